#!/usr/bin/env bash
# openrainflow 1.0.0 and rust-fatigue 0.1.9: peaks of a load that is held for some samples are counted otherwise, or not at all.
# Expected: rainflow cycles depend on the turning points alone. The example of ASTM E1049-85 (-2, 1, -3, 5, -1, 3, -4, 4, -2) has ranges 3,
#   4, 6, 8, 9 with counts 0.5, 1.5, 0.5, 1, 0.5, also when each sample is there three times. Both say that they count by rainflow,
#   openrainflow "ASTM E1049-85".
# Seen: openrainflow counts 3, 4, 6, 8 with 1, 1, 0.5, 1.5: the largest range, 9, is not there. With samples repeated it counts 4, 6, 9
#   with 2, 1, 0.5. rust-fatigue is right, but with samples repeated it has one cycle of range 0. The equivalent load (m = 4) of a sine of
#   amplitude 1 is 1.978, and 0 of the same sine rounded to one decimal. rainflow 3.2.0 has the counts of the standard for both. No warning.
# Versions: openrainflow 1.0.0, rust-fatigue 0.1.9, rainflow 3.2.0, numpy 1.26.4, numba 0.68.1, matplotlib 3.11.2.
# Meets: whoever makes load spectra of gears and shafts from torques: recorders hold a value, duty cycles consist of levels.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q openrainflow==1.0.0 rust-fatigue==0.1.9 rainflow==3.2.0 numpy==1.26.4 numba==0.68.1 matplotlib==3.11.2
"$folder/venv/bin/python" - <<'END'
from collections import Counter

import numpy as np
import rainflow
import rustfatigue
from openrainflow import rainflow_count

EXAMPLE = np.array([-2, 1, -3, 5, -1, 3, -4, 4, -2], float)
STANDARD = {3: 0.5, 4: 1.5, 6: 0.5, 8: 1.0, 9: 0.5}


def summed(pairs):
    counts = Counter()
    for size, count in pairs:
        counts[round(float(size), 6)] += float(count)
    return dict(sorted(counts.items()))


COUNTERS = {
    "rainflow": lambda load: summed(rainflow.count_cycles(load)),
    "openrainflow": lambda load: summed((row[0], row[2]) for row in rainflow_count(load)),
    "rust-fatigue": lambda load: summed((size, 0.5) for _, size in rustfatigue.rainflow_count(load)),
}
seen = {(name, times): count(np.repeat(EXAMPLE, times)) for name, count in COUNTERS.items() for times in (1, 3)}
for (name, times), counts in seen.items():
    print(f"{name}, each sample {times} x: {counts}")
sine = np.sin(np.linspace(0.0, 20.0 * np.pi, 1001))
exact, rounded = (rustfatigue.eq_load(load, m=4, neq=10) for load in (sine, np.round(sine, 1)))
print(f"rust-fatigue, equivalent load of a sine {exact:.3f}, rounded to one decimal {rounded:.3f}")
assert seen["rainflow", 1] == seen["rainflow", 3] == seen["rust-fatigue", 1] == STANDARD
assert seen["openrainflow", 1] == {3: 1.0, 4: 1.0, 6: 0.5, 8: 1.5}, "openrainflow counts the example otherwise now"
assert seen["openrainflow", 3] == {4: 2.0, 6: 1.0, 9: 0.5}, "openrainflow counts repeated samples otherwise now"
assert seen["rust-fatigue", 3] == {0: 0.5}, "rust-fatigue counts repeated samples now"
assert exact > 1.97 and rounded < 1e-9, "rust-fatigue counts rounded loads now"
END
