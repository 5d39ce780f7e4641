"""Refusals as a page shows them: the line, the key it belongs to, and values that would be allowed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, TypeGuard

from gearmesh.allowed import Bounds
from gearmesh.design.keys import Key
from gearmesh.errors import GearmeshError
from gearmesh.explore.ranges import halved

#: distance from a bound that is excluded itself, over the bound
INSIDE_SHARE = 1e-5
#: significant digits of offered values
OFFERED_DIGITS = 6
#: rounds that halve the gap between a value that builds and a refused one
OFFER_ROUNDS = 7


class KeyTable(Protocol):
    """Keys by their dotted names: those of a class of designs, or of all stages of a train."""

    def key_at(self, dotted: str, /) -> Key | None:
        """Return a key, None without one."""


def refusal(error: GearmeshError, design: KeyTable, mm_per_unit: float) -> dict[str, Any]:
    """Return an error with the key beside which it is shown, and the offers that would mend it, as plain data."""
    errors = [error, *getattr(error, "others", ())]
    offers = [offer for each in errors if (offer := _offer(each, design, mm_per_unit)) is not None]
    line = str(error)
    return {"line": " ".join(line.split()), "key": error.key, "offers": offers}


def offers_that_build(
    offers: Sequence[dict[str, Any]],
    request: Mapping[str, Any],
    design: KeyTable,
    works: Callable[[Mapping[str, Any]], bool],
) -> list[dict[str, Any]]:
    """Return those of the offers with which the gears build, else the value of the changed key nearest to the refused one.

    `request` has the key that was changed `last`, and its `good` value, which built; `works`: True for changes with which the
    gears build. If the refused value builds itself, something else failed, and the offers stay as they are.
    """
    dotted, good = str(request.get("last")), request.get("good")
    known = [offer for offer in offers if works({offer["key"]: offer["value"]})]
    key = design.key_at(dotted)
    refused = request["keys"].get(dotted) if isinstance(request.get("keys"), dict) else None
    if known or key is None or not key.is_numeric or not (_is_number(good) and _is_number(refused)):
        return known
    if works({}):
        return list(offers)
    nearest = _nearest(good, refused, lambda tried: works({dotted: tried}), whole=key.unit == "count")
    return [] if nearest is None else [_offered(dotted, nearest)]


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _nearest(good: float, refused: float, works: Callable[[float], bool], *, whole: bool) -> float | None:
    """Return a value that works between a good one and a refused one, near to where values cease to work; None without any."""
    step = 10.0 ** math.floor(math.log10(abs(refused - good) / 50.0 or 1.0))

    def rounded(value: float) -> float:
        return math.trunc(value) if whole else float(f"{round(value / step) * step:.{OFFERED_DIGITS}g}")

    nearest = halved(good, refused, works, OFFER_ROUNDS, rounded)
    return None if nearest == good else nearest


def _offered(key: str, value: float) -> dict[str, Any]:
    """Return a value of a key as an offer."""
    shown = f"{value:g}" if isinstance(value, int) else f"{value:.{OFFERED_DIGITS}g}"
    return {"key": key, "value": value, "text": f"set {key} to {shown}"}


def _offer(error: GearmeshError, design: KeyTable, mm_per_unit: float) -> dict[str, Any] | None:
    """Return the allowed value nearest to a refused one, in the design's units.

    None if neither the error nor the key has bounds.
    """
    key, value = design.key_at(error.key), error.value
    if key is None or not key.is_numeric or not isinstance(value, int | float):
        return None
    bounds = error.bounds or _limits(key, value * (mm_per_unit**key.power if error.unit != "mm" else 1.0))
    if bounds is None:
        return None
    # fields of errors are in mm unless they name the design's unit
    scale = mm_per_unit**key.power if bounds.unit in ("mm", "1/mm") else 1.0
    if key.power and bounds.unit == "" and error.unit == "mm":
        scale = mm_per_unit**key.power
    ends = [
        (end / scale, included, inwards)
        for end, included, inwards in ((bounds.low, bounds.includes_low, 1), (bounds.high, bounds.includes_high, -1))
        if end is not None
    ]
    if not ends:
        return None
    refused = value / (mm_per_unit**key.power if error.unit == "mm" else 1.0)
    end, included, inwards = min(ends, key=lambda each: abs(each[0] - refused))
    if not included:
        end += inwards * (1.0 if key.unit == "count" else INSIDE_SHARE * (abs(end) or 1.0))
    offered = round(end) if key.unit == "count" else _rounded(end, inwards)
    return _offered(error.key, offered)


def _limits(key: Key, value: float) -> Bounds | None:
    """Return the limits of a key beyond which a value (lengths in mm) lies; None without any, or at 0 that is not allowed."""
    if value > key.high:
        return Bounds(None, key.high, "mm" if key.power else "")
    if value < key.low and not (key.above and key.low == 0.0):
        return Bounds(key.low, None, "mm" if key.power else "", includes_low=not key.above)
    return None


def _rounded(value: float, inwards: int) -> float:
    """Return a value with few digits, rounded into the allowed range."""
    if value == 0.0:
        return 0.0
    step = 10.0 ** (math.floor(math.log10(abs(value))) - OFFERED_DIGITS + 1)
    steps = value / step
    nearest = round(steps)
    whole = nearest if abs(steps - nearest) < 1e-4 else math.ceil(steps) if inwards > 0 else math.floor(steps)
    return float(f"{whole * step:.{OFFERED_DIGITS}g}")
