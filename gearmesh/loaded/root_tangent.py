"""Where a fillet's tangent is at 30 deg to the middle of its tooth, the place of the nominal root stress [ISO 6336-3 6.2].

c ^    |  /  flank             c: from the form points' middle to that of the tips, w: along the tooth, both of a station;
  |    | /                     the tangent is that of the section across w, its angle to c falls from 90 deg on the
  |  __|/ 30 deg               root land to the form point; on internal teeth the place is at 60 deg
  +------> across
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.hexahedra.layers import layers
from gearmesh.teeth.region import FILLETS, Side
from gearmesh.teeth.tooth import Tooth

#: angle of the tangent, rad, of external teeth and of those that point to the axis
EXTERNAL, INTERNAL = np.radians(30.0), np.radians(60.0)
#: cosine to the direction from the axis below which a tooth counts as pointing to it: those of face gears stand along it
TO_AXIS = -0.7
#: places on a fillet between which its tangents are interpolated
SAMPLES = 129


def tangent_weights(tooth: Tooth, side: Side, t: Array, nodes: Array) -> Array:
    """What (K, F) of values at nodes (F, 3) of a fillet, station by station of t (T,), makes the value at the tangent: one row a
    station, none for those at which no tangent has the angle."""
    s, sections = np.linspace(0.0, 1.0, SAMPLES), layers(tooth, t)
    fillet = sections.grid(FILLETS[side], s if side is Side.RIGHT else s[::-1])
    ends = 0.5 * (sections.flank(Side.RIGHT, [0.0, 1.0]).points + sections.flank(Side.LEFT, [0.0, 1.0]).points)
    along = unit(np.gradient(ends[0], axis=0))
    up = ends[1] - ends[0]
    up = unit(up - dot(up, along)[:, None] * along)
    across = cross(along, up)
    angle = np.arctan2(np.abs(dot(fillet.normals, up)), np.abs(dot(fillet.normals, across)))
    to_axis = (up[:, :2] * tooth.joint.outward(ends[0])).sum(axis=-1).mean() < TO_AXIS
    wanted = INTERNAL if to_axis else EXTERNAL
    steps = np.linalg.norm(np.diff(fillet.points, axis=0), axis=-1)
    arc = np.concatenate((np.zeros((1, len(t))), np.cumsum(steps, axis=0)))
    rows = nodes.reshape(len(t), -1, 3)
    nearest = np.linalg.norm(rows[:, :, None] - fillet.points.swapaxes(0, 1)[:, None], axis=-1).argmin(axis=2)
    rows_of_weights = []
    for k, places in enumerate(nearest):
        steeper = np.flatnonzero(angle[:, k] >= wanted)
        if not steeper.size or steeper[-1] == SAMPLES - 1:
            continue
        last = steeper[-1] + np.array([1, 0])
        place = np.interp(wanted, angle[last, k], arc[last, k])
        order = np.argsort(places)
        weights = np.zeros(rows.shape[:2])
        weights[k, order] = [np.interp(place, arc[places[order], k], unit_row) for unit_row in np.eye(len(order))]
        rows_of_weights.append(weights.ravel())
    return np.reshape(rows_of_weights, (len(rows_of_weights), len(nodes)))
