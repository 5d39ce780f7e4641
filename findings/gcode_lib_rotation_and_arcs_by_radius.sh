#!/usr/bin/env bash
# gcode-lib 1.1.13: rotated programs lose the axis that a line leaves out, and arcs given by radius become full circles about their start.
# Expected: `rotate_xy` turns the way of the tool: "Rotate XY coordinates by angle_deg degrees". A line `G1 X10` keeps its Y, so that the
#   rotated line has X and Y. `linearize_arcs` says "Replace all G2/G3 arcs with equivalent G1 segments"; `G2 X10 Y0 R5` is an arc, too.
# Seen: the square X10, Y10, X0, Y0, turned by 30 deg about the origin, has an area of 186.6 for 100; the same square with X and Y in each
#   line has 100. The arc of 5 mm radius becomes a full circle of 10 mm about its start: 72.7 mm of lines for 15.7, bounds of 20 x 20 mm for
#   10 x 5. A helix rises to its final height in its first line. No warning.
# Versions: gcode-lib 1.1.13.
# Meets: whoever turns, moves or checks programs for printed or milled gears; slicers and CAM leave out words that do not change.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q gcode-lib==1.1.13
"$folder/venv/bin/python" - <<'END'
from math import dist, pi

import gcode_lib as gcode


def way(lines):
    """Positions after each move."""
    state, points = gcode.ModalState(), []
    for line in lines:
        gcode.advance_state(state, line)
        if line.is_move:
            points.append((state.x, state.y, state.z))
    return points


def area(points):
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, points[1:] + points[:1]))


def turned(text):
    return area(way(gcode.rotate_xy(gcode.parse_lines(text), 30.0, pivot_x=0.0, pivot_y=0.0, skip_negative_y=False)))


short = turned("G90\nG1 X0 Y0\nG1 X10\nG1 Y10\nG1 X0\nG1 Y0\n")
full = turned("G90\nG1 X0 Y0\nG1 X10 Y0\nG1 X10 Y10\nG1 X0 Y10\nG1 X0 Y0\n")
print(f"turned square: area {short:.3f}, with both axes in each line {full:.3f}")
by_radius, by_centre = "G90\nG1 X0 Y0\nG2 X10 Y0 R5\n", "G90\nG1 X0 Y0\nG2 X10 Y0 I5 J0\n"
length = {}
for text in (by_radius, by_centre):
    points = way(gcode.linearize_arcs(gcode.parse_lines(text), seg_mm=0.1))
    length[text] = sum(dist(a, b) for a, b in zip(points, points[1:]))
    box = gcode.compute_bounds(gcode.parse_lines(text))
    print(f"{text.split(chr(10))[2]}: {length[text]:.3f} mm of lines, bounds {box.width:.3f} x {box.height:.3f} mm")
helix = way(gcode.linearize_arcs(gcode.parse_lines("G90\nG1 X0 Y0 Z0\nG3 X10 Y0 Z6 I5 J0\n"), seg_mm=4.0, max_deg=360.0))[1:]
heights = [point[2] for point in helix]
print("heights along half a turn that rises by 6 mm:", heights)
assert abs(full - 100.0) < 1e-6 and abs(length[by_centre] - 5.0 * pi) < 1e-2
assert abs(short - 186.603) < 1e-2, "lines with one axis are turned now"
assert length[by_radius] > 50.0, "arcs by radius are read now"
assert heights[0] == 6.0, "the height of a helix grows along it now"
END
