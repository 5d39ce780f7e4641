"""What is written on a drawing: rows of gear data, values for dimensions, entries of the title block."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class DataRow:
    """A row of the table of gear data: words, symbol and value with its unit; `heading`: words alone, above others."""

    words: str
    symbol: str = ""
    value: str = ""
    heading: bool = False


@dataclass(frozen=True)
class Facts:
    """What a drawing says of a member beside its shape.

    `rows`: its gear data. `tip`: its tip diameter (mm), `reference`: reference or pitch diameters (mm) at toe and heel, None
    where the sheet has none; `tip_deviations`: upper and lower ones of the tip diameter, mm. `title`, `part`, `material`, `mass`,
    `version`, `units`: what the title block says.
    """

    rows: tuple[DataRow, ...]
    tip: float | None
    reference: tuple[float, float] | None
    tip_deviations: tuple[float, float] | None
    title: str
    part: str
    material: str
    mass: str
    version: str
    units: str


def number(value: float, digits: int = 3) -> str:
    """A value to so many decimals, without zeros at its end."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text.replace("-", "\N{MINUS SIGN}")


def diameter(value: float, deviations: tuple[float, float] | None = None) -> str:
    """A diameter with its symbol, and its deviations."""
    text = f"\N{DIAMETER SIGN}{number(value)}"
    if deviations is None:
        return text
    return text + " (" + " / ".join(("+" if end > 0.0 else "") + number(end) for end in deviations) + ")"
