"""Exchange of designs with REXS: designs from REXS models, and REXS models of designs."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from gearmesh import __version__
from gearmesh.answers.contact.contact import PHI1_RANGE_KEYS
from gearmesh.answers.load.figures import LoadedPosition
from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.answers.pinned import Pinned
from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing
from gearmesh.arguments import checks_arguments
from gearmesh.design.core import Design, RexsSource
from gearmesh.design.dotted import values_of
from gearmesh.design.files import anchor, counted_from, every_key, stated_text
from gearmesh.errors import ArgumentError, DesignError, FileError
from gearmesh.exchange.model import WRITTEN_VERSION, Component, LoadCase, RexsModel
from gearmesh.exchange.rexs_file import read_rexs, rexs_bytes
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_form import StageForm
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.figures import Content, Figures, figure
from gearmesh.formats import JSON_SUFFIX, REXS_SUFFIXES, TOML_SUFFIX
from gearmesh.numerals import parse_whole_number
from gearmesh.records import dataclass
from gearmesh.systems.designs import parse_as_stated
from gearmesh.systems.system import System, complete_design, loaded_kinds, system, system_of

#: date of a new model; it is fixed, so that the same design gives the same file
DEFAULT_DATE = "1970-01-01T00:00:00+00:00"


@dataclass(frozen=True)
class UnusedAttributeFigures(Figures):
    """An attribute of a REXS file that no key of the design stands for."""

    component: str = figure("type and id of the component")
    attribute: str = figure("name of the attribute")


@dataclass(frozen=True)
class TorqueFigures(Figures):
    """A torque on the shaft of a gear."""

    gear: str = figure("type and id of the gear")
    load_case: str = figure("id of the load case, empty where the torque is of none")
    torque_Nm: float = figure("torque on the gear's shaft", unit="Nm")


@dataclass(frozen=True, repr=False)
class RexsReading(Result):
    """Design of a stage of a REXS file.

    A file with the suffix ".toml" is the design file.
    """

    #: the design of the stage
    design: Design
    #: keys of the design as the file states them
    keys: Mapping[str, Any]
    #: type and id of the stage
    stage: str
    #: attributes of the file that no key of the design represents
    unused: tuple[UnusedAttributeFigures, ...]
    #: torques on the gears
    torques: tuple[TorqueFigures, ...]
    #: notes of the reader, one line each
    warnings: tuple[str, ...] = ()

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, TOML_SUFFIX)

    @property
    def headline(self) -> str:
        return f"{self.stage}: {len(self.unused)} attributes of the file not used"

    @property
    def listings(self) -> list[Listing]:
        torques = [[entry.gear, entry.load_case, entry.torque_Nm] for entry in self.torques]
        unused: dict[str, list[str]] = {}
        for entry in self.unused:
            unused.setdefault(entry.component, []).append(entry.attribute)
        listings = [Listing("Torques", ("gear", "load case", "torque Nm"), torques)] if torques else []
        rows = [[component, attribute] for component, attributes in unused.items() for attribute in attributes]
        return [*listings, Listing("Not used", ("component", "attribute"), rows)]

    def to_dict(self) -> dict[str, list[Any]]:
        return {
            "component": [entry.component for entry in self.unused],
            "attribute": [entry.attribute for entry in self.unused],
        }

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "stage": self.stage, "torques": self.torques, "unused": self.unused}

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        whole_text(target, self.text(target.parent))

    def text(self, folder: Path) -> str:
        """The design file.

        Parameters
        ----------
        folder : pathlib.Path
            Folder of the file; paths of other files in it are relative to this folder.

        Returns
        -------
        str
            TOML.

        Examples
        --------
        >>> from pathlib import Path
        >>> gm.load_rexs(gears.rexs().save("gears.rexs")).text(Path(".")).splitlines()[0]
        'kind = "cylindrical"'
        """
        lines = [
            f"# torque on {entry.gear}{f', load case {entry.load_case}' if entry.load_case else ''}: {entry.torque_Nm:.12g} Nm\n"
            for entry in self.torques
        ]
        return "".join(lines) + stated_text(self.keys, type(self.design), folder)


@checks_arguments
def load_rexs(file: str | os.PathLike[str], stage: str | None = None) -> RexsReading:
    """The design of a stage of a REXS file (.rexs, .rexsj, .rexsz; versions 1.0 to 1.7).

    Parameters
    ----------
    file : str or os.PathLike[str]
        The file.
    stage : str, optional
        Id of the stage; not needed if the file has only one stage.

    Returns
    -------
    RexsReading
        The `design`, the torques of the file, and all attributes of the file that the design does not represent.

    Raises
    ------
    DesignError
        One line: a file that cannot be read, a stage that does not exist, or gears that are impossible.

    Examples
    --------
    >>> gears.rexs().save("pair.rexs").name
    'pair.rexs'
    >>> gm.load_rexs("pair.rexs").design.kind
    'cylindrical'
    """
    path = Path(file)
    return read_stage(read_rexs(path), path, stage)


def read_stage(model: RexsModel, path: Path, stage: str | None) -> RexsReading:
    """Return the design of a stage, by its id, of the model in a file. Raises DesignError as `load_rexs` does."""
    kind_system, reader = _stage(model, path, stage)
    assert kind_system.rexs is not None
    dotted = kind_system.rexs.read(reader)
    keys: dict[str, Any] = {}
    for key, value in {**dotted, "rexs.file": path.name, "rexs.stage": reader.stage.id}.items():
        *tables, last = key.split(".")
        table = keys
        for name in tables:
            table = table.setdefault(name, {})
            if not isinstance(table, dict):
                raise FileError(path, reason=f"{reader.stage.in_full}: {key}: {name} is not a table of a design")
        table[last] = value
    keys = anchor(keys, kind_system.of_keys(keys).design, path.parent)
    try:
        design = complete_design(parse_as_stated(keys))
    except DesignError as refusal:
        raise reader.name_origin(refusal) from None
    torques = tuple(
        TorqueFigures(str(gear), case, torque)
        for stage_reader, gear in _gears(reader)
        for case, torque in stage_reader.torques(gear).items()
    )
    unused = tuple(UnusedAttributeFigures(component, attribute) for component, attribute in reader.unused_attributes())
    return RexsReading(design, keys, str(reader.stage), unused, torques, tuple(dict.fromkeys(reader.notes)))


def _gears(reader: StageReader) -> Iterator[tuple[StageReader, Component]]:
    """Yield the gears of a stage or of its part stages, each with the reader of the stage that has its torque."""
    seen: set[str] = set()
    stages = (
        [reader.stage] if any(reader.model.relations_of("stage", "stage", reader.stage.id)) else reader.part_stages()
    )
    for stage in map(reader.of, stages):
        for gear in stage.gears():
            if gear.id not in seen:
                seen.add(gear.id)
                yield stage, gear


def _forms() -> Iterator[tuple[System[Any], StageForm]]:
    for kind in loaded_kinds():
        kind_system = system(kind)
        if kind_system.rexs is not None:
            yield kind_system, kind_system.rexs


def stages_in(model: RexsModel, path: Path) -> list[Component]:
    """Return the stages of a model that are no part of another stage. Raises FileError if there is none."""
    return _stages(model, path)[1]


def _stages(model: RexsModel, path: Path) -> tuple[list[Component], list[Component]]:
    """Return all stages of a model, and those that are no part of another stage."""
    types = tuple(dict.fromkeys(type for _, form in _forms() for type in form.stages))
    stages = [component for component in model.components if component.type in types]
    inside = {
        relation.in_role("part")
        for relation in model.relations
        if relation.type == "assembly" and relation.in_role("assembly") in [component.id for component in stages]
    }
    if not stages:
        raise FileError(path, reason=f"has no stage of these types: {', '.join(types)}")
    return stages, [component for component in stages if component.id not in inside]


def _stage(model: RexsModel, path: Path, wanted: str | None) -> tuple[System[Any], StageReader]:
    """Return the system of a stage, and its reader."""
    stages, offered = _stages(model, path)
    listed = ", ".join(
        f'{component.id} ({component.type} "{component.name}")'
        if component.name
        else f"{component.id} ({component.type})"
        for component in offered
    )
    if wanted is None and len(offered) > 1:
        raise ArgumentError("stage", reason=f"the file has {len(offered)} stages; name one", allowed=listed)
    chosen = [component for component in stages if component.id == wanted or (wanted is None and component in offered)]
    if not chosen:
        raise ArgumentError("stage", wanted, reason="the file has no such stage", allowed=listed)
    reader = StageReader(str(path), model, chosen[0])
    for kind_system, form in _forms():
        if chosen[0].type in form.stages and form.is_of(StageReader(str(path), model, chosen[0])):
            return kind_system, reader
    raise FileError(path, reason=f"{chosen[0].in_full}: gears of this form are not read")


@dataclass(frozen=True, repr=False)
class RexsExport(Result):
    """REXS model of a design: a new model, or the model from which the design was read, with its gears updated.

    The suffix selects the format: ".rexs" is XML, ".rexsj" is JSON, ".rexsz" is zipped.
    """

    #: the design
    design: Design
    #: the model
    _model: RexsModel
    #: type and id of the stage
    stage: str
    #: keys of the design without an attribute in the format; they are written as attributes of this program
    own_keys: tuple[str, ...]
    #: warnings, one line each
    warnings: tuple[str, ...] = ()

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, *REXS_SUFFIXES)

    @property
    def headline(self) -> str:
        return f"{self.stage}: {len(self._model.components)} components, {len(self.own_keys)} keys without a REXS attribute"

    @property
    def listings(self) -> list[Listing]:
        return [Listing("Written as attributes of this program", ("key",), [[key] for key in self.own_keys])]

    def to_dict(self) -> dict[str, list[Any]]:
        return {"key": list(self.own_keys)}

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "stage": self.stage, "own_keys": list(self.own_keys)}

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_file

        with whole_file(target) as file:
            file.write_bytes(rexs_bytes(self._model, target))


def refuse_kind(design: Design) -> StageForm:
    """Return how stages of the kind of a design are written.

    Raises DesignError for kinds that the format does not have.
    """
    form = system_of(design).rexs
    if form is None:
        having = ", ".join(f'"{kind_system.kind}"' for kind_system, _ in _forms())
        raise DesignError("kind", design.kind, reason="REXS has no such stage", allowed=having)
    return form


def rexs_of(pinned: Pinned, folder: Path, loaded: LoadedContact | None = None) -> RexsExport:
    """Return the REXS model of a pinned design, for a file in `folder`.

    Loaded contact is written as load cases, one per torque. Raises DesignError for kinds that the format does not have,
    and FileError for an unreadable source file of the design.
    """
    form = refuse_kind(pinned.design)
    design = pinned.design.in_mm()
    source: RexsSource | None = getattr(design, "rexs", None)
    model = RexsModel() if source is None else read_rexs(source.file)
    known = None if source is None else model.component(source.stage)
    if source is not None and known is None:
        raise DesignError("rexs.stage", source.stage, reason=f"{source.file} has no component of this id")
    model.version, model.application, model.application_version = WRITTEN_VERSION, "gearmesh", __version__
    model.date = model.date or DEFAULT_DATE
    plain = counted_from(every_key(design, PHI1_RANGE_KEYS), type(design), folder)
    keys = {key: value for key, value in values_of(plain) if not key.startswith("rexs.")}
    writer = StageWriter(model, keys)
    stage = form.write(writer, design, known)
    own_keys = tuple(writer.keys)
    writer.put_own(stage)
    if loaded is not None:
        _put_results(writer, stage, loaded)
    return RexsExport(pinned.design, model, str(stage), own_keys)


def _put_results(writer: StageWriter, stage: Component, loaded: LoadedContact) -> None:
    """Add a load case for each torque: the torques on both gears, and results of loaded contact over the mesh cycle."""
    model = writer.model
    first, second = next(
        (model.component(relation.in_role("gear_1")), model.component(relation.in_role("gear_2")))
        for relation in model.relations_of("stage", "stage", stage.id)
    )
    model.spectrum = model.spectrum or "1"
    taken = max((parse_whole_number(relation.id) or 0 for relation in model.load_cases), default=0)
    for number, rows in enumerate(_by_torque(loaded.rows), start=taken + 1):
        case_stage, te = Component(stage.id, stage.type), [row.te for row in rows]
        for name, value, unit in (
            ("loaded_transmission_error_peak_to_peak", (max(te) - min(te)) / 3600.0, "deg"),
            ("largest_contact_pressure", max(row.peak_pressure for row in rows), "N / mm^2"),
        ):
            writer.put_custom(case_stage, name, value, unit)
        components = [case_stage]
        for gear, torque in ((first, rows[0].torque), (second, rows[0].gear_torque)):
            if gear is not None:
                data = writer.partner(
                    "stage_gear_data", "gear", gear, "stage_gear_data", f"{stage.type}_gear_data", gear.name
                )
                writer.relate("stage_gear_data", {"stage": stage, "gear": gear, "stage_gear_data": data})
                of_case = Component(data.id, data.type)
                writer.put(of_case, "torque", torque)
                components.append(of_case)
        model.load_cases.append(LoadCase(str(number), components, model.spectrum))


def _by_torque(rows: list[LoadedPosition]) -> list[list[LoadedPosition]]:
    torques = list(dict.fromkeys(row.torque for row in rows))
    return [[row for row in rows if row.torque == torque] for torque in torques]
