"""First touch of two trimmed flanks at many positions: the most advanced of all places where the flanks may touch.

`field` finds the places, over the whole of both flanks, and the exact conditions are solved from each place. Every solution is a
point on both flanks, so no solution can be ahead of first touch. The most advanced solution is the contact: inside both flanks, on
an edge, or where two edges cross.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.line_ends import touch_along_lines
from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.conditions.refinement import Contacts, Priority, Trial, advances_of, refine_candidates
from gearmesh.contact.first_touch.field import NO_EDGE, SLACK_MM, Candidates, candidates, seen_closely, sharpen
from gearmesh.contact.first_touch.search import UNSEEN_LEAD_RAD, circle_contacts, refine_missed
from gearmesh.contact.pair import NUMBERED_EDGES, Pair
from gearmesh.kernel.numeric.algebra import Array

#: largest lag of contact on an edge behind a line of contact that is about to leave the flanks there, rad
LINE_ENDS = 1e-5
#: numbers of the gear's edges
OF_GEAR = [number for number, (member, _) in enumerate(NUMBERED_EDGES) if member == 1]


def first_touch(pair: Pair, phi1: Array) -> Contacts:
    """Return first touch at rotations phi1 (N,), for one mount or N mounts of the flanks, without errors or warnings."""
    return touches(pair, phi1)[0]


def touches(pair: Pair, phi1: Array, *, edges: bool = True) -> tuple[Contacts, Contacts]:
    """Return first touch of the teeth at rotations phi1 (N,), including fillets and tip edges, and of the flanks alone.

    Without `edges` only tangency inside both flanks counts.
    """
    contacts = Contacts.nothing(len(phi1))
    flanks = contacts
    with np.errstate(all="ignore"):
        for number, part in pair.parts.items():
            # fillets and tip edges matter only where they may be ahead of the flanks; refine all places that may be ahead
            floor = contacts.advance if edges and number else None
            places = candidates(part, phi1, trimmed=edges, floor=floor)
            worth = places.most > contacts.advance[places.position]
            if floor is not None and not part.wound:
                kept = np.flatnonzero(worth)
                worth[kept] = places.windows[kept].most(SLACK_MM) > contacts.advance[places.position[kept]]
            if not edges:
                worth &= (places.edges == NO_EDGE).all(axis=1)
            trial = Trial.of(places.position[worth], places.x[worth], places.edges[worth])
            trial.most = places.most[worth]
            look = partial(seen_closely, part, phi1)
            priority = _priority(part, places, worth)
            refine_candidates(part, phi1, trial, contacts, number, edges=edges, look=look, priority=priority)
            if edges and number == 0 and part.wound:
                _along_lines(part, phi1, trial, contacts)
            # peaks that are too sharp for Newton: search finer lattices around them and solve again
            lost = _lost_candidates(part, phi1, trial, contacts)
            if lost.size:
                sharp = sharpen(part, phi1, trial.position[lost], trial.start[lost])
                again = Trial.of(trial.position[lost], sharp, trial.edges[lost])
                refine_candidates(part, phi1, again, contacts, number, edges=edges)
            # positions where a sample is still ahead of the solved contact: search a finer grid
            if edges:
                missed = np.flatnonzero((places.best > contacts.advance + UNSEEN_LEAD_RAD) & (places.top >= 0))
                missed = _confirm_missed(part, phi1, missed, places, contacts) if missed.size else missed
            else:
                # a coarse grid may show only the saddle beside the summit of a ridge
                missed = np.flatnonzero(~contacts.touching & (places.top >= 0))
            if missed.size:
                _on_finer_grid(part, phi1, missed, places, contacts, number, edges=edges)
            if number == 0:
                flanks = contacts.at(np.arange(len(phi1)))
    return contacts, flanks


def _priority(pair: Pair, places: Candidates, worth: NDArray[np.bool_]) -> Priority | None:
    """Return the order in which the places are solved that are worth it (C,); None for teeth that wind, which have few summits."""
    if pair.wound:
        return None
    return Priority(places.leading(worth)[worth], places.steps[worth], places.windows[np.flatnonzero(worth)])


def _along_lines(pair: Pair, phi1: Array, trial: Trial, contacts: Contacts) -> None:
    """Find the parts inside the flanks of bent lines of contact that are known at places beside the flanks.

    Only positions are tried whose known contact is at most LINE_ENDS behind the line: a line that is about to leave the flanks
    touches an edge at its end.
    """
    ahead = advances_of(pair, phi1, trial.x, trial.position) - contacts.advance[trial.position]
    beside = np.flatnonzero(trial.line & ~trial.good & (ahead > 0.0) & (ahead < LINE_ENDS))
    first = beside[np.unique(trial.position[beside], return_index=True)[1]]
    if first.size:
        touch_along_lines(pair, phi1, trial.position[first], trial.x[first], contacts)


def _confirm_missed(
    pair: Pair, phi1: Array, missed: NDArray[np.intp], coarse: Candidates, contacts: Contacts
) -> NDArray[np.intp]:
    """Return the positions of `missed` (M,) whose leading sample is not explained by the error of its table.

    The exact advance at the sample's circle decides. Crossings of grid lines with the gear's edges are guesses: they stay missed
    unless the contact is along a line, which nothing can be ahead of.
    """
    top = coarse.top[missed]
    sampled = coarse.samples(pair, phi1, top)
    advance = circle_contacts(pair, Conditions(pair.flanks, phi1, pair.length), missed, sampled)[1]
    of_table = (advance > -np.inf) & (advance <= contacts.advance[missed] + UNSEEN_LEAD_RAD)
    return missed[~of_table | (np.isin(coarse.edges[top, 0], OF_GEAR) & ~contacts.line[missed])]


def _on_finer_grid(
    pair: Pair,
    phi1: Array,
    missed: NDArray[np.intp],
    coarse: Candidates,
    contacts: Contacts,
    number: int,
    *,
    edges: bool,
) -> None:
    """Solve again at missed positions, from candidates on a finer grid; without `edges` only inside both flanks."""
    fine = candidates(pair, phi1, trimmed=edges, only=missed, finer=True)
    own = np.flatnonzero(edges | (fine.edges == NO_EDGE).all(axis=1))
    trial = Trial.of(fine.position[own], fine.x[own], fine.edges[own])
    refine_candidates(pair, phi1, trial, contacts, number, edges=edges)
    if not edges:
        return
    # the nodes of the coarse grid lie exactly on the ends of the pinion's flank, and nodes are certainly on both flanks; crossings
    # of grid lines with an edge of the gear are guesses
    nodes = np.flatnonzero(~np.isin(coarse.edges[:, 0], OF_GEAR) & np.isin(coarse.position, missed))
    sampled = coarse.samples(pair, phi1, nodes)
    nodes = nodes[np.argsort(advances_of(pair, phi1, sampled, coarse.position[nodes]), kind="stable")]
    sure = np.full(len(phi1), -1)
    sure[coarse.position[nodes]] = nodes
    for grid_places, best, top in (
        (coarse, coarse.best[missed], coarse.top[missed]),
        (coarse, coarse.best[missed], sure[missed]),
        (fine, fine.best, fine.top),
    ):
        still = np.flatnonzero((best > contacts.advance[missed] + UNSEEN_LEAD_RAD) & (top >= 0))
        if still.size:
            seen = grid_places.samples(pair, phi1, top[still])
            refine_missed(pair, phi1, missed[still], seen, contacts, number)


def _lost_candidates(pair: Pair, phi1: Array, trial: Trial, contacts: Contacts) -> NDArray[np.intp]:
    """Return numbers (M,) of trials inside the flanks that may still be ahead but have lost their peak.

    Newton did not converge, or converged to a place that is less advanced: the peak is too sharp. Positions with contact along a
    line are complete, because nothing can be ahead of the line.
    """
    start, end = (advances_of(pair, phi1, x, trial.position) for x in (trial.start, trial.x))
    arrived = ~np.isnan(trial.beyond).all(axis=1) & (end > start - UNSEEN_LEAD_RAD)
    leading = (trial.most > contacts.advance[trial.position]) & ~contacts.line[trial.position]
    return np.flatnonzero(~arrived & leading & (trial.edges[:, 0] == NO_EDGE))
