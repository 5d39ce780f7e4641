"""The sheet of worm drives: hand-made figures, wires against closed form and brute force, forces, contact lines of the solver."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, minimize, minimize_scalar

import gearmesh as gm
from gearmesh import DesignError, WormDriveDesign
from gearmesh.contact.flanks import separation_curvatures
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.solid import prove
from gearmesh.systems.worm_drive.build import worm_thread
from gearmesh.systems.worm_drive.force_tables import pair_forces, thread_mesh
from gearmesh.systems.worm_drive.load_parameters import field
from gearmesh.systems.worm_drive.sheet import effective_width

TORQUE, SPEED = 100.0, 1500.0


def gears_of(**more: Any) -> gm.Gears:
    """a = 125, i = 38 / 2; keys of members are added to theirs."""
    keys: dict[str, Any] = {"kind": "worm_drive", "module": 5, "center_distance": 125}
    keys |= {"worm": {"threads": 2, "reference_diameter": 60, "length": 100}, "wheel": {"teeth": 38}}
    for name, value in more.items():
        keys[name] = {**keys.get(name, {}), **value} if isinstance(value, dict) else value
    return gm.build(gm.parse(keys))


def sheet_of(gears: gm.Gears) -> dict[str, Any]:
    """Symbol -> values of the rows of the sheet, those of one column alone."""
    rows = {}
    for table in gears.sheet().tables:
        for symbol, row in zip(table.symbols, table.rows, strict=False):
            rows.setdefault(symbol, row[2:] if len(row) > 3 else row[2])
    return rows


def own_of(gears: gm.Gears) -> WormDriveDesign:
    design = gears.design
    assert isinstance(design, WormDriveDesign)
    return design.in_mm()


@pytest.mark.sweep
def test_figures_are_those_of_the_hand() -> None:
    """d1 = 60, q = 12, gamma = atan(1/6), x2 = 0.2 by a = 126; a hob of 66 mm, 3 mm farther away: 1 mm over the reference cylinders
    it has the worm's normal pitch, sin(gamma_w0) = m_x cos(gamma_w) z / (d0 + 2)."""
    sheet = sheet_of(gears_of(center_distance=126, backlash=0.1, friction=0.05, hob={"reference_diameter": 66}))
    gamma, alpha = math.atan(1.0 / 6.0), math.radians(20.0)
    normal = 5.0 * math.cos(gamma)
    assert (sheet["q"], sheet["i"], sheet["m_x"]) == (12.0, 19.0, 5.0)
    assert sheet["gamma_m"] == pytest.approx(math.degrees(gamma), abs=1e-8)
    assert sheet["m_n"] == pytest.approx(normal, abs=1e-8)
    assert sheet["p_x"][0] * 2 == pytest.approx(sheet["p_z"][0]) == pytest.approx(10.0 * math.pi)
    assert sheet["d"] == pytest.approx((60.0, 190.0))
    assert sheet["d_m"] == pytest.approx((60.0, 192.0))
    assert sheet["d_a"] == pytest.approx((70.0, 202.0))
    assert sheet["d_f"] == pytest.approx((48.0, 2.0 * (129.0 - 39.0)))
    assert sheet["d_e"][1] == pytest.approx(207.0)
    assert sheet["c"] == pytest.approx((126.0 - 35.0 - 90.0, 126.0 - 24.0 - 101.0))
    base = 60.0 * math.cos(math.atan(math.tan(alpha) / math.sin(gamma)))
    assert sheet["d_b"][0] == pytest.approx(base, abs=1e-8)
    flat = math.atan(5.0 / 31.0)
    steep = math.asin(5.0 * math.cos(flat) * 2.0 / 68.0)
    module = 5.0 * math.cos(flat) / math.cos(steep)
    assert (sheet["h_w0"], sheet["m_x0"]) == pytest.approx((1.0, module), abs=1e-8)
    assert sheet["eta_0"] == pytest.approx(math.degrees(steep - flat), abs=1e-8)
    assert sheet["gamma_0"] == pytest.approx(math.degrees(math.atan(module / 33.0)), abs=1e-8)
    assert (sheet["a_0"], sheet["d_a0"]) == pytest.approx((129.0, 78.0))
    thin = 0.1 / (math.cos(gamma) * math.cos(alpha))
    assert sheet["s_mx"] == pytest.approx(2.5 * math.pi - thin, abs=1e-8)
    assert sheet["j_phi2"] == pytest.approx(math.degrees(thin / 95.0), abs=1e-8)
    assert sheet["mu_s"] == pytest.approx(math.tan(gamma) * math.cos(alpha), abs=1e-8)
    assert sheet["v_g / n_1"] == pytest.approx(60.0 * math.pi / 60000.0 / math.cos(gamma), abs=1e-8)
    # x2 moves the point of contact out of the common perpendicular; without it this is tan(gamma) / tan(gamma + rho)
    assert sheet_of(gears_of(friction=0.05))["eta"] == pytest.approx(
        math.tan(gamma) / math.tan(gamma + math.atan(0.05 / math.cos(alpha))), abs=1e-8
    )


@pytest.mark.sweep
def test_za_worm_and_larger_hob_match_hand_calculation() -> None:
    """tan(alpha_n) = tan(alpha_0) cos(gamma); a hob of 3 threads. In the middle plane a rack of 20 deg meets an involute gear."""
    keys: dict[str, Any] = {"worm": {"form": "ZA"}, "backlash": 0.1, "friction": 0.05}
    sheet = sheet_of(gears_of(**keys, hob={"reference_diameter": 90, "threads": 3}))
    gamma, alpha = math.atan(1.0 / 6.0), math.radians(20.0)
    normal, own = 5.0 * math.cos(gamma), math.atan(math.tan(alpha) * math.cos(gamma))
    steep = math.asin(normal * 3.0 / 90.0)
    rho, shift = math.atan(0.05 / math.cos(own)), 0.1 / (math.cos(gamma) * math.cos(own))
    thick = 2.5 * math.pi - shift
    expected: dict[str, tuple[float, ...]] = {
        "a": (125.0,),
        "Sigma": (90.0,),
        "alpha_0": (20.0,),
        "alpha_n": (math.degrees(own),),
        "h_am": (5.0, 5.0),
        "h_fm": (6.0,),
        "x_2": (0.0,),
        "r_k": (125.0 - 0.5 * 200.0,),
        "b": (100.0, 10.0 * (math.sqrt(13.0) + 0.5)),
        "b_H": (10.0 * (math.sqrt(13.0) + 0.5),),
        "s_mx": (thick,),
        "e_mx": (5.0 * math.pi - thick,),
        "s_mn": (thick * math.cos(gamma),),
        "e_mn": ((5.0 * math.pi - thick) * math.cos(gamma),),
        "z_0": (3.0,),
        "m_x0": (normal / math.cos(steep),),
        "d_0": (90.0,),
        "s_mx0": (0.5 * math.pi * normal / math.cos(steep),),
        "eta_0": (math.degrees(steep - gamma),),
        "j_n": (0.1,),
        "j_x": (shift,),
        "j_t2": (shift,),
        "j_phi1": (math.degrees(shift / 5.0),),
        "rho_s": (math.degrees(math.atan(math.tan(gamma) * math.cos(own))),),
        "mu": (0.05,),
        "rho_z": (math.degrees(rho),),
        "eta'": (math.tan(gamma - rho) / math.tan(gamma),),
    }
    base = 95.0 * math.cos(alpha)
    path = math.sqrt(100.0**2 - base**2) - 95.0 * math.sin(alpha) + 5.0 / math.sin(alpha)
    expected["eps_alpha"] = (path / (5.0 * math.pi * math.cos(alpha)),)
    for symbol, values in expected.items():
        shown = sheet[symbol] if isinstance(sheet[symbol], tuple) else (sheet[symbol],)
        given = [value for value in shown if value is not None]
        assert given == pytest.approx(values, abs=1e-8), symbol
    # less where the worm's tip cylinder leaves the wheel's outside cylinder inside the face: 3, 4, 5
    assert effective_width(35.0, 28.0) == pytest.approx(42.0)
    # with more friction than tan(gamma) cos(alpha_n) the wheel does not drive
    assert sheet_of(gears_of(**{**keys, "friction": 0.17}))["eta'"] is None


@pytest.mark.sweep
def test_angular_backlash_is_the_way_from_flank_to_flank() -> None:
    """Threads of the other flank's contact are an axial way j_x away where those without backlash are not."""
    ways = []
    for backlash in (0.0, 0.1):
        made = [gears_of(backlash=backlash, contact={"flank": flank}) for flank in ("right", "left")]
        first, second = (thread_mesh(own_of(gears)).at_reference() for gears in made)
        ways.append(second.shift - first.shift)
    sheet = sheet_of(made[0])
    assert abs(ways[1] - ways[0]) == pytest.approx(sheet["j_x"], abs=1e-9)


@pytest.mark.sweep
def test_wires_are_the_balls_of_a_helical_gear() -> None:
    """ZI: inv(alpha_K) = inv(alpha_t) + D / (z m_n cos(alpha_n)) - half the angle of the thread's thickness, of z = 2."""
    made = gears_of(backlash=0.2, worm={"wire_diameter": 8.3, "right_hand": False})
    sheet, gamma, alpha = sheet_of(made), math.atan(1.0 / 6.0), math.radians(20.0)
    transverse = math.atan(math.tan(alpha) / math.sin(gamma))
    space = (5.0 * math.pi - sheet["s_mx"]) / 10.0
    angle = math.tan(transverse) - transverse - space
    angle += 8.3 / (2.0 * 5.0 * math.cos(gamma) * math.cos(alpha))
    at = brentq(lambda a: math.tan(a) - a - angle, 0.1, 1.55, xtol=1e-15)
    assert sheet["M_d"] == pytest.approx(60.0 * math.cos(transverse) / math.cos(at) + 8.3, abs=1e-8)
    with pytest.raises(DesignError, match=r"worm\.wire_diameter = 3 mm: .*allowed is from 7"):
        gears_of(worm={"wire_diameter": 3.0}).sheet()


@pytest.mark.sweep
def test_a_wire_lies_in_the_space_of_a_za_worm() -> None:
    """Brute force: the ball at the wire's centre is as near to the flank as its radius. A wire that is free to turn and lies as
    low as it can has the same height, at about the lead angle."""
    made = gears_of(worm={"form": "ZA", "threads": 4})
    sheet, thread = sheet_of(made), worm_thread(own_of(made))
    half = 0.5 * sheet["D_M"]
    centre = np.array([0.5 * (sheet["M_d"] - sheet["D_M"]), 0.0, 0.5 * thread.axial_pitch])
    flank = thread.flank(1)

    def away(x: Array) -> float:
        return float(np.linalg.norm(flank.jet(np.array(x[0]), np.array(x[1])).r - centre))

    nearest = minimize(away, [0.0, 0.0], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-13})
    assert nearest.fun == pytest.approx(half, abs=1e-8)
    p, v = np.meshgrid(np.linspace(-4.0, 4.0, 801), np.linspace(-0.4, 0.4, 801), indexing="ij")
    r = flank.jet(p, v).r - [0.0, 0.0, centre[2]]

    def height(tilt: float) -> float:
        """Height, mm, of the wire's axis over the worm's axis at which the wire just clears all points of the flank."""
        beside = -np.sin(tilt) * r[..., 1] + np.cos(tilt) * r[..., 2]
        return float((r[..., 0] + np.sqrt(np.maximum(half**2 - beside**2, 0.0)))[np.abs(beside) < half].max())

    lowest = minimize_scalar(height, bounds=(0.5 * thread.lead_angle, 2.0 * thread.lead_angle), method="bounded")
    assert lowest.fun == pytest.approx(centre[0], abs=1e-4)


@pytest.mark.parametrize(("hand", "flank"), [(True, "right"), (True, "left"), (False, "right"), (False, "left")])
@pytest.mark.sweep_cases("False-left", "False-right", "True-right")
def test_forces_are_those_of_the_exact_normals(hand: bool, flank: str) -> None:
    """An involute worm and an oversized hob: every point of contact has the same normal, that of the pitch point."""
    gears = gears_of(worm={"right_hand": hand}, hob={"reference_diameter": 63}, contact={"flank": flank})
    (table,) = pair_forces(own_of(gears), TORQUE, SPEED)
    rows = {symbol: row[2:] for symbol, row in zip(table.symbols, table.rows, strict=True)}
    path = gears.contact(np.linspace(-3.0, 3.0, 7), cycle=False).path
    on_flanks = path.kind == "point"
    assert on_flanks.sum() >= 2
    first, second = gears.pairs[0].mounts
    between = np.array([1.0, 0.0, 0.0])
    for point, normal in zip(path.point[on_flanks], -path.normal[on_flanks], strict=True):
        force = normal * 1e3 * TORQUE / abs(np.cross(point - first.origin, normal) @ first.axis)
        for k, (sign, mount) in enumerate(((1.0, first), (-1.0, second))):
            on = sign * force
            assert abs(on @ np.cross(mount.axis, between)) == pytest.approx(rows["F_t"][k], rel=1e-9)
            assert on @ mount.axis == pytest.approx(rows["F_a"][k], rel=1e-9)
            assert -sign * (on @ between) == pytest.approx(rows["F_r"][k], rel=1e-9)
        assert np.linalg.norm(force) == pytest.approx(rows["F_n"][0], rel=1e-9)
        moment = np.cross(point - second.origin, -force) @ second.axis
        assert abs(moment) == pytest.approx(1e3 * rows["T"][1], rel=1e-9)


@pytest.mark.parametrize(("friction", "flank"), [(None, "right"), (0.06, "right"), (0.06, "left")])
@pytest.mark.sweep_cases("0.06-right", "None-right")
def test_what_goes_in_comes_out_or_slides(friction: float | None, flank: str) -> None:
    """ZK, profile shift, axes at 80 deg: the moments of the forces have the ratio's power, but for friction along the sliding."""
    worm = {"form": "ZK", "right_hand": False}
    gears = gears_of(worm=worm, center_distance=127, shaft_angle=80, friction=friction, contact={"flank": flank})
    (table,) = pair_forces(own_of(gears), TORQUE, SPEED)
    rows = {symbol: row[2:] for symbol, row in zip(table.symbols, table.rows, strict=True)}
    lost = 1e-3 * (friction or 0.0) * rows["F_n"][0] * rows["v_g"][0]
    turning = SPEED * math.pi / 3e4
    assert min(rows["F_n"]) > 0.0
    assert rows["T"][1] * turning / 19.0 + lost == pytest.approx(TORQUE * turning, rel=1e-9)
    assert rows["P"] == pytest.approx((TORQUE * turning, TORQUE * turning - lost), rel=1e-9)


@pytest.mark.parametrize("form", ["ZI", "ZK"])
@pytest.mark.sweep_cases("ZK")
def test_contact_lines_are_those_of_the_solver(form: str) -> None:
    """Place, normal and curvature of the gap, from both built surfaces, and the weight of a line."""
    gears = gears_of(worm={"form": form}, center_distance=126)
    own = own_of(gears)
    path = gears.contact(np.linspace(-4.0, 4.0, 17), cycle=False).path
    on = path.kind == "line"
    assert on.sum() >= 5
    mesh = thread_mesh(own)
    angle = np.arctan2(path.point[on, 1], path.point[on, 0])
    at = mesh.at(path.params1[on, 0], angle)
    np.testing.assert_allclose(at.r, path.point[on], rtol=0, atol=1e-9)
    np.testing.assert_allclose(at.n, path.normal[on], rtol=0, atol=1e-9)
    kappa = separation_curvatures(gears.pairs[0], path)[on]
    np.testing.assert_allclose(at.curvature, kappa[:, 1], rtol=1e-6)
    # the field has a line's length by the way of a thread that slides: the gradient of the shift on its flank
    p, step = path.params1[on, 0], 1e-5
    ends = [(mesh.at(p + step, angle), mesh.at(p - step, angle)), (mesh.at(p, angle + step), mesh.at(p, angle - step))]
    way = np.array([[0.0, 0.0, 1.0]])
    along = np.stack([(a.r - a.shift[:, None] * way - b.r + b.shift[:, None] * way) / (2.0 * step) for a, b in ends], 1)
    rise = np.stack([(a.shift - b.shift) / (2.0 * step) for a, b in ends], 1)
    slope = np.einsum("pk,pkx->px", np.linalg.solve(along @ along.mT, rise[..., None])[..., 0], along)
    rate = mesh.thread.screw * np.linalg.norm(at.b, axis=-1) / np.abs(at.over_thread)
    np.testing.assert_allclose(np.linalg.norm(slope, axis=-1), rate, rtol=1e-6)
    tip = gears.members["wheel"].tooth.blank.tip
    coarse, fine = (float(field(own, tip, grid)[1].sum()) for grid in ((41, 81), (81, 161)))
    assert coarse == pytest.approx(fine, rel=1e-3)


@pytest.mark.sweep
@pytest.mark.parametrize(("threads", "form"), [(7, "ZA"), (8, "ZN"), (9, "ZK"), (10, "ZI")])
def test_worms_of_seven_to_ten_threads(threads: int, form: str) -> None:
    """Lines of contact, no transmission error, a lead angle of 30 deg, solids, and the power that goes in comes out."""
    worm = {"threads": threads, "form": form, "lead_angle": 30, "length": 80}
    keys = {"kind": "worm_drive", "module": 5, "backlash": 0.1, "worm": worm, "wheel": {"teeth": 41}}
    gears = gm.build(gm.parse(keys))
    sheet = sheet_of(gears)
    assert sheet["z"] == (threads, 41)
    assert sheet["d"][0] == pytest.approx(5.0 * threads / math.tan(math.radians(30.0)))
    assert sheet["p_z"][0] == pytest.approx(5.0 * math.pi * threads)
    path = gears.contact(np.linspace(-1.0, 1.0, 5), cycle=False).path
    assert (path.kind == "line").all()
    assert np.abs(path.te).max() < 1e-9
    (table,) = pair_forces(own_of(gears), TORQUE, SPEED)
    rows = {symbol: row[2:] for symbol, row in zip(table.symbols, table.rows, strict=True)}
    assert rows["T"][1] == pytest.approx(TORQUE * 41 / threads, rel=1e-9)
    for name in gears.members:
        assert prove(gears.solid(name, 0.05).mesh, 1).ok
