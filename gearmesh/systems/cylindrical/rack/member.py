"""A rack as a member, and its mounting to its pinion [ISO 21771, ISO 53].

A rack is what rolls on its pinion as the basic rack does: flanks are planes, root fillets cylinders along the tooth traces, lands
planes. Its own frame: x out of the bar, x = 0 the reference plane, on which tooth and space are equally wide but for allowances; y
along the bar; z across it, the middle of the face at z = 0, where one tooth is centred on y = 0. Lengths in mm, angles in rad.

Fixed frame: the pinion's, as in `build`; the rack's reference plane is at x = `distance`, its teeth point to the pinion's axis. The
rack's coordinate phi2 (rad) is its displacement over the radius of the pinion's reference cylinder, which rolls on it without slip
whatever profile shift and distance; the displacement grows towards -y of the fixed frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.joint import Prismatic
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.flat import FlatLevel
from gearmesh.kernel.surface.levels import PlaneLevel
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.systems.common.bodies.body import LEAST_RIM
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.micro_geometry import with_modifications
from gearmesh.systems.common.racks.rack_member import ROOT
from gearmesh.systems.common.racks.rack_tooth import Heights, RackTooth, round_tips
from gearmesh.systems.common.tooth_edges import edge_refusal, tip_edge, with_end_chamfers
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.blank.features import BodyFeatures, HoleRow
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Region, Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.description import HeightZero, ToolDescription
from gearmesh.tools.rack import RackLine, RackSurface

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.rack.design import BoltRow, RackTable


@dataclass(frozen=True)
class RackProportions:
    """Teeth of a rack: their number; face width and height of the bar, from its back to the tips; addendum, dedendum and radius of
    the root fillets in normal modules; allowance of the normal tooth thickness; how far the bar goes on beyond the last pitch at
    either end. Lengths in the unit of the pinion's."""

    teeth: int
    face_width: float
    height: float
    addendum: float = 1.0
    dedendum: float = 1.25
    tool_tip_radius: float = 0.38
    allowance: float = 0.0
    overhang: float = 0.0


@dataclass(frozen=True)
class RackMesh:
    """A pinion and a rack in closed form; `tip`: the pinion's tip radius, `distance`: from its axis to the reference plane."""

    pinion: Toothing
    rack: RackProportions
    tip: float
    distance: float

    @property
    def pitch(self) -> float:
        """Transverse pitch, along the rack."""
        return math.pi * self.pinion.transverse_module

    @property
    def travel(self) -> float:
        """Way of the rack in a turn of the pinion."""
        return self.pinion.teeth * self.pitch

    @property
    def length(self) -> float:
        """Length of the bar."""
        return self.rack.teeth * self.pitch + 2.0 * self.rack.overhang

    @property
    def above(self) -> float:
        """How far the reference plane is from the reference cylinder."""
        return self.distance - self.pinion.radius

    @property
    def pitch_height(self) -> float:
        """Height of the reference plane over the back of the bar."""
        return self.rack.height - self.rack.addendum * self.pinion.module

    @property
    def mounting_distance(self) -> float:
        """Of the pinion's axis from the back of the bar."""
        return self.distance + self.pitch_height

    @property
    def working_angle(self) -> float:
        """Transverse working pressure angle: that of the basic rack, whatever the distance."""
        return self.pinion.alpha_t

    @property
    def rack_thickness(self) -> float:
        """Normal tooth thickness of the rack on its reference plane."""
        return 0.5 * math.pi * self.pinion.module + self.rack.allowance

    @property
    def rack_land(self) -> float:
        """Normal width of the rack's top lands."""
        return self.rack_thickness - 2.0 * self.rack.addendum * self.pinion.module * math.tan(self.pinion.alpha)

    @property
    def circumferential_backlash(self) -> float:
        """Transverse play along the rack, j_wt: what pinion and rack leave of the pitch on the reference cylinder."""
        own = self.pinion
        rack = self.rack_thickness / math.cos(own.beta) - 2.0 * self.above * math.tan(own.alpha_t)
        return self.pitch - own.thickness / math.cos(own.beta) - rack

    @property
    def normal_backlash(self) -> float:
        """Normal backlash j_bn = j_wt cos(alpha_wt) cos(beta_b)."""
        return self.circumferential_backlash * math.cos(self.working_angle) * math.cos(self.pinion.beta_b)

    @property
    def radial_backlash(self) -> float:
        """By how much nearer the rack may come until there is no play, j_r."""
        return 0.5 * self.circumferential_backlash / math.tan(self.working_angle)

    @property
    def generator(self) -> float:
        """Roll length of the pinion at the pitch point C."""
        return self.pinion.base_radius * math.tan(self.pinion.alpha_t)

    def roll_length_at(self, height: float) -> float:
        """Roll length of the pinion where the rack is met `height` over its reference plane."""
        return self.generator - (height - self.above) / math.sin(self.pinion.alpha_t)

    def rack_height(self, length: float) -> float:
        """Height over the rack's reference plane where it is met by the pinion's roll length."""
        return self.above - (length - self.generator) * math.sin(self.pinion.alpha_t)

    def sliding(self, length: float) -> tuple[float, float]:
        """Specific sliding of pinion and rack where the pinion has a roll length: 1 - (speed of the mating gear along the flank)
        / (own).

        -inf where the pinion's flank is at rest, at its base circle.
        """
        return (1.0 - self.generator / length if length > 0.0 else -math.inf), 1.0 - length / self.generator

    @property
    def transverse_contact_ratio(self) -> float:
        """Path of contact from the rack's tip plane to the pinion's tip, over the base pitch.

        Of pinions whose involute goes on to where the rack's tips meet it.
        """
        own = self.pinion
        begins = self.roll_length_at(self.rack.addendum * own.module)
        return (own.roll_length(self.tip) - begins) / own.base_pitch

    @property
    def overlap_ratio(self) -> float:
        return self.rack.face_width * math.sin(abs(self.pinion.beta)) / (math.pi * self.pinion.module)

    @property
    def root_clearance(self) -> float:
        """Of the pinion's tips over the rack's root, mm."""
        return self.distance + self.rack.dedendum * self.pinion.module - self.tip


def rack_member(name: str, spec: RackProportions, pinion: Toothing, table: RackTable | None = None) -> Member:
    """A rack (in mm) that meshes with a pinion, without its mounting; its helix has the other hand. `table` is its part of the
    design, which says what edges are broken and what flanks modified.

    Raises DesignError naming key, value and limit: no room for the fillet, no tooth, no bar, a tip edge larger than the tooth.
    """
    m, helix = pinion.module, -pinion.beta
    heights = Heights(spec.addendum * m, -spec.dedendum * m)
    line = RackLine(pinion.alpha, m, 0.25 * math.pi * m + 0.5 * spec.allowance)
    right, left = (
        _side(rack, helix, side)
        for rack, side in zip(round_tips(name, spec, m, (line, line), heights), (1, -1), strict=True)
    )
    depth, back = (spec.addendum + spec.dedendum) * m, heights.tip - spec.height
    if not spec.height > depth:
        raise DesignError(
            f"{name}.height",
            spec.height,
            unit="mm",
            reason="the root lies below the back of the bar",
            allowed=f"more than the teeth's, {at_least(depth)} mm",
        )
    joint, half = Prismatic(pinion.radius, 2.0 * math.pi / pinion.teeth), 0.5 * spec.face_width
    tooth = Tooth(
        teeth=spec.teeth,
        right=right,
        left=left,
        blank=Blank(
            PlaneLevel(0.0),
            (-half, half),
            FlatLevel(heights.tip, joint),
            FlatLevel(heights.root, joint),
            Body.tube(back, -half, half, Region.BACK),
        ),
        tip_edge=None if table is None else tip_edge(table, joint),
        joint=joint,
    )
    try:
        tooth.prove()
    except TrimError as failure:
        raise edge_refusal(name, tooth, failure) or failure from failure

    def source_parameters(p: Array, v: Array) -> dict[str, Array]:
        return {"l_R": p, "u_R": v}

    member = Member(name, tooth, source_parameters, overhang=spec.overhang)
    if table is None:
        return member
    if table.bolts is not None:
        member = replace(member, features=BodyFeatures(row=_bolt_row(member, table.bolts)))
    return with_end_chamfers(with_modifications(member, table), table)


def _bolt_row(member: Member, bolts: BoltRow) -> HoleRow:
    """The bolt holes of a bar. Raises DesignError naming key, value and limit where they do not stay in it."""
    key, tooth = f"{member.name}.bolts", member.tooth
    root, back = float(tooth.blank.root.at(0.0)), tooth.blank.body.profile[0][0]
    # the ends go along the tooth traces, so that holes are nearest to one of them on one of the faces
    places, middle = tooth.joint.places(tooth.teeth), tooth.root_middle(np.array(tooth.blank.extent))
    ways = tooth.joint.to(np.array([places[0], places[-1] + 1]) * tooth.pitch_angle).translation[:, 1:2]
    ends = middle + ways + member.overhang * np.array([[-1.0], [1.0]])
    first, last = float(ends[0].max()), float(ends[1].min())
    pitch = float(ends[1, 0] - ends[0, 0]) / bolts.count if bolts.pitch is None else bolts.pitch
    height = 0.5 * (root - back) if bolts.height is None else bolts.height
    row = HoleRow(bolts.count, bolts.diameter, pitch, back + height, float(ends.mean()), bolts.depth)
    if bolts.count > 1 and not bolts.diameter < pitch:
        raise DesignError(
            f"{key}.pitch",
            pitch,
            unit="mm",
            reason="the holes overlap",
            allowed=f"more than {at_least(bolts.diameter)} mm",
        )
    low, high = row.reach
    least = LEAST_RIM * float(tooth.blank.tip.at(0.0) - root)
    if high > root - least:
        left = max(root - high, 0.0)
        raise DesignError(
            f"{key}.{'diameter' if bolts.height is None else 'height'}",
            bolts.diameter if bolts.height is None else height,
            unit="mm",
            reason=f"leaves {f'a rim of {left:.3g} mm' if left else 'no rim'} at the roots",
            allowed=f"at least {at_least(least)} mm of rim, {LEAST_RIM:g} whole depths",
        )
    if not low > back:
        raise DesignError(
            f"{key}.height",
            height,
            unit="mm",
            reason="the holes break out of the back",
            allowed=f"more than {at_least(0.5 * bolts.diameter)} mm",
        )
    reach = np.abs(row.centres[[0, -1], 1] - row.middle).max() + 0.5 * bolts.diameter
    room = min(row.middle - first, last - row.middle)
    if not reach < room:
        most = (2.0 * room - bolts.diameter) / max(bolts.count - 1, 1)
        stated = "pitch" if bolts.pitch is not None else "count"
        raise DesignError(
            f"{key}.{stated}",
            pitch if bolts.pitch is not None else bolts.count,
            unit="mm" if bolts.pitch is not None else "",
            reason="the holes break out of the ends of the bar",
            allowed=f"{'' if stated == 'pitch' else 'a pitch of '}less than {at_most(most)} mm"
            if most > bolts.diameter
            else "fewer or smaller holes",
        )
    width = float(np.ptp(tooth.blank.extent))
    if bolts.depth is not None and not bolts.depth < width:
        raise DesignError(
            f"{key}.depth", bolts.depth, unit="mm", allowed=f"less than the face width, {at_most(width)} mm"
        )
    return row


def _side(rack: RackTooth, helix: float, side: int) -> ToothSide:
    """A side of the rack: the profile itself, swept along the tooth trace."""
    flank, fillet = (RackSurface(profile, helix, 0.0, side) for profile in (rack.flank, rack.rounding))
    tool = ToolDescription(
        "planing tool",
        profile=rack.flank,
        tip=rack.rounding,
        tip_radius=abs(rack.rounding.radius),
        zero=HeightZero.PITCH_PLANE,
    )
    return ToothSide(flank, fillet, rack.form_point, root=ROOT, tip=rack.tip, tool=tool)


def rack_mount(pinion: Toothing, distance: float, flank: Side, errors: Rigid | None = None) -> Mount:
    """Mounting of a rack: at phi2 = 0 with a space before the pinion's tooth that is on +x at phi1 = 0, whose `flank` drives.

    `errors`: by which rack and guide are moved from there, about the middle of the reference plane before the pinion.
    """
    joint = Prismatic(pinion.radius, 2.0 * math.pi / pinion.teeth)
    middle = np.array([distance, 0.0, 0.0])
    off = Rigid.identity() if errors is None else errors
    about = Rigid(np.eye(3), middle) @ off @ Rigid(np.diag([-1.0, -1.0, 1.0]), np.zeros(3))
    return Mount(about, zero=-0.5 * flank.sign * joint.step, joint=joint)


def rack_pair(pinion: Member, rack: Member, flank: Side, delta: float) -> GearPair:
    """Both mounted members, the pinion driving with a flank."""
    return GearPair(pinion, rack, (flank, flank), drive=flank.sign, ratio=1.0, delta=delta)
