"""Two-part head of a face-hobbed pair: cutter radius, and the eccentricity that crowns the teeth lengthwise.

One crown gear generates both members. At the mean point all blades cut tooth lines in one direction. Outer blades turn
at a larger radius than inner blades by the eccentricity, about another centre. An outer blade cuts the concave side of
one member, an inner blade the convex side of the other one. Both tooth lines touch at the mean point and part to both
ends of the face. Without eccentricity both members are conjugate, and touch along lines.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.blank import CUTTER_RADIUS_SHARE, BevelBlank, nominal_radius
from gearmesh.systems.common.bevel.cone_blank import ConeData
from gearmesh.systems.common.bevel.iso23509.tooth_line import ToothLine
from gearmesh.systems.common.bounds import at_least, at_most

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: usual cutter radii of two-part heads, mm
NOMINAL_HEAD_RADII_MM = (25.0, 30.0, 40.0, 55.0, 75.0, 100.0, 135.0, 170.0, 210.0, 260.0, 350.0, 450.0)
#: cutter radius over mean cone distance from which the nominal radius is chosen
HEAD_RADIUS_SHARE = 0.8
#: largest cutter radius over mean cone distance that is chosen where the usual radius does not clear the gear
LARGEST_HEAD_SHARE = 1.3
#: largest deviation of a nominal radius from the wanted one
MAX_RADIUS_DEVIATION = 0.25
#: largest lead angle of a head by default, rad
USUAL_LEAD_ANGLE = float(np.radians(30.0))
#: largest lead angle of a head, rad
MAX_LEAD_ANGLE = float(np.radians(45.0))
#: largest eccentricity, over the cutter radius
MAX_ECCENTRICITY_SHARE = 0.5
#: largest eccentricity that is chosen, over the cutter radius
CHOSEN_ECCENTRICITY_SHARE = 0.4


def refuse_hobbing(design: FaceMilledDesign, reason: str) -> None:
    """Raise DesignError for a face-hobbed design, with the `reason` why only face-milled ones go."""
    if design.hobbed:
        raise DesignError("process", design.process, shown=f'"{design.process}"', reason=reason, allowed="face milling")


def head_radius(design: FaceMilledDesign, mean_cone_distance: float, module: float) -> float:
    """Return the cutter radius (mm) of a design in mm: given, or the nominal radius nearest to the usual one.

    `module`: mean normal module, mm.
    """
    if design.head.radius is not None:
        return design.head.radius
    # many blade groups need a larger head
    least = 0.5 * design.head.blade_groups * module / np.sin(USUAL_LEAD_ANGLE)
    if design.milling_blank:
        # the tooth line of method 1 has the curvature of the limit normal: heads as large as those of face milling
        return nominal_radius(max(CUTTER_RADIUS_SHARE * mean_cone_distance, float(least)))
    wanted = max(HEAD_RADIUS_SHARE * mean_cone_distance, least)
    radii = np.array(NOMINAL_HEAD_RADII_MM)
    nearest = float(radii[np.abs(np.log(radii / wanted)).argmin()])
    return nearest if abs(nearest / wanted - 1.0) <= MAX_RADIUS_DEVIATION else float(wanted)


def larger_radii(radius: float, mean_cone_distance: float) -> list[float]:
    """Return usual radii (mm) of heads larger than a `radius`, up to the largest over a mean cone distance (mm), and that."""
    most = LARGEST_HEAD_SHARE * mean_cone_distance
    return [*(each for each in NOMINAL_HEAD_RADII_MM if radius < each < most), most]


def check_head(cones: ConeData) -> None:
    """Raise DesignError for a head that cannot cut the teeth of a pair from toe to heel."""
    pitch, line = cones.pitch, cones.pitch.tooth_line(cones.cutter)
    radius, groups = line.cutter.radius, line.cutter.blade_groups
    # the lead angle, sin(nu) = groups R_m cos(beta_m) / (r z_P) [ISO 23509 (98)], limits the radius from below
    least = groups * line.mean_cone_distance * np.cos(line.spiral_angle) / line.crown_teeth / np.sin(MAX_LEAD_ANGLE)
    if not radius >= least:
        raise DesignError(
            "head.radius",
            radius,
            unit="mm",
            reason=f"the lead angle of {groups} blade groups would be more than {np.degrees(MAX_LEAD_ANGLE):.3g} deg",
            allowed=f"{at_least(float(least))} mm or more, or a smaller head.blade_groups",
        )
    # the blade's path on the crown gear is between two circles, which must enclose the face
    toe, heel = pitch.inner_cone_distance, pitch.outer_cone_distance
    if line.reaches(toe) and line.reaches(heel):
        return
    raise DesignError(
        "head.radius",
        radius,
        unit="mm",
        reason=f"the head cuts from the cone distance {line.inner_distance:.6g} mm to "
        f"{float(line.centre_distance) + radius:.6g} mm",
        allowed=f"a radius that reaches the whole face, {at_most(toe)} to {at_least(heel)} mm",
    )


def check_eccentricity(eccentricity: float, radius: float) -> None:
    """Raise DesignError for a given eccentricity (mm) that is too large for a cutter of a radius (mm)."""
    most = MAX_ECCENTRICITY_SHARE * radius
    if eccentricity > most:
        raise DesignError(
            "head.eccentricity",
            eccentricity,
            unit="mm",
            reason=f"more than {MAX_ECCENTRICITY_SHARE:g} head.radius: the tooth lines of both sides would part too far",
            allowed=Allowed.between(0.0, most, "mm"),
        )


@dataclass(frozen=True)
class HeadLines:
    """Tooth lines of one side of the pinion and of the mating side of the gear, on their common crown gear."""

    #: nominal tooth line
    line: ToothLine
    #: cone distances of toe and heel, mm
    extent: tuple[float, float]
    #: normal pressure angle, rad
    pressure_angle: float

    @staticmethod
    def of(blank: BevelBlank, pressure_angle: float) -> HeadLines:
        """Return the lines of a blank, with the pressure angle (rad) of the side."""
        return HeadLines(blank.tooth_line, blank.gear.extent, pressure_angle)

    def crowning(self, eccentricity: Array) -> Array:
        """Return the normal gap (N,), mm, between both lines, the mean of toe and heel, for eccentricities (N,), mm."""
        outer, inner = (self._turns(0.5 * sign * eccentricity) for sign in (1.0, -1.0))
        toe_heel = np.array(self.extent)[:, None]
        across = toe_heel * np.cos(self.line.spiral_angle_at(toe_heel)) * np.cos(self.pressure_angle)
        # the more curved line of the inner blades turns less towards the head's centre at neither end
        return np.asarray((across * (inner - outer)).mean(axis=0))

    @property
    def largest_crowning(self) -> float:
        """Largest length crowning (mm) that is chosen; inf if lines of so different radii do not reach toe and heel."""
        most = np.array([CHOSEN_ECCENTRICITY_SHARE * self.line.cutter.radius])
        with np.errstate(invalid="ignore"):
            return float(np.nan_to_num(self.crowning(most)[0], nan=np.inf))

    def eccentricity(self, crowning: float) -> float:
        """Return the eccentricity (mm) with a length crowning (mm). Raises DesignError if there is none."""
        if crowning == 0.0:
            return 0.0
        most = np.array([MAX_ECCENTRICITY_SHARE * self.line.cutter.radius])
        with np.errstate(invalid="ignore"):
            root = bracketed_root(lambda x, _: self.crowning(x) - crowning, np.zeros(1), most)
        if not root.converged[0]:
            raise DesignError(
                "contact.ease_off.length_crowning",
                crowning,
                unit="mm",
                reason="no eccentricity of the head crowns the teeth so much",
                allowed=Allowed.between(0.0, float(np.nan_to_num(self.crowning(most)[0])), "mm"),
            )
        return float(root.values[0])

    def _turns(self, more: Array) -> Array:
        """Return the turns (2, N), rad, of a line from the mean point to toe and heel.

        `more`: excess (N,) of its radius, mm.
        """
        cutter = self.line.cutter
        lines = [replace(self.line, cutter=replace(cutter, radius=cutter.radius + own)) for own in np.atleast_1d(more)]
        return np.array([[own.turn_at(distance) for own in lines] for distance in self.extent])
