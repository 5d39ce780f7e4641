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
from gearmesh.contact.conditions.refinement import Contacts, Trial, advances_of, refine_candidates
from gearmesh.contact.first_touch.field import INTERIOR, Candidates, candidates, seen_closely, sharpen
from gearmesh.contact.first_touch.search import UNSEEN, circle_contacts, refine_missed
from gearmesh.contact.pair import NUMBERED, Pair
from gearmesh.kernel.numeric.algebra import Array

#: rad by which contact on an edge may be behind a line of contact that is about to leave the flanks there
LINE_ENDS = 1e-5
#: numbers of the gear's edges
OF_GEAR = [number for number, (member, _) in enumerate(NUMBERED) if member == 1]


def first_touch(pair: Pair, phi1: Array) -> Contacts:
    """First touch at rotations phi1 (N,); the flanks' mounts may be N of their own. Nothing is raised or warned of."""
    return touches(pair, phi1)[0]


def touches(pair: Pair, phi1: Array, *, edges: bool = True) -> tuple[Contacts, Contacts]:
    """First touch of the teeth at rotations phi1 (N,), fillets and tip edges too, and of the flanks alone.

    Without `edges` only tangency inside both flanks counts.
    """
    contacts = Contacts.nothing(len(phi1))
    flanks = contacts
    with np.errstate(all="ignore"):
        for number, part in pair.parts.items():
            # beyond the flanks only what may be ahead of them
            floor = contacts.advance if edges and number else None
            places = candidates(part, phi1, trimmed=edges, floor=floor)
            worth = places.most > contacts.advance[places.position]
            if not edges:
                worth &= (places.edges == INTERIOR).all(axis=1)
            trial = Trial.of(places.position[worth], places.x[worth], places.edges[worth])
            trial.most = places.most[worth]
            look = partial(seen_closely, part, phi1)
            refine_candidates(part, phi1, trial, contacts, number, edges=edges, look=look)
            if edges and number == 0 and part.wound:
                _along_lines(part, phi1, trial, contacts)
            lost = _lost_candidates(part, phi1, trial, contacts)
            if lost.size:
                sharp = sharpen(part, phi1, trial.position[lost], trial.start[lost])
                again = Trial.of(trial.position[lost], sharp, trial.edges[lost])
                refine_candidates(part, phi1, again, contacts, number, edges=edges)
            if edges:
                missed = np.flatnonzero((places.best > contacts.advance + UNSEEN) & (places.top >= 0))
                missed = _confirm_missed(part, phi1, missed, places, contacts) if missed.size else missed
            else:
                # of the summit of a ridge a coarse grid may show nothing but the saddle beside it
                missed = np.flatnonzero(~contacts.touching & (places.top >= 0))
            if missed.size:
                _on_finer_grid(part, phi1, missed, places, contacts, number, edges=edges)
            if number == 0:
                flanks = contacts.at(np.arange(len(phi1)))
    return contacts, flanks


def _along_lines(pair: Pair, phi1: Array, trial: Trial, contacts: Contacts) -> None:
    """Of lines of contact that bend, known at places beside the flanks, what the flanks have of them, where that may be: at the
    ends of a line, which touches an edge there, what else is known is next to nothing behind it."""
    ahead = advances_of(pair, phi1, trial.x, trial.position) - contacts.advance[trial.position]
    beside = np.flatnonzero(trial.line & ~trial.good & (ahead > 0.0) & (ahead < LINE_ENDS))
    first = beside[np.unique(trial.position[beside], return_index=True)[1]]
    if first.size:
        touch_along_lines(pair, phi1, trial.position[first], trial.x[first], contacts)


def _confirm_missed(
    pair: Pair, phi1: Array, missed: NDArray[np.intp], coarse: Candidates, contacts: Contacts
) -> NDArray[np.intp]:
    """Those positions of `missed` (M,) at which the sample that is ahead is not known to do so by the error of its table. Where a
    line of the grid crosses an edge of the gear is a guess, which counts beside lines of contact: nothing is ahead of those."""
    top = coarse.top[missed]
    advance = circle_contacts(pair, Conditions(pair.flanks, phi1, pair.length), missed, coarse.x[top])[1]
    of_table = (advance > -np.inf) & (advance <= contacts.advance[missed] + UNSEEN)
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
    """Positions at which a sample is ahead that was not solved for: on a finer grid, on which candidates are
    refined, without `edges` those inside both flanks."""
    fine = candidates(pair, phi1, trimmed=edges, only=missed, finer=True)
    own = np.flatnonzero(edges | (fine.edges == INTERIOR).all(axis=1))
    trial = Trial.of(fine.position[own], fine.x[own], fine.edges[own])
    refine_candidates(pair, phi1, trial, contacts, number, edges=edges)
    if not edges:
        return
    # only nodes of the coarse grid are on the very ends of flanks, and only nodes are sure to be on both: where lines of the grid
    # cross an edge of the gear is a guess
    nodes = np.flatnonzero(~np.isin(coarse.edges[:, 0], OF_GEAR))
    nodes = nodes[np.argsort(advances_of(pair, phi1, coarse.x[nodes], coarse.position[nodes]), kind="stable")]
    sure = np.full(len(phi1), -1)
    sure[coarse.position[nodes]] = nodes
    for grid_places, best, top in (
        (coarse, coarse.best[missed], coarse.top[missed]),
        (coarse, coarse.best[missed], sure[missed]),
        (fine, fine.best, fine.top),
    ):
        still = np.flatnonzero((best > contacts.advance[missed] + UNSEEN) & (top >= 0))
        if still.size:
            refine_missed(pair, phi1, missed[still], grid_places.x[top[still]], contacts, number)


def _lost_candidates(pair: Pair, phi1: Array, trial: Trial, contacts: Contacts) -> NDArray[np.intp]:
    """Places inside the flanks (M,) from which Newton converged to nothing, or to what is less advanced, and which may be ahead
    still: their peak is too sharp for it. Nothing is ahead of a line."""
    start, end = (advances_of(pair, phi1, x, trial.position) for x in (trial.start, trial.x))
    arrived = ~np.isnan(trial.beyond).all(axis=1) & (end > start - UNSEEN)
    leading = (trial.most > contacts.advance[trial.position]) & ~contacts.line[trial.position]
    return np.flatnonzero(~arrived & leading & (trial.edges[:, 0] == INTERIOR))
