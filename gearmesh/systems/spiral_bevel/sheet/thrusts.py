"""Forces on both members of a bevel pair for a torque on the pinion, for both driving sides."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.systems.common.bevel.blank import BevelBlank
from gearmesh.systems.common.bevel.forces import along_normal, by_formula, force_rows
from gearmesh.systems.common.symbol_table import table
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES
from gearmesh.systems.spiral_bevel.synthesis.settings import MeanPoint
from gearmesh.systems.system import SheetTable


def thrust_table(blank: BevelBlank, means: dict[str, MeanPoint], gear_base: Rigid, torque: float) -> SheetTable:
    """Return the table of forces for a torque (Nm) on the pinion, for both driving sides.

    `means`: mean points by side of the pinion.
    """
    columns, formulas, normals = [], [], []
    # the drive side, concave on the pinion, meets the gear's convex side, which inside blades cut
    for (name, side), pressure in zip(BLADE_SIDES.items(), blank.blade_angles, strict=True):
        exact = along_normal(1e3 * torque, means[name].contact.point, means[name].contact.normal, gear_base)
        for k, (member, member_blank) in enumerate((("pinion", blank.pinion), ("gear", blank.gear))):
            columns.append(f"{member}, {name}")
            # the component across the teeth is the same on both members
            tangential = (
                1e3
                * torque
                / blank.pinion.mean_radius
                * np.cos(member_blank.spiral_angle)
                / np.cos(blank.pinion.spiral_angle)
            )
            sense = side if k == 0 else -side
            formulas.append(by_formula(float(tangential), member_blank, pressure, sense))
            normals.append(exact[k])
    return table(
        f"Forces for {torque:g} Nm on the pinion, its concave or convex side driving",
        tuple(columns),
        force_rows(formulas, normals),
    )
