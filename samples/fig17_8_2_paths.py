"""Where does the contact of misaligned Novikov-Wildhaber gears go? [LF04] Fig. 17.8.2: paths of contact on the pinion.

Centre distance + 70 um, shaft angle + 3', lead angle of the pinion + 3', and the shaft angle made good by the lead angle
(d_gamma + d_lambda1 = 0), each over one pitch beside the path of the aligned pair of Table 17.8.1.

    python samples/fig17_8_2_paths.py [picture.png] [novikov|modified_involute]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import gearmesh as gm
from gearmesh.answers.contact.contact import Contact
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.view.diagrams.flank_diagrams import beside, plot_flanks
from gearmesh.view.pictures import flank_panel

SAMPLES = Path(__file__).parent
ARCMIN = 1.0 / 60.0
CASES = {
    "ΔE = 70 µm": {"dE": 0.07},
    "Δγ = 3'": {"d_gamma": 3 * ARCMIN},
    "Δλ₁ = 3'": {"d_lambda1": 3 * ARCMIN},
    "Δγ = 3', Δγ + Δλ₁ = 0": {"d_gamma": 3 * ARCMIN, "d_lambda1": -3 * ARCMIN},
}


def contact(kind: str, errors: dict[str, float]) -> Contact:
    """The pair's contact over one pitch."""
    gears = gm.build(gm.load(SAMPLES / f"{kind}.toml", [f"assembly.{key}={value}" for key, value in errors.items()]))
    return gears.contact(np.degrees(np.linspace(-0.5, 0.5, 21) * gears.pairs[0].pitch), cycle=False)


def main() -> None:
    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("fig17_8_2.png")
    kind = sys.argv[2] if len(sys.argv) > 2 else "novikov"
    aligned = contact(kind, {}).path
    views = []
    print("middle of the path   shift along the tooth   across it       TE at -half, +half a pitch")
    for title, errors in CASES.items():
        found = contact(kind, errors)
        path = found.path
        views.append(flank_panel(found.pair, "pinion", path, f"pinion, {title}", nominal=aligned.point1))
        middle, before = path.point1[10], aligned.point1[10]
        along, across = middle[2] - before[2], np.hypot(*middle[:2]) - np.hypot(*before[:2])
        first, last = path.te[[0, -1]] / ARCSEC
        print(f"{title:22s} {along:16.2f} mm {across:13.3f} mm {first:14.2f} {last:8.2f} arcsec")
    plot_flanks(picture, beside(views), "LF04 Fig. 17.8.2: path of contact under errors of alignment")


if __name__ == "__main__":
    main()
