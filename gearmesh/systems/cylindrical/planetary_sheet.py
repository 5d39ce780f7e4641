"""The data sheet of a planetary set: those of both of its meshes, sun with planet and planet with ring [ISO 21771-1]."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.cylindrical.planetary import meshes
from gearmesh.systems.cylindrical.planetary_design import PLANET, RING, SUN
from gearmesh.systems.cylindrical.sheet import pair_tables
from gearmesh.systems.system import Sheet, SheetTable, completed
from gearmesh.teeth.train import Train

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.planetary_design import PlanetaryDesign


def planetary_sheet(design: PlanetaryDesign, train: Train) -> Sheet:
    """The sheet of a planetary design and the train built of it; what that of any system has is part of it."""
    own = completed(design).in_mm()
    found = meshes(own)
    derived, *plain = plain_sheet(own, train).tables
    members = {SUN: train.members[SUN], PLANET: train.members[f"{PLANET}_1"], RING: train.members[RING]}
    tables: list[SheetTable] = []
    for mesh, names in ((found.inner, (SUN, PLANET)), (found.outer, (PLANET, RING))):
        # the meshes have what shapes their teeth alone
        whole = mesh.model_copy(update={"accuracy_class": own.accuracy_class, "material": own.material})
        for table in pair_tables(whole, tuple(members[name] for name in names), names):
            tables.append(replace(table, title=f"{names[0].capitalize()} and {names[1]}: {table.title}"))
    return Sheet((derived, *tables, *plain), {})
