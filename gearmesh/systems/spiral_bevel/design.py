"""Design of a spiral bevel pair: basic data are enough, every derived value can be given instead [AB; ISO 23509].

Straight and zerol bevel gears are the same kind at spiral angle 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from gearmesh.design.core import ContactTable, GearBody, PairDesign
from gearmesh.design.keys import DERIVED, Key, Table, given_or

_SYNTHESIS = "derived: see gearmesh settings"

#: The key `edge_radius` of any head cutter.
EdgeRadius = Annotated[
    float | None,
    Key(
        "length",
        "rounding of the blade tip: generates the fillet",
        low=0,
        default="0.2 mean normal modules or what fits",
    ),
]


class Machine(Table):
    """Machine and cutter settings that every side has."""

    radial: Annotated[
        float | None, Key("length", "radial setting S", low=0, above=True, default=_SYNTHESIS, source="[AB] (6), (53)")
    ] = None
    cradle_angle: Annotated[
        float | None, Key("angle", "cradle angle q", low=-180, high=180, default=_SYNTHESIS, source="[AB] (7), (53)")
    ] = None
    ratio_of_roll: Annotated[
        float | None,
        Key("number", "cradle over blank", low=0, high=10, above=True, default=_SYNTHESIS, source="[AB] (4), (50)"),
    ] = None
    machining_offset: Annotated[
        float | None,
        Key("length", "blank offset, > 0 away from the cutter's centre", default=_SYNTHESIS, source="[AB] (51)"),
    ] = None
    machine_centre_to_back: Annotated[
        float | None,
        Key("length", "machine centre beyond the apex, along the root line", default=_SYNTHESIS, source="[AB] (52)"),
    ] = None
    sliding_base: Annotated[float, Key("length", "blank withdrawn along the cradle axis", source="[AB] Fig. 4")] = 0.0
    machine_root_angle: Annotated[
        float | None, Key("angle", "angle of blank axis and machine plane", low=0, high=90, default="root angle")
    ] = None
    modified_roll_c2: Annotated[
        float, Key("number", "blank turns (q - c2 q^2 - c3 q^3 ...) / ratio", low=-1, high=1)
    ] = 0.0
    modified_roll_c3: Annotated[float, Key("number", "modified roll, third order", low=-1, high=1)] = 0.0
    modified_roll_c4: Annotated[float, Key("number", "modified roll, fourth order", low=-1, high=1)] = 0.0
    modified_roll_c5: Annotated[float, Key("number", "modified roll, fifth order", low=-1, high=1)] = 0.0
    blade_angle: Annotated[
        float | None,
        Key("angle", "between blade and cutter axis", low=0, high=60, above=True, default=_SYNTHESIS, source="[AB]"),
    ] = None
    blade_radius: Annotated[
        float, Key("length", "radius of a circular-arc blade, > 0 convex; 0 = straight blade", source="[AB] Table 4")
    ] = 0.0
    blade_height: Annotated[
        float | None,
        Key("length", "height over the tip where blade_angle holds (circular-arc blade)", low=0, default="mean point"),
    ] = None
    edge_radius: EdgeRadius = None


class PinionSide(Machine):
    """One side of the pinion: the contact asked for, and the settings that give it or are given instead."""

    sliding_base: Annotated[
        float,
        Key(
            "length",
            "blank withdrawn along the cradle axis",
            default="that of the other side, or 0",
            source="[AB] Fig. 4",
        ),
    ] = DERIVED
    tip_radius: Annotated[
        float | None, Key("length", "cutter radius at the tip", low=0, above=True, default=_SYNTHESIS, source="[AB]")
    ] = None
    te_at_change: Annotated[
        float,
        Key("number", "TE (arcsec) of the gear at the change of teeth, as a lag", low=-3600, high=3600, default="10"),
    ] = 10.0
    ratio_derivative: Annotated[
        float | None,
        Key(
            "number",
            "(d2 phi2/d phi1^2)/(N1/N2) at the mean point, instead of te_at_change",
            low=-1,
            high=1,
            default="from te_at_change",
            source="[AB] Table 2",
        ),
    ] = None
    path_angle: Annotated[
        float,
        Key(
            "angle",
            "path of contact on the gear, from its lengthwise principal direction (to the toe) towards its root",
            low=-180,
            high=180,
            source="[AB] Table 2",
        ),
    ] = 90.0
    semi_major_axis: Annotated[
        float | None,
        Key(
            "length",
            "of the ellipse at the mean point",
            low=0,
            above=True,
            default="face_width / 4, more on a narrow face",
            source="[AB]",
        ),
    ] = None
    mean_offset: Annotated[
        float,
        Key("length", "mean point farther from the gear's root than the middle of the working depth", source="[AB]"),
    ] = 0.0


class GearCutter(Machine):
    """The gear's spread-blade cutter: both sides in one cut."""

    tip_radius: Annotated[
        float | None,
        Key(
            "length", "mean of inside and outside tip radius", low=0, above=True, default="ISO 23509", source="[AB] (5)"
        ),
    ] = None
    point_width: Annotated[
        float | None,
        Key("length", "outside less inside tip radius", low=0, default="by the tooth thickness", source="[AB] (5)"),
    ] = None


class BevelMember(GearBody):
    """What both members have."""

    root_angle: Annotated[
        float | None,
        Key("angle", "root cone", low=0, high=90, above=True, default="standard taper", source="ISO 23509"),
    ] = None
    face_angle: Annotated[
        float | None,
        Key(
            "angle",
            "tip cone, about the tip at the mean",
            low=0,
            high=89.5,
            above=True,
            default="parallel to the mate's root",
        ),
    ] = None


class BevelPinion(BevelMember):
    """The pinion, each side by settings of its own."""

    concave: PinionSide = PinionSide()
    convex: PinionSide = PinionSide()

    def side(self, name: str) -> PinionSide:
        """The side "concave" or "convex"."""
        return self.concave if name == "concave" else self.convex


class BevelGear(BevelMember):
    """The gear."""

    cutter: GearCutter = GearCutter()


class BevelAssembly(Table):
    """How the members stand beside their nominal places."""

    dA: Annotated[
        float, Key("length", "pinion moved along its axis, away from the apex", source="[AB]; [CR3553] 3.5")
    ] = 0.0
    dG: Annotated[float, Key("length", "gear moved along its axis, away from the apex", source="[CR3553] 3.5")] = 0.0
    dV: Annotated[float, Key("length", "pinion axis offset (dE), along y", source="[AB]; [CR3553] 3.5")] = 0.0
    d_delta: Annotated[float, Key("angle", "shaft angle opened", low=-5, high=5, source="[CR3553] 3.5")] = 0.0
    pinion_eccentricity: Annotated[
        float, Key("length", "teeth off the pinion's axis of rotation", low=0, high=1, source="[CR3553] 3.4")
    ] = 0.0
    pinion_phase: Annotated[float, Key("angle", "its direction, from the tooth on x", low=-360, high=360)] = 0.0
    gear_eccentricity: Annotated[
        float, Key("length", "teeth off the gear's axis of rotation", low=0, high=1, source="[CR3553] 3.4")
    ] = 0.0
    gear_phase: Annotated[float, Key("angle", "its direction, from the tooth on x", low=-360, high=360)] = 0.0


class BevelContact(ContactTable):
    """Contact, on one of the pinion's sides."""

    side: Annotated[
        str, Key("choice", "side of the pinion that drives", choices=("pinion_concave", "pinion_convex"))
    ] = "pinion_concave"

    @property
    def pinion_side(self) -> str:
        """The pinion's side by its name alone."""
        return self.side.removeprefix("pinion_")


class BevelDesign(PairDesign):
    """What all pairs of bevel gears have."""

    module: Annotated[
        float | None, Key("length", "outer transverse module", low=0, above=True, default="given by diametral_pitch")
    ] = None
    diametral_pitch: Annotated[
        float | None,
        Key(
            "pitch",
            "outer transverse diametral pitch, per inch in any units",
            low=0,
            above=True,
            default="given by module",
        ),
    ] = None
    shaft_angle: Annotated[float, Key("angle", "shaft angle", low=10, high=170, source="ISO 23509")] = 90.0
    hand: Annotated[str, Key("choice", "hand of spiral of the pinion", choices=("right", "left"))] = "left"
    face_width: Annotated[
        float | None,
        Key("length", "along the pitch cone", low=0, above=True, default="0.3 outer cone distance, at most 10 m"),
    ] = None
    assembly: BevelAssembly = BevelAssembly()
    contact: BevelContact = BevelContact()


class SpiralBevelDesign(BevelDesign):
    """A spiral bevel pair cut by head cutters."""

    own_kind: ClassVar[str] = "spiral_bevel"
    example: ClassVar[Mapping[str, Any]] = {"module": 5, "pinion": {"teeth": 13}, "gear": {"teeth": 44}}
    about: ClassVar[str] = "spiral, zerol and straight bevel gears cut by head cutters on a cradle [AB; ISO 23509]"

    spiral_angle: Annotated[float, Key("angle", "mean spiral angle", low=0, high=50, source="ISO 23509")] = 35.0
    pressure_angle: Annotated[
        float, Key("angle", "nominal pressure angle: blade angle of the gear", low=10, high=30)
    ] = 20.0
    mean_cone_distance: Annotated[
        float | None, Key("length", "of the mean point", low=0, above=True, default="outer less half the face width")
    ] = None
    mean_point: Annotated[
        str,
        Key(
            "choice",
            "where along the face the mean point is: at the mean cone distance, or generated at cradle rotation 0",
            choices=("mean_cone_distance", "cradle_zero"),
            source="[AB]",
        ),
    ] = "mean_cone_distance"
    clearance: Annotated[
        float | None,
        Key("length", "between tip and the mate's root", low=0, above=True, default="0.25 mean normal module"),
    ] = None
    depth_factor: Annotated[
        float | None,
        Key(
            "number",
            "mean working depth, mean normal modules",
            low=0.5,
            high=3,
            default="k_d by pinion teeth",
            source="ISO 23509",
        ),
    ] = None
    addendum_factor: Annotated[
        float | None,
        Key(
            "number",
            "gear's mean addendum over working depth",
            low=0,
            high=1,
            default="c_ham by ratio",
            source="ISO 23509",
        ),
    ] = None
    thickness_factor: Annotated[
        float | None,
        Key(
            "number",
            "pinion thicker by, mean normal modules",
            low=-1,
            high=1,
            default="k_t by teeth",
            source="ISO 23509",
        ),
    ] = None
    pinion: BevelPinion
    gear: BevelGear

    def derived(self) -> dict[str, float]:
        """The sliding bases that the file leaves out: both sides of the pinion are cut to one depth."""
        first, second = self.pinion.concave.sliding_base, self.pinion.convex.sliding_base
        return {
            **super().derived(),
            "pinion.concave.sliding_base": given_or(second, 0.0),
            "pinion.convex.sliding_base": given_or(first, 0.0),
        }
