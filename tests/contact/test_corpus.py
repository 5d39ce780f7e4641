"""Random designs whose contact was once wrong: another place touched first, or none was found where the flanks meet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.built import pair_of

from gearmesh.check.members import roll_flanks
from gearmesh.contact import ARCSEC, contact_path, solver_pair
from gearmesh.systems.designs import load

CORPUS = sorted((Path(__file__).parents[1] / "corpus").glob("contact_*.toml"))


@pytest.mark.parametrize("file", CORPUS, ids=lambda file: file.stem)
def test_the_flanks_touch_where_they_roll(file: Path) -> None:
    pair = pair_of(load(file))
    phi1 = np.array([-0.45, -0.1, 0.3, 0.5]) * pair.pitch
    found = contact_path(solver_pair(pair).parts[0], phi1)
    rolled = roll_flanks(pair, phi1, 60, found.phi2)
    assert found.touching.tolist() == [each is not None for each in rolled]
    apart = [abs(each.phi2 - phi2) for each, phi2 in zip(rolled, found.phi2, strict=True) if each is not None]
    assert len(apart) >= 3
    assert max(apart) < 0.05 * ARCSEC


def test_flanks_that_overlap_by_less_than_a_cell_of_the_grid_touch() -> None:
    """Long before its turn a corner of the gear's flank comes to the pinion's: nothing else of the two overlaps."""
    pair = pair_of(load(CORPUS[0].with_name("contact_beveloid_sensible_0.toml")))
    phi1 = np.array([-31.0, -30.0, -29.0]) / 24.0 * pair.pitch
    found = contact_path(solver_pair(pair).parts[0], phi1)
    rolled = roll_flanks(pair, phi1, 48, found.phi2)
    assert found.edge.tolist() == ["gear_tip+gear_toe"] * 3
    assert max(abs(each.phi2 - phi2) for each, phi2 in zip(rolled, found.phi2, strict=True) if each) < 0.05 * ARCSEC
    assert all(rolled)
