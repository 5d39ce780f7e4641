"""What a link asks of a grid: its second form, the directions in which its cells are best drawn, how many it takes.

With the second form L ds^2 + 2 M ds dt + N dt^2 of a link, a cell ds x dt cut along its better diagonal misses the surface by
an eighth of the largest of

    |L| ds^2,   |N| dt^2,   |L ds^2 - 2 |M| ds dt + N dt^2|,

so given dt the widest ds follows in closed form. Cells may be sheared: where the diagonals between the lines of constant s run
in the conjugate direction dt/ds = -M / N instead of along the section, L becomes L - M^2 / N and M vanishes. On a developable
flank the diagonals are then rulings and one cell is as wide as the flank; on the thread of a worm, whose sections go round the
axis as its helices do, they cross it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Grid, Link, Sections, parameter
from gearmesh.teeth.tooth import Tooth

#: points per link on which second forms are sampled, across and along
SAMPLES = (25, 9)
#: stations on which levels are kept: a worm's diagonals are drawn by them over several turns
STATIONS = 65
#: step of t over which the ends of the links are differentiated
STEP = 1e-6
#: a link is sheared if that takes no more than this share of its cells
WORTH = 0.9
#: and if its diagonals, as long as the link is wide, run along no more than so many times the whole face
STEEP = 5.0
#: section curves that need no more than so many times the lines' nodes have the lines begin at all of them
CLOSE = 1.5


@dataclass(frozen=True)
class Forms:
    """Second forms of all links (R, S, T) on uniform samples of s and of tau, the graded station parameter.

    `outline` (R, 2, S): as `length`, of the section curves at toe and heel in space.
    """

    length: Array
    twist: Array
    face: Array
    outline: Array
    t_of_tau: Array

    @staticmethod
    def of(tooth: Tooth, regions: tuple[Region, ...]) -> Forms:
        """Raises TrimError where the tooth cannot be trimmed."""
        s, t = np.linspace(0.0, 1.0, SAMPLES[0]), np.linspace(0.0, 1.0, SAMPLES[1])
        around = np.clip(t[:, None] + np.array([-STEP, 0.0, STEP]), 0.0, 1.0)
        sections = tooth.sections(around.ravel())
        second_forms = [_second_form(tooth, tooth.chain[region], s, around, sections) for region in regions]
        length, twist, face = np.moveaxis(np.array(second_forms), 1, 0)
        curves = np.stack([tooth.grid(region, s, sections[1::3]).points[:, [0, -1]] for region in regions])
        return _grade(length, twist, face, _outline(curves, s), t)


def _second_form(tooth: Tooth, link: Link, s: Array, around: Array, sections: Sections) -> tuple[Array, Array, Array]:
    """L, M, N (S, T) by s and t, of sections before, at and after every station, `around` (T, 3).

    n . r_xy = -r_x . n_y, where x and y are s and t: along s the station stays, along t it grows evenly.
    """
    grid = link.grid(s, sections[1::3])
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


@dataclass(frozen=True)
class LinkPlan:
    """Cells per unit of s of the lines, and of the section curves at toe and heel, as pairs (s, density); levels (S, STATIONS).

    The diagonals are to follow the lines of constant level over (s, t). `otherwise` is the plan without shear of a link that has
    it.
    """

    lines: tuple[Array, Array]
    outline: tuple[tuple[Array, Array], tuple[Array, Array]]
    level: Array
    otherwise: LinkPlan | None = None


def _outline(curves: Array, s: Array) -> Array:
    """Second derivatives (R, 2, S) of section curves (R, S, 2, 3) by s, across the curve, at toe and heel."""
    along = curves[:, 2:] - curves[:, :-2]
    bent = np.diff(curves, 2, axis=1) / s[1] ** 2
    length = dot(along, along)
    share = np.divide(dot(bent, along), length, out=np.zeros_like(length), where=length > 0.0)
    across = bent - share[..., None] * along
    return np.pad(np.sqrt(dot(across, across)).swapaxes(1, 2), ((0, 0), (0, 0), (1, 1)), mode="edge")


def _grade(length: Array, twist: Array, face: Array, outline: Array, t: Array) -> Forms:
    """Station parameter tau with cells along the face in proportion to 1 / sqrt(N): forms with respect to it."""
    need = np.sqrt(np.abs(face).max(axis=(0, 1)))
    need = np.maximum(need, 0.25 * need.max()) if need.max() > 0.0 else np.ones_like(need)
    total = np.concatenate(([0.0], np.cumsum(0.5 * (need[1:] + need[:-1]))))
    total /= total[-1]
    uniform = np.linspace(0.0, 1.0, t.size)
    t_of_tau = np.interp(uniform, total, t)
    speed = np.gradient(t_of_tau, uniform)
    return Forms(length, twist * speed, face * speed**2, outline, t_of_tau)


def cheapest(forms: Forms, tolerance: float, at_ends: float, *, straight: bool = False) -> tuple[int, list[LinkPlan]]:
    """Number of cells along the face with the fewest triangles, and what each link then takes.

    `at_ends`: tolerance (mm) of the outline of the end faces; `straight`: without shear, as where the surfaces have corners at
    stations.
    """
    least = max(1, int(np.ceil(np.sqrt(np.abs(forms.face).max() / (8.0 * tolerance)))))
    counts = np.unique(np.round(least * np.geomspace(1.0, 16.0, 25)).astype(int))
    s = np.linspace(0.0, 1.0, forms.length.shape[1])
    floor = 8e-6 * tolerance
    face = np.copysign(np.maximum(np.abs(forms.face), floor), forms.face)
    slope = forms.twist / face
    ends = np.sqrt(forms.outline / (8.0 * at_ends))
    per_unit, cells = [], []
    for length, twist in ((forms.length, forms.twist), (forms.length - slope * forms.twist, np.zeros_like(slope))):
        wide = _widest(length, twist, forms.face, 1.0 / counts[:, None, None, None], tolerance).min(axis=-1)
        density = 1.0 / wide
        for end in (0, 1):
            close = (ends[:, end] > density) & (ends[:, end] <= CLOSE * density)
            density = np.where(close, ends[:, end], density)
        per_unit.append(density)
        cells.append(np.maximum(np.ceil(np.trapezoid(density, s, axis=-1)), 1.0))
    # by t, of which the second forms are smooth
    level = [
        _levels(slopes) for slopes in slope * np.gradient(forms.t_of_tau, np.linspace(0.0, 1.0, forms.t_of_tau.size))
    ]
    plain = np.broadcast_to(np.linspace(0.0, 1.0, STATIONS), (s.size, STATIONS))
    sheared = (cells[1] <= WORTH * cells[0]) & (np.array([np.abs(shear - plain).max() for shear in level]) <= STEEP)
    sheared &= not straight
    taken = np.where(sheared, cells[1], cells[0])
    best = int(np.argmin((counts + 1.0) * taken.sum(axis=-1)))
    plans = []
    for k, shear in enumerate(level):
        outline = (s, ends[k, 0]), (s, ends[k, 1])
        plan = LinkPlan((s, per_unit[0][best, k]), outline, plain)
        plans.append(LinkPlan((s, per_unit[1][best, k]), outline, shear, plan) if sheared[best, k] else plan)
    return int(counts[best]), plans


def _levels(slope: Array) -> Array:
    """Level (S, STATIONS) of slopes M / N (S, T) by s and t: where the line dt/ds = -slope through each place meets s = 0.

    By Heun's method. Slopes that are taken straight between the samples, or at the end of a step where it begins, turn the
    diagonals of a worm's root by degrees.
    """
    s, coarse, t = (np.linspace(0.0, 1.0, n) for n in (*slope.shape, STATIONS))
    if not slope.any():
        return np.tile(t, (s.size, 1))
    from scipy.interpolate import make_interp_spline

    fine = make_interp_spline(coarse, slope, k=3, axis=1)(t)
    level = np.tile(t, (s.size, 1))
    for k in range(s.size - 1, 0, -1):
        step = s[k] - s[k - 1]
        here = np.interp(level[k:], t, fine[k])
        there = np.interp(level[k:] + step * here, t, fine[k - 1])
        level[k:] += 0.5 * step * (here + there)
    return level


def _widest(length: Array, twist: Array, face: Array, dt: Array, tolerance: float) -> Array:
    """Widest ds for cells of height dt, from the condition on the edge along s and on the better diagonal.

    L is made positive by turning the normal; then L ds^2 - 2 |M| dt ds + N dt^2 must lie within +-8 tolerance.
    """
    limit = 8.0 * tolerance
    sign = np.where(length < 0.0, -1.0, 1.0)
    length = np.maximum(np.abs(length), limit * 1e-6)
    half = np.abs(twist) * dt
    rest = sign * face * dt**2
    upper = (half + np.sqrt(np.maximum(half**2 - length * (rest - limit), 0.0))) / length
    dips = half**2 - length * (rest + limit)
    lower = (half - np.sqrt(np.maximum(dips, 0.0))) / length
    ds = np.where((dips > 0.0) & (lower > 0.0), lower, upper)
    return np.clip(np.minimum(ds, np.sqrt(limit / length)), 1e-5, 1e3)
