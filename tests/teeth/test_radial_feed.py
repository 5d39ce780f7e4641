"""Crowning by a radial feed: against pinions that a worm or a disk grinds with a plunge, as exact envelopes."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from oracles.built import built

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.kinds import Jet, Side
from gearmesh.teeth.micro_geometry.modification import Extent, FlankField, Modification
from gearmesh.teeth.micro_geometry.radial_feed import DiskSetting, disk_crowning, twist_of, worm_crowning
from gearmesh.teeth.micro_geometry.screw_involute import AmountJet, ScrewInvolute

MODULE, TEETH, HELIX, FACE, PLUNGE = 3.0, 25, 20.0, 40.0, 5e-5
#: pitch radius of the tool, mm
TOOL_RADIUS = 60.0
GROUND: dict[str, Any] = {
    "kind": "modified_involute",
    "module": MODULE,
    "pressure_angle": 20,
    "helix_angle": HELIX,
    "rack_parameter": 1.0,
    "worm": {"pitch_radius": TOOL_RADIUS},
    "disk": {"pitch_radius": TOOL_RADIUS},
    "gear": {"teeth": 50, "face_width": FACE},
}
ORDERED: dict[str, Any] = {
    "kind": "cylindrical",
    "module": MODULE,
    "helix_angle": HELIX,
    "pinion": {"teeth": TEETH, "face_width": FACE},
    "gear": {"teeth": 50, "face_width": FACE},
}


def ground(crowning: str) -> gm.Gears:
    """Pinion with straight profiles, ground with a plunge of PLUNGE s^2; the disk's vertex is that of the right flank."""
    pinion = {"teeth": TEETH, "face_width": FACE, "parabola": 0.0, "crowning": crowning, "plunge_coefficient": PLUNGE}
    return built(GROUND | {"pinion": pinion})


def ordered(**modifications: object) -> gm.Gears:
    return built(ORDERED | {"pinion": {**ORDERED["pinion"], "modifications": modifications}})


def involute_of(gears: gm.Gears, side: Side) -> tuple[ScrewInvolute, Extent]:
    """True involute of the pinion's flank, and the range of its ordered gear."""
    flank = gears.member("pinion").tooth.side(side).flank
    assert isinstance(flank, ScrewInvolute)
    assert isinstance(flank.amount, Modification)
    return flank, flank.amount.extent


def sheet_of(gears: gm.Gears) -> dict[str, Any]:
    """Values of the pinion in the data sheet, by symbol."""
    tables = [table for table in gears.sheet().tables if table.title == "Members"]
    return {symbol: row[2] for table in tables for symbol, row in zip(table.symbols, table.rows, strict=True)}


def removed(gears: gm.Gears, side: Side) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Roll lengths, face positions and amounts (7, 9), mm in the transverse plane, that the plunge removes."""
    plain = ground("none").member("pinion").tooth.flank_grid(side, [1.0], [0.5]).jet
    jet = gears.member("pinion").tooth.flank_grid(side, np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 9)).jet
    assert plain is not None
    assert jet is not None
    true = ScrewInvolute.through(Jet(*(getattr(plain, each.name)[0] for each in fields(Jet))), side.sign)
    length, z = np.sqrt(jet.r[..., 0] ** 2 + jet.r[..., 1] ** 2 - true.base_radius**2), jet.r[..., 2]
    nominal = true.jet(length, z)
    along = np.sum((nominal.r - jet.r) * nominal.n, axis=-1)
    # from the normal into the transverse plane
    return length, z, along / np.hypot(nominal.n[..., 0], nominal.n[..., 1])


@pytest.mark.parametrize(
    ("tool", "crowning", "side"),
    # the vertex of the disk is that of the right flank
    [("worm", "worm_plunge", Side.RIGHT), ("worm", "worm_plunge", Side.LEFT), ("disk", "disk", Side.RIGHT)],
)
@pytest.mark.sweep_cases("worm-worm_plunge-right", "worm-worm_plunge-left")
def test_crowning_is_that_of_the_ground_flank(tool: str, crowning: str, side: Side) -> None:
    length, z, amounts = removed(ground(crowning), side)
    disk = {"crowning_disk_diameter": 2.0 * TOOL_RADIUS} if tool == "disk" else {}
    # an order whose sheet asks for the feed of the ground pinion
    trial = sheet_of(ordered(helix_crowning=0.01, crowning_tool=tool, **disk))["f_r"]
    crown = 0.01 * PLUNGE * (0.5 * FACE) ** 2 / trial
    true, extent = involute_of(ordered(helix_crowning=crown, crowning_tool=tool, **disk), side)
    assert true.amount is not None
    field = true.amount.jet(length, z).a
    # what is left is the finite radius of the tool; without the twist a quarter of the amount is wrong
    assert np.abs(field - amounts).max() < 0.015 * amounts.max()
    plain = crown * (2.0 * z / (extent.heel - extent.toe)) ** 2
    assert np.abs(plain - amounts).max() > 0.2 * amounts.max()


def disk_field(amount: float = 0.4) -> tuple[FlankField, Extent]:
    true, extent = involute_of(ordered(helix_crowning=0.01, crowning_tool="worm"), Side.RIGHT)
    radius = 0.5 * MODULE * TEETH / np.cos(np.radians(HELIX))
    setting = DiskSetting(TEETH, radius, TOOL_RADIUS)
    return disk_crowning(amount, extent, involute=true, setting=setting, key="diameter"), extent


def test_partials_of_disk_crowning() -> None:
    field, extent = disk_field()
    length, z = (
        each.ravel() for each in np.meshgrid(np.linspace(extent.root, extent.tip, 5), [-19.0, -3.0, 0.2, 18.0])
    )
    jet, step = field.jet(length, z), 1e-3

    def partial(name: str, dl: float, dz: float) -> np.ndarray:
        ahead, behind = (getattr(field.jet(length + k * dl, z + k * dz), name) for k in (step, -step))
        return np.asarray((ahead - behind) / (2.0 * step))

    expected = AmountJet(
        jet.a, partial("a", 1, 0), partial("a", 0, 1), partial("a_l", 1, 0), partial("a_l", 0, 1), partial("a_z", 0, 1)
    )
    for each in fields(AmountJet):
        np.testing.assert_allclose(getattr(jet, each.name), getattr(expected, each.name), atol=1e-7, err_msg=each.name)


def test_twist_of_worm_crowning_is_that_of_the_closed_form() -> None:
    crown = 0.008
    gears = ordered(helix_crowning=crown, crowning_tool="worm")
    rows = sheet_of(gears)
    _, extent = involute_of(gears, Side.RIGHT)
    lean = float(np.tan(np.arcsin(np.sin(np.radians(HELIX)) * np.cos(np.radians(20.0)))))
    twist = 8.0 * crown * lean * abs(extent.tip - extent.root) / FACE
    assert abs(rows["S_right"]) == pytest.approx(twist, rel=1e-6)
    assert rows["S_left"] == pytest.approx(-rows["S_right"], rel=1e-6)
    # the radial feed moves the flank by its sine of the pressure angle
    alpha_t = np.arctan(np.tan(np.radians(20.0)) / np.cos(np.radians(HELIX)))
    assert rows["f_r"] == pytest.approx(crown / np.sin(alpha_t), rel=1e-6)
    # the opposite profile twist compensates it
    straight = ordered(helix_crowning=crown, crowning_tool="worm", profile_twist=-rows["S_right"])
    amount = straight.member("pinion").tooth.side(Side.RIGHT).flank.amount
    assert abs(twist_of(amount, amount.extent)) < 1e-9


def test_spur_flanks_are_not_twisted() -> None:
    extent, spur = Extent(4.0, 12.0, -10.0, 10.0), ScrewInvolute(37.0, 0.0, 0.0)
    assert twist_of(worm_crowning(0.01, extent, involute=spur, reference_radius=40.0), extent) == 0.0


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"pinion.modifications.crowning_tool": "disk"}, "pinion.modifications.crowning_disk_diameter"),
        ({"pinion.modifications.crowning_disk_diameter": 100.0}, "pinion.modifications.crowning_disk_diameter"),
        ({"gear.modifications": {"helix_crowning": 0.01, "crowning_tool": "worm"}}, "gear.modifications.crowning_tool"),
    ],
)
def test_impossible_tools_are_refused(change: dict[str, Any], key: str) -> None:
    design: dict[str, Any] = {
        "kind": "cylindrical",
        "module": 2,
        "helix_angle": 15,
        "pinion": {"teeth": 20, "face_width": 20, "modifications": {"helix_crowning": 0.01}},
        "gear": {"teeth": -60, "face_width": 20},
    }
    for name, value in change.items():
        table = design
        *path, last = name.split(".")
        for each in path:
            table = table[each]
        table[last] = value
    with pytest.raises(DesignError) as refused:
        built(design)
    assert refused.value.key == key
