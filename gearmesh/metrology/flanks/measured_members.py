"""Members with measured flanks and with measured positions of their teeth, from the table `measured` of a design."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np

from gearmesh.design.core import Design
from gearmesh.design.measured import MeasuredMember, MeasuredTable
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


def flank_keys(table_name: str) -> dict[Side, str]:
    """Return the keys of a design that name the files of a member's flanks, with the name of their table."""
    return {side: f"measured.{MeasuredMember(table_name).flank(side)}" for side in Side}


def flank_files(design: Design, table_name: str) -> dict[Side, Path]:
    """Return the files of a member's flanks that a design names."""
    flanks, table = MeasuredMember(table_name), getattr(design, "measured", None)
    return {side: Path(file) for side in Side if (file := getattr(table, flanks.flank(side), None))}


def measuring_mode(table: MeasuredTable | None) -> MeasuringMode:
    """Return the settings of the table `measured` for reading files of flanks."""
    return MeasuringMode() if table is None else MeasuringMode(table.axial_position == "free", table.stiffness)


class MeasuredMembers:
    """Builds the measured members of a design; members with one shape, as planets, share it. `warnings` collects
    remarks on the files."""

    def __init__(self, design: Design) -> None:
        self._design = design
        self._known: dict[tuple[str, int], Member] = {}
        self.warnings: tuple[str, ...] = ()

    @property
    def any(self) -> bool:
        """True if the design has files of measured flanks."""
        given = getattr(getattr(self._design, "measured", None), "model_fields_set", ())
        return any(name.endswith(tuple(Side)) for name in given)

    def of_member(self, member: Member) -> Member:
        """Return the member with its measured flanks, or the member itself without a file. Raises FileError and
        DesignError that name the key."""
        table_name = self._design.table_named(member.name)
        files = flank_files(self._design, table_name)
        if not files:
            return member
        if (table_name, id(member.tooth)) not in self._known:
            mode = measuring_mode(getattr(self._design, "measured", None))
            measured_member, notes = with_measured_flanks(member, files, mode, flank_keys(table_name))
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
        key = self._keys(name).farther_out
        values = getattr(self._table, key, None)
        if values is None:
            return None
        if teeth is not None and len(values) != teeth:
            raise DesignError(f"measured.{key}", f"{len(values)} values", must_be=f"{teeth} values, one a tooth")
        return np.asarray(MM_PER_UM * np.array(values))

    def _values(self, name: str) -> dict[str, Any]:
        keys = self._keys(name)
        known = (keys.pitch_file, *keys.lists, keys.drawn_class, keys.drawn_seed)
        return {key: getattr(self._table, key, None) for key in known}

    def _keys(self, name: str) -> MeasuredMember:
        return MeasuredMember(self._named(name))

    def pitch(self, name: str, teeth: int, basis: InspectionBasis | None) -> MeasuredPitch:
        """Return the measured or drawn pitch deviations of a member with `teeth` teeth.

        `basis`: inspection basis of the member. Raises FileError and DesignError that name the key.
        """
        keys, given = self._keys(name), self._values(name)
        file, lists = given[keys.pitch_file], dict[str, Array]()
        self._refuse_together(keys, given)
        if given[keys.drawn_class] is not None or given[keys.drawn_seed] is not None:
            return self._draw(keys, teeth, basis)
        for key in keys.lists:
            values = given[key]
            if values is None:
                continue
            if len(values) != teeth:
                raise DesignError(f"measured.{key}", f"{len(values)} values", must_be=f"{teeth} values, one a tooth")
            lists[key] = MM_PER_UM * np.array(values)
        if file is not None:
            return read_pitch(Path(file), teeth)
        found = {side: lists.get(keys.deviations(side)) for side in Side}
        sides = {side: PitchDeviations(values) for side, values in found.items() if values is not None}
        return MeasuredPitch(sides, lists.get(keys.runout))

    @staticmethod
    def _refuse_together(keys: MeasuredMember, values: dict[str, Any]) -> None:
        """Raise DesignError if the positions of teeth are given in two ways."""
        ways = ((keys.pitch_file,), keys.lists, (keys.drawn_class, keys.drawn_seed))
        first_keys = [next((key for key in way if values[key] is not None), None) for way in ways]
        given = [key for key in first_keys if key is not None]
        if len(given) > 1:
            raise DesignError(f"measured.{given[1]}", reason=f"cannot be given together with measured.{given[0]}")

    def _draw(self, keys: MeasuredMember, teeth: int, basis: InspectionBasis | None) -> MeasuredPitch:
        """Draw a gear of the class that the table gives, or of the class that the design asks for."""
        tolerance_class, seed = getattr(self._table, keys.drawn_class), getattr(self._table, keys.drawn_seed)
        if basis is None:
            raise DesignError(
                f"measured.{keys.drawn_class if tolerance_class is not None else keys.drawn_seed}",
                reason=f"pitch deviations of the {keys.name} have no tolerances",
                allowed="cylindrical and bevel gears",
            )
        finest, coarsest = basis.sizes.classes
        tolerance_class = basis.asked if tolerance_class is None else tolerance_class
        if not finest <= tolerance_class <= coarsest:
            raise DesignError(
                f"measured.{keys.drawn_class}", tolerance_class, must_be=f"a whole number from {finest} to {coarsest}"
            )
        # members with the same seed differ by their name
        return MeasuredPitch(drawn_pitch(basis, teeth, tolerance_class, (seed or 0, crc32(keys.name.encode()))))

    def of_member(self, member: Member, basis_of: BasisOf) -> Member:
        """Return the member with its teeth at their measured positions, or the member itself without any.

        Deviations are arcs of the circle that the system measures them on, or of the circle through the middle of the
        flanks. Raises the errors of `pitch`.
        """
        if not self.says(member.name):
            return member
        tooth, basis = member.tooth, basis_of(member.name)
        of_runout = f"measured.{self._keys(member.name).runout}"
        pitch = self.pitch(member.name, tooth.teeth, basis).complete(None if basis is None else basis.ball, of_runout)
        index = index_angles(pitch, pitch_radius(tooth, basis))
        away = self.farther_out(member.name, tooth.teeth)
        index = index if away is None else replace(index, outwards=tuple(away.tolist()))
        # teeth that a kind has turned keep their rotation
        return replace(member, index=member.index.beside(index, tooth.teeth) if any(member.index.right) else index)
