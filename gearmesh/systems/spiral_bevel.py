"""Spiral, zerol and straight bevel gears cut by head cutters [AB; CR3553; ISO 23509].

Fixed frame: the pinion's own at its nominal place. phi1 grows in the sense in which the pinion's concave side drives;
phi1 = 0 and, but for what given settings miss, phi2 = 0 is contact at the mean point of the side asked for.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gearmesh.assembly import Assembly, Mount
from gearmesh.frames import Rigid, rotation_about
from gearmesh.pair import GearPair
from gearmesh.systems.bevel_generated import bevel_member
from gearmesh.systems.bevel_settings import HANDS, MATES, SIDES, basic_blank, gear_sides, mean_point, pinion_side


def build(design: Any) -> GearPair:
    """The pair of a spiral bevel design (in mm).

    Raises DesignError for blanks and teeth that cannot exist, NoSolutionError where no pinion gives the contact asked for.
    """
    blank = basic_blank(design)
    nominal = gear_base(blank.shaft_angle)
    gear = gear_sides(design, blank)
    means = {name: mean_point(design, blank, name, gear[MATES[name]], nominal) for name in SIDES}
    pinion = {name: pinion_side(design, blank, name, means[name]) for name in SIDES}
    # each flank of the pinion gives way by half the normal backlash, at the mean pitch circle
    across = np.cos(blank.pressure_angle) * np.cos(blank.spiral_angle)
    thinning = 0.5 * design.backlash / (across * blank.mean_cone_distance * np.sin(blank.pinion.pitch_angle))
    ratio = blank.gear.teeth / blank.pinion.teeth
    # a pinion flank stands as it was cut when the gear is turned to its mean contact: turned back, it fits the gear's space
    pinion_places = {
        side.flank_name: means[name].gear_turn * ratio + (-thinning if side.flank_name == "left" else thinning)
        for name, side in pinion.items()
    }
    # the cutter's space is at the x axis, the tooth between two of them half a pitch beside
    half_pitch = np.pi / blank.gear.teeth
    gear_places = {side.flank_name: half_pitch if side.flank_name == "left" else -half_pitch for side in gear.values()}
    members = {
        "pinion": bevel_member("pinion", design.pinion, blank, pinion, pinion_places),
        "gear": bevel_member("gear", design.gear, blank, gear, gear_places),
    }
    name = design.contact.side.removeprefix("pinion_")
    flanks = (pinion[name].flank_name, gear[MATES[name]].flank_name)
    return GearPair(
        kind=design.kind,
        pinion=members["pinion"],
        gear=members["gear"],
        assembly=_assemble(design, nominal, pinion_places[flanks[0]], means[name].gear_turn - gear_places[flanks[1]]),
        flanks=flanks,
        drive=SIDES[name],
        delta=design.contact.delta,
        warnings=blank.warnings,
    )


def gear_base(shaft_angle: float) -> Rigid:
    """The gear's own frame to the pinion's: apexes together, the gear's x axis towards the pitch line."""
    axis = np.array([np.sin(shaft_angle), 0.0, np.cos(shaft_angle)])
    # in the axial plane, a right angle before the gear's axis
    x = np.array([-np.cos(shaft_angle), 0.0, np.sin(shaft_angle)])
    return Rigid(np.stack((x, np.array([0.0, -1.0, 0.0]), axis), axis=-1), np.zeros(3))


def _assemble(design: Any, nominal: Rigid, pinion_turn: float, gear_turn: float) -> Assembly:
    """Mounts with the assembly errors; `pinion_turn`, `gear_turn` (rad) bring the flanks to their mean contact."""
    errors, sense = design.assembly, float(HANDS[design.hand])
    opened = Rigid(rotation_about("y", np.radians(errors.d_delta)), np.zeros(3))
    along = Rigid(np.eye(3), np.array([0.0, 0.0, errors.dG]))
    pinion_base = Rigid(np.eye(3), np.array([0.0, errors.dV, errors.dA]))
    return Assembly(
        Mount(
            pinion_base,
            sense,
            zero=sense * pinion_turn,
            eccentricity=_vector(errors.pinion_eccentricity, errors.pinion_phase),
        ),
        Mount(
            opened @ nominal @ along,
            -sense,
            zero=sense * gear_turn,
            eccentricity=_vector(errors.gear_eccentricity, errors.gear_phase),
        ),
        design.pinion.teeth,
        design.gear.teeth,
    )


def _vector(length: float, degrees: float) -> tuple[float, float]:
    return float(length * np.cos(np.radians(degrees))), float(length * np.sin(np.radians(degrees)))
