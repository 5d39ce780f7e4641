"""Figures by which the gears of a planetary set are inspected.

Sun and planet are taken from their mesh, the ring from its mesh with the planet.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.design.core import Design
from gearmesh.metrology.measured_teeth import InspectionBasis
from gearmesh.systems.cylindrical.double_helical import half_of
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.inspection.basis import inspection_of
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME
from gearmesh.systems.cylindrical.sheet import SheetPair
from gearmesh.systems.system import complete_design

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign
    from gearmesh.teeth.gear_train import GearTrain


def planetary_inspection(design: PlanetaryDesign, train: GearTrain, name: str) -> InspectionBasis:
    """Return the inspection basis of a member of a planetary design and the gear set built from it."""
    own = complete_design(design).in_mm()
    both, key = meshes(own), Design.table_named(name)
    mesh, names = (both.outer, (PLANET_NAME, RING_NAME)) if key == RING_NAME else (both.inner, (SUN_NAME, PLANET_NAME))
    half = half_of(mesh)
    members = tuple(train.members[f"{PLANET_NAME}_1" if called == PLANET_NAME else called] for called in names)
    basis = inspection_of(SheetPair(half, proportions(half), members), names.index(key))
    return replace(basis, asked=own.accuracy_class)
