"""Stress in the fillets of teeth in contact: bending stress, and separately the contact's own field beside the contact.

Bending stress is the largest principal stress where the tangent of the fillet is at 30 deg to the tooth
(`root_tangent`). The largest stress in the fillet may lie elsewhere. Where flanks are pressed close to their lower end,
it is the tension around the contact, not bending.

A force that moves down the flank bends the fillet less and less, in proportion to its lever. Close to the fillet, the
tension around the contact rises like 1/r^2. Forces nearer than half the height of the flank therefore count by their
bending alone: the stress of forces farther up is continued in a straight line (`contact_tension`). No place of the
fillet is excluded because a contact is near, so that the stress is continuous while a contact passes. Nodes on the
border of flank and fillet never count: they carry the load, and their stress does not converge.

The contact's own field is reported separately. On a half-space (Boussinesq) a force F causes on the surface, at
distance r and angle phi to x,

    s_rr = -s_tt = (1 - 2 nu) F / (2 pi r^2)
    (s_xx - s_yy) / 2 + i s_xy = sum over forces of (1 - 2 nu) F exp(2 i phi) / (2 pi r^2)

This falls off slowly beside points and the ends of lines, and sums to zero beside the middle of a line. Next to an end
face the forces' images behind it add as much again. A place is in the contact's own field if this tension exceeds the
share `OWN_FIELD_SHARE` of its stress. Places within an eighth of the flank's height (about an element) of a pressed
place are in the field too.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.fe.results import principal_stresses
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.loaded.compliance.compliance import FilletStress
from gearmesh.records import dataclass

#: share of the stress at a place above which the contact's own tension puts the place in the contact's own field
OWN_FIELD_SHARE = 0.1
#: distance, in eighths of the flank's height, below which a force's own field at a place is removed from bending;
#: beyond it the stress of a line of contact is proportional to the lever
CLOSE_EIGHTHS = 4.0
#: error of the bending stress over its difference from a mesh three quarters as fine (see notes.md)
MESH_ERROR_SHARE = 0.8


@dataclass(frozen=True)
class RootStress:
    """Largest principal stresses (M, 2), MPa, in the fillets of pinion and gear for tooth pairs (M,)."""

    #: stress (M, 2), MPa, where the tangent is at 30 deg (internal teeth: 60); NaN without such a tangent
    bending: Array
    #: estimated relative error (M, 2) of `nominal`
    error: Array
    #: largest stress (M, 2), MPa, in the fillet below its border with the flank, without the contact's own field
    largest: Array
    #: point (M, 2, 3), mm, of the `largest` stress, own frame
    place: Array
    #: largest stress (M, 2), MPa, within the contact's own field, the field included; NaN if it does not reach the
    #: fillet
    contact: Array

    @property
    def nominal(self) -> Array:
        """Bending stress (M, 2), MPa; the largest stress in the fillet for a member without a tangent at 30 deg."""
        return np.where(np.isnan(self.bending).all(axis=0), self.largest, self.bending)

    def some(self, rows: NDArray[np.intp]) -> RootStress:
        """Return the stresses of some tooth pairs, `rows` (N,)."""
        return RootStress(*(values[rows] for values in vars(self).values()))

    @staticmethod
    def join(pinion: RootStress, gear: RootStress) -> RootStress:
        """Return the stresses of both members as one record.

        `pinion`: arrays (M,) of the pinion. `gear`: arrays (M,) of the gear. Result: arrays (M, 2).
        """
        return RootStress(
            *(
                np.stack(values_of_members, axis=1)
                for values_of_members in zip(vars(pinion).values(), vars(gear).values(), strict=True)
            )
        )

    def worst(self, values: Array, position: NDArray[np.intp], count: int) -> NDArray[np.intp]:
        """Return the tooth pair with the largest stress at each position.

        `values`: stresses of pinion and gear, MPa. `count`: number P of positions.
        """
        known = np.nan_to_num(values, nan=-np.inf)
        order = [np.lexsort((member_values, position)) for member_values in known.T]
        return np.stack(
            [rows[np.searchsorted(position[rows], np.arange(count), "right") - 1] for rows in order], axis=1
        )


@dataclass(frozen=True)
class Pressed:
    """Forces of tooth pairs (M,) on the flanks of one member."""

    #: forces (M, X), N, of the rows of cells
    line: Array
    #: points (M, X, 3), mm, of these forces, own frame
    places: Array
    #: number (M,) of the member's tooth, counted in the direction of motion
    teeth: NDArray[np.intp]
    #: pairs (C,) whose stress is computed, pairs (C,) that are loaded at the same position, and steps (C,) from the
    #: loaded tooth to the stressed tooth
    couples: tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]
    #: Poisson's ratio of the member
    poisson_ratio: float

    def field(self, body: FilletStress, places: Array, stress: Array) -> NDArray[np.bool_]:
        """Return the places (F, 3) with stresses (M, F), MPa, that lie in the contact's own field, (M, F)."""
        own_field = np.zeros(stress.shape, dtype=bool)
        loaded = self.line.any(axis=1)
        line, forces, min_distance = self.line[loaded], self.places[loaded], body.eighth
        along = unit(forces[:, -1] - forces[:, 0])
        cosines, sines = np.zeros((2, len(line), len(places)))
        near = np.zeros(cosines.shape, dtype=bool)
        # the forces, and their images behind both end faces
        for forces_at, axis in ((forces, along), *(end.images(forces, along) for end in body.ends)):
            # square of the distance r, and x = r cos phi, (M, F, X)
            square = (places**2).sum(axis=1)[:, None] + (forces_at**2).sum(axis=2)[:, None]
            square = np.maximum(square - 2.0 * places @ forces_at.swapaxes(1, 2), 0.0)
            x = (axis @ places.T)[:, :, None] - np.einsum("mxi,mi->mx", forces_at, axis)[:, None]
            # r^2 exp(2 i phi) over r^4
            weight = line[:, None] / np.maximum(square, min_distance**2) ** 2
            cosines += (weight * (2.0 * x**2 - square)).sum(axis=2)
            sines += (weight * (2.0 * x * np.sqrt(np.maximum(square - x**2, 0.0)))).sum(axis=2)
            near |= ((square < min_distance**2) & (line[:, None] > 0.0)).any(axis=2)
        # tension of a half-space beside the forces, not closer to them than an eighth of the flank
        tension = (1.0 - 2.0 * self.poisson_ratio) / (2.0 * np.pi) * np.hypot(cosines, sines)
        own_field[loaded] = near | (tension > OWN_FIELD_SHARE * np.maximum(stress[loaded], 0.0))
        return own_field


def root_stress(body: FilletStress, coarser: FilletStress | None, pressed: Pressed) -> RootStress:
    """Return the root stress of one member (M,); `coarser`: its stress on a coarser mesh, without which the error is
    NaN."""
    by_mesh = _by_mesh(body, pressed)
    if coarser is None:
        return by_mesh
    other, unknown = _bending(coarser, *_stresses(coarser, pressed)), np.full(len(pressed.line), np.nan)
    if np.isnan(by_mesh.bending).all():
        other = _by_mesh(coarser, pressed).largest
    change = np.abs(by_mesh.nominal - other)
    # a tooth that is only compressed has no bending stress
    share = np.divide(change, by_mesh.nominal, out=unknown, where=by_mesh.nominal != 0.0)
    return replace(by_mesh, error=MESH_ERROR_SHARE * share)


def _by_mesh(body: FilletStress, pressed: Pressed) -> RootStress:
    """Return the root stress of one member (M,) on one mesh; its error is NaN."""
    stress, contact_part = _stresses(body, pressed)
    whole, without_contact = principal_stresses(stress)[..., 2], principal_stresses(stress - contact_part)[..., 2]
    field = pressed.field(body, body.fillet, whole)
    contact = np.where(field.any(axis=1), np.where(field, whole, -np.inf).max(axis=1), np.nan)
    # beside a force, where its own field is compressive, the whole stress is the smaller one and counts
    counted = np.where(body.below_flank, np.minimum(whole, without_contact), -np.inf)
    bending = _bending(body, stress, contact_part)
    return RootStress(
        bending, np.full_like(bending, np.nan), counted.max(axis=1), body.fillet[counted.argmax(axis=1)], contact
    )


def _bending(body: FilletStress, stress: Array, contact_part: Array) -> Array:
    """Return the largest stress (M,) at the tangents of all stations; NaN without such a tangent.

    `stress` (M, F, 6): stresses at the nodes of the fillet. `contact_part`: their part that is the contact's own field.
    """
    if not len(body.tangent):
        return np.full(len(stress), np.nan)
    tangent_stress = (
        principal_stresses(np.einsum("kf,mfs->mks", body.tangent, part))[..., 2]
        for part in (stress, stress - contact_part)
    )
    bending: Array = np.minimum(*tangent_stress).max(axis=1)
    return bending


def _stresses(body: FilletStress, pressed: Pressed) -> tuple[Array, Array]:
    """Return stresses (M, F, 6), MPa, at the nodes of the fillets, and the part of them that is the contact's own
    field."""
    nodes, share = body.shares(pressed.places)
    # forces on the nodes of the flank: each force is shared by the four nodes around it
    force = np.zeros((len(nodes), body.stress.shape[-1]))
    rows = np.broadcast_to(np.arange(len(nodes))[:, None, None], nodes.shape)
    np.add.at(force, (rows, nodes), share * pressed.line[:, :, None])
    stresses, field = np.zeros((2, len(nodes), *body.stress.shape[1:3]))
    close = contact_tension(body)
    # stress of a tooth under its own load and under the load of its neighbours; only its own load has a contact field
    for stressed, loaded, tooth_step in zip(*pressed.couples, strict=True):
        loaded_body = body.of_tooth(pressed.teeth[loaded])
        stresses[stressed] += loaded_body.stress[tooth_step + loaded_body.reach] @ force[loaded]
        if tooth_step == 0:
            field[stressed] += (close if loaded_body is body else contact_tension(loaded_body)) @ force[loaded]
    return stresses, field


def contact_tension(body: FilletStress) -> Array:
    """Compute the contact's own stress (F, 6, n), MPa/N, in the fillet of the loaded tooth.

    It is the stress under unit forces at the flank's nodes. It is 0 for nodes at least `CLOSE_EIGHTHS` away from a
    place. For closer nodes it is the excess of their stress over the bending stress there. The bending stress is the
    stress of the nodes above, continued in a straight line down the flank. Where this line would rise towards the root,
    as at end faces, it is taken in proportion to the distance from the place instead.
    """
    rows, columns = body.points.shape[:2]
    stress = np.moveaxis(body.stress[body.reach].reshape(len(body.fillet), 6, rows, columns), 1, -1)
    # heights of the nodes along the flank, and distances (F, I, J) from the places to the nodes
    steps = np.linalg.norm(np.diff(body.points, axis=0), axis=-1)
    height = np.concatenate((np.zeros((1, columns)), np.cumsum(steps, axis=0)))
    lever = np.linalg.norm(body.fillet[:, None, None] - body.points, axis=-1)
    # the lowest row that is far enough, and the row above it, define the straight line
    far = lever >= CLOSE_EIGHTHS * body.eighth
    first_far_row = np.minimum(np.where(far.any(axis=1), far.argmax(axis=1), rows), rows - 2)[:, None]
    low, high = (np.take_along_axis(stress, first_far_row[..., None] + k, axis=1) for k in (0, 1))
    # heights (F, 1, J) of these two rows
    low_height, high_height = (
        np.take_along_axis(np.broadcast_to(height, far.shape), first_far_row + k, axis=1) for k in (0, 1)
    )
    rising = principal_stresses(high)[..., 2] > principal_stresses(low)[..., 2]
    straight = low + (height - low_height)[..., None] * (high - low) / (high_height - low_height)[..., None]
    falling = low * (lever / np.take_along_axis(lever, first_far_row, axis=1))[..., None]
    continued = np.where(rising[..., None], straight, falling)
    close = np.arange(rows)[:, None] < first_far_row
    excess = np.where(close[..., None], stress - continued, 0.0)
    return np.moveaxis(excess, -1, 1).reshape(body.stress.shape[1:])
