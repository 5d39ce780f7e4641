"""Measuring grids and measured flanks: files read back exactly, real flanks go through what was measured, of every kind of gear,
and wrong files are refused in one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearmeshError, Member
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kinds import Side
from gearmesh.metrology.flanks.measuring_grid import MeasuringGrid
from gearmesh.metrology.flanks.point_file import point_text, read_points
from gearmesh.metrology.flanks.projection import FlankProjection
from gearmesh.metrology.flanks.smoothing import smooth_deviations

HEAD = "flank,row,column,x_mm,y_mm,z_mm,nx,ny,nz,deviation_um\n"


def wavy(s: Array, t: Array) -> Array:
    """Deviations, mm."""
    return 0.004 * (s - 0.5) ** 2 - 0.006 * (t - 0.5) ** 2 + 0.003 * s * t + 0.001 * np.sin(5.0 * t)


def write_deviations(path: Path, member: Member, side: Side, shape: tuple[int, int] = (5, 9)) -> MeasuringGrid:
    """A file as an operator completes it."""
    grid = MeasuringGrid.of(member, side, shape)
    values = iter((1e3 * wavy(grid.s[:, None], grid.t)).ravel().tolist())
    lines = point_text([grid], ["a comment"], None, ".csv").splitlines()
    done = [
        f"{line},deviation_um" if line.startswith("flank,") else line if line[0] == "#" else f"{line},{next(values)}"
        for line in lines
    ]
    path.write_text("\n".join(done) + "\n")
    return grid


def write_points(path: Path, points: Array) -> None:
    rows = "".join(f"{x!r},{y!r},{z!r}\n" for x, y, z in points.reshape(-1, 3).tolist())
    path.write_text("x_mm,y_mm,z_mm\n" + rows)


def through_points(design: gm.Design, nominal: Member, path: Path) -> tuple[Member, Array]:
    """A member whose right flank is measured at a grid of points, and how far these are from its flank."""
    grid = write_deviations(path, nominal, Side.RIGHT)
    measured = grid.points + wavy(grid.s[:, None], grid.t)[..., None] * grid.normals
    real = gm.build(design.with_values({f"measured.{nominal.name}_right": str(path)})).members[nominal.name]
    return real, FlankProjection(real.tooth, Side.RIGHT).foot_points(measured.reshape(-1, 3)).distances


@pytest.fixture(scope="module")
def spur() -> gm.Gears:
    return gm.build(gm.load(SAMPLES / "spur.toml"))


@pytest.mark.parametrize("suffix", [".csv", ".txt"])
def test_a_grid_reads_back_to_the_last_digit(spur: gm.Gears, suffix: str, tmp_path: Path) -> None:
    """And its points are on the flank, with its normals; those of the ball a radius away."""
    made = spur.measuring_grid("pinion", ball="2mm", surface="all")
    path = made.save(tmp_path / f"grid{suffix}")
    table = read_points(path).of_flank(Side.LEFT)
    grid = next(grid for grid in made.grids if grid.side is Side.LEFT and not grid.fillet)
    points, normals = table.side_by_side(("x_mm", "y_mm", "z_mm")), table.side_by_side(("nx", "ny", "nz"))
    assert points is not None
    assert normals is not None
    assert np.array_equal(points.reshape(grid.points.shape), grid.points)
    assert np.array_equal(normals.reshape(grid.normals.shape), grid.normals)
    feet = FlankProjection(spur.members["pinion"].tooth, Side.LEFT).foot_points(grid.probe_centres(0.01).reshape(-1, 3))
    np.testing.assert_allclose(feet.distances, 0.01, atol=1e-12)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "member"),
    [
        ("beveloid_crossed", "gear"),
        ("rack", "rack"),
        pytest.param("hypoid", "pinion", marks=pytest.mark.sweep),
        pytest.param("worm_drive", "wheel", marks=pytest.mark.sweep),
        pytest.param("face_gear", "gear", marks=pytest.mark.sweep),
        pytest.param("novikov", "gear", marks=pytest.mark.sweep),
    ],
)
@pytest.mark.sweep_cases("beveloid_crossed-gear")
def test_real_flanks_go_through_what_was_measured(sample: str, member: str, tmp_path: Path) -> None:
    """At the points to rounding; points in space, turned by two pitches and a bit, give the same flank."""
    design = gm.load(SAMPLES / f"{sample}.toml")
    nominal = gm.build(design).members[member]
    real, distances = through_points(design, nominal, tmp_path / "grid.csv")
    np.testing.assert_allclose(distances, 0.0, atol=1e-11)

    cloud = real.tooth.flank_grid(Side.RIGHT, np.linspace(0.05, 0.95, 40), np.linspace(0.05, 0.95, 90))
    joint = nominal.tooth.joint
    away = joint.to(2.0 * nominal.tooth.pitch_angle + 1e-3).point(cloud.points.reshape(-1, 3))
    write_points(tmp_path / "cloud.csv", away)
    again = gm.build(design.with_values({f"measured.{member}_right": str(tmp_path / "cloud.csv")})).members[member]
    # up to the rotation that the fit takes away
    lever = np.array([0.0, 1.0, 0.0]) if joint.travel else np.cross([0.0, 0.0, 1.0], cloud.points)
    there = FlankProjection(again.tooth, Side.RIGHT).foot_points(cloud.points.reshape(-1, 3)).distances
    arm = dot(lever, cloud.normals).ravel()
    rest = there - arm * (arm @ there) / (arm @ arm)
    assert np.sqrt((rest**2).mean()) < 2e-5
    assert np.abs(rest).max() < 1e-4


@pytest.mark.parametrize("axis", range(3))
def test_a_rack_slides_to_its_points_and_does_not_turn(axis: int, tmp_path: Path) -> None:
    """Turned about its frame's axis, points of the mirrored plane of a helical rack would fit too."""
    design = gm.load(SAMPLES / "rack.toml")
    grid = MeasuringGrid.of(gm.build(design).members["rack"], Side.RIGHT, (5, 9), (0.1, 0.1))
    write_points(tmp_path / "rack.csv", grid.points.reshape(-1, 3) * np.where(np.arange(3) == axis, -1.0, 1.0))
    with pytest.raises(GearmeshError, match=r"points|lie on the right flank|from the flank"):
        gm.build(design.with_values({"measured.rack_right": str(tmp_path / "rack.csv")}))


def crowned_and_measured(folder: Path) -> tuple[gm.Contact, gm.Contact]:
    """Contact of a gear that has crownings and slopes by its keys, and by points of its flanks."""
    design = gm.load(SAMPLES / "spur.toml")
    keys = {"helix_crowning": 0.012, "profile_crowning": 0.008, "profile_slope": -0.004}
    crowned = gm.build(design.with_values({f"gear.modifications.{key}": value for key, value in keys.items()}))
    files = {}
    for side in Side:
        grid = MeasuringGrid.of(crowned.members["gear"], side, (17, 9), (0.0, 0.0))
        numbers = np.moveaxis(np.indices(grid.shape), 0, -1)
        rows = np.concatenate((numbers, grid.points, grid.normals, np.zeros((*grid.shape, 1))), axis=-1).reshape(-1, 9)
        lines = "".join(",".join([str(side), *map(repr, row)]) + "\n" for row in rows.tolist())
        files[f"measured.gear_{side}"] = str(folder / f"{side}.csv")
        (folder / f"{side}.csv").write_text(HEAD + lines)
    return crowned.contact(), gm.build(design.with_values(files)).contact()


@pytest.mark.sweep
def test_a_measured_flank_is_that_of_the_design_that_made_it(tmp_path: Path) -> None:
    """Transmission error and backlash."""
    one, other = crowned_and_measured(tmp_path)
    np.testing.assert_allclose(other.path.te, one.path.te, atol=2e-8)
    assert other.summary["backlash_min_deg"] == pytest.approx(one.summary["backlash_min_deg"], abs=1e-5)
    assert np.ptp(one.path.te) > 1e-5


def test_noise_is_smoothed_and_outliers_are_reported(spur: gm.Gears, tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    s, t = rng.random((2, 3000))
    smooth = smooth_deviations(s, t, wavy(s, t) + 0.001 * rng.normal(size=s.size), None)
    lines = np.linspace(0.0, 1.0, 21)
    inner = smooth.at(lines, lines) - wavy(lines[:, None], lines)
    assert np.sqrt((inner**2).mean()) < 1.5e-4
    exact = smooth_deviations(s, t, wavy(s, t), None)
    assert np.abs(exact.residuals).max() < 2e-6
    # one missing point and one that is 30 um off
    write_deviations(tmp_path / "grid.csv", spur.members["pinion"], Side.RIGHT)
    rows = (tmp_path / "grid.csv").read_text().splitlines()
    rows[10] = rows[10].rsplit(",", 1)[0] + ","
    head, value = rows[25].rsplit(",", 1)
    rows[25] = f"{head},{float(value) + 30.0}"
    (tmp_path / "grid.csv").write_text("\n".join(rows))
    gears = gm.build(spur.design.with_values({"measured.pinion_right": str(tmp_path / "grid.csv")}))
    assert any("far from their neighbours: line 26 (3" in warning for warning in gears.warnings)
    assert any("1 of 45 points of its grid have no deviation" in warning for warning in gears.warnings)


def test_planets_that_were_measured_stay_alike(tmp_path: Path) -> None:
    design = gm.load(SAMPLES / "planetary.toml")
    write_deviations(tmp_path / "planet.csv", gm.build(design).as_built.members["planet_1"], Side.RIGHT)
    made = gm.build(design.with_values({"measured.planet_right": str(tmp_path / "planet.csv")})).as_built
    assert made.members["planet_1"].tooth is made.members["planet_3"].tooth
    assert len(made.different) == 2


def test_a_design_counts_its_files_from_where_it_is(tmp_path: Path) -> None:
    """And a wheel that is made without its pinion is as measured too."""
    design = gm.load(SAMPLES / "spur.toml")
    (tmp_path / "data").mkdir()
    write_deviations(tmp_path / "data" / "gear.csv", gm.build(design).members["gear"], Side.LEFT)
    text = (SAMPLES / "spur.toml").read_text() + '\n[measured]\ngear_left = "data/gear.csv"\n'
    (tmp_path / "spur.toml").write_text(text)
    made = gm.build(gm.load(tmp_path / "spur.toml")).members["gear"].tooth
    assert made.left.generated is not None
    assert made.right.generated is None


POINT = "1,1,23.1,-3.5,71.0,0.1,-0.7,-0.7,"
WRONG: dict[str, tuple[str | Callable[[Array], Array], str]] = {
    "nothing": ("", "has no line with the names of columns"),
    "head alone": (HEAD, "has no points"),
    "unknown column": ("x_mm,y_mm,height\n1,2,3\n", 'column "height": allowed'),
    "column without a name": ("x_mm,,y_mm,z_mm\n1,2,3,4\n", 'column "": allowed'),
    "no names of columns": (
        "40.5,1.2,3.3\n40.6,1.3,3.4\n",
        'the first line "40.5 1.2 3.3" names no column: it must name each, as x_mm',
    ),
    "format of other points": ("ply\nformat ascii 1.0\n", 'the first line "ply" names no column'),
    "both units": (
        "s,t,deviation_um,deviation_mm\n0,0,1,1\n",
        "allowed is one of the columns deviation_um and deviation_mm",
    ),
    "no places": ("row,column,deviation_um\n1,1,2\n", "needs the columns x_mm, y_mm, z_mm, or s, t and deviation_um"),
    "short row": (HEAD + "right,1,1\n", "line 2: 3 cells, must be 10"),
    "no number": (HEAD + f"right,{POINT}abc\n", 'line 2: deviation_um = "abc": must be a finite number'),
    "not finite": (HEAD + f"right,{POINT.replace('71.0', 'nan')}1\n", 'line 2: z_mm = "nan": must be a finite number'),
    "flank": (HEAD + f"upper,{POINT}1\n", 'line 2: flank = "upper": must be right or left'),
    "other flank": (HEAD + f"left,{POINT}1\n", "has no points of a right flank"),
    "few": ("s,t,deviation_um\n0.1,0.1,1\n0.5,0.5,1\n", "2 deviations of the right flank, at least 4"),
    "large": ("s,t,deviation_mm\n" + "0.5,0.5,3\n" * 5, "line 2: 3000 um from the flank, at most 1000"),
    "off": ("s,t,deviation_um\n" + "0.5,1.5,3\n" * 5, "line 2: s,t = 0.5,1.5: allowed is from 0 to 1"),
    "mirror image": (lambda points: points * np.array([1.0, -1.0, 1.0]), "they fit the left flank within"),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_files_are_refused_in_one_line(spur: gm.Gears, what: str, tmp_path: Path) -> None:
    content, expected = WRONG[what]
    path = tmp_path / "wrong.csv"
    if callable(content):
        write_points(
            path, content(spur.members["pinion"].tooth.flank_grid("right", [0.1, 0.5, 0.9], [0.1, 0.4, 0.9]).points)
        )
    else:
        path.write_text(content)
    with pytest.raises(GearmeshError) as refusal:
        gm.build(spur.design.with_values({"measured.pinion_right": str(path)}))
    line = str(refusal.value)
    assert expected in line
    assert "\n" not in line


def test_flanks_that_make_no_tooth_are_refused_without_bounds_of_keys(spur: gm.Gears, tmp_path: Path) -> None:
    """Keys were tried without the measured flanks: `pressure_angle = 20 deg: allowed is at most 20 deg`."""
    path, shares = tmp_path / "steep.csv", np.linspace(0.0, 1.0, 5)
    rows = [f"{s},{t},{250 * (i % 2)}\n" for i, s in enumerate(shares) for t in shares]
    path.write_text("s,t,deviation_um\n" + "".join(rows))
    with pytest.raises(GearmeshError, match=r"^measured\.pinion_right and measured\.pinion_left: deviations: "):
        gm.build(spur.design.with_values({f"measured.pinion_{side}": str(path) for side in ("right", "left")}))


def test_modified_flanks_that_were_measured_end_where_they_cross_the_fillet(spur: gm.Gears, tmp_path: Path) -> None:
    """A slope leaves the fillet in an edge, where deviations along both normals come apart (1.4e-5 mm: KindError)."""
    path = tmp_path / "level.csv"
    path.write_text("s,t,deviation_um\n" + "".join(f"{s},{t},20\n" for s in (0, 0.3, 0.6, 1) for t in (0, 0.3, 0.6, 1)))
    modified = spur.design.with_values({"pinion.modifications_right.profile_slope": 0.02})
    real = gm.build(modified.with_values({"measured.pinion_right": str(path)})).members["pinion"]
    shares = np.array([0.0, 0.5, 1.0])
    before = gm.build(modified).members["pinion"].tooth.flank_grid("right", shares, shares)
    after = FlankProjection(real.tooth, Side.RIGHT).foot_points((before.points + 0.02 * before.normals).reshape(-1, 3))
    assert np.abs(after.distances).max() < 1e-9


@pytest.mark.parametrize("length", [1.004, 2.0, 0.0])
def test_deviations_count_along_unit_normals(spur: gm.Gears, length: float, tmp_path: Path) -> None:
    """Normals of another length made 10 um of 5; those rounded to two decimals are taken to unit length."""
    path, grid = tmp_path / "long.csv", spur.measuring_grid("pinion", "right").grids[0]
    lines = np.column_stack((grid.points.reshape(-1, 3), length * grid.normals.reshape(-1, 3)))
    rows = [",".join(f"{value:.17g}" for value in line) + f",{50.0}\n" for line in lines]
    path.write_text("x_mm,y_mm,z_mm,nx,ny,nz,deviation_um\n" + "".join(rows))
    measured = spur.design.with_values({"measured.pinion_right": str(path)})
    if abs(length - 1.0) > 0.01:
        with pytest.raises(GearmeshError, match=rf"line 2: nx,ny,nz have a length of {length:g}: must be unit vectors"):
            gm.build(measured)
        return
    shares = np.array([0.2, 0.5, 0.8])
    grids = [gears.members["pinion"].tooth.flank_grid("right", shares, shares) for gears in (gm.build(measured), spur)]
    apart = ((grids[0].points - grids[1].points) * grids[1].normals).sum(axis=-1)
    # along normals 1.004 long it would be 2e-4 mm; the displaced flank is met beside its foot points
    assert np.abs(apart - 0.05).max() < 5e-5


def test_normals_that_point_into_the_material_are_refused(spur: gm.Gears, tmp_path: Path) -> None:
    path, grid = tmp_path / "inward.csv", spur.measuring_grid("pinion", "right")
    for sign in (1.0, -1.0):
        rows = [
            ",".join(f"{value:.17g}" for value in (*point, *sign * normal, 5.0))
            for point, normal in zip(
                *(of.reshape(-1, 3) for of in (grid.grids[0].points, grid.grids[0].normals)), strict=True
            )
        ]
        path.write_text("x_mm,y_mm,z_mm,nx,ny,nz,deviation_um\n" + "\n".join(rows) + "\n")
        measured = spur.design.with_values({"measured.pinion_right": str(path)})
        if sign > 0.0:
            gm.build(measured)
    with pytest.raises(GearmeshError, match="line 2: nx,ny,nz point into the material, as 45 of 45 do"):
        gm.build(measured)


def test_points_of_the_other_flank_are_told_apart(spur: gm.Gears, tmp_path: Path) -> None:
    other = spur.members["pinion"].tooth.flank_grid("left", [0.1, 0.5, 0.9], [0.1, 0.4, 0.9])
    write_points(tmp_path / "left.csv", other.points)
    with pytest.raises(GearmeshError, match=r"measured\.pinion_right.*they fit the left flank within"):
        gm.build(spur.design.with_values({"measured.pinion_right": str(tmp_path / "left.csv")}))


def test_points_of_a_gear_of_the_other_hand_are_told_apart(tmp_path: Path) -> None:
    """Both ways in which a helical gear can be its mirror image: across the plane of a tooth, and across that of mid face."""
    helical = gm.build(gm.load(SAMPLES / "helical.toml"))
    points = helical.members["pinion"].tooth.flank_grid("right", [0.1, 0.5, 0.9], [0.1, 0.4, 0.9]).points
    for mirror, flank in (([1.0, -1.0, 1.0], "right"), ([1.0, 1.0, -1.0], "left")):
        write_points(tmp_path / "other.csv", points * np.array(mirror))
        with pytest.raises(
            GearmeshError, match=f"they fit the {flank} flank of the mirror image, a gear of the other hand"
        ):
            gm.build(helical.design.with_values({"measured.pinion_right": str(tmp_path / "other.csv")}))
