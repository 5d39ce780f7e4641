"""Transmission error of a misassembled or eccentric bevel pair in closed form, of first order [CR3553 3.4, 3.5].

The nominal contact is that of the pair without errors; what each error adds is a scalar product (see `kinematic_errors`).
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

B = TypeVar("B", bound="BevelDesign")


def first_order(design: B, build: Callable[[B], GearTrain]) -> FirstOrder | None:
    """The closed form for a design in mm that `build` builds; None where it has no errors."""
    errors = design.assembly
    # directions without lengths are no errors
    if not any(value for key, value in errors.plain().items() if not key.endswith("_phase")):
        return None

    def transmission_error(phi1: Array) -> Array:
        pair = build(design.with_values(without_errors(design))).pairs[0]
        path = analyse(pair, np.append(phi1, 0.0))
        first, second = pair.mounts
        nominal = NominalContact(path.point, path.normal, first.axis, second.axis, first.sign, second.origin)
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
        relative: Array = (total - total[-1])[:-1]
        return relative

    return transmission_error
