"""Input decks for CalculiX and Abaqus: one linear-elastic static step with contact.

Nodes and elements have the numbers index + 1. The reference nodes of rigid ties follow the mesh's nodes, in the same
block, because meshio keeps only the last of several blocks. Large displacements are neglected: Hertz contact and the
bending of teeth are linear theory. Tests behind the choice of elements, contact and initial overlap are in notes.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.fe.decks.fields import T_PER_MM3_OF_KG_PER_M3, one_line
from gearmesh.fe.decks.registry import register
from gearmesh.fe.model import ContactPair, CyclicSymmetry, Model, NodeForces, RigidTie
from gearmesh.formats import INP_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.io.texts import lines
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.records import dataclass

#: stick slope over contact stiffness in CalculiX: traction over slip below Coulomb's limit
STICK_RATIO = 0.1
#: largest number of nodes for the direct solver without contact, in about 2 GB
MAX_DIRECT_NODES = 60_000

#: request of stresses at the integration points of all elements
POINT_STRESSES = "*EL PRINT, ELSET=all_elements\nS\n"

#: format of a number: CalculiX reads 20 characters per field
_NUMBER_FORMAT = "%.12e"
#: fields in a line that CalculiX reads; Abaqus reads no fewer
_FIELDS_PER_LINE = 16


@dataclass(frozen=True)
class _Dialect:
    """Keywords in which the two programs differ."""

    #: True if a second reference node holds moments and rotations of a rigid body (CalculiX), instead of degrees of
    #: freedom 4 to 6 of the first node
    rotation_node: bool
    #: template of a rigid body
    tie: str
    #: template of friction
    friction: str
    #: requests of results
    requests: str
    #: requests of further results as text
    prints: str = ""
    #: procedure of the step; a static one if empty
    step: str = ""


#: keywords of CalculiX
_CALCULIX_DIALECT = _Dialect(
    rotation_node=True,
    tie="*RIGID BODY, NSET={set}, REF NODE={reference}, ROT NODE={rotation}",
    friction="*FRICTION\n{coefficient:.12g}, {slope:.12g}\n",
    requests="*NODE FILE\nU\n*EL FILE\nS\n",
)
#: keywords of Abaqus
_ABAQUS_DIALECT = _Dialect(
    rotation_node=False,
    tie="*RIGID BODY, REF NODE={reference}, TIE NSET={set}",
    friction="*FRICTION\n{coefficient:.12g}\n",
    requests="*OUTPUT, FIELD\n*NODE OUTPUT\nU, RF\n*ELEMENT OUTPUT\nS\n*CONTACT OUTPUT\nCDISP, CSTRESS, CFORCE\n",
)


def reference_nodes(model: Model, rotation_node: bool = True) -> list[tuple[int, int]]:
    """Return the numbers of the reference node, and of the node with its rotations, for each rigid tie.

    Both are the same node without a `rotation_node` (Abaqus).
    """
    first = len(model.mesh.nodes) + 1
    if rotation_node:
        return [(first + 2 * i, first + 2 * i + 1) for i in range(len(model.ties))]
    return [(first + i, first + i) for i in range(len(model.ties))]


def write_calculix(model: Model, path: Path) -> None:
    """Write the deck for ccx."""
    _write(path, _deck(model, _CALCULIX_DIALECT))


def write_solved(model: Model, path: Path) -> None:
    """Write the deck for ccx with stresses at integration points requested too, as text."""
    _write(path, _deck(model, replace(_CALCULIX_DIALECT, prints=POINT_STRESSES)))


def write_abaqus(model: Model, path: Path) -> None:
    """Write the deck of the same model for Abaqus."""
    _write(path, _deck(model, _ABAQUS_DIALECT))


def write_modes(model: Model, path: Path, count: int) -> None:
    """Write the deck for ccx with a step for the lowest natural frequencies instead of loads.

    `count`: number of frequencies.
    """
    unloaded = replace(model, forces=(), ties=tuple(replace(tie, load=(0.0,) * 6) for tie in model.ties))
    dialect = replace(_CALCULIX_DIALECT, step=f"*FREQUENCY\n{count}\n", requests="*NODE FILE\nU\n")
    _write(path, _deck(unloaded, dialect))


def _write(path: Path, deck: Iterator[str]) -> None:
    with whole_file(path) as temporary, open(temporary, "w", encoding="utf-8", newline="\n") as file:
        file.writelines(deck)


def _deck(model: Model, dialect: _Dialect) -> Iterator[str]:
    yield f"*HEADING\n{one_line(model.title)}\n** mm, N, MPa, t\n"
    yield from (f"** {line}\n" for line in model.note_lines)
    nodes = reference_nodes(model, dialect.rotation_node)
    yield from _nodes(model, nodes)
    yield from _mesh(model.mesh)
    for name, material in model.materials.items():
        yield f"*MATERIAL, NAME={name}\n*ELASTIC\n{material.youngs_modulus:.12g}, {material.poisson_ratio:.12g}\n"
        if material.density is not None:
            yield f"*DENSITY\n{T_PER_MM3_OF_KG_PER_M3 * material.density:.12g}\n"
        yield f"*SOLID SECTION, ELSET={name}, MATERIAL={name}\n"
    for tie, pair in zip(model.ties, nodes, strict=True):
        yield from _tie(tie, pair, dialect)
    for i, contact in enumerate(model.contacts, 1):
        yield from _contact(contact, f"contact_{i}", dialect)
    if model.cyclic is not None:
        yield from _cyclic(model.cyclic, dialect)
    solver = f", SOLVER={_solver(model)}" if dialect.rotation_node else ""
    yield "*STEP\n" + (dialect.step or f"*STATIC{solver}\n1., 1.\n")
    for support in model.supports:
        yield "*BOUNDARY\n"
        yield from (f"{support.node_set}, {d + 1}, {d + 1}, {support.value:.12g}\n" for d in support.directions)
    for tie, pair in zip(model.ties, nodes, strict=True):
        yield from _drive(tie, pair)
    for forces in model.forces:
        yield from _forces(forces)
    yield dialect.requests
    yield from _calculix_prints(model) if dialect.rotation_node and not dialect.step else ()
    yield dialect.prints
    yield "*END STEP\n"


def _solver(model: Model) -> str:
    """Return ccx's solver: iterative with contact, direct without contact as far as memory allows.

    The iterations for contact correct the residual at which the iterative solver stops. Friction makes the matrix
    unsymmetric, which the iterative solver does not handle: it does not terminate. Times and errors are in notes.md.
    """
    if any(contact.friction for contact in model.contacts):
        return "SPOOLES"
    direct = not model.contacts and len(model.mesh.nodes) <= MAX_DIRECT_NODES
    return "SPOOLES" if direct else "ITERATIVE CHOLESKY"


def _nodes(model: Model, references: list[tuple[int, int]]) -> Iterator[str]:
    """Return all nodes in one block, and the set all_nodes of the mesh's nodes."""
    count = len(model.mesh.nodes)
    line = f"%d, {_NUMBER_FORMAT}, {_NUMBER_FORMAT}, {_NUMBER_FORMAT}\n"
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
    if first > _FIELDS_PER_LINE:
        first, rest = _FIELDS_PER_LINE, table.shape[1] - _FIELDS_PER_LINE
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
    """Return the numbers of a set, 16 per line."""
    whole = len(indices) // _FIELDS_PER_LINE * _FIELDS_PER_LINE
    yield from lines(", ".join(["%d"] * _FIELDS_PER_LINE) + "\n", indices[:whole].reshape(-1, _FIELDS_PER_LINE) + 1)
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


def _cyclic(cyclic: CyclicSymmetry, dialect: _Dialect) -> Iterator[str]:
    """Return the tie of the cut faces: nodes of the last cut face follow those of the first, rotated by a sector."""
    tie = f"{cyclic.first}_{cyclic.last}"
    yield f"** node k of the set {cyclic.last} is node k of {cyclic.first}, turned by 360 deg / {cyclic.sectors}\n"
    yield f"*TIE, CYCLIC SYMMETRY, NAME={tie}\n{cyclic.last}, {cyclic.first}\n"
    yield f"*CYCLIC SYMMETRY MODEL, N={cyclic.sectors}{f', TIE={tie}' if dialect.rotation_node else ''}\n"
    yield ", ".join(_NUMBER_FORMAT % x for x in cyclic.axis.ravel()) + "\n"


def _drive(tie: RigidTie, nodes: tuple[int, int]) -> Iterator[str]:
    """Return prescribed motions at a reference node, and loads in its free directions."""
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
    yield from lines(f"%d, %d, {_NUMBER_FORMAT}\n", table)


def _calculix_prints(model: Model) -> Iterator[str]:
    """Return requests for contact results at the nodes, and for sums as text: of reference nodes and contact pairs."""
    for tie in model.ties:
        for part in ("reference", "rotation"):
            yield f"*NODE PRINT, NSET={tie.node_set}_{part}\nU, RF\n"
    if model.contacts:
        yield "*CONTACT FILE\nCDIS, CSTR\n"
    for contact in model.contacts:
        yield f"*CONTACT PRINT, SLAVE={contact.slave}, MASTER={contact.master}\nCF\n"


register("calculix", INP_SUFFIX, "CalculiX deck: mesh, sets, contact, one static step, output requests", write_calculix)
register("abaqus", INP_SUFFIX, "Abaqus deck of the same model", write_abaqus)
