"""Contact of a gear pair: its trimmed flanks handed to the solver, which knows nothing of teeth."""

from __future__ import annotations

import numpy as np

from gearmesh.assembly import Mount
from gearmesh.frames import Array
from gearmesh.meshing import Flank
from gearmesh.pair import GearPair, Member
from gearmesh.path import ContactPath
from gearmesh.surface import ConeLevel, Shifted
from gearmesh.tca import Pair, contact_path
from gearmesh.tooth import Side, Tooth

#: points of the start grid across and along a flank
START_GRID = (9, 11)
#: stations at which the joint of flank and fillet is sampled
JOINT_STATIONS = 33


def solver_pair(pair: GearPair) -> Pair:
    """The two touching flanks of a gear pair, mounted, as the solver wants them."""
    return Pair(
        pinion=contact_flank(pair.pinion, pair.flanks[0], pair.assembly.pinion),
        gear=contact_flank(pair.gear, pair.flanks[1], pair.assembly.gear),
        ratio=pair.assembly.ratio,
        drive=pair.drive,
        delta=pair.delta,
    )


def analyse(pair: GearPair, phi1: Array) -> ContactPath:
    """Contact path of a gear pair at phi1 (P,), rad, counted as its source counts it."""
    return contact_path(solver_pair(pair), phi1, pair.generation)


def contact_flank(member: Member, side: str, mount: Mount) -> Flank:
    """One trimmed flank ("right" or "left") of a member in its mounting.

    Raises TrimError where the tooth cannot be trimmed.
    """
    tooth = member.tooth
    grid = tooth.flank_grid(side, np.linspace(0.0, 1.0, START_GRID[0]), np.linspace(0.0, 1.0, START_GRID[1]))
    assert grid.p is not None
    assert grid.v is not None
    axial, (toe, heel) = tooth.blank.axial, tooth.blank.extent
    tip_point = grid.points[-1, START_GRID[1] // 2]
    tip = ConeLevel(float(np.hypot(*tip_point[:2]) - tooth.blank.tip.slope * tip_point[2]), tooth.blank.tip.slope)
    return Flank(
        surface=getattr(tooth, side).flank,
        mount=mount,
        edges={"tip": tip, "toe": Shifted(axial, toe, -1.0), "heel": Shifted(axial, heel)},
        axial=axial,
        extent=(toe, heel),
        grid=np.stack((grid.p, grid.v), axis=-1),
        beyond_joint=_Joint(tooth, getattr(tooth, side), side),
    )


class _Joint:
    """How far (mm along the profile) flank points lie past the joint with the fillet, interpolated between stations."""

    def __init__(self, tooth: Tooth, side: Side, name: str) -> None:
        t = np.linspace(0.0, 1.0, JOINT_STATIONS)
        ends = getattr(tooth.sections(t), name)
        middle = JOINT_STATIONS // 2
        half_way = np.array(0.5 * (ends.joint_flank[middle] + ends.tip[middle]))
        speed = float(np.linalg.norm(side.flank.jet(half_way, np.array(0.0)).r_u))
        self._axial = tooth.blank.axial
        self._stations, self._joint = tooth.stations(t), ends.joint_flank
        self._scale = speed * float(np.sign(ends.joint_flank[middle] - ends.tip[middle]))

    def __call__(self, parameters: Array, r: Array) -> Array:
        joint = np.interp(self._axial.value(r), self._stations, self._joint)
        return self._scale * (parameters[..., 0] - joint)
