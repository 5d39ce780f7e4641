"""Transmission error of a misassembled or eccentric bevel pair in closed form, to first order [CR3553 3.4, 3.5].

The nominal contact is the contact of the pair without errors. Each error adds a scalar product: see `kinematic_errors`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from gearmesh.contact.flanks import analyse
from gearmesh.design.runout import runout
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.spiral_bevel.errors.kinematic_errors import NominalContact
from gearmesh.systems.spiral_bevel.machine.pair import without_errors
from gearmesh.systems.system import FirstOrder
from gearmesh.teeth.gear_train import GearTrain

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import BevelDesign

BevelT = TypeVar("BevelT", bound="BevelDesign")


def first_order(design: BevelT, build: Callable[[BevelT], GearTrain]) -> FirstOrder | None:
    """Return the closed form for a design in mm that `build` builds, or None for a design without errors."""
    errors = design.assembly
    # phases alone are no errors
    if not any(value for key, value in errors.plain().items() if not key.endswith("_phase")):
        return None

    def transmission_error(phi1: Array) -> Array:
        pair = build(design.with_values(without_errors(design))).pairs[0]
        # nominal contact at phi1, and at the mean point as the last one
        path = analyse(pair, np.append(phi1, 0.0))
        pinion_mount, gear_mount = pair.mounts
        nominal = NominalContact(
            path.point, path.normal, pinion_mount.axis, gear_mount.axis, pinion_mount.sign, gear_mount.origin
        )
        # displacement of the teeth of each member by its eccentricity, in the fixed frame
        teeth = [
            member.mount.at(turn).vector(np.array([*runout(design, member.name), 0.0]))
            for member, turn in zip(pair.both, (path.rotation, path.phi2), strict=True)
        ]
        error = (
            nominal.pinion_axial(errors.dA)
            + nominal.gear_axial(errors.dG)
            + nominal.offset(errors.dV)
            + nominal.shaft_angle(np.radians(errors.d_delta))
            + nominal.eccentricity(*teeth)
        )
        total: Array = path.te + error
        # relative to the mean point
        relative: Array = (total - total[-1])[:-1]
        return relative

    return transmission_error
