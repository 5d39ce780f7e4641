"""Addendum and depth of the teeth where a design leaves them open: as ISO 23509 suggests, or so that the teeth can be cut.

What the standard suggests suits 12 pinion teeth and more at usual angles. Where teeth would be undercut the pinion gets more
addendum and the gear less, and where that is not enough, because the gear is undercut then or the pinion's tips grow too thin,
both get shallower teeth [LF04 6.7; AGMA 2005]. A generating rack cuts a virtual gear of z_v teeth whole to the depth
z_v sin^2(alpha) / 2, in modules; that says where to begin, the undercut of the teeth themselves decides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.spiral_bevel.design import BLADE_KEYS, Machine
from gearmesh.systems.spiral_bevel.iso23509.tooth_factors import suggested_addendum_factor, suggested_depth_factor
from gearmesh.systems.spiral_bevel.synthesis.settings import proportions

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank, MemberBlank, Proportions
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: the keys
FACTORS = ("depth_factor", "addendum_factor")
#: parts of the suggested depth that are tried; by how much the gear's addendum falls from try to try, and to what, at least
DEPTHS, STEP, LEAST = (1.0, 0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.65, 0.6, 0.55), 0.05, 0.1
#: by how much less, as parts of the suggested depth, is tried next where teeth are refused
FAR = 0.09


@dataclass(frozen=True)
class ToothFaults:
    """What is wrong with teeth: `undercut` of (pinion, gear), mm; whether the land on the pinion's tips is too `thin` for more
    addendum; `refused`: teeth that cannot be closed, for other reasons."""

    undercut: tuple[float, float] = (0.0, 0.0)
    thin: bool = False
    refused: bool = False

    @property
    def cut_whole(self) -> bool:
        """Whether the teeth exist and nothing cuts them off."""
        return not (any(self.undercut) or self.refused)


def open_factors(design: FaceMilledDesign) -> frozenset[str]:
    """Those of addendum_factor and depth_factor that are free to be chosen: none of a design that says how deep or with which
    machine settings its teeth are cut."""
    machine = [key for key in Machine.model_fields if key not in BLADE_KEYS]
    said = {f"{member}.root_angle" for member in ("pinion", "gear")}
    said |= {f"{cutter}.{key}" for cutter in ("pinion.concave", "pinion.convex", "gear.cutter") for key in machine}
    own = {key for key, _ in design.own()}
    formed = any(design.ease_off(name) is not None for name in ("concave", "convex"))
    return frozenset() if design.completing or formed or own & said else frozenset({*FACTORS} - own)


def chosen_proportions(
    design: FaceMilledDesign, blank: BevelBlank, first: ToothFaults, faults_of: Callable[[Proportions], ToothFaults]
) -> Proportions:
    """The proportions of a design in mm, whose `blank` and faults with those that it gives are `first`.

    The first of which `faults_of` finds none, or those of which the least is undercut, or those that it gives.
    """
    given, free = proportions(design), open_factors(design)
    best, least = given, np.inf if first.refused else sum(first.undercut)
    if first.cut_whole:
        return given
    depth, share = factors(given, blank)
    gap, refused_at = blank.clearance / blank.mean_working_depth, np.inf
    whole = [_whole(own, blank) for own in blank.members]
    if design.formate:
        whole[1] = np.inf
    for part in DEPTHS if "depth_factor" in free else DEPTHS[:1]:
        # what is refused for its roots or tips is refused at nearly the same depth
        if part > refused_at - FAR:
            continue
        own = min(share, whole[0] / (part * depth) - gap) if "addendum_factor" in free else share
        while own >= min(share, LEAST) and (1.0 + gap - own) * part * depth <= whole[1]:
            asked, faults = replace(given, depth_factor=part * depth, addendum_factor=own), first
            if part < 1.0 or own < share:
                faults = faults_of(asked)
                if faults.cut_whole and not faults.thin:
                    return asked
                if not (faults.refused or faults.thin) and sum(faults.undercut) < least:
                    best, least = asked, sum(faults.undercut)
            if faults.refused:
                refused_at = part
            if faults.refused or faults.thin or faults.undercut[1] or "addendum_factor" not in free:
                break
            own -= STEP
    return best


def factors(given: Proportions, blank: BevelBlank) -> tuple[float, float]:
    """FACTORS of given proportions, or what is suggested for their `blank`."""
    teeth, angles = (blank.pinion.teeth, blank.gear.teeth), (blank.pinion.pitch_angle, blank.gear.pitch_angle)
    return (
        suggested_depth_factor(teeth) if given.depth_factor is None else given.depth_factor,
        suggested_addendum_factor(teeth, angles) if given.addendum_factor is None else given.addendum_factor,
    )


def _whole(own: MemberBlank, blank: BevelBlank) -> float:
    """About the depth (mean normal modules) to which a member is cut whole: at the toe, with the blades' rounding."""
    sine = np.sin(blank.pressure_angle)
    virtual = own.teeth / np.cos(own.pitch_angle) / np.cos(own.end_spiral_angles[1]) ** 3
    return float(0.5 * virtual * sine**2 + blank.edge_radius / blank.mean_normal_module * (1.0 - sine))
