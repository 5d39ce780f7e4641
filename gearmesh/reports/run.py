"""Run: everything about a design into one folder, with a report of what was found and written."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import field, replace
from functools import cached_property
from hashlib import file_digest
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from gearmesh import __version__, io
from gearmesh.answers.bodies.solid import Solid, solid_of
from gearmesh.answers.check import Check
from gearmesh.answers.contact.contact import Contact
from gearmesh.answers.gearset import number_list
from gearmesh.answers.limits import limits_of
from gearmesh.answers.load.loaded import LoadedContact, required_torques
from gearmesh.answers.questions import SolvedGears, loaded_meshes
from gearmesh.answers.result import Result, header
from gearmesh.answers.sheet import DesignSheet, sheet_of
from gearmesh.answers.tables import Listing, figures
from gearmesh.errors import NoSolutionError, OutputError
from gearmesh.figures import Content
from gearmesh.files.reading import BYTES_PER_MIB, is_file, read_json
from gearmesh.formats import STL_SUFFIX, VTM_SUFFIX
from gearmesh.io.atomic import files_together, whole_text
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.progress import Progress
from gearmesh.records import dataclass
from gearmesh.reports.report import (
    PagePlots,
    flanks_caption,
    modifications_caption,
    report_page,
    te_caption,
    turns_plots,
)
from gearmesh.systems.system import system_of
from gearmesh.teeth.gear_train import GearPair
from gearmesh.view import opengl, pictures
from gearmesh.view.diagrams.flank_diagrams import plot_flanks
from gearmesh.view.diagrams.modification_diagrams import is_modified, plot_modifications
from gearmesh.view.load.loaded_pictures import LoadedPictures
from gearmesh.view.offscreen.letters import Image
from gearmesh.view.render import render

#: file of the report, which also lists the other files of the run
REPORT_FILE = "report.json"
#: file of the report page
PAGE_FILE = "report.html"
#: list of the files that a run has written, with their digests: only these may the next run remove
MANIFEST_FILE = ".gearmesh-run.json"
#: pattern of the names of members
_MEMBER_PATTERN = r"(?:pinion|gear|rack|sun|ring|worm|wheel|planet(?:_\d+)?)"
#: pattern of the files of a run; names of files of a mesh begin with its members. No other file is ever removed
RUN_FILE = re.compile(
    rf"(?:{_MEMBER_PATTERN}_){{0,2}}(?:(?:contact|loaded)\.json|contact\.csv|(?:transmission_error|path_of_contact|flank|contact|pattern|gap"
    rf"|loaded|loaded_(?:flank|te|share|stress|pair)|modifications)\.png)|(?:sheet|limits)\.json|report\.html|pair\.(?:vtm|png)"
    rf"|{_MEMBER_PATTERN}\.(?:stl|png)",
    re.ASCII,
)
#: limit of a manifest that is read, bytes
MAX_MANIFEST_BYTES = BYTES_PER_MIB


@dataclass(frozen=True, repr=False)
class Report(Result):
    """Results and files of `run`."""

    #: deviation of the solids, and the roll test
    check: Check
    #: contact of the first mesh; None for gears that do not mesh
    contact: Contact | None
    #: folder of the files
    folder: Path
    #: all files of the run
    files: tuple[Path, ...]
    #: reason why there are no pictures; None if there are pictures
    skipped: str | None
    #: sheet of kinds that have one
    sheet: DesignSheet | None = None
    #: contact of each different mesh, if a gear set has several
    meshes: tuple[Contact, ...] = ()
    #: first mesh under torque, if a torque was given
    loaded: LoadedContact | None = None
    #: each different mesh under torque, if a gear set has several
    loaded_meshes: tuple[LoadedContact, ...] = ()

    @property
    def stuck(self) -> bool:
        """True if the gears of a mesh are jammed at all positions."""
        return any(mesh.stuck for mesh in (self.contact, *self.meshes) if mesh is not None)

    @property
    def headline(self) -> str:
        return f"{len(self.files)} files in {self.folder}; {self.check.headline}"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about gears and figures, one line each."""
        solved = (self.check if self.contact is None else self.contact, *self.meshes)
        warning_lists = [mesh.warnings for mesh in solved] + [under_load.warnings for under_load in self._under_load]
        return tuple(dict.fromkeys(line for lines in warning_lists for line in lines))

    @property
    def complaints(self) -> list[str]:
        """Failures of the check and of loaded contact, one line each."""
        under_load = [
            f"{loaded.pair.name}: {line}" if self.loaded_meshes else line
            for loaded in self._under_load
            for line in loaded.complaints
        ]
        return [*self.check.complaints, *under_load]

    @property
    def _under_load(self) -> tuple[LoadedContact, ...]:
        return self.loaded_meshes or (() if self.loaded is None else (self.loaded,))

    @property
    def listings(self) -> list[Listing]:
        meshes, *roll = self.check.listings
        files = Listing("Files", ("",), [(str(file),) for file in self.files])
        loaded = [
            replace(table, title=f"{table.title} of {under_torque.pair.name}") if self.loaded_meshes else table
            for under_torque in self._under_load
            for table in under_torque.overview
        ]
        contact = [] if self.contact is None else [figures("Contact", self.contact.summary)]
        return [meshes, *contact, *loaded, *roll, files]

    def to_dict(self) -> dict[str, list[Any]]:
        return {"file": [str(file) for file in self.files]}

    @property
    def sections(self) -> Mapping[str, Content]:
        """Sections of the check, with the summary of contact, the files, and the frames of their coordinates."""
        members = tuple(self.check.solids)
        meshes = {mesh.pair.name: mesh.summary for mesh in self.meshes}
        under_load = {loaded_mesh.pair.name: loaded_mesh.figures for loaded_mesh in self.loaded_meshes}
        return {
            **header(self.check.design),
            "mesh": self.check.meshes,
            **({} if self.contact is None else {"contact": self.contact.summary}),
            **({"meshes": meshes} if meshes else {}),
            **({} if self.loaded is None else {"loaded": self.loaded.figures}),
            **({"loaded_meshes": under_load} if under_load else {}),
            "roll": self.check.roll.rows,
            "verdicts": self.check.verdicts,
            **({} if self.sheet is None else {"sheet": self.sheet.plain_tables}),
            **({} if self.sheet is None or not self.sheet.missing else {"sheet_missing": self.sheet.missing}),
            "warnings": self.warnings,
            "files": [file.name for file in self.files],
            "frames": {file.name: _frame(file, members) for file in self.files if file.suffix in _MESH_SUFFIXES},
        }


#: suffixes of files with coordinates
_MESH_SUFFIXES = (STL_SUFFIX, VTM_SUFFIX)


def _frame(file: Path, members: tuple[str, ...]) -> str:
    return f"own frame of the {file.stem}" if file.stem in members else "fixed frame"


@dataclass
class RunFolder:
    """Files of a run in the order in which they are written."""

    #: the gears
    gears: SolvedGears
    #: temporary folder to which the files are written
    folder: Path
    #: folder in which all files appear together at the end
    target: Path
    #: True if files contain run times
    timing: bool
    #: files written so far
    files: list[Path] = field(default_factory=list)
    #: solids written so far, by members
    solids: dict[str, Solid] = field(default_factory=dict)

    @cached_property
    def teeth(self) -> pictures.ToothViews:
        """Teeth for pictures: those of the solids if these are fine enough."""
        return pictures.ToothViews(self.solids)

    def file(self, name: str, pair: GearPair | None = None) -> Path:
        """Return the path of a file that is written next.

        With several meshes, names of files of a `pair` begin with its members.
        """
        self.files.append(self.folder / f"{'' if pair is None else self.prefix(pair)}{name}")
        return self.files[-1]

    def prefix(self, pair: GearPair) -> str:
        """Return the beginning of the names of files of a mesh; empty if there is only one mesh."""
        return f"{pair.pinion.name}_{pair.gear.name}_" if self.several else ""

    def finish(self, report: Callable[[tuple[Path, ...]], Report]) -> Report:
        """Write the report, which lists all files by their final paths, and the manifest."""
        written = report(
            tuple(self.target / file.relative_to(self.folder) for file in (*self.files, self.folder / REPORT_FILE))
        )
        written.save(self.folder / REPORT_FILE, timing=self.timing)
        manifest = {"gearmesh": __version__, "sha256": _digests(self.files)}
        whole_text(self.folder / MANIFEST_FILE, json.dumps(manifest, indent=2) + "\n")
        return written

    @property
    def several(self) -> bool:
        """True if there are several meshes."""
        return len(self.gears.pairs) > 1

    def write_answers(self, contacts: Mapping[int, Contact], loaded: Mapping[int, LoadedContact]) -> None:
        """Write contact and loaded contact as JSON and CSV."""
        for under in loaded.values():
            under.save(self.file("loaded.json", under.pair), timing=self.timing)
        for contact in contacts.values():
            contact.save(self.file("contact.json", contact.pair), timing=self.timing)
            contact.save(self.file("contact.csv", contact.pair))

    def write_solids(self, tolerance: float, progress: Progress) -> dict[str, Solid]:
        """Write all members as STL, within `tolerance` (mm)."""
        solids = self.solids
        for k, name in enumerate(self.gears.members):
            progress(0.15 + 0.3 * k / len(self.gears.members), f"solid of the {name}")
            target = self.file(f"{name}.stl")
            solids[name] = solid_of(self.gears, name, tolerance, file=target)
            solids[name].save(target)
        return solids

    def write_plots(
        self, contacts: Mapping[int, Contact], drawn: Mapping[int, LoadedPictures], progress: Progress
    ) -> None:
        """Write the plots of contact, of loaded contact and of modifications."""
        progress(0.6, "plots")
        for contact in contacts.values():
            te_file, path_file = (
                self.file(f"{name}.png", contact.pair) for name in ("transmission_error", "path_of_contact")
            )
            rows = pictures.plots(contact, te_file, path_file, self.gears.title)
            if rows:
                title = f"{self.gears.title}: contact on the flanks"
                plot_flanks(self.file("flank.png", contact.pair), rows, title)
        for under_load in drawn.values():
            progress(0.65, "pictures of loaded contact")
            self.files += under_load.save(self.folder, self.prefix(under_load.contact.pair))
        for name, member in self.gears.members.items():
            if is_modified(member):
                plot_modifications(self.file(f"{name}_modifications.png"), member)

    def page_plots(self, contacts: Mapping[int, Contact], drawn: Mapping[int, LoadedPictures]) -> PagePlots:
        """Return the plots of `write_plots` for the page; missing plots are drawn."""
        made = PagePlots()
        for contact in contacts.values():
            name_prefix, pair_name = self.prefix(contact.pair), contact.pair.name if len(contacts) > 1 else ""
            flanks = self.folder / f"{name_prefix}flank.png"
            made.contact.append(
                (te_caption(pair_name), (self.folder / f"{name_prefix}transmission_error.png").read_bytes())
            )
            if flanks not in self.files:
                flanks = self.folder / f"{name_prefix}path_of_contact.png"
            made.contact.append((flanks_caption(pair_name), flanks.read_bytes()))
            made.contact.extend(turns_plots(contact, pair_name))
        for name, member in self.gears.members.items():
            if is_modified(member):
                file = self.folder / f"{name}_modifications.png"
                made.contact.append((modifications_caption(name), file.read_bytes()))
        for under_load in drawn.values():
            pair = under_load.contact.pair
            for view, diagram in under_load.diagrams(note=pair.name if len(drawn) > 1 else "").items():
                made.loaded.append((diagram.title, (self.folder / f"{self.prefix(pair)}{view}.png").read_bytes()))
        return made

    def write_pictures(
        self, contacts: Mapping[int, Contact], check: Check, meshes: dict[str, TriangleMesh]
    ) -> list[tuple[str, Image]]:
        """Write pictures of teeth and gears, with `meshes` of the members.

        Returns their captions and pixels, all gears first.
        """
        images = []
        for contact, rolled in zip(contacts.values(), (check, *check.others), strict=True):
            if contact.stuck:
                continue
            patches = rolled.roll.patches(contact.pair, contact.pair.pinion.name)
            scenes = pictures.all_pictures(
                contact.pair, contact.path, patches, meshes, self.gears.title, self.teeth, contact.whole
            )
            if self.several or self.gears.names.carried:
                del scenes["pair.png"]
            images += [(scene.title, render(scene, self.file(file, contact.pair))) for file, scene in scenes.items()]
        if self.several or self.gears.names.carried or not images:
            overview = pictures.set_picture(contacts[0].pair, self.gears.place(meshes), title=self.gears.title)
            images.append((overview.title, render(overview, self.file("pair.png"))))
        return images[-1:] + images[:-1]


def run(
    gears: SolvedGears,
    folder: Path,
    tolerance: float,
    progress: Progress,
    timing: bool,
    page: bool,
    source: str | None,
    torque: ArrayLike | None = None,
) -> Report:
    """Write solids, contact, roll test, plots, pictures and the `page` of gears into `folder`; the page shows `source`.

    With one or several values of `torque` (Nm) on the pinion of the first mesh, loaded contact of each different mesh
    is added. All files appear together: if one cannot be made, none is written, and files of an earlier run stay. Files
    in the manifest of an earlier run that this run does not write are removed. Raises NoSolutionError if nothing
    touches, unless the gears are jammed.
    """
    if torque is not None:
        required_torques(number_list("torque", torque, "Nm").tolist())
        gears.pair()
    if gears.names.pairs:
        gears.pair()
    stale = _listed_files(folder)
    with files_together(folder) as temporary:
        written = RunFolder(gears, temporary, folder, timing)
        if not gears.pairs and torque is None:
            report = _run_alone(written, tolerance, progress, page, source)
        else:
            report = _run_meshes(written, tolerance, progress, page, source, torque)
    for file in stale - {file.name for file in report.files}:
        (folder / file).unlink(missing_ok=True)
    progress(1.0, "done")
    return report


def _run_meshes(
    written: RunFolder, tolerance: float, progress: Progress, page: bool, source: str | None, torque: ArrayLike | None
) -> Report:
    """Write everything about gears that mesh."""
    gears = written.gears
    sheet = sheet_of(gears) if system_of(gears.design).sheet is not None else None
    contacts, loaded = _solve(gears, torque, progress)
    written.write_answers(contacts, loaded)
    solids = written.write_solids(tolerance, progress)
    meshes, contact = {name: solid.mesh for name, solid in solids.items()}, contacts[0]
    # gears that are jammed at all positions have no contact to show
    moving = {k: contact for k, contact in contacts.items() if not contact.stuck}
    alone = written.several or contact.stuck
    placed = gears.place(meshes) if alone else pictures.in_mesh(contact.pair, meshes, contact.path)
    io.write_scene(placed, written.file("pair.vtm"))
    progress(0.45, "roll test")
    check = gears.check_solved(contacts, solids)
    drawn = {k: LoadedPictures(under_load, written.teeth) for k, under_load in loaded.items()}
    written.write_plots(moving, drawn, progress)
    skipped, images = opengl.missing_opengl_message(), list[tuple[str, Image]]()
    if skipped is None:
        progress(0.7, "pictures")
        images = written.write_pictures(contacts, check, meshes)
    if page:
        progress(0.9, "report page")
        html = report_page(
            gears,
            contacts,
            check=check,
            images=images,
            source=source,
            loaded=drawn,
            plots=written.page_plots(moving, drawn),
            sheet=sheet,
        )
        html.save(written.file(PAGE_FILE))
    several = tuple(contacts.values()) if written.several else ()
    under_load = tuple(loaded.values()) if several else ()
    return written.finish(
        lambda files: Report(check, contact, written.target, files, skipped, sheet, several, loaded.get(0), under_load)
    )


def _run_alone(written: RunFolder, tolerance: float, progress: Progress, page: bool, source: str | None) -> Report:
    """Write everything about gears that do not mesh: solids, sheet, limits, plots of modifications, pictures, page,
    report.
    """
    gears, timing = written.gears, written.timing
    sheet = sheet_of(gears)
    solids = written.write_solids(tolerance, progress)
    sheet.save(written.file("sheet.json"), timing=timing)
    limits_of(gears.design, gears.train).save(written.file("limits.json"), timing=timing)
    written.write_plots({}, {}, progress)
    check = gears.check_solved({}, solids)
    skipped, images = opengl.missing_opengl_message(), list[tuple[str, Image]]()
    if skipped is None:
        progress(0.7, "pictures")
        for name, solid in solids.items():
            mount = gears.members[name].mount
            placed = {name: solid.mesh.move(gears.places[name])}
            scene = pictures.members_picture(placed, mount.axis, title=gears.title)
            images.append((scene.title, render(scene, written.file(f"{name}.png"))))
    if page:
        progress(0.9, "report page")
        plots = written.page_plots({}, {})
        report_page(gears, {}, check=check, images=images, source=source, plots=plots, sheet=sheet).save(
            written.file(PAGE_FILE)
        )
    return written.finish(lambda files: Report(check, None, written.target, files, skipped, sheet))


def _solve(
    gears: SolvedGears, torque: ArrayLike | None, progress: Progress
) -> tuple[dict[int, Contact], dict[int, LoadedContact]]:
    """Return the contact of each different mesh, by the numbers of the pairs.

    The loaded contact is added if torques (Nm) are given.
    """
    progress(0.05, "tooth contact")
    contacts = {k: gears.contact(pair=k) for k in gears.train.different}
    if not all(contact.path.touching.any() or contact.stuck for contact in contacts.values()):
        raise NoSolutionError(
            "contact.phi1", reason="no position in this range has contact; reduce the range or the assembly errors"
        )
    if torque is None or any(contact.stuck for contact in contacts.values()):
        return contacts, {}
    return contacts, loaded_meshes(
        gears, torque, contacts, lambda fraction, doing: progress(0.05 + 0.1 * fraction, doing)
    )


def _listed_files(folder: Path) -> set[str]:
    """Return the names of files in the folder that an earlier run wrote and that have not been changed since.

    Their names are in the manifest and match RUN_FILE, and their bytes have the digest of the manifest.
    """
    try:
        digests = read_json(folder / MANIFEST_FILE, MAX_MANIFEST_BYTES, error=OutputError)["sha256"]
    except (OutputError, KeyError, TypeError):
        return set()
    files = [
        folder / name
        for name in (digests if isinstance(digests, dict) else {})
        if RUN_FILE.fullmatch(name) and is_file(folder / name) and not (folder / name).is_symlink()
    ]
    return {name for name, digest in _digests(files).items() if digest == digests[name]}


def _digests(files: Iterable[Path]) -> dict[str, str]:
    """Return the SHA-256 of files by their names."""
    digests = {}
    for path in filter(is_file, files):
        with open(path, "rb") as file:
            digests[path.name] = file_digest(file, "sha256").hexdigest()
    return digests
