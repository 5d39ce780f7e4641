"""Commands end to end: new files, samples, pictures, pairs in one file, tables in a pipe, closed output, completion."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from matplotlib.figure import Figure
from oracles.command_line import refused, run
from oracles.examples import some
from oracles.places import ROOT, SAMPLES

import gearmesh as gm
from gearmesh import io, system
from gearmesh.answers.contact import contact
from gearmesh.answers.contact.sides import side_contacts
from gearmesh.view.opengl import missing_opengl_message

needs_opengl = pytest.mark.skipif(missing_opengl_message() is not None, reason="off-screen OpenGL")
DESIGNS = sorted(path.stem for path in SAMPLES.glob("*.toml"))
CROSSED, SPUR = SAMPLES / "beveloid_crossed.toml", SAMPLES / "spur.toml"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def program(*arguments: str | Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """The program in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "gearmesh", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
    )


# ---------------------------------------------------------------- new, sample, describe


@pytest.mark.sweep_cases("spiral_bevel", "hypoid")
@pytest.mark.parametrize("kind", gm.kinds())
def test_a_new_file_of_every_kind_loads_and_builds(kind: str, here: Path) -> None:
    assert run("new", kind, "--all", "-o", "new.toml") == (0, "", "")
    assert run("new", kind, "--all")[1] == (here / "new.toml").read_text()
    design = gm.load("new.toml")
    assert design.kind == kind
    assert len(gm.build(design).members) == (5 if kind == "planetary" else 2)
    assert refused("new", kind, "-o", "new.toml") == "cannot write new.toml: it exists already"
    # every key is in it
    text = (here / "new.toml").read_text()
    for line in type(design).key_lines():
        assert f"{line.key.rpartition('.')[2]} = " in text


@pytest.mark.quick
def test_samples_are_listed_and_copied(here: Path) -> None:
    listed = [line.split()[0] for line in run("sample")[1].splitlines() if line and line[0] != " "]
    guides = sorted(path.stem for path in (SAMPLES / "guides").iterdir() if path.suffix in (".md", ".ipynb"))
    folders = (SAMPLES, SAMPLES / "trains")
    designs = sorted(path.stem for folder in folders for path in folder.iterdir() if path.suffix in (".toml", ".py"))
    assert listed == ["sample", *designs, "guide", *(name for name in guides if name != "README")]
    for name, file in (
        ("spur", "spur.toml"),
        ("fig9_beveloid_ellipse.py", "fig9_beveloid_ellipse.py"),
        ("01-spur-pair", "guides/01-spur-pair.md"),
        ("gears-in-3d", "guides/gears-in-3d.ipynb"),
    ):
        copied = here / Path(file).name
        assert run("sample", name) == (0, f"{copied.name}\n", "")
        assert copied.read_bytes() == (SAMPLES / file).read_bytes()
    assert refused("sample", "spur") == "cannot write spur.toml: it exists already"
    assert refused("sample", "spurr") == 'name = "spurr": no sample has this name; did you mean "spur"?'
    assert refused("sample", "spur", "-o", "nowhere") == "cannot write to nowhere: it is not a folder"


@pytest.mark.sweep_cases(
    "hypoid_formate",
    "hypoid_measured",
    "novikov",
    "zerol",
    "asymmetric",
    "circular_arc",
    "face_gear",
    "helical_hub",
    "spiral_bevel_geometry2",
    "straight_bevel",
)
@pytest.mark.parametrize("sample", some(DESIGNS, 10))
def test_every_sample_is_described(sample: str) -> None:
    status, out, _ = run("describe", SAMPLES / f"{sample}.toml")
    assert status == 0
    assert " nan" not in out
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    (teeth,) = (line.split() for line in out.splitlines() if line.startswith("teeth "))
    counts = [str(member.tooth.teeth) for member in gears.members.values()]
    assert teeth[-len(counts) :] == counts


# ---------------------------------------------------------------- render, solid, run


@pytest.mark.sweep_cases("gap", "pattern", "tool", "contact", "contact_lines")
@needs_opengl
@pytest.mark.parametrize(
    "options",
    [
        ("--view", "contact", "--member", "gear", "--phi1", "0"),
        ("--view", "pattern"),
        ("--view", "gap", "--phi1", "1.5"),
        ("--view", "pair", "--set", "mesh.tolerance=50um"),
        ("--view", "tool"),
        ("--view", "contact_lines"),
    ],
    ids=lambda options: options[1],
)
def test_pictures_compute_no_mesh_cycle(options: tuple[str, ...], here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearmesh.answers.contact.fit.mesh_cycle", lambda *_: pytest.fail("a mesh cycle"))
    assert run("render", CROSSED, "-o", "a.png", "--size", "64x48", *options)[0] == 0
    assert (here / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.quick
def test_what_render_refuses(here: Path) -> None:
    assert refused("render", CROSSED, "-o", "a.png", "--member", "hub") == "--member = hub: must be one of pinion, gear"
    assert refused("render", CROSSED, "-o", "a.png", "--phi1", "nan").startswith("--phi1 = nan: must be a number")
    assert refused("render", CROSSED, "-o", "a.png", "--phi1", "90", status=3).startswith("no contact at any position")
    assert "'contact', 'pattern', 'gap', 'pair'" in refused("render", CROSSED, "-o", "a.png", "--view", "inside")
    assert not list(here.iterdir())


@pytest.mark.parametrize("suffix", sorted(io.formats(several=True)))
@pytest.mark.sweep_cases(".glb", ".obj", ".vtm")
def test_both_members_go_into_one_file_as_they_mesh(suffix: str, here: Path) -> None:
    """Each under its name, the gear at its distance from the pinion."""
    file = f"pair{suffix}"
    assert run("solid", SPUR, "--member", "both", "-o", file, "--tol", "50um")[0] == 0
    scene = io.read_scene(file)
    assert list(scene) == ["pinion", "gear"]
    gears = gm.build(gm.load(SPUR))
    for name, mesh in scene.items():
        middle = 0.5 * (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0))
        assert middle == pytest.approx(gears.members[name].mount.origin, abs=0.1)


@pytest.mark.quick
def test_a_format_for_one_part_refuses_both() -> None:
    message = refused("solid", SPUR, "--member", "both", "-o", "pair.stl")
    assert message.startswith("--member = both: .stl holds one part; for both use ")


def drawn(_: Figure, file: str, **__: object) -> None:
    """Stands in for the drawing of a figure."""
    Path(file).write_bytes(b"drawn")


PICTURES = [f"{name}.png" for name in ("pinion_contact", "gear_contact", "pinion_pattern", "pinion_gap", "pair")]


@pytest.mark.sweep
def test_a_second_run_leaves_no_stale_file_and_keeps_foreign_ones(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second sample touches along lines and has no picture of a pattern; what the first run did not write stays."""
    folder = here / "out"
    folder.mkdir()
    (folder / "mine.txt").write_text("mine")
    (folder / "old.png").write_text("nobody's")
    # a renderer that draws nothing: what matters is which files there are
    monkeypatch.setattr("gearmesh.reports.run.render", lambda scene, file: file.write_bytes(b"drawn"))
    monkeypatch.setattr(Figure, "savefig", drawn)
    monkeypatch.setattr("gearmesh.answers.check.ROLL_TOLERANCE_MM", 1e-3)
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: None)
    monkeypatch.setattr(
        "gearmesh.view.pictures.all_pictures", lambda *_: dict.fromkeys(PICTURES, SimpleNamespace(title="drawn"))
    )
    assert run("run", CROSSED, "-o", "out", "--tol", "50um", "--no-report", "--set", "contact.phi1.count=3")[0] == 0
    assert (folder / "pinion_pattern.png").exists()
    first = {file.name for file in folder.iterdir()}
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "no OpenGL today")
    status, _, err = run("run", SPUR, "-o", "out", "--tol", "50um", "--no-report", "--set", "contact.phi1.count=3")
    assert status == 0
    assert err.splitlines()[-1] == "gearmesh: warning: no OpenGL today"
    # one line a stage
    assert err.splitlines()[:2] == ["gearmesh: tooth contact", "gearmesh: solid of the pinion"]
    assert {file.name for file in folder.iterdir()} == first - {*PICTURES}
    assert {"mine.txt", "old.png", "pinion.stl", "transmission_error.png"} <= first - {*PICTURES}


# ---------------------------------------------------------------- standard output


COMMANDS = {
    "describe": ["describe"],
    **{f"describe {kind}": ["describe", "--all", kind] for kind in gm.kinds()},
    "describe in short": ["describe", "cylindrical"],
    **{f"describe {name}": ["describe", SAMPLES / f"{name}.toml"] for name in ("spur", "zerol", "face_gear")},
    "sample": ["sample"],
    "tca": ["tca", CROSSED, "--torque", "50"],
    "tca of a worm": ["tca", SAMPLES / "novikov.toml"],
    "limits": ["limits", SAMPLES / "novikov.toml"],
    "topography": [
        "topography",
        SPUR,
        "--member",
        "gear",
        "--flank",
        "left",
        "--set",
        "gear.modifications_left.helix_slope=9um",
    ],
    "grid": ["grid", SPUR, "--member", "gear", "--surface", "all", "--ball", "2mm"],
    "settings": ["settings", SAMPLES / "spiral_bevel_basic.toml"],
    "compensate": ["settings", SAMPLES / "circular_arc.toml", "--set", "assembly.dC=0.02"],
    "check": ["check", CROSSED, "--tol", "50um", "--set", "contact.phi1.count=3"],
    "solid": ["solid", SAMPLES / "novikov.toml", "--member", "both", "-o", "a.obj", "--tol", "100um"],
    "fe": ["fe", CROSSED, "-o", "a.inp", "--teeth", "1", "--set", "fe.flank=5", "--set", "fe.face=6"],
    "run": ["run", SPUR, "--tol", "100um", "-o", "out", "--set", "contact.phi1.count=3"],
}


@pytest.mark.sweep_cases("run", "compensate", "check", "solid", "fe", "limits", "tca", "tca of a worm")
@pytest.mark.parametrize("command", COMMANDS)
def test_tables_fit_eighty_columns(command: str, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "no pictures")
    monkeypatch.setattr(Figure, "savefig", drawn)
    monkeypatch.setattr("gearmesh.answers.check.ROLL_TOLERANCE_MM", 1e-3)
    monkeypatch.setenv("COLUMNS", "80")
    solved: list[str] = []
    monkeypatch.setattr(
        contact, "side_contacts", lambda pair, *known: solved.append(pair.name) or side_contacts(pair, *known)
    )
    status, out, _ = run(*COMMANDS[command])
    assert status == 0
    # plots and page of a run show the same answer
    assert solved == (["pinion-gear"] if command in ("run", "tca") else [])
    assert out
    assert [line for line in out.splitlines() if len(line) > 80] == []
    # nothing is cut short, and no key is broken
    assert "…" not in out
    if "--all" in COMMANDS[command]:
        shown = {line.split()[0] for line in out.splitlines() if line.strip() and line[0] != " "}
        groups = system(COMMANDS[command][-1]).design.key_groups()
        assert {line.key for lines in groups.values() for line in lines} <= shown


@pytest.mark.sweep_cases("describe", "tca SAMPLE --json -")
@pytest.mark.parametrize("arguments", some(["describe", "describe beveloid", "sample", "tca SAMPLE --json -"], 3))
def test_a_closed_standard_output_is_one_line(arguments: str) -> None:
    command = f"exec '{sys.executable}' -m gearmesh {arguments.replace('SAMPLE', str(SPUR))} >&-"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "default"}
    done = subprocess.run(["sh", "-c", command], stderr=subprocess.PIPE, text=True, check=False, env=environment)
    assert done.returncode == 2
    last = done.stderr.splitlines()[-1]
    assert last == "gearmesh: error: standard output: Bad file descriptor"
    assert "Traceback" not in done.stderr
    assert all(line.startswith("gearmesh: ") for line in done.stderr.splitlines())


def test_completion_answers() -> None:
    asked = {"_GEARMESH_COMPLETE": "complete_bash", "COMP_WORDS": "gearmesh s", "COMP_CWORD": "1"}
    done = program(**asked)
    assert (done.returncode, done.stdout.split()) == (0, ["solid", "settings", "size", "study", "sample"])
    script = program(_GEARMESH_COMPLETE="source_bash")
    assert "_GEARMESH_COMPLETE=complete_bash" in script.stdout


def test_json_is_that_of_the_api() -> None:
    answer = gm.build(gm.load(CROSSED)).limits()
    assert run("limits", CROSSED, "--json", "-")[1] == answer.json()


@pytest.mark.sweep
def test_topographies_go_into_files_and_wrong_requests_are_one_line(here: Path) -> None:
    relief = "pinion.modifications_right.tip_relief={ amount = '9um', start_roll_length = 12 }"
    asked = ("topography", SPUR, "--set", relief, "--member", "pinion", "--flank")
    assert run(*asked, "right", "-o", "right.csv")[0] == 0
    text = (here / "right.csv").read_text()
    assert text.startswith("roll_length_mm,z_mm,amount_um\n")
    status, out, _ = run("tca", SPUR, "--set", "pinion.modifications_right.topography=right.csv", "--json", "-")
    assert status == 0
    written, again = json.loads(run("tca", SPUR, "--set", relief, "--json", "-")[1]), json.loads(out)
    assert written["summary"]["mesh_te_peak_to_peak_arcsec"] == pytest.approx(
        again["summary"]["mesh_te_peak_to_peak_arcsec"], abs=0.05
    )
    for wrong, message in (
        (
            ("left",),
            "--flank = left: this flank has no modification; allowed is a flank with pinion.modifications or pinion.mod",
        ),
        (("both",), "--flank = both: must be one of right, left"),
        (("right", "-o", "a.txt"), "cannot write a.txt: its suffix must be .csv"),
    ):
        status, out, err = run(*asked, *wrong)
        assert (status, out) == (2, "")
        assert err.splitlines()[-1].startswith(f"gearmesh: error: {message}")


def test_convert_reads_and_writes_rexs_files(tmp_path: Path) -> None:
    rexs, design = tmp_path / "gears.rexsj", tmp_path / "again.toml"
    assert run("convert", SAMPLES / "spur.toml", "-o", rexs)[0] == 0
    status, out, _ = run("convert", rexs, "-o", design, "--json", tmp_path / "reading.json")
    assert status == 0
    assert "reference_circle_diameter" in out
    assert json.loads((tmp_path / "reading.json").read_text())["stage"] == "cylindrical_stage 1"
    for arguments, why in (
        ((rexs, "-o", tmp_path / "x.stl"), ".toml"),
        ((SAMPLES / "spur.toml", "-o", tmp_path / "x.toml"), ".rexs"),
        ((rexs, "-o", design, "--torque", "3"), "--torque = 3: is for designs"),
        ((rexs, "-o", design, "--stage", "77"), "--stage = 77: the file has no such stage"),
        ((SAMPLES / "spur.toml", "-o", rexs, "--stage", "1"), "--stage = 1: is for REXS files"),
        ((SAMPLES / "face_gear.toml", "-o", rexs), "REXS has no such stage"),
    ):
        assert why in refused("convert", *arguments)
