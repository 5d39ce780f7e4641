"""A maker's summary, entered as it stands, against its cutters swept by matrices that only know the sheet."""

from __future__ import annotations

from math import factorial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.swept_cutter import along_to_cone, power_series, shift, turn

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side, Tooth, along

ENTERED = Path(__file__).parents[1] / "designs" / "maker_summary_13_42.toml"
TEETH, BACKLASH = 13, 0.12
#: what the sheet prints of the two machines: mm, deg; motions by powers of the cradle's rotation in rad
SHEET: dict[str, dict[str, Any]] = {
    "concave": {
        "S": 67.70812, "q": 68.7145, "i": -2.5, "j": -40.0, "E_M": 15.05643, "X_B": -0.26816, "X_D": -4.75831,
        "gamma_m": 17.7733, "R_a": 3.2966217,
        "2C": 0.01635, "6D": -0.144878, "24E": -0.054853, "120F": 6.609728, "720G": -28.773005,
        "helical": [-0.00016, -0.04771, 0.37642, -0.55879, 0.5885, -0.3], "vertical": [],
        "blade": 15.793, "point": 69.5553,
    },
    "convex": {
        "S": 74.18883, "q": 74.6664, "i": 3.0, "j": -35.0, "E_M": 15.38435, "X_B": 4.57937, "X_D": 2.4658,
        "gamma_m": 17.7733, "R_a": 3.5444474,
        "2C": 0.007071, "6D": 0.090025, "24E": 0.0, "120F": 0.0, "720G": 0.0,
        "helical": [], "vertical": [0.00049, -0.02108, -0.18197, 0.23002, 0.05288, -0.1],
        "blade": 29.1564, "point": 78.884,
    },
}  # fmt: skip
#: +1 of blades whose cutting edge is the cutter's outer one
OUTER = {"concave": 1.0, "convex": -1.0}
#: of the concave side: where its straight toprem begins, mm, and its angle, deg
TOPREM = (0.9, 11.0)


def cutter_to_blank(sheet: dict[str, Any], q: Array) -> Array:
    """Transformation (..., 4, 4) from cutter to blank of a right-hand machine, at cradle rotations q (...,), rad. The blank's
    own z axis lies along its axis."""
    i, j, cradle, gamma = (np.radians(sheet[key]) for key in ("i", "j", "q", "gamma_m"))
    zero = 0.0 * q
    cutter = turn(2, cradle + q) @ shift(sheet["S"] + zero, zero, zero) @ turn(2, 0.5 * np.pi + j) @ turn(1, i)
    orders = zip(range(2, 7), ("2C", "6D", "24E", "120F", "720G"), strict=True)
    roll = sheet["R_a"] * (q - sum((sheet[key] / factorial(n) * q**n for n, key in orders), zero))
    moved = shift(
        zero, power_series(sheet["E_M"], sheet["vertical"], q), power_series(sheet["X_B"], sheet["helical"], q)
    )
    # X_D counts along the axis
    blank = moved @ turn(1, 0.5 * np.pi - gamma + zero) @ shift(zero, zero, sheet["X_D"] + zero) @ turn(2, roll)
    return np.asarray(np.linalg.inv(blank) @ cutter)


def nearest(
    sheet: dict[str, Any], cone: tuple[float, float], points: Array, normals: Array, around: float = 0.1
) -> Array:
    """The least distances (N,), mm, along the normals to the cone, prolonged, `around` (rad) the position where it is nearest."""

    def at(q: Array) -> Array:
        with np.errstate(invalid="ignore"):
            apart = along_to_cone(cutter_to_blank(sheet, q), cone, points, normals)
        return np.where(np.isnan(apart), np.inf, apart)

    coarse = np.linspace(-0.5, 0.5, 201)[:, None]
    middle = coarse[np.abs(at(coarse)).argmin(axis=0), 0]
    least = at(middle + np.linspace(-around, around, 81)[:, None]).min(axis=0)
    for reach in (0.01, 4e-4, 2e-5):
        q = middle + np.linspace(-reach, reach, 61)[:, None]
        apart = at(q)
        middle = q[apart.argmin(axis=0), np.arange(len(points))]
    return np.asarray(np.minimum(least, apart.min(axis=0)))


def on_the_machine(r: Array, flank: Side, hand: int, index: float) -> Array:
    """Vectors (N, 3) of the tooth on +x of the pinion's own frame, where the blank was cut that was turned by the index angle
    (deg) from where the middle of its space is over the x axis; of a left-hand pinion in the mirror."""
    beside = np.pi / TEETH if flank is Side.LEFT else -np.pi / TEETH
    back = turn(2, np.array(-beside - hand * np.radians(index)))[:3, :3]
    return np.asarray((r @ back.T) * [1.0, hand, 1.0])


def pinion_of(hand: str) -> tuple[Tooth, dict[str, float]]:
    gears = gm.build(gm.load(ENTERED, [f"hand={hand}"]))
    rows = {row[0]: row[2:] for table in gears.sheet().tables for row in table.rows}
    index = dict(zip(("concave", "convex"), rows["index angle of the blank"], strict=False))
    return gears.members["pinion"].tooth, index


@pytest.mark.sweep
@pytest.mark.parametrize("hand", ["left", "right"])
def test_flanks_and_toprem_of_the_design_file_are_what_the_sheet_cuts(hand: str) -> None:
    """At the index angle that is reported: within 1e-6 mm, nothing cut into, everything touched."""
    tooth, index = pinion_of(hand)
    sense = 1 if hand == "right" else -1
    for name, sheet in SHEET.items():
        which = Side.LEFT if (name == "concave") == (sense > 0) else Side.RIGHT
        jet = tooth.flank_grid(which, np.linspace(0.01, 0.99, 7), np.linspace(0.0, 1.0, 6)).jet
        assert jet is not None
        points, normals = (on_the_machine(x.reshape(-1, 3), which, sense, index[name]) for x in (jet.r, jet.n))
        slope = OUTER[name] * np.tan(np.radians(sheet["blade"]))
        assert np.abs(nearest(sheet, (sheet["point"], slope), points, normals)).max() < 1e-6
    # the straight toprem goes on from the blade
    high, angle = TOPREM
    sheet, which = SHEET["concave"], Side.LEFT if sense > 0 else Side.RIGHT
    side = tooth.side(which)
    (seam,) = side.fillet_breaks
    p = side.form_point[1] + np.linspace(0.05, 0.95, 4) * (seam - side.form_point[1])
    toe, heel = tooth.blank.extent
    at = np.repeat(p, 5), np.tile(toe + np.linspace(0.1, 0.9, 5) * (heel - toe), 4)
    jet = along(side.fillet, *at, tooth.blank.axial)[1]
    points, normals = (on_the_machine(x, which, sense, index["concave"]) for x in (jet.r, jet.n))
    radius = sheet["point"] + high * (np.tan(np.radians(sheet["blade"])) - np.tan(np.radians(angle)))
    # farther off it is not the toprem but its prolongation beyond the blade's tip that is swept
    assert np.abs(nearest(sheet, (radius, np.tan(np.radians(angle))), points, normals, 0.01)).max() < 1e-6


@pytest.mark.sweep
def test_pair_of_the_summary_has_contact_and_the_requested_backlash() -> None:
    contact = gm.build(gm.load(ENTERED)).contact()
    assert contact.fit is not None
    # least over the cycle, where both flanks lag
    assert contact.fit.normal_backlash[0] == pytest.approx(BACKLASH, abs=5e-3)
    assert contact.summary["interference_um"] == 0.0
    assert contact.summary["mesh_te_peak_to_peak_arcsec"] < 10.0
