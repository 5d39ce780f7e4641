"""The face gear that a worm grinds, fed along the shaper's axis: an envelope of roll and feed, against the shaped one [LF04 18.14].

Thread and gear touch in a point; over roll and feed these points cover the flank. Which ones of the thread these are says how
long the worm must be, and how far they stay from the thread's singular points.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearmesh.kernel.envelope.feed_envelope import FeedEnvelope
from gearmesh.kernel.motion.feed_motion import FeedMotion
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.face_gear.limits import ShapedGear
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.profile import Profile
from gearmesh.tools.shaper_worm import ShaperWorm

#: points along the face and across the profile at which ground and shaped flanks are compared
STATIONS, ACROSS = 25, 13
#: rounds from the section of the feed to that of the contact, which are Z apart
ROUNDS = 30
#: mm by which a section of the start may still change
SAME = 1e-9


@dataclass(frozen=True)
class Grinding:
    """A worm that grinds a face gear; `place` (mm): the middle of the face along the shaper's axis, where the feed is 0.

    `depth` (mm): how far it is displaced along the gear's axis; `swivelled` (rad): how much larger the angle between its axis and
    the shaper's is than where it grinds what the shaper generates.
    """

    shaped: ShapedGear
    worm: ShaperWorm
    place: float
    depth: float = 0.0
    swivelled: float = 0.0

    def own(self, side: Side) -> tuple[ShapedGear, ShaperWorm]:
        """Gear and worm whose right flank, or its mirror image, is that of a side."""
        right = side is Side.RIGHT
        return (self.shaped, self.worm) if right else (self.shaped.mirror_image, self.worm.mirror_image)

    def motion(self) -> FeedMotion:
        """Motion of the worm's frame over the gear's: the roll is the shaper's turn (rad), the feed (mm) along its axis."""
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
        """The worm's frame over the shaper's at its angle; x of both is the common perpendicular of their axes."""
        nominal = self.worm.to_shaper
        # its axis, along y, turns towards -z
        return Rigid(rotation_about("x", -self.swivelled) @ nominal.rotation, nominal.translation)

    def flank(self, side: Side) -> FeedEnvelope:
        """The ground flank in the gear's frame, parameters theta_s (rad) and the feed (mm)."""
        shaper = self.shaped.shaper

        def normal(theta: Array) -> tuple[Array, Array]:
            return shaper.theta_0 + theta, np.full_like(theta, shaper.base_radius)

        return self._envelope(side, shaper.involute, normal)

    def fillet(self, side: Side) -> FeedEnvelope:
        """The ground fillet, parameters those of the shaper's tip rounding and the feed (mm)."""
        shaper = self.shaped.shaper

        def normal(q: Array) -> tuple[Array, Array]:
            at = np.array([shaper.pitch_radius, 0.0]) - shaper.rounding.section(q)[0]
            return q, at[..., 0] * np.cos(q) + at[..., 1] * np.sin(q)

        return self._envelope(side, shaper.rounding, normal)

    def _envelope(self, side: Side, profile: Profile, normal: Callable[[Array], tuple[Array, Array]]) -> FeedEnvelope:
        """What the thread of a profile of the shaper generates; of its `normal` the angle (rad) in the shaper's section and how
        far (mm) it passes from the shaper's axis, by the profile's parameter."""
        gear, worm = self.own(side)

        def start(u: Array, feed: Array) -> tuple[Array, Array]:
            """Where the lines of contact of shaper and gear and of shaper and worm cross."""
            angle, arm = normal(np.asarray(u, dtype=float))
            z = self.place + np.asarray(feed, dtype=float)
            for _ in range(ROUNDS):
                kappa = gear.pressure_angle(z, arm)
                before, z = z, self.place + feed + worm.along_arm(kappa, arm)[0]
                if not (np.abs(z - before) > SAME).any():
                    break
            return worm.along_arm(kappa, arm)[0], side.sign * (kappa - angle)

        return FeedEnvelope(self.worm.thread(profile, side.sign), self.motion(), start)

    def grind(self, tooth: Tooth) -> Tooth:
        """A shaped tooth with ground flanks and fillets instead."""
        right, left = (self._grind_side(tooth.side(side), side) for side in Side)
        return replace(tooth, right=right, left=left)

    def _grind_side(self, side: ToothSide, which: Side) -> ToothSide:
        flank, fillet = self.flank(which), self.fillet(which)
        return replace(side, flank=flank, fillet=fillet, tool=self.worm.description, generation=(flank, fillet))

    def difference(self, tooth: Tooth) -> float:
        """Largest distance (mm) of the ground flanks from the shaped ones, at points of the trimmed tooth."""
        distances = []
        for side in Side:
            surface, grid = tooth.side(side).flank, tooth.flank_grid(side, *self._places)
            assert grid.p is not None
            assert grid.v is not None
            worm, kappa = self._kappa(side, grid.v)
            ground = self.flank(side).generation(grid.p, grid.v - worm.along(kappa))
            apart = ground.state.tool_to_blank.point(ground.tool.r) - surface.jet(grid.p, grid.v).r
            distances.append(np.linalg.norm(apart, axis=-1).max())
        return float(max(distances))

    def contact(self, tooth: Tooth, side: Side) -> tuple[Array, Array]:
        """theta_s and kappa (rad), (S, T) each, of the thread's points that grind a trimmed flank."""
        grid = tooth.flank_grid(side, *self._places)
        assert grid.p is not None
        assert grid.v is not None
        return grid.p, self._kappa(side, grid.v)[1]

    def reach(self, tooth: Tooth) -> tuple[float, float]:
        """Lowest and highest place (mm) along the worm's axis of the points that grind a trimmed tooth."""
        places = [side.sign * self.own(side)[1].place(*self.contact(tooth, side)) for side in Side]
        return float(min(place.min() for place in places)), float(max(place.max() for place in places))

    def reserve(self, tooth: Tooth) -> float:
        """Least pressure angle (rad) of the points that grind, beyond that of the thread's singular points."""
        reserves = []
        for side in Side:
            theta, kappa = self.contact(tooth, side)
            singular = self.own(side)[1].singular_kappa(theta.ravel())
            reserves.append(float((kappa.ravel() - singular).min()))
        return min(reserves)

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        return np.linspace(0.0, 1.0, ACROSS), np.linspace(0.0, 1.0, STATIONS)

    def _kappa(self, side: Side, v: Array) -> tuple[ShaperWorm, Array]:
        gear, worm = self.own(side)
        return worm, gear.pressure_angle(self.place + v)
