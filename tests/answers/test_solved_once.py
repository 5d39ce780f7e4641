"""Solutions of one answer are handed to the others."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.answers.contact import sides
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.fit.fit import reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.view.scene import contact_on

pytestmark = pytest.mark.quick


@pytest.mark.sweep
def test_both_sides_of_a_contact_are_followed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Driving flanks for the path, coast flanks, of which bevel gears have no image, for the backlash; plots are handed both."""
    contact = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml")).contact()
    other = reversed_pair(contact.pair)
    alone = whole_engagement(solver_pair(other), other.pitch)
    monkeypatch.setattr(sides, "whole_engagement", lambda *given: pytest.fail("a side is followed again"))
    assert [each.driving for each in contact.sides] == [True, False]
    assert contact.fit is not None
    assert contact.fit.coast_curve is not None
    assert alone is not None
    assert np.array_equal(contact.fit.coast_curve.engagement.contacts.x, alone.contacts.x, equal_nan=True)


@pytest.mark.sweep_cases("face_gear")
@pytest.mark.parametrize("sample", ["spur", "face_gear"])
def test_coast_flanks_that_are_an_image_are_not_solved(sample: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Panels of the coast flank have the places of its own solution: a half turn (spur) and a mirror (face gear)."""
    contact = gm.build(gm.load(SAMPLES / f"{sample}.toml")).contact(phi1=[-1.0, 0.0, 2.0])
    (alone,) = (
        side for side in sides.side_contacts(contact.pair, contact.path, contact.engagement) if not side.driving
    )
    assert alone.exchange is None
    monkeypatch.setattr(sides, "whole_engagement", lambda *given: pytest.fail("the coast side is followed"))
    driving, image = contact.sides
    assert image.exchange is not None
    assert image.whole is driving.whole
    for member in range(2):
        found = contact_on(member, image.path, image.pair.mounts, image.whole).image(image.exchange)
        solved = contact_on(member, alone.path, alone.pair.mounts, alone.whole)
        for name in ("point", "normal", "semi_major", "edge"):
            value, wanted = getattr(found, name), getattr(solved, name)
            np.testing.assert_allclose(value, wanted[::-1], rtol=0.0, atol=1e-9)
        lengths = [
            [None if line is None else np.nanmax(np.ptp(line, axis=0)) for line in each.lines]
            for each in (found, solved)
        ]
        assert lengths[0] == pytest.approx(lengths[1][::-1], abs=1e-8)
    field = image.ease_off
    for name in ("points", "distance", "phi1", "beyond"):
        np.testing.assert_allclose(getattr(field, name), getattr(alone.ease_off, name), rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(image.sliding_velocity, alone.sliding_velocity, rtol=0.0, atol=1e-7)


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
