"""Forces in a cycloidal drive for a torque: rigid disc and ring, pins that yield alike in proportion to their force.

Without modification the deflection of a pin is the lever of its normal times one small rotation, and so is its force:

    F_i = T l_i / sum(l^2),   l_i lever about the axis of the pins, over the pins that push;   T torque on them

Discs that the output pins turn alike share the torque as their stiffness, T_k / T = sum(l_k^2) / sum over all discs.
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


def disc_shares(curve: PinCurve, arms: tuple[float, ...], phi: Array) -> Array:
    """Return the shares (..., D) of the torque on discs whose eccentrics are at angles `arms` (D,), rad.

    `phi` (...,): rotations of the first pin, rad, seen from the first eccentric.
    """
    stiffness = []
    for arm in arms:
        places = phi[..., None] - arm + 2.0 * np.pi * np.arange(curve.pins) / curve.pins
        stiffness.append((np.maximum(curve.levers(places), 0.0) ** 2).sum(axis=-1))
    stacked = np.stack(stiffness, axis=-1)
    return np.asarray(stacked / stacked.sum(axis=-1, keepdims=True))


def pair_forces(design: CycloidalDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return the forces for a torque (Nm) on all discs, which turn at a speed (1/min) seen from the arm."""
    own = complete_design(design).in_mm()
    drive = Drive(own)
    curve, ratio = drive.curve, own.ring.teeth / own.disc.teeth
    on_pins = torque * ratio if own.pins_in_ring else torque
    phi = np.linspace(0.0, 2.0 * np.pi / curve.pins, POSITIONS_PER_PITCH)
    # all discs pass through the same positions, with other shares of the torque
    shares = disc_shares(curve, own.arm_angles, phi)
    of_first = shares[:, 0]
    forces = of_first[:, None] * pin_forces(curve, on_pins, phi)
    # sums of the forces along and across the line of both axes; across it they carry the torque at the pitch radius
    places = phi[:, None] + 2.0 * np.pi * np.arange(curve.pins) / curve.pins
    along = (forces * np.cos(places + curve.leans(places))).sum(axis=-1)
    across = 1e3 * of_first * on_pins / curve.pitch_radius
    rows: list[Row] = running_rows((torque, torque * ratio), None if speed is None else (speed, speed / ratio))
    if own.discs > 1:
        rows += [
            ("w_min", "least share of a disc", "-", (float(shares.min()), None)),
            ("w_max", "largest share of a disc", "-", (float(shares.max()), None)),
        ]
    rows += [
        ("n_F", "pins that push, mean", "-", (float((forces > 0.0).sum(axis=-1).mean()),) * 2),
        ("F_max", "largest force of a pin", "N", (float(forces.max()),) * 2),
        ("F_y", "sum of their forces across the line of both axes", "N", (float(across.max()),) * 2),
        ("F_x", "sum along the line of both axes, largest", "N", (float(np.abs(along).max()),) * 2),
        (
            "F",
            "load of the eccentric's bearing by the pins, largest",
            "N",
            (float(np.hypot(along, across).max()), None),
        ),
    ]
    on = "the disc" if own.discs == 1 else f"{own.discs} discs, forces of one"
    title = f"Forces for {torque:g} Nm on {on}, rigid members without modification"
    return (table(title, (DISC_NAME, RING_NAME), rows),)
