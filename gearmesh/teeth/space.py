"""The space between two teeth: the volume that a broach, an electrode or a form tool fills.

Its chain of links starts from the tooth after it. The tip surface, from this tooth's right tip back to the left tip of
the tooth before, takes the place of the land. The links of the left side belong to the tooth before, one pitch back. So
the chain is closed:

                 tip surface, back
           .----------------------------.
    left   |                            |  right
    flank  |                            |  flank
            `-- fillet    root  fillet -'

Sections, grids and meshes are made as for a tooth. Normals point out of the teeth, into the space. The normal of the
tip surface points away from both.
"""

from __future__ import annotations

from dataclasses import fields

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Sections, TurnedLink
from gearmesh.teeth.tooth import Tooth


@dataclass(frozen=True)
class Space(Tooth):
    """The space before a tooth, beside its right flank."""

    @staticmethod
    def before(tooth: Tooth) -> Space:
        """Return the space between a tooth and an equal tooth before it."""
        return Space(**{field.name: getattr(tooth, field.name) for field in fields(Tooth)})

    def _top(self) -> TurnedLink:
        """Return the tip surface, from the right tip back to the left tip of the tooth before."""
        pitch = self.pitch_angle

        def across(sections: Sections) -> tuple[Array, Array]:
            return sections.right.tip_angle, sections.left.tip_angle - pitch

        return TurnedLink(Region.TIP_SURFACE, self.blank.tip.surface, self.blank.axial, across)

    def volume(self, order: int = 24) -> float:
        """Return the volume (mm^3) of the space, by Gauss quadrature of exact section areas."""
        return abs(self._swept(order))
