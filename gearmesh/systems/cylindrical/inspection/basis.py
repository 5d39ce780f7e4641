"""Figures by which cylindrical gears are inspected [ISO 1328-1:2013].

The profile control diameter is the active root diameter d_Nf of a gear with a mating gear, else the root form diameter
d_Ff. Sun and planet of a planetary set are taken from their mesh, the ring from its mesh with the planet.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.design.core import Design
from gearmesh.metrology.measured_teeth import InspectionBasis, InvoluteFlank
from gearmesh.metrology.pitch import BallInSpace
from gearmesh.systems.cylindrical.double_helical import first_halves, half_of
from gearmesh.systems.cylindrical.geometry.accuracy import tolerance_sizes
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES
from gearmesh.systems.cylindrical.geometry.proportions import GearsProportions, proportions
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME
from gearmesh.systems.cylindrical.sheet import SheetGears, SheetPair
from gearmesh.systems.cylindrical.single.build import proportions as single_proportions
from gearmesh.systems.system import complete_design
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign
    from gearmesh.systems.cylindrical.single.design import SingleGearDesign
    from gearmesh.teeth.gear_train import GearTrain


def pair_inspection(design: CylindricalDesign, train: GearTrain, name: str) -> InspectionBasis:
    """Return the inspection basis of the "pinion" or the "gear" of a design and the gear set built from it."""
    half = half_of(complete_design(design).in_mm())
    gears = SheetPair(half, proportions(half), tuple(train.members[own] for own in MEMBER_NAMES))
    return inspection_of(gears, MEMBER_NAMES.index(name))


def single_inspection(design: SingleGearDesign, train: GearTrain, name: str) -> InspectionBasis:
    """Return the inspection basis of a gear without a mating gear."""
    own = complete_design(design).in_mm()
    gears = SheetGears(first_halves(own), GearsProportions((single_proportions(own),)), (train.members[name],))
    return inspection_of(gears, 0)


def inspection_of(gears: SheetGears, number: int) -> InspectionBasis:
    """Return the inspection basis of a gear by its `number` in a sheet."""
    own, width = gears.teeth[number], gears.specs[number].face_width
    angles = [(side.alpha_t, side.sense * (math.pi / side.teeth - side.half_angle(side.radius))) for side in own.sides]
    # by right and left flanks
    order = slice(None, None, 1 if own.drive is Side.RIGHT else -1)
    involutes = [_involute(gears, number, side) for side in range(len(own.sides))][order]
    right, *left = angles[order]
    return InspectionBasis(
        sizes=tolerance_sizes(own, width),
        asked=gears.design.accuracy_class,
        involute=involutes[0],
        left_involute=involutes[1] if own.asymmetric else None,
        ball=BallInSpace(*right, left=left[0] if left else None),
    )


def _involute(gears: SheetGears, number: int, side: int) -> InvoluteFlank:
    """Return the involute flank of a side, by its number, of a gear."""
    own, width = gears.teeth[number].sides[side], gears.specs[number].face_width
    root_form, tip_form = gears.side_flanks[number][side]
    mesh = gears.meshing
    begins = root_form if mesh is None else math.hypot(own.base_radius, mesh.lines[side].active(number)[0])
    return InvoluteFlank(
        base=own.base_radius,
        control=begins,
        form=tip_form,
        tip=gears.geometry.tips[number],
        helix=own.beta,
        base_helix=own.beta_b,
        toe=-0.5 * width,
        heel=0.5 * width,
        module=own.module,
    )


def planetary_inspection(design: PlanetaryDesign, train: GearTrain, name: str) -> InspectionBasis:
    """Return the inspection basis of a member of a planetary design and the gear set built from it."""
    own = complete_design(design).in_mm()
    both, key = meshes(own), Design.table_named(name)
    mesh, names = (both.outer, (PLANET_NAME, RING_NAME)) if key == RING_NAME else (both.inner, (SUN_NAME, PLANET_NAME))
    half = half_of(mesh)
    members = tuple(train.members[f"{PLANET_NAME}_1" if called == PLANET_NAME else called] for called in names)
    basis = inspection_of(SheetPair(half, proportions(half), members), names.index(key))
    return replace(basis, asked=own.accuracy_class)
