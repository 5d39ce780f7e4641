r"""Whole racks: the teeth of a sliding member in a row, closed by the bar under them.

                    ____        ____
        B    ______/    \______/    \______  A      toe and heel: planes across z
        a   |                              | b      ends: along the tooth traces, in the middle of a root land
        r   |______________________________| a
                          back               r

The halves of a double helical rack are mirror images; its ends then bend where the halves meet, or run straight through the gap.

A bar is as many pitches long as it has teeth: bars laid end to end continue each other. With an overhang the root lands,
and the chamfers along toe and heel, go on beyond the last pitch.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.body import triangulate
from gearmesh.mesh.ends.end_mesh import EndMesh
from gearmesh.mesh.halves import WeldedHalves
from gearmesh.mesh.tessellate import ToothMesh
from gearmesh.mesh.triangles import with_area
from gearmesh.records import dataclass
from gearmesh.teeth.blank.halves import HalfEnd, Rows, row_stations
from gearmesh.teeth.gear_train import Member
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
    #: triangle (N,) of the single tooth, of all rows one after the other, for each of the first N triangles
    of_tooth: Index


@dataclass(frozen=True)
class BarFloors:
    """Faces of the bar beside and under its teeth: ends, back, and the floor of a gap between two rows."""

    #: their vertices (V, 3), mm, which follow those of teeth and roots
    vertices: Array
    #: triangles (M, 3) by region
    faces: list[tuple[Region, Index]]
    #: vertices (2,) under each end face, at the first and the last end of the bar
    under_end: dict[HalfEnd, Index]

    @staticmethod
    def under(back: float, rows: Rows, sides: tuple[list[Index], list[Index]], vertices: Array) -> BarFloors:
        """Return the faces under root lines at the two ends of the bar.

        - back: height x of the back, mm.
        - rows: rows of teeth.
        - sides: lines (N,) from toe to heel of every row, at the first and the last end of the bar.
        - vertices: (V, 3), mm, of teeth and roots.
        """
        stations = row_stations(rows)
        station_of = {end: k for k, ends in enumerate(stations) for end in ends}
        tops = np.array([[side[half][-end] for (half, end), *_ in stations] for side in sides])
        levels = [back, *(gap.floor for gap in rows.gaps)]
        corners = [vertices[tops.ravel()], *(vertices[tops[:, 1:-1].ravel()] for _ in rows.gaps)]
        for points, level in zip(corners, levels, strict=True):
            points[:, 0] = level
        first, last = len(vertices) + np.arange(tops.size).reshape(2, -1)
        faces, under_end = list[tuple[Region, Index]](), dict[HalfEnd, Index]()
        for end, k in ((rows.outer[0], 0), (rows.outer[1], -1)):
            under_end[end] = np.array([first[k], last[k]])
        grooves = len(vertices) + tops.size + np.arange(4).reshape(2, 2)
        for gap in rows.gaps:
            for end, pair in zip(gap.ends[::-1], grooves.T, strict=True):
                under_end[end] = pair
        for n, (side, bottom) in enumerate(zip(sides, (first, last), strict=True)):
            sense = -1 if n else 1
            for k, half in enumerate(rows.halves):
                # each row has its own plane, from its toe to its heel
                near, far = station_of[k, 0], station_of[k, 1]
                groove = [grooves[n, k]] if rows.gaps else []
                line = np.concatenate((side[k], groove, [bottom[far]])).astype(np.int64)
                faces.append((Region.END, _fan(bottom[near], line)[:, :: sense * half.hand_sign]))
            if rows.gaps:
                line = np.array([*grooves[n], bottom[2]])
                faces.append((Region.END, _fan(bottom[1], line)[:, ::sense]))
        for k in range(len(stations) - 1):
            a, b, c, d = first[k], first[k + 1], last[k + 1], last[k]
            faces.append((Region.BACK, np.array([[a, b, c], [a, c, d]])))
        for _ in rows.gaps:
            (a, b), (d, c) = grooves
            faces.append((Region.GAP, np.array([[a, c, b], [a, d, c]])))
        return BarFloors(np.concatenate(corners), faces, under_end)


def row_mesh(tooth_mesh: ToothMesh, member: Member) -> RowMesh:
    """Return the closed surface of a rack; the tooth of `tooth_mesh` is in the middle, or next to it."""
    tooth, strips, rows, halves = tooth_mesh.tooth, tooth_mesh.end_meshes(), member.rows, member.halves
    single = tooth_mesh.weld()
    welded, size = WeldedHalves.of(single, halves), len(single.triangles)
    count, teeth = len(welded.vertices), tooth.teeth
    # one more tooth than there are: its first line ends the last tooth
    places = tooth.joint.places(teeth)
    ways = tooth.joint.to(np.append(places, places[-1] + 1) * tooth.pitch_angle).translation
    vertices = (welded.vertices + ways[:, None]).reshape(-1, 3)
    first_numbers = count * np.arange(teeth)[:, None, None]
    # the bar begins and ends in the middle of a root: the first tooth has no root of its own here
    root = len(tooth_mesh.patches[0].triangles)
    of_root = np.arange(size) < root
    begin = sum(len(patch.triangles) for patch in tooth_mesh.patches)
    for strip in strips.values():
        of_root[begin : begin + strip.pieces[0]] = True
        begin += len(strip.triangles)
    of_root = np.tile(of_root, len(halves))
    of_tooth = np.concatenate((np.flatnonzero(~of_root), np.tile(np.arange(len(of_root)), teeth - 1)))
    place = np.repeat(np.arange(teeth), [int((~of_root).sum()), *[len(of_root)] * (teeth - 1)])
    triangles = welded.triangles[of_tooth] + count * place[:, None]
    # lines from toe to heel of each half: beginning of the first root, end of the last root, and the ends of the bar
    firsts = [number[single.firsts[1]] for number in welded.numbers]
    lasts = [number[single.firsts[0]] + teeth * count for number in welded.numbers]
    ends, added = list[list[Index]](), len(vertices)
    for n, lines in enumerate((firsts, lasts)):
        numbers = list[Index]()
        for half, line in zip(halves, lines, strict=True):
            points = half.points(vertices[line])
            points[:, 1] = member.bar_ends(points[:, 2])[n]
            fresh = added + np.arange(len(line))
            for end in half.shared:
                fresh[-end] = numbers[0][-end]
            numbers.append(fresh)
            vertices, added = np.concatenate((vertices, half.points(points))), added + len(line)
        ends.append(numbers)
    lows, highs = ends
    faces = list[tuple[Region, Index]]()
    for half, *lines in zip(halves, lows, firsts, lasts, highs, strict=True):
        for near, far in (lines[:2], lines[2:]):
            faces += [(region, face[:, :: half.hand_sign]) for region, face in _half_root(near, far, strips)]
    floors = BarFloors.under(tooth.blank.body.profile[0][0], rows, (lows, highs), vertices)
    vertices = np.concatenate((vertices, floors.vertices))
    for row_end, upper in rows_ends(rows):
        number, which = row_end
        row = welded.end(row_end)
        low, first, last, high = (int(lines[number][-which]) for lines in (lows, firsts, lasts, highs))
        # the outline begins where the first root ends
        chain = (row + first_numbers[:, 0]).ravel()[int(np.flatnonzero(row == first)[0]) :]
        outline = np.concatenate(([low], chain, [last, high], floors.under_end[row_end][::-1]))
        face = outline[triangulate(vertices[outline, :2])]
        faces.append((Region.FACE_HEEL, face) if upper else (Region.FACE_TOE, face[:, ::-1]))
    faces += floors.faces
    tooth_regions = [patch.region for patch in tooth_mesh.patches for _ in patch.triangles]
    tooth_regions += [region for region, strip in strips.items() for _ in strip.triangles]
    regions = [tooth_regions[k % size] for k in of_tooth.tolist()] + [region for region, face in faces for _ in face]
    triangles = np.concatenate((triangles, *(face for _, face in faces)))
    triangles, kept = with_area(vertices, triangles)
    of_tooth, regions = of_tooth[kept[kept < len(of_tooth)]], [regions[k] for k in kept.tolist()]
    used, compact = np.unique(triangles, return_inverse=True)
    return RowMesh(vertices[used], compact.reshape(-1, 3), tuple(regions), of_tooth)


def rows_ends(rows: Rows) -> list[tuple[HalfEnd, bool]]:
    """Return the ends of all rows that have an end face, and True where the face looks along +z."""
    pairs = (rows.outer, *(gap.ends for gap in rows.gaps))
    return [(end, upper == 1) for pair in pairs for upper, end in enumerate(pair)]


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
