"""How a pair is cut: both sides of both members for the contact that is asked of them, and how they stand in their teeth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array, dot, polar_angle
from gearmesh.kernel.levels import ConeLevel
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.spiral_bevel.pair import HANDS, MATES, SIDES, Angles, CutSides, Sides, nominal_base, thinning
from gearmesh.systems.spiral_bevel.settings import ContactChoice, gear_sides, mean_point, pinion_side
from gearmesh.teeth.region import Side

#: distance (mm) from the mean point that counts as none
REACHED = 1e-10
#: rotation (rad) that a tooth may be too thick for rounding
ROOM = 1e-12

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.generated import Generated

#: what is asked of the contact, by the pinion's sides
Choices = dict[str, ContactChoice]


def cut_sides(design: FaceMilledDesign, blank: BevelBlank, choices: Choices) -> CutSides:
    """Both sides of both members of a design (in mm), for the contact that `choices` ask for.

    Raises NoSolutionError where no pinion gives it, DesignError for cutters that cannot exist.
    """
    nominal, gear = nominal_base(blank, HANDS[design.hand]), gear_sides(design, blank)
    means = {name: mean_point(design, blank, gear[MATES[name]], nominal, choices[name]) for name in SIDES}
    pinion = {name: pinion_side(design, blank, name, means[name]) for name in SIDES}
    # a pinion flank stands as it was cut when the gear is turned to its mean contact: turned back, it fits the gear's space
    ratio = blank.gear.teeth / blank.pinion.teeth
    fitting, to_mean = {name: means[name].gear_turn * ratio for name in SIDES}, dict.fromkeys(SIDES, 0.0)
    if design.completing:
        # settings that serve both sides at once leave no side where its mean contact is
        to_mean = {name: _turn_to(pinion[name], means[name].contact.point, blank) for name in SIDES}
        fitting = {name: angle + to_mean[name] for name, angle in fitting.items()}
        pinion_places = _cut_at_once(design, blank, pinion, fitting)
    else:
        away = thinning(design, blank)
        pinion_places = {
            name: fitting[name] + (-away if side.flank is Side.LEFT else away) for name, side in pinion.items()
        }
    turns = {name: mean.gear_turn for name, mean in means.items()}
    return CutSides(blank, pinion, gear, (pinion_places, _beside_space(gear, blank.gear.teeth)), (to_mean, turns))


def _beside_space(sides: Sides, teeth: int) -> Angles:
    """Places (rad) of sides that are cut at once: the space is at the x axis, the tooth between two of them half a pitch beside."""
    half_pitch = np.pi / teeth
    return {name: half_pitch if side.flank is Side.LEFT else -half_pitch for name, side in sides.items()}


def _turn_to(side: Generated, point: Array, blank: BevelBlank) -> float:
    """Rotation (rad) about its axis that brings a flank of the pinion, as cut, to a point (3,) of the pinion's own frame.

    Raises NoSolutionError where the flank has no point so high at this cone distance.
    """
    levels = (blank.pinion.stations, ConeLevel(blank.pinion.pitch_angle - 0.5 * np.pi))
    wanted = np.array([float(level.value(point)) for level in levels])
    flank = side.side(0.0).flank

    def apart(x: Array, _: NDArray[np.intp]) -> tuple[Array, Array]:
        jet = flank.jet(x[:, 0], x[:, 1])
        values = np.stack([level.value(jet.r) for level in levels], axis=-1)
        rows = [[dot(level.gradient(jet.r), d) for d in (jet.r_u, jet.r_v)] for level in levels]
        return values - wanted, np.moveaxis(np.array(rows), -1, 0)

    start = np.array([side.blade.at_height(0.5 * blank.mean_depth), 0.0])
    found = newton.solve(apart, start[None, :], tolerance=REACHED)
    if not found.converged[0]:
        raise NoSolutionError("pinion: its cutter does not generate the mean point: check its settings")
    r = flank.jet(found.values[:, 0], found.values[:, 1]).r
    turn = float(polar_angle(point) - polar_angle(r)[0])
    return (turn + np.pi) % (2.0 * np.pi) - np.pi


def _cut_at_once(design: FaceMilledDesign, blank: BevelBlank, sides: Sides, fitting: Angles) -> Angles:
    """Places (rad) of both sides of the pinion in the middle of where each would fit the gear's space: what is left is backlash.

    Raises DesignError where the tooth is too thick for it.
    """
    places = _beside_space(sides, blank.pinion.teeth)
    (left,), (right,) = (
        [name for name, side in sides.items() if side.flank is which] for which in (Side.LEFT, Side.RIGHT)
    )
    room = (fitting[left] - places[left]) - (fitting[right] - places[right])
    if not room >= -ROOM:
        # the rotation that half a normal backlash of 1 mm takes
        lacking = -0.5 * room / thinning(design.with_values({"backlash": 1.0}), blank)
        width = sides["concave"].blade.tip_radius - sides["convex"].blade.tip_radius
        least = at_least(width + lacking / float(np.cos(blank.pressure_angle)))
        raise DesignError(
            f"pinion.concave.tip_radius = {sides['concave'].blade.tip_radius:g} mm: {width:.6g} mm more than pinion.convex."
            f"tip_radius leaves a tooth {lacking:.4g} mm too thick for the gear's space; allowed is {least} mm more, or about that"
        )
    middle = 0.5 * (fitting[left] - places[left] + fitting[right] - places[right])
    return {name: place + middle for name, place in places.items()}
