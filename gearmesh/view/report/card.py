"""The card on the first screen of the report page: the main figures of the gears in words, rounded, with units."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmesh.answers.contact.contact import Contact
from gearmesh.answers.contact.figures import SlideSummary
from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: transmission error below which the card says so instead of a number: the last digit of tables, arcsec or um
MIN_SHOWN_ERROR = 1e-3
#: length below which the card shows 0
MIN_SHOWN_LENGTH_MM = 1e-4
#: length from which the unit is mm, not um
MIN_LENGTH_IN_MM = 0.1
#: sign of negative numbers
MINUS_SIGN = "\u2212"
#: between a number and its unit, which stay on one line
NO_BREAK_SPACE = "\u00a0"
#: text of a length of 0
ZERO_LENGTH = f"0{NO_BREAK_SPACE}\u00b5m"


@dataclass(frozen=True)
class CardFigure:
    """A figure in words."""

    #: name of the figure
    label: str
    #: value with unit
    value: str
    #: remark on the value, "" without one
    note: str = ""
    #: first number of the value, in its unit (lengths in mm); None if there is none
    amount: float | None = None
    #: unit of the amount
    unit: str = ""


@dataclass(frozen=True)
class MeshCard:
    """The figures of one mesh."""

    mesh: str
    figures: tuple[CardFigure, ...]


@dataclass(frozen=True)
class Card:
    """The card of a page."""

    #: figures of the meshes
    meshes: tuple[MeshCard, ...] = ()
    #: all warnings, the most important one first
    warnings: tuple[str, ...] = ()
    #: number of checks; None if nothing was checked
    checks: int | None = None
    #: checks that failed, one line each
    failures: tuple[str, ...] = ()
    #: words in place of a verdict, where nothing can be checked; "" for the verdict
    remark: str = ""

    @property
    def verdict(self) -> str:
        """All checks in one line."""
        if self.remark:
            return self.remark
        if self.checks is None:
            return "Not checked: the option --check compares meshes and contact by a second route."
        if self.failures:
            return f"{len(self.failures)} of {self.checks} checks fail: {'; '.join(self.failures)}"
        return f"All {self.checks} checks hold."


def mesh_card(contact: Contact, loaded: LoadedContact | None = None) -> MeshCard:
    """Return the eight figures of a pair with solved contact; the last is the pressure if there is a torque."""
    pressure = tuple(_pressure(contact, loaded))
    figures = (*_cycle(contact), *_fit(contact), *_pattern(contact), *(pressure or (_ratio(contact),)))
    return MeshCard(contact.pair.name, figures)


def _cycle(contact: Contact) -> Iterator[CardFigure]:
    cycle = contact.cycle
    known = cycle is not None and np.isfinite(cycle.contact_ratio)
    yield (
        CardFigure("Contact ratio", number(cycle.contact_ratio), _pairs(cycle.contact_ratio), cycle.contact_ratio)
        if cycle is not None and known
        else CardFigure("Contact ratio", "not known", "no whole mesh cycle")
    )
    label, swing = "Mesh transmission error", np.nan if cycle is None else cycle.peak_to_peak
    if np.isfinite(swing):
        rad, unit = contact.pair.output.reading.error
        shown_unit = unit.replace("um", "\u00b5m")
        yield CardFigure(
            label,
            error(float(swing) / rad, shown_unit),
            "peak to peak, without load",
            _shown(float(swing) / rad),
            shown_unit,
        )
        assert cycle is not None
        harmonics = np.abs(cycle.harmonics[:3]) / rad
        yield CardFigure(
            "Harmonics 1, 2, 3 of it", *_harmonics(harmonics, shown_unit), _shown(float(harmonics[0])), shown_unit
        )
    else:
        yield CardFigure(label, "not known", "no whole mesh cycle")
        yield CardFigure("Harmonics 1, 2, 3 of it", "not known", "no whole mesh cycle")


def _harmonics(amplitudes: Array, unit: str) -> tuple[str, str]:
    """Return the amplitudes of the first harmonics of the mesh frequency, and a note."""
    note = "amplitudes at the mesh frequency and its multiples"
    if not np.isfinite(amplitudes).all() or amplitudes.max(initial=0.0) < MIN_SHOWN_ERROR:
        return error(0.0, unit), note
    values = [number(value) if value >= MIN_SHOWN_ERROR else "0" for value in amplitudes.tolist()]
    return f"{', '.join(values)}{NO_BREAK_SPACE}{unit}", note


def _pattern(contact: Contact) -> Iterator[CardFigure]:
    """Yield place and size of the contact pattern on the drive side of the pinion, or of the side that has one."""
    if not contact.patterns:
        yield CardFigure("Contact pattern", "none", "the flanks touch on edges alone, or not at all")
        return
    first = contact.patterns[0]
    yield CardFigure(
        "Centre of the contact pattern",
        f"{percent(first.centre_face)} of face, {percent(first.centre_height)} of height",
        f"{first.member}, {first.side} side; from toe and root limit",
        first.centre_face,
        "%",
    )
    yield CardFigure(
        "Size of the contact pattern",
        f"{percent(first.length)} long, {percent(first.width)} wide",
        "in parts of face and working height, without load",
        first.length,
        "%",
    )


def percent(value: float) -> str:
    """Text of a percentage, whole."""
    return f"{value:.0f}{NO_BREAK_SPACE}%"


def _ratio(contact: Contact) -> CardFigure:
    """Return the ratio of the teeth, or of the arm that turns; of a rack the travel per turn of the pinion."""
    slid = contact.summary.entry(SlideSummary.key_of("displacement_per_turn"))
    if slid is not None:
        return CardFigure("Travel per turn", length(slid.value), "of the pinion")
    first, second = contact.pair.both
    if contact.pair.arm_turns:
        # of Willis's equation, the gear at rest
        arm = contact.pair.ratio / (contact.pair.ratio - 1.0)
        held = f"{number(1.0 - arm)} to {second.name}, {first.name} not turning"
        note = f"eccentric to {first.name}, {second.name} at rest; {held}"
        return CardFigure("Gear ratio", number(arm), note, arm)
    ratio = 1.0 / abs(contact.pair.ratio)
    return CardFigure("Gear ratio", number(ratio), f"{second.tooth.teeth} : {first.tooth.teeth} teeth", ratio)


def _pairs(ratio: float) -> str:
    """Text of the number of tooth pairs in contact."""
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
        note = "negative: the gears are jammed" if least.startswith(MINUS_SIGN) else _turn(contact, fit.backlash[0])
        least_backlash = float(fit.normal_backlash[0])
        yield CardFigure("Normal backlash", backlash, "" if least == ZERO_LENGTH else note, least_backlash, "mm")
    if fit is None:
        return
    distances = ["not known" if tip is None else length(tip.distance) for tip in fit.clearances]
    alike = distances[0] == distances[1]
    named = [f"{name} {distance}" for name, distance in zip(contact.pair.members, distances, strict=True)]
    note = "tips of both members" if alike else ""
    deepest = length(max((clash.depth for clash in fit.interference), default=0.0))
    note = note if deepest == ZERO_LENGTH else f"a tip is {deepest} in a fillet"
    first = None if fit.clearances[0] is None else fit.clearances[0].distance
    yield CardFigure("Tip clearance", distances[0] if alike else ", ".join(named), note, first, "mm")


#: signs that replace units behind a number
UNIT_SIGNS = {"deg": "°"}


def _turn(contact: Contact, angle: float) -> str:
    """Text of the smallest backlash (rad), as rotation or travel of the gear."""
    rad, unit = contact.pair.output.reading.motion
    return f"at least {number(angle / rad)}{UNIT_SIGNS.get(unit, f' {unit}')} of the {contact.pair.gear.name}"


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
            pressure = f"{number(highest.max_pressure)}{NO_BREAK_SPACE}MPa"
            yield CardFigure(label, pressure, at + also, highest.max_pressure, "MPa")
    elif (hertz := contact.hertz) is not None and np.isfinite(hertz.peak_pressure).any():
        yield CardFigure(
            label,
            f"{number(np.nanmax(hertz.peak_pressure))}{NO_BREAK_SPACE}MPa",
            f"Hertz, at {number(hertz.torque)} Nm",
        )


def number(value: float) -> str:
    """Text of a number: three significant digits, all digits before the point, no exponent, a true minus sign."""
    size = abs(float(value))
    digits = 0 if size >= 100.0 else int(2 - np.floor(np.log10(size))) if size > 0.0 else 0
    text = f"{size:.{max(digits, 0)}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return (MINUS_SIGN if value < 0.0 and float(text) else "") + text


def error(size: float, unit: str) -> str:
    """Text of a transmission error; below the last digit of tables only this limit."""
    return (
        f"below {MIN_SHOWN_ERROR:g}{NO_BREAK_SPACE}{unit}"
        if size < MIN_SHOWN_ERROR
        else f"{number(size)}{NO_BREAK_SPACE}{unit}"
    )


def _shown(size: float) -> float:
    """Return a transmission error, or 0 below the last digit of tables: rounding has no changes."""
    return size if size >= MIN_SHOWN_ERROR else 0.0


def length(value: float, of: float | None = None) -> str:
    """Text of a length (mm) in mm or um; the length `of`, by default the same, selects the unit."""
    value = value if abs(value) >= MIN_SHOWN_LENGTH_MM else 0.0
    in_mm = abs(value if of is None else of) >= MIN_LENGTH_IN_MM
    return f"{number(value)}{NO_BREAK_SPACE}mm" if in_mm else f"{number(1e3 * value)}{NO_BREAK_SPACE}\u00b5m"


def span(low: float, high: float) -> str:
    """Text of two lengths (mm) in one unit, or of one length if both have the same text."""
    of = max(abs(low), abs(high))
    first, last = length(low, of), length(high, of)
    return first if first == last else f"{first.split(NO_BREAK_SPACE)[0]} to {last}"
