"""Mountings of worm drives that bring the contact to a side of the wheel's face: the displaced drive's own path is there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import WormDriveDesign
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.systems.worm_drive.build import build, displaced_bases

DRIVE: dict[str, Any] = {
    "kind": "worm_drive",
    "module": 4,
    "worm": {"threads": 2},
    "wheel": {"teeth": 40},
    "hob": {"reference_diameter": 44},
}
KEYS = {"V": "da", "J": "dz2", "alpha": "d_sigma"}


def crossing(design: gm.Design) -> float:
    """Share of the wheel's face at which the path crosses the middle of the working depth, by first touch."""
    gears = gm.build(design)
    pair = gears.train.pairs[0]
    path = contact_path(solver_pair(pair), pair.pitch * np.linspace(-1.6, 1.6, 641))
    k = path.kind == "point"
    tooth = pair.gear.one_tooth
    r = tooth.side(pair.flanks[1]).flank.jet(path.params2[k, 0], path.params2[k, 1]).r
    root, tip = tooth.blank.root.value(r), tooth.blank.tip.value(r)
    # 0.2 modules of clearance under the worm's tip
    depth = 0.5 * (root + tip) - 0.5 * 0.2 * 4.0
    toe, heel = tooth.blank.extent
    share = (r[:, 2] - toe) / (heel - toe)
    change = np.flatnonzero(np.diff(np.sign(depth)))
    (at,) = change
    return float(share[at] - depth[at] * (share[at + 1] - share[at]) / (depth[at + 1] - depth[at]))


@pytest.mark.sweep
@pytest.mark.sweep_cases("J-left hand", "V-left hand", "V-right hand", "alpha-left hand", "alpha-right hand")
@pytest.mark.parametrize("right_hand", [True, False], ids=["right hand", "left hand"])
@pytest.mark.parametrize("moved", ["J", "alpha", "V"])
def test_contact_is_where_it_was_asked_for(moved: str, right_hand: bool) -> None:
    design = gm.parse({**DRIVE, "worm": {"threads": 2, "right_hand": right_hand}, "assembly": {"dz2": 0.05}})
    check = gm.build(design).vh((moved,))
    assert [shift.place for shift in check.shifts] == 2 * ["entering side", "middle", "leaving side"]
    for shift in check.shifts:
        errors = {"da": shift.v, "dz2": shift.j, "d_sigma": shift.alpha}
        others = {key: value for key, value in errors.items() if key != KEYS[moved]}
        assert others == {key: 0.05 if key == "dz2" else 0.0 for key in others}
        displaced = {f"assembly.{key}": value for key, value in errors.items()}
        own = design.with_values({**displaced, "contact.flank": shift.side.removeprefix("worm_")})
        assert crossing(own) == pytest.approx(shift.share, abs=2e-4)
    if moved == "J":
        assert all(shift.reached for shift in check.shifts)


@pytest.mark.parametrize("right_hand", [True, False], ids=["right hand", "left hand"])
@pytest.mark.sweep_cases("left hand")
def test_members_of_studies_stand_where_the_design_has_them(right_hand: bool) -> None:
    """Many assemblies at once are those of designs with the same errors; d_sigma went the other way."""
    keys = {**DRIVE, "worm": {"threads": 2, "right_hand": right_hand}, "shaft_angle": 87.0}
    design = gm.build(gm.parse(keys)).design
    assert isinstance(design, WormDriveDesign)
    errors = {"da": 0.1, "dz1": 0.2, "dz2": -0.3, "d_sigma": 0.5}
    batch = displaced_bases(design, build(design), {key: np.array([value]) for key, value in errors.items()})
    own = build(design.with_values({f"assembly.{key}": value for key, value in errors.items()})).pairs[0]
    for many, mount in zip(batch, own.mounts, strict=True):
        np.testing.assert_allclose(many.rotation[0], mount.base.rotation, rtol=0, atol=1e-14)
        np.testing.assert_allclose(many.translation[0], mount.base.translation, rtol=0, atol=1e-13)


def test_flanks_and_hands_are_mirror_images() -> None:
    """The plane across the worm leaves the wheel's axis: the other hand has the same positions. The plane along it turns the axis
    round: the other flank has them with the other sign."""
    hands = [gm.build(gm.parse({**DRIVE, "worm": {"threads": 2, "right_hand": hand}})).vh() for hand in (True, False)]
    right, left = (np.array([shift.j for shift in check.shifts]).reshape(2, 3) for check in hands)
    np.testing.assert_allclose(right[0], -right[1], rtol=0, atol=1e-8)
    np.testing.assert_allclose(left, right, rtol=0, atol=1e-8)
    assert (np.abs(right[:, [0, 2]]) > 0.1).all()


def test_what_has_no_pattern_to_place() -> None:
    alike = {key: value for key, value in DRIVE.items() if key != "hob"}
    with pytest.raises(gm.DesignError, match=r"mm \(the default, the worm's\): .* along lines over all of its face"):
        gm.build(gm.parse(alike)).vh()
    with pytest.raises(gm.DesignError, match="one of V, J, alpha"):
        gm.build(gm.parse(DRIVE)).vh(("V", "J"))
