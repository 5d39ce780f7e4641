"""Figures of finite-element models of gears in mesh: of the model, of its solution, and of several decks."""

from __future__ import annotations

from collections.abc import Mapping

from gearmesh.fe.gear_model import resolving
from gearmesh.fe.model import CyclicSymmetry
from gearmesh.figures import Figures, figure
from gearmesh.mesh.hexahedra.hexahedra import ENOUGH_LAYERS_SHARE
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.records import dataclass


@dataclass(frozen=True)
class HalfAxes(Figures):
    """Elements over half the contact ellipse of a member."""

    across: float = figure("elements over half the contact ellipse, across the tooth")
    along: float = figure("elements over half the contact ellipse, along the tooth")


@dataclass(frozen=True)
class Resolution(Figures):
    """Resolution of the contact pressure by a finite-element model; unknown in edge contact."""

    over: Mapping[str, HalfAxes] = figure(
        "elements over half the contact ellipse, by members", key="elements_over_half_axes"
    )
    inwards: Mapping[str, float] = figure(
        "layers of elements over the smaller semi-axis of the contact ellipse, into the tooth, by members",
        key="layers_over_smaller_half_axis",
    )
    sag: float | None = figure(
        "distance of the elements' edges along the contact ellipse from the flank, over the elastic approach",
        key="sag_over_approach",
    )

    def coarse(self, second_order: bool) -> str:
        """Reason why the elements are too coarse for the contact pressure.

        `second_order`: true for elements of second order.
        """
        if self.sag is None:
            return "the contact is at an edge"
        least = min(min(half_axes.across, half_axes.along) for half_axes in self.over.values())
        inwards, wanted = min(self.inwards.values()), resolving(second_order, 1.0)
        if least < ENOUGH_LAYERS_SHARE * wanted.over:
            return f"{least:.2g} elements over a semi-axis of the contact ellipse"
        if inwards < ENOUGH_LAYERS_SHARE * wanted.inwards:
            return f"{inwards:.2g} layers of elements over the smaller semi-axis of the contact ellipse, into the tooth"
        if self.sag > wanted.sag / ENOUGH_LAYERS_SHARE**2:
            return f"elements along the contact ellipse deviate from the flank by {self.sag:.2g} of the approach"
        return ""


@dataclass(frozen=True)
class MeshFigures(Figures):
    """The elements of a finite-element model."""

    elements: int = figure("elements", whole=True)
    element_order: int = figure("order of the elements: 1 or 2", whole=True)
    nodes: int = figure("nodes", whole=True)
    min_scaled_jacobian: float = figure(
        "least scaled Jacobian of the elements: at corners, of second order at all nodes and integration points"
    )
    volume: float = figure("volume of the elements", "mm3", "V")


@dataclass(frozen=True)
class ModeFigures(Figures):
    """A natural vibration of a finite-element model, as it is held."""

    mode: int = figure("number of the mode", whole=True)
    frequency: float = figure("natural frequency", "Hz", "f")


@dataclass(frozen=True)
class CyclicFigures(Figures):
    """The cyclic symmetry of a finite-element model of a sector."""

    sectors: int = figure("sectors of the model that make the whole gear", whole=True)
    node_pairs: int = figure("nodes on either cut face of the sector", whole=True)

    @staticmethod
    def of(symmetry: CyclicSymmetry, mesh: HexMesh) -> CyclicFigures:
        """Return the figures of a model's symmetry and mesh."""
        return CyclicFigures(symmetry.sectors, len(mesh.node_sets[symmetry.first]))


@dataclass(frozen=True)
class UnloadedModelFigures(MeshFigures):
    """A finite-element model of a member without a mating gear."""

    seconds: float = figure("run time", "s", timing=True)


@dataclass(frozen=True)
class ModelFigures(MeshFigures):
    """A finite-element model of gears in mesh."""

    phi1: float = figure("rotation of the pinion", "deg", "phi_1")
    phi2: float = figure("rotation of the gear", "deg", "phi_2")
    torque: float = figure("torque on the pinion", "Nm", "T_1")
    friction: float = figure("coefficient of friction of the flanks", symbol="mu")
    normal_force: float = figure("normal force by Hertz contact", "N", "F_n")
    hertz_p0: float = figure("largest pressure of Hertz contact", "MPa", "p_0")
    hertz_a: float = figure("semi-major axis of the pressed ellipse by Hertz contact", "mm", "a")
    hertz_b: float = figure("semi-minor axis of the pressed ellipse by Hertz contact", "mm", "b")
    resolution: Resolution = figure("how well the contact pressure is resolved", parts=Resolution)
    elements_to_resolve: int | None = figure(
        "elements of the model that resolves the contact pressure, where that has too many by default", whole=True
    )
    preload: float = figure("rotation of the pinion until the facets of the flanks touch", "arcsec")
    facets_gap: float = figure("gap of the facets of both flanks where these touch", "um")
    seconds: float = figure("run time", "s", timing=True)

    @property
    def coarse(self) -> str:
        """Reason why the model does not resolve the contact pressure; empty if it does."""
        return self.resolution.coarse(self.element_order == 2)


@dataclass(frozen=True)
class DeckFigures(Figures):
    """One of several decks."""

    deck: str = figure("name of the file")
    asked_phi1: float = figure("requested rotation of the pinion", "deg", "phi_1")
    pressure_resolved: bool = figure("whether the model resolves the contact pressure")
    model: ModelFigures = figure("the model")


@dataclass(frozen=True)
class SolvedToothPair(Figures):
    """The contact of one tooth pair as finite elements find it."""

    force: float = figure("normal force", "N", "F_n")
    peak_pressure: float = figure("largest contact pressure", "MPa", "p_max")
    area: float = figure("area in contact", "mm2", "A")


@dataclass(frozen=True)
class SolvedContact(Figures):
    """Contact of gears as finite elements find it."""

    max_pressure: float = figure("largest contact pressure", "MPa", "p_max")
    pressure_resolved: bool = figure("whether the model resolves the contact pressure where it is largest")
    max_pressure_point: list[float] = figure("place of the largest contact pressure, fixed frame", "mm", vector=True)
    pressure_centre: list[float] = figure("centre of the contact pressure, fixed frame", "mm", vector=True)
    contact_area: float = figure("area in contact of all tooth pairs", "mm2", "A")
    torque: float = figure("torque on the pinion", "Nm", "T_1")
    rotation: float = figure("rotation of the pinion by the deflection of the teeth and the bodies", "arcsec")
    tooth_pairs: list[SolvedToothPair] = figure("contact of each tooth pair", shown=False)


@dataclass(frozen=True)
class SolvedFillets(Figures):
    """Stresses in the fillets of a member as finite elements find them."""

    max_tension: float = figure("largest tensile stress in the fillets", "MPa", "sigma_F")
    tension_point: list[float] = figure("place of the largest tensile stress, fixed frame", "mm", vector=True)
    max_compression: float = figure("largest compressive stress in the fillets", "MPa")
    compression_point: list[float] = figure("place of the largest compressive stress, fixed frame", "mm", vector=True)


@dataclass(frozen=True)
class SolutionFigures(Figures):
    """Results of CalculiX for a finite-element model."""

    contact: SolvedContact | None = figure(
        "contact of the gears, none of one member", parts=SolvedContact, optional=True
    )
    fillets: Mapping[str, SolvedFillets] = figure("stresses in the fillets, by members")
    iterations: int = figure("iterations of the solver", whole=True)
    seconds: float = figure("run time of the solver", "s", key="solver_seconds", timing=True)
