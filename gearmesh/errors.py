"""Exceptions, and what every batched solve returns: values, a status and a residual for each of its members.

Bad input raises `DesignError` at construction; a solve never raises for one bad position but returns a
`Status` for it, and the caller decides (the command line turns "nothing converged" into `NoSolutionError`).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class GearmeshError(Exception):
    """Base of every error that gearmesh raises on purpose; its message is one clear line.

    A message that is work to find out is given as a function, which is called when somebody reads it; then `topic` says what it is
    about, to tell it from others. `remedies` are dotted keys of a design of which a
    larger (1) or smaller (-1) value, or either (0), may mend it.
    """

    exit_status = 1

    def __init__(
        self, message: str | Callable[[], str], topic: str | None = None, remedies: Mapping[str, int] | None = None
    ) -> None:
        super().__init__(message)
        self._topic, self.remedies = topic, remedies or {}

    @property
    def topic(self) -> str:
        """What went wrong, the same for the same trouble with other figures."""
        return re.split(r"\d", str(self), maxsplit=1)[0] if self._topic is None else self._topic

    def __str__(self) -> str:
        if callable(self.args[0]):
            self.args = (self.args[0](),)
        return str(self.args[0])

    def __reduce__(self) -> str | tuple[Any, ...]:
        str(self)
        return super().__reduce__()


class DesignError(GearmeshError):
    """Input that cannot be used: the message names the key, the value and what is allowed."""

    exit_status = 2


class FileError(DesignError):
    """A file that somebody hands in cannot be read or understood: no value of another key mends that."""


class VagueError(DesignError):
    """Geometry that cannot exist, noticed where it is not known which key is to blame, or how far it is off."""


class OutputError(GearmeshError):
    """A file that cannot be read or written, or a missing optional component needed to write it."""

    exit_status = 2


class NoSolutionError(GearmeshError):
    """A well-formed design without a solution; the message says where and why."""

    exit_status = 3


class Status(IntEnum):
    """Outcome of one member of a batched solve."""

    CONVERGED = 0
    MAX_ITERATIONS = 1
    SINGULAR = 2
    NOT_FINITE = 3
    NO_CONTACT = 4
    STALLED = 5
    JAMMED = 6

    @property
    def advice(self) -> str:
        """What to try when a solve ends like this."""
        return _ADVICE[self]


@dataclass(frozen=True)
class Solution:
    """What a solve found for its members (...,): `values` (...,) or (..., k) of the unknowns, Status codes, residuals (...,).

    A residual is the size of what the equations leave at the values, in the equations' units; CONVERGED members hold them
    to the solver's tolerance. Values of members that did not converge are where the solve ended, and may be NaN.
    `iterations` is the largest number used by a member.
    """

    values: NDArray[np.float64]
    status: NDArray[np.int64]
    residual: NDArray[np.float64]
    iterations: int

    @property
    def converged(self) -> NDArray[np.bool_]:
        """Members (...,) that hold their equations."""
        found: NDArray[np.bool_] = self.status == Status.CONVERGED
        return found


_ADVICE = {
    Status.CONVERGED: "nothing to do",
    Status.MAX_ITERATIONS: "start closer to the solution, or ask for more and smaller steps of phi1",
    Status.SINGULAR: "the surfaces touch along a line or the surface is undercut here; `gearmesh limits` tells where",
    Status.NOT_FINITE: "the surface is not defined at the parameters reached; reduce the range of phi1",
    Status.STALLED: "start closer to the solution: from here no step leads nearer to one",
    Status.JAMMED: "both sides of the teeth are in each other here, tips in fillets or roots: no rotation of the gear is free",
    Status.NO_CONTACT: "the trimmed flanks do not meet at this position; reduce the range of phi1 or the assembly errors",
}
