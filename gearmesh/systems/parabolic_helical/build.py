"""Double-crowned helical gears on parallel axes [LF04 17]: Novikov-Wildhaber gears and modified involute gears.

Parabolic rack cutters touch at the pitch plane. In the space of the pinion's cutter both flanks lose material away from
it by a_c d^2, with d along the tangent. The gear's flanks gain a_t d^2 (Novikov gears of the new version, internal
tangency) or lose it (modified involute gears, external tangency). A worm or disk then grinds the pinion and crowns it
along its teeth.

The frame S_1 = S_f is the pinion's. The gear's axis is at x = E, and its own x axis is turned over. phi1 turns the
pinion clockwise about +z, phi2 the gear counterclockwise. The driving side is the right flank of both members. At phi1
= 0 the touching flanks meet the pitch point at mid face, where rack, pinion and gear touch.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.design.modifications import Modified
from gearmesh.errors import DesignError
from gearmesh.kernel.envelope.feed_envelope import FeedEnvelope
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.systems.common.axes import shifts
from gearmesh.systems.common.backlash import thin
from gearmesh.systems.common.bodies.tip_surface import with_tip_surface
from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.common.micro_geometry import with_modifications
from gearmesh.systems.common.racks.rack_member import (
    ALONG_PROFILE,
    ROOT_PARAMETER,
    Roll,
    ToothMaking,
    member,
    rack_parameters,
)
from gearmesh.systems.common.racks.rack_tooth import Heights, RackTooth, round_tips
from gearmesh.systems.common.tooth_edges import with_end_chamfers
from gearmesh.systems.parabolic_helical.worm_thread import grinding_worm, touching_range
from gearmesh.systems.system import Displacements, ToolPart
from gearmesh.teeth.gear_train import GearPair, GearTrain, SourceParameters
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side
from gearmesh.teeth.source_parameters import NamedParameters, SourceParameter
from gearmesh.teeth.tooth_side import Bottom
from gearmesh.tools.disk import Disk
from gearmesh.tools.rack import RackSurface
from gearmesh.tools.worm import Worm

if TYPE_CHECKING:
    from gearmesh.systems.parabolic_helical.design import ParabolicHelicalDesign, ParabolicMember

#: feed on either side of mid face, over the face width, for which the ground tooth is prepared
FEED_SHARE = 0.6


def build(design: ParabolicHelicalDesign) -> GearTrain:
    """Return the pair of a `novikov` or `modified_involute` design (in mm).

    Raises DesignError for racks and teeth that cannot exist (see `rack_tooth.round_tips`, `rack_member.member`), and
    for tools that cannot grind the pinion.
    """
    rolls, racks = _rolls(design), _racks(design)
    grinding = {"pinion": _crowning(design, rolls["pinion"]), "gear": None}
    bottoms = {"pinion": _bottom(design, rolls["pinion"], racks["pinion"]), "gear": None}
    mounts = _mounts(design, rolls)
    # cut or ground teeth, then turned tips, modifications and chamfers
    made = {
        name: member(
            name,
            spec,
            racks[name],
            rolls[name],
            _source_parameters(grinding[name]),
            "addendum",
            grinding[name],
            bottoms[name],
        )
        for name, spec in _specs(design).items()
    }
    made = {name: with_tip_surface(made[name], spec) for name, spec in _specs(design).items()}
    if isinstance(design.gear, Modified):
        made["gear"] = with_modifications(made["gear"], design.gear, reference_radius=rolls["gear"].radius)
    specs = _specs(design)
    pinion, gear = (
        replace(with_end_chamfers(member, specs[name]), mount=mounts[name]) for name, member in made.items()
    )
    side = Side(design.contact.flank)
    pair = GearPair(
        pinion=pinion,
        gear=gear,
        flanks=(side, side),
        drive=side.sign,
        ratio=design.pinion.teeth / design.gear.teeth,
        delta=design.contact.delta,
    )
    return GearTrain(design.kind, (pair,), unusual_defaults(design, design.standards()))


def _specs(design: ParabolicHelicalDesign) -> dict[str, ParabolicMember]:
    return {"pinion": design.pinion, "gear": design.gear}


def _rolls(design: ParabolicHelicalDesign) -> dict[str, Roll]:
    """Return the rolling racks; a changed lead angle turns the racks' teeth, and the pitch cylinders stay nominal."""
    helix, rolls = np.radians(design.helix_angle), {}
    hand = _hand(design)
    for name, sign, change in (
        ("pinion", 1.0, design.assembly.d_lambda1),
        ("gear", -1.0, design.assembly.d_lambda2),
    ):
        radius = 0.5 * _specs(design)[name].teeth * design.given_module / np.cos(helix)
        rolls[name] = Roll(float(radius), float(sign * (helix - hand * np.radians(change))), 0.0)
    return rolls


def _hand(design: ParabolicHelicalDesign) -> float:
    """Return +1 for a right-hand pinion (and spur gears), -1 for a left-hand pinion."""
    return 1.0 if design.helix_angle >= 0.0 else -1.0


def _racks(design: ParabolicHelicalDesign) -> dict[str, tuple[RackTooth, RackTooth]]:
    """Return right and left side of both cutters' spaces.

    Each of the pair's four flanks is set back by a quarter of the backlash.
    """
    module, racks = design.given_module, {}
    for name, spec in _specs(design).items():
        for angle in (design.pressure_angle, design.coast_pressure_angle):
            thin(0.5 * design.rack_space(name), design.backlash, 0.25, float(np.radians(angle)), f" of the {name}")
        heights = Heights(spec.addendum * module, -spec.dedendum * module)
        racks[name] = round_tips(name, spec, module, design.rack_flanks(name), heights)
    return racks


def _crowning(design: ParabolicHelicalDesign, roll: Roll) -> ToothMaking | None:
    """Return the tool that makes the pinion's teeth from a cutter's surface; None for the cutter itself."""
    pinion, module = design.pinion, _module(design, roll)
    feed = FEED_SHARE * pinion.face_width
    if pinion.crowning == "none":
        return None
    if pinion.crowning == "disk":
        disk, vertex = _disk(design, roll)
        return ToothMaking(
            lambda rack, used: disk.tooth(rack, pinion.plunge_coefficient, vertex).prepare(used, (-feed, feed)),
            disk.description,
        )
    tool = worm(design, module, roll.helix)
    ground = _grind(design, tool)
    return ToothMaking(lambda rack, used: ground(rack).prepare(used, (-feed, feed)), tool.description)


def _disk(design: ParabolicHelicalDesign, roll: Roll) -> tuple[Disk, float]:
    """Return the disk that grinds the pinion, and the feed at which it does not plunge."""
    disk = Disk(design.disk.pitch_radius, design.pinion.teeth, _module(design, roll), roll.helix)
    vertex = design.disk.vertex
    if vertex is None:
        driving = design.rack_flanks("pinion")[0]
        vertex = disk.feed_at_mid_face(RackSurface(driving, roll.helix, roll.cone), driving.vertex)
    return disk, vertex


def _bottom(design: ParabolicHelicalDesign, roll: Roll, racks: tuple[RackTooth, RackTooth]) -> Bottom | None:
    """Return the root that a disk's rim grinds; it is askew in the space, so that a plunge varies across it."""
    if design.pinion.crowning != "disk":
        return None
    disk, vertex = _disk(design, roll)
    right, left = (
        RackSurface(rack.rounding, roll.helix, roll.cone, side) for rack, side in zip(racks, (1, -1), strict=True)
    )
    return Bottom(*disk.rim((right, left), ROOT_PARAMETER, design.pinion.plunge_coefficient, vertex))


def _grind(design: ParabolicHelicalDesign, tool: Worm) -> Callable[[RackSurface], FeedEnvelope]:
    """Return the function from a cutter surface to the tooth that the worm grinds, crowned if the worm crowns it."""
    pinion = design.pinion
    plunge = pinion.plunge_coefficient if pinion.crowning == "worm_plunge" else 0.0
    modified_roll = pinion.roll_coefficient if pinion.crowning == "worm_roll" else 0.0
    # the rotation that removes material from the right flank leaves more on the left flank
    return lambda rack: tool.tooth(rack, plunge, rack.side * modified_roll)


def _module(design: ParabolicHelicalDesign, roll: Roll) -> float:
    """Return the normal module (mm) that belongs to the pinion's pitch radius, also if the lead angle is changed."""
    return float(2.0 * roll.radius * np.cos(roll.helix) / design.pinion.teeth)


def worm_part(design: ParabolicHelicalDesign) -> ToolPart:
    """Return the worm of the table `worm` (in mm) as a part, long enough to grind the pinion from end to end.

    If the pinion is crowned by another tool, or not at all, the worm grinds it without crowning. Raises DesignError as
    `worm_thread.worm_member` does.
    """
    pinion, roll, racks = design.pinion, _rolls(design)["pinion"], _racks(design)["pinion"]
    tool = worm(design, _module(design, roll), roll.helix)
    half = 0.5 * pinion.face_width
    touching = touching_range(_grind(design, tool), tool, racks, (-half, half))
    return grinding_worm(tool, racks, touching, design.worm.length, design.worm.bore)


def pinned_values(design: ParabolicHelicalDesign, train: GearTrain) -> dict[str, float]:
    """Return the position of the disk, and length and bore of the worm if it can be a part.

    They are given for a complete design in mm.
    """
    values = {}
    if design.pinion.crowning == "disk":
        values["disk.vertex"] = float(_disk(design, _rolls(design)["pinion"])[1])
    with suppress(DesignError):
        part = worm_part(design)
        values |= {
            "worm.length": part.figures["length_mm"],
            "worm.bore": 2.0 * part.member.tooth.blank.body.bore_radius,
        }
    return values


def worm(design: ParabolicHelicalDesign, module: float, helix: float) -> Worm:
    """Return the worm that grinds the pinion."""
    hand = 1 if design.worm.right_hand else -1
    return Worm(design.worm.pitch_radius, design.worm.threads, design.pinion.teeth, module, helix, hand)


def _mounts(design: ParabolicHelicalDesign, rolls: dict[str, Roll]) -> dict[str, Mount]:
    """Return the positions of both members [LF04 17.8].

    dE moves the axes apart, d_gamma turns the gear's axis about the line of centres. Its sense is such that d_gamma +
    d_lambda1 = 0 restores the contact, for right-hand and left-hand pinions.
    """
    tilt = rotation_about("x", -_hand(design) * np.radians(design.assembly.d_gamma)) @ rotation_about("z", np.pi)
    pinion, gear = rolls["pinion"].radius, rolls["gear"].radius
    # half of the pinion's tooth on the pitch cylinder: the distance of the touching flank from the middle of the tooth
    half = 0.5 * np.pi * design.given_module / (1.0 + design.rack_parameter) / np.cos(np.radians(design.helix_angle))
    aside = float(half if design.contact.flank == "right" else -half)
    return {
        "pinion": Mount(Rigid.identity(), sign=-1.0, zero=aside / pinion),
        "gear": Mount(
            Rigid(tilt, np.array([pinion + gear + design.assembly.dE, 0.0, 0.0])),
            zero=aside / gear - np.pi / design.gear.teeth,
        ),
    }


def _displaced_bases(
    design: ParabolicHelicalDesign, train: GearTrain, errors: Mapping[str, Array]
) -> tuple[Rigid, Rigid]:
    """Return the positions of both members with assembly errors."""
    pinion, gear = (mount.base for mount in train.pairs[0].mounts)
    tilt = rotation_about("x", -_hand(design) * np.radians(errors["d_gamma"]))
    return pinion, Rigid(tilt @ gear.rotation, gear.translation + shifts(errors["dE"], 0.0, 0.0))


#: keys of the assembly errors, and the positions of the members with them
ASSEMBLY_DISPLACEMENTS: Displacements[ParabolicHelicalDesign] = Displacements(("dE", "d_gamma"), _displaced_bases)


def _source_parameters(grinding: ToothMaking | None) -> SourceParameters:
    """Return the function for the source parameters.

    They are u_c along the rack's profile and theta_c along its teeth [LF04 17.9], or the feed s_w of worm and disk
    (17.7.8).
    """
    if grinding is None:
        return rack_parameters("u_c", "theta_c")
    feed = SourceParameter("s_w", "mm", "feed of the grinding tool along the axis, from mid face")
    return NamedParameters((SourceParameter("u_c", "mm", ALONG_PROFILE), feed), lambda p, v: (p, v))
