"""Whole mesh cycle: tooth pairs are in contact in turn, and the first pair to touch determines the transmission error.

Pair k has at phi1 the contact of pair 0 at phi1 - k pitches. (Eccentric members stay displaced as at phi1 = 0, see
`displaced_pair`.) te(phi1) is the transmission error of one pair over its whole engagement, edges included. The transmission error
of the gears is the extreme of te(phi1 - k pitch) over k, a chain of smooth arcs. Changes of the pair in contact, ends of surface
contact and extremes of an arc are roots.
"""

from __future__ import annotations

from dataclasses import field
from functools import cached_property

import numpy as np

from gearmesh.contact.conditions.refinement import Contacts
from gearmesh.contact.engagement.curve import HARMONIC_COUNT, MeshCurve
from gearmesh.contact.engagement.displaced import displaced_pair
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.records import dataclass

#: positions in a pitch at which the cycle is given
POSITIONS_PER_PITCH = 24
#: least step (rad) of the transmission error that is a break (0.1 arcsec)
MIN_BREAK_RAD = 5e-7


@dataclass(frozen=True)
class Break:
    """Break of the transmission error of the flanks' surfaces [LF04 17.8], which edge contact bridges.

    The surface contact of a pair ends while the pair is ahead of the next pair, or begins while the pair is already ahead.
    """

    #: rotation of the pinion at the break, rad
    phi1: float
    #: lead of the pair over the other pair, rad, NaN where no other pair has surface contact
    jump: float
    #: True for the beginning of surface contact, False for its end
    beginning: bool


@dataclass(frozen=True)
class Cycle:
    """Mesh cycle of a pair: transmission error, contact ratio and ends of contact."""

    #: rotations (Q,) of the pinion over one pitch, rad
    phi1: Array
    #: transmission errors (K, Q) of the tooth pairs that touch in the pitch, rad, NaN where a pair does not touch
    te: Array
    #: transmission error (Q,) of the gears, rad
    envelope: Array
    #: pitches over which one pair has surface contact, NaN if it has none
    contact_ratio: float
    #: amplitudes of the first harmonics of the mesh frequency in the transmission error, rad
    harmonics: Array
    #: places where surface contact does not pass smoothly to the next pair
    breaks: tuple[Break, ...] = ()
    #: greatest less least transmission error, rad
    peak_to_peak: float = np.nan
    #: transverse contact ratio of line contact
    transverse_ratio: float = np.nan
    #: overlap ratio of line contact
    overlap_ratio: float = np.nan
    #: phi1 at which surface contact of pair 0 begins and ends, rad
    surface: tuple[float, float] = (np.nan, np.nan)
    #: phi1 between which pair 0 may be ahead of its neighbours or has surface contact, rad
    engagement: tuple[float, float] = (np.nan, np.nan)
    #: advance of the gears
    curve: MeshCurve | None = field(default=None, repr=False)
    #: transmission error of pair 0 at phi1 = 0 or at the first position with contact, rad; NaN for jammed gears
    reference: float = np.nan

    @cached_property
    def handovers(self) -> tuple[float, ...]:
        """phi1 at which pair 0 takes over from another pair, rad."""
        return () if self.curve is None or np.isnan(self.reference) else tuple(self.curve.handovers().tolist())

    @cached_property
    def gears(self) -> Array | None:
        """phi1 and te (2, M) of the gears over one pitch with all bends, rad; None for jammed gears."""
        if self.curve is None or np.isnan(self.reference):
            return None
        phase = _phases(self.curve)
        return np.stack((phase, self.curve.pair.drive * self.curve.advance(phase) - self.reference))

    @cached_property
    def pair(self) -> Array | None:
        """phi1 and te (2, K) of pair 0 over its engagement, rad; None for jammed gears."""
        if self.curve is None or np.isnan(self.reference):
            return None
        # the same phases as those of the gears, so that both curves coincide where the pair is ahead
        phi1, pitch = self.curve.phi1, self.curve.pitch
        turns = np.arange(np.floor(phi1[0] / pitch), np.ceil(phi1[-1] / pitch))
        every = distinct(np.concatenate((phi1[[0, -1]], (turns[:, None] * pitch + _phases(self.curve)).ravel())))
        own = every[(every >= phi1[0]) & (every <= phi1[-1])]
        return np.stack((own, self.curve.pair.drive * self.curve.of_pair.at(own)[0] - self.reference))


def mesh_cycle(
    pair: Pair,
    pitch: float,
    engagement: Engagement | None = None,
    *,
    curve: MeshCurve | None = None,
    jammed: bool = False,
) -> Cycle | None:
    """Compute the cycle of a pair at pinion pitch `pitch` (rad); None where nothing touches.

    The cycle starts from the `curve` of the gears or from the whole `engagement`; without both, the engagement is followed. The
    contact ratio is NaN where a pair has no surface contact (misaligned line contact). The transmission error of `jammed` gears is
    NaN.
    """
    if curve is None:
        curve = gears_curve(pair, pitch, engagement)
    if curve is None:
        return None
    surface, followed = curve.surface, curve.engagement
    # gears that overlap have an engagement of each pair alone, but no transmission error
    if jammed:
        return Cycle(
            phi1=np.arange(POSITIONS_PER_PITCH) * pitch / POSITIONS_PER_PITCH,
            te=np.zeros((0, POSITIONS_PER_PITCH)),
            envelope=np.full(POSITIONS_PER_PITCH, np.nan),
            contact_ratio=surface.length / pitch,
            harmonics=np.full(HARMONIC_COUNT, np.nan),
            surface=(surface.begin, surface.end),
            engagement=_touching(curve),
            curve=curve,
        )
    te, envelope = _sample(curve, pitch)
    reference = _reference(followed)
    return Cycle(
        phi1=np.arange(POSITIONS_PER_PITCH) * pitch / POSITIONS_PER_PITCH,
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
        curve=curve,
        reference=reference,
    )


def gears_curve(pair: Pair, pitch: float, engagement: Engagement | None = None) -> MeshCurve | None:
    """Compute the transmission advance of the gears; None where nothing touches.

    `engagement` is the whole engagement of the pair, followed here if it is not given. Eccentric members stay displaced as at
    phi1 = 0, so all tooth pairs have the same curve.
    """
    alike = displaced_pair(pair)
    followed = whole_engagement(alike, pitch) if engagement is None or alike is not pair else engagement
    return None if followed is None or not followed.contacts.touching.any() else MeshCurve(followed, pitch)


def range_of_curve(curve: MeshCurve) -> tuple[float, float]:
    """Return phi1 (rad) as `engagement_range` does, from a curve of the engagement with any tolerance."""
    begin, end, margin = curve.surface.begin, curve.surface.end, 2.0 * curve.tolerance
    # arcs that certainly lie within surface contact do not decide
    if np.isfinite([begin, end]).all() and all(
        arc.first - margin > begin and arc.last + margin < end for arc in curve.arcs
    ):
        return begin, end
    return engagement_range(curve.engagement, curve.pitch)


def engagement_range(engagement: Engagement, pitch: float, cycle: Cycle | None = None) -> tuple[float, float]:
    """Return phi1 (rad) between which a pair is ahead of its neighbours or has surface contact.

    The range of eccentric members is the range of members that stay displaced as at phi1 = 0, shifted by the difference of the
    ends of surface contact. The `cycle` of the displaced members is used if it is known.
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


def _phases(curve: MeshCurve) -> Array:
    """Return phases (M,), rad, within a pitch: equal steps, and the bends of the curve, which steps between would cut off."""
    equal = np.linspace(0.0, curve.pitch, 4 * POSITIONS_PER_PITCH + 1)
    return distinct(np.concatenate((equal, np.clip(curve.marks[0], 0.0, curve.pitch))))


def _te(engagement: Engagement, contacts: Contacts, phi1: Array) -> Array:
    """Return phi2 - phi1 N1/N2 (N,), rad, NaN without contact."""
    return np.where(contacts.touching, contacts.x[:, 4] - engagement.pair.ratio * phi1, np.nan)


def _reference(engagement: Engagement) -> float:
    """Return the transmission error (rad) of pair 0 at phi1 = 0, or at the first position with contact."""
    te = _te(engagement, engagement.contacts, engagement.phi1)
    at_zero = te[np.abs(engagement.phi1) < 1e-12]
    return float(at_zero[0] if at_zero.size and np.isfinite(at_zero[0]) else te[np.isfinite(te)][0])


def _sample(curve: MeshCurve, pitch: float) -> tuple[Array, Array]:
    """Return transmission errors (K, Q) of the tooth pairs and (Q,) of the gears over one pitch, rad."""
    first, last = (round(float(curve.phi1[k] / pitch * POSITIONS_PER_PITCH)) for k in (0, -1))
    steps = np.arange(first, last + 1)
    phi1 = steps * pitch / POSITIONS_PER_PITCH
    rows = np.floor_divide(steps, POSITIONS_PER_PITCH)
    table = np.full((int(np.ptp(rows)) + 1, POSITIONS_PER_PITCH), np.nan)
    drive = curve.pair.drive
    te = drive * curve.of_pair.at(phi1)[0]
    table[rows - rows[0], steps - rows * POSITIONS_PER_PITCH] = te
    envelope = drive * np.max(np.where(np.isnan(table), -np.inf, drive * table), axis=0)
    return (
        table[~np.isnan(table).all(axis=1)],
        np.where(np.isfinite(envelope), envelope, np.nan),
    )


def _whole(curve: MeshCurve) -> tuple[float, float]:
    """Return phi1 (rad) between which the pair is ahead of its neighbours or has surface contact."""
    if curve.within_surface:
        return curve.surface.begin, curve.surface.end
    ends = [end for end in (curve.surface.begin, curve.surface.end) if np.isfinite(end)]
    ends += [end for arc in curve.arcs for end in (arc.first, arc.last)]
    return (min(ends), max(ends)) if ends else _touching(curve)


def _touching(curve: MeshCurve) -> tuple[float, float]:
    """Return phi1 (rad) between which the pair touches."""
    touching = curve.phi1[curve.contacts.touching]
    return float(touching[0]), float(touching[-1])


def _breaks(curve: MeshCurve, pitch: float) -> tuple[Break, ...]:
    """Return breaks at the ends of surface contact of a pair, where surface contact of its neighbours ends and begins."""
    # compare this pair with its neighbour where surface contact begins and ends: whoever is ahead there breaks the smooth curve
    begin, end = curve.surface.begin, curve.surface.end
    if not np.isfinite(begin):
        return ()
    if end - begin < pitch:
        return (Break(end, np.nan, beginning=False),)
    advance = curve.of_pair.at(np.array([begin, begin + pitch, end - pitch, end]))[0]
    breaks = []
    for phi1, (own, other), beginning in ((begin, advance[:2], True), (end, advance[:1:-1], False)):
        ahead = own - other
        if ahead > MIN_BREAK_RAD:
            breaks.append(Break(phi1, float(ahead), beginning))
    return tuple(breaks)
