#!/usr/bin/env bash
# ffpack 0.3.3: the safety factor of the Goodman and Soderberg corrections has no effect, and that of Gerber counts twice.
# Expected: "n: Safety factor" of the three lines means one thing: the point of n times the amplitude and n times the mean stress lies on the
#   line. Goodman: S_e = n S_a / (1 - n S_m / S_u), Soderberg the same with the yield strength, Gerber S_e = n S_a / (1 - (n S_m / S_u)^2);
#   so does the textbook (S_a / S_e + S_m / S_u = 1 / n). The result, "Fatigue limit", for n is that of n times the stresses.
# Seen: for 20 to 220 MPa and a strength of 600 MPa Goodman and Soderberg give 125 MPa for every n, where n = 1.5 and 2 need 214 and 333. Gerber
#   gives 282 and 1111 MPa for 165 and 238: that of n^2. The same stresses multiplied by hand, with n = 1, are right, and so is n = 1. An n that
#   the line cannot have is refused for all three. Rainflow counts are those of ASTM E1049, also of loads that are held. No warning.
# Versions: ffpack 0.3.3, numpy 2.4.6, scipy 1.17.1.
# Meets: whoever sizes shafts, bolts and gear teeth for a safety factor: by Goodman the part is designed for none.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q ffpack==0.3.3 numpy==2.4.6 scipy==1.17.1
"$folder/venv/bin/python" - <<'END'
from ffpack.lcc import astmRainflowCounting, gerberCorrection, goodmanCorrection, soderbergCorrection

LOW, HIGH, STRENGTH = 20.0, 220.0, 600.0
AMPLITUDE, MEAN = (HIGH - LOW) / 2.0, (HIGH + LOW) / 2.0
POWERS = {goodmanCorrection: 1, soderbergCorrection: 1, gerberCorrection: 2}
FACTORS = (1.0, 1.5, 2.0)


def right(power, factor):
    """The fatigue limit whose line goes through factor times the amplitude and factor times the mean stress."""
    return factor * AMPLITUDE / (1.0 - (factor * MEAN / STRENGTH) ** power)


for line, power in POWERS.items():
    seen = [line([LOW, HIGH], STRENGTH, factor) for factor in FACTORS]
    by_hand = [line([factor * LOW, factor * HIGH], STRENGTH) for factor in FACTORS]
    wanted = [right(power, factor) for factor in FACTORS]
    print(f"{line.__name__}: {[round(float(value), 2) for value in seen]} for {[round(value, 2) for value in wanted]}")
    assert all(abs(a / b - 1.0) < 1e-12 for a, b in zip(by_hand, wanted))
    changed = [right(power, 1.0)] * 3 if power == 1 else [right(power, factor**2) for factor in FACTORS]
    assert all(abs(a / b - 1.0) < 1e-12 for a, b in zip(seen, changed)), f"{line.__name__} takes its factor otherwise now"
example = [-2, 1, -3, 5, -1, 3, -4, 4, -2]
counts = astmRainflowCounting([value for value in example for _ in range(3)])
print("rainflow counts of the standard's example, each sample three times:", counts)
assert counts == [[3.0, 0.5], [4.0, 1.5], [6.0, 0.5], [8.0, 1.0], [9.0, 0.5]]
END
