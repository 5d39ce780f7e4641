"""Worms that grind (or hob) helical gears: rack cutter -> thread of the worm -> tooth of the gear [LF04 17.7].

The skew rack cutter generates gear and worm at once, on either side of its pitch plane. Its frame S_c is fixed in
space: x points from the gear to the worm, z along the gear's axis, and the teeth run along t = (0, sin beta, cos beta):

    gear                       rack's pitch plane x = 0                worm
    axis along z at x = -r_p        teeth along t              axis in the plane x = r_w

1. The rack moves across the worm's axis with v_2 = omega_w r_w [LF04 17.7.4], and along y with v_1 = omega_p r_p for
   the gear [LF04 17.7.3]. Both are the same motion of its surface, because they differ by a motion along t.
2. Their components across the teeth agree if the worm's lead angle is sin(lambda) = threads m_n / (2 r_w). Then the
   worm turns teeth / threads times as fast [LF04 17.7.5].
3. The thread of the worm touches the gear's tooth in a point. The worm is fed along the gear's axis by s while the gear
   turns by s / p [LF04 17.7.6], and generates the same tooth as the rack. A plunge E - a_pl s^2 [LF04 17.7.8] or a
   modified roll s / p + a_mr s^2 [LF04 17.7.9] crowns the tooth along the face.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.envelope.feed_envelope import FeedEnvelope
from gearmesh.kernel.motion.feed_motion import FeedMotion
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import PlacedSurface
from gearmesh.records import dataclass
from gearmesh.tools.description import Dimension, ToolDescription
from gearmesh.tools.drawing import PartDrawing
from gearmesh.tools.rack import RackSurface


@dataclass(frozen=True)
class Worm:
    """A worm that grinds helical gears. Raises DesignError if its pitch radius allows no lead angle."""

    #: pitch radius of the worm, mm
    radius: float
    #: number of threads
    threads: int
    #: number of teeth of the gear
    teeth: int
    #: normal module of the gear, mm
    module: float
    #: helix angle of the gear, rad
    helix: float
    #: +1 for right-hand threads, -1 for left-hand threads
    hand: int = 1

    def __post_init__(self) -> None:
        if not 0.5 * self.threads * self.module < self.radius:
            least = 0.5 * self.threads * self.module
            raise DesignError(
                "worm.pitch_radius", self.radius, unit="mm", must_be=Allowed.more_than(least, "mm", "threads m_n / 2")
            )

    @property
    def gear_radius(self) -> float:
        """Pitch radius r_p (mm) of the gear."""
        return 0.5 * self.teeth * self.module / float(np.cos(self.helix))

    @property
    def lead_angle(self) -> float:
        """Lead angle (rad) on the worm's pitch cylinder."""
        return float(np.arcsin(0.5 * self.threads * self.module / self.radius))

    @cached_property
    def _along(self) -> Array:
        """Direction t (3,) of the rack's teeth."""
        return np.array([0.0, np.sin(self.helix), np.cos(self.helix)])

    @cached_property
    def rack_to_aligned(self) -> Rigid:
        """Rotation of S_c after which the worm's axis is parallel to z, at negative x, and the rack moves along -y."""
        across = np.array([0.0, np.cos(self.helix), -np.sin(self.helix)])
        y = np.sin(self.lead_angle) * across - self.hand * np.cos(self.lead_angle) * self._along
        x = np.array([-1.0, 0.0, 0.0])
        return Rigid(np.stack((x, y, np.cross(x, y))), np.zeros(3))

    @property
    def crossing_angle(self) -> float:
        """Angle (rad) between the axes of worm and gear, 0 .. pi / 2."""
        return float(np.arccos(abs(self.rack_to_aligned.rotation[2, 2])))

    @cached_property
    def roll(self) -> float:
        """Turns of the worm per turn of the gear, signed; the magnitude is teeth / threads [LF04 17.7.5]."""
        y = self.rack_to_aligned.rotation[1]
        across = np.array([0.0, np.cos(self.helix), -np.sin(self.helix)])
        return float(self.gear_radius * across[1] / (self.radius * (y @ across)))

    def description(self, behind: ToolDescription) -> ToolDescription:
        """Return the description of the worm for a rack cutter or shaper `behind` it, with the same profile heights."""
        return replace(behind, name="grinding worm", drawing=PartDrawing(), dimensions=self.dimensions)

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        return (
            Dimension("threads", float(self.threads), "", "z_0"),
            Dimension("pitch diameter", 2.0 * self.radius, "mm", "d_0"),
            Dimension("lead angle", float(np.degrees(self.lead_angle)), "deg", "gamma_0"),
        )

    def thread(self, rack: RackSurface) -> Envelope:
        """Return the thread surface generated by a rack cutter, in the worm's frame (z its axis).

        Its parameters are the rack's.
        """
        return Envelope(PlacedSurface(rack, self.rack_to_aligned), RackRoll(self.radius))

    def tooth(self, rack: RackSurface, plunge: float = 0.0, modified_roll: float = 0.0) -> FeedEnvelope:
        """Return the tooth surface generated by the thread of `rack`; parameters: the rack's p and the feed s (mm).

        `plunge` is a_pl, 1/mm, and `modified_roll` is a_mr, rad/mm^2. The frame is the gear's, as in `RackRoll`: its
        axis is z, the tooth is on +x. With both 0 the surface is the surface that the rack generates.
        """
        thread, gear = self.thread(rack), Envelope(rack, RackRoll(self.gear_radius))
        # difference of the rack's two motions: a slide along its teeth, mm per rad of the gear
        slide = self.gear_radius * self._along[1] - self.radius * self.roll * (
            self.rack_to_aligned.rotation[1] @ self._along
        )

        def start(u: Array, s: Array) -> tuple[Array, Array]:
            """Return the common point of the contact lines rack - gear and rack - thread.

            Both equations are linear in v.
            """

            def apart(v: Array) -> Array:
                phi = gear.parameter(u, v)
                return thread.parameter(u, v - slide * phi) - self.roll * phi

            # `apart` is linear in v: its root follows from two values
            zero = np.zeros_like(u)
            at_zero, at_one = apart(zero), apart(zero + 1.0)
            v = at_zero / (at_zero - at_one)
            phi = gear.parameter(u, v)
            return v - slide * phi, phi

        return FeedEnvelope(thread, self.grinding(plunge, modified_roll), start)

    def grinding(self, plunge: float = 0.0, modified_roll: float = 0.0) -> FeedMotion:
        """Return the motion of the worm's frame over the gear's frame.

        The roll is the gear's turn (rad), the feed (mm) is along the gear's axis.
        """
        # x of the worm's frame points towards the rack's pitch plane; the worm's axis is r_w beyond this plane
        to_fixed = self.rack_to_aligned.inverse.rotation
        axis = self.gear_radius + self.radius
        return FeedMotion(
            turn=1.0,
            tool_turn=-self.roll,
            feed_turn=(self._along[1] / (self._along[2] * self.gear_radius), modified_roll),
            path=((axis, 0.0, 0.0), (0.0, 0.0, 1.0), (-plunge, 0.0, 0.0)),
            base=Rigid(to_fixed, np.zeros(3)),
        )
