#!/usr/bin/env bash
# poekit 0.1.0: a screw with a pitch turns without moving along its axis, and the twist of a given motion is wrong even without a pitch.
# Expected: `exp_screw` of a twist (v, w) and an angle t is the matrix exponential; for pitch h the body moves h t along the axis.
#   `motion_2_twist` is its inverse.
# Seen: the term w w.v t is left out: a screw of pitch 3 mm/rad turned by 1 rad is 3 mm short, while `twist_pitch` of the same twist says
#   3. `motion_2_twist` of a turn of 1 rad about an axis through (5, 0, 0) says v = (0, -5, 5) where (0, -5, 0) is right: w w^T is taken
#   as a number and added to all nine elements of a matrix. Its twist has a pitch of 5 where the motion has none. No warning.
# Versions: poekit 0.1.0, sympy 1.14.0, numpy 2.4.6, scipy 1.17.1 (its matrix exponential compares).
# Meets: whoever moves lead screws, helical gears or the relative motion of gears on crossed axes by products of exponentials.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q poekit==0.1.0 sympy==1.14.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import numpy as np
from poekit.expmapping import ExpMapping
from poekit.twist_utils import TwistUtils
from scipy.linalg import expm

for axis, point, pitch, angle in (((0, 0, 1), (5, 0, 0), 0.0, 1.0), ((0, 0, 1), (5, 0, 0), 3.0, 1.0), ((0.6, 0, 0.8), (5, 1, 2), 3.0, 2.0)):
    axis = np.array(axis, float)
    twist = np.concatenate((np.cross(point, axis) + pitch * axis, axis))
    generator = np.zeros((4, 4))
    generator[:3, :3], generator[:3, 3] = np.cross(axis, np.eye(3)).T, twist[:3]
    right = expm(angle * generator)
    off = ExpMapping.exp_screw(np.append(twist, angle)) - right
    back = TwistUtils.motion_2_twist(right).ravel()
    print(f"pitch {pitch:g}, {angle:g} rad: {np.linalg.norm(off):.3f} mm off, twist {back[:3].round(3)}, should be {twist[:3].round(3)}")
    assert abs(TwistUtils.twist_pitch(twist) - pitch) < 1e-12 and np.allclose(back[3:], axis)
    assert np.abs(off[:, :3]).max() < 1e-12 and np.allclose(off[:3, 3], -pitch * angle * axis), "screws move along their axis now"
    assert np.abs(back[:3] - twist[:3]).max() > 0.5, "the twist of a motion is right now"
END
