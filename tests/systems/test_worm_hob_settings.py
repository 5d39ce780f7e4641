"""The hob at a centre distance and a swivel of its own, and how it is fed, by brute force; backlash by either member."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from oracles.examples import some
from oracles.places import SAMPLES
from scipy.interpolate import CubicSpline

import gearmesh as gm
from gearmesh import DesignError, Rigid, WormDriveDesign, parse
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.systems import diagnosis
from gearmesh.systems.worm_drive.build import hob_thread, nominal_thread, wheel_hob
from gearmesh.systems.worm_drive.force_tables import thread_mesh

SHARES = (np.linspace(0.03, 0.97, 10), np.linspace(0.02, 0.98, 10))
#: turns of the blade to a point, each nearer by the ratio of the teeth
TURNS = 8
#: mm to which a flank has to be what the hob leaves
LEFT = 1e-4


def gears_of(*changes: str) -> gm.Gears:
    return gm.build(gm.load(SAMPLES / "worm_drive.toml", list(changes)))


class Blade:
    """One tooth of the hob, of no width round its axis: its edge in the axial section, and how far points are from it."""

    def __init__(self, gears: gm.Gears, side: Side) -> None:
        own = gears.design.in_mm()
        assert own.kind == "worm_drive"
        self.teeth, self.side = own.wheel.teeth, side.sign
        self.hob = wheel_hob(own, side.sign * (1 if own.worm.right_hand else -1))
        self.thread = self.hob.thread
        self.radii = np.linspace(0.5 * self.thread.radius, self.hob.form_radius, 240)
        p = np.array([self.thread.at_radius(float(radius)) for radius in self.radii])
        known = np.isfinite(p)
        z = self.thread.section.axial_section(p[known])[0][:, 1]
        self.radii = self.radii[known]
        self.edge = CubicSpline(self.radii, z)
        # the machine: the wheel's axis z, the hob's thread before it at the side's flank, nothing turned or fed
        place = self.hob.place(side.sign)
        self.machine = Rigid(place.rotation, place.translation + np.array([self.hob.roll.radius, 0.0, 0.0]))

    def away(self, points: Array, turn: Array, feed: Array, in_feed: Array | float = 0.0) -> tuple[Array, Array]:
        """Axial distance (N,) of points of the wheel from the edge, and polar angle that they have about the hob's axis, where the
        hob has turned by `turn` and is fed along its axis by `feed`, and stands `in_feed` farther away."""
        hand = self.thread.hand
        # indexed by its turn, and by what the feed takes of the wheel's teeth
        wheel = hand * self.thread.threads / self.teeth * turn - 2.0 * feed / (self.thread.module * self.teeth)
        c, s = np.cos(-wheel), np.sin(-wheel)
        x, y, z = np.moveaxis(points, -1, 0)
        turned = np.stack((c * x - s * y - in_feed, s * x + c * y, z + np.zeros_like(c)), axis=-1)
        r = self.machine.inverse.point(turned)
        rho = np.hypot(r[..., 0], r[..., 1])
        off = self.side * (r[..., 2] - feed) - self.edge(rho)
        there = (rho <= self.hob.form_radius + 1e-9) & (rho >= self.radii[0])
        return np.where(there, off, np.inf), np.arctan2(r[..., 1], r[..., 0])


def flank_points(gears: gm.Gears, side: Side) -> Array:
    return gears.members["wheel"].tooth.flank_grid(side, *SHARES).points.reshape(-1, 3)


def least(of: Any, ways: Array, step: float) -> Array:
    """The least value (N,) over a way, from samples, by parabolas."""
    at = ways[np.argmin([of(np.full(1, way)) for way in ways], axis=0)]
    for _ in range(3):
        before, here, after = (of(at + k * step) for k in (-1.0, 0.0, 1.0))
        with np.errstate(invalid="ignore"):
            moved = at + 0.5 * step * (before - after) / (before - 2.0 * here + after)
        at = np.where(np.isfinite(moved), moved, at)
        step *= 0.1
    return np.asarray(of(at))


SETTINGS = (
    ["worm.threads=4", "worm.reference_diameter=50", "center_distance=120"],
    [
        "hob.center_distance=124.4",
        "hob.reference_diameter=63",
        "hob.swivel_angle=1.5",
        "backlash=0.1",
        "backlash_share=0.3",
    ],
    ["hob.center_distance=125.3", "worm.form=ZK", "worm.right_hand=false", "shaft_angle=80"],
    ["worm.form=ZA", "worm.dual_lead=0.02", "hob.swivel_angle=-1"],
)


@pytest.mark.sweep
@pytest.mark.parametrize("changes", some(SETTINGS, 2))
@pytest.mark.sweep_cases("changes3")
def test_a_fly_cutter_fed_along_the_hobs_axis_leaves_the_wheel(changes: list[str]) -> None:
    """100 points of either flank: at every place of the feed the blade turns to each of them, the wheel by both; the least distance
    over the feed."""
    gears = gears_of(*changes)
    length = dict(zip((table := hob_table(gears)).symbols, table.rows, strict=True))["l_0"][2]
    for side in Side:
        blade, points = Blade(gears, side), flank_points(gears, side)

        def cut(feed: Array, blade: Blade = blade, points: Array = points) -> Array:
            turn = np.zeros(len(points))
            for _ in range(TURNS):
                off, turn = blade.away(points, turn, feed)
            return off

        ways = np.linspace(-0.75 * length, 0.75 * length, 201)
        np.testing.assert_allclose(least(cut, ways, 0.1), 0.0, rtol=0, atol=LEFT)


@pytest.mark.sweep
@pytest.mark.parametrize("changes", some(SETTINGS, 1))
def test_a_hob_fed_towards_the_wheel_takes_nothing_on_its_way(changes: list[str]) -> None:
    """At every distance, the whole thread in every position of the roll stays clear of the flanks, the farther the more."""
    gears = gears_of(*changes)
    for side in Side:
        blade, points = Blade(gears, side), flank_points(gears, side)
        clear = []
        for farther in np.array([0.0, 0.01, 0.3, 3.0]):

            def cut(roll: Array, farther: float = farther, blade: Blade = blade, points: Array = points) -> Array:
                # a thread is all its blades: the one at the point's polar angle has turned to it
                feed = -0.5 * blade.thread.module * blade.teeth * roll
                turn = np.zeros(len(points))
                for _ in range(TURNS):
                    screwed = feed + blade.thread.hand * blade.thread.screw * turn
                    off, turn = blade.away(points, turn, screwed, farther)
                return off

            clear.append(least(cut, np.linspace(-0.5, 0.5, 201), 2e-3))
        np.testing.assert_allclose(clear[0], 0.0, rtol=0, atol=LEFT)
        for nearer, farther_off in pairwise(clear):
            # where the thread does not come by at all any more there is no distance
            there = np.isfinite(farther_off)
            assert (farther_off[there] > nearer[there]).all()


def hob_table(gears: gm.Gears) -> Any:
    return next(table for table in gears.sheet().tables if "l_0" in table.symbols)


def sheet_of(gears: gm.Gears) -> dict[str, Any]:
    return {
        symbol: row[2] for table in gears.sheet().tables for symbol, row in zip(table.symbols, table.rows, strict=False)
    }


@pytest.mark.parametrize("form", ["enveloping", "helical"])
@pytest.mark.sweep_cases("enveloping")
def test_backlash_is_the_same_by_either_member(form: str) -> None:
    """Thinner threads, thinner teeth, or both: the teeth's way is the sheet's, and contact is at the same place at phi1 = 0."""
    ways = []
    for share in (1.0, 0.4, 0.0):
        gears = gears_of("backlash=0.2", f"backlash_share={share}", f"wheel.form={form}")
        sheet, summary = sheet_of(gears), gears.contact().summary
        assert summary["backlash_min_deg"] == pytest.approx(sheet["j_phi2"], rel=1e-9)
        assert sheet["s_mx"] == pytest.approx(2.5 * math.pi - share * sheet["j_x"], abs=1e-9)
        if form == "enveloping":
            assert sheet["s_mx0"] == pytest.approx(2.5 * math.pi + (1.0 - share) * sheet["j_x"], abs=1e-9)
        path = gears.contact(phi1=[0.0], cycle=False).path
        ways.append(float(path.phi2[0]))
    assert np.ptp(ways) < 1e-9


@pytest.mark.sweep
def test_a_hob_that_stands_deeper_leaves_more_backlash() -> None:
    """Normal backlash grows by 2 e sin(alpha_n) for a hob that stands deeper by e, at 20 deg. The hob is larger than the worm,
    so that contact stays near the pitch point."""
    larger = ("backlash=0.1", "hob.reference_diameter=75")
    near = sheet_of(gears_of(*larger, "hob.center_distance=132.45"))
    assert near["a_0"] == 132.45
    assert near["j_n"] == pytest.approx(0.1 + 2.0 * 0.05 * math.sin(math.radians(20.0)), abs=5e-4)
    # what it is in the usual place comes from the key, and by contact it is the same
    usual = sheet_of(gears_of(*larger)), sheet_of(gears_of(*larger, "hob.center_distance=132.5"))
    for symbol in ("j_n", "j_x", "j_phi1", "j_phi2"):
        assert usual[1][symbol] == pytest.approx(usual[0][symbol], rel=1e-6)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            ["hob.center_distance=180"],
            "hob.center_distance = 180 mm: the wheel's root lies above its tip$",
        ),
        (
            ["hob.center_distance=20"],
            "hob.center_distance = 20 mm: the hob cuts beyond the wheel's axis$",
        ),
        (
            ["worm.threads=4", "worm.reference_diameter=45", "hob.reference_diameter=50", "hob.pitch_height=-2"],
            "hob.pitch_height = -2: worm or hob have no flanks at this height",
        ),
        (
            ["hob.center_distance=125", "wheel.tip_form=cylindrical", "wheel.outside_diameter=260"],
            "wheel.outside_diameter = 260 mm: the outside cylinder reaches the hob's axis$",
        ),
        (
            ["hob.center_distance=85"],
            "hob.center_distance = 85 mm: the outside cylinder reaches the hob's axis$",
        ),
        (["hob.feed=axial"], 'hob.feed = "axial": must be one of "tangential", "radial"'),
        (
            ["wheel.form=helical", "hob.swivel_angle=1"],
            "hob.swivel_angle = 1.*cannot be given together with wheel.form = helical",
        ),
    ],
)
def test_hobs_that_cannot_be_are_refused(changes: list[str], message: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # without effort for trials: the reason alone, since bounds of values that follow are not bounds of the key
    monkeypatch.setattr(diagnosis, "MAX_EFFORT", 0.0)
    with pytest.raises(DesignError, match=f"^{message}"):
        gears_of(*changes)


@pytest.mark.parametrize("right_hand", [True, False])
@pytest.mark.parametrize("shaft_angle", [70.0, 90.0, 115.0])
@pytest.mark.sweep_cases("90.0-False", "90.0-True")
def test_worm_and_wheel_touch_in_their_pitch_point_by_default(shaft_angle: float, right_hand: bool) -> None:
    """Without a centre distance: both move alike across the thread where the reference cylinder meets the common perpendicular."""
    keys = {"kind": "worm_drive", "module": 4, "shaft_angle": shaft_angle, "wheel": {"teeth": 33}}
    design = parse({**keys, "worm": {"threads": 4, "right_hand": right_hand}})
    (w1, w2), hand = thread_mesh(design).speeds, 1.0 if right_hand else -1.0
    r, centre = np.array([0.5 * design.reference_diameter, 0.0, 0.0]), np.array([design.center_distance, 0.0, 0.0])
    across = np.array([0.0, -hand * np.sin(design.lead_angle), np.cos(design.lead_angle)])
    assert np.cross(w1, r) @ across == pytest.approx(np.cross(w2, r - centre) @ across, rel=1e-12)
    assert design.center_distance - r[0] == pytest.approx(0.5 * design.wheel_reference_diameter, rel=1e-12)


def larger_hob(threads: int, shift: float, **more: Any) -> dict[str, Any]:
    """Keys of a drive whose hob is 10 % larger than the worm; keys of tables are added to theirs."""
    keys: dict[str, Any] = {"kind": "worm_drive", "module": 4, "worm": {"threads": threads, "quotient": 11}}
    keys |= {"wheel": {"teeth": 37, "profile_shift": shift}, "hob": {"reference_diameter": 48.4}}
    for name, value in more.items():
        keys[name] = {**keys.get(name, {}), **value} if isinstance(value, dict) else value
    return keys


@pytest.mark.parametrize("hob_threads", [3, 2])
@pytest.mark.parametrize("right_hand", [True, False])
@pytest.mark.parametrize("shaft_angle", [90.0, 75.0, 105.0])
def test_worm_and_larger_hob_move_along_one_thread_in_the_pitch_point(
    shaft_angle: float, right_hand: bool, hob_threads: int
) -> None:
    """Both as racks over the wheel, by their velocities there: each along its own thread, the threads parallel, as fast across
    them. Nothing of the heights is used but the point itself."""
    keys = larger_hob(3, 0.4, shaft_angle=shaft_angle, worm={"right_hand": right_hand}, hob={"threads": hob_threads})
    design = parse(keys)
    assert isinstance(design, WormDriveDesign)
    worm, hob = nominal_thread(design), wheel_hob(design)
    # the wheel's frame, its x axis towards the worm
    tilt = (1 if right_hand else -1) * np.radians(shaft_angle - 90.0)
    axes = [np.array([0.0, np.cos(tilt), np.sin(tilt)]), hob.place(1).rotation[:, 2]]
    height = design.hob.pitch_height * design.axial_module
    point = np.array([design.center_distance - worm.radius - height, 0.0, 0.0])
    directions, across = [], []
    for thread, axis, distance in zip((worm, hob.thread), axes, (design.center_distance, hob.distance), strict=True):
        along = np.cross(axis, point - np.array([distance, 0.0, 0.0])) + thread.hand * thread.screw * axis
        directions.append(along / np.linalg.norm(along))
        rack = 0.5 * thread.module * design.wheel.teeth * axis
        relative = rack - np.cross([0.0, 0.0, 1.0], point)
        assert np.linalg.norm(np.cross(relative, directions[-1])) < 1e-12 * np.linalg.norm(rack)
        # out of the thread's direction, in the tangent plane
        across.append(float(np.cross(directions[-1], [1.0, 0.0, 0.0]) @ rack))
    np.testing.assert_allclose(directions[0], directions[1], rtol=0, atol=1e-12)
    assert across[0] == pytest.approx(across[1], rel=1e-12)


#: a random drive that jammed by 0.10 mm where threads were tangent on the reference cylinders, and touched on edges alone
DRIVE_132: dict[str, Any] = {
    "module": 2.594,
    "pressure_angle": 24.19,
    "worm": {"quotient": 8.117, "right_hand": False},
    "wheel": {"teeth": 22},
    "hob": {"reference_diameter": 23.322},
}
UNIFORM = (
    larger_hob(3, 0.5),
    larger_hob(3, -0.3, worm={"right_hand": False}),
    larger_hob(4, 0.4, shaft_angle=80.0, contact={"flank": "left"}),
    larger_hob(4, 0.62, **DRIVE_132),
    larger_hob(2, 0.5, hob={"threads": 3, "reference_diameter": 70.0}),
)


@pytest.mark.parametrize("keys", some(UNIFORM, 2))
@pytest.mark.sweep_cases("keys0")
def test_larger_zi_hob_leaves_a_uniform_wheel_without_jamming(keys: dict[str, Any]) -> None:
    """Without backlash: neither flank is ahead anywhere, so nothing jams, and both touch in the pitch point together."""
    contact = gm.build(gm.parse(keys)).contact()
    path, fitted, cycle = contact.path, contact.fit, contact.cycle
    assert fitted is not None
    assert cycle is not None
    flanks = np.isin(path.kind, ("point", "line"))
    assert flanks.sum() > 5
    assert np.ptp(path.te[flanks]) < 1e-9
    assert fitted.fits
    assert abs(fitted.normal_backlash[0]) < 1e-6
    assert cycle.contact_ratio > 1.4


def test_a_stated_swivel_keeps_a_hob_of_the_worms_normal_module() -> None:
    """Files pinned by older versions state a swivel angle and no pitch height. With the height stated, too, the hob is the
    default hob again."""
    design = parse(larger_hob(3, 0.5, hob={"swivel_angle": -1.2}))
    assert isinstance(design, WormDriveDesign)
    made = hob_thread(design)
    assert (design.hob.pitch_height, design.hob.swivel_angle) == (0.0, -1.2)
    assert made.module * math.cos(made.lead_angle) == pytest.approx(design.normal_module, rel=1e-14)
    # and with the height of the pitch point it is the default again
    usual = parse(larger_hob(3, 0.5))
    assert isinstance(usual, WormDriveDesign)
    stated = parse(larger_hob(3, 0.5, hob={"swivel_angle": usual.hob.swivel_angle, "pitch_height": 0.5}))
    assert isinstance(stated, WormDriveDesign)
    assert hob_thread(stated) == hob_thread(usual)


@pytest.mark.quick
@pytest.mark.parametrize(
    "values", [{"hob.reference_diameter": 72.0}, {"hob.threads": 3, "hob.reference_diameter": 90.0}]
)
@pytest.mark.parametrize("nominal", [[], ["hob.reference_diameter=66", "center_distance=126.5"]])
@pytest.mark.sweep_cases("nominal0-values0", "nominal1-values0")
def test_another_hob_has_its_own_setting(values: dict[str, float], nominal: list[str]) -> None:
    """In a row of a study as in a file; a swivel that is stated stays."""
    file = SAMPLES / "worm_drive.toml"
    row = gm.load(file, nominal).with_values(values)
    stated = [f"{key}={value}" for key, value in values.items()]
    assert row.hob == gm.load(file, [*nominal, *stated]).hob
    assert gm.load(file, ["hob.swivel_angle=-0.5"]).with_values(values).hob.swivel_angle == -0.5


@pytest.mark.quick
@pytest.mark.parametrize("angle", [75.0, 90.0, 101.24])
def test_hobs_of_unshifted_wheels_are_tangent_on_the_reference_cylinders(angle: float) -> None:
    """Exactly, whatever a processor rounds: the default is written into pinned files."""
    worm, wheel, hob = {"threads": 4, "quotient": 12.03}, {"teeth": 41}, {"reference_diameter": 51.676}
    drive = {"kind": "worm_drive", "module": 3.689, "worm": worm, "wheel": wheel, "hob": hob, "shaft_angle": angle}
    made = gm.parse(drive)
    assert isinstance(made, WormDriveDesign)
    assert made.hob.pitch_height == 0.0
