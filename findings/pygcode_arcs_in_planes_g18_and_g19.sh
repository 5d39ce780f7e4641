#!/usr/bin/env bash
# pygcode 0.2.1: arcs in the planes G18 and G19 are made lines on other ways, and a full turn of a helix is one straight line.
# Expected: `linearize_arc(..., plane, max_error=0.01)` gives lines within 0.01 of the arc in each plane: its help says "maximum distance
#   approximation arcs can stray from original arc". A G3 of 90 deg with r = 10 has about 18 lines. G3 with the start as its end and
#   a height is a full turn, as in thread milling.
# Seen: G17 is right (18 lines, 0.0095 off). Quarters in G18 and G19 are 36 lines up to 2.63 off the arc, or one straight line, 2.93 off, as
#   their centre stands on the first or second axis of the plane. Half circles are right. A full turn with a height of 4 is one line
#   upwards. No warning.
# Versions: pygcode 0.2.1, euclid3 0.1, six 1.17.0.
# Meets: whoever makes lines of turning, gashing and thread milling programs, also by the package's own `pygcode-norm`.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q pygcode==0.2.1 euclid3==0.01 six==1.17.0
"$folder/venv/bin/python" - <<'END'
from math import hypot

import pygcode
from pygcode.machine import Position
from pygcode.transform import ArcLinearizeInside, linearize_arc

RADIUS, ERROR = 10.0, 0.01
# plane, its first and second axis in the sense of G3
PLANES = {"G17": (pygcode.GCodeSelectXYPlane, "XY"), "G18": (pygcode.GCodeSelectZXPlane, "ZX"), "G19": (pygcode.GCodeSelectYZPlane, "YZ")}
# end and centre of arcs from (0, 0), counter-clockwise
ARCS = {
    "half circle": ((20, 0), (10, 0)),
    "quarter, centre on axis 1": ((10, -10), (10, 0)),
    "quarter, centre on axis 2": ((10, 10), (0, 10)),
}
CENTRES = {"X": "I", "Y": "J", "Z": "K"}


def lines(word, plane):
    arc = next(code for code in pygcode.Line(word).block.gcodes if isinstance(code, pygcode.GCodeArcMove))
    points = [{"X": 0.0, "Y": 0.0, "Z": 0.0}]
    for line in linearize_arc(arc, Position(X=0, Y=0, Z=0), plane(), ArcLinearizeInside, max_error=ERROR):
        points.append({**points[-1], **line.get_param_dict("XYZ")})
    return points


def measured(name, arc):
    """Lines and largest distance from the arc of a G3 from (0, 0), with end and centre in the axes of the plane."""
    plane, axes = PLANES[name]
    end, centre = ARCS[arc]
    words = [f"{axis}{length:g}" for axis, length in zip(axes, end)] + [f"{CENTRES[axis]}{length:g}" for axis, length in zip(axes, centre)]
    points = [[point[axis] for axis in axes] for point in lines("G3 " + " ".join(words), plane)]
    strays = [
        abs(hypot(*(p + t / 20 * (q - p) - c for p, q, c in zip(a, b, centre))) - RADIUS)
        for a, b in zip(points, points[1:])
        for t in range(21)
    ]
    print(f"{name}, {arc}: {len(points) - 1} lines, up to {max(strays):.4f} off the arc")
    return len(points) - 1, max(strays)


found = {(name, arc): measured(name, arc) for name in PLANES for arc in ARCS}
turn = lines("G3 X0 Y0 Z4 I10 J0", pygcode.GCodeSelectXYPlane)
print(f"full turn with a height of 4: {len(turn) - 1} lines")
assert all(found["G17", arc][1] <= ERROR for arc in ARCS)
assert all(found[name, "half circle"][1] <= ERROR for name in PLANES)
for name in ("G18", "G19"):
    assert found[name, "quarter, centre on axis 1"][1] > 2.0, "arcs are right now"
    assert found[name, "quarter, centre on axis 2"][0] == 1, "arcs are right now"
assert len(turn) == 2, "a full turn has more than one line now"
END
