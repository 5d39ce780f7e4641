"""Bevel pairs from basic data alone: does the program make good pairs of them, on both sides?

python scripts/bevel_sweep.py [--count 200] [--hypoids 50] [--hobbed 50]
    [--hobbed-hypoids 25] [--formates 25] [--hypoid-formates 25] [--all-hobbed 0] [--seed 0] [--jobs 2] [--no-solids]
    [--results FILE] [--write]

Seeded pairs:
- bevel: 8 to 60 teeth, ratio 1 to 6, spiral angle 0 to 45 deg, pressure angle 16 to 25 deg, shaft angle 45 to 135 deg, face width
  0.2 to 0.35 outer cone distances, module 0.8 to 12, both hands
- hypoid: 8 to 16 teeth, ratio 2.5 to 5.5, offset 0.05 to 0.25 of the gear's mean diameter, spiral angle 35 to 50 deg
- face-hobbed: 6 to 40 teeth, ratio 1 to 6, spiral angle 20 to 42 deg, heads of 5 to 17 blade groups
- face-hobbed hypoid pairs, and face-hobbed pairs of both kinds with gears that are not generated
- with --all-hobbed: face-hobbed pairs of both kinds and processes, 6 to 40 teeth, ratio 1 to 6, offset up to 0.3 of the gear's
  pitch radius, heads of 5 to 17 blade groups

Checks of each side: surface contact lasts longer than a pitch and passes from pair to pair without a break; the transmission error
is within 15 % of the requested lag; the path is in the middle of the flank; roots and tips are clear; nothing is undercut. Both
solids at 20 um are proved.

Prints a line for each failure, and a table; --write keeps the table in scripts/measured. --results keeps each pair in a file of
JSON lines, from which a stopped sweep continues. Exit 1 if a solid is no solid.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tables

import gearmesh as gm
from gearmesh.mesh.solid import prove

#: tolerance of the solids, mm
TOLERANCE = 0.02
#: largest error of the lag, as a share of the requested lag; largest distance of the path from mid-face, in half face widths
MISSED, OFF_MIDDLE = 0.15, 0.3
#: teeth of the pinion from which on nearly all pairs should be good
FEW = 12
#: the same of face-hobbed pairs of all kinds
FEW_HOBBED = 10
SIDES = ("concave", "convex")
FAULTS = ("contact ratio", "transmission error", "break", "off the middle", "interference", "undercut", "bad solids")
COLUMNS = {name: name for name in ("pinion teeth", "pairs", "refused", "good", *FAULTS, "median, CPU s", "95 %, CPU s")}


def random_pair(seed: int) -> dict[str, Any]:
    """Basic data of a pair as a design file holds them; of pairs whose gear would be a crown gear or more another is drawn."""
    rng = np.random.default_rng([14, seed])
    while True:
        pinion = int(rng.integers(8, 31))
        gear = int(np.clip(round(pinion * rng.uniform(1.0, 6.0)), pinion, 180))
        shaft = np.radians(90.0 if rng.random() < 0.5 else rng.uniform(45.0, 135.0))
        pitch_angle = np.arctan2(np.sin(shaft), pinion / gear + np.cos(shaft))
        if 0.0 < pitch_angle < np.radians(87.0):
            break
    module = float(np.exp(rng.uniform(np.log(0.8), np.log(12.0))))
    outer = 0.5 * module * gear / np.sin(pitch_angle)
    return {
        "kind": "spiral_bevel",
        "module": round(module, 3),
        "spiral_angle": round(float(rng.uniform(0.0, 45.0)) if rng.random() < 0.75 else 0.0, 2),
        "pressure_angle": round(float(rng.uniform(16.0, 25.0)), 2),
        "shaft_angle": round(float(np.degrees(shaft)), 3),
        "face_width": round(float(rng.uniform(0.2, 0.35) * outer), 3),
        "hand": str(rng.choice(["left", "right"])),
        "pinion": {"teeth": pinion},
        "gear": {"teeth": gear},
    }


def random_hypoid(seed: int) -> dict[str, Any]:
    """Basic data of a hypoid pair as a design file holds them."""
    rng = np.random.default_rng([15, seed])
    pinion = int(rng.integers(8, 17))
    gear = round(pinion * rng.uniform(2.5, 5.5))
    module = float(np.exp(rng.uniform(np.log(1.5), np.log(10.0))))
    # the mean diameter is about this part of the outer one, by which the module counts
    mean = 0.86 * module * gear
    return {
        "kind": "hypoid",
        "module": round(module, 3),
        "offset": round(float(rng.uniform(0.05, 0.25) * mean), 3),
        "spiral_angle": round(float(rng.uniform(35.0, 50.0)), 2),
        "pressure_angle": round(float(rng.uniform(18.0, 23.0)), 2),
        "hand": str(rng.choice(["left", "right"])),
        "pinion": {"teeth": pinion},
        "gear": {"teeth": gear},
    }


def random_hobbed(seed: int) -> dict[str, Any]:
    """Basic data of a face-hobbed pair as a design file holds them."""
    rng = np.random.default_rng([60, seed])
    while True:
        pinion = int(rng.integers(6, 41))
        gear = int(np.clip(round(pinion * rng.uniform(1.0, 6.0)), pinion, 180))
        shaft = np.radians(90.0 if rng.random() < 0.6 else rng.uniform(45.0, 120.0))
        if 0.0 < np.arctan2(np.sin(shaft), pinion / gear + np.cos(shaft)) < np.radians(87.0):
            break
    return {
        "kind": "spiral_bevel",
        "process": "face_hobbed",
        "module": round(float(np.exp(rng.uniform(np.log(1.5), np.log(12.0)))), 3),
        "spiral_angle": round(float(rng.uniform(20.0, 42.0)), 2),
        "pressure_angle": round(float(rng.uniform(18.0, 23.0)), 2),
        "shaft_angle": round(float(np.degrees(shaft)), 3),
        "hand": str(rng.choice(["left", "right"])),
        "head": {"blade_groups": int(rng.integers(5, 18))},
        "pinion": {"teeth": pinion},
        "gear": {"teeth": gear},
    }


def random_hobbed_hypoid(seed: int) -> dict[str, Any]:
    """Basic data of a face-hobbed hypoid pair as a design file holds them."""
    groups = int(np.random.default_rng([61, seed]).integers(5, 18))
    return {**random_hypoid(seed), "process": "face_hobbed", "head": {"blade_groups": groups}}


def random_formate(seed: int) -> dict[str, Any]:
    """Basic data of a face-hobbed pair whose gear is not generated."""
    return {**random_hobbed(seed), "process": "face_hobbed_formate"}


def random_hypoid_formate(seed: int) -> dict[str, Any]:
    """Basic data of a face-hobbed hypoid pair whose gear is not generated."""
    return {**random_hobbed_hypoid(seed), "process": "face_hobbed_formate", "limit_share": 0.5}


def random_all_hobbed(seed: int) -> dict[str, Any]:
    """Basic data of a face-hobbed pair of one of both kinds and processes, as a design file holds them."""
    rng = np.random.default_rng([62, seed])
    pinion = int(rng.integers(6, 41))
    gear = int(np.clip(round(pinion * rng.uniform(1.0, 6.0)), pinion, 240))
    module = float(np.exp(rng.uniform(np.log(1.5), np.log(10.0))))
    formate, hypoid = (bool(value) for value in rng.random(2) < 0.5)
    share, spiral = rng.uniform(0.02, 0.3), float(rng.uniform(25.0, 38.0))
    data = {
        "kind": "hypoid" if hypoid else "spiral_bevel",
        "process": "face_hobbed_formate" if formate else "face_hobbed",
        "module": round(module, 3),
        "pressure_angle": round(float(rng.uniform(18.0, 23.0)), 2),
        "hand": str(rng.choice(["left", "right"])),
        "head": {"blade_groups": int(rng.integers(5, 18))},
        "pinion": {"teeth": pinion},
        "gear": {"teeth": gear},
        "spiral_angle": round(spiral, 2),
    }
    if hypoid:
        # the offset makes the pinion's spiral angle about this much larger
        turned = np.degrees(np.arcsin(share / (1.0 + pinion / gear)))
        data |= {
            "offset": round(float(share * 0.5 * module * gear), 3),
            "spiral_angle": round(spiral + float(turned), 2),
        }
    return data


#: basic data of seeded pairs by what they are
RANDOM_PAIRS = {
    "spiral_bevel": random_pair,
    "hypoid": random_hypoid,
    "face_hobbed": random_hobbed,
    "hobbed_hypoid": random_hobbed_hypoid,
    "hobbed_formate": random_formate,
    "hobbed_hypoid_formate": random_hypoid_formate,
    "all_hobbed": random_all_hobbed,
}


@dataclass
class Found:
    """Result for a pair: `faults` by their names, with a figure; CPU `seconds` for both solids and both contacts."""

    kind: str
    seed: int
    pinion: int
    refused: str = ""
    faults: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0
    #: design class of pairs of several kinds: kind and process
    design_class: str = ""


def tried(task: tuple[str, int, bool]) -> Found:
    """One pair of a kind by its seed, its solids too if asked for."""
    kind, seed, solids = task
    data = RANDOM_PAIRS[kind](seed)
    found = Found(kind, seed, data["pinion"]["teeth"])
    found.design_class = f"{data['kind']}, {data['process']}" if kind == "all_hobbed" else ""
    started = time.process_time()
    try:
        for side in SIDES:
            gears = gm.build(gm.parse({**data, "contact": {"side": f"pinion_{side}"}}))
            for fault, figure in faults_of(gears).items():
                found.faults[fault] = " ".join(filter(None, (found.faults.get(fault), f"{side} {figure}")))
        for name in gears.members if solids else ():
            mesh = gears.solid(name, TOLERANCE).mesh
            if not prove(mesh, 1).ok:
                found.faults["bad solids"] = name
    except gm.GearmeshError as error:
        found.refused = str(error)
    found.seconds = time.process_time() - started
    return found


def faults_of(gears: gm.Gears) -> dict[str, str]:
    """Return the faults on the driving side of the pinion, each with its figure."""
    answer = gears.contact()
    summary, faults = answer.summary, {}
    ratio, te = summary.get("contact_ratio"), summary.get("mesh_te_peak_to_peak_arcsec")
    design = gears.design
    wanted = design.pinion.side(design.contact.pinion_side).te_at_change
    if not (ratio is not None and ratio > 1.0):
        faults["contact ratio"] = f"{ratio}"
    if not (te is not None and abs(te / wanted - 1.0) < MISSED):
        faults["transmission error"] = f"{te} arcsec"
    if summary.get("te_breaks_phi1_deg"):
        faults["break"] = f"at {summary['te_breaks_phi1_deg'][0]:.4g} deg"
    if off := off_the_middle(gears, answer):
        faults["off the middle"] = off
    clearances = [summary.get(f"tip_clearance_{name}_mm") for name in gears.members]
    if summary.get("interference_um") or any(each is not None and each <= 0.0 for each in clearances):
        faults["interference"] = f"{summary.get('interference_um')} um, tips {clearances}"
    lines = [line for line in gears.warnings if "is undercut" in line]
    if lines:
        faults["undercut"] = lines[0].split(" mm ")[0].split()[-1] + " mm"
    return faults


def off_the_middle(gears: gm.Gears, answer: Any) -> str:
    """Return the distance of the path from the middle of the face, in half face widths, while its pair carries; "" if small."""
    path, tooth = answer.path, gears.members["pinion"].tooth
    points = (path.kind == "point") & (np.abs(path.phi1) <= 0.5 * gears.pairs[0].pitch)
    if not points.any():
        return "no path"
    flank = tooth.side(gears.pairs[0].flanks[0]).flank
    station = tooth.blank.axial.value(flank.jet(path.params1[points, 0], path.params1[points, 1]).r)
    toe, heel = tooth.blank.extent
    off = (station.mean() - 0.5 * (toe + heel)) / (0.5 * (heel - toe))
    return f"{off:.2f}" if abs(off) > OFF_MIDDLE else ""


def summary(found: list[Found]) -> list[tables.Row]:
    """A row for pinions of many and of few teeth, of either kind."""
    rows: list[tables.Row] = []
    for words, kind, many in (
        (f"{FEW} and more", "spiral_bevel", True),
        ("fewer", "spiral_bevel", False),
        (f"hypoid, {FEW} and more", "hypoid", True),
        ("hypoid, fewer", "hypoid", False),
        (f"face-hobbed, {FEW} and more", "face_hobbed", True),
        ("face-hobbed, fewer", "face_hobbed", False),
        (f"face-hobbed hypoid, {FEW} and more", "hobbed_hypoid", True),
        ("face-hobbed hypoid, fewer", "hobbed_hypoid", False),
        (f"face-hobbed Formate, {FEW} and more", "hobbed_formate", True),
        ("face-hobbed Formate, fewer", "hobbed_formate", False),
        (f"face-hobbed hypoid Formate, {FEW} and more", "hobbed_hypoid_formate", True),
        ("face-hobbed hypoid Formate, fewer", "hobbed_hypoid_formate", False),
    ):
        some = [each for each in found if each.kind == kind and (each.pinion >= FEW) == many]
        if some:
            rows.append(summary_row(words, some))
    classes = sorted({each.design_class for each in found if each.design_class})
    for words, most in ((f"{FEW_HOBBED} and more", True), ("fewer", False)):
        for name in classes:
            some = [each for each in found if each.design_class == name and (each.pinion >= FEW_HOBBED) == most]
            if some:
                rows.append(summary_row(f"{name}, {words}", some))
    return rows


def summary_row(words: str, some: list[Found]) -> tables.Row:
    """The row of some pairs."""
    made = [each for each in some if not each.refused]
    median, most = np.percentile([each.seconds for each in some], (50, 95)).tolist()
    return {
        "pinion teeth": words,
        "pairs": len(some),
        "refused": len(some) - len(made),
        "good": sum(not each.faults for each in made),
        **{fault: sum(fault in each.faults for each in made) for fault in FAULTS},
        "median, CPU s": median,
        "95 %, CPU s": most,
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="pairs")
    parser.add_argument("--hypoids", type=int, default=50, help="hypoid pairs")
    parser.add_argument("--hobbed", type=int, default=50, help="face-hobbed pairs")
    parser.add_argument("--hobbed-hypoids", type=int, default=25, help="face-hobbed hypoid pairs")
    parser.add_argument("--formates", type=int, default=25, help="face-hobbed pairs whose gear is not generated")
    parser.add_argument("--hypoid-formates", type=int, default=25, help="face-hobbed hypoid pairs of such gears")
    parser.add_argument("--all-hobbed", type=int, default=0, help="face-hobbed pairs of both kinds and processes")
    parser.add_argument("--seed", type=int, default=0, help="of the first")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--no-solids", dest="solids", action="store_false", help="contact only")
    parser.add_argument("--results", type=Path, help="file of JSON lines that keeps each pair: goes on where it ends")
    parser.add_argument("--write", action="store_true", help="keep the table in scripts/measured")
    asked = parser.parse_args()
    found: list[Found] = []
    tasks = [("spiral_bevel", asked.seed + k, asked.solids) for k in range(asked.count)]
    tasks += [("hypoid", asked.seed + k, asked.solids) for k in range(asked.hypoids)]
    tasks += [("face_hobbed", asked.seed + k, asked.solids) for k in range(asked.hobbed)]
    tasks += [("hobbed_hypoid", asked.seed + k, asked.solids) for k in range(asked.hobbed_hypoids)]
    tasks += [("hobbed_formate", asked.seed + k, asked.solids) for k in range(asked.formates)]
    tasks += [("hobbed_hypoid_formate", asked.seed + k, asked.solids) for k in range(asked.hypoid_formates)]
    tasks += [("all_hobbed", asked.seed + k, asked.solids) for k in range(asked.all_hobbed)]
    kept = asked.results
    if kept and kept.exists():
        found = [Found(**json.loads(line)) for line in kept.read_text().splitlines()]
    done = {(each.kind, each.seed) for each in found}
    tasks = [task for task in tasks if task[:2] not in done]
    with ProcessPoolExecutor(asked.jobs) as pool:
        for each in pool.map(tried, tasks):
            found.append(each)
            if kept:
                with kept.open("a") as file:
                    file.write(json.dumps(asdict(each)) + "\n")
            if each.refused or each.faults:
                lines = (
                    [each.refused] if each.refused else [f"{fault}: {figure}" for fault, figure in each.faults.items()]
                )
                print(f"{each.kind} {each.seed}: {each.pinion} teeth; {'; '.join(lines)}", flush=True)
    rows = summary(found)
    print(tables.table(rows, COLUMNS))
    if asked.write:
        tables.keep("bevel", rows, COLUMNS)
    return 1 if any("bad solids" in each.faults for each in found) else 0


if __name__ == "__main__":
    sys.exit(main())
