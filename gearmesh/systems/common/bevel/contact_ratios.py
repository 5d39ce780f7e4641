"""Contact ratios of a bevel pair on its sheet: of the virtual cylindrical gears, and of the tooth line along the face.

Virtual gears [ISO 10300-1:2014, annex A]: in the transverse section at the mean point both pitch cones unroll to
circles of d_v = d_m / cos(delta). The virtual gears have the mean addenda of the teeth and the pressure angle
tan(alpha_vt) = tan(alpha_n) / cos(beta_v). beta_v is the mean of both spiral angles, which differ with offset.

The face contact ratio is the turn of the tooth line about the crown gear's centre from the gear's toe to its heel, in
pitches. It is exact for the circle or epicycloid of the cutter. Contact analysis determines the part of both ratios that
a localised contact covers.
"""

from __future__ import annotations

import numpy as np

from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.blank import BevelBlank


@dataclass(frozen=True)
class BevelContactRatios:
    """Contact ratios of a pair."""

    #: transverse contact ratio eps_v_alpha
    transverse: float
    #: face contact ratio eps_v_beta
    face: float

    @property
    def modified_ratio(self) -> float:
        """Modified contact ratio eps_v_gamma: root of the sum of both squares [AGMA 2003-B97; ISO 10300-1:2001]."""
        return float(np.hypot(self.transverse, self.face))


def contact_ratios(blank: BevelBlank) -> BevelContactRatios:
    """Return the contact ratios of a blank and its nominal cutter."""
    spiral = 0.5 * (blank.pinion.spiral_angle + blank.gear.spiral_angle)
    transverse = np.arctan(np.tan(blank.pressure_angle) / np.cos(spiral))
    radii, reaches = [], []
    for member in (blank.pinion, blank.gear):
        radius = member.mean_cone_distance * np.tan(member.pitch_angle)
        base = radius * np.cos(transverse)
        radii.append(radius)
        reaches.append(np.sqrt((radius + member.mean_addendum) ** 2 - base**2))
    # length of the path of contact of the virtual gears, over the transverse base pitch
    path = sum(reaches) - sum(radii) * np.sin(transverse)
    pitch = np.pi * blank.mean_normal_module / np.cos(spiral) * np.cos(transverse)
    return BevelContactRatios(float(path / pitch), _face_ratio(blank))


def _face_ratio(blank: BevelBlank) -> float:
    """Return the turn of the tooth line about the crown gear's centre from toe to heel, in pitches."""
    line = blank.tooth_line
    if np.isinf(blank.cutter_radius):
        # a straight line turns about the centre as its spiral angle falls
        toe, heel = (float(line.spiral_angle_at(distance)) for distance in blank.gear.extent)
        return (toe - heel) * float(line.crown_teeth) / (2.0 * np.pi)
    turns = [float(line.turn_at(distance)) for distance in blank.gear.extent]
    # the line reverses where the circle is tangent to a ray, as in the middle of a zerol gear's face
    return abs(turns[1] - turns[0]) * float(line.crown_teeth) / (2.0 * np.pi)
