r"""Sectors: some pitches of a gear as a closed solid with two congruent cut faces, for cyclic symmetry.

The cut surface goes through the middles of the roots. On each station surface (a plane, cone or cylinder about the axis) it
is the generatrix at the polar angle theta of the root's middle, from the axis outwards. Beyond the teeth theta stays constant.
The cut therefore follows helical and spiral teeth, through rim, web and hub. The mesh of the whole gear is cut along this
surface, and along the same surface turned by the pitches; the sector lies between. The second cut face is the first one
turned, node by node; only its outline comes from the second cut. All other facets are those of the gear: the sectors of a
whole gear have its volume to rounding.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import ArgumentError, DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.mesh.solid import facets_of, manifold_of
from gearmesh.mesh.triangles import TriangleMesh, closeness, facet_normals, without_doubles
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import CUT_REGIONS, Region
from gearmesh.teeth.section import Sections
from gearmesh.teeth.tooth import Tooth

Index = NDArray[np.int64]

#: angle of the cut beside the middles of the roots: nodes of the mesh may lie there, and rounding would decide on their side
CUT_OFFSET_RAD = 1e-9
#: largest angle between neighbouring generatrices of the cut surface
MAX_TWIST_RAD = 0.1
#: the same limit in pitches
MAX_TWIST_PITCHES = 1.0 / 16.0
#: distances of the outermost rows from the tooth's ends, in cells: no row coincides with a station of the mesh
END_CELL_SHARES = (0.013, 0.029)
#: largest turn of the middles of a straight tooth's roots, which is rounding
STRAIGHT_TURN_RAD = 1e-12
#: height above the root, as a share of the tooth's height, at which the rows of the cut surface are joined, too
JOINED_HEIGHT_SHARE = 0.1
#: margin of the cut surface beyond the gear, as a share of the largest radius
MARGIN_SHARE = 0.1
#: largest angle between edges of the wedge's outer wall
MAX_WALL_STEP_RAD = 0.2


@dataclass(frozen=True)
class CutSurface:
    """Cut surface before tooth 0, straight between its stations."""

    #: axial station of points
    level: Level
    #: station coordinates (N,), rising
    stations: Array
    #: polar angles (N,), rad
    theta: Array
    #: rho (N,), mm, a little above the root; z if the stations are cylinders
    above: Array

    @staticmethod
    def of(member: Member) -> CutSurface:
        """Return the surface through the middles of the root before tooth 0, for all rows of teeth."""
        tooth, level = member.tooth, member.tooth.blank.axial
        turning = np.abs(np.diff(_middles(tooth, tooth.even)[1]))
        # rows are close enough that the surface between them is hardly twisted
        most = min(MAX_TWIST_RAD, MAX_TWIST_PITCHES * tooth.pitch_angle)
        rows = int(np.ceil(turning.sum() / most)) + 1 if turning.max() > STRAIGHT_TURN_RAD else 1
        low, high = (share / rows for share in END_CELL_SHARES)
        root, theta, above = _middles(tooth, tooth.sections(np.linspace(low, 1.0 - high, rows + 1)))
        places = np.concatenate([level.value(half.points(root)) for half in member.halves])
        order = np.argsort(places)
        theta, above = (np.tile(values, len(member.halves))[order] for values in (theta, above))
        return CutSurface(level, places[order], theta, above)

    def rows(self, mesh: TriangleMesh) -> Array:
        """Return a grid (M, 3, 3), mm, whose rows are generatrices of the surface, beyond the outline of a mesh on all sides.

        The first point of each row is on the axis; if stations are cylinders, the first row is. The second point is above the
        root.
        """
        (across, up), base = station_normal(self.level), float(self.level.value(np.zeros(3)))
        rho, z = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1]), mesh.vertices[:, 2]
        margin = MARGIN_SHARE * float(rho.max())
        outer = float(rho.max()) + margin
        if up == 0.0:
            ends, sides = base + across * np.array([0.0, outer]), (z.min() - margin, z.max() + margin)
        else:
            value = across * rho + up * z + base
            ends, sides = np.array([value.min() - margin, value.max() + margin]), (0.0, outer)
        stations = np.sort(np.concatenate((ends, self.stations)))
        angle, above = (
            np.interp(stations, self.stations, values) for values in (self.theta + CUT_OFFSET_RAD, self.above)
        )
        grid = np.stack((np.full_like(above, sides[0]), above, np.full_like(above, sides[1])), axis=1)
        rest = (stations - base)[:, None] * np.ones(3)
        rhos, zs = (rest / across, grid) if up == 0.0 else (grid, (rest - across * grid) / up)
        return np.stack((rhos * np.cos(angle)[:, None], rhos * np.sin(angle)[:, None], zs), axis=-1)


def _middles(tooth: Tooth, sections: Sections) -> tuple[Array, Array, Array]:
    """Return the middles (T, 3), mm, of the root before tooth 0, their polar angles (T,), rad, and `CutSurface.above` (T,)."""
    half, place = np.array([0.5]), 0 if station_normal(tooth.blank.axial)[1] else 1
    root, land = (tooth.grid(region, half, sections).points[0] for region in (Region.ROOT, Region.LAND))
    low, high = (np.stack((np.hypot(r[:, 0], r[:, 1]), r[:, 2]))[place] for r in (root, land))
    return root, tooth.joint.running(tooth.joint.angle(root)), low + JOINED_HEIGHT_SHARE * (high - low)


def _check_pitches(member: Member, pitches: int) -> None:
    """Raise DesignError if a member has no sector of `pitches` pitches."""
    if np.isinf(member.tooth.joint.cycle(member.tooth.teeth)):
        raise ArgumentError("sector", pitches, must_be=f"left out for the {member.name}, which does not turn")
    most = member.tooth.teeth - 1
    if most < 1:
        raise ArgumentError("sector", pitches, must_be=f"left out for the {member.name}, which has one tooth")
    if not 1 <= pitches <= most:
        raise ArgumentError(
            "sector", pitches, must_be=f"a whole number from 1 to {most}; without it the {member.name} is whole"
        )
    member.check_alike()


def cyclic(member: Member, pitches: int) -> tuple[Member, tuple[str, ...]]:
    """Return the member without features that do not repeat after `pitches` pitches, and a warning for each of these.

    Raises DesignError if there is no such sector.
    """
    _check_pitches(member, pitches)
    warnings = []
    features = member.features
    form = features.bore_form
    if form is not None and form.symmetry * pitches % member.tooth.teeth:
        features = features.with_round_bore
        repeats = "" if form.symmetry == 1 else f" after {pitches} of {member.tooth.teeth} pitches"
        warnings.append(f"the sector of the {member.name} has no {form.name}, which does not repeat{repeats}")
    for pattern in features.patterns:
        if pattern.count * pitches % member.tooth.teeth:
            words = {Region.HOLE: "holes", Region.BOLT: "bolt holes", Region.SPOKE: "openings between spokes"}
            warnings.append(
                f"the sector of the {member.name} has none of the {pattern.count} {words[pattern.region]}, which do not repeat "
                f"after {pitches} of {member.tooth.teeth} pitches"
            )
            features = features.without(pattern)
    if features != member.features:
        member = replace(member, features=features)
    return member, tuple(warnings)


def sector(whole: TriangleMesh, member: Member, pitches: int) -> TriangleMesh:
    """Return the first `pitches` pitches of a member, cut from its whole mesh.

    The faces cut_right, before tooth 0, and cut_left close it. Raises DesignError if the mesh does not repeat after the
    pitches.
    """
    import manifold3d

    angle = pitches * member.tooth.pitch_angle
    turn = Rigid.about_z(angle)
    gear_id, right, left, wall = (manifold3d.Manifold.reserve_ids(4) + k for k in range(4))
    gear = manifold_of(whole.vertices, {gear_id: whole.triangles})
    cut, sides = _wedge(CutSurface.of(member).rows(whole), angle)
    wedge = manifold_of(cut, dict(zip((right, left, wall), sides, strict=True)))
    vertices, triangles, origin, face = facets_of(gear ^ wedge)
    on_cut = distinct(triangles[np.isin(origin, (right, left))])
    vertices = _snap(vertices, on_cut, whole.vertices)
    triangles, kept = without_doubles(vertices, triangles, on_cut)
    origin, source = origin[kept], face[kept]
    first, surface = triangles[origin == right], origin == gear_id
    partners = _partners(vertices, first, triangles[origin == left], turn)
    if partners is None:
        raise DesignError(
            member.name, reason=f"its body does not repeat after {pitches} of {member.tooth.teeth} pitches"
        )
    # the second face is the first one turned; the nodes of its outline exist already
    vertices[partners[:, 1]] = turn.point(vertices[partners[:, 0]])
    inner = np.setdiff1d(first, partners[:, 0])
    numbers = np.arange(len(vertices))
    numbers[partners[:, 0]], numbers[inner] = partners[:, 1], len(vertices) + np.arange(len(inner))
    vertices = np.concatenate((vertices, turn.point(vertices[inner])))
    used, compact = np.unique(np.concatenate((triangles[surface], first, numbers[first][:, ::-1])), return_inverse=True)
    vertices, compact = vertices[used], compact.reshape(-1, 3)
    kept_regions, names = whole.regions[source[surface]], len(whole.region_names)
    return replace(
        whole,
        vertices=vertices,
        triangles=compact,
        regions=np.concatenate((kept_regions, np.repeat(names + np.arange(2), len(first)))).astype(np.int32),
        region_names=(*whole.region_names, *CUT_REGIONS),
        normals=np.concatenate((whole.normals[source[surface]], facet_normals(vertices, compact[len(kept_regions) :]))),
    )


def genus_of(mesh: TriangleMesh, member: Member, pitches: int) -> int:
    """Return the genus of a sector, by the holes of the member and the number of pieces of a cut face."""
    cut = mesh.only(Region.CUT_RIGHT).triangles
    edges = np.unique(np.sort(cut[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    pieces = int(cut.max()) + 1 - len(edges) + len(cut)
    holes = (member.genus - member.plain_body.genus) * pitches // member.tooth.teeth
    return 1 + holes - pieces


def _wedge(rows: Array, angle: float) -> tuple[Array, tuple[Index, Index, Index]]:
    """Return the solid between a grid (M, N, 3) and the same grid turned about z: vertices (V, 3) and triangles of three sides.

    The sides are the grid, the turned grid, and the surface that the border of the grid sweeps, in steps.
    """
    count, steps = rows.shape[0] * rows.shape[1], int(np.ceil(angle / MAX_WALL_STEP_RAD))
    points = rows.reshape(-1, 3)
    vertices = Rigid.about_z(angle * np.arange(steps + 1) / steps).rotation[:, None] @ points[..., None]
    # points on the axis stay where they are
    fixed = np.flatnonzero(np.hypot(points[:, 0], points[:, 1]) == 0.0)
    numbers = np.arange((steps + 1) * count).reshape(steps + 1, count)
    numbers[:, fixed] = fixed
    places = np.arange(count).reshape(rows.shape[:2])
    corners = np.stack((places[:-1, :-1], places[:-1, 1:], places[1:, 1:], places[1:, :-1]), axis=-1).reshape(-1, 4)
    grid = np.concatenate((corners[:, :3], corners[:, [0, 2, 3]]))
    border = np.concatenate((places[0], places[1:, -1], places[-1, -2::-1], places[-2:0:-1, 0]))
    along = np.stack((border, np.roll(border, -1)), axis=1)
    quads = np.concatenate((numbers[:-1, along], numbers[1:, along[:, ::-1]]), axis=2).reshape(-1, 4)
    wall = np.concatenate((quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]))
    sides = [numbers[0][grid][:, ::-1], numbers[-1][grid], wall]
    sides = [side[(side != np.roll(side, 1, axis=1)).all(axis=1)] for side in sides]
    vertices = vertices.reshape(-1, 3)
    a, b, c = np.moveaxis(vertices[np.concatenate(sides)], 1, 0)
    if np.einsum("ij,ij->", a, np.cross(b, c)) < 0.0:
        sides = [side[:, ::-1] for side in sides]
    return vertices, (sides[0], sides[1], sides[2])


def _snap(vertices: Array, cut: Index, nodes: Array) -> Array:
    """Return vertices (V, 3) with those of the `cut` that are close to `nodes` of the gear moved onto these."""
    from scipy.spatial import cKDTree

    distance, nearest = cKDTree(nodes).query(vertices[cut], distance_upper_bound=closeness(nodes))
    close, snapped = np.isfinite(distance), vertices.copy()
    snapped[cut[close]] = nodes[nearest[close]]
    return snapped


def _outline(triangles: Index) -> Index:
    """Return the edges (E, 2) that belong to one triangle only, each with its smaller node first."""
    ends, counts = np.unique(
        np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0, return_counts=True
    )
    return np.asarray(ends[counts == 1])


def _partners(vertices: Array, first: Index, last: Index, turn: Rigid) -> Index | None:
    """Return pairs (N, 2) of a node on the outline of the first cut face and its image on the last one; None if they differ."""
    from scipy.spatial import cKDTree

    near, far = _outline(first), _outline(last)
    nodes, there = distinct(near), distinct(far)
    distance, nearest = cKDTree(vertices[there]).query(turn.point(vertices[nodes]))
    if (
        len(nodes) != len(there)
        or distance.max(initial=0.0) > closeness(vertices)
        or distinct(nearest).size < len(there)
    ):
        return None
    turned = np.sort(there[nearest][np.searchsorted(nodes, near)], axis=1)
    if not np.array_equal(np.unique(turned, axis=0), far):
        return None
    return np.stack((nodes, there[nearest]), axis=1)
