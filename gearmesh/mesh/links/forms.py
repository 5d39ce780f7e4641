"""The second forms of the links of a tooth: L ds^2 + 2 M ds dt + N dt^2, sampled over s and t."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.grid import significant
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Grid, Link, Sections, parameter
from gearmesh.teeth.tooth import Tooth

#: points per link on which second forms are sampled, across and along
SAMPLES = (25, 9)
#: step of t over which the ends of the links are differentiated: ends are known to 1e-11, which of which 1e-6 showed too much
STEP = 1e-4
#: bits of forms, and the share of the largest of a link below which one is rounding: what is planned by them does not hang on last
#: digits, which differ between processors
BITS, LEAST_SHARE = 16, 2.0**-20
#: a triangle within eps of a surface covers at most so many times eps over sqrt(|k1 k2|): where k1 k2 > 0, and where < 0
BOWL, SADDLE = 1.5 * 3.0**0.5, 2.0 * 5.0**0.5
#: a link narrower than this part of its length is a line, as the fillet of a sharp root corner: what its lines turn by is rounding
NO_WIDTH = 1e-9


@dataclass(frozen=True)
class Forms:
    """Second forms of links (R, S, T), mm, on uniform samples of s and t.

    `sideways` (R, S, T): how fast lines of constant s turn within the surface, as second derivatives of s by t.
    `outline` (R, 2, S): as `length`, of the section curves at toe and heel in space. `second` (R, S, T): the second
    parameters of the surfaces there, 0 of links that are drawn.
    """

    length: Array
    twist: Array
    face: Array
    outline: Array
    second: Array
    sideways: Array

    @staticmethod
    def of(tooth: Tooth, regions: tuple[Region, ...]) -> Forms:
        """Raises TrimError where the tooth cannot be trimmed."""
        s, t = (np.linspace(0.0, 1.0, samples) for samples in SAMPLES)
        around = np.clip(t[:, None] + np.array([-STEP, 0.0, STEP]), 0.0, 1.0)
        sections = tooth.sections(around.ravel())
        grids = [tooth.grid(region, s, sections[1::3]) for region in regions]
        second_forms = [
            _second_form(tooth, tooth.chain[region], grid, s, around, sections)
            for region, grid in zip(regions, grids, strict=True)
        ]
        length, twist, face = np.moveaxis(np.array(second_forms), 1, 0)
        curves = np.stack([grid.points[:, [0, -1]] for grid in grids])
        second = np.stack([np.zeros(SAMPLES) if grid.v is None else grid.v for grid in grids])
        sideways = np.stack([_sideways(grid.points, s[1], t[1]) for grid in grids])
        length, twist, face, outline, sideways = (
            _without_last_digits(form) for form in (length, twist, face, _outline(curves, s), sideways)
        )
        return Forms(length, twist, face, outline, second, sideways)

    def seam_cells(self, tolerance: float, *, whole: bool) -> Array:
        """Fewest edges (R + 1,) of the seams before and after links within a tolerance, mm, of the surfaces on both sides of them;
        `whole`: the last link of a tooth ends where the next tooth begins."""
        first, last = np.abs(self.face[:, 0]), np.abs(self.face[:, -1])
        own = np.concatenate((first, last[-1:]))
        other = np.concatenate((last[-1:] if whole else first[:1], last[:-1], first[:1] if whole else last[-1:]))
        density = np.sqrt(np.maximum(own, other) / (8.0 * tolerance))
        cells: Array = np.maximum(1.0, np.ceil(np.trapezoid(density, dx=1.0 / (SAMPLES[1] - 1), axis=-1) - 0.05))
        return cells

    def fewest(self, link: int, tolerance: float, on_seams: int) -> float:
        """Fewest triangles of a link within a tolerance, mm: by the integral of sqrt(|k1 k2|) dA, or by the edges of its
        border, so many of them on its seams, of which a triangle has one, but for two at corners.
        """
        bent = self.length[link] * self.face[link] - self.twist[link] ** 2
        density = np.sqrt(np.abs(bent)) / np.where(bent > 0.0, BOWL, SADDLE) / tolerance
        s, t = (np.linspace(0.0, 1.0, samples) for samples in SAMPLES)
        outline = np.ceil(np.trapezoid(np.sqrt(self.outline[link] / (8.0 * tolerance)), s, axis=-1)).sum()
        return float(max(np.trapezoid(np.trapezoid(density, t), s), on_seams + outline - 2.0))


def _without_last_digits(forms: Array) -> Array:
    """Forms (R, ..., ...) of links with as many digits as planning needs."""
    return np.stack([significant(form, BITS, LEAST_SHARE * float(np.abs(form).max())) for form in forms])


def _second_form(
    tooth: Tooth, link: Link, grid: Grid, s: Array, around: Array, sections: Sections
) -> tuple[Array, Array, Array]:
    """L, M, N (S, T) by s and t, of sections before, at and after every station, `around` (T, 3), and the grid at s
    and t.

    n . r_xy = -r_x . n_y, where x and y are s and t: along s the station stays, along t it grows evenly.
    """
    if grid.jet is None:
        return _differences(grid, s, around[:, 1])
    jet = grid.jet
    p, rate = parameter(s[:, None], link.span(sections), link.seams)
    p = p.reshape(s.size, -1, 3)
    p_s, p_t = rate[..., 1::3], (p[..., 2] - p[..., 0]) / (around[:, 2] - around[:, 0])
    gradient = tooth.blank.axial.gradient(jet.r)
    along_u, along_v = dot(gradient, jet.r_u), dot(gradient, jet.r_v)
    toe, heel = tooth.blank.extent
    v_s, v_t = -along_u * p_s / along_v, (heel - toe - along_u * p_t) / along_v
    r_s, r_t = (jet.r_u * p_x[..., None] + jet.r_v * v_x[..., None] for p_x, v_x in ((p_s, v_s), (p_t, v_t)))
    n_s, n_t = (jet.n_u * p_x[..., None] + jet.n_v * v_x[..., None] for p_x, v_x in ((p_s, v_s), (p_t, v_t)))
    return -dot(r_s, n_s), -0.5 * (dot(r_s, n_t) + dot(r_t, n_s)), -dot(r_t, n_t)


def _differences(grid: Grid, s: Array, t: Array) -> tuple[Array, Array, Array]:
    """As `_second_form`, of a link that is drawn."""
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
    """How fast lines of constant s turn within the surface (S, T): second derivatives of s by t along straight chords.

    By differences of the points (S, T, 3) of a grid.
    """
    bent = np.pad(np.diff(points, 2, axis=1) / dt**2, ((0, 0), (1, 1), (0, 0)), mode="edge")
    r_s, r_t = _rates(points, ds), _rates(points.swapaxes(0, 1), dt).swapaxes(0, 1)
    size = dot(r_t, r_t)
    across = r_s - np.divide(dot(r_s, r_t), size, out=np.zeros_like(size), where=size > 0.0)[..., None] * r_t
    width = dot(across, across)
    wide = width > NO_WIDTH**2 * size
    turning: Array = np.divide(np.abs(dot(bent, across)), width, out=np.zeros_like(width), where=wide)
    return turning


def _rates(points: Array, step: float) -> Array:
    """Derivatives (S, T, 3) along the first axis of points so many steps apart: as np.gradient, in a fifth of its calls."""
    rates = np.empty_like(points)
    rates[1:-1] = (points[2:] - points[:-2]) / (2.0 * step)
    rates[0], rates[-1] = (points[1] - points[0]) / step, (points[-1] - points[-2]) / step
    return rates


def _outline(curves: Array, s: Array) -> Array:
    """Second derivatives (R, 2, S) of section curves (R, S, 2, 3) by s, across the curve, at toe and heel."""
    along = curves[:, 2:] - curves[:, :-2]
    bent = np.diff(curves, 2, axis=1) / s[1] ** 2
    length = dot(along, along)
    share = np.divide(dot(bent, along), length, out=np.zeros_like(length), where=length > 0.0)
    across = bent - share[..., None] * along
    return np.pad(np.sqrt(dot(across, across)).swapaxes(1, 2), ((0, 0), (0, 0), (1, 1)), mode="edge")
