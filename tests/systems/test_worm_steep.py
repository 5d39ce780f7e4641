"""Worm drives of steep threads: tips at every station of the face, and the face width that is left to the default."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.kernel.surface.stations import along
from gearmesh.systems.worm_drive.design import WormDriveDesign
from gearmesh.teeth.region import Side

CORPUS = SAMPLES.parent / "tests" / "corpus"


def face_width(gears: gm.Gears) -> float:
    assert isinstance(gears.design, WormDriveDesign)
    return gears.design.wheel.face_width


@pytest.mark.parametrize("name", ["tip_worm_drive_19", "tip_worm_drive_53"])
def test_every_station_has_the_tip_next_to_its_neighbours(name: str) -> None:
    """Beside each other at 2,001 stations, on the tip; by halving the flank's parameter at the station where it failed."""
    tooth = gm.build(gm.load(CORPUS / f"{name}.toml")).members["wheel"].tooth
    t = np.linspace(0.0, 1.0, 2001)
    tips = tooth.ends(Side.RIGHT, t).tip
    assert np.abs(np.diff(tips)).max() < 0.02 * np.ptp(tips)
    k = int(np.argmin(np.abs(t - (0.01 if name.endswith("19") else 0.995))))
    side, station = tooth.right, tooth.stations(t[[k]])
    low, high = side.form_point[0], tips[k] + (tips[k] - side.form_point[0])
    for _ in range(60):
        middle = 0.5 * (low + high)
        r = along(side.flank, np.array([middle]), station, tooth.blank.axial)[1].r
        low, high = (middle, high) if tooth.blank.tip.value(r)[0] < 0.0 else (low, middle)
    assert tips[k] == pytest.approx(low, abs=1e-9 * abs(side.tip - side.form_point[0]))


def test_a_face_width_that_is_left_open_is_no_reason_for_a_refusal() -> None:
    """What is left of DIN 3975's is sound, an eighth of it more is not; where that is, it stays."""
    steep = gm.load(CORPUS / "face_worm_drive_10.toml")
    gears = gm.build(steep)
    width = face_width(gears)
    usual = 2.0 * gears.design.given_module * (np.sqrt(8.478 + 1.0) + 0.5)
    assert width == pytest.approx(np.round(8.0 * width / usual) / 8.0 * usual, rel=1e-12)
    assert 0.5 * usual <= width < usual
    with pytest.raises(gm.DesignError, match=r"^wheel\.face_width"):
        gm.build(steep.with_values({"wheel.face_width": width + usual / 8.0}))
    keys = {"kind": "worm_drive", "module": 5, "worm": {"threads": 4, "quotient": 10}, "wheel": {"teeth": 38}}
    assert face_width(gm.build(gm.parse(keys))) == pytest.approx(10.0 * (np.sqrt(11.0) + 0.5))


def test_throat_angle_is_refused_where_it_does_nothing() -> None:
    keys = {"kind": "worm_drive", "module": 5, "worm": {"threads": 2}, "wheel": {"teeth": 38, "throat_angle": 30.0}}
    with pytest.raises(
        gm.DesignError, match=r"^wheel\.throat_angle = 30 deg: .* wheel\.tip_form is throated; .*chamfered"
    ):
        gm.build(gm.parse(keys))
