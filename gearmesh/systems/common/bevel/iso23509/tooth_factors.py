"""Tooth proportions, their suggested values, and thicknesses with backlash [ISO 23509:2016 tables 3, 4]."""

from __future__ import annotations

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.iso23509.pitch_cones import PitchCones

#: depth factor k_d by number of pinion teeth below 12 (spiral bevel, AGMA 2005); 2 for 12 and more
DEPTH_FACTORS = {6: 1.765, 7: 1.835, 8: 1.895, 9: 1.940, 10: 1.975, 11: 1.995}
#: k_c: clearance over mean working depth
CLEARANCE_FACTOR = 0.125
#: rows: largest outer transverse module (mm), least normal backlash (mm) for ISO 17485 grades up to FINE_GRADE and for
#: coarser grades [AGMA 2005-D03, minimum normal backlash; sample 1 of ISO 23509 has the finer value: 0.127 for module
#: 4.54]
MIN_BACKLASH_ROWS = (
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
#: coarsest ISO 17485 grade of the first column of backlashes
FINE_GRADE = 7
#: smallest module of the table (mm); outside the table the backlash is proportional to the module
MIN_TABLE_MODULE = 1.0
#: places of a backlash: at the outer or mean cone distance, normal to the flanks or along the wheel's pitch circle
BACKLASH_NAMES = ("outer_normal", "outer_transverse", "mean_normal", "mean_transverse")


@dataclass(frozen=True)
class ToothFactors:
    """Proportions of a pair, data of type I.

    Raises DesignError, naming the key.
    """

    #: nominal pressure angle alpha_dD of the drive side, rad
    drive_pressure_angle: float
    #: nominal pressure angle alpha_dC of the coast side, rad
    coast_pressure_angle: float
    #: f_alim: share of the limit pressure angle by which the generated pressure angles differ from the nominal ones
    limit_share: float
    #: profile shift x_hm1, in mean normal modules
    profile_shift: float
    #: basic addendum k_hap, in mean normal modules
    addendum: float
    #: basic dedendum k_hfp, in mean normal modules
    dedendum: float
    #: thickness modification x_smn of the pinion, in mean normal modules
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
        """Return the proportions by data of type II [ISO 23509 table 4].

        - `pressure_angles`: nominal pressure angles of drive and coast side, rad
        - `limit_share`: f_alim
        - `addendum_factor`: c_ham: mean addendum of the wheel over the working depth
        - `depth_factor`: k_d: working depth in mean normal modules
        - `clearance_factor`: k_c: clearance over the working depth
        - `thickness_factor`: k_t: pinion thickness beyond half the pitch and the addenda, in mean normal modules
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
    """Pressure angles of one side."""

    #: generated pressure angle alpha_n, rad
    generated: float
    #: effective pressure angle alpha_e, rad, from the limit pressure angle
    effective: float


def pressure_angles(factors: ToothFactors, limit: float) -> tuple[PressureAngles, PressureAngles]:
    """Return the pressure angles of drive and coast side by the limit pressure angle (rad) [ISO 23509 (118)-(121)]."""
    drive = factors.drive_pressure_angle + factors.limit_share * limit
    coast = factors.coast_pressure_angle - factors.limit_share * limit
    return PressureAngles(drive, drive - limit), PressureAngles(coast, coast + limit)


@dataclass(frozen=True)
class Backlash:
    """Backlash of a pair; each member is thinned for half of it.

    Raises DesignError, naming the key.
    """

    #: backlash, mm
    value: float = 0.0
    #: place of the backlash, a name in BACKLASH_NAMES
    measured: str = "mean_normal"

    def __post_init__(self) -> None:
        if self.measured not in BACKLASH_NAMES:
            raise DesignError(
                "backlash_measured",
                self.measured,
                shown=f"{self.measured!r}",
                must_be=f"one of {', '.join(BACKLASH_NAMES)}",
            )
        if not self.value >= 0.0:
            raise DesignError("backlash", self.value, unit="mm", allowed="0 or more")

    def at_mean(self, cones: PitchCones, outer_spiral_angle: float, pressure_angle: float) -> float:
        """Return the backlash along the normal pitch line at the mean cone distance (mm) [ISO 23509 (202)-(205)].

        - `cones`: pitch cones of both members
        - `outer_spiral_angle`: outer spiral angle of the wheel, rad
        - `pressure_angle`: mean normal pressure angle, rad
        """
        where, along = self.measured.split("_")
        size = self.value * cones.mean_cone_distances[1] / cones.outer_cone_distance if where == "outer" else self.value
        mean = np.cos(cones.spiral_angles[1])
        if along == "transverse":
            return float(size * mean)
        turned = mean / np.cos(outer_spiral_angle) if where == "outer" else 1.0
        return float(size * turned / np.cos(pressure_angle))


#: a pair without backlash
NO_BACKLASH = Backlash()


def normal_thickness(module: float, addendum_difference: float, modification: float, pressure_angle: float) -> float:
    """Return the mean normal circular thickness s_mn (mm) of a member [ISO 23509 (206), (211)].

    - `module`: mean normal module, mm
    - `addendum_difference`: addendum less the mating gear's addendum, mm
    - `modification`: thickness modification x_sm, in modules
    - `pressure_angle`: mean normal pressure angle, rad
    """
    return float(0.5 * np.pi * module + addendum_difference * np.tan(pressure_angle) + 2.0 * modification * module)


def suggested_backlash(module: float, grade: int) -> float:
    """Return the least normal backlash (mm) by the outer transverse module (mm) and the ISO 17485 grade of accuracy."""
    column, largest = 1 if grade <= FINE_GRADE else 2, MIN_BACKLASH_ROWS[-1][0]
    within = min(max(module, MIN_TABLE_MODULE), largest)
    row = next(row for row in MIN_BACKLASH_ROWS if within <= row[0])
    return row[column] * module / within


def suggested_depth_factor(teeth: tuple[int, int]) -> float:
    """Return k_d by the pinion's number of teeth."""
    return DEPTH_FACTORS.get(max(teeth[0], min(DEPTH_FACTORS)), 2.0)


def suggested_addendum_factor(teeth: tuple[int, int], pitch_angles: tuple[float, float]) -> float:
    """Return c_ham by the ratio of the equivalent numbers of teeth."""
    pinion_cosine, gear_cosine = np.cos(pitch_angles)
    return float(0.21 + 0.29 / (teeth[1] * pinion_cosine / (teeth[0] * gear_cosine)))


def suggested_thickness_factor(teeth: tuple[int, int]) -> float:
    """Return k_t by the gear ratio and the pinion's number of teeth."""
    ratio = teeth[1] / teeth[0]
    more = -0.088 + 0.092 * ratio - 0.004 * ratio**2 + 0.0016 * (teeth[0] - 30) * (ratio - 1.0)
    return max(more, 0.0)
