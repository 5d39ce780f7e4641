"""Machine settings of a spiral bevel pair: given by the design, or else by standard rules and local synthesis.

The gear's spread-blade cutter follows from the blank [AB 4-7]. The pinion's sides follow from the requested contact at
the mean point of the gear [AB 8-56], in the given assembly. An assembly with errors gives settings that compensate
them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.design.keys import given_or
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import ARCSEC, Z_AXIS, Array, cross, unit
from gearmesh.kernel.surface.curvature import principal, shape_operator, tangent_basis
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.systems.common.bevel.blank import BevelBlank, Proportions, basic_data
from gearmesh.systems.common.bevel.cone_blank import ConeData, OffsetData, cone_blank
from gearmesh.systems.common.bevel.pair_blank import pair_blank, proportions
from gearmesh.systems.spiral_bevel.design import (
    SYNTHESISED_KEYS,
    HypoidDesign,
    SpiralBevelDesign,
)
from gearmesh.systems.spiral_bevel.hobbing.head import check_head, head_radius, larger_radii
from gearmesh.systems.spiral_bevel.hobbing.head_synthesis import HeadStart, head_settings
from gearmesh.systems.spiral_bevel.hobbing.secondary_cut import second_pass
from gearmesh.systems.spiral_bevel.hobbing.sides import (
    hobbed_cones,
    hobbed_gear,
    hobbed_pinion,
    indexing,
    indexing_head,
)
from gearmesh.systems.spiral_bevel.machine.blades import blade_keys, made_blade, or_else, or_none, radians_or
from gearmesh.systems.spiral_bevel.machine.gear_cradle import machine_axes, root_normal, turned_after_cut
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.index import touching_turn
from gearmesh.systems.spiral_bevel.machine.machine import MachineSettings
from gearmesh.systems.spiral_bevel.machine.motions import given_roll, with_motions
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES, HAND_SIGNS, MATING_SIDES
from gearmesh.systems.spiral_bevel.machine.thickness import cut_to
from gearmesh.systems.spiral_bevel.synthesis.default_ellipse import default_semi_major_axis
from gearmesh.systems.spiral_bevel.synthesis.local_synthesis import (
    ContactAsked,
    MachinePlanes,
    MeanContact,
    ToolSettings,
    pinion_operator,
    tool_settings,
)
from gearmesh.tools.head_cutter import OUTSIDE_BLADE, Blade

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign, GearCutter, Machine, PinionSide

#: three equally spaced rotations (rad) that determine A cos + B sin + C
_THIRD_TURNS = np.array([0.0, 2.0, 4.0]) * np.pi / 3.0
#: least curvature (1/mm) of a blade that is not straight: arcs of 10 km lose digits
MIN_BLADE_CURVATURE = 1e-7
#: largest number of steps to the direction in which a cutter leans
MAX_LEAN_STEPS = 100
#: change (rad) of the direction of lean at which the iteration ends
LEAN_TOLERANCE_RAD = 1e-14


@dataclass(frozen=True)
class ContactChoice:
    """Requested contact of one side of the pinion."""

    #: requested contact at the mean point
    asked: ContactAsked
    #: distance of the mean point from the middle of the working depth, away from the gear's root, mm
    height: float = 0.0
    #: distance of the mean point beyond the mean cone distance, mm
    along: float = 0.0
    #: coefficients of modified roll from the third to the fifth order, added to those of the design
    roll: tuple[float, float, float] = (0.0, 0.0, 0.0)
    #: settings for an ease-off in place of local synthesis; of the rest only the mean point then counts
    form: FlankForm | None = None
    #: True where modified roll gives the derivative of the ratio, less that of the head
    by_roll: bool = False
    #: derivative of the ratio that the crowned head gives beside modified roll; 0 where it only parts flanks along the path
    head_derivative: float = 0.0

    def second_roll(self, ratio: float) -> float:
        """Return the coefficient of modified roll of the second order that gives the derivative of the ratio.

        `ratio`: ratio of roll, that of the teeth.
        """
        return 0.5 * (self.asked.ratio_derivative - self.head_derivative) / ratio if self.by_roll else 0.0


@dataclass(frozen=True)
class FlankForm:
    """Settings of one side of the pinion that were found for an ease-off.

    The grids (I, J) are over the active flank. `wanted` and `reached` are without the turn of the flank about the
    pinion's axis, which makes the ease-off `away` in the middle. With this turn the flank projects nowhere.
    """

    #: settings by key (mm, deg); NaN for a sliding base that follows from the others
    values: dict[str, float]
    #: coefficients of modified roll from the second order on, including those of the design
    roll: tuple[float, ...]
    #: coordinates (I, J) along the face, -1 to 1
    along: Array
    #: coordinates (I, J) up the tooth, -1 to 1
    up: Array
    #: requested ease-off (I, J), mm; NaN where the gear has no conjugate
    wanted: Array
    #: reached ease-off (I, J), mm
    reached: Array
    #: ease-off in the middle of the turned flank, mm
    away: float
    #: five parameters of the reached ease-off, by key
    parameters: dict[str, float]

    @property
    def residual(self) -> Array:
        """Residual topography (I, J), mm."""
        return self.reached - self.wanted

    @property
    def rest_max(self) -> float:
        """Largest absolute residual topography, mm."""
        return float(np.nanmax(np.abs(self.residual)))

    @property
    def most(self) -> float:
        """Largest absolute requested ease-off, mm."""
        return float(np.nanmax(np.abs(self.wanted)))


@dataclass(frozen=True)
class MeanPoint:
    """Mean point of one pair of sides."""

    #: parameters on the gear's flank, as cut
    parameters: tuple[float, float]
    #: rotation of the gear, as cut, about its axis at which the mean point is in contact, rad
    gear_turn: float
    #: geometry of the gear at the mean point
    contact: MeanContact
    #: requested contact
    choice: ContactChoice
    #: the gear's flank, and its position in contact in the pinion's frame
    mating: tuple[Surface, Rigid]


def basic_blank(design: FaceMilledDesign, given: Proportions | None = None) -> BevelBlank:
    """Return the blank of a design in mm, with `given` proportions or those of the design.

    Raises DesignError for a blank that cannot exist, and for a head that cannot cut it.
    """
    given = proportions(design) if given is None else given
    mean = design.mean_cone_distance if isinstance(design, SpiralBevelDesign) else None
    if isinstance(design, HypoidDesign):
        cones = ConeData.of_hypoid(offset_data(design))
    elif design.hobbed:
        cones = hobbed_cones(design, mean)
    else:
        data = basic_data(design, design.spiral_angle, design.pressure_angle, mean)
        return pair_blank(design, data, given, design.gear.cutter.tip_radius, design.gear_backlash)
    if not design.hobbed:
        return cone_blank(cones, given, design.gear_backlash)
    return _head_blank(design, cones, given)


def _head_blank(design: FaceMilledDesign, cones: ConeData, given: Proportions) -> BevelBlank:
    """Return the blank of a face-hobbed design, with a larger head than the usual one where that does not clear the gear.

    The head of a design with a radius, or with offset, stays. Raises as `basic_blank`.
    """
    check_head(cones)
    usual = cone_blank(cones, given, design.gear_backlash)
    if design.head.radius is not None or isinstance(design, HypoidDesign) or _clears(design, usual):
        return usual
    for radius in larger_radii(cones.cutter.radius, usual.gear.mean_cone_distance):
        wider = replace(cones, cutter=replace(cones.cutter, radius=radius))
        blank = cone_blank(wider, given, design.gear_backlash)
        if _clears(design, blank):
            check_head(wider)
            return blank
    return usual


def _clears(design: FaceMilledDesign, blank: BevelBlank) -> bool:
    """Return True if a head clears the gear beside the spaces that it cuts."""
    return not any(second_pass(side, blank.gear) for side in hobbed_gear(design, blank).values())


def offset_data(design: HypoidDesign) -> OffsetData:
    """Return the basic data of a hypoid design in mm. Raises DesignError, naming the key."""
    data = OffsetData(
        (design.pinion.teeth, design.gear.teeth),
        design.given_module,
        design.offset,
        spiral_angle=float(np.radians(design.spiral_angle)),
        shaft_angle=float(np.radians(design.shaft_angle)),
        pressure_angle=float(np.radians(design.pressure_angle)),
        taper=design.taper,
        limit_share=design.limit_share,
        given_face_width=design.face_width,
        given_cutter_radius=design.head.radius if design.hobbed else design.gear.cutter.tip_radius,
        blade_groups=design.head.blade_groups if design.hobbed else 0,
        method=design.blank_method,
    )
    if not design.hobbed or design.head.radius is not None:
        return data
    return replace(data, given_cutter_radius=head_radius(design, *data.rough_mean))


def gear_sides(design: FaceMilledDesign, blank: BevelBlank) -> dict[str, Generated]:
    """Return both sides of the gear by the spread-blade cutter [AB 4-7], or by the head of face hobbing.

    The gear rolls unless it is a Formate gear.

    Raises DesignError for blades that cannot exist.
    """
    if design.hobbed:
        return hobbed_gear(design, blank)
    spec, member = design.gear.cutter, blank.gear
    _check_gear_tilt(spec)
    dedendum_angle = member.dedendum_angle
    # the cradle axis passes through the pitch apex
    from_apex, radius = member.mean_cone_distance * np.cos(dedendum_angle), blank.cutter_radius
    x, y = from_apex - radius * np.sin(member.spiral_angle), radius * np.cos(member.spiral_angle)
    derived = {
        "radial": float(np.hypot(x, y)),
        "cradle_angle": float(np.degrees(np.arctan2(y, x))),
        "ratio_of_roll": 0.0 if design.formate else float(np.sin(member.pitch_angle) / np.cos(dedendum_angle)),
        "machining_offset": 0.0,
        "machine_centre_to_back": member.along_root(0.0),
    }
    values = {key: or_else(getattr(spec, key), value) for key, value in derived.items()}
    base = member.root_base(radians_or(spec.machine_root_angle, member.root_angle))
    values["sliding_base"] = given_or(spec.sliding_base, base)
    machine = _machine(spec, member.root_angle, values, design.formate)

    def cut_by(width: float) -> dict[str, Generated]:
        """Return the sides of a point width (mm)."""
        return {name: _gear_side(design, blank, machine, name, width) for name in BLADE_SIDES}

    if design.gear.thickness is not None:
        return cut_to(design.gear.thickness, member, blank.mean_normal_module, cut_by)
    return cut_by(or_else(spec.point_width, blank.point_width))


def _gear_side(
    design: FaceMilledDesign, blank: BevelBlank, machine: MachineSettings, name: str, width: float
) -> Generated:
    """Return one side of the gear by its machine and the cutter's point width (mm).

    Raises DesignError for a blade that cannot exist.
    """
    spec, member, side = design.gear.cutter, blank.gear, BLADE_SIDES[name]
    table, nominal = ("outside", blank.blade_angles[1]) if side == OUTSIDE_BLADE else ("inside", blank.blade_angles[0])
    keys = blade_keys(spec, getattr(spec, table))
    prefix = f"gear.cutter.{table}" if getattr(spec, table).model_fields_set else "gear.cutter"
    angle = radians_or(keys["blade_angle"], nominal)
    blade = made_blade(
        prefix, (side, blank.cutter_radius + 0.5 * side * width, angle), keys, 0.5 * blank.mean_depth, blank
    )
    tip_height, mean = blank.mean_depth - blank.clearance, member.along_root(member.mean_cone_distance)
    return Generated(machine, blade, -HAND_SIGNS[design.hand], mean, tip_height, keys["edge_radius"] is None)


def _check_gear_tilt(spec: GearCutter) -> None:
    """Raise DesignError for a tilted gear cutter without settings that are only derived for an upright one."""
    missing = [key for key in ("radial", "cradle_angle", "ratio_of_roll") if getattr(spec, key) is None]
    if spec.tilt and missing:
        raise DesignError(
            "gear.cutter.tilt",
            spec.tilt,
            unit="deg",
            reason="the gear's settings can only be derived for an untilted cutter",
            allowed=f"0, or any with gear.cutter.{', '.join(missing)} and sliding_base given",
        )


def pinion_side(design: FaceMilledDesign, blank: BevelBlank, name: str, mean: MeanPoint) -> Generated:
    """Return one side ("concave" or "convex") of the pinion: given settings, and local synthesis for those left out.

    A side with given settings is turned about the pinion's axis until it touches the gear at the mean point.

    Raises NoSolutionError if the requested contact is impossible, and DesignError for a blade that cannot exist.
    """
    if design.one_crown_gear:
        return hobbed_pinion(design, blank, name, mean.gear_turn)
    spec = design.pinion.side(name)
    values = pinion_values(design, blank, name, mean.contact, mean.choice)
    made = side_of(design, blank, name, values, roll_of(spec, mean.choice, blank))
    if spec.mesh_angle is not None:
        return replace(made, turned=HAND_SIGNS[design.hand] * float(np.radians(spec.mesh_angle)))
    if mean.choice.form is not None or not (spec.moves_flank or mean.choice.by_roll):
        return made
    return replace(made, turned=made.turned + touching_turn(made, mean.mating, mean.parameters, blank))


def side_of(
    design: FaceMilledDesign, blank: BevelBlank, name: str, values: dict[str, float], roll: tuple[float, ...]
) -> Generated:
    """Return one side of the pinion.

    - `values`: settings by key (mm, deg); a sliding base of NaN is derived
    - `roll`: coefficients of modified roll from the second order on

    Raises DesignError for a blade that cannot exist.
    """
    spec, member = design.pinion.side(name), blank.pinion
    edge = BLADE_SIDES[name], values["tip_radius"], float(np.radians(values["blade_angle"]))
    keys = {**blade_keys(spec), "blade_radius": values.get("blade_radius", spec.blade_radius)}
    blade = made_blade(f"pinion.{name}", edge, keys, values["blade_height"], blank)
    machine = _machine(spec, radians_or(pinion_root_angle(design, name), member.root_angle), values)
    made = Generated(
        replace(machine, modified_roll=roll),
        blade,
        HAND_SIGNS[design.hand],
        member.along_root(member.mean_cone_distance),
        blank.mean_depth - blank.clearance,
        spec.edge_radius is None,
        turned_after_cut(design, blank),
    )
    if design.hobbed:
        radius = blade.radius_at(values["blade_height"])
        made = replace(made, indexing=indexing(design, blank, member, made.hand, radius))
    if np.isnan(made.settings.sliding_base):
        base = made.base_to(member.root_angle, member.root_base(member.root_angle))
        made = replace(made, settings=replace(made.settings, sliding_base=base))
    return made


def roll_of(spec: PinionSide, choice: ContactChoice, blank: BevelBlank) -> tuple[float, ...]:
    """Return the coefficients of modified roll from the second order on, given and chosen ones added."""
    second, *others = given_roll(spec)
    if choice.form is not None:
        return choice.form.roll
    second += choice.second_roll(blank.pinion.teeth / blank.gear.teeth)
    return second, *(a + b for a, b in zip_longest(others, choice.roll, fillvalue=0.0))


def pinion_root_angle(design: FaceMilledDesign, name: str) -> float | None:
    """Given machine root angle (deg) of one side of the pinion, or else the other side's: both have one depth."""
    other = MATING_SIDES[name]
    return or_none(design.pinion.side(name).machine_root_angle, design.pinion.side(other).machine_root_angle)


def machine_root_angle(design: FaceMilledDesign, blank: BevelBlank, name: str) -> float:
    """Return the machine root angle (rad) of one side of the pinion."""
    return float(np.radians(or_else(pinion_root_angle(design, name), float(np.degrees(blank.pinion.root_angle)))))


def upright_base(design: FaceMilledDesign, blank: BevelBlank, name: str) -> float:
    """Return the sliding base (mm) with which an upright cutter of one side of the pinion reaches the root cone's apex."""
    return blank.pinion.root_base(machine_root_angle(design, blank, name))


def pinion_values(
    design: FaceMilledDesign, blank: BevelBlank, name: str, contact: MeanContact, choice: ContactChoice
) -> dict[str, float]:
    """Settings of a pinion side by key (mm, deg): given, found for its ease-off, or by local synthesis."""
    if choice.form is not None:
        return choice.form.values
    spec = design.pinion.side(name)
    values = {key: getattr(spec, key) for key in (*SYNTHESISED_KEYS, "blade_height")}
    if any(values[key] is None for key in SYNTHESISED_KEYS):
        second_roll = choice.second_roll(blank.pinion.teeth / blank.gear.teeth)
        derived = synthesise(design, blank, name, contact, choice.asked, second_roll)
    else:
        derived = {"blade_height": 0.5 * blank.mean_depth}
    settings = {key: value if value is not None else derived[key] for key, value in values.items()}
    base = derived.get("sliding_base", float("nan")) if np.isnan(spec.sliding_base) else spec.sliding_base
    radius = spec.blade_radius if design.sets(f"pinion.{name}.blade_radius") else derived.get("blade_radius", 0.0)
    return {**settings, "sliding_base": base, "blade_radius": radius}


def synthesise(
    design: FaceMilledDesign,
    blank: BevelBlank,
    name: str,
    contact: MeanContact,
    asked: ContactAsked,
    second_roll: float = 0.0,
) -> dict[str, float]:
    """Return the settings of one side of the pinion by local synthesis, by key (mm, deg).

    `second_roll`: as for `tool_values`.

    Raises NoSolutionError, naming the side, if the requested contact is impossible.
    """
    try:
        operator = pinion_operator(contact, asked)
    except NoSolutionError as failure:
        raise NoSolutionError(f"pinion.{name}", reason=failure.reason, remedy=failure.remedy) from failure
    return tool_values(design, blank, name, (contact.point, contact.normal), operator, second_roll)


def tool_values(
    design: FaceMilledDesign,
    blank: BevelBlank,
    name: str,
    mean: tuple[Array, Array],
    operator: Array,
    second_roll: float = 0.0,
) -> dict[str, float]:
    """Return the settings by key (mm, deg) of one side of the pinion with a given point, normal and shape operator.

    - `mean`: point (3,) and normal (3,), `operator`: shape operator (3, 3), in the pinion's frame
    - `second_roll`: coefficient of modified roll of the second order, of face hobbing

    Raises NoSolutionError, naming the side, if no cutter has them.
    """
    spec, hand, side = design.pinion.side(name), HAND_SIGNS[design.hand], BLADE_SIDES[name]
    cradle = machine_axes(machine_root_angle(design, blank, name))[2]
    turned = turned_after_cut(design, blank)
    to_cut = Rigid.about_z(-turned)
    curvature = 1.0 / spec.blade_radius if spec.blade_radius else 0.0
    base = None if np.isnan(spec.sliding_base) else -spec.sliding_base
    plane = -upright_base(design, blank, name) if base is None else base
    # local synthesis is in the frame of the pinion as cut
    mean = to_cut.point(mean[0]), to_cut.vector(mean[1])
    operator = to_cut.rotation @ operator @ to_cut.rotation.T
    head = indexing_head(design, blank, name, cradle, hand * second_roll) if design.hobbed else None

    nearby: HeadStart | None = None

    def solve(planes: MachinePlanes) -> ToolSettings:
        nonlocal nearby
        if head is None:
            return tool_settings(operator, mean, planes, side, curvature)
        # the next lean is near the last one
        settings, nearby = head_settings(operator, mean, planes, side, head, nearby)
        return settings

    def leaning(axis: Array) -> ToolSettings:
        upright = root_normal(blank.pinion, -turned)
        floor = upright, -blank.pinion.root_base(blank.pinion.root_angle)
        # the cutter is upright on the root line when the cradle has not rolled
        rolled = around(cradle, axis) - around(cradle, upright) if design.formate and head is not None else 0.0
        return solve(MachinePlanes(cradle, base, axis, floor, rolled))

    try:
        if spec.upright:
            settings = solve(MachinePlanes(cradle, plane))
        else:
            # a tilted cutter starts from the place of an upright one on the cradle
            upright = (
                solve(MachinePlanes(cradle, plane)) if head is None else leaning(root_normal(blank.pinion, -turned))
            )
            settings = _leaning(leaning, upright, cradle, spec, hand)
    except NoSolutionError as failure:
        raise NoSolutionError(f"pinion.{name}", reason=failure.reason, remedy=failure.remedy) from failure
    bent = abs(settings.blade_curvature) > MIN_BLADE_CURVATURE
    blade_radius = spec.blade_radius or (1.0 / settings.blade_curvature if bent else 0.0)
    blade = Blade.through(side, settings.radius, settings.height, settings.blade_angle, 0.0, blade_radius)
    values = {
        "radial": float(np.hypot(*settings.cutter)),
        "cradle_angle": float(np.degrees(np.arctan2(hand * settings.cutter[1], settings.cutter[0]))),
        "ratio_of_roll": settings.ratio_of_roll,
        "machining_offset": -hand * settings.centre[1],
        "machine_centre_to_back": settings.centre[0],
        "sliding_base": -settings.tip_plane,
        "blade_angle": float(np.degrees(settings.blade_angle)),
        "tip_radius": blade.tip_radius,
        "blade_height": settings.height,
        "blade_radius": blade_radius,
    }
    if design.hobbed:
        made = side_of(design, blank, name, values, ()).indexed_at(mean[0])
        # the cradle has rolled by the index at the mean point; the ratio of roll there is that of the synthesis
        rolled = np.radians(values["cradle_angle"]) - made.settings.cradle_angle
        values["ratio_of_roll"] *= 1.0 - 2.0 * second_roll * float(rolled)
        values["cradle_angle"] = float(np.degrees(made.settings.cradle_angle))
    return values


def around(cradle: Array, vector: Array) -> float:
    """Return the angle (rad) of a vector (3,) about the cradle axis (3,), from the machine root line."""
    root = np.array([cradle[2], 0.0, -cradle[0]])
    return float(np.arctan2(vector @ np.cross(cradle, root), vector @ root))


def _leaning(
    solve: Callable[[Array], ToolSettings], upright: ToolSettings, cradle: Array, spec: PinionSide, hand: int
) -> ToolSettings:
    """Return the settings of a tilted cutter.

    The swivel counts from the cutter's position on the cradle, which depends on the lean: the secant of the last two
    steps, where they come nearer, gives the next.

    Raises NoSolutionError if the steps do not converge.
    """
    tilt, swivel = np.radians(spec.tilt), np.radians(spec.swivel)
    root = np.array([cradle[2], 0.0, -cradle[0]])
    across = np.cross(cradle, root)
    settings, azimuth, last, missed = upright, np.nan, np.nan, np.nan
    for _ in range(MAX_LEAN_STEPS):
        found = float(np.arctan2(settings.cutter[1], settings.cutter[0]) + hand * (0.5 * np.pi + swivel))
        miss = found - azimuth
        if abs(miss) <= LEAN_TOLERANCE_RAD:
            return settings
        follows = azimuth - miss * (azimuth - last) / (miss - missed) if abs(miss) < abs(missed) else found
        azimuth, last, missed = follows, azimuth, miss
        axis = np.sin(tilt) * (np.cos(azimuth) * root + np.sin(azimuth) * across) + np.cos(tilt) * cradle
        settings = solve(axis)
    raise NoSolutionError(
        reason="no cutter with this tilt and swivel gives this contact", remedy="change tilt or swivel"
    )


def contact_asked(design: FaceMilledDesign, blank: BevelBlank, name: str) -> ContactAsked:
    """Return the requested contact of a design on one side of the pinion, with plain defaults."""
    spec, ratio = design.pinion.side(name), blank.pinion.teeth / blank.gear.teeth
    # at the change of teeth the gear lags by ratio * derivative / 2 * (pi / N1)^2; concave flanks drive towards larger phi2
    lag = -BLADE_SIDES[name] * spec.te_at_change * ARCSEC * 2.0 / (ratio * (np.pi / blank.pinion.teeth) ** 2)
    return ContactAsked(
        ratio_derivative=or_else(spec.ratio_derivative, lag),
        path_angle=float(np.radians(spec.path_angle)),
        semi_major_axis=or_else(spec.semi_major_axis, default_semi_major_axis(design, blank)),
        delta=design.contact.delta,
    )


def longer_than_standard(design: FaceMilledDesign, blank: BevelBlank) -> tuple[str, ...]:
    """Return the warnings on default ellipses that are longer than a quarter of the face width."""
    length, standard = default_semi_major_axis(design, blank), 0.25 * blank.gear.face_width
    return tuple(
        f"pinion.{name}.semi_major_axis = {length:.4g} mm: the default; a quarter of the face width, {standard:.4g} mm, is too "
        f"short for the flanks to separate by contact.delta = {design.contact.delta:.4g} mm"
        for name in BLADE_SIDES
        if length > standard
        and any(getattr(design.pinion.side(name), key) is None for key in SYNTHESISED_KEYS)
        and design.pinion.side(name).semi_major_axis is None
        and design.ease_off(name) is None
    )


def mean_point(
    design: FaceMilledDesign, blank: BevelBlank, gear: Generated, gear_to_pinion: Rigid, choice: ContactChoice
) -> MeanPoint:
    """Return the mean point of a side of the pinion and of the gear (as cut), in the position `gear_to_pinion`.

    It is on the gear at the middle of the mean working depth and at the mean cone distance, plus the shifts of
    `choice`, or at the point of [AB].
    """
    height = 0.5 * blank.mean_depth + choice.height
    if design.mean_point == "cradle_zero":
        parameters = gear.at_cradle_zero(height)
    else:
        level = blank.gear.station(blank.gear.mean_cone_distance + choice.along)
        parameters = gear.at_cone_distance(height, level)
    flank = gear.side(0.0).flank
    jet = flank.jet(*(np.array(x) for x in parameters))
    turn, contact = mean_contact(jet, gear_to_pinion, HAND_SIGNS[design.hand], blank)
    return MeanPoint(parameters, turn, contact, choice, (flank, gear_to_pinion @ Rigid.about_z(turn)))


def mean_contact(jet: Jet, gear_to_pinion: Rigid, sense: int, blank: BevelBlank) -> tuple[float, MeanContact]:
    """Rotation (rad) of the gear, nearest 0, at which its point (jet, gear's frame) meets the pinion, and the contact.

    `sense`: +1 where the pinion turns right-handed about its axis as phi1 grows. Raises NoSolutionError if the point is
    never in contact.
    """
    ratio = blank.pinion.teeth / blank.gear.teeth
    turn = float(meshing_turns(jet, gear_to_pinion, sense, ratio))
    if not np.isfinite(turn):
        raise NoSolutionError(
            reason="the mean point of the gear never meets the pinion", remedy="reduce the assembly errors"
        )
    placed = jet.move(gear_to_pinion @ Rigid.about_z(turn))
    return turn, contact_at(placed, gear_to_pinion, sense, ratio, blank.gear.pitch_apex)


def contact_at(at: Jet, gear_to_pinion: Rigid, sense: int, ratio: float, apex: float) -> MeanContact:
    """Return the data of the gear at a point of contact for local synthesis.

    - `at`: jet of the gear at the point, in the pinion's frame
    - `ratio`: ratio of the angular velocities
    - `apex`: apex of the gear's pitch cone beyond its origin, mm
    """
    axis, origin = gear_to_pinion.rotation[:, 2], gear_to_pinion.translation
    e1, e2 = tangent_basis(at)
    operator = shape_operator(at, e1, e2)
    angle, basis = float(principal(operator).angle), np.stack((e1, e2))
    c, s = np.cos(angle), np.sin(angle)
    pitch_line = unit(at.r - (origin - apex * axis))
    # the principal direction nearer to the pitch line is the lengthwise one
    directions = sorted((c * e1 + s * e2, c * e2 - s * e1), key=lambda d: -abs(float(d @ pitch_line)))
    to_axis = axis - (axis @ pitch_line) * pitch_line
    return MeanContact(
        point=at.r,
        normal=-at.n,
        # with -n, the outward normal of the pinion, curvatures change their sign
        gear_operator=-(basis.T @ operator @ basis),
        lengthwise=-directions[0] * np.sign(directions[0] @ pitch_line),
        profilewise=directions[1] * np.sign(directions[1] @ to_axis),
        spin1=sense * Z_AXIS,
        spin2=-sense * ratio * axis,
        origin2=origin,
    )


def meshing_turns(jet: Jet, gear_to_pinion: Rigid, sense: int, ratio: float, near: float = 0.0) -> Array:
    """Rotations (...,), rad, of the gear nearest `near` at which points meet the equation of meshing n . v12 = 0.

    `jet`: points in the gear's frame; `sense`, `ratio` as for `mean_contact`. The rotation is NaN for a point that is
    never in contact. n and r turn with the gear, so that the equation is A cos + B sin + C = 0.
    """
    spin1, spin2 = sense * Z_AXIS, -sense * ratio * gear_to_pinion.rotation[:, 2]
    values = []
    for turn in _THIRD_TURNS:
        placed = gear_to_pinion @ Rigid.about_z(turn)
        r, n = placed.point(jet.r), placed.vector(jet.n)
        values.append((n * (cross(spin1, r) - cross(spin2, r - gear_to_pinion.translation))).sum(axis=-1))
    # A, B and C by three equally spaced rotations
    f = np.stack(values, axis=-1)
    mean, a, b = f.mean(axis=-1), 2.0 / 3.0 * (f @ np.cos(_THIRD_TURNS)), 2.0 / 3.0 * (f @ np.sin(_THIRD_TURNS))
    with np.errstate(invalid="ignore"):
        half_angle, middle = np.arccos(-mean / np.hypot(a, b)), np.arctan2(b, a)
    # both roots; the one nearest `near` is returned
    roots = np.stack((middle - half_angle, middle + half_angle)) - near
    roots = (roots + np.pi) % (2.0 * np.pi) - np.pi
    nearest: Array = near + np.where(np.abs(roots[0]) <= np.abs(roots[1]), roots[0], roots[1])
    return nearest


def _machine(spec: Machine, root_angle: float, values: dict[str, float], formate: bool = False) -> MachineSettings:
    """Return machine settings from the values of their keys (mm, deg)."""
    settings = MachineSettings(
        radial=values["radial"],
        cradle_angle=float(np.radians(values["cradle_angle"])),
        ratio_of_roll=values["ratio_of_roll"],
        machining_offset=values["machining_offset"],
        machine_centre_to_back=values["machine_centre_to_back"],
        machine_root_angle=radians_or(spec.machine_root_angle, root_angle),
        sliding_base=values["sliding_base"],
        tilt=float(np.radians(spec.tilt)),
        swivel=float(np.radians(spec.swivel)),
        formate=formate,
    )
    return with_motions(settings, spec)
