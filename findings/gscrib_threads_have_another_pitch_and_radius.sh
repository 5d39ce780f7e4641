#!/usr/bin/env bash
# gscrib 1.2.0: `trace.thread` traces another pitch than asked for, and beside X0 Y0 a spiral instead of a thread of constant radius.
# Expected: its help says "a helical motion with constant radius from the current position to the target point", and of pitch "distance
#   between turns in Z axis". A target across the diameter is half a turn away: 20 mm with a pitch of 2 mm are 9.5 or 10.5 turns
#   of 2.105 or 1.905 mm, or 10 of 2.
# Seen: from (0, 0) the 9.5 turns of radius 5. The same thread 10 mm further along x, from (10, 0) to (20, 0), has its centre taken as (5, 0):
#   the target less the start is halved and the start taken off again, though centres are relative. About it the radius grows from
#   5 to 15 mm, a spiral up to 24.5 mm from the axis of the bore. `helix` with a centre, `arc` and `circle` are right. No warning.
# Versions: gscrib 1.2.0, numpy 2.4.6, scipy 1.17.1.
# Meets: whoever mills threads or bores by helix, away from the origin, as nearly every hole of a plate is.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q gscrib==1.2.0 numpy==2.4.6 scipy==1.17.1
"$folder/venv/bin/python" - "$folder" <<'END'
import re
import sys
from math import atan2, hypot, pi

from gscrib import GCodeBuilder


def way(start, draw):
    """Points of the program's moves from the start on."""
    file = f"{sys.argv[1]}/way.g"
    builder = GCodeBuilder(output=file)
    builder.set_resolution(0.1)
    builder.set_direction("ccw")
    builder.set_distance_mode("absolute")
    builder.move(start)
    draw(builder.trace)
    builder.teardown()
    points, at = [], [0.0, 0.0, 0.0]
    for line in open(file):
        if re.match(r"G[01]\b", line):
            for axis, value in re.findall(r"([XYZ])([-\d.]+)", line):
                at["XYZ".index(axis)] = float(value)
            points.append(tuple(at))
    return points


def about(points, x, y):
    """Turns about an axis, and the least and greatest distance from it."""
    arms = [(a - x, b - y) for a, b, _ in points]
    turned = sum(atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]) for p, q in zip(arms, arms[1:]))
    return turned / (2.0 * pi), min(hypot(*p) for p in arms), max(hypot(*p) for p in arms)


def thread(x):
    points = way((x, 0.0, 0.0), lambda trace: trace.thread((x + 10.0, 0.0, 20.0), pitch=2.0))
    turns, least, greatest = about(points, x + 5.0, 0.0)
    print(f"from x = {x:g}: {turns:.3f} turns over 20 mm, {least:.3f} to {greatest:.3f} mm from the axis between start and target")
    return turns, least, greatest


origin, beside = thread(0.0), thread(10.0)
turns, least, greatest = about(way((10.0, 0.0, 0.0), lambda trace: trace.helix((10.0, 0.0, 20.0), (-5.0, 0.0), turns=10)), 5.0, 0.0)
print(f"helix with its centre: {turns:.3f} turns, {least:.3f} to {greatest:.3f} mm")
assert abs(turns - 10.0) < 1e-3 and abs(least - 5.0) < 1e-2 and abs(greatest - 5.0) < 1e-2
assert abs(origin[0] - 9.5) < 1e-2 and abs(origin[2] - 5.0) < 1e-2
assert beside[2] > 14.0 and beside[1] < 1.0, "the radius of a thread beside the origin is constant now"
END
