#!/usr/bin/env bash
# ccx2paraview 3.2.0: prisms (C3D6, C3D15) are inside out in its .vtu files, and E_Mises is 1.5 times the equivalent strain.
# Expected: a prism of the solver is a valid one in VTK, with a positive volume; in a bar under tension von Mises' equivalent
#   strain is 2/3 (1 + nu) times the axial strain, or the axial one itself where nu is 1/2.
# Seen: corners 2 and 3, and 5 and 6, change places. That suits the picture of a wedge in VTK's old file-format notes, not VTK: the
#   volume of a prism of 0.5 is -0.5, where corners in the order of the solver have 0.5. Hexahedra are right. E_Mises has the factor
#   of stresses: 1.3 times the axial strain for nu = 0.3, where 0.867 is right. No warning.
# Versions: ccx2paraview 3.2.0, pyvista 0.49.1, vtk 9.7.2, numpy 2.4.6; calculix-ccx 2.20-1 of Debian 12.
# Meets: whoever integrates, clips or measures quality of swept meshes in ParaView, or compares strains with a limit.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -q calculix-ccx=2.20-1 libspooles2.2 libarpack2 libblas3 liblapack3 libgfortran5 >apt.log
for package in *.deb; do dpkg -x "$package" root; done
python3 -m venv venv
venv/bin/pip install -q ccx2paraview==3.2.0 pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
library="$folder/root/usr/lib/$(uname -m)-linux-gnu"
LD_LIBRARY_PATH="$library:$library/blas:$library/lapack" OMP_NUM_THREADS=1 venv/bin/python - <<'END'
import subprocess

import numpy as np
import pyvista as pv
from ccx2paraview.common import Converter

POISSON, STRAIN = 0.3, 1e-3
CORNERS = {
    "C3D6": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]],
    "C3D8": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
}


def converted(kind):
    """Volume of one element under tension along z, and E_Mises over the axial strain."""
    nodes = np.array(CORNERS[kind], float)
    numbers = range(1, len(nodes) + 1)
    deck = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(nodes, 1))
    deck += f"*ELEMENT, TYPE={kind}, ELSET=BODY\n1, " + ", ".join(map(str, numbers)) + "\n"
    deck += f"*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., {POISSON}\n*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL\n*BOUNDARY\n1, 1, 3\n2, 2\n"
    deck += "*STEP\n*STATIC\n*BOUNDARY\n"
    deck += "".join(f"{n}, 3, 3, {STRAIN * nodes[n - 1, 2]}\n" for n in numbers)
    deck += "*EL FILE\nS, E\n*NODE FILE\nU\n*END STEP\n"
    with open(f"{kind}.inp", "w") as file:
        file.write(deck)
    done = subprocess.run(["root/usr/bin/ccx", kind], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-500:] + done.stderr
    Converter(f"{kind}.frd", ["vtu"]).run()
    grid = pv.read(f"{kind}.vtu")
    volume, strain = grid.compute_cell_sizes()["Volume"][0], grid["E_Mises"].mean() / STRAIN
    print(f"{kind}: volume {volume:.4f}, E_Mises {strain:.4f} times the axial strain, should be {2.0 / 3.0 * (1.0 + POISSON):.4f}")
    return volume, strain


cube, prism = converted("C3D8"), converted("C3D6")
right = pv.UnstructuredGrid(np.array([6, *range(6)]), [pv.CellType.WEDGE], np.array(CORNERS["C3D6"], float))
assert abs(right.compute_cell_sizes()["Volume"][0] - 0.5) < 1e-9
assert abs(cube[0] - 1.0) < 1e-6
assert abs(prism[0] + 0.5) < 1e-6, "prisms have another volume now"
assert abs(cube[1] - (1.0 + POISSON)) < 1e-3, "the equivalent strain is another one now"
END
