"""A gear system of one's own: a rack and a roll, registered in one line, has all commands."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.registry import keep_registry

import gearmesh as gm
import gearmesh.kinds as kinds
from gearmesh.kinds import (
    Arc,
    Blank,
    Body,
    ConeLevel,
    Envelope,
    FlankContact,
    GearPair,
    GearTrain,
    Member,
    MemberTable,
    Mount,
    PlaneLevel,
    RackLine,
    RackRoll,
    RackSurface,
    Rigid,
    Side,
    Tooth,
    ToothSide,
)

ALPHA, ADDENDUM, DEDENDUM = np.radians(20.0), 1.0, 1.25


class SharpRackDesign(gm.Design):
    """A pair cut by a rack with sharp edges."""

    about: ClassVar[str] = "spur gears cut by a rack with sharp edges"
    own_kind: ClassVar[str] = "sharp_rack"
    example: ClassVar[Mapping[str, Any]] = {
        "module": 2,
        "pinion": {"teeth": 24, "face_width": 6},
        "gear": {"teeth": 36, "face_width": 6},
    }

    pinion: MemberTable
    gear: MemberTable
    contact: FlankContact = FlankContact()


def member(name: str, spec: MemberTable, module: float) -> Member:
    radius, half = 0.5 * spec.teeth * module, 0.5 * spec.face_width
    line = RackLine(ALPHA, module, 0.25 * np.pi * module)
    form_point, tip = line.at_height(-DEDENDUM * module), line.at_height(ADDENDUM * module)
    edge = Arc(tuple(line.section(np.array(form_point))[0]), 0.0)

    def side(sign: int) -> ToothSide:
        cutters = RackSurface(line, 0.0, 0.0, sign), RackSurface(edge, 0.0, 0.0, sign)
        flank, fillet = (Envelope(cutter, RackRoll(radius)) for cutter in cutters)
        tool = cutters[0].cutter(edge, 0.0, radius)
        return ToothSide(
            flank, fillet, (form_point, float(ALPHA)), root=0.5 * np.pi, tip=tip, tool=tool, generation=(flank, fillet)
        )

    levels = (ConeLevel.of(radius + height * module) for height in (ADDENDUM, -DEDENDUM))
    body = Body.tube(0.5 * radius, -half, half)
    tooth = Tooth(spec.teeth, side(1), side(-1), Blank(PlaneLevel(0.0), (-half, half), *levels, body))
    tooth.prove()
    return Member(name, tooth, lambda p, v: {"p": p, "z": v})


def build(design: SharpRackDesign) -> GearTrain:
    module, flank = design.given_module, Side(design.contact.flank)
    pinion, gear = member("pinion", design.pinion, module), member("gear", design.gear, module)
    apart = np.array([0.5 * module * (design.pinion.teeth + design.gear.teeth), 0.0, 0.0])
    ratio = design.pinion.teeth / design.gear.teeth
    pinion = replace(pinion, mount=Mount(Rigid.identity(), sign=-1.0))
    gear = replace(gear, mount=Mount(Rigid(np.eye(3), apart)))
    return GearTrain(design.kind, (GearPair(pinion, gear, (flank, flank), flank.sign, ratio, design.contact.delta),))


@pytest.fixture
def design_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A new design of the kind, in an empty current folder."""
    keep_registry(monkeypatch)
    gm.register(gm.System("sharp_rack", SharpRackDesign, build))
    monkeypatch.chdir(tmp_path)
    assert run("new", "sharp_rack", "-o", "own.toml")[0] == 0
    return "own.toml"


def contact_ratio() -> float:
    """Length of the line of action between the tip circles over the base pitch [ISO 21771]."""
    length = -60.0 * np.sin(ALPHA)
    for teeth in (24, 36):
        length += np.sqrt((teeth + 2.0 * ADDENDUM) ** 2 - (teeth * np.cos(ALPHA)) ** 2)
    return float(length / (2.0 * np.pi * np.cos(ALPHA)))


@pytest.mark.sweep
def test_contact_solids_checks_and_limits(design_file: str) -> None:
    contact = json.loads(run("tca", design_file, "--json", "-")[1])
    assert {row["contact"] for row in contact["positions"]} == {"line"}
    assert contact["summary"]["te_peak_to_peak_arcsec"] < 1e-6
    assert contact["summary"]["contact_ratio"] == pytest.approx(contact_ratio(), abs=1e-3)

    status, out, _ = run("solid", design_file, "--member", "both", "-o", "pair.obj", "--tol", "20um")
    assert status == 0
    assert out.count("true") == 2
    found = json.loads(run("check", design_file, "--tol", "20um", "--json", "-")[1])
    assert all(mesh["watertight"] for mesh in found["mesh"].values())
    assert all(abs(row["te_difference_arcsec"]) < 2.0 for row in found["roll"])

    # [LF04 6]: a sharp rack undercuts below 2 h / sin^2(alpha) teeth, 21.4
    limits = json.loads(run("limits", design_file, "--json", "-")[1])["members"]["pinion"]
    assert (limits["undercut"], limits["fewest_teeth"]) == (False, 22)


@pytest.mark.sweep
def test_models_descriptions_and_errors(design_file: str) -> None:
    model = json.loads(run("fe", design_file, "-o", "pair.inp", "--teeth", "1", "--json", "-")[1])["model"]
    assert model["min_scaled_jacobian"] > 0.2
    assert "sharp_rack" in run("describe")[1]
    assert "pinion.face_width" in run("describe", "sharp_rack")[1]
    assert "60" in run("describe", design_file)[1]
    assert refused("describe", "sharp_rak").endswith('did you mean "sharp_rack"?')
    assert (
        refused("tca", design_file, "--set", "pinion.tooth=3")
        == "pinion.tooth: unknown key; did you mean pinion.teeth?"
    )


@pytest.mark.sweep
def test_the_main_job(design_file: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # its pictures are the same code, and cost more than all the rest
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "none today")
    status, out, _ = run("run", design_file, "--tol", "20um", "--set", "contact.phi1.count=3")
    assert status == 0
    folder = Path("out") / "own"
    written = json.loads((folder / "report.json").read_text())["files"]
    assert {
        "pinion.stl",
        "gear.stl",
        "pair.vtm",
        "contact.csv",
        "transmission_error.png",
        "report.json",
        "report.html",
    } <= {*written}
    assert all((folder / name).is_file() for name in written)
    assert str(folder / "gear.stl") in out


OUTSIDE = """
import gearmesh as gm
from gearmesh.kinds import MemberTable

class OutsideDesign(gm.Design):
    own_kind = "outside"
    about = "gears of another package"
    pinion: MemberTable

SYSTEM = gm.System("outside", OutsideDesign, print)
"""


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], None]:
    """Installs a package with entry points, lines of "kind = module:object", and the text of its module other_gears."""
    keep_registry(monkeypatch)
    monkeypatch.delitem(sys.modules, "other_gears", raising=False)

    def install(entries: str, text: str) -> None:
        metadata = tmp_path / "other_gears-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: other-gears\nVersion: 1.0\n")
        (metadata / "entry_points.txt").write_text(f"[gearmesh.systems]\n{entries}\n")
        (tmp_path / "other_gears.py").write_text(text)
        monkeypatch.syspath_prepend(tmp_path)

    return install


@pytest.mark.quick
def test_installed_packages_bring_their_kinds(installed: Callable[[str, str], None]) -> None:
    """Installed packages declare kinds by an entry point. A package is imported when its kind is asked for."""
    assert "kind" in refused("describe", "outside")
    assert "outside" not in gm.kinds()
    installed("outside = other_gears:SYSTEM", OUTSIDE)
    # listed and suggested before it is used
    assert "outside" in gm.kinds()
    assert "other_gears" not in sys.modules
    assert refused("describe", "outsid").endswith('did you mean "outside"?')
    assert "gears of another package" in run("describe")[1]
    assert "pinion.teeth" in run("describe", "outside")[1]
    assert (
        json.loads(run("describe", "outside", "--schema", "--json", "-")[1])["properties"]["kind"]["const"] == "outside"
    )
    assert gm.system("outside").design.about == "gears of another package"


@pytest.mark.parametrize(
    ("entry", "text", "fault"),
    [
        (
            "outside = other_gears:SYSTEM",
            "import no_such_package",
            "cannot be loaded: ModuleNotFoundError: No module named",
        ),
        (
            "outside = other_gears:OutsideDesign",
            OUTSIDE,
            "it is a ModelMetaclass; must be a gearmesh.System of the kind",
        ),
        (
            "inside = other_gears:SYSTEM",
            OUTSIDE,
            'it is a system of the kind "outside"; must be a gearmesh.System of the kind',
        ),
    ],
)
def test_packages_that_bring_no_kind(entry: str, text: str, fault: str, installed: Callable[[str, str], None]) -> None:
    installed(entry, text)
    kind = entry.partition(" ")[0]
    # the list of kinds and other kinds do not suffer from it
    status, listed, _ = run("describe")
    assert status == 0
    assert "spur and helical" in listed
    assert fault in " ".join(listed.split())
    assert fault in refused("describe", kind, status=3)


@pytest.mark.quick
def test_names_of_the_module_for_kinds() -> None:
    """All are there and found without a change of `gm.kinds`, whose place the module takes."""
    assert sorted(kinds.__all__) == sorted(name for name in dir(kinds) if not name.startswith("_"))
    assert all(
        getattr(kinds, name).__module__.startswith("gearmesh.") for name in kinds.__all__ if name != "REVOLUTE_JOINT"
    )
    assert gm.kinds() == kinds()  # type: ignore[operator]
    assert "ToothSide" not in vars(gm)
