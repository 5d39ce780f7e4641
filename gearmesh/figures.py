"""Figures of answers, each with unit, symbol and meaning.

Keys of JSON files, columns of tables and studies, and the reference come from these declarations.

    @dataclass(frozen=True)
    class Ellipse(Figures):
        a: float = figure("semi-major axis of the contact ellipse", "mm", "a")      # key a_mm
        b: float = figure("semi-minor axis of the contact ellipse", "mm", "b")      # key b_mm
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, field, fields, replace
from functools import cache
from typing import Any, TypeAlias

from gearmesh.errors import UnknownFigureError
from gearmesh.records import dataclass

#: ending of keys by unit
KEY_ENDINGS = {
    "": "",
    "mm": "_mm",
    "mm2": "_mm2",
    "mm3": "_mm3",
    "um": "_um",
    "1/mm": "_per_mm",
    "deg": "_deg",
    "arcsec": "_arcsec",
    "MPa": "_mpa",
    "N": "_n",
    "Nm": "_nm",
    "Nm/arcsec": "_nm_per_arcsec",
    "N/(mm um)": "_n_per_mm_um",
    "N/mm": "_n_per_mm",
    "N/m": "_n_per_m",
    "Nm/rad": "_nm_per_rad",
    "mm/rad": "_mm_per_rad",
    "m/s": "_m_per_s",
    "MPa m/s": "_mpa_m_per_s",
    "W": "_w",
    "K": "_kelvin",
    "%": "_percent",
    "modules": "_modules",
    "s": "",
    "Hz": "_hz",
}
#: size, by unit, below which a table shows 0: above rounding, far below any measurement
ZERO_SIZES = {
    "": 1e-12,
    "mm": 1e-9,
    "mm2": 1e-9,
    "um": 1e-6,
    "deg": 1e-9,
    "arcsec": 1e-6,
    "MPa": 1e-6,
    "N": 1e-6,
    "Nm": 1e-9,
    "Hz": 1e-9,
}
#: place of the name of a member in a key
MEMBER_PLACE = "{member}"


@dataclass(frozen=True)
class Figure:
    """Declaration of a figure."""

    #: key in JSON, ending in the unit; `{member}` stands for the name of a member
    key: str
    #: unit
    unit: str
    #: symbol of ISO 21771, ISO 23509 or the source
    symbol: str
    #: meaning in words
    meaning: str
    #: True if answers without the figure leave it out
    optional: bool = False
    #: True for whole numbers
    whole: bool = False
    #: True for vectors, whose x, y and z are separate columns of a table
    vector: bool = False
    #: True for vectors that are None in JSON while unknown
    nullable: bool = False
    #: True for a nested table whose names are columns without a prefix
    bare: bool = False
    #: False for figures without a column
    shown: bool = True
    #: key, without unit and number, of one number of a list
    singular: str = ""
    #: True for run times, which differ from run to run
    timing: bool = False
    #: True for figures that report the size of rounding
    rounding: bool = False

    @property
    def resolution(self) -> float:
        """Least size that a table shows; smaller values are shown as 0."""
        return 0.0 if self.rounding else ZERO_SIZES.get(self.unit, 0.0)

    @property
    def stem(self) -> str:
        """Key without its unit."""
        return self.key.removesuffix(KEY_ENDINGS[self.unit])

    def item(self, k: int) -> Figure:
        """Return one number of a figure that is a list.

        `k`: position, from 1.
        """
        return replace(
            self, key=f"{self.singular or self.stem}_{k}{KEY_ENDINGS[self.unit]}", meaning=f"{self.meaning}, number {k}"
        )

    def of(self, member: str) -> Figure:
        """Return the figure of a member."""
        return replace(self, key=self.key.replace(MEMBER_PLACE, member))

    def in_um(self, um: str = "um") -> Figure:
        """The same along the travel of a gear that slides, as a rack does.

        `um`: unit that takes the place of arcsec.
        """
        return replace(
            self, key=f"{self.stem}{KEY_ENDINGS[um]}", unit=um, meaning=f"{self.meaning}, along the travel of the rack"
        )


def at_resolution(value: Any, resolution: float) -> Any:
    """A value as a table shows it: numbers below a resolution are 0, those of lists too."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, list | tuple):
        return [at_resolution(item, resolution) for item in value]
    return 0.0 if isinstance(value, float) and abs(value) < resolution else value


def figure(
    meaning: str,
    unit: str = "",
    symbol: str = "",
    *,
    key: str | None = None,
    optional: bool = False,
    whole: bool = False,
    vector: bool = False,
    nullable: bool = False,
    bare: bool = False,
    shown: bool = True,
    singular: str = "",
    timing: bool = False,
    rounding: bool = False,
    parts: type[Figures] | None = None,
    default: Any = MISSING,
) -> Any:
    """A field of `Figures`. Its key is its name with the unit at the end, or the `key` given; one with {member} in it holds a
    figure for each member, by names. An `optional` one that is None is left out. With `parts` it holds figures of that kind
    that stand among the others: one, or one for each member by names, whose keys have {member} in them."""
    if unit not in KEY_ENDINGS:
        raise ValueError(f"unit {unit}: must be one of {', '.join(KEY_ENDINGS)}")
    told: dict[str, Any] = {"unit": unit, "symbol": symbol, "meaning": meaning, "key": key}
    told |= {"optional": optional, "whole": whole, "vector": vector, "nullable": nullable, "bare": bare}
    told |= {"shown": shown, "singular": singular, "timing": timing, "rounding": rounding, "parts": parts}
    return field(default=default, metadata=told) if default is not MISSING else field(metadata=told)


@dataclass(frozen=True)
class Entry:
    """A figure with its value."""

    figure: Figure
    value: Any

    @property
    def key(self) -> str:
        """Key in JSON."""
        return self.figure.key

    @property
    def known(self) -> Any:
        """Value; None for an unknown vector."""
        return None if self.figure.nullable and any(map(math.isnan, self.value)) else self.value


#: further properties of a figure
_FIGURE_PROPERTIES = ("optional", "whole", "vector", "nullable", "bare", "shown", "singular", "timing", "rounding")


class Figures:
    """Base of frozen dataclasses whose fields are all made by `figure`."""

    @property
    def known(self) -> bool:
        """True if there is anything to report; figures that contain these have None in their place otherwise."""
        return True

    @classmethod
    @cache
    def _by_field(cls) -> tuple[tuple[str, Figure, type[Figures] | None], ...]:
        """Return names of fields, their figures, and the class of nested figures."""
        return tuple(
            (
                field.name,
                Figure(
                    key=field.metadata["key"]
                    if field.metadata["key"] is not None
                    else f"{field.name}{KEY_ENDINGS[field.metadata['unit']]}",
                    **{name: field.metadata[name] for name in ("unit", "symbol", "meaning", *_FIGURE_PROPERTIES)},
                ),
                field.metadata["parts"],
            )
            for field in fields(cls)  # type: ignore[arg-type]
        )

    @classmethod
    def declared_figures(cls) -> tuple[Figure, ...]:
        """Return the figures that an answer of the class can have, in order.

        Returns
        -------
        tuple of Figure
            Declarations with key, unit, symbol and meaning.

        Examples
        --------
        >>> gears.contact().positions()[0].declared_figures()[0].key
        'phi1_deg'
        """
        return tuple(
            figure
            for _, known, kind in cls._by_field()
            for figure in ((known,) if kind is None else kind.declared_figures())
        )

    @classmethod
    def key_of(cls, name: str) -> str:
        """The key of the figure of a field.

        Parameters
        ----------
        name : str
            Of a field.

        Returns
        -------
        str
            The name with the unit at its end, if the field states no other key.

        Examples
        --------
        >>> gears.contact().positions()[0].key_of("te")
        'te_arcsec'
        """
        return next(known.key for own, known, _ in cls._by_field() if own == name)

    @property
    def entries(self) -> tuple[Entry, ...]:
        """The figures that it has, one for each member where it holds members' own."""
        own_entries: list[Entry] = []
        for name, known, kind in self._by_field():
            value = getattr(self, name)
            if value is None and known.optional:
                continue
            if kind is not None:
                own = value.entries if isinstance(value, Figures) else _of_members(value)
                own_entries += own
            elif MEMBER_PLACE in known.key:
                own_entries += [Entry(known.of(member), own) for member, own in value.items()]
            else:
                own_entries.append(Entry(known, value))
        return tuple(own_entries)

    def entries_of(self, member: str) -> tuple[Entry, ...]:
        """The figures that it has, as those of a member.

        Parameters
        ----------
        member : str
            Takes the place of {member} in the keys.

        Returns
        -------
        tuple of Entry
            Figures with their values.

        Examples
        --------
        >>> (position,) = gears.contact([0.0]).positions()
        >>> position.entries_of("pinion")[0].key
        'phi1_deg'
        """
        told = ((known.of(member), getattr(self, name)) for name, known, _ in self._by_field())
        return tuple(Entry(known, value) for known, value in told if value is not None or not known.optional)

    @property
    def row(self) -> dict[str, Any]:
        """Values by key, figures within figures as rows of their own."""
        return {entry.key: as_rows(entry.known) for entry in self.entries}

    @property
    def flat(self) -> dict[str, Any]:
        """Values by key, figures within figures and vectors laid flat: the columns of a table."""
        return flat(self.entries)


def _of_members(values: Mapping[str, Figures]) -> list[Entry]:
    """Figures of members, all of one, then all of the next."""
    return [entry for member, own in values.items() for entry in own.entries_of(member)]


def as_rows(value: Any) -> Any:
    """A value of a figure with figures in it as rows."""
    if isinstance(value, Figures):
        return value.row if value.known else None
    if isinstance(value, Summary):
        return value.row
    if isinstance(value, list | tuple) and any(isinstance(item, Figures) for item in value):
        return [as_rows(item) for item in value]
    if isinstance(value, Mapping):
        return {key: as_rows(item) for key, item in value.items()}
    return value


def flat(entries: Iterable[Entry]) -> dict[str, Any]:
    """Values by key, figures within figures and vectors laid flat: the columns of a table."""
    return {key: value for key, value, _ in _flat(entries, "")}


def shown_values(entries: Iterable[Entry]) -> dict[str, Any]:
    """The same as people read it: what is below the resolution of its figure is 0."""
    return {key: at_resolution(value, known.resolution) for key, value, known in _flat(entries, "")}


def _flat(entries: Iterable[Entry], prefix: str) -> Iterator[tuple[str, Any, Figure]]:
    for entry in entries:
        known, value = entry.figure, entry.value
        if not known.shown:
            continue
        if isinstance(value, Figures):
            yield from _flat(value.entries, f"{prefix}{known.key}_" if known.key else prefix)
        elif isinstance(value, Mapping):
            inner = prefix if known.bare or not known.key else f"{prefix}{known.key}_"
            own = (Entry(replace(known, key=name, bare=False), one) for name, one in value.items())
            yield from _flat(own, inner)
        elif known.vector:
            unit = KEY_ENDINGS[known.unit]
            yield from ((f"{prefix}{known.stem}_{axis}{unit}", x, known) for axis, x in zip("xyz", value, strict=True))
        else:
            yield prefix + known.key, value, known


class Summary(Mapping[str, Any]):
    """Figures of several kinds one after the other, by their keys."""

    def __init__(self, *parts: Figures | Summary | Iterable[Entry] | None) -> None:
        """Join the `parts` that are not None; the later of two figures with one key counts."""
        entries: dict[str, Entry] = {}
        for part in parts:
            if part is not None:
                entries |= {
                    entry.key: entry for entry in (part.entries if isinstance(part, Figures | Summary) else part)
                }
        self._entries = entries

    @property
    def entries(self) -> tuple[Entry, ...]:
        """All figures with their values."""
        return tuple(self._entries.values())

    def entry(self, key: str) -> Entry | None:
        """The figure of a key with its value.

        Parameters
        ----------
        key : str
            As in JSON.

        Returns
        -------
        Entry or None
            None where there is no such figure.

        Examples
        --------
        >>> gears.contact().summary.entry("contact_ratio").figure.unit
        ''
        """
        return self._entries.get(key)

    @property
    def row(self) -> dict[str, Any]:
        """Values by key."""
        return {key: as_rows(entry.known) for key, entry in self._entries.items()}

    @property
    def flat(self) -> Summary:
        """With one entry for each number of a list, counted from 1."""
        entries: list[Entry] = []
        for entry in self.entries:
            if isinstance(entry.value, list | tuple):
                entries += [Entry(entry.figure.item(k), value) for k, value in enumerate(entry.value, start=1)]
            else:
                entries.append(entry)
        return Summary(entries)

    def __getitem__(self, key: str) -> Any:
        try:
            return self._entries[key].value
        except KeyError:
            raise UnknownFigureError.among(key, self._entries) from None

    def __contains__(self, key: object) -> bool:
        return key in self._entries

    def get(self, key: str, default: Any = None) -> Any:
        """The value of a figure.

        Parameters
        ----------
        key : str
            As in JSON.
        default : object
            What counts where there is no such figure.

        Returns
        -------
        object
            The value, or `default`.

        Examples
        --------
        >>> gears.contact().summary.get("no_such_figure", 0.0)
        0.0
        """
        return self._entries[key].value if key in self._entries else default

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        return f"Summary({self.row!r})"


#: what a document is made of: figures, tables of them, and messages beside them
Content: TypeAlias = "Figures | Mapping[str, Content] | Sequence[Content] | str | float | bool | None"
