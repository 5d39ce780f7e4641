"""The root of a hobbed external gear by ISO 6336-3:2006, 6.2 and 6.3 (method B); angles in rad, lengths in modules."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.optimize import brentq


@dataclass(frozen=True)
class Hobbed:
    """Teeth and hob: rounding rho_fP and dedendum h_fP in modules; `allowance` of the thickness, which the hob's tooth has more."""

    teeth: int
    alpha: float
    beta: float
    shift: float
    dedendum: float
    rounding: float
    allowance: float = 0.0

    @property
    def beta_b(self) -> float:
        return math.asin(math.sin(self.beta) * math.cos(self.alpha))

    @property
    def virtual(self) -> float:
        """z_n."""
        return self.teeth / (math.cos(self.beta_b) ** 2 * math.cos(self.beta))

    def root(self) -> tuple[float, float, float]:
        """s_Fn, rho_F and the distance of the chord from the axis of the virtual gear, in modules."""
        # E is counted to the middle of the hob's tooth, which is wider by half of what the gear's is thinner
        e = 0.25 * math.pi - self.dedendum * math.tan(self.alpha) - 0.5 * self.allowance
        e -= (1.0 - math.sin(self.alpha)) * self.rounding / math.cos(self.alpha)
        g = self.rounding - self.dedendum + self.shift
        h = 2.0 / self.virtual * (0.5 * math.pi - e) - math.pi / 3.0
        theta = brentq(lambda t: t - (2.0 * g / self.virtual * math.tan(t) - h), 0.0, 1.4, xtol=1e-15)
        arm = g / math.cos(theta) - self.rounding
        chord = self.virtual * math.sin(math.pi / 3.0 - theta) + math.sqrt(3.0) * arm
        fillet = self.rounding + 2.0 * g**2 / (math.cos(theta) * (self.virtual * math.cos(theta) ** 2 - 2.0 * g))
        return chord, fillet, 0.5 * (self.virtual * math.cos(math.pi / 3.0 - theta) + arm)

    def lever(self, tip: float, reference: float, ratio: float) -> float:
        """h_Fe in modules: of a force at the outer point of single contact; diameters of tip and reference circle, eps_alpha."""
        return self.load(tip, reference, ratio)[0]

    def load(self, tip: float, reference: float, ratio: float) -> tuple[float, float]:
        """h_Fe in modules and the load angle alpha_Fen of this force."""
        inv = math.tan(self.alpha) - self.alpha
        d_n = self.virtual
        d_bn = d_n * math.cos(self.alpha)
        d_an = d_n + tip - reference
        way = math.sqrt(0.25 * (d_an**2 - d_bn**2))
        way -= (
            math.pi
            * reference
            * math.cos(self.beta)
            * math.cos(self.alpha)
            / self.teeth
            * (ratio / math.cos(self.beta_b) ** 2 - 1.0)
        )
        d_en = 2.0 * math.hypot(way, 0.5 * d_bn)
        a_en = math.acos(d_bn / d_en)
        half = 0.5 * math.pi + 2.0 * self.shift * math.tan(self.alpha) + self.allowance
        gamma = half / self.virtual + inv - (math.tan(a_en) - a_en)
        a_fen = a_en - gamma
        return 0.5 * (math.cos(gamma) - math.sin(gamma) * math.tan(a_fen)) * d_en - self.root()[2], a_fen
