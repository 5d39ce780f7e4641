"""Zone of contact of conjugate flanks: the points of a flank that touch, and their places in the fixed frame.

A point of a flank touches the conjugate flank where the equation of meshing n . v12 = 0 holds. For a member that turns by phi the
equation reads A cos(phi) + B sin(phi) + C = 0:

    |C| < hypot(A, B)       two roots: the point meets the mating flank twice; the root that lies on the mating flank counts
    |C| = hypot(A, B)       one double root: the envelope of the contact lines, beyond which nothing touches (limit line)
    |C| > hypot(A, B)       no root: the point never touches

The generated flank ends where it becomes singular, on the limiting line of its tool (`kernel.envelope.limiting_line`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, components, cross, distinct, dot
from gearmesh.kernel.numeric.polylines import depth_inside, share_inside
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.limits import ways_to_limiting_line

#: points of the gear's flank from root to tip and along the face
GEAR_GRID = (21, 41)
#: points of the pinion's flank whose normals tell the two roots of a point apart
PINION_GRID = (15, 15)
#: points of the pinion's flank, up and along, between which the envelope of the contact lines is looked for
LIMIT_GRID = (41, 161)
#: stations of a limiting line
LIMIT_STATIONS = 41
#: steps from the flank to its limiting line
LIMIT_STEPS = 41
#: rounding error of 1 - |C| / hypot(A, B)
RESERVE_ROUNDING = 1e-6
#: rotations (rad) that determine A, B and C: thirds of a turn
THIRDS_OF_TURN = np.array([0.0, 2.0, 4.0]) * np.pi / 3.0


@dataclass(frozen=True)
class MeetingPoints:
    """Rotations `turns` (..., 2), rad, of a member at which points of its flank touch the conjugate flank.

    `fixed` (..., 2, 3) are the points in the fixed frame, mm; both are NaN for points that never touch. `reserve` (...,) is
    1 - |C| / hypot(A, B), 0 on the envelope of the contact lines.
    """

    turns: Array
    fixed: Array
    reserve: Array


def meeting_points(pair: GearPair, name: str, r: Array, n: Array) -> MeetingPoints:
    """Solve the equation of meshing for points r (..., 3), with normals n, of the flank of member `name`, in its frame."""
    first, second = (own.concentric for own in pair.mounts)
    mount = pair.members[name].mount.concentric

    def meshing(phi: float) -> Array:
        to_fixed = mount.at(phi)
        at = to_fixed.point(r)
        return dot(to_fixed.vector(n), first.velocity(at) - pair.ratio * second.velocity(at))

    values = np.stack([meshing(float(phi)) for phi in THIRDS_OF_TURN])
    c = values.mean(axis=0)
    a, b = (2.0 / 3.0 * np.tensordot(wave, values, axes=1) for wave in (np.cos(THIRDS_OF_TURN), np.sin(THIRDS_OF_TURN)))
    size = np.hypot(a, b)
    with np.errstate(invalid="ignore", divide="ignore"):
        # on the envelope rounding must not take the double root away
        cosine = np.where(np.abs(c) <= (1.0 + RESERVE_ROUNDING) * size, np.clip(-c / size, -1.0, 1.0), np.nan)
        turns = np.arctan2(b, a)[..., None] + np.arccos(cosine)[..., None] * np.array([-1.0, 1.0])
        turns = (turns - mount.zero + np.pi) % (2.0 * np.pi) - np.pi + mount.zero
        fixed = mount.at(turns).point(np.broadcast_to(r[..., None, :], (*turns.shape, 3)))
        return MeetingPoints(turns, fixed, 1.0 - np.abs(c) / size)


@dataclass(frozen=True)
class ContactZone:
    """Zone of contact on the gear's flank, on a grid from form point to tip (I) and from toe to heel (J)."""

    #: points (I, J, 3) of the flank, gear's frame, mm
    points: Array
    #: places (I, J, 3) of contact, fixed frame, mm, NaN for points that never touch
    fixed: Array
    #: depth (I, J) of the place within the edges of the pinion's flank, mm, below 0 beyond them
    depth: Array
    #: number (I, J) of the root in `MeetingPoints.turns`
    root: NDArray[np.intp]
    #: share of the flank's area that touches
    share: float
    #: stations (2,) between which the flank touches, mm, NaN if it touches nowhere
    ends: Array


def contact_zone(pair: GearPair, grid: tuple[int, int] = GEAR_GRID) -> ContactZone | None:
    """Compute the zone of contact of conjugate flanks; None for a pair with a member that slides (a rack)."""
    if not all(mount.spin.any() for mount in pair.mounts):
        return None
    gear, side, pinion = pair.gear, pair.flanks[1], pair.pinion.mount.concentric
    flank = gear.tooth.flank_grid(side, *(np.linspace(0.0, 1.0, n) for n in grid))
    met = meeting_points(pair, gear.name, flank.points, flank.normals)
    frame = FlankFrame.of(pair.pinion, pair.flanks[0])
    # places of both roots on the pinion's flank; lengths, heights and parts of normals do not depend on its rotation
    to_own = pinion.at(pinion.zero).inverse
    places = frame.places(to_own.point(met.fixed))
    both = np.where(np.isnan(places[..., 0]), -np.inf, depth_inside(frame.outline, places))
    # of the two roots take the root with the normal of the pinion's flank there, and the root nearer to the flank
    normals = -pair.gear.mount.concentric.at(met.turns).vector(flank.normals[..., None, :])
    parts = _round_axis(to_own.point(met.fixed), to_own.vector(normals))
    apart = parts - _normals_at(pair, frame, places)
    far = np.maximum(-both, 0.0) / np.ptp(frame.extent[:, 1])
    root = np.nan_to_num(dot(apart, apart) + far**2, nan=np.inf).argmin(axis=-1)
    depth = np.take_along_axis(both, root[..., None], axis=-1)[..., 0]
    fixed = np.take_along_axis(met.fixed, root[..., None, None], axis=-2)[..., 0, :]
    # area of the flank by the trapezoidal rule, and the share of every cell that touches
    rows, columns = (np.where(np.arange(n) % (n - 1) == 0, 0.5, 1.0) for n in grid)
    up, along = (np.gradient(flank.points, axis=axis) for axis in (0, 1))
    area = np.linalg.norm(cross(up, along), axis=-1) * rows[:, None] * columns
    lowest = float(depth[np.isfinite(depth)].min(initial=0.0))
    touching = area * share_inside(np.maximum(depth, lowest))
    seen = gear.tooth.blank.axial.value(flank.points)[depth > 0.0]
    ends = np.array([seen.min(), seen.max()]) if seen.size else np.full(2, np.nan)
    return ContactZone(flank.points, fixed, depth, root, float(touching.sum() / area.sum()), ends)


def _round_axis(r: Array, n: Array) -> Array:
    """Return radial, tangential and axial parts (..., 3) of vectors n at points r (..., 3), member's frame."""
    cosine, sine = (r[..., k] / np.hypot(r[..., 0], r[..., 1]) for k in (0, 1))
    return components(cosine * n[..., 0] + sine * n[..., 1], cosine * n[..., 1] - sine * n[..., 0], n[..., 2])


def _normals_at(pair: GearPair, frame: FlankFrame, places: Array) -> Array:
    """Return parts (..., 3) of the pinion's normals at lengths and heights (..., 2), from the nearest grid point; NaN for NaN."""
    grid = pair.pinion.tooth.flank_grid(pair.flanks[0], *(np.linspace(0.0, 1.0, n) for n in PINION_GRID))
    size = np.ptp(frame.extent, axis=0)
    known = (frame.places(grid.points) / size).reshape(-1, 2)
    # squared distances less the squares of the places: one matrix product, five times as fast as differences
    number = ((known**2).sum(axis=-1) - 2.0 * (places / size) @ known.T).argmin(axis=-1)
    normals: Array = _round_axis(grid.points, grid.normals).reshape(-1, 3)[number]
    return np.where(np.isnan(places[..., :1]), np.nan, normals)


@dataclass(frozen=True)
class LimitLine:
    """Limit line of contact on a member's flank.

    Points (K, 3) in the member's frame (`own`) and, at their contact, in the fixed frame (`fixed`), mm, NaN between pieces.
    `undercut` is True on the limiting line of the tool, where the flank is singular, and False on the envelope of contact lines.
    """

    own: Array
    fixed: Array
    undercut: bool


def limit_lines(pair: GearPair, zone: ContactZone) -> dict[str, LimitLine]:
    """Solve for the limit lines of both members, by name.

    The gear has the limiting line of its tool, even beyond the flank; the pinion has the envelope of the contact lines within its
    flank.
    """
    lines = {}
    ways, normals = ways_to_limiting_line(pair.gear.tooth, pair.flanks[1], LIMIT_STATIONS, LIMIT_STEPS)
    if np.isfinite(ways).any():
        met = meeting_points(pair, pair.gear.name, ways, normals)
        lines[pair.gear.name] = LimitLine(ways[-1], _follow_root(met, int(zone.root[-1, 0])), undercut=True)
    envelope = _envelope(pair)
    if len(envelope.own):
        lines[pair.pinion.name] = envelope
    return lines


def _envelope(pair: GearPair) -> LimitLine:
    """Solve for the envelope of the contact lines on the pinion's flank, by a root on every grid line from toe to heel."""
    pinion, which = pair.pinion, pair.flanks[0]
    surface = pinion.tooth.side(which).flank
    grid = pinion.tooth.flank_grid(which, *(np.linspace(0.0, 1.0, n) for n in LIMIT_GRID))
    reserve = meeting_points(pair, pinion.name, grid.points, grid.normals).reserve
    i, j = np.nonzero(reserve[:, :-1] * reserve[:, 1:] < 0.0)
    low, high = grid.parameters[i, j], grid.parameters[i, j + 1]

    def at(share: Array, k: NDArray[np.intp]) -> Jet:
        u = low[k] + share[:, None] * (high[k] - low[k])
        return surface.jet(u[:, 0], u[:, 1])

    def ahead(share: Array, k: NDArray[np.intp]) -> Array:
        jet = at(share, k)
        return meeting_points(pair, pinion.name, jet.r, jet.n).reserve

    root = bracketed_root(ahead, np.zeros(len(i)), np.ones(len(i)))
    every = np.flatnonzero(root.converged)
    jet = at(root.values[every], every)
    fixed = meeting_points(pair, pinion.name, jet.r, jet.n).fixed[..., 0, :]
    # the first crossings of all rows are one line, the second crossings the next line
    number = np.arange(every.size) - np.searchsorted(i[every], i[every])
    gap = np.full((1, 3), np.nan)
    parts = [np.flatnonzero(number == n) for n in distinct(number)]
    own, placed = (
        np.concatenate([piece for part in parts for piece in (values[part], gap)]) if parts else np.empty((0, 3))
        for values in (jet.r, fixed)
    )
    return LimitLine(own, placed, undercut=False)


def _follow_root(met: MeetingPoints, root: int) -> Array:
    """Return the places (K, 3), fixed frame, mm, of the last row of points (N, K), by following one of the two roots.

    The roots may cross. The search follows `root` of the first point down the first column and then along the last row.
    """
    turns = np.concatenate((met.turns[:, 0], met.turns[-1, 1:]))
    at, before = [root], turns[0, root]
    chosen = before
    for here in turns[1:]:
        onward = 2.0 * chosen - before
        off = np.nan_to_num((here - onward + np.pi) % (2.0 * np.pi) - np.pi, nan=np.inf)
        at.append(int(np.abs(off).argmin()))
        if np.isfinite(off[at[-1]]):
            before, chosen = chosen, onward + off[at[-1]]
    return np.asarray(met.fixed[-1, np.arange(met.turns.shape[1]), at[len(met.turns) - 1 :]])
