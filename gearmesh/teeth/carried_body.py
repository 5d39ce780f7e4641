"""Bodies without teeth that turn with a member of a gear set, as the output pins of a cycloidal drive."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array


@dataclass(frozen=True)
class CarriedBody:
    """A cylinder that turns as a member does, about an axis parallel to that of the member."""

    #: name in the gear set, as "output_pin_1"
    name: str
    #: name of the member
    member: str
    #: radius, mm
    radius: float
    #: z of both ends, mm, in its own frame
    ends: tuple[float, float]
    #: transform from the body's own frame to that of the member, but for the `shift`
    own: Rigid
    #: displacement (3,), mm, fixed frame, of the axis of rotation from the axis of the member
    shift: Array = field(default_factory=lambda: np.zeros(3), hash=False, compare=False)

    def place(self, member_place: Rigid) -> Rigid:
        """Return the transform of the body to the fixed frame where its member is at `member_place`."""
        return Rigid(np.eye(3), self.shift) @ member_place @ self.own
