"""A rack as a member, and its mounting to its pinion [ISO 21771, ISO 53].

The rack rolls on its pinion as the basic rack does. Its flanks are planes, its root fillets cylinders along the tooth
traces, and its lands planes. In its own frame x points out of the bar; x = 0 is the reference plane, on which tooth and
space are equally wide except for allowances. y is along the bar. z is across the bar, with the middle of the face at z
= 0, where one tooth is centred on y = 0. Lengths are in mm, angles in rad.

The fixed frame is the pinion's, as in `build`. The rack's reference plane is at x = `distance`, and its teeth point to
the pinion's axis. The rack's coordinate phi2 (rad) is its displacement over the radius of the pinion's reference
cylinder. This cylinder rolls on the rack without slip for any profile shift and distance. The displacement grows
towards -y of the fixed frame.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.joint import Prismatic
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.surface.flat import FlatLevel
from gearmesh.kernel.surface.levels import PlaneLevel
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.records import dataclass
from gearmesh.systems.common.bodies.body import LEAST_RIM
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.micro_geometry import with_modifications
from gearmesh.systems.common.racks.rack_member import ROOT_PARAMETER, rack_parameters
from gearmesh.systems.common.racks.rack_tooth import Heights, RackTooth, round_tips, tip_roundings
from gearmesh.systems.common.tooth_edges import check_beside_holes, edge_refusal, tip_edge, with_end_chamfers
from gearmesh.systems.cylindrical.geometry.geometry import Toothing, mean_of
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
    """Teeth of a rack; lengths are in the unit of the pinion's lengths."""

    #: number of teeth
    teeth: int
    #: face width
    face_width: float
    #: height of the bar from its back to the tips
    height: float
    #: addendum, normal modules
    addendum: float = 1.0
    #: dedendum, normal modules
    dedendum: float = 1.25
    #: radius of the root fillets, normal modules
    tool_tip_radius: float = 0.38
    #: radius of the root fillets of the coast side, normal modules; None: as on the drive side
    coast_tool_tip_radius: float | None = None
    #: allowance of the normal tooth thickness
    allowance: float = 0.0
    #: length of the bar beyond the last pitch, at either end
    overhang: float = 0.0


@dataclass(frozen=True)
class RackMesh:
    """A pinion and a rack in closed form."""

    #: teeth of the pinion
    pinion: Toothing
    #: teeth of the rack
    rack: RackProportions
    #: tip radius of the pinion; NaN while it is not known
    tip: float
    #: distance of the pinion's axis from the reference plane
    distance: float

    @property
    def pitch(self) -> float:
        """Transverse pitch, along the rack."""
        return math.pi * self.pinion.transverse_module

    @property
    def travel(self) -> float:
        """Travel of the rack per turn of the pinion."""
        return self.pinion.teeth * self.pitch

    @property
    def length(self) -> float:
        """Length of the bar."""
        return self.rack.teeth * self.pitch + 2.0 * self.rack.overhang

    @property
    def above(self) -> float:
        """Distance of the reference plane from the pinion's reference cylinder."""
        return self.distance - self.pinion.radius

    @property
    def pitch_height(self) -> float:
        """Height of the reference plane over the back of the bar."""
        return self.rack.height - self.rack.addendum * self.pinion.module

    @property
    def mounting_distance(self) -> float:
        """Distance of the pinion's axis from the back of the bar."""
        return self.distance + self.pitch_height

    @property
    def sides(self) -> tuple[RackMesh, ...]:
        """Meshes of the flanks of each side: drive and coast side, or this mesh alone if it is symmetric."""
        return tuple(self if own is self.pinion else replace(self, pinion=own) for own in self.pinion.sides)

    def working_side(self, flank: Side) -> RackMesh:
        """Return the mesh of the side that works when the right or the left flanks of the pinion drive."""
        return self.sides[0 if flank is self.pinion.drive else -1]

    @property
    def transverse_tangents(self) -> float:
        """Sum of tan(alpha_t) of both sides: growth of the transverse thickness with the height."""
        return 2.0 * mean_of([math.tan(side.alpha_t) for side in self.pinion.sides])

    @property
    def working_angle(self) -> float:
        """Transverse working pressure angle: the basic rack's, at any distance."""
        return self.pinion.alpha_t

    @property
    def rack_thickness(self) -> float:
        """Normal tooth thickness of the rack on its reference plane."""
        return 0.5 * math.pi * self.pinion.module + self.rack.allowance

    @property
    def rack_land(self) -> float:
        """Normal width of the rack's top lands."""
        return self.rack_thickness - self.rack.addendum * self.pinion.module * self.pinion.both_tangents

    @property
    def circumferential_backlash(self) -> float:
        """Transverse backlash j_wt along the rack: part of the pitch that the teeth leave free."""
        own = self.pinion
        rack = self.rack_thickness / math.cos(own.beta) - self.above * self.transverse_tangents
        return self.pitch - own.thickness / math.cos(own.beta) - rack

    @property
    def normal_backlash(self) -> float:
        """Normal backlash j_bn = j_wt cos(alpha_wt) cos(beta_b)."""
        return self.normal_of(self.circumferential_backlash)

    @property
    def normal_backlashes(self) -> tuple[float, ...]:
        """Normal backlash to the flanks of drive and coast side, or the one of symmetric teeth."""
        return tuple(side.normal_of(self.circumferential_backlash) for side in self.sides)

    def normal_of(self, circumferential: float) -> float:
        """Return the normal backlash for a backlash along the rack."""
        return circumferential * math.cos(self.working_angle) * math.cos(self.pinion.beta_b)

    @property
    def radial_backlash(self) -> float:
        """Radial backlash j_r: change of the distance that eliminates it."""
        return self.circumferential_backlash / self.transverse_tangents

    @property
    def generator(self) -> float:
        """Roll length of the pinion at the pitch point C."""
        return self.pinion.base_radius * math.tan(self.pinion.alpha_t)

    def roll_length_at(self, height: float) -> float:
        """Return the roll length of the pinion at contact with the rack at a `height` over its reference plane."""
        return self.generator - (height - self.above) / math.sin(self.pinion.alpha_t)

    def rack_height(self, length: float) -> float:
        """Return the height over the rack's reference plane at contact at the pinion's roll length."""
        return self.above - (length - self.generator) * math.sin(self.pinion.alpha_t)

    def sliding(self, length: float) -> tuple[float, float]:
        """Return the specific sliding of pinion and rack at a roll length of the pinion.

        zeta = 1 - (speed of the mating gear along the flank) / (speed of the member itself). It is -inf where the
        pinion's flank is at rest, at its base circle.
        """
        return (1.0 - self.generator / length if length > 0.0 else -math.inf), 1.0 - length / self.generator

    @property
    def transverse_contact_ratio(self) -> float:
        """Path of contact from the rack's tip plane to the pinion's tip, over the base pitch.

        It holds for pinions whose involute extends to where it meets the rack's tips.
        """
        own = self.pinion
        begins = self.roll_length_at(self.rack.addendum * own.module)
        return (own.roll_length(self.tip) - begins) / own.base_pitch

    @property
    def overlap_ratio(self) -> float:
        return self.rack.face_width * math.sin(abs(self.pinion.beta)) / (math.pi * self.pinion.module)

    @property
    def root_clearance(self) -> float:
        """Clearance (mm) of the pinion's tips over the rack's root."""
        return self.distance + self.rack.dedendum * self.pinion.module - self.tip


def rack_member(name: str, spec: RackProportions, pinion: Toothing, table: RackTable | None = None) -> Member:
    """Return a rack (in mm) that meshes with a pinion, without its mounting; its helix has the other hand.

    `table`: its part of the design, which gives broken edges and modifications of flanks.

    Raises DesignError naming key, value and limit: no room for the fillet, no tooth, no bar, or a tip edge larger than
    the tooth.
    """
    m, helix = pinion.module, -pinion.beta
    heights = Heights(spec.addendum * m, -spec.dedendum * m)
    # flanks are the lines of the basic rack, set apart by the allowance
    on_right, on_left = (
        RackLine(pinion.side(side).alpha, m, 0.25 * math.pi * m + 0.5 * spec.allowance) for side in Side
    )
    roundings = tip_roundings(spec, pinion.drive.other)
    right, left = (
        _side(rack, helix, side)
        for rack, side in zip(round_tips(name, spec, m, (on_right, on_left), heights, roundings), (1, -1), strict=True)
    )
    depth, back = (spec.addendum + spec.dedendum) * m, heights.tip - spec.height
    if not spec.height > depth:
        raise DesignError(
            f"{name}.height",
            spec.height,
            unit="mm",
            reason="the root lies below the back of the bar",
            allowed=Allowed.more_than(depth, "mm", "the teeth's"),
        )
    # the rack slides: an angle of its coordinate is an arc of the pinion's reference cylinder
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
        tip_edge=None if table is None else tip_edge(table, joint, pinion.drive.other),
        joint=joint,
    )
    try:
        tooth.prove()
    except TrimError as failure:
        raise edge_refusal(name, tooth, failure) or failure from failure

    member = Member(name, tooth, rack_parameters("l_R", "u_R"), overhang=spec.overhang)
    return member if table is None else with_end_chamfers(with_modifications(member, table), table)


def with_bolts(rack: Member, table: RackTable) -> Member:
    """Return a rack with the bolt holes of its table.

    Raises DesignError naming key, value and limit if the holes do not stay in the bar, or if chamfers of its end faces
    reach them.
    """
    if table.bolts is None:
        return rack
    bolted = replace(rack, features=BodyFeatures(row=_bolt_row(rack, table.bolts)))
    # chamfers are cut once more, beside the holes; halves keep theirs, which differ at both ends
    if bolted.halves[1:]:
        check_beside_holes(bolted, table)
        return bolted
    return with_end_chamfers(bolted, table)


def _bolt_row(member: Member, bolts: BoltRow) -> HoleRow:
    """Return the bolt holes of a bar.

    Raises DesignError naming key, value and limit if the holes do not stay in the bar.
    """
    key, tooth = f"{member.name}.bolts", member.tooth
    root, back = float(tooth.blank.root.at(0.0)), tooth.blank.body.profile[0][0]
    root = min((root, *(gap.floor for gap in member.gaps)))
    # the ends of the bar run along the tooth traces: on helical teeth the nearest point of an end is on a face
    places, middle = tooth.joint.places(tooth.teeth), tooth.root_middle(np.array(tooth.blank.extent))
    displacements = tooth.joint.to(np.array([places[0], places[-1] + 1]) * tooth.pitch_angle).translation[:, 1:2]
    ends = middle + displacements + member.overhang * np.array([[-1.0], [1.0]])
    start, end = float(ends[0].max()), float(ends[1].min())
    pitch = float(ends[1, 0] - ends[0, 0]) / bolts.count if bolts.pitch is None else bolts.pitch
    height = 0.5 * (root - back) if bolts.height is None else bolts.height
    row = HoleRow(bolts.count, bolts.diameter, pitch, back + height, float(ends.mean()), bolts.depth)
    if bolts.count > 1 and not bolts.diameter < pitch:
        raise DesignError(
            f"{key}.pitch",
            pitch,
            unit="mm",
            reason="the holes overlap",
            allowed=Allowed.more_than(bolts.diameter, "mm"),
        )
    # the holes must leave a rim below the roots, and stay above the back
    low, high = row.reach
    least = LEAST_RIM * float(tooth.blank.tip.at(0.0) - root)
    if high > root - least:
        remaining_rim = max(root - high, 0.0)
        raise DesignError(
            f"{key}.{'diameter' if bolts.height is None else 'height'}",
            bolts.diameter if bolts.height is None else height,
            unit="mm",
            reason=f"leaves {f'a rim of {remaining_rim:.3g} mm' if remaining_rim else 'no rim'} at the roots",
            allowed=f"at least {at_least(least)} mm of rim, {LEAST_RIM:g} whole depths",
        )
    if not low > back:
        raise DesignError(
            f"{key}.height",
            height,
            unit="mm",
            reason="the holes break out of the back",
            allowed=Allowed.more_than(0.5 * bolts.diameter, "mm"),
        )
    # the outermost holes must stay between the ends of the bar
    reach = np.abs(row.centres[[0, -1], 1] - row.middle).max() + 0.5 * bolts.diameter
    room = min(row.middle - start, end - row.middle)
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
    width = float(np.ptp(member.plain_body.ends))
    if bolts.depth is not None and not bolts.depth < width:
        raise DesignError(
            f"{key}.depth", bolts.depth, unit="mm", allowed=Allowed.less_than(width, "mm", "the face width")
        )
    return row


def _side(rack: RackTooth, helix: float, side: int) -> ToothSide:
    """Return one side of the rack: the profile itself, swept along the tooth trace."""
    flank, fillet = (RackSurface(profile, helix, 0.0, side) for profile in (rack.flank, rack.rounding))
    tool = ToolDescription(
        "planing tool",
        profile=rack.flank,
        tip=rack.rounding,
        tip_radius=abs(rack.rounding.radius),
        zero=HeightZero.PITCH_PLANE,
    )
    return ToothSide(flank, fillet, rack.form_point, root=ROOT_PARAMETER, tip=rack.tip, tool=tool)


def rack_mount(pinion: Toothing, distance: float, flank: Side, errors: Rigid | None = None) -> Mount:
    """Return the mounting of a rack.

    At phi2 = 0 a space faces the pinion's tooth that is on +x at phi1 = 0 and whose `flank` drives.

    `errors`: displacement of rack and guide, about the middle of the reference plane in front of the pinion.
    """
    joint = Prismatic(pinion.radius, 2.0 * math.pi / pinion.teeth)
    middle = np.array([distance, 0.0, 0.0])
    off = Rigid.identity() if errors is None else errors
    about = Rigid(np.eye(3), middle) @ off @ Rigid(np.diag([-1.0, -1.0, 1.0]), np.zeros(3))
    return Mount(about, zero=-0.5 * flank.sign * joint.step, joint=joint)


def rack_pair(pinion: Member, rack: Member, flank: Side, delta: float) -> GearPair:
    """Return both mounted members; the pinion drives with a flank."""
    return GearPair(pinion, rack, (flank, flank), drive=flank.sign, ratio=1.0, delta=delta)
