"""Tables of the forces on cylindrical gears for a torque, with powers and speeds [ISO 21771]; without friction.

Pairs, pinion and rack, and planetary sets have the same rows. The planets of a set share its torque equally.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.systems.common.symbol_table import Row, Values, running_rows, table
from gearmesh.systems.cylindrical.double_helical import half_of
from gearmesh.systems.cylindrical.geometry.forces import MeshForces, mesh_forces
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME
from gearmesh.systems.cylindrical.planetary.motion import DRIVING_MEMBER, speeds
from gearmesh.systems.cylindrical.rack.design import PINION_NAME, RACK_NAME
from gearmesh.systems.cylindrical.rack.proportions import rack_proportions
from gearmesh.systems.system import SheetTable, complete_design
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign
    from gearmesh.systems.cylindrical.rack.design import RackDesign


def pair_forces(design: CylindricalDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return the forces on pinion and gear for a torque (Nm) on the pinion, which turns at a speed (1/min)."""
    own = complete_design(design).in_mm()
    mesh = proportions(half_of(own)).mesh
    flank = Side(own.contact.flank)
    forces, ratio = mesh_forces(mesh.working_side(flank), torque, flank.sign), mesh.gear.teeth / mesh.pinion.teeth
    senses = (mesh.pinion.sense, mesh.gear.sense)
    rows = running_rows((torque, torque * ratio), None if speed is None else (speed, speed / ratio))
    if speed is not None:
        rows.append(speed_row(mesh.working_radius(mesh.pinion), speed, 2))
    title = f"Forces for {torque:g} Nm on the pinion, its {flank.value} flanks driving"
    return (table(title, MEMBER_NAMES, [*rows, *force_rows(forces, senses, halves=own.double_helical)]),)


def speed_row(radius: float, speed: float, columns: int) -> Row:
    """Return the row of the speed (m/s) of a pitch circle of a `radius` (mm) at a rotational speed (1/min)."""
    return (
        "v_w",
        "circumferential speed of the working pitch circles",
        "m/s",
        (1e-3 * radius * math.pi * speed / 30.0,) * columns,
    )


def force_rows(forces: MeshForces, senses: tuple[int, int], *, halves: bool = False) -> list[Row]:
    """Return the rows of the forces on both members of a mesh.

    - senses: -1 for an internal member, else +1.
    - halves: True for double helical gears, whose axial forces cancel each other.
    """
    axial: Values = forces.axial, -forces.axial
    none: Values = 0.0, 0.0
    rows: list[Row] = [
        ("F_wt", "tangential, at the working pitch circles", "N", (forces.tangential,) * 2),
        ("F_t", "tangential, at the reference circles", "N", (forces.at_reference,) * 2),
        ("F_wr", "radial, > 0 towards the own axis", "N", tuple(sense * forces.radial for sense in senses)),
        ("F_wa", "axial, > 0 along z", "N", none if halves else axial),
        ("F_bn", "normal to the flanks", "N", (forces.normal,) * 2),
    ]
    if halves:
        of_half: Values = 0.5 * forces.axial, -0.5 * forces.axial
        rows.insert(4, ("F_waB", "axial, of the first half alone, > 0 along z", "N", of_half))
    return rows


#: names of the forces of a pair whose gear is a rack, by symbol
RACK_FORCE_NAMES = {
    "F_wt": "tangential, along the rack",
    "F_t": "tangential, at the reference circle",
    "F_wr": "radial: towards the pinion's axis; towards the back of the rack",
}


def rack_forces(design: RackDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return the forces on pinion and rack for a torque (Nm) on the pinion, which turns at a speed (1/min)."""
    own = complete_design(design).in_mm()
    mesh = rack_proportions(half_of(own)).mesh
    flank = Side(own.contact.flank)
    forces = mesh_forces(mesh.working_side(flank), torque, flank.sign)
    turning = running_rows((torque,), None if speed is None else (speed,))
    rows: list[Row] = [(*row[:3], (*row[3], None)) for row in turning]
    if speed is not None:
        symbol, _, unit, values = speed_row(mesh.pinion.radius, speed, 2)
        rows.append((symbol, "speed of the rack, and of the reference circle", unit, values))
    rows += [
        (symbol, RACK_FORCE_NAMES.get(symbol, words), unit, values)
        for symbol, words, unit, values in force_rows(forces, (1, 1), halves=own.double_helical)
    ]
    return (
        table(
            f"Forces for {torque:g} Nm on the pinion, its {flank.value} flanks driving", (PINION_NAME, RACK_NAME), rows
        ),
    )


def set_forces(design: PlanetaryDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return tables of the torques on sun, carrier and ring, and of the forces on a planet.

    `torque` (Nm) is on the member that drives, which turns at a speed (1/min).
    """
    own = complete_design(design).in_mm()
    both, count = meshes(own), len(own.angles)
    teeth = own.sun.teeth, own.planet.teeth, own.ring.teeth
    driver = DRIVING_MEMBER[own.fixed]
    # equilibrium: tangential forces of both meshes are equal, so that torques of sun and ring are as their teeth
    on_sun = torque if driver == SUN_NAME else torque * teeth[0] / teeth[2]
    on_ring = on_sun * teeth[2] / teeth[0]
    torques = on_sun, -on_sun - on_ring, on_ring
    turns = speeds(*teeth, own.fixed)
    rates = None if speed is None else [speed * turn for turn in (turns.sun, turns.carrier, turns.ring)]
    rows = running_rows(torques, rates)
    if speed is not None:
        rows.append(("n_p", "speed of the planets", "1/min", (speed * turns.planet, None, None)))
        rows.append(("n_p_c", "the same relative to the carrier", "1/min", (speed * turns.relative, None, None)))
    share, flank = on_sun / count, Side(own.contact.flank)
    halves = own.double_helical
    inner, outer = (proportions(mesh).mesh for mesh in (both.inner, both.outer))
    # the planet drives the ring with its other flanks
    with_sun = mesh_forces(inner.working_side(flank), share, flank.sign)
    with_ring = mesh_forces(outer.working_side(flank.other), share * teeth[1] / teeth[0], flank.other.sign)
    halves = own.double_helical
    pin: list[Row] = [
        ("F_pt", "tangential, at the circle of the planets' axes", "N", (with_sun.tangential + with_ring.tangential,)),
        ("F_pr", "radial, > 0 away from the sun", "N", (with_sun.radial - with_ring.radial,)),
        ("F_pa", "axial, > 0 along z", "N", (0.0 if halves else with_ring.axial - with_sun.axial,)),
    ]
    of_one = f"one of {count} planets that share the load equally"
    return (
        table(f"Torques on the set for {torque:g} Nm on the {driver}", (SUN_NAME, "carrier", RING_NAME), rows),
        table(
            f"Forces of sun and {PLANET_NAME}, {of_one}",
            (SUN_NAME, PLANET_NAME),
            force_rows(with_sun, (1, 1), halves=halves),
        ),
        table(
            f"Forces of {PLANET_NAME} and ring, {of_one}",
            (PLANET_NAME, RING_NAME),
            force_rows(with_ring, (1, -1), halves=halves),
        ),
        table("Load of its mesh forces on the planet's bearing", (PLANET_NAME,), pin),
    )
