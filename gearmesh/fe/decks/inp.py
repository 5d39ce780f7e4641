"""Input decks for CalculiX and Abaqus: one linear-elastic static step with contact.

Nodes and elements are numbered index + 1; the reference nodes of rigid ties follow the mesh's nodes, in the same block:
of several blocks meshio keeps the last.

What was tried with ccx 2.20 on a ball (R 10 mm, a 0.208 mm, 1500 MPa by Hertz) pressed on a block, a/h elements over
the contact radius, before it became the default here:

- Start. Contact elements arise only where the clearance is below 1/K, 1e-7 mm: bodies that just touch have none, and a
  body that nothing but contact holds then never finds equilibrium (400 s of cutbacks on 3800 nodes). With the bodies
  overlapping by a share of the Hertz approach a torque or a force converges in one increment; iterations by share:
  0.01: 19, 0.03: 14, 0.1: 10, 0.3: 7, 0.5: 4, 1: 7, 2: 10, 3: 12. The end does not depend on it (the sum of overlap and
  rotation to 3e-5). A rotation prescribed from touching takes 8; a step of rotation before one of torque 8 + 4. A spring
  to ground stiff enough to help took half of the load.
- Stiffness. Peak at a/h = 3 (a lever) by K/E: 10: 1348, 50: 1478, 200: 1616, 1000: 2829 MPa; at a/h = 8: 50: 1464, 200:
  1495 MPa. The penalty lowers the peak by about 0.25 E / (K a), K h > 10 E makes it ripple.
- Discretisation. Node to surface gives the same peak (1462 MPa) but no totals of the contact forces.
- Elements. C3D8 gives the same peak (1465 MPa) and is too stiff in bending; C3D20R with a/h = 4 gives 1466 MPa in twice
  the time of C3D8I with a/h = 8.
- Large displacements change the rotation by 0.7 % and are neglected: Hertz, and the bending of teeth, are linear theory.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.fe.decks.registry import register
from gearmesh.fe.model import ContactPair, CyclicSymmetry, Model, NodeForces, RigidTie
from gearmesh.io.atomic import whole_file
from gearmesh.io.rows import lines
from gearmesh.mesh.hexahedra.hexes import HexMesh

#: stick slope over contact stiffness: traction over the slip before Coulomb's limit, of CalculiX
STICK_RATIO = 0.1
#: nodes up to which a model without contact is solved directly, in some 2 GB
LARGEST_DIRECT = 60_000

# CalculiX reads 20 characters a field and 16 fields a line, Abaqus no fewer.
_NUMBER = "%.12e"
_FIELDS = 16


@dataclass(frozen=True)
class _Dialect:
    """What the two programs want differently.

    `rotation_node`: moments and rotations of a rigid body are the forces and displacements of a second reference node
    (CalculiX), not degrees of freedom 4 to 6 of the first.
    """

    rotation_node: bool
    tie: str
    friction: str
    requests: str


_CALCULIX = _Dialect(
    rotation_node=True,
    tie="*RIGID BODY, NSET={set}, REF NODE={reference}, ROT NODE={rotation}",
    friction="*FRICTION\n{coefficient:.12g}, {slope:.12g}\n",
    requests="*NODE FILE\nU\n*EL FILE\nS\n",
)
_ABAQUS = _Dialect(
    rotation_node=False,
    tie="*RIGID BODY, REF NODE={reference}, TIE NSET={set}",
    friction="*FRICTION\n{coefficient:.12g}\n",
    requests="*OUTPUT, FIELD\n*NODE OUTPUT\nU, RF\n*ELEMENT OUTPUT\nS\n*CONTACT OUTPUT\nCDISP, CSTRESS, CFORCE\n",
)


def reference_nodes(model: Model, rotation_node: bool = True) -> list[tuple[int, int]]:
    """Numbers of the reference node and of the node that holds its rotations, for each rigid tie.

    Both are the same node unless `rotation_node` (CalculiX).
    """
    first = len(model.mesh.nodes) + 1
    if rotation_node:
        return [(first + 2 * i, first + 2 * i + 1) for i in range(len(model.ties))]
    return [(first + i, first + i) for i in range(len(model.ties))]


def write_calculix(model: Model, path: Path) -> None:
    """Write the deck that ccx solves."""
    _write(model, path, _CALCULIX)


def write_abaqus(model: Model, path: Path) -> None:
    """Write the same model for Abaqus."""
    _write(model, path, _ABAQUS)


def _write(model: Model, path: Path, dialect: _Dialect) -> None:
    with whole_file(path) as temporary, open(temporary, "w", encoding="utf-8", newline="\n") as file:
        file.writelines(_deck(model, dialect))


def _deck(model: Model, dialect: _Dialect) -> Iterator[str]:
    yield f"*HEADING\n{' '.join(model.title.split())}\n** mm, N, MPa\n"
    yield from (f"** {line}\n" for line in model.note_lines)
    nodes = reference_nodes(model, dialect.rotation_node)
    yield from _nodes(model, nodes)
    yield from _mesh(model.mesh)
    for name, material in model.materials.items():
        yield f"*MATERIAL, NAME={name}\n*ELASTIC\n{material.youngs_modulus:.12g}, {material.poisson_ratio:.12g}\n"
        yield f"*SOLID SECTION, ELSET={name}, MATERIAL={name}\n"
    for tie, pair in zip(model.ties, nodes, strict=True):
        yield from _tie(tie, pair, dialect)
    for i, contact in enumerate(model.contacts, 1):
        yield from _contact(contact, f"contact_{i}", dialect)
    if model.cyclic is not None:
        yield from _cyclic(model.cyclic)
    solver = f", SOLVER={_solver(model)}" if dialect is _CALCULIX else ""
    yield f"*STEP\n*STATIC{solver}\n1., 1.\n"
    for support in model.supports:
        yield "*BOUNDARY\n"
        yield from (f"{support.node_set}, {d + 1}, {d + 1}, {support.value:.12g}\n" for d in support.directions)
    for tie, pair in zip(model.ties, nodes, strict=True):
        yield from _drive(tie, pair)
    for forces in model.forces:
        yield from _forces(forces)
    yield dialect.requests
    yield from _calculix_prints(model) if dialect is _CALCULIX else ()
    yield "*END STEP\n"


def _solver(model: Model) -> str:
    """ccx's solver: iterative with contact, direct without as far as memory allows.

    The iterative one stops at a residual that the iterations for contact correct (same pressure to five digits,
    11,664 nodes: 19 s, directly 38 s; 87,000 nodes: 326 s and 1 GB, directly 560 s and 6 GB); alone it left the rotation of
    a bent bar wrong by 5e-5 with C3D8I, by 2e-3 with C3D20R. Friction makes the matrix unsymmetric, which the iterative
    one takes for symmetric: a tooth pair that SPOOLES solves goes on for ever with it.
    """
    if any(contact.friction for contact in model.contacts):
        return "SPOOLES"
    direct = not model.contacts and len(model.mesh.nodes) <= LARGEST_DIRECT
    return "SPOOLES" if direct else "ITERATIVE CHOLESKY"


def _nodes(model: Model, references: list[tuple[int, int]]) -> Iterator[str]:
    """All nodes in one block, the set all_nodes of those of the mesh."""
    count = len(model.mesh.nodes)
    line = f"%d, {_NUMBER}, {_NUMBER}, {_NUMBER}\n"
    yield "*NODE\n"
    # float64 holds node numbers exactly, and %d prints them without a point
    yield from lines(line, np.column_stack([np.arange(1, count + 1), model.mesh.nodes]))
    for tie, pair in zip(model.ties, references, strict=True):
        yield from (line % (number, *tie.point) for number in dict.fromkeys(pair))
    yield f"*NSET, NSET=all_nodes, GENERATE\n1, {count}, 1\n"


def _mesh(mesh: HexMesh) -> Iterator[str]:
    yield f"*ELEMENT, TYPE={'C3D20R' if mesh.second_order else 'C3D8I'}, ELSET=all_elements\n"
    table = np.column_stack([np.arange(1, len(mesh.elements) + 1), mesh.elements + 1])
    first, rest = table.shape[1], 0
    if first > _FIELDS:
        first, rest = _FIELDS, table.shape[1] - _FIELDS
    template = ", ".join(["%d"] * first) + (",\n" + ", ".join(["%d"] * rest) if rest else "") + "\n"
    yield from lines(template, table)
    for name, nodes in mesh.node_sets.items():
        yield f"*NSET, NSET={name}\n"
        yield from _numbers(nodes)
    for name, elements in mesh.element_sets.items():
        yield f"*ELSET, ELSET={name}\n"
        yield from _numbers(elements)
    for name, faces in mesh.face_sets.items():
        yield f"*SURFACE, NAME={name}, TYPE=ELEMENT\n"
        yield from lines("%d, S%d\n", faces + 1)


def _numbers(indices: NDArray[np.int64]) -> Iterator[str]:
    """Numbers of a set, 16 a line."""
    whole = len(indices) // _FIELDS * _FIELDS
    yield from lines(", ".join(["%d"] * _FIELDS) + "\n", indices[:whole].reshape(-1, _FIELDS) + 1)
    if whole < len(indices):
        yield ", ".join(str(i + 1) for i in indices[whole:].tolist()) + "\n"


def _tie(tie: RigidTie, nodes: tuple[int, int], dialect: _Dialect) -> Iterator[str]:
    reference, rotation = nodes
    yield f"*NSET, NSET={tie.node_set}_reference\n{reference}\n"
    if dialect.rotation_node:
        yield f"*NSET, NSET={tie.node_set}_rotation\n{rotation}\n"
    yield dialect.tie.format(set=tie.node_set, reference=reference, rotation=rotation) + "\n"


def _contact(contact: ContactPair, name: str, dialect: _Dialect) -> Iterator[str]:
    yield f"*SURFACE INTERACTION, NAME={name}\n"
    yield f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{contact.stiffness:.12g}\n"
    if contact.friction:
        yield dialect.friction.format(coefficient=contact.friction, slope=STICK_RATIO * contact.stiffness)
    yield f"*CONTACT PAIR, INTERACTION={name}, TYPE=SURFACE TO SURFACE\n{contact.slave}, {contact.master}\n"


def _cyclic(cyclic: CyclicSymmetry) -> Iterator[str]:
    """The cut faces tied to each other: nodes of the last one follow those of the first, which are the same, turned."""
    tie = f"{cyclic.first}_{cyclic.last}"
    yield f"** node k of the set {cyclic.last} is node k of {cyclic.first}, turned by 360 deg / {cyclic.sectors}\n"
    yield f"*TIE, CYCLIC SYMMETRY, NAME={tie}\n{cyclic.last}, {cyclic.first}\n"
    yield f"*CYCLIC SYMMETRY MODEL, N={cyclic.sectors}, TIE={tie}\n"
    yield ", ".join(_NUMBER % x for x in cyclic.axis.ravel()) + "\n"


def _drive(tie: RigidTie, nodes: tuple[int, int]) -> Iterator[str]:
    """What is prescribed at a reference node, and what loads it where it is free."""
    reference, rotation = nodes
    offset = 1 if rotation != reference else 4
    places = [(reference, 1 + i) for i in range(3)] + [(rotation, offset + i) for i in range(3)]
    for place, motion, load in zip(places, tie.motion, tie.load, strict=True):
        node, direction = place
        if motion is not None:
            yield f"*BOUNDARY\n{node}, {direction}, {direction}, {motion:.12g}\n"
        elif load:
            yield f"*CLOAD\n{node}, {direction}, {load:.12g}\n"


def _forces(forces: NodeForces) -> Iterator[str]:
    yield "*CLOAD\n"
    count = len(forces.nodes)
    table = np.column_stack([np.repeat(forces.nodes + 1, 3), np.tile([1, 2, 3], count), forces.forces.ravel()])
    yield from lines(f"%d, %d, {_NUMBER}\n", table)


def _calculix_prints(model: Model) -> Iterator[str]:
    """Contact results on the nodes, and totals as text: of reference nodes and of contact pairs."""
    for tie in model.ties:
        for part in ("reference", "rotation"):
            yield f"*NODE PRINT, NSET={tie.node_set}_{part}\nU, RF\n"
    if model.contacts:
        yield "*CONTACT FILE\nCDIS, CSTR\n"
    for contact in model.contacts:
        yield f"*CONTACT PRINT, SLAVE={contact.slave}, MASTER={contact.master}\nCF\n"


register("calculix", ".inp", "CalculiX deck: mesh, sets, contact, one static step, output requests", write_calculix)
register("abaqus", ".inp", "Abaqus deck of the same model", write_abaqus)
