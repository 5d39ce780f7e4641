#!/usr/bin/env bash
# ngsolve 6.2.2608 (netgen-mesher 6.2.2608): curved prisms of second order are straight half-way between their triangles.
# Expected: `ReadGmsh` reads prisms of 15 nodes and, as with tetrahedra of 10, hexahedra of 20 and pyramids of 13 nodes, the elements are
#   those of the file: mid-side nodes of the triangles carry 4 a b (1 - z), so that an extruded arc stays an arc over its height.
# Seen: the nodes are in order, but their share falls as (1 - z)(1 - 2 z). A prism with one side that bulges by 0.1 at both ends has a
#   volume of 0.5222 for 0.5667. A quarter of a ring (radii 5 and 10, height 3) has 173.707 of prisms, where gmsh and NGSolve have 176.706 of
#   hexahedra with the same arcs, and gmsh has 176.706 of the prisms. Mass and stiffness are those of the wrong body. No warning.
# Versions: ngsolve 6.2.2608, netgen-mesher 6.2.2608, gmsh 4.15.2, numpy 2.4.6.
# Meets: whoever solves extruded or swept meshes of prisms with curved sides: rims, shafts, gears meshed with triangles on the end face.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q ngsolve==6.2.2608 netgen-mesher==6.2.2608 gmsh==4.15.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'END' 2>&1 | grep -v "Physical groups detected"
import math

import gmsh
import numpy as np
from netgen.read_gmsh import ReadGmsh
from ngsolve import CF, Integrate, Mesh

# gmsh's own order of the edges of a prism
EDGES = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)]
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], float)


def volumes(path):
    """Volume by gmsh and by NGSolve of the model that gmsh has."""
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    gmsh.write(path)
    (kind,) = gmsh.model.mesh.getElementTypes(3)
    local, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss6")
    by_gmsh = gmsh.model.mesh.getJacobians(kind, local)[1].reshape(-1, len(weights)) @ weights
    return float(by_gmsh.sum()), Integrate(CF(1), Mesh(ReadGmsh(path)), order=8)


def prism(bulge):
    gmsh.clear()
    nodes = np.vstack([CORNERS, [CORNERS[list(edge)].mean(axis=0) for edge in EDGES]])
    nodes[[6 + EDGES.index((0, 1)), 6 + EDGES.index((3, 4))], 1] -= bulge
    gmsh.model.addDiscreteEntity(3, 1)
    gmsh.model.mesh.addNodes(3, 1, range(1, 16), nodes.ravel())
    gmsh.model.mesh.addElementsByType(1, 18, [1], range(1, 16))
    return volumes("prism.msh")


def ring(hexahedra):
    gmsh.clear()
    build, mesh = gmsh.model.occ, gmsh.model.mesh
    centre = build.addPoint(0, 0, 0)
    a, b, c, d = (build.addPoint(*point, 0) for point in [(5, 0), (0, 5), (10, 0), (0, 10)])
    arcs = [build.addCircleArc(a, centre, b), build.addCircleArc(c, centre, d)]
    lines = [build.addLine(b, d), build.addLine(a, c)]
    face = build.addPlaneSurface([build.addCurveLoop([arcs[0], lines[0], -arcs[1], -lines[1]])])
    build.synchronize()
    for curves, number in ((arcs, 5), (lines, 3)):
        for curve in curves:
            mesh.setTransfiniteCurve(curve, number)
    mesh.setTransfiniteSurface(face)
    if hexahedra:
        mesh.setRecombine(2, face)
    build.extrude([(2, face)], 0, 0, 3, [2], recombine=True)
    build.synchronize()
    mesh.generate(3)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    mesh.setOrder(2)
    return volumes("ring.msh")


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
found = {"straight prism": prism(0.0), "bulging prism": prism(0.1), "ring of hexahedra": ring(True), "ring of prisms": ring(False)}
for name, (by_gmsh, by_ngsolve) in found.items():
    print(f"{name}: gmsh {by_gmsh:.4f}, NGSolve {by_ngsolve:.4f}")
print(f"exact ring {0.25 * math.pi * 75 * 3:.4f}")
for name in ("straight prism", "ring of hexahedra"):
    assert abs(found[name][0] - found[name][1]) < 1e-9
assert abs(found["bulging prism"][0] - 0.5 - 0.2 / 3.0) < 1e-9 and abs(found["ring of prisms"][0] - found["ring of hexahedra"][0]) < 1e-6
assert abs(found["bulging prism"][1] - 0.5 - 0.2 / 9.0) < 1e-9, "prisms of 15 nodes are curved all the way now"
assert abs(found["ring of prisms"][1] - 173.707) < 1e-3, "prisms of 15 nodes are curved all the way now"
gmsh.finalize()
END
test "${PIPESTATUS[0]}" = 0
