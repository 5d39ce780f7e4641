"""Unloaded contact of worm drives in the mirror: hands, flanks and senses differ by signs alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.worm_drives import BASE, DRIVES

from gearmesh import parse
from gearmesh.contact.flanks import analyse
from gearmesh.contact.path import ContactPath

PHI1 = np.radians([-100.0, -35.0, 0.0, 20.0, 85.0])
ERRORS = {"da": 0.03, "dz1": 0.1, "dz2": 0.2, "d_sigma": 0.05}
#: about what the drives are in mm
SIZE = 125.0
#: hand, flank and signs of y and z in the planes across the worm and along it, and in both
MIRRORS = {
    "other hand": (False, "right", np.array([1.0, 1.0, -1.0])),
    "other hand, flank and sense": (False, "left", np.array([1.0, -1.0, 1.0])),
    "other flank and sense": (True, "left", np.array([1.0, -1.0, -1.0])),
}


def path_of(name: str, hand: bool, flank: str, signs: Any, shaft_angle: float, errors: bool) -> ContactPath:
    """Contact of a drive in the mirror, in which the worm turns and members are displaced as the signs say."""
    displaced = ERRORS | {"dz1": signs[2] * ERRORS["dz1"], "dz2": signs[1] * ERRORS["dz2"]}
    keys: dict[str, Any] = dict(BASE)
    for changes in (DRIVES[name], {"worm": {"right_hand": hand}}):
        for table, values in changes.items():
            keys[table] = {**keys.get(table, {}), **values}
    own = {"shaft_angle": shaft_angle, "contact": {"flank": flank}, "assembly": displaced if errors else {}}
    return analyse(pair_of(parse(keys | own)), signs[1] * PHI1)


@pytest.mark.sweep_cases(
    "ZA oversize-90.0-True", "ZC-90.0-True", "ZI-90.0-False", "ZI-90.0-True", "ZK-80.0-True", "ZK oversize-100.0-True"
)
@pytest.mark.parametrize(
    ("name", "shaft_angle", "errors"),
    [
        ("ZI", 90.0, False),
        ("ZI", 90.0, True),
        ("ZK", 80.0, True),
        ("ZC", 90.0, True),
        ("ZA oversize", 90.0, True),
        ("ZK oversize", 100.0, True),
        ("ZN oversize", 80.0, True),
    ],
)
def test_contact_in_the_mirror(name: str, shaft_angle: float, errors: bool) -> None:
    """Lines, points and edges, which is all that errors leave of the line contact behind a hob of the worm's size."""
    own = path_of(name, True, "right", np.ones(3), shaft_angle, errors)
    assert own.touching.all()
    for hand, flank, signs in MIRRORS.values():
        other = path_of(name, hand, flank, signs, shaft_angle, errors)
        assert other.kind.tolist() == own.kind.tolist()
        np.testing.assert_allclose(signs[1] * other.phi2, own.phi2, rtol=0, atol=1e-12)
        np.testing.assert_allclose(signs[1] * other.te, own.te, rtol=0, atol=1e-12)
        for k, (image, line) in enumerate(zip(other.lines, own.lines, strict=True)):
            if line is None:
                np.testing.assert_allclose(signs * other.point[k], own.point[k], rtol=0, atol=1e-12 * SIZE)
                np.testing.assert_allclose(signs * other.normal[k], own.normal[k], rtol=0, atol=1e-12)
                continue
            # where a line ends is exact, what is between is spaced as the solver came along it; either end may be the first
            assert image is not None
            ends = signs * image[[0, -1]]
            apart = [np.abs(ends[::way] - line[[0, -1]]).max() for way in (1, -1)]
            assert min(apart) < 1e-12 * SIZE
        for key in ("semi_major", "semi_minor"):
            np.testing.assert_allclose(getattr(other, key), getattr(own, key), rtol=0, atol=1e-12 * SIZE)
