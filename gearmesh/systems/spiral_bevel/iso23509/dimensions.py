"""All dimensions of a bevel or hypoid pair, with or without offset, by ISO 23509:2016, clause 7.

Lengths in mm, angles in rad; "mean" is at the mean point, "outer" and "inner" at the ends of the member's own face.
The crossing point of a member is the foot of the common perpendicular on its axis, the same for both without offset; apexes
count from it, > 0 away from the teeth. Depths are across the pitch cone. The standard counts the clearance across the
root line for the tip and root cones of the pinion, and across the pitch cone for its depths, so that its outside diameter and
its tip cone differ by some micrometres; both are given as it has them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_most
from gearmesh.systems.spiral_bevel.iso23509.blank_cones import BlankCones, blank_cones
from gearmesh.systems.spiral_bevel.iso23509.pitch_cones import PitchCones
from gearmesh.systems.spiral_bevel.iso23509.taper_names import CUTTER_TAPERS
from gearmesh.systems.spiral_bevel.iso23509.tapers import taper_angles
from gearmesh.systems.spiral_bevel.iso23509.tooth_factors import (
    NO_BACKLASH,
    Backlash,
    PressureAngles,
    ToothFactors,
    normal_thickness,
    pressure_angles,
)
from gearmesh.systems.spiral_bevel.iso23509.tooth_line import FaceCutter, ToothLine, reaching


@dataclass(frozen=True)
class FaceSpan:
    """A member's face along its pitch cone: `outer` b_e and `inner` b_i on either side of the mean point."""

    outer: float
    inner: float

    @property
    def width(self) -> float:
        """b."""
        return self.outer + self.inner


@dataclass(frozen=True)
class PinionFace:
    """What leads to the pinion's face: b_p1, b_1A in the pitch plane; of method 1 lambda' and b_reri1, else 0; at both
    ends the wheel's cone distance R_e21, R_i21, spiral angle beta_e21, beta_i21 and offset angle zeta_ep21, zeta_ip21.
    """

    span: FaceSpan
    pitch_plane_width: float
    front_crown_width: float
    auxiliary_angle: float
    projected_width: float
    wheel_cone_distances: tuple[float, float]
    wheel_spiral_angles: tuple[float, float]
    offset_angles: tuple[float, float]

    @property
    def spiral_angles(self) -> tuple[float, float]:
        """beta_e1, beta_i1 [ISO 23509 (187), (188)]."""
        outer, inner = (
            spiral + offset for spiral, offset in zip(self.wheel_spiral_angles, self.offset_angles, strict=True)
        )
        return outer, inner


@dataclass(frozen=True)
class ToothDepth:
    """Addendum h_a and dedendum h_f at a cone distance."""

    addendum: float
    dedendum: float

    @property
    def whole(self) -> float:
        """h."""
        return self.addendum + self.dedendum


@dataclass(frozen=True)
class MemberDimensions:
    """One member; its pitch cone, cones of tip and root, face, depths and thicknesses. ISO symbols, index 1 or 2 left out:

    delta, delta_a, delta_f, theta_a, theta_f; t_zm, t_z, t_zF, t_zR; R_m, beta_m, d_m; R_e, R_i, beta_e, beta_i (`cone_distances`,
    `spiral_angles` are (outer, inner)); x_sm, s_mn, s_mt, d_mn, s_mnc, h_amc.
    """

    teeth: int
    pitch_angle: float
    face_angle: float
    root_angle: float
    addendum_angle: float
    dedendum_angle: float
    crossing_distance: float
    pitch_apex: float
    face_apex: float
    root_apex: float
    mean_cone_distance: float
    mean_spiral_angle: float
    face: FaceSpan
    spiral_angles: tuple[float, float]
    mean_depth: ToothDepth
    thickness_modification: float
    normal_thickness: float
    normal_diameter: float

    @property
    def cone_distances(self) -> tuple[float, float]:
        """R_e, R_i [ISO 23509 (122), (123), (216), (217)]."""
        return self.mean_cone_distance + self.face.outer, self.mean_cone_distance - self.face.inner

    @property
    def mean_diameter(self) -> float:
        """d_m."""
        return self.pitch_diameter(self.mean_cone_distance)

    def pitch_diameter(self, cone_distance: float) -> float:
        """d_m, d_e, d_i [ISO 23509 (110), (124), (125), (218), (219)]."""
        return float(2.0 * cone_distance * np.sin(self.pitch_angle))

    def depth(self, cone_distance: float) -> ToothDepth:
        """h_ae, h_fe, h_ai, h_fi [ISO 23509 (195)-(200)]."""
        longer = cone_distance - self.mean_cone_distance
        return ToothDepth(
            float(self.mean_depth.addendum + longer * np.tan(self.addendum_angle)),
            float(self.mean_depth.dedendum + longer * np.tan(self.dedendum_angle)),
        )

    def tip_diameter(self, cone_distance: float) -> float:
        """d_ae, d_ai [ISO 23509 (220), (222)]."""
        across = 2.0 * self.depth(cone_distance).addendum * np.cos(self.pitch_angle)
        return float(self.pitch_diameter(cone_distance) + across)

    def root_diameter(self, cone_distance: float) -> float:
        """d_fe, d_fi [ISO 23509 (221), (223)]."""
        across = 2.0 * self.depth(cone_distance).dedendum * np.cos(self.pitch_angle)
        return float(self.pitch_diameter(cone_distance) - across)

    def crown(self, cone_distance: float) -> float:
        """t_xo, t_xi: from the crossing point to the tip along the axis [ISO 23509 (224), (225)]."""
        longer, addendum = cone_distance - self.mean_cone_distance, self.depth(cone_distance).addendum
        return float(self.crossing_distance + longer * np.cos(self.pitch_angle) - addendum * np.sin(self.pitch_angle))

    @property
    def transverse_thickness(self) -> float:
        """s_mt [ISO 23509 (212)]."""
        return float(self.normal_thickness / np.cos(self.mean_spiral_angle))

    @property
    def chordal_thickness(self) -> float:
        """s_mnc [ISO 23509 (214)]."""
        return float(self.normal_diameter * np.sin(self.normal_thickness / self.normal_diameter))

    @property
    def chordal_addendum(self) -> float:
        """h_amc [ISO 23509 (215)]."""
        rise = 1.0 - np.cos(self.normal_thickness / self.normal_diameter)
        return float(self.mean_depth.addendum + 0.5 * self.normal_diameter * np.cos(self.pitch_angle) * rise)


@dataclass(frozen=True)
class BevelDimensions:
    """Both members and what they share: the pitch cones, the planes of tip and root (`cones`), the pressure angles of drive and
    coast side, their mean alpha_n, the working depth h_mw, the clearance c and what leads to the pinion's face.
    """

    pitch: PitchCones
    cones: BlankCones
    pinion: MemberDimensions
    wheel: MemberDimensions
    drive: PressureAngles
    coast: PressureAngles
    working_depth: float
    clearance: float
    pinion_face: PinionFace

    @property
    def pressure_angle(self) -> float:
        """alpha_n [ISO 23509 (201)]."""
        return 0.5 * (self.drive.generated + self.coast.generated)

    @property
    def outer_transverse_module(self) -> float:
        """m_et2 [ISO 23509 (126)]."""
        return self.wheel.pitch_diameter(self.wheel.cone_distances[0]) / self.wheel.teeth

    @property
    def pinion_whole_depth(self) -> float:
        """h_t1: of the pinion's outer end, across its root cone [ISO 23509 (226)]."""
        own = self.pinion
        along = (own.face_apex + own.crown(own.cone_distances[0])) / np.cos(own.face_angle)
        apart = (own.root_apex - own.face_apex) * np.sin(own.root_angle)
        return float(along * np.sin(own.addendum_angle + own.dedendum_angle) - apart)


def bevel_dimensions(
    pitch: PitchCones,
    cutter: FaceCutter,
    factors: ToothFactors,
    taper: str | tuple[float, float],
    backlash: Backlash = NO_BACKLASH,
) -> BevelDimensions:
    """The dimensions of a pair by its pitch cones, cutter and proportions; `taper` is one of TAPERS, or the wheel's addendum and
    dedendum angles theta_a2, theta_f2.

    Raises DesignError, naming the key, for what cannot exist.
    """
    module, line = pitch.mean_normal_module, pitch.tooth_line(cutter)
    ends = pitch.outer_cone_distance, pitch.inner_cone_distance
    if not ends[1] > abs(pitch.pitch_plane_offset):
        raise DesignError(
            "face_width",
            pitch.face_width,
            unit="mm",
            reason="the wheel's face would reach the pinion's axis in the pitch plane",
            allowed=f"less than {at_most(pitch.outer_cone_distance - abs(pitch.pitch_plane_offset))} mm",
        )
    reaching(line, ends)
    drive, coast = pressure_angles(factors, pitch.limit_pressure_angle)
    pressure = 0.5 * (drive.generated + coast.generated)
    # (132)-(139)
    working, clearance = 2.0 * module * factors.addendum, module * (factors.dedendum - factors.addendum)
    shift = factors.profile_shift * module
    first, second = (
        ToothDepth(module * factors.addendum + more, module * factors.dedendum - more) for more in (shift, -shift)
    )
    if isinstance(taper, str):
        if cutter.blade_groups and taper in CUTTER_TAPERS:
            raise DesignError(
                "taper",
                taper,
                shown=f"{taper!r}",
                reason="is of face milling; allowed with blade_groups are uniform and standard",
            )
        dedenda = first.dedendum, second.dedendum
        taper = taper_angles(taper, pitch, dedenda, second.addendum, working, pressure, cutter.radius)
    cones = blank_cones(pitch, taper, (second.addendum, second.dedendum), clearance)
    face = _pinion_face(pitch, line, cones, working, (first.addendum, second.dedendum - clearance))
    mean = pitch.mean_cone_distances[1]
    spans = face.span, FaceSpan(ends[0] - mean, mean - ends[1])
    wheel_spirals = float(line.spiral_angle_at(ends[0])), float(line.spiral_angle_at(ends[1]))
    thinner = 0.25 * backlash.at_mean(pitch, wheel_spirals[0], pressure) / module
    pinion, wheel = (
        _member(k, pitch, cones, span, spirals, depth, pressure, (more, modification - thinner))
        for k, span, spirals, depth, more, modification in (
            (0, spans[0], face.spiral_angles, first, 2.0 * shift, factors.thickness),
            (1, spans[1], wheel_spirals, second, -2.0 * shift, -factors.thickness),
        )
    )
    return BevelDimensions(pitch, cones, pinion, wheel, drive, coast, working, clearance, face)


def _member(
    k: int,
    pitch: PitchCones,
    cones: BlankCones,
    span: FaceSpan,
    spirals: tuple[float, float],
    depth: ToothDepth,
    pressure: float,
    thicker: tuple[float, float],
) -> MemberDimensions:
    """The member `k`; `thicker`: its addendum less its mating gear's (mm), and its thickness modification."""
    angle, spiral = pitch.pitch_angles[k], pitch.spiral_angles[k]
    # (213)
    normal = (1.0 - (np.sin(spiral) * np.cos(pressure)) ** 2) * np.cos(angle)
    return MemberDimensions(
        teeth=pitch.teeth[k],
        pitch_angle=angle,
        face_angle=cones.face_angles[k],
        root_angle=cones.root_angles[k],
        addendum_angle=cones.face_angles[k] - angle,
        dedendum_angle=angle - cones.root_angles[k],
        crossing_distance=pitch.crossing_distances[k],
        pitch_apex=pitch.pitch_apexes[k],
        face_apex=cones.face_apexes[k],
        root_apex=cones.root_apexes[k],
        mean_cone_distance=pitch.mean_cone_distances[k],
        mean_spiral_angle=spiral,
        face=span,
        spiral_angles=spirals,
        mean_depth=depth,
        thickness_modification=thicker[1],
        normal_thickness=normal_thickness(pitch.mean_normal_module, *thicker, pressure),
        normal_diameter=float(pitch.mean_diameters[k] / normal),
    )


def _pinion_face(
    pitch: PitchCones, line: ToothLine, cones: BlankCones, working: float, depths: tuple[float, float]
) -> PinionFace:
    """The pinion's face by the method of the pitch cones; `depths`: its mean addendum, and the wheel's dedendum less clearance."""
    across, mean = pitch.pitch_plane_offset, pitch.mean_cone_distances[1]
    outer, middle, inner = (
        math.sqrt(r**2 - across**2) for r in (pitch.outer_cone_distance, mean, pitch.inner_cone_distance)
    )
    # (154), (155)
    plane, front = outer - inner, middle - inner
    auxiliary = projected = 0.0
    share, apart = pitch.face_width_factor, pitch.offset_angle
    if pitch.method == 1:
        span, auxiliary, projected = _gleason_face(pitch, cones, working, depths)
    elif pitch.method == 3:
        # (170)-(173): whole millimetres
        whole = math.floor(plane + 3.0 * pitch.mean_normal_module * abs(math.tan(apart)) + 1.0)
        within = front + 0.5 * (whole - plane)
        span = FaceSpan(whole - within, within)
    else:
        # (156)-(158), (167)-(169)
        width = pitch.face_width * (1.0 + math.tan(apart) ** 2)
        span = FaceSpan(share * width, width - share * width)
    # (174), (175)
    reached = [math.hypot(mean + b * math.cos(apart), b * math.sin(apart)) for b in (span.outer, -span.inner)]
    reaching(line, tuple(reached))
    turned = [float(line.spiral_angle_at(distance)) for distance in reached]
    offsets = [math.asin(across / distance) for distance in reached]
    return PinionFace(
        span,
        plane,
        front,
        auxiliary,
        projected,
        (reached[0], reached[1]),
        (turned[0], turned[1]),
        (offsets[0], offsets[1]),
    )


def _gleason_face(
    pitch: PitchCones, cones: BlankCones, working: float, depths: tuple[float, float]
) -> tuple[FaceSpan, float, float]:
    """The pinion's face by method 1, lambda' and b_reri1 [ISO 23509 (159)-(166)]."""
    (first, second), apart, share = pitch.pitch_angles, pitch.offset_angle, pitch.face_width_factor
    face, (addendum, below) = cones.face_angles[0], depths
    along = pitch.ratio * math.cos(first) + math.cos(second) * math.cos(apart)
    auxiliary = math.atan(math.sin(apart) * math.cos(second) / along)
    width = pitch.face_width * math.cos(auxiliary) / math.cos(apart - auxiliary)
    # from the mean point along the pinion's axis, then along its pitch cone
    turned = math.cos(face) / math.cos(face - first)
    more = working * math.sin(cones.root_plane.offset_angle) * (1.0 - 1.0 / pitch.ratio)
    drop = (addendum - below) * math.sin(first)
    outer, inner = (part * width * turned + more for part in (share, 1.0 - share))
    return FaceSpan((outer + drop) / turned, (inner - drop) / turned), auxiliary, width
