"""Parts before the front plane of a picture are cut away, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh.view.offscreen.front_plane import cut_front


@pytest.mark.quick
def test_the_area_behind_the_plane_is_kept_and_colours_stay_linear() -> None:
    """Sheets of triangles over a unit square at random heights: what is kept projects onto the area where the height is below 0."""
    rng, count = np.random.default_rng(3), 40
    x, y = np.meshgrid(np.linspace(0.0, 1.0, count), np.linspace(0.0, 1.0, count), indexing="ij")
    z = np.sin(7.0 * x + 1.0) * np.cos(9.0 * y) + 0.2 * rng.normal(size=x.shape)
    points = np.stack((x, y, z), axis=-1).reshape(-1, 3)
    number = np.arange(count**2).reshape(count, count)
    corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    cells = np.concatenate(
        [np.stack([corners[k] for k in three], axis=-1).reshape(-1, 3) for three in ([0, 1, 2], [0, 2, 3])]
    )
    shades = np.rint(255.0 * points[:, [0, 1, 0]]).astype(np.uint8)
    kept, triangles, colours = cut_front(points, cells, -points[:, 2], shades)
    assert colours is not None
    assert kept[:, 2].max() <= 1e-12
    assert np.abs(colours - 255.0 * kept[:, [0, 1, 0]]).max() <= 1.01

    def areas(places: np.ndarray, of: np.ndarray) -> np.ndarray:
        one, two = places[of[:, 1]] - places[of[:, 0]], places[of[:, 2]] - places[of[:, 0]]
        return 0.5 * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])

    assert areas(kept, triangles).min() >= -1e-15
    # a place is covered once where the sheet is behind the plane, and not at all before it
    places = rng.uniform(0.02, 0.98, (400, 2))
    own, height = _covering(points, cells, places)
    assert (own == 1).all()
    covered, _ = _covering(kept, triangles, places)
    assert ((height < 0.0) == (covered == 1)).all()
    assert set(covered.tolist()) == {0, 1}
    # those that the plane cuts come first, and points of no cell are gone
    uncut = (z.reshape(-1)[cells] <= 0.0).all(axis=1).sum()
    assert areas(kept, triangles[-uncut:]) == pytest.approx(np.full(uncut, 0.5 / (count - 1) ** 2))
    assert set(triangles.ravel().tolist()) == set(range(len(kept)))


@pytest.mark.quick
def test_lines_end_at_the_plane() -> None:
    points = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 3.0], [2.0, 0.0, 1.0], [3.0, 0.0, -1.0]])
    kept, lines, _ = cut_front(points, np.array([[0, 1], [1, 2], [2, 3], [3, 0]]), -points[:, 2])
    ends = sorted(tuple(sorted(map(tuple, kept[line].round(12).tolist()))) for line in lines)
    assert ends == [
        ((0.0, 0.0, -1.0), (0.25, 0.0, 0.0)),
        ((0.0, 0.0, -1.0), (3.0, 0.0, -1.0)),
        ((2.5, 0.0, 0.0), (3.0, 0.0, -1.0)),
    ]


def _covering(points: np.ndarray, triangles: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the number of triangles over places (N, 2) as seen from above, and the height of the last one there."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    one, two = (b - a)[:, :2], (c - a)[:, :2]
    double = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    away = places[:, None] - a[:, :2]
    with np.errstate(all="ignore"):
        u = (away[..., 0] * two[:, 1] - away[..., 1] * two[:, 0]) / double
        v = (one[:, 0] * away[..., 1] - one[:, 1] * away[..., 0]) / double
        inside = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
        heights = a[:, 2] + u * (b - a)[:, 2] + v * (c - a)[:, 2]
    return inside.sum(axis=1), np.where(inside, heights, -np.inf).max(axis=1)
