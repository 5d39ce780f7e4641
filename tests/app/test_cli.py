"""The command line: exit statuses, one-line errors, and the shape of what it prints and writes."""

from __future__ import annotations

import csv
import io
import json
import math
import os
import re
import signal
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Sequence
from contextlib import nullcontext, redirect_stdout, suppress
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.command_line import refused, run
from oracles.examples import examples
from oracles.places import ROOT, SAMPLES

import gearmesh as gm
from gearmesh import (
    Check,
    Compensation,
    Contact,
    NoSolutionError,
    OutputError,
    Report,
    RollTest,
    Solid,
    Summary,
    load,
    system,
)
from gearmesh.answers.bodies.solid import SolidFigures
from gearmesh.answers.check import RollRow
from gearmesh.answers.contact.figures import PathSummary
from gearmesh.answers.tables import Listing
from gearmesh.app import cli
from gearmesh.app.terminal import show
from gearmesh.contact.path import ContactPath
from gearmesh.design import files
from gearmesh.errors import Status
from gearmesh.io import atomic
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.kinds import Setting
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.progress import Progress
from gearmesh.systems.system import kinds

INTERSECTED, CIRCULAR_ARC = str(SAMPLES / "beveloid_intersected.toml"), str(SAMPLES / "circular_arc.toml")


def contact_path(kinds: Sequence[str]) -> ContactPath:
    """A path whose numbers tell where they came from: position i has values near i."""
    i = np.arange(len(kinds), dtype=float)
    kind = np.array(kinds)
    none, point = kind == "none", kind == "point"
    vector = np.where(none[:, None], np.nan, i[:, None] + np.array([0.1, 0.2, 0.3]))
    line = np.array([[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]])
    values = {
        "phi1": np.radians(i),
        "phi2": np.where(none, np.nan, np.radians(100 + i)),
        "te": np.where(none, np.nan, i * ARCSEC),
        "kind": kind,
        "edge": np.where(kind == "edge", "pinion_tip", ""),
        "status": np.where(none, int(Status.NO_CONTACT), int(Status.CONVERGED)),
        "residual": np.where(none, np.nan, 1e-13),
        **dict.fromkeys(("point", "normal", "point1", "point2"), vector),
        **dict.fromkeys(("params1", "params2"), vector[:, :2]),
        **dict.fromkeys(("semi_major", "semi_minor"), np.where(point, 2.0, np.nan)),
        "angle": np.where(point, np.radians(30), np.nan),
        **dict.fromkeys(("major", "minor"), np.where(point[:, None], vector, np.nan)),
        "lines": tuple(line if k == "line" else None for k in kinds),
        "part": np.zeros(len(kinds), dtype=np.intp),
        "seconds": 0.5,
    }
    # fields that the command line does not read may come and go
    known = {name: values.get(name) for name in ContactPath.__dataclass_fields__}
    return ContactPath(**known)  # type: ignore[arg-type]


def tetrahedron(name: str) -> TriangleMesh:
    """The smallest solid."""
    triangles = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    normals = np.array([[0, 0, -1.0], [0, -1, 0], [1, 1, 1] / np.sqrt(3), [-1, 0, 0]])
    return TriangleMesh(np.eye(4, 3, -1), triangles, np.zeros(4, dtype=np.int32), ("root",), normals, name)


FIGURES = SolidFigures(
    triangles=4, watertight=True, volume=1 / 6, max_deviation=3.0, sampled_deviation=2.5, tolerance=5.0, seconds=0.25
)


class Asked:
    """Questions to gears, and their answers."""

    def __init__(self) -> None:
        self.asked: dict[str, Any] = {}
        self.kinds = ["point", "line", "edge", "none"]
        self.figures = FIGURES
        self.error: Exception | None = None


class CannedGears:
    """Stands in for `gearmesh.Gears`: true members and designs, answers at once, and remembers what it was asked."""

    warnings = ("odd radius",)

    def __init__(self, told: Asked, gears: gm.Gears) -> None:
        self.told, self.design, self.members = told, gears.design, gears.members
        self.real, self.train, self.pairs, self.names = gears, gears.train, gears.pairs, gears.names

    def contact(
        self,
        *,
        torque: float | None = None,
        load_sharing: bool = False,
        pair: str = "pinion-gear",
        turns: bool = False,
        speed: float | None = None,
    ) -> Contact:
        assert pair == "pinion-gear"
        assert speed is None
        if self.told.error is not None:
            raise self.told.error
        path = contact_path(self.told.kinds)
        names = {"pinion": ("l_F", "u_F"), "gear": ("l_G", "u_G")}
        both = {"pinion": path.params1, "gear": path.params2}
        params = {m: [dict(zip(names[m], row, strict=True)) for row in both[m].tolist()] for m in names}
        te: Any = np.float64(math.nan)
        summary = Summary(PathSummary(len(self.told.kinds), 3, te, 1e-13, 0.5, 40.0))
        return Contact(self.design, self.real.pairs[0], path, params, summary, self.warnings, None)

    def solid(
        self,
        member: str,
        tolerance: float | None = None,
        *,
        teeth: int | None = None,
        sector: int | None = None,
        flank_only: str | None = None,
        space: bool = False,
        blank: bool = False,
        offset: float = 0.0,
        file: Path | None = None,
    ) -> Solid:
        assert file is not None, "its figures must be those of the file"
        assert (flank_only, space, blank, offset) == (None, False, False, 0.0)
        parts = {name: count for name, count in (("teeth", teeth), ("sector", sector)) if count is not None}
        self.told.asked = {"member": member, "tolerance": self.real.within(tolerance), **parts}
        return Solid(self.design, tetrahedron(member), self.told.figures, self.warnings, open=teeth is not None)

    def check(self, tolerance: float | None = None) -> Check:
        self.told.asked = {"tolerance": tolerance}
        none: Any = np.float64(math.nan)
        rolled = [RollRow(1.0, "flanks", 0.25, None, none, None, None, None)]
        solids = {
            name: Solid(self.design, tetrahedron(name), found)
            for name, found in (("pinion", self.told.figures), ("gear", FIGURES))
        }
        return Check(self.design, solids, RollTest(rolled, ()), self.warnings)

    def picture(self, view: str, member: str | None, *, pair: str, **how: Any) -> Any:
        assert pair == "pinion-gear"
        self.told.asked = {"view": view, "member": member, **how}
        return SimpleNamespace(save=lambda path: self.told.asked.update(path=path))

    def compensate(self, refinish: str | None = None) -> Compensation:
        assert refinish is None
        return Compensation(self.design, (Setting("pinion.b", 0.12, 0.1, "inch", "theta 30"),), self.warnings)

    def run(
        self,
        folder: Path,
        tolerance: float | None,
        *,
        progress: Progress,
        timing: bool,
        page: bool,
        source: str | None,
        torque: Any,
    ) -> Report:
        assert source is None or source == Path(INTERSECTED).read_text(encoding="utf-8")
        if self.told.error is not None:
            raise self.told.error
        self.told.asked = {"folder": folder, "tolerance": tolerance, "timing": timing, "page": page, "torque": torque}
        progress(0.5, "half way")
        (folder / "pinion.stl").write_text("x")
        asked = self.told.asked
        report = Report(self.check(), self.contact(), folder, (folder / "pinion.stl",), "no pictures here")
        self.told.asked = asked
        return report


@pytest.fixture
def job(monkeypatch: pytest.MonkeyPatch) -> Asked:
    """The one seam: what the commands build gears with."""
    told, build = Asked(), gm.build
    monkeypatch.setattr(gm, "build", lambda design, **how: CannedGears(told, build(design, **how)))
    return told


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


WARNED = "gearmesh: warning: odd radius\n"

# ---------------------------------------------------------------- contact


@pytest.mark.quick
def test_tca_json(job: Asked) -> None:
    status, out, err = run("tca", INTERSECTED, "--json", "-")
    assert status == 0
    document = json.loads(out, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert document["gearmesh"] == gm.__version__
    assert document["design"] == load(INTERSECTED).resolve()
    told = {"converged": 3, "max_residual_mm": 1e-13, "shaft_angle_deg": 40.0}
    assert document["summary"] == {"positions": 4, "te_peak_to_peak_arcsec": None, **told}
    assert document["timing"] == {"summary": {"seconds": 0.5}}
    point, line, edge, none = document["positions"]
    assert point["phi2_deg"] == pytest.approx(100)
    assert edge["te_arcsec"] == pytest.approx(2)
    assert [p["contact"] for p in document["positions"]] == ["point", "line", "edge", "none"]
    assert [p["edge"] for p in document["positions"]] == [None, None, "pinion_tip", None]
    assert [p["status"] for p in document["positions"]] == ["converged"] * 3 + ["no_contact"]
    assert point["pinion"] == {"params": {"l_F": 0.1, "u_F": 0.2}, "point_mm": [0.1, 0.2, 0.3]}
    assert line["gear"]["params"] == {"l_G": 1.1, "u_G": 1.2}
    assert point["ellipse"]["angle_deg"] == pytest.approx(30)
    assert point["ellipse"].keys() == {"a_mm", "b_mm", "angle_deg", "major_axis"}
    assert [p["ellipse"] is None for p in document["positions"]] == [False, True, True, True]
    assert line["line_mm"] == [[0, 1, 2], [3, 4, 5]]
    assert point["line_mm"] is None
    assert none["phi1_deg"] == pytest.approx(3)
    assert none["phi2_deg"] is none["te_arcsec"] is none["point_mm"] is none["normal"] is None
    assert none["pinion"] == {"params": {"l_F": None, "u_F": None}, "point_mm": None}
    # nothing but the document on standard output; warnings apart, each once
    assert err.splitlines()[0] + "\n" == WARNED
    assert err.splitlines()[1].startswith(
        "gearmesh: warning: no contact at 1 of 4 positions: phi1 = 3 to 3 deg, no_con"
    )


@pytest.mark.quick
def test_tca_csv(job: Asked, here: Path) -> None:
    assert run("tca", INTERSECTED, "--csv", "contact.csv", "--json", "contact.json")[0] == 0
    rows = list(csv.DictReader((here / "contact.csv").open()))
    positions = json.loads((here / "contact.json").read_text())["positions"]
    assert len(rows) == len(positions) == 4
    for row, position in zip(rows, positions, strict=True):
        assert float(row["phi1_deg"]) == position["phi1_deg"]
        assert row["contact"] == position["contact"]
    assert [float(rows[1][f"point_{axis}_mm"]) for axis in "xyz"] == positions[1]["point_mm"]
    assert [float(rows[1][f"gear_{name}"]) for name in ("l_G", "u_G")] == [1.1, 1.2]
    assert float(rows[0]["ellipse_a_mm"]) == 2
    assert rows[3]["te_arcsec"] == rows[3]["pinion_l_F"] == rows[3]["point_x_mm"] == rows[3]["ellipse_a_mm"] == ""


@pytest.mark.quick
def test_tca_without_any_contact_exits_with_3(job: Asked, here: Path) -> None:
    job.kinds = ["none", "none"]
    (here / "old.json").write_text("old")
    message = refused("tca", INTERSECTED, "--json", "old.json", status=3)
    assert message == f"no contact at any position: phi1 = 0 to 1 deg, no_contact; {Status.NO_CONTACT.advice}"
    assert (here / "old.json").read_text() == "old"
    assert [file.name for file in here.iterdir()] == ["old.json"]


@pytest.mark.quick
def test_tca_for_people(job: Asked) -> None:
    _, out, _ = run("tca", INTERSECTED)
    lines = out.splitlines()
    assert lines[1].split()[:6] == ["phi1", "deg", "phi2", "deg", "TE", "arcsec"]
    assert [line.split()[:5] for line in lines[4:7]] == [
        ["2", "102", "2", "edge:", "pinion"],
        ["tip"],
        ["3", "-", "-", "none", "-"],
    ]


@pytest.mark.quick
def test_terminal_gets_ruled_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    terminal = io.StringIO()
    terminal.isatty = lambda: True  # type: ignore[method-assign]
    listing = Listing("Title", ("name", "mm"), [("[a]", 1.5), ("b", math.nan)])
    with redirect_stdout(terminal):
        show([listing])
    assert "─" in terminal.getvalue()
    assert "[a]" in terminal.getvalue()
    # numbers are never cut short, however narrow the window
    wide = Listing("", ("name", *"abcdefghij"), [("first", *[1234.567] * 10)])
    with redirect_stdout(terminal):
        show([wide])
    assert terminal.getvalue().count("1234.567") == 10
    pipe = io.StringIO()
    with redirect_stdout(pipe):
        show([listing])
    assert pipe.getvalue() == "Title\nname   mm\n[a]   1.5\nb       -\n"


# ---------------------------------------------------------------- solids, check, pictures, settings, run


@pytest.mark.parametrize(
    ("text", "mm"),
    [("10um", 0.01), ("10µm", 0.01), ("0.01mm", 0.01), ("0.01", 0.01), ("1e-3 mm", 0.001), ("0.0004in", 0.01016)],
)
def test_tolerance_with_units(job: Asked, here: Path, text: str, mm: float) -> None:
    assert run("solid", INTERSECTED, "--member", "gear", "-o", "gear.stl", "--tol", text)[0] == 0
    assert job.asked == {"member": "gear", "tolerance": pytest.approx(mm, rel=1e-14)}
    assert (here / "gear.stl").stat().st_size == 84 + 4 * 50


@pytest.mark.quick
def test_tolerance_of_the_design(job: Asked, here: Path) -> None:
    run("solid", CIRCULAR_ARC, "--member", "pinion", "-o", "p.ply", "--set", "mesh.tolerance=0.001", "--teeth", "12")
    assert job.asked == {"member": "pinion", "tolerance": pytest.approx(0.0254), "teeth": 12}
    run("solid", CIRCULAR_ARC, "--member", "pinion", "-o", "p.ply", "--sector", "5")
    assert job.asked["sector"] == 5


def test_solid_prints_its_figures(job: Asked, here: Path) -> None:
    status, out, err = run("solid", INTERSECTED, "--member", "pinion", "-o", "p.stl")
    found = dict(line.split() for line in out.splitlines())
    assert (status, err) == (0, WARNED)
    assert found.keys() == FIGURES.row.keys()
    assert (found["watertight"], found["triangles"], float(found["volume_mm3"])) == ("true", "4", pytest.approx(1 / 6))
    job.figures = replace(job.figures, watertight=False, max_deviation=6.0)
    warnings = run("solid", INTERSECTED, "--member", "pinion", "-o", "p.stl")[2]
    assert "the mesh of the pinion is not watertight" in warnings
    assert "6 um from the exact surface, more than the tolerance of 5 um" in warnings
    # a few teeth are open by nature
    assert "watertight" not in run("solid", INTERSECTED, "--member", "pinion", "-o", "p.stl", "--teeth", "3")[2]


def test_check(job: Asked) -> None:
    document = json.loads(run("check", INTERSECTED, "--json", "-")[1])
    assert document["mesh"]["gear"] | document["timing"]["mesh"]["gear"] == FIGURES.row
    assert document["timing"]["mesh"]["gear"] == {"seconds": 0.25}
    assert "timing" not in json.loads(run("check", INTERSECTED, "--json", "-", "--no-timing")[1])
    (row,) = document["roll"]
    assert {key: value for key, value in row.items() if value is not None} == {
        "phi1_deg": 1.0,
        "rolled": "flanks",
        "te_difference_arcsec": 0.25,
    }
    assert row["a_ratio"] is None
    assert job.asked == {"tolerance": None}
    status, out, err = run("check", INTERSECTED, "--tol", "1um")
    assert job.asked == {"tolerance": pytest.approx(1e-3)}
    assert (status, err) == (0, WARNED)
    assert "te_difference_arcsec" in out


@pytest.mark.quick
def test_render(job: Asked, here: Path) -> None:
    assert run("render", INTERSECTED, "-o", "a.png", "--size", "320x200")[0] == 0
    how = {"phi1": None, "size": (320, 200), "dpi": 150, "note": "", "look": "plain"}
    assert job.asked == {"view": "contact", "member": None, "path": Path("a.png"), **how}
    varied = ("--set", "contact.delta=5um", "--dpi", "90")
    assert run("render", INTERSECTED, "-o", "a.svg", "--view", "flank", *varied)[0] == 0
    how = {"phi1": None, "size": None, "dpi": 90, "note": "contact.delta=5um", "look": "plain"}
    assert job.asked == {"view": "flank", "member": None, "path": Path("a.svg"), **how}


@pytest.mark.quick
def test_settings_writes_a_design(job: Asked, here: Path) -> None:
    status, out, _ = run("settings", CIRCULAR_ARC, "-o", "new.toml", "--set", "pinion.teeth=13")
    assert status == 0
    assert "pinion.b" in out
    new = load("new.toml")
    assert (new.pinion.teeth, new.resolve()["pinion"]["b"]) == (13, 0.1)


def test_settings_sheet_of_a_spiral_bevel_pair(here: Path) -> None:
    sample = str(SAMPLES / "spiral_bevel_basic.toml")
    status, out, _ = run("settings", sample, "-o", "new.toml")
    assert status == 0
    for line in ("Blank", "root angle", "Cutters and machine settings", "ratio of roll"):
        assert line in out
    assert load("new.toml").resolve()["gear"]["cutter"]["tip_radius"] == pytest.approx(76.2)
    assert run("describe", sample)[1] == out
    status, out, _ = run("settings", sample, "--compensate", "--set", "assembly.dV=0.05")
    assert status == 0
    assert "pinion.convex.machining_offset" in out


@pytest.mark.quick
def test_run(job: Asked, here: Path) -> None:
    status, out, err = run("run", INTERSECTED, "--tol", "20um")
    folder = Path("out") / "beveloid_intersected"
    assert job.asked == {
        "folder": folder,
        "tolerance": pytest.approx(0.02),
        "timing": True,
        "page": True,
        "torque": None,
    }
    assert status == 0
    assert str(folder / "pinion.stl") in out
    assert err == "gearmesh: half way\n" + WARNED + "gearmesh: warning: no pictures here\n"


@pytest.mark.sweep
@pytest.mark.quick
def test_run_ends_as_the_check_of_the_same_design(job: Asked, here: Path) -> None:
    """It ended with 0 where the check failed, unless the gears were jammed."""
    for watertight, status in ((True, 0), (False, NoSolutionError.exit_status)):
        job.figures = replace(job.figures, watertight=watertight)
        assert [run(command, INTERSECTED)[0] for command in ("check", "run")] == [status, status]
        assert (here / "out" / "beveloid_intersected" / "pinion.stl").exists()


@pytest.mark.quick
def test_run_that_fails_leaves_no_empty_folder(job: Asked, here: Path) -> None:
    job.error = NoSolutionError("nowhere to be found")
    (here / "mine").mkdir()
    assert refused("run", INTERSECTED, "-o", "new", status=3) == "nowhere to be found"
    refused("run", INTERSECTED, "-o", "mine", status=3)
    assert [entry.name for entry in here.iterdir()] == ["mine"]


# ---------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("", "Missing command (see gearmesh --help)"),
        ("tac", "No such command 'tac'; did you mean tca?"),
        ("step SAMPLE -o a.step", "No such command 'step'; did you mean solid?"),
        ("qqq", "No such command 'qqq' (see gearmesh --help)"),
        ("absent.toml", "absent.toml is a design file, no command: gearmesh run absent.toml does the main job"),
        ("tca", "Missing argument 'DESIGN' (see gearmesh tca --help)"),
        ("tca x --jsn -", "No such option: --jsn"),
        ("tca absent.toml", "absent.toml: cannot be read: No such file or directory"),
        # before what to make of it, which is missing, too
        ("solid absent.toml", "absent.toml: cannot be read: No such file or directory"),
        ("convert absent.rexs", "absent.rexs: cannot be read: No such file or directory"),
        ("tca .", ".: is a folder, not a design file"),
        ("tca SAMPLE --json - --csv -", "--csv = -: --json already uses standard output"),
        ("tca SAMPLE --json nowhere/a.json", "cannot write nowhere/a.json: the folder nowhere does not exist"),
        ("tca SAMPLE --csv .", "cannot write .: it is a folder"),
        ("tca SAMPLE --torque 0", "--torque = 0: must be a finite number of Nm above 0"),
        ("tca SAMPLE --set pinion.teeth=0", "pinion.teeth = 0: must be a whole number from 1 to 10000"),
        ("tca SAMPLE --set pinion.teeth", '--set "pinion.teeth": must look like dotted.key=value'),
        ("solid SAMPLE -o a.stl", "Missing option '--member'"),
        ("solid SAMPLE --member hub -o a.stl", "--member = hub: must be one of pinion, gear, both, all"),
        ("solid SAMPLE --member gear -o a.xyz", "cannot write a.xyz: its suffix must be one of .glb, .obj, .ply, .stl"),
        ("solid SAMPLE --member gear -o a.stl --tol 0", "--tol = 0: must be a length as 10um, 0.01mm or 0.0004in"),
        ("solid SAMPLE --member gear -o a.stl --tol nan", "--tol = nan: must be a length"),
        ("solid SAMPLE --member gear -o a.stl --tol 1km", "--tol = 1km: must be a length"),
        ("solid SAMPLE --member gear -o a.stl --tol 1e", "--tol = 1e: must be a length"),
        ("solid SAMPLE --member gear -o a.stl --teeth 37", "--teeth = 37: must be a whole number from 1 to 36"),
        ("solid SAMPLE --member gear -o a.stl --sector 2 --teeth 2", "--teeth = 2: must be left out with --sector"),
        ("solid SAMPLE --member both -o a.3mf --sector 2", "--sector = 2: must be left out for --member = both"),
        ("solid SAMPLE --member gear -o a.svg --sector 2", "--sector = 2: must be left out for .svg"),
        ("solid SAMPLE --member gear -o a.stl --teeth x", "--teeth = x: must be a whole number"),
        ("render SAMPLE -o a.jpg", "cannot write a.jpg: its suffix must be .png"),
        ("render SAMPLE", "--output: name a file for the picture, or for an animation with --animate"),
        ("render SAMPLE --animate a.avi", "cannot write a.avi: its suffix must be .gif or .mp4"),
        (
            "render SAMPLE --animate a.gif --view te",
            "--animate = a.gif: is not for the view te; it is for section, pair,",
        ),
        ("render SAMPLE -o a.jpg --view flank", "cannot write a.jpg: its suffix must be .png or .svg or .pdf"),
        ("render SAMPLE -o a.png --size 800", "--size = 800: must be WIDTHxHEIGHT in pixels, each from 16 to 16384"),
        ("render SAMPLE -o a.png --size 0x0", "--size = 0x0: must be WIDTHxHEIGHT"),
        ("settings SAMPLE -o a.json", "cannot write a.json: its suffix must be .toml"),
        ("run SAMPLE -o file/x", "cannot make the folder file/x: Not a directory"),
        ("run SAMPLE -o file", "cannot make the folder file: File exists"),
        (
            "describe circular-arc",
            'kind = "circular-arc": must be one of "cylindrical", "planetary", "rack", "beveloid", "circular_arc", ',
        ),
    ],
)
def test_refused(job: Asked, here: Path, arguments: str, message: str) -> None:
    (here / "file").write_text("")
    assert refused(*arguments.replace("SAMPLE", INTERSECTED).split()).startswith(message)
    assert [entry.name for entry in here.iterdir()] == ["file"]
    assert not job.asked


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (OutputError("first line\nsecond \x1b[31mline"), "first line second ?[31mline"),
        (OSError(28, "No space left on device", "pinion.stl"), "pinion.stl: No space left on device"),
        (MemoryError(), "out of memory: choose a larger --tol"),
    ],
)
def test_failures_are_one_line(job: Asked, error: Exception, message: str) -> None:
    job.error = error
    assert refused("tca", INTERSECTED).startswith(message)


# Values that no key of the given unit takes.
WRONG: dict[str, st.SearchStrategy[Any]] = {
    "number": st.sampled_from(
        [True, "", "12", "nan", math.nan, math.inf, -math.inf, -1e9, 1e9, 10**400, [1], {"x": 1}]
    ),
    "choice": st.sampled_from([True, "", "MM", "up", math.nan, 3, [], ["mm"], {"x": 1}]),
    "flag": st.sampled_from(["", "true", 0, 1, 1.5, math.nan, [True]]),
    "text": st.sampled_from([1, True, ["a"], "two\nlines", "x" * 81]),
    "file": st.sampled_from([1, True, ["a"], "", "two\nlines"]),
}


def full(file: str) -> dict[str, Any]:
    """A sample with every optional table in it, so that one wrong value is the only thing wrong."""
    data = files.read(file)
    for member in ("pinion", "gear"):
        data[member] |= {"keyway": {"width": 1, "depth": 1}, "hub": {"diameter": 90, "length": 9}}
        data[member] |= {"web": {"thickness": 1}, "holes": {"count": 2}, "toe_hub": {"diameter": 90, "length": 9}}
        data[member] |= {"bolts": {"count": 2, "diameter": 1}, "spokes": {"count": 3, "width": 1}}
        steps = {"diameters": [9], "lengths": [1]}
        data[member] |= {name: dict(steps) for name in ("heel_shaft", "toe_shaft", "heel_bore", "toe_bore")}
    return data


@pytest.fixture(scope="module")
def scratch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("designs") / "design.json"


@examples(100)
@given(st.sampled_from([INTERSECTED, CIRCULAR_ARC]), st.data())
def test_one_wrong_value_is_named(scratch: Path, sample: str, data: st.DataObject) -> None:
    design = full(sample)
    lines = [line for line in system(design["kind"]).design.key_lines() if line.key != "kind"]
    line = data.draw(st.sampled_from(lines))
    wrong = WRONG.get(line.unit, WRONG["number"])
    # a list of one number is right where lists are
    value = data.draw(wrong.filter(lambda drawn: not (line.range.startswith("list") and isinstance(drawn, list))))
    *tables, last = line.key.split(".")
    table = design
    for name in tables:
        table = table.setdefault(name, {})
    if tables and "_relief" in tables[-1]:
        table |= {"amount": 0.01, "length": 1} if "end" in tables[-1] else {"amount": 0.01, "start_diameter": 1}
    if tables and tables[-1] == "d_bore":
        table |= {"height": 1}
    table[last] = value
    scratch.write_text(json.dumps(design))
    message = refused("tca", scratch)
    assert message.startswith(f"{line.key} = ")
    assert ": must be " in message


@examples(50)
@given(st.binary(max_size=60))
def test_any_file_is_refused_in_one_line(scratch: Path, content: bytes) -> None:
    for suffix in (".toml", ".json"):
        file = scratch.with_suffix(suffix)
        file.write_bytes(content)
        assert refused("tca", file).startswith((f"{file}: ", "kind: missing", "kind = "))


# ---------------------------------------------------------------- describe, start-up


def rows(lines: Sequence[str]) -> dict[str, str]:
    """Rows of a table by their first words; a row goes on in the lines below that begin with a blank."""
    found: dict[str, str] = {}
    for line in filter(None, lines):
        if line[0] != " ":
            key = line.split()[0]
        found[key] = f"{found.get(key, '')} {line}"
    return {key: " ".join(text.split()) for key, text in found.items()}


@pytest.mark.quick
def test_describe() -> None:
    status, out, _ = run("describe")
    assert status == 0
    # what goes on below a kind is indented
    assert [line.split()[0] for line in out.splitlines()[1:] if line[0] != " "] == list(kinds())
    for kind, sample, fewest in (("beveloid", INTERSECTED, "1"), ("circular_arc", CIRCULAR_ARC, "3")):
        lines = rows(run("describe", kind, "--all")[1].splitlines()[1:])
        resolved = full(sample)
        stated = {
            f"{a}.{b}" if isinstance(x, dict) else a
            for a, x in resolved.items()
            for b in (x if isinstance(x, dict) else [""])
        }
        tables = {
            f"{member}.{table}"
            for member in ("pinion", "gear")
            for table in ("keyway", "hub", "web", "holes", "toe_hub")
        }
        assert stated - tables - {"contact.phi1"} <= lines.keys()
        assert f"pinion.teeth (count, {fewest} .. 10000; required) number of" in lines["pinion.teeth"]
    assert "[LT85] (13)" in lines["gear.a"]
    (rule,) = (line.default for line in system("circular_arc").design.key_lines() if line.key == "gear.a")
    assert rule == "a_F + (rho_P - rho_F) cos(pressure_angle)"


def test_describe_has_a_line_for_a_key_where_there_is_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "1000")
    groups = system("hypoid").design.key_groups()
    printed = run("describe", "hypoid", "--all")[1].splitlines()
    # titles and blank lines of groups
    assert len(printed) == sum(map(len, groups.values())) + 2 * len(groups) - 1
    # in a pipe there always is
    monkeypatch.delenv("COLUMNS")
    assert run("describe", "hypoid", "--all")[1].splitlines() == printed
    monkeypatch.setenv("COLUMNS", "60")
    narrow = run("describe", "hypoid", "--all")[1].splitlines()
    assert max(map(len, narrow)) <= 60
    assert " ".join(" ".join(narrow).split()) == " ".join(" ".join(printed).split())


@pytest.mark.quick
def test_describe_says_the_same_as_json(tmp_path: Path) -> None:
    status, text, _ = run("describe", "beveloid", "--json", "-")
    assert status == 0
    document = json.loads(text)
    printed = rows(run("describe", "beveloid", "--all", "--json", tmp_path / "keys.json")[1].splitlines())
    assert json.loads((tmp_path / "keys.json").read_text()) == document
    lines = [*document["keys"], *(line for table in document["tables"].values() for line in table)]
    assert {line["key"] for line in lines} <= printed.keys()
    (teeth,) = (line for line in document["keys"] if line["key"] == "pinion.teeth")
    assert (teeth["unit"], teeth["range"], teeth["default"]) == ("count", "1 .. 10000", "required")
    assert set(json.loads(run("describe", "--json", "-")[1])["kinds"]) == set(kinds())


def merged(key: str) -> str:
    """A key without the name of its member."""
    return re.sub(r"^(pinion|gear|sun|planet|ring|rack|worm|wheel)\.", "", key)


@pytest.mark.quick
def test_the_short_list_has_the_keys_that_samples_set() -> None:
    """Keys that half of the samples set that could; at most 30 of the 167 to 587 keys of a kind."""
    could, do = Counter[str](), Counter[str]()
    shown, by_kind = dict[str, set[str]](), dict[str, set[str]]()
    for sample in SAMPLES.glob("*.toml"):
        design = gm.load(sample, complete=False)
        usual = type(design).usual_keys()
        could.update({merged(line.key) for line in type(design).key_lines()})
        own = {merged(key) for key, _ in design.own()}
        do.update(own)
        by_kind.setdefault(design.kind, set()).update(own)
        shown[design.kind] = {merged(key) for key in usual}
        assert len(usual) <= 30
    assert shown.keys() == set(kinds())
    often = {key for key, count in do.items() if count >= 0.5 * could[key] and could[key] >= 4}
    assert len(often) > 15
    for kind, keys in shown.items():
        required = {merged(line.key) for line in system(kind).design.key_lines() if line.default == "required"}
        assert (often & by_kind[kind]) | required <= keys


@pytest.mark.quick
@pytest.mark.parametrize("kind", kinds())
@pytest.mark.sweep_cases("hypoid")
def test_describe_is_short_and_says_how_much_it_leaves_out(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # pytest-xdist sets it for its workers
    monkeypatch.delenv("COLUMNS", raising=False)
    design = system(kind).design
    usual, every = design.usual_keys(), [line.key for line in design.key_lines()]
    status, out, _ = run("describe", kind)
    listed, _, rest = out.partition("\n\n")
    assert status == 0
    assert [line.split()[0] for line in listed.splitlines()[1:]] == list(usual)
    assert rest.startswith(f"{len(every) - len(usual)} more keys, ")
    assert f"gearmesh describe {kind} --all" in rest
    # a file of these keys is a design
    text = gm.new(kind, short=True)
    assert f"# {len(set(every) - {'gearmesh', *usual})} more keys: gearmesh new {kind} --all" in text
    assert run("new", kind)[1] == text
    assert run("new", kind, "--all")[1] == gm.new(kind)
    assert gm.parse(tomllib.loads(text)) == gm.parse(tomllib.loads(gm.new(kind)))
    assert len(re.findall(r"^(?:# )?\w+ = ", text, re.MULTILINE)) == len({"gearmesh", *usual})


@pytest.mark.quick
def test_describe_shows_one_table(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    status, out, _ = run("describe", "cylindrical", "pinion.keyway")
    assert (status, out.splitlines()[0]) == (0, 'kind = "cylindrical"')
    assert [line.split()[0] for line in out.splitlines()[1:]] == [
        f"pinion.keyway.{key}" for key in ("standard", "width", "depth")
    ]
    assert run("describe", "cylindrical", "pinion.keyway.width")[1].split()[3:4] == ["pinion.keyway.width"]
    # tables in several places: by their place, and by their title
    (count,) = (line for line in run("describe", "rack", "pinion.spokes")[1].splitlines() if ".count " in line)
    assert count.startswith("pinion.spokes.count ")
    assert run("describe", "rack", "spokes")[1].splitlines()[1].startswith("count ")
    document = json.loads(run("describe", "hypoid", "pinion.hub", "--json", "-")[1])
    assert (document["table"], [line["key"] for line in document["keys"]]) == (
        "pinion.hub",
        ["pinion.hub.diameter", "pinion.hub.length"],
    )
    wrong = refused("describe", "hypoid", "pinion.keywy")
    assert wrong == "TABLE = pinion.keywy: no table or key of hypoid; did you mean pinion.keyway?"
    assert refused("describe", "hypoid", "weave") == (
        "TABLE = weave: no table or key of hypoid; gearmesh describe hypoid lists its tables"
    )
    assert refused("describe", INTERSECTED, "pinion") == "TABLE: needs a kind"
    assert refused("describe", "--all") == "--all: needs a kind"
    assert refused("describe", "hypoid", "--all", "--schema") == "--all: must be left out with --schema"
    assert refused("describe", "hypoid", "pinion", "--all").startswith("--all: must be left out with a table")


@pytest.mark.sweep
def test_help_loads_no_mathematics_and_describe_draws_nothing() -> None:
    program = (
        "import sys\n"
        "from gearmesh.app.cli import main\n"
        "assert [main(a) for a in (['--help'], ['--version'], ['solid', '--help'])] == [0] * 3\n"
        "print(sorted({'numpy', 'scipy', 'pyvista', 'trimesh', 'rich'} & sys.modules.keys()), file=sys.stderr)\n"
        "assert [main(a) for a in (['describe'], ['describe', 'beveloid'])] == [0] * 2\n"
        "print(sorted({'pyvista', 'trimesh', 'rich', 'meshio'} & sys.modules.keys()), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stderr.splitlines() == ["[]", "[]"]
    assert f"gearmesh {gm.__version__}" in done.stdout
    assert "render" in done.stdout


@pytest.mark.quick
def test_stopped_while_it_is_being_loaded_is_one_line() -> None:
    """Ctrl-C when the library of the command line is looked for."""
    program = (
        "import runpy, sys\n"
        "class Stop:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name == 'typer':\n"
        "            raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Stop())\n"
        "runpy.run_module('gearmesh', run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "gearmesh: error: stopped: no file was written\n"


@pytest.mark.quick
def test_the_end_of_a_process_does_not_search_for_unreachable_objects() -> None:
    # what is registered before the program is called after what the program registers
    program = (
        "import atexit, gc, runpy, sys\n"
        "atexit.register(lambda: print('kept', gc.get_freeze_count() > 1000, len(gc.get_objects())))\n"
        "sys.argv = ['gearmesh', '--version']\n"
        "runpy.run_module('gearmesh', run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    words = done.stdout.splitlines()[-1].split()
    assert words[:2] == ["kept", "True"]
    assert int(words[2]) < 1000


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_full_standard_output_is_one_line() -> None:
    with open("/dev/full", "w") as full_device:
        done = subprocess.run(
            [sys.executable, "-m", "gearmesh", "describe"],
            stdout=full_device,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            env={**os.environ, "PYTHONWARNINGS": "default"},
        )
    assert (done.returncode, done.stderr) == (2, f"gearmesh: error: standard output: {os.strerror(28)}\n")


# ---------------------------------------------------------------- true gears


@pytest.mark.quick
def test_tca_of_the_first_sample() -> None:
    """[LT02] Table 2, case 1."""
    status, out, err = run("tca", INTERSECTED, "--json", "-")
    assert (status, err) == (0, "gearmesh: tooth contact\n")
    rows = [
        (p["phi1_deg"], p["phi2_deg"], *p["pinion"]["params"].values(), *p["gear"]["params"].values(), p["te_arcsec"])
        for p in json.loads(out)["positions"]
    ]
    table = [(6, 189, 8.813, 0, 1.829, 0, 0), (3, 187, 7.738, 0, 2.903, 0, 0), (0, 185, 6.664, 0, 3.978, 0, 0)]
    np.testing.assert_allclose(rows[:3], table, atol=6e-4)


@pytest.mark.quick
def test_solid_of_the_first_sample(here: Path) -> None:
    status, out, err = run("solid", INTERSECTED, "--member", "pinion", "-o", "p.stl", "--tol", "50um")
    assert (status, err) == (0, "gearmesh: solid of the pinion\n")
    found = dict(line.split() for line in out.splitlines())
    assert (found["watertight"], float(found["tolerance_um"])) == ("true", 50)
    assert (here / "p.stl").stat().st_size == 84 + 50 * int(found["triangles"])


@pytest.mark.parametrize("aborts", [True, False])
def test_interrupted_commands_say_what_is_kept(aborts: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The command line may end by itself with the status of an interrupted program, or by the exception."""
    monkeypatch.setattr(atomic, "_written", [])

    def stopped_after(*files: str) -> SimpleNamespace:
        def main(**_: object) -> int:
            for name in files:
                atomic.whole_text(tmp_path / name, "whole")
            with (
                suppress(KeyboardInterrupt) if not aborts else nullcontext(),
                atomic.whole_file(tmp_path / "half") as half,
            ):
                half.write_bytes(b"half of it")
                raise KeyboardInterrupt
            return cli.INTERRUPTED_STATUS

        return SimpleNamespace(main=main)

    monkeypatch.setattr(cli, "_group", lambda names: stopped_after())
    assert refused("tca", status=130) == "stopped: no file was written"
    monkeypatch.setattr(cli, "_group", lambda names: stopped_after("a.csv", "b.stl"))
    assert refused("tca", status=130) == f"stopped: kept in {tmp_path}, each of them whole: a.csv, b.stl"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "b.stl"]
    # as writers of several files name their own
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    monkeypatch.setattr(atomic, "_written", [])
    monkeypatch.setattr(cli, "_group", lambda names: stopped_after("out/c.vtp"))
    atomic.whole_text("out/first.json", "whole")
    assert refused("tca", status=130) == "stopped: kept in out, each of them whole: first.json, c.vtp"


#: work of a command in which Ctrl-C is pressed: it prints how far it came
STOPPED_IN = {
    # Python drops what is raised there, and prints it
    "a finaliser": """
class Held:
    def __del__(self):
        press()
held = Held()
del held
for turn in range(2000):
    time.sleep(0.001)
print('went on')
""",
    # as libraries do that clear exceptions
    "a library": """
try:
    press()
except BaseException:
    pass
print('went on')
""",
    # as modules in C do that are stopped while they load
    "a module": """
from gearmesh import OutputError
try:
    press()
except KeyboardInterrupt:
    raise OutputError(reason='STEP needs OpenCASCADE') from None
""",
}


@pytest.mark.quick
def test_stop_within_executed_text_gives_the_exit_status_of_a_stop(tmp_path: Path) -> None:
    """Stop by Ctrl-C while `exec` runs text, as imports of dataclasses do. Untreated, `python -m` would print the message and
    then end by the signal."""
    (tmp_path / "stopped.py").write_text(
        "import signal, sys\n"
        "from gearmesh import __main__\n"
        "from gearmesh.app import cli\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "cli.import_module = lambda name: exec('raise KeyboardInterrupt')\n"
        "sys.argv = ['gearmesh', 'tca']\n"
        "sys.exit(__main__.main())\n"
    )
    command, environment = [sys.executable, "-m", "stopped"], {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "gearmesh: error: stopped: no file was written\n")


@pytest.mark.quick
@pytest.mark.parametrize(("place", "goes_on"), [("a finaliser", ""), ("a library", "went on\n"), ("a module", "")])
def test_a_stop_that_is_dropped_is_none_the_less_a_stop(place: str, goes_on: str) -> None:
    """Ctrl-C where Python or a library drops it or turns it into another error: raised again at once, or known at the end."""
    program = (
        "import os, signal, sys, time\n"
        "from types import SimpleNamespace\n"
        "from gearmesh.app import cli, stopping\n"
        # at once: on a busy machine the hook of what was dropped may take longer than any delay
        "stopping.RAISE_AGAIN_S = 0.0\n"
        # of a job in the background the signal is ignored
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "def press():\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    time.sleep(0.01)\n"
        f"work = compile({STOPPED_IN[place]!r}, 'work', 'exec')\n"
        "cli._group = lambda names: SimpleNamespace(main=lambda **_: exec(work, globals()))\n"
        "sys.exit(cli.main(['tca']))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (130, goes_on)
    assert done.stderr == "gearmesh: error: stopped: no file was written\n"


#: a command that begins a file and a folder, says so, and waits for the signal as long as it takes
WRITES = """
import sys, time
from pathlib import Path
from types import SimpleNamespace
from gearmesh.app import cli
from gearmesh.io.atomic import scratch_folder, whole_file, whole_folder

def work():
    with scratch_folder() as scratch, whole_file("a.stl") as file, whole_folder("pieces", ".vtp") as folder:
        for path in (scratch / "x", file, folder / "y.vtp"):
            path.write_text("half")
        print(scratch, flush=True)
        while True:
            time.sleep(0.01)

cli._group = lambda names: SimpleNamespace(main=lambda **_: work())
sys.exit(cli.main(["tca"]))
"""


@pytest.mark.quick
@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_signals_end_a_command_as_ctrl_c_does(tmp_path: Path, number: int, status: int) -> None:
    """One line, its own exit status, and nothing is left: neither beside the target nor in the system's temporary folder."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    # of a job under nohup the signal is ignored
    begin = f"import signal; signal.signal({int(number)}, signal.SIG_DFL)\n"
    with subprocess.Popen([sys.executable, "-c", begin + WRITES], cwd=tmp_path, env=environment, **pipes) as process:
        assert process.stdout is not None
        scratch = Path(process.stdout.readline().strip())
        assert scratch.exists()
        process.send_signal(number)
        _, said = process.communicate()
    assert (process.returncode, said) == (status, "gearmesh: error: stopped: no file was written\n")
    assert list(tmp_path.iterdir()) == []
    assert not scratch.exists()


class OneFile(io.RawIOBase):
    """File that both standard streams go to, as in `gearmesh tca pair.toml > pair.txt 2>&1`."""

    def __init__(self) -> None:
        self.text = ""

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        self.text += bytes(data).decode()
        return len(data)


@pytest.mark.quick
def test_warnings_stand_behind_the_output_in_one_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """Standard output that is no terminal is kept in a buffer, standard error is not."""
    file = OneFile()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BufferedWriter(file), encoding="utf-8"))
    monkeypatch.setattr(sys, "stderr", io.TextIOWrapper(file, encoding="utf-8", write_through=True))
    keys = ("pinion.modifications.profile_crowning=0.01", "assembly.gamma_v=0.3")
    assert cli.main(["tca", str(SAMPLES / "spur.toml"), *(word for key in keys for word in ("--set", key))]) == 0
    lines = file.text.splitlines()
    warnings = [k for k, line in enumerate(lines) if line.startswith("gearmesh: warning: ")]
    assert warnings
    assert lines[: warnings[0]].count("Contact") == 1
    assert not any(line.startswith("mesh_te") for line in lines[warnings[0] :])
