"""A finite-element model as data: bodies of hexahedra with supports, loads and contacts.

Units are mm, N, MPa, rad. Writers of decks and solvers start from a `Model`; this module does not know gears.
"""

from __future__ import annotations

from textwrap import wrap

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.hertz import Material
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.records import dataclass

#: characters in a line of notes
NOTE_WIDTH = 76


@dataclass(frozen=True)
class Support:
    """Displacement prescribed on a node set."""

    #: name of the node set
    node_set: str
    #: directions x, y, z as 0, 1, 2
    directions: tuple[int, ...] = (0, 1, 2)
    #: displacement, mm
    value: float = 0.0


@dataclass(frozen=True)
class RigidTie:
    """A node set that moves as a rigid body with a reference node."""

    #: name of the node set
    node_set: str
    #: position (3,) of the reference node, mm
    point: Array
    #: prescribed displacements (mm) along x, y, z and rotations (rad) about them; None where free
    motion: tuple[float | None, ...] = (0.0, 0.0, 0.0, 0.0, 0.0, None)
    #: forces (N) and moments (N mm) in the free directions
    load: tuple[float, ...] = (0.0,) * 6

    @property
    def is_loaded(self) -> bool:
        """True if a force or moment acts in a free direction."""
        return any(motion is None and load for motion, load in zip(self.motion, self.load, strict=True))


@dataclass(frozen=True)
class ContactPair:
    """Two face sets that may touch."""

    #: face set with the finer mesh
    slave: str
    #: other face set
    master: str
    #: pressure over penetration, MPa/mm
    stiffness: float
    #: coefficient of Coulomb friction
    friction: float = 0.0


@dataclass(frozen=True)
class NodeForces:
    """Forces (K, 3), N, on nodes (K,) of the mesh; each node occurs once."""

    nodes: NDArray[np.int64]
    forces: Array


@dataclass(frozen=True)
class CyclicSymmetry:
    """Symmetry of a mesh that is one of several equal sectors around an axis.

    Supports and loads act on every sector.
    """

    #: number of sectors in a full turn
    sectors: int
    #: name of the node set and face set of the first cut face
    first: str
    #: name of the sets of the last cut face; its node k is node k of `first`, rotated by 360 deg / `sectors`
    last: str
    #: two points (2, 3), mm, on the axis
    axis: Array


@dataclass(frozen=True)
class Model:
    """Bodies, supports, rigid ties, contacts and forces of one static step."""

    #: title of the model
    title: str
    #: mesh of all bodies
    mesh: HexMesh
    #: material of each element set; the sets cover all elements
    materials: dict[str, Material]
    #: prescribed displacements
    supports: tuple[Support, ...] = ()
    #: rigid ties
    ties: tuple[RigidTie, ...] = ()
    #: contact pairs
    contacts: tuple[ContactPair, ...] = ()
    #: forces on nodes
    forces: tuple[NodeForces, ...] = ()
    #: cyclic symmetry, if the mesh is a sector
    cyclic: CyclicSymmetry | None = None
    #: remarks at the head of files, such as the parts that are not modelled
    notes: tuple[str, ...] = ()

    @property
    def is_loaded(self) -> bool:
        """True if a force, a moment or a prescribed motion other than 0 acts."""
        moved = any(support.value for support in self.supports) or any(any(tie.motion) for tie in self.ties)
        return moved or bool(self.forces) or any(tie.is_loaded for tie in self.ties)

    @property
    def note_lines(self) -> list[str]:
        """Notes as lines for the head of a file."""
        return [line for note in self.notes for line in wrap(note, NOTE_WIDTH)]
