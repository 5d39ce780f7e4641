"""Which module may import which, and what importing gearmesh loads."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "gearmesh"

# A module, or a whole sub-package, may import from earlier rows only; those of one row are independent of each other.
LAYERS: tuple[tuple[str, ...], ...] = (
    ("errors",),
    ("frames",),
    ("mesh", "assembly", "path", "hex_quality", "grading"),
    ("hertz",),
    ("fe_model",),
    ("newton",),
    ("surface",),
    ("envelope", "feed_envelope", "feed_motion", "nearest", "barrel"),
    ("curvature",),
    ("meshing",),
    ("seeds",),
    ("tca",),
    ("cycle",),
    ("tools", "local_synthesis", "bevel_blank", "conjugate", "kinematic_errors"),
    ("face_gear_limits",),
    ("design",),
    ("stations",),
    ("limiting_line",),
    ("tip_edge", "tooth_side"),
    ("undercut",),
    ("tooth",),  # needs only surfaces; the systems hand out teeth
    ("pair",),
    ("limits",),
    ("contact",),  # a pair's teeth handed to the solver
    ("systems",),
    ("synthesis", "sheet"),
    ("tessellate",),
    ("deviation",),
    ("body",),  # what the teeth stand on
    ("solid",),
    ("section_lattice",),
    ("hexmesh", "brep"),
    ("heightfield",),
    ("roll",),
    ("fe_place",),
    ("fe_pair",),
    ("fe_results",),
    ("io",),
    ("ccx",),
    ("occ",),
    ("turned",),
    ("cad",),
    ("opengl",),
    ("scene",),
    ("on_tooth",),
    ("views",),
    ("fe_views",),
    ("plots", "render"),
    ("pictures",),
    ("report",),
    ("fe_job", "limits_job", "solid_job"),
    ("job",),
    ("options", "terminal"),
    ("fe_command", "limits_command"),
    ("cli",),
    ("__main__",),
)
LAYER = {name: i for i, row in enumerate(LAYERS) for name in row}

# Narrower than the order: what these may import, and why.
ONLY: dict[str, set[str]] = {
    # a sphere must be able to test them, without a cutter or a gear
    "curvature": {"errors", "frames", "newton", "surface", "assembly", "path"},
    "meshing": {"errors", "frames", "newton", "surface", "assembly", "path", "curvature"},
    "seeds": {"errors", "frames", "newton", "surface", "assembly", "path", "curvature", "meshing"},
    "tca": {"errors", "frames", "newton", "surface", "assembly", "path", "curvature", "meshing", "seeds"},
    # the independent check of the contact solver shares nothing with it, nor with the surfaces
    "heightfield": {"errors", "frames", "mesh"},
    "roll": {"errors", "frames", "mesh", "assembly", "heightfield"},
    # formats write meshes and know nothing of gears
    "io": {"errors", "frames", "mesh", "fe_model", "hertz"},
}

# Mathematics, and the data it exchanges: knows nothing of files, pictures, validation or terminals.
MATHEMATICS = {name for name in LAYER if LAYER[name] <= LAYER["deviation"] and name != "design"} | {
    "section_lattice",
    "hexmesh",
    "brep",
    "heightfield",
    "roll",
    "fe_place",
    "fe_pair",
    "fe_results",
}

LATE = ("pyvista", "vtk", "vtkmodules", "matplotlib", "manifold3d", "trimesh", "meshio", "pydantic", "typer", "rich")

FILES = sorted(path.relative_to(PACKAGE.parent).as_posix() for path in PACKAGE.rglob("*.py"))


def owner(file: str) -> str:
    """Module or sub-package of gearmesh that a file belongs to; "" for gearmesh/__init__.py."""
    top = Path(file).with_suffix("").parts[1]
    return "" if top == "__init__" else top


def imported(file: str, source: str) -> set[tuple[int, str]]:
    """(line, absolute dotted name) of all imports in a file, at any depth; `from a import b` gives a.b."""
    package = Path(file).parts[:-1]
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {(node.lineno, alias.name) for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            stem = [*base, *(node.module.split(".") if node.module else ())]
            found |= {(node.lineno, ".".join((*stem, alias.name))) for alias in node.names}
    return found


def complaints(file: str, source: str) -> list[str]:
    """What a file imports against the rules, one line each."""
    own = owner(file)
    if own and own not in LAYER:
        return [f"{file}: module {own!r} is in no row of LAYERS in {Path(__file__).name}: decide its place and add it"]
    wrong = []
    for line, name in sorted(imported(file, source)):
        top, *rest = name.split(".")
        where = f"{file}:{line} imports {name}"
        if top != "gearmesh":
            if own in MATHEMATICS and top not in sys.stdlib_module_names and top not in ("numpy", "scipy"):
                wrong.append(f"{where}: {own} may use numpy and scipy only")
            continue
        target = rest[0] if rest else ""
        if own == "" or target == own or target in ("", "__version__"):
            continue
        if target not in LAYER:
            wrong.append(f"{where}: {target!r} is in no row of LAYERS in {Path(__file__).name}")
        elif LAYER[target] >= LAYER[own]:
            wrong.append(f"{where}: {target} does not come before {own} in LAYERS")
        elif own in ONLY and target not in ONLY[own]:
            wrong.append(f"{where}: {own} may import only {', '.join(sorted(ONLY[own]))}")
    return wrong


@pytest.mark.parametrize("file", FILES)
def test_imports_go_down_the_list_only(file: str) -> None:
    wrong = complaints(file, (PACKAGE.parent / file).read_text(encoding="utf-8"))
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    ("file", "source", "words"),
    [
        ("gearmesh/surface.py", "from gearmesh.tca import solve", "tca does not come before surface"),
        ("gearmesh/surface.py", "from gearmesh import frames, solid", "solid does not come before surface"),
        ("gearmesh/tools/rack.py", "def f():\n    from ..systems.beveloid import x", "systems does not come before"),
        ("gearmesh/tools/rack.py", "from . import worm\nfrom gearmesh.tools import disk", None),
        ("gearmesh/mesh.py", "import gearmesh.path", "path does not come before mesh"),
        ("gearmesh/tca.py", "from gearmesh.envelope import Envelope", "tca may import only"),
        ("gearmesh/errors.py", "from gearmesh.frames import Array", "frames does not come before errors"),
        ("gearmesh/errors.py", "from gearmesh import __version__", None),
        ("gearmesh/tooth.py", "import pyvista as pv", "numpy and scipy only"),
        ("gearmesh/novelty.py", "import numpy", "'novelty' is in no row"),
        ("gearmesh/cli.py", "from gearmesh.novelty import x", "'novelty' is in no row"),
    ],
)
def test_rules_catch_what_they_should(file: str, source: str, words: str | None) -> None:
    found = complaints(file, source)
    assert (words is None and not found) or (words is not None and len(found) == 1 and words in found[0])


# gear systems may read their typed designs, and so load what those need
@pytest.mark.parametrize(
    "modules", [["gearmesh"], sorted(MATHEMATICS - {"systems", "synthesis"})], ids=["package", "mathematics"]
)
def test_importing_loads_nothing_heavy(modules: list[str]) -> None:
    """`import gearmesh`, and tca with the other mathematics, in a fresh interpreter."""
    present = [
        name
        for name in modules
        if name == "gearmesh" or {f"gearmesh/{name}.py", f"gearmesh/{name}/__init__.py"} & {*FILES}
    ]
    program = (
        "import importlib, json, sys\n"
        f"for name in {present!r}: importlib.import_module(name if name == 'gearmesh' else 'gearmesh.' + name)\n"
        "print(json.dumps(sorted({name.split('.')[0] for name in sys.modules})))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=PACKAGE.parent
    )
    assert run.returncode == 0, run.stderr
    loaded = set(json.loads(run.stdout))
    assert "gearmesh" in loaded
    assert not loaded & {*LATE}
