#!/usr/bin/env bash
# meshio 5.3.5: volume elements that it writes to MED files, or reads from them, are inside out.
# Expected: a unit cube of one hexahedron, written as .med, is a valid cube in other programs; a mesh that gmsh writes as .med
#   comes back from `meshio.read` with positive Jacobians, as from .msh.
# Seen: MED numbers the corners of tetrahedra, prisms and hexahedra in the other sense than VTK and Abaqus do. gmsh changes the order on
#   both ways, meshio on neither: gmsh finds a scaled Jacobian of -1 in meshio's cube, and all elements that meshio reads
#   are negative. No warning. Read and written by meshio, the two faults cancel, so that a round trip looks right.
# Versions: meshio 5.3.5 (h5py 3.16.0), gmsh 4.15.2.
# Meets: whoever takes a mesh to Code_Aster or Salome by meshio, or from there to a solver.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q meshio==5.3.5 h5py==3.16.0 gmsh==4.15.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import gmsh
import meshio
import numpy as np

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
CELLS = {"hexahedron": [[0, 1, 2, 3, 4, 5, 6, 7]], "wedge": [[0, 1, 3, 4, 5, 7]], "tetra": [[0, 1, 3, 4]]}
FROM_FIRST = {"hexahedron": (1, 3, 4), "wedge": (1, 2, 3), "tetra": (1, 2, 3)}
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)


def determinant(mesh):
    """Smallest determinant of the three edges at the first corner of an element; positive in a valid one."""
    (block,) = (block for block in mesh.cells if block.type in CELLS)
    corners = mesh.points[block.data]
    return float(np.linalg.det(np.stack([corners[:, k] - corners[:, 0] for k in FROM_FIRST[block.type]], axis=1)).min())


def seen_by_gmsh(file):
    gmsh.clear()
    gmsh.open(file)
    (kind,) = gmsh.model.mesh.getElementTypes(3)
    tags, _ = gmsh.model.mesh.getElementsByType(kind)
    return float(min(gmsh.model.mesh.getElementQualities(tags, "minSJ")))


for kind, cells in CELLS.items():
    valid = meshio.Mesh(CORNERS, [(kind, cells)])
    assert determinant(valid) > 0.0
    tags = {name: [np.ones(1, int)] for name in ("gmsh:physical", "gmsh:geometrical")}
    tagged = meshio.Mesh(CORNERS, [(kind, cells)], cell_data=tags)
    meshio.write("med.med", valid)
    meshio.write("msh.msh", tagged, file_format="gmsh22", binary=False)
    read_msh, read_med = seen_by_gmsh("msh.msh"), seen_by_gmsh("med.med")
    gmsh.clear()
    gmsh.open("msh.msh")
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="body")
    gmsh.write("back.med")
    assert seen_by_gmsh("back.med") > 0.0
    back, again = determinant(meshio.read("back.med")), determinant(meshio.read("med.med"))
    print(f"{kind}: scaled Jacobian in gmsh by .msh {read_msh:.2f}, by .med {read_med:.2f}; "
          f"determinant in meshio of gmsh's .med {back:.2f}, of its own {again:.2f}")
    assert read_msh > 0.0 and again > 0.0
    assert read_med < 0.0, "meshio writes MED in its order now"
    assert back < 0.0, "meshio reads MED in its order now"
END
