"""CalculiX CrunchiX (ccx) as an external program: run a deck, and read the results.

Results come from two files: fields at the nodes from the .frd (six digits), and sums from the .dat.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError, OutputError
from gearmesh.fe.decks.inp import reference_nodes, write_modes, write_solved
from gearmesh.fe.model import Model
from gearmesh.fe.results import ContactTotal, NodalSolution, ReferenceNode
from gearmesh.formats import INP_SUFFIX
from gearmesh.io.atomic import PathLike, files_together, scratch_folder
from gearmesh.kernel.numeric.algebra import Array

#: environment variable with the path of the program, if `ccx` is not on the PATH
CCX_VARIABLE = "GEARMESH_CCX"
#: message without the program
MISSING_CCX = "CalculiX is not installed: apt-get install calculix-ccx (or name the program in GEARMESH_CCX)"

#: message for bodies that do not touch at the start
NOT_TOUCHING = (
    "ccx finds no contact at the start, and nothing else supports the loaded body: let the bodies overlap by about half the "
    "elastic approach under the load, by more where facets are coarse"
)

#: Callback with the share of the work that is done (0 to 1) and a description of the step
Progress = Callable[[float, str], None]

#: files of a solution that may be kept: deck, fields, tables, increments, iterations, what ccx printed
KEPT_SUFFIXES = (INP_SUFFIX, ".frd", ".dat", ".sta", ".cvg", ".log")

#: name of the deck without its suffix
_JOB_NAME = "model"
#: characters of a number in an .frd file
_FRD_WIDTH = 12
#: time between two looks at the running solver, s
_SECONDS_BETWEEN_LOOKS = 0.2


def program() -> str:
    """Return the path of ccx. Raises OutputError, with the command that installs it, if there is none."""
    path = shutil.which(os.environ.get(CCX_VARIABLE) or "ccx")
    if path is None:
        raise OutputError(reason=MISSING_CCX)
    return path


def solve(
    model: Model, progress: Progress | None = None, threads: int | None = None, keep: PathLike | None = None
) -> NodalSolution:
    """Solve a model in a temporary folder; the number of threads is by default that of the environment.

    The folder `keep` gets the deck and the files of ccx (`KEPT_SUFFIXES`), also if ccx fails.
    Raises OutputError if ccx is missing. Raises NoSolutionError, with ccx's message, if ccx fails, or if bodies that
    only contact holds do not touch at the start.
    """
    loose = bool(model.contacts) and any(tie.is_loaded for tie in model.ties)
    with _solved(partial(write_solved, model), progress, threads, keep, must_touch=loose) as folder:
        return read(model, folder)


def frequencies(
    model: Model, count: int, progress: Progress | None = None, threads: int | None = None, keep: PathLike | None = None
) -> list[float]:
    """Return the lowest `count` natural frequencies, Hz, of a model without contact, as it is held.

    Raises the errors of `solve`.
    """
    with _solved(partial(write_modes, model, count=count), progress, threads, keep) as folder:
        text = (folder / f"{_JOB_NAME}.dat").read_text()
    # rows: mode, eigenvalue, frequency in rad/s, in Hz, imaginary part
    table = text.partition("E I G E N V A L U E   O U T P U T")[2].partition("P A R T I C I P A T I O N")[0]
    rows = [line.split() for line in table.splitlines()]
    found = [float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()]
    if len(found) < count:
        raise NoSolutionError(reason=f"ccx found {len(found)} of {count} natural frequencies")
    return found[:count]


@contextmanager
def _solved(
    write: Callable[[Path], None],
    progress: Progress | None,
    threads: int | None,
    keep: PathLike | None,
    must_touch: bool = False,
) -> Iterator[Path]:
    """Yield a temporary folder in which ccx has solved the deck that `write` writes. Arguments are those of `solve` and `run`."""
    executable = program()
    with scratch_folder() as folder:
        write(folder / f"{_JOB_NAME}{INP_SUFFIX}")
        try:
            run(executable, folder, progress, threads, must_touch)
        finally:
            if keep is not None:
                _keep(folder, keep)
        yield folder


def _keep(folder: Path, target: PathLike) -> None:
    """Copy the deck and the files of ccx from `folder` to another folder."""
    with files_together(target) as temporary:
        for suffix in KEPT_SUFFIXES:
            file = folder / f"{_JOB_NAME}{suffix}"
            if file.exists():
                shutil.copyfile(file, temporary / file.name)


def run(
    executable: str,
    folder: Path,
    progress: Progress | None = None,
    threads: int | None = None,
    must_touch: bool = False,
) -> None:
    """Run ccx on the deck model.inp in `folder`; stop it early if the bodies `must_touch` at the start and do not.

    Raises NoSolutionError if it fails.
    """
    environment = dict(os.environ)
    if threads is not None:
        environment |= {"OMP_NUM_THREADS": str(threads)}
    output = folder / f"{_JOB_NAME}.log"
    with open(output, "wb") as stream:
        child = subprocess.Popen(
            [executable, "-i", _JOB_NAME],
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=stream,
            stderr=stream,
        )
        try:
            _wait(child, folder, progress, output if must_touch else None)
        finally:  # an interrupted run does not go on by itself
            child.kill()
            child.wait()
    text = output.read_text(encoding="utf-8", errors="replace")
    if child.returncode or "Job finished" not in text or "*ERROR" in text:
        raise NoSolutionError(reason=f"ccx: {_complaint(text, child.returncode)}")


def _wait(child: subprocess.Popen[bytes], folder: Path, progress: Progress | None, watched: Path | None) -> None:
    """Wait for ccx and report progress when its table of convergence grows; stop it if the `watched` output reports no
    contact."""
    known_rows = 0
    while True:
        try:
            child.wait(_SECONDS_BETWEEN_LOOKS)
            return
        except subprocess.TimeoutExpired:
            rows = list(_table(folder / f"{_JOB_NAME}.cvg", 9))
        # without contact ccx would search an equilibrium through six cutbacks of sixty iterations
        if watched is not None and _first_contacts(watched) == 0:
            raise NoSolutionError(reason=NOT_TOUCHING)
        if progress is not None and len(rows) > known_rows:
            progress(_share_done(folder, int(rows[-1][3])), _doing(rows[-1]))
        known_rows = len(rows)


def _first_contacts(output: Path) -> int | None:
    """Return the number of contact elements at the start; None before ccx has counted them."""
    match = re.search(rb"contact spring elements=(\d+)\n", output.read_bytes())
    return int(match[1]) if match else None


def _share_done(folder: Path, iteration: int) -> float:
    """Return the time reached in the step plus an estimate: each iteration since takes a fifth of the remaining
    time."""
    rows = list(_table(folder / f"{_JOB_NAME}.sta", 7))
    done = float(rows[-1][5]) if rows else 0.0
    return done + (1.0 - done) * (1.0 - 0.8**iteration)


def _doing(row: list[str]) -> str:
    _, increment, _, iteration, contacts, residual, correction, *_ = row
    return (
        f"ccx: increment {increment}, iteration {iteration}: {contacts} contact elements,"
        f" residual {float(residual):.2g} %, correction {float(correction):.2g} %"
    )


def _table(file: Path, columns: int) -> Iterator[list[str]]:
    """Return rows of numbers in a file to which ccx may still be writing."""
    if file.exists():
        for line in file.read_text(errors="replace").splitlines():
            row = line.split()
            if len(row) == columns and row[0].isdigit():
                yield row


def _complaint(text: str, status: int) -> str:
    """Return the first error of ccx, with its continuation lines, as one line."""
    match = re.search(r"\*ERROR:?\s*(.*(?:\n[ \t]+\S.*){0,3})", text)
    if match is None:
        return f"it stopped with status {status} and said nothing"
    return " ".join(match[1].split())


def read(model: Model, folder: Path) -> NodalSolution:
    """Read the results of a finished run. Raises NoSolutionError for files that ccx left incomplete."""
    blocks = _frd(folder / f"{_JOB_NAME}.frd")
    try:
        displacement, stress = blocks["DISP"], blocks["STRESS"]
    except KeyError as missing:
        raise NoSolutionError(reason=f"ccx wrote no {missing} results") from None
    count = len(model.mesh.nodes)
    contact = _spread(*blocks["CONTACT"], count) if "CONTACT" in blocks else np.zeros((count, 4))
    totals, point_stress = _tables(folder / f"{_JOB_NAME}.dat", len(model.mesh.elements))
    rows = list(_table(folder / f"{_JOB_NAME}.sta", 7))
    return NodalSolution(
        displacement=_spread(*displacement, count)[:, :3],
        stress=_spread(*stress, count),
        pressure=contact[:, 3],
        references=_references(model, totals),
        contacts=tuple(_contact(totals, pair.slave, pair.master) for pair in model.contacts),
        iterations=int(rows[-1][3]),
        point_stress=point_stress,
    )


def _spread(nodes: NDArray[np.int64], values: Array, count: int) -> Array:
    """Return values in the order of the mesh's nodes; reference nodes, which have higher numbers, are dropped."""
    out = np.zeros((count, values.shape[1]))
    kept = nodes <= count
    out[nodes[kept] - 1] = values[kept]
    return out


def _frd(file: Path) -> dict[str, tuple[NDArray[np.int64], Array]]:
    """Read the last block of each result in an ASCII .frd: node numbers (K,) and values (K, components).

    Every row of a block has the same length: `-1`, the node (10 characters), then 12 characters per component.
    """
    data = file.read_bytes()
    blocks: dict[str, tuple[NDArray[np.int64], Array]] = {}
    for head in re.finditer(rb"\n -4  (\w+) .*\n((?: -5 .*\n)+)", data):
        start = head.end()
        width = data.index(b"\n", start) + 1 - start
        stop = data.index(b"\n -3", start - 1) + 1
        rows = np.frombuffer(data, "S1", stop - start, start).reshape(-1, width)
        numbers = np.ascontiguousarray(rows[:, 3:13]).view("S10")[:, 0].astype(np.int64)
        fields = np.ascontiguousarray(rows[:, 13:-1]).view(f"S{_FRD_WIDTH}").astype(float)
        blocks[head[1].decode()] = numbers, fields
    return blocks


def _tables(file: Path, elements: int) -> tuple[str, Array | None]:
    """Return the text of a .dat without stresses at integration points, and the last of these stresses (E, P, 6).

    Every row has the same length: element (10 characters), point (4), then 14 characters per component xx, yy, zz, xy,
    xz, yz.
    """
    data = file.read_bytes()
    stress, kept, done = None, [], 0
    for head in re.finditer(rb"\n stresses \(elem.*\n\n", data):
        start = head.end()
        width = data.index(b"\n", start) + 1 - start
        end = data.find(b"\n\n", start)
        count = (len(data) if end < 0 else end + 1) - start
        rows = np.frombuffer(data, "S1", count, start).reshape(-1, width)
        fields = np.ascontiguousarray(rows[:, 14:-1]).view("S14").astype(float)
        stress = fields.reshape(elements, -1, 6)[:, :, [0, 1, 2, 3, 5, 4]]
        kept.append(data[done : head.start()])
        done = start + count
    return b"".join([*kept, data[done:]]).decode(), stress


def _references(model: Model, totals: str) -> dict[str, ReferenceNode]:
    numbers = reference_nodes(model)
    return {
        tie.node_set: ReferenceNode(
            displacement=_node(totals, "displacements", reference),
            rotation=_node(totals, "displacements", rotation),
            force=_node(totals, "forces", reference),
            moment=_node(totals, "forces", rotation),
        )
        for tie, (reference, rotation) in zip(model.ties, numbers, strict=True)
    }


def _node(totals: str, quantity: str, number: int) -> Array:
    """Return the last vector that is printed for a node."""
    rows = re.findall(rf"^ {quantity} \(.*\n\n +{number} +(.*)$", totals, re.MULTILINE)
    return np.array(rows[-1].split(), float)


def _contact(totals: str, slave: str, master: str) -> ContactTotal:
    title = f"statistics for slave set {slave.upper()}, master set {master.upper()} and time"
    rows = [line.split() for line in totals[totals.rindex(title) :].splitlines()[1:] if _is_numbers(line)]
    force = np.array(rows[0], float)
    return ContactTotal(force[:3], force[3:], float(rows[3][0]))


def _is_numbers(line: str) -> bool:
    # ccx prints averages over faces that do not touch as NaN
    return re.fullmatch(r"(\s+([-+.\dE]+|NaN))+\s*", line) is not None
