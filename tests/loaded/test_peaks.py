"""Peak pressures: no singular edge counts, what is behind a minimum does, and nothing jumps with the position of the gears."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.peaks import RowGrid, peaks, row_peaks

ACROSS = np.sqrt(1.0 - (np.arange(-5.5, 6.0) / 6.0) ** 2)


def grid_of(rows: Array, dx: float, ends: tuple[float, float] = (0.0, 0.0), sharp: bool = True) -> RowGrid:
    """Rows (X,) across which pressure is elliptical; the first end is sharp or not, the last one is not."""
    pressure = (rows[:, None] * ACROSS / ACROSS.max())[None]
    return RowGrid(
        pressure,
        np.ones(pressure.shape, dtype=bool),
        np.zeros(pressure.shape[:2], dtype=bool),
        np.array([dx]),
        np.array(ends)[:, None],
        np.array([[not sharp, True]]),
    )


@pytest.mark.quick
def test_rise_to_a_sharp_end_is_no_peak_for_any_cell_size() -> None:
    """500 MPa and a singularity like a root of the distance: the value at the border of the zone, by three sizes of cells."""
    found = []
    for cells in (20, 40, 80):
        dx = 10.0 / cells
        x = dx * (np.arange(cells) + 0.5)
        rows = 500.0 + 200.0 / np.sqrt(x)
        found.append(peaks(grid_of(rows, dx), 2.3).pressure[0])
        assert peaks(grid_of(rows, dx, sharp=False), 2.3).pressure[0] == pytest.approx(rows[0])
        assert np.isnan(peaks(grid_of(rows[: cells // 5], dx), 2.3).pressure[0])
    np.testing.assert_allclose(found, 500.0 + 200.0 / np.sqrt(2.3), rtol=3e-3)


@pytest.mark.quick
def test_hump_beside_an_edge_and_fading_contact_are_peaks() -> None:
    x = 0.25 * (np.arange(40) + 0.5)
    hump = 900.0 * np.exp(-((x - 1.6) ** 2))
    assert peaks(grid_of(hump, 0.25), 4.0).pressure[0] == pytest.approx(900.0, rel=0.01)
    both = hump + 700.0 * np.exp(-4.0 * x)
    assert peaks(grid_of(both, 0.25), 4.0).pressure[0] == pytest.approx(both[x > 1.0].max())
    # the same grid where the ridge ends 1 mm within it, and rows beyond it run along the edge
    moved = grid_of(both, 0.25, (1.0, 0.0))
    moved.edged[0, x < 1.0] = True
    assert peaks(moved, 4.0).pressure[0] == pytest.approx(both[x > 1.0].max())


@pytest.mark.quick
def test_across_a_row_the_maximum_beside_an_edge_is_none() -> None:
    """An edge that cuts a little of the ellipse leaves its middle, one that cuts half of it leaves nothing."""
    grid = grid_of(np.full(3, 600.0), 1.0)
    for row, off in enumerate((1, 6)):
        grid.on[0, row, :off] = False
        grid.pressure[0, row, :off] = 0.0
        grid.pressure[0, row, off] += 1000.0
    assert row_peaks(grid)[0] == pytest.approx([600.0, np.nan, 600.0], nan_ok=True)
