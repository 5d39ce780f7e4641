"""Volume, mass and moment of inertia of a member: exact teeth, the body under them with hub and web, its keyway and holes.

Sections across the axis are integrated as sectors to it, of area (x dy - y dx) / 2 and polar moment rho^2 (x dy - y dx) / 4, by
Gauss's rule on polynomials through each of their links, and so along the face. The body is a profile turned round the axis; a
keyway lies along +x.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.gear_train import Drilling, Member, Slot
from gearmesh.teeth.tooth import Tooth

#: nodes of Gauss's rule on a link of a section (volumes agree with `Tooth.volume` to 3e-11), along the face and over a keyway
ORDER, STATIONS, ACROSS = 32, 7, 32
#: mm^3 in m^3
CUBIC = 1e-9


@dataclass(frozen=True)
class Bulk:
    """Volume (mm^3) and polar moment about the axis (mm^5), of a density of 1."""

    volume: float
    moment: float

    def __add__(self, other: Bulk) -> Bulk:
        return Bulk(self.volume + other.volume, self.moment + other.moment)

    def __sub__(self, other: Bulk) -> Bulk:
        return Bulk(self.volume - other.volume, self.moment - other.moment)

    def mass(self, density: float) -> float:
        """kg, of a density in kg/m^3."""
        return self.volume * CUBIC * density

    def inertia(self, density: float) -> float:
        """Moment of inertia about the axis, kg mm^2, of a density in kg/m^3."""
        return self.moment * CUBIC * density


def bulk(member: Member) -> Bulk:
    """Volume and polar moment of a member."""
    body = member.body
    whole = sum([_teeth(member.one_tooth)] * len(member.halves), Bulk(0.0, 0.0))
    for under in (*(gap.body for gap in member.gaps), body):
        whole -= _profile_bulk(under)
    if member.keyway is not None:
        whole -= _slot(member.keyway, body.bore_radius, body.ends[1] - body.ends[0])
    if member.holes is not None:
        low, high = member.hole_range
        whole -= _hole_bulk(member.holes, high - low)
    return whole


def _teeth(tooth: Tooth) -> Bulk:
    """Everything between the axis and the teeth; signed by the direction of z from toe to heel."""
    nodes, weights = np.polynomial.legendre.leggauss(ORDER)
    stations, shares = np.polynomial.legendre.leggauss(STATIONS)
    sections = tooth.sections(0.5 * (stations + 1.0))
    area, moment = np.zeros(STATIONS), np.zeros(STATIONS)
    for region in tooth.regions:
        points = tooth.grid(region, 0.5 * (nodes + 1.0), sections).points
        x, y, _ = np.moveaxis(points, -1, 0)
        dx, dy = (_slope(nodes, coordinate) for coordinate in (x, y))
        sector = x * dy - y * dx
        area = area + 0.5 * weights @ sector
        moment = moment + 0.25 * weights @ (sector * (x * x + y * y))
    toe, heel = (point[1] for point in (tooth.blank.body.profile[0], tooth.blank.body.profile[-1]))
    length = 0.5 * (heel - toe) * tooth.teeth
    return Bulk(float(length * (shares @ area)), float(length * (shares @ moment)))


def _slope(nodes: Array, values: Array) -> Array:
    """Derivative (S, T) at nodes (S,) of the polynomials through values (S, T)."""
    series = np.polynomial.legendre.legfit(nodes, values, nodes.size - 1)
    return np.asarray(np.polynomial.legendre.legval(nodes, np.polynomial.legendre.legder(series)).T, dtype=float)


def _profile_bulk(body: Body) -> Bulk:
    """What a body's profile cuts off towards the axis, from toe to heel; signed as `_teeth`."""
    rho, z = np.array(body.profile).T
    a, b, rise = rho[:-1], rho[1:], np.diff(z)
    fourth = (a**4 + a**3 * b + a**2 * b**2 + a * b**3 + b**4) / 5.0
    return Bulk(float(np.pi / 3.0 * (rise @ (a * a + a * b + b * b))), float(0.5 * np.pi * (rise @ fourth)))


def _slot(slot: Slot, bore: float, length: float) -> Bulk:
    """What a keyway takes outside the bore."""
    nodes, weights = np.polynomial.legendre.leggauss(ACROSS)
    y, weights = 0.5 * slot.width * nodes, 0.5 * slot.width * weights
    inner, outer = np.sqrt(bore**2 - y**2), bore + slot.depth
    moment = (outer**3 - inner**3) / 3.0 + y**2 * (outer - inner)
    return Bulk(length * float(weights @ (outer - inner)), length * float(weights @ moment))


def _hole_bulk(holes: Drilling, length: float) -> Bulk:
    area = 0.25 * math.pi * holes.diameter**2 * holes.count
    return Bulk(area * length, area * length * (0.125 * holes.diameter**2 + 0.25 * holes.circle**2))
