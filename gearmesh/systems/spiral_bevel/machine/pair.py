"""Pairs of bevel gears from their generated sides: mating flanks, positions of the members, and assembly errors.

The fixed frame is the pinion's frame at its nominal position. phi1 grows in the sense in which the pinion's concave
side drives. phi1 = 0 and phi2 = 0 is contact at the mean point of the requested side; given settings may miss phi2 = 0.
If given settings generate the mean point at cradle rotation 0, phi1 = 0 is the pinion's position as cut at that
rotation.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.records import dataclass
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.common.bevel.blank import BevelBlank
from gearmesh.systems.common.bevel.member import CutMember, Remedies, bevel_member
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side
from gearmesh.teeth.source_parameters import NamedParameters, SourceParameter
from gearmesh.tools.head_cutter import INSIDE_BLADE, OUTSIDE_BLADE

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import HandedDesign

#: remedies for a tooth that cannot be trimmed, by the kind of failure
TRIM_REMEDIES = {
    "pointed": "a smaller addendum, spiral angle or face width",
    "undercut": "more teeth, a smaller dedendum or a larger pressure angle",
    "flank": "a larger addendum, a smaller face width or a smaller edge radius of the {name}'s blades",
    "root": "a smaller edge radius of the {name}'s blades, a larger point width or a smaller face width",
    "tip": "settings whose cutter generates the whole tooth: check face width, spiral angle and cutter radius",
    "crossing": "a toprem_angle nearer to the blade angle, a smaller toprem_height or a toprem_radius",
}
#: keys that remedy a failure; their values have to be larger (1) or smaller (-1), or either (0)
TRIM_REMEDY_KEYS = {
    "pointed": {"addendum_factor": 0, "spiral_angle": -1, "face_width": -1},
    "undercut": {"pressure_angle": 1, "pinion.teeth": 1, "gear.teeth": 1, "depth_factor": -1},
    "tip": {"face_width": -1, "spiral_angle": 0, "gear.cutter.tip_radius": 0},
}
#: remedies for teeth that cannot be trimmed
TOOTH_REMEDIES = Remedies(TRIM_REMEDIES, TRIM_REMEDY_KEYS)
#: meaning of the parameter around the cutter
CUTTER_ANGLE = "angle of the point of the blade about the axis of the cutter, 0 near the mean cone distance"
#: sign of a member's hand in frames and motions
HAND_SIGNS = {"right": 1, "left": -1}
#: side of the cutter whose blades cut a side of the tooth
BLADE_SIDES = {"concave": OUTSIDE_BLADE, "convex": INSIDE_BLADE}
#: side of the gear that meets a side of the pinion
MATING_SIDES = {"concave": "convex", "convex": "concave"}

#: both sides of a member, "concave" and "convex"
Sides = dict[str, Generated]
#: angles (rad) by side, "concave" and "convex"
Angles = dict[str, float]


@dataclass(frozen=True)
class CutSides:
    """Both sides of both members as they are cut, by the names of the member's sides."""

    #: blank of the pair
    blank: BevelBlank
    #: sides of the pinion
    pinion: Sides
    #: sides of the gear
    gear: Sides
    #: index positions of the sides of (pinion, gear), rad: rotation from cutting a side to its position in the tooth on
    #: +x
    places: tuple[Angles, Angles]
    #: rotation of the gear, as cut, to contact with each side of the pinion, as cut, at its mean point, rad
    turns: Angles
    #: rotations of the pinion from that contact to phi1 = 0, rad
    starts: Angles

    @property
    def mesh_angles(self) -> Angles:
        """Mesh angles (rad) of the pinion's sides: rotation of the pinion from cutting a side to its position at phi1 = 0.

        The sense is that of a growing cradle angle.
        """
        return {name: side.hand * (side.turned + self.starts[name]) for name, side in self.pinion.items()}

    @property
    def index_angles(self) -> Angles:
        """Index angles (rad) of the pinion's sides: rotation of the blank before a side was cut.

        They count in the sense of a growing cradle angle. At 0 the middle of the space is on the machine root line at
        cradle rotation 0.
        """
        return index_angles(self.pinion, self.blank.pinion.teeth, self.places[0])


def index_angles(sides: Sides, teeth: int, places: Angles) -> Angles:
    """Return the index angles (rad) of the sides of a pinion at index positions `places` (rad): see `CutSides`."""
    in_space = beside_space(sides, teeth)
    return {name: side.hand * (places[name] + side.turned - in_space[name]) for name, side in sides.items()}


def beside_space(sides: Sides, teeth: int) -> Angles:
    """Return the index positions (rad) of sides that are cut at once.

    The space is at the x axis; the tooth between two spaces is half a pitch from it.
    """
    half_pitch = np.pi / teeth
    return {name: half_pitch if side.flank is Side.LEFT else -half_pitch for name, side in sides.items()}


def cut_member(design: HandedDesign, cut: CutSides, name: str) -> CutMember:
    """Return the member "pinion" or "gear" of a design (in mm). Raises DesignError for teeth that cannot exist."""
    sides, places = (cut.pinion, cut.places[0]) if name == "pinion" else (cut.gear, cut.places[1])
    return member_of(design, cut.blank, name, sides, places)


def member_of(design: HandedDesign, blank: BevelBlank, name: str, sides: Sides, places: Angles) -> CutMember:
    """Return a member by its sides; the other member need not be cut.

    Raises DesignError for teeth that cannot exist.
    """
    spec, member_blank = (design.pinion, blank.pinion) if name == "pinion" else (design.gear, blank.gear)
    letter = {"pinion": "P", "gear": "G"}[name]
    parameters = NamedParameters(
        (_blade_parameter(f"u_{letter}", sides.values()), SourceParameter(f"theta_{letter}", "deg", CUTTER_ANGLE)),
        lambda p, v: (p, np.degrees(v)),
    )
    by_flank = {side.flank: side for side in sides.values()}
    at = {side.flank: places[key] for key, side in sides.items()}
    return bevel_member(name, spec, blank, member_blank, by_flank, at, parameters, TOOTH_REMEDIES)


def _blade_parameter(name: str, sides: Iterable[Generated]) -> SourceParameter:
    """Return the parameter along the cutting edges of a member's sides.

    A straight edge has a length, an arc the angle of its normal.
    """
    meanings = {
        True: ("rad", "angle of the arc of the blade"),
        False: ("mm", "distance along the straight blade, from its tip plane"),
    }
    straight = {side.blade.blade_radius == 0.0 for side in sides}
    units, words = zip(*(meanings[not line] for line in sorted(straight, reverse=True)), strict=True)
    return SourceParameter(name, " or ".join(units), ", or ".join(words))


def bevel_pair(design: HandedDesign, cut: CutSides, pinion: CutMember, gear: CutMember) -> GearTrain:
    """Return the pair of a design (in mm) by its cut members."""
    name, blank, (places, turns) = design.contact.pinion_side, cut.blank, (cut.places, cut.turns)
    mating = MATING_SIDES[name]
    pinion_mount, gear_mount = _mounts(
        design, blank, places[0][name] - cut.starts[name], turns[name] - places[1][mating]
    )
    pair = GearPair(
        pinion=replace(pinion.member, mount=pinion_mount),
        gear=replace(gear.member, mount=gear_mount),
        flanks=(cut.pinion[name].flank, cut.gear[mating].flank),
        drive=BLADE_SIDES[name],
        ratio=design.pinion.teeth / design.gear.teeth,
        delta=design.contact.delta,
    )
    # the gear first: a fault of the gear shows on the pinion as well
    return GearTrain(
        design.kind, (pair,), (*blank.warnings, *undercut_warnings(gear, blank), *undercut_warnings(pinion, blank))
    )


def undercut_warnings(cut: CutMember, blank: BevelBlank) -> tuple[str, ...]:
    """Return the warnings on flanks that are partly undercut."""
    remedies = TRIM_REMEDIES["undercut"] if blank.offset == 0.0 else f"a smaller offset, {TRIM_REMEDIES['undercut']}"
    return cut.undercut_warnings(remedies)


def thinning(backlash: float, blank: BevelBlank) -> float:
    """Return the rotation (rad) that sets a flank of the pinion back for half the normal `backlash` (mm).

    The backlash counts at the mean pitch circle.
    """
    across = np.cos(blank.pressure_angle) * np.cos(blank.pinion.spiral_angle)
    return float(0.5 * backlash / (across * blank.pinion.mean_radius))


def nominal_base(blank: BevelBlank, hand: int) -> Rigid:
    """Return the motion from the gear's frame to the pinion's; `hand` +1 right, -1 left.

    The mean point of the pitch cones is over the x axes of both frames.
    """
    axes_to_pinion, gear_to_axes = _about_axes(blank, hand)
    return axes_to_pinion @ gear_to_axes


def _about_axes(blank: BevelBlank, hand: int) -> tuple[Rigid, Rigid]:
    """Return the motions to the pinion's frame from the frame of the axes, and to that frame from the gear's.

    The y axis of the frame of the axes is the common perpendicular of both axes.
    """
    pinion_azimuth, gear_azimuth = blank.azimuths
    gear_to_axes = gear_base(blank.shaft_angle, -hand * blank.offset) @ Rigid.about_z(hand * gear_azimuth)
    return Rigid.about_z(-hand * pinion_azimuth), gear_to_axes


def displaced_frames(design: HandedDesign, blank: BevelBlank) -> tuple[Rigid, Rigid]:
    """Return the mounting of pinion and gear with the assembly errors of a design: their frames to the fixed frame."""
    errors = design.assembly
    axes_to_pinion, gear_to_axes = _about_axes(blank, HAND_SIGNS[design.hand])
    # errors in the frame of the axes: shaft angle, then axial and offset displacements
    opened = Rigid(rotation_about("y", np.radians(errors.d_delta)), np.zeros(3))
    along = Rigid(np.eye(3), np.array([0.0, 0.0, errors.dG]))
    moved = Rigid(np.eye(3), np.array([0.0, errors.dV, errors.dA]))
    return axes_to_pinion @ moved @ axes_to_pinion.inverse, axes_to_pinion @ opened @ gear_to_axes @ along


def without_errors(design: HandedDesign) -> dict[str, float]:
    """Return zero assembly errors of a design by dotted key."""
    return {f"assembly.{key}": 0.0 for key in type(design.assembly).model_fields}


def _mounts(design: HandedDesign, blank: BevelBlank, pinion_turn: float, gear_turn: float) -> tuple[Mount, Mount]:
    """Return the mounts of both members; `pinion_turn` and `gear_turn` (rad) bring the flanks to their mean contact."""
    sense = float(HAND_SIGNS[design.hand])
    pinion_frame, gear_frame = displaced_frames(design, blank)
    return Mount(pinion_frame, sense, sense * pinion_turn), Mount(gear_frame, -sense, sense * gear_turn)
