"""Kinematic errors of eccentric spiral bevel gears over a whole period: exact contact and the four harmonics of [CR3553] 3.4.

Usage: python samples/eccentricity_harmonics.py [PICTURE.png]

Both members of the pair of [AB] are 0.02 mm eccentric. The exact error comes tooth by tooth from contact analysis, the
closed form (3.4.11) takes all contact at the mean point: two harmonics with the period of the pinion, two with the gear's.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from gearmesh import job
from gearmesh.contact import solver_pair
from gearmesh.design import load
from gearmesh.kinematic_errors import NominalContact, harmonics
from gearmesh.path import ARCSEC
from gearmesh.tca import contact_path

DESIGN = Path(__file__).parent / "spiral_bevel_basic.toml"
ECCENTRICITY = 0.02
#: positions of one tooth pair, and the pinion teeth that a period of both members takes
POSITIONS = 9


def main(picture: Path) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    errors = [f"assembly.{name}_eccentricity={ECCENTRICITY}" for name in ("pinion", "gear")]
    gears, eccentric = job.pair(load(DESIGN)), job.pair(load(DESIGN, errors))
    stand = gears.assembly
    teeth, pitch = stand.teeth_gear, stand.pitch
    local = np.linspace(-0.45, 0.45, POSITIONS) * pitch
    nominal = contact_path(solver_pair(gears), np.append(local, 0.0), edges=False)
    at, te = [], []
    for tooth in range(teeth):
        # the pair `tooth` pitches later: both members stand turned on by whole teeth, their eccentricities with them
        turned = [
            replace(mount, eccentricity=tuple(rotated(mount.eccentricity, mount.sign * 2.0 * np.pi * tooth / n)))
            for mount, n in ((eccentric.assembly.pinion, stand.teeth_pinion), (eccentric.assembly.gear, teeth))
        ]
        moved = replace(eccentric, assembly=replace(eccentric.assembly, pinion=turned[0], gear=turned[1]))
        path = contact_path(solver_pair(moved), local, edges=False)
        at.append(local + tooth * pitch)
        te.append(np.where(path.kind == "point", path.phi2 - nominal.phi2[:-1], np.nan))
    phi1, exact = np.concatenate(at), np.concatenate(te)
    mean = NominalContact(nominal.point[-1], nominal.normal[-1], stand.pinion.axis, stand.gear.axis, stand.pinion.sign)
    form = harmonics(mean, ECCENTRICITY, ECCENTRICITY)
    closed = form.at(phi1 - stand.pinion.zero, phi1 * stand.ratio - stand.gear.zero)
    known = np.isfinite(exact)
    print(f"{known.sum()} positions over {teeth} pinion pitches (one turn of the gear)")
    print(f"exact      {np.ptp(exact[known]) / ARCSEC:8.2f} arcsec peak to peak")
    print(f"closed     {np.ptp(closed) / ARCSEC:8.2f} arcsec peak to peak")
    print(f"difference {np.abs(exact - closed)[known].max() / ARCSEC:8.2f} arcsec at most")
    for name, value in (("a1", form.a1), ("b1", form.b1), ("a2", form.a2), ("b2", form.b2)):
        print(f"{name} = {value / ARCSEC:8.3f} arcsec")
    figure, axes = plt.subplots(figsize=(11, 6), layout="constrained")
    turns = phi1 / (2.0 * np.pi)
    axes.plot(turns, closed / ARCSEC, color="#1f5fa8", lw=2.0, label="four harmonics (3.4.11)")
    axes.plot(turns, exact / ARCSEC, ".", color="#c8102e", ms=4.0, label="exact contact, tooth by tooth")
    for name, part in (
        ("pinion", replace(form, a2=0.0, b2=0.0)),
        ("gear", replace(form, a1=0.0, b1=0.0)),
    ):
        values = part.at(phi1 - stand.pinion.zero, phi1 * stand.ratio - stand.gear.zero)
        axes.plot(turns, values / ARCSEC, lw=1.0, ls="--", label=f"two harmonics of the {name}")
    axes.set(xlabel="turns of the pinion", ylabel="error of the gear's rotation (arcsec)")
    axes.set_title(f"Spiral bevel pair, both members {ECCENTRICITY} mm eccentric")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right")
    figure.savefig(picture, dpi=120)
    print(picture)


def rotated(vector: tuple[float, float], angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]]) @ vector


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "eccentricity_harmonics.png"))
