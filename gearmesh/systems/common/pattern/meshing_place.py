"""Conditions under which flanks touch at given points of the gear's, and the displacements of the members that bring them there.

For a point of the gear's flank there are a rotation of either gear, a point of the pinion's flank and displacements at which the
flanks touch there:

    r1 = r2 (3),    n1 + n2 = 0 in the tangent plane (2),    n2 . (w1 x (r - o1) - w2 x (r - o2)) = 0

With two displacements these are six conditions of six unknowns: the last says that the gears turn at the ratio of their teeth
there, the vertex of the transmission error. With one displacement it is left out, five of five: for gears of uniform
transmission, or nearly so, however they are mounted (worm drives), and whose contact passes the point at some rotation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.surface import Jet
from gearmesh.teeth.gear_train import GearPair


@dataclass(frozen=True)
class Moves:
    """Displacements by their letters, V, H, J and alpha, and their `keys` of the table assembly.

    `opens`: sense (1 or -1) in which alpha turns the gear about the common perpendicular, pinion's axis x gear's axis. V brings the
    pinion that way, or the gear the other way; H and J go along the axes.
    """

    keys: Mapping[str, str]
    opens: float = 1.0

    def values(self, x: Array, moved: tuple[str, ...]) -> dict[str, Array]:
        """The displacements (N,) of unknowns x (N, 4 + K) by their keys of the table assembly: mm, deg."""
        values = {key: np.zeros(len(x)) for key in self.keys.values()}
        for k, name in enumerate(moved):
            values[self.keys[name]] = np.degrees(x[:, 4 + k]) if name == "alpha" else x[:, 4 + k]
        return values


@dataclass(frozen=True)
class MeshingPlace:
    """Residuals, mm, of unknowns x = (u1, v1, turn 1, turn 2, and the displacements `moved`: mm, rad); `mating` (N,): the gear's
    jets, its own frame.

    Both members turn about their axes, from their unturned positions. `bases` gives those of both members, displaced by errors (N,)
    of the table assembly under the keys of `moves`.
    """

    pair: GearPair
    mating: Jet
    moved: tuple[str, ...]
    moves: Moves
    bases: Callable[[Mapping[str, Array]], tuple[Rigid, Rigid]]

    @property
    def _length(self) -> float:
        """Scale of the conditions on directions: the farthest point's distance from the apex."""
        return float(np.linalg.norm(self.mating.r, axis=-1).max())

    def __call__(self, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        first, second = self.bases(self.moves.values(x, self.moved))
        axis1, axis2 = first.rotation[..., 2], second.rotation[..., 2]
        own = self.pair.pinion.tooth.side(self.pair.flanks[0]).flank.jet(x[:, 0], x[:, 1])
        own = own.move(first @ Rigid.about_z(x[:, 2]))
        mating = Jet(*(getattr(self.mating, key)[index] for key in ("r", "n", "r_u", "r_v", "n_u", "n_v")))
        mating = mating.move(second @ Rigid.about_z(x[:, 3]))
        # the common perpendicular of both axes, about which the shaft angle opens
        across, still = unit(cross(axis1, axis2)), np.zeros_like(axis1)
        arm1, arm2 = own.r - first.translation, mating.r - second.translation
        by_turn1, by_turn2 = cross(axis1, arm1), cross(axis2, arm2)
        # how each displacement moves the pinion, the gear, and the gear's normals
        ways = {
            "V": (across, still, still),
            "H": (axis1, still, still),
            "J": (still, axis2, still),
            "alpha": (still, self.moves.opens * cross(across, mating.r), self.moves.opens * cross(across, mating.n)),
        }
        moves = [ways[name] for name in self.moved]
        count = 4 + len(moves)
        f, jacobian = np.zeros((len(x), 6)), np.zeros((len(x), 6, count))
        f[:, :3] = own.r - mating.r
        columns = (own.r_u, own.r_v, by_turn1, -by_turn2, *(pinion - gear for pinion, gear, _ in moves))
        jacobian[:, :3] = np.stack(columns, axis=-1)
        # in two directions of the pinion's tangent plane, held fixed
        e1 = unit(own.r_u)
        for row, direction in ((3, e1), (4, cross(own.n, e1))):
            f[:, row] = self._length * dot(own.n + mating.n, direction)
            columns = (own.n_u, own.n_v, cross(axis1, own.n), cross(axis2, mating.n), *(turned for *_, turned in moves))
            jacobian[:, row] = self._length * np.stack([dot(column, direction) for column in columns], axis=-1)
        # the pinion turns by its sign, the gear by its own, at the ratio of the teeth
        w1, w2 = (mount.sign * axis for mount, axis in zip(self.pair.mounts, (axis1, axis2), strict=True))
        w2 = self.pair.ratio * w2
        sliding = cross(w1, mating.r - first.translation) - cross(w2, arm2)
        f[:, 5] = dot(mating.n, sliding)
        jacobian[:, 5, 3] = dot(cross(axis2, mating.n), sliding) + dot(
            mating.n, cross(w1, by_turn2) - cross(w2, by_turn2)
        )
        for k, (pinion, gear, turned) in enumerate(moves):
            # what moves the gear moves its axis as well: only what the pinion's rotation does changes
            carried = cross(w1, mating.r - first.translation)
            jacobian[:, 5, 4 + k] = dot(mating.n, cross(w1, gear - pinion)) + dot(turned, carried)
        # with one displacement the gears need not turn at the ratio of their teeth
        return f[:, :count], jacobian[:, :count]
