"""Design of a beveloid pair [LT02]: rack-generated involute gears, tapered by a cone angle or not.

With cone angles 0 these are the ordinary spur and helical gears.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.design.core import FlankContact, MemberTable, PairDesign, TurnedTip
from gearmesh.design.keys import DERIVED_VALUE, Key, conflict
from gearmesh.design.modifications import Modified
from gearmesh.design.runout import PairRunout
from gearmesh.systems.common.defaults import straight_rounding
from gearmesh.systems.kinds import OWN_KINDS

#: angles (deg) closer than this to parallel axes are parallel
PARALLEL_TOLERANCE_DEG = 1e-9
#: default rounding of the rack's tip, in normal modules, if there is room for it [ISO 53]
STANDARD_TIP_RADIUS = 0.38


class BeveloidMember(TurnedTip, MemberTable, Modified):
    """One gear of a beveloid pair; flanks may be modified where its cone angle is 0."""

    replaces: ClassVar = (("tip_diameter", "addendum"), ("root_diameter", "dedendum"))

    teeth: Annotated[int, Key("count", "number of teeth; one is a thread", low=1, high=10000)]
    cone_angle: Annotated[
        float, Key("angle", "cone angle delta of the pitch plane", low=-60, high=60, source="[LT02] Fig. 2")
    ] = 0.0
    helix_angle: Annotated[
        float, Key("angle", "helix angle beta, positive right-handed", low=-88, high=88, source="[LT02] Fig. 2")
    ] = 0.0
    profile_shift: Annotated[float, Key("coefficient", "profile shift at mid face", low=-5, high=5)] = 0.0
    addendum: Annotated[
        float, Key("coefficient", "tip above the shifted pitch plane", low=0, high=5, source="ISO 53")
    ] = 1.0
    dedendum: Annotated[
        float, Key("coefficient", "root below the shifted pitch plane", low=0, high=5, source="ISO 53")
    ] = 1.25
    tip_cone_angle: Annotated[
        float | None,
        Key(
            "angle",
            "angle of a conical tip to the axis, positive where it widens along z; the tip diameter is that at mid face",
            low=-60,
            high=60,
            default="cone_angle",
        ),
    ] = None
    tip_diameter: Annotated[
        float | None,
        Key("length", "tip diameter at mid face, instead of addendum", low=0, above=True, default="from addendum"),
    ] = None
    root_diameter: Annotated[
        float | None,
        Key("length", "root diameter at mid face, instead of dedendum", low=0, above=True, default="from dedendum"),
    ] = None
    tool_tip_radius: Annotated[
        float,
        Key(
            "coefficient",
            "tip rounding of the rack; 0 = sharp edge",
            low=0,
            high=2,
            default="0.38, or 90 % of what the rack's tooth has room for",
            source="ISO 53",
        ),
    ] = DERIVED_VALUE

    @model_validator(mode="after")
    def _cylindrical(self) -> Self:
        if self.modified and self.cone_angle:
            raise conflict("cone_angle", self.cone_angle, must_be="0 where modifications are given")
        return self

    @model_validator(mode="after")
    def _tip_above_root(self) -> Self:
        tip, root = self.tip_diameter, self.root_diameter
        if tip is not None and root is not None and tip <= root:
            raise conflict("tip_diameter", tip, must_be=f"larger than root_diameter, {root:g}")
        return self


#: text about the keys that determine the shaft angle
SHAFT_ANGLE_NOTE = (
    "the cone and helix angles of the members give it: without cones it is pinion.helix_angle + gear.helix_angle, without helices "
    "pinion.cone_angle + gear.cone_angle; the data sheet (gearmesh describe DESIGN) has it"
)


class BeveloidAssembly(PairRunout):
    """Position of the gear against its nominal one: assembly errors."""

    absent: ClassVar[Mapping[str, str]] = {"shaft_angle": SHAFT_ANGLE_NOTE}

    dx: Annotated[float, Key("length", "offset of the gear along x_g", source="[LT02] 5")] = 0.0
    dy: Annotated[float, Key("length", "offset of the gear along y_g", source="[LT02] 5")] = 0.0
    dz: Annotated[float, Key("length", "offset of the gear along its axis", source="[LT02] 5")] = 0.0
    gamma_h: Annotated[
        float, Key("angle", "horizontal misalignment of the gear axis", low=-10, high=10, source="[LT02] 5")
    ] = 0.0
    gamma_v: Annotated[
        float, Key("angle", "vertical misalignment of the gear axis", low=-10, high=10, source="[LT02] 5")
    ] = 0.0
    turned_over: Annotated[
        bool, Key("flag", "gear turned over, its heel at the pinion's toe (Gamma = pi)", source="[LT02] 5.3")
    ] = False
    center_distance: Annotated[
        float | None,
        Key("length", "distance of parallel axes", low=0, above=True, default="the gears mesh with the given backlash"),
    ] = None


class BeveloidDesign(PairDesign):
    """A beveloid pair on intersected, crossed or parallel axes."""

    own_kind: ClassVar[str] = "beveloid"
    example: ClassVar[Mapping[str, Any]] = {
        "module": 2,
        "pinion": {"teeth": 18, "face_width": 20},
        "gear": {"teeth": 45, "face_width": 20},
    }
    about: ClassVar[str] = OWN_KINDS["beveloid"].about
    called: ClassVar[str] = "Beveloid gears"
    absent: ClassVar[Mapping[str, str]] = {
        "shaft_angle": SHAFT_ANGLE_NOTE,
    }

    pressure_angle: Annotated[
        float, Key("angle", "normal pressure angle of the rack", low=1, high=45, source="[LT02] Table 1")
    ] = 20.0
    pinion: BeveloidMember
    gear: BeveloidMember
    assembly: BeveloidAssembly = BeveloidAssembly()
    contact: FlankContact = FlankContact()

    def derived_values(self) -> dict[str, float]:
        """Return the tip roundings of the racks that the file leaves out; see the key's default.

        Returns
        -------
        dict of str to float
            By dotted key, in the file's units.

        Examples
        --------
        >>> sorted(gm.load("samples/beveloid_crossed.toml", complete=False).derived_values())[:2]
        ['contact.delta', 'contact.phi1.start']
        """
        return {
            **super().derived_values(),
            **{f"{name}.tool_tip_radius": self._rounding(getattr(self, name)) for name in ("pinion", "gear")},
        }

    def _rounding(self, member: BeveloidMember) -> float:
        """Return the default tip rounding of a member's rack, normal modules."""
        m, alpha = self.given_module, math.radians(self.pressure_angle)
        depth = member.dedendum
        if member.root_diameter is not None:
            radius = 0.5 * member.teeth * m / math.cos(math.radians(member.helix_angle))
            below = (radius - 0.5 * member.root_diameter) * math.cos(math.radians(member.cone_angle))
            depth = member.profile_shift + below / m
        # each flank of the pair is set back by a quarter of the backlash
        width = 0.5 * math.pi + 0.5 * self.backlash / m / math.cos(alpha)
        return straight_rounding(width, depth, (self.pressure_angle, self.pressure_angle), STANDARD_TIP_RADIUS)

    @property
    def parallel(self) -> bool:
        """True if the nominal axes are parallel [LT02 3]: opposite helices, and cone angles that cancel."""
        cones = self.pinion.cone_angle + (-1 if self.assembly.turned_over else 1) * self.gear.cone_angle
        helices = self.pinion.helix_angle + self.gear.helix_angle
        return math.hypot(cones, helices) < PARALLEL_TOLERANCE_DEG

    @model_validator(mode="after")
    def _center_distance_of_parallel_axes(self) -> Self:
        distance = self.assembly.center_distance
        if distance is not None and not self.parallel:
            raise conflict(
                "assembly.center_distance",
                distance,
                reason="only parallel axes have one (helix angles opposite; cone angles opposite, or equal with "
                "turned_over)",
            )
        return self
