"""Run time, memory and error of loaded contact over grids, elements, positions and torques; errors are against the finest.

    python scripts/load_bench.py [--write]

Each row runs in a process of its own, for its memory; CPU seconds do not depend on what else the machine does. `--write` keeps
the table in scripts/measured, and with it the table of the sample `te_under_torque`.
"""

from __future__ import annotations

import argparse
import resource
import runpy
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

import tables

import gearmesh as gm
from gearmesh.contact.hertz import STEEL
from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.loaded.compliance.compliance import SECTOR_CELLS as ELEMENTS
from gearmesh.loaded.compliance.compliance import flank_compliance
from gearmesh.loaded.sharing import CONTACT_CELLS, loaded_mesh
from gearmesh.mesh.hexahedra.hexahedra import Cells

ROOT = Path(__file__).parents[1]
SAMPLES = ROOT / "samples"


@dataclass(frozen=True)
class Case:
    """A pair under torques (Nm) at even positions of a pitch, on grids of cells along and across, with elements of a sector."""

    sample: str
    torque: tuple[float, ...]
    positions: int = 9
    cells: tuple[int, int] = CONTACT_CELLS
    elements: Cells = ELEMENTS


#: what is made finer, the last of each the finest, against which the others are held
GRIDS = ((20, 12), (40, 24), (80, 48))
FINER = (
    Cells(flank=6, fillet=4, thickness=3, rim=4, face=8),
    ELEMENTS,
    Cells(flank=14, fillet=11, thickness=4, rim=7, face=20),
)
POSITIONS = (5, 9, 21, 42)
#: torques as shares of that of the pair
TORQUES = ((1.0,), (0.5, 1.0, 2.0), (0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.7, 2.0))
#: a pair of points and one of lines, with torques, Nm, that they may have in use
PAIRS = (Case("spiral_bevel_basic", (50.0,)), Case("helical", (600.0,)))
COLUMNS = {
    "sample": "pair",
    "cells": "cells of a contact",
    "elements": "elements of a flank",
    "positions": "positions",
    "torques": "torques",
    "bodies": "bodies, CPU s",
    "contact": "contact, CPU s",
    "megabytes": "peak, MB",
    "rotation": "rotation error, %",
    "te": "TE, %",
    "pressure": "pressure, %",
    "stress": "root stress, %",
}
#: columns of the table of transmission error under growing torque
UNDER_TORQUE = {
    "pair": "pair",
    "torque": "torque, Nm",
    "peak_to_peak_arcsec": "TE peak to peak, arcsec",
    "middle_arcsec": "in the middle of the mesh, arcsec",
    "pressure_mpa": "pressure, MPa",
}


def measured(case: Case) -> dict[str, Any]:
    """A row of the table, with what errors are taken of."""
    pair = gm.build(gm.load(SAMPLES / f"{case.sample}.toml")).pairs[0]
    started = time.process_time()
    first, second = (
        flank_compliance(member.tooth, side, STEEL, case.elements)
        for member, side in zip(pair.both, pair.flanks, strict=True)
    )
    built = time.process_time()
    phi1 = pair.pitch * np.arange(case.positions) / case.positions
    found = loaded_mesh(pair, phi1, 1e3 * np.array(case.torque), (first, second), cells=case.cells)
    ended = time.process_time()
    return {
        "sample": case.sample,
        "cells": "{} x {}".format(*case.cells),
        "elements": f"{case.elements.flank} x {case.elements.face}",
        "positions": case.positions,
        "torques": len(case.torque),
        "bodies": built - started,
        "contact": ended - built,
        "megabytes": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
        "converged": bool((found.status == Status.CONVERGED).all()),
        "of": {
            "rotation": found.rotation,
            "te": np.ptp(found.te, axis=1) / ARCSEC,
            "pressure": np.array([np.nanmax(load.peak) for load in found.loads]),
            "stress": found.root_stress.max(axis=1),
        },
    }


def alone(case: Case) -> dict[str, Any]:
    """The same in a process of its own."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        row = pool.submit(measured, case).result()
    print(", ".join(f"{key} {tables.cell(value)}" for key, value in row.items() if key != "of"), flush=True)
    return row


def finer(cases: list[Case]) -> list[dict[str, Any]]:
    """Rows of cases, the last of them the finest: how far the others are from it, in per cent at most."""
    rows = [alone(case) for case in cases]
    last = rows[-1]["of"]
    for row in rows[:-1]:
        for name, values in row["of"].items():
            if values.shape == last[name].shape and np.all(last[name]):
                row[name] = 100.0 * float(np.abs(values / last[name] - 1.0).max())
    return rows


def growth(pairs: tuple[Case, ...] = PAIRS) -> list[dict[str, Any]]:
    """All rows of the table."""
    found = []
    for pair in pairs:
        found += finer([replace(pair, cells=each) for each in GRIDS])
        found += finer([replace(pair, elements=each) for each in FINER])
        found += finer([replace(pair, positions=each) for each in POSITIONS])
        for shares in TORQUES[1:]:
            found.append(alone(replace(pair, torque=tuple(share * pair.torque[0] for share in shares))))
    return found


def under_torque() -> list[dict[str, Any]]:
    """Return the rows that the sample measures."""
    sample = runpy.run_path(str(SAMPLES / "te_under_torque.py"))
    return [row for pair in sample["PAIRS"] for row in sample["under_torque"](pair)[0]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="keep both tables in scripts/measured")
    parser.add_argument("--pair", choices=[pair.sample for pair in PAIRS], help="one of the pairs only")
    options = parser.parse_args()
    if options.write and options.pair:
        parser.error("--write: not with --pair, which leaves rows out")
    started = time.perf_counter()
    found = growth(tuple(p for p in PAIRS if options.pair in (None, p.sample)))
    print(tables.table(found, COLUMNS))
    if options.write:
        tables.keep("loads", found, COLUMNS)
        tables.keep("design_torque", under_torque(), UNDER_TORQUE)
    print(f"{time.perf_counter() - started:.0f} s")


if __name__ == "__main__":
    main()
