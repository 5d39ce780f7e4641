"""The blank of a member before its teeth are cut: a turned body, or the bar of a rack.

The axial half section of a turned blank goes round the profile of the body, then along the tip surface back over every
row of teeth. Hubs, shafts, bore and its steps, recesses of a web and the groove between halves are turned. Keyway,
holes and openings are cut later, and the edges of end faces are broken after the teeth are cut.

                 tip                        above the axis, with z to the right and the radius upwards,
       4 ___________________ 3              the section goes counterclockwise: 1 - 2 is the bore
        |    ___________    |
        |___|   bore    |___|
    ----- 1 ----------- 2 -------- z
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc, PlaneLine
from gearmesh.kernel.surface.levels import LandLevel
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import end_regions
from gearmesh.teeth.blank.halves import HalfGear
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.limits import crossing
from gearmesh.teeth.region import BODY_REGIONS, FEATURE_REGIONS, GAP_REGIONS, RARE_REGIONS, Region

#: length of a band that counts as 0
ZERO_LENGTH_MM = 1e-9
#: largest distance of a tip's points from a line or an arc that the tip is
MAX_SHAPE_MISS_MM = 1e-9
#: points of a piece of a tip that show its shape
SHAPE_POINTS = 17
#: Gauss nodes on a smooth band for the volume
VOLUME_NODES = 24
#: regions of turned blanks, in the order of the files
BLANK_REGIONS = (Region.LAND, *BODY_REGIONS, *RARE_REGIONS, *GAP_REGIONS, *FEATURE_REGIONS)


@dataclass(frozen=True)
class TipCurve:
    """A smooth piece of a tip surface over (z, rho), mm, between two of its stations."""

    #: blank with the tip surface
    blank: Blank
    #: row of teeth
    half: HalfGear
    #: first and last station, mm
    stations: tuple[float, float]

    def at(self, s: Array) -> Array:
        """Return points (K, 2), mm, at s (K,) from 0 to 1."""
        first, last = self.stations
        rho, z = crossing(self.blank.tip, self.blank.axial, first + s * (last - first))
        points = self.half.points(np.stack((rho, np.zeros_like(rho), z), axis=-1))
        return points[:, [2, 0]]

    @property
    def start(self) -> Array:
        """First point (2,), mm."""
        return np.asarray(self.at(np.zeros(1))[0])

    @property
    def end(self) -> Array:
        """Last point (2,), mm."""
        return np.asarray(self.at(np.ones(1))[0])

    @property
    def shape(self) -> PlaneLine | PlaneArc | TipCurve:
        """The line or the arc that the piece is; otherwise the piece itself."""
        points = self.at(np.linspace(0.0, 1.0, SHAPE_POINTS))
        first, middle, last = points[0], points[SHAPE_POINTS // 2], points[-1]
        chord = last - first
        across = np.array([-chord[1], chord[0]]) / np.linalg.norm(chord)
        if np.abs((points - first) @ across).max() <= MAX_SHAPE_MISS_MM:
            return PlaneLine(first, last)
        # the centre is as far from all three points
        centre = np.linalg.solve(
            np.stack((middle - first, last - first)),
            0.5 * np.array([middle @ middle - first @ first, last @ last - first @ first]),
        )
        radius = float(np.linalg.norm(first - centre))
        if np.abs(np.linalg.norm(points - centre, axis=-1) - radius).max() > MAX_SHAPE_MISS_MM:
            return self
        angles = np.unwrap(np.arctan2(*(points - centre).T[::-1]))
        return PlaneArc(centre, radius, float(angles[0]), float(angles[-1] - angles[0]))


@dataclass(frozen=True)
class BlankBand:
    """A band of a turned blank: what its curve over (z, rho), mm, leaves when it turns about the axis."""

    region: Region
    curve: PlaneLine | PlaneArc | TipCurve


@dataclass(frozen=True)
class TurnedBlank:
    """Turned blank of a gear: its axial half section, closed and counterclockwise."""

    #: name of the member
    name: str
    #: bands in order; each begins where the one before ends
    bands: tuple[BlankBand, ...]
    #: number of holes along the axis: 1 with a bore, 0 without
    genus: int

    def volume(self) -> float:
        """Return the volume, mm3."""
        # pi rho^2 dz along the section, against its sense
        nodes, weights = np.polynomial.legendre.leggauss(VOLUME_NODES)
        total = 0.0
        for band in self.bands:
            points = band.curve.at(0.5 * (1.0 + nodes))
            ends = band.curve.start[0], band.curve.end[0]
            # rho over z; z is linear in s of lines and pieces of tips, but not of arcs
            slope = np.full(VOLUME_NODES, ends[1] - ends[0])
            if isinstance(band.curve, PlaneArc):
                slope = band.curve.slope(0.5 * (1.0 + nodes))[:, 0]
            elif isinstance(band.curve, TipCurve):
                slope = _z_slope(band.curve, 0.5 * (1.0 + nodes))
            total -= np.pi * 0.5 * float(weights @ (points[:, 1] ** 2 * slope))
        return total


#: half of the step in s with which z of a piece of a tip is differentiated
HALF_STEP_S = 1e-4


def _z_slope(curve: TipCurve, s: Array) -> Array:
    """Return dz/ds (K,), mm, of a piece of a tip."""
    return np.asarray((curve.at(s + HALF_STEP_S)[:, 0] - curve.at(s - HALF_STEP_S)[:, 0]) / (2.0 * HALF_STEP_S))


@dataclass(frozen=True)
class BarBlank:
    """Bar of a rack up to the tips of its teeth: a block whose ends follow the traces of the teeth."""

    #: name of the member
    name: str
    #: corners (4, 2), mm, over x and y, of the face at the toe, counterclockwise
    corners: Array
    #: z (mm) of that face
    low: float
    #: way (3,), mm, from that face to the face at the heel
    way: Array
    #: no hole along the axis
    genus: int = 0

    def volume(self) -> float:
        """Return the volume, mm3."""
        across = self.corners[1] - self.corners[0], self.corners[3] - self.corners[0]
        return float(abs(across[0][0] * across[1][1] - across[0][1] * across[1][0]) * abs(self.way[2]))


def blank_of(member: Member) -> TurnedBlank | BarBlank:
    """Return the blank of a member before its teeth are cut."""
    return _turned(member) if member.tooth.joint.travel is None else _bar(member)


def _bar(member: Member) -> BarBlank:
    """Return the bar of a rack."""
    tooth = member.tooth.sharp_ends
    places = tooth.joint.places(tooth.teeth)
    low, high = sorted(tooth.blank.extent)
    middle = tooth.root_middle(np.array([low, high]))
    step = float(tooth.joint.to(tooth.pitch_angle).translation[1])
    first = float(middle[0]) + places[0] * step - member.overhang
    last = float(middle[0]) + (places[-1] + 1) * step + member.overhang
    back, tip = tooth.blank.body.profile[0][0], float(tooth.blank.tip.at(0.0))
    corners = np.array([(back, first), (tip, first), (tip, last), (back, last)])
    return BarBlank(member.name, corners, low, np.array([0.0, middle[1] - middle[0], high - low]))


def _turned(member: Member) -> TurnedBlank:
    """Return the turned blank of a gear."""
    body, regions = member.body, end_regions(member.tooth.blank.axial)
    profile = [np.array([z, rho]) for rho, z in body.profile]
    bands = [BlankBand(region, PlaneLine(a, b)) for region, (a, b) in zip(body.bands, pairwise(profile), strict=True)]
    blank, halves = member.tooth.blank.sharp, member.halves
    first, place = member.rows.outer
    at, region = profile[-1], regions[1]
    # back from the end of the profile over all rows of teeth
    while True:
        half, end = place
        row = _tip(blank, halves[half], end)
        bands += [BlankBand(region, PlaneLine(at, row[0].start)), *(BlankBand(Region.LAND, curve) for curve in row)]
        at, place = row[-1].end, (half, 1 - end)
        if place == first:
            break
        gap = next((gap for gap in member.gaps if place in gap.ends), None)
        if gap is None:
            # the halves meet
            region, place = Region.LAND, (1 - half, 1 - end)
            continue
        ends = [np.array([z, rho]) for rho, z in gap.body.profile]
        ends, order = (ends, 1) if gap.ends[0] == place else (ends[::-1], -1)
        entered, left = regions[::order]
        bands += [BlankBand(entered, PlaneLine(at, ends[0])), BlankBand(Region.GAP, PlaneLine(*ends))]
        at, region, place = ends[1], left, gap.ends[::order][1]
    bands.append(BlankBand(regions[0], PlaneLine(at, profile[0])))
    return TurnedBlank(member.name, tuple(band for band in bands if _length(band.curve) > ZERO_LENGTH_MM), body.genus)


def _tip(blank: Blank, half: HalfGear, end: int) -> list[PlaneLine | PlaneArc | TipCurve]:
    """Return the tip of a row of teeth from its `end` (0 toe, 1 heel) to the other end."""
    ends = blank.extent[end], blank.extent[1 - end]
    within = [x for x in _corners(blank.tip, blank) if min(ends) + ZERO_LENGTH_MM < x < max(ends) - ZERO_LENGTH_MM]
    stations = [ends[0], *(within if ends[1] > ends[0] else within[::-1]), ends[1]]
    return [TipCurve(blank, half, stretch).shape for stretch in pairwise(stations)]


def _corners(tip: LandLevel, blank: Blank) -> list[float]:
    """Return the stations (mm) of the corners of a tip, ascending."""
    return sorted(tip.corners(blank.axial))


def _length(curve: PlaneLine | PlaneArc | TipCurve) -> float:
    """Return the length (mm) of the chord of a curve, or of the arc."""
    return float(np.linalg.norm(curve.end - curve.start))
