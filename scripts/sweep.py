"""Runs all tests that have the mark sweep, in ten parts, of which CI runs two for each commit (a fifth): before a version.

    python scripts/sweep.py                     all ten parts, one after the other
    python scripts/sweep.py --parts 3 7         only these, such as those that failed
    python scripts/sweep.py -- -x               pytest's own arguments after --

Prints the exit status and the time of each part. Exits with 1 if a part failed.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
PART_COUNT = 10
#: exit status of pytest where a part has no test of the files that were asked for
NO_TESTS_COLLECTED = 5


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    numbers = range(1, PART_COUNT + 1)
    parser.add_argument(
        "--parts", nargs="+", type=int, choices=numbers, metavar="K", default=[*numbers], help="1 to 10"
    )
    parser.add_argument("arguments", nargs="*", help="arguments of pytest, after --")
    options = parser.parse_args()
    failed = []
    for number in options.parts:
        started = time.monotonic()
        command = [sys.executable, "-m", "pytest", "-q", "-m", "sweep", "--part", f"{number}/{PART_COUNT}"]
        status = subprocess.run([*command, *options.arguments], cwd=ROOT).returncode
        print(f"part {number} of {PART_COUNT}: exit {status}, {time.monotonic() - started:.0f} s", flush=True)
        failed += [number] if status not in (0, NO_TESTS_COLLECTED) else []
    if failed:
        print("failed: --parts", *failed)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
