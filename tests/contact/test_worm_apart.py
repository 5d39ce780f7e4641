"""Worm drives whose members do not reach each other: answered in a line, never by a contact that is not there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.built import built
from oracles.worm_drives import BASE

import gearmesh as gm
from gearmesh.check.members import roll_members


def drive(**assembly: float) -> gm.Gears:
    keys: dict[str, Any] = {**BASE, "hob": {"reference_diameter": 66}, "contact": {"phi1": {"count": 3}}}
    return built({**keys, "assembly": assembly})


@pytest.mark.parametrize(
    "assembly",
    [{"da": 15.0}, {"dz2": 60.0}, {"dz1": -200.0}, {"da": 14.0, "d_sigma": 4.0}],
    ids=["centre distance", "wheel", "worm", "both"],
)
@pytest.mark.sweep_cases("centre distance", "wheel", "worm")
def test_members_that_do_not_reach_each_other(assembly: dict[str, float]) -> None:
    """The whole members do not meet when they roll, either, over a turn of the wheel."""
    gears = drive(**assembly)
    contact = gears.contact()
    assert (contact.path.kind == "none").all()
    assert np.isnan(contact.path.phi2).all()
    assert contact.summary["converged"] == 0
    (warning,) = contact.warnings
    assert warning.startswith("the driving or the coast flanks touch nowhere: the teeth may be apart")
    (rolled,) = roll_members(gears.pairs[0], 0.0, 20, coast=False)
    assert rolled.drive is None


@pytest.mark.sweep
def test_tips_that_just_reach_flanks_are_told_from_those_that_do_not() -> None:
    """The worm's tip and the wheel's outside meet until the centre distance is as long as both radii: edge contact is left."""
    gears = drive(da=8.0)
    contact = gears.contact()
    assert (contact.path.kind == "edge").all()
    assert any("edge contact alone" in warning for warning in contact.warnings)
    assert np.isnan(contact.path.semi_major).all()
