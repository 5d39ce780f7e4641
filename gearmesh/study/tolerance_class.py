"""Flanks and teeth within a tolerance class, as spreads of the keys of their micro-geometry and pitch [ISO 1328-1:2013, ISO 17485].

Of each member in contact, on the flank that is in contact: profile and helix slope, and form deviations as crownings, which are
what of them changes contact. Each is normal about what the design has, its tolerance three standard deviations, and cut off there.

    key                   tolerance   a flank that has it alone has exactly this deviation
    profile_slope         f_HaT       over the flank from form to form circle, read between control and tip diameter
    profile_crowning      f_faT       a parabola over the flank, of which its evaluated part departs from its mean line
    helix_slope           f_HbT       over the face
    helix_crowning        f_fbT       as of the profile

Pitch deviations are drawn by a number, `pitch_seed` of the table `measured`, within f_pT and F_pT (`metrology/drawn_pitch.py`); of
bevel gears, whose flanks have no tolerances, these alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gearmesh.design.core import Design
from gearmesh.design.measured import MAX_SEED
from gearmesh.errors import ArgumentError
from gearmesh.metrology.measured_teeth import InspectionBasis, InvoluteFlank
from gearmesh.numerals import parse_whole_number
from gearmesh.study.rows.work import own_keys
from gearmesh.study.spreads import WHOLE, Spread
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.region import Side

#: what stands for the tolerances of a class among keys, and standard deviations in a tolerance
CLASS, SIGMAS = "class", 3.0
#: um of a mm
UM = 1e3


def class_spreads(design: Design, pair: int | str, text: Any) -> dict[str, Spread]:
    """Spreads, in the design's units, of the keys of both members of a pair, for flanks and teeth within the class that a text
    names; teeth whose places the design gives stay there.

    Raises DesignError for another class, and for gears that have no tolerances.
    """
    train = systems.build(design)
    mesh = train.pair(pair)
    spreads: dict[str, Spread] = {}
    for member, side in zip(mesh.both, mesh.flanks, strict=True):
        name = Design.table_named(member.name)
        basis = _basis(design, train, member)
        number = _class(basis, text)
        table = f"{name}.modifications_{side}"
        for key, limit in _limits(member, side, basis, number).items():
            mean, most = _value(own_keys(design), f"{table}.{key}"), limit / design.mm_per_unit
            spreads[f"{table}.{key}"] = Spread("truncated", (mean, most / SIGMAS, mean - most, mean + most))
        if member.index.uneven:
            continue
        if number != basis.asked:
            spreads[f"measured.{name}_pitch_class"] = Spread(WHOLE, (number, number + 1))
        spreads[f"measured.{name}_pitch_seed"] = Spread(WHOLE, (0, MAX_SEED + 1))
    return spreads


def _basis(design: Design, train: GearTrain, member: Member) -> InspectionBasis:
    """What a member is inspected by."""
    inspection = systems.system_of(design).inspection
    if inspection is None:
        raise ArgumentError(
            "tolerance",
            entry=CLASS,
            reason=f"flanks of {design.kind} gears have no tolerances",
            allowed="cylindrical and bevel gears",
        )
    return inspection(design, train, member.name)


def _class(basis: InspectionBasis, text: Any) -> int:
    """The class that a text names."""
    finest, coarsest = basis.sizes.classes
    number = parse_whole_number(str(text))
    if number is None or not finest <= number <= coarsest:
        must_be = f"a whole number from {finest} to {coarsest}"
        raise ArgumentError("tolerance", str(text).strip(), entry=CLASS, must_be=must_be)
    return number


def _limits(member: Member, side: Side, basis: InspectionBasis, number: int) -> dict[str, float]:
    """Largest amounts (mm) of the keys of a flank of a class; none of flanks that are no involutes."""
    um = basis.sizes.tolerances(number)
    if um is None:
        raise ArgumentError(
            "tolerance", entry=CLASS, reason=f"the {member.name} is beyond the range of {basis.sizes.standard}"
        )
    if basis.involute is None:
        return {}
    profile, helix = basis.involute.profile, basis.involute.helix_trace
    flank = _flank_length(member, side, basis.involute)
    read, face = (abs(own.slope[1] - own.slope[0]) for own in (profile, helix))
    return {
        "profile_slope": um["f_HaT"] / UM * flank / read,
        "profile_crowning": um["f_faT"] / UM * (flank / profile.length) ** 2,
        "helix_slope": um["f_HbT"] / UM,
        "helix_crowning": um["f_fbT"] / UM * (face / helix.length) ** 2,
    }


def _flank_length(member: Member, side: Side, involute: InvoluteFlank) -> float:
    """Roll length (mm) of a flank from form to form circle, in the middle of the face."""
    points = member.tooth.flank_grid(side, [0.0, 1.0], [0.5]).points[:, 0]
    return float(np.ptp(involute.roll_length(np.hypot(points[:, 0], points[:, 1]))))


def _value(keys: Mapping[str, Any], dotted: str) -> float:
    """The value of a length key that a design sets, in its units; 0 where it does not."""
    below: Any = keys
    for name in dotted.split("."):
        below = below.get(name) if isinstance(below, Mapping) else None
    return float(below) if isinstance(below, int | float) else 0.0
