"""Contact pattern in the words of the workshop: place and size on the flank of each member, drive and coast side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from gearmesh.answers.tables import Listing, round_to
from gearmesh.contact.fit.fit import reversed_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.pattern import ellipse_ends, line_ends
from gearmesh.figures import Figures, figure
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.records import dataclass
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import GearPair

#: smallest length of a path of contact that has a direction, as a share of the flank's height
MIN_PATH_LENGTH_HEIGHTS = 0.02
#: names of the sides of the teeth; True is the driving side
SIDE_NAMES = {True: "drive", False: "coast"}


@dataclass(frozen=True)
class PatternFigures(Figures):
    """The contact pattern of a tooth pair without load on the flank of one member.

    It is the area that the contact ellipses of the whole engagement cover under the marking compound of
    `contact.delta`, or the contact lines.
    """

    side: str = figure("side of the teeth in contact: drive or coast")
    member: str = figure("member whose flank is described")
    flank: str = figure("flank of the member, seen from +z: right or left")
    toe: str = figure("toe: the end of the face from which places count, the inner end or the end face at a z")
    centre_face: float = figure("centre of the contact pattern along the face, from the toe", "%")
    centre_height: float = figure("centre of the contact pattern along the working height, from the root limit", "%")
    length: float = figure("length of the contact pattern, in parts of the face", "%")
    width: float = figure("width of the contact pattern, in parts of the working height", "%")
    face_ends: list[float] = figure("ends of the contact pattern along the face, from the toe", "%")
    height_ends: list[float] = figure("ends of the contact pattern along the working height, from the root limit", "%")
    bias: float | None = figure(
        "bias: direction of the path of contact from root to tip, against the profile; positive towards the heel", "deg"
    )

    @property
    def known(self) -> bool:
        """False for contact on edges alone, which leaves no pattern."""
        return bool(np.isfinite(self.centre_face))


def pattern_figures(pair: GearPair, whole: ContactPath, *, driving: bool = False) -> tuple[PatternFigures, ...]:
    """Return the pattern of a `whole` engagement on both members; none for contact on edges alone."""
    side = SIDE_NAMES[driving]
    return tuple(pattern for which in range(2) if (pattern := _pattern(pair, whole, which, side)).known)


def images(pair: GearPair, driving: Sequence[PatternFigures], exchange: Array) -> tuple[PatternFigures, ...]:
    """Return the patterns of coast flanks that are the image of the driving flanks.

    `exchange` (3,): diagonal of the map of the members' frames. One that exchanges the ends of the face counts from the
    heel. Both maps turn the path of contact over: a half turn exchanges toe and heel, a mirror keeps them.
    """
    flanks = dict(zip(pair.members, reversed_pair(pair).flanks, strict=True))
    turned = float(exchange[2]) < 0.0
    return tuple(
        replace(
            pattern,
            side=SIDE_NAMES[False],
            flank=str(flanks[pattern.member]),
            centre_face=100.0 - pattern.centre_face if turned else pattern.centre_face,
            face_ends=[100.0 - end for end in reversed(pattern.face_ends)] if turned else pattern.face_ends,
            bias=-pattern.bias if turned and pattern.bias is not None else pattern.bias,
        )
        for pattern in driving
    )


def pattern_listing(patterns: Sequence[PatternFigures], delta: float) -> Iterator[Listing]:
    """Yield the table of patterns under a thickness of marking compound (mm); none without a pattern."""
    if not patterns:
        return
    rows = [
        [
            f"{pattern.side}, {pattern.member}",
            *(
                round_to(value, 1)
                for value in (pattern.centre_face, pattern.centre_height, pattern.length, pattern.width)
            ),
            None if pattern.bias is None else round_to(pattern.bias, 1),
            pattern.toe,
        ]
        for pattern in patterns
    ]
    heads = ("side, member", "centre: face %", "height %", "length %", "width %", "bias deg", "toe")
    # one line of a terminal
    title = f"Contact pattern without load, % from toe and root limit, compound {1e3 * delta:.3g} um"
    yield Listing(title, heads, rows)


def _pattern(pair: GearPair, whole: ContactPath, which: int, side: str) -> PatternFigures:
    """Return the pattern of a whole engagement on the pinion (0) or the gear (1)."""
    member, flank = pair.both[which], pair.flanks[which]
    frame = FlankFrame.of(member, flank)
    turn = (whole.rotation, whole.phi2)[which]
    to_own = member.mount.at(turn).inverse
    points = (whole.point1, whole.point2)[which]
    semi = np.stack((whole.semi_major[:, None] * whole.major, whole.semi_minor[:, None] * whole.minor), axis=1)
    axes = np.einsum("pij,pkj->pki", to_own.rotation, semi)
    inside = whole.kind == "point"
    ends = [ellipse_ends(frame, points, axes, inside)]
    lines = [
        line @ to_own.rotation[k].T + to_own.translation[k] for k, line in enumerate(whole.lines) if line is not None
    ]
    if lines:
        ends.append(line_ends(frame, lines))
    low = 100.0 * np.fmin.reduce([end[0] for end in ends])
    high = 100.0 * np.fmax.reduce([end[1] for end in ends])
    (face, height), (length, width) = ((low + high) / 2.0).tolist(), (high - low).tolist()
    return PatternFigures(
        side=side,
        member=member.name,
        flank=str(flank),
        toe=toe_words(frame),
        centre_face=face,
        centre_height=height,
        length=length,
        width=width,
        face_ends=[float(low[0]), float(high[0])],
        height_ends=[float(low[1]), float(high[1])],
        bias=_bias(frame, points[inside]),
    )


def toe_words(frame: FlankFrame) -> str:
    """Return which end of the face is the toe: the inner end, or an end face by its z in the member's own frame."""
    across, along = station_normal(frame.levels[0])
    return "inner end" if across != 0.0 else f"z = {round_to(along * float(frame.up[:, 0, 0].mean()), 4):.6g} mm"


def _bias(frame: FlankFrame, points: Array) -> float | None:
    """Return the direction (deg) of the path of contact, points (P, 3), from root to tip; None for a path too short."""
    if len(points) < 2:
        return None
    along, up = frame.places(points)[[0, -1]].T @ np.array([-1.0, 1.0])
    height = float(np.ptp(frame.extent[:, 1]))
    if np.hypot(along, up) < MIN_PATH_LENGTH_HEIGHTS * height:
        return None
    sense = -1.0 if up < 0.0 else 1.0
    return float(np.degrees(np.arctan2(sense * along, sense * up)))
