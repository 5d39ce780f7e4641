"""Designs built, as most tests ask for them."""

from __future__ import annotations

from collections.abc import Sequence

import gearmesh as gm
from gearmesh.answers.bodies.finite_elements import FiniteElements
from gearmesh.answers.contact.contact import Contact
from gearmesh.design.core import Design
from gearmesh.teeth.gear_train import GearPair


def pair_of(design: Design) -> GearPair:
    """The only pair of a design."""
    (pair,) = gm.build(design).pairs
    return pair


def contact_of(design: Design, torque: float | None = None) -> Contact:
    """Its contact."""
    return gm.build(design).contact(torque=torque)


def model_of(design: Design, phi1: float = 0.0, members: Sequence[str] | None = None) -> FiniteElements:
    """Its finite-element model at phi1, deg."""
    return gm.build(design).finite_elements(phi1, members=members)
