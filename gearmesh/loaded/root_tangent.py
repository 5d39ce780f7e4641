"""Place of the nominal root stress: the tangent of the fillet is at 30 deg to the middle of the tooth [ISO 6336-3 6.2].

    c ^    |  /  flank             c: from the middle of the form points to the middle of the tips
      |    | /                     w: along the tooth; c and w belong to a station
      |  __|/ 30 deg               the tangent is taken in the section across w
      +------> across

The angle of the tangent to c falls from 90 deg on the root land to its value at the form point. On internal teeth the
place is at 60 deg.
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.hexahedra.layers import layers
from gearmesh.teeth.region import FILLET_REGIONS, Side
from gearmesh.teeth.tooth import Tooth

#: angle of the tangent, rad, on external teeth
EXTERNAL_TANGENT = np.radians(30.0)
#: angle of the tangent, rad, on teeth that point to the axis
INTERNAL_TANGENT = np.radians(60.0)
#: cosine between the tooth and the outward direction below which a tooth points to the axis; teeth of face gears stand
#: along the axis
MAX_INTERNAL_COSINE = -0.7
#: points on a fillet between which the tangent is interpolated
FILLET_SAMPLES = 129


def tangent_weights(tooth: Tooth, side: Side, t: Array, nodes: Array) -> Array:
    """Return weights (K, F) that interpolate values at the nodes (F, 3) of a fillet to the places of the tangent.

    The nodes are in the order of the stations t (T,). Each row belongs to one station; stations without such a tangent
    have none.
    """
    s, sections = np.linspace(0.0, 1.0, FILLET_SAMPLES), layers(tooth, t)
    fillet = sections.grid(FILLET_REGIONS[side], s if side is Side.RIGHT else s[::-1])
    # directions along, up and across the tooth at every station
    end_middles = 0.5 * (sections.flank(Side.RIGHT, [0.0, 1.0]).points + sections.flank(Side.LEFT, [0.0, 1.0]).points)
    along = unit(np.gradient(end_middles[0], axis=0))
    tooth_direction = end_middles[1] - end_middles[0]
    tooth_direction = unit(tooth_direction - dot(tooth_direction, along)[:, None] * along)
    across = cross(along, tooth_direction)
    # angle of the tangent to the tooth: the normal's angle to the direction across
    angle = np.arctan2(np.abs(dot(fillet.normals, tooth_direction)), np.abs(dot(fillet.normals, across)))
    to_axis = (tooth_direction[:, :2] * tooth.joint.outward(end_middles[0])).sum(axis=-1).mean() < MAX_INTERNAL_COSINE
    tangent_angle = INTERNAL_TANGENT if to_axis else EXTERNAL_TANGENT
    steps = np.linalg.norm(np.diff(fillet.points, axis=0), axis=-1)
    arc = np.concatenate((np.zeros((1, len(t))), np.cumsum(steps, axis=0)))
    rows = nodes.reshape(len(t), -1, 3)
    # sample of the fillet nearest to each node
    nearest = np.linalg.norm(rows[:, :, None] - fillet.points.swapaxes(0, 1)[:, None], axis=-1).argmin(axis=2)
    rows_of_weights = []
    for k, node_samples in enumerate(nearest):
        # the place lies behind the last sample, counted from the root, with a larger angle; none if all samples or no
        # sample has one
        steeper = np.flatnonzero(angle[:, k] >= tangent_angle)
        if not steeper.size or steeper[-1] == FILLET_SAMPLES - 1:
            continue
        bracket = steeper[-1] + np.array([1, 0])
        tangent_arc = np.interp(tangent_angle, angle[bracket, k], arc[bracket, k])
        # linear interpolation between the nodes along the arc
        node_order = np.argsort(node_samples)
        weights = np.zeros(rows.shape[:2])
        weights[k, node_order] = [
            np.interp(tangent_arc, arc[node_samples[node_order], k], unit_row) for unit_row in np.eye(len(node_order))
        ]
        rows_of_weights.append(weights.ravel())
    return np.reshape(rows_of_weights, (len(rows_of_weights), len(nodes)))
