#!/usr/bin/env bash
# FLife 2.3: two criteria for multiaxial stress depend on the axes in which the stress is given; lives are up to millions of times too long.
# Expected: one stress at one point of a part has one life, whatever the axes of its tensor. The criteria of Carpinteri and Spagnoli (`cs`) and
#   of normal and shear stress on the plane of largest shear (`max_normal_and_shear`) are made so that uniaxial stress is its own
#   equivalent: 1.00 times its PSD, and for `cs` 0.974 (limits 200 and 120 MPa, plane at 43.2 deg), 2.77 in pure torsion.
# Seen: uniaxial stress along x, y or z has 0.70 by `cs`, at 45 deg between x and y 0.0016: a narrow band then lives 9 million times as long (slope 5)
#   as by the stress itself. Torsion has 1.38 or 0.70, by its axes. `max_normal_and_shear` has 1.00 along x and 0.444, (2/3)^2, along z, a life
#   7.6 times as long: normal and shear stress are added with the sign of a direction that can point either way. EVMS, `max_normal`,
#   `max_shear`, Lemaitre and Nieslony are the same in all axes, to 1e-6. No warning.
# Versions: FLife 2.3, numpy 2.4.6, scipy 1.17.1.
# Meets: whoever takes lives of shafts, tooth roots or housings under random vibration from spectra of finite element stresses.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q FLife==2.3 numpy==2.4.6 scipy==1.17.1
"$folder/venv/bin/python" - <<'END'
from math import cos, radians, sin

import FLife
import numpy as np

FREQUENCY = np.arange(0.0, 200.0)
BAND = np.where(abs(FREQUENCY - 50.0) < 10.0, 1.0, 0.0)
LIMITS = (200.0, 120.0)  # bending and torsion, MPa
ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def uniaxial(x, y, z):
    return np.outer((x, y, z), (x, y, z))


def turned(stress, angle):
    turn = np.array([[cos(angle), -sin(angle), 0.0], [sin(angle), cos(angle), 0.0], [0.0, 0.0, 1.0]])
    return turn @ stress @ turn.T


def equivalent(stress, criterion, *settings):
    """PSD of the equivalent stress over the PSD of a stress of 1 MPa, and its life by the closed form of narrow bands."""
    entries = np.array([stress[entry] for entry in ENTRIES])
    spectrum = FLife.EquivalentStress(input={"PSD": BAND[:, None, None] * np.outer(entries, entries), "f": FREQUENCY})
    getattr(spectrum, criterion)(*settings)
    return float(spectrum.psd[:, 1].real.max()), float(FLife.Narrowband(spectrum).get_life(1e12, 5.0))


half = 0.5**0.5
torsion = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
stresses = {
    "uniaxial along x": uniaxial(1.0, 0.0, 0.0),
    "uniaxial along z": uniaxial(0.0, 0.0, 1.0),
    "uniaxial at 45 deg": uniaxial(half, half, 0.0),
    "torsion": torsion,
    "torsion, axes turned by 45 deg": turned(torsion, radians(45.0)),
}
criteria = {"EVMS": (), "max_normal": (), "max_shear": (), "Lemaitre": (0.3,), "Nieslony": LIMITS, "max_normal_and_shear": LIMITS, "cs": LIMITS}
seen = {name: {case: equivalent(stress, name, *settings) for case, stress in stresses.items()} for name, settings in criteria.items()}
for name, cases in seen.items():
    print(f"{name}: " + ", ".join(f"{case} {size:.4f} (life {life:.3g} s)" for case, (size, life) in cases.items()))
for name in ("EVMS", "max_normal", "max_shear", "Lemaitre", "Nieslony"):
    sizes = [size for size, _ in seen[name].values()]
    assert max(abs(size - 1.0) for size in sizes[:3]) < 1e-6 and abs(sizes[3] - sizes[4]) < 1e-6
both = [size for size, _ in seen["max_normal_and_shear"].values()]
assert abs(both[0] - 1.0) < 1e-4 and abs(both[3] - (5.0 / 3.0) ** 2) < 1e-3
assert abs(both[1] - 4.0 / 9.0) < 1e-3, "normal and shear stress add up in every direction now"
planes = [size for size, _ in seen["cs"].values()]
assert 0.6 < planes[0] < 0.8 and planes[2] < 0.01, "uniaxial stress has its own size by cs now"
assert max(planes[3:]) < 2.0 and abs(planes[3] - planes[4]) > 0.3, "torsion has one size by cs now"
assert seen["cs"]["uniaxial at 45 deg"][1] > 1e6 * seen["EVMS"]["uniaxial at 45 deg"][1]
END
