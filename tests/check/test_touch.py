"""First touch: tip edges against a closed form, thin overlaps against brute force, refinement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.examples import some
from oracles.places import SAMPLES
from scipy.interpolate import CubicSpline

from gearmesh import GearPair, Rigid, load
from gearmesh.check.heightfield import (
    Arcs,
    GridFlank,
    HeightFlank,
    MeshFlank,
    PatchedFlank,
    Rays,
    Slides,
    first_highest,
)
from gearmesh.check.members import flank_patches, roll_flanks
from gearmesh.check.touch import FirstTouch, first_touch
from gearmesh.contact.flanks import analyse
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.kinds import Side

ARCS = Arcs(1.0, 0.0)


# --- an involute spur pair beyond its line of action ------------------------------------------------------------------


@dataclass(frozen=True)
class Spur:
    """An unmodified spur pair of a design, its pinion's right flank driving: base radii, tip radii, centre distance.

    `start`: the pinion's rotation at which its flank touches at the pitch point, read off its exact flank.
    """

    base: tuple[float, float]
    tip: tuple[float, float]
    centre: float
    start: float

    @staticmethod
    def of(pair: GearPair) -> Spur:
        centre = pair.gear.mount.origin - pair.pinion.mount.origin
        distance = float(np.hypot(*centre[:2]))
        working = distance * pair.pinion.tooth.teeth / sum(member.tooth.teeth for member in pair.both)
        base = 0.5 * 3.0 * np.cos(np.radians(20.0)) * np.array([member.tooth.teeth for member in pair.both])
        grid = pair.pinion.tooth.flank_grid(Side.RIGHT, np.linspace(0.0, 1.0, 200), [0.5]).points[:, 0]
        own = CubicSpline(np.hypot(grid[:, 0], grid[:, 1]), np.arctan2(grid[:, 1], grid[:, 0]))(working)
        line = np.arctan2(centre[1], centre[0])
        tips = tuple(member.tooth.blank.tip.radius for member in pair.both)
        return Spur((base[0], base[1]), tips, distance, float(line - own))

    @property
    def working_angle(self) -> float:
        return float(np.arccos(sum(self.base) / self.centre))

    def te_of_edge(self, member: int, turn: float) -> float:
        """TE (rad, of the gear, < 0 behind) where a member's tip edge touches the mating gear's flank; `turn` from the pitch point.

        With both members turning by their own angles in the sense of the motion, a point of radius r on the pinion stands at
        the angle turn + inv(working) - inv(r) from the line of centres. The mating gear's flank through that point of the plane
        says how far the gear has turned. The gear's tip is the same seen from the other side, for the motion backwards.
        """
        one, other = member, 1 - member
        involute = lambda angle: np.tan(angle) - angle  # noqa: E731
        own, mating = self.base[one], self.base[other]
        tip = self.tip[one]

        def mating_turn(own_turn: float) -> float:
            at = own_turn + involute(self.working_angle) - involute(np.arccos(own / tip))
            across, along = tip * np.sin(at), self.centre - tip * np.cos(at)
            pressure = np.arccos(mating / np.hypot(across, along))
            return float(np.arctan2(across, along) + involute(self.working_angle) - involute(pressure))

        if member == 0:
            return mating_turn(turn) - turn * own / mating
        # the gear's turn that gives the pinion's, by bisection: seen from the gear, backwards
        low, high = -turn * mating / own - 0.3, -turn * mating / own + 0.3
        for _ in range(200):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if mating_turn(middle) < -turn else (low, middle)
        return -0.5 * (low + high) - turn * mating / own


@pytest.mark.sweep_cases("gear_tip-0.3", "pinion_tip-0.02", "pinion_tip-0.3")
@pytest.mark.parametrize("beyond", some([0.02, 0.1, 0.3], 2))
@pytest.mark.parametrize("edge", ["pinion_tip", "gear_tip"])
def test_tip_edges_beyond_the_line_of_action_follow_the_closed_form(edge: str, beyond: float) -> None:
    pair = pair_of(load(SAMPLES / "spur.toml"))
    spur = Spur.of(pair)
    member = 0 if edge == "pinion_tip" else 1
    reach = np.sqrt(spur.tip[member] ** 2 - spur.base[member] ** 2) - spur.base[member] * np.tan(spur.working_angle)
    turn = (1 if member == 0 else -1) * (reach / spur.base[0] + beyond * pair.pitch)
    # the pinion turns towards positive angles or negative ones, as its right flank drives
    sense = pair.pinion.mount.sign
    way = 1.0 if sense * pair.drive * np.sign(pair.ratio) > 0 else -1.0
    phi1 = sense * (spur.start + way * turn)
    at, zero = roll_flanks(pair, [phi1, sense * spur.start])
    assert at is not None
    assert zero is not None
    te = pair.drive * (at.phi2 - zero.phi2 - pair.ratio * (phi1 - sense * spur.start))
    expected = spur.te_of_edge(member, turn)
    assert expected < 0.0
    assert at.on_rims[member]
    assert abs(te + 2.0 * np.pi * np.round((expected - te) / (2.0 * np.pi)) - expected) < 1e-3 * ARCSEC


# --- narrow overlaps --------------------------------------------------------------------------------------------------


def sheet(corners: Array, height: Array, count: int) -> Array:
    """Grid (count, count, 3) over the quadrangle `corners` (4, 2) of (rho, z), theta = height . (1, rho, z, (rho - 60)^2)."""
    a, b = np.meshgrid(np.linspace(0.0, 1.0, count), np.linspace(0.0, 1.0, count), indexing="ij")
    weights = np.stack(((1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b), axis=-1)
    rho, z = np.moveaxis(weights @ corners, -1, 0)
    theta = height[0] + height[1] * rho + height[2] * z + height[3] * (rho - 60.0) ** 2
    return np.stack((rho * np.cos(theta), rho * np.sin(theta), z), axis=-1)


def triangles(grid: Array) -> Array:
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    return np.concatenate((np.stack((a, b, c), axis=-2), np.stack((a, c, d), axis=-2))).reshape(-1, 3, 3)


def touched(pinion: HeightFlank, gear: HeightFlank) -> FirstTouch | None:
    fields = [f.over(ARCS, Rigid.identity(), side) for f, side in ((pinion, 1.0), (gear, -1.0))]
    return first_touch(fields[0], fields[1], ARCS)


SQUARE = np.array([[50.0, 0.0], [60.0, 0.0], [60.0, 10.0], [50.0, 10.0]])
PINION = np.array([0.0, 0.002, 0.003, -1e-4])
GEAR = np.array([0.1, -0.001, 0.0005, 0.0])
DIFFERENCE = PINION - GEAR


def advance(place: Array) -> Array:
    rho, z = place[..., 0], place[..., 1]
    found: Array = DIFFERENCE[0] + DIFFERENCE[1] * rho + DIFFERENCE[2] * z + DIFFERENCE[3] * (rho - 60.0) ** 2
    return found


def diagonal(width: float) -> Array:
    """A quadrangle that shares with the square a strip of that width along its upper left side, turned a little."""
    return np.array([[48.0, 9.0], [59.0, 10.0 - width], [61.0, 20.0], [50.0, 19.0]])


@pytest.mark.parametrize(
    ("made", "within"), [(GridFlank, 1e-9), (lambda grid: MeshFlank(triangles(grid)), 2e-7)], ids=["grid", "facets"]
)
@pytest.mark.parametrize("size", [1e-1, 1e-3, 1e-5])
def test_a_corner_on_a_corner_is_touched(size: float, made: type[GridFlank], within: float) -> None:
    other = np.array([[60.0 - size, 10.0 - size], [70.0, 9.0], [70.0, 20.0], [59.0, 20.0]])
    found = touched(made(sheet(SQUARE, PINION, 41)), made(sheet(other, GEAR, 41)))
    assert found is not None
    # the advance grows in rho and z: the corner of the square is inside the other sheet
    expected = float(advance(np.array([60.0, 10.0])))
    assert abs(found.turn - expected) < within
    assert found.on_rims == (True, False)


@pytest.mark.parametrize("width", [0.5, 0.05, 0.005])
@pytest.mark.sweep_cases("0.005", "0.5")
def test_a_thin_strip_of_overlap_is_seen_as_brute_force_sees_it(width: float) -> None:
    other = diagonal(width)
    found = touched(GridFlank(sheet(SQUARE, PINION, 41)), GridFlank(sheet(other, GEAR, 41)))
    # brute force: points of the upper side of the square and of the lower side of the other, each if inside its mating gear
    share = np.linspace(0.0, 1.0, 2_000_001)[:, None]
    upper = np.array([50.0, 10.0]) + share * np.array([10.0, 0.0])
    lower = other[0] + share * (other[1] - other[0])
    above = upper[:, 1] - other[0, 1] - (upper[:, 0] - other[0, 0]) * (other[1, 1] - other[0, 1]) / 11.0 >= 0.0
    beside = (upper[:, 0] - other[1, 0]) * (other[2, 1] - other[1, 1]) - (upper[:, 1] - other[1, 1]) * 2.0 <= 0.0
    values = np.concatenate(
        (advance(upper[above & beside]), advance(lower[(lower[:, 1] <= 10.0) & (lower[:, 0] >= 50.0)]))
    )
    assert found is not None
    assert abs(found.turn - values.max()) < 1e-7
    assert found.turn >= values.max() - 1e-12


@pytest.mark.parametrize("width", [1e-2, 1e-5])
def test_narrow_sheets_that_cross_touch_where_their_rims_cross(width: float) -> None:
    """No corner and no middle of a segment of either is on the other: only the crossings of their rims tell."""
    lying = np.array([[50.0, 5.0], [60.0, 5.3], [60.0, 5.3 + width], [50.0, 5.0 + width]])
    standing = np.array([[54.1, 0.0], [54.1 + width, 0.0], [54.4 + width, 10.0], [54.4, 10.0]])
    found = touched(GridFlank(sheet(lying, PINION, 41)), GridFlank(sheet(standing, GEAR, 41)))
    # the right side of the one that stands crosses the upper side of the one that lies
    z = (0.03 * (54.1 + width - 50.0) + 5.0 + width) / (1.0 - 0.03 * 0.03)
    expected = float(advance(np.array([54.1 + width + 0.03 * z, z])))
    assert found is not None
    assert found.on_rims == (True, True)
    assert abs(found.turn - expected) < 1e-11


def test_a_summit_inside_a_strip_is_found() -> None:
    """A greatest advance on neither rim, in a diagonal strip that no centre of the first cells is in."""
    summit = np.array([55.31, 5.17])
    t = np.linspace(-1.0, 1.0, 61)
    a, b = np.meshgrid(t, t, indexing="ij")

    def strip(turn: float, half: float, along_bend: float, across_bend: float) -> Array:
        along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
        # bent, for the centres of the first cells are on the diagonal of a straight one
        place = summit + 5.0 * a[..., None] * along + (half * b + 0.7 * a * (a + 0.3))[..., None] * across
        theta = -along_bend * (5.0 * a) ** 2 - across_bend * (half * b) ** 2
        rho = place[..., 0]
        return np.stack((rho * np.cos(theta), rho * np.sin(theta), place[..., 1]), axis=-1)

    # the rims are 2 arcsec lower than the summit between them
    found = touched(GridFlank(strip(0.8, 5e-5, 1e-3, 4e3)), GridFlank(strip(0.8, 7e-5, 0.0, 0.0)))
    assert found is not None
    assert abs(found.turn) < 1e-10
    assert found.on_rims == (False, False)


def test_sheets_that_only_seem_to_overlap_do_not_touch() -> None:
    apart = np.array([[50.0, 10.5], [60.0, 10.001], [60.0, 20.0], [50.0, 20.0]])
    tilted = np.array([[58.0, 10.5], [60.5, 8.4], [70.0, 10.0], [60.0, 20.0]])
    assert touched(GridFlank(sheet(SQUARE, PINION, 21)), GridFlank(sheet(apart, GEAR, 21))) is None
    assert touched(GridFlank(sheet(SQUARE, PINION, 21)), GridFlank(sheet(tilted, GEAR, 21))) is not None
    tilted[:2] = [[58.0, 12.5], [62.5, 8.4]]
    assert touched(GridFlank(sheet(SQUARE, PINION, 21)), GridFlank(sheet(tilted, GEAR, 21))) is None


def test_a_fold_is_met_on_its_better_sheet() -> None:
    """A quarter barrel round an axis beside that of the circles: they meet it twice, and the pinion's higher sheet counts."""
    angle = np.linspace(-0.6, 0.6, 61)
    z = np.linspace(0.0, 10.0, 21)
    barrel = np.stack(
        np.broadcast_arrays(100.0 - 40.0 * np.cos(angle)[:, None], 40.0 * np.sin(angle)[:, None], z), axis=-1
    )
    field = GridFlank(barrel).over(ARCS, Rigid.identity(), 1.0)
    place = np.array([[62.0, 5.0], [66.0, 3.0]])
    found = field.at(place)
    # the circle rho^2 = 100^2 + 40^2 - 2 100 40 cos(angle) about the axis
    at = np.arccos((100.0**2 + 40.0**2 - place[:, 0] ** 2) / 8000.0)
    expected = np.arctan2(40.0 * np.sin(at), 100.0 - 40.0 * np.cos(at))
    np.testing.assert_allclose(found.height, expected, atol=1e-9)
    np.testing.assert_allclose(
        GridFlank(barrel).over(ARCS, Rigid.identity(), -1.0).at(place).height, -expected, atol=1e-9
    )


# --- refinement -------------------------------------------------------------------------------------------------------

#: designs whose pair leaves its path over tips, heels and corners, and the pinion's rotations (pitches)
LEAVING = {
    "spiral_bevel_basic": [],
    "zerol": ["assembly.dV=0.1"],
    "face_gear": ["assembly.d_gamma=0.1"],
    "beveloid_crossed": ["assembly.gamma_h=0.3"],
    "helical": ["assembly.gamma_v=0.05"],
}


@pytest.mark.sweep
@pytest.mark.sweep_cases("face_gear", "spiral_bevel_basic")
@pytest.mark.parametrize("name", some(LEAVING, 3))
def test_finer_grids_move_the_touch_by_less_than_5_milliarcseconds(name: str) -> None:
    pair = pair_of(load(SAMPLES / f"{name}.toml", LEAVING[name]))
    phi1 = np.array([-0.9, 0.05, 0.8]) * pair.pitch
    path = analyse(pair, phi1)
    guess = np.where(path.touching, path.phi2, pair.ratio * phi1)
    coarse, fine = (roll_flanks(pair, path.rotation, cells, guess) for cells in (80, 160))
    found = 0
    for k, (one, other) in enumerate(zip(coarse, fine, strict=True)):
        assert (one is None) == (other is None)
        if one is None or other is None:
            continue
        found += 1
        assert abs(one.phi2 - other.phi2) < 0.005 * ARCSEC
        if path.kind[k] == "point":
            assert abs(one.phi2 - path.phi2[k]) < 0.005 * ARCSEC
    assert found >= 2


def test_patches_are_one_flank() -> None:
    """A flank cut in two along its stations is touched as the whole one, at the cut too."""
    pair = pair_of(load(SAMPLES / "spiral_bevel_basic.toml"))
    halves = [flank_patches(m.tooth, side, 60).flank for m, side in zip(pair.both, pair.flanks, strict=True)]
    whole = halves[0]
    assert isinstance(whole, PatchedFlank)
    (grid,) = whole.patches
    assert isinstance(grid, GridFlank)
    cut = PatchedFlank((GridFlank(grid.grid[:, :31]), GridFlank(grid.grid[:, 30:])))
    to_base = pair.gear.mount.base.inverse @ pair.pinion.mount.at(0.0)
    sense = pair.drive * pair.gear.mount.sign
    centre = to_base.point(grid.points).mean(axis=0)
    arcs = Arcs(sense, float(np.arctan2(centre[1], centre[0])))
    own = halves[1].points.mean(axis=0)
    gear = halves[1].over(Arcs(sense, float(np.arctan2(own[1], own[0]))), Rigid.identity(), -1.0)
    turns = []
    for flank in (whole, cut):
        found = first_touch(flank.over(arcs, to_base, 1.0), gear, arcs)
        assert found is not None
        turns.append(found.turn)
    assert abs(turns[0] - turns[1]) < 1e-3 * ARCSEC


@pytest.mark.quick
def test_first_of_the_highest_hits_counts() -> None:
    """Per line, as sorting by line and height would give it; equal heights keep their order."""
    random = np.random.default_rng(3)
    owner = np.sort(random.integers(0, 300, 1000))
    height = random.integers(-2, 3, 1000) / 2.0
    order = np.lexsort((-height, owner))
    wanted = order[np.diff(owner[order], prepend=-1) > 0]
    np.testing.assert_array_equal(first_highest(owner, height), wanted)


@pytest.mark.parametrize("chart", [Arcs(1.0, 0.0), Slides(-1.0, 20.0), Rays()], ids=["arcs", "slides", "rays"])
@pytest.mark.sweep_cases("arcs", "slides")
def test_half_planes_lose_no_line(chart):
    """Lines through points of triangles hit the same with the half planes of the sides and without them.

    Some triangles are as long as they are far from the axis, so that sides bend; some are thin.
    """
    rng = np.random.default_rng(5)
    corners = rng.normal(scale=6.0, size=(60, 3, 3)) + np.array([10.0, 0.0, 0.0])
    corners[::3, 2] = corners[::3, 0] + 1e-3 * (corners[::3, 2] - corners[::3, 0])
    shares, hits = rng.dirichlet(np.full(3, 0.3), size=40), 0
    for triangle in corners:
        flat, _ = chart.split(shares @ triangle)
        field, without = (MeshFlank(triangle[None]).over(chart, Rigid.identity(), 1.0) for _ in range(2))
        vars(without)["_sides"] = np.broadcast_to(np.array([0.0, 0.0, 1.0])[:, None], (3, 3, 1))
        np.testing.assert_array_equal(field.at(flat).height, without.at(flat).height)
        hits += np.isfinite(field.at(flat).height).sum()
    assert hits > 1500
