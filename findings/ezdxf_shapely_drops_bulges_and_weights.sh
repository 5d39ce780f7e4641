#!/usr/bin/env bash
# ezdxf-shapely 1.0: arcs in LWPOLYLINEs become chords, splines lose their weights, and entities seen from below are not mirrored.
# Expected: a bulge of 1 is a half circle in a light polyline as in the old POLYLINE; a rational spline through (10, 0), (10, 10), (0, 10)
#   with weights 1, cos 45 deg, 1 is a quarter circle; an arc with the extrusion (0, 0, -1) lies at -x. ezdxf flattens all of them so.
# Seen: the half disc under 10 mm with a strip of 5 mm has an area of 50 mm2 as LWPOLYLINE and 89.27 as POLYLINE (exactly 89.27). The quarter circle
#   bulges to 10.61 mm. The arc stands at +x. No warning. Bulges are looked for in vertices of four numbers, which have five.
# Versions: ezdxf-shapely 1.0, ezdxf 1.4.5, shapely 2.2.0, geomdl 5.4.0, numpy 2.4.6.
# Meets: whoever nests, mills, meshes or takes section values of outlines of CAD: light polylines are what programs write today.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q ezdxf-shapely==1.0 ezdxf==1.4.5 shapely==2.2.0 geomdl==5.4.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import ezdxf
import numpy as np
import shapely
from ezdxf import path
from ezdxf_shapely import convert_all

drawing = ezdxf.new().modelspace()
outline = [(0, 0, 1), (10, 0, 0), (10, 5, 0), (0, 5, 0)]
light = drawing.add_lwpolyline(outline, format="xyb", close=True)
heavy = drawing.add_polyline2d(outline, format="xyb", close=True)
corners, weights = [(10, 0, 0), (10, 10, 0), (0, 10, 0)], [1, np.sqrt(0.5), 1]
spline = drawing.add_rational_spline(corners, weights, degree=2, knots=[0, 0, 0, 1, 1, 1])
spline.dxf.flags |= 8  # planar, as programs mark it
below = drawing.add_arc((5, 0), 3, 0, 90, dxfattribs={"extrusion": (0, 0, -1)})


def both(entity):
    """Points of one entity by the package and by ezdxf."""
    (line,) = convert_all([entity], spline_delta=0.01)
    return np.array(line.coords)[:, :2], np.array([tuple(point)[:2] for point in path.make_path(entity).flattening(1e-4)])


exact = 10 * 5 + np.pi * 5**2 / 2
for name, entity in (("LWPOLYLINE", light), ("POLYLINE", heavy)):
    areas = [shapely.Polygon(points).area for points in both(entity)]
    print(f"{name}: area {areas[0]:.2f} mm2, by ezdxf {areas[1]:.2f}, exactly {exact:.2f}")
    assert abs(areas[1] - exact) < 0.05
    assert abs(areas[0] - (50 if entity is light else exact)) < 0.05, "bulges of light polylines are arcs now"
here, there = (np.hypot(*points.T).max() for points in both(spline))
print(f"quarter circle as spline: radius up to {here:.3f} mm, by ezdxf {there:.3f}")
assert abs(there - 10) < 0.01 and here > 10.6, "splines have weights now"
here, there = (points[:, 0].mean() for points in both(below))
print(f"arc seen from below: about x = {here:.2f} mm, by ezdxf {there:.2f}")
assert there < -5 and here > 5, "entities are mirrored now"
END
