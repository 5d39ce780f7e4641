"""Worm drives of all flank forms, cut by hobs of the worm's size and by larger ones."""

from __future__ import annotations

from typing import Any

import gearmesh as gm
from oracles.built import built

FORMS = ("ZI", "ZA", "ZN", "ZK", "ZC")
#: reference diameter (mm) of a hob larger than the worm's 60
OVERSIZE = 66.0
#: name -> keys of tables that are set anew
DRIVES: dict[str, dict[str, dict[str, Any]]] = {
    **{form: {"worm": {"form": form}} for form in FORMS},
    **{f"{form} oversize": {"worm": {"form": form}, "hob": {"reference_diameter": OVERSIZE}} for form in FORMS},
}
BASE: dict[str, Any] = {
    "kind": "worm_drive",
    "module": 5,
    "backlash": 0.2,
    "worm": {"threads": 2, "reference_diameter": 60, "length": 80},
    "wheel": {"teeth": 38},
}


def drive(name: str, **tables: dict[str, Any]) -> gm.Gears:
    """One of `DRIVES`, with keys of tables set anew."""
    keys = dict(BASE)
    for changes in (DRIVES[name], tables):
        for table, values in changes.items():
            keys[table] = {**keys.get(table, {}), **values}
    return built(keys)
