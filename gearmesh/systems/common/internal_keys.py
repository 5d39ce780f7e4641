"""Internal gears in designs: a tooth number below 0 [ISO 21771], and the tables of a body that a ring does not have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gearmesh.design.core import MemberTable
from gearmesh.design.keys import Table, conflict

#: tables of a body that an internal gear does not have
NOT_INSIDE: tuple[str, ...] = (
    "keyway",
    "hex_bore",
    "d_bore",
    "hub",
    "web",
    "toe_hub",
    "heel_shaft",
    "toe_shaft",
    "spokes",
)


def with_internal(keys: Any) -> Any:
    """Return the keys of a member; a tooth number below zero says an internal gear."""
    if not isinstance(keys, Mapping):
        return keys
    teeth = keys.get("teeth")
    if isinstance(teeth, bool) or not isinstance(teeth, int | float) or teeth >= 0:
        return keys
    if keys.get("internal", True) is False:
        raise conflict(
            "teeth", teeth, reason="a negative number of teeth means an internal gear, but internal is false"
        )
    return {**keys, "teeth": -teeth, "internal": True}


def check_ring(table: MemberTable, *, internal: bool, rim: float | None) -> None:
    """Refuse the body of a disc on an internal gear, and a rim on an external one."""
    if not internal:
        if rim is not None:
            raise conflict("rim", rim, reason="only an internal gear has one")
        return
    for key in ("bore", *NOT_INSIDE):
        if (given := getattr(table, key)) is not None:
            raise conflict(
                key,
                None if isinstance(given, Table) else given,
                reason="an internal gear has none (teeth below 0 mean one); its body is the rim around the teeth",
            )
