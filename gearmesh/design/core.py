"""Tables of a design file that all kinds have, and the base class of all designs.

A `Table` is a table of the file, a `Design` is the whole file. Numbers stay in the file's `units` and in degrees until
`Design.in_mm`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from typing import Any, ClassVar, Self

from pydantic import PrivateAttr, ValidationError, model_validator

from gearmesh import __version__
from gearmesh.design import keys
from gearmesh.design.changes import unknown_version
from gearmesh.design.dotted import with_keys
from gearmesh.design.explain import explain
from gearmesh.design.keys import DERIVED_VALUE, MM_PER, KeyLine, Table, conflict, key_lines, usual_keys
from gearmesh.design.measured import PairMeasured
from gearmesh.design.shown import html_table, value_text
from gearmesh.errors import DesignError
from gearmesh.member_names import MemberNames
from gearmesh.records import dataclass

#: default thickness of the marking compound [LT02 5]
DEFAULT_DELTA_MM = 0.00635
#: largest default thickness of the marking compound, in modules: ellipses stay smaller than small teeth
MAX_DELTA_MODULES = 0.01
#: smallest module whose teeth a mesh resolves with the finest tolerance
SMALLEST_MODULE_MM = 1e-3
#: largest module whose radii stay below the largest length
LARGEST_MODULE_MM = 1e4
#: default density
STEEL_DENSITY_KG_PER_M3 = 7850.0


def module_key(about: str, default: str) -> Any:
    """Return the key of a module, of any section."""
    return keys.length(about, None, low=SMALLEST_MODULE_MM, high=LARGEST_MODULE_MM, default=default)


def pitch_key(about: str, default: str) -> Any:
    """Return the key of a diametral pitch; its range covers the same teeth as that of a module."""
    low, high = (MM_PER["inch"] / module for module in (LARGEST_MODULE_MM, SMALLEST_MODULE_MM))
    return keys.pitch(about, None, low=low, high=high, default=default)


class Keyway(Table):
    """Keyway in the bore: by a standard, or of its own size."""

    replaces = (("width", "standard"),)

    standard: str = keys.choice("gives width and depth for the bore", ("DIN 6885",), "DIN 6885")
    width: float | None = keys.length("width", None, above=0, default="by the standard")
    depth: float | None = keys.length("depth below the bore's surface", None, above=0, default="by the standard")

    @model_validator(mode="after")
    def _whole_size(self) -> Self:
        if (self.width is None) != (self.depth is None):
            given, other = ("width", "depth") if self.depth is None else ("depth", "width")
            raise conflict(
                given, getattr(self, given), reason=f"{other} is missing; give both, or neither for the standard sizes"
            )
        if self.width is None:
            # an empty table asks for the standard's
            self.model_fields_set.add("standard")
        return self


class HexBore(Table):
    """Hexagonal bore, with a corner on +x; `bore` is then the hole that is drilled before broaching."""

    across_flats: float = keys.length("width across flats; the default of bore", above=0)


class DBore(Table):
    """Flat in the bore, square to +x (D bore); with flats = 2 there is another one on the opposite side."""

    height: float = keys.length(
        "distance from the flat to the opposite side of the bore, or to the second flat", above=0
    )
    flats: int = keys.count("number of flats", 1, low=1, high=2)


class Hub(Table):
    """Hub beyond the end face."""

    diameter: float = keys.length("outer diameter", above=0)
    length: float = keys.length("length beyond the end face", above=0)


class Web(Table):
    """Disc between hub and rim, thinner than the face is wide and in its middle; of bevel gears beside the toe's face."""

    thickness: float = keys.length("thickness", above=0)
    rim_diameter: float | None = keys.length(
        "inner diameter of the rim", None, above=0, default="1.2 whole depths below the smallest root"
    )
    hub_diameter: float | None = keys.length(
        "outer diameter of the hub",
        None,
        above=0,
        default="that of the hub beyond the end face, or 1.6 bores; without a bore 40 % of rim_diameter",
    )


class Holes(Table):
    """Through holes along the axis, in the web or, without one, between bore (or rim) and root; the first is on +x."""

    count: int = keys.count("number of holes", low=1, high=1000)
    diameter: float | None = keys.length(
        "diameter of each hole", None, above=0, default="half the room, or 60 % of the distance between holes"
    )
    circle: float | None = keys.length(
        "diameter of the circle through the hole centres", None, above=0, default="in the middle of the room"
    )


class BoltHoles(Table):
    """Bolt holes along the axis on a bolt circle, evenly spaced, through the body or into its heel."""

    listed_apart: ClassVar[str] = "bolt holes"

    count: int = keys.count("number of holes", low=1, high=1000)
    diameter: float = keys.length("diameter of each hole", above=0)
    circle: float | None = keys.length(
        "diameter of the bolt circle", None, above=0, default="in the middle of the room"
    )
    depth: float | None = keys.length(
        "depth of blind holes, from the heel's face; without it they go through", None, above=0
    )
    start_angle: float = keys.angle(
        "polar angle of the first hole, counted from the tooth on +x", 0.0, low=-360, high=360
    )


class SpokeTable(Table):
    """Spokes of constant width, with openings between them, in the web or, without one, between bore (or hub) and rim."""

    listed_apart: ClassVar[str] = "spokes"

    count: int = keys.count("number of spokes", low=2, high=1000)
    width: float = keys.length("width of each spoke", above=0)
    inner_diameter: float | None = keys.length(
        "diameter at which the openings begin", None, above=0, default="10 % of the room beyond its inner diameter"
    )
    outer_diameter: float | None = keys.length(
        "diameter at which the openings end", None, above=0, default="10 % of the room within its outer diameter"
    )
    corner_radius: float | None = keys.length(
        "radius of the openings' corners; 0 = sharp", None, low=0, default="a tenth of their height"
    )
    start_angle: float = keys.angle(
        "polar angle of the first spoke, counted from the tooth on +x", 0.0, low=-360, high=360
    )


#: largest number of steps of a shaft or bore
MAX_SHAFT_STEPS = 12


class ShaftSteps(Table):
    """Shaft, shank or journals in one piece with the body, on an end face or on the hub; the default bore is then 0."""

    listed_apart: ClassVar[str] = "shafts"

    diameters: tuple[float, ...] = keys.length(
        "diameters of the steps, from the body outwards", above=0, most=MAX_SHAFT_STEPS
    )
    lengths: tuple[float, ...] = keys.length("length of each step", above=0, most=MAX_SHAFT_STEPS)
    end_diameters: tuple[float, ...] = keys.length(
        "diameter of each step at its outer end, of cones",
        (),
        above=0,
        most=MAX_SHAFT_STEPS,
        default="those of diameters",
    )

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        _refuse_uneven(self.diameters, {"lengths": self.lengths, "end_diameters": self.end_diameters or self.diameters})
        return self


class BoreSteps(Table):
    """Steps of the bore at one end; of an internal gear, steps of the outside."""

    listed_apart: ClassVar[str] = "bore steps"

    diameters: tuple[float, ...] = keys.length(
        "diameters of the steps, from the end face inwards", above=0, most=MAX_SHAFT_STEPS
    )
    lengths: tuple[float, ...] = keys.length("length of each step along the axis", above=0, most=MAX_SHAFT_STEPS)

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        _refuse_uneven(self.diameters, {"lengths": self.lengths})
        return self


def _refuse_uneven(diameters: tuple[float, ...], others: Mapping[str, tuple[float, ...]]) -> None:
    """Refuse steps with missing sizes."""
    if not diameters:
        raise conflict("diameters", list(diameters), must_be="a list of at least one length")
    for key, values in others.items():
        if len(values) != len(diameters):
            raise conflict(key, list(values), must_be=f"{len(diameters)} lengths, one for each of diameters")


class MemberMaterial(Table):
    """Material of one member, where it differs from the table material."""

    youngs_modulus: float | None = keys.pressure("Young's modulus", None, above=0, default="material.youngs_modulus")
    poisson_ratio: float | None = keys.number(
        "Poisson's ratio", None, low=0, high=0.499, default="material.poisson_ratio"
    )
    density: float | None = keys.density("density", None, above=0, high=50000, default="material.density")


class MemberMount(Table):
    """Support of a member under load: body, shaft and bearings."""

    needs: ClassVar = (("z", "stiffness", "stiffness, which refers to this point"),)

    stiffness: tuple[float | str | tuple[float, ...], ...] | None = keys.stiffness(
        "stiffness of shaft and bearings at z, for displacements x, y, z and small rotations about them, always in N, mm, "
        "rad: its diagonal, or all 6 by 6; in the frame of the member at rotation 0, not rotating (of a planet: its pin, x away "
        "from the sun)",
        None,
        default="rigid",
    )
    z: float | None = keys.length(
        "point on the member's axis to which stiffness refers", None, default="the middle of the face"
    )
    held: str = keys.choice(
        "where the body is held: at the bore (an internal gear: on its outside; a rack: at its back), or 1.2 whole depths "
        "under the root",
        ("bore", "rim"),
        "bore",
    )

    @model_validator(mode="after")
    def _sound_stiffness(self) -> Self:
        given = self.stiffness
        if given is not None and isinstance(given[0], tuple) and not _positive_definite(given):
            raise conflict("stiffness", None, reason="its rows must be symmetric and positive definite")
        return self

    def refuse_stiffness(self, key: str, why: str) -> None:
        """Refuse a stiffness that cannot have an effect.

        Parameters
        ----------
        key : str
            Dotted key of the table.
        why : str
            The reason in words.

        Raises
        ------
        DesignError
            If a stiffness is given.

        Examples
        --------
        >>> gm.MemberMount(held="rim").refuse_stiffness("pinion.mount", "the gears are rigid")
        """
        if self.stiffness is not None:
            raise conflict(f"{key}.stiffness", None, reason=why)


#: tables of members that describe the body under the teeth
BODY_TABLES: tuple[str, ...] = (
    "keyway", "hub", "web", "holes", "toe_hub", "heel_shaft", "toe_shaft", "heel_bore", "toe_bore", "bolts", "spokes",
    "hex_bore", "d_bore",
)  # fmt: skip


def _at_one_end(end: str, both: str) -> Any:
    """Return the key of an edge at one end face, whose default is the key of both end faces."""
    return keys.length(f"the same at the {end} alone; 0 = sharp", None, low=0, default=both)


class BrokenEdges(Table):
    """Chamfers and roundings of the edges of teeth, at tips and end faces."""

    exclusive: ClassVar[tuple[tuple[str, str], ...]] = (("tip_rounding", "tip_chamfer"),)

    tip_chamfer: float | None = keys.length("45 deg chamfer between flank and top land", None, low=0)
    tip_rounding: float | None = keys.length("rounding between flank and top land", None, low=0)
    end_chamfer: float | None = keys.length(
        "chamfer of the teeth's edges at both end faces: width on the end face, at right angles to them", None, low=0
    )
    end_chamfer_toe: float | None = _at_one_end("toe", "end_chamfer")
    end_chamfer_heel: float | None = _at_one_end("heel", "end_chamfer")
    end_chamfer_angle: float | None = keys.angle(
        "angle of these chamfers to the end face", None, low=10, high=80, default="45"
    )
    end_rounding: float | None = keys.length(
        "rounding of the teeth's edges at both end faces: radius where they are at right angles", None, low=0
    )
    end_rounding_toe: float | None = _at_one_end("toe", "end_rounding")
    end_rounding_heel: float | None = _at_one_end("heel", "end_rounding")

    @model_validator(mode="after")
    def _edges(self) -> Self:
        if self.end_chamfer_angle is not None and not (
            self.end_chamfer or self.end_chamfer_toe or self.end_chamfer_heel
        ):
            raise conflict("end_chamfer_angle", self.end_chamfer_angle, reason="needs end_chamfer")
        for end in ("toe", "heel"):
            (width_key, width), (radius_key, radius) = (
                next(
                    (key, own)
                    for key in (f"{edge}_{end}", edge)
                    if (own := getattr(self, key)) is not None or key == edge
                )
                for edge in ("end_chamfer", "end_rounding")
            )
            if width and radius:
                raise conflict(radius_key, radius, reason=f"cannot be given together with {width_key}, for the {end}")
        return self


class FlankStock(Table):
    """Stock for a finishing tool."""

    stock: float = keys.length(
        "stock on each flank, normal to it, in solids, sections, STEP files and tool paths; root and lands, contact and load "
        "are those of the finished gear",
        0.0,
        low=0,
        high=100,
    )


class TurnedTip(Table):
    """Turned tip: a cone or a throat instead of the tip cylinder."""

    exclusive: ClassVar[tuple[tuple[str, str], ...]] = (("tip_throat_radius", "tip_cone_angle"),)

    tip_cone_angle: float | None = keys.angle(
        "angle of a conical tip to the axis, positive where it widens along z; the tip diameter is that at mid face",
        None,
        low=-60,
        high=60,
        default="0, a cylinder",
    )
    tip_throat_radius: float | None = keys.length(
        "radius of a throated tip in the axial plane: the tip diameter is that at mid face, the ends are higher",
        None,
        above=0,
        default="no throat",
    )

    @model_validator(mode="after")
    def _one_tip_surface(self) -> Self:
        for key in ("tip_cone_angle", "tip_throat_radius"):
            if (value := getattr(self, key)) and getattr(self, "modified", False):
                raise conflict(key, value, reason="cannot be given together with modifications")
        return self


class NumberOfTeeth(Table):
    """Number of teeth of a gear."""

    teeth: int = keys.count("number of teeth", low=3, high=10000)


class TurnedBody(Table):
    """Body of revolution under the teeth, with keyway or other forms of the bore, steps, holes and spokes."""

    usual: ClassVar[tuple[str, ...]] = ("bore",)

    exclusive: ClassVar[tuple[tuple[str, str], ...]] = (
        ("hex_bore", "keyway"),
        ("d_bore", "keyway"),
        ("d_bore", "hex_bore"),
    )

    bore: float | None = keys.length(
        "bore diameter; 0 = no bore", None, low=0, default="40 % of the root diameter at the small end"
    )
    keyway: Keyway | None = None
    hex_bore: HexBore | None = None
    d_bore: DBore | None = None
    hub: Hub | None = None
    toe_hub: Hub | None = None
    heel_shaft: ShaftSteps | None = None
    toe_shaft: ShaftSteps | None = None
    heel_bore: BoreSteps | None = None
    toe_bore: BoreSteps | None = None
    bolts: BoltHoles | None = None
    spokes: SpokeTable | None = None

    @model_validator(mode="after")
    def _shaft(self) -> Self:
        if self.bore is None:
            return self
        width = None if self.keyway is None else self.keyway.width
        if width is not None and width >= self.bore:
            raise conflict(
                "keyway.width",
                width,
                must_be=f"smaller than the bore, {self.bore:g}",
                other=("bore", self.bore, f"larger than the width of the keyway, {width:g}"),
            )
        for key, hub in (("hub", self.hub), ("toe_hub", self.toe_hub)):
            if hub is not None and hub.diameter <= self.bore:
                raise conflict(
                    f"{key}.diameter",
                    hub.diameter,
                    must_be=f"larger than the bore, {self.bore:g}",
                    other=("bore", self.bore, f"smaller than the diameter of the hub, {hub.diameter:g}"),
                )
        return self

    @property
    def bore_key(self) -> str:
        """Key that gives the diameter of the bore."""
        return "bore" if self.bore is not None or self.hex_bore is None else "hex_bore.across_flats"

    @property
    def stated_bore(self) -> float | None:
        """Given diameter of the bore; 0 if a shaft is in one piece with the body; None for the default."""
        if self.bore is None and self.hex_bore is not None:
            return self.hex_bore.across_flats
        return 0.0 if self.bore is None and (self.heel_shaft or self.toe_shaft) else self.bore


class MemberBody(FlankStock, BrokenEdges, TurnedBody):
    """Keys of every member, with teeth or threads."""

    rank: ClassVar[int] = 0

    material: MemberMaterial | None = None
    mount: MemberMount | None = None


class GearBody(MemberBody, NumberOfTeeth):
    """Keys of every gear."""


class PlaneFaces(Table):
    """Plane end faces of a member, and what may be between them."""

    usual: ClassVar[tuple[str, ...]] = ("face_width",)

    face_width: float = keys.length("width of the gear blank along its axis", above=0)
    web: Web | None = None
    holes: Holes | None = None


class MemberTable(PlaneFaces, GearBody):
    """A member between plane end faces."""


class Phi1(Table):
    """Positions of the pinion, evenly spaced; phi1 = 0 is defined by the kind."""

    usual: ClassVar[tuple[str, ...]] = ("start", "stop", "count")

    start: float = keys.angle(
        "first position", DERIVED_VALUE, low=-3600, high=3600, default="where a tooth pair begins contact"
    )
    stop: float = keys.angle("last position", DERIVED_VALUE, low=-3600, high=3600, default="where it ends contact")
    count: int = keys.count("number of positions", 21, low=1, high=1_000_000)


class ContactTable(Table):
    """Positions and marking compound of the contact analysis."""

    phi1: Phi1 = Phi1()
    delta: float = keys.length(
        "thickness of the marking compound: sets the size of the contact ellipses",
        DERIVED_VALUE,
        above=0,
        high=10,
        default="0.00635 mm, at most 0.01 modules",
        source="[LT02] 5",
    )


class FlankContact(ContactTable):
    """Contact analysis of members whose flanks are named right and left."""

    flank: str = keys.choice("working flank of the pinion; right is y < 0 of a tooth on +x", ("right", "left"), "right")


class MeshTable(Table):
    """Accuracy of the solids."""

    tolerance: float = keys.length(
        "largest distance to the exact surface", DERIVED_VALUE, low=1e-5, high=10, default="0.005 mm"
    )


class MaterialTable(Table):
    """Material of the members."""

    youngs_modulus: float = keys.pressure("Young's modulus", 206000.0, above=0)
    poisson_ratio: float = keys.number("Poisson's ratio", 0.3, low=0, high=0.499)
    density: float | None = keys.density(
        "density", None, above=0, high=50000, default=f"{STEEL_DENSITY_KG_PER_M3:g}, steel"
    )


class FiniteElementTable(Table):
    """Finite-element models: number of teeth, fineness, torque."""

    teeth: int = keys.count("teeth of each member; 0 = all", 3, low=0, high=99)
    torque: float = keys.torque("torque on the pinion", 100.0, above=0)
    order: int = keys.count("1: C3D8I, 2: C3D20R elements", 1, low=1, high=2)
    spacing: str = keys.choice(
        "mesh lines follow the contact ellipse, or are evenly spaced", ("contact", "even"), "contact"
    )
    ellipse: int = keys.count(
        "elements over each semi-axis of the contact ellipse; 0 = as the other keys allow", 0, low=0, high=64
    )
    rim: float | None = keys.length("rim under the root land", None, above=0, default="1.2 whole depths at most")
    body: str = keys.choice(
        "teeth on a rim alone, or on the whole body as it is turned: web, hubs, shafts, steps of the bore",
        ("rim", "whole"),
        "rim",
    )
    body_size: float | None = keys.length(
        "size of the elements of a whole body", None, above=0, default="0.6 whole depths"
    )
    flank: int = keys.count(
        "elements from fillet to tip; with an ellipse, of the teeth beside the leading one", 24, low=2, high=500
    )
    fillet: int = keys.count("elements from the middle of the root land to the flank", 11, low=3, high=500)
    thickness: int = keys.count(
        "elements from flank to the middle of the tooth, where ellipse does not determine them", 4, low=2, high=200
    )
    rim_layers: int = keys.count(
        "elements from the middle of the tooth's foot to the rim's inner face", 3, low=1, high=200
    )
    face: int = keys.count("elements from toe to heel, where ellipse does not determine them", 35, low=2, high=2000)


class UnloadedElementTable(FiniteElementTable):
    """Finite-element model of a member without a mating gear: no load, evenly spaced mesh lines."""

    absent: ClassVar[Mapping[str, str]] = dict.fromkeys(("torque", "ellipse"), "needs a mating gear: give both tables")

    spacing: str = keys.choice(
        "mesh lines are evenly spaced, as there is no contact to follow", ("contact", "even"), "even"
    )


class RexsSource(Table):
    """Stage of a REXS file that a design was read from; writing copies the attributes that the design has no keys for."""

    file: str = keys.file(
        "REXS file that the design was read from; its contents that a design cannot hold are written back"
    )
    stage: str = keys.text("id of the stage in it")


@dataclass(frozen=True)
class _Changed:
    """Overridden keys of a design; they do not count when designs are compared."""

    keys: tuple[str, ...] = field(default=(), compare=False)


class Design(Table):
    """A whole design file with the derived defaults filled in, read by `load` or written in Python key by key.

    Raises DesignError, one line with key, value and allowed values.
    """

    usual: ClassVar[tuple[str, ...]] = ("units", "name", "module", "backlash")
    exclusive: ClassVar[tuple[tuple[str, str], ...]] = (("diametral_pitch", "module"),)

    #: one line about the kind
    about: ClassVar[str] = ""
    #: name of such gears at the head of pages; the kind in words if empty
    called: ClassVar[str] = ""
    #: the kind; optional in Python, where the class tells it
    own_kind: ClassVar[str] = ""
    #: values of a new file of the kind: all required keys
    example: ClassVar[Mapping[str, Any]] = {}

    _changed: _Changed = PrivateAttr(default_factory=lambda: _Changed())

    kind: str = keys.text("gear system")
    gearmesh: str | None = keys.text(
        "version that the design was written for; defaults that have changed since are reported", None
    )
    units: str = keys.choice("unit of every length in the file", tuple(MM_PER), "mm")
    name: str | None = keys.text("title for reports and pictures", None)
    module: float | None = module_key("normal module", "given by diametral_pitch")
    diametral_pitch: float | None = pitch_key("normal diametral pitch, per inch in any units", "given by module")
    backlash: float = keys.length("normal backlash of the pair", 0.0, low=0)
    contact: ContactTable = ContactTable()
    mesh: MeshTable = MeshTable()
    material: MaterialTable = MaterialTable()
    fe: FiniteElementTable = FiniteElementTable()

    @model_validator(mode="after")
    def _right_kind(self) -> Self:
        """Refuse the kind of another class."""
        if self.own_kind and self.kind != self.own_kind:
            raise conflict("kind", self.kind, must_be=f'"{self.own_kind}" here')
        return self

    @model_validator(mode="after")
    def _known_version(self) -> Self:
        """Refuse a version that is no version, or newer than the program."""
        if self.gearmesh is not None and (why := unknown_version(self.gearmesh, __version__)):
            raise conflict("gearmesh", self.gearmesh, reason=why)
        return self

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        """Refuse a design without module and diametral pitch."""
        if self.module is None and self.diametral_pitch is None:
            raise conflict("module", None, reason=f"missing; give module ({self.units}) or diametral_pitch (1/inch)")
        return self

    def __init__(self, /, **keys: Any) -> None:
        """Validate, fill in the derived defaults, validate again."""
        keys.setdefault("kind", self.own_kind)
        mm_per_unit = MM_PER.get(str(keys.get("units", "mm")), 1.0)
        own, context = type(self), {"mm_per_unit": mm_per_unit}
        try:
            given = own.__new__(own)
            own.__pydantic_validator__.validate_python(keys, self_instance=given, context=context)
            complete = _fill(given.plain(), given.derived_values())
            own.__pydantic_validator__.validate_python(complete, self_instance=self, context=context)
            self._count_as_set(given)
        except ValidationError as error:
            raise explain(error, own, "inch" if mm_per_unit == MM_PER["inch"] else "mm", keys) from None

    @property
    def title(self) -> str:
        """Title of pages, sheets, drawings and files: the design's name, or kind, teeth and size: "Worm drive 2/38, m_x = 5 mm"."""
        if self.name:
            return self.name
        teeth = self._tooth_numbers
        count = f" {'/'.join(map(str, teeth))}" if len(teeth) > 1 else "".join(f", {one} teeth" for one in teeth)
        return f"{self.kind_in_words}{count}{self._size}"

    @property
    def kind_in_words(self) -> str:
        """Name of such gears."""
        return self.called or self.kind.replace("_", " ").capitalize()

    @property
    def _tooth_numbers(self) -> tuple[int, ...]:
        """Numbers of teeth or threads of the members, the pinion first."""
        tables = (getattr(self, name) for name in type(self).model_fields)
        return tuple(
            getattr(table, "threads", 0) or getattr(table, "teeth", 0)
            for table in tables
            if isinstance(table, MemberBody)
        )

    @property
    def _size_symbols(self) -> Mapping[str, str]:
        """Symbols of the keys that can give the size."""
        return {"module": "m_n", "diametral_pitch": "P_n"}

    @property
    def _size(self) -> str:
        """The size, by the key that gives it."""
        for key, symbol in self._size_symbols.items():
            if (value := getattr(self, key)) is not None:
                return f", {symbol} = {value:g} {'per inch' if key.endswith('pitch') else self.units}"
        return ""

    @property
    def changed_keys(self) -> tuple[str, ...]:
        """Dotted keys whose values override those of a file or of another design."""
        return self._changed.keys

    def with_changed_keys(self, keys: Iterable[str]) -> Self:
        """Return the same design with some keys marked as overridden.

        Parameters
        ----------
        keys : iterable of str
            Dotted keys.

        Returns
        -------
        Design
            Equal to this design.

        Examples
        --------
        >>> design.with_changed_keys(["module"]) == design
        True
        """
        self._changed = _Changed(tuple(keys))
        return self

    def _count_as_set(self, other: Table) -> None:
        super()._count_as_set(other)
        if isinstance(other, Design):
            self._changed = other._changed

    def _repr_html_(self) -> str:
        """Return the keys that the design sets as an HTML table, for notebooks."""
        kind = type(self)
        rows = [
            (dotted, value_text(value), "" if (key := kind.key_at(dotted)) is None else key.unit_in(self.units))
            for dotted, value in self.own()
        ]
        return html_table(self.title, ("key", "value", "unit"), rows)

    @property
    def keeps_from_crossing(self) -> str:
        """Remedy for flanks that cross at their point of tangency, in words for a warning; empty if the kind has none.

        Returns
        -------
        str
            Keys and the direction of their change.

        Examples
        --------
        >>> design.keeps_from_crossing
        ''
        """
        return ""

    @property
    def complete(self) -> bool:
        """True if every default is filled in."""
        plain = self.plain()
        return _finite_values(plain) == plain

    def derived_keys(self) -> Iterator[tuple[str, float]]:
        """Yield the keys whose defaults follow from other keys or from geometry.

        Returns
        -------
        iterator of (str, float)
            Dotted keys and their values in the design's units.

        Examples
        --------
        >>> all(isinstance(value, float) for key, value in design.derived_keys())
        True
        """
        yield from _derived_keys(self)

    def elastic(self, member: str) -> tuple[float, float]:
        """Return the elastic constants of a member: its own values, or those of the table material.

        Parameters
        ----------
        member : str
            Its name in the gear set.

        Returns
        -------
        (float, float)
            Young's modulus, MPa, and Poisson's ratio.

        Examples
        --------
        >>> design.elastic("pinion")
        (206000.0, 0.3)
        """
        own = getattr(self._member(member), "material", None)
        of_all = self.material.youngs_modulus, self.material.poisson_ratio
        if own is None:
            return of_all
        given = own.youngs_modulus, own.poisson_ratio
        modulus, ratio = (general if own is None else own for own, general in zip(given, of_all, strict=True))
        return modulus, ratio

    def given_density(self, member: str) -> float | None:
        """Return the density of a member, kg/m^3: its own, or that of the table material; None if neither is given.

        Parameters
        ----------
        member : str
            Its name in the gear set.

        Returns
        -------
        float or None
            kg/m^3 in a design in mm; without it the density is that of steel.

        Examples
        --------
        >>> print(design.given_density("pinion"))
        None
        """
        own = getattr(self._member(member), "material", None)
        return self.material.density if own is None or own.density is None else own.density

    def density(self, member: str) -> float:
        """Return the density of a member, kg/m^3; of steel if none is given.

        Parameters
        ----------
        member : str
            Its name in the gear set.

        Returns
        -------
        float
            kg/m^3.

        Examples
        --------
        >>> design.density("pinion")
        7850.0
        """
        given = self.given_density(member)
        return STEEL_DENSITY_KG_PER_M3 if given is None else given

    def mount(self, member: str) -> MemberMount:
        """Return the support of a member.

        Parameters
        ----------
        member : str
            Its name in the gear set.

        Returns
        -------
        MemberMount
            Keys of its shaft and bearings.

        Examples
        --------
        >>> type(design.mount("pinion")).__name__
        'MemberMount'
        """
        return getattr(self._member(member), "mount", None) or MemberMount()

    def _member(self, name: str) -> Any:
        """Return the table of a member by its name in the gear set."""
        return getattr(self, self.table_named(name), None)

    @staticmethod
    def table_named(member: str) -> str:
        """Return the name of the table of a member; numbered planets ("planet_1") share the table planet.

        Parameters
        ----------
        member : str
            Its name in the gear set.

        Returns
        -------
        str
            Name of a table.

        Examples
        --------
        >>> gm.PlanetaryDesign.table_named("planet_1")
        'planet'
        """
        return member.rstrip("0123456789").removesuffix("_")

    def sets(self, dotted: str) -> bool:
        """Return True if the design sets a key, False if the key is left to its default.

        Parameters
        ----------
        dotted : str
            The key, as "pinion.teeth".

        Returns
        -------
        bool
            False for derived values.

        Examples
        --------
        >>> design.sets("pinion.teeth"), design.sets("pressure_angle")
        (True, False)
        """
        return any(key == dotted for key, _ in self.own())

    def fill(self, derived: Mapping[str, float]) -> Self:
        """Return the design with values for keys that are still to be derived.

        Parameters
        ----------
        derived : mapping of str to float
            By dotted key, in the design's units, as `derived_values` returns them.

        Returns
        -------
        Design
            The values do not count as set.

        Examples
        --------
        >>> design.fill(design.derived_values()) == design
        True
        """
        made = type(self)(**_fill(self.plain(), derived))
        made._count_as_set(self)
        return made

    def with_values(self, values: Mapping[str, Any]) -> Self:
        """Return the design with other values of some keys; derived values stay, except those that the new values replace.

        Parameters
        ----------
        values : mapping of str to values
            By dotted key, in the design's units; None leaves a key out.

        Returns
        -------
        Design
            Validated anew.

        Raises
        ------
        DesignError
            As the class does; also for a key that the design sets and that one of `values` would replace.

        Examples
        --------
        >>> design.with_values({"pinion.teeth": 20}).pinion.teeth
        20
        """
        gone = tuple(key for key, value in values.items() if value is None)
        given = ((key, value) for key, value in values.items() if value is not None)
        try:
            stated = type(self)(**with_keys(self.stated(gone), given))
        except DesignError as refusal:
            raise refusal.facing(values) from None
        complete = stated.plain()
        for dotted, value in self.derived_keys():
            *tables, last = dotted.split(".")
            if dotted not in values and self.stays(dotted, values) and last in (table := _table(complete, tables)):
                table[last] = value
        made = type(self)(**_fill(complete, {}))
        made._count_as_set(stated)
        return made.with_changed_keys(values)

    def stays(self, dotted: str, values: Mapping[str, Any]) -> bool:
        """Return True if a derived value stays when other keys change; False if it would then be wrong.

        Parameters
        ----------
        dotted : str
            Key of the derived value.
        values : mapping of str to values
            New values by dotted key.

        Returns
        -------
        bool
            True for most values.

        Examples
        --------
        >>> design.stays("pinion.tool_tip_radius", {"name": "other"})
        True
        """
        return True

    def derived_values(self) -> dict[str, float]:
        """Return the defaults that follow from other keys.

        Returns
        -------
        dict of str to float
            By dotted key, in the file's units.

        Examples
        --------
        >>> isinstance(design.derived_values(), dict)
        True
        """
        mm = self.mm_per_unit
        return {
            "contact.phi1.start": -180.0 / self.counted_teeth,
            "contact.phi1.stop": 180.0 / self.counted_teeth,
            "contact.delta": min(DEFAULT_DELTA_MM / mm, MAX_DELTA_MODULES * self.given_module),
            "mesh.tolerance": 0.005 / mm,
        }

    @property
    def member_names(self) -> MemberNames | None:
        """Names of the members and pairs that are built of the design; None where they are not known before."""
        return None

    @property
    def counted_teeth(self) -> int:
        """Number of teeth of the member whose rotation is phi1: the pinion, unless the kind overrides this."""
        pinion: GearBody = getattr(self, "pinion")  # noqa: B009
        return pinion.teeth

    @property
    def mm_per_unit(self) -> float:
        """Length of the file's unit, mm."""
        return MM_PER[self.units]

    @property
    def given_module(self) -> float:
        """Module that sizes the kind, in the design's units."""
        if self.module is not None:
            return self.module
        assert self.diametral_pitch is not None
        return MM_PER["inch"] / self.mm_per_unit / self.diametral_pitch

    def in_mm(self) -> Self:
        """Return the same design with all lengths in mm.

        Returns
        -------
        Design
            With units = "mm".

        Examples
        --------
        >>> gm.load("samples/helical.toml", ["units=inch", "module=0.2", "pinion.face_width=2", "gear.face_width=2"]).in_mm().module
        5.08
        """
        if self.units == "mm":
            return self
        made = self.scale(self.mm_per_unit).model_copy(update={"units": "mm"})
        made._count_as_set(self)
        return made

    def resolve(self) -> dict[str, Any]:
        """Return the design as a plain dict, every default filled in, in its own units.

        Returns
        -------
        dict of str to values
            The dict loads back to the same design.

        Examples
        --------
        >>> gm.parse(design.resolve()).pinion == design.pinion
        True
        """
        return self.plain()

    @classmethod
    def key_lines(cls) -> Iterator[KeyLine]:
        """Yield all keys of the kind in the order of the file.

        Returns
        -------
        iterator of KeyLine
            Key, unit, allowed range, default, meaning and source.

        Examples
        --------
        >>> next(gm.HypoidDesign.key_lines()).key
        'kind'
        """
        return key_lines(cls)

    @classmethod
    def usual_keys(cls) -> tuple[str, ...]:
        """Return the keys that most designs of the kind set.

        Returns
        -------
        tuple of str
            Dotted keys in the order of the file: required keys, keys of the example, and keys that are usual in designs.

        Examples
        --------
        >>> "pinion.bore" in gm.CylindricalDesign.usual_keys()
        True
        """
        return tuple(usual_keys(cls, {"kind": cls.own_kind, **cls.example}))

    @classmethod
    def key_groups(cls) -> dict[str, list[KeyLine]]:
        """Return all keys of the kind; tables that occur in several places are listed once.

        Returns
        -------
        dict of str to list of KeyLine
            By title of the table; the kind's own keys under "".

        Examples
        --------
        >>> next(iter(gm.HypoidDesign.key_groups()))
        ''
        """
        apart: dict[str, type[Table]] = {}
        own = list(key_lines(cls, apart=apart))
        return {"": own} | {name: list(key_lines(table)) for name, table in apart.items()}


class PairDesign(Design):
    """A design of two members, pinion and gear."""

    pinion: GearBody
    gear: GearBody
    measured: PairMeasured | None = None

    @property
    def member_names(self) -> MemberNames | None:
        """Pinion and gear, which mesh."""
        return MemberNames((("pinion", "gear"),))


def _positive_definite(rows: Sequence[Any]) -> bool:
    """True if a matrix is positive definite, and symmetric to 1e-9 of its diagonal."""
    import numpy as np

    given = np.array(rows, dtype=float)
    size = np.sqrt(np.maximum(np.diag(given), np.finfo(float).tiny))
    even = given / np.outer(size, size)
    return bool(np.allclose(even, even.T, rtol=0.0, atol=1e-9) and np.linalg.eigvalsh(even)[0] > 0.0)


def _derived_keys(table: Table, prefix: str = "") -> Iterator[tuple[str, float]]:
    """Yield the dotted keys, and their values, whose default is derived."""
    for name in table.names():
        value, default = getattr(table, name), type(table).model_fields[name].default
        if isinstance(value, Table):
            yield from _derived_keys(value, f"{prefix}{name}.")
        elif isinstance(default, float) and math.isnan(default):
            yield prefix + name, value


def _fill(complete: dict[str, Any], derived: Mapping[str, float]) -> dict[str, Any]:
    """Return a plain design with derived values for keys without a value; keys without any value are left out."""
    for dotted, value in derived.items():
        *tables, last = dotted.split(".")
        table = _table(complete, tables)
        if math.isnan(table.get(last, math.nan)):
            table[last] = value
    return _finite_values(complete)


def _finite_values(table: dict[str, Any]) -> dict[str, Any]:
    """Return a table without the keys that are NaN."""
    return {
        key: _finite_values(value) if isinstance(value, dict) else value
        for key, value in table.items()
        if not (isinstance(value, float) and math.isnan(value))
    }


def _table(table: dict[str, Any], path: list[str]) -> dict[str, Any]:
    """Return the table at a path of names; empty if there is none."""
    for name in path:
        table = table.get(name, {})
    return table
