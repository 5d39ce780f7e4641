"""Pairs whose coast flanks are the image of the driving ones: the contact of the coast side is known from that of the drive side.

A half turn about the line through the middle of a tooth and of the mating gear's (cylindrical gears, helical ones too), or a mirror
through both axes (spur gears, face gears), takes such a pair to itself with its flanks exchanged. In their own frames a tooth
turned by a goes to one turned by -a, the gear's turned by b to c - b, c by how the gear stands: what the other flanks do at a
rotation, the ones that drive do at the opposite one. Whether a pair is like that is seen from its surfaces; most assembly errors
end it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.engagement.curve import MeshArc, MeshCurve
from gearmesh.contact.pair import Pair
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array

#: what exchanges the flanks of a tooth centred on +x: the half turn about x, the mirror y = 0
IMAGES = (np.array([1.0, -1.0, -1.0]), np.array([1.0, -1.0, 1.0]))
#: part of the largest coordinate by which points of a flank may miss its image, and by which axes may
SAME = 1e-12
#: difference of normals that is rounding; those of tabulated tip roundings come from differences of their tables
SAME_NORMALS = 1e-11


@dataclass(frozen=True)
class ImageCurve:
    """The transmission advance of the gears on their other flanks, from the `curve` of those that drive: at phi1 that of the
    curve at
    `sum` - phi1 (rad) and `more` (rad)."""

    curve: MeshCurve
    sum: float
    more: float

    @property
    def pitch(self) -> float:
        """The pinion's, rad."""
        return self.curve.pitch

    @property
    def whole(self) -> bool:
        """As of a `MeshCurve`."""
        return self.curve.whole

    @property
    def arcs(self) -> list[MeshArc]:
        """The envelope of the curve itself, arc by arc; none where nothing touches somewhere in it."""
        return self.curve.arcs

    @property
    def marks(self) -> tuple[Array, Array]:
        """As of a `MeshCurve`: phases (M,), rad, of any pitch, and advances there (M,), rad."""
        phase, advance = self.curve.marks
        return self.sum - phase, advance + self.more

    def advance(self, phase: Array) -> Array:
        """Advance (N,), rad, of the gears at phases (N,); NaN where nothing touches."""
        return self.curve.advance(np.mod(self.sum - phase, self.curve.pitch)) + self.more

    def advance_as_known(self, phase: Array) -> Array:
        """As `MeshCurve.advance_as_known`."""
        return self.curve.advance_as_known(np.mod(self.sum - phase, self.curve.pitch)) + self.more

    def carrier(self, phase: Array) -> NDArray[np.intp]:
        """Numbers (N,) of the tooth pairs in contact at phases (N,)."""
        whole = np.floor((self.sum - phase) / self.curve.pitch).astype(np.intp)
        return self.curve.carrier(self.sum - phase - whole * self.curve.pitch) - whole

    def slope(self, phase: Array, number: NDArray[np.intp]) -> Array:
        """Slope (N,) by phi1 of the advance of the tooth pairs with given numbers (N,) at phases (N,)."""
        return -self.curve.slope(self.sum - phase, number)


def image(curve: MeshCurve, other: Pair) -> ImageCurve | None:
    """The curve of the `other` flanks of a curve's pair, None where they are not the image of its own."""
    pair = curve.pair
    for exchange in IMAGES:
        angle = _gear_angle(pair, exchange)
        if angle is not None and _are_images(pair, other, exchange):
            first, second = pair.pinion.mount, pair.gear.mount
            more = 2.0 * (second.zero - pair.ratio * first.zero) + second.sign * angle
            return ImageCurve(curve, 2.0 * first.zero, -pair.drive * more)
    return None


def _gear_angle(pair: Pair, exchange: Array) -> float | None:
    """The angle c (rad) that the gear is turned by where the image of the pinion at rest is the pinion at rest; None where the
    image of the gear is no gear there."""
    mounts = pair.pinion.mount, pair.gear.mount
    if any(m.eccentricity != (0.0, 0.0) or m.base.rotation.ndim != 2 for m in mounts):
        return None
    first, second = (mount.base for mount in mounts)
    own = Rigid(np.diag(exchange), np.zeros(3))
    back = second.inverse @ (first @ own @ first.inverse) @ second @ own
    reach = 1.0 + float(np.abs(second.translation - first.translation).max())
    if abs(back.rotation[2, 2] - 1.0) > SAME or np.abs(back.translation).max() > SAME * reach:
        return None
    return pair.gear.mount.joint.rotation_angle(back.rotation, SAME)


def _are_images(pair: Pair, other: Pair, exchange: Array) -> bool:
    """True where flanks, fillets and tip edges are the images of those of another pair, which is mounted as this one is."""
    fillets = [() if one_pair.fillets is None else one_pair.fillets for one_pair in (pair, other)]
    both = zip((*pair.flanks, *fillets[0], *pair.tips), (*other.flanks, *fillets[1], *other.tips), strict=True)
    return all(
        first is second if first is None or second is None else _is_image(first, second, exchange)
        for first, second in both
    )


def _is_image(flank: Flank, other: Flank, exchange: Array) -> bool:
    """Whether a flank's grid, with its ends and seams, and the normals on it are the image of another's."""
    if flank.grid.shape != other.grid.shape or flank.edges.keys() | flank.creases != other.edges.keys() | other.creases:
        return False
    here, there = (
        own_flank.surface.jet(own_flank.grid[..., 0], own_flank.grid[..., 1]) for own_flank in (flank, other)
    )
    size = np.abs(here.r).max()
    for own, image, rounding in ((here.r / size, there.r / size, SAME), (here.n, there.n, SAME_NORMALS)):
        # the half turn exchanges the ends of the face
        if not np.abs(own * exchange - (image if exchange[2] > 0.0 else image[:, ::-1])).max() <= rounding:
            return False
    return True
