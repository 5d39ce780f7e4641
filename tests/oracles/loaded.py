"""Loaded contact of a sample on few elements: for tests of what is done with it."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

import gearmesh as gm
from gearmesh import GearPair, LoadedContact
from gearmesh.answers.contact.fit import fitted_cycle
from gearmesh.contact.hertz import STEEL
from gearmesh.loaded.compliance.compliance import FlankCompliance, flank_compliance
from gearmesh.loaded.sharing import loaded_mesh
from gearmesh.mesh.hexahedra.hexahedra import Cells
from oracles.built import pair_of
from oracles.places import SAMPLES

#: few elements on a tooth, and fewer for the error
SMALL, SMALLER = (
    Cells(flank=6, fillet=4, thickness=3, rim=4, face=8),
    Cells(flank=4, fillet=3, thickness=2, rim=3, face=6),
)


def few_elements(*asked: Any, **named: Any) -> FlankCompliance:
    """Stands in for `flank_compliance` where it is asked for with default elements."""
    return flank_compliance(*asked, **named | {"cells": SMALL, "coarser": SMALLER})


@lru_cache
def geared(sample: str, *keys: str) -> tuple[GearPair, tuple[FlankCompliance, FlankCompliance]]:
    pair = pair_of(gm.load(SAMPLES / f"{sample}.toml", list(keys)))
    first, second = (
        flank_compliance(member.tooth, side, STEEL, SMALL) for member, side in zip(pair.both, pair.flanks, strict=True)
    )
    return pair, (first, second)


@lru_cache
def loaded_contact(sample: str, torques: tuple[float, ...], positions: int, *keys: str) -> LoadedContact:
    """A sample under torques, Nm, at so many positions of a pitch."""
    design, (pair, bodies) = gm.load(SAMPLES / f"{sample}.toml", list(keys)), geared(sample, *keys)
    phi1 = pair.pitch * np.arange(positions) / positions
    mesh = loaded_mesh(pair, phi1, 1e3 * np.array(torques), bodies)
    return LoadedContact(design, pair, mesh, ("edge contact",), 0.0, fitted_cycle(pair)[1])
