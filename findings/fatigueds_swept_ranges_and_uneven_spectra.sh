#!/usr/bin/env bash
# FatigueDS 0.3.1: sweeps in several ranges do their damage several times, PSDs of uneven steps are summed with the first step, sines in g are not scaled.
# Expected: a sweep of one amplitude and rate does one damage, however many ranges it is given in: the integral of cycles times amplitude to
#   the power k. A constant PSD is the same PSD in steps of 1 Hz and of 5 Hz. "unit: unit of the signal (supported: 'g' and 'ms2') Parameter
#   only needed for fds": a sine of 1 g is one of 9.81 m/s2.
# Seen: 10 to 400 Hz with 50 m/s2, whose damage is right as one range, is 1.30 to 4.33 times as bad as 10-100-400 Hz, and 3.0 to 9.75 times in four
#   ranges: each range lasts as long as the whole sweep. Logarithmic sweeps are 1.6 to 5.3 times as bad. A PSD of 1 (m/s2)^2/Hz with steps of 1 Hz up to
#   100 Hz and of 5 Hz beyond has 0.05 of the damage at 200 Hz (k = 4), and 0.48 of the response; by its four corners, 0.19 of the response at 60 Hz.
#   The damage of a sine in g is 9.81^k times too small; random loads in g are right. No warning.
# Versions: FatigueDS 0.3.1, FLife 2.3, numpy 2.4.6, scipy 1.17.1, rainflow 3.2.0, tqdm 4.70.1, matplotlib 3.11.2.
# Meets: whoever makes test specifications of gearboxes and housings: sweeps of standards have ranges, spectra are given by their corners.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q fatigueds==0.3.1 flife==2.3 tqdm==4.70.1 numpy==2.4.6 scipy==1.17.1 rainflow==3.2.0 matplotlib==3.11.2
TQDM_DISABLE=1 MPLBACKEND=Agg "$folder/venv/bin/python" - <<'END'
import numpy as np
from FatigueDS import Spectrum

QUALITY, SLOPE, AMPLITUDE = 10.0, 4, 50.0
NATURAL = np.arange(20.0, 201.0, 20.0)
RANGES = ([10.0, 400.0], [10.0, 100.0, 400.0], [10.0, 50.0, 100.0, 200.0, 400.0])
RATES = {"lin": 60.0, "log": 1.0}


def spectrum(kind, settings):
    result = Spectrum(freq_data=NATURAL.copy(), Q=QUALITY)
    getattr(result, f"set_{kind}_load")(**settings)
    result.get_ers()
    result.get_fds(k=SLOPE, C=1, p=1)
    return result


def swept(kind, natural):
    """Damage of the sweep from 10 to 400 Hz: the integral of cycles, frequency times time, times amplitude of the response to the power of k."""
    frequency = np.linspace(10.0, 400.0, 400001)
    seconds = 60.0 / RATES[kind] if kind == "lin" else 60.0 / (RATES[kind] * np.log(2.0) * frequency)
    ratio = frequency / natural
    response = AMPLITUDE / (2.0 * np.pi * natural) ** 2 / np.hypot(1.0 - ratio**2, ratio / QUALITY)
    return np.trapezoid(frequency * seconds * response**SLOPE, frequency)


def span(values):
    return f"{min(values):.3f} to {max(values):.3f}"


for kind, rate in RATES.items():
    runs = [
        spectrum("sine_sweep", dict(const_amp=[AMPLITUDE] * (len(r) - 1), const_f_range=r, dt=0.01, sweep_type=kind, sweep_rate=rate)) for r in RANGES
    ]
    one, two, four = (run.fds for run in runs)
    print(f"{kind}: as one range {span(one / [swept(kind, f) for f in NATURAL])} of the integral, two {span(two / one)}, four {span(four / one)} of one")
    assert all(np.allclose(run.ers, QUALITY * AMPLITUDE) for run in runs)
    assert np.allclose(one, [swept(kind, natural) for natural in NATURAL], rtol=2e-3)
    assert min(two / one) > 1.29 and max(two / one) > 2.6 and min(four / one) > 2.2, "ranges of a sweep last as long as they take now"

even = np.arange(10.0, 501.0)
grids = {"even": even, "5 Hz from 100 Hz": np.r_[np.arange(10.0, 100.0), np.arange(100.0, 501.0, 5.0)], "corners": np.array([10.0, 20.0, 80.0, 500.0])}
runs = {name: spectrum("random", dict(signal_data=(np.ones_like(grid), grid), T=100.0)) for name, grid in grids.items()}
for name, run in runs.items():
    print(f"flat PSD, {name}: response {np.round(run.ers[[0, 2, 9]], 3)}, damage {np.round(run.fds[[0, 2, 9]] / runs['even'].fds[[0, 2, 9]], 4)} of even")
deviation = np.sqrt(np.pi / 2.0 * 60.0 * QUALITY)
assert abs(runs["even"].ers[2] / (deviation * np.sqrt(2.0 * np.log(60.0 * 100.0))) - 1.0) < 0.03
assert runs["5 Hz from 100 Hz"].fds[9] < 0.06 * runs["even"].fds[9] and runs["corners"].ers[2] < 0.2 * runs["even"].ers[2], "uneven spectra are summed with their own steps now"

one_g = spectrum("sine", dict(sine_freq=50.0, amp=1.0, t_total=100.0, unit="g")).fds
metres = spectrum("sine", dict(sine_freq=50.0, amp=9.81, t_total=100.0)).fds
noise = np.random.default_rng(1).normal(size=4000)
random_g, random_metres = (spectrum("random", dict(signal_data=(load, 1e-3), unit=unit)).fds for load, unit in ((noise, "g"), (9.81 * noise, "ms2")))
print(f"damage of 9.81 m/s2 over that of 1 g: sine {span(metres / one_g)}, random {span(random_metres / random_g)}")
assert np.allclose(random_g, random_metres)
assert np.allclose(metres / one_g, 9.81**SLOPE), "a sine in g is scaled now"
END
