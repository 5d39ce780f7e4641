"""Tables of the forces on a planetary set for a torque, shared equally by its planets, with powers and speeds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.systems.common.running import running_rows
from gearmesh.systems.common.symbol_table import Row, table
from gearmesh.systems.cylindrical.force_tables import force_rows
from gearmesh.systems.cylindrical.geometry.forces import mesh_forces
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME
from gearmesh.systems.cylindrical.planetary.motion import DRIVING_MEMBER, speeds
from gearmesh.systems.system import SheetTable, complete_design
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign


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
    with_sun = mesh_forces(inner, share, flank.sign)
    with_ring = mesh_forces(outer, share * teeth[1] / teeth[0], flank.other.sign)
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
