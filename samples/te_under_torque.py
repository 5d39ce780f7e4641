"""Which torque are crowned teeth made for? Transmission error of a spiral bevel and of a helical pair from little torque to much.

Crowning makes a transmission error that is a parabola for each tooth pair. Under torque the deflection is largest in its middle,
where fewest tooth pairs are loaded: the parabola flattens, and with more torque it is inverted. In between the transmission is
most uniform: that is the torque that the crowning is made for.

    python samples/te_under_torque.py [picture.png]
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import gearmesh as gm
from gearmesh.view.diagrams.plots import save_figure
from gearmesh.view.palette import CURVE_COLOURS, INK_COLOUR

SAMPLES = Path(__file__).parent
#: positions in a pitch
POSITIONS = 15


@dataclass(frozen=True)
class Crowned:
    """A pair by its sample and the `keys` set in it, and torques, Nm, the last of them far too much."""

    name: str
    sample: str
    keys: tuple[str, ...]
    torques: tuple[float, ...]


#: um of crowning over profile and face of both helical gears
CROWNING = tuple(
    f"{member}.modifications.{key}=20um"
    for member in ("pinion", "gear")
    for key in ("profile_crowning", "helix_crowning")
)
PAIRS = (
    Crowned("spiral bevel 13/44", "spiral_bevel_basic", (), (1, 10, 20, 30, 40, 50, 60, 80, 100, 150)),
    Crowned("helical 24/48, crowned", "helical", CROWNING, (10, 100, 200, 300, 400, 500, 600, 800, 1100, 1500)),
)


def under_torque(pair: Crowned) -> tuple[list[dict[str, Any]], np.ndarray, np.ndarray]:
    """A row a torque, and transmission errors (T, P), arc seconds, less their means, at phases (P,) of a pitch about the place
    where the unloaded gear is most ahead; `middle_arcsec` of the rows is that there: below 0 where the parabola is inverted."""
    gears = gm.build(gm.load(SAMPLES / f"{pair.sample}.toml", list(pair.keys)))
    pitch = np.degrees(gears.pairs[0].pitch)
    found = gears.loaded_contact(pair.torques, pitch * np.arange(POSITIONS) / POSITIONS)
    shape = (len(pair.torques), POSITIONS)
    te, unloaded = (np.array(found.to_dict()[key]).reshape(shape) for key in ("te_arcsec", "unloaded_te_arcsec"))
    shift = POSITIONS // 2 - int(unloaded[0].argmax())
    te = np.roll(te - te.mean(axis=1, keepdims=True), shift, axis=1)
    rows = [
        {
            "pair": pair.name,
            "torque": total.torque,
            "peak_to_peak_arcsec": total.te_peak_to_peak,
            "middle_arcsec": float(te[k, POSITIONS // 2]),
            "pressure_mpa": total.max_pressure,
        }
        for k, total in enumerate(found.totals)
    ]
    return rows, te, (np.arange(POSITIONS) - POSITIONS // 2) / POSITIONS


def main() -> None:
    from matplotlib.figure import Figure

    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("te_under_torque.png")
    figure = Figure(figsize=(11, 8.25), layout="constrained")
    axes = figure.subplots(2, len(PAIRS))
    for k, pair in enumerate(PAIRS):
        rows, te, phase = under_torque(pair)
        print(f"{pair.name}\ntorque, Nm   TE peak to peak, arcsec   in the middle of the mesh, arcsec   pressure, MPa")
        for row in rows:
            print("{torque:10g} {peak_to_peak_arcsec:25.2f} {middle_arcsec:34.2f} {pressure_mpa:15.0f}".format(**row))
        torque, error = (np.array([row[key] for row in rows]) for key in ("torque", "peak_to_peak_arcsec"))
        best = int(error.argmin())
        print(f"least at {torque[best]:g} Nm: {error[best]:.2f} arcsec, of {error[0]:.2f} at {torque[0]:g} Nm\n")
        for colour, each in zip(CURVE_COLOURS, (0, best, len(torque) - 1), strict=False):
            label = f"{torque[each]:g} Nm: {error[each]:.1f} arcsec"
            axes[0, k].plot(phase, te[each], color=colour, marker="o", ms=4, label=label)
            axes[1, k].plot(torque[each], error[each], color=colour, marker="o", ms=9)
        axes[0, k].set(title=pair.name, xlabel="phase of a pitch", ylabel="transmission error (arcsec)")
        axes[0, k].legend()
        axes[1, k].plot(torque, error, color=INK_COLOUR, marker=".", zorder=0)
        axes[1, k].set(xlabel="torque on the pinion (Nm)", ylabel="peak to peak (arcsec)", ylim=(0.0, None))
        for each in axes[:, k]:
            each.grid(alpha=0.3)
    save_figure(figure, picture)
    print(picture)


if __name__ == "__main__":
    main()
