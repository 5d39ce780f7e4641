"""Dependencies in pyproject.toml are the packages that gearmesh imports, no more and no less."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from oracles.places import PACKAGE, ROOT
from oracles.sources import imports

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def names(requirements: list[str]) -> set[str]:
    """Distributions, as normalised names."""
    return {re.split(r"[\s<>=!~;\[]", each)[0].lower().replace("_", "-") for each in requirements}


def imported() -> set[str]:
    """Top-level modules from elsewhere that the package imports anywhere."""
    found = set()
    for path in PACKAGE.rglob("*.py"):
        for node in imports(path.read_text(encoding="utf-8")):
            if isinstance(node, ast.Import):
                found |= {alias.name.split(".")[0] for alias in node.names}
            elif not node.level and node.module:
                found.add(node.module.split(".")[0])
    return found - {*sys.stdlib_module_names, "gearmesh"}


def test_runtime_dependencies_are_what_is_imported() -> None:
    known = packages_distributions()
    extras = names(
        [each for extra, wanted in PROJECT["optional-dependencies"].items() if extra != "test" for each in wanted]
    )
    wanted = names(PROJECT["dependencies"])
    used: set[str] = set()
    for module in imported():
        owners = names(known.get(module, [module]))
        assert owners & (wanted | extras), f"{module}: none of {sorted(owners)} is a dependency or in an extra"
        used |= owners
    assert wanted <= used, f"nothing imports {sorted(wanted - used)}"


@pytest.mark.parametrize("spare", ["lxml", "networkx"])
def test_formats_need_no_library_that_is_not_asked_for(spare: str, tmp_path: Path) -> None:
    """trimesh and meshio import some libraries when they happen to be there: the package works without."""
    program = f"""
import sys
sys.modules[{spare!r}] = None
import numpy as np
from gearmesh import io
from gearmesh.fe.decks.vtu import write_mesh
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.mesh.solid import prove
from gearmesh.mesh.triangles import TriangleMesh
corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
mesh = TriangleMesh(corners, faces, np.zeros(4, np.int32), ("all",), np.zeros((4, 3)))
for suffix in io.formats():
    io.write(mesh, "a" + suffix)
    assert prove(io.read("a" + suffix), 0).ok, suffix
cube = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
write_mesh(HexMesh(cube, np.arange(8)[None], {{}}, {{}}, {{}}), __import__("pathlib").Path("cube.vtu"))
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
