"""Machine settings by the names, axes and signs of the makers' sheets, beside those of `machine`.

Machine centre to back X_D counts along the blank's axis, the sliding base X_B along the cradle axis. The ratio of roll
R_a is blank over cradle. Its modification is given as derivatives of the blank's rotation, 2C, 6D, 24E, 120F, 720G: the
blank turns R_a (q - C q^2 - D q^3 - ...). The cutter's lean is a tilt i and a swivel j from the cutter's radius, or the
slopes of the cutter's axis along and across the root line.
"""

from __future__ import annotations

import math

import numpy as np

from gearmesh.systems.common.symbol_table import Row, table
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.machine import MachineSettings
from gearmesh.systems.system import SheetTable

#: symbols of the derivatives of the blank's rotation, from the second on
ROLL_DERIVATIVES = ("2C", "6D", "24E", "120F", "720G")


def maker_table(sides: list[Generated], columns: tuple[str, ...], unit: float, noun: str) -> SheetTable:
    """Return the table of settings of some sides; lengths over `unit` (mm) in `noun`."""
    machines = [side.settings for side in sides]
    leans = [_slopes(side) for side in sides]

    def row(symbol: str, words: str, kind: str, values: list[float | None]) -> Row:
        scale = {"deg": math.pi / 180.0, "-": 1.0}.get(kind, unit)
        return symbol, words, kind or noun, tuple(None if value is None else float(value) / scale for value in values)

    rows = [
        row("S", "radial distance", "", [m.radial for m in machines]),
        row("q", "basic cradle angle", "deg", [m.cradle_angle for m in machines]),
        row("i", "basic tilt angle", "deg", [m.tilt for m in machines]),
        row("j", "basic swivel angle, from the cutter's radius", "deg", [m.swivel for m in machines]),
        row("i_x", "lean of the cutter's axis along the root line", "deg", [lean[0] for lean in leans]),
        row("i_y", "lean of the cutter's axis across it", "deg", [lean[1] for lean in leans]),
        row("E_M", "blank offset", "", [m.machining_offset for m in machines]),
        row("X_B", "sliding base", "", [base(m) for m in machines]),
        row("X_D", "machine centre to back, along the blank's axis", "", [centre_to_back(m) for m in machines]),
        row("gamma_m", "machine root angle", "deg", [m.machine_root_angle for m in machines]),
        row("R_a", "ratio of roll, blank over cradle", "-", [ratio(m) for m in machines]),
    ]
    for power, symbol in enumerate(ROLL_DERIVATIVES, start=2):
        values = [derivative(m, power) for m in machines]
        if any(values):
            rows.append(
                row(
                    symbol,
                    f"modified roll, order {power}",
                    "-",
                    values,
                )
            )
    return table("Machine settings by the makers' names", columns, rows)


def centre_to_back(machine: MachineSettings) -> float:
    """Return X_D (mm): distance of the blank's apex behind the machine centre along the blank's axis."""
    return -machine.machine_centre_to_back / math.cos(machine.machine_root_angle)


def base(machine: MachineSettings) -> float:
    """Return X_B (mm) along the cradle axis, when X_D is along the blank's axis."""
    return machine.sliding_base - centre_to_back(machine) * math.sin(machine.machine_root_angle)


def ratio(machine: MachineSettings) -> float | None:
    """Return R_a, or None for a machine without roll."""
    return None if machine.formate else 1.0 / machine.ratio_of_roll


def derivative(machine: MachineSettings, power: int) -> float | None:
    """Return power! times the coefficient of the cradle's rotation to that power, or None for a machine without roll."""
    roll = machine.modified_roll
    if machine.formate:
        return None
    return math.factorial(power) * (roll[power - 2] if power - 2 < len(roll) else 0.0)


def _slopes(side: Generated) -> tuple[float, float]:
    """Return the angles (rad) by which the cutter's axis leans towards the heel and across the root line.

    Across counts along y of a right-hand member.
    """
    x, y, z = side.settings.cutter_axes(side.hand)[:, 2]
    return float(np.arctan2(x, z)), float(np.arctan2(side.hand * y, z))
