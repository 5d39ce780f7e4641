"""The whole mesh cycle: neighbouring tooth pairs are in contact in turn; the first to touch determines the transmission error.

All tooth pairs are alike: pair k does at phi1 what pair 0 does at phi1 - k pitches. (Eccentric members stay displaced as at
phi1 = 0, see `displaced_pair`.) With te(phi1) of one pair over its whole
engagement, edges included, the transmission error of the gears is the extreme of te(phi1 - k pitch) over k. It is a chain of
smooth arcs; where they change over, where surface contact begins and ends and where an arc has an extreme are roots.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gearmesh.contact.conditions.refinement import Contacts
from gearmesh.contact.engagement.curve import HARMONICS, MeshCurve
from gearmesh.contact.engagement.displaced import displaced_pair
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric.algebra import Array

#: positions in a pitch at which the cycle is given
PER_PITCH = 24
#: rad (0.1 arcsec): from here on a step of the transmission error is a break
JUMP = 5e-7


@dataclass(frozen=True)
class Break:
    """The transmission error of the flanks' surfaces is discontinuous [LF04 17.8]: edges have to bridge it.

    At phi1 (rad) the surface contact of a pair ends although it is still ahead of the next pair by `jump` (rad), or begins
    although it is ahead already; `jump` is NaN where nothing else has surface contact. `beginning`: which of both.
    """

    phi1: float
    jump: float
    beginning: bool


@dataclass(frozen=True)
class Cycle:
    """phi1 (Q,), rad, over one pitch; te (K, Q) of the tooth pairs that touch in it (NaN where they do not) and the
    envelope (Q,) of the gears, rad; contact_ratio: pitches over which one pair has surface contact (NaN if nowhere), of a line of
    contact also its transverse part and the overlap; harmonics: amplitudes of the envelope's first harmonics of the mesh
    frequency, rad; breaks: where one pair's surface contact does not pass on to the next one's smoothly; surface: phi1 (rad)
    between which pair 0 has surface contact; engagement: between which it may be ahead of its neighbours or has surface contact;
    handovers: phi1 (rad) of pair 0 at which it takes over from another; curve: the advance of the gears itself; pair: phi1 and te
    (2, K), rad, of pair 0 over its engagement; gears: likewise (2, M) of the gears over one pitch, all its bends in it."""

    phi1: Array
    te: Array
    envelope: Array
    contact_ratio: float
    harmonics: Array
    breaks: tuple[Break, ...] = ()
    peak_to_peak: float = np.nan
    transverse_ratio: float = np.nan
    overlap_ratio: float = np.nan
    surface: tuple[float, float] = (np.nan, np.nan)
    engagement: tuple[float, float] = (np.nan, np.nan)
    handovers: tuple[float, ...] = ()
    curve: MeshCurve | None = field(default=None, repr=False)
    pair: Array | None = field(default=None, repr=False)
    gears: Array | None = field(default=None, repr=False)


def mesh_cycle(
    pair: Pair,
    pitch: float,
    engagement: Engagement | None = None,
    *,
    curve: MeshCurve | None = None,
    jammed: bool = False,
) -> Cycle | None:
    """The cycle of a pair at pinion pitch `pitch` (rad), from its whole `engagement`, which is followed where it is not given, or
    from the `curve` of its gears.

    Where a pair has surface contact nowhere (misaligned line contact) the contact ratio is NaN. None where nothing touches. Gears
    that are `jammed` have no transmission error: NaN.
    """
    if curve is None:
        curve = gears_curve(pair, pitch, engagement)
    if curve is None:
        return None
    surface, followed = curve.surface, curve.engagement
    if jammed:
        return Cycle(
            phi1=np.arange(PER_PITCH) * pitch / PER_PITCH,
            te=np.zeros((0, PER_PITCH)),
            envelope=np.full(PER_PITCH, np.nan),
            contact_ratio=surface.length / pitch,
            harmonics=np.full(HARMONICS, np.nan),
            surface=(surface.begin, surface.end),
            engagement=_touching(curve),
            curve=curve,
        )
    te, envelope = _sample(curve, pitch)
    reference = _reference(followed)
    phase = np.unique(np.concatenate((np.linspace(0.0, pitch, 4 * PER_PITCH + 1), np.clip(curve.marks[0], 0.0, pitch))))
    # the same places of pair 0, so that its curve and that of the gears are one where it is ahead
    turns = np.arange(np.floor(curve.phi1[0] / pitch), np.ceil(curve.phi1[-1] / pitch))
    every = np.unique(np.concatenate((curve.phi1[[0, -1]], (turns[:, None] * pitch + phase).ravel())))
    own = every[(every >= curve.phi1[0]) & (every <= curve.phi1[-1])]
    return Cycle(
        phi1=np.arange(PER_PITCH) * pitch / PER_PITCH,
        te=te - reference,
        envelope=envelope - reference,
        contact_ratio=surface.length / pitch,
        harmonics=curve.harmonics(),
        breaks=_breaks(curve, pitch),
        peak_to_peak=curve.peak_to_peak,
        transverse_ratio=(surface.length - surface.overlap) / pitch,
        overlap_ratio=surface.overlap / pitch,
        surface=(surface.begin, surface.end),
        engagement=_whole(curve),
        handovers=tuple(curve.handovers().tolist()),
        curve=curve,
        pair=np.stack((own, pair.drive * curve.of_pair.at(own)[0] - reference)),
        gears=np.stack((phase, pair.drive * curve.advance(phase) - reference)),
    )


def gears_curve(pair: Pair, pitch: float, engagement: Engagement | None = None) -> MeshCurve | None:
    """The transmission advance of the gears, from the whole `engagement` of a pair, which is followed where it is not given;
    None where nothing touches. Eccentric members stay displaced as at phi1 = 0: their tooth pairs are alike."""
    alike = displaced_pair(pair)
    followed = whole_engagement(alike, pitch) if engagement is None or alike is not pair else engagement
    return None if followed is None or not followed.contacts.touching.any() else MeshCurve(followed, pitch)


def engagement_range(engagement: Engagement, pitch: float, cycle: Cycle | None = None) -> tuple[float, float]:
    """phi1 (rad) between which a pair is ahead of its neighbours or has surface contact.

    Of eccentric members it begins and ends with the surface contact of this tooth pair. It goes beyond it as far as the range of
    members that stay displaced as at phi1 = 0 does; `cycle` is theirs, where it is known.
    """
    curve = MeshCurve(engagement, pitch)
    if displaced_pair(engagement.pair) is engagement.pair:
        return _whole(curve)
    alike = gears_curve(engagement.pair, pitch) if cycle is None else cycle.curve
    if alike is None:
        return _touching(curve)
    first, last = _whole(alike)
    own, other = curve.surface, alike.surface
    moved = own.begin - other.begin, own.end - other.end
    return (first + moved[0], last + moved[1]) if np.isfinite(moved).all() else (first, last)


def _te(engagement: Engagement, contacts: Contacts, phi1: Array) -> Array:
    """phi2 - phi1 N1/N2 (N,), rad, NaN where there is no contact."""
    return np.where(contacts.touching, contacts.x[:, 4] - engagement.pair.ratio * phi1, np.nan)


def _reference(engagement: Engagement) -> float:
    """Transmission error of pair 0 at phi1 = 0, or of the first position that touches."""
    te = _te(engagement, engagement.contacts, engagement.phi1)
    at_zero = te[np.abs(engagement.phi1) < 1e-12]
    return float(at_zero[0] if at_zero.size and np.isfinite(at_zero[0]) else te[np.isfinite(te)][0])


def _sample(curve: MeshCurve, pitch: float) -> tuple[Array, Array]:
    """Transmission errors of the tooth pairs (K, Q) and of the gears (Q,), over one pitch."""
    first, last = (round(float(curve.phi1[k] / pitch * PER_PITCH)) for k in (0, -1))
    steps = np.arange(first, last + 1)
    phi1 = steps * pitch / PER_PITCH
    rows = np.floor_divide(steps, PER_PITCH)
    table = np.full((int(np.ptp(rows)) + 1, PER_PITCH), np.nan)
    drive = curve.pair.drive
    te = drive * curve.of_pair.at(phi1)[0]
    table[rows - rows[0], steps - rows * PER_PITCH] = te
    envelope = drive * np.max(np.where(np.isnan(table), -np.inf, drive * table), axis=0)
    return (
        table[~np.isnan(table).all(axis=1)],
        np.where(np.isfinite(envelope), envelope, np.nan),
    )


def _whole(curve: MeshCurve) -> tuple[float, float]:
    """phi1 between which the pair is ahead of its neighbours or has surface contact."""
    ends = [end for end in (curve.surface.begin, curve.surface.end) if np.isfinite(end)]
    ends += [end for arc in curve.arcs for end in (arc.first, arc.last)]
    return (min(ends), max(ends)) if ends else _touching(curve)


def _touching(curve: MeshCurve) -> tuple[float, float]:
    """phi1 between which the pair touches at all."""
    touching = curve.phi1[curve.contacts.touching]
    return float(touching[0]), float(touching[-1])


def _breaks(curve: MeshCurve, pitch: float) -> tuple[Break, ...]:
    """Breaks of a pair with surface contact between its two ends, where its neighbours' begins and ends too."""
    begin, end = curve.surface.begin, curve.surface.end
    if not np.isfinite(begin):
        return ()
    if end - begin < pitch:
        return (Break(end, np.nan, beginning=False),)
    advance = curve.of_pair.at(np.array([begin, begin + pitch, end - pitch, end]))[0]
    breaks = []
    for phi1, (own, other), beginning in ((begin, advance[:2], True), (end, advance[:1:-1], False)):
        ahead = own - other
        if ahead > JUMP:
            breaks.append(Break(phi1, float(ahead), beginning))
    return tuple(breaks)
