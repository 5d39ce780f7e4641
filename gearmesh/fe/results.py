"""What a solved finite-element model says: contact pressure, place and area, forces, rotation, stress in a fillet.

Whoever runs a solver fills a `NodalSolution`; the figures here are of arrays alone. Units are mm, N, MPa, rad, the frame the
model's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.fe.model import Model
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.hexes import HexMesh


@dataclass(frozen=True)
class ReferenceNode:
    """State of the reference node of a rigid tie: mm, rad, N, N mm, (3,) each; forces are those that hold or load it."""

    displacement: Array
    rotation: Array
    force: Array
    moment: Array


@dataclass(frozen=True)
class ContactTotal:
    """What the slave of a contact pair feels: `force` (3,) N, `moment` (3,) N mm about the origin, `area` mm^2."""

    force: Array
    moment: Array
    area: float


@dataclass(frozen=True)
class NodalSolution:
    """A solved model with N nodes.

    `displacement` (N, 3) mm; `stress` (N, 6) MPa: xx, yy, zz, xy, yz, zx, extrapolated to the nodes and averaged there;
    `pressure` (N,) MPa, 0 where no slave face is pressed; `references` by node set of the tie; `contacts` in the model's
    order; `iterations` of the last increment.
    """

    displacement: Array
    stress: Array
    pressure: Array
    references: dict[str, ReferenceNode]
    contacts: tuple[ContactTotal, ...]
    iterations: int


@dataclass(frozen=True)
class ContactFigures:
    """A pressed contact pair: peak pressure (MPa) at a node and its `place` (3,), the `centre` (3,) of pressure over the
    nodes, both on the undeformed slave; `area` (mm^2); `force` (3,) N and `moment` (3,) N mm about the origin on the slave.

    An untouched pair has no place and no centre: NaN.
    """

    peak_pressure: float
    place: Array
    centre: Array
    area: float
    force: Array
    moment: Array


def contact_figures(model: Model, solution: NodalSolution) -> list[ContactFigures]:
    """Figures of each contact pair of the model, in its order."""
    return [
        _figures(model.mesh, pair.slave, solution.pressure, total)
        for pair, total in zip(model.contacts, solution.contacts, strict=True)
    ]


def _figures(mesh: HexMesh, slave: str, pressure: Array, total: ContactTotal) -> ContactFigures:
    nodes = mesh.face_nodes(slave)
    weight = pressure[nodes] * _shares(mesh, slave)[nodes]
    peak = nodes[int(np.argmax(pressure[nodes]))]
    touching = weight.sum() > 0.0
    nowhere = np.full(3, np.nan)
    return ContactFigures(
        peak_pressure=float(pressure[peak]),
        place=mesh.nodes[peak] if touching else nowhere,
        centre=weight @ mesh.nodes[nodes] / weight.sum() if touching else nowhere,
        area=total.area,
        force=total.force,
        moment=total.moment,
    )


def _shares(mesh: HexMesh, name: str) -> Array:
    """Area (N,) of a face set that each corner node stands for, mm^2: a quarter of the faces round it."""
    corners = mesh.face_corners(name)
    a, b, c, d = np.moveaxis(mesh.nodes[corners], 1, 0)
    area = 0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=-1)
    shares = np.zeros(len(mesh.nodes))
    np.add.at(shares, corners, area[:, None] / 4.0)
    return shares


def principal_stresses(stress: Array) -> Array:
    """Principal stresses (..., 3), MPa, the largest last, from xx, yy, zz, xy, yz, zx (..., 6)."""
    rows = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
    return np.asarray(np.linalg.eigvalsh(stress[..., rows]), np.float64)


def largest_principal(mesh: HexMesh, solution: NodalSolution, *face_sets: str, sense: float = 1.0) -> tuple[float, int]:
    """Largest tension (MPa) at the nodes of face sets, and the node where it is; with `sense` -1 the largest compression."""
    nodes = np.unique(np.concatenate([mesh.face_nodes(name) for name in face_sets]))
    values = principal_stresses(sense * solution.stress[nodes])[:, 2]
    worst = int(np.argmax(values))
    return float(values[worst]), int(nodes[worst])
