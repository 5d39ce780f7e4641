#!/usr/bin/env bash
# wormgear 0.2.0: a wheel with profile shift keeps the centre distance of the wheel without it.
# Expected: the worm has no shift, so that the wheel's tooth moves out with its reference line: a = (d_m1 + m z2) / 2 + x m as in
#   DIN 3975, and the bottom clearance of both members stays 0.25 modules.
# Seen: `design_from_module(2.0, 30, worm_pitch_diameter=20.0, profile_shift=x)` gives 40 mm for every x, while tip and root of the
#   wheel move by x m. Bottom clearance is 0.5, 0.1 and -0.1 mm at x = 0, 0.2 and 0.3. At x = 0.2 its own check finds nothing, though
#   the wheel's teeth are 0.29 mm thicker in the worm's spaces; from 0.25 on it calls the design wrong that it made itself. The wheel's
#   helix angle is the complement (84.3 deg) of what DIN 3975 calls so, the worm's lead angle (5.7 deg).
# Versions: wormgear 0.2.0 (its calculator alone, which runs without build123d), pydantic 2.13.4.
# Meets: whoever sets a worm drive to a given centre distance by profile shift, which is what profile shift of wheels is for.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q pydantic==2.13.4
"$folder/venv/bin/pip" install -q --no-deps --ignore-requires-python wormgear==0.2.0 2>/dev/null
cd "$folder"
"$folder/venv/bin/python" - <<'END'
from wormgear.calculator import design_from_module, validate_design

MODULE = 2.0
for shift, clearance, valid in ((0.0, 0.5, True), (0.2, 0.1, True), (0.3, -0.1, False)):
    design = design_from_module(MODULE, 30, worm_pitch_diameter=20.0, profile_shift=shift)
    worm, wheel, distance = design.worm, design.wheel, design.assembly.centre_distance_mm
    wanted = 0.5 * (worm.pitch_diameter_mm + wheel.pitch_diameter_mm) + shift * MODULE
    found = distance - 0.5 * (wheel.tip_diameter_mm + worm.root_diameter_mm)
    judged = validate_design(design).valid
    print(f"x = {shift}: centre distance {distance:.2f} mm, should be {wanted:.2f}; wheel's tip over worm's root {found:+.2f} mm; "
          f"its check says {'good' if judged else 'wrong'}; helix angle of the wheel {wheel.helix_angle_deg:.1f} deg")
    assert abs(distance - 40.0) < 1e-9, "the centre distance follows the profile shift now"
    assert abs(found - clearance) < 1e-9
    assert judged is valid, "its check judges in another way now"
END
