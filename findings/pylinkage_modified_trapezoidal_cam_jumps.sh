#!/usr/bin/env bash
# pylinkage 1.3.0: a cam with the modified trapezoidal law has four steps in its profile, the last one as high as the lift, and dips below its base circle.
# Expected: the help says "continuous acceleration", "zero velocity at boundaries". Displacement grows from 0 to 1, is 1/2 in the middle,
#   its derivative is the velocity (2 at most), and the peak acceleration is 4.888 lifts per square of the rise.
# Seen: displacement jumps by 0.04, 0.165, -0.54 and 1.02 at 1/8, 3/8, 5/8 and 7/8 of the rise; it is 0.375 in the middle and -0.094 just
#   before 7/8. The velocity is 0 in the middle, where it should be at its peak, negative in the fourth quarter, and does not integrate
#   to the lift. A cam of 2 mm lift on a base circle of 10 mm is 9.81 mm at its smallest, with a step of 2.05 mm. Harmonic,
#   cycloidal, 3-4-5 and 4-5-6-7 laws are right to 1e-6. No warning.
# Versions: pylinkage 1.3.0, numba 0.65.1, numpy 2.4.6, scipy 1.17.1.
# Meets: whoever cuts or simulates cams of indexing drives and presses, for which this law is the usual choice.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q pylinkage==1.3.0 numba==0.65.1 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import numpy as np
from pylinkage.cam import FunctionProfile
from pylinkage.cam.motion_laws import CycloidalMotionLaw, HarmonicMotionLaw, ModifiedTrapezoidalMotionLaw, polynomial_345, polynomial_4567

rise = np.linspace(0.0, 1.0, 4001)


def figures(law):
    """Largest step, lowest displacement, displacement and velocity in the middle, and the integral of the velocity."""
    s, v = (np.array([f(u) for u in rise]) for f in (law.displacement, law.velocity))
    return np.array([np.abs(np.diff(s)).max(), s.min(), s[2000], v[2000], np.trapezoid(v, rise)])


for law in (HarmonicMotionLaw(), CycloidalMotionLaw(), polynomial_345(), polynomial_4567()):
    step, low, middle, _, whole = figures(law)
    assert step < 1e-3 and low >= 0.0 and abs(middle - 0.5) < 1e-6 and abs(whole - 1.0) < 1e-6
law = ModifiedTrapezoidalMotionLaw()
step, low, middle, speed, whole = figures(law)
steps = [law.displacement(u + 1e-9) - law.displacement(u - 1e-9) for u in (0.125, 0.375, 0.625, 0.875)]
print(f"steps {np.round(steps, 3)}, lowest {low:.4f}, in the middle {middle:.3f} with velocity {speed:.3f}, integral of the velocity {whole:.3f}")
cam = FunctionProfile(motion_law=law, base_radius=10.0, total_lift=2.0, rise_end=np.pi / 2, dwell_high_end=np.pi, fall_end=1.5 * np.pi)
radii = np.array([cam.evaluate(a) for a in np.linspace(0.0, np.pi / 2, 20001)])
print(f"cam of 10 mm with a lift of 2 mm: from {radii.min():.3f} to {radii.max():.3f} mm, largest step {np.abs(np.diff(radii)).max():.3f} mm")
assert min(np.abs(steps)) > 0.03 and radii.min() < 9.9, "the law has no steps now"
END
