"""The data sheet of a planetary set: the whole set, sun with planet, and planet with ring [ISO 21771-1]."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.symbol_table import Row, table, tables_of
from gearmesh.systems.cylindrical.double_helical import half_of
from gearmesh.systems.cylindrical.geometry.nominal_stress import NominalFactors
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME
from gearmesh.systems.cylindrical.planetary.motion import (
    DRIVEN_MEMBER,
    DRIVING_MEMBER,
    pairs_in_contact,
    phase_of_ring,
    phases,
    ratio,
    speeds,
)
from gearmesh.systems.cylindrical.sheet import SheetPair, factors_of, half_tables, pair_of_members, pair_tables
from gearmesh.systems.system import Reserve, Sheet, SheetTable, complete_design
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.region import Region, Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign


#: members of both meshes, as named in tables
MESH_MEMBERS = (SUN_NAME, PLANET_NAME), (PLANET_NAME, RING_NAME)


def planetary_sheet(design: PlanetaryDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a planetary design and the gear set built from it.

    It contains the tables that every system has.
    """
    own = complete_design(design).in_mm()
    derived, *plain = plain_sheet(own, train).tables
    tables: list[SheetTable] = []
    pairs = _sheet_pairs(own, train)
    for pair, names in zip(pairs, MESH_MEMBERS, strict=True):
        for pair_table in pair_tables(pair, names):
            tables.append(replace(pair_table, title=f"{names[0].capitalize()} and {names[1]}: {pair_table.title}"))
    warnings = [
        line for pair, names in zip(pairs, MESH_MEMBERS, strict=True) for line in pair.fillet_interference(names)
    ]
    members = _sheet_members(train)
    of_set = tables_of(("Set", lambda: _set_tables(own, members[PLANET_NAME], *pairs)))
    return Sheet(
        (derived, *of_set, *half_tables(own, tuple(members.values())), *tables, *plain), {}, warnings=tuple(warnings)
    )


def planetary_reserves(design: PlanetaryDesign, train: GearTrain) -> tuple[Reserve, ...]:
    """Return the reserves of all meshes against interference, the sun's meshes first.

    All planets have the same reserves.
    """
    pairs, planets = _sheet_pairs(complete_design(design).in_mm(), train), len(train.pairs) // 2
    return tuple(
        reserve
        for number in range(len(train.pairs))
        for reserve in pairs[number // planets].interference_reserves(number, MESH_MEMBERS[number // planets])
    )


def _sheet_members(train: GearTrain) -> dict[str, Member]:
    """Return sun, first planet and ring of a gear set."""
    return {
        SUN_NAME: train.members[SUN_NAME],
        PLANET_NAME: train.members[f"{PLANET_NAME}_1"],
        RING_NAME: train.members[RING_NAME],
    }


def set_factors(design: PlanetaryDesign, pair: GearPair) -> NominalFactors | None:
    """Return the factors of the nominal stresses of a mesh of a set [ISO 6336-2, -3]."""
    both = meshes(complete_design(design).in_mm())
    mesh = both.inner if SUN_NAME in pair.members else both.outer
    return factors_of(pair_of_members(mesh, pair.both), pair)


def _sheet_pairs(own: PlanetaryDesign, train: GearTrain) -> tuple[SheetPair, SheetPair]:
    """Return both meshes of a complete design in mm and the gear set built from it."""
    both_meshes, members = meshes(own), _sheet_members(train)
    pairs = []
    for mesh, names in zip((both_meshes.inner, both_meshes.outer), MESH_MEMBERS, strict=True):
        # the designs of the meshes have only the keys that shape their teeth
        whole = half_of(mesh).model_copy(update={"accuracy_class": own.accuracy_class, "material": own.material})
        both = members[names[0]], members[names[1]]
        stated = tuple(getattr(own, name) for name in names)
        pairs.append(SheetPair(whole, proportions(whole), both, stated=stated))
    inner, outer = pairs
    return inner, outer


def _set_tables(design: PlanetaryDesign, planet: Member, inner: SheetPair, outer: SheetPair) -> list[SheetTable]:
    """Return the tables of the whole set and of its planets."""
    teeth = design.sun.teeth, design.planet.teeth, design.ring.teeth
    # the planet drives the ring with its other flanks
    flank = Side(design.contact.flank)
    with_sun, with_ring = inner.working_line(flank), outer.working_line(flank.other)
    ratios = with_sun.contact_ratio + inner.overlap_ratio, with_ring.contact_ratio + outer.overlap_ratio
    sense = flank.sign
    ahead = phases(teeth[0], design.angles, sense)
    # first halves end together at the gap: either all of both faces touches before this plane, or nothing
    share = float(inner.mesh.pinion.beta * sense > 0.0) if design.double_helical else 0.5
    ring_phase = phase_of_ring(with_sun, with_ring, (inner.overlap_ratio, outer.overlap_ratio), share)
    of_ring = [(phase + ring_phase) % 1.0 for phase in ahead]
    tip_gaps = _apart(design, inner.mesh.distance, planet)
    count = len(ahead)
    contact_counts = [
        pairs_in_contact([ratios[0]] * count, ahead),
        pairs_in_contact([ratios[1]] * count, of_ring),
        pairs_in_contact([*[ratios[0]] * count, *[ratios[1]] * count], [*ahead, *of_ring]),
    ]
    rows: list[Row] = [
        *_motion_rows(design, teeth),
        (
            "z_a",
            "teeth of sun and ring per planet; a whole number where planets can be equally spaced",
            "-",
            (_planet_share(design),),
        ),
        ("tau_a", "step of the angles at which planets can be assembled", "deg", (360.0 / (teeth[0] + teeth[2]),)),
        ("c_p", "clearance of the tips of neighbouring planets, least", "mm", (min(tip_gaps, default=None),)),
        ("phi_r", "phase of the mesh with the ring against that with the sun", "p", (ring_phase,)),
        ("eps_s", "total contact ratio of sun and planet", "-", (ratios[0],)),
        ("eps_r", "total contact ratio of planet and ring", "-", (ratios[1],)),
        ("eps_s_sum", "sum over the planets, with the sun", "-", (count * ratios[0],)),
        ("eps_r_sum", "sum over the planets, with the ring", "-", (count * ratios[1],)),
    ]
    for symbol, words, (low, high) in zip(
        ("n_s", "n_r", "n"), ("the sun", "the ring", "both"), contact_counts, strict=True
    ):
        rows += [
            (f"{symbol}_min", f"least tooth pairs in contact with {words}", "-", (low,)),
            (f"{symbol}_max", f"most tooth pairs in contact with {words}", "-", (high,)),
        ]
    planets: list[Row] = [
        ("psi", "angle about the sun", "deg", tuple(design.angles)),
        ("phi_s", "phase of the mesh with the sun against that of planet_1", "p", tuple(ahead)),
        ("phi_r", "phase of the mesh with the ring against planet_1 with the sun", "p", tuple(of_ring)),
        ("c_p", "clearance of the tips to the next planet", "mm", tuple(tip_gaps) or (None,)),
    ]
    names = tuple(f"{PLANET_NAME}_{k + 1}" for k in range(count))
    return [table("Set", ("",), rows), table("Planets", names, planets)]


def _motion_rows(design: PlanetaryDesign, teeth: tuple[int, int, int]) -> list[Row]:
    """Return the rows of speeds per turn of the driving member, and of the ratios for each fixed member."""
    turns = speeds(*teeth, design.fixed)
    driver = DRIVING_MEMBER[design.fixed]
    rows: list[Row] = [("fixed", "fixed member", "", (design.fixed,))]
    rows += [
        ("w_s", f"turns of the sun per turn of the {driver}", "-", (turns.sun,)),
        ("w_p", "turns of the planets", "-", (turns.planet,)),
        ("w_p_c", "turns of the planets relative to the carrier", "-", (turns.relative,)),
        ("w_c", "turns of the carrier", "-", (turns.carrier,)),
        ("w_r", "turns of the ring", "-", (turns.ring,)),
    ]
    for fixed, driving in DRIVING_MEMBER.items():
        words = f"ratio, {fixed} fixed: speed of the {driving} over the {DRIVEN_MEMBER[fixed]}'s"
        rows.append((f"i_{fixed}", words, "-", (ratio(teeth[0], teeth[2], fixed),)))
    return rows


def _planet_share(design: PlanetaryDesign) -> float:
    """Return the teeth of sun and ring per planet."""
    return (design.sun.teeth + design.ring.teeth) / len(design.angles)


def _apart(design: PlanetaryDesign, distance: float, planet: Member) -> list[float]:
    """Return the gaps (mm) between the tips of every planet, as built, and the next; empty for a single planet."""
    land = planet.tooth.grid(Region.LAND, np.array([0.0, 1.0]), planet.tooth.sections([0.0, 0.5, 1.0])).points
    tip = float(np.hypot(land[..., 0], land[..., 1]).max())
    angles = [angle % 360.0 for angle in design.angles]
    if len(angles) < 2:
        return []
    # angle to the next planet around, in any order of the list
    steps = [min((other - angle) % 360.0 for other in angles if other != angle) for angle in angles]
    return [2.0 * distance * math.sin(math.radians(min(step, 360.0 - step)) / 2.0) - 2.0 * tip for step in steps]
