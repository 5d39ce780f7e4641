"""Openings of bodies: through hubs on one side, refused by the key that is set; the volume of the sheet has them."""

from __future__ import annotations

from typing import Any

import pytest
from oracles.built import built

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.teeth.blank.moments import member_moments

GEAR = {"teeth": 60, "face_width": 20, "bore": 30, "hub": {"diameter": 80, "length": 6}}


def gear(**keys: Any) -> gm.Gears:
    return built({"kind": "cylindrical", "module": 2, "gear": {**GEAR, **keys}})


@pytest.mark.parametrize(
    ("keys", "area"),
    [
        ({"bolts": {"count": 4, "diameter": 8, "circle": 56}}, 4 * 50.26548),
        ({"spokes": {"count": 4, "width": 8, "inner_diameter": 44, "outer_diameter": 68, "corner_radius": 1}}, None),
    ],
)
@pytest.mark.sweep_cases("keys0-201.06192")
def test_openings_go_through_a_hub_on_one_side(keys: dict[str, Any], area: float | None) -> None:
    gears = gear(**keys)
    member, full = gears.members["gear"], gear().members["gear"]
    openings = member.openings
    assert {(opening.low, opening.high) for opening in openings} == {(-10.0, 16.0)}
    removed = full_volume = member_moments(full).volume - member_moments(member).volume
    if area is not None:
        assert removed == pytest.approx(26.0 * area, rel=1e-6)
    mesh = gears.solid("gear", 0.02).mesh
    assert mesh.volume() == pytest.approx(member_moments(full).volume - full_volume, rel=1e-3)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"bolts": {"count": 4, "diameter": 8, "circle": 5}}, "gear.bolts.circle = 5 mm: allowed is at least 38."),
        (
            {"bolts": {"count": 4, "diameter": 8, "circle": 78}},
            r"gear.bolts.circle = 78 mm: openings from 70 .* allowed is openings from 30.18 to 79.82 mm or 80.18 to 110.499 ",
        ),
        (
            {"spokes": {"count": 4, "width": 8, "inner_diameter": 26, "outer_diameter": 68}},
            "gear.spokes.inner_diameter = 26 mm: allowed is at least 30.18 and less than 68 mm",
        ),
    ],
)
@pytest.mark.sweep_cases("keys0-gear.bolts.circle = 5 mm: allowed is at least 38.")
def test_refused_openings_name_the_key_that_is_set(keys: dict[str, Any], text: str) -> None:
    with pytest.raises(DesignError, match=text):
        gear(**keys)


def test_every_table_of_the_sheet_has_the_same_volume() -> None:
    """With hub, keyway and holes."""
    tables = gear(keyway={}, holes={"count": 5}).sheet().plain_tables
    volume = tables["Members at mid face"]["volume"][-1]
    assert volume == pytest.approx(tables["Mass and inertia"]["V"][-1], rel=1e-12)
    assert volume > tables["Members at mid face"]["teeth"][-1]
