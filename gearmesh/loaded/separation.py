"""Separation of two unloaded flanks where they may touch under load: exact gaps on grids that follow the contact.

Every near tooth pair has a grid in the tangent plane at its first touch. x runs along the contact, which is a line or
the major axis of an ellipse, and y across it. The middle of the grid is the ridge: the place of the least gap across,
for every x. The gap is measured along the normal, from the flanks themselves. Where the ridge leaves a flank over an
edge that runs more along x than across it, as a tip, the least gap lies on this edge. The grid follows the edge to its
end. x ends where one of the flanks ends.

            toe or tip                               y
    +----------------------------+                    |  ridge, least gap for this x
    |     cells dx by dy         |  2 W               o-------- x
    +----------------------------+

Units: mm, rad; the fixed frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import chain
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.engagement.uneven_teeth import farther_out_ahead, flanks_ahead
from gearmesh.contact.flanks import solver_pair, touching_jets
from gearmesh.contact.hertz import line_contact, point_contact
from gearmesh.contact.pair import MEMBER_NAMES, Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.kernel.surface.curvature import contact_ellipse, principal, relative_curvature, tangent_basis
from gearmesh.kernel.surface.surface import Jet
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.micro_geometry.index_angles import NO_INDEX_ANGLES
from gearmesh.teeth.mount import Mount

Record = TypeVar("Record", ContactPath, Jet)

#: tooth pairs searched on either side of the pair next to phi1
SEARCHED_PAIRS = 3
#: pairs searched further out while the outermost pair is near
MORE_PAIRS = 3
#: largest distance, in pairs, of a searched pair
MAX_PAIRS = 24
#: places along the contact at which the end of the flanks is searched
SCAN_PLACES = 33
#: places between two of these at which the end of an edge is searched
EDGE_PLACES = 17
#: places across the contact with exact gaps; between them gaps are polynomials
GAP_NODES = 5
#: steps of the secant method to the ridge: gaps across are nearly parabolas
RIDGE_STEPS = 6
#: step, mm, below which all places are on the ridge: the gap changes by its square
RIDGE_TOLERANCE_MM = 1e-4
#: largest ratio, either way, of the gap's curvature to the curvature at first touch
MAX_CURVATURE_RATIO = 5.0
#: gap, mm, of the largest step to the ridge
MAX_STEP_GAP_MM = 0.05
#: least relative curvature, 1/mm
LEAST_KAPPA = 1e-3
#: least width of a grid over that of a wider one whose gaps it takes
MIN_SHARED_WIDTH = 0.6
#: half width of the grid over the Hertz semi-axis under the load
GRID_MARGIN = 1.4
#: extension of a grid beyond a corner of a flank, in half widths of a contact as long as wide
CORNER_MARGIN = 2.0
#: distance, mm, within which a point of a surface is solved for
POINT_TOLERANCE_MM = 1e-9
#: plain Newton steps to a point; from a place next to it one to three are usual
POINT_STEPS = 5
#: least length of a grid, mm: a contact at a corner of a flank has nearly no length
MIN_GRID_LENGTH_MM = 0.05
#: change of the distance outside a flank over the distance of places; beyond it the surface turns back at a cusp
MAX_MARGIN_SLOPE = 2.0
#: distance outside the flank, mm, within which a point lies on its edge
EDGE_TOLERANCE_MM = 1e-3
#: largest tangent of the angle between x and an edge that runs along x
MAX_EDGE_TANGENT = 0.02
#: distance from first touch, as share of the length, at which this angle is measured
PROBE_SHARE = 0.02
#: Newton steps that move a point on to an edge
EDGE_STEPS = 3
#: largest distance, mm, from x to an edge that runs along x
MAX_EDGE_OFFSET_MM = 0.5
#: step, mm, of the difference quotient for the slope of the distance outside a flank
SLOPE_STEP_MM = 1e-3
#: least slope of the distance outside a flank; with a smaller slope the point lies beyond an end face, at another edge
MIN_EDGE_SLOPE = 0.5
#: extension of a grid along an edge: until the edge is this many half widths of the contact away from the line
EDGE_MARGIN = 2.0
#: least tangent of the angle between line and edge; a smaller angle gives no extension
MIN_EDGE_TANGENT = 1e-3
#: least cosine between x and an end face's normal for the face to count as at right angles to x
MIN_END_COSINE = 0.7
#: axis of the pairs in those arrays of a `Separation` where it is not the first
PAIR_AXES = {"levers": 1, "places": 1, "open": 1, "part": 1, "ends": 2, "ridge_ends": 1}


@dataclass(frozen=True)
class NearPairs:
    """Tooth pairs (M,) that may touch under load, at rotations of the pinion."""

    #: flanks and mounts of the pair; of a double helical pair, of its first half
    pair: Pair
    #: rotations (P,) of the pinion, rad
    phi1: Array
    #: rotations (P,) of the unloaded gear, rad
    phi2: Array
    #: index (M,) in `phi1` of each pair
    position: NDArray[np.intp]
    #: number (M,) of each pair: at phi1, pair k does what pair 0 does at phi1 - k pitches, pitch deviations apart
    number: NDArray[np.intp]
    #: half (M,) of a double helical gear, 0 or 1, or number of a pair that shares the torque; points of all but 0 are stored
    #: in the frame that `images` maps to the fixed frame
    half: NDArray[np.intp]
    #: rotations of both members, rad, (M,) each, counted like those of pair 0
    turns: tuple[Array, Array]
    #: mounts of pinion and gear; the gear of a double helical pair has one base (M,) for each pair
    mounts: tuple[Mount, Mount]
    #: first touch of each pair
    path: ContactPath
    #: directions (M, 3, 3) at first touch, as columns: x, y and the normal out of the pinion
    axes: Array
    #: relative curvatures (M, 2), 1/mm, along x and y
    kappa: Array
    #: motion of each half to its place: reflections at the pinion's plane of symmetry; of each pair that shares the torque
    images: tuple[Rigid, ...]
    #: half heights (M,), mm, of whole flanks that may touch, with their middle in the origin; None if contacts are narrow
    heights: Array | None = None
    #: the pairs of all positions, and the rows (M,) of these pairs there; None for all
    chosen_from: tuple[NearPairs, NDArray[np.intp]] | None = None

    @cached_property
    def surfaces(self) -> _Surfaces:
        """The flanks over their tangent planes."""
        return _Surfaces(self)

    @cached_property
    def range(self) -> tuple[Array, Array]:
        """Least and largest x (M,), mm, at which the ridge lies on both flanks; equal for all torques."""
        if self.chosen_from is None:
            return _range(self.surfaces, self)
        every_pair, rows = self.chosen_from
        low, high = every_pair.range
        return low[rows], high[rows]

    @cached_property
    def first_gap(self) -> Array:
        """Gaps (M,), mm, at the places of first touch: how far tooth pairs lag the pair that touches."""
        origin = np.zeros((len(self.position), 1))
        return np.asarray(self.surfaces.at(origin, origin).gap[:, 0])

    @cached_property
    def beyond(self) -> tuple[Array, Array]:
        """Lengths (2, M), mm, by which the ridge continues along edges beyond the ends of `range`, and tangents of the
        angles to these edges."""
        if self.chosen_from is None:
            return _beyond(self.surfaces, self.range)
        every_pair, rows = self.chosen_from
        lengths, tangents = every_pair.beyond
        return lengths[:, rows], tangents[:, rows]

    def at_positions(self, positions: NDArray[np.bool_]) -> NearPairs:
        """Return the pairs at some of the positions (P,) of the pinion."""
        rows = np.flatnonzero(positions[self.position])
        return self._taken(rows, (np.cumsum(positions) - 1)[self.position[rows]], np.flatnonzero(positions))

    def some(self, rows: NDArray[np.intp]) -> NearPairs:
        """Return the pairs `rows` (N,) at the same positions."""
        return self._taken(rows, self.position[rows], np.arange(len(self.phi1)))

    def repeated(self, times: int) -> NearPairs:
        """Return the same pairs at the same positions several times, one after the other."""
        count, every = len(self.phi1), np.arange(len(self.position))
        position = (np.arange(times)[:, None] * count + self.position).ravel()
        return self._taken(np.tile(every, times), position, np.tile(np.arange(count), times))

    def _taken(self, rows: NDArray[np.intp], position: NDArray[np.intp], positions: NDArray[np.intp]) -> NearPairs:
        """Return the pairs `rows` at other numbers `position` of the positions `positions`."""
        pinion, gear = self.mounts
        if gear.base.rotation.ndim > 2:
            gear = replace(gear, base=Rigid(gear.base.rotation[rows], gear.base.translation[rows]))
        return NearPairs(
            self.pair,
            self.phi1[positions],
            self.phi2[positions],
            position,
            self.number[rows],
            self.half[rows],
            (self.turns[0][rows], self.turns[1][rows]),
            (pinion, gear),
            _rows(self.path, rows),
            self.axes[rows],
            self.kappa[rows],
            self.images,
            None if self.heights is None else self.heights[rows],
            (self, rows),
        )

    def of_flanks(self, gears: GearPair) -> NearPairs:
        """Return the same pairs at the same rotations, with flanks and mounts of gears that nearly equal these."""
        pair, (pinion, gear) = solver_pair(gears), gears.mounts
        if self.mounts[1].base.rotation.ndim > 2:
            bases = [row.gear.mount.base for row in gears.halves]
            rotation, translation = (
                np.stack(parts)[self.half] for parts in zip(*((b.rotation, b.translation) for b in bases), strict=True)
            )
            gear = replace(gear, base=Rigid(rotation, translation))
        return replace(self, pair=pair, mounts=(pinion, gear), chosen_from=(self, np.arange(len(self.position))))

    def in_place(self, points: Array) -> Array:
        """Return points (M, ..., 3) in the fixed frame; those of the other half are mapped by its image."""
        for k, image in enumerate(self.images[1:], 1):
            points = np.where(self._of_half(k, points), image.point(points), points)
        return points

    def turn(self, vectors: Array) -> Array:
        """Return vectors (M, ..., 3) in the fixed frame; those of the other half are mapped by its image."""
        for k, image in enumerate(self.images[1:], 1):
            vectors = np.where(self._of_half(k, vectors), image.vector(vectors), vectors)
        return vectors

    def _of_half(self, k: int, values: Array) -> NDArray[np.bool_]:
        """Return True for the pairs of half k, in a shape that broadcasts with values (M, ..., 3)."""
        of_half: NDArray[np.bool_] = np.asarray(self.half == k).reshape(-1, *(1,) * (values.ndim - 1))
        return of_half

    def rotation(self, member: int) -> Array:
        """Return angles (M,), rad, of the touching teeth about a member's own axis, counted from the direction to the
        other axis."""
        mount, other_mount = self.mounts[member], self.mounts[1 - member]
        apart = np.atleast_2d(other_mount.origin - mount.origin)
        common_normal = np.cross(mount.axis, other_mount.axis)
        # parallel or intersecting axes: the vector between the mounts; otherwise the common normal
        along = dot(apart, common_normal)[..., None]
        apart = np.where(np.abs(along) > 0.0, along * common_normal, apart)
        towards = mount.base.inverse.vector(apart)
        angle = np.arctan2(towards[..., 1], towards[..., 0])
        return mount.sign * (self.turns[member] - mount.zero) - angle

    def levers(self, member: int, points: Array, normals: Array) -> Array:
        """Return levers (M, ...), mm, positive, of pressures along `normals` at `points` (M, ..., 3) about a member's
        axis."""
        pairs_last = np.moveaxis(points, 0, -2)
        velocity = np.moveaxis(self.mounts[member].velocity(pairs_last), -2, 0)
        return np.abs(dot(normals, velocity))


def advances_of_halves(gears: GearPair, phi1: Array) -> Array:
    """Return advances (H, P), rad, at which the first tooth pairs of all `halves` touch at rotations phi1 (P,), rad, without load.

    They are -inf where no teeth touch.
    """
    return np.stack(
        [_Followed(row, phi1 + phase).advance for row, phase in zip(gears.halves, gears.phases, strict=True)]
    )


def near_pairs(gears: GearPair, phi1: Array, limit: float) -> NearPairs:
    """Find the tooth pairs apart by less than `limit` (mm) at rotations phi1 (P,), rad, in both halves.

    Raises NoSolutionError where no teeth touch.
    """
    rows = gears.halves
    # pinions of pairs that share the torque are ahead, and have rotations of their own
    turned = [phi1 + phase for phase in gears.phases]
    engagements = [_Followed(row, own) for row, own in zip(rows, turned, strict=True)]
    # the gear rests on the tooth pair that is farthest ahead: the largest advance of all halves is its position without
    # load
    advance = np.max([followed.advance for followed in engagements], axis=0)
    for engagement in engagements:
        engagement.widen(advance, limit)
    if not np.isfinite(advance).all():
        k = int(np.argmin(np.isfinite(advance)))
        raise NoSolutionError(reason=f"no teeth touch at phi1 = {np.degrees(phi1[k]):g} deg; tca shows where they do")
    pair = engagements[0].pair
    near = [followed.near(advance, limit) for followed in engagements]
    # pairs of all halves in one list; each is solved at the rotation at which it does what pair 0 does
    position, number = (np.concatenate(column) for column in zip(*(found[:2] for found in near), strict=True))
    half, paths = np.repeat(np.arange(len(rows)), [len(found[0]) for found in near]), [found[2] for found in near]
    ahead = [_ahead(row, number[half == k]) for k, row in enumerate(rows)]
    pinion_ahead, gear_ahead = (np.concatenate(parts) for parts in zip(*ahead, strict=True))
    if any(row.uneven for row in rows):
        out = [
            farther_out_ahead(row, followed.pair, path, number[half == k])
            for k, (row, followed, path) in enumerate(zip(rows, engagements, paths, strict=True))
        ]
        gear_ahead = gear_ahead + np.concatenate(out)
    touching = [touching_jets(row, path) for row, path in zip(rows, paths, strict=True)]
    jets = [_join(jets_of_rows) for jets_of_rows in zip(*touching, strict=True)]
    path = _join(paths)
    # rotations of both members, the gear ahead by the advance of the pair that touches first
    turns = path.rotation, pair.ratio * (path.rotation - pinion_ahead) + gear_ahead + pair.drive * advance[position]
    # x along the major axis of the contact ellipse, relative curvatures along x and y
    e1, e2 = tangent_basis(jets[0])
    relative = relative_curvature(jets[0], jets[1], e1, e2)
    ellipse, principal_kappa = contact_ellipse(relative, e1, e2, 1.0), principal(relative)
    normal = path.normal
    along = unit(ellipse.major - dot(ellipse.major, normal)[:, None] * normal)
    axes = np.stack((along, np.cross(normal, along), normal), axis=-1)
    kappa = -np.stack((principal_kappa.k1, principal_kappa.k2), axis=-1)
    phi2 = pair.ratio * phi1 + pair.drive * advance
    pinion, gear = gears.mounts
    # the gear of a double helical pair has the mount of the pair's half
    if len(rows) > 1:
        bases = [row.gear.mount.base for row in rows]
        gear = replace(
            gear,
            base=Rigid(
                np.stack([base.rotation for base in bases])[half], np.stack([base.translation for base in bases])[half]
            ),
        )
    found = NearPairs(pair, phi1, phi2, position, number, half, turns, (pinion, gear), path, axes, kappa, gears.images)
    return _over_whole_flanks(found) if pair.coupled else found


def _over_whole_flanks(near: NearPairs) -> NearPairs:
    """Return tooth pairs of coupled members with the middle of both flanks as origin, and x along the axis.

    Their flanks are nearly congruent, so that neither first touch nor its curvatures tell where they touch under load.
    """
    pinion = near.pair.pinion
    middle = pinion.grid[pinion.grid.shape[0] // 2, pinion.grid.shape[1] // 2]
    jet = pinion.surface.jet(middle[0], middle[1])
    # tangent plane of the pinion's flank in its middle, x along the axis and y up the profile
    motions = [mount.at(turn) for mount, turn in zip(near.mounts, near.turns, strict=True)]
    origin, normal = motions[0].point(jet.r), motions[0].vector(jet.n)
    axis = np.broadcast_to(near.mounts[0].axis, normal.shape)
    along = unit(axis - dot(axis, normal)[:, None] * normal)
    across = np.cross(normal, along)
    # the part of the plane that both flanks reach
    ends = []
    for flank, motion in zip(near.pair.flanks, motions, strict=True):
        r = flank.surface.jet(flank.grid[..., 0].ravel(), flank.grid[..., 1].ravel()).r
        places = np.einsum("mij,kj->mki", motion.rotation, r) + (motion.translation - origin)[:, None]
        spans = [np.einsum("mki,mi->mk", places, way) for way in (along, across)]
        ends.append([(span.min(axis=1), span.max(axis=1)) for span in spans])
    (x_low, x_high), (y_low, y_high) = (
        (np.maximum(first[0], second[0]), np.minimum(first[1], second[1])) for first, second in zip(*ends, strict=True)
    )
    # the origin moves to the middle of the common part
    origin = origin + 0.5 * ((x_low + x_high)[:, None] * along + (y_low + y_high)[:, None] * across)
    kind, edge = np.full(len(origin), "line"), np.full(len(origin), "", dtype=near.path.edge.dtype)
    return replace(
        near,
        path=replace(near.path, point=origin, normal=normal, kind=kind, edge=edge),
        axes=np.stack((along, across, normal), axis=-1),
        kappa=np.zeros((len(origin), 2)),
        heights=0.5 * (y_high - y_low),
    )


def _ahead(gears: GearPair, number: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return angles, rad, by which the flanks of tooth pairs lead their nominal places; 0 for equal teeth."""
    if all(member.index == NO_INDEX_ANGLES for member in gears.both):
        return np.zeros(number.shape), np.zeros(number.shape)
    return flanks_ahead(gears, number)


class _Followed:
    """Advances, drive (phi2 - phi1 N1/N2) in rad, of the near tooth pairs on either side of the pair next to phi1
    (P,)."""

    def __init__(self, gears: GearPair, phi1: Array) -> None:
        self.pair, self._gears = solver_pair(gears), gears
        self._phi1, self._pitch = phi1, gears.pitch
        self._first = np.round(phi1 / gears.pitch).astype(np.intp)
        searched = int(np.ceil(np.pi / gears.pitch)) if self.pair.led_all_round else SEARCHED_PAIRS
        self._numbers = np.arange(-searched, searched + 1)
        self._advances, self._levers, self._path = self._solve(self._numbers)
        # rows of the path, one for each position and number
        self._rows = np.arange(self._advances.size).reshape(self._advances.shape)
        if gears.uneven:
            # any pair in engagement may be ahead of its neighbours
            self._search_on(lambda: np.isfinite(self._advances))

    @property
    def advance(self) -> Array:
        """Largest advance (P,); -inf where no teeth touch."""
        greatest: Array = self._advances.max(axis=1)
        return greatest

    def widen(self, advance: Array, limit: float) -> None:
        """Add pairs further out until the outermost pairs are not within `limit`, mm, of `advance` (P,)."""
        self._search_on(lambda: self._near(advance, limit))

    def _search_on(self, wanted: Callable[[], NDArray[np.bool_]]) -> None:
        """Add pairs further out until none of the outermost pairs is `wanted` at a position, (P, K)."""
        for direction in () if self.pair.coupled else (-1, 1):
            outermost = self._numbers[::direction][-1]
            while wanted()[:, ::direction][:, -1].any() and abs(outermost) < MAX_PAIRS:
                new_numbers = outermost + direction * np.arange(1, MORE_PAIRS + 1)
                advances, levers, path = self._solve(new_numbers)
                self._numbers = np.append(self._numbers, new_numbers)
                order = np.argsort(self._numbers)
                self._numbers, outermost = self._numbers[order], new_numbers[-1]
                self._advances = np.concatenate((self._advances, advances), axis=1)[:, order]
                self._levers = np.concatenate((self._levers, levers), axis=1)[:, order]
                added = self._rows.size + np.arange(advances.size).reshape(advances.shape)
                self._rows = np.concatenate((self._rows, added), axis=1)[:, order]
                self._path = _join((self._path, path))

    def near(self, advance: Array, limit: float) -> tuple[NDArray[np.intp], NDArray[np.intp], ContactPath]:
        """Return positions, numbers and contacts (M,) of the pairs that lag `advance` (P,) by less than `limit`, mm."""
        position, column = np.nonzero(self._near(advance, limit))
        return position, self._first[position] + self._numbers[column], _rows(self._path, self._rows[position, column])

    def _near(self, advance: Array, limit: float) -> NDArray[np.bool_]:
        with np.errstate(invalid="ignore"):
            is_near: NDArray[np.bool_] = (advance[:, None] - self._advances) * self._levers < limit
        return is_near

    def _solve(self, numbers: NDArray[np.intp]) -> tuple[Array, Array, ContactPath]:
        """Return advances, and levers at the gear in mm, (P, K), of the pairs `numbers` (K,) counted from the pair next
        to phi1, and their contacts (P K,)."""
        all_numbers = self._first[:, None] + numbers
        pinion_ahead, gear_ahead = _ahead(self._gears, all_numbers)
        # pair k at phi1 is in the position of pair 0 at phi1 - k pitches; a pair without contact there has no advance
        path = contact_path(self.pair, (self._phi1[:, None] - self._pitch * all_numbers + pinion_ahead).ravel())
        if self._gears.uneven:
            out = farther_out_ahead(self._gears, self.pair, path, all_numbers.ravel())
            gear_ahead = gear_ahead + out.reshape(gear_ahead.shape)
        te = path.phi2 - self.pair.ratio * path.rotation + (self.pair.ratio * pinion_ahead - gear_ahead).ravel()
        advance = np.where(path.touching, self.pair.drive * te, -np.inf)
        lever = np.abs(dot(path.normal, self.pair.gear.mount.velocity(path.point)))
        shape = len(self._phi1), len(numbers)
        return advance.reshape(shape), lever.reshape(shape), path


def _join(parts: Sequence[Record]) -> Record:
    """Join records of arrays and tuples of the same type, one after the other; other values are taken from the first
    record."""
    if len(parts) == 1:
        return parts[0]

    def join_values(values: list[Any]) -> Any:
        if isinstance(values[0], np.ndarray):
            return np.concatenate(values)
        return tuple(chain(*values)) if isinstance(values[0], tuple) else values[0]

    names = [field.name for field in fields(parts[0])]
    return replace(parts[0], **{name: join_values([getattr(part, name) for part in parts]) for name in names})


def _rows(path: ContactPath, rows: NDArray[np.intp]) -> ContactPath:
    """Return some rows of a path."""

    def chosen(values: Any) -> Any:
        if isinstance(values, np.ndarray):
            return values[rows]
        return tuple(values[k] for k in rows) if isinstance(values, tuple) else values

    return replace(path, **{field.name: chosen(getattr(path, field.name)) for field in fields(path)})


@dataclass(frozen=True)
class Separation:
    """Unloaded gaps of the tooth pairs (M,) on grids of cells, X along the contact by Y across it."""

    #: lengths (M,) of the cells, mm
    dx: Array
    #: widths (M,) of the cells, mm
    dy: Array
    #: gaps (M, X, Y), mm, along the normal
    gap: Array
    #: cells (M, X, Y) that lie on both flanks
    on: NDArray[np.bool_]
    #: points (M, X, 3), mm, of the ridge, fixed frame
    middle: Array
    #: normals (M, X, 3) at the ridge, out of the pinion, fixed frame
    normal: Array
    #: levers (2, M, X), mm, positive, of pressure at the ridge about the axes of pinion and gear
    levers: Array
    #: points (2, M, X, 3), mm, of the ridge in the frame of each member's touching tooth
    places: Array
    #: motions from the frames of `places` to the fixed frame
    own_to_fixed: tuple[Rigid, Rigid]
    #: directions (M, 3) of y
    across: Array
    #: grids (M,) around a corner of a flank
    corner: NDArray[np.bool_]
    #: ends (2, M), at the least and the largest x, beyond which the flanks continue, though contact was expected to end
    open: NDArray[np.bool_]
    #: start and end (2, M) of the grid as shares of the expected length; never beyond the flanks
    part: Array
    #: distances (2, 2, M), mm along x, from the end face of either member (first index) to the least and the largest x
    #: of the grid (second); inf without an end face, or with one that is too oblique to x
    ends: Array
    #: rows (M, X) in which the ridge follows an edge
    edged: NDArray[np.bool_]
    #: distances (2, M), mm, inward from the least and the largest x to the end of the ridge on the flanks; negative if
    #: the ridge continues beyond the grid
    ridge_ends: Array
    #: gaps (M, X, GAP_NODES), mm, along the normal, at the nodes of polynomials across
    gap_nodes: Array
    #: distances (M, X, GAP_NODES), mm, outside the flanks there
    margin_nodes: Array
    #: width (M,) of the grids over that of the nodes
    narrow: Array

    def copy(self) -> Separation:
        """Return grids whose arrays `put` changes without an effect on these."""
        arrays = {f.name: getattr(self, f.name).copy() for f in fields(self) if f.name != "own_to_fixed"}
        return replace(self, **arrays)

    def some(self, rows: NDArray[np.intp]) -> Separation:
        """Return the grids of some pairs, `rows` (N,)."""
        arrays = {
            f.name: np.take(getattr(self, f.name), rows, axis=PAIR_AXES.get(f.name, 0))
            for f in fields(self)
            if f.name != "own_to_fixed"
        }
        first, second = (Rigid(own.rotation[rows], own.translation[rows]) for own in self.own_to_fixed)
        return replace(self, **arrays, own_to_fixed=(first, second))

    def narrowed(self, rows: NDArray[np.intp], share: Array) -> None:
        """Make the grids of some pairs, `rows` (N,), narrower, to a `share` (N,) of their width: their gaps are those of
        the same polynomials across."""
        self.dy[rows] *= share
        self.narrow[rows] *= share
        self.gap[rows], self.on[rows] = _on_cells(
            self.gap_nodes[rows], self.margin_nodes[rows], self.narrow[rows], self.gap.shape[2]
        )

    def put(self, rows: NDArray[np.intp], other: Separation) -> None:
        """Replace the grids of some pairs, `rows`, by those of another separation, of these pairs alone."""
        for field in fields(self):
            if field.name != "own_to_fixed":
                axis = PAIR_AXES.get(field.name, 0)
                whole, part = (np.moveaxis(getattr(grids, field.name), axis, 0) for grids in (self, other))
                whole[rows] = part


def separation(
    near: NearPairs,
    force: Array,
    modulus: float,
    cells: tuple[int, int],
    widen: Array,
    part: Array | tuple[float, float] = (0.0, 1.0),
) -> Separation:
    """Compute gaps on grids; arguments are those of `_separation`.

    Of grids of one pair that differ in width alone, as those of several torques, only the widest has gaps of its own.
    """
    if near.chosen_from is None:
        return _separation(near, force, modulus, cells, widen, part)
    count = len(near.position)
    ends = np.broadcast_to(np.reshape(part, (2, -1)), (2, count))
    order = np.argsort(-widen, kind="stable")
    first: dict[tuple[float, ...], int] = {}
    of = np.arange(count)
    for row in order.tolist():
        key = (int(near.chosen_from[1][row]), float(ends[0, row]), float(ends[1, row]), float(force[row]))
        widest = first.setdefault(key, row)
        if widen[row] >= MIN_SHARED_WIDTH * widen[widest]:
            of[row] = widest
        else:
            first[key] = row
    kept = np.unique(of)
    if len(kept) == count:
        return _separation(near, force, modulus, cells, widen, part)
    alone = _separation(near.some(kept), force[kept], modulus, cells, widen[kept], ends[:, kept])
    grids = alone.some(np.searchsorted(kept, of))
    narrower = np.flatnonzero(of != np.arange(count))
    grids.narrowed(narrower, (widen / widen[of])[narrower])
    return grids


def _separation(
    near: NearPairs,
    force: Array,
    modulus: float,
    cells: tuple[int, int],
    widen: Array,
    part: Array | tuple[float, float] = (0.0, 1.0),
) -> Separation:
    """Compute gaps on grids of `cells` (X, Y) that are as long and wide as contacts under given forces.

    - `force` (M,): N.
    - `modulus`: E*, MPa.
    - `widen` (M,): factor for the width.
    - `part` (2, M): start and end as shares of the length; below 0 and above 1 up to the ends of the flanks.
    """
    surfaces, (low, high) = near.surfaces, near.range
    # expected half lengths and half widths
    along, across = _sizes(near, force, modulus, np.maximum(0.5 * (high - low), MIN_GRID_LENGTH_MM))
    least, most = low, np.maximum(high, low + MIN_GRID_LENGTH_MM)
    # a line that an edge ends continues along the edge
    (before, after), bends = near.beyond
    extra_before, extra_after = np.minimum((before, after), EDGE_MARGIN * across / bends)
    low = np.where(low < -GRID_MARGIN * along, -GRID_MARGIN * along, low - extra_before)
    high = np.where(high > GRID_MARGIN * along, GRID_MARGIN * along, high + extra_after)
    high = np.maximum(high, low + MIN_GRID_LENGTH_MM)
    # around a corner, flanks lie beside the ridge, and contacts are about as long as wide
    corner_size = np.cbrt(4.0 * force / (np.pi * np.maximum(near.kappa[:, 1], LEAST_KAPPA) * modulus))
    corner = (high - low < corner_size) & (near.heights is None)
    across = np.where(corner, corner_size, across)
    low, high = (
        np.where(corner, low - CORNER_MARGIN * across, low),
        np.where(corner, high + CORNER_MARGIN * across, high),
    )
    # the wanted part of the length, not beyond the flanks
    start, length = low, high - low
    least, most = np.where(corner, -np.inf, least - before), np.where(corner, np.inf, most + after)
    low, high = (np.clip(start + share * length, least, most) for share in part)
    part = np.stack((low - start, high - start)) / length
    goes_on = np.stack((low - least, most - high)) > 1e-6 * length
    half = GRID_MARGIN * across * widen
    dx, dy = (high - low) / cells[0], 2.0 * half / cells[1]
    # exact gaps at Chebyshev nodes across the ridge, gap along the common normal at the ridge
    x = low[:, None] + dx[:, None] * (np.arange(cells[0]) + 0.5)
    ridge, bent, _, on_ridge = surfaces.ridge_and_edge(x)
    surfaces.known = on_ridge
    nodes = _chebyshev_nodes()
    x_nodes = np.repeat(x[:, :, None], GAP_NODES, axis=2)
    seen = surfaces.at(x_nodes, ridge[:, :, None] + half[:, None, None] * nodes, beside=on_ridge)
    # the node in the middle is on the ridge
    middle = seen.node(GAP_NODES // 2)
    normal = _common(near, middle, bent)
    normal_slant = dot(normal, near.axes[:, None, :, 2])
    edged = (near.path.kind == "edge")[:, None] | bent
    exact, margin = _extend(seen, half[:, None, None] * nodes, near.kappa[:, 1], edged)
    gap_nodes = exact * normal_slant[:, :, None]
    gap, on = _on_cells(gap_nodes, margin, np.ones(len(gap_nodes)), cells[1])
    levers = np.stack([near.levers(member, middle.points[0], normal) for member in (0, 1)])
    places = np.stack(
        [
            _each(own.rotation.swapaxes(1, 2), middle.points[0] - own.translation[:, None])
            for own in surfaces.own_to_fixed
        ]
    )
    pinion_motion, gear_motion = surfaces.own_to_fixed
    ends = np.stack([_ends(flank, own, dx) for flank, own in zip(near.pair.flanks, places, strict=True)])
    return Separation(
        dx,
        dy,
        gap,
        on,
        middle.points[0],
        normal,
        levers,
        places,
        (pinion_motion, gear_motion),
        near.axes[..., 1],
        corner,
        goes_on,
        part,
        ends,
        bent | surfaces.along_edge[:, None],
        np.stack((near.range[0] - low, high - near.range[1])),
        gap_nodes,
        margin,
        np.ones(len(gap_nodes)),
    )


def _chebyshev_nodes() -> Array:
    """Return the places (GAP_NODES,) across grids, as shares of their half width, with exact gaps, in falling order."""
    return np.cos(np.pi * np.arange(GAP_NODES) / (GAP_NODES - 1))


def _on_cells(gap_nodes: Array, margin_nodes: Array, narrow: Array, count: int) -> tuple[Array, NDArray[np.bool_]]:
    """Return gaps (M, X, Y), mm, of Y = `count` cells across, and True for cells on the flanks; gaps are 0 elsewhere.

    Cells lie within a share `narrow` (M,) of the nodes. Gaps are polynomials, margins straight lines between nodes.
    """
    nodes = _chebyshev_nodes()
    eta = narrow[:, None] * ((np.arange(count) + 0.5) * 2.0 / count - 1.0)
    chebyshev, degree = np.polynomial.chebyshev.chebvander, GAP_NODES - 1
    polynomials = chebyshev(eta, degree) @ np.linalg.inv(chebyshev(nodes, degree))
    lines = np.stack([np.interp(eta, nodes[::-1], row[::-1]) for row in np.eye(GAP_NODES)], axis=-1)
    gap = gap_nodes @ polynomials.swapaxes(1, 2)
    on = (margin_nodes @ lines.swapaxes(1, 2) <= 0.0) & np.isfinite(gap)
    return np.where(on, gap, 0.0), on


def _common(near: NearPairs, seen: _Seen, bent: NDArray[np.bool_]) -> Array:
    """Return normals (M, X, 3), out of the pinion, along which the bodies press on each other.

    It is the mean normal of both flanks. If one flank touches with an edge, it is the normal of the other flank. An
    edge touches first, or the ridge follows it, where `bent` (M, X).
    """
    pinion_normal, gear_normal = seen.normals[0], -seen.normals[1]
    on_edge = [np.char.find(near.path.edge, name)[:, None] >= 0 for name in MEMBER_NAMES]
    edge_of = [
        (this_edge & ~other_edge) | (bent & (seen.over == k))
        for k, (this_edge, other_edge) in enumerate((on_edge, on_edge[::-1]))
    ]
    mean_normal = unit(pinion_normal + gear_normal)
    normals: Array = np.where(
        edge_of[0][..., None], gear_normal, np.where(edge_of[1][..., None], pinion_normal, mean_normal)
    )
    return normals


def _ends(flank: Flank, places: Array, dx: Array) -> Array:
    """Return distances (2, M), mm along x, of a member's end faces from the ends of grids with ridge points (M, X, 3),
    own frame."""
    distances = np.full((2, len(dx)), np.inf)
    for grid_end, (last_row, row_before) in enumerate(((0, 1), (-1, -2))):
        for name in ("toe", "heel"):
            outside, inner = (flank.edges[name].value(places[:, k]) for k in (last_row, row_before))
            slope = (outside - inner) / dx
            with np.errstate(all="ignore"):
                distance = np.where(slope > MIN_END_COSINE, np.maximum(-outside / slope - 0.5 * dx, 0.0), np.inf)
            distances[grid_end] = np.fmin(distances[grid_end], distance)
    return distances


def _extend(seen: _Seen, y: Array, kappa: Array, edged: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return gaps and margins (M, X, GAP_NODES) at y (M, 1, GAP_NODES) from the ridge, continued where a surface ends.

    A surface ends, or it turns back at a cusp and is suddenly far outside. There the margin is |y|, and the gap is a
    parabola with its apex on the ridge, fitted to the known gaps. At an edge, `edged` (M, X), the gap instead has a
    fitted slope and the curvature `kappa`.
    """
    middle = GAP_NODES // 2
    # a margin that rises faster than the way across belongs to another sheet of the surface, beyond a cusp
    with np.errstate(invalid="ignore"):
        leap = seen.margin - seen.margin[:, :, middle : middle + 1] > MAX_MARGIN_SLOPE * np.abs(y)
    known = np.isfinite(seen.gap) & ~leap
    lowest = seen.gap[:, :, middle : middle + 1]
    y_known = np.where(known, y, 0.0)
    parabola = 0.5 * kappa[:, None, None] * y**2
    # least squares over the known gaps: c y^2 at smooth places; at edges a slope and the known curvature
    with np.errstate(all="ignore"):
        rise = np.where(known, seen.gap - lowest, 0.0)
        curved = np.nan_to_num((rise * y_known**2).sum(axis=2) / (y_known**4).sum(axis=2))
        sloped = np.nan_to_num(((rise - parabola) * y_known).sum(axis=2) / (y_known**2).sum(axis=2))
    models = sloped[:, :, None] * y + parabola, curved[:, :, None] * y**2
    guess = lowest + np.where(edged[:, :, None], *models)
    return np.where(known, seen.gap, guess), np.where(known & np.isfinite(seen.margin), seen.margin, np.abs(y))


def _sizes(near: NearPairs, force: Array, modulus: float, length: Array) -> tuple[Array, Array]:
    """Return Hertz semi-axes (M,) along and across, mm, of contacts under forces (M,); a contact is at most twice a
    `length` (M,) long. Whole flanks have their own sizes."""
    if near.heights is not None:
        return length, near.heights
    # a point contact; a line contact if the ellipse would be longer than the flanks
    kappa_along, kappa_across = near.kappa[:, 0], np.maximum(near.kappa[:, 1], 1e-9)
    ellipse = point_contact(np.maximum(kappa_along, 1e-6 * kappa_across), kappa_across, force, modulus)
    line = line_contact(kappa_across, 0.5 * force / length, modulus)
    is_line = ellipse.semi_major > length
    return np.where(is_line, length, ellipse.semi_major), np.where(is_line, line.half_width, ellipse.semi_minor)


def _range(surfaces: _Surfaces, near: NearPairs) -> tuple[Array, Array]:
    """Return the least and the largest x (M,) at which the ridge lies on both flanks."""
    low, high = surfaces.extent
    share = np.linspace(0.0, 1.0, SCAN_PLACES)
    x = low[:, None] + (high - low)[:, None] * share
    _, on_ridge = surfaces.ridge(x)
    surfaces.known, margin = on_ridge, on_ridge.margin
    edge = near.path.kind == "edge"
    on = np.where(np.isfinite(margin), margin, np.inf) <= np.where(edge, EDGE_TOLERANCE_MM, 0.0)[:, None]
    # start from the place nearest to first touch, and go outward while places lie on the flanks
    nearest = np.where(on, np.abs(x), np.inf).argmin(axis=1)
    pairs = np.arange(len(x))
    ends = []
    for step in (-1, 1):
        last_on = nearest.copy()
        for _ in range(SCAN_PLACES):
            next_place = np.clip(last_on + step, 0, SCAN_PLACES - 1)
            last_on = np.where(on[pairs, next_place], next_place, last_on)
        # the end lies between the last place on the flanks and the first place beyond, by linear interpolation
        beyond = np.clip(last_on + step, 0, SCAN_PLACES - 1)
        inside, outside = margin[pairs, last_on], margin[pairs, beyond]
        with np.errstate(all="ignore"):
            way_share = np.where(np.isfinite(outside) & (outside > inside), -inside / (outside - inside), 0.0)
        if surfaces.along_edge.any():
            way_share = np.where(
                surfaces.along_edge, _edge_share(surfaces, x[pairs, last_on], x[pairs, beyond]), way_share
            )
        ends.append(x[pairs, last_on] + np.clip(way_share, 0.0, 1.0) * (x[pairs, beyond] - x[pairs, last_on]))
    return ends[0], ends[1]


def _edge_share(surfaces: _Surfaces, inside: Array, beyond: Array) -> Array:
    """Return the share (M,) of the way from x `inside` the flanks to x `beyond` that an edge continues.

    The ridge lies on the edge, so that its distance outside the flanks is 0 and cannot be interpolated.
    """
    share = np.linspace(0.0, 1.0, EDGE_PLACES)
    x = inside[:, None] + (beyond - inside)[:, None] * share
    margin = surfaces.ridge(x)[1].margin
    off = ~(np.where(np.isfinite(margin), margin, np.inf) <= EDGE_TOLERANCE_MM)
    off[:, 0] = False
    return share[np.where(off.any(axis=1), off.argmax(axis=1) - 1, EDGE_PLACES - 1)]


def _beyond(surfaces: _Surfaces, ends: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return lengths (2, M), mm, by which edges continue beyond the `ends` (M,) of ridges, and tangents of the angles
    between ridge and edge."""
    lengths, bends = [], []
    for end, far in zip(ends, surfaces.extent, strict=True):
        x = end[:, None] + (far - end)[:, None] * np.linspace(0.0, 1.0, SCAN_PLACES)[1:]
        y, bent, ridge, _ = surfaces.ridge_and_edge(x[:, :1])
        # the edge counts only up to the first place at which the ridge has left it
        last_on_edge, rows = np.full(len(x), -1), np.flatnonzero(bent[:, 0])
        if rows.size:
            along = surfaces.some(rows).ridge_and_edge(x[rows])[1]
            last_on_edge[rows] = np.where(along.all(axis=1), along.shape[1], along.argmin(axis=1)) - 1
        pairs = np.arange(len(x))
        lengths.append(np.where(last_on_edge < 0, 0.0, np.abs(x[pairs, last_on_edge] - end)))
        with np.errstate(all="ignore"):
            slope = np.abs(y - ridge)[:, 0] / np.abs(x[:, 0] - end)
        bends.append(np.where((last_on_edge < 0) | ~(slope > MIN_EDGE_TANGENT), np.inf, slope))
    return np.stack(lengths), np.stack(bends)


@dataclass(frozen=True)
class _Seen:
    """Both flanks over places in the tangent planes."""

    #: gaps (...,), mm, along the normal of the plane
    gap: Array
    #: distances (...,), mm, by which the places lie outside the flanks; negative inside both
    margin: Array
    #: flank (...,) that the place is farther outside of: 0 pinion, 1 gear
    over: NDArray[np.intp]
    #: points (..., 3), mm, of both flanks, fixed frame
    points: tuple[Array, Array]
    #: outward normals (..., 3) of both flanks, fixed frame
    normals: tuple[Array, Array]
    #: the places x, y (...,), mm
    places: tuple[Array, Array]
    #: surface parameters (..., 2) of both flanks
    parameters: tuple[Array, Array]
    #: change (..., 2, 2) of these parameters (first index) per mm along x and y (second)
    rates: tuple[Array, Array]

    def node(self, k: int) -> _Seen:
        """Return the flanks at index k of the third axis of the places."""
        return self._chosen(lambda values: values[:, :, k])

    def some(self, rows: NDArray[np.intp]) -> _Seen:
        """Return some rows of the places."""
        return self._chosen(lambda values: values[rows])

    def next_to(self, x: Array) -> tuple[_Seen, Array]:
        """Return the places next to x (M, L) of these (M, K), which have equal steps in x, and y at x between these."""
        own_x, own_y = self.places
        last = own_x.shape[1] - 1
        step = np.clip((x - own_x[:, :1]) * (last / (own_x[:, -1:] - own_x[:, :1])), 0.0, last)
        low = np.minimum(step.astype(np.intp), last - 1)
        below, above = (np.take_along_axis(own_y, low + k, axis=1) for k in (0, 1))
        row, nearest = np.arange(len(x))[:, None], np.round(step).astype(np.intp)
        return self._chosen(lambda values: values[row, nearest]), below + (step - low) * (above - below)

    def guess(self, member: int, x: Array, y: Array) -> Array:
        """Return parameters (..., 2) of a member's flank over places x, y (...,) beside these, by their rates.

        Several places beside each of these have one axis more.
        """
        parameters, rates, (own_x, own_y) = self.parameters[member], self.rates[member], self.places
        if x.ndim > own_x.ndim:
            own_x, own_y, parameters, rates = (
                own_x[..., None],
                own_y[..., None],
                parameters[..., None, :],
                rates[..., None, :, :],
            )
        away = np.stack((x - own_x, y - own_y), axis=-1)
        return np.asarray(parameters + (rates @ away[..., None])[..., 0])

    def _chosen(self, choose: Callable[[NDArray[Any]], NDArray[Any]]) -> _Seen:
        """Return the record of those values that a function takes from each array."""
        pairs = self.points, self.normals, self.places, self.parameters, self.rates
        return _Seen(
            choose(self.gap),
            choose(self.margin),
            choose(self.over),
            *((choose(first), choose(second)) for first, second in pairs),
        )


class _Surfaces:
    """Flanks of near pairs as heights over their tangent planes."""

    def __init__(self, near: NearPairs) -> None:
        self._near = near
        self.own_to_fixed = []
        for mount, turn in zip(near.mounts, near.turns, strict=True):
            motion = mount.at(turn)
            shape = near.path.point.shape
            self.own_to_fixed.append(
                Rigid(np.broadcast_to(motion.rotation, near.axes.shape), np.broadcast_to(motion.translation, shape))
            )
        self._frames = [
            Rigid(motion.rotation.swapaxes(-1, -2) @ near.axes, motion.inverse.point(near.path.point))
            for motion in self.own_to_fixed
        ]
        self._edge = near.path.kind == "edge"
        # the middle of whole flanks, or the edge that touches first, is where the grid is
        self._fixed = self._edge | (near.heights is not None)
        self._known: _Seen | None = None

    @property
    def known(self) -> _Seen | None:
        """Known places (M, K) on the ridge, in equal steps of x, from which the search for other places begins; by default
        the places known of all pairs."""
        if self._known is None and self._near.chosen_from is not None:
            every_pair, rows = self._near.chosen_from
            known = every_pair.surfaces.known
            self._known = None if known is None else known.some(rows)
        return self._known

    @known.setter
    def known(self, seen: _Seen) -> None:
        self._known = seen

    def some(self, rows: NDArray[np.intp]) -> _Surfaces:
        """Return the flanks of the pairs `rows` (N,)."""
        return self._near.some(rows).surfaces

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """Least and largest x (M,) that both flanks reach."""
        ends = []
        for flank, frame in zip(self._near.pair.flanks, self._frames, strict=True):
            r = flank.surface.jet(flank.grid[..., 0].ravel(), flank.grid[..., 1].ravel()).r
            x = (
                np.einsum("kj,mj->mk", r, frame.rotation[:, :, 0])
                - dot(frame.translation, frame.rotation[:, :, 0])[:, None]
            )
            ends.append((np.nanmin(x, axis=1), np.nanmax(x, axis=1)))
        return np.maximum(ends[0][0], ends[1][0]), np.minimum(ends[0][1], ends[1][1])

    def ridge(self, x: Array) -> tuple[Array, _Seen]:
        """Return y (M, K) of the least gap at x (M, K), and the flanks there, within the tolerance of the ridge.

        Where whole flanks or an edge touch first, y is 0; if this edge runs along x, y is on the edge.
        """
        kappa, fixed = np.maximum(self._near.kappa[:, 1:], LEAST_KAPPA), self._fixed[:, None]
        max_step, curvature = np.sqrt(2.0 * MAX_STEP_GAP_MM / kappa), np.broadcast_to(kappa, x.shape)
        y, known = np.zeros_like(x), None
        if self.known is not None:
            known, known_y = self.known.next_to(x)
            y = np.where(fixed, 0.0, known_y)
        beside = self.at(x, y, beside=known)
        last_step, last_slope = np.zeros_like(y), np.zeros_like(y)
        for k in range(RIDGE_STEPS):
            beside = self.at(x, y, beside=beside) if k else beside
            # secant method for slope of the gap = 0 along y. The curvature stays positive and near the curvature at
            # first touch: steps then lead to the minimum of the gap next to first touch, never to a maximum
            slopes = [
                -dot(n, self._near.axes[:, None, :, 1]) / dot(n, self._near.axes[:, None, :, 2]) for n in beside.normals
            ]
            slope = slopes[1] - slopes[0]
            if k:
                with np.errstate(all="ignore"):
                    curvature = np.where(
                        np.abs(last_step) > POINT_TOLERANCE_MM, (slope - last_slope) / last_step, curvature
                    )
                curvature = np.clip(
                    np.where(np.isfinite(curvature), curvature, kappa),
                    kappa / MAX_CURVATURE_RATIO,
                    kappa * MAX_CURVATURE_RATIO,
                )
            step = np.clip(-slope / curvature, -max_step, max_step)
            last_step, last_slope = np.where(np.isfinite(step) & ~fixed, step, 0.0), slope
            y = y + last_step
            if np.abs(last_step).max(initial=0.0) < RIDGE_TOLERANCE_MM:
                break
        if self.along_edge.any():
            y = self._on_edge(x, y, beside)
        same = np.abs(y - beside.places[1]).max(initial=0.0) < RIDGE_TOLERANCE_MM
        return y, beside if same else self.at(x, y, beside=beside)

    def ridge_and_edge(self, x: Array) -> tuple[Array, NDArray[np.bool_], Array, _Seen]:
        """Return y (M, K) of the least gap at x (M, K), True where it lies on an edge, y of the ridge alone, and the
        flanks on the ridge.

        Where the ridge has left a flank over an edge, the least gap lies on this edge. Edges that run across x, as end
        faces, do not count.
        """
        ridge, on_ridge = self.ridge(x)
        margin = on_ridge.margin
        outside = (margin > 0.0) & ~self.along_edge[:, None]
        rows = np.flatnonzero(outside.any(axis=1))
        y, bent = ridge.copy(), np.zeros_like(outside)
        if rows.size:
            x_outside, y_edge, on_edge = x[rows], ridge[rows], on_ridge.some(rows)
            # Newton steps along y to the edge, where the distance outside the flanks is 0
            with np.errstate(all="ignore"):
                further = self.at(x_outside, y_edge + SLOPE_STEP_MM, rows, on_edge)
                slope = (further.margin - on_edge.margin) / SLOPE_STEP_MM
                # a small slope belongs to another edge, such as an end face, which the ridge does not follow
                steep = outside[rows] & (np.abs(slope) > MIN_EDGE_SLOPE)
                for _ in range(EDGE_STEPS):
                    y_edge = y_edge + np.where(steep, -on_edge.margin / slope, 0.0)
                    on_edge = self.at(x_outside, y_edge, rows, on_edge)
                bent[rows] = steep & (np.abs(on_edge.margin) < EDGE_TOLERANCE_MM)
            y[rows] = np.where(bent[rows], y_edge, ridge[rows])
        return y, bent, ridge, on_ridge

    @cached_property
    def along_edge(self) -> NDArray[np.bool_]:
        """Pairs (M,) that first touch on an edge that runs along x, as tips of spur gears do.

        The direction of the edge is measured on both sides of first touch, which may be a corner of the flank.
        """
        if self._near.chosen_from is not None:
            every_pair, rows = self._near.chosen_from
            return every_pair.surfaces.along_edge[rows]
        low, high = self.extent
        probe_length = PROBE_SHARE * (high - low)
        along = np.zeros(len(probe_length), dtype=bool)
        for side in (-1.0, 1.0):
            x = side * probe_length[:, None] * np.array([1.0, 2.0, 1.0])
            probe_margin, further_margin, beside_margin = self.at(
                x, np.broadcast_to([0.0, 0.0, SLOPE_STEP_MM], x.shape)
            ).margin.T
            slope = np.abs(beside_margin - probe_margin) / SLOPE_STEP_MM
            with np.errstate(invalid="ignore"):
                near = (slope > MIN_EDGE_SLOPE) & (np.abs(probe_margin) < 2.0 * MAX_EDGE_TANGENT * probe_length)
                along |= near & (np.abs(further_margin - probe_margin) < MAX_EDGE_TANGENT * probe_length)
        return np.asarray(along & self._edge)

    def _on_edge(self, x: Array, y: Array, beside: _Seen) -> Array:
        """Return y (M, K) after Newton steps on to edges that run along x; y of other pairs is unchanged. Flanks are known
        `beside` these places."""
        rows, y = np.flatnonzero(self.along_edge), y.copy()
        x_along, on_edge = x[rows], beside.some(rows)
        for _ in range(EDGE_STEPS):
            on_edge = self.at(x_along, y[rows], rows, on_edge)
            further = self.at(x_along, y[rows] + SLOPE_STEP_MM, rows, on_edge)
            slope = (further.margin - on_edge.margin) / SLOPE_STEP_MM
            with np.errstate(all="ignore"):
                step = -on_edge.margin / slope
            # beyond the end face lies another edge: its slope is small or it is far away
            same_edge = (np.abs(slope) > MIN_EDGE_SLOPE) & (np.abs(y[rows] + step) < MAX_EDGE_OFFSET_MM)
            y[rows] += np.where(same_edge, step, 0.0)
        return y

    def at(self, x: Array, y: Array, rows: NDArray[np.intp] | None = None, beside: _Seen | None = None) -> _Seen:
        """Return both flanks over places x, y (M, ...); `rows` (M,) selects some of the pairs. The search begins from
        the places `beside` these."""
        heights, margins, points, normals, parameters, rates = [], [], [], [], [], []
        selected = slice(None) if rows is None else rows
        for member, (flank, whole, plane) in enumerate(
            zip(self._near.pair.flanks, self.own_to_fixed, self._frames, strict=True)
        ):
            own, frame = (Rigid(motion.rotation[selected], motion.translation[selected]) for motion in (whole, plane))
            seen = _over(flank, frame, x, y, None if beside is None else beside.guess(member, x, y))
            parameters.append(seen[4])
            rates.append(seen[5])
            heights.append(seen[0])
            margins.append(seen[1])
            points.append(_each(own.rotation, seen[2]) + own.translation.reshape(-1, *(1,) * (x.ndim - 1), 3))
            normals.append(_each(own.rotation, seen[3]))
        over = (margins[1] > margins[0]).astype(np.intp)
        return _Seen(
            heights[1] - heights[0],
            np.maximum(*margins),
            over,
            (points[0], points[1]),
            (normals[0], normals[1]),
            (x, y),
            (parameters[0], parameters[1]),
            (rates[0], rates[1]),
        )


def _each(rotation: Array, vectors: Array) -> Array:
    """Return vectors (M, ..., 3), rotated by rotations (M, 3, 3)."""
    rotated: Array = np.einsum("mij,m...j->m...i", rotation, vectors)
    return rotated


def _over(
    flank: Flank, frame: Rigid, x: Array, y: Array, guess: Array | None = None
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Return a flank over places x, y (M, ...) of planes `frame` (M,), own frame.

    Values are the heights along the third axis, distances outside the flank in mm, (M, ...), points and normals
    (M, ..., 3), surface parameters (M, ..., 2) and their change (M, ..., 2, 2) per mm along x and y. The first two are
    NaN where the surface has no point. `guess` (M, ..., 2): parameters next to those.
    """
    shape, count = x.shape, x.size
    plane_index = np.broadcast_to(np.arange(len(x)).reshape(-1, *(1,) * (x.ndim - 1)), shape).ravel()
    axes, origin = frame.rotation[plane_index], frame.translation[plane_index]
    xy = np.stack((x.ravel(), y.ravel()), axis=-1)
    spans = np.abs(np.ptp(flank.grid.reshape(-1, 2), axis=0))

    # Newton's method for the surface parameters (u, v) of the point over (x, y). The start has the same radius and z,
    # or is next to the place, so that the root lies on the sheet of the flank; without a root the surface has no point
    # there
    def residual(p: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        jet = flank.surface.jet(p[:, 0], p[:, 1])
        return _beside_plane(jet, axes[index], origin[index], xy[index])

    with np.errstate(all="ignore"):
        values, known, rows = np.empty((count, 2)), np.ones(count, dtype=bool), np.arange(count)
        if guess is not None:
            values[rows] = found = _stepped(residual, guess.reshape(count, 2), 0.5 * spans)
            rows = np.flatnonzero(np.isnan(found[:, 0]))
        if rows.size:
            place = origin[rows] + np.einsum("kij,kj->ki", axes[rows][:, :, :2], xy[rows])
            start = flank.heights.parameters_at(flank.mount.joint.radius(place), place[:, 2])
            values[rows] = found = _stepped(lambda p, index: residual(p, rows[index]), start, 0.5 * spans)
            hard = np.isnan(found[:, 0])
            if hard.any():
                rows = rows[hard]
                root = newton.solve(
                    lambda p, index: residual(p, rows[index]),
                    start[hard],
                    tolerance=POINT_TOLERANCE_MM,
                    max_step=0.5 * spans,
                    max_iterations=15,
                )
                values[rows], known[rows] = root.values, root.converged
        jet = flank.surface.jet(values[:, 0], values[:, 1])
        height = np.where(known, dot(jet.r - origin, axes[:, :, 2]), np.nan)
        margin = np.where(known, flank.margin(values, jet.r), np.nan)
        rates = _inverse(_beside_plane(jet, axes, origin, xy)[1])
    return (
        height.reshape(shape),
        margin.reshape(shape),
        jet.r.reshape(*shape, 3),
        jet.n.reshape(*shape, 3),
        values.reshape(*shape, 2),
        rates.reshape(*shape, 2, 2),
    )


def _beside_plane(jet: Jet, axes: Array, origin: Array, xy: Array) -> tuple[Array, Array]:
    """Return the way (N, 2), mm, from places `xy` in planes to the feet of points, and its change (N, 2, 2) with the
    surface parameters."""
    plane = axes[:, :, :2]
    rates = [np.einsum("ki,kij->kj", d, plane) for d in (jet.r_u, jet.r_v)]
    return np.einsum("ki,kij->kj", jet.r - origin, plane) - xy, np.stack(rates, axis=-1)


def _inverse(matrices: Array) -> Array:
    """Return the inverse of matrices (N, 2, 2)."""
    (a, b), (c, d) = np.moveaxis(matrices, 0, -1)
    inverse: Array = np.array([[d, -b], [-c, a]]) / (a * d - b * c)
    return np.moveaxis(inverse, -1, 0)


def _stepped(residual: newton.Residual, start: Array, max_step: Array) -> Array:
    """Return surface parameters (N, 2) after plain Newton steps; NaN where `POINT_STEPS` do not suffice, where the
    residual rises, and where a step is longer than `max_step` (2,)."""
    values, solved = start.copy(), np.full_like(start, np.nan)
    active, size = np.arange(len(start)), np.full(len(start), np.inf)
    for _ in range(POINT_STEPS):
        f, matrix = residual(values[active], active)
        norm = np.abs(f).max(axis=1)
        met = norm < POINT_TOLERANCE_MM
        solved[active[met]] = values[active[met]]
        step = -(_inverse(matrix) @ f[..., None])[..., 0]
        on = ~met & (norm < size[active]) & (np.abs(step) <= max_step).all(axis=1)
        size[active] = norm
        active = active[on]
        values[active] += step[on]
        if not active.size:
            break
    return solved
