"""The command `gear`, and `gm.gear`: one gear in one line, and what is refused."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.app.cli import main

SPUR = ["gear", "--module", "1", "--teeth", "30"]


@pytest.mark.sweep
def test_writes_the_gear_of_its_design(tmp_path: Path) -> None:
    """All ways to one gear write the same bytes: options, the design that they write, and the call in Python."""
    options = ["--module", "2", "--teeth", "17", "--helix", "12", "--hand", "left", "--face", "0.5in", "--shift", "0.2"]
    options += ["--bore", "8mm", "--pressure-angle", "22.5", "--set", "gear.tip_chamfer=0.1"]
    stl, design, other = (tmp_path / name for name in ("a.stl", "a.toml", "b.stl"))
    for file in (stl, design):
        assert main(["gear", *options, "-o", str(file)]) == 0
    assert main(["solid", str(design), "--member", "all", "-o", str(tmp_path / "all.stl.3mf")]) == 0
    assert main(["solid", str(design), "--member", "gear", "-o", str(other)]) == 0
    assert stl.read_bytes() == other.read_bytes()
    in_python = gm.gear(
        17,
        module=2,
        helix=12,
        hand="left",
        face="0.5in",
        shift=0.2,
        bore=8,
        pressure_angle=22.5,
        settings=["gear.tip_chamfer=0.1"],
    )
    in_python.solid("gear", file=stl).save(other)
    assert stl.read_bytes() == other.read_bytes()
    assert in_python.design.own() is not None
    assert in_python.members["gear"].tooth.teeth == 17


def test_prints_the_sheet(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*SPUR, "--internal", "--face", "5"]) == 0
    printed = capsys.readouterr().out
    assert "-30" in printed
    assert "over (internal: between) balls" in printed


def test_writes_a_rack(tmp_path: Path) -> None:
    file = tmp_path / "rack.step.stl"
    assert main(["gear", "--rack", "--teeth", "6", "--module", "1.5", "--helix", "8", "-o", str(file)]) == 0
    assert len(file.read_bytes()) == 84 + 50 * len(
        gm.gear(6, module=1.5, helix=8, rack=True).solid("rack").mesh.triangles
    )


def test_diametral_pitch_is_that_of_the_module() -> None:
    one, other = gm.gear(20, diametral_pitch=25.4 / 3), gm.gear(20, module="3mm")
    assert np.allclose(one.solid("gear", 0.05).mesh.vertices, other.solid("gear", 0.05).mesh.vertices, atol=1e-12)


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["--teeth", "30"], "--module: missing; give module or diametral_pitch"),
        ([*SPUR[1:], "--diametral-pitch", "8"], "--diametral-pitch = 8: cannot be given together with module"),
        (["--teeth", "2", "--module", "1"], "--teeth = 2: must be a whole number from 3 to 10000"),
        (["--teeth", "30", "--module", "1/2"], "--module = 1/2: must be a length as 5, -2.5mm or 0.1in"),
        ([*SPUR[1:], "--face", "10furlong"], "--face = 10furlong: must be a length as 5, -2.5mm or 0.1in"),
        ([*SPUR[1:], "--hand", "up"], '--hand = "up": must be one of "right", "left"'),
        ([*SPUR[1:], "--bore", "40"], "--bore = 40 mm: the root lies below the bore; allowed is less than"),
        ([*SPUR[1:], "-o", "x.pdf"], "cannot write x.pdf: its suffix must be one of .glb"),
        ([*SPUR[1:], "--set", "gear.teeth=1"], "gear.teeth = 1: must be a whole number"),
        ([*SPUR[1:], "--set", "assembly.dx=1"], "assembly: needs a mating gear: give both tables, [pinion] and [gear]"),
        ([*SPUR[1:], "--internal", "--rack"], "--internal = true: must be left out for a rack"),
    ],
)
def test_refuses_in_one_line(options: list[str], line: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gear", *options]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"gearmesh: error: {line}")
    assert said.count("\n") == 1


def test_loads_no_more_than_a_solid_needs(tmp_path: Path) -> None:
    program = (
        "import sys; from gearmesh.app.cli import main\n"
        f"main({[*SPUR, '-o', str(tmp_path / 'g.stl')]!r})\n"
        "heavy = ('scipy', 'matplotlib', 'pyvista', 'rich', 'trimesh', 'gearmesh.contact', 'gearmesh.loaded', 'gearmesh.view')\n"
        "print([name for name in heavy if name in sys.modules], file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stderr.splitlines()[-1] == "[]"
