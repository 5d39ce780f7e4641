#!/usr/bin/env bash
# rational-linkages 3.0.1: the dual quaternion of a half turn about an oblique axis is that of another motion, often of none at all.
# Expected: `TransfMatrix.matrix2dq` and `DualQuaternion.dq2matrix` undo each other, as they do for turns of 179 deg to 1e-14. A half turn
#   about (1, 2, 2)/3 is the quaternion (0, 1, 2, 2)/3; half turns about lines are what linkages are factorised into.
# Seen: the real part of a half turn is 0, but comes from 1 + n_x + o_y + a_z as a rounding error, and is compared with 0 exactly. Other
#   parts, rounding errors, too, are divided by it. Of 124 half turns about axes of whole numbers from -2 to 2 some 68 come back as other
#   motions: the matrix is wrong by up to 2, about (1, 2, 2) by 1.397. Half turns about x, y, z are right. No warning unless it is nan.
# Versions: rational-linkages 3.0.1, numpy 2.4.6, scipy 1.17.1, sympy 1.14.0, biquaternion-py 1.2.0.
# Meets: whoever gives poses of links, couplings or gear axes as matrices: a part that is turned over has a half turn.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q rational-linkages==3.0.1 numpy==2.4.6 scipy==1.17.1 sympy==1.14.0 biquaternion-py==1.2.0
"$folder/venv/bin/python" - <<'END'
from itertools import product
from math import cos, radians, sin

import numpy as np
from rational_linkages import DualQuaternion, TransfMatrix


def turn(axis, degrees):
    """Matrix of a turn about an axis of whole numbers; half turns without sine and cosine."""
    square = sum(x * x for x in axis)
    if degrees == 180:
        return np.array([[2 * x * y / square - (i == j) for j, y in enumerate(axis)] for i, x in enumerate(axis)])
    x, y, z = (part / square**0.5 for part in axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sin(radians(degrees)) * cross + (1 - cos(radians(degrees))) * cross @ cross


def error(axis, degrees):
    given = turn(axis, degrees)
    frame = TransfMatrix.from_vectors(normal_x=given[:, 0], approach_z=given[:, 2], origin=np.array([10.0, 0.0, 5.0]))
    assert np.abs(np.array(frame.to_standard())[:3, :3] - given).max() < 1e-12
    back = np.array(TransfMatrix(DualQuaternion(frame.matrix2dq()).dq2matrix()).to_standard())
    return np.abs(back[:3, :3] - given).max()


axes = [axis for axis in product(range(-2, 3), repeat=3) if any(axis)]
for degrees in (90, 179, 180):
    found = [error(axis, degrees) for axis in axes]
    print(f"{degrees} deg about {len(axes)} axes: {sum(not e < 1e-6 for e in found)} come back wrong, by up to {np.nanmax(found):.3f}")
    assert (np.nanmax(found) < 1e-6) == (degrees != 180), "half turns come back now"
straight = [error(axis, 180) for axis in np.eye(3, dtype=int).tolist()]
oblique = error((1, 2, 2), 180)
print(f"half turns about x, y, z: {max(straight):.1e}; about (1, 2, 2): {oblique:.3f}")
assert max(straight) < 1e-12
END
