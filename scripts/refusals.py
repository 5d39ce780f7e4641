"""Push numeric keys of every kind up and down until they are refused, and check each refusal: `value` is the key's value, the
stated bound builds, and a value 5 % beyond is refused.

    python scripts/refusals.py                                      the examples of all kinds
    python scripts/refusals.py --designs rack internal zerol        kinds or samples
    python scripts/refusals.py --designs hypoid --keys 40           a seeded choice of 40 keys
    python scripts/refusals.py --keep out/refusals.jsonl --write    goes on where it was stopped, and keeps the table

Prints a line for each key, with its faults, and a table by design. Exits with 1 if there is a fault. --keep keeps each key in a
file when it was pushed, and does not push the keys of this file again. --write keeps the rows in scripts/measured; the rows of
other designs stay. A seeded choice of keys is in tests/systems/test_refusals.py.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
import tables
from oracles.refusals import SAMPLES, numeric_keys, verdict

import gearmesh as gm

COLUMNS = {
    "design": "kind or sample",
    "keys": "keys",
    "of": "of",
    "refusals": "refusals",
    "built": "stated bounds that build",
    "followed": "bounds behind which another refusal follows",
    "faults": "faults",
    "longest": "longest refusal, CPU s",
}


@dataclass(frozen=True)
class Pushed:
    """Result for a pushed key: numbers of refusals, of bounds that build and of bounds with another refusal behind them; the
    longest refusal; faults."""

    design: str
    key: str
    refusals: int
    built: int
    followed: int
    longest: float
    faults: list[str]


def kept(file: Path | None) -> dict[tuple[str, str], Pushed]:
    """Keys that were pushed already, by design and name."""
    if file is None or not file.exists():
        return {}
    keys = [Pushed(**json.loads(line)) for line in file.read_text(encoding="utf-8").splitlines()]
    return {(key.design, key.key): key for key in keys}


def row(design: str, keys: list[Pushed]) -> dict[str, object]:
    """Row of the table."""
    return {
        "design": design,
        "keys": len(keys),
        "of": len(numeric_keys(design)),
        **{name: sum(getattr(key, name) for key in keys) for name in ("refusals", "built", "followed")},
        "faults": sum(len(key.faults) for key in keys),
        "longest": max(key.longest for key in keys),
    }


def with_other_rows(rows: list[tables.Row]) -> list[tables.Row]:
    """Return rows together with the kept rows of other designs."""
    titles = {title: key for key, title in COLUMNS.items()}
    before = [{titles[title]: cell for title, cell in row.items()} for row in tables.kept("refusals")]
    own = {row["design"] for row in rows}
    return [*rows, *(row for row in before if row["design"] not in own)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    known = [*gm.kinds(), *(sample.stem for sample in SAMPLES.glob("*.toml"))]
    parser.add_argument(
        "--designs", nargs="+", choices=known, default=gm.kinds(), metavar="NAME", help="kinds or samples"
    )
    parser.add_argument("--keys", type=int, metavar="COUNT", help="a seeded choice of keys, the same each time")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="JSON lines of the keys that have been pushed")
    parser.add_argument("--write", action="store_true", help="keep the rows in scripts/measured")
    asked = parser.parse_args()
    pushed, shown = kept(asked.keep), dict[str, list[Pushed]]()
    for design in asked.designs:
        keys = numeric_keys(design, asked.keys)
        for number, key in enumerate(keys, start=1):
            if (design, key) in pushed:
                continue
            found = pushed[design, key] = Pushed(design, key, **asdict(verdict(design, key)))
            print(f"{design} {number}/{len(keys)} {key}, {found.longest:.2f} s:", *(found.faults or ["ok"]), flush=True)
            if asked.keep:
                with asked.keep.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(asdict(found)) + "\n")
        shown[design] = [pushed[design, key] for key in keys]
    rows: list[tables.Row] = [row(design, keys) for design, keys in shown.items()]
    print(f"\n{tables.table(rows, COLUMNS)}")
    if asked.write:
        tables.keep("refusals", with_other_rows(rows), COLUMNS)
    return 1 if any(key.faults for keys in shown.values() for key in keys) else 0


if __name__ == "__main__":
    sys.exit(main())
