"""Rows of a study against the same designs asked one by one, as `--set` has them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import NoSolutionError, system
from gearmesh.contact.assemblies import AssemblyPaths
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.study.rows.path_figures import gears_advance
from gearmesh.study.rows.work import StudyWork, own_keys

BEVEL, CROSSED = SAMPLES / "spiral_bevel_basic.toml", SAMPLES / "beveloid_crossed.toml"
#: one sample of each way that errors move members, with an error (mm, deg) of every key
MOVED = ["hypoid", "spiral_bevel_geometry1", "helical", "internal", "face_gear", "beveloid_parallel", "novikov"]


@pytest.mark.parametrize("sample", [*MOVED, "circular_arc"])
@pytest.mark.sweep_cases("novikov", "beveloid_parallel", "internal", "spiral_bevel_geometry1")
def test_members_of_many_assemblies_stand_where_each_design_puts_them(sample: str) -> None:
    design = gm.load(SAMPLES / f"{sample}.toml")
    moved = system(design.kind).displacements
    assert moved is not None
    values = {f"assembly.{key}": 0.05 * (-1) ** k + 0.01 * k for k, key in enumerate(moved.keys)}
    still = design.with_values(dict.fromkeys(values, 0.0))
    wanted = [pair_of(design.with_values(each)).mounts for each in (dict.fromkeys(values, 0.0), values)]
    scale = {key: design.mm_per_unit if type(design).key_at(key).unit == "length" else 1.0 for key in values}  # type: ignore[union-attr]
    errors = {key.removeprefix("assembly."): np.array([0.0, scale[key] * value]) for key, value in values.items()}
    found = moved.bases(still.in_mm(), gm.build(still).train, errors)
    for member, base in enumerate(found):
        turns, shifts = np.broadcast_to(base.rotation, (2, 3, 3)), np.broadcast_to(base.translation, (2, 3))
        for k in (0, 1):
            other = wanted[k][member].base
            np.testing.assert_allclose(turns[k], other.rotation, rtol=0, atol=1e-14)
            np.testing.assert_allclose(shifts[k], other.translation, rtol=0, atol=1e-12)


#: figures of rows that are those of the contact of the design itself, under the same names
ALIKE = ("contact_ratio", "mesh_te_peak_to_peak_arcsec", "backlash_normal_min_mm", "tip_clearance_gear_mm")


def rows_and_designs() -> Iterator[tuple[gm.Study, int, dict[str, Any]]]:
    """A study of assembly errors through one pair of members and of a rebuilt key, together, on top of errors that the design has
    itself; numbers of rows, and the summary of the contact of the design with their keys."""
    own = ["assembly.dy=0.02", "assembly.dx=0.05"]
    vary = {"pinion.teeth": [25, 26], "assembly.dx": "0,60um", "assembly.gamma_v": [0.03]}
    more = ("mesh_te_harmonic_2_arcsec", "engagement_phi1_1_deg")
    study = gm.build(gm.load(CROSSED, own)).study(vary, record=(*ALIKE, *more), workers=1)
    assert set(study.columns["status"]) == {"ok"}
    for row in (1, 2):
        keys = {key: study.columns[key][row] for key in study.plan.keys}
        yield (
            study,
            row,
            gm.build(gm.load(CROSSED, [*own, *(f"{k}={v}" for k, v in keys.items())])).contact().summary,
        )


@pytest.mark.sweep
def test_a_row_is_what_the_design_with_these_keys_has() -> None:
    for study, row, alone in rows_and_designs():
        for name in ALIKE:
            assert study.columns[name][row] == pytest.approx(alone[name], rel=1e-9, abs=1e-9), name
        assert study.columns["mesh_te_harmonic_2_arcsec"][row] == pytest.approx(
            alone["mesh_te_harmonics_arcsec"][1], abs=1e-7
        )
        assert study.columns["engagement_phi1_1_deg"][row] == pytest.approx(alone["engagement_phi1_deg"][0], abs=1e-6)
    assert len({round(value, 6) for value in study.columns["contact_ratio"]}) == 4


@pytest.mark.sweep
def test_what_paths_alone_tell_is_near_what_the_cycle_does() -> None:
    vary = {"assembly.dV": "0,0.1", "assembly.dA": "0,0.1"}
    study = gm.build(gm.load(BEVEL, ["contact.phi1.count=41"])).study(vary, workers=1)
    for about, exact in (
        ("mesh_te_estimate_arcsec", "mesh_te_peak_to_peak_arcsec"),
        ("contact_ratio_estimate", "contact_ratio"),
    ):
        np.testing.assert_allclose(study.rows[about], study.rows[exact], rtol=0.02)
    # the places are those of the exact contact, from the middle of the pinion's flank; the path goes to the heel with dV
    pair = pair_of(gm.load(BEVEL, ["assembly.dV=0.1"]))
    path = contact_path(solver_pair(pair), np.linspace(-1.0, 1.0, 61) * pair.pitch)
    blank, inside = pair.pinion.tooth.blank, path.kind == "point"
    middle = np.mean(blank.extent)
    length = blank.axial.value(path.point1[inside]).mean() - middle
    row = study.plan.rows(0, 99).index((0.1, 0.0))
    assert study.rows["contact_length_mm"][row] == pytest.approx(length, abs=0.15)
    assert study.rows["path_shift_length_mm"][row] > 2.0
    low, high = (study.rows[f"pattern_length_{end}_mm"][row] for end in ("min", "max"))
    assert blank.extent[0] - middle <= low < length < high <= blank.extent[1] - middle
    assert study.rows["surface_te_peak_to_peak_arcsec"][row] > 0.0


@pytest.mark.sweep
def test_contact_that_goes_on_at_an_edge_adds_nothing_to_the_estimate() -> None:
    """Cubics from a line of contact to an edge rise above it: 270 arcsec where five or six pairs carry without error."""
    wide = {"kind": "cylindrical", "module": 3, "helix_angle": 45, "backlash": 0.1}
    pinion, gear = (
        {"teeth": 3, "face_width": 80, "profile_shift": 0.7},
        {"teeth": 30, "face_width": 70, "profile_shift": -0.1},
    )
    gears = gm.build(gm.parse({**wide, "pinion": pinion, "gear": gear}))
    row = gears.study({"assembly.dz": [0.0]}, record="path,cycle", workers=1).columns
    assert row["mesh_te_peak_to_peak_arcsec"][0] == pytest.approx(0.0, abs=1e-6)
    assert row["mesh_te_estimate_arcsec"][0] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.sweep
def test_estimate_of_crowned_spur_gears_is_that_of_the_cycle() -> None:
    """Without crowning contact is a line up to the tips: cubics made 16 arcsec of nothing, and crowning seemed to help."""
    teeth = {"pinion": {"teeth": 20, "face_width": 6}, "gear": {"teeth": 31, "face_width": 6}}
    contact = {"phi1": {"start": -20, "stop": 20, "count": 15}}
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 2, "backlash": 0.1, "contact": contact, **teeth}))
    vary = {"pinion.modifications.profile_crowning": [0.0, 0.001, 0.004]}
    rows = gears.study(vary, record="path,cycle", workers=1).columns
    exact = rows["mesh_te_peak_to_peak_arcsec"]
    assert exact[2] > 4.0
    assert rows["mesh_te_estimate_arcsec"] == pytest.approx(exact, rel=0.03, abs=1e-6)


@pytest.mark.sweep
def test_what_cannot_be_known_from_the_positions_is_not_told() -> None:
    """Positions that end where the pair still carries say nothing of the gears; a line of contact does not end as points do."""
    for start, stop, inside in ((-3, 3, 21), (-10, 25, 16)):
        gears = gm.build(gm.load(BEVEL, [f"contact.phi1.start={start}", f"contact.phi1.stop={stop}"]))
        narrow = gears.study({"assembly.dV": [0.0]}, record="path", workers=1).columns
        assert narrow["mesh_te_estimate_arcsec"] == narrow["contact_ratio_estimate"] == [None]
        assert narrow["surface_positions"] == [inside]
    helical = gm.build(gm.load(SAMPLES / "helical.toml")).study({"assembly.dx": [0.0, 0.1]}, record="path", workers=1)
    assert helical.columns["contact_ratio_estimate"] == [None, None]


@pytest.mark.sweep
def test_jammed_rows_have_no_transmission_error_with_and_without_fit() -> None:
    design = gm.load(SAMPLES / "spiral_bevel_geometry1.toml", ["contact.phi1.count=3"])
    keys, rows = ("assembly.d_delta",), [(-0.3,), (0.0,)]
    for groups in (("path", "cycle"), ("path", "cycle", "fit")):
        (jammed, _), (free, _) = StudyWork(own_keys(design), keys, 0, groups).figures(rows)
        told = [name for name in jammed if "_te_" in name and name.endswith("_arcsec")]
        assert {"mesh_te_peak_to_peak_arcsec", "mesh_te_harmonic_1_arcsec", "mesh_te_estimate_arcsec"} <= set(told)
        assert np.isnan([jammed[name] for name in told]).all()
        assert np.isfinite(free["mesh_te_peak_to_peak_arcsec"])
        assert ("backlash_min_deg" in jammed) == ("fit" in groups)


@pytest.mark.sweep
def test_a_design_that_fails_is_a_row_with_its_reason() -> None:
    vary = {"pinion.teeth": [25, 2, 4], "assembly.dx": [0.0, 300.0]}
    study = gm.build(gm.load(CROSSED)).study(vary, record="path", workers=1, limits=["converged>0"])
    status = study.columns["status"]
    assert status[0] == "ok"
    assert status[1] == "no contact"
    assert status[2] == status[3] == "failed"
    assert study.columns["reason"][2].startswith("pinion.teeth = 2: allowed is at least 3")
    assert study.columns["converged"][2] is None
    assert study.good == status.count("ok") / 6
    assert len(study.csv().splitlines()) == 7


@pytest.mark.sweep
def test_the_largest_error_is_where_the_criterion_fails() -> None:
    gears = gm.build(gm.load(CROSSED))
    found = gears.largest_errors({"assembly.gamma_h": "0.5"}, ["path_shift_length_mm<0.7", "path_shift_length_mm>-0.6"])
    (row,) = found.ranges
    assert row.low < 0.0 < row.high
    assert {each.fails for each in found.rows} & {"path_shift_length_mm < 0.7", "path_shift_length_mm > -0.6"}
    for each in found.rows:
        if each.fails is None:
            assert abs(each.value) == 0.5
            continue
        # at the value the criterion holds with hardly any room, and does not 1e-6 of the reach beyond
        assert (0.7 if each.fails.endswith("< 0.7") else -0.6) == pytest.approx(each.there, abs=1e-4)
        values = [each.value, each.value + 1e-6 * each.way]
        rows = gears.study({"assembly.gamma_h": values}, record="path", workers=1).rows
        good = (rows["path_shift_length_mm"] < 0.7) & (rows["path_shift_length_mm"] > -0.6)
        assert good.tolist() == [True, False]
        assert rows["path_shift_length_mm"][0] == pytest.approx(each.there, abs=1e-9)
    with pytest.raises(gm.DesignError, match="contact_ratio > 9: the design itself does not meet it"):
        gears.largest_errors(["assembly.dx"], ["contact_ratio>9"])


@pytest.mark.sweep
def test_the_command_writes_tables_and_figures(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    from pyarrow import parquet

    out = tmp_path / "out"
    words = (
        "study",
        CROSSED,
        "--vary",
        "assembly.dx=-100um:100um:2",
        "--vary",
        "assembly.gamma_h=0,0.1",
        "--workers",
        "1",
    )
    words = (*words, "--limit", "contact_ratio>1", "--record", "path,contact_ratio", "-o", out)
    status, text, told = run(*words)
    assert status == 0, told
    assert "Study: 4 rows over assembly.dx, assembly.gamma_h, 4 with contact, yield 100 %" in text
    names = {"patterns.png", "plan.json", "responses.png", "rows.jsonl", "study.csv", "study.json", "study.parquet"}
    assert names <= {file.name for file in out.iterdir()}
    table = parquet.read_table(out / "study.parquet").to_pydict()
    lines = (out / "study.csv").read_text().splitlines()
    heads = lines[0].split(",")
    assert heads == list(table)
    assert heads[:3] == ["row", "assembly.dx", "assembly.gamma_h"]
    assert heads[-3:] == ["contact_ratio", "status", "reason"]
    for k, line in enumerate(lines[1:]):
        for name, cell in zip(heads, line.split(","), strict=True):
            value = table[name][k]
            assert cell == ("" if value is None else str(value))
    assert json.loads((out / "study.json").read_text())["yield"] == 1.0
    before = {name: (out / name).read_bytes() for name in names}
    assert run(*words)[0] == 0
    assert {name: (out / name).read_bytes() for name in names} == before


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "--vary: missing"),
        (["--vary", "assembly.dx"], "--vary .*must look like"),
        (["--vary", "assembly.dx=0,1", "--vary", "assembly.dx=0,1"], "--vary assembly.dx: is given twice"),
        (["--vary", "assembly.dx=0:1:2", "--tolerance", "x=normal:0:1"], "--tolerance: needs sample"),
        (["--sample", "3"], "--sample: needs vary \\(KEY=LOW:HIGH\\) or tolerance"),
        (["--sample", "3", "--vary", "assembly.dx=0,1"], "must be LOW:HIGH"),
        (["--sample", "3", "--tolerance", "none.toml"], "--tolerance none.toml: cannot be read"),
        (["--sample", "3", "--tolerance", "pinion.teeth=uniform:9:12"], "whole numbers can be varied in a grid"),
        (["--vary", "assembly.gamma_h=0,50"], "assembly.gamma_h = 50.0: must be an angle in deg from"),
        (["--vary", "assembly.dx=0,1", "--record", "contact_ration"], "did you mean contact_ratio?"),
        (
            ["--vary", "assembly.dx=0,1", "--record", "path", "--limit", "contact_ratio>1"],
            "contact_ratio>1: not recorded",
        ),
        (["--vary", "assembly.dx=0,1", "--workers", "0"], "--workers = 0: must be"),
        (
            ["--find-limits", "assembly.dx", "--vary", "assembly.dx=0,1"],
            "--find-limits: searches from the design itself and has no rows: it cannot be given together with --vary",
        ),
        (["--find-limits", "assembly.dx", "--workers", "2"], "cannot be given together with --workers"),
        (["--find-limits", "assembly.dx", "--tls-ca-file", "a.pem"], "cannot be given together with --tls-ca-file"),
        (
            ["--find-limits", "assembly.dx", "-o", "limits"],
            "-o = limits: --find-limits writes no folder: its table is printed, and --json FILE writes it",
        ),
        (["--vary", "assembly.dx=0,1", "--method", "sobol"], "--method = sobol: needs sample"),
        (["--vary", "assembly.dx=0,1", "--level", "quick"], "--level = quick: is for figures under load"),
        (["--find-limits", "pinion.teeth"], "--find-limits pinion.teeth: must be a key of real numbers"),
        (
            ["--find-limits", "assembly.dx=-1"],
            "--find-limits assembly.dx = -1: must be above 0",
        ),
    ],
)
@pytest.mark.sweep_cases(
    "words11---workers = 0: must be", "words10-contact_ratio>1: not recorded", "words9-did you mean contact_ratio?"
)
def test_what_the_command_cannot_do_is_one_line(words: list[str], said: str) -> None:
    assert re.search(said, refused("study", CROSSED, *words))


def test_a_design_without_contact_is_refused() -> None:
    with pytest.raises(NoSolutionError, match="the design itself"):
        gm.build(gm.load(CROSSED, ["assembly.dx=300"])).study({"assembly.dy": [0.0]}, workers=1)


@pytest.mark.parametrize("rounding", [1e-16, -1e-16])
def test_estimates_do_not_depend_on_rounding_where_tooth_pairs_are_level(rounding: float) -> None:
    """Conjugate flanks: every tooth pair is as far ahead as its neighbours, at the first and last position too."""
    phi1 = np.linspace(-1.5, 1.5, 31)
    level, seen = np.zeros((1, 31)), np.ones((1, 31), dtype=bool)
    advance = level.copy()
    advance[0, [0, -1]] = rounding
    none = np.full((1, 31, 3), np.nan)
    paths = AssemblyPaths(
        phi1, seen, seen, seen, advance, level, level, none, np.stack((none, none), axis=-2), level[..., None]
    )
    assert np.isfinite(gears_advance(paths, 1.0)).all()


@pytest.mark.sweep
def test_the_pattern_shifts_from_the_nominal_assembly() -> None:
    """Errors of assembly that the design itself sets count, too; places are those of tooth contact analysis."""
    own = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml", ["assembly.dV=0.05"]))
    study = own.study({"assembly.dV": "0,0.05"}, record=("path",), workers=1)
    shift, centre = (study.rows[f"pattern_{what}_percent"] for what in ("shift_face", "centre_face"))
    assert shift == pytest.approx([0.0, centre[1] - centre[0]])
    assert shift[1] > 5.0
    assert study.nominal["pattern_shift_face_percent"] == pytest.approx(shift[1])
    assert study.nominal["path_shift_length_mm"] == 0.0
    pinion = own.contact().patterns[0]
    assert centre[1] == pytest.approx(pinion.centre_face, abs=0.5)
    assert study.rows["pattern_length_percent"][1] == pytest.approx(pinion.length, abs=1.0)


@pytest.mark.parametrize("option", ["--torque", "--level", "--scheduler", "--tls-ca-file"])
def test_options_of_gear_sets_are_refused_for_trains(option: str) -> None:
    values = {"--torque": "10", "--level": "quick", "--scheduler": "tcp://127.0.0.1:1", "--tls-ca-file": "a.pem"}
    said = refused("study", SAMPLES / "trains" / "train_two_stage.toml", option, values[option])
    assert f"{option}: is for studies of one gear set" in said
