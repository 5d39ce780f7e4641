"""Sides of teeth with micro-geometry, for any tool whose flanks are screw involutes or planes of racks.

The flank becomes the closed form of the involute, or of the plane, less the amounts (see `ScrewInvolute`,
`PlaneFlank`). The fillet and the rounding of the tip turn about the axis, or slide along the rack, with the end of the
flank at each section. A tool that follows the modification along the face moves in this way, and no step remains where
the surfaces meet.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import ClassVar, Protocol

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.sheared import Sheared
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.kernel.surface.twisted import Twisted
from gearmesh.records import dataclass
from gearmesh.teeth.micro_geometry.modification import Extent, Kinks, Modification, Topography
from gearmesh.teeth.micro_geometry.plane_flank import PlaneFlank
from gearmesh.teeth.micro_geometry.screw_involute import Amount, ScrewInvolute
from gearmesh.teeth.region import Side
from gearmesh.teeth.source_parameters import SourceParameter
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide

#: parameter along the face of flanks in closed form
FACE_PARAMETER = SourceParameter("z_mm", "mm", "distance along the axis, from mid face")
#: points across a flank at which it is compared with its closed form
COMPARED_POINTS = 5
#: largest distance from the closed form, over the base radius
MAX_FORM_ERROR = 1e-11


class TrueFlank(Protocol):
    """Closed form of an unmodified flank, with the range in which it is evaluated: from its beginning to the tip, or to
    its tip edge.

    A place on the profile is the roll length of an involute, or the height of a plane; mm.
    """

    @property
    def extent(self) -> Extent: ...

    @property
    def lean(self) -> float:
        """Slope of the contact lines, l + lean z = const, l the place on the profile."""

    @property
    def places(self) -> Mapping[str, Callable[[float], float]]:
        """Functions by the name of a length (mm); each returns the place on the profile, NaN if there is none."""

    @property
    def parameters(self) -> tuple[SourceParameter, ...]:
        """Parameters of the flank."""

    def length_of(self, name: str, place: float) -> float:
        """Return a place as the length with a name."""

    def place(self, jet: Jet) -> Array:
        """Return places (...,) of points from their jets."""

    def surface(self, amount: Amount | None) -> Surface:
        """Return the flank less an amount; without an amount, the flank itself."""

    def follow(self, surface: Surface, modification: Modification, place: float) -> Surface:
        """Return a surface beside the flank, moved section by section like the flank's point at a place."""


@dataclass(frozen=True)
class TrueInvolute:
    """A flank that is a screw involute."""

    #: parameters of screw involutes
    PARAMETERS: ClassVar = (
        SourceParameter("roll_length_mm", "mm", "length of the normal of the involute to the base circle"),
        FACE_PARAMETER,
    )

    involute: ScrewInvolute
    extent: Extent

    @staticmethod
    def of(tooth: Tooth, which: Side, *, internal: bool = False) -> TrueInvolute:
        """Return the involute of a flank.

        Raises DesignError if the flank is no screw involute, TrimError if the tooth cannot be trimmed.
        """
        jet, tip = _proof_jets(tooth, which)
        involute = ScrewInvolute.through(tip, which.sign, internal)
        length, z = ScrewInvolute.roll_length(jet, internal), jet.r[..., 2]
        if np.abs(involute.jet(length, z).r - jet.r).max() > MAX_FORM_ERROR * involute.base_radius:
            raise DesignError("modifications", reason="only involute flanks of cylindrical gears may have them")
        return TrueInvolute(involute, Extent(float(length[0, 1]), float(length[-1, 1]), *tooth.blank.extent))

    @property
    def lean(self) -> float:
        return self.involute.lean

    @property
    def places(self) -> Mapping[str, Callable[[float], float]]:
        return {"roll_length": lambda length: length, "diameter": self.roll_length}

    @property
    def parameters(self) -> tuple[SourceParameter, ...]:
        return self.PARAMETERS

    def length_of(self, name: str, place: float) -> float:
        return place if name == "roll_length" else 2.0 * float(np.hypot(self.involute.base_radius, place))

    def roll_length(self, diameter: float) -> float:
        """Roll length (mm) at a diameter (mm), NaN below the base circle."""
        return self.involute.length_at(0.5 * diameter)

    def place(self, jet: Jet) -> Array:
        return ScrewInvolute.roll_length(jet, self.involute.internal)

    def surface(self, amount: Amount | None) -> Surface:
        return replace(self.involute, amount=amount)

    def follow(self, surface: Surface, modification: Modification, place: float) -> Surface:
        per_mm = self.involute.side / self.involute.base_radius
        return Twisted(surface, 0.0, _Motion(modification, place, per_mm))


@dataclass(frozen=True)
class TruePlane:
    """A flank of a rack, a plane."""

    plane: PlaneFlank
    extent: Extent

    @staticmethod
    def of(tooth: Tooth, which: Side) -> TruePlane:
        """Return the plane of a flank.

        Raises DesignError if the flank is no plane, TrimError if the tooth cannot be trimmed.
        """
        jet, tip = _proof_jets(tooth, which)
        plane = PlaneFlank.through(tip, which.sign)
        x, z = jet.r[..., 0], jet.r[..., 2]
        if np.abs(plane.jet(x, z).r - jet.r).max() > MAX_FORM_ERROR * tooth.joint.arm(jet.r).max():
            raise DesignError("modifications", reason="only plane flanks of racks may have them")
        extent = Extent(float(x[0, 1]), float(x[-1, 1]), *tooth.blank.extent, levels=False)
        return TruePlane(plane, extent)

    @property
    def lean(self) -> float:
        # contact line: flank plane and plane of action, x (tan(alpha_t) + 1 / tan(alpha_t)) + s z tan(beta) = const
        return self.plane.side * self.plane.slope * float(np.sin(self.plane.alpha_t) * np.cos(self.plane.alpha_t))

    @property
    def places(self) -> Mapping[str, Callable[[float], float]]:
        return {"height": lambda height: height}

    @property
    def parameters(self) -> tuple[SourceParameter, ...]:
        return SourceParameter("height_mm", "mm", "height over the reference plane of the rack"), FACE_PARAMETER

    def length_of(self, name: str, place: float) -> float:
        return place

    def place(self, jet: Jet) -> Array:
        return jet.r[..., 0]

    def surface(self, amount: Amount | None) -> Surface:
        return replace(self.plane, amount=amount)

    def follow(self, surface: Surface, modification: Modification, place: float) -> Surface:
        per_mm = self.plane.side / float(np.cos(self.plane.alpha_t))
        return Sheared(surface, _Motion(modification, place, per_mm))


def modification_of(flank: Surface) -> Modification | None:
    """Return the modification of a screw involute; None without one, and for any other flank."""
    amount = flank.amount if isinstance(flank, ScrewInvolute) else None
    return amount if isinstance(amount, Modification) else None


def true_flank(tooth: Tooth, which: Side, *, internal: bool = False) -> TrueFlank:
    """Return the closed form of a flank: a plane of a sliding member, a screw involute of a turning one.

    Raises the errors of `TrueInvolute.of` and `TruePlane.of`.
    """
    return (
        TrueInvolute.of(tooth, which, internal=internal) if tooth.joint.travel is None else TruePlane.of(tooth, which)
    )


def _proof_jets(tooth: Tooth, which: Side) -> tuple[Jet, Jet]:
    """Return jets at which a flank is compared with its closed form, and the jet (1,) of its tip at mid face."""
    jet = tooth.flank_grid(which, np.linspace(0.0, 1.0, COMPARED_POINTS), [0.0, 0.5, 1.0]).jet
    assert jet is not None
    return jet, Jet(*(getattr(jet, field.name)[-1, 1:2] for field in fields(Jet)))


@dataclass(frozen=True)
class _Motion:
    """Motion of sections with the flank's point at a place on the profile: an angle, or a displacement; `per_mm`: per
    mm of amount.
    """

    modification: Modification
    place: float
    per_mm: float

    def __call__(self, z: Array) -> tuple[Array, Array, Array]:
        jet = self.modification.jet(np.full_like(z, self.place), z)
        return self.per_mm * jet.a, self.per_mm * jet.a_z, self.per_mm * jet.a_zz


@dataclass(frozen=True)
class _Smooth:
    """A modified flank near a place (place on the profile, and z, mm), continued as if it had no corners."""

    true: TrueFlank
    modification: Modification

    def __call__(self, place: float, z: float) -> Surface:
        return self.true.surface(self.modification.smooth(place, z))


def modified_side(tooth: Tooth, which: Side, true: TrueFlank, modification: Modification | None) -> ToothSide:
    """Return the side of a tooth less the amounts of a modification; without a modification, its true flank."""
    side = tooth.side(which)
    kinks = Kinks() if modification is None else modification.kinks

    def twist(surface: Surface, length: float) -> Surface:
        """Return a surface that moves with the flank's point at a place on the profile."""
        return surface if modification is None else true.follow(surface, modification, length)

    def length_at(p: float) -> float:
        """Return the place on the profile of a flank parameter p, at mid face."""
        middle = tooth.stations([0.5])
        jet = along(side.flank, np.full_like(middle, p), middle, tooth.blank.axial)[1]
        return float(true.place(jet)[0])

    # station coordinates of an internal gear's teeth run against z
    stations = np.asarray(tooth.blank.axial.value(np.array([(0.0, 0.0, z) for z in kinks.positions]).reshape(-1, 3)))
    begins = true.extent.root
    tip_corner = side.tip_corner
    if tip_corner is not None:
        ends = length_at(tip_corner.form_point[0])
        tip_corner = replace(
            tip_corner, surface=twist(tip_corner.surface, ends), form_point=(ends, tip_corner.form_point[1])
        )
    return ToothSide(
        flank=true.surface(modification),
        fillet=twist(side.fillet, begins),
        form_point=(length_at(side.form_point[0]), side.form_point[1]),
        root=side.root,
        tip=true.extent.tip,
        tip_corner=tip_corner,
        flank_breaks=kinks.lengths,
        fillet_breaks=side.fillet_breaks,
        face_breaks=tuple(sorted({*side.face_breaks, *stations.tolist()})),
        creases=kinks.creases,
        ridges=kinks.ridges,
        tabulated=modification is not None and any(isinstance(field, Topography) for field in modification.fields),
        smooth_flank=None if modification is None else _Smooth(true, modification),
        generated=side,
        sharp=side.sharp,
        tool=side.tool,
    )
