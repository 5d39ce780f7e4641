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
from typing import Any

import numpy as np

from gearmesh.cad.brep import MIN_LINK_WIDTH_MM, Patch, SplineTooth
from gearmesh.cad.faces.bar_end import BarEnd
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
    # vertices of the section on toe and heel, and under them on the back
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
    # a face for each link: a plane, or the extruded arc of a fillet
    faces = []
    for n, link in enumerate(links):
        sides = [(across[n][0], True), (along[n + 1], True), (across[n][1], False), (along[n], False)]
        way = corners[n, 1] - corners[n, 0]
        if link.arc is None:
            # the outward normal is the direction along the chain times the direction from toe to heel
            shape = _plane(corners[n, 0], np.cross(corners[n + 1, 0] - corners[n, 0], way), sides)
        else:
            shape = _extrude(link.arc, way, sides)
        faces.append(NamedFace(shape, link.name, link.region, tooth=link.tooth))
    # the bar under the teeth: toe, heel, both ends and back
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
    """Return True if all faces of a rack are planes and cylinders along the tooth traces."""
    tooth = member.tooth
    rounded = tooth.tip_edge is not None and tooth.tip_edge.rounded
    return tooth.unmodified_tooth is tooth and not rounded and tooth.blank.ends == SHARP_ENDS


def spline_bar_part(member: Member, teeth: SplineTooth) -> Part:
    """Build the whole rack with spline patches on its teeth; faces are named by region and number of the tooth.

    Raises DesignError for an invalid solid, OutputError without OpenCASCADE.
    """
    require_occ()
    tooth, links, rows = teeth.tooth, len(teeth.links), range(len(teeth.bounds))
    rooted = teeth.links[0].region is Region.ROOT
    places, curves = tooth.joint.places(tooth.teeth), [LinkCurves.of(teeth, i) for i in range(links)]
    ways = [np.asarray(tooth.joint.to(place * tooth.pitch_angle).translation) for place in places.tolist()]
    # the first root is only half, and belongs to the bar's end; another half root follows the last tooth
    columns = [(k, i) for k in range(tooth.teeth) for i in range(links)][1 if rooted else 0 :]
    last_corner = [patch.control[-1, end] for patch, end in _row_ends(teeth)]
    corners = np.array([teeth.corners[i] + ways[k] for k, i in columns] + [np.array(last_corner) + ways[-1]])
    vertices = [[vertex(r) for r in column] for column in corners]
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
    # the faces of tooth 1, moved to all teeth
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
    """Return, for every bound, a patch of the last link that reaches it and the end of the patch there, 0 or -1."""
    row = teeth.patches[teeth.links[-1]]
    return [*((patch, 0) for patch in row), (row[-1], -1)]


def _move(shape: Any, way: Array) -> Any:
    """Return a curve or surface moved by `way` (3,)."""
    return shape.Transformed(translation(way))


def _closed_bar(
    member: Member,
    faces: list[NamedFace],
    teeth: tuple[Array, list[list[Any]], list[list[Any]]],
    sides: tuple[BarEnd, BarEnd],
) -> Part:
    """Build the part from the faces of all teeth, the roots at both ends and the bar under them.

    - `teeth`: corners (N, G, 3), mm, their vertices, and the edges along the face, where columns begin; last where the teeth end
    - `sides`: toe and heel
    """
    # the ends of the bar are planes through the roots, moved outwards by the overhang
    tooth, (corners, vertices, along) = member.tooth, teeth
    ways = [tooth.joint.to(place * tooth.pitch_angle).translation[1] for place in tooth.joint.places(tooth.teeth)]
    far = float(ways[-1] + tooth.joint.to(tooth.pitch_angle).translation[1])
    moved = (float(ways[0]) - member.overhang, far + member.overhang)
    ends = corners[[0, -1]][:, [0, -1]]
    for end, beyond in zip(ends, moved, strict=True):
        end[:, 1] = tooth.root_middle(end[:, 2]) + beyond
    top = [[vertex(r) for r in column] for column in ends]
    up = np.array([1.0, 0.0, 0.0])
    # half roots from the first end to the first tooth, and from the last tooth to the last end
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
    # faces of the half roots, then of holes, toe and heel, both ends and the back
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
            if arc is not None:
                arc = BarArc(arc.centre + way, arc.axes, arc.halves, arc.first, arc.last)
            links.append(BarLink(region, f"{region}_{k}", corner, arc, k))
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
