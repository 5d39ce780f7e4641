"""Flanks of a gear pair for the contact solver, with their numbered edges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Bound, Flank
from gearmesh.kernel.numeric.algebra import Array, polar_angle
from gearmesh.kernel.surface.levels import Level, Shifted
from gearmesh.kernel.surface.surface import Surface
from gearmesh.records import dataclass

#: members of a pair, in the order of all arrays
MEMBER_NAMES = ("pinion", "gear")
#: edges of a flank beside the form point; toe and heel are the ends where the face begins and ends
FLANK_EDGES = ("tip", "toe", "heel")
#: edge between flank and fillet
FORM_POINT = "joint"
#: edge of a fillet, which has neither tip nor form point
ROOT_EDGE = "root"
#: corners along the face inside a flank: as many as linear reliefs of two tables make
CREASE_NAMES = tuple(f"crease_{k}" for k in (1, 2, 3, 4))
#: corners up the profile inside a flank: as many as linear reliefs of two tables make
RIDGE_NAMES = tuple(f"ridge_{k}" for k in (1, 2, 3, 4))
#: corners of tip lines, for example where the throat of a worm wheel passes into its outside cylinder
TIP_CORNERS = tuple(f"tip_corner_{k}" for k in (1, 2, 3, 4))
#: all edges of both members, in the order in which the solver counts them, by member and name
NUMBERED_EDGES = (
    *((member, name) for member in (0, 1) for name in FLANK_EDGES),
    (0, FORM_POINT),
    (1, FORM_POINT),
    (0, ROOT_EDGE),
    (1, ROOT_EDGE),
    *((member, name) for member in (0, 1) for name in (*CREASE_NAMES, *RIDGE_NAMES, *TIP_CORNERS)),
)
#: flank of a tooth, which may touch
FLANK_PART = "flank"
#: fillet of a tooth, which a tip may touch
FILLET_PART = "fillet"
#: tip edge of a tooth, which may touch
TIP_EDGE = "tip_edge"
#: touching part of the pinion and of the gear, by the number of `Contacts.part`
PART_PAIRS = (
    (FLANK_PART, FLANK_PART),
    (FILLET_PART, FLANK_PART),
    (FLANK_PART, FILLET_PART),
    (TIP_EDGE, FLANK_PART),
    (FLANK_PART, TIP_EDGE),
    (TIP_EDGE, TIP_EDGE),
    (TIP_EDGE, FILLET_PART),
    (FILLET_PART, TIP_EDGE),
)
#: True for the pairs of parts with a fillet
HAS_FILLET = np.array([FILLET_PART in parts for parts in PART_PAIRS])
#: True for the pairs of parts with a tip edge
HAS_TIP_EDGE = np.array([TIP_EDGE in parts for parts in PART_PAIRS])
#: True for the numbered edges inside a flank, which continues beyond them
IS_INSIDE_FLANK = np.array([name in (*CREASE_NAMES, *RIDGE_NAMES) for _, name in NUMBERED_EDGES])
#: True for the stations of corners of tip lines, which are edges only together with the tip
IS_TIP_CORNER = np.array([name in TIP_CORNERS for _, name in NUMBERED_EDGES])
#: number of a place at which no condition holds: a corner of edges
EDGE_CORNER = len(NUMBERED_EDGES)
#: azimuth range of a pinion's tooth above which only the part that faces the gear is sampled
WOUND_AZIMUTH_RAD = 0.5 * np.pi
#: largest rotation at which a flank faces the gear without another count of its windings
FACING_RANGE_RAD = 0.6 * np.pi
#: step beside a place, as a share of the flank, that shows on which side of a corner the place lies
CORNER_STEP_SHARE = 1e-6
#: least sine of the angle between skew axes; below it the axes are parallel except for assembly errors
SKEW_SINE = 0.1
#: least cosine of the angle between the spins of members that turn inside each other
NESTED_COSINE = 0.9
#: rotation beyond half a turn that is rounding
HALF_TURN_ROUNDING_RAD = 1e-12
#: difference of a ratio from 1 that is rounding
COUPLED_RATIO_ROUNDING = 1e-12
#: largest residual of a solved contact
SOLVED_RESIDUAL_MM = 1e-11
#: largest residual of a solved contact of large gears, as a share of the pinion's largest coordinate
ROUNDING_SHARE = 1e-12


@dataclass(frozen=True)
class Pair:
    """Data of a gear pair for the contact solver."""

    #: mounted flank of the pinion
    pinion: Flank
    #: mounted flank of the gear
    gear: Flank
    #: nominal ratio phi2/phi1, N1/N2
    ratio: float
    #: sense of the drive: +1 where phi2 is greatest at first touch, -1 where it is least
    drive: int
    #: thickness of the marking compound for contact ellipses, mm
    delta: float
    #: fillets of the same sides with the mounts of the flanks, None if tips do not count on fillets
    fillets: tuple[Flank, Flank] | None = None
    #: chamfers or roundings of the tips with the mounts of the flanks, None for sharp tips
    tips: tuple[Flank | None, Flank | None] = (None, None)
    #: pitch of the pinion, rad, NaN if unknown
    pitch: float = np.nan
    #: True if an eccentric drives the pair
    arm_turns: bool = False

    @cached_property
    def parts(self) -> dict[int, Pair]:
        """Pairs of parts of the teeth by their numbers in `PART_PAIRS`: first the flanks, then tip edges, then fillets."""
        if self.fillets is None:
            return {0: self}
        regions: tuple[dict[str, Flank], ...] = tuple(
            {FLANK_PART: flank, FILLET_PART: fillet.remount(flank.mount)}
            | ({} if tip is None else {TIP_EDGE: tip.remount(flank.mount)})
            for flank, fillet, tip in zip(self.flanks, self.fillets, self.tips, strict=True)
        )
        alone = replace(self, fillets=None, tips=(None, None))
        return {
            number: replace(alone, pinion=regions[0][PART_PAIRS[number][0]], gear=regions[1][PART_PAIRS[number][1]])
            for number in np.argsort(HAS_FILLET, kind="stable").tolist()
            if all(name in own for name, own in zip(PART_PAIRS[number], regions, strict=True))
        }

    @property
    def flanks(self) -> tuple[Flank, Flank]:
        return self.pinion, self.gear

    @cached_property
    def wound(self) -> bool:
        """True if the pinion's tooth winds so far round its axis that only part of its face is near the gear in any position."""
        return self.pinion.winding > WOUND_AZIMUTH_RAD and self.gear.mount.eccentricity == (0.0, 0.0)

    @property
    def unbroken(self) -> bool:
        """True if no derivative of either surface jumps, so that polynomials through samples of the advance bound it."""
        return self.pinion.unbroken and self.gear.unbroken

    @cached_property
    def nested(self) -> bool:
        """True if one member turns inside the other, about axes that are nearly parallel."""
        first, second = (flank.mount.spin for flank in self.flanks)
        return float(np.min(np.sum(first * second, axis=-1))) > NESTED_COSINE

    @property
    def turn(self) -> tuple[float, float]:
        """Ends (rad) of the turn of phi1 in which a tooth pair of coupled members counts as pair 0."""
        middle = self.pinion.mount.sign * self.pinion.middle_angle
        return -np.pi - middle, np.pi - middle

    @property
    def coupled(self) -> bool:
        """True if both members turn alike about axes that coincide but for assembly errors: all tooth pairs mesh at once."""
        return self.nested and abs(self.ratio - 1.0) < COUPLED_RATIO_ROUNDING

    @property
    def led_all_round(self) -> bool:
        """True if any tooth pair may be the first to touch: of coupled members, and of pairs that an eccentric drives."""
        return self.coupled or self.arm_turns

    @cached_property
    def length(self) -> float:
        """Typical flank dimension (mm), which turns conditions on normals into lengths."""
        return float(0.25 * np.linalg.norm(np.ptp(self._points.reshape(-1, 3), axis=0)))

    @cached_property
    def tolerance(self) -> float:
        """Residual (mm) below which a contact counts as solved; Newton goes one step further, to rounding."""
        return max(SOLVED_RESIDUAL_MM, ROUNDING_SHARE * float(np.nanmax(np.abs(self._points))))

    @cached_property
    def _points(self) -> Array:
        """Points of the pinion's grid, own frame, mm."""
        return self.pinion.surface.jet(self.pinion.grid[..., 0], self.pinion.grid[..., 1]).r

    @cached_property
    def max_step(self) -> Array:
        """Largest Newton step (5,): half the range of each flank's parameters, and 0.2 rad."""
        spans = [0.5 * np.ptp(f.grid.reshape(-1, 2), axis=0) for f in self.flanks]
        return np.array([*spans[0], *spans[1], 0.2])

    @cached_property
    def bounds(self) -> tuple[Bound | None, ...]:
        """Edges of both flanks in the order of NUMBERED_EDGES, None for edges that a flank does not have."""
        every = [{**flank.edges, **flank.creases, **flank.tip_corners} for flank in self.flanks]
        return tuple(
            Bound(member, every[member][name]) if name in every[member] else None for member, name in NUMBERED_EDGES
        )

    @cached_property
    def ends(self) -> tuple[int, ...]:
        """Numbers in `bounds` of the edges that end a flank."""
        return tuple(k for k in self.edges if not IS_INSIDE_FLANK[k])

    @cached_property
    def edges(self) -> tuple[int, ...]:
        """Numbers in `bounds` of the edges along which flanks may touch: those that end them, and corners inside."""
        return tuple(k for k, bound in enumerate(self.bounds) if bound is not None and not IS_TIP_CORNER[k])

    @cached_property
    def tip_corners(self) -> tuple[tuple[int, int], ...]:
        """Corners of tip lines: numbers in `bounds` of the tip and of the corner's station."""
        there = [k for k, bound in enumerate(self.bounds) if bound is not None and IS_TIP_CORNER[k]]
        return tuple((edge_number(NUMBERED_EDGES[k][0], "tip"), k) for k in there)

    @cached_property
    def smooth(self) -> NDArray[np.bool_]:
        """True for edges of `bounds` across which the teeth continue smoothly."""
        return np.array([name in self.flanks[member].smooth for member, name in NUMBERED_EDGES])

    def next_winding(self, phi1: Array, r: Array) -> NDArray[np.bool_]:
        """Return True (...,) for points r (..., 3) of the pinion that phi1 (...,), rad, has turned by more than half a turn.

        The turn counts from the rotation at which the point faces the gear. A point that comes round to the gear again touches it
        as another tooth of the pinion.
        """
        if self.pinion.winding + abs(self.facing) + np.abs(phi1).max(initial=0.0) <= np.pi:
            return np.zeros(np.broadcast_shapes(r.shape[:-1], phi1.shape), dtype=bool)
        turned = self.pinion.mount.sign * (phi1 - self.facing)
        # the teeth of coupled members face each other at every rotation: a whole flank changes its count at once
        azimuth = np.full(r.shape[:-1], self.pinion.middle_angle) if self.coupled else self.pinion.azimuth(r)
        farther: NDArray[np.bool_] = np.abs(azimuth + turned) > np.pi + HALF_TURN_ROUNDING_RAD
        return farther

    @cached_property
    def facing(self) -> float:
        """Rotation, rad, at which the middle of the pinion's flank faces the gear, 0 where so small a rotation does not count.

        Teeth of nested members may be in mesh over a whole turn, so that the rotation counts, however small. That of a thread is 0
        if within `FACING_RANGE_RAD` of 0. The coast flank of a single thread faces the gear half a turn before or after the
        driving flank.
        """
        if self.nested and not self.coupled:
            return _turn_into_mesh(*self.flanks)
        if not self.wound:
            return 0.0
        first, second = (_turn_towards(*flanks) for flanks in (self.flanks, self.flanks[::-1]))
        if abs(first) <= FACING_RANGE_RAD:
            return 0.0
        # the thread faces the gear once a turn, the gear's tooth says in which one
        conjugate = second / self.ratio
        return conjugate + (first - conjugate + np.pi) % (2.0 * np.pi) - np.pi

    @cached_property
    def all_bounds(self) -> tuple[Bound, ...]:
        """Edges of `bounds` that exist."""
        return tuple(bound for bound in self.bounds if bound is not None)

    @cached_property
    def numbers(self) -> NDArray[np.intp]:
        """Numbers in `all_bounds` of the edges of `bounds`, with -1 for edge -1."""
        there = np.array([bound is not None for bound in self.bounds])
        return np.append(np.where(there, np.cumsum(there) - 1, -1), -1)

    def pieces(self, x: Array) -> Iterator[tuple[NDArray[np.intp], Pair]]:
        """Yield the pieces of both flanks between creases: numbers of the unknowns x (M, 5) on them, and the pair of the pieces.

        Creases are edges of a piece, and its surfaces continue smoothly across them.
        """
        if not any(flank.creases for flank in self.flanks):
            yield np.arange(len(x)), self
            return
        by_piece: dict[tuple[Surface | None, Surface | None], list[int]] = {}
        for k, (u1, v1, u2, v2, _) in enumerate(x.tolist()):
            by_piece.setdefault((self.pinion.smooth_about(u1, v1), self.gear.smooth_about(u2, v2)), []).append(k)
        for own in by_piece.values():
            pinion, gear = _piece(self.pinion, x[own[0], :2]), _piece(self.gear, x[own[0], 2:4])
            yield np.array(own), replace(self, pinion=pinion, gear=gear, fillets=None, tips=(None, None))


def _piece(flank: Flank, place: Array) -> Flank:
    """Return the piece of a flank between its creases that holds a place, parameters (2,)."""
    rows, columns = flank.grid.shape[:2]
    ends = {"tip": (-1, columns // 2), FORM_POINT: (0, columns // 2), "toe": (rows // 2, 0), "heel": (rows // 2, -1)}
    smooth, steps = flank.smooth_about(*place), CORNER_STEP_SHARE * np.ptp(flank.grid.reshape(-1, 2), axis=0)
    nearest: dict[str, tuple[float, Level]] = {}
    for name, level in flank.creases.items():
        both, axis = (("tip", FORM_POINT), 0) if name in CREASE_NAMES else (("toe", "heel"), 1)
        # a place on a crease belongs to the side with the same surface
        near = place + np.array([[0.0], [1.0], [-1.0]]) * steps * (np.arange(2) == axis)
        same = np.array([flank.smooth_about(*parameters) == smooth for parameters in near])
        beside, beyond = (
            level.value(flank.surface.jet(*at.T).r)
            for at in (near, np.array([flank.grid[ends[edge]] for edge in both]))
        )
        own = beside[same][np.abs(beside[same]).argmax()]
        for edge, value in zip(both, beyond, strict=True):
            if own * value < 0.0 and (edge not in nearest or abs(own) < nearest[edge][0]):
                nearest[edge] = abs(own), Shifted(level, 0.0, -float(np.sign(own)))
    edges = flank.edges | {edge: level for edge, (_, level) in nearest.items()}
    surface = flank.surface if smooth is None else smooth
    return replace(flank, surface=surface, edges=edges, smooth=flank.smooth - set(nearest), creases={})


def within(edges: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return True (N,) for edges, numbers in `Pair.bounds`, EDGE_CORNER or -1, that lie inside a flank."""
    inside: NDArray[np.bool_] = np.append(IS_INSIDE_FLANK, False)[edges]
    return inside


def edge_number(member: int, name: str) -> int:
    """Return the number of an edge in `Pair.bounds`."""
    return NUMBERED_EDGES.index((member, name))


def along_face(number: int) -> bool:
    """Return True if an edge runs along the face, as tip, form point and root do, and not up a profile."""
    return NUMBERED_EDGES[number][1] not in ("toe", "heel", *RIDGE_NAMES)


def edge_name(pair: Pair, number: int) -> str:
    """Return the name in answers of an edge of a pair, by its number in `Pair.bounds`."""
    if number == EDGE_CORNER:
        return "corner"
    member, name = NUMBERED_EDGES[number]
    return f"{MEMBER_NAMES[member]}_{pair.flanks[member].edge_name(name)}"


def _turn_into_mesh(flank: Flank, mating: Flank) -> float:
    """Return the rotation (rad), -pi to pi, of a flank's member that turns its middle to where nested members are in mesh.

    There the inner member is farthest from the axis of the outer one. The rotation is 0 where both axes coincide.
    """
    origin, axis, other, across = _axes(flank, mating)
    row, column = (size // 2 for size in flank.grid.shape[:2])
    middle = np.reshape(flank.mount.at(0.0).point(flank.surface.jet(*flank.grid[row, column]).r), (-1, 3))[0]
    # the offset of the axes at the middle of the flank
    apart = origin + axis * (axis @ (middle - origin)) - other
    apart = apart - across * (across @ apart)
    apart = apart - axis * (axis @ apart)
    if np.linalg.norm(apart) < SOLVED_RESIDUAL_MM:
        return 0.0
    # +1 where tips of the mating member point away from its axis
    outwards = np.sign(mating.heights.sign * mating.heights.station[1])
    return _turn_to(flank, -outwards * apart)


def _turn_towards(flank: Flank, mating: Flank) -> float:
    """Return the rotation (rad), -pi to pi, of a flank's member that turns its middle to the axis of the mating member.

    The rotation is 0 where the axes meet or are parallel except for assembly errors.
    """
    origin, axis, other, across = _axes(flank, mating)
    normal = np.cross(axis, across)
    towards = normal * (normal @ (other - origin))
    if np.linalg.norm(normal) < SKEW_SINE or np.linalg.norm(towards) < SOLVED_RESIDUAL_MM:
        return 0.0
    return _turn_to(flank, towards)


def _axes(flank: Flank, mating: Flank) -> tuple[Array, ...]:
    """Return origin (mm) and direction (3,) of the axis of a flank's member and of the axis of the mating member."""
    first, second = flank.mount, mating.mount
    return tuple(np.reshape(vector, (-1, 3))[0] for vector in (first.origin, first.axis, second.origin, second.axis))


def _turn_to(flank: Flank, towards: Array) -> float:
    """Return the rotation (rad), -pi to pi, of a flank's member that turns its middle to the direction `towards` (3,)."""
    own = flank.mount.at(0.0).inverse.vector(towards)
    angle = float(np.reshape(polar_angle(own), -1)[0]) - flank.middle_angle
    return flank.mount.sign * float((angle + np.pi) % (2.0 * np.pi) - np.pi)
