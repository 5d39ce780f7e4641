"""Second fundamental forms of the links of a tooth, L ds^2 + 2 M ds dt + N dt^2, sampled over s and t."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.grid import significant
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Grid, Link, Sections, parameter
from gearmesh.teeth.tooth import Tooth

#: samples of the second forms of a link over s, and over t if the tooth is smooth along the face
SAMPLE_COUNTS = (25, 9)
#: least number of cells between samples over t on a smooth stretch of the face, as the run-out of a thread
CELLS_PER_STRETCH = 4
#: largest number of samples over t
MAX_STATION_COUNT = 65
#: step of t in differences of the ends of links; the ends are known to 1e-11
STATION_STEP = 1e-4
#: significant bits of the forms: plans do not depend on last digits, which differ between processors
FORM_BITS = 16
#: share of a link's largest form below which a form is rounding
FORM_ROUNDING_SHARE = 2.0**-20
#: area of the largest triangle within eps of a surface, over eps / sqrt(|k1 k2|), for k1 k2 > 0
BOWL_AREA_FACTOR = 1.5 * 3.0**0.5
#: the same for k1 k2 < 0
SADDLE_AREA_FACTOR = 2.0 * 5.0**0.5
#: share of its length below which the width of a link is 0, as the fillet of a sharp root corner: turning of its lines is rounding
LINE_WIDTH_SHARE = 1e-9


@dataclass(frozen=True)
class Forms:
    """Second forms of R links at S uniform samples of s and T of t."""

    #: L (R, S, T), mm, along s
    length: Array
    #: M (R, S, T), mm
    twist: Array
    #: N (R, S, T), mm, along t
    face: Array
    #: second derivatives (R, 2, S), mm, by s of the section curves at toe and heel, in space
    outline: Array
    #: second parameters (R, S, T) of the surfaces; 0 for drawn links
    second: Array
    #: turning (R, S, T) of lines of constant s within the surface, as second derivatives of s by t
    sideways: Array

    @staticmethod
    def of(tooth: Tooth, regions: tuple[Region, ...]) -> Forms:
        """Return the forms of links of a tooth. Raises TrimError if the tooth cannot be trimmed."""
        s, t = (np.linspace(0.0, 1.0, samples) for samples in (SAMPLE_COUNTS[0], _station_count(tooth)))
        around = np.clip(t[:, None] + np.array([-STATION_STEP, 0.0, STATION_STEP]), 0.0, 1.0)
        sections = tooth.sections(around.ravel())
        grids = [tooth.grid(region, s, sections[1::3]) for region in regions]
        second_forms = [
            _second_form(tooth, tooth.chain[region], grid, s, around, sections)
            for region, grid in zip(regions, grids, strict=True)
        ]
        length, twist, face = np.moveaxis(np.array(second_forms), 1, 0)
        curves = np.stack([grid.points[:, [0, -1]] for grid in grids])
        second = np.stack([np.zeros((s.size, t.size)) if grid.v is None else grid.v for grid in grids])
        sideways = np.stack([_sideways(grid.points, s[1], t[1]) for grid in grids])
        length, twist, face, outline, sideways = (
            _without_last_digits(form) for form in (length, twist, face, _outline(curves, s), sideways)
        )
        return Forms(length, twist, face, outline, second, sideways)

    def seam_cells(self, tolerance: float, *, whole: bool) -> Array:
        """Return the least numbers of edges (R + 1,) of the seams before, between and after the links.

        The edges are within the tolerance, mm, of the surfaces on both sides of a seam. If `whole`, the links are a whole
        tooth: the last link ends at the first link of the next tooth.
        """
        first, last = np.abs(self.face[:, 0]), np.abs(self.face[:, -1])
        after = np.concatenate((first, last[-1:]))
        before = np.concatenate((last[-1:] if whole else first[:1], last[:-1], first[:1] if whole else last[-1:]))
        density = np.sqrt(np.maximum(after, before) / (8.0 * tolerance))
        cells: Array = np.maximum(
            1.0, np.ceil(np.trapezoid(density, dx=1.0 / (self.face.shape[-1] - 1), axis=-1) - 0.05)
        )
        return cells

    def fewest(self, link: int, tolerance: float, on_seams: int) -> float:
        """Return the least number of triangles of a link within a tolerance, mm.

        The integral of sqrt(|k1 k2|) dA is one lower bound. The edges of the border are another one: a triangle has one of
        them, or two at a corner of the link. `on_seams`: number of edges on the seams.
        """
        bent = self.length[link] * self.face[link] - self.twist[link] ** 2
        density = np.sqrt(np.abs(bent)) / np.where(bent > 0.0, BOWL_AREA_FACTOR, SADDLE_AREA_FACTOR) / tolerance
        s, t = (np.linspace(0.0, 1.0, samples) for samples in bent.shape)
        outline = np.ceil(np.trapezoid(np.sqrt(self.outline[link] / (8.0 * tolerance)), s, axis=-1)).sum()
        return float(max(np.trapezoid(np.trapezoid(density, t), s), on_seams + outline - 2.0))


def _station_count(tooth: Tooth) -> int:
    """Return the number of samples over t: enough for the shortest stretch of the face on which the tooth is smooth."""
    shortest, count = float(np.diff(tooth.smooth_stretches).min()), SAMPLE_COUNTS[1]
    while (count - 1) * shortest < CELLS_PER_STRETCH and count < MAX_STATION_COUNT:
        count = 2 * count - 1
    return count


def _without_last_digits(forms: Array) -> Array:
    """Return forms (R, ..., ...) of links rounded to the bits that plans use."""
    return np.stack([significant(form, FORM_BITS, FORM_ROUNDING_SHARE * float(np.abs(form).max())) for form in forms])


def _second_form(
    tooth: Tooth, link: Link, grid: Grid, s: Array, around: Array, sections: Sections
) -> tuple[Array, Array, Array]:
    """Return L, M, N (S, T) of a link.

    - grid: grid of the link at s (S,) and t (T,).
    - around: stations (T, 3) before, at and after each t, for differences.
    - sections: sections at all these stations.

    n . r_xy = -r_x . n_y, with s and t for x and y. Along s the axial station is constant, along t it grows evenly.
    """
    if grid.jet is None:
        return _differences(grid, s, around[:, 1])
    jet = grid.jet
    # derivatives of the first parameter by s and t
    p, rate = parameter(s[:, None], link.span(sections), link.seams)
    p = p.reshape(s.size, -1, 3)
    p_s, p_t = rate[..., 1::3], (p[..., 2] - p[..., 0]) / (around[:, 2] - around[:, 0])
    # derivatives of the second parameter, from the condition on the axial station
    gradient = tooth.blank.axial.gradient(jet.r)
    along_u, along_v = dot(gradient, jet.r_u), dot(gradient, jet.r_v)
    toe, heel = tooth.blank.extent
    v_s, v_t = -along_u * p_s / along_v, (heel - toe - along_u * p_t) / along_v
    r_s, r_t = (jet.r_u * p_x[..., None] + jet.r_v * v_x[..., None] for p_x, v_x in ((p_s, v_s), (p_t, v_t)))
    n_s, n_t = (jet.n_u * p_x[..., None] + jet.n_v * v_x[..., None] for p_x, v_x in ((p_s, v_s), (p_t, v_t)))
    return -dot(r_s, n_s), -0.5 * (dot(r_s, n_t) + dot(r_t, n_s)), -dot(r_t, n_t)


def _differences(grid: Grid, s: Array, t: Array) -> tuple[Array, Array, Array]:
    """Return L, M, N (S, T) of a drawn link, by differences of its grid."""
    points, normals, ds, dt = grid.points, grid.normals, s[1], t[1]
    length, face, twist = (np.zeros(points.shape[:2]) for _ in range(3))
    length[1:-1] = dot(normals[1:-1], np.diff(points, 2, axis=0)) / ds**2
    face[:, 1:-1] = dot(normals[:, 1:-1], np.diff(points, 2, axis=1)) / dt**2
    corners = points[2:, 2:] - points[2:, :-2] - points[:-2, 2:] + points[:-2, :-2]
    twist[1:-1, 1:-1] = dot(normals[1:-1, 1:-1], corners) / (4.0 * ds * dt)
    for form in (length, face, twist):
        form[0], form[-1] = form[1], form[-2]
        form[:, 0], form[:, -1] = form[:, 1], form[:, -2]
    return length, twist, face


def _sideways(points: Array, ds: float, dt: float) -> Array:
    """Return the turning (S, T) of lines of constant s within the surface: second derivatives of s by t along straight chords.

    It comes from differences of the points (S, T, 3) of a grid with steps ds and dt.
    """
    bent = np.pad(np.diff(points, 2, axis=1) / dt**2, ((0, 0), (1, 1), (0, 0)), mode="edge")
    r_s, r_t = _rates(points, ds), _rates(points.swapaxes(0, 1), dt).swapaxes(0, 1)
    size = dot(r_t, r_t)
    across = r_s - np.divide(dot(r_s, r_t), size, out=np.zeros_like(size), where=size > 0.0)[..., None] * r_t
    width = dot(across, across)
    wide = width > LINE_WIDTH_SHARE**2 * size
    turning: Array = np.divide(np.abs(dot(bent, across)), width, out=np.zeros_like(width), where=wide)
    return turning


def _rates(points: Array, step: float) -> Array:
    """Return the derivatives (S, T, 3) along the first axis, the same as np.gradient in a fifth of its time."""
    rates = np.empty_like(points)
    rates[1:-1] = (points[2:] - points[:-2]) / (2.0 * step)
    rates[0], rates[-1] = (points[1] - points[0]) / step, (points[-1] - points[-2]) / step
    return rates


def _outline(curves: Array, s: Array) -> Array:
    """Return the second derivatives (R, 2, S) by s, square to the curve, of section curves (R, S, 2, 3) at toe and heel."""
    along = curves[:, 2:] - curves[:, :-2]
    bent = np.diff(curves, 2, axis=1) / s[1] ** 2
    length = dot(along, along)
    share = np.divide(dot(bent, along), length, out=np.zeros_like(length), where=length > 0.0)
    across = bent - share[..., None] * along
    return np.pad(np.sqrt(dot(across, across)).swapaxes(1, 2), ((0, 0), (0, 0), (1, 1)), mode="edge")
