"""Members with the flanks and at the places that were measured of their teeth, as the table `measured` of a design has them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from gearmesh.design.core import Design
from gearmesh.errors import DesignError
from gearmesh.metrology.flanks.measured_flank import MeasuringMode, with_measured_flanks
from gearmesh.metrology.measured_teeth import InspectionBasis, pitch_radius
from gearmesh.metrology.pitch import MeasuredPitch, PitchDeviations, index_angles
from gearmesh.metrology.pitch_file import UM, read_pitch
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side

#: what a member, by its name, is inspected by; None where its system does not say
BasisOf = Callable[[str], InspectionBasis | None]


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


class MeasuredPlaces:
    """Puts the teeth of members of a design where they were measured."""

    def __init__(self, design: Design) -> None:
        self._table = getattr(design, "measured", None)
        self._named = design.table_named

    def says(self, name: str) -> bool:
        """Whether the design has pitch deviations or runout of a member."""
        own = self._named(name)
        return any(getattr(self._table, key, None) is not None for key in (_file_key(own), *_list_keys(own)))

    def pitch(self, name: str, teeth: int) -> MeasuredPitch:
        """What the design has of a member of so many teeth. Raises FileError and DesignError naming the key."""
        own = self._named(name)
        file, lists = getattr(self._table, _file_key(own), None), {}
        for key in _list_keys(own):
            values = getattr(self._table, key, None)
            if values is None:
                continue
            if file is not None:
                raise DesignError(f"measured.{key}", reason=f"cannot be given together with measured.{_file_key(own)}")
            if len(values) != teeth:
                raise DesignError(f"measured.{key}", f"{len(values)} values", must_be=f"{teeth} values, one a tooth")
            lists[key] = UM * np.array(values)
        if file is not None:
            return read_pitch(Path(file), teeth)
        *of_sides, of_runout = _list_keys(own)
        sides = {side: PitchDeviations(lists[key]) for side, key in zip(Side, of_sides, strict=True) if key in lists}
        return MeasuredPitch(sides, lists.get(of_runout))

    def of_member(self, member: Member, basis_of: BasisOf) -> Member:
        """The member with its teeth where they were measured; itself, where the design has none.

        Deviations are arcs of the circle that its system measures them on, or of that through the middle of its flanks. Raises as
        `pitch`.
        """
        if not self.says(member.name):
            return member
        tooth, basis = member.tooth, basis_of(member.name)
        of_runout = f"measured.{_list_keys(self._named(member.name))[-1]}"
        pitch = self.pitch(member.name, tooth.teeth).complete(None if basis is None else basis.ball, of_runout)
        return replace(member, index=index_angles(pitch, pitch_radius(tooth, basis)))


def _file_key(member: str) -> str:
    return f"{member}_pitch"


def _list_keys(member: str) -> tuple[str, ...]:
    return (*(f"{member}_pitch_{side}_um" for side in Side), f"{member}_runout_um")
