#!/usr/bin/env bash
# femlabpy 0.6.2: linear tetrahedra are 12 times too stiff, with a negative stiffness where their nodes are in the order of gmsh.
# Expected: `keT4e` is "the exact volume integral of B.T @ C @ B", `qeT4e` "the element volume times B.T @ Se". Under a uniform strain the energy is
#   that of the volume, forces and stiffness times displacements are one, and bricks and tetrahedra of one cube stretch alike: by F L / (E A).
# Seen: a right-handed tetrahedron (corners 0, x, y, z, as meshers have them) has -12 times the energy, one with two
#   corners exchanged 12 times; its forces are -6 and 6 times, so that an iteration on the two cannot come to rest. A cube of six
#   tetrahedra is pressed by a load that pulls, by a twelfth of the right amount. Stresses and strains, masses, and bricks (`keh8e`) are
#   right. Natural frequencies of such a stiffness are 3.5 times too high, or imaginary. No warning.
# Versions: femlabpy 0.6.2, numpy 2.4.6, scipy 1.17.1, matplotlib 3.11.2.
# Meets: whoever learns or checks finite elements on meshes of tetrahedra, which is what meshers make of gears and housings.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q femlabpy==0.6.2 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
MPLBACKEND=Agg "$folder/venv/bin/python" - <<'END'
import numpy as np
from femlabpy import keh8e, keT4e, meT4e, qeT4e

YOUNG, POISSON, DENSITY, SIDE, FORCE = 200000.0, 0.3, 7.8e-9, 10.0, 500.0
MATERIAL = np.array([YOUNG, POISSON, DENSITY])
CUBE = SIDE * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
BRICK = [[0, 1, 2, 3, 4, 5, 6, 7]]
TETRAHEDRA = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]


def volume(corners):
    return np.linalg.det(corners[1:] - corners[0]) / 6.0


def stretch(elements, stiffness):
    """Lengthening along z under a force that pulls, of a cube on supports that let it narrow."""
    total = np.zeros((24, 24))
    for element in elements:
        freedoms = np.array([3 * node + axis for node in element for axis in range(3)])
        total[np.ix_(freedoms, freedoms)] += stiffness(CUBE[element], MATERIAL[:2])
    # z at the bottom, x and y at the corner on the axis, y at its neighbour along x
    free = np.setdiff1d(np.arange(24), [2, 5, 8, 11, 0, 1, 4])
    loads, moves = np.zeros(24), np.zeros(24)
    # shares of a uniform traction: a quarter for each corner of a brick, a third for each corner of the two triangles on top
    shares = (3, 3, 3, 3) if elements is BRICK else (4, 2, 4, 2)
    loads[14::3] = FORCE * np.array(shares) / 12.0
    moves[free] = np.linalg.solve(total[np.ix_(free, free)], loads[free])
    return moves[[14, 17, 20, 23]].mean()


expected = FORCE * SIDE / (YOUNG * SIDE**2)
right, seen = stretch(BRICK, keh8e), stretch(TETRAHEDRA, keT4e)
print(f"closed form {expected:.6f} mm, brick {right:.6f} mm, six tetrahedra {seen:.6f} mm: {seen / expected:.4f} of it")
assert all(volume(CUBE[element]) > 0.0 for element in TETRAHEDRA)
assert abs(right / expected - 1.0) < 1e-9

stiff = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
ratios = []
for order in ([0, 1, 3, 4], [0, 3, 1, 4]):
    corners = CUBE[order]
    moves = (corners * (1e-3, 0.0, 0.0)).ravel()
    forces, stress, _ = (np.ravel(part) for part in qeT4e(corners, MATERIAL[:2], moves[:, None]))
    energy = stiff * 1e-6 * abs(volume(corners))
    ratios.append((moves @ keT4e(corners, MATERIAL[:2]) @ moves / energy, moves @ forces / energy))
    mass = meT4e(corners, MATERIAL)[::3, ::3].sum() / (DENSITY * abs(volume(corners)))
    print(f"corners {order}: energy {ratios[-1][0]:.4f}, of its forces {ratios[-1][1]:.4f}, mass {mass:.4f} of the right ones")
    assert abs(stress[0] / (stiff * 1e-3) - 1.0) < 1e-9 and abs(mass - 1.0) < 1e-9
assert np.allclose(ratios, [(-12.0, -6.0), (12.0, 6.0)], rtol=1e-6), "tetrahedra have their stiffness now"
assert abs(seen / expected + 1.0 / 12.0) < 1e-6, "tetrahedra stretch as they should now"
END
