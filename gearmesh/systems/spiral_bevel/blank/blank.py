"""Blanks of bevel gears without offset, as the cutters of this kind make them, from basic data and the rules of `iso23509`.

Standard depth taper: in the axial plane the root lines of both members pass through the pitch apex, at the dedendum
angles below the pitch line; the tip line of a member is parallel to its mating gear's root line at the distance of the clearance.
Root angles that are given without a taper may be those of any: see `roots_through_apex`.
Lengths in mm, angles in rad; "mean" is at the mean cone distance, "outer" at the heel.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.spiral_bevel.iso23509.blank_cones import BlankCones, blank_cones
from gearmesh.systems.spiral_bevel.iso23509.dimensions import ToothDepth
from gearmesh.systems.spiral_bevel.iso23509.methods import without_offset
from gearmesh.systems.spiral_bevel.iso23509.pitch_cones import PitchCones, bevel_pitch_angles, crown_shaft_angle
from gearmesh.systems.spiral_bevel.iso23509.tapers import standard_dedendum_angle
from gearmesh.systems.spiral_bevel.iso23509.tooth_factors import (
    CLEARANCE_FACTOR,
    normal_thickness,
    suggested_addendum_factor,
    suggested_depth_factor,
    suggested_thickness_factor,
)
from gearmesh.systems.spiral_bevel.iso23509.tooth_line import FaceCutter, ToothLine

#: nominal cutter diameters, inch
NOMINAL_CUTTERS = (1.1, 1.5, 2.0, 2.75, 3.5, 4.5, 5.0, 6.0, 7.5, 9.0, 10.5, 12.0, 14.0, 16.0, 18.0, 21.0)
#: face width over outer cone distance: unusual, and refused
WIDE, WIDEST, NARROWEST = 0.35, 0.6, 1e-4
#: cutter radius over mean cone distance that the nominal one should be near
CUTTER_SHARE = 0.95
#: part of the mean whole depth by which root lines through the pitch apex may miss it: angles printed to the minute miss 0.003
SAME_DEPTH = 0.01
#: part by which root angles of a uniform depth that were written may exceed the pitch angle
ROUNDED = 1e-9


@dataclass(frozen=True)
class MemberBlank:
    """One member: teeth, cone angles, and at the mean its spiral angle, addendum, dedendum and normal circular thickness;
    `end_spiral_angles` at heel and toe.

    The tip cone is rho = tip_radius + tan(face_angle) z in the member's own frame. Its origin is the apex of a pair without
    offset, else the foot of the axes' common perpendicular: `pitch_apex` and `root_apex` are how far (mm) the apexes of pitch and
    root cone are beyond it, away from the teeth. Cone distances count from the pitch apex.
    """

    teeth: int
    pitch_angle: float
    root_angle: float
    face_angle: float
    tip_radius: float
    mean_addendum: float
    mean_dedendum: float
    outer_addendum: float
    outer_dedendum: float
    thickness: float
    spiral_angle: float
    end_spiral_angles: tuple[float, float]
    mean_cone_distance: float
    outer_cone_distance: float
    face_width: float
    pitch_apex: float = 0.0
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
        """Of the pitch circle at the mean."""
        return float(self.mean_cone_distance * np.sin(self.pitch_angle))

    @property
    def stations(self) -> ConeLevel:
        """The level whose values are cone distances."""
        return self.station(0.0)

    def station(self, cone_distance: float) -> ConeLevel:
        """The level that is 0 at a cone distance."""
        return ConeLevel(self.pitch_angle, cone_distance - self.pitch_apex * float(np.cos(self.pitch_angle)))

    @property
    def pitch_cone(self) -> ConeLevel:
        """Height over the pitch cone."""
        return ConeLevel(self.pitch_angle + 0.5 * np.pi, self.pitch_apex * float(np.sin(self.pitch_angle)))

    @property
    def tip(self) -> ConeLevel:
        """The tip cone."""
        return ConeLevel.of(self.tip_radius, float(np.tan(self.face_angle)))

    def addendum_at(self, cone_distance: Array) -> Array:
        """Height (...,), mm, of the tip cone over the pitch cone, across that, at cone distances (...,)."""
        s, c, slope = np.sin(self.pitch_angle), np.cos(self.pitch_angle), np.tan(self.face_angle)
        # cone_distance s + h c = tip_radius + slope (cone_distance c - pitch_apex - h s)
        under = self.tip_radius - slope * self.pitch_apex
        return np.asarray((under + cone_distance * (slope * c - s)) / (c + slope * s))

    def crown(self, cone_distance: float) -> float:
        """From the origin to the tip cone along the axis (mm) at a cone distance."""
        addendum = float(self.addendum_at(np.array(cone_distance)))
        c, s = np.cos(self.pitch_angle), np.sin(self.pitch_angle)
        return float(cone_distance * c - self.pitch_apex - addendum * s)

    def along_root(self, cone_distance: float) -> float:
        """How far (mm) from the origin, along the root line, the foot of a point of the pitch line on it is."""
        at_apex = self.pitch_apex * np.cos(self.root_angle)
        return float(cone_distance * np.cos(self.dedendum_angle) - at_apex)

    def root_base(self, root_angle: float) -> float:
        """Sliding base (mm) with which a machine plane at a root angle (rad) passes through the root cone's apex."""
        return float(self.root_apex * np.sin(root_angle))


@dataclass(frozen=True)
class BevelBlank:
    """Both members and what they share; `mean_depth` is the distance between both root lines across the pitch line at the mean
    cone distance: working depth and twice the clearance. `blade_angles` (rad) are those of the gear's inside and outside blades.
    `standard_depths`: mean addendum and dedendum of (pinion, gear) as ISO 23509 has them, which counts the clearance across the
    pitch cones there and across the root lines where it places the cones.

    `offset` (mm) of the axes, > 0 where it makes the pinion's spiral angle the larger one; `azimuths` (rad): of the mean point in
    the frames of pinion and gear whose x axes are in the plane of both axes' directions, of a right-hand pinion.
    """

    pinion: MemberBlank
    gear: MemberBlank
    shaft_angle: float
    pressure_angle: float
    blade_angles: tuple[float, float]
    mean_normal_module: float
    clearance: float
    mean_depth: float
    cutter_radius: float
    point_width: float
    edge_radius: float
    standard_depths: tuple[ToothDepth, ToothDepth]
    offset: float = 0.0
    azimuths: tuple[float, float] = (0.0, 0.0)
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
        """The line of the face-milling cutter on the gear's crown gear."""
        crown, gear = self.gear.teeth / np.sin(self.gear.pitch_angle), self.gear
        return ToothLine(FaceCutter(self.cutter_radius), gear.mean_cone_distance, gear.spiral_angle, float(crown))


@dataclass(frozen=True)
class BasicData:
    """Basic data of a pair; (pinion, gear) each, `module` outer transverse, lengths in mm, angles in rad.

    Raises DesignError, naming the key, for pitch cones that cannot exist.
    """

    teeth: tuple[int, int]
    module: float
    spiral_angle: float
    shaft_angle: float
    pressure_angle: float
    given_face_width: float | None = None
    given_mean_cone_distance: float | None = None

    def __post_init__(self) -> None:
        gear, outer = self.pitch_angles[1], self.outer_cone_distance
        if not max(self.pitch_angles) < 0.5 * np.pi:
            raise DesignError(
                "shaft_angle",
                np.degrees(self.shaft_angle),
                unit="deg",
                reason=f"with {self.teeth[0]} and {self.teeth[1]} teeth the gear's pitch angle is {np.degrees(gear):.4g} deg",
                allowed=f"less than {at_most(np.degrees(crown_shaft_angle(self.teeth)))} deg",
            )
        if not self.face_width < WIDEST * outer:
            raise DesignError(
                "face_width",
                self.face_width,
                unit="mm",
                allowed=f"less than {at_most(WIDEST * outer)} mm, {WIDEST:g} of the outer cone distance",
            )
        if not self.face_width > NARROWEST * outer:
            raise DesignError(
                "face_width",
                self.face_width,
                unit="mm",
                allowed=f"more than {at_least(NARROWEST * outer)} mm, {NARROWEST:g} of the outer cone distance",
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
        """As given, or 0.3 of the outer cone distance but at most 10 modules."""
        if self.given_face_width is not None:
            return self.given_face_width
        return min(0.3 * self.outer_cone_distance, 10.0 * self.module)

    @property
    def mean_cone_distance(self) -> float:
        return self.pitch_cones.mean_cone_distances[1]

    @property
    def mean_normal_module(self) -> float:
        return self.pitch_cones.mean_normal_module


@dataclass(frozen=True)
class Proportions:
    """Tooth proportions that are given; what is None follows from the basic data [ISO 23509].

    `depth_factor` k_d (mean working depth in mean normal modules), `addendum_factor` c_ham (mean addendum of the gear over the
    mean working depth), `thickness_factor` k_t (pinion's mean normal thickness beyond half the pitch and the difference
    of the addenda, in mean normal modules), `clearance` (mm), `root_angles` and `face_angles` (rad) of (pinion, gear).
    """

    depth_factor: float | None = None
    addendum_factor: float | None = None
    thickness_factor: float | None = None
    clearance: float | None = None
    root_angles: tuple[float | None, float | None] = (None, None)
    face_angles: tuple[float | None, float | None] = (None, None)


def roots_through_apex(data: BasicData, given: Proportions) -> bool:
    """Whether root angles that are given are those of a standard taper, so that root lines pass through the pitch apex: where
    they leave the whole depth that the factors ask for. The depths are then theirs, as in [AB]; those of any other taper turn
    root lines about the root at the mean point [ISO 23509 (151)].

    Raises DesignError for a clearance that leaves no depth.
    """
    wanted = standard_dedenda(data, given)[0]
    pairs = zip(data.pitch_angles, given.root_angles, wanted, strict=True)
    depths = [own if root is None else data.mean_cone_distance * np.tan(angle - root) for angle, root, own in pairs]
    return bool(abs(sum(depths) - sum(wanted)) <= SAME_DEPTH * sum(wanted))


def standard_dedenda(data: BasicData, given: Proportions) -> tuple[tuple[float, float], float]:
    """Mean dedenda (mm) by the factors, given or suggested, and the clearance. Raises DesignError for one that leaves no depth."""
    angles, normal = data.pitch_angles, data.mean_normal_module
    working = (suggested_depth_factor(data.teeth) if given.depth_factor is None else given.depth_factor) * normal
    gap = CLEARANCE_FACTOR * working if given.clearance is None else given.clearance
    if not gap < 0.5 * working:
        raise DesignError(
            "clearance", gap, unit="mm", allowed=f"less than half the mean working depth, {at_most(0.5 * working)} mm"
        )
    share = suggested_addendum_factor(data.teeth, angles) if given.addendum_factor is None else given.addendum_factor
    return (share * working + gap, (1.0 - share) * working + gap), gap


def tapered_blank(
    data: BasicData,
    given: Proportions = Proportions(),
    cutter_radius: float | None = None,
    backlash: float = 0.0,
) -> BevelBlank:
    """Standard taper [ISO 23509]: both root lines through the apex.

    Raises DesignError for a blank that cannot exist, naming the key.
    """
    angles, mean = data.pitch_angles, data.mean_cone_distance
    wanted, gap = standard_dedenda(data, given)
    roots = []
    for name, angle, dedendum, asked in zip(("pinion", "gear"), angles, wanted, given.root_angles, strict=True):
        root = angle - standard_dedendum_angle(dedendum, mean) if asked is None else asked
        check_root_angle(name, root, angle)
        roots.append(root)
    dedenda = [mean * float(np.tan(angle - root)) for angle, root in zip(angles, roots, strict=True)]
    if not 2.0 * gap < sum(dedenda):
        raise DesignError(
            "clearance",
            gap,
            unit="mm",
            reason="leaves no working depth",
            allowed=f"less than {at_most(0.5 * sum(dedenda))} mm",
        )
    more = suggested_thickness_factor(data.teeth) if given.thickness_factor is None else given.thickness_factor
    depths = _Depths((roots[0], roots[1]), (dedenda[0], dedenda[1]), gap, given.face_angles)
    return _blank(data, depths, more, cutter_radius, backlash)


def check_root_angle(name: str, root: float, pitch_angle: float) -> None:
    """Refuse a root angle (rad) of a pair without offset beyond the pitch angle. Raises DesignError."""
    if not 0.0 < root <= pitch_angle * (1.0 + ROUNDED):
        raise DesignError(
            f"{name}.root_angle",
            np.degrees(root),
            unit="deg",
            allowed=f"between 0 and the pitch angle, {at_most(np.degrees(pitch_angle))} deg",
        )


def uniform_blank(data: BasicData, depths: tuple[float, float], cutter_radius: float) -> BevelBlank:
    """Uniform depth: root and tip cones parallel to the pitch cones; `depths`: addendum and dedendum in mean normal modules."""
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
    """Root angles and mean dedenda of (pinion, gear), clearance, and face angles where given."""

    roots: tuple[float, float]
    dedenda: tuple[float, float]
    gap: float
    faces: tuple[float | None, float | None]

    def tapers(self, pitch: PitchCones) -> tuple[float, float]:
        """Dedendum angles."""
        first, second = (angle - root for angle, root in zip(pitch.pitch_angles, self.roots, strict=True))
        return first, second

    def addenda(self, pitch: PitchCones) -> tuple[float, float]:
        """The mating gear's dedendum less the clearance across its root line, all across the pitch cone at the mean."""
        first, second = (
            float(dedendum - self.gap / np.cos(taper))
            for dedendum, taper in zip(self.dedenda, self.tapers(pitch), strict=True)
        )
        return second, first

    @property
    def standard(self) -> tuple[ToothDepth, ToothDepth]:
        """Mean depths with the clearance across the pitch cones [ISO 23509 (136)-(139)]."""
        first, second = self.dedenda
        return ToothDepth(second - self.gap, first), ToothDepth(first - self.gap, second)

    def cones(self, pitch: PitchCones) -> BlankCones:
        """Cones of tip and root."""
        return blank_cones(pitch, self.tapers(pitch), (self.addenda(pitch)[1], self.dedenda[1]), self.gap)


def _blank(data: BasicData, depths: _Depths, more: float, cutter_radius: float | None, backlash: float) -> BevelBlank:
    """Both members; `more`: thickness factor k_t of the pinion. Each is thinned for half of the normal `backlash`."""
    dedenda, pitch, alpha = depths.dedenda, data.pitch_cones, data.pressure_angle
    normal, depth = pitch.mean_normal_module, dedenda[0] + dedenda[1]
    pinion = normal_thickness(normal, dedenda[1] - dedenda[0], 0.5 * more, alpha)
    above_tip = float(dedenda[1] * np.cos(depths.tapers(pitch)[1]))
    cut = gear_cutter(normal, pinion, backlash, (alpha, alpha), above_tip)
    radius = nominal_radius(CUTTER_SHARE * data.mean_cone_distance) if cutter_radius is None else cutter_radius
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
    """What to say of a face width (mm) that is unusual at an outer cone distance (mm)."""
    told = f"face_width = {width:g} mm is more than {WIDE:g} of the outer cone distance, {outer:.6g} mm"
    return (told,) if width > WIDE * outer else ()


@dataclass(frozen=True)
class GearCut:
    """What the gear's spread-blade cutter leaves: mean normal thicknesses of (pinion, gear); its point width and the edge radius,
    mm."""

    thicknesses: tuple[float, float]
    point_width: float
    edge_radius: float


def gear_cutter(
    module: float, pinion: float, backlash: float, blade_angles: tuple[float, float], above_tip: float
) -> GearCut:
    """The gear's cutter by the mean normal module, the pinion's mean normal thickness without backlash, the normal backlash, for
    for half of which each member is thinned [ISO 23509 (206)-(211)], the angles (rad) of the blades, and how far the pitch point is
    above their tips.
    """
    away = 0.5 * backlash / float(np.cos(0.5 * (blade_angles[0] + blade_angles[1])))
    space = pinion + away
    narrower = above_tip * (np.tan(blade_angles[0]) + np.tan(blade_angles[1]))
    point_width = float(max(space - narrower, 0.05 * module))
    return GearCut((pinion - away, float(np.pi * module - space)), point_width, min(0.2 * module, 0.5 * point_width))


def _member(pitch: PitchCones, k: int, depths: _Depths, thickness: float, line: ToothLine) -> MemberBlank:
    angle, asked, dedendum = pitch.pitch_angles[k], depths.faces[k], depths.dedenda[k]
    mean, outer = pitch.mean_cone_distances[k], pitch.outer_cone_distance
    face = depths.cones(pitch).face_angles[k] if asked is None else asked
    if not face < np.radians(89.5):
        raise DesignError(
            "shaft_angle",
            np.degrees(pitch.shaft_angle),
            unit="deg",
            reason=f"the face angle of the {('pinion', 'gear')[k]} would be {np.degrees(face):.4g} deg",
            allowed="less than 89.5 deg",
        )
    addendum = depths.addenda(pitch)[k]
    # through the tip at the mean cone distance
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
    """The nearest nominal cutter radius (mm), or what is wanted where none is within a fifth of it."""
    radii = 12.7 * np.array(NOMINAL_CUTTERS)
    nearest = float(radii[np.abs(np.log(radii / wanted)).argmin()])
    return nearest if abs(nearest / wanted - 1.0) < 0.2 else float(wanted)
