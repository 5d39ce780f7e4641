"""Tooth contact analysis: contact of two trimmed flanks at given rotations of the pinion, all rotations in one batch.

At a given phi1 the driven gear stands at its first touch. There phi2 is the largest (drive +1) or smallest (-1) value at which a
point of one tooth meets the other tooth. In the interior of both flanks the surfaces are tangent. Otherwise contact is on an edge
(tip, toe, heel), at the crossing of two edges, or on a fillet. Line contact makes the equations singular; it is recognised by the
relative curvature.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.even_edges import to_middle
from gearmesh.contact.conditions.lines import trace
from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.conditions.refinement import Contacts
from gearmesh.contact.engagement.engagement import Engagement, follow
from gearmesh.contact.first_touch.first_touch import first_touch, touches
from gearmesh.contact.pair import HAS_TIP_EDGE, IS_TIP_CORNER, MEMBER_NAMES, PART_PAIRS, TIP_EDGE, Pair, edge_name
from gearmesh.contact.path import ContactPath
from gearmesh.errors import DesignError, Status
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import contact_ellipse, relative_curvature, tangent_basis
from gearmesh.kernel.surface.surface import Jet

#: positions up to which first touch is found at each position; more positions are followed from nodes
MAX_DIRECT_POSITIONS = 64
#: nodes at least from which positions are followed; the nodes of 4 pitches
MIN_NODES = 48
#: rounds that solve for the rotation where the source counts phi1 differently
COUNTING_ROUNDS = 6


def contact_path(
    pair: Pair,
    phi1: Array,
    count_phi1: Callable[[Array, Array], Array] | None = None,
    *,
    edges: bool = True,
    engagement: Engagement | None = None,
) -> ContactPath:
    """Compute the contact of one tooth pair at rotations phi1 (P,), rad, with the transmission error relative to phi1 = 0.

    `count_phi1` returns, from surface parameters of the pinion, the angle by which the source counts phi1 (the generation angle of
    [LT85]). The rotation is then solved for so that this angle takes the given values inside both flanks. Without `edges` the
    solver looks only for tangency inside both flanks. A known `engagement` of the pair saves its solution.
    Positions without contact have the kind "none" and their reason in `status`. Raises DesignError where the flanks drive in the
    sense opposite to the pair's `drive`.
    """
    started = time.perf_counter()
    asked = np.append(np.asarray(phi1, dtype=float), 0.0)
    with np.errstate(all="ignore"):
        rotation = asked.copy()
        contacts = _solve(pair, rotation, edges, engagement)
        if count_phi1 is not None:
            for _ in range(COUNTING_ROUNDS):
                miss = asked - rotation - _count_offset(count_phi1, rotation, contacts)
                off = np.flatnonzero(np.abs(miss) > 1e-13)
                if not off.size:
                    break
                rotation[off] += miss[off]
                contacts.put(off, _solve(pair, rotation[off], edges, engagement))
        if (
            not contacts.touching.any()
            and first_touch(replace(pair.parts[0], drive=-pair.drive), rotation).touching.any()
        ):
            raise DesignError(
                "drive", pair.drive, reason="these flanks drive in the other direction", allowed=f"{-pair.drive}"
            )
        return _result(pair, asked, rotation, contacts, started)


def jammed_path(pair: Pair, phi1: Array) -> ContactPath:
    """Return the path of gears that are jammed at all rotations phi1 (P,), rad: no contact, with `Status.JAMMED`."""
    phi1 = np.asarray(phi1, dtype=float)
    every = np.append(phi1, 0.0)
    path = _result(pair, every, every, Contacts.nothing(len(every)), time.perf_counter())
    return replace(path, status=np.full(len(phi1), int(Status.JAMMED)))


def _count_offset(count_phi1: Callable[[Array, Array], Array], rotation: Array, contacts: Contacts) -> Array:
    """Return the lead (N,), rad, of the source's phi1 over the pinion's rotation.

    No source treats edge contact: it has the lead of the nearest end of surface contact.
    """
    offset = count_phi1(contacts.x[:, 0], contacts.x[:, 1]) - rotation
    inside = np.flatnonzero(contacts.touching & (contacts.edges[:, 0] < 0) & (contacts.part == 0) & np.isfinite(offset))
    if not inside.size:
        return np.zeros(len(rotation))
    inside = inside[np.argsort(rotation[inside], kind="stable")]
    known = np.interp(rotation, rotation[inside], offset[inside])
    known[inside] = offset[inside]
    return known


def _solve(pair: Pair, phi1: Array, edges: bool, engagement: Engagement | None) -> Contacts:
    """Solve for contacts at rotations phi1 (N,), rad."""
    if not edges:
        return touches(pair.parts[0], phi1, edges=False)[0]
    if engagement is not None:
        return engagement.at(phi1)
    if len(phi1) <= MAX_DIRECT_POSITIONS:
        return touches(pair, phi1)[0]
    low, high = phi1.min(), phi1.max()
    count = (
        MIN_NODES if np.isnan(pair.pitch) else max(MIN_NODES, int(np.ceil((high - low) / pair.pitch * MIN_NODES / 4.0)))
    )
    return follow(pair, np.linspace(low, high, count)).at(phi1)


def _result(pair: Pair, asked: Array, rotation: Array, contacts: Contacts, started: float) -> ContactPath:
    """Build the path from solved contacts; the last position, phi1 = 0, is only the reference of the transmission error."""
    count = len(asked)
    # a contact that is any point of an edge or a line moves to its middle; lines get their points
    lines: list[Array | None] = [None] * count
    for number, part in pair.parts.items():
        to_middle(part, rotation, contacts, number)
        along = np.flatnonzero(contacts.line & (contacts.part == number))
        if not along.size:
            continue
        for which, piece in part.pieces(contacts.x[along]):
            places = along[which]
            line = trace(piece, rotation[places], contacts.x[places])
            contacts.x[places] = line.x
            for k, points in zip(places, line.points, strict=True):
                lines[k] = points
    # contact ellipses from the relative curvature, transmission error relative to phi1 = 0 or to the first contact
    own, fixed = contact_jets(pair, rotation, contacts)
    one, two = fixed
    e1, e2 = tangent_basis(one)
    ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta)
    gap = np.sqrt(dot(one.r - two.r, one.r - two.r))
    touching = contacts.touching
    te = contacts.x[:, 4] - pair.ratio * rotation
    first = np.flatnonzero(touching)
    reference = te[-1] if touching[-1] or not first.size else te[first[0]]
    on_edge = contacts.edges[:, 0] >= 0
    on_tip = HAS_TIP_EDGE[contacts.part]
    kind = np.select([~touching, on_tip, contacts.line, on_edge], ["none", "edge", "line", "edge"], "point").astype(
        "<U5"
    )
    keep = slice(0, count - 1)
    is_point = (kind == "point")[keep]

    def for_points(values: Array) -> Array:
        return np.where(is_point if values.ndim == 1 else is_point[:, None], values[keep], np.nan)

    return ContactPath(
        phi1=asked[keep],
        rotation=rotation[keep],
        phi2=contacts.x[keep, 4],
        te=(te - reference)[keep],
        kind=kind[keep],
        edge=_edge_names(pair, contacts)[keep],
        status=contacts.status[keep],
        residual=gap[keep],
        point=one.r[keep],
        normal=one.n[keep],
        point1=own[0].r[keep],
        point2=own[1].r[keep],
        params1=contacts.x[keep, 0:2],
        params2=contacts.x[keep, 2:4],
        semi_major=for_points(ellipse.semi_major),
        semi_minor=for_points(ellipse.semi_minor),
        angle=for_points(ellipse.angle),
        major=for_points(ellipse.major),
        minor=for_points(ellipse.minor),
        lines=tuple(lines[keep]),
        seconds=time.perf_counter() - started,
        part=contacts.part[keep],
    )


def contact_jets(pair: Pair, rotation: Array, contacts: Contacts) -> tuple[tuple[Jet, Jet], tuple[Jet, Jet]]:
    """Return jets (N,) of both members at the contacts, in the members' frames and in the fixed frame; NaN without contact."""
    jets = {
        number: Conditions(part.flanks, rotation, pair.length).touch(contacts.x, np.arange(len(rotation)))
        for number, part in pair.parts.items()
        if number == 0 or (contacts.part == number).any()
    }
    own: list[Jet] = []
    fixed: list[Jet] = []
    for member in (0, 1):
        for kept, of_parts in (
            (own, {number: jet.own[member] for number, jet in jets.items()}),
            (fixed, {number: jet.fixed[member] for number, jet in jets.items()}),
        ):
            chosen = of_parts.pop(0)
            for number, other in of_parts.items():
                chosen = chosen.where(contacts.part != number, other)
            kept.append(chosen)
    return (own[0], own[1]), (fixed[0], fixed[1])


def _edge_names(pair: Pair, contacts: Contacts) -> NDArray[np.str_]:
    """Return names (N,) of the edges in contact, two joined by "+"; tip corners, chamfers and roundings count as tip."""
    names = np.full(len(contacts.x), "", dtype="<U32")
    # CORNER has a name, -1 none
    named = np.concatenate((~IS_TIP_CORNER, [True, False]))
    for k in np.flatnonzero((contacts.edges[:, 0] >= 0) | (contacts.touching & HAS_TIP_EDGE[contacts.part])):
        of_tips = [
            f"{member}_tip"
            for member, region in zip(MEMBER_NAMES, PART_PAIRS[contacts.part[k]], strict=True)
            if region == TIP_EDGE
        ]
        own = [edge_name(pair, int(number)) for number in contacts.edges[k] if named[number]]
        names[k] = "+".join(dict.fromkeys([*of_tips, *own]))
    return names
