"""Studies under load: rows against the same designs asked one by one, what is built once, and what is refused."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, GearPair, NoSolutionError, OutputError
from gearmesh.answers.load import loaded
from gearmesh.contact.hertz import STEEL, Material
from gearmesh.errors import Status
from gearmesh.loaded import sharing
from gearmesh.loaded.compliance.compliance import FlankCompliance, flank_compliance
from gearmesh.loaded.sharing import loaded_mesh
from gearmesh.mesh.hexahedra.hexahedra import Cells
from gearmesh.study.rows.load_figures import POSITIONS_PER_PITCH, load_figures, loaded_contact_ratio
from gearmesh.study.rows.work import Bodies, StudyWork, _build

SMALL = Cells(flank=6, fillet=4, thickness=3, rim=4, face=8)
SPUR = SAMPLES / "spur_relieved.toml"
VARY = ("--vary", "assembly.gamma_v=0,0.02")


@pytest.fixture
def bodies(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Pairs whose compliance has been worked out, with few elements; contact is solved on few cells, in rows and alone."""
    asked: list[str] = []

    def few(
        pair: GearPair, materials: tuple[Material, Material], *_: object
    ) -> tuple[FlankCompliance, FlankCompliance]:
        asked.append(pair.name)
        first, second = (
            flank_compliance(member.tooth, side, material, SMALL)
            for member, side, material in zip(pair.both, pair.flanks, materials, strict=True)
        )
        return first, second

    monkeypatch.setattr(loaded, "compliances", few)
    monkeypatch.setattr(sharing, "CONTACT_CELLS", (24, 14))
    _build.cache_clear()
    return asked


@pytest.mark.sweep
def test_a_row_is_what_the_design_has_under_these_torques(bodies: list[str]) -> None:
    """On top of an error that the design has itself; bodies are worked out once for all places, and anew for another design."""
    own = ["assembly.dy=0.01"]
    vary: dict[str, list[float]] = {"assembly.gamma_v": [0.0, 0.02]}
    study = gm.build(gm.load(SPUR, own)).study(vary, record="load", torque=[10.0, 40.0], workers=1)
    assert bodies == ["pinion-gear"]
    assert set(study.columns["status"]) == {"ok"}
    alone = gm.build(gm.load(SPUR, [*own, "assembly.gamma_v=0.02"]))
    phi1 = np.degrees(alone.pairs[0].pitch) * np.arange(POSITIONS_PER_PITCH) / POSITIONS_PER_PITCH
    found = alone.loaded_contact([10.0, 40.0], phi1)
    for k, total in enumerate([each.row for each in found.totals], start=1):
        row = {name: values[1] for name, values in study.columns.items()}
        assert row[f"loaded_te_peak_to_peak_{k}_arcsec"] == pytest.approx(total["te_peak_to_peak_arcsec"], rel=1e-6)
        for name in (
            "max_pressure",
            "pinion_root_stress",
            "gear_root_stress",
            "pinion_root_stress_30",
            "gear_root_stress_30",
        ):
            assert row[f"{name}_{k}_mpa"] == pytest.approx(total[f"{name}_mpa"], rel=1e-6)
        own_rows = [each.row for each in found.rows if each.torque == total["torque_nm"]]
        most = [max(pair["force_n"] for pair in each["tooth_pairs"]) for each in own_rows]
        share = np.array(most) / [sum(pair["force_n"] for pair in each["tooth_pairs"]) for each in own_rows]
        # spur gears: levers are the same everywhere
        assert row[f"max_pair_share_{k}"] == pytest.approx(share.max(), rel=1e-3)
        assert row[f"loaded_edge_positions_{k}"] == sum(
            any(pair["on_edge"] for pair in each["tooth_pairs"]) for each in own_rows
        )
        stiffness = np.mean([each["stiffness_nm_per_arcsec"] for each in own_rows])
        assert row[f"mean_stiffness_{k}_nm_per_arcsec"] == pytest.approx(stiffness, rel=1e-6)
        assert 1.0 < row[f"loaded_contact_ratio_{k}"] < 2.0
        assert row[f"loaded_converged_positions_{k}"] == POSITIONS_PER_PITCH
    assert study.columns["gear_root_stress_2_mpa"][0] != pytest.approx(
        study.columns["gear_root_stress_2_mpa"][1], rel=1e-4
    )
    assert len(bodies) == 2
    gm.build(gm.load(SPUR, own)).study({"pinion.bore": [14.0]}, record="max_pressure_1_mpa", torque=20.0, workers=1)
    assert len(bodies) == 3


def bodies_in(design: Path, *keys: str) -> Bodies:
    """Bodies of a design's first pair."""
    gears = gm.build(gm.load(design, list(keys)))
    return Bodies(gears.design, gears.pairs[0])


@pytest.mark.sweep
def test_variants_of_micro_geometry_take_the_bodies_of_the_unchanged_design(bodies: list[str]) -> None:
    """3 um of crowning: figures within 2e-3 of those of its own bodies; 20 um and another bore are other bodies."""
    key, names = "pinion.modifications.profile_crowning", ["pinion_root_stress_30_1_mpa", "max_pressure_1_mpa"]
    study = gm.build(gm.load(SPUR)).study({key: [0.0, 0.003]}, record=",".join(names), torque=40.0, workers=1)
    assert set(study.columns["status"]) == {"ok"}
    assert len(bodies) == 1
    own = gm.build(gm.load(SPUR, [f"{key}=0.003"]))
    alone = own.study({"assembly.gamma_v": [0.0]}, record=",".join(names), torque=40.0, workers=1)
    assert len(bodies) == 2
    for name in names:
        unchanged, found = study.columns[name]
        assert found == pytest.approx(alone.columns[name][0], rel=2e-3)
        assert found != pytest.approx(unchanged, rel=1e-5)
    known = bodies_in(SPUR)
    assert known.serves(bodies_in(SPUR, f"{key}=0.003"))
    assert not known.serves(bodies_in(SPUR, f"{key}=0.02"))
    assert not known.serves(bodies_in(SPUR, "pinion.mount.held=rim"))


@pytest.mark.sweep
def test_the_command_records_loads_and_keeps_their_torques(tmp_path: Path, bodies: list[str]) -> None:
    out = tmp_path / "out"
    limit = ("--limit", "max_pressure_1_mpa<1e4", "--limit", "loaded_contact_ratio_1>1")
    words = ("study", SPUR, *VARY, "--record", "path,load", "--workers", "1", "--no-pictures", "-o", out)
    status, text, told = run(*words, *limit, "--torque", "20")
    assert status == 0, told
    assert "yield 100 %" in text
    document = json.loads((out / "study.json").read_text())
    assert document["torque_nm"] == [20.0]
    assert {"edge_positions", "loaded_edge_positions_1", "max_pressure_1_mpa"} <= set(document["nominal"])
    # the same folder with another torque is another study
    gears, more = gm.build(gm.load(SPUR)), {"pair": "pinion-gear", "workers": 1}
    with pytest.raises(OutputError, match="another study"):
        gears.study({"assembly.gamma_v": "0,0.02"}, record="path,load", torque=[30.0], folder=out, **more)  # type: ignore[arg-type]
    assert bodies == ["pinion-gear"]
    with pytest.raises(DesignError, match=r"max_pressure_1_mpa < 1: the design itself does not meet it: \d"):
        gears.largest_errors(["assembly.gamma_v"], ["max_pressure_1_mpa<1"], torque=20.0)


def test_limits_are_found_at_a_level(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def none(*given: object) -> None:
        asked.append(str(given[-1]))
        raise NoSolutionError(reason="not asked for")

    monkeypatch.setattr(loaded, "compliances", none)
    gears = gm.build(gm.load(SPUR))
    for level in ("quick", "full"):
        _build.cache_clear()
        with pytest.raises(NoSolutionError, match="not asked for"):
            gears.largest_errors(["assembly.gamma_v"], ["max_pressure_1_mpa<1"], torque=20.0, level=level)
        assert set(asked) == {level}
        asked.clear()
    with pytest.raises(DesignError, match="level = fast"):
        gears.largest_errors(["assembly.gamma_v"], level="fast")


def test_what_does_not_converge_has_no_figures() -> None:
    """Two torques, the second with a position without a solution: this position is counted as not converged, and all other
    figures of the torque are empty."""
    pair = pair_of(gm.load(SPUR))
    bodies = [flank_compliance(m.tooth, side, STEEL, SMALL) for m, side in zip(pair.both, pair.flanks, strict=True)]
    phi1 = pair.pitch * np.arange(2) / 2
    mesh = loaded_mesh(pair, phi1, np.array([1e4, 2e4]), (bodies[0], bodies[1]), cells=(12, 8))
    status = np.where([[False, False], [False, True]], Status.MAX_ITERATIONS, Status.CONVERGED)
    found = loaded.LoadedContact(gm.load(SPUR), pair, replace(mesh, status=status), (), 0.0)
    figures = load_figures(found).row
    assert figures.pop("loaded_converged_positions") == [2, 1]
    assert all(values[0] is not None and values[1] is None for values in figures.values())


@pytest.mark.parametrize(("first", "length"), [(2.3, 14.0), (0.0, 11.4), (3.6, 20.8)])
def test_the_contact_ratio_under_load_is_how_long_a_pair_carries(first: float, length: float) -> None:
    """A moment that rises and falls evenly over known lengths, in steps of a ninth of a pitch, told in any order."""
    at = np.arange(-9, 36)
    moment = np.clip(np.minimum(at - first, first + length - at) / 4.0, 0.0, 1.0)
    # both halves of double helical gears are one pair
    near = np.random.default_rng(1).permutation(np.tile(np.flatnonzero((at > -2) & (at < 30)), 2))
    load = SimpleNamespace(
        position=at[near] % POSITIONS_PER_PITCH, number=-(at[near] // POSITIONS_PER_PITCH), moment=moment[near]
    )
    assert loaded_contact_ratio(load, POSITIONS_PER_PITCH) == pytest.approx(length / POSITIONS_PER_PITCH, rel=1e-12)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--record", "load"], "--record load: needs torque, in Nm"),
        (["--torque", "40,80"], "--torque 40,80: needs figures under load; record = load has them"),
        (["--torque", "40,0"], "--torque = 40,0: must be finite numbers of Nm above 0"),
        (
            ["--record", "max_pressure_1_mpa"],
            "--record max_pressure_1_mpa: must be path, cycle, fit, turns, load with torque",
        ),
    ],
)
@pytest.mark.sweep_cases(
    "words1---torque 40,80: needs figures under load; record = load has them",
    "words3---record max_pressure_1_mpa: must be path, cycle, fit, turns, load with torque",
)
def test_torques_and_their_figures_need_each_other(
    words: list[str], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are refused before anything is solved."""

    def solved(*_: object) -> None:
        raise AssertionError("a row was solved")

    monkeypatch.setattr(StudyWork, "figures", solved)
    assert re.search(said, refused("study", SPUR, *VARY, *words))
