"""A member as a solid with named faces for CAD: the teeth's spline patches on a body of planes, cones and cylinders.

Vertices and edges are made once and the faces built on them, so the shell is closed by construction and nothing has to
be sewn. Columns are where links of the chain begin, counted on round all teeth; rows are toe, breaks and heel. Hub and
bore belong to the profile that is turned to the body.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from gearmesh.cad.brep import DEGREE, SplineTooth
from gearmesh.cad.occ import PRECISION, edge, face, spline_curve, spline_surface, vertex, wire
from gearmesh.cad.step import NamedFace, Part, require_occ
from gearmesh.cad.turned import Loop, Trace, circle, keyed_bore, plane_face, turned_face
from gearmesh.errors import DesignError
from gearmesh.kernel.algebra import Array
from gearmesh.kernel.levels import station_normal
from gearmesh.kernel.rigid import Rigid
from gearmesh.teeth.body import end_regions
from gearmesh.teeth.region import BODY_REGIONS, Region
from gearmesh.teeth.train import Member

#: places on an end curve at which its distance from its trace is measured
SAMPLES = 101
#: an edge's tolerance over the largest distance sampled: OpenCASCADE looks at other places
MARGIN = 2.0


def solid_part(member: Member, teeth: SplineTooth) -> Part:
    """The whole member, its faces named by region and, on the teeth, number of the tooth (1 is the tooth on +x).

    Raises DesignError where hub, bore and keyway do not make a valid solid, OutputError where OpenCASCADE is missing.
    """
    require_occ()
    from OCP.BRep import BRep_Builder
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid

    toothed, ends = _toothed(teeth)
    faces = (*toothed, *_body(member, ends))
    builder, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    builder.MakeShell(shell)
    for each in faces:
        builder.Add(shell, each.shape)
    shell.Closed(True)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    if not BRepCheck_Analyzer(solid).IsValid():
        raise DesignError(
            f"{member.name}: the faces do not make a valid solid; change bore, keyway or hub, or ask for a larger --tol"
        )
    return Part(member.name, solid, faces, (*teeth.tooth.regions, *BODY_REGIONS))


def volume(part: Part) -> float:
    """Volume of a part (mm^3), by OpenCASCADE."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(part.solid, properties)
    return float(properties.Mass())


def _toothed(teeth: SplineTooth) -> tuple[list[NamedFace], tuple[Loop, Loop]]:
    """The faces of all teeth, and the loops of their outline on toe and heel."""
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

    bounds, segments, links = teeth.bounds.tolist(), len(teeth.bounds) - 1, len(teeth.patches)
    count = teeth.tooth.teeth * links
    turns = []
    for k in range(teeth.tooth.teeth):
        turns.append(gp_Trsf())
        turns[k].SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), k * teeth.tooth.pitch_angle)
    rotations = Rigid.about_z(np.arange(teeth.tooth.teeth) * teeth.tooth.pitch_angle).rotation
    rows = [_rows(teeth, i) for i in range(links)]
    corners = [[vertex(rotations[n // links] @ r[0]) for r in rows[n % links]] for n in range(count)]
    across_curves = [
        [spline_curve(r, link[0].s_knots) for r in row] for link, row in zip(teeth.patches, rows, strict=True)
    ]
    along_curves = [[spline_curve(patch.control[0], patch.t_knots) for patch in link] for link in teeth.patches]
    across = [
        [
            edge(curve.Transformed(turns[n // links]), corners[n][g], corners[(n + 1) % count][g], 0.0, 1.0)
            for g, curve in enumerate(across_curves[n % links])
        ]
        for n in range(count)
    ]
    along = [
        [
            edge(curve.Transformed(turns[n // links]), corners[n][g], corners[n][g + 1], bounds[g], bounds[g + 1])
            for g, curve in enumerate(along_curves[n % links])
        ]
        for n in range(count)
    ]
    surfaces = [
        [spline_surface(patch.control, patch.s_knots, patch.t_knots) for patch in link] for link in teeth.patches
    ]
    faces = []
    for n in range(count):
        k, i = divmod(n, links)
        for g in range(segments):
            sides = (across[n][g], along[(n + 1) % count][g], across[n][g + 1], along[n][g])
            shape = _patch_face(surfaces[i][g].Transformed(turns[k]), sides, bounds[g], bounds[g + 1])
            region = teeth.patches[i][g].region
            faces.append(NamedFace(shape, f"{region}_{k + 1}", region))
    traces = [_traces(teeth, rows, end) for end in (0, -1)]
    ends = [
        Loop(
            tuple(each[end] for each in across),
            corners[0][end],
            float(np.hypot(*rows[0][end][0, :2])),
            float(rows[0][end][0, 2]),
            float(np.arctan2(*rows[0][end][0, 1::-1])),
            trace,
        )
        for end, trace in zip((0, -1), traces, strict=True)
    ]
    return faces, (ends[0], ends[1])


def _rows(teeth: SplineTooth, link: int) -> list[Array]:
    """Control polygons (S, 3) of a link's curves at toe, breaks and heel."""
    patches = teeth.patches[link]
    return [*(patch.control[:, 0] for patch in patches), patches[-1].control[:, -1]]


def _patch_face(surface: Any, sides: tuple[Any, Any, Any, Any], low: float, high: float) -> Any:
    """Face on the whole of a spline surface (s in [0, 1], t in [low, high]) with its sides at t = low, s = 1, t = high, s = 0."""
    from OCP.BRep import BRep_Builder
    from OCP.Geom2d import Geom2d_Line
    from OCP.gp import gp_Dir2d, gp_Pnt2d
    from OCP.TopLoc import TopLoc_Location

    builder, here = BRep_Builder(), TopLoc_Location()
    across, along = gp_Dir2d(1.0, 0.0), gp_Dir2d(0.0, 1.0)
    starts = ((0.0, low, across), (1.0, 0.0, along), (0.0, high, across), (0.0, 0.0, along))
    for side, (s, t, direction) in zip(sides, starts, strict=True):
        # curves have the surface's own parameters
        builder.UpdateEdge(side, Geom2d_Line(gp_Pnt2d(s, t), direction), surface, here, PRECISION)
    return face(surface, [wire(*zip(sides, (True, True, False, False), strict=True))], True)


def _traces(teeth: SplineTooth, rows: list[list[Array]], end: int) -> tuple[Trace, ...]:
    """The outline on toe (0) or heel (-1) in cylindrical coordinates, for all teeth."""
    links, angle = [], float(np.arctan2(*rows[0][end][0, 1::-1]))
    places = np.linspace(0.0, 1.0, SAMPLES)
    for patches, row in zip(teeth.patches, rows, strict=True):
        s, knots = patches[0].s, patches[0].s_knots
        inside = BSpline(knots, row[end], DEGREE)
        x, y, z = np.moveaxis(inside(s), -1, 0)
        polar = (np.arctan2(y, x) - angle + np.pi) % (2.0 * np.pi) - np.pi
        spline = make_interp_spline(s, np.stack((polar, np.hypot(x, y), z), axis=-1), k=DEGREE)
        polar, rho, z = np.moveaxis(spline(places), -1, 0)
        drawn = np.stack((rho * np.cos(angle + polar), rho * np.sin(angle + polar), z), axis=-1)
        links.append((knots, spline.c, MARGIN * float(np.linalg.norm(drawn - inside(places), axis=-1).max())))
    turns = np.arange(teeth.tooth.teeth) * teeth.tooth.pitch_angle
    return tuple(
        Trace(knots, control + np.array([turn, 0.0, 0.0]), miss) for turn in turns for knots, control, miss in links
    )


def _body(member: Member, outline: tuple[Loop, Loop]) -> list[NamedFace]:
    """The faces under the teeth: end faces from the outline down, and one for each step of the profile."""
    blank = member.tooth.blank
    profile, names = _profile(member)
    turned = station_normal(blank.axial)[0] != 0.0
    loops: list[Loop | None] = []
    for k, (rho, z) in enumerate(profile):
        # the two loops of a cone or cylinder begin on one generatrix
        angle = outline[k > 0].angle if turned and k in (0, len(profile) - 1) else 0.0
        loops.append(circle(rho, z, angle) if rho > 0.0 else None)
    faces, keyed = [], -1
    if member.keyway is not None:
        keyed = names.index(Region.BORE)
        pair, walls = keyed_bore(blank.body.bore_radius, (profile[keyed][1], profile[keyed + 1][1]), member.keyway)
        loops[keyed : keyed + 2] = pair
        faces += [NamedFace(walls[0], "bore", "bore")]
        faces += [NamedFace(wall, f"keyway_{i + 1}", "keyway") for i, wall in enumerate(walls[1:])]
    for k, name in enumerate(names):
        first, second = loops[k], loops[k + 1]
        (rho, z), (next_rho, next_z) = profile[k : k + 2]
        if k == keyed or (first is None and second is None):
            continue
        if z == next_z:
            outer, inner = (first, second) if rho > next_rho else (second, first)
            assert outer is not None
            shape = plane_face(outer, inner, next_rho > rho)
        elif first is None or second is None:
            raise DesignError(f"{member.name}: a body that comes to a point on its axis cannot be written as STEP")
        else:
            shape = turned_face(first, second, next_z < z)
        faces.append(NamedFace(shape, name, name))
    for end, (loop, ring) in enumerate(zip(outline, (loops[0], loops[-1]), strict=True)):
        if turned:
            assert ring is not None
            shape = turned_face(ring, loop, end == 1)
        else:
            shape = plane_face(loop, ring, end == 1)
        region = end_regions(blank.axial)[end]
        faces.append(NamedFace(shape, region, region))
    return faces


def _profile(member: Member) -> tuple[list[tuple[float, float]], list[Region]]:
    """The body's profile (rho, z) with the hub, from the toe's end face to the heel's, and the region of each step."""
    blank = member.tooth.blank
    body = blank.body
    points, names = [(float(rho), float(z)) for rho, z in body.profile], list(body.bands)
    if member.hub is not None:
        bore, high, last = body.bore_radius, body.ends[1], body.bore_band + 1
        radius, top = 0.5 * member.hub.diameter, high + member.hub.length
        points[last : last + 1] = [(bore, top), (radius, top), (radius, high)]
        names[last:last] = [Region.HUB, Region.HUB]
    return points, names
