#!/usr/bin/env bash
# gmsh 4.15.2: the volume of second-order tetrahedra is that of straight ones, where all other second-order elements are curved.
# Expected: `getElementQualities(tags, "volume")` and the plugin MeshVolume integrate over the curved element, as the Jacobians
#   that gmsh itself returns do. For hexahedra and prisms of second order they do, to 1e-12.
# Seen: for tetrahedra of ten nodes both leave the mid-side nodes out. Of a cylinder (radius 5 mm, elements of 2 mm) they say
#   155.51 mm3, the same as before `setOrder(2)`; integrated over the elements it is 157.078, and exactly 157.080. No warning.
# Versions: gmsh 4.15.2 (numpy 2.4.6).
# Meets: whoever checks volume or mass of a tetrahedral mesh against the CAD part: curved parts seem 1 % too light, and going
#   to second order seems to change nothing.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q gmsh==4.15.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import gmsh
import numpy as np

RADIUS, HEIGHT = 5.0, 2.0
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeMax", 2.0)


def volumes(order, swept):
    """Volume by element qualities, by the plugin, and by integration of the Jacobians that gmsh returns."""
    gmsh.clear()
    if swept:  # prisms
        gmsh.model.occ.extrude([(2, gmsh.model.occ.addDisk(0, 0, 0, RADIUS, RADIUS))], 0, 0, HEIGHT, [2], recombine=True)
    else:
        gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, HEIGHT, RADIUS)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)
    (kind,) = gmsh.model.mesh.getElementTypes(3)
    tags, _ = gmsh.model.mesh.getElementsByType(kind)
    points, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss8")
    _, determinants, _ = gmsh.model.mesh.getJacobians(kind, points)
    gmsh.plugin.setNumber("MeshVolume", "Dimension", 3)
    gmsh.plugin.run("MeshVolume")
    plugin = gmsh.view.getListData(gmsh.view.getTags()[-1])[2][0][-1]
    integral = float((np.array(determinants).reshape(-1, len(weights)) @ np.array(weights)).sum())
    name = gmsh.model.mesh.getElementProperties(kind)[0]
    quality = float(np.sum(gmsh.model.mesh.getElementQualities(tags, "volume")))
    print(f"{name}: qualities {quality:.4f}, plugin {plugin:.4f}, integral {integral:.4f} mm3")
    return quality, plugin, integral


exact = np.pi * RADIUS**2 * HEIGHT
print(f"exact: {exact:.4f} mm3")
straight, (quality, plugin, integral), prisms = volumes(1, False), volumes(2, False), volumes(2, True)
assert np.ptp(straight) < 1e-9 * exact and np.ptp(prisms) < 1e-9 * exact
assert abs(integral / exact - 1.0) < 1e-4
assert abs(quality / straight[0] - 1.0) < 1e-9 and abs(plugin / straight[0] - 1.0) < 1e-9, "volumes of tetrahedra are curved now"
assert 1.0 - quality / integral > 0.005
END
