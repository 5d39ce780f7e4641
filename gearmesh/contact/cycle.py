"""The whole mesh cycle: neighbouring tooth pairs carry in turn, the first to touch decides.

All tooth pairs are alike: pair k does at phi1 what pair 0 does at phi1 - k pitches. With te(phi1) of one pair over its
whole engagement, edges included, the transmission error of the gears is the extreme of te(phi1 - k pitch) over k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.tca import Pair, contact_path
from gearmesh.kernel.algebra import Array
from gearmesh.kernel.roots import last_true

#: positions in a pitch, and halvings of the interval in which surface contact begins or ends
PER_PITCH = 24
REFINEMENTS, SPLIT = 2, 12
#: no pair is followed farther than this many pitches either way
MOST_PITCHES = 8
#: pitches either way over which a pair that only touches on edges is followed
EDGE_PITCHES = 2
HARMONICS = 5
#: rad (0.1 arcsec): from here on a step of the transmission error is a break
JUMP = 5e-7


@dataclass(frozen=True)
class Break:
    """The transmission error of the flanks' surfaces is discontinuous [LF04 17.8]: edges have to bridge it.

    At phi1 (rad) the surface contact of a pair ends although it is still ahead of the next pair by `jump` (rad), or begins
    although it is ahead already; `jump` is NaN where nothing else has surface contact. `beginning` tells which.
    """

    phi1: float
    jump: float
    beginning: bool


@dataclass(frozen=True)
class Cycle:
    """phi1 (Q,), rad, over one pitch; te (K, Q) of the tooth pairs that touch in it (NaN where they do not) and the
    envelope (Q,) of the gears, rad; contact_ratio: pitches over which one pair has surface contact (NaN if nowhere);
    harmonics: amplitudes of the envelope's first harmonics of the mesh frequency, rad;
    breaks: where one pair's surface contact does not pass on to the next one's smoothly."""

    phi1: Array
    te: Array
    envelope: Array
    contact_ratio: float
    harmonics: Array
    breaks: tuple[Break, ...] = ()

    @property
    def peak_to_peak(self) -> float:
        """TE peak to peak over one pitch, rad; NaN where the contact breaks off."""
        return float(np.ptp(self.envelope))


def mesh_cycle(pair: Pair, pitch: float) -> Cycle | None:
    """Follow one tooth pair through its whole engagement at pinion pitch `pitch` (rad), and let its neighbours join.

    Where a pair has surface contact nowhere (misaligned line contact), its edges are followed for EDGE_PITCHES either
    way and the contact ratio is NaN. None where nothing touches.
    """
    steps, inside = _engagement(pair, pitch)
    ratio = np.nan
    breaks: tuple[Break, ...] = ()
    if inside.size:
        ends = [
            _boundary(pair, inside[k] * pitch / PER_PITCH, direction * pitch / PER_PITCH)
            for k, direction in ((0, -1.0), (-1, 1.0))
        ]
        ratio, breaks = (ends[1] - ends[0]) / pitch, _breaks(pair, pitch, ends[0], ends[1])
    path = contact_path(pair, steps * pitch / PER_PITCH)
    if not path.touching.any():
        return None
    te = _by_pair(np.where(path.touching, path.te, np.nan), steps)
    with np.errstate(all="ignore"):
        envelope = pair.drive * np.max(np.where(np.isnan(te), -np.inf, pair.drive * te), axis=0)
    envelope = np.where(np.isfinite(envelope), envelope, np.nan)
    spectrum = np.abs(np.fft.rfft(envelope))[1 : HARMONICS + 1] * 2.0 / PER_PITCH
    carried = te[~np.isnan(te).all(axis=1)]
    return Cycle(np.arange(PER_PITCH) * pitch / PER_PITCH, carried, envelope, ratio, spectrum, breaks)


def _engagement(pair: Pair, pitch: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Steps of a pitch / PER_PITCH to follow a tooth pair over, and those of them with surface contact."""
    low, high = -PER_PITCH, PER_PITCH
    while True:
        steps = np.arange(low, high + 1)
        path = contact_path(pair, steps * pitch / PER_PITCH, edges=False)
        inside = steps[path.touching]
        if not inside.size:
            return np.arange(-EDGE_PITCHES * PER_PITCH, EDGE_PITCHES * PER_PITCH + 1), inside
        grow_low = inside[0] < low + PER_PITCH and low > -MOST_PITCHES * PER_PITCH
        grow_high = inside[-1] > high - PER_PITCH and high < MOST_PITCHES * PER_PITCH
        if not (grow_low or grow_high):
            return steps, inside
        low -= PER_PITCH * grow_low
        high += PER_PITCH * grow_high


def _breaks(pair: Pair, pitch: float, begin: float, end: float) -> tuple[Break, ...]:
    """Breaks of a pair with surface contact between `begin` and `end` (rad), where its neighbours' begins and ends too."""
    if end - begin < pitch:
        return (Break(end, np.nan, beginning=False),)
    inside = pitch / PER_PITCH / SPLIT**REFINEMENTS
    begin, end = begin + inside, end - inside
    te = contact_path(pair, np.array([begin, begin + pitch, end - pitch, end]), edges=False).te
    found = []
    for phi1, (own, other), beginning in ((begin, te[:2], True), (end, te[:1:-1], False)):
        ahead = pair.drive * (own - other)
        if ahead > JUMP:
            found.append(Break(phi1, float(ahead), beginning))
    return tuple(found)


def _by_pair(te: Array, steps: NDArray[np.int64]) -> Array:
    """Rows: tooth pairs, columns: positions within one pitch."""
    rows = np.floor_divide(steps, PER_PITCH)
    table = np.full((int(np.ptp(rows)) + 1, PER_PITCH), np.nan)
    table[rows - rows[0], steps - rows * PER_PITCH] = te
    return table


def _boundary(pair: Pair, inside: float, step: float) -> float:
    """phi1 at which surface contact ends, between `inside` and `inside` + `step` (rad), by repeated division."""
    last, first = last_true(
        lambda phi1, _: contact_path(pair, phi1, edges=False).touching,
        np.array([inside]),
        np.array([inside + step]),
        rounds=REFINEMENTS,
        split=SPLIT,
    )
    return float(0.5 * (last[0] + first[0]))
