"""Tables of the forces on cylindrical gears for a torque, with powers and speeds [ISO 21771]; without friction."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.systems.common.running import running_rows
from gearmesh.systems.common.symbol_table import Row, Values, table
from gearmesh.systems.cylindrical.double_helical import half_of
from gearmesh.systems.cylindrical.geometry.forces import MeshForces, mesh_forces
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.system import SheetTable, complete_design
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign


def pair_forces(design: CylindricalDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return the forces on pinion and gear for a torque (Nm) on the pinion, which turns at a speed (1/min)."""
    own = complete_design(design).in_mm()
    mesh = proportions(half_of(own)).mesh
    flank = Side(own.contact.flank)
    forces, ratio = mesh_forces(mesh, torque, flank.sign), mesh.gear.teeth / mesh.pinion.teeth
    senses = (mesh.pinion.sense, mesh.gear.sense)
    rows = running_rows((torque, torque * ratio), None if speed is None else (speed, speed / ratio))
    if speed is not None:
        rows.append(speed_row(mesh.working_radius(mesh.pinion), speed, 2))
    title = f"Forces for {torque:g} Nm on the pinion, its {flank.value} flanks driving"
    return (table(title, MEMBER_NAMES, [*rows, *force_rows(forces, senses, halves=own.double_helical)]),)


def speed_row(radius: float, speed: float, columns: int) -> Row:
    """Return the row of the speed (m/s) of a pitch circle of a `radius` (mm) at a rotational speed (1/min)."""
    return (
        "v_w",
        "circumferential speed of the working pitch circles",
        "m/s",
        (1e-3 * radius * math.pi * speed / 30.0,) * columns,
    )


def force_rows(forces: MeshForces, senses: tuple[int, int], *, halves: bool = False) -> list[Row]:
    """Return the rows of the forces on both members of a mesh.

    - senses: -1 for an internal member, else +1.
    - halves: True for double helical gears, whose axial forces cancel each other.
    """
    axial: Values = forces.axial, -forces.axial
    none: Values = 0.0, 0.0
    rows: list[Row] = [
        ("F_wt", "tangential, at the working pitch circles", "N", (forces.tangential,) * 2),
        ("F_t", "tangential, at the reference circles", "N", (forces.at_reference,) * 2),
        ("F_wr", "radial, > 0 towards the own axis", "N", tuple(sense * forces.radial for sense in senses)),
        ("F_wa", "axial, > 0 along z", "N", none if halves else axial),
        ("F_bn", "normal to the flanks", "N", (forces.normal,) * 2),
    ]
    if halves:
        of_half: Values = 0.5 * forces.axial, -0.5 * forces.axial
        rows.insert(4, ("F_waB", "axial, of the first half alone, > 0 along z", "N", of_half))
    return rows
