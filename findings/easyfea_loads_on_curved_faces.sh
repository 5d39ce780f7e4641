#!/usr/bin/env bash
# EasyFEA 7.1.0: curved faces and edges of second order have the area and length of their chords, and loads on them are off.
# Expected: faces of HEXA20 and TETRA10 (QUAD8, TRI6) are curved as the volume elements are, whose volume is right; a traction of
#   1 MPa along z on the side of a cylinder is the area in N, and a pressure of 1 MPa on half of it is diameter times length.
# Seen: each face is integrated over its projection on a plane, each edge over its chord. With eight elements round a cylinder the
#   volume is 0.9992 of the exact one, the area of the side 0.9745, as of the inscribed octagon, and so is the load. The pressure has
#   the curved normals on the flat area: its resultant is 1.0234 (HEXA20) and 1.0069 (TETRA10) of the right one. No warning.
# Versions: EasyFEA 7.1.0, gmsh 4.15.2, numpy 2.4.6, scipy 1.17.1, vtk 9.7.2.
# Meets: whoever loads bores, journals and tooth flanks of meshes of second order, and sums reactions against the load.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q EasyFEA==7.1.0 gmsh==4.15.2 numpy==2.4.6 scipy==1.17.1 vtk==9.7.2
cd "$folder"
"$folder/venv/bin/python" - 2>/dev/null <<'END'
import numpy as np
from EasyFEA import ElemType, Mesher, Models, Simulations
from EasyFEA.Geoms import Circle

RADIUS, LENGTH = 5.0, 7.0
SIDE = 2.0 * np.pi * RADIUS * LENGTH


def loaded(kind):
    """Volume, area of the side, axial load and resultant of the pressure on half the side, each over its exact value."""
    mesh = Mesher().Mesh_Extrude(Circle((0, 0), 2.0 * RADIUS, 5.0), [], [0, 0, LENGTH], [3], kind)
    x, y, z = mesh.coord.T
    side = np.flatnonzero(abs(np.hypot(x, y) - RADIUS) < 1e-6)
    faces = sum(group.area for group in mesh.Get_list_groupElem(2))
    ends = 2.0 * mesh.volume / LENGTH

    def force(load, nodes, *values):
        simulation = Simulations.Elastic(mesh, Models.Elastic.Isotropic(3, E=2.1e5, v=0.3))
        simulation.add_dirichlet(np.flatnonzero(z < 1e-9), [0, 0, 0], ["x", "y", "z"])
        getattr(simulation, load)(nodes, *values)
        vector = simulation.Bc_vector_Neumann()
        return np.asarray(vector.todense() if hasattr(vector, "todense") else vector).reshape(-1, 3).sum(axis=0)

    axial = force("add_surfLoad", side, [1.0], ["z"])[2]
    across = abs(force("add_pressureLoad", side[x[side] > -1e-9], 1.0)[0])
    ratios = (mesh.volume / (np.pi * RADIUS**2 * LENGTH), (faces - ends) / SIDE, axial / SIDE, across / (2.0 * RADIUS * LENGTH))
    print(f"{kind}: volume, area of the side, axial load, resultant of pressure over exact: " + ", ".join(f"{v:.4f}" for v in ratios))
    return ratios


OCTAGON = np.sin(np.pi / 8.0) / (np.pi / 8.0)
for kind, pressure in ((ElemType.HEXA20, 1.0234), (ElemType.TETRA10, 1.0069)):
    volume, area, axial, across = loaded(kind)
    assert abs(volume - 1.0) < 1e-3
    assert abs(area - OCTAGON) < 1e-6 and abs(axial - OCTAGON) < 1e-6, "curved faces have another area now"
    assert abs(across - pressure) < 1e-3, "the pressure has another resultant now"
END
