#!/usr/bin/env bash
# gmsh 4.15.2: hexahedra and prisms of second order in .bdf files of pyNastran 1.4.1 are read as first order; mid-side nodes are gone.
# Expected: continuation fields (the tenth of a line and the first of the next) may be blank in Nastran's small fields, as pyNastran
#   writes them, so that a CHEXA of 20 nodes on three lines is a hexahedron of 20 nodes; or gmsh refuses what it cannot follow.
# Seen: gmsh goes on to a third line only if the tenth field of the second is marked. Without marks CHEXA of 20 nodes has 8, and CPENTA
#   of 15 has 6; 12 and 9 nodes are dropped from the mesh. No warning: its log counts 20 nodes. A curved element loses its volume, too:
#   0.9000 of a cube with a face that bulges inwards becomes 1. CTETRA of 10 nodes, on two lines, is right, and so is "+" in the fields.
# Versions: gmsh 4.15.2, pyNastran 1.4.1 (NumPy 1.26.4).
# Meets: whoever looks at a Nastran model in gmsh, or converts it there, after pyNastran has written it.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q gmsh==4.15.2 pyNastran==1.4.1 numpy==1.26.4
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import gmsh
import numpy as np
from pyNastran.bdf.bdf import BDF

# corners, and edges of the mid-side nodes in Nastran's order: bottom, uprights, top
SHAPES = {
    "CHEXA": (
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)],
    ),
    "CPENTA": (
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
        [(0, 1), (1, 2), (2, 0), (0, 3), (1, 4), (2, 5), (3, 4), (4, 5), (5, 3)],
    ),
    "CTETRA": ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]),
}


def read(path):
    """Nodes of the one element, and its volume."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.logger.start()
    gmsh.open(path)
    (kind,) = gmsh.model.mesh.getElementTypes(3)
    nodes = gmsh.model.mesh.getElementProperties(kind)[3]
    local, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss4")
    volume = float(gmsh.model.mesh.getJacobians(kind, local)[1] @ weights)
    messages = [line for line in gmsh.logger.get() if not line.startswith("Info")]
    gmsh.logger.stop()
    gmsh.finalize()
    return nodes, volume, messages


found = {}
for name, (corners, edges) in SHAPES.items():
    corners = np.array(corners, float)
    points = np.vstack((corners, [corners[list(edge)].mean(axis=0) for edge in edges]))
    if name == "CHEXA":
        # the mid-side nodes of one side move in: a parabola over each of two edges
        points[[9, 17], 0] -= 0.15
    model = BDF(debug=False, log=None)
    for number, point in enumerate(points, 1):
        model.add_grid(number, point.tolist())
    getattr(model, f"add_{name.lower()}")(1, 1, list(range(1, len(points) + 1)))
    model.add_psolid(1, 1)
    model.add_mat1(1, 2e5, None, 0.3)
    model.write_bdf(f"{name}.bdf", enddata=True)
    lines = open(f"{name}.bdf").read().split("\n")
    start = next(k for k, line in enumerate(lines) if line.startswith(name))
    end = next(k for k in range(start + 1, len(lines)) if lines[k].startswith("$"))
    marked = [line.ljust(72) + "+" for line in lines[start : end - 1]] + lines[end - 1 : end]
    marked[1:] = ["+" + line[1:] for line in marked[1:]]
    with open(f"marked_{name}.bdf", "w") as file:
        file.write("\n".join([*lines[:start], *marked, *lines[end:]]))
    found[name] = (len(points), *read(f"{name}.bdf"), *read(f"marked_{name}.bdf"))
    print(f"{name} of {len(points)} nodes: gmsh has {found[name][1]}, volume {found[name][2]:.4f}, messages {found[name][3]}; "
          f"with marks {found[name][4]}, volume {found[name][5]:.4f}")
for count, _, _, messages, nodes, _, _ in found.values():
    assert nodes == count and not messages
assert found["CTETRA"][1] == 10
assert abs(found["CHEXA"][5] - 0.9) < 1e-6
assert (found["CHEXA"][1], found["CPENTA"][1]) == (8, 6), "gmsh has other nodes now"
assert abs(found["CHEXA"][2] - 1.0) < 1e-6
END
