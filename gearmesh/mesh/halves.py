"""Both halves of a double helical member as one: each tooth with its mirror image, and the gap between them closed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.surface.levels import Level
from gearmesh.mesh.body import BodyMesh, gear_body
from gearmesh.mesh.tessellate import Welded
from gearmesh.teeth.blank.mirrored import Mirrored


def both_halves(one: Welded, mirrored: Mirrored) -> Welded:
    """A tooth and its mirror image, whose toe and heel are the outer ends of both.

    The triangles of the image follow those of the tooth, in the same order. Without a gap both have the vertices in the plane.
    """
    image, count = _image(one, mirrored)
    size = len(one.vertices)
    own = np.ones(size, dtype=bool)
    own[_near(one, mirrored) if mirrored.groove is None else []] = False
    vertices = np.concatenate((one.vertices, mirrored.points(one.vertices[own])))
    first, second = (
        number[one.triangles % size] + count * (one.triangles // size) for number in (np.arange(size), image)
    )
    toe, heel = (one.toe, image[one.toe]) if mirrored.beyond_heel else (image[one.heel], one.heel)
    return Welded(vertices, np.concatenate((first, second[:, ::-1])), toe, heel)


def closed_gap(
    one: Welded, both: Welded, mirrored: Mirrored, teeth: int, level: Level, tolerance: float
) -> BodyMesh | None:
    """The end faces on either side of the gap and the cylinder between them, as `gear_body`; None without a gap."""
    if mirrored.gap is None:
        return None
    image, _ = _image(one, mirrored)
    toe, heel = (image[one.heel], one.heel) if mirrored.beyond_heel else (one.toe, image[one.toe])
    return gear_body(Welded(both.vertices, both.triangles, toe, heel), teeth, level, mirrored.gap, tolerance)


def _near(one: Welded, mirrored: Mirrored) -> NDArray[np.int64]:
    return one.heel if mirrored.beyond_heel else one.toe


def _image(one: Welded, mirrored: Mirrored) -> tuple[NDArray[np.int64], int]:
    """The number of the image of every vertex (V,) of a tooth, and how many vertices both have.

    Without a gap vertices in the plane are their own images; some of these may be the next tooth's.
    """
    size = len(one.vertices)
    if mirrored.groove is not None:
        return size + np.arange(size), 2 * size
    own = np.ones(size, dtype=bool)
    own[_near(one, mirrored)] = False
    image = np.where(own, size + np.cumsum(own) - 1, np.arange(size))
    return image, size + int(own.sum())
