"""Two versions of gearmesh side by side: whole commands in turns, each version in an environment of its own.

`python scripts/bench.py --against 0.17.0` calls this module. The other version is taken from the history of the checkout, by a
version number or by any revision that git knows; this one is the checkout as it is. Both get the same versions of all libraries.
"""

from __future__ import annotations

import json
import math
import statistics
import subprocess
import sys
import tarfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

import tables
from processes import Measured, measured

ROOT = Path(__file__).parent.parent
#: figures of two versions are equal if they differ by less than this, relative, or absolute for figures below 1
FIGURE_TOLERANCE = 1e-12
#: keys whose values are times, versions, rounding or names of files, which may differ
NOT_FIGURES = frozenset({"seconds", "timing", "gearmesh", "files", "max_residual_mm"})
#: what both environments are installed with
EXTRAS = "step"


@dataclass(frozen=True)
class Command:
    """A command whose time is measured, and where its figures and its error stand.

    words: arguments of `gearmesh`; {out} is a folder of the run's own.
    figures: JSON file of the figures, in that folder, "" for what the command prints, None for no figures.
    error: path of the error in the figures, keys between dots; * is the largest of a list or table. None for no error.
    unit: unit of the error.
    """

    words: str
    figures: str | None = None
    error: str | None = None
    unit: str = ""


def _run(sample: str) -> Command:
    words = f"run samples/{sample}.toml -o {{out}}/run"
    return Command(words, "run/report.json", "mesh.*.max_deviation_um", "um")


def _contact(sample: str) -> Command:
    return Command(f"tca samples/{sample}.toml --json -", "", "summary.max_residual_mm", "mm")


def _solid(sample: str, member: str, tolerance: str) -> Command:
    words = f"solid samples/{sample}.toml --member {member} --tol {tolerance} -o {{out}}/solid.stl"
    return Command(words, "", "max_deviation_um", "um")


COMMANDS = {
    "run beveloid_crossed": _run("beveloid_crossed"),
    "run helical": _run("helical"),
    "run spiral_bevel_basic": _run("spiral_bevel_basic"),
    "run hypoid": _run("hypoid"),
    "run worm_drive": _run("worm_drive"),
    "report helical": Command("report samples/helical.toml -o {out}/page.html"),
    "report spiral_bevel_basic": Command("report samples/spiral_bevel_basic.toml -o {out}/page.html"),
    "render helical, tooth": Command("render samples/helical.toml -o {out}/tooth.png"),
    "render spiral_bevel_basic, pair": Command("render samples/spiral_bevel_basic.toml --view pair -o {out}/pair.png"),
    "render helical, loaded": Command("render samples/helical.toml --view loaded --torque 500 -o {out}/loaded.png"),
    "load helical, 500 Nm": Command("load samples/helical.toml --torque 500 --json -", ""),
    "fe beveloid_crossed, three teeth": Command("fe samples/beveloid_crossed.toml --torque 50 -o {out}/pair.inp"),
    "study spiral_bevel_basic, 25 assemblies": Command(
        "study samples/spiral_bevel_basic.toml --vary assembly.dV=-0.05:0.05:5 --vary assembly.dA=-0.05:0.05:5 --workers 1"
        " --no-pictures -o {out}/study",
        "study/study.json",
    ),
    "help": Command("--help"),
    "describe helical": Command("describe samples/helical.toml --json -", ""),
    "tca helical": _contact("helical"),
    "tca spiral_bevel_basic": _contact("spiral_bevel_basic"),
    "solid helical, 10 um": _solid("helical", "pinion", "10um"),
    "solid spiral_bevel_basic, 10 um": _solid("spiral_bevel_basic", "pinion", "10um"),
    "solid worm_drive_zk_oversize, 10 um": _solid("worm_drive_zk_oversize", "worm", "10um"),
    "solid face_gear, 1 um": _solid("face_gear", "gear", "1um"),
    "STEP of the pair helical": Command("solid samples/helical.toml --member all -o {out}/pair.step"),
    "STEP of the gear of spiral_bevel_basic": Command(
        "solid samples/spiral_bevel_basic.toml --member gear -o {out}/gear.step"
    ),
}
COLUMNS = {
    "command": "command",
    "version": "version before",
    "cpu_before": "CPU before, s",
    "cpu": "now, s",
    "ratio": "before / now",
    "spread": "in the rounds",
    "rounds": "rounds",
    "megabytes_before": "peak before, MB",
    "megabytes": "now, MB",
    "error_before": "error before",
    "error": "now",
    "figures": "figures compared",
    "differ": "that differ",
}


def revision(version: str) -> str:
    """Last commit that has a version number, or the commit of any other revision. Raises SystemExit for neither."""
    line = f'__version__ = "{version}"'
    found = _git("log", "-1", "--format=%H", f"-S{line}", "--", "gearmesh/__init__.py").decode().strip()
    if found and line not in _git("show", f"{found}:gearmesh/__init__.py").decode():
        # the newest commit that touches the line takes it away: the one before still has it
        return _git("rev-parse", f"{found}^").decode().strip()
    if found:
        return _git("rev-parse", "HEAD").decode().strip()
    try:
        return _git("rev-parse", "--verify", "--quiet", f"{version}^{{commit}}").decode().strip()
    except subprocess.CalledProcessError:
        raise SystemExit(f"--against {version}: must be a version number or a revision of this checkout") from None


def _git(*words: str) -> bytes:
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, check=True).stdout


def environment(folder: Path, source: Path, libraries: Path) -> Path:
    """Python of a new environment in which the package of a source tree is installed, with libraries of given versions."""
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    python = folder / "bin" / "python"
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-c", libraries]
    subprocess.run([*install, f"{source}[{EXTRAS}]"], check=True)
    return python


def versions_here(folder: Path) -> Path:
    """File that pins the libraries of this environment, for both new ones."""
    frozen = subprocess.run([sys.executable, "-m", "pip", "freeze"], capture_output=True, text=True, check=True).stdout
    lines = [line for line in frozen.splitlines() if "==" in line]
    path = folder / "libraries.txt"
    path.write_text("\n".join(lines) + "\n")
    return path


def run_of(python: Path, command: Command, folder: Path) -> tuple[Measured, Any]:
    """One run in a folder that exists: what it took, and its figures. Raises CalledProcessError where it fails.

    Exit status 3 is a check of the design that fails, not a failure of the command.
    """
    words = command.words.replace("{out}", str(folder)).split()
    printed = folder / "printed"
    took = measured([python, "-m", "gearmesh", *words], _samples(folder), printed, folder / "said", (0, 3))
    figures = None
    if command.figures is not None:
        figures = figures_of((folder / command.figures if command.figures else printed).read_text(encoding="utf-8"))
    return took, figures


def figures_of(text: str) -> Any:
    """Figures of a JSON text, or of the lines of a printed table that are a key and a number."""
    if text.lstrip().startswith("{"):
        return json.loads(text)
    rows = (line.split() for line in text.splitlines())
    return {row[0]: float(row[1]) for row in rows if len(row) == 2 and _is_number(row[1])}


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _samples(folder: Path) -> Path:
    """Return a folder with the samples but without the checkout's package, which Python would import instead of the installed
    one."""
    link = folder / "samples"
    if not link.exists():
        link.symlink_to(ROOT / "samples")
    return folder


def leaves(value: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Paths and values of all figures of a JSON value, times and names of files left out."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if key not in NOT_FIGURES:
                yield from leaves(inner, (*path, key))
    elif isinstance(value, Sequence) and not isinstance(value, str):
        for k, inner in enumerate(value):
            yield from leaves(inner, (*path, str(k)))
    else:
        yield path, value


def differing(before: Any, now: Any) -> tuple[int, list[str]]:
    """Count of the figures that both versions have, and the paths of those that differ by more than rounding."""
    old, new = dict(leaves(before)), dict(leaves(now))
    common = [path for path in old if path in new]
    return len(common), [".".join(path) for path in common if not same(old[path], new[path])]


def same(one: Any, two: Any) -> bool:
    """True for equal values, and for numbers that are equal within `FIGURE_TOLERANCE`."""
    numbers = [value for value in (one, two) if isinstance(value, int | float) and not isinstance(value, bool)]
    if len(numbers) < 2:
        return bool(one == two)
    return math.isclose(one, two, rel_tol=FIGURE_TOLERANCE, abs_tol=FIGURE_TOLERANCE)


def error_of(figures: Any, path: str) -> float:
    """Largest value at a path of keys between dots, * for all of a table or list. Raises KeyError where there is none."""
    values = [figures]
    for key in path.split("."):
        if key == "*":
            values = [inner for value in values for inner in (value.values() if isinstance(value, Mapping) else value)]
        else:
            values = [value[key] for value in values]
    return float(max(values))


def row(name: str, command: Command, pythons: tuple[Path, Path], rounds: int, folder: Path) -> dict[str, Any]:
    """Figures of one command: medians over rounds in which the two versions run one after the other.

    The modules are compiled: pip does that when it installs them.
    """
    runs: list[tuple[Measured, Measured]] = []
    figures: list[Any] = [None, None]
    for k in range(rounds):
        both = []
        for side, python in enumerate(pythons):
            place = folder / f"{k}-{side}"
            place.mkdir()
            took, figures[side] = run_of(python, command, place)
            both.append(took)
        runs.append((both[0], both[1]))
    ratios = [before.cpu / now.cpu for before, now in runs]
    found: dict[str, Any] = {"command": name, "ratio": statistics.median(ratios), "rounds": rounds}
    found["spread"] = f"{min(ratios):.2f} to {max(ratios):.2f}"
    for side, suffix in enumerate(("_before", "")):
        found[f"cpu{suffix}"] = statistics.median(pair[side].cpu for pair in runs)
        found[f"megabytes{suffix}"] = round(max(pair[side].megabytes for pair in runs))
        if command.error:
            found[f"error{suffix}"] = f"{error_of(figures[side], command.error):.3g} {command.unit}"
    if command.figures is not None:
        found["figures"], paths = differing(*figures)
        found["differ"], found["differing"] = len(paths), paths
    return found


def keep(rows: Sequence[Mapping[str, Any]]) -> None:
    """Keep rows in scripts/measured; the rows of other commands stay there if they are of the same version."""
    try:
        known = tables.kept("against")
    except ValueError:
        known = []
    keys = [*COLUMNS]
    old = [dict(zip(keys, row.values(), strict=True)) for row in known]
    versions = {row["version"] for row in rows}
    by_command: dict[str, tables.Row] = {row["command"]: row for row in old if row["version"] in versions}
    by_command |= {row["command"]: row for row in rows}
    tables.keep("against", [by_command[name] for name in COMMANDS if name in by_command], COLUMNS)


def compare(version: str, names: Sequence[str], rounds: int) -> Iterator[dict[str, Any]]:
    """Rows of the commands of given names, one after the other. Raises SystemExit for an unknown version."""
    commit = revision(version)
    with TemporaryDirectory() as name:
        folder = Path(name)
        libraries = versions_here(folder)
        with tarfile.open(fileobj=BytesIO(_git("archive", commit))) as tree:
            tree.extractall(folder / "before", filter="data")
        pythons = (
            environment(folder / "env-before", folder / "before", libraries),
            environment(folder / "env-now", ROOT, libraries),
        )
        for k, command in enumerate(names):
            work = folder / f"work-{k}"
            work.mkdir()
            yield {"version": version, **row(command, COMMANDS[command], pythons, rounds, work)}
