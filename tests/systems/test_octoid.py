"""Straight bevel gears as another package brings them: by an entry point, from the names of gearmesh and gearmesh.kinds alone."""

from __future__ import annotations

import ast
import json
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from oracles.command_line import run
from oracles.registry import keep_registry
from scipy.optimize import brentq

import gearmesh as gm

SOURCE = Path(__file__).parents[1] / "data" / "octoid_gears.py"
TEETH, ALPHA, MODULE, THINNING = (18, 36), np.radians(20.0), 3.0, 0.05
PITCH_ANGLES = np.arctan2(TEETH, TEETH[::-1])
CROWN_TEETH = float(np.hypot(*TEETH))


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The folder of an installed package with the kind octoid."""
    folder = tmp_path_factory.mktemp("installed")
    metadata = folder / "octoid_gears-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: octoid-gears\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[gearmesh.systems]\noctoid = octoid_gears:SYSTEM\n")
    shutil.copy(SOURCE, folder)
    with pytest.MonkeyPatch.context() as patch:
        keep_registry(patch)
        patch.syspath_prepend(folder)
        yield folder
    sys.modules.pop("octoid_gears", None)


@pytest.fixture(scope="module")
def gears(package: Path) -> gm.Gears:
    tables = {name: {"teeth": teeth, "face_width": 14} for name, teeth in zip(("pinion", "gear"), TEETH, strict=True)}
    return gm.build(
        gm.parse(
            {"kind": "octoid", "module": MODULE, "thinning": THINNING, **tables, "contact": {"phi1": {"count": 3}}}
        )
    )


def contact_ratio() -> float:
    """Arc of the crown rack between contact at both tips, over its pitch.

    The normal n of the rack's plane at the azimuth theta leans against the pitch line p by sin(chi) = cos(alpha)
    sin(theta). The plane touches where it meets the plane of n and p, along p - (p . n) n. Of this direction and the
    member's axis the angle is that of its tip cone:

        cos(delta) cos(chi) - sin(alpha) sin(delta) tan(chi) = cos(delta_a)
    """
    arc = 0.0
    for delta in PITCH_ANGLES:
        tip = delta + np.arctan(2.0 / CROWN_TEETH)

        def beyond(chi: float, delta: float = delta, tip: float = tip) -> float:
            return float(np.cos(delta) * np.cos(chi) - np.sin(ALPHA) * np.sin(delta) * np.tan(chi) - np.cos(tip))

        arc += float(np.arcsin(np.sin(brentq(beyond, 0.0, 1.0, xtol=1e-15)) / np.cos(ALPHA)))
    return arc * CROWN_TEETH / (2.0 * np.pi)


def test_the_package_takes_public_names_alone() -> None:
    modules = {node.module for node in ast.walk(ast.parse(SOURCE.read_text())) if isinstance(node, ast.ImportFrom)}
    assert {module for module in modules if str(module).startswith("gearmesh")} == {"gearmesh.kinds"}


def test_surfaces_are_proved(package: Path) -> None:
    assert "octoid" in gm.kinds()
    assert max(row.point_error for row in gm.prove("octoid").rows) < 1e-9


@pytest.mark.sweep
def test_contact_ratio_backlash_and_transmission_are_those_of_the_crown_rack(gears: gm.Gears) -> None:
    contact = gears.contact().summary
    assert contact["te_peak_to_peak_arcsec"] < 1e-8
    assert contact["contact_ratio"] == pytest.approx(contact_ratio(), abs=1e-10)
    # each of four flanks is turned about the axis of the crown rack
    play = 4.0 * THINNING / np.sin(PITCH_ANGLES[1])
    assert contact["backlash_min_deg"] == pytest.approx(play, abs=1e-10)
    assert contact["backlash_max_deg"] == pytest.approx(play, abs=1e-10)


@pytest.mark.sweep
def test_commands(package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("new", "octoid", "-o", "pair.toml")[0] == 0
    checked = json.loads(run("check", "pair.toml", "--tol", "50um", "--set", "thinning=0.05", "--json", "-")[1])
    assert all(mesh["watertight"] for mesh in checked["mesh"].values())
    assert all(abs(row["te_difference_arcsec"]) < 5.0 for row in checked["roll"])
