r"""Ball-end cutters, and the largest that fits into a space.

               |     |        holder, if there is one: a cylinder from the end of the shank on, without end
               '-. .-'
                 | |          shank: a cylinder of the ball's diameter, `length` long beyond the ball's centre
                 | |
        ---.     | |    .---
            \    (c)   /
             \    r   /       c = r + (R + stock) n touches the surface in r; the tip is at c - R a, a the unit tool axis
              `--.|.-'

A ball that touches in r, with normal n, and passes through q has the radius |q - r|^2 / (2 n . (q - r)). The least of these
over all q
of the space, and 1/k1 of the larger principal curvature in r (q next to r), is the radius of the largest ball that touches in r
without gouging; the least over all r that are finished is that of the largest cutter. In a groove it is the ball that touches both
walls, in a fillet its least radius.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import principal, shape_operator, tangent_basis
from gearmesh.kernel.surface.surface import Jet
from gearmesh.lengths import in_mm
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Sections
from gearmesh.toolpath.corners import InnerCorner, largest_between
from gearmesh.toolpath.space import CutSpace

#: length (diameters) of a shank that is not given
LENGTH = 5.0
#: least and largest diameter and length, mm
SIZES = 1e-3, 1e4
#: stations along the face, and points across a wall where it is touched, and where it may be hit
STATIONS, TOUCHED, HIT = 9, 17, 33
#: places on either side of a station where walls may be hit, as a share of the depth of the space: a ball reaches not much farther
BESIDE = np.linspace(-0.6, 0.6, 37)
#: how many of the narrowest places are refined; rounds, points of each, and by how much the window shrinks
PLACES, ROUNDS, WINDOW, SHRINK = 2, 8, 7, 0.36
#: distance (mm) below which two points are one: 1/k1 has the limit
SAME = 1e-3
#: diameter (mm) of the largest ball below which two surfaces meet in a sharp inner corner: it is then a few SAME over the sine
#: of the corner's angle
SHARP = 0.02
#: a ball is refused where it is larger than the largest by more than this share of it
ROOM = 1e-6


@dataclass(frozen=True)
class ToolCylinder:
    """A part of a cutter, mm: radius, and heights over the ball's centre between which it is."""

    radius: float
    low: float
    high: float


@dataclass(frozen=True)
class BallCutter:
    """Ball-end cutter, mm: diameter of ball and shank, length of the shank beyond the ball's centre, and diameter of the holder."""

    diameter: float
    length: float
    holder: float | None = None

    @property
    def radius(self) -> float:
        return 0.5 * self.diameter

    @property
    def cylinders(self) -> tuple[ToolCylinder, ...]:
        """The shank, and the holder."""
        shank = ToolCylinder(self.radius, 0.0, self.length)
        return (shank,) if self.holder is None else (shank, ToolCylinder(0.5 * self.holder, self.length, np.inf))

    @property
    def text(self) -> str:
        """As it is asked for."""
        return f"ball:{self.diameter:g},{self.length:g}" + ("" if self.holder is None else f",{self.holder:g}")

    @staticmethod
    def of(text: str) -> BallCutter:
        """The cutter that "ball:D", "ball:D,L" or "ball:D,L,H" says. Raises DesignError for another text."""
        kind, _, sizes = text.partition(":")
        parts = sizes.split(",")
        allowed = "ball:D, ball:D,L or ball:D,L,H, as ball:3mm,40mm,20mm, each from 0.001 to 10000 mm, H more than D"
        refusal = ArgumentError("tool", text[:60], must_be=allowed)
        if kind != "ball" or len(parts) > 3:
            raise refusal
        try:
            diameter, *further = (in_mm("tool", part, *SIZES) for part in parts)
        except ArgumentError:
            raise refusal from None
        holder = further[1] if len(further) > 1 else None
        if holder is not None and holder <= diameter:
            raise refusal
        return BallCutter(diameter, further[0] if further else LENGTH * diameter, holder)


@dataclass(frozen=True)
class LargestBall:
    """Radius (mm) of the largest ball that touches all that is finished, the region in which it touches where it is narrowest, and
    what it hits there: another region, or the same one, where the surface is too much curved; or the regions beside the `corner`
    in which a larger one would leave too much."""

    radius: float
    touched: Region
    hit: Region
    corner: bool = False

    @property
    def why(self) -> str:
        """What limits it, in words."""
        touched, hit = (str(region).replace("_", " ") for region in (self.touched, self.hit))
        if self.corner:
            return f"what it may leave in the sharp inner corner between {touched} and {hit}"
        return f"the least radius of the {touched}" if touched == hit else f"the room between {touched} and {hit}"


#: number of a wall, s and t
_Place = tuple[int, float, float]
#: lines s (S,) of walls by their numbers
_Lines = list[tuple[int, Array]]


@dataclass(frozen=True)
class _Spots:
    """Places (N) and their jets (N,)."""

    places: list[_Place]
    jet: Jet

    @property
    def bend(self) -> Array:
        """Largest principal curvature (N,), 1/mm; 0 where it is not defined."""
        k1 = principal(shape_operator(self.jet, *tangent_basis(self.jet))).k1
        return np.where(np.isfinite(k1), k1, 0.0)


@dataclass(frozen=True)
class _Narrowest:
    """Radius (mm) of the smallest of balls that touch in a place and pass through another, and both places."""

    radius: float
    places: tuple[_Place, _Place]

    @staticmethod
    def of(touched: _Spots, hit: _Spots, corners: Sequence[InnerCorner]) -> _Narrowest:
        """Of all pairs of places but those on both sides of a corner."""
        way = hit.jet.r[None] - touched.jet.r[:, None]
        square, height = dot(way, way), dot(way, touched.jet.n[:, None])
        with np.errstate(divide="ignore", invalid="ignore"):
            apart = (height > 0.0) & (square > SAME**2) & _beside_no_corner(touched, hit, corners)
            radius = np.where(apart, square / (2.0 * height), np.inf)
            curved = np.where(touched.bend > 0.0, 1.0 / touched.bend, np.inf)
        i, j = np.unravel_index(int(np.argmin(radius)), radius.shape)
        k = int(np.argmin(curved))
        if curved[k] < radius[i, j]:
            return _Narrowest(float(curved[k]), (touched.places[k], touched.places[k]))
        return _Narrowest(float(radius[i, j]), (touched.places[i], hit.places[j]))


def _beside_no_corner(touched: _Spots, hit: _Spots, corners: Sequence[InnerCorner]) -> NDArray[np.bool_]:
    """Whether places (N,) and places (M,) are not on both sides of a corner, (N, M)."""
    one, other = (np.array([k for k, _, _ in spots.places]) for spots in (touched, hit))
    first = np.minimum(one[:, None], other)
    beside: NDArray[np.bool_] = (np.abs(one[:, None] - other) == 1) & np.isin(first, [own.before for own in corners])
    return ~beside


def largest_ball(
    space: CutSpace, walls: Sequence[int], stock: float, corners: Sequence[InnerCorner] = (), left: float = 0.0
) -> LargestBall:
    """The largest ball that finishes some walls of a space, with the rest of it in the way, and leaves `stock` (mm), and, in sharp
    inner corners, no more than `left` (mm)."""
    toe, heel = space.tooth.blank.extent
    beside = BESIDE * min(1.0, space.depth / abs(heel - toe))
    stations = np.linspace(0.0, 1.0, STATIONS)
    ways = [(np.array([t]), np.unique(np.clip(t + beside, 0.0, 1.0))) for t in stations]
    lines = ([(k, np.linspace(0.0, 1.0, TOUCHED)) for k in walls], _everywhere(space))
    spots = _at(space, [(line, t) for both in ways for line, t in zip(lines, both, strict=True)])
    by_station = [_Narrowest.of(touched, hit, corners) for touched, hit in zip(spots[::2], spots[1::2], strict=True)]
    by_station.sort(key=lambda pair: pair.radius)
    sizes = (1.0 / (TOUCHED - 1), 1.0 / (STATIONS - 1)), (1.0 / (HIT - 1), float(beside[1] - beside[0]))
    least = min((_refine(space, pair, sizes, corners) for pair in by_station[:PLACES]), key=lambda pair: pair.radius)
    touched, hit = (space.walls[k].region for k, _, _ in least.places)
    radius, corner = largest_between(space, corners, least.radius, stock, left)
    if corner is not None:
        touched, hit = (space.walls[k].region for k in (corner.before, corner.before + 1))
    return LargestBall(radius - stock, touched, hit, corner=corner is not None)


def _everywhere(space: CutSpace) -> _Lines:
    """Lines of all walls where a ball may hit them."""
    return [(k, np.linspace(0.0, 1.0, HIT)) for k in range(len(space.walls))]


def _refine(
    space: CutSpace,
    pair: _Narrowest,
    sizes: tuple[tuple[float, float], tuple[float, float]],
    corners: Sequence[InnerCorner],
) -> _Narrowest:
    """The narrowest ball near one, within windows of `sizes`, shares across the wall and along it, about its places."""
    for k in range(ROUNDS):
        windows = [_window(place, size, SHRINK**k) for place, size in zip(pair.places, sizes, strict=True)]
        touched, hit = _at(space, windows)
        tried = _Narrowest.of(touched, hit, corners)
        pair = tried if tried.radius < pair.radius else pair
    return pair


def refuse_too_large(ball: BallCutter, largest: LargestBall, stock: float) -> None:
    """Raise DesignError for a ball that is larger than the largest that fits, or a stock (mm) that leaves no room for any."""
    most = 2.0 * largest.radius
    if most >= SHARP and ball.diameter <= most * (1.0 + ROOM):
        return
    if most < SHARP <= most + 2.0 * stock:
        room = largest.radius + stock - 0.5 * SHARP
        raise ArgumentError(
            "stock",
            stock,
            unit="mm",
            reason="it leaves no room for a ball",
            allowed=f"at most {np.floor(1e4 * room) / 1e4:.7g} mm, by {largest.why}",
        )
    if most < SHARP:
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
    """Lines of a wall and stations about a place."""
    k, *centre = place
    steps = share * np.linspace(-1.0, 1.0, WINDOW)
    s, t = (np.unique(np.clip(c + width * steps, 0.0, 1.0)) for c, width in zip(centre, size, strict=True))
    return [(k, s)], t


def _at(space: CutSpace, grids: list[tuple[_Lines, Array]]) -> list[_Spots]:
    """Places on lines of walls at stations t (T,), of several such grids."""
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
