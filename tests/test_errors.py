"""Refusals are data: every one has fields, of which one place makes the sentence, and commands name their own options."""

from __future__ import annotations

import ast
import pickle
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from oracles.places import SAMPLES
from oracles.sources import parsed

import gearmesh as gm
from gearmesh import DesignError, GearmeshError, OutputError, samples
from gearmesh.allowed import Allowed, Bounds, in_unit, stated_bounds
from gearmesh.app.cli import main
from gearmesh.kinds import VagueError

PACKAGE = Path(gm.__file__).parent
#: errors whose fields are key, value, reason and what is allowed, by keyword after the first two
WITH_FIELDS = (
    "GearmeshError",
    "DesignError",
    "ArgumentError",
    "FileError",
    "VagueError",
    "OutputError",
    "OutputArgumentError",
    "NoSolutionError",
    "conflict",
)
WHY = {"reason", "allowed", "must_be"}


#: the beginning of a call that makes an error; classes and functions of these names are none
CALLED = re.compile(rf"(?<!class )(?<!def )(?<![\w.])(?:{'|'.join(WITH_FIELDS)})\(")


@cache
def sources() -> dict[str, str]:
    """Return the text of every file of the package."""
    return {str(file.relative_to(PACKAGE)): file.read_text(encoding="utf-8") for file in sorted(PACKAGE.rglob("*.py"))}


def called(text: str, start: int) -> ast.Call:
    """The call that begins there: the shortest text that ends with a bracket and is an expression.

    Raises ValueError for words that are none.
    """
    end = start
    while end := text.index(")", end) + 1:
        try:
            expression = ast.parse(text[start:end], mode="eval").body
        except SyntaxError:
            continue
        assert isinstance(expression, ast.Call)
        return expression
    raise AssertionError


@cache
def calls() -> list[tuple[str, ast.Call]]:
    """All calls in the package that make an error, with where they are: to parse every file takes 4 s."""
    return [
        (f"{file}:{text.count(chr(10), 0, found.start()) + 1}", called(text, found.start()))
        for file, text in sources().items()
        for found in CALLED.finditer(text)
    ]


def name_of(node: ast.Call) -> str:
    return node.func.id if isinstance(node.func, ast.Name) else ""


def texts(node: ast.AST) -> str:
    """All literal text in an expression."""
    return " ".join(n.value for n in ast.walk(node) if isinstance(n, ast.Constant) and isinstance(n.value, str))


def test_every_refusal_passes_fields() -> None:
    wrong = []
    assert len(calls()) > 900
    for place, node in calls():
        given = {each.arg for each in node.keywords}
        key = texts(node.args[0]) if node.args else ""
        sentence = ": " in key or " = " in key or len(key.split()) > 4 or len(node.args) > 2
        without_key = not node.args and name_of(node) not in ("NoSolutionError", "OutputError")
        if sentence or without_key or not given & WHY | ({None} & given):
            wrong.append(f"{place}: {ast.unparse(node)[:120]}")
    assert not wrong, "\n".join(wrong)


def test_outside_app_no_message_names_an_option() -> None:
    wrong = [
        f"{place}: {ast.unparse(node)[:160]}"
        for place, node in calls()
        if not place.startswith("app/") and re.search(r"(^|\s)--?[a-z]", texts(node))
    ]
    assert not wrong, "\n".join(wrong)


#: what takes a text apart
READERS = {
    "match",
    "search",
    "fullmatch",
    "findall",
    "split",
    "sub",
    "partition",
    "rpartition",
    "startswith",
    "removeprefix",
}
#: in what a function is given, or what is caught
OURS = re.compile(r"\b(" + "|".join([*WITH_FIELDS[:-1], "TrimError"]) + r")\b")

#: names of what is caught, and of what is one of ours by its annotation; names in a text
CAUGHT = re.compile(rf"\bas (\w+):|\b(\w+): [^,\n]*?{OURS.pattern}")
TOLD = re.compile(r"\bstr\((\w+)\)|\{(\w+)\}")


def errors_in(tree: ast.Module) -> Iterator[tuple[str, ast.AST]]:
    """Names of errors of gearmesh, each with the code that knows it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ExceptHandler) and node.name and node.type and OURS.search(ast.unparse(node.type)):
            yield node.name, node
        if isinstance(node, ast.FunctionDef):
            for each in node.args.args:
                if each.annotation and OURS.search(ast.unparse(each.annotation)):
                    yield each.arg, node


def test_no_code_reads_a_message() -> None:
    """Nothing takes the text of an error apart: it has fields."""
    wrong = []
    for file, text in sources().items():
        known_names, told = ({name for found in one.findall(text) for name in found[:2]} for one in (CAUGHT, TOLD))
        if not (known_names & told) - {""}:
            continue
        for name, known in errors_in(parsed(text)):
            apart = re.compile(rf"\bstr\({name}\)|\{{{name}\}}")
            for node in ast.walk(known):
                reads = (
                    isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in READERS
                )
                if reads and apart.search(ast.unparse(node)):
                    wrong.append(f"{file}: {ast.unparse(node)}")
    assert not wrong, "\n".join(wrong)


@pytest.fixture(scope="module")
def spur() -> gm.Gears:
    return gm.build(gm.load(SAMPLES / "spur.toml"))


# what is called; key, value, what is allowed and reason
REFUSED: list[tuple[Callable[[gm.Gears], Any], str, Any, str, str]] = [
    (lambda g: g.sheet(speed=5), "speed", 5, "", "needs a torque"),
    (lambda g: g.sheet(torque=5, member="pinion"), "torque", 5, "", "forces need both members"),
    (lambda g: g.sheet(member="sun"), "member", "sun", "one of pinion, gear", ""),
    (lambda g: g.picture("inside"), "view", "inside", "one of contact", ""),
    (lambda g: g.picture("flank", member="sun"), "member", "sun", "one of pinion, gear", ""),
    (lambda g: g.solid("pinion", tolerance="1 ell"), "tolerance", "1 ell", "a length as", ""),
    (lambda g: g.solid("pinion", tolerance=-1), "tolerance", "-1", "a length as", ""),
    (lambda g: g.topography("sun", "left"), "member", "sun", "one of pinion, gear", ""),
    (lambda g: g.measuring_grid("gear", "upper"), "flank", "upper", "one of right, left, both", ""),
    (lambda g: g.measuring_grid("gear", grid="5"), "grid", "5", "two numbers, as 5x9", ""),
    (lambda g: g.measuring_grid("gear", grid=(0, 9)), "grid", "0x9", "rows and columns from 1 to 2001", ""),
    (lambda g: g.measuring_grid("gear", margins=(0.1, 0.6)), "margins", "0.1,0.6", "from 0 to 0.45", ""),
    (lambda g: g.measuring_grid("gear", ball=-1), "ball", -1.0, "a diameter above 0", ""),
    (lambda g: g.toolpath("pinion", "ball:1", "10um", order="both"), "order", "both", "one of zigzag, one-way", ""),
    (lambda g: g.topography("pinion", "upper"), "flank", "upper", "one of right, left", ""),
    (lambda g: g.loaded_contact(-3.0), "torque", "-3", "one or more finite numbers above 0", ""),
    (lambda g: g.compensate(), "kind", "cylindrical", "spiral_bevel", "has no"),
    (lambda g: g.vh(("V", "X")), "kind", "cylindrical", "spiral_bevel", "has no V-H check"),
    (lambda g: g.train.pair("sun-ring"), "pair", "sun-ring", "one of pinion-gear", ""),
    (lambda g: gm.build("spur.toml"), "design", "spur.toml", "a Design", ""),
    (lambda g: gm.load(SAMPLES / "spur.toml", ["module"]), "overrides", None, "", "must look like dotted.key=value"),
    (lambda g: gm.load(SAMPLES / "spur.toml", ["pressure_angle=50"]), "pressure_angle", 50, "an angle in deg", ""),
    (lambda g: gm.load(SAMPLES / "spur.toml", ["modul=2"]), "modul", None, "", "unknown key; did you mean module?"),
    (lambda g: gm.load(SAMPLES / "spur.toml", ["kind='worm'"]), "kind", "worm", 'one of "cylindrical"', ""),
    (lambda g: gm.load(SAMPLES / "spur.toml", ["gear.teeth=400"]), "assembly.center_distance", 90, "at least", ""),
    (
        lambda g: gm.build(gm.load(SAMPLES / "spur.toml", ["backlash=30"])),
        "backlash",
        30,
        "at most",
        "",
    ),
    (lambda g: gm.parse({}), "kind", None, "one of", "missing"),
    (lambda g: samples.text("spurr"), "name", "spurr", "", "no sample has this name"),
]


@pytest.mark.parametrize("case", REFUSED, ids=[f"{key}-{k}" for k, (_, key, *_) in enumerate(REFUSED)])
@pytest.mark.sweep_cases("backlash-25")
def test_errors_have_fields(spur: gm.Gears, case: tuple[Callable[[gm.Gears], Any], str, Any, str, str]) -> None:
    call, key, value, allowed, reason = case
    with pytest.raises(GearmeshError) as refused:
        call(spur)
    error = refused.value
    assert (error.key, error.value) == (key, value)
    assert allowed in error.allowed
    assert reason in error.reason
    assert error.allowed or error.reason
    line = str(error)
    assert line.startswith(f"{key} {error.entry}".rstrip() if value is None else f"{key} = ")
    assert "--" not in line
    assert "\n" not in line
    # Dask has tracebacks and causes pickled, too, which is not looked at here
    error.__cause__ = error.__context__ = error.__traceback__ = None
    for again in (pickle.loads(pickle.dumps(error)), error.rename(key)):
        assert type(again) is type(error)
        assert str(again) == line
        assert repr(again) == repr(error)
    assert repr(error).startswith(f"{type(error).__name__}(key={key!r}")


@pytest.mark.parametrize(
    ("arguments", "begins"),
    [
        ("describe {spur} --speed 5", "--speed = 5: needs a torque"),
        ("describe {spur} --torque 5 --member pinion", "--torque = 5: forces need both members"),
        ("describe {spur} --member sun", "--member = sun: must be one of pinion, gear"),
        ("solid {spur} --member pinion -o x.stl --tol 1ell", "--tol = 1ell: must be a length as"),
        ("topography {spur} --member pinion --flank upper", "--flank = upper: must be one of right, left"),
        ("tca {spur} --pair sun-ring", "--pair = sun-ring: must be one of pinion-gear"),
        ("tca {spur} --set module", '--set "module": must look like dotted.key=value'),
        ("tca {spur} --set gear.teeth=400", "assembly.center_distance = 90 mm: allowed is at least"),
        ("tca {spur} --json - --csv -", "--csv = -: --json already uses standard output"),
        ("size --ratio 2 --center-distance 1ell --module 2", "--center-distance = 1ell: must be a length as"),
        ("sample spurr", 'name = "spurr": no sample has this name'),
    ],
)
def test_commands_name_their_options(arguments: str, begins: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments.format(spur=SAMPLES / "spur.toml").split()) == 2
    assert capsys.readouterr().err.startswith(f"gearmesh: error: {begins}")


def test_one_form_of_sentence() -> None:
    error = DesignError("gear.web.thickness", 12.5, unit="mm", reason="too thick", allowed="less than 12 mm")
    assert str(error) == "gear.web.thickness = 12.5 mm: too thick; allowed is less than 12 mm"
    assert str(DesignError("teeth", 0, must_be="a whole number above 0")) == "teeth = 0: must be a whole number above 0"
    assert (
        str(OutputError("cannot write", Path("a.stl"), reason="it is a folder")) == "cannot write a.stl: it is a folder"
    )


def test_what_is_work_to_find_out_is_asked_for_once_and_late() -> None:
    asked: list[int] = []

    def tell() -> DesignError:
        asked.append(1)
        return DesignError("gear", 3, reason="too few", remedies={"gear.teeth": 1})

    error = VagueError.later(tell, "gear: few")
    assert (error.topic, asked) == ("gear: few", [])
    assert (str(error), error.value, error.topic) == ("gear = 3: too few", 3, "gear: few")
    assert str(pickle.loads(pickle.dumps(VagueError.later(tell, "gear: few")))) == "gear = 3: too few"
    assert asked == [1, 1]


@pytest.mark.quick
def test_refusals_of_designs_in_inches_are_in_inches() -> None:
    """Fields stay in mm; of figures with a bound the printed one is allowed, tried on a design with it."""
    keys = {"kind": "cylindrical", "units": "inch", "diametral_pitch": 10}
    keys |= {"pinion": {"teeth": 17, "face_width": 0.5}, "gear": {"teeth": 40, "face_width": 0.5}}
    design = gm.parse(keys)
    with pytest.raises(DesignError, match=r"^gear.bore = 9 inch: .* less than the smallest root diameter, 3.75 inch$"):
        gm.build(design.with_values({"gear.bore": 9}))
    with pytest.raises(DesignError, match=r"^gear.end_chamfer = 0.3 inch: .* at most (0\.\d+) inch$") as refused:
        gm.build(design.with_values({"gear.end_chamfer": 0.3}))
    assert (refused.value.value, refused.value.unit) == (pytest.approx(7.62), "mm")
    most = float(str(refused.value).split()[-2])
    gm.build(design.with_values({"gear.end_chamfer": most}))
    with pytest.raises(DesignError):
        gm.build(design.with_values({"gear.end_chamfer": most + 1e-5}))
    # what was noticed is in the design's unit, as the key is
    with pytest.raises(
        DesignError, match=r"^pinion.profile_shift = 3: .* -0.25 inch: the tip diameter is 2.5 inch"
    ) as pointed:
        gm.build(design.with_values({"pinion.profile_shift": 3}))
    assert " mm" not in str(pointed.value)


@pytest.mark.quick
def test_lengths_of_a_message_in_another_unit() -> None:
    line = "a = 5.08 mm: at most 10 mm, at least 10 mm, from 1 to 25.4 mm; 0.3 mm/mm, 12 teeth and 3 mm^2"
    said = "a = 0.2 inch: at most 0.3937 inch, at least 0.393701 inch, from 0.0393701 to 1 inch; 0.3 mm/mm, 12 teeth and 3 mm^2"
    assert in_unit(line, "inch", 25.4) == said


@pytest.mark.parametrize(
    ("allowed", "text", "bounds"),
    [
        (
            Allowed.less_than(31.2345678, "mm", "the root"),
            "less than the root, 31.2345 mm",
            Bounds(None, 31.2345, "mm", includes_high=False),
        ),
        (Allowed.at_most(0.5), "at most 0.5", Bounds(None, 0.5, "")),
        (
            Allowed.more_than(2.00000001, "mm", note=", or another taper"),
            "more than 2.00001 mm, or another taper",
            Bounds(2.00001, None, "mm", includes_low=False),
        ),
        (Allowed.at_least(-20.0, "deg"), "at least -20 deg", Bounds(-20.0, None, "deg")),
        (Allowed.from_to(1.0, 2.5, "mm"), "from 1 to 2.5 mm", Bounds(1.0, 2.5, "mm")),
        (
            Allowed.between(1.0, 2.5, "mm", " (the bore)"),
            "between 1 and 2.5 mm (the bore)",
            Bounds(1.0, 2.5, "mm", includes_low=False, includes_high=False),
        ),
    ],
)
def test_allowed_values_carry_the_bounds_of_their_text(allowed: Allowed, text: str, bounds: Bounds) -> None:
    """Bounds are rounded towards the allowed values, equal to what is read from the text, and survive another process."""
    refusal = pickle.loads(pickle.dumps(DesignError("bore", 50.0, unit="mm", allowed=allowed)))
    assert (allowed, refusal.bounds, stated_bounds(allowed)) == (text, bounds, bounds)
