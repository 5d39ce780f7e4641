"""The space between two teeth: what a broach, an electrode or a form tool fills.

Its chain is that of the tooth after it, with the tip surface from its right tip back to the left tip of the tooth before in the
place of the land; the links of the left side then belong to that tooth before, one pitch back, and the chain is closed:

                 tip surface, back
           .----------------------------.
    left   |                            |  right
    flank  |                            |  flank
            `-- fillet    root  fillet -'

All else is as of a tooth: sections, grids, meshes. Normals point out of the teeth, so into the space, but that of the tip surface,
which points away from both.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Sections, TurnedLink
from gearmesh.teeth.tooth import Tooth


@dataclass(frozen=True)
class Space(Tooth):
    """The space before a tooth, on the side of its right flank."""

    @staticmethod
    def before(tooth: Tooth) -> Space:
        """The one between a tooth and another that is like it."""
        return Space(**{field.name: getattr(tooth, field.name) for field in fields(Tooth)})

    def _top(self) -> TurnedLink:
        """The tip surface, from the tip of the right side back to that of the left one of the tooth before."""
        pitch = self.pitch_angle

        def across(sections: Sections) -> tuple[Array, Array]:
            return sections.right.tip_angle, sections.left.tip_angle - pitch

        return TurnedLink(Region.TIP_SURFACE, self.blank.tip.surface, self.blank.axial, across)

    def volume(self, order: int = 24) -> float:
        """Volume (mm^3) of the space, by Gauss quadrature of exact section areas."""
        return abs(self._swept(order))
