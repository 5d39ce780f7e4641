"""Positions of the members of bevel pairs in many assemblies at once: the errors of `pair.displaced_frames` as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, rotation_about, unit
from gearmesh.systems.common.axes import shifts
from gearmesh.systems.system import Displacements

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.design import BevelDesign
    from gearmesh.teeth.gear_train import GearTrain
    from gearmesh.teeth.mount import Mount


def displaced_bases(mounts: tuple[Mount, Mount], errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
    """Bases of pinion and gear, moved from `mounts` by assembly errors (M,), mm and deg, by key of the table assembly.

    The errors refer to the frame of the axes: z along the pinion's axis, y along the common perpendicular.
    """
    pinion, gear = (mount.base for mount in mounts)
    z = pinion.rotation[:, 2]
    y = unit(cross(z, gear.rotation[:, 2]))
    axes_to_fixed = np.stack((cross(y, z), y, z), axis=-1)
    opened = axes_to_fixed @ rotation_about("y", np.radians(errors["d_delta"])) @ axes_to_fixed.T
    moved = shifts(0.0, errors["dV"], errors["dA"]) @ axes_to_fixed.T
    along = Rigid(np.eye(3), shifts(0.0, 0.0, errors["dG"]))
    still = np.broadcast_to(pinion.rotation, opened.shape)
    return Rigid(still, pinion.translation + moved), Rigid(opened, np.zeros(3)) @ gear @ along


def _bases(design: BevelDesign, train: GearTrain, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
    """Return the bases of the first pair of a gear set."""
    return displaced_bases(train.pairs[0].mounts, errors)


#: keys of the assembly errors, and the bases that they displace
ASSEMBLY_DISPLACEMENTS: Displacements[BevelDesign] = Displacements(("dA", "dG", "dV", "d_delta"), _bases)
