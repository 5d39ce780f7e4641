"""Figures of many assemblies from their paths of contact alone, in one batch: milliseconds per assembly.

Lengths and heights are on the pinion's flank, measured from its middle (`teeth.flank_frame`). Shares of the pattern are
those of `contact.pattern`. The transmission error of the gears is an estimate. It is the largest advance of all tooth
pairs at equally spaced phases of a pitch, from cubics through the positions and their slopes. The contact ratio is
estimated by extrapolating the distance to the edges. The mesh cycle has the exact values, with each change of pairs
solved as a root.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.assemblies import AssemblyPaths
from gearmesh.contact.pattern import ellipse_ends
from gearmesh.figures import Figures, figure
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.records import dataclass
from gearmesh.teeth.flank_frame import FlankFrame

#: phases of a pitch at which the advance of the gears is computed
PHASES_PER_PITCH = 96
#: difference of advances, rad, that is only rounding: below it two tooth pairs are level
LEVEL_ADVANCE_RAD = 1e-12


@dataclass(frozen=True)
class PathFigures(Figures):
    """The paths of contact of one tooth pair in many assemblies, from the middle of the pinion's flank."""

    converged: Array = figure("positions at which the tooth pair touches", whole=True)
    surface_positions: Array = figure("positions with contact inside both flanks", whole=True)
    edge_positions: Array = figure("positions at which the tooth pair has edge contact", whole=True)
    contact_ratio_estimate: Array = figure("estimate of the contact ratio of the flank surfaces", symbol="eps")
    surface_te_peak_to_peak: Array = figure(
        "transmission error of a tooth pair in surface contact, peak to peak", "arcsec"
    )
    mesh_te_estimate: Array = figure("estimate of the transmission error of the gears, peak to peak", "arcsec")
    max_residual: Array = figure("largest distance between the two flanks at a point of contact", "mm")
    contact_length: Array = figure("mean place of the contact along the flank", "mm")
    contact_height: Array = figure("mean place of the contact across the flank", "mm")
    pattern_length_min: Array = figure("end of the contact pattern along the flank, towards the toe", "mm")
    pattern_length_max: Array = figure("end of the contact pattern along the flank, towards the heel", "mm")
    pattern_height_min: Array = figure("end of the contact pattern across the flank, towards the root", "mm")
    pattern_height_max: Array = figure("end of the contact pattern across the flank, towards the tip", "mm")
    pattern_centre_face: Array = figure("centre of the contact pattern along the face, from the toe", "%")
    pattern_centre_height: Array = figure(
        "centre of the contact pattern along the working height, from the root limit", "%"
    )
    pattern_length: Array = figure("length of the contact pattern, in parts of the face", "%")
    pattern_width: Array = figure("width of the contact pattern, in parts of the working height", "%")


@dataclass(frozen=True)
class PathShift(Figures):
    """Shift of the contact from its place in the unchanged design, and of the pattern from the nominal assembly."""

    length: Array | float = figure(
        "shift of the contact along the flank, from the unchanged design", "mm", key="path_shift_length_mm"
    )
    height: Array | float = figure(
        "shift of the contact across the flank, from the unchanged design", "mm", key="path_shift_height_mm"
    )
    pattern_face: Array | float = figure(
        "shift of the centre of the contact pattern along the face, towards the heel, from the nominal assembly "
        "(all errors of assembly 0)",
        "%",
        key="pattern_shift_face_percent",
    )
    pattern_height: Array | float = figure(
        "shift of the centre of the contact pattern along the working height, towards the tip, from the nominal "
        "assembly (all errors of assembly 0)",
        "%",
        key="pattern_shift_height_percent",
    )


def path_figures(paths: AssemblyPaths, frame: FlankFrame, pitch: float) -> PathFigures:
    """Return the figures (M,) of M assemblies; NaN where there is no value."""
    with np.errstate(all="ignore"):
        inside = paths.surface & ~paths.line
        places = frame.places(paths.point)
        centre = _means(places, inside)
        low, high = pattern_box(paths, frame, places)
        least, most = ellipse_ends(frame, paths.point, paths.axes, inside)
        middle, size = 50.0 * (least + most), 100.0 * (most - least)
        return PathFigures(
            converged=paths.touching.sum(axis=1).astype(float),
            surface_positions=paths.surface.sum(axis=1).astype(float),
            edge_positions=(paths.touching & ~paths.surface & carries(paths, pitch)).sum(axis=1).astype(float),
            contact_ratio_estimate=surface_length(paths) / pitch,
            surface_te_peak_to_peak=_ptp(np.where(paths.surface, paths.advance, np.nan)) / ARCSEC,
            mesh_te_estimate=_ptp(gears_advance(paths, pitch), whole=True) / ARCSEC,
            max_residual=_most(paths.residual),
            contact_length=centre[:, 0],
            contact_height=centre[:, 1],
            pattern_length_min=low[:, 0],
            pattern_length_max=high[:, 0],
            pattern_height_min=low[:, 1],
            pattern_height_max=high[:, 1],
            pattern_centre_face=middle[:, 0],
            pattern_centre_height=middle[:, 1],
            pattern_length=size[:, 0],
            pattern_width=size[:, 1],
        )


def pattern_box(paths: AssemblyPaths, frame: FlankFrame, places: Array) -> tuple[Array, Array]:
    """Return smallest and largest length and height (M, 2) of the contact ellipses inside both flanks.

    The ellipses are clipped to the flank.
    """
    half = np.linalg.norm(frame.directions(paths.point[:, :, None], paths.axes), axis=2)
    inside = (paths.surface & ~paths.line)[..., None] & np.isfinite(half)
    low, high = frame.extent
    least = np.where(inside, np.clip(places - half, low, high), np.inf).min(axis=1)
    most = np.where(inside, np.clip(places + half, low, high), -np.inf).max(axis=1)
    none = ~inside.any(axis=1)
    return np.where(none, np.nan, least), np.where(none, np.nan, most)


def surface_length(paths: AssemblyPaths) -> Array:
    """Return the range of phi1 (M,), rad, over which the surface contact about the middle of its positions lasts.

    Beyond its last positions the distance to an edge is extrapolated to zero along its last slope. NaN without surface
    contact, if it lasts beyond the positions, and along lines of contact, which end in another way.
    """
    count, surface = len(paths.phi1), paths.surface
    step = float(np.diff(paths.phi1).mean()) if count > 1 else np.nan
    # nothing is known beyond the first and last of all positions
    known = surface.any(axis=1) & ~surface[:, 0] & ~surface[:, -1] & ~paths.line.any(axis=1)
    first, last = surface.argmax(axis=1), count - 1 - surface[:, ::-1].argmax(axis=1)
    assemblies = np.arange(len(surface))
    steps = (last - first).astype(float)
    for end, before in ((first, np.minimum(first + 1, count - 1)), (last, np.maximum(last - 1, 0))):
        edge_distance, distance_before = paths.inside[assemblies, end], paths.inside[assemblies, before]
        run = np.where(distance_before > edge_distance, edge_distance / (distance_before - edge_distance), np.inf).min(
            axis=1, initial=np.inf
        )
        steps += np.clip(np.where(np.isfinite(run), run, 0.5), 0.0, 1.0)
    return np.asarray(np.where(known, step * steps, np.nan))


def gears_advance(paths: AssemblyPaths, pitch: float) -> Array:
    """Return the advance (M, PHASES_PER_PITCH), rad, of the gears at equally spaced phases of a pitch.

    NaN at phases near which no position has contact. NaN for all phases of an assembly whose tooth pair is still in
    contact at the first or last position: contact beyond them is not known.
    """
    phi1 = paths.phi1
    if len(phi1) < 2 or phi1[-1] - phi1[0] < pitch:
        return np.full((len(paths.advance), PHASES_PER_PITCH), np.nan)
    phase = np.linspace(0.0, pitch, PHASES_PER_PITCH, endpoint=False)
    first, last = (int(np.floor(end / pitch)) for end in (phi1[0], phi1[-1]))
    # the gears follow the tooth pair that is farthest ahead; pair k at a phase is pair 0 k pitches later
    best = np.full((len(paths.advance), PHASES_PER_PITCH), -np.inf)
    for k in range(first, last + 1):
        rotation = phase + k * pitch
        known_phases = np.flatnonzero((rotation >= phi1[0]) & (rotation <= phi1[-1]))
        if known_phases.size:
            best[:, known_phases] = np.fmax(best[:, known_phases], _advance_at(paths, rotation[known_phases]))
    # at the first and last position the neighbouring pair should be ahead: if it is not, contact continues beyond them
    neighbour_advance = _advance_at(paths, np.array([phi1[0] + pitch, phi1[-1] - pitch]))
    open_end = np.any(paths.advance[:, [0, -1]] > neighbour_advance + LEVEL_ADVANCE_RAD, axis=1, keepdims=True)
    return np.where(np.isfinite(best) & ~open_end, best, np.nan)


def carries(paths: AssemblyPaths, pitch: float) -> NDArray[np.bool_]:
    """Return positions (M, P) at which the pair is ahead of both neighbouring pairs, as far as the positions show."""
    phi1 = paths.phi1
    ahead = np.ones(paths.advance.shape, dtype=bool)
    for at in (phi1 - pitch, phi1 + pitch) if len(phi1) > 1 else ():
        known_positions = np.flatnonzero((at >= phi1[0]) & (at <= phi1[-1]))
        ahead[:, known_positions] &= ~(paths.advance[:, known_positions] < _advance_at(paths, at[known_positions]))
    return ahead


def _advance_at(paths: AssemblyPaths, at: Array) -> Array:
    """Return the advance (M, N), rad, at rotations `at` (N,), from values and slopes at the positions.

    The advance is a cubic between two positions, straight where a slope is not known. Where contact moves from the
    flanks to an edge the cubic may rise above its tangent on the flanks, which the advance of a pair never does: there
    the advance is that tangent, and a parabola from the place where the edge takes over.
    """
    phi1, value, slope = paths.phi1, paths.advance, paths.slope
    k = np.clip(np.searchsorted(phi1, at, "right") - 1, 0, len(phi1) - 2)
    h = phi1[k + 1] - phi1[k]
    t = (at - phi1[k]) / h
    first, last = value[:, k], value[:, k + 1]
    chord = last - first
    begin, end = (np.where(np.isnan(slope[:, j]), chord, h * slope[:, j]) for j in (k, k + 1))
    cubic: Array = first + t * chord + t * (1.0 - t) * ((1.0 - t) * (begin - chord) - t * (end - chord))
    # from the end on the flanks on, with the slopes in this direction
    forward = paths.surface[:, k]
    start, way = np.where(forward, first, last), np.where(forward, t, 1.0 - t)
    flank_slope, edge_slope = np.where(forward, begin, -end), np.where(forward, end, -begin)
    below, steeper = np.where(forward, chord, -chord) - flank_slope, edge_slope - flank_slope
    # the parabola is as long as its fall over half of its change of slope; a cubic is convex if it is shorter than 2/3
    length = np.divide(2.0 * below, steeper, out=np.zeros_like(steeper), where=steeper < 0.0)
    to_edge = (paths.surface[:, k] != paths.surface[:, k + 1]) & (length > 0.0) & (length < 2.0 / 3.0)
    past = np.maximum(way - 1.0 + length, 0.0)
    return np.where(to_edge, start + flank_slope * way + below * (past / np.where(to_edge, length, 1.0)) ** 2, cubic)


def _means(places: Array, inside: NDArray[np.bool_]) -> Array:
    """Return the means (M, 2) of the places (M, P, 2) that are inside."""
    count = inside.sum(axis=1)[:, None]
    return np.asarray(np.where(inside[..., None], places, 0.0).sum(axis=1) / np.where(count, count, np.nan))


def _ptp(values: Array, *, whole: bool = False) -> Array:
    """Return the range (largest less smallest) of the known values (M, N); NaN if `whole` and a value is not known."""
    known = np.isfinite(values)
    none = ~known.any(axis=1) | (whole & ~known.all(axis=1))
    spread = np.where(known, values, -np.inf).max(axis=1) - np.where(known, values, np.inf).min(axis=1)
    return np.where(none, np.nan, spread)


def _most(values: Array) -> Array:
    known = np.isfinite(values)
    return np.where(known.any(axis=1), np.where(known, values, -np.inf).max(axis=1), np.nan)
