r"""Ball-end cutters, and the largest ball that fits into a space.

               |     |        holder, if there is one: an endless cylinder from the end of the shank on
               '-. .-'
                 | |          shank: a cylinder of the ball's diameter, `length` long beyond the ball's centre
                 | |
        ---.     | |    .---
            \    (c)   /
             \    r   /       c = r + (R + stock) n touches the surface in r; the tip is c - R a, a the unit tool axis
              `--.|.-'

A ball that touches the surface in r, with normal n, and passes through q has the radius |q - r|^2 / (2 n . (q - r)).
The largest ball that touches in r without gouging has the least of these radii over all q of the space. Its radius is
at most 1/k1, with k1 the larger principal curvature in r (the limit of q next to r). The largest cutter has the least
radius over all finished r. In a groove this is the ball that touches both walls; in a fillet it is the fillet's least
radius.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gearmesh.allowed import Allowed
from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import principal, shape_operator, tangent_basis
from gearmesh.kernel.surface.surface import Jet
from gearmesh.lengths import in_mm
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Sections
from gearmesh.toolpath.corners import InnerCorner, largest_between
from gearmesh.toolpath.order import PathOrder
from gearmesh.toolpath.space import CutSpace

#: default length of a shank, in diameters of the ball
DEFAULT_LENGTH_DIAMETERS = 5.0
#: allowed diameters and lengths
SIZE_RANGE_MM = 1e-3, 1e4
#: stations along the face at which balls are tried
STATIONS_ALONG_FACE = 9
#: points across a wall that the ball may touch
TOUCHED_POINTS = 17
#: points across a wall that the ball may hit
HIT_POINTS = 33
#: distances from a station at which walls may be hit, in depths of the space; a ball reaches little farther
HIT_OFFSETS_DEPTHS = np.linspace(-0.6, 0.6, 37)
#: number of the narrowest stations that are refined
REFINED_STATIONS = 2
#: rounds of the refinement
REFINING_ROUNDS = 8
#: points across the window of a round
POINTS_PER_WINDOW = 7
#: factor of the window's size from round to round
WINDOW_SHRINKAGE = 0.36
#: smallest distance between two points of a ball; 1/k1 replaces nearer points
MIN_DISTANCE_MM = 1e-3
#: surfaces with a smaller largest ball meet in a sharp inner corner. There the ball's size is a few MIN_DISTANCE_MM
#: over the sine of the corner's angle
SHARP_CORNER_DIAMETER_MM = 0.02
#: relative excess over the largest ball up to which a ball is accepted
RELATIVE_ROOM = 1e-6


@dataclass(frozen=True)
class ToolCylinder:
    """Cylindrical part of a cutter, mm: its radius, and its lowest and highest height over the ball's centre."""

    radius: float
    low: float
    high: float


@dataclass(frozen=True)
class BallCutter:
    """Ball-end cutter; lengths in mm."""

    #: diameter of ball and shank
    diameter: float
    #: length of the shank beyond the ball's centre
    length: float
    #: diameter of the holder, None without a holder
    holder: float | None = None

    @property
    def radius(self) -> float:
        return 0.5 * self.diameter

    @property
    def cylinders(self) -> tuple[ToolCylinder, ...]:
        """The shank, and the holder if there is one."""
        shank = ToolCylinder(self.radius, 0.0, self.length)
        return (shank,) if self.holder is None else (shank, ToolCylinder(0.5 * self.holder, self.length, np.inf))

    @property
    def text(self) -> str:
        """The cutter as the user writes it."""
        return f"ball:{self.diameter:g},{self.length:g}" + ("" if self.holder is None else f",{self.holder:g}")

    @staticmethod
    def of(text: str) -> BallCutter:
        """Return the cutter of a text "ball:D", "ball:D,L" or "ball:D,L,H". Raises DesignError for any other text."""
        kind, _, sizes = text.partition(":")
        parts = sizes.split(",")
        allowed = "ball:D, ball:D,L or ball:D,L,H, as ball:3mm,40mm,20mm, each from 0.001 to 10000 mm, H more than D"
        refusal = ArgumentError("tool", text[:60], must_be=allowed)
        if kind != "ball" or len(parts) > 3:
            raise refusal
        try:
            diameter, *further = (in_mm("tool", part, *SIZE_RANGE_MM) for part in parts)
        except ArgumentError:
            raise refusal from None
        holder = further[1] if len(further) > 1 else None
        if holder is not None and holder <= diameter:
            raise refusal
        return BallCutter(diameter, further[0] if further else DEFAULT_LENGTH_DIAMETERS * diameter, holder)


@dataclass(frozen=True)
class LargestBall:
    """The largest ball that touches all finished surfaces, and what limits it."""

    #: radius, mm
    radius: float
    #: region that the ball touches at the narrowest place, or the region before the `corner`
    touched: Region
    #: region that the ball hits there; the touched region itself if its curvature is the limit; or the region after the
    #: `corner`
    hit: Region
    #: True if a larger ball would leave too much in the corner between both regions
    corner: bool = False

    @property
    def why(self) -> str:
        """The limit in words."""
        touched, hit = (str(region).replace("_", " ") for region in (self.touched, self.hit))
        if self.corner:
            return f"what it may leave in the sharp inner corner between {touched} and {hit}"
        return f"the least radius of the {touched}" if touched == hit else f"the room between {touched} and {hit}"


#: number of a wall, with the parameters s and t
_Place = tuple[int, float, float]
#: walls by their numbers, each with lines s (S,)
_Lines = list[tuple[int, Array]]


@dataclass(frozen=True)
class _Spots:
    """N points of walls and their jets (N,)."""

    places: list[_Place]
    jet: Jet

    @property
    def bend(self) -> Array:
        """Largest principal curvature (N,), 1/mm; 0 where it is not defined."""
        k1 = principal(shape_operator(self.jet, *tangent_basis(self.jet))).k1
        return np.where(np.isfinite(k1), k1, 0.0)


@dataclass(frozen=True)
class _Narrowest:
    """The smallest ball that touches a wall in one place and passes through another: radius (mm) and both places."""

    radius: float
    places: tuple[_Place, _Place]

    @staticmethod
    def of(touched: _Spots, hit: _Spots, corners: Sequence[InnerCorner]) -> _Narrowest:
        """Return the narrowest ball of all pairs of places, except pairs on both sides of a corner."""
        way = hit.jet.r[None] - touched.jet.r[:, None]
        square, height = dot(way, way), dot(way, touched.jet.n[:, None])
        # radii of the balls through every pair of points, and radii of curvature at the points that are touched
        with np.errstate(divide="ignore", invalid="ignore"):
            apart = (height > 0.0) & (square > MIN_DISTANCE_MM**2) & _beside_no_corner(touched, hit, corners)
            radius = np.where(apart, square / (2.0 * height), np.inf)
            curved = np.where(touched.bend > 0.0, 1.0 / touched.bend, np.inf)
        i, j = np.unravel_index(int(np.argmin(radius)), radius.shape)
        k = int(np.argmin(curved))
        if curved[k] < radius[i, j]:
            return _Narrowest(float(curved[k]), (touched.places[k], touched.places[k]))
        return _Narrowest(float(radius[i, j]), (touched.places[i], hit.places[j]))


def _beside_no_corner(touched: _Spots, hit: _Spots, corners: Sequence[InnerCorner]) -> NDArray[np.bool_]:
    """Return (N, M): False where a place (N,) and a place (M,) are on both sides of a corner."""
    touched_walls, hit_walls = (np.array([k for k, _, _ in spots.places]) for spots in (touched, hit))
    lower_wall = np.minimum(touched_walls[:, None], hit_walls)
    beside: NDArray[np.bool_] = (np.abs(touched_walls[:, None] - hit_walls) == 1) & np.isin(
        lower_wall, [corner.before for corner in corners]
    )
    return ~beside


def largest_ball(
    space: CutSpace, walls: Sequence[int], order: PathOrder, corners: Sequence[InnerCorner] = (), left: float = 0.0
) -> LargestBall:
    """Return the largest ball that finishes some walls of a space without gouging the other walls.

    The ball leaves the stock of the order on the walls and no more than `left` (mm) in sharp inner corners.
    """
    toe, heel = space.tooth.blank.extent
    beside = HIT_OFFSETS_DEPTHS * min(1.0, space.depth / abs(heel - toe))
    # the narrowest pair of places at each station: touched points at the station, hit points around it
    stations = np.linspace(0.0, 1.0, STATIONS_ALONG_FACE)
    ways = [(np.array([t]), np.unique(np.clip(t + beside, 0.0, 1.0))) for t in stations]
    lines = ([(k, np.linspace(0.0, 1.0, TOUCHED_POINTS)) for k in walls], _everywhere(space))
    spots = _at(space, [(line, t) for both in ways for line, t in zip(lines, both, strict=True)])
    by_station = [_Narrowest.of(touched, hit, corners) for touched, hit in zip(spots[::2], spots[1::2], strict=True)]
    by_station.sort(key=lambda pair: pair.radius)
    # refine the narrowest stations within windows of one grid step
    sizes = (
        (1.0 / (TOUCHED_POINTS - 1), 1.0 / (STATIONS_ALONG_FACE - 1)),
        (1.0 / (HIT_POINTS - 1), float(beside[1] - beside[0])),
    )
    narrowest = min(
        (_refine(space, pair, sizes, corners) for pair in by_station[:REFINED_STATIONS]), key=lambda pair: pair.radius
    )
    touched, hit = (space.walls[k].region for k, _, _ in narrowest.places)
    # sharp corners may limit the ball further
    radius, corner = largest_between(space, corners, narrowest.radius, order.stock, left)
    if corner is not None:
        touched, hit = (space.walls[k].region for k in (corner.before, corner.before + 1))
    return LargestBall(radius - order.stock, touched, hit, corner=corner is not None)


def _everywhere(space: CutSpace) -> _Lines:
    """Return lines of all walls that a ball may hit."""
    return [(k, np.linspace(0.0, 1.0, HIT_POINTS)) for k in range(len(space.walls))]


def _refine(
    space: CutSpace,
    pair: _Narrowest,
    sizes: tuple[tuple[float, float], tuple[float, float]],
    corners: Sequence[InnerCorner],
) -> _Narrowest:
    """Return the narrowest ball within windows about the places of `pair`.

    `sizes` holds the windows of the touched and of the hit place, as shares across and along the wall.
    """
    for k in range(REFINING_ROUNDS):
        windows = [_window(place, size, WINDOW_SHRINKAGE**k) for place, size in zip(pair.places, sizes, strict=True)]
        touched, hit = _at(space, windows)
        tried = _Narrowest.of(touched, hit, corners)
        pair = tried if tried.radius < pair.radius else pair
    return pair


def refuse_too_large(ball: BallCutter, largest: LargestBall, order: PathOrder) -> None:
    """Raise DesignError for a ball larger than the largest that fits, or a stock without room for any ball."""
    most = 2.0 * largest.radius
    if most >= SHARP_CORNER_DIAMETER_MM and ball.diameter <= most * (1.0 + RELATIVE_ROOM):
        return
    if most < SHARP_CORNER_DIAMETER_MM <= most + 2.0 * order.stock:
        room = largest.radius + order.stock - 0.5 * SHARP_CORNER_DIAMETER_MM
        raise ArgumentError(
            "stock",
            order.stock,
            unit="mm",
            reason="it leaves no room for a ball",
            allowed=Allowed.at_most(np.floor(1e4 * room) / 1e4, "mm", note=f", by {largest.why}"),
        )
    if most < SHARP_CORNER_DIAMETER_MM:
        raise ArgumentError(
            "tool",
            f"ball:{ball.diameter:g}",
            reason=f"no ball reaches all of it: {largest.why}" + ("" if largest.corner else " is a sharp inner corner"),
            remedy="finish the flanks alone (surfaces: flanks), or round the tip of the tool that generates the teeth",
        )
    if largest.corner:
        raise ArgumentError(
            "tool",
            f"ball:{ball.diameter:g}",
            reason=f"the largest ball has a diameter of {np.floor(1e4 * most) / 1e4:.7g} mm, by {largest.why}",
            remedy="allow a larger scallop, or finish the flanks alone (surfaces: flanks)",
        )
    raise ArgumentError(
        "tool",
        f"ball:{ball.diameter:g}",
        reason=f"the largest ball that fits has a diameter of {np.floor(1e4 * most) / 1e4:.7g} mm, by {largest.why}",
    )


def _window(place: _Place, size: tuple[float, float], share: float) -> tuple[_Lines, Array]:
    """Return lines of a wall and stations about a place."""
    k, *centre = place
    steps = share * np.linspace(-1.0, 1.0, POINTS_PER_WINDOW)
    s, t = (np.unique(np.clip(c + width * steps, 0.0, 1.0)) for c, width in zip(centre, size, strict=True))
    return [(k, s)], t


def _at(space: CutSpace, grids: list[tuple[_Lines, Array]]) -> list[_Spots]:
    """Return the points on lines of walls at stations t (T,), for several such grids."""
    sections = space.tooth.sections(np.concatenate([t for _, t in grids]))
    ends = np.cumsum([t.size for _, t in grids])
    return [
        _spots(space, lines, t, sections[end - t.size : end])
        for (lines, t), end in zip(grids, ends.tolist(), strict=True)
    ]


def _spots(space: CutSpace, lines: _Lines, t: Array, sections: Sections) -> _Spots:
    jets = [space.walls[k].jet(s, sections) for k, s in lines]
    names = ("r", "n", "r_u", "r_v", "n_u", "n_v")
    jet = Jet(*(np.concatenate([getattr(jet, name).reshape(-1, 3) for jet in jets]) for name in names))
    return _Spots([(k, a, b) for k, s in lines for a in s.tolist() for b in t.tolist()], jet)
