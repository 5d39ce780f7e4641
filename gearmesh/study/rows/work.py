"""Rows of a study: what one worker does of a chunk. It holds plain data only, so that it can be sent anywhere.

Keys that only move members (`System.displacements`) are put through one pair of built members, all rows in one batch; any other key
builds its design anew, as `--set` would. What is computed is what the figures asked for need, in three groups, each with all
figures of those before it at hand, and two apart:

    path    paths of contact at the design's positions, batched: milliseconds a row
    cycle   the mesh cycle of every row: exact transmission error of the gears, harmonics, contact ratio: tenths of a second; none
            of gears that jam
    fit     backlash, clearance, interference besides, which the cycle has looked at

    turns   transmission error over whole turns of members that are eccentric or have pitch deviations, until the same teeth meet
            again: a second
    load    a mesh cycle under each of some torques: a second or two a row and torque, and seconds for how the members of each
            design deflect, wherever they are mounted
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from gearmesh.answers.contact.contact import by_engagement
from gearmesh.answers.contact.figures import CycleSummary, slid_summary
from gearmesh.answers.contact.fit import FitSummary
from gearmesh.answers.load.loaded import bodies_of, loaded_contact_of
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
from gearmesh.loaded.compliance.compliance import FlankCompliance
from gearmesh.study.rows.load_figures import POSITIONS, load_figures
from gearmesh.study.rows.path_figures import PathShift, path_figures
from gearmesh.study.rows.turns_figures import turns_figures
from gearmesh.systems import system as systems
from gearmesh.systems.designs import parse
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import GearPair, GearTrain

#: each needs what those before it do
GROUPS = ("path", "cycle", "fit")
#: the group of whole turns, and the one that needs torques
TURNS, LOAD = "turns", "load"
#: rows of a chunk: of those that are batched, and of others
BATCHED, SINGLE = 50, 4
#: pitches by which positions go on beyond the engagement either way: errors move it
WIDER = 0.5
#: designs that a process keeps built
KEPT = 8
NO_CONTACT = "no contact at any position"

#: figures of a row by their names, and why there are none ("": there are)
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
    """What is done of each row: `own`, the design's own keys as nested tables; `keys` that are varied; which mesh; `groups` of
    figures that are computed and `names` of those that are kept; `reference`: length and height (mm) of the contact of the design
    as it is; `torque` (T,), Nm, on the pinion, of the group load."""

    own: Mapping[str, Any]
    keys: tuple[str, ...]
    pair: int | str
    groups: tuple[str, ...]
    names: tuple[str, ...] = ()
    reference: tuple[float, float] | None = None
    torque: tuple[float, ...] = ()

    def __call__(self, rows: Sequence[Sequence[Any]]) -> list[list[Any]]:
        """Values of `names` of each row, None where there is none, and last the reason."""
        return [[*(_value(figures, name) for name in self.names), reason] for figures, reason in self.figures(rows)]

    @property
    def chunk(self) -> int:
        """Rows that are done together."""
        return BATCHED if self.groups == ("path",) and self._moving else SINGLE

    @property
    def kind(self) -> str:
        return str(self.own["kind"])

    @property
    def _moving(self) -> tuple[str, ...]:
        """The keys that only move members."""
        return tuple(key for key in self.keys if key in displacing_keys(self.kind))

    def figures(self, rows: Sequence[Sequence[Any]]) -> list[Row]:
        """All figures of the groups, row by row; what fails is a reason."""
        results_by_row: list[Row] = [(Summary(), "")] * len(rows)
        for variant, which, errors in self._variants(rows):
            if isinstance(variant, str):
                results: list[Row] = [(Summary(), variant)] * len(which)
            else:
                results = self._of_variant(variant, errors)
            for k, result in zip(which, results, strict=True):
                results_by_row[k] = result
        return results_by_row

    def paths(self, rows: Sequence[Sequence[Any]]) -> list[tuple[Variant, AssemblyPaths] | str]:
        """Paths of contact of each row, one assembly each, with the design they are of, with its mounting; or why there is none."""
        by_row: list[tuple[Variant, AssemblyPaths] | str] = [""] * len(rows)
        for variant, which, errors in self._variants(rows):
            if isinstance(variant, str):
                for k in which:
                    by_row[k] = variant
                continue
            # half way between the positions of the rows too
            phi1 = np.linspace(variant.phi1[0], variant.phi1[-1], 2 * len(variant.phi1) - 1)
            bases = variant.bases(errors)
            every = assembly_paths(variant.flanks, bases, phi1)
            for m, k in enumerate(which):
                one = {name: value[m : m + 1] for name, value in vars(every).items() if name != "phi1"}
                by_row[k] = variant.standing(bases, m), AssemblyPaths(every.phi1, **one)
        return by_row

    def _variants(self, rows: Sequence[Sequence[Any]]) -> Iterator[tuple[Variant | str, list[int], dict[str, Array]]]:
        """Rows of one design each: it, or why it cannot be, their numbers, and their errors (M,) by key, in the design's units."""
        moving = self._moving
        still = [k for k, key in enumerate(self.keys) if key not in moving]
        groups: dict[tuple[Any, ...], list[int]] = {}
        for k, row in enumerate(rows):
            groups.setdefault(tuple(row[i] for i in still), []).append(k)
        for values, which in groups.items():
            own = with_keys(self.own, ((self.keys[i], value) for i, value in zip(still, values, strict=True)))
            errors = {
                key: np.array([float(rows[k][self.keys.index(key)]) for k in which]).reshape(-1) for key in moving
            }
            variant: Variant | str
            try:
                variant = _build(json.dumps(own, sort_keys=True), self.pair)
            except Exception as failure:  # whatever is wrong with one design is a row, not the end of the study
                variant = _reason(failure)
            yield variant, which, errors if errors else {"": np.zeros(len(which))}

    def _of_variant(self, variant: Variant, errors: Mapping[str, Array]) -> list[Row]:
        count = len(next(iter(errors.values())))
        bases = variant.bases(errors)
        paths = assembly_paths(variant.flanks, bases, variant.phi1)
        every = path_figures(paths, variant.frame, variant.pair.pitch)
        columns, (length, height) = every.entries, self.reference or (math.nan, math.nan)
        rows: list[Row] = []
        for m in range(count):
            own = [replace(column, value=float(column.value[m])) for column in columns]
            shift = PathShift(float(every.contact_length[m]) - length, float(every.contact_height[m]) - height)
            figures = Summary(own, shift, variant.pair.figures)
            reason = "" if every.converged[m] else NO_CONTACT
            if not reason and self.groups != ("path",):
                try:
                    figures = Summary(figures, self._of_assembly(variant.standing(bases, m)))
                except Exception as failure:
                    reason = _reason(failure)
            rows.append((figures, reason))
        return rows

    def _of_assembly(self, variant: Variant) -> Summary:
        """Figures of the mesh cycle, of the fit and of loads, as they are asked for."""
        cycle, figures = self._of_cycle(variant) if "cycle" in self.groups else (None, Summary())
        if TURNS in self.groups:
            figures = Summary(figures, turns_figures(variant.design, variant.train, variant.pair))
        if LOAD in self.groups:
            phi1 = variant.pair.pitch * np.arange(POSITIONS) / POSITIONS
            loaded = loaded_contact_of(
                variant.design, variant.pair, self.torque, cycle=cycle, phi1=phi1, bodies=variant.bodies.both
            )
            figures = Summary(figures, load_figures(loaded).flat)
        return figures

    def _of_cycle(self, variant: Variant) -> tuple[Cycle | None, Summary]:
        """The mesh cycle, None where nothing touches, and its figures."""
        pair = variant.pair
        curve = gears_curve(variant.flanks, pair.pitch)
        if curve is None:
            return None, Summary()
        # gears that jam have no transmission error, whether or not it is asked how they fit
        fits = fit(pair, curve)
        jammed = fits is not None and fits.jammed
        cycle = mesh_cycle(variant.flanks, pair.pitch, curve=curve, jammed=jammed)
        assert cycle is not None
        fitted = FitSummary.of(pair, fits) if fits is not None and "fit" in self.groups else None
        return cycle, cycle_figures(pair, CycleSummary.of(cycle), fitted, jammed=jammed)


def cycle_figures(pair: GearPair, known: CycleSummary, fitted: FitSummary | None, *, jammed: bool = False) -> Summary:
    """Figures of a row about a mesh cycle and the fit of the gears: breaks by their number, lists number by number."""
    told = (entry for entry in known.entries if entry.value is not known.te_breaks_phi1)
    breaks = BreakCount(len(known.te_breaks_phi1))
    figures = Summary(told, breaks, PathErrors(math.nan, math.nan) if jammed else None, fitted)
    return Summary(figures, slid_summary(pair, figures)).flat


@dataclass(frozen=True)
class Bodies:
    """The members of a pair as elastic bodies, the same in every mounting."""

    design: Design
    pair: GearPair

    @cached_property
    def both(self) -> tuple[FlankCompliance, FlankCompliance]:
        """Of pinion and gear: seconds, when first asked for."""
        return bodies_of(self.design, self.pair)


@dataclass(frozen=True)
class Variant:
    """A design that is built: with the members mounted without errors (or `standing` with them), and the `errors` that
    the design itself has, by key, in its own units; `phi1` (P,), rad, of the rows."""

    design: Design
    train: GearTrain
    pair: GearPair
    flanks: Pair
    frame: FlankFrame
    errors: Mapping[str, float]
    phi1: Array
    bodies: Bodies

    def bases(self, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
        """Bases of pinion and gear in M assemblies, with errors (M,) by dotted key in the place of the design's own."""
        return _bases(self.design, self.train, self.pair, self.errors, errors)

    def standing(self, bases: tuple[Rigid, Rigid], m: int) -> Variant:
        """The same with the members mounted as in the m-th of M assemblies."""
        pinion, gear = (Rigid(basis.rotation[m], basis.translation[m]) for basis in bases)
        pair = _place(self.pair, pinion, gear)
        return replace(self, pair=pair, flanks=remount(self.flanks, pair))


def displacing_keys(kind: str) -> tuple[str, ...]:
    """Dotted keys of a kind that only move its members."""
    known = systems.system(kind).displacements
    return () if known is None else tuple(f"assembly.{key}" for key in known.keys)


def own_keys(design: Design) -> Mapping[str, Any]:
    """The keys that a design sets, as nested tables."""
    return with_keys({}, design.own())


def remount(flanks: Pair, pair: GearPair) -> Pair:
    """The flanks of a pair in other places."""
    first, second = (flank.remount(mount) for flank, mount in zip(flanks.flanks, pair.mounts, strict=True))
    return replace(flanks, pinion=first, gear=second)


@lru_cache(maxsize=KEPT)
def _build(text: str, which: int | str) -> Variant:
    """The design of a JSON text, built. Raises DesignError, and NoSolutionError where the flanks never meet."""
    own = json.loads(text)
    keys = displacing_keys(own["kind"])
    design = parse(own)
    given = dict(design.own())
    errors = {key: float(given.get(key, 0.0)) for key in keys}
    still = parse(with_keys(own, ((key, 0.0) for key in keys))) if any(errors.values()) else design
    train = systems.build(still)
    pair = train.pair(which)
    flanks = solver_pair(pair)
    if any(errors.values()):
        bases = _bases(still, train, pair, errors, {"": np.zeros(1)})
        placed = _place(pair, *(Rigid(basis.rotation[0], basis.translation[0]) for basis in bases))
        there = remount(flanks, placed)
    else:
        there = flanks
    phi1 = _positions(design, pair, there)
    frame = FlankFrame.of(pair.pinion, pair.flanks[0])
    return Variant(still, train, pair, flanks, frame, errors, phi1, Bodies(still, pair))


def _positions(design: Design, pair: GearPair, flanks: Pair) -> Array:
    """Rotations (P,), rad, of a design's positions: those it sets, else over its engagement and WIDER than that."""
    wanted = design.contact.phi1
    ends = wanted.start, wanted.stop
    if by_engagement(design, pair):
        followed = whole_engagement(flanks, pair.pitch)
        if followed is None or not followed.contacts.touching.any():
            raise NoSolutionError(reason="the flanks never meet", remedy="reduce the assembly errors")
        first, last = engagement_range(followed, pair.pitch)
        ends = tuple(np.degrees((first - WIDER * pair.pitch, last + WIDER * pair.pitch)).tolist())
    phi1 = np.radians(np.linspace(*ends, wanted.count))
    return phi1 if pair.generation is None else contact_path(flanks, phi1, pair.generation).rotation


def _bases(
    design: Design, train: GearTrain, pair: GearPair, own: Mapping[str, float], errors: Mapping[str, Array]
) -> tuple[Rigid, Rigid]:
    count = len(next(iter(errors.values())))
    known = systems.system_of(design).displacements
    bases = tuple(mount.base for mount in pair.mounts)
    if known is not None:
        values = {}
        for key in known.keys:
            dotted = f"assembly.{key}"
            meant = type(design).key_at(dotted)
            factor = design.mm_per_unit if meant is not None and meant.unit == "length" else 1.0
            values[key] = factor * errors.get(dotted, np.full(count, own[dotted]))
        bases = known.bases(design.in_mm(), train, values)
    first, second = (
        Rigid(np.broadcast_to(b.rotation, (count, 3, 3)), np.broadcast_to(b.translation, (count, 3))) for b in bases
    )
    return first, second


def _place(pair: GearPair, pinion: Rigid, gear: Rigid) -> GearPair:
    first, second = (
        replace(member, mount=replace(member.mount, base=base))
        for member, base in zip(pair.both, (pinion, gear), strict=True)
    )
    return replace(pair, pinion=first, gear=second)


def _value(summary: Summary, name: str) -> Any:
    """The value of a figure, None where there is none."""
    entry = summary.entry(name)
    value = None if entry is None else plain(entry.value)
    return int(value) if entry is not None and entry.figure.whole and value is not None else value


def _reason(failure: Exception) -> str:
    """Why a row failed, in one line."""
    text = str(failure) if isinstance(failure, GearmeshError) else f"{type(failure).__name__}: {failure}"
    return " ".join(text.split()) or type(failure).__name__
