#!/usr/bin/env bash
# ems-file-format-converter 0.6.0: I-DEAS universal files lose all nodes where exponents are D, and bricks of 20 nodes are folded both ways.
# Expected: coordinates of dataset 2411 are 1P3D25.16, with D as in Fortran, as gmsh writes them; a parabolic brick (116) goes round corner,
#   mid-side, corner, so that its nodes change places on the way to and from the order of meshio and VTK (corners first).
# Seen: a brick of gmsh's .unv comes back as a mesh without points and cells, exit without error. With E in place of D it has its 20
#   nodes in the order of the file: mid-side nodes stand at corners, up to 1.60 from the middle of their edges in a unit cube. A good
#   brick that it writes has Jacobians down to -0.83 in gmsh and a volume of 0.58 for 1. Round trips by itself look right. Bricks of 8
#   nodes are right. No warning.
# Versions: ems-file-format-converter 0.6.0, meshio 5.3.5, gmsh 4.15.2, numpy 2.4.6.
# Meets: whoever passes meshes of second order between gmsh, Salome or I-DEAS and Femap by way of it.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q ems-file-format-converter==0.6.0 meshio==5.3.5 gmsh==4.15.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'END'
from pathlib import Path

import gmsh
import meshio
import numpy as np
from ems_file_format_converter.io import read_mesh, write_mesh

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
# gmsh's own order of the edges of a brick
GMSH_EDGES = [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)]


def nodes_of(edges):
    return np.vstack([CORNERS, *(CORNERS[list(edge)].mean(axis=0)[None] for edge in edges)])


def by_gmsh(path):
    """Volume and smallest Jacobian of the bricks."""
    gmsh.open(path)
    (kind,) = gmsh.model.mesh.getElementTypes(3)
    local, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss4")
    determinants = gmsh.model.mesh.getJacobians(kind, local)[1]
    return float(determinants @ weights), float(determinants.min())


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.addDiscreteEntity(3, 1)
gmsh.model.mesh.addNodes(3, 1, range(1, 21), nodes_of(GMSH_EDGES).ravel())
gmsh.model.mesh.addElementsByType(1, 17, [1], range(1, 21))
gmsh.write("brick.unv")
assert abs(by_gmsh("brick.unv")[0] - 1.0) < 1e-9
first = read_mesh(Path("brick.unv"))
print(f"from gmsh: {len(first.points)} points, {len(first.cells)} blocks of cells")
text = Path("brick.unv").read_text()
head, tail = text.split("  2411\n")
Path("exponents.unv").write_text(head + "  2411\n" + tail.replace("D+", "E+").replace("D-", "E-"))
second = read_mesh(Path("exponents.unv"))
points = second.points[second.cells_dict["hexahedron20"][0]]
off = max(np.linalg.norm(points[8 + k] - points[list(edge)].mean(axis=0)) for k, edge in enumerate(EDGES))
print(f"with E: {len(second.points)} points, mid-side nodes up to {off:.3f} from the middle of their edges")
write_mesh(Path("written.unv"), meshio.Mesh(nodes_of(EDGES), [("hexahedron20", np.arange(20)[None])]))
volume, smallest = by_gmsh("written.unv")
print(f"written, read by gmsh: volume {volume:.4f}, smallest Jacobian {smallest:.3f}")
write_mesh(Path("linear.unv"), meshio.Mesh(CORNERS, [("hexahedron", np.arange(8)[None])]))
linear = by_gmsh("linear.unv")
assert abs(linear[0] - 1.0) < 1e-9
assert len(first.points) == 0 and not first.cells, "files of gmsh have nodes now"
assert off > 1.0, "bricks are read in another order now"
assert smallest < -0.5, "bricks are written in another order now"
gmsh.finalize()
END
