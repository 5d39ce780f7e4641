"""Flanks that cross where they are tangent: such places fulfil the equations of contact, but the bodies overlap beside them.

The advance of the points of the pinion is stationary there: greatest in one direction, least in the other. Other points of the
flanks, up to their edges, are ahead, so that edges touch for any mounts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.conditions.refinement import EDGE_SLACK, Trial, shape, solve
from gearmesh.contact.first_touch.field import NO_EDGE, advances
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric.algebra import Array, dot

#: positions of an engagement at which crossing is looked for
CROSSING_POSITIONS = 33
#: step in nodes of the pinion's flank between starts of the solution
NODE_STEP = 2


def crossing(pair: Pair, phi1: Array) -> NDArray[np.bool_]:
    """Return True (N,) for rotations phi1 (N,), rad, at which the flanks of a part cross where they are tangent inside both."""
    nodes = pair.pinion.grid[::NODE_STEP, ::NODE_STEP].reshape(-1, 2)
    jet = pair.pinion.surface.jet(nodes[:, 0], nodes[:, 1])
    crossed = np.zeros(len(phi1), dtype=bool)
    with np.errstate(all="ignore"):
        # solve for tangency from every node on both flanks
        field = advances(pair, phi1, jet.r, jet.n, np.arange(len(phi1)))
        position, k = np.nonzero(np.isfinite(field.advance) & (field.beyond <= 0.0).all(axis=0))
        on_gear = pair.gear.heights.parameters_at(field.rho[position, k], field.z[position, k])
        phi2 = pair.drive * field.advance[position, k] + pair.ratio * phi1[position]
        start = np.column_stack((nodes[k], on_gear, phi2))
        trial = Trial.of(position, start, np.full((len(position), 2), NO_EDGE))
        solve(pair, phi1, trial)
        # solutions inside both flanks whose normals face each other; the signs of the relative curvatures say which ones cross
        tangent = np.flatnonzero((trial.beyond <= EDGE_SLACK).all(axis=1) & ~trial.line)
        touch = Conditions(pair.flanks, phi1, pair.length).touch(trial.x[tangent], position[tangent])
        facing = dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0
        crossed[position[tangent[shape(pair, touch)[1] & facing]]] = True
    return crossed


def crossing_over_a_pitch(pair: Pair, phi1: Array, pitch: float) -> bool:
    """Return True if flanks that are engaged over phi1 (N,), rad, cross over more than a `pitch` (rad) of the pinion.

    Some tooth pair then crosses at every position.
    """
    phi1 = np.linspace(phi1[0], phi1[-1], CROSSING_POSITIONS)
    return bool(crossing(pair, phi1).mean() * np.ptp(phi1) > pitch)
