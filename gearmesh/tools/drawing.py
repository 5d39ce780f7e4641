"""How tools are shown in their place over a tooth: as grids of their surfaces, in the tool's frame.

Surfaces of revolution are turned once round; racks and shapers go along the face; what is a part of its own is drawn as that part.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Protocol

import numpy as np

from gearmesh.kernel.envelope.helicoid import half_plane
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import AXIS, Array, components, unit
from gearmesh.kernel.surface.surface import GeneratedSurface, Jet

#: points across a tool's flank and its tip rounding, round a surface of revolution, along a rack
ACROSS, TIP, AROUND, ALONG = 25, 17, 361, 61
#: how far a head cutter's blades and a disk are shown, in heights of the flank that they generate, and a rack beyond the face
SHOWN, BEYOND = 1.5, 0.1
#: spaces of a rack that are shown on either side of the middle one
SPACES = 2
#: pitches of a thread that are shown along its axis on either side of the middle, and points on a turn of it
PITCHES, TURN = 2.5, 97


@dataclass(frozen=True)
class ToolSheet:
    """A part of a tool's surface as a grid of points and unit normals, into the tool, (M, N, 3), in the tool's frame, mm."""

    region: str
    points: Array
    normals: Array


@dataclass(frozen=True)
class DrawnSide:
    """One side of what a tool generates: flank and fillet, and their parameters as those of a `ToothSide`."""

    flank: GeneratedSurface
    fillet: GeneratedSurface
    form_point: tuple[float, float]
    root: float
    tip: float

    def parts(self, top: float) -> tuple[tuple[str, GeneratedSurface, Array], ...]:
        """Flank, from the parameter `top` to the form point, and fillet on to the root, each with parameters (P,) across it."""
        return (
            ("flank", self.flank, np.linspace(top, self.form_point[0], ACROSS)),
            ("fillet", self.fillet, np.linspace(self.form_point[1], self.root, TIP)),
        )


@dataclass(frozen=True)
class DrawnPlace:
    """The point that the tool generates: its parameters (2,) on the flank and the tool's point (3,), its frame, mm; `face`: range
    of the flank's second parameter along the face, `pitch` (rad) from tooth to tooth."""

    parameters: Array
    point: Array
    face: tuple[float, float]
    pitch: float


#: grids of a tool's surface, and lines (K, 3) of its section through the point that it generates
Drawn = tuple[tuple[ToolSheet, ...], tuple[Array, ...]]


class Drawing(Protocol):
    """How a tool is shown: `axis`: the frame whose z axis is its own, over the tool's frame, None where it has none; `as_part`: by
    a mesh of its own instead of sheets."""

    @property
    def axis(self) -> Rigid | None: ...
    @property
    def as_part(self) -> bool: ...

    def draw(self, sides: list[DrawnSide], at: DrawnPlace) -> Drawn:
        """The tool that generates these `sides`, one or two, in its frame."""


@dataclass(frozen=True)
class PartDrawing:
    """A tool that is a part of its own, such as a worm."""

    axis: Rigid | None = field(default_factory=Rigid.identity)
    as_part: bool = True

    def draw(self, sides: list[DrawnSide], at: DrawnPlace) -> Drawn:
        return (), ()


@dataclass(frozen=True)
class TurnedDrawing:
    """A surface of revolution about the tool's z axis: flank and tip of all sides, the tip plane or rim between two, and their
    section at the point."""

    axis: Rigid | None = field(default_factory=Rigid.identity)
    as_part: bool = False

    def draw(self, sides: list[DrawnSide], at: DrawnPlace) -> Drawn:
        through = float(np.arctan2(at.point[1], at.point[0]))
        sheets, sections = [], []
        for side in sides:
            section = []
            for region, surface, p in side.parts(side.form_point[0] + SHOWN * (side.tip - side.form_point[0])):
                jet = surface.tool.jet(*surface.on_tool(p, np.full_like(p, at.parameters[1])))
                sheets.append(_sheet(region, _revolve(jet, np.linspace(0.0, 2.0 * np.pi, AROUND))))
                section.append(_revolve(jet, np.array([through])).r[:, 0])
            sections.append(np.concatenate(section))
        if len(sections) == 2:
            first, second = sections
            ring = np.linspace(first[-1], second[-1], 2)
            flat = Jet(ring, np.broadcast_to(AXIS, ring.shape), *(np.zeros_like(ring),) * 4)
            sheets.append(_sheet("land", _revolve(flat, np.linspace(0.0, 2.0 * np.pi, AROUND) - through)))
            sections = [np.concatenate((first, second[::-1]))]
        return tuple(sheets), tuple(sections)


def _sheet(region: str, jet: Jet) -> ToolSheet:
    return ToolSheet(region, jet.r, jet.n)


def _revolve(line: Jet, angles: Array) -> Jet:
    """A line (P,) turned about the z axis, each of its points to the angles (A,), rad: (P, A)."""
    at = np.arctan2(line.r[:, 1], line.r[:, 0])
    turned = Rigid.about_z(angles - at[:, None])
    r, n = turned.point(line.r[:, None]), turned.vector(line.n[:, None])
    return Jet(r, n, *(np.zeros_like(r),) * 4)


@dataclass(frozen=True)
class StraightDrawing:
    """A tool along the face: flanks and tips of a few spaces of a rack that rolls on a pitch `radius` (mm), or of one space of a
    shaper (None), and the tip planes between them."""

    radius: float | None = None
    axis: Rigid | None = None
    as_part: bool = False

    def draw(self, sides: list[DrawnSide], at: DrawnPlace) -> Drawn:
        return tuple(self._sheets(sides, at)), ()

    def _sheets(self, sides: list[DrawnSide], at: DrawnPlace) -> Iterator[ToolSheet]:
        shifts = np.zeros((1, 3))
        if self.radius is not None:
            shifts = np.arange(-SPACES, SPACES + 1)[:, None] * [0.0, self.radius * at.pitch, 0.0]
        low, high = at.face
        v = np.linspace(low - BEYOND * (high - low), high + BEYOND * (high - low), ALONG)
        ends = []
        for side in sides:
            for region, surface, p in side.parts(side.tip):
                jet = surface.tool.jet(p[:, None], v)
                yield from (ToolSheet(region, jet.r + shift, jet.n) for shift in shifts)
            ends.append((jet.r[-1], jet.n[-1]))
        if len(ends) == 2:
            # the tip plane of a cutter's tooth, from the end of one space to the beginning of the next
            (low_end, normal), (high_end, _) = sorted(ends, key=lambda end: float(end[0][:, 1].mean()))
            for before, after in pairwise(shifts):
                points = np.stack((high_end + before, low_end + after))
                yield ToolSheet("land", points, np.broadcast_to(normal, points.shape))


@dataclass(frozen=True)
class ThreadDrawing:
    """A hob: flanks, tip roundings, tips and roots of its `threads` about the z axis of the frame `axis` (over the tool's), `screw`
    (mm/rad) their axial advance, signed; the gashes are not shown."""

    axis: Rigid
    screw: float
    threads: int
    as_part: bool = False

    @property
    def _pitch(self) -> float:
        return 2.0 * np.pi * abs(self.screw) / self.threads

    def draw(self, sides: list[DrawnSide], at: DrawnPlace) -> Drawn:
        point = self.axis.inverse.point(at.point)
        turn = float(np.arctan2(point[1], point[0]))
        lines = [self._line(side, float(at.parameters[1])) for side in sides]
        parts = [part for line in lines for part in line]
        outlines = [np.concatenate([points for _, points, _ in line]) for line in lines]
        if len(outlines) == 2:
            low, high = sorted(outlines, key=lambda line: float(line[-1, 1]))
            outlines, inwards = [np.concatenate((low, high[::-1]))], np.array([[-1.0, 0.0], [-1.0, 0.0]])
            parts.append(("land", np.stack((low[-1], high[-1])), inwards))
            parts.append(("root", np.stack((high[0], low[0] + [0.0, self._pitch])), inwards))
        sheets = [self._sheet(*part, k, point[2]) for part in parts for k in range(self.threads)]
        drawn = []
        for line in outlines:
            # the thread that the point is on
            number = np.rint((point[2] - self.screw * turn - line[:, 1].mean()) / self._pitch)
            drawn.append(self.axis.point(self._wind(line, np.array([turn]), number)[:, 0]))
        return tuple(sheets), tuple(drawn)

    def _line(self, side: DrawnSide, v: float) -> list[tuple[str, Array, Array]]:
        """Flank and fillet of a side: radius and height (K, 2) in the axial section through the thread about z = 0, and normals
        there, into the tool."""
        line = []
        for region, surface, p in side.parts(side.tip):
            jet = surface.tool.jet(*surface.on_tool(p, np.full_like(p, v)))
            here = self.axis.inverse
            line.append((region, *half_plane(here.point(jet.r), here.vector(jet.n), self.screw)))
        shift = np.rint(line[-1][1][-1, 1] / self._pitch) * self._pitch
        return [(region, points - [0.0, shift], normals) for region, points, normals in line]

    def _sheet(self, region: str, points: Array, normals: Array, number: int, middle: float) -> ToolSheet:
        """A part of the section (K, 2) of a thread, wound about the axis on either side of the height `middle`, mm."""
        half = PITCHES * self._pitch / abs(self.screw)
        angles = (middle - number * self._pitch) / self.screw + np.linspace(-half, half, int(half / np.pi * TURN))
        wound = self._wind(points, angles, number)
        # at right angles to the screw motion
        around = -self.screw * normals[:, 1] / points[:, 0]
        c, s = np.cos(angles), np.sin(angles)
        n_x, n_y = (normals[:, :1] * a + around[:, None] * b for a, b in ((c, -s), (s, c)))
        inwards = unit(components(n_x, n_y, normals[:, 1:]))
        return ToolSheet(region, self.axis.point(wound), self.axis.vector(inwards))

    def _wind(self, points: Array, angles: Array, number: float) -> Array:
        """Points (K, A, 3), own frame, of a section (K, 2) wound to angles (A,), rad, that many pitches along the axis."""
        rho, z = points[:, :1], points[:, 1:] + number * self._pitch
        return components(rho * np.cos(angles), rho * np.sin(angles), z + self.screw * angles)
