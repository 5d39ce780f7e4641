"""Names of the figures that a row of a study can have; no contact is solved to know them."""

from __future__ import annotations

import math
from dataclasses import fields

from gearmesh.answers.contact.figures import CycleSummary
from gearmesh.answers.contact.fit import FitSummary
from gearmesh.answers.contact.shared import SharedFigures, names_of_sharing
from gearmesh.answers.contact.turns import TurnsSummary
from gearmesh.contact.engagement.curve import HARMONIC_COUNT
from gearmesh.figures import Summary
from gearmesh.study.rows.load_figures import LoadFigures
from gearmesh.study.rows.path_figures import PathFigures, PathShift
from gearmesh.study.rows.turns_figures import RowPitch
from gearmesh.study.rows.work import CONTACT_GROUPS, LOAD_GROUP, TURNS_GROUP, cycle_figures
from gearmesh.teeth.gear_train import GearPair


def recordable(pair: GearPair, torques: int = 0) -> dict[str, str]:
    """Return the group of each figure that rows of a pair can have, by name in the order of the rows.

    `pair` has its fellows, those that share its torque. Figures under load are included for `torques` above 0. Ratios of
    line contact are always included, also where the contact proves to be at points.
    """
    path = [declared_figure.key for kind in (PathFigures, PathShift) for declared_figure in kind.declared_figures()]
    kind_figures = () if pair.figures is None else pair.figures.row
    cycle = Summary(cycle_figures(pair, _cycle(), None), _shared(pair))
    fit = cycle_figures(pair, _cycle(), _fit(pair))
    turns = Summary(_turns(), RowPitch(*[dict.fromkeys(pair.members, math.nan)] * 2))
    load = Summary(_load(pair, torques)).flat if torques else ()
    groups: dict[str, str] = {}
    for group, names in zip(
        (*CONTACT_GROUPS, TURNS_GROUP, LOAD_GROUP), ([*path, *kind_figures], cycle, fit, turns, load), strict=True
    ):
        groups |= {name: group for name in names if name not in groups}
    return groups


def _cycle() -> CycleSummary:
    """Return a mesh cycle with unknown values, which gives the names of its figures."""
    none = math.nan
    return CycleSummary(
        contact_ratio=none,
        transverse_contact_ratio=none,
        overlap_ratio=none,
        pairs_in_contact=[0, 0],
        engagement_phi1=[none, none],
        mesh_te_peak_to_peak=none,
        mesh_te_harmonics=[none] * HARMONIC_COUNT,
        te_breaks_phi1=[],
    )


def _fit(pair: GearPair) -> FitSummary:
    none, pinion = math.nan, {pair.pinion.name: math.nan}
    clearance: dict[str, float | None] = dict.fromkeys(pair.members, none)
    return FitSummary(none, none, pinion, pinion, none, none, none, none, clearance, none)


def _shared(pair: GearPair) -> SharedFigures | None:
    """Return figures of all pairs that share the torque, with unknown values; None without others."""
    names = dict.fromkeys(names_of_sharing(pair), math.nan)
    return SharedFigures(math.nan, math.nan, math.nan, names) if pair.fellows else None


def _turns() -> TurnsSummary:
    return TurnsSummary(*[math.nan] * len(fields(TurnsSummary)))


def _load(pair: GearPair, torques: int) -> LoadFigures:
    none: list[float | None] = [None] * torques
    stress = dict.fromkeys(pair.members, none)
    counts = [0] * torques
    return LoadFigures(none, none, stress, stress, none, [*counts], none, none, counts)
