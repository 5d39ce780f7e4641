"""The space between two teeth as a closed solid: the sides of both teeth, root, tip surface, and end faces at toe and heel.

Links share the vertices of their seams, and end faces share the vertices of the links: the surface is closed by
construction. End faces are triangulated in a chart, as those of the body under the teeth.
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
    """Return the mesh of a space's links in two parts: from the root to the tip surface, and the left side of the tooth before.

    The left side is in the frame of its own tooth.
    """
    first = tooth_mesh.tooth.regions.index(Region.TIP_SURFACE) + 1
    patches = tooth_mesh.patches
    return replace(tooth_mesh, patches=patches[:first]), replace(tooth_mesh, patches=patches[first:])


def space_mesh(tooth_mesh: ToothMesh, name: str) -> TriangleMesh:
    """Return the closed mesh of a `Space` from the mesh of its links; normals point out of the space, into the teeth."""
    space, (here, before) = tooth_mesh.tooth, (part.weld() for part in parts(tooth_mesh))
    back, count = space.joint.to(-space.pitch_angle), len(here.vertices)
    ours = len(here.triangles)
    # the last line of each part is the first line of the other
    left = np.empty(len(before.vertices), dtype=np.int64)
    line, last = len(before.firsts[0]), len(here.firsts[0])
    left[before.firsts[0]] = np.arange(count - line, count)
    left[-last:] = here.firsts[0]
    unshared = np.ones(len(left), dtype=bool)
    unshared[before.firsts[0]] = unshared[-last:] = False
    left[unshared] = count + np.arange(unshared.sum())
    vertices = np.concatenate((here.vertices, back.point(before.vertices[unshared])))
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
    """Return the triangles of the face inside a closed chain of points (C, 3) on a station, and further points (m, 3).

    The triangles have the sense of the chain.
    """
    across, up = station_normal(level)
    rho = np.hypot(chain[:, 0], chain[:, 1])
    # direction of the generatrix in (rho, z); radii of the chart are counted from the mean radius
    out, middle = np.array([up, -across]), float(rho.mean())

    def lift(q: Array) -> Array:
        """Return points (N, 3) on the station for points (N, 2) of the chart."""
        radius = np.hypot(q[:, 0], q[:, 1])
        way, scale = radius - middle, 1.0 / radius
        return np.column_stack((q * ((rho[0] + out[0] * way) * scale)[:, None], chain[0, 2] + out[1] * way))

    if across == 0.0:
        q = chain[:, :2].copy()
    else:
        radius = middle + out[0] * (rho - rho[0]) + out[1] * (chain[:, 2] - chain[0, 2])
        q = chain[:, :2] * (radius / rho)[:, None]
    x, y = q.T
    # a clockwise chain is seen from the other side
    seen = 1.0 if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0.0 else -1.0
    triangles = triangulate(q * np.array([1.0, seen]))
    if across == 0.0:
        return triangles, np.empty((0, 3))
    triangles, points = split_long(triangles, (q, chain), level, lift, tolerance)
    return triangles, points[len(chain) :]
