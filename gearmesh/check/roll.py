"""The roll test: the gear is turned until two flanks first touch, and the region closer than delta is measured.

The test knows only two flanks (triangle meshes, or dense grids of exact points) and the positions of the members. It is
an independent check of the contact solver, with which it shares no equation: it contains distances, but no curvatures
and no tangency conditions.

1. Touch. Every circle about the gear's axis that meets both flanks gives the turn of the gear at which its two points
   meet. The largest turn is the first touch (`touch.first_touch`).
2. Patch. Distances are measured along the common normal over the common tangent plane. The part closer than delta is
   measured by its area, centroid and second moments (`_patch`). An ellipse with semi-axis a has the second moment a^2 /
   4.
"""

from __future__ import annotations

from dataclasses import field

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.check.heightfield import Field, HeightFlank, Rays, along, as_flank
from gearmesh.check.touch import first_touch
from gearmesh.check.windings import WoundTouch, in_mesh, middle, windings
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.records import dataclass
from gearmesh.teeth.mount import Mount

#: default gap that bounds the patch
DEFAULT_DELTA_MM = 0.00635
#: points across a lattice that searches the patch; 4 m + 1, so that every second point forms a lattice, too
SEARCH_POINTS = 33
#: points across the final lattice; 4 m + 1, too
PATCH_POINTS = 97
#: half sides of a lattice, in semi-axes of the patch
LATTICE_MARGIN = 1.4


@dataclass(frozen=True)
class RollContact:
    """Contact at one position of the roll test; vectors are in the fixed frame, NaN where the flanks never meet.

    The patch is the part of the common tangent plane in which the flanks are closer than delta. Its semi-axes belong to
    the ellipse with the same second moments. The centre deviates from the contact point in proportion to delta, because
    the gap is not symmetric. `centre_limit` extrapolates the centres for delta and delta / 2 to 0. On meshes it is a
    far better contact point than `point`, which is at the highest facets.
    """

    #: rotation of the pinion, rad
    phi1: float
    #: rotation of the gear, rad, as the source counts it
    phi2: float
    #: point of first touch (3,), mm
    point: Array
    #: mean unit normal (3,) of both members there, out of the pinion; on meshes the normal of facets
    normal: Array
    #: larger semi-axis of the patch, mm
    semi_major: float
    #: smaller semi-axis of the patch, mm
    semi_minor: float
    #: unit vector (3,) along the larger semi-axis
    major: Array
    #: unit vector (3,) along the smaller semi-axis
    minor: Array
    #: centroid (3,) of the patch in the tangent plane, mm
    centre: Array
    #: centroid (3,) extrapolated to delta = 0, mm
    centre_limit: Array
    #: area of the patch in the tangent plane, mm^2
    area: float
    #: True if the patch reaches the edge of a flank, so that its moments are not those of an ellipse
    cut_by_edge: bool
    #: number of evaluated places
    lattice_points: int
    #: gap map: points (M, N, 3) of the pinion in the pinion's frame, mm
    map_points: Array = field(repr=False)
    #: gap map: gap (M, N), mm, NaN beyond the flanks
    map_gap: Array = field(repr=False)

    @property
    def touching(self) -> bool:
        """True if the flanks meet within a full turn of the gear."""
        return bool(np.isfinite(self.phi2))


def roll(
    pinion: TriangleMesh | Array | HeightFlank,
    gear: TriangleMesh | Array | HeightFlank,
    mounts: tuple[Mount, Mount],
    ratio: float,
    phi1: ArrayLike,
    drive: int,
    delta: float = DEFAULT_DELTA_MM,
    guess_phi2: ArrayLike | None = None,
    turns: float = 0.0,
) -> tuple[RollContact, ...]:
    """Roll two flanks against each other at pinion rotations phi1 (P,), rad.

    - `pinion`, `gear`: the touching flank of one tooth each, in the members' own frames: triangle meshes, or structured
      grids of exact points (I, J, 3).
    - `drive`: +1 if the pinion pushes the gear towards larger phi2; phi2 is then the smallest rotation without
      penetration. -1 if it pushes towards smaller phi2; phi2 is then the largest such rotation.
    - `delta`: gap that bounds the patch, mm.
    - `guess_phi2`: (P,) or (). Whole turns are added to phi2 to bring it next to this rotation. Without it the first
      position is within half a turn of 0, and each following position is near its predecessor by the nominal `ratio` d
      phi2 / d phi1.
    - `turns`: number of turns of the pinion's flank about its axis. On a thread the winding next to the guessed phi2
      counts.

    Raises DesignError for a drive other than +-1 or a delta that is not positive.
    """
    if drive not in (1, -1):
        raise DesignError("drive", drive, allowed="+1 or -1")
    if not (np.isfinite(delta) and delta > 0.0):
        raise DesignError("delta", delta, unit="mm", allowed="more than 0")
    pinion, gear = as_flank(pinion), as_flank(gear)
    angles = np.atleast_1d(np.asarray(phi1, dtype=float))
    guesses = None if guess_phi2 is None else np.broadcast_to(np.asarray(guess_phi2, dtype=float), angles.shape)

    gear_arcs = arcs_over(gear, mounts[1].own_to_turning, drive * mounts[1].sign, side=-1.0, joint=mounts[1].joint)
    pieces = windings(pinion, turns)
    contacts: list[RollContact] = []
    for i, angle in enumerate(angles):
        if guesses is not None:
            guess = float(guesses[i])
        elif contacts and contacts[-1].touching:
            guess = contacts[-1].phi2 + ratio * (angle - contacts[-1].phi1)
        else:
            guess = 0.0
        contacts.append(_roll_once(pieces, gear, gear_arcs, mounts, ratio, float(angle), drive, delta, guess))
    return tuple(contacts)


def _roll_once(
    pieces: tuple[HeightFlank, ...],
    gear: HeightFlank,
    gear_arcs: Field,
    mounts: tuple[Mount, Mount],
    ratio: float,
    phi1: float,
    drive: int,
    delta: float,
    guess: float,
) -> RollContact:
    """Return the contact at one position; `gear_arcs` is the unturned gear over circles about its axis."""
    # all computations are in the frame of the gear's bearing, whose z axis is the gear's axis
    base_to_fixed = mounts[1].base
    pinion_to_base = base_to_fixed.inverse @ mounts[0].at(phi1)
    sense, joint = drive * mounts[1].sign, mounts[1].joint
    touches = []
    for piece in pieces:
        arcs = arcs_over(piece, pinion_to_base, sense, side=1.0, joint=joint)
        if (contact := first_touch(arcs, gear_arcs, along(joint, sense, 0.0))) is not None:
            aside = abs(float(pinion_to_base.inverse.point(contact.point)[2]) - middle(piece))
            touches.append(
                WoundTouch(piece, contact, joint.nearest(mounts[1].zero + drive * contact.turn, guess), aside)
            )
    best = in_mesh(touches, guess, ratio, drive, anywhere=True)
    if best is None:
        return _nowhere(phi1)
    pinion, touch, phi2 = best.piece, best.touch, best.phi2

    # the patch: gaps along the mean normal at the point of first touch, with the gear turned to touch
    gear_to_base = joint.to(sense * touch.turn) @ mounts[1].own_to_turning
    normal = unit(touch.pinion_normal + gear_to_base.vector(touch.gear_normal))
    base_to_tangent = _tangent_frame(touch.point, normal).inverse
    patch = _patch(
        pinion.over(Rays(), base_to_tangent @ pinion_to_base, side=1.0),
        gear.over(Rays(), base_to_tangent @ gear_to_base, side=-1.0),
        delta,
        touch.cell,
    )
    tangent_to_fixed = base_to_fixed @ base_to_tangent.inverse
    tangent_to_pinion = mounts[0].at(phi1).inverse @ tangent_to_fixed
    minor, major = _in_space(patch.shape.axes.T)
    return RollContact(
        phi1=phi1,
        phi2=phi2,
        point=base_to_fixed.point(touch.point),
        normal=base_to_fixed.vector(normal),
        semi_major=float(patch.shape.halves[1]),
        semi_minor=float(patch.shape.halves[0]),
        major=tangent_to_fixed.vector(major),
        minor=tangent_to_fixed.vector(minor),
        centre=tangent_to_fixed.point(_in_space(patch.shape.centre)),
        centre_limit=tangent_to_fixed.point(_in_space(patch.centre_limit)),
        area=patch.shape.area,
        cut_by_edge=patch.cut_by_edge,
        lattice_points=touch.count + patch.count,
        map_points=tangent_to_pinion.point(patch.points),
        map_gap=patch.gap,
    )


def _nowhere(phi1: float) -> RollContact:
    none, nan = np.full(3, np.nan), float("nan")
    return RollContact(phi1, nan, none, none, nan, nan, none, none, none, none, nan, False, 0, *_no_map())


def _no_map() -> tuple[Array, Array]:
    return np.zeros((0, 0, 3)), np.zeros((0, 0))


# --- first touch ------------------------------------------------------------------------------------------------------


def arcs_over(
    flank: HeightFlank, own_to_base: Rigid, sense: float, side: float, joint: Joint = REVOLUTE_JOINT
) -> Field:
    """Return a flank over circles about the gear's axis, or over the lines along which it slides.

    Heights increase in the direction in which the gear is pushed.
    """
    x, y, _ = own_to_base.point(flank.points).mean(axis=0)
    return flank.over(along(joint, sense, float(np.arctan2(y, x))), own_to_base, side)


# --- patch ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _PatchShape:
    """Moments of a patch in the tangent plane."""

    #: area, mm^2
    area: float
    #: centroid (2,), mm
    centre: Array
    #: semi-axes (2,), ascending, mm
    halves: Array
    #: unit vectors along the semi-axes as columns (2, 2)
    axes: Array


@dataclass(frozen=True)
class _Lattice:
    """Gap (M, M) in mm at points (M, M, 3) of the pinion, in the tangent frame; NaN beyond the flanks."""

    points: Array
    gap: Array

    def rim_is_near(self, delta: float) -> bool:
        rim = np.concatenate((self.gap[0], self.gap[-1], self.gap[:, 0], self.gap[:, -1]))
        return bool((rim < delta).any())

    def is_cut(self, delta: float) -> bool:
        """Return True if a place closer than delta has a neighbour beyond the flanks."""
        missing = np.pad(np.isnan(self.gap), 1)
        beside = missing[:-2, 1:-1] | missing[2:, 1:-1] | missing[1:-1, :-2] | missing[1:-1, 2:]
        return bool((beside & (self.gap < delta)).any())


@dataclass(frozen=True)
class _Patch:
    """Measured patch, and the lattice on which it was measured."""

    #: shape of the part closer than delta
    shape: _PatchShape
    #: centroid (2,) extrapolated to delta = 0, mm
    centre_limit: Array
    #: points (M, M, 3) of the pinion on the lattice, mm
    points: Array
    #: gaps (M, M), mm
    gap: Array
    #: True if the patch reaches the edge of a flank
    cut_by_edge: bool
    #: number of evaluated places
    count: int


def _patch(pinion: Field, gear: Field, delta: float, start: float) -> _Patch:
    """Return the part of the tangent plane in which the flanks are closer than delta.

    A lattice is laid over the contact and then turned and stretched to the patch found on it, until both agree. A patch
    that fills the lattice makes the lattice larger. The final lattice is finer. Gaps are measured along the common
    normal times its cosine with the mean of the two local normals: the shortest distance, to second order. The result
    is NaN if no lattice fits, as on edges with almost no patch.
    """
    shape = _PatchShape(0.0, np.zeros(2), np.full(2, start), np.eye(2))
    margin, points, count = LATTICE_MARGIN, SEARCH_POINTS, 0
    for _ in range(60):
        sides = margin * shape.halves
        lattice = _lattice(pinion, gear, shape.centre, shape.axes * sides, points)
        count += lattice.gap.size
        better = _measure(lattice, shape, sides, delta)
        # no place closer than delta: try a smaller lattice
        if better is None:
            shape = _PatchShape(0.0, shape.centre, shape.halves / 4.0, shape.axes)
            continue
        # a lattice that fits is enlarged, made finer, or final; any other lattice follows the measured patch
        fits = _fits(better, shape)
        if fits and lattice.rim_is_near(delta):
            margin *= 1.3
        elif fits and points == PATCH_POINTS:
            inner = _measure(lattice, shape, sides, delta / 2.0)
            limit = np.full(2, np.nan) if inner is None else 2.0 * inner.centre - better.centre
            return _Patch(better, limit, lattice.points, lattice.gap, lattice.is_cut(delta), count)
        elif fits:
            points = PATCH_POINTS
        shape = better
    nan = np.full((2, 2), np.nan)
    return _Patch(_PatchShape(float("nan"), nan[0], nan[0], nan), nan[0], *_no_map(), True, count)


def _fits(own: _PatchShape, shape: _PatchShape) -> bool:
    """Return True if the measured shape is about the shape for which the lattice was made, in units of the latter."""
    spread = (shape.axes / shape.halves).T @ own.axes * own.halves
    offset = (own.centre - shape.centre) @ shape.axes / shape.halves
    return bool(np.abs(spread @ spread.T - np.eye(2)).max() < 0.3 and np.abs(offset).max() < 0.2)


def _lattice(pinion: Field, gear: Field, centre: Array, stretch: Array, count: int) -> _Lattice:
    """Return gaps at count x count places over the rectangle centre +- columns of `stretch` (2, 2)."""
    steps = np.linspace(-1.0, 1.0, count)
    flat = centre + np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2) @ stretch.T
    pinion_hits, gear_hits = pinion.at(flat), gear.at(flat)
    mean = pinion_hits.normal + gear_hits.normal
    gap = (gear_hits.height - pinion_hits.height) * mean[:, 2] / np.sqrt(dot(mean, mean))
    return _Lattice(pinion_hits.point.reshape(count, count, 3), gap.reshape(count, count))


def _measure(lattice: _Lattice, shape: _PatchShape, sides: Array, delta: float) -> _PatchShape | None:
    """Return area, centre and axes of the patch on a lattice made for `shape`; None if no place is closer than delta.

    Linear interpolation makes the patch of a convex gap smaller by a relative error of h^2/8. The moments on the
    lattice and on every second point of it are therefore extrapolated.
    """
    steps = np.linspace(-1.0, 1.0, len(lattice.gap))
    places = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1)
    fine = _moments(places, lattice.gap - delta)
    coarse = _moments(places[::2, ::2], lattice.gap[::2, ::2] - delta)
    total = (4.0 * fine - coarse) / 3.0
    area = total[0, 0]
    if area <= 0.0 or coarse[0, 0] <= 0.0:
        return None
    centre = total[0, 1:] / area
    spread = total[1:, 1:] / area - np.outer(centre, centre)
    stretch = shape.axes * sides
    squares, axes = np.linalg.eigh(stretch @ spread @ stretch.T)
    if squares[0] <= 0.0:
        return None
    return _PatchShape(float(area * sides.prod()), shape.centre + stretch @ centre, 2.0 * np.sqrt(squares), axes)


def _moments(places: Array, value: Array) -> Array:
    """Return integrals (3, 3) of (1, x, y) (1, x, y)^T over {value < 0}.

    `places` is (M, N, 2), `value` (M, N), linear on the two triangles of every lattice cell. Triangles with a NaN
    corner are left out. Triangles with two corners inside are whole triangles minus the part at the corner outside.
    """
    quads = [np.s_[:-1, :-1], np.s_[1:, :-1], np.s_[1:, 1:], np.s_[:-1, 1:]]
    homogeneous = np.concatenate((np.ones((*value.shape, 1)), places), axis=-1)
    corners = np.concatenate(
        [np.stack([homogeneous[quads[k]].reshape(-1, 3) for k in t], axis=1) for t in ((0, 1, 2), (0, 2, 3))]
    )
    values = np.concatenate([np.stack([value[quads[k]].ravel() for k in t], axis=1) for t in ((0, 1, 2), (0, 2, 3))])
    used = np.isfinite(values).all(axis=1) & (values < 0.0).any(axis=1)
    corners, values = corners[used], values[used]

    # part of a triangle: the tip at the odd corner, cut at the zero of the linear interpolation
    inside = values < 0.0
    number = inside.sum(axis=1)
    odd = np.where(number == 1, inside.argmax(axis=1), inside.argmin(axis=1))
    order = (odd[:, None] + np.arange(3)) % 3
    mixed = number < 3
    triangles = np.take_along_axis(corners, order[..., None], axis=1)[mixed]
    ends = np.take_along_axis(values, order, axis=1)[mixed]
    share = ends[:, :1] / (ends[:, :1] - ends[:, 1:])
    cut = np.concatenate(
        (triangles[:, :1], triangles[:, :1] + share[..., None] * (triangles[:, 1:] - triangles[:, :1])), axis=1
    )
    pieces = np.concatenate((corners[number >= 2], cut))
    weight = np.concatenate((np.ones(int((number >= 2).sum())), np.where(number[mixed] == 1, 1.0, -1.0)))

    # exact integrals of products of linear functions over triangles
    area = weight * np.abs(np.linalg.det(pieces)) / 2.0
    total = pieces.sum(axis=1)
    squares = np.einsum("t,tki,tkj->ij", area, pieces, pieces)
    integrals: Array = (squares + np.einsum("t,ti,tj->ij", area, total, total)) / 12.0
    return integrals


def _tangent_frame(point: Array, normal: Array) -> Rigid:
    """Return tangent_to_base: z along the normal (3,), origin at the point (3,)."""
    x = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    x /= np.linalg.norm(x)
    return Rigid(np.stack((x, np.cross(normal, x), normal), axis=-1), point)


def _in_space(flat: Array) -> Array:
    """Return points (..., 3) of the tangent plane from coordinates (..., 2)."""
    return np.concatenate((flat, np.zeros((*flat.shape[:-1], 1))), axis=-1)
