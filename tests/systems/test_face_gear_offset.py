"""Face gears on crossed axes: three surfaces in mesh at once, limits of two flanks that differ, members rolled and overlapped."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.overlap import overlap
from oracles.places import SAMPLES
from oracles.stretched import stretched

from gearmesh import DesignError, FaceGearDesign, load
from gearmesh.check.members import roll_flanks
from gearmesh.contact.flanks import analyse
from gearmesh.kinds import Side, Tooth, TrimError
from gearmesh.mesh.solid import gear_solid
from gearmesh.systems import system
from gearmesh.systems.face_gear.build import shaped_gear
from gearmesh.systems.face_gear.sheet import data_sheet
from gearmesh.teeth.limits import pointed_station, undercut_station

PHI1 = np.radians([-8.0, -4.0, 0.0, 4.0, 8.0])


def design(*overrides: str, sample: str = "face_gear_offset") -> FaceGearDesign:
    given = load(SAMPLES / f"{sample}.toml", list(overrides)).in_mm()
    assert isinstance(given, FaceGearDesign)
    return given


@pytest.mark.parametrize(
    "overrides",
    [(), ("shaft_angle=70", "contact.flank=left", "backlash=0.1"), ("offset=-150", "shaft_angle=100")],
    ids=" ".join,
)
@pytest.mark.sweep_cases("offset=-150 shaft_angle=100", "shaft_angle=70 contact.flank=left backlash=0.1")
def test_aligned_pair_turns_uniformly_and_touches_with_normals_through_the_pitch_line(
    overrides: tuple[str, ...],
) -> None:
    """Shaper and pinion are an internal spur mesh; where on their line of contact the gear touches, n . v = 0 says, written out."""
    given = design(*overrides)
    path = analyse(pair_of(given), PHI1)
    assert (path.kind == "point").all()
    np.testing.assert_allclose(path.phi2, PHI1 * given.pinion.teeth / given.gear.teeth, rtol=0, atol=1e-12)
    radius, angle = 0.5 * given.shaper_teeth * given.module, np.radians(given.shaft_angle)
    away = np.cross(path.point - np.array([radius, 0.0, 0.0]), path.normal)
    np.testing.assert_allclose(away[:, 2], 0.0, rtol=0, atol=1e-9)
    gear_axis, foot = np.array([np.sin(angle), 0.0, np.cos(angle)]), np.array([0.0, -given.offset, 0.0])
    ratio = given.shaper_teeth / given.gear.teeth
    velocity = -np.cross([0.0, 0.0, 1.0], path.point) - ratio * np.cross(gear_axis, path.point - foot)
    np.testing.assert_allclose(np.sum(velocity * path.normal, axis=-1), 0.0, rtol=0, atol=1e-9)


@pytest.mark.sweep
def test_shaper_like_the_pinion_is_conjugate_on_crossed_axes_without_overlap() -> None:
    """Solver, flanks rolled on grids of exact points, and solids."""
    given = design("offset=30", "shaft_angle=80", "backlash=0.02", sample="face_gear_conjugate")
    pair = pair_of(given)
    path = analyse(pair, PHI1[1:4])
    assert (path.kind == "line").all()
    np.testing.assert_allclose(path.te, 0.0, rtol=0, atol=1e-12)
    phi1 = 0.2 * pair.pitch
    (touch,) = roll_flanks(pair, phi1, cells=80)
    assert touch is not None
    assert abs(touch.phi2 - phi1 * pair.ratio) < 1e-9
    pinion, gear = (gear_solid(member, 0.01) for member in pair.both)
    found = overlap(pair, (pinion, gear), phi1, phi1 * pair.ratio)
    assert all(piece.thickness < 0.02 for piece in found.pieces)
    # half a degree of the pinion ahead they do
    ahead = overlap(pair, (pinion, gear), phi1 + np.radians(0.5), phi1 * pair.ratio)
    assert ahead.pieces[0].thickness > 0.03


@pytest.mark.sweep
@pytest.mark.sweep_cases("module=0.5 offset=6.3 pinion.bore=4.7 gear.bore=60")
@pytest.mark.parametrize(
    "overrides",
    [
        ("offset=-60", "shaft_angle=70", "shaper.teeth=26"),
        ("module=0.5", "offset=6.3", "pinion.bore=4.7", "gear.bore=60"),
    ],
    ids=" ".join,
)
def test_solids_of_other_offset_pairs_touch_and_do_not_overlap(overrides: tuple[str, ...]) -> None:
    """Either side of the axis, off 90 deg, a shaper of one tooth more, small teeth: where contact has them they just touch."""
    given = design(*overrides)
    pair, tolerance = pair_of(given), 0.004 * given.module
    phi1 = 0.2 * pair.pitch
    phi2 = float(analyse(pair, np.array([phi1])).phi2[0])
    pinion, gear = (gear_solid(member, tolerance) for member in pair.both)
    # each of both may stand out by its tolerance
    found = overlap(pair, (pinion, gear), phi1, phi2)
    assert all(piece.thickness < 2.0 * tolerance for piece in found.pieces)
    ahead = overlap(pair, (pinion, gear), phi1 + np.radians(0.5), phi2)
    assert ahead.pieces[0].thickness > 3.0 * tolerance


@pytest.mark.parametrize("overrides", [(), ("offset=-60", "shaft_angle=70")], ids=" ".join)
@pytest.mark.sweep_cases("offset=-60 shaft_angle=70")
def test_limits_of_both_flanks_by_closed_form_and_by_the_surface(overrides: tuple[str, ...]) -> None:
    given = design(*overrides)
    shaped, tooth = shaped_gear(given), pair_of(given).gear.tooth
    inner = [side.undercut_radius_of_right() for side in shaped.sides]
    outer = shaped.pointing_radius(given.gear.addendum * given.module)
    assert abs(inner[0] - inner[1]) > 5.0
    # of the other flank no section is undercut: it begins where the shaper begins to generate
    radius, side = max(zip(inner, Side, strict=True))
    near = stretched(tooth, radius + 1.0, radius + 20.0)
    assert undercut_station(near, near.side(side)) == pytest.approx(radius, abs=1e-6)
    assert np.isnan(undercut_station(near, near.side(side.other)))
    assert pointed_station(tooth) == pytest.approx(outer, abs=1e-6)

    def fault(radius: float) -> str:
        at = stretched(tooth, radius, radius + 1.0)
        try:
            at.sections([0.0])
        except TrimError as failure:
            return failure.what
        return ""

    assert [fault(outer + d) for d in (-1e-6, 1e-6)] == ["", "pointed"]
    for d, cut in ((-1e-4, True), (1e-4, False)):
        sections = stretched(tooth, radius + d, radius + 1.0).sections([0.0])
        assert bool(sections.of(side).form_point_flank[0] != tooth.side(side).form_point[0]) is cut


def root_matches(tooth: Tooth) -> float:
    sections = tooth.sections(np.linspace(0.0, 1.0, 4))
    root, right = tooth.grid("root", [0.0, 1.0], sections), tooth.grid("fillet_right", [0.0], sections)  # type: ignore[arg-type]
    left = tooth.grid("fillet_left", [1.0], sections)  # type: ignore[arg-type]
    c, s = np.cos(tooth.pitch_angle), np.sin(tooth.pitch_angle)
    before = left.points[0] @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return float(max(np.abs(root.points[1] - right.points[0]).max(), np.abs(root.points[0] - before).max()))


def test_root_that_the_top_cylinder_generates_runs_into_both_fillets() -> None:
    for keys in ((), ("shaft_angle=65",)):
        assert root_matches(pair_of(design(*keys)).gear.tooth) < 1e-10


@pytest.mark.sweep_cases("offset=900-", "offset=500-")
@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["gear.inner_radius=480"], "gear.inner_radius = 480 mm: undercut by the shaper; allowed is at least 481.8"),
        (["offset=500"], "offset = 500 mm: allowed is at most 4"),
        (
            ["offset=900", "shaft_angle=50"],
            "with the other keys unchanged: the shaper generates no complete flank there",
        ),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_refusals_name_key_value_and_limit(overrides: list[str], words: str) -> None:
    with pytest.raises(DesignError) as failure:
        pair_of(design(*overrides))
    assert words in str(failure.value)


@pytest.mark.sweep_cases("120.0", "90.0")
@pytest.mark.parametrize("shaft_angle", [70.0, 90.0, 120.0])
def test_sheet_has_rolling_axodes_and_lines_of_contact(shaft_angle: float) -> None:
    """The cones touch in the instantaneous axis, where both members have one velocity; in the pitch point it is the pitch line."""
    given = design(f"shaft_angle={shaft_angle}", sample="face_gear")
    tables = {each.title: each for each in data_sheet(given, system.build(given)).tables}
    rows = {row[0]: row[2:] for row in tables["Axodes [LF04 18.2, 18.4]"].rows}
    angle = np.radians(shaft_angle)
    cones = rows["half angle of its axode"], rows["half angle of the gear's axode"]
    for first, second, teeth in zip(*cones, (given.pinion.teeth, given.shaper_teeth), strict=True):
        assert first + second == pytest.approx(shaft_angle, abs=1e-8)
        slope = np.radians(first)
        line = np.array([np.sin(slope), 0.0, np.cos(slope)])
        gear = np.array([np.sin(angle), 0.0, np.cos(angle)]) * teeth / given.gear.teeth
        np.testing.assert_allclose(np.cross([0.0, 0.0, 1.0], line) + np.cross(gear, line), 0.0, rtol=0, atol=1e-9)
    radius = 0.5 * given.shaper_teeth * given.module
    place = rows["pitch point from the apex, along the axis"][1]
    assert place * np.tan(np.radians(cones[0][1])) == pytest.approx(radius, abs=1e-6)
    lines = {row[0]: row[2:] for row in tables["Lines of contact on the shaper [LF04 18.4]"].rows}
    at = lines["from the apex, along the shaper's axis"], lines["pressure angle of L_s2, right"]
    for z, kappa in zip(*at, strict=True):
        assert z * np.tan(np.radians(cones[0][1])) * np.cos(np.radians(kappa)) == pytest.approx(
            radius * np.cos(np.radians(given.pressure_angle)), abs=1e-6
        )
    crossed = design()
    tables = {each.title: each for each in data_sheet(crossed, system.build(crossed)).tables}
    assert tables["Axodes [LF04 18.2, 18.4]"].rows[0][2:] == (None, None)
