"""Effort: evaluations of generated surfaces, and in searches for roots, counted, so that a search ends where no clock decides.

It is counted in seconds of a processor of 2023, about, and the same for the same work on every machine.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

#: effort of an evaluation of a motion and of each of its points, where the motion is linear in its parameter, and otherwise
LINEAR, OTHER = (1e-4, 5e-7), (1.5e-4, 6e-7)


class EffortSpentError(Exception):
    """The effort allowed is spent."""


@dataclass
class Effort:
    """Effort that is left."""

    left: float

    @property
    def spent(self) -> bool:
        return self.left <= 0.0


_limit: ContextVar[Effort | None] = ContextVar("effort", default=None)


@contextmanager
def limit_effort(effort: Effort) -> Iterator[None]:
    """Raise EffortSpentError from what is computed inside as soon as the effort is spent."""
    token = _limit.set(effort)
    try:
        yield
    finally:
        _limit.reset(token)


def spend(points: int, evaluations: int, *, linear: bool) -> None:
    """Count evaluations of a motion, each at so many points, or of what costs as much as a `linear` one."""
    effort = _limit.get()
    if effort is None:
        return
    call, point = LINEAR if linear else OTHER
    effort.left -= evaluations * (call + points * point)
    if effort.spent:
        raise EffortSpentError
