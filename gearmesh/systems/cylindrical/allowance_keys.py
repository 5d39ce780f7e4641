"""Keys of tooth thickness, tip diameter and centre distance with their tolerances.

The thickness is given by its allowances, or by the limits of a measure: span, balls or pins.
"""

from __future__ import annotations

import math
from typing import Any, Self

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from gearmesh.design import keys
from gearmesh.design.keys import DERIVED_VALUE, Table, conflict
from gearmesh.systems.common.standards import din3967, iso286

#: letters of tolerance classes of tip diameters
TIP_LETTERS = ("h", "js", "H", "JS")
#: grades of tolerance classes of tip diameters
TIP_GRADES = range(5, 13)
#: letters of tolerance classes of centre distances [DIN 3964]
CENTER_LETTERS = ("js",)
#: grades of tolerance classes of centre distances [DIN 3964]
CENTER_GRADES = range(5, 12)
#: difference of allowances that is rounding
ALLOWANCE_ROUNDING_MM = 1e-9


def _disordered(lower: float, upper: float) -> PydanticCustomError:
    """Return the error of a lower limit above the upper limit."""
    return conflict(
        "lower", lower, must_be=f"at most upper, {upper:g}", other=("upper", upper, f"at least lower, {lower:g}")
    )


def _given_alone(lower: float | None, upper: float | None) -> tuple[str, float, str] | None:
    """Return the refusal of a limit that is given without the other limit; None if both are missing."""
    if upper is not None:
        return "upper", upper, "given with lower"
    return None if lower is None else ("lower", lower, "given with upper")


class ThicknessAllowance(Table):
    """Allowances of the normal tooth thickness at the reference cylinder; teeth are made in their middle."""

    series: str | None = keys.text(
        'letter and tolerance series, as "cd25"; this text alone may replace the table', None, source="DIN 3967"
    )
    upper: float = keys.length(
        "upper allowance A_sne, negative where the tooth is thinned",
        DERIVED_VALUE,
        low=-100,
        high=100,
        default="by series",
    )
    lower: float = keys.length("lower allowance A_sni", DERIVED_VALUE, low=-100, high=100, default="by series")

    @model_validator(mode="before")
    @classmethod
    def _text_is_a_series(cls, keys: Any) -> Any:
        if not isinstance(keys, str):
            return keys
        if wrong := din3967.refusal(keys):
            raise conflict("", keys, must_be=f"{wrong}; or a table with upper and lower")
        return {"series": keys}

    @model_validator(mode="after")
    def _sound(self) -> Self:
        given = [key for key in ("upper", "lower") if not math.isnan(getattr(self, key))]
        if self.series is not None and (wrong := din3967.refusal(self.series)):
            raise conflict("series", self.series, must_be=wrong)
        if self.series is None and len(given) < 2:
            missing = "lower" if given == ["upper"] else "upper"
            alone = _given_alone(*(getattr(self, key) if key in given else None for key in ("lower", "upper")))
            raise conflict(missing, None, reason='missing; give upper and lower, or a series as "cd25"', other=alone)
        if self.lower > self.upper:
            raise _disordered(self.lower, self.upper)
        return self

    def by_series(self, diameter: float) -> dict[str, float]:
        """Return both ends of the allowance by its series, DIN 3967.

        `diameter`: reference diameter, mm. Result: "upper" and "lower", mm; empty without a series.
        """
        if self.series is None:
            return {}
        return dict(zip(("upper", "lower"), din3967.allowances(self.series, diameter), strict=True))

    def check_series(self, table: str, diameter: float, mm_per_unit: float) -> None:
        """Refuse a reference diameter outside the standard's range, and ends that differ from the series.

        `table`: dotted name of this table, which refusals name. `diameter`: reference diameter, mm. `mm_per_unit`:
        millimetres in a unit of the design's lengths. Raises DesignError where they are not.
        """
        if diameter > din3967.DIAMETER_LIMITS_MM[-1]:
            raise conflict(
                f"{table}.series",
                self.series,
                reason=f"DIN 3967 ends at a reference diameter of {din3967.DIAMETER_LIMITS_MM[-1]} mm, "
                f"this one is {diameter:.7g} mm",
                allowed="upper and lower instead",
            )
        for key, value in self.by_series(diameter).items():
            own = getattr(self, key)
            if not math.isnan(own) and abs(own * mm_per_unit - value) > ALLOWANCE_ROUNDING_MM:
                raise conflict(f"{table}.{key}", own, reason=f"cannot be given together with series = {self.series}")

    @property
    def middle(self) -> float:
        return 0.5 * (self.upper + self.lower)


def thickness_made_key() -> Any:
    """Return the key of the place within its allowance at which a tooth thickness is made."""
    about = "at which end of the thickness allowance, or in its middle, the teeth are made"
    return keys.choice(about, ("middle", "upper", "lower"), "middle")


class DiameterTolerance(Table):
    """Deviations of a diameter."""

    grade: str | None = keys.text(
        'tolerance class, as "h8"; this text alone may replace the table', None, source="ISO 286-1"
    )
    upper: float | None = keys.length("upper deviation", None, low=-100, high=100)
    lower: float | None = keys.length("lower deviation", None, low=-100, high=100)

    @model_validator(mode="before")
    @classmethod
    def _text_is_a_grade(cls, keys: Any) -> Any:
        if not isinstance(keys, str):
            return keys
        if wrong := iso286.refusal(keys, TIP_LETTERS, TIP_GRADES):
            raise conflict("", keys, must_be=f"{wrong}; or a table with upper and lower")
        return {"grade": keys}

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if self.grade is not None:
            if wrong := iso286.refusal(self.grade, TIP_LETTERS, TIP_GRADES):
                raise conflict("grade", self.grade, must_be=wrong)
            for key in ("upper", "lower"):
                if (value := getattr(self, key)) is not None:
                    raise conflict(key, value, reason=f"cannot be given together with grade = {self.grade}")
        elif self.upper is None or self.lower is None:
            missing = "upper" if self.upper is None else "lower"
            alone = _given_alone(self.lower, self.upper)
            raise conflict(missing, None, reason='missing; give upper and lower, or a grade as "h8"', other=alone)
        elif self.lower > self.upper:
            raise _disordered(self.lower, self.upper)
        return self

    def deviations(self, diameter: float) -> iso286.Deviations | None:
        """Return both deviations of a diameter, for a table in mm."""
        if self.grade is not None:
            return None if diameter > iso286.SIZE_LIMITS_MM[-1] else iso286.deviations(self.grade, diameter)
        assert self.upper is not None
        assert self.lower is not None
        return iso286.Deviations(self.upper, self.lower)


class CenterDistanceAllowance(Table):
    """Assembly of members on parallel axes."""

    center_distance_allowance: str | None = keys.text(
        "allowance of the centre distance, js5 to js11, for backlash and the data sheet", None, source="DIN 3964"
    )

    @model_validator(mode="after")
    def _known_allowance(self) -> Self:
        given = self.center_distance_allowance
        if given is not None and (wrong := iso286.refusal(given, CENTER_LETTERS, CENTER_GRADES)):
            raise conflict("center_distance_allowance", given, must_be=wrong)
        return self

    def center_distance_deviations(self, distance: float) -> iso286.Deviations | None:
        """Return both deviations of a centre distance.

        `distance`: nominal centre distance, mm. Result: upper and lower, mm; None where no allowance is given, or ISO
        286 has no such size.
        """
        given = self.center_distance_allowance
        return None if given is None or distance > iso286.SIZE_LIMITS_MM[-1] else iso286.deviations(given, distance)


class MeasuredSize(Table):
    """Limits of a measured size: both, or none."""

    upper: float | None = keys.length("upper limit; with it the thickness is given", None, above=0)
    lower: float | None = keys.length("lower limit", None, above=0)

    @model_validator(mode="after")
    def _sound_limits(self) -> Self:
        if (self.upper is None) != (self.lower is None):
            missing, other = ("upper", "lower") if self.upper is None else ("lower", "upper")
            alone = _given_alone(self.lower, self.upper)
            raise conflict(missing, None, reason=f"missing; give it with {other}", other=alone)
        if self.upper is not None and self.lower is not None and self.lower > self.upper:
            raise _disordered(self.lower, self.upper)
        return self


class SpanMeasurement(MeasuredSize):
    """Span W_k over teeth, of an internal gear over spaces, for the data sheet, and with limits for the thickness."""

    teeth: int = keys.count("number k of teeth, of an internal gear of spaces, of the span W_k", low=1, high=1000)


class BallMeasurement(MeasuredSize):
    """Dimension over two balls (or pins) in opposite spaces, between them in an internal gear; as the span."""

    diameter: float = keys.length("diameter D_M of the ball or pin", above=0)
