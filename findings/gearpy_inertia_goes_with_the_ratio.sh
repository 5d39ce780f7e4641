#!/usr/bin/env bash
# gearpy 1.3.1: inertia is carried over a gear pair by the ratio, not by its square, so that drives win energy, and loads below a loaded gear are lost.
# Expected: a rigid drive has one kinetic energy: a motor of inertia J in front of a ratio i is J i^2 at the output. All that the motor and the
#   load do to it from rest is that energy. Loads on two gears of a chain both reach the motor. Two gears that mesh press on each other with
#   one force; the largest contact stress is at least the force over the area of contact.
# Seen: "multiplying each element's moment of inertia ... by its gear ratio": a motor (4.1e-4 kg m2 with its pinion, 2 Nm) and a wheel of 1e-3 behind
#   20/100 teeth start at 2951 rad/s2 for 800; after 1 ms they have 3.69 times the energy that was put in. With 2 Nm on the middle gear and 6 Nm
#   on the last, the motor carries 0.667 Nm, as without the 6 Nm, for 1.667. Pinion and wheel of one mesh have 10 and 100 N while the
#   drive speeds up. The contact stress is 0.629 times Hertz's, and 0.80 of the mean. Ratios of 1 are right. No warning.
# Versions: gearpy 1.3.1, numpy 2.4.6, scipy 1.17.1, pandas 3.1.1, matplotlib 3.11.2.
# Meets: whoever sizes motors, starts and stops of geared drives by it: a ratio of 5 makes the motor's rotor a fifth of what it is.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q gearpy==1.3.1 numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 matplotlib==3.11.2
MPLBACKEND=Agg "$folder/venv/bin/python" - <<'END'
from math import cos, pi, radians, sin, sqrt

from gearpy.mechanical_objects import DCMotor, SpurGear
from gearpy.powertrain import Powertrain
from gearpy.solver import Solver
from gearpy.units import AngularPosition, AngularSpeed, InertiaMoment, Length, Stress, TimeInterval, Torque
from gearpy.utils import add_fixed_joint, add_gear_mating

ROTOR, PINION, WHEEL = 4e-4, 1e-5, 1e-3  # kg m2
MODULE, FACE, YOUNG, POISSON = 2e-3, 20e-3, 210e9, 0.3
STALL, STEP = 2.0, 1e-5


def drive(pairs, loads):
    """Run a motor with pairs of teeth (driver, driven) for 1 ms; loads: number of the gear -> Nm. Returns the motor and the gears."""
    motor = DCMotor("motor", InertiaMoment(ROTOR, "kgm^2"), AngularSpeed(300.0, "rad/s"), Torque(STALL, "Nm"))
    gears, last = [], motor
    for place, teeth in enumerate(pairs):
        pinion, wheel = (
            SpurGear(f"{name}{place}", number, InertiaMoment(inertia, "kgm^2"), Length(MODULE, "m"), Length(FACE, "m"), Stress(YOUNG, "Pa"))
            for name, number, inertia in zip(("pinion", "wheel"), teeth, (PINION, WHEEL))
        )
        add_fixed_joint(last, pinion)
        add_gear_mating(pinion, wheel, efficiency=1)
        gears += [pinion, wheel]
        last = wheel
    for place, load in loads.items():
        gears[place].external_torque = lambda angular_position, angular_speed, time, load=load: Torque(load, "Nm")
    last.angular_position, last.angular_speed = AngularPosition(0.0, "rad"), AngularSpeed(0.0, "rad/s")
    train = Powertrain(motor)
    Solver(train).run(time_discretization=TimeInterval(STEP, "sec"), simulation_time=TimeInterval(1e-3, "sec"))
    return motor, gears


def values(part, name, unit):
    return [value.to(unit).value for value in part.time_variables[name]]


found = {}
for teeth in ((20, 20), (20, 100)):
    ratio = teeth[1] / teeth[0]
    motor, (pinion, wheel) = drive((teeth,), {1: 1.0})
    inertia = WHEEL + (ROTOR + PINION) * ratio**2
    start, right = values(wheel, "angular acceleration", "rad/s^2")[0], (STALL * ratio - 1.0) / inertia
    speed, torque = values(wheel, "angular speed", "rad/s"), values(motor, "driving torque", "Nm")
    work = sum((torque[k] * ratio - 1.0) * (speed[k] + speed[k + 1]) / 2.0 * STEP for k in range(len(speed) - 1))
    energy = inertia * speed[-1] ** 2 / 2.0
    forces = [values(gear, "tangential force", "N")[0] for gear in (pinion, wheel)]
    print(f"{teeth}: start {start:.1f} rad/s2 for {right:.1f}; energy {energy:.4f} J of {work:.4f}; forces in the mesh {forces[0]:.1f}, {forces[1]:.1f} N")
    found[ratio] = start / right, energy / work, forces

linear = (WHEEL + (ROTOR + PINION) * 25.0) / (WHEEL + (ROTOR + PINION) * 5.0)
force, curvature = found[5.0][2][1], 2.0 / sin(radians(20.0)) * (1.0 / (20 * MODULE) + 1.0 / (100 * MODULE))
line, modulus = force / cos(radians(20.0)) / FACE, YOUNG / (2.0 * (1.0 - POISSON**2))
hertz, mean = sqrt(line * modulus * curvature / pi), line / (2.0 * sqrt(4.0 * line / (pi * modulus * curvature)))
stress = values(wheel, "contact stress", "Pa")[0]
print(f"contact stress {stress / 1e6:.2f} MPa, Hertz {hertz / 1e6:.2f}, force over area {mean / 1e6:.2f}: {stress / hertz:.4f}, {stress / mean:.4f}")

chain = ((20, 60), (20, 40))
carried = [values(drive(chain, loads)[0], "load torque", "Nm")[0] for loads in ({3: 6.0}, {1: 2.0, 3: 0.0}, {1: 2.0, 3: 6.0})]
print("load on the motor of 6 Nm on the last gear, 2 Nm on the middle one, both:", [round(load, 4) for load in carried], "for 1, 0.6667, 1.6667")
assert abs(found[1.0][0] - 1.0) < 1e-9 and abs(found[1.0][1] - 1.0) < 1e-9
assert abs(found[5.0][0] / linear - 1.0) < 1e-9 and found[5.0][1] > 3.6, "inertia goes with the square of the ratio now"
assert found[5.0][2][1] > 9.9 * found[5.0][2][0], "both gears of a mesh have one force now"
assert stress < 0.81 * mean, "the contact stress is Hertz's now"
assert abs(carried[0] - 1.0) < 1e-9 and abs(carried[1] - carried[2]) < 1e-9, "loads add up now"
END
