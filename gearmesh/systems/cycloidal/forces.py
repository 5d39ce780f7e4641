"""Forces in a cycloidal drive for a torque: rigid disc and ring, pins that yield alike in proportion to their force.

Without modification the deflection of a pin is the lever of its normal times one small rotation, and so is its force:

    F_i = T l_i / sum(l^2),   l_i lever about the axis of the pins, over the pins that push;   T torque on them

All normals pass through the pitch point. The force across the line of both axes is therefore T over the pitch radius.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.common.symbol_table import Row, running_rows, table
from gearmesh.systems.cycloidal.build import Drive
from gearmesh.systems.cycloidal.design import DISC_NAME, RING_NAME
from gearmesh.systems.cycloidal.geometry import PinCurve
from gearmesh.systems.system import SheetTable, complete_design

if TYPE_CHECKING:
    from gearmesh.systems.cycloidal.design import CycloidalDesign

#: positions within a pitch of the pins at which the largest forces are looked for
POSITIONS_PER_PITCH = 181


def pin_forces(curve: PinCurve, torque: float, phi: Array) -> Array:
    """Return the forces (..., N), N, of all pins at rotations phi (...,), rad, of the first pin, without modification.

    `torque`: torque (Nm) on the member with pins. Pins that do not push have no force.
    """
    places = phi[..., None] + 2.0 * np.pi * np.arange(curve.pins) / curve.pins
    levers = np.maximum(curve.levers(places), 0.0)
    return np.asarray(1e3 * torque * levers / (levers**2).sum(axis=-1, keepdims=True))


def pair_forces(design: CycloidalDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return the forces for a torque (Nm) on the disc, which turns at a speed (1/min) seen from the arm."""
    own = complete_design(design).in_mm()
    drive = Drive(own)
    curve, ratio = drive.curve, own.ring.teeth / own.disc.teeth
    on_pins = torque * ratio if own.pins_in_ring else torque
    phi = np.linspace(0.0, 2.0 * np.pi / curve.pins, POSITIONS_PER_PITCH)
    forces = pin_forces(curve, on_pins, phi)
    places = phi[:, None] + 2.0 * np.pi * np.arange(curve.pins) / curve.pins
    along = (forces * np.cos(places + curve.leans(places))).sum(axis=-1)
    across = 1e3 * on_pins / curve.pitch_radius
    rows: list[Row] = running_rows((torque, torque * ratio), None if speed is None else (speed, speed / ratio))
    rows += [
        ("n_F", "pins that push, mean", "-", (float((forces > 0.0).sum(axis=-1).mean()),) * 2),
        ("F_max", "largest force of a pin", "N", (float(forces.max()),) * 2),
        ("F_y", "sum of their forces across the line of both axes", "N", (across,) * 2),
        ("F_x", "sum along the line of both axes, largest", "N", (float(np.abs(along).max()),) * 2),
        (
            "F",
            "load of the eccentric's bearing by the pins, largest",
            "N",
            (float(np.hypot(along, across).max()), None),
        ),
    ]
    title = f"Forces for {torque:g} Nm on the disc, rigid members without modification"
    return (table(title, (DISC_NAME, RING_NAME), rows),)
