"""Blanks of bevel gears without offset, from basic data and the rules of `iso23509`, for the cutters of this kind.

Standard depth taper: in the axial plane the root lines of both members pass through the pitch apex, each at its
dedendum angle below the pitch line. The tip line of a member is parallel to the root line of its mating gear, at the
distance of the clearance. Root angles given without a taper may belong to another taper: see `roots_through_apex`.
Lengths in mm, angles in rad; "mean" is at the mean cone distance, "outer" at the heel.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.iso23509.blank_cones import BlankCones, blank_cones
from gearmesh.systems.common.bevel.iso23509.dimensions import ToothDepth
from gearmesh.systems.common.bevel.iso23509.methods import without_offset
from gearmesh.systems.common.bevel.iso23509.pitch_cones import PitchCones, bevel_pitch_angles, crown_shaft_angle
from gearmesh.systems.common.bevel.iso23509.tapers import standard_dedendum_angle
from gearmesh.systems.common.bevel.iso23509.tooth_factors import (
    CLEARANCE_FACTOR,
    normal_thickness,
    suggested_addendum_factor,
    suggested_depth_factor,
    suggested_thickness_factor,
)
from gearmesh.systems.common.bevel.iso23509.tooth_line import FaceCutter, ToothLine
from gearmesh.systems.common.bounds import at_least, at_most

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.design import BevelDesign

#: nominal cutter diameters, inch
NOMINAL_CUTTER_DIAMETERS_INCH = (1.1, 1.5, 2.0, 2.75, 3.5, 4.5, 5.0, 6.0, 7.5, 9.0, 10.5, 12.0, 14.0, 16.0, 18.0, 21.0)
#: face width over outer cone distance above which the blank has a warning
MAX_USUAL_FACE_SHARE = 0.35
#: largest face angle, deg: a tip cone that is nearly a plane has no apex near the teeth
MAX_FACE_ANGLE_DEG = 89.5
#: face width over outer cone distance at and above which a design is refused
MAX_FACE_SHARE = 0.6
#: face width over outer cone distance at and below which a design is refused
MIN_FACE_SHARE = 1e-4
#: cutter radius over mean cone distance from which the nominal cutter is chosen
CUTTER_RADIUS_SHARE = 0.95
#: largest difference, over the mean whole depth, of root lines that count as passing through the pitch apex; angles
#: printed to the minute differ by 0.003
APEX_DEPTH_TOLERANCE = 0.01
#: largest relative excess of a given root angle over the pitch angle: rounding of uniform depths written to a file
ROOT_ANGLE_ROUNDING = 1e-9


@dataclass(frozen=True)
class MemberBlank:
    """One member of the pair: teeth, cones, depths and thickness, in the member's own frame.

    The origin of the frame is the apex of a pair without offset, else the foot of the common perpendicular of the axes.
    z is along the axis towards the heel. Cone distances count from the pitch apex. Apexes are beyond the origin where
    they are on the side away from the teeth.
    """

    #: number of teeth
    teeth: int
    #: pitch angle, rad
    pitch_angle: float
    #: root angle, rad
    root_angle: float
    #: face angle, rad
    face_angle: float
    #: radius of the tip cone at z = 0, mm: rho = tip_radius + tan(face_angle) z
    tip_radius: float
    #: addendum at the mean cone distance, mm, across the pitch cone
    mean_addendum: float
    #: dedendum at the mean cone distance, mm, across the pitch cone
    mean_dedendum: float
    #: addendum at the heel, mm, across the pitch cone
    outer_addendum: float
    #: dedendum at the heel, mm, across the pitch cone
    outer_dedendum: float
    #: mean normal circular thickness, mm
    thickness: float
    #: mean spiral angle, rad
    spiral_angle: float
    #: spiral angles at heel and toe, rad
    end_spiral_angles: tuple[float, float]
    #: mean cone distance, mm
    mean_cone_distance: float
    #: cone distance of the heel, mm
    outer_cone_distance: float
    #: face width along the pitch cone, mm
    face_width: float
    #: distance of the pitch cone's apex beyond the origin, mm
    pitch_apex: float = 0.0
    #: distance of the root cone's apex beyond the origin, mm
    root_apex: float = 0.0

    @property
    def dedendum_angle(self) -> float:
        return self.pitch_angle - self.root_angle

    @property
    def inner_cone_distance(self) -> float:
        return self.outer_cone_distance - self.face_width

    @property
    def extent(self) -> tuple[float, float]:
        """Cone distances of toe and heel."""
        return self.inner_cone_distance, self.outer_cone_distance

    @property
    def mean_radius(self) -> float:
        """Radius of the pitch circle at the mean cone distance."""
        return float(self.mean_cone_distance * np.sin(self.pitch_angle))

    @property
    def stations(self) -> ConeLevel:
        """Level whose values are cone distances."""
        return self.station(0.0)

    def station(self, cone_distance: float) -> ConeLevel:
        """Return the level that is 0 at a cone distance."""
        return ConeLevel(self.pitch_angle, cone_distance - self.pitch_apex * float(np.cos(self.pitch_angle)))

    @property
    def pitch_cone(self) -> ConeLevel:
        """Level whose value is the height over the pitch cone."""
        return ConeLevel(self.pitch_angle + 0.5 * np.pi, self.pitch_apex * float(np.sin(self.pitch_angle)))

    @property
    def tip(self) -> ConeLevel:
        """The tip cone."""
        return ConeLevel.of(self.tip_radius, float(np.tan(self.face_angle)))

    @property
    def root(self) -> ConeLevel:
        """The root cone."""
        slope = float(np.tan(self.root_angle))
        return ConeLevel.of(self.root_apex * slope, slope)

    def depth_of(self, root: ConeLevel, cone_distance: Array) -> Array:
        """Depths (...,), mm, of a root cone under the pitch cone at cone distances (...,), across the pitch cone."""
        c, s = np.cos(self.pitch_angle), np.sin(self.pitch_angle)
        above = s * cone_distance - root.radius - root.slope * c * cone_distance + root.slope * self.pitch_apex
        return np.asarray(above / (c + root.slope * s))

    def addendum_at(self, cone_distance: Array) -> Array:
        """Heights (...,), mm, of the tip cone over the pitch cone at cone distances (...,), across the pitch cone."""
        s, c, slope = np.sin(self.pitch_angle), np.cos(self.pitch_angle), np.tan(self.face_angle)
        # A point at height h over the pitch cone is on the tip cone where
        # cone_distance s + h c = tip_radius + slope (cone_distance c - pitch_apex - h s)
        under = self.tip_radius - slope * self.pitch_apex
        return np.asarray((under + cone_distance * (slope * c - s)) / (c + slope * s))

    def crown(self, cone_distance: float) -> float:
        """Return the distance (mm) along the axis from the origin to the tip cone at a cone distance."""
        addendum = float(self.addendum_at(np.array(cone_distance)))
        c, s = np.cos(self.pitch_angle), np.sin(self.pitch_angle)
        return float(cone_distance * c - self.pitch_apex - addendum * s)

    def along_root(self, cone_distance: float) -> float:
        """Return the distance (mm), along the root line, of a point of the pitch line from the origin."""
        at_apex = self.pitch_apex * np.cos(self.root_angle)
        return float(cone_distance * np.cos(self.dedendum_angle) - at_apex)

    def root_base(self, root_angle: float) -> float:
        """Sliding base (mm) with which a machine plane at a root angle (rad) passes through the root cone's apex."""
        return float(self.root_apex * np.sin(root_angle))


@dataclass(frozen=True)
class BevelBlank:
    """Blanks of both members and the data that they share."""

    #: blank of the pinion
    pinion: MemberBlank
    #: blank of the gear
    gear: MemberBlank
    #: shaft angle, rad
    shaft_angle: float
    #: mean normal pressure angle, rad
    pressure_angle: float
    #: angles of the gear's inside and outside blades, rad
    blade_angles: tuple[float, float]
    #: mean normal module, mm
    mean_normal_module: float
    #: clearance between tip and mating root, mm
    clearance: float
    #: distance between the root lines of both members across the pitch line at the mean cone distance, mm: working
    #: depth and twice the clearance
    mean_depth: float
    #: mean radius of the gear's cutter, mm
    cutter_radius: float
    #: point width of the gear's cutter, mm
    point_width: float
    #: edge radius of the gear's blades, mm
    edge_radius: float
    #: mean addendum and dedendum of (pinion, gear) by ISO 23509; the standard counts the clearance across the pitch
    #: cones for depths, but across the root lines for cones
    standard_depths: tuple[ToothDepth, ToothDepth]
    #: offset of the axes, mm; > 0 makes the pinion's spiral angle the larger one
    offset: float = 0.0
    #: number of blade groups of a face-hobbing cutter; 0 in face milling
    blade_groups: int = 0
    #: azimuths of the mean point in the frames of pinion and gear, rad, for a right-hand pinion; the x axes are in the
    #: plane of both axes' directions
    azimuths: tuple[float, float] = (0.0, 0.0)
    #: sentences on unusual dimensions
    warnings: tuple[str, ...] = field(default=())

    @property
    def members(self) -> tuple[MemberBlank, MemberBlank]:
        """Pinion and gear."""
        return self.pinion, self.gear

    @property
    def mean_working_depth(self) -> float:
        return self.mean_depth - 2.0 * self.clearance

    @property
    def tooth_line(self) -> ToothLine:
        """Tooth line of the cutter on the gear's crown gear."""
        crown, gear = self.gear.teeth / np.sin(self.gear.pitch_angle), self.gear
        cutter = FaceCutter(self.cutter_radius, self.blade_groups)
        return ToothLine(cutter, gear.mean_cone_distance, gear.spiral_angle, float(crown))


@dataclass(frozen=True)
class BasicData:
    """Basic data of a pair without offset; tuples are (pinion, gear).

    Raises DesignError, naming the key, for pitch cones that cannot exist.
    """

    #: numbers of teeth
    teeth: tuple[int, int]
    #: outer transverse module, mm
    module: float
    #: mean spiral angle, rad
    spiral_angle: float
    #: shaft angle, rad
    shaft_angle: float
    #: mean normal pressure angle, rad
    pressure_angle: float
    #: face width, mm; None for the suggested width
    given_face_width: float | None = None
    #: mean cone distance, mm; None for the middle of the face
    given_mean_cone_distance: float | None = None

    def __post_init__(self) -> None:
        gear, outer = self.pitch_angles[1], self.outer_cone_distance
        if not max(self.pitch_angles) < 0.5 * np.pi:
            raise DesignError(
                "shaft_angle",
                np.degrees(self.shaft_angle),
                unit="deg",
                reason=f"with {self.teeth[0]} and {self.teeth[1]} teeth the gear's pitch angle is {np.degrees(gear):.4g} deg",
                allowed=Allowed.less_than(np.degrees(crown_shaft_angle(self.teeth)), "deg"),
            )
        if not self.face_width < MAX_FACE_SHARE * outer:
            raise DesignError(
                "face_width",
                self.face_width,
                unit="mm",
                allowed=Allowed.less_than(
                    MAX_FACE_SHARE * outer, "mm", note=f", {MAX_FACE_SHARE:g} of the outer cone distance"
                ),
            )
        if not self.face_width > MIN_FACE_SHARE * outer:
            raise DesignError(
                "face_width",
                self.face_width,
                unit="mm",
                allowed=Allowed.more_than(
                    MIN_FACE_SHARE * outer, "mm", note=f", {MIN_FACE_SHARE:g} of the outer cone distance"
                ),
            )
        if not outer - self.face_width < self.mean_cone_distance < outer:
            raise DesignError(
                "mean_cone_distance",
                self.mean_cone_distance,
                unit="mm",
                allowed=f"between {at_least(outer - self.face_width)} (toe) and {at_most(outer)} mm (heel)",
            )

    @property
    def pitch_angles(self) -> tuple[float, float]:
        """Pitch angles of pinion and gear."""
        return bevel_pitch_angles(self.teeth, self.shaft_angle)

    @property
    def pitch_cones(self) -> PitchCones:
        """Pitch cones and mean point by ISO 23509 method 0."""
        return self._cones(self.face_width, self.given_mean_cone_distance)

    def _cones(self, face_width: float, mean: float | None) -> PitchCones:
        diameter = self.module * self.teeth[1]
        return without_offset(self.teeth, self.shaft_angle, diameter, face_width, self.spiral_angle, mean)

    @property
    def outer_cone_distance(self) -> float:
        return self._cones(0.0, None).outer_cone_distance

    @property
    def face_width(self) -> float:
        """Face width: the given width, or 0.3 of the outer cone distance but at most 10 modules."""
        if self.given_face_width is not None:
            return self.given_face_width
        return min(0.3 * self.outer_cone_distance, 10.0 * self.module)

    @property
    def mean_cone_distance(self) -> float:
        return self.pitch_cones.mean_cone_distances[1]

    @property
    def mean_normal_module(self) -> float:
        return self.pitch_cones.mean_normal_module


def basic_data(
    design: BevelDesign, spiral_angle: float, pressure_angle: float, mean_cone_distance: float | None = None
) -> BasicData:
    """Return the basic data of a design (in mm), angles in deg. Raises DesignError for pitch cones that cannot exist."""
    return BasicData(
        (design.pinion.teeth, design.gear.teeth),
        design.given_module,
        spiral_angle=float(np.radians(spiral_angle)),
        shaft_angle=float(np.radians(design.shaft_angle)),
        pressure_angle=float(np.radians(pressure_angle)),
        given_face_width=design.face_width,
        given_mean_cone_distance=mean_cone_distance,
    )


@dataclass(frozen=True)
class Proportions:
    """Tooth proportions given by the design; None stands for the suggestion of ISO 23509. Tuples are (pinion, gear)."""

    #: k_d: mean working depth in mean normal modules
    depth_factor: float | None = None
    #: c_ham: mean addendum of the gear over the mean working depth
    addendum_factor: float | None = None
    #: k_t: mean normal thickness of the pinion beyond half the pitch and the difference of the addenda, in mean normal
    #: modules
    thickness_factor: float | None = None
    #: clearance, mm
    clearance: float | None = None
    #: root angles, rad
    root_angles: tuple[float | None, float | None] = (None, None)
    #: face angles, rad
    face_angles: tuple[float | None, float | None] = (None, None)


def roots_through_apex(data: BasicData, given: Proportions) -> bool:
    """Return True where the given root angles belong to a standard taper, whose root lines pass through the pitch apex.

    Root lines count as passing through the apex if they leave the whole depth that the factors ask for. The depths then
    follow from the root angles, as in [AB]. Root lines of any other taper turn about the root at the mean point [ISO
    23509 (151)].

    Raises DesignError for a clearance that leaves no depth.
    """
    wanted = standard_dedenda(data, given)[0]
    pairs = zip(data.pitch_angles, given.root_angles, wanted, strict=True)
    # the dedendum at the mean point of a root line through the apex, at the given root angle
    depths = [
        dedendum if root is None else data.mean_cone_distance * np.tan(angle - root) for angle, root, dedendum in pairs
    ]
    return bool(abs(sum(depths) - sum(wanted)) <= APEX_DEPTH_TOLERANCE * sum(wanted))


def standard_dedenda(data: BasicData, given: Proportions) -> tuple[tuple[float, float], float]:
    """Return the mean dedenda (mm) of (pinion, gear) by the given or suggested factors, and the clearance (mm).

    Raises DesignError for a clearance that leaves no depth.
    """
    angles, normal = data.pitch_angles, data.mean_normal_module
    working = (suggested_depth_factor(data.teeth) if given.depth_factor is None else given.depth_factor) * normal
    gap = CLEARANCE_FACTOR * working if given.clearance is None else given.clearance
    if not gap < 0.5 * working:
        raise DesignError(
            "clearance", gap, unit="mm", allowed=Allowed.less_than(0.5 * working, "mm", "half the mean working depth")
        )
    share = suggested_addendum_factor(data.teeth, angles) if given.addendum_factor is None else given.addendum_factor
    return (share * working + gap, (1.0 - share) * working + gap), gap


def tapered_blank(
    data: BasicData,
    given: Proportions = Proportions(),
    cutter_radius: float | None = None,
    backlash: float = 0.0,
) -> BevelBlank:
    """Return the blank with standard taper [ISO 23509]: both root lines pass through the apex.

    Raises DesignError for a blank that cannot exist, naming the key.
    """
    angles, mean = data.pitch_angles, data.mean_cone_distance
    wanted, gap = standard_dedenda(data, given)
    roots = []
    for name, angle, dedendum, given_root in zip(("pinion", "gear"), angles, wanted, given.root_angles, strict=True):
        root = angle - standard_dedendum_angle(dedendum, mean) if given_root is None else given_root
        check_root_angle(name, root, angle)
        roots.append(root)
    # depths of both members by their root lines, which pass through the apex
    dedenda = [mean * float(np.tan(angle - root)) for angle, root in zip(angles, roots, strict=True)]
    if not 2.0 * gap < sum(dedenda):
        raise DesignError(
            "clearance",
            gap,
            unit="mm",
            reason="leaves no working depth",
            allowed=Allowed.less_than(0.5 * sum(dedenda), "mm"),
        )
    more = suggested_thickness_factor(data.teeth) if given.thickness_factor is None else given.thickness_factor
    depths = _Depths((roots[0], roots[1]), (dedenda[0], dedenda[1]), gap, given.face_angles)
    return _blank(data, depths, more, cutter_radius, backlash)


def check_root_angle(name: str, root: float, pitch_angle: float) -> None:
    """Raise DesignError for a root angle (rad) beyond the pitch angle of a pair without offset."""
    if not 0.0 < root <= pitch_angle * (1.0 + ROOT_ANGLE_ROUNDING):
        raise DesignError(
            f"{name}.root_angle",
            np.degrees(root),
            unit="deg",
            allowed=f"between 0 and the pitch angle, {at_most(np.degrees(pitch_angle))} deg",
        )


def uniform_blank(data: BasicData, depths: tuple[float, float], cutter_radius: float) -> BevelBlank:
    """Return the blank of uniform depth: root and tip cones are parallel to the pitch cones.

    `depths`: addendum and dedendum in mean normal modules.
    """
    addendum, dedendum = (depth * data.mean_normal_module for depth in depths)
    return _blank(
        data,
        _Depths(data.pitch_angles, (dedendum, dedendum), dedendum - addendum, (None, None)),
        0.0,
        cutter_radius,
        0.0,
    )


@dataclass(frozen=True)
class _Depths:
    """Depths of both members without offset; tuples are (pinion, gear)."""

    #: root angles, rad
    roots: tuple[float, float]
    #: mean dedenda, mm
    dedenda: tuple[float, float]
    #: clearance, mm
    gap: float
    #: given face angles, rad; None where the face angle follows from the mating gear's root angle
    faces: tuple[float | None, float | None]

    def tapers(self, pitch: PitchCones) -> tuple[float, float]:
        """Return the dedendum angles (rad) of (pinion, gear)."""
        pinion_angle, gear_angle = (angle - root for angle, root in zip(pitch.pitch_angles, self.roots, strict=True))
        return pinion_angle, gear_angle

    def addenda(self, pitch: PitchCones) -> tuple[float, float]:
        """Return the mean addenda (mm) of (pinion, gear), across the pitch cones.

        An addendum is the mating gear's dedendum less the clearance, which counts across the mating gear's root line.
        """
        gear_addendum, pinion_addendum = (
            float(dedendum - self.gap / np.cos(taper))
            for dedendum, taper in zip(self.dedenda, self.tapers(pitch), strict=True)
        )
        return pinion_addendum, gear_addendum

    @property
    def standard(self) -> tuple[ToothDepth, ToothDepth]:
        """Mean depths with the clearance across the pitch cones [ISO 23509 (136)-(139)]."""
        pinion_dedendum, gear_dedendum = self.dedenda
        return ToothDepth(gear_dedendum - self.gap, pinion_dedendum), ToothDepth(
            pinion_dedendum - self.gap, gear_dedendum
        )

    def cones(self, pitch: PitchCones) -> BlankCones:
        """Return the cones of tip and root."""
        return blank_cones(pitch, self.tapers(pitch), (self.addenda(pitch)[1], self.dedenda[1]), self.gap)


def _blank(data: BasicData, depths: _Depths, more: float, cutter_radius: float | None, backlash: float) -> BevelBlank:
    """Return the blank of both members; each is thinned for half of the normal `backlash` (mm).

    `more`: thickness factor k_t of the pinion. `cutter_radius` (mm): None for a nominal cutter.
    """
    dedenda, pitch, alpha = depths.dedenda, data.pitch_cones, data.pressure_angle
    normal, depth = pitch.mean_normal_module, dedenda[0] + dedenda[1]
    # thicknesses, and the cutter whose point leaves the gear's tooth space
    pinion = normal_thickness(normal, dedenda[1] - dedenda[0], 0.5 * more, alpha)
    above_tip = float(dedenda[1] * np.cos(depths.tapers(pitch)[1]))
    cut = gear_cutter(normal, pinion, backlash, (alpha, alpha), above_tip)
    # the tooth line gives the spiral angles at toe and heel
    radius = nominal_radius(CUTTER_RADIUS_SHARE * data.mean_cone_distance) if cutter_radius is None else cutter_radius
    line = pitch.tooth_line(FaceCutter(radius))
    outer, width = data.outer_cone_distance, data.face_width
    return BevelBlank(
        pinion=_member(pitch, 0, depths, cut.thicknesses[0], line),
        gear=_member(pitch, 1, depths, cut.thicknesses[1], line),
        shaft_angle=data.shaft_angle,
        pressure_angle=data.pressure_angle,
        blade_angles=(data.pressure_angle, data.pressure_angle),
        mean_normal_module=normal,
        clearance=float(depths.gap),
        mean_depth=depth,
        cutter_radius=radius,
        point_width=cut.point_width,
        edge_radius=cut.edge_radius,
        standard_depths=depths.standard,
        warnings=wide_face(width, outer),
    )


def wide_face(width: float, outer: float) -> tuple[str, ...]:
    """Return the warning on a face width (mm) that is unusual at an outer cone distance (mm), or nothing."""
    warning = (
        f"face_width = {width:g} mm is more than {MAX_USUAL_FACE_SHARE:g} of the outer cone distance, {outer:.6g} mm"
    )
    return (warning,) if width > MAX_USUAL_FACE_SHARE * outer else ()


@dataclass(frozen=True)
class GearCut:
    """The gear's spread-blade cutter, and the thicknesses that it leaves."""

    #: mean normal circular thicknesses of (pinion, gear), mm
    thicknesses: tuple[float, float]
    #: point width of the cutter, mm
    point_width: float
    #: edge radius of the blades, mm
    edge_radius: float


def gear_cutter(
    module: float, pinion: float, backlash: float, blade_angles: tuple[float, float], above_tip: float
) -> GearCut:
    """Return the gear's cutter and the thicknesses of both members with backlash [ISO 23509 (206)-(211)].

    - `module`: mean normal module, mm
    - `pinion`: mean normal thickness of the pinion without backlash, mm
    - `backlash`: normal backlash, mm; each member is thinned for half of it
    - `blade_angles`: angles of the gear's inside and outside blades, rad
    - `above_tip`: height of the pitch point above the tips of the blades, mm
    """
    set_back = 0.5 * backlash / float(np.cos(0.5 * (blade_angles[0] + blade_angles[1])))
    # the gear's tooth space at the pitch point, and how much narrower it is at the tips of the blades
    space = pinion + set_back
    narrower = above_tip * (np.tan(blade_angles[0]) + np.tan(blade_angles[1]))
    point_width = float(max(space - narrower, 0.05 * module))
    return GearCut(
        (pinion - set_back, float(np.pi * module - space)), point_width, min(0.2 * module, 0.5 * point_width)
    )


def _member(pitch: PitchCones, k: int, depths: _Depths, thickness: float, line: ToothLine) -> MemberBlank:
    """Blank of member `k` (0 pinion, 1 gear) with a mean normal `thickness` (mm) and a tooth `line` of the cutter."""
    angle, given_face, dedendum = pitch.pitch_angles[k], depths.faces[k], depths.dedenda[k]
    mean, outer = pitch.mean_cone_distances[k], pitch.outer_cone_distance
    face = depths.cones(pitch).face_angles[k] if given_face is None else given_face
    if not face < np.radians(MAX_FACE_ANGLE_DEG):
        raise DesignError(
            "shaft_angle",
            np.degrees(pitch.shaft_angle),
            unit="deg",
            reason=f"the face angle of the {('pinion', 'gear')[k]} would be {np.degrees(face):.4g} deg",
            allowed=f"a face angle of less than {MAX_FACE_ANGLE_DEG:g} deg",
            excess=float(np.degrees(face)) - MAX_FACE_ANGLE_DEG,
        )
    addendum = depths.addenda(pitch)[k]
    # the tip cone passes through the tip at the mean cone distance
    rho = mean * np.sin(angle) + addendum * np.cos(angle)
    z = mean * np.cos(angle) - addendum * np.sin(angle)
    longer = outer - mean
    return MemberBlank(
        teeth=pitch.teeth[k],
        pitch_angle=angle,
        root_angle=depths.roots[k],
        face_angle=float(face),
        tip_radius=float(rho - z * np.tan(face)),
        mean_addendum=addendum,
        mean_dedendum=float(dedendum),
        outer_addendum=float(addendum + longer * np.tan(face - angle)),
        outer_dedendum=float(dedendum + longer * np.tan(angle - depths.roots[k])),
        thickness=thickness,
        spiral_angle=pitch.spiral_angles[k],
        end_spiral_angles=(float(line.spiral_angle_at(outer)), float(line.spiral_angle_at(outer - pitch.face_width))),
        mean_cone_distance=mean,
        outer_cone_distance=outer,
        face_width=pitch.face_width,
    )


def nominal_radius(wanted: float) -> float:
    """Return the nearest nominal cutter radius (mm), or the wanted radius if no nominal one is within a fifth of it."""
    radii = 12.7 * np.array(NOMINAL_CUTTER_DIAMETERS_INCH)
    nearest = float(radii[np.abs(np.log(radii / wanted)).argmin()])
    return nearest if abs(nearest / wanted - 1.0) < 0.2 else float(wanted)
