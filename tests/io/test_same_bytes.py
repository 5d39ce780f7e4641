"""The same command gives the same bytes: in another process, with another hash seed, another day, another zone."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from oracles.places import ROOT, SAMPLES

# zip dates and other clocks have steps of two seconds at most: the second run lives on another day
PROGRAM = """
import sys, time
shift = float(sys.argv[1])
now, local = time.time, time.localtime
time.time = lambda: now() + shift
time.localtime = lambda seconds=None: local(now() + shift if seconds is None else seconds)
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
model = gears.finite_elements().model
for name, entry in formats().items():
    write_model(model, name + entry.suffix, name)
"""


def files(folder: Path, shift: float, seed: str, zone: str) -> dict[str, bytes]:
    folder.mkdir()
    environment = {**os.environ, "PYTHONHASHSEED": seed, "TZ": zone, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": seed}
    program = PROGRAM.format(sample=str(SAMPLES / "spur.toml"))
    subprocess.run([sys.executable, "-c", program, str(shift)], cwd=folder, env=environment, check=True)
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_two_processes_write_the_same(tmp_path: Path) -> None:
    first, second = files(tmp_path / "a", 0.0, "1", "UTC"), files(tmp_path / "b", 5e6, "2", "Asia/Tokyo")
    assert {"pinion.3mf", "both.glb", "both.vtm", "calculix.inp", "gmsh.msh", "vtu.vtu"} < set(first)
    assert set(first) == set(second)
    assert [name for name in first if first[name] != second[name]] == []
