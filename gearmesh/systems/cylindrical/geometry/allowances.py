"""Allowances of the tooth thickness of a member, given directly or as limits of span, balls or pins."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.allowance_keys import BallMeasurement, SpanMeasurement
from gearmesh.systems.cylindrical.geometry import measures
from gearmesh.systems.cylindrical.geometry.geometry import Toothing

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalMember
    from gearmesh.systems.cylindrical.rack.design import RackTable

#: largest allowance, of either sign, that limits of a measured size may lead to
MAX_ALLOWANCE_MODULES = 1.0


@dataclass(frozen=True)
class Allowances:
    """Allowances of the normal tooth thickness, mm."""

    upper: float
    lower: float
    made: float

    @classmethod
    def between(cls, upper: float, lower: float, where: str) -> Allowances:
        """Return the allowances; teeth are made at their "upper" or "lower" end, or in their "middle"."""
        return cls(upper, lower, {"upper": upper, "lower": lower, "middle": 0.5 * (upper + lower)}[where])


def allowances_of(name: str, spec: CylindricalMember | RackTable, own: Toothing) -> Allowances | None:
    """Return the allowances of the part `spec` of a design, called `name`; None if the design gives none.

    `own`: the nominal teeth. Raises DesignError if no such tooth has the given limits of a measured size.
    """
    key = spec.thickness_key
    if key is None:
        return None
    if key == "thickness_allowance":
        given = spec.thickness_allowance
        assert given is not None
        return Allowances.between(given.upper, given.lower, spec.thickness_made)
    ends = [_allowance_at(name, spec, key, end, own) for end in ("upper", "lower")]
    # of an internal gear the larger dimension between balls belongs to thinner teeth
    return Allowances.between(max(ends), min(ends), spec.thickness_made)


def made_allowance(name: str, spec: CylindricalMember | RackTable, own: Toothing) -> float:
    """Return the allowance with which the teeth are made; 0 if the design gives none.

    Raises DesignError as `allowances_of` does.
    """
    given = allowances_of(name, spec, own)
    return 0.0 if given is None else given.made


def _allowance_at(name: str, spec: CylindricalMember | RackTable, key: str, end: str, own: Toothing) -> float:
    """Return the allowance of teeth whose measured size is at its limit.

    - key: "span", "balls" or "pins".
    - end: "upper" or "lower".
    """
    table, bare = getattr(spec, key), replace(own, allowance=0.0)
    value = getattr(table, end)
    if key == "span" and own.asymmetric:
        raise DesignError(f"{name}.span", reason=measures.NO_ASYMMETRIC_SPAN, remedy="give balls")
    if key == "span":
        thickness = measures.thickness_by_span(bare, table.teeth, value)
    elif measures.over_pins(bare, table.diameter) is None and key == "pins":
        raise DesignError(
            f"{name}.pins", reason="straight pins touch internal helical teeth at their ends alone", remedy="give balls"
        )
    else:
        # pins of helical teeth slide until they are opposite each other
        opposite = key == "pins" and own.beta != 0.0
        thickness = measures.thickness_over_balls(bare, table.diameter, value, opposite=opposite)
    allowance = thickness - bare.thickness
    if not abs(allowance) <= MAX_ALLOWANCE_MODULES * own.module:
        raise DesignError(
            f"{name}.{key}.{end}",
            value,
            unit="mm",
            reason=f"asks for a thickness that is not within {MAX_ALLOWANCE_MODULES:g} modules "
            f"of that of the profile shift, {own.shift:.4g}",
            allowed=_possible(key, table, bare),
        )
    return allowance


def _possible(key: str, table: SpanMeasurement | BallMeasurement, own: Toothing) -> str:
    """Return the allowed range of a measured size as text.

    Its ends belong to the largest allowance of either sign. Where no such teeth have the size, smaller allowances are
    used. The text is empty if none have it.
    """

    def size(allowance: float) -> float:
        teeth = replace(own, allowance=allowance)
        if isinstance(table, SpanMeasurement):
            return measures.span(teeth, table.teeth)
        return (measures.over_balls if key == "balls" else measures.over_pins)(teeth, table.diameter) or math.nan

    parts = (1.0, 0.75, 0.5, 0.25)
    ends = [
        [x for part in parts if math.isfinite(x := size(sign * part * MAX_ALLOWANCE_MODULES * own.module))]
        for sign in (-1, 1)
    ]
    if not all(ends):
        return ""
    low, high = sorted(end[0] for end in ends)
    return Allowed.from_to(low, high, "mm")
