"""What the members of a pair are made of: the design's own words for each, else those for all."""

from __future__ import annotations

from gearmesh.contact.hertz import Material
from gearmesh.design.core import Design
from gearmesh.teeth.gear_train import GearPair


def materials_of(design: Design, pair: GearPair) -> tuple[Material, Material]:
    """Materials of pinion and gear of a pair."""
    first, second = (Material(*design.elastic(member.name)) for member in pair.both)
    return first, second
