"""Figures of tooth contact: at one position, over the path of a tooth pair, and over the mesh cycle."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearmesh.contact.engagement.cycle import Cycle
from gearmesh.contact.pair import FORM_POINT, MEMBER_NAMES
from gearmesh.contact.path import ContactPath
from gearmesh.contact.sliding import FlankMotion
from gearmesh.figures import Entry, Figures, Summary, figure
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair


def shown_edge(edge: str, names: Sequence[str] = MEMBER_NAMES) -> str:
    """Return an edge in contact as tables and pages show it, with the names of the members.

    "gear_heel+gear_joint" becomes "wheel heel, wheel form point".
    """
    words = {**dict(zip(MEMBER_NAMES, names, strict=True)), FORM_POINT: "form point"}
    return ", ".join(" ".join(words.get(word, word) for word in edge_name.split("_")) for edge_name in edge.split("+"))


def shown_contact(kind: str, edge: str | None, names: Sequence[str]) -> str:
    """Return the kind of contact at a position, with the name of the edge in edge contact."""
    return f"edge: {shown_edge(edge, names)}" if edge else kind


@dataclass(frozen=True)
class PathSummary(Figures):
    """The path of contact of one tooth pair over all positions."""

    positions: int = figure("positions of the pinion that were requested", whole=True)
    converged: int = figure("positions at which the tooth pair touches", whole=True)
    te_peak_to_peak: float | None = figure(
        "transmission error of the tooth pair, peak to peak over the positions", "arcsec"
    )
    max_residual: float | None = figure(
        "largest distance between the two flanks at a point of contact", "mm", rounding=True
    )
    seconds: float = figure("time of the solver", "s", timing=True)
    shaft_angle: float = figure("shaft angle", "deg", "Sigma")

    @staticmethod
    def of(pair: GearPair, path: ContactPath) -> PathSummary:
        """Return the figures of a solved path."""
        te = path.te[path.touching]
        return PathSummary(
            positions=len(path.phi1),
            converged=int(path.touching.sum()),
            te_peak_to_peak=float(np.ptp(te)) / ARCSEC if te.size else None,
            max_residual=float(path.residual[path.touching].max()) if te.size else None,
            seconds=path.seconds,
            shaft_angle=float(np.degrees(pair.shaft_angle)),
        )


@dataclass(frozen=True)
class CycleSummary(Figures):
    """The mesh cycle: the gears as the tooth pairs in contact turn them, over one pitch."""

    contact_ratio: float = figure(
        "contact ratio of the flank surfaces without load: tooth pairs in contact on average", symbol="eps"
    )
    transverse_contact_ratio: float | None = figure(
        "transverse contact ratio, of line contact", symbol="eps_alpha", optional=True
    )
    overlap_ratio: float | None = figure("overlap ratio, of line contact", symbol="eps_beta", optional=True)
    pairs_in_contact: list[int] | None = figure(
        "least and most tooth pairs with surface contact", optional=True, whole=True
    )
    engagement_phi1: list[float] = figure(
        "rotation of the pinion at which a tooth pair begins and ends contact, edge contact included", "deg"
    )
    mesh_te_peak_to_peak: float = figure("transmission error of the gears, peak to peak over the mesh cycle", "arcsec")
    mesh_te_harmonics: list[float] = figure(
        "amplitude of the harmonics of the mesh frequency in the transmission error",
        "arcsec",
        singular="mesh_te_harmonic",
    )
    te_breaks_phi1: list[float] = figure("rotations of the pinion at which the transmission error jumps", "deg")

    @staticmethod
    def of(cycle: Cycle) -> CycleSummary:
        """Return the figures of a solved mesh cycle."""
        line, known = bool(np.isfinite(cycle.overlap_ratio)), bool(np.isfinite(cycle.contact_ratio))
        pairs = [math.floor(cycle.contact_ratio + 1e-9), math.ceil(cycle.contact_ratio - 1e-9)] if known else None
        return CycleSummary(
            contact_ratio=cycle.contact_ratio,
            transverse_contact_ratio=cycle.transverse_ratio if line else None,
            overlap_ratio=cycle.overlap_ratio if line else None,
            pairs_in_contact=pairs,
            engagement_phi1=np.degrees(cycle.engagement).tolist(),
            mesh_te_peak_to_peak=cycle.peak_to_peak / ARCSEC,
            mesh_te_harmonics=[float(a) / ARCSEC for a in cycle.harmonics],
            te_breaks_phi1=[float(np.degrees(gap.phi1)) for gap in cycle.breaks],
        )


@dataclass(frozen=True)
class SlideSummary(Figures):
    """A gear that slides, as a rack does."""

    displacement_per_turn: float = figure("travel of the gear per turn of the pinion", "mm")


def slid_summary(pair: GearPair, known: Summary) -> Iterator[Entry]:
    """Yield, for a gear that slides, its travel per turn of the pinion, and every figure in arcsec also in um."""
    travel = pair.output.travel
    if travel is None:
        return
    yield from SlideSummary(2.0 * math.pi * pair.ratio * travel).entries
    um = 1e3 * travel * ARCSEC
    for entry in known.entries:
        if entry.figure.unit == "arcsec":
            value = entry.value
            moved = None if value is None else [um * v for v in value] if isinstance(value, list) else um * value
            yield replace(entry, figure=entry.figure.in_um(), value=moved)


@dataclass(frozen=True)
class TorqueSummary(Figures):
    """Hertz contact along the path under a torque."""

    torque: float = figure("torque on the pinion", "Nm", "T_1")
    load_sharing: str = figure("how tooth pairs share the torque")
    max_pressure: float | None = figure("largest Hertz pressure along the path", "MPa", "p_0")


@dataclass(frozen=True)
class EllipseFigures(Figures):
    """The contact ellipse under the thickness of marking compound that the design says."""

    a: float = figure("semi-major axis of the contact ellipse", "mm", "a")
    b: float = figure("semi-minor axis of the contact ellipse", "mm", "b")
    angle: float = figure("angle of the major axis, from the tooth's length", "deg")
    major_axis: list[float] = figure("direction of the major axis, fixed frame", vector=True)

    @property
    def known(self) -> bool:
        """False for lines and edges, which have no ellipse."""
        return not math.isnan(self.a)


@dataclass(frozen=True)
class CurvatureFigures(Figures):
    """Principal curvatures of a surface, or of the gap between two."""

    k1: float = figure("first principal curvature", "1/mm", "kappa_1")
    k2: float = figure("second principal curvature", "1/mm", "kappa_2")
    direction1: list[float] = figure("first principal direction, fixed frame", vector=True)
    direction2: list[float] = figure("second principal direction, fixed frame", vector=True)


@dataclass(frozen=True)
class PairCurvature(Figures):
    """Principal curvatures at a contact."""

    members: Mapping[str, CurvatureFigures] = figure("principal curvatures of the member's flank", key="{member}")
    relative: CurvatureFigures = figure("principal curvatures of the gap between both flanks")

    @property
    def known(self) -> bool:
        """False for edges, which have no curvature."""
        return not math.isnan(self.relative.k1)


@dataclass(frozen=True)
class HertzFigures(Figures):
    """The Hertz contact under a torque."""

    p0: float = figure("largest pressure", "MPa", "p_0")
    a: float = figure("semi-major axis of the pressed ellipse; of a line half its length", "mm", "a")
    b: float = figure("semi-minor axis of the pressed ellipse", "mm", "b")
    approach: float = figure("elastic approach of the bodies", "um", "delta")
    force: float = figure("normal force", "N", "F_n")

    @property
    def known(self) -> bool:
        """False for edges, which have no Hertz contact."""
        return not math.isnan(self.p0)


@dataclass(frozen=True)
class MotionFigures(Figures):
    """Sliding and rolling of both flanks at a contact, per radian of the pinion's rotation."""

    sliding: float = figure("sliding velocity of the flanks, per rad of the pinion", "mm/rad", "v_g")
    sliding_across: float = figure(
        "sliding velocity across the contact, above 0 where the pinion's surface is faster, per rad of the pinion",
        "mm/rad",
    )
    rolling: Mapping[str, float] = figure(
        "velocity of the member's surface through the contact, across it, per rad of the pinion",
        "mm/rad",
        key="rolling_{member}_mm_per_rad",
    )
    entrainment: float = figure(
        "mean velocity of both surfaces through the contact, across it, per rad of the pinion", "mm/rad"
    )

    @staticmethod
    def of(motion: FlankMotion, members: Sequence[str]) -> list[MotionFigures]:
        """Return the figures of all contacts (N,)."""
        columns = motion.sliding_speed, motion.sliding_across, motion.entrainment
        return [
            MotionFigures(sliding, across, dict(zip(members, rolling, strict=True)), entrainment)
            for sliding, across, entrainment, rolling in zip(
                *(column.tolist() for column in columns), motion.rolling.tolist(), strict=True
            )
        ]

    @property
    def known(self) -> bool:
        """False without contact."""
        return not math.isnan(self.sliding)


def velocity_per_rad(speed: float) -> float:
    """Return the velocity, m/s, of 1 mm per rad of the pinion at a speed of the pinion, rpm."""
    return 1e-3 * math.tau * speed / 60.0


@dataclass(frozen=True)
class SpeedFigures(Figures):
    """Velocities of both flanks at a contact, at a speed of the pinion."""

    sliding: float = figure("sliding velocity of the flanks", "m/s", "v_g")
    rolling: Mapping[str, float] = figure(
        "velocity of the member's surface through the contact, across it", "m/s", key="rolling_{member}_m_per_s"
    )
    entrainment: float = figure("mean velocity of both surfaces through the contact, across it", "m/s")
    pressure_velocity: float | None = figure("largest pressure times sliding velocity", "MPa m/s", "p v", optional=True)

    @staticmethod
    def of(motion: MotionFigures, speed: float, pressure: float | None) -> SpeedFigures:
        """Return the figures at a speed of the pinion, rpm, under a largest pressure, MPa, if it is known."""
        per_rad = velocity_per_rad(speed)
        return SpeedFigures(
            per_rad * motion.sliding,
            {member: per_rad * rolling for member, rolling in motion.rolling.items()},
            per_rad * motion.entrainment,
            None if pressure is None else per_rad * motion.sliding * pressure,
        )

    @property
    def known(self) -> bool:
        """False without contact."""
        return not math.isnan(self.sliding)


@dataclass(frozen=True)
class ParameterMeaning(Figures):
    """Unit and meaning of a parameter of a member's surface."""

    unit: str = figure("unit of the parameter")
    meaning: str = figure("meaning of the parameter in words")


@dataclass(frozen=True)
class MemberPoint(Figures):
    """Place at which a member touches."""

    params: Mapping[str, float] = figure(
        "parameters of the surface, named as in the source; units and meanings under surface_parameters", bare=True
    )
    point: list[float] = figure("point of contact, own frame of the member", "mm", vector=True, nullable=True)


@dataclass(frozen=True)
class PositionFigures(Figures):
    """One tooth pair at one position of the pinion."""

    phi1: float = figure("rotation of the pinion, as the design counts it", "deg", "phi_1")
    phi2: float = figure("rotation of the gear", "deg", "phi_2")
    te: float = figure("transmission error of the tooth pair, against phi1 = 0", "arcsec", "Delta phi_2")
    displacement: float | None = figure("travel of a gear that slides", "mm", optional=True)
    te_um: float | None = figure(
        "transmission error along the travel of a gear that slides", "um", key="te_um", optional=True
    )
    contact: str = figure("kind of contact: point, line, edge, none")
    edge: str | None = figure("edge that touches")
    regions: Mapping[str, str | None] = figure("part of each member's tooth that touches")
    status: str = figure("whether the solver converged")
    residual: float = figure("distance of the two flanks", "mm", rounding=True)
    point: list[float] = figure("point of contact, fixed frame", "mm", vector=True, nullable=True)
    normal: list[float] = figure(
        "unit normal at the contact, out of the pinion, fixed frame", vector=True, nullable=True
    )
    members: Mapping[str, MemberPoint] = figure("contact in the frame of the member", key="{member}")
    ellipse: EllipseFigures = figure("contact ellipse")
    curvature: PairCurvature = figure("principal curvatures of both flanks, and relative ones")
    line: Any = figure("points of the line of contact, fixed frame", "mm", shown=False)
    hertz: HertzFigures | None = figure("Hertz contact under a torque", optional=True)
    load_share: float | None = figure("share of the torque on the tooth pair", optional=True)
    neighbour_advance: float | None = figure(
        "transmission advance of a neighbouring tooth pair, as rotation of the gear",
        "arcsec",
        key="neighbour_lead_arcsec",
        optional=True,
    )
    neighbour_advance_um: float | None = figure(
        "the same along the travel of a gear that slides", "um", key="neighbour_lead_um", optional=True
    )
    backlash: float | None = figure(
        "backlash of the gears at this position, as rotation of the gear", "deg", "j_theta", optional=True
    )
    te_first_order: float | None = figure("transmission error of first order, in closed form", "arcsec", optional=True)
    line_load: float | None = figure("load per length in the middle of the contact", "N/mm", "w", optional=True)
    motion: MotionFigures = figure("sliding and rolling of both flanks, per rad of the pinion")
    at_speed: SpeedFigures | None = figure("velocities of both flanks at the speed of the pinion", optional=True)
