"""The zone of contact of conjugate flanks: which points of a flank touch, and where in space.

A point of a flank that turns with its member touches where the equation of meshing n . v12 = 0 holds. Of a member that turns by
phi that is A cos(phi) + B sin(phi) + C = 0:

    |C| < hypot(A, B)       the point touches twice, as the flank comes past it and goes; where it lies on the other flank decides
    |C| = hypot(A, B)       both are one: there contact lines have their envelope, beyond which nothing touches (limit line)
    |C| > hypot(A, B)       it never touches

The flank that is generated ends where it becomes singular, on the limiting line of its tool (`kernel.envelope.limiting_line`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, components, cross, dot
from gearmesh.kernel.numeric.polylines import depth_inside, share_inside
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.surface.surface import Jet
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.limits import ways_to_limiting_line

#: points of a flank from root to tip and along the face
GRID = (21, 41)
#: points of the pinion's flank by whose normals both places of a point are told apart
PINION_GRID = (15, 15)
#: points up and along a flank among which the envelope of its contact lines is looked for; stations of limiting lines
LIMIT_GRID = (41, 161)
#: and steps on the way there
STATIONS, STEPS = 41, 41
#: rounding of 1 - |C| / hypot(A, B)
ROUNDING = 1e-6
#: thirds of a turn, by which a harmonic is known
THIRDS = np.array([0.0, 2.0, 4.0]) * np.pi / 3.0


@dataclass(frozen=True)
class MeetingPoints:
    """Rotations `turns` (..., 2), rad, of a member at which points of its flank touch a conjugate one, and where: `fixed`
    (..., 2, 3), fixed frame, mm; NaN of points that never touch. `reserve` (...,): 1 - |C| / hypot(A, B), 0 on the envelope of
    the contact lines."""

    turns: Array
    fixed: Array
    reserve: Array


def meeting_points(pair: GearPair, name: str, r: Array, n: Array) -> MeetingPoints:
    """Where points r (..., 3) of the flank of a member that turns, with normals n, own frame, touch."""
    first, second = (own.concentric for own in pair.mounts)
    mount = pair.members[name].mount.concentric

    def meshing(phi: float) -> Array:
        to_fixed = mount.at(phi)
        at = to_fixed.point(r)
        return dot(to_fixed.vector(n), first.velocity(at) - pair.ratio * second.velocity(at))

    values = np.stack([meshing(float(phi)) for phi in THIRDS])
    c = values.mean(axis=0)
    a, b = (2.0 / 3.0 * np.tensordot(wave, values, axes=1) for wave in (np.cos(THIRDS), np.sin(THIRDS)))
    size = np.hypot(a, b)
    with np.errstate(invalid="ignore", divide="ignore"):
        # on the envelope itself rounding decides whether there is a root
        cosine = np.where(np.abs(c) <= (1.0 + ROUNDING) * size, np.clip(-c / size, -1.0, 1.0), np.nan)
        turns = np.arctan2(b, a)[..., None] + np.arccos(cosine)[..., None] * np.array([-1.0, 1.0])
        turns = (turns - mount.zero + np.pi) % (2.0 * np.pi) - np.pi + mount.zero
        fixed = mount.at(turns).point(np.broadcast_to(r[..., None, :], (*turns.shape, 3)))
        return MeetingPoints(turns, fixed, 1.0 - np.abs(c) / size)


@dataclass(frozen=True)
class ContactZone:
    """The zone of contact on the gear's flank, on points (I, J, 3) of it from form point to tip and from toe to heel, own frame.

    `fixed` (I, J, 3): where they touch, fixed frame, mm, NaN where they never do; `depth` (I, J), mm: how far within the edges of
    the pinion's flank that is, < 0 beyond them; `root` (I, J): which of both `MeetingPoints.turns` that is; `share` of the
    flank's area that touches; `ends` (2,): stations (mm) between which it does, NaN where it does nowhere.
    """

    points: Array
    fixed: Array
    depth: Array
    root: NDArray[np.intp]
    share: float
    ends: Array


def contact_zone(pair: GearPair, grid: tuple[int, int] = GRID) -> ContactZone | None:
    """The zone of contact of flanks that are conjugate; None where a member slides."""
    if not all(mount.spin.any() for mount in pair.mounts):
        return None
    gear, side, pinion = pair.gear, pair.flanks[1], pair.pinion.mount.concentric
    flank = gear.tooth.flank_grid(side, *(np.linspace(0.0, 1.0, n) for n in grid))
    met = meeting_points(pair, gear.name, flank.points, flank.normals)
    frame = FlankFrame.of(pair.pinion, pair.flanks[0])
    # lengths and heights are the same however the pinion is turned, and so are the parts of its normals
    to_own = pinion.at(pinion.zero).inverse
    places = frame.places(to_own.point(met.fixed))
    both = np.where(np.isnan(places[..., 0]), -np.inf, depth_inside(frame.outline, places))
    normals = -pair.gear.mount.concentric.at(met.turns).vector(flank.normals[..., None, :])
    parts = _round_axis(to_own.point(met.fixed), to_own.vector(normals))
    apart = parts - _normals_at(pair, frame, places)
    far = np.maximum(-both, 0.0) / np.ptp(frame.extent[:, 1])
    root = np.nan_to_num(dot(apart, apart) + far**2, nan=np.inf).argmin(axis=-1)
    depth = np.take_along_axis(both, root[..., None], axis=-1)[..., 0]
    fixed = np.take_along_axis(met.fixed, root[..., None, None], axis=-2)[..., 0, :]
    rows, columns = (np.where(np.arange(n) % (n - 1) == 0, 0.5, 1.0) for n in grid)
    up, along = (np.gradient(flank.points, axis=axis) for axis in (0, 1))
    area = np.linalg.norm(cross(up, along), axis=-1) * rows[:, None] * columns
    lowest = float(depth[np.isfinite(depth)].min(initial=0.0))
    touching = area * share_inside(np.maximum(depth, lowest))
    seen = gear.tooth.blank.axial.value(flank.points)[depth > 0.0]
    ends = np.array([seen.min(), seen.max()]) if seen.size else np.full(2, np.nan)
    return ContactZone(flank.points, fixed, depth, root, float(touching.sum() / area.sum()), ends)


def _round_axis(r: Array, n: Array) -> Array:
    """Radial, tangential and axial parts (..., 3) of vectors n at points r (..., 3), own frame."""
    cosine, sine = (r[..., k] / np.hypot(r[..., 0], r[..., 1]) for k in (0, 1))
    return components(cosine * n[..., 0] + sine * n[..., 1], cosine * n[..., 1] - sine * n[..., 0], n[..., 2])


def _normals_at(pair: GearPair, frame: FlankFrame, places: Array) -> Array:
    """Parts (..., 3) of the pinion's normals at lengths and heights (..., 2), of the nearest of its points; NaN of no place."""
    grid = pair.pinion.tooth.flank_grid(pair.flanks[0], *(np.linspace(0.0, 1.0, n) for n in PINION_GRID))
    size = np.ptp(frame.extent, axis=0)
    known = (frame.places(grid.points) / size).reshape(-1, 2)
    # squares of distances, less those of the places: one product, where differences take five times as long
    number = ((known**2).sum(axis=-1) - 2.0 * (places / size) @ known.T).argmin(axis=-1)
    normals: Array = _round_axis(grid.points, grid.normals).reshape(-1, 3)[number]
    return np.where(np.isnan(places[..., :1]), np.nan, normals)


@dataclass(frozen=True)
class LimitLine:
    """Where contact lines end on a member's flank: points (K, 3), `own` frame and, as they touch, `fixed` frame, mm; NaN between
    its parts. `undercut`: the flank is singular there, on the limiting line of its tool; else they have their envelope there."""

    own: Array
    fixed: Array
    undercut: bool


def limit_lines(pair: GearPair, zone: ContactZone) -> dict[str, LimitLine]:
    """Limit lines by the members' names: on the gear the limiting line of its tool, also where that is beyond the flank; on the
    pinion the envelope of the contact lines within its flank."""
    lines = {}
    ways, normals = ways_to_limiting_line(pair.gear.tooth, pair.flanks[1], STATIONS, STEPS)
    if np.isfinite(ways).any():
        met = meeting_points(pair, pair.gear.name, ways, normals)
        lines[pair.gear.name] = LimitLine(ways[-1], _follow_root(met, int(zone.root[-1, 0])), undercut=True)
    envelope = _envelope(pair)
    if len(envelope.own):
        lines[pair.pinion.name] = envelope
    return lines


def _envelope(pair: GearPair) -> LimitLine:
    """The envelope of the contact lines on the pinion's flank: one point for every line from toe to heel and place on it, where it
    crosses."""
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
    # of every row the first crossing and the others, one line each
    number = np.arange(every.size) - np.searchsorted(i[every], i[every])
    gap = np.full((1, 3), np.nan)
    parts = [np.flatnonzero(number == n) for n in np.unique(number)]
    own, placed = (
        np.concatenate([piece for part in parts for piece in (values[part], gap)]) if parts else np.empty((0, 3))
        for values in (jet.r, fixed)
    )
    return LimitLine(own, placed, undercut=False)


def _follow_root(met: MeetingPoints, root: int) -> Array:
    """Where the last of points (N, K) touches, (K, 3): of both roots, which may cross, that which follows from the one of the
    first, on to the last of the first column, and from there along the last."""
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
