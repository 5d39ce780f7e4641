"""Pitch cones, machines and blades of a face-hobbed pair that one crown gear generates [ISO 23509 method 0, uniform depth]."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, unit
from gearmesh.kernel.surface.curvature import shape_operator
from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank, basic_data
from gearmesh.systems.common.bevel.cone_blank import ConeData
from gearmesh.systems.common.bevel.iso23509.tooth_line import FaceCutter, ToothLine
from gearmesh.systems.spiral_bevel.design import CROWN_MACHINE_KEYS
from gearmesh.systems.spiral_bevel.hobbing.crowning import crown_gear_curvatures
from gearmesh.systems.spiral_bevel.hobbing.head import HeadLines, check_eccentricity, head_radius
from gearmesh.systems.spiral_bevel.hobbing.head_synthesis import IndexingHead
from gearmesh.systems.spiral_bevel.machine.blades import blade_keys, made_blade
from gearmesh.systems.spiral_bevel.machine.gear_cradle import turned_after_cut
from gearmesh.systems.spiral_bevel.machine.generated import Generated, Indexing
from gearmesh.systems.spiral_bevel.machine.machine import MachineSettings
from gearmesh.systems.spiral_bevel.machine.motions import with_motions
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES, HAND_SIGNS, MATING_SIDES, Sides, nominal_base
from gearmesh.systems.spiral_bevel.synthesis.default_ellipse import default_semi_major_axis
from gearmesh.teeth.region import Side
from gearmesh.tools.head_cutter import Blade

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import EaseOffTable, FaceMilledDesign, PinionSide

#: depth taper of all face-hobbed teeth
HOBBED_TAPER = "uniform"
#: eccentricity, over the cutter radius, whose effect on the curvatures is measured
ECCENTRICITY_STEP_SHARE = 1e-4
#: radius of the most hollow blades that crown a pinion's profile, over the working depth; with 15 to 20 many interfere
HOLLOWEST_BLADE_DEPTHS = 24.0
#: least length of the contact on either side of the point in which both members touch, in pitches
MIN_SIDE_PITCHES = 0.54
#: heights of this point over the middle of the depth that are compared, over the working depth
TOUCH_SHARES = np.linspace(-0.24, 0.24, 13)
#: number of pairs of sides whose height is kept
MAX_CACHED_TOUCHES = 64
#: number of points on either side of it
TOUCH_STEPS = 60
#: table of the gear's blades by side of the gear
BLADE_TABLES = {"concave": "outside", "convex": "inside"}


def hobbed_cones(design: FaceMilledDesign, mean_cone_distance: float | None) -> ConeData:
    """Return pitch cones and head of a face-hobbed pair without offset (design in mm), with uniform depth.

    Raises DesignError for cones that cannot exist.
    """
    data = basic_data(design, design.spiral_angle, design.pressure_angle, mean_cone_distance)
    pitch = data.pitch_cones
    radius = head_radius(design, data.mean_cone_distance, data.mean_normal_module)
    return ConeData(pitch, FaceCutter(radius, design.head.blade_groups), data.pressure_angle, HOBBED_TAPER)


@dataclass(frozen=True)
class HobbedContact:
    """Crowning of one side of the pinion with the mating side of the gear."""

    #: excess (mm) of the outer blade's radius over the inner blade's
    eccentricity: float
    #: length crowning, mm along the normal, mean of toe and heel
    length_crowning: float
    #: profile crowning, mm along the normal
    profile_crowning: float
    #: height (mm) over the middle of the pinion's depth at which the blades of both members touch
    above: float = 0.0

    @staticmethod
    def of(design: FaceMilledDesign, blank: BevelBlank, name: str) -> HobbedContact:
        """Return the crowning of the pinion's side `name`, "concave" or "convex", of a design in mm.

        Raises DesignError for a length crowning that no eccentricity gives.
        """
        if not design.one_crown_gear:
            # local synthesis fits the pinion to a gear of straight blades
            return HobbedContact(0.0, 0.0, 0.0)
        target: EaseOffTable | None = design.ease_off(name)
        lines = HeadLines.of(blank, blade_angle(design, blank, MATING_SIDES[name]))
        length, profile = (
            _asked(design, blank, name, lines) if target is None else (target.length_crowning, target.profile_crowning)
        )
        if design.head.eccentricity is not None:
            apart = design.head.eccentricity
            check_eccentricity(apart, blank.cutter_radius)
            length = float(lines.crowning(np.array([apart]))[0])
        else:
            apart = lines.eccentricity(length)
        return HobbedContact(apart, length, profile, _height_of_touch(design, blank, name, (length, profile)))

    def blade_radius(self, blank: BevelBlank, pressure_angle: float) -> float:
        """Return the radius (mm) of both blades that give the profile crowning, half each; 0 for straight blades.

        The blades are hollow: half the working depth from their middle they stand away by half the crowning.
        """
        half = 0.5 * blank.mean_working_depth / np.cos(pressure_angle)
        return -float(half**2 / self.profile_crowning) if self.profile_crowning else 0.0


def _asked(design: FaceMilledDesign, blank: BevelBlank, name: str, lines: HeadLines) -> tuple[float, float]:
    """Return the crownings (mm) lengthwise and along the profile with the ellipse and transmission error of a design.

    `lines`: tooth lines of the side.

    Both follow from the gap on the crown gear at the change of tooth pairs, half a pitch from the middle, and from the
    ellipse (`crown_gear_curvatures`); the eccentricity gives the terms of k_x, hollow blades those of k_y.
    """
    spec, angle = design.pinion.side(name), blade_angle(design, blank, MATING_SIDES[name])
    ratio, teeth = blank.pinion.teeth / blank.gear.teeth, float(blank.tooth_line.crown_teeth)
    lag = abs(spec.te_at_change) * ARCSEC
    if spec.ratio_derivative is not None:
        lag = 0.5 * ratio * abs(spec.ratio_derivative) * (np.pi / blank.pinion.teeth) ** 2
    axis = default_semi_major_axis(design, blank) if spec.semi_major_axis is None else spec.semi_major_axis
    # gap along the normal at the change of tooth pairs, half a pitch from the middle
    gap = lag * blank.gear.mean_radius * np.cos(blank.gear.spiral_angle) * np.cos(angle)
    half_pitch, slopes = np.pi / teeth, _crown_slopes(design, blank, name)
    least, parting = 2.0 * design.contact.delta / axis**2, _parting(design, blank, name, slopes)
    half_length, half_height = _half_flank(blank, angle)
    most = 2.0 * lines.largest_crowning / half_length**2
    k_x, k_y = crown_gear_curvatures(slopes, 2.0 * gap / half_pitch**2, least, parting, most)
    return float(0.5 * k_x * half_length**2), float(0.5 * k_y * half_height**2)


def _half_flank(blank: BevelBlank, angle: float) -> tuple[float, float]:
    """Return half the length and half the height (mm) of the crown gear's flank; `angle`: pressure angle, rad."""
    length, height = blank.gear.face_width / np.cos(blank.gear.spiral_angle), blank.mean_working_depth / np.cos(angle)
    return float(0.5 * length), float(0.5 * height)


def _height_of_touch(design: FaceMilledDesign, blank: BevelBlank, name: str, crownings: tuple[float, float]) -> float:
    """Return the height (mm) over the middle of the pinion's depth at which the blades of both members touch.

    There the lag is 0. Few teeth reach the end of the path at their tip sooner than at their root, counted from the
    middle. The height moves until the shorter side is MIN_SIDE_PITCHES long, at most until both sides are equal.

    - `name`: side of the pinion
    - `crownings`: length and profile crowning, mm
    """
    if not min(crownings) > 0.0:
        return 0.0
    pinion, gear = _plain_sides(design, blank, name)
    half = _half_flank(blank, pinion.blade.blade_angle)
    k_x, k_y = (2.0 * crowning / size**2 for crowning, size in zip(crownings, half, strict=True))
    return _centred_touch(blank, pinion, gear, _crown_slopes(design, blank, name), (k_x, k_y))


def _plain_sides(design: FaceMilledDesign, blank: BevelBlank, name: str) -> tuple[Generated, Generated]:
    """Return the pinion's side `name` and the gear's mating side without crowning."""
    plain = HobbedContact(0.0, 0.0, 0.0)
    pinion, gear = (
        _side(design, blank, own, _blade(design, blank, member, side), plain)
        for own, member, side in zip(blank.members, ("pinion", "gear"), (name, MATING_SIDES[name]), strict=True)
    )
    return pinion, gear


def _parting(design: FaceMilledDesign, blank: BevelBlank, name: str, slopes: tuple[float, float, float]) -> float:
    """Return C (mm) of `crown_gear_curvatures` in the middle of the flank, by both members without crowning.

    `slopes`: figures of `crown_curvatures`.
    """
    convex = 0.0
    for side in _plain_sides(design, blank, name):
        jet = side.side(0.0).flank.jet(np.array(side.blade.at_height(0.5 * blank.mean_depth)), np.zeros(()))
        along = unit(jet.r_v)
        convex -= float(np.trace(shape_operator(jet, along, np.cross(jet.n, along))))
    return convex / (slopes[0] ** 2 + slopes[1] ** 2)


@lru_cache(maxsize=MAX_CACHED_TOUCHES)
def _centred_touch(
    blank: BevelBlank,
    pinion: Generated,
    gear: Generated,
    slopes: tuple[float, float, float],
    curvatures: tuple[float, float],
) -> float:
    """Return the height of `_height_of_touch` by the sides of both members without crowning.

    `slopes`, `curvatures`: figures of `crown_curvatures`.
    """
    (g_x, g_y, twist), (k_x, k_y) = slopes, curvatures
    half, middle = _half_flank(blank, pinion.blade.blade_angle), 0.5 * blank.mean_depth
    direction = np.linalg.solve(np.array([[k_x, twist * k_x], [twist * k_x, k_y]]), np.array([g_x, g_y]))
    envelopes = [side.envelope(side.blade.flank) for side in (pinion, gear)]
    tools = [
        envelope.tool.jet(np.array(side.blade.at_height(middle)), np.zeros(()))
        for envelope, side in zip(envelopes, (pinion, gear), strict=True)
    ]
    # the path as a line over the parameters of both members: lengths of edge and of tooth line
    x = unit(tools[0].r_v)
    across = direction[0] * x + direction[1] * np.cross(tools[0].n, x)
    du, dv = np.linalg.lstsq(np.stack((tools[0].r_u, tools[0].r_v), axis=-1), across, rcond=None)[0]
    rates = [float(jet.r_v @ jet.r / np.linalg.norm(jet.r[:2])) for jet in tools]
    reach = min(2.0 * half[1] / abs(direction[1]), 2.0 * half[0] / abs(direction[0]))
    along, centre = np.linspace(-reach, reach, 2 * TOUCH_STEPS + 1), TOUCH_STEPS
    slope, pitch = np.cos(pinion.blade.blade_angle), 2.0 * np.pi / float(blank.tooth_line.crown_teeth)

    def shorter(heights: Array) -> Array:
        """Return the lengths (N,), pitches, of the shorter side of the path through heights (N,), mm, over the middle."""
        up = heights[:, None] + slope * du * along
        parameters = ((middle + up) / slope, dv * along), ((middle - up) / slope, dv * along * rates[0] / rates[1])
        inside = np.ones(up.shape, dtype=bool)
        for envelope, own, (p, q) in zip(envelopes, blank.members, parameters, strict=True):
            r, (toe, heel) = envelope.jet(p, q).r, own.extent
            station = own.stations.value(r)
            inside &= (own.tip.value(r) < 0.0) & (station > toe) & (station < heel)
        # equal distances from the touch are equal lags: teeth change where they are a pitch apart
        roll = envelopes[0].parameter(*parameters[0])
        apart = np.abs(roll[:, centre:] - roll[:, centre::-1]) / pitch
        change = np.array([np.interp(1.0, row, along[centre:]) for row in apart])
        run = np.where(inside, along, 0.0)
        return np.asarray(0.5 * np.minimum(run.max(axis=1), -run.min(axis=1)) / change)

    if shorter(np.zeros(1))[0] >= MIN_SIDE_PITCHES:
        return 0.0
    heights = TOUCH_SHARES * blank.mean_working_depth
    sides = shorter(heights)
    at, best = len(heights) // 2, int(sides.argmax())
    order = np.arange(at, best + 1) if best >= at else np.arange(at, best - 1, -1)
    return float(np.interp(MIN_SIDE_PITCHES, np.maximum.accumulate(sides[order]), heights[order]))


def _crown_slopes(design: FaceMilledDesign, blank: BevelBlank, name: str) -> tuple[float, float, float]:
    """Return figures of the crown gear's flank in its middle, with x along the tooth and y up the blade.

    They are the gradient (1/mm) of the cradle's rotation by x and by y, and the curvature by x and y over the curvature by
    x that an eccentricity adds.
    """
    blade, share = _blade(design, blank, "pinion", name), ECCENTRICITY_STEP_SHARE * blank.cutter_radius
    nominal, wider, narrower = (
        _side(design, blank, blank.pinion, blade, HobbedContact(apart, 0.0, 0.0)) for apart in (0.0, share, -share)
    )
    envelope = nominal.envelope(nominal.blade.flank)
    at = np.array(nominal.blade.at_height(0.5 * blank.mean_depth)), np.zeros(())
    jet, (_, by_p, by_v) = envelope.tool.jet(*at), envelope.progress(*at)
    x = jet.r_v / np.linalg.norm(jet.r_v)
    y = np.cross(jet.n, x)
    tangents = np.array([[jet.r_u @ x, jet.r_u @ y], [jet.r_v @ x, jet.r_v @ y]])
    g_x, g_y = np.linalg.solve(tangents, np.array([by_p, by_v]))
    more, less = (shape_operator(side.envelope(side.blade.flank).tool.jet(*at), x, y) for side in (wider, narrower))
    return float(g_x), float(g_y), _twist(more - less)


def _twist(added: Array) -> float:
    """Return the curvature by x and y over the curvature by x of an operator (2, 2) that an eccentricity adds."""
    return float(added[0, 1] / added[0, 0])


def formate_twist(design: FaceMilledDesign, blank: BevelBlank, name: str) -> float:
    """Return the curvature by x and y over the curvature by x that an eccentricity adds to a gear that is not generated.

    x is along the tooth, in the sweep of the blade. `name`: side of the gear.
    """
    blade, share = _blade(design, blank, "gear", name), ECCENTRICITY_STEP_SHARE * blank.cutter_radius
    wider, narrower = (
        _side(design, blank, blank.gear, blade, HobbedContact(apart, 0.0, 0.0)) for apart in (share, -share)
    )
    operators = []
    for side in (wider, narrower):
        jet = side.side(0.0).flank.jet(np.array(side.blade.at_height(0.5 * blank.mean_depth)), np.zeros(()))
        along = unit(jet.r_v)
        operators.append(shape_operator(jet, along, np.cross(jet.n, along)))
    return _twist(operators[0] - operators[1])


def blade_angle(design: FaceMilledDesign, blank: BevelBlank, name: str) -> float:
    """Return the angle (rad) of the blades that cut the gear's side `name`, "concave" or "convex"."""
    given = blade_keys(design.gear.cutter, getattr(design.gear.cutter, BLADE_TABLES[name]))["blade_angle"]
    inside, outside = blank.blade_angles
    return (outside if name == "concave" else inside) if given is None else float(np.radians(given))


def hobbed_gear(design: FaceMilledDesign, blank: BevelBlank) -> Sides:
    """Return both sides of the gear; as cut, the middle of the tooth space is over the x axis.

    Raises DesignError for blades that cannot exist.
    """
    sides = {}
    for name in BLADE_SIDES:
        contact = HobbedContact.of(design, blank, MATING_SIDES[name])
        made = _side(design, blank, blank.gear, _blade(design, blank, "gear", name), contact)
        sides[name] = replace(made, turned=_gear_turned(design, blank, made.flank))
    return sides


def _gear_turned(design: FaceMilledDesign, blank: BevelBlank, flank: Side) -> float:
    """Return the rotation (rad) of a side of the gear from the pitch point over the x axis to its place beside a space."""
    own = blank.gear
    thickness = own.thickness if design.gear.thickness is None else design.gear.thickness
    half_space = np.pi / own.teeth - 0.5 * thickness / (np.cos(own.spiral_angle) * own.mean_radius)
    return float(-half_space if flank is Side.LEFT else half_space)


def hobbed_pinion(design: FaceMilledDesign, blank: BevelBlank, name: str, gear_turn: float) -> Generated:
    """Return one side of the pinion, "concave" or "convex", turned into contact with the gear.

    `gear_turn`: rotation (rad) of the gear, as cut, to the contact of the mean point.

    Raises DesignError for blades that cannot exist.
    """
    contact = HobbedContact.of(design, blank, name)
    made = _side(design, blank, blank.pinion, _blade(design, blank, "pinion", name), contact)
    made = replace(made, settings=_with_given(made.settings, design.pinion.side(name)))
    # from the position of the crown gear in which both members are cut
    turned = (gear_turn + _gear_turned(design, blank, made.flank)) * blank.gear.teeth / blank.pinion.teeth
    return replace(made, turned=-float(turned))


def _with_given(settings: MachineSettings, spec: PinionSide) -> MachineSettings:
    """Return the machine of one crown gear with the settings and motions that a side of a design (in mm) gives."""
    given = {key: value for key in CROWN_MACHINE_KEYS if (value := getattr(spec, key)) is not None}
    if "cradle_angle" in given:
        given["cradle_angle"] = float(np.radians(given["cradle_angle"]))
    return with_motions(replace(settings, **given), spec)


def indexing_head(
    design: FaceMilledDesign, blank: BevelBlank, name: str, cradle: Array, second_roll: float
) -> IndexingHead:
    """Return the head of the pinion's side `name`, and the machine from which local synthesis starts.

    It is the pinion's own crown gear, or the gear itself where it is not generated, about the `cradle` axis (3,).
    `second_roll`: coefficient of modified roll of the second order, by right-handed rotations.
    """
    own, hand = blank.pinion, HAND_SIGNS[design.hand]
    lead = hand * 0.5 * design.head.blade_groups * blank.mean_normal_module
    radius, curvature = design.pinion.side(name).blade_radius, 0.0 if not design.formate else None
    if design.sets(f"pinion.{name}.blade_radius"):
        curvature = 1.0 / radius if radius else 0.0
    if design.formate:
        base = Rigid.about_z(-turned_after_cut(design, blank)) @ nominal_base(blank, hand)
        centre, ratio = base.translation, own.teeth / blank.gear.teeth
    else:
        # the cradle rolls on the pitch cone without sliding across the pitch line
        c, s = np.cos(own.pitch_angle), np.sin(own.pitch_angle)
        centre = np.array([0.0, 0.0, -own.pitch_apex])
        ratio = float(s / np.linalg.norm(np.cross(cradle, [s, 0.0, c])))
    hollowest = -1.0 / (HOLLOWEST_BLADE_DEPTHS * blank.mean_working_depth)
    per_turn = design.head.blade_groups / own.teeth
    return IndexingHead(per_turn, lead, blank.cutter_radius, centre, ratio, curvature, hollowest, second_roll)


@dataclass(frozen=True)
class _BladeKeys:
    """Keys of one blade."""

    #: OUTSIDE_BLADE or INSIDE_BLADE
    side: int
    #: table that a refusal names
    prefix: str
    #: values
    values: dict[str, float | None]
    #: angle, rad
    angle: float
    #: True if the radius of the cutting edge is given
    curved: bool


def _blade(design: FaceMilledDesign, blank: BevelBlank, member: str, name: str) -> _BladeKeys:
    """Return the keys of the blade that cuts the side `name` of a member."""
    if member == "pinion":
        prefixes, values = [f"pinion.{name}"], blade_keys(design.pinion.side(name))
    else:
        own = getattr(design.gear.cutter, BLADE_TABLES[name])
        values = blade_keys(design.gear.cutter, own)
        prefixes = [f"gear.cutter.{BLADE_TABLES[name]}"] if own.model_fields_set else []
        prefixes.append("gear.cutter")
    angle = blade_angle(design, blank, name if member == "gear" else MATING_SIDES[name])
    curved = any(design.sets(f"{prefix}.blade_radius") for prefix in prefixes)
    return _BladeKeys(BLADE_SIDES[name], prefixes[0], values, angle, curved)


def _side(
    design: FaceMilledDesign, blank: BevelBlank, own: MemberBlank, blade: _BladeKeys, contact: HobbedContact
) -> Generated:
    """Return one side of a member.

    - `own`: blank of the member
    - `blade`: keys of its blade
    - `contact`: crowning of the side and its mating side
    """
    hand = HAND_SIGNS[design.hand] * (1 if own is blank.pinion else -1)
    nominal, angle = blank.tooth_line, blade.angle
    # heads of both sides differ in radius by the eccentricity, which crowns the flanks along their length
    radius = nominal.cutter.radius + 0.5 * blade.side * contact.eccentricity
    line = ToothLine(
        FaceCutter(radius, nominal.cutter.blade_groups),
        own.mean_cone_distance,
        own.spiral_angle,
        own.teeth / float(np.sin(own.pitch_angle)),
    )
    given = blade.values["blade_radius"] if blade.curved else None
    curved = contact.blade_radius(blank, angle) if given is None else given
    # the straight edge passes through the pitch point; a curved edge touches it in about the middle of the working depth
    middle = 0.5 * blank.mean_depth + (contact.above if own is blank.pinion else -contact.above)
    beside = radius + blade.side * (middle - own.mean_dedendum) * np.tan(angle)
    tip_radius = Blade.through(blade.side, float(beside), middle, angle, 0.0, curved).tip_radius
    edge, values = (blade.side, tip_radius, angle), {**blade.values, "blade_radius": curved, "blade_height": None}
    made = made_blade(blade.prefix, edge, values, middle, blank)
    machine = _machine(line, own)
    if design.formate and own is blank.gear:
        machine = replace(machine, ratio_of_roll=0.0, formate=True)
    return Generated(
        machine,
        made,
        hand,
        own.along_root(own.mean_cone_distance),
        blank.mean_depth - blank.clearance,
        edge_free=values["edge_radius"] is None,
        indexing=indexing(design, blank, own, hand, radius),
    )


def indexing(design: FaceMilledDesign, blank: BevelBlank, own: MemberBlank, hand: int, radius: float) -> Indexing:
    """Return the indexing of a member with a `hand`, by blades at a cutter's `radius` (mm) at the mean point."""
    groups = design.head.blade_groups
    lead = np.arcsin(0.5 * groups * blank.mean_normal_module / radius)
    return Indexing(groups, own.teeth, radius, hand * float(lead))


def _machine(line: ToothLine, own: MemberBlank) -> MachineSettings:
    """Return the machine: the cradle's axis is that of the crown gear, and the cutter's centre gives the tooth line."""
    lean, radius = line.spiral_angle - line.lead_angle, line.cutter.radius
    x, y = float(line.mean_cone_distance - radius * np.sin(lean)), float(radius * np.cos(lean))
    return MachineSettings(
        radial=float(np.hypot(x, y)),
        cradle_angle=float(np.arctan2(y, x)),
        ratio_of_roll=float(np.sin(own.pitch_angle)),
        machine_root_angle=own.root_angle,
        machine_centre_to_back=own.along_root(0.0),
        sliding_base=own.root_base(own.root_angle),
    )
