"""Grinding of a face gear by a worm fed along the shaper's axis: envelope of roll and feed [LF04 18.14].

Thread and gear touch in a point. Over roll and feed these points cover the flank. Their positions on the thread
determine how long the worm must be, and how far they are from the thread's singular points.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

from gearmesh.kernel.envelope.feed_envelope import FeedEnvelope
from gearmesh.kernel.motion.feed_motion import FeedMotion
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.records import dataclass
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.face_gear.limits import ShapedGear
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.profile import Profile
from gearmesh.tools.shaper_worm import ShaperWorm

#: number of points along the face at which ground and shaped flanks are compared
FACE_STATIONS = 25
#: number of points across the profile at which ground and shaped flanks are compared
PROFILE_POINTS = 13
#: largest number of steps from the section of the feed to the section of the contact, Z apart
MAX_START_ROUNDS = 30
#: change (mm) of the section at which the start value is accepted
START_TOLERANCE_MM = 1e-9


@dataclass(frozen=True)
class Grinding:
    """A worm that grinds a face gear."""

    #: the gear that the shaper generates
    shaped: ShapedGear
    #: the worm
    worm: ShaperWorm
    #: position of the middle of the face along the shaper's axis, where the feed is 0, mm
    place: float
    #: displacement of the worm along the gear's axis, mm
    depth: float = 0.0
    #: excess of the angle between the axes of worm and shaper over the angle at which the worm grinds the shaped flank,
    #: rad
    swivelled: float = 0.0

    def own(self, side: Side) -> tuple[ShapedGear, ShaperWorm]:
        """Return gear and worm whose right flank, or its mirror image, is the flank of a side."""
        right = side is Side.RIGHT
        return (self.shaped, self.worm) if right else (self.shaped.mirror_image, self.worm.mirror_image)

    def motion(self) -> FeedMotion:
        """Return the motion of the worm's frame over the gear's.

        The roll is the shaper's rotation (rad); the feed (mm) is along the shaper's axis.
        """
        base, tool = gear_base(self.shaped.shaft_angle, -self.shaped.offset).inverse, self.worm_to_shaper
        start = base.point(tool.translation + np.array([0.0, 0.0, self.place])) + np.array([0.0, 0.0, self.depth])
        return FeedMotion(
            turn=self.shaped.ratio,
            tool_turn=self.worm.turn,
            feed_turn=(),
            path=((start[0], start[1], start[2]), (*base.rotation[:, 2].tolist(),)),
            base=Rigid(base.rotation @ tool.rotation, np.zeros(3)),
            angle0=-self.shaped.lean(self.place),
        )

    @property
    def worm_to_shaper(self) -> Rigid:
        """Worm's frame in the shaper's frame; x of both is the common perpendicular of their axes."""
        nominal = self.worm.to_shaper
        # the worm's axis, along y, turns towards -z
        return Rigid(rotation_about("x", -self.swivelled) @ nominal.rotation, nominal.translation)

    def flank(self, side: Side) -> FeedEnvelope:
        """Return the ground flank in the gear's frame, with parameters theta_s (rad) and feed (mm)."""
        shaper = self.shaped.shaper

        def normal(theta: Array) -> tuple[Array, Array]:
            return shaper.theta_0 + theta, np.full_like(theta, shaper.base_radius)

        return self._envelope(side, shaper.involute, normal)

    def fillet(self, side: Side) -> FeedEnvelope:
        """Return the ground fillet, with the parameter of the shaper's tip rounding and the feed (mm)."""
        shaper = self.shaped.shaper

        def normal(q: Array) -> tuple[Array, Array]:
            point = np.array([shaper.pitch_radius, 0.0]) - shaper.rounding.section(q)[0]
            return q, point[..., 0] * np.cos(q) + point[..., 1] * np.sin(q)

        return self._envelope(side, shaper.rounding, normal)

    def _envelope(self, side: Side, profile: Profile, normal: Callable[[Array], tuple[Array, Array]]) -> FeedEnvelope:
        """Return the surface that the thread of a profile of the shaper generates.

        `normal` returns, by the profile's parameter, the angle (rad) of the profile's normal in the shaper's section,
        and its distance (mm) from the shaper's axis.
        """
        gear, worm = self.own(side)

        def start(u: Array, feed: Array) -> tuple[Array, Array]:
            """Return start values where the contact line of shaper and gear crosses that of shaper and worm."""
            angle, arm = normal(np.asarray(u, dtype=float))
            z = self.place + np.asarray(feed, dtype=float)
            for _ in range(MAX_START_ROUNDS):
                kappa = gear.pressure_angle(z, arm)
                last_z, z = z, self.place + feed + worm.along_arm(kappa, arm)[0]
                if not (np.abs(z - last_z) > START_TOLERANCE_MM).any():
                    break
            return worm.along_arm(kappa, arm)[0], side.sign * (kappa - angle)

        return FeedEnvelope(self.worm.thread(profile, side.sign), self.motion(), start)

    def grind(self, tooth: Tooth) -> Tooth:
        """Return a shaped tooth with ground flanks and fillets."""
        right, left = (self._grind_side(tooth.side(side), side) for side in Side)
        return replace(tooth, right=right, left=left)

    def _grind_side(self, side: ToothSide, flank_side: Side) -> ToothSide:
        """Return one side of a shaped tooth with ground flank and fillet."""
        flank, fillet = self.flank(flank_side), self.fillet(flank_side)
        return replace(side, flank=flank, fillet=fillet, tool=self.worm.description, generation=(flank, fillet))

    def difference(self, tooth: Tooth) -> float:
        """Return the largest distance (mm) of the ground flanks from the shaped flanks, at points of the trimmed tooth."""
        distances = []
        for side in Side:
            surface, grid = tooth.side(side).flank, tooth.flank_grid(side, *self._places)
            assert grid.p is not None
            assert grid.v is not None
            worm, kappa = self._kappa(side, grid.v)
            ground = self.flank(side).generation(grid.p, grid.v - worm.along(kappa))
            distance = ground.state.tool_to_blank.point(ground.tool.r) - surface.jet(grid.p, grid.v).r
            distances.append(np.linalg.norm(distance, axis=-1).max())
        return float(max(distances))

    def contact(self, tooth: Tooth, side: Side) -> tuple[Array, Array]:
        """Return theta_s and kappa (rad), (S, T) each, of the thread's points that grind a trimmed flank."""
        grid = tooth.flank_grid(side, *self._places)
        assert grid.p is not None
        assert grid.v is not None
        return grid.p, self._kappa(side, grid.v)[1]

    def reach(self, tooth: Tooth) -> tuple[float, float]:
        """Return the lowest and highest position (mm) along the worm's axis of points that grind a trimmed tooth."""
        places = [side.sign * self.own(side)[1].place(*self.contact(tooth, side)) for side in Side]
        return float(min(positions.min() for positions in places)), float(max(positions.max() for positions in places))

    def reserve(self, tooth: Tooth) -> float:
        """Return the least pressure angle (rad) of the grinding points, beyond that of the thread's singular points."""
        reserves = []
        for side in Side:
            theta, kappa = self.contact(tooth, side)
            singular = self.own(side)[1].singular_kappa(theta.ravel())
            reserves.append(float((kappa.ravel() - singular).min()))
        return min(reserves)

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        """Shares across the profile and along the face of the points of comparison."""
        return np.linspace(0.0, 1.0, PROFILE_POINTS), np.linspace(0.0, 1.0, FACE_STATIONS)

    def _kappa(self, side: Side, v: Array) -> tuple[ShaperWorm, Array]:
        """Return the worm of a side, and pressure angles at positions v (mm) from the middle of the face."""
        gear, worm = self.own(side)
        return worm, gear.pressure_angle(self.place + v)
