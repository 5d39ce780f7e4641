"""Members with measured flanks and with measured positions of their teeth, from the table `measured` of a design."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np

from gearmesh.design.core import Design
from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.metrology.drawn_pitch import drawn_pitch
from gearmesh.metrology.flanks.measured_flank import MeasuringMode, with_measured_flanks
from gearmesh.metrology.measured_teeth import InspectionBasis, pitch_radius
from gearmesh.metrology.pitch import MeasuredPitch, PitchDeviations, index_angles
from gearmesh.metrology.pitch_file import MM_PER_UM, read_pitch
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side

#: Inspection basis of a member by its name; None if its system has none
BasisOf = Callable[[str], InspectionBasis | None]


class MeasuredMembers:
    """Builds the measured members of a design; members with one shape, as planets, share it. `warnings` collects
    remarks on the files."""

    def __init__(self, design: Design) -> None:
        self._table = getattr(design, "measured", None)
        self._named = design.table_named
        self._known: dict[tuple[str, int], Member] = {}
        self.warnings: tuple[str, ...] = ()

    @property
    def any(self) -> bool:
        """True if the design has files of measured flanks."""
        return any(name.endswith(tuple(Side)) for name in getattr(self._table, "model_fields_set", ()))

    def of_member(self, member: Member) -> Member:
        """Return the member with its measured flanks, or the member itself without a file. Raises FileError and
        DesignError that name the key."""
        table_name = self._named(member.name)
        keys = {side: f"{table_name}_{side}" for side in Side}
        files = {side: Path(file) for side, key in keys.items() if (file := getattr(self._table, key, None))}
        if not files:
            return member
        if (table_name, id(member.tooth)) not in self._known:
            assert self._table is not None
            mode = MeasuringMode(self._table.axial_position == "free", self._table.stiffness)
            dotted = {side: f"measured.{key}" for side, key in keys.items()}
            measured_member, notes = with_measured_flanks(member, files, mode, dotted)
            self._known[table_name, id(member.tooth)] = measured_member
            self.warnings += notes
        known_member = self._known[table_name, id(member.tooth)]
        return member.with_tooth(known_member.tooth)


class MeasuredPlaces:
    """Moves the teeth of a design's members to their measured positions."""

    def __init__(self, design: Design) -> None:
        self._table = getattr(design, "measured", None)
        self._named = design.table_named

    def says(self, name: str) -> bool:
        """Return True if the design has pitch deviations or runout of a member."""
        return self.farther_out(name) is not None or any(value is not None for value in self._values(name).values())

    def farther_out(self, name: str, teeth: int | None = None) -> Array | None:
        """Return the distances (N,), mm, by which the teeth of a member are farther from its axis; None if none are given.

        Raises DesignError for another number than that of the `teeth`.
        """
        key = f"{self._named(name)}_radial_um"
        values = getattr(self._table, key, None)
        if values is None:
            return None
        if teeth is not None and len(values) != teeth:
            raise DesignError(f"measured.{key}", f"{len(values)} values", must_be=f"{teeth} values, one a tooth")
        return np.asarray(MM_PER_UM * np.array(values))

    def _values(self, name: str) -> dict[str, Any]:
        table_name = self._named(name)
        return {
            key: getattr(self._table, key, None)
            for key in (_file_key(table_name), *_list_keys(table_name), *_drawn_keys(table_name))
        }

    def pitch(self, name: str, teeth: int, basis: InspectionBasis | None) -> MeasuredPitch:
        """Return the measured or drawn pitch deviations of a member with `teeth` teeth.

        `basis`: inspection basis of the member. Raises FileError and DesignError that name the key.
        """
        table_name, given = self._named(name), self._values(name)
        file, lists = given[_file_key(table_name)], dict[str, Array]()
        self._refuse_together(table_name, given)
        if any(given[key] is not None for key in _drawn_keys(table_name)):
            return self._draw(table_name, teeth, basis)
        for key in _list_keys(table_name):
            values = given[key]
            if values is None:
                continue
            if len(values) != teeth:
                raise DesignError(f"measured.{key}", f"{len(values)} values", must_be=f"{teeth} values, one a tooth")
            lists[key] = MM_PER_UM * np.array(values)
        if file is not None:
            return read_pitch(Path(file), teeth)
        *of_sides, of_runout = _list_keys(table_name)
        sides = {side: PitchDeviations(lists[key]) for side, key in zip(Side, of_sides, strict=True) if key in lists}
        return MeasuredPitch(sides, lists.get(of_runout))

    @staticmethod
    def _refuse_together(table_name: str, values: dict[str, Any]) -> None:
        """Raise DesignError if the positions of teeth are given in two ways."""
        alternatives = ([_file_key(table_name)], _list_keys(table_name), _drawn_keys(table_name))
        keys = [
            key
            for alternative in alternatives
            for key in [next((key for key in alternative if values[key] is not None), None)]
            if key
        ]
        if len(keys) > 1:
            raise DesignError(f"measured.{keys[1]}", reason=f"cannot be given together with measured.{keys[0]}")

    def _draw(self, table_name: str, teeth: int, basis: InspectionBasis | None) -> MeasuredPitch:
        """Draw a gear of the class that the table gives, or of the class that the design asks for."""
        of_class, of_seed = _drawn_keys(table_name)
        tolerance_class, seed = getattr(self._table, of_class), getattr(self._table, of_seed)
        if basis is None:
            raise DesignError(
                f"measured.{of_class if tolerance_class is not None else of_seed}",
                reason=f"pitch deviations of the {table_name} have no tolerances",
                allowed="cylindrical and bevel gears",
            )
        finest, coarsest = basis.sizes.classes
        tolerance_class = basis.asked if tolerance_class is None else tolerance_class
        if not finest <= tolerance_class <= coarsest:
            raise DesignError(
                f"measured.{of_class}", tolerance_class, must_be=f"a whole number from {finest} to {coarsest}"
            )
        # members with the same seed differ by their name
        return MeasuredPitch(drawn_pitch(basis, teeth, tolerance_class, (seed or 0, crc32(table_name.encode()))))

    def of_member(self, member: Member, basis_of: BasisOf) -> Member:
        """Return the member with its teeth at their measured positions, or the member itself without any.

        Deviations are arcs of the circle that the system measures them on, or of the circle through the middle of the
        flanks. Raises the errors of `pitch`.
        """
        if not self.says(member.name):
            return member
        tooth, basis = member.tooth, basis_of(member.name)
        of_runout = f"measured.{_list_keys(self._named(member.name))[-1]}"
        pitch = self.pitch(member.name, tooth.teeth, basis).complete(None if basis is None else basis.ball, of_runout)
        index = index_angles(pitch, pitch_radius(tooth, basis))
        away = self.farther_out(member.name, tooth.teeth)
        return replace(member, index=index if away is None else replace(index, outwards=tuple(away.tolist())))


def _file_key(member: str) -> str:
    return f"{member}_pitch"


def _drawn_keys(member: str) -> tuple[str, str]:
    return f"{member}_pitch_class", f"{member}_pitch_seed"


def _list_keys(member: str) -> tuple[str, ...]:
    return (*(f"{member}_pitch_{side}_um" for side in Side), f"{member}_runout_um")
