#!/usr/bin/env bash
# lsdyna-mesh-reader 0.2.1: a hexahedron of 20 nodes (*ELEMENT_SOLID_H20) is read as two elements of eight wrong nodes.
# Expected: one element with its 20 nodes, or at least its 8 corners; or a refusal, since only elements of first order are supported.
# Seen: one element 1 of part 1 with nodes 1 to 20 comes back as two: element 1 with nodes 0 to 7, and element 11 of part 12 with nodes
#   13 to 20, number and part of which are the 11th and 12th node. No warning and no error.
# Versions: lsdyna-mesh-reader 0.2.1 (NumPy 2.4.6).
# Meets: whoever looks at, converts or checks a mesh of second order of LS-DYNA by this reader.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q lsdyna-mesh-reader==0.2.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import lsdyna_mesh_reader

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
points = [tuple(map(float, corner)) for corner in CORNERS]
points += [tuple((x + y) / 2.0 for x, y in zip(points[a], points[b])) for a, b in EDGES]
nodes = "".join(f"{k:8d}" + "".join(f"{x:16.9f}" for x in point) + "\n" for k, point in enumerate(points, 1))
numbers = "".join("".join(f"{k:8d}" for k in range(first, first + 10)) + "\n" for first in (1, 11))
with open("cube.k", "w") as file:
    file.write(f"*KEYWORD\n*NODE\n{nodes}*ELEMENT_SOLID_H20\n{1:8d}{1:8d}\n{numbers}*END\n")
deck = lsdyna_mesh_reader.Deck("cube.k")
(section,) = deck.element_solid_sections
print(section)
print(f"elements in the file: 1; read: {len(section)}")
assert len(section) == 2, "it reads one element now"
END
