#!/usr/bin/env bash
# VTK 9.7.2 (PyVista 0.49.1): the scaled Jacobian of every quadratic hexahedron is -1, that of a perfect cube too.
# Expected: 1 for a cube with its mid-side nodes in the middles, as for the linear hexahedron.
# Seen: -1, which is what VTK has for cells that it knows no quality of. As a quality it says "inside out", and a filter
#   "below 0.2" marks all cells of a good second-order mesh. A linear cube is compared beside it, whose 1 is right.
# Versions: pyvista 0.49.1, vtk 9.7.2.
# Meets: whoever checks a C3D20 or HEX20 mesh in ParaView or PyVista before solving.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q pyvista==0.49.1 vtk==9.7.2
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import numpy as np
import pyvista as pv

corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
middles = np.array([0.5 * (corners[a] + corners[b]) for a, b in edges])


def quality(kind, points):
    grid = pv.UnstructuredGrid({kind: np.arange(len(points))[None]}, points)
    return {name: float(grid.cell_quality(name)[name][0]) for name in ("scaled_jacobian", "jacobian", "volume")}


linear = quality(pv.CellType.HEXAHEDRON, corners)
quadratic = quality(pv.CellType.QUADRATIC_HEXAHEDRON, np.concatenate((corners, middles)))
print("8 nodes:", linear)
print("20 nodes:", quadratic)
assert abs(linear["scaled_jacobian"] - 1.0) < 1e-12
assert quadratic["scaled_jacobian"] == -1.0, "quadratic hexahedra have a scaled Jacobian now"
END
