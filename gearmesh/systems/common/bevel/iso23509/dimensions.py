"""All dimensions of a bevel or hypoid pair, with or without offset, by ISO 23509:2016, clause 7.

Lengths in mm, angles in rad. "Mean" is at the mean point, "outer" and "inner" at the ends of the member's face. The
crossing point of a member is the foot of the common perpendicular on its axis; without offset both members have the
same crossing point. Apexes count from it, > 0 away from the teeth.

Depths are across the pitch cone. The standard counts the clearance across the root line for the pinion's tip and root
cones, but across the pitch cone for the pinion's depths. Outside diameter and tip cone of the pinion therefore differ
by some micrometres. Both are given as in the standard.
"""

from __future__ import annotations

import math

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.iso23509.blank_cones import BlankCones, blank_cones
from gearmesh.systems.common.bevel.iso23509.pitch_cones import PitchCones
from gearmesh.systems.common.bevel.iso23509.taper_names import CUTTER_TAPERS
from gearmesh.systems.common.bevel.iso23509.tapers import taper_angles
from gearmesh.systems.common.bevel.iso23509.tooth_factors import (
    NO_BACKLASH,
    Backlash,
    PressureAngles,
    ToothFactors,
    normal_thickness,
    pressure_angles,
)
from gearmesh.systems.common.bevel.iso23509.tooth_line import FaceCutter, ToothLine, reaching


@dataclass(frozen=True)
class FaceSpan:
    """Face of a member along its pitch cone."""

    #: b_e: length outside the mean point, mm
    outer: float
    #: b_i: length inside the mean point, mm
    inner: float

    @property
    def width(self) -> float:
        """Face width b, mm."""
        return self.outer + self.inner


@dataclass(frozen=True)
class PinionFace:
    """Face of the pinion, and the intermediate values from which it follows; tuples are (outer, inner) ends."""

    #: face along the pinion's pitch cone
    span: FaceSpan
    #: b_p1: face width in the pitch plane, mm
    pitch_plane_width: float
    #: b_1A: face width from mean point to front crown in the pitch plane, mm
    front_crown_width: float
    #: lambda', rad, in method 1; else 0
    auxiliary_angle: float
    #: b_reri1, mm, in method 1; else 0
    projected_width: float
    #: R_e21, R_i21: wheel cone distances at the ends of the pinion's face, mm
    wheel_cone_distances: tuple[float, float]
    #: beta_e21, beta_i21: wheel spiral angles at the ends of the pinion's face, rad
    wheel_spiral_angles: tuple[float, float]
    #: zeta_ep21, zeta_ip21: offset angles at the ends of the pinion's face, rad
    offset_angles: tuple[float, float]

    @property
    def spiral_angles(self) -> tuple[float, float]:
        """Spiral angles of the pinion at its ends, beta_e1 and beta_i1 [ISO 23509 (187), (188)]."""
        outer, inner = (
            spiral + offset for spiral, offset in zip(self.wheel_spiral_angles, self.offset_angles, strict=True)
        )
        return outer, inner


@dataclass(frozen=True)
class ToothDepth:
    """Depth of a tooth at a cone distance."""

    #: addendum h_a, mm
    addendum: float
    #: dedendum h_f, mm
    dedendum: float

    @property
    def whole(self) -> float:
        """Whole depth h, mm."""
        return self.addendum + self.dedendum


@dataclass(frozen=True)
class MemberDimensions:
    """Dimensions of one member; index 1 or 2 is left out of the symbols of ISO 23509."""

    #: number of teeth
    teeth: int
    #: pitch angle delta, rad
    pitch_angle: float
    #: face angle delta_a, rad
    face_angle: float
    #: root angle delta_f, rad
    root_angle: float
    #: addendum angle theta_a, rad
    addendum_angle: float
    #: dedendum angle theta_f, rad
    dedendum_angle: float
    #: t_zm: distance from crossing point to mean point along the axis, mm
    crossing_distance: float
    #: t_z: pitch apex beyond the crossing point, mm
    pitch_apex: float
    #: t_zF: apex of the tip cone beyond the crossing point, mm
    face_apex: float
    #: t_zR: apex of the root cone beyond the crossing point, mm
    root_apex: float
    #: mean cone distance R_m, mm
    mean_cone_distance: float
    #: mean spiral angle beta_m, rad
    mean_spiral_angle: float
    #: face along the pitch cone
    face: FaceSpan
    #: outer and inner spiral angle, beta_e and beta_i, rad
    spiral_angles: tuple[float, float]
    #: mean addendum and dedendum
    mean_depth: ToothDepth
    #: thickness modification coefficient x_sm
    thickness_modification: float
    #: mean normal circular thickness s_mn, mm
    normal_thickness: float
    #: mean normal diameter d_mn, mm
    normal_diameter: float

    @property
    def cone_distances(self) -> tuple[float, float]:
        """Outer and inner cone distance, R_e and R_i [ISO 23509 (122), (123), (216), (217)]."""
        return self.mean_cone_distance + self.face.outer, self.mean_cone_distance - self.face.inner

    @property
    def mean_diameter(self) -> float:
        """Mean pitch diameter d_m."""
        return self.pitch_diameter(self.mean_cone_distance)

    def pitch_diameter(self, cone_distance: float) -> float:
        """Return the pitch diameter at a cone distance: d_m, d_e, d_i [ISO 23509 (110), (124), (125), (218), (219)]."""
        return float(2.0 * cone_distance * np.sin(self.pitch_angle))

    def depth(self, cone_distance: float) -> ToothDepth:
        """Return addendum and dedendum at a cone distance: h_ae, h_fe, h_ai, h_fi [ISO 23509 (195)-(200)]."""
        longer = cone_distance - self.mean_cone_distance
        return ToothDepth(
            float(self.mean_depth.addendum + longer * np.tan(self.addendum_angle)),
            float(self.mean_depth.dedendum + longer * np.tan(self.dedendum_angle)),
        )

    def tip_diameter(self, cone_distance: float) -> float:
        """Return the tip diameter at a cone distance: d_ae, d_ai [ISO 23509 (220), (222)]."""
        across = 2.0 * self.depth(cone_distance).addendum * np.cos(self.pitch_angle)
        return float(self.pitch_diameter(cone_distance) + across)

    def root_diameter(self, cone_distance: float) -> float:
        """Return the root diameter at a cone distance: d_fe, d_fi [ISO 23509 (221), (223)]."""
        across = 2.0 * self.depth(cone_distance).dedendum * np.cos(self.pitch_angle)
        return float(self.pitch_diameter(cone_distance) - across)

    def crown(self, cone_distance: float) -> float:
        """Return the distance along the axis from crossing point to tip: t_xo, t_xi [ISO 23509 (224), (225)]."""
        longer, addendum = cone_distance - self.mean_cone_distance, self.depth(cone_distance).addendum
        return float(self.crossing_distance + longer * np.cos(self.pitch_angle) - addendum * np.sin(self.pitch_angle))

    @property
    def transverse_thickness(self) -> float:
        """Mean transverse circular thickness s_mt [ISO 23509 (212)]."""
        return float(self.normal_thickness / np.cos(self.mean_spiral_angle))

    @property
    def chordal_thickness(self) -> float:
        """Mean normal chordal thickness s_mnc [ISO 23509 (214)]."""
        return float(self.normal_diameter * np.sin(self.normal_thickness / self.normal_diameter))

    @property
    def chordal_addendum(self) -> float:
        """Mean chordal addendum h_amc [ISO 23509 (215)]."""
        rise = 1.0 - np.cos(self.normal_thickness / self.normal_diameter)
        return float(self.mean_depth.addendum + 0.5 * self.normal_diameter * np.cos(self.pitch_angle) * rise)


@dataclass(frozen=True)
class BevelDimensions:
    """Dimensions of both members and the data that they share."""

    #: pitch cones of both members
    pitch: PitchCones
    #: tip and root cones of both members, and their planes
    cones: BlankCones
    #: dimensions of the pinion
    pinion: MemberDimensions
    #: dimensions of the wheel
    wheel: MemberDimensions
    #: pressure angles of the drive side
    drive: PressureAngles
    #: pressure angles of the coast side
    coast: PressureAngles
    #: mean working depth h_mw, mm
    working_depth: float
    #: clearance c, mm
    clearance: float
    #: face of the pinion and its intermediate values
    pinion_face: PinionFace

    @property
    def pressure_angle(self) -> float:
        """Mean normal pressure angle alpha_n [ISO 23509 (201)]."""
        return 0.5 * (self.drive.generated + self.coast.generated)

    @property
    def outer_transverse_module(self) -> float:
        """Outer transverse module of the wheel, m_et2 [ISO 23509 (126)]."""
        return self.wheel.pitch_diameter(self.wheel.cone_distances[0]) / self.wheel.teeth

    @property
    def pinion_whole_depth(self) -> float:
        """Whole depth h_t1 at the pinion's outer end, across its root cone [ISO 23509 (226)]."""
        pinion = self.pinion
        along = (pinion.face_apex + pinion.crown(pinion.cone_distances[0])) / np.cos(pinion.face_angle)
        root_shift = (pinion.root_apex - pinion.face_apex) * np.sin(pinion.root_angle)
        return float(along * np.sin(pinion.addendum_angle + pinion.dedendum_angle) - root_shift)


def bevel_dimensions(
    pitch: PitchCones,
    cutter: FaceCutter,
    factors: ToothFactors,
    taper: str | tuple[float, float],
    backlash: Backlash = NO_BACKLASH,
) -> BevelDimensions:
    """Return the dimensions of a pair by its pitch cones, cutter and proportions.

    - `pitch`: pitch cones of both members
    - `cutter`: face cutter of the wheel
    - `factors`: pressure angles and proportions
    - `taper`: a name in TAPER_NAMES, or addendum and dedendum angle of the wheel, theta_a2 and theta_f2, rad
    - `backlash`: backlash of the pair

    Raises DesignError, naming the key, for dimensions that cannot exist.
    """
    module, line = pitch.mean_normal_module, pitch.tooth_line(cutter)
    ends = pitch.outer_cone_distance, pitch.inner_cone_distance
    if not ends[1] > abs(pitch.pitch_plane_offset):
        raise DesignError(
            "face_width",
            pitch.face_width,
            unit="mm",
            reason="the wheel's face would reach the pinion's axis in the pitch plane",
            allowed=Allowed.less_than(pitch.outer_cone_distance - abs(pitch.pitch_plane_offset), "mm"),
        )
    reaching(line, ends)
    drive, coast = pressure_angles(factors, pitch.limit_pressure_angle)
    pressure = 0.5 * (drive.generated + coast.generated)
    # mean depths: (132)-(139)
    working, clearance = 2.0 * module * factors.addendum, module * (factors.dedendum - factors.addendum)
    shift = factors.profile_shift * module
    pinion_depth, wheel_depth = (
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
        dedenda = pinion_depth.dedendum, wheel_depth.dedendum
        taper = taper_angles(taper, pitch, dedenda, wheel_depth.addendum, working, pressure, cutter.radius)
    # the pinion's cones follow from the wheel's, and its face from both
    cones = blank_cones(pitch, taper, (wheel_depth.addendum, wheel_depth.dedendum), clearance)
    face = _pinion_face(pitch, line, cones, working, (pinion_depth.addendum, wheel_depth.dedendum - clearance))
    mean = pitch.mean_cone_distances[1]
    spans = face.span, FaceSpan(ends[0] - mean, mean - ends[1])
    wheel_spirals = float(line.spiral_angle_at(ends[0])), float(line.spiral_angle_at(ends[1]))
    # each member's thickness modification coefficient is reduced by half of the backlash
    thinner = 0.25 * backlash.at_mean(pitch, wheel_spirals[0], pressure) / module
    pinion, wheel = (
        _member(k, pitch, cones, span, spirals, depth, pressure, (more, modification - thinner))
        for k, span, spirals, depth, more, modification in (
            (0, spans[0], face.spiral_angles, pinion_depth, 2.0 * shift, factors.thickness),
            (1, spans[1], wheel_spirals, wheel_depth, -2.0 * shift, -factors.thickness),
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
    """Return the dimensions of member `k` (0 pinion, 1 wheel).

    - `span`, `spirals`: its face and its spiral angles (outer, inner)
    - `depth`: its mean depths
    - `pressure`: mean normal pressure angle, rad
    - `thicker`: its addendum less its mating gear's (mm), and its thickness modification coefficient
    """
    angle, spiral = pitch.pitch_angles[k], pitch.spiral_angles[k]
    # mean normal diameter: (213)
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
    """Return the pinion's face by the method of the pitch cones.

    `depths`: the pinion's mean addendum, and the wheel's dedendum less the clearance, mm.
    """
    across, mean = pitch.pitch_plane_offset, pitch.mean_cone_distances[1]
    outer, middle, inner = (
        math.sqrt(r**2 - across**2) for r in (pitch.outer_cone_distance, mean, pitch.inner_cone_distance)
    )
    # face widths in the pitch plane: (154), (155)
    plane, front = outer - inner, middle - inner
    auxiliary = projected = 0.0
    share, offset_angle = pitch.face_width_factor, pitch.offset_angle
    if pitch.method == 1:
        span, auxiliary, projected = _gleason_face(pitch, cones, working, depths)
    elif pitch.method == 3:
        # width in whole millimetres: (170)-(173)
        whole_width = math.floor(plane + 3.0 * pitch.mean_normal_module * abs(math.tan(offset_angle)) + 1.0)
        within = front + 0.5 * (whole_width - plane)
        span = FaceSpan(whole_width - within, within)
    else:
        # width divided at the mean point like the wheel's: (156)-(158), (167)-(169)
        width = pitch.face_width * (1.0 + math.tan(offset_angle) ** 2)
        span = FaceSpan(share * width, width - share * width)
    # wheel cone distances at the ends of the pinion's face: (174), (175)
    reached = [
        math.hypot(mean + b * math.cos(offset_angle), b * math.sin(offset_angle)) for b in (span.outer, -span.inner)
    ]
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
    """Return the pinion's face, lambda' (rad) and b_reri1 (mm) by method 1 [ISO 23509 (159)-(166)]."""
    (pinion_angle, wheel_angle), offset_angle, share = pitch.pitch_angles, pitch.offset_angle, pitch.face_width_factor
    face, (addendum, below) = cones.face_angles[0], depths
    along = pitch.ratio * math.cos(pinion_angle) + math.cos(wheel_angle) * math.cos(offset_angle)
    auxiliary = math.atan(math.sin(offset_angle) * math.cos(wheel_angle) / along)
    width = pitch.face_width * math.cos(auxiliary) / math.cos(offset_angle - auxiliary)
    # from the mean point along the pinion's axis, then along its pitch cone
    turned = math.cos(face) / math.cos(face - pinion_angle)
    more = working * math.sin(cones.root_plane.offset_angle) * (1.0 - 1.0 / pitch.ratio)
    drop = (addendum - below) * math.sin(pinion_angle)
    outer, inner = (part * width * turned + more for part in (share, 1.0 - share))
    return FaceSpan((outer + drop) / turned, (inner - drop) / turned), auxiliary, width
