"""Surfaces of broken tip edges, drawn or generated: what touches the mating gear beyond the tip form point."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, cross
from gearmesh.kernel.surface.surface import Surface
from gearmesh.kernel.surface.tabulated import TabulatedSurface, nodes_across
from gearmesh.teeth.region import EDGES, Side
from gearmesh.teeth.section import Grid
from gearmesh.teeth.tooth import Tooth

#: sections in each smooth stretch of the face through which a drawn edge's surface goes
SECTIONS_PER_STRETCH = 33
#: sine of the angle up to which two surfaces pass smoothly into each other
SMOOTH_ANGLE_SINE = 1e-6


def tip_edge_surface(tooth: Tooth, which: Side) -> Surface | None:
    """Surface of a side's tip chamfer or rounding, None where the tip is sharp.

    Of a generated one the tool's envelope with its own parameters. Of a drawn one parameters (s, z): s from 0 at the flank to 1 at
    the land, and the station coordinate, mm; it goes through exact sections.
    """
    link = tooth.chain.get(EDGES[which])
    if link is None or link.surface is not None:
        return None if link is None else link.surface
    t = np.array([np.linspace(low, high, SECTIONS_PER_STRETCH) for low, high in pairwise(tooth.smooth_stretches)])
    s = nodes_across()
    grid = link.grid(s if which is Side.RIGHT else 1.0 - s, tooth.sections(t.ravel()))
    points, normals = (vectors.reshape(len(s), *t.shape, 3) for vectors in (grid.points, grid.normals))
    stations = tooth.stations(t.ravel()).reshape(t.shape)
    if stations[0, 0] > stations[-1, -1]:
        points, normals, stations = points[:, ::-1, ::-1], normals[:, ::-1, ::-1], stations[::-1, ::-1]
    return TabulatedSurface.through(points, stations, normals)


def tip_edge_grid(tooth: Tooth, which: Side, s: Array) -> Grid | None:
    """Points of a side's tip edge at shares s (S,) of the way from the flank to the land, ascending, and at the tooth's even
    stations, with the parameters of its surface; None where the tip is sharp."""
    surface, link = tip_edge_surface(tooth, which), tooth.chain.get(EDGES[which])
    if surface is None or link is None:
        return None
    if link.surface is not None:
        return link.grid(s if which is Side.RIGHT else 1.0 - s, tooth.even)
    p, v = np.broadcast_arrays(s[:, None], tooth.even.stations)
    jet = surface.jet(p, v)
    return Grid(jet.r, jet.n, jet, p, v)


def is_tangent(first: Array, second: Array) -> bool:
    """True where two surfaces have the same normals (N, 3) at all of the points that they share."""
    apart = np.linalg.norm(cross(first, second), axis=-1)
    return bool((apart < SMOOTH_ANGLE_SINE).all())
