"""Do two solids overlap? Both members' meshes where they stand, intersected by manifold3d, which knows nothing of gears.

Facets are off the exact surfaces by up to their tolerances, so that members that only touch overlap in slivers. A sliver is
nowhere thicker than both tolerances together: a piece whose *mean* thickness is more is an overlap of the exact solids.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh import GearPair
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import TriangleMesh


@dataclass(frozen=True)
class Piece:
    """A connected part of the overlap: volume (mm^3), mean thickness (mm), least and greatest coordinates (2, 3), fixed frame.

    The surface of a thin piece is that of both its faces, so that twice the volume over the surface is its thickness.
    """

    volume: float
    thickness: float
    box: Array


@dataclass(frozen=True)
class Overlap:
    """All pieces of an overlap, the thickest first."""

    pieces: tuple[Piece, ...]

    @property
    def volume(self) -> float:
        return sum(piece.volume for piece in self.pieces)

    @property
    def thickness(self) -> float:
        """Mean thickness (mm) of the thickest piece, 0 without any."""
        return self.pieces[0].thickness if self.pieces else 0.0

    def beyond(self, *tolerances: float) -> tuple[Piece, ...]:
        """Pieces that facets within these tolerances (mm) cannot be the cause of."""
        return tuple(piece for piece in self.pieces if piece.thickness > sum(tolerances))


def overlap(pair: GearPair, meshes: tuple[TriangleMesh, TriangleMesh], phi1: float, phi2: float) -> Overlap:
    """Overlap of the solids of pinion and gear (own frames) at rotations phi1, phi2 (rad)."""
    one, other = (
        _manifold(mesh.move(mount.at(phi))) for mesh, mount, phi in zip(meshes, pair.mounts, (phi1, phi2), strict=True)
    )
    pieces = []
    for part in (one ^ other).decompose():
        surface = part.surface_area()
        if surface > 0.0:
            box = np.array(part.bounding_box()).reshape(2, 3)
            pieces.append(Piece(part.volume(), 2.0 * part.volume() / surface, box))
    return Overlap(tuple(sorted(pieces, key=lambda piece: -piece.thickness)))


def _manifold(mesh: TriangleMesh) -> Any:
    import manifold3d

    vertices, triangles = np.array(mesh.vertices, order="C"), np.array(mesh.triangles, dtype=np.uint64, order="C")
    found = manifold3d.Manifold(manifold3d.Mesh64(vertices, triangles))
    assert found.status().name == "NoError", found.status().name
    return found
