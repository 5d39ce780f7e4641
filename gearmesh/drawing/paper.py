"""Sheets of paper [ISO 5457] and scales [ISO 5455]."""

from __future__ import annotations

from gearmesh.records import dataclass

#: border on the left, where sheets are bound
BINDING_BORDER_MM = 20.0
#: border on the other sides
SHEET_BORDER_MM = 10.0
#: enlargements, full size and reductions, the largest first
DRAWING_SCALES = tuple(
    sorted(
        [factor * 10.0**power for power in (0, 1) for factor in (1.0, 2.0, 5.0)]
        + [1.0 / (factor * 10.0**power) for power in (0, 1, 2, 3) for factor in (1.0, 2.0, 5.0)],
        reverse=True,
    )
)
#: scales between them, the largest first
INTERMEDIATE_SCALES = tuple(
    sorted(
        [factor * power for power in (1.0, 10.0) for factor in (1.25, 1.5, 2.5, 3.0, 4.0)]
        + [1.0 / (factor * power) for power in (1.0, 10.0, 100.0) for factor in (1.25, 1.5, 2.5, 3.0, 4.0, 6.0, 8.0)],
        reverse=True,
    )
)
#: least ratio of an intermediate scale to the recommended scale in its place
INTERMEDIATE_GAIN = 1.2


@dataclass(frozen=True)
class Paper:
    """A sheet lying on its long side; lengths in mm."""

    #: size, as A4
    name: str
    #: length of the long side
    width: float
    #: length of the short side
    height: float
    #: smallest scale at which this sheet is used
    scale: float

    @property
    def frame(self) -> tuple[float, float, float, float]:
        """Left, low, right and high side of the drawing space, mm."""
        return BINDING_BORDER_MM, SHEET_BORDER_MM, self.width - SHEET_BORDER_MM, self.height - SHEET_BORDER_MM


#: sheets, in the order in which they are tried
PAPER_SIZES = (Paper("A4", 297.0, 210.0, 1.0), Paper("A3", 420.0, 297.0, 0.0))


def scale_name(scale: float) -> str:
    """Return a scale as 1:2 or 5:1."""
    return f"{scale:g}:1" if scale >= 1.0 else f"1:{1.0 / scale:g}"
