#!/usr/bin/env bash
# ROSS 2.3.0 (ross-rotordynamics; 3.1.0 is the same): the axial force of helical gears is too small by the tangent of the pressure angle.
# Expected: the mesh is one spring along the normal of the teeth, a unit vector, and the axial force is the tangential force
#   times the tangent of the helix angle: 0.577 for 30 deg.
# Seen: 0.210 for a pressure angle of 20 deg. The axial component of the normal is sin(alpha) sin(beta), where it should be
#   cos(alpha) sin(beta), and the square of the normal's length is 0.808. Spur gears are right. No warning.
# Versions: ross-rotordynamics 2.3.0 with plotly 5.24.1, numpy 2.4.6 (Python 3.11); ross-rotordynamics 3.1.0 (Python 3.13).
# Meets: whoever takes the mesh stiffness of a helical pair into a rotor model: axial modes and thrust on bearings are
#   those of gears with a helix of 12 deg instead of 30 deg.
set -eo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q ross-rotordynamics==2.3.0 plotly==5.24.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - 2>/dev/null <<'END' | grep helix
import numpy as np
import ross
from ross.materials import steel

PRESSURE_ANGLE, RADIUS = np.radians(20.0), 0.025


def rotor(teeth, diameter, helix):
    shaft = [ross.ShaftElement(0.1, 0.0, 0.03, material=steel) for _ in range(2)]
    angles = {"pr_angle": PRESSURE_ANGLE, "helix_angle": helix}
    gear = ross.GearElement(n=1, m=2.0, Id=0.002, Ip=0.004, n_teeth=teeth, pitch_diameter=diameter, **angles)
    bearings = [ross.BearingElement(n=node, kxx=1e8, kzz=1e7, cxx=1e3) for node in (0, 2)]
    return ross.Rotor(shaft, [gear], bearings)


for degrees in (0.0, 15.0, 30.0):
    helix = np.radians(degrees)
    both = ross.MultiRotor(
        rotor(20, 2 * RADIUS, helix), rotor(40, 4 * RADIUS, -helix), coupled_nodes=(1, 1), gear_mesh_stiffness=2e8
    )
    coupling = both.coupling_matrix() if callable(both.coupling_matrix) else both.coupling_matrix
    # rows and columns: x, y, z and rotations about them; the rotation about z strains the mesh by the tangential arc
    length = coupling[0, 0] + coupling[1, 1] + coupling[2, 2]
    axial = abs(coupling[2, 5] / coupling[5, 5]) * RADIUS
    print(f"helix {degrees:4.1f} deg: square of the normal {length:.4f}, axial to tangential {axial:.4f}, should be {np.tan(helix):.4f}")
    assert abs(axial - np.tan(PRESSURE_ANGLE) * np.tan(helix)) < 1e-9, "the axial force is another one now"
    assert helix == 0.0 or length < 0.95, "the normal is a unit vector now"
END
