"""Report page of two designs side by side: figures with their change, keys that differ, errors and patterns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

from gearmesh.answers.contact.contact import Contact
from gearmesh.answers.gearset import GearSet
from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.answers.tables import Listing, round_to
from gearmesh.design.core import Design
from gearmesh.design.dotted import leaves
from gearmesh.errors import NoSolutionError
from gearmesh.io.atomic import scratch_folder
from gearmesh.reports.report import MAP_DPI, ReportPage, tables_html
from gearmesh.reports.study_pictures import pattern_matrix
from gearmesh.study.study import Study
from gearmesh.view import pictures
from gearmesh.view.diagrams.flank_diagrams import plot_flanks
from gearmesh.view.diagrams.plots import ErrorCurve, plot_compared_errors
from gearmesh.view.report import page as pages
from gearmesh.view.report.bars import pattern_bars
from gearmesh.view.report.card import MINUS_SIGN, CardFigure, mesh_card, number
from gearmesh.view.report.page import PageSection, drawing

#: letters before the titles of both designs
DESIGN_LETTERS = ("A", "B")
#: change below which two figures are equal, relative to the larger one
EQUAL_SHARE = 1e-9


def comparison_page(
    both: tuple[GearSet, GearSet],
    contacts: tuple[Mapping[int, Contact], Mapping[int, Contact]],
    loaded: tuple[LoadedContact, LoadedContact] | None = None,
    studies: tuple[Study, Study] | None = None,
) -> ReportPage:
    """Return the page of two gear sets with solved contacts, which are given by the numbers of their pairs.

    Meshes are compared by their order, and only as many as both have. Raises NoSolutionError if a gear set has none.

    - loaded: contact of the first meshes under the same torques.
    - studies: grids over the same one or two errors of assembly.
    """
    for gears, solved in zip(both, contacts, strict=True):
        if not solved:
            raise NoSolutionError(gears.title, reason="has no mesh, so that there is nothing to compare")
    meshes = list(zip(contacts[0].values(), contacts[1].values(), strict=False))
    titles = [f"{letter}: {gears.title}" for letter, gears in zip(DESIGN_LETTERS, both, strict=True)]
    sections = [
        PageSection("Figures", "".join(_figures(mesh, titles, len(meshes) > 1) for mesh in meshes)),
        PageSection("Keys that differ", tables_html([_keys(*(gears.design for gears in both))])),
        PageSection("Contact pattern", "".join(map(_patterns, meshes))),
        PageSection("Transmission error", f'<div class="plots">{"".join(map(_errors, meshes))}</div>'),
    ]
    if loaded is not None:
        sections.insert(1, PageSection("Under load", tables_html([_loads(loaded, titles)])))
    if studies is not None:
        sections.append(PageSection("Patterns at errors of assembly", "".join(map(_matrix, titles, studies))))
    lines = [
        [*gears.warnings, *(line for contact in solved.values() for line in contact.warnings)]
        for gears, solved in zip(both, contacts, strict=True)
    ]
    warnings = tuple(
        dict.fromkeys(f"{letter}: {line}" for letter, own in zip(DESIGN_LETTERS, lines, strict=True) for line in own)
    )
    if warnings:
        sections.insert(1, PageSection("Warnings", tables_html([Listing("", ("",), [[line] for line in warnings])])))
    title = " and ".join(titles)
    kinds = list(dict.fromkeys(gears.design.kind_in_words for gears in both))
    html = pages.plain_page(title, " and ".join(kinds), sections)
    stuck = any(contact.stuck for solved in contacts for contact in solved.values())
    return ReportPage(title, html, warnings, None, stuck)


def _figures(mesh: tuple[Contact, Contact], titles: Sequence[str], named: bool) -> str:
    """Return the table of the figures of two meshes, in words, with their change."""
    cards = [{figure.label: figure for figure in mesh_card(contact).figures} for contact in mesh]
    labels = list(dict.fromkeys([*cards[0], *cards[1]]))
    rows = [[label, *_row(*(card.get(label) for card in cards))] for label in labels]
    title = " and ".join(dict.fromkeys(contact.pair.name for contact in mesh)) if named else ""
    return tables_html([Listing(title, ("", *titles, "change from A to B"), rows)])


def _loads(loaded: tuple[LoadedContact, LoadedContact], titles: Sequence[str]) -> Listing:
    """Return the table of figures under load, with their change: one row per figure and torque."""
    rows = []
    for first, second in zip(*(each.totals for each in loaded), strict=True):
        figures = [
            ("transmission error, peak to peak", "arcsec", first.te_peak_to_peak, second.te_peak_to_peak),
            ("largest pressure", "MPa", first.max_pressure, second.max_pressure),
        ]
        for (name, fillet), (other, other_fillet) in zip(first.fillets.items(), second.fillets.items(), strict=True):
            what = f"root stress of the {' and '.join(dict.fromkeys((name, other)))}"
            figures.append((what, "MPa", fillet.root_stress, other_fillet.root_stress))
        rows += [
            [f"{what}, {unit}", first.torque, round_to(before, 4), round_to(after, 4), change(before, after, unit)]
            for what, unit, before, after in figures
        ]
    names = list(dict.fromkeys(row[0] for row in rows))
    return Listing("", ("", "Nm", *titles, "change from A to B"), sorted(rows, key=lambda row: names.index(row[0])))


def _matrix(title: str, study: Study) -> str:
    """Return the patterns of a design over errors of assembly."""
    with scratch_folder() as folder:
        file = folder / "patterns.png"
        pattern_matrix(study, file, title)
        return drawing(f"{title}: patterns on the pinion over {', '.join(study.plan.keys)}", file.read_bytes())


def _row(first: CardFigure | None, second: CardFigure | None) -> Iterator[str]:
    """Yield both values and the change of the first number of a figure."""
    yield from ("-" if figure is None else figure.value for figure in (first, second))
    before, after = (None if figure is None else figure.amount for figure in (first, second))
    yield change(before, after, "" if first is None else first.unit)


def change(first: float | None, second: float | None, unit: str = "") -> str:
    """Return the text of a change from one amount to another in a unit; "" where one is not known.

    Amounts that are no percentages have the change in per cent of the first, too.
    """
    if first is None or second is None or not np.isfinite([first, second]).all():
        return ""
    step = second - first
    if abs(step) <= EQUAL_SHARE * max(abs(first), abs(second)):
        return "equal"
    sign = "+" if step > 0.0 else MINUS_SIGN
    share = f" ({sign}{number(abs(100.0 * step / first))} %)" if first and unit != "%" else ""
    return f"{sign}{number(abs(step))}{f' {unit}' if unit else ''}{share}"


def _keys(first: Design, second: Design) -> Listing:
    """Return the table of the keys that one of both designs sets and that have another value in the other one."""
    resolved = [{key: value for key, value in leaves(design.resolve()) if value != {}} for design in (first, second)]
    own = [dict(design.own()) for design in (first, second)]
    rows = []
    for key in dict.fromkeys([*own[0], *own[1]]):
        values = [flat.get(key) for flat in resolved]
        if values[0] != values[1]:
            notes = [
                "" if key in keys or value is None else " (default)" for keys, value in zip(own, values, strict=True)
            ]
            rows.append([key, *(_value(value) + note for value, note in zip(values, notes, strict=True))])
    return Listing("" if rows else "No key differs", ("key", *DESIGN_LETTERS), rows)


def _value(value: Any) -> str:
    """Return the text of a value of a key."""
    return "-" if value is None else f"{value:.7g}" if isinstance(value, float) else str(value)


def _patterns(mesh: tuple[Contact, Contact]) -> str:
    """Return the patterns of two meshes beside each other: bars, and the flanks of the drive side."""
    parts = []
    for letter, contact in zip(DESIGN_LETTERS, mesh, strict=True):
        heading = f"<h3>{escape(f'{letter}: {contact.pair.name}')}</h3>"
        if not contact.patterns:
            parts.append(f"<div>{heading}<p>No pattern: the flanks touch on edges alone, or not at all.</p></div>")
            continue
        bars = pattern_bars(contact.patterns, contact.pair.delta)
        with scratch_folder() as folder:
            file = folder / "flanks.png"
            panels = (
                pictures.flank_panel(contact.pair, name, contact.path, whole=contact.whole)
                for name in contact.pair.members
            )
            plot_flanks(file, [[panel] for panel in panels], "", dpi=MAP_DPI)
            flanks = drawing(f"Contact on the flanks of {letter}, drive side", file.read_bytes())
        parts.append(f"<div>{heading}{bars}{flanks}</div>")
    return f'<div class="plots">{"".join(parts)}</div>'


def _errors(mesh: tuple[Contact, Contact]) -> str:
    """Return the transmission errors of two meshes over one pitch in one plot, with their harmonics."""
    curves = []
    for letter, contact in zip(DESIGN_LETTERS, mesh, strict=True):
        rad, unit = contact.pair.output.reading.error
        if contact.cycle is not None and contact.cycle.gears is not None:
            phi1, te = contact.cycle.gears
            curves.append(ErrorCurve(letter, phi1 / phi1[-1], te / rad, np.abs(contact.cycle.harmonics) / rad, unit))
    if not curves or len({curve.unit for curve in curves}) > 1:
        return "<p>The transmission errors have no common unit, or are not known.</p>"
    with scratch_folder() as folder:
        file = folder / "errors.svg"
        plot_compared_errors(file, curves)
        return drawing(f"Transmission error of the gears over one pitch, {mesh[0].pair.name}", file.read_bytes())
