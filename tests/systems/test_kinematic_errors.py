"""Closed forms of [CR3553] chapter 3 against exact contact: what they leave out is of second order in the error.

And the source's split of the five equations of contact into two and three, as a second solver beside the project's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.examples import some
from oracles.places import SAMPLES
from scipy.optimize import fsolve

import gearmesh as gm
from gearmesh import GearPair, Rigid, load
from gearmesh.check.roll import roll
from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.first_touch.field import candidates
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, rotation_about
from gearmesh.kinds import Mount
from gearmesh.systems.spiral_bevel.conjugate.build import conjugate_blank, conjugate_geometry
from gearmesh.systems.spiral_bevel.errors.kinematic_errors import (
    NominalContact,
    compensation,
    harmonics,
    parallel_axes_eccentricity,
)

PHI1 = np.radians([-3.0, 0.0, 2.0])
SIZES = np.array([0.04, 0.02, 0.01])
PAIRS = [
    (sample, hand, side)
    for sample in ("spiral_bevel_geometry1", "spiral_bevel_geometry2", "spiral_bevel_abdullah_curved")
    for hand, side in (("left", "pinion_convex"), ("right", "pinion_concave"))
]


def solved(pair: Pair, phi1: Array = PHI1) -> ContactPath:
    path = contact_path(pair, phi1, edges=False)
    assert (path.kind == "point").all()
    return path


@cache
def nominal(sample: str, hand: str, side: str) -> tuple[GearPair, Pair, ContactPath, NominalContact]:
    gears = build(sample, hand, side)
    pair, (pinion, gear) = solver_pair(gears), gears.mounts
    path = solved(pair)
    contact = NominalContact(path.point, path.normal, pinion.axis, gear.axis, pinion.sign)
    return gears, pair, path, contact


def build(sample: str, hand: str, side: str, errors: Mapping[str, float] | None = None) -> GearPair:
    keys = [f"assembly.{key}={float(value)!r}" for key, value in (errors or {}).items()]
    return pair_of(load(SAMPLES / f"{sample}.toml", [f"hand={hand}", f"contact.side={side}", *keys]))


def shifted(x: float, y: float, z: float) -> Rigid:
    return Rigid(np.eye(3), np.array([x, y, z]))


def misplaced(pair: Pair, dA: float = 0.0, dG: float = 0.0, dV: float = 0.0, d_delta: float = 0.0) -> Pair:
    """The same teeth, bearings moved: mm and rad."""
    opened = Rigid(rotation_about("y", d_delta), np.zeros(3))
    pinion, gear = pair.pinion.mount, pair.gear.mount
    return mounted(
        pair,
        replace(pinion, base=shifted(0.0, dV, dA) @ pinion.base),
        replace(gear, base=opened @ gear.base @ shifted(0.0, 0.0, dG)),
    )


def mounted(pair: Pair, pinion: Mount, gear: Mount) -> Pair:
    return replace(pair, pinion=replace(pair.pinion, mount=pinion), gear=replace(pair.gear, mount=gear))


def eccentric(mount: Mount, size: float, phase: float) -> Mount:
    return replace(mount, eccentricity=(float(size * np.cos(phase)), float(size * np.sin(phase))))


def direction(mount: Mount, phi: Array) -> Array:
    """The eccentricity as it stands in the fixed frame (..., 3)."""
    return mount.at(phi).vector(np.array([*mount.eccentricity, 0.0]))


def order(remainders: list[float]) -> float:
    """Exponent of the error size in what a closed form leaves out."""
    return float(np.polyfit(np.log(SIZES), np.log(remainders), 1)[0])


@pytest.mark.quick
def test_keys_of_a_design_move_the_bearings_as_defined() -> None:
    _, pair, _, _ = nominal(*PAIRS[0])
    given = {"dA": 0.03, "dG": -0.02, "dV": 0.05, "d_delta": 0.4}
    phases = {"pinion_eccentricity": 0.02, "pinion_phase": 50.0, "gear_eccentricity": 0.01, "gear_phase": -120.0}
    mounts = build(*PAIRS[0], {**given, **phases}).mounts
    moved = misplaced(pair, **{**given, "d_delta": np.radians(0.4)})
    wanted = (
        eccentric(moved.pinion.mount, 0.02, np.radians(50.0)),
        eccentric(moved.gear.mount, 0.01, np.radians(-120.0)),
    )
    for mount, expected in zip(mounts, wanted, strict=True):
        a, b = mount.at(PHI1), expected.at(PHI1)
        np.testing.assert_allclose(a.rotation, b.rotation, rtol=0, atol=1e-14)
        np.testing.assert_allclose(a.translation, b.translation, rtol=0, atol=1e-12)


@pytest.mark.parametrize("pair", some(PAIRS, 2, whole=True), ids="-".join)
@pytest.mark.parametrize("key", ["dA", "dG", "dV", "d_delta"])
def test_misalignment(pair: tuple[str, str, str], key: str) -> None:
    _, teeth, path, contact = nominal(*pair)
    form: dict[str, Callable[[float], Array]] = {
        "dA": contact.pinion_axial,
        "dG": contact.gear_axial,
        "dV": contact.offset,
        "d_delta": contact.shaft_angle,
    }
    unit = np.radians(1.0) if key == "d_delta" else 1.0
    exact = [solved(misplaced(teeth, **{key: float(size * unit)})).phi2 - path.phi2 for size in SIZES]
    remainders = [np.abs(e - form[key](size * unit)).max() for e, size in zip(exact, SIZES, strict=True)]
    assert remainders[-1] < 0.03 * np.abs(exact[-1]).max()
    assert 1.8 < order(remainders) < 2.3


@pytest.mark.quick
def test_displacement_along_the_crown_gear_axis_is_the_axial_ones_together() -> None:
    # -x_f = (-cos, 0, sin) in the pinion's frame; with 90 deg between the axes z is the pinion's and x the gear's axis
    gears, _, _, contact = nominal(*PAIRS[0])
    pitch_angle = np.arctan2(gears.pinion.tooth.teeth, gears.gear.tooth.teeth)
    both = contact.pinion_axial(np.sin(pitch_angle)) + contact.gear_axial(np.cos(pitch_angle))
    np.testing.assert_allclose(contact.crown_axial(1.0, pitch_angle), both, rtol=1e-12)


@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
@pytest.mark.sweep_cases("spiral_bevel_abdullah_curved-left-pinion_convex", "spiral_bevel_geometry2-left-pinion_convex")
def test_eccentricity(pair: tuple[str, str, str]) -> None:
    _, teeth, path, contact = nominal(*pair)
    phases = np.radians([50.0, -120.0])
    # at the mean point, phi1 = 0, the harmonics are exact to first order
    mean = replace(contact, point=contact.point[1], normal=contact.normal[1])
    remainders, harmonic_remainders = [], []
    for size in SIZES:
        mounts = [
            eccentric(flank.mount, e, phase)
            for flank, e, phase in zip(teeth.flanks, (size, 0.7 * size), phases, strict=True)
        ]
        exact = solved(mounted(teeth, *mounts)).phi2 - path.phi2
        vectors = [direction(mount, phi) for mount, phi in zip(mounts, (PHI1, path.phi2), strict=True)]
        remainders.append(np.abs(exact - contact.eccentricity(*vectors)).max())
        t1, t2 = (mount.sign * phase - mount.zero for mount, phase in zip(mounts, phases, strict=True))
        form = harmonics(mean, float(size), float(0.7 * size))
        harmonic_remainders.append(abs(exact[1] - form.at(t1, t2)))
    assert 1.8 < order(remainders) < 2.3
    assert 1.8 < order(harmonic_remainders) < 2.3
    # two waves, written by their crests
    waves = [a * np.cos(t - crest) for a, t, crest in zip(form.amplitudes, (t1, t2), form.phases, strict=True)]
    np.testing.assert_allclose(sum(waves), form.at(t1, t2), rtol=1e-12)


@pytest.mark.sweep
@pytest.mark.sweep_cases("pinion")
@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_roll_and_start_values_follow_an_eccentric_member(member: str) -> None:
    gears, teeth, _, _ = nominal(*PAIRS[-1])
    mounts = {name: each.mount for name, each in gears.members.items()}
    mounts[member] = eccentric(mounts[member], 0.2, np.radians(50.0))
    moved = mounted(teeth, **mounts)
    path = solved(moved)
    # a start value is a place where the flanks meet: never past the first touch, and a grid cell before it
    before = moved.drive * (path.phi2 - moved.ratio * PHI1) - candidates(moved, PHI1).best
    assert (before > 0.0).all()
    assert before.max() < 60.0 * ARCSEC
    pinion, gear = (
        getattr(gears, name).tooth.flank_grid(side, np.linspace(0, 1, 81), np.linspace(0, 1, 101)).points
        for name, side in zip(("pinion", "gear"), gears.flanks, strict=True)
    )
    rolled = roll(
        pinion, gear, (mounts["pinion"], mounts["gear"]), gears.ratio, PHI1, gears.drive, gears.delta, path.phi2
    )
    np.testing.assert_allclose([r.phi2 for r in rolled], path.phi2, rtol=0, atol=0.01 * ARCSEC)
    # the patch's centre lies where the contact point is
    np.testing.assert_allclose([r.centre_limit for r in rolled], path.point, rtol=0, atol=0.05)


@pytest.mark.parametrize("flank", ["right", "left"])
@pytest.mark.sweep_cases("left")
def test_spur_gears(flank: str) -> None:
    same = ["pinion.teeth=30", "gear.teeth=30", "pinion.profile_shift=0", "gear.profile_shift=0"]
    gears = pair_of(load(SAMPLES / "spur.toml", [*same, f"contact.flank={flank}"]))
    teeth, (first_mount, second_mount), radius = solver_pair(gears), gears.mounts, 45.0
    straight = contact_path(teeth, PHI1, edges=False)
    x = (first_mount.origin - second_mount.origin) * [1.0, 1.0, 0.0] / (2.0 * radius)
    y = np.cross(second_mount.sign * second_mount.axis, x)
    angle = -gears.drive * np.radians(20.0)

    def errors(size: float, first: float, second: float) -> tuple[Array, Array]:
        """Exact and closed error, the eccentricities at `first`, `second` (rad) from x at phi1 = 0."""
        mounts = []
        for mount, phi, at in ((first_mount, 0.0, (first, -1.0)), (second_mount, straight.phi2[1], (second, 1.0))):
            wanted = size * (np.cos(at[0]) * x + at[1] * np.sin(at[0]) * y)
            own = mount.at(phi).inverse.vector(wanted)
            mounts.append(replace(mount, eccentricity=(float(own[0]), float(own[1]))))
        path = contact_path(mounted(teeth, *mounts), PHI1, edges=False)
        assert (path.kind == "line").all()
        form = parallel_axes_eccentricity(
            size, size, first + PHI1, second + straight.phi2 - straight.phi2[1], radius, angle
        )
        return path.phi2 - straight.phi2, form

    pairs = [errors(float(size), 0.7, 0.3) for size in SIZES]
    assert 1.9 < order([np.abs(exact - form).max() for exact, form in pairs]) < 2.1
    # made good completely at pi - 2 psi; at pi, where the source has it, the full wave 2 e tan(psi) / r2 remains
    good = [np.abs(errors(float(size), 0.0, np.pi - 2.0 * angle)[0]).max() for size in SIZES]
    assert 1.9 < order(good) < 2.1
    left = errors(0.01, 0.0, np.pi)[0][1]
    np.testing.assert_allclose(abs(left), 2.0 * 0.01 * np.tan(np.radians(20.0)) / radius, rtol=2e-3)


@pytest.mark.quick
@pytest.mark.parametrize("geometry", [1, 2])
@pytest.mark.sweep_cases("2")
def test_compensation_of_the_shaft_angle(geometry: int) -> None:
    pair = (f"spiral_bevel_geometry{geometry}", "left", "pinion_convex")
    design = load(SAMPLES / f"{pair[0]}.toml").in_mm()
    form = conjugate_geometry(design, conjugate_blank(design), "convex")
    step = 1e-2
    phi1 = step * np.arange(-2.0, 3.0)
    teeth = nominal(*pair)[1]
    straight = solved(teeth, phi1).phi2
    pitch_line = np.array([np.sin(form.gamma_1), 0.0, np.cos(form.gamma_1)])
    cradle = form.setting(form.r_k)[1] if geometry == 2 else None
    values, slopes, uncompensated = [], [], []
    for closed in np.radians(SIZES):
        bent = misplaced(teeth, d_delta=-float(closed))
        shift, along = compensation(form.spiral_angle, form.psi_c, form.cone_distance, float(closed), cradle)
        base = shifted(0.0, shift, 0.0) @ shifted(*(along * pitch_line)) @ bent.pinion.mount.base
        error = solved(mounted(bent, replace(bent.pinion.mount, base=base), bent.gear.mount), phi1).phi2 - straight
        values.append(abs(error[2]))
        slopes.append(abs(error[0] - 8.0 * error[1] + 8.0 * error[3] - error[4]) / (12.0 * step))
        uncompensated.append(np.abs(solved(bent, phi1).phi2 - straight).max())
    assert values[0] < 0.01 * uncompensated[0]
    assert order(list(np.hypot(values, slopes))) > 1.8


@pytest.mark.sweep
@pytest.mark.parametrize(("geometry", "hand", "side"), [(1, "right", "concave"), (2, "left", "convex")])
def test_settings_compensate_the_shaft_angle_on_the_exact_contact(geometry: int, hand: str, side: str) -> None:
    """`settings --compensate`: what is solved for parts from [3.5.28-3.5.35] with the square of the error, and does restore."""
    kind = [f"hand={hand}", f"contact.side=pinion_{side}"]
    apart, sizes = [], -SIZES[:2]
    phi1 = np.radians([-0.5, 0.0, 0.5])
    for opened in sizes:
        bent = gm.load(SAMPLES / f"spiral_bevel_geometry{geometry}.toml", [*kind, f"assembly.d_delta={opened}"])
        found = gm.build(bent).compensate()
        closed = [float(row.effect.rsplit(" ", 1)[-1]) for row in found.rows]
        apart.append(np.linalg.norm([row.value_after - form for row, form in zip(found.rows, closed, strict=True)]))
        assert np.linalg.norm(closed) > 3.0 * apart[-1]
    assert 1.8 < np.log2(apart[0] / apart[1]) < 2.2
    straight, spoilt, mended = (
        solved(solver_pair(pair_of(each)), phi1).phi2
        for each in (bent.with_values({"assembly.d_delta": 0.0}), bent, found.apply())
    )
    for error in (np.take, np.diff):
        before, after = (error(each - straight, *([1] if error is np.take else [])) for each in (spoilt, mended))
        assert np.abs(after).max() < 0.02 * np.abs(before).max()


# ---- the split of five equations into two and three [CR3553 3.2.18-27]


def rotations_that_oppose_the_normals(one: Flank, two: Flank, n1: Array, n2: Array, near: Array) -> Array:
    """(phi1, phi2) at which the normals of two given points are opposite [3.2.23, 3.2.24], the solution next to `near`.

    Seen from the pinion's axis only phi2 matters: a cos + b sin + c = 0; then phi1 turns n1 onto -n2.
    """
    first = one.mount.axis
    turns = np.array([0.0, 2.0, 4.0]) * np.pi / 3.0
    f = np.array([first @ two.mount.base.vector(Rigid.about_z(t).vector(n2)) for t in turns]) + n1[2]
    c, a, b = f.mean(), 2.0 / 3.0 * f @ np.cos(turns), 2.0 / 3.0 * f @ np.sin(turns)
    found = []
    for sign in (1.0, -1.0):
        turn2 = np.arctan2(b, a) + sign * np.arccos(np.clip(-c / np.hypot(a, b), -1.0, 1.0))
        wanted = one.mount.base.inverse.vector(-two.mount.base.vector(Rigid.about_z(turn2).vector(n2)))
        turn1 = np.arctan2(wanted[1], wanted[0]) - np.arctan2(n1[1], n1[0])
        angles = np.array([turn1 / one.mount.sign + one.mount.zero, turn2 / two.mount.sign + two.mount.zero])
        found.append(near + (angles - near + np.pi) % (2.0 * np.pi) - np.pi)
    return min(found, key=lambda angles: float(np.abs(angles - near).max()))


def two_subsystems(pair: Pair, u1: float, start: Array, near: Array) -> Array:
    """phi1, phi2 of the contact at pinion parameter u1, by iterating the other three parameters only [3.2.25-3.2.27]."""
    one, two = pair.flanks
    state = {"angles": near}

    def gaps(x: Array) -> Array:
        a = one.surface.jet(np.array(u1), np.array(x[0]))
        b = two.surface.jet(np.array(x[1]), np.array(x[2]))
        state["angles"] = rotations_that_oppose_the_normals(one, two, a.n, b.n, near)
        # the shortest distance of the axes and the axial settings, all in one vector
        return one.mount.at(state["angles"][0]).point(a.r) - two.mount.at(state["angles"][1]).point(b.r)

    solution, _, status, message = fsolve(gaps, start, xtol=1e-14, full_output=True)
    assert status == 1 or np.abs(gaps(solution)).max() < 1e-10, message
    gaps(solution)
    return state["angles"]


@pytest.mark.quick
@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
def test_split_into_two_and_three_equations_finds_the_same_contact(pair: tuple[str, str, str]) -> None:
    moved = misplaced(nominal(*pair)[1], dA=0.03, dV=-0.02, d_delta=float(np.radians(0.02)))
    moved = mounted(moved, eccentric(moved.pinion.mount, 0.03, 1.0), eccentric(moved.gear.mount, 0.02, 2.0))
    path = solved(moved)
    for k in range(len(PHI1)):
        start = np.array([path.params1[k, 1], *path.params2[k]]) + np.array([1e-3, 1e-2, -1e-3])
        near = np.array([path.rotation[k], path.phi2[k]]) + 1e-3
        angles = two_subsystems(moved, float(path.params1[k, 0]), start, near)
        np.testing.assert_allclose(angles, [path.rotation[k], path.phi2[k]], rtol=0, atol=1e-9)


@pytest.mark.sweep_cases("spiral_bevel_geometry1")
@pytest.mark.parametrize("sample", ["spiral_bevel_geometry1", "spiral_bevel_basic"])
def test_the_program_shows_the_closed_form_beside_the_solver(sample: str) -> None:
    """`tca` of a pair with errors has both; they part with the square of the errors. Without errors there is no such column."""
    assert gm.build(gm.load(SAMPLES / f"{sample}.toml")).contact(0.0, cycle=False).first_order is None
    phi1, apart = np.linspace(-3.0, 3.0, 5), []
    for size in (0.01, 0.02):
        errors = {
            "dV": size,
            "dA": -0.5 * size,
            "d_delta": size,
            "pinion_eccentricity": 0.5 * size,
            "pinion_phase": 40.0,
        }
        keys = [f"assembly.{key}={value}" for key, value in errors.items()]
        contact = gm.build(gm.load(SAMPLES / f"{sample}.toml", keys)).contact(phi1, cycle=False)
        assert contact.first_order is not None
        assert "closed form" in str(contact)
        np.testing.assert_allclose(contact.to_dict()["te_first_order_arcsec"], contact.first_order / ARCSEC, rtol=1e-12)
        apart.append(np.abs(contact.first_order - contact.path.te).max())
        assert apart[-1] < 0.1 * np.abs(contact.path.te).max()
    assert 3.0 < apart[1] / apart[0] < 5.0
