"""Sheets of paper [ISO 5457] and scales [ISO 5455]."""

from __future__ import annotations

from dataclasses import dataclass

#: mm: border on the left, where sheets are bound, and on the other sides
BINDING, BORDER = 20.0, 10.0
#: enlargements, full size and reductions, the largest first
SCALES = tuple(
    sorted(
        [factor * 10.0**power for power in (0, 1) for factor in (1.0, 2.0, 5.0)]
        + [1.0 / (factor * 10.0**power) for power in (0, 1, 2, 3) for factor in (1.0, 2.0, 5.0)],
        reverse=True,
    )
)


@dataclass(frozen=True)
class Paper:
    """A sheet lying on its long side, mm; smaller ones are taken for views at `scale` or larger only."""

    name: str
    width: float
    height: float
    scale: float

    @property
    def frame(self) -> tuple[float, float, float, float]:
        """Left, low, right and high side of the drawing space."""
        return BINDING, BORDER, self.width - BORDER, self.height - BORDER


PAPERS = (Paper("A4", 297.0, 210.0, 1.0), Paper("A3", 420.0, 297.0, 0.0))


def scale_name(scale: float) -> str:
    """As 1:2 or 5:1."""
    return f"{scale:g}:1" if scale >= 1.0 else f"1:{round(1.0 / scale):d}"
