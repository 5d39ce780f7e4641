"""Friction, flash temperature and film along loaded contacts: closed forms, the heat equation, and units of the standard."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.loaded import loaded_contact
from scipy.integrate import quad

import gearmesh as gm
from gearmesh.contact.hertz import STEEL, contact_modulus
from gearmesh.errors import ArgumentError
from gearmesh.loaded.lubrication import flash_temperature

FRICTION, SPEED, VISCOSITY, EXPONENT = 0.06, 3000.0, 15.0, 18.0


@pytest.mark.sweep
def test_efficiency_is_that_of_shares_and_distances_from_the_pitch_point() -> None:
    """Loss mu F s (1 + N1/N2) of every tooth pair at a distance s from the pitch point, from load shares and rotations alone."""
    loaded = loaded_contact("spur", (200.0,), 9)
    (total,) = loaded.tribology(SPEED, friction=FRICTION).totals
    base, angle = 30.0 * np.cos(np.radians(20.0)), np.radians(20.0)
    # the flank of tooth 0 is on the line of action at s = r_b (phi1 - phi1 of the pitch point)
    at = np.array([row.phi1 for row in loaded.tooth_pair])
    share = np.array([row.load_share for row in loaded.tooth_pair])
    s = base * np.radians(at + 5.095132301)
    # contact stays on the line of action between the tips
    ends = [np.sqrt(tip**2 - (r * np.cos(angle)) ** 2) - r * np.sin(angle) for tip, r in ((33.9, 30.0), (62.1, 60.0))]
    loss = FRICTION / base * (share * 1.5 * np.abs(np.clip(s, -ends[1], ends[0]))).sum() / 9
    assert total.efficiency is not None
    assert total.efficiency == pytest.approx(100.0 / (1.0 + loss), abs=0.01)
    assert total.friction_power == pytest.approx(
        200.0 * SPEED * np.pi / 30.0 * (1.0 - 0.01 * total.efficiency), rel=1e-9
    )


def test_flash_temperature_is_that_of_moving_half_spaces() -> None:
    """The heat equation of a half-space under a semi-elliptic band of heat, integrated; both surfaces share the heat."""
    width, load, sliding = 0.2, 150.0, 3.0
    rolling, thermal = np.array([7.0, 4.0]), (13800.0, 9000.0)
    heat = 1e3 * FRICTION * load * sliding / (2e-3 * width)

    def rise(x: float) -> float:
        """Rise over mean heat, by sqrt(b / u) / B, at x half widths from the middle."""
        first = np.sqrt(max(0.0, x - 1.0))
        return quad(lambda t: 8.0 / np.pi * np.sqrt(max(0.0, 1.0 - (x - t * t) ** 2)), first, np.sqrt(x + 1.0))[
            0
        ] / np.sqrt(np.pi)

    largest = max(rise(x) for x in np.linspace(0.5, 0.8, 31)) * np.sqrt(1e-3 * width / rolling) / thermal
    # equal temperatures: shares of the heat in the inverse ratio of these
    wanted = heat / (1.0 / largest).sum()
    found = flash_temperature(
        FRICTION, np.array([load]), np.array([width]), np.array([sliding]), rolling[None], thermal
    )
    assert found[0] == pytest.approx(wanted, rel=2e-3)


def test_rows_have_the_film_of_the_standard_and_the_pressure_of_hertz() -> None:
    """ISO/TS 6336-22 states the film by pressure, sum velocity and radius in mm: 1600 rho G^0.6 U^0.7 W^-0.13."""
    tribology = loaded_contact("spur", (200.0,), 9).tribology(
        SPEED, friction=FRICTION, viscosity=VISCOSITY, pressure_viscosity=EXPONENT
    )
    reduced = 2.0 * contact_modulus(STEEL, STEEL)
    rows = [row for row in tribology.rows if not row.on_edge]
    for row in rows[::40]:
        assert row.at_speed is not None
        assert row.flash_temperature is not None
        radius, sum_velocity = 1.0 / row.curvature, sum(row.at_speed.rolling.values())
        hertz = np.sqrt(row.line_load * reduced / (2.0 * np.pi * radius))
        assert row.half_width == pytest.approx(2.0 * row.line_load / (np.pi * hertz), rel=1e-9)
        assert row.pressure == pytest.approx(hertz, rel=0.03)
        material, speed = 1e6 * 1e-9 * EXPONENT * reduced, 1e-3 * VISCOSITY * sum_velocity / (2000.0 * reduced * radius)
        film = 1600.0 * radius * material**0.6 * speed**0.7 * (2.0 * np.pi * hertz**2 / reduced**2) ** -0.13
        assert row.film_thickness == pytest.approx(film, rel=1e-9)
        assert row.friction_power == pytest.approx(
            FRICTION * row.line_load * row.length * row.at_speed.sliding, rel=1e-9
        )
    (total,) = tribology.totals
    assert total.min_film_thickness == min(row.film_thickness or np.inf for row in rows)
    assert total.max_flash_temperature == max(row.flash_temperature or 0.0 for row in rows)


@pytest.mark.sweep_cases("helical")
@pytest.mark.parametrize("sample", ["spur", "helical"])
def test_standard_friction_is_that_of_the_pitch_point(sample: str) -> None:
    """ISO/TR 14179-2 from the sheet's geometry; the efficiency is that of this coefficient, and of its local sum velocity."""
    oil, roughness, torque = 30.0, 0.4, {"spur": 400.0, "helical": 900.0}[sample]
    loaded = loaded_contact(sample, (torque,), 3 if sample == "helical" else 9)
    (total,) = loaded.tribology(SPEED, viscosity=oil, roughness=roughness).totals
    tables = gm.build(loaded.design).sheet().plain_tables
    of_pair = {key: values[1] for key, values in tables["Pair"].items() if len(values) == 2}
    working, beta_b, u = np.radians(of_pair["alpha_wt"]), np.radians(of_pair["beta_b"]), of_pair["u"]
    radius = of_pair["a"] / (1.0 + u)
    pitch_speed = 1e-3 * radius * SPEED * np.pi / 30.0
    width = min(tables["Members"]["b"][1:])
    per_width = 1e3 * torque / (radius * np.cos(working)) / width
    reduced = radius * np.sin(working) / np.cos(beta_b) * u / (u + 1.0)
    wanted = 0.048 * (per_width / (2.0 * pitch_speed * np.sin(working) * reduced)) ** 0.2
    wanted *= oil**-0.05 * roughness**0.25
    assert per_width > 150.0
    assert total.standard_friction == pytest.approx(wanted, rel=2e-3)
    same = loaded.tribology(SPEED, friction=total.standard_friction).totals[0].efficiency
    assert total.standard_efficiency == pytest.approx(same, rel=1e-9)
    # loads below 150 N/mm count as 150 N/mm
    light = replace(loaded, mesh=replace(loaded.mesh, torque=0.01 * loaded.mesh.torque))
    least = light.tribology(SPEED, viscosity=oil, roughness=roughness).totals[0].standard_friction
    assert least == pytest.approx(wanted * (150.0 / per_width) ** 0.2, rel=2e-3)


@pytest.mark.sweep
def test_standard_friction_needs_parallel_axes() -> None:
    loaded = loaded_contact("face_gear", (50.0,), 3)
    with pytest.raises(ArgumentError, match=r"roughness = 0\.4 um: must be left out unless the axes are parallel"):
        assert loaded.tribology(SPEED, viscosity=30.0, roughness=0.4).totals


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"friction": 1.0}, "friction = 1"),
        ({"roughness": 0.4, "speed": 10.0}, "roughness = 0.4: the coefficient of friction of ISO/TR 14179-2 needs"),
        ({"roughness": 0.4, "viscosity": 30.0}, "viscosity = 30: the coefficient of friction of ISO/TR 14179-2 needs"),
        ({"speed": 10.0, "viscosity": 0.0, "pressure_viscosity": 1.0}, "viscosity = 0"),
        ({"speed": 10.0, "viscosity": 5.0}, "viscosity = 5: a film needs"),
        ({"viscosity": 5.0, "pressure_viscosity": 20.0}, "viscosity = 5: a film needs speed"),
    ],
)
def test_conditions_that_cannot_be_are_refused(given: dict[str, float], message: str) -> None:
    with pytest.raises(ArgumentError, match=message):
        loaded_contact("spur", (200.0,), 9).tribology(**given)
