"""Writes tests/data/defaults.json: every default of every kind, and figures derived of the samples, of this version.

    python scripts/defaults_snapshot.py            writes it, and the tables of gearmesh/CHANGES.md
    python scripts/defaults_snapshot.py --check    says what has changed and leaves it, exit 1 if anything has

A default that changes changes the gears that people get from an old file: raise `gearmesh.__version__`, add an entry to
gearmesh/design/changes.py, say it in gearmesh/CHANGES.md, and run this.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gearmesh as gm
from gearmesh.design.changes import DEFAULT_CHANGES
from gearmesh.design.keys import Table

ROOT = Path(__file__).parents[1]
SNAPSHOT = ROOT / "tests" / "data" / "defaults.json"
LOG = ROOT / "gearmesh" / "CHANGES.md"
#: significant digits of derived figures: what processors differ by is less
DIGITS = 8
#: values nearer to 0 than this are rounding, mm or deg
NOTHING = 1e-9
#: keys that are the sample's own or name no default
ASIDE = ("kind", "gearmesh", "name")


def defaults(table: type[Table], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Keys of a table that have a default, and that, in words where it is derived."""
    for name in table.names():
        field, below, key = table.model_fields[name], table.table_of(name), table.key_of(name)
        if below is not None:
            yield from defaults(below, f"{prefix}{name}.")
        elif key is not None and not field.is_required() and prefix + name not in ASIDE:
            plain = field.default
            derived = plain is None or (isinstance(plain, float) and math.isnan(plain))
            yield prefix + name, key.default if derived else list(plain) if isinstance(plain, tuple) else plain


def derived(path: Path) -> dict[str, Any]:
    """Return the values that a sample leaves out and that its gears are built of."""
    return {key: rounded(value) for key, value in gm.build(gm.load(path)).pin().added.items() if key not in ASIDE}


def rounded(value: Any) -> Any:
    """A number to DIGITS significant digits."""
    if not isinstance(value, float):
        return list(value) if isinstance(value, tuple) else value
    return 0.0 if abs(value) < NOTHING else float(f"{value:.{DIGITS}g}")


def snapshot() -> dict[str, Any]:
    """All of it."""
    return {
        "gearmesh": gm.__version__,
        "defaults": {kind: dict(defaults(gm.system(kind).design)) for kind in gm.kinds()},
        "samples": {path.stem: derived(path) for path in sorted((ROOT / "samples").glob("*.toml"))},
    }


def differences(old: Any, new: Any, where: str = "") -> list[str]:
    """Return the differences of two snapshots, one line each; numbers may differ by a unit of the last digit that is kept."""
    if isinstance(old, dict) and isinstance(new, dict):
        lines = []
        for key in dict.fromkeys((*old, *new)):
            lines += differences(old.get(key, "absent"), new.get(key, "absent"), f"{where}{' ' if where else ''}{key}")
        return lines
    numbers = all(isinstance(each, float | int) and not isinstance(each, bool) for each in (old, new))
    same = math.isclose(old, new, rel_tol=10.0 ** (2 - DIGITS), abs_tol=10.0 * NOTHING) if numbers else old == new
    return [] if same else [f"{where}: {old} -> {new}"]


def change_table(version: str) -> str:
    """The rows of a version in gearmesh/CHANGES.md."""
    head = f"| kind | key | before | {version} | why |\n|---|---|---|---|---|\n"
    return head + "".join(
        f"| {', '.join(f'`{kind}`' for kind in each.kinds) or 'all'} | `{each.key}` | {each.old} | {each.new} | {each.why} |\n"
        for each in DEFAULT_CHANGES
        if each.version == version
    )


def logged(text: str) -> str:
    """The change log with the tables of the entries in design/changes.py."""
    return re.sub(
        r"(<!-- changes:([\d.]+) -->\n).*?(<!-- /changes -->)",
        lambda found: found[1] + change_table(found[2]) + found[3],
        text,
        flags=re.DOTALL,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="say what has changed, and write nothing")
    only_checks = parser.parse_args().check
    now = snapshot()
    lines = differences(json.loads(SNAPSHOT.read_text(encoding="utf-8")), now) if SNAPSHOT.exists() else []
    print("\n".join(lines))
    if only_checks:
        return 1 if lines else 0
    SNAPSHOT.write_text(json.dumps(now, indent=1) + "\n", encoding="utf-8")
    LOG.write_text(logged(LOG.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
