#!/usr/bin/env bash
# GcodeTools 0.3.2: points on the x or y axis stay where they are when a program is turned, and full circles are left out.
# Expected: `Tools.rotate(gcode, 30)` turns every position about the origin ("Rotate around Z axis with a given angle"), so that areas stay.
#   `G3 X10 Y0 I-10 J0` from X10 Y0 is a full circle, as in RS-274, Marlin and Klipper. The centre of mass of an even square loop is its middle.
# Seen: a position with X = 0 or Y = 0 is returned as it is: the square X0..10, Y0..10 turns one corner of four, and its area is 86.60
#   for 100; the same square from 5 to 15 keeps 100. The circle of 20 mm becomes a move of no length, cw and ccw, where a quarter of it has
#   91 points. The loop of four equal sides from 10 to 20 mm has its centre of mass at (13.57, 15.00): sides count by all that was
#   extruded before, at their ends. No warning.
# Versions: GcodeTools 0.3.2.
# Meets: whoever turns, splits or checks printed parts about the origin, and prints bores by arcs.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q GcodeTools==0.3.2
"$folder/venv/bin/python" - <<'END'
from math import dist, pi

from GcodeTools import Gcode, Tools
from GcodeTools.gcode_parser import GcodeParser


def program(*lines):
    return GcodeParser.generate_moves(Gcode(), "\n".join(("G90", "M83", *lines)))


def points(gcode):
    return [(block.position.X, block.position.Y) for block in gcode]


def square(low, high):
    return program(*(f"G1 X{x} Y{y}" for x, y in ((low, low), (high, low), (high, high), (low, high), (low, low))))


def area(gcode):
    corners = points(gcode)[-5:]
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corners, corners[1:]))


def length(gcode):
    way = points(gcode)
    start = way.index((10.0, 0.0)) if (10.0, 0.0) in way else 0
    return sum(dist(a, b) for a, b in zip(way[start:], way[start + 1 :]))


turned = {low: area(Tools.rotate(square(low, low + 10), 30)) for low in (0, 5)}
print("areas of turned squares by their lower corner:", {low: round(size, 3) for low, size in turned.items()})
print("corners:", [tuple(round(c, 3) for c in corner) for corner in points(Tools.rotate(square(0, 10), 30))[-5:]])
circles = {arc: length(program("G1 X10 Y0", arc)) for arc in ("G3 X10 Y0 I-10 J0", "G2 X10 Y0 I-10 J0", "G3 X0 Y10 I-10 J0")}
print("lengths of arcs:", {arc: round(way, 3) for arc, way in circles.items()})
sides = ("G1 X20 Y10 E1", "G1 X20 Y20 E1", "G1 X10 Y20 E1", "G1 X10 Y10 E1")
centre = Tools.center_of_mass(program("G1 X10 Y10", *sides))
print(f"centre of mass of the loop: {centre.X:.3f}, {centre.Y:.3f}")
assert abs(turned[5] - 100.0) < 1e-6 and abs(circles["G3 X0 Y10 I-10 J0"] - 5.0 * pi) < 1e-2
assert abs(turned[0] - 86.603) < 1e-2, "points on the axes turn now"
assert circles["G3 X10 Y0 I-10 J0"] < 1e-9 and circles["G2 X10 Y0 I-10 J0"] < 1e-9, "full circles are traced now"
assert abs(centre.X - 13.571) < 1e-2, "the centre of mass counts each side by itself now"
END
