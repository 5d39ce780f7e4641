"""Nominal stresses of ISO 6336-2:2006 and ISO 6336-3:2006 (method B), without load factors.

- contact stress: sigma_H0 = Z_H Z_E Z_eps Z_beta sqrt(F_t / (d_1 b) (u + 1) / u), Hertz's line at the pitch point.
- root stress: sigma_F0 = F_t / (b m_n) Y_F Y_S Y_beta, a force at the outer point of single contact.

The critical section of Y_F and Y_S is that of the teeth as cut (`root`), not of the standard's own generating rack. Rim
factor Y_B and deep-tooth factor Y_DT are 1.
"""

from __future__ import annotations

import math

from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction
from gearmesh.systems.cylindrical.geometry.root import CriticalSection, lever, load_angle

#: largest helix angle that counts for Y_beta, deg [ISO 6336-3]
MAX_HELIX_ANGLE_DEG = 30.0
#: angle over which Y_beta falls to 0 at an overlap ratio of 1, deg [ISO 6336-3]
HELIX_ANGLE_RANGE_DEG = 120.0


@dataclass(frozen=True)
class NominalFactors:
    """Factors of the nominal stresses of a mesh; form and correction are NaN for a member without a tangent of 30 deg."""

    #: form factors Y_F of pinion and gear
    form: tuple[float, float]
    #: stress correction factors Y_S of pinion and gear
    correction: tuple[float, float]
    #: helix angle factor Y_beta
    helix: float
    #: zone factor Z_H
    zone: float
    #: contact ratio factor Z_eps
    contact_ratio: float
    #: helix angle factor Z_beta
    flank_helix: float
    #: normal module m_n, mm
    module: float
    #: reference diameter d_1 of the pinion, mm
    diameter: float
    #: common face width b, mm, of all halves
    width: float
    #: gear ratio u, below 0 with an internal gear
    ratio: float

    def tangential_force(self, torque: float) -> float:
        """Return F_t, N, at the pinion's reference circle for a torque, N mm."""
        return 2.0 * torque / self.diameter

    def root_stress(self, torque: float) -> tuple[float, float]:
        """Return sigma_F0, MPa, of pinion and gear under a torque on the pinion, N mm."""
        even = self.tangential_force(torque) / (self.width * self.module) * self.helix
        first, second = (even * y_f * y_s for y_f, y_s in zip(self.form, self.correction, strict=True))
        return first, second

    def contact_stress(self, torque: float, modulus: float) -> float:
        """Return sigma_H0, MPa, under a torque on the pinion, N mm; `modulus`: E*, MPa, of which Z_E is made."""
        elasticity = math.sqrt(modulus / math.pi)
        load = self.tangential_force(torque) / (self.diameter * self.width) * (self.ratio + 1.0) / self.ratio
        return self.zone * elasticity * self.contact_ratio * self.flank_helix * math.sqrt(load)


def nominal_factors(
    line: LineOfAction, sections: tuple[CriticalSection, CriticalSection], width: float, halves: int = 1
) -> NominalFactors:
    """Return the factors of a mesh of symmetric teeth.

    - `sections`: critical sections of pinion and gear.
    - `width`: common face width, mm, of each of the `halves`.
    """
    mesh, pinion = line.mesh, line.mesh.pinion
    beta, beta_b, alpha_t, working = abs(pinion.beta), abs(pinion.beta_b), pinion.alpha_t, mesh.working_angle
    overlap = width * math.sin(beta) / (math.pi * pinion.module)
    forms, corrections = zip(*(_root_factors(line, k, section) for k, section in enumerate(sections)), strict=True)
    inclined = min(math.degrees(beta), MAX_HELIX_ANGLE_DEG) / HELIX_ANGLE_RANGE_DEG
    zone = math.sqrt(2.0 * math.cos(beta_b) * math.cos(working) / (math.cos(alpha_t) ** 2 * math.sin(working)))
    eps_alpha, counted = line.contact_ratio, min(overlap, 1.0)
    return NominalFactors(
        form=forms,
        correction=corrections,
        helix=1.0 - counted * inclined,
        zone=zone,
        contact_ratio=math.sqrt((4.0 - eps_alpha) / 3.0 * (1.0 - counted) + counted / eps_alpha),
        flank_helix=1.0 / math.sqrt(math.cos(beta)),
        module=pinion.module,
        diameter=2.0 * pinion.radius,
        width=halves * width,
        ratio=mesh.gear.teeth / pinion.teeth * mesh.gear.sense,
    )


def _root_factors(line: LineOfAction, number: int, section: CriticalSection) -> tuple[float, float]:
    """Return Y_F and Y_S of a member, by number."""
    teeth = line.members[number]
    arm, chord = lever(line, number, section), section.chord
    form = 6.0 * arm * teeth.module * math.cos(load_angle(line, number)) / (chord**2 * math.cos(teeth.alpha))
    slenderness, notch = chord / arm, chord / (2.0 * section.fillet_radius)
    correction = (1.2 + 0.13 * slenderness) * notch ** (1.0 / (1.21 + 2.3 / slenderness))
    return form, correction
