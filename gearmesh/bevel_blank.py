"""Blanks of bevel gears from basic data: ISO 23509 method 0 (no offset) with standard depth taper.

In the axial plane the root lines of both members pass through the pitch apex, at the dedendum angles below the pitch
line; the tip line of a member is parallel to its mate's root line at the distance of the clearance. Lengths in mm,
angles in rad; "mean" is at the mean cone distance, "outer" at the heel.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gearmesh.errors import DesignError

#: depth factor k_d by pinion teeth, for fewer than 12 (spiral bevel, AGMA 2005), 2 from there on
DEPTH_FACTORS = {6: 1.765, 7: 1.835, 8: 1.895, 9: 1.940, 10: 1.975, 11: 1.995}
#: clearance over mean working depth, ISO 23509 k_c
CLEARANCE_FACTOR = 0.125
#: nominal cutter diameters, inch
NOMINAL_CUTTERS = (1.1, 1.5, 2.0, 2.75, 3.5, 4.5, 5.0, 6.0, 7.5, 9.0, 10.5, 12.0, 14.0, 16.0, 18.0, 21.0)
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

    @property
    def addendum_angle(self) -> float:
        return self.face_angle - self.pitch_angle


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


def pitch_angles(teeth_pinion: int, teeth_gear: int, shaft_angle: float) -> tuple[float, float]:
    """Pitch angles (rad) of pinion and gear.

    Raises DesignError where a pitch cone would not be external (90 deg or more).
    """
    pinion = float(np.arctan2(np.sin(shaft_angle), teeth_gear / teeth_pinion + np.cos(shaft_angle)))
    gear = shaft_angle - pinion
    if not max(pinion, gear) < 0.5 * np.pi:
        raise DesignError(
            f"shaft_angle = {np.degrees(shaft_angle):g} deg: with {teeth_pinion} and {teeth_gear} teeth the gear's pitch angle is "
            f"{np.degrees(gear):.4g} deg; allowed is less than 90 deg"
        )
    return pinion, gear


def bevel_blank(
    teeth: tuple[int, int],
    module: float,
    spiral_angle: float,
    shaft_angle: float,
    pressure_angle: float,
    face_width: float | None = None,
    mean_cone_distance: float | None = None,
    clearance: float | None = None,
    root_angles: tuple[float | None, float | None] = (None, None),
    cutter_radius: float | None = None,
    backlash: float = 0.0,
) -> BevelBlank:
    """The blank of a pair; (pinion, gear) each, `module` outer transverse. What is None follows from the rest.

    Raises DesignError for a blank that cannot exist, naming the key.
    """
    angles = pitch_angles(*teeth, shaft_angle)
    outer = 0.5 * module * teeth[1] / np.sin(angles[1])
    width = min(0.3 * outer, 10.0 * module) if face_width is None else face_width
    if not width < 0.6 * outer:
        raise DesignError(
            f"face_width = {width:g} mm: allowed is less than {0.6 * outer:.6g} mm, 0.6 of the outer cone distance"
        )
    mean = outer - 0.5 * width if mean_cone_distance is None else mean_cone_distance
    if not outer - width < mean < outer:
        raise DesignError(
            f"mean_cone_distance = {mean:g} mm: allowed is between {outer - width:.6g} and {outer:.6g} mm, toe and heel"
        )
    normal = 2.0 * mean * np.sin(angles[1]) * np.cos(spiral_angle) / teeth[1]
    working = DEPTH_FACTORS.get(teeth[0], 2.0 if teeth[0] > 6 else DEPTH_FACTORS[6]) * normal
    gap = CLEARANCE_FACTOR * working if clearance is None else clearance
    # addendum factor of the gear over the equivalent ratio [ISO 23509 c_ham]
    share = 0.21 + 0.29 / (teeth[1] * np.cos(angles[0]) / (teeth[0] * np.cos(angles[1])))
    addenda = ((1.0 - share) * working, share * working)
    dedenda = tuple(mate + gap for mate in addenda[::-1])
    roots = tuple(
        float(delta - np.arctan(depth / mean)) if given is None else given
        for delta, depth, given in zip(angles, dedenda, root_angles, strict=True)
    )
    for name, root, delta in zip(("pinion", "gear"), roots, angles, strict=True):
        if not 0.0 < root < delta:
            raise DesignError(
                f"{name}.root_angle = {np.degrees(root):.6g} deg: allowed is between 0 and the pitch angle, {np.degrees(delta):.6g} deg"
            )
    below = tuple(float(np.tan(delta - root)) for delta, root in zip(angles, roots, strict=True))
    depth = mean * sum(below)
    if not 2.0 * gap < depth:
        raise DesignError(f"clearance = {gap:g} mm: leaves no working depth; allowed is less than {0.5 * depth:.4g} mm")
    thickness = _thicknesses(teeth, normal, pressure_angle, below, mean)
    point_width = max(
        thickness[0] + backlash / np.cos(pressure_angle) - 2.0 * mean * below[1] * np.tan(pressure_angle), 0.05 * normal
    )
    members = [_member(k, teeth, angles, roots, below, gap, mean, outer, thickness[k]) for k in (0, 1)]
    warnings = []
    if width > 0.35 * outer:
        warnings.append(f"face_width = {width:g} mm is more than 0.35 of the outer cone distance, {outer:.6g} mm")
    return BevelBlank(
        *members,
        shaft_angle=shaft_angle,
        spiral_angle=spiral_angle,
        pressure_angle=pressure_angle,
        face_width=width,
        outer_cone_distance=float(outer),
        mean_cone_distance=float(mean),
        mean_normal_module=float(normal),
        clearance=float(gap),
        mean_depth=float(depth),
        cutter_radius=_nominal_radius(CUTTER_SHARE * mean) if cutter_radius is None else cutter_radius,
        point_width=float(point_width),
        edge_radius=float(min(0.2 * normal, 0.5 * point_width)),
        warnings=tuple(warnings),
    )


def _thicknesses(
    teeth: tuple[int, int], module: float, pressure_angle: float, below: tuple[float, ...], mean: float
) -> tuple[float, float]:
    """Mean normal circular thicknesses (mm): half the pitch, more for the pinion by the difference of the addenda and k_t."""
    ratio = teeth[1] / teeth[0]
    more = -0.088 + 0.092 * ratio - 0.004 * ratio**2 + 0.0016 * (teeth[0] - 30) * (ratio - 1.0)
    pinion = 0.5 * np.pi * module + mean * (below[1] - below[0]) * np.tan(pressure_angle) + max(more, 0.0) * module
    return float(pinion), float(np.pi * module - pinion)


def _member(
    k: int,
    teeth: tuple[int, int],
    angles: tuple[float, float],
    roots: tuple[float, ...],
    below: tuple[float, ...],
    gap: float,
    mean: float,
    outer: float,
    thickness: float,
) -> MemberBlank:
    mate = 1 - k
    face = angles[k] + (angles[mate] - roots[mate])
    if not face < np.radians(89.5):
        raise DesignError(
            f"shaft_angle: the face angle of the {('pinion', 'gear')[k]} would be {np.degrees(face):.4g} deg; allowed is less than 89.5 deg"
        )
    # distance of the mate's root line, less the clearance across it
    lost = gap / np.cos(angles[mate] - roots[mate])
    return MemberBlank(
        teeth=teeth[k],
        pitch_angle=angles[k],
        root_angle=roots[k],
        face_angle=float(face),
        tip_radius=float(-gap / np.cos(face)),
        mean_addendum=float(mean * below[mate] - lost),
        mean_dedendum=float(mean * below[k]),
        outer_addendum=float(outer * below[mate] - lost),
        outer_dedendum=float(outer * below[k]),
        thickness=thickness,
    )


def _nominal_radius(wanted: float) -> float:
    """The nearest nominal cutter radius (mm), or what is wanted where none is within a fifth of it."""
    radii = 12.7 * np.array(NOMINAL_CUTTERS)
    nearest = float(radii[np.abs(np.log(radii / wanted)).argmin()])
    return nearest if abs(nearest / wanted - 1.0) < 0.2 else float(wanted)
