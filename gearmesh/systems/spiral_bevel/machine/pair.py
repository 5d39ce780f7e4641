"""Pairs of bevel gears from their generated sides: which flanks mesh, their positions, and the assembly errors.

Fixed frame: the pinion's own at its nominal place. phi1 grows in the sense in which the pinion's concave side drives;
phi1 = 0 and, but for what given settings miss, phi2 = 0 is contact at the mean point of the side asked for. Where given settings
generate that point at cradle rotation 0, phi1 = 0 is the pinion's position as cut then.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.spiral_bevel.blank.blank import BasicData, BevelBlank
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.member import ALLOWED, bevel_member
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.limits import lost_heights
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side
from gearmesh.tools.head_cutter import INSIDE, OUTSIDE

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import BevelDesign

HANDS = {"right": 1, "left": -1}
SIDES = {"concave": OUTSIDE, "convex": INSIDE}
#: the gear's side that meets a side of the pinion
MATING = {"concave": "convex", "convex": "concave"}

#: of both sides, "concave" and "convex"
Sides = dict[str, Generated]
Angles = dict[str, float]


@dataclass(frozen=True)
class CutSides:
    """Both sides of (pinion, gear) of a `blank` as they are cut, by their own names.

    `places`: how far (rad) each side of (pinion, gear) is turned, as cut, to stand in its tooth on +x; `turns`: how far the gear,
    as cut, is turned when it meets a side of the pinion, as cut, at its mean point; `starts`: rotations (rad) of the pinion from
    that contact to phi1 = 0.
    """

    blank: BevelBlank
    pinion: Sides
    gear: Sides
    places: tuple[Angles, Angles]
    turns: Angles
    starts: Angles

    @property
    def mesh_angles(self) -> Angles:
        """Mesh angles (rad) of the pinion's sides: rotation of the pinion, in the sense of a growing cradle angle, from cutting a
        side to its position at phi1 = 0."""
        return {name: side.hand * (side.turned + self.starts[name]) for name, side in self.pinion.items()}

    @property
    def index_angles(self) -> Angles:
        """Index angles (rad) of the pinion's sides: how far the blank was turned before they were cut, in the sense of a growing
        cradle angle, from where the middle of the space is on the machine root line at cradle rotation 0."""
        return index_angles(self.pinion, self.blank.pinion.teeth, self.places[0])


def index_angles(sides: Sides, teeth: int, places: Angles) -> Angles:
    """Index angles (rad) of the sides of a pinion at `places` (rad), see `CutSides`."""
    beside = beside_space(sides, teeth)
    return {name: side.hand * (places[name] + side.turned - beside[name]) for name, side in sides.items()}


def beside_space(sides: Sides, teeth: int) -> Angles:
    """Places (rad) of sides that are cut at once: the space is at the x axis, the tooth between two of them half a pitch beside."""
    half_pitch = np.pi / teeth
    return {name: half_pitch if side.flank is Side.LEFT else -half_pitch for name, side in sides.items()}


@dataclass(frozen=True)
class CutMember:
    """A member; `lost`: how much (mm) of the height that its cutter could generate undercut takes from the flanks that have any."""

    member: Member
    lost: dict[Side, float]


def cut_member(design: BevelDesign, cut: CutSides, name: str) -> CutMember:
    """The member "pinion" or "gear" of a design (in mm). Raises DesignError for teeth that cannot exist."""
    sides, places = (cut.pinion, cut.places[0]) if name == "pinion" else (cut.gear, cut.places[1])
    return member_of(design, cut.blank, name, sides, places)


def member_of(design: BevelDesign, blank: BevelBlank, name: str, sides: Sides, places: Angles) -> CutMember:
    """The same of its own sides, which the other member need not have been cut for."""
    spec, own = (design.pinion, blank.pinion) if name == "pinion" else (design.gear, blank.gear)
    by_flank = {side.flank: places[key] for key, side in sides.items()}
    member = bevel_member(name, spec, blank, own, sides, by_flank)
    return CutMember(member, lost_heights(member.tooth))


def bevel_pair(design: BevelDesign, cut: CutSides, pinion: CutMember, gear: CutMember) -> GearTrain:
    """The pair of a design (in mm) whose members are made of the sides that are cut."""
    name, blank, (places, turns) = design.contact.pinion_side, cut.blank, (cut.places, cut.turns)
    mating = MATING[name]
    first, second = _mounts(design, blank, places[0][name] - cut.starts[name], turns[name] - places[1][mating])
    pair = GearPair(
        pinion=replace(pinion.member, mount=first),
        gear=replace(gear.member, mount=second),
        flanks=(cut.pinion[name].flank, cut.gear[mating].flank),
        drive=SIDES[name],
        ratio=design.pinion.teeth / design.gear.teeth,
        delta=design.contact.delta,
    )
    # the gear first: what is wrong with it would show on the pinion as well
    return GearTrain(
        design.kind, (pair,), (*blank.warnings, *undercut_warnings(gear, blank), *undercut_warnings(pinion, blank))
    )


def undercut_warnings(cut: CutMember, blank: BevelBlank) -> tuple[str, ...]:
    """What to say of flanks that are undercut, though not wholly."""
    remedies = ALLOWED["undercut"] if blank.offset == 0.0 else f"a smaller offset, {ALLOWED['undercut']}"
    return tuple(
        f"{cut.member.name}: the {side} flank is undercut by up to {lost:.3g} mm of the height that its cutter could "
        f"generate; remedies: {remedies}"
        for side, lost in cut.lost.items()
    )


def basic_data(
    design: BevelDesign, spiral_angle: float, pressure_angle: float, mean_cone_distance: float | None = None
) -> BasicData:
    """Basic data of a design (in mm), angles in deg. Raises DesignError for pitch cones that cannot exist."""
    return BasicData(
        (design.pinion.teeth, design.gear.teeth),
        design.given_module,
        spiral_angle=float(np.radians(spiral_angle)),
        shaft_angle=float(np.radians(design.shaft_angle)),
        pressure_angle=float(np.radians(pressure_angle)),
        given_face_width=design.face_width,
        given_mean_cone_distance=mean_cone_distance,
    )


def thinning(backlash: float, blank: BevelBlank) -> float:
    """Rotation (rad) by which each flank of the pinion is set back for half the normal `backlash` (mm), at the mean pitch
    circle."""
    across = np.cos(blank.pressure_angle) * np.cos(blank.pinion.spiral_angle)
    return float(0.5 * backlash / (across * blank.pinion.mean_radius))


def nominal_base(blank: BevelBlank, hand: int) -> Rigid:
    """The gear's own frame to the pinion's, `hand` +1 right, -1 left; the mean point of the pitch cones is over both x axes."""
    axes_to_pinion, gear_to_axes = _about_axes(blank, hand)
    return axes_to_pinion @ gear_to_axes


def _about_axes(blank: BevelBlank, hand: int) -> tuple[Rigid, Rigid]:
    """To the pinion's own frame from the one whose y axis is the common perpendicular of both axes; to that from the gear's."""
    first, second = blank.azimuths
    gear_to_axes = gear_base(blank.shaft_angle, -hand * blank.offset) @ Rigid.about_z(hand * second)
    return Rigid.about_z(-hand * first), gear_to_axes


def displaced_frames(design: BevelDesign, blank: BevelBlank) -> tuple[Rigid, Rigid]:
    """Mounting of pinion and gear with the assembly errors of a design: their own frames to the fixed frame."""
    errors = design.assembly
    axes_to_pinion, gear_to_axes = _about_axes(blank, HANDS[design.hand])
    opened = Rigid(rotation_about("y", np.radians(errors.d_delta)), np.zeros(3))
    along = Rigid(np.eye(3), np.array([0.0, 0.0, errors.dG]))
    moved = Rigid(np.eye(3), np.array([0.0, errors.dV, errors.dA]))
    return axes_to_pinion @ moved @ axes_to_pinion.inverse, axes_to_pinion @ opened @ gear_to_axes @ along


def without_errors(design: BevelDesign) -> dict[str, float]:
    """The values of a design's assembly errors, by dotted key, for members without errors."""
    return {f"assembly.{key}": 0.0 for key in type(design.assembly).model_fields}


def _mounts(design: BevelDesign, blank: BevelBlank, pinion_turn: float, gear_turn: float) -> tuple[Mount, Mount]:
    """Mounts; `pinion_turn`, `gear_turn` (rad) bring the flanks to their mean contact."""
    sense = float(HANDS[design.hand])
    first, second = displaced_frames(design, blank)
    return Mount(first, sense, sense * pinion_turn), Mount(second, -sense, sense * gear_turn)
