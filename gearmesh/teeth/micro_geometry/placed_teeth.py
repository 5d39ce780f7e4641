"""Teeth of a member at the places of its index angles, for solids: flanks turn about the axis, the root stays.

A turned flank is the flank at its place with deviations along its normals, which end in the fillet. The deviation d at
a point r of the flank is the distance to the turned flank along the normal n,

    R(angle) S(u, v) = r + d n,    by Newton's method in (u, v, d)

A bicubic spline interpolates it between the points of a grid, at which it is exact.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.deviations import EDGE_MARGIN, DeviationGrid, deviating_tooth
from gearmesh.teeth.micro_geometry.index_angles import NO_INDEX_ANGLES
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: points across and along a flank
DEVIATION_GRID = (7, 7)
#: most Newton steps to a distance
DISTANCE_NEWTON_STEPS = 8
#: change of the distance that ends them
DISTANCE_TOLERANCE_MM = 1e-12


def placed_teeth(member: Member) -> Member:
    """Return the member with teeth that differ by their places, and no index angles; the same member if all angles are
    equal.

    Teeth with generated lands, as lobes and pins, stay at their nominal places: lands do not follow moved flanks.

    Raises DesignError if flanks cannot be moved, as flanks with corners.
    """
    index, teeth = member.index, member.tooth.teeth
    if not index.uneven:
        return member
    if not can_be_placed(member):
        return replace(member, index=NO_INDEX_ANGLES)
    angles = np.stack([index.of(side, teeth) for side in Side], axis=-1)
    kinds, which = np.unique(angles, axis=0, return_inverse=True)
    try:
        made = [_turned_tooth(member.one_tooth, dict(zip(Side, kind.tolist(), strict=True))) for kind in kinds]
    except DesignError as failure:
        raise DesignError(f"{member.name} pitch deviations", reason=str(failure), topic="pitch deviations") from failure
    return replace(member, index=NO_INDEX_ANGLES).with_teeth(
        {k: made[kind] for k, kind in enumerate(which.ravel().tolist())}
    )


def can_be_placed(member: Member) -> bool:
    """Return True if the flanks of a member can be moved: their lands are no generated surfaces."""
    return member.tooth.crest is None


def has_placed_teeth(member: Member) -> bool:
    """Return True if whole solids of a member have its teeth at the places of their index angles."""
    return member.index.uneven and can_be_placed(member)


def _turned_tooth(tooth: Tooth, angles: dict[Side, float]) -> Tooth:
    """Return the tooth with each flank turned by its angle, rad."""
    return deviating_tooth(tooth, {side: turned_grid(tooth, side, angle) for side, angle in angles.items() if angle})


def turned_grid(tooth: Tooth, side: Side, angle: float) -> DeviationGrid:
    """Distances from a flank to the same flank turned by an angle, rad, about the axis, along the normals of the
    first.
    """
    s, t = np.linspace(EDGE_MARGIN, 1.0, DEVIATION_GRID[0]), np.linspace(0.0, 1.0, DEVIATION_GRID[1])
    grid = tooth.flank_grid(side, s, t)
    r, n = grid.points, grid.normals
    return DeviationGrid(r, n, _distances(tooth, side, grid.parameters, r, n, angle))


def _distances(tooth: Tooth, side: Side, parameters: Array, r: Array, n: Array, angle: float) -> Array:
    """Distances (I, J), mm, along normals n at points r (I, J, 3)."""
    surface, turn = tooth.side(side).flank, Rigid.about_z(angle)
    u, v = np.moveaxis(parameters, -1, 0)
    d = np.zeros(u.shape)
    for _ in range(DISTANCE_NEWTON_STEPS):
        jet = surface.jet(u, v).move(turn)
        matrix = np.stack((jet.r_u, jet.r_v, -n), axis=-1)
        step = np.linalg.solve(matrix, (r + d[..., None] * n - jet.r)[..., None])[..., 0]
        u, v, d = u + step[..., 0], v + step[..., 1], d + step[..., 2]
        if np.abs(step[..., 2]).max() < DISTANCE_TOLERANCE_MM:
            return np.asarray(d)
    raise DesignError("index", reason=f"a flank turned by {angle:.3g} rad does not cross the normals of its place")
