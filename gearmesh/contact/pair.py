"""The two flanks of a gear pair as the contact solver wants them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.meshing import Bound, Flank
from gearmesh.kernel.algebra import Array

#: edges of a flank, in the order in which the solver counts those of the pinion and then those of the gear
EDGES = ("tip", "toe", "heel")
MEMBERS = ("pinion", "gear")


@dataclass(frozen=True)
class Pair:
    """What the solver needs to know of a gear pair: two mounted flanks, N1/N2, the side of first touch and delta (mm).

    `fillets`: those of the same sides, for tips that reach them, mounted as the flanks are; `pitch`: the pinion's, rad, where it is
    known.
    """

    pinion: Flank
    gear: Flank
    ratio: float
    drive: int
    delta: float
    fillets: tuple[Flank, Flank] | None = None
    pitch: float = np.nan

    @cached_property
    def parts(self) -> tuple[Pair, ...]:
        """The pair of flanks alone, and each flank with the fillet of its mate."""
        if self.fillets is None:
            return (self,)
        first, second = (
            fillet if fillet.mount is flank.mount else replace(fillet, mount=flank.mount)
            for fillet, flank in zip(self.fillets, self.flanks, strict=True)
        )
        alone = replace(self, fillets=None)
        return alone, replace(alone, pinion=first), replace(alone, gear=second)

    @property
    def flanks(self) -> tuple[Flank, Flank]:
        return self.pinion, self.gear

    @cached_property
    def length(self) -> float:
        """Typical flank dimension (mm), which turns conditions on normals into lengths."""
        r = self.pinion.surface.jet(self.pinion.grid[..., 0], self.pinion.grid[..., 1]).r
        return float(0.25 * np.linalg.norm(np.ptp(r.reshape(-1, 3), axis=0)))

    @cached_property
    def max_step(self) -> Array:
        """Largest Newton step (5,): half the range of each flank's parameters, and 0.2 rad."""
        spans = [0.5 * np.ptp(f.grid.reshape(-1, 2), axis=0) for f in self.flanks]
        return np.array([*spans[0], *spans[1], 0.2])

    @cached_property
    def bounds(self) -> tuple[Bound | None, ...]:
        """The edges of both flanks, the pinion's first, in the order of EDGES; None for those that a flank has not."""
        return tuple(
            Bound(member, flank.edges[name]) if name in flank.edges else None
            for member, flank in enumerate(self.flanks)
            for name in EDGES
        )

    @cached_property
    def all_bounds(self) -> tuple[Bound, ...]:
        """Those edges that there are."""
        return tuple(bound for bound in self.bounds if bound is not None)

    @cached_property
    def numbers(self) -> NDArray[np.intp]:
        """Numbers in `all_bounds` of the edges of `bounds`, and -1 for edge -1."""
        there = np.array([bound is not None for bound in self.bounds])
        return np.append(np.where(there, np.cumsum(there) - 1, -1), -1)


def edge_name(number: int) -> str:
    """Name of an edge by its number in `Pair.bounds`; after them come the joints with the fillets."""
    if number >= len(MEMBERS) * len(EDGES):
        return f"{MEMBERS[number - len(MEMBERS) * len(EDGES)]}_joint"
    return f"{MEMBERS[number // len(EDGES)]}_{EDGES[number % len(EDGES)]}"
