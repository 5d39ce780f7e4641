"""A gear pair: two members with their teeth, where they stand, and how their source names what is computed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from gearmesh.kernel.algebra import Array
from gearmesh.teeth.assembly import Assembly
from gearmesh.teeth.tooth import Tooth

#: Surface parameters (p, v) (...,) of a flank -> values named and counted as in the source (angles in degrees)
SourceParameters = Callable[[Array, Array], dict[str, Array]]


@dataclass(frozen=True)
class Keyway:
    """Slot in the bore, mm: width, and depth beyond the bore's radius."""

    width: float
    depth: float


@dataclass(frozen=True)
class Hub:
    """Cylinder on the heel face, mm."""

    diameter: float
    length: float


@dataclass(frozen=True)
class Member:
    """One gear of a pair: its tooth in its own frame (axis z, tooth centred on x), and its body's features."""

    name: str
    tooth: Tooth
    source_parameters: SourceParameters
    keyway: Keyway | None = None
    hub: Hub | None = None


@dataclass(frozen=True)
class GearPair:
    """What every further step starts from.

    `flanks` names the touching side of (pinion, gear); `drive` is +1 where contact pushes the gear towards larger
    phi2, -1 towards smaller; `delta` (mm) is the marking-compound thickness; `generation` gives, for pinion surface
    parameters, the generation angle (rad) where the source counts phi1 by it, None where phi1 is the rotation.
    """

    kind: str
    pinion: Member
    gear: Member
    assembly: Assembly
    flanks: tuple[str, str]
    drive: int
    delta: float
    generation: Callable[[Array, Array], Array] | None = None
    warnings: tuple[str, ...] = field(default=())

    @property
    def members(self) -> dict[str, Member]:
        return {"pinion": self.pinion, "gear": self.gear}
