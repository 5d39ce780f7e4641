"""Discs of cycloidal drives beside those of another program, cycloidgen 8.0.0: points of the lobes, STEP files at equal accuracy.

Usage: python scripts/cycloidal_against.py PYTHON [--tolerance MM]

PYTHON is an interpreter with `pip install cycloidgen==8.0.0`. Both programs write a disc with bore and output holes, in turns,
each in a process of its own. Times are CPU seconds without imports. Files of both are read back and compared with the curve in
closed form: the largest distance of their outline is measured, not taken from the programs.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import gearmesh as gm
from gearmesh.systems.cycloidal.build import Drive
from gearmesh.teeth.region import Side

#: radius of the pins' circle, radius of a pin, eccentricity, lobes; mm
DESIGNS = {"small": (50.0, 5.0, 1.5, 19), "slow": (80.0, 3.5, 0.9, 59), "fast": (40.0, 6.0, 2.0, 11)}
WIDTH, BORE, HOLES, PIN, HOLE_CIRCLE = 10.0, 20.0, 6, 5.0, 44.0
#: rounds in which both write, of which the median counts
ROUNDS = 3
#: points along the lobes at which both curves are compared
POINTS = 4001
#: points along each edge of a file at which its outline is measured
POINTS_PER_EDGE = 200

OTHER = """
import json, sys, time, numpy as np
import cadquery as cq
from cycloidgen.core.profile import disc_profile, profile_spline_from_spec
from cycloidgen.core.spec import GearSpec
from cycloidgen.export.solid import disc_solid
circle, pin, e, lobes, width, bore, holes, output, hole_circle, tolerance, points, target = json.loads(sys.argv[1])
spec = GearSpec(pin_circle_radius=circle, pin_radius=pin, eccentricity=e, lobes=lobes, disc_thickness=width, profile_clearance=0.0,
                hole_clearance=0.0, center_bore_diameter=bore, output_pin_count=holes, output_pin_diameter=output,
                output_bolt_circle_radius=0.5 * hole_circle, edge_chamfer=0.0, dxf_chord_tolerance=tolerance)
begin = time.process_time()
solid = disc_solid(spec, bore=bore)
cq.exporters.export(solid, target)
seconds = time.process_time() - begin
t = np.linspace(0.0, 2.0 * np.pi, points)
np.save(target + ".npy", disc_profile(t, circle, pin, e, lobes))
print(json.dumps({"seconds": seconds, "claimed": profile_spline_from_spec(spec).deviation}))
"""

OWN = """
import json, sys, time
import gearmesh as gm
import gearmesh.cad.step
keys, tolerance, target = json.loads(sys.argv[1])
import os
gears = gm.build(gm.parse(keys))
begin = sum(os.times()[:4])
gears.cad("disc", tolerance=tolerance).save(target)
print(json.dumps({"seconds": sum(os.times()[:4]) - begin}))
"""


def keys_of(circle: float, pin: float, e: float, lobes: int) -> dict[str, Any]:
    """Return the design of a drive."""
    return {
        "kind": "cycloidal",
        "eccentricity": e,
        "pin_circle": 2.0 * circle,
        "pin_diameter": 2.0 * pin,
        "disc": {"teeth": lobes, "face_width": WIDTH, "bore": BORE},
        "ring": {"teeth": lobes + 1, "face_width": WIDTH},
        "output": {"pins": HOLES, "pin_diameter": PIN, "circle": HOLE_CIRCLE},
    }


def lobes_at(drive: Drive, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return points and normals (P, 2) of the lobes, clockwise from the middle of a space; t, rad, is a turn of the disc."""
    jet = drive.envelope(Side.LEFT).jet(drive.ground.lobes * t, np.zeros_like(t))
    c, s = np.cos(np.pi / drive.ground.lobes), np.sin(np.pi / drive.ground.lobes)
    turn = np.array([[c, -s], [s, c]])
    return jet.r[:, :2] @ turn, jet.n[:, :2] @ turn


def outline_deviation(file: Path, drive: Drive) -> float:
    """Return the largest distance (mm) of the outline in a STEP file from the lobes."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_BSplineCurve
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS
    from scipy.spatial import cKDTree

    reader = STEPControl_Reader()
    reader.ReadFile(str(file))
    reader.TransferRoots()
    edges = TopExp_Explorer(reader.OneShape(), TopAbs_EDGE)
    found = []
    while edges.More():
        curve = BRepAdaptor_Curve(TopoDS.Edge(edges.Current()))
        edges.Next()
        if curve.GetType() == GeomAbs_BSplineCurve:
            for u in np.linspace(curve.FirstParameter(), curve.LastParameter(), POINTS_PER_EDGE):
                point = curve.Value(float(u))
                found.append((point.X(), point.Y()))
    drawn = np.array(found)
    # the file may begin at another lobe or in the middle of one: both turns are tried
    exact, normals = lobes_at(drive, np.linspace(0.0, 2.0 * np.pi, 400 * drive.ground.lobes, endpoint=False))
    half = np.exp(1j * np.pi / drive.ground.lobes)
    deviations = []
    for turn in (1.0, half):
        turned = (drawn[:, 0] + 1j * drawn[:, 1]) * turn
        at = np.stack((turned.real, turned.imag), axis=-1)
        near = cKDTree(exact).query(at)[1]
        deviations.append(float(np.abs(((at - exact[near]) * normals[near]).sum(axis=-1)).max()))
    return min(deviations)


def run(python: str, code: str, arguments: list[Any]) -> dict[str, Any]:
    """Return the figures that a program prints as JSON in its last line."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run(
        [python, "-c", code, json.dumps(arguments)], capture_output=True, text=True, check=True, env=environment
    )
    return dict(json.loads(done.stdout.splitlines()[-1]))


def main() -> None:
    """Write a line for each design."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("python", help="interpreter with cycloidgen 8.0.0")
    parser.add_argument("--tolerance", type=float, default=0.001, help="of the files, mm")
    asked = parser.parse_args()
    print("design  lobes  points apart nm  file       seconds  bytes    outline um")
    with tempfile.TemporaryDirectory() as folder:
        for name, (circle, pin, e, lobes) in DESIGNS.items():
            keys = keys_of(circle, pin, e, lobes)
            drive = Drive(gm.parse(keys))
            files = {"gearmesh": Path(folder) / f"{name}_own.step", "cycloidgen": Path(folder) / f"{name}_other.step"}
            others = [circle, pin, e, lobes, WIDTH, BORE, HOLES, PIN, HOLE_CIRCLE, asked.tolerance, POINTS]
            times: dict[str, list[float]] = {"gearmesh": [], "cycloidgen": []}
            for _ in range(ROUNDS):
                own = run(sys.executable, OWN, [keys, asked.tolerance, str(files["gearmesh"])])
                other = run(asked.python, OTHER, [*others, str(files["cycloidgen"])])
                times["gearmesh"].append(own["seconds"])
                times["cycloidgen"].append(other["seconds"])
            theirs = np.load(f"{files['cycloidgen']}.npy")
            apart = np.abs(lobes_at(drive, np.linspace(0.0, 2.0 * np.pi, POINTS))[0] - theirs).max()
            for program, file in files.items():
                deviation = 1e3 * outline_deviation(file, drive)
                seconds = statistics.median(times[program])
                size = file.stat().st_size
                print(
                    f"{name:7} {lobes:5}  {1e6 * apart:15.2g}  {program:10} {seconds:7.2f}  {size:7}  {deviation:.3f}"
                )


if __name__ == "__main__":
    main()
