#!/usr/bin/env bash
# frd2vtu 0.2.1: mid-side nodes of C3D15 prisms go to wrong edges, those of C3D20 and C3D10 to the right ones.
# Expected: each mid-side node of VTK's quadratic wedge lies on its edge; a straight prism has its volume and a positive Jacobian.
# Seen: result files of CalculiX have the nodes of the upright edges before those of the upper triangle, VTK and the solver's
#   input after them. frd2vtu turns them round for hexahedra and not for prisms: six nodes change places, the volume of a prism of
#   0.5 is 0.0417, surfaces are folded, and smooth displacements look torn. Values at nodes are right. No warning.
# Versions: frd2vtu 0.2.1, pyvista 0.49.1, vtk 9.7.2, pandas 3.1.1, numpy 2.4.6; calculix-ccx 2.20-1 of Debian 12.
# Meets: whoever looks at extruded or swept meshes of second order (C3D15) in ParaView by way of frd2vtu.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -q calculix-ccx=2.20-1 libspooles2.2 libarpack2 libblas3 liblapack3 libgfortran5 >apt.log
for package in *.deb; do dpkg -x "$package" root; done
python3 -m venv venv
venv/bin/pip install -q frd2vtu==0.2.1 pyvista==0.49.1 vtk==9.7.2 pandas==3.1.1 numpy==2.4.6
library="$folder/root/usr/lib/$(uname -m)-linux-gnu"
LD_LIBRARY_PATH="$library:$library/blas:$library/lapack" OMP_NUM_THREADS=1 venv/bin/python - <<'END'
import subprocess

import numpy as np
from frd2vtu import frdbin2vtu

PRISM = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], float)
CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
# corners at the ends of each mid-side node's edge, in the order of the solver's input and of VTK
EDGES = {
    "C3D15": [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
    "C3D20": [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
}


def converted(kind, corners):
    """Largest distance of mid-side nodes from the middle of their edges, and the volume, of one element."""
    nodes = np.vstack((corners, [corners[list(edge)].mean(axis=0) for edge in EDGES[kind]]))
    numbers = [str(n) for n in range(1, len(nodes) + 1)]
    deck = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(nodes, 1))
    deck += f"*ELEMENT, TYPE={kind}, ELSET=BODY\n1, " + ", ".join(numbers[:15]) + ("," if numbers[15:] else "") + "\n"
    deck += ", ".join(numbers[15:]) + "\n" if numbers[15:] else ""
    deck += "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL\n"
    deck += "*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 1, 3\n*STEP\n*STATIC\n*CLOAD\n5, 1, 10.\n*NODE OUTPUT\nU\n*END STEP\n"
    with open(f"{kind}.inp", "w") as file:
        file.write(deck)
    done = subprocess.run(["root/usr/bin/ccx", kind], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-500:] + done.stderr
    grid = frdbin2vtu(f"{kind}.frd", ".")
    points = grid.points[grid.get_cell(0).point_ids]
    off = points[len(corners) :] - [points[list(edge)].mean(axis=0) for edge in EDGES[kind]]
    distance, volume = np.linalg.norm(off, axis=1).max(), grid.compute_cell_sizes()["Volume"][0]
    print(f"{kind}: mid-side nodes up to {distance:.3f} off their edges, volume {volume:.4f}")
    return distance, volume


distance, volume = converted("C3D20", CUBE)
assert distance < 1e-6 and abs(volume - 1.0) < 1e-6
distance, volume = converted("C3D15", PRISM)
assert distance > 0.5 and abs(volume - 0.0417) < 1e-3, "the nodes of prisms have other places now"
END
