"""Keys of a design file with unit, range and default; tables of keys; the list of all keys.

Every field of a `Table` has a `Key` with its unit, range, default and source, which one constructor a unit makes:
`bore: float | None = keys.length("bore diameter", None, low=0)`. Numbers stay in the file's `units` and in
degrees. A length may also be a text with a unit, "15um"; it becomes a number in the file's unit.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from functools import cache
from typing import Any, ClassVar, Literal, Self, get_args

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, ValidationInfo, model_validator
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from gearmesh import lengths
from gearmesh.design.shown import value_text
from gearmesh.errors import DesignError
from gearmesh.records import dataclass

#: mm in each unit of lengths that a file may have
MM_PER = {unit: float(lengths.MM_PER_UNIT[unit]) for unit in ("mm", "inch")}

#: value of a field whose default follows from other keys, until `Design.derived_values` fills it in
DERIVED_VALUE = math.nan

#: word in a stiffness for a direction in which a mount is rigid; inf means the same
RIGID_WORD = "rigid"

#: largest length
LARGEST_LENGTH_MM = 1e6
#: smallest length above 0 of keys that cannot be negative, a hundredth of an atom
SMALLEST_LENGTH_MM = 1e-9
#: smallest size of any other number but 0: sweeps through 0 give 1e-17, and products of ten such numbers do not underflow
SMALLEST_NUMBER = 1e-30

Unit = Literal[
    "length",
    "curvature",
    "turn per square length",
    "angle",
    "count",
    "number",
    "coefficient",
    "axial coefficient",
    "pitch",
    "pressure",
    "torque",
    "density",
    "stiffness",
    "choice",
    "text",
    "file",
    "flag",
]

#: power of the unit of length in each unit; 0 for the others
_LENGTH_POWERS: dict[Unit, int] = {"length": 1, "curvature": -1, "turn per square length": -2}

#: words for a value of each unit
_UNIT_NOUNS = {
    "length": "a length in {units}",
    "curvature": "a number in 1/{units}",
    "turn per square length": "a number in rad/{units}^2",
    "angle": "an angle in deg",
    "count": "a whole number",
    "number": "a number",
    "coefficient": "a multiple of the normal module",
    "axial coefficient": "a multiple of the axial module",
    "pitch": "a number per inch",
    "pressure": "a stress in MPa",
    "torque": "a torque in Nm",
    "density": "a density in kg/m^3",
}


@dataclass(frozen=True)
class Key:
    """Meaning of one key: unit, one line about it, range, default and source."""

    #: unit of the value
    unit: Unit
    #: one line about the key
    about: str
    #: least allowed value; lengths in mm, angles in deg
    low: float = -math.inf
    #: greatest allowed value
    high: float = math.inf
    #: True if `low` itself is not allowed
    above: bool = False
    #: default in words, if the field's default does not tell it
    default: str = ""
    #: source of the definition
    source: str = ""
    #: allowed texts of a key of the unit "choice"
    choices: tuple[str, ...] = ()
    #: 0 for a single value; else the value is a list of at most so many numbers, each in the range
    most: int = 0

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        optional = type(None) in get_args(source)

        def check(value: Any, info: ValidationInfo) -> Any:
            if value is None and optional:
                return None
            return self.check(value, (info.context or {}).get("mm_per_unit", 1.0))

        return core_schema.with_info_plain_validator_function(check)

    def unit_in(self, units: str) -> str:
        """Return the unit of the key in a design file whose lengths are in `units`, "mm" or "inch"; "" for none."""
        return _UNIT_TEXTS.get(self.unit, "").split("|")[-1 if units == "inch" else 0]

    def allowed_values(self, units: str) -> str:
        """Return the allowed values of the key, in words, for a file whose lengths are in `units`, "mm" or "inch"."""
        if self.unit == "choice":
            return "one of " + ", ".join(f'"{choice}"' for choice in self.choices)
        if self.unit == "text":
            return "a text of at most 80 printable characters"
        if self.unit == "file":
            return "the name of a file"
        if self.unit == "flag":
            return "true or false"
        if self.unit == "stiffness":
            return f"6 numbers above 0 or {value_text(RIGID_WORD)}, in {_UNIT_TEXTS['stiffness']}, or 6 rows of 6 finite numbers"
        low, high = (f"{bound / self._factor(MM_PER[units]):.7g}" for bound in self._bounds)
        limits = f"above {low} and up to {high}" if self.above else f"from {low} to {high}"
        if self.most:
            return f"a list of up to {self.most} values, each {_UNIT_NOUNS[self.unit].format(units=units)} {limits}"
        return f"{_UNIT_NOUNS[self.unit].format(units=units)} {limits}"

    @property
    def is_numeric(self) -> bool:
        """True if values are single numbers."""
        return not self.most and self.unit not in ("choice", "text", "file", "flag", "stiffness")

    @property
    def with_unit(self) -> str:
        """Words for a length with its unit, which such a key also accepts; empty for other keys."""
        return f", or a length with its unit, as {lengths.LENGTH_EXAMPLES}" if self.power == 1 else ""

    def least(self, units: str) -> str:
        """Return the smallest size of a value but 0, in words, for the refusal of a smaller number; `units` as in
        `unit_in`."""
        zero = "" if self.above and self.low == 0.0 else "0 or "
        return f"; {zero}at least {self._least / self._factor(MM_PER[units]):.7g} in size"

    @property
    def range(self) -> str:
        """Range in short: choices, or limits with lengths in mm."""
        if self.unit in ("choice", "text", "file", "flag"):
            return " | ".join(self.choices)
        if self.unit == "stiffness":
            return f"6 numbers > 0 or {RIGID_WORD}, or 6 rows of 6"
        if self.most:
            return f"list of up to {self.most}"
        unit = " mm" if self.unit == "length" else ""
        low = f"{'>' if self.above else '>='} {self.low:g}" if math.isfinite(self.low) else "any"
        if not math.isfinite(self.high):
            return low
        return f"{low}, <= {self.high:.7g}{unit}" if self.above else f"{self.low:g} .. {self.high:.7g}{unit}"

    def check(self, value: Any, mm_per_unit: float) -> Any:
        """Return a value as the key's type, with lengths in mm.

        - value: a number, a length with its unit, or a value of the key's other types.
        - mm_per_unit: length (mm) of the file's unit.

        Raises PydanticCustomError of the type "refused" for a value that is not allowed.
        """
        if self.most:
            if not isinstance(value, (list, tuple)) or len(value) > self.most:
                raise _REFUSED_ERROR
            return tuple(replace(self, most=0).check(item, mm_per_unit) for item in value)
        if self.unit == "choice":
            good = isinstance(value, str) and value in self.choices
        elif self.unit == "text":
            good = isinstance(value, str) and len(value) <= 80 and value.isprintable()
        elif self.unit == "file":
            good = isinstance(value, str) and value != "" and value.isprintable()
        elif self.unit == "flag":
            good = isinstance(value, bool)
        elif self.unit == "stiffness":
            return _stiffness(value)
        else:
            if self.power == 1 and isinstance(value, str):
                value = lengths.length(value, "mm" if mm_per_unit == MM_PER["mm"] else "inch")
            return self._number(value, self._factor(mm_per_unit))
        if not good:
            raise _REFUSED_ERROR
        return value

    def _number(self, value: Any, factor: float) -> float | int:
        if isinstance(value, bool) or not isinstance(value, numbers.Real):
            raise _REFUSED_ERROR
        try:
            number = float(value)
        except OverflowError:
            raise _REFUSED_ERROR from None
        low, high = self._bounds
        inside = low < number * factor <= high if self.above else low <= number * factor <= high
        if not inside or (self.unit == "count" and not number.is_integer()):
            raise _REFUSED_ERROR
        if number and abs(number * factor) < self._least:
            raise _TOO_SMALL_ERROR
        return int(number) if self.unit == "count" else number

    def _factor(self, mm_per_unit: float) -> float:
        return mm_per_unit**self.power

    @property
    def power(self) -> int:
        """Power of the file's unit of length in the key's unit."""
        return _LENGTH_POWERS.get(self.unit, 0)

    @property
    def _least(self) -> float:
        return SMALLEST_LENGTH_MM if self.power == 1 and self.low >= 0.0 else SMALLEST_NUMBER

    @property
    def _bounds(self) -> tuple[float, float]:
        return max(self.low, -LARGEST_LENGTH_MM), min(self.high, LARGEST_LENGTH_MM)


@dataclass(frozen=True)
class Quantity:
    """Constructor of the keys of one unit: `width: float | None = keys.length("width", None, above=0)`."""

    unit: Unit

    def __call__(
        self,
        about: str,
        value: Any = ...,
        *,
        low: float = -math.inf,
        above: float | None = None,
        high: float = math.inf,
        default: str = "",
        source: str = "",
        most: int = 0,
    ) -> Any:
        """Return the field of a table with its key.

        - about: one line about the key.
        - value: value of a key that is left out; without it the key is required.
        - low, high: least and greatest allowed value; lengths in mm, angles in deg.
        - above: in the place of low, a limit that is not allowed itself.
        - default, source, most: as in `Key`.
        """
        least = low if above is None else above
        return _field(
            Key(self.unit, about, least, high, above is not None, default=default, source=source, most=most), value
        )


length = Quantity("length")
curvature = Quantity("curvature")
turn_per_square_length = Quantity("turn per square length")
angle = Quantity("angle")
count = Quantity("count")
number = Quantity("number")
coefficient = Quantity("coefficient")
axial_coefficient = Quantity("axial coefficient")
pitch = Quantity("pitch")
pressure = Quantity("pressure")
torque = Quantity("torque")
density = Quantity("density")
stiffness = Quantity("stiffness")
text = Quantity("text")
file = Quantity("file")
flag = Quantity("flag")


def choice(about: str, choices: tuple[str, ...], value: Any = ..., *, default: str = "", source: str = "") -> Any:
    """Return the field of a key with some allowed texts; the other arguments are those of `Quantity`."""
    return _field(Key("choice", about, choices=choices, default=default, source=source), value)


def _field(key: Key, value: Any) -> Any:
    """Return the field of a table whose value is `value` where the key is left out."""
    field = Field(default=value)
    field.metadata.append(key)
    return field


_REFUSED_ERROR = PydanticCustomError("refused", "value not allowed")
_TOO_SMALL_ERROR = PydanticCustomError("too_small", "value too near to 0")


def _stiffness(value: Any) -> tuple[Any, ...]:
    """Return the diagonal of a stiffness, numbers above 0 or `RIGID_WORD`, or its 6 rows. Raises PydanticCustomError."""
    if not isinstance(value, (list, tuple)) or len(value) != 6:
        raise _REFUSED_ERROR
    if all(isinstance(row, (list, tuple)) and len(row) == 6 for row in value):
        return tuple(tuple(_finite(entry) for entry in row) for row in value)
    diagonal = tuple(RIGID_WORD if entry in (RIGID_WORD, math.inf) else _finite(entry) for entry in value)
    if any(isinstance(entry, float) and entry <= 0.0 for entry in diagonal):
        raise _REFUSED_ERROR
    return diagonal


def _finite(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise _REFUSED_ERROR
    return float(value)


def given_or(value: float, otherwise: float) -> float:
    """Return `value`, or `otherwise` while `value` is still to be derived."""
    return otherwise if math.isnan(value) else value


def conflict(
    key: str,
    value: Any,
    *,
    reason: str = "",
    allowed: str = "",
    must_be: str = "",
    other: tuple[str, Any, str] | None = None,
) -> PydanticCustomError:
    """Return the error of a key whose value does not go with other keys.

    - key: relative to the table that raises the error.
    - other: the same conflict as a refusal of the other key: this key, its value, and what it must be.

    The other arguments are those of `GearmeshError`.
    """
    fields = {"key": key, "value": value, "reason": reason, "allowed": allowed, "must_be": must_be, "other": other}
    return PydanticCustomError("conflict", "{key}", fields)


#: types of most keys, by their texts in annotations: pydantic would compile the text of each key
_KNOWN_TYPES: dict[str, Any] = {
    "float": float,
    "float | None": float | None,
    "int": int,
    "int | None": int | None,
    "str": str,
    "str | None": str | None,
    "bool": bool,
    "bool | None": bool | None,
    "tuple[float, ...]": tuple[float, ...],
}


def _know_types(table: type[BaseModel]) -> None:
    """Replace texts in the annotations of a table by their types; pydantic compiles those of class variables in each subclass."""
    own = table.__annotations__
    for name, text in own.items():
        if isinstance(text, str):
            own[name] = ClassVar if text.startswith("ClassVar") else _KNOWN_TYPES.get(text, text)


class Table(BaseModel):
    """A table of a design file: immutable, with the declared keys alone."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    #: pairs (first, second): a given `first` replaces `second`, and only one of them may be given
    replaces: ClassVar[tuple[tuple[str, str], ...]] = ()
    #: pairs (key, other), dotted where they are in tables below: only one of them may be given; 0 counts as left out. Each
    #: class names those that it declares, as in `needs`
    exclusive: ClassVar[tuple[tuple[str, str], ...]] = ()
    #: keys that have an effect with another one only: (key, other, that other in words)
    needs: ClassVar[tuple[tuple[str, str, str], ...]] = ()
    #: keys that the tables of other designs have and this table has not, with the reason
    absent: ClassVar[Mapping[str, str]] = {}
    #: keys whose sign has a meaning for the table, as negative teeth of an internal gear
    signed: ClassVar[tuple[str, ...]] = ()
    #: keys that most designs set; each class names those that it declares
    usual: ClassVar[tuple[str, ...]] = ()
    #: place in a file: tables of lower rank come first
    rank: ClassVar[int] = 1
    #: title of the list of keys of a table that occurs in several places; empty: its keys are listed at each place
    listed_apart: ClassVar[str] = ""
    #: names in texts of the tables of a design that is part of another design
    other_names: ClassVar[Mapping[str, str]] = {}

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        _know_types(cls)

    @classmethod
    def name_in_texts(cls, dotted: str) -> str:
        """Return the name in texts of a table or a dotted key.

        Parameters
        ----------
        dotted : str
            The table or key.

        Returns
        -------
        str
            Name in texts.

        Examples
        --------
        >>> gm.CylindricalDesign.name_in_texts("pinion.teeth")
        'pinion.teeth'
        """
        head, dot, rest = dotted.partition(".")
        return cls.other_names.get(head, head) + dot + rest

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse to change a key, in one line; private attributes may change."""
        if name not in type(self).model_fields:
            return super().__setattr__(name, value)
        raise DesignError(
            name,
            value,
            reason="a design does not change; with_values({key: value}) makes another one with other values",
        )

    @model_validator(mode="before")
    @classmethod
    def _not_absent(cls, keys: Any) -> Any:
        """Refuse the keys of `absent`, with their reasons."""
        for name, why in cls.absent.items() if isinstance(keys, Mapping) else ():
            if name in keys:
                raise conflict(name, None, reason=why)
        return keys

    @model_validator(mode="after")
    def _not_together(self) -> Self:
        """Refuse both keys of a pair of `replaces` or `exclusive`, and a key without the one that it needs."""
        for first, second in self.replaces:
            if getattr(self, first) is not None and second in self.model_fields_set:
                raise conflict(first, getattr(self, first), reason=f"cannot be given together with {second}")
        for key, other in _declared(type(self), "exclusive"):
            if (value := self._at(key)) and self._at(other):
                shown = None if isinstance(value, Table) else value
                raise conflict(key, shown, reason=f"cannot be given together with {other}")
        for key, other, words in _declared(type(self), "needs"):
            if (value := self._at(key)) is not None and self._at(other) in (
                None,
                type(self).model_fields[other].default,
            ):
                raise conflict(key, value, reason=f"needs {words}")
        return self

    def _at(self, dotted: str) -> Any:
        """Return the value of a dotted key; None in a table that is left out."""
        value: Any = self
        for name in dotted.split("."):
            value = getattr(value, name, None)
        return value

    @classmethod
    def names(cls) -> list[str]:
        """Return the names of the fields, plain keys before tables, and tables by their rank.

        Returns
        -------
        list of str
            In the order of a file.

        Examples
        --------
        >>> gm.CylindricalDesign.names()[0]
        'kind'
        """
        return list(_names(cls))

    @classmethod
    def key_of(cls, name: str) -> Key | None:
        """Return the key of a field.

        Parameters
        ----------
        name : str
            Name of the field.

        Returns
        -------
        Key or None
            None for a table.

        Examples
        --------
        >>> gm.CylindricalDesign.key_of("module").unit
        'length'
        """
        return next((m for m in cls.model_fields[name].metadata if isinstance(m, Key)), None)

    @classmethod
    def key_at(cls, dotted: str) -> Key | None:
        """Return the key of a dotted name.

        Parameters
        ----------
        dotted : str
            As "pinion.teeth".

        Returns
        -------
        Key or None
            None for a table and for an unknown name.

        Examples
        --------
        >>> gm.CylindricalDesign.key_at("pinion.face_width").unit
        'length'
        """
        *tables, last = dotted.split(".")
        table: type[Table] | None = cls
        for name in tables:
            table = table.table_of(name) if table is not None and name in table.model_fields else None
        return None if table is None or last not in table.model_fields else table.key_of(last)

    @classmethod
    def table_of(cls, name: str) -> type[Table] | None:
        """Return the class of the table of a field.

        Parameters
        ----------
        name : str
            Name of the field.

        Returns
        -------
        type of Table or None
            None for a plain key.

        Examples
        --------
        >>> gm.CylindricalDesign.table_of("contact").__name__
        'FlankContact'
        """
        annotation = cls.model_fields[name].annotation
        for candidate in (annotation, *get_args(annotation)):
            if isinstance(candidate, type) and issubclass(candidate, Table):
                return candidate
        return None

    def own(self, prefix: str = "") -> Iterator[tuple[str, Any]]:
        """Yield the keys that were set, without those left to their defaults.

        Parameters
        ----------
        prefix : str
            Text before their names.

        Returns
        -------
        iterator of (str, value)
            Dotted keys and their values.

        Examples
        --------
        >>> dict(design.own())["pinion.teeth"]
        18
        """
        for name in self.names():
            value = getattr(self, name)
            if name not in self.model_fields_set or value is None:
                continue
            if isinstance(value, Table):
                yield from value.own(f"{prefix}{name}.")
            else:
                yield prefix + name, value

    def stated(self, gone: Collection[str] = ()) -> dict[str, Any]:
        """Return what was set as nested tables, as in a file: also tables that are there without a key, as `keyway = {}`.

        Parameters
        ----------
        gone : collection of str
            Dotted keys and tables to leave out.

        Returns
        -------
        dict of str to values
            The dict loads back to the same table.

        Examples
        --------
        >>> design.stated(["contact"])["pinion"]["teeth"]
        18
        """
        found: dict[str, Any] = {}
        for name in self.names():
            value = getattr(self, name)
            if name not in self.model_fields_set or value is None or name in gone:
                continue
            if isinstance(value, Table):
                inner = [key.removeprefix(f"{name}.") for key in gone if key.startswith(f"{name}.")]
                table = value.stated(inner)
                # a table whose last key is left out is left out, too
                if table or not any(True for _ in value.own()):
                    found[name] = table
            else:
                found[name] = value
        return found

    def _count_as_set(self, other: Table) -> None:
        """Count the keys as set that are set in `other`, a table of the same class."""
        self.model_fields_set.intersection_update(other.model_fields_set)
        for name in type(self).model_fields:
            value, theirs = getattr(self, name), getattr(other, name)
            if isinstance(value, Table) and isinstance(theirs, Table):
                value._count_as_set(theirs)

    def scale(self, factor: float) -> Self:
        """Return the table with all lengths multiplied by a factor, and curvatures divided by it.

        Parameters
        ----------
        factor : float
            Factor of lengths.

        Returns
        -------
        Table
            Of the same class.

        Examples
        --------
        >>> design.scale(2.0).module
        4.0
        """
        changed: dict[str, Any] = {}
        for name in type(self).model_fields:
            value, key = getattr(self, name), self.key_of(name)
            if isinstance(value, Table):
                changed[name] = value.scale(factor)
            elif key is not None and key.power and value is not None:
                scale = factor**key.power
                changed[name] = tuple(item * scale for item in value) if key.most else value * scale
        made = self.model_copy(update=changed)
        made._count_as_set(self)
        return made

    def plain(self) -> dict[str, Any]:
        """Return the table as a plain dict that loads back to the same table, with defaults filled in.

        Returns
        -------
        dict of str to values
            Inner tables are dicts, too; keys without a value are left out.

        Examples
        --------
        >>> design.plain()["pinion"]["teeth"]
        18
        """
        replaced = {second for first, second in self.replaces if getattr(self, first) is not None}
        values = {name: getattr(self, name) for name in self.names() if name not in replaced}
        return {
            name: value.plain() if isinstance(value, Table) else value
            for name, value in values.items()
            if value is not None
        }


_know_types(Table)


@cache
def _declared(table: type[Table], name: str) -> tuple[tuple[str, ...], ...]:
    """Return the entries of a class variable that a table and its base classes declare."""
    return tuple(entry for base in reversed(table.__mro__) for entry in vars(base).get(name, ()))


@cache
def _names(table: type[Table]) -> tuple[str, ...]:
    """Return `Table.names` of a class; cached, because a design asks some hundred times."""

    def place(name: str) -> int:
        inner = table.table_of(name)
        return -1 if inner is None else inner.rank

    return tuple(sorted((name for name in table.model_fields if name not in table.absent), key=place))


@dataclass(frozen=True)
class KeyLine:
    """One key as `gearmesh describe` prints it."""

    #: dotted key
    key: str
    #: unit
    unit: str
    #: allowed range in short
    range: str
    #: default in words
    default: str
    #: one line about the key
    about: str
    #: source of the definition
    source: str


#: texts of units, of files in mm and in inches
_UNIT_TEXTS = {
    "length": "mm|inch",
    "curvature": "1/mm|1/inch",
    "turn per square length": "rad/mm^2|rad/inch^2",
    "angle": "deg",
    "coefficient": "m_n",
    "axial coefficient": "m_x",
    "pitch": "1/inch",
    "number": "-",
    "pressure": "MPa",
    "torque": "Nm",
    "density": "kg/m^3",
    "stiffness": "N/mm, N, N mm/rad",
}


def key_lines(
    table: type[Table], prefix: str = "", optional: str = "", apart: dict[str, type[Table]] | None = None
) -> Iterator[KeyLine]:
    """Yield all keys of a table in the order of the file.

    - prefix: text before the names of keys.
    - optional: name of the optional table that the keys belong to.
    - apart: a dict that collects the tables listed apart by their titles; each gets one line.
    """
    for name in table.names():
        field, below, key = table.model_fields[name], table.table_of(name), table.key_of(name)
        if below is not None and below.listed_apart and apart is not None:
            apart[below.listed_apart] = below
            yield KeyLine(prefix + name, "table", "", "none", f"its keys are listed under {below.listed_apart}", "")
        elif below is not None:
            yield from key_lines(below, f"{prefix}{name}.", name if field.default is None else optional, apart)
        elif key is not None:
            if field.is_required():
                default = f"required with {optional}" if optional else "required"
            else:
                default = key.default or _default_text(field.default)
            yield KeyLine(
                key=prefix + name,
                unit=_UNIT_TEXTS.get(key.unit, key.unit),
                range=key.range,
                default=default,
                about=key.about,
                source=key.source,
            )


def usual_keys(table: type[Table], example: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    """Yield the dotted keys of a table that most designs set, in the order of the file.

    They are the required keys, those of `Table.usual` and those of the example. Optional tables have none, unless the
    example has them.
    """
    usual = {name for base in table.__mro__ if issubclass(base, Table) for name in base.usual}
    for name in table.names():
        field, below, given = table.model_fields[name], table.table_of(name), example.get(name)
        if below is None:
            if field.is_required() or name in usual or given is not None:
                yield prefix + name
        elif field.default is not None or given is not None:
            yield from usual_keys(below, given or {}, f"{prefix}{name}.")


def _default_text(default: Any) -> str:
    """Return the default of a field as `describe` prints it."""
    if default is None:
        return "none"
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, tuple):
        return str(list(default))
    return str(default) if isinstance(default, str) else f"{default:g}"
