#!/usr/bin/env bash
# py-gearworks 0.0.24: `cone_angle_from_teeth` is right for axes at 90 deg only; bevel gears of other shaft angles do not mesh.
# Expected: the help says "cone angles for two bevel gears based on their number of teeth and the prescribed angle between
#   their axes". Half angles d1, d2 add to that angle, and sin d1 / sin d2 is the ratio of the teeth: 19.1 and 40.9 deg for
#   20 and 40 teeth at 60 deg.
# Seen: 45.5 and 74.5 deg. `mesh_to` then puts the axes at 120 deg where 60 was asked for, and the cone distances are 28.0 and 41.5 mm,
#   so that the teeth of one gear lie inside those of the other. No warning. At 90 deg all is right, and so are gears with
#   angles from the closed form at any shaft angle.
# Versions: py-gearworks 0.0.24 with build123d 0.13.0, cadquery-ocp-novtk 8.0.1.1.0, scipy 1.17.1.
# Meets: whoever makes bevel gears for a shaft angle other than 90 deg.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q py-gearworks==0.0.24 build123d==0.13.0 cadquery-ocp-novtk==8.0.1.1.0 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import numpy as np
import py_gearworks as gearworks

TEETH = (20, 40)


def meshed(cone_angles):
    """Angle of the axes in degrees and cone distances in mm of two gears of module 2 mm that mesh."""
    pinion, gear = (gearworks.BevelGear(number_of_teeth=z, cone_angle=c, module=2, height=5) for z, c in zip(TEETH, cone_angles))
    gear.mesh_to(pinion)
    cosine = pinion.gearcore.transform.z_axis @ gear.gearcore.transform.z_axis
    return float(np.degrees(np.arccos(cosine))), np.array((pinion.radius_spherical, gear.radius_spherical))


axes, distances = {}, {}
for shaft in (60, 90, 120):
    angle = np.radians(shaft)
    pinion_half = np.arctan2(np.sin(angle), TEETH[1] / TEETH[0] + np.cos(angle))
    exact_halves = np.array((pinion_half, angle - pinion_half))
    halves = gearworks.cone_angle_from_teeth(*TEETH, angle) / 2.0
    axes[shaft], distances[shaft] = meshed(2.0 * halves)
    exact_axes, exact_distances = meshed(2.0 * exact_halves)
    print(f"asked for {shaft} deg: half cone angles {np.degrees(halves).round(2)}, axes {axes[shaft]:.1f} deg, cone distances {distances[shaft].round(2)}")
    print(f"    closed form: half cone angles {np.degrees(exact_halves).round(2)}, axes {exact_axes:.1f} deg, cone distances {exact_distances.round(2)}")
    assert abs(exact_axes - shaft) < 1e-6 and np.ptp(exact_distances) < 1e-9
assert abs(axes[90] - 90.0) < 1e-6 and np.ptp(distances[90]) < 1e-9
for shaft in (60, 120):
    assert abs(axes[shaft] - shaft) > 50.0 and np.ptp(distances[shaft]) > 10.0, "cone angles off 90 deg are right now"
END
