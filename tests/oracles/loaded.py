"""Loaded contact of a sample on few elements: for tests of what is done with it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

import gearmesh as gm
from gearmesh.answers.contact.fit import fitted_cycle
from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.contact.hertz import STEEL
from gearmesh.loaded.compliance.compliance import flank_compliance
from gearmesh.loaded.sharing import loaded_mesh
from gearmesh.mesh.hexahedra.hexahedra import Cells
from oracles.places import SAMPLES

#: few elements on a tooth
SMALL = Cells(flank=6, fillet=4, thickness=3, rim=4, face=8)


@lru_cache
def loaded_contact(sample: str, torques: tuple[float, ...], positions: int, *keys: str) -> LoadedContact:
    """A sample under torques, Nm, at so many positions of a pitch."""
    design = gm.load(SAMPLES / f"{sample}.toml", list(keys))
    pair = gm.build(design).pairs[0]
    first, second = (
        flank_compliance(member.tooth, side, STEEL, SMALL) for member, side in zip(pair.both, pair.flanks, strict=True)
    )
    phi1 = pair.pitch * np.arange(positions) / positions
    mesh = loaded_mesh(pair, phi1, 1e3 * np.array(torques), (first, second))
    return LoadedContact(design, pair, mesh, ("edges carry",), 0.0, fitted_cycle(pair)[1])
