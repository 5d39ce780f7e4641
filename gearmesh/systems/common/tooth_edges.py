"""Broken edges of teeth, and the refusal of edges for which a tooth has no room."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.numeric.effort import EffortSpentError
from gearmesh.kernel.numeric.excess import Division, Refused
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.systems.common.pressure_angles import CoastSide
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import end_names
from gearmesh.teeth.blank.end_edge import EndChamfer, EndChamfers
from gearmesh.teeth.blank.tip_edge import TipEdge
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import HEEL_END, TOE_END, Side
from gearmesh.teeth.tooth import Tooth

if TYPE_CHECKING:
    from gearmesh.design.core import BrokenEdges

#: default angle of the chamfers to the end faces
DEFAULT_END_CHAMFER_ANGLE_DEG = 45.0
#: halvings to the largest share that fits, of which messages show six digits
BISECTION_STEPS = 24
#: width of the interval in which the largest share is found by the excess of refusals
SHARE_TOLERANCE = 2.0**-BISECTION_STEPS
#: width of that interval, as a part of the share, with which a search may end that takes too long
KNOWN_SHARE = 2e-3
#: largest number of proofs of a tip edge of the largest size that fits at the known stations
MAX_EDGE_PROOFS = 3


def tip_edge(spec: BrokenEdges, joint: Joint = REVOLUTE_JOINT, coast: Side = Side.LEFT) -> TipEdge | None:
    """Return the broken tip edge that a part of a design asks for; None if it asks for none.

    `coast`: flanks of the coast side, whose edge may have another size.
    """
    other = spec.coast_tip_edge if isinstance(spec, CoastSide) else None
    if spec.tip_chamfer:
        return TipEdge(spec.tip_chamfer, False, joint, other, coast)
    return TipEdge(spec.tip_rounding, True, joint, other, coast) if spec.tip_rounding else None


def with_tip_edge(name: str, tooth: Tooth, spec: BrokenEdges) -> Tooth:
    """Return the proved tooth of a member with the tip edge that its part `spec` of a design asks for.

    Raises DesignError naming the key, its value and the largest value that fits.
    """
    edge = tip_edge(spec, tooth.joint)
    if edge is None:
        return tooth
    broken = replace(tooth, tip_edge=edge)
    try:
        broken.prove()
    except TrimError as failure:
        refusal = edge_refusal(name, broken, failure)
        raise refusal or DesignError(name, reason=failure.reason) from failure
    return broken


def end_widths(spec: BrokenEdges) -> tuple[float | None, float | None]:
    """Return the widths of the chamfers at toe and heel; None without a chamfer."""
    toe, heel = (spec.end_chamfer if own is None else own for own in (spec.end_chamfer_toe, spec.end_chamfer_heel))
    return toe, heel


def _end_radii(spec: BrokenEdges) -> tuple[float | None, float | None]:
    """Return the radii of the roundings at toe and heel; None without a rounding."""
    toe, heel = (spec.end_rounding if own is None else own for own in (spec.end_rounding_toe, spec.end_rounding_heel))
    return toe, heel


def with_end_chamfers(member: Member, spec: BrokenEdges) -> Member:
    """Return a member with the chamfers or roundings of its end faces that its part `spec` (in mm) asks for.

    This is the last step, since modifications are defined on the whole face. Raises DesignError naming the key, its
    value and the largest value that fits.
    """
    order = [(TOE_END, HEEL_END).index(name) for name in end_names(member.tooth.blank.axial)]
    widths, radii = ([both[end] for end in order] for both in (end_widths(spec), _end_radii(spec)))
    if not any((*widths, *radii)):
        return member
    slope = np.tan(
        np.radians(DEFAULT_END_CHAMFER_ANGLE_DEG if spec.end_chamfer_angle is None else spec.end_chamfer_angle)
    )

    sharp = member.tooth.sharp_ends

    def chamfers(shares: tuple[float, float]) -> EndChamfers:
        first, last = (
            EndChamfer(share * r, share * r, rounded=True)
            if r and share
            else EndChamfer(share * w, float(share * w * slope))
            if w and share
            else None
            for w, r, share in zip(widths, radii, shares, strict=True)
        )
        return first, last

    def fits_ends(*shares: float) -> bool:
        """True if chamfers of these shares fit the sharp outline, which is the same for every share."""
        blank = sharp.blank.with_ends(chamfers((shares[0], shares[1])))
        return goes(lambda: _prove_ends(member, blank, lambda end, ch: sharp.sharp_outlines[end].inside(ch.width)))

    made = replace(member.tooth, blank=sharp.blank.with_ends(chamfers((1.0, 1.0))))
    if goes(lambda: _prove_ends(member, made.blank, lambda end, _: _outline_of(made, end))):
        return replace(member, tooth=made)
    # the end at fault, toe first, is the one whose edge does not fit even alone
    ends = [order.index(end) for end in (0, 1)]
    keys = dict(zip(ends, _end_keys(spec), strict=True))
    at_fault = next(
        (end for end in ends if keys[end] and not fits_ends(*(float(end == own) for own in (0, 1)))), ends[0]
    )
    key = keys[at_fault] or keys[1 - at_fault]
    width, other = getattr(spec, key), keys[1 - at_fault]
    beside = 1.0 if other and fits_ends(*(float(at_fault != own) for own in (0, 1))) else 0.0

    def shares(share: float) -> tuple[float, ...]:
        return tuple(share if keys[own] == key else beside for own in (0, 1))

    limit = largest(lambda share: fits_ends(*shares(share)))
    larger, most = "larger than teeth, face width or rim allow", Allowed.at_most(limit * width, "mm")
    raise DesignError(f"{member.name}.{key}", width, unit="mm", reason=larger, allowed=most)


def _end_keys(spec: BrokenEdges) -> tuple[str, str]:
    """Return the keys that give the broken edges at toe and heel; empty where an end is sharp."""
    toe, heel = (
        next(
            (
                key
                for edge in ("chamfer", "rounding")
                for key in (f"end_{edge}_{end}", f"end_{edge}")
                if _asks(spec, key, end)
            ),
            "",
        )
        for end in ("toe", "heel")
    )
    return toe, heel


def _asks(spec: BrokenEdges, key: str, end: str) -> bool:
    """True if a key gives the broken edge of an end; a key for both ends does so unless the end has its own."""
    own = f"{key}_{end}"
    return bool(getattr(spec, key)) and getattr(spec, own, None) is None


def _prove_ends(member: Member, blank: Blank, outline: Callable[[int, EndChamfer], Array]) -> None:
    """Raise TrimError if the chamfers of a member's blank have no room in the face, on teeth or body, or beside holes.

    `outline` returns points (N, 3) of an end face's outline with its chamfer. It raises TrimError if the teeth have no
    room for it.
    """
    toe, heel = blank.extent
    if (heel - toe) * np.subtract(*blank.faces[::-1]) <= 0.0:
        raise TrimError("end", 0.0, "the end chamfers meet")
    across = blank.across
    for end, chamfer in enumerate(blank.ends):
        if chamfer is None:
            continue
        rho, z = blank.body.profile[-end]
        edge = outline(end, chamfer)
        above = across.value(edge) - float(across.value(np.array([rho, 0.0, z])))
        if (above * np.sign(above[0]) <= 0.0).any():
            raise TrimError("end", 0.0, "the end chamfer reaches the body's profile")
        if _reaches_hole(member, end, edge):
            raise TrimError("end", 0.0, "the end chamfer reaches a hole")


def _reaches_hole(member: Member, end: int, edge: Array) -> bool:
    """True if the outline (N, 3) of a broken end, 0 or 1 of the tooth, reaches a hole in an outer face of the member."""
    rho, z = member.tooth.blank.body.profile[-end]
    faces = [
        float(half.points(np.array([rho, 0.0, z]))[2])
        for number, half in enumerate(member.halves)
        if (number, end) in member.rows.outer
    ]
    radius = member.tooth.joint.radius(edge)
    return any(
        radius.min() <= opening.reach[1] and radius.max() >= opening.reach[0]
        for opening in member.openings
        for face in faces
        if face in (opening.low, opening.high) and face != opening.floor
    )


def _share_keeps_off(member: Member, end: int, width: float, share: float) -> bool:
    """True if a share of the width (mm) of a broken end does not reach a hole."""
    return not _reaches_hole(member, end, member.tooth.sharp_ends.sharp_outlines[end].inside(share * width))


def check_beside_holes(member: Member, spec: BrokenEdges) -> None:
    """Refuse broken ends that reach holes of a double helical member, whose halves get their ends before the holes.

    `spec`: part of the design, in mm. Raises DesignError naming the key, its value and the largest value that fits.
    """
    tooth, keys = member.tooth, dict(zip((TOE_END, HEEL_END), _end_keys(spec), strict=True))
    for end, name in enumerate(end_names(tooth.blank.axial)):
        key, chamfer = keys[name], tooth.blank.ends[end]
        if chamfer is None or not _reaches_hole(member, end, _outline_of(tooth, end)):
            continue
        limit = largest(partial(_share_keeps_off, member, end, chamfer.width))
        raise DesignError(
            f"{member.name}.{key}",
            getattr(spec, key),
            unit="mm",
            reason="reaches the holes in the end face",
            allowed=Allowed.at_most(limit * getattr(spec, key), "mm"),
        )


def _outline_of(tooth: Tooth, end: int) -> Array:
    """Return points (N, 3) of the outline of an end face with a chamfer."""
    strip = tooth.end_strips[end]
    assert strip is not None
    return strip.outline


def edge_refusal(name: str, tooth: Tooth, failure: TrimError) -> DesignError | None:
    """Return the refusal of a broken tip edge that is too large; None if trimming failed for another reason.

    The refusal has no bound if the search for it takes too long.
    """
    edge = tooth.tip_edge
    if edge is None or failure.what not in ("edge", "pointed"):
        return None
    # a tooth that is pointed may be so without the edge, too
    if failure.what == "pointed" and not fits(replace(tooth, tip_edge=None), 1.0):
        return None
    # of two sizes the larger one is refused, and the other one stays
    on_coast = edge.coast_size is not None and edge.coast_size > edge.size
    key = "coast_tip_edge" if on_coast else "tip_rounding" if edge.rounded else "tip_chamfer"
    size = edge.of(edge.coast).size if on_coast else edge.size
    try:
        most: str = Allowed.at_most(_largest_edge(tooth, edge, failure, on_coast=on_coast), "mm")
    except EffortSpentError:
        most = ""
    return DesignError(f"{name}.{key}", size, unit="mm", reason="larger than the tooth's tip allows", allowed=most)


def _largest_edge(tooth: Tooth, edge: TipEdge, failure: TrimError, *, on_coast: bool) -> float:
    """Return the largest size (mm) of a broken tip edge that a tooth has room for; `failure`: that of its own size.

    `on_coast`: the size is that of the coast side alone.
    """
    size = edge.of(edge.coast).size if on_coast else edge.size

    def tooth_of_share(share: float) -> Tooth:
        own = replace(edge, coast_size=share * size) if on_coast else replace(edge, size=share * size)
        return replace(tooth, tip_edge=own)

    def trim(most: float, at: Array, share: float) -> None:
        tooth_of_share(share * most).sections(at)

    # the largest size at some stations is proved over the whole face; the station of a failure is added
    stations, limit = distinct(np.append(stations_on(1.0), failure.station)), 1.0
    for _ in range(MAX_EDGE_PROOFS):
        limit *= largest_trimmed(partial(trim, limit, stations), failure)
        try:
            tooth_of_share(limit).prove()
            break
        except TrimError as further:
            # there is less room between the stations so far
            failure, stations = further, distinct(np.append(stations, further.station))
        except EffortSpentError:
            # what fits at the stations fits between them but for tips that bulge
            break
    return limit * size


def fits(tooth: Tooth, share: float) -> bool:
    """True if the tooth can be trimmed on the given share of its face width, about the middle."""
    return goes(lambda: tooth.sections(stations_on(share)))


def stations_on(share: float) -> Array:
    """Stations t (3,) on the given share of the face width, about the middle."""
    return 0.5 + 0.5 * share * np.linspace(-1.0, 1.0, 3)


def goes(trim: Callable[[], object]) -> bool:
    """True if `trim` does not fail."""
    try:
        trim()
    except TrimError:
        return False
    return True


def largest_trimmed(trim: Callable[[float], object], whole: TrimError | None = None) -> float:
    """Return the largest share in [0, 1] that can be trimmed, 0 if there is none; `trim` raises TrimError beyond it.

    `whole`: the failure of the share 1, if it is known. If the effort is spent, a share that is known to KNOWN_SHARE will do.
    """
    good, bad, division = 0.0, 1.0, Division()
    refused: list[Refused] = []
    aim: float | None = bad
    if whole is not None:
        division.last_refused, aim = True, 0.5
        refused.append((bad, whole.excess))
    while aim is not None:
        try:
            trim(aim)
        except TrimError as failure:
            bad, division.last_refused = aim, True
            refused.insert(0, (aim, failure.excess))
        except EffortSpentError:
            if bad - good > KNOWN_SHARE * good:
                raise
            break
        else:
            good, division.last_refused = aim, False
        if bad - good <= SHARE_TOLERANCE or good == 1.0:
            break
        aim = division.beside_root(good, bad, refused, SHARE_TOLERANCE)
        aim = 0.5 * (good + bad) if aim is None else aim
    return good


def largest(fits_share: Callable[[float], bool]) -> float:
    """Return the largest share in [0, 1] that fits (0 if none does)."""
    ends = np.zeros(1), np.ones(1)
    most, _ = last_true(
        lambda shares, _: np.array([fits_share(float(s)) for s in shares]), *ends, rounds=BISECTION_STEPS
    )
    return float(most[0])
