#!/usr/bin/env bash
# superellipse 0.8.0: outward normals point inwards in one quadrant and are askew in two; the curvature of an ellipse changes its sign.
# Expected: `normal` is "Outward unit normal at parameter t", for an ellipse (2 cos t, 3 sin t) over its length; `tangent` is that turned by
#   90 deg; the signed curvature 6 / |.|^3 has one sign all round, since ellipses and superellipses are convex. "CAD/CAM: Smooth corner
#   profiles for machining" is a use of the package.
# Seen: of the ellipse with half axes 3 and 2 mm the normals of the first quadrant are the inward ones; those of the second and fourth are mirrored in
#   an axis, 15 to 165 deg off, and those of the third are right. Tangents are right in the first, turned round in the third, mirrored
#   in the others. The curvature is negative in the second and fourth. A cutter of radius 0.5 mm led along points plus 0.5 times normals
#   cuts up to 0.5 mm into the part. Points, insides, arc lengths and the curvature's size are right, and so for exponents of 4, where
#   `sample(method="arclength")`, "uniform in arc length", has steps of 0.42 to 1. No warning.
# Versions: superellipse 0.8.0, numpy 2.4.6.
# Meets: whoever offsets elliptical pitch curves, cams, pockets or electrodes for a cutter or wire, or sums curvature along them.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q superellipse==0.8.0 numpy==2.4.6
"$folder/venv/bin/python" - <<'END'
import numpy as np
from superellipse import Superellipse

A, B, OFFSET = 3.0, 2.0, 0.5
ellipse = Superellipse(a=A, b=B, p=2)
around = np.linspace(0.0, 2.0 * np.pi, 200_001)
curve = np.column_stack((A * np.cos(around), B * np.sin(around)))
for quadrant in range(4):
    at = 0.5 * np.pi * quadrant + np.array([0.2, 0.6, 1.0, 1.4])
    size = np.hypot(A * np.sin(at), B * np.cos(at))
    outward = np.column_stack((B * np.cos(at), A * np.sin(at))) / size[:, None]
    along = np.column_stack((-A * np.sin(at), B * np.cos(at))) / size[:, None]
    points, normals, tangents, curvature = (getattr(ellipse, name)(at) for name in ("point", "normal", "tangent", "curvature"))
    assert np.allclose(points, np.column_stack((A * np.cos(at), B * np.sin(at))), atol=1e-12)
    assert np.allclose(abs(curvature), A * B / size**3, rtol=1e-9)
    cosines, senses = (normals * outward).sum(1), (tangents * along).sum(1)
    path = points + OFFSET * normals
    inside = ((path / (A, B)) ** 2).sum(1) < 1.0
    clear = np.linalg.norm(path[:, None] - curve[None, ::20], axis=2).min(1) * np.where(inside, -1.0, 1.0)
    degrees = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    print(f"quadrant {quadrant + 1}: normals {np.round(degrees, 1)} deg off, tangents . true {np.round(senses, 3)}, curvature of sign {np.sign(curvature)}")
    print(f"  path {OFFSET} mm outside runs {np.round(clear, 3)} mm outside")
    if quadrant == 0:
        assert np.all(cosines < -0.999) and np.all(senses > 0.999) and np.allclose(clear, -OFFSET, atol=1e-3), "normals point outwards now"
    elif quadrant == 2:
        assert np.all(cosines > 0.999) and np.all(senses < -0.999) and np.allclose(clear, OFFSET, atol=1e-3), "tangents run one way now"
    else:
        assert np.all(cosines < 0.97) and clear.min() < -0.4 and np.all(curvature < 0.0), "normals and curvature keep their sense now"
squircle = Superellipse(a=A, b=B, p=4)
fine = np.sign(np.cos(around)) * A * abs(np.cos(around)) ** 0.5, np.sign(np.sin(around)) * B * abs(np.sin(around)) ** 0.5
length = float(np.hypot(*np.diff(fine)).sum())
sampled = squircle.sample(200, method="arclength")
steps = np.hypot(*np.diff(sampled, axis=0).T)
print(f"exponent 4: length {squircle.arc_length():.5f} for {length:.5f}, steps of equal length {steps.min() / steps.max():.3f}")
assert abs(squircle.arc_length() / length - 1.0) < 1e-5
assert steps.min() / steps.max() < 0.6, "steps have equal lengths now"
END
