"""Surface that a ball-end cutter leaves, from a cutter location file alone: spheres one after the other along every way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]

#: mm: how far spheres one after the other stay from what is swept between them
BETWEEN = 5e-5
#: mm: heights that are looked for
REACH = 0.12


def positions(file: Path) -> tuple[float, Array, Array, NDArray[np.bool_]]:
    """Radius of the ball, tips and axes (K, 3), and which positions are gone to in rapid."""
    rows, rapid, radius, next_is_rapid = [], [], 0.0, False
    for line in file.read_text().splitlines():
        word, _, values = line.partition("/")
        if word == "CUTTER":
            diameter, radius = map(float, values.split(",")[:2])
            assert diameter == 2.0 * radius
        elif word == "GOTO":
            rows.append([float(value) for value in values.split(",")])
            rapid.append(next_is_rapid)
        next_is_rapid = word == "RAPID"
    table = np.array(rows)
    return radius, table[:, :3], table[:, 3:], np.array(rapid)


def spheres(file: Path) -> tuple[float, Array]:
    """Radius of the ball and its centres while it cuts: the tip goes straight, and the axis turns with it."""
    radius, tips, axes, rapid = positions(file)
    step, centres = np.sqrt(8.0 * radius * BETWEEN), []
    for k in np.flatnonzero(~rapid[1:]):
        count = int(np.ceil(np.linalg.norm(tips[k + 1] - tips[k]) / step)) + 1
        share = np.linspace(0.0, 1.0, count + 1)[:, None]
        axis = axes[k] + share * (axes[k + 1] - axes[k])
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
        centres.append(tips[k] + share * (tips[k + 1] - tips[k]) + radius * axis)
    return radius, np.concatenate(centres)


def heights(file: Path, points: Array, normals: Array) -> Array:
    """Heights (Q,), mm, along unit normals over points (Q, 3) at which the first sphere is; infinite beyond REACH."""
    radius, centres = spheres(file)
    found = np.full(len(points), np.inf)
    for q, near in enumerate(cKDTree(centres).query_ball_point(points, radius + REACH)):
        way = centres[near] - points[q]
        along = way @ normals[q]
        left = radius**2 - ((way - along[:, None] * normals[q]) ** 2).sum(axis=1)
        over = along[left > 0.0] - np.sqrt(left[left > 0.0])
        found[q] = over.min(initial=np.inf)
    return found
