"""Tooth contact analysis: where two trimmed flanks touch, position by position, all positions in one batch.

For a given phi1 the driven gear lies where it is first touched: phi2 is the largest (drive +1) or smallest (-1) value
at which some point of one tooth meets the other. In the interior of both flanks that is tangency of the surfaces; else it lies
on an edge (tip, toe, heel), where two edges cross, or, where tips reach that far, on a fillet. Pairs that touch along lines make
the equations singular; they are recognised by their relative curvature.
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
from gearmesh.contact.pair import HAS_TIP_EDGE, MEMBERS, OF_CORNERS, PARTS, TIP_EDGE, Pair, edge_name
from gearmesh.contact.path import ContactPath
from gearmesh.errors import DesignError, Status
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import contact_ellipse, relative_curvature, tangent_basis
from gearmesh.kernel.surface.surface import Jet

#: so many positions are solved one by one over the whole of the flanks; more are followed from nodes
DIRECT = 64
#: nodes from which positions are followed, at most a pitch's part apart
NODES = 48
#: rounds in which the rotation is found for a phi1 that the source counts otherwise
COUNTS = 6


def contact_path(
    pair: Pair,
    phi1: Array,
    count_phi1: Callable[[Array, Array], Array] | None = None,
    *,
    edges: bool = True,
    engagement: Engagement | None = None,
) -> ContactPath:
    """Contact of one tooth pair at rotations phi1 (P,), rad; TE relative to phi1 = 0.

    `count_phi1` gives, for pinion surface parameters, the angle by which the source counts phi1 (the generation
    angle of [LT85]); the rotation is then found that makes it take the values asked for, inside both flanks. Without `edges` only
    tangency inside both flanks is looked for. An `engagement` of the pair that is known already is made use of.
    Positions without contact come back as kind "none" with the reason in `status`; nothing is raised for them, and
    no floating-point warnings either: what is not finite is reported by its status. Raises DesignError where the flanks push the
    other way than the pair's `drive` says.
    """
    started = time.perf_counter()
    asked = np.append(np.asarray(phi1, dtype=float), 0.0)
    with np.errstate(all="ignore"):
        rotation = asked.copy()
        contacts = _solve(pair, rotation, edges, engagement)
        if count_phi1 is not None:
            for _ in range(COUNTS):
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
    """The path of gears that are jammed at rotations phi1 (P,), rad, all along: no contact, and the status says why."""
    phi1 = np.asarray(phi1, dtype=float)
    every = np.append(phi1, 0.0)
    path = _result(pair, every, every, Contacts.nothing(len(every)), time.perf_counter())
    return replace(path, status=np.full(len(phi1), int(Status.JAMMED)))


def _count_offset(count_phi1: Callable[[Array, Array], Array], rotation: Array, contacts: Contacts) -> Array:
    """By how much (N,), rad, the source's phi1 is ahead of the pinion's rotation; on edges, which no source treats, as much as
    where surface contact ends next to them."""
    offset = count_phi1(contacts.x[:, 0], contacts.x[:, 1]) - rotation
    inside = np.flatnonzero(contacts.touching & (contacts.edges[:, 0] < 0) & (contacts.part == 0) & np.isfinite(offset))
    if not inside.size:
        return np.zeros(len(rotation))
    inside = inside[np.argsort(rotation[inside], kind="stable")]
    known = np.interp(rotation, rotation[inside], offset[inside])
    known[inside] = offset[inside]
    return known


def _solve(pair: Pair, phi1: Array, edges: bool, engagement: Engagement | None) -> Contacts:
    """Contacts at rotations phi1 (N,)."""
    if not edges:
        return touches(pair.parts[0], phi1, edges=False)[0]
    if engagement is not None:
        return engagement.at(phi1)
    if len(phi1) <= DIRECT:
        return touches(pair, phi1)[0]
    low, high = phi1.min(), phi1.max()
    count = NODES if np.isnan(pair.pitch) else max(NODES, int(np.ceil((high - low) / pair.pitch * NODES / 4.0)))
    return follow(pair, np.linspace(low, high, count)).at(phi1)


def _result(pair: Pair, asked: Array, rotation: Array, contacts: Contacts, started: float) -> ContactPath:
    """Everything reported, from the unknowns; the last position, phi1 = 0, only serves as the reference of TE."""
    count = len(asked)
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
    """Jets (N,) of both members at the contacts, in their own frames and in the fixed one; NaN where there is none."""
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
    """Names of the edges in contact (N,), two joined by "+"; corners of a tip line, chamfers and roundings are of the tip."""
    names = np.full(len(contacts.x), "", dtype="<U32")
    # CORNER has a name, -1 none
    named = np.concatenate((~OF_CORNERS, [True, False]))
    for k in np.flatnonzero((contacts.edges[:, 0] >= 0) | (contacts.touching & HAS_TIP_EDGE[contacts.part])):
        of_tips = [
            f"{member}_tip"
            for member, region in zip(MEMBERS, PARTS[contacts.part[k]], strict=True)
            if region == TIP_EDGE
        ]
        own = [edge_name(pair, int(number)) for number in contacts.edges[k] if named[number]]
        names[k] = "+".join(dict.fromkeys([*of_tips, *own]))
    return names
