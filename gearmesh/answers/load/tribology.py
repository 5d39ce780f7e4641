"""Load, sliding and rolling along every loaded contact: what wears and heats the flanks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.contact.figures import MotionFigures, SpeedFigures
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, csv_text, round_to
from gearmesh.design.core import Design
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.rows import ContactRows, contact_rows
from gearmesh.loaded.sharing import LoadedMesh
from gearmesh.teeth.gear_train import GearPair


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
    motion: MotionFigures = figure("sliding and rolling, per rad of the pinion")
    at_speed: SpeedFigures | None = figure("velocities at the speed of the pinion", optional=True)


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
    #: speed of the pinion, rpm; None if not given
    speed: float | None = None

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, CSV_SUFFIX)

    @property
    def headline(self) -> str:
        return f"{len(self.rows)} rows of loaded contacts, torques: {len(self.mesh.torque)}"

    @cached_property
    def _contacts(self) -> list[ContactRows]:
        """Rows under each torque."""
        return [contact_rows(self.pair, load) for load in self.mesh.loads]

    @cached_property
    def rows(self) -> list[RowFigures]:
        """Figures of every loaded row, by torque, position, tooth pair and place along the contact."""
        torques = 1e-3 * self.mesh.torque
        return [
            row
            for torque, contact in zip(torques.tolist(), self._contacts, strict=True)
            for row in self._rows_of(torque, contact)
        ]

    def _rows_of(self, torque: float, contact: ContactRows) -> list[RowFigures]:
        """Return the figures of the rows under a torque, Nm."""
        names = list(self.pair.members)
        phi1 = np.degrees(self.mesh.phi1[contact.position]).round(12)
        motions = MotionFigures.of(contact.motion, names)
        places, curvatures = contact.own_point.tolist(), contact.curvatures.tolist()
        whole = [column.tolist() for column in (contact.number, contact.half, contact.on_edge)]
        measured = [
            column.tolist()
            for column in (contact.point, contact.length, contact.line_load, contact.pressure, contact.motion.curvature)
        ]
        return [
            RowFigures(
                torque,
                angle,
                number,
                self.pair.pinion.halves[half].number,
                point,
                {name: RowMember(places[k][n], *curvatures[k][n]) for k, name in enumerate(names)},
                length,
                line_load,
                pressure,
                on_edge,
                curvature,
                motion,
                None if self.speed is None else SpeedFigures.of(motion, self.speed, pressure),
            )
            for n, (motion, angle, number, half, on_edge, point, length, line_load, pressure, curvature) in enumerate(
                zip(motions, phi1.tolist(), *whole, *measured, strict=True)
            )
        ]

    @cached_property
    def totals(self) -> list[TribologyTotals]:
        """Extremes over all rows, one per torque."""
        return [
            self._total(float(torque), contact)
            for torque, contact in zip(1e-3 * self.mesh.torque, self._contacts, strict=True)
        ]

    def _total(self, torque: float, contact: ContactRows) -> TribologyTotals:
        """Return the extremes under a torque, Nm."""
        sliding, inner = contact.motion.sliding_speed, ~contact.on_edge
        per_rad = None if self.speed is None else 1e-3 * 2.0 * np.pi * self.speed / 60.0
        largest = float(sliding.max())
        return TribologyTotals(
            torque,
            largest,
            _largest(contact.line_load[inner]),
            None if per_rad is None else per_rad * largest,
            None if per_rad is None else per_rad * _largest((contact.pressure * sliding)[inner]),
        )

    @property
    def listings(self) -> list[Listing]:
        heads = ["Nm", "sliding mm/rad", "load N/mm", "sliding m/s", "p v MPa m/s"]
        rows = [[round_to(value, 3) for value in total.row.values()] for total in self.totals]
        return [Listing("Largest along all loaded contacts, away from edges", heads[: len(rows[0])], rows)]

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
        >>> gears.loaded_contact(20.0, [0.0]).tribology().csv().splitlines()[0].split(",")[:3]
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
            "warnings": self.warnings,
            "pinion_speed_rpm": self.speed,
            **Summary(TribologyFigures(self.totals, self.rows)),
        }


@dataclass(frozen=True)
class TribologyFigures(Figures):
    """All figures along loaded contacts."""

    totals: list[TribologyTotals] = figure("extremes over all rows, one per torque")
    rows: list[RowFigures] = figure("rows of loaded contacts, one per place along each")


def _largest(values: Array) -> float:
    """Return the largest value; NaN if there is none."""
    return float(values.max()) if values.size else np.nan
