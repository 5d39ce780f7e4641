"""Start-up: whole commands against `python -c 'import numpy'`, and time and size of each dependency.

    python scripts/start_bench.py [--rounds 9] [--write]

CPU seconds of whole processes, the median of rounds in which every command runs once beside numpy, so that other work on the
machine counts for all alike; the compiled files of the package are there, as after an installation. `--write` keeps the tables
`start` and `dependencies` in scripts/measured.
"""

from __future__ import annotations

import argparse
import re
import statistics
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

import tables
from processes import measured

ROOT = Path(__file__).parent.parent
#: commands, {} where a file is written, and the ratio that was asked for
COMMANDS = {
    "--help": 2.0,
    "describe": 3.0,
    "describe hypoid": 3.0,
    "solid samples/helical.toml --member pinion -o {}.stl": 6.0,
    "tca samples/helical.toml": 8.0,
    "render samples/helical.toml -o {}.png": "",
}
#: what dependencies are for, the module that is imported, and by which command first; others are loaded when they are needed
USES = {
    "numpy": ("numpy", "all that computes"),
    "scipy": (
        "scipy.spatial",
        "contact under load, STEP of sectors, DXF, the roll test; not `solid`, not `tca`, not pictures of teeth",
    ),
    "threadpoolctl": ("threadpoolctl", "contact under load"),
    "trimesh": ("trimesh", "solids handed over in Python"),
    "meshio": ("meshio", "ease-off and finite-element meshes as VTU"),
    "pyvista": ("pyvista", "solids and models handed over in Python"),
    "vtk": ("vtkmodules.vtkRenderingOpenGL2", "pictures in three dimensions"),
    "manifold3d": ("manifold3d", "proof that a solid has no self-intersection"),
    "pydantic": ("pydantic.main", "keys of design files; options"),
    "pydantic-core": ("pydantic_core", "keys of design files; options"),
    "typer": ("typer", "the command line"),
    "tomli-w": ("tomli_w", "designs written as TOML"),
    "rich": ("rich.table", "tables and progress on a terminal"),
    "matplotlib": ("matplotlib.figure", "plots, drawings"),
    "pillow": ("PIL.Image", "animations"),
    "lazy-loader": ("lazy_loader", "public names, each when it is first used"),
}
COLUMNS = {
    "start": {
        "command": "command, as a whole process",
        "seconds": "CPU, s",
        "ratio": "times `import numpy`",
        "asked": "asked",
        "modules": "modules of scipy loaded",
    },
    "dependencies": {
        "name": "dependency",
        "megabytes": "on disk, MB",
        "seconds": "import alone, CPU s",
        "used": "loaded for",
    },
}


def cpu_seconds(command: Sequence[str]) -> float:
    """CPU seconds of a process, children included. Raises CalledProcessError where it fails."""
    return measured(command, ROOT).cpu


def start(rounds: int) -> list[dict[str, Any]]:
    """Rows of the commands, beside numpy, which comes first."""
    with TemporaryDirectory() as folder:
        programs = {"python -c 'import numpy'": [sys.executable, "-c", "import numpy"]}
        for command in COMMANDS:
            words = command.replace("{}", f"{folder}/part").split()
            programs[f"gearmesh {command.replace('{}', 'part')}"] = [sys.executable, "-m", "gearmesh", *words]
        times: dict[str, list[float]] = {name: [] for name in programs}
        # the first round compiles the package
        for k in range(rounds + 1):
            for name, program in programs.items():
                seconds = cpu_seconds(program)
                times[name] += [seconds] if k else []
        scipys = {name: scipy_modules(program) for name, program in programs.items()}
    numpy = statistics.median(times["python -c 'import numpy'"])
    asked = dict(zip(programs, ["", *COMMANDS.values()], strict=True))
    return [
        {"command": name, "seconds": (s := statistics.median(times[name])), "ratio": s / numpy}
        | {"asked": asked[name], "modules": scipys[name]}
        for name in programs
    ]


def scipy_modules(program: Sequence[str]) -> int:
    """Return the number of modules of scipy that a Python program loads."""
    run = subprocess.run(
        [program[0], "-X", "importtime", *program[1:]], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return len(re.findall(r"\|\s+scipy[\w.]*$", run.stderr, re.MULTILINE))


def direct_dependencies() -> list[str]:
    """Names of the dependencies in pyproject.toml, without those of extras."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [_name(text) for text in project["dependencies"]]


def dependencies(rounds: int) -> list[dict[str, Any]]:
    """Rows of what pyproject.toml asks for without extras, the largest first; MB with what only it brings."""
    direct = direct_dependencies()
    needed = {name: brought(name) for name in direct}
    bare = min(cpu_seconds([sys.executable, "-c", "pass"]) for _ in range(rounds))
    rows = []
    for name in direct:
        others = {one for other in direct if other != name for one in needed[other]}
        own = {name} | (needed[name] - others - {*direct})
        module, used = USES[name]
        alone = min(cpu_seconds([sys.executable, "-c", f"import {module}"]) for _ in range(rounds))
        rows.append(
            {"name": name, "megabytes": sum(map(megabytes, own)), "seconds": max(alone - bare, 0.0), "used": used}
        )
    shared = {one for name in direct for one in needed[name]} - {*direct}
    several = {one for one in shared if sum(one in needed[name] for name in direct) > 1}
    rows.sort(key=lambda row: -row["megabytes"])
    everything = {*direct, *shared}
    return [
        *rows,
        {"name": "brought by several", "megabytes": sum(map(megabytes, several)), "used": ", ".join(sorted(several))},
        {"name": "all", "megabytes": sum(map(megabytes, everything))},
    ]


def brought(name: str) -> set[str]:
    """Distributions that one needs, itself among them, without extras."""
    known, waiting = set[str](), [name]
    while waiting:
        one = waiting.pop()
        if one in known:
            continue
        try:
            requirements = distribution(one).requires or []
        except PackageNotFoundError:
            continue
        known.add(one)
        waiting += [_name(text) for text in requirements if ";" not in text]
    return known


def megabytes(name: str) -> float:
    """Return the size of the files of a distribution, MB."""
    files = distribution(name).files or []
    paths = (Path(str(file.locate())) for file in files)
    return sum(path.stat().st_size for path in paths if path.is_file()) / 1e6


def _name(requirement: str) -> str:
    return re.split(r"[\s<>=!~;\[(]", requirement)[0].lower().replace("_", "-")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--write", action="store_true", help="keep the tables in scripts/measured")
    options = parser.parse_args()
    for name, measure in {"start": start, "dependencies": dependencies}.items():
        rows = measure(options.rounds)
        print(tables.table(rows, COLUMNS[name]), end="\n\n")
        if options.write:
            tables.keep(name, rows, COLUMNS[name])


if __name__ == "__main__":
    main()
