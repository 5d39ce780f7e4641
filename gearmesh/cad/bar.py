r"""A rack as a solid with named faces for CAD: exact planes and cylinders, or spline patches if flanks are modified.

                 __ land __                      columns: beginnings of the links of the section, from end to end of the bar
    flank_right /          \ flank_left          rows: toe and heel, planes across z
    ___________/            \___________
    root    fillet          fillet    root       every edge along the tooth traces is straight

A plane across z cuts a root fillet in an arc: of a circle for spur teeth, of an ellipse for helical teeth. The fillet is this arc
extruded along the trace, for spur teeth a cylinder. Teeth with modified flanks or rounded tip edges consist of patches, like the
teeth of gears; the faces of the bar under them are planes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from gearmesh.cad.brep import MIN_LINK_WIDTH_MM, Patch, SplineTooth
from gearmesh.cad.faces.bar_end import BarEnd, HalfRoot
from gearmesh.cad.faces.drawn_face import DrawnFace, Sides
from gearmesh.cad.occ import (
    PRECISION_MM,
    edge,
    face,
    point,
    spline_curve,
    straight2d,
    straight_edge,
    translation,
    vertex,
    wire,
)
from gearmesh.cad.solid_part import LinkCurves, drawn_faces, link_border, opening_faces, whole_part
from gearmesh.cad.step import NamedFace, Part, require_occ
from gearmesh.cad.turned import Prism
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.teeth.blank.body import end_edges
from gearmesh.teeth.blank.end_edge import SHARP_ENDS
from gearmesh.teeth.blank.halves import AxialGap, HalfEnd, HalfGear, row_stations
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FILLET_REGIONS, Region

#: s along a link at which its distance from the drawn face is measured
LINK_SAMPLES = np.linspace(0.0, 1.0, 17)


@dataclass(frozen=True)
class BarArc:
    """An arc of a circle or an ellipse in the plane of the toe, between two columns."""

    #: centre (3,), mm
    centre: Array
    #: unit vectors (2, 3) of the axes: along the bar, and out of it or into it
    axes: Array
    #: half axes (2,), mm
    halves: Array
    #: angle of the first end, rad
    first: float
    #: angle of the last end, rad, larger than the first
    last: float

    @staticmethod
    def of(toe: Array, normals: Array, trace: Array) -> BarArc:
        """Return the arc of a root fillet with points and normals (K, 3) on the toe, extruded along the unit vector `trace`."""
        middle, radius = rounding(toe, normals, trace)
        centre = middle + trace * (toe[0, 2] - middle[2]) / trace[2]
        halves = radius * np.array([1.0 / trace[2], 1.0])
        begin, end = toe[0], toe[-1]
        axes = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
        # take the shorter way round, and mirror an axis if the angles fall
        (first, last) = _angles(np.stack((begin, end)) - centre, axes, halves)
        if (last - first) % (2.0 * np.pi) > np.pi:
            axes = axes * [[1.0], [-1.0]]
            (first, last) = _angles(np.stack((begin, end)) - centre, axes, halves)
        # OpenCASCADE counts the parameters of edges on closed curves from 0
        low = float(first % (2.0 * np.pi))
        return BarArc(centre, axes, halves, low, low + float((last - first) % (2.0 * np.pi)))

    def miss(self, r: Array) -> float:
        """Return the largest distance (mm) of points (K, 3) in the plane from the ellipse, to first order."""
        u = (r - self.centre) @ self.axes.T / self.halves
        rho = np.linalg.norm(u, axis=-1)
        slope = np.linalg.norm(u / self.halves, axis=-1) / rho
        return float(np.abs((rho - 1.0) / slope).max())

    def curve(self, way: Array) -> Any:
        """Return the Geom_Ellipse or Geom_Circle, moved by `way` (3,)."""
        from OCP.Geom import Geom_Circle, Geom_Ellipse

        place = self._frame(way).Ax2()
        if self.halves[0] == self.halves[1]:
            return Geom_Circle(place, float(self.halves[1]))
        return Geom_Ellipse(place, float(self.halves[0]), float(self.halves[1]))

    def surface(self, trace: Array) -> tuple[Any, float]:
        """Return the surface of the arc extruded along the unit vector `trace`, and the sign of its second parameter along it."""
        from OCP.Geom import Geom_CylindricalSurface, Geom_SurfaceOfLinearExtrusion
        from OCP.gp import gp_Dir

        if self.halves[0] == self.halves[1]:
            sense = float(np.sign(np.cross(*self.axes)[2]))
            return Geom_CylindricalSurface(self._frame(np.zeros(3)), float(self.halves[1])), sense
        return Geom_SurfaceOfLinearExtrusion(self.curve(np.zeros(3)), gp_Dir(*trace.tolist())), 1.0

    def move(self, way: Array) -> BarArc:
        """Return the arc moved by `way` (3,)."""
        return BarArc(self.centre + way, self.axes, self.halves, self.first, self.last)

    def _frame(self, way: Array) -> Any:
        from OCP.gp import gp_Ax3, gp_Dir

        normal = np.cross(*self.axes)
        return gp_Ax3(point(self.centre + way), gp_Dir(*normal.tolist()), gp_Dir(*self.axes[0].tolist()))


def rounding(r: Array, normals: Array, trace: Array) -> tuple[Array, float]:
    """Return a point (3,) on the axis and the radius of a cylinder along the unit vector `trace`.

    The points r (K, 3) with normals (K, 3) lie on the cylinder; the first and the last point determine it.
    """
    across, turned = r[-1] - r[0], normals[-1] - normals[0]
    across = across - (across @ trace) * trace
    radius = float(across @ turned / (turned @ turned))
    return r[0] - radius * normals[0], abs(radius)


def _angles(r: Array, axes: Array, halves: Array) -> Array:
    """Return angles (K,), rad, of points (K, 3) relative to the centre of an ellipse."""
    u = r @ axes.T / halves
    return np.asarray(np.arctan2(u[:, 1], u[:, 0]))


@dataclass(frozen=True)
class BarLink:
    """A link of the section of the whole bar."""

    #: region of its face
    region: Region
    #: name of its face
    name: str
    #: points (2, 3) on toe and heel where the link begins, mm
    corner: Array
    #: arc of a fillet, None for planes
    arc: BarArc | None = None
    #: number of its tooth, None for the roots at the ends of the bar
    tooth: int | None = None


def bar_part(member: Member) -> tuple[Part, float]:
    """Build the whole rack of planes and cylinders, and return it with its distance (mm) from the exact surfaces.

    Faces are named by region and number of the tooth. Raises DesignError for an invalid solid, OutputError without OpenCASCADE.
    """
    require_occ()
    # vertices of the sections at which the rows of teeth begin and end, in the order of z
    links, last, miss = _links(member)
    corners = np.stack([_in_rows(member, corner) for corner in (*(link.corner for link in links), last)])
    vertices = [[vertex(r) for r in column] for column in corners]
    across = [
        tuple(
            _across(link, vertices[n][row], vertices[n + 1][row], corners[n, row] - corners[n, 0])
            for row in range(corners.shape[1])
        )
        for n, link in enumerate(links)
    ]
    faces, tops = list[NamedFace](), list[BarTop]()
    for half, row in zip(member.halves, (0, corners.shape[1] - 2), strict=False):
        along = [straight_edge(*column[row : row + 2]) for column in vertices]
        # a face for each link: a plane, or the extruded arc of a fillet
        for n, link in enumerate(links):
            sides = [(across[n][row], True), (along[n + 1], True), (across[n][row + 1], False), (along[n], False)]
            way = corners[n, row + 1] - corners[n, row]
            if link.arc is None:
                # the outward normal is the direction along the chain times the direction along z
                shape = _plane(corners[n, row], np.cross(corners[n + 1, row] - corners[n, row], way), sides)
            else:
                shape = _extrude(link.arc.move(corners[n, row] - corners[n, 0]), way, sides)
            faces.append(NamedFace(shape, link.name + half.suffix, link.region, tooth=link.tooth))
        rows = (row, row + 1)[:: half.hand_sign]
        tops.append(
            BarTop(
                half,
                tuple([(edges[k], True) for edges in across] for k in rows),
                tuple(tuple((vertices[n][k], corners[n, k]) for k in rows) for n in (0, -1)),
                tuple([(along[n], half.hand_sign > 0)] for n in (0, -1)),
                corners[[0, -1]][:, rows],
                corners[0, rows],
            )
        )
    faces += under_teeth(member, tops)
    return whole_part(member.name, tuple(faces), (*member.tooth.regions, *member.body_regions)), miss


def _in_rows(member: Member, corner: Array) -> Array:
    """Return the points (R, 3), mm, of all rows of teeth in the order of z, for the points (2, 3) on the toe and the heel.

    Rows that meet share a point.
    """
    points = [*corner]
    for half in member.halves[1:]:
        image = half.points(corner)[::-1]
        points += [*image[len(half.shared) :]]
    return np.stack(points)


@dataclass(frozen=True)
class BarTop:
    """Top of the bar under a row of teeth; toe and heel are those of the row."""

    #: the row of teeth
    half: HalfGear
    #: outlines of the teeth on toe and heel, edges with their senses from the first to the last end of the bar
    outlines: tuple[list[tuple[Any, bool]], ...]
    #: vertex and point (3,) of the outline at the first and the last end, each on toe and heel
    corners: tuple[tuple[tuple[Any, Array], ...], ...]
    #: edges with their senses from toe to heel at the first and the last end
    lines: tuple[list[tuple[Any, bool]], ...]
    #: points (2, 2, 3), mm, of the root at the first and the last end, each on toe and heel
    roots: Array
    #: points (2, 3), mm, on toe and heel
    origins: Array


def under_teeth(member: Member, tops: Sequence[BarTop]) -> list[NamedFace]:
    """Return the faces of the bar beside and under its rows of teeth, and the walls of the holes across it."""
    foot, rows, (walls, holes) = _Foot.of(member, tops), member.rows, _bolt_holes(member)
    faces = [*walls, *(foot.end_face(end, upper, holes[upper]) for upper, end in enumerate(rows.outer))]
    faces += [foot.end_face(end, upper) for gap in rows.gaps for upper, end in enumerate(gap.ends)]
    for n in (0, 1):
        faces += [foot.side(n, number) for number in range(len(tops))]
        faces += [foot.side_of_gap(n, number) for number in range(len(rows.gaps))]
    return [*faces, foot.back_face(), *(foot.floor_of_gap(number) for number in range(len(rows.gaps)))]


@dataclass(frozen=True)
class _Foot:
    """Bar under its rows of teeth, with edges at and between the stations along z where rows of teeth begin and end.

    Pairs are of the first and the last end of the bar, in the order of y.
    """

    #: tops under the rows of teeth
    tops: Sequence[BarTop]
    #: gaps between the rows
    gaps: tuple[AxialGap, ...]
    #: height x of the back, mm
    back: float
    #: station of each end of a row; rows that meet share one
    station_of: dict[HalfEnd, int]
    #: edges at each station from the teeth down to the back, two at a gap: they meet at its floor
    down: tuple[list[list[Any]], ...]
    #: edges of the back between stations
    across_back: tuple[list[Any], ...]
    #: edges of the back along y at the first and the last station
    along_back: tuple[Any, Any]
    #: edges of the floor of each gap along z
    across_floor: tuple[list[Any], ...]
    #: edges of the floors along y, under the end of a row
    along_floor: dict[HalfEnd, Any]

    @staticmethod
    def of(member: Member, tops: Sequence[BarTop]) -> _Foot:
        """Return the foot of a bar under the tops of its rows."""
        rows, back = member.rows, member.tooth.blank.body.profile[0][0]
        stations = row_stations(rows)
        floors = {end: gap.floor for gap in rows.gaps for end in gap.ends}
        down, across_back, across_floor, ground, floor = list[list[list[Any]]](), [], [], [], []
        for n in (0, 1):
            ground.append([vertex(_below(tops, n, end, back)) for end, *_ in stations])
            floor.append({end: vertex(_below(tops, n, end, height)) for end, height in floors.items()})
            down.append([])
            for (end, *_), foot in zip(stations, ground[n], strict=True):
                top, _ = _corner(tops, n, end)
                way = [top, floor[n][end], foot] if end in floors else [top, foot]
                down[n].append([straight_edge(*pair) for pair in pairwise(way)])
            across_back.append([straight_edge(*pair) for pair in pairwise(ground[n])])
            across_floor.append([straight_edge(*(floor[n][end] for end in gap.ends[::-1])) for gap in rows.gaps])
        return _Foot(
            tops,
            rows.gaps,
            back,
            {end: k for k, ends in enumerate(stations) for end in ends},
            tuple(down),
            tuple(across_back),
            (straight_edge(ground[0][0], ground[1][0]), straight_edge(ground[0][-1], ground[1][-1])),
            tuple(across_floor),
            {end: straight_edge(floor[0][end], floor[1][end]) for end in floors},
        )

    def end_face(self, end: HalfEnd, upper: int, wires: Sequence[Any] = ()) -> NamedFace:
        """Return the end face of a row, down to the back, or at a gap to its floor; `upper`: 1 if it looks along +z."""
        half, which = end
        at_gap = end in self.along_floor
        first, last = (down[self.station_of[end]][: 1 if at_gap else None] for down in self.down)
        base = self.along_floor[end] if at_gap else self.along_back[upper]
        loop = [*self.tops[half].outlines[which], *_forwards(last), (base, False), *_backwards(first)]
        region = (Region.FACE_TOE, Region.FACE_HEEL)[upper]
        normal = np.array([0.0, 0.0, 1.0 if upper else -1.0])
        shape = _plane(self.tops[half].origins[which], normal, loop if upper else _reverse(loop), wires)
        return NamedFace(shape, f"{region}_gap" if at_gap else f"{region}", region)

    def side(self, n: int, number: int) -> NamedFace:
        """Return the face under a row at the first (n = 0) or last (1) end of the bar."""
        top, sense = self.tops[number], 1.0 if n else -1.0
        toe, heel = self.station_of[number, 0], self.station_of[number, 1]
        rising, across = heel > toe, self.across_back[n][min(toe, heel)]
        down = self.down[n]
        loop = [*top.lines[n], *_forwards(down[heel]), (across, not rising), *_backwards(down[toe])]
        normal = sense * top.half.hand_sign * np.cross(top.roots[n, 1] - top.roots[n, 0], [1.0, 0.0, 0.0])
        shape = _plane(top.roots[n, 0], normal, loop if (n == 0) == rising else _reverse(loop))
        return NamedFace(shape, f"end_{n + 1}{top.half.suffix}", Region.END)

    def side_of_gap(self, n: int, number: int) -> NamedFace:
        """Return the face under a gap at the first (n = 0) or last (1) end of the bar."""
        upper_end, lower_end = self.gaps[number].ends
        low, high = self.station_of[lower_end], self.station_of[upper_end]
        loop = [(self.across_floor[n][number], True), (self.down[n][high][1], True)]
        loop += [(self.across_back[n][low], False), (self.down[n][low][1], False)]
        normal = np.array([0.0, 1.0 if n else -1.0, 0.0])
        shape = _plane(_below(self.tops, n, lower_end, self.back), normal, _reverse(loop) if n else loop)
        return NamedFace(shape, f"end_{n + 1}_gap", Region.END)

    def back_face(self) -> NamedFace:
        """Return the back of the bar."""
        near, far = self.along_back
        loop = [*_forwards(self.across_back[0]), (far, True), *_backwards(self.across_back[1]), (near, False)]
        first = next(iter(self.station_of))
        shape = _plane(_below(self.tops, 0, first, self.back), np.array([-1.0, 0.0, 0.0]), loop)
        return NamedFace(shape, Region.BACK, Region.BACK)

    def floor_of_gap(self, number: int) -> NamedFace:
        """Return the floor of a gap."""
        gap = self.gaps[number]
        upper_end, lower_end = gap.ends
        loop = [(self.along_floor[lower_end], True), (self.across_floor[1][number], True)]
        loop += [(self.along_floor[upper_end], False), (self.across_floor[0][number], False)]
        shape = _plane(_below(self.tops, 0, lower_end, gap.floor), np.array([1.0, 0.0, 0.0]), loop)
        return NamedFace(shape, Region.GAP, Region.GAP)


def _corner(tops: Sequence[BarTop], n: int, end: HalfEnd) -> tuple[Any, Array]:
    """Return vertex and point (3,) where the outline of a row begins (n = 0) or ends (1)."""
    half, which = end
    return tops[half].corners[n][which]


def _below(tops: Sequence[BarTop], n: int, end: HalfEnd, height: float) -> Array:
    """Return the point (3,) at a height x under a corner of a row's outline."""
    return np.array([height, *_corner(tops, n, end)[1][1:]])


def _forwards(edges: Sequence[Any]) -> list[tuple[Any, bool]]:
    """Return edges with their own sense."""
    return [(part, True) for part in edges]


def _backwards(edges: Sequence[Any]) -> list[tuple[Any, bool]]:
    """Return edges in opposite order and sense."""
    return [(part, False) for part in reversed(edges)]


def has_straight_faces(member: Member) -> bool:
    """Return True if all faces of a rack are planes and cylinders along the tooth traces."""
    tooth = member.tooth
    rounded = tooth.tip_edge is not None and tooth.tip_edge.rounded
    return tooth.unmodified_tooth is tooth and not rounded and tooth.blank.ends == SHARP_ENDS


def spline_bar_part(member: Member, teeth: SplineTooth) -> Part:
    """Build the whole rack with spline patches on its teeth; faces are named by region and number of the tooth.

    Raises DesignError for an invalid solid, OutputError without OpenCASCADE.
    """
    require_occ()
    tooth, rows = teeth.tooth, list[_BarRow]()
    faces, tops = list[NamedFace](), list[BarTop]()
    for half in member.halves:
        rows.append(_BarRow.of(teeth.place(half), rows[0] if half.shared else None))
        faces += rows[-1].faces
    for row in rows:
        toe_and_heel = tuple(
            BarEnd.of(row.teeth, end, ([column[-end] for column in row.vertices], row.outlines[end]), row.ways)
            for end in (0, 1)
        )
        top, of_row = _bar_top(member, row, toe_and_heel, tops[0] if row.teeth.half.shared else None)
        faces += [*of_row, *(face for side in toe_and_heel for face in side.faces)]
        tops.append(top)
    faces += under_teeth(member, tops)
    edges = zip(end_edges(tooth.blank.axial), (0, 1), strict=True)
    chamfers = tuple(region for region, end in edges if teeth.strips[end])
    return whole_part(member.name, tuple(faces), (*tooth.regions, *member.body_regions, *chamfers))


@dataclass(frozen=True)
class _BarRow:
    """A row of teeth of a bar, without the half roots at its ends."""

    #: faces of tooth 1
    teeth: SplineTooth
    #: translations (3,) to all teeth, mm
    ways: list[Array]
    #: corners (N, G, 3), mm, where columns begin, last where the teeth end
    corners: Array
    #: their vertices
    vertices: list[list[Any]]
    #: edges along the face where columns begin, last where the teeth end
    along: list[list[Any]]
    #: edges of the links on toe and heel
    outlines: tuple[list[Any], list[Any]]
    #: faces of the teeth
    faces: list[NamedFace]

    @staticmethod
    def of(teeth: SplineTooth, met: _BarRow | None) -> _BarRow:
        """Return a row; its heel is the heel of the row that it has `met`, if any."""
        tooth, links, rows = teeth.tooth, len(teeth.links), range(len(teeth.bounds))
        rooted = teeth.links[0].region is Region.ROOT
        places, curves = tooth.joint.places(tooth.teeth), [LinkCurves.of(teeth, i) for i in range(links)]
        ways = [np.asarray(tooth.joint.to(place * tooth.pitch_angle).translation) for place in places.tolist()]
        # the first root is only half, and belongs to the bar's end; another half root follows the last tooth
        columns = [(k, i) for k in range(tooth.teeth) for i in range(links)][1 if rooted else 0 :]
        last_corner = [patch.control[-1, end] for patch, end in _row_ends(teeth)]
        corners = np.array([teeth.corners[i] + ways[k] for k, i in columns] + [np.array(last_corner) + ways[-1]])
        vertices = [[vertex(r) for r in column] for column in corners]
        for own, other in zip(vertices, [] if met is None else met.vertices, strict=False):
            own[-1] = other[-1]
        # edges along the face where links begin, and edges of the links on toe and heel
        borders = [*curves, LinkCurves({}, [spline_curve(*border) for border in link_border(teeth, links)])]
        starts = [*columns, (tooth.teeth - 1, links)]
        along = [
            [
                edge(_move(curve, ways[k]), vertices[n][g], vertices[n][g + 1], 0.0, 1.0)
                for g, curve in enumerate(borders[i].along)
            ]
            for n, (k, i) in enumerate(starts)
        ]
        across = [
            {
                row: edge(_move(curve, ways[k]), vertices[n][row], vertices[n + 1][row], 0.0, last)
                for row, (curve, last) in curves[i].across.items()
            }
            for n, (k, i) in enumerate(columns)
        ]
        for edges, other in zip(across, [] if met is None else met.outlines[1], strict=False):
            edges[rows[-1]] = other
        # the faces of tooth 1, moved to all teeth
        drawn = [drawn_faces(teeth, i, DrawnFace.of_net) for i in range(links)]
        faces = []
        for n, (k, i) in enumerate(columns):
            for patch in drawn[i]:
                toe, heel = (across[n][row] for row in patch.rows)
                span = slice(*patch.rows)
                shape = patch.face(_move(patch.surface, ways[k]), Sides(toe, along[n + 1][span], heel, along[n][span]))
                name = f"{patch.region}_{k + 1}{teeth.half.suffix}"
                faces.append(NamedFace(shape, name, patch.region, tooth=k + 1))
        outlines = [edges[rows[0]] for edges in across], [edges[rows[-1]] for edges in across]
        return _BarRow(teeth, ways, corners, vertices, along, outlines, faces)


def _row_ends(teeth: SplineTooth) -> list[tuple[Patch, int]]:
    """Return, for every bound, a patch of the last link that reaches it and the end of the patch there, 0 or -1."""
    row = teeth.patches[teeth.links[-1]]
    return [*((patch, 0) for patch in row), (row[-1], -1)]


def _move(shape: Any, way: Array) -> Any:
    """Return a curve or surface moved by `way` (3,)."""
    return shape.Transformed(translation(way))


def _bar_top(
    member: Member, row: _BarRow, sides: tuple[BarEnd, ...], met: BarTop | None
) -> tuple[BarTop, list[NamedFace]]:
    """Return where the bar under a row begins, and the half roots at its ends.

    - `sides`: toe and heel of the row
    - `met`: top of the row whose heel is the heel of this row, if any
    """
    # the ends of the bar are planes through the roots, moved outwards by the overhang
    half, tooth, up = row.teeth.half, row.teeth.tooth, np.array([1.0, 0.0, 0.0])
    ends = half.points(row.corners[[0, -1]][:, [0, -1]])
    for n, end in enumerate(ends):
        end[:, 1] = member.bar_ends(end[:, 2])[n]
    ends = half.points(ends)
    first = float(tooth.root_middle(np.zeros(1))[0])
    moved = [float(of[0]) - first for of in member.bar_ends(np.zeros(1))]
    top = [[vertex(r) for r in column] for column in ends]
    for n, column in enumerate(top):
        if met is not None:
            column[1] = met.corners[n][1][0]

    def half_root(n: int, end: int) -> HalfRoot:
        """Return the half root from the first end to the first tooth, or from the last tooth to the last end."""
        if met is not None and end == 1:
            rim, _ = met.outlines[1][-n]
            return HalfRoot(rim, rim, *met.corners[n][1])
        at = (top[n][end], ends[n, end])
        return sides[end].half_root(n, at, (row.vertices[-n][-end], row.corners[-n, -end]), moved[n])

    halves = [[half_root(n, end) for end in (0, 1)] for n in (0, 1)]
    across_top = [straight_edge(*column) for column in top]
    roots = (
        Sides(halves[0][0].root, row.along[0], halves[0][1].root, [across_top[0]]),
        Sides(halves[1][0].root, [across_top[1]], halves[1][1].root, row.along[-1]),
    )
    faces = list[NamedFace]()
    for number, side in zip((1, tooth.teeth + 1), roots, strict=True):
        shape = _plane(ends[0, 0], up, side.wire if half.hand_sign > 0 else _reverse(side.wire))
        faces.append(NamedFace(shape, f"root_{number}{half.suffix}", Region.ROOT))
    origins = np.array([root.point for root in halves[0]])
    origins[:, 0] = tooth.blank.body.profile[0][0]
    made = BarTop(
        half,
        tuple([(part, True) for part in (halves[0][end].rim, *sides[end].edges, halves[1][end].rim)] for end in (0, 1)),
        tuple(tuple((root.corner, root.point) for root in of_end) for of_end in halves),
        tuple(
            [(part, True) for part in (halves[n][0].side, across_top[n], halves[n][1].side) if part is not None]
            for n in (0, 1)
        ),
        ends,
        origins,
    )
    return made, faces


def _links(member: Member) -> tuple[list[BarLink], Array, float]:
    """Return the links of the bar from end to end, their end (2, 3), mm, and their distance (mm) from the exact surfaces."""
    # arcs of fillets and planes of the other links of one tooth, with the distance of exact points from them
    tooth = member.tooth
    ends = tooth.sections(np.array([0.0, 1.0]))
    drawn = {region: tooth.grid(region, LINK_SAMPLES, ends) for region in tooth.regions}
    grids = {region: grid.points for region, grid in drawn.items()}
    wide = [r for r in tooth.regions if np.linalg.norm(grids[r][-1] - grids[r][0], axis=-1).max() > MIN_LINK_WIDTH_MM]
    arcs: dict[Region, BarArc] = {}
    miss = 0.0
    for region in wide:
        toe = grids[region][:, 0]
        if region in FILLET_REGIONS.values():
            trace = unit(grids[region][0, 1] - toe[0])
            arcs[region] = BarArc.of(toe, drawn[region].normals[:, 0], trace)
            miss = max(miss, arcs[region].miss(toe))
        else:
            normal = unit(np.cross(toe[-1] - toe[0], grids[region][0, 1] - toe[0]))
            miss = max(miss, float(np.abs((grids[region] - toe[0]) @ normal).max()))
    # the links of all teeth, with a half root at either end
    places, pitch = tooth.joint.places(tooth.teeth), tooth.pitch_angle
    half = np.array(
        [0.0, 0.5 * float(np.linalg.norm(grids[Region.ROOT][-1] - grids[Region.ROOT][0], axis=-1).max()), 0.0]
    )
    half[1] += member.overhang
    links: list[BarLink] = []
    roots = half[1] > MIN_LINK_WIDTH_MM
    for k, place in enumerate(places.tolist(), 1):
        way = tooth.joint.to(place * pitch).translation
        for region in wide:
            corner = grids[region][0] + way
            if region is Region.ROOT and k == 1:
                continue
            if region is not Region.ROOT and not links and roots:
                links.append(BarLink(Region.ROOT, "root_1", corner - half))
            arc = arcs.get(region)
            links.append(BarLink(region, f"{region}_{k}", corner, arc and arc.move(way), k))
    last = grids[wide[-1]][-1] + tooth.joint.to(places[-1] * pitch).translation
    if roots:
        links.append(BarLink(Region.ROOT, f"root_{len(places) + 1}", last))
        last = last + half
    return links, last, miss


def _across(link: BarLink, begin: Any, end: Any, way: Array) -> Any:
    """Return the edge of a link on toe or heel, `way` (3,) from the toe."""
    if link.arc is None:
        return straight_edge(begin, end)
    return edge(link.arc.curve(way), begin, end, link.arc.first, link.arc.last)


def _reverse(sides: list[tuple[Any, bool]]) -> list[tuple[Any, bool]]:
    """Return a closed line in the opposite direction."""
    return [(edge, not forward) for edge, forward in reversed(sides)]


def _bolt_holes(member: Member) -> tuple[list[NamedFace], tuple[list[Any], list[Any]]]:
    """Return the walls and floors of the holes across a bar, and the wires of the holes in toe and heel.

    The wires go clockwise about the outward normals of toe and heel.
    """
    cuts = [(opening, Prism.of(opening.curves, (opening.low, opening.high))) for opening in member.openings]
    toe = [wire(*((edge, True) for edge in cut.edges[0])) for opening, cut in cuts if opening.floor is None]
    return opening_faces(cuts), (toe, [cut.wire_at(1) for _, cut in cuts])


def _plane(origin: Array, normal: Array, sides: list[tuple[Any, bool]], holes: Sequence[Any] = ()) -> Any:
    """Return a plane face with edges counterclockwise about its outward normal, and with holes by their wires."""
    from OCP.Geom import Geom_Plane
    from OCP.gp import gp_Dir

    return face(Geom_Plane(point(origin), gp_Dir(*normal.tolist())), [wire(*sides), *holes], True)


def _extrude(arc: BarArc, way: Array, sides: list[tuple[Any, bool]]) -> Any:
    """Return the face of an arc extruded by `way` (3,) from toe to heel; its sides are toe, far, heel, near."""
    from OCP.BRep import BRep_Builder
    from OCP.TopLoc import TopLoc_Location

    surface, sense = arc.surface(unit(way))
    length = sense * float(np.linalg.norm(way))
    curves = [((0.0, 0.0), (1.0, 0.0)), ((arc.last, 0.0), (0.0, sense)), ((0.0, length), (1.0, 0.0))]
    curves.append(((arc.first, 0.0), (0.0, sense)))
    builder, here = BRep_Builder(), TopLoc_Location()
    for (side, _), (start, direction) in zip(sides, curves, strict=True):
        builder.UpdateEdge(side, straight2d(start, direction), surface, here, PRECISION_MM)
    return face(surface, [wire(*(sides if sense > 0.0 else _reverse(sides)))], sense > 0.0)
