"""Stress in the fillets of teeth in contact: bending, and apart from it what the contact itself does next to it.

Bending is the largest principal stress where the tangent of the fillet is at 30 deg to the tooth (`root_tangent`). The largest in
the fillet may be elsewhere, but where flanks are pressed close to their lower end it is the tension round the contact, no bending.
On a half-space (Boussinesq) a force F puts on the surface, r away and phi from x, beside it

    s_rr = -s_tt = (1 - 2 nu) F / (2 pi r^2), or together   (s_xx - s_yy) / 2 + i s_xy = sum (1 - 2 nu) F exp(2 i phi) / (2 pi r^2)

which falls off slowly next to points and the ends of lines, and adds up to nothing beside the middle of a line; next to an end face
there is as much again, of the forces' images behind it. Places at which this is more than `OWN` of what there is are the contact's
own field, and so are those within an eighth of the flank, about an element, of what is pressed.
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
#: what is left to the limit over the difference from a mesh three quarters as fine each way: 0.2 to 1.3 in plane strain under loads
#: in the flank's upper half, held against converged meshes (involute teeth, pinions of 12 to rings, and those with sharp fillets)
LEFT = 0.8


@dataclass(frozen=True)
class RootStress:
    """Of tooth pairs (M,), pinion and gear: stresses (M, 2), MPa, largest principal ones.

    `bending` where the tangents are at 30 deg (internal teeth: 60), NaN where none are away from the contact; the estimate of the
    `error` of what is `nominal`, a share of it; `largest` in the fillet away from the contact, NaN where there is nothing of it,
    and its `place` (M, 2, 3), own frame; `contact`: in the contact's own field, NaN where it does not reach the fillet.
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
    stress = _stresses(body, pressed)
    bending = _bending(body, stress, pressed)
    every = principal_stresses(stress)[..., 2]
    field = pressed.field(body, body.fillet, every)
    away, within = np.where(field, -np.inf, every), np.where(field, every, -np.inf)
    contact = np.where(field.any(axis=1), within.max(axis=1), np.nan)
    largest = np.where(field.all(axis=1), np.nan, away.max(axis=1))
    return RootStress(bending, np.full_like(bending, np.nan), largest, body.fillet[away.argmax(axis=1)], contact)


def _stresses(body: FilletStress, pressed: Pressed) -> Array:
    """Stresses (M, F, 6), MPa, at the nodes of the fillets."""
    nodes, share = body.shares(pressed.places)
    force = np.zeros((len(nodes), body.stress.shape[-1]))
    rows = np.broadcast_to(np.arange(len(nodes))[:, None, None], nodes.shape)
    np.add.at(force, (rows, nodes), share * pressed.line[:, :, None])
    stresses = np.zeros((len(nodes), *body.stress.shape[1:3]))
    for stressed, loaded, way in zip(*pressed.couples, strict=True):
        own = body.of_tooth(pressed.teeth[loaded])
        stresses[stressed] += own.stress[way + own.reach] @ force[loaded]
    return stresses


def _bending(body: FilletStress, stress: Array, pressed: Pressed) -> Array:
    """The largest (M,) where the tangent is at 30 deg, of all stations away from the contact; NaN without."""
    if not len(body.tangent):
        return np.full(len(stress), np.nan)
    bending = principal_stresses(np.einsum("kf,mfs->mks", body.tangent, stress))[..., 2]
    away = ~pressed.field(body, body.tangent @ body.fillet, bending)
    return np.where(away.any(axis=1), np.where(away, bending, -np.inf).max(axis=1), np.nan)
