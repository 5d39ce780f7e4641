"""The area that contact lines sweep, from lines whose pieces part, join and vanish."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.view.diagrams.flank_plane import strips


def area(swept: list[Array]) -> float:
    """Area, mm^2, of quadrilaterals, whichever way round their corners go."""
    across, along = (np.concatenate([quads[:, k] - quads[:, j] for quads in swept]) for k, j in ((2, 0), (3, 1)))
    return float(0.5 * np.abs(across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0]).sum())


def line(x: float, *pieces: tuple[float, float]) -> Array:
    """Pieces at x = const, from and to a y, with NaN between them."""
    parts = [np.column_stack((np.full(13, x), np.linspace(*ends, 13))) for ends in pieces]
    return np.concatenate([row for part in parts for row in (part, np.full((1, 2), np.nan))][:-1])


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ([line(0.0, (0.0, 10.0)), line(1.0, (9.0, 1.0))], 9.0),
        # a hole opens, stays, and one of the pieces vanishes
        ([line(0.0, (0.0, 10.0)), line(1.0, (0.0, 4.0), (6.0, 10.0)), line(2.0, (0.0, 4.0), (6.0, 10.0))], 16.0),
        ([line(0.0, (0.0, 4.0), (6.0, 10.0)), line(1.0, (0.0, 4.0))], 4.0),
        ([line(0.0, (6.0, 10.0)), line(1.0, (0.0, 4.0), (6.0, 10.0))], 4.0),
        # towards a corner the next line is short
        ([line(0.0, (0.0, 10.0)), line(1.0, (8.0, 10.0))], 6.0),
        # what lies elsewhere is another part of the flank
        ([line(0.0, (0.0, 4.0)), line(1.0, (6.0, 10.0))], 0.0),
        ([line(0.0, (0.0, 4.0)), None, line(1.0, (0.0, 4.0))], 0.0),
    ],
)
def test_strips_join_the_pieces_that_lie_beside_each_other(lines: list[Array | None], expected: float) -> None:
    """Areas by hand; points of a line are a fortieth of it apart."""
    swept = strips(lines)
    assert (area(swept) if swept else 0.0) == pytest.approx(expected, rel=0.02)
