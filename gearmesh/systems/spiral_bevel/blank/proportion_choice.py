"""Choice of addendum and depth where a design leaves them open: as ISO 23509 suggests, or so that the teeth can be cut.

The suggestions of the standard suit 12 and more pinion teeth at usual angles. If teeth would be undercut, the pinion
gets more addendum and the gear less. If that is not enough, because the gear is then undercut or the tips of the pinion
become too thin, both members get shallower teeth [LF04 6.7; AGMA 2005]. A generating rack cuts a virtual gear of z_v
teeth whole to the depth z_v sin^2(alpha) / 2, in modules. This depth is the start of the search; the undercut of the
teeth themselves decides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.iso23509.tooth_factors import suggested_addendum_factor, suggested_depth_factor
from gearmesh.systems.common.bevel.pair_blank import proportions
from gearmesh.systems.spiral_bevel.design import BLADE_KEYS, Machine

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank, Proportions
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: keys of the design whose values are chosen
FACTOR_KEYS = ("depth_factor", "addendum_factor")
#: depths that are tried, over the suggested depth
DEPTH_SHARES = (1.0, 0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.65, 0.6, 0.55)
#: step by which the gear's addendum factor falls from try to try
ADDENDUM_FACTOR_STEP = 0.05
#: least addendum factor of the gear that is tried
MIN_ADDENDUM_FACTOR = 0.1
#: least step, over the suggested depth, from a depth whose teeth are refused to the next try
REFUSED_DEPTH_STEP = 0.09


@dataclass(frozen=True)
class ToothFaults:
    """Faults of the teeth of a pair."""

    #: undercut of (pinion, gear), mm
    undercut: tuple[float, float] = (0.0, 0.0)
    #: True where the land on the pinion's tips is too thin for more addendum
    thin: bool = False
    #: True where the teeth cannot be closed for other reasons
    refused: bool = False

    @property
    def cut_whole(self) -> bool:
        """True where the teeth exist and are not undercut."""
        return not (any(self.undercut) or self.refused)


def open_factors(design: FaceMilledDesign) -> frozenset[str]:
    """Return the keys of FACTOR_KEYS that are free to be chosen.

    No key is free in a design that sets the root angles or machine settings of its teeth.
    """
    machine = [key for key in Machine.model_fields if key not in BLADE_KEYS]
    set_by_cut = {f"{member}.root_angle" for member in ("pinion", "gear")}
    set_by_cut |= {
        f"{cutter}.{key}" for cutter in ("pinion.concave", "pinion.convex", "gear.cutter") for key in machine
    }
    given = {key for key, _ in design.own()}
    formed = any(design.ease_off(name) is not None for name in ("concave", "convex"))
    return frozenset() if design.completing or formed or given & set_by_cut else frozenset({*FACTOR_KEYS} - given)


def chosen_proportions(
    design: FaceMilledDesign, blank: BevelBlank, first: ToothFaults, faults_of: Callable[[Proportions], ToothFaults]
) -> Proportions:
    """Return proportions whose teeth have no faults, else those with the least undercut, else the design's.

    - `design`: the design, lengths in mm
    - `blank`: its blank with the given or suggested proportions
    - `first`: the faults of that blank's teeth
    - `faults_of`: returns the faults of teeth with other proportions
    """
    given, free = proportions(design), open_factors(design)
    best, least = given, np.inf if first.refused else sum(first.undercut)
    if first.cut_whole:
        return given
    depth, share = factors(given, blank)
    gap, refused_at = blank.clearance / blank.mean_working_depth, np.inf
    # depths to which a generating cutter cuts each member whole; a Formate gear is not generated, so it has none
    whole = [_whole(member, blank) for member in blank.members]
    if design.formate:
        whole[1] = np.inf
    # from the deepest teeth to shallower ones, at each depth from the pinion's least addendum to larger ones
    for part in DEPTH_SHARES if "depth_factor" in free else DEPTH_SHARES[:1]:
        # teeth refused for their roots or tips are refused at nearly the same depth, too
        if part > refused_at - REFUSED_DEPTH_STEP:
            continue
        # gear addendum from which the pinion's dedendum is cut whole, at most the suggested one
        gear_factor = min(share, whole[0] / (part * depth) - gap) if "addendum_factor" in free else share
        while gear_factor >= min(share, MIN_ADDENDUM_FACTOR) and (1.0 + gap - gear_factor) * part * depth <= whole[1]:
            asked, faults = replace(given, depth_factor=part * depth, addendum_factor=gear_factor), first
            if part < 1.0 or gear_factor < share:
                faults = faults_of(asked)
                if faults.cut_whole and not faults.thin:
                    return asked
                if not (faults.refused or faults.thin) and sum(faults.undercut) < least:
                    best, least = asked, sum(faults.undercut)
            if faults.refused:
                refused_at = part
            if faults.refused or faults.thin or faults.undercut[1] or "addendum_factor" not in free:
                break
            gear_factor -= ADDENDUM_FACTOR_STEP
    return best


def factors(given: Proportions, blank: BevelBlank) -> tuple[float, float]:
    """Return depth and addendum factor of given proportions; where they are None, the suggestion for their `blank`."""
    teeth, angles = (blank.pinion.teeth, blank.gear.teeth), (blank.pinion.pitch_angle, blank.gear.pitch_angle)
    return (
        suggested_depth_factor(teeth) if given.depth_factor is None else given.depth_factor,
        suggested_addendum_factor(teeth, angles) if given.addendum_factor is None else given.addendum_factor,
    )


def _whole(member: MemberBlank, blank: BevelBlank) -> float:
    """Return the approximate depth (mean normal modules) to which rounded blades cut a member whole at the toe."""
    sine = np.sin(blank.pressure_angle)
    virtual = member.teeth / np.cos(member.pitch_angle) / np.cos(member.end_spiral_angles[1]) ** 3
    return float(0.5 * virtual * sine**2 + blank.edge_radius / blank.mean_normal_module * (1.0 - sine))
