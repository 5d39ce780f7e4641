"""Moments of volumes up to the second: what volume, centre of gravity and inertia of a member follow from, of a density of 1.

The teeth are integrated as `Tooth.volume` does, down to a floor, at constant polar angle along the generatrices of their sections;
the body is what its profile cuts off towards the axis; openings are prisms along it, their sections integrated along their
outlines. All are closed forms or Gauss's rule on smooth integrands.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneCurve
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.tooth import Tooth

#: mm^3 in m^3
CUBIC = 1e-9
#: nodes of Gauss's rule along a profile's pieces, on which moments are polynomials of degree 4, and along an outline's curves
ALONG, ROUND = 4, 32


@dataclass(frozen=True)
class Moments:
    """Integrals over a volume: of 1, mm^3, of the place r (3,), mm^4, and of its products r r^T (3, 3), mm^5."""

    volume: float
    first: Array
    second: Array

    @staticmethod
    def none() -> Moments:
        return Moments(0.0, np.zeros(3), np.zeros((3, 3)))

    @staticmethod
    def of(points: Array, weights: Array) -> Moments:
        """Of points (..., 3) with weights (...,)."""
        r, w = points.reshape(-1, 3), weights.ravel()
        return Moments(float(w.sum()), w @ r, (w[:, None] * r).T @ r)

    def __add__(self, other: Moments) -> Moments:
        return Moments(self.volume + other.volume, self.first + other.first, self.second + other.second)

    def __sub__(self, other: Moments) -> Moments:
        return Moments(self.volume - other.volume, self.first - other.first, self.second - other.second)

    def move(self, motion: Rigid) -> Moments:
        """Of the volume moved, or reflected."""
        turned, way = motion.rotation @ self.first, motion.translation
        crossed = np.outer(turned, way)
        second = motion.rotation @ self.second @ motion.rotation.T + crossed + crossed.T
        return Moments(self.volume, turned + self.volume * way, second + self.volume * np.outer(way, way))

    @property
    def centre(self) -> Array:
        """Centre of gravity (3,), mm."""
        return np.asarray(self.first / self.volume)

    def mass(self, density: float) -> float:
        """kg, of a density in kg/m^3."""
        return self.volume * CUBIC * density

    def about_axis(self, density: float) -> float:
        """Moment of inertia about the z axis, kg mm^2, of a density in kg/m^3."""
        return float(self.second[0, 0] + self.second[1, 1]) * CUBIC * density

    def about_centre(self, density: float) -> Array:
        """Tensor of inertia (3, 3) about the centre of gravity, kg mm^2, of a density in kg/m^3."""
        second = self.second - np.outer(self.first, self.first) / self.volume
        return np.asarray(np.trace(second) * np.eye(3) - second) * CUBIC * density


def member_moments(member: Member) -> Moments:
    """Moments of a member in its own frame, with all features of its body."""
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
    """All teeth of a row down to the axis; signed by the direction of z from toe to heel."""
    profile = member.tooth.blank.body.profile
    return _teeth(member) + cut_off((profile[0], profile[-1]))


def _teeth(member: Member) -> Moments:
    """All teeth of a row down to their floor, of a rack to its back."""
    tooth, row = member.tooth, Moments.none()
    own = [Moments.of(*one.quadrature()) for one in member.different_teeth]
    for place, kind in zip(tooth.joint.places(tooth.teeth).tolist(), member.order.tolist(), strict=True):
        row += own[kind].move(tooth.joint.to(place * tooth.pitch_angle))
    return row


def _bar(member: Member) -> Moments:
    """A rack: its teeth, and what goes on beyond them at both ends as high as the root."""
    tooth, whole = member.tooth, _teeth(member)
    back, places = tooth.blank.body.profile[0][0], tooth.joint.places(tooth.teeth)
    nodes, weights = _gauss(ROUND)
    x, y, _ = np.meshgrid(*(nodes,) * 3, indexing="ij")
    # teeth are counted from where the root before them begins, the bar's ends from its middle
    for line, widths in _root_lines(tooth, nodes, weights):
        top, begin, z = line.T
        middle, height = tooth.root_middle(z), top - back
        amount = np.einsum("i,j,k->ijk", weights, weights, height * widths)
        for place, side in ((places[0], -1.0), (places[-1] + 1, 1.0)):
            way = float(tooth.joint.to(place * tooth.pitch_angle).translation[1])
            length = side * (middle - begin) + member.overhang
            there = np.stack((back + height * x, begin + way + side * length * y, np.broadcast_to(z, x.shape)), axis=-1)
            whole += Moments.of(there, amount * length)
    for outline, *between in member.prisms:
        whole -= prism(outline, *between)
    return whole


def _root_lines(tooth: Tooth, nodes: Array, weights: Array) -> Iterator[tuple[Array, Array]]:
    """Where a rack's root begins from toe to heel, with the chamfers there that go on along it: points (N, 3), and what of the face
    each stands for, mm, (N,), at `nodes` (N,) of a rule from 0 to 1 with its weights, one part after the other."""
    (toe, heel), root = tooth.blank.extent, next(iter(tooth.chain))
    for low, high in pairwise(tooth.smooth_stretches):
        points = tooth.grid(root, np.zeros(1), tooth.sections(low + (high - low) * nodes)).points[0]
        yield points, (heel - toe) * (high - low) * weights
    for end, strip in enumerate(tooth.end_strips):
        if strip is not None:
            width = abs(tooth.blank.extent[end] - tooth.blank.faces[end])
            yield strip.at(strip.pieces[0], np.zeros(1), nodes), width * strip.depth(nodes)[1] * weights


def cut_off(profile: Sequence[tuple[float, float]]) -> Moments:
    """Of what a profile (rho, z) cuts off towards the axis; signed by the direction of z."""
    ends = np.array(profile)
    nodes, weights = _gauss(ALONG)
    way = np.diff(ends, axis=0)
    rho, z = np.moveaxis(ends[:-1, None] + nodes[:, None] * way[:, None], -1, 0)
    area = np.pi * rho**2 * weights * way[:, 1:]
    second = np.diag([(0.25 * area * rho**2).sum()] * 2 + [(area * z**2).sum()])
    return Moments(float(area.sum()), np.array([0.0, 0.0, (area * z).sum()]), second)


def prism(outline: Iterable[PlaneCurve], low: float, high: float) -> Moments:
    """Of a prism along the axis between two z, mm, its outline counterclockwise."""
    nodes, weights = _gauss(ROUND)
    points, shares = [], []
    for curve in outline:
        r, slope = curve.at(nodes), curve.slope(nodes)
        # sectors to the origin, along whose rays moments are polynomials
        ray, ray_weights = _gauss(ALONG)
        swept = (r[:, 0] * slope[:, 1] - r[:, 1] * slope[:, 0]) * weights
        points.append((ray[:, None, None] * r).reshape(-1, 2))
        shares.append((ray_weights * ray)[:, None] * swept)
    flat, share = np.concatenate(points), np.concatenate([part.ravel() for part in shares])
    z, z_weights = _gauss(ALONG)
    levels = low + (high - low) * z
    there = np.concatenate([np.column_stack((flat, np.full(len(flat), level))) for level in levels])
    return Moments.of(there, np.concatenate([share * (high - low) * weight for weight in z_weights]))


def _gauss(order: int) -> tuple[Array, Array]:
    """Nodes and weights of Gauss's rule on 0 .. 1."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    return 0.5 * (nodes + 1.0), 0.5 * weights
