"""Figures of loaded contact: under a torque, at one position, and of one tooth pair."""

from __future__ import annotations

from collections.abc import Mapping

from gearmesh.figures import Figures, figure
from gearmesh.records import dataclass


@dataclass(frozen=True)
class FilletFigures(Figures):
    """Stresses in the fillets of a member."""

    bending_stress: float = figure(
        "bending stress: largest tensile stress in the fillet without the contact's own field",
        "MPa",
        "sigma_F",
        key="{member}_bending_stress_mpa",
    )
    error: float = figure(
        "estimate of the error of the bending stress", "%", key="{member}_bending_stress_error_percent"
    )
    root_stress: float = figure(
        "largest tensile stress in the fillet below its border with the flank; beside the contact the smaller of the stresses with "
        "and without the contact's own field",
        "MPa",
        key="{member}_root_stress_mpa",
    )
    root_stress_30: float = figure(
        "tensile stress at the tangent of 30 deg to the fillet", "MPa", "sigma_F", key="{member}_root_stress_30_mpa"
    )
    contact_stress: float = figure(
        "largest tensile stress in the fillet by the contact's own field",
        "MPa",
        key="{member}_fillet_contact_stress_mpa",
    )


@dataclass(frozen=True)
class MemberDisplacement(Figures):
    """Movement of a member on elastic mounts."""

    displacement: list[float] = figure(
        "displacement of the member, fixed frame", "um", key="{member}_displacement_um", vector=True
    )
    tilt: list[float] = figure(
        "rotation of the member by the deflection of its mounts, fixed frame",
        "arcsec",
        key="{member}_tilt_arcsec",
        vector=True,
    )


@dataclass(frozen=True)
class MeshShareFigures(Figures):
    """Load on one of several meshes that share a torque, at one position."""

    share: float = figure("share of the torque on the mesh", key="{member}_share")
    peak_pressure: float = figure(
        "largest contact pressure of the mesh away from singular edges", "MPa", key="{member}_peak_pressure_mpa"
    )


@dataclass(frozen=True)
class MeshShareTotals(Figures):
    """Load on one of several meshes that share a torque, over all positions."""

    least_share: float = figure("least share of the torque on the mesh", key="{member}_least_share")
    largest_share: float = figure("largest share of the torque on the mesh", key="{member}_largest_share")
    max_pressure: float = figure(
        "largest contact pressure of the mesh away from singular edges", "MPa", key="{member}_max_pressure_mpa"
    )
    max_pair_force: float = figure(
        "largest normal force on a tooth pair of the mesh", "N", key="{member}_max_pair_force_n"
    )


@dataclass(frozen=True)
class ToothPairFigures(Figures):
    """The load on one tooth pair at a position."""

    pair: int = figure("number of the tooth pair", whole=True, shown=False)
    load_share: float = figure("share of the torque on the tooth pair", symbol="X")
    half: int | None = figure("half of double helical gears", whole=True, optional=True, shown=False)
    force: float = figure("normal force", "N", "F_n")
    peak_pressure: float = figure("largest contact pressure away from singular edges", "MPa", "p_max")
    peak_pressure_error: float = figure("estimate of the error of the largest contact pressure", "%")
    on_edge: bool = figure("whether there is edge contact: load on cells next to an edge")
    edge_contact: bool = figure("whether the contact pressure is singular at an edge")
    bending_stress: Mapping[str, float] = figure(
        "bending stress in the fillets of the tooth pair", "MPa", "sigma_F", key="{member}_bending_stress_mpa"
    )

    @property
    def name(self) -> str:
        """Number of the tooth pair for tables, with a prime for the second half of double helical gears."""
        return f"{self.pair}{stroke(self.half)}"

    @property
    def column(self) -> str:
        """Beginning of the names of its columns."""
        return f"pair_{self.pair}" + ("" if self.half is None else f"_half_{self.half}")


@dataclass(frozen=True)
class LoadedPosition(Figures):
    """The gears under a torque at one position of the pinion."""

    torque: float = figure("torque on the pinion", "Nm", "T_1")
    phi1: float = figure("rotation of the pinion", "deg", "phi_1")
    te: float = figure("loaded transmission error, against the first position without load", "arcsec")
    unloaded_te: float = figure("transmission error without load, against the first position", "arcsec")
    rotation: float = figure("rotation of the pinion by the deflection of the teeth and the bodies", "arcsec")
    gear_torque: float = figure("torque on the gear", "Nm", "T_2")
    te_um: float | None = figure(
        "loaded transmission error along the travel of a gear that slides", "um", key="te_um", optional=True
    )
    unloaded_te_um: float | None = figure(
        "transmission error without load along the travel of a gear that slides",
        "um",
        key="unloaded_te_um",
        optional=True,
    )
    gear_force: float | None = figure("force on a gear that slides, along its travel", "N", optional=True)
    stiffness: float = figure("secant mesh stiffness: torque over rotation", "Nm/arcsec")
    tangent_stiffness: float = figure("tangent mesh stiffness", "Nm/arcsec")
    tangent_stiffness_per_width: float | None = figure(
        "tangent mesh stiffness along the line of action per mm of face",
        "N/(mm um)",
        key="tangent_stiffness_n_per_mm_um",
        optional=True,
    )
    peak_pressure: float = figure("largest contact pressure away from singular edges", "MPa", "p_max")
    peak_pressure_error: float = figure("estimate of the error of the largest contact pressure", "%")
    peak_pressure_pair: int | None = figure("tooth pair with the largest contact pressure", whole=True)
    peak_pressure_point: list[float] = figure("place of the largest contact pressure, fixed frame", "mm", vector=True)
    edge_contact: bool = figure("whether the contact pressure is singular at an edge")
    fillets: Mapping[str, FilletFigures] = figure("stresses in the fillets", parts=FilletFigures)
    root_stress_point: Mapping[str, list[float]] = figure(
        "place of the largest tensile stress in the fillet", "mm", key="{member}_root_stress_point_mm", vector=True
    )
    displacements: Mapping[str, MemberDisplacement] = figure(
        "displacements of members on elastic mounts", parts=MemberDisplacement
    )
    meshes: Mapping[str, MeshShareFigures] = figure("meshes that share the torque", parts=MeshShareFigures)
    tooth_pairs: tuple[ToothPairFigures, ...] = figure("load on each tooth pair", shown=False)
    residual: float = figure("largest residual of the contact conditions", "mm", rounding=True)
    status: str = figure("whether the solver converged")


@dataclass(frozen=True)
class ToothPairPosition(Figures):
    """One tooth pair under a torque at one position of its own engagement."""

    torque: float = figure("torque on the pinion", "Nm", "T_1")
    phi1: float = figure("rotation of the pinion in the mesh cycle of tooth pair 0", "deg", "phi_1")
    half: int | None = figure("half of double helical gears", whole=True, optional=True)
    load_share: float = figure("share of the torque on the tooth pair", symbol="X")
    force: float = figure("normal force", "N", "F_n")
    peak_pressure: float = figure("largest contact pressure away from singular edges", "MPa", "p_max")
    peak_pressure_error: float = figure("estimate of the error of the largest contact pressure", "%")
    edge_contact: bool = figure("whether the contact pressure is singular at an edge")
    bending_stress: Mapping[str, float] = figure(
        "bending stress in the fillets of the tooth pair", "MPa", "sigma_F", key="{member}_bending_stress_mpa"
    )


@dataclass(frozen=True)
class LoadedTotals(Figures):
    """The gears under a torque over all positions."""

    torque: float = figure("torque on the pinion", "Nm", "T_1")
    te_peak_to_peak: float = figure("loaded transmission error, peak to peak over the positions", "arcsec")
    unloaded_te_peak_to_peak: float = figure(
        "transmission error without load, peak to peak over the whole mesh cycle", "arcsec"
    )
    mean_tooth_pairs: float = figure("mean number of loaded tooth pairs")
    tooth_pairs: list[int] = figure("least and most loaded tooth pairs", whole=True)
    max_pressure: float = figure("largest contact pressure away from singular edges", "MPa", "p_max")
    max_pressure_error: float = figure("estimate of the error of the largest contact pressure", "%")
    max_pressure_phi1: float = figure("rotation of the pinion at which the contact pressure is largest", "deg")
    max_pair_force: float = figure("largest normal force on one tooth pair", "N", "F_n")
    gear_torque_ripple: float = figure("torque on the gear, peak to peak over the positions, of its mean", "%")
    mean_tangent_stiffness: float = figure("mean tangent mesh stiffness", "Nm/arcsec")
    mean_tangent_stiffness_per_width: float | None = figure(
        "mean tangent mesh stiffness along the line of action per mm of face, bodies included",
        "N/(mm um)",
        key="mean_tangent_stiffness_n_per_mm_um",
        optional=True,
    )
    c_gamma: float | None = figure(
        "mean tangent mesh stiffness of the teeth along the line of action per mm of face, without the twist of the bodies",
        "N/(mm um)",
        "c_gamma",
        optional=True,
    )
    c_prime: float | None = figure(
        "largest stiffness of one tooth pair along the line of action per mm of face, without the twist of the bodies",
        "N/(mm um)",
        "c'",
        key="c_prime_n_per_mm_um",
        optional=True,
    )
    k_h_beta: float | None = figure(
        "face load factor: largest load per face width, mean over the positions, over its mean along the face",
        symbol="K_Hbeta",
        optional=True,
    )
    k_f_beta: float | None = figure(
        "face load factor of root stress by ISO 6336-1, from K_Hbeta, face widths and whole depths",
        symbol="K_Fbeta",
        optional=True,
    )
    k_h_alpha: float | None = figure(
        "transverse load factor of ISO 6336-1: largest force on a tooth pair over that without pitch deviations",
        symbol="K_Halpha",
        optional=True,
    )
    fillets: Mapping[str, FilletFigures] = figure("largest stresses in the fillets", parts=FilletFigures)
    nominal_contact_stress: float | None = figure(
        "nominal contact stress of ISO 6336-2, without load factors", "MPa", "sigma_H0", optional=True
    )
    nominal_root_stress: Mapping[str, float] = figure(
        "nominal root stress of ISO 6336-3, without load factors",
        "MPa",
        "sigma_F0",
        key="{member}_nominal_root_stress_mpa",
    )
    meshes: Mapping[str, MeshShareTotals] = figure("meshes that share the torque", parts=MeshShareTotals)
    on_edge: bool = figure("whether there is edge contact at any position")
    edge_contact: bool = figure("whether the contact pressure is singular at an edge anywhere")
    edge_load_share: Mapping[str, float] = figure(
        "largest share of the torque on the cells next to an edge, by edges", shown=False
    )


@dataclass(frozen=True)
class LoadedFigures(Figures):
    """All figures of loaded contact."""

    totals: list[LoadedTotals] = figure("the gears over all positions, one per torque")
    positions: list[LoadedPosition] = figure("the gears, one per torque and position")
    tooth_pair: list[ToothPairPosition] = figure(
        "one tooth pair from its first touch to its last, one per torque and position"
    )


def stroke(half: int | None) -> str:
    """Return the mark of the second half of double helical gears in tables."""
    return "'" if half == 2 else ""
