"""Design of a pair of straight bevel gears: basic data, proportions and taper give the blank [ISO 23509]."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.design import keys
from gearmesh.design.core import FlankContact
from gearmesh.design.keys import Table, conflict
from gearmesh.systems.common.bevel.design import BACKLASH_KEYS, BevelMember, ProportionedDesign
from gearmesh.systems.kinds import OWN_KINDS

#: forms of the flanks: of straight cutting edges on a crown gear, and of a great circle rolling on a base cone
FORM_NAMES = ("octoid", "spherical_involute")


class DiscTable(Table):
    """Disc cutters, one for each side of a space: they crown the teeth lengthwise."""

    radius: float | None = keys.length(
        "radius of the discs where edge and land meet", None, above=0, default="6 face widths"
    )
    dish_angle: float = keys.angle(
        "angle between the cutting edges and the plane of the disc; 0 leaves the flank uncrowned", 3.0, low=0, high=30
    )


class StraightBevelMember(BevelMember):
    """One member."""

    disc: DiscTable | None = None
    edge_radius: float | None = keys.length(
        "rounding of the tool's tip: generates the fillet",
        None,
        low=0,
        default="0.2 mean normal modules or what fits",
    )


class StraightBevelDesign(ProportionedDesign):
    """A pair of straight bevel gears."""

    own_kind: ClassVar[str] = "straight_bevel"
    usual: ClassVar[tuple[str, ...]] = ("form", "taper")
    example: ClassVar[Mapping[str, Any]] = {"module": 3, "pinion": {"teeth": 16}, "gear": {"teeth": 32}}
    about: ClassVar[str] = OWN_KINDS["straight_bevel"].about
    called: ClassVar[str] = "Straight bevel gears"

    form: str = keys.choice(
        "flanks: octoid, cut by straight edges on a crown gear, or spherical_involute, as forged",
        FORM_NAMES,
        "octoid",
    )
    pressure_angle: float = keys.angle("pressure angle at the pitch plane of the crown gear", 20.0, low=10, high=35)
    depth_factor: float | None = keys.number(
        "mean working depth, mean normal modules",
        None,
        low=0.5,
        high=3,
        default="k_d by pinion teeth",
        source="ISO 23509",
    )
    addendum_factor: float | None = keys.number(
        "gear's mean addendum over working depth", None, low=0, high=1, default="c_ham by ratio", source="ISO 23509"
    )
    contact: FlankContact = FlankContact()
    pinion: StraightBevelMember
    gear: StraightBevelMember

    @model_validator(mode="after")
    def _octoids(self) -> Self:
        for name in ("pinion", "gear"):
            if getattr(self, name).disc is not None and self.form != "octoid":
                raise conflict(
                    f"{name}.disc", None, reason=f'discs cut no flanks of form = "{self.form}"; leave it out'
                )
        return self

    def derived_values(self) -> dict[str, float]:
        return {**super().derived_values(), "backlash": self.suggested_backlash}

    def stays(self, dotted: str, values: Mapping[str, Any]) -> bool:
        return dotted != "backlash" or not BACKLASH_KEYS & values.keys()
