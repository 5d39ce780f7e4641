"""Cost of studies: CPU seconds a row in this process, on two processes and on a Dask cluster, and the time of Dask itself.

    python scripts/study_bench.py [--rows 3200] [--loads] [--write]

CPU seconds are those of all processes together, so that they do not depend on what else the machine does; `--write` keeps the
tables in scripts/measured. With `--loads` only studies under load are measured.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

import tables

import gearmesh as gm
from gearmesh.study.rows.work import MAX_BATCHED_ROWS, _build

ROOT = Path(__file__).parents[1]
BEVEL = ROOT / "samples" / "spiral_bevel_basic.toml"
SPREAD = {
    "assembly.dV": "normal:0:0.03",
    "assembly.dA": "normal:0:0.03",
    "assembly.dG": "normal:0:0.03",
    "assembly.d_delta": "normal:0:0.01",
}
#: keys of designs that are built anew
REBUILT = {"pressure_angle": "uniform:19.5:20.5", "contact.delta": "uniform:0.005:0.008"}
HELICAL = {"helix_angle": "uniform:14:16", "pinion.profile_shift": "uniform:-0.05:0.05"}
#: torques, Nm, of studies under load, and their rows of misalignments
TORQUES, LOADED = (20.0, 40.0, 80.0), 6
#: tasks by which the overhead of Dask is measured
TASKS = 1000
COLUMNS = {
    "study": {
        "what": "study of spiral_bevel_basic, 21 positions",
        "rows": "rows",
        "wall": "time, s",
        "cpu": "CPU, s",
        "each": "CPU, ms per row",
        "efficiency": "efficiency",
    },
    "study_loads": {
        "what": "study of spiral_bevel_basic under load, in process",
        "rows": "rows",
        "cpu": "CPU, s",
        "first": "of it the design as it is, s",
        "more": "CPU, s each further row",
    },
    "dask": {
        "task": "time of Dask for a task, ms",
        "tasks": "tasks without work",
        "chunk": f"work in a chunk of {MAX_BATCHED_ROWS} misalignments, s",
        "share": "time of Dask over the work, %",
    },
}


def cpu() -> float:
    """CPU seconds of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def timed(what: str, rows: int, work: Callable[[], Any]) -> dict[str, Any]:
    """A row of the table."""
    wall, before = time.perf_counter(), cpu()
    work()
    wall, used = time.perf_counter() - wall, cpu() - before
    print(f"{what}: {rows} rows in {wall:.1f} s, {used:.1f} s CPU", flush=True)
    return {"what": what, "rows": rows, "wall": wall, "cpu": used, "each": 1e3 * used / rows}


def on_cluster(gears: gm.Gears, rows: int, **more: Any) -> None:
    """A study on two workers of a local cluster, whose processes end with it."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        gears.study(sample=rows, tolerance=SPREAD, scheduler=cluster.scheduler_address, **more)


def nothing(rows: list[Any]) -> int:
    """Work that takes no time."""
    return len(rows)


def overhead() -> float:
    """Seconds that Dask takes for a task: TASKS of them without work, on two workers."""
    from distributed import LocalCluster

    from gearmesh.study.runners import Scheduler, runner

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        runner(1, Scheduler(cluster.scheduler_address)) as run,
    ):
        list(run(nothing, [(k, []) for k in range(20)]))
        started = time.perf_counter()
        list(run(nothing, [(k, []) for k in range(TASKS)]))
        return (time.perf_counter() - started) / TASKS


def measured(rows: int, designs: int) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Rows of studies, and one row of what Dask takes."""
    gears = gm.build(gm.load(BEVEL))
    path: dict[str, Any] = {"record": "path"}
    sampled: dict[str, Any] = {"sample": rows, "tolerance": SPREAD, **path}
    found = [
        timed("misalignments, path, in process", rows, lambda: gears.study(**sampled, workers=1)),
        timed("the same on 2 processes", rows, lambda: gears.study(**sampled, workers=2)),
        timed("the same on 2 Dask workers", rows, lambda: on_cluster(gears, rows, **path)),
    ]
    for each in found:
        each["efficiency"] = found[0]["cpu"] / each["cpu"]
    found += [
        timed("misalignments, path and cycle", 40, lambda: gears.study(sample=40, tolerance=SPREAD, workers=1)),
        timed(
            "designs built anew, path",
            designs,
            lambda: gears.study(sample=designs, tolerance=REBUILT, record="path", workers=1),
        ),
        timed(
            "helical: designs built anew, path",
            designs,
            lambda: gm.build(gm.load(ROOT / "samples" / "helical.toml")).study(
                sample=designs, tolerance=HELICAL, record="path", workers=1
            ),
        ),
    ]
    task = overhead()
    chunk = MAX_BATCHED_ROWS * 1e-3 * found[0]["each"]
    return found, [{"task": 1e3 * task, "tasks": TASKS, "chunk": chunk, "share": 100.0 * task / chunk}]


def loads() -> list[dict[str, Any]]:
    """Studies under load: each works the design out as it is, and then one row or several."""
    found = []
    for what, keys, torques, rows in (
        ("misalignments, 1 torque", SPREAD, TORQUES[:1], LOADED),
        ("misalignments, 3 torques", SPREAD, TORQUES, LOADED),
        ("designs built anew, 1 torque", REBUILT, TORQUES[:1], LOADED // 2),
    ):
        more: dict[str, Any] = {"record": "load", "torque": torques, "tolerance": keys, "workers": 1}
        took = []
        for count in (1, 1 + rows):
            # a design that is known already is not built again
            _build.cache_clear()
            gears = gm.build(gm.load(BEVEL))
            took.append(timed(what, count, partial(gears.study, sample=count, **more)))
        each = (took[1]["cpu"] - took[0]["cpu"]) / rows
        found.append({**took[1], "more": each, "first": took[0]["cpu"] - each})
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=3200)
    parser.add_argument("--designs", type=int, default=40)
    parser.add_argument("--write", action="store_true", help="keep the tables in scripts/measured")
    parser.add_argument("--loads", action="store_true", help="only studies under load")
    options = parser.parse_args()
    found = {"study_loads": loads()}
    if not options.loads:
        found["study"], found["dask"] = measured(options.rows, options.designs)
    for name, rows in found.items():
        print(tables.table(rows, COLUMNS[name]), end="\n\n")
        if options.write:
            tables.keep(name, rows, COLUMNS[name])


if __name__ == "__main__":
    main()
