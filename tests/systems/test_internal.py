"""An internal gear on the core as it is: teeth that point to the axis, a body around them, stations that count downwards."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.internal import ALPHA, MODULE, OUTSIDE, PINION, RING, WIDTH, internal_gears

from gearmesh.mesh.hexahedra.hex_quality import scaled_jacobian


def test_solid_is_proved_and_has_the_exact_volume() -> None:
    gears = internal_gears()
    tooth = gears.members["ring"].tooth
    exact = tooth.volume()
    root, tip = 62.5, 58.4
    disk = np.pi * WIDTH * (0.25 * OUTSIDE**2 - root**2)
    assert disk < exact < np.pi * WIDTH * (0.25 * OUTSIDE**2 - tip**2)
    off = []
    for tolerance in (0.02, 0.005):
        solid = gears.solid("ring", tolerance)
        assert solid.figures["watertight"]
        assert solid.figures["max_deviation_um"] <= 1e3 * tolerance
        off.append(abs(solid.figures["volume_mm3"] / exact - 1.0))
    assert off[1] < 0.5 * off[0]
    regions = {str(solid.mesh.region_names[k]) for k in np.unique(solid.mesh.regions)}
    assert "rim" in regions
    assert "bore" not in regions
    rim = solid.mesh.only("rim").vertices
    assert np.hypot(rim[:, 0], rim[:, 1]) == pytest.approx(0.5 * OUTSIDE, rel=1e-12)


@pytest.mark.sweep
def test_contact_ratio_by_the_closed_form_and_rolled_flanks_agree() -> None:
    gears = internal_gears()
    contact = gears.contact(np.linspace(-3.0, 3.0, 5))
    assert (contact.path.kind == "line").all()
    assert np.ptp(contact.path.te) < 1e-12
    alpha = np.radians(ALPHA)
    base = np.array([0.5 * PINION, 0.5 * RING]) * MODULE * np.cos(alpha)
    tips = np.array([0.5 * PINION + 0.8, 0.5 * RING - 0.8]) * MODULE
    reach = np.sqrt(tips**2 - base**2)
    length = reach[0] - reach[1] + 0.5 * MODULE * (RING - PINION) * np.sin(alpha)
    assert contact.cycle is not None
    assert contact.cycle.contact_ratio == pytest.approx(length / (np.pi * MODULE * np.cos(alpha)), abs=1e-3)
    for row in gears.roll(contact).rows:
        assert abs(row.te_difference) < 0.5


@pytest.mark.sweep
def test_rim_of_finite_elements_lies_outside_the_teeth() -> None:
    model = internal_gears().finite_elements()
    mesh = model.mesh
    assert scaled_jacobian(mesh.nodes, mesh.elements).min() > 0.4
    gears = internal_gears()
    ring = gears.finite_elements(members=["ring"])
    found = {name: ring.mesh.nodes[ring.mesh.node_sets[f"ring_{name}"]] for name in ("rim", "land", "root")}
    # the model's frame is the pinion's; the ring's axis stands beside it
    apart = np.array([-0.5 * MODULE * (RING - PINION), 0.0])
    rho = {name: np.hypot(*(points[:, :2] - apart).T) for name, points in found.items()}
    assert rho["rim"].min() > rho["root"].max() > rho["land"].max()
    assert rho["rim"].max() <= 0.5 * OUTSIDE + 1e-9


def test_limits_say_that_nothing_is_undercut() -> None:
    limits = internal_gears().limits()
    assert limits.headline == "undercut: none"
    assert not limits.limits["ring"].right.undercut.any()
    # an involute ring tooth does not come to a point before its base circle
    assert np.isnan(limits.limits["ring"].land_radius).all()
