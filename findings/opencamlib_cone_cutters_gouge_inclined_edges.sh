#!/usr/bin/env bash
# OpenCAMLib 2023.1.11: conical cutters, and combined ones by their cone, are dropped too deep onto edges that are not level.
# Expected: the tip of a cone of half angle a that touches an edge of slope m at a distance d stands at the height
#   z = -d sqrt(1 / tan(a)^2 - m^2) over the edge's point abreast of it. Ball and bull cutters are on their own such heights to 1e-9.
# Seen: for half an angle of 35 deg, 3 mm from an edge at 45 deg, the tip is 0.98 mm below that: it cuts into the part. At a slope of
#   0.3 it is 0.07 mm. Level edges are right. CylConeCutter, BallConeCutter and ConeConeCutter are off by the same where their cone
#   touches, 0.34 mm for the first two at 2 mm. No warning.
# Versions: opencamlib 2023.1.11, numpy 2.4.6.
# Meets: whoever engraves, deburrs, chamfers or V-carves with drop-cutter paths over a mesh, and whoever checks such a path for gouges.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q opencamlib==2023.1.11 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import numpy as np
import opencamlib as ocl

HALF_ANGLE = np.radians(35.0)
COTANGENT = 1.0 / np.tan(HALF_ANGLE)
# height of the cutter's surface over its tip, by the distance from its axis
CUTTERS = {
    "ball": (ocl.BallCutter(10.0, 50.0), lambda r: 5.0 - np.sqrt(25.0 - r * r)),
    "cone": (ocl.ConeCutter(10.0, HALF_ANGLE, 50.0), lambda r: COTANGENT * r),
    "cylinder and cone": (ocl.CylConeCutter(4.0, 10.0, HALF_ANGLE), lambda r: COTANGENT * np.maximum(r - 2.0, 0.0)),
}


def dropped(cutter, distance, slope):
    """Height of the tip over the z axis, for a ridge at y = distance with a face that falls steeply towards the axis."""
    surface, path = ocl.STLSurf(), ocl.BatchDropCutter()
    corners = ((-8.0, distance, -8.0 * slope), (8.0, distance, 8.0 * slope), (0.0, distance + 0.001, -60.0))
    surface.addTriangle(ocl.Triangle(*(ocl.Point(*corner) for corner in corners)))
    path.setSTL(surface)
    path.setCutter(cutter)
    path.appendPoint(ocl.CLPoint(0.0, 0.0, -1000.0))
    path.run()
    return path.getCLPoints()[0].z


for name, (cutter, height) in CUTTERS.items():
    for distance, slope in ((2.0, 0.0), (2.0, 0.3), (2.0, 1.0), (3.0, 0.3), (3.0, 1.0)):
        along = np.linspace(-8.0, 8.0, 1_600_001)
        radius = np.hypot(along, distance)
        under = radius < 5.0
        right = (slope * along - height(np.where(under, radius, 0.0)))[under].max()
        if name == "cone":
            assert abs(right + distance * np.sqrt(COTANGENT**2 - slope**2)) < 1e-9
        off = dropped(cutter, distance, slope) - right
        print(f"{name}, edge {distance:g} mm away with slope {slope:g}: tip at {right + off:.4f}, should be {right:.4f} mm")
        if name == "ball" or slope == 0.0:
            assert abs(off) < 1e-6
        else:
            assert off < -0.02, "inclined edges are right now"
END
