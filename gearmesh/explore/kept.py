"""Parts that gears and trains on a page share: work that is asked for, kept meshes with marks of surfaces, plain figures."""

from __future__ import annotations

import hashlib
import json
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from gearmesh.design.core import Design
from gearmesh.figures import Summary, at_resolution
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.pickling import fingerprint
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.view.report.staged_member import MEMBER_PAINTS, StagedMember, shape_data

if TYPE_CHECKING:
    from gearmesh.teeth.tooth import Tooth

#: tolerances of the meshes that are shown one after the other, over the module
TOLERANCE_MODULES = (0.02, 0.002)
#: smallest and largest of these tolerances, mm
TOLERANCE_LIMITS_MM = (0.002, 0.1)
#: limit of the states that are kept
MAX_KEPT_STATES = 12
#: limit of the bytes of meshes that are kept
MAX_KEPT_SHAPE_BYTES = 24_000_000
#: triangles of a fine mesh up to which it takes hardly longer than a coarse one, so that no coarse one goes before it
FEW_TRIANGLES = 40_000
#: figures at the head of the list, by the beginning of their keys
MAIN_FIGURES = (
    "contact_ratio",
    "mesh_te_peak_to_peak",
    "backlash_normal_min",
    "backlash_min",
    "tip_clearance",
    "interference",
)


Kept = TypeVar("Kept")


class Stale(BaseException):
    """The work is not wanted any more; no handler of other errors must stop it."""


class Shelf(Generic[Kept]):
    """Things by key, the last used of which are kept up to a limit."""

    def __init__(self, limit: int, size: Callable[[Kept], int] = lambda thing: 1) -> None:
        self._limit, self._size = limit, size
        self._things: OrderedDict[str, Kept] = OrderedDict()

    def get(self, key: str) -> Kept | None:
        """Return what is kept under a key, or None."""
        if key in self._things:
            self._things.move_to_end(key)
        return self._things.get(key)

    def put(self, key: str, thing: Kept) -> Kept:
        """Keep a thing and return it; what was not used for the longest time goes."""
        self._things[key] = thing
        self._things.move_to_end(key)
        while len(self._things) > 1 and sum(map(self._size, self._things.values())) > self._limit:
            self._things.popitem(last=False)
        return thing


@dataclass(frozen=True, eq=False)
class Shape:
    """Mesh of a member, packed for a page."""

    #: key of the shape
    key: str
    #: arrays of the mesh, as the page reads them
    data: dict[str, Any]
    #: greatest distance of a vertex from the origin, mm
    reach: float
    #: mesh of the whole member, own frame
    whole: TriangleMesh

    @property
    def size(self) -> int:
        """Bytes, about."""
        packed = sum(len(text) for part in self.data.values() for text in part.values() if isinstance(text, str))
        mesh = self.whole
        return packed + mesh.vertices.nbytes + mesh.triangles.nbytes + mesh.regions.nbytes + mesh.normals.nbytes


@dataclass
class Job:
    """Work for one message of a page."""

    #: called with each answer
    answer: Callable[[dict[str, Any]], None]
    #: True if the work is not wanted any more
    is_stale: Callable[[], bool] = lambda: False
    #: part of the work that is done, and its name
    doing: str = ""
    #: share of the whole work at which the present stage begins, and at which it ends
    stage: tuple[float, float] = (0.0, 1.0)

    def check(self) -> None:
        """Raise Stale if the work is not wanted any more."""
        if self.is_stale():
            raise Stale

    def say(self, kind: str, **fields: Any) -> None:
        """Answer with a message of a kind."""
        self.check()
        self.answer({**fields, "type": kind})

    def begin(self, doing: str, first: float, last: float) -> None:
        """Begin a stage of the work."""
        self.doing, self.stage = doing, (first, last)
        self.progress(0.0)

    def progress(self, share: float) -> None:
        """Report how far the present stage is."""
        first, last = self.stage
        self.say("progress", doing=self.doing, share=round(first + share * (last - first), 3))


class MeshStore:
    """MeshStore of members by the marks of their surfaces, and cameras that see them."""

    def __init__(self) -> None:
        self.shapes: Shelf[Shape] = Shelf(MAX_KEPT_SHAPE_BYTES, lambda shape: shape.size)
        # triangles of the last fine mesh of each member
        self.triangles: Shelf[int] = Shelf(MAX_KEPT_STATES)
        self.cameras: Shelf[dict[str, Any]] = Shelf(MAX_KEPT_STATES)

    @staticmethod
    def tolerances(design: Design) -> tuple[float, float]:
        """Return the tolerances (mm) of the coarse and of the fine meshes of a complete design."""
        module = design.given_module * design.mm_per_unit
        coarse, fine = (float(np.clip(modules * module, *TOLERANCE_LIMITS_MM)) for modules in TOLERANCE_MODULES)
        return coarse, fine

    def shapes_of(
        self,
        members: Mapping[str, Member],
        marks: Mapping[str, str],
        tolerance: float,
        fine: float,
        job: Job,
        share: float,
    ) -> list[Shape]:
        """Return the meshes of all members within a tolerance (mm); a fine one takes its place if it is there, or made as soon."""
        shapes = []
        for name, member in members.items():
            is_soon = (self.triangles.get(name) or np.inf) <= FEW_TRIANGLES
            known = self.known_shape(marks[name], fine)
            shapes.append(known or self._shape(member, marks[name], fine if is_soon else tolerance, job, share))
            if tolerance == fine:
                self.triangles.put(name, shapes[-1].whole.triangle_count)
        return shapes

    def known_shape(self, mark: str, tolerance: float) -> Shape | None:
        return self.shapes.get(_shape_key(mark, tolerance))

    def _shape(self, member: Member, mark: str, tolerance: float, job: Job, share: float) -> Shape:
        """Return the packed mesh of a member within a tolerance (mm); known surfaces keep their mesh."""
        known = self.known_shape(mark, tolerance)
        if known is not None:
            return known
        job.begin(f"mesh of {member.name} within {1e3 * tolerance:.3g} um", share, share + 0.1)
        staged, key = StagedMember.of(member, tolerance, lean=False), _shape_key(mark, tolerance)
        return self.shapes.put(key, Shape(key, shape_data(staged), staged.reach, staged.whole))


def surface_marks(train: GearTrain) -> dict[str, str]:
    """Return marks of the surfaces of the members; computed before the members remember anything of their use."""
    paints = dict[str, int]()
    marks = {}
    for name, member in train.members.items():
        surfaces = fingerprint((member.tooth, member.features, member.rows, member.overhang))[:24]
        paint = paints.setdefault(surfaces, len(paints)) % len(MEMBER_PAINTS)
        marks[name] = f"{surfaces}/{paint}"
    return marks


def contact_mark(train: GearTrain) -> str:
    """Return a mark of all on which the contact of the pairs depends: not of the bodies under the teeth; "" if none can be made.

    Computed before the members remember anything of their use.
    """
    parts = []
    for pair in train.pairs:
        if pair.generation is not None:
            return ""
        for member in pair.both:
            teeth = [_without_body(tooth) for tooth in (member.tooth, *member.others.values())]
            parts.append([teeth, sorted(member.others), *_values_of(member, "tooth", "others", "features")])
        parts.append(_values_of(pair, "pinion", "gear"))
    return fingerprint(parts)[:24]


def _without_body(tooth: Tooth) -> list[Any]:
    return [_values_of(tooth.blank, "body"), _values_of(tooth, "blank")]


def _values_of(record: Any, *left_out: str) -> list[Any]:
    """Return the values of the fields of a record without some of them."""
    return [getattr(record, field.name) for field in fields(record) if field.name not in left_out]


def shown_figures(summary: Summary, main_keys: Sequence[str] = MAIN_FIGURES) -> Iterator[dict[str, Any]]:
    """Yield the figures that are numbers, the main ones first."""
    entries = [entry for entry in summary.flat.entries if entry.figure.shown and not entry.figure.timing]
    ranks = {
        entry.key: next((k for k, main in enumerate(main_keys) if entry.key.startswith(main)), None)
        for entry in entries
    }
    for entry in sorted(entries, key=lambda entry: (ranks[entry.key] is None, ranks[entry.key])):
        value = at_resolution(entry.known, entry.figure.resolution)
        if isinstance(value, bool) or not isinstance(value, int | float | None):
            continue
        yield {
            "key": entry.key,
            "about": entry.figure.meaning,
            "symbol": entry.figure.symbol,
            "unit": entry.figure.unit,
            "value": None if value is None or not np.isfinite(value) else value,
            "main": ranks[entry.key] is not None,
        }


def _shape_key(mark: str, tolerance: float) -> str:
    return mark_of([mark, f"{tolerance:.9g}"])


def mark_of(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=repr).encode()).hexdigest()[:24]
