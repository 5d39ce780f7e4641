"""Where do the settings of a bevel gear machine count from? The frames of the universal generator, drawn to scale from a sample.

The concave side of the pinion of spiral_bevel_formate.toml, mirrored into a right-hand machine, at cradle rotation 0: above the
machine plane, seen along the cradle axis from the blank; below the plane of cradle axis and root line. Signs and zeros of all
settings: gearmesh/systems/spiral_bevel/README.md.

    python samples/bevel_machine_frames.py [picture.png]
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.spiral_bevel.machine.machine import MachineSettings

DESIGN = Path(__file__).parent / "spiral_bevel_formate.toml"
BLUE, RED, GREY = "#1f5fa8", "#c8102e", "#5f7d8c"
#: swivel and offset are drawn as they would be in a machine that has them all
SHOWN = {"swivel": 25.0, "machining_offset": 14.0, "machine_centre_to_back": 12.0}


def main() -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("bevel_machine_frames.png")
    values = gm.build(gm.load(DESIGN)).sheet().values
    keys = ("radial", "cradle_angle", "ratio_of_roll", "tip_radius", "sliding_base")
    given = {key: values[f"pinion.concave.{key}"] for key in keys}
    machine = MachineSettings(
        radial=given["radial"],
        cradle_angle=float(np.radians(given["cradle_angle"])),
        ratio_of_roll=given["ratio_of_roll"],
        machine_root_angle=float(np.radians(14.0)),
        machining_offset=SHOWN["machining_offset"],
        machine_centre_to_back=SHOWN["machine_centre_to_back"],
        sliding_base=given["sliding_base"],
        tilt=float(np.radians(15.0)),
        swivel=float(np.radians(SHOWN["swivel"])),
    )
    centre, axes = machine.cutter_centre(1), machine.cutter_axes(1)
    around = np.linspace(0.0, 2.0 * np.pi, 200)
    tip = centre + given["tip_radius"] * (np.cos(around)[:, None] * axes[:, 0] + np.sin(around)[:, None] * axes[:, 1])
    blank = machine.own_from_machine(1).inverse
    apex, heel = blank.point(np.zeros(3)), blank.point(np.array([0.0, 0.0, 110.0]))

    figure, (above, below) = plt.subplots(2, 1, figsize=(9.6, 10.8), layout="constrained", height_ratios=(1.35, 1.0))
    for view, plane in ((above, (0, 1)), (below, (0, 2))):
        view.plot(*tip[:, plane].T, color=GREY, lw=1.5)
        line(view, (apex, heel), plane, "k", "-.")
        mark(view, np.zeros(3), plane, "machine centre", (-8, -22))
        mark(view, centre, plane, "cutter's centre", (8, -4) if view is above else (46, -22))
        arrow(view, centre, centre + 60.0 * axes[:, 2], plane, RED)
        arrow(view, np.zeros(3), np.array([75.0, 0.0, 0.0]), plane, "k")
        view.set_aspect("equal")
        view.set_xlim(-98.0, 158.0)
        view.axis("off")
    label(above, np.array([77.0, -3.0]), "x: machine root line, to the heel", "k")
    arrow(above, np.zeros(3), np.array([0.0, 95.0, 0.0]), (0, 1), "k")
    label(above, np.array([-3.0, 98.0]), "y", "k")
    mark(above, apex, (0, 1), "apex of the blank", (-118, 10))
    line(above, (np.zeros(3), centre), (0, 1), BLUE, "-")
    label(above, np.array([20.0, 33.0]), "radial S")
    arc(above, 48.0, 0.0, machine.cradle_angle, np.zeros(3))
    label(above, np.array([46.0, 24.0]), "cradle angle q > 0")
    lean = machine.cradle_angle + 0.5 * np.pi
    line(above, (centre, centre + 48.0 * np.array([np.cos(lean), np.sin(lean), 0.0])), (0, 1), BLUE, ":")
    arc(above, 42.0, lean, lean + machine.swivel, centre)
    label(above, centre[:2] + np.array([-66.0, 24.0]), "swivel j > 0")
    label(above, centre[:2] + np.array([-42.0, -11.0]), "the cutter's axis leans", RED)
    line(above, (np.array([apex[0], 0.0, 0.0]), apex), (0, 1), BLUE, "-")
    label(above, np.array([apex[0] - 78.0, 0.35 * apex[1]]), "machining offset E > 0")
    line(above, (np.array([apex[0], -4.0, 0.0]), np.array([0.0, -4.0, 0.0])), (0, 1), BLUE, "-")
    label(above, np.array([apex[0] - 88.0, -12.0]), "machine centre to back > 0")
    label(above, centre[:2] + np.array([-52.0, 62.0]), "the machine plane, seen from the blank", "k")
    arrow(below, np.zeros(3), np.array([0.0, 0.0, 60.0]), (0, 2), "k")
    label(below, np.array([-30.0, 63.0]), "z: cradle axis, into the blank", "k")
    mark(below, apex, (0, 2), "apex", (-44, 4))
    label(below, np.array([77.0, -2.5]), "x", "k")
    upright = centre + np.array([0.0, 0.0, 58.0])
    line(below, (centre, upright), (0, 2), BLUE, ":")
    arc(below, 50.0, 0.5 * np.pi, float(np.arctan2(axes[2, 2], axes[0, 2])), centre[[0, 2, 1]])
    label(below, np.array([centre[0] - 15.0, 50.0]), "tilt i > 0", RED)
    line(below, (np.array([apex[0], 0.0, 0.0]), apex), (0, 2), BLUE, "-")
    label(below, np.array([apex[0] - 56.0, -4.0]), "sliding base > 0")
    line(below, (apex, apex + np.array([105.0, 0.0, 0.0])), (0, 2), BLUE, ":")
    arc(below, 90.0, 0.0, machine.machine_root_angle, apex[[0, 2, 1]])
    label(below, np.array([apex[0] + 92.0, apex[2] + 7.0]), "machine root angle")
    label(below, heel[[0, 2]] + np.array([2.0, 0.0]), "axis of the blank", "k")
    figure.savefig(picture, dpi=120)
    print(picture)


def line(view: Any, ends: tuple[Array, Array], plane: tuple[int, int], colour: str, style: str) -> None:
    """A straight line between two points (3,), in the plane of two of their coordinates."""
    view.plot(*np.stack(ends)[:, plane].T, color=colour, ls=style, lw=1.6)


def mark(view: Any, at: Array, plane: tuple[int, int], name: str, apart: tuple[int, int]) -> None:
    """A point with its name."""
    view.plot(*at[list(plane)], "o", color="k", ms=5)
    view.annotate(name, at[list(plane)], xytext=apart, textcoords="offset points", fontsize=15)


def arrow(view: Any, begin: Array, end: Array, plane: tuple[int, int], colour: str) -> None:
    """An arrow between two points."""
    style = {"arrowstyle": "-|>", "color": colour, "lw": 1.8}
    view.annotate("", xy=end[list(plane)], xytext=begin[list(plane)], arrowprops=style)
    view.plot(*end[list(plane)], alpha=0.0)


def label(view: Any, at: Array, text: str, colour: str = BLUE) -> None:
    view.text(*at[:2], text, color=colour, fontsize=15)


def arc(view: Any, radius: float, first: float, last: float, centre: Array) -> None:
    """An angle (rad) from one direction to another about a centre."""
    angles = np.linspace(first, last, 40)
    view.plot(centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles), color=BLUE, lw=1.6)


if __name__ == "__main__":
    main()
