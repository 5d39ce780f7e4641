"""Thickness by span, balls and pins, balls that are proposed, and roots as a tool leaves them that is fed for the allowance."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from oracles import measuring
from oracles.examples import some
from scipy.optimize import brentq

import gearmesh as gm
from gearmesh.kinds import Region
from gearmesh.systems.cylindrical.geometry import measures
from gearmesh.systems.cylindrical.geometry.geometry import Toothing

#: mm: the sheet has nine decimals
EXACT = 1e-9
ALPHA = math.radians(20.0)
CUT = "As cut by feeding the tool for the allowance"


def design_of(**more: Any) -> gm.Design:
    keys: dict[str, Any] = {"kind": "cylindrical", "module": 2, **more}
    for member, teeth in (("pinion", 18), ("gear", 45)):
        keys[member] = {"teeth": teeth, "face_width": 20, **keys.get(member, {})}
    return gm.parse(keys)


@pytest.mark.quick
def test_a_published_sheet_to_the_last_digit() -> None:
    """51 and 52 teeth of module 1, whose span allowances are -0.278 and -0.207 mm, as STplus prints its example kst-E: s_n, A_sne,
    W_6 and M_dK (1.75 mm) nominal, x_E, d_W and d_M as cut."""
    for z, x, of_span, printed in (
        (51, 0.2034, -0.278, (1.719, -0.296, 17.090, 53.846, -0.2030, 50.788, 50.779)),
        (52, 0.3143, -0.207, (1.800, -0.220, 17.180, 55.064, 0.0117, 51.728, 52.146)),
    ):
        nominal = Toothing(z, 1.0, ALPHA, shift=x)
        cut = Toothing(z, 1.0, ALPHA, shift=x, allowance=of_span / math.cos(ALPHA))
        assert measures.span(cut, 6) - measures.span(nominal, 6) == pytest.approx(of_span, abs=1e-12)
        figures = (
            *(nominal.thickness, cut.allowance, measures.span(nominal, 6), measures.over_balls(nominal, 1.75)),
            *(cut.generating_shift, 2.0 * measures.span_radius(cut, 6), 2.0 * measures.ball_contact_radius(cut, 1.75)),
        )
        digits = (3, 3, 3, 3, 4, 3, 3)
        assert tuple(round(value, n) for value, n in zip(figures, digits, strict=True)) == printed


@pytest.mark.quick
def test_balls_of_din_3977() -> None:
    """Its table 1 has 55 diameters, in five columns of eleven that begin so; its example (22 teeth, 30 deg, x 0.5, module 3.5):
    6.475 mm, so that 6.5 is taken; 6 mm touches 0.113 modules below the V cylinder, beyond its limit of 0.1."""
    table = measures.STANDARD_DIAMETERS_MM[:55]
    assert [table[k] for k in (0, 11, 22, 33, 44, 54)] == [0.17, 0.895, 3.0, 6.5, 16.0, 50.0]
    assert list(measures.STANDARD_DIAMETERS_MM) == sorted(set(measures.STANDARD_DIAMETERS_MM))
    teeth = Toothing(22, 3.5, ALPHA, math.radians(30.0), shift=0.5)
    middle = measures.v_radius(teeth)
    # the standard's own formula approximates the ideal one
    assert measures.best_ball(teeth, middle) == pytest.approx(6.475, abs=0.003)
    circles = teeth.radius_at(1.5 * 3.5), teeth.radius_at(-0.75 * 3.5)
    assert measures.ball_diameter(teeth, [(teeth.base_radius + 1.0, circles[0])], circles) == 6.5
    assert (measures.ball_contact_radius(teeth, 6.0) - middle) / 3.5 == pytest.approx(-0.113, abs=5e-4)


@pytest.mark.parametrize("made", ["upper", "lower"])
@pytest.mark.sweep_cases("upper")
def test_teeth_measure_what_the_limits_say(made: str) -> None:
    """Planes and balls on the exact flanks, helical; the sheet has the limits again. Over balls thick teeth are the upper limit."""
    span = {"teeth": 3, "upper": 15.27, "lower": 15.24}
    balls = {"diameter": 4, "upper": 98.9, "lower": 98.8}
    design = design_of(
        helix_angle=15,
        pinion={"span": span, "thickness_made": made},
        gear={"balls": balls, "thickness_made": made},
    )
    gears = gm.build(design)
    assert measuring.span(gears.members["pinion"], 3) == pytest.approx(span[made], abs=EXACT)
    assert measuring.over_balls(gears.members["gear"], 4.0, 1) == pytest.approx(balls[made], abs=EXACT)
    tables = gears.sheet().plain_tables
    rows = tables["Measures of the tooth thickness"]
    assert [rows["k_W"][1], rows["W_k_upper"][1], rows["W_k_lower"][1]] == pytest.approx([3, 15.27, 15.24], abs=EXACT)
    assert [rows["D_M"][2], rows["M_dK_upper"][2], rows["M_dK_lower"][2]] == pytest.approx([4, 98.9, 98.8], abs=EXACT)
    members = tables["Members"]
    assert members["T_sn"][1] == pytest.approx(0.03 / math.cos(ALPHA), abs=EXACT)
    assert members["A_sn"][1] == members["A_sne" if made == "upper" else "A_sni"][1]
    assert tables["Backlash"]["j_bn"][3 if made == "upper" else 4] == tables["Backlash"]["j_bn"][2]


@pytest.mark.sweep
def test_a_ring_between_pins_is_thickest_at_their_lower_limit() -> None:
    """Internal spur teeth of the upper limit measure the lower limit between pins, in a gear without a mating gear and in a
    set. A planet's span without limits leaves its thickness."""
    pins = {"diameter": 3.75, "upper": 114.1, "lower": 114.0}
    ring = {"teeth": -60, "face_width": 20, "pins": pins, "thickness_made": "upper"}
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 2, "gear": ring}))
    assert measuring.over_balls(gears.members["gear"], 3.75, -1) == pytest.approx(114.0, abs=EXACT)
    planetary = {
        "sun": {"teeth": 18, "face_width": 20},
        "planet": {"teeth": 21, "face_width": 20, "span": {"teeth": 2}},
    }
    own = gm.parse({"kind": "planetary", "module": 2, **planetary, "ring": ring, "planets": 3})
    tables = gm.build(own).sheet().plain_tables
    rows = tables["Planet and ring: Measures of the tooth thickness"]
    assert [rows["M_dR_upper"][2], rows["M_dR_lower"][2]] == pytest.approx([114.0, 114.1], abs=EXACT)
    assert rows["k_W"][1] == 2
    assert "A_sne" not in tables["Sun and planet: Members"]


FED: dict[str, dict[str, Any]] = {
    "ring": {"teeth": -60, "profile_shift": 0.1, "tool_tip_radius": 0.2, "shaper": {"teeth": 24}},
    "shaper": {"shaper": {"teeth": 25}, "profile_shift": 0.2, "tool_tip_radius": 0.2},
    "hob": {},
}


def shaping_distance(teeth: tuple[int, int], shift: float) -> float:
    """Distance of a gear (negative: internal) and its cutter without shift, module 2, 12 deg: inv(alpha_w0) = inv(alpha_t) + 2
    tan(alpha_n) x / (z + z_0) [ISO 21771]."""
    alpha_t = math.atan(math.tan(ALPHA) / math.cos(math.radians(12.0)))
    wanted = math.tan(alpha_t) - alpha_t + 2.0 * math.tan(ALPHA) * shift / sum(teeth)
    working = brentq(lambda angle: math.tan(angle) - angle - wanted, 0.0, 1.2, xtol=1e-14)
    return abs(sum(teeth)) / math.cos(math.radians(12.0)) * math.cos(alpha_t) / math.cos(working)


@pytest.mark.parametrize("name", some(FED, 2))
@pytest.mark.sweep_cases("ring")
def test_a_tool_that_is_fed_leaves_the_root_that_the_sheet_states(name: str) -> None:
    """Roots, form diameters and thicknesses of the exact teeth, and the root of the mesh; the flanks are the same either way."""
    given = {"face_width": 6, "teeth": 30, "thickness_allowance": {"upper": -0.1, "lower": -0.3}, **FED[name]}
    gears = {
        by: gm.build(
            gm.parse(
                {
                    "kind": "cylindrical",
                    "module": 2,
                    "helix_angle": 12,
                    "gear": {**given, "allowance_by": by, "thickness_made": "lower"},
                }
            )
        )
        for by in ("flanks", "feed")
    }
    tables = {by: made.sheet().plain_tables for by, made in gears.items()}
    fed, members = tables["feed"]["Members"], tables["flanks"]["Members"]
    cut = tables["flanks"][CUT]
    assert tables["feed"][CUT] == cut
    for symbol, own in (("d_fE", "d_f"), ("d_FfE", "d_Ff")):
        assert cut[f"{symbol}_lower"][1] == pytest.approx(fed[own][1], abs=EXACT)
        # the thinner the deeper: outside of a ring
        assert np.sign(fed[own][1] - members[own][1]) == (1.0 if name == "ring" else -1.0)
    shift = fed["x"][1] - 0.3 / (4.0 * math.tan(ALPHA))
    assert cut["x_E_lower"][1] == pytest.approx(shift, abs=EXACT)
    if name == "hob":
        assert fed["d_f"][1] == pytest.approx(fed["d"][1] + 4.0 * (shift - 1.25), abs=EXACT)
    else:
        z = (FED[name].get("teeth", 30), FED[name]["shaper"]["teeth"])
        fed_by = shaping_distance(z, shift) - shaping_distance(z, fed["x"][1])
        assert fed["d_f"][1] - members["d_f"][1] == pytest.approx(2.0 * fed_by, abs=1e-8)
    assert fed["s_n"][1] == members["s_n"][1]
    member = gears["feed"].members["gear"]
    tooth = member.tooth
    root = tooth.grid(Region.ROOT, np.array([0.0, 1.0]), tooth.sections([0.5])).points
    assert 2.0 * np.hypot(root[..., 0], root[..., 1]) == pytest.approx(fed["d_f"][1], abs=EXACT)
    assert measuring.arc(member, fed["d"][1] / 2) == pytest.approx(fed["s_t"][1], abs=EXACT)
    if name == "hob":
        corners = gears["feed"].solid("gear", 0.02).mesh.vertices
        radii = np.hypot(corners[:, 0], corners[:, 1])
        assert np.abs(2.0 * radii - fed["d_f"][1]).min() < 1e-9


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"pinion": {"span": {"teeth": 9}}}, "pinion.span.teeth = 9: it does not touch"),
        ({"pinion": {"span": {"teeth": 9}}}, "allowed is 1 to 4"),
        ({"pinion": {"balls": {"diameter": 9}}}, "pinion.balls.diameter = 9 mm: does not touch the involutes"),
        ({"gear": {"balls": {"diameter": 4, "upper": 9, "lower": 8}}}, "gear.balls.upper = 9 mm"),
        ({"pinion": {"span": {"teeth": 3, "upper": 15}}}, "pinion.span.lower: missing"),
        (
            {"pinion": {"thickness_allowance": "e24", "balls": {"diameter": 4, "upper": 42, "lower": 42}}},
            "pinion.balls: cannot say the thickness together with thickness_allowance",
        ),
        ({"gear": {"teeth": -60, "span": {"teeth": 30}}}, "gear.span.teeth = 30: it does not touch"),
        (
            {"helix_angle": 9, "gear": {"teeth": -60, "pins": {"diameter": 4, "upper": 116, "lower": 115}}},
            "straight pins touch internal helical teeth at their ends alone",
        ),
        (
            {"backlash": 0.1, "pinion": {"span": {"teeth": 3, "upper": 15.1, "lower": 15}}},
            "backlash = 0.1 mm: cannot be given together with pinion.span",
        ),
    ],
)
@pytest.mark.sweep_cases(
    "keys2-pinion.balls.diameter = 9 mm: does not touch the involutes",
    "keys7-straight pins touch internal helical teeth at their ends alone",
)
def test_what_cannot_be_measured_is_refused_in_one_line(keys: dict[str, Any], said: str) -> None:
    with pytest.raises(gm.DesignError) as failure:
        gm.build(design_of(**keys))
    assert said in str(failure.value)
    assert "\n" not in str(failure.value)


@pytest.mark.quick
def test_the_range_of_balls_ends_where_they_cease_to_touch() -> None:
    teeth = Toothing(30, 2.0, ALPHA, math.radians(10.0), shift=0.2)
    flank, circles = (teeth.base_radius + 0.3, teeth.radius + 2.4), (teeth.radius + 2.4, teeth.radius - 2.1)
    between = measures.ball_range(teeth, [flank], circles)
    assert between is not None
    for end, away in zip(between, (-1e-6, 1e-6), strict=True):
        assert measures.ball_fits(teeth, end - away, [flank], circles)
        assert not measures.ball_fits(teeth, end + away, [flank], circles)
