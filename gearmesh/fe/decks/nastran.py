"""Nastran bulk data (.bdf) for SOL 101: CHEXA, rigid RBE2, linear contact of Simcenter Nastran, loads, one subcase.

Nodes and elements have the numbers index + 1. Coordinates stand in large fields, 16 characters. Nastran has no names of
sets: each set is a SET of the case control, under a comment with its name. Contacts are BSURFS, BCTSET and BCTPARM, with
the stiffness as pressure over penetration. A sector's cut faces are tied by MPC.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.fe.decks.fields import (
    T_PER_MM3_OF_KG_PER_M3,
    UPRIGHT_EDGES_FIRST_ORDER,
    all_points,
    coordinate_field,
    cyclic_equations,
    longest_edge,
    material_numbers,
    one_line,
    rows_of_numbers,
    write_ascii,
)
from gearmesh.fe.decks.registry import register
from gearmesh.fe.model import ContactPair, Model
from gearmesh.formats import BDF_SUFFIX
from gearmesh.io.texts import lines
from gearmesh.mesh.hexahedra.hexes import HexMesh

#: number of the set of constraints
SPC_SET_NUMBER = 1
#: number of the set of loads
LOAD_SET_NUMBER = 2
#: number of the set of equations
MPC_SET_NUMBER = 3
#: number of the set of all contacts; contact k has this number + k
CONTACT_SET_NUMBER = 100


def write(model: Model, path: Path) -> None:
    """Write the whole deck."""
    write_ascii(path, _deck(model))


def _deck(model: Model) -> Iterator[str]:
    yield from _case_control(model)
    yield "BEGIN BULK\nPARAM,POST,-1\n"
    yield from _mesh(model)
    for number, (name, material) in enumerate(model.materials.items(), 1):
        density = 0.0 if material.density is None else T_PER_MM3_OF_KG_PER_M3 * material.density
        yield f"$ {name}\nPSOLID  {number:8d}{number:8d}\n"
        yield f"MAT1*   {number:16d}{material.youngs_modulus:16.9E}{'':16}{material.poisson_ratio:16.9E}\n"
        yield f"*       {density:16.9E}\n"
    yield from _supports(model)
    yield from _ties(model)
    for forces in model.forces:
        for node, force in zip(forces.nodes.tolist(), forces.forces.tolist(), strict=True):
            yield _vector("FORCE*", node + 1, force)
    yield from _contacts(model)
    yield from _cyclic(model)
    yield "ENDDATA\n"


def _case_control(model: Model) -> Iterator[str]:
    mesh = model.mesh
    yield f"$ {one_line(model.title)}\n$ mm, N, MPa, t\n"
    yield from (f"$ {line}\n" for line in model.note_lines)
    yield f"SOL 101\nCEND\nTITLE = {one_line(model.title)[:66]}\nECHO = NONE\n"
    number = 0
    for kind, sets in (("nodes", mesh.node_sets), ("elements", mesh.element_sets)):
        for name, members in sets.items():
            number += 1
            yield f"$ {kind} {name}\nSET {number} = "
            yield from rows_of_numbers(members + 1, "%d", 7, between=",", end=",")
    yield "SUBCASE 1\n"
    wanted = (
        ("SPC", SPC_SET_NUMBER, model.supports or model.ties),
        ("LOAD", LOAD_SET_NUMBER, model.is_loaded),
        ("MPC", MPC_SET_NUMBER, model.cyclic),
        ("BCSET", CONTACT_SET_NUMBER, model.contacts),
    )
    yield from (f"  {word} = {chosen}\n" for word, chosen, there in wanted if there)
    yield "  DISPLACEMENT = ALL\n  SPCFORCES = ALL\n  STRESS(CORNER) = ALL\n"
    yield "  BCRESULTS(TRACTION,FORCE) = ALL\n" if model.contacts else ""


def _mesh(model: Model) -> Iterator[str]:
    mesh = model.mesh
    points = all_points(model)
    field = coordinate_field(points, 16)
    # float64 holds node numbers exactly, and %d prints them without a point
    table = np.column_stack((np.arange(1, len(points) + 1), points))
    yield from lines(f"GRID*   %16d{'':16}{field}{field}\n*       {field}\n", table)
    elements = mesh.elements[:, UPRIGHT_EDGES_FIRST_ORDER] if mesh.second_order else mesh.elements
    rows = ["%8d" * 8, "%8d" * 2] if not mesh.second_order else ["%8d" * 8, "%8d" * 8, "%8d" * 6]
    # gmsh follows a line to the next one by the marks in fields 10 and 1: without the first it drops mid-side nodes
    template = "CHEXA   " + "+\n+       ".join(rows) + "\n"
    numbers = np.arange(1, len(elements) + 1)
    yield from lines(template, np.column_stack((numbers, material_numbers(model), elements + 1)))


def _supports(model: Model) -> Iterator[str]:
    for support in model.supports:
        components = int("".join(str(d + 1) for d in sorted(support.directions)))
        nodes = model.mesh.node_sets[support.node_set] + 1
        yield f"$ {support.node_set}\n"
        yield from _card("SPC1", np.concatenate(([SPC_SET_NUMBER, components], nodes)))
        if support.value:
            for direction in support.directions:
                yield from (_enforced(node, direction + 1, support.value) for node in nodes.tolist())


def _ties(model: Model) -> Iterator[str]:
    first_node, element = len(model.mesh.nodes) + 1, len(model.mesh.elements) + 1
    for k, tie in enumerate(model.ties):
        node = first_node + k
        yield f"$ {tie.node_set}\n"
        yield from _card("RBE2", np.concatenate(([element + k, node, 123], model.mesh.node_sets[tie.node_set] + 1)))
        held = [d + 1 for d in range(6) if tie.motion[d] is not None]
        if held:
            yield f"SPC1    {SPC_SET_NUMBER:8d}{''.join(map(str, held)):>8}{node:8d}\n"
        for d, motion in enumerate(tie.motion):
            if motion:
                yield _enforced(node, d + 1, motion)
        load = np.where([motion is None for motion in tie.motion], tie.load, 0.0).tolist()
        for card, vector in (("FORCE*", load[:3]), ("MOMENT*", load[3:])):
            if any(vector):
                yield _vector(card, node, vector)


def _enforced(node: int, component: int, value: float) -> str:
    return f"SPCD*   {LOAD_SET_NUMBER:16d}{node:16d}{component:16d}{value:16.9E}\n"


def _vector(card: str, node: int, vector: list[float]) -> str:
    """Return a force or moment in the basic frame: a factor of 1 and three components."""
    numbers = "".join(f"{x:16.9E}" for x in vector)
    return f"{card:8}{LOAD_SET_NUMBER:16d}{node:16d}{0:16d}{1.0:16.9E}\n*       {numbers}\n"


def _contacts(model: Model) -> Iterator[str]:
    mesh = model.mesh
    numbers: dict[str, int] = {}
    for contact in model.contacts:
        for name in (contact.slave, contact.master):
            if name not in numbers:
                numbers[name] = CONTACT_SET_NUMBER + len(numbers) + len(model.contacts) + 1
                yield from _faces(mesh, name, numbers[name])
    for k, contact in enumerate(model.contacts, CONTACT_SET_NUMBER + 1):
        yield from _contact(contact, k, numbers, longest_edge(mesh, contact.slave))
    if model.contacts:
        yield from _card(
            "BCTADD", np.concatenate(([CONTACT_SET_NUMBER], np.arange(len(model.contacts)) + CONTACT_SET_NUMBER + 1))
        )


def _faces(mesh: HexMesh, name: str, number: int) -> Iterator[str]:
    """Return the faces of a set, each as element and three corners."""
    corners = mesh.face_corners(name)[:, :3] + 1
    fields = np.column_stack((mesh.face_sets[name][:, 0] + 1, corners)).ravel()
    yield f"$ {name}\n"
    yield from _card(f"BSURFS  {number:8d}{'':24}", fields, 4)


def _contact(contact: ContactPair, number: int, numbers: dict[str, int], reach: float) -> Iterator[str]:
    """Return a pair of faces with its friction, search distances and stiffness (force per length^3)."""
    friction, stiffness = f"{contact.friction:8.5f}", _short(contact.stiffness)
    yield f"$ {contact.slave} on {contact.master}\n"
    yield f"BCTSET  {number:8d}{numbers[contact.slave]:8d}{numbers[contact.master]:8d}{friction}"
    yield f"{_short(-reach)}{_short(reach)}\n"
    yield f"BCTPARM {number:8d}{'PENTYP':>8}{2:8d}{'PENN':>8}{stiffness}{'PENT':>8}{_short(0.1 * contact.stiffness)}\n"


def _short(value: float) -> str:
    """Return a number with a decimal point in 8 characters: the exponent stands without an E, as Nastran takes it."""
    texts = (f"{value:.{digits}E}" for digits in range(5, 0, -1))
    short = (text.replace("E", "").replace("+0", "+").replace("-0", "-") for text in texts)
    return f"{next(text for text in short if len(text) <= 8):>8}"


def _card(lead: str, fields: NDArray[np.int64], first: int = 8) -> Iterator[str]:
    """Return a card of whole numbers: `first` of them after its `lead`, then eight to a line."""
    yield f"{lead:8}" + "%8d" * len(fields[:first]) % tuple(fields[:first].tolist()) + "\n"
    yield from rows_of_numbers(fields[first:], "%8d", 8, lead="+       ")


def _cyclic(model: Model) -> Iterator[str]:
    """Return the equations of a sector's cut faces, one for each node and direction."""
    if model.cyclic is None:
        return
    equations = cyclic_equations(model.mesh, model.cyclic)
    for row, terms in enumerate(equations.terms):
        # a line of the small format has two terms; here each of its halves has one, after a blank field in every second
        template = f"MPC*    {MPC_SET_NUMBER:16d}%16d{row + 1:16d}{1.0:16.9E}\n" + "".join(
            f"*       {'':{16 * (k % 2)}}%16d{d + 1:16d}{c:16.9E}\n" for k, (d, c) in enumerate(terms)
        )
        table = np.column_stack((equations.dependent, *([equations.independent] * len(terms)))) + 1
        yield from lines(template, table)


register("nastran", BDF_SUFFIX, "Nastran bulk data: SOL 101, contact of Simcenter Nastran", write)
