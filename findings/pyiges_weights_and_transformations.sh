#!/usr/bin/env bash
# pyiges 0.3.4: surfaces of IGES files lose their weights, so that cylinders are not round, and splines stay where no matrix has moved them.
# Expected: a quarter of a cylinder of radius 10 mm as a rational B-spline surface (type 128, weights 1, cos 45 deg, 1) is round; a
#   curve (126) that refers to a transformation matrix (124) stands where the matrix puts it.
# Seen: the surface bulges to a radius of 10.606 mm, with an area of 64.93 mm2 for 62.83: the weights are read, and the surface is built
#   without them. Curves (126) are built with theirs, and are round. A curve that is moved by 100 mm comes back where it was before.
#   gmsh (OpenCASCADE) reads the same file right. No warning.
# Versions: pyiges 0.3.4, geomdl 5.4.0, pyvista 0.49.1, vtk 9.7.2, numpy 2.4.6; gmsh 4.15.2.
# Meets: whoever looks at, meshes or measures turned and toothed parts of CAD by it: bores, cones and tips are rational surfaces.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q pyiges==0.3.4 geomdl==5.4.0 pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6 gmsh==4.15.2
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import gmsh
import numpy as np
import pyiges

RADIUS, HEIGHT, MOVED = 10.0, 4.0, 100.0


def write(path, entities):
    """IGES file of entities (type, matrix or 0, parameters); directory entries have odd numbers."""
    text = "1H,,1H;,4Hpart,4Hpart,4Hpart,4Hpart,32,38,6,308,15,4Hpart,1.,2,2HMM,1,0.01,15H20260101.000000,1E-6,1000.,4Hnone,4Hnone,11,0;"
    start = ["part".ljust(72) + "S      1"]
    head = [text[k : k + 72].ljust(72) + f"G{k // 72 + 1:7d}" for k in range(0, len(text), 72)]
    directory, data = [], []
    for n, (kind, matrix, parameters) in enumerate(entities):
        lines = [f"{kind},"]
        for value in parameters:
            word = f"{value!r},"
            lines += [""] if len(lines[-1]) + len(word) > 64 else []
            lines[-1] += word
        lines[-1] = lines[-1][:-1] + ";"
        entry = 2 * n + 1
        numbers = "".join(f"{value:8d}" for value in (kind, len(data) + 1, 0, 0, 0, 0, matrix, 0))
        directory.append(f"{numbers}00000000D{entry:7d}")
        directory.append("".join(f"{value:8d}" for value in (kind, 0, 0, len(lines), 0)) + " " * 24 + f"{0:8d}D{entry + 1:7d}")
        data += [f"{line:64s} {entry:7d}P{len(data) + k:7d}" for k, line in enumerate(lines, 1)]
    end = f"S{1:7d}G{len(head):7d}D{len(directory):7d}P{len(data):7d}".ljust(72) + "T      1"
    with open(path, "w") as file:
        file.write("\n".join(start + head + directory + data + [end]) + "\n")


knots, ends, weights = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0], [1.0, float(np.sqrt(0.5)), 1.0]
circle = [RADIUS, 0.0, 0.0, RADIUS, RADIUS, 0.0, 0.0, RADIUS, 0.0]
above = [RADIUS, 0.0, HEIGHT, RADIUS, RADIUS, HEIGHT, 0.0, RADIUS, HEIGHT]
surface = [2, 1, 2, 1, 0, 0, 0, 0, 0, *knots, *ends, *weights, *weights, *circle, *above, 0.0, 1.0, 0.0, 1.0]
curve = [2, 2, 1, 0, 0, 0, *knots, *weights, *circle, 0.0, 1.0, 0.0, 0.0, 1.0]
matrix = [1.0, 0.0, 0.0, MOVED, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]
write("part.igs", [(128, 0, surface), (126, 0, curve), (124, 0, matrix), (126, 5, curve)])

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
shapes = gmsh.model.occ.importShapes("part.igs", highestDimOnly=False)
(area,) = [gmsh.model.occ.getMass(*shape) for shape in shapes if shape[0] == 2]
centres = [gmsh.model.occ.getCenterOfMass(*shape)[0] for shape in shapes if shape[0] == 1]
print(f"gmsh: area {area:.3f} mm2, a curve about x = {max(centres):.2f} mm")
assert abs(area - np.pi / 2 * RADIUS * HEIGHT) < 1e-6 and max(centres) > MOVED

entities = list(pyiges.read("part.igs"))
mesh = entities[0].to_vtk(delta=0.02)
radii = np.hypot(*mesh.points[:, :2].T)
print(f"surface: radius {radii.min():.3f} to {radii.max():.3f} mm, area {mesh.area:.3f}, should be {np.pi / 2 * RADIUS * HEIGHT:.3f} mm2")
assert radii.max() > 1.06 * RADIUS, "surfaces have weights now"
still, moved = (entities[k].to_vtk().points for k in (1, 3))
print(f"curve: radius {np.hypot(*still[:, :2].T).min():.6f} mm; the moved one from x = {moved[:, 0].min():.1f}, should be {MOVED:.1f} mm")
assert np.allclose(np.hypot(*still[:, :2].T), RADIUS)
assert np.allclose(still, moved), "matrices move curves now"
END
