"""Blanks by the dimensions of ISO 23509 for the cutters of this kind: pairs with offset, and pairs with any taper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError, VagueError
from gearmesh.records import dataclass
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.common.bevel.blank import (
    CUTTER_RADIUS_SHARE,
    BasicData,
    BevelBlank,
    MemberBlank,
    Proportions,
    check_root_angle,
    gear_cutter,
    nominal_radius,
    wide_face,
)
from gearmesh.systems.common.bevel.iso23509.blank_cones import lean_of_plane
from gearmesh.systems.common.bevel.iso23509.dimensions import (
    BevelDimensions,
    MemberDimensions,
    ToothDepth,
    bevel_dimensions,
)
from gearmesh.systems.common.bevel.iso23509.methods import OffsetPair, with_offset
from gearmesh.systems.common.bevel.iso23509.pitch_cones import PitchCones
from gearmesh.systems.common.bevel.iso23509.tooth_factors import (
    CLEARANCE_FACTOR,
    ToothFactors,
    suggested_addendum_factor,
    suggested_depth_factor,
    suggested_thickness_factor,
)
from gearmesh.systems.common.bevel.iso23509.tooth_line import FaceCutter


@dataclass(frozen=True)
class OffsetData:
    """Basic data of a pair with offset; tuples are (pinion, gear)."""

    #: numbers of teeth
    teeth: tuple[int, int]
    #: outer transverse module of the gear, mm
    module: float
    #: offset of the axes, mm; > 0 makes the pinion's spiral angle the larger one
    offset: float
    #: mean spiral angle of the pinion, rad
    spiral_angle: float
    #: shaft angle, rad
    shaft_angle: float
    #: nominal pressure angle, rad
    pressure_angle: float
    #: depth taper, a name in `iso23509.taper_names.TAPER_NAMES`
    taper: str
    #: f_alim: share of the limit pressure angle by which the blade angles differ from the nominal pressure angle
    limit_share: float
    #: face width of the gear, mm; None for the suggested width
    given_face_width: float | None = None
    #: radius of the cutter, mm; None for a nominal cutter
    given_cutter_radius: float | None = None
    #: number of blade groups of the cutter; 0 in face milling
    blade_groups: int = 0
    #: method of ISO 23509: 1, or 2 and 3 of face hobbing, by which `spiral_angle` is that of the gear
    method: int = 1

    @property
    def rough_mean(self) -> tuple[float, float]:
        """Mean cone distance and mean normal module, mm, by the estimated pitch angle of the gear.

        Raises DesignError, naming the key.
        """
        rough = replace(self, given_cutter_radius=self.module).pair
        sine = float(np.sin(rough.estimate))
        mean = 0.5 * (rough.diameter / sine - rough.face_width)
        spiral = self.spiral_angle
        if self.method == 1:
            # the spiral angle of the gear is smaller by about the offset angle
            spiral -= float(
                np.arcsin(np.clip(self.offset / (mean * sine * (1.0 + self.teeth[0] / self.teeth[1])), -1.0, 1.0))
            )
        return mean, float(2.0 * mean * sine * np.cos(spiral) / self.teeth[1])

    @property
    def pair(self) -> OffsetPair:
        """Input of the method of ISO 23509. Raises DesignError, naming the key."""
        diameter, width = self.module * self.teeth[1], self.given_face_width
        rough = OffsetPair(
            method=self.method,
            teeth=self.teeth,
            shaft_angle=self.shaft_angle,
            offset=self.offset,
            diameter=diameter,
            face_width=self.module if width is None else width,
            spiral_angle=self.spiral_angle,
            cutter=FaceCutter(diameter, self.blade_groups),
            by_outer=True,
        )
        # the outer cone distance by the estimated pitch angle gives the suggested face width and cutter
        outer = float(0.5 * diameter / np.sin(rough.estimate))
        width = min(0.3 * outer, 10.0 * self.module) if width is None else width
        radius = self.given_cutter_radius
        if radius is None:
            radius = nominal_radius(CUTTER_RADIUS_SHARE * (outer - 0.5 * width))
        return replace(rough, face_width=width, cutter=FaceCutter(radius, self.blade_groups))


@dataclass(frozen=True)
class ConeData:
    """Data from which the dimensions of a pair follow."""

    #: pitch cones of both members
    pitch: PitchCones
    #: face cutter of the gear
    cutter: FaceCutter
    #: nominal pressure angle, rad
    pressure_angle: float
    #: depth taper, a name in `iso23509.taper_names.TAPER_NAMES`
    taper: str
    #: f_alim: share of the limit pressure angle by which the blade angles differ from the nominal pressure angle
    limit_share: float = 1.0

    @staticmethod
    def of_bevel(data: BasicData, cutter_radius: float | None, taper: str) -> ConeData:
        """Return the data of a pair without offset. Raises DesignError, naming the key."""
        radius = (
            nominal_radius(CUTTER_RADIUS_SHARE * data.mean_cone_distance) if cutter_radius is None else cutter_radius
        )
        return ConeData(data.pitch_cones, FaceCutter(radius), data.pressure_angle, taper)

    @staticmethod
    def of_hypoid(data: OffsetData) -> ConeData:
        """Return the data of a pair with offset, by its method. Raises DesignError, naming the key."""
        pair = data.pair
        return ConeData(with_offset(pair), pair.cutter, data.pressure_angle, data.taper, data.limit_share)


def cone_blank(data: ConeData, given: Proportions, backlash: float = 0.0) -> BevelBlank:
    """Return the blank of a pair whose cones all follow from the gear's cones unless `given` sets them.

    Suggested factors are meant for pairs without offset. Raises DesignError for a blank that cannot exist, naming the
    key.
    """
    dimensions = cone_dimensions(data, given)
    pitch = dimensions.pitch
    drive, coast = dimensions.drive.generated, dimensions.coast.generated
    wheel = dimensions.wheel
    above_tip = float(wheel.mean_depth.dedendum * np.cos(wheel.dedendum_angle))
    cut = gear_cutter(pitch.mean_normal_module, dimensions.pinion.normal_thickness, backlash, (drive, coast), above_tip)
    pinion = _leant(_member(dimensions.pinion, cut.thicknesses[0]), given.face_angles[0], given.root_angles[0])
    gear = _member(wheel, cut.thicknesses[1])
    for name, member, root in zip(("pinion", "gear"), (pinion, gear), given.root_angles, strict=True):
        if root is not None:
            if not pitch.offset:
                check_root_angle(name, root, member.pitch_angle)
            _check_ends(name, member)
    return BevelBlank(
        pinion=pinion,
        gear=gear,
        shaft_angle=pitch.shaft_angle,
        pressure_angle=dimensions.pressure_angle,
        # the drive side is the gear's convex one, which inside blades cut
        blade_angles=(drive, coast),
        mean_normal_module=pitch.mean_normal_module,
        clearance=dimensions.clearance,
        mean_depth=dimensions.working_depth + 2.0 * dimensions.clearance,
        cutter_radius=data.cutter.radius,
        point_width=cut.point_width,
        edge_radius=cut.edge_radius,
        standard_depths=(dimensions.pinion.mean_depth, wheel.mean_depth),
        offset=pitch.offset,
        blade_groups=data.cutter.blade_groups,
        azimuths=_azimuths(pitch),
        warnings=wide_face(wheel.face.width, wheel.cone_distances[0]),
    )


def _check_ends(name: str, member: MemberBlank) -> None:
    """Raise VagueError for a given root cone that leaves the teeth no dedendum at toe or heel."""
    ends = np.array(member.extent) - member.mean_cone_distance
    dedenda = member.mean_dedendum + ends * np.tan(member.dedendum_angle)
    for end, dedendum in zip(("toe", "heel"), dedenda, strict=True):
        if not dedendum > 0.0:
            raise VagueError(
                name,
                reason=f"the root cone, through the root at the mean point, rises over the pitch cone at the {end}",
                allowed=f"a root angle nearer to the pitch angle, {np.degrees(member.pitch_angle):.6g} deg",
                excess=-float(dedendum),
            )


def cone_dimensions(data: ConeData, given: Proportions) -> BevelDimensions:
    """Return all dimensions by ISO 23509 without backlash.

    The gear's cones are given or follow from the taper; the pinion's cones follow from the gear's. Raises DesignError,
    naming the key, for a blank that cannot exist.
    """
    pitch, cutter = data.pitch, data.cutter
    teeth, depth = pitch.teeth, given.depth_factor
    depth = suggested_depth_factor(teeth) if depth is None else depth
    working, share = depth * pitch.mean_normal_module, given.addendum_factor
    gap = CLEARANCE_FACTOR * working if given.clearance is None else given.clearance
    if not gap < 0.5 * working:
        raise DesignError(
            "clearance", gap, unit="mm", allowed=Allowed.less_than(0.5 * working, "mm", "half the mean working depth")
        )
    factors = ToothFactors.of_depths(
        (data.pressure_angle, data.pressure_angle),
        data.limit_share,
        suggested_addendum_factor(teeth, pitch.pitch_angles) if share is None else share,
        depth,
        gap / working,
        suggested_thickness_factor(teeth) if given.thickness_factor is None else given.thickness_factor,
    )
    dimensions = bevel_dimensions(pitch, cutter, factors, data.taper)
    (pinion_root, root), face = given.root_angles, given.face_angles[1]
    if face is None and root is None and pinion_root is None:
        return dimensions
    # given angles replace the gear's addendum and dedendum angle: the pinion's root angle sets the gear's face cone
    angle, tapers = dimensions.wheel.pitch_angle, (dimensions.wheel.addendum_angle, dimensions.wheel.dedendum_angle)
    if face is not None:
        tapers = face - angle, tapers[1]
    elif pinion_root is not None:
        tapers = -lean_of_plane(pitch, pinion_root), tapers[1]
    if root is not None:
        tapers = tapers[0], angle - root
    return bevel_dimensions(pitch, cutter, factors, tapers)


def _member(member: MemberDimensions, thickness: float) -> MemberBlank:
    """Return the blank of a member by its dimensions, with a mean normal `thickness` (mm)."""
    mean, outer = member.mean_cone_distance, member.cone_distances[0]
    at_mean, at_heel = _depth(member, mean), _depth(member, outer)
    return MemberBlank(
        teeth=member.teeth,
        pitch_angle=member.pitch_angle,
        root_angle=member.root_angle,
        face_angle=member.face_angle,
        tip_radius=float(member.face_apex * np.tan(member.face_angle)),
        mean_addendum=at_mean.addendum,
        mean_dedendum=at_mean.dedendum,
        outer_addendum=at_heel.addendum,
        outer_dedendum=at_heel.dedendum,
        thickness=thickness,
        spiral_angle=member.mean_spiral_angle,
        end_spiral_angles=member.spiral_angles,
        mean_cone_distance=member.mean_cone_distance,
        outer_cone_distance=outer,
        face_width=member.face.width,
        pitch_apex=member.pitch_apex,
        root_apex=member.root_apex,
    )


def _depth(member: MemberDimensions, cone_distance: float) -> ToothDepth:
    """Return addendum and dedendum (mm) between the cones themselves at a cone distance (mm).

    The standard's depths of a pinion differ from these by some micrometres.
    """
    face, root = member.face_angle - member.pitch_angle, member.pitch_angle - member.root_angle
    higher = (member.face_apex - member.pitch_apex) * np.sin(member.face_angle)
    deeper = (member.root_apex - member.pitch_apex) * np.sin(member.root_angle)
    return ToothDepth(
        float((cone_distance * np.sin(face) + higher) / np.cos(face)),
        float((cone_distance * np.sin(root) - deeper) / np.cos(root)),
    )


def _leant(member: MemberBlank, face: float | None, root: float | None) -> MemberBlank:
    """Return the member with a given face angle and root angle (rad), turned about its tip and root at the mean point."""
    c, s = np.cos(member.pitch_angle), np.sin(member.pitch_angle)
    mean, longer = (
        member.mean_cone_distance * c - member.pitch_apex,
        member.outer_cone_distance - member.mean_cone_distance,
    )
    if face is not None:
        # the tip cone turns about the tip at the mean point
        rho, z = member.mean_radius + member.mean_addendum * c, mean - member.mean_addendum * s
        outer = member.mean_addendum + longer * np.tan(face - member.pitch_angle)
        member = replace(member, face_angle=face, tip_radius=float(rho - z * np.tan(face)), outer_addendum=float(outer))
    if root is not None:
        # the root cone turns about the root at the mean point
        rho, z = member.mean_radius - member.mean_dedendum * c, mean + member.mean_dedendum * s
        outer = member.mean_dedendum + longer * np.tan(member.pitch_angle - root)
        member = replace(member, root_angle=root, root_apex=float(rho / np.tan(root) - z), outer_dedendum=float(outer))
    return member


def _azimuths(pitch: PitchCones) -> tuple[float, float]:
    """Azimuths (rad) of a right-hand pinion's mean point about both axes, from the plane of their directions."""
    pinion_radius, gear_radius = (0.5 * diameter for diameter in pitch.mean_diameters)
    y = gear_radius * np.sin(pitch.axial_offset_angle) - pitch.offset
    mean_point = np.array([np.sqrt(pinion_radius**2 - y**2), y, pitch.crossing_distances[0]])
    in_gear_frame = gear_base(pitch.shaft_angle, -pitch.offset).inverse.point(mean_point)
    return float(np.arctan2(mean_point[1], mean_point[0])), float(np.arctan2(in_gear_frame[1], in_gear_frame[0]))
