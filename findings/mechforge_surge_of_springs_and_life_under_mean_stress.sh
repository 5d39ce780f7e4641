#!/usr/bin/env bash
# mechforge 0.1.0: natural frequencies of helical springs are 126 times too low, and the life of parts does not know of the mean stress.
# Expected: `HelicalSpring` says "Natural frequency (fundamental, both ends fixed)": half the root of spring rate over mass of the active
#   coils, 414 Hz for a valve spring of 4 mm wire, 24 mm, 6 coils. `predict_life(..., criterion)` says "Predict fatigue life" by Goodman, Gerber
#   or Soderberg: a safety factor below 1 is no infinite life, and a higher mean stress is a shorter life.
# Seen: 3.27 Hz. The closed form has G / (2 rho) where the program has G / (32 rho), and mm are brought to m under the root, by 1000
#   for 1e6: a factor of 4 root(1000). The rate in the same answer is right. Of AISI 1045 at 1 MPa below its endurance limit with a mean of
#   300 MPa all three criteria have safety factors below 1 and an infinite life; above the limit the cycles are those at mean stress 0,
#   and so is `miners_rule`. No warning.
# Versions: mechforge 0.1.0, pint 0.25.3, numpy 2.4.6.
# Meets: whoever keeps springs of valves, followers and clutches clear of their surge, or sums damage of shafts and teeth under load one way.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q mechforge==0.1.0 pint==0.25.3 numpy==2.4.6
"$folder/venv/bin/python" - <<'END'
from math import pi, sqrt

from mechforge.core.materials import get_material
from mechforge.core.units import Q
from mechforge.machine.springs import HelicalSpring
from mechforge.structural.fatigue import FatigueAnalysis


def surge(wire, coil, turns):
    """Natural frequency by the program, and of a rod of the spring's rate and mass, Hz."""
    spring = HelicalSpring(
        wire_diameter=Q(wire, "mm"),
        mean_coil_diameter=Q(coil, "mm"),
        free_length=Q(60, "mm"),
        active_coils=turns,
        material_Sut=Q(1500, "MPa"),
        material_G=Q(79.3, "GPa"),
    )
    found = spring.analyze(Q(200, "N"))
    rate = 79.3e9 * (1e-3 * wire) ** 4 / (8.0 * (1e-3 * coil) ** 3 * turns)
    assert abs(found.spring_rate.to("N/m").magnitude / rate - 1.0) < 1e-9
    mass = 7850.0 * 0.25 * pi * (1e-3 * wire) ** 2 * pi * 1e-3 * coil * turns
    return found.natural_frequency.to("Hz").magnitude, 0.5 * sqrt(rate / mass)


ratios = []
for sizes in ((4.0, 24.0, 6.0), (2.0, 20.0, 10.0)):
    own, closed = surge(*sizes)
    ratios.append(closed / own)
    print(f"wire, coil, turns {sizes}: {own:.3f} Hz, closed form {closed:.1f} Hz, {ratios[-1]:.2f} times")
part = FatigueAnalysis(get_material("AISI 1045"))
kept = {}
for above in (-1.0, 40.0):
    alternating = part.Se + above
    for mean in (0.0, 300.0):
        for criterion in ("goodman", "gerber", "soderberg"):
            life = part.predict_life(mean + alternating, mean - alternating, criterion)
            kept[above, mean, criterion] = life
            print(f"{alternating:.1f} MPa about {mean:g}, {criterion}: safety {life.safety_factor:.3f}, cycles {life.cycles:.4g}")
damage = [part.miners_rule([(mean + alternating, mean - alternating)], [1e4]) for mean in (0.0, 300.0)]
print("damage of 10,000 cycles at mean 0 and 300:", damage)
assert all(abs(ratio - 4.0 * sqrt(1000.0)) < 0.01 for ratio in ratios), "natural frequencies have changed"
for criterion in ("goodman", "gerber", "soderberg"):
    low = kept[-1.0, 300.0, criterion]
    assert low.safety_factor < 1.0 and low.infinite_life, "life follows the criterion now"
    assert kept[40.0, 300.0, criterion].cycles == kept[40.0, 0.0, criterion].cycles, "life knows of the mean stress now"
assert damage[0] == damage[1] > 0.0
END
