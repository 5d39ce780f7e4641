"""Random worm drives: are their solids sound, is interference reported, do refusals name a key that is set?

python scripts/worm_sweep.py [--count 200] [--seed 0] [--jobs 2] [--no-solids] [--no-roll] [--write]

Seeded drives of all five flank forms in turn: 1 to 6 threads, wheels of 20 to 80 teeth, diameter quotient 6 to 20, module 1 to 10,
pressure angle 15 to 25 deg, both hands, shaft angle 90 deg or (a quarter of them) 75 to 105, profile shift -0.5 to 0.75, hobs of
the worm's size or 2 to 20 % larger. Of each drive: both flanks in contact; where these touch, a transmission error below 1e-9 rad
of those that are uniform (hob of the worm's size, and any hob of a ZI worm); undercut and pointed teeth by `limits`; both solids at
20 um proved; and the flanks that the solids have rolled against each other at one position: where that is ahead of the solver,
teeth go through each other that the solver does not know of. A refusal must name a key that the design sets. Prints a line for
what fails and a table; with --write that of scripts/README.md becomes it. Exit 1 if a solid is no solid, a refusal names no key
that is set, or interference is not reported.
"""

from __future__ import annotations

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tables

import gearmesh as gm
from gearmesh.mesh.solid import prove

#: tolerance of the solids, mm
TOLERANCE = 0.02
#: transmission error (rad) of drives that are exactly uniform
UNIFORM = 1e-9
#: what roll test and solver may differ by, mm at the wheel's reference circle
ROLLED = 1e-3
FORMS = ("ZA", "ZN", "ZI", "ZK", "ZC")
#: faults that the program does not report, and what it does report
FAULTS = ("wrong key", "no solid", "bad solids", "silent interference", "transmission error")
REPORTED = ("interference", "undercut", "pointed", "edge contact", "contact ratio below 1", "no contact")
COLUMNS = {
    name: name for name in ("form", "drives", "refused", *FAULTS, *REPORTED, "sound", "median, CPU s", "95 %, CPU s")
}


def random_drive(seed: int) -> dict[str, Any]:
    """A worm drive as a design file holds it."""
    rng = np.random.default_rng([16, seed])
    module = float(np.exp(rng.uniform(0.0, np.log(10.0))))
    quotient, form = float(rng.uniform(6.0, 20.0)), FORMS[seed % len(FORMS)]
    data: dict[str, Any] = {
        "kind": "worm_drive",
        "module": round(module, 3),
        "pressure_angle": round(float(rng.uniform(15.0, 25.0)), 2),
        "worm": {
            "threads": int(rng.integers(1, 7)),
            "form": form,
            "quotient": round(quotient, 3),
            "right_hand": bool(rng.random() < 0.5),
        },
        "wheel": {"teeth": int(rng.integers(20, 81))},
    }
    if rng.random() < 0.25:
        data["shaft_angle"] = round(float(rng.uniform(75.0, 105.0)), 2)
    if rng.random() < 0.5:
        data["wheel"]["profile_shift"] = round(float(rng.uniform(-0.5, 0.75)), 3)
    if rng.random() < 0.5:
        diameter = data["module"] * data["worm"]["quotient"]
        data["hob"] = {"reference_diameter": round(float(rng.uniform(1.02, 1.2)) * diameter, 3)}
    return data


@dataclass
class Tried:
    """What was seen of a drive: why it is `refused`, `faults` and what is `reported`, by what they are, with a figure; CPU
    `seconds` for both contacts and both solids, the roll test apart."""

    seed: int
    form: str
    refused: str = ""
    faults: dict[str, str] = field(default_factory=dict)
    reported: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0

    @property
    def told(self) -> str:
        """All of it in a line."""
        both = {**self.faults, **self.reported}
        return "; ".join(filter(None, [self.refused, *(f"{name}: {figure}" for name, figure in both.items())]))


def tried(task: tuple[int, bool, bool]) -> Tried:
    """One drive by its seed, its solids and the roll test too if asked for."""
    seed, solids, roll = task
    data = random_drive(seed)
    drive = Tried(seed, data["worm"]["form"])
    started = time.process_time()
    try:
        gears = {flank: gm.build(gm.parse({**data, "contact": {"flank": flank}})) for flank in ("right", "left")}
        for flank, own in gears.items():
            look_at(drive, own, flank)
        for name in gears["right"].members if solids else ():
            try:
                mesh = gears["right"].solid(name, TOLERANCE).mesh
            except gm.NoSolutionError as error:
                drive.faults["no solid"] = f"{name}, {error}"
                continue
            if not prove(mesh, 1).ok:
                drive.faults["bad solids"] = name
        drive.seconds = time.process_time() - started
        if roll:
            roll_one(drive, gears["right"])
    except gm.DesignError as error:
        drive.refused = str(error).splitlines()[0]
        if not (error.key and gm.parse(data).sets(error.key)):
            drive.faults["wrong key"] = str(error.key)
    drive.seconds = drive.seconds or time.process_time() - started
    return drive


def look_at(drive: Tried, gears: gm.Gears, flank: str) -> None:
    """Contact of one flank, and what is undercut or pointed."""
    try:
        answer = gears.contact()
    except gm.NoSolutionError as error:
        drive.reported["no contact"] = f"{flank}, {error}"
        return
    summary, path = answer.summary, answer.path
    ratio, te = summary.get("contact_ratio"), summary.get("mesh_te_peak_to_peak_arcsec")
    equal = "hob" not in gears.design.model_fields_set
    cut = [line for line in gears.limits().complaints if "undercut" in line or "pointed" in line]
    for line in cut:
        drive.reported["undercut" if "undercut" in line else "pointed"] = line
    if ratio is None or ratio < 1.0:
        drive.reported["contact ratio below 1"] = f"{flank} {ratio}"
    elif (equal or drive.form == "ZI") and not cut:
        flanks = np.isin(path.kind, ("point", "line"))
        if not (flanks.any() and np.ptp(path.te[flanks]) < UNIFORM):
            drive.faults["transmission error"] = f"{flank}, flanks in contact"
        elif not (te is not None and np.radians(te / 3600.0) < UNIFORM):
            drive.reported["edge contact"] = f"{flank} {te} arcsec"
    if depth := summary.get("interference_um"):
        drive.reported["interference"] = f"{flank} {depth:.3g} um"


def roll_one(drive: Tried, gears: gm.Gears) -> None:
    """The roll test at one position against the solver."""
    pair = gears.train.pairs[0]
    try:
        contact = gears.contact(phi1=[0.11 * np.degrees(pair.pitch)])
    except gm.NoSolutionError:
        return
    (difference,) = gears.roll(contact).to_dict()["te_difference_arcsec"]
    design = gears.design.in_mm()
    off = np.radians(difference / 3600.0) * 0.5 * design.module * design.wheel.teeth
    if not abs(off) < ROLLED:
        drive.faults["silent interference"] = f"roll test {difference:.4g} arcsec off, {1e3 * off:.3g} um"


def summary_of(drives: list[Tried]) -> list[tables.Row]:
    """A row a flank form."""
    rows: list[tables.Row] = []
    for form in FORMS:
        some = [drive for drive in drives if drive.form == form]
        if not some:
            continue
        median, most = np.percentile([drive.seconds for drive in some], (50, 95)).tolist()
        rows.append(
            {
                "form": form,
                "drives": len(some),
                "refused": sum(bool(drive.refused) for drive in some),
                **{fault: sum(fault in drive.faults for drive in some) for fault in FAULTS},
                **{name: sum(name in drive.reported for drive in some) for name in REPORTED},
                "sound": sum(not drive.told for drive in some),
                "median, CPU s": median,
                "95 %, CPU s": most,
            }
        )
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="drives")
    parser.add_argument("--seed", type=int, default=0, help="of the first")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--no-solids", dest="solids", action="store_false", help="contact only")
    parser.add_argument("--no-roll", dest="roll", action="store_false", help="without the roll test")
    parser.add_argument("--write", action="store_true", help="put the table into scripts/README.md")
    asked = parser.parse_args()
    drives = []
    tasks = [(asked.seed + k, asked.solids, asked.roll) for k in range(asked.count)]
    with ProcessPoolExecutor(asked.jobs) as pool:
        for drive in pool.map(tried, tasks):
            drives.append(drive)
            if drive.told:
                print(f"{drive.seed}: {drive.form}; {drive.told}", flush=True)
    shown = tables.table(summary_of(drives), COLUMNS)
    print(shown)
    if asked.write:
        tables.rewrite(Path(__file__).with_name("README.md"), {"worm": shown})
    return 1 if any({"bad solids", "wrong key", "silent interference"} & drive.faults.keys() for drive in drives) else 0


if __name__ == "__main__":
    sys.exit(main())
