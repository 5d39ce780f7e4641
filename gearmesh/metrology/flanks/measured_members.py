"""Members with the flanks that were measured of them, as the table `measured` of a design has files."""

from __future__ import annotations

from pathlib import Path

from gearmesh.design.core import Design
from gearmesh.metrology.flanks.measured_flank import MeasuringMode, with_measured_flanks
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side


class MeasuredMembers:
    """Makes members of a design as measured; members of one shape, as planets, stay so. `warnings`: of what was made."""

    def __init__(self, design: Design) -> None:
        self._table = getattr(design, "measured", None)
        self._named = design.table_named
        self._known: dict[tuple[str, int], Member] = {}
        self.warnings: tuple[str, ...] = ()

    @property
    def any(self) -> bool:
        """Whether the design has files of measured flanks."""
        return any(name.endswith(tuple(Side)) for name in getattr(self._table, "model_fields_set", ()))

    def of_member(self, member: Member) -> Member:
        """The member as measured; itself, where no file is about it. Raises FileError and DesignError naming the key."""
        own = self._named(member.name)
        keys = {side: f"{own}_{side}" for side in Side}
        files = {side: Path(file) for side, key in keys.items() if (file := getattr(self._table, key, None))}
        if not files:
            return member
        if (own, id(member.tooth)) not in self._known:
            assert self._table is not None
            mode = MeasuringMode(self._table.axial_position == "free", self._table.stiffness)
            dotted = {side: f"measured.{key}" for side, key in keys.items()}
            made, notes = with_measured_flanks(member, files, mode, dotted)
            self._known[own, id(member.tooth)] = made
            self.warnings += notes
        real = self._known[own, id(member.tooth)]
        return member.with_tooth(real.tooth)
