"""Exceptions, and what every batched solve returns: values, a status and a residual for each of its members.

Bad input raises `DesignError` at construction; a solve never raises for one bad position but returns a
`Status` for it, and the caller decides (the command line turns "nothing converged" into `NoSolutionError`).
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Collection, Iterable, Mapping
from copy import copy
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple, Self

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: significant digits of lengths that a message has in another unit than mm
DIGITS = 6
#: words before a length that may be no more (0) or no less (1) than it
_BOUNDS = {"at most ": 0, "less than ": 0, " to ": 0, "at least ": 1, "more than ": 1, "from ": 1, "between ": 1}
_BOUNDS |= {"at most about ": 0, "at least about ": 1}
_NUMBER = re.compile(rf"(?P<bound>{'|'.join(_BOUNDS)})?(?<![\w.])(?P<figure>-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)")
#: one length or several in mm, with the words before the first
_LENGTHS = re.compile(
    rf"((?:{'|'.join(_BOUNDS)})?(?<![\w.])-?\d[\d.]*(?:e[-+]?\d+)?(?:(?: to | and | or |, )-?\d[\d.]*(?:e[-+]?\d+)?)*) mm(?![/\w^])"
)
#: least likeness of a misspelt word and the one that it stands for
LIKE = 0.55
#: the same of keys of figures, which are long and which people shorten
SHORTENED = 0.2
#: words before an upper and a lower bound in `allowed`
_UPPER, _LOWER = "at most|less than|smaller than|below", "at least|more than|larger than|above"
_FIGURE = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
_QUANTITY = (
    rf"(?:about )?(?:[^\d;:]*? |[^;:]*?, )?(?P<{{0}}>{_FIGURE})(?: (?P<{{0}}_unit>mm/mm|1/mm|1/inch|mm|inch|deg))?"
)
#: `allowed` as bounds of the value itself: a range, or one bound or two; what follows does not say that they are of something else
_RANGE = rf"(?P<range>from|between) {_QUANTITY.format('least')},? (?:to|and) {_QUANTITY.format('most')}"
_LOW = rf"(?P<lower>{_LOWER}) {_QUANTITY.format('low')}(?:,? and (?P<under>{_UPPER}) {_QUANTITY.format('top')})?"
_HIGH = rf"(?P<upper>{_UPPER}) {_QUANTITY.format('high')}"
_ALLOWED = re.compile(rf"(?:{_RANGE}|{_LOW}|{_HIGH})(?=$|[,:]| with | or | either way)")
_BOUND_GROUPS = (("least", "low"), ("most", "top", "high"))
_ANY_BOUND = re.compile(rf"(?:{_UPPER}|{_LOWER}) {_QUANTITY.format('any')}")
_IN_PARENTHESES = re.compile(r" \([^()]*\)")
#: what figures are made of
_FIGURES = str.maketrans("", "", "0123456789.-+")


class Bounds(NamedTuple):
    """Least and greatest allowed value in `unit`, None where there is none; `includes_low` and `includes_high` are true where the
    bound itself is allowed."""

    low: float | None
    high: float | None
    unit: str
    includes_low: bool = True
    includes_high: bool = True


class GearmeshError(Exception):
    """Base of every error that gearmesh raises on purpose: fields, of which the one clear line of its message is made.

    `key`: what was refused, a dotted key of a design, an argument of a call, or a part of the gears; `entry`: of an argument that
    has several, the one; `value`: what it was, in `unit`, and `shown`, if it is not shown as it is; `reason`: why; `allowed`: what
    may be there instead, or `must_be`, which says the same in other words; `remedy`: what to do; `more`: how many other things are
    refused; `topic`: what it is about, the same for the same trouble with other figures; `remedies`: dotted keys of a design of
    which a larger (1) or smaller (-1) value, or either (0), may mend it; `excess`: how far the checked figure is beyond its limit.
    """

    exit_status = 1
    #: whether `key` is an argument of a call
    of_argument = False
    #: unit in which the message has lengths, and mm in it; fields are in mm
    lengths_in = ("mm", 1.0)

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
        """A refusal whose fields are work to find out.

        Parameters
        ----------
        tell : callable
            Makes the refusal that has them; it is called when somebody reads any.
        topic : str
            What it is about.

        Returns
        -------
        GearmeshError
            Of the same class.

        Examples
        --------
        >>> str(gm.DesignError.later(lambda: gm.DesignError("teeth", 1, allowed="2 or more"), "teeth"))
        'teeth = 1: allowed is 2 or more'
        """
        made = cls.__new__(cls)
        made.__dict__.update(_tell=tell, _topic=topic, remedies={})
        return made

    def __getattr__(self, name: str) -> Any:
        """A field that is not known yet."""
        tell = None if name.startswith("__") else self.__dict__.pop("_tell", None)
        if tell is None:
            raise AttributeError(name)
        self.__dict__.update({**tell().__dict__, "_topic": self._topic})
        return getattr(self, name)

    @property
    def topic(self) -> str:
        """What went wrong, the same for the same trouble with other figures."""
        return f"{self.key}: {self.reason.translate(_FIGURES)}" if self._topic is None else self._topic

    @property
    def excess(self) -> float | None:
        """How far the checked figure is beyond its limit, 0 at the limit; searches for a bound go by it.

        Returns
        -------
        float or None
            In any unit, the same for the same topic; None where no figure says how far.

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
        """Bounds of the value that `allowed` states; None where it states none, or those of something else.

        Returns
        -------
        Bounds or None
            With the unit that `allowed` names.

        Examples
        --------
        >>> gm.DesignError("bore", 50.0, unit="mm", allowed="less than the root, 31 mm").bounds.high
        31.0
        """
        stated = _ALLOWED.match(_IN_PARENTHESES.sub("", self.allowed))
        if stated is None:
            return None
        part = {name: text for name, text in stated.groupdict().items() if text is not None}
        low, high = (next((float(part[name]) for name in names if name in part), None) for names in _BOUND_GROUPS)
        unit = next((part[name] for name in part if name.endswith("_unit")), "")
        return Bounds(
            low,
            high,
            unit,
            includes_low=part.get("range", "from") == "from" and part.get("lower", "at least") == "at least",
            includes_high=part.get("range", "from") == "from"
            and {part.get("upper"), part.get("under")} <= {"at most", None},
        )

    @property
    def bounds_another(self) -> bool:
        """True if `allowed` begins with bounds, but of another quantity than the value; "0 or at least 5 mm" does not.

        Returns
        -------
        bool
            False also where it states none.

        Examples
        --------
        >>> gm.DesignError("addendum", 4.0, allowed="a tip diameter of at most 46.067 mm").bounds_another
        True
        """
        return self.bounds is None and not self.allowed[:1].isdigit() and _ANY_BOUND.search(self.allowed) is not None

    @property
    def subject(self) -> str:
        """What was refused, as the message names it."""
        name = f"{self.key} {self.entry}".strip()
        shown = name if self.value is None else f"{name} = {self.shown or shown_value(self.value, self.unit)}"
        return in_unit(shown, *self.lengths_in)

    def rename(self, key: str) -> Self:
        """The same refusal of what is called otherwise where it is read.

        Parameters
        ----------
        key : str
            How it is called there.

        Returns
        -------
        GearmeshError
            Of the same class.

        Examples
        --------
        >>> gm.DesignError("teeth", 1, allowed="2 or more").rename("pinion.teeth").key
        'pinion.teeth'
        """
        made = copy(self)
        made.key = key
        return made

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
        """As plain fields, so that errors come back from other processes."""
        told = self.key is not None
        assert told, "reading a field makes all of them known"
        return _restore, (type(self), self.__dict__.copy())


def _restore(kind: type[GearmeshError], fields: dict[str, Any]) -> GearmeshError:
    made = kind.__new__(kind)
    made.__dict__.update(fields)
    return made


def shown_value(value: Any, unit: str = "") -> str:
    """A value with its unit, as messages show it."""
    if isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, float):
        text = f"{value:.7g}"
    elif isinstance(value, list | tuple):
        text = ",".join(map(shown_value, value)) or "[]"
    else:
        text = str(value)
    return f"{text} {unit}".rstrip()


def nearest(word: str, known: Iterable[str], likeness: float = LIKE) -> str | None:
    """The known word that a misspelt one most likely stands for."""
    import difflib

    return next(iter(difflib.get_close_matches(word, list(known), n=1, cutoff=likeness)), None)


def in_unit(line: str, unit: str, mm: float) -> str:
    """A message with its lengths, which are in mm, in another unit of so many mm; what may be at most or at least so much never
    becomes more or less than that."""
    return line if mm == 1.0 else _LENGTHS.sub(lambda lengths: _in_unit(lengths, unit, mm), line)


def _in_unit(lengths: re.Match[str], unit: str, mm: float) -> str:
    """One length or several, as "from 1 to 2.5 mm", in another unit."""

    def convert(number: re.Match[str]) -> str:
        figure = float(number["figure"]) / mm
        step = 10.0 ** (math.floor(math.log10(abs(figure))) - DIGITS + 1) if figure else 1.0
        # what is whole but for rounding is whole
        whole = (math.floor, math.ceil, round)[_BOUNDS.get(number["bound"], 2)]
        nearest = round(figure / step)
        count = nearest if abs(figure / step - nearest) < 1e-4 else whole(figure / step)
        return f"{number['bound'] or ''}{count * step:.{DIGITS}g}"

    return f"{_NUMBER.sub(convert, lengths[1])} {unit}"


class DesignError(GearmeshError):
    """Input that cannot be used: key, value and what is allowed."""

    exit_status = 2


class ArgumentError(DesignError):
    """An argument of a call that cannot be used; a command names its own option instead."""

    of_argument = True


class FileError(DesignError):
    """A file that somebody hands in cannot be read or understood: no value of another key mends that."""


class VagueError(DesignError):
    """Geometry that cannot exist, noticed where it is not known which key makes it infeasible, or by how much."""


class OutputError(GearmeshError):
    """A file that cannot be read or written, the `value`, or a missing component that it needs; `key` says what was tried."""

    exit_status = 2

    @property
    def subject(self) -> str:
        """What was tried, and with which file."""
        return super().subject if not self.key.startswith("cannot ") else f"{self.key} {self.shown or self.value}"


class OutputArgumentError(OutputError):
    """The same, of what an argument of a call names."""

    of_argument = True


class UnknownFigureError(ArgumentError, KeyError):
    """A figure that a result does not have, by its key."""

    @classmethod
    def among(cls, key: Any, known: Collection[str]) -> Self:
        """The refusal of a key that is not one of `known`, with the one that is meant."""
        begins = (name for name in known if isinstance(key, str) and key and name.startswith(key))
        close = next(begins, None) or nearest(str(key), known, SHORTENED)
        hint = f"did you mean {close}?" if close else f"there are {', '.join(known) or 'none'}"
        return cls("key", key, reason=f"there is no figure of this name; {hint}")


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
        held: NDArray[np.bool_] = self.status == Status.CONVERGED
        return held


_ADVICE = {
    Status.CONVERGED: "nothing to do",
    Status.MAX_ITERATIONS: "start closer to the solution, or choose more and smaller steps of phi1",
    Status.SINGULAR: "the surfaces touch along a line or the surface is undercut here; `gearmesh limits` shows where",
    Status.NOT_FINITE: "the surface is not defined at the parameters reached; reduce the range of phi1",
    Status.STALLED: "start closer to the solution: no step from here comes closer to one",
    Status.JAMMED: "the teeth overlap, tips in fillets, roots or other tips: the gears cannot turn",
    Status.NO_CONTACT: "the trimmed flanks do not meet at this position; reduce the range of phi1 or the assembly errors",
}
