"""Depth tapers of bevel pairs without offset: what the cutters leave of the teeth, against what names and roots promise."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.systems.spiral_bevel.settings import basic_blank
from gearmesh.teeth.region import Side

PAIR: dict[str, Any] = {
    "kind": "spiral_bevel",
    "module": 4.0,
    "shaft_angle": 80.0,
    "spiral_angle": 33.0,
    "hand": "right",
    "backlash": 0.1,
    "pinion": {"teeth": 16},
    "gear": {"teeth": 43},
}
TAPERS = ("uniform", "standard", "duplex", "tilted_root_line")
CUT = "Teeth as cut, measured on their flanks"


@cache
def gears(taper: str) -> Any:
    return gm.build(gm.parse({**PAIR, "taper": taper}))


@cache
def slots(taper: str) -> dict[str, np.ndarray]:
    """Slot widths (toe, mean, heel) of both members, measured between the fillets."""
    (blank,) = (table for table in gears(taper).sheet().tables if table.title == "Blank")
    rows = [row for row in blank.rows if row[0].startswith("slot width")]
    return {name: np.array([row[k] for row in rows]) for k, name in ((2, "pinion"), (3, "gear"))}


@pytest.mark.parametrize("taper", TAPERS)
def test_tips_clear_roots_by_the_clearance(taper: str) -> None:
    """As the contact analysis has it of the generated roots, which a wrong sliding base would raise or lower."""
    pair = gears(taper)
    told, clearance = pair.contact().summary, basic_blank(pair.design.in_mm()).clearance
    for member in ("pinion", "gear"):
        assert told[f"tip_clearance_{member}_mm"] == pytest.approx(clearance, rel=3e-3)
    assert told["contact_ratio"] > 1.0
    assert told["interference_um"] == 0.0


def test_duplex_slots_are_as_wide_at_the_toe_as_at_the_heel() -> None:
    widths = {taper: slots(taper)["pinion"] for taper in TAPERS}
    spread = {taper: float(heel / toe) for taper, (toe, _, heel) in widths.items()}
    assert spread["duplex"] == pytest.approx(1.0, abs=0.02)
    assert spread["uniform"] > 1.5
    # root lines through the apex leave a slot between both
    assert abs(spread["standard"] - 1.0) > abs(spread["duplex"] - 1.0)


def test_uniform_teeth_are_as_deep_everywhere() -> None:
    (rows,) = (
        table for title, table in gears("uniform").sheet().plain_tables.items() if title.startswith("Dimensions")
    )
    for outer, inner in (("hae", "hai"), ("hfe", "hfi"), ("he", "hi")):
        assert rows[outer][1:] == pytest.approx(rows[inner][1:], rel=1e-9)


def test_settings_written_are_the_same_pair(tmp_path: Path) -> None:
    written = gm.load(gears("duplex").sheet().save(tmp_path / "given.toml"))
    for name, member in gears("duplex").members.items():
        for side in Side:
            s, t = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 7)
            one, other = (
                each.tooth.flank_grid(side, s, t).points for each in (member, gm.build(written).members[name])
            )
            np.testing.assert_allclose(one, other, atol=1e-9)
