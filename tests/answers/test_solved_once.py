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


def test_path_and_pattern_are_solved_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pattern needs the path from first to last contact: it has what that path has alone."""
    contact = gm.build(gm.load(SAMPLES / "spur.toml")).contact()
    assert contact.engagement is not None
    assert contact.cycle is not None
    alone = sides.whole_path(contact.pair, contact.engagement, contact.cycle.engagement)
    monkeypatch.setattr(sides, "contact_path", lambda *given, **more: pytest.fail("a path is solved again"))
    whole = contact.whole
    assert whole is not None
    np.testing.assert_allclose(whole.phi2, alone.phi2, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(whole.point1, alone.point1, rtol=0.0, atol=1e-9)
    assert len(contact.patterns) == 4


@pytest.mark.sweep
def test_rows_of_loaded_contact_are_made_once() -> None:
    found = gm.build(gm.load(SAMPLES / "spur.toml")).loaded_contact(100.0, [0.0])
    assert found.rows is found.figures.positions
    assert found.totals is found.figures.totals
    assert found.tooth_pair is found.figures.tooth_pair
