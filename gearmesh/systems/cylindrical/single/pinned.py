"""Values that a gear without a mating gear leaves to its build."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.systems.cylindrical.pinned import member_values
from gearmesh.systems.cylindrical.single.build import proportions

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.cylindrical.single.design import SingleGearDesign
    from gearmesh.teeth.gear_train import GearTrain


def single_values(design: SingleGearDesign, train: GearTrain) -> Values:
    """Return the values for a complete design in mm and the gear built from it."""
    name = design.member_name
    return {"arrangement": design.arrangement, **member_values(proportions(design), name, train.members[name])}
