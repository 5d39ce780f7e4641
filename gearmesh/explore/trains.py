"""Trains on a page: the keys of their stages, their gears in mesh, figures and files.

A page sets the keys of the stages. The shafts, and the files that a train names, stay as its own file has them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.bodies.questions import ModelledGears
from gearmesh.answers.contact.contact import MeshSolution
from gearmesh.answers.contact.fit import fit_warnings
from gearmesh.design.core import Design
from gearmesh.design.dotted import leaves, nested
from gearmesh.design.keys import Key
from gearmesh.errors import ArgumentError, DesignError, GearmeshError, NoSolutionError
from gearmesh.explore.kept import (
    MAIN_FIGURES,
    MAX_KEPT_STATES,
    Job,
    MeshStore,
    Shape,
    Shelf,
    mark_of,
    shown_figures,
    surface_marks,
)
from gearmesh.explore.keys import key_rows, plain_values
from gearmesh.explore.state import STAGES_NAME, Origin, is_file, refuse_file_key, stage_key
from gearmesh.figures import Summary
from gearmesh.formats import DXF_SUFFIX, HTML_SUFFIX, STEP_SUFFIX
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.systems.system import build, system
from gearmesh.trains.bodies import gear_names, joined_shafts
from gearmesh.trains.file import DESIGN_KEY, TRAIN_KIND, TrainFile, TrainKeys, naming_stage, train_of
from gearmesh.trains.stage import CARRIER_NAME, Stage
from gearmesh.trains.train import MultistageTrain, TrainError
from gearmesh.trains.transmission import mesh_motions
from gearmesh.view.report.packing import pack
from gearmesh.view.report.staged_member import camera_data, fitted, member_data
from gearmesh.view.views import set_scene

#: turns of the input up to which the view goes on until all teeth look as they did
MAX_VIEW_TURNS = 8
#: time in which the input turns once in the view, s
SECONDS_PER_TURN = 12.0
#: name of the train among its meshes
WHOLE_NAME = "train"
#: figures of a train at the head of the list
TRAIN_FIGURES = ("ratio", "te_peak_to_peak_arcsec", "speed", "torque")
#: those of a rack, and of a train that ends in one
RACK_FIGURES = ("travel_mm", "te_peak_to_peak_um", "force")


class StageKeys:
    """Keys of all stages of a train by their dotted names, as `Design.key_at` has those of one design."""

    def __init__(self, keys: Mapping[str, Any], origin: Origin) -> None:
        self._tables = nested(keys).get(STAGES_NAME, {})
        self._origin = origin

    def design(self, stage: str) -> type[Design]:
        """Return the class of the design of a stage. Raises DesignError."""
        table = self._tables.get(stage, {})
        if f"{STAGES_NAME}.{stage}.{DESIGN_KEY}" in self._origin.named:
            return type(opened_train(self._origin).stages[stage])
        with naming_stage(stage):
            return system(table.get("kind")).of_keys(table).design

    def mm_per_unit(self, stage: str) -> float:
        """Return the length of a unit of the keys of a stage, mm."""
        return 25.4 if self._tables.get(stage, {}).get("units") == "inch" else 1.0

    def key_at(self, dotted: str) -> Key | None:
        """Return a key by its dotted name, None without one."""
        stage, rest = stage_key(dotted)
        try:
            return self.design(stage).key_at(rest) if stage else TrainKeys.key_at(rest)
        except (GearmeshError, LookupError):
            return None


def opened_train(origin: Origin) -> TrainFile:
    """Return the train of an origin as it was opened."""
    return train_of(nested(origin.keys), Path())


def stated_train(keys: Mapping[str, Any], origin: Origin) -> TrainFile:
    """Return the train of the keys of a page, with the shafts and files of its origin. Raises DesignError."""
    known = StageKeys(keys, origin)
    for key in keys:
        stage, rest = stage_key(key)
        if key.startswith("shafts"):
            raise DesignError(key, reason="shafts stay as the file has them", remedy="set it in the file of the train")
        if stage and (rest == DESIGN_KEY or is_file(known.design(stage), rest)):
            refuse_file_key(key)
    return train_of(nested({**keys, **origin.files}), Path())


def try_train(origin: Origin) -> None:
    """Raise what refuses the train of an origin."""
    assert MultistageTrain(opened_train(origin)).layout


# ---------------------------------------------------------------- gears


@dataclass
class BuiltStage:
    """A stage with the marks of the surfaces of its members, and its figures."""

    #: the stage
    stage: Stage
    #: marks of the members
    marks: dict[str, str]
    #: figures and warnings of its meshes by the flanks that carry, +1 or -1, as they were solved
    solved: dict[tuple[int, ...], list[tuple[str, Summary, tuple[str, ...]]]]


class TrainBench:
    """Trains of pages, of which only the stages that change are built and solved again."""

    def __init__(self, meshes: MeshStore) -> None:

        self.meshes = meshes
        self.stages: Shelf[BuiltStage] = Shelf(MAX_KEPT_STATES)

    def built(self, file: TrainFile, *, keeping: bool = True) -> dict[str, BuiltStage]:
        """Return the stages of a train; known ones are not built again. `keeping`: new ones are kept."""

        found = {}
        for name, design in file.stages.items():
            mark = mark_of([name, design.resolve()])
            known = self.stages.get(mark)
            if known is None:
                with naming_stage(name):
                    gears = ModelledGears(design, build(design))
                    known = BuiltStage(Stage.of(name, gears), surface_marks(gears.train), {})
                known = self.stages.put(mark, known) if keeping else known
            found[name] = known
        return found

    def train(self, file: TrainFile, *, keeping: bool = True) -> MultistageTrain:
        """Return a train with the stages that are known."""
        built = self.built(file, keeping=keeping)
        return MultistageTrain(file, stages={name: each.stage for name, each in built.items()})

    def builds(self, keys: Mapping[str, Any], origin: Origin) -> bool:
        """True if the train of the keys of a page can be built."""
        try:
            return bool(self.train(stated_train(keys, origin), keeping=False).layout.steps)
        except (DesignError, NoSolutionError):
            return False

    @staticmethod
    def stage_design(keys: Mapping[str, Any], origin: Origin, dotted: str) -> tuple[Design, str]:
        """Return the design of the stage that has a key, and the name of the key in it. Raises DesignError."""
        (stage, own), stages = stage_key(dotted), stated_train(keys, origin).stages
        if stage not in stages:
            raise ArgumentError("key", dotted, must_be="a key of a stage")
        return stages[stage], own

    @staticmethod
    def bodies(train: MultistageTrain) -> list[str]:
        """Return the names of the bodies of a train: gears, and shafts whose gears are joined."""
        joined = joined_shafts(train.layout)
        return list(dict.fromkeys(joined.get(name, name) for name in gear_names(train.layout)))

    def steps(self, file: TrainFile, job: Job) -> Iterator[dict[str, Any]]:
        """Yield the messages of a train."""
        job.begin("gears of all stages", 0.0, 0.3)
        built, train = self.built(file), self.train(file)
        layout = train.layout
        members = {f"{name}.{own}": member for name, stage in layout.stages.items()
                   for own, member in stage.gears.train.members.items()}  # fmt: skip
        yield {
            "type": "design",
            "title": train.title,
            "kind": TRAIN_KIND,
            "kind_in_words": "train of several stages",
            "units": file.keys.units,
            "values": dict(_values(file)),
            "of": "/".join([TRAIN_KIND, *(f"{name}.{type(d).__name__}.{d.units}" for name, d in file.stages.items())]),
            "rows": _rows(file),
            "errors": [],
            "members": self.bodies(train),
            "words": list(dict.fromkeys(name.partition(".")[2] for name in members)),
        }
        found = [_named(WHOLE_NAME, Summary(train.figures))]
        warnings = list(train.warnings)
        for number, (name, stage) in enumerate(layout.stages.items()):
            share = 0.3 + 0.3 * number / len(layout.stages)
            job.begin(f"meshes of the stage {name}", share, share + 0.3 / len(layout.stages))
            with naming_stage(name):
                solved = _solved(built[name], stage)
            found += [_named(f"{name}: {mesh}", summary) for mesh, summary, _ in solved]
            warnings += [f"{name}: {line}" for _, _, lines in solved for line in lines]
            yield {"type": "figures", "later": True, "meshes": found, "warnings": []}
        job.begin("motion and transmission error of the output", 0.6, 0.7)
        error = train.transmission_error(_view_turns(train))
        shafts = [_named(f"shaft {shaft.shaft}", Summary(shaft)) for shaft in train.shafts]
        whole = _named(WHOLE_NAME, Summary(train.figures, error.figures))
        yield {"type": "figures", "later": False, "meshes": [whole, *shafts, *found[1:]],
               "warnings": list(dict.fromkeys(warnings))}  # fmt: skip
        marks = {f"{name}.{own}": mark for name, each in built.items() for own, mark in each.marks.items()}
        pair = self._motion(train, error, list(members))
        for is_fine in (False, True):
            shapes: dict[str, Shape] = {}
            for name, stage in layout.stages.items():
                coarse, fine = self.meshes.tolerances(stage.gears.design)
                own = {key: member for key, member in members.items() if key.startswith(f"{name}.")}
                tolerance, share = (fine, 0.85) if is_fine else (coarse, 0.7)
                made = self.meshes.shapes_of(own, marks, tolerance, fine, job, share)
                shapes |= dict(zip(own, made, strict=True))
            yield {"type": "scene", "camera": self._camera(train, marks, shapes), **_scene(train, shapes),
                   "waiting": False, "pairs": [pair]}  # fmt: skip

    def _motion(self, train: MultistageTrain, error: TrainError, names: list[str]) -> dict[str, Any]:
        """Return the motion of all members over the rotations of the input of an error, in the form of a pair without contact."""
        layout = train.layout
        psi = error.solved.psi * layout.sense
        none = np.full((len(psi), 3), np.nan)
        shafts, ports = layout.follow(psi)
        turns: dict[str, Array] = {}
        carried: dict[str, Array] = {}
        for name, stage in layout.stages.items():
            turned = ports[name]
            turns |= {f"{name}.{own}": turned[own] for own in stage.members}
            if stage.planetary:
                relative = turned[stage.members[0]] - turned[CARRIER_NAME]
                for path in stage.paths:
                    planet = f"{name}.{path.meshes[0].pair.gear.name}"
                    turns[planet], carried[planet] = path.output(relative)[1], turned[CARRIER_NAME]
        return {
            "name": WHOLE_NAME,
            "title": f"Transmission error of the shaft {train.file.output}",
            "members": [],
            "phi1": pack(psi),
            "jumps": [],
            "turns": [pack(turns[name]) for name in names],
            "carried": [pack(carried[name]) if name in carried else None for name in names],
            "shafts": [
                {"name": name, "travel": layout.port(name).joint.travel, "turns": pack(turned)}
                for name, turned in shafts.items()
            ],
            "seconds": SECONDS_PER_TURN * float(np.ptp(psi)) / (2.0 * math.pi),
            "te": pack(error.solved.te / error.reading[0]),
            "te_unit": error.reading[1],
            "kind": [""] * len(psi),
            "delta_um": 0.0,
            "point": pack(none),
            "normal": pack(none),
            "lines": pack(none),
            "flanks": [],
        }

    def _camera(self, train: MultistageTrain, marks: Mapping[str, str], shapes: Mapping[str, Shape]) -> dict[str, Any]:
        """Return the camera that sees all gears; it stays while their surfaces stay."""

        mark = mark_of(["train", sorted(marks.items())])
        known = self.meshes.cameras.get(mark)
        if known is None:
            placed = {name: shapes[name].whole.move(place) for name, place in train.places().items()}
            axis = train.layout.shafts[train.file.input].frame.rotation[:, 2]
            known = self.meshes.cameras.put(mark, camera_data(fitted(set_scene(placed, axis))))
        return known


def _solved(built: BuiltStage, stage: Stage) -> list[tuple[str, Summary, tuple[str, ...]]]:
    """Return name, figures and warnings of the meshes of a stage that differ, on the flanks that carry."""
    pairs = [mesh.pair for mesh in stage.meshes if mesh.like is None]
    flanks = tuple(pair.drive for pair in pairs)
    if flanks not in built.solved:
        found = []
        for pair in pairs:
            mesh = MeshSolution.of(pair)
            lines = () if mesh.fit is None else tuple(fit_warnings(pair, mesh.fit))
            found.append((pair.name, mesh.summary(pair), lines))
        built.solved[flanks] = found
    return built.solved[flanks]


def _named(name: str, summary: Summary) -> dict[str, Any]:
    """Return the figures of a part of a train with its name."""
    slides = any(entry.key == "travel_mm" and entry.known is not None for entry in summary.flat.entries)
    first = RACK_FIGURES if slides else TRAIN_FIGURES
    return {"name": name, "figures": list(shown_figures(summary, (*MAIN_FIGURES, *first)))}


def _view_turns(train: MultistageTrain) -> float:
    """Return the turns of the input after which all teeth look as they did, one turn if these are many."""
    passing = [motion.teeth for step in train.layout.steps for motion in mesh_motions(step)]
    turns = math.lcm(*(each.denominator for each in passing))
    return float(turns) if turns <= MAX_VIEW_TURNS else 1.0


def _values(file: TrainFile) -> Iterator[tuple[str, Any]]:
    """Yield the keys of a train that have a value, by their dotted names, without names of files."""
    yield from ((key, value) for key, value in leaves(file.keys.plain()) if value is not None)
    for name, design in file.stages.items():
        yield from ((f"{STAGES_NAME}.{name}.{key}", value) for key, value in plain_values(design))


def _rows(file: TrainFile) -> list[dict[str, Any]]:
    """Return all keys that a page can set, stage by stage."""
    return [
        {**row, "key": f"{STAGES_NAME}.{name}.{row['key']}"}
        for name, design in file.stages.items()
        for row in key_rows(type(design), design.units)
    ]


def _scene(train: MultistageTrain, shapes: Mapping[str, Shape]) -> dict[str, Any]:
    """Return members and shapes of a scene; members with one shape share it."""
    keys = list(dict.fromkeys(shape.key for shape in shapes.values()))
    by_key = {shape.key: shape for shape in shapes.values()}
    members = []
    for step in train.layout.steps:
        stage = step.stage
        axis = step.place @ stage.ports[stage.members[0]].frame
        for own, member in stage.gears.train.members.items():
            name = f"{step.stage.name}.{own}"
            central = own in stage.members
            base = step.place @ stage.ports[own].frame if central else axis.inverse @ step.place @ member.mount.base
            data = member_data(member, keys.index(shapes[name].key), shapes[name].reach)
            data |= {"name": name, "sign": 1, "zero": 0.0, **_frame(base)}
            members.append(data if central else {**data, "carrier": _frame(axis)})
    return {"shapes": [{"key": key, **by_key[key].data} for key in keys], "members": members}


def _frame(place: Rigid) -> dict[str, Any]:
    """Return a transformation as plain data."""
    return {"rotation": place.rotation.tolist(), "translation": place.translation.tolist()}


# ---------------------------------------------------------------- files


def train_content(train: MultistageTrain, name: str, suffix: str, member: str, everything: str) -> bytes:
    """Return a file of a train with a `name`, as the command `train` makes it. Raises GearmeshError."""
    import tempfile

    if suffix == DXF_SUFFIX:
        raise ArgumentError("suffix", suffix, reason="a section is of the gears of one stage; open its design")
    if suffix == HTML_SUFFIX:
        return train.page().html.encode()
    with tempfile.TemporaryDirectory(prefix="gearmesh-explore-") as folder:
        target = Path(folder) / name
        if suffix == STEP_SUFFIX:
            train.cad().save(target)
        else:
            solids = train.solids(file=target)
            (solids if member == everything else solids.parts[member]).save(target)
        return target.read_bytes()
