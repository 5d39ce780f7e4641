"""Designs built, as most tests ask for them."""

from __future__ import annotations

import gearmesh as gm
from gearmesh.api.contact import Contact
from gearmesh.design.core import Design
from gearmesh.teeth.train import GearPair


def pair_of(design: Design) -> GearPair:
    """The only pair of a design."""
    (pair,) = gm.build(design).pairs
    return pair


def contact_of(design: Design, torque: float | None = None) -> Contact:
    """Its contact."""
    return gm.build(design).contact(torque=torque)
