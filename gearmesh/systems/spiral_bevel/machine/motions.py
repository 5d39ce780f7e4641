"""Modified roll and motions of a machine by the keys of a design."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.spiral_bevel.design import MAX_MOTION_ORDER
from gearmesh.systems.spiral_bevel.machine.machine import MachineSettings

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import Machine


def given_roll(spec: Machine) -> tuple[float, ...]:
    """Return the coefficients of modified roll of a design from the second order on."""
    return tuple(getattr(spec, f"modified_roll_c{k}") for k in range(2, MAX_MOTION_ORDER + 1))


def with_motions(settings: MachineSettings, spec: Machine) -> MachineSettings:
    """Return settings with the modified roll and the motions of a design in mm."""
    return replace(
        settings,
        modified_roll=given_roll(spec),
        tilt_motion=tuple(float(a) for a in np.radians(spec.tilt_motion)),
        swivel_motion=tuple(float(a) for a in np.radians(spec.swivel_motion)),
        radial_motion=spec.radial_motion,
        helical_motion=spec.helical_motion,
        vertical_motion=spec.vertical_motion,
    )
