"""Friction heat, flash temperature and lubricant film of a contact across which both surfaces roll and slide.

All functions are for a line of contact:

- w: load per length.
- 1/rho: relative curvature across the contact.
- E*: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.
- u1, u2: rolling velocities of the surfaces through the contact.
- v_g: sliding velocity.

Sources:

- Half width: Hertz, b = sqrt(4 w rho / (pi E*)).
- Flash temperature: H. Blok, 1937 and 1963. Two half-spaces share the heat of a semi-elliptic band so that both are equally hot:
  1.11 mu w v_g / (sqrt(2 b) (B1 sqrt(u1) + B2 sqrt(u2))), B = sqrt(lambda rho c). ISO/TS 6336-20 is based on it.
  It holds if heat has no time to flow along the surface: Peclet number u b rho c / (4 lambda) above 5.
- Film: D. Dowson and G. R. Higginson, Elasto-Hydrodynamic Lubrication, 1966: h = 1.6 rho G^0.6 U^0.7 W^-0.13 with E' = 2 E*,
  G = alpha E', U = eta (u1 + u2) / (2 E' rho), W = w / (E' rho). ISO/TS 6336-22 has this film, and a factor for the heat of
  sliding that is not applied here.
- Mean coefficient of friction: ISO/TR 14179-2:2001, mu = 0.048 (F_bt / (b v_sum rho))^0.2 eta^-0.05 Ra^0.25 at the pitch point, for
  mineral oil (X_L = 1), with F_bt / b in N/mm, sum velocity in m/s, rho in mm, viscosity in mPa s, roughness in um.
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array

#: heat conductivity of steel, W/(m K)
STEEL_CONDUCTIVITY = 50.0
#: heat capacity of steel per volume, J/(m^3 K)
STEEL_HEAT_CAPACITY = 3.8e6
#: sqrt(lambda rho c) of steel, N/(m sqrt(s) K)
STEEL_THERMAL_CONTACT = float(np.sqrt(STEEL_CONDUCTIVITY * STEEL_HEAT_CAPACITY))
#: largest flash temperature over that of the mean heat of a semi-elliptic band on a half-space, by sqrt(2 b / u) / B
BLOK_FACTOR = 1.11
#: least load per face width, N/mm, for the mean coefficient of friction: smaller loads count as this one
LEAST_FACE_LOAD = 150.0
#: largest circumferential speed, m/s, for it: faster gears count as slow as this one
LARGEST_PITCH_SPEED = 50.0
#: least Peclet number at which heat has no time to flow along the surface
LEAST_PECLET = 5.0


def half_width(line_load: Array, curvature: Array, modulus: float) -> Array:
    """Return half widths (...,), mm, of contacts under loads per length (...,), N/mm.

    - `curvature` (...,): relative curvature across the contact, 1/mm.
    - `modulus`: E*, MPa.
    """
    width: Array = np.sqrt(4.0 * line_load / (np.pi * modulus * curvature))
    return width


def flash_temperature(
    friction: float, line_load: Array, width: Array, sliding: Array, rolling: Array, thermal: tuple[float, float]
) -> Array:
    """Return flash temperatures (...,), K: largest rise of the surfaces over their bulk temperature.

    - `friction`: coefficient of friction.
    - `line_load` (...,): load per length, N/mm.
    - `width` (...,): half width of the contact, mm.
    - `sliding` (...,): sliding velocity, m/s.
    - `rolling` (..., 2): rolling velocities of both surfaces, m/s.
    - `thermal`: thermal contact coefficients of both bodies, N/(m sqrt(s) K).
    """
    heat = friction * 1e3 * line_load * sliding
    taken_up = np.sqrt(np.abs(rolling)) @ np.array(thermal)
    flash: Array = BLOK_FACTOR * heat / (np.sqrt(2e-3 * width) * taken_up)
    return flash


def peclet_number(rolling: float, width: float) -> float:
    """Return the Peclet number of a surface: its rolling velocity, m/s, times half width, mm, over 4 diffusivities."""
    return 1e-3 * width * rolling * STEEL_HEAT_CAPACITY / (4.0 * STEEL_CONDUCTIVITY)


def film_thickness(
    line_load: Array, curvature: Array, entrainment: Array, modulus: float, viscosity: float, pressure_viscosity: float
) -> Array:
    """Return least film thicknesses (...,), um; 0 without entrainment.

    - `line_load` (...,): load per length, N/mm.
    - `curvature` (...,): relative curvature across the contact, 1/mm.
    - `entrainment` (...,): mean rolling velocity, m/s.
    - `modulus`: E*, MPa.
    - `viscosity`: dynamic viscosity at the bulk temperature of the teeth, mPa s.
    - `pressure_viscosity`: its exponent over pressure, 1/GPa.
    """
    radius, stiffness = 1e-3 / curvature, 2e6 * modulus
    material = 1e-9 * pressure_viscosity * stiffness
    speed = 1e-3 * viscosity * np.maximum(entrainment, 0.0) / (stiffness * radius)
    load = 1e3 * line_load / (stiffness * radius)
    film: Array = 1e6 * 1.6 * radius * material**0.6 * speed**0.7 * load**-0.13
    return film


def mean_friction(
    face_load: float, pitch_speed: float, working_angle: float, curvature: float, viscosity: float, roughness: float
) -> float:
    """Return the mean coefficient of friction of a mesh of parallel axes under mineral oil [ISO/TR 14179-2].

    - `face_load`: transverse force at the base circle per face width, N/mm.
    - `pitch_speed`: circumferential speed of the working pitch circles, m/s.
    - `working_angle`: working transverse pressure angle, rad.
    - `curvature`: relative curvature at the pitch point, across the contact, 1/mm.
    - `viscosity`: dynamic viscosity at the temperature of the oil, mPa s.
    - `roughness`: arithmetic mean roughness Ra of both flanks, um.
    """
    sum_velocity = 2.0 * min(pitch_speed, LARGEST_PITCH_SPEED) * np.sin(working_angle)
    load = max(face_load, LEAST_FACE_LOAD) * curvature / sum_velocity
    return float(0.048 * load**0.2 * viscosity**-0.05 * roughness**0.25)
