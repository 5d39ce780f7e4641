"""Pushes every numeric key of every kind up and down until it is refused, and holds the refusal to its word: `value` is the key's
value, the bound that it states builds, and a value 5 % beyond is refused.

    python scripts/refusals.py                                      all kinds
    python scripts/refusals.py --kinds rack planetary               some of them
    python scripts/refusals.py --keep out/refusals.jsonl --write    goes on where it was stopped, and keeps the table

Prints a line for each key, with its faults, and a table by kind. Exits with 1 if there is a fault. With --keep keys are kept in a
file as they are pushed, and those in it are not pushed again. --write keeps the table in scripts/measured. A seeded
choice of keys is in tests/systems/test_refusals.py.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
import tables
from oracles.refusals import numeric_keys, verdict

import gearmesh as gm

COLUMNS = {
    "kind": "kind",
    "keys": "keys",
    "refusals": "refusals",
    "built": "stated bounds that build",
    "followed": "bounds behind which another refusal follows",
    "faults": "faults",
    "longest": "longest refusal, CPU s",
}


@dataclass(frozen=True)
class Pushed:
    """A key that was pushed: refusals, bounds that build, bounds behind which another refusal follows, longest refusal, faults."""

    kind: str
    key: str
    refusals: int
    built: int
    followed: int
    longest: float
    faults: list[str]


def kept(file: Path | None) -> dict[tuple[str, str], Pushed]:
    """Keys that were pushed already, by kind and name."""
    if file is None or not file.exists():
        return {}
    keys = [Pushed(**json.loads(line)) for line in file.read_text(encoding="utf-8").splitlines()]
    return {(key.kind, key.key): key for key in keys}


def rows(keys: list[Pushed]) -> list[dict[str, object]]:
    """A row for each kind."""
    made: list[dict[str, object]] = []
    for kind in dict.fromkeys(key.kind for key in keys):
        own = [key for key in keys if key.kind == kind]
        made.append(
            {
                "kind": kind,
                "keys": len(own),
                **{name: sum(getattr(key, name) for key in own) for name in ("refusals", "built", "followed")},
                "faults": sum(len(key.faults) for key in own),
                "longest": max(key.longest for key in own),
            }
        )
    return made


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", nargs="+", choices=gm.kinds(), default=gm.kinds(), metavar="KIND")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="JSON lines of the keys that have been pushed")
    parser.add_argument("--write", action="store_true", help="keep the table in scripts/measured")
    asked = parser.parse_args()
    pushed = kept(asked.keep)
    for kind in asked.kinds:
        keys = numeric_keys(kind)
        for number, key in enumerate(keys, start=1):
            if (kind, key) in pushed:
                continue
            found = pushed[kind, key] = Pushed(kind, key, **asdict(verdict(kind, key)))
            print(f"{kind} {number}/{len(keys)} {key}, {found.longest:.2f} s:", *(found.faults or ["ok"]), flush=True)
            if asked.keep:
                with asked.keep.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(asdict(found)) + "\n")
    shown = [pushed[kind, key] for kind in asked.kinds for key in numeric_keys(kind)]
    found = rows(shown)
    print(f"\n{tables.table(found, COLUMNS)}")
    if asked.write:
        tables.keep("refusals", found, COLUMNS)
    return 1 if any(key.faults for key in shown) else 0


if __name__ == "__main__":
    sys.exit(main())
