r"""Whole racks: the teeth of a sliding member in a row, closed by the bar under them.

                    ____        ____
        B    ______/    \______/    \______  A      toe and heel: planes across z
        a   |                              | b      ends: along the tooth traces, in the middle of a root land
        r   |______________________________| a
                          back               r

A bar is as many pitches long as it has teeth: bars laid end to end continue each other. With an overhang the root lands,
and the chamfers along toe and heel, go on beyond the last pitch.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.body import triangulate
from gearmesh.mesh.ends.end_mesh import EndMesh
from gearmesh.mesh.tessellate import ToothMesh
from gearmesh.mesh.triangles import with_area
from gearmesh.teeth.region import Region

Index = NDArray[np.int64]


@dataclass(frozen=True)
class RowMesh:
    """Mesh of a whole rack."""

    #: (V, 3), mm
    vertices: Array
    #: (M, 3)
    triangles: Index
    #: region of each triangle
    regions: tuple[Region, ...]
    #: triangle (N,) of the single tooth for each of the first N triangles
    of_tooth: Index


def row_mesh(tooth_mesh: ToothMesh, overhang: float = 0.0) -> RowMesh:
    """Return the closed surface of all teeth and the bar; the tooth of `tooth_mesh` is in the middle, or next to it.

    `overhang`: length, mm, of the bar beyond the last pitch, at either end.
    """
    tooth, welded, strips = tooth_mesh.tooth, tooth_mesh.weld(), tooth_mesh.end_meshes()
    count, teeth = len(welded.vertices), tooth.teeth
    # one more tooth than there are: its first line ends the last tooth
    places = tooth.joint.places(teeth)
    ways = tooth.joint.to(np.append(places, places[-1] + 1) * tooth.pitch_angle).translation
    vertices = (welded.vertices + ways[:, None]).reshape(-1, 3)
    first_numbers = count * np.arange(teeth)[:, None, None]
    # the bar begins and ends in the middle of a root: the first tooth has no root of its own here
    root = len(tooth_mesh.patches[0].triangles)
    of_root = np.arange(len(welded.triangles)) < root
    begin = sum(len(patch.triangles) for patch in tooth_mesh.patches)
    for strip in strips.values():
        of_root[begin : begin + strip.pieces[0]] = True
        begin += len(strip.triangles)
    of_tooth = np.concatenate((np.flatnonzero(~of_root), np.tile(np.arange(len(of_root)), teeth - 1)))
    place = np.repeat(np.arange(teeth), [int((~of_root).sum()), *[len(of_root)] * (teeth - 1)])
    triangles = welded.triangles[of_tooth] + count * place[:, None]
    first, last = welded.firsts[1], welded.firsts[0] + teeth * count
    low, high = len(vertices) + np.arange(len(first)), len(vertices) + len(first) + np.arange(len(last))
    corners, (toe, heel) = len(vertices) + len(first) + len(last) + np.arange(4), (0, -1)
    ends = [vertices[line] for line in (first, last)]
    for end, way, beyond in zip(ends, ways[[0, -1]], (-overhang, overhang), strict=True):
        end[:, 1] = tooth.root_middle(end[:, 2]) + way[1] + beyond
    back = np.stack([end[k] for end in ends for k in (toe, heel)])
    back[:, 0] = tooth.blank.body.profile[0][0]
    vertices = np.concatenate((vertices, *ends, back))
    faces = list[tuple[Region, Index]]()
    for near, far in ((low, first), (last, high)):
        faces += _half_root(near, far, strips)
    for k, row in enumerate((welded.toe, welded.heel)):
        # the outline begins where the first root ends
        chain = (row + first_numbers[:, 0]).ravel()[int(np.flatnonzero(row == first[-k])[0]) :]
        outline = np.concatenate((low[[-k]], chain, last[[-k]], high[[-k]], corners[[2 + k, k]]))
        face = outline[triangulate(vertices[outline, :2])]
        faces.append((Region.FACE_HEEL, face) if k else (Region.FACE_TOE, face[:, ::-1]))
    faces += [
        (Region.END, _fan(corners[0], np.append(low, corners[1]))),
        (Region.END, _fan(corners[2], np.append(high, corners[3]))[:, ::-1]),
        (Region.BACK, corners[np.array([[0, 1, 3], [0, 3, 2]])]),
    ]
    tooth_regions = [patch.region for patch in tooth_mesh.patches for _ in patch.triangles]
    tooth_regions += [region for region, strip in strips.items() for _ in strip.triangles]
    regions = [tooth_regions[k] for k in of_tooth.tolist()] + [region for region, face in faces for _ in face]
    triangles = np.concatenate((triangles, *(face for _, face in faces)))
    triangles, kept = with_area(vertices, triangles)
    of_tooth, regions = of_tooth[kept[kept < len(of_tooth)]], [regions[k] for k in kept.tolist()]
    used, compact = np.unique(triangles, return_inverse=True)
    return RowMesh(vertices[used], compact.reshape(-1, 3), tuple(regions), of_tooth)


def _half_root(low: Index, high: Index, strips: Mapping[Region, EndMesh]) -> list[tuple[Region, Index]]:
    """Return the triangles of half a root between two lines (N,) from toe to heel, by region; `strips`: meshes of the chamfers."""
    rows = {region: strip.rows for region, strip in strips.items()}
    toe, heel = (rows.get(region, 0) for region in (Region.EDGE_TOE, Region.EDGE_HEEL))
    cuts = [0, toe, len(low) - 1 - heel, len(low) - 1]
    return [
        (region, _strip(low[first : last + 1], high[first : last + 1]))
        for region, (first, last) in zip((Region.EDGE_TOE, Region.ROOT, Region.EDGE_HEEL), pairwise(cuts), strict=True)
    ]


def _strip(low: Index, high: Index) -> Index:
    """Return the triangles between two lines (N,) from toe to heel, counterclockwise seen from the tips."""
    quads = [((a, b, d), (a, d, c)) for (a, c), (b, d) in zip(pairwise(low), pairwise(high), strict=True)]
    return np.array(quads, dtype=np.int64).reshape(-1, 3)


def _fan(corner: int, line: Index) -> Index:
    """Return the triangles between a corner and a line (N,) that does not contain it."""
    return np.stack((np.full(len(line) - 1, corner), line[:-1], line[1:]), axis=1)
