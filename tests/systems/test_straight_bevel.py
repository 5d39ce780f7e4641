"""Straight bevel gears against closed forms on the unit sphere, and their mesh against its own definitions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.systems.common.bevel.machine_frame import own_axes
from gearmesh.systems.straight_bevel.build import cut_side, half_angles, straight_blank
from gearmesh.systems.straight_bevel.generated import DiscCut

#: the pair of the sample, and a pair on obtuse axes with an octoid of another pressure angle
PAIRS: dict[str, dict[str, Any]] = {
    "right_angle": {"module": 2, "face_width": 10, "backlash": 0.1, "pinion": {"teeth": 12}, "gear": {"teeth": 30}},
    "obtuse": {
        **{"module": 5, "shaft_angle": 110, "pressure_angle": 22.5, "backlash": 0.08, "taper": "tilted_root_line"},
        **{"pinion": {"teeth": 17}, "gear": {"teeth": 24}},
    },
}
FORMS = ("octoid", "spherical_involute")


def design_of(pair: str, **more: Any) -> gm.Design:
    return gm.parse({"kind": "straight_bevel", **PAIRS[pair], **more})


@pytest.fixture(scope="module")
def built() -> dict[tuple[str, str], gm.Gears]:
    return {(pair, form): gm.build(design_of(pair, form=form)) for pair in PAIRS for form in FORMS}


def flank_points(gears: gm.Gears, name: str, side: Side, count: int = 5) -> tuple[Array, Array]:
    """Points (count, 3, 3) of a flank from form point to tip, and their parameters p (count, 1)."""
    tooth = gears.members[name].tooth
    flank, p = tooth.side(side).flank, np.linspace(0.0, tooth.side(side).tip, count)[:, None]
    toe, heel = tooth.blank.extent
    points = flank.jet(p, np.linspace(toe, heel, 3) - 0.5 * (toe + heel)).r
    return points, p


def test_blank_of_the_sample_is_that_of_the_closed_forms() -> None:
    blank = straight_blank(gm.load("samples/straight_bevel.toml").in_mm())
    angle = np.degrees(blank.pinion.pitch_angle)
    assert angle == pytest.approx(np.degrees(np.arctan(12 / 30)), abs=1e-12) == pytest.approx(21.801, abs=5e-4)
    assert np.degrees(blank.gear.pitch_angle) == pytest.approx(68.199, abs=5e-4)
    assert blank.gear.outer_cone_distance == pytest.approx(np.hypot(12, 30), abs=1e-12)
    assert blank.gear.outer_cone_distance == pytest.approx(32.311, abs=5e-4)
    assert blank.gear.end_spiral_angles == (0.0, 0.0)


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.sweep_cases("right_angle")
def test_octoid_is_where_the_pitch_line_projects_on_the_plane(
    built: dict[tuple[str, str], gm.Gears], pair: str
) -> None:
    """The line of contact of a turning plane is the orthogonal projection of the pitch line, the axis of the roll."""
    gears = built[pair, "octoid"]
    blank = straight_blank(gears.design.in_mm())
    alpha = blank.pressure_angle
    for own, name, half in zip(blank.members, ("pinion", "gear"), half_angles(blank), strict=True):
        flank, tool = gears.members[name].tooth.right.flank, gears.members[name].tooth.right.generation[0].tool
        crown = np.linspace(-0.5, 0.4, 9)
        normals = np.stack(
            (np.cos(alpha) * np.sin(crown), -np.cos(alpha) * np.cos(crown), np.full_like(crown, -np.sin(alpha))),
            axis=-1,
        )
        lines = np.array([1.0, 0.0, 0.0]) - normals * normals[:, :1]
        lines /= np.linalg.norm(lines, axis=-1)[:, None]
        # the arc of the line up the plane, and from it the flank's parameter
        arcs = np.arcsin(-lines[:, 2] / np.cos(alpha))
        form = np.arcsin(-tool.jet(np.zeros(1), np.zeros(1)).r[0, 2] / own.mean_cone_distance / np.cos(alpha))
        for away in (-0.4, 0.0, 0.3):
            distance = own.mean_cone_distance + away
            start = np.arcsin(-tool.jet(np.zeros(1), np.full(1, away)).r[0, 2] / distance / np.cos(alpha))
            points = flank.jet(own.mean_cone_distance * (arcs - start), np.full_like(arcs, away)).r
            turn = Rigid.about_z(-half - crown / np.sin(own.pitch_angle))
            wanted = distance * turn.vector(lines @ own_axes(own.pitch_angle).T)
            assert np.abs(points - wanted).max() < 1e-12 * distance
        assert form < 0.0


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("side", Side)
def test_spherical_involute_unrolls_from_its_base_cone(
    built: dict[tuple[str, str], gm.Gears], pair: str, side: Side
) -> None:
    gears = built[pair, "spherical_involute"]
    blank = straight_blank(gears.design.in_mm())
    for own, name, half in zip(blank.members, ("pinion", "gear"), half_angles(blank), strict=True):
        points, _ = flank_points(gears, name, side)
        base = np.arcsin(np.sin(own.pitch_angle) * np.cos(blank.pressure_angle))

        def azimuth(polar: Array, base: float = base) -> Array:
            arc = np.arccos(np.cos(polar) / np.cos(base))
            return np.asarray(arc / np.sin(base) - np.arctan2(np.tan(arc), np.sin(base)))

        polar = np.arctan2(np.hypot(points[..., 0], points[..., 1]), points[..., 2])
        wanted = half + azimuth(np.array(own.pitch_angle)) - azimuth(polar)
        found = -side.sign * np.arctan2(points[..., 1], points[..., 0])
        assert np.abs(found - wanted).max() < 1e-12


@pytest.mark.sweep_cases("right_angle-spherical_involute", "obtuse-octoid", "obtuse-spherical_involute")
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("pair", PAIRS)
def test_aligned_pairs_are_conjugate_and_have_their_backlash(
    built: dict[tuple[str, str], gm.Gears], pair: str, form: str
) -> None:
    gears = built[pair, form]
    contact = gears.contact()
    arcsec = np.radians(1.0 / 3600.0)
    assert contact.summary["mesh_te_peak_to_peak_arcsec"] * arcsec < 1e-9
    assert set(contact.path.kind) == {"line"}
    for end in ("min", "max"):
        assert contact.summary[f"backlash_normal_{end}_mm"] == pytest.approx(gears.design.in_mm().backlash, abs=1e-9)
    assert contact.summary["interference_um"] == 0.0
    blank = straight_blank(gears.design.in_mm())
    for name in ("pinion", "gear"):
        assert contact.summary[f"tip_clearance_{name}_mm"] == pytest.approx(blank.clearance, abs=1e-5)


def test_forms_differ_by_some_micrometres_towards_the_tip(built: dict[tuple[str, str], gm.Gears]) -> None:
    octoid, involute = (flank_points(built["right_angle", form], "pinion", Side.RIGHT, 400)[0] for form in FORMS)
    # azimuths of both flanks over the polar angle, at the heel
    curves = [
        (np.arctan2(np.hypot(r[:, 0], r[:, 1]), r[:, 2]), np.arctan2(r[:, 1], r[:, 0]))
        for r in (octoid[:, 2], involute[:, 2])
    ]
    polar = np.linspace(max(c[0][0] for c in curves), min(c[0][-1] for c in curves), 9)
    first, second = (np.interp(polar, *curve) for curve in curves)
    away = 1e3 * np.hypot(12, 30) * np.sin(polar) * (first - second)
    assert away[-1] == pytest.approx(25.3, abs=0.5)
    assert np.abs(away[:3]).max() < 2.0


@pytest.mark.parametrize("taper", ["standard", "uniform", "duplex", "tilted_root_line"])
def test_fillets_end_tangent_to_the_root_cone(taper: str) -> None:
    data = {**PAIRS["right_angle"], "face_width": 6, "edge_radius": None, "taper": taper}
    del data["edge_radius"]
    gears = gm.build(gm.parse({"kind": "straight_bevel", **data, "form": "spherical_involute"}))
    for member in gears.members.values():
        root = member.tooth.blank.root
        v = np.linspace(-2.9, 2.9, 5)
        for side in Side:
            jet = member.tooth.side(side).fillet.jet(np.ones_like(v), v)
            assert np.abs(root.value(jet.r)).max() < 1e-12
            gradient = root.gradient(jet.r)
            assert np.abs(np.cross(gradient, jet.n)).max() < 1e-9


@pytest.mark.parametrize("dish", [0.0, 3.0])
@pytest.mark.parametrize("side", Side)
def test_discs_cut_the_plane_hollowed_by_their_cone(dish: float, side: Side) -> None:
    design = design_of("right_angle", pinion={"teeth": 12, "disc": {"dish_angle": dish, "radius": 70}})
    cut = cut_side(design.in_mm(), straight_blank(design.in_mm()), 0, side)
    assert isinstance(cut, DiscCut)
    tool = cut.side(0.0).generation
    assert tool is not None
    p, v = np.linspace(0.0, 5.0, 6)[:, None], np.linspace(-0.08, 0.08, 5)
    # from the disc's frame, as the roll at rest places it, to the plane through the apex
    alpha, place = np.radians(20), tool[0].motion.at(np.zeros(())).tool_to_blank
    points = own_axes(cut.pitch_angle).T @ place.point(tool[0].tool.jet(p, v).r)[..., None]
    away = points[..., 0] @ np.array([0.0, -side.sign * np.cos(alpha), -np.sin(alpha)])
    angle = np.radians(dish)
    wanted = -(70 - p * np.cos(angle)) * (1 - np.cos(v)) * np.sin(angle)
    assert np.abs(away - wanted).max() < 1e-12
    # the edge in the plane passes through the mean point
    edge = points[:, 2, :, 0]
    mean = np.array([cut_mean(design), 0.0, 0.0])
    assert np.linalg.norm(np.cross(edge[-1] - edge[0], mean - edge[0])) < 1e-11


def cut_mean(design: gm.Design) -> float:
    return float(straight_blank(design.in_mm()).pinion.mean_cone_distance)


def test_a_crowned_pinion_runs_uniformly_in_points_with_its_backlash() -> None:
    contact = gm.build(design_of("right_angle", pinion={"teeth": 12, "disc": {}})).contact()
    assert set(contact.path.kind) == {"point"}
    assert np.radians(contact.summary["mesh_te_peak_to_peak_arcsec"] / 3600.0) < 1e-9
    assert contact.summary["backlash_normal_min_mm"] == pytest.approx(0.1, abs=1e-9)
    assert contact.summary["interference_um"] == 0.0


def test_sheet_has_the_crowning_that_the_discs_leave() -> None:
    gears = gm.build(design_of("right_angle", pinion={"teeth": 12, "disc": {}}))
    rows = {row[0]: row[2:] for table in gears.sheet().tables for row in table.rows if "Disc" in table.title}
    for place, end in (("toe", -5.0), ("heel", 5.0)):
        pinion, gear = rows[f"crowning at the {place}, on the pitch line"]
        assert gear is None
        assert pinion == pytest.approx(end**2 * np.sin(np.radians(3)) / (2 * (60 - 1.4)), rel=0.01)


def test_sheet_and_forces_of_the_sample() -> None:
    gears = gm.build(gm.load("samples/straight_bevel.toml"))
    tables = {table.title: table for table in gears.sheet(torque=20.0).tables}
    forces = {row[0]: row for row in tables["Forces for 20 Nm on the pinion"].rows}
    radius = 0.5 * 2 * 12 * (1 - 5 / np.hypot(12, 30)) * 1e-3
    tangential = 20 / radius
    for item, wanted in (
        ("tangential", (1.0, 1.0)),
        ("axial, > 0 away from the crossing point", np.tan(np.radians(20)) * np.sin(np.arctan([12 / 30, 30 / 12]))),
        ("separating, > 0 away from the mating gear", np.tan(np.radians(20)) * np.cos(np.arctan([12 / 30, 30 / 12]))),
    ):
        exact = forces[f"{item.split(',')[0]}, by the exact normal"]
        assert forces[item][2:] == pytest.approx(tangential * np.array(wanted), rel=1e-11)
        assert exact[2:] == pytest.approx(tangential * np.array(wanted), rel=1e-11)
    measured = dict(
        zip(
            tables["Teeth as cut, measured on their flanks"].symbols,
            tables["Teeth as cut, measured on their flanks"].rows,
            strict=True,
        )
    )
    nominal = dict(zip(tables["Dimensions [ISO 23509]"].symbols, tables["Dimensions [ISO 23509]"].rows, strict=True))
    assert measured["s_mt"][2:] == pytest.approx(nominal["smt"][2:], abs=1e-9)


@pytest.mark.parametrize(
    ("keys", "key", "said"),
    [
        ({"form": "octoide"}, "form", "octoid"),
        ({"face_width": 40}, "face_width", "outer cone distance"),
        ({"taper": "parabolic"}, "taper", "standard"),
        ({"pinion": {"teeth": 12, "disc": {"radius": 5}}}, "pinion.disc.radius", "7.5 mm or more"),
        ({"form": "spherical_involute", "gear": {"teeth": 30, "disc": {}}}, "gear.disc", "leave it out"),
        ({"pinion": {"teeth": 12, "edge_radius": -1}}, "pinion.edge_radius", "0"),
    ],
)
def test_wrong_values_are_refused_by_name(keys: dict[str, Any], key: str, said: str) -> None:
    with pytest.raises(gm.DesignError) as refusal:
        gm.build(design_of("right_angle", **keys))
    assert refusal.value.key == key
    assert said in str(refusal.value)


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(100))
def test_random_pairs_build_and_run(seed: int) -> None:
    """Half of them are crowned; the two discs of a uniform depth touch the crown gear along one line, and turn uniformly, too."""
    dice = np.random.default_rng(seed)
    module, teeth = float(dice.uniform(0.5, 8)), int(dice.integers(17, 40))
    crowned = {0: ("pinion", "gear"), 2: (str(dice.choice(["pinion", "gear"])),)}.get(seed % 4, ())
    data = {
        "kind": "straight_bevel",
        "module": module,
        "shaft_angle": float(dice.uniform(30, 120)),
        "form": "octoid" if crowned else str(dice.choice(FORMS)),
        "taper": str(dice.choice(["standard", "uniform", "duplex", "tilted_root_line"])),
        "backlash": float(dice.uniform(0.02, 0.08)) * module,
        "pinion": {"teeth": teeth},
        "gear": {"teeth": int(teeth * dice.uniform(1.0, 2.2))},
    }
    for name in crowned:
        data[name] |= {"disc": {"dish_angle": float(dice.uniform(0.5, 6.0))}}
    gears = gm.build(gm.parse(data))
    contact = gears.contact()
    summary = contact.summary
    conjugate = len(crowned) < 2 or data["taper"] == "uniform"
    assert np.radians(summary["mesh_te_peak_to_peak_arcsec"] / 3600.0) < (1e-9 if conjugate else 5e-6)
    assert set(contact.path.kind) <= ({"point", "edge"} if crowned else {"line"})
    assert summary["backlash_normal_min_mm"] == pytest.approx(data["backlash"], rel=1e-6 if conjugate else 5e-4)
    assert summary["interference_um"] == 0.0
    assert min(summary["tip_clearance_pinion_mm"], summary["tip_clearance_gear_mm"]) > 0.0
    assert summary["contact_ratio"] > 1.0
