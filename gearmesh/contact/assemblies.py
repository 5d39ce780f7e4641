"""Contact of one pair of members in many assemblies with different mounts, all assemblies in one batch."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.refinement import Contacts
from gearmesh.contact.engagement.engagement import rates
from gearmesh.contact.first_touch.first_touch import touches
from gearmesh.contact.pair import HAS_TIP_EDGE, Pair, within
from gearmesh.contact.tca import contact_jets
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import contact_ellipse, relative_curvature, tangent_basis
from gearmesh.records import dataclass
from gearmesh.teeth.mount import Mount

#: positions solved at once: fewer spend more of their time between calls, more do not stay in the cache
MAX_BATCH = 10_000


def many_assemblies(pair: Pair, bases: tuple[Rigid, Rigid], phi1: Array) -> Contacts:
    """Find first touch of a tooth pair in M assemblies at rotations phi1 (P,), rad: M P positions, assembly by assembly.

    `bases` map the frames of pinion and gear at rotation zero to the fixed frame, with rotations (M, 3, 3) and translations (M, 3).
    The other values of the mounts are the pair's.
    """
    contacts = Contacts.nothing(len(bases[0].translation) * len(phi1))
    for part, there, rotation in _chunks(pair, bases, phi1):
        contacts.put(part, touches(there, rotation)[0])
    return contacts


@dataclass(frozen=True)
class AssemblyPaths:
    """Contact of one tooth pair in M assemblies at P rotations; values are NaN without contact."""

    #: rotations of the pinion, (P,) for all assemblies or (M, P), rad
    phi1: Array
    #: True (M, P) where the pair touches
    touching: NDArray[np.bool_]
    #: True (M, P) where contact is inside both flanks, in a point or along a line
    surface: NDArray[np.bool_]
    #: True (M, P) where contact is along a line
    line: NDArray[np.bool_]
    #: advance (M, P) of the gear over the nominal ratio, rad
    advance: Array
    #: slope (M, P) of the advance by phi1
    slope: Array
    #: distance (M, P) between the points of both members, mm
    residual: Array
    #: point (M, P, 3) of contact in the pinion's frame, mm
    point: Array
    #: semi-axes (M, P, 2, 3) of the contact ellipse in the pinion's frame, mm
    axes: Array
    #: distance (M, P, E) of surface contact inside each edge that ends a flank, mm
    inside: Array


def assembly_paths(pair: Pair, bases: tuple[Rigid, Rigid], phi1: Array) -> AssemblyPaths:
    """Compute the contact of a tooth pair in M assemblies at rotations phi1, rad, (P,) for all assemblies or (M, P).

    `bases` are as in `many_assemblies`.
    """
    shape = len(bases[0].translation), phi1.shape[-1]
    count = shape[0] * shape[1]
    alone = pair.parts[0]
    bounds = [bound for number in alone.ends if (bound := alone.bounds[number]) is not None]
    flags, inside = np.zeros((3, count), dtype=bool), np.full((count, len(bounds)), np.nan)
    numbers, vectors = np.full((3, count), np.nan), np.full((3, count, 3), np.nan)
    for part, there, rotation in _chunks(pair, bases, phi1):
        with np.errstate(all="ignore"):
            contacts = touches(there, rotation)[0]
            touching, edge = contacts.touching, contacts.edges[:, 0]
            (own, mating), (one, two) = contact_jets(there, rotation, contacts)
            e1, e2 = tangent_basis(one)
            ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta)
            gap = np.sqrt(dot(one.r - two.r, one.r - two.r))
            slope = pair.drive * (rates(there, rotation, contacts)[:, 4] - pair.ratio)
            to_own = there.pinion.mount.at(rotation).inverse
        surface = touching & ((edge < 0) | within(edge)) & (contacts.part == 0)
        # contact on a chamfer or rounding of a tip is edge contact
        on_tip = HAS_TIP_EDGE[contacts.part]
        flags[:, part] = touching, surface, contacts.line & ~on_tip
        for k, bound in enumerate(bounds):
            inside[part, k] = np.where(surface, -bound.level.value((own, mating)[bound.member].r), np.nan)
        numbers[:, part] = np.where(touching, (contacts.advance, slope, gap), np.nan)
        vectors[0, part] = np.where(touching[:, None], own.r, np.nan)
        pointed = (touching & (edge < 0) & ~contacts.line & ~on_tip)[:, None]
        for k, (size, way) in enumerate(((ellipse.semi_major, ellipse.major), (ellipse.semi_minor, ellipse.minor))):
            vectors[k + 1, part] = np.where(pointed, size[:, None] * to_own.vector(way), np.nan)
    touching, on_surface, line = (flag.reshape(shape) for flag in flags)
    advance, slope, residual = (row.reshape(shape) for row in numbers)
    point, major, minor = (vector.reshape(*shape, 3) for vector in vectors)
    axes = np.stack((major, minor), axis=-2)
    return AssemblyPaths(
        phi1, touching, on_surface, line, advance, slope, residual, point, axes, inside.reshape(*shape, len(bounds))
    )


def _chunks(pair: Pair, bases: tuple[Rigid, Rigid], phi1: Array) -> Iterator[tuple[NDArray[np.intp], Pair, Array]]:
    """Yield positions of all assemblies in batches: their numbers (N,), the pair with N mounts, and rotations (N,), rad."""
    count, positions = len(bases[0].translation), phi1.shape[-1]
    every = np.broadcast_to(phi1, (count, positions)).ravel()
    ends = np.linspace(0, count * positions, -(-count * positions // MAX_BATCH) + 1).astype(np.intp)
    for start, end in pairwise(ends):
        part = np.arange(start, end)
        there = replace(
            pair,
            pinion=pair.pinion.remount(_place(pair.pinion.mount, bases[0], part // positions)),
            gear=pair.gear.remount(_place(pair.gear.mount, bases[1], part // positions)),
        )
        yield part, there, every[part]


def _place(mount: Mount, base: Rigid, index: NDArray[np.intp]) -> Mount:
    return replace(mount, base=Rigid(base.rotation[index], base.translation[index]))
