"""How do eccentric spiral bevel gears run? Exact contact against the four harmonics of [CR3553] 3.4, over a full turn of the set.

Both members of a conjugate pair (Geometry I), which runs without error when centred, are 0.02 mm eccentric. The exact error comes
tooth by tooth from contact analysis; the closed form (3.4.11) takes all contact at the mean point: two harmonics with the
period of the pinion, two with the gear's. (3.4.7), at the contact points themselves, follows the breaks from tooth to tooth.

    python samples/eccentricity_harmonics.py [picture.png]
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import gearmesh as gm
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.systems.spiral_bevel.errors.kinematic_errors import Harmonics, NominalContact, harmonics

DESIGN = Path(__file__).parent / "spiral_bevel_geometry1.toml"
ECCENTRICITY = 0.02
#: directions from the members' tooth on x, deg
PHASES = (0.0, 60.0)
#: positions of one tooth pair
POSITIONS = 9


def main() -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("eccentricity_harmonics.png")
    gears = gm.build(gm.load(DESIGN)).pairs[0]
    pair, (pinion, gear) = solver_pair(gears), gears.mounts
    numbers = np.array([member.tooth.teeth for member in gears.both])
    # until the same teeth meet again
    pitches = int(np.lcm(*numbers))
    local = np.linspace(-0.45, 0.45, POSITIONS) * gears.pitch
    nominal = contact_path(pair, np.append(local, 0.0), edges=False)
    contact = NominalContact(nominal.point, nominal.normal, pinion.axis, gear.axis, pinion.sign)
    mean = replace(contact, point=contact.point[-1], normal=contact.normal[-1])
    phi1, exact, at_points = [], [], []
    for pitch in range(pitches):
        # the pair so many pitches later: both members stand turned on by whole teeth, their eccentricities with them
        angles = np.radians(PHASES) + [pinion.sign, gear.sign] * (2.0 * np.pi * pitch / numbers)
        vectors = ECCENTRICITY * np.stack((np.cos(angles), np.sin(angles)), axis=-1)
        mounts = [
            replace(m, eccentricity=(float(x), float(y))) for m, (x, y) in zip((pinion, gear), vectors, strict=True)
        ]
        moved = replace(pair, pinion=replace(pair.pinion, mount=mounts[0]), gear=replace(pair.gear, mount=mounts[1]))
        path = contact_path(moved, local, edges=False)
        turned = [
            m.at(phi).vector(np.array([*m.eccentricity, 0.0]))
            for m, phi in zip(mounts, (nominal.rotation, nominal.phi2), strict=True)
        ]
        phi1.append(local + pitch * gears.pitch)
        exact.append(np.where(path.kind == "point", path.phi2 - nominal.phi2[:-1], np.nan))
        at_points.append(contact.eccentricity(*turned)[:-1])
    form = harmonics(mean, ECCENTRICITY, ECCENTRICITY)
    turn, error = np.concatenate(phi1), np.concatenate(exact)
    t1 = turn - pinion.zero + pinion.sign * np.radians(PHASES[0])
    t2 = turn * gears.ratio - gear.zero + gear.sign * np.radians(PHASES[1])
    closed, known = form.at(t1, t2), np.isfinite(error)
    fit = fitted(error[known], t1[known], t2[known])

    print(f"{known.sum()} of {known.size} positions touch, over {pitches} pitches: the same teeth meet again")
    print(
        f"peak to peak: exact {np.ptp(error[known]) / ARCSEC:.2f}, four harmonics {np.ptp(closed) / ARCSEC:.2f} arcsec"
    )
    print(
        f"exact less (3.4.11), contact at the mean point:  {np.abs(error - closed)[known].max() / ARCSEC:.2f} arcsec at most"
    )
    print(
        f"exact less (3.4.7), contact where it really is:  "
        f"{np.abs(error - np.concatenate(at_points))[known].max() / ARCSEC:.2f} arcsec at most"
    )
    print("                  amplitude, arcsec   crest, deg   the same fitted to the exact error")
    for k, name in enumerate(("pinion", "gear")):
        print(
            f"harmonics of {name:6s} {form.amplitudes[k] / ARCSEC:12.3f} {np.degrees(form.phases[k]):12.2f}"
            f" {fit.amplitudes[k] / ARCSEC:22.3f} {np.degrees(fit.phases[k]):11.2f}"
        )

    figure, axes = plt.subplots(figsize=(11, 6), layout="constrained")
    turns = turn / (2.0 * np.pi)
    axes.plot(turns, closed / ARCSEC, color="#1f5fa8", lw=2.0, label="four harmonics (3.4.11)")
    axes.plot(turns, error / ARCSEC, ".", color="#c8102e", ms=4.0, label="exact contact, tooth by tooth")
    for name, part, colour in (
        ("pinion", replace(form, a2=0.0, b2=0.0), "#5f7d8c"),
        ("gear", replace(form, a1=0.0, b1=0.0), "#c58b1b"),
    ):
        label = f"two harmonics of the {name}"
        axes.plot(turns, part.at(t1, t2) / ARCSEC, color=colour, lw=1.0, ls="--", label=label)
    axes.set(xlabel="turns of the pinion", ylabel="error of the gear's rotation (arcsec)")
    axes.set_title(f"Spiral bevel pair {numbers[0]}/{numbers[1]}, both members {ECCENTRICITY} mm eccentric")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper right")
    figure.savefig(picture, dpi=120)
    print(picture)


def fitted(error: Array, t1: Array, t2: Array) -> Harmonics:
    """The four harmonics that are nearest to an error, by least squares beside a constant."""
    columns = np.stack((np.sin(t1), np.cos(t1), np.sin(t2), np.cos(t2), np.ones_like(t1)), axis=-1)
    return Harmonics(*(float(c) for c in np.linalg.lstsq(columns, error, rcond=None)[0][:4]))


if __name__ == "__main__":
    main()
