#!/usr/bin/env bash
# build123d 0.13.0: copies of one shape in an assembly all come back from a STEP file with the label of the last copy.
# Expected: three bolts labelled bolt_1, bolt_2, bolt_3, written by `export_step` and read by `import_step`, have their labels.
# Seen: bolt_3 three times, without a warning; the shapes and places are right. The file has the three names of the
#   occurrences, but the name of the part is that of the last copy, and `import_step` reads names of parts only.
#   Copies with a topology of their own (BRepBuilderAPI_Copy) keep their labels.
# Versions: build123d 0.13.0 with cadquery-ocp-novtk 8.0.1.1.0.
# Meets: whoever passes an assembly with repeated parts on by STEP and looks parts up by label.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q build123d==0.13.0 cadquery-ocp-novtk==8.0.1.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import copy
import re

import build123d as bd
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy


def labels(own_topology):
    bolt, bolts = bd.Solid.make_cylinder(2, 10), []
    for number in (1, 2, 3):
        own = bd.Solid(BRepBuilderAPI_Copy(bolt.wrapped).Shape()) if own_topology else copy.copy(bolt)
        own = own.moved(bd.Location((10 * number, 0, 0)))
        own.label = f"bolt_{number}"
        bolts.append(own)
    bd.export_step(bd.Compound(label="bolts", children=bolts), "bolts.step")
    return [part.label for part in bd.import_step("bolts.step").children]


shared = labels(False)
occurrences = re.findall(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('[^']*','([^']*)'", open("bolts.step").read())
print("shared shape:", shared, "- occurrences in the file:", occurrences)
separate = labels(True)
print("own topology:", separate)
assert shared == ["bolt_3"] * 3, "labels of copies are kept now"
assert occurrences == ["bolt_1", "bolt_2", "bolt_3"]
assert separate == ["bolt_1", "bolt_2", "bolt_3"]
END
