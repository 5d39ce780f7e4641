"""Surfaces of drawn tip edges: chamfers and roundings that touch the mating gear beyond the tip form point."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.tabulated import TabulatedSurface, nodes_across
from gearmesh.teeth.region import Side
from gearmesh.teeth.section import DrawnLink, Sections

#: sections in each smooth stretch of the face that the surface of a drawn edge interpolates
SECTIONS_PER_STRETCH = 33


def drawn_edge_surface(
    link: DrawnLink, sections_at: Callable[[Array], Sections], smooth_stretches: tuple[float, ...]
) -> TabulatedSurface:
    """Return the surface through exact sections of a drawn edge; parameters s from 0 at the flank to 1 at the land, and
    z in mm.

    `link`: the edge in the chain of the tooth's sections. `sections_at`: gives the tooth's sections at t (T,) from 0
    at the toe to 1 at the heel. `smooth_stretches`: t between which the tooth is smooth along the face, from 0 to 1.
    """
    t = np.array([np.linspace(low, high, SECTIONS_PER_STRETCH) for low, high in pairwise(smooth_stretches)])
    s, sections = nodes_across(), sections_at(t.ravel())
    grid = link.grid(s if link.side is Side.RIGHT else 1.0 - s, sections)
    points, normals = (vectors.reshape(len(s), *t.shape, 3) for vectors in (grid.points, grid.normals))
    stations = sections.stations.reshape(t.shape)
    if stations[0, 0] > stations[-1, -1]:
        points, normals, stations = points[:, ::-1, ::-1], normals[:, ::-1, ::-1], stations[::-1, ::-1]
    return TabulatedSurface.through(points, stations, normals)
