"""Moments of volumes up to the second: the basis of volume, centre of gravity and inertia of a member, for a density of
1.

Teeth are integrated like `Tooth.volume`: down to a floor, at constant polar angle along the generatrices of their
sections. The body is the volume between its profile and the axis. Openings are prisms along the axis; their sections
are integrated along their outlines. All integrals are closed forms or Gauss rules on smooth integrands.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneCurve
from gearmesh.records import dataclass
from gearmesh.teeth.blank.halves import AxialGap
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.tooth import Tooth

#: m^3 per mm^3
M3_PER_MM3 = 1e-9
#: Gauss nodes along a piece of a profile, on which moments are polynomials of degree 4
PROFILE_NODES = 4
#: Gauss nodes along a curve of an outline
OUTLINE_NODES = 32


@dataclass(frozen=True)
class Moments:
    """Integrals over a volume.

    `volume`: integral of 1, mm^3. `first`: integral of the position r (3,), mm^4. `second`: integral of r r^T (3, 3),
    mm^5.
    """

    volume: float
    first: Array
    second: Array

    @staticmethod
    def none() -> Moments:
        return Moments(0.0, np.zeros(3), np.zeros((3, 3)))

    @staticmethod
    def of(points: Array, weights: Array) -> Moments:
        """Return the moments of points (..., 3) with weights (...,)."""
        r, w = points.reshape(-1, 3), weights.ravel()
        return Moments(float(w.sum()), w @ r, (w[:, None] * r).T @ r)

    def __add__(self, other: Moments) -> Moments:
        return Moments(self.volume + other.volume, self.first + other.first, self.second + other.second)

    def __sub__(self, other: Moments) -> Moments:
        return Moments(self.volume - other.volume, self.first - other.first, self.second - other.second)

    def move(self, motion: Rigid) -> Moments:
        """Return the moments of the volume moved, or reflected."""
        turned, way = motion.rotation @ self.first, motion.translation
        crossed = np.outer(turned, way)
        second = motion.rotation @ self.second @ motion.rotation.T + crossed + crossed.T
        return Moments(self.volume, turned + self.volume * way, second + self.volume * np.outer(way, way))

    @property
    def centre(self) -> Array:
        """Centre of gravity (3,), mm."""
        return np.asarray(self.first / self.volume)

    def mass(self, density: float) -> float:
        """Mass, kg, for a density in kg/m^3."""
        return self.volume * M3_PER_MM3 * density

    def about_axis(self, density: float) -> float:
        """Moment of inertia about the z axis, kg mm^2, for a density in kg/m^3."""
        return float(self.second[0, 0] + self.second[1, 1]) * M3_PER_MM3 * density

    def about_centre(self, density: float) -> Array:
        """Tensor of inertia (3, 3) about the centre of gravity, kg mm^2, for a density in kg/m^3."""
        second = self.second - np.outer(self.first, self.first) / self.volume
        return np.asarray(np.trace(second) * np.eye(3) - second) * M3_PER_MM3 * density


def member_moments(member: Member) -> Moments:
    """Return the moments of a member in its own frame, with all features of its body."""
    if member.tooth.joint.travel is not None:
        return _bar(member)
    row = _row(member)
    whole = Moments.none()
    for half in member.halves:
        whole += row.move(half.motion)
    for under in (*(gap.body for gap in member.gaps), member.body):
        whole -= cut_off(under.profile)
    for outline, low, high in member.prisms:
        whole -= prism(outline, low, high)
    return whole


def _row(member: Member) -> Moments:
    """Moments of all teeth of a row down to the axis, signed by the direction of z from toe to heel."""
    profile = member.tooth.blank.body.profile
    return _teeth(member) + cut_off((profile[0], profile[-1]))


def _teeth(member: Member) -> Moments:
    """Moments of all teeth of a row down to their floor, or of a rack to its back."""
    tooth, row = member.tooth, Moments.none()
    tooth_moments = [Moments.of(*tooth_kind.quadrature()) for tooth_kind in member.different_teeth]
    for place, kind in zip(tooth.joint.places(tooth.teeth).tolist(), member.order.tolist(), strict=True):
        row += tooth_moments[kind].move(tooth.joint.to(place * tooth.pitch_angle))
    return row


def _bar(member: Member) -> Moments:
    """Moments of a rack: its teeth, and the bar beyond them at both ends, as high as the root."""
    tooth, whole = member.tooth, _teeth(member)
    back, places = tooth.blank.body.profile[0][0], tooth.joint.places(tooth.teeth)
    nodes, weights = _gauss(OUTLINE_NODES)
    x, y, _ = np.meshgrid(*(nodes,) * 3, indexing="ij")
    # a tooth begins with the root before it; the bar ends in the middle of a root: integrate the rest of the bar
    for line, widths in _root_lines(tooth, nodes, weights):
        top, begin, z = line.T
        middle, height = tooth.root_middle(z), top - back
        amount = np.einsum("i,j,k->ijk", weights, weights, height * widths)
        for place, side in ((places[0], -1.0), (places[-1] + 1, 1.0)):
            way = float(tooth.joint.to(place * tooth.pitch_angle).translation[1])
            length = side * (middle - begin) + member.overhang
            samples = np.stack(
                (back + height * x, begin + way + side * length * y, np.broadcast_to(z, x.shape)), axis=-1
            )
            whole += Moments.of(samples, amount * length)
    row, whole = whole, Moments.none()
    for half in member.halves:
        whole += row.move(half.motion)
    for gap in member.gaps:
        whole += _bar_in_gap(member, gap, nodes, weights)
    for outline, *z_ends in member.prisms:
        whole -= prism(outline, *z_ends)
    return whole


def _bar_in_gap(member: Member, gap: AxialGap, nodes: Array, weights: Array) -> Moments:
    """Moments of the bar between the halves of a rack."""
    blank, (low, high) = member.tooth.blank, gap.body.ends
    back, (begin, end) = blank.body.profile[0][0], map(float, member.bar_ends(np.array(blank.faces[1])))
    samples = np.stack(np.meshgrid(*(nodes,) * 3, indexing="ij"), axis=-1)
    sizes = np.array([gap.floor - back, end - begin, high - low])
    amount = np.einsum("i,j,k->ijk", weights, weights, weights) * sizes.prod()
    return Moments.of(np.array([back, begin, low]) + samples * sizes, amount)


def _root_lines(tooth: Tooth, nodes: Array, weights: Array) -> Iterator[tuple[Array, Array]]:
    """Yield lines along which a rack's root begins, from toe to heel, and within the chamfers at its ends.

    Each line has points (N, 3), mm, at `nodes` (N,) of a rule on 0 .. 1, and the width (N,), mm, of the face at each
    point.
    """
    (toe, heel), root = tooth.blank.extent, next(iter(tooth.chain))
    for low, high in pairwise(tooth.smooth_stretches):
        points = tooth.grid(root, np.zeros(1), tooth.sections(low + (high - low) * nodes)).points[0]
        yield points, (heel - toe) * (high - low) * weights
    for end, strip in enumerate(tooth.end_strips):
        if strip is not None:
            width = abs(tooth.blank.extent[end] - tooth.blank.faces[end])
            yield strip.at(strip.pieces[0], np.zeros(1), nodes), width * strip.depth(nodes)[1] * weights


def cut_off(profile: Sequence[tuple[float, float]]) -> Moments:
    """Moments of the volume between a profile (rho, z) and the axis, signed by the direction of z."""
    ends = np.array(profile)
    nodes, weights = _gauss(PROFILE_NODES)
    way = np.diff(ends, axis=0)
    rho, z = np.moveaxis(ends[:-1, None] + nodes[:, None] * way[:, None], -1, 0)
    area = np.pi * rho**2 * weights * way[:, 1:]
    second = np.diag([(0.25 * area * rho**2).sum()] * 2 + [(area * z**2).sum()])
    return Moments(float(area.sum()), np.array([0.0, 0.0, (area * z).sum()]), second)


def prism(outline: Iterable[PlaneCurve], low: float, high: float) -> Moments:
    """Moments of a prism along the axis between two z, mm; its outline is counterclockwise."""
    nodes, weights = _gauss(OUTLINE_NODES)
    points, shares = [], []
    for curve in outline:
        r, slope = curve.at(nodes), curve.slope(nodes)
        # sectors to the origin, along whose rays moments are polynomials
        ray, ray_weights = _gauss(PROFILE_NODES)
        swept = (r[:, 0] * slope[:, 1] - r[:, 1] * slope[:, 0]) * weights
        points.append((ray[:, None, None] * r).reshape(-1, 2))
        shares.append((ray_weights * ray)[:, None] * swept)
    flat, share = np.concatenate(points), np.concatenate([part.ravel() for part in shares])
    z, z_weights = _gauss(PROFILE_NODES)
    levels = low + (high - low) * z
    samples = np.concatenate([np.column_stack((flat, np.full(len(flat), level))) for level in levels])
    return Moments.of(samples, np.concatenate([share * (high - low) * weight for weight in z_weights]))


def _gauss(order: int) -> tuple[Array, Array]:
    """Nodes and weights of a Gauss rule on 0 .. 1."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    return 0.5 * (nodes + 1.0), 0.5 * weights
