"""Hertz contact: closed forms, a published table, the integral of the displacements, and gears in contact under a torque."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from oracles.built import contact_of, pair_of
from oracles.hertz import at_peak, squared_ratio
from oracles.places import SAMPLES
from scipy.special import ellipe, ellipkm1, elliprd

from gearmesh import DesignError, load
from gearmesh.answers import tables
from gearmesh.contact import hertz
from gearmesh.contact.flanks import hertz_path, separation_curvatures
from gearmesh.contact.hertz import Material, PointContact, contact_modulus, line_contact, normal_force, point_contact
from gearmesh.kernel.numeric.algebra import Array

MODULUS = 113000.0
#: F(rho) = (kappa_y - kappa_x) / (kappa_y + kappa_x), a*, b*, delta*: T. A. Harris, Rolling Bearing Analysis, table of
#: dimensionless contact parameters; to the printed digits
HARRIS = np.array(
    [
        (0.1075, 1.0760, 0.9318, 0.9974),
        (0.3204, 1.2623, 0.8114, 0.9761),
        (0.5916, 1.6440, 0.6687, 0.9077),
        (0.6716, 1.8258, 0.6245, 0.8733),
        (0.83495, 2.494, 0.5186, 0.7602),
        (0.90999, 3.233, 0.4499, 0.6636),
        (0.983797, 6.448, 0.3150, 0.4352),
        (0.990902, 8.062, 0.2814, 0.3745),
        (0.997300, 12.789, 0.2232, 0.2705),
    ]
)


def displacement(contact: PointContact, x: Array, y: Array, chords: int = 4000) -> Array:
    """Sum of both surfaces' displacements (P,) at points inside the ellipse: p / (pi E* distance) integrated chord by chord.

    Along a chord the pressure is a semi-ellipse over its length, whose integral is pi / 4 of its length times its peak.
    """
    theta = np.pi * (np.arange(chords) + 0.5) / chords
    a, b, p0 = (float(v) for v in (contact.semi_major, contact.semi_minor, contact.peak_pressure))
    c, s = np.cos(theta) / a, np.sin(theta) / b
    x, y = x[:, None] / a, y[:, None] / b
    slope = c**2 + s**2
    # 1 - (x + c r)^2 - (y + s r)^2 = top - slope (r - r0)^2
    top = 1.0 - x**2 - y**2 + (x * c + y * s) ** 2 / slope
    return (0.5 * np.pi * p0 * top / np.sqrt(slope)).mean(axis=1) / MODULUS


@pytest.mark.quick
@pytest.mark.parametrize("ratio", [1.0, 0.999999, 0.7, 0.1, 0.003])
def test_displacement_closes_the_gap(ratio: float) -> None:
    kappa = np.array([0.2 * ratio, 0.2])
    found = point_contact(kappa[0], kappa[1], 300.0, MODULUS)
    radius, angle = np.meshgrid([0.0, 0.4, 0.8, 0.99], np.radians([0.0, 20.0, 45.0, 90.0]))
    x = float(found.semi_major) * (radius * np.cos(angle)).ravel()
    y = float(found.semi_minor) * (radius * np.sin(angle)).ravel()
    gap = 0.5 * (kappa[0] * x**2 + kappa[1] * y**2)
    np.testing.assert_allclose(displacement(found, x, y) + gap, float(found.approach), rtol=1e-11)
    volume = 2.0 / 3.0 * np.pi * found.semi_major * found.semi_minor * found.peak_pressure
    np.testing.assert_allclose(volume, 300.0)


@pytest.mark.quick
@pytest.mark.parametrize("radius", [0.5, 20.0])
def test_sphere_on_a_plane_and_equal_crossed_cylinders(radius: float) -> None:
    """[J85 4.22-4.24]: curvature 1/R either way."""
    found = point_contact(1.0 / radius, 1.0 / radius, np.array([1.0, 500.0]), MODULUS)
    force = found.force
    a = np.cbrt(0.75 * force * radius / MODULUS)
    np.testing.assert_allclose(found.semi_major, a, rtol=1e-12)
    np.testing.assert_allclose(found.semi_minor, a, rtol=1e-12)
    np.testing.assert_allclose(found.approach, a**2 / radius, rtol=1e-12)
    np.testing.assert_allclose(
        found.peak_pressure, np.cbrt(6.0 * force * MODULUS**2 / (np.pi**3 * radius**2)), rtol=1e-12
    )


@pytest.mark.quick
def test_published_table() -> None:
    difference = HARRIS[:, 0]
    # lengths in units in which both factors of the table's definitions, 3 F / (2 E* sum) and sum / 2, are 1 and 1/2
    found = point_contact(0.5 * (1.0 - difference), 0.5 * (1.0 + difference), 2.0 / 3.0, 1.0)
    computed = np.stack((found.semi_major, found.semi_minor, 2.0 * found.approach), axis=-1)
    # half a unit of the last printed digit
    np.testing.assert_allclose(computed, HARRIS[:, 1:], rtol=2.3e-4)


@pytest.mark.quick
def test_nearly_round_and_nearly_a_line() -> None:
    # q = 1 - (4/3) e + O(e^2) for curvatures in the ratio 1 - e
    e = 2.0 ** -np.arange(5.0, 14.0)
    miss = 1.0 - 4.0 / 3.0 * e - squared_ratio(1.0 - e, 1.0)
    assert (np.abs(miss) < 0.3 * e**2).all()
    np.testing.assert_allclose(np.log2(miss[:-1] / miss[1:])[-3:], 2.0, atol=1e-2)
    # each cross section of a long ellipse is in line contact under its own load per length
    thin = point_contact(np.array([1e-12, 1e-100, 1e-280]), 0.1, 100.0, MODULUS)
    line = line_contact(0.1, 0.5 * np.pi * thin.peak_pressure * thin.semi_minor, MODULUS)
    np.testing.assert_allclose(thin.peak_pressure, line.peak_pressure, rtol=1e-10)
    np.testing.assert_allclose(thin.semi_minor, line.half_width, rtol=1e-10)


@pytest.mark.quick
def test_ratio_solves_its_equation_from_end_to_end() -> None:
    ratio = np.geomspace(1e-200, 1.0, 4001)
    q = squared_ratio(ratio, 1.0)
    assert (np.diff(q) > 0.0).all()
    inner = ratio > 1e-14
    k, e = ellipkm1(q[inner]), ellipe(1.0 - q[inner])
    # [J85 4.28], with integrals by another method; its differences lose digits towards the circle
    with np.errstate(divide="ignore", invalid="ignore"):
        closed = q[inner] * (k - e) / (e - q[inner] * k)
    away = q[inner] < 0.9
    np.testing.assert_allclose(closed[away], ratio[inner][away], rtol=1e-12)


@pytest.mark.quick
def test_powers_of_the_force_and_order_of_arguments() -> None:
    kappa, other = np.array([[0.03], [0.4]]), np.array([0.05, 0.4, 1e-5])
    one, wanted = point_contact(kappa, other, 1.0, MODULUS), point_contact(kappa, other, 80.0, MODULUS)
    assert wanted.peak_pressure.shape == wanted.force.shape == (2, 3)
    again, swapped = at_peak(kappa, other, wanted.peak_pressure, MODULUS), point_contact(other, kappa, 80.0, MODULUS)
    for name, power in (("force", 3), ("peak_pressure", 1), ("semi_major", 1), ("semi_minor", 1), ("approach", 2)):
        expected = getattr(one, name) * 80.0 ** (power / 3.0)
        for found in (wanted, swapped, again):
            np.testing.assert_allclose(getattr(found, name), expected, rtol=1e-13)


@pytest.mark.quick
def test_cylinders_along_a_line() -> None:
    """[J85 4.43-4.45] for two cylinders of steel and brass."""
    first, second = Material(206000.0, 0.3), Material(100000.0, 0.35)
    modulus = contact_modulus(first, second)
    radius, load = 1.0 / (1.0 / 30.0 + 1.0 / 70.0), 120.0
    found = line_contact(1.0 / radius, load, modulus)
    np.testing.assert_allclose(found.half_width, np.sqrt(4.0 * load * radius / (np.pi * modulus)), rtol=1e-12)
    np.testing.assert_allclose(found.peak_pressure, np.sqrt(load * modulus / (np.pi * radius)), rtol=1e-12)
    np.testing.assert_allclose(0.25 * np.pi * found.peak_pressure * 2.0 * found.half_width, load, rtol=1e-12)


@pytest.mark.quick
def test_no_load_and_bad_input() -> None:
    nothing = point_contact(0.1, 0.2, 0.0, MODULUS)
    assert nothing.peak_pressure == nothing.semi_major == nothing.approach == 0.0
    assert line_contact(0.1, 0.0, MODULUS).peak_pressure == 0.0
    for bad, words in (
        (lambda: point_contact(0.0, 0.1, 5.0, MODULUS), "relative curvature = 0: allowed is a finite number above 0"),
        (lambda: point_contact([0.1, -0.2], 0.1, 5.0, MODULUS), "relative curvature = -0.2: allowed is"),
        (lambda: point_contact(0.1, np.nan, 5.0, MODULUS), "relative curvature = nan: allowed is"),
        (lambda: point_contact(0.1, 0.1, -5.0, MODULUS), "force = -5: allowed is a finite number from 0"),
        (lambda: line_contact(0.1, 5.0, 0.0), "modulus = 0: allowed is"),
        (lambda: line_contact(0.1, -1.0, MODULUS), "load = -1: allowed is"),
        (lambda: Material(poisson_ratio=0.6), "poisson_ratio = 0.6: allowed is above -1 and up to 0.5"),
        (lambda: Material(youngs_modulus=0.0), "youngs_modulus = 0 MPa: allowed is"),
    ):
        with pytest.raises(DesignError) as refused:
            bad()
        assert str(refused.value).startswith(words)


@pytest.mark.quick
def test_normal_force() -> None:
    """A force along n through a point at the arm r cos(alpha) from the axis, with a part along the axis that has no moment."""
    alpha, beta = np.radians([20.0, 15.0])
    normal = np.array([-np.sin(alpha), np.cos(alpha) * np.cos(beta), np.cos(alpha) * np.sin(beta)])
    origin, axis = np.array([3.0, -2.0, 50.0]), np.array([0.0, 0.0, 1.0])
    point = np.array([[3.0 + 60.0, -2.0, 7.0], [3.0 + 30.0, -2.0, 7.0]])
    wanted = 50e3 / (np.array([60.0, 30.0]) * np.cos(alpha) * np.cos(beta))
    np.testing.assert_allclose(normal_force(50e3, point, normal, origin, axis), wanted, rtol=1e-14)
    np.testing.assert_allclose(normal_force(50e3, point, -normal, origin, axis, 0.25), -0.25 * wanted, rtol=1e-14)
    assert np.isinf(normal_force(1.0, origin + 5.0 * normal, normal, origin, axis))


@pytest.mark.sweep
def test_crossed_beveloid_pair_under_50_nm() -> None:
    design = load(SAMPLES / "beveloid_crossed.toml")
    gears, found = pair_of(design), contact_of(design, 50.0, cycle=False)
    assert found.hertz is not None
    # the common rack's normal is at the normal pressure angle everywhere: the arm is m N cos(alpha) / 2
    np.testing.assert_allclose(found.hertz.force, 50e3 / (60.0 * np.cos(np.radians(20.0))), rtol=1e-12)
    ellipse = np.stack((found.path.semi_major, found.path.semi_minor), axis=-1)
    kappa = separation_curvatures(gears, found.path)
    np.testing.assert_allclose(0.5 * kappa * ellipse**2, np.full((5, 2), gears.delta), rtol=1e-9)
    modulus = contact_modulus(Material(206000.0, 0.3), Material(206000.0, 0.3))
    along, across = (2.0 * gears.delta / ellipse**2).T
    wanted = point_contact(along, across, found.hertz.force, modulus)
    np.testing.assert_allclose(found.hertz.peak_pressure, wanted.peak_pressure, rtol=1e-9)
    assert found.summary["max_pressure_mpa"] == found.hertz.peak_pressure.max()
    rows = found.document()["positions"]
    assert set(rows[2]["hertz"]) == {"p0_mpa", "a_mm", "b_mm", "approach_um", "force_n"}
    np.testing.assert_allclose(rows[2]["hertz"]["approach_um"], 1e3 * wanted.approach[2], rtol=1e-9)
    # the same shape as the overlap by the approach, but smaller
    assert (found.hertz.semi_minor < np.sqrt(2.0 * found.hertz.approach / kappa[:, 1])).all()
    plain = contact_of(design, cycle=False)
    assert "hertz" not in plain.document()["positions"][0]
    assert "hertz_p0_mpa" in found.csv()
    assert "hertz" not in plain.csv()
    with pytest.raises(DesignError, match="torque = 0 Nm: allowed is"):
        hertz_path(gears, plain.path, 0.0)


@pytest.mark.quick
def test_spur_pair_in_line_contact() -> None:
    """Involutes, whose radii of curvature add up to the line of action; the load is T / r_b over the narrower face."""
    design: Any = load(SAMPLES / "spur.toml", ["contact.phi1.start=-4", "contact.phi1.stop=4", "contact.phi1.count=3"])
    gears, found = pair_of(design), contact_of(design, 30.0, cycle=False)
    assert found.hertz is not None
    assert set(found.path.kind) == {"line"}
    alpha = np.radians(design.pressure_angle)
    pitch = 0.5 * design.module * np.array([member.tooth.teeth for member in gears.both])
    base = pitch[0] * np.cos(alpha)
    first = np.sqrt((found.path.point1[:, :2] ** 2).sum(axis=1) - base**2)
    kappa = 1.0 / first + 1.0 / (pitch.sum() * np.sin(alpha) - first)
    modulus = contact_modulus(hertz.STEEL, hertz.STEEL)
    wanted = np.sqrt(30e3 / (base * design.gear.face_width) * modulus / np.pi * kappa)
    np.testing.assert_allclose(found.hertz.peak_pressure, wanted, rtol=1e-9)
    np.testing.assert_allclose(found.hertz.semi_major, 0.5 * design.gear.face_width, rtol=1e-9)
    row = found.document()["positions"][0]
    assert tables.plain(row["hertz"])["approach_um"] is None


def test_edges_have_no_hertz_contact() -> None:
    design = load(SAMPLES / "beveloid_crossed.toml", ["contact.phi1.start=20", "contact.phi1.stop=0"])
    found = contact_of(design, 50.0, cycle=False)
    kinds = found.path.kind
    assert {"point"} < set(kinds)
    for kind, row in zip(kinds, found.document()["positions"], strict=True):
        assert (row["hertz"] is None) == (kind != "point")
    assert "Hertz contact, 50 Nm on the pinion, all on this tooth pair" in [t.title for t in found.listings]


def test_contact_in_a_point_loads_no_scipy() -> None:
    """It took a tenth of the time of whole commands."""
    code = "import sys; from gearmesh.contact.hertz import point_contact; point_contact(1.0, 2.0, 3.0, 4.0); "
    subprocess.run([sys.executable, "-c", code + "assert 'scipy' not in sys.modules"], check=True)


@pytest.mark.parametrize("q", [1e-250, 1e-12, 0.3, 1.0 - 1e-12, 1.0])
def test_elliptic_integrals_keep_their_digits(q: float) -> None:
    d, b = hertz._integrals(np.array([q]))
    assert d[0] == pytest.approx(elliprd(0.0, q, 1.0) / 3.0, rel=2e-15)
    # K - D, which is log(4 / sqrt(q)) times smaller than K
    assert b[0] == pytest.approx(q * elliprd(0.0, 1.0, q) / 3.0, rel=1e-15 * max(2.0, np.log(4.0 / np.sqrt(q))))
