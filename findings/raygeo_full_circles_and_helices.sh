#!/usr/bin/env bash
# raygeo 1.67.2: the bounding rectangle of a full circle is a point, and lengths of paths leave out z.
# Expected: an arc that ends where it begins is a full circle, as in G-code (G2, G3 with I and J); `rect` is "(x_min, y_min, x_max, y_max)".
#   `distance` is "the total path distance in mm"; a helix of radius 10 mm that falls 20 mm in half a turn is
#   hypot(31.416, 20) = 37.242 mm long.
# Seen: length and area of a full circle are those of a full circle, its rectangle is (10, 0, 10, 0), and so is that of its segment. Half
#   circles have theirs, and so has the circle as two halves. The helix is 31.416 mm long, as its circle, and a straight line to
#   (3, 0, 4) is 3 mm long, though commands keep their z. No warning.
# Versions: raygeo 1.67.2, numpy 2.4.6, msgpack 1.2.4.
# Meets: whoever frames, places or checks jobs of holes and bores by their rectangle, or times ramps and thread milling by length.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q raygeo==1.67.2 numpy==2.4.6 msgpack==1.2.4
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import numpy as np
from raygeo.geo import Geometry

RADIUS, DEPTH = 10.0, 20.0


def path(*arcs):
    """A path from (10, 0), of arcs to x = 10 or -10 about the middle, counter-clockwise."""
    found, x = Geometry().move_to(RADIUS, 0.0, 0.0), RADIUS
    for end, z in arcs:
        found.arc_to(end, 0.0, -x, 0.0, clockwise=False, z=z)
        x = end
    return found


circle, halves, helix = path((RADIUS, 0.0)), path((-RADIUS, 0.0), (RADIUS, 0.0)), path((-RADIUS, -DEPTH))
line = Geometry().move_to(0.0, 0.0, 0.0).line_to(3.0, 0.0, 4.0)
right = np.hypot(np.pi * RADIUS, DEPTH)
print(f"full circle: length {circle.distance():.3f}, rectangle {circle.rect()}, of its segment {circle.segment_bounds(1)}")
print(f"two halves: rectangle {halves.rect()}")
print(f"helix: {helix.distance():.3f} mm for {right:.3f}; line {line.distance():.3f}")
assert abs(circle.distance() - 2.0 * np.pi * RADIUS) < 1e-9 and np.allclose(halves.rect(), (-10, -10, 10, 10))
assert line.iter_typed_commands()[1].end == (3.0, 0.0, 4.0)
assert np.allclose(circle.rect(), (10, 0, 10, 0)), "the rectangle is right now"
assert abs(helix.distance() - np.pi * RADIUS) < 1e-6 and abs(line.distance() - 3.0) < 1e-9, "lengths have z now"
END
