"""Nominal stresses of ISO 6336-2 and -3 against the formulas for the hob's rack and Hertz at the pitch point."""

from __future__ import annotations

import math

import pytest
from oracles.iso6336 import Hobbed

import gearmesh as gm
from gearmesh.contact.hertz import Material, contact_modulus, line_contact
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.sheet import pair_factors

#: materials of different moduli
MATERIALS = (Material(206000.0, 0.3), Material(110000.0, 0.27))
TORQUE = 1.5e5


def design_of(helix_angle: float, **keys: object) -> gm.Design:
    return gm.parse(
        {
            "kind": "cylindrical",
            "module": 2.5,
            "helix_angle": helix_angle,
            "backlash": 0.05,
            "pinion": {"teeth": 22, "face_width": 24, "profile_shift": 0.2},
            "gear": {"teeth": 40, "face_width": 22},
            **keys,
        }
    )


def test_contact_stress_of_a_published_example() -> None:
    """ISO/TR 6336-30, example 1: F_t = 127.352 kN, Z_H = 2.3953, Z_eps = 0.803, Z_beta = 1.0194, sigma_H0 = 1206.58 MPa."""
    members = {"pinion": {"teeth": 17, "profile_shift": 0.145}, "gear": {"teeth": 103, "profile_shift": 0.0}}
    example: dict[str, object] = {"kind": "cylindrical", "module": 8, "helix_angle": 15.8}
    example |= {name: {**keys, "face_width": 100} for name, keys in members.items()}
    gears = gm.build(gm.parse({**example, "assembly": {"center_distance": 500}}))
    factors = pair_factors(gears.design, gears.pairs[0])
    assert factors is not None
    assert factors.tangential_force(9e6) == pytest.approx(127352.0, rel=1e-5)
    assert factors.zone == pytest.approx(2.3953, abs=5e-5)
    # its tips are rounded
    assert factors.contact_ratio == pytest.approx(0.803, abs=1e-3)
    assert factors.flank_helix == pytest.approx(1.0194, abs=5e-5)
    steel = Material(206000.0, 0.3)
    assert factors.contact_stress(9e6, contact_modulus(steel, steel)) == pytest.approx(1206.58, rel=1e-3)


@pytest.mark.parametrize("helix_angle", [0.0, 12.0])
@pytest.mark.sweep_cases("12.0")
def test_root_stress_by_the_formulas_of_the_hob(helix_angle: float) -> None:
    gears = gm.build(design_of(helix_angle))
    factors = pair_factors(gears.design, gears.pairs[0])
    assert factors is not None
    found, sheet = proportions(gears.design), gears.sheet()
    symbols = {key: sheet.plain_tables[table.title][key][1:] for table in sheet.tables for key in table.symbols}
    beta, m, width = math.radians(helix_angle), 2.5, 22.0
    force = 2.0 * TORQUE * math.cos(beta) / (22 * m)
    overlap = width * math.sin(beta) / (math.pi * m)
    y_beta = 1.0 - min(overlap, 1.0) * helix_angle / 120.0
    for k, teeth in enumerate((found.mesh.pinion, found.mesh.gear)):
        spec = (gears.design.pinion, gears.design.gear)[k]
        hob = Hobbed(
            teeth.teeth,
            teeth.alpha,
            beta,
            spec.profile_shift,
            spec.dedendum,
            spec.tool_tip_radius,
            teeth.allowance / m,
        )
        chord, fillet, _ = hob.root()
        arm, angle = hob.load(symbols["d_Na"][k] / m, symbols["d"][k] / m, symbols["eps_alpha"][0])
        y_f = 6.0 * arm * math.cos(angle) / (chord**2 * math.cos(teeth.alpha))
        y_s = (1.2 + 0.13 * chord / arm) * (0.5 * chord / fillet) ** (1.0 / (1.21 + 2.3 * arm / chord))
        # the normal section of a helical tooth is that of its virtual gear to a fraction of a per cent
        assert factors.root_stress(TORQUE)[k] == pytest.approx(
            force / (width * m) * y_f * y_s * y_beta, rel=5e-3 if helix_angle else 1e-8
        )


@pytest.mark.parametrize(
    ("helix_angle", "keys"), [(0.0, {}), (12.0, {}), (0.0, {"gear": {"teeth": -63, "face_width": 22}})]
)
@pytest.mark.sweep_cases("0.0-keys2", "12.0-keys1")
def test_contact_stress_is_hertz_at_the_pitch_point(helix_angle: float, keys: dict[str, object]) -> None:
    """Cylinders with the curvature of both base cylinders' tangents at the pitch point, over mean lengths of contact."""
    gears = gm.build(design_of(helix_angle, **keys))
    (pair,) = gears.pairs
    factors = pair_factors(gears.design, pair)
    assert factors is not None
    mesh, sheet = proportions(gears.design).mesh, gears.sheet()
    eps_alpha = sheet.plain_tables["Pair"]["eps_alpha"][1]
    pinion, gear, working = mesh.pinion, mesh.gear, mesh.working_angle
    beta_b, width = abs(pinion.beta_b), 22.0
    radii = [teeth.base_radius * math.tan(working) / math.cos(beta_b) for teeth in (pinion, gear)]
    # normal force over the mean length of contact; spur gears have all load on part of the width
    overlap = width * math.sin(math.radians(helix_angle)) / (math.pi * 2.5)
    lines = 1.0 / ((4.0 - eps_alpha) / 3.0 * (1.0 - min(overlap, 1.0)) + min(overlap, 1.0) / eps_alpha)
    normal_force = TORQUE / (pinion.base_radius * math.cos(beta_b))
    line_load = normal_force * math.cos(beta_b) / (width * lines)
    modulus = contact_modulus(*MATERIALS)
    kappa = [1.0 / radii[0], gear.sense / radii[1]]
    pressure = float(line_contact(sum(kappa), line_load, modulus).peak_pressure)
    # Z_beta of the standard is beyond Hertz
    wanted = pressure / math.sqrt(math.cos(math.radians(helix_angle)))
    assert factors.contact_stress(TORQUE, modulus) == pytest.approx(wanted, rel=1e-9)
