"""Blanks by the dimensions of ISO 23509, as the cutters of this kind make them: of pairs with offset, and of all tapers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearmesh.errors import DesignError, VagueError
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.common.bounds import at_most
from gearmesh.systems.spiral_bevel.blank.blank import (
    CUTTER_SHARE,
    BasicData,
    BevelBlank,
    MemberBlank,
    Proportions,
    check_root_angle,
    gear_cutter,
    nominal_radius,
    wide_face,
)
from gearmesh.systems.spiral_bevel.iso23509.blank_cones import lean_of_plane
from gearmesh.systems.spiral_bevel.iso23509.dimensions import (
    BevelDimensions,
    MemberDimensions,
    ToothDepth,
    bevel_dimensions,
)
from gearmesh.systems.spiral_bevel.iso23509.methods import OffsetPair, with_offset
from gearmesh.systems.spiral_bevel.iso23509.pitch_cones import PitchCones
from gearmesh.systems.spiral_bevel.iso23509.tooth_factors import (
    CLEARANCE_FACTOR,
    ToothFactors,
    suggested_addendum_factor,
    suggested_depth_factor,
    suggested_thickness_factor,
)
from gearmesh.systems.spiral_bevel.iso23509.tooth_line import FaceCutter


@dataclass(frozen=True)
class OffsetData:
    """Basic data of a pair with offset; (pinion, gear) each, `module` outer transverse, `spiral_angle` the pinion's,
    `pressure_angle` nominal; lengths in mm, angles in rad. `offset` is > 0 where it makes the pinion's spiral angle the larger one.

    `taper` is one of iso23509's, `limit_share` f_alim. The cutter's radius is that of a nominal one unless given.
    """

    teeth: tuple[int, int]
    module: float
    offset: float
    spiral_angle: float
    shaft_angle: float
    pressure_angle: float
    taper: str
    limit_share: float
    given_face_width: float | None = None
    given_cutter_radius: float | None = None

    @property
    def pair(self) -> OffsetPair:
        """What method 1 starts from. Raises DesignError, naming the key."""
        diameter, width = self.module * self.teeth[1], self.given_face_width
        rough = OffsetPair(
            method=1,
            teeth=self.teeth,
            shaft_angle=self.shaft_angle,
            offset=self.offset,
            diameter=diameter,
            face_width=self.module if width is None else width,
            spiral_angle=self.spiral_angle,
            cutter=FaceCutter(diameter),
        )
        outer = float(0.5 * diameter / np.sin(rough.estimate))
        width = min(0.3 * outer, 10.0 * self.module) if width is None else width
        radius = self.given_cutter_radius
        if radius is None:
            radius = nominal_radius(CUTTER_SHARE * (outer - 0.5 * width))
        return replace(rough, face_width=width, cutter=FaceCutter(radius))


@dataclass(frozen=True)
class ConeData:
    """What the dimensions of a pair follow from: its pitch cones, cutter, nominal pressure angle (rad), taper, and f_alim."""

    pitch: PitchCones
    cutter: FaceCutter
    pressure_angle: float
    taper: str
    limit_share: float = 1.0

    @staticmethod
    def of_bevel(data: BasicData, cutter_radius: float | None, taper: str) -> ConeData:
        """Of a pair without offset. Raises DesignError, naming the key."""
        radius = nominal_radius(CUTTER_SHARE * data.mean_cone_distance) if cutter_radius is None else cutter_radius
        return ConeData(data.pitch_cones, FaceCutter(radius), data.pressure_angle, taper)

    @staticmethod
    def of_hypoid(data: OffsetData) -> ConeData:
        """Of a pair with offset, by method 1. Raises DesignError, naming the key."""
        pair = data.pair
        return ConeData(with_offset(pair), pair.cutter, data.pressure_angle, data.taper, data.limit_share)


def cone_blank(data: ConeData, given: Proportions, backlash: float = 0.0) -> BevelBlank:
    """The blank of a pair all of whose cones follow from the gear's unless `given` says otherwise.

    What is suggested for factors that are not given is meant for pairs without offset. Raises DesignError for a blank that
    cannot exist, naming the key.
    """
    dimensions = cone_dimensions(data, given)
    pitch = dimensions.pitch
    drive, coast = dimensions.drive.generated, dimensions.coast.generated
    wheel = dimensions.wheel
    above_tip = float(wheel.mean_depth.dedendum * np.cos(wheel.dedendum_angle))
    cut = gear_cutter(pitch.mean_normal_module, dimensions.pinion.normal_thickness, backlash, (drive, coast), above_tip)
    pinion = _leant(_member(dimensions.pinion, cut.thicknesses[0]), given.face_angles[0], given.root_angles[0])
    gear = _member(wheel, cut.thicknesses[1])
    for name, own, root in zip(("pinion", "gear"), (pinion, gear), given.root_angles, strict=True):
        if root is not None:
            if not pitch.offset:
                check_root_angle(name, root, own.pitch_angle)
            _check_ends(name, own)
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
        azimuths=_azimuths(pitch),
        warnings=wide_face(wheel.face.width, wheel.cone_distances[0]),
    )


def _check_ends(name: str, own: MemberBlank) -> None:
    """Refuse a given root cone that leaves teeth no dedendum at one of their ends. Raises DesignError."""
    ends = np.array(own.extent) - own.mean_cone_distance
    dedenda = own.mean_dedendum + ends * np.tan(own.dedendum_angle)
    for end, dedendum in zip(("toe", "heel"), dedenda, strict=True):
        if not dedendum > 0.0:
            raise VagueError(
                name,
                reason=f"the root cone, through the root at the mean point, rises over the pitch cone at the {end}",
                allowed=f"a root angle nearer to the pitch angle, {np.degrees(own.pitch_angle):.6g} deg",
            )


def cone_dimensions(data: ConeData, given: Proportions) -> BevelDimensions:
    """All dimensions by ISO 23509 without backlash, the gear's cones as given or by the taper; those of the pinion follow.

    Raises DesignError, naming the key, for a blank that cannot exist.
    """
    pitch, cutter = data.pitch, data.cutter
    teeth, depth = pitch.teeth, given.depth_factor
    depth = suggested_depth_factor(teeth) if depth is None else depth
    working, share = depth * pitch.mean_normal_module, given.addendum_factor
    gap = CLEARANCE_FACTOR * working if given.clearance is None else given.clearance
    if not gap < 0.5 * working:
        raise DesignError(
            "clearance", gap, unit="mm", allowed=f"less than half the mean working depth, {at_most(0.5 * working)} mm"
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
    angle, tapers = dimensions.wheel.pitch_angle, (dimensions.wheel.addendum_angle, dimensions.wheel.dedendum_angle)
    if face is not None:
        tapers = face - angle, tapers[1]
    elif pinion_root is not None:
        tapers = -lean_of_plane(pitch, pinion_root), tapers[1]
    if root is not None:
        tapers = tapers[0], angle - root
    return bevel_dimensions(pitch, cutter, factors, tapers)


def _member(own: MemberDimensions, thickness: float) -> MemberBlank:
    mean, outer = own.mean_cone_distance, own.cone_distances[0]
    at_mean, at_heel = _depth(own, mean), _depth(own, outer)
    return MemberBlank(
        teeth=own.teeth,
        pitch_angle=own.pitch_angle,
        root_angle=own.root_angle,
        face_angle=own.face_angle,
        tip_radius=float(own.face_apex * np.tan(own.face_angle)),
        mean_addendum=at_mean.addendum,
        mean_dedendum=at_mean.dedendum,
        outer_addendum=at_heel.addendum,
        outer_dedendum=at_heel.dedendum,
        thickness=thickness,
        spiral_angle=own.mean_spiral_angle,
        end_spiral_angles=own.spiral_angles,
        mean_cone_distance=own.mean_cone_distance,
        outer_cone_distance=outer,
        face_width=own.face.width,
        pitch_apex=own.pitch_apex,
        root_apex=own.root_apex,
    )


def _depth(own: MemberDimensions, cone_distance: float) -> ToothDepth:
    """Addendum and dedendum (mm) between the cones themselves, of which the standard's depths miss some micrometres of a pinion."""
    face, root = own.face_angle - own.pitch_angle, own.pitch_angle - own.root_angle
    higher = (own.face_apex - own.pitch_apex) * np.sin(own.face_angle)
    deeper = (own.root_apex - own.pitch_apex) * np.sin(own.root_angle)
    return ToothDepth(
        float((cone_distance * np.sin(face) + higher) / np.cos(face)),
        float((cone_distance * np.sin(root) - deeper) / np.cos(root)),
    )


def _leant(own: MemberBlank, face: float | None, root: float | None) -> MemberBlank:
    """The member with a face and a root angle of its own, about tip and root at the mean."""
    c, s = np.cos(own.pitch_angle), np.sin(own.pitch_angle)
    mean, longer = own.mean_cone_distance * c - own.pitch_apex, own.outer_cone_distance - own.mean_cone_distance
    if face is not None:
        rho, z = own.mean_radius + own.mean_addendum * c, mean - own.mean_addendum * s
        outer = own.mean_addendum + longer * np.tan(face - own.pitch_angle)
        own = replace(own, face_angle=face, tip_radius=float(rho - z * np.tan(face)), outer_addendum=float(outer))
    if root is not None:
        rho, z = own.mean_radius - own.mean_dedendum * c, mean + own.mean_dedendum * s
        outer = own.mean_dedendum + longer * np.tan(own.pitch_angle - root)
        own = replace(own, root_angle=root, root_apex=float(rho / np.tan(root) - z), outer_dedendum=float(outer))
    return own


def _azimuths(pitch: PitchCones) -> tuple[float, float]:
    """Azimuths (rad) of the mean point of a right-hand pinion about both axes, from the plane of their directions."""
    first, second = (0.5 * diameter for diameter in pitch.mean_diameters)
    y = second * np.sin(pitch.axial_offset_angle) - pitch.offset
    at = np.array([np.sqrt(first**2 - y**2), y, pitch.crossing_distances[0]])
    own = gear_base(pitch.shaft_angle, -pitch.offset).inverse.point(at)
    return float(np.arctan2(at[1], at[0])), float(np.arctan2(own[1], own[0]))
