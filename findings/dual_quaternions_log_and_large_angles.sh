#!/usr/bin/env bash
# dual_quaternions 0.4.0: the logarithm of a screw motion is not its screw, `exp` does not undo `log`, and powers beyond 180 deg leave the motion.
# Expected: log of the motion by an angle w about an axis l with moment m, and d along it, is w/2 l + eps (w/2 m + d/2 l), as its help
#   says (s theta / 2); exp(log(q)) is q; q.pow(0.5) is half the motion, and its square is q.
# Seen: for 60 deg about an axis through (5, 0, 0) the dual part is (1.25, 0, 0) where (0, -2.618, 0) is right; a travel of 2 mm along the
#   axis is not in it at all, and exp(log(q)) is 4.3 mm off. `screw` of 4 rad with 1.5 mm turns axis, angle and travel round at once,
#   -l, 4 - 2 pi, -1.5, which is the motion by 2.28 rad: q.pow(0.5) squared is another motion, and so is `sqrt`. Up to 180 deg powers
#   are right, as are products, inverses and matrices always. No warning.
# Versions: dual_quaternions 0.4.0, pyquaternion 0.9.9, numpy 2.4.6, scipy 1.17.1 (its matrix exponential and logarithm compare).
# Meets: whoever averages, interpolates or filters screw motions of gear axes, machine tools or robots in the space of logarithms.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q dual_quaternions==0.4.0 pyquaternion==0.9.9 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import numpy as np
from dual_quaternions import DualQuaternion
from scipy.linalg import expm

CASES = (((0, 0, 1), (5, 0, 0), np.pi / 3, 0.0), ((0, 0, 1), (5, 0, 0), np.pi / 3, 2.0), ((1, 2, 2), (5, -1, 3), 4.0, 1.5))
for axis, point, angle, travel in CASES:
    axis = np.array(axis) / np.linalg.norm(axis)
    moment = np.cross(point, axis)
    generator = np.zeros((4, 4))
    generator[:3, :3] = angle * np.cross(axis, np.eye(3)).T
    generator[:3, 3] = angle * moment + travel * axis
    right = expm(generator)

    def off(motion):
        return np.abs(motion.homogeneous_matrix() - right).max()

    motion = DualQuaternion.from_screw(axis, moment, angle, travel)
    logarithm = motion.log()
    wanted = (angle * moment + travel * axis) / 2
    half = motion.pow(0.5)
    print(f"{angle:.3f} rad, {travel:g} mm: dual part of log {np.round(logarithm.dq_array()[5:], 4)}, should be {wanted.round(4)};")
    print(f"  off: motion {off(motion):.1e}, exp(log) {off(logarithm.exp()):.3f}, square of the half {off(half * half):.1e}")
    assert off(motion) < 1e-12 and np.allclose(logarithm.dq_array()[1:4], angle / 2 * axis)
    assert np.abs(np.subtract(logarithm.dq_array()[5:], wanted)).max() > 0.5, "the logarithm is the screw now"
    assert off(logarithm.exp()) > 0.5, "exp undoes log now"
    if angle < np.pi:
        assert off(half * half) < 1e-9
    else:
        print(f"  screw: {[np.round(value, 3) for value in motion.screw()]}")
        assert off(half * half) > 0.5, "powers beyond 180 deg are right now"
END
