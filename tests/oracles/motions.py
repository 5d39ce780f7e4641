"""Second routes to motions: those that are written out, through the general product."""

from __future__ import annotations

from gearmesh.kernel import Chain, CradleRoll, FeedMotion, RackRoll, Step


def as_chain(motion: RackRoll | CradleRoll | FeedMotion) -> Chain:
    """The same motion through the general product."""
    if isinstance(motion, RackRoll):
        return Chain((Step(rate=1.0), Step(offset=(motion.radius, 0.0, 0.0), velocity=(0.0, -motion.radius, 0.0))))
    if isinstance(motion, CradleRoll):
        start, rate, *higher = motion.turn
        blank = Step(rate=rate, angle0=start, higher=tuple(higher))
        return Chain((blank, Step(rate=motion.sense, base=motion.base), Step(offset=motion.centre)), harmonic=True)
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
