"""Tables of the forces on a pinion and its rack for a torque, with power and speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.systems.common.running import running_rows
from gearmesh.systems.common.symbol_table import Row, table
from gearmesh.systems.cylindrical.force_tables import force_rows, speed_row
from gearmesh.systems.cylindrical.geometry.forces import mesh_forces
from gearmesh.systems.cylindrical.rack.design import PINION_NAME, RACK_NAME
from gearmesh.systems.cylindrical.rack.proportions import rack_proportions
from gearmesh.systems.system import SheetTable, complete_design
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.rack.design import RackDesign

#: names of the forces of a pair whose gear is a rack, by symbol
RACK_FORCE_NAMES = {
    "F_wt": "tangential, along the rack",
    "F_t": "tangential, at the reference circle",
    "F_wr": "radial: towards the pinion's axis; towards the back of the rack",
}


def rack_forces(design: RackDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return the forces on pinion and rack for a torque (Nm) on the pinion, which turns at a speed (1/min)."""
    own = complete_design(design).in_mm()
    mesh = rack_proportions(own).mesh
    flank = Side(own.contact.flank)
    forces = mesh_forces(mesh, torque, flank.sign)
    turning = running_rows((torque,), None if speed is None else (speed,))
    rows: list[Row] = [(*row[:3], (*row[3], None)) for row in turning]
    if speed is not None:
        symbol, _, unit, values = speed_row(mesh.pinion.radius, speed, 2)
        rows.append((symbol, "speed of the rack, and of the reference circle", unit, values))
    rows += [
        (symbol, RACK_FORCE_NAMES.get(symbol, words), unit, values)
        for symbol, words, unit, values in force_rows(forces, (1, 1))
    ]
    return (
        table(
            f"Forces for {torque:g} Nm on the pinion, its {flank.value} flanks driving", (PINION_NAME, RACK_NAME), rows
        ),
    )
