"""Finite-element models with a known answer, for the tests and for scripts/fe_checks.py."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh import FiniteElements, Rigid, load, parse
from gearmesh.contact.hertz import STEEL, PointContact, contact_modulus
from gearmesh.fe.model import Model, RigidTie
from gearmesh.fe.results import NodalSolution, principal_stresses
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.hexes import HexMesh
from oracles.built import model_of
from oracles.fe_blocks import block, graded, pressed, rounded
from oracles.hertz import at_peak
from oracles.places import SAMPLES


def crossed_cylinders(peak: float, cells: int, second_order: bool = False) -> tuple[Model, PointContact]:
    """A quarter of two crossed cylinders (R 10 and 4 mm) under the force that gives the peak pressure (MPa) by Hertz.

    `cells`: elements over each half axis of the ellipse.
    """
    kappa_x, kappa_y = 1.0 / 10.0, 1.0 / 4.0
    hertz = at_peak(kappa_x, kappa_y, peak, contact_modulus(STEEL, STEEL))
    a, b = float(hertz.semi_major), float(hertz.semi_minor)
    depth = 6.0 * a
    x, y = graded(1.25 * a, a / cells, depth, 2.0), graded(1.25 * b, b / cells, depth, 2.0)
    z = graded(b, b / cells, depth, 2.0)
    touching = Rigid(np.eye(3), np.array([0, 0, -0.5 * float(hertz.approach)]))
    upper = block(x, y, z, rounded(depth, kappa_x, 0.0), second_order).move(touching)
    lower = block(x, y, -z[::-1], rounded(-depth, 0.0, -kappa_y), second_order)
    load = (0, 0, -0.25 * float(hertz.force), 0, 0, 0)
    tie = RigidTie("upper_z1", np.array([0, 0, depth]), (0.0, 0.0, None, 0.0, 0.0, 0.0), load)
    return pressed(upper, lower, tie, "xy", 40.0 * STEEL.youngs_modulus / b), hertz


def crossed_beveloids(ellipse: int, order: int = 1) -> FiniteElements:
    """One tooth pair of the LT02 crossed pair under 50 Nm, `ellipse` elements over each half axis."""
    fillet = f"fe.fillet={3 if ellipse < 4 else 4}"
    return one_pair("beveloid_crossed", fillet, f"fe.ellipse={ellipse}", f"fe.order={order}")


def one_pair(sample: str, *keys: str) -> FiniteElements:
    """One tooth pair of a sample under 50 Nm."""
    own = ["fe.teeth=1", "fe.torque=50.0", "fe.rim_layers=2", "fe.fillet=4", *keys]
    return model_of(load(SAMPLES / f"{sample}.toml", own))


def worm_pair(ellipse: int = 0, **keys: Any) -> FiniteElements:
    """A thread and a tooth in a point under 20 Nm (m = 4, 2/40, the hob a tenth larger), `ellipse` elements over each half axis or
    by default as many as resolve the pressure; keys of tables set anew."""
    own = {"teeth": 1, "torque": 20.0, "rim_layers": 2, "fillet": 4, "ellipse": ellipse}
    drive: dict[str, Any] = {
        "kind": "worm_drive",
        "module": 4,
        "worm": {"threads": 2},
        "wheel": {"teeth": 40},
        "hob": {"reference_diameter": 44},
        "fe": own,
    }
    return model_of(parse({**drive, **keys}))


#: width (mm) of the slice of the spur pinion, N mm on it
WIDTH, TORQUE = 1.0, 10e4 / 30.0


def spur_slice(cells: int, order: int, teeth: int = 1, rim: float | None = None) -> FiniteElements:
    """A slice of the spur pinion held at rim and cut faces, under Hertz pressure: plane stress, two elements thick.

    `cells`: elements on a fillet and half the adjacent root land; the others are about as large there.
    """
    keys = {
        "pinion.face_width": WIDTH,
        "gear.face_width": WIDTH,
        "fe.torque": 1e-3 * TORQUE,
        "fe.teeth": teeth,
        "fe.order": order,
        "fe.spacing": "even",
        "fe.face": 2,
        "fe.flank": max(2, cells // 2),
        "fe.fillet": cells,
        "fe.thickness": cells,
        "fe.rim_layers": cells if rim else 2 * cells,
    }
    if rim:
        keys["fe.rim"] = rim
    return model_of(load(SAMPLES / "spur.toml", [f"{key}={value}" for key, value in keys.items()]), 0.0, ("pinion",))


@dataclass(frozen=True)
class FilletStress:
    """Largest principal stress (MPa) along the loaded fillet in the middle of the face: its maximum, and that at a fixed
    distance from the flank's lower end.
    """

    largest: float
    at_place: float


#: distance, mm, from the form point along the fillet, close to the maximum
PLACE = 1.25


def fillet_stress(mesh: HexMesh, solution: NodalSolution, fillet: str) -> FilletStress:
    """Stress along the fillet set, interpolated between corner nodes: at mid-side nodes ccx has only their mean."""
    nodes = np.unique(mesh.face_corners(fillet))
    nodes = nodes[np.abs(mesh.nodes[nodes, 2]) < 1e-6]
    nodes = nodes[np.argsort(-np.hypot(mesh.nodes[nodes, 0], mesh.nodes[nodes, 1]))]
    steps = np.linalg.norm(np.diff(mesh.nodes[nodes], axis=0), axis=-1)
    arc = np.concatenate(([0.0], np.cumsum(steps)))
    stress = principal_stresses(solution.stress[nodes])[:, 2]
    peak = int(np.clip(np.argmax(stress), 1, len(stress) - 2))
    around = slice(peak - 1, peak + 2)
    square, slope, level = np.polyfit(arc[around] - arc[peak], stress[around], 2)
    return FilletStress(float(level - 0.25 * slope**2 / square), _cubic(arc - PLACE, stress))


def _cubic(x: Array, y: Array) -> float:
    """Value at 0 of the cubic through the four nearest points."""
    nearest = np.argsort(np.abs(x))[:4]
    return float(np.polyfit(x[nearest], y[nearest], 3)[-1])


def iso_root_stress(force: float, radius: float) -> float:
    """Tooth-root stress YF YS F_t / (b m), MPa, of the spur slice by ISO 6336-3:2006, clauses 6 and 7 (30-degree tangent).

    `force` N along the normal, at the tooth's flank at `radius` mm. Lengths below are in modules; the rack is the standard
    one with a tip radius of 0.38.
    """
    m, z, x, alpha, dedendum, rho = 3.0, 20, 0.3, np.radians(20.0), 1.25, 0.38
    e = np.pi / 4.0 - dedendum * np.tan(alpha) - (1.0 - np.sin(alpha)) * rho / np.cos(alpha)
    g = rho - dedendum + x
    h = 2.0 / z * (np.pi / 2.0 - e) - np.pi / 3.0
    theta = np.pi / 6.0
    for _ in range(50):
        theta = 2.0 * g / z * np.tan(theta) - h
    reach = g / np.cos(theta) - rho
    chord = z * np.sin(np.pi / 3.0 - theta) + np.sqrt(3.0) * reach
    notch = rho + 2.0 * g**2 / (np.cos(theta) * (z * np.cos(theta) ** 2 - 2.0 * g))
    # the load's angle to the normal of the tooth's middle, and its arm over the critical chord
    diameter = 2.0 * radius / m
    pressure_angle = np.arccos(z * np.cos(alpha) / diameter)
    gamma = (0.5 * np.pi + 2.0 * x * np.tan(alpha)) / z + np.tan(alpha) - alpha
    gamma -= np.tan(pressure_angle) - pressure_angle
    load_angle = pressure_angle - gamma
    arm = (np.cos(gamma) - np.sin(gamma) * np.tan(load_angle)) * diameter - z * np.cos(np.pi / 3.0 - theta) - reach
    form = 3.0 * arm * np.cos(load_angle) / (chord**2 * np.cos(alpha))
    slender, sharp = chord / (0.5 * arm), chord / (2.0 * notch)
    correction = (1.2 + 0.13 * slender) * sharp ** (1.0 / (1.21 + 2.3 / slender))
    return float(form * correction * force * np.cos(alpha) / (WIDTH * m))
