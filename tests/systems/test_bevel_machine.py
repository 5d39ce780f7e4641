"""The universal machine: flanks against cutters swept by matrices of their own, equal machines, Formate gears, processes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.built import built, contact_of, pair_of
from oracles.examples import some
from oracles.places import SAMPLES
from oracles.swept_cutter import along_to_cone, power_series, shift, turn

import gearmesh as gm
from gearmesh import GearmeshError, parse
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Envelope, Region, Side, gear_base
from gearmesh.systems.common.bevel.blank import BevelBlank
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES, HAND_SIGNS, MATING_SIDES
from gearmesh.systems.spiral_bevel.synthesis.contact_choice import contact_said
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank, gear_sides, mean_point, pinion_side
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth
from gearmesh.tools.head_cutter import Revolved

BASIC: dict[str, Any] = {"kind": "spiral_bevel", "module": 4.0, "pinion": {"teeth": 15}, "gear": {"teeth": 38}}
#: a machine that uses everything, with no setting left to the search for a contact
EVERYTHING: dict[str, Any] = {
    "sliding_base": 4.25,
    "tilt": 4.0,
    "swivel": -35.0,
    "modified_roll_c2": 0.012,
    "modified_roll_c3": -0.05,
    "modified_roll_c4": 0.02,
    "modified_roll_c5": 0.03,
    "modified_roll_c6": -0.04,
    "helical_motion": [0.9, -0.7, 0.5, 0.2, -0.3, 0.4],
    "vertical_motion": [-0.6, 0.4, 0.3, -0.2, 0.1, 0.2],
    "radial_motion": [0.5, 0.3, -0.4, 0.1, 0.2, -0.1],
    "tilt_motion": [0.8, -1.5, 0.5, 0.3, -0.2, 0.1],
    "swivel_motion": [9.0, 5.0, -8.0, 2.0, 3.0, -1.0],
}
SLIDES = ("helical_motion", "vertical_motion", "radial_motion")


def design_of(**more: Any) -> Any:
    return parse({**BASIC, **more})


def gears_of(**more: Any) -> gm.Gears:
    return built({**BASIC, **more})


def generated(design: Any, blank: BevelBlank | None = None) -> dict[str, Generated]:
    """All four flanks' machines and blades, on the blank that the design says or on another."""
    own = design.in_mm()
    blank = blank or basic_blank(own)
    gear, base = gear_sides(own, blank), gear_base(blank.shaft_angle)
    found = {f"gear {name}": side for name, side in gear.items()}
    for name in BLADE_SIDES:
        mean = mean_point(own, blank, gear[MATING_SIDES[name]], base, contact_said(own, blank, name))
        found[f"pinion {name}"] = pinion_side(own, blank, name, mean)
    return found


# ------------------------------------------------------------ a second machine, of matrices


def cutter_to_blank(side: Generated, q: Array) -> Array:
    """Transformation (..., 4, 4) from cutter to blank, as the settings are defined for a right-hand machine. The left-hand
    machine is its mirror image."""
    machine, mirror = side.settings, np.diag([1.0, float(side.hand), 1.0, 1.0])
    roll = 0.0 * q
    if not machine.formate:
        higher = sum((c * q ** (k + 2) for k, c in enumerate(machine.modified_roll)), 0.0 * q)
        roll = (q - higher) / machine.ratio_of_roll
    tilt = power_series(machine.tilt, machine.tilt_motion, q)
    swivel = power_series(machine.swivel, machine.swivel_motion, q)
    # the cutter: tilted about the radius, swivelled, out on the cradle, which turns
    cutter = turn(2, 0.5 * np.pi + swivel) @ turn(1, tilt)
    zero = 0.0 * q
    radial = power_series(machine.radial, machine.radial_motion, q)
    on_machine = turn(2, machine.cradle_angle + q) @ shift(radial, zero, zero) @ cutter
    # the blank's apex in the machine, its axis rising by the root angle from the machine plane
    apex = shift(
        zero - machine.machine_centre_to_back,
        power_series(machine.machining_offset, machine.vertical_motion, q),
        power_series(machine.sliding_base, machine.helical_motion, q),
    )
    # own x towards the cutter, own z along the axis
    tipped = turn(1, 0.5 * np.pi - machine.machine_root_angle + zero)
    blank = apex @ tipped @ turn(2, roll)
    return mirror @ np.linalg.inv(blank) @ on_machine @ mirror


def along_normals(side: Generated, points: Array, normals: Array, q: Array) -> Array:
    """Return distances (mm), along the normals (N, 3) from points, to the blade's prolonged cone at cradle rotations q (K, N)."""
    blade = side.blade
    slope = float(blade.side * np.tan(blade.blade_angle))
    return along_to_cone(cutter_to_blank(side, q), (blade.tip_radius, slope), points, normals)


@pytest.mark.sweep_cases("pinion concave-left", "gear convex-right", "pinion concave-right")
@pytest.mark.parametrize("hand", HAND_SIGNS)
@pytest.mark.parametrize("name", some(["pinion concave", "pinion convex", "gear concave", "gear convex"], 2))
def test_flanks_are_what_swept_cutters_leave(hand: str, name: str) -> None:
    """352 points: no position of the cutter is inside the tooth, and one touches it, to 1e-6 mm."""
    side = generated(
        design_of(
            hand=hand,
            pinion={"teeth": 15, "concave": EVERYTHING, "convex": {**EVERYTHING, "tilt": -3.0, "sliding_base": -3.47}},
        )
    )[name]
    if name.startswith("gear"):
        motions = {key: value for key, value in EVERYTHING.items() if key.endswith("_motion")}
        angles = {key: tuple(np.radians(value)) for key, value in motions.items() if key not in SLIDES}
        slides = {key: tuple(0.3 * np.array(motions[key])) for key in SLIDES}
        machine = replace(side.settings, tilt=0.03, swivel=0.4, modified_roll=(0.02, 0.03), **angles, **slides)
        side = replace(side, settings=machine)
    flank = side.side(0.3).flank
    assert isinstance(flank, Envelope)
    assert all(
        len(getattr(side.settings, f"{each}_motion")) == 6
        for each in ("tilt", "swivel", "radial", "helical", "vertical")
    )
    heights = np.linspace(0.3, 0.95, 16) * side.tip_height
    reach = 0.4 * basic_blank(design_of()).gear.face_width / side.blade.tip_radius
    p, v = np.meshgrid([side.blade.at_height(h) for h in heights], np.linspace(-reach, reach, 22))
    jet, generation = flank.jet(p.ravel(), v.ravel()), flank.generation(p.ravel(), v.ravel())
    turned = turn(2, np.array(-0.3 - side.turned))[:3, :3]
    points, normals = jet.r @ turned.T, jet.n @ turned.T
    assert points.shape == (352, 3)
    q = generation.phi + np.linspace(-0.02, 0.02, 41)[:, None]
    apart = along_normals(side, points, normals, q)
    assert np.abs(apart.min(axis=0)).max() < 1e-6
    assert (np.abs(apart.argmin(axis=0) - 20) <= 1).all()
    # nor from farther away, where the cone of the cutter is still the blade
    assert along_normals(side, points, normals, generation.phi + np.linspace(-0.3, 0.3, 121)[:, None]).min() > -1e-6


def surface_of(side: Generated, machine: Any, place: float) -> Envelope:
    return Envelope(Revolved(side.blade.flank, side.blade.side), machine.motion(side.hand, place))


@pytest.mark.parametrize("hand", HAND_SIGNS)
def test_the_zero_of_the_cradle_is_free(hand: str) -> None:
    """Settings counted from another cradle angle, every polynomial expanded anew, cut the same flank."""
    side = generated(design_of(hand=hand, pinion={"teeth": 15, "concave": EVERYTHING}))["pinion concave"]
    machine, start = side.settings, 0.07

    def moved(constant: float, coefficients: tuple[float, ...]) -> tuple[float, tuple[float, ...]]:
        first, *rest = np.polynomial.Polynomial((constant, *coefficients))(np.polynomial.Polynomial((start, 1.0))).coef
        return float(first), tuple(float(a) for a in rest)

    def rolled() -> tuple[float, float, tuple[float, ...]]:
        turned, (rate, *higher) = moved(0.0, (1.0, *(-c for c in machine.modified_roll)))
        return turned, rate, tuple(-c / rate for c in higher)

    turned, rate, roll = rolled()
    tilt, swivel, radial, base, offset = (
        moved(getattr(machine, key), getattr(machine, f"{motion}_motion"))
        for key, motion in (
            ("tilt", "tilt"),
            ("swivel", "swivel"),
            ("radial", "radial"),
            ("sliding_base", "helical"),
            ("machining_offset", "vertical"),
        )
    )
    other = replace(
        machine,
        cradle_angle=machine.cradle_angle + start,
        ratio_of_roll=machine.ratio_of_roll / rate,
        modified_roll=roll,
        tilt=tilt[0],
        tilt_motion=tilt[1],
        swivel=swivel[0],
        swivel_motion=swivel[1],
        radial=radial[0],
        radial_motion=radial[1],
        sliding_base=base[0],
        helical_motion=base[1],
        machining_offset=offset[0],
        vertical_motion=offset[1],
    )
    p = np.full(7, side.blade.at_height(0.5 * side.tip_height))
    v = side.mean_direction + np.linspace(-0.1, 0.1, 7)
    one = surface_of(side, machine, 0.0).jet(p, v)
    two = surface_of(side, other, -side.hand * turned / machine.ratio_of_roll).jet(p, v)
    np.testing.assert_allclose(two.r, one.r, rtol=0, atol=1e-10)
    np.testing.assert_allclose(two.n, one.n, rtol=0, atol=1e-11)


def test_swivel_of_an_upright_cutter_and_polynomials_of_zeros_change_nothing() -> None:
    side = generated(design_of())["pinion concave"]
    zeros = {f"{key}_motion": (0.0,) * 6 for key in ("tilt", "swivel", "radial", "helical", "vertical")}
    plain, other = side.settings, replace(side.settings, swivel=1.1, modified_roll=(0.0,) * 5, **zeros)
    motion = other.motion(side.hand, 0.2)
    assert motion.unmodified_motion is motion
    p, v = np.full(5, side.blade.at_height(2.0)), np.linspace(-0.1, 0.1, 5) + side.mean_direction
    one, two = (surface_of(side, machine, 0.2).jet(p, v) for machine in (plain, other))
    np.testing.assert_array_equal(one.r, two.r)


# ------------------------------------------------------------ Formate


@pytest.mark.sweep
def test_a_formate_flank_is_the_cutter_itself() -> None:
    gears = gears_of(process="formate_fixed")
    (pair,), blank = gears.pairs, bevel_teeth(gears.design.in_mm()).cut.blank
    sides = generated(gears.design, blank)
    for which in Side:
        side = next(s for key, s in sides.items() if key.startswith("gear") and s.flank is which)
        tooth = pair.gear.tooth
        points = tooth.flank_grid(which, np.linspace(0.0, 1.0, 16), np.linspace(0.0, 1.0, 22)).points.reshape(-1, 3)
        place = np.pi / 38 * (1.0 if which is Side.LEFT else -1.0)
        to_cutter = np.linalg.inv(turn(2, np.array(place)) @ cutter_to_blank(side, np.zeros(())))
        x, y, z = (points @ to_cutter[:3, :3].T + to_cutter[:3, 3]).T
        slope = side.blade.side * np.tan(side.blade.blade_angle)
        off = (np.hypot(x, y) - side.blade.tip_radius + slope * z) * np.cos(side.blade.blade_angle)
        assert np.abs(off).max() < 1e-12
        # the root is the cutter's tip plane
        root = tooth.grid(Region.ROOT, np.linspace(0.0, 1.0, 5), tooth.even).points.reshape(-1, 3)
        if which is Side.RIGHT:
            assert np.abs(root @ to_cutter[2, :3] + to_cutter[2, 3]).max() < 1e-12
    # teeth are cut with the proportions that sliding bases were derived for, which are not those that the standard suggests
    assert any("addendum_factor = 0.1552: the default, instead of" in line for line in gears.warnings)


#: of the pinion of BASIC, deg
ROOT_ANGLE = 19.794423325236554
#: tilt along the cutter's radius at the mean point, which leaves the root line where it is
ALONG_RADIUS = {"concave": {"tilt": 4.0, "swivel": -24.0}, "convex": {"tilt": -3.0, "swivel": -20.0}}
#: the cradle is the gear, the cutter stands upright on the pinion's root line: what the gear's flank itself would generate is near
AS_THE_GEAR = {
    "concave": {"tilt": ROOT_ANGLE, "swivel": -152.1424, "machine_root_angle": 0.0},
    "convex": {"tilt": ROOT_ANGLE, "swivel": -145.6963, "machine_root_angle": 0.0},
}


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("more", "fits"),
    [
        ({"process": "formate_fixed"}, False),
        ({"pinion": {"teeth": 15, **ALONG_RADIUS}}, True),
        ({"process": "formate_fixed", "backlash": 0.1, "pinion": {"teeth": 15, **AS_THE_GEAR}}, True),
    ],
    ids=["formate", "tilted", "formate and tilted"],
)
def test_contact_solids_and_roll(more: dict[str, Any], fits: bool) -> None:
    """Contact as local synthesis was asked for; the roll of flanks, and solids within their tolerance, by `gearmesh check`."""
    gears = gears_of(**more)
    (pair,) = gears.train.pairs
    path = contact_path(solver_pair(pair), np.zeros(1), edges=False)
    assert path.semi_major[0] == pytest.approx(0.25 * basic_blank(gears.design).gear.face_width, rel=1e-6)
    check = gears.check(tolerance=0.02)
    # a pinion that an upright cutter generates runs into a Formate gear beside its mean point
    left = [line for line in check.complaints if fits or not line.startswith("fit:")]
    assert not left, left
    assert fits or len(check.complaints) > len(left)
    # where tips jam in fillets at every position there is nothing to roll
    assert bool(check.roll.rows) == fits
    for name, member in pair.members.items():
        assert check.solids[name].mesh.volume() == pytest.approx(member.tooth.volume(), rel=3e-3)


# ------------------------------------------------------------ processes, blades


def completing(width: float) -> dict[str, Any]:
    """BASIC with both sides of the pinion by the concave one's machine, the cutter's point so wide (mm)."""
    values = gears_of().sheet().values
    machine = {key.rpartition(".")[2]: value for key, value in values.items() if key.startswith("pinion.concave.")}
    convex = {"tip_radius": machine["tip_radius"] - width, "blade_angle": 23.0}
    return {"process": "completing", "pinion": {"teeth": 15, "concave": machine, "convex": convex}}


@pytest.mark.sweep
def test_a_completing_cutter_leaves_its_point_width_and_the_backlash_that_follows() -> None:
    gears = gears_of(**completing(2.2))
    assert gears.design.pinion.convex.radial == gears.design.pinion.concave.radial
    tooth = gears.train.pairs[0].pinion.tooth
    # both sides of a space are cut in one position of the blank
    motions = [tooth.side(which).fillet.motion for which in (Side.RIGHT, Side.LEFT)]  # type: ignore[attr-defined]
    right, left = (replace(motion, turn=motion.turn[1:]) for motion in motions)
    assert (right.centre, right.turn) == (left.centre, left.turn)
    assert motions[1].turn[0] - motions[0].turn[0] == pytest.approx(2.0 * np.pi / 15)
    wide, narrow = gears.contact().fit, contact_of(design_of(**completing(2.1))).fit
    assert wide is not None
    assert narrow is not None
    # a space that is wider by so much leaves as much more play across the flanks
    more = wide.normal_backlash[0] - narrow.normal_backlash[0]
    assert more == pytest.approx(0.1 * np.cos(np.radians(20.0)), rel=0.05)
    with pytest.raises(GearmeshError, match=r"pinion\.concave\.tip_radius = .* too thick for the gear's tooth space"):
        gm.build(design_of(**completing(1.0)))


@pytest.mark.sweep
def test_blades_of_one_cutter_that_cross_are_refused_for_their_point_width() -> None:
    """Summaries of pinions whose sides are cut one by one can have blades that cross as one cutter. The refusal computes no
    tooth thickness and advises no width."""
    crossed = completing(-0.4)
    why = "point width negative: the blades of one cutter cross; allowed is more than"
    refused = rf'{why} .*; or cut side by side: process = "fixed_setting"$'
    with pytest.raises(GearmeshError, match=rf"^pinion\.concave\.tip_radius = \S+ mm: {refused}"):
        design_of(**crossed)
    alone = gm.build(design_of(**{**crossed, "process": "fixed_setting"}))
    assert alone.contact(phi1=0.0, cycle=False).path.kind[0] == "point"


@pytest.mark.sweep
def test_refused_teeth_of_given_machines_name_edge_radii_and_index_angles() -> None:
    given = gm.load(SAMPLES / "spiral_bevel_abdullah_straight.toml").with_values({"backlash": 3.0})
    edges = r"a smaller pinion\.concave\.edge_radius and pinion\.convex\.edge_radius \(such as 0\.01\)"
    angles = r"another pinion\.concave\.index_angle and pinion\.convex\.index_angle"
    with pytest.raises(GearmeshError, match=rf"pinion: .*; with these machine settings also {edges}, or {angles}"):
        gm.build(given)


REFUSED = [
    ({"process": "duplex"}, 'process = "duplex": must be one of "fixed_setting", "completing", "formate_fixed"'),
    ({"process": "completing"}, r"pinion\.concave\.radial: missing; process = \"completing\" derives no settings"),
    (
        {"process": "formate_fixed", "gear": {"teeth": 38, "cutter": {"ratio_of_roll": 0.9}}},
        r"gear\.cutter\.ratio_of_roll = 0\.9: the gear of process = \"formate_fixed\" is cut without generating roll",
    ),
    ({"process": "formate_fixed", "mean_point": "cradle_zero"}, r"mean_point = \"cradle_zero\": the gear of process"),
    (
        {"gear": {"teeth": 38, "cutter": {"tilt": 3.0}}},
        r"gear\.cutter\.tilt = 3 deg: the gear's settings can only be derived for",
    ),
    (
        {"pinion": {"teeth": 15, "concave": {"helical_motion": [0.1] * 7}}},
        r"pinion\.concave\.helical_motion = .*must be a list of up to 6 values, each a length in mm",
    ),
    (
        {"pinion": {"teeth": 15, "concave": {"tilt_motion": 0.1}}},
        r"pinion\.concave\.tilt_motion = 0\.1: must be a list of up to 6 values, each an angle in deg",
    ),
    (
        {"pinion": {"teeth": 15, "concave": {"toprem_height": 1.0}}},
        r"pinion\.concave\.toprem_height = 1 mm: needs either toprem_angle",
    ),
    (
        {"gear": {"teeth": 38, "cutter": {"toprem_height": 9.0}}},
        r"gear\.cutter\.toprem_height = 9 mm: needs either toprem_angle",
    ),
    (
        {"gear": {"teeth": 38, "cutter": {"toprem_height": 9.0, "toprem_angle": 5.0}}},
        r"gear\.cutter\.toprem_height = 9 mm: allowed is less than half the depth, ",
    ),
    (
        {"gear": {"teeth": 38, "cutter": {"inside": {"toprem_height": 1.0, "toprem_angle": 25.0}}}},
        r"gear\.cutter\.inside\.toprem_angle = 25 deg: allowed is less than the blade's, 20 deg",
    ),
    (
        {"pinion": {"teeth": 15, "concave": {"toprem_height": 1.0, "toprem_radius": 1.0}}},
        r"pinion\.concave\.toprem_radius = 1 mm: the blade would be hollow; allowed is more than",
    ),
    (
        {"pinion": {"teeth": 15, "concave": {"toprem_height": 0.3, "toprem_radius": 9.0, "edge_radius": 0.9}}},
        r"pinion\.concave\.edge_radius = 0\.9 mm: reaches beyond the toprem; allowed is less than",
    ),
]


@pytest.mark.parametrize(("more", "message"), REFUSED)
@pytest.mark.sweep_cases("more9-gear\\\\.cutter\\\\.toprem_height = 9 mm: allowed is less than half the depth, ")
def test_refused(more: dict[str, Any], message: str) -> None:
    with pytest.raises(GearmeshError, match=message) as error:
        gm.build(design_of(**more))
    assert "\n" not in str(error.value)


@pytest.mark.sweep
def test_sides_that_are_cut_at_once_differ_by_rounding_at_most() -> None:
    """Sliding bases that two solutions have rounded off their own ways; 1e-8 mm is another machine."""
    design = completing(2.2)
    sides = design["pinion"]["concave"], design["pinion"]["convex"]
    for side, base in zip(sides, (-1.5e-15, -9.5e-16), strict=True):
        side["sliding_base"] = base
    assert set(gears_of(**design).members) == {"pinion", "gear"}
    sides[1]["sliding_base"] = 1e-8
    with pytest.raises(GearmeshError, match=r"pinion\.convex\.sliding_base = 1e-08 mm: .*cuts both sides at once"):
        design_of(**design)


def test_sides_that_are_cut_at_once_have_one_machine() -> None:
    design = completing(2.2)
    design["pinion"]["convex"]["radial"] = 70.0
    with pytest.raises(
        GearmeshError, match=r"pinion\.convex\.radial = 70 mm: process = \"completing\" cuts both sides at once"
    ):
        design_of(**design)


@pytest.mark.sweep
@pytest.mark.parametrize(
    "toprem",
    some([{"toprem_radius": 25.0}, {"toprem_angle": 13.0}, {"toprem_height": 0.8, "toprem_angle": 9.0}], 1),
    ids=["arc", "straight", "far out"],
)
def test_a_toprem_relieves_the_root_and_nothing_else(toprem: dict[str, float]) -> None:
    """Its profile by elementary geometry; the flank over it stays, the tooth is closed and loses what the toprem takes."""
    # the same contact of both, for a toprem shortens the path that it would be chosen by
    fixed = {"path_angle": 90.0, "mean_offset": 0.0, "mean_shift": 0.0, "semi_major_axis": 6.0, "modified_roll_c3": 0.0}
    sides = {"concave": {**fixed, "ratio_derivative": -0.008}, "convex": {**fixed, "ratio_derivative": 0.008}}
    blades = {"toprem_height": 1.0, **toprem}
    other = {"toprem_height": 0.8, "toprem_radius": 20.0}
    without = {"pinion": {"teeth": 15, **sides}}
    with_toprem = {
        "pinion": {
            "teeth": 15,
            "concave": {**sides["concave"], **blades},
            "convex": {**sides["convex"], **other},
        }
    }
    gears = gears_of(**with_toprem)
    plain, relieved = gears_of(**without).members["pinion"], gears.members["pinion"]
    blade = generated(gears.design)["pinion concave"].blade
    assert blade.toprem is not None
    (seam,) = blade.tip_breaks
    q = [blade.form_point[1], 0.5 * (blade.form_point[1] + seam), seam + 1e-9, seam - 1e-9, blade.root]
    point, tangent, normal, _ = blade.tip.section(np.array(q))
    # its parameter is its length, all along
    np.testing.assert_allclose(np.linalg.norm(tangent, axis=-1), 1.0, rtol=0, atol=1e-12)
    on_flank = blade.flank.section(np.array(blade.form_point[0]))
    np.testing.assert_allclose(point[0], on_flank[0], rtol=0, atol=1e-12)
    assert point[0, 0] == pytest.approx(blades["toprem_height"], abs=1e-12)
    # the normal goes on where the toprem is an arc and passes smoothly into the rounding, which ends upright on the tip plane
    angles = np.degrees(np.arctan2(normal[:, 0], -normal[:, 1]))
    first = np.degrees(blade.blade_angle) if "toprem_radius" in toprem else toprem["toprem_angle"]
    assert angles[0] == pytest.approx(first)
    assert angles[2] == pytest.approx(angles[3], abs=1e-6)
    assert angles[4] == pytest.approx(90.0)
    assert point[4, 0] == pytest.approx(0.0, abs=1e-12)
    # beyond the prolonged cutting edge, into the tooth
    away = (point[1] - on_flank[0]) @ on_flank[2]
    assert away < -0.001
    s, t = np.linspace(0.35, 1.0, 9), np.linspace(0.0, 1.0, 9)
    grid = plain.tooth.flank_grid(Side.RIGHT, s, t)
    assert grid.p is not None
    assert grid.v is not None
    np.testing.assert_array_equal(relieved.tooth.right.flank.jet(grid.p, grid.v).r, grid.points)
    assert not any("undercut" in line for line in gears.train.warnings)
    solid = gears.solid("pinion", 0.01)
    assert not solid.complaints
    assert relieved.tooth.volume() < plain.tooth.volume()
    assert solid.mesh.volume() == pytest.approx(relieved.tooth.volume(), rel=1e-3)


@pytest.mark.sweep
def test_blades_of_a_cutter_may_differ() -> None:
    cutter = {
        "outside": {"blade_angle": 18.0, "edge_radius": 0.3},
        "inside": {"blade_angle": 22.0, "blade_radius": 700.0},
    }
    gears = gears_of(gear={"teeth": 38, "cutter": cutter})
    design = gears.design
    sides = generated(design)
    concave, convex = sides["gear concave"].blade, sides["gear convex"].blade
    assert np.degrees([concave.blade_angle, convex.blade_angle]) == pytest.approx([18.0, 22.0])
    assert (concave.edge_radius, concave.blade_radius, convex.blade_radius) == (0.3, 0.0, 700.0)
    again = design.with_values(gears.sheet().values)
    for one, other in zip(gears.members.values(), pair_of(again).members.values(), strict=True):
        assert one.tooth.volume() == pytest.approx(other.tooth.volume(), rel=1e-9)


@pytest.mark.sweep
def test_the_sheet_shows_tilt_and_motions_and_loads_back() -> None:
    # with the contact given there is none to look for
    fixed = {
        "path_angle": 90.0,
        "mean_offset": 0.0,
        "mean_shift": 0.0,
        "semi_major_axis": 0.25,
        "modified_roll_c3": 0.0,
    }
    concave = {**fixed, **ALONG_RADIUS["concave"], "ratio_derivative": -0.008, "helical_motion": [0.0, 0.05]}
    convex = {**fixed, **ALONG_RADIUS["convex"], "ratio_derivative": 0.008, "tilt_motion": [0.3]}
    pinion = {"teeth": 15, "concave": concave, "convex": convex, "bore": 0.2}
    gears = gears_of(units="inch", module=0.16, pinion=pinion)
    design, sheet = gears.design, gears.sheet()
    rows = {row[0]: row[1:] for row in sheet.tables[2].rows}
    assert rows["tilt"] == ("deg", pytest.approx(4.0), pytest.approx(-3.0), 0.0, 0.0)
    assert rows["helical motion a2"] == ("inch/rad^2", pytest.approx(0.05), 0.0, 0.0, 0.0)
    assert rows["tilt motion a1"] == ("deg/rad^1", 0.0, pytest.approx(0.3), 0.0, 0.0)
    # the sliding base of a tilted cutter is derived
    assert {f"pinion.{name}.sliding_base" for name in BLADE_SIDES} <= sheet.values.keys()
    again = design.with_values(sheet.values)
    assert again.pinion.concave.helical_motion == (0.0, 0.05)
    for one, other in zip(gears.members.values(), pair_of(again).members.values(), strict=True):
        assert one.tooth.volume() == pytest.approx(other.tooth.volume(), rel=1e-9)


@pytest.mark.parametrize(("process", "within"), [("fixed_setting", 0.02), ("formate_fixed", 1e-4)])
@pytest.mark.sweep_cases("formate_fixed-0.0001")
def test_slot_widths_of_the_gear_are_its_point_width(process: str, within: float) -> None:
    """Slot widths of a Formate gear are the cutter's point width all along the face. A generated gear has nearly that width,
    because its cutter comes to toe and heel from other angles."""
    # nothing of the pinion's contact is searched for
    said = {"mean_offset": 0.0, "mean_shift": 0.0, "modified_roll_c3": 0.0, "path_angle": 90.0}
    sheet = gears_of(process=process, pinion={"teeth": 15, "concave": said, "convex": said}).sheet()
    rows = {row[0]: row[2:] for row in sheet.tables[0].rows}
    for place in ("toe", "mean", "heel"):
        width = rows[f"slot width at the root, {place}"][1]
        assert width == pytest.approx(sheet.values["gear.cutter.point_width"], rel=within)
