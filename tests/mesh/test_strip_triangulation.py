"""Triangulations of strips between lines: every one fills the rectangle of the (s, t) plane, whatever its levels and corners."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.strip_triangulation import Index, StripTriangulation

#: so much do levels rise from s = 0 to 1
SHEARS = (-3.0, -0.4, -0.01, 0.0, 0.01, 0.4, 3.0)


def nodes(
    rows: list[int], toe: list[int], heel: list[int]
) -> tuple[list[Index], list[Index], list[Index], Array, Array]:
    """Lines of so many nodes, so many nodes between them at toe and heel; s and t of all."""
    at, s, t, parts = np.linspace(0.0, 1.0, len(rows)), [], [], []
    for k, count in enumerate(rows):
        s.append(np.full(count, at[k]))
        t.append(np.linspace(0.0, 1.0, count))
    for end, counts in ((0.0, toe), (1.0, heel)):
        for k, count in enumerate(counts):
            s.append(np.linspace(at[k], at[k + 1], count + 2)[1:-1])
            t.append(np.full(count, end))
    ends = np.cumsum([0] + [part.size for part in s])
    parts = [np.arange(low, high) for low, high in pairwise(ends)]
    k = len(rows)
    return parts[:k], parts[k : 2 * k - 1], parts[2 * k - 1 :], np.concatenate(s), np.concatenate(t)


def areas(s: Array, t: Array, triangles: Index) -> Array:
    (a, b, c), (d, e, f) = s[triangles].T, t[triangles].T
    return 0.5 * ((b - a) * (f - d) - (c - a) * (e - d))


@pytest.mark.parametrize("shear", SHEARS)
@pytest.mark.parametrize(
    ("rows", "toe", "heel"),
    [
        ([2, 2], [0], [0]),
        ([2, 2], [3], [0]),
        ([6, 6, 6, 6], [0, 0, 0], [0, 0, 0]),
        ([6, 6, 6], [4, 0], [1, 7]),
        ([9, 4, 2, 30], [5, 1, 0], [0, 2, 3]),
    ],
)
def test_a_triangulation_fills_the_rectangle(rows: list[int], toe: list[int], heel: list[int], shear: float) -> None:
    lines, below, above, s, t = nodes(rows, toe, heel)
    random = np.random.default_rng(7)

    def miss(edges: Index) -> Array:
        found: Array = random.random(len(edges))
        return found

    level = t + shear * s
    plain = StripTriangulation.of(lines, below, above, level, miss)
    for triangulation in (plain, plain.flip(miss)):
        triangles, strip = triangulation.triangles()
        assert (areas(s, t, triangles) > 0.0).all()
        assert areas(s, t, triangles).sum() == pytest.approx(1.0, abs=1e-12)
        # as many as the border of every strip demands, and every node is used
        on_border = [rows[k] + rows[k + 1] + toe[k] + heel[k] for k in range(len(toe))]
        assert np.bincount(strip).tolist() == [count - 2 for count in on_border]
        assert np.unique(triangles).size == s.size
        # edges between neighbouring strips, and of the rectangle, are those of the lines: no vertex lies inside one
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        counts = np.unique(edges, axis=0, return_counts=True)[1]
        assert (counts == 1).sum() == rows[0] + rows[-1] - 2 + sum(toe) + sum(heel) + 2 * len(toe)
        assert counts.max() <= 2


@pytest.mark.parametrize("seed", range(6))
def test_the_best_triangulation_is_the_best_of_all(seed: int) -> None:
    """Compare with all triangulations between two chains, for every choice of corners. The strip has sides of 5 and 4 nodes and
    ends with 1 and 2 nodes between; the other strip stays as it is."""
    lines, below, above, s, t = nodes([5, 4, 3], [1, 0], [2, 1])
    table = np.random.default_rng(seed).random((s.size, s.size))

    def miss(edges: Index) -> Array:
        low, high = np.sort(edges, axis=1).T
        found: Array = table[low, high]
        return found

    def cost(triangles: Index) -> float:
        return float((miss(inner_edges(triangles)) ** 4).sum())

    def least(a: list[int], b: list[int]) -> float:
        """Least cost of all ways from the first nodes of two chains to the last ones."""
        ways = []
        for chosen in combinations(range(len(a) + len(b) - 2), len(a) - 1):
            i = np.cumsum([0, *(k in chosen for k in range(len(a) + len(b) - 2))])
            ways.append(np.column_stack((np.array(a)[i], np.array(b)[np.arange(i.size) - i])))
        return min(float((miss(way) ** 4).sum()) for way in ways)

    (left, right), toe, heel = (line.tolist() for line in lines[:2]), below[0].tolist(), above[0].tolist()
    of_left, of_right = [toe[::-1] + left, left[1:]], [right[1:], toe + right]
    chains = [
        (of_left[first] + heel, of_right[first][:-1]) if last else (of_left[first][:-1], of_right[first] + heel[::-1])
        for first in (0, 1)
        for last in (0, 1)
    ]
    plain = StripTriangulation.of(lines, below, above, t, miss)
    better = plain.best(miss, t, np.array([True, False]))
    triangles, strip = better.triangles()
    assert cost(triangles[strip == 0]) == pytest.approx(min(least(a, b) for a, b in chains), rel=1e-12)
    assert (areas(s, t, triangles) > 0.0).all()
    before, of = plain.triangles()
    np.testing.assert_array_equal(triangles[strip == 1], before[of == 1])


def test_long_strips_have_the_best_triangulation_without_every_pair() -> None:
    """Strip of 181 nodes beside 61, with 2 between them at the toe, as where a face gear's fillet meets its flank. Diagonals
    lean by a twentieth of the strip, and there are fans. The least cost over all pairs of nodes, cell by cell, is not below the
    cost that was found over near pairs alone."""
    lines, below, above, s, t = nodes([61, 181], [2], [0])
    tried = 0

    def miss(edges: Index) -> Array:
        nonlocal tried
        tried += len(edges)
        ds, dt = s[edges[:, 1]] - s[edges[:, 0]], t[edges[:, 1]] - t[edges[:, 0]]
        off: Array = np.abs(ds * (0.05 - 0.1 * t[edges].mean(axis=1)) - dt) + 0.01 * dt**2
        return off

    plain = StripTriangulation.of(lines, below, above, t, miss)
    tried = 0
    better = plain.best(miss, t, np.array([True]))
    assert 0 < tried < 0.25 * 4 * 61 * 181
    (left, right), toe = lines, below[0]
    least = np.inf
    for a, b in ((np.append(toe[::-1], left), right[1:]), (left[1:], np.append(toe, right))):
        for first, last in ((a, b[:-1]), (a[:-1], b)):
            pairs = np.stack(np.meshgrid(first, last, indexing="ij"), axis=-1)
            cost = miss(pairs.reshape(-1, 2)).reshape(pairs.shape[:2]) ** 4
            for i, j in np.ndindex(cost.shape):
                before = [cost[i - 1, j]] * (i > 0) + [cost[i, j - 1]] * (j > 0)
                cost[i, j] += min(before, default=0.0)
            least = min(least, float(cost[-1, -1]))
    triangles, _ = better.triangles()
    assert (miss(inner_edges(triangles)) ** 4).sum() == pytest.approx(least, rel=1e-9)
    assert (miss(inner_edges(plain.triangles()[0])) ** 4).sum() > 10.0 * least
    assert (areas(s, t, triangles) > 0.0).all()


def inner_edges(triangles: Index) -> Index:
    edges, counts = np.unique(
        np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0, return_counts=True
    )
    return edges[counts == 2]


def test_diagonals_follow_the_levels() -> None:
    """Between lines of evenly spaced nodes no diagonal crosses more than a row, however steep the levels are."""
    lines, below, above, s, t = nodes([41, 41, 41], [3, 3], [3, 3])
    level = t + 0.2 * s
    triangulation = StripTriangulation.of(lines, below, above, level, lambda edges: np.zeros(len(edges)))
    places, _ = triangulation.diagonals()
    assert np.abs(level[triangulation.a[places[:, 0]]] - level[triangulation.b[places[:, 1]]]).max() < 1.5 / 40.0
    assert np.abs(t[triangulation.a[places[:, 0]]] - t[triangulation.b[places[:, 1]]]).max() > 0.09


def test_diagonals_are_turned_to_the_nearer_side() -> None:
    lines, below, above, s, t = nodes([6, 6, 6], [0, 0], [0, 0])

    def rising(edges: Index) -> Array:
        """0 for edges along which s and t rise together, or one of them stays."""
        by_s, by_t = (np.diff(each[edges], axis=1)[:, 0] for each in (s, t))
        return np.maximum(-by_s * by_t, 0.0)

    triangulation = StripTriangulation.of(lines, below, above, t, rising).flip(rising)
    places, _ = triangulation.diagonals()
    assert rising(np.stack((triangulation.a[places[:, 0]], triangulation.b[places[:, 1]]), axis=1)).max() == 0.0
