r"""Chamfers along end faces as B-spline patches, between the section where the teeth's patches end and the outline of the end face.

    toe side                                            heel side
    outline of the end face   o-----o--o----o           (upside down at the heel)
                              |     | / \   |           one patch for each piece of the strip; if a piece ends in a point,
    section under it          o-----o----o--o           so does its patch

Along the chain, a patch has the knots of the curve at the end of the tooth's patch, so that both share this curve exactly. It has
more knots where the outline needs them. From toe to heel, a chamfer between plane stations is straight; chamfers on cones and
cylinders and all roundings are quintics. All patches of a strip have the same knots from toe to heel, so they share the curves
between them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gearmesh.cad.brep import LEVEL_TOLERANCE_MM, MIN_LINK_WIDTH_MM, TOLERANCE_SHARE, Piece, SplineTooth, StripPatch
from gearmesh.cad.nodes import MAX_NODES, SPLINE_DEGREE, warp
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.numeric.splines import SplineCurve, control_net, tensor_product
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.records import dataclass
from gearmesh.teeth.end_strip import EndStrip, StripPiece

#: places of a span at which a patch is measured
PLACES_PER_SPAN = 6
#: largest number of rounds of halving spans
MAX_HALVINGS = 12
#: largest number of spans from outline to section
MAX_SPANS = 8


def with_strips(teeth: SplineTooth, tolerance: float) -> SplineTooth:
    """Add the patches of the chamfers at both ends to a tooth, within `tolerance` (mm).

    Raises TrimError if the chamfers have no room, NoSolutionError if the tolerance is not met.
    """
    toe, heel = (
        () if strip is None else _patches(teeth, strip, end, tolerance)
        for end, strip in enumerate(teeth.tooth.end_strips)
    )
    return replace(teeth, strips=(toe, heel))


def _patches(teeth: SplineTooth, strip: EndStrip, end: int, tolerance: float) -> tuple[StripPatch, ...]:
    """Return the patches of the chamfer at the toe (0) or heel (1)."""
    patches, column = list[StripPatch](), 0
    numbers: dict[Piece | None, int] = {link: k for k, link in enumerate(teeth.links)}
    fits = [_PieceFit.of(teeth, strip, piece, end, tolerance) for piece in strip.pieces]
    lines = _lines(fits)
    for fit in fits:
        number = numbers.get(fit.link)
        column = column if number is None else number
        if number is None and fit.is_point:
            continue
        net, knots, miss = fit.fit(lines)
        patches.append(StripPatch(net, knots, lines, end, number, column, fit.piece.point is not None, miss))
        column += number is not None
    return tuple(patches)


@dataclass(frozen=True)
class _PieceFit:
    """Fit of the patch of a piece of a strip."""

    #: faces of the tooth
    teeth: SplineTooth
    #: strip along the end face
    strip: EndStrip
    #: piece of the strip
    piece: StripPiece
    #: 0 at the toe, 1 at the heel
    end: int
    #: allowed deviation, mm
    tolerance: float
    #: link of the tooth under the piece, None at a corner
    link: Piece | None
    #: curve at the end of the tooth's patch, None without a patch
    curve: SplineCurve | None
    #: function from the curve's parameter to sigma of the piece
    own: Callable[[Array], Array]
    #: last parameter of the curve: 1, or the angle (rad) of an arc
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
            # the border of a land or root is an arc
            width = abs(teeth.arc_width(teeth.links.index(link), -end))
            return replace(made, own=lambda y: y / width, last=width)
        patch, bend = patches[-end], patches[-end].s.bend
        curve = SplineCurve(patch.s_knots, patch.control[:, -end], SPLINE_DEGREE)
        return replace(made, curve=curve, own=lambda y: warp(y, bend))

    @property
    def is_point(self) -> bool:
        """True if the piece has no width in the section and in the outline."""
        points = self._at(np.linspace(0.0, self.last, PLACES_PER_SPAN), np.array([0.0, 1.0]))
        return bool(np.linalg.norm(np.diff(points, axis=0), axis=-1).sum(axis=0).max() <= MIN_LINK_WIDTH_MM)

    def _at(self, y: Array, tau: Array) -> Array:
        """Return exact points (y.size, tau.size, 3), mm; tau goes from the outline (0) to the section (1)."""
        sigma = self.own(y)[:, None]
        return self.strip.at(self.piece, sigma, np.broadcast_to(tau, (y.size, tau.size)))

    def _control_net(self, knots: Array, lines: Array) -> Array:
        """Return the control net (S, T, 3), mm, through exact points, and through the tooth's patch on the section."""
        s, t = _nodes(knots), _nodes(lines)
        exact = self._at(s, t)
        if self.curve is not None:
            exact[:, -1] = self.curve(s)
        return control_net((s, t), exact, (knots, lines))

    def fit(self, lines: Array) -> tuple[Array, Array, float]:
        """Return the control net (S, T, 3), mm, from outline to section, the knots along the chain, and the deviation (mm)."""
        knots = self._clamped_knots(np.array([0.0, self.last])) if self.curve is None else self.curve.knots
        tau = _places(lines)
        for _ in range(MAX_HALVINGS):
            net = self._control_net(knots, lines)
            y = _places(knots)
            drawn = tensor_product((knots, lines), net, (y, tau))
            miss = np.linalg.norm(drawn - self._at(y, tau), axis=-1)
            excess = np.maximum(miss.max(axis=1) / (TOLERANCE_SHARE * self.tolerance), self._off(drawn, miss))
            worst = np.maximum.reduceat(excess[:-1], np.arange(0, y.size - 1, PLACES_PER_SPAN))
            if worst.max() <= 1.0:
                return net, knots, float(miss.max())
            spans = distinct(knots)
            if spans.size > MAX_NODES:
                break
            knots = np.sort(np.concatenate((knots, (0.5 * (spans[1:] + spans[:-1]))[worst > 1.0])))
        raise NoSolutionError(
            reason=f"a B-spline face of the chamfer of an end face deviates by {1e3 * miss.max():.3g} um, more than the "
            f"tolerance of {1e3 * self.tolerance:g} um allows; choose a larger tolerance"
        )

    def _off(self, drawn: Array, miss: Array) -> Array:
        """Return distances (Y,) of drawn points (Y, T, 3) on the outline from the end face, over the allowed distance.

        They include the distances of points on the section from the arc of a land or root.
        """
        blank = self.teeth.tooth.blank
        off = np.abs(blank.axial.value(drawn[:, 0]) - blank.faces[self.end])
        if self.link is not None and self.curve is None:
            off = np.maximum(off, miss[:, -1])
        return np.asarray(off / LEVEL_TOLERANCE_MM)

    def across(self, lines: Array) -> float:
        """Return the deviation (mm) of curves from outline to section."""
        y, tau = np.linspace(0.0, self.last, 2 * PLACES_PER_SPAN), _places(lines)
        nodes = _nodes(lines)
        exact = self._at(y, nodes).swapaxes(0, 1)
        drawn = SplineCurve.through(nodes, exact, _degree(lines), lines)(tau).swapaxes(0, 1)
        return float(np.linalg.norm(drawn - self._at(y, tau), axis=-1).max())

    @staticmethod
    def _clamped_knots(spans: Array, degree: int = SPLINE_DEGREE) -> Array:
        return np.concatenate((np.repeat(spans[0], degree), spans, np.repeat(spans[-1], degree)))


def _lines(fits: list[_PieceFit]) -> Array:
    """Return the knots from outline (0) to section (1) of all pieces of a strip."""
    axial = fits[0].teeth.tooth.blank.axial
    if station_normal(axial)[0] == 0.0 and not fits[0].strip.chamfer.rounded:
        return _PieceFit._clamped_knots(np.array([0.0, 1.0]), 1)
    spans, tolerance = 1, fits[0].tolerance
    lines = _PieceFit._clamped_knots(np.linspace(0.0, 1.0, spans + 1))
    while spans < MAX_SPANS and max(fit.across(lines) for fit in fits) > 0.5 * TOLERANCE_SHARE * tolerance:
        spans *= 2
        lines = _PieceFit._clamped_knots(np.linspace(0.0, 1.0, spans + 1))
    return lines


def _degree(knots: Array) -> int:
    """Return the degree of a clamped spline with these knots."""
    return int((knots == knots[0]).sum()) - 1


def _nodes(knots: Array) -> Array:
    """Return the interpolation nodes of a spline: means of neighbouring knots (Greville points), stable for any knots."""
    degree = _degree(knots)
    nodes = np.array([knots[k + 1 : k + degree + 1].mean() for k in range(len(knots) - degree - 1)])
    nodes[0], nodes[-1] = knots[0], knots[-1]
    return nodes


def _places(knots: Array) -> Array:
    """Return the measured places: PLACES_PER_SPAN in each span, and the end."""
    spans = distinct(knots)
    return np.append(
        (spans[:-1, None] + np.diff(spans)[:, None] * np.arange(PLACES_PER_SPAN) / PLACES_PER_SPAN).ravel(), spans[-1]
    )
