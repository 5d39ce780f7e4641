"""Places that a summit of the advance explains: what is known of its surroundings leaves no room for another summit that is higher.

About a place of contact the advance falls as the gap between the flanks opens: by the slope over an edge that it lies on, and by
the relative curvature. A place whose sampled advance is that of the model, as exactly as it lies below the summit, needs no
solution of its own. What was sampled decides, not the model: where they differ, it is solved for.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import in_plane, principal, relative_curvature, tangent_basis

#: part of what a place lies below the summit by which its sample may differ from the model: of the least within half a step of the
#: lattice around it, so that nothing that lies on one ridge with the summit is explained by how steep its sides are
APART = 0.5
#: the same of places within a step of the summit, between which samples would not tell two summits apart
BESIDE = 0.15
#: rad by which a sample may differ at the least: the accuracy of tables
NOISE = 5e-9
#: slope of the advance, rad/mm, that counts as none
LEVEL = 1e-12


def explained(
    pair: Pair,
    phi1: Array,
    position: NDArray[np.intp],
    summits: tuple[Array, Array],
    places: tuple[Array, Array],
    step: Array,
) -> NDArray[np.bool_]:
    """True for places (M,) that summits explain, one each, at positions (M,).

    `summits` and `places`: unknowns (M, 5) and advances (M,), rad. `step` (2, 2): steps of the lattice of places along its rows and
    columns, in the pinion's parameters. No summit explains what is ahead of it, or a saddle anything.
    """
    (top, highest), (start, advance) = summits, places
    conditions = Conditions(pair.flanks, phi1, pair.length)
    touch = conditions.touch(top, position)
    one, two = touch.fixed
    way = conditions.mounts(position)[1].velocity(two.r)
    push = dot(two.n, way)
    e1, e2 = tangent_basis(one)
    own = principal(relative_curvature(one, two, e1, e2))
    placed = pair.pinion.surface.jet(start[:, 0], start[:, 1]).r - touch.own[0].r
    offset = (touch.turns[0] @ placed[..., None])[..., 0]
    sides = [
        du[:, None] * one.r_u + dv[:, None] * one.r_v for du, dv in np.broadcast_to(step[..., None], (2, 2, len(top)))
    ]
    # the way in which the advance falls most, where the summit is one on an edge alone
    slope = pair.drive * np.stack((dot(e1, two.n), dot(e2, two.n))) / push
    steepness = np.hypot(*slope)
    level = steepness < LEVEL
    downhill = -np.where(level, 0.0, slope / np.where(level, 1.0, steepness))
    ways = [(steepness, 1, downhill[0][:, None] * e1 + downhill[1][:, None] * e2)]
    size = np.abs(push)
    for curvature, direction in zip((own.k1, own.k2), in_plane(own.angle, e1, e2), strict=True):
        ways.append((-0.5 * curvature / size, 2, direction))
    lower, least = np.zeros(len(top)), np.zeros(len(top))
    beside = np.ones(len(top), dtype=bool)
    for rate, power, direction in ways:
        away = dot(offset, direction)
        reach = sum(np.abs(dot(side, direction)) for side in sides)
        if power == 2:
            away = np.abs(away)
            beside &= away <= reach
        lower += rate * away**power
        least += np.maximum(rate, 0.0) * np.maximum(away - 0.5 * reach, 0.0) ** power
    # bodies on either side in all directions
    good = (own.k1 <= 0.0) & (lower >= 0.0)
    room = NOISE + np.maximum(APART * least, np.where(beside, BESIDE * lower, 0.0))
    explains: NDArray[np.bool_] = good & (np.abs(highest - lower - advance) <= room)
    return explains
