"""Optimisations: closed forms, a dense grid, fronts, limits, errors; the command, killed and gone on with."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.command_line import messages, refused, run
from oracles.constant_stiffness import BEST_RELIEF_UM, peak_to_peak, replace_work, replace_work_by_exact_flanks
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import NoSolutionError
from gearmesh.optimize.lockstep import Ask, in_lockstep

SMALL = """# a small pair
kind = "cylindrical"
module = 2   # mm
units = "mm"

[pinion]
teeth = 20
face_width = "6mm"   # narrow

[gear]
teeth = 31
face_width = 6

[contact]
phi1 = { start = -20, stop = 20, count = 15 }
"""
MODIFIED = "pinion.modifications."
RELIEF, START = f"{MODIFIED}tip_relief.amount", f"{MODIFIED}tip_relief.start_diameter"
CROWNING, SLOPE, TWIST = (f"{MODIFIED}{name}" for name in ("profile_crowning", "profile_slope", "profile_twist"))
#: key of a figure
KEY = "mesh_te_estimate_arcsec"
#: a figure whose name stands for the value of the model
FIGURE, OTHER, THIRD = "mesh_te_estimate", "contact_length", "contact_height"


@pytest.fixture(scope="module")
def gears() -> gm.Gears:
    return gm.build(gm.parse(tomllib.loads(SMALL)))


def optimum(gears: gm.Gears, vary: dict[str, Any], minimize: Any = FIGURE, **more: Any) -> gm.Optimum:
    return gears.optimize(vary, minimize, **{"workers": 1, **more})


def test_long_relief_of_constant_stiffness_is_found(gears: gm.Gears, monkeypatch: pytest.MonkeyPatch) -> None:
    """Closed form: F / c; 60 designs at most, with those of the sensitivities, and every seed agrees."""
    calls = replace_work(monkeypatch, lambda amount: (peak_to_peak(1e3 * amount),))
    for seed in range(4):
        calls.clear()
        found = optimum(gears, {RELIEF: "0:40um"}, budget=50, seed=seed)
        assert 1e3 * found.values[RELIEF] == pytest.approx(BEST_RELIEF_UM, rel=0.02)
        assert len(calls) <= 60
    assert {(each.key, each.changed) for each in found.sensitivities} == {(RELIEF, FIGURE)}
    # beyond the optimum the transmission error grows by half the relief, 5 % of 40 um
    assert found.sensitivities[0].high == pytest.approx(found.sensitivities[0].best + 1.0, abs=0.1)


@pytest.mark.sweep
def test_long_reliefs_of_exact_spur_flanks_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both tips with reliefs over the whole double contact, tooth pairs of constant stiffness: F / c on both, TE 0."""
    module, teeth = 2.0, (20, 31)
    cosine, sine = math.cos(math.radians(20.0)), math.sin(math.radians(20.0))
    # ends of the path of contact, from the pitch point
    tip = [math.sqrt((0.5 * module * (z + 2.0)) ** 2 - (0.5 * module * z * cosine) ** 2) for z in teeth]
    beyond = [length - 0.5 * module * z * sine for length, z in zip(tip, teeth, strict=True)]
    pitch = math.pi * module * cosine
    double = sum(beyond) - pitch
    tables = {
        name: {
            "teeth": z,
            "face_width": 6,
            "modifications": {"tip_relief": {"amount": 0.005, "start_roll_length": length - double}},
        }
        for name, z, length in zip(("pinion", "gear"), teeth, tip, strict=True)
    }
    positions = {"phi1": {"start": -22.5, "stop": 22.5 - 1.8, "count": 25}}
    design = gm.parse({"kind": "cylindrical", "module": module, **tables, "contact": positions})
    replace_work_by_exact_flanks(monkeypatch)
    keys = [f"{name}.modifications.tip_relief.amount" for name in tables]
    found = gm.build(design).optimize(dict.fromkeys(keys, "1um:30um"), FIGURE, budget=56, workers=1)
    assert len(found.to_dict()["evaluation"]) <= 60
    for key in keys:
        assert 1e3 * found.values[key] == pytest.approx(BEST_RELIEF_UM, rel=0.02)
    assert found.summary.best.objectives[FIGURE] < 0.03 * found.summary.before.objectives[FIGURE]


def test_optimum_equals_that_of_a_dense_grid(gears: gm.Gears, monkeypatch: pytest.MonkeyPatch) -> None:
    """Relief and its length: the mean over two torques has a valley with kinks, here by a second route."""

    def mean(amount: float, start_diameter: float) -> float:
        # half the force needs half the relief
        return peak_to_peak(1e3 * amount, start_diameter - 40.0) + 0.5 * peak_to_peak(
            2e3 * amount, start_diameter - 40.0
        )

    replace_work(monkeypatch, lambda **keys: (mean(**keys),))
    grid = [mean(a, s) for a in np.linspace(0.002, 0.04, 77) for s in np.linspace(40.2, 41.4, 61)]
    values = []
    for seed in range(3):
        found = optimum(gears, {RELIEF: "2um:40um", START: "40.2:41.4"}, budget=120, seed=seed)
        values.append(found.summary.best.objectives[FIGURE])
    assert max(values) <= 1.01 * min(grid)
    # random restarts agree
    assert max(values) <= 1.03 * min(values)


def test_limits_are_kept_and_failures_are_data(gears: gm.Gears, monkeypatch: pytest.MonkeyPatch) -> None:
    """The minimum of a sum of squares at the nearest point of a line, with a quarter of the range that fails."""

    def circle(profile_crowning: float, profile_slope: float) -> tuple[float, float]:
        x, y = 1e2 * profile_crowning, 1e2 * profile_slope
        if x < 0.0 and y < 0.0:
            raise ArithmeticError("tip pointed")
        return x * x + y * y, x + y

    replace_work(monkeypatch, circle)
    found = optimum(gears, {CROWNING: "-10um:20um", SLOPE: "-10um:20um"}, subject=[f"{OTHER}>2"], budget=80)
    x, y = (1e2 * value for value in found.values.values())
    assert found.feasible
    assert x + y > 2.0
    assert [x, y] == pytest.approx([1.0, 1.0], abs=0.03)
    assert list(found.failures) == ["tip pointed"]
    columns = found.to_dict()
    assert all((value is None) == bool(why) for value, why in zip(columns[FIGURE], columns["reason"], strict=True))
    assert not found.complaints
    never = optimum(gears, {CROWNING: "-10um:20um", SLOPE: "-10um:20um"}, subject=[f"{OTHER}>9"], budget=40)
    assert not never.feasible
    assert never.complaints[0].startswith(f"no design keeps all limits; the nearest one misses {OTHER}>9 (")
    with pytest.raises(NoSolutionError, match=r"all \d+ designs of the first sample failed: tip pointed"):
        optimum(gears, {CROWNING: "-10um:-2um", SLOPE: "-10um:-2um"}, budget=20)


@pytest.mark.quick
def test_fronts_are_those_of_the_closed_form(gears: gm.Gears, monkeypatch: pytest.MonkeyPatch) -> None:
    """Distances from two points: the front is the segment between them; from three points the triangle."""

    def distances(profile_crowning: float, profile_slope: float) -> tuple[float, ...]:
        x, y = 1e2 * profile_crowning, 1e2 * profile_slope
        return math.hypot(x, y), math.hypot(x - 1.0, y), math.hypot(x, y - 1.0)

    vary = {CROWNING: "-10um:20um", SLOPE: "-10um:20um"}
    replace_work(monkeypatch, lambda **keys: distances(**keys)[:2])
    two = optimum(gears, vary, [FIGURE, OTHER], budget=150)
    front = np.array([list(each.objectives.values()) for each in two.summary.front])
    assert len(front) >= 12
    assert (np.diff(front[:, 0]) > 0.0).all()
    assert (np.diff(front[:, 1]) < 0.0).all()
    assert (np.quantile(front.sum(axis=1), 0.8) - 1.0) < 0.05
    assert front.min(axis=0) == pytest.approx([0.0, 0.0], abs=0.05)
    # the chosen design is between both ends
    assert list(two.summary.best.objectives.values()) == pytest.approx([0.5, 0.5], abs=0.1)
    assert len(two.front) == len(front)
    assert two.front[0].pinion.modifications.profile_crowning == two.summary.front[0].values[CROWNING]
    # where a small search ends beside the front, a design that is evaluated for sensitivities may be better in both
    surpassed = []
    for seed in range(6):
        few = optimum(gears, vary, [FIGURE, OTHER], budget=12, seed=seed)
        best, every = few.summary.best.objectives, few.to_dict()
        better = np.all([np.array(every[name]) < best[name] for name in (FIGURE, OTHER)], axis=0)
        assert better.any() == any("needs a larger budget" in line for line in few.complaints)
        surpassed.append(better.any())
    assert sum(surpassed) <= 2
    replace_work(monkeypatch, lambda **keys: distances(**keys))
    three = optimum(gears, vary, [FIGURE, OTHER, THIRD], budget=150)
    for k, each in enumerate(np.array([list(each.objectives.values()) for each in three.summary.front]).min(axis=0)):
        assert each < 0.1, k


def test_rounding_ranks_no_designs(gears: gm.Gears, monkeypatch: pytest.MonkeyPatch) -> None:
    """A figure that only rounding changes makes no front, and numbers of teeth beside the best design are looked at."""

    def figures(profile_crowning: float, teeth: float) -> tuple[float, ...]:
        noise = math.sin(1e7 * profile_crowning + teeth)
        return 1e2 * profile_crowning, 0.8238466 + 1e-13 * noise, 1e-12 * noise + 1e-3 * (23.0 - teeth)

    replace_work(monkeypatch, lambda **keys: figures(*keys.values()))
    vary = {CROWNING: "0:20um", "pinion.teeth": "21:23"}
    found = optimum(gears, vary, [FIGURE, OTHER, THIRD], budget=40, method="evolution")
    assert found.values == {CROWNING: 0.0, "pinion.teeth": 23}
    assert len(found.front) == 1
    assert {each.low_value for each in found.sensitivities if each.key == "pinion.teeth"} == {22.0}
    shown = found.listings[1].rows
    assert [row[2] for row in shown] == [0.0, pytest.approx(0.8238466), 0.0]


def test_errors_count_as_asked(gears: gm.Gears, monkeypatch: pytest.MonkeyPatch) -> None:
    """A narrow deep valley beside a wide flat one: over errors of the varied key the wide one is better."""

    def valleys(profile_crowning: float) -> tuple[float]:
        x = 1e3 * profile_crowning
        return (min(8.0 * abs(x - 2.0), 1.0 + abs(x - 10.0)),)

    replace_work(monkeypatch, valleys)
    vary = {CROWNING: "0:20um"}
    assert 1e3 * optimum(gears, vary, budget=60).values[CROWNING] == pytest.approx(2.0, abs=0.02)
    worst = optimum(gears, vary, KEY, budget=60, robust={CROWNING: "-1um,0,2um"}, robust_by="worst")
    # the largest of 1 + |x - 11|, 1 + |x - 10|, 1 + |x - 8| is least at 9.5
    assert 1e3 * worst.values[CROWNING] == pytest.approx(9.5, abs=0.1)
    assert worst.summary.best.objectives[KEY] == pytest.approx(2.5, abs=0.05)
    # the table has what counts, and the mean beside it
    columns = worst.to_dict()
    assert min(columns[KEY]) == worst.summary.best.objectives[KEY]
    assert all(mean <= most for mean, most in zip(columns[f"{KEY}_mean"], columns[KEY], strict=True))
    drawn = optimum(gears, vary, budget=60, robust={CROWNING: "normal:0:1um"}, robust_by="mean+2sigma", robust_rows=8)
    assert 1e3 * drawn.values[CROWNING] == pytest.approx(10.0, abs=0.7)


def test_whole_numbers_and_lists_are_evolved(gears: gm.Gears, monkeypatch: pytest.MonkeyPatch) -> None:
    def steps(teeth: int, shape: str, amount: float) -> tuple[float]:
        assert isinstance(teeth, int)
        return ((teeth - 26) ** 2 + (0.0 if shape == "circular" else 4.0) + abs(1e3 * amount - 7.0),)

    replace_work(monkeypatch, steps)
    found = optimum(
        gears,
        {"pinion.teeth": "18:40", f"{MODIFIED}tip_relief.shape": "linear,parabolic,circular", RELIEF: "1um:20um"},
        budget=200,
    )
    assert found.method == "evolution"
    assert list(found.values.values())[:2] == [26, "circular"]
    assert 1e3 * found.values[RELIEF] == pytest.approx(7.0, abs=1.0)


@pytest.mark.quick
def test_searches_side_by_side_ask_in_rounds() -> None:
    """The order of the questions does not depend on the threads; an error in one of them ends all."""
    rounds: list[list[int]] = []

    def search(number: int) -> Any:
        def run_search(ask: Ask) -> None:
            for step in range(number + 1):
                assert ask([10 * number + step, -1]) == [100 * number + 10 * step, -10]

        return run_search

    in_lockstep([search(0), search(1), search(2)], lambda asked: rounds.append(asked) or [10 * each for each in asked])
    assert rounds == [[0, -1, 10, -1, 20, -1], [11, -1, 21, -1], [22, -1]]
    in_lockstep([search(2)], lambda asked: None)

    def broken(ask: Ask) -> None:
        ask([1])
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        in_lockstep([search(1), broken], lambda asked: [10 * each for each in asked])


WORDS = (
    "--vary",
    f"{CROWNING}=2um:12um",
    "--minimize",
    FIGURE,
    "--budget",
    "6",
    "--workers",
    "1",
    "--no-pictures",
    "--no-report",
)


@pytest.mark.sweep
def test_command_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    """The same bytes of twice the same command, of a stopped one, and of one whose designs another objective had found."""
    design, out = tmp_path / "small.toml", tmp_path / "out"
    design.write_text(SMALL)
    words = ("optimize", design, *WORDS, "-o", out)
    status, table, err = run(*words)
    # crowning makes the transmission error of a pair without other modifications larger
    assert (status, messages(err)) == (0, f"gearmesh: warning: {CROWNING} = 0.002 is at the end of its range\n")
    assert FIGURE in table
    assert CROWNING in table
    best = (out / "best.toml").read_text()
    # comments and spelling stay, one table is new
    value = json.loads((out / "optimum.json").read_text())["best"]["values"][CROWNING]
    assert best == f"{SMALL}\n[pinion.modifications]\nprofile_crowning = {value}\n"
    assert gm.load(out / "best.toml").pinion.modifications.profile_crowning == value
    files = {name: (out / name).read_bytes() for name in ("best.toml", "optimum.csv", "optimum.json")}
    kept = (out / "rows.jsonl").read_bytes().splitlines(keepends=True)
    assert len(kept) >= 6
    (out / "rows.jsonl").write_bytes(b"".join(kept[:4]) + kept[4][:-9])
    assert run(*words)[0] == 0
    assert (out / "rows.jsonl").read_bytes().splitlines(keepends=True) == kept
    for name, text in files.items():
        assert (out / name).read_bytes() == text, name
    assert refused(*words, "--set", "pinion.teeth=21") == (
        f"{out}: holds another study (design, plan, record or version differ); name another folder"
    )


@pytest.mark.sweep
def test_bevel_pattern_stays_off_all_edges_in_a_wider_box() -> None:
    """Exact mesh cycles at the corners of a box of errors: contact of a tooth pair over a pitch, and changes without edges."""
    keys = ("assembly.dV", "assembly.dA", "assembly.dG")

    def corners(gears: gm.Gears, size: float) -> gm.Study:
        return gears.study({key: [-size, size] for key in keys}, record="contact_ratio,te_breaks", workers=1)

    def worst(gears: gm.Gears, size: float) -> gm.Study:
        vary = {key: [sign * size] for key, sign in zip(keys, (-1.0, 1.0, -1.0), strict=True)}
        return gears.study(vary, record="contact_ratio,te_breaks", workers=1)

    gears = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml"))
    # today the contact ratio is above 1 up to 0.115 mm, and tooth pairs change over without edges up to 0.009 mm
    assert (worst(gears, 0.0125).numbers("te_breaks") > 0).all()
    assert (worst(gears, 0.12).numbers("contact_ratio") < 1.0).all()
    found = gears.optimize(
        {"pinion.concave.semi_major_axis": "2.5:8", "pinion.concave.te_at_change": "5:60"},
        maximize="contact_ratio_estimate",
        robust=dict.fromkeys(keys, "-0.18,0.18"),
        robust_by="worst",
        budget=12,
        workers=1,
    )
    best = gm.build(found.best_design)
    assert (corners(best, 1.5 * 0.12).numbers("contact_ratio") > 1.0).all()
    assert (corners(best, 1.5 * 0.0125).numbers("te_breaks") == 0).all()


@pytest.mark.parametrize(
    ("more", "line"),
    [
        (["--minimize", "te_peek_to_peak"], "--minimize te_peek_to_peak: no figure of this name; there are "),
        (["--minimize", "te_peek_to_peak@10"], "did you mean te_peak_to_peak?"),
        (["--minimize", "max_pressure"], "max_pressure is under load: needs torques, as max_pressure@100"),
        (["--minimize", "mesh_te_estimate@10"], "mesh_te_estimate is without load: leave out the torques"),
        (["--minimize", "max_pressure@0"], "behind @ must be torques on the pinion in Nm"),
        (["--minimize", "max_pressure@1:median"], "must be FIGURE[@NM,NM...][:mean|max]"),
        (["--minimize", "contact_height", "--subject", "contact_ratio"], "--subject contact_ratio: must look like"),
        (["--minimize", "contact_height", "--subject", "contact_rate>1"], "--subject contact_rate>1: no figure"),
        (["--minimize", "contact_height", "--budget", "3"], "--budget = 3: must be a number of designs from 6 to"),
        (["--minimize", "contact_height", "--budget", "2 days"], "--budget = 2 days: must be a number of designs"),
        (["--minimize", "contact_height", "--robust-by", "median"], "--robust-by = median: must be worst, mean or"),
        (["--minimize", "contact_height", "--robust", "assembly.dx=gauss:0:1"], "--robust assembly.dx = gauss:0:1: must"),
        (["--minimize", "contact_height", "--robust", "assembly.dx=1,2", "--robust", "assembly.dy=normal:0:1um"],
         "--robust assembly.dy: lists A,B,C (assembly.dx) and distributions cannot be given together"),
        (["--minimize", "contact_height", "--method", "simplex"], "--method = simplex: must be one of cobyqa, evolution"),
        (["--minimize", "contact_height", "--vary", "pinion.teeth=18:30", "--method", "cobyqa"], "pinion.teeth is none"),
        (["--minimize", "contact_height", "--vary", "pinion.tooth=18:30"], "did you mean pinion.teeth?"),
        (["--minimize", "contact_height", "--vary", "gear.modifications.helix_slope=2um:1um"], "HIGH above LOW"),
        ([], "--minimize: missing; give a figure"),
    ],
)  # fmt: skip
def test_wrong_input_is_one_line(tmp_path: Path, more: list[str], line: str) -> None:
    design = tmp_path / "small.toml"
    design.write_text(SMALL)
    said = refused("optimize", design, "--vary", f"{CROWNING}=2um:12um", *more, "-o", tmp_path / "out")
    assert line in said
    assert not (tmp_path / "out").exists()


@pytest.mark.sweep
def test_the_full_level_confirms_what_the_quick_one_finds(gears: gm.Gears) -> None:
    """Crowning under load with the quick level: the result has figures of both levels, within 3 %, and the full one decides."""
    found = optimum(gears, {CROWNING: "0:20um"}, "te_peak_to_peak@40", budget=6, level="quick")
    quick, full = found.summary.best, found.summary.confirmed[1]
    (name,) = quick.objectives
    assert quick.values == full.values
    assert full.objectives[name] != quick.objectives[name]
    assert full.objectives[name] == pytest.approx(quick.objectives[name], rel=0.06)
    assert [row[0] for row in found.listings[1].rows] == [name]
    assert len(found.listings[1].rows[0]) == 5
    assert found.feasible
