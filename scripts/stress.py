"""Random designs of every kind: each answers every question, and each answer is checked by an independent route.

python scripts/stress.py [--count 300] [--seed 0] [--kind KIND] [--range sensible|edge|both] [--jobs 2] [--timeout 180]
                         [--results out/stress.jsonl] [--failures out/stress] [--resume] [--write]

Checks of every design:
- It is built, or refused over a key that it sets.
- Its solids are closed and within their tolerance.
- The contact of one tooth pair agrees with the roll of exact flanks.
- The contact of the gears agrees with the roll of whole members.
- Solids that overlap come with a warning.

Prints a table by kind, and writes every failure as a design that loads again. --write keeps the table in scripts/measured.
Exit 1 if anything failed.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import re
import resource
import sys
import time
import traceback
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

import numpy as np
import tables
from stress_designs import KINDS, RANGES, random_design

import gearmesh as gm
from gearmesh.check.members import FLANK_CELLS, HALF_CELLS, MemberRoll, ToothTouch, roll_flanks, roll_members
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.region import Region

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "tests"))
from oracles.overlap import overlap  # noqa: E402

ARCSEC = math.pi / 648000.0
#: largest difference of contact and roll of one pair's flanks, arcsec; largest change of the roll with finer grids, arcsec
SAME, SURE = 0.05, 0.02
#: largest difference of the gears' first touch and the roll of whole members, arcsec
SAME_GEARS = 0.5
#: number of positions of one pair, and their range in pitches from phi1 = 0; then the position of the whole gears, as a share of
#: the mesh cycle
POSITIONS, REACH = 3, 0.9
CYCLE_SHARE = 0.3
#: tolerance of the solids in modules, and mm at least
SOLID_TOLERANCE, FINEST = 1e-3, 1e-3
#: words of the warnings about solids that overlap
TELLING = re.compile("overlap|interfer|backlash|jam|penetrat|inside", re.IGNORECASE)
#: what refused designs begin with: a dotted key, and what follows it
LEADING_KEY = re.compile(r"^([a-z]\w*(?:\.\w+)*)(?= =|:)", re.IGNORECASE)


@dataclass(frozen=True)
class Task:
    kind: str
    seed: int
    range: str

    @property
    def name(self) -> str:
        return f"{self.kind}_{self.range}_{self.seed}"


@dataclass
class Outcome:
    """Outcome of a design: `state` built, refused, unset, traceback, timeout; `failures` reason -> what was found."""

    kind: str
    seed: int
    range: str
    state: str = "built"
    message: str = ""
    failures: dict[str, str] = field(default_factory=dict)
    notes: dict[str, Any] = field(default_factory=dict)
    seconds: float = 0.0
    peak_mb: float = 0.0


# --- one design -------------------------------------------------------------------------------------------------------


def tried(task: Task) -> Outcome:
    """Put one design to all questions."""
    outcome = Outcome(task.kind, task.seed, task.range)
    started = time.perf_counter()
    keys = random_design(task.kind, task.seed, task.range)
    try:
        gears = gm.build(gm.parse(keys))
    except gm.GearmeshError as error:
        outcome.message = str(error)
        outcome.state = "refused" if names_a_set_key(str(error), keys) else "unset"
        if outcome.state == "unset":
            outcome.failures["unset"] = str(error)
    except Exception:
        outcome.state, outcome.failures["traceback"] = "traceback", traceback.format_exc(limit=-4)
    else:
        for question in (solids, contact, whole):
            before = time.perf_counter()
            try:
                question(gears, outcome)
            except gm.GearmeshError as error:
                outcome.failures[f"{question.__name__}_refused"] = f"{type(error).__name__}: {error}"
            except Exception:
                outcome.failures["traceback"] = traceback.format_exc(limit=-4)
            outcome.notes[f"{question.__name__}_seconds"] = round(time.perf_counter() - before, 2)
    outcome.seconds = time.perf_counter() - started
    outcome.peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    return outcome


def names_a_set_key(message: str, keys: Mapping[str, Any]) -> bool:
    """True for a refusal that begins with a key that the design sets, or with a table of it."""
    found = LEADING_KEY.match(message)
    if found is None:
        return False
    value: Any = keys
    for part in found[1].split("."):
        if not isinstance(value, Mapping) or part not in value:
            return False
        value = value[part]
    return True


def tolerance_of(gears: gm.Gears) -> float:
    module = gears.design.in_mm().given_module
    return max(FINEST, SOLID_TOLERANCE * module)


def solids(gears: gm.Gears, outcome: Outcome) -> None:
    """Check that solids are closed as an STL file holds them, are proved, and are within their tolerance of the exact surfaces."""
    wrong = []
    for name in gears.members:
        found = gears.solid(name, tolerance_of(gears), file="x.stl")
        wrong += found.complaints
    if wrong:
        outcome.failures["solid"] = "; ".join(wrong)


def contact(gears: gm.Gears, outcome: Outcome) -> None:
    """The path of one tooth pair against the roll of its flanks on exact grids."""
    pair = gears.pairs[0]
    # of the flanks alone, as they are rolled; tips on fillets are for whole members
    phi1 = np.random.default_rng(outcome.seed).uniform(-REACH, REACH, POSITIONS) * pair.pitch
    path = contact_path(solver_pair(pair).parts[0], phi1)
    guess = np.where(path.touching, path.phi2, pair.ratio * path.rotation)
    for k, (rotation, near) in enumerate(zip(path.rotation.tolist(), guess.tolist(), strict=True)):
        (found,) = roll_flanks(pair, rotation, FLANK_CELLS, near)
        line = compared(path.phi2[k] if path.touching[k] else None, found, pair)
        if line is None:
            continue
        (finer,) = roll_flanks(pair, rotation, 2 * FLANK_CELLS, near)
        if found is not None and finer is not None and abs(finer.phi2 - found.phi2) > SURE * ARCSEC:
            outcome.notes["unsure"] = f"roll moves by {(finer.phi2 - found.phi2) / ARCSEC:.3g} arcsec on finer grids"
            if compared(path.phi2[k] if path.touching[k] else None, finer, pair) is None:
                continue
        reason = "contact" if found is not None and path.touching[k] else "none"
        place = f"phi1 {np.degrees(path.phi1[k]):.5g} deg: {' '.join((str(path.kind[k]), str(path.edge[k]))).strip()}, {line}"
        if found is not None and path.touching.any():
            j = int(np.argmax(path.touching))
            te = found.phi2 - path.phi2[j] - pair.ratio * (rotation - path.rotation[j])
            te = pair.drive * ((te + math.pi) % (2.0 * math.pi) - math.pi) / ARCSEC
            place += f", {te:.5g} arcsec ahead of the contact at phi1 {np.degrees(path.phi1[j]):.4g}"
        outcome.failures[reason] = "; ".join(filter(None, (outcome.failures.get(reason), place)))


def compared(phi2: float | None, found: ToothTouch | None, pair: GearPair) -> str | None:
    """Return the disagreement of solver and roll; None if they agree."""
    if found is None:
        return None if phi2 is None else "the roll finds no touch"
    where = f"{found.regions[0]} on {found.regions[1]}, rims {found.on_rims}"
    if phi2 is None:
        return f"the roll touches ({where})"
    ahead = pair.drive * (found.phi2 - phi2) / ARCSEC
    return None if abs(ahead) <= SAME else f"the roll touches {ahead:.4g} arcsec before it ({where})"


def whole(gears: gm.Gears, outcome: Outcome) -> None:
    """The gears' first touch in the mesh cycle against the roll of whole members, and the overlap of their solids."""
    pair = gears.pairs[0]
    answer = gears.contact(0.0)
    told = [line for line in (*gears.warnings, *answer.warnings) if TELLING.search(line)]
    stated = stated_touch(pair, answer)
    phi1 = 0.0 if stated is None else stated[0]
    guess = None if stated is None else stated[1]
    rolled = roll_members(pair, phi1, guess_phi2=guess)[0]
    if doubtful(pair, rolled, stated, answer.summary):
        finer = roll_members(pair, phi1, 2 * HALF_CELLS, guess)[0]
        moved = (finer.backlash - rolled.backlash) / ARCSEC
        if abs(moved) > SURE:
            outcome.notes["unsure_gears"] = f"backlash by the roll moves by {moved:.3g} arcsec on finer grids"
        rolled = finer
    first = rolled.drive
    if first is None:
        if stated is not None:
            outcome.failures["gears"] = "the roll of the members finds nothing in reach"
        return
    backlash = rolled.backlash / ARCSEC
    outcome.notes["backlash_arcsec"] = backlash
    where = f"phi1 {math.degrees(phi1):.5g} deg, pair {first.tooth}, {first.regions[0]} on {first.regions[1]}"
    if stated is not None and abs(ahead := pair.drive * (first.phi2 - stated[1]) / ARCSEC) > SAME_GEARS:
        flanks_only = all(region.is_flank for region in first.regions)
        if flanks_only or ahead < 0.0 or not told:
            reason = "gears" if flanks_only or ahead < 0.0 else "interference"
            outcome.failures[reason] = f"whole members touch {ahead:.4g} arcsec before the contact: {where}"
    if backlash < -SAME_GEARS and not told and rolled.coast is not None:
        coast = rolled.coast.regions
        outcome.failures["jam"] = f"backlash {backlash:.4g} arcsec: {where}; coast {coast[0]} on {coast[1]}"
    if not eccentric(pair):
        outcome.failures |= figures_against(answer.summary, rolled)
    tolerance = tolerance_of(gears)
    meshes = [gears.solid(name, tolerance).mesh for name in gears.members]
    place = first.phi2 if stated is None else stated[1]
    pieces = overlap(pair, (meshes[0], meshes[1]), phi1, place).beyond(tolerance, tolerance)
    if pieces and not told:
        box = np.round(pieces[0].box, 3).tolist()
        outcome.failures["overlap"] = (
            f"{sum(p.volume for p in pieces):.4g} mm3, {1e3 * pieces[0].thickness:.4g} um thick in {box}, phi1 "
            f"{math.degrees(phi1):.5g} deg, backlash by the roll {backlash:.4g} arcsec"
        )


def doubtful(
    pair: GearPair, rolled: MemberRoll, stated: tuple[float, float] | None, summary: Mapping[str, Any]
) -> bool:
    """True if the roll of members disagrees with the contact, so that finer grids have to decide."""
    if rolled.drive is None or stated is None:
        return False
    apart = abs(rolled.drive.phi2 - stated[1]) > SAME_GEARS * ARCSEC
    # a jam that is not stated
    least = summary.get("backlash_min_deg")
    apart |= rolled.backlash < -SAME_GEARS * ARCSEC and (least is None or math.radians(least) > 0.5 * rolled.backlash)
    return apart or (not eccentric(pair) and bool(figures_against(summary, rolled)))


def eccentric(pair: GearPair) -> bool:
    """True for eccentric members, whose tooth pairs differ: the figures of one pair say nothing about the next."""
    return any(mount.eccentricity != (0.0, 0.0) for mount in pair.mounts)


def stated_touch(pair: GearPair, answer: Any) -> tuple[float, float] | None:
    """Return rotations of pinion and gear (rad) at a position of the mesh cycle, from the contact analysis; None without a
    cycle.

    Eccentric members have another cycle for every pair.
    """
    cycle = answer.cycle
    if cycle is None or cycle.curve is None or eccentric(pair):
        return None
    q = int(CYCLE_SHARE * len(cycle.phi1))
    phi1 = cycle.phi1[q]
    phi2 = float(pair.ratio * phi1 + pair.drive * cycle.curve.advance(np.array([phi1]))[0])
    return (float(cycle.phi1[q]), phi2) if math.isfinite(phi2) else None


def figures_against(summary: Mapping[str, Any], rolled: MemberRoll) -> dict[str, str]:
    """Compare figures of the gears with the roll of whole members, if the contact analysis has them: fault by reason.

    `backlash_min_deg` is the least over the mesh cycle, so that no position may have less.
    """
    least = summary.get("backlash_min_deg")
    if least is None or math.isnan(rolled.backlash):
        return {}
    # teeth that stand in roots jam by a depth, which is no rotation
    if rolled.backlash < 0.0 and (least < 0.0 or stands_in_root(summary, rolled)):
        return {}
    short = math.radians(least) - rolled.backlash
    return (
        {} if short <= SAME_GEARS * ARCSEC else {"backlash": f"{short / ARCSEC:.4g} arcsec less than the least stated"}
    )


def stands_in_root(summary: Mapping[str, Any], rolled: MemberRoll) -> bool:
    """True if the roll stands on a root and the contact has a tip below a root."""
    clearances = (value for key, value in summary.items() if key.startswith("tip_clearance_") and value is not None)
    touches = (touch for touch in (rolled.drive, rolled.coast) if touch is not None)
    return min(clearances, default=0.0) < 0.0 and any(Region.ROOT in touch.regions for touch in touches)


# --- many designs -----------------------------------------------------------------------------------------------------


def many(tasks: list[Task], jobs: int, timeout: float) -> Iterator[Outcome]:
    """Outcomes in the order in which they come, each from a process of its own: what hangs or dies is a failure too."""
    context = multiprocessing.get_context("fork")
    waiting, running = tasks[::-1], dict[Connection, tuple[Task, BaseProcess, float]]()
    while waiting or running:
        while waiting and len(running) < jobs:
            task = waiting.pop()
            ours, theirs = context.Pipe(duplex=False)
            process = context.Process(target=_work, args=(task, theirs))
            process.start()
            theirs.close()
            running[ours] = (task, process, time.perf_counter())
        ready = wait(list(running), timeout=0.5)
        for pipe, (task, process, started) in list(running.items()):
            late = time.perf_counter() - started > timeout
            if pipe not in ready and not late:
                continue
            try:
                yield pipe.recv() if pipe in ready else _lost(task, "timeout", f"more than {timeout:g} s", timeout)
            except EOFError:
                yield _lost(task, "died", "the process died", time.perf_counter() - started)
            process.kill() if late else None
            process.join()
            pipe.close()
            del running[pipe]


def _work(task: Task, pipe: Connection) -> None:
    np.seterr(all="ignore")
    pipe.send(tried(task))
    pipe.close()


def _lost(task: Task, state: str, why: str, seconds: float) -> Outcome:
    return Outcome(task.kind, task.seed, task.range, state, why, {state: why}, {}, seconds, 0.0)


def saved_failures(outcome: Outcome, folder: Path) -> None:
    """A failed design as a file that loads again, its failures in a comment, once for each reason."""
    folder.mkdir(parents=True, exist_ok=True)
    text = gm.toml(random_design(outcome.kind, outcome.seed, outcome.range))
    for reason, line in outcome.failures.items():
        comment = "".join(f"# {row}\n" for row in f"{reason}: {line}".splitlines())
        path = folder / f"{outcome.kind}_{outcome.range}_{outcome.seed}_{reason}.toml"
        path.write_text(comment + text, encoding="utf-8")


def summary(outcomes: list[Outcome]) -> list[dict[str, object]]:
    """A row of figures for each kind and range."""
    rows = []
    for kind, name in sorted({(o.kind, o.range) for o in outcomes}):
        some = [o for o in outcomes if (o.kind, o.range) == (kind, name)]
        built = [o for o in some if o.state == "built"]
        reasons = Counter(reason for o in some for reason in o.failures)
        seconds = [o.seconds for o in built] or [0.0]
        rows.append(
            {
                "kind": f"{kind}, {name}",
                "designs": len(some),
                "refused": sum(o.state == "refused" for o in some),
                "unset": reasons["unset"],
                "traceback": reasons["traceback"],
                "lost": reasons["timeout"] + reasons["died"],
                "solid": reasons["solid"] + reasons["solids_refused"],
                "contact": reasons["contact"] + reasons["contact_refused"],
                "none": reasons["none"],
                "gears": reasons["gears"] + reasons["backlash"] + reasons["whole_refused"],
                "interference": reasons["interference"],
                "jam": reasons["jam"],
                "overlap": reasons["overlap"],
                "median": float(np.median(seconds)),
                "slow": float(np.quantile(seconds, 0.95)),
                "peak": round(max(o.peak_mb for o in some)),
            }
        )
    return rows


COLUMNS = {
    "kind": "kind, range",
    "designs": "designs",
    "refused": "refused, set key",
    "unset": "refused, unset key",
    "traceback": "tracebacks",
    "lost": "hung or died",
    "solid": "bad solids",
    "contact": "wrong contact",
    "none": "contact missed by one",
    "gears": "wrong first touch",
    "interference": "silent interference",
    "jam": "silent jams",
    "overlap": "silent overlaps",
    "median": "median, s",
    "slow": "95 %, s",
    "peak": "peak, MB",
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="designs in all, spread evenly over kinds and ranges")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first design of every kind")
    parser.add_argument("--kind", choices=sorted(KINDS), action="append", help="this kind only (may be given again)")
    parser.add_argument("--range", choices=(*RANGES, "both"), default="both")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--timeout", type=float, default=180.0, help="seconds a design may take")
    parser.add_argument("--results", type=Path, default=Path("out/stress.jsonl"), help="one line of JSON a design")
    parser.add_argument("--failures", type=Path, default=Path("out/stress"), help="folder for designs that failed")
    parser.add_argument("--resume", action="store_true", help="keep the results that are there, do what is missing")
    parser.add_argument("--write", action="store_true", help="keep the table in scripts/measured")
    args = parser.parse_args()
    unknown = set(gm.kinds()) - set(KINDS)
    if unknown:
        print(f"no ranges for {', '.join(sorted(unknown))} in stress_designs.py", file=sys.stderr)
    kinds, ranges = args.kind or list(KINDS), RANGES if args.range == "both" else (args.range,)
    classes = [(kind, name) for kind in kinds for name in ranges]
    tasks = [
        Task(*classes[k % len(classes)][:1], args.seed + k // len(classes), classes[k % len(classes)][1])
        for k in range(args.count)
    ]
    outcomes: list[Outcome] = []
    if args.resume and args.results.exists():
        outcomes = [Outcome(**json.loads(line)) for line in args.results.read_text(encoding="utf-8").splitlines()]
    known = {(o.kind, o.seed, o.range) for o in outcomes}
    todo = [task for task in tasks if (task.kind, task.seed, task.range) not in known]
    args.results.parent.mkdir(parents=True, exist_ok=True)
    with args.results.open("a" if args.resume else "w", encoding="utf-8") as file:
        for done, outcome in enumerate(many(todo, args.jobs, args.timeout), start=1):
            outcomes.append(outcome)
            file.write(json.dumps(asdict(outcome)) + "\n")
            file.flush()
            if outcome.failures:
                saved_failures(outcome, args.failures)
            print(f"{done}/{len(todo)} {outcome.kind} {outcome.range} {outcome.seed}: {outcome.state}", end="")
            print(
                f", {outcome.seconds:.1f} s",
                *(f"\n    {r}: {line}" for r, line in outcome.failures.items()),
                flush=True,
            )
    wanted = {(task.kind, task.seed, task.range) for task in tasks}
    rows = summary([o for o in outcomes if (o.kind, o.seed, o.range) in wanted])
    print(tables.table(rows, COLUMNS))
    if args.write:
        tables.keep("stress", rows, COLUMNS)
    return 1 if any(o.failures for o in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main())
