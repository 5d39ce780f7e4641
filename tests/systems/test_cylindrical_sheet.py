"""The data sheet of cylindrical gears: every figure by its formula and measured, with planes, balls and chords on the surfaces."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles import measuring
from oracles.command_line import refused, run
from oracles.examples import in_turn
from oracles.iso6336 import Hobbed

import gearmesh as gm
from gearmesh.contact.fit.fit import fit
from gearmesh.systems.cylindrical.geometry.line_of_action import form_roll_length
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.teeth.blank.moments import member_moments

#: mm and rad: the sheet has nine decimals
EXACT = 1e-9

THIN = {"thickness_allowance": {"upper": -0.05, "lower": -0.09}}
PAIRS: dict[str, dict[str, Any]] = {
    "spur": {},
    "spur_shifted": {"pinion": {"profile_shift": 0.3, **THIN}, "assembly": {"center_distance": 64}},
    "helical_right": {"helix_angle": 15, "pinion": {"teeth": 17}, "gear": {"teeth": 45}},
    "helical_left": {
        "helix_angle": 25,
        "hand": "left",
        "pinion": {"profile_shift": 0.4, **THIN},
        "gear": {"profile_shift": -0.1, "teeth": 46, **THIN},
    },
    "internal_spur": {"gear": {"teeth": -60, "profile_shift": 0.1}},
    "internal_helical": {"helix_angle": 20, "gear": {"teeth": -61, **THIN}},
    "internal_pinion": {"helix_angle": 12, "hand": "left", "pinion": {"teeth": -57}, "gear": {"teeth": 20}},
    "formed": {"helix_angle": 18, "hand": "left", "gear": {"teeth": -62, "manufacture": "formed", **THIN}},
    "shaped": {"helix_angle": 12, "pinion": {"shaper": {"teeth": 25}, "profile_shift": 0.3}},
}


def design_of(name: str, **more: Any) -> gm.Design:
    keys: dict[str, Any] = {"kind": "cylindrical", "module": 2, **PAIRS[name], **more}
    for member, teeth in (("pinion", 18), ("gear", 45)):
        keys[member] = {"teeth": teeth, "face_width": 20, **keys.get(member, {})}
    return gm.parse(keys)


def sheet_of(gears: gm.Gears) -> dict[str, list[Any]]:
    """Symbol -> values, of all tables that have symbols."""
    sheet = gears.sheet()
    return {key: sheet.plain_tables[table.title][key][1:] for table in sheet.tables for key in table.symbols}


@pytest.mark.sweep
@pytest.mark.sweep_cases("spur_shifted", "internal_helical", "spur", "helical_right", "internal_spur")
@pytest.mark.parametrize("name", PAIRS)
def test_measures_are_those_of_the_exact_surfaces(name: str) -> None:
    gears = gm.build(design_of(name))
    sheet, mesh = sheet_of(gears), proportions(gears.design).mesh
    for k, member in enumerate(gears.members.values()):
        own = {symbol: values[k] for symbol, values in sheet.items() if len(values) == 2}
        sense, beta = int(np.sign(own["z"])), math.radians(sheet["beta"][0])
        assert member.tooth.teeth == abs(own["z"])
        base, lead = measuring.base(member)
        assert 2.0 * base == pytest.approx(own["d_b"], abs=EXACT)
        assert abs(lead) == pytest.approx(math.radians(sheet["beta_b"][0]), abs=EXACT)
        assert own["hand"] == ("spur" if not beta else "right" if (mesh.pinion, mesh.gear)[k].beta > 0.0 else "left")
        # thickness
        assert measuring.arc(member, own["d"] / 2) == pytest.approx(own["s_t"], abs=EXACT)
        assert own["s_t"] * math.cos(beta) == pytest.approx(own["s_n"], abs=EXACT)
        slope = math.tan(beta) * own["d_a"] / own["d"]
        assert measuring.arc(member, own["d_a"] / 2) / math.hypot(1.0, slope) == pytest.approx(own["s_an"], abs=EXACT)
        # span: flat anvils cannot touch hollow flanks
        if beta and sense < 0:
            assert own["W_k"] is None
        else:
            assert measuring.span(member, own["k_W"], sense) == pytest.approx(own["W_k"], abs=EXACT)
        # balls and pins
        centre, touch = measuring.ball(member, own["D_M"])
        assert 2.0 * np.hypot(*centre[:2]) == pytest.approx(own["d_K"], abs=EXACT)
        assert 2.0 * np.hypot(*touch[:2]) == pytest.approx(own["d_M"], abs=EXACT)
        assert sorted((own["d_Ff"], own["d_M"], own["d_Fa"]))[1] == own["d_M"]
        assert measuring.over_balls(member, own["D_M"], sense) == pytest.approx(own["M_dK"], abs=EXACT)
        if not beta:
            assert own["M_dR"] == own["M_dK"]
        elif sense > 0:
            twist = (mesh.pinion, mesh.gear)[k].twist
            assert measuring.over_pins(member, own["D_M"], twist) == pytest.approx(own["M_dR"], abs=EXACT)
        else:
            assert own["M_dR"] is None
        # chords
        for symbol, height, measured in (
            ("s_c", "h_c", measuring.constant_chord(member, own["d"] / 2)),
            ("s_nc", "h_nc", measuring.chord(member, own["d"] / 2)),
        ):
            assert measured[0] == pytest.approx(own[symbol], abs=EXACT)
            assert sense * (own["d_a"] / 2 - measured[1]) == pytest.approx(own[height], abs=EXACT)
        # where the flank begins: read off the teeth, and the tool's form point
        form_point = form_roll_length(proportions(gears.design).gear(member.name))
        assert 2.0 * math.hypot(base, form_point) == pytest.approx(own["d_Ff"], abs=EXACT)


@pytest.mark.sweep
@pytest.mark.sweep_cases("internal_helical", "helical_left")
@pytest.mark.parametrize("name", ["spur_shifted", "helical_left", "internal_spur", "internal_helical"])
def test_backlash_contact_and_clearance_are_those_of_the_contact_solver(name: str) -> None:
    gears = gm.build(design_of(name))
    sheet, found = sheet_of(gears), gears.contact().summary
    assert sheet["eps_alpha"][0] == pytest.approx(found["transverse_contact_ratio"], abs=1e-8)
    assert sheet["eps_beta"][0] == pytest.approx(found["overlap_ratio"], abs=1e-8)
    assert sheet["j_bn"][1] == pytest.approx(found["backlash_normal_min_mm"], abs=1e-8)
    assert sheet["j_wt"][1] == pytest.approx(found["backlash_transverse_min_mm"], abs=1e-8)
    # those are measured on a grid of the tips
    assert sheet["c"] == pytest.approx([found[f"tip_clearance_{member}_mm"] for member in gears.members], abs=1e-5)
    # theoretical, working, least, largest: with nominal teeth, as made, with the upper and with the lower allowances
    theoretical, working, *ends = sheet["j_bn"]
    assert theoretical == pytest.approx(0.0, abs=EXACT) or name == "spur_shifted"
    assert (not ends and working == theoretical) or ends[0] < working < ends[1]
    # at the centre distance less j_r nothing is left
    own = gears.design.resolve()
    away = -sheet["j_r"][1] if "internal" not in name else sheet["j_r"][1]
    own["assembly"]["center_distance"] = sheet["a"][0] + away
    assert sheet_of(gm.build(gm.parse(own)))["j_bn"][1] == pytest.approx(0.0, abs=1e-8)


#: few teeth, undercut: where mating gears' tips reach below the root form circle the contact ends at the edge of the undercut
UNDERCUT: dict[str, dict[str, Any]] = {
    "pinion": {"helix_angle": 20, "pinion": {"teeth": 9}, "gear": {"teeth": 30}},
    "gear": {
        "helix_angle": 11.64998407145476,
        "hand": "left",
        "pinion": {"teeth": 42, "face_width": 8.6275, "profile_shift": -0.00407},
        "gear": {"teeth": 14, "face_width": 19.0913, "profile_shift": -0.02927},
    },
    "near_the_base_circle": {
        "helix_angle": 26.8,
        "pinion": {"teeth": 7, "face_width": 12, "profile_shift": 0.316},
        "gear": {"teeth": 53, "profile_shift": -0.144},
    },
    "both": {"helix_angle": 16.3, "pinion": {"teeth": 7, "face_width": 12}, "gear": {"teeth": 9}},
    "spur": {"pinion": {"teeth": 9}, "gear": {"teeth": 30}},
}


@pytest.mark.sweep
@pytest.mark.sweep_cases("near_the_base_circle-right", "spur-right", "pinion-right", "gear-left")
@pytest.mark.parametrize(("name", "flank"), in_turn(UNDERCUT, ["right", "left"]))
def test_contact_ratios_of_undercut_pairs_are_those_of_the_contact_solver(name: str, flank: str) -> None:
    keys = {**UNDERCUT[name], "backlash": 0.05, "contact": {"flank": flank}}
    gears = gm.build(design_of("spur", **keys))
    sheet, summary = sheet_of(gears), gears.contact().summary
    names = {"eps_alpha": "transverse_contact_ratio", "eps_beta": "overlap_ratio", "eps_gamma": "contact_ratio"}
    for symbol, key in names.items():
        assert summary[key] == pytest.approx(sheet[symbol][0], abs=2.0 * EXACT), symbol


@pytest.mark.sweep
@pytest.mark.sweep_cases("internal_spur")
@pytest.mark.parametrize("name", ["spur_shifted", "internal_spur"])
def test_specific_sliding_is_what_the_points_of_contact_do_on_the_flanks(name: str) -> None:
    """The contact solver's points, in the frames of the members, moved by a little: how far they go on either flank."""
    gears = gm.build(design_of(name))
    sheet = sheet_of(gears)
    ends = gears.contact().summary["engagement_phi1_deg"]
    # a little inside the path of contact, positions a little apart (deg)
    for point, positions in (("A", ends[0] + np.array([1e-4, 3e-4])), ("E", ends[1] - np.array([1e-4, 3e-4]))):
        path = gears.contact(positions, cycle=False).path
        for points, diameter in zip((path.point1, path.point2), sheet[f"d_{point}"], strict=True):
            assert 2.0 * np.hypot(*points[0, :2]) == pytest.approx(diameter, abs=1e-4)
        first, second = (float(np.linalg.norm(np.diff(points, axis=0))) for points in (path.point1, path.point2))
        assert [1.0 - second / first, 1.0 - first / second] == pytest.approx(sheet[f"zeta_{point}"], abs=1e-3, rel=1e-3)


@pytest.mark.sweep_cases(
    "internal_helical",
    "internal_spur",
    "formed",
    "helical_left",
    "helical_right",
    "internal_pinion",
    "shaped",
    "spur_shifted",
)
@pytest.mark.parametrize("name", PAIRS)
def test_the_root_is_that_of_the_generated_fillet(name: str) -> None:
    """Compare root dimensions with points of the fillet alone; for a hobbed external spur gear also with ISO 6336-3, to which
    helical gears come near."""
    gears = gm.build(design_of(name))
    sheet, found = sheet_of(gears), proportions(gears.design)
    for k, (member, teeth) in enumerate(zip(gears.members.values(), (found.mesh.pinion, found.mesh.gear), strict=True)):
        own = {symbol: sheet[symbol][k] for symbol in ("s_Fn", "h_F", "rho_F", "d_F", "d_Na", "d")}
        angle = math.radians(60.0 if teeth.internal else 30.0)
        chord, radius, rounding = measuring.fillet_tangent(member, teeth.beta, angle)
        assert [own["s_Fn"], own["d_F"] / 2] == pytest.approx([chord, radius], abs=2e-6)
        assert own["rho_F"] == pytest.approx(rounding, rel=1e-5)
        spec = getattr(gears.design, member.name)
        if not spec.hobbed:
            continue
        m = teeth.module
        hob = Hobbed(
            teeth=spec.teeth,
            alpha=teeth.alpha,
            beta=teeth.beta,
            shift=spec.profile_shift,
            dedendum=spec.dedendum,
            rounding=spec.tool_tip_radius,
            allowance=teeth.allowance / m,
        )
        lever = m * hob.lever(own["d_Na"] / m, own["d"] / m, sheet["eps_alpha"][0])
        # the normal section of a helical tooth is that of its virtual gear to a fraction of a per cent
        near = {"abs": 1e-9} if teeth.beta == 0.0 else {"rel": 5e-3}
        assert [own["s_Fn"], own["rho_F"]] == pytest.approx([m * each for each in hob.root()[:2]], **near)
        assert own["h_F"] == pytest.approx(lever, **near)


@pytest.mark.sweep
def test_undercut_and_interference_have_negative_reserves_and_sound_teeth_have_them() -> None:
    sound = sheet_of(gm.build(design_of("spur")))
    assert min(*sound["undercut"], *sound["interference"]) > 0.0
    undercut = gm.build(design_of("spur", pinion={"teeth": 10}))
    sheet = sheet_of(undercut)
    assert sheet["undercut"][0] < 0.0 < sheet["undercut"][1]
    # the least profile shift of a hob: h_fP - rho_fP (1 - sin) - z sin^2 / 2, in modules
    least = 1.25 - 0.38 * (1.0 - math.sin(math.radians(20))) - 5.0 * math.sin(math.radians(20)) ** 2
    just = sheet_of(gm.build(design_of("spur", pinion={"teeth": 10, "profile_shift": least})))
    assert just["undercut"][0] == pytest.approx(0.0, abs=EXACT)
    # what undercut leaves of the flank begins beyond the base circle
    assert sheet["d_Ff"][0] > sheet["d_b"][0] + 0.1
    # what the gear's tip does not meet then, and how much shift brings it back; no tip is in the fillet
    (warned,) = undercut.sheet().warnings
    assert warned.startswith(
        f"pinion: undercut: the flank begins {-sheet['interference'][0]:.4g} mm of roll length beyond"
    )
    assert float(re.search(r"profile_shift of at least (\S+) avoids", warned)[1]) == pytest.approx(least, abs=2e-6)
    assert undercut.contact().summary["interference_um"] == 0.0
    # a gear whose long addendum reaches below the pinion's flank
    long = gm.build(design_of("spur", gear={"teeth": 90, "addendum": 1.15}))
    assert sheet_of(long)["interference"][0] < 0.0 < sheet_of(long)["interference"][1]
    assert "pinion: interference: the gear's tip reaches" in long.sheet().warnings[0]
    # tips of a ring that pass the mating gear's, or do not: what the train is warned of
    for teeth, clears in ((50, True), (54, False)):
        gears = gm.build(design_of("spur", pinion={"teeth": teeth}, gear={"teeth": -60}))
        assert (sheet_of(gears)["trochoid"][1] > 0.0) == clears
        assert any("trochoid" in line for line in gears.warnings) != clears
    # a ring whose tip is near the end of what its cutter's involute generates
    ring = gm.build(design_of("internal_spur"))
    reserve = sheet_of(ring)["undercut"][1]
    tip = sheet_of(ring)["d_a"][1] / 2
    base = sheet_of(ring)["d_b"][1] / 2
    least_tip = math.hypot(base, math.sqrt(tip**2 - base**2) - reserve)
    keys = {"teeth": -60, "profile_shift": 0.1, "shaper": {"teeth": 24}}
    near = design_of("internal_spur", gear={**keys, "tip_diameter": 2.0 * least_tip + 1e-3}, pinion={"addendum": 0.5})
    assert gm.build(near).members["gear"].tooth.teeth == 60
    with pytest.raises(gm.DesignError, match="generates no involute up to the tip"):
        gm.build(design_of("internal_spur", gear={**keys, "tip_diameter": 2.0 * least_tip - 1e-3}))


def interference(gears: gm.Gears) -> float:
    """Depth (mm) of the deepest tip in a fillet, without what would free it."""
    fitted = fit(gears.pairs[0])
    assert fitted is not None
    return max((tip.depth for tip in fitted.interference), default=0.0)


@pytest.mark.sweep
def test_warning_of_tip_in_fillet_agrees_with_contact() -> None:
    """It is on flank alone with the tip diameter that is named, by the sheet and by first touch of the exact teeth."""
    external = design_of("spur", gear={"teeth": 90, "addendum": 1.15})
    ring = {"teeth": -60, "profile_shift": 0.1, "tool_tip_radius": 0.36}
    internal = design_of("spur", pinion={"addendum": 1.15}, gear=ring)
    for design, mating, keys in ((external, "gear", {"teeth": 90}), (internal, "pinion", {})):
        (line,) = (each for each in gm.build(design).sheet().warnings if "into the fillet" in each)
        bound = re.fullmatch(rf".*; it clears the fillet with {mating}\.tip_diameter at most ([\d.]+) mm", line)
        assert bound is not None
        other = {"gear": ring} if mating == "pinion" else {}
        clear = gm.build(design_of("spur", **other, **{mating: {**keys, "tip_diameter": float(bound[1])}}))
        assert not any("fillet" in each for each in clear.sheet().warnings)
        assert min(sheet_of(clear)["interference"]) == pytest.approx(0.0, abs=1e-3)
        if mating == "gear":
            inside, touching = (interference(gears) for gears in (gm.build(design), clear))
            # a tip that reaches to the very end of the flank passes on into the fillet by what that is curved more
            assert touching < 0.01 * inside


BODIES: dict[str, dict[str, Any]] = {
    "keyed": {
        "pinion": {"bore": 14, "keyway": {"width": 5, "depth": 2.3}, "hub": {"diameter": 24, "length": 10}, "tip_chamfer": 0.2},
        "helix_angle": 15,
    },
    "webbed": {
        "gear": {"teeth": 45, "bore": 20, "web": {"thickness": 6}, "holes": {"count": 5}, "hub": {"diameter": 34, "length": 8}}
    },
    "ring": {"gear": {"teeth": -60, "rim": 12, "holes": {"count": 6, "diameter": 4}}},
}  # fmt: skip


@pytest.mark.sweep
@pytest.mark.sweep_cases("keyed")
@pytest.mark.parametrize("name", BODIES)
def test_bodies_have_volume_mass_and_inertia_of_the_solid(name: str) -> None:
    """The moments of the triangles; of what has neither hub, keyway, web nor holes, the volume in a second exact way."""
    gears = gm.build(design_of("spur", **BODIES[name], material={"density": 2700}))
    sheet = sheet_of(gears)
    plain = gears.members["gear" if name == "keyed" else "pinion"]
    assert member_moments(plain).volume == pytest.approx(plain.tooth.volume(), rel=1e-10)
    for k, member in enumerate(gears.members):
        mesh = gears.solid(member, 0.004).mesh
        a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
        volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
        # of a tetrahedron to the origin: sum over its corners and their sum, squared, over 20
        squares = sum((corner[:, :2] ** 2).sum(axis=1) for corner in (a, b, c, a + b + c)) / 20.0
        assert sheet["V"][k] == pytest.approx(volumes.sum(), rel=6e-4)
        assert sheet["m"][k] == pytest.approx(2.7e-6 * volumes.sum(), rel=6e-4)
        assert sheet["J"][k] == pytest.approx(2.7e-6 * (volumes * squares).sum(), rel=1.5e-3)


@pytest.mark.quick
def test_gears_beyond_the_range_of_iso_1328_have_no_tolerances() -> None:
    sheet = sheet_of(gm.build(design_of("spur", accuracy_class=8, module=0.4, pinion={"face_width": 5})))
    assert sheet["A"] == [8, 8]
    assert sheet["f_pT"] == [None, None]


@pytest.mark.sweep
def test_describe_prints_the_sheet_and_run_reports_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    design = tmp_path / "pair.toml"
    design.write_text(gm.toml(design_of("helical_left", contact={"phi1": {"count": 3}}).resolve()))
    status, out, _ = run("describe", design)
    assert status == 0
    assert max(map(len, out.splitlines())) <= 80
    for symbol in ("alpha_wt", "beta_b", "d_Nf", "W_k_upper", "M_dR", "s_nc", "eps_gamma", "zeta_E", "s_Fn", "F_bT"):
        assert any(line.split()[:1] == [symbol] for line in out.splitlines()), symbol
    status, text, _ = run("describe", design, "--json", "-")
    tables = json.loads(text)["tables"]
    assert tables["Members"]["d_a"] == ["mm", *sheet_of(gm.build(gm.load(design)))["d_a"]]
    # what the sheet of every kind has
    assert {"Derived keys (lengths in mm)", "Members at mid face", "Axes"} < tables.keys()
    # lengths are in mm whatever the design's unit
    inches = gm.parse({"kind": "cylindrical", "units": "inch", "module": 2 / 25.4,
                       "pinion": {"teeth": 18, "face_width": 1}, "gear": {"teeth": 45, "face_width": 1}})  # fmt: skip
    assert sheet_of(gm.build(inches))["d"] == pytest.approx([36.0, 90.0])
    # it is no sheet of machine settings
    assert "has no compensating settings" in refused("settings", design)
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "no pictures here")
    status, _, _ = run("run", design, "-o", tmp_path / "out", "--tol", "0.05", "--no-report")
    assert status == 0
    assert not (tmp_path / "out" / "report.html").exists()
    assert json.loads((tmp_path / "out" / "report.json").read_text())["sheet"] == tables
    assert refused("describe", design, "--set", "accuracy_class=12").count("accuracy_class = 12") == 1


@pytest.mark.sweep
def test_a_planetary_set_has_the_sheets_of_both_meshes() -> None:
    keys = {"module": 2, "helix_angle": 10, "accuracy_class": 8, "backlash": 0.08, "material": {"density": 7000}}
    teeth = {name: {"teeth": z, "face_width": 20} for name, z in (("sun", 18), ("planet", 27), ("ring", 72))}
    gears = gm.build(gm.parse({"kind": "planetary", **keys, **teeth}))
    tables = gears.sheet().plain_tables
    for first, second, pair in (("sun", "planet", 0), ("planet", "ring", 3)):
        title = f"{first.capitalize()} and {second}: "
        members = [gears.members[f"{name}_1" if name == "planet" else name] for name in (first, second)]
        found = gears.contact(pair=pair).summary
        assert tables[title + "Pair"]["eps_alpha"][1] == pytest.approx(found["transverse_contact_ratio"], abs=1e-8)
        assert tables[title + "Backlash"]["j_bn"][2] == pytest.approx(0.08, abs=1e-8)
        assert tables[title + "Members"]["z"][1:] == [
            teeth[first]["teeth"],
            teeth[second]["teeth"] * (-1 if pair else 1),
        ]
        sizes, measures = (tables[title + "Measures of the tooth thickness"][symbol][1:] for symbol in ("D_M", "M_dK"))
        for k, member in enumerate(members):
            sense = -1 if member.name == "ring" else 1
            assert measuring.over_balls(member, sizes[k], sense) == pytest.approx(measures[k], abs=EXACT)
        assert tables[title + "Flank tolerances [ISO 1328-1:2013]"]["A"] == ["-", 8, 8]
        assert tables[title + "Bodies"]["rho"] == ["kg/m^3", 7000.0, 7000.0]
    assert {"Members at mid face", "Axes"} < tables.keys()
