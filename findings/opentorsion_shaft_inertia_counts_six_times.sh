#!/usr/bin/env bash
# opentorsion 0.3.2: a shaft that is given by stiffness and inertia, `Shaft(k=..., I=...)`, has six times that inertia in the model.
# Expected: the help says "I: moment of inertia of the shaft [kgm^2]". The element's mass matrix is I/6 [[2, 1], [1, 2]], whose
#   terms add up to I, as for a shaft that is given by its length and diameters.
# Seen: I [[2, 1], [1, 2]], which adds up to 6 I. A shaft of 0.6 kg m2 between two discs of 1 kg m2 (k = 10 kNm/rad) has 3.6; the
#   natural frequency is 17.794 Hz where 21.460 is right, which the same shaft given by its diameter has. No warning. With a length
#   and a diameter, I is left out, though the help says that it overrides the geometry.
# Versions: opentorsion 0.3.2, numpy 2.4.6, scipy 1.17.1, matplotlib 3.11.2.
# Meets: whoever takes stiffness and inertia of splined, stepped or hollow shafts of a drive train from a data sheet or from CAD.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q opentorsion==0.3.2 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
"$folder/venv/bin/python" - <<'END'
import numpy as np
import opentorsion as ot

STIFFNESS, INERTIA, DISC = 1e4, 0.6, 1.0
LENGTH, DIAMETER = 1.0, 0.1
SECTION = np.pi * DIAMETER**4 / 32.0


def measured(name, **shaft):
    model = ot.Assembly([ot.Shaft(0, 1, **shaft)], disk_elements=[ot.Disk(node, I=DISC) for node in (0, 1)])
    inertia = model.M.sum() - 2.0 * DISC
    frequency = model.modal_analysis()[0].max() / (2.0 * np.pi)
    print(f"{name}: inertia of the shaft {inertia:.4f} kg m2, natural frequency {frequency:.3f} Hz")
    return inertia, frequency


geometry = dict(L=1e3 * LENGTH, odl=1e3 * DIAMETER, G=STIFFNESS * LENGTH / SECTION, rho=INERTIA / (SECTION * LENGTH))
given = measured("stiffness and inertia", k=STIFFNESS, I=INERTIA)
right = measured("the same shaft by its diameter", **geometry)
overridden = measured("diameter and another inertia", **geometry, I=10.0 * INERTIA)
# anti-phase mode of two inertias DISC + INERTIA / 2, less the terms beside the diagonal
exact = np.sqrt(2.0 * STIFFNESS / (DISC + INERTIA / 6.0)) / (2.0 * np.pi)
assert abs(right[0] - INERTIA) < 1e-9 and abs(right[1] - exact) < 1e-4
assert abs(given[0] - 6.0 * INERTIA) < 1e-9, "the shaft has another inertia now"
assert abs(given[1] - np.sqrt(2.0 * STIFFNESS / (DISC + INERTIA)) / (2.0 * np.pi)) < 1e-4
assert abs(overridden[0] - INERTIA) < 1e-9, "the given inertia overrides the geometry now"
END
