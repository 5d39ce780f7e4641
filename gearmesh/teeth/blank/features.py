"""Features of a gear body: turned hubs, shafts and stepped bores; keyways and other forms of the bore, holes and spokes
that are cut along the axis.

A cut is a prism along the axis, with an outline of lines and arcs. Angles are in rad, lengths in mm.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import Body, TurnedStep
from gearmesh.teeth.blank.bores import BoreForm, ClosedLine, Slot
from gearmesh.teeth.region import Region


@dataclass(frozen=True)
class Boss:
    """Hub: a cylinder on an end face, mm."""

    diameter: float
    length: float

    @property
    def step(self) -> TurnedStep:
        """The hub as a step on the end face of a body."""
        return TurnedStep(0.5 * self.diameter, 0.5 * self.diameter, self.length, Region.HUB)


class Pattern(Protocol):
    """Openings of the same shape, evenly spaced round the axis, or along a bar."""

    @property
    def region(self) -> Region:
        """Region of their walls."""

    @property
    def depth(self) -> float | None:
        """Depth (mm) from the heel's face, None for openings through the body."""

    @property
    def count(self) -> int:
        """Number of openings."""

    @property
    def reach(self) -> tuple[float, float]:
        """Smallest and largest radius (mm), or height over a bar's reference plane."""

    @property
    def outlines(self) -> tuple[ClosedLine, ...]:
        """Outline of each opening."""


@dataclass(frozen=True)
class Drilling:
    """Holes along the axis, evenly spaced on a circle; lengths in mm."""

    #: number of holes
    count: int
    #: diameter of a hole
    diameter: float
    #: diameter of the circle through their centres
    circle: float
    #: polar angle of the first hole, rad
    start: float = 0.0
    #: depth from the heel's face; None: through the body
    depth: float | None = None
    #: region of the walls
    region: Region = Region.HOLE

    @property
    def centres(self) -> Array:
        """Centres of the holes, (count, 2), mm."""
        angle = self.start + 2.0 * np.pi * np.arange(self.count) / self.count
        return np.asarray(0.5 * self.circle * np.stack((np.cos(angle), np.sin(angle)), axis=-1))

    @property
    def reach(self) -> tuple[float, float]:
        return 0.5 * (self.circle - self.diameter), 0.5 * (self.circle + self.diameter)

    @property
    def outlines(self) -> tuple[ClosedLine, ...]:
        return tuple((PlaneArc.circle(0.5 * self.diameter, centre),) for centre in self.centres)


@dataclass(frozen=True)
class HoleRow:
    """Row of bolt holes across a bar; lengths in mm."""

    #: number of holes
    count: int
    #: diameter of a hole
    diameter: float
    #: distance between neighbouring centres
    pitch: float
    #: height of the centres over the reference plane
    height: float
    #: y of the middle of the row
    middle: float
    #: depth from the heel's face; None: through the bar
    depth: float | None = None
    #: region of the walls
    region: Region = Region.BOLT

    @property
    def centres(self) -> Array:
        """Centres of the holes, (count, 2), mm."""
        along = self.middle + self.pitch * (np.arange(self.count) - 0.5 * (self.count - 1))
        return np.stack((np.full(self.count, self.height), along), axis=-1)

    @property
    def reach(self) -> tuple[float, float]:
        return self.height - 0.5 * self.diameter, self.height + 0.5 * self.diameter

    @property
    def outlines(self) -> tuple[ClosedLine, ...]:
        return tuple((PlaneArc.circle(0.5 * self.diameter, centre),) for centre in self.centres)


@dataclass(frozen=True)
class Spokes:
    """Spokes of constant width, and the openings between them; lengths in mm."""

    #: number of spokes
    count: int
    #: width of a spoke
    width: float
    #: inner diameter of the openings
    inner: float
    #: outer diameter of the openings
    outer: float
    #: radius of their corners
    corner: float
    #: polar angle of the middle of the first spoke, rad
    start: float = 0.0
    #: openings go through the body
    depth: None = None
    #: region of the walls
    region: Region = Region.SPOKE

    @property
    def reach(self) -> tuple[float, float]:
        return 0.5 * self.inner, 0.5 * self.outer

    @property
    def corners(self) -> Array:
        """Centres (2, 2) of the corner roundings at the inner and the outer diameter, beside a spoke along +x; NaN if
        there is no room.
        """
        across = 0.5 * self.width + self.corner
        away = np.array([0.5 * self.inner + self.corner, 0.5 * self.outer - self.corner])
        with np.errstate(invalid="ignore"):
            return np.stack((np.sqrt(away**2 - across**2), np.full(2, across)), axis=-1)

    @property
    def fits(self) -> bool:
        """True if the opening between two spokes has room for all its corners."""
        angles = np.arctan2(self.corners[:, 1], self.corners[:, 0])
        straight = bool(self.corners[1, 0] > self.corners[0, 0] and 0.5 * self.outer > self.corner)
        return straight and bool((angles < np.pi / self.count).all())

    @property
    def outlines(self) -> tuple[ClosedLine, ...]:
        (xi, y), (xo, _) = self.corners
        between, r, foot = 2.0 * np.pi / self.count, self.corner, 0.5 * self.width
        inner, outer = np.arctan2(y, xi), np.arctan2(y, xo)
        near = PlaneLine(np.array([xi, foot]), np.array([xo, foot]))
        # the other side: reflected in the line half way between both spokes
        mirror = np.array([(np.cos(between), np.sin(between)), (np.sin(between), -np.cos(between))])
        far = PlaneLine(mirror @ near.end, mirror @ near.start)
        rim = PlaneArc(np.zeros(2), 0.5 * self.outer, outer, between - 2.0 * outer)
        hub = PlaneArc(np.zeros(2), 0.5 * self.inner, between - inner, 2.0 * inner - between)
        curves: list[PlaneCurve] = [near, rim, far, hub]
        if r > 0.0:
            low, high = np.array([xi, y]), np.array([xo, y])
            quarter = 0.5 * np.pi
            curves = [
                near,
                PlaneArc(high, r, -quarter, quarter + outer),
                rim,
                PlaneArc(mirror @ high, r, between - outer, quarter + outer),
                far,
                PlaneArc(mirror @ low, r, between + quarter, quarter - inner),
                hub,
                PlaneArc(low, r, inner + np.pi, quarter - inner),
            ]
        return tuple(tuple(curve.turn(self.start + k * between) for curve in curves) for k in range(self.count))


@dataclass(frozen=True)
class Opening:
    """Prism along the axis, cut out of a body; lengths in mm."""

    #: region of the walls
    region: Region
    #: outline, counterclockwise
    curves: ClosedLine
    #: smaller z
    low: float
    #: larger z
    high: float
    #: smallest and largest radius
    reach: tuple[float, float]
    #: z at which the opening ends; None if it goes through the body
    floor: float | None = None


@dataclass(frozen=True)
class BodyFeatures:
    """Features of a body beside its web and bore."""

    #: keyway in the bore
    keyway: Slot | None = None
    #: hub on the heel side
    hub: Boss | None = None
    #: holes that lighten the body
    holes: Drilling | None = None
    #: hub on the toe side
    toe_hub: Boss | None = None
    #: steps of the shaft on the toe side, from the body outwards
    toe_shaft: tuple[TurnedStep, ...] = ()
    #: steps of the shaft on the heel side, from the body outwards
    heel_shaft: tuple[TurnedStep, ...] = ()
    #: steps of the bore on the toe side, from its end inwards
    toe_bore: tuple[TurnedStep, ...] = ()
    #: steps of the bore on the heel side, from its end inwards
    heel_bore: tuple[TurnedStep, ...] = ()
    #: bolt holes
    bolts: Drilling | None = None
    #: spokes and the openings between them
    spokes: Spokes | None = None
    #: bolt holes of a bar
    row: HoleRow | None = None
    #: form of a bore that is neither round nor has a keyway
    bore: BoreForm | None = None

    @property
    def bore_form(self) -> BoreForm | None:
        """Form of the bore, keyways included; None if it is round."""
        return self.bore if self.keyway is None else self.keyway

    @property
    def patterns(self) -> tuple[Pattern, ...]:
        """Openings that are cut beside the bore."""
        return tuple(pattern for pattern in (self.holes, self.bolts, self.spokes, self.row) if pattern is not None)

    @property
    def is_cut(self) -> bool:
        """True if a feature is no body of revolution."""
        return self.bore_form is not None or bool(self.patterns)

    @property
    def uncut(self) -> BodyFeatures:
        """The turned features."""
        return replace(self.with_round_bore, holes=None, bolts=None, spokes=None, row=None)

    @property
    def with_round_bore(self) -> BodyFeatures:
        """The features without keyway or other form of the bore."""
        return replace(self, keyway=None, bore=None)

    def without(self, pattern: Pattern) -> BodyFeatures:
        """Return the features without one of their `patterns`."""
        return replace(
            self,
            holes=None if self.holes is pattern else self.holes,
            bolts=None if self.bolts is pattern else self.bolts,
            spokes=None if self.spokes is pattern else self.spokes,
            row=None if self.row is pattern else self.row,
        )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the features that are present."""
        turned = {
            "hub": self.hub or self.toe_hub,
            "shaft": self.toe_shaft or self.heel_shaft,
            "bore steps": self.toe_bore or self.heel_bore,
        }
        return (*(name for name, feature in turned.items() if feature), *self.cut_regions)

    @property
    def cut_regions(self) -> dict[str, Region]:
        """Region of the walls of each feature that is cut along the axis, by its name."""
        form = {} if self.bore_form is None else {self.bore_form.name: self.bore_form.region}
        named = {"holes": self.holes, "bolt holes": self.bolts or self.row, "spokes": self.spokes}
        return form | {name: pattern.region for name, pattern in named.items() if pattern is not None}

    @property
    def rare_regions(self) -> bool:
        """True if a body with these features has one of FEATURE_REGIONS."""
        steps = (self.toe_shaft, self.heel_shaft, self.toe_bore, self.heel_bore)
        return any(steps) or self.bolts is not None or self.spokes is not None

    def turn(self, plain: Body) -> Body:
        """Return a plain body with hubs, shafts and steps of the bore, or of the outside of a ring."""
        hubs = [() if boss is None else (boss.step,) for boss in (self.toe_hub, self.hub)]
        body = plain.with_steps((*hubs[0], *self.toe_shaft), (*hubs[1], *self.heel_shaft))
        return body.with_stepped_bore(self.toe_bore, self.heel_bore)

    def openings(self, body: Body, flat_ends: bool) -> tuple[Opening, ...]:
        """Return the openings that the features cut out of a turned body; `flat_ends` as in `Body.levels`."""
        made: list[Opening] = []
        for pattern in self.patterns:
            low, high = body.levels(pattern.reach, flat_ends, pattern.depth)
            floor = None if pattern.depth is None else low
            made += [Opening(pattern.region, curves, low, high, pattern.reach, floor) for curves in pattern.outlines]
        return tuple(made)
