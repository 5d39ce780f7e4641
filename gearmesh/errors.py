"""Exceptions, and the result of batched solvers: values, a status and a residual for each member of the batch.

Bad input raises `DesignError` when a design is built. A solver does not raise for a single bad position but returns a `Status` for
it, and the caller decides (a command turns "nothing converged" into `NoSolutionError`).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Mapping
from copy import copy
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, Self

from gearmesh.allowed import Allowed, Bounds, has_bound, in_unit, stated_bounds

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: least likeness of a misspelt word and the suggested word
MIN_LIKENESS = 0.55
#: least likeness of a key of a figure and the suggested key: people shorten these long keys
MIN_KEY_LIKENESS = 0.2
#: characters of figures
_FIGURE_CHARACTERS = str.maketrans("", "", "0123456789.-+")


class GearmeshError(Exception):
    """Base class of all errors that gearmesh raises on purpose; the message is one line made of the fields.

    - `key`: refused key of a design, argument of a call, or part of the gears; `entry`: refused entry of an argument with several
    - `value`: refused value in `unit`; `shown`: text of the value in the message, if it differs
    - `reason`: reason of the refusal; `allowed`: allowed values, or `must_be` with the same meaning; `remedy`: advice
    - `more`: number of other refusals; `topic`: kind of the refusal, equal for refusals that differ only in figures
    - `remedies`: keys of a design that may mend it by a larger (1) or smaller (-1) value, or by either (0)
    - `excess`: distance of the checked figure beyond its limit
    """

    exit_status = 1
    #: True if `key` is an argument of a call
    of_argument = False
    #: unit of lengths in the message, and its length in mm; fields are in mm
    lengths_in = ("mm", 1.0)
    #: conflict of two keys as a refusal of the other key
    other_side: GearmeshError | None = None

    def __init__(
        self,
        key: str | os.PathLike[str] = "",
        value: Any = None,
        *,
        entry: str = "",
        unit: str = "",
        shown: str | None = None,
        reason: str = "",
        allowed: str = "",
        must_be: str = "",
        remedy: str = "",
        more: int = 0,
        topic: str | None = None,
        remedies: Mapping[str, int] | None = None,
        excess: float | None = None,
    ) -> None:
        super().__init__()
        self.key, self.entry, self.unit, self.shown, self.remedy, self.more = str(key), entry, unit, shown, remedy, more
        self.value = value.item() if hasattr(value, "item") and getattr(value, "ndim", 1) == 0 else value
        self.reason, self.allowed, self._said = reason, allowed or must_be, not must_be
        self._topic, self.remedies, self._excess = topic, dict(remedies or {}), excess

    @classmethod
    def later(cls, tell: Callable[[], GearmeshError], topic: str) -> Self:
        """Return a refusal whose fields are computed when they are first read.

        Parameters
        ----------
        tell : callable
            Function that makes the refusal with all fields.
        topic : str
            Kind of the refusal.

        Returns
        -------
        GearmeshError
            Error of the same class.

        Examples
        --------
        >>> str(gm.DesignError.later(lambda: gm.DesignError("teeth", 1, allowed="2 or more"), "teeth"))
        'teeth = 1: allowed is 2 or more'
        """
        made = cls.__new__(cls)
        made.__dict__.update(_tell=tell, _topic=topic, remedies={})
        return made

    def __getattr__(self, name: str) -> Any:
        """Compute the fields of a refusal that `later` made."""
        tell = None if name.startswith("__") else self.__dict__.pop("_tell", None)
        if tell is None:
            raise AttributeError(name)
        self.__dict__.update({**tell().__dict__, "_topic": self._topic})
        return getattr(self, name)

    @property
    def topic(self) -> str:
        """Kind of the refusal, equal for refusals that differ only in figures."""
        return f"{self.key}: {self.reason.translate(_FIGURE_CHARACTERS)}" if self._topic is None else self._topic

    @property
    def excess(self) -> float | None:
        """Distance of the checked figure beyond its limit, 0 at the limit; searches for a bound use it.

        Returns
        -------
        float or None
            Distance in any unit, the same unit for the same topic; None if no figure is known.

        Examples
        --------
        >>> gm.DesignError("bore", 50.0, unit="mm", allowed="less than the root, 31 mm").excess
        19.0
        """
        known: float | None = self.__dict__.get("_excess")
        if known is None and isinstance(self.__cause__, GearmeshError):
            known = self.__cause__.excess
        if known is not None or "_tell" in self.__dict__ or isinstance(self.value, bool):
            return known
        bounds = self.bounds
        if bounds is None or not isinstance(self.value, int | float):
            return None
        ends = ((bounds.low, 1.0), (bounds.high, -1.0))
        beyond = (inwards * (end - self.value) for end, inwards in ends if end is not None)
        return max((apart for apart in beyond if apart >= 0.0), default=None)

    @property
    def bounds(self) -> Bounds | None:
        """Bounds of the value in `allowed`; None if it has no bounds, or bounds of another quantity.

        Returns
        -------
        Bounds or None
            Bounds in the unit that `allowed` names.

        Examples
        --------
        >>> gm.DesignError("bore", 50.0, unit="mm", allowed="less than the root, 31 mm").bounds.high
        31.0
        """
        return self.allowed.bounds if isinstance(self.allowed, Allowed) else stated_bounds(self.allowed)

    @property
    def bounds_another(self) -> bool:
        """True if `allowed` begins with bounds of another quantity than the value; "0 or at least 5 mm" does not.

        Returns
        -------
        bool
            False also if `allowed` has no bounds.

        Examples
        --------
        >>> gm.DesignError("addendum", 4.0, allowed="a tip diameter of at most 46.067 mm").bounds_another
        True
        """
        return self.bounds is None and not self.allowed[:1].isdigit() and has_bound(self.allowed)

    @property
    def subject(self) -> str:
        """Refused key and value as in the message."""
        name = f"{self.key} {self.entry}".strip()
        shown = name if self.value is None else f"{name} = {self.shown or shown_value(self.value, self.unit)}"
        return in_unit(shown, *self.lengths_in)

    def rename(self, key: str) -> Self:
        """Return the same refusal under another key.

        Parameters
        ----------
        key : str
            Name for the reader of the message.

        Returns
        -------
        GearmeshError
            Error of the same class.

        Examples
        --------
        >>> gm.DesignError("teeth", 1, allowed="2 or more").rename("pinion.teeth").key
        'pinion.teeth'
        """
        made = copy(self)
        made.key = key
        return made

    def facing(self, changed: Iterable[str]) -> GearmeshError:
        """Return the refusal that names a changed key, if the refusal is a conflict of this key with an unchanged key.

        Parameters
        ----------
        changed : iterable of str
            Dotted keys and tables that were changed.

        Returns
        -------
        GearmeshError
            The same refusal, or its `other_side`.

        Examples
        --------
        >>> gm.DesignError("teeth", 1, allowed="2 or more").facing(["teeth"]).key
        'teeth'
        """
        tables = tuple(f"{key}." for key in changed)
        other = self.other_side
        if other is None or f"{self.key}.".startswith(tables) or not f"{other.key}.".startswith(tables):
            return self
        return other

    def __str__(self) -> str:
        allowed = f"{'allowed is' if self._said else 'must be'} {self.allowed}" if self.allowed else ""
        why = "; ".join(part for part in (self.reason, allowed) if part)
        line = ": ".join(part for part in (self.subject, why, self.remedy) if part)
        line = in_unit(line, *self.lengths_in)
        return f"{line} (and {self.more} more)" if self.more else line

    def __repr__(self) -> str:
        fields = {
            name: getattr(self, name) for name in ("key", "entry", "value", "unit", "reason", "allowed", "remedy")
        }
        told = ", ".join(f"{name}={value!r}" for name, value in fields.items() if value not in ("", None))
        return f"{type(self).__name__}({told})"

    def __reduce__(self) -> tuple[Any, ...]:
        """Return plain fields, so that errors return from other processes."""
        told = self.key is not None
        assert told, "reading a field makes all of them known"
        return _restore, (type(self), self.__dict__.copy())


def _restore(kind: type[GearmeshError], fields: dict[str, Any]) -> GearmeshError:
    made = kind.__new__(kind)
    made.__dict__.update(fields)
    return made


def shown_value(value: Any, unit: str = "") -> str:
    """Return a value with its unit as text for messages."""
    if isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, float):
        text = f"{value:.7g}"
    elif isinstance(value, list | tuple):
        text = ",".join(map(shown_value, value)) or "[]"
    else:
        text = str(value)
    return f"{text} {unit}".rstrip()


def nearest(word: str, known: Iterable[str], likeness: float = MIN_LIKENESS) -> str | None:
    """Return the known word that is most like a misspelt word; None without a similar word."""
    import difflib

    return next(iter(difflib.get_close_matches(word, list(known), n=1, cutoff=likeness)), None)


class DesignError(GearmeshError):
    """Input that cannot be used, with key, value and allowed values."""

    exit_status = 2


class ArgumentError(DesignError):
    """Argument of a call that cannot be used; a command names its option instead."""

    of_argument = True


class FileError(DesignError):
    """Input file that cannot be read or understood; no value of another key mends it."""


class VagueError(DesignError):
    """Geometry that cannot exist, found where the responsible key or its bound is not known."""


class OutputError(GearmeshError):
    """File (`value`) that cannot be read or written, or a missing component for it; `key` names the attempt."""

    exit_status = 2

    @property
    def subject(self) -> str:
        """Attempt and file as in the message."""
        return super().subject if not self.key.startswith("cannot ") else f"{self.key} {self.shown or self.value}"


class OutputArgumentError(OutputError):
    """File or component, named by an argument of a call, that cannot be used."""

    of_argument = True


class UnknownFigureError(ArgumentError, KeyError):
    """Key of a figure that a result does not have."""

    @classmethod
    def among(cls, key: Any, known: Collection[str]) -> Self:
        """Return the refusal of a key that is not in `known`, with the key that is probably meant."""
        begins = (name for name in known if isinstance(key, str) and key and name.startswith(key))
        close = next(begins, None) or nearest(str(key), known, MIN_KEY_LIKENESS)
        hint = f"did you mean {close}?" if close else f"there are {', '.join(known) or 'none'}"
        return cls("key", key, reason=f"there is no figure of this name; {hint}")


class KindError(GearmeshError):
    """Fault of a gear system, not of a design: surfaces, motions or bodies that contradict each other."""

    exit_status = 3


class NoSolutionError(GearmeshError):
    """Valid design without a solution; the message names place and reason."""

    exit_status = 3


class Status(IntEnum):
    """Outcome of a solve for one member of a batch."""

    CONVERGED = 0
    MAX_ITERATIONS = 1
    SINGULAR = 2
    NOT_FINITE = 3
    NO_CONTACT = 4
    STALLED = 5
    JAMMED = 6

    @property
    def advice(self) -> str:
        """Advice for a solve with this outcome."""
        return _ADVICE_BY_STATUS[self]


@dataclass(frozen=True)
class Solution:
    """Result of a batched solve with members (...,)."""

    #: unknowns (...,) or (..., k); of members that did not converge, the last values of the solve, which may be NaN
    values: NDArray[np.float64]
    #: codes (...,) of `Status`
    status: NDArray[np.int64]
    #: residuals (...,) of the equations at the values, in their units; below the solver's tolerance for CONVERGED members
    residual: NDArray[np.float64]
    #: greatest number of iterations of a member
    iterations: int

    @property
    def converged(self) -> NDArray[np.bool_]:
        """True (...,) for members whose equations hold."""
        held: NDArray[np.bool_] = self.status == Status.CONVERGED
        return held


_ADVICE_BY_STATUS = {
    Status.CONVERGED: "nothing to do",
    Status.MAX_ITERATIONS: "start closer to the solution, or choose more and smaller steps of phi1",
    Status.SINGULAR: "the surfaces touch along a line or the surface is undercut here; `gearmesh limits` shows where",
    Status.NOT_FINITE: "the surface is not defined at the parameters reached; reduce the range of phi1",
    Status.STALLED: "start closer to the solution: no step from here comes closer to one",
    Status.JAMMED: "the teeth overlap, tips in fillets, roots or other tips: the gears cannot turn",
    Status.NO_CONTACT: "the trimmed flanks do not meet at this position; reduce the range of phi1 or the assembly errors",
}
