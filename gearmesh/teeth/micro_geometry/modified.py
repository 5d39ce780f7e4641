"""Sides of teeth with micro-geometry, whatever tool generated them, as long as their flanks are screw involutes.

The flank becomes the involute in closed form less the amounts (see `ScrewInvolute`). What the tool generates beside it, fillet
and rounding of the tip, turns about the axis with its end of the flank, section by section: so does the tool that moves along the
face as the modification wants it, and no step is left where they meet.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.kernel.surface.twisted import Twisted
from gearmesh.teeth.micro_geometry.modification import Extent, Kinks, Modification, Topography
from gearmesh.teeth.micro_geometry.screw_involute import ScrewInvolute
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide

#: points at which a flank is compared with its involute, and the largest distance (mm), relative to the base radius, from it
POINTS, INVOLUTE = 5, 1e-11


@dataclass(frozen=True)
class TrueFlank:
    """The involute that a flank is, and where it is evaluated: from where it begins to where the tip, or what breaks it, does."""

    involute: ScrewInvolute
    extent: Extent

    @staticmethod
    def of(tooth: Tooth, which: Side, *, internal: bool = False) -> TrueFlank:
        """Raises DesignError where the flank is no screw involute, TrimError where the tooth cannot be trimmed."""
        grid = tooth.flank_grid(which, np.linspace(0.0, 1.0, POINTS), [0.0, 0.5, 1.0])
        assert grid.jet is not None
        tip = Jet(*(getattr(grid.jet, field.name)[-1, 1:2] for field in fields(Jet)))
        involute = ScrewInvolute.through(tip, which.sign, internal)
        length, z = ScrewInvolute.roll_length(grid.jet, internal), grid.points[..., 2]
        if np.abs(involute.jet(length, z).r - grid.points).max() > INVOLUTE * involute.base_radius:
            raise DesignError("modifications", reason="only involute flanks of cylindrical gears may have them")
        return TrueFlank(involute, Extent(float(length[0, 1]), float(length[-1, 1]), *tooth.blank.extent))

    @property
    def lean(self) -> float:
        """Contact lines are L + lean z = const."""
        return self.involute.hand * self.involute.rate * self.involute.base_radius

    def roll_length(self, diameter: float) -> float:
        """Roll length (mm) at a diameter (mm), NaN below the base circle."""
        square = (0.5 * diameter) ** 2 - self.involute.base_radius**2
        return float(np.sqrt(square)) if square >= 0.0 else float("nan")


@dataclass(frozen=True)
class _Turn:
    """The angle by which sections turn with the flank's point of a roll length."""

    involute: ScrewInvolute
    modification: Modification
    length: float

    def __call__(self, z: Array) -> tuple[Array, Array, Array]:
        jet = self.modification.jet(np.full_like(z, self.length), z)
        per_mm = self.involute.side / self.involute.base_radius
        return per_mm * jet.a, per_mm * jet.a_z, per_mm * jet.a_zz


@dataclass(frozen=True)
class _Smooth:
    """A modified flank about a place (roll length and z, mm), as if it had no corners."""

    involute: ScrewInvolute
    modification: Modification

    def __call__(self, length: float, z: float) -> Surface:
        return replace(self.involute, amount=self.modification.smooth(length, z))


def modified_side(tooth: Tooth, which: Side, true: TrueFlank, modification: Modification | None) -> ToothSide:
    """The side of a tooth less the amounts of a modification; with None its true involute."""
    side, involute = tooth.side(which), true.involute
    kinks = Kinks() if modification is None else modification.kinks

    def twist(surface: Surface, length: float) -> Surface:
        return surface if modification is None else Twisted(surface, 0.0, _Turn(involute, modification, length))

    def length_at(p: float) -> float:
        middle = tooth.stations([0.5])
        jet = along(side.flank, np.full_like(middle, p), middle, tooth.blank.axial)[1]
        return float(ScrewInvolute.roll_length(jet, involute.internal)[0])

    begins = true.extent.root
    tip_corner = side.tip_corner
    if tip_corner is not None:
        ends = length_at(tip_corner.form_point[0])
        tip_corner = replace(
            tip_corner, surface=twist(tip_corner.surface, ends), form_point=(ends, tip_corner.form_point[1])
        )
    return ToothSide(
        flank=replace(involute, amount=modification),
        fillet=twist(side.fillet, begins),
        form_point=(length_at(side.form_point[0]), side.form_point[1]),
        root=side.root,
        tip=true.extent.tip,
        tip_corner=tip_corner,
        flank_breaks=kinks.lengths,
        fillet_breaks=side.fillet_breaks,
        face_breaks=tuple(sorted({*side.face_breaks, *kinks.positions})),
        creases=kinks.creases,
        ridges=kinks.ridges,
        tabulated=modification is not None and any(isinstance(field, Topography) for field in modification.fields),
        smooth_flank=None if modification is None else _Smooth(involute, modification),
        generated=side,
        sharp=side.sharp,
        tool=side.tool,
    )
