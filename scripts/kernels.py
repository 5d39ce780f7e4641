"""Run tests under the kernels that other processors get: last digits differ, and all tests must pass.

    python scripts/kernels.py                                  the quick tests, under all of them
    python scripts/kernels.py --only Prescott -- -n 0 tests/kernel      pytest's own arguments after --
    python scripts/kernels.py --designs samples/*.toml     compares the answers of `tca` with those of this processor

OpenBLAS chooses its kernels and numpy its vector loops by the processor; the script sets them by OPENBLAS_CORETYPE and
NPY_DISABLE_CPU_FEATURES.
Kernels that this processor cannot run are named and left out. Exit 1 if tests fail under a kernel, or figures differ.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
#: OpenBLAS's kernels for SSE3, AVX2 and AVX-512: the name to request, and the name that OpenBLAS then reports
CORES = {"Prescott": "Katmai", "Haswell": "Haswell", "SkylakeX": "SkylakeX"}
#: numpy's own loops with nothing beyond its baseline
PLAIN = "plain-numpy"
#: program that prints the kernels in use and the features that numpy can switch off; it crashes if the processor cannot run the
#: kernels, because OpenBLAS does not check this
ASK = """
import numpy, scipy.linalg, threadpoolctl
numpy.ones((64, 64)) @ numpy.ones((64, 64))
scipy.linalg.solve(numpy.eye(64), numpy.ones(64))
from numpy._core._multiarray_umath import __cpu_dispatch__ as names, __cpu_features__ as has
print(*sorted({each.get("architecture", "") for each in threadpoolctl.threadpool_info()}), sep=",")
print(*(name for name in names if has[name]))
"""

#: largest difference of figures of an answer, relative, or absolute for figures below 1
EQUAL = 1e-6


def answers(environment: dict[str, str]) -> tuple[set[str], str]:
    """Return OpenBLAS's kernels in an environment, and the features beyond its baseline that numpy uses; no kernels if they
    cannot run."""
    found = subprocess.run([sys.executable, "-c", ASK], env=environment, capture_output=True, text=True)
    if found.returncode < 0:
        return set(), ""
    found.check_returncode()
    kernels, features = found.stdout.split("\n")[:2]
    return set(kernels.split(",")), features


def environment_of(name: str) -> dict[str, str] | None:
    """Return the environment of a kernel, None if the kernel is not available."""
    own = dict(os.environ)
    for key in ("OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES"):
        own.pop(key, None)
    if name == PLAIN:
        features = answers(own)[1]
        own["NPY_DISABLE_CPU_FEATURES"] = features
        return own if features and not answers(own)[1] else None
    own["OPENBLAS_CORETYPE"] = name
    return own if answers(own)[0] & {name, CORES[name]} else None


def contact_of(design: Path, environment: dict[str, str]) -> Any:
    """Return the answer of `tca` about a design in an environment: its JSON, or the line of its refusal."""
    command = [sys.executable, "-m", "gearmesh", "tca", str(design), "--json", "-"]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    if not done.stdout:
        return done.stderr
    answer = json.loads(done.stdout)
    del answer["timing"]
    return answer


def apart(one: Any, other: Any, where: str = "") -> Iterator[str]:
    """Yield the places where two answers differ by more than `EQUAL`, with the difference."""
    numbers = [type(value) in (int, float) for value in (one, other)]
    if isinstance(one, dict) and isinstance(other, dict):
        for key in [*one, *(key for key in other if key not in one)]:
            yield from apart(one.get(key), other.get(key), f"{where}.{key}" if where else key)
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for k, values in enumerate(zip(one, other, strict=True)):
            yield from apart(*values, f"{where}[{k}]")
    elif not (all(numbers) and math.isclose(one, other, rel_tol=EQUAL, abs_tol=EQUAL)) and one != other:
        yield f"{where}: {one} here, {other} there"


def differing(design: Path, names: list[str]) -> Iterator[str]:
    """Yield the differences in the answers of `tca` about a design under kernels by name, a line each."""
    here = contact_of(design, dict(os.environ))
    for name in names:
        environment = environment_of(name)
        if environment is not None:
            yield from (f"{design.name}, {name}: {line}" for line in apart(here, contact_of(design, environment)))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=(*CORES, PLAIN), metavar="KERNEL", help=", ".join((*CORES, PLAIN)))
    parser.add_argument("tests", nargs="*", help="arguments of pytest, after --; by default -m quick")
    parser.add_argument(
        "--designs", nargs="+", type=Path, metavar="DESIGN", help="compare answers on them, run no tests"
    )
    options = parser.parse_args()
    names = options.only or [*CORES, PLAIN]
    failed = []
    for design in options.designs or ():
        lines = list(differing(design, names))
        print("\n".join(lines or [f"{design.name}: the same"]), flush=True)
        failed += [design.name] if lines else []
    if options.designs:
        return 1 if failed else 0
    for name in names:
        environment = environment_of(name)
        if environment is None:
            print(f"{name}: not on this processor", flush=True)
            continue
        started = time.monotonic()
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", *(options.tests or ["-m", "quick"])], cwd=ROOT, env=environment
        )
        print(f"{name}: exit {done.returncode}, {time.monotonic() - started:.0f} s", flush=True)
        failed += [name] if done.returncode else []
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
