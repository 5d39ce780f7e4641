"""Tool paths leave what is asked for and gouge nothing: measured from the file that is written, and by what must be refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES
from oracles.swept_balls import BETWEEN, heights, positions, spheres
from scipy.spatial import cKDTree

import gearmesh as gm
from gearmesh.toolpath.ball import BallCutter, largest_ball
from gearmesh.toolpath.motion import ToolMotion
from gearmesh.toolpath.order import PathOrder
from gearmesh.toolpath.proof import Left, measure_left
from gearmesh.toolpath.space import CutSpace, choose_walls
from gearmesh.toolpath.toolpath import MAX_GOUGE_MM, tool_path

#: points of every wall at which the file is judged
POINTS = 400


def sample(name: str) -> Callable[[], gm.Gears]:
    return lambda: gm.build(gm.load(SAMPLES / f"{name}.toml"), alone=True)


CASES = {
    "spiral bevel, one-way, with stock": (sample("spiral_bevel_basic"), "pinion", "ball:1.1,20", "80um",
                                          {"stock": "30um", "order": "one-way"}),
    "hypoid, left flank": (sample("hypoid"), "gear", "ball:1.9", "40um", {"flank": "left", "surfaces": "flanks"}),
    "hypoid of 5 teeth, 70 deg": (sample("hypoid_high_ratio"), "pinion", "ball:0.5987", "10um", {}),
    "face gear, undercut": (sample("face_gear"), "gear", "ball:2", "100um", {"flank": "right"}),
    "novikov, hollow flanks": (sample("novikov"), "gear", "ball:2.4", "60um", {"lead": 10.0}),
    "formate pinion, sharp inner corner": (sample("spiral_bevel_formate"), "pinion", "ball:1", "10um", {}),
    "formate hypoid, a corner that turns into an edge": (sample("hypoid_formate"), "pinion", "ball:0.603", "20um", {}),
    "worm of 6 threads": (sample("../tests/corpus/contact_worm_drive_left_six_zk"), "worm", "ball:0.95,9", "20um", {}),
    "8 teeth of 0.5 mm, undercut": (lambda: gm.gear(8, module=0.5, face=4), "gear", "ball:0.52", "5um", {}),
}  # fmt: skip


@pytest.mark.parametrize(
    "case", [pytest.param(name, marks=[] if k == len(CASES) - 1 else pytest.mark.sweep) for k, name in enumerate(CASES)]
)
def test_the_file_leaves_no_more_than_asked_and_gouges_nothing(case: str, tmp_path: Path) -> None:
    make, member, tool, scallop, how = CASES[case]
    answer = make().toolpath(member, tool, scallop, **how)
    file = answer.save(tmp_path / "path.cls")
    space, random = answer._path.space, np.random.default_rng(7)
    cut = choose_walls(space, answer.order.flank, answer.order.surfaces)
    sections = space.tooth.sections(np.sort(random.random(25)))
    highest = 0.0
    for k, wall in enumerate(space.walls):
        jet = wall.jet(np.append(random.random(POINTS // 25 - 2), [0.0, 1.0]), sections)
        left = heights(file, jet.r.reshape(-1, 3), jet.n.reshape(-1, 3)) - answer.order.stock
        assert left.min() > -MAX_GOUGE_MM - (0.0 if k in cut else answer.order.stock)
        if k in cut:
            assert left.max() < answer.order.scallop + BETWEEN
            highest = max(highest, float(left.max()))
    # not more passes than the scallop takes: points at random come near to the highest ridge
    assert highest > 0.4 * answer.order.scallop
    assert answer.measured.left_max > 0.7e3 * answer.order.scallop
    assert highest < 1e-3 * answer.measured.left_max + BETWEEN


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("name", "member", "tool"),
    [("worm_drive", "wheel", "ball:1.86"), ("internal", "gear", "ball:1.14"), ("helical_hub", "gear", "ball:3.1,30")],
)
def test_ball_and_shank_stay_out_of_the_whole_solid(name: str, member: str, tool: str, tmp_path: Path) -> None:
    """The file against all vertices of the gear's solid, which are on exact surfaces: end faces, lands, hub and all teeth."""
    gears = sample(name)()
    answer = gears.toolpath(member, tool, "50um")
    file = answer.save(tmp_path / "path.cls")
    points = gears.solid(member, "5um").mesh.vertices
    radius, centres = spheres(file)
    depth = radius - cKDTree(centres).query(points, distance_upper_bound=2.0 * radius)[0]
    assert -1e-3 < depth.max() < MAX_GOUGE_MM
    _, tips, axes, rapid = positions(file)
    cuts = np.flatnonzero(~rapid)
    cuts = cuts[:: max(1, cuts.size // 60)]
    way = points - (tips + radius * axes)[cuts][:, None]
    up = np.einsum("nkj,nj->nk", way, axes[cuts])
    away = np.sqrt(np.maximum((way**2).sum(axis=-1) - up**2, 0.0)) - radius
    shank = away[(up > 0.02 * radius) & (up < answer._path.ball.length)]
    assert shank.min(initial=np.inf) > 0.9 * answer._path.clearance


@pytest.mark.sweep
@pytest.mark.quick
def test_the_proof_reports_a_gouge_and_a_ridge() -> None:
    member, ball, order = gm.gear(17, module=2, face=6).members["gear"], BallCutter(1.3, 10.0), PathOrder(0.02)
    path = tool_path(member, ball, order)
    walls = choose_walls(path.space, "both", "all")

    def measured(motion: ToolMotion) -> Left:
        return measure_left(path.space, walls, path.passes, motion, order)

    assert path.left.gouge < MAX_GOUGE_MM
    assert 0.7 * 0.02 < path.left.scallop <= 0.02
    deeper = replace(path.motion, tips=path.motion.tips - 1e-3 * path.motion.axes)
    assert measured(deeper).gouge == pytest.approx(1e-3, rel=0.05)
    without = path.motion.number != int(np.flatnonzero(path.passes.wall == 4)[-5])
    names = ("tips", "axes", "rapid", "space", "number", "contacts")
    fewer = replace(path.motion, **{name: getattr(path.motion, name)[without] for name in names})
    assert measured(fewer).scallop > 1.5 * path.left.scallop


@pytest.mark.sweep
@pytest.mark.quick
def test_the_largest_ball() -> None:
    """Largest ball of a rack is its tip rounding. The tolerance is the rounding error of 100 mm over the height of an arc of 1
    um. Largest ball of a hypoid pinion's flank touches at its form point and at the root beside it."""
    rack = CutSpace(gm.gear(20, module=4, rack=True).members["rack"])
    assert largest_ball(rack, choose_walls(rack, "both", "all"), PathOrder(0.02)).radius == pytest.approx(
        0.38 * 4.0, abs=1e-7
    )
    assert largest_ball(rack, choose_walls(rack, "both", "all"), PathOrder(0.02, stock=0.1)).radius == pytest.approx(
        1.42, abs=1e-7
    )
    space = CutSpace(sample("hypoid")().members["pinion"])
    radius = largest_ball(space, choose_walls(space, "left", "flanks"), PathOrder(0.02)).radius
    # brute force: at the form point, from 0.8 to 1 of the face, what is farthest within a ball of that radius
    t = np.linspace(0.8, 1.0, 21)
    touched = space.walls[0].jet(np.array([1.0]), space.tooth.sections(t))
    near = space.tooth.sections(np.linspace(0.75, 1.0, 251))
    points = np.concatenate([space.walls[k].jet(np.linspace(0.0, 1.0, 41), near).r.reshape(-1, 3) for k in (1, 2)])
    within = [
        min(float(np.linalg.norm(points - c, axis=1).min()) for c in (touched.r + share * radius * touched.n)[0])
        - share * radius
        for share in (0.99, 1.02)
    ]
    assert within[0] > -1e-9
    assert within[1] < -3e-4


@pytest.mark.sweep
def test_the_holder_stays_clear_of_the_teeth() -> None:
    """Both cylinders over every seventh position against points of the exact teeth beside the space."""
    gears = gm.gear(17, module=2, face=3)
    tooth, grid = gears.members["gear"].tooth, np.linspace(0.0, 1.0, 33)
    points = [tooth.grid(region, grid, tooth.sections(grid)).points.reshape(-1, 3) for region in tooth.regions]
    teeth = np.concatenate(
        [tooth.joint.to(k * tooth.pitch_angle).point(np.concatenate(points)) for k in (-2, -1, 0, 1)]
    )
    answer = gears.toolpath("gear", "ball:1.3,3.5,5", "200um")
    motion, clearance = answer.motion, answer.measured.shank_clearance
    at = np.flatnonzero(np.isfinite(motion.contacts[:, 0]))[::7]
    way = teeth - motion.centres[at][:, None]
    up = np.einsum("nkj,nj->nk", way, motion.axes[at])
    away = np.sqrt(np.maximum((way**2).sum(axis=-1) - up**2, 0.0))
    shank = (away[(up > 0.0) & (up < 3.5)] - 0.65).min()
    holder = (away[up > 3.5] - 2.5).min()
    assert 0.0 < clearance < min(shank, holder)
    # it is the holder that comes near: its rim is measured an eighth of the ball's radius early
    assert holder - 0.08 < clearance < shank - 0.03
    with pytest.raises(gm.NoSolutionError, match=r"shank or holder is 3\.95 mm within a tooth"):
        gears.toolpath("gear", "ball:1.3,3,12", "200um", lead=0.0, tilt=0.0)


@pytest.mark.sweep_cases(
    "--tool ball:9-2---tool = ball:9: the largest ball that fits has a diameter of 1.2048 mm, by the least radius of",
    "--tool ball:1 --stock 9-2---stock = 9 mm: it leaves no room for a ball; allowed is at most 0.59",
)
@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (
            "--tool ball:9",
            2,
            "--tool = ball:9: the largest ball that fits has a diameter of 1.2048 mm, by the least radius of",
        ),
        pytest.param(
            *("--tool ball:1,300 --lead 0", 3, "is a shank of 300 mm clear of the teeth, one of"),
            marks=pytest.mark.sweep,
        ),
        ("--tool ball:1 --spaces 70", 2, "--spaces = 70: must be all, or from 0 to 69"),
        ("--tool cone:9", 2, "--tool = cone:9: must be ball:D, ball:D,L or ball:D,L,H"),
        ("--tool ball:0", 2, "--tool = ball:0: must be ball:D, ball:D,L or ball:D,L,H"),
        ("--tool ball:3,9,2", 2, "each from 0.001 to 10000 mm, H more than D"),
        ("--tool ball:1 --stock 9", 2, "--stock = 9 mm: it leaves no room for a ball; allowed is at most 0.59"),
        pytest.param(
            "--tool ball:0.001 --scallop 1um", 3, "mm long, more than 600000 radii of the ball", marks=pytest.mark.sweep
        ),
        ("--tool ball:1 --flank up", 2, "--flank = up: must be one of right, left, both"),
    ],
)
def test_refusals(arguments: str, status: int, words: str) -> None:
    design = SAMPLES / "internal.toml"
    asked = ("--member", "gear", "--scallop", "100um", *arguments.split())
    assert words in refused("toolpath", design, *asked, status=status)


def test_the_command(tmp_path: Path) -> None:
    asked = (
        "--member",
        "pinion",
        "--tool",
        "ball:2,15",
        "--scallop",
        "100um",
        "--surfaces",
        "flanks",
        "--flank",
        "left",
    )
    status, out, _ = run("toolpath", SAMPLES / "spur.toml", *asked, "-o", tmp_path / "path.csv")
    assert status == 0
    assert [line for line in out.splitlines() if len(line) > 80] == []
    assert (tmp_path / "path.csv").read_text().startswith("space,pass,rapid,x,y,z,i,j,k,contact_x")


@pytest.mark.sweep
def test_every_format_has_the_same_positions(tmp_path: Path) -> None:
    import pyvista

    cls = tmp_path / "path.cls"
    answer = sample("double_helical")().toolpath("pinion", "ball:3,25", "60um", spaces="all", surfaces="flanks")
    answer.save(cls)
    head = cls.read_text().splitlines()
    assert head[0].startswith("PARTNO ")
    assert {"UNITS/MM", "MULTAX/ON", "LOADTL/1", "FEDRAT/500.0000,MMPM", "FINI"} <= set(head)
    assert "CUTTER/3.000000,1.500000,0.000000,1.500000,0.000000,0.000000,26.500000" in head
    assert max(map(len, head)) <= 72
    radius, tips, axes, rapid = positions(cls)
    table = np.genfromtxt(answer.save(tmp_path / "path.csv"), delimiter=",", names=True)
    # the head says which point x, y, z is, and in which unit
    for axis in "xyz":
        assert np.array_equal(table[f"tip_{axis}_mm"], table[axis])
    assert np.array_equal(table["x"], tips[:, 0])
    assert np.array_equal(table["rapid"] == 1.0, rapid)
    # both halves, all spaces: the same turned, and seen in the mirror
    assert np.unique(table["space"]).size == 46
    assert np.linalg.norm(axes, axis=1) == pytest.approx(1.0, abs=1e-6)
    lines = pyvista.read(answer.save(tmp_path / "path.vtp"))
    assert lines.points == pytest.approx(tips + radius * axes, abs=1e-5)
    assert lines.n_lines == len(lines.cell_data["pass"])


def test_threads_that_do_not_open_in_a_section_are_refused_for_it() -> None:
    """In a section across the axis the middle between both tips of one or two threads is beneath their root, whatever the ball."""
    asked = ("--member", "worm", "--tool", "ball:1,5", "--scallop", "20um")
    for name in ("worm_drive", "worm_drive_dual_lead"):
        words = refused("toolpath", SAMPLES / f"{name}.toml", *asked, status=3)
        assert "does not open between its tips" in words


@pytest.mark.sweep
def test_the_largest_ball_of_a_corner_is_measured_between_curved_walls() -> None:
    """A ball between it and the 0.69 mm that flat walls of this angle would have room for is refused; the case above is one of
    the size that is named."""
    gears = sample("hypoid_formate")()
    with pytest.raises(
        gm.DesignError, match=r"diameter of 0\.603\d mm, by what it may leave in the sharp inner corner"
    ):
        gears.toolpath("pinion", "ball:0.62", "20um")
