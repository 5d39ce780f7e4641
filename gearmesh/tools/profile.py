"""The profile of a tool: the interface of every plane curve that generates or grinds a flank."""

from __future__ import annotations

from typing import Protocol

from gearmesh.kernel.numeric.algebra import Array


class Profile(Protocol):
    """Plane curve p -> (x, y) with the blank's outward normal."""

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        """Return points, tangents dr/dp, normals and dn/dp, each (..., 2), at p (...,)."""
