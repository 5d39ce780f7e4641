"""A finite-element model as data: bodies of hexahedra, what holds them, what loads them, where they touch.

Units are mm, N, MPa, rad. Whoever writes a deck or runs a solver starts from a `Model`; nothing here knows of gears.
"""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import wrap

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.hertz import Material
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.hexes import HexMesh

#: characters in a line of notes
WIDTH = 76


@dataclass(frozen=True)
class Support:
    """Displacement prescribed on a node set: directions (of 0, 1, 2) and its value, mm."""

    node_set: str
    directions: tuple[int, ...] = (0, 1, 2)
    value: float = 0.0


@dataclass(frozen=True)
class RigidTie:
    """A node set made rigid to a reference node at `point` (3,), mm.

    `motion`: three displacements (mm) and three rotations (rad) about x, y, z that are prescribed, None where free;
    `load`: forces (N) and moments (N mm) in the directions that are free.
    """

    node_set: str
    point: Array
    motion: tuple[float | None, ...] = (0.0, 0.0, 0.0, 0.0, 0.0, None)
    load: tuple[float, ...] = (0.0,) * 6


@dataclass(frozen=True)
class ContactPair:
    """Two face sets that may touch; the slave is the finer one. `stiffness`: pressure over penetration, MPa/mm; `friction`:
    coefficient of Coulomb.
    """

    slave: str
    master: str
    stiffness: float
    friction: float = 0.0


@dataclass(frozen=True)
class NodeForces:
    """Forces (K, 3), N, on nodes (K,) of the mesh, each node once."""

    nodes: NDArray[np.int64]
    forces: Array


@dataclass(frozen=True)
class CyclicSymmetry:
    """The mesh is one of `sectors` alike, which go round the axis through two points, `axis` (2, 3), mm.

    `first`, `last`: sets of nodes and of faces of the two cut faces; node k of `last` is node k of `first`, turned about it by
    360 deg / `sectors`. Supports and loads are those of every sector.
    """

    sectors: int
    first: str
    last: str
    axis: Array


@dataclass(frozen=True)
class Model:
    """Bodies, supports, rigid ties, contacts and forces of one static step. `materials` names an element set each, covering all;
    `notes`: what files say of it at their heads, as what it leaves out."""

    title: str
    mesh: HexMesh
    materials: dict[str, Material]
    supports: tuple[Support, ...] = ()
    ties: tuple[RigidTie, ...] = ()
    contacts: tuple[ContactPair, ...] = ()
    forces: tuple[NodeForces, ...] = ()
    cyclic: CyclicSymmetry | None = None
    notes: tuple[str, ...] = ()

    @property
    def note_lines(self) -> list[str]:
        """The notes, as lines at the head of a file."""
        return [line for note in self.notes for line in wrap(note, WIDTH)]
