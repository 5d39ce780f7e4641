"""Depth tapers of bevel pairs without offset: what the cutters leave of the teeth, against what names and roots promise."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.kinds import Side
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank

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


@pytest.mark.sweep
@pytest.mark.parametrize("taper", TAPERS)
def test_tips_clear_roots_by_the_clearance(taper: str) -> None:
    """Compare with tip clearances of the generated roots in the contact analysis. A wrong sliding base would raise or lower the
    roots."""
    pair = gears(taper)
    told, clearance = pair.contact().summary, basic_blank(pair.design.in_mm()).clearance
    for member in ("pinion", "gear"):
        assert told[f"tip_clearance_{member}_mm"] == pytest.approx(clearance, rel=3e-3)
    assert told["contact_ratio"] > 1.0
    assert told["interference_um"] == 0.0


@pytest.mark.sweep
def test_duplex_slots_are_as_wide_at_the_toe_as_at_the_heel() -> None:
    widths = {taper: slots(taper)["pinion"] for taper in TAPERS}
    spread = {taper: float(heel / toe) for taper, (toe, _, heel) in widths.items()}
    assert spread["duplex"] == pytest.approx(1.0, abs=0.02)
    assert spread["uniform"] > 1.5
    # root lines through the apex leave a slot between both
    assert abs(spread["standard"] - 1.0) > abs(spread["duplex"] - 1.0)


@pytest.mark.sweep
def test_uniform_teeth_are_as_deep_everywhere() -> None:
    (rows,) = (
        table for title, table in gears("uniform").sheet().plain_tables.items() if title.startswith("Dimensions")
    )
    for outer, inner in (("hae", "hai"), ("hfe", "hfi"), ("he", "hi")):
        assert rows[outer][1:] == pytest.approx(rows[inner][1:], rel=1e-9)


#: ISO 23509 annex F, sample 1: basic data, the printed cones, and figures of the standard's tables
SAMPLE_1: dict[str, Any] = {
    "kind": "spiral_bevel",
    "module": 176.893 / 39.0,
    "face_width": 25.4,
    # j_en = 0.127 at the outer, by (203) at the mean; profile shift 0.505 and x_smn 0.046 as the standard rounds them
    "backlash": 0.112431,
    "addendum_factor": 0.2475,
    "thickness_factor": 0.092,
    "pinion": {"teeth": 14},
    "gear": {"teeth": 39, "cutter": {"tip_radius": 114.3}},
}
PRINTED_CONES = {
    "pinion.root_angle": 17.613,
    "pinion.face_angle": 26.24,
    "gear.root_angle": 63.76,
    "gear.face_angle": 72.387,
}
PRINTED_SIZES = {
    "smn": (6.465, 3.511),
    "smt": (7.892, 4.286),
    "ham": (4.836, 1.591),
    "hfm": (2.394, 5.639),
    "hae": (6.281, 2.064),
    "dae": (75.324, 178.288),
    "txo": (86.324, 29.808),
    "tzF": (-9.931, -1.508),
    "tzR": (2.094, 3.999),
}


@pytest.mark.sweep
def test_printed_root_and_face_angles_are_the_cones_of_the_standard() -> None:
    """ISO 23509 sample 1, whose angles are those of a duplex taper: as that builds it, with the standard's thicknesses."""
    given = gm.build(gm.parse(SAMPLE_1).with_values(PRINTED_CONES))
    duplex = gm.build(gm.parse({**SAMPLE_1, "taper": "duplex"}))
    own = given.sheet().plain_tables["Dimensions [ISO 23509]"]
    for symbol, printed in PRINTED_SIZES.items():
        # a printed angle of the gear's root is good to 0.0005 deg, which its root apex, nearly square to it, shows most
        assert own[symbol][1:] == pytest.approx(printed, abs=0.0025), symbol
    for name, member in given.members.items():
        for side in Side:
            one, other = (
                each.tooth.flank_grid(side, np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 7)).points
                for each in (member, duplex.members[name])
            )
            # angles rounded to 0.0005 deg over half the face
            np.testing.assert_allclose(one, other, atol=2e-3)
    assert given.contact().summary["tip_clearance_pinion_mm"] == pytest.approx(0.803, abs=3e-3)


@pytest.mark.sweep
def test_thicknesses_with_offset_are_those_of_the_standard() -> None:
    """ISO 23509 sample 2: the gear's printed cones, j_et2 = 0.2 of which both members have half."""
    mean = 0.2 * 76.337 / 91.468 * np.cos(np.radians(38.609)) * np.cos(np.radians(20.0))
    cones = {"root_angle": 64.324, "face_angle": 69.323, "cutter": {"tip_radius": 63.5}}
    factors = {"addendum_factor": 0.35, "depth_factor": 2, "thickness_factor": 0.1, "backlash": mean}
    basic = {"kind": "hypoid", "module": 170.0 / 42.0, "offset": 15, "spiral_angle": 50, "face_width": 30}
    design = {**basic, **factors, "pinion": {"teeth": 13}, "gear": {"teeth": 42, **cones}}
    blank = basic_blank(gm.parse(design))
    assert [each.thickness for each in blank.members] == pytest.approx([4.922, 3.241], abs=1e-3)
    first, second = blank.standard_depths
    assert [first.addendum, first.dedendum, second.addendum, second.dedendum] == pytest.approx(
        [3.432, 2.508, 1.848, 4.092], abs=1e-3
    )
    assert np.degrees([blank.pinion.root_angle, blank.pinion.face_angle]) == pytest.approx([20.303, 25.232], abs=1e-3)


def test_root_lines_through_the_apex_are_told_by_their_depth() -> None:
    """Root angles whose lines through the pitch apex leave the whole depth keep these lines [AB]; others turn about the mean."""
    base = gm.parse({**PAIR, "hand": "left"})
    plain = basic_blank(base)
    angles = [float(np.degrees(each.root_angle)) for each in plain.members]
    # as much more on the one as less on the other: a sheet that splits the depth otherwise
    split = basic_blank(base.with_values({"pinion.root_angle": angles[0] - 0.2, "gear.root_angle": angles[1] + 0.2}))
    for own, old in zip(split.members, plain.members, strict=True):
        assert own.root_apex == 0.0
        assert own.mean_dedendum == pytest.approx(own.mean_cone_distance * np.tan(own.dedendum_angle), rel=1e-12)
        assert own.mean_dedendum != pytest.approx(old.mean_dedendum, rel=0.02)
    leant = basic_blank(base.with_values({"pinion.root_angle": angles[0] - 1.0}))
    assert leant.pinion.mean_dedendum == pytest.approx(plain.pinion.mean_dedendum, rel=2e-3)
    # the gear's tip follows the pinion's root
    assert leant.gear.face_angle == pytest.approx(leant.shaft_angle - leant.pinion.root_angle, abs=1e-12)
    assert leant.gear.root_angle == pytest.approx(plain.gear.root_angle, abs=1e-12)


@pytest.mark.sweep
def test_settings_written_are_the_same_pair(tmp_path: Path) -> None:
    written = gm.load(gears("duplex").sheet().save(tmp_path / "given.toml"))
    for name, member in gears("duplex").members.items():
        for side in Side:
            s, t = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 7)
            one, other = (
                each.tooth.flank_grid(side, s, t).points for each in (member, gm.build(written).members[name])
            )
            np.testing.assert_allclose(one, other, atol=1e-9)
