"""Blanks of bevel gears from basic data: ISO 23509 method 0 (no offset) with standard depth taper.

In the axial plane the root lines of both members pass through the pitch apex, at the dedendum angles below the pitch
line; the tip line of a member is parallel to its mate's root line at the distance of the clearance. Lengths in mm,
angles in rad; "mean" is at the mean cone distance, "outer" at the heel.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least, at_most

#: depth factor k_d by pinion teeth, for fewer than 12 (spiral bevel, AGMA 2005), 2 from there on
DEPTH_FACTORS = {6: 1.765, 7: 1.835, 8: 1.895, 9: 1.940, 10: 1.975, 11: 1.995}
#: clearance over mean working depth, ISO 23509 k_c
CLEARANCE_FACTOR = 0.125
#: nominal cutter diameters, inch
NOMINAL_CUTTERS = (1.1, 1.5, 2.0, 2.75, 3.5, 4.5, 5.0, 6.0, 7.5, 9.0, 10.5, 12.0, 14.0, 16.0, 18.0, 21.0)
#: face width over outer cone distance: unusual, and refused
WIDE, WIDEST, NARROWEST = 0.35, 0.6, 1e-4
#: cutter radius over mean cone distance that the nominal one should be near
CUTTER_SHARE = 0.95


@dataclass(frozen=True)
class MemberBlank:
    """One member: teeth, cone angles, and at the mean its addendum, dedendum and normal circular thickness.

    The tip cone is rho = tip_radius + tan(face_angle) z in the member's own frame (apex at the origin).
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

    @property
    def dedendum_angle(self) -> float:
        return self.pitch_angle - self.root_angle


@dataclass(frozen=True)
class BevelBlank:
    """Both members and what they share; `mean_depth` is the distance between both root lines across the pitch line at the mean
    cone distance: working depth and twice the clearance.
    """

    pinion: MemberBlank
    gear: MemberBlank
    shaft_angle: float
    spiral_angle: float
    pressure_angle: float
    face_width: float
    outer_cone_distance: float
    mean_cone_distance: float
    mean_normal_module: float
    clearance: float
    mean_depth: float
    cutter_radius: float
    point_width: float
    edge_radius: float
    warnings: tuple[str, ...] = field(default=())

    @property
    def inner_cone_distance(self) -> float:
        return self.outer_cone_distance - self.face_width

    @property
    def mean_working_depth(self) -> float:
        return self.mean_depth - 2.0 * self.clearance

    def spiral_angle_at(self, cone_distance: float) -> float:
        """Spiral angle (rad) at a cone distance for the face-milling cutter [ISO 23509]."""
        rm, rc = self.mean_cone_distance, self.cutter_radius
        sine = (2.0 * rm * rc * np.sin(self.spiral_angle) - rm**2 + cone_distance**2) / (2.0 * cone_distance * rc)
        return float(np.arcsin(np.clip(sine, -1.0, 1.0)))


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
                f"shaft_angle = {np.degrees(self.shaft_angle):g} deg: with {self.teeth[0]} and {self.teeth[1]} teeth "
                f"the gear's pitch angle is {np.degrees(gear):.4g} deg; allowed is less than 90 deg"
            )
        if not self.face_width < WIDEST * outer:
            raise DesignError(
                f"face_width = {self.face_width:g} mm: allowed is less than {at_most(WIDEST * outer)} mm, "
                f"{WIDEST:g} of the outer cone distance"
            )
        if not self.face_width > NARROWEST * outer:
            raise DesignError(
                f"face_width = {self.face_width:g} mm: allowed is more than {at_least(NARROWEST * outer)} mm, "
                f"{NARROWEST:g} of the outer cone distance"
            )
        if not outer - self.face_width < self.mean_cone_distance < outer:
            raise DesignError(
                f"mean_cone_distance = {self.mean_cone_distance:g} mm: allowed is between "
                f"{at_least(outer - self.face_width)} (toe) and {at_most(outer)} mm (heel)"
            )

    @property
    def pitch_angles(self) -> tuple[float, float]:
        """Pitch angles of pinion and gear [AB 1, 2]."""
        pinion = float(np.arctan2(np.sin(self.shaft_angle), self.teeth[1] / self.teeth[0] + np.cos(self.shaft_angle)))
        return pinion, self.shaft_angle - pinion

    @property
    def outer_cone_distance(self) -> float:
        return float(0.5 * self.module * self.teeth[1] / np.sin(self.pitch_angles[1]))

    @property
    def face_width(self) -> float:
        """As given, or 0.3 of the outer cone distance but at most 10 modules."""
        if self.given_face_width is not None:
            return self.given_face_width
        return min(0.3 * self.outer_cone_distance, 10.0 * self.module)

    @property
    def mean_cone_distance(self) -> float:
        if self.given_mean_cone_distance is not None:
            return self.given_mean_cone_distance
        return self.outer_cone_distance - 0.5 * self.face_width

    @property
    def mean_normal_module(self) -> float:
        circle = 2.0 * self.mean_cone_distance * np.sin(self.pitch_angles[1])
        return float(circle * np.cos(self.spiral_angle) / self.teeth[1])


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


def tapered_blank(
    data: BasicData,
    given: Proportions = Proportions(),
    cutter_radius: float | None = None,
    backlash: float = 0.0,
) -> BevelBlank:
    """Standard taper [ISO 23509]: both root lines through the apex.

    Raises DesignError for a blank that cannot exist, naming the key.
    """
    angles, mean, normal = data.pitch_angles, data.mean_cone_distance, data.mean_normal_module
    factor = DEPTH_FACTORS.get(max(data.teeth[0], min(DEPTH_FACTORS)), 2.0)
    working = (factor if given.depth_factor is None else given.depth_factor) * normal
    gap = CLEARANCE_FACTOR * working if given.clearance is None else given.clearance
    if not gap < 0.5 * working:
        raise DesignError(
            f"clearance = {gap:g} mm: allowed is less than half the mean working depth, {at_most(0.5 * working)} mm"
        )
    # addendum factor of the gear over the equivalent ratio [ISO 23509 c_ham]
    share = 0.21 + 0.29 / (data.teeth[1] * np.cos(angles[0]) / (data.teeth[0] * np.cos(angles[1])))
    share = share if given.addendum_factor is None else given.addendum_factor
    addenda = ((1.0 - share) * working, share * working)
    roots = []
    for name, angle, mate, asked in zip(("pinion", "gear"), angles, addenda[::-1], given.root_angles, strict=True):
        root = float(angle - np.arctan((mate + gap) / mean)) if asked is None else asked
        if not 0.0 < root < angle:
            raise DesignError(
                f"{name}.root_angle = {np.degrees(root):.6g} deg: allowed is between 0 and the pitch angle, "
                f"{at_most(np.degrees(angle))} deg"
            )
        roots.append(root)
    dedenda = [mean * float(np.tan(angle - root)) for angle, root in zip(angles, roots, strict=True)]
    if not 2.0 * gap < sum(dedenda):
        raise DesignError(
            f"clearance = {gap:g} mm: leaves no working depth; allowed is less than {at_most(0.5 * sum(dedenda))} mm"
        )
    ratio = data.teeth[1] / data.teeth[0]
    more = -0.088 + 0.092 * ratio - 0.004 * ratio**2 + 0.0016 * (data.teeth[0] - 30) * (ratio - 1.0)
    more = max(more, 0.0) if given.thickness_factor is None else given.thickness_factor
    cones = _Cones((roots[0], roots[1]), (dedenda[0], dedenda[1]), gap, given.face_angles)
    return _blank(data, cones, more, cutter_radius, backlash)


def uniform_blank(data: BasicData, depths: tuple[float, float], cutter_radius: float) -> BevelBlank:
    """Uniform depth: root and tip cones parallel to the pitch cones; `depths`: addendum and dedendum in mean normal modules."""
    addendum, dedendum = (depth * data.mean_normal_module for depth in depths)
    cones = _Cones(data.pitch_angles, (dedendum, dedendum), dedendum - addendum, (None, None))
    return _blank(data, cones, 0.0, cutter_radius, 0.0)


@dataclass(frozen=True)
class _Cones:
    """Root angles and mean dedenda of (pinion, gear), clearance, and face angles where given."""

    roots: tuple[float, float]
    dedenda: tuple[float, float]
    gap: float
    faces: tuple[float | None, float | None]


def _blank(data: BasicData, cones: _Cones, more: float, cutter_radius: float | None, backlash: float) -> BevelBlank:
    """Both members; `more`: thickness factor k_t of the pinion."""
    dedenda = cones.dedenda
    normal, depth, tan_alpha = data.mean_normal_module, dedenda[0] + dedenda[1], np.tan(data.pressure_angle)
    # half the pitch, more for the pinion by the difference of the addenda and k_t
    pinion = 0.5 * np.pi * normal + (dedenda[1] - dedenda[0]) * tan_alpha + more * normal
    slot = pinion + backlash / np.cos(data.pressure_angle) - 2.0 * dedenda[1] * tan_alpha
    point_width = float(max(slot, 0.05 * normal))
    outer, width = data.outer_cone_distance, data.face_width
    wide = f"face_width = {width:g} mm is more than {WIDE:g} of the outer cone distance, {outer:.6g} mm"
    return BevelBlank(
        pinion=_member(data, 0, cones, float(pinion)),
        gear=_member(data, 1, cones, float(np.pi * normal - pinion)),
        shaft_angle=data.shaft_angle,
        spiral_angle=data.spiral_angle,
        pressure_angle=data.pressure_angle,
        face_width=width,
        outer_cone_distance=outer,
        mean_cone_distance=data.mean_cone_distance,
        mean_normal_module=normal,
        clearance=float(cones.gap),
        mean_depth=depth,
        cutter_radius=_nominal_radius(CUTTER_SHARE * data.mean_cone_distance)
        if cutter_radius is None
        else cutter_radius,
        point_width=point_width,
        edge_radius=min(0.2 * normal, 0.5 * point_width),
        warnings=(wide,) if width > WIDE * outer else (),
    )


def _member(data: BasicData, k: int, cones: _Cones, thickness: float) -> MemberBlank:
    mate, dedenda, asked = 1 - k, cones.dedenda, cones.faces[k]
    angle, mean, outer = data.pitch_angles[k], data.mean_cone_distance, data.outer_cone_distance
    taper = [pitch - root for pitch, root in zip(data.pitch_angles, cones.roots, strict=True)]
    face = angle + taper[mate] if asked is None else asked
    if not face < np.radians(89.5):
        raise DesignError(
            f"shaft_angle = {np.degrees(data.shaft_angle):g} deg: the face angle of the {('pinion', 'gear')[k]} would be "
            f"{np.degrees(face):.4g} deg; allowed is less than 89.5 deg"
        )
    # the mate's root line, less the clearance across it, in depth across the pitch line
    lost = cones.gap / np.cos(taper[mate])
    addendum = dedenda[mate] - lost
    # through the tip at the mean cone distance
    rho = mean * np.sin(angle) + addendum * np.cos(angle)
    z = mean * np.cos(angle) - addendum * np.sin(angle)
    longer = outer - mean
    return MemberBlank(
        teeth=data.teeth[k],
        pitch_angle=angle,
        root_angle=cones.roots[k],
        face_angle=float(face),
        tip_radius=float(rho - z * np.tan(face)),
        mean_addendum=float(addendum),
        mean_dedendum=float(dedenda[k]),
        outer_addendum=float(addendum + longer * np.tan(face - angle)),
        outer_dedendum=float(dedenda[k] + longer * np.tan(taper[k])),
        thickness=thickness,
    )


def _nominal_radius(wanted: float) -> float:
    """The nearest nominal cutter radius (mm), or what is wanted where none is within a fifth of it."""
    radii = 12.7 * np.array(NOMINAL_CUTTERS)
    nearest = float(radii[np.abs(np.log(radii / wanted)).argmin()])
    return nearest if abs(nearest / wanted - 1.0) < 0.2 else float(wanted)
