#!/usr/bin/env bash
# gcode-collision-check 0.1.0: moves on lines without a G word are not checked, so that crashes pass, and arcs in G18 run the other way round.
# Expected: G0 to G3 and drilling cycles hold until another one comes, "Fanuc-style dialect (covers Fanuc, Haas, Mazak, ...)", "RS-274 tokenizer + modal
#   state": X-60 below a G1 is a move, X2 below G81 another hole. G2 is clockwise seen against the third axis of the plane: in G18,
#   against Y, from Z towards -X, so that a G3 from Z10 to X10 about the origin is a quarter circle.
# Seen: the same straight move into a vise has hits as "G1 X-60", and none as "X-60" on the line below G1: the program is "safe". Of "G1 X10", "X20",
#   "X30 Y5", "G1 Z0" two of four moves are left, with a gap between them that nothing crosses; positions go on right. Of three holes one is
#   left, without the way to it from X0. In G18 the quarter is 270 deg long, and G2 has 90 where 270 is right; G17, G19,
#   full circles and helices are right. No warning, and none of this is among its limits.
# Versions: gcode-collision-check 0.1.0, trimesh 5.2.0, python-fcl 0.7.0.11, numpy 2.4.6.
# Meets: whoever checks programs of a CAM system before the first run: most leave a G word out that is still valid.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q gcode-collision-check==0.1.0 trimesh==5.2.0 python-fcl==0.7.0.11 numpy==2.4.6
venv/bin/python - <<'END'
import numpy as np
import trimesh
from gcode_collision_check.collision.checker import verify
from gcode_collision_check.parser.arc_linearizer import linearize_arc
from gcode_collision_check.parser.gcode_parser import parse_program
from gcode_collision_check.tool.assembly import default_tool


def hits(*lines):
    """Number of lines on which the tool meets the vise, a block of 20 mm at x = -40 mm."""
    with open("part.nc", "w") as file:
        file.write("\n".join(lines) + "\n")
    found = verify("part.nc", {"vise": "vise.stl"}, default_tool())
    count = len({event.line_no for event in found.events})
    print("; ".join(lines), "->", count, "lines with hits,", "safe" if found.safe else "not safe")
    return count


def ends(*lines):
    moves = [(move.line_no, tuple(vars(move.start).values()), tuple(vars(move.end).values())) for move in parse_program("\n".join(lines) + "\n")]
    print("; ".join(lines), "->", moves)
    return moves


def sweep(plane, first, second, word):
    """Angle of a quarter or three quarters of a circle from the first axis of a plane to the second, positive from one to the other."""
    centre = {"X": "I", "Y": "J", "Z": "K"}[first]
    arc = parse_program(f"{plane}\nG0 {first}10 {second}0\n{word} {first}0 {second}10 {centre}-10\n")[-1]
    points = np.array([tuple(vars(point).values()) if hasattr(point, "x") else point for point in linearize_arc(arc)])
    angle = np.unwrap(np.arctan2(points[:, "XYZ".index(second)], points[:, "XYZ".index(first)]))
    print(f"{plane} {word} from {first}10 to {second}10: {np.degrees(angle[-1] - angle[0]):.1f} deg")
    return round(np.degrees(angle[-1] - angle[0]))


block = trimesh.creation.box(extents=(20.0, 60.0, 20.0))
block.apply_translation((-40.0, 0.0, 0.0))
block.export("vise.stl")
assert hits("G21 G90", "G0 Z50", "G0 X0 Y0", "G1 Z5 F200", "G1 X-60") == 1
assert hits("G21 G90", "G0 Z50", "G0 X0 Y0", "G1 Z5 F200", "X-60") == 0, "lines without a G word are checked now"
way = ends("G90 G0 Z5", "G1 X10 F100", "X20", "X30 Y5", "G1 Z0")
assert [line for line, *_ in way] == [1, 2, 5] and way[1][2] == (10.0, 0.0, 5.0) and way[2][1] == (30.0, 5.0, 5.0)
assert len(ends("G90 G0 Z10", "G81 X1 Y0 Z-5 R2 F100", "X2", "X3", "G80")) == 4, "holes below a cycle are drilled now"
for plane, first, second in (("G17", "X", "Y"), ("G19", "Y", "Z")):
    assert sweep(plane, first, second, "G3") == 90 and sweep(plane, first, second, "G2") == -270
assert sweep("G18", "Z", "X", "G3") == -270 and sweep("G18", "Z", "X", "G2") == 90, "arcs in G18 have their sense now"
END
