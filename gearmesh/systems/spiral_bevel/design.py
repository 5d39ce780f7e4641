"""Designs of spiral bevel and hypoid pairs: basic data are enough, every derived value can be given instead [AB; ISO 23509].

Straight and zerol bevel gears are spiral bevel gears at spiral angle 0. A hypoid pair has an offset between its axes; its
blank follows method 1, or of face hobbing also 2 and 3, of ISO 23509.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.design import keys
from gearmesh.design.core import ContactTable, RexsSource
from gearmesh.design.keys import DERIVED_VALUE, Table, conflict, given_or
from gearmesh.design.shown import value_text
from gearmesh.systems.common.bevel.design import (
    BACKLASH_KEYS,
    BevelDesign,
    BevelMember,
    ProportionedDesign,
    edge_radius_key,
)
from gearmesh.systems.kinds import OWN_KINDS

#: default of settings that local synthesis or standard rules derive
_SYNTHESIS_DEFAULT = "derived: see gearmesh settings"

#: largest parameter of an ease-off, mm
MAX_EASE_OFF_MM = 1.0
#: highest order of the polynomials in the cradle's rotation
MAX_MOTION_ORDER = 6
#: description of the tilt
_TILT_TEXT = (
    "tilt i of the cutter's axis, 0 = parallel to the cradle axis; > 0 leans its end in the blank by the swivel"
)
#: description of the thickness
_THICKNESS_TEXT = "mean normal circular thickness s_mn of the tooth as it is cut"
#: description of the coefficients of a motion
_MOTION_TEXT = "by the cradle's rotation q in rad: a1 q + a2 q^2 + ..."


def driving_side_key(side: str) -> Any:
    """Return the key of the driving side of the pinion."""
    return keys.choice("driving side of the pinion", ("pinion_concave", "pinion_convex"), side)


def _blade_angle(default: str, source: str = "") -> Any:
    """Return the key of a blade's angle with a given default."""
    about = "blade angle, between blade and cutter axis"
    return keys.angle(about, None, above=0, high=60, default=default, source=source)


class BladeTable(Table):
    """One blade of a cutter, for keys that differ from the cutter's keys."""

    blade_angle: float | None = _blade_angle("that of the cutter")
    blade_radius: float | None = keys.length(
        "radius of a circular-arc blade, > 0 convex; 0 = straight", None, default="that of the cutter"
    )
    blade_height: float | None = keys.length(
        "height over the tip where blade_angle holds", None, low=0, default="that of the cutter"
    )
    edge_radius: float | None = keys.length("rounding of the blade tip", None, low=0, default="that of the cutter")
    toprem_height: float | None = keys.length(
        "height of the toprem; 0 = none", None, low=0, default="that of the cutter"
    )
    toprem_angle: float | None = keys.angle(
        "between a straight toprem and the cutter axis", None, low=0, high=60, default="that of the cutter"
    )
    toprem_radius: float | None = keys.length(
        "radius of a tangent toprem arc; 0 = straight", None, low=0, default="that of the cutter"
    )


class Machine(Table):
    """Machine and cutter settings of a side."""

    radial: float | None = keys.length(
        "radial setting S", None, above=0, default=_SYNTHESIS_DEFAULT, source="[AB] (6), (53)"
    )
    cradle_angle: float | None = keys.angle(
        "cradle angle q", None, low=-180, high=180, default=_SYNTHESIS_DEFAULT, source="[AB] (7), (53)"
    )
    ratio_of_roll: float | None = keys.number(
        "cradle over blank", None, above=0, high=10, default=_SYNTHESIS_DEFAULT, source="[AB] (4), (50)"
    )
    machining_offset: float | None = keys.length(
        "blank offset E, > 0 towards the side of the cutter's centre",
        None,
        default=_SYNTHESIS_DEFAULT,
        source="[AB] (51)",
    )
    machine_centre_to_back: float | None = keys.length(
        "machine centre beyond the apex, along the root line", None, default=_SYNTHESIS_DEFAULT, source="[AB] (52)"
    )
    sliding_base: float = keys.length("blank withdrawn along the cradle axis", 0.0, source="[AB] Fig. 4")
    machine_root_angle: float | None = keys.angle(
        "angle of blank axis and machine plane", None, low=0, high=90, default="root angle"
    )
    modified_roll_c2: float = keys.number("blank turns (q - c2 q^2 - c3 q^3 ...) / ratio", 0.0, low=-1, high=1)
    modified_roll_c3: float = keys.number("modified roll, third order", 0.0, low=-1, high=1)
    modified_roll_c4: float = keys.number("modified roll, fourth order", 0.0, low=-1, high=1)
    modified_roll_c5: float = keys.number("modified roll, fifth order", 0.0, low=-1, high=1)
    modified_roll_c6: float = keys.number("modified roll, sixth order", 0.0, low=-1, high=1)
    tilt: float = keys.angle(_TILT_TEXT, 0.0, low=-60, high=60, source="[LF04] 21")
    swivel: float = keys.angle(
        "swivel j: direction of the tilt, 0 = towards growing cradle angle, 90 = towards the machine centre",
        0.0,
        low=-360,
        high=360,
        source="[LF04] 21",
    )
    tilt_motion: tuple[float, ...] = keys.angle(f"added to tilt {_MOTION_TEXT}", (), most=MAX_MOTION_ORDER)
    swivel_motion: tuple[float, ...] = keys.angle(f"added to swivel {_MOTION_TEXT}", (), most=MAX_MOTION_ORDER)
    radial_motion: tuple[float, ...] = keys.length(f"added to radial {_MOTION_TEXT}", (), most=MAX_MOTION_ORDER)
    helical_motion: tuple[float, ...] = keys.length(f"added to sliding_base {_MOTION_TEXT}", (), most=MAX_MOTION_ORDER)
    vertical_motion: tuple[float, ...] = keys.length(
        f"added to machining_offset {_MOTION_TEXT}", (), most=MAX_MOTION_ORDER
    )
    blade_angle: float | None = _blade_angle(_SYNTHESIS_DEFAULT, "[AB]")
    blade_radius: float = keys.length(
        "radius of a circular-arc blade, > 0 convex; 0 = straight blade", 0.0, source="[AB] Table 4"
    )
    blade_height: float | None = keys.length(
        "height over the tip where blade_angle holds (circular-arc blade)", None, low=0, default="mean point"
    )
    edge_radius: float | None = edge_radius_key()
    toprem_height: float = keys.length("height over the tip where the blade's toprem begins; 0 = none", 0.0, low=0)
    toprem_angle: float | None = keys.angle(
        "between a straight toprem and the cutter axis", None, low=0, high=60, default="given by toprem_radius"
    )
    toprem_radius: float = keys.length(
        "radius of a toprem that is an arc tangent to the blade; 0 = straight", 0.0, low=0
    )


class HeadTable(Table):
    """Two-part head of face hobbing, for both members."""

    blade_groups: int = keys.count(
        "number of blade groups z0: the blank turns by so many teeth per turn of the head", 5, low=1, high=40
    )
    radius: float | None = keys.length(
        "cutter radius at the pitch point, mean of outer and inner blades",
        None,
        above=0,
        default="a usual radius by the mean cone distance",
        source="ISO 23509 r_c0",
    )
    eccentricity: float | None = keys.length(
        "radius of the outer blades less that of the inner blades, which turn about another centre: crowns the teeth "
        "lengthwise; 0 = line contact if blades are straight, too",
        None,
        low=0,
        default="by contact.ease_off.length_crowning, or the contact ellipse",
    )


class EaseOffTable(Table):
    """Requested ease-off: material missing on the pinion at the edges of its active flank against the conjugate flank.

    e = pressure_angle y + spiral_angle x + profile_crowning y^2 + length_crowning x^2 + twist x y. x is -1 at the toe
    and 1 at the heel. y is -1 as deep as the gear's tip reaches, and 1 at the pinion's tip.
    """

    pressure_angle: float = keys.length(
        "material missing at the tip; as much in excess where the gear's tip reaches",
        0.0,
        low=-MAX_EASE_OFF_MM,
        high=MAX_EASE_OFF_MM,
    )
    spiral_angle: float = keys.length(
        "material missing at the heel; as much in excess at the toe", 0.0, low=-MAX_EASE_OFF_MM, high=MAX_EASE_OFF_MM
    )
    profile_crowning: float = keys.length(
        "material missing at tip and root, by a parabola over the height",
        0.0,
        low=-MAX_EASE_OFF_MM,
        high=MAX_EASE_OFF_MM,
    )
    length_crowning: float = keys.length(
        "material missing at toe and heel, by a parabola along the face",
        0.0,
        low=-MAX_EASE_OFF_MM,
        high=MAX_EASE_OFF_MM,
    )
    twist: float = keys.length(
        "material missing at heel tip and toe root, in excess in the other corners",
        0.0,
        low=-MAX_EASE_OFF_MM,
        high=MAX_EASE_OFF_MM,
    )

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if not self.model_fields_set:
            # an empty table requests the conjugate flank
            self.model_fields_set.add("pressure_angle")
        return self


class PinionSide(Machine):
    """One side of the pinion: the requested contact, and the settings that give it or are given instead."""

    needs: ClassVar = (("mesh_angle", "index_angle", "index_angle, the position of the side on its tooth"),)

    ease_off: EaseOffTable | None = None
    sliding_base: float = keys.length(
        "blank withdrawn along the cradle axis",
        DERIVED_VALUE,
        default="that of the other side, or 0; of a tilted cutter where its tip reaches the root line",
        source="[AB] Fig. 4",
    )
    tilt: float = keys.angle(
        _TILT_TEXT,
        DERIVED_VALUE,
        low=-60,
        high=60,
        default="0; where the gear is not generated the cutter is upright on the root line",
        source="[LF04] 21",
    )
    swivel: float = keys.angle(
        "swivel j: direction of the tilt, 0 = towards growing cradle angle, 90 = towards the machine centre",
        DERIVED_VALUE,
        low=-360,
        high=360,
        default="0, or as for tilt",
        source="[LF04] 21",
    )
    machine_root_angle: float | None = keys.angle(
        "angle of blank axis and machine plane",
        None,
        low=-60,
        high=90,
        default="root angle; with tilt left out where the gear is not generated shaft_angle - 90 deg",
    )
    tip_radius: float | None = keys.length(
        "cutter radius at the tip", None, above=0, default=_SYNTHESIS_DEFAULT, source="[AB]"
    )
    index_angle: float | None = keys.angle(
        "rotation of the blank before this side is cut, in the sense of the cradle angle; 0: the middle of the tooth space is "
        "on the machine root line at cradle rotation 0",
        None,
        low=-360,
        high=360,
        default="by the backlash",
    )
    mesh_angle: float | None = keys.angle(
        "rotation of the pinion, in the sense of the cradle angle, from cutting this side to its position in mesh at phi1 = 0; "
        "with index_angle",
        None,
        low=-360,
        high=360,
        default='where it touches the gear at the mean point; 0 of given settings with mean_point = "cradle_zero"',
    )
    te_at_change: float = keys.number(
        "TE (arcsec) by which the gear lags at the change of tooth pairs", 10.0, low=-3600, high=3600, default="10"
    )
    ratio_derivative: float | None = keys.number(
        "(d2 phi2/d phi1^2)/(N1/N2) at the mean point, instead of te_at_change",
        None,
        low=-1,
        high=1,
        default="from te_at_change",
        source="[AB] Table 2",
    )
    path_angle: float = keys.angle(
        "direction of the path of contact on the gear, from its lengthwise principal direction (to the toe) towards its root",
        90.0,
        low=-180,
        high=180,
        default="chosen: 90, or as far from it as the contact ratio needs",
        source="[AB] Table 2",
    )
    semi_major_axis: float | None = keys.length(
        "semi-major axis of the contact ellipse at the mean point",
        None,
        above=0,
        default="face_width / 4, more on a narrow face",
        source="[AB]",
    )
    mean_offset: float = keys.length(
        "mean point farther from the gear's root than the middle of the working depth",
        0.0,
        default="chosen: the middle of the path",
        source="[AB]",
    )
    mean_shift: float = keys.length(
        "mean point farther from the apex than mean_cone_distance", 0.0, default="chosen: the middle of the path"
    )

    @property
    def gives_roll(self) -> bool:
        """True if modified roll is given."""
        return any(f"modified_roll_c{k}" in self.model_fields_set for k in range(2, MAX_MOTION_ORDER + 1))

    @property
    def moves_flank(self) -> bool:
        """True if given settings or motions may move the flank away from the mean point when it is cut."""
        given = any(getattr(self, key) is not None for key in SYNTHESISED_KEYS)
        return given or any(any(getattr(self, key)[:1]) for key in MOTION_KEYS)

    @property
    def upright(self) -> bool:
        """True if the cutter's axis is parallel to the cradle axis."""
        return self.tilt == 0.0


class GearCutter(Machine):
    """The gear's spread-blade cutter: both sides in one cut."""

    sliding_base: float = keys.length(
        "blank withdrawn along the cradle axis",
        DERIVED_VALUE,
        default="where the cutter's tip reaches the root cone: 0 where this passes through the crossing point",
        source="ISO 23509 t_zR2",
    )
    tip_radius: float | None = keys.length(
        "mean of inside and outside tip radius", None, above=0, default="ISO 23509", source="[AB] (5)"
    )
    straightest: bool = keys.flag(
        "without tip_radius: take the largest tip radius with which the pair can be made, for the straightest teeth",
        False,
    )
    point_width: float | None = keys.length(
        "outside minus inside tip radius", None, low=0, default="by the tooth thickness", source="[AB] (5)"
    )
    outside: BladeTable = BladeTable()
    inside: BladeTable = BladeTable()


class BevelPinion(BevelMember):
    """The pinion, with settings for each side."""

    thickness: float | None = keys.length(
        f"{_THICKNESS_TEXT}: by index_angle", None, above=0, default="by the backlash", source="ISO 23509"
    )
    concave: PinionSide = PinionSide()
    convex: PinionSide = PinionSide()

    @property
    def given_sides(self) -> tuple[str, ...]:
        return tuple(f"pinion.{name}" for name in ("concave", "convex") if self.side(name).moves_flank)

    def side(self, name: str) -> PinionSide:
        """Return the keys of a side of the pinion's teeth.

        `name`: "concave" or "convex".
        """
        return self.concave if name == "concave" else self.convex


class BevelGear(BevelMember):
    """The gear."""

    thickness: float | None = keys.length(
        f"{_THICKNESS_TEXT}: by the cutter's point width",
        None,
        above=0,
        default="by the blank and the backlash",
        source="ISO 23509",
    )
    cutter: GearCutter = GearCutter()


class BevelContact(ContactTable):
    """Contact, on one of the pinion's sides."""

    usual: ClassVar[tuple[str, ...]] = ("side",)

    side: str = driving_side_key("pinion_concave")

    @property
    def pinion_side(self) -> str:
        """Name of the side of the pinion, "concave" or "convex"."""
        return self.side.removeprefix("pinion_")


class SpiralBevelContact(BevelContact):
    """Contact of a pair that is cut, on one of the pinion's sides; the ease-off is requested of both."""

    ease_off: EaseOffTable | None = None


class HandedDesign(BevelDesign):
    """Keys of all pairs of bevel gears with a hand of spiral."""

    usual: ClassVar[tuple[str, ...]] = ("hand",)

    hand: str = keys.choice("hand of spiral of the pinion", ("right", "left"), "left")
    contact: BevelContact = BevelContact()


#: processes: each flank of the pinion by its own machine, or both at once; the gear both at once, generated or not
PROCESS_NAMES = (
    *("fixed_setting", "completing", "formate_fixed", "formate_completing"),
    *("face_hobbed", "face_hobbed_formate"),
)
#: processes with continuous indexing
HOBBED_PROCESSES = ("face_hobbed", "face_hobbed_formate")
#: processes that cut both flanks of the pinion at once
COMPLETING_PROCESSES = ("completing", "formate_completing")
#: processes that do not generate the gear
FORMATE_PROCESSES = ("formate_fixed", "formate_completing", "face_hobbed_formate")
#: keys of a blade, not of the machine
BLADE_KEYS = tuple(BladeTable.model_fields)
#: keys in which sides that are cut at once may differ: those of the blade, and those that request a contact
ONE_SIDE_KEYS = (
    *BLADE_KEYS,
    "tip_radius",
    "mesh_angle",
    "te_at_change",
    "ratio_derivative",
    "path_angle",
    "semi_major_axis",
    "mean_offset",
)
#: keys of a blade that face hobbing knows: edges pass through the pitch point, where blade_angle holds
HOBBED_BLADE_KEYS = tuple(key for key in BLADE_KEYS if key not in ("blade_angle", "blade_height"))
#: keys of the contact that eccentricity and hollow blades give
HOBBED_CONTACT_KEYS = ("te_at_change", "ratio_derivative", "semi_major_axis")
#: keys of the polynomials in the cradle's rotation
MOTION_KEYS = tuple(f"{name}_motion" for name in ("tilt", "swivel", "radial", "helical", "vertical"))
#: keys without meaning for a machine that does not roll
ROLLING_KEYS = (
    "ratio_of_roll",
    *(f"modified_roll_c{k}" for k in range(2, MAX_MOTION_ORDER + 1)),
    *MOTION_KEYS,
)
#: keys of a side of the pinion that are unknown to face hobbing by a machine for each side
HOBBED_UNKNOWN_KEYS = ("ease_off",)
#: parameters of an ease-off that eccentricity and hollow blades of face hobbing give
HOBBED_EASE_OFF_KEYS = ("profile_crowning", "length_crowning")
#: largest difference (mm) of lengths that count as equal: 1e5 times the rounding of solved settings of 100 mm
MAX_LENGTH_ROUNDING_MM = 1e-9
#: keys of a side of the pinion that, all given, leave nothing to local synthesis
SYNTHESISED_KEYS = (
    "radial",
    "cradle_angle",
    "ratio_of_roll",
    "machining_offset",
    "machine_centre_to_back",
    "blade_angle",
    "tip_radius",
)
#: keys of the pinion's machine that replace settings by one crown gear
CROWN_MACHINE_KEYS = SYNTHESISED_KEYS[:5]
#: parameters of an ease-off
EASE_OFF_KEYS = tuple(EaseOffTable.model_fields)
#: keys that cannot be given together with an ease-off
EASE_OFF_EXCLUDED_KEYS = (
    "te_at_change",
    "ratio_derivative",
    "path_angle",
    "semi_major_axis",
    "mean_offset",
    "mean_shift",
)
#: mean spiral angle of the gear, deg, where methods 2 and 3 of ISO 23509 take it and the design leaves it out
USUAL_GEAR_SPIRAL_ANGLE = 30.0
#: ends of the keys of derived settings that belong to the cones
KEYS_OF_CONES = (".sliding_base", ".tilt", ".swivel", ".machine_root_angle")
#: keys and tables on which no cone depends
KEYS_BESIDE_CONES = ("gearmesh.", "assembly.", "contact.", "mesh.", "material.", "fe.")


class FaceMilledDesign(ProportionedDesign, HandedDesign):
    """Keys of all pairs cut by face-milling head cutters, with or without offset."""

    usual: ClassVar[tuple[str, ...]] = ("spiral_angle", "process")

    process: str = keys.choice(
        "pinion sides cut with a machine setting each (fixed_setting) or both in one cut (completing); formate: "
        "gear not generated; face_hobbed: continuous indexing; face_hobbed_formate: gear not generated",
        PROCESS_NAMES,
        "fixed_setting",
    )
    spiral_angle: float = keys.angle("mean spiral angle", 35.0, low=0, high=50, source="ISO 23509")
    pressure_angle: float = keys.angle("nominal pressure angle: blade angle of the gear", 20.0, low=10, high=30)
    mean_point: str = keys.choice(
        "position of the mean point along the face: at the mean cone distance, or where cradle rotation 0 generates it",
        ("mean_cone_distance", "cradle_zero"),
        "mean_cone_distance",
        source="[AB]",
    )
    head: HeadTable = HeadTable()
    contact: SpiralBevelContact = SpiralBevelContact()
    pinion: BevelPinion
    gear: BevelGear
    rexs: RexsSource | None = None

    @property
    def apex_base(self) -> float:
        """Sliding base with which a cutter's tip passes through the crossing point of the axes.

        It is NaN unless root cones have their apex there.
        """
        return DERIVED_VALUE

    def ease_off(self, name: str) -> EaseOffTable | None:
        """Return the requested ease-off of a side of the pinion: the side's table, or the table for both sides.

        Parameters
        ----------
        name : str
            "concave" or "convex".

        Returns
        -------
        EaseOffTable or None
            None if no ease-off is requested.

        Examples
        --------
        >>> gm.load("samples/spiral_bevel_basic.toml").ease_off("concave") is None
        True
        """
        own = self.pinion.side(name).ease_off
        return self.contact.ease_off if own is None else own

    def ease_off_key(self, name: str) -> str:
        """Return the key of the requested ease-off of a side of the pinion.

        Parameters
        ----------
        name : str
            "concave" or "convex".

        Returns
        -------
        str
            Dotted key.

        Examples
        --------
        >>> gm.load("samples/spiral_bevel_basic.toml").ease_off_key("concave")
        'contact.ease_off'
        """
        return "contact.ease_off" if self.pinion.side(name).ease_off is None else f"pinion.{name}.ease_off"

    @property
    def complete(self) -> bool:
        cutter = self.gear.cutter
        return super().complete and not (cutter.straightest and cutter.tip_radius is None)

    def plain(self) -> dict[str, Any]:
        tables = super().plain()
        if self.pinion.thickness is not None:
            del tables["backlash"]
        for name in ("concave", "convex"):
            if self.ease_off(name) is not None:
                # without the defaults of keys that an ease-off replaces
                side = tables["pinion"][name]
                tables["pinion"][name] = {key: side[key] for key in side if key not in EASE_OFF_EXCLUDED_KEYS}
        if not self.hobbed:
            del tables["head"]
            return tables
        for prefix, (_, known) in self._hobbed_tables.items():
            *above, name = prefix.split(".")
            outer = functools.reduce(lambda table, key: table[key], above, tables)
            # a radius of the cutting edge that is left out follows from the profile crowning
            outer[name] = {
                key: value
                for key, value in outer[name].items()
                if key in known and (key != "blade_radius" or self.sets(f"{prefix}.{key}"))
            }
        return tables

    @property
    def _hobbed_tables(self) -> dict[str, tuple[Table, tuple[str, ...]]]:
        """Tables of members and cutters, by their keys, and the keys that face hobbing has in them."""
        machine_keys = (*CROWN_MACHINE_KEYS, *ROLLING_KEYS[1:])
        side_keys: tuple[str, ...] = (*HOBBED_BLADE_KEYS, *HOBBED_CONTACT_KEYS, *machine_keys, "ease_off")
        if not self.one_crown_gear:
            # settings by local synthesis, or given
            side_keys = tuple(key for key in PinionSide.model_fields if key not in HOBBED_UNKNOWN_KEYS)
        blade = (*HOBBED_BLADE_KEYS, "blade_angle")
        gear, pinion = self.gear, self.pinion
        return {
            "pinion": (pinion, tuple(key for key in BevelPinion.model_fields if key != "root_angle")),
            "gear": (gear, tuple(key for key in BevelGear.model_fields if key != "root_angle")),
            "pinion.concave": (pinion.concave, side_keys),
            "pinion.convex": (pinion.convex, side_keys),
            "gear.cutter": (gear.cutter, (*blade, "outside", "inside")),
            "gear.cutter.outside": (gear.cutter.outside, blade),
            "gear.cutter.inside": (gear.cutter.inside, blade),
        }

    @property
    def completing(self) -> bool:
        """True if both sides of the pinion are cut at once."""
        return self.process in COMPLETING_PROCESSES

    @property
    def hobbed(self) -> bool:
        """True if the cutter indexes continuously: face hobbing."""
        return self.process in HOBBED_PROCESSES

    @property
    def one_crown_gear(self) -> bool:
        """True if one crown gear generates both members."""
        return self.hobbed and not self.formate

    @property
    def milling_blank(self) -> bool:
        """True if pitch cones follow from the limit curvature, as those of face-milled hypoid pairs."""
        return False

    @property
    def indexed(self) -> bool:
        """True if index angles or a given thickness determine the pinion's thickness, not the backlash."""
        angles = [self.pinion.side(name).index_angle for name in ("concave", "convex")]
        return self.pinion.thickness is not None or any(angle is not None for angle in angles)

    @property
    def formate(self) -> bool:
        """True if the gear is not generated."""
        return self.process in FORMATE_PROCESSES

    @model_validator(mode="before")
    @classmethod
    def _depth_of_hobbing(cls, data: Any) -> Any:
        """Make the depth uniform where face hobbing leaves the taper out."""
        hobbed = isinstance(data, dict) and str(data.get("process", "")) in HOBBED_PROCESSES
        return {"taper": "uniform", **data} if hobbed else data

    @model_validator(mode="before")
    @classmethod
    def _as_the_other_side(cls, data: Any) -> Any:
        """Copy settings given for one side to the other if both sides of the pinion are cut at once."""
        pinion = data.get("pinion") if isinstance(data, dict) else None
        if not (isinstance(pinion, dict) and str(data.get("process", "")) in COMPLETING_PROCESSES):
            return data
        sides = {name: pinion.get(name, {}) for name in ("concave", "convex")}
        if not all(isinstance(side, dict) for side in sides.values()):
            return data
        shared = {key: value for side in sides.values() for key, value in side.items() if key not in ONE_SIDE_KEYS}
        return {**data, "pinion": {**pinion, **{name: {**shared, **side} for name, side in sides.items()}}}

    @model_validator(mode="after")
    def _one_machine(self) -> Self:
        """Refuse sides cut at once with different or missing machine settings."""
        if not self.completing:
            return self
        first, second = self.pinion.concave.plain(), self.pinion.convex.plain()
        for key in sorted((first.keys() | second.keys()) - {*ONE_SIDE_KEYS}):
            one, other = first.get(key), second.get(key)
            if not self._alike(key, one, other):
                why = f'process = "{self.process}" cuts both sides at once; allowed is pinion.concave.{key} = {value_text(one)}'
                raise conflict(f"pinion.convex.{key}", other, reason=why)
        for name in ("concave", "convex"):
            for key in SYNTHESISED_KEYS:
                if getattr(self.pinion.side(name), key) is None:
                    why = f'missing; process = "{self.process}" derives no settings of the pinion: give them all'
                    raise conflict(f"pinion.{name}.{key}", None, reason=why)
        self._refuse_crossed_blades()
        return self

    def _refuse_crossed_blades(self) -> None:
        """Refuse blades of one cutter that cross.

        The outside blade cuts the concave side, the inside blade the convex side.
        """
        outside, inside = self.pinion.concave.tip_radius, self.pinion.convex.tip_radius
        if outside is None or inside is None or outside > inside:
            return
        alone = self.process.replace("completing", "fixed" if self.formate else "fixed_setting")
        why = "point width negative: the blades of one cutter cross"
        more = f"more than pinion.convex.tip_radius, {value_text(inside)}"
        raise conflict(
            "pinion.concave.tip_radius",
            outside,
            reason=why,
            allowed=f'{more}; or cut side by side: process = "{alone}"',
        )

    def _alike(self, key: str, one: Any, other: Any) -> bool:
        """Return True if a setting is equal on both sides; lengths are compared up to rounding."""
        of_key = self.pinion.concave.key_of(key)
        if of_key is not None and of_key.unit == "length" and isinstance(one, float) and isinstance(other, float):
            apart = abs(one - other) * self.mm_per_unit
            return apart <= MAX_LENGTH_ROUNDING_MM or (math.isnan(one) and math.isnan(other))
        return bool(one == other or (one != one and other != other))

    @model_validator(mode="after")
    def _thickness_alone(self) -> Self:
        """Refuse other keys that determine a given thickness."""
        given = self.pinion.thickness
        if self.gear.thickness is not None and self.gear.cutter.point_width is not None:
            why = "cannot be given together with gear.cutter.point_width"
            raise conflict("gear.thickness", self.gear.thickness, reason=why)
        if given is None:
            return self
        if self.completing:
            why = f'process = "{self.process}" determines it by the pinion\'s blades; leave it out, or give their tip_radius'
            raise conflict("pinion.thickness", given, reason=why)
        if not math.isnan(self.backlash):
            raise conflict(
                "pinion.thickness", given, reason="cannot be given together with backlash, which follows from it"
            )
        for name in ("concave", "convex"):
            if self.pinion.side(name).index_angle is not None:
                raise conflict(
                    "pinion.thickness", given, reason=f"cannot be given together with pinion.{name}.index_angle"
                )
        return self

    @property
    def gear_backlash(self) -> float:
        """Normal backlash (in the design's units) by which the gear is thinned.

        It is the backlash of the pair, or the default backlash if the thickness of the pinion is given.
        """
        return given_or(self.backlash, self.suggested_backlash)

    @model_validator(mode="after")
    def _standing(self) -> Self:
        """Refuse keys of rolling for a gear that is not generated."""
        if not self.formate:
            return self
        for key in ROLLING_KEYS:
            value = getattr(self.gear.cutter, key)
            if value:
                raise conflict(
                    f"gear.cutter.{key}",
                    value,
                    reason=f'the gear of process = "{self.process}" is cut without generating roll; leave it out',
                )
        if self.mean_point == "cradle_zero":
            why = f'the gear of process = "{self.process}" is cut without a cradle; allowed is "mean_cone_distance"'
            raise conflict("mean_point", self.mean_point, reason=why)
        return self

    @model_validator(mode="after")
    def _continuous(self) -> Self:
        """Refuse keys of face milling beside face hobbing, and keys of the head beside face milling."""
        own = f'process = "{self.process}"'
        if not self.hobbed:
            for key in HeadTable.model_fields:
                if getattr(self.head, key) != HeadTable.model_fields[key].default:
                    why = (
                        f'is for face hobbing; {own} cuts one space after the other; allowed is process = "face_hobbed"'
                    )
                    raise conflict(f"head.{key}", getattr(self.head, key), reason=why)
            return self
        for prefix, (table, known) in self._hobbed_tables.items():
            for key in sorted(table.model_fields_set - {*known}):
                value = getattr(table, key)
                unset = value == type(table).model_fields[key].default or (
                    isinstance(value, float) and math.isnan(value)
                )
                # settings of 0 are derived values, but no blades are 0 apart
                if not unset and (value or key == "point_width"):
                    why = f"{own} derives it from head, blank and contact; leave it out"
                    if key in ROLLING_KEYS[1:]:
                        why = f"{own} has a constant ratio of roll; leave it out"
                    raise conflict(f"{prefix}.{key}", value, reason=why)
        for key, allowed in (("taper", "uniform"), ("mean_point", "mean_cone_distance")):
            if key in self.model_fields_set and getattr(self, key) != allowed:
                raise conflict(key, getattr(self, key), reason=f'{own}; allowed is "{allowed}"')
        if self.one_crown_gear:
            self._refuse_other_crownings(own)
        return self

    @model_validator(mode="after")
    def _no_eccentricity(self) -> Self:
        """Refuse keys that crown the teeth of one crown gear where each member has its own."""
        if not self.hobbed or self.one_crown_gear:
            return self
        two = "" if self.formate else " with offset"
        why = f'process = "{self.process}"{two}; the contact follows from local synthesis; leave it out'
        if self.head.eccentricity is not None:
            raise conflict("head.eccentricity", self.head.eccentricity, reason=why)
        for name in ("concave", "convex"):
            if self.ease_off(name) is not None:
                raise conflict(self.ease_off_key(name), None, reason=why)
        return self

    def _refuse_other_crownings(self, own: str) -> None:
        """Refuse parameters of an ease-off that face hobbing does not give."""
        for name in ("concave", "convex"):
            target = self.ease_off(name)
            if target is None:
                continue
            asked = self.ease_off_key(name)
            for key in EASE_OFF_KEYS:
                value = getattr(target, key)
                if key not in HOBBED_EASE_OFF_KEYS and value:
                    raise conflict(f"{asked}.{key}", value, reason=f"{own} gives none; allowed is 0")
                if value < 0.0:
                    raise conflict(f"{asked}.{key}", value, reason=own, allowed="0 or more")
            if self.head.eccentricity is not None and target.length_crowning:
                why = f"cannot be given together with {asked}.length_crowning"
                raise conflict("head.eccentricity", self.head.eccentricity, reason=why)

    @model_validator(mode="after")
    def _ease_off_alone(self) -> Self:
        """Refuse other keys of the contact, and complete settings, beside an ease-off."""
        for name in ("concave", "convex"):
            if self.ease_off(name) is None:
                continue
            side, asked = self.pinion.side(name), self.ease_off_key(name)
            for key in EASE_OFF_EXCLUDED_KEYS:
                if key in side.model_fields_set and getattr(side, key) is not None:
                    raise conflict(
                        f"pinion.{name}.{key}", getattr(side, key), reason=f"cannot be given together with {asked}"
                    )
            if self.completing:
                raise conflict(
                    asked, None, reason=f'process = "{self.process}" derives no settings of the pinion; leave it out'
                )
            if self.mean_point == "cradle_zero":
                why = f'cannot be given together with {asked}; allowed is "mean_cone_distance"'
                raise conflict("mean_point", self.mean_point, reason=why)
            if all(getattr(side, key) is not None for key in SYNTHESISED_KEYS):
                why = f"pinion.{name} already gives all settings; leave the ease-off out, or some of the settings"
                raise conflict(asked, None, reason=why)
        return self

    def stays(self, dotted: str, values: Mapping[str, Any]) -> bool:
        if dotted == "backlash":
            return not BACKLASH_KEYS & values.keys()
        # a sliding base and a lean belong to the cones; machine settings given together, as on a sheet, belong to the
        # old ones
        whole = any(key.endswith(".radial") for key in values)
        if dotted == "gear.cutter.tip_radius":
            return all(f"{key}.".startswith(KEYS_BESIDE_CONES) for key in values)
        return (
            whole
            or not dotted.endswith(KEYS_OF_CONES)
            or all(f"{key}.".startswith(KEYS_BESIDE_CONES) for key in values)
        )

    def leans(self, name: str) -> bool:
        """Return True if tilt and swivel of a side of the pinion are to be derived, for a gear that is not generated.

        Parameters
        ----------
        name : str
            "concave" or "convex".

        Returns
        -------
        bool
            True if they are to be derived.

        Examples
        --------
        >>> gm.load("samples/spiral_bevel_basic.toml").leans("concave")
        False
        """
        own = self.pinion.side(name)
        left = math.isnan(own.tilt) and math.isnan(own.swivel)
        return self.formate and left and any(getattr(own, key) is None for key in SYNTHESISED_KEYS)

    def derived_values(self) -> dict[str, float]:
        # backlash, tilt, swivel and sliding bases that the file leaves out. Values that need the geometry are not
        # included: sliding bases of tilted cutters, and their tilt and swivel for a gear that is not generated. Both
        # sides of the pinion are cut to one depth.
        defaults = super().derived_values()
        if self.pinion.thickness is None:
            defaults["backlash"] = self.suggested_backlash
        if not math.isnan(self.apex_base):
            defaults["gear.cutter.sliding_base"] = self.apex_base
        upright = {}
        for name in ("concave", "convex"):
            key, leans = f"pinion.{name}", self.leans(name)
            upright[name] = not leans and given_or(self.pinion.side(name).tilt, 0.0) == 0.0
            if leans:
                defaults[f"{key}.machine_root_angle"] = self.shaft_angle - 90.0
            else:
                defaults |= {f"{key}.tilt": 0.0, f"{key}.swivel": 0.0}
        for name, other in (("concave", "convex"), ("convex", "concave")):
            base = given_or(self.pinion.side(other).sliding_base, self.apex_base) if upright[other] else self.apex_base
            if upright[name] and not math.isnan(base):
                defaults[f"pinion.{name}.sliding_base"] = base
        return defaults


class SpiralBevelDesign(FaceMilledDesign):
    """A spiral bevel pair cut by head cutters."""

    own_kind: ClassVar[str] = "spiral_bevel"
    example: ClassVar[Mapping[str, Any]] = {"module": 5, "pinion": {"teeth": 13}, "gear": {"teeth": 44}}
    about: ClassVar[str] = OWN_KINDS["spiral_bevel"].about

    mean_cone_distance: float | None = keys.length(
        "cone distance of the mean point", None, above=0, default="outer less half the face width"
    )

    @property
    def kind_in_words(self) -> str:
        return "Spiral bevel gears" if self.spiral_angle else "Bevel gears"

    @property
    def apex_base(self) -> float:
        given = self.pinion.root_angle, self.gear.root_angle
        return 0.0 if self.taper == "standard" and given == (None, None) else super().apex_base


class HypoidDesign(FaceMilledDesign):
    """A hypoid pair cut by head cutters."""

    own_kind: ClassVar[str] = "hypoid"
    example: ClassVar[Mapping[str, Any]] = {
        "module": 4.5,
        "offset": 25,
        "pinion": {"teeth": 12},
        "gear": {"teeth": 41},
    }
    about: ClassVar[str] = OWN_KINDS["hypoid"].about
    called: ClassVar[str] = "Hypoid gears"

    offset: float = keys.length(
        "offset of the axes, > 0 where it makes the pinion's spiral angle the larger one", source="ISO 23509 a"
    )
    spiral_angle: float = keys.angle(
        "mean spiral angle of the pinion; with blank_method 2 and 3 of the gear",
        50.0,
        low=0,
        high=80,
        default="50; with blank_method 2 and 3 30",
        source="ISO 23509",
    )
    blank_method: int = keys.count(
        "method of ISO 23509 for the pitch cones: 1 (limit curvature); of face hobbing also 2 (Oerlikon) and "
        "3 (Klingelnberg)",
        1,
        low=1,
        high=3,
        source="ISO 23509",
    )
    limit_share: float = keys.number(
        "share of the limit pressure angle that the gear's blades compensate: 1 = equal conditions on both sides",
        1.0,
        low=0,
        high=1,
        source="ISO 23509 f_alim",
    )

    @model_validator(mode="before")
    @classmethod
    def _spiral_of_gear(cls, data: Any) -> Any:
        """Give the gear a usual spiral angle where a method takes the gear's and the design leaves it out."""
        by_gear = isinstance(data, dict) and data.get("blank_method") in (2, 3)
        return {"spiral_angle": USUAL_GEAR_SPIRAL_ANGLE, **data} if by_gear else data

    @model_validator(mode="after")
    def _blank_of_hobbing(self) -> Self:
        """Refuse methods of face hobbing beside face milling."""
        if self.blank_method != 1 and not self.hobbed:
            why = f'is for face hobbing; process = "{self.process}"'
            raise conflict("blank_method", self.blank_method, reason=why, allowed="1")
        return self

    @property
    def one_crown_gear(self) -> bool:
        return False

    @property
    def milling_blank(self) -> bool:
        return self.blank_method == 1
