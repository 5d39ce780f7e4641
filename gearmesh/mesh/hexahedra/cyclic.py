"""Hexahedra of a sector: both cut faces with the same nodes, turned, in the same order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.mesh.hexahedra.hexes import HexMesh

#: share of the largest radius by which nodes of both cut faces, turned onto each other, may be apart: rounding
ALIKE = 1e-9


def pair_cuts(mesh: HexMesh, turn: Rigid) -> HexMesh:
    """The mesh with node k of its set cut_left where node k of cut_right is, turned.

    Raises DesignError where no node is there.
    """
    from scipy.spatial import cKDTree

    first, last = mesh.node_sets["cut_right"], mesh.node_sets["cut_left"]
    wanted = turn.point(mesh.nodes[first])
    distance, nearest = cKDTree(mesh.nodes[last]).query(wanted)
    if np.unique(nearest).size < len(last) or distance.max() > ALIKE * np.abs(wanted).max():
        raise DesignError("sector", reason="the cut faces of the hexahedra are not alike")
    nodes, partners = mesh.nodes.copy(), last[nearest]
    nodes[partners] = wanted
    return replace(mesh, nodes=nodes, node_sets=mesh.node_sets | {"cut_left": partners})
