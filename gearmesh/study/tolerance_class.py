"""Flanks and teeth within a tolerance class, as spreads of keys of micro-geometry and pitch [ISO 1328-1:2013, ISO
17485].

Spreads cover the flank in contact of each member: profile slope, helix slope, and form deviations as crownings, because
only the crowned part of a form deviation changes contact. Each is normal about the value of the design. Its tolerance
is three standard deviations, and the distribution is cut off there.

    key                   tolerance   deviation of a flank that has only this key at its tolerance
    profile_slope         f_HaT       exactly the tolerance, from form to form circle, read between control and tip diameter
    profile_crowning      f_faT       a parabola over the flank; its evaluated part deviates from its mean line
    helix_slope           f_HbT       exactly the tolerance, over the face
    helix_crowning        f_fbT       as for the profile

Pitch deviations are drawn by a number, `pitch_seed` of the table `measured`, within f_pT and F_pT
(`metrology/drawn_pitch.py`). Flanks of bevel gears have no tolerances, so that only their pitch deviates.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gearmesh.design.core import Design
from gearmesh.design.measured import MAX_SEED, MeasuredMember
from gearmesh.errors import ArgumentError
from gearmesh.metrology.measured_teeth import InspectionBasis, InvoluteFlank
from gearmesh.numerals import parse_whole_number
from gearmesh.study.rows.work import own_keys
from gearmesh.study.spreads import WHOLE_NUMBERS, Spread
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.region import Side

#: name that stands for the tolerances of a class among keys
CLASS_KEY = "class"
#: standard deviations in a tolerance
SIGMAS_PER_TOLERANCE = 3.0
#: micrometres per millimetre
UM_PER_MM = 1e3


def class_spreads(design: Design, pair: int | str, text: Any) -> dict[str, Spread]:
    """Return spreads of keys of both members of a pair, for flanks and teeth within a tolerance class.

    They are in the design's units. Teeth whose positions the design sets are not varied. Raises ArgumentError for an
    unknown class, and for gears that have no tolerances.
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
            mean, largest = _value(own_keys(design), f"{table}.{key}"), limit / design.mm_per_unit
            spreads[f"{table}.{key}"] = Spread(
                "truncated", (mean, largest / SIGMAS_PER_TOLERANCE, mean - largest, mean + largest)
            )
        if member.index.uneven:
            continue
        positions = MeasuredMember(name)
        if number != basis.asked:
            spreads[f"measured.{positions.drawn_class}"] = Spread(WHOLE_NUMBERS, (number, number + 1))
        spreads[f"measured.{positions.drawn_seed}"] = Spread(WHOLE_NUMBERS, (0, MAX_SEED + 1))
    return spreads


def _basis(design: Design, train: GearTrain, member: Member) -> InspectionBasis:
    """Return the data by which a member is inspected."""
    inspection = systems.system_of(design).inspection
    if inspection is None:
        raise ArgumentError(
            "tolerance",
            entry=CLASS_KEY,
            reason=f"flanks of {design.kind} gears have no tolerances",
            allowed="cylindrical and bevel gears",
        )
    return inspection(design, train, member.name)


def _class(basis: InspectionBasis, text: Any) -> int:
    """Return the class that a text names."""
    finest, coarsest = basis.sizes.classes
    number = parse_whole_number(str(text))
    if number is None or not finest <= number <= coarsest:
        must_be = f"a whole number from {finest} to {coarsest}"
        raise ArgumentError("tolerance", str(text).strip(), entry=CLASS_KEY, must_be=must_be)
    return number


def _limits(member: Member, side: Side, basis: InspectionBasis, number: int) -> dict[str, float]:
    """Return the largest amounts (mm) of the keys of a flank of a class; none if the flank is no involute."""
    um = basis.sizes.tolerances(number)
    if um is None:
        raise ArgumentError(
            "tolerance", entry=CLASS_KEY, reason=f"the {member.name} is beyond the range of {basis.sizes.standard}"
        )
    involute = basis.involute_of(side)
    if involute is None:
        return {}
    profile, helix = involute.profile, involute.helix_trace
    flank_length = _flank_length(member, side, involute)
    evaluated_length, face = (abs(trace.slope[1] - trace.slope[0]) for trace in (profile, helix))
    return {
        "profile_slope": um["f_HaT"] / UM_PER_MM * flank_length / evaluated_length,
        "profile_crowning": um["f_faT"] / UM_PER_MM * (flank_length / profile.length) ** 2,
        "helix_slope": um["f_HbT"] / UM_PER_MM,
        "helix_crowning": um["f_fbT"] / UM_PER_MM * (face / helix.length) ** 2,
    }


def _flank_length(member: Member, side: Side, involute: InvoluteFlank) -> float:
    """Return the roll length (mm) of a flank from form to form circle, in the middle of the face."""
    points = member.tooth.flank_grid(side, [0.0, 1.0], [0.5]).points[:, 0]
    return float(np.ptp(involute.roll_length(np.hypot(points[:, 0], points[:, 1]))))


def _value(keys: Mapping[str, Any], dotted: str) -> float:
    """Return the value of a length key that a design sets, in its units; 0 if it does not set the key."""
    below: Any = keys
    for name in dotted.split("."):
        below = below.get(name) if isinstance(below, Mapping) else None
    return float(below) if isinstance(below, int | float) else 0.0
