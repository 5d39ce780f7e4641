"""Rows of cells along every loaded contact: load per length, pressure, curvatures and velocities of both flanks.

A contact under load is a grid of cells: rows along the contact, each with its cells across. Flank surfaces are exact: each row
stands at the point of least gap, where both surfaces are solved for and their curvatures follow.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.sliding import FlankMotion, flank_motion
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import principal, shape_operator, tangent_basis
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kernel.surface.surface import Jet
from gearmesh.loaded.sharing import PairLoad, inside
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair

#: largest slope across a row of the gap at its least; a larger slope belongs to contact on an edge
MAX_GAP_SLOPE = 5e-4


@dataclass(frozen=True)
class ContactRows:
    """Loaded rows (N,) of all tooth pairs under one torque."""

    #: position (N,) of each row in the rotations of the pinion
    position: NDArray[np.intp]
    #: number (N,) of its tooth pair, as in `PairLoad`
    number: NDArray[np.intp]
    #: half (N,) of a double helical gear, 0 or 1
    half: NDArray[np.intp]
    #: points (N, 3), mm, fixed frame
    point: Array
    #: points (2, N, 3), mm, in the frames of the touching teeth of pinion and gear
    own_point: Array
    #: length (N,) of the row along the contact, mm
    length: Array
    #: load per length (N,), N/mm
    line_load: Array
    #: largest pressure (N,), MPa, of the cells of the row; NaN where an edge touches, where it is singular
    pressure: Array
    #: True (N,) where a pressed cell is next to an edge of a flank
    on_edge: NDArray[np.bool_]
    #: principal curvatures (2, N, 2), 1/mm, of both flanks by their outward normals, greater first
    curvatures: Array
    #: sliding and rolling
    motion: FlankMotion


def contact_rows(gears: GearPair, load: PairLoad) -> ContactRows:
    """Return the loaded rows of a pair under one torque."""
    grid = load.separation
    rows_load = load.pressure.sum(axis=2) * grid.dy[:, None]
    pair_index, row_index = np.nonzero(rows_load > 0.0)
    pressed_edge = np.any((load.pressure > 0.0) & ~inside(grid.on, 1), axis=2)
    flanks, halves = solver_pair(gears).flanks, gears.halves
    own_points = grid.places[:, pair_index, row_index]
    own_jets = [_jet(flank, points) for flank, points in zip(flanks, own_points, strict=True)]
    jets = [
        jet.move(Rigid(motion.rotation[pair_index], motion.translation[pair_index]))
        for jet, motion in zip(own_jets, grid.own_to_fixed, strict=True)
    ]
    point, normal = grid.middle[pair_index, row_index], grid.normal[pair_index, row_index]
    slope = dot(jets[0].n + jets[1].n, grid.across[pair_index])
    tangent = ~grid.edged[pair_index, row_index] & (np.abs(slope) < MAX_GAP_SLOPE)
    half = load.half[pair_index]
    motions = [
        (rows, flank_motion(halves[k].mounts, (jets[0][rows], jets[1][rows]), point[rows], normal[rows], tangent[rows]))
        for k in np.unique(half)
        for rows in [np.flatnonzero(half == k)]
    ]
    for k, image in enumerate(gears.images[1:], 1):
        point = np.where((half == k)[:, None], image.point(point), point)
    return ContactRows(
        load.position[pair_index],
        load.number[pair_index],
        half,
        point,
        own_points,
        grid.dx[pair_index],
        rows_load[pair_index, row_index],
        np.where(tangent, load.pressure.max(axis=2)[pair_index, row_index], np.nan),
        pressed_edge[pair_index, row_index],
        np.stack([_principal(jet) for jet in own_jets]),
        FlankMotion.joined(motions),
    )


def _jet(flank: Flank, points: Array) -> Jet:
    """Return the jet of a flank nearest to points (N, 3), own frame."""
    start = flank.heights.parameters_at(flank.mount.joint.radius(points), points[:, 2])
    with np.errstate(all="ignore"):
        return nearest(flank.surface, points, start[:, 0], start[:, 1]).jet


def _principal(jet: Jet) -> Array:
    """Return principal curvatures (N, 2), 1/mm, greater first."""
    curvatures = principal(shape_operator(jet, *tangent_basis(jet)))
    return np.stack((curvatures.k1, curvatures.k2), axis=-1)
