#!/usr/bin/env bash
# ansys-mapdl-reader 0.56.0: prisms of ANSYS archives are inside out in its VTK grids, and valid prisms are written inside out.
# Expected: a prism of a SOLID185 or SOLID186 is a hexahedron I, J, K, K, M, N, O, O, right-handed as hexahedra are, and VTK's wedge
#   with a positive volume is I, J, K, M, N, O. Hexahedra are taken over as they are, and are right.
# Seen: the wedge is K, J, I, O, N, M. In the package's own example sector.cdb all 101 hexahedra have positive volumes in VTK and all
#   4 prisms negative ones. A VTK wedge of +0.5 that `save_as_archive` writes is an element of volume -0.5, as its hexahedron of eight
#   corners integrates to. Its own `quality` is positive for the wrong order and -1.15 for the right one. The same for SOLID186 with
#   mid-side nodes, which lie on their edges. No warning. A round trip turns the order twice and looks right.
# Versions: ansys-mapdl-reader 0.56.0, pyvista 0.49.1, vtk 9.7.2, matplotlib 3.11.2, numpy 2.4.6.
# Meets: whoever integrates, clips or checks meshes of ANSYS with prisms in PyVista or ParaView, or sends swept meshes to ANSYS.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q ansys-mapdl-reader==0.56.0 pyvista==0.49.1 vtk==9.7.2 matplotlib==3.11.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'END'
import numpy as np
import pyvista as pv
from ansys.mapdl.reader import Archive, examples, save_as_archive

SIGNS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float)


def integral(corners):
    """Volume of a trilinear hexahedron (8, 3), by Gauss's rule of two points a direction."""
    volume = 0.0
    for point in SIGNS / np.sqrt(3.0):
        factors = 1.0 + SIGNS * point
        slopes = np.stack([SIGNS[:, k] * np.delete(factors, k, axis=1).prod(axis=1) for k in range(3)]) / 8.0
        volume += np.linalg.det(slopes @ corners)
    return volume


grid = Archive(examples.sector_archive_file).grid
volumes = grid.compute_cell_sizes()["Volume"]
hexahedra, prisms = (volumes[grid.celltypes == kind] for kind in (pv.CellType.HEXAHEDRON, pv.CellType.WEDGE))
print(f"example: {len(hexahedra)} hexahedra from {hexahedra.min():.2e}, {len(prisms)} prisms up to {prisms.max():.2e}")
assert len(hexahedra) == 101 and len(prisms) == 4 and hexahedra.min() > 0.0
assert prisms.max() < 0.0, "prisms are right now"

corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], float)
middles = [corners[list(edge)].mean(axis=0) for edge in ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))]
for kind, points in ((pv.CellType.WEDGE, corners), (pv.CellType.QUADRATIC_WEDGE, np.vstack((corners, middles)))):
    wedge = pv.UnstructuredGrid([len(points), *range(len(points))], [kind], points)
    save_as_archive("wedge.cdb", wedge)
    archive = Archive("wedge.cdb")
    written = archive.elem[0][10:18]
    volume, own = wedge.compute_cell_sizes()["Volume"][0], float(archive.quality[0])
    print(f"{len(points)} nodes: {volume:.3f} in VTK, written as {written}: {integral(points[written - 1]):.3f}, own quality {own:.3f}")
    assert abs(volume - 0.5) < 1e-12 and abs(integral(points[[0, 1, 2, 2, 3, 4, 5, 5]]) - 0.5) < 1e-12
    assert abs(integral(points[written - 1]) + 0.5) < 1e-12 and own < 0.0, "prisms are written right now"
END
