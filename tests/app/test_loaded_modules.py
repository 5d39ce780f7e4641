"""Modules that commands load when they start: time at the start is time for modules."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from oracles.places import ROOT

#: libraries that are loaded for what they do alone
LIBRARIES = (
    *("scipy", "matplotlib", "PIL", "pyvista", "vtkmodules", "trimesh", "meshio", "pandas", "manifold3d", "rich"),
    "numpy.ma",
)
#: packages of gearmesh likewise
PARTS = (
    *("contact", "loaded", "check", "fe", "toolpath", "study", "drawing", "view", "reports"),
    *("mesh.tessellate", "mesh.hexahedra"),
)
#: commands, {} for a folder, and which of these they load
LOADED = {
    "solid samples/helical.toml --member pinion --tol 50um -o {}/part.stl": {"manifold3d", "mesh.tessellate"},
    "render samples/spur.toml --phi1 0 --size 160x120 -o {}/part.png": {
        *("PIL", "contact", "manifold3d", "mesh.tessellate", "reports", "view")
    },
    "tca samples/spur.toml": {"contact"},
    # of view only what starts the drawing process
    "--help": {"view"},
}


@pytest.mark.parametrize("command", LOADED, ids=lambda command: command.split()[0])
@pytest.mark.sweep_cases("render", "solid", "tca")
def test_a_command_loads_what_it_needs(command: str, tmp_path: Path) -> None:
    program = (
        "import sys, numpy\n"
        "numpys = set(sys.modules)\n"
        "from gearmesh.app.cli import main\n"
        f"assert main({command.format(tmp_path).split()!r}) == 0\n"
        f"found = [name for name in {LIBRARIES!r} if name in set(sys.modules) - numpys]\n"
        f"found += [name for name in {PARTS!r} if 'gearmesh.' + name in sys.modules]\n"
        "print(*found, file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert set(done.stderr.splitlines()[-1].split()) == LOADED[command]
