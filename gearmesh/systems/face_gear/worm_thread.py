"""The worm that grinds a face gear as a part: flanks, crests that grind the fillets, root with clearance.

The shaper's flank and tip rounding generate flank and crest, its top cylinder the land, a barrel. The root is a cylinder: the
gear's tips pass the worm along a line across it. From there to the flank a wall stands along the radius, which touches
nothing. Seen across the worm, at the place y along it:

        ____   land, rho(y), a barrel
       /    \\  crest
      /      \\   flank, from theta_low(y) to the end of the shaper's involute
      |      |   wall, from the flank at the height x = h of the contact point down to
    __|      |__ the root, rho = E_ws + h - clearance / 2

The flank's parameters are its share p of the way from theta_low to the end, and v = y. A shaper's point theta_s touches at y where

    y = r_b (sin(kappa) - theta_s cos(kappa)),   r_b^2 theta_s^2 = x^2 + y^2 - r_b^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError
from gearmesh.figures import Figures, Summary, figure
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, cross
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.kernel.surface.levels import ConeLevel, PlaneLevel
from gearmesh.kernel.surface.mapped import MappedSurface, Mapping
from gearmesh.kernel.surface.meridian import Meridian
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.kernel.surface.surface import Jet, PlacedSurface, Surface
from gearmesh.systems.common.bodies.body import bore_radius
from gearmesh.systems.common.bounds import at_most
from gearmesh.systems.face_gear.build import build, cut_gear, grinding_of, middle, shaped_gear
from gearmesh.systems.face_gear.grinding import Grinding
from gearmesh.systems.system import ToolPart
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import TipCorner, ToothSide
from gearmesh.tools.description import ToolDescription
from gearmesh.tools.rack import Reversed
from gearmesh.tools.shaper_worm import ShaperWorm

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.face_gear.design import FaceGearDesign

#: clearance of the worm's root from the gear's tips, in modules: what is made if the thread is sound down to it, and at least
CLEARANCE, LEAST = 0.25, 0.02
#: mm: below this length there is no thread
SHORTEST = 1e-3
#: theta_s below which the thread's flank does not begin, smoothly
FLOOR = 0.05
#: step (mm) of the difference that gives the wall's curvature along the thread; its error is below 1e-6 of the curvature
STEP = 1e-3
#: rounds of Newton's method from the place on the worm to the angle on the shaper's top
ROUNDS = 30


@dataclass(frozen=True)
class Thread:
    """A thread whose flanks begin at the height `low` (mm) over the shaper's axis, on a root `clearance` / 2 (mm) below."""

    worm: ShaperWorm
    low: float
    clearance: float

    @property
    def root(self) -> float:
        """Radius (mm) of the root cylinder."""
        return self.worm.distance + self.low - 0.5 * self.clearance

    def side(self, which: int) -> ToothSide:
        """The thread's right side (+1) or left side (-1), in its own frame: a thread is centred on +x."""
        shaper, side = self.worm.shaper, -which * self.worm.hand
        to_own = Rigid.about_z(-which * np.pi / self.worm.threads)
        flank = PlacedSurface(self.flank(side), to_own)
        generated = self.worm.thread(Reversed(shaper.rounding), side, branch=-1)
        rounding = MappedSurface(generated, lambda q, v: self._crest_mapping(side, q, v))
        tip_corner = TipCorner(PlacedSurface(rounding, to_own), (1.0, -shaper.form_point[1]), -shaper.root)
        wall = Wall(flank, self.root, which)
        return ToothSide(
            flank, wall, (0.0, 0.0), 1.0, 1.0, tip_corner=tip_corner, sharp=True, tool=ToolDescription("shaper")
        )

    def flank(self, side: int) -> Surface:
        """The flank that the shaper's `side` generates, normal out of the worm, by the parameters (p, v)."""
        generated = self.worm.thread(Reversed(self.worm.shaper.involute), side, branch=-1)
        return MappedSurface(generated, lambda p, v: self._mapping(side, p, v))

    def beginning(self, y: Array) -> tuple[Array, Array]:
        """theta_low (...,) at y (...,), and d theta_low / dy, 1/mm."""
        base = self.worm.shaper.base_radius
        squared = (self.low**2 + y**2) / base**2 - 1.0
        root = np.hypot(squared, 2.0 * FLOOR**2)
        theta = np.sqrt(0.5 * (squared + root))
        slope: Array = (1.0 + squared / root) * y / base**2 / (2.0 * theta)
        return theta, slope

    def kappa(self, theta: Array, y: Array) -> tuple[Array, Array]:
        """Pressure angle (...,), rad, with which theta_s touches at y, and the height x (...,), mm, at which it does."""
        with np.errstate(invalid="ignore"):
            x = np.sqrt(self.worm.shaper.base_radius**2 * (1.0 + theta**2) - y**2)
        return np.arctan2(y, x) + np.arctan(theta), x

    def sound(self, half: Array) -> NDArray[np.bool_]:
        """Whether (...,) a thread from -half to half (...,), mm, has no singular points: they are where its flank begins."""
        y = -np.atleast_1d(half)
        theta = self.beginning(y)[0]
        with np.errstate(invalid="ignore"):
            kappa = self.kappa(theta, y)[0]
        regular: NDArray[np.bool_] = kappa > self.worm.singular_kappa(theta)
        return regular

    def longest(self) -> float:
        """Length (mm) up to which the thread has no singular points."""
        low, high = np.zeros(1), np.array([self.worm.shaper.base_radius])
        half, _ = last_true(lambda at, _: self.sound(at), low, high)
        return 2.0 * float(half[0]) * float(np.cos(self.worm.lead_angle))

    def _mapping(self, side: int, p: Array, v: Array) -> Mapping:
        p, v = broadcast_pair(p, v)
        worm, end = self.worm if side > 0 else self.worm.mirror_image, self.worm.shaper.form_point[0]
        y = side * v
        low, low_y = self.beginning(y)
        theta, theta_p, theta_y = low + p * (end - low), end - low, (1.0 - p) * low_y
        kappa, x = self.kappa(theta, y)
        # along y = r_b (sin(kappa) - theta cos(kappa)), x = r_b (cos(kappa) + theta sin(kappa))
        by_theta, by_y = worm.shaper.base_radius * np.cos(kappa) / x, 1.0 / x
        z, slope, _ = worm.along_arm(kappa, np.array(worm.shaper.base_radius))
        kappa_y = by_y + by_theta * theta_y
        return Mapping(-theta, z, -theta_p, -side * theta_y, slope * by_theta * theta_p, side * slope * kappa_y)

    def _crest_mapping(self, side: int, q: Array, v: Array) -> Mapping:
        """Of the rounding, whose parameter stays; Z would be far from even across it."""
        q, v = broadcast_pair(q, v)
        worm, shaper = self.worm if side > 0 else self.worm.mirror_image, self.worm.shaper
        # the rounding's point from the shaper's axis, where the shaper's space is centred on x; its normal is at -q
        points, tangents, _, _ = shaper.rounding.section(-q)
        at, slope, y = np.array([shaper.pitch_radius, 0.0]) - points, tangents, side * v
        radius = np.hypot(at[..., 0], at[..., 1])
        with np.errstate(invalid="ignore"):
            x = np.sqrt(radius**2 - y**2)
        psi = np.arctan2(y, x) - np.arctan2(at[..., 1], at[..., 0])
        c, s = np.cos(-q), np.sin(-q)
        arm = at[..., 0] * c + at[..., 1] * s
        # by q; the angle of the normal is -q, the tangent -d at / d(-q)
        arm_q = slope[..., 0] * c + slope[..., 1] * s + at[..., 0] * s - at[..., 1] * c
        radius_q = np.einsum("...i,...i", at, slope) / radius
        turn_q = (at[..., 0] * slope[..., 1] - at[..., 1] * slope[..., 0]) / radius**2
        kappa, kappa_q = psi - q, -1.0 - turn_q - radius_q * y / (radius * x)
        z, z_kappa, z_arm = worm.along_arm(kappa, arm)
        return Mapping(q, z, np.ones_like(q), np.zeros_like(q), z_kappa * kappa_q + z_arm * arm_q, side * z_kappa / x)


@dataclass(frozen=True)
class Wall:
    """Wall along the radius from the beginning p = 0 of a flank, at q = 0, to a cylinder of radius `root` (mm), at q = 1.

    `side` +1: its normal points against the angle about the axis, -1: with it.
    """

    flank: Surface
    root: float
    side: int

    def jet(self, u: Array, v: Array) -> Jet:
        q, v = broadcast_pair(u, v)
        curve, ahead, behind = (self.flank.jet(np.zeros_like(v), v + step) for step in (0.0, STEP, -STEP))
        bend = (ahead.r_v - behind.r_v) / (2.0 * STEP)
        rho = np.hypot(curve.r[..., 0], curve.r[..., 1])
        out = curve.r * [1.0, 1.0, 0.0] / rho[..., None]
        up = np.array([0.0, 0.0, 1.0])
        around = cross(np.broadcast_to(up, out.shape), out)
        rate, turn = (np.einsum("...i,...i", curve.r_v, d) for d in (out, around))
        # r = radius out + z up; out' = angle_v around
        angle_v = turn / rho
        angle_vv = (np.einsum("...i,...i", bend, around) - 2.0 * rate * angle_v) / rho
        radius, radius_q, radius_v = rho + q * (self.root - rho), self.root - rho, (1.0 - q) * rate
        z_v, z_vv = curve.r_v[..., 2], bend[..., 2]

        def vector(along_out: Array, along_around: Array, along_up: Array) -> Array:
            sum_of_parts: Array = (
                along_out[..., None] * out + along_around[..., None] * around + along_up[..., None] * up
            )
            return sum_of_parts

        zero = np.zeros_like(q)
        sense = self.side * np.sign(z_v)
        length = np.hypot(z_v, radius * angle_v)
        a, b = -sense * z_v / length, sense * radius * angle_v / length

        def normal_change(z_x: Array, slope_x: Array, angle_x: Array) -> Array:
            """Change of the normal a around + b up."""
            change = (z_v * slope_x - radius * angle_v * z_x) / length**2
            return vector(-a * angle_x, b * change, -a * change)

        return Jet(
            r=vector(radius, zero, curve.r[..., 2]),
            n=vector(zero, a, b),
            r_u=vector(radius_q, zero, zero),
            r_v=vector(radius_v, radius * angle_v, z_v),
            n_u=normal_change(zero, radius_q * angle_v, zero),
            n_v=normal_change(z_vv, radius_v * angle_v + radius * angle_vv, angle_v),
        )


@dataclass(frozen=True)
class ThreadFigures(Figures):
    """The thread of the worm that grinds a face gear."""

    length: float = figure("length of the thread", "mm")
    needed_length: float = figure("length of thread needed to grind the whole tooth", "mm")
    longest: float = figure("length of the thread up to its singular points", "mm")


@dataclass(frozen=True)
class GrindingFigures(Figures):
    """How a worm grinds a face gear."""

    turns: float = figure("turns of the thread")
    lead_angle: float = figure("lead angle of the worm", "deg", "lambda_w")
    crossing_angle: float = figure("crossing angle of the axes of worm and shaper", "deg", "gamma_ws")
    axes_distance: float = figure("shortest distance of the axes of worm and shaper", "mm", "E_ws")
    reserve_to_singular_points: float = figure(
        "angle of the worm between the tooth and the first singular point", "deg"
    )
    ground_from_shaped: float = figure("largest distance between the ground flank and the shaped one", "um")


def worm_part(design: FaceGearDesign) -> ToolPart:
    """The worm of the table `worm` (in mm) as a part, and how far the gear that it grinds is from the shaped one.

    Raises DesignError as `grinding_worm`.
    """
    tooth = _shaped_tooth(design)
    grinding, part = _make(design, tooth)
    worm = grinding.worm
    figures = GrindingFigures(
        turns=part.figures["length_mm"] / (2.0 * np.pi * worm.radius * np.tan(worm.lead_angle)),
        lead_angle=float(np.degrees(worm.lead_angle)),
        crossing_angle=float(np.degrees(worm.crossing_angle)),
        axes_distance=worm.distance,
        reserve_to_singular_points=float(np.degrees(grinding.reserve(tooth))),
        ground_from_shaped=1e3 * grinding.difference(tooth),
    )
    return replace(part, figures=Summary(part.figures, figures), ground="gear", tooth=grinding.grind(tooth))


def grinding_in_place(design: FaceGearDesign) -> Grinding:
    """The worm of a design (in mm) on its gear. Raises DesignError for a worm that cannot exist."""
    shaped = shaped_gear(design)
    return grinding_of(design, cut_gear(design, shaped), middle(design, shaped))


def _shaped_tooth(design: FaceGearDesign) -> Tooth:
    """The tooth of the gear (design in mm) as a shaper makes it with the settings of the machine."""
    return build(design.with_values({"gear.machine.tool": "shaper"})).pairs[0].gear.tooth


def _make(design: FaceGearDesign, tooth: Tooth) -> tuple[Grinding, ToolPart]:
    """The worm of a design (in mm) on the tooth of its gear, and as a part with the figures of its length. Raises DesignError."""
    grinding, spec = grinding_in_place(design), design.worm
    shaped, height = grinding.shaped, design.gear.addendum * design.given_module
    reach = grinding.reach(tooth)
    # the gear's tips are on a cone: off 90 deg they are not at one height across the worm
    y = np.array([reach[0], 0.0, reach[1]])
    tip = float(shaped.tip_line(height, y, float(shaped.place_of(design.gear.inner_radius))).min())
    return grinding, grinding_worm(grinding.worm, tip, reach, spec.length, spec.bore)


def pinned_values(design: FaceGearDesign, _: GearTrain) -> Values:
    """Of a complete design in mm: teeth of the shaper; length and bore of the worm, where there is one."""
    teeth: Values = {"shaper.teeth": design.shaper_teeth}
    try:
        part = _make(design, _shaped_tooth(design))[1]
    except DesignError:
        return teeth
    return {
        **teeth,
        "worm.length": part.figures["length_mm"],
        "worm.bore": 2.0 * float(part.member.tooth.blank.body.bore_radius),
    }


def grinding_worm(
    worm: ShaperWorm, tip: float, reach: tuple[float, float], length: float | None, bore: float | None
) -> ToolPart:
    """The worm as a part; `tip` (mm): least height of the gear's tips over the shaper's axis; `reach`: see `Grinding`.

    A `length` (mm) that is not given is what grinds the whole tooth, in whole mm, or as much as is sound. Raises DesignError
    naming key, value and limit: singular points of the thread, or nothing without them, bore not below the root, thread that
    cannot be closed.
    """
    needed = 2.0 * max(abs(place) for place in reach)
    thinnest = _thread(worm, tip, LEAST)
    longest = thinnest.longest()
    if longest < SHORTEST:
        raise DesignError(
            "shaper.teeth",
            worm.shaper.teeth,
            reason="the thread of the worm has singular points everywhere",
            allowed="more",
        )
    given = min(float(math.ceil(needed)), math.floor(1e3 * longest) / 1e3) if length is None else length
    if given > longest:
        raise DesignError(
            "worm.length",
            given,
            unit="mm",
            reason="the thread has singular points there",
            allowed=f"at most {at_most(longest)} mm",
        )
    half = 0.5 * given / np.cos(worm.lead_angle)
    clearance, _ = last_true(
        lambda at, _: np.array([bool(_thread(worm, tip, float(c)).sound(np.array(half))[0]) for c in at]),
        np.array([LEAST]),
        np.array([CLEARANCE]),
    )
    thread = _thread(worm, tip, float(clearance[0]))
    figures = Summary(ThreadFigures(given, needed, longest))
    short = f"worm.length = {given:g} mm: grinding the whole tooth needs {needed:.6g} mm"
    warnings = (short,) if given < needed else ()
    return ToolPart(_member(thread, given, bore), figures, warnings, Rigid.about_z(np.pi / worm.threads))


def _thread(worm: ShaperWorm, tip: float, clearance: float) -> Thread:
    depth = clearance * worm.shaper.module
    return Thread(worm, tip - 0.5 * depth, depth)


def _member(thread: Thread, length: float, bore: float | None) -> Member:
    worm, half = thread.worm, 0.5 * length
    hole = bore_radius("worm", bore, thread.root, "the root diameter")
    try:
        land = Meridian.through(lambda z: _crest_radius(worm, worm.shaper.top_radius, z), (-half, half))
        blank = Blank(PlaneLevel(0.0), (-half, half), land, ConeLevel.of(thread.root), Body.tube(hole, -half, half))
        tooth = Tooth(worm.threads, thread.side(1), thread.side(-1), blank)
        tooth.prove()
    except (TrimError, ValueError) as failure:
        raise DesignError(
            "worm.pitch_radius", worm.radius, unit="mm", reason=f"{failure} (of the worm's thread)", allowed="more"
        ) from failure
    return Member("worm", tooth, lambda p, v: {"p": p, "y": v})


def _crest_radius(worm: ShaperWorm, radius: float, z: Array) -> Array:
    """rho (...,), mm, at z on the surface of revolution that a cylinder about the shaper's axis generates on the worm."""
    _, cosine, sine = worm.to_shaper.rotation[:, 2]
    off = sine**2 / cosine * worm.distance
    angle = np.arcsin(z / (radius * cosine))
    for _ in range(ROUNDS):
        miss = radius * cosine * np.sin(angle) - off * np.tan(angle) - z
        angle = angle - miss / (radius * cosine * np.cos(angle) - off / np.cos(angle) ** 2)
    along = -sine / cosine * worm.distance * np.tan(angle)
    rho: Array = np.hypot(radius * np.cos(angle) + worm.distance, sine * radius * np.sin(angle) - cosine * along)
    return rho
