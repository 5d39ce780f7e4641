#!/usr/bin/env bash
# sdypy-EMA 0.31.0: normal modes of more than 50 points depend on the common phase of the complex mode, and can have nothing in common with it.
# Expected: the help of `complex_to_normal_mode` says "The real mode shape should have the maximum correlation with the original complex mode
#   shape": the same shape times a number of unit size has the same normal mode. Above `max_dof` (50) points it is found from every so many
#   points, and is to be close to that of all points, "More closely related" with `long=True`, the default.
# Seen: a bending mode, its phases scattered by 10 deg as measured ones are, and turned by 0 to 345 deg as a whole. With 50 points the MAC with the
#   shape is 0.99 to 1 for every turn. With 51 points it falls below 0.6 and with 200 below 0.05; there the shape is noise. Angles are taken
#   from the arc cosine, which has no sign, of vectors whose sense is chance, and averaged. With `max_dof=1000` the same modes are right.
#   Modes turned to 0, 90 or 180 deg are nearly right, so that tests with modes of undamped models do not show it. No warning.
# Versions: sdypy-EMA 0.31.0, numpy 2.4.6, scipy 1.17.1.
# Meets: whoever compares modes of housings and gear bodies from scanning vibrometers or cameras with a finite-element model.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q sdypy-ema==0.31.0 numpy==2.4.6 scipy==1.17.1
MPLBACKEND=Agg "$folder/venv/bin/python" - <<'END'
import numpy as np
from sdypy.EMA.normal_modes import complex_to_normal_mode
from sdypy.EMA.tools import MAC

TURNS, SAMPLES, SCATTER = np.arange(0, 360, 15), 5, 10.0
rng = np.random.default_rng(1)


def correlations(points, **settings):
    """MAC of normal modes with the shape that they come from, (samples, turns): a bending mode with scattered phases, turned as a whole."""
    shape = np.sin(2.3 * np.pi * np.linspace(0.0, 1.0, points) + 0.3)
    result = np.empty((SAMPLES, len(TURNS)))
    for sample in range(SAMPLES):
        mode = shape * np.exp(1j * np.radians(SCATTER * rng.normal(size=points)))
        for place, turn in enumerate(TURNS):
            normal = np.ravel(complex_to_normal_mode(mode * np.exp(1j * np.radians(turn)), **settings))
            result[sample, place] = np.real(MAC(normal, shape))
    return result


for points, settings, least in ((50, {}, 0.98), (51, {}, None), (51, {"max_dof": 1000}, 0.98), (200, {}, None), (200, {"max_dof": 1000}, 0.98)):
    found = correlations(points, **settings)
    wrong = np.count_nonzero(found < 0.9)
    print(f"{points} points {settings}: MAC least {found.min():.2f}, greatest {found.max():.2f}; below 0.9 in {wrong} of {found.size}")
    if least is None:
        assert found.min() < 0.6 and wrong > 10, "normal modes of many points keep their shape now"
    else:
        assert found.min() > least
END
