"""The space between two teeth as a closed solid: both sides of the teeth, root, tip surface, and the end faces at toe and heel.

Links have the vertices of their seams in common, end faces those of the links: the surface is closed by construction. End
faces are triangulated in a chart that develops the generatrices of their station, as those of the body under the teeth.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.mesh.body import Index, split_long, triangulate
from gearmesh.mesh.labelled import labelled_mesh
from gearmesh.mesh.tessellate import ToothMesh
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.blank.body import end_regions
from gearmesh.teeth.region import Region


def parts(tooth_mesh: ToothMesh) -> tuple[ToothMesh, ToothMesh]:
    """The mesh of a space's links as two: from the root to the tip surface, and the left side, of the tooth before, as it is on
    its own tooth."""
    first = tooth_mesh.tooth.regions.index(Region.TIP_SURFACE) + 1
    patches = tooth_mesh.patches
    return replace(tooth_mesh, patches=patches[:first]), replace(tooth_mesh, patches=patches[first:])


def space_mesh(tooth_mesh: ToothMesh, name: str) -> TriangleMesh:
    """The closed mesh of a `Space`, of the mesh of its links; normals point out of it, into the teeth."""
    space, (here, before) = tooth_mesh.tooth, (part.weld() for part in parts(tooth_mesh))
    back, count = space.joint.to(-space.pitch_angle), len(here.vertices)
    ours = len(here.triangles)
    # the last line of either part is the first one of the other
    left = np.empty(len(before.vertices), dtype=np.int64)
    line, last = len(before.firsts[0]), len(here.firsts[0])
    left[before.firsts[0]] = np.arange(count - line, count)
    left[-last:] = here.firsts[0]
    own = np.ones(len(left), dtype=bool)
    own[before.firsts[0]] = own[-last:] = False
    left[own] = count + np.arange(own.sum())
    vertices = np.concatenate((here.vertices, back.point(before.vertices[own])))
    normals = np.concatenate([patch.normals for patch in tooth_mesh.patches])
    normals[ours:] = back.vector(normals[ours:])
    triangles = [np.concatenate((here.triangles, left[before.triangles]))[:, ::-1]]
    for end, rows in enumerate(((here.toe, before.toe), (here.heel, before.heel))):
        row = np.concatenate((rows[0], left[rows[1]]))
        face, added = _end_face(vertices[row], space.blank.axial, tooth_mesh.tolerance)
        face = np.concatenate((row, len(vertices) + np.arange(len(added))))[face]
        vertices = np.concatenate((vertices, added))
        triangles.append(face[:, ::-1] if end else face)
    sizes = [*(len(patch.triangles) for patch in tooth_mesh.patches), *(len(face) for face in triangles[1:])]
    regions = np.repeat(np.arange(len(sizes), dtype=np.int32), sizes)
    names = (*space.regions, *end_regions(space.blank.axial))
    return labelled_mesh(vertices, np.concatenate(triangles), regions, names, -normals, name)


def _end_face(chain: Array, level: Level, tolerance: float) -> tuple[Index, Array]:
    """Triangles of the face inside a closed chain of points (C, 3) on a station, and further points (m, 3).

    They go round as the chain does.
    """
    across, up = station_normal(level)
    rho = np.hypot(chain[:, 0], chain[:, 1])
    # along the generatrix, in (rho, z), from the first point; radii of the chart are those of its middle
    out, middle = np.array([up, -across]), float(rho.mean())

    def lift(q: Array) -> Array:
        radius = np.hypot(q[:, 0], q[:, 1])
        way, scale = radius - middle, 1.0 / radius
        return np.column_stack((q * ((rho[0] + out[0] * way) * scale)[:, None], chain[0, 2] + out[1] * way))

    if across == 0.0:
        q = chain[:, :2].copy()
    else:
        radius = middle + out[0] * (rho - rho[0]) + out[1] * (chain[:, 2] - chain[0, 2])
        q = chain[:, :2] * (radius / rho)[:, None]
    x, y = q.T
    # a chain that goes round clockwise is seen from the other side
    seen = 1.0 if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0.0 else -1.0
    triangles = triangulate(q * np.array([1.0, seen]))
    if across == 0.0:
        return triangles, np.empty((0, 3))
    triangles, points = split_long(triangles, (q, chain), level, lift, tolerance)
    return triangles, points[len(chain) :]
