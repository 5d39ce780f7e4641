"""Index deviations of a gear's teeth as angles about its axis, positive if a flank is ahead of its theoretical
place; and distances by which whole teeth are farther from the axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side


@dataclass(frozen=True)
class IndexAngles:
    """Angles, rad, about the member's z axis by which flanks are ahead of their theoretical places, by the number of
    the tooth.

    - `right`, `left`: angles (N,) of each side, empty if the side has no deviations.
    - `outwards`: distances (N,), mm, by which teeth are farther from the axis, as pins that are set into a ring; empty if
      none are.
    """

    right: tuple[float, ...] = ()
    left: tuple[float, ...] = ()
    outwards: tuple[float, ...] = ()

    @staticmethod
    def of_sides(angles: Mapping[Side, Array]) -> IndexAngles:
        """Return index deviations from the angles of each side.

        `angles`: by how much flanks are ahead of their places, rad, one a tooth.
        """
        return IndexAngles(
            **{str(side): tuple(np.asarray(values, dtype=float).tolist()) for side, values in angles.items()}
        )

    @staticmethod
    def turned(angle: float, teeth: int) -> IndexAngles:
        """Return index deviations of teeth that are all turned by an angle, rad; none for 0."""
        return IndexAngles(*((angle,) * teeth,) * 2) if angle else NO_INDEX_ANGLES

    def beside(self, other: IndexAngles, teeth: int) -> IndexAngles:
        """Return these deviations and, in addition, those of another cause."""
        angles = {side: self.of(side, teeth) + other.of(side, teeth) for side in Side}
        return replace(IndexAngles.of_sides(angles), outwards=self.outwards or other.outwards)

    @property
    def uneven(self) -> bool:
        """True if the deviations of a side differ from tooth to tooth, or teeth are farther from the axis."""
        return any(np.ptp(values) > 0.0 for values in (self.right, self.left) if values) or any(self.outwards)

    @property
    def off_place(self) -> bool:
        """True if any tooth is off its theoretical place, also if all are turned alike."""
        return any(any(values) for values in (self.right, self.left, self.outwards))

    @property
    def even(self) -> IndexAngles:
        """The same deviations without their differences: every flank of a side has their mean."""
        return IndexAngles(*((sum(side) / len(side),) * len(side) if side else () for side in (self.right, self.left)))

    def check(self, name: str, teeth: int) -> None:
        """Refuse a number of deviations that is not the number of teeth.

        `name`: the member's, which the refusal names. Raises DesignError for another number of deviations.
        """
        for values in (self.right, self.left, self.outwards):
            if values and len(values) != teeth:
                raise DesignError(
                    f"{name} pitch deviations", len(values), must_be=f"{teeth}, one a tooth", topic="pitch deviations"
                )

    def from_tooth(self, first: int) -> IndexAngles:
        """Return the index deviations with the teeth counted from another tooth, `first`."""
        return IndexAngles(*(values[first:] + values[:first] for values in (self.right, self.left, self.outwards)))

    def of(self, side: Side, teeth: int) -> Array:
        """Return the index deviations of the flanks of one side.

        `teeth`: number of teeth N. Result: angles, rad; 0 without deviations.
        """
        values = self.right if side is Side.RIGHT else self.left
        return np.array(values) if values else np.zeros(teeth)

    def farther_out(self, teeth: int) -> Array:
        """Return the distances (N,), mm, by which the teeth, N of them, are farther from the axis."""
        return np.array(self.outwards) if self.outwards else np.zeros(teeth)


#: index angles of teeth at their theoretical places
NO_INDEX_ANGLES = IndexAngles()
