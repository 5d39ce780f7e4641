#!/usr/bin/env bash
# opentorsion 0.3.2: `dsim` adds the torques of two shafts that start at one node, gives a speed as a torque, and lets a held shaft turn.
# Expected: the help says "torques: shaft torque array, speeds: disk speed array". Three shafts have three torques; a disc with a
#   stiffness to ground holds a shaft, so that a steady torque ends in a steady twist and rest.
# Seen: for a drive of 10 Nm on a disc with two branches, whose shafts take 3 and 5 Nm behind one of 9 Nm, the rows are 9, 8 and
#   50.05: the branches are added, and the last row is the speed of disc 0 in rad/s, which has moved up. The speed of disc 0 is 50.05
#   again in `speeds`. A shaft held by a spring of 2 kNm/rad turns at 20 rad/s for ever under 10 Nm: its state has the twist between
#   the nodes alone, and the spring's angle is lost. Steady state by the model's own K is right in both cases. No warning.
# Versions: opentorsion 0.3.2, numpy 2.4.6, scipy 1.17.1, matplotlib 3.11.2.
# Meets: whoever runs up gearboxes with a power take-off, or two pinions on one shaft, and whoever holds the end of a train.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q opentorsion==0.3.2 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
"$folder/venv/bin/python" - <<'END'
import numpy as np
import opentorsion as ot

TORQUE, STEP, STEPS = 10.0, 1e-4, 50_000


def run(shafts, discs, node):
    """Last torques (Nm) and speeds (rad/s) under a steady torque on one node, after 5 s."""
    model = ot.Assembly(shafts, disk_elements=discs)
    drive = ot.TransientExcitation(model.dofs, STEP * np.arange(STEPS))
    drive.add_transient(node, np.full(STEPS, TORQUE))
    torques, speeds, _ = model.dsim(drive)
    return model, torques[:, -1], speeds[:, -1]


inertias = (0.1, 0.1, 0.3, 0.5)
shafts = [ot.Shaft(0, 1, k=1e3, c=2.0), ot.Shaft(1, 2, k=1e3, c=2.0), ot.Shaft(1, 3, k=2e3, c=2.0)]
_, torques, speeds = run(shafts, [ot.Disk(node, inertia) for node, inertia in enumerate(inertias)], 0)
acceleration = TORQUE / sum(inertias)
wanted = acceleration * np.array([sum(inertias[1:]), inertias[2], inertias[3]])
print(f"branches: torques {np.round(torques, 3)}, should be {np.round(wanted, 3)} Nm; speeds {np.round(speeds, 2)} rad/s")
assert np.allclose(torques[:2], [wanted[0], wanted[1] + wanted[2]], atol=1e-3), "other torques of the branches now"
assert abs(torques[2] - speeds[0]) < 1e-9 and abs(torques[2] - acceleration * STEP * STEPS) < 1.0, "the last row is another one now"

held, torques, speeds = run([ot.Shaft(0, 1, k=1e3, c=2.0)], [ot.Disk(0, 0.1, c=1.0, k=2e3), ot.Disk(1, 0.1)], 1)
angles = np.linalg.solve(held.K, [0.0, TORQUE])
print(f"held shaft: speeds {np.round(speeds, 4)} rad/s, should be 0 at angles {np.round(angles, 4)} rad")
assert np.allclose(angles, [TORQUE / 2e3, TORQUE / 2e3 + TORQUE / 1e3])
assert np.allclose(speeds, 20.0, atol=1e-3), "the held shaft turns otherwise now"
END
