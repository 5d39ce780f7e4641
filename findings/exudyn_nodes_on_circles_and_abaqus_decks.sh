#!/usr/bin/env bash
# exudyn 1.13.6: nodes on a circle are not found within the tolerance, and Abaqus decks lose all blocks of elements but the first.
# Expected: `GetNodesOnCircle(..., tolerance)` gives the nodes within this distance of the circle, as `GetNodesOnCylinder` does for a
#   cylinder. `ImportFromAbaqusInputFile` reads a part of C3D8 whose elements stand in two blocks, and takes nodes by their numbers.
# Seen: the circle compares |d^2 - r^2| with the square of the tolerance, a length of 5e-12 mm for r = 10 mm and 1e-5 mm. Of 24 nodes around
#   a bore of 25 mm, written with 4 decimals (up to 0.000043 mm off), 4 are found with 0.01 mm, 24 on the cylinder. Of two stacked cubes
#   one comes when each has its own `*Element` line. When nodes do not stand in the order of their numbers, the element has other corners:
#   a volume of 1.3333 for 2. No warning in any case.
# Versions: exudyn 1.13.6, numpy 2.4.6, scipy 1.17.1.
# Meets: whoever couples the bore of a flexible gear or housing to a shaft, with a mesh from a file.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q exudyn==1.13.6 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import numpy as np
from exudyn.FEM import FEMinterface

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
CORNERS = np.vstack([np.column_stack([SQUARE, np.full(4, height)]) for height in (0.0, 1.0, 2.0)])
LOWER, UPPER = "1, 1, 2, 3, 4, 5, 6, 7, 8", "2, 5, 6, 7, 8, 9, 10, 11, 12"
HEAD = "*Element, type=C3D8"
RADIUS = 25.0


def volume(elements, order=range(12)):
    """Volume inside the surface triangles of a deck with these lines of elements."""
    nodes = [f"{k + 1}, {CORNERS[k, 0]}, {CORNERS[k, 1]}, {CORNERS[k, 2]}" for k in order]
    with open("deck.inp", "w") as file:
        file.write("\n".join(["*Part, name=Part-1", "*Node", *nodes, *elements, "*End Part", ""]))
    model = FEMinterface()
    model.ImportFromAbaqusInputFile("deck.inp")
    a, b, c = np.moveaxis(model.GetNodePositionsAsArray()[np.array(model.GetSurfaceTriangles())], 1, 0)
    return abs(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6.0


one = volume([HEAD, LOWER, UPPER])
two = volume([HEAD, LOWER, HEAD, UPPER])
shuffled = volume([HEAD, LOWER, UPPER], order=[3, 0, 1, 2, *range(4, 12)])
print(f"volume of two cubes: one block {one:.4f}, two blocks {two:.4f}, nodes in another order {shuffled:.4f}")
angles = np.linspace(0.0, 2.0 * np.pi, 25)[:-1]
model = FEMinterface()
model.nodes["Position"] = np.round(RADIUS * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(24)]), 4)
off = np.abs(np.linalg.norm(model.nodes["Position"], axis=1) - RADIUS).max()
circle = len(model.GetNodesOnCircle([0, 0, 0], [0, 0, 1], RADIUS, tolerance=0.01))
cylinder = len(model.GetNodesOnCylinder(np.array([0, 0, -1.0]), np.array([0, 0, 1.0]), RADIUS, tolerance=0.01))
print(f"24 nodes up to {off:.6f} mm off: on the circle {circle}, on the cylinder {cylinder}, tolerance 0.01 mm")
assert abs(one - 2.0) < 1e-9 and cylinder == 24 and off < 1e-4
assert abs(two - 1.0) < 1e-9, "a second block of elements is read now"
assert abs(shuffled - 4.0 / 3.0) < 1e-9, "nodes are taken by their numbers now"
assert circle == 4, "nodes on a circle are found within the tolerance now"
END
