"""Pairs whose coast flanks are the image of the driving flanks: the coast side needs no second solution.

Two motions map a pair onto itself with its flanks exchanged:

- a half turn about the line through the middles of a tooth and of the mating space: cylindrical gears, also helical
- a mirror through both axes: spur gears, face gears

In the members' frames, the image of a pinion tooth turned by a is a tooth turned by -a. The image of a gear tooth turned by b is a
tooth turned by c - b, where c depends on the position of the gear. The coast flanks therefore have the contact of the driving
flanks at the opposite rotation. The surfaces decide whether a pair has this symmetry; most assembly errors break it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.engagement.curve import MeshArc, MeshCurve
from gearmesh.contact.pair import Pair
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: diagonals of the maps that exchange the flanks of a tooth centred on +x: half turn about x, mirror y = 0
FLANK_EXCHANGES = (np.array([1.0, -1.0, -1.0]), np.array([1.0, -1.0, 1.0]))
#: distance of a point from its image, by the largest coordinate, that is rounding; same for axes
POSITION_ROUNDING = 1e-12
#: difference of normals that is rounding; tabulated tip roundings differentiate their tables
NORMAL_ROUNDING = 1e-11


@dataclass(frozen=True)
class ImageCurve:
    """Transmission advance of the gears on their coast flanks, as the image of the `curve` of the driving flanks.

    The advance at phi1 is the advance of the curve at `sum` - phi1, plus `more`.
    """

    #: transmission advance on the driving flanks
    curve: MeshCurve
    #: sum of a rotation of the pinion and the rotation of its image, rad
    sum: float
    #: advance of the image beyond the advance of the curve, rad
    more: float
    #: diagonal (3,) of the map of the members' own frames
    exchange: Array

    @property
    def pitch(self) -> float:
        """Pitch of the pinion, rad."""
        return self.curve.pitch

    @property
    def whole(self) -> bool:
        """True if a tooth pair touches at every node of a pitch."""
        return self.curve.whole

    @property
    def arcs(self) -> list[MeshArc]:
        """Arcs of the driving curve over one pitch; none if contact breaks off in it."""
        return self.curve.arcs

    @property
    def marks(self) -> tuple[Array, Array]:
        """Marks of `MeshCurve.marks`: phases (M,), rad, of any pitch, and advances (M,), rad."""
        phase, advance = self.curve.marks
        return self.sum - phase, advance + self.more

    def advance(self, phase: Array) -> Array:
        """Return advances (N,), rad, of the gears at phases (N,); NaN where nothing touches."""
        return self.curve.advance(np.mod(self.sum - phase, self.curve.pitch)) + self.more

    def advance_as_known(self, phase: Array) -> Array:
        """Return advances (N,), rad, as `MeshCurve.advance_as_known` does."""
        return self.curve.advance_as_known(np.mod(self.sum - phase, self.curve.pitch)) + self.more

    def carrier(self, phase: Array) -> NDArray[np.intp]:
        """Return numbers (N,) of the tooth pairs in contact at phases (N,)."""
        whole = np.floor((self.sum - phase) / self.curve.pitch).astype(np.intp)
        return self.curve.carrier(self.sum - phase - whole * self.curve.pitch) - whole

    def slope(self, phase: Array, number: NDArray[np.intp]) -> Array:
        """Return slopes (N,) by phi1 of the advance of tooth pairs with numbers (N,) at phases (N,)."""
        return -self.curve.slope(self.sum - phase, number)


def image(curve: MeshCurve, other: Pair) -> ImageCurve | None:
    """Return the curve of the `other` flanks of a curve's pair; None where they are not the image of its flanks."""
    pair = curve.pair
    for exchange in FLANK_EXCHANGES:
        angle = _gear_angle(pair, exchange)
        if angle is not None and _are_images(pair, other, exchange):
            first, second = pair.pinion.mount, pair.gear.mount
            more = 2.0 * (second.zero - pair.ratio * first.zero) + second.sign * angle
            return ImageCurve(curve, 2.0 * first.zero, -pair.drive * more, exchange)
    return None


def _gear_angle(pair: Pair, exchange: Array) -> float | None:
    """Return the angle c (rad) by which the image turns the gear when the image of the pinion at rest is the pinion at rest.

    None where the image of the gear's axis is not the gear's axis.
    """
    mounts = pair.pinion.mount, pair.gear.mount
    if any(m.eccentricity != (0.0, 0.0) or m.base.rotation.ndim != 2 for m in mounts):
        return None
    # the image of the gear's frame, seen from the gear: it must be a rotation about the gear's axis
    first, second = (mount.base for mount in mounts)
    motion = Rigid(np.diag(exchange), np.zeros(3))
    back = second.inverse @ (first @ motion @ first.inverse) @ second @ motion
    reach = 1.0 + float(np.abs(second.translation - first.translation).max())
    if abs(back.rotation[2, 2] - 1.0) > POSITION_ROUNDING or np.abs(back.translation).max() > POSITION_ROUNDING * reach:
        return None
    return pair.gear.mount.joint.rotation_angle(back.rotation, POSITION_ROUNDING)


def _are_images(pair: Pair, other: Pair, exchange: Array) -> bool:
    """Return True if flanks, fillets and tip edges are the images of their counterparts in another pair with the same mounts."""
    fillets = [() if one_pair.fillets is None else one_pair.fillets for one_pair in (pair, other)]
    both = zip((*pair.flanks, *fillets[0], *pair.tips), (*other.flanks, *fillets[1], *other.tips), strict=True)
    return all(
        first is second if first is None or second is None else _is_image(first, second, exchange)
        for first, second in both
    )


def _is_image(flank: Flank, other: Flank, exchange: Array) -> bool:
    """Return True if a flank's grid with its edges, creases and normals is the image of another flank's grid."""
    if flank.grid.shape != other.grid.shape or flank.edges.keys() | flank.creases != other.edges.keys() | other.creases:
        return False
    jet, other_jet = (
        own_flank.surface.jet(own_flank.grid[..., 0], own_flank.grid[..., 1]) for own_flank in (flank, other)
    )
    size = np.abs(jet.r).max()
    for own, image, rounding in (
        (jet.r / size, other_jet.r / size, POSITION_ROUNDING),
        (jet.n, other_jet.n, NORMAL_ROUNDING),
    ):
        # the half turn exchanges the ends of the face
        if not np.abs(own * exchange - (image if exchange[2] > 0.0 else image[:, ::-1])).max() <= rounding:
            return False
    return True
