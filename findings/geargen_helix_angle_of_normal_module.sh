#!/usr/bin/env bash
# geargen 0.0.1: helical gears by their normal module get another helix angle (33.69 for 30 deg), and `rootFillet` is not looked at.
# Expected: with `normal=True` the module is that of the hob: the pitch diameter is m_n z / cos(beta), the transverse pressure angle
#   atan(tan(alpha_n) / cos(beta)), and the teeth stand at beta on the pitch cylinder. `rootFillet` is a radius, 0.38 modules by default.
# Seen: diameter and pressure angle are converted, the twist is still that of the diameter m_n z: tan(beta) becomes tan(beta) / cos(beta).
#   24 teeth of module 2 mm and 30 deg stand at 33.69 deg, and their normal module is 1.921 mm, so that they do not mesh with gears
#   of a hob. Without `normal` the angle is right. Every fillet has a radius of 0.1 mm, whatever module and `rootFillet` are. No warning.
# Versions: geargen 0.0.1, cadquery 2.8.0, numpy 2.4.6.
# Meets: whoever prints or models a helical gear as drawings give it, by module and helix angle, to mate with a bought one.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q geargen==0.0.1 cadquery==2.8.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import cadquery as cq
import numpy as np
from geargen.parallel import makeParallelShaftGear
from geargen.profile import involuteProfile

MODULE, TEETH, HELIX, WIDTH = 2.0, 24, 30.0, 2.0  # so narrow that the twist is less than half a pitch


def tip(face):
    """Tip radius of an end face, and the angle of its teeth within a pitch."""
    places = np.array([v.X + 1j * v.Y for v in face.Vertices()])
    outer = places[np.abs(places) > np.abs(places).max() - 1e-3]
    return np.abs(outer).max(), np.angle(np.mean((outer / np.abs(outer)) ** TEETH)) / TEETH


def helix_angle(normal):
    solid = cq.Shape.cast(makeParallelShaftGear(MODULE, TEETH, WIDTH, type="helical", helixAngle=HELIX, normal=normal).wrapped)
    ends = sorted(solid.Faces(), key=lambda f: f.Center().z)
    (radius, low), (_, high) = tip(ends[0]), tip(ends[-1])
    transverse = MODULE / np.cos(np.radians(HELIX)) if normal else MODULE
    assert abs(radius - transverse * (TEETH / 2 + 1)) < 1e-6  # one transverse module over the pitch circle
    twist = (high - low + np.pi / TEETH) % (2.0 * np.pi / TEETH) - np.pi / TEETH
    angle = np.degrees(np.arctan(abs(twist) * transverse * TEETH / 2 / WIDTH))
    return angle, transverse * np.cos(np.radians(angle))


def fillets(module, **given):
    arcs = [e.radius() for e in involuteProfile(module, 18, **given).Edges() if e.geomType() == "CIRCLE"]
    return {round(r, 4) for r in arcs if r < 0.6 * module}


transverse, normal = helix_angle(False), helix_angle(True)
print(f"helix angle {transverse[0]:.3f} deg by the transverse module, {normal[0]:.3f} deg by the normal one (normal module {normal[1]:.4f} mm)")
radii = [fillets(2.0), fillets(2.0, rootFillet=0.6), fillets(10.0)]
print(f"root fillets of module 2, of module 2 with rootFillet=0.6, of module 10: {radii}")
assert abs(transverse[0] - HELIX) < 1e-3
assert abs(normal[0] - 33.690) < 1e-2, "the helix angle has changed"
assert radii == [{0.1}] * 3, "fillets follow module or rootFillet now"
END
