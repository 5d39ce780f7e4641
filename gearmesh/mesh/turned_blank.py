"""Meshes of blanks: rings of vertices round the axis for turned blanks, a block for the bar of a rack."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneLine
from gearmesh.mesh.body import band_triangles, ring_counts
from gearmesh.mesh.deviation.bound import DeviationBound
from gearmesh.mesh.deviation.revolution import facet_distances
from gearmesh.mesh.labelled import labelled_mesh
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.region import BAR_REGIONS, Region
from gearmesh.teeth.turned_blank import BLANK_REGIONS, BarBlank, BlankBand, TurnedBlank

#: number of points on a ring, or a multiple of it
RING_SIDES = 8
#: share of the tolerance for the chords of rings; the rest is for the chords of curved bands
RING_SHARE = 0.5
#: largest number of halvings of a curved band
MAX_HALVINGS = 16
#: places between neighbouring points of a curved band at which its distance from the chord is measured
PLACES_PER_CHORD = 4


def blank_mesh(blank: TurnedBlank | BarBlank, tolerance: float) -> tuple[TriangleMesh, DeviationBound]:
    """Return the closed mesh of a blank within a tolerance (mm), and the bound of its distance from the exact blank."""
    return _block(blank) if isinstance(blank, BarBlank) else _turned(blank, tolerance)


def _block(blank: BarBlank) -> tuple[TriangleMesh, DeviationBound]:
    """Return the mesh of a bar, which is exact."""
    names = (*BAR_REGIONS, Region.LAND, *((Region.GAP,) if len(set(blank.tops)) > 1 else ()))
    corners = np.concatenate([ring[[0, k, k + 1]] for _, ring in blank.faces for k in range(1, len(ring) - 1)])
    regions = [names.index(region) for region, ring in blank.faces for _ in ring[2:]]
    vertices, triangles = np.unique(corners, axis=0, return_inverse=True)
    made = triangles.reshape(-1, 3).astype(np.int64), np.array(regions, dtype=np.int32)
    return labelled_mesh(vertices, *made, names, np.zeros((0, 3)), f"{blank.name}_blank"), DeviationBound()


def _turned(blank: TurnedBlank, tolerance: float) -> tuple[TriangleMesh, DeviationBound]:
    """Return the mesh of a turned blank."""
    curved = any(not isinstance(band.curve, PlaneLine) for band in blank.bands)
    rows = [_points(band, (1.0 - RING_SHARE) * tolerance) for band in blank.bands]
    chord = max(miss for _, miss in rows)
    regions = [band.region for band, (points, _) in zip(blank.bands, rows, strict=True) for _ in points[1:]]
    ring = [(float(rho), float(z)) for points, _ in rows for z, rho in points[:-1]]
    # three times round: the rings of the second round are beside all that the bands join to them
    counts = ring_counts(RING_SIDES, ring * 3, RING_SHARE * tolerance if curved else tolerance)[len(ring) : -len(ring)]
    firsts = np.concatenate(([0], np.cumsum(counts)))
    vertices = []
    for (rho, z), count in zip(ring, counts, strict=True):
        angle = 2.0 * np.pi * np.arange(count) / count
        vertices.append(np.column_stack((rho * np.cos(angle), rho * np.sin(angle), np.full(count, z))))
    faces, labels = [], list[int]()
    for k, region in enumerate(regions):
        after = (k + 1) % len(counts)
        if counts[k] > 1 or counts[after] > 1:
            # the section is counterclockwise over (z, rho): outside is on its right
            face = band_triangles(int(firsts[k]), counts[k], int(firsts[after]), counts[after])
            faces.append(face)
            labels += [BLANK_REGIONS.index(region)] * len(face)
    points, triangles = np.concatenate(vertices), np.concatenate(faces)
    mesh = labelled_mesh(
        points, triangles, np.array(labels, dtype=np.int32), BLANK_REGIONS, np.zeros((0, 3)), f"{blank.name}_blank"
    )
    largest = chord + float(facet_distances(points[triangles]).max())
    return mesh, DeviationBound(largest, largest)


def _points(band: BlankBand, tolerance: float) -> tuple[Array, float]:
    """Return points (K, 2) on a band over (z, rho) with chords within a tolerance (mm), and their largest distance."""
    if isinstance(band.curve, PlaneLine):
        return np.array([band.curve.start, band.curve.end]), 0.0
    for halvings in range(MAX_HALVINGS):
        number = 2**halvings
        points = band.curve.at(np.linspace(0.0, 1.0, number * PLACES_PER_CHORD + 1))
        nodes = points[::PLACES_PER_CHORD]
        along = np.diff(nodes, axis=0)
        along /= np.linalg.norm(along, axis=-1, keepdims=True)
        away = points[:-1].reshape(number, PLACES_PER_CHORD, 2) - nodes[:-1, None]
        miss = float(np.abs(along[:, None, 0] * away[..., 1] - along[:, None, 1] * away[..., 0]).max())
        if miss <= tolerance:
            break
    return nodes, miss
