r"""The chamfers along end faces as B-spline patches: between the tooth's section, where the teeth's patches end, and the outline.

    toe side                                            heel side
    outline of the end face   o-----o--o----o           (at the heel the other way round)
                              |     | / \   |           one patch a piece of the strip; where a piece ends in a point,
    section under it          o-----o----o--o           so does its patch

Along the chain a patch has the knots of the curve in which the tooth's own patch ends, which it has in common with it exactly,
and more of them where the outline needs them. From toe to heel a chamfer is straight between plane stations; it is a quintic on
cones and cylinders, and so is a rounding; its knots all patches of a strip have in common, and so the curves between them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gearmesh.cad.brep import NARROWEST, ON_LEVEL, SHARE, Piece, SplineTooth, StripPatch
from gearmesh.cad.nodes import DEGREE, MOST, warp
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import SplineCurve, control_net, tensor_product
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.teeth.end_strip import EndStrip, StripPiece

#: places in every span of a patch where it is measured, and in every second of which it is drawn first
PLACES = 6
#: rounds of halving spans, and most spans from outline to section
ROUNDS, SPANS = 12, 8


def with_strips(teeth: SplineTooth, tolerance: float) -> SplineTooth:
    """The tooth with the patches of the chamfers at its ends, within `tolerance` (mm) of them.

    Raises TrimError where they have no room, NoSolutionError where the tolerance is not met.
    """
    toe, heel = (
        () if strip is None else _patches(teeth, strip, end, tolerance)
        for end, strip in enumerate(teeth.tooth.end_strips)
    )
    return replace(teeth, strips=(toe, heel))


def _patches(teeth: SplineTooth, strip: EndStrip, end: int, tolerance: float) -> tuple[StripPatch, ...]:
    """Of the chamfer at the toe (0) or the heel (1)."""
    patches, column = list[StripPatch](), 0
    numbers: dict[Piece | None, int] = {link: k for k, link in enumerate(teeth.links)}
    fits = [_PieceFit.of(teeth, strip, piece, end, tolerance) for piece in strip.pieces]
    lines = _lines(fits)
    for one in fits:
        number = numbers.get(one.link)
        column = column if number is None else number
        if number is None and one.is_point:
            continue
        net, knots, miss = one.fit(lines)
        patches.append(StripPatch(net, knots, lines, end, number, column, one.piece.point is not None, miss))
        column += number is not None
    return tuple(patches)


@dataclass(frozen=True)
class _PieceFit:
    """A piece of a strip, and what its patch ends in on the section: a curve of the tooth's patch, or none.

    `own` takes the curve's parameter to the piece's sigma; `last`: the parameter's end, 1 or the angle (rad) of an arc.
    """

    teeth: SplineTooth
    strip: EndStrip
    piece: StripPiece
    end: int
    tolerance: float
    link: Piece | None
    curve: SplineCurve | None
    own: Callable[[Array], Array]
    last: float

    @staticmethod
    def of(teeth: SplineTooth, strip: EndStrip, piece: StripPiece, end: int, tolerance: float) -> _PieceFit:
        low, high = piece.inner
        link = None if low == high else Piece(piece.region, low, high)
        made = _PieceFit(teeth, strip, piece, end, tolerance, link, None, lambda y: y, 1.0)
        if link is None or link not in teeth.links:
            return replace(made, link=None)
        patches = teeth.patches.get(link)
        if patches is None:
            # of a land or root, which is turned: its border is an arc
            width = abs(teeth.arc_width(teeth.links.index(link), -end))
            return replace(made, own=lambda y: y / width, last=width)
        patch, bend = patches[-end], patches[-end].s.bend
        curve = SplineCurve(patch.s_knots, patch.control[:, -end], DEGREE)
        return replace(made, curve=curve, own=lambda y: warp(y, bend))

    @property
    def is_point(self) -> bool:
        """Whether it has no width, neither in the section nor in the outline."""
        points = self._at(np.linspace(0.0, self.last, PLACES), np.array([0.0, 1.0]))
        return bool(np.linalg.norm(np.diff(points, axis=0), axis=-1).sum(axis=0).max() <= NARROWEST)

    def _at(self, y: Array, tau: Array) -> Array:
        """Exact points (y.size, tau.size, 3), tau from the outline to the section."""
        sigma = self.own(y)[:, None]
        return self.strip.at(self.piece, sigma, np.broadcast_to(tau, (y.size, tau.size)))

    def _control_net(self, knots: Array, lines: Array) -> Array:
        """Control net (S, T, 3) of the spline through exact points, on the section through those of the tooth's patch."""
        s, t = _nodes(knots), _nodes(lines)
        exact = self._at(s, t)
        if self.curve is not None:
            exact[:, -1] = self.curve(s)
        return control_net((s, t), exact, (knots, lines))

    def fit(self, lines: Array) -> tuple[Array, Array, float]:
        """Control net (S, T, 3) from the outline to the section, knots along the chain, and the deviation (mm)."""
        knots = self._clamped_knots(np.array([0.0, self.last])) if self.curve is None else self.curve.knots
        tau = _places(lines)
        for _ in range(ROUNDS):
            net = self._control_net(knots, lines)
            y = _places(knots)
            drawn = tensor_product((knots, lines), net, (y, tau))
            miss = np.linalg.norm(drawn - self._at(y, tau), axis=-1)
            excess = np.maximum(miss.max(axis=1) / (SHARE * self.tolerance), self._off(drawn, miss))
            worst = np.maximum.reduceat(excess[:-1], np.arange(0, y.size - 1, PLACES))
            if worst.max() <= 1.0:
                return net, knots, float(miss.max())
            spans = np.unique(knots)
            if spans.size > MOST:
                break
            knots = np.sort(np.concatenate((knots, (0.5 * (spans[1:] + spans[:-1]))[worst > 1.0])))
        raise NoSolutionError(
            reason=f"a B-spline face of the chamfer of an end face deviates by {1e3 * miss.max():.3g} um, more than the "
            f"tolerance of {1e3 * self.tolerance:g} um allows; choose a larger tolerance"
        )

    def _off(self, drawn: Array, miss: Array) -> Array:
        """How far (Y,) points (Y, T, 3) of the outline are from the end face, and of the section from an arc, as multiples of what
        is allowed."""
        blank = self.teeth.tooth.blank
        off = np.abs(blank.axial.value(drawn[:, 0]) - blank.faces[self.end])
        if self.link is not None and self.curve is None:
            off = np.maximum(off, miss[:, -1])
        return np.asarray(off / ON_LEVEL)

    def across(self, lines: Array) -> float:
        """How far (mm) curves from outline to section are from exact ones."""
        y, tau = np.linspace(0.0, self.last, 2 * PLACES), _places(lines)
        nodes = _nodes(lines)
        exact = self._at(y, nodes).swapaxes(0, 1)
        drawn = SplineCurve.through(nodes, exact, _degree(lines), lines)(tau).swapaxes(0, 1)
        return float(np.linalg.norm(drawn - self._at(y, tau), axis=-1).max())

    @staticmethod
    def _clamped_knots(spans: Array, degree: int = DEGREE) -> Array:
        return np.concatenate((np.repeat(spans[0], degree), spans, np.repeat(spans[-1], degree)))


def _lines(fits: list[_PieceFit]) -> Array:
    """Knots from outline (0) to section (1) that all pieces of a strip have in common."""
    axial = fits[0].teeth.tooth.blank.axial
    if station_normal(axial)[0] == 0.0 and not fits[0].strip.chamfer.rounded:
        return _PieceFit._clamped_knots(np.array([0.0, 1.0]), 1)
    spans, tolerance = 1, fits[0].tolerance
    lines = _PieceFit._clamped_knots(np.linspace(0.0, 1.0, spans + 1))
    while spans < SPANS and max(one.across(lines) for one in fits) > 0.5 * SHARE * tolerance:
        spans *= 2
        lines = _PieceFit._clamped_knots(np.linspace(0.0, 1.0, spans + 1))
    return lines


def _degree(knots: Array) -> int:
    """Of a clamped spline with these knots."""
    return int((knots == knots[0]).sum()) - 1


def _nodes(knots: Array) -> Array:
    """Where a spline with these knots is interpolated: its own centres of gravity, which is stable for any knots."""
    degree = _degree(knots)
    nodes = np.array([knots[k + 1 : k + degree + 1].mean() for k in range(len(knots) - degree - 1)])
    nodes[0], nodes[-1] = knots[0], knots[-1]
    return nodes


def _places(knots: Array) -> Array:
    """PLACES in each of the spans, and the end."""
    spans = np.unique(knots)
    return np.append((spans[:-1, None] + np.diff(spans)[:, None] * np.arange(PLACES) / PLACES).ravel(), spans[-1])
