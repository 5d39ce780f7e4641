"""Hobs with protuberance, stock, chamfer and a finishing tool: teeth against the rolling tools themselves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from oracles.examples import some

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.cad.brep import exact_volume, spline_tooth
from gearmesh.cad.solid_part import solid_part
from gearmesh.cad.volume import volume
from gearmesh.contact.flanks import contact_flank
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Region, Side
from gearmesh.mesh.hexahedra.hex_quality import scaled_jacobian
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.systems.cylindrical.geometry.proportions import proportions

MODULE, ALPHA = 2.0, math.radians(20.0)
#: positions of the tools, points of a rounding, and mm between those of a straight line
POSITIONS, ROUNDING, STEP = 3000, 300, 0.01


def hobbed(
    teeth: int,
    hob: dict[str, Any] | None,
    *,
    beta: float = 0.0,
    module: float = MODULE,
    width: float = 20.0,
    **keys: Any,
) -> Any:
    """A pair whose pinion the hob cuts."""
    pinion = {"teeth": teeth, "face_width": width, **({} if hob is None else {"hob": hob}), **keys}
    gear = {"teeth": 41, "face_width": width}
    return gm.parse({"kind": "cylindrical", "module": module, "helix_angle": beta, "pinion": pinion, "gear": gear})


#: the rounding alone relieves; so it does of an undercut flank; the line of the protuberance does; rounding, then line; before
#: the stock is off; no protuberance and a notch in the fillet, in the flank; a notch over a protuberance; chamfers; a sharp hob
HOBS: dict[str, tuple[int, dict[str, Any], dict[str, Any]]] = {
    "relieved": (20, {"protuberance": 0.2, "stock": 0.1}, {"beta": 20}),
    "undercut": (11, {"protuberance": 0.12, "stock": 0.1, "protuberance_angle": 5}, {}),
    "line": (120, {"protuberance": 0.3, "stock": 0.15}, {}),
    "line_cut": (45, {"protuberance": 0.22, "stock": 0.0}, {"beta": 10}),
    "line_helical": (60, {"protuberance": 0.25, "stock": 0.1}, {"beta": 30, "profile_shift": 0.3}),
    "unfinished": (30, {"protuberance": 0.2, "stock": 0.1, "finished": False}, {"profile_shift": 0.4}),
    "barely": (25, {"protuberance": 0.003}, {}),
    "notch": (20, {"stock": 0.1, "finishing_diameter": 37.8}, {}),
    "notch_in_flank": (35, {"stock": 0.1, "finishing_diameter": 70.5}, {"beta": 15}),
    "notch_over_line": (90, {"protuberance": 0.05, "stock": 0.12, "finishing_diameter": 178}, {}),
    "semi_topping": (20, {"chamfer_diameter": 43.3}, {}),
    "all": (30, {"protuberance": 0.2, "stock": 0.1, "chamfer_diameter": 67.5, "chamfer_angle": 38}, {"beta": 20}),
    "unfinished_semi_topping": (40, {"stock": 0.1, "finished": False, "chamfer_diameter": 83}, {}),
    "sharp": (24, {"protuberance": 0.15, "stock": 0.05}, {"tool_tip_radius": 0}),
}


def hob_contour(
    own: Toothing, root: float, hob: dict[str, Any], rounding: float, chamfer: tuple[Array, float] | None = None
) -> Array:
    """Points (N, 2) of the right side of a hob's space in the normal section, x outwards, from the tip plane's middle up.

    `chamfer`: a point (2,) and the angle of the line at the hob's root.
    """
    pr, q, alpha = hob.get("protuberance", 0.0), hob.get("stock", 0.0), own.alpha
    half = 0.5 * own.module * (0.5 * math.pi + 2.0 * own.shift * math.tan(alpha)) + 0.5 * own.allowance
    into = np.array([math.sin(alpha), -math.cos(alpha)])
    foot = np.array([0.0, -half]) + q * into  # on the hob's flank
    x = root + rounding
    # the centre of the rounding is its radius less the protuberance behind the hob's flank
    y = foot[1] - (rounding - pr - (x - foot[0]) * into[0]) / math.cos(alpha)
    last = alpha
    if pr:
        last = math.radians(hob.get("protuberance_angle", 10.0))
        if pr <= rounding * (1.0 - math.cos(alpha - last)):
            last = alpha - math.acos(1.0 - pr / rounding)
    angle = np.linspace(0.5 * math.pi, last, ROUNDING)
    arc = np.array([x, y]) - rounding * np.stack((np.sin(angle), -np.cos(angle)), axis=-1)
    # from the arc's end along its tangent to the hob's flank
    tangent = np.array([math.cos(last), math.sin(last)])
    short = max(0.0, -float((arc[-1] - foot) @ into)) / float(tangent @ into) if last < alpha - 1e-12 else 0.0
    corner = arc[-1] + short * tangent
    top = corner + 3.0 * own.module * np.array([math.cos(alpha), math.sin(alpha)])
    middle = np.array([root, -0.5 * math.pi * own.module])
    found = [drawn(middle, arc[0]), arc, drawn(arc[-1], corner)]
    if chamfer is not None:
        point, steep = chamfer
        direction = np.array([math.cos(steep), math.sin(steep)])
        bend = point - float((point - foot) @ into) / float(direction @ into) * direction
        found, corner = [*found, drawn(corner, bend)], bend
        top = bend + 2.0 * own.module * direction
    return np.vstack((*found, drawn(corner, top)))


def drawn(start: Array, end: Array) -> Array:
    """Points (N, 2) of a straight line."""
    count = max(2, math.ceil(float(np.linalg.norm(end - start)) / STEP))
    return start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)


def finisher_contour(own: Toothing, diameter: float) -> Array:
    """Points (N, 2) like `hob_contour`, of the finishing tool with a sharp tip that leaves an involute from `diameter` on."""
    half = 0.5 * own.thickness - own.shift * own.module * math.tan(own.alpha)
    length = own.roll_length(0.5 * diameter)
    x = (length - own.radius * math.sin(own.alpha_t)) * math.sin(own.alpha_t)
    edge = np.array([x, x * math.tan(own.alpha) - half])
    top = edge + 3.0 * own.module * np.array([1.0, math.tan(own.alpha)])
    middle = np.array([x, -0.5 * math.pi * own.module])
    return np.vstack((drawn(middle, edge), drawn(edge, top)))


def swept(own: Toothing, contour: Array, radii: Array) -> Array:
    """Half angles (J,) of the tooth at radii (J,) that the contour of a rack, rolled on the pitch circle, leaves."""
    x, y = contour[:, 0], contour[:, 1] / math.cos(own.beta)
    found = np.full(radii.shape, np.inf)
    for shift in np.linspace(-7.0 * own.module - 0.15 * own.radius, 7.0 * own.module + 0.15 * own.radius, POSITIONS):
        moved = y + shift
        rho, theta = np.hypot(own.radius + x, moved), np.arctan2(moved, own.radius + x) - shift / own.radius
        below, above = rho[:-1, None] - radii, rho[1:, None] - radii
        k, j = np.nonzero(below * above <= 0.0)
        share = below[k, j] / np.where(below[k, j] == above[k, j], 1.0, below[k, j] - above[k, j])
        np.minimum.at(found, j, -(theta[k] + share * (theta[k + 1] - theta[k])))
    return found


@pytest.mark.sweep
@pytest.mark.sweep_cases("semi_topping", "relieved", "barely")
@pytest.mark.parametrize("case", some(HOBS, 5))
def test_tooth_is_what_the_tools_leave_in_thousands_of_positions(case: str) -> None:
    teeth, hob, keys = HOBS[case]
    design = hobbed(teeth, hob, **keys)
    gears = gm.build(design)
    found = proportions(gears.design)
    own, root, tip = found.mesh.pinion, found.roots[0], found.tips[0]
    tooth = gears.members["pinion"].tooth
    sections = tooth.sections([0.5])
    regions = {Region.FILLET_RIGHT: (0.02, 1.0), Region.FLANK_RIGHT: (0.0, 0.98)}
    tip_corner, chamfer = tooth.right.tip_corner, None
    if tip_corner is not None:
        regions |= {Region.FLANK_RIGHT: (0.0, 1.0), Region.EDGE_RIGHT: (0.0, 0.98)}
        # where the hob has it follows from the diameter: what is looked at is that all is as it leaves it
        chamfer = tip_corner.surface.tool.profile.section(np.array(0.0))[0], math.radians(hob.get("chamfer_angle", 45))
        assert np.hypot(*tooth.grid(Region.FLANK_RIGHT, [1.0], sections).points[0, 0, :2]) == pytest.approx(
            0.5 * hob["chamfer_diameter"], abs=1e-11
        )
    places = [tooth.grid(region, np.linspace(*ends, 25), sections).points[:, 0, :2] for region, ends in regions.items()]
    r = np.vstack(places)
    rho, half = np.hypot(*r.T), -np.arctan2(r[:, 1], r[:, 0])
    inside = (rho > root + 1e-3) & (rho < tip)
    rounding = gears.design.pinion.tool_tip_radius * MODULE
    contour = hob_contour(own, root - own.radius, hob, rounding, chamfer)
    left = swept(own, contour, rho)
    if hob.get("finished", True):
        diameter = hob.get("finishing_diameter")
        if diameter is None:
            # the finishing tool ends in the relief, and reaches no fillet
            flank = np.arange(rho.size) // 25 == 1
            left[flank] = np.minimum(left[flank], [own.half_angle(each) for each in rho[flank]])
        else:
            finisher = finisher_contour(own, diameter)
            left = np.minimum(left, swept(own, finisher, rho))
            # along the tip plane of the finishing tool the radius does not change
            inside &= np.abs(rho - own.radius - finisher[0, 0]) > 0.01
    assert inside.sum() > 30
    # a sharp edge is nearest to a place in one position, and misses it by a part of the step in all others
    sharp = rounding == 0.0 or "finishing_diameter" in hob
    assert np.abs((half - left) * rho)[inside].max() < (4e-3 if sharp else 5e-5)


@pytest.mark.sweep
def test_a_tip_over_the_relief_of_a_protuberance_is_no_interference() -> None:
    """The fillet lies behind the flank: contact is lost there, and the exact surfaces have room."""
    teeth, hob, keys = HOBS["all"]
    gears = gm.build(hobbed(teeth, hob, width=10, **keys))
    fit = gears.contact().fit
    assert not fit.interference
    assert [text.partition(":")[2].partition(" begins")[0] for text in gears.sheet().warnings] == [
        " relief: the flank above what the protuberance cuts"
    ]


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("case", "size"), some([("relieved", 0.5), ("line_cut", 8.0), ("notch", 0.5), ("all", 0.5), ("all", 8.0)], 2)
)
def test_solid_contact_cad_and_elements_have_the_edge(case: str, size: float) -> None:
    teeth, hob, keys = HOBS[case]
    lengths = {key: value if key.endswith("angle") else value * size for key, value in hob.items()}
    keys = {**keys, "modifications": {"helix_crowning": 0.005 * size}} if case == "relieved" else keys
    design = hobbed(teeth, lengths, module=MODULE * size, width=10 * size, **keys)
    gears = gm.build(design)
    check = gears.check(0.004 * size)
    # a notch as high as this stands in the mating gear's way
    wrong = {each.what for each in check.verdicts if not each.ok}
    assert all(what.startswith(("fit", "sheet: interference")) for what in wrong) if case == "notch" else not wrong
    assert check.solids["pinion"].figures["max_deviation_um"] <= 4.0 * size
    assert contact_flank(gears.members["pinion"], Side.RIGHT).smooth == frozenset()
    model = gears.finite_elements().mesh
    assert scaled_jacobian(model.nodes, model.elements).min() > 0.3
    member = gears.members["pinion"]
    assert volume(solid_part(member, spline_tooth(member.tooth))) == pytest.approx(exact_volume(member), rel=1e-6)


@pytest.mark.sweep
@pytest.mark.sweep_cases("line_cut")
@pytest.mark.parametrize("case", ["line_cut", "line_helical"])
def test_form_diameter_of_the_sheet_is_where_the_hob_passes_the_involute(case: str) -> None:
    teeth, hob, keys = HOBS[case]
    gears = gm.build(hobbed(teeth, hob, **keys))
    found = proportions(gears.design)
    own = found.mesh.pinion
    sheet = gears.sheet()
    rows = {key: sheet.plain_tables[table.title][key][1:] for table in sheet.tables for key in table.symbols}
    radii = 0.5 * rows["d_Ff"][0] + np.array([-0.002, 0.002])
    contour = hob_contour(own, found.roots[0] - own.radius, hob, gears.design.pinion.tool_tip_radius * MODULE)
    below, above = swept(own, contour, radii) - [own.half_angle(each) for each in radii]
    assert below < 0.0 < above
    assert rows["eps_alpha"][0] == pytest.approx(gears.contact().summary["transverse_contact_ratio"], abs=1e-8)
    assert gears.limits().limits["pinion"].fewest_teeth is None


def test_as_much_protuberance_as_stock_leaves_the_plain_tooth() -> None:
    plain, even = (gm.build(hobbed(20, hob)) for hob in (None, {"stock": 0.1, "protuberance": 0.1}))
    first, second = (gears.solid("pinion", 0.01).mesh.vertices for gears in (plain, even))
    assert np.array_equal(first, second)


@pytest.mark.parametrize(
    ("hob", "keys", "message"),
    [
        ({"stock": 0.1}, {}, "pinion.hob.stock = 0.1 mm: the finishing tool cuts below the protuberance, 0;"),
        (
            {"stock": 0.1, "finishing_diameter": 30.0},
            {},
            "pinion.hob.finishing_diameter = 30 mm: allowed is above 37.58",
        ),
        (
            {"protuberance": 0.1, "protuberance_angle": 20},
            {},
            "allowed is less than the pressure angle, 20 deg",
        ),
        ({"protuberance": 0.3, "protuberance_angle": 18}, {}, "its line of 18 deg is longer than the flank"),
        ({"chamfer_diameter": 45.0}, {}, "pinion.hob.chamfer_diameter = 45 mm: allowed is between"),
        ({"chamfer_diameter": 40.0, "chamfer_angle": 70}, {}, "the chamfers leave no land"),
        ({"chamfer_diameter": 43.0, "chamfer_angle": 20}, {}, "pinion.hob.chamfer_angle = 20 deg: allowed is more"),
        ({"chamfer_angle": 30}, {}, "pinion.hob.chamfer_angle = 30 deg: needs a chamfer_diameter"),
        ({"chamfer_diameter": 43.0}, {"tip_chamfer": 0.1}, "pinion.tip_chamfer = 0.1 mm: cannot be given together"),
        ({"protuberance_angle": 5}, {}, "pinion.hob.protuberance_angle = 5 deg: needs a protuberance"),
        ({"protuberance": 0.1, "finishing_diameter": 38.0}, {}, "pinion.hob.finishing_diameter = 38 mm: needs a stock"),
        ({"protuberance": 0.1}, {"shaper": {"teeth": 20}}, "pinion.hob: cannot be given together with shaper"),
    ],
)
@pytest.mark.sweep_cases(
    "hob3-keys3-its line of 18 deg is longer than the flank",
    "hob5-keys5-the chamfers leave no land",
    "hob2-keys2-allowed is less than the pressure angle, 20 deg",
)
def test_refused_in_one_line(hob: dict[str, Any], keys: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError) as refused:
        gm.build(hobbed(20, hob, **keys))
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.sweep
def test_limits_say_that_undercut_is_hidden_behind_a_relief() -> None:
    """Ten teeth are undercut by the rounding alone, as the sheet says; where a protuberance relieves flanks it cannot be seen."""
    for hob, told in (
        (None, "is undercut from"),
        ({"protuberance": 0.1, "stock": 0.05}, "begin at a sharp edge"),
    ):
        gears = gm.build(hobbed(10, hob))
        own = [line for line in gears.limits().warnings if "pinion" in line]
        assert own
        assert all(told in line for line in own)
        reserve = next(table for table in gears.sheet().tables if "undercut" in table.symbols)
        assert reserve.rows[reserve.symbols.index("undercut")][2] < 0.0
    begins = (
        gm.build(hobbed(10, {"protuberance": 0.1, "stock": 0.05})).limits().document()["members"]["pinion"]["sides"]
    )
    assert f"of diameter {begins['right']['flank_from_diameter_mm'][2]:.6g} mm" in own[0]
