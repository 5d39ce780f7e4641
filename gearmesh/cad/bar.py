r"""A rack as a solid with named faces for CAD: planes and cylinders, as they are, or spline patches where flanks are modified.

                 __ land __                      columns: where links of the section begin, from end to end of the bar
    flank_right /          \ flank_left          rows: toe and heel, planes across z
    ___________/            \___________
    root    fillet          fillet    root       along the tooth traces every edge is straight

What a plane across z cuts of a root fillet is an arc, of helical teeth that of an ellipse; the fillet is that arc drawn along the
trace, of spur teeth a cylinder by name. Teeth with modified flanks or rounded tip edges are patches as those of gears, between bars
of planes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.cad.brep import NARROWEST, Patch, SplineTooth
from gearmesh.cad.faces.bar_end import BarEnd
from gearmesh.cad.faces.drawn_face import DrawnFace, Sides
from gearmesh.cad.occ import (
    PRECISION,
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
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FILLET_REGIONS, Region

#: s along a link at which its distance from what is drawn is measured
SAMPLES = np.linspace(0.0, 1.0, 17)


@dataclass(frozen=True)
class BarArc:
    """An arc in the plane of the toe: its centre (3,), directions (3,) of its axes, along the bar and out of or into it, their
    halves, mm, and the angles between which it goes, growing, from column to column."""

    centre: Array
    axes: Array
    halves: Array
    first: float
    last: float

    @staticmethod
    def of(toe: Array, normals: Array, trace: Array) -> BarArc:
        """Of a root fillet with points and normals (K, 3) on the toe, drawn along the unit vector `trace`."""
        middle, radius = rounding(toe, normals, trace)
        centre = middle + trace * (toe[0, 2] - middle[2]) / trace[2]
        halves = radius * np.array([1.0 / trace[2], 1.0])
        begin, end = toe[0], toe[-1]
        axes = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
        # the shorter way round, and so that angles grow
        (first, last) = _angles(np.stack((begin, end)) - centre, axes, halves)
        if (last - first) % (2.0 * np.pi) > np.pi:
            axes = axes * [[1.0], [-1.0]]
            (first, last) = _angles(np.stack((begin, end)) - centre, axes, halves)
        # from 0 on, as edges on closed curves are counted
        low = float(first % (2.0 * np.pi))
        return BarArc(centre, axes, halves, low, low + float((last - first) % (2.0 * np.pi)))

    def miss(self, r: Array) -> float:
        """Largest distance (mm) of points (K, 3) in its plane from the ellipse, to first order."""
        u = (r - self.centre) @ self.axes.T / self.halves
        rho = np.linalg.norm(u, axis=-1)
        slope = np.linalg.norm(u / self.halves, axis=-1) / rho
        return float(np.abs((rho - 1.0) / slope).max())

    def curve(self, way: Array) -> Any:
        """Geom_Ellipse, or Geom_Circle, moved by `way` (3,)."""
        from OCP.Geom import Geom_Circle, Geom_Ellipse

        place = self._frame(way).Ax2()
        if self.halves[0] == self.halves[1]:
            return Geom_Circle(place, float(self.halves[1]))
        return Geom_Ellipse(place, float(self.halves[0]), float(self.halves[1]))

    def surface(self, trace: Array) -> tuple[Any, float]:
        """What the arc is drawn to along the unit vector `trace`, and the sense in which its second parameter grows with it."""
        from OCP.Geom import Geom_CylindricalSurface, Geom_SurfaceOfLinearExtrusion
        from OCP.gp import gp_Dir

        if self.halves[0] == self.halves[1]:
            sense = float(np.sign(np.cross(*self.axes)[2]))
            return Geom_CylindricalSurface(self._frame(np.zeros(3)), float(self.halves[1])), sense
        return Geom_SurfaceOfLinearExtrusion(self.curve(np.zeros(3)), gp_Dir(*trace.tolist())), 1.0

    def _frame(self, way: Array) -> Any:
        from OCP.gp import gp_Ax3, gp_Dir

        normal = np.cross(*self.axes)
        return gp_Ax3(point(self.centre + way), gp_Dir(*normal.tolist()), gp_Dir(*self.axes[0].tolist()))


def rounding(r: Array, normals: Array, trace: Array) -> tuple[Array, float]:
    """A point (3,) on the axis, and the radius, of the cylinder along a unit vector `trace` on which points r (K, 3) with normals
    (K, 3) lie, by the first and the last of them."""
    across, turned = r[-1] - r[0], normals[-1] - normals[0]
    across = across - (across @ trace) * trace
    radius = float(across @ turned / (turned @ turned))
    return r[0] - radius * normals[0], abs(radius)


def _angles(r: Array, axes: Array, halves: Array) -> Array:
    """Angles (K,), rad, of points (K, 3) from the centre of an ellipse."""
    u = r @ axes.T / halves
    return np.asarray(np.arctan2(u[:, 1], u[:, 0]))


@dataclass(frozen=True)
class BarLink:
    """A link of the section of the whole bar: its region, name, corner (2, 3), mm, on toe and heel where it begins, its arc,
    None where it is a plane, and the number of its tooth, None for the roots at the ends of the bar."""

    region: Region
    name: str
    corner: Array
    arc: BarArc | None = None
    tooth: int | None = None


def bar_part(member: Member) -> tuple[Part, float]:
    """The whole rack, its faces named by region and number of the tooth, and how far (mm) it is from the exact surfaces.

    Raises DesignError for what is no solid, OutputError where OpenCASCADE is missing.
    """
    require_occ()
    links, last, miss = _links(member)
    corners = np.stack([*(link.corner for link in links), last])
    vertices = [[vertex(r) for r in column] for column in corners]
    back = np.stack((corners[0], corners[-1]))
    back[..., 0] = member.tooth.blank.body.profile[0][0]
    under = [[vertex(r) for r in column] for column in back]
    along = [straight_edge(*column) for column in vertices]
    across = [
        tuple(_across(link, vertices[n][row], vertices[n + 1][row], corners[n, row] - corners[n, 0]) for row in (0, 1))
        for n, link in enumerate(links)
    ]
    faces = []
    for n, link in enumerate(links):
        sides = [(across[n][0], True), (along[n + 1], True), (across[n][1], False), (along[n], False)]
        way = corners[n, 1] - corners[n, 0]
        if link.arc is None:
            # out of the material: along the chain times from toe to heel
            shape = _plane(corners[n, 0], np.cross(corners[n + 1, 0] - corners[n, 0], way), sides)
        else:
            shape = _extrude(link.arc, way, sides)
        faces.append(NamedFace(shape, link.name, link.region, tooth=link.tooth))
    down = [[straight_edge(vertices[n][row], under[n][row]) for row in (0, 1)] for n in (0, -1)]
    across_back = [straight_edge(*column) for column in under]
    along_back = [straight_edge(under[0][row], under[1][row]) for row in (0, 1)]
    walls, holes = _bolt_holes(member)
    faces += walls
    for row, region, z in ((0, Region.FACE_TOE, -1.0), (1, Region.FACE_HEEL, 1.0)):
        outline = [*((edges[row], True) for edges in across), (down[1][row], True), (along_back[row], False)]
        outline.append((down[0][row], False))
        shape = _plane(corners[0, row], np.array([0.0, 0.0, z]), outline if row else _reverse(outline), holes[row])
        faces.append(NamedFace(shape, region, region))
    for n, sense in ((0, -1.0), (1, 1.0)):
        outline = [(along[-n], True), (down[n][1], True), (across_back[n], False), (down[n][0], False)]
        normal = sense * np.cross(corners[-n, 1] - corners[-n, 0], [1.0, 0.0, 0.0])
        shape = _plane(corners[-n, 0], normal, outline if n == 0 else _reverse(outline))
        faces.append(NamedFace(shape, f"end_{n + 1}", Region.END))
    outline = [(across_back[0], True), (along_back[1], True), (across_back[1], False), (along_back[0], False)]
    faces.append(NamedFace(_plane(back[0, 0], np.array([-1.0, 0.0, 0.0]), outline), Region.BACK, Region.BACK))
    return whole_part(member, tuple(faces), (*member.tooth.regions, *member.body_regions)), miss


def has_straight_faces(member: Member) -> bool:
    """Whether all faces of a rack are planes and cylinders along the tooth traces."""
    tooth = member.tooth
    rounded = tooth.tip_edge is not None and tooth.tip_edge.rounded
    return tooth.unmodified_tooth is tooth and not rounded and tooth.blank.ends == SHARP_ENDS


def spline_bar_part(member: Member, teeth: SplineTooth) -> Part:
    """The whole rack with spline patches on its teeth, its faces named by region and number of the tooth.

    Raises DesignError for what is no solid, OutputError where OpenCASCADE is missing.
    """
    require_occ()
    tooth, links, rows = teeth.tooth, len(teeth.links), range(len(teeth.bounds))
    rooted = teeth.links[0].region is Region.ROOT
    places, curves = tooth.joint.places(tooth.teeth), [LinkCurves.of(teeth, i) for i in range(links)]
    ways = [np.asarray(tooth.joint.to(place * tooth.pitch_angle).translation) for place in places.tolist()]
    # the first root is half of one, and behind the last tooth is another
    columns = [(k, i) for k in range(tooth.teeth) for i in range(links)][1 if rooted else 0 :]
    last_corner = [patch.control[-1, end] for patch, end in _row_ends(teeth)]
    corners = np.array([teeth.corners[i] + ways[k] for k, i in columns] + [np.array(last_corner) + ways[-1]])
    vertices = [[vertex(r) for r in column] for column in corners]
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
    drawn = [drawn_faces(teeth, i, DrawnFace.of_net) for i in range(links)]
    faces = []
    for n, (k, i) in enumerate(columns):
        for patch in drawn[i]:
            toe, heel = (across[n][row] for row in patch.rows)
            span = slice(*patch.rows)
            shape = patch.face(_move(patch.surface, ways[k]), Sides(toe, along[n + 1][span], heel, along[n][span]))
            faces.append(NamedFace(shape, f"{patch.region}_{k + 1}", patch.region, tooth=k + 1))
    toe, heel = (
        BarEnd.of(teeth, end, ([column[row] for column in vertices], [edges[row] for edges in across]), ways)
        for end, row in enumerate((rows[0], rows[-1]))
    )
    return _closed_bar(member, faces, (corners, vertices, along), (toe, heel))


def _row_ends(teeth: SplineTooth) -> list[tuple[Patch, int]]:
    """For every bound a patch of the last link that reaches it, and which end of the patch it is."""
    row = teeth.patches[teeth.links[-1]]
    return [*((patch, 0) for patch in row), (row[-1], -1)]


def _move(shape: Any, way: Array) -> Any:
    """A curve or surface moved by `way` (3,)."""
    return shape.Transformed(translation(way))


def _closed_bar(
    member: Member,
    faces: list[NamedFace],
    teeth: tuple[Array, list[list[Any]], list[list[Any]]],
    sides: tuple[BarEnd, BarEnd],
) -> Part:
    """The part of the faces of all teeth, the roots at both ends and the bar under them.

    `teeth`: corners (N, G, 3), mm, their vertices and the edges along the face where columns begin, the last where the teeth end;
    `sides`: toe and heel.
    """
    tooth, (corners, vertices, along) = member.tooth, teeth
    ways = [tooth.joint.to(place * tooth.pitch_angle).translation[1] for place in tooth.joint.places(tooth.teeth)]
    far = float(ways[-1] + tooth.joint.to(tooth.pitch_angle).translation[1])
    moved = (float(ways[0]) - member.overhang, far + member.overhang)
    ends = corners[[0, -1]][:, [0, -1]]
    for end, beyond in zip(ends, moved, strict=True):
        end[:, 1] = tooth.root_middle(end[:, 2]) + beyond
    top = [[vertex(r) for r in column] for column in ends]
    up = np.array([1.0, 0.0, 0.0])
    # from the first end to the first tooth, and from the last tooth to the last end
    halves = [
        [
            side.half_root(n, (top[n][row], ends[n, row]), (vertices[-n][-row], corners[-n, -row]), moved[n])
            for row, side in enumerate(sides)
        ]
        for n in (0, 1)
    ]
    back = np.array([[half.point for half in column] for column in halves])
    back[..., 0] = tooth.blank.body.profile[0][0]
    under = [[vertex(r) for r in column] for column in back]
    across_top, across_back = ([straight_edge(*column) for column in places] for places in (top, under))
    down = [[straight_edge(halves[n][row].corner, under[n][row]) for row in (0, 1)] for n in (0, 1)]
    along_back = [straight_edge(under[0][row], under[1][row]) for row in (0, 1)]
    roots = (
        Sides(halves[0][0].root, along[0], halves[0][1].root, [across_top[0]]),
        Sides(halves[1][0].root, [across_top[1]], halves[1][1].root, along[-1]),
    )
    for number, side in zip((1, tooth.teeth + 1), roots, strict=True):
        faces.append(NamedFace(_plane(ends[0, 0], up, side.wire), f"root_{number}", Region.ROOT))
    faces += [face for side in sides for face in side.faces]
    walls, holes = _bolt_holes(member)
    faces += walls
    for row, region, z in ((0, Region.FACE_TOE, -1.0), (1, Region.FACE_HEEL, 1.0)):
        loop = [(edge, True) for edge in (halves[0][row].rim, *sides[row].edges, halves[1][row].rim, down[1][row])]
        loop += [(along_back[row], False), (down[0][row], False)]
        shape = _plane(back[0, row], np.array([0.0, 0.0, z]), loop if row else _reverse(loop), holes[row])
        faces.append(NamedFace(shape, region, region))
    for n, sense in ((0, -1.0), (1, 1.0)):
        line = (halves[n][0].side, across_top[n], halves[n][1].side)
        loop = [(edge, True) for edge in line if edge is not None]
        loop += [(down[n][1], True), (across_back[n], False), (down[n][0], False)]
        normal = sense * np.cross(ends[n, 1] - ends[n, 0], up)
        faces.append(
            NamedFace(_plane(ends[n, 0], normal, loop if n == 0 else _reverse(loop)), f"end_{n + 1}", Region.END)
        )
    loop = [(across_back[0], True), (along_back[1], True), (across_back[1], False), (along_back[0], False)]
    faces.append(NamedFace(_plane(back[0, 0], -up, loop), Region.BACK, Region.BACK))
    chamfers = tuple(region for region, side in zip(end_edges(tooth.blank.axial), sides, strict=True) if side.patches)
    return whole_part(member, tuple(faces), (*tooth.regions, *member.body_regions, *chamfers))


def _links(member: Member) -> tuple[list[BarLink], Array, float]:
    """The links of the bar from end to end, where they end (2, 3), and how far (mm) they are from the exact surfaces."""
    tooth = member.tooth
    ends = tooth.sections(np.array([0.0, 1.0]))
    drawn = {region: tooth.grid(region, SAMPLES, ends) for region in tooth.regions}
    grids = {region: grid.points for region, grid in drawn.items()}
    wide = [r for r in tooth.regions if np.linalg.norm(grids[r][-1] - grids[r][0], axis=-1).max() > NARROWEST]
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
    places, pitch = tooth.joint.places(tooth.teeth), tooth.pitch_angle
    half = np.array(
        [0.0, 0.5 * float(np.linalg.norm(grids[Region.ROOT][-1] - grids[Region.ROOT][0], axis=-1).max()), 0.0]
    )
    half[1] += member.overhang
    links: list[BarLink] = []
    roots = half[1] > NARROWEST
    for k, place in enumerate(places.tolist(), 1):
        way = tooth.joint.to(place * pitch).translation
        for region in wide:
            corner = grids[region][0] + way
            if region is Region.ROOT and k == 1:
                continue
            if region is not Region.ROOT and not links and roots:
                links.append(BarLink(Region.ROOT, "root_1", corner - half))
            arc = arcs.get(region)
            if arc is not None:
                arc = BarArc(arc.centre + way, arc.axes, arc.halves, arc.first, arc.last)
            links.append(BarLink(region, f"{region}_{k}", corner, arc, k))
    last = grids[wide[-1]][-1] + tooth.joint.to(places[-1] * pitch).translation
    if roots:
        links.append(BarLink(Region.ROOT, f"root_{len(places) + 1}", last))
        last = last + half
    return links, last, miss


def _across(link: BarLink, begin: Any, end: Any, way: Array) -> Any:
    """The edge of a link on toe or heel, `way` (3,) from the toe."""
    if link.arc is None:
        return straight_edge(begin, end)
    return edge(link.arc.curve(way), begin, end, link.arc.first, link.arc.last)


def _reverse(sides: list[tuple[Any, bool]]) -> list[tuple[Any, bool]]:
    """A closed line the other way round."""
    return [(edge, not forward) for edge, forward in reversed(sides)]


def _bolt_holes(member: Member) -> tuple[list[NamedFace], tuple[list[Any], list[Any]]]:
    """The walls and floors of the holes across a bar, and the wires of their mouths, clockwise about the outward normals of toe and
    heel."""
    cuts = [(opening, Prism.of(opening.curves, (opening.low, opening.high))) for opening in member.openings]
    toe = [wire(*((edge, True) for edge in cut.edges[0])) for opening, cut in cuts if opening.floor is None]
    return opening_faces(cuts), (toe, [cut.wire_at(1) for _, cut in cuts])


def _plane(origin: Array, normal: Array, sides: list[tuple[Any, bool]], holes: Sequence[Any] = ()) -> Any:
    """A plane face with edges counterclockwise about its outward normal, and the wires of holes in it."""
    from OCP.Geom import Geom_Plane
    from OCP.gp import gp_Dir

    return face(Geom_Plane(point(origin), gp_Dir(*normal.tolist())), [wire(*sides), *holes], True)


def _extrude(arc: BarArc, way: Array, sides: list[tuple[Any, bool]]) -> Any:
    """The face of an arc drawn by `way` (3,) from toe to heel; its sides are toe, far, heel, near."""
    from OCP.BRep import BRep_Builder
    from OCP.TopLoc import TopLoc_Location

    surface, sense = arc.surface(unit(way))
    length = sense * float(np.linalg.norm(way))
    curves = [((0.0, 0.0), (1.0, 0.0)), ((arc.last, 0.0), (0.0, sense)), ((0.0, length), (1.0, 0.0))]
    curves.append(((arc.first, 0.0), (0.0, sense)))
    builder, here = BRep_Builder(), TopLoc_Location()
    for (side, _), (start, direction) in zip(sides, curves, strict=True):
        builder.UpdateEdge(side, straight2d(start, direction), surface, here, PRECISION)
    return face(surface, [wire(*(sides if sense > 0.0 else _reverse(sides)))], sense > 0.0)
