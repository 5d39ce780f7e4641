"""Parts that several formats share: ASCII files, fields of fixed width, nodes, contact faces, equations of cyclic symmetry."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.fe.model import CyclicSymmetry, Model
from gearmesh.io.atomic import whole_file
from gearmesh.io.texts import lines
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.records import dataclass

#: t/mm^3 in a kg/m^3
T_PER_MM3_OF_KG_PER_M3 = 1e-12
#: order of the mid-side nodes where edges between bottom and top precede those of the top
UPRIGHT_EDGES_FIRST_ORDER = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]
#: coefficient of an equation below which the term is left out
MIN_EQUATION_COEFFICIENT = 1e-14


def write_ascii(path: Path, pieces: Iterator[str]) -> None:
    """Write a whole ASCII file from its pieces; other characters become question marks."""
    with whole_file(path) as temporary, open(temporary, "w", encoding="ascii", errors="replace", newline="\n") as file:
        file.writelines(pieces)


@dataclass(frozen=True)
class NodeEquations:
    """Linear equations u_dependent = `rotation` u_independent of the displacements of pairs of nodes."""

    #: node indices (K,)
    dependent: NDArray[np.int64]
    #: node indices (K,)
    independent: NDArray[np.int64]
    #: (3, 3)
    rotation: Array

    @property
    def terms(self) -> list[list[tuple[int, float]]]:
        """Direction and coefficient of the terms of u_independent, on the left side, for each direction of u_dependent."""
        return [
            [(direction, -c) for direction, c in enumerate(row) if abs(c) > MIN_EQUATION_COEFFICIENT]
            for row in self.rotation.tolist()
        ]


def cyclic_equations(mesh: HexMesh, cyclic: CyclicSymmetry) -> NodeEquations:
    """Return the equations that tie the last cut face of a sector to the first, rotated by a sector."""
    x, y, z = unit(cyclic.axis[1] - cyclic.axis[0])
    spin = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = 2.0 * np.pi / cyclic.sectors
    rotation = np.eye(3) + np.sin(angle) * spin + (1.0 - np.cos(angle)) * spin @ spin
    return NodeEquations(mesh.node_sets[cyclic.last], mesh.node_sets[cyclic.first], rotation)


def all_points(model: Model) -> Array:
    """Return the nodes (N, 3), mm, of the mesh, and after them the reference nodes of the ties."""
    nodes = model.mesh.nodes
    return np.concatenate((nodes, [tie.point for tie in model.ties])) if model.ties else nodes


def material_numbers(model: Model) -> NDArray[np.int64]:
    """Return the number (M,) of the material of each element, from 1; 0 for an element without a material."""
    numbers = np.zeros(len(model.mesh.elements), np.int64)
    for number, name in enumerate(model.materials, 1):
        numbers[model.mesh.element_sets[name]] = number
    return numbers


def coordinate_field(nodes: Array, width: int) -> str:
    """Return the %-format of a coordinate, mm, in `width` characters, with as many decimals as the largest leaves."""
    whole = len(str(int(np.ceil(np.abs(nodes).max(initial=1.0)))))
    return f"%{width}.{width - 2 - whole}f"


def rows_of_numbers(
    numbers: NDArray[np.int64], field: str, per_row: int, lead: str = "", between: str = "", end: str = ""
) -> Iterator[str]:
    """Return numbers in rows of `per_row`, each with the %-format `field`.

    `lead` begins a row, `between` separates its numbers, and `end` ends all rows but the last.
    """
    whole = max(0, (len(numbers) - 1) // per_row) * per_row
    yield from lines(f"{lead}{between.join([field] * per_row)}{end}\n", numbers[:whole].reshape(-1, per_row))
    if rest := numbers[whole:].tolist():
        yield lead + between.join([field] * len(rest)) % tuple(rest) + "\n"


def longest_edge(mesh: HexMesh, name: str) -> float:
    """Return the longest edge, mm, of the faces of a set."""
    corners = mesh.nodes[mesh.face_corners(name)]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1).max())


def corners_then_middles(mesh: HexMesh, name: str) -> NDArray[np.int64]:
    """Return the nodes (K, 4 or 8) of the faces of a set, counterclockwise from outside: corners, then mid-side nodes."""
    outline = mesh.face_outlines(name)
    return np.concatenate((outline[:, ::2], outline[:, 1::2]), axis=1) if mesh.second_order else outline


def one_line(text: str) -> str:
    """Return a text with single blanks in place of line ends and other white space."""
    return " ".join(text.split())
