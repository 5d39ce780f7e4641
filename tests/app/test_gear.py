"""The command `gear`, and `gm.gear`: one gear in one line, and what is refused."""

from __future__ import annotations

import contextlib
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


@pytest.mark.sweep
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


@pytest.mark.sweep
@pytest.mark.parametrize("suffix", [".stl", ".step"])
@pytest.mark.sweep_cases(".step")
def test_loads_no_more_than_a_solid_needs(suffix: str, tmp_path: Path) -> None:
    """One format, and of a CAD solid neither scipy, whose splines it could take, nor any."""
    others = ["glb", "threemf", "vtk", *(["stl"] if suffix == ".step" else [])]
    program = (
        "import sys; from gearmesh.app.cli import main\n"
        f"main({[*SPUR, '-o', str(tmp_path / f'g{suffix}')]!r})\n"
        "heavy = ['scipy', 'matplotlib', 'pyvista', 'rich', 'trimesh', 'gearmesh.contact', 'gearmesh.loaded', 'gearmesh.view']\n"
        f"heavy += [f'gearmesh.io.meshes.{{name}}' for name in {others!r}]\n"
        "print([name for name in heavy if name in sys.modules], file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stderr.splitlines()[-1] == "[]"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--set", "bore=5"], "bore: unknown key; did you mean gear.bore?"),
        (["--set", "pinion.teeth=25"], "pinion.teeth: there is only one member, gear; did you mean gear.teeth?"),
        (["--rack", "--set", "height=5"], "height: unknown key; did you mean rack.height?"),
        (["--rack", "--set", "gear.teeth=4"], "gear.teeth: there is only one member, rack; did you mean rack.teeth?"),
        (["--curves", "arcs"], "--curves = arcs: needs -o with the file of a mesh, a CAD solid or a section"),
        (["--offset", "1um"], "--offset = 1um: needs -o with the file of a mesh, a CAD solid or a section"),
    ],
)
def test_keys_of_the_only_member_are_suggested(
    options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*SPUR, *options]) == 2
    assert capsys.readouterr().err == f"gearmesh: error: {message}\n"


def test_the_example_of_its_help_works(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Figures of a public question: P 16, z 20, 14.5 deg, dedendum 1.157: d_a 34.925, d_f 28.0765 mm."""
    with contextlib.suppress(SystemExit):
        main(["gear", "--help"])
    assert "pinion" not in capsys.readouterr().out
    public = ["gear", "--diametral-pitch", "16", "--teeth", "20", "--pressure-angle", "14.5"]
    assert main([*public, "--set", "gear.dedendum=1.157"]) == 0
    printed = capsys.readouterr().out
    assert "34.925" in printed
    assert "28.0765" in printed
    assert main([*public, "-o", str(tmp_path / "g.toml"), "--set", "gear.tip_chamfer=0.2"]) == 0


def test_sections_take_curves_and_offset_as_solid_does(tmp_path: Path) -> None:
    design, own, other = (tmp_path / name for name in ("g.toml", "a.dxf", "b.dxf"))
    given, few = ["--curves", "polyline", "--offset", "-0.05mm", "--tol", "20um"], ["--module", "1", "--teeth", "12"]
    assert main(["gear", *few, "-o", str(design)]) == 0
    assert main(["gear", *few, *given, "-o", str(own)]) == 0
    assert main(["solid", str(design), "--member", "gear", *given, "-o", str(other)]) == 0
    assert own.read_bytes() == other.read_bytes()
