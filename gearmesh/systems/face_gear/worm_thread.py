r"""The worm that grinds a face gear, as a part: flanks, crests that grind the fillets, root with clearance.

The shaper's flank and tip rounding generate flank and crest; its top cylinder generates the land, a barrel. The root is
a cylinder, because the gear's tips pass the worm along a line across it. A wall along the radius connects root and
flank and touches nothing. The section across the worm at the position y along it:

        ____   land, rho(y), a barrel
       /    \  crest
      /      \   flank, from theta_low(y) to the end of the shaper's involute
      |      |   wall, from the flank at the height x = h of the contact point down to
    __|      |__ the root, rho = E_ws + h - clearance / 2

The flank's parameters are its share p of the way from theta_low to the end, and v = y. The shaper's point theta_s
touches at y, where

    y = r_b (sin(kappa) - theta_s cos(kappa)),   r_b^2 theta_s^2 = x^2 + y^2 - r_b^2.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.allowed import Allowed
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
from gearmesh.records import dataclass
from gearmesh.systems.common.bodies.body import bore_radius
from gearmesh.systems.face_gear.build import build, cut_gear, grinding_of, middle, shaped_gear
from gearmesh.systems.face_gear.grinding import Grinding
from gearmesh.systems.system import ToolPart
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.source_parameters import NamedParameters, SourceParameter
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import TipCorner, ToothSide
from gearmesh.tools.description import ToolDescription
from gearmesh.tools.rack import Reversed
from gearmesh.tools.shaper_worm import ShaperWorm

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.face_gear.design import FaceGearDesign

#: clearance (modules) of the worm's root from the gear's tips, if the thread has no singular points down to it
CLEARANCE_MODULES = 0.25
#: least clearance of the worm's root from the gear's tips, in modules
MIN_CLEARANCE_MODULES = 0.02
#: least length (mm) of a thread
MIN_THREAD_LENGTH_MM = 1e-3
#: theta_s that the beginning of the thread's flank approaches smoothly from above
MIN_THREAD_THETA = 0.05
#: step (mm) of the difference for the wall's curvature along the thread; its error is below 1e-6 of the curvature
CURVATURE_STEP_MM = 1e-3
#: Newton steps from the position on the worm to the angle on the shaper's top
NEWTON_ROUNDS = 30


@dataclass(frozen=True)
class Thread:
    """Thread of the worm."""

    #: the worm
    worm: ShaperWorm
    #: height of the beginning of the flanks over the shaper's axis, mm
    low: float
    #: twice the distance of the root below the beginning of the flanks, mm
    clearance: float

    @property
    def root(self) -> float:
        """Radius (mm) of the root cylinder."""
        return self.worm.distance + self.low - 0.5 * self.clearance

    def side(self, thread_side: int) -> ToothSide:
        """Return the thread's right side (+1) or left side (-1) in the worm's frame; a thread is centred on +x."""
        shaper, side = self.worm.shaper, -thread_side * self.worm.hand
        to_own = Rigid.about_z(-thread_side * np.pi / self.worm.threads)
        flank = PlacedSurface(self.flank(side), to_own)
        generated = self.worm.thread(Reversed(shaper.rounding), side, branch=-1)
        rounding = MappedSurface(generated, lambda q, v: self._crest_mapping(side, q, v))
        tip_corner = TipCorner(PlacedSurface(rounding, to_own), (1.0, -shaper.form_point[1]), -shaper.root)
        wall = Wall(flank, self.root, thread_side)
        return ToothSide(
            flank, wall, (0.0, 0.0), 1.0, 1.0, tip_corner=tip_corner, sharp=True, tool=ToolDescription("shaper")
        )

    def flank(self, side: int) -> Surface:
        """Return the flank that the shaper's `side` generates, with parameters (p, v) and normal out of the worm."""
        generated = self.worm.thread(Reversed(self.worm.shaper.involute), side, branch=-1)
        return MappedSurface(generated, lambda p, v: self._mapping(side, p, v))

    def beginning(self, y: Array) -> tuple[Array, Array]:
        """Return theta_low (...,) at y (...,), and d theta_low / dy, 1/mm."""
        base = self.worm.shaper.base_radius
        squared = (self.low**2 + y**2) / base**2 - 1.0
        root = np.hypot(squared, 2.0 * MIN_THREAD_THETA**2)
        theta = np.sqrt(0.5 * (squared + root))
        slope: Array = (1.0 + squared / root) * y / base**2 / (2.0 * theta)
        return theta, slope

    def kappa(self, theta: Array, y: Array) -> tuple[Array, Array]:
        """Return the pressure angle (...,), rad, and the height x (...,), mm, at which theta_s touches at y."""
        with np.errstate(invalid="ignore"):
            x = np.sqrt(self.worm.shaper.base_radius**2 * (1.0 + theta**2) - y**2)
        return np.arctan2(y, x) + np.arctan(theta), x

    def sound(self, half: Array) -> NDArray[np.bool_]:
        """Return True (...,) if a thread from -half to half (...,), mm, has no singular points.

        The first singular points are at the beginning of its flank.
        """
        y = -np.atleast_1d(half)
        theta = self.beginning(y)[0]
        with np.errstate(invalid="ignore"):
            kappa = self.kappa(theta, y)[0]
        regular: NDArray[np.bool_] = kappa > self.worm.singular_kappa(theta)
        return regular

    def longest(self) -> float:
        """Return the length (mm) up to which the thread has no singular points."""
        low, high = np.zeros(1), np.array([self.worm.shaper.base_radius])
        half, _ = last_true(lambda at, _: self.sound(at), low, high)
        return 2.0 * float(half[0]) * float(np.cos(self.worm.lead_angle))

    def _mapping(self, side: int, p: Array, v: Array) -> Mapping:
        """Return the mapping from (p, v) to the parameters of the generated flank."""
        p, v = broadcast_pair(p, v)
        worm, end = self.worm if side > 0 else self.worm.mirror_image, self.worm.shaper.form_point[0]
        y = side * v
        low, low_y = self.beginning(y)
        theta, theta_p, theta_y = low + p * (end - low), end - low, (1.0 - p) * low_y
        kappa, x = self.kappa(theta, y)
        # derivatives of kappa along y = r_b (sin(kappa) - theta cos(kappa)), x = r_b (cos(kappa) + theta sin(kappa))
        by_theta, by_y = worm.shaper.base_radius * np.cos(kappa) / x, 1.0 / x
        z, slope, _ = worm.along_arm(kappa, np.array(worm.shaper.base_radius))
        kappa_y = by_y + by_theta * theta_y
        return Mapping(-theta, z, -theta_p, -side * theta_y, slope * by_theta * theta_p, side * slope * kappa_y)

    def _crest_mapping(self, side: int, q: Array, v: Array) -> Mapping:
        """Mapping of the rounding, whose parameter q is kept; v = y replaces Z, which varies strongly across it."""
        q, v = broadcast_pair(q, v)
        worm, shaper = self.worm if side > 0 else self.worm.mirror_image, self.worm.shaper
        # point of the rounding from the shaper's axis, with the shaper's space centred on x; its normal is at the angle -q
        points, tangents, _, _ = shaper.rounding.section(-q)
        point, slope, y = np.array([shaper.pitch_radius, 0.0]) - points, tangents, side * v
        radius = np.hypot(point[..., 0], point[..., 1])
        with np.errstate(invalid="ignore"):
            x = np.sqrt(radius**2 - y**2)
        psi = np.arctan2(y, x) - np.arctan2(point[..., 1], point[..., 0])
        c, s = np.cos(-q), np.sin(-q)
        arm = point[..., 0] * c + point[..., 1] * s
        # derivatives by q; the angle of the normal is -q, the tangent is -d at / d(-q)
        arm_q = slope[..., 0] * c + slope[..., 1] * s + point[..., 0] * s - point[..., 1] * c
        radius_q = np.einsum("...i,...i", point, slope) / radius
        turn_q = (point[..., 0] * slope[..., 1] - point[..., 1] * slope[..., 0]) / radius**2
        kappa, kappa_q = psi - q, -1.0 - turn_q - radius_q * y / (radius * x)
        z, z_kappa, z_arm = worm.along_arm(kappa, arm)
        return Mapping(q, z, np.ones_like(q), np.zeros_like(q), z_kappa * kappa_q + z_arm * arm_q, side * z_kappa / x)


@dataclass(frozen=True)
class Wall:
    """Wall along the radius from the beginning of a flank (q = 0) to a cylinder (q = 1)."""

    #: flank of the thread, which begins at p = 0
    flank: Surface
    #: radius of the cylinder, mm
    root: float
    #: +1 if the normal points against the angle about the axis, -1 if with it
    side: int

    def jet(self, u: Array, v: Array) -> Jet:
        """Return the jet at q = u and v."""
        q, v = broadcast_pair(u, v)
        curve, ahead, behind = (
            self.flank.jet(np.zeros_like(v), v + step) for step in (0.0, CURVATURE_STEP_MM, -CURVATURE_STEP_MM)
        )
        # second derivative of the flank's beginning along the thread, by central differences
        bend = (ahead.r_v - behind.r_v) / (2.0 * CURVATURE_STEP_MM)
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
            """Return vectors by their components along `out`, `around` and z."""
            sum_of_parts: Array = (
                along_out[..., None] * out + along_around[..., None] * around + along_up[..., None] * up
            )
            return sum_of_parts

        zero = np.zeros_like(q)
        sense = self.side * np.sign(z_v)
        length = np.hypot(z_v, radius * angle_v)
        a, b = -sense * z_v / length, sense * radius * angle_v / length

        def normal_change(z_x: Array, slope_x: Array, angle_x: Array) -> Array:
            """Return the change of the normal a around + b up."""
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
    """Grinding of a face gear by a worm."""

    turns: float = figure("turns of the thread")
    lead_angle: float = figure("lead angle of the worm", "deg", "lambda_w")
    crossing_angle: float = figure("crossing angle of the axes of worm and shaper", "deg", "gamma_ws")
    axes_distance: float = figure("shortest distance of the axes of worm and shaper", "mm", "E_ws")
    reserve_to_singular_points: float = figure(
        "angle of the worm between the tooth and the first singular point", "deg"
    )
    ground_from_shaped: float = figure("largest distance between the ground flank and the shaped one", "um")


def worm_part(design: FaceGearDesign) -> ToolPart:
    """Return the worm of the table `worm` (in mm) as a part, with the distance of the ground gear from the shaped gear.

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
    """Return the grinding of a design (in mm). Raises DesignError for a worm that cannot exist."""
    shaped = shaped_gear(design)
    return grinding_of(design, cut_gear(design, shaped), middle(design, shaped))


def _shaped_tooth(design: FaceGearDesign) -> Tooth:
    """Return the tooth of the gear (design in mm) made by the shaper with the machine's settings."""
    return build(design.with_values({"gear.machine.tool": "shaper"})).pairs[0].gear.tooth


def _make(design: FaceGearDesign, tooth: Tooth) -> tuple[Grinding, ToolPart]:
    """Return the grinding of a design (in mm), and the worm as a part with the figures of its length.

    `tooth`: tooth of the gear. Raises DesignError as `grinding_worm`.
    """
    grinding, spec = grinding_in_place(design), design.worm
    shaped, height = grinding.shaped, design.gear.addendum * design.given_module
    reach = grinding.reach(tooth)
    # the gear's tips are on a cone: at shaft angles other than 90 deg their height varies across the worm
    y = np.array([reach[0], 0.0, reach[1]])
    tip = float(shaped.tip_line(height, y, float(shaped.place_of(design.gear.inner_radius))).min())
    return grinding, grinding_worm(grinding.worm, tip, reach, spec.length, spec.bore)


def pinned_values(design: FaceGearDesign, _: GearTrain) -> Values:
    """Return values of a complete design in mm: teeth of the shaper; length and bore of the worm, if it can exist."""
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
    """Return the worm as a part.

    - `worm`: the worm
    - `tip`: least height of the gear's tips over the shaper's axis, mm
    - `reach`: range of the grinding points along the worm's axis, mm: see `Grinding`
    - `length`: length of the thread, mm; None for the length that grinds the whole tooth, in whole mm, or the largest
      length without singular points
    - `bore`: bore diameter, mm, or None

    Raises DesignError naming key, value and limit: a thread with singular points, a bore not below the root, a thread
    that cannot be closed.
    """
    needed = 2.0 * max(abs(place) for place in reach)
    thinnest = _thread(worm, tip, MIN_CLEARANCE_MODULES)
    longest = thinnest.longest()
    if longest < MIN_THREAD_LENGTH_MM:
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
            allowed=Allowed.at_most(longest, "mm"),
        )
    half = 0.5 * given / np.cos(worm.lead_angle)
    clearance, _ = last_true(
        lambda at, _: np.array([bool(_thread(worm, tip, float(c)).sound(np.array(half))[0]) for c in at]),
        np.array([MIN_CLEARANCE_MODULES]),
        np.array([CLEARANCE_MODULES]),
    )
    thread = _thread(worm, tip, float(clearance[0]))
    figures = Summary(ThreadFigures(given, needed, longest))
    short = f"worm.length = {given:g} mm: grinding the whole tooth needs {needed:.6g} mm"
    warnings = (short,) if given < needed else ()
    return ToolPart(_member(thread, given, bore), figures, warnings, Rigid.about_z(np.pi / worm.threads))


def _thread(worm: ShaperWorm, tip: float, clearance: float) -> Thread:
    """Return the thread with a clearance (modules) below the gear's tips at the height `tip` (mm)."""
    depth = clearance * worm.shaper.module
    return Thread(worm, tip - 0.5 * depth, depth)


def _member(thread: Thread, length: float, bore: float | None) -> Member:
    """Return the worm as a member. Raises DesignError for a thread that cannot be closed."""
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
    declared = (
        SourceParameter("p", "", "place between the beginning (0) and the end (1) of the flank"),
        SourceParameter("y", "mm", "distance along the axis of the worm, from its middle"),
    )
    return Member("worm", tooth, NamedParameters(declared, lambda p, v: (p, v)))


def _crest_radius(worm: ShaperWorm, radius: float, z: Array) -> Array:
    """Return rho (...,), mm, at z on the surface that a cylinder about the shaper's axis generates on the worm.

    The surface is a surface of revolution about the worm's axis.
    """
    _, cosine, sine = worm.to_shaper.rotation[:, 2]
    off = sine**2 / cosine * worm.distance
    angle = np.arcsin(z / (radius * cosine))
    for _ in range(NEWTON_ROUNDS):
        miss = radius * cosine * np.sin(angle) - off * np.tan(angle) - z
        angle = angle - miss / (radius * cosine * np.cos(angle) - off / np.cos(angle) ** 2)
    along = -sine / cosine * worm.distance * np.tan(angle)
    rho: Array = np.hypot(radius * np.cos(angle) + worm.distance, sine * radius * np.sin(angle) - cosine * along)
    return rho
