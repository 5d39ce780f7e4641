"""Results of a solved finite-element model: contact pressure, position and area, forces, rotation, stress in a fillet.

A solver fills a `NodalSolution`; the figures here follow from its arrays. Units are mm, N, MPa, rad, in the frame of
the model.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from gearmesh.fe.model import Model
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.records import dataclass


@dataclass(frozen=True)
class ReferenceNode:
    """State of the reference node of a rigid tie."""

    #: displacement (3,), mm
    displacement: Array
    #: rotation (3,), rad
    rotation: Array
    #: force (3,), N, that holds or loads the node
    force: Array
    #: moment (3,), N mm, that holds or loads the node
    moment: Array


@dataclass(frozen=True)
class ContactTotal:
    """Sums over a contact pair, on its slave."""

    #: force (3,), N
    force: Array
    #: moment (3,) about the origin, N mm
    moment: Array
    #: area in contact, mm^2
    area: float


@dataclass(frozen=True)
class NodalSolution:
    """A solved model with N nodes."""

    #: displacements (N, 3), mm
    displacement: Array
    #: stresses (N, 6), MPa: xx, yy, zz, xy, yz, zx, extrapolated to the nodes and averaged there
    stress: Array
    #: contact pressures (N,), MPa; 0 without a pressed slave face
    pressure: Array
    #: reference nodes, by node set of the tie
    references: dict[str, ReferenceNode]
    #: sums over the contact pairs, in the order of the model
    contacts: tuple[ContactTotal, ...]
    #: iterations of the last increment
    iterations: int
    #: stresses (E, P, 6), MPa, components as above, at the integration points of the elements; None if not requested
    point_stress: Array | None = None

    @property
    def nodal_fields(self) -> dict[str, Array]:
        """Results at the nodes for files, by names with their units; stresses as VTK orders them."""
        return {
            "displacement_mm": self.displacement,
            "stress_mpa": self.stress,
            "von_mises_mpa": von_mises(self.stress),
            "max_principal_stress_mpa": principal_stresses(self.stress)[:, 2],
            "contact_pressure_mpa": self.pressure,
        }

    @property
    def element_fields(self) -> dict[str, Array]:
        """Stresses (E, 6) at each integration point of the elements, by names; points count as in CalculiX."""
        points: Iterable[Array] = () if self.point_stress is None else np.moveaxis(self.point_stress, 1, 0)
        return {f"stress_at_point_{k}_mpa": stress for k, stress in enumerate(points, 1)}


@dataclass(frozen=True)
class ContactFigures:
    """Figures of a contact pair. A pair that does not touch has NaN as place and centre."""

    #: largest pressure at a node, MPa
    peak_pressure: float
    #: position (3,) of this node, mm, on the undeformed slave
    place: Array
    #: centre (3,) of pressure over the nodes, mm, on the undeformed slave
    centre: Array
    #: area in contact, mm^2
    area: float
    #: force (3,) on the slave, N
    force: Array
    #: moment (3,) about the origin on the slave, N mm
    moment: Array


def contact_figures(model: Model, solution: NodalSolution) -> list[ContactFigures]:
    """Return the figures of each contact pair of the model, in its order."""
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
    """Return the area (N,), mm^2, of a face set at each corner node: a quarter of the faces around it."""
    corners = mesh.face_corners(name)
    a, b, c, d = np.moveaxis(mesh.nodes[corners], 1, 0)
    area = 0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=-1)
    shares = np.zeros(len(mesh.nodes))
    np.add.at(shares, corners, area[:, None] / 4.0)
    return shares


def principal_stresses(stress: Array) -> Array:
    """Return principal stresses (..., 3), MPa, in ascending order, from xx, yy, zz, xy, yz, zx (..., 6)."""
    rows = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
    return np.asarray(np.linalg.eigvalsh(stress[..., rows]), np.float64)


def von_mises(stress: Array) -> Array:
    """Return the equivalent stress (...,), MPa, of xx, yy, zz, xy, yz, zx (..., 6)."""
    normal, shear = stress[..., :3], stress[..., 3:]
    differences = normal - np.roll(normal, 1, axis=-1)
    return np.asarray(np.sqrt(0.5 * (differences**2).sum(axis=-1) + 3.0 * (shear**2).sum(axis=-1)), np.float64)


def largest_principal(mesh: HexMesh, solution: NodalSolution, *face_sets: str, sense: float = 1.0) -> tuple[float, int]:
    """Return the largest tension (MPa) at the nodes of face sets, and its node; with `sense` -1 the largest
    compression."""
    nodes = distinct(np.concatenate([mesh.face_nodes(name) for name in face_sets]))
    values = principal_stresses(sense * solution.stress[nodes])[:, 2]
    worst = int(np.argmax(values))
    return float(values[worst]), int(nodes[worst])
