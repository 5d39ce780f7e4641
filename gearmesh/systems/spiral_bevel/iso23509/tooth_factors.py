"""Tooth proportions in mean normal modules, their suggested values, and thicknesses with backlash [ISO 23509:2016 tables 3, 4]."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.spiral_bevel.iso23509.pitch_cones import PitchCones

#: depth factor k_d by pinion teeth, for fewer than 12 (spiral bevel, AGMA 2005), 2 from there on
DEPTH_FACTORS = {6: 1.765, 7: 1.835, 8: 1.895, 9: 1.940, 10: 1.975, 11: 1.995}
#: clearance over mean working depth, k_c
CLEARANCE_FACTOR = 0.125
#: least normal backlash (mm) of outer transverse modules (mm) up to the first figure, for ISO 17485 grades up to FINE_GRADE and
#: coarser ones [AGMA 2005-D03, minimum normal backlash; ISO 23509 sample 1 has the first of both: 0.127 for 4.54]
LEAST_BACKLASH = (
    (1.5, 0.03, 0.05),
    (2.5, 0.05, 0.08),
    (3.0, 0.08, 0.10),
    (4.0, 0.10, 0.13),
    (5.0, 0.13, 0.15),
    (6.0, 0.15, 0.20),
    (8.0, 0.20, 0.25),
    (10.0, 0.25, 0.33),
    (12.0, 0.30, 0.41),
    (16.0, 0.38, 0.51),
    (20.0, 0.51, 0.69),
    (25.0, 0.61, 0.81),
)
FINE_GRADE = 7
#: smallest module of the table; smaller and larger ones have their part of what its ends have
LEAST_MODULE = 1.0
#: where a backlash is measured: at the outer or the mean cone distance, normal to the flanks or along the wheel's pitch circle
BACKLASHES = ("outer_normal", "outer_transverse", "mean_normal", "mean_transverse")


@dataclass(frozen=True)
class ToothFactors:
    """Data of type I: nominal pressure angles alpha_dD and alpha_dC (rad) of drive and coast side, `limit_share` f_alim of the
    limit pressure angle that is made up for; in mean normal modules the profile shift x_hm1, the basic addendum k_hap and
    dedendum k_hfp, and the pinion's thickness modification x_smn.

    Raises DesignError, naming the key.
    """

    drive_pressure_angle: float
    coast_pressure_angle: float
    limit_share: float
    profile_shift: float
    addendum: float
    dedendum: float
    thickness: float

    def __post_init__(self) -> None:
        if not self.addendum > 0.0:
            raise DesignError("addendum_factor", self.addendum, allowed="more than 0")
        if not self.dedendum >= self.addendum:
            raise DesignError(
                "dedendum_factor", self.dedendum, allowed=f"the addendum_factor, {self.addendum:g}, or more"
            )

    @classmethod
    def of_depths(
        cls,
        pressure_angles: tuple[float, float],
        limit_share: float,
        addendum_factor: float,
        depth_factor: float = 2.0,
        clearance_factor: float = CLEARANCE_FACTOR,
        thickness_factor: float = 0.0,
    ) -> ToothFactors:
        """Data of type II: the wheel's mean addendum over the working depth c_ham, the working depth k_d in modules, the
        clearance over it k_c, and the pinion's thickness k_t beyond half the pitch and the addenda [ISO 23509 table 4].
        """
        return cls(
            *pressure_angles,
            limit_share,
            profile_shift=depth_factor * (0.5 - addendum_factor),
            addendum=0.5 * depth_factor,
            dedendum=depth_factor * (clearance_factor + 0.5),
            thickness=0.5 * thickness_factor,
        )


@dataclass(frozen=True)
class PressureAngles:
    """Of one side (rad): `generated` alpha_n and `effective` alpha_e, which counts from the limit pressure angle."""

    generated: float
    effective: float


def pressure_angles(factors: ToothFactors, limit: float) -> tuple[PressureAngles, PressureAngles]:
    """Drive and coast side by the limit pressure angle (rad) [ISO 23509 (118)-(121)]."""
    drive = factors.drive_pressure_angle + factors.limit_share * limit
    coast = factors.coast_pressure_angle - factors.limit_share * limit
    return PressureAngles(drive, drive - limit), PressureAngles(coast, coast + limit)


@dataclass(frozen=True)
class Backlash:
    """A backlash of the pair (mm) and where it is measured: one of BACKLASHES; each member is thinned for half of it.

    Raises DesignError, naming the key.
    """

    value: float = 0.0
    measured: str = "mean_normal"

    def __post_init__(self) -> None:
        if self.measured not in BACKLASHES:
            raise DesignError(
                "backlash_measured",
                self.measured,
                shown=f"{self.measured!r}",
                must_be=f"one of {', '.join(BACKLASHES)}",
            )
        if not self.value >= 0.0:
            raise DesignError("backlash", self.value, unit="mm", allowed="0 or more")

    def at_mean(self, cones: PitchCones, outer_spiral_angle: float, pressure_angle: float) -> float:
        """The same backlash along the normal pitch line at the mean (mm), by the wheel's outer spiral angle and the mean normal
        pressure angle (rad) [ISO 23509 (202)-(205)].
        """
        where, along = self.measured.split("_")
        size = self.value * cones.mean_cone_distances[1] / cones.outer_cone_distance if where == "outer" else self.value
        mean = np.cos(cones.spiral_angles[1])
        if along == "transverse":
            return float(size * mean)
        turned = mean / np.cos(outer_spiral_angle) if where == "outer" else 1.0
        return float(size * turned / np.cos(pressure_angle))


#: none
NO_BACKLASH = Backlash()


def normal_thickness(module: float, addendum_difference: float, modification: float, pressure_angle: float) -> float:
    """s_mn: mean normal circular thickness (mm) by how much more addendum the member has than its mating gear (mm) and its
    thickness modification x_sm in modules [ISO 23509 (206), (211)].
    """
    return float(0.5 * np.pi * module + addendum_difference * np.tan(pressure_angle) + 2.0 * modification * module)


def suggested_backlash(module: float, grade: int) -> float:
    """Least normal backlash (mm) by the outer transverse module (mm) and the ISO 17485 grade of accuracy."""
    column, largest = 1 if grade <= FINE_GRADE else 2, LEAST_BACKLASH[-1][0]
    within = min(max(module, LEAST_MODULE), largest)
    row = next(row for row in LEAST_BACKLASH if within <= row[0])
    return row[column] * module / within


def suggested_depth_factor(teeth: tuple[int, int]) -> float:
    """k_d by the pinion's teeth."""
    return DEPTH_FACTORS.get(max(teeth[0], min(DEPTH_FACTORS)), 2.0)


def suggested_addendum_factor(teeth: tuple[int, int], pitch_angles: tuple[float, float]) -> float:
    """c_ham by the ratio of the equivalent teeth."""
    first, second = np.cos(pitch_angles)
    return float(0.21 + 0.29 / (teeth[1] * first / (teeth[0] * second)))


def suggested_thickness_factor(teeth: tuple[int, int]) -> float:
    """k_t by ratio and pinion teeth."""
    ratio = teeth[1] / teeth[0]
    more = -0.088 + 0.092 * ratio - 0.004 * ratio**2 + 0.0016 * (teeth[0] - 30) * (ratio - 1.0)
    return max(more, 0.0)
