"""Transmission advance of one tooth pair as a function of phi1, by polynomials through solved nodes and slopes.

Four nodes and their slopes give a polynomial of degree 7 between the middle two nodes. The change by the last node measures its
error; where the error is too large, nodes are added. No polynomial exists between nodes of different kinds of contact: rotations
there are solved for one by one. The passage of a point of contact from the flanks to an edge is a root. Two nodes, one of each
kind, stand there, so that polynomials exist on both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.refinement import Contacts
from gearmesh.contact.engagement.engagement import Engagement, rates
from gearmesh.contact.pair import EDGE_CORNER
from gearmesh.kernel.numeric.algebra import Array

#: nodes of a polynomial at most
NODES_PER_POLYNOMIAL = 4
#: change (rad) by the last node up to which a polynomial is used
MAX_POLYNOMIAL_ERROR_RAD = 1e-11
#: difference of slopes (rad/rad) of two kinds of contact at their passage that is rounding
SLOPE_ROUNDING = 1e-8
#: least distance of a node from a passage, by the step of the nodes
MIN_DISTANCE_FROM_PASSAGE = 0.1
#: rounds in which nodes are added
REFINING_ROUNDS = 4
#: parts of an interval between contacts of two kinds
PARTS_BETWEEN_KINDS = 8
#: parts of such an interval where contact is a line or a corner
ROUGH_PARTS = 2


class TransmissionAdvance:
    """Transmission advance of a tooth pair over the nominal ratio, rad, from its `engagement`.

    `ends`: phi1 (rad) between which contact of the flanks keeps its kind, if known.
    """

    def __init__(self, engagement: Engagement, ends: Sequence[float] = ()) -> None:
        self.engagement, self.pair = _with_ends(_refine(_with_passages(engagement, ends)), ends), engagement.pair
        self.phi1, self.advance, self.slope, _ = _nodes(self.engagement)
        self._left, self._coefficients, self._sure = _polynomials(self.engagement)

    def at(self, phi1: Array) -> tuple[Array, Array]:
        """Return advances (N,), rad, at phi1 (N,), NaN without contact, and slopes (N,)."""
        # by the polynomial of the interval; exactly at nodes; solved where no polynomial is exact enough
        last = len(self.phi1) - 1
        k = np.clip(np.searchsorted(self.phi1, phi1, side="right") - 1, 0, last - 1)
        advance, slope = self._by_polynomial(phi1, k)
        nearest = np.where(np.abs(phi1 - self.phi1[k]) <= np.abs(phi1 - self.phi1[k + 1]), k, k + 1)
        node = np.abs(phi1 - self.phi1[nearest]) <= 4.0 * np.spacing(np.abs(phi1) + 1.0)
        advance[node], slope[node] = self.advance[nearest[node]], self.slope[nearest[node]]
        inside = (phi1 >= self.phi1[0]) & (phi1 <= self.phi1[-1])
        rest = np.flatnonzero(~node & ~(self._sure[k] & inside))
        if rest.size:
            advance[rest], slope[rest] = self.exactly(phi1[rest])
        return advance, slope

    def exactly(self, phi1: Array) -> tuple[Array, Array]:
        """Return advances and slopes as `at` does, but solved at each rotation."""
        return _values(self.engagement, phi1, self.engagement.near(phi1))

    def over_neighbours(self, pitch: float, phi1: Array) -> Array:
        """Return the lead (P,), rad, of the most advanced neighbouring pair over this pair at phi1 (P,).

        The lead is negative where this pair is ahead, and NaN where this pair or all neighbours do not touch.
        """
        counts = np.arange(1.0, np.ptp(self.phi1) / pitch + 1.0)
        shifts = np.concatenate((-counts, counts)) * pitch
        touching, ahead = np.isfinite(self.advance), np.full(len(phi1), np.nan)
        if not touching.any():
            return ahead
        # the nodes show which neighbour is ahead; only this neighbour is evaluated
        rough = np.stack(
            [np.interp(phi1 + s, self.phi1[touching], self.advance[touching], -np.inf, -np.inf) for s in shifts]
        )
        rows = np.flatnonzero(np.isfinite(rough.max(axis=0)))
        neighbour_phi1 = phi1[rows] + shifts[rough.argmax(axis=0)[rows]]
        itself, other = self.at(np.concatenate((phi1[rows], neighbour_phi1)))[0].reshape(2, -1)
        ahead[rows] = other - itself
        return ahead

    def _by_polynomial(self, phi1: Array, k: NDArray[np.intp]) -> tuple[Array, Array]:
        """Evaluate advances and slopes (N,) by the polynomials of intervals k (N,)."""
        # Horner's scheme for Newton's form, together with its derivative
        c = self._coefficients[k]
        degree = c.shape[1] - 1
        advance, slope = c[:, degree].copy(), np.zeros(len(phi1))
        for j in range(degree - 1, -1, -1):
            away = phi1 - self.phi1[np.minimum(self._left[k] + j // 2, len(self.phi1) - 1)]
            # intervals without a polynomial, whose values `at` solves for, have no finite coefficients
            with np.errstate(invalid="ignore", over="ignore"):
                slope = slope * away + advance
                advance = advance * away + c[:, j]
        return advance, slope


def _values(engagement: Engagement, phi1: Array, contacts: Contacts) -> tuple[Array, Array]:
    slope = engagement.pair.drive * (rates(engagement.pair, phi1, contacts)[:, 4] - engagement.pair.ratio)
    return np.where(contacts.touching, contacts.advance, np.nan), slope


def _nodes(engagement: Engagement) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    """Return phi1, advance and slope (K,) at the nodes, and True (K - 1,) where neighbours touch at the same corner."""
    phi1, c, pair = engagement.phi1, engagement.contacts, engagement.pair
    advance = np.where(c.touching, c.advance, np.nan)
    slope = pair.drive * (engagement.rates[:, 4] - pair.ratio)
    # no condition gives the slope at a corner: take the slope of the parabola through three nodes
    alike = _at_one_corner(engagement)
    inner = np.flatnonzero(alike[1:] & alike[:-1]) + 1
    before, after = phi1[inner] - phi1[inner - 1], phi1[inner + 1] - phi1[inner]
    with np.errstate(all="ignore"):
        steps = np.diff(advance) / np.diff(phi1)
    slope[inner] = (steps[inner - 1] * after + steps[inner] * before) / (before + after)
    for k in np.flatnonzero(alike):
        for node in (k, k + 1):
            if np.isnan(slope[node]):
                slope[node] = steps[k]
    return phi1, advance, slope, alike


def _at_one_corner(engagement: Engagement) -> NDArray[np.bool_]:
    """Return True (K - 1,) where neighbouring nodes touch at the same corner and are near enough for a parabola.

    Teeth that touch at corners in a root are jammed, so that a rough advance is enough.
    """
    c, steps = engagement.contacts, np.diff(engagement.phi1)
    same = (c.edges[1:] == c.edges[:-1]).all(axis=1) & (c.part[1:] == c.part[:-1]) & c.touching[1:] & c.touching[:-1]
    at_corner: NDArray[np.bool_] = (
        same & (c.edges[1:, 0] >= EDGE_CORNER) & (steps < 1.5 * engagement.step / ROUGH_PARTS)
    )
    return at_corner


def _polynomials(engagement: Engagement) -> tuple[NDArray[np.intp], Array, NDArray[np.bool_]]:
    """Compute the polynomial of each interval (K - 1,) by Newton's divided differences, every node taken twice.

    Returns the first node (K - 1,), the coefficients (K - 1, 2 NODES_PER_POLYNOMIAL), and True (K - 1,) where the polynomial is
    exact enough.
    """
    phi1, advance, slope, alike = _nodes(engagement)
    smooth = alike | (engagement.smooth & np.isfinite(slope[:-1]) & np.isfinite(slope[1:]))
    count = len(smooth)
    numbers = np.arange(count)
    # run of smooth intervals that holds the interval, from node `first` to node `last`
    breaks = np.flatnonzero(~smooth)
    first = np.append(-1, breaks)[np.searchsorted(breaks, numbers)] + 1
    last = np.append(breaks, count)[np.searchsorted(breaks, numbers)]
    nodes = np.minimum(last - first + 1, NODES_PER_POLYNOMIAL)
    left = np.clip(numbers - (nodes - 2) // 2, first, last - nodes + 1)
    coefficients = np.zeros((count, 2 * NODES_PER_POLYNOMIAL))
    sure = np.zeros(count, dtype=bool)
    middle = 0.5 * (phi1[1:] + phi1[:-1])
    for m in range(2, NODES_PER_POLYNOMIAL + 1):
        # divided differences of m double nodes; the first differences of a double node are its slope
        intervals = np.flatnonzero(smooth & (nodes == m))
        at = np.repeat(left[intervals, None] + np.arange(m), 2, axis=1)
        z, column = phi1[at], advance[at]
        coefficients[intervals, 0] = column[:, 0]
        for order in range(1, 2 * m):
            step = z[:, order:] - z[:, :-order]
            with np.errstate(all="ignore"):
                column = np.diff(column, axis=1) / step
            if order == 1:
                column[:, ::2] = slope[at[:, ::2]]
            coefficients[intervals, order] = column[:, 0]
        # the change by the last node, in the middle of the interval, measures the error; nodes of one rotation have none
        away = middle[intervals, None] - phi1[at[:, ::2]]
        with np.errstate(all="ignore"):
            by_last = coefficients[intervals, 2 * m - 2] + coefficients[intervals, 2 * m - 1] * away[:, -1]
            change = np.abs(by_last * (away[:, :-1] ** 2).prod(axis=1))
        sure[intervals] = alike[intervals] | (change <= MAX_POLYNOMIAL_ERROR_RAD)
    return left, coefficients, sure


def _refine(engagement: Engagement) -> Engagement:
    """Return the engagement with nodes added where polynomials are not exact enough."""
    for number in range(REFINING_ROUNDS):
        _, _, sure = _polynomials(engagement)
        phi1, c = engagement.phi1, engagement.contacts
        smooth, touching = engagement.smooth, c.touching[1:] | c.touching[:-1]
        halved = np.flatnonzero(smooth & ~sure)
        places = [0.5 * (phi1[halved] + phi1[halved + 1])]
        if number == 0:
            # lines, corners and ends of contact need a new first touch at each node, which is slow: fewer nodes there
            plain = c.touching & engagement.followable
            followed = plain[1:] & plain[:-1]
            for which, parts in ((followed, PARTS_BETWEEN_KINDS), (touching & ~followed, ROUGH_PARTS)):
                k = np.flatnonzero(which & ~smooth & (np.diff(phi1) > 0.0))
                share = np.arange(1, parts) / parts
                places.append((phi1[k, None] + share * (phi1[k + 1] - phi1[k])[:, None]).ravel())
        wanted = np.sort(np.concatenate(places))
        if not wanted.size:
            break
        engagement = _with_nodes(engagement, wanted, engagement.near(wanted))
    return engagement


def _with_passages(engagement: Engagement, ends: Sequence[float]) -> Engagement:
    """Return the engagement with two nodes at each passage of a point of contact between flanks and edge, one of each kind.

    Both nodes have the same advance and slope.
    """
    # ends of surface contact between a node inside the flanks and a node on one edge
    phi1, c = engagement.phi1, engagement.contacts
    passages = np.array([end for end in ends if phi1[0] < end < phi1[-1]])
    left = np.searchsorted(phi1, passages) - 1
    on_edge = (c.edges[:, 0] >= 0) & (c.edges[:, 0] < EDGE_CORNER) & (c.edges[:, 1] < 0)
    known = c.touching & (c.part == 0) & ~c.line
    passes = known[left] & known[left + 1] & (phi1[left + 1] > passages)
    passes &= ((c.edges[left, 0] < 0) & on_edge[left + 1]) | (on_edge[left] & (c.edges[left + 1, 0] < 0))
    if not passes.any():
        return engagement
    # solve for both kinds at the passage; they must agree in advance and slope
    node = (left[passes, None] + np.arange(2)).ravel()
    passage_phi1 = np.repeat(passages[passes], 2)
    contacts = engagement.as_at(passage_phi1, node)
    advance, slope = (column.reshape(-1, 2) for column in _values(engagement, passage_phi1, contacts))
    alike = (np.abs(np.diff(advance)) < MAX_POLYNOMIAL_ERROR_RAD) & (np.abs(np.diff(slope)) < SLOPE_ROUNDING)
    accepted = np.flatnonzero(np.repeat(alike[:, 0], 2) & (contacts.edges == c.edges[node]).all(axis=1))
    if not accepted.size:
        return engagement
    # divided differences with nodes close to a passage would be rounding errors
    beside = node[accepted][np.abs(phi1[node] - passage_phi1)[accepted] < MIN_DISTANCE_FROM_PASSAGE * engagement.step]
    kept = np.setdiff1d(np.arange(len(phi1)), beside[(beside > 0) & (beside < len(phi1) - 1)], assume_unique=True)
    fewer = Engagement(engagement.pair, phi1[kept], c.at(kept), engagement.flanks.at(kept), engagement.step)
    return _with_nodes(fewer, passage_phi1[accepted], contacts.at(accepted))


def _with_ends(engagement: Engagement, ends: Sequence[float]) -> Engagement:
    """Return the engagement with nodes at the ends of line contact, where the line is a point."""
    phi1, line = engagement.phi1, engagement.contacts.line
    places, nearest = [], []
    for end, step in zip(ends, (1, -1), strict=False):
        # the last node with a line, seen from the end
        k = int(np.searchsorted(phi1, end)) - (step < 0)
        if 0 <= k < len(phi1) and line[k] and phi1[k] != end:
            places.append(end)
            nearest.append(k)
    if not places:
        return engagement
    contacts = engagement.along_line(np.array(places), np.array(nearest))
    # no node where the line was not found: rotations there are solved for one by one
    found = np.flatnonzero(contacts.residual <= engagement.pair.tolerance)
    return _with_nodes(engagement, np.array(places)[found], contacts.at(found)) if found.size else engagement


def _with_nodes(engagement: Engagement, phi1: Array, contacts: Contacts) -> Engagement:
    """Return the engagement with nodes added at phi1 (M,) with contacts (M,)."""
    all_phi1 = np.concatenate((engagement.phi1, phi1))
    order = np.argsort(all_phi1, kind="stable")
    c = engagement.contacts
    merged = Contacts(
        *(np.concatenate((getattr(c, e.name), getattr(contacts, e.name)))[order] for e in fields(Contacts))
    )
    return Engagement(engagement.pair, all_phi1[order], merged, merged, engagement.step)
