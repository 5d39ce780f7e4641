"""Texts and values of a drawing: rows of gear data, values for dimensions, entries of the title block."""

from __future__ import annotations

from gearmesh.records import dataclass


@dataclass(frozen=True)
class DataRow:
    """A row of the table of gear data."""

    #: name of the quantity
    words: str
    #: its symbol, as alpha_n
    symbol: str = ""
    #: its value with unit
    value: str = ""
    #: True for a heading, which has words only
    heading: bool = False


@dataclass(frozen=True)
class Facts:
    """Data of a drawing that do not follow from the member's shape."""

    #: rows of gear data
    rows: tuple[DataRow, ...]
    #: tip diameter, mm; None if the sheet has none
    tip: float | None
    #: reference or pitch diameters at toe and heel, mm; None if the sheet has none
    reference: tuple[float, float] | None
    #: upper and lower deviation of the tip diameter, mm; None if the sheet has none
    tip_deviations: tuple[float, float] | None
    #: title of the design
    title: str
    #: name of the member, and its number of teeth
    part: str
    #: mass of the member
    mass: str
    #: version of the program
    version: str
    #: units of lengths and angles
    units: str


def number(value: float, digits: int = 3) -> str:
    """Return a value with a number of decimals, without trailing zeros."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text.replace("-", "\N{MINUS SIGN}")


def diameter(value: float, deviations: tuple[float, float] | None = None) -> str:
    """Return a diameter with its symbol and its deviations."""
    text = f"\N{DIAMETER SIGN}{number(value)}"
    if deviations is None:
        return text
    return text + " (" + " / ".join(("+" if end > 0.0 else "") + number(end) for end in deviations) + ")"
