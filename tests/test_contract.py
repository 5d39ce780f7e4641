"""Imports that packages may have, and modules that importing gearmesh loads."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest
from oracles.sources import CLASSES, nodes, parsed

import gearmesh

PACKAGE = Path(__file__).parents[1] / "gearmesh"

# package: the packages that its modules may import, anywhere, function-level imports included (SHARED all may);
# `gearmesh` itself, whose names are those of api, systems and design, is for app alone
SHARED = {
    "allowed",
    "arguments",
    "deprecated",
    "errors",
    "figures",
    "formats",
    "lengths",
    "member_names",
    "memory",
    "numerals",
    "pickling",
    "pipes",
    "progress",
    "records",
}
MAY_IMPORT: dict[str, str] = {
    "deprecated": "",
    "former_names": "",
    "kinds": "systems",  # its names are in its stub
    "allowed": "",
    "errors": "",
    "lengths": "",
    "member_names": "",
    "memory": "",
    "numerals": "",
    "pickling": "",
    "pipes": "",
    "arguments": "",
    "figures": "",
    "formats": "",
    "progress": "",
    "records": "",
    "kernel": "",
    "files": "",
    "exchange": "files",
    "samples": "io",
    "tools": "kernel",
    "teeth": "kernel tools",
    "contact": "kernel teeth",
    "design": "files",
    "metrology": "kernel teeth design files",
    "systems": "kernel tools teeth contact metrology design exchange",  # and never another system
    "mesh": "kernel teeth",
    "toolpath": "kernel teeth",
    "check": "kernel teeth mesh",  # never the solver that it checks
    "io": "kernel mesh files",
    "cad": "kernel teeth mesh io",
    "fe": "kernel teeth contact mesh io",
    "loaded": "kernel teeth contact mesh fe",
    "answers": "kernel tools teeth contact metrology design files exchange systems mesh toolpath check io cad fe loaded",
    "study": "kernel teeth contact metrology design files io systems loaded answers",
    "optimize": "kernel teeth design files io systems answers study",
    "view": "kernel tools teeth contact mesh check fe loaded io answers",  # and of solvers their results alone
    "drawing": "kernel teeth design systems cad answers view",  # of answers the sheet, of view the writer of figures
    "reports": "kernel teeth design files systems mesh io answers view drawing study optimize",
    # of trains the stages, and all answers about them
    "trains": "kernel teeth contact design files exchange systems mesh io cad answers view study reports",
    # the local page
    "explore": "kernel design systems samples mesh teeth answers view reports trains",
    # only app and gearmesh import api
    "api": "teeth design systems cad answers view drawing study optimize reports explore trains",
    "app": "api answers view explore trains samples systems design files exchange io cad fe contact study",  # nobody imports app
}
#: the only packages of others that may be loaded by importing, and those that may be loaded inside functions too
LIGHT = {"numpy", "pydantic", "typer", "rich", "click", "threadpoolctl"}
HEAVY = {
    "scipy",
    "vtk",
    "vtkmodules",
    "pyvista",
    "OCP",
    "dask",
    "distributed",
    "pyarrow",
    "matplotlib",
    "manifold3d",
    "trimesh",
    "meshio",
    "tomli_w",
    "ezdxf",
    "starlette",
    "uvicorn",
    "websockets",
}
#: what view may import of the solvers' packages: what they found, not how it is found
SOLVERS = ("contact", "loaded")
RESULTS = {
    "ContactPath",
    "Cycle",
    "FullTurns",
    "LoadedMesh",
    "whole_cycle",
    "inside",
    "solver_flank",
}
#: packages that are mathematics: numpy and scipy only
MATHEMATICS = ("kernel", "tools", "teeth", "contact", "metrology", "check")

#: where tools are, and the surfaces and motions that stand for them
TOOLS = ("gearmesh/tools/", "gearmesh/kernel/envelope/", "gearmesh/kernel/motion/", "gearmesh/kernel/surface/")

#: modules in a folder
MOST_MODULES = 20

FILES = sorted(path.relative_to(PACKAGE.parent).as_posix() for path in PACKAGE.rglob("*.py"))


#: what is imported from gearmesh itself: its public names
PUBLIC = [[name] for name in gearmesh.__all__]


def package_of(parts: tuple[str, ...]) -> str:
    """Package that a dotted name or a file below gearmesh belongs to; "" for gearmesh itself."""
    return parts[1] if len(parts) > 1 and parts[1] not in ("__init__", "__main__", "__version__") else ""


#: texts of several lines
LONG_TEXT = re.compile(r'"""(?:\\.|[^\\])*?"""', re.DOTALL)
#: imports, and what may hold late ones, with the depth of each
STATEMENTS = re.compile(
    r"^(?P<depth>[ ]*)(?P<words>(?:from [.\w]+ )?import (?:\([^)]*\)|[^\n(#]*)|(?:async )?def |class |if (?:\w+\.)?TYPE_CHECKING:)",
    re.MULTILINE,
)


@cache
def imported(file: str, source: str) -> list[tuple[int, bool, str]]:
    """(line, on importing, absolute dotted name) of all imports in a file, those for types too; `from a import b` gives a.b.

    From the lines, as the formatter writes them: to parse every file takes 5 s. An import is late within a function, and where
    only types are checked.
    """
    package, found = Path(file).parts[:-1], []
    # long texts hold programs that are written, not imports
    code = LONG_TEXT.sub(lambda text: "\n" * text[0].count("\n"), source)
    within: list[tuple[int, bool]] = []
    for statement in STATEMENTS.finditer(code):
        depth, words = len(statement["depth"]), statement["words"]
        while within and within[-1][0] >= depth:
            within.pop()
        late = bool(within) and within[-1][1]
        if not words.startswith(("import ", "from ")):
            within.append((depth, late or not words.startswith("class ")))
            continue
        line = code.count("\n", 0, statement.start("words")) + 1
        (node,) = ast.parse(words).body
        if isinstance(node, ast.Import):
            found += [(line, not late, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            stem = [*base, *(node.module.split(".") if node.module else ())]
            found += [(line, not late, ".".join((*stem, alias.name))) for alias in node.names]
    return sorted(found)


def complaints(file: str, source: str) -> list[str]:
    """Return the imports of a file that break the rules, one line each."""
    parts = Path(file).with_suffix("").parts
    own, wrong = package_of(parts), []
    if own and own not in MAY_IMPORT:
        return [f"{file}: package {own!r} is not in MAY_IMPORT of {Path(__file__).name}: decide what it may import"]
    for line, early, name in imported(file, source):
        target = name.split(".")
        where = f"{file}:{line} imports {name}"
        if target[0] != "gearmesh":
            if early and target[0] in HEAVY:
                wrong.append(f"{where}: it must be loaded inside the function that needs it")
            elif own in MATHEMATICS and target[0] not in {*sys.stdlib_module_names, "numpy", "scipy"}:
                wrong.append(f"{where}: {own} may use numpy and scipy only")
            continue
        if name == "gearmesh" or target[1:] in PUBLIC:
            wrong += [f"{where}: the public names are for app alone"] if own not in ("", "app") else []
            continue
        package = package_of(tuple(target))
        if package not in {"", own, *SHARED, *MAY_IMPORT.get(own, "").split()} and own:
            wrong.append(f"{where}: {own} may import only {MAY_IMPORT[own] or 'errors'}")
        if own == "view" and package in SOLVERS and target[-1] not in RESULTS:
            wrong.append(f"{where}: view draws what it is given, and solves nothing")
        between = own == package == "systems" and len(parts) > 3 and len(target) > 3
        if between and target[2] not in (parts[2], "common", "system", "kinds"):
            wrong.append(f"{where}: a gear system imports no other one; what they share goes to systems/common")
    return wrong


@cache
def source(file: str) -> str:
    return (PACKAGE.parent / file).read_text(encoding="utf-8")


def test_packages_import_what_they_may() -> None:
    wrong = [line for file in FILES for line in complaints(file, source(file))]
    assert not wrong, "\n".join(wrong)


def test_no_files_import_each_other_in_a_circle() -> None:
    """Imports inside functions counted, and those for types alone."""
    known = {file.removesuffix(".py").replace("/", ".").removesuffix(".__init__"): file for file in FILES}
    edges = {
        name: {
            target
            for _, _, line in imported(file, source(file))
            for target in (line if line in known else line.rpartition(".")[0],)
            if target in known and target != "gearmesh"
        }
        for name, file in known.items()
    }
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == [["a", "b", "c"]]
    assert circles(edges) == []


def circles(edges: dict[str, set[str]]) -> list[list[str]]:
    """Names that lead back to themselves, with those on the way."""

    def reached(name: str) -> set[str]:
        found, waiting = set(), [name]
        while waiting:
            fresh = edges[waiting.pop()] - found
            found |= fresh
            waiting += fresh
        return found

    beyond = {name: reached(name) for name in edges}
    groups = {tuple(sorted(m for m in beyond[n] if n in beyond[m])) for n in edges if n in beyond[n]}
    return [list(each) for each in sorted(groups)]


def test_no_folder_has_more_modules_than_one_can_scan() -> None:
    counts: dict[str, int] = {}
    for file in FILES:
        if not file.endswith("__init__.py"):
            counts[file.rpartition("/")[0]] = counts.get(file.rpartition("/")[0], 0) + 1
    assert {folder: count for folder, count in counts.items() if count > MOST_MODULES} == {}


def test_no_code_asks_which_tool_or_motion_made_a_surface() -> None:
    """Outside tools and kernel no isinstance of a class of tools, nor of a surface of the kernel, an envelope or a motion."""
    known = {name for file in FILES if file.startswith(TOOLS) for name in CLASSES.findall(source(file))}
    example = (
        "from gearmesh.tools.rack import Arc\nisinstance(s, Arc | None)\nmatch s:\n    case rolling.RackRoll(): pass\n"
    )
    assert asked("x.py", example, known) == [(2, "Arc"), (4, "RackRoll")]
    asking = [
        f"{file}:{line} asks whether something is a {name}: let it answer by a method"
        for file in FILES
        if not file.startswith(("gearmesh/tools/", "gearmesh/kernel/"))
        for line, name in asked(file, source(file), known)
    ]
    assert not asking, "\n".join(asking)


#: words that ask for a class, and how far around them its name stands
ASKING = re.compile(r"\b(?:isinstance|issubclass|type)\(|^ *case ", re.MULTILINE)
NEAR_WORDS = 400
WORD = re.compile(r"\w+")


def asked(file: str, text: str, known: set[str]) -> list[tuple[int, str]]:
    """(line, name) of the `known` classes that a file asks for by isinstance, issubclass, match or `type(x) is`."""
    # only a file that has a known name beside such words is worth its syntax tree
    places = [found.start() for found in ASKING.finditer(text)]
    near = {word for at in places for word in WORD.findall(text, max(at - NEAR_WORDS, 0), at + NEAR_WORDS)}
    if not near & known:
        return []
    own = {name.rpartition(".")[2] for _, _, name in imported(file, text) if name.startswith("gearmesh.")}
    found = []
    for node in nodes(text):
        classes: list[ast.expr] = []
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("isinstance", "issubclass"):
            classes = node.args[1:]
        elif isinstance(node, ast.MatchClass):
            classes = [node.cls]
        elif isinstance(node, ast.Compare) and "type(" in ast.unparse(node):
            classes = [node.left, *node.comparators]
        for each in (n for c in classes for n in ast.walk(c)):
            if isinstance(each, ast.Attribute) and each.attr in known:
                found.append((each.lineno, each.attr))
            elif isinstance(each, ast.Name) and each.id in known & own:
                found.append((each.lineno, each.id))
    return sorted(found)


#: conditions outside of kernel and teeth that ask whether a member slides, or has one row of teeth or two: fewer than so many
FEWER_KINDS = 10
#: what they would ask: what joints and rows of teeth answer with nothing, and their classes
KIND_OF_MEMBER = {
    *("travel", "slide", "drift", "mirrored", "Prismatic", "Revolute", "SingleRow", "DoubleHelical", "SINGLE_ROW", "REVOLUTE"),
    *("member.halves", "member.gaps", "pair.halves", "gears.halves", "pinion.halves", "gear.halves"),
}  # fmt: skip


def conditions(text: str) -> dict[int, str]:
    """Conditions of a file that ask what kind of member there is, by their lines."""
    found: dict[int, str] = {}
    if not any(name.rpartition(".")[2] in text for name in KIND_OF_MEMBER):
        return found
    for node in nodes(text):
        tests = list(node.ifs) if isinstance(node, ast.comprehension) else []
        tests += node.values if isinstance(node, ast.BoolOp) else []
        tests += [node.test] if isinstance(node, ast.If | ast.IfExp | ast.While | ast.Assert) else []
        tests += [node.subject] if isinstance(node, ast.Match) else []
        for test in tests:
            names = [ast.unparse(n).split(".") for n in ast.walk(test) if isinstance(n, ast.Name | ast.Attribute)]
            if KIND_OF_MEMBER & {".".join(name[-k:]) for name in names for k in (1, 2)}:
                found.setdefault(test.lineno, ast.unparse(test))
    return found


def test_members_answer_for_racks_and_double_helical_gears_themselves() -> None:
    found = [
        f"{file}:{line} asks {text}"
        for file in FILES
        if not file.startswith(("gearmesh/kernel/", "gearmesh/teeth/"))
        for line, text in conditions(source(file)).items()
    ]
    assert 0 < len(found) < FEWER_KINDS, "\n".join(found)
    example = "if member.mirrored is not None and a:\n    x = 1 if pair.slide is None else 2\n"
    example += "y = [m for m in both if len(m.pinion.halves) > 1 or isinstance(m.joint, Prismatic)]\n"
    assert list(conditions(example)) == [1, 2, 3]
    assert not conditions("for half in member.halves:\n    x = joint.travelled(half)\n")


def test_every_class_has_a_name_of_its_own() -> None:
    homes: dict[str, list[str]] = {}
    for file in FILES:
        for name in CLASSES.findall(LONG_TEXT.sub("", source(file))):
            homes.setdefault(name, []).append(file)
    assert len(homes) > 1000
    assert {name: places for name, places in homes.items() if len(places) > 1} == {}


@pytest.mark.quick
@pytest.mark.parametrize(
    ("file", "source", "words"),
    [
        (
            "gearmesh/kernel/surface/surface.py",
            "from gearmesh.contact.tca import solve",
            "kernel may import only errors",
        ),
        ("gearmesh/kernel/surface/surface.py", "from gearmesh import kernel, mesh", "kernel may import only errors"),
        ("gearmesh/tools/rack.py", "def f():\n    from ..systems.beveloid import x", "tools may import only kernel"),
        ("gearmesh/tools/rack.py", "from . import worm\nfrom gearmesh.tools import disk", None),
        ("gearmesh/check/roll.py", "import gearmesh.contact.tca", "check may import only"),
        ("gearmesh/errors.py", "from gearmesh.kernel.numeric.algebra import Array", "errors may import only"),
        ("gearmesh/errors.py", "from gearmesh import __version__", None),
        ("gearmesh/teeth/tooth.py", "def f():\n    import pydantic", "numpy and scipy only"),
        ("gearmesh/view/render.py", "import pyvista as pv", "inside the function"),
        ("gearmesh/view/render.py", "def f():\n    import pyvista as pv", None),
        ("gearmesh/fe/ccx.py", "from gearmesh.app import cli", "fe may import only"),
        ("gearmesh/view/pictures.py", "from gearmesh.study.study import Study", "view may import only"),
        ("gearmesh/view/pictures.py", "from gearmesh.contact.tca import contact_path", "view draws what it is given"),
        ("gearmesh/view/pictures.py", "from gearmesh.contact.path import ContactPath", None),
        ("gearmesh/answers/check.py", "def f():\n    from gearmesh.view.scene import Scene", "answers may import only"),
        ("gearmesh/api/gears.py", "def f():\n    from gearmesh.app.cli import main", "api may import only"),
        (
            "gearmesh/app/commands/contact/tca.py",
            "from gearmesh.answers.tables import Listing\nimport gearmesh as gm",
            None,
        ),
        ("gearmesh/app/commands/contact/tca.py", "from gearmesh.mesh.solid import prove", "app may import only"),
        ("gearmesh/view/pictures.py", "from gearmesh import build", "are for app alone"),
        ("gearmesh/novelty/new.py", "import numpy", "'novelty' is not in MAY_IMPORT"),
        ("gearmesh/systems/beveloid/build.py", "from gearmesh.systems.face_gear.build import x", "no other one"),
        ("gearmesh/systems/beveloid/build.py", "from gearmesh.systems.common.racks.rack_member import x", None),
        (
            "gearmesh/systems/beveloid/build.py",
            "from gearmesh.systems.face_gear.system import GEAR_SYSTEMS",
            "no other one",
        ),
        ("gearmesh/systems/beveloid/system.py", "from gearmesh.systems.system import System", None),
        ("gearmesh/kernel/surface/levels.py", "from scipy.interpolate import PPoly", "inside the function"),
    ],
)
def test_rules_catch_what_they_should(file: str, source: str, words: str | None) -> None:
    found = complaints(file, source)
    assert (words is None and not found) or (words is not None and len(found) == 1 and words in found[0])


@pytest.mark.parametrize("modules", [["gearmesh"], FILES], ids=["package", "every module"])
@pytest.mark.sweep_cases("every module")
def test_importing_loads_nothing_heavy(modules: list[str]) -> None:
    """`import gearmesh`, and every module of it, in a fresh interpreter."""
    names = [Path(name).with_suffix("").as_posix().replace("/", ".").removesuffix(".__init__") for name in modules]
    program = (
        "import importlib, json, sys\n"
        f"for name in {[n for n in names if not n.endswith('__main__')]!r}: importlib.import_module(name)\n"
        "print(json.dumps(sorted({name.split('.')[0] for name in sys.modules})))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=PACKAGE.parent
    )
    assert run.returncode == 0, run.stderr
    loaded = set(json.loads(run.stdout))
    assert "gearmesh" in loaded
    assert not loaded & (HEAVY | LIGHT if modules == ["gearmesh"] else HEAVY)


def test_kinds_and_keys_need_no_solver() -> None:
    """The kinds and their lines load no design, the designs' keys no numpy and nothing that makes gears of them."""
    program = (
        "import json, sys\n"
        "from gearmesh.systems.system import about, design_class, kinds\n"
        "lines = [about(kind) for kind in kinds()]\n"
        "of_kinds = [*sys.modules]\n"
        "keys = [design_class(kind).key_groups() for kind in kinds()]\n"
        "print(json.dumps([of_kinds, [*sys.modules]]))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=PACKAGE.parent
    )
    of_kinds, of_keys = json.loads(run.stdout)
    assert not {name for name in of_kinds if name.endswith("design") and "systems" in name}
    assert not {"numpy", "scipy"} & {*of_keys}
    assert not {
        name for name in of_keys if "build" in name.split(".") or (name.count(".") > 2 and name.endswith(".system"))
    }


def test_late_functions_exist() -> None:
    """A kind names them as text, which no type checker reads."""
    texts = "".join(source(file) for file in FILES if file.endswith("/system.py"))
    references = re.findall(r'late\("([\w.]+):(\w+)"\)', texts)
    assert len(references) > 10
    for module, name in references:
        tree = ast.parse(source(f"gearmesh/systems/{module.replace('.', '/')}.py"))
        assert name in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}, (module, name)


def test_the_quick_selection_has_something_of_every_package() -> None:
    """Marked in its folder."""
    tests = Path(__file__).parent
    packages = {package for package in MAY_IMPORT if package not in {*SHARED, "samples", "former_names", "kinds"}}
    quick = {file.parent.name for file in tests.glob("*/test_*.py") if "pytest.mark.quick" in file.read_text()}
    assert packages <= quick


#: packages of which each takes 100 MB
LARGE = {"OCP", "gmsh", "pyvista", "vtk", "vtkmodules", "selenium", "build123d", "cadquery", "distributed"}


def _loaded_by_importing(statements: list[ast.stmt]) -> set[str]:
    """Packages that statements of a module import, `pytest.importorskip` included."""
    found = set()
    for statement in statements:
        if isinstance(statement, ast.Import):
            found |= {alias.name for alias in statement.names}
        elif isinstance(statement, ast.ImportFrom):
            found.add(statement.module or "")
        elif isinstance(statement, ast.Expr | ast.Assign) and isinstance(statement.value, ast.Call):
            found |= {str(ast.literal_eval(own)) for own in statement.value.args if isinstance(own, ast.Constant)}
    return {name.partition(".")[0] for name in found}


def test_large_packages_are_loaded_by_the_tests_that_need_them() -> None:
    """Each process that collects the tests has the memory of all that test modules import."""
    texts = {file.name: file.read_text() for file in Path(__file__).parent.rglob("*.py")}
    named = {name: text for name, text in texts.items() if any(package in text for package in LARGE)}
    assert "test_volume.py" in named
    assert {name for name, text in named.items() if _loaded_by_importing(parsed(text).body) & LARGE} == set()


@pytest.mark.quick
def test_tests_take_public_names_from_where_users_take_them() -> None:
    """A test that imports a public object from the module that defines it would not see that the public name is another one."""
    public = {
        name: getattr(place, name) for place in (gearmesh, import_module("gearmesh.kinds")) for name in place.__all__
    }
    pattern = re.compile(r"^\s*from (gearmesh\.[\w.]+) import (\([^)]*\)|.*)$", re.MULTILINE)
    wrong = []
    for file in sorted((PACKAGE.parent / "tests").rglob("test_*.py")):
        for module, names in pattern.findall(file.read_text()):
            for name in set(re.findall(r"\w+", names)) & public.keys() if module != "gearmesh.kinds" else ():
                if getattr(import_module(module), name, None) is public[name]:
                    wrong.append(f"{file.name}: {module}.{name}")
    assert not wrong
