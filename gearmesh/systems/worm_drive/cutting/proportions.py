"""Default proportions of worm and wheel: those of DIN 3975, or less where flanks or spaces end sooner or teeth are pointed.

Towards its root a worm's flank ends in a cusp: an involute on its base cylinder, a ground flank near it. A rounding of the
radius R needs the root cylinder within R below the cusp. For steeper threads the cusp is farther from the axis.

Towards one end of the face, the flank of a steep hob turns away from the wheel until it generates nothing. The position
depends on all data of the hob. It is therefore determined on the teeth themselves.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import takewhile
from typing import TYPE_CHECKING, ParamSpec

import numpy as np

from gearmesh.design.keys import given_or
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.systems.worm_drive.build import (
    ADDENDUM_SHARES,
    prove_wheel_of,
    refuse_tools,
    usual_addendum,
    wheel_failure,
    wheel_tooth,
    worm_member,
    worm_thread,
)
from gearmesh.systems.worm_drive.design import ADDENDUM_MODULES, DEDENDUM_MODULES, ROUNDING_MODULES
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign


#: dedenda that are tried, over the usual dedendum
DEDENDUM_SHARES = np.linspace(1.0, 0.5, 13)
#: roundings that are tried, over the usual rounding
ROUNDING_SHARES = np.linspace(1.0, 0.0, 11)
#: least land between two roundings, in axial modules
MIN_LAND_MODULES = 0.002


def open_root(design: WormDriveDesign) -> dict[str, float]:
    """Return the coefficients of dedendum and root rounding of a design with lengths in mm, by dotted key.

    They are the usual values, or the largest dedendum, and for it the largest rounding, that the flanks reach and the
    space has room for. If there are none, they are the usual values. Values that the design states are kept.
    """
    usual = {"worm.dedendum": DEDENDUM_MODULES, "worm.root_rounding": ROUNDING_MODULES}
    stated = math.isfinite(design.worm.dedendum)
    for dedendum in (DEDENDUM_MODULES * (DEDENDUM_SHARES[:1] if stated else DEDENDUM_SHARES)).round(6).tolist():
        if (rounding := _rounding(design.fill({"worm.dedendum": dedendum}))) is not None:
            return {"worm.dedendum": dedendum, "worm.root_rounding": rounding}
    return usual


def _rounding(design: WormDriveDesign) -> float | None:
    """Return the coefficient of the largest root rounding for a dedendum, or None if there is none.

    It is ROUNDING_MODULES, or a share of it with which the roundings of both flanks of a space do not overlap, or a
    stated value that the flanks reach.
    """
    stated, least = math.isfinite(design.worm.root_rounding), MIN_LAND_MODULES * design.axial_module
    largest, *smaller = (
        [design.worm.root_rounding] if stated else (ROUNDING_MODULES * ROUNDING_SHARES).round(6).tolist()
    )
    land = _land(design, largest)
    # flanks that do not reach a rounding do not reach smaller ones either; the smallest rounding leaves the most land
    if land is None or stated or land > least:
        return None if land is None else largest
    if (most := _land(design, smaller[-1])) is not None and most <= least:
        return None
    return next((rounding for rounding in smaller if (_land(design, rounding) or 0.0) > least), None)


def _land(design: WormDriveDesign, rounding: float) -> float | None:
    """Return the least land (mm) between two roundings of a coefficient, or None if flanks do not reach them."""
    spec, m = design.worm, design.axial_module
    root = 0.5 * design.reference_diameter - spec.dedendum * m
    # spaces between dual-lead threads are narrowest at one end
    narrower = abs(spec.dual_lead) * (0.5 * spec.length + spec.run_out)
    lands = []
    for thread in dict.fromkeys(worm_thread(design, side) for side in (1, -1)):
        try:
            # an arc ends on the root below its centre
            lands.append(0.5 * thread.axial_pitch - narrower + thread.root_rounding(root, rounding * m).arc.centre[1])
        except DesignError:
            return None
    return min(lands)


TrimP = ParamSpec("TrimP")

#: widths that are tried, over the usual width
WIDTH_SHARES = np.linspace(0.5, 1.0, 5)
#: smaller widths, over the usual width, that are tried if no tooth is sound on half of it
NARROW_WIDTH_SHARES = (0.5, 0.4, 0.3, 0.2)
#: addenda, over the usual addendum, that are tried with the smaller widths
NARROW_ADDENDUM_SHARES = (1.0, 0.75, 0.5)
#: number of stations of a close proof
CLOSE_STATIONS = 1025
#: share of the face of the middle plane
MIDDLE_STATION = np.array([0.5])
#: lead angle (rad) up to which the usual width is used without trial
GENTLE_LEAD_ANGLE = math.radians(10.0)


def derived_values(design: WormDriveDesign) -> dict[str, float]:
    """Return the wheel's face width and addendum, and the worm's dedendum and root rounding, by dotted key.

    Lengths are in the design's units.

    They are the usual values if the teeth are sound with them, or if nothing helps. A narrower face is preferred to a
    lower tip, but a lower tip to a face less than half as wide as usual.
    """
    root = open_root(design.in_mm())
    design = design.fill(root)
    wheel, usual = design.wheel, design.usual_face_width
    open_width, open_tip = math.isnan(wheel.face_width), math.isnan(wheel.addendum)
    # the width is sought only where it can be the cause: not for helical wheels, nor for gentle threads with a given tip
    sought = wheel.form != "helical" and (open_tip or (open_width and design.lead_angle > GENTLE_LEAD_ANGLE))
    for addendum, narrow in _tries(open_width, open_tip) if sought else ():
        tried = design.fill({"wheel.addendum": round(usual_addendum(design) * addendum, 6)})
        if _refused_by_tools(tried, usual):
            break
        shares = _narrow_shares(tried, usual) if narrow else _sound_shares(tried, given_or(wheel.face_width, usual))
        if (share := next(shares, None)) is not None:
            return {**root, "wheel.addendum": tried.wheel.addendum, "wheel.face_width": share * usual}
        if addendum == 1.0 and not narrow and not (_has_spaces(tried, usual) and _has_worm(design)):
            break
        if not open_width and _form_point_above_tip(tried, wheel.face_width):
            break
    return {**root, "wheel.addendum": usual_addendum(design), "wheel.face_width": usual}


def _tries(open_width: bool, open_tip: bool) -> Iterator[tuple[float, bool]]:
    """Yield shares of the usual addendum in the order of trial, and True for faces less than half as wide as usual."""
    yield from ((share, False) for share in (ADDENDUM_SHARES.tolist() if open_tip else [1.0]))
    if open_width:
        yield from ((share, True) for share in (NARROW_ADDENDUM_SHARES if open_tip else NARROW_ADDENDUM_SHARES[:1]))


def _refused_by_tools(design: WormDriveDesign, usual: float) -> bool:
    """Return True if the hob is impossible, which is refused by its keys."""
    try:
        refuse_tools(design.fill({"wheel.face_width": usual}).in_mm())
    except DesignError:
        return True
    return False


def _has_spaces(design: WormDriveDesign, usual: float) -> bool:
    """Return True if the hob's tips leave spaces in the middle plane.

    Where fillets overlap there, no addendum or width separates them.
    """
    try:
        tooth = wheel_tooth(_in_mm(design, usual))
    except DesignError:
        # another width may have a tooth
        return True
    return _succeeds(tooth.prove_root, MIDDLE_STATION)


def _form_point_above_tip(design: WormDriveDesign, width: float) -> bool:
    """Return True if the undercut ends above the tip somewhere on a face of this width: a lower tip leaves still less."""
    try:
        failure = wheel_failure(_in_mm(design, width))
    except DesignError:
        return False
    # failures without a figure are not of the form point
    return failure is not None and failure.what == "flank" and failure.excess is not None


def _has_worm(design: WormDriveDesign) -> bool:
    """Return True if a worm can be built; an impossible worm is refused by its keys, whatever the wheel."""
    try:
        worm_member(design.in_mm())
    except (DesignError, NoSolutionError):
        return False
    return True


def _sound_shares(design: WormDriveDesign, usual: float) -> Iterator[float]:
    """Yield the shares of the usual width over which the flanks are whole, the largest first.

    Only 1 is tried if the width is given, or the thread is gentle.
    """
    prove = _prove_closely if design.wheel.addendum < ADDENDUM_MODULES else prove_wheel_of
    try:
        tooth = wheel_tooth(wide := _in_mm(design, usual))
    except DesignError:
        return
    # fillets that overlap in the middle plane overlap over any width
    if not _succeeds(tooth.prove_root, MIDDLE_STATION):
        return
    if _succeeds(prove, wide):
        yield 1.0
    if math.isfinite(design.wheel.face_width) or design.lead_angle <= GENTLE_LEAD_ANGLE:
        return
    # the right side represents both: the left one is its mirror image, or nearly
    ends = {share: 0.5 + 0.5 * np.array([-share, share]) for share in WIDTH_SHARES[:-1].tolist()}
    whole = list(takewhile(lambda share: _succeeds(tooth.ends, Side.RIGHT, ends[share]), ends))
    yield from (share for share in whole[::-1] if _succeeds(prove, _in_mm(design, share * usual)))


def _narrow_shares(design: WormDriveDesign, usual: float) -> Iterator[float]:
    """Yield smaller shares of the usual width over which the teeth are sound, the largest first.

    Each is proved separately: where teeth are not sound over half the width, the wide tooth gives no information.
    """
    for share in NARROW_WIDTH_SHARES:
        narrow = _in_mm(design, share * usual)
        try:
            wheel_tooth(narrow)
        except DesignError:
            continue
        if _succeeds(_prove_closely, narrow):
            yield share


def _prove_closely(design: WormDriveDesign) -> None:
    """Trim the wheel's tooth of a design in mm at many stations; fewer may miss where it just fails. Raises TrimError."""
    prove_wheel_of(design)
    wheel_tooth(design).sections(np.linspace(0.0, 1.0, CLOSE_STATIONS))


def _in_mm(design: WormDriveDesign, width: float) -> WormDriveDesign:
    """Return the design in mm with a face width of the wheel in the design's units."""
    return design.fill({"wheel.face_width": width}).in_mm()


def _succeeds(trimming: Callable[TrimP, object], *args: TrimP.args, **keys: TrimP.kwargs) -> bool:
    """Return True if a tooth is trimmed."""
    try:
        trimming(*args, **keys)
    except TrimError:
        return False
    return True
