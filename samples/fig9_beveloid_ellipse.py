"""How round is the contact of beveloid gears? [LT02] Fig. 9: ratio of the axes of the contact ellipse over the cone angle.

Straight teeth on intersected axes: as the cone angle goes to 0 the pair becomes a spur pair in line contact, the ratio a/b
grows beyond all bounds. Helical teeth (15 deg, both right-handed) on crossed axes stay in point contact, and a/b has a limit.

    python samples/fig9_beveloid_ellipse.py [picture.png]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import gearmesh as gm
from gearmesh.view.diagrams.plots import plot_curves

SAMPLES = Path(__file__).parent
CONES = np.array([1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0])


def axis_ratio(cone: float, helix: float) -> float:
    """a/b at phi1 = 0 of the pair of [LT02] Table 1 with these cone and helix angles (deg) on both members."""
    settings = [
        f"{m}.{key}={value}"
        for m in ("pinion", "gear")
        for key, value in (("cone_angle", cone), ("helix_angle", helix))
    ]
    path = gm.build(gm.load(SAMPLES / "beveloid_crossed.toml", settings)).contact(0.0, cycle=False).path
    return float(path.semi_major[0] / path.semi_minor[0])


def main() -> None:
    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("fig9.png")
    straight = np.array([axis_ratio(cone, 0.0) for cone in CONES])
    helical = np.array([axis_ratio(cone, 15.0) for cone in CONES])
    print("cone angle, deg   a/b straight   a/b helical")
    for row in zip(CONES, straight, helical, strict=True):
        print("{:15.0f} {:14.3f} {:13.3f}".format(*row))
    growth = np.log(straight[0] / straight[1]) / np.log(CONES[1] / CONES[0])
    print(
        f"towards 0: straight grows as the cone angle to the power -{growth:.3f}, helical tends to {axis_ratio(0.0, 15.0):.3f}"
    )
    plot_curves(
        picture,
        {"straight, intersected axes": (CONES, straight), "helical 15 deg, crossed axes": (CONES, helical)},
        ("cone angle of both members (deg)", "a / b"),
        "LT02 Fig. 9: axes of the contact ellipse",
        log_y=True,
    )


if __name__ == "__main__":
    main()
