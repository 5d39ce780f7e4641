"""Keys of measures of the tooth thickness: span, balls, pins. With limits they define the thickness."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import model_validator

from gearmesh.design.keys import Key, Table, conflict


class MeasuredSize(Table):
    """Limits of a measured size: both, or none."""

    upper: Annotated[float | None, Key("length", "upper limit; with it the thickness is given", low=0, above=True)] = (
        None
    )
    lower: Annotated[float | None, Key("length", "lower limit", low=0, above=True)] = None

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

    teeth: Annotated[
        int, Key("count", "number k of teeth, of an internal gear of spaces, of the span W_k", low=1, high=1000)
    ]


class BallMeasurement(MeasuredSize):
    """Dimension over two balls (or pins) in opposite spaces, between them in an internal gear; as the span."""

    diameter: Annotated[float, Key("length", "diameter D_M of the ball or pin", low=0, above=True)]
