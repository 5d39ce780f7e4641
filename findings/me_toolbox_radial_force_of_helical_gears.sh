#!/usr/bin/env bash
# me-toolbox 0.0.18: the radial force of helical gears is 57 times too small, and the ASME ellipse takes the tensile strength for the yield.
# Expected: W_r = W_t tan(phi_t) with the pressure angle in the tangential plane, as spur gears of the same package have W_t tan(phi). The
#   ASME-elliptic line ends at the yield strength, so that a static mean stress has the safety factor S_y / sigma_m, as
#   `get_safety_factors(..., "asme-elliptic")` of the same object says.
# Seen: the angle is turned into radians twice: 20 deg and a helix of 20 deg give 0.0065 W_t for 0.387. Tangential and axial forces are
#   right, and the force stands 19.7 deg off the normal of the flank. `ASME_elliptic` of a steel with S_y = 310 and S_ut = 565 MPa under a
#   mean stress of 300 MPa is 1.88, where it yields at 1.03. No warning.
# Versions: me-toolbox 0.0.18 (which needs icecream, too), numpy 2.4.6, sympy 1.14.0.
# Meets: whoever sizes shafts and bearings beside helical gears, where the radial force decides in one of two planes.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q me-toolbox==0.0.18 icecream numpy==2.4.6 sympy==1.14.0
"$folder/venv/bin/python" - <<'END'
from math import acos, atan, cos, degrees, radians, sin, sqrt, tan

from me_toolbox.fatigue import FatigueAnalysis
from me_toolbox.gears import HelicalGear, SpurGear

COMMON = dict(
    modulus=3, teeth_num=25, rpm=1500, Qv=8, width=60, bearing_span=120, pinion_offset=0, enclosure="commercial enclosed",
    hardness=300, pressure_angle=20, grade=1, work_hours=10_000,
)
spur = SpurGear(**COMMON)
tangential, radial = SpurGear.calc_forces(spur, 10_000.0)[:2]
print(f"spur gear: W_r / W_t = {radial / tangential:.6f}, tan(20 deg) = {tan(radians(20)):.6f}")
assert abs(radial / tangential - tan(radians(20))) < 1e-9
for helix in (15, 20, 30):
    gear = HelicalGear(helix_angle=helix, **COMMON)
    tangential, radial, axial = HelicalGear.calc_forces(gear, 10_000.0)
    transverse = atan(tan(radians(20)) / cos(radians(helix)))
    assert abs(gear.tangent_pressure_angle - degrees(transverse)) < 1e-9 and abs(axial / tangential - tan(radians(helix))) < 1e-9
    # direction of the force on the flank: its normal, by pressure angle in the normal plane and helix angle
    normal = [cos(radians(20)) * cos(radians(helix)), sin(radians(20)), cos(radians(20)) * sin(radians(helix))]
    size = sqrt(tangential**2 + radial**2 + axial**2)
    off = degrees(acos(sum(a * b for a, b in zip(normal, (tangential, radial, axial))) / size))
    print(f"helix {helix} deg: W_r / W_t = {radial / tangential:.5f}, tan(phi_t) = {tan(transverse):.5f}; force and normal {off:.1f} deg apart")
    assert abs(radial / tangential / tan(transverse) - 1.0 / 57.3) < 0.002 and off > 15.0, "radial forces are right now"
part = FatigueAnalysis(
    modified_endurance_limit=200.0, stress_type="bending", ductile=True, ultimate_tensile_strength=565.0, yield_strength=310.0,
    Kf_bending=1.0, alt_bending_stress=1.0, mean_bending_stress=300.0,
)
own, table = float(part.ASME_elliptic), float(part.get_safety_factors("asme-elliptic")[0])
exact = 1.0 / sqrt((1.0 / 200.0) ** 2 + (300.0 / 310.0) ** 2)
print(f"ASME ellipse: property {own:.4f}, get_safety_factors {table:.4f}, by hand {exact:.4f}")
assert abs(table - exact) < 1e-3 and own > 1.5, "the property takes the yield strength now"
END
