"""Options that cannot be are refused before anything is built of the design: of every command every option that takes a value."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import click
import pytest
import typer
from oracles.command_line import refused
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.app.cli import command_line
from gearmesh.app.options import refuse_arguments
from gearmesh.systems import system as systems

SPUR, HYPOID = str(SAMPLES / "spur.toml"), str(SAMPLES / "hypoid.toml")
ARC, PLANETARY = str(SAMPLES / "circular_arc.toml"), str(SAMPLES / "planetary.toml")
#: what a command has beside the option that is wrong
BASE: dict[str, list[str]] = {
    "run": [SPUR],
    "report": [SPUR],
    "tca": [SPUR],
    "load": [SPUR, "--torque", "10"],
    "solid": [SPUR, "--member", "pinion", "-o", "out.step"],
    "render": [SPUR, "-o", "out.png"],
    "check": [SPUR],
    "fe": [SPUR, "-o", "out.inp"],
    "limits": [SPUR],
    "topography": [SPUR, "--member", "pinion", "--flank", "right"],
    "grid": [SPUR, "--member", "pinion"],
    "evaluate": [SPUR, "--member", "pinion", "--pitch", "pitch.csv"],
    "composite": [SPUR],
    "correct": [SPUR, "--member", "pinion"],
    "drawing": [SPUR, "--member", "pinion", "-o", "out.pdf"],
    "freecad": [SPUR, "-o", "out.FCMacro"],
    "toolpath": [SPUR, "--member", "pinion", "--tool", "ball:1mm", "--scallop", "10um"],
    "settings": [ARC],
    "vh": [HYPOID],
    "gear": ["--teeth", "20", "--module", "2", "-o", "out.step"],
    "size": ["--ratio", "2", "--center-distance", "64", "--module", "2"],
    "study": [SPUR, "--vary", "assembly.dx=0:0.1:2"],
    "optimize": [SPUR, "--vary", "pinion.bore=5:9", "--minimize", "contact_ratio", "-o", "out"],
    "describe": [SPUR],
    "prove": [SPUR],
    "new": ["hypoid"],
    "explore": [SPUR, "--no-browser"],
    "pin": [SPUR, "-o", "out.toml"],
    "convert": [SPUR, "-o", "out.rexs"],
    "sample": ["spur"],
}
NOWHERE = ("nowhere/out", "cannot write nowhere/out")
#: a folder inside a file
IN_FILE = ("pitch.csv/out", "cannot make the folder pitch.csv/out: Not a directory")
#: wrong processes and clusters, of all commands that compute many designs
WRONG_CLUSTER: dict[str, Any] = {
    "--workers": ("0", "--workers = 0"),
    "--scheduler": ("host", "--scheduler = host: must be an address with a port"),
    "--tls-ca-file": ("nowhere.pem", "--tls-client-cert: missing"),
    "--tls-client-cert": ("nowhere.pem", "--tls-ca-file: missing"),
    "--tls-client-key": ("nowhere.pem", "--tls-ca-file: missing"),
}
#: wrong values of options, and what the refusal begins with; of one option several, each with what else is given
WRONG: dict[str, dict[str, Any]] = {
    "run": {"-o": IN_FILE, "--tol": ("0", "--tol = 0"), "--torque": ("-1", "--torque = -1")},
    "report": {
        "-o": ("nowhere/out.html", "cannot write"),
        "--tol": ("x", "--tol = x"),
        "--study": ("nowhere", "--study = nowhere: holds no finished study"),
        "--errors": ("assembly.dx=0,1", "--errors assembly.dx=0,1: needs OTHER"),
        "--torque": ("0", "--torque = 0"),
    },
    "tca": {
        "--csv": NOWHERE,
        "--torque": ("nan", "--torque = nan"),
        "--ease-off": NOWHERE,
        "--speed": ("0", "--speed = 0"),
        "--pair": ("a-b", "--pair = a-b"),
    },
    "load": {
        "--level": ("x", "--level = x"),
        "--torque": ("x", "--torque = x"),
        "--phi1": ("3:1:5", "--phi1 = 3:1:5"),
        "--csv": NOWHERE,
        "-o": IN_FILE,
        "--dynamics": ("out.txt", "cannot write out.txt"),
        "--tribology": ("out.txt", "cannot write out.txt"),
        "--speed": ("1500", "--speed = 1500: must be left out without --tribology"),
        "--friction": ("2", "--friction = 2: must be a coefficient", "--tribology", "out.csv"),
        "--viscosity": ("-1", "--viscosity = -1", "--tribology", "out.csv"),
        "--pressure-viscosity": ("20", "--pressure-viscosity = 20: a film needs", "--tribology", "out.csv"),
        "--roughness": ("0.4", "--roughness = 0.4: the coefficient of friction", "--tribology", "out.csv"),
        "--pair": ("gear", "--pair = gear"),
    },
    "solid": {
        "--member": ("wheel", "--member = wheel"),
        "-o": ("out.xyz", "cannot write out.xyz"),
        "--tol": ("-1um", "--tol = -1um"),
        "--section": ("x", "--section = x", "-o", "out.dxf"),
        "--curves": ("cubic", "--curves = cubic", "-o", "out.dxf"),
        "--dxf": ("R13", "--dxf = R13", "-o", "out.dxf"),
        "--offset": ("x", "--offset = x"),
        "--teeth": ("1000", "--teeth = 1000"),
        "--flank-only": ("top", "--flank-only = top"),
        "--phi1": ("3", "--phi1 = 3"),
        "--sector": ("0", "--sector = 0"),
        "--names": ("out.txt", "cannot write out.txt"),
    },
    "render": {
        "-o": ("out.xyz", "cannot write out.xyz"),
        "--view": ("x", "Invalid value for '--view'"),
        "--look": ("x", "Invalid value for '--look'"),
        "--member": ("wheel", "--member = wheel"),
        "--phi1": ("nan", "--phi1 = nan"),
        "--torque": ("-1", "--torque = -1", "--view", "loaded"),
        "--tool": ("cube:1", "--tool = cube:1", "--view", "toolpath"),
        "--scallop": ("x", "--scallop = x", "--view", "toolpath", "--tool", "ball:1mm"),
        "--pair": ("a-b", "--pair = a-b"),
        "--size": ("1x1", "--size = 1x1"),
        "--dpi": ("1", "--dpi = 1"),
        "--animate": ("out.png", "cannot write out.png"),
    },
    "check": {"--tol": ("0", "--tol = 0")},
    "fe": {
        "-o": ("out.xyz", "cannot write out.xyz"),
        "--teeth": ("2", "--teeth = 2"),
        "--sector": ("1", "--teeth = 3", "--teeth", "3"),
        "--phi1": ("x", "--phi1 = x"),
        "--torque": ("-1", "fe.torque = -1"),
        "--rotation": ("5", "--rotation = 5"),
        "--friction": ("2", "--friction = 2"),
        "--for": ("sap", "Invalid value for '--for'"),
        "--member": ("wheel", "--member = wheel"),
        "--pair": ("a-b", "--pair = a-b"),
        "--picture": ("out.png", "--picture = out.png"),
        "--keep": ("kept", "--keep = kept"),
        "--frequencies": ("0", "--frequencies = 0"),
    },
    "limits": {"--land": ("9", "--land = 9")},
    "topography": {
        "--member": ("wheel", "--member = wheel"),
        "--flank": ("top", "--flank = top"),
        "-o": ("out.txt", "cannot write out.txt"),
        "--tol": ("0", "--tol = 0"),
    },
    "grid": {
        "--member": ("wheel", "--member = wheel"),
        "--flank": ("top", "--flank = top"),
        "--surface": ("tip", "--surface = tip"),
        "--grid": ("0x5", "--grid = 0"),
        "--margins": ("0.6,0.1", "--margins = 0.6"),
        "--ball": ("0", "--ball = 0"),
        "-o": ("out.xyz", "cannot write out.xyz"),
        "--chart": ("out.txt", "cannot write out.txt"),
    },
    "evaluate": {
        "--member": ("wheel", "--member = wheel"),
        "--measured": ("nowhere.csv", "nowhere.csv"),
        "--flank": ("top", "--flank = top", "--measured", "flanks.csv"),
        "--pitch": ("nowhere.csv", "nowhere.csv"),
        "-o": ("out.txt", "cannot write out.txt"),
    },
    "composite": {"--csv": NOWHERE, "-o": ("out.txt", "cannot write out.txt"), "--pair": ("a-b", "--pair = a-b")},
    "correct": {
        "--member": ("wheel", "--member = wheel"),
        "--measured": ("nowhere.csv", "nowhere.csv"),
        "--flank": ("top", "--flank = top", "--measured", "flanks.csv"),
        "--settings": ("x", "--settings = x", "--measured", "flanks.csv"),
        "--noise": ("-1", "--noise = -1"),
        "--residual": ("out.txt", "cannot write out.txt"),
        "--topography": ("out.txt", "cannot write out.txt"),
        "-o": ("out.txt", "cannot write out.txt"),
    },
    "drawing": {"--member": ("wheel", "--member = wheel"), "-o": ("out.txt", "cannot write out.txt")},
    "freecad": {"-o": ("out.txt", "cannot write out.txt"), "--tol": ("0", "--tol = 0")},
    "toolpath": {
        "--member": ("wheel", "--member = wheel"),
        "--tool": ("cube:1", "--tool = cube:1"),
        "--scallop": ("x", "--scallop = x"),
        "-o": ("out.txt", "cannot write out.txt"),
        "--stock": ("-1", "--stock = -1"),
        "--tol": ("x", "--tol = x"),
        "--flank": ("top", "--flank = top"),
        "--surfaces": ("x", "--surfaces = x"),
        "--spaces": ("x", "--spaces = x"),
        "--order": ("x", "--order = x"),
        "--lead": ("90", "--lead = 90"),
        "--tilt": ("90", "--tilt = 90"),
        "--feed": ("-1", "--feed = -1"),
    },
    "settings": {
        "-o": ("out.txt", "cannot write out.txt"),
        "--refinish": ("x", "--refinish = x"),
        "--torque": ("-1", "--torque = -1"),
    },
    "vh": {"--move": ("V,x", "--move = V,x")},
    "study": {
        "--level": ("x", "--level = x"),
        "--vary": ("assembly.dx=0:1:1", "--vary assembly.dx = 0:1:1"),
        "--sample": ("-1", "--sample = -1"),
        "--tolerance": ("x=normal:0:1", "--tolerance"),
        "--method": ("x", "--method = x", "--sample", "4"),
        "--seed": ("-1", "--seed = -1", "--sample", "4"),
        "--record": ("load", "--record load"),
        "--torque": ("-1", "--torque = -1"),
        "--limit": ("x", "--limit"),
        "--find-limits": ("assembly.dx=-1", "--find-limits"),
        "-o": IN_FILE,
        **WRONG_CLUSTER,
        "--pair": ("a-b", "--pair = a-b"),
    },
    "optimize": {
        "--level": ("x", "--level = x"),
        "--vary": ("pinion.teeth=18", "--vary pinion.teeth: must be LOW:HIGH, or a list"),
        "--minimize": ("x@", "--minimize x@: behind @ must be torques"),
        "--maximize": ("x:max", "--maximize x:max: must be FIGURE"),
        "--subject": ("x", "--subject x: must look like"),
        "--robust": ("x=normal:0:1", "--robust"),
        "--robust-rows": ("1", "--robust-rows = 1"),
        "--robust-by": ("x", "--robust-by = x"),
        "--method": ("x", "--method = x"),
        "--budget": ("x", "--budget = x"),
        "--seed": ("-1", "--seed = -1"),
        "-o": IN_FILE,
        **WRONG_CLUSTER,
        "--pair": ("a-b", "--pair = a-b"),
    },
    "explore": {"--port": ("80", "--port = 80")},
    "describe": {
        "--torque": ("-1", "--torque = -1"),
        "--speed": ("10", "--speed = 10"),
        "--member": ("wheel", "--member = wheel"),
    },
    "pin": {"-o": ("out.txt", "cannot write out.txt")},
    "convert": {
        "-o": ("out.txt", "cannot write out.txt"),
        "--stage": ("s", "--stage = s"),
        "--torque": ("-1", "--torque = -1"),
    },
}


@pytest.mark.parametrize("sample", ["spur", "planetary", "rack", "worm_drive", "face_gear", "hypoid"])
def test_names_are_known_before_gears_are_built(sample: str) -> None:
    design = gm.load(SAMPLES / f"{sample}.toml", complete=False)
    assert design.member_names == gm.build(design).train.names


def test_names_of_gears_alone() -> None:
    for name in ("pinion", "gear"):
        design = gm.parse({"kind": "cylindrical", "module": 2, name: {"teeth": 20, "face_width": 9}})
        assert design.member_names == gm.build(design).train.names
    rack = gm.parse({"kind": "rack", "module": 2, "rack": {"teeth": 9, "face_width": 9}})
    assert rack.member_names == gm.build(rack).train.names


#: what gears are asked without a wrong argument
ASKED: dict[str, Callable[[gm.Gears], object]] = {
    "contact": lambda gears: gears.contact(),
    "loaded": lambda gears: gears.loaded_contact(10.0),
    "solid": lambda gears: gears.solid(gears.names.members[0]),
    "cad": lambda gears: gears.cad(),
    "section": lambda gears: gears.section(gears.names.members[0]),
    "picture": lambda gears: gears.picture(),
    "elements": lambda gears: gears.finite_elements(),
    "grid": lambda gears: gears.measuring_grid(gears.names.members[0]),
    "toolpath": lambda gears: gears.toolpath(gears.names.members[0], "ball:1mm", "10um"),
    "study": lambda gears: gears.study({"contact.delta": "0.001:0.01:2"}),
    "largest": lambda gears: gears.largest_errors(["contact.delta"]),
    "run": lambda gears: gears.run("out"),
    "report": lambda gears: gears.report(),
    "sheet": lambda gears: gears.sheet(),
    "pin": lambda gears: gears.pin(),
}


@pytest.mark.parametrize("sample", sorted(file.stem for file in SAMPLES.glob("*.toml")))
def test_what_can_be_is_not_refused_before_gears_are_built(sample: str) -> None:
    """Designs as they stand in their files, whose derived values are missing."""
    design = gm.load(SAMPLES / f"{sample}.toml", complete=False)
    for ask in ASKED.values():
        refuse_arguments(design, ask)


def options() -> Iterator[tuple[str, str]]:
    """Commands that read a design, and their options with a value."""
    group: Any = typer.main.get_command(command_line())
    context = click.Context(group)
    for name in group.list_commands(context):
        if name in WRONG:
            for parameter in group.get_command(context, name).params:
                flag = getattr(parameter, "is_flag", False)
                if not flag and parameter.opts[0] not in (
                    "design_file",
                    "other_file",
                    "what",
                    "table",
                    "source",
                    "--set",
                ):
                    yield name, parameter.opts[0]


@pytest.mark.parametrize(("command", "option"), list(options()))
def test_option_is_refused_before_work(
    command: str, option: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    def built(*_: object, **__: object) -> None:
        raise AssertionError("something was built")

    monkeypatch.chdir(tmp_path)
    (tmp_path / "flanks.csv").write_text("flank,s,t,deviation_um\nright,0.5,0.5,1\n")
    (tmp_path / "pitch.csv").write_text("tooth,right_um\n0,1\n")
    monkeypatch.setattr(systems, "_naming_keys", built)
    given = NOWHERE if option == "--json" else WRONG[command][option]
    value, words, *more = given
    base = list(BASE[command])
    for name, other in zip(more[::2], more[1::2], strict=True):
        if name in base:
            base[base.index(name) + 1] = other
        else:
            base += [name, other]
    if option in base:
        base[base.index(option) + 1] = value
    else:
        base += [option, value]
    assert refused(command, *base).startswith(words)
