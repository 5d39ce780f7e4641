"""Distance of the tips of one gear from the root of the other over the whole face.

Tip lands with their chamfers and roundings are moved through the mesh. The root of the mating gear is a surface of revolution,
so its level function gives the distance of a point. The least distance is sampled over the face and several pitches, then
searched on lattices that become finer.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearmesh.contact.first_touch.spline_table import SplineTable
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.region import TIP_EDGES, Region

#: rotations phi1 of the pinion (N,), rad -> those of the gear
Turns = Callable[[Array], Array]
#: points across a land or a broken edge
POINTS_ACROSS = 5
#: pitches before and after the middle of the mesh over which a tooth is followed
PITCHES_EACH_WAY = 3
#: positions of the pinion in a pitch
POSITIONS_PER_PITCH = 8
#: lattices about the place of the least distance
REFINING_ROUNDS = 10
#: step of a lattice by the step of the lattice before
STEP_SHRINKAGE = 0.4
#: distances (mm) that differ by less are equal: on parallel axes the least distance is the same all along the face
EQUAL_DISTANCE_MM = 1e-9


@dataclass(frozen=True)
class Clearance:
    """Least distance (mm) of a member's tips from its mating gear's root, negative inside the root.

    phi1 (rad) of the pinion and the point of the tip (3,), fixed frame, mm, belong to the least distance. Of equal places the
    search returns the place nearest to the middle of the face and to phi1 = 0.
    """

    distance: float
    phi1: float
    point: Array


def tip_clearance(pair: GearPair, phi2: Turns, of: int) -> Clearance | None:
    """Compute the clearance of the tips of the pinion (`of` 0) or the gear (1) over the mating gear's root.

    The gear stands at phi2(phi1). Returns None where no tip ever passes the face of the mating gear.
    """
    tooth, mating = pair.both[of].one_tooth, pair.both[1 - of].one_tooth
    stations = len(tooth.even.t)
    low, high = sorted(mating.blank.extent)

    def place(phi1: Array, tip: Array) -> tuple[Array, Array]:
        """Return points (M, 3) of the tips in the fixed frame and in the frame of the mating gear."""
        mounts = [mount.at(turn) for mount, turn in zip(pair.mounts, (phi1, phi2(phi1)), strict=True)]
        fixed = mounts[of].point(tip)
        return fixed, mounts[1 - of].inverse.point(fixed)

    def distance(r: Array) -> Array:
        """Return distances (M,), mm, of points (M, 3) in the mating gear's frame, inf beside its face and at unknown phi2."""
        station = mating.blank.axial.value(r)
        # faces of equal widths end together: rounding must not put a tip beside the face
        over = (station >= low - EQUAL_DISTANCE_MM) & (station <= high + EQUAL_DISTANCE_MM)
        return np.where(over, mating.blank.root.value(r), np.inf)

    least: Clearance | None = None
    middle = np.array([0.0, 0.5 * (POINTS_ACROSS - 1), 0.5 * (stations - 1)])
    for region in (Region.LAND, *TIP_EDGES.values()):
        if region not in tooth.regions:
            continue
        grid = tooth.grid(region, np.linspace(0.0, 1.0, POINTS_ACROSS), tooth.even).points
        tables = [SplineTable.of(grid[..., axis]) for axis in range(3)]
        steps = np.array([pair.pitch / POSITIONS_PER_PITCH, 1.0, 1.0])
        many = np.arange(-PITCHES_EACH_WAY * POSITIONS_PER_PITCH, PITCHES_EACH_WAY * POSITIONS_PER_PITCH + 1) * steps[0]
        x = _every_place(many, np.arange(float(POINTS_ACROSS)), np.arange(float(stations)))
        ways = _every_place(*[np.linspace(-1.0, 1.0, 5)] * 3)
        for _ in range(REFINING_ROUNDS):
            tip = np.stack([table.at(x[:, 1], x[:, 2]) for table in tables], axis=-1)
            fixed, own = place(x[:, 0], tip)
            apart = distance(own)
            if not np.isfinite(apart.min()):
                break
            equal = np.flatnonzero(apart <= apart.min() + EQUAL_DISTANCE_MM)
            k = int(equal[np.lexsort(np.abs(np.round(x[equal].T - middle[:, None], 6)))[0]])
            if least is None or apart[k] < least.distance - EQUAL_DISTANCE_MM:
                least = Clearance(float(apart[k]), float(x[k, 0]), fixed[k])
            x = x[k] + ways * steps
            x[:, 1], x[:, 2] = np.clip(x[:, 1], 0.0, POINTS_ACROSS - 1.0), np.clip(x[:, 2], 0.0, stations - 1.0)
            steps = steps * STEP_SHRINKAGE
    return least


def _every_place(*values: Array) -> Array:
    """Return every combination (M, 3) of three lists of values; the last value changes first."""
    return np.stack([places.ravel() for places in np.meshgrid(*values, indexing="ij")], axis=-1)
