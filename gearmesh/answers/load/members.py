"""Members of a pair under load: their materials, and how they are mounted on shafts and bearings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from gearmesh.contact.hertz import Material
from gearmesh.design.core import STEEL_DENSITY_KG_PER_M3, Design
from gearmesh.design.keys import RIGID_WORD
from gearmesh.loaded.mounts import FlexibleMount
from gearmesh.teeth.gear_train import GearPair

#: range of Young's modulus, MPa, of steel and cast iron, whose densities differ by less than a tenth
STEEL_MODULI_MPA = (150_000.0, 230_000.0)


def materials_of(design: Design, pair: GearPair) -> tuple[Material, Material]:
    """Return the materials of pinion and gear of a pair."""
    first, second = (material_of(design, member.name) for member in pair.both)
    return first, second


def material_of(design: Design, member: str) -> Material:
    """Return the material of a member, by its name."""
    return Material(*design.elastic(member), design.density(member))


def assumed_densities(design: Design, members: Iterable[str]) -> list[str]:
    """Return a note on members that have the density of steel, which the design does not give, but not its modulus."""
    assumed = [
        name
        for name in members
        if design.given_density(name) is None
        and not (STEEL_MODULI_MPA[0] <= design.elastic(name)[0] <= STEEL_MODULI_MPA[1])
    ]
    if not assumed:
        return []
    what = f"; give material.density, or {design.table_named(assumed[0])}.material.density, for natural frequencies and inertia"
    return [
        f"without material.density the density is {STEEL_DENSITY_KG_PER_M3:g} kg/m^3, as of steel ({', '.join(assumed)}){what}"
    ]


def mounts_of(design: Design, pair: GearPair) -> dict[str, FlexibleMount]:
    """Return the elastic mounts of members whose stiffness the design gives, by names of members.

    The stiffness applies at z of the design (mm), by default at the middle of the working flank.
    """
    mounts, in_mm = {}, design.in_mm()
    for member in pair.both:
        given = in_mm.mount(member.name)
        if given.stiffness is not None:
            stiffness = [np.inf if entry == RIGID_WORD else entry for entry in given.stiffness]
            mounts[member.name] = FlexibleMount.of(stiffness, pair.middle(member) if given.z is None else given.z)
    return mounts


def mounts_around(
    pair: GearPair, mounts: Mapping[str, FlexibleMount]
) -> tuple[FlexibleMount | None, FlexibleMount | None]:
    """Return the mounts of pinion and gear, from those by names of members; that of a member that several equal planets load
    is the one that each of their meshes has."""
    own = [mounts.get(member.name) for member in pair.both]
    pinion, gear = (
        mount if mount is None or member.idler else mount.around(pair.around)
        for member, mount in zip(pair.both, own, strict=True)
    )
    return pinion, gear


def held_by_rim(design: Design, pair: GearPair) -> tuple[bool, bool]:
    """Return True for pinion and gear if the body is held under the root, not at the bore."""
    first, second = (design.mount(member.name).held == "rim" for member in pair.both)
    return first, second
