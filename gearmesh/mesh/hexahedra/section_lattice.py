"""Quadrilaterals in the sections of a tooth with its share of the rim: exact nodes outside, interpolated ones inside.

Each half of a tooth is two blocks, lines s along the outline and lines d into the material:

              land
          +---------+ C            `upper`: flank (and broken edge) x half the tooth's thickness
    flank |  upper  |
          |         |              `lower`: middle of the root land to the form point x depth of the rim; its side at the
        J +---------+ M                     joint goes J - M - K, so that the lines d turn round the fillet
    cut  /          |
    +---   lower    |
    |               |
    +---------------+ K
        rim, inner face

Interior nodes come from transfinite interpolation in a conformal chart of the section, in which radial cuts and arcs
round the axis are straight lines; sections of constant station are planes, cones or cylinders.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.mesh.hexahedra.layers import Chart, Layers
from gearmesh.teeth.region import EDGES, FILLETS, FLANKS, Region, Side

#: how far up from the root land towards the form point the lines J - M and M - K meet on the middle of the tooth
MEETING = 0.35
#: least width of the root land, over an even share of its cells, on which these stay
LEAST_ROOT = 0.4
#: steps of regula falsi, the first of which halves the interval, towards the place halfway along an edge: within 2 % of its length
HALVING_STEPS = 3
#: points at which the lengths of the outline's links are measured
LENGTH_SAMPLES = 65


def transfinite(low_s: Array, high_s: Array, low_d: Array, high_d: Array) -> Array:
    """Nodes (S, D, ..., 2) of a block between its four sides, each interpolated by its own arc length.

    `low_s`, `high_s` (D, ..., 2): the sides at the first and last line s; `low_d`, `high_d` (S, ..., 2): at the first and
    last line d. Corners must agree.
    """
    xi_low, xi_high = fractions(low_d)[:, None], fractions(high_d)[:, None]
    eta_low, eta_high = fractions(low_s)[None], fractions(high_s)[None]
    # straight lines in the unit square between the places on opposite sides
    xi = (xi_low + eta_low * (xi_high - xi_low)) / (1.0 - (eta_high - eta_low) * (xi_high - xi_low))
    eta = eta_low + xi * (eta_high - eta_low)
    xi, eta = xi[..., None], eta[..., None]
    sides = (1.0 - xi) * low_s[None] + xi * high_s[None] + (1.0 - eta) * low_d[:, None] + eta * high_d[:, None]
    corners = (1.0 - xi) * ((1.0 - eta) * low_d[0] + eta * high_d[0]) + xi * (
        (1.0 - eta) * low_d[-1] + eta * high_d[-1]
    )
    nodes: Array = sides - corners
    return nodes


def fractions(line: Array) -> Array:
    """Arc length from the first point over the whole (S, ...) of polylines (S, ..., 2)."""
    steps = np.sqrt((np.diff(line, axis=0) ** 2).sum(axis=-1))
    length = np.concatenate((np.zeros((1, *steps.shape[1:])), np.cumsum(steps, axis=0)))
    shares: Array = length / length[-1]
    return shares


@dataclass(frozen=True)
class Lines:
    """Where the lines of the lattice run: places from 0 to 1 along each side of the blocks.

    `root`: cells from the middle of the root land to the form point; `flank` (F + 1,) or (F + 1, T): places from form point to tip;
    `edge`: cells on a broken tip edge; `thickness` (D + 1,): places from flank to middle; `rim` (R + 1,): from there inwards;
    `land`: what the length of the root land counts beside that of the fillet where `root` cells are shared out. `halved`: every
    other line is of mid-side nodes, which on flanks lie as far from one corner of their edge as from the other.
    """

    root: int
    flank: Array
    edge: int
    thickness: Array
    rim: Array
    land: float = 1.0
    halved: bool = False


@dataclass(frozen=True)
class HalfLattice:
    """Nodes of one half of a tooth: `lower` (L + 1, N + 1, T, 3) and `upper` (U + 1, D + 1, T, 3), lines s by lines d.

    Line L of `lower` is, up to line D, the first of `upper`. `root_cells` (L,): outer face on the root land, not the fillet.
    """

    lower: Array
    upper: Array
    root_cells: NDArray[np.bool_]


def tooth_lattice(layers: Layers, lines: Lines, chart: Chart, inner: Array) -> tuple[HalfLattice, HalfLattice]:
    """Nodes of the right and of the left half of a tooth; `inner` (T,): height u of the rim's inner face."""
    outlines = [_outline(layers, side, lines) for side in Side]
    low, flank, land = ([chart.to_chart(getattr(o, name)) for o in outlines] for name in ("low", "flank", "land"))
    bottom, root = chart.depth(inner), 0.5 * (low[0][0, :, 0] + low[1][0, :, 0])
    meeting, centre = 0.5 * (low[0][-1] + low[1][-1]), 0.5 * (low[0][0, :, 1] + low[1][0, :, 1])
    meeting[:, 0] = root + MEETING * (meeting[:, 0] - root)
    down = _straight(meeting, np.stack((bottom, centre), -1), lines.rim)
    across = [_straight(side[-1], meeting, lines.thickness) for side in low]
    inwards = [np.concatenate((line, down[1:])) for line in across]
    # what neighbouring halves share is spaced by the mean of both
    middle = _straight(meeting, land[0][-1], 0.5 * (fractions(flank[0]) + fractions(flank[1])))
    places = 0.5 * (fractions(inwards[0]) + fractions(inwards[1]))
    halves = []
    for k, outline in enumerate(outlines):
        cut = _straight(low[k][0], np.stack((bottom, low[k][0, :, 1]), -1), places)
        arc = _straight(cut[-1], inwards[k][-1], np.linspace(0.0, 1.0, lines.root + 1))
        lower = chart.from_chart(transfinite(cut, inwards[k], low[k], arc))
        upper = chart.from_chart(transfinite(across[k], land[k], flank[k], middle))
        halves.append(HalfLattice(lower, upper, outline.root_cells))
    return halves[0], halves[1]


@dataclass(frozen=True)
class _Outline:
    """One half of a tooth's outline: exact points (..., T, 3) from cut to form point, to the tip, to the middle of the land."""

    low: Array
    flank: Array
    land: Array
    root_cells: NDArray[np.bool_]


def _outline(layers: Layers, side: Side, lines: Lines) -> _Outline:
    links = _Links(layers, side)
    low, root_cells = links.from_cut_to_form_point(lines.root, lines.land, 2 if lines.halved else 1)
    places = links.halve(FLANKS[side], lines.flank) if lines.halved else lines.flank
    flank = links.points(FLANKS[side], places)
    if layers.tooth.tip_edge is not None:
        flank = np.concatenate((flank, links.points(EDGES[side], np.linspace(0.0, 1.0, lines.edge + 1))[1:]))
    return _Outline(low, flank, links.points(Region.LAND, lines.thickness), root_cells)


class _Links:
    """The links of one side of a tooth's outline with every link running from the cut towards the land."""

    def __init__(self, layers: Layers, side: Side) -> None:
        self._layers, self._side = layers, side

    def points(self, region: Region, s: Array) -> Array:
        """Exact points (S, T, 3) at s (S,) or (S, T); halves of root and land count to their middles."""
        right = self._side is Side.RIGHT
        if region in (Region.ROOT, Region.LAND):
            place = 0.5 * s + 0.5 if region is Region.ROOT else 0.5 * s
            points = self._layers.grid(region, place if right else 1.0 - place).points
            return self._layers.step.point(points) if region is Region.ROOT and not right else points
        return self._layers.grid(region, s if right else 1.0 - s).points

    def halve(self, region: Region, s: Array) -> Array:
        """Places (2 F + 1, T) of which every other one is halfway between its neighbours by distance; s (2 F + 1,) or (2 F + 1, T).

        Halfway in s is not: where a flank ends near its singular point its length grows with the square of s, and a mid-side node
        at a quarter of its edge makes the element singular.
        """
        first, last = self.points(region, s[:-2:2]), self.points(region, s[2::2])
        shape = first.shape[:-1]
        low, middle, high = (
            np.broadcast_to(part if s.ndim > 1 else part[:, None], shape) for part in (s[:-2:2], s[1::2], s[2::2])
        )
        length = np.sqrt(dot(last - first, last - first))
        nearer, farther = -length, length
        for _ in range(HALVING_STEPS):
            there = self.points(region, middle)
            beyond = np.sqrt(dot(there - first, there - first)) - np.sqrt(dot(last - there, last - there))
            before = beyond < 0.0
            low, nearer = np.where(before, middle, low), np.where(before, beyond, nearer)
            high, farther = np.where(before, high, middle), np.where(before, farther, beyond)
            middle = low + (high - low) * nearer / (nearer - farther)
        places = np.empty((len(s), *shape[1:]))
        places[::2], places[1::2] = s[::2] if s.ndim > 1 else s[::2, None], middle
        return places

    def from_cut_to_form_point(self, cells: int, land: float, step: int) -> tuple[Array, NDArray[np.bool_]]:
        """Nodes (cells + 1, T, 3) over root land and fillet, and which cells lie on the root land.

        The cells, `step` to an element, are shared out by the mean lengths of both, of the root land `land` times it, evenly spaced
        on either.
        Where the root land narrows to less than `LEAST_ROOT` of its cells' even share, they reach over to the fillet.
        """
        s = np.linspace(0.0, 1.0, LENGTH_SAMPLES)
        fillet = FILLETS[self._side]
        samples = np.concatenate((self.points(Region.ROOT, s), self.points(fillet, s)[1:]))
        steps = np.sqrt((np.diff(samples, axis=0) ** 2).sum(axis=-1))
        length = np.concatenate((np.zeros((1, steps.shape[1])), np.cumsum(steps, axis=0)))
        root, whole = length[LENGTH_SAMPLES - 1], length[-1]
        part = land * root / (land * root + whole - root)
        # lines of corners, not of mid-side nodes, lie between root land and fillet
        elements = cells // step
        on_root = step * int(np.clip(np.round(elements * part.mean()), 1, elements - 1))
        change = np.maximum(root, LEAST_ROOT * whole * on_root / cells)
        wanted = np.concatenate(
            (
                change * np.linspace(0.0, 1.0, on_root + 1)[:-1, None],
                change + (whole - change) * np.linspace(0.0, 1.0, cells - on_root + 1)[:, None],
            )
        )
        # 0 .. 1 over the root land, 1 .. 2 over the fillet
        places = np.linspace(0.0, 2.0, 2 * LENGTH_SAMPLES - 1)
        nodes = np.stack([np.interp(w, at, places) for w, at in zip(wanted.T, length.T, strict=True)], axis=-1)
        points = np.where(
            (nodes <= 1.0)[..., None],
            self.points(Region.ROOT, np.clip(nodes, 0.0, 1.0)),
            self.points(fillet, np.clip(nodes - 1.0, 0.0, 1.0)),
        )
        return points, np.arange(cells) < on_root


def _straight(first: Array, last: Array, places: Array) -> Array:
    """Points (S, T, 2) from first to last (T, 2) at places (S,) or (S, T)."""
    places = places[:, None] if places.ndim == 1 else places
    return first + places[..., None] * (last - first)
