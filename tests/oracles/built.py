"""Designs built, as most tests ask for them; what several tests ask for is built once."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import gearmesh as gm
from gearmesh import Contact, Design, FiniteElements, GearPair
from oracles.places import SAMPLES


def pair_of(design: Design) -> GearPair:
    """The only pair of a design."""
    (pair,) = gm.build(design).pairs
    return pair


def contact_of(design: Design, torque: float | None = None, *, cycle: bool = True) -> Contact:
    """Its contact; without the mesh cycle, most of the work, only the path of one tooth pair."""
    return gm.build(design).contact(torque=torque, cycle=cycle)


def model_of(design: Design, phi1: float = 0.0, members: Sequence[str] | None = None) -> FiniteElements:
    """Its finite-element model at phi1, deg."""
    return gm.build(design).finite_elements(phi1, members=members)


def built(keys: dict[str, Any]) -> gm.Gears:
    """The gears of a design by its keys."""
    return _built(json.dumps(keys))


@lru_cache(maxsize=64)
def _built(text: str) -> gm.Gears:
    return gm.build(gm.parse(json.loads(text)))


@lru_cache(maxsize=64)
def built_sample(sample: str, *overrides: str) -> gm.Gears:
    """The gears of a sample with some keys overridden."""
    return gm.build(gm.load(SAMPLES / f"{sample}.toml", list(overrides)))
