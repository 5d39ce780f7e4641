"""Closed forms of [CR3553] chapter 3 against exact contact: what they leave out is of second order in the error.

And the source's split of the five equations of contact into two and three, as a second solver beside the project's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import fsolve

from gearmesh import job
from gearmesh.contact import solver_pair
from gearmesh.design import load
from gearmesh.frames import Array, Rigid
from gearmesh.kinematic_errors import NominalContact, compensation, harmonics
from gearmesh.meshing import Flank
from gearmesh.pair import GearPair
from gearmesh.path import ContactPath
from gearmesh.systems.spiral_bevel_conjugate import conjugate_blank, conjugate_geometry
from gearmesh.tca import contact_path

SAMPLES = Path(__file__).parents[1] / "samples"
PHI1 = np.radians([-3.0, 0.0, 2.0])
SIZES = np.array([0.04, 0.02, 0.01])
PAIRS = [
    (sample, hand, side)
    for sample in ("spiral_bevel_geometry1", "spiral_bevel_geometry2", "spiral_bevel_abdullah_curved")
    for hand, side in (("left", "pinion_convex"), ("right", "pinion_concave"))
]


def solved(gears: GearPair, phi1: Array = PHI1) -> ContactPath:
    path = contact_path(solver_pair(gears), phi1, edges=False)
    assert (path.kind == "point").all()
    return path


@cache
def nominal(sample: str, hand: str, side: str) -> tuple[GearPair, ContactPath, NominalContact]:
    gears = build(sample, hand, side)
    path, stand = solved(gears), gears.assembly
    contact = NominalContact(path.point, path.normal, stand.pinion.axis, stand.gear.axis, stand.pinion.sign)
    return gears, path, contact


def build(sample: str, hand: str, side: str, **errors: float) -> GearPair:
    keys = [f"assembly.{key}={float(value)!r}" for key, value in errors.items()]
    return job.pair(load(SAMPLES / f"{sample}.toml", [f"hand={hand}", f"contact.side={side}", *keys]))


def order(remainders: list[float]) -> float:
    """Exponent of the error size in what a closed form leaves out."""
    return float(np.polyfit(np.log(SIZES), np.log(remainders), 1)[0])


@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
@pytest.mark.parametrize("key", ["dA", "dG", "dV", "d_delta"])
def test_misalignment(pair: tuple[str, str, str], key: str) -> None:
    _, path, contact = nominal(*pair)
    form: dict[str, Callable[[float], Array]] = {
        "dA": contact.pinion_axial,
        "dG": contact.gear_axial,
        "dV": contact.offset,
        "d_delta": lambda degrees: contact.shaft_angle(np.radians(degrees)),
    }
    exact = [solved(build(*pair, **{key: float(size)})).phi2 - path.phi2 for size in SIZES]
    remainders = [np.abs(e - form[key](size)).max() for e, size in zip(exact, SIZES, strict=True)]
    assert remainders[-1] < 0.03 * np.abs(exact[-1]).max()
    assert 1.8 < order(remainders) < 2.3


def test_displacement_along_the_crown_gear_axis_is_the_axial_ones_together() -> None:
    # -x_f = (-cos, 0, sin) in the pinion's frame; with 90 deg between the axes z is the pinion's and x the gear's axis
    gears, _, contact = nominal(*PAIRS[0])
    pitch_angle = np.arctan2(gears.pinion.tooth.teeth, gears.gear.tooth.teeth)
    both = contact.pinion_axial(np.sin(pitch_angle)) + contact.gear_axial(np.cos(pitch_angle))
    np.testing.assert_allclose(contact.crown_axial(1.0, pitch_angle), both, rtol=1e-12)


@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
def test_eccentricity(pair: tuple[str, str, str]) -> None:
    _, path, contact = nominal(*pair)
    remainders, harmonic_remainders = [], []
    for size in SIZES:
        gears = build(
            *pair, pinion_eccentricity=size, pinion_phase=50.0, gear_eccentricity=0.7 * size, gear_phase=-120.0
        )
        stand = gears.assembly
        exact = solved(gears).phi2 - path.phi2
        vectors = [
            mount.at(phi).vector(np.array([*mount.eccentricity, 0.0]))
            for mount, phi in ((stand.pinion, PHI1), (stand.gear, path.phi2))
        ]
        remainders.append(np.abs(exact - contact.eccentricity(*vectors)).max())
        # at the mean point, phi1 = 0, the harmonics are exact to first order
        mean = replace(contact, point=contact.point[1], normal=contact.normal[1])
        t1, t2 = (
            mount.sign * np.radians(phase) - mount.zero for mount, phase in ((stand.pinion, 50.0), (stand.gear, -120.0))
        )
        form = harmonics(mean, float(size), float(0.7 * size)).at(t1, t2)
        harmonic_remainders.append(abs(exact[1] - form))
    assert 1.8 < order(remainders) < 2.3
    assert 1.8 < order(harmonic_remainders) < 2.3


@pytest.mark.parametrize("geometry", [1, 2])
def test_compensation_of_the_shaft_angle(geometry: int) -> None:
    pair = (f"spiral_bevel_geometry{geometry}", "left", "pinion_convex")
    design = load(SAMPLES / f"{pair[0]}.toml").in_mm()
    form = conjugate_geometry(design, conjugate_blank(design), "convex")
    step = 1e-2
    phi1 = step * np.arange(-2.0, 3.0)
    straight = solved(nominal(*pair)[0], phi1).phi2
    pitch_line = np.array([np.sin(form.gamma_1), 0.0, np.cos(form.gamma_1)])
    cradle = form.setting(form.r_k)[1] if geometry == 2 else None
    values, slopes, uncompensated = [], [], []
    for size in SIZES:
        gears = build(*pair, d_delta=-float(size))
        shift, along = compensation(form.spiral_angle, form.psi_c, form.cone_distance, float(np.radians(size)), cradle)
        base = Rigid(np.eye(3), shift * np.array([0.0, 1.0, 0.0]) + along * pitch_line)
        mount = replace(gears.assembly.pinion, base=base)
        moved = replace(gears, assembly=replace(gears.assembly, pinion=mount))
        error = solved(moved, phi1).phi2 - straight
        values.append(abs(error[2]))
        slopes.append(abs(error[0] - 8.0 * error[1] + 8.0 * error[3] - error[4]) / (12.0 * step))
        uncompensated.append(np.abs(solved(gears, phi1).phi2 - straight).max())
    assert values[0] < 0.01 * uncompensated[0]
    assert order(list(np.hypot(values, slopes))) > 1.8


# ---- the split of five equations into two and three [CR3553 3.2.18-27]


def rotations_that_oppose_the_normals(one: Flank, two: Flank, n1: Array, n2: Array, near: Array) -> Array:
    """(phi1, phi2) at which the normals of two given points are opposite [3.2.23, 3.2.24], the solution next to `near`.

    Seen from the pinion's axis only phi2 matters: a cos + b sin + c = 0; then phi1 turns n1 onto -n2.
    """
    first, second = one.mount.axis, two.mount.axis
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
    assert abs(np.linalg.norm(second) - 1.0) < 1e-12
    return min(found, key=lambda angles: float(np.abs(angles - near).max()))


def two_subsystems(pair: GearPair, u1: float, start: Array, near: Array) -> Array:
    """phi1, phi2 of the contact at pinion parameter u1, by iterating the other three parameters only [3.2.25-3.2.27]."""
    one, two = solver_pair(pair).flanks
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


@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
def test_split_into_two_and_three_equations_finds_the_same_contact(pair: tuple[str, str, str]) -> None:
    gears = build(*pair, dA=0.03, dV=-0.02, d_delta=0.02)
    path = solved(gears)
    for k in range(len(PHI1)):
        start = np.array([path.params1[k, 1], *path.params2[k]]) + np.array([1e-3, 1e-2, -1e-3])
        near = np.array([path.rotation[k], path.phi2[k]]) + 1e-3
        angles = two_subsystems(gears, float(path.params1[k, 0]), start, near)
        np.testing.assert_allclose(angles, [path.rotation[k], path.phi2[k]], rtol=0, atol=1e-9)
