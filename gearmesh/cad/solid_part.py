"""A member as a solid with named faces for CAD: the teeth's spline patches on a body of planes, cones and cylinders.

Each vertex and edge is made once and the faces are built on them, so the shell is closed by construction, without sewing. Columns
are the beginnings of the links of the chain, counted round all teeth; rows are toe, breaks and heel. Hub, web and bore are parts
of the profile of the body of revolution.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.cad.brep import SplineTooth
from gearmesh.cad.faces.drawn_face import DrawnFace, Sides
from gearmesh.cad.faces.strip_faces import strip_faces
from gearmesh.cad.occ import PRECISION_MM, edge, frame, spline_curve, vertex
from gearmesh.cad.step import NamedFace, Part, require_occ
from gearmesh.cad.turned import Loop, Prism, Trace, TurnedSurface, circle, plane_face, turned_face
from gearmesh.errors import DesignError
from gearmesh.io.digits import points_on_grid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.teeth.blank.body import Body, end_edges, end_regions
from gearmesh.teeth.blank.bores import ClosedLine
from gearmesh.teeth.blank.features import Opening
from gearmesh.teeth.blank.halves import HalfEnd
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region


def solid_part(member: Member, teeth: SplineTooth) -> Part:
    """Build the whole member; faces are named by region, and faces of teeth also by number (1 is the tooth on +x).

    Raises DesignError if hub, bore and keyway make no valid solid, and for teeth that differ; OutputError without OpenCASCADE.
    """
    require_occ()
    member.check_alike()
    edges = end_edges(teeth.tooth.blank.axial)
    chamfers = tuple(region for region, strip in zip(edges, teeth.strips, strict=True) if strip)
    return whole_part(
        member.name, tuple(_faces(member, teeth)), (*teeth.tooth.regions, *member.body_regions, *chamfers)
    )


def whole_part(name: str, faces: tuple[NamedFace, ...], regions: tuple[str, ...]) -> Part:
    """Build a part with a name from faces that share all their edges. Raises DesignError for an invalid solid."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid

    builder, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    builder.MakeShell(shell)
    for named in faces:
        builder.Add(shell, named.shape)
    shell.Closed(True)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    if not BRepCheck_Analyzer(solid).IsValid():
        raise DesignError(
            name,
            reason="the faces do not make a valid solid; change bore, keyway or hub, or choose a larger tolerance",
        )
    return Part(name, solid, faces, regions)


def _faces(member: Member, teeth: SplineTooth) -> list[NamedFace]:
    """Return all faces of a member: of the teeth of all rows, of the gaps between rows, and of the body."""
    faces, loops, rows = list[NamedFace](), list[tuple[Loop, Loop]](), list[tuple[_Row, _Row]]()
    for half in member.halves:
        toothed, ends, outlines = tooth_faces(teeth.place(half), {-end: rows[0][end] for end in half.shared})
        faces += toothed
        loops.append(ends)
        rows.append(outlines)

    def between(ends: tuple[HalfEnd, HalfEnd]) -> tuple[Loop, Loop]:
        toe, heel = (loops[half][end] for half, end in ends)
        return toe, heel

    faces += _body(member, between(member.rows.outer), teeth.outward)
    for gap in member.gaps:
        faces += _gap_faces(gap.body, between(gap.ends), teeth)
    return faces


def _gap_faces(gap: Body, outline: tuple[Loop, Loop], teeth: SplineTooth) -> list[NamedFace]:
    """Return the cylinder in a gap, and the end faces of the teeth on both sides of the gap, a toe and a heel."""
    up = station_normal(teeth.tooth.blank.axial)[1] > 0.0
    loops = [circle(rho, z, 0.0) for rho, z in gap.profile]
    (_, first), (_, last) = gap.profile
    faces = [NamedFace(turned_face(loops[0], loops[1], (last < first) == teeth.outward), Region.GAP, Region.GAP)]
    regions = end_regions(teeth.tooth.blank.axial)
    for end, (loop, ring) in enumerate(zip(outline, loops, strict=True)):
        outer, inner = (ring, loop) if ring.rho > loop.rho else (loop, ring)
        faces.append(NamedFace(plane_face(outer, inner, up == (end == 1)), f"{regions[end]}_gap", regions[end]))
    return faces


#: vertices and edges of the outline of all teeth at a bound, from column to column
_Row = tuple[list[Any], list[Any]]


def tooth_faces(
    teeth: SplineTooth, shared: Mapping[int, _Row] | None = None
) -> tuple[list[NamedFace], tuple[Loop, Loop], tuple[_Row, _Row]]:
    """Return the faces of all teeth, the loops of their outlines on toe and heel, and vertices and edges of these outlines.

    `shared`: outlines at toe (0) or heel (-1) that another row of teeth has made already.
    """
    # vertices of all columns and rows, with the shared ones
    links, count = len(teeth.links), teeth.count * len(teeth.links)
    turns = [turn_about_z(k * teeth.step) for k in range(teeth.count)]
    vertices = [[vertex(r, turns[n // links]) for r in teeth.corners[n % links]] for n in range(count)]
    for row, (corners, _) in (shared or {}).items():
        for places, corner in zip(vertices, corners, strict=True):
            places[row] = corner
    outlines = [LinkCurves.of(teeth, i) for i in range(links)]

    def place(curve: Any, n: int) -> Any:
        return curve.Transformed(turns[n // links])

    # edges of links at the bounds, with the shared ones, and edges along the face where links begin
    across = [
        {
            row: edge(place(curve, n), vertices[n][row], vertices[(n + 1) % count][row], 0.0, last)
            for row, (curve, last) in outlines[n % links].across.items()
        }
        for n in range(count)
    ]
    bounds = len(teeth.bounds)
    for row, (_, edges) in (shared or {}).items():
        for column, own in zip(across, edges, strict=True):
            column[row % bounds] = own
    along = [
        [
            edge(place(curve, n), vertices[n][g], vertices[n][g + 1], 0.0, 1.0)
            for g, curve in enumerate(outlines[n % links].along)
        ]
        for n in range(count)
    ]
    # the faces of tooth 1, turned to all teeth on their vertices and edges
    drawn = [drawn_faces(teeth, i) for i in range(links)]
    faces = []
    for n in range(count):
        k, i = divmod(n, links)
        for part in drawn[i]:
            sides = Sides(
                across[n][part.rows[0]],
                along[(n + 1) % count][slice(*part.rows)],
                across[n][part.rows[1]],
                along[n][slice(*part.rows)],
            )
            shape = part.face(place(part.surface, n), sides)
            name = f"{part.region}_{k + 1}{teeth.half.suffix}"
            faces.append(NamedFace(shape, name, part.region, 0 if k else teeth.count, k + 1))
    # outlines of the end faces: of the teeth, or of their chamfers
    ends = [
        Loop(
            tuple(edges[row] for edges in across),
            vertices[0][row],
            float(np.hypot(*teeth.corners[0, row, :2])),
            float(teeth.corners[0, row, 2]),
            float(np.arctan2(*teeth.corners[0, row, 1::-1])),
            _traces(teeth, row),
        )
        for row in (0, bounds - 1)
    ]
    first, last = (([own[row] for own in vertices], [own[row] for own in across]) for row in (0, bounds - 1))
    for end, under in enumerate((first, last)):
        if teeth.strips[end]:
            chamfers, ends[end] = strip_faces(teeth, end, under, turns)
            faces += chamfers
    return faces, (ends[0], ends[1]), (first, last)


def turn_about_z(angle: float) -> Any:
    """gp_Trsf that turns about z by an angle (rad)."""
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

    made = gp_Trsf()
    made.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), angle)
    return made


@dataclass(frozen=True)
class _Arc:
    """The end of a turned link at a bound: an arc of a circle about z."""

    #: radius, mm
    rho: float
    #: height, mm
    z: float
    #: polar angle of the beginning, rad
    start: float
    #: angle from beginning to end, rad, negative for clockwise arcs
    width: float

    @staticmethod
    def of(teeth: SplineTooth, link: int, row: int) -> _Arc:
        """Return the arc of a link of tooth 1 at a bound."""
        first, width = teeth.corner(link, row), teeth.arc_width(link, row)
        return _Arc(float(np.hypot(first[0], first[1])), float(first[2]), float(np.arctan2(first[1], first[0])), width)


@dataclass(frozen=True)
class LinkCurves:
    """The curves of a link of tooth 1."""

    #: curves of the link at the bounds that have one, with the last parameter of each
    across: dict[int, tuple[Any, float]]
    #: curves along the face where the link begins, from bound to bound
    along: list[Any]

    @staticmethod
    def of(teeth: SplineTooth, i: int) -> LinkCurves:
        from OCP.Geom import Geom_Circle

        rows = range(len(teeth.bounds))
        along = [spline_curve(control, knots) for control, knots in link_border(teeth, i)]
        if teeth.links[i] in teeth.patches:
            knots = teeth.patches[teeth.links[i]][0].s_knots
            return LinkCurves({row: (spline_curve(_row(teeth, i, row), knots), 1.0) for row in rows}, along)
        arcs = {row: _Arc.of(teeth, i, row) for row in (rows[0], rows[-1])}
        return LinkCurves(
            {
                row: (
                    Geom_Circle(frame((0.0, 0.0, arc.z), np.copysign(1.0, arc.width), arc.start).Ax2(), arc.rho),
                    abs(arc.width),
                )
                for row, arc in arcs.items()
            },
            along,
        )


def _row(teeth: SplineTooth, i: int, row: int) -> Array:
    """Return the control polygon (S, 3), mm, of a spline link at a bound."""
    patches = teeth.patches[teeth.links[i]]
    return patches[row].control[:, 0] if row < len(patches) else patches[-1].control[:, -1]


def link_border(teeth: SplineTooth, i: int) -> list[tuple[Array, Array]]:
    """Return control polygons (T, 3), mm, and knots, from bound to bound, of the curve where link i of tooth 1 begins.

    i may be one beyond the last link, where the next tooth begins.
    """
    joint, pitch = teeth.tooth.joint, teeth.step
    turn = joint.to(pitch * (i // len(teeth.links)))
    i %= len(teeth.links)
    own = teeth.patches.get(teeth.links[i])
    # on the grid first, as every tooth is
    if own is not None:
        return [(turn.point(points_on_grid(patch.control[0])), patch.t_knots) for patch in own]
    if i == 0:
        turn = joint.to(-pitch) @ turn
    before = teeth.patches[teeth.links[i - 1]]
    return [(turn.point(points_on_grid(patch.control[-1])), patch.t_knots) for patch in before]


def drawn_faces(teeth: SplineTooth, i: int, face_of: Callable[..., DrawnFace] = DrawnFace.of_spline) -> list[DrawnFace]:
    """Return the faces of a link of tooth 1; `face_of` makes the faces of its patches."""
    if teeth.links[i] not in teeth.patches:
        return [_turned_link(teeth, i)]
    return [
        face_of(patch.region, (g, g + 1), (patch.control, patch.s_knots, patch.t_knots), outward=teeth.outward)
        for g, patch in enumerate(teeth.patches[teeth.links[i]])
    ]


def _turned_link(teeth: SplineTooth, i: int) -> DrawnFace:
    """Return the land or root of tooth 1 as a plane, cylinder or cone."""
    from OCP.Geom import Geom_Plane

    rows = (0, len(teeth.bounds) - 1)
    toe, heel = (_Arc.of(teeth, i, row) for row in rows)
    if teeth.level(teeth.links[i]).normal[0] == 0.0:
        plane = Geom_Plane(frame((0.0, 0.0, toe.z), 1.0, 0.0))
        with_chain = (heel.rho < toe.rho) == (toe.width > 0.0)
        return DrawnFace(teeth.links[i].region, rows, plane, (), with_chain, teeth.outward)
    ends = np.array([(toe.rho, toe.z), (heel.rho, heel.z)])
    # the seam of the surface lies opposite to the link
    middle = toe.start + 0.5 * toe.width
    turned = TurnedSurface.through(ends[0], ends[1], middle - np.pi)

    def curve(trace: Trace) -> tuple[Any, float]:
        return turned.curve(trace, np.pi), max(PRECISION_MM, trace.miss)

    near, far = (
        [curve(Trace.of(knots, control, middle)) for control, knots in link_border(teeth, column)]
        for column in (i, i + 1)
    )
    low, high = (
        curve(Trace.arc(arc.width, arc.rho, arc.z, _within_half_turn(arc.start - middle))) for arc in (toe, heel)
    )
    with_chain = toe.width * turned.axis * float(turned.generatrix @ (ends[1] - ends[0])) > 0.0
    return DrawnFace(
        teeth.links[i].region, rows, turned.surface, (low, *far, high, *reversed(near)), with_chain, teeth.outward
    )


def _within_half_turn(angle: float) -> float:
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _traces(teeth: SplineTooth, row: int) -> tuple[Trace, ...]:
    """Return the outline of all teeth at a bound in cylindrical coordinates, nothing for plane end faces."""
    if station_normal(teeth.tooth.blank.axial)[0] == 0.0:
        return ()
    angle, links = float(np.arctan2(*teeth.corners[0, row, 1::-1])), []
    for i, link in enumerate(teeth.links):
        if link in teeth.patches:
            links.append(Trace.of(teeth.patches[link][0].s_knots, _row(teeth, i, row), angle))
        else:
            arc = _Arc.of(teeth, i, row)
            links.append(Trace.arc(arc.width, arc.rho, arc.z, _within_half_turn(arc.start - angle)))
    return tuple(trace.turn(k * teeth.step) for k in range(teeth.count) for trace in links)


def _body(member: Member, outline: tuple[Loop, Loop], outward: bool) -> list[NamedFace]:
    """Return the faces of the body: end faces between outline and profile, and a face for each segment of the profile.

    The material is on the right of the profile in (rho, z) if `outward` (see `SplineTooth`), else on its left. It is inside the
    outline of an external gear, and outside the outline of an internal ring.
    """
    # a circle for each corner of the profile
    blank = member.tooth.blank
    profile, names = member.body.profile, member.body.bands
    across, up = station_normal(blank.axial)
    loops: list[Loop | None] = []
    for k, (rho, z) in enumerate(profile):
        # both loops of a cone or cylinder must begin on the same generatrix
        angle = outline[k > 0].angle if across != 0.0 and k in (0, len(profile) - 1) else 0.0
        loops.append(circle(rho, z, angle) if rho > 0.0 else None)
    # a keyway, hexagon or flat replaces the bore and its two circles by a prism
    faces, keyed = [], -1
    if member.bore_form is not None:
        keyed = names.index(Region.BORE)
        rho, levels = profile[keyed][0], (profile[keyed][1], profile[keyed + 1][1])
        drawn = member.bore_form.in_bore(rho)
        bore = Prism.of(drawn, levels)
        angle = float(np.arctan2(*drawn[0].start[::-1]))
        loops[keyed : keyed + 2] = [
            Loop(edges, start, rho, z, angle) for edges, start, z in zip(bore.edges, bore.starts, levels, strict=True)
        ]
        faces += _bore_faces(member.bore_form.region, drawn, bore)
    cuts = [(opening, Prism.of(opening.curves, (opening.low, opening.high))) for opening in member.openings]
    faces += opening_faces(cuts)

    def holes_in(z: float, inner: float, outer: float) -> list[Any]:
        """Return the wires of the openings in a plane face at z between two radii."""
        return [
            cut.wire_at(row)
            for opening, cut in cuts
            for row, level in enumerate((opening.low, opening.high))
            if level == z and level != opening.floor and inner <= opening.reach[0] and opening.reach[1] <= outer
        ]

    # faces of the profile: planes across the axis, cylinders and cones
    for k, name in enumerate(names):
        first, second = loops[k], loops[k + 1]
        (rho, z), (next_rho, next_z) = profile[k : k + 2]
        if k == keyed or (first is None and second is None):
            continue
        if z == next_z:
            outer, inner = (first, second) if rho > next_rho else (second, first)
            assert outer is not None
            holes = holes_in(z, min(rho, next_rho), max(rho, next_rho))
            shape = plane_face(outer, inner, (next_rho > rho) == outward, holes)
        elif first is None or second is None:
            raise DesignError(member.name, reason="the body ends in a point on its axis, which STEP cannot represent")
        else:
            shape = turned_face(first, second, (next_z < z) == outward)
        faces.append(NamedFace(shape, name, name))
    # end faces between the outline of the teeth and the profile
    for end, (loop, ring) in enumerate(zip(outline, (loops[0], loops[-1]), strict=True)):
        # the station's normal points out of the material at the heel
        if across != 0.0:
            assert ring is not None
            shape = turned_face(ring, loop, (across > 0.0) == (end == 1))
        else:
            outer, inner = (ring, loop) if ring is not None and ring.rho > loop.rho else (loop, ring)
            rho, z = profile[-end]
            holes = holes_in(z, 0.0, rho) if member.body.around else holes_in(z, rho, np.inf)
            # a shaft thicker than the teeth is a wall that looks the other way
            wall = outer is ring and not member.body.around
            shape = plane_face(outer, inner, ((up > 0.0) == (end == 1)) != wall, holes)
        region = end_regions(blank.axial)[end]
        faces.append(NamedFace(shape, region, region))
    return faces


def _bore_faces(region: Region, outline: ClosedLine, bore: Prism) -> list[NamedFace]:
    """Return the walls of a bore: its round parts, and the plane ones, which have a region of their own."""
    kinds = [Region.BORE if isinstance(curve, PlaneArc) else region for curve in outline]
    counts, faces = dict.fromkeys(kinds, 0), list[NamedFace]()
    for wall, kind in zip(bore.faces, kinds, strict=True):
        counts[kind] += 1
        single = kind is Region.BORE and kinds.count(kind) == 1
        faces.append(NamedFace(wall, kind if single else f"{kind}_{counts[kind]}", kind))
    return faces


def opening_faces(cuts: list[tuple[Opening, Prism]]) -> list[NamedFace]:
    """Return the walls and floors of all openings, numbered within their regions."""
    faces, counts = list[NamedFace](), dict[Region, int]()
    for opening, cut in cuts:
        counts[opening.region] = number = counts.get(opening.region, 0) + 1
        walls = list(cut.faces)
        if opening.floor is not None:
            row = int(opening.floor == opening.high)
            walls.append(cut.floor(row, opening.floor))
        names = [f"{opening.region}_{number}", *(f"{opening.region}_{number}_{k}" for k in range(2, len(walls) + 1))]
        faces += [NamedFace(wall, name, opening.region) for wall, name in zip(walls, names, strict=True)]
    return faces
