"""Internal gears that a form tool leaves: flank, root fillet and volume in closed form, contact, refusals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.cad.brep import exact_volume
from gearmesh.kinds import Side
from gearmesh.systems.cylindrical.geometry.geometry import Toothing, involute
from gearmesh.systems.cylindrical.geometry.proportions import PairProportions, proportions

PAIRS: dict[str, dict[str, Any]] = {
    "spur": {"backlash": 0.08},
    # the round root of a space, given as the refusal of more says it
    "round_root": {"gear": {"tool_tip_radius": 0.43758}},
    "helical": {
        "module": 0.5,
        "helix_angle": 30,
        "hand": "left",
        "gear": {"teeth": -37, "profile_shift": 0.4, "tool_tip_radius": 0.2, "root_diameter": 22.4, "rim": 1},
        "pinion": {"teeth": 13, "profile_shift": 0.3},
    },
    "thinned": {
        "pressure_angle": 25,
        "helix_angle": 8,
        "gear": {"teeth": -121, "thickness_allowance": {"upper": -0.1, "lower": -0.2}, "addendum": 0.7},
    },
}


def design_of(name: str, **ring: Any) -> gm.Design:
    keys = {"kind": "cylindrical", "module": 2, **PAIRS[name]}
    pinion = {"teeth": 22, "face_width": 22, **keys.get("pinion", {})}
    gear = {"teeth": -70, "face_width": 20, "manufacture": "formed", **keys.get("gear", {}), **ring}
    return gm.parse({**keys, "pinion": pinion, "gear": gear})


def geometry_of(gears: gm.Gears) -> tuple[PairProportions, Any]:
    """Teeth in closed form (mm), and the ring's part of the design."""
    design = gears.design
    return proportions(design), design.gear  # type: ignore[arg-type, attr-defined]


def space_area(own: Toothing, tip: float, root: float, rounding: float) -> float:
    """Area between the axis and the outline of one pitch of a ring, with arcs as root fillets: sectors of tip and root circle, of
    both involutes, r_b^2 (xi_2^3 - xi_1^3) / 6 each, and of both arcs (Green's theorem)."""
    base, pitch = own.base_radius, math.pi / own.teeth
    first, of_centre = math.sqrt((tip / base) ** 2 - 1.0), math.sqrt(((root - rounding) / base) ** 2 - 1.0)
    last = of_centre + rounding / base
    # the space's flank begins on the base circle at this angle from its middle; there, less the roll, the line of action touches
    begins = pitch - own.half_angle(own.radius) + involute(own.alpha_t)
    centre, normal = begins - last + math.atan(of_centre), begins - last + 0.5 * math.pi
    x, y = (root - rounding) * math.cos(centre), (root - rounding) * math.sin(centre)
    across = x * (math.sin(normal) - math.sin(centre)) - y * (math.cos(normal) - math.cos(centre))
    arc = 0.5 * (rounding**2 * (normal - centre) + rounding * across)
    land = pitch - (begins - first + math.atan(first))
    return tip**2 * land + base**2 * (last**3 - first**3) / 3.0 + 2.0 * arc + root**2 * centre


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.sweep_cases("helical", "spur", "thinned")
def test_flank_matches_shaped_gear_and_fillet_matches_given_arc(name: str) -> None:
    gears = gm.build(design_of(name))
    geometry, spec = geometry_of(gears)
    own, tip, root = geometry.mesh.gear, geometry.tips[1], geometry.roots[1]
    rounding = spec.tool_tip_radius * own.module
    tooth = gears.members["gear"].tooth
    shaped = gm.build(design_of(name, manufacture="generated", tool_tip_radius=0.0, root_diameter=2.0 * root))
    for which in Side:
        formed, other = tooth.unmodified_tooth.side(which), shaped.members["gear"].tooth.side(which)
        p, z = np.linspace(formed.form_point[0], formed.tip, 9)[:, None], np.linspace(-10.0, 10.0, 5)
        jet = formed.flank.jet(*np.broadcast_arrays(p, z))
        length = np.sqrt(jet.r[..., 0] ** 2 + jet.r[..., 1] ** 2 - own.base_radius**2)
        of_shaped = other.flank.jet(length, jet.r[..., 2])
        assert np.abs(of_shaped.r - jet.r).max() < 1e-12 * root
        assert np.abs(of_shaped.n - jet.n).max() < 1e-12
        # the fillet touches flank and root
        begin, end = (formed.fillet.jet(np.array([q]), np.array([3.0])) for q in (formed.form_point[1], formed.root))
        touched = formed.flank.jet(np.array([formed.form_point[0]]), np.array([3.0]))
        assert np.abs(begin.r - touched.r).max() < 1e-13 * root
        assert np.abs(begin.n - touched.n).max() < 1e-12
        assert np.hypot(*end.r[0, :2]) == pytest.approx(root, rel=1e-14)
        assert np.abs(end.n[0, :2] + end.r[0, :2] / root).max() < 1e-12
        # and is an arc in the transverse section: its derivative turns the normal at 1 / rounding
        middle = formed.fillet.jet(np.array([0.5 * (formed.form_point[1] + formed.root)]), np.array([0.0]))
        assert np.linalg.norm(middle.r_u) == pytest.approx(rounding, rel=1e-12)
    # the centre of the arc is on an involute of the same base circle
    form = math.hypot(own.base_radius, math.sqrt((root - rounding) ** 2 - own.base_radius**2) + rounding)
    sheet = gears.sheet().plain_tables
    assert sheet["Members"]["d_Ff"][2] == pytest.approx(2.0 * form, abs=1e-9)
    outside = tooth.blank.body.profile[0][0]
    exact = spec.face_width * (math.pi * outside**2 - own.teeth * space_area(own, tip, root, rounding))
    assert exact_volume(gears.members["gear"]) == pytest.approx(exact, rel=1e-12)


@pytest.mark.sweep
def test_solids_contact_and_roll_test_agree() -> None:
    gears = gm.build(design_of("spur", tip_chamfer=0.15))
    assert not gears.check(0.01).complaints
    geometry, spec = geometry_of(gears)
    sheet = gears.sheet().plain_tables
    # the tangent of 60 deg touches the arc, and there is involute down to the base circle
    assert sheet["Root: tangent of 30 deg, internal 60 deg"]["rho_F"][2] == pytest.approx(2.0 * spec.tool_tip_radius)
    tip, base = geometry.tips[1], geometry.mesh.gear.base_radius
    assert sheet["Reserves (negative: none)"]["undercut"][2] == pytest.approx(math.sqrt(tip**2 - base**2))


@pytest.mark.parametrize(
    ("ring", "words"),
    [
        (
            {"tool_tip_radius": 0.5},
            "gear.tool_tip_radius = 0.5: .* at most 0.454115, with which a space has one round root",
        ),
        ({"tool_tip_radius": 0.0}, "gear.tool_tip_radius = 0 m_n: must be above 0"),
        (
            {"tool_tip_radius": 0.9, "dedendum": 0.4, "addendum": 0.1},
            "leave no flank below the tips; allowed is less than 0.74",
        ),
        ({"dedendum": 2}, "gear.dedendum = 2: the spaces are pointed before the root; allowed is less than 1.86611"),
        (
            {"root_diameter": 130},
            "gear.root_diameter = 130 mm: if it is left out, .*: the root is inside the base circle",
        ),
        (
            {"tip_diameter": 131},
            "gear.tip_diameter = 131 mm: .*: the involute ends on the base circle, .* at least 131.557 mm",
        ),
        ({"shaper": {"teeth": 28}}, 'gear.manufacture = "formed": cannot be given together with shaper'),
        ({"teeth": 70}, 'gear.manufacture = "formed": only internal gears are formed'),
    ],
)
@pytest.mark.sweep_cases(
    "ring5-gear.tip_diameter = 131 mm: .*: the involute ends on the base circle, .* at least 131.557 mm",
    "ring4-gear.root_diameter = 130 mm: if it is left out, .*: the root is inside the base circle",
)
def test_what_no_form_tool_leaves_is_refused_in_one_line(ring: dict[str, Any], words: str) -> None:
    with pytest.raises(DesignError, match=words) as failure:
        gm.build(design_of("spur", **ring))
    assert "\n" not in str(failure.value)


def test_a_ring_alone_ends_where_its_involute_does_or_says_what_would() -> None:
    keys: dict[str, Any] = {"teeth": -24, "face_width": 10, "manufacture": "formed"}
    alone = gm.build(gm.parse({"kind": "cylindrical", "module": 1, "gear": {**keys, "thickness_allowance": "cd25"}}))
    assert any(line.endswith("instead of 1 because its involute ends on the base circle") for line in alone.warnings)
    assert exact_volume(alone.members["gear"]) > 0.0
    for more, words in (
        (
            {"profile_shift": 3, "addendum": 1},
            "profile_shift = 3: leaves no spaces between the teeth; allowed is less than 2.1578",
        ),
        (
            {"thickness_allowance": {"upper": 4, "lower": 3}},
            "upper = 4 mm: leaves no spaces .* is less than 2.07079 mm",
        ),
    ):
        with pytest.raises(DesignError, match=words):
            gm.parse({"kind": "cylindrical", "module": 1, "gear": {**keys, **more}})
