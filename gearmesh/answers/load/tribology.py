"""Load, sliding and rolling along every loaded contact: what wears and heats the flanks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.contact.figures import MotionFigures, SpeedFigures, velocity_per_rad
from gearmesh.answers.load.members import materials_of
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, csv_text, round_to
from gearmesh.arguments import refuse_speed
from gearmesh.contact.hertz import contact_modulus
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX
from gearmesh.kernel.numeric.algebra import Array, largest_known
from gearmesh.loaded.lubrication import (
    LEAST_PECLET,
    STEEL_THERMAL_CONTACT,
    film_thickness,
    flash_temperature,
    half_width,
    mean_friction,
    peclet_number,
)
from gearmesh.loaded.rows import ContactRows, contact_rows
from gearmesh.loaded.sharing import LoadedMesh
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair

#: headings of the table of extremes, by fields of `TribologyTotals`
TOTAL_HEADINGS = {
    "torque": "Nm",
    "max_sliding": "sliding mm/rad",
    "max_line_load": "load N/mm",
    "max_sliding_at_speed": "sliding m/s",
    "max_pressure_velocity": "p v MPa m/s",
    "efficiency": "efficiency %",
    "standard_friction": "mu of 14179-2",
    "standard_efficiency": "efficiency %, mu of 14179-2",
    "friction_power": "friction W",
    "max_flash_temperature": "flash K",
    "min_film_thickness": "film um",
}


@dataclass(frozen=True)
class RowMember(Figures):
    """A member's flank at a row of a loaded contact."""

    point: list[float] = figure("place of the row, own frame of the member", "mm", key="{member}_point_mm", vector=True)
    k1: float = figure("greater principal curvature, below 0 where convex", "1/mm", key="{member}_k1_per_mm")
    k2: float = figure("smaller principal curvature, below 0 where convex", "1/mm", key="{member}_k2_per_mm")


@dataclass(frozen=True)
class RowFigures(Figures):
    """A row of cells of a loaded contact: one place along the contact of one tooth pair."""

    torque: float = figure("torque on the pinion", "Nm", "T_1")
    phi1: float = figure("rotation of the pinion", "deg", "phi_1")
    pair: int = figure("number of the tooth pair", whole=True)
    half: int | None = figure("half of double helical gears", whole=True, optional=True)
    point: list[float] = figure("place of the row, fixed frame", "mm", vector=True)
    members: Mapping[str, RowMember] = figure("both flanks", parts=RowMember)
    length: float = figure("length of the row along the contact", "mm")
    line_load: float = figure("load per length", "N/mm", "w")
    pressure: float = figure("largest contact pressure across the row", "MPa", "p")
    on_edge: bool = figure("whether there is edge contact, where the pressure grows with every refinement of the cells")
    curvature: float = figure("relative curvature across the contact", "1/mm", "1/rho")
    half_width: float = figure("half width of the contact by Hertz, from load per length and curvature", "mm", "b_H")
    motion: MotionFigures = figure("sliding and rolling, per rad of the pinion")
    at_speed: SpeedFigures | None = figure("velocities at the speed of the pinion", optional=True)
    friction_power: float | None = figure("friction power of the row", "W", optional=True)
    flash_temperature: float | None = figure(
        "flash temperature by Blok: largest rise over the bulk temperature", "K", "Theta_fl", optional=True
    )
    film_thickness: float | None = figure("least film thickness by Dowson and Higginson", "um", "h", optional=True)


@dataclass(frozen=True)
class TribologyTotals(Figures):
    """Extremes over all rows under a torque."""

    torque: float = figure("torque on the pinion", "Nm", "T_1")
    max_sliding: float = figure("largest sliding velocity of loaded flanks, per rad of the pinion", "mm/rad", "v_g")
    max_line_load: float = figure("largest load per length, away from edges", "N/mm", "w")
    max_sliding_at_speed: float | None = figure(
        "largest sliding velocity of loaded flanks", "m/s", "v_g", key="max_sliding_m_per_s", optional=True
    )
    max_pressure_velocity: float | None = figure(
        "largest pressure times sliding velocity, away from edges", "MPa m/s", "p v", optional=True
    )
    efficiency: float | None = figure(
        "efficiency of the mesh with sliding friction alone, mean over the positions", "%", "eta", optional=True
    )
    standard_friction: float | None = figure(
        "mean coefficient of friction of ISO/TR 14179-2 for mineral oil", symbol="mu_m", optional=True
    )
    standard_efficiency: float | None = figure(
        "efficiency of the mesh with this coefficient of friction", "%", "eta", optional=True
    )
    friction_power: float | None = figure("friction power, mean over the positions", "W", "P_VZ", optional=True)
    max_flash_temperature: float | None = figure(
        "largest flash temperature by Blok, away from edges", "K", "Theta_fl", optional=True
    )
    min_film_thickness: float | None = figure(
        "least film thickness by Dowson and Higginson, away from edges", "um", "h_min", optional=True
    )


@dataclass(frozen=True)
class RunningConditions:
    """Speed, friction and oil under which gears run; None where they are not given.

    Raises ArgumentError for values that cannot be.
    """

    #: speed of the pinion, rpm
    speed: float | None = None
    #: coefficient of friction
    friction: float | None = None
    #: dynamic viscosity of the oil at the bulk temperature of the teeth, mPa s
    viscosity: float | None = None
    #: pressure-viscosity coefficient of the oil there, 1/GPa
    pressure_viscosity: float | None = None
    #: arithmetic mean roughness Ra of both flanks, um
    roughness: float | None = None

    def __post_init__(self) -> None:
        refuse_speed(self.speed)
        if self.friction is not None and not 0.0 < self.friction < 1.0:
            raise ArgumentError("friction", self.friction, must_be="a coefficient above 0 and below 1")
        units = {"viscosity": "mPa s", "pressure_viscosity": "1/GPa", "roughness": "um"}
        given = {name: value for name in units if (value := getattr(self, name)) is not None}
        for name, value in given.items():
            if not 0.0 < value < math.inf:
                raise ArgumentError(name, value, unit=units[name], must_be="a finite number above 0")
        reasons = {
            "pressure_viscosity": "a film needs speed, viscosity and pressure_viscosity",
            "roughness": "the coefficient of friction of ISO/TR 14179-2 needs speed, viscosity and roughness",
        }
        if "viscosity" in given and (len(given) == 1 or self.speed is None):
            reason = reasons["roughness" if "roughness" in given else "pressure_viscosity"]
            raise ArgumentError("viscosity", given["viscosity"], reason=reason)
        for name, reason in reasons.items():
            if name in given and "viscosity" not in given:
                raise ArgumentError(name, given[name], reason=reason)

    @property
    def per_rad(self) -> float | None:
        """Velocity, m/s, of 1 mm per rad of the pinion; None without a speed."""
        return None if self.speed is None else velocity_per_rad(self.speed)


@dataclass(frozen=True)
class PitchPoint:
    """Mesh of parallel axes at its pitch point."""

    #: base radius of the pinion, mm
    base_radius: float
    #: radius of its working pitch circle, mm
    radius: float
    #: common face width, mm, of all halves
    face: float
    #: relative curvature across the contact, 1/mm
    curvature: float

    @property
    def working_angle(self) -> float:
        """Working transverse pressure angle, rad."""
        return math.acos(self.base_radius / self.radius)


@dataclass(frozen=True, repr=False)
class Tribology(Result):
    """Rows of all loaded contacts of a pair, by torque and position."""

    #: the design
    design: Design
    #: the pair
    pair: GearPair
    #: the solved loaded mesh
    mesh: LoadedMesh
    #: warnings, one line each
    warnings: tuple[str, ...] = ()
    #: speed, friction and oil
    running: RunningConditions = RunningConditions()
    #: the pitch point; None unless the axes are parallel
    pitch_point: PitchPoint | None = None

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, CSV_SUFFIX)

    @property
    def headline(self) -> str:
        return f"{len(self.rows)} rows of loaded contacts, torques: {len(self.mesh.torque)}"

    @cached_property
    def _contacts(self) -> list[_Heated]:
        """Rows under each torque, with friction and film."""
        materials = materials_of(self.design, self.pair)
        modulus = contact_modulus(*materials)
        return [_Heated(contact_rows(self.pair, load), self.running, modulus) for load in self.mesh.loads]

    @cached_property
    def rows(self) -> list[RowFigures]:
        """Figures of every loaded row, by torque, position, tooth pair and place along the contact."""
        torques = 1e-3 * self.mesh.torque
        return [
            row
            for torque, heated in zip(torques.tolist(), self._contacts, strict=True)
            for row in self._rows_of(torque, heated)
        ]

    def _rows_of(self, torque: float, heated: _Heated) -> list[RowFigures]:
        """Return the figures of the rows under a torque, Nm."""
        names, contact, speed = list(self.pair.members), heated.rows, self.running.speed
        phi1 = np.degrees(self.mesh.phi1[contact.position]).round(12).tolist()
        motions = MotionFigures.of(contact.motion, names)
        places, curvatures, points = contact.own_point.tolist(), contact.curvatures.tolist(), contact.point.tolist()
        known = (heated.friction_power, heated.flash_temperature, heated.film_thickness)
        return [
            RowFigures(
                torque,
                phi1[n],
                int(contact.number[n]),
                self.pair.pinion.halves[int(contact.half[n])].number,
                points[n],
                {name: RowMember(places[k][n], *curvatures[k][n]) for k, name in enumerate(names)},
                float(contact.length[n]),
                float(contact.line_load[n]),
                float(contact.pressure[n]),
                bool(contact.on_edge[n]),
                float(contact.motion.curvature[n]),
                float(heated.half_width[n]),
                motion,
                None if speed is None else SpeedFigures.of(motion, speed, float(contact.pressure[n])),
                *(None if values is None else float(values[n]) for values in known),
            )
            for n, motion in enumerate(motions)
        ]

    @cached_property
    def totals(self) -> list[TribologyTotals]:
        """Extremes over all rows, one per torque."""
        return [
            self._total(float(torque), float(carried), heated)
            for torque, carried, heated in zip(
                1e-3 * self.mesh.torque, 1e-3 * self.mesh.carried, self._contacts, strict=True
            )
        ]

    def _total(self, torque: float, carried: float, heated: _Heated) -> TribologyTotals:
        """Return the extremes under a torque, Nm; `carried` is the part of it on this pair, others lose alike."""
        contact, per_rad = heated.rows, self.running.per_rad
        sliding, inner = contact.motion.sliding_speed, ~contact.on_edge
        flash, film = heated.flash_temperature, heated.film_thickness
        # friction work over the work of the loads without friction, mean over the positions; under the given torque
        # friction reduces all loads to 1 / (1 + lost)
        slid = 1e-3 * float((contact.line_load * contact.length * sliding).sum()) / len(self.mesh.phi1) / carried
        lost = None if self.running.friction is None else self.running.friction * slid
        standard = self._standard_friction(carried)
        return TribologyTotals(
            torque,
            float(sliding.max()),
            largest_known(contact.line_load[inner]),
            None if per_rad is None else per_rad * float(sliding.max()),
            None if per_rad is None else per_rad * largest_known((contact.pressure * sliding)[inner]),
            None if lost is None else 100.0 / (1.0 + lost),
            standard,
            None if standard is None else 100.0 / (1.0 + standard * slid),
            None if lost is None or per_rad is None else 1e3 * per_rad * torque * lost / (1.0 + lost),
            None if flash is None else largest_known(flash[inner]),
            None if film is None else -largest_known(-film[inner]),
        )

    def _standard_friction(self, torque: float) -> float | None:
        """Return the mean coefficient of friction [ISO/TR 14179-2] under a torque, Nm; None without a roughness."""
        running = self.running
        if running.roughness is None or running.viscosity is None or running.per_rad is None:
            return None
        point = self.pitch_point
        if point is None:
            raise ArgumentError(
                "roughness", running.roughness, unit="um", must_be="left out unless the axes are parallel"
            )
        return mean_friction(
            1e3 * torque / (point.base_radius * point.face),
            running.per_rad * point.radius,
            point.working_angle,
            point.curvature,
            running.viscosity,
            running.roughness,
        )

    @property
    def listings(self) -> list[Listing]:
        keys = dict.fromkeys(key for total in self.totals for key in total.row)
        names = {TribologyTotals.key_of(name): head for name, head in TOTAL_HEADINGS.items()}
        rows = [[round_to(value, 3) for value in total.row.values()] for total in self.totals]
        return [Listing("Extremes along all loaded contacts, away from edges", [names[key] for key in keys], rows)]

    @property
    def notes(self) -> list[str]:
        """Warnings about the figures of this answer, one line each."""
        slow = [heated.peclet for heated in self._contacts if heated.peclet is not None]
        if not slow or min(slow) >= LEAST_PECLET:
            return []
        return [
            f"flash temperature: heat flows along the surface at this speed (Peclet number {min(slow):.2g}, below "
            f"{LEAST_PECLET:g}): Blok's temperature is too high"
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.flat for row in self.rows])

    def csv(self) -> str:
        """The rows as a table.

        Returns
        -------
        str
            CSV, one line per row of a loaded contact, with flattened JSON keys as columns.

        Examples
        --------
        >>> loaded = gears.loaded_contact(20.0, [0.0], level="quick")
        >>> loaded.tribology().csv().splitlines()[0].split(",")[:3]
        ['torque_nm', 'phi1_deg', 'pair']
        """
        return csv_text([row.flat for row in self.rows])

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        whole_text(target, self.csv())

    @property
    def sections(self) -> Mapping[str, Content]:
        return {
            **header(self.design),
            "warnings": (*self.warnings, *self.notes),
            "pinion_speed_rpm": self.running.speed,
            "friction": self.running.friction,
            "viscosity_mpa_s": self.running.viscosity,
            "pressure_viscosity_per_gpa": self.running.pressure_viscosity,
            "roughness_um": self.running.roughness,
            **Summary(TribologyFigures(self.totals, self.rows)),
        }


@dataclass(frozen=True)
class TribologyFigures(Figures):
    """All figures along loaded contacts."""

    totals: list[TribologyTotals] = figure("extremes over all rows, one per torque")
    rows: list[RowFigures] = figure("rows of loaded contacts, one per place along each")


class _Heated:
    """Rows of loaded contacts with friction and film; None where it is not asked for."""

    def __init__(self, rows: ContactRows, running: RunningConditions, modulus: float) -> None:
        motion, per_rad, friction = rows.motion, running.per_rad, running.friction
        self.rows = rows
        #: half widths (N,), mm
        self.half_width = half_width(rows.line_load, motion.curvature, modulus)
        #: friction work (N,), N mm per rad of the pinion, of every row
        self.friction_work: Array | None = None
        #: friction power (N,), W, and flash temperature (N,), K
        self.friction_power: Array | None = None
        self.flash_temperature: Array | None = None
        #: film thickness (N,), um
        self.film_thickness: Array | None = None
        #: Peclet number of the slower surface where the flash temperature is largest
        self.peclet: float | None = None
        if friction is not None:
            self.friction_work = friction * rows.line_load * rows.length * motion.sliding_speed
        if per_rad is None:
            return
        rolling = per_rad * motion.rolling
        if friction is not None and self.friction_work is not None:
            self.friction_power = per_rad * self.friction_work
            self.flash_temperature = flash_temperature(
                friction,
                rows.line_load,
                self.half_width,
                per_rad * motion.sliding_speed,
                rolling,
                (STEEL_THERMAL_CONTACT, STEEL_THERMAL_CONTACT),
            )
            if np.isfinite(self.flash_temperature).any():
                hottest = int(np.nanargmax(self.flash_temperature))
                slower = float(np.abs(rolling[hottest]).min())
                self.peclet = peclet_number(slower, float(self.half_width[hottest]))
        if running.viscosity is not None and running.pressure_viscosity is not None:
            self.film_thickness = film_thickness(
                rows.line_load,
                motion.curvature,
                per_rad * motion.entrainment,
                modulus,
                running.viscosity,
                running.pressure_viscosity,
            )
