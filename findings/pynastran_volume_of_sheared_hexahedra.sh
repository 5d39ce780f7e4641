#!/usr/bin/env bash
# pyNastran 1.4.1: volume and mass of a hexahedron (CHEXA) are wrong unless its upright edges stand square on both ends.
# Expected: a unit cube has a volume of 1, and so has the same cube sheared (Cavalieri); a frustum whose top is half as wide has
#   (1 + 1/2 + 1/4) / 3 = 0.5833. mass_properties has the density times that.
# Seen: the mean area of faces 1-4 and 5-8 times the distance of their centres: 1.4142 for a shear of 45 deg (41 % more), 0.6250 for
#   the frustum (7 % more). The mass follows.
# Versions: pyNastran 1.4.1 (NumPy 1.26.4).
# Meets: whoever checks mass and volume of a mesh of hexahedra before it is solved.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q pyNastran==1.4.1 numpy==1.26.4
"$folder/venv/bin/python" - <<'END'
import numpy as np
from pyNastran.bdf.bdf import BDF
from pyNastran.bdf.mesh_utils.mass_properties import mass_properties

CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)


def measured(corners):
    model = BDF(debug=False, log=None)
    for number, corner in enumerate(corners, 1):
        model.add_grid(number, corner.tolist())
    model.add_chexa(1, 1, list(range(1, 9)))
    model.add_psolid(1, 1)
    model.add_mat1(1, 2e5, None, 0.3, rho=2.0)
    model.cross_reference()
    mass, _, _ = mass_properties(model)
    return model.elements[1].Volume(), float(mass) / 2.0


sheared, frustum = CUBE.copy(), CUBE.copy()
sheared[:, 0] += sheared[:, 2]
frustum[4:, :2] = 0.25 + 0.5 * frustum[4:, :2]
for name, corners, exact in (
    ("cube", CUBE, 1.0),
    ("sheared cube", sheared, 1.0),
    ("frustum", frustum, 1.75 / 3.0),
):
    volume, of_mass = measured(corners)
    print(f"{name}: volume {volume:.4f}, mass over density {of_mass:.4f}, exact {exact:.4f}")
assert abs(measured(CUBE)[0] - 1.0) < 1e-12
assert abs(measured(sheared)[0] - np.sqrt(2.0)) < 1e-12, "the sheared cube has another volume now"
assert abs(measured(frustum)[1] - 0.625) < 1e-12, "the frustum has another mass now"
END
