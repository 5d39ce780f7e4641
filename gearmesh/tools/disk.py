"""Disk-shaped tools that grind (or mill) helical gears: rack cutter -> helical tooth -> disk -> crowned tooth [LF04 17.6, 17.7].

The disk is a surface of revolution. It is in a tooth space of the gear, its axis crossing the gear's at the distance
E = r_p + r_d on the line x through the middle of the space, and lies along the teeth there, t = (0, sin beta, cos beta):

    gear                        middle of the space                disk
    axis along z at x = 0           x = r_p                axis along a = (0, cos beta, -sin beta) at x = E

1. The tooth that the rack generates determines the disk: turning about a by chi, it sweeps the disk's surface and touches it
   where n . (a x (r - O)) = 0, that is where its normal meets the disk's axis.
2. Fed along the gear's axis by s with the turn s / p of the gear, the disk generates the same tooth again; a plunge
   E - a_pl s^2, as that of the worm [LF04 17.7.8], crowns it along the face: n . w_s = 0.

Both are equations of meshing for the tooth of step 1 in one motion of two parameters, chi and s. So the crowned tooth is a
`FeedEnvelope` whose roll is the turn of the disk; the first equation depends neither on chi nor on s, only on where the
tooth is touched.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.envelope.feed_envelope import FeedEnvelope
from gearmesh.kernel.motion.feed_motion import FeedMotion
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.kernel.numeric.algebra import Array, plane_cross, polar_angle
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.kernel.surface.surface import Jet, PlacedSurface
from gearmesh.tools.description import Dimension, ToolDescription
from gearmesh.tools.drawing import TurnedDrawing
from gearmesh.tools.rack import RackSurface

#: steps to the place where a disk touches a helical tooth, each by a parabola: from 60 mm off to 1e-6 mm
ROUNDS = 4


@dataclass(frozen=True)
class Disk:
    """A disk for gears of `teeth` teeth, normal module `module` (mm) and helix angle `helix` (rad).

    `radius` r_d (mm) is the disk's where its line x meets the gear's pitch cylinder. That line is `aside` pitches off the
    middle of the tooth: 0.5 is the middle of the space, whose flanks and root one disk then grinds at once; 0.25 is the pitch
    point of the flank, where a disk of its own touches at the place of its feed and its plunge acts as the worm's does.
    Raises DesignError where the radius is no larger than the module: the disk's axis would run through the gear's tips.
    """

    radius: float
    teeth: int
    module: float
    helix: float
    aside: float = 0.5

    def __post_init__(self) -> None:
        if not self.radius > self.module:
            raise DesignError(
                "disk.pitch_radius", self.radius, unit="mm", must_be=f"above the normal module, {self.module:g} mm"
            )

    @property
    def gear_radius(self) -> float:
        """Pitch radius r_p (mm) of the gear."""
        return 0.5 * self.teeth * self.module / float(np.cos(self.helix))

    @property
    def crossing_angle(self) -> float:
        """Angle (rad) between the axes of disk and gear, 0 .. pi / 2."""
        return 0.5 * np.pi - abs(self.helix)

    def description(self, rack: ToolDescription) -> ToolDescription:
        """The disk of a rack cutter: heights of its profile are the rack's."""
        dimensions = (
            Dimension("pitch diameter", 2.0 * self.radius, "mm", "d_0"),
            Dimension("crossing angle", float(np.degrees(self.crossing_angle)), "deg", "Sigma_0"),
        )
        return replace(rack, name="grinding disk", drawing=TurnedDrawing(), dimensions=dimensions)

    def tooth(self, rack: RackSurface, plunge: float = 0.0, vertex: float = 0.0) -> FeedEnvelope:
        """Tooth surface ground by the disk of `rack`, parameters (rack's profile parameter, feed s in mm).

        `plunge` a_pl in 1/mm, `vertex` the feed (mm) where there is none: E - a_pl (s - vertex)^2. The frame is the gear's, as
        that of `RackRoll`: its axis is z, the tooth is on +x, and the disk in the space beside the rack's side of it. Without
        plunge it is the surface that the rack itself generates.
        """

        at_rest = self.grinding(rack.side).at_several(np.zeros(()), np.zeros(())).tool_to_blank
        determining = PlacedSurface(Envelope(rack, RackRoll(self.gear_radius)), at_rest.inverse)

        def start(u: Array, s: Array) -> tuple[Array, Array]:
            """Where the disk touches the helical tooth, from the transverse section through its centre: it turns only with plunge.

            Past a limiting line, where the line of action runs off, it would touch the tooth in another place too. The one that
            goes on from the sound flank is where the first equation rises with v: a root of a parabola's two.
            """
            v = -rack.jet(u, np.zeros_like(u)).r[..., 2] / np.cos(self.helix)
            for _ in range(ROUNDS):
                value, slope = _through_axis(determining.jet(u, v))
                bend = (_through_axis(determining.jet(u, v + self.module))[1] - slope) / self.module
                root = np.sqrt(np.maximum(slope**2 - 2.0 * bend * value, 0.0))
                with np.errstate(divide="ignore", invalid="ignore"):
                    v = v - 2.0 * value / (slope + root)
            return v, np.zeros_like(u)

        ground = FeedEnvelope(determining, self.grinding(rack.side, plunge, vertex), start)
        # what the plunge turns the disk by is small: three steps give it to rounding
        return replace(ground, start=ground.after_steps(3))

    def feed_at_mid_face(self, rack: RackSurface, p: float) -> float:
        """Feed (mm) at which the disk touches the point with the rack's profile parameter p at z = 0, without plunge.

        It stands there beside z = 0, on the other side of it for the other flank of the space.
        """
        return -float(self.tooth(rack).jet(np.array(p), np.array(0.0)).r[2])

    def rim(
        self, racks: tuple[RackSurface, RackSurface], p: float, plunge: float = 0.0, vertex: float = 0.0
    ) -> tuple[FeedEnvelope, tuple[float, float]]:
        """The root that the rim grinds, parameters (polar angle on the root cylinder, feed in mm), and its ends (rad).

        `racks`: right and left side; p: the profile parameter of their tip roundings where the tip plane begins. The space is
        the one at y < 0, beside the tooth's right side. The rim is determined by the root cylinder, touched where
        z = -E tan(beta) tan(angle), E the distance of the axes and the angle counted from the middle of the space.
        """
        right, left = (self.tooth(rack).jet(np.array(p), np.array(0.0)).r for rack in racks)
        cylinder = ConeLevel.of(float(np.hypot(right[0], right[1]))).surface
        motion = self.grinding(1, plunge, vertex)
        at_rest = self.grinding(1).at_several(np.zeros(()), np.zeros(())).tool_to_blank
        lead = (self.gear_radius + self.radius) * np.tan(self.helix)

        def start(u: Array, s: Array) -> tuple[Array, Array]:
            return -lead * np.tan(u - motion.angle0), np.zeros_like(u)

        ends = float(polar_angle(left)) - 2.0 * np.pi / self.teeth, float(polar_angle(right))
        return FeedEnvelope(PlacedSurface(cylinder, at_rest.inverse), motion, start), ends

    def section(self, rack: RackSurface, p: Array) -> tuple[Array, Array]:
        """The disk's axial section: radius and height (...,), mm, of its points at the rack's profile parameters p (...,).

        The height is counted from the disk's middle plane, positive towards +y of the gear.
        """
        x, y, z = np.moveaxis(self.tooth(rack).generation(p, np.zeros_like(p)).tool.r, -1, 0)
        return np.hypot(x, y), z

    def grinding(self, side: int, plunge: float = 0.0, vertex: float = 0.0) -> FeedMotion:
        """Motion of the disk's frame (x away from the gear, z its axis) over the gear's; `side` +1: in the space at y < 0.

        The roll is the turn of the disk (rad), the feed (mm) is along the gear's axis.
        """
        return FeedMotion(
            turn=0.0,
            tool_turn=1.0,
            feed_turn=(float(np.tan(self.helix)) / self.gear_radius,),
            path=(
                (self.gear_radius + self.radius - plunge * vertex**2, 0.0, 0.0),
                (2.0 * plunge * vertex, 0.0, 1.0),
                (-plunge, 0.0, 0.0),
            ),
            base=self._disk_axes,
            angle0=-side * self.aside * 2.0 * np.pi / self.teeth,
        )

    @cached_property
    def _disk_axes(self) -> Rigid:
        x, z = np.array([1.0, 0.0, 0.0]), np.array([0.0, np.cos(self.helix), -np.sin(self.helix)])
        return Rigid(np.stack((x, np.cross(z, x), z), axis=-1), np.zeros(3))


def _through_axis(jet: Jet) -> tuple[Array, Array]:
    """n . (e_z x r), 0 where the normal meets the z axis, and its derivative with respect to v, (...,) each."""
    return plane_cross(jet.r, jet.n), plane_cross(jet.r_v, jet.n) + plane_cross(jet.r, jet.n_v)
