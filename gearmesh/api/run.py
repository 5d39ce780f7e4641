"""The main job: everything about a design into one folder, with a report of what was found and written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from gearmesh import io
from gearmesh.answers.bodies.solid import solid_of
from gearmesh.answers.check import Check
from gearmesh.answers.contact.contact import Contact
from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.answers.questions import SolvedGears, loaded_meshes
from gearmesh.answers.result import Result, header
from gearmesh.answers.sheet import DesignSheet, sheet_of
from gearmesh.answers.tables import Listing, figures
from gearmesh.api.report import report_page
from gearmesh.errors import NoSolutionError, OutputError
from gearmesh.figures import Content
from gearmesh.files.reading import MIB, is_file, read_json
from gearmesh.progress import Progress
from gearmesh.systems.system import system
from gearmesh.teeth.train import GearPair
from gearmesh.view import opengl, pictures
from gearmesh.view.diagrams.flank_diagrams import plot_flanks
from gearmesh.view.diagrams.modification_diagrams import is_modified, plot_modifications
from gearmesh.view.load.loaded_pictures import LoadedPictures
from gearmesh.view.render import render

#: the report, which also lists the files that belong to it, and the page beside it
REPORT, PAGE = "report.json", "report.html"
#: largest report of an earlier run that is read, bytes
LARGEST = 64 * MIB


@dataclass(frozen=True, repr=False)
class Report(Result):
    """What `run` found and wrote; `skipped` says why there are no pictures, None where there are.

    `contact`: of the first mesh; `meshes`: of every different mesh of a gear set that has several; `sheet`: the sheet of kinds that
    have one of their own; `loaded`: the first mesh under torque, where one was asked for; `loaded_meshes`: likewise all of them.
    """

    check: Check
    contact: Contact
    folder: Path
    files: tuple[Path, ...]
    skipped: str | None
    sheet: DesignSheet | None = None
    meshes: tuple[Contact, ...] = ()
    loaded: LoadedContact | None = None
    loaded_meshes: tuple[LoadedContact, ...] = ()

    @property
    def headline(self) -> str:
        return f"{len(self.files)} files in {self.folder}; {self.check.headline}"

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to know of gears and figures, one line each."""
        told = [each.warnings for each in (self.contact, *self.meshes)] + [each.warnings for each in self._under_load]
        return tuple(dict.fromkeys(line for lines in told for line in lines))

    @property
    def complaints(self) -> list[str]:
        """Failures of the check and of loaded contact, one line each."""
        under_load = [
            f"{each.pair.name}: {line}" if self.loaded_meshes else line
            for each in self._under_load
            for line in each.complaints
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
            replace(table, title=f"{table.title} of {each.pair.name}") if self.loaded_meshes else table
            for each in self._under_load
            for table in each.overview
        ]
        return [meshes, figures("Contact", self.contact.summary), *loaded, *roll, files]

    def to_dict(self) -> dict[str, list[Any]]:
        return {"file": [str(file) for file in self.files]}

    @property
    def sections(self) -> Mapping[str, Content]:
        """As those of the check, with the contact's summary, the files and the frames that their coordinates are in."""
        members = tuple(self.check.solids)
        meshes = {each.pair.name: each.summary for each in self.meshes}
        under_load = {each.pair.name: each.figures for each in self.loaded_meshes}
        return {
            **header(self.check.design),
            "mesh": self.check.meshes,
            "contact": self.contact.summary,
            **({"meshes": meshes} if meshes else {}),
            **({} if self.loaded is None else {"loaded": self.loaded.figures}),
            **({"loaded_meshes": under_load} if under_load else {}),
            "roll": self.check.roll.rows,
            "verdicts": self.check.verdicts,
            **({} if self.sheet is None else {"sheet": self.sheet.plain_tables}),
            "warnings": self.warnings,
            "files": [file.name for file in self.files],
            "frames": {file.name: _frame(file, members) for file in self.files if file.suffix in _MESHES},
        }


_MESHES = (".stl", ".vtm")


def _frame(file: Path, members: tuple[str, ...]) -> str:
    return f"own frame of the {file.stem}" if file.stem in members else "fixed frame"


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
    """Solids, contact, roll test, plots and pictures of gears into `folder`, and their `page`, with the `source` of the design.

    With a `torque` or several (Nm) on the pinion of the first mesh loaded contact, too, of every mesh that differs.
    Files of an earlier run that this one does not write are removed: those that its report lists. Raises NoSolutionError
    where no position has contact.
    """
    folder.mkdir(parents=True, exist_ok=True)
    stale, files = _listed(folder), list[Path]()

    def wrote(name: str) -> Path:
        files.append(folder / name)
        return folder / name

    progress(0.05, "tooth contact")
    contacts = {k: gears.contact(pair=k) for k in gears.train.different}
    for each in contacts.values():
        if not each.path.touching.any():
            raise NoSolutionError(
                "contact.phi1", reason="no position in this range has contact; reduce the range or the assembly errors"
            )
    loaded: dict[int, LoadedContact] = {}
    if torque is not None:
        loaded = loaded_meshes(gears, torque, contacts, lambda fraction, doing: progress(0.05 + 0.1 * fraction, doing))
    for under in loaded.values():
        under.save(wrote(f"{_prefix(gears, under.pair)}loaded.json"), timing=timing)
    for each in contacts.values():
        each.save(wrote(f"{_prefix(gears, each.pair)}contact.json"), timing=timing)
        each.save(wrote(f"{_prefix(gears, each.pair)}contact.csv"))
    contact = contacts[0]
    solids = {}
    for k, name in enumerate(gears.members):
        progress(0.15 + 0.3 * k / len(gears.members), f"solid of the {name}")
        target = wrote(f"{name}.stl")
        solids[name] = solid_of(gears, name, tolerance, file=target)
        solids[name].save(target)
    meshes = {name: solid.mesh for name, solid in solids.items()}
    placed = gears.placed(meshes) if len(gears.pairs) > 1 else pictures.in_mesh(contact.pair, meshes, contact.path)
    io.write_scene(placed, wrote("pair.vtm"))
    progress(0.45, "roll test")
    check = gears.checked(contacts, solids)
    progress(0.6, "plots")
    for each in contacts.values():
        before = _prefix(gears, each.pair)
        te_file, path_file = (wrote(f"{before}{name}.png") for name in ("transmission_error", "path_of_contact"))
        rows = pictures.plots(each, te_file, path_file, gears.title)
        if rows:
            plot_flanks(wrote(f"{before}flank.png"), rows, f"{gears.title}: contact on the flanks")
    drawn = {k: LoadedPictures(each) for k, each in loaded.items()}
    for under_load in drawn.values():
        progress(0.65, "pictures of loaded contact")
        files += under_load.save(folder, _prefix(gears, under_load.contact.pair))
    for name, member in gears.members.items():
        if is_modified(member):
            plot_modifications(wrote(f"{name}_modifications.png"), member)
    skipped = opengl.missing_opengl_message()
    images = []
    if skipped is None:
        progress(0.7, "pictures")
        for each, rolled in zip(contacts.values(), (check, *check.others), strict=True):
            patches = rolled.roll.patches(each.pair, each.pair.pinion.name)
            scenes = pictures.all_pictures(each.pair, each.path, patches, meshes, gears.title)
            if len(gears.pairs) > 1:
                del scenes["pair.png"]
            for file, scene in scenes.items():
                pixels = render(scene, wrote(f"{_prefix(gears, each.pair)}{file}"))
                if page:
                    images.append((scene.title, pixels))
        if len(gears.pairs) > 1:
            overview = pictures.set_picture(contact.pair, placed, title=gears.title)
            images.append((overview.title, render(overview, wrote("pair.png"))))
    if page:
        progress(0.9, "report page")
        # all gears, the last picture, come first
        written = report_page(
            gears, contacts, check=check, images=images[-1:] + images[:-1], source=source, loaded=drawn
        )
        written.save(wrote(PAGE))
    sheet = sheet_of(gears) if system(gears.design.kind).sheet is not None else None
    several = tuple(contacts.values()) if len(gears.pairs) > 1 else ()
    meshes_under_load = tuple(loaded.values()) if several else ()
    written_files = (*files, folder / REPORT)
    report = Report(check, contact, folder, written_files, skipped, sheet, several, loaded.get(0), meshes_under_load)
    report.save(folder / REPORT, timing=timing)
    for file in stale - {file.name for file in report.files}:
        (folder / file).unlink(missing_ok=True)
    progress(1.0, "done")
    return report


def _prefix(gears: SolvedGears, pair: GearPair) -> str:
    """What the names of a mesh's files begin with: nothing, where there is but one."""
    return "" if len(gears.pairs) == 1 else f"{pair.pinion.name}_{pair.gear.name}_"


def _listed(folder: Path) -> set[str]:
    """Names of the files in the folder that the report of an earlier run lists."""
    try:
        names = read_json(folder / REPORT, LARGEST, error=OutputError)["files"]
    except (OutputError, KeyError, TypeError):
        return set()
    known = names if isinstance(names, list) else []
    return {name for name in known if isinstance(name, str) and Path(name).name == name and is_file(folder / name)}
