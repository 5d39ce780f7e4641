"""The same command gives the same bytes: in another process, with another hash seed, another day, another zone."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from oracles.places import ROOT, SAMPLES

from gearmesh.view.opengl import missing_opengl_message

# zip dates and other clocks have steps of two seconds at most: the second run lives on another day
CLOCK = """
import sys, time
shift = float(sys.argv[1])
now, local = time.time, time.localtime
time.time = lambda: now() + shift
time.localtime = lambda seconds=None: local(now() + shift if seconds is None else seconds)
"""

FORMATS = """
from gearmesh import io
import gearmesh as gm
from gearmesh.fe.decks import formats, write_model
from gearmesh.mesh.solid import gear_solid
keys = ["fe.torque=100.0", "fe.flank=4", "fe.fillet=3", "fe.teeth=1", "pinion.bore=18", "pinion.keyway={{width=6, depth=2.8}}"]
gears = gm.build(gm.load({sample!r}, keys))
scene = {{name: gear_solid(member, 0.05) for name, member in gears.members.items()}}
for suffix in io.formats():
    io.write(scene["pinion"], "pinion" + suffix)
    if suffix in io.formats(several=True):
        io.write_scene(scene, "both" + suffix)
model = gears.finite_elements()._model
for name, entry in formats().items():
    write_model(model, name + entry.suffix, name)
"""

#: every command that writes files, of one design each, as coarse and as small as may be; @ stands for the folder of the samples
COMMANDS = """
from gearmesh.app import cli
from gearmesh.reports import run
from gearmesh.answers import check
check.ROLL_TOLERANCE_MM = 1e-3
render = run.render
run.render = lambda scene, file: render(scene, file, (320, 240))
for line in '''
    tca @beveloid_crossed.toml --no-timing --json tca.json --csv tca.csv --torque 100 --set contact.phi1.count=5
    check @spur.toml --no-timing --tol 0.05 --json check.json
    limits @spur.toml --json limits.json
    settings @spiral_bevel_basic.toml --json sheet.json -o sheet.toml
    settings @circular_arc.toml --compensate --json compensated.json
    solid @novikov.toml --member worm --tol 0.5 -o worm.stl
    solid @spiral_bevel_basic.toml --member pinion --tol 0.1 -o bevel.ply
    solid @spur.toml --member gear --teeth 2 -o two.vtp
    solid @helical.toml --member both --set pinion.teeth=8 --set gear.teeth=9 --set pinion.bore=0 --set gear.bore=0 -o pair.step
    solid @spur.toml --member pinion -o section.dxf
    solid @spur.toml --member gear --section 2mm -o section.svg
    fe @spur.toml --no-timing --teeth 1 --set fe.flank=4 --set fe.fillet=3 -o model.inp --json fe.json
    new face_gear -o new.toml
    run @spur.toml --no-timing --tol 0.1 --set contact.phi1.count=3 -o out
'''.strip().splitlines():
    assert cli.main(line.replace("@", {samples!r}).split()) == 0, line
"""


def files(folder: Path, program: str, shift: float, seed: str, zone: str) -> dict[str, bytes]:
    """Return the files that a program writes into a new folder, in a process of its own."""
    folder.mkdir()
    environment = {**os.environ, "PYTHONHASHSEED": seed, "TZ": zone, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": seed}
    program = CLOCK + program.format(sample=str(SAMPLES / "spur.toml"), samples=f"{SAMPLES}/")
    subprocess.run([sys.executable, "-c", program, str(shift)], cwd=folder, env=environment, check=True)
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


#: of what is written, something of every kind
SOME = {
    *(
        "pinion.3mf",
        "both.glb",
        "both.vtm",
        "calculix.inp",
        "gmsh.msh",
        "vtu.vtu",
        "tca.json",
        "check.json",
        "worm.stl",
    ),
    *("pair.step", "section.dxf", "section.svg", "fe.json", "out/pair.png", "out/report.json", "out/report.html"),
}


@pytest.mark.sweep
def test_two_processes_write_the_same(tmp_path: Path) -> None:
    needs = {
        "pair.step": find_spec("OCP") is not None,
        "section.dxf": find_spec("ezdxf") is not None,
        "out/pair.png": missing_opengl_message() is None,
    }
    missing = {file for file, there in needs.items() if not there}
    lines = (FORMATS + COMMANDS).splitlines(keepends=True)
    program = "".join(line for line in lines if not any(file in line for file in missing))
    first = files(tmp_path / "a", program, 0.0, "1", "UTC")
    second = files(tmp_path / "b", program, 5e6, "2", "Asia/Tokyo")
    assert SOME - missing < set(first)
    assert set(first) == set(second)
    assert b'"timing"' not in first["tca.json"]
    assert [name for name in first if first[name] != second[name]] == []
