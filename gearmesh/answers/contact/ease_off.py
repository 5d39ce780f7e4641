"""Ease-off map of a pair, as tables and files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, round_to
from gearmesh.contact.engagement.ease_off import EaseOff, ease_off
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.flanks import solver_pair
from gearmesh.design.core import Design
from gearmesh.errors import NoSolutionError
from gearmesh.figures import Content, Figures, figure
from gearmesh.formats import JSON_SUFFIX, VTU_SUFFIX
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair


def ease_off_of(design: Design, pair: GearPair, engagement: Engagement | None = None) -> EaseOffMap:
    """Return the ease-off map of a pair, from its `engagement` if known.

    Raises NoSolutionError if the flanks never meet.
    """
    followed = whole_engagement(solver_pair(pair), pair.pitch) if engagement is None else engagement
    if followed is None:
        raise NoSolutionError(reason="the flanks never meet", remedy="reduce the assembly errors")
    return EaseOffMap(design, pair, ease_off(followed, pair.pitch))


@dataclass(frozen=True)
class EaseOffPoint(Figures):
    """The ease-off at a point of the pinion's flank."""

    s: float = figure("place from form diameter (0) to tip (1)")
    t: float = figure("place from toe (0) to heel (1)")
    point: list[float] = figure("point of the flank, own frame of the pinion", "mm", vector=True)
    ease_off: float = figure("distance of the pinion's flank from the gear's at the nominal ratio", "um")
    phi1: float = figure("rotation of the pinion at which the point is closest to the gear's flank", "deg", "phi_1")


@dataclass(frozen=True, repr=False)
class EaseOffMap(Result):
    """Gap (um) between the flanks of pinion and gear at the nominal ratio; NaN where the gear has no flank."""

    design: Design
    pair: GearPair
    map: EaseOff

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, VTU_SUFFIX)

    @property
    def headline(self) -> str:
        return f"{self.map.distance.size} points, up to {1e3 * np.nanmax(self.map.distance):.4g} um"

    @property
    def listings(self) -> list[Listing]:
        """Table with the tip at the top and the form point at the bottom, toe left and heel right."""
        um = 1e3 * self.map.distance[::-3, ::4]
        heads = ["ease-off um", *(f"{k}" for k in np.linspace(0.0, 1.0, um.shape[1]).round(2))]
        s = np.linspace(1.0, 0.0, um.shape[0]).round(2)
        rows = [[float(share), *(round_to(float(value), 3) for value in row)] for share, row in zip(s, um, strict=True)]
        return [
            Listing(
                f"Ease-off of the {self.pair.pinion.name}, form point (0) to tip (1), toe (0) to heel (1)", heads, rows
            )
        ]

    def rows(self) -> list[EaseOffPoint]:
        """The ease-off, point by point.

        Returns
        -------
        list of EaseOffPoint
            Place on the flank (s from form point to tip, t from toe to heel), point, mm, ease-off, um, and phi1, deg.

        Examples
        --------
        >>> gears.ease_off().rows()[0].s
        0.0
        """
        i, j = self.map.distance.shape
        s, t = np.meshgrid(np.linspace(0.0, 1.0, i), np.linspace(0.0, 1.0, j), indexing="ij")
        return [
            EaseOffPoint(
                s=float(s[k]),
                t=float(t[k]),
                point=self.map.points[k].tolist(),
                ease_off=1e3 * float(self.map.distance[k]),
                phi1=float(np.degrees(self.map.phi1[k])),
            )
            for k in np.ndindex(i, j)
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.row for row in self.rows()])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "shape": self.map.distance.shape, "ease_off": self.rows()}

    def _write(self, target: Path) -> None:
        """Write quadrilaterals in the pinion's own frame, with ease-off and phi1 at their corners."""
        import meshio

        from gearmesh.io.atomic import whole_file

        i, j = self.map.distance.shape
        number = np.arange(i * j).reshape(i, j)
        corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
        cells = np.stack([corner.ravel() for corner in corners], axis=-1)
        data = {"ease_off_um": 1e3 * self.map.distance.ravel(), "phi1_deg": np.degrees(self.map.phi1.ravel())}
        mesh = meshio.Mesh(self.map.points.reshape(-1, 3), [("quad", cells)], point_data=data)
        with whole_file(target) as unfinished:
            mesh.write(unfinished, file_format="vtu")
