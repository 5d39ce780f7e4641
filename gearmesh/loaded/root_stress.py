"""Stress in the fillets of teeth in contact: bending, and apart from it what the contact itself does next to it.

Bending is the largest principal stress where the tangent of the fillet is at 30 deg to the tooth (`root_tangent`). The largest in
the fillet may be elsewhere, but where flanks are pressed close to their lower end it is the tension round the contact, no bending.

A force that moves down the flank bends the fillet less and less, in proportion to its lever, until it is so close that the tension
round the contact rises like 1/r^2. Forces nearer than half the height of the flank count by their bending alone: the stress of
forces further up, continued in a straight line (`contact_tension`). Places are never left out, so that stress is continuous while
a contact passes them.

The contact's own field is reported apart. On a half-space (Boussinesq) a force F puts on the surface beside it, r away and phi from
x,

    s_rr = -s_tt = (1 - 2 nu) F / (2 pi r^2), or together   (s_xx - s_yy) / 2 + i s_xy = sum (1 - 2 nu) F exp(2 i phi) / (2 pi r^2)

which falls off slowly next to points and the ends of lines, and adds up to nothing beside the middle of a line; next to an end face
there is as much again, of the forces' images behind it. Places at which this is more than `OWN` of what there is are in the
contact's own field, and so are those within an eighth of the flank, about an element, of what is pressed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.fe.results import principal_stresses
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.loaded.compliance.compliance import FilletStress

#: share of the stress at a place from which on that is the contact's own
OWN = 0.1
#: eighths of the flank's height up to which a force is so close to a place that the contact's own field counts there: of a line of
#: contact the stress falls with the lever down to 4 of them
CLOSE_EIGHTHS = 4.0
#: what is left to the limit over the difference from a mesh three quarters as fine each way: 0.2 to 1.3 in plane strain under loads
#: in the flank's upper half, held against converged meshes (involute teeth, pinions of 12 to rings, and those with sharp fillets)
LEFT = 0.8


@dataclass(frozen=True)
class RootStress:
    """Of tooth pairs (M,), pinion and gear: stresses (M, 2), MPa, largest principal ones.

    `bending` where the tangents are at 30 deg (internal teeth: 60), NaN where none are; the estimate of the `error` of what is
    `nominal`, a share of it; `largest` in the fillet without the contact's own field, and its `place` (M, 2, 3), own frame;
    `contact`: in the contact's own field, with it, NaN where it does not reach the fillet.
    """

    bending: Array
    error: Array
    largest: Array
    place: Array
    contact: Array

    @property
    def nominal(self) -> Array:
        """Bending stress (M, 2), MPa: where no tangent is at 30 deg at all the largest in the fillet."""
        return np.where(np.isnan(self.bending).all(axis=0), self.largest, self.bending)

    @staticmethod
    def join(pinion: RootStress, gear: RootStress) -> RootStress:
        """Stresses of both members in one.

        Parameters
        ----------
        pinion : RootStress
            Arrays (M,) of the pinion.
        gear : RootStress
            The same of the gear.

        Returns
        -------
        RootStress
            Arrays (M, 2).

        Examples
        --------
        >>> one = gm.RootStress(*(np.ones(3) for _ in range(5)))
        >>> gm.RootStress.join(one, one).bending.shape
        (3, 2)
        """
        return RootStress(
            *(np.stack(both, axis=1) for both in zip(vars(pinion).values(), vars(gear).values(), strict=True))
        )

    def worst(self, values: Array, position: NDArray[np.intp], count: int) -> NDArray[np.intp]:
        """Which tooth pair is stressed most at each position.

        Parameters
        ----------
        values : numpy.ndarray of float (M, 2)
            Stresses of pinion and gear, MPa.
        position : numpy.ndarray of int (M,)
            Position of each pair.
        count : int
            Positions P.

        Returns
        -------
        numpy.ndarray of int (P, 2)
            Numbers of the pairs, of pinion and gear.

        Examples
        --------
        >>> stress = gm.RootStress(*(np.ones((3, 2)) for _ in range(5)))
        >>> stress.worst(np.array([[1.0, 3.0], [2.0, 1.0], [5.0, 5.0]]), np.array([0, 0, 1]), 2).tolist()
        [[1, 0], [2, 2]]
        """
        known = np.nan_to_num(values, nan=-np.inf)
        order = [np.lexsort((own, position)) for own in known.T]
        return np.stack(
            [rows[np.searchsorted(position[rows], np.arange(count), "right") - 1] for rows in order], axis=1
        )


@dataclass(frozen=True)
class Pressed:
    """What tooth pairs (M,) put on the flanks of a member: forces `line` (M, X), N, at `places` (M, X, 3), own frame.

    `teeth` (M,): the member's teeth, counted the way it moves; `couples`: pairs (C,) that are stressed and that are loaded at one
    position, and the way (C,) from the loaded tooth to the stressed one.
    """

    line: Array
    places: Array
    teeth: NDArray[np.intp]
    couples: tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]
    poisson_ratio: float

    def field(self, body: FilletStress, places: Array, stress: Array) -> NDArray[np.bool_]:
        """Whether places (F, 3) with stresses (M, F), MPa, are in the contact's own field."""
        along, least = unit(self.places[:, -1] - self.places[:, 0]), body.eighth
        own, near = np.zeros(stress.shape, dtype=complex), np.zeros(stress.shape, dtype=bool)
        for pressed, axis in ((self.places, along), *(end.images(self.places, along) for end in body.ends)):
            way = places[None, :, None] - pressed[:, None]
            x, square = np.einsum("mfxi,mi->mfx", way, axis), (way**2).sum(axis=-1)
            # (r cos phi + i r sin phi)^2 = r^2 exp(2 i phi)
            twice = (x + 1j * np.sqrt(np.maximum(square - x**2, 0.0))) ** 2
            own += (self.line[:, None] * twice / np.maximum(square, least**2) ** 2).sum(axis=2)
            near |= ((square < least**2) & (self.line[:, None] > 0.0)).any(axis=2)
        tension = (1.0 - 2.0 * self.poisson_ratio) / (2.0 * np.pi) * np.abs(own)
        own_field: NDArray[np.bool_] = near | (tension > OWN * np.maximum(stress, 0.0))
        return own_field


def root_stress(body: FilletStress, coarser: FilletStress | None, pressed: Pressed) -> RootStress:
    """Of one member (M,); `coarser`: its stress by a coarser mesh, without which the error is NaN."""
    by_mesh = _by_mesh(body, pressed)
    if coarser is None:
        return by_mesh
    error = LEFT * np.abs(by_mesh.nominal - _by_mesh(coarser, pressed).nominal) / by_mesh.nominal
    return replace(by_mesh, error=error)


def _by_mesh(body: FilletStress, pressed: Pressed) -> RootStress:
    """Of one member (M,) by one mesh, its error unknown."""
    stress, own = _stresses(body, pressed)
    every, bent = principal_stresses(stress)[..., 2], principal_stresses(stress - own)[..., 2]
    field = pressed.field(body, body.fillet, every)
    contact = np.where(field.any(axis=1), np.where(field, every, -np.inf).max(axis=1), np.nan)
    # beside forces, where their own field presses, the whole is the smaller one
    away = np.minimum(every, bent)
    bending = np.full(len(away), np.nan)
    if len(body.tangent):
        both = (
            principal_stresses(np.einsum("kf,mfs->mks", body.tangent, part))[..., 2] for part in (stress, stress - own)
        )
        bending = np.minimum(*both).max(axis=1)
    return RootStress(
        bending, np.full_like(bending, np.nan), away.max(axis=1), body.fillet[away.argmax(axis=1)], contact
    )


def _stresses(body: FilletStress, pressed: Pressed) -> tuple[Array, Array]:
    """Stresses (M, F, 6), MPa, at the nodes of the fillets, and what of them is the contact's own field."""
    nodes, share = body.shares(pressed.places)
    force = np.zeros((len(nodes), body.stress.shape[-1]))
    rows = np.broadcast_to(np.arange(len(nodes))[:, None, None], nodes.shape)
    np.add.at(force, (rows, nodes), share * pressed.line[:, :, None])
    stresses, field = np.zeros((2, len(nodes), *body.stress.shape[1:3]))
    close = contact_tension(body)
    for stressed, loaded, way in zip(*pressed.couples, strict=True):
        own = body.of_tooth(pressed.teeth[loaded])
        stresses[stressed] += own.stress[way + own.reach] @ force[loaded]
        if way == 0:
            field[stressed] += (close if own is body else contact_tension(own)) @ force[loaded]
    return stresses, field


def contact_tension(body: FilletStress) -> Array:
    """Stress (F, 6, n), MPa/N, in the fillet of the loaded tooth that is the contact's own under unit forces at the flank's nodes.

    Of nodes closer to a place than `CLOSE_EIGHTHS` it is what their stress has beyond that of the nodes above, continued in a
    straight line down the flank; where that would rise towards the root, as at end faces, in proportion to the distance from the
    place. Of all others it is 0.
    """
    rows, columns = body.points.shape[:2]
    stress = np.moveaxis(body.stress[body.reach].reshape(len(body.fillet), 6, rows, columns), 1, -1)
    steps = np.linalg.norm(np.diff(body.points, axis=0), axis=-1)
    height = np.concatenate((np.zeros((1, columns)), np.cumsum(steps, axis=0)))
    lever = np.linalg.norm(body.fillet[:, None, None] - body.points, axis=-1)
    far = lever >= CLOSE_EIGHTHS * body.eighth
    first = np.minimum(np.where(far.any(axis=1), far.argmax(axis=1), rows), rows - 2)[:, None]
    low, high = (np.take_along_axis(stress, first[..., None] + k, axis=1) for k in (0, 1))
    # heights (F, 1, J) of the two rows that are continued
    at, above = (np.take_along_axis(np.broadcast_to(height, far.shape), first + k, axis=1) for k in (0, 1))
    rising = principal_stresses(high)[..., 2] > principal_stresses(low)[..., 2]
    straight = low + (height - at)[..., None] * (high - low) / (above - at)[..., None]
    falling = low * (lever / np.take_along_axis(lever, first, axis=1))[..., None]
    continued = np.where(rising[..., None], straight, falling)
    close = np.arange(rows)[:, None] < first
    own = np.where(close[..., None], stress - continued, 0.0)
    return np.moveaxis(own, -1, 1).reshape(body.stress.shape[1:])
