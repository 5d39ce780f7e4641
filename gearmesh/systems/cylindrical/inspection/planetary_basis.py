"""What the gears of a planetary set are inspected by: sun and planet as their mesh has them, the ring as that with the planet."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.design.core import Design
from gearmesh.metrology.measured_teeth import InspectionBasis
from gearmesh.systems.cylindrical.double_helical import half_of
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.inspection.basis import inspection_of
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET, RING, SUN
from gearmesh.systems.cylindrical.sheet import SheetPair
from gearmesh.systems.system import complete_design

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign
    from gearmesh.teeth.gear_train import GearTrain


def planetary_inspection(design: PlanetaryDesign, train: GearTrain, name: str) -> InspectionBasis:
    """Of a member of a planetary design and the gear set built of it."""
    own = complete_design(design).in_mm()
    both, key = meshes(own), Design.table_named(name)
    mesh, names = (both.outer, (PLANET, RING)) if key == RING else (both.inner, (SUN, PLANET))
    half = half_of(mesh)
    members = tuple(train.members[f"{PLANET}_1" if called == PLANET else called] for called in names)
    basis = inspection_of(SheetPair(half, proportions(half), members), names.index(key))
    return replace(basis, asked=own.accuracy_class)
