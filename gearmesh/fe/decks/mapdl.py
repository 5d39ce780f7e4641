"""Ansys archive (.cdb): a static analysis of Mechanical APDL, which `/INPUT` or the batch option -i runs.

Hexahedra are SOLID185 with enhanced strains or SOLID186, with a component for each set. Contacts are CONTA174 and
TARGE170 elements on the faces, with outward normals and a real constant set for each pair: the stiffness as pressure over
penetration. A rigid set follows a MASS21 element without mass by constraint equations.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from gearmesh.fe.decks.fields import (
    T_PER_MM3_OF_KG_PER_M3,
    all_points,
    corners_then_middles,
    cyclic_equations,
    material_numbers,
    one_line,
    rows_of_numbers,
    write_ascii,
)
from gearmesh.fe.decks.registry import register
from gearmesh.fe.model import Model
from gearmesh.formats import CDB_SUFFIX
from gearmesh.io.texts import lines

#: number of the element type of the bodies
SOLID_TYPE_NUMBER = 1
#: number of the element type of target faces
TARGET_TYPE_NUMBER = 2
#: number of the element type of contact faces
CONTACT_TYPE_NUMBER = 3
#: number of the element type of the reference nodes
MASS_TYPE_NUMBER = 4
#: number of the real constants of the reference nodes; contact k has this number + k
FIRST_REAL_NUMBER = 10
#: directions of displacements and rotations
MOTION_NAMES = ("UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ")
#: directions of forces and moments
LOAD_NAMES = ("FX", "FY", "FZ", "MX", "MY", "MZ")


def write(model: Model, path: Path) -> None:
    """Write the whole archive."""
    write_ascii(path, _archive(model))


def _archive(model: Model) -> Iterator[str]:
    yield f"/COM,{one_line(model.title)}\n/COM,mm, N, MPa, t\n"
    yield from (f"/COM,{line}\n" for line in model.note_lines)
    yield f"/PREP7\n/NOPR\n/TITLE,{one_line(model.title)[:70]}\n"
    yield from _types(model)
    yield from _mesh(model)
    yield from _components(model)
    yield from _contacts(model)
    yield from _ties(model)
    yield from _cyclic(model)
    yield from _supports(model)
    # bodies that contact alone holds converge in the first substep, since they overlap
    yield "ALLSEL,ALL\nFINISH\n/SOLU\nANTYPE,STATIC\nNLGEOM,OFF\nTIME,1\nOUTRES,ALL,LAST\n"
    yield "SOLVE\nFINISH\n/GOPR\n"


def _types(model: Model) -> Iterator[str]:
    if model.mesh.second_order:
        yield f"ET,{SOLID_TYPE_NUMBER},186\n"
    else:
        yield f"ET,{SOLID_TYPE_NUMBER},185\nKEYOPT,{SOLID_TYPE_NUMBER},2,2\n"
    for number, material in enumerate(model.materials.values(), 1):
        yield f"MP,EX,{number},{material.youngs_modulus:.12g}\nMP,PRXY,{number},{material.poisson_ratio:.12g}\n"
        if material.density is not None:
            yield f"MP,DENS,{number},{T_PER_MM3_OF_KG_PER_M3 * material.density:.12g}\n"
    if model.contacts:
        yield f"ET,{TARGET_TYPE_NUMBER},170\nET,{CONTACT_TYPE_NUMBER},174\n"
        # penalty stiffness, detection at Gauss points, initial overlap counts, standard contact
        for option, value in ((2, 1), (4, 0), (9, 0), (12, 0)):
            yield f"KEYOPT,{CONTACT_TYPE_NUMBER},{option},{value}\n"
    if model.ties:
        # six degrees of freedom, no mass
        yield f"ET,{MASS_TYPE_NUMBER},21\nKEYOPT,{MASS_TYPE_NUMBER},3,0\nR,{FIRST_REAL_NUMBER},0,0,0,0,0,0\n"


def _mesh(model: Model) -> Iterator[str]:
    points, elements = all_points(model), model.mesh.elements
    count = len(points)
    yield f"NBLOCK,6,SOLID,{count:10d},{count:10d}\n(3i9,6e21.13e3)\n"
    table = np.column_stack((np.arange(1, count + 1), points))
    yield from lines(f"%9d{0:9d}{0:9d}%21.13E%21.13E%21.13E\n", table)
    yield "N,R5.3,LOC,       -1,\n"
    yield f"EBLOCK,19,SOLID,{len(elements):10d},{len(elements):10d}\n(19i10)\n"
    # material, type, real constants, section, frame, four flags, count of nodes, unused, number, nodes
    head = f"%10d{SOLID_TYPE_NUMBER:10d}{1:10d}{1:10d}{0:10d}{0:10d}{0:10d}{0:10d}{elements.shape[1]:10d}{0:10d}%10d"
    template = head + "%10d" * 8 + ("\n" + "%10d" * 12 if model.mesh.second_order else "") + "\n"
    numbers = np.arange(1, len(elements) + 1)
    yield from lines(template, np.column_stack((material_numbers(model), numbers, elements + 1)))
    yield "        -1\n"


def component_names(model: Model) -> tuple[dict[str, str], dict[str, str]]:
    """Return the names of components by node sets and by element sets; one name has one component in Ansys."""
    nodes = {name: name.upper() for name in model.mesh.node_sets}
    taken = set(nodes.values())
    return nodes, {
        name: f"{name.upper()}_E" if name.upper() in taken else name.upper() for name in model.mesh.element_sets
    }


def _components(model: Model) -> Iterator[str]:
    mesh, (of_nodes, of_elements) = model.mesh, component_names(model)
    for kind, names, sets in (("NODE", of_nodes, mesh.node_sets), ("ELEM", of_elements, mesh.element_sets)):
        for name, members in sets.items():
            yield f"CMBLOCK,{names[name]},{kind},{len(members):8d}\n(8i10)\n"
            yield from rows_of_numbers(np.sort(members) + 1, "%10d", 8)


def _contacts(model: Model) -> Iterator[str]:
    mesh = model.mesh
    next_element = len(mesh.elements) + 1
    shape = "QUA8" if mesh.second_order else "QUAD"
    for k, contact in enumerate(model.contacts, 1):
        real, material = FIRST_REAL_NUMBER + k, len(model.materials) + k
        yield f"/COM,{contact.slave} on {contact.master}\n"
        # a negative FKN is the stiffness itself
        yield f"R,{real},0,0,{-contact.stiffness:.9g},0.1\nMP,MU,{material},{contact.friction:.12g}\n"
        for kind, name in ((TARGET_TYPE_NUMBER, contact.master), (CONTACT_TYPE_NUMBER, contact.slave)):
            nodes = corners_then_middles(mesh, name) + 1
            yield f"TYPE,{kind}\nREAL,{real}\nMAT,{material}\n"
            yield f"TSHAP,{shape}\n" if kind == TARGET_TYPE_NUMBER else ""
            numbers = np.arange(next_element, next_element + len(nodes))
            yield from lines("EN" + ",%d" * (1 + nodes.shape[1]) + "\n", np.column_stack((numbers, nodes)))
            next_element += len(nodes)


def _ties(model: Model) -> Iterator[str]:
    of_nodes, _ = component_names(model)
    for node, tie in enumerate(model.ties, len(model.mesh.nodes) + 1):
        yield f"/COM,{tie.node_set}\nTYPE,{MASS_TYPE_NUMBER}\nREAL,{FIRST_REAL_NUMBER}\nE,{node}\n"
        yield f"CMSEL,S,{of_nodes[tie.node_set]}\nNSEL,A,NODE,,{node}\nCERIG,{node},ALL,UXYZ\nALLSEL,ALL\n"
        for motion, load, move, force in zip(tie.motion, tie.load, MOTION_NAMES, LOAD_NAMES, strict=True):
            if motion is not None:
                yield f"D,{node},{move},{motion:.12g}\n"
            elif load:
                yield f"F,{node},{force},{load:.12g}\n"


def _cyclic(model: Model) -> Iterator[str]:
    """Return the equations of a sector's cut faces, one for each node and direction."""
    if model.cyclic is None:
        return
    equations = cyclic_equations(model.mesh, model.cyclic)
    pairs = np.column_stack((equations.dependent, equations.independent)) + 1
    for row, terms in enumerate(equations.terms):
        # NEXT is the number of the equation, which stays the same for further terms of it as HIGH
        template = f"CE,NEXT,0,%d,{MOTION_NAMES[row]},1" + "".join(
            (",%d" if k < 2 else "\nCE,HIGH,0,%d") + f",{MOTION_NAMES[d]},{c:.15g}" for k, (d, c) in enumerate(terms)
        )
        yield from lines(template + "\n", np.column_stack((pairs[:, :1], *([pairs[:, 1:]] * len(terms)))))


def _supports(model: Model) -> Iterator[str]:
    of_nodes, _ = component_names(model)
    for support in model.supports:
        yield f"CMSEL,S,{of_nodes[support.node_set]}\n"
        yield from (f"D,ALL,{MOTION_NAMES[d]},{support.value:.12g}\n" for d in support.directions)
        yield "ALLSEL,ALL\n"
    for forces in model.forces:
        for d, force in enumerate(LOAD_NAMES[:3]):
            table = np.column_stack((forces.nodes + 1, forces.forces[:, d]))
            yield from lines(f"F,%d,{force},%.12g\n", table[table[:, 1] != 0.0])


register("ansys", CDB_SUFFIX, "Mechanical APDL: mesh, contact elements, supports, loads, a static step", write)
