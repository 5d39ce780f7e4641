"""What a design file may say: typed keys with units and ranges, and the base of all designs.

A `Table` is a table of the file, a `Design` the whole file; every field carries a `Key` that knows its unit, range,
default and source. Numbers stay in the file's `units` and degrees until `Design.in_mm`.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, ValidationError, ValidationInfo, model_validator
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from gearmesh.design.explain import explain, shown
from gearmesh.errors import DesignError

MM_PER = {"mm": 1.0, "inch": 25.4}

#: Value of a field whose default follows from other keys, until `Design.derived` fills it in.
DERIVED = math.nan

#: Longest length that makes sense, mm.
LONGEST = 1e6

Unit = Literal[
    "length", "angle", "count", "number", "coefficient", "pitch", "pressure", "torque", "choice", "text", "flag"
]

_NOUN = {
    "length": "a length in {units}",
    "angle": "an angle in deg",
    "count": "a whole number",
    "number": "a number",
    "coefficient": "a multiple of the normal module",
    "pitch": "a number per inch",
    "pressure": "a stress in MPa",
    "torque": "a torque in Nm",
}


@dataclass(frozen=True)
class Key:
    """Meaning of one key: unit, one line about it, range (lengths in mm, angles in deg) and source.

    `above` leaves `low` itself out of the range; `default` says in words what a left-out key means.
    """

    unit: Unit
    about: str
    low: float = -math.inf
    high: float = math.inf
    above: bool = False
    default: str = ""
    source: str = ""
    choices: tuple[str, ...] = ()

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        optional = type(None) in get_args(source)

        def check(value: Any, info: ValidationInfo) -> Any:
            if value is None and optional:
                return None
            return self.checked(value, (info.context or {}).get("mm_per_unit", 1.0))

        return core_schema.with_info_plain_validator_function(check)

    def allowed(self, units: str) -> str:
        """What the key accepts, in words, lengths in `units`."""
        if self.unit == "choice":
            return "one of " + ", ".join(f'"{choice}"' for choice in self.choices)
        if self.unit == "text":
            return "a text of at most 80 printable characters"
        if self.unit == "flag":
            return "true or false"
        low, high = (f"{bound / self._factor(MM_PER[units]):.7g}" for bound in self._bounds)
        limits = f"above {low} and up to {high}" if self.above else f"from {low} to {high}"
        return f"{_NOUN[self.unit].format(units=units)} {limits}"

    @property
    def range(self) -> str:
        """The range in short: choices, or limits with lengths in mm."""
        if self.unit in ("choice", "text", "flag"):
            return " | ".join(self.choices)
        unit = " mm" if self.unit == "length" else ""
        low = f"{'>' if self.above else '>='} {self.low:g}" if math.isfinite(self.low) else "any"
        if not math.isfinite(self.high):
            return low
        return f"{low}, <= {self.high:.7g}{unit}" if self.above else f"{self.low:g} .. {self.high:.7g}{unit}"

    def checked(self, value: Any, mm_per_unit: float) -> Any:
        """`value` as the key's type, or PydanticCustomError "refused"."""
        if self.unit == "choice":
            good = isinstance(value, str) and value in self.choices
        elif self.unit == "text":
            good = isinstance(value, str) and len(value) <= 80 and value.isprintable()
        elif self.unit == "flag":
            good = isinstance(value, bool)
        else:
            return self._number(value, self._factor(mm_per_unit))
        if not good:
            raise _REFUSED
        return value

    def _number(self, value: Any, factor: float) -> float | int:
        if isinstance(value, bool) or not isinstance(value, numbers.Real):
            raise _REFUSED
        try:
            number = float(value)
        except OverflowError:
            raise _REFUSED from None
        low, high = self._bounds
        inside = low < number * factor <= high if self.above else low <= number * factor <= high
        if not inside or (self.unit == "count" and not number.is_integer()):
            raise _REFUSED
        return int(number) if self.unit == "count" else number

    def _factor(self, mm_per_unit: float) -> float:
        return mm_per_unit if self.unit == "length" else 1.0

    @property
    def _bounds(self) -> tuple[float, float]:
        return max(self.low, -LONGEST), min(self.high, LONGEST)


_REFUSED = PydanticCustomError("refused", "value not allowed")


def conflict(key: str, value: Any, why: str) -> PydanticCustomError:
    """Error of a key that is good alone but not beside the others; `key` is relative to the table that raises it."""
    given = key if value is None else f"{key} = {shown(value)}"
    return PydanticCustomError("conflict", "{given}: {why}", {"given": given, "why": why})


class Table(BaseModel):
    """A table of a design file: immutable, and nothing in it but the declared keys."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    #: Pairs (first, second): a given `first` replaces `second`, and only one of them may be given.
    replaces: ClassVar[tuple[tuple[str, str], ...]] = ()

    @model_validator(mode="after")
    def _not_together(self) -> Self:
        for first, second in self.replaces:
            if getattr(self, first) is not None and second in self.model_fields_set:
                raise conflict(first, getattr(self, first), f"cannot be given together with {second}")
        return self

    @classmethod
    def names(cls) -> list[str]:
        """The names of the fields, plain keys before tables."""
        return sorted(cls.model_fields, key=lambda name: cls.table_of(name) is not None)

    @classmethod
    def key_of(cls, name: str) -> Key | None:
        """The `Key` of a field, None for a table."""
        return next((m for m in cls.model_fields[name].metadata if isinstance(m, Key)), None)

    @classmethod
    def table_of(cls, name: str) -> type[Table] | None:
        """The class of the table behind a field, None for a plain key."""
        annotation = cls.model_fields[name].annotation
        for candidate in (annotation, *get_args(annotation)):
            if isinstance(candidate, type) and issubclass(candidate, Table):
                return candidate
        return None

    def scaled(self, factor: float) -> Self:
        """The same table with all lengths multiplied."""
        changed: dict[str, Any] = {}
        for name in type(self).model_fields:
            value, key = getattr(self, name), self.key_of(name)
            if isinstance(value, Table):
                changed[name] = value.scaled(factor)
            elif key is not None and key.unit == "length" and value is not None:
                changed[name] = value * factor
        return self.model_copy(update=changed)

    def plain(self) -> dict[str, Any]:
        """The table as a plain dict that loads back to it, with defaults filled in; what is absent has none."""
        replaced = {second for first, second in self.replaces if getattr(self, first) is not None}
        values = {name: getattr(self, name) for name in self.names() if name not in replaced}
        return {
            name: value.plain() if isinstance(value, Table) else value
            for name, value in values.items()
            if value is not None
        }


class Keyway(Table):
    """Keyway in the bore."""

    width: Annotated[float, Key("length", "width", low=0, above=True)]
    depth: Annotated[float, Key("length", "depth below the bore's surface", low=0, above=True)]


class Hub(Table):
    """Hub beyond the end face."""

    diameter: Annotated[float, Key("length", "outer diameter", low=0, above=True)]
    length: Annotated[float, Key("length", "length beyond the end face", low=0, above=True)]


class GearBody(Table):
    """What every toothed member has."""

    teeth: Annotated[int, Key("count", "number of teeth", low=3, high=10000)]
    bore: Annotated[
        float | None,
        Key("length", "bore diameter; 0 = no bore", low=0, default="40 % of the root diameter at the small end"),
    ] = None
    keyway: Keyway | None = None
    hub: Hub | None = None

    @model_validator(mode="after")
    def _shaft(self) -> Self:
        if self.bore is None:
            return self
        if self.keyway is not None and self.keyway.width >= self.bore:
            raise conflict("keyway.width", self.keyway.width, f"must be smaller than the bore, {self.bore:g}")
        if self.hub is not None and self.hub.diameter <= self.bore:
            raise conflict("hub.diameter", self.hub.diameter, f"must be larger than the bore, {self.bore:g}")
        return self


class Member(GearBody):
    """A member between plane end faces."""

    face_width: Annotated[float, Key("length", "width of the gear blank along its axis", low=0, above=True)]
    tip_chamfer: Annotated[float | None, Key("length", "45 deg chamfer between flank and top land", low=0)] = None
    tip_rounding: Annotated[float | None, Key("length", "rounding between flank and top land", low=0)] = None

    @model_validator(mode="after")
    def _tip(self) -> Self:
        if self.tip_chamfer and self.tip_rounding:
            raise conflict("tip_rounding", self.tip_rounding, "cannot be given together with tip_chamfer")
        return self


class Phi1(Table):
    """Positions of the pinion, evenly spaced, counted as the source counts them."""

    start: Annotated[float, Key("angle", "first position", low=-3600, high=3600, default="-180 / pinion.teeth")] = (
        DERIVED
    )
    stop: Annotated[float, Key("angle", "last position", low=-3600, high=3600, default="180 / pinion.teeth")] = DERIVED
    count: Annotated[int, Key("count", "number of positions", low=1, high=1_000_000)] = 21


class Contact(Table):
    """Which contact is asked for."""

    phi1: Phi1 = Phi1()
    delta: Annotated[
        float,
        Key(
            "length",
            "thickness of the marking compound: sets the size of the contact ellipses",
            low=0,
            high=10,
            above=True,
            default="0.00635 mm",
            source="[LT02] 5",
        ),
    ] = DERIVED


class FlankContact(Contact):
    """Contact of members whose flanks have no other names than right and left."""

    flank: Annotated[
        str, Key("choice", "flank of the pinion that works; right is y < 0 of a tooth on +x", choices=("right", "left"))
    ] = "right"


class Mesh(Table):
    """How fine the solids are."""

    tolerance: Annotated[
        float,
        Key("length", "largest distance to the exact surface", low=1e-5, high=10, default="0.005 mm"),
    ] = DERIVED


class Material(Table):
    """What both members are made of."""

    youngs_modulus: Annotated[float, Key("pressure", "Young's modulus", low=0, above=True)] = 206000.0
    poisson_ratio: Annotated[float, Key("number", "Poisson's ratio", low=0, high=0.499)] = 0.3


class FiniteElements(Table):
    """Finite-element models: how many teeth, how fine, under which torque."""

    teeth: Annotated[int, Key("count", "teeth of each member; 0 = all", low=0, high=99)] = 3
    torque: Annotated[float, Key("torque", "torque on the pinion", low=0, above=True)] = 100.0
    order: Annotated[int, Key("count", "1: C3D8I, 2: C3D20R elements", low=1, high=2)] = 1
    ellipse: Annotated[
        int, Key("count", "elements over each half axis of the contact ellipse; 0 = even spacing", low=0, high=64)
    ] = 0
    rim: Annotated[
        float | None, Key("length", "rim under the root land", low=0, above=True, default="1.2 whole depths at most")
    ] = None
    flank: Annotated[int, Key("count", "least elements from fillet to tip", low=2, high=500)] = 16
    fillet: Annotated[int, Key("count", "elements from the middle of the root land to the flank", low=3, high=500)] = 10
    thickness: Annotated[int, Key("count", "least elements from flank to the middle of the tooth", low=2, high=200)] = 4
    under: Annotated[int, Key("count", "elements from there to the rim's inner face", low=1, high=200)] = 3
    face: Annotated[int, Key("count", "least elements from toe to heel", low=2, high=2000)] = 45


class Design(Table):
    """A whole design file; `gearmesh.design.load` and `parse` build one with the derived defaults filled in."""

    #: One line about the kind.
    about: ClassVar[str] = ""

    kind: Annotated[str, Key("text", "gear system")]
    units: Annotated[str, Key("choice", "unit of every length in the file", choices=tuple(MM_PER))] = "mm"
    name: Annotated[str | None, Key("text", "title for reports and pictures")] = None
    module: Annotated[
        float | None, Key("length", "normal module", low=0, above=True, default="given by diametral_pitch")
    ] = None
    diametral_pitch: Annotated[
        float | None,
        Key("pitch", "normal diametral pitch, per inch in any units", low=0, above=True, default="given by module"),
    ] = None
    backlash: Annotated[float, Key("length", "normal backlash of the pair", low=0)] = 0.0
    pinion: GearBody
    gear: GearBody
    contact: Contact = Contact()
    mesh: Mesh = Mesh()
    material: Material = Material()
    fe: FiniteElements = FiniteElements()

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        if self.module is None and self.diametral_pitch is None:
            raise conflict("module", None, f"missing; give module ({self.units}) or diametral_pitch (1/inch)")
        if self.module is not None and self.diametral_pitch is not None:
            raise conflict("diametral_pitch", self.diametral_pitch, "cannot be given together with module")
        return self

    @classmethod
    def from_mapping(cls, mapping: Mapping[str, Any]) -> Self:
        """Validate, fill in what is derived, validate again; DesignError with one line for whatever is wrong."""
        mm_per_unit = MM_PER.get(str(mapping.get("units", "mm")), 1.0)
        context = {"mm_per_unit": mm_per_unit}
        try:
            design = cls.model_validate(dict(mapping), context=context)
            complete = design.plain()
            for dotted, value in design.derived().items():
                _fill(complete, dotted.split("."), value)
            return cls.model_validate(complete, context=context)
        except ValidationError as error:
            raise DesignError(explain(error, cls, "inch" if mm_per_unit == MM_PER["inch"] else "mm")) from None

    def derived(self) -> dict[str, float]:
        """Defaults that follow from other keys, by dotted key, in the file's units."""
        mm = MM_PER[self.units]
        return {
            "contact.phi1.start": -180.0 / self.pinion.teeth,
            "contact.phi1.stop": 180.0 / self.pinion.teeth,
            "contact.delta": 0.00635 / mm,
            "mesh.tolerance": 0.005 / mm,
        }

    @property
    def mm_per_unit(self) -> float:
        """Length of the file's unit, mm."""
        return MM_PER[self.units]

    @property
    def given_module(self) -> float:
        """The module that the kind is sized by, in the design's units."""
        if self.module is not None:
            return self.module
        assert self.diametral_pitch is not None
        return MM_PER["inch"] / MM_PER[self.units] / self.diametral_pitch

    def in_mm(self) -> Self:
        """The same design with all lengths in mm."""
        if self.units == "mm":
            return self
        return self.scaled(MM_PER[self.units]).model_copy(update={"units": "mm"})

    def resolved(self) -> dict[str, Any]:
        """The design as a plain dict, every default filled in, in its own units; it loads back to the same design."""
        return self.plain()

    @classmethod
    def key_lines(cls) -> Iterator[KeyLine]:
        """Every key of the kind, in the order of the file."""
        return _lines(cls, "", "")


@dataclass(frozen=True)
class KeyLine:
    """One key as `gearmesh describe` prints it; all texts."""

    key: str
    unit: str
    range: str
    default: str
    about: str
    source: str


_UNIT_TEXT = {
    "length": "mm|inch",
    "angle": "deg",
    "coefficient": "m_n",
    "pitch": "1/inch",
    "number": "-",
    "pressure": "MPa",
    "torque": "Nm",
}


def _lines(table: type[Table], prefix: str, optional: str) -> Iterator[KeyLine]:
    for name in table.names():
        field, below, key = table.model_fields[name], table.table_of(name), table.key_of(name)
        if below is not None:
            yield from _lines(below, f"{prefix}{name}.", name if field.default is None else optional)
        elif key is not None:
            if field.is_required():
                default = f"required with {optional}" if optional else "required"
            else:
                default = key.default or _default_text(field.default)
            yield KeyLine(
                key=prefix + name,
                unit=_UNIT_TEXT.get(key.unit, key.unit),
                range=key.range,
                default=default,
                about=key.about,
                source=key.source,
            )


def _default_text(default: Any) -> str:
    if default is None:
        return "none"
    if isinstance(default, bool):
        return str(default).lower()
    return str(default) if isinstance(default, str) else f"{default:g}"


def _fill(table: dict[str, Any], path: list[str], value: float) -> None:
    *tables, last = path
    for name in tables:
        table = table[name]
    if math.isnan(table[last]):
        table[last] = value
