"""Second routes to motions: those that are written out, through the general product."""

from __future__ import annotations

import numpy as np

from gearmesh import Rigid
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.kinds import Chain, CradleRoll, FeedMotion, RackRoll, Step


def as_chain(motion: RackRoll | CradleRoll | FeedMotion) -> Chain:
    """The same motion through the general product."""
    if isinstance(motion, RackRoll):
        return Chain((Step(rate=1.0), Step(offset=(motion.radius, 0.0, 0.0), velocity=(0.0, -motion.radius, 0.0))))
    if isinstance(motion, CradleRoll):
        start, rate, *higher = motion.turn
        blank = Step(rate=rate, angle0=start, higher=tuple(higher))
        (feed, *fed), (slide, *slid) = (each or ((0.0, 0.0, 0.0),) for each in (motion.feed, motion.slide))
        cradle = Step(rate=motion.sense, base=motion.base, velocity=feed, plunge=tuple(fed))
        (swivel, swivel_rate, *swivelled), (tilt, tilt_rate, *tilted) = (
            (*each, 0.0, 0.0) for each in (motion.swivel, motion.tilt)
        )
        tool = Step(
            rate=swivel_rate,
            angle0=swivel,
            offset=motion.centre,
            velocity=slide,
            plunge=tuple(slid),
            higher=tuple(swivelled),
        )
        # a turn about y is one about z in a frame turned by a right angle about x
        lain = Rigid(rotation_about("x", -0.5 * np.pi), np.zeros(3))
        lean = Step(rate=tilt_rate, angle0=tilt, base=lain, higher=tuple(tilted))
        return Chain((blank, cradle, tool, lean, Step(base=lain.inverse)), harmonic=True)
    rate, *higher = motion.feed_turn
    offset, velocity, *plunge = motion.path
    return Chain(
        (
            Step(rate=motion.turn, angle0=motion.angle0),
            Step(rate=rate, higher=tuple(higher), parameter=1),
            Step(offset=offset, velocity=velocity, plunge=tuple(plunge), parameter=1),
            Step(rate=motion.tool_turn, base=motion.base),
        )
    )
