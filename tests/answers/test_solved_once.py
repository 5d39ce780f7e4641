"""What one answer has solved the others are handed."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.answers.contact import sides
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.fit.fit import reversed_pair
from gearmesh.contact.flanks import solver_pair

pytestmark = pytest.mark.quick


def test_both_sides_of_a_contact_are_followed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Driving flanks for the path, coast flanks, of which bevel gears have no image, for the backlash; plots are handed both."""
    contact = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml")).contact()
    other = reversed_pair(contact.pair)
    alone = whole_engagement(solver_pair(other), other.pitch)
    monkeypatch.setattr(sides, "whole_engagement", lambda *given: pytest.fail("a side is followed again"))
    assert [each.driving for each in contact.sides] == [True, False]
    assert contact.fit is not None
    assert contact.fit.coast is not None
    assert alone is not None
    assert np.array_equal(contact.fit.coast.contacts.x, alone.contacts.x, equal_nan=True)


@pytest.mark.sweep
def test_rows_of_loaded_contact_are_made_once() -> None:
    found = gm.build(gm.load(SAMPLES / "spur.toml")).loaded_contact(100.0, [0.0])
    assert found.rows is found.figures.positions
    assert found.totals is found.figures.totals
    assert found.tooth_pair is found.figures.tooth_pair
