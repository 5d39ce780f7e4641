"""Design of a pinion and a rack: a spur or helical gear, and a bar on whose teeth it rolls [ISO 21771, ISO 53]."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.allowed import Allowed
from gearmesh.design import keys
from gearmesh.design.core import (
    BODY_TABLES,
    BrokenEdges,
    FlankContact,
    FlankStock,
    MemberMaterial,
    MemberMount,
    UnloadedElementTable,
)
from gearmesh.design.keys import DERIVED_VALUE, Table, conflict
from gearmesh.design.measured import RackMeasured
from gearmesh.design.modifications import Modified
from gearmesh.design.runout import PinionRunout
from gearmesh.member_names import MemberNames
from gearmesh.systems.common.pressure_angles import CoastSide
from gearmesh.systems.cylindrical.allowance_keys import ThicknessAllowance, thickness_made_key
from gearmesh.systems.cylindrical.design import CylindricalMember, HalvesKeys, accuracy_class_key
from gearmesh.systems.kinds import OWN_KINDS

#: name of the pinion's table in a design
PINION_NAME = "pinion"
#: name of the rack's table in a design
RACK_NAME = "rack"
#: part of a pitch by which a bar may be too short for its teeth: rounding
LENGTH_ROUNDING = 1e-9


class BoltRow(Table):
    """Bolt holes across the bar, evenly spaced along it, the row in its middle."""

    listed_apart: ClassVar[str] = "bolt holes of the rack"

    count: int = keys.count("number of holes", low=1, high=1000)
    diameter: float = keys.length("diameter of each hole", above=0)
    pitch: float | None = keys.length(
        "distance from one hole to the next", None, above=0, default="length of the bar over their number"
    )
    height: float | None = keys.length(
        "height of their centres over the back", None, above=0, default="half way from back to root"
    )
    depth: float | None = keys.length(
        "depth of blind holes, from the heel's face; without it they go through", None, above=0
    )


class BarKeys(CoastSide, Modified):
    """Keys of a bar with teeth, as many pitches long as it has teeth, or longer."""

    usual: ClassVar[tuple[str, ...]] = ("teeth", "height")

    teeth: int | None = keys.count(
        "number of teeth", None, low=1, high=10000, default="as many as the length has room for"
    )
    length: float | None = keys.length(
        "length of the bar; beyond the teeth, half at either end, it is as high as the root",
        None,
        above=0,
        default="number of teeth times pitch",
    )
    face_width: float = keys.length("width of the bar, across its length", above=0)
    height: float = keys.length(
        "height of the bar from its back to the tips", DERIVED_VALUE, above=0, default="the teeth and 3 modules"
    )
    addendum: float = keys.coefficient(
        "tip above the reference plane", DERIVED_VALUE, low=0, high=5, default="by profile", source="ISO 53"
    )
    dedendum: float = keys.coefficient(
        "root below the reference plane", DERIVED_VALUE, low=0, high=5, default="by profile", source="ISO 53"
    )
    tool_tip_radius: float = keys.coefficient(
        "radius of the root fillets; 0 = sharp corner",
        DERIVED_VALUE,
        low=0,
        high=2,
        default="by profile, or what the space has room for",
        source="ISO 53",
    )

    @model_validator(mode="after")
    def _some_length(self) -> Self:
        if self.teeth is None and self.length is None:
            raise conflict("teeth", None, reason="missing; give teeth or length")
        return self


class RackTable(FlankStock, BrokenEdges, BarKeys):
    """The rack."""

    rank: ClassVar[int] = 0
    absent: ClassVar[Mapping[str, str]] = dict.fromkeys(
        (table for table in BODY_TABLES if table != "bolts"),
        "a rack is a bar: it has no hub, shaft or bore, only bolts",
    )

    #: Key of the floor of the gap between both halves.
    gap_key: ClassVar[str] = "gap_height"

    gap_height: float | None = keys.length(
        "height over the back of the floor of the gap between the halves of a double helical rack",
        None,
        above=0,
        default="a quarter of a module below the root",
    )
    bolts: BoltRow | None = None
    thickness_allowance: ThicknessAllowance | None = None
    thickness_made: str = thickness_made_key()
    material: MemberMaterial | None = None
    mount: MemberMount | None = None

    #: The dedendum always gives the root.
    dedendum_counts: ClassVar[bool] = True

    @property
    def thickness_key(self) -> str | None:
        """Key that gives the thickness; None if no key does."""
        return None if self.thickness_allowance is None else "thickness_allowance"


class RackAssembly(PinionRunout):
    """Mounting of pinion and rack."""

    mounting_distance: float | None = keys.length(
        "distance of the pinion's axis from the back of the bar",
        None,
        above=0,
        default="nominal teeth mesh without backlash",
    )
    dx: float = keys.length("offset of the rack along x, away from the pinion's axis", 0.0)
    dz: float = keys.length("offset of the rack along the pinion's axis", 0.0)
    gamma_h: float = keys.angle("misalignment of the rack and its guide about x", 0.0, low=-10, high=10)
    gamma_v: float = keys.angle("misalignment of the rack and its guide about y", 0.0, low=-10, high=10)


class RackKeys(HalvesKeys):
    """Keys of the designs of racks, with and without a pinion."""

    own_kind: ClassVar[str] = "rack"
    toothed: ClassVar[tuple[str, ...]] = (PINION_NAME, RACK_NAME)

    pinion: CylindricalMember | None = None
    rack: RackTable
    measured: RackMeasured | None = None

    @model_validator(mode="after")
    def _long_enough(self) -> Self:
        if self.rack.length is not None:
            teeth = self.rack.teeth or 1
            if self.rack.length < teeth * self.pitch * (1.0 - LENGTH_ROUNDING):
                raise conflict(
                    "rack.length",
                    self.rack.length,
                    must_be=Allowed.at_least(
                        teeth * self.pitch,
                        self.units,
                        note=f", the length of {teeth} {'tooth' if teeth == 1 else 'teeth'}",
                    ),
                )
        return self

    @property
    def _tooth_numbers(self) -> tuple[int, ...]:
        return (*super()._tooth_numbers, self.rack_teeth)

    @property
    def pitch(self) -> float:
        """Transverse pitch, along the rack, in the design's units."""
        return math.pi * self.given_module / math.cos(math.radians(self.helix_angle))

    @property
    def rack_teeth(self) -> int:
        """Number of teeth of the rack: given, or as many as its length has room for."""
        if self.rack.teeth is not None:
            return self.rack.teeth
        assert self.rack.length is not None
        return math.floor(self.rack.length / self.pitch * (1.0 + LENGTH_ROUNDING))

    @property
    def overhang(self) -> float:
        """Length of the bar beyond the last pitch, at either end, in the design's units."""
        if self.rack.length is None:
            return 0.0
        beyond = 0.5 * (self.rack.length - self.rack_teeth * self.pitch)
        return beyond if beyond > LENGTH_ROUNDING * self.pitch else 0.0


class RackDesign(RackKeys):
    """A pinion and a rack of finite length."""

    example: ClassVar[Mapping[str, Any]] = {
        "module": 2,
        "pinion": {"teeth": 20, "face_width": 20},
        "rack": {"teeth": 40, "face_width": 20},
    }
    about: ClassVar[str] = OWN_KINDS["rack"].about
    called: ClassVar[str] = "Pinion and rack"

    pinion: CylindricalMember
    accuracy_class: int = accuracy_class_key()
    assembly: RackAssembly = RackAssembly()
    contact: FlankContact = FlankContact()

    @model_validator(mode="after")
    def _sound_members(self) -> Self:
        self.with_allowances()
        if self.pinion.internal:
            raise conflict("pinion.internal", True, reason="the pinion of a rack is external")
        self._refuse_uneven_load(self.assembly)
        return self

    @property
    def member_names(self) -> MemberNames:
        """Pinion and rack, which mesh."""
        return MemberNames(((PINION_NAME, RACK_NAME),))


def is_single_rack(keys: Mapping[str, Any]) -> bool:
    """True if the keys of a design of kind rack have no table of a pinion."""
    return RACK_NAME in keys and PINION_NAME not in keys


class SingleRackDesign(RackKeys):
    """A rack of finite length without a pinion."""

    absent: ClassVar[Mapping[str, str]] = dict.fromkeys(
        (PINION_NAME, "accuracy_class", "assembly", "contact", "backlash", "circumferential_backlash"),
        "needs a pinion: give both tables, [pinion] and [rack]",
    )
    example: ClassVar[Mapping[str, Any]] = {"module": 2, "rack": {"teeth": 40, "face_width": 20}}
    about: ClassVar[str] = "a rack of finite length without a pinion, spur or helical [ISO 21771]"
    called: ClassVar[str] = "Rack"

    hand: str = keys.choice("hand of the traces, as of a gear that they are on", ("right", "left"), "right")

    fe: UnloadedElementTable = UnloadedElementTable()

    @property
    def member_names(self) -> MemberNames:
        """The rack, which lacks a pinion."""
        return MemberNames(unpaired=(RACK_NAME,), lacking=PINION_NAME)

    @property
    def counted_teeth(self) -> int:
        return self.rack_teeth

    def _series_diameter(self, name: str) -> float:
        given = self.rack.thickness_allowance
        raise conflict(
            f"{name}.thickness_allowance.series",
            None if given is None else given.series,
            reason="goes by a reference diameter, which a rack without a pinion has not",
            allowed="upper and lower instead",
        )
