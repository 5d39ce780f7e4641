#!/usr/bin/env bash
# OpenCASCADE 8.0 (build123d 0.13.0): `volume` of a valid solid extruded from one closed spline can be a third too small.
# Expected: the volume of a prism is area times height, to many digits; the tessellated solid agrees.
# Seen: a wavy disc, a periodic spline through 48 points with 12 waves, 5 mm high: 1068 mm3, and no warning. Area times
#   height is 1586 mm3, which its triangles have too. `is_valid` is true. The side face is integrated with a fixed number of
#   points, whatever the number of spans of its spline; OpenCASCADE's adaptive integration (1e-8) is wrong as well (1364 mm3).
#   The same curve as twelve splines, one a wave, has the right volume.
# Versions: build123d 0.13.0 with cadquery-ocp-novtk 8.0.1.1.0.
# Meets: whoever takes masses of cams, lobed rotors and gears that were drawn as one spline through points and extruded.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q build123d==0.13.0 cadquery-ocp-novtk==8.0.1.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import build123d as bd
import numpy as np
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

WAVES, POINTS, HEIGHT = 12, 48, 5.0


def shoelace(x, y):
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


angle = np.arange(POINTS) * 2.0 * np.pi / POINTS
radius = 10.0 * (1.0 + 0.15 * np.cos(WAVES * angle))
points = [bd.Vector(r * np.cos(a), r * np.sin(a)) for r, a in zip(radius, angle)]
edge = bd.Edge.make_spline(points, periodic=True)
solid = bd.extrude(bd.Face(bd.Wire([edge])), HEIGHT)
along = [edge.position_at(u) for u in np.linspace(0.0, 1.0, 4800, endpoint=False)]
exact = HEIGHT * shoelace(np.array([p.X for p in along]), np.array([p.Y for p in along]))
corners, triangles = solid.tessellate(0.001, 0.05)
mesh = np.array([tuple(p) for p in corners])[np.array(triangles)]
meshed = float(np.einsum("ij,ij->i", mesh[:, 0], np.cross(mesh[:, 1], mesh[:, 2])).sum()) / 6.0
adaptive = GProp_GProps()
BRepGProp.VolumeProperties_s(solid.wrapped, adaptive, 1e-8)
print(f"valid {solid.is_valid}: volume {solid.volume:.1f}, adaptive {adaptive.Mass():.1f}, area x height {exact:.1f}, mesh {meshed:.1f}")
assert solid.is_valid
assert abs(meshed / exact - 1.0) < 1e-3
assert abs(solid.volume / exact - 1.0) > 0.1, "the volume is right now"
assert abs(adaptive.Mass() / exact - 1.0) > 0.1, "the adaptive volume is right now"
END
