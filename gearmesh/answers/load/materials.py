"""Materials of the members of a pair: those that the design names for each member, else the common material."""

from __future__ import annotations

from gearmesh.contact.hertz import Material
from gearmesh.design.core import Design
from gearmesh.teeth.gear_train import GearPair


def materials_of(design: Design, pair: GearPair) -> tuple[Material, Material]:
    """Return the materials of pinion and gear of a pair."""
    first, second = (Material(*design.elastic(member.name)) for member in pair.both)
    return first, second
