"""Design of one spur or helical gear without a mating gear [ISO 21771]: keys that need no mating gear."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.design import keys
from gearmesh.design.core import UnloadedElementTable
from gearmesh.design.keys import conflict
from gearmesh.design.measured import PairMeasured
from gearmesh.member_names import MemberNames
from gearmesh.systems.cylindrical.design import CylindricalKeys, CylindricalMember, HalvesKeys

#: tables of a pair; a single gear has one of them
MEMBER_TABLES = ("pinion", "gear")
#: reason why a key needs a mating gear
ALONE_REASON = "needs a mating gear: give both tables, [pinion] and [gear]"


def is_single(keys: Mapping[str, Any]) -> bool:
    """True if the keys of a design of kind cylindrical have the table of only one gear."""
    return sum(name in keys for name in MEMBER_TABLES) == 1


class SingleGearDesign(HalvesKeys, CylindricalKeys):
    """One spur or helical gear, external or internal, without a mating gear: the table pinion or the table gear."""

    own_kind: ClassVar[str] = "cylindrical"
    absent: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("assembly", "contact", "backlash", "circumferential_backlash", "shift_sharing"), ALONE_REASON
    )
    example: ClassVar[Mapping[str, Any]] = {"module": 1, "gear": {"teeth": 30, "face_width": 10}}
    about: ClassVar[str] = "one spur or helical gear, external or internal, without a mating gear [ISO 21771]"

    hand: str = keys.choice("hand of the gear's helix", ("right", "left"), "right")
    fe: UnloadedElementTable = UnloadedElementTable()
    pinion: CylindricalMember | None = None
    gear: CylindricalMember | None = None
    measured: PairMeasured | None = None

    @model_validator(mode="after")
    def _one_gear(self) -> Self:
        if len(self.specs) != 1:
            raise conflict("gear", None, reason="a single gear is given by one of the tables [pinion] and [gear]")
        return self

    @property
    def member_name(self) -> str:
        """Name of the gear: the name of its table."""
        return next(iter(self.specs))

    @property
    def member_names(self) -> MemberNames:
        """The gear, and the member that it lacks."""
        name = self.member_name
        return MemberNames(unpaired=(name,), lacking=next(other for other in MEMBER_TABLES if other != name))

    @property
    def spec(self) -> CylindricalMember:
        """Table of the gear."""
        spec: CylindricalMember = self.specs[self.member_name]
        return spec

    @property
    def counted_teeth(self) -> int:
        return self.spec.teeth
