"""Random worm drives: are their solids sound, is interference reported, do refusals name a key that is set?

python scripts/worm_sweep.py [--count 200] [--seed 0] [--jobs 2] [--no-solids] [--no-contact]
                             [--keep FILE] [--write]

Seeded drives of all five flank forms in turn: 1 to 6 threads, wheels of 20 to 80 teeth, diameter quotient 6 to 20, module 1 to 10,
pressure angle 15 to 25 deg, both hands, shaft angle 90 deg or (a quarter of them) 75 to 105, profile shift -0.5 to 0.75, hobs of
the worm's size or 2 to 20 % larger.

Checks of each drive:
- undercut, by `limits`
- both solids at 20 um are proved
- contact of one flank (the right one for even seeds), with all interference, also of the other flank
- transmission error below 1e-9 rad if the drive is exactly uniform: the hob has the worm's size, or the worm is ZI. Flanks that
  cross must be reported.
- meshes of the flanks, rolled against each other at one position. If they touch earlier than the solver says, teeth pass
  through each other without a report.
- a refusal names a key that the design sets

Prints a line for every drive with a finding, and two tables; --write keeps both in scripts/measured. --keep keeps each drive in a
file when it was tried, and does not try the drives of this file again. Exit 1 if a solid is no solid, a refusal names no key that
is set, or interference is not reported.

The public answers would take four times as long: they make solids of their own for the roll test, and search how to free a pair
that jams.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tables

import gearmesh as gm
from gearmesh.answers.check import RollRow, roll_test
from gearmesh.answers.contact.fit import fitted_cycle
from gearmesh.contact.engagement.cycle import engagement_range
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.first_touch.crossing import crossing_over_a_pitch
from gearmesh.contact.flanks import solver_pair
from gearmesh.mesh.solid import prove

#: tolerance of the solids, and of the flanks that are rolled against each other, mm
TOLERANCE, ROLLED = 0.02, 1e-3
#: compared figures of the roll test: rotations alone, because facets of 1 um change a mark of 6.35 um by more than is allowed
ROTATIONS = tuple(f"roll: {RollRow.key_of(name)}" for name in ("te_difference", "along"))
#: transmission error (rad) of drives that are exactly uniform
UNIFORM = 1e-9
#: positions of a path, over the engagement
POSITIONS = 15
FORMS = ("ZA", "ZN", "ZI", "ZK", "ZC")
#: faults that the program does not report, and findings that it reports
FAULTS = ("wrong key", "no solid", "bad solids", "no answer", "silent interference", "transmission error")
REPORTED = ("undercut", "interference", "crossing flanks", "contact ratio below 1", "no contact")
COLUMNS = {name: name for name in ("form", "drives", "refused", "in contact", *REPORTED, "plain", *FAULTS)}
REFUSED = {name: name for name in ("refused for", "drives", "keys that are named", "an example")}


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
    """Result for a drive: the refused key `refused`, the cause `about` of the refusal and its full `line`; `faults` and
    `reported` findings with a figure each, by name; CPU `seconds`; `contact`: True if contact was tried."""

    seed: int
    form: str
    refused: str = ""
    about: str = ""
    line: str = ""
    faults: dict[str, str] = field(default_factory=dict)
    reported: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0
    contact: bool = True

    @property
    def told(self) -> str:
        """All of it in a line."""
        both = {**self.faults, **self.reported}
        return "; ".join(filter(None, [self.line, *(f"{name}: {figure}" for name, figure in both.items())]))


def tried(task: tuple[int, bool, bool]) -> Tried:
    """One drive by its seed, its solids and its contact if asked for."""
    seed, solids, contact = task
    data = random_drive(seed)
    drive = Tried(seed, data["worm"]["form"], contact=contact)
    started = time.process_time()
    try:
        gears = gm.build(gm.parse(data))
        look_at_members(drive, gears, solids=solids)
        flank = ("right", "left")[seed % 2]
        try:
            if contact:
                look_at_flank(drive, gm.build(gm.parse({**data, "contact": {"flank": flank}})), flank)
        except gm.NoSolutionError as error:
            drive.faults["no answer"] = f"{flank}, {error}"
    except gm.DesignError as error:
        drive.refused, drive.about, drive.line = (
            str(error.key),
            error.topic or str(error.key),
            str(error).splitlines()[0],
        )
        if not (error.key and gm.parse(data).sets(error.key)):
            drive.faults["wrong key"] = str(error.key)
    drive.seconds = time.process_time() - started
    return drive


def look_at_members(drive: Tried, gears: gm.Gears, *, solids: bool) -> None:
    """Note undercut and the faults of the solids in the result of a drive."""
    for line in gears.limits().warnings:
        if "undercut" in line:
            drive.reported["undercut"] = line
    for name in gears.members if solids else ():
        try:
            mesh = gears.solid(name, TOLERANCE).mesh
        except gm.NoSolutionError as error:
            drive.faults["no solid"] = f"{name}, {error}"
            continue
        if not prove(mesh, 1).ok:
            drive.faults["bad solids"] = name


def look_at_flank(drive: Tried, gears: gm.Gears, flank: str) -> None:
    """Contact of one flank, what interferes, and the flanks' meshes rolled against each other."""
    pair = gears.train.pairs[0]
    followed = whole_engagement(solver_pair(pair), pair.pitch)
    fits, cycle = (None, None) if followed is None else fitted_cycle(pair, followed)
    if followed is None or fits is None or cycle is None:
        drive.reported["no contact"] = flank
        return
    if fits.fits is False:
        drive.reported["interference"] = f"{flank} {-1e3 * fits.slack:.3g} um"
    if not fits.jammed and not cycle.contact_ratio >= 1.0:
        drive.reported["contact ratio below 1"] = f"{flank} {cycle.contact_ratio:.3g}"
    ends = engagement_range(followed, pair.pitch)
    path = gears.contact(np.degrees(np.linspace(*ends, POSITIONS)), cycle=False).path
    uniform = "hob" not in gears.design.model_fields_set or drive.form == "ZI"
    flanks = np.isin(path.kind, ("point", "line"))
    if not flanks.any() and crossing_over_a_pitch(followed.pair.parts[0], followed.phi1, pair.pitch):
        drive.reported["crossing flanks"] = flank
        uniform = False
    if uniform and "undercut" not in drive.reported and not (flanks.any() and np.ptp(path.te[flanks]) < UNIFORM):
        drive.faults["transmission error"] = f"{flank}, flanks in contact"
    for verdict in roll_test(pair, path, 1, ROLLED).verdicts:
        if not verdict.ok and verdict.what in ROTATIONS:
            drive.faults["silent interference"] = (
                f"{flank}, {verdict.what} {verdict.value:.3g}, at most {verdict.limit:.3g}"
            )


def summary_of(drives: list[Tried]) -> list[tables.Row]:
    """A row a flank form."""
    rows: list[tables.Row] = []
    for form in FORMS:
        some = [drive for drive in drives if drive.form == form]
        if not some:
            continue
        rows.append(
            {
                "form": form,
                "drives": len(some),
                "refused": sum(bool(drive.refused) for drive in some),
                "in contact": sum(drive.contact and not drive.refused for drive in some),
                **{name: sum(name in drive.reported for drive in some) for name in REPORTED},
                "plain": sum(not drive.told for drive in some),
                **{fault: sum(fault in drive.faults for drive in some) for fault in FAULTS},
            }
        )
    return rows


def refusals_of(drives: list[Tried]) -> list[tables.Row]:
    """Return a row for each cause of refusals."""
    rows: list[tables.Row] = []
    for about in sorted({drive.about for drive in drives if drive.refused}):
        some = [drive for drive in drives if drive.about == about]
        keys = Counter(drive.refused for drive in some)
        rows.append(
            {
                "refused for": about,
                "drives": len(some),
                "keys that are named": ", ".join(f"`{key}` {count}" for key, count in keys.most_common()),
                "an example": f"seed {some[0].seed}: {some[0].line}",
            }
        )
    return rows


def kept(file: Path | None) -> dict[int, Tried]:
    """Return the drives of a file of JSON lines, by seed; none if the file does not exist."""
    if file is None or not file.exists():
        return {}
    drives = (Tried(**json.loads(line)) for line in file.read_text(encoding="utf-8").splitlines())
    return {drive.seed: drive for drive in drives}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="drives")
    parser.add_argument("--seed", type=int, default=0, help="of the first")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--no-solids", dest="solids", action="store_false", help="without solids")
    parser.add_argument("--no-contact", dest="contact", action="store_false", help="members alone")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="JSON lines of the drives that have been tried")
    parser.add_argument("--write", action="store_true", help="keep the tables in scripts/measured")
    asked = parser.parse_args()
    drives = kept(asked.keep)
    missing = sorted(set(range(asked.seed, asked.seed + asked.count)) - drives.keys())
    with ProcessPoolExecutor(asked.jobs) as pool:
        for drive in pool.map(tried, [(seed, asked.solids, asked.contact) for seed in missing]):
            drives[drive.seed] = drive
            if drive.told:
                print(f"{drive.seed}: {drive.form}; {drive.told}", flush=True)
            if asked.keep:
                with asked.keep.open("a", encoding="utf-8") as file:
                    print(json.dumps(asdict(drive)), file=file)
    every = [drives[seed] for seed in sorted(drives)]
    found = {"worms": summary_of(every), "worms_refused": refusals_of(every)}
    for name, columns in (("worms", COLUMNS), ("worms_refused", REFUSED)):
        if rows := found[name]:
            print(tables.table(rows, columns), end="\n\n")
            if asked.write:
                tables.keep(name, rows, columns)
    return 1 if any({"bad solids", "wrong key", "silent interference"} & drive.faults.keys() for drive in every) else 0


if __name__ == "__main__":
    sys.exit(main())
