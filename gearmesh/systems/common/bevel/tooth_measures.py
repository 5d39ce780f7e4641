"""Measures on the exact flanks of a bevel gear's tooth: thicknesses, chords, lands, spiral angles.

All are in the member's frame, lengths in mm, angles in rad. Stations (T,) are cone distances. The pitch cone is the
cone through the apex whose generatrices the stations count along.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, cross, dot, polar_angle
from gearmesh.kernel.numeric.algebra import unit as unit_vector
from gearmesh.kernel.surface.levels import ConeLevel, Level, SlantedLevel, station_normal
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass
from gearmesh.systems.common.pattern.targets import on_flank
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth


def width_across(ends: tuple[Array, Array], tangents: Array) -> Array:
    """Return the distances (T,) of two points (T, 3) each, across a direction (T, 3)."""
    direction, across = unit_vector(tangents), ends[0] - ends[1]
    across = across - direction * dot(across, direction)[:, None]
    width: Array = np.sqrt(dot(across, across))
    return width


@dataclass(frozen=True)
class PitchLines:
    """Lines in which the flanks of a tooth cross its pitch cone."""

    #: jets (T,) of the flanks at the stations, by side
    jets: dict[Side, Jet]
    #: hand of the member: +1 right, -1 left
    hand: int
    #: levels of cone distance and of height over the pitch cone
    levels: tuple[Level, Level]

    @classmethod
    def of(
        cls,
        flanks: dict[Side, Surface],
        starts: dict[Side, Array],
        hand: int,
        stations: Array,
        levels: tuple[Level, Level],
    ) -> PitchLines:
        """Return the pitch lines of flanks at `stations` (T,), near parameters `starts` (T, 2)."""
        wanted = np.stack((stations, np.zeros_like(stations)), axis=-1)
        return cls({side: on_flank(flanks[side], starts[side], levels, wanted)[1] for side in Side}, hand, levels)

    def lengthwise(self, side: Side) -> Array:
        """Return the unit vectors (T, 3) along a flank's pitch line, towards the heel."""
        axial, height = self.levels
        jet = self.jets[side]
        direction = unit_vector(cross(jet.n, height.gradient(jet.r)))
        return direction * np.sign(dot(direction, axial.gradient(jet.r)))[:, None]

    def spiral_angles(self, side: Side) -> Array:
        """Return the angles (T,) between a flank's pitch line and the generatrices of the pitch cone.

        They are > 0 in the sense of the hand.
        """
        direction, jet = self.lengthwise(side), self.jets[side]
        around = dot(direction, unit_vector(cross(Z_AXIS, jet.r)))
        angles: Array = np.arctan2(self.hand * around, dot(direction, self.levels[0].gradient(jet.r)))
        return angles

    @property
    def transverse_thicknesses(self) -> Array:
        """Circular thicknesses (T,) along the pitch circle."""
        right, left = (self.jets[side].r for side in (Side.RIGHT, Side.LEFT))
        turn = (polar_angle(left) - polar_angle(right)) % (2.0 * np.pi)
        thicknesses: Array = np.hypot(right[:, 0], right[:, 1]) * turn
        return thicknesses

    @property
    def across(self) -> Array:
        """Cosines (T,) of the mean of the flanks' spiral angles: normal over transverse thicknesses."""
        cosines: Array = np.cos(np.mean([self.spiral_angles(side) for side in Side], axis=0))
        return cosines

    @property
    def normal_thicknesses(self) -> Array:
        """Circular thicknesses (T,) across the tooth."""
        return np.asarray(self.transverse_thicknesses * self.across)


@dataclass(frozen=True)
class ToothMeasures:
    """Measures of a tooth at stations within its face."""

    #: the tooth
    tooth: Tooth
    #: hand of the member: +1 right, -1 left
    hand: int
    #: cone distances (T,), ascending, mm
    stations: Array
    #: level of the height over the pitch cone
    pitch_cone: ConeLevel

    @property
    def _levels(self) -> tuple[Level, Level]:
        """Levels of cone distance and of height over the pitch cone."""
        return self.tooth.blank.axial, self.pitch_cone

    @property
    def _t(self) -> Array:
        """Shares (T,) of the face at the stations, from toe to heel."""
        toe, heel = self.tooth.blank.extent
        return (self.stations - toe) / (heel - toe)

    @cached_property
    def pitch_lines(self) -> PitchLines:
        """Lines in which the flanks cross the pitch cone."""
        flanks = {side: self.tooth.side(side).flank for side in Side}
        starts = {side: self.tooth.flank_grid(side, [0.5], self._t).parameters[0] for side in Side}
        return PitchLines.of(flanks, starts, self.hand, self.stations, self._levels)

    @property
    def top_lands(self) -> Array:
        """Widths (T,) of the tip across the tooth."""
        ends, tangents, tip = [], [], self.tooth.blank.tip
        for side in Side:
            jet = self.tooth.flank_grid(side, [1.0], self._t).jet
            assert jet is not None
            direction = unit_vector(cross(jet.n[0], tip.gradient(jet.r[0])))
            ends.append(jet.r[0])
            tangents.append(direction * np.sign(dot(direction, self._levels[0].gradient(jet.r[0])))[:, None])
        return width_across((ends[0], ends[1]), tangents[0] + tangents[1])

    @property
    def root_heights(self) -> Array:
        """Heights (T,) over the pitch cone, mm, of the middle of the root between two teeth; < 0."""
        axial, height = self._levels
        bottom = self.tooth.bottom
        if bottom is not None:
            middle = np.full_like(self.stations, 0.5 * sum(bottom.ends))
            return np.asarray(height.value(along(bottom.surface, middle, self.stations, axial)[1].r))
        return np.array([self._section_point(number, self.tooth.blank.root)[2] for number in range(len(self.stations))])

    def _section_point(self, number: int, cone: Level) -> Array:
        """Return the point of a cone in the axial plane at station `number`: (rho, z, height over the pitch cone), mm."""
        axial, height = self._levels
        # both levels are linear in rho and z
        rows = [station_normal(level) for level in (axial, cone)]
        offsets = [float(level.value(np.array([1e-300, 0.0, 0.0]))) for level in (axial, cone)]
        rho, z = np.linalg.solve(np.array(rows), np.array([self.stations[number] - offsets[0], -offsets[1]]))
        return np.array([rho, z, float(height.value(np.array([rho, 0.0, z])))])

    def advance(self, side: Side) -> float:
        """Return the angle (rad) about the axis between the first and the last station of a flank's pitch line."""
        angles = np.unwrap(polar_angle(self.pitch_lines.jets[side].r))
        return abs(float(angles[-1] - angles[0]))

    def chord(self, number: int, depth: float) -> float:
        """Return the reading (mm) of a tooth calliper at station `number`.

        Its tongue is `depth` mm under the middle of the tip.

        The calliper is across the tooth and perpendicular to the pitch cone. The reading is NaN if a jaw finds no
        flank.
        """
        height = self.pitch_cone
        r = [self.pitch_lines.jets[side].r[number] for side in (Side.RIGHT, Side.LEFT)]
        angles = np.unwrap([float(polar_angle(point)) for point in r])
        rho, z, _ = self._section_point(number, self.tooth.blank.tip)
        middle = float(np.mean(angles))
        tip = np.array([rho * np.cos(middle), rho * np.sin(middle), z])
        # axes of the calliper: out of the pitch cone, and along the tooth by the mean of both flanks
        up = unit_vector(height.gradient(tip))
        along = sum(self.pitch_lines.lengthwise(side)[number] for side in Side)
        along = unit_vector(along - up * dot(along, up))
        ends = []
        for side in Side:
            start = self.tooth.flank_grid(side, [0.5], self._t[[number]]).parameters[0]
            # the jaw touches the flank in the plane across the tooth, at the depth of the tongue
            jaws = SlantedLevel(along, tip), SlantedLevel(up, tip)
            ends.append(on_flank(self.tooth.side(side).flank, start, jaws, np.array([[0.0, -depth]]))[1].r[0])
        return abs(float(dot(ends[0] - ends[1], np.cross(up, along))))
