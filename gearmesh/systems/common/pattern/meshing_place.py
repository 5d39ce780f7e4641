"""Conditions of contact at given points of the gear's flank, with displacements of the members as unknowns.

For a point of the gear's flank the unknowns are the rotations of both gears, a point of the pinion's flank and
displacements. The flanks touch there if

    r1 = r2 (3),    n1 + n2 = 0 in the tangent plane (2),    n2 . (w1 x (r - o1) - w2 x (r - o2)) = 0

With two displacements these are six conditions for six unknowns. The last condition says that the gears turn at the
ratio of their teeth there, which is the vertex of the transmission error. With one displacement it is left out, which
gives five conditions for five unknowns. This case is for gears of uniform transmission, or nearly so, in any mounting
(worm drives). Their contact passes the point at some rotation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair


@dataclass(frozen=True)
class Moves:
    """Displacements by their letters, V, H, J and alpha, and their `keys` in the table assembly.

    V moves the pinion along the common perpendicular, pinion's axis x gear's axis, or the gear the opposite way. H and
    J are along the axes. alpha turns the gear about the common perpendicular, in the sense `opens` (1 or -1).
    """

    keys: Mapping[str, str]
    opens: float = 1.0

    def values(self, x: Array, moved: tuple[str, ...]) -> dict[str, Array]:
        """Return the displacements (N,) of unknowns x (N, 4 + K) by their keys of the table assembly: mm, deg."""
        values = {key: np.zeros(len(x)) for key in self.keys.values()}
        for k, name in enumerate(moved):
            values[self.keys[name]] = np.degrees(x[:, 4 + k]) if name == "alpha" else x[:, 4 + k]
        return values


@dataclass(frozen=True)
class MeshingPlace:
    """Residuals (mm) of the conditions of contact.

    The unknowns are x = (u1, v1, turn 1, turn 2, displacements), in mm and rad. Both members turn about their axes from
    their unturned positions.
    """

    #: the pair
    pair: GearPair
    #: jets (N,) of the points on the gear's flank, in its own frame
    mating: Jet
    #: letters of the displacements that are unknowns
    moved: tuple[str, ...]
    #: keys of the displacements
    moves: Moves
    #: positions of both members, displaced by assembly errors (N,) by key
    bases: Callable[[Mapping[str, Array]], tuple[Rigid, Rigid]]

    @property
    def _length(self) -> float:
        """Scale of the conditions on directions: the distance of the farthest point from the apex."""
        return float(np.linalg.norm(self.mating.r, axis=-1).max())

    def __call__(self, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return residuals (N, 4 + K) and their derivatives (N, 4 + K, 4 + K) for unknowns x (N, 4 + K)."""
        first, second = self.bases(self.moves.values(x, self.moved))
        # both flanks in the fixed frame, with the members displaced and turned
        axis1, axis2 = first.rotation[..., 2], second.rotation[..., 2]
        pinion_jet = self.pair.pinion.tooth.side(self.pair.flanks[0]).flank.jet(x[:, 0], x[:, 1])
        pinion_jet = pinion_jet.move(first @ Rigid.about_z(x[:, 2]))
        mating = Jet(*(getattr(self.mating, key)[index] for key in ("r", "n", "r_u", "r_v", "n_u", "n_v")))
        mating = mating.move(second @ Rigid.about_z(x[:, 3]))
        # the common perpendicular of both axes, about which the shaft angle opens
        across, still = unit(cross(axis1, axis2)), np.zeros_like(axis1)
        arm1, arm2 = pinion_jet.r - first.translation, mating.r - second.translation
        by_turn1, by_turn2 = cross(axis1, arm1), cross(axis2, arm2)
        # velocities by each displacement: of the pinion's point, the gear's point, and the gear's normal
        velocities = {
            "V": (across, still, still),
            "H": (axis1, still, still),
            "J": (still, axis2, still),
            "alpha": (still, self.moves.opens * cross(across, mating.r), self.moves.opens * cross(across, mating.n)),
        }
        moves = [velocities[name] for name in self.moved]
        count = 4 + len(moves)
        f, jacobian = np.zeros((len(x), 6)), np.zeros((len(x), 6, count))
        f[:, :3] = pinion_jet.r - mating.r
        columns = (pinion_jet.r_u, pinion_jet.r_v, by_turn1, -by_turn2, *(pinion - gear for pinion, gear, _ in moves))
        jacobian[:, :3] = np.stack(columns, axis=-1)
        # normals are opposite: n1 + n2 = 0 in two directions of the pinion's tangent plane, held fixed
        e1 = unit(pinion_jet.r_u)
        for row, direction in ((3, e1), (4, cross(pinion_jet.n, e1))):
            f[:, row] = self._length * dot(pinion_jet.n + mating.n, direction)
            columns = (
                pinion_jet.n_u,
                pinion_jet.n_v,
                cross(axis1, pinion_jet.n),
                cross(axis2, mating.n),
                *(turned for *_, turned in moves),
            )
            jacobian[:, row] = self._length * np.stack([dot(column, direction) for column in columns], axis=-1)
        # no sliding along the normal: pinion and gear turn by their signs, at the ratio of the teeth
        w1, w2 = (mount.sign * axis for mount, axis in zip(self.pair.mounts, (axis1, axis2), strict=True))
        w2 = self.pair.ratio * w2
        sliding = cross(w1, mating.r - first.translation) - cross(w2, arm2)
        f[:, 5] = dot(mating.n, sliding)
        jacobian[:, 5, 3] = dot(cross(axis2, mating.n), sliding) + dot(
            mating.n, cross(w1, by_turn2) - cross(w2, by_turn2)
        )
        for k, (pinion, gear, turned) in enumerate(moves):
            # a displacement of the gear moves its axis as well: only the velocity of the pinion changes
            carried = cross(w1, mating.r - first.translation)
            jacobian[:, 5, 4 + k] = dot(mating.n, cross(w1, gear - pinion)) + dot(turned, carried)
        # with one displacement the gears need not turn at the ratio of their teeth
        return f[:, :count], jacobian[:, :count]
