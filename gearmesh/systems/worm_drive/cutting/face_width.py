"""Face width and addendum of a wheel whose design leaves them open: those of DIN 3975, or less where the flanks of a steep thread
end sooner, or teeth are pointed.

Towards one end of the face the hob's flank turns away from the wheel until it does not generate any more. How far that is depends
on all of the hob, and is asked of the teeth themselves.
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
    wheel_tooth,
    worm_member,
)
from gearmesh.systems.worm_drive.cutting.root import open_root
from gearmesh.systems.worm_drive.design import ADDENDUM
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign

P = ParamSpec("P")

#: parts of the usual width that are tried, half of it at least, and lesser ones where no tooth is sound on half, with parts of the
#: usual addendum
SHARES = np.linspace(0.5, 1.0, 5)
NARROW_SHARES, NARROW_ADDENDA = (0.5, 0.4, 0.3, 0.2), (1.0, 0.75, 0.5)
#: stations of close looks, and the middle plane
CLOSE, MIDDLE = 1025, np.array([0.5])
#: lead angle (rad) up to which the usual width is taken unseen: of 200 random drives the gentlest that it did not suit has 14 deg
GENTLE = math.radians(10.0)


def derived_values(design: WormDriveDesign) -> dict[str, float]:
    """Face width and addendum of the wheel, and the dedendum of the worm with the rounding there, by their dotted keys, in the
    design's units.

    They are the usual ones where the teeth are sound, or where nothing helps; a narrower face is taken before a lower tip, but for
    one less than half as wide as usual.
    """
    root = open_root(design.in_mm())
    design = design.fill(root)
    wheel, usual = design.wheel, design.usual_face_width
    open_width, open_tip = math.isnan(wheel.face_width), math.isnan(wheel.addendum)
    # where it is not the width that is wrong it stays
    sought = wheel.form != "helical" and (open_tip or (open_width and design.lead_angle > GENTLE))
    for addendum, narrow in _tries(open_width, open_tip) if sought else ():
        own = design.fill({"wheel.addendum": round(usual_addendum(design) * addendum, 6)})
        if _refused_by_tools(own, usual):
            break
        shares = _narrow_shares(own, usual) if narrow else _sound_shares(own, given_or(wheel.face_width, usual))
        if (share := next(shares, None)) is not None:
            return {**root, "wheel.addendum": own.wheel.addendum, "wheel.face_width": share * usual}
        if addendum == 1.0 and not narrow and not (_has_spaces(own, usual) and _has_worm(design)):
            break
    return {**root, "wheel.addendum": usual_addendum(design), "wheel.face_width": usual}


def _tries(open_width: bool, open_tip: bool) -> Iterator[tuple[float, bool]]:
    """Parts of the usual addendum in the order in which they are tried, and whether with faces less than half as wide as usual."""
    yield from ((share, False) for share in (ADDENDUM_SHARES.tolist() if open_tip else [1.0]))
    if open_width:
        yield from ((share, True) for share in (NARROW_ADDENDA if open_tip else NARROW_ADDENDA[:1]))


def _refused_by_tools(design: WormDriveDesign, usual: float) -> bool:
    """Whether a hob is none, which is refused by its own keys."""
    try:
        refuse_tools(design.fill({"wheel.face_width": usual}).in_mm())
    except DesignError:
        return True
    return False


def _has_spaces(design: WormDriveDesign, usual: float) -> bool:
    """Whether the hob's tips leave spaces in the middle plane: where fillets overlap there, no addendum or width parts them."""
    try:
        tooth = wheel_tooth(_in_mm(design, usual))
    except DesignError:
        # of other widths there may be one
        return True
    return _succeeds(tooth.prove_root, MIDDLE)


def _has_worm(design: WormDriveDesign) -> bool:
    """Whether a worm can be built; where none can, that is refused by its own keys, whatever the wheel."""
    try:
        worm_member(design.in_mm())
    except (DesignError, NoSolutionError):
        return False
    return True


def _sound_shares(design: WormDriveDesign, usual: float) -> Iterator[float]:
    """Parts of the usual width over which the flanks are whole, the largest first; 1 alone where the width is given, or the thread
    is gentle."""
    prove = _prove_closely if design.wheel.addendum < ADDENDUM else prove_wheel_of
    try:
        tooth = wheel_tooth(wide := _in_mm(design, usual))
    except DesignError:
        return
    # fillets that overlap in the middle plane do over any width
    if not _succeeds(tooth.prove_root, MIDDLE):
        return
    if _succeeds(prove, wide):
        yield 1.0
    if math.isfinite(design.wheel.face_width) or design.lead_angle <= GENTLE:
        return
    # the other side is the mirror image, or next to it
    ends = {share: 0.5 + 0.5 * np.array([-share, share]) for share in SHARES[:-1].tolist()}
    whole = list(takewhile(lambda share: _succeeds(tooth.ends, Side.RIGHT, ends[share]), ends))
    yield from (share for share in whole[::-1] if _succeeds(prove, _in_mm(design, share * usual)))


def _narrow_shares(design: WormDriveDesign, usual: float) -> Iterator[float]:
    """Lesser parts of the usual width over which the teeth are sound, the largest first, each looked at for itself: where teeth are
    not sound over half the width, the wide one is no guide."""
    for share in NARROW_SHARES:
        own = _in_mm(design, share * usual)
        try:
            wheel_tooth(own)
        except DesignError:
            continue
        if _succeeds(_prove_closely, own):
            yield share


def _prove_closely(design: WormDriveDesign) -> None:
    """Trim the wheel's tooth of a design in mm at many stations: those of the proof may miss where it just does not reach. Raises
    TrimError."""
    prove_wheel_of(design)
    wheel_tooth(design).sections(np.linspace(0.0, 1.0, CLOSE))


def _in_mm(design: WormDriveDesign, width: float) -> WormDriveDesign:
    """The design in mm with a face width of the wheel in its own units."""
    return design.fill({"wheel.face_width": width}).in_mm()


def _succeeds(trimming: Callable[P, object], *args: P.args, **keys: P.kwargs) -> bool:
    """Whether a tooth is trimmed."""
    try:
        trimming(*args, **keys)
    except TrimError:
        return False
    return True
