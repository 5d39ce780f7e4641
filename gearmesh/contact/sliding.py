"""Sliding and rolling of two flanks at their contact: velocities of both surfaces, per radian of the pinion's rotation.

Both bodies move as rigid bodies: v_k(r) = dr/dphi1 of body k. At a contact with normal n their normal velocities are equal,
which gives the instantaneous ratio dphi2/dphi1. The difference v_1 - v_2 is the sliding velocity.

The contact itself moves. Let h_k be the height of surface k over the common tangent plane, with the Hessian K_k (shape
operator, n_i = -K r_i). At a fixed place the heights change by v_k.n - v_k.grad h_k, and their gradients by

    b_k = (n x omega_k) - K_k v_k        in the tangent plane

The gap h_2 - h_1 has its least value at the contact. So the contact moves by c with (K_1 - K_2) c = b_2 - b_1. In a principal
direction e of the relative curvature each component follows alone: c.e = (b_2 - b_1).e / kappa_e. Across a line of contact, e has
the larger relative curvature. There the surfaces pass through the contact with the rolling velocities

    u_k = (v_k - c).e

Their mean is the entrainment velocity, and their difference is the sliding velocity across the contact. For an involute spur
pair u_1 = rho_1 and u_2 = rho_2 N1/N2, with the radii of curvature rho_k.
Source: K. L. Johnson, Contact Mechanics, 1985, section 8.1, for the velocities of a contact; the rest is derived above.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.flanks import touching_jets
from gearmesh.contact.pair import MEMBER_NAMES
from gearmesh.contact.path import ContactPath
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.curvature import in_plane, principal, relative_curvature, shape_operator, tangent_basis
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.mount import Mount


@dataclass(frozen=True)
class FlankMotion:
    """Motion of both flanks at contacts (N,), per radian of the pinion's rotation."""

    #: instantaneous ratio (N,), dphi2/dphi1
    ratio: Array
    #: sliding velocities (N, 3), mm/rad: pinion's surface less gear's surface, fixed frame
    sliding: Array
    #: unit vectors (N, 3) across the contact, in the sense of entrainment, fixed frame; NaN at edges
    across: Array
    #: velocities (N, 2), mm/rad, of the surfaces of pinion and gear through the contact, across it; NaN at edges
    rolling: Array
    #: relative curvature (N,), 1/mm, across the contact; NaN at edges
    curvature: Array

    @staticmethod
    def joined(parts: Sequence[tuple[NDArray[np.intp], FlankMotion]]) -> FlankMotion:
        """Return the motion at all contacts from that at some; `parts`: their numbers, and their motion."""
        order = np.argsort(np.concatenate([rows for rows, _ in parts]))
        values = ([getattr(motion, field.name) for _, motion in parts] for field in fields(FlankMotion))
        return FlankMotion(*(np.concatenate(columns)[order] for columns in values))

    @property
    def sliding_speed(self) -> Array:
        """Sliding velocity (N,), mm/rad."""
        return np.asarray(np.linalg.norm(self.sliding, axis=-1))

    @property
    def sliding_across(self) -> Array:
        """Sliding velocity (N,), mm/rad, across the contact; above 0 where the pinion's surface is faster."""
        return np.asarray(self.rolling[:, 0] - self.rolling[:, 1])

    @property
    def entrainment(self) -> Array:
        """Mean (N,), mm/rad, of the rolling velocities: what draws lubricant into the contact."""
        return np.asarray(self.rolling.mean(axis=1))


def flank_motion(
    mounts: tuple[Mount, Mount], jets: tuple[Jet, Jet], point: Array, normal: Array, tangent: NDArray[np.bool_]
) -> FlankMotion:
    """Compute the motion of both flanks at contacts.

    - `mounts`: of pinion and gear.
    - `jets`: of both flanks (N,), fixed frame, normals out of the bodies.
    - `point` (N, 3), `normal` (N, 3): places of contact, mm, and normals out of the pinion along which the bodies press.
    - `tangent` (N,): True where the flanks touch inside both; elsewhere an edge touches, which has no rolling velocity.
    """
    pinion, gear = mounts
    pinion_jet, gear_jet = jets
    gear_velocity = gear.velocity(point)
    pinion_velocity = pinion.velocity(point)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = dot(normal, pinion_velocity) / dot(normal, gear_velocity)
        velocities = pinion_velocity, ratio[:, None] * gear_velocity
        spins = np.broadcast_to(pinion.spin, point.shape), ratio[:, None] * gear.spin
        # direction of the larger relative curvature: across a line, along the minor axis of an ellipse
        e1, e2 = tangent_basis(pinion_jet)
        pinion_operator = shape_operator(pinion_jet, e1, e2)
        relative = relative_curvature(pinion_jet, gear_jet, e1, e2)
        operators = pinion_operator, pinion_operator - relative
        curvatures = principal(relative)
        directions = in_plane(curvatures.angle, e1, e2)
        first = np.abs(curvatures.k1) > np.abs(curvatures.k2)
        across = np.where(first[:, None], *directions)
        kappa = np.where(first, curvatures.k1, curvatures.k2)
        # changes of the gradients of both heights, along `across`
        turn = np.stack((dot(across, e1), dot(across, e2)), axis=-1)
        changes = []
        for velocity, spin, operator in zip(velocities, spins, operators, strict=True):
            tangential = np.stack((dot(velocity, e1), dot(velocity, e2)), axis=-1)
            bent = np.einsum("ni,nij,nj->n", turn, operator, tangential)
            changes.append(dot(cross(pinion_jet.n, spin), across) - bent)
        moved = (changes[1] - changes[0]) / kappa
        rolling = np.stack([dot(velocity, across) - moved for velocity in velocities], axis=-1)
        # entrainment is positive along `across`
        sense = np.where(rolling.sum(axis=1) < 0.0, -1.0, 1.0)
    return FlankMotion(
        ratio,
        velocities[0] - velocities[1],
        np.where(tangent[:, None], sense[:, None] * across, np.nan),
        np.where(tangent[:, None], sense[:, None] * rolling, np.nan),
        np.where(tangent, -kappa, np.nan),
    )


def path_motion(pair: GearPair, path: ContactPath) -> FlankMotion:
    """Compute the motion of both flanks at the positions (P,) of a path; NaN without contact.

    Where one body touches with an edge, the normal is that of the other flank.
    """
    jets = touching_jets(pair, path)
    on_pinion_edge, on_gear_edge = (np.char.find(path.edge, name) >= 0 for name in MEMBER_NAMES)
    normal = np.where((on_pinion_edge & ~on_gear_edge)[:, None], -jets[1].n, path.normal)
    return flank_motion(pair.mounts, jets, path.point, normal, np.isin(path.kind, ("point", "line")))
