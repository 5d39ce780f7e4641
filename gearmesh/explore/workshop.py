"""Gears of the states of pages: built, solved and packed in steps, each of which a page shows at once.

What did not change is not computed again:

- a state that was shown before, as after undo;
- the gears, where only errors of assembly changed: their members are moved, not built;
- the meshes of a member whose surfaces are the same, and their way to a page that has them.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.answers.bodies.questions import ModelledGears
from gearmesh.design.core import Design
from gearmesh.design.keys import MM_PER
from gearmesh.errors import ArgumentError, GearmeshError
from gearmesh.explore.kept import (
    MAX_KEPT_STATES,
    Job,
    MeshStore,
    Shape,
    Shelf,
    Stale,
    contact_mark,
    mark_of,
    shown_figures,
    surface_marks,
)
from gearmesh.explore.keys import error_keys, key_rows, plain_values
from gearmesh.explore.ranges import builds, key_range
from gearmesh.explore.refusals import KeyTable, offers_that_build, refusal
from gearmesh.explore.saving import ALL_MEMBERS, design_file, file_name, gear_file, refuse_file
from gearmesh.explore.state import OPENED_NAME, TRAIN_KIND, Origin, as_stated, design_class_of, refuse_keys, stage_key
from gearmesh.figures import Summary
from gearmesh.formats import HTML_SUFFIX, TOML_SUFFIX
from gearmesh.pickling import as_bytes
from gearmesh.progress import ending_when, listening
from gearmesh.records import dataclass
from gearmesh.systems.displaced import displaced_bases, displaced_pair
from gearmesh.systems.system import build, complete_design, system_of
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.kept_by_tooth import stand_for
from gearmesh.view.report.staged_member import (
    camera_data,
    fitted,
    member_data,
)
from gearmesh.view.views import pair_scene, set_scene

if TYPE_CHECKING:
    from gearmesh.answers.contact.contact import Contact
    from gearmesh.explore.trains import TrainBench
    from gearmesh.teeth.tooth import Tooth

#: limit of the built gears that are kept
MAX_KEPT_GEARS = 4
#: messages of a state that are kept; curves come again with their scene
KEPT_MESSAGES = ("design", "figures", "scene")


@dataclass
class Built:
    """Gears of a design, with the marks of the surfaces of their members."""

    gears: ModelledGears
    #: mark of the surfaces of each member, equal for equal surfaces
    marks: dict[str, str]
    #: mark of all on which the contact depends; "" without one
    contact: str


@dataclass
class Solved:
    """Solved contact of gears, and of all other gears with the same teeth in the same places."""

    #: contacts by the numbers of their pairs
    contacts: dict[int, Contact]
    #: warnings of the contacts alone
    lines: list[str]
    #: data of the pairs for the view, with all fields
    pairs: list[dict[str, Any]]


class Workshop:
    """Gears of the states of pages."""

    def __init__(self, opened: Origin | None) -> None:
        self.origins = {} if opened is None else {OPENED_NAME: opened}
        self.states: Shelf[list[dict[str, Any]]] = Shelf(MAX_KEPT_STATES)
        self.built: Shelf[Built] = Shelf(MAX_KEPT_GEARS)
        # teeth by their bytes when they were new
        self.teeth: Shelf[Tooth] = Shelf(MAX_KEPT_STATES)
        self.solved: Shelf[Solved] = Shelf(MAX_KEPT_STATES)
        # first and last position of the contact of each pair
        self.ends: Shelf[dict[int, tuple[float, float]]] = Shelf(MAX_KEPT_STATES)
        self.meshes = MeshStore()

    def answer(self, request: Mapping[str, Any], job: Job) -> None:
        """Answer one message of a page. Errors of gearmesh are answers, too; raises Stale if it is not wanted any more."""
        questions = {
            "show": self._show,
            "range": self._range,
            "file": self._file,
            "open": self._open,
            "start": self._start,
        }
        try:
            question = questions.get(str(request.get("do")))
            if question is None:
                raise ArgumentError("do", must_be=f"one of {', '.join(questions)}")
            # work ends where it reports progress, and wherever a surface is evaluated
            with listening(job.progress), ending_when(job.is_stale):
                try:
                    question(request, job)
                except GearmeshError as error:
                    self._refuse(request, job, error)
        except CancelledError:
            raise Stale from None

    def _refuse(self, request: Mapping[str, Any], job: Job, error: GearmeshError) -> None:
        """Send a refusal; of gears that were to be shown at once, then again with offers that build."""
        design: KeyTable = Design
        mm_per_unit = 1.0
        try:
            if _is_train(request):
                from gearmesh.explore.trains import StageKeys

                design = stages = StageKeys(request["keys"], self._origin(request.get("from")))
                mm_per_unit = stages.mm_per_unit(stage_key(error.key)[0])
            else:
                design = design_class_of(request["keys"])
                mm_per_unit = MM_PER["inch" if request["keys"].get("units") == "inch" else "mm"]
        except (GearmeshError, LookupError, TypeError, AttributeError):
            pass
        told = refusal(error, design, mm_per_unit)
        if request.get("do") != "show":
            job.say("refused", **told)
            return
        job.say("refused", **{**told, "offers": []})
        try:
            keys, origin = refuse_keys(request.get("keys")), self._origin(request.get("from"))
        except GearmeshError:
            return
        job.begin("which values build", 0.0, 1.0)

        def works(changes: Mapping[str, Any]) -> bool:
            job.check()
            try:
                changed = {**keys, **changes}
                return (
                    self.trains.builds(changed, origin)
                    if _is_train(request)
                    else builds(as_stated(changed, origin), {})
                )
            except GearmeshError:
                return False

        offers = offers_that_build(told["offers"], request, design, works)
        if offers:
            job.say("refused", **{**told, "offers": offers})

    # ---------------------------------------------------------------- questions

    def _origin(self, name: Any) -> Origin:
        if not isinstance(name, str) or len(name) > 80:
            raise ArgumentError("from", must_be="a text")
        if name not in self.origins:
            if name == OPENED_NAME:
                raise ArgumentError("from", name, reason="the program was started without a design")
            self.origins[name] = Origin.find(name)
        return self.origins[name]

    def _start(self, request: Mapping[str, Any], job: Job) -> None:
        """List the kinds and the samples."""
        from gearmesh import samples
        from gearmesh.systems.system import about, loaded_kinds

        names = [name for name in samples.names() if samples.path(name).suffix == TOML_SUFFIX]
        job.say(
            "start",
            kinds=[{"name": kind, "about": about(kind)} for kind in loaded_kinds()],
            samples=[{"name": name, "about": samples.headline(name)} for name in names],
            opened=OPENED_NAME in self.origins,
        )

    def _open(self, request: Mapping[str, Any], job: Job) -> None:
        """Send the keys of a kind, a sample or the opened design."""
        job.say("opened", **self._origin(request.get("from")).state)

    def _range(self, request: Mapping[str, Any], job: Job) -> None:
        """Send the range of a key with which the gears can be built."""
        dotted = request.get("key")
        if not isinstance(dotted, str):
            raise ArgumentError("key", must_be="a key with a number")
        works: Callable[[float], bool]
        if _is_train(request):
            keys, origin = refuse_keys(request.get("keys")), self._origin(request.get("from"))
            design, own = self.trains.stage_design(keys, origin, dotted)

            def works(tried: float) -> bool:
                job.check()
                return self.trains.builds({**keys, dotted: tried}, origin)

        else:
            design, own = self._stated(request), dotted

            def works(tried: float) -> bool:
                job.check()
                return builds(design, {own: tried})

        key = type(design).key_at(own)
        if key is None or not key.is_numeric:
            raise ArgumentError("key", must_be="a key with a number")
        job.begin(f"which values of {dotted} build", 0.0, 1.0)
        whole = complete_design(design)
        value = dict(plain_values(whole)).get(own)
        if not isinstance(value, int | float):
            raise ArgumentError("key", dotted, reason="has no value from which to search")
        found = key_range(whole, own, value, works)
        job.say("range", key=dotted, value=value, **vars(found))

    def _file(self, request: Mapping[str, Any], job: Job) -> None:
        """Send a file that the browser saves."""
        suffix, member = request.get("suffix"), request.get("member")
        refuse_file(suffix, member)
        origin = self._origin(request.get("from"))
        if _is_train(request):
            self._train_file(request, origin, str(suffix), str(member), job)
            return
        design = self._stated(request)
        source = design_file(request["keys"], origin)
        content, name = source, file_name(design.title, str(member), str(suffix))
        if suffix != TOML_SUFFIX:
            job.begin("gears", 0.0, 0.1)
            gears = self._gears(design).gears
            if member not in (*gears.members, ALL_MEMBERS):
                raise ArgumentError("member", str(member), must_be=f"one of {', '.join(gears.members)}, {ALL_MEMBERS}")
            job.begin(f"file {suffix}", 0.1, 1.0)
            contacts = {k: gears.contact(pair=k) for k in gears.train.different} if suffix == HTML_SUFFIX else {}
            content = gear_file(gears, contacts, name, str(member), source.decode())
        job.say("file", name=name, content=base64.b64encode(content).decode("ascii"))

    def _train_file(self, request: Mapping[str, Any], origin: Origin, suffix: str, member: str, job: Job) -> None:
        """Send a file of a train."""
        from gearmesh.explore.trains import stated_train, train_content

        file = stated_train(refuse_keys(request.get("keys")), origin)
        content, name = design_file(request["keys"], origin), file_name(file.title, member, suffix)
        if suffix != TOML_SUFFIX:
            job.begin("gears of all stages", 0.0, 0.1)
            train = self.trains.train(file)
            bodies = self.trains.bodies(train)
            if member not in (*bodies, ALL_MEMBERS):
                raise ArgumentError("member", member, must_be=f"one of {', '.join(bodies)}, {ALL_MEMBERS}")
            job.begin(f"file {suffix}", 0.1, 1.0)
            content = train_content(train, name, suffix, member, ALL_MEMBERS)
        job.say("file", name=name, content=base64.b64encode(content).decode("ascii"))

    def _stated(self, request: Mapping[str, Any]) -> Design:
        """Return the design of a state; a refusal looks first at the key that the page changed last."""
        design = as_stated(refuse_keys(request.get("keys")), self._origin(request.get("from")))
        last = request.get("last")
        return design.with_changed_keys([last]) if isinstance(last, str) else design

    # ---------------------------------------------------------------- gears

    def _show(self, request: Mapping[str, Any], job: Job) -> None:
        """Send design, figures and scene of a state, the meshes first coarse, then fine."""
        have = request.get("have")
        have = [key for key in have if isinstance(key, str)] if isinstance(have, list) else []
        have.append(str(request.get("rows")))
        keys = refuse_keys(request.get("keys"))
        mark = mark_of([request.get("from"), sorted(keys.items())])
        known = self.states.get(mark)
        if known is None:
            known = []
            for message in self._messages(request, job, is_bare=len(have) == 1):
                if message["type"] in KEPT_MESSAGES and not message.get("later"):
                    known.append(message)
                job.answer(_sent(message, have))
                # a page keeps the meshes of the scene that it shows, and no others
                have = [shape["key"] for shape in message["shapes"]] if message["type"] == "scene" else have
                job.check()
            self.states.put(mark, known)
            return
        # meshes that a finer one follows are not sent again
        last = max((k for k, message in enumerate(known) if message["type"] == "scene"), default=-1)
        for k, message in enumerate(known):
            if message["type"] != "scene" or k == last:
                job.check()
                job.answer(_sent(message if k != last else self._whole_scene(known), have))

    def _messages(self, request: Mapping[str, Any], job: Job, *, is_bare: bool) -> Iterator[dict[str, Any]]:
        """Return the messages of a state: gears of a design, or a train."""
        if _is_train(request):
            from gearmesh.explore.trains import stated_train

            return self.trains.steps(stated_train(request["keys"], self._origin(request.get("from"))), job)
        return self._steps(self._stated(request), job, is_bare=is_bare)

    @cached_property
    def trains(self) -> TrainBench:
        """Trains of pages."""
        from gearmesh.explore.trains import TrainBench

        return TrainBench(self.meshes)

    @staticmethod
    def _whole_scene(messages: Sequence[dict[str, Any]]) -> dict[str, Any]:
        """Return the last scene of a state with the camera and the contact that came with others."""
        whole: dict[str, Any] = {}
        for message in messages:
            whole |= message if message["type"] == "scene" else {}
        return whole

    def _steps(self, design: Design, job: Job, *, is_bare: bool) -> Iterator[dict[str, Any]]:
        """Yield the messages of a state; a bare page gets gears before their contact is solved."""
        job.begin("gears", 0.0, 0.2)
        built = self._gears(design)
        gears, train = built.gears, built.gears.train
        whole = gears.design
        own = system_of(whole)
        yield {
            "type": "design",
            "title": whole.title,
            "kind": whole.kind,
            "kind_in_words": whole.kind_in_words,
            "units": whole.units,
            "values": dict(plain_values(whole)),
            "of": f"{type(whole).__name__}/{whole.units}",
            "rows": key_rows(type(whole), whole.units),
            "errors": error_keys(own, type(whole)),
            "members": list(gears.members),
        }
        coarse, fine = self.meshes.tolerances(whole)
        names = list(gears.members)
        different = train.different if train.pairs else ()
        # where no tooth changed, contact at few positions is there long before the mesh cycle
        positions = mark_of([sorted(built.marks.items()), whole.contact.stated()])
        solved = built.contact and mark_of([built.contact, whole.contact.stated()])
        known = self.solved.get(solved) if solved else None
        if known is not None:
            yield from self._known_contact(built, known, (coarse, fine), job)
            return
        first = self._first_scene(gears, built.marks, fine, self.ends.get(positions))
        if first is not None:
            yield first
        elif is_bare:
            shapes = self.meshes.shapes_of(gears.members, built.marks, coarse, fine, job, 0.1)
            still = self._still(gears, built.marks, shapes)
            yield {"type": "scene", **still, "pairs": [], "waiting": bool(different)}
        # the solver is loaded when the first gears are on the screen
        from gearmesh.explore.pairs import few_solved, solve_contact, solve_mesh, staged

        meshes, contacts = {}, {}
        for number, k in enumerate(different):
            share = 0.2 + 0.4 * number / len(different)
            job.begin(f"mesh of {train.pairs[k].name}", share, share + 0.3 / len(different))
            meshes[k] = solve_mesh(train.pairs[k])
            yield {
                "type": "figures",
                "later": True,
                "meshes": [
                    _mesh_figures(train.pairs[m].name, mesh.summary(train.pairs[m])) for m, mesh in meshes.items()
                ],
                "warnings": [],
            }
            job.begin(f"contact of {train.pairs[k].name}", share + 0.3 / len(different), share + 0.4 / len(different))
            contacts[k] = solve_contact(gears, k, meshes[k])
        self.ends.put(positions, {k: (contact.path.phi1[0], contact.path.phi1[-1]) for k, contact in contacts.items()})
        # warnings of the contacts follow those of the gears
        lines = [line for contact in contacts.values() for line in contact.warnings[len(gears.warnings) :]]
        yield _all_figures(gears, contacts, lines)
        moving = {k: contact for k, contact in contacts.items() if contact.path.touching.any() and not contact.stuck}
        if first is None:
            # the pattern at the positions of the figures: curves at once, then on coarse gears
            pairs = few_solved(train, moving.values(), names)
            if pairs is not None:
                members = [member_data(member, 0, 0.0) for member in gears.members.values()]
                yield {"type": "curves", "pairs": pairs, "members": members}
                shapes = self.meshes.shapes_of(gears.members, built.marks, coarse, fine, job, 0.6)
                yield {"type": "scene", **self._still(gears, built.marks, shapes), "pairs": pairs}
        job.begin("contact pattern", 0.7, 0.85)
        pairs = staged(train, moving.values(), names)
        if solved:
            self.solved.put(solved, Solved(contacts, lines, pairs))
        shapes = self.meshes.shapes_of(gears.members, built.marks, fine, fine, job, 0.85)
        yield {"type": "scene", **self._still(gears, built.marks, shapes), "pairs": pairs}

    def _known_contact(
        self, built: Built, known: Solved, tolerances: tuple[float, float], job: Job
    ) -> Iterator[dict[str, Any]]:
        """Yield the messages of gears whose contact is known from gears with the same teeth."""
        gears, marks, shown = built.gears, built.marks, list[str]()
        yield _all_figures(gears, known.contacts, known.lines)
        for tolerance in tolerances:
            shapes = self.meshes.shapes_of(gears.members, marks, tolerance, tolerances[1], job, 0.5)
            if shown != [shape.key for shape in shapes]:
                shown = [shape.key for shape in shapes]
                yield {"type": "scene", **self._still(gears, marks, shapes), "pairs": known.pairs}

    def _still(self, gears: ModelledGears, marks: Mapping[str, str], shapes: Sequence[Shape]) -> dict[str, Any]:
        """Return the scene of gears without their contact."""
        return {"camera": self._camera(gears, marks, shapes), **_scene(gears.members, shapes), "waiting": False}

    def _gears(self, design: Design) -> Built:
        """Return the gears of a design; where only errors of assembly differ, those of a known design are moved."""
        errors = {key: _value(design, key) for key in error_keys(system_of(design), type(design))}
        stated = {key: error for key, error in errors.items() if design.sets(key)}
        still = self._built(design.with_values(dict.fromkeys(stated)) if stated else design)
        if not any(errors.values()):
            return still
        if len(still.gears.train.pairs) != 1:
            return self._built(design)
        mark = still.contact and mark_of([still.contact, sorted(errors.items())])
        return Built(_moved(still.gears, errors, stated), still.marks, mark)

    def _built(self, design: Design) -> Built:
        """Return the gears of a design; known ones are not built again."""
        mark = mark_of(design.stated())
        known = self.built.get(mark)
        if known is None:
            complete = complete_design(design)
            train = build(complete)
            self._share(train)
            known = self.built.put(
                mark, Built(ModelledGears(complete, train), surface_marks(train), contact_mark(train))
            )
        return known

    def _share(self, train: GearTrain) -> None:
        """Let members that a key leaves as they were use the tables that the solver has made of them.

        Called before teeth remember anything of their use.
        """
        for member in train.members.values():
            mark = hashlib.sha256(as_bytes(member.tooth)).hexdigest()
            known = self.teeth.get(mark) or self.teeth.put(mark, member.tooth)
            if known is not member.tooth:
                stand_for(known, member.tooth)

    def _first_scene(
        self,
        gears: ModelledGears,
        marks: Mapping[str, str],
        tolerance: float,
        ends: dict[int, tuple[float, float]] | None,
    ) -> dict[str, Any] | None:
        """Return the scene with contact at few positions between the `ends` of an earlier one.

        None unless meshes and ends are known from other positions of the same teeth.
        """
        names = list(gears.members)
        shapes = [shape for name in names if (shape := self.meshes.known_shape(marks[name], tolerance)) is not None]
        if len(shapes) != len(names) or not ends:
            return None
        from gearmesh.explore.pairs import few_positions

        pairs = few_positions(gears.train, ends, names)
        return {"type": "scene", **self._still(gears, marks, shapes), "pairs": pairs} if pairs else None

    def _camera(self, gears: ModelledGears, marks: Mapping[str, str], shapes: Sequence[Shape]) -> dict[str, Any]:
        """Return the camera that sees all gears as they are mounted; it stays while their surfaces stay."""
        mark = mark_of(sorted(marks.items()))
        known = self.meshes.cameras.get(mark)
        if known is not None:
            return known
        pairs, members = gears.train.pairs, gears.members
        meshes = {name: shape.whole for name, shape in zip(members, shapes, strict=True)}
        if len(pairs) == 1:
            (pair,) = pairs
            first, second = (meshes[name] for name in pair.members)
            seen = pair_scene(first, second, pair, (0.0, 0.0))
        else:
            axis = next(iter(members.values())).mount.axis if not pairs else pairs[0].pinion.mount.axis
            placed = {name: meshes[name].move(member.mount.at(0.0)) for name, member in members.items()}
            seen = set_scene(placed, axis)
        return self.meshes.cameras.put(mark, camera_data(fitted(seen)))


# ---------------------------------------------------------------- parts of answers


def _is_train(request: Mapping[str, Any]) -> bool:
    """True for a question about a train of several stages."""
    keys = request.get("keys")
    return isinstance(keys, dict) and keys.get("kind") == TRAIN_KIND


def _moved(gears: ModelledGears, errors: Mapping[str, float], stated: Mapping[str, float]) -> ModelledGears:
    """Return the gears of one pair with errors of assembly; the teeth stay, only the mounts move.

    `errors`: all of them by dotted key, in the units of the design; `stated`: those that the design sets.
    """
    train, (pair,) = gears.train, gears.train.pairs
    values = {key: np.array([error]) for key, error in errors.items()}
    moved = displaced_pair(pair, displaced_bases(gears.design, train, pair, values))
    return ModelledGears(gears.design.with_values(stated), replace(train, pairs=(moved,)))


def _value(design: Design, dotted: str) -> float:
    """Return the value of a key of a design."""
    value: Any = design
    for name in dotted.split("."):
        value = getattr(value, name)
    return float(value)


def _scene(members: Mapping[str, Member], shapes: Sequence[Shape]) -> dict[str, Any]:
    """Return members and shapes of a scene; members with one shape share it."""
    keys = list(dict.fromkeys(shape.key for shape in shapes))
    by_key = {shape.key: shape for shape in shapes}
    return {
        "shapes": [{"key": key, **by_key[key].data} for key in keys],
        "members": [
            member_data(member, keys.index(shape.key), shape.reach)
            for member, shape in zip(members.values(), shapes, strict=True)
        ],
    }


def _all_figures(gears: ModelledGears, contacts: Mapping[int, Contact], lines: Sequence[str]) -> dict[str, Any]:
    """Return the message of all figures; `lines`: warnings of the contacts."""
    return {
        "type": "figures",
        "later": False,
        "meshes": [_mesh_figures(each.pair.name, each.summary) for each in contacts.values()],
        "warnings": list(dict.fromkeys([*gears.warnings, *lines])),
    }


def _mesh_figures(name: str, summary: Summary) -> dict[str, Any]:
    """Return the figures of a mesh with its name."""
    return {"name": name, "figures": list(shown_figures(summary))}


def _sent(message: Mapping[str, Any], have: Sequence[str]) -> dict[str, Any]:
    """Return a message without the meshes and the list of keys that the page has."""
    if message["type"] == "design" and message["of"] in have:
        return {key: value for key, value in message.items() if key != "rows"}
    if message["type"] != "scene":
        return dict(message)
    shapes = [{"key": shape["key"]} if shape["key"] in have else shape for shape in message["shapes"]]
    return {**message, "shapes": shapes}
