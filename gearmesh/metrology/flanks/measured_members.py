"""Members with the flanks and at the places that were measured of their teeth, as the table `measured` of a design has them."""

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
        return any(value is not None for value in self._values(name).values())

    def _values(self, name: str) -> dict[str, Any]:
        own = self._named(name)
        return {key: getattr(self._table, key, None) for key in (_file_key(own), *_list_keys(own), *_drawn_keys(own))}

    def pitch(self, name: str, teeth: int, basis: InspectionBasis | None) -> MeasuredPitch:
        """What the design has of a member of so many teeth, inspected by a basis, or what is drawn for it.

        Raises FileError and DesignError naming the key.
        """
        own, given = self._named(name), self._values(name)
        file, lists = given[_file_key(own)], dict[str, Array]()
        self._refuse_together(own, given)
        if any(given[key] is not None for key in _drawn_keys(own)):
            return self._draw(own, teeth, basis)
        for key in _list_keys(own):
            values = given[key]
            if values is None:
                continue
            if len(values) != teeth:
                raise DesignError(f"measured.{key}", f"{len(values)} values", must_be=f"{teeth} values, one a tooth")
            lists[key] = UM * np.array(values)
        if file is not None:
            return read_pitch(Path(file), teeth)
        *of_sides, of_runout = _list_keys(own)
        sides = {side: PitchDeviations(lists[key]) for side, key in zip(Side, of_sides, strict=True) if key in lists}
        return MeasuredPitch(sides, lists.get(of_runout))

    @staticmethod
    def _refuse_together(own: str, given: dict[str, Any]) -> None:
        """Raise DesignError where the places of teeth are given in two ways."""
        ways = ([_file_key(own)], _list_keys(own), _drawn_keys(own))
        keys = [key for way in ways for key in [next((key for key in way if given[key] is not None), None)] if key]
        if len(keys) > 1:
            raise DesignError(f"measured.{keys[1]}", reason=f"cannot be given together with measured.{keys[0]}")

    def _draw(self, own: str, teeth: int, basis: InspectionBasis | None) -> MeasuredPitch:
        """A gear of the class that the design names, or asks for."""
        of_class, of_seed = _drawn_keys(own)
        wanted, seed = getattr(self._table, of_class), getattr(self._table, of_seed)
        if basis is None:
            raise DesignError(
                f"measured.{of_class if wanted is not None else of_seed}",
                reason=f"pitch deviations of the {own} have no tolerances",
                allowed="cylindrical and bevel gears",
            )
        finest, coarsest = basis.sizes.classes
        wanted = basis.asked if wanted is None else wanted
        if not finest <= wanted <= coarsest:
            raise DesignError(f"measured.{of_class}", wanted, must_be=f"a whole number from {finest} to {coarsest}")
        # members that are drawn by the same number differ
        return MeasuredPitch(drawn_pitch(basis, teeth, wanted, (seed or 0, crc32(own.encode()))))

    def of_member(self, member: Member, basis_of: BasisOf) -> Member:
        """The member with its teeth where they were measured; itself, where the design has none.

        Deviations are arcs of the circle that its system measures them on, or of that through the middle of its flanks. Raises as
        `pitch`.
        """
        if not self.says(member.name):
            return member
        tooth, basis = member.tooth, basis_of(member.name)
        of_runout = f"measured.{_list_keys(self._named(member.name))[-1]}"
        pitch = self.pitch(member.name, tooth.teeth, basis).complete(None if basis is None else basis.ball, of_runout)
        return replace(member, index=index_angles(pitch, pitch_radius(tooth, basis)))


def _file_key(member: str) -> str:
    return f"{member}_pitch"


def _drawn_keys(member: str) -> tuple[str, str]:
    return f"{member}_pitch_class", f"{member}_pitch_seed"


def _list_keys(member: str) -> tuple[str, ...]:
    return (*(f"{member}_pitch_{side}_um" for side in Side), f"{member}_runout_um")
