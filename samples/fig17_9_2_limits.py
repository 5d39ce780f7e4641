"""How deep may a rack cut, how high may a tip be? [LF04] Fig. 17.9.2 (b): h1 and h2 over the pinion's tooth number.

h1: depth below the pitch plane of the rack point A_c that generates the first singular point of the pinion, the warning
of undercut; h2: height of the rack point B_c that generates the pinion's tip where the top land is 0.3 m wide. Parabolic rack,
alpha_d = 25 deg, beta = 20 deg, a_c = 0.016739 1/mm, tooth = space on the pitch line, module 1 mm; and the straight rack,
which gives involute teeth, against its closed forms.

    python samples/fig17_9_2_limits.py [picture.png]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.envelope.limiting_line import limiting_line
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.kernel.surface.levels import ConeLevel, PlaneLevel
from gearmesh.teeth.limits import land_of_width
from gearmesh.tools.rack import Parabola, RackLine, RackSurface
from gearmesh.view.diagrams.plots import plot_curves

MODULE, ALPHA, BETA, PARABOLA, LAND = 1.0, np.radians(25.0), np.radians(20.0), 0.016739, 0.3
LINE = RackLine(ALPHA, MODULE, 0.25 * np.pi * MODULE)
#: of the prolonged rack, in modules over the pitch plane
HIGH, LOW = 1.0, -8.0
TEETH = range(10, 41)


def pitch_radius(teeth: int) -> float:
    return float(0.5 * teeth * MODULE / np.cos(BETA))


def flank(teeth: int, coefficient: float, side: int) -> Envelope:
    """Right (1) or left (-1) flank of the pinion."""
    profile = Parabola(LINE, coefficient, LINE.at_height(0.0))
    return Envelope(RackSurface(profile, BETA, 0.0, side), RackRoll(pitch_radius(teeth)))


def height(coefficient: float, p: float) -> float:
    """Height (mm) of a rack point over the pitch plane."""
    return float(Parabola(LINE, coefficient, LINE.at_height(0.0)).section(np.array(p))[0][0])


def h1(teeth: int, coefficient: float = PARABOLA) -> float:
    """Depth (mm) of the rack point that generates the first singular point."""
    span = LINE.at_height(HIGH * MODULE), LINE.at_height(LOW * MODULE)
    line = limiting_line(flank(teeth, coefficient, 1), span, np.zeros(1))
    return -height(coefficient, line.p[0])


def h2(teeth: int, coefficient: float = PARABOLA, land: float = LAND * MODULE) -> float:
    """Height (mm) of the rack point that generates the tip where the top land is `land` (mm) wide."""
    start = LINE.at_height(HIGH * MODULE)
    sides = (flank(teeth, coefficient, 1), start), (flank(teeth, coefficient, -1), start)
    tip = ConeLevel.of(pitch_radius(teeth) + HIGH * MODULE)
    p, _, _ = land_of_width(sides, PlaneLevel(0.0), tip, np.zeros(1), land)
    return height(coefficient, p[0])


def involute(teeth: int) -> tuple[float, float]:
    """h1 and h2 (mm) of the straight rack in closed form: r_p sin^2(alpha_t), and the angle where the land is s_a wide."""
    r, alpha = pitch_radius(teeth), np.arctan(np.tan(ALPHA) / np.cos(BETA))

    def radius(angle: float) -> float:
        return float(r * np.cos(alpha) / np.cos(angle))

    def excess(angle: float) -> float:
        half = 0.5 * np.pi / teeth + (np.tan(alpha) - alpha) - (np.tan(angle) - angle)
        return float(2.0 * radius(angle) * half - LAND * MODULE)

    tip = brentq(excess, alpha, 1.4, xtol=1e-15)
    # the point stands beside the pitch point by rho sin(alpha) - r sin(alpha_t) along the line of action
    return float(r * np.sin(alpha) ** 2), float((radius(tip) * np.sin(tip) - r * np.sin(alpha)) * np.sin(alpha))


def main() -> None:
    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("fig17_9_2.png")
    curves = np.array([[h1(n), h2(n), h1(n, 0.0), h2(n, 0.0)] for n in TEETH])
    closed = np.array([involute(n) for n in TEETH])
    print("  N1   h1, mm   h2, mm   straight: h1   h2")
    for n, row in zip(TEETH, curves, strict=True):
        if n % 5 == 0 or n == 17:
            print("{:4d} {:8.4f} {:8.4f} {:14.4f} {:.4f}".format(n, *row))
    print(f"straight against its closed forms: within {np.abs(curves[:, 2:] - closed).max():.1e} mm")
    free = next(n for n, row in zip(TEETH, curves, strict=True) if row[0] >= 1.25 * MODULE)
    print(f"a rack 1.25 m deep cuts no singular point from N1 = {free} on")
    teeth = np.array(TEETH, dtype=float)
    plot_curves(
        picture,
        {
            "h1, parabolic rack": (teeth, curves[:, 0]),
            "h2, parabolic rack": (teeth, curves[:, 1]),
            "h1, straight rack": (teeth, curves[:, 2]),
            "h2, straight rack": (teeth, curves[:, 3]),
        },
        ("tooth number N1", "mm, module 1 mm"),
        "LF04 Fig. 17.9.2: limits of the rack against undercut (h1) and narrow tips (h2)",
    )


if __name__ == "__main__":
    main()
