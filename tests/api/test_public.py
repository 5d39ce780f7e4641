"""The public API: its names, what importing it loads, and what every answer can do."""

from __future__ import annotations

import ast
import inspect
import json
import pydoc
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.loaded import few_elements
from oracles.places import PACKAGE, ROOT, SAMPLES
from oracles.sources import CLASSES, nodes

import gearmesh as gm
from gearmesh import Result, former_names
from gearmesh.view.opengl import missing_opengl_message

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="apt-get install calculix-ccx")
needs_opengl = pytest.mark.skipif(missing_opengl_message() is not None, reason="off-screen OpenGL")

#: a narrow pair and coarse elements: every answer in a second
SMALL = {
    "module": 2,
    "pinion": {"teeth": 20, "face_width": 6},
    "gear": {"teeth": 31, "face_width": 6},
    "contact": {"phi1": {"count": 3}},
    "mesh": {"tolerance": 0.02},
    "fe": {"teeth": 1, "flank": 5, "fillet": 4, "thickness": 2, "face": 4, "torque": 10},
}

# ---------------------------------------------------------------- names


@pytest.mark.quick
def test_every_name_is_there_and_no_other_is_shown() -> None:
    assert dir(gm) == sorted([*gm.__all__, "__version__"])
    assert gm.__all__ == sorted(gm.__all__)
    for name in gm.__all__:
        thing = getattr(gm, name)
        assert thing.__module__.startswith("gearmesh.")
        assert thing.__doc__, name
    with pytest.raises(AttributeError, match="attribute job"):
        gm.job  # noqa: B018


#: beside verbs, designs, errors and answers: what gears consist of, what calls take, how figures and studies are read, and
#: the page of `explore`
PARTS_OF_GEARS = {
    *("Gears", "GearTrain", "GearPair", "Member", "Design", "System"),
    *("Rigid", "FlexibleMount", "Summary", "StudySummary", "Explorer"),
}
#: what gears are built of: given back by `Gears`, internal all the same
INTERNAL = {"CarriedBody", "MemberNames", "TriangleMesh", "Mapping"}


def own_classes() -> set[str]:
    """Return the names of all classes of the package."""
    return {name for path in PACKAGE.rglob("*.py") for name in CLASSES.findall(path.read_text(encoding="utf-8"))}


def version(words: str) -> tuple[int, ...]:
    return tuple(map(int, words.split(".")))


@pytest.mark.quick
def test_former_public_names_work_until_their_version_and_warn() -> None:
    assert not set(former_names.MODULE_OF_FORMER_NAME) & set(gm.__all__)
    assert len(former_names.MODULE_OF_FORMER_NAME) > 280
    assert version(gm.__version__) < version(former_names.GOES_WITH_VERSION)
    for name, module in former_names.MODULE_OF_FORMER_NAME.items():
        with pytest.warns(DeprecationWarning, match=rf"^gearmesh\.{name} is deprecated .* {re.escape(module)}") as told:
            assert getattr(gm, name) is getattr(import_module(module), name)
        assert told[0].filename == __file__


def given_back(name: str) -> set[str]:
    """Return the words of classes in what a public function, or the methods and properties of a public class, return."""
    thing = getattr(gm, name)
    owners = (
        [owner for owner in thing.__mro__ if owner.__module__.startswith("gearmesh.")] if inspect.isclass(thing) else []
    )
    members = [member for owner in owners for member in vars(owner).items()] or [(name, thing)]
    words: set[str] = set()
    for key, member in members:
        plain = getattr(member, "fget", None) or getattr(member, "func", None) or getattr(member, "__func__", member)
        if not key.startswith("_") and str(getattr(plain, "__module__", "")).startswith("gearmesh"):
            words |= {*re.findall(r"(?<![.\w])[A-Z]\w+", str(getattr(plain, "__annotations__", {}).get("return", "")))}
    return words


def answers() -> set[str]:
    """Return the names of all classes of the package that can be saved, but for bases and for what only one command makes."""
    found = set()
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if "def save(" not in text and "Result" not in text:
            continue
        for node in nodes(text):
            if isinstance(node, ast.ClassDef):
                bases = {ast.unparse(base).partition("[")[0] for base in node.bases}
                methods = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
                if not node.name.startswith("_") and ("save" in methods or bases & {"Result"}):
                    found.add(node.name)
    return found


@pytest.mark.quick
def test_public_names_are_verbs_gears_answers_designs_and_errors() -> None:
    verbs = {name for name in gm.__all__ if not inspect.isclass(getattr(gm, name))}
    classes = {name: getattr(gm, name) for name in gm.__all__ if name not in verbs}
    designs = {gm.system(kind).design.__name__ for kind in gm.kinds()}
    errors = {name for name, value in classes.items() if issubclass(value, Exception)}
    saved = {name for name, value in classes.items() if hasattr(value, "save")}
    asked = {word for name in (*verbs, "Gears") for word in given_back(name)} & own_classes()
    assert verbs == {word for word in verbs if word.islower()}
    assert designs <= set(classes)
    assert {*classes} - designs - errors - saved <= PARTS_OF_GEARS
    # every kind adds its class of designs; a train of several designs has a verb and two answers
    assert len(set(gm.__all__) - designs) <= 74
    assert asked - INTERNAL <= set(gm.__all__)


@pytest.mark.quick
def test_every_answer_that_another_answer_gives_is_public() -> None:
    given = {word for name in gm.__all__ for word in given_back(name)}
    assert given & answers() - INTERNAL <= set(gm.__all__)
    assert len(given & answers()) > 25


@pytest.mark.quick
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda gears: gears.contact(phi1="x"), "phi1 = x: must be a number in deg, or several"),
        (lambda gears: gears.contact(phi1=[0.0, float("nan")]), "phi1 = 0,nan: must be finite numbers in deg"),
        (
            lambda gears: gears.contact(phi1=[[0.0, 1.0]]),
            "phi1 = 0,1: must be finite numbers in deg, one or several in a row",
        ),
        (lambda gears: gears.loaded_contact("a"), "torque = a: must be a number in Nm, or several"),
        (
            lambda gears: gm.parse({**SMALL, "kind": "cylindrical", "teeth": 20}),
            "teeth: unknown key; did you mean pinion.teeth?",
        ),
    ],
)
def test_wrong_values_are_refused_by_the_argument_s_name(call: Callable[[gm.Gears], object], message: str) -> None:
    with pytest.raises(gm.DesignError) as refusal:
        call(gm.build(gm.parse({"kind": "cylindrical", **SMALL})))
    assert str(refusal.value).startswith(message)


@pytest.mark.quick
def test_help_reads_like_a_page() -> None:
    text = pydoc.plain(pydoc.render_doc(gm))
    for line in ("gears = gm.build(design)", "DesignError", "Lengths are in mm"):
        assert line in text
    for page in (gm.Gears, gm.build, gm.load):
        assert "_cached" not in pydoc.plain(pydoc.render_doc(page))


@pytest.mark.quick
def test_importing_loads_no_module_of_its_own() -> None:
    program = "import sys, gearmesh; print(*[name for name in sys.modules if name.startswith('gearmesh')])"
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["gearmesh"]


# ---------------------------------------------------------------- designs


@pytest.mark.quick
def test_designs_in_python_need_no_kind_and_are_those_of_files(tmp_path: Path) -> None:
    design = gm.BeveloidDesign(**SMALL)
    assert design == gm.parse({"kind": "beveloid", **SMALL})
    file = tmp_path / "small.toml"
    file.write_text(gm.toml(design.resolve()))
    assert gm.load(file) == design


@pytest.mark.quick
@pytest.mark.parametrize(
    ("key", "value"),
    [("pinion", {"teeth": 0, "face_width": 6}), ("modul", 2), ("units", "cm"), ("module", "2 km"), ("gear", 3)],
)
def test_designs_in_python_give_the_errors_of_files(tmp_path: Path, key: str, value: Any) -> None:
    wrong, file, messages = {**SMALL, key: value}, tmp_path / "wrong.json", []
    file.write_text(json.dumps({"kind": "beveloid", **wrong}))
    for make in (lambda: gm.BeveloidDesign(**wrong), lambda: gm.load(file)):
        with pytest.raises(gm.DesignError) as error:
            make()
        messages.append(str(error.value))
    assert messages[0] == messages[1]
    assert messages[0].startswith(key)


@pytest.mark.quick
def test_a_design_of_another_kind_is_refused() -> None:
    with pytest.raises(gm.DesignError, match=r'^kind = "face_gear": must be "beveloid" here$'):
        gm.BeveloidDesign(kind="face_gear", **SMALL)


# ---------------------------------------------------------------- answers


@pytest.fixture(autouse=True, scope="module")
def _coarse() -> Iterator[None]:
    """Larger facets in roll tests, few elements under load: what is told is looked at here, not how right it is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gearmesh.answers.check.ROLL_TOLERANCE_MM", 1e-3)
        patch.setattr("gearmesh.loaded.sharing.flank_compliance", few_elements)
        yield


@pytest.fixture(scope="module")
def gears() -> gm.Gears:
    return gm.build(gm.BeveloidDesign(**SMALL))


#: every kind of answer
ANSWERS: dict[str, Callable[[gm.Gears], Any]] = {
    "contact": lambda gears: gears.contact(torque=10.0),
    "a few positions": lambda gears: gears.contact([0.0, 1.0], cycle=False),
    "loaded": lambda gears: gears.loaded_contact([5.0, 20.0], [0.0, 3.0]),
    "solid": lambda gears: gears.solid("pinion"),
    "two teeth": lambda gears: gears.solid("gear", teeth=2),
    "solids": lambda gears: gears.solids(),
    "section": lambda gears: gears.section("pinion"),
    "check": lambda gears: gears.check(),
    "roll": lambda gears: gears.roll(gears.contact(cycle=False)),
    "limits": lambda gears: gears.limits(),
    "sheet": lambda gears: gears.sheet(),
    "vh": lambda _: gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml")).vh(),
    "finite elements": lambda gears: gears.finite_elements(),
    "compensation": lambda _: gm.build(gm.load(SAMPLES / "circular_arc.toml", ["assembly.dC=0.021"])).compensate(),
    "settings": lambda _: gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml")).sheet(),
}


class Tables(HTMLParser):
    """Counts rows, and that every tag is closed in its turn."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.rows = 0
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attributes: Any) -> None:
        self.open.append(tag)
        self.rows += tag == "tr"

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def assert_speaks(answer: Result) -> None:
    """One line, tables as text and as HTML, columns, JSON; nothing private shown."""
    assert len(repr(answer).splitlines()) == 1
    assert repr(answer).startswith(f"<{type(answer).__name__}: ")
    assert len(repr(answer)) < 400
    assert max(map(len, str(answer).splitlines())) <= 80
    page = Tables(answer._repr_html_())
    assert (page.open, page.rows >= sum(len(listing.rows) for listing in answer.listings)) == ([], True)
    assert len({len(column) for column in answer.to_dict().values()}) <= 1
    json.loads(answer.json(), parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert "timing" not in json.loads(answer.json(timing=False))
    assert not [name for name in dir(answer) if name.startswith("_")]
    assert {"save", "to_dict"} <= {*dir(answer)}


@pytest.mark.sweep_cases("compensation", "check", "contact", "loaded", "roll", "vh", "finite elements", "settings")
@pytest.mark.parametrize("name", ANSWERS)
def test_answers_speak_for_themselves_and_save(name: str, gears: gm.Gears, tmp_path: Path) -> None:
    answer = ANSWERS[name](gears)
    assert_speaks(answer)
    for suffix in answer.suffixes:
        file = answer.save(tmp_path / f"saved{suffix}")
        assert file.stat().st_size > 0
        if suffix == ".toml":
            assert gm.load(file) == answer.apply().with_values({"gearmesh": gm.__version__})
    with pytest.raises(gm.OutputError, match=r"suffix"):
        answer.save(tmp_path / "saved.xyz")


@pytest.mark.sweep
def test_cad_answers_save(gears: gm.Gears, tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    cad = gears.cad("pinion", 0.01)
    assert_speaks(cad)
    for suffix in cad.suffixes:
        assert cad.save(tmp_path / f"saved{suffix}").stat().st_size > 0


@needs_ccx
@needs_opengl
def test_solved_models_speak_and_save(gears: gm.Gears, tmp_path: Path) -> None:
    solved = gears.finite_elements(members=("pinion",)).solve()
    assert_speaks(solved)
    for suffix in solved.suffixes:
        assert solved.save(tmp_path / f"saved{suffix}").stat().st_size > 0


@pytest.mark.sweep_cases("gap", "contact")
@needs_opengl
@pytest.mark.parametrize("view", ["contact", "gap", "pair"])
def test_pictures_are_drawn_when_saved(view: str, gears: gm.Gears, tmp_path: Path) -> None:
    picture = gears.picture(view, None if view == "pair" else "gear", size=(64, 48))
    assert repr(picture).endswith("64 x 48>")
    assert len(repr(picture).splitlines()) == 1
    assert picture.save(tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(gm.OutputError, match=r"a\.jpg: its suffix must be \.png"):
        picture.save(tmp_path / "a.jpg")


@pytest.mark.quick
def test_gears_say_what_they_are(gears: gm.Gears) -> None:
    assert repr(gears) == "<Gears: Beveloid gears, teeth pinion 20, gear 31>"
    assert not [name for name in dir(gears) if name.startswith("_")]
    for wrong in (lambda: gears.solid("wheel"), lambda: gears.picture(member="wheel"), lambda: gears.picture("inside")):
        with pytest.raises(gm.DesignError, match=r" = (wheel|inside): must be one of "):
            wrong()


def test_meshes_go_to_other_libraries(gears: gm.Gears) -> None:
    """With all triangles, and the volume that was measured."""
    solids = gears.solids()
    scene, blocks = solids.to_trimesh(), solids.to_pyvista()
    assert set(scene.geometry) == set(blocks.keys()) == {"pinion", "gear"}
    for name, part in solids.parts.items():
        assert part.to_trimesh().is_watertight
        assert scene.geometry[name].volume == pytest.approx(part.figures["volume_mm3"], rel=1e-12)
        assert blocks[name].n_cells == part.figures["triangles"]
        assert blocks[name].volume == pytest.approx(part.figures["volume_mm3"], rel=1e-9)
        assert {"flank_right", "bore"} <= {*blocks[name].field_data["region_names"]}
    model = gears.finite_elements()
    grid = model.to_pyvista()
    assert (grid.n_cells, grid.n_points) == (model.figures["elements"], model.figures["nodes"])
    assert grid.volume == pytest.approx(model.figures["volume_mm3"], rel=1e-3)


@pytest.mark.quick
def test_positions_asked_for_are_those_of_the_answer(gears: gm.Gears) -> None:
    contact = gears.contact([-1.0, 0.0, 2.0], cycle=False)
    assert contact.to_dict()["phi1_deg"] == [-1.0, 0.0, 2.0]
    assert contact.cycle is None
    assert "contact_ratio" not in contact.summary
    np.testing.assert_allclose(contact.to_dict()["te_arcsec"], 0.0, rtol=0, atol=1e-6)


# ---------------------------------------------------------------- lengths


def test_lengths_have_units_wherever_python_takes_one(gears: gm.Gears, tmp_path: Path) -> None:
    """Bare numbers are mm, as everywhere."""
    solid = gears.solid("pinion", "20um")
    assert solid.figures["tolerance_um"] == 20.0
    assert replace(solid.measured, seconds=0.0) == replace(gears.solid("pinion", 0.02).measured, seconds=0.0)
    assert gears.section("pinion", "-0.05in", "1um").figures["z_mm"] == pytest.approx(-1.27)
    assert gears.section("pinion", tolerance="1um").tolerance == 1e-3
    found = gm.size(2.0, "2.5in", "2000um", face_width="20mm")
    assert (found.wanted.center_distance, found.wanted.module, found.wanted.face_width) == (63.5, 2.0, 20.0)
    assert gm.FlexibleMount.of([1e5] * 6, "0.5in").z == pytest.approx(12.7)
    row = gears.study({"assembly.dx": ["10um", 0.02]}, record="path").columns
    assert row["assembly.dx"] == [0.01, 0.02]


ASKED = {
    "solid": lambda gears, length, folder: gears.solid("pinion", length),
    "solids": lambda gears, length, folder: gears.solids(length),
    "section": lambda gears, length, folder: gears.section("pinion", None, length),
    "section_z": lambda gears, length, folder: gears.section("pinion", length),
    "topography": lambda gears, length, folder: gears.topography("pinion", "right", length),
    "measuring_grid": lambda gears, length, folder: gears.measuring_grid("pinion", ball=length),
    "check": lambda gears, length, folder: gears.check(length),
    "report": lambda gears, length, folder: gears.report(length),
    "run": lambda gears, length, folder: gears.run(folder, length),
    "size": lambda gears, length, folder: gm.size(2.0, length, 2.0),
    "size_module": lambda gears, length, folder: gm.size(2.0, 64.0, length),
    "mount": lambda gears, length, folder: gm.FlexibleMount.of([1e5] * 6, length),
}


@pytest.mark.parametrize("name", ASKED)
@pytest.mark.parametrize("length", ["1 parsec", "", "nan", float("inf"), True, [1.0]], ids=str)
def test_what_is_no_length_is_one_line(name: str, length: Any, gears: gm.Gears, tmp_path: Path) -> None:
    with pytest.raises(
        gm.DesignError, match=r"^(tolerance|z|center_distance|module|ball) = .*: must be a length as "
    ) as failure:
        ASKED[name](gears, length, tmp_path)
    assert "\n" not in str(failure.value)


@pytest.mark.quick
@pytest.mark.parametrize("tolerance", [0.0, -0.01, "1e-6", "11mm"])
def test_tolerances_in_python_have_the_range_of_the_command_line(tolerance: Any, gears: gm.Gears) -> None:
    with pytest.raises(gm.DesignError, match=rf"^tolerance = {tolerance}: must be a length .*, from 0\.01um to 10mm$"):
        gears.solid("pinion", tolerance)


def test_designs_and_gears_show_as_short_tables_in_notebooks() -> None:
    """Values that the file sets, with its own units; the members."""
    design = gm.CylindricalDesign(
        units="inch",
        module=0.1,
        name="a < b",
        pinion={"teeth": 18, "face_width": 1},
        gear={"teeth": 40, "face_width": 1},
    )
    shown = design._repr_html_()
    assert "a &lt; b" in shown
    assert "<td>pinion.face_width</td><td>1.0</td><td>inch</td>" in shown
    assert "profile_shift" not in shown
    assert "<td>gear</td><td>40</td><td>25.4</td>" in gm.build(design)._repr_html_()


def test_all_members_may_be_asked_for_where_one_is() -> None:
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    together = gears.solid("both", "50um")
    assert isinstance(together, gm.Solids)
    apart = gears.solids("50um")
    for name, part in together.parts.items():
        assert (part.mesh.vertices == apart.parts[name].mesh.vertices).all()
    with pytest.raises(gm.DesignError, match="teeth = 2: must be left out, or member the name of one"):
        gears.solid("all", teeth=2)


def test_designs_do_not_change() -> None:
    design = gm.load(SAMPLES / "spur.toml")
    for table, key in ((design, "module"), (design.pinion, "teeth")):
        with pytest.raises(gm.DesignError, match=f"{key} = 3: a design does not change; with_values"):
            setattr(table, key, 3)
    assert design == gm.load(SAMPLES / "spur.toml")


@pytest.mark.parametrize("kind", [gm.Animation, gm.Diagram, gm.Picture, gm.WorkshopDrawing])
def test_pictures_list_what_they_have(kind: Any) -> None:
    listed = dir(object.__new__(kind))
    assert "save" in listed
    assert not [name for name in listed if name not in kind.__dataclass_fields__ and not hasattr(kind, name)]
