"""LS-DYNA keyword file (.k): an implicit static analysis with mortar contact.

Hexahedra have formulation 62 (incompatible modes), of second order 23. Sets keep their names as titles. A rigid set is a
nodal rigid body whose centre of gravity is its reference node, since its constraints and loads act there. The stiffness
of mortar contact is LS-DYNA's own. Initial overlaps are an interference fit, resolved over the step (IGNORE 3).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.fe.decks.fields import (
    T_PER_MM3_OF_KG_PER_M3,
    all_points,
    coordinate_field,
    cyclic_equations,
    material_numbers,
    one_line,
    rows_of_numbers,
    write_ascii,
)
from gearmesh.fe.decks.registry import register
from gearmesh.fe.model import Model, RigidTie
from gearmesh.formats import K_SUFFIX
from gearmesh.io.texts import lines

#: element formulations of first and second order
FORMULATION_NUMBERS = {False: 62, True: 23}
#: code of a combination of directions x, y, z that a rigid body's centre may not move or rotate along
DIRECTION_CODES = {(): 0, (0,): 1, (1,): 2, (2,): 3, (0, 1): 4, (1, 2): 5, (0, 2): 6, (0, 1, 2): 7}
#: numbers of directions of motions and loads: x, y, z, and rotations about them
DIRECTION_NUMBERS = (1, 2, 3, 5, 6, 7)
#: mass (t) and moments of inertia (t mm^2) of rigid bodies, of which a static analysis makes no use
RIGID_MASS_T = 1e-3
#: density, t/mm^3, of a material without one
MISSING_DENSITY_T_PER_MM3 = 1e-12


def write(model: Model, path: Path) -> None:
    """Write the whole file."""
    write_ascii(path, _file(model))


def _file(model: Model) -> Iterator[str]:
    yield "*KEYWORD\n$ mm, N, MPa, t, s\n"
    yield from (f"$ {line}\n" for line in model.note_lines)
    yield f"*TITLE\n{one_line(model.title)[:80]}\n"
    yield f"*CONTROL_TERMINATION\n{1.0:10.1f}\n*CONTROL_IMPLICIT_GENERAL\n{1:10d}{1.0:10.1f}\n"
    # full Newton, residual and displacement below a thousandth
    yield f"*CONTROL_IMPLICIT_SOLUTION\n{12:10d}\n*CONTROL_IMPLICIT_AUTO\n{1:10d}\n"
    yield f"*DATABASE_BINARY_D3PLOT\n{1.0:10.1f}\n*DATABASE_RCFORC\n{1.0:10.1f}\n"
    # loads and motions grow with the time
    yield f"*DEFINE_CURVE\n{1:10d}\n{0.0:20.1f}{0.0:20.1f}\n{1.0:20.1f}{1.0:20.1f}\n"
    yield f"*SECTION_SOLID\n{1:10d}{FORMULATION_NUMBERS[model.mesh.second_order]:10d}\n"
    for number, (name, material) in enumerate(model.materials.items(), 1):
        density = MISSING_DENSITY_T_PER_MM3 if material.density is None else T_PER_MM3_OF_KG_PER_M3 * material.density
        yield f"*PART\n{name}\n{number:10d}{1:10d}{number:10d}\n*MAT_ELASTIC_TITLE\n{name}\n"
        yield f"{number:10d}{density:10.3E}{_number(material.youngs_modulus)}{_number(material.poisson_ratio)}\n"
    yield from _mesh(model)
    yield from _sets(model)
    yield from _supports(model)
    for number, tie in enumerate(model.ties):
        yield from _tie(model, number, tie)
    for forces in model.forces:
        table = np.column_stack((np.repeat(forces.nodes + 1, 3), np.tile(DIRECTION_NUMBERS[:3], len(forces.nodes))))
        # long fields, of 20 characters
        yield "*LOAD_NODE_POINT +\n"
        yield from lines(f"%20d%20d{1:20d}%20.12E\n", np.column_stack((table, forces.forces.ravel())))
    yield from _contacts(model)
    yield from _cyclic(model)
    yield "*END\n"


def _number(value: float) -> str:
    """Return a number with as many digits as 10 characters hold."""
    texts = (f"{value:.{digits}G}" for digits in range(9, 0, -1))
    return f"{next(text for text in texts if len(text) <= 10):>10}"


def _mesh(model: Model) -> Iterator[str]:
    mesh = model.mesh
    points = all_points(model)
    yield "*NODE\n"
    template = "%8d" + 3 * coordinate_field(points, 16) + "\n"
    yield from lines(template, np.column_stack((np.arange(1, len(points) + 1), points)))
    table = np.column_stack((np.arange(1, len(mesh.elements) + 1), material_numbers(model), mesh.elements + 1))
    if mesh.second_order:
        yield "*ELEMENT_SOLID_H20\n"
        yield from lines("%8d%8d\n" + "%8d" * 10 + "\n" + "%8d" * 10 + "\n", table)
    else:
        yield "*ELEMENT_SOLID\n"
        yield from lines("%8d" * 10 + "\n", table)


def set_numbers(model: Model) -> tuple[dict[str, int], dict[str, int], dict[str, int]]:
    """Return the numbers of the sets of nodes, of elements and of segments (faces), by their names."""
    mesh, ties = model.mesh, [_rigid_name(tie) for tie in model.ties]
    return (
        {name: k for k, name in enumerate([*mesh.node_sets, *ties], 1)},
        {name: k for k, name in enumerate(mesh.element_sets, 1)},
        {name: k for k, name in enumerate(mesh.face_sets, 1)},
    )


def _rigid_name(tie: RigidTie) -> str:
    return f"{tie.node_set}_and_reference"


def _sets(model: Model) -> Iterator[str]:
    mesh, (nodes, elements, faces) = model.mesh, set_numbers(model)
    first_reference = len(mesh.nodes)
    rigid = {
        _rigid_name(tie): np.append(mesh.node_sets[tie.node_set], first_reference + k)
        for k, tie in enumerate(model.ties)
    }
    for name, members in (mesh.node_sets | rigid).items():
        yield f"*SET_NODE_LIST_TITLE\n{name}\n{nodes[name]:10d}\n"
        yield from rows_of_numbers(members + 1, "%10d", 8)
    for name, members in mesh.element_sets.items():
        yield f"*SET_SOLID_TITLE\n{name}\n{elements[name]:10d}\n"
        yield from rows_of_numbers(members + 1, "%10d", 8)
    for name in mesh.face_sets:
        yield f"*SET_SEGMENT_TITLE\n{name}\n{faces[name]:10d}\n"
        yield from lines("%10d" * 4 + "\n", mesh.face_corners(name) + 1)


def _supports(model: Model) -> Iterator[str]:
    nodes, _, _ = set_numbers(model)
    for support in model.supports:
        number = nodes[support.node_set]
        if support.value:
            yield "*BOUNDARY_PRESCRIBED_MOTION_SET\n"
            for d in support.directions:
                yield f"{number:10d}{DIRECTION_NUMBERS[d]:10d}{2:10d}{1:10d}{_number(support.value)}\n"
        else:
            flags = "".join(f"{int(d in support.directions):10d}" for d in range(3))
            yield f"*BOUNDARY_SPC_SET\n{number:10d}{0:10d}{flags}\n"


def _tie(model: Model, number: int, tie: RigidTie) -> Iterator[str]:
    """Return a nodal rigid body: its number follows those of the parts."""
    nodes, _, _ = set_numbers(model)
    body, reference = len(model.materials) + 1 + number, len(model.mesh.nodes) + 1 + number
    fixed = [_fixed(tie.motion[:3]), _fixed(tie.motion[3:])]
    yield f"*CONSTRAINED_NODAL_RIGID_BODY_SPC_INERTIA_TITLE\n{tie.node_set}\n"
    yield f"{body:10d}{0:10d}{nodes[_rigid_name(tie)]:10d}{reference:10d}\n"
    yield f"{1:10d}{fixed[0]:10d}{fixed[1]:10d}\n"
    centre = "".join(_number(x) for x in tie.point)
    yield f"{centre}{RIGID_MASS_T:10.3E}{0:10d}{reference:10d}\n"
    inertia = [RIGID_MASS_T, 0.0, 0.0, RIGID_MASS_T, 0.0, RIGID_MASS_T]
    yield "".join(f"{x:10.3E}" for x in inertia) + "\n" + f"{0.0:10.1f}" * 6 + "\n"
    for direction, motion, load in zip(DIRECTION_NUMBERS, tie.motion, tie.load, strict=True):
        if motion:
            yield f"*BOUNDARY_PRESCRIBED_MOTION_RIGID\n{body:10d}{direction:10d}{2:10d}{1:10d}{_number(motion)}\n"
        elif motion is None and load:
            yield f"*LOAD_RIGID_BODY\n{body:10d}{direction:10d}{1:10d}{_number(load)}\n"


def _fixed(motion: Sequence[float | None]) -> int:
    """Return the code of the directions that are held; those with a prescribed motion are not."""
    return DIRECTION_CODES[tuple(d for d, value in enumerate(motion) if value == 0.0)]


def _contacts(model: Model) -> Iterator[str]:
    _, _, faces = set_numbers(model)
    for number, contact in enumerate(model.contacts, 1):
        yield "*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE_MORTAR_ID\n"
        yield f"{number:10d}{f'{contact.slave} on {contact.master}'[:70]}\n"
        yield f"{faces[contact.slave]:10d}{faces[contact.master]:10d}{0:10d}{0:10d}\n"
        yield f"{_number(contact.friction)}{_number(contact.friction)}\n{1.0:10.1f}{1.0:10.1f}\n"
        # optional cards A and B are there as defaults, so that card C has IGNORE, which ends with the step
        yield f"{0:10d}\n{0:10d}\n{0:10d}{3:10d}{1.0:10.1f}\n"


def _cyclic(model: Model) -> Iterator[str]:
    """Return the equations of a sector's cut faces, one for each node and direction."""
    if model.cyclic is None:
        return
    equations, number = cyclic_equations(model.mesh, model.cyclic), 0
    for row, terms in enumerate(equations.terms):
        template = f"*CONSTRAINED_MULTIPLE_GLOBAL +\n%20d\n{1 + len(terms):20d}\n%20d{row + 1:20d}{1.0:20.1f}\n"
        template += "".join(f"%20d{d + 1:20d}{c:20.12E}\n" for d, c in terms)
        count = len(equations.dependent)
        numbers = np.arange(number + 1, number + 1 + count)
        others: list[NDArray[np.int64]] = [equations.independent + 1] * len(terms)
        yield from lines(template, np.column_stack((numbers, equations.dependent + 1, *others)))
        number += count


register("lsdyna", K_SUFFIX, "LS-DYNA keyword file: implicit statics, mortar contact", write)
