"""Effort: a count of evaluations of generated surfaces and of root searches, which ends a search without a clock.

The unit is about one second of a processor of 2023. The same work has the same effort on every machine.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

#: effort of one evaluation, and of each of its points, of a motion linear in its parameter
EFFORT_OF_LINEAR_MOTION = (1e-4, 5e-7)
#: effort of one evaluation, and of each of its points, of any other motion
EFFORT_OF_OTHER_MOTION = (1.5e-4, 6e-7)


class EffortSpentError(Exception):
    """The allowed effort is spent."""


@dataclass
class Effort:
    """Remaining effort; `left` decreases as work is counted."""

    left: float

    @property
    def spent(self) -> bool:
        return self.left <= 0.0


_limit: ContextVar[Effort | None] = ContextVar("effort", default=None)


@contextmanager
def limit_effort(effort: Effort) -> Iterator[None]:
    """Raise EffortSpentError from the computation inside the block as soon as the effort is spent."""
    token = _limit.set(effort)
    try:
        yield
    finally:
        _limit.reset(token)


def spend(points: int, evaluations: int, *, linear: bool) -> None:
    """Count `evaluations` of a motion, each at `points` points, against the effort limit.

    `linear` is true for a motion linear in its parameter, and for other work that costs as much. Raises
    EffortSpentError.
    """
    effort = _limit.get()
    if effort is None:
        return
    call, point = EFFORT_OF_LINEAR_MOTION if linear else EFFORT_OF_OTHER_MOTION
    effort.left -= evaluations * (call + points * point)
    if effort.spent:
        raise EffortSpentError
