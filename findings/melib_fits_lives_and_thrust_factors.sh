#!/usr/bin/env bash
# melib 1.1.1: fits at the limits of size ranges, pitting lives below 4 million cycles, and thrust factors of ball bearings are wrong.
# Expected: ranges of ISO 286 are "over 30 up to and including 50", so that 50 H7 is +25/0 and f6 is -25/-41. The pitting factor of
#   AGMA 2101 for steel is 2.466 N^-0.056 from 10^4 to 10^7 cycles (there it meets 1.4488 N^-0.023): 1.138 at a million. A thrust
#   factor Y between two rows of the bearing table gives e and T/C0 between those rows.
# Seen: `isofits(d=50, s="H7f6")` is that of sizes over 50: +30/0 and -30/-49; so at 30, 80 and 120 mm, and s6 at 65 mm. `agmazn` is 1.5
#   for all lives below 4 million, where it jumps to 1.05: at 3.9 million 1.42 times too much. `dgbbrtfacs(Y=1.5)` has e = 0.44 and
#   T/C0 = 0.56, the end of the table, for 0.29 and 0.097: it interpolates in a falling column. Its inverse by e is right. No warning.
# Versions: melib 1.1.1, numpy 2.4.6, scipy 1.17.1, matplotlib 3.11.2, openpyxl 3.1.5, PyLaTeX 1.4.2.
# Meets: whoever sizes seats of gears and bearings (30, 50 and 80 mm are usual shafts), or teeth for less than 10^7 cycles.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q melib==1.1.1 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 openpyxl==3.1.5 pylatex==1.4.2
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import numpy as np
from melib.library import agmazn, dgbbrtfacs, isofits

# upper and lower deviations (um) of hole and shaft by ISO 286-2
RIGHT = {
    ("H7f6", 30.0): (21, 0, -20, -33),
    ("H7f6", 50.0): (25, 0, -25, -41),
    ("H7f6", 80.0): (30, 0, -30, -49),
    ("H7s6", 65.0): (30, 0, 72, 53),
}
for (fit, size), right in RIGHT.items():
    inside, at_limit = (isofits(d=d, s=fit) for d in (size - 0.1, size))
    print(f"{size:g} {fit}: {at_limit}, should be {right} um")
    assert inside == right
    assert at_limit != right, "sizes at limits are in the right range now"
for cycles in (1e5, 1e6, 3.9e6, 4.1e6):
    factor, right = float(agmazn(cycles)), 2.466 * cycles**-0.056
    print(f"{cycles:.1e} cycles: pitting factor {factor:.3f}, should be {right:.3f}")
    assert abs(factor - (1.5 if cycles < 4e6 else right)) < 1e-9, "other pitting factors now"
e, ratio, _ = dgbbrtfacs(Y=1.5)
by_e = dgbbrtfacs(e=0.29)
print(f"Y = 1.5: e {e:.3f}, T/C0 {ratio:.3f}; e = 0.29: T/C0 {by_e[1]:.3f}, Y {by_e[2]:.3f}")
assert np.allclose(by_e[1:], (0.097, 1.5))
assert np.allclose((e, ratio), (0.44, 0.56)), "the row of Y is another one now"
END
