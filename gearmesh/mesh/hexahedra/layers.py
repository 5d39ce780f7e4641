"""Sections of a tooth for hexahedra: by stations along the face; of threads, by half planes through the axis.

A thread crosses a plane of constant station at a flat angle: elements between such sections would be sheared beyond use.
Threads are cut by half planes instead, in which they look like the tooth of a rack; the sections follow each other around the
axis. The next tooth is then the next thread along the axis. The thread may go on beyond the member's length.

            z (toe to heel)                     Y across, X out of the body; right-handed with the way from section to
            |   ____                            section, which is that on which z grows.
      step  |  /    \\   thread
    <-------| /      \\______ root
            |______________________ rho
"""

from __future__ import annotations

from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, components
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.kernel.surface.stations import along
from gearmesh.records import dataclass
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, Region, Side
from gearmesh.teeth.section import GeneratedLink, Grid, Sections, parameter
from gearmesh.teeth.tooth import Tooth

#: half the meshed arc of a thread, rad: contact with a wheel is within 50 deg of the common perpendicular
HALF_ARC = 0.5 * np.pi
#: thickest rim of a gear without bore, as a share of the way to the axis
SOLID_SHARE = 0.8


class Chart(Protocol):
    """Plane coordinates (X, Y) of points on T sections: X grows out of the body, Y in the direction of motion."""

    @property
    def reference(self) -> Array:
        """Height u (T,), mm, at X = 0."""

    def height(self, reach: Array, z: Array) -> Array:
        """Return the height u, mm, of places at a distance `reach`, mm, from the axis, and at z."""

    def to_chart(self, points: Array) -> Array:
        """Return chart coordinates (..., T, 2) of points (..., T, 3)."""

    def depth(self, height: Array) -> Array:
        """Return X of heights u (..., T), mm."""

    def from_chart(self, chart: Array) -> Array:
        """Return points (..., T, 3) of chart coordinates (..., T, 2)."""


@dataclass(frozen=True)
class FlatChart:
    """Sections of a bar, planes of constant z: X = x - reference, Y = y - middle."""

    #: z (T,) of the sections, mm
    stations: Array
    #: (T,), mm
    reference: Array
    #: (T,), mm
    middle: Array

    def height(self, reach: Array, z: Array) -> Array:
        """Return the height u, see `Chart`."""
        return reach

    def to_chart(self, points: Array) -> Array:
        """Return chart coordinates, see `Chart`."""
        return np.stack((points[..., 0] - self.reference, points[..., 1] - self.middle), axis=-1)

    def depth(self, height: Array) -> Array:
        """Return X, see `Chart`."""
        return height - self.reference

    def from_chart(self, chart: Array) -> Array:
        """Return points, see `Chart`."""
        x, y = chart[..., 0] + self.reference, chart[..., 1] + self.middle
        return np.stack((x, y, np.broadcast_to(self.stations, x.shape)), axis=-1)


@dataclass(frozen=True)
class HalfPlaneChart:
    """Half planes through the axis: X = rho - reference, Y = sense (z - middle)."""

    #: polar angles (T,), rad
    angle: Array
    #: 1 or -1
    sense: float
    #: (T,), mm
    reference: Array
    #: (T,), mm
    middle: Array

    def height(self, reach: Array, z: Array) -> Array:
        """Return the height u, see `Chart`."""
        return reach

    def to_chart(self, points: Array) -> Array:
        """Return chart coordinates, see `Chart`."""
        rho = np.hypot(points[..., 0], points[..., 1])
        return np.stack((rho - self.reference, self.sense * (points[..., 2] - self.middle)), axis=-1)

    def depth(self, height: Array) -> Array:
        """Return X, see `Chart`."""
        return height - self.reference

    def from_chart(self, chart: Array) -> Array:
        """Return points, see `Chart`."""
        rho, z = chart[..., 0] + self.reference, self.sense * chart[..., 1] + self.middle
        return components(rho * np.cos(self.angle), rho * np.sin(self.angle), z)


@dataclass(frozen=True)
class SectionChart:
    """Conformal coordinates on sections of constant station: Y is the polar angle, X = int du / rho along the generatrix."""

    #: axial station of points
    level: Level
    #: stations (T,)
    stations: Array
    #: height u (T,), mm, along the generatrix outwards, at X = 0
    reference: Array
    #: polar angle (T,), rad, at Y = 0
    turn: Array

    def height(self, rho: Array, z: Array) -> Array:
        """Return the height u, mm, along the generatrix."""
        a, b = station_normal(self.level)
        return b * rho - a * z

    def to_chart(self, points: Array) -> Array:
        """Return chart coordinates (..., T, 2) of points (..., T, 3)."""
        rho = np.hypot(points[..., 0], points[..., 1])
        cos, sin = np.cos(self.turn), np.sin(self.turn)
        x, y = points[..., 0] * cos + points[..., 1] * sin, points[..., 1] * cos - points[..., 0] * sin
        return np.stack((self.depth(self.height(rho, points[..., 2])), np.arctan2(y, x)), axis=-1)

    def depth(self, height: Array) -> Array:
        """Return X of heights u (..., T), mm."""
        slope = station_normal(self.level)[1]
        change = (height - self.reference) / self._rho_at_reference
        return np.log1p(slope * change) / slope if abs(slope) > 1e-9 else change

    def from_chart(self, chart: Array) -> Array:
        """Return points (..., T, 3) of chart coordinates (..., T, 2)."""
        a, b = station_normal(self.level)
        change = np.expm1(b * chart[..., 0]) / b if abs(b) > 1e-9 else chart[..., 0]
        u = self.reference + change * self._rho_at_reference
        v = self._across
        rho, z = b * u + a * v, b * v - a * u
        angle = chart[..., 1] + self.turn
        return np.stack((rho * np.cos(angle), rho * np.sin(angle), z), axis=-1)

    @property
    def _across(self) -> Array:
        """Distance (T,), mm, of the sections from the origin, along the gradient."""
        return self.stations - float(self.level.value(np.zeros(3)))

    @property
    def _rho_at_reference(self) -> Array:
        """Distance (T,), mm, from the axis at X = 0."""
        a, b = station_normal(self.level)
        return b * self.reference + a * self._across


@dataclass(frozen=True)
class Base:
    """Body under the teeth, in the sections."""

    #: chart of the sections, with X = 0 at the root
    chart: Chart
    #: heights u (T,), mm, of the root
    root: Array
    #: heights u (T,), mm, of the tip
    tip: Array
    #: depth (T,), mm, of the body under the root
    room: Array


class Layers(Protocol):
    """T sections of a tooth, from toe to heel."""

    @property
    def tooth(self) -> Tooth:
        """The tooth as the sections show it."""

    @property
    def step(self) -> Rigid:
        """Motion to the next tooth in the sections, in the direction of the joint."""

    @property
    def base(self) -> Base:
        """Body under the teeth."""

    def grid(self, region: Region, s: ArrayLike) -> Grid:
        """Return exact points and normals (S, T, 3) of a link at s (S,) or (S, T)."""

    def flank(self, side: Side, s: ArrayLike) -> Grid:
        """Return exact points and normals (S, T, 3) of a flank at s (S,), from form point to tip on both sides."""

    def places(self, teeth: NDArray[np.int64]) -> Rigid:
        """Return the motions (K,) from the tooth on +x to other teeth."""


def layers(tooth: Tooth, t: ArrayLike, centre: float = 0.0) -> Layers:
    """Return the sections of a tooth at t (T,), 0 at the toe to 1 at the heel.

    The sections of a thread cover an arc of +- HALF_ARC about the running polar angle `centre`, rad, which is 0 in the middle
    of the thread. Raises TrimError for a tooth that cannot be trimmed.
    """
    t = np.atleast_1d(np.asarray(t, dtype=float))
    return StationLayers(tooth, t) if tooth.screw is None else ThreadLayers(tooth, t, centre)


@dataclass(frozen=True)
class StationLayers:
    """Sections of a tooth by surfaces of constant station; the members are those of `Layers`."""

    #: the tooth
    tooth: Tooth
    #: stations (T,), 0 .. 1
    t: Array

    @cached_property
    def _sections(self) -> Sections:
        """Trimmed sections at all stations."""
        return self.tooth.sections(self.t)

    @property
    def step(self) -> Rigid:
        """Motion to the next tooth."""
        return self.tooth.joint.to(self.tooth.pitch_angle)

    def places(self, teeth: NDArray[np.int64]) -> Rigid:
        """Return the motions to other teeth."""
        return self.tooth.joint.to(teeth * self.tooth.pitch_angle)

    def grid(self, region: Region, s: ArrayLike) -> Grid:
        """Return points and normals of a link."""
        return self.tooth.grid(region, s, self._sections)

    def flank(self, side: Side, s: ArrayLike) -> Grid:
        """Return points and normals of a flank."""
        return self.tooth.flank_grid(side, s, self.t)

    @property
    def base(self) -> Base:
        """Body under the teeth."""
        tooth, sections = self.tooth, self._sections
        blank = tooth.blank
        middle = (sections.right.tip_angle + sections.left.tip_angle) / 2.0
        none = np.zeros_like(sections.t)
        chart: SectionChart | FlatChart = SectionChart(blank.axial, sections.stations, none, middle)
        if tooth.joint.travel is not None:
            chart = FlatChart(sections.stations, none, tooth.joint.travel * middle)
        root, tip = (
            chart.height(tooth.joint.radius(points), points[:, 2])
            for points in (self.grid(name, np.array([0.5])).points[0] for name in (Region.ROOT, Region.LAND))
        )
        (rho_toe, z_toe), (rho_heel, z_heel) = blank.body.profile[0], blank.body.profile[-1]
        ends = chart.height(np.array([rho_toe, rho_heel]), np.array([z_toe, z_heel]))
        room = root - (ends[0] + sections.t * (ends[1] - ends[0]))
        if blank.body.solid:
            room = room * SOLID_SHARE
        if isinstance(chart, FlatChart):
            return Base(FlatChart(chart.stations, root, chart.middle), root, tip, room)
        return Base(SectionChart(chart.level, chart.stations, root, chart.turn), root, tip, room)


@dataclass(frozen=True)
class ThreadLayers:
    """Sections of a thread by half planes through the axis; the members are those of `Layers`.

    Roundings and chamfers of the tip are left out.
    """

    #: the thread
    whole: Tooth
    #: places (T,) along the arc, 0 .. 1
    t: Array
    #: running polar angle, rad, of the middle of the arc
    centre: float

    @cached_property
    def tooth(self) -> Tooth:
        """The thread with a sharp tip."""
        return self.whole.sharp_tip

    @property
    def screw(self) -> float:
        """Axial advance, mm/rad; negative for left-hand threads."""
        screw = self.whole.screw
        assert screw is not None
        return screw

    @property
    def _angle(self) -> Array:
        """Running polar angles (T,), rad, of the sections."""
        return np.asarray(self.centre + np.sign(self.screw) * HALF_ARC * (2.0 * self.t - 1.0))

    @property
    def _way(self) -> Array:
        """Displacement (3,), mm, to the next thread."""
        return np.array([0.0, 0.0, -self.screw * self.tooth.pitch_angle])

    @property
    def step(self) -> Rigid:
        """Motion to the next thread."""
        return Rigid(np.eye(3), self._way)

    def places(self, teeth: NDArray[np.int64]) -> Rigid:
        """Return the motions to other threads."""
        return Rigid(np.broadcast_to(np.eye(3), (len(teeth), 3, 3)), teeth[:, None] * self._way)

    @cached_property
    def _middle(self) -> Sections:
        """Trimmed section in the middle of the face."""
        return self.tooth.sections(0.5)

    def grid(self, region: Region, s: ArrayLike) -> Grid:
        """Return points and normals of a link."""
        s = np.asarray(s, dtype=float)
        s = s[:, None] if s.ndim == 1 else s
        link = self.tooth.chain[region]
        if isinstance(link, GeneratedLink):
            return self._swept(link, s)
        right, left = (self._ends(region, side) for side in Side)
        # the root goes from the thread before to the right side, the land from the right side to the left one
        first, last = (left - self._way, right) if region is Region.ROOT else (right, left)
        points = first + s[..., None] * (last - first)
        outward = np.stack((np.cos(self._angle), np.sin(self._angle), np.zeros_like(self._angle)), axis=-1)
        return Grid(points, np.broadcast_to(outward, points.shape))

    def _ends(self, region: Region, side: Side) -> Array:
        """Return the points (T, 3), mm, at which a side ends at the land or the root."""
        link, last = (FLANK_REGIONS[side], 1.0) if region is Region.LAND else (FILLET_REGIONS[side], 0.0)
        end: Array = self.grid(link, np.array([last if side is Side.RIGHT else 1.0 - last])).points[0]
        return end

    def flank(self, side: Side, s: ArrayLike) -> Grid:
        """Return points and normals of a flank."""
        side, s = Side(side), np.asarray(s, dtype=float)
        return self.grid(FLANK_REGIONS[side], s if side is Side.RIGHT else 1.0 - s)

    def _swept(self, link: GeneratedLink, s: Array) -> Grid:
        """Return points of a generated link: from the middle of the face they go along the helix to the half planes."""
        p = parameter(s, link.span(self._middle), link.seams)[0]
        p, angle = np.broadcast_arrays(p, self._angle)
        v, start = along(link.surface, p, np.broadcast_to(self._middle.stations, p.shape), link.axial)
        turned = angle - np.arctan2(start.r[..., 1], start.r[..., 0])
        station = link.axial.value(start.r + (self.screw * turned)[..., None] * np.array([0.0, 0.0, 1.0]))
        v, jet = along(link.surface, p, station, link.axial, v)
        return Grid(jet.r, jet.n, jet, p, v)

    @property
    def base(self) -> Base:
        """Body under the thread."""
        points = [self.grid(name, np.array([0.5])).points[0] for name in (Region.ROOT, Region.LAND)]
        root, tip = (self.tooth.joint.radius(line) for line in points)
        body = self.tooth.blank.body
        room = root - max(body.profile[0][0], body.profile[-1][0])
        if body.solid:
            room = room * SOLID_SHARE
        return Base(HalfPlaneChart(self._angle, -np.sign(self.screw), root, points[1][:, 2]), root, tip, room)


def running_angle(tooth: Tooth, points: Array) -> Array:
    """Return the running polar angles (...,), rad, of points (..., 3) on a thread, without jumps by full turns; 0 in its middle."""
    screw = tooth.screw
    assert screw is not None
    angle = np.arctan2(points[..., 1], points[..., 0])
    running: Array = angle + 2.0 * np.pi * np.round((points[..., 2] / screw - angle) / (2.0 * np.pi))
    return running
