"""The place of the nominal root stress: where the tangent of the fillet is at 30 deg, on internal teeth at 60 deg, to the tooth."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.loaded.root_tangent import tangent_weights
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.geometry.root import critical_section
from gearmesh.systems.cylindrical.sheet import SheetPair
from gearmesh.teeth.region import FILLET_REGIONS

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("sample", ["spur", "helical", "internal"])
@pytest.mark.sweep_cases("internal", "spur")
def test_it_is_where_iso_6336_has_it(sample: str) -> None:
    """Radius from the axis against the normal section through the middle of the tooth, at every station: 20 um, 1 deg."""
    design = gm.load(SAMPLES / f"{sample}.toml")
    pair = pair_of(design)
    sheet = SheetPair(design, proportions(design.in_mm()), pair.both)
    t, s = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 33)
    for member, teeth in zip(pair.both, sheet.teeth, strict=True):
        section = critical_section(member.tooth, teeth)
        wanted = np.hypot(section.radius, 0.5 * section.chord * np.cos(teeth.beta))
        for side in FILLET_REGIONS:
            fillet = member.tooth.grid(FILLET_REGIONS[side], s, member.tooth.sections(t)).points
            nodes = fillet.swapaxes(0, 1).reshape(-1, 3)
            weights = tangent_weights(member.tooth, side, t, nodes)
            np.testing.assert_allclose(weights.sum(axis=1), np.ones(5), rtol=1e-12)
            np.testing.assert_allclose(np.hypot(*(weights @ nodes)[:, :2].T), wanted, atol=0.02)
