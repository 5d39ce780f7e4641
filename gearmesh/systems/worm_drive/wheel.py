"""The wheel of a worm drive as its hob generates it.

The hob turns and the wheel with it: since a thread that turns is the same surface as one that slides along its axis, the hob is a
rack that rolls on the wheel, its pitch plane at the radius K cos(theta), with K = m_x0 z2 / 2 and theta the angle by which the
axes are away from a right angle. The equation of meshing is linear in the roll: one root, whatever the threads wind.

Tool frame, of `RackRoll`: x away from the wheel's axis, z along it; the hob's axis is (0, cos(theta), sin(theta)), its threads
point towards -x.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.envelope.helicoid import Helicoid
from gearmesh.kernel.envelope.limiting_line import area_density
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair
from gearmesh.kernel.surface.levels import ConeLevel, LandLevel
from gearmesh.kernel.surface.mapped import Mapping
from gearmesh.kernel.surface.meridian import CircularMeridian, CylinderMeridian, Joined, Meridian, Straight
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.kernel.surface.surface import Jet, PlacedSurface, Surface
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.worm_drive.thread import LAND, Rounding, WormThread
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import PROOF_STATIONS, Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.description import Dimension, ToolDescription
from gearmesh.tools.drawing import ThreadDrawing

#: stations at which a wheel's land is tried, and both ends and the middle of the face
LANDS, PLACES = 65, np.array([0.0, 0.5, 1.0])
#: stations between toe and heel, whose undercut is kept with that beside the ends of loops
BETWEEN = np.linspace(0.0, 1.0, PROOF_STATIONS)[1:-1]


@dataclass(frozen=True)
class FaceFlank:
    """A hob's flank `own` by parameters (p, v) of which lines p = const go on across a throated face: p is that of the profile in
    the plane v = 0 through the axis, v (mm) over `height` the tangent of the polar angle.

    At the form point, of radius `outer` (mm) and parameter `form_point`, nothing changes; the lines towards the tip of the wheel
    become lines at the height `height` (mm) over the hob's axis.
    """

    own: Helicoid
    outer: float
    form_point: float
    height: float

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        away, depth = np.hypot(self.height, v), self.outer - self.height
        share, rate = (self.outer - away) / depth, -v / away / depth
        a, a_v = self.form_point + (u - self.form_point) * share, (u - self.form_point) * rate
        at = self.own.curve.at(a)
        x, y, x_p, y_p = at.c[..., 0], at.c[..., 1], at.c_p[..., 0], at.c_p[..., 1]
        mirror = self.own.signs[1]
        # the curve itself winds about the axis
        turned = -mirror * (x * y_p - y * x_p) / (x**2 + y**2)
        b = np.arctan2(v, self.height) - mirror * np.arctan2(y, x)
        # a step of Newton's method that goes astray ends where the square is infinite, and the polar angle rests
        with np.errstate(over="ignore"):
            mapping = Mapping(a, b, share, a_v, turned * share, self.height / away**2 + turned * a_v)
        return mapping.over(self.own.sweep(at, b))


def crossed_axes(tilt: float) -> Array:
    """Axes (3, 3) of a frame that looks back along x, its z axis the other's y axis turned by `tilt` (rad) towards the other's z:
    of the hob over its tool frame, and of the wheel over the worm's frame."""
    c, s = math.cos(tilt), math.sin(tilt)
    return np.array([[-1.0, 0.0, 0.0], [0.0, -s, c], [0.0, c, s]]).T


@dataclass(frozen=True)
class WormHob:
    """A hob over a wheel of `teeth` teeth: its thread, radius of its tip and of its tip rounding, distance of the axes, mm; `tilt`
    (rad): of its axis out of the plane across the wheel's."""

    thread: WormThread
    tip_radius: float
    rounding_radius: float
    distance: float
    tilt: float
    teeth: int

    @property
    def way(self) -> float:
        """How far it moves along its axis for every rad of the wheel, mm."""
        return 0.5 * self.thread.module * self.teeth

    @property
    def roll(self) -> RackRoll:
        """The motion of the hob over the wheel."""
        return RackRoll(self.way * math.cos(self.tilt), self.way * math.sin(self.tilt))

    @cached_property
    def rounding(self) -> Rounding:
        """The rounding of its tip."""
        try:
            return self.thread.tip_rounding(self.tip_radius, self.rounding_radius)
        except DesignError as failure:
            raise DesignError(
                "hob.tip_radius", self.rounding_radius, unit="mm", reason="the hob's flank does not reach it"
            ) from failure

    @property
    def form_radius(self) -> float:
        """Radius on the hob where flank and tip rounding meet, mm."""
        return self.thread.form_radius(self.rounding)

    def place(self, side: int) -> Rigid:
        """The hob's frame over the tool's, the thread beside the right (+1) or left (-1) side of the wheel's tooth on +x."""
        axes = crossed_axes(self.tilt)
        start = np.array([self.distance - self.roll.radius, 0.0, 0.0])
        return Rigid(axes, start - 0.5 * side * self.thread.axial_pitch * axes[:, 2])

    def _side(self, side: int) -> int:
        """The side of the hob's thread that generates a side of the wheel's tooth: the one that looks towards it."""
        return side * self.thread.hand

    def generate(self, surface: Surface, side: int) -> Envelope:
        """What a surface of the thread generates on a side of the wheel's tooth."""
        return Envelope(PlacedSurface(surface, self.place(side)), self.roll)

    def flank(self, side: int, height: float) -> Envelope:
        """The flank of a side of the wheel's tooth, parameters as of `FaceFlank` with the `height`."""
        own = self.thread.flank(self._side(side), -1)
        return self.generate(FaceFlank(own, self.form_radius, self.rounding.form_point[0], height), side)

    def fillet(self, side: int) -> Envelope:
        """The fillet of a side of the wheel's tooth."""
        return self.generate(self.thread.rounding_surface(self.rounding, self._side(side), -1), side)

    def tooth_side(self, side: int, tip_height: float, height: float) -> ToothSide:
        """A side of the wheel's tooth, whose tip is at `tip_height` (mm) over the hob's axis in the middle plane."""
        flank, fillet = self.flank(side, height), self.fillet(side)
        p, q = self.rounding.form_point
        return ToothSide(
            flank,
            fillet,
            form_point=(p, q),
            root=LAND,
            tip=self.thread.at_radius(tip_height),
            tool=self.description,
            generation=(flank, fillet),
        )

    @property
    def description(self) -> ToolDescription:
        thread = self.thread
        dimensions = (
            Dimension("threads", thread.threads, "", "z_0"),
            Dimension("axial module", thread.module, "mm", "m_x0"),
            Dimension("pressure angle", math.degrees(thread.angle), "deg", "alpha_0"),
            Dimension("reference diameter", 2.0 * thread.radius, "mm", "d_0"),
            Dimension("tip diameter", 2.0 * self.tip_radius, "mm", "d_a0"),
            Dimension("lead angle", math.degrees(thread.lead_angle), "deg", "gamma_0"),
        )
        drawing = ThreadDrawing(self.place(1), thread.hand * thread.screw, thread.threads)
        return ToolDescription("hob", drawing, dimensions, tip_radius=self.rounding_radius)

    def root(self, half: float) -> LandLevel:
        """The root that the hob's tips leave on a face of +-`half` mm. Raises DesignError where they do not reach its ends."""
        r, a, narrower = self.tip_radius, self.distance, math.cos(self.tilt)
        if half * narrower >= r:
            raise VagueError(
                "wheel.face_width",
                2.0 * half,
                unit="mm",
                reason=f"a hob of the tip diameter {2.0 * r:.6g} mm does not reach over so wide a face",
            )
        return Meridian(CircularMeridian((0.0, a), r) if self.tilt == 0.0 else CylinderMeridian(a, r, self.tilt))


def prove_wheel(tooth: Tooth) -> None:
    """Trim a wheel's tooth. Raises TrimError where it cannot be, or where none of the flank is left at an end of the face.

    Towards one end the generating normal's part n_x away from the wheel's axis falls to 0, where flanks are generated in an endless
    roll; beyond is another sheet of the envelope, which the hob generates from inside the wheel. Undercut may remove all of the
    flank before: its tip then lies beyond the singular points, turned inside out against mid face.
    """
    # the least work first, for most widths and tips that are tried for a steep thread fail at once; lands are least where the
    # throat ends, between the stations of the whole proof
    for stations in (PLACES, np.union1d(np.linspace(0.0, 1.0, LANDS), tooth.face_breaks)):
        tooth.prove_land(stations)
    _prove_generated(tooth)
    if tooth.has_loops:
        tooth.sections(BETWEEN)
    tooth.prove()


def _prove_generated(tooth: Tooth) -> None:
    """Raise TrimError where a wheel's tooth cannot be trimmed at the ends and in the middle of the face, or none of its flank is
    left there."""
    ends = np.array([0.0, 1.0])
    for which in Side:
        generation = tooth.side(which).generation
        assert generation is not None
        flank = generation[0]
        p, v = np.moveaxis(tooth.flank_grid(which, ends, PLACES).parameters, -1, 0)
        away = flank.tool.jet(*flank.on_tool(p, v)).n[..., 0].min(axis=0)
        density = area_density(flank.jet(p[1], v[1]))
        for lost, why in (
            (away <= 0.0, "the hob's flank has turned away from the wheel"),
            (density * density[1] <= 0.0, "the undercut removes all of the flank"),
        ):
            if lost.any():
                raise TrimError("flank", float(PLACES[int(np.argmax(lost))]), why)


@dataclass(frozen=True)
class Throat:
    """The tip of a wheel: a circle of `radius` mm about the worm's axis at the `distance` (mm), and the `outside` radius (mm)
    beyond; radius 0: a cylinder. With an `angle` (rad) its tangents stand for the circle: a cylinder and two cones of this angle to
    the axis.
    """

    radius: float
    distance: float
    outside: float
    angle: float | None = None

    def level(self, half: float) -> LandLevel:
        """The tip on a face of +-`half` mm. Raises DesignError for a throat that the face never meets."""
        if self.radius == 0.0:
            return ConeLevel.of(self.outside)
        height = self.distance - self.outside
        if not 0.0 < height < self.radius:
            raise VagueError(
                "wheel.outside_diameter",
                2.0 * self.outside,
                unit="mm",
                reason="the outside cylinder must lie between the throat, at "
                f"{at_least(2.0 * (self.distance - self.radius))} mm, and the worm's axis, at {at_most(2.0 * self.distance)} mm",
                remedies={"wheel.outside_diameter": 1 if height > 0.0 else -1},
            )
        if self.angle is not None:
            return self._tangents(self.angle, half)
        arc, corner = CircularMeridian((0.0, self.distance), self.radius), math.sqrt(self.radius**2 - height**2)
        if corner >= half:
            return Meridian(arc)
        straight = Straight(self.outside)
        return Meridian(Joined((straight, arc, straight), (-corner, corner)))

    def _tangents(self, angle: float, half: float) -> LandLevel:
        # tangents of a circle meet in the middle of the angle between them
        inner, slope = self.radius * math.tan(0.5 * angle), math.tan(angle)
        outer = inner + (self.outside - self.middle) / slope
        if inner >= half:
            return ConeLevel.of(self.middle)
        points = [(inner, self.middle), (outer, self.outside), (outer + half, self.outside)]
        joined = Joined.polyline(tuple([(-a, w) for a, w in points[::-1]] + points))
        return Meridian(joined)

    @property
    def middle(self) -> float:
        """Radius of the tip in the middle plane, mm."""
        return self.outside if self.radius == 0.0 else self.distance - self.radius
