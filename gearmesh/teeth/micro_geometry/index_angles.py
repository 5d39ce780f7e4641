"""Index deviations of a gear's teeth as angles about its axis: how far its flanks are ahead of their theoretical places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.region import Side


@dataclass(frozen=True)
class IndexAngles:
    """Angles, rad, about the member's z axis by which the `right` and `left` flanks of its teeth, by their numbers, are ahead of
    their places; of a side without deviations there are none."""

    right: tuple[float, ...] = ()
    left: tuple[float, ...] = ()

    @staticmethod
    def of_sides(angles: Mapping[Side, Array]) -> IndexAngles:
        """Index deviations from the angles of each side.

        Parameters
        ----------
        angles : mapping of Side to numpy.ndarray (N,)
            By how much flanks are ahead of their places, rad, one a tooth.

        Returns
        -------
        IndexAngles
            Of these sides.

        Examples
        --------
        >>> gm.IndexAngles.of_sides({gm.Side.RIGHT: np.array([0.0, 1e-4])}).uneven
        True
        """
        return IndexAngles(**{str(side): tuple(np.asarray(own, dtype=float).tolist()) for side, own in angles.items()})

    @property
    def uneven(self) -> bool:
        """Whether teeth differ by them."""
        return any(np.ptp(own) > 0.0 for own in (self.right, self.left) if own)

    def check(self, name: str, teeth: int) -> None:
        """See that there is one deviation a tooth.

        Parameters
        ----------
        name : str
            The member's, which the refusal names.
        teeth : int
            Its number of teeth.

        Raises
        ------
        DesignError
            For another number of deviations.

        Examples
        --------
        >>> gm.IndexAngles().check("pinion", 18)
        """
        for own in (self.right, self.left):
            if own and len(own) != teeth:
                raise DesignError(
                    f"{name} pitch deviations", len(own), must_be=f"{teeth}, one a tooth", topic="pitch deviations"
                )

    def of(self, side: Side, teeth: int) -> Array:
        """Index deviations of the flanks of a side.

        Parameters
        ----------
        side : Side
            The side.
        teeth : int
            Number of teeth N.

        Returns
        -------
        numpy.ndarray of float (N,)
            Angles, rad; 0 without deviations.

        Examples
        --------
        >>> gears.members["pinion"].index.of(gm.Side.LEFT, 3).tolist()
        [0.0, 0.0, 0.0]
        """
        own = self.right if side is Side.RIGHT else self.left
        return np.array(own) if own else np.zeros(teeth)


#: of teeth that are all at their places
EVEN = IndexAngles()
