"""Public calls take what their annotations say, and refuse everything else in one line; answers go to other processes and back."""

from __future__ import annotations

import contextlib
import functools
import inspect
import json
import multiprocessing
import os
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import OutputError, pickling
from gearmesh.arguments import checks_arguments
from gearmesh.errors import ArgumentError
from gearmesh.kinds import Side

#: a narrow pair and coarse elements: answers in a moment
SMALL: dict[str, Any] = {
    "kind": "cylindrical",
    "module": 2,
    "pinion": {"teeth": 20, "face_width": 6},
    "gear": {"teeth": 31, "face_width": 6},
    "contact": {"phi1": {"count": 3}},
    "mesh": {"tolerance": 0.02},
    "fe": {"teeth": 1, "flank": 5, "fillet": 4, "thickness": 2, "face": 4, "torque": 10},
}
#: what computes
WORK = tuple(f"gearmesh{os.sep}{part}{os.sep}" for part in ("kernel", "contact", "mesh", "loaded", "fe"))
WRONG = (None, [], "x", -1, 1j, object())


@functools.cache
def small_study() -> gm.Study:
    """A study of two rows."""
    return gm.build(gm.parse(SMALL)).study({"assembly.dx": "0:0.01:2"})


#: what verbs need beside the argument that is wrong; a function gives it when it is needed
NEEDED: dict[str, tuple[Any, ...]] = {
    "with_deviations": ("pinion", "left", [[0, 0], [0, 0]]),
    "with_teeth_like": ("pinion", 1),
    "compare": (lambda: gm.build(gm.parse(SMALL)),),
    "correct": ("pinion",),
    "drawing": ("pinion",),
    "dynamics": ([10.0],),
    "evaluate": ("pinion",),
    "finite_element_decks": (".", [0.0]),
    "largest_errors": (["assembly.dx"],),
    "loaded_contact": (10.0, [0.0]),
    "measuring_grid": ("pinion",),
    "member": ("pinion",),
    "optimize": ({"pinion.modifications.profile_crowning": "1um:9um"}, "mesh_te_estimate"),
    "part": ("pinion",),
    "place": ({},),
    "places_at": (0.0,),
    "run": ("out",),
    "save_pictures": (small_study, "pictures"),
    "section": ("pinion",),
    "solid": ("pinion",),
    "theoretical_chart": ("pinion",),
    "topography": ("pinion",),
    "toolpath": ("pinion", "ball:1mm", "20um"),
    "within": (None,),
    "check_solved": ({}, {}),
    "gear": (20,),
    "size": (2.0, 64.0, 2.0),
    "size_planetary": (4.0,),
    "load": (SAMPLES / "helical.toml",),
    "load_train": (SAMPLES / "trains" / "train_two_stage.toml",),
    "load_rexs": ("x.rexs",),
    "new": ("rack",),
    "parse": (SMALL,),
    "toml": ({},),
}
VERBS = (
    *(
        "build",
        "gear",
        "load",
        "load_rexs",
        "load_train",
        "new",
        "parse",
        "prove",
        "register",
        "size",
        "size_planetary",
    ),
    *("system", "toml"),
)
METHODS = [name for name, _ in inspect.getmembers(gm.Gears, inspect.isfunction) if not name.startswith("_")]


@pytest.fixture(scope="module")
def gears() -> gm.Gears:
    return gm.build(gm.parse(SMALL))


def call(gears: gm.Gears, verb: str, parameter: str, wrong: Any) -> Any:
    """A verb with one argument that is wrong."""
    function = getattr(gm, verb) if verb in VERBS else getattr(gears, verb)
    needed = (of() if callable(of) else of for of in NEEDED.get(verb, ()))
    given = inspect.signature(function).bind_partial(*needed)
    if verb == "gear":
        given.arguments["module"] = 1
    if verb == "optimize":
        given.arguments.update(budget=6, workers=1)
    given.arguments[parameter] = wrong
    return function(*given.args, **given.kwargs)


def parameters(verb: str) -> list[inspect.Parameter]:
    function = getattr(gm, verb) if verb in VERBS else getattr(gm.Gears, verb)
    return [one for one in inspect.signature(function).parameters.values() if one.name != "self"]


def test_all_public_verbs_check_their_arguments() -> None:
    names = [name for name in gm.__all__ if inspect.isfunction(getattr(gm, name)) and parameters_of(getattr(gm, name))]
    assert sorted(names) == sorted(VERBS)
    assert len(METHODS) > 35
    for function in (*(getattr(gm.Gears, name) for name in METHODS), *(getattr(gm, n) for n in VERBS if n != "system")):
        assert function.__code__ is checks_arguments(lambda: None).__code__, function  # type: ignore[attr-defined]

    for name in METHODS:
        every = inspect.signature(getattr(gm.Gears, name))
        needed = {one.name for one in every.parameters.values() if one.default is one.empty}
        missing = needed - {*every.bind_partial(None, *NEEDED.get(name, ())).arguments}
        assert not missing or missing == {*every.parameters} - {"self"}, f"NEEDED lacks arguments of {name}: {missing}"


def parameters_of(function: Callable[..., Any]) -> list[str]:
    return list(inspect.signature(function).parameters)


@pytest.mark.parametrize("verb", [*METHODS, *VERBS])
@pytest.mark.sweep_cases("save_pictures")
def test_no_verb_takes_an_object_or_a_complex_number(gears: gm.Gears, verb: str) -> None:
    """No annotation allows these, but that of values to be written."""
    for one in parameters(verb):
        for wrong in (1j, object(), [object()]):
            with pytest.raises(gm.DesignError) as failure:
                call(gears, verb, one.name, wrong)
            assert failure.value.key in (one.name, "kind")
            assert "\n" not in str(failure.value)
            pickle.loads(pickle.dumps(failure.value))


@pytest.mark.sweep
@pytest.mark.parametrize("verb", [*METHODS, *VERBS])
def test_wrong_arguments_are_refused_or_give_a_result(
    gears: gm.Gears, verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for one in parameters(verb):
        for wrong in WRONG:
            if wrong is one.default:
                continue
            with contextlib.suppress(gm.GearmeshError):
                call(gears, verb, one.name, wrong)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda g: g.contact(pair=5), "pair = 5: must be 0, or one of pinion-gear"),
        (lambda g: g.contact(pair=-1), "pair = -1: must be 0, or one of pinion-gear"),
        (lambda g: g.study({"assembly.dx": []}), "vary assembly.dx: no values; must be one value at least"),
        (lambda g: g.study({"assembly.dx": -1}), "vary assembly.dx = -1: must be a text or a sequence of "),
        (lambda g: gm.size(None, 64, 2), "ratio: must be a number"),
        (lambda g: gm.parse(None), "mapping: must be a mapping of texts to values: gm.load reads files"),
        (lambda g: gm.load(None), "path: must be a path"),
        (
            lambda g: g.with_deviations("pinion", "left", [[1, 2], [1]]),
            "values = [[1, 2], [1]]: must be a number or an ",
        ),
        (lambda g: g.with_deviations("pinion", "left", 1j * np.ones((3, 3))), "values = array([[0.+1.j, 0.+1.j"),
        (lambda g: g.contact(torque="5"), "torque = 5: must be a number or None"),
        (lambda g: g.animation(size=(1, 2, 3)), "size = (1, 2, 3): must be 2 whole numbers"),
        (lambda g: g.loaded_contact(5, mounts={"pinion": 3}), "mounts pinion = 3: must be a FlexibleMount"),
        (lambda g: g.roll(g.design), "contact = "),
        (lambda g: g.solid("pinion", teeth=-1), "teeth = -1: must be a whole number from 1 to 20"),
        (lambda g: g.finite_elements(members=[]), "members = []: must be members of the pair pinion-gear"),
        (lambda g: g.loaded_contact(5.0, []), "phi1 = []: must be one position at least, deg"),
        (lambda g: g.largest_errors(["assembly.dx"], []), "criteria = []: must be one limit at least"),
        (lambda g: gm.build({"kind": "rack"}), "design = {'kind': 'rack'}: must be a Design"),
    ],
)
def test_calls_that_ended_in_bare_errors(gears: gm.Gears, ask: Callable[[gm.Gears], Any], message: str) -> None:
    with pytest.raises(ArgumentError) as failure:
        ask(gears)
    assert str(failure.value).startswith(message)


class _WorkError(Exception):
    """Something was computed."""


def _at_work(frame: Any, event: str, _: object) -> None:
    """Stop what computes: evaluates surfaces, looks for contact, makes meshes."""
    code = frame.f_code
    refuses = code.co_name == "<module>" or code.co_name.startswith("refuse")
    if event == "call" and not refuses and any(part in code.co_filename for part in WORK):
        raise _WorkError(code.co_filename)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda g: g.contact(torque=-1), "torque = -1 Nm: allowed is a finite number above 0"),
        (lambda g: g.report(torque=-1), "torque = -1 Nm: must be one or more finite numbers above 0"),
        (lambda g: g.report(tolerance=0), "tolerance = 0: must be a length as "),
        (lambda g: g.report(studies=["nowhere"]), "study = nowhere: holds no finished study"),
        (lambda g: g.run("out", torque=[5.0, 0.0]), "torque = 0 Nm: must be one or more finite numbers above 0"),
        (lambda g: g.animation(size=(0, 0)), "size = 0,0: must be width and height in pixels, each from 16 to 16384"),
        (lambda g: g.picture("te", size=(-1, 100)), "size = -1,100: must be width and height in pixels, each from 16"),
        (lambda g: g.finite_elements(np.inf), "phi1 = inf: must be finite numbers in deg"),
        (lambda g: g.finite_element_decks("out", []), "phi1 = []: must be one position at least, deg"),
        (lambda g: g.finite_element_decks("out", [0.0], program="x"), "program = x: must be calculix or abaqus"),
        (lambda g: g.picture("contact", phi1=[]), "phi1 = []: must be one position at least, deg"),
        (lambda g: g.animation(phi1=[]), "phi1 = []: must be one position at least, deg"),
        (lambda g: g.contact(range(10**8)), "phi1 = 100000000 positions: must be 100000 positions at most"),
        (lambda g: g.contact(1e300), "phi1 = 1e+300: must be a finite number of degrees, 1e+09 either way at most"),
        (lambda g: g.loaded_contact(1e-300), "torque = 1e-300 Nm: allowed is from 1e-09 to 1e+12 Nm"),
        (lambda g: g.picture("te", dpi=-1), "dpi = -1: must be a whole number from 20 to 1200"),
        (lambda g: g.finite_elements(rotation=1e9), "rotation = 1e+09: must be above 0 and up to 1 deg"),
        (lambda g: g.measuring_grid("pinion", ball=1e9), "ball = 1e+09 mm: allowed is a diameter above 0 and up to"),
        (lambda g: g.contact([]), "phi1 = []: must be one position at least, deg"),
        (lambda g: g.largest_errors(["assembly.dx"], torque=-1), "torque = -1 Nm: must be one or more finite numbers"),
        (lambda g: g.largest_errors({"assembly.dx": -1}), "find_limits assembly.dx = -1: must be above 0"),
        (lambda g: g.study({"assembly.dx": "0:1:2"}, workers=0), "workers = 0: must be a whole number above 0"),
        (lambda g: g.study({"assembly.dx": "0:1:2"}, limits=["x"]), "limit x: must look like"),
        (lambda g: g.sheet(speed=5), "speed = 5: needs a torque"),
        (lambda g: g.compensate("x"), "kind = cylindrical: has no compensating settings"),
    ],
)
def test_arguments_are_refused_before_anything_is_computed(
    gears: gm.Gears, ask: Callable[[gm.Gears], Any], message: str
) -> None:
    with contextlib.suppress(gm.GearmeshError):
        # modules are loaded once
        ask(gears)
    sys.setprofile(_at_work)
    try:
        with pytest.raises(gm.GearmeshError) as failure:
            ask(gears)
    finally:
        sys.setprofile(None)
    assert str(failure.value).startswith(message)


def test_numbers_of_numpy_are_numbers(gears: gm.Gears) -> None:
    assert gears.within(np.float32(0.5)) == 0.5
    path = gears.contact(np.array([0.0]), pair=np.int64(0), cycle=np.bool_(False)).path  # type: ignore[arg-type]
    assert path.touching.tolist() == [True]
    with pytest.raises(ArgumentError, match=r"^pair = True: must be"):
        gears.contact(pair=True)


# ---------------------------------------------------------------- other processes


def figures_of(answer: gm.Result) -> str:
    return json.dumps(answer.document(), sort_keys=True)


@pytest.mark.parametrize(
    "sample",
    [
        "helical",
        "rack",
        "face_gear",
        "hypoid_measured",
        "novikov",
        "worm_drive",
        "straight_bevel",
        "cycloidal",
        "spline",
    ],
)
@pytest.mark.sweep_cases("hypoid_measured", "cycloidal", "spline")
def test_gears_pickle(sample: str) -> None:
    """Every way to make a surface gives the same answers afterwards, to the last digit."""
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    other = pickle.loads(pickle.dumps(gears))
    assert repr(other.design.plain()) == repr(gears.design.plain())
    for name, member in gears.members.items():
        shares = np.linspace(0.2, 0.8, 3)
        mine, theirs = (one.one_tooth.flank_grid(Side.RIGHT, shares, shares) for one in (member, other.members[name]))
        assert np.isfinite(mine.points).all()
        assert np.array_equal(theirs.points, mine.points)


def test_answers_pickle_with_all_that_they_are_made_of(gears: gm.Gears) -> None:
    contact = gears.contact([0.0, 4.0], torque=5.0)
    again = pickle.loads(pickle.dumps(contact))
    assert figures_of(again) == figures_of(contact)
    # and it still answers
    assert np.array_equal(again.backlash(3).phi1, contact.backlash(3).phi1)
    real = gears.with_deviations("pinion", "left", 0.002 * np.eye(3))
    te = (one.contact([0.0], cycle=False).path.te.tolist() for one in (real, pickle.loads(pickle.dumps(real))))
    assert next(te) == next(te)
    solid = gears.solid("pinion", 0.1)
    other = pickle.loads(pickle.dumps(solid))
    assert figures_of(other) == figures_of(solid)
    assert np.array_equal(other.mesh.vertices, solid.mesh.vertices)


def first_te(gears: gm.Gears) -> tuple[gm.Gears, list[float]]:
    """Return the gears, and their transmission errors, rad, at phi1 = 0 and 5 deg: the function that a worker process runs."""
    return gears, gears.contact([0.0, 5.0], cycle=False).path.te.tolist()


@pytest.mark.sweep
def test_gears_go_to_workers_and_back(gears: gm.Gears) -> None:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        back, te = pool.apply(first_te, (gears,))
    assert te == first_te(gears)[1] == first_te(back)[1]


def test_bytes_of_another_version_are_refused() -> None:
    with pytest.raises(OutputError, match=r"made by gearmesh 0.1.0; this is .*, which cannot read it"):
        pickling.from_bytes("0.1.0", pickling.as_bytes(1))


def test_functions_that_lead_to_themselves_pickle() -> None:
    def count(n: int, more: int = 1) -> int:
        return 0 if n == 0 else more + count(n - 1)

    holder = pickling.from_bytes(gm.__version__, pickling.as_bytes([count, count]))
    assert holder[0] is holder[1]
    assert holder[0](5) == 5
