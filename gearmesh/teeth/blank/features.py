"""Features of a gear body: hubs, shafts, stepped bores, which are turned; keyways, holes, spokes, which are cut along the axis.

What is cut is a prism along the axis, its outline lines and arcs. Angles in rad, lengths in mm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine
from gearmesh.teeth.blank.body import Body, TurnedStep
from gearmesh.teeth.region import Region

#: a closed line of curves, counterclockwise
ClosedLine = tuple[PlaneCurve, ...]


@dataclass(frozen=True)
class Slot:
    """Keyway in the bore, mm: width, and depth beyond the bore's radius."""

    width: float
    depth: float

    def in_bore(self, radius: float) -> ClosedLine:
        """The outline of a bore with the keyway on +x: the arc, and from its end the three lines.

        Parameters
        ----------
        radius : float
            Of the bore, mm.

        Returns
        -------
        tuple of PlaneCurve
            Closed, counterclockwise, in the plane across the axis, mm.

        Examples
        --------
        >>> len(gm.Slot(width=6.0, depth=2.8).in_bore(10.0))
        4
        """
        half, bottom = 0.5 * self.width, radius + self.depth
        first = float(np.arcsin(half / radius))
        near = radius * np.cos(first)
        corners = np.array([(near, -half), (bottom, -half), (bottom, half), (near, half)])
        arc = PlaneArc(np.zeros(2), radius, first, 2.0 * (np.pi - first))
        return arc, *(PlaneLine(corners[k], corners[k + 1]) for k in range(3))

    def reach(self, radius: float) -> float:
        """How far from the axis its corners are.

        Parameters
        ----------
        radius : float
            Of the bore, mm.

        Returns
        -------
        float
            mm.

        Examples
        --------
        >>> round(gm.Slot(width=6.0, depth=2.8).reach(10.0), 3)
        13.147
        """
        return float(np.hypot(radius + self.depth, 0.5 * self.width))


@dataclass(frozen=True)
class Boss:
    """Hub: a cylinder on an end face, mm."""

    diameter: float
    length: float

    @property
    def step(self) -> TurnedStep:
        """It as a step on the end face of a body."""
        return TurnedStep(0.5 * self.diameter, 0.5 * self.diameter, self.length, Region.HUB)


class Pattern(Protocol):
    """Openings of the same shape, evenly spaced round the axis, or along a bar."""

    @property
    def region(self) -> Region:
        """Region of their walls."""

    @property
    def depth(self) -> float | None:
        """Depth (mm) from the heel's face, None of what goes through."""

    @property
    def count(self) -> int:
        """How many there are."""

    @property
    def reach(self) -> tuple[float, float]:
        """Radii (mm) between which they are, or heights over a bar's reference plane."""

    @property
    def outlines(self) -> tuple[ClosedLine, ...]:
        """One for each."""


@dataclass(frozen=True)
class Drilling:
    """Holes along the axis, evenly spaced, the first at the polar angle `start`: their number, diameter, and the circle through
    their centres, mm."""

    count: int
    diameter: float
    circle: float
    start: float = 0.0
    depth: float | None = None
    region: Region = Region.HOLE

    @property
    def centres(self) -> Array:
        """Where they are, (count, 2), mm."""
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
    """Bolt holes across a bar: their number, diameter, distance from one to the next, `height` of their centres over the reference
    plane, and y of the middle of the row, mm."""

    count: int
    diameter: float
    pitch: float
    height: float
    middle: float
    depth: float | None = None
    region: Region = Region.BOLT

    @property
    def centres(self) -> Array:
        """Where they are, (count, 2), mm."""
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
    """Spokes of constant width, the middle of the first at the polar angle `start`, and the openings between them, mm.

    Openings lie between the diameters `inner` and `outer`; their corners have the radius `corner`.
    """

    count: int
    width: float
    inner: float
    outer: float
    corner: float
    start: float = 0.0
    depth: None = None
    region: Region = Region.SPOKE

    @property
    def reach(self) -> tuple[float, float]:
        return 0.5 * self.inner, 0.5 * self.outer

    @property
    def corners(self) -> Array:
        """Centres (2, 2) of the roundings at the inner and the outer diameter, beside a spoke along +x; NaN where
        it has no room."""
        across = 0.5 * self.width + self.corner
        away = np.array([0.5 * self.inner + self.corner, 0.5 * self.outer - self.corner])
        with np.errstate(invalid="ignore"):
            return np.stack((np.sqrt(away**2 - across**2), np.full(2, across)), axis=-1)

    @property
    def fits(self) -> bool:
        """Whether there is an opening between two spokes, with all of its corners."""
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
    """A prism along the axis, cut out of a body between two z, `low` and `high`, mm; it ends in a `floor` at one of them, or goes
    through."""

    region: Region
    curves: ClosedLine
    low: float
    high: float
    reach: tuple[float, float]
    floor: float | None = None


@dataclass(frozen=True)
class BodyFeatures:
    """What a body has beside its web and bore. Steps are in order: of shafts from the body outwards, of bores from their ends
    inwards. `row`: the bolt holes of a bar."""

    keyway: Slot | None = None
    hub: Boss | None = None
    holes: Drilling | None = None
    toe_hub: Boss | None = None
    toe_shaft: tuple[TurnedStep, ...] = ()
    heel_shaft: tuple[TurnedStep, ...] = ()
    toe_bore: tuple[TurnedStep, ...] = ()
    heel_bore: tuple[TurnedStep, ...] = ()
    bolts: Drilling | None = None
    spokes: Spokes | None = None
    row: HoleRow | None = None

    @property
    def patterns(self) -> tuple[Pattern, ...]:
        """What is cut beside the bore."""
        return tuple(pattern for pattern in (self.holes, self.bolts, self.spokes, self.row) if pattern is not None)

    @property
    def is_cut(self) -> bool:
        """Whether anything is that is no body of revolution."""
        return self.keyway is not None or bool(self.patterns)

    @property
    def uncut(self) -> BodyFeatures:
        """What of them is turned."""
        return replace(self, keyway=None, holes=None, bolts=None, spokes=None, row=None)

    def without(self, pattern: Pattern) -> BodyFeatures:
        """The same but for one of the patterns.

        Parameters
        ----------
        pattern : Pattern
            One of `patterns`.

        Returns
        -------
        BodyFeatures
            What is left.

        Examples
        --------
        >>> holes = gm.Drilling(count=4, diameter=3.0, circle=20.0)
        >>> gm.BodyFeatures(holes=holes).without(holes).is_cut
        False
        """
        return replace(
            self,
            holes=None if self.holes is pattern else self.holes,
            bolts=None if self.bolts is pattern else self.bolts,
            spokes=None if self.spokes is pattern else self.spokes,
            row=None if self.row is pattern else self.row,
        )

    @property
    def names(self) -> tuple[str, ...]:
        """What of them there is, in words."""
        has = {
            "hub": self.hub or self.toe_hub,
            "shaft": self.toe_shaft or self.heel_shaft,
            "bore steps": self.toe_bore or self.heel_bore,
            "keyway": self.keyway,
            "holes": self.holes,
            "bolt holes": self.bolts or self.row,
            "spokes": self.spokes,
        }
        return tuple(name for name, there in has.items() if there)

    @property
    def rare_regions(self) -> bool:
        """Whether a body with them has one of FEATURE_REGIONS."""
        steps = (self.toe_shaft, self.heel_shaft, self.toe_bore, self.heel_bore)
        return any(steps) or self.bolts is not None or self.spokes is not None

    def turn(self, plain: Body) -> Body:
        """A body with hubs, shafts and steps of the bore, or of the outside of a ring.

        Parameters
        ----------
        plain : Body
            The body without them.

        Returns
        -------
        Body
            With them.

        Examples
        --------
        >>> body = gears.members["pinion"].tooth.blank.body
        >>> gm.BodyFeatures().turn(body).profile == body.profile
        True
        """
        hubs = [() if boss is None else (boss.step,) for boss in (self.toe_hub, self.hub)]
        body = plain.with_steps((*hubs[0], *self.toe_shaft), (*hubs[1], *self.heel_shaft))
        return body.with_stepped_bore(self.toe_bore, self.heel_bore)

    def openings(self, body: Body, flat_ends: bool) -> tuple[Opening, ...]:
        """Where they are cut out of a turned body.

        Parameters
        ----------
        body : Body
            The turned body.
        flat_ends : bool
            Whether its end faces are planes, as `Body.levels` has it.

        Returns
        -------
        tuple of Opening
            One for each opening.

        Examples
        --------
        >>> gm.BodyFeatures().openings(gears.members["pinion"].tooth.blank.body, True)
        ()
        """
        made: list[Opening] = []
        for pattern in self.patterns:
            low, high = body.levels(pattern.reach, flat_ends, pattern.depth)
            floor = None if pattern.depth is None else low
            made += [Opening(pattern.region, curves, low, high, pattern.reach, floor) for curves in pattern.outlines]
        return tuple(made)
