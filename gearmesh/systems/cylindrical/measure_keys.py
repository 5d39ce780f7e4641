"""Keys of measures of the tooth thickness: span, balls, pins. With limits they define the thickness."""

from __future__ import annotations

from typing import Self

from pydantic import model_validator

from gearmesh.design import keys
from gearmesh.design.keys import Table, conflict


class MeasuredSize(Table):
    """Limits of a measured size: both, or none."""

    upper: float | None = keys.length("upper limit; with it the thickness is given", None, above=0)
    lower: float | None = keys.length("lower limit", None, above=0)

    @model_validator(mode="after")
    def _sound_limits(self) -> Self:
        if (self.upper is None) != (self.lower is None):
            missing, other = ("upper", "lower") if self.upper is None else ("lower", "upper")
            raise conflict(missing, None, reason=f"missing; give it with {other}")
        if self.upper is not None and self.lower is not None and self.lower > self.upper:
            raise conflict("lower", self.lower, must_be=f"at most upper, {self.upper:g}")
        return self


class SpanMeasurement(MeasuredSize):
    """Span W_k over teeth, of an internal gear over spaces, for the data sheet, and with limits for the thickness."""

    teeth: int = keys.count("number k of teeth, of an internal gear of spaces, of the span W_k", low=1, high=1000)


class BallMeasurement(MeasuredSize):
    """Dimension over two balls (or pins) in opposite spaces, between them in an internal gear; as the span."""

    diameter: float = keys.length("diameter D_M of the ball or pin", above=0)
