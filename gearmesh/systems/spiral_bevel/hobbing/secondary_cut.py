"""Cuts of a face-hobbing head beside those that make a flank: secondary cuts, and a second pass over the blank.

**Secondary cut.** Inner and outer blades follow each other through one space. Both together must clear its widest
slot, so that a blade is half as wide as that slot. Where the slot tapers, the back of a blade may reach the flank that
the blades of the other side have finished. The back is a straight edge b(u) in the blade's face, parallel to
that flank in its middle. With the head's rotation theta and the cradle's roll q it is at r(u, theta, q) on the blank. It
reaches furthest into the blank where

    det(r_u, r_theta, r_q) = 0,

so that the surface which it leaves is an envelope as that of a cutting edge is. The room between a point P of the flank
with the normal n and this surface S is x in S(u, v) = P + x n. The flank is cut where x < 0.

**Second pass.** The circle of the blades crosses the blank's cone distances twice. Beside the spaces that it cuts, the
tip of a blade must be outside the blank, at all rolls at which it cuts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import VagueError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, about_z, unit
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.surface.stations import follow
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.blank import MemberBlank
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.pair import MATING_SIDES, Angles
from gearmesh.systems.spiral_bevel.sheet.dimension_sheet import BLADE_OVERLAP_MM
from gearmesh.systems.spiral_bevel.sheet.slots import slot_widths
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.teeth.section import Grid
from gearmesh.teeth.tooth import Tooth
from gearmesh.tools.head_cutter import Blade

#: shares of the height of a flank, from form point to tip, at which its room is known
ROOM_HEIGHTS = np.array([0.0, 0.5, 1.0])
#: shares of the face, from toe to heel, at which slots and rooms are known
ROOM_STATIONS = np.linspace(0.0, 1.0, 5)
#: all points of a grid of these heights and stations
WHOLE_GRID = (slice(None), slice(None))
#: the point in its middle
MIDDLE_POINT = (slice(1, 2), slice(2, 3))
#: residual (mm) of a point on a normal
ROOM_TOLERANCE_MM = 1e-11
#: difference of shares of the face that is rounding
STATION_TOLERANCE = 1e-9
#: rounds in which a blade's back becomes parallel to a flank; each gains two digits
BACK_ROUNDS = 2
#: depth (mm) of a secondary cut that is reported
LEAST_CUT_MM = 1e-4
#: narrowest slot, in point widths, from which on no exact room is needed: small heads have 0.25 widths less than the slots
WIDE_SLOT_BLADES = 1.35
#: number of cone distances at which the rolls of a pass are known
PASS_STATIONS = 3
#: number of rolls at which the pass of a head is followed
PASS_ROLLS = 7
#: number of rotations of a head at which its pass is followed
PASS_ROTATIONS = 720
#: rotations beside those that cut a flank, over these, in which tips enter the same space: those of the ends of the roll
BESIDE_SHARE = 0.5


def blade_width(tooth: Tooth) -> float:
    """Return the point width (mm) of blades that together clear the widest slot of a tooth."""
    return _blade_and_narrowest(tooth)[0]


def slots_are_wide(tooth: Tooth) -> bool:
    """Return True where such blades leave so much room in the narrowest slot that no blade of one crown gear cuts a flank."""
    width, narrowest = _blade_and_narrowest(tooth)
    return narrowest > WIDE_SLOT_BLADES * width


def _blade_and_narrowest(tooth: Tooth) -> tuple[float, float]:
    """Return the point width of blades that clear the widest slot of a tooth, and the narrowest slot, mm."""
    slots = slot_widths(tooth, tooth.stations(ROOM_STATIONS))
    return 0.5 * (float(slots.max()) + BLADE_OVERLAP_MM), float(slots.min())


@dataclass(frozen=True)
class SecondaryCut:
    """Room between a finished flank and the backs of the blades that cut the other side of the space."""

    #: least room at the stations ROOM_STATIONS (T,), mm along the normals; < 0: a secondary cut; inf: far away
    room: Array
    #: shares of the face at which the cut begins or ends
    ends: Array
    #: back of the blades that cut the other side
    back: Generated

    @property
    def least(self) -> float:
        """Least room (mm) over the face; < 0: the depth of the secondary cut."""
        return float(self.room.min())

    @property
    def at_heel(self) -> bool:
        """True if the least room is nearer to the heel than to the toe."""
        return bool(self.room.argmin() > 0.5 * (len(self.room) - 1))


def secondary_cut(
    name: str, sides: Mapping[str, Generated], places: Angles, tooth: Tooth, width: float
) -> SecondaryCut:
    """Return the room of the flank `name`, "concave" or "convex", of a member to the blades of its other side.

    - `sides`: sides of the member
    - `places`: index positions of the sides, rad
    - `tooth`: tooth of the member
    - `width`: point width of the blades, mm
    """
    side, other = sides[name], sides[MATING_SIDES[name]]
    turn = -tooth.pitch_angle if side.flank is Side.RIGHT else tooth.pitch_angle
    place = places[MATING_SIDES[name]] + turn
    back = blade_back(side, other, width)
    grid = tooth.flank_grid(side.flank, ROOM_HEIGHTS, ROOM_STATIONS)
    for _ in range(BACK_ROUNDS):
        # parallel to the flank in its middle
        _, jet = _met(back, place, side, grid, MIDDLE_POINT)
        leaning = float((grid.normals[MIDDLE_POINT][0, 0] @ unit(jet.r_u)[0]).item())
        if not np.isfinite(leaning):
            break
        back = blade_back(side, other, width, back.blade.blade_angle + np.arcsin(leaning))
    room = _met(back, place, side, grid)[0].reshape(grid.points.shape[:-1])
    least = np.where(np.isnan(room), np.inf, room)
    height = least.min(axis=1).argmin()
    (before,) = np.nonzero(np.diff(least[height] < 0.0))
    roots = bracketed_root(
        lambda t, _: _met(back, place, side, tooth.flank_grid(side.flank, ROOM_HEIGHTS[[height]], t))[0],
        ROOM_STATIONS[before],
        ROOM_STATIONS[before + 1],
        tolerance=STATION_TOLERANCE,
    )
    return SecondaryCut(least.min(axis=0), roots.values[roots.converged], back)


def blade_back(side: Generated, other: Generated, width: float, angle: float | None = None) -> Generated:
    """Return the straight back of the `other` side's blades, of a point width (mm), as a blade that cuts the `side`.

    `angle` (rad) is that between back and axis of the head; by default that of the side's own blade.
    """
    own = side.blade
    angle = own.blade_angle if angle is None else angle
    tip_radius = other.blade.tip_radius - other.blade.side * width
    return replace(other, blade=Blade(own.side, tip_radius, angle, 0.0))


def _met(
    back: Generated, place: float, side: Generated, grid: Grid, part: tuple[slice, slice] = WHOLE_GRID
) -> tuple[Array, Jet]:
    """Return the distances (N,), mm, from points of a flank along its normals to what a back leaves, and its jets there.

    - `place`: index position of the back, rad
    - `side`: side of the flank
    - `grid`, `part`: points of the flank, and those N of them that count

    NaN where the normals do not meet it.
    """
    surface = back.cut(back.blade.flank, place)
    r, n = (a[part].reshape(-1, 3) for a in (grid.points, grid.normals))
    u, v = np.moveaxis(grid.parameters[part].reshape(-1, 2), -1, 0)
    heights = side.blade.flank.section(u)[0][:, 0]

    def apart(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        jet = surface.jet(x[:, 0], x[:, 1])
        return jet.r - r[index] - x[:, 2:] * n[index], np.stack((jet.r_u, jet.r_v, -n[index]), axis=-1)

    start = np.stack((heights / np.cos(back.blade.blade_angle), v, np.zeros_like(v)), axis=-1)
    with np.errstate(all="ignore"):
        solution = newton.solve(apart, start, tolerance=ROOM_TOLERANCE_MM)
        x = np.where(solution.converged[:, None], solution.values, np.nan)
        return x[:, 2], surface.jet(x[:, 0], x[:, 1])


def cradle_rolls(side: Generated, u: Array, v: Array) -> Array:
    """Return the rotations of the cradle (...,), rad, at which a side's points u, v (...,) are cut; 0 without roll."""
    if side.settings.formate:
        return np.zeros_like(u)
    assert side.indexing is not None
    # the crown gear turns with cradle and cutter
    crown = side.settings.ratio_of_roll * side.indexing.blade_groups / side.indexing.teeth
    return np.asarray(side.envelope(side.blade.flank).parameter(u, v) + side.hand * crown * v)


def second_pass(side: Generated, own: MemberBlank) -> float:
    """Return the depth (mm) to which the tips of a head's blades enter a member's blank beside the spaces that they cut.

    It is the largest distance from the tip cone between toe and heel, and 0 for a head that clears the blank.
    """
    settings, hand = side.settings, side.hand
    assert side.indexing is not None
    toe, heel = own.extent
    ends = side.blade.at_height(0.0), side.blade.at_height(side.tip_height)
    u, stations = (a.ravel() for a in np.meshgrid(ends, np.linspace(toe, heel, PASS_STATIONS)))
    followed = follow(side.side(0.0).flank, u, stations, own.stations)
    u, v = u[followed.converged], followed.values[followed.converged]
    if not v.size:
        return 0.0
    rolls = cradle_rolls(side, u, v)
    rolls = np.linspace(rolls.min(), rolls.max(), 1 if settings.formate else PASS_ROLLS)
    turn = np.linspace(-np.pi, np.pi, PASS_ROTATIONS, endpoint=False)
    # distance of the blade's tip from the axis; its face is turned from the radius
    lengthwise, across = (f(side.indexing.offset_angle) for f in (np.cos, np.sin))
    out = side.blade.land_radius - side.indexing.radius
    reach = np.hypot(side.indexing.radius + out * lengthwise, out * across)
    tip = reach * np.stack((np.cos(turn), np.sin(turn), np.zeros_like(turn)), axis=-1)
    cutter = Rigid(settings.cutter_axes(hand), settings.cutter_centre(hand)) @ Rigid.about_z(side.mean_direction)
    on_cradle = cutter.point(tip)
    c, s = (f(hand * rolls)[:, None] for f in (np.cos, np.sin))
    r = settings.own_from_machine(hand).point(about_z(c, s, on_cradle))
    station, depth = own.stations.value(r), -own.tip.value(r)
    inside = (depth > 0.0) & (station > toe) & (station < heel)
    # at the ends of the roll the tips enter the blank next to the flank's own rotations
    margin = BESIDE_SHARE * (v.max() - v.min())
    beside = (turn < v.min() - margin) | (turn > v.max() + margin)
    # the pass in which the flank is cut is the one that reaches its rotations
    depths = [depth[k][_apart(row, ~beside)] for k, row in enumerate(inside)]
    return float(max((each.max() for each in depths if each.size), default=0.0))


def _apart(inside: NDArray[np.bool_], cutting: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return True (N,) in the arcs of a circle that are `inside` and have no point in common with `cutting` ones."""
    number = np.cumsum(np.diff(inside, prepend=inside[-1]) != 0)
    # the arc over the end of the circle is one
    number = np.where(number == number[-1], 0, number) if inside[0] and inside[-1] else number
    return inside & ~np.isin(number, number[inside & cutting])


@dataclass(frozen=True)
class HeadRoom:
    """Room for the blades of a head in the spaces of one member."""

    #: the member's tooth
    tooth: Tooth
    #: name of the member, "pinion" or "gear"
    member: str
    #: point width (mm) of blades that together clear the widest slot
    width: float
    #: room of the flanks, by side of the member
    sides: Mapping[str, SecondaryCut]

    @staticmethod
    def of(member: Member, sides: Mapping[str, Generated], places: Angles) -> HeadRoom:
        """Return the room in the spaces of a member, by its sides and their index positions (rad)."""
        tooth = member.tooth
        width = blade_width(tooth)
        cuts = {name: secondary_cut(name, sides, places, tooth, width) for name in sides}
        return HeadRoom(tooth, member.name, width, cuts)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings on secondary cuts."""
        return tuple(self._warning(name, cut) for name, cut in self.sides.items() if cut.least < -LEAST_CUT_MM)

    def _warning(self, name: str, cut: SecondaryCut) -> str:
        """Return the warning on the secondary cut of the flank `name`."""
        end = "heel" if cut.at_heel else "toe"
        found = self.tooth.stations(cut.ends[-1:] if cut.at_heel else cut.ends[:1])
        place = "".join(f", from the cone distance {float(x):.5g} mm" for x in found)
        return (
            f"{self.member}: secondary cut: blades of the other side, with the point width of {self.width:.4g} mm that clears "
            f"the widest slot, cut into the {name} flank by up to {-cut.least:.3g} mm{place} to the {end}; remedies: "
            f"a {'larger' if cut.at_heel else 'smaller'} head.radius, or a smaller face_width"
        )


def refuse_second_pass(name: str, sides: Mapping[str, Generated], own: MemberBlank) -> None:
    """Raise VagueError for a head so small that it cuts the member `name`, by its sides, a second time."""
    depth = max(second_pass(side, own) for side in sides.values())
    if depth > 0.0:
        raise VagueError(
            name,
            reason=f"the head is too small to clear it: blades enter the blank a second time, {depth:.3g} mm deep",
            allowed="a larger head.radius or a smaller face_width",
            topic=f"{name}: second pass",
            remedies={"head.radius": 1, "face_width": -1},
            excess=depth,
        )
