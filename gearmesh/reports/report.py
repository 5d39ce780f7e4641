"""Report page of a design: one HTML file with a view that turns and rolls, figures, plots, data sheet, design file."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from html import escape
from importlib.metadata import PackageNotFoundError, version
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh import __version__
from gearmesh.answers.bodies.solid import Solid
from gearmesh.answers.check import Check
from gearmesh.answers.contact.contact import Contact
from gearmesh.answers.contact.staging import staged_contact
from gearmesh.answers.gearset import GearSet
from gearmesh.answers.limits import limits_of
from gearmesh.answers.sheet import DesignSheet, sheet_of
from gearmesh.answers.tables import Listing, as_html, cell, described, round_to
from gearmesh.design.core import Design
from gearmesh.design.files import with_version
from gearmesh.drawing.drawing import drawing_of
from gearmesh.errors import NoSolutionError, OutputArgumentError, OutputError
from gearmesh.files.reading import BYTES_PER_MIB, file_bytes, read_json
from gearmesh.formats import HTML_SUFFIX, SVG_SUFFIX
from gearmesh.io.atomic import scratch_folder, whole_text
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.study.summary import StudySummary
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.view import opengl, pictures
from gearmesh.view.diagrams.flank_diagrams import plot_flanks
from gearmesh.view.diagrams.modification_diagrams import is_modified, plot_modifications
from gearmesh.view.diagrams.turns_plot import plot_turns
from gearmesh.view.load.loaded_pictures import LoadedPictures
from gearmesh.view.offscreen.letters import Image
from gearmesh.view.picture import Saved, saved_bytes
from gearmesh.view.render import render
from gearmesh.view.report import page as pages
from gearmesh.view.report.bars import pattern_bars
from gearmesh.view.report.card import Card, mesh_card
from gearmesh.view.report.page import PageSection, drawing, listing, picture, three_version
from gearmesh.view.report.stage import StagedPair, stage
from gearmesh.view.report.staged_member import StagedMember, fitted
from gearmesh.view.scene import Scene

#: largest distance, mm, of the shown meshes from the exact surfaces
SHOWN_TOLERANCE_MM = 0.01
#: smallest tolerance of an existing mesh that is shown, relative to the tolerance asked for; a finer mesh is too large
MIN_TOLERANCE_RATIO = 0.25
#: width and height of pictures, pixels
PICTURE_SIZE = (800, 600)
#: resolution of plots that contain maps, pixels per inch
MAP_DPI = 80
#: quality of JPEG files, per cent
JPEG_QUALITY_PERCENT = 80
#: libraries whose versions a page lists, beside gearmesh, Python and three.js
LISTED_LIBRARIES = ("numpy", "scipy", "manifold3d", "matplotlib", "pyvista", "vtk")
#: decimals of the data sheet on the page, mm and deg
SHEET_DECIMALS = 4
#: beginning of the caption of contact on the flanks
FLANKS_CAPTION = "Contact on the flanks"
#: limit of a file of a study that is shown, bytes
MAX_STUDY_FILE_BYTES = 64 * BYTES_PER_MIB


@dataclass(frozen=True)
class PagePlots:
    """Plots of a page, each as its caption and the bytes of a PNG or SVG file."""

    #: plots of contact and of teeth
    contact: list[tuple[str, bytes]] = field(default_factory=list)
    #: plots of loaded contact
    loaded: list[tuple[str, bytes]] = field(default_factory=list)

    def split(self, caption: str) -> tuple[list[tuple[str, bytes]], list[tuple[str, bytes]]]:
        """Return the plots of contact whose caption begins with a text, and the others."""
        first = [plot for plot in self.contact if plot[0].startswith(caption)]
        return first, [plot for plot in self.contact if not plot[0].startswith(caption)]


@dataclass(frozen=True, repr=False)
class ReportPage(Saved):
    """Report page as HTML text."""

    #: title of the page
    title: str
    #: the whole page
    html: str
    #: warnings about gears and figures, one line each
    warnings: tuple[str, ...] = ()
    #: reason why the page has no pictures; None if it has pictures
    skipped: str | None = None
    #: True if the gears of a mesh are jammed at all positions
    stuck: bool = False
    #: failures of the check and of loaded contact, if the page contains them
    complaints: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<ReportPage: {self.title}, {len(self.html.encode()) / 1e6:.2f} MB>"

    @property
    def suffixes(self) -> tuple[str, ...]:
        return (HTML_SUFFIX,)

    def _write(self, target: Path) -> None:
        whole_text(target, self.html)


def report_page(
    gears: GearSet,
    contacts: Mapping[int, Contact],
    tolerance: float = SHOWN_TOLERANCE_MM,
    check: Check | None = None,
    images: Sequence[tuple[str, Image]] | None = None,
    source: str | None = None,
    studies: Sequence[Path] = (),
    loaded: Mapping[int, LoadedPictures] | None = None,
    plots: PagePlots | None = None,
    sheet: DesignSheet | None = None,
) -> ReportPage:
    """Return the page of gears with solved contacts, which are given by the numbers of their pairs.

    Gears that do not mesh have no contacts, but a workshop drawing and limits. Arguments:

    - `tolerance` (mm) applies to the shown meshes.
    - `check`: its verdicts are added, and its solids are shown if their tolerance is about the one asked for.
    - `images`: captions and RGB pixels, all gears first; drawn if not given.
    - `source`: text of the design file, by default the keys that the design sets.
    - `studies`: folders of finished studies.
    - `loaded`: contact under torque, by the numbers of the pairs.
    - `plots`, `sheet`: made if not given.

    Raises OutputError for a folder without a study, and NoSolutionError if a pair has no contact at any position and is
    not jammed.
    """
    for contact in contacts.values():
        if not contact.path.touching.any() and not contact.stuck:
            raise NoSolutionError(
                contact.pair.name,
                reason="no position has contact; set contact.phi1 to other positions or reduce the assembly errors",
            )
    # gears that are jammed at all positions have figures, but no contact in pictures
    moving = {k: contact for k, contact in contacts.items() if not contact.stuck}
    solids = {} if check is None else check.solids
    members = [_staged_member(member, tolerance, solids.get(name)) for name, member in gears.members.items()]
    meshes = {member.member.name: member.whole for member in members}
    overview = _overview(gears, moving, meshes)
    # pictures that are given need no OpenGL
    skipped = None if images else opengl.missing_opengl_message()
    if images is None:
        images = [] if skipped else _draw(gears, moving, members, overview)
    checks = {} if check is None or not contacts else dict(zip(contacts, (check, *check.others), strict=True))
    loads = {} if loaded is None else dict(loaded)
    staged = [_stage(gears.train, contact, checks.get(k), loads.get(k)) for k, contact in moving.items()]
    data = stage(gears.train, members, staged, fitted(overview))
    shots = [(caption, jpeg(image)) for caption, image in images]
    sections = _sections(
        gears,
        contacts,
        check,
        shots,
        source,
        studies,
        loads,
        plots or draw_plots(gears, moving, loads),
        sheet or sheet_of(gears),
    )
    lines = (*gears.warnings, *(line for contact in contacts.values() for line in contact.warnings))
    complaints = list[str]()
    for under in (load.contact for load in loads.values()):
        pair_prefix = f"{under.pair.name}: " if len(loads) > 1 else ""
        failures = [f"{pair_prefix}{line}" for line in under.complaints]
        complaints += failures
        lines = (*lines, *under.warnings, *failures)
    if check is not None:
        complaints += check.complaints
        lines = (*lines, *check.warnings, *check.complaints)
    if skipped is not None:
        lines = (*lines, skipped)
    warnings = tuple(dict.fromkeys(lines))
    teeth = ", ".join(f"{name} {member.tooth.teeth}" for name, member in gears.members.items())
    card = Card(
        tuple(mesh_card(contact, loads[k].contact if k in loads else None) for k, contact in contacts.items()),
        tuple(dict.fromkeys((*_most_important(gears, contacts, check, loads), *warnings))),
        None if check is None else len(check.verdicts),
        () if check is None else tuple(check.complaints),
    )
    html = pages.page(gears.title, f"{gears.design.kind_in_words}, teeth: {teeth}", card, data, shots, sections)
    return ReportPage(gears.title, html, warnings, skipped, len(moving) < len(contacts), tuple(complaints))


def _most_important(
    gears: GearSet, contacts: Mapping[int, Contact], check: Check | None, loads: Mapping[int, LoadedPictures]
) -> list[str]:
    """Return all warnings, the most important ones first.

    First come failed checks, gears that do not fit, loads that did not converge, and gears whose fit is not known. Then
    come warnings of contact, of loaded contact, of the design, and of the check.
    """
    verdicts = {k: None if contact.fit is None else contact.fit.fits for k, contact in contacts.items()}
    # warnings of the gears are left out here, so that interference comes first among the warnings of each contact
    contact_lines = {
        k: [line for line in contact.warnings if line not in gears.warnings] for k, contact in contacts.items()
    }
    loaded_contacts = [load.contact for load in loads.values()]
    return [
        *([] if check is None else check.complaints),
        *(line for k, lines in contact_lines.items() if verdicts[k] is False for line in lines),
        *(line for loaded in loaded_contacts for line in loaded.complaints),
        *(line for k, lines in contact_lines.items() if verdicts[k] is None for line in lines),
        *(line for lines in contact_lines.values() for line in lines),
        *(line for loaded in loaded_contacts for line in loaded.warnings),
        *gears.warnings,
        *([] if check is None else check.warnings),
    ]


def _overview(gears: GearSet, contacts: Mapping[int, Contact], meshes: Mapping[str, TriangleMesh]) -> Scene:
    """Return the picture of all gears, in mesh if they mesh."""
    if 0 not in contacts:
        axis = next(iter(gears.members.values())).mount.axis
        return pictures.members_picture(gears.place(meshes), axis, PICTURE_SIZE)
    first = contacts[0]
    if len(gears.pairs) > 1 or gears.names.carried:
        return pictures.set_picture(first.pair, gears.place(meshes), PICTURE_SIZE)
    return pictures.pair_picture(first.pair, dict(meshes), first.path, PICTURE_SIZE)


def _staged_member(member: Member, tolerance: float, solid: Solid | None) -> StagedMember:
    """Return a member for the view.

    The mesh of `solid` is reused if it is within the tolerance (mm) but not far finer.
    """
    if solid is not None and solid.member is member and len(solid.teeth) == 1:
        (tooth,) = solid.teeth
        if MIN_TOLERANCE_RATIO * tolerance <= tooth.tolerance <= tolerance:
            return StagedMember.of_mesh(member, solid.mesh, tooth)
    return StagedMember.of(member, tolerance)


def _stage(train: GearTrain, contact: Contact, check: Check | None, loaded: LoadedPictures | None = None) -> StagedPair:
    """Return a pair for the view, with its contact at the positions of the slider.

    Positions without contact are left out.
    """
    patches = {} if check is None else {name: check.roll.patches(contact.pair, name) for name in contact.pair.members}
    return StagedPair(staged_contact(train, contact), patches, None if loaded is None else loaded.pattern)


def _draw(
    gears: GearSet, contacts: Mapping[int, Contact], members: Sequence[StagedMember], overview: Scene
) -> list[tuple[str, Image]]:
    """Draw all gears in mesh, then the teeth of the members with their contact."""
    scenes = [overview]
    teeth = pictures.ToothViews({staged.member.name: staged for staged in members}, size=PICTURE_SIZE)
    for contact in contacts.values():
        scenes += [
            pictures.contact_picture(
                contact.pair, name, contact.path, PICTURE_SIZE, teeth.of(contact.pair, name), whole=contact.whole
            )
            for name in contact.pair.members
        ]
    return [(scene.title, render(scene)) for scene in scenes]


def jpeg(image: Image) -> bytes:
    """Return RGB pixels as a JPEG file; larger pictures are reduced by a whole number."""
    from PIL import Image as pillow

    fewer = max(1, image.shape[1] // PICTURE_SIZE[0])
    rows, columns = (size // fewer * fewer for size in image.shape[:2])
    file = BytesIO()
    small = pillow.fromarray(image[:rows, :columns]).reduce(fewer)
    small.save(file, format="jpeg", quality=JPEG_QUALITY_PERCENT, optimize=True)
    return file.getvalue()


def _sections(
    gears: GearSet,
    contacts: Mapping[int, Contact],
    check: Check | None,
    shots: Sequence[tuple[str, bytes]],
    source: str | None,
    studies: Sequence[Path],
    loaded: Mapping[int, LoadedPictures],
    plots: PagePlots,
    sheet: DesignSheet,
) -> list[PageSection]:
    sections = []
    bars = [
        (f"<h3>{escape(contact.pair.name)}</h3>" if len(contacts) > 1 else "")
        + pattern_bars(contact.patterns, contact.pair.delta)
        for contact in contacts.values()
        if contact.patterns
    ]
    flanks, others = plots.split(FLANKS_CAPTION)
    if bars:
        sections.append(PageSection("Contact pattern", "".join(bars) + "".join(drawing(*plot) for plot in flanks)))
    if not contacts:
        sections += _sections_alone(gears)
    if body := "".join(drawing(*plot) for plot in (others if bars else plots.contact)):
        sections.append(PageSection("Plots", f'<div class="plots">{body}</div>'))
    if loaded:
        tables = tables_html([
            replace(loaded_contact.listings[0], title=f"{loaded_contact.listings[0].title} of {loaded_contact.pair.name}")
            for loaded_contact in (under.contact for under in loaded.values())
        ])  # fmt: skip
        body = "".join(drawing(*plot) for plot in plots.loaded)
        sections.append(PageSection("Under load", f'{tables}<div class="plots">{body}</div>'))
    # the view already shows the first picture
    if shots[1:]:
        body = "".join(picture(*shot) for shot in shots[1:])
        sections.append(PageSection("Pictures", f'<div class="pictures">{body}</div>'))
    sections += [study_section(folder) for folder in studies]
    known = [listing for listing in map(known_rows, sheet.listings) if listing.rows]
    sections.append(PageSection("Data sheet", f'<div class="sheet">{tables_html(known)}</div>'))
    if contacts:
        listings = [table for contact in contacts.values() for table in _contact_tables(contact)]
        sections.append(PageSection("Figures and positions", tables_html(listings), folded=True))
    if check is not None:
        sections.append(PageSection("Checks", tables_html(check.listings), folded=True))
    text = given_keys(gears.design) if source is None else source
    sections.append(PageSection("Design file", listing(text, "Copy the design file"), folded=True))
    sections.append(PageSection("Versions", tables_html([_versions()]), folded=True))
    return sections


def known_rows(table: Listing) -> Listing:
    """Return a table of the data sheet without rows that have no value, and with the decimals that say something."""
    first = next((k for k, column in enumerate(table.columns) if column == "unit"), 0) + 1
    rows = [row for row in table.rows if any(text != "-" for text in map(cell, row[first:]))]
    return replace(table, rows=[[_few_decimals(value) for value in row] for row in rows])


def _few_decimals(value: Any) -> Any:
    """Return a value of the data sheet rounded to `SHEET_DECIMALS`, and to as many digits where it is small."""
    if not isinstance(value, float) or not np.isfinite(value):
        return value
    small = abs(value) < 10.0 ** (1 - SHEET_DECIMALS // 2)
    return float(f"{value:.{SHEET_DECIMALS}g}") if small else round_to(value, SHEET_DECIMALS)


def _sections_alone(gears: GearSet) -> list[PageSection]:
    """Return the sections of gears that do not mesh, in place of contact."""
    body = "".join(
        drawing(f"Drawing of the {name}", saved_bytes(drawing_of(gears, name), SVG_SUFFIX)) for name in gears.members
    )
    return [
        PageSection("Drawing", body),
        PageSection("Limits", tables_html(limits_of(gears.design, gears.train).listings)),
    ]


def study_section(folder: Path) -> PageSection:
    """Return the tables and pictures of a finished study in a folder. Raises OutputError if the folder holds none."""
    try:
        document = read_json(folder / "study.json", MAX_STUDY_FILE_BYTES, "finished study", OutputError)
        summary = StudySummary.read(document)
        remarks = [[line] for line in summary.warnings]
        tables = tables_html([*summary.tables, *([Listing("Warnings", ("",), remarks)] if remarks else [])])
    except (OutputError, LookupError, ValueError, TypeError, AttributeError) as failure:
        why = f": {failure}" if isinstance(failure, OutputError) else ""
        raise OutputArgumentError(
            "study",
            folder,
            reason="holds no finished study (study.json)",
            allowed=f"the folder that a study wrote{why}",
        ) from None
    drawings = [
        drawing(f"Study: {file.stem}", file_bytes(file, MAX_STUDY_FILE_BYTES, "picture", OutputError))
        for file in sorted(folder.glob("*.png"))
    ]
    return PageSection(f"Study {folder.name}", tables + "".join(drawings))


def draw_plots(
    gears: GearSet, contacts: Mapping[int, Contact], loaded: Mapping[int, LoadedPictures] | None = None
) -> PagePlots:
    """Return the plots of a page: SVG, but PNG for maps, whose contours are long."""
    made = PagePlots()
    with scratch_folder() as folder:
        te, maps, curves = (folder / file for file in ("te.svg", "maps.png", "curves.svg"))
        for contact in contacts.values():
            of = contact.pair.name if len(contacts) > 1 else ""
            pictures.plot_errors(contact, te)
            rows = pictures.all_flank_rows(contact)
            plot_flanks(maps, rows or pictures.driving_flanks(contact, rows), "", dpi=MAP_DPI)
            made.contact.append((te_caption(of), te.read_bytes()))
            made.contact.append((flanks_caption(of), maps.read_bytes()))
            made.contact.extend(turns_plots(contact, of))
        for member in gears.members.values():
            if is_modified(member):
                plot_modifications(maps, member)
                made.contact.append((modifications_caption(member.name), maps.read_bytes()))
        for under_torque in (loaded or {}).values():
            note = under_torque.contact.pair.name if loaded and len(loaded) > 1 else ""
            for view, diagram in under_torque.diagrams(MAP_DPI, note).items():
                # the diagram of flanks is a PNG file: maps
                file = diagram.save(maps if view == "loaded_flank" else curves)
                made.loaded.append((diagram.title.removeprefix(f"{gears.title}: "), file.read_bytes()))
    return made


def te_caption(of: str) -> str:
    """Caption of the transmission error of a pair, named if there are several."""
    return f"Transmission error{_of(of)}"


def flanks_caption(of: str) -> str:
    """Caption of the contact on the flanks of a pair, named if there are several."""
    return f"{FLANKS_CAPTION}{_of(of)}"


def modifications_caption(name: str) -> str:
    """Caption of a member's modifications."""
    return f"Modifications of the {name}"


def turns_plots(contact: Contact, of: str) -> list[tuple[str, bytes]]:
    """Return the transmission error over whole turns with its caption; nothing for gears whose teeth are alike."""
    if (turns := contact.unlike_turns) is None:
        return []
    with scratch_folder() as folder:
        file = folder / "turns.png"
        plot_turns(file, turns, "", contact.pair.output.reading.error, dpi=MAP_DPI)
        return [(f"Transmission error over whole turns{_of(of)}", file.read_bytes())]


def _of(name: str) -> str:
    return f", {name}" if name else ""


def given_keys(design: Design) -> str:
    """Return the keys that a design sets, as TOML."""
    return with_version(design.stated())


def _contact_tables(contact: Contact) -> list[Listing]:
    name = contact.pair.name
    tables = [replace(listing, title=f"{listing.title} of {name}") for listing in contact.listings[:-1]]
    return [described(f"Figures of {name}", contact.summary), *tables]


def _versions() -> Listing:
    rows = [("gearmesh", __version__), ("Python", platform.python_version())]
    for name in LISTED_LIBRARIES:
        # some have a wheel of another name
        with suppress(PackageNotFoundError):
            rows.append((name, version(name)))
    return Listing("", ("", ""), [*rows, ("three.js", three_version())])


def tables_html(listings: Sequence[Listing]) -> str:
    """Return tables as HTML, without run times; each scrolls by itself."""
    return "\n".join(f'<div class="scroll" tabindex="0">{as_html([listing.timeless])}</div>' for listing in listings)
