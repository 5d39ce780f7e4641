"""Contact of all pairs whose pinions turn as one and share the torque, as the discs of a cycloidal drive.

Pair k touches where its gear has turned by D_k (rad, in the sense of the drive) beyond the nominal ratio. Its coast flanks touch
where the gear has turned by D_k + P_k, with the play P_k of the pair. One gear meets all pairs:

    D = max D_k,        P = min (D_k + P_k) - D

D is the transmission error of all pairs, P their backlash. A negative P is a jam that no pair has on its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.contact.engagement.cycle import gears_curve
from gearmesh.contact.engagement.turns import pitches_until_repeat
from gearmesh.contact.engagement.uneven_teeth import flanks_ahead
from gearmesh.contact.fit.fit import Fit, fit
from gearmesh.contact.flanks import solver_pair
from gearmesh.figures import Figures, Summary, figure
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair, GearTrain

if TYPE_CHECKING:
    from gearmesh.answers.contact.contact import Contact
    from gearmesh.contact.engagement.curve import MeshCurve

#: positions in a pitch of teeth that are alike
POSITIONS_PER_PITCH = 192
#: positions in a pitch over whole turns
POSITIONS_PER_UNLIKE_PITCH = 12
#: lag (rad) within which a pair touches together with the first
TOGETHER_RAD = 1e-9
#: distance (mm) and angle (rad) of mounts that are the same
SAME_PLACE = 1e-9


@dataclass(frozen=True)
class SharedFigures(Figures):
    """Contact of all pairs that share the torque, as the discs of a cycloidal drive."""

    set_te_peak_to_peak: float = figure(
        "transmission error with all members that share the torque, peak to peak", "arcsec"
    )
    set_backlash_min: float | None = figure(
        "backlash with all members that share the torque as rotation of the gear, least", "deg", optional=True
    )
    set_backlash_max: float | None = figure(
        "backlash with all members that share the torque as rotation of the gear, greatest", "deg", optional=True
    )
    first: Mapping[str, float] = figure(
        "part of the positions at which a member touches first, alone or with others", "%", key="{member}_first_percent"
    )


@dataclass(frozen=True)
class SharedTouch:
    """First touch of all pairs that share the torque."""

    #: names of the pinions
    names: tuple[str, ...]
    #: rotations (P,) of the pinions, rad: over a pitch, or over the turns after which unlike teeth repeat
    phi1: Array
    #: advances (K, P), rad, at which each pair touches, +1 or -1 times phi2 - phi1 N1/N2
    advances: Array
    #: rotation (P,), rad, of the gear between the first touches of all pairs; None for teeth that are not alike
    backlash: Array | None

    @property
    def figures(self) -> SharedFigures:
        """Figures of all pairs together."""
        ahead = self.advances.max(axis=0)
        first = np.mean(self.advances > ahead - TOGETHER_RAD, axis=1)
        low, high = (
            (None, None) if self.backlash is None else np.degrees((self.backlash.min(), self.backlash.max())).tolist()
        )
        shares = (100.0 * first).tolist()
        return SharedFigures(float(np.ptp(ahead)) / ARCSEC, low, high, dict(zip(self.names, shares, strict=True)))


def with_shared(contact: Contact, train: GearTrain, which: int | str) -> Contact:
    """Return the contact of a pair with the figures of all pairs that share its torque, if there are some."""
    curve = None if contact.cycle is None else contact.cycle.curve
    touch = shared_touch(train.sharing(which), curve, contact.fit, over_turns=contact.turns is not None)
    if touch is None:
        return contact
    what = "set_te, set_backlash and *_first are of"
    warning = f"{what} {', '.join(touch.names)} together, all other figures are of {contact.pair.name} alone"
    summary = Summary(contact.summary, touch.figures)
    return replace(contact, summary=summary, warnings=(*contact.warnings, warning))


def names_of_sharing(pair: GearPair) -> tuple[str, ...]:
    """Return the names of the pinions of a pair and of its fellows."""
    return pair.pinion.name, *(fellow.pair.pinion.name for fellow in pair.fellows)


def shared_touch(
    pair: GearPair, curve: MeshCurve | None, fitted: Fit | None, *, over_turns: bool = False
) -> SharedTouch | None:
    """Return the first touch of a pair and its fellows, from the curve and the fit of the pair.

    None without fellows, for eccentric members, where some pair loses contact, and for unlike teeth but `over_turns`.
    """
    rows = pair.halves
    if not pair.fellows or any(row.eccentric for row in rows) or curve is None or fitted is None or fitted.gaps:
        return None
    names = names_of_sharing(pair)
    turned = [_turned(row) for row in rows]
    if any(own is None for own in turned):
        return _of_unlike_teeth(pair, names) if over_turns else None
    phi1 = pair.pitch * np.arange(POSITIONS_PER_PITCH) / POSITIONS_PER_PITCH
    advances, ends = [], []
    for row, phase, (first, second) in zip(rows, pair.phases, filter(None, turned), strict=True):
        same = _same(row, pair)
        fits = fitted if same else fit(row)
        known = curve if same else gears_curve(solver_pair(row), row.pitch)
        if fits is None or fits.gaps or known is None or not known.whole:
            return None
        at = phi1 + phase + first
        advance = known.advance(np.mod(at, pair.pitch)) + pair.drive * (pair.ratio * first - second)
        advances.append(advance)
        ends.append(advance + fits.play(at))
    made = np.stack(advances)
    return SharedTouch(names, phi1, made, np.min(ends, axis=0) - made.max(axis=0))


def _of_unlike_teeth(pair: GearPair, names: tuple[str, ...]) -> SharedTouch | None:
    """Return the first touch of a pair and its fellows over the turns after which their teeth repeat; None without contact."""
    from gearmesh.loaded.separation import advances_of_halves

    pitches = max(pitches_until_repeat(row) for row in pair.halves)
    phi1 = pair.pitch * np.arange(pitches * POSITIONS_PER_UNLIKE_PITCH) / POSITIONS_PER_UNLIKE_PITCH
    advances = advances_of_halves(pair, phi1)
    return SharedTouch(names, phi1, advances, None) if np.isfinite(advances).all() else None


def _turned(pair: GearPair) -> tuple[float, float] | None:
    """Return the rotations (rad) of all teeth of pinion and gear against their places, as phi1 and phi2 count; None for unlike
    teeth.
    """
    if pair.uneven:
        return None
    first, second = flanks_ahead(pair, np.zeros(1, dtype=np.intp))
    return float(first[0]), float(second[0])


def _same(row: GearPair, pair: GearPair) -> bool:
    """Return True if a pair has the teeth and places of another."""
    moved = [other.mount.base.inverse @ own.mount.base for own, other in zip(row.both, pair.both, strict=True)]
    off = [np.append(own.translation, own.rotation - np.eye(3)) for own in moved]
    alike = all(own.tooth is other.tooth for own, other in zip(row.both, pair.both, strict=True))
    return alike and float(np.abs(off).max()) < SAME_PLACE
