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

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc, PlaneLine
from gearmesh.kernel.surface.levels import LandLevel
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import end_regions
from gearmesh.teeth.blank.halves import HalfGear
from gearmesh.teeth.carried_body import CarriedBody
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


def cylinder(body: CarriedBody) -> TurnedBlank:
    """Return a cylinder that members carry as a turned blank."""
    (low, high), radius = body.ends, body.radius
    corners = [np.array(corner) for corner in ((low, 0.0), (high, 0.0), (high, radius), (low, radius))]
    regions = (Region.BORE, Region.FACE_HEEL, Region.LAND, Region.FACE_TOE)
    ends = zip(corners, (*corners[1:], corners[0]), strict=True)
    return TurnedBlank(
        body.name, tuple(BlankBand(r, PlaneLine(a, b)) for r, (a, b) in zip(regions, ends, strict=True)), 0
    )


#: half of the step in s with which z of a piece of a tip is differentiated
HALF_STEP_S = 1e-4


def _z_slope(curve: TipCurve, s: Array) -> Array:
    """Return dz/ds (K,), mm, of a piece of a tip."""
    return np.asarray((curve.at(s + HALF_STEP_S)[:, 0] - curve.at(s - HALF_STEP_S)[:, 0]) / (2.0 * HALF_STEP_S))


@dataclass(frozen=True)
class BarBlank:
    """Bar of a rack up to the tips of its teeth, whose ends follow the traces of the teeth.

    It consists of one block for each row of teeth and each gap, side by side along z.
    """

    #: name of the member
    name: str
    #: height x (mm) of the back
    back: float
    #: height x (mm) of the top of each block
    tops: tuple[float, ...]
    #: stations (S,), mm, at which the blocks begin and end
    stations: Array
    #: y (2, S), mm, of the first and the last end of the bar at the stations
    ends: Array
    #: no hole along the axis
    genus: int = 0

    def heights(self, station: int, top: float) -> list[float]:
        """Return the heights (mm) of the vertices at a station, from the back to a top."""
        beside = self.tops[max(station - 1, 0) : station + 1]
        return sorted({self.back, *(height for height in beside if height <= top)})

    @property
    def outline(self) -> Array:
        """Corners (4, 2), mm, over x and y, of the section in the middle of the first block, counterclockwise."""
        first, last = self.ends[:, :2].mean(axis=1)
        return np.array([(self.back, first), (self.tops[0], first), (self.tops[0], last), (self.back, last)])

    @property
    def faces(self) -> list[tuple[Region, Array]]:
        """Plane faces as polygons (N, 3), mm, counterclockwise seen from outside, by region."""

        def at(station: int, side: int, heights: Sequence[float]) -> list[tuple[float, float, float]]:
            return [(x, float(self.ends[side, station]), float(self.stations[station])) for x in heights]

        blocks, last = list(enumerate(self.tops)), len(self.tops)
        faces = list[tuple[Region, Array]]()
        for side in (0, 1):
            for k, top in blocks:
                # begin at a station with two heights, so that no three corners beside the first one are in line
                rings = [at(n, side, self.heights(n, top)) for n in (k, k + 1)]
                ring = (
                    [*rings[0], *rings[1][::-1]] if len(rings[0]) == 2 else [rings[1][0], *rings[0], *rings[1][:0:-1]]
                )
                faces.append((Region.END, np.array(ring if side == 0 else [ring[0], *ring[:0:-1]])))
            if side == 0:
                for k, top in blocks:
                    region = Region.LAND if top == self.tops[0] else Region.GAP
                    faces.append((region, np.array([at(n, m, [top])[0] for n, m in _round(k)])))
        for k, _ in blocks:
            faces.append((Region.BACK, np.array([at(n, m, [self.back])[0] for n, m in _round(k)[::-1]])))
        for n in range(last + 1):
            low, high = (self.tops[m] if 0 <= m < last else self.back for m in (n - 1, n))
            if low == high:
                continue
            corners = [at(n, side, sorted((low, high))) for side in (0, 1)]
            ring = [*corners[0], *corners[1][::-1]]
            faces.append((Region.FACE_TOE, np.array(ring[::-1])) if high > low else (Region.FACE_HEEL, np.array(ring)))
        return faces

    def volume(self) -> float:
        """Return the volume, mm3."""
        lengths = np.ptp(self.ends, axis=0)
        areas = 0.5 * (lengths[1:] + lengths[:-1]) * (np.array(self.tops) - self.back)
        return float(areas @ np.diff(self.stations))


def _round(block: int) -> list[tuple[int, int]]:
    """Return station and end of the bar of the corners of a block, counterclockwise seen from the tips."""
    return [(block, 0), (block, 1), (block + 1, 1), (block + 1, 0)]


def blank_of(member: Member) -> TurnedBlank | BarBlank:
    """Return the blank of a member before its teeth are cut."""
    return _turned(member) if member.tooth.joint.travel is None else _bar(member)


def _bar(member: Member) -> BarBlank:
    """Return the bar of a rack."""
    blank = member.tooth.sharp_ends.blank
    back, tip, stations = blank.body.profile[0][0], float(blank.tip.at(0.0)), np.array(sorted(blank.extent))
    ends = np.stack(member.bar_ends(stations))
    tops, plane = [tip], member.halves[-1].plane
    if plane is not None:
        # the second half is the image of the first; both share a station unless there is a gap
        kept = slice(None) if member.gaps else slice(1, None)
        stations = np.concatenate((stations, (2.0 * plane - stations)[::-1][kept]))
        ends = np.concatenate((ends, ends[:, ::-1][:, kept]), axis=1)
        tops += [*(gap.floor for gap in member.gaps), tip]
    return BarBlank(member.name, back, tuple(tops), stations, ends)


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
