#!/usr/bin/env bash
# compmec-nurbs 1.0.8: a rational curve that is split inside of a span becomes another curve; arcs bulge by 6 %.
# Expected: the help of `split` says "Separate the current curve at specified nodes": the pieces are the curve. `knot_insert` at the same
#   place keeps it, as do `degree_increase` and `split` at knots.
# Seen: control points and weights are split each for itself, where points times weights, and weights, must be. A quarter circle of 10 mm
#   (weights 1, cos 45 deg, 1) that is split in the middle has pieces that meet at (7.5, 7.5), 10.607 mm from the centre: 0.607 mm off. A
#   full circle of four arcs is right when split at its knots, and 0.607 mm off when split at 0.5. Polynomial curves are right.
#   No warning; weights of the pieces are there and look plausible.
# Versions: compmec-nurbs 1.0.8, numpy 2.4.6.
# Meets: whoever trims profiles of arcs, conics and fillets, or cuts them into pieces for meshing or milling.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q compmec-nurbs==1.0.8 numpy==2.4.6
"$folder/venv/bin/python" - <<'END'
from math import cos, pi

import numpy as np
from compmec.nurbs import Curve

CORNERS = [(10, 0), (10, 10), (0, 10), (-10, 10), (-10, 0), (-10, -10), (0, -10), (10, -10), (10, 0)]


def circle(quarters):
    """Rational curve of so many quarters of a circle of radius 10, a span each."""
    inner = [knot for k in range(1, quarters) for knot in (k, k)]
    curve = Curve([0.0] * 3 + [float(k) for k in inner] + [float(quarters)] * 3, [np.array(p, float) for p in CORNERS[: 2 * quarters + 1]])
    curve.weights = [1.0, cos(0.25 * pi)] * quarters + [1.0]
    return curve


def off(curve):
    """Largest distance from the circle, mm."""
    first, last = float(curve.knots[0]), float(curve.knots[-1])
    return max(abs(np.hypot(*curve(float(u))) - 10.0) for u in np.linspace(first, last, 101))


def inserted(curve):
    curve.knot_insert([0.5])
    return curve


def raised(curve):
    curve.degree_increase(1)
    return curve


right = [off(circle(1)), off(inserted(circle(1))), off(raised(circle(1))), *map(off, circle(4).split())]
print("off by, mm: whole, with a knot, of degree 3, four quarters split at their knots:", [f"{value:.1e}" for value in right])
wrong = {quarters: [off(piece) for piece in circle(quarters).split([0.5])] for quarters in (1, 4)}
print("pieces split at 0.5, by quarters:", {quarters: [round(value, 4) for value in pieces] for quarters, pieces in wrong.items()})
first, second = circle(1).split([0.5])
print("where the pieces of a quarter meet:", first(0.5), second(0.5), "weights", first.weights, second.weights)
parabola = Curve([0.0] * 3 + [1.0] * 3, [np.array(p, float) for p in CORNERS[:3]])
assert all(np.abs(piece(u) - parabola(u)).max() < 1e-12 for piece, u in zip(parabola.split([0.5]), (0.3, 0.8)))
assert max(right) < 1e-9
assert all(abs(max(pieces) - (7.5 * 2.0**0.5 - 10.0)) < 1e-3 for pieces in wrong.values()), "rational curves are split right now"
END
