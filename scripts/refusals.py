"""Pushes every numeric key of every kind up and down until it is refused, and holds the refusal to its word: `value` is the key's
value, the bound that it states builds, and a value 5 % beyond is refused.

    python scripts/refusals.py                          all kinds
    python scripts/refusals.py --kinds rack planetary   some of them

Prints a line for each fault. Exits with 1 if there is one. A seeded choice of keys is in tests/systems/test_refusals.py.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from oracles.refusals import faults, numeric_keys

import gearmesh as gm


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", nargs="+", choices=gm.kinds(), default=gm.kinds(), metavar="KIND")
    fault_count = 0
    for kind in parser.parse_args().kinds:
        keys = numeric_keys(kind)
        for number, key in enumerate(keys, start=1):
            found = faults(kind, key)
            fault_count += len(found)
            print(f"{kind} {number}/{len(keys)} {key}:", *(found or ["ok"]), flush=True)
    return 1 if fault_count else 0


if __name__ == "__main__":
    sys.exit(main())
