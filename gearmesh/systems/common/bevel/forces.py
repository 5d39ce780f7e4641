"""Forces on both members of a bevel pair for a torque on the pinion, at the mean point, without friction.

The forces are computed by the formulas of AGMA 2003-B97 and ISO 10300-1 (see `by_formula`), and by the normal of the
exact flanks. Each force has three components:

- tangential, against the motion of the pinion and along the motion of the gear
- axial, > 0 away from the crossing point
- separating, > 0 away from the mating gear

The formulas use the mean cone distances, the spiral angle of each member and the pressure angle of the driving side.
The exact normal is the normal of the flanks at the nominal contact of phi1 = 0.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.blank import MemberBlank
from gearmesh.systems.common.symbol_table import Row


@dataclass(frozen=True)
class ToothForces:
    """Components of the force on one member."""

    #: tangential force, N
    tangential: float
    #: axial force, N, > 0 away from the crossing point
    axial: float
    #: separating force, N, > 0 away from the mating gear
    separating: float


def by_formula(tangential: float, member: MemberBlank, pressure_angle: float, sense: int) -> ToothForces:
    """Return the components by F_x = F_t / cos(beta) (tan(alpha) sin(delta) + sense sin(beta) cos(delta)).

    F_r has cos(delta) in the first term and - sense sin(delta) in the second. Angles in rad. `sense` is +1 where the
    member's spiral pushes it away from the crossing point, else -1. It is +1 for a pinion that drives with its concave
    side, and for a gear that is driven on its concave side.
    """
    s, c = np.sin(member.pitch_angle), np.cos(member.pitch_angle)
    across, along = np.tan(pressure_angle) / np.cos(member.spiral_angle), sense * np.tan(member.spiral_angle)
    return ToothForces(
        tangential, float(tangential * (across * s + along * c)), float(tangential * (across * c - along * s))
    )


def along_normal(torque: float, point: Array, normal: Array, gear_base: Rigid) -> tuple[ToothForces, ToothForces]:
    """Return the forces on pinion and gear of a contact at a point (3,) of the pinion's frame.

    - `torque`: torque on the pinion, Nmm
    - `normal`: normal of the flanks (3,) out of the pinion
    - `gear_base`: position of the gear's frame in the pinion's
    """
    arm = abs(float(normal @ np.cross(Z_AXIS, point)))
    force = -torque / arm * normal
    back = gear_base.inverse
    return _parts(force, point), _parts(back.vector(-force), back.point(point))


def _parts(force: Array, point: Array) -> ToothForces:
    """Return the components of a force (3,) on a member at a point (3,), in its frame."""
    outward = np.array([point[0], point[1], 0.0]) / np.hypot(point[0], point[1])
    return ToothForces(abs(float(force @ np.cross(Z_AXIS, outward))), float(force @ Z_AXIS), -float(force @ outward))


def force_rows(formulas: Sequence[ToothForces], normals: Sequence[ToothForces]) -> list[Row]:
    """Return the rows of the components, a column for each force: by formula, and by the exact normal."""
    rows: list[Row] = []
    for symbol, words, key in (
        ("F_mt", "tangential", "tangential"),
        ("F_ax", "axial, > 0 away from the crossing point", "axial"),
        ("F_rad", "separating, > 0 away from the mating gear", "separating"),
    ):
        rows.append((symbol, words, "N", tuple(getattr(forces, key) for forces in formulas)))
        exact_words = f"{words.split(',')[0]}, by the exact normal"
        rows.append((f"{symbol}_n", exact_words, "N", tuple(getattr(forces, key) for forces in normals)))
    return rows
