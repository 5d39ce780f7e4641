"""The card on the first screen of the report page: what the gears do at a glance, in words, rounded, with units."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gearmesh.answers.contact.contact import Contact
from gearmesh.answers.load.loaded import LoadedContact

#: below it a transmission error is read as none: the last digit that tables of it have, in arcsec or um
LEAST_ERROR = 1e-3
#: mm: below it a length is read as 0, above the second it is in mm, not um
LEAST_LENGTH, IN_MM = 1e-4, 0.1
MINUS, DEGREE = "\u2212", "\u00b0"
#: between a number and its unit, which stay together
BLANK = "\u00a0"
#: a length that is none
NOTHING = f"0{BLANK}\u00b5m"


@dataclass(frozen=True)
class CardFigure:
    """A figure in words: what it is, its value with its unit, and what is to be known of it."""

    label: str
    value: str
    note: str = ""


@dataclass(frozen=True)
class MeshCard:
    """The figures of one mesh."""

    mesh: str
    figures: tuple[CardFigure, ...]


@dataclass(frozen=True)
class Card:
    """The card of a page: the figures of its meshes, and the warning that matters most with the number of all of them."""

    meshes: tuple[MeshCard, ...] = ()
    worst: str | None = None
    warnings: int = 0


def mesh_card(contact: Contact, loaded: LoadedContact | None = None) -> MeshCard:
    """The figures of a pair with solved contact, and of its contact under torque where there is one."""
    figures = (*_cycle(contact), *_fit(contact), *_pressure(contact, loaded))
    return MeshCard(contact.pair.name, figures)


def _cycle(contact: Contact) -> Iterator[CardFigure]:
    cycle = contact.cycle
    known = cycle is not None and np.isfinite(cycle.contact_ratio)
    yield (
        CardFigure("Contact ratio", number(cycle.contact_ratio), _pairs(cycle.contact_ratio))
        if cycle is not None and known
        else CardFigure("Contact ratio", "not known", "no whole mesh cycle")
    )
    label, swing = "Mesh transmission error", np.nan if cycle is None else cycle.peak_to_peak
    if np.isfinite(swing):
        rad, unit = contact.pair.output.reading.error
        yield CardFigure(label, error(float(swing) / rad, unit.replace("um", "\u00b5m")), "peak to peak, without load")
    else:
        yield CardFigure(label, "not known", "no whole mesh cycle")


def _pairs(ratio: float) -> str:
    """How many tooth pairs are in contact."""
    least, most = int(np.floor(ratio + 1e-9)), int(np.ceil(ratio - 1e-9))
    if least < 1:
        return "below 1: edge contact between two tooth pairs"
    if least == most:
        return f"{least} tooth pair{'s' * (least > 1)} in contact"
    return f"{least} or {most} tooth pairs in contact"


def _fit(contact: Contact) -> Iterator[CardFigure]:
    fit = contact.fit
    if fit is None or not np.isfinite(fit.normal_backlash[0]):
        yield CardFigure("Normal backlash", "not known", "the driving or the coast flanks do not touch")
    else:
        backlash, least = span(*fit.normal_backlash), length(fit.normal_backlash[0])
        note = "negative: the gears are jammed" if least.startswith(MINUS) else _turn(contact, fit.backlash[0])
        yield CardFigure("Normal backlash", backlash, "" if least == NOTHING else note)
    if fit is None:
        return
    distances = ["not known" if tip is None else length(tip.distance) for tip in fit.clearances]
    alike = distances[0] == distances[1]
    named = [f"{name} {distance}" for name, distance in zip(contact.pair.members, distances, strict=True)]
    note = "tips of both members" if alike else ""
    deepest = length(max((clash.depth for clash in fit.interference), default=0.0))
    note = note if deepest == NOTHING else f"a tip is {deepest} in a fillet"
    yield CardFigure("Tip clearance", distances[0] if alike else ", ".join(named), note)


#: units that are signs behind a number
SIGNS = {"deg": "°"}


def _turn(contact: Contact, angle: float) -> str:
    """The least backlash (rad) as rotation or travel of the gear."""
    rad, unit = contact.pair.output.reading.motion
    return f"at least {number(angle / rad)}{SIGNS.get(unit, f' {unit}')} of the {contact.pair.gear.name}"


def _pressure(contact: Contact, loaded: LoadedContact | None) -> Iterator[CardFigure]:
    label = "Largest contact pressure"
    if loaded is not None:
        highest = max(loaded.totals, key=lambda total: (np.nan_to_num(total.max_pressure, nan=-1.0), total.torque))
        at = f"at {number(highest.torque)} Nm"
        singular = any(total.edge_contact for total in loaded.totals)
        if np.isnan(highest.max_pressure):
            yield CardFigure(label, "edge contact", f"{at}: the peak pressure is singular and is not reported")
        else:
            also = ", without the singular peak of edge contact" if singular else ""
            yield CardFigure(label, f"{number(highest.max_pressure)}{BLANK}MPa", at + also)
    elif (hertz := contact.hertz) is not None and np.isfinite(hertz.peak_pressure).any():
        yield CardFigure(
            label, f"{number(np.nanmax(hertz.peak_pressure))}{BLANK}MPa", f"Hertz, at {number(hertz.torque)} Nm"
        )


def number(value: float) -> str:
    """Three significant digits, all digits before the point, no exponent, with a minus sign."""
    size = abs(float(value))
    digits = 0 if size >= 100.0 else int(2 - np.floor(np.log10(size))) if size > 0.0 else 0
    text = f"{size:.{max(digits, 0)}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return (MINUS if value < 0.0 and float(text) else "") + text


def error(size: float, unit: str) -> str:
    """A transmission error, which below the last digit of tables is none."""
    return f"below {LEAST_ERROR:g}{BLANK}{unit}" if size < LEAST_ERROR else f"{number(size)}{BLANK}{unit}"


def length(value: float, of: float | None = None) -> str:
    """A length (mm) in mm or um, as `of` is, by default itself."""
    value = value if abs(value) >= LEAST_LENGTH else 0.0
    in_mm = abs(value if of is None else of) >= IN_MM
    return f"{number(value)}{BLANK}mm" if in_mm else f"{number(1e3 * value)}{BLANK}\u00b5m"


def span(low: float, high: float) -> str:
    """Two lengths (mm) in one unit, or one where they read alike."""
    of = max(abs(low), abs(high))
    first, last = length(low, of), length(high, of)
    return first if first == last else f"{first.split(BLANK)[0]} to {last}"
