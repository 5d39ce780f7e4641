"""Rows of a study: the work of one worker on a chunk. It holds only plain data, so that it can be sent to any worker.

All rows that vary only keys that move members (`System.displacements`) go through one pair of built members in one
batch. Each other key builds its design anew, as `--set` does. Only the groups of the wanted figures are computed. The
first three groups build on each other. The last two are separate.

    path    paths of contact at the design's positions, batched: milliseconds per row
    cycle   the mesh cycle of every row: exact transmission error of the gears, harmonics, contact ratio: tenths of a second;
            no transmission error for gears that jam
    fit     backlash, clearance and interference, which the cycle has computed already

    turns   transmission error over whole turns of members with eccentricity or pitch deviations, until the same teeth
            meet again: a second
    load    a mesh cycle under each torque: one to two seconds per row and torque, and some seconds per design for the
            compliance of its members, which is the same in all mountings
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from gearmesh.answers.contact.contact import by_engagement
from gearmesh.answers.contact.figures import CycleSummary, slid_summary
from gearmesh.answers.contact.fit import FitSummary
from gearmesh.answers.contact.shared import shared_touch
from gearmesh.answers.load.loaded import bodies_of, loaded_contact_of
from gearmesh.answers.load.members import held_by_rim, materials_of, mounts_of
from gearmesh.answers.tables import plain
from gearmesh.contact.assemblies import AssemblyPaths, assembly_paths
from gearmesh.contact.engagement.cycle import Cycle, engagement_range, gears_curve, mesh_cycle
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.fit.fit import fit
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.tca import contact_path
from gearmesh.design.core import Design
from gearmesh.design.dotted import with_keys
from gearmesh.errors import GearmeshError, NoSolutionError
from gearmesh.figures import Figures, Summary, figure
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.compliance.compliance import BodyOutline, FlankCompliance
from gearmesh.loaded.sharing import (
    MAX_BODY_SHIFT,
    MAX_VARIANT_SHIFT,
    Level,
    Reference,
    largest_shift,
    modified_shift,
    outlines_of,
)
from gearmesh.records import dataclass
from gearmesh.study.rows.load_figures import POSITIONS_PER_PITCH, load_figures
from gearmesh.study.rows.path_figures import PathFigures, PathShift, path_figures
from gearmesh.study.rows.turns_figures import turns_figures
from gearmesh.systems import system as systems
from gearmesh.systems.designs import parse
from gearmesh.systems.displaced import displaced_bases, displaced_pair
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import GearPair, GearTrain

#: groups of figures; each needs the groups before it
CONTACT_GROUPS = ("path", "cycle", "fit")
#: group of figures over whole turns
TURNS_GROUP = "turns"
#: group of figures under load, which needs torques
LOAD_GROUP = "load"
#: figures that the paths of contact give
PATH_NAMES = frozenset(known.key for kind in (PathFigures, PathShift) for known in kind.declared_figures())
#: fewest rows of a chunk whose rows are computed in one batch
MIN_BATCHED_ROWS = 50
#: most rows of such a chunk: larger chunks take less time per row, more chunks keep workers busy
MAX_BATCHED_ROWS = 400
#: rows of a chunk from which fields of advances are polynomials in four errors of assembly: a fifth less time for each row
POSED_ROWS = 120
#: fewest chunks of a study with chunks of more than POSED_ROWS, and with chunks of up to as many
MIN_BATCHED_CHUNKS, MIN_POSED_CHUNKS = 16, 4
#: rows of any other chunk
SINGLE_CHUNK_ROWS = 4
#: pitches that are added to the engagement at both ends, because errors shift it
EXTRA_PITCHES = 0.5
#: limit of the built designs that a process keeps
MAX_KEPT_DESIGNS = 8
#: reason of a row whose flanks do not touch
NO_CONTACT = "no contact at any position"

#: figures of a row, and the reason why it has none ("" if it has figures)
Row = tuple[Summary, str]


@dataclass(frozen=True)
class PathErrors(Figures):
    """Transmission errors of paths of contact, which know one side of the teeth only."""

    surface_te_peak_to_peak: float = figure(
        "transmission error of a tooth pair in surface contact, peak to peak", "arcsec"
    )
    mesh_te_estimate: float = figure("estimate of the transmission error of the gears, peak to peak", "arcsec")


@dataclass(frozen=True)
class BreakCount(Figures):
    """The figures of a mesh cycle that a row has instead of the positions of its breaks."""

    te_breaks: int = figure("jumps of the transmission error in a mesh cycle", whole=True)


@dataclass(frozen=True)
class StudyWork:
    """Function that computes rows of a study."""

    #: keys that the design sets, as nested tables
    own: Mapping[str, Any]
    #: varied keys, dotted
    keys: tuple[str, ...]
    #: name or number of the pair
    pair: int | str
    #: groups of figures that are computed
    groups: tuple[str, ...]
    #: figures that are kept
    names: tuple[str, ...] = ()
    #: length and height (mm) of the contact of the unchanged design
    reference: tuple[float, float] | None = None
    #: centre of the contact pattern of the nominal assembly, % of face and of working height
    nominal_pattern: tuple[float, float] | None = None
    #: torques (T,), Nm, on the pinion, for the group "load"
    torque: tuple[float, ...] = ()
    #: model of contact under load
    level: Level = "full"

    def __call__(self, rows: Sequence[Sequence[Any]]) -> list[list[Any]]:
        """Return the values of `names` of each row, None where there is no value, and last the reason."""
        return [[*(_value(figures, name) for name in self.names), reason] for figures, reason in self.figures(rows)]

    def chunk_rows(self, rows: int) -> int:
        """Return the number of rows that are computed together in a study of so many `rows`."""
        if self.groups != ("path",) or not self._moving:
            return SINGLE_CHUNK_ROWS
        few = max(min(rows // MIN_POSED_CHUNKS, POSED_ROWS), MIN_BATCHED_ROWS)
        return min(max(rows // MIN_BATCHED_CHUNKS, few), MAX_BATCHED_ROWS)

    @property
    def level_entry(self) -> dict[str, str]:
        """Entry of the level for what tells studies apart; none for the full level."""
        return {} if self.level == "full" else {"level": self.level}

    @property
    def kind(self) -> str:
        return str(self.own["kind"])

    @property
    def _moving(self) -> tuple[str, ...]:
        """Varied keys that only move members."""
        return tuple(key for key in self.keys if key in displacing_keys(self.kind))

    def figures(self, rows: Sequence[Sequence[Any]]) -> list[Row]:
        """Return all figures of the groups, row by row; a row that fails has only its reason."""
        results_by_row: list[Row] = [(Summary(), "")] * len(rows)
        for variant, row_numbers, errors in self._variants(rows):
            if isinstance(variant, str):
                results: list[Row] = [(Summary(), variant)] * len(row_numbers)
            else:
                results = self._of_variant(variant, errors)
            for k, result in zip(row_numbers, results, strict=True):
                results_by_row[k] = result
        return results_by_row

    def paths(self, rows: Sequence[Sequence[Any]]) -> list[tuple[Variant, AssemblyPaths] | str]:
        """Return the paths of contact of each row (one assembly) with its mounted design.

        A text is the reason why a row has none.
        """
        by_row: list[tuple[Variant, AssemblyPaths] | str] = [""] * len(rows)
        for variant, row_numbers, errors in self._variants(rows):
            if isinstance(variant, str):
                for k in row_numbers:
                    by_row[k] = variant
                continue
            # the positions of the rows and the points half way between them
            phi1 = np.linspace(variant.phi1[0], variant.phi1[-1], 2 * len(variant.phi1) - 1)
            bases = variant.bases(errors)
            all_paths = assembly_paths(variant.flanks, bases, phi1)
            for m, k in enumerate(row_numbers):
                single_assembly = {name: value[m : m + 1] for name, value in vars(all_paths).items() if name != "phi1"}
                by_row[k] = variant.standing(bases, m), AssemblyPaths(all_paths.phi1, **single_assembly)
        return by_row

    def _variants(self, rows: Sequence[Sequence[Any]]) -> Iterator[tuple[Variant | str, list[int], dict[str, Array]]]:
        """Yield the rows of each design: the design or the reason why it fails, row numbers, and errors (M,) by key.

        Errors are in the design's units.
        """
        moving = self._moving
        still = [k for k, key in enumerate(self.keys) if key not in moving]
        groups: dict[tuple[Any, ...], list[int]] = {}
        for k, row in enumerate(rows):
            groups.setdefault(tuple(row[i] for i in still), []).append(k)
        for values, row_numbers in groups.items():
            keys_of_variant = with_keys(
                self.own, ((self.keys[i], value) for i, value in zip(still, values, strict=True))
            )
            errors = {
                key: np.array([float(rows[k][self.keys.index(key)]) for k in row_numbers]).reshape(-1) for key in moving
            }
            variant: Variant | str
            try:
                variant = _build(json.dumps(keys_of_variant, sort_keys=True), self.pair)
            except Exception as failure:  # an invalid design is a failed row, not the end of the study
                variant = _reason(failure)
            yield variant, row_numbers, errors if errors else {"": np.zeros(len(row_numbers))}

    @property
    def _loads_alone(self) -> bool:
        """True if no figure is kept that the paths of contact give."""
        return self.groups == (CONTACT_GROUPS[0], LOAD_GROUP) and bool(self.names) and PATH_NAMES.isdisjoint(self.names)

    def _of_variant(self, variant: Variant, errors: Mapping[str, Array]) -> list[Row]:
        count = len(next(iter(errors.values())))
        bases = variant.bases(errors)
        if self._loads_alone:
            known = [self._loads(variant.standing(bases, m)) for m in range(count)]
            # paths tell whether there is contact at all where one of these fails
            if not any(reason for _, reason in known):
                return known
        paths = assembly_paths(variant.flanks, bases, variant.phi1)
        all_figures = path_figures(paths, variant.frame, variant.pair.pitch)
        columns, (length, height) = all_figures.entries, self.reference or (math.nan, math.nan)
        face_share, height_share = self.nominal_pattern or (math.nan, math.nan)
        rows: list[Row] = []
        for m in range(count):
            row_entries = [replace(column, value=float(column.value[m])) for column in columns]
            shift = PathShift(
                float(all_figures.contact_length[m]) - length,
                float(all_figures.contact_height[m]) - height,
                float(all_figures.pattern_centre_face[m]) - face_share,
                float(all_figures.pattern_centre_height[m]) - height_share,
            )
            figures = Summary(row_entries, shift, variant.pair.figures)
            reason = "" if all_figures.converged[m] else NO_CONTACT
            if not reason and self.groups != ("path",):
                try:
                    figures = Summary(figures, self._of_assembly(variant.standing(bases, m)))
                except Exception as failure:
                    reason = _reason(failure)
            rows.append((figures, reason))
        return rows

    def _loads(self, variant: Variant) -> Row:
        """Return the figures under load of one assembly, and the reason if it has none."""
        try:
            return Summary(variant.pair.figures, self._of_assembly(variant)), ""
        except Exception as failure:
            return Summary(), _reason(failure)

    def _of_assembly(self, variant: Variant) -> Summary:
        """Return the figures of mesh cycle, fit, whole turns and loads, as far as their groups are wanted."""
        cycle, figures = self._of_cycle(variant) if "cycle" in self.groups else (None, Summary())
        if TURNS_GROUP in self.groups:
            figures = Summary(figures, turns_figures(variant.design, variant.train, variant.pair))
        if LOAD_GROUP in self.groups:
            phi1 = variant.pair.pitch * np.arange(POSITIONS_PER_PITCH) / POSITIONS_PER_PITCH
            reference = self._reference(variant, phi1)
            loaded = loaded_contact_of(
                variant.design,
                variant.sharing,
                self.torque,
                cycle=cycle,
                phi1=phi1,
                bodies=self._bodies(variant).of(self.level) if reference is None else reference.bodies,
                level=self.level,
                reference=reference,
            )
            figures = Summary(figures, load_figures(loaded).flat)
        return figures

    def _reference(self, variant: Variant, phi1: Array) -> Reference | None:
        """Return the solved mesh of the unchanged design if it serves a variant; None if it does not.

        It is the same in every process, so that rows do not depend on which rows were computed before.
        """
        own = json.dumps(self.own, sort_keys=True)
        base = _standing(own, self.pair)
        if base is None or _held(base.design, base.pair) != _held(variant.design, variant.pair):
            return None
        if mounts_of(base.design, base.pair):
            return None
        # at level "full" the design itself is solved on its own
        shift = modified_shift(base.sharing, variant.sharing, base.bodies.outlines)
        if shift is None:
            shift = largest_shift(base.sharing, variant.sharing, base.bodies.outlines, variant.bodies.outlines)
        if shift > MAX_VARIANT_SHIFT if self.level == "quick" else not 0.0 < shift < MAX_BODY_SHIFT:
            return None
        known = _reference_of(own, self.pair, self.torque, self.level)
        return known if known is not None and known.at_positions(phi1) else None

    def _bodies(self, variant: Variant) -> Bodies:
        """Return the bodies of the unchanged design if they serve a variant; else its own."""
        known = _bodies_of(json.dumps(self.own, sort_keys=True), self.pair)
        return known if known is not None and known.serves(variant.bodies) else variant.bodies

    def _of_cycle(self, variant: Variant) -> tuple[Cycle | None, Summary]:
        """Return the mesh cycle (None if nothing touches) and its figures."""
        pair = variant.pair
        curve = gears_curve(variant.flanks, pair.pitch)
        if curve is None:
            return None, Summary()
        # gears that jam have no transmission error, also where the fit is not recorded
        fits = fit(pair, curve)
        jammed = fits is not None and fits.jammed
        cycle = mesh_cycle(variant.flanks, pair.pitch, curve=curve, jammed=jammed)
        assert cycle is not None
        fitted = FitSummary.of(pair, fits) if fits is not None and "fit" in self.groups else None
        figures = cycle_figures(pair, CycleSummary.of(cycle), fitted, jammed=jammed)
        touch = shared_touch(variant.sharing, curve, fits, over_turns=TURNS_GROUP in self.groups)
        return cycle, Summary(figures, None if touch is None else touch.figures)


def cycle_figures(pair: GearPair, known: CycleSummary, fitted: FitSummary | None, *, jammed: bool = False) -> Summary:
    """Return the figures of a mesh cycle and the fit of the gears: the number of breaks, and lists number by number."""
    shown = (entry for entry in known.entries if entry.value is not known.te_breaks_phi1)
    breaks = BreakCount(len(known.te_breaks_phi1))
    figures = Summary(shown, breaks, PathErrors(math.nan, math.nan) if jammed else None, fitted)
    return Summary(figures, slid_summary(pair, figures)).flat


@dataclass(frozen=True)
class Bodies:
    """Members of a pair as elastic bodies, the same in every mounting."""

    design: Design
    pair: GearPair
    #: compliances that are known, by level
    _known: dict[str, tuple[FlankCompliance, FlankCompliance]] = field(default_factory=dict, compare=False)

    @cached_property
    def outlines(self) -> tuple[BodyOutline, BodyOutline]:
        """Outlines of both members."""
        return outlines_of(self.pair)

    def serves(self, other: Bodies) -> bool:
        """Return True if the compliance of these bodies is nearly that of others, in any mounting."""
        if _held_bodies(self.design, self.pair) != _held_bodies(other.design, other.pair):
            return False
        if self.pair.flanks != other.pair.flanks:
            return False
        shifts = [mine.shift(theirs) for mine, theirs in zip(self.outlines, other.outlines, strict=True)]
        return max(shifts) < MAX_BODY_SHIFT

    def of(self, level: Level) -> tuple[FlankCompliance, FlankCompliance]:
        """Return the compliance of pinion and gear at a level, computed at the first use, which takes seconds."""
        if level not in self._known:
            self._known[level] = bodies_of(self.design, self.pair, level)
        return self._known[level]


@dataclass(frozen=True)
class Variant:
    """Built design, with its members mounted without errors; `standing` returns it with errors."""

    #: the design without its assembly errors
    design: Design
    #: its built gears
    train: GearTrain
    #: the pair whose contact is computed
    pair: GearPair
    #: flanks of the pair as the contact solver takes them
    flanks: Pair
    #: frame of the pinion's flank
    frame: FlankFrame
    #: assembly errors that the design itself sets, by dotted key, in its own units
    errors: Mapping[str, float]
    #: rotations (P,), rad, of the positions
    phi1: Array
    #: members as elastic bodies
    bodies: Bodies

    def bases(self, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
        """Return the bases of pinion and gear in M assemblies; errors (M,) by dotted key replace the design's errors."""
        count = len(next(iter(errors.values())))
        given = {key: np.full(count, own) for key, own in self.errors.items()}
        return displaced_bases(self.design, self.train, self.pair, {**given, **errors})

    @property
    def sharing(self) -> GearPair:
        """The pair with those that share its torque, whose members stand as its own, and with the other mesh of its planet."""
        nominal, pinion = self.train.sharing(self.pair.name), self.pair.pinion.mount
        fellows = tuple(
            replace(each, pair=replace(each.pair, pinion=replace(each.pair.pinion, mount=pinion)))
            for each in nominal.fellows
        )
        return replace(self.pair, fellows=fellows, other_mesh=nominal.other_mesh, around=nominal.around)

    def standing(self, bases: tuple[Rigid, Rigid], m: int) -> Variant:
        """Return the design with its members mounted as in the m-th of M assemblies."""
        pair = displaced_pair(self.pair, bases, m)
        return replace(self, pair=pair, flanks=remount(self.flanks, pair))


def displacing_keys(kind: str) -> tuple[str, ...]:
    """Return the dotted keys of a kind that only move its members."""
    system = systems.system(kind)
    known = () if system.displacements is None else system.displacements.keys
    return tuple(systems.assembly_key(system.design, key) for key in known)


def own_keys(design: Design) -> Mapping[str, Any]:
    """Return the keys that a design sets, as nested tables."""
    return design.stated()


def remount(flanks: Pair, pair: GearPair) -> Pair:
    """Return the flanks of a pair with the members in the positions of another pair."""
    first, second = (flank.remount(mount) for flank, mount in zip(flanks.flanks, pair.mounts, strict=True))
    return replace(flanks, pinion=first, gear=second)


@lru_cache(maxsize=MAX_KEPT_DESIGNS)
def _build(text: str, which: int | str) -> Variant:
    """Build the design of a JSON text. Raises DesignError, and NoSolutionError if the flanks never meet."""
    tables = json.loads(text)
    keys = displacing_keys(tables["kind"])
    design = parse(tables)
    given = dict(design.own())
    errors = {key: float(given.get(key, 0.0)) for key in keys}
    aligned = parse(with_keys(tables, ((key, 0.0) for key in keys))) if any(errors.values()) else design
    train = systems.build(aligned)
    pair = train.pair(which)
    flanks = solver_pair(pair)
    if any(errors.values()):
        bases = displaced_bases(aligned, train, pair, {key: np.full(1, error) for key, error in errors.items()})
        mounted_flanks = remount(flanks, displaced_pair(pair, bases))
    else:
        mounted_flanks = flanks
    phi1 = _positions(design, pair, mounted_flanks)
    frame = FlankFrame.of(pair.pinion, pair.flanks[0])
    return Variant(aligned, train, pair, flanks, frame, errors, phi1, Bodies(aligned, pair))


def _held_bodies(design: Design, pair: GearPair) -> tuple[Any, ...]:
    """Return materials and places at which bodies of a pair are held."""
    return materials_of(design, pair), held_by_rim(design, pair)


def _held(design: Design, pair: GearPair) -> tuple[Any, ...]:
    """Return materials, places at which bodies are held, and elastic mounts of a pair."""
    return *_held_bodies(design, pair), tuple(mounts_of(design, pair))


def _bodies_of(text: str, which: int | str) -> Bodies | None:
    """Return the bodies of the design of a JSON text; None if it cannot be built."""
    try:
        return _build(text, which).bodies
    except GearmeshError:
        return None


def _standing(text: str, which: int | str) -> Variant | None:
    """Return the design of a JSON text with its own errors of assembly; None if it cannot be built."""
    try:
        variant = _build(text, which)
        return variant.standing(variant.bases({"": np.zeros(1)}), 0)
    except GearmeshError:
        return None


@lru_cache(maxsize=2)
def _reference_of(text: str, which: int | str, torque: tuple[float, ...], level: Level) -> Reference | None:
    """Return the mesh of the design of a JSON text on rigid mounts under torques, Nm; None if it has no contact."""
    variant = _standing(text, which)
    if variant is None:
        return None
    phi1 = variant.pair.pitch * np.arange(POSITIONS_PER_PITCH) / POSITIONS_PER_PITCH
    materials = materials_of(variant.design, variant.pair)
    try:
        return Reference.of(variant.sharing, phi1, 1e3 * np.array(torque), variant.bodies.of(level), materials, level)
    except GearmeshError:
        return None


def _positions(design: Design, pair: GearPair, flanks: Pair) -> Array:
    """Return the rotations (P,), rad, of a design's positions.

    These are the positions that it sets; else they cover its engagement and EXTRA_PITCHES beyond both ends.
    """
    wanted = design.contact.phi1
    ends = wanted.start, wanted.stop
    if by_engagement(design, pair):
        followed = whole_engagement(flanks, pair.pitch)
        if followed is None or not followed.contacts.touching.any():
            raise NoSolutionError(reason="the flanks never meet", remedy="reduce the assembly errors")
        first, last = engagement_range(followed, pair.pitch)
        ends = tuple(np.degrees((first - EXTRA_PITCHES * pair.pitch, last + EXTRA_PITCHES * pair.pitch)).tolist())
    phi1 = np.radians(np.linspace(*ends, wanted.count))
    return phi1 if pair.generation is None else contact_path(flanks, phi1, pair.generation).rotation


def _value(summary: Summary, name: str) -> Any:
    """Return the value of a figure; None if there is none."""
    entry = summary.entry(name)
    value = None if entry is None else plain(entry.value)
    return int(value) if entry is not None and entry.figure.whole and value is not None else value


def _reason(failure: Exception) -> str:
    """Return why a row failed, in one line."""
    text = str(failure) if isinstance(failure, GearmeshError) else f"{type(failure).__name__}: {failure}"
    return " ".join(text.split()) or type(failure).__name__
