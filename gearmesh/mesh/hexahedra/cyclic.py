"""Hexahedra of a sector: the nodes of one cut face are those of the other, turned, in the same order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.lattice import numbers_at
from gearmesh.mesh.hexahedra.hexes import HexMesh

#: largest distance of nodes of both cut faces, turned onto each other, as a share of the largest radius: rounding
ROUNDING_SHARE = 1e-9


def pair_cuts(mesh: HexMesh, turn: Rigid) -> HexMesh:
    """Return the mesh with node k of the set cut_left at the turned place of node k of cut_right.

    Raises DesignError if the cut faces have different nodes.
    """
    first, last = mesh.node_sets["cut_right"], mesh.node_sets["cut_left"]
    wanted = turn.point(mesh.nodes[first])
    nearest = numbers_at(mesh.nodes[last], wanted, ROUNDING_SHARE * float(np.abs(wanted).max()))
    if np.unique(nearest).size < len(last) or nearest.min() < 0:
        raise DesignError("sector", reason="the cut faces of the hexahedra are not alike")
    nodes, partners = mesh.nodes.copy(), last[nearest]
    nodes[partners] = wanted
    return replace(mesh, nodes=nodes, node_sets=mesh.node_sets | {"cut_left": partners})
