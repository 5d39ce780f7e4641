"""Planetary gear sets: two cylindrical meshes that share the planet, and planets around the sun [ISO 21771].

The fixed frame is the carrier's: z is along the common axis, and planet 1 is on +x unless the design says otherwise. In
this frame sun, planets and ring turn about fixed axes. phi1 of a mesh counts the sun clockwise about +z, or the planet
counterclockwise.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.records import dataclass
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.cylindrical.build import warnings_of, whole_member
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.double_helical import HALF_NOTE, half_of
from gearmesh.systems.cylindrical.geometry import proportions as closed
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES, wanted_backlash
from gearmesh.systems.cylindrical.parts import completed_pair, is_given, nest, shared_keys
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign

#: largest distance, in teeth, of a planet from a position at which it can be assembled
ASSEMBLY_TOLERANCE_TEETH = 1e-6


class InnerMesh(CylindricalDesign):
    """Sun and planet as a cylindrical pair."""

    other_names: ClassVar[Mapping[str, str]] = {"pinion": SUN_NAME, "gear": PLANET_NAME}


class OuterMesh(CylindricalDesign):
    """Planet and ring as a cylindrical pair."""

    other_names: ClassVar[Mapping[str, str]] = {"pinion": PLANET_NAME, "gear": RING_NAME}


@dataclass(frozen=True)
class Meshes:
    """The meshes of a set as designs of cylindrical pairs: sun with planet, planet with ring."""

    inner: InnerMesh
    outer: OuterMesh


def meshes(design: PlanetaryDesign) -> Meshes:
    """Return both meshes as complete designs.

    Raises DesignError, with the names of the set, for a mesh that cannot exist.
    """
    own, shared = dict(design.own()), shared_keys(design)
    distance, allowance = design.assembly.center_distance, design.assembly.center_distance_allowance
    tolerated = {} if allowance is None else {"center_distance_allowance": allowance}
    # sun and planet as a pair, with the centre distance and the backlash of the set
    inner = {
        **shared,
        "hand": design.hand,
        **nest(own, {SUN_NAME: "pinion", PLANET_NAME: "gear"}),
        "assembly": tolerated if distance is None else {"center_distance": distance, **tolerated},
        **{key: getattr(design, key) for key in ("backlash", "circumferential_backlash") if is_given(design, key)},
    }
    inner_pair = completed_pair(InnerMesh, inner)
    geometry = closed.proportions(inner_pair)
    planet = inner_pair.gear.plain()
    middle = geometry.mesh.gear.allowance
    # the planet is as thick as in its mesh with the sun; the ring gets the rest of the wanted backlash
    if inner_pair.gear.thickness_key is None:
        planet["thickness_allowance"] = {"upper": middle, "lower": middle}
    outer = {
        **shared,
        "hand": "left" if design.hand == "right" else "right",
        "pinion": planet,
        **nest(own, {RING_NAME: "gear"}),
        "assembly": {"center_distance": geometry.mesh.distance, **tolerated},
    }
    outer["gear"].setdefault("internal", True)
    _check_ring(design, geometry.mesh)
    outer_pair = completed_pair(OuterMesh, outer)
    ring = closed.proportions(outer_pair)
    # the thickness of the ring gives its mesh the same normal backlash
    wanted = wanted_backlash(design, ring.nominal)
    if wanted is not None:
        rest = (ring.mesh.normal_backlash - wanted) / math.cos(ring.mesh.pinion.alpha)
        outer["gear"] = {**outer["gear"], "thickness_allowance": {"upper": rest, "lower": rest}}
        outer_pair = completed_pair(OuterMesh, outer)
    return Meshes(inner_pair, outer_pair)


def _check_ring(design: PlanetaryDesign, mesh: InvolutePair) -> None:
    """Refuse a ring so large that its planets cannot reach it at the centre distance of sun and planet."""
    largest_cosine = max(math.cos(side.alpha_t) for side in mesh.gear.sides)
    of_teeth = 2.0 * mesh.distance / (mesh.gear.transverse_module * largest_cosine)
    most = math.ceil(design.planet.teeth + of_teeth) - 1
    if design.ring.teeth > most:
        raise DesignError(
            "ring.teeth",
            design.ring.teeth,
            reason="no working pressure angle with the planet at the centre distance of sun and planet, "
            f"{mesh.distance:.7g} mm",
            allowed=Allowed.at_most(most),
        )


def derived_values(design: PlanetaryDesign) -> dict[str, float]:
    """Return the values of keys left out in the file that follow from the meshes, by dotted key.

    Values are in the design's units.
    """
    both = meshes(design)
    tables = {SUN_NAME: both.inner.pinion, PLANET_NAME: both.inner.gear, RING_NAME: both.outer.gear}
    values = {
        f"{name}.{key}": value
        for name, member in tables.items()
        for key, value in member.plain().items()
        if isinstance(value, float)
    }
    values["backlash"] = closed.proportions(both.inner).mesh.normal_backlash
    return closed.still_open(design, values)


def build(design: PlanetaryDesign) -> GearTrain:
    """Return the set of a planetary design (in mm): sun, planets and ring in mesh.

    Raises DesignError naming key, value and limit: teeth that cannot exist, planets that cannot be assembled or
    collide.
    """
    both = meshes(design)
    halves = half_of(both.inner), half_of(both.outer)
    inner, outer = (closed.proportions(half) for half in halves)
    _check_assembly(design, inner.mesh.distance, inner.tips[1])
    sun, planet = (whole_member(both.inner, which, inner) for which in MEMBER_NAMES)
    ring = whole_member(both.outer, "gear", outer)
    # on double helical gears, halves of different widths have different middles
    of_planet = halves[0].assembly.dz
    of_ring = of_planet + halves[1].assembly.dz
    flank = Side(design.contact.flank)
    angles = np.radians(design.angles)
    made: list[GearPair] = []
    for k, angle in enumerate(angles):
        place = Rigid.about_z(angle) @ Rigid(np.eye(3), np.array([inner.mesh.distance, 0.0, of_planet]))
        own = replace(planet, name=f"{PLANET_NAME}_{k + 1}", mount=Mount(place), idler=True)
        made.append(
            GearPair(
                pinion=replace(sun, mount=Mount(_facing(angle, design.sun.teeth), sign=-1.0)),
                gear=own,
                flanks=(flank, flank),
                drive=flank.sign,
                ratio=design.sun.teeth / design.planet.teeth,
                delta=design.contact.delta,
            )
        )
    for k, angle in enumerate(angles):
        made.append(
            GearPair(
                pinion=made[k].gear,
                gear=replace(ring, mount=Mount(_facing(angle, design.ring.teeth, of_ring))),
                flanks=(flank.other, flank),
                drive=flank.sign,
                ratio=design.planet.teeth / design.ring.teeth,
                delta=design.contact.delta,
            )
        )
    warnings = dict.fromkeys([*warnings_of(halves[0], inner), *warnings_of(halves[1], outer), *_snap_notes(design)])
    if design.double_helical:
        warnings[HALF_NOTE] = None
    return GearTrain(design.kind, tuple(made), tuple(warnings), (*[0] * len(angles), *[len(angles)] * len(angles)))


def _facing(angle: float, teeth: int, along: float = 0.0) -> Rigid:
    """Return the position of a central gear `along` the axis (mm), turned by whole pitches.

    Its first tooth is then nearest to an angle (rad).
    """
    pitch = 2.0 * math.pi / teeth
    return Rigid(np.eye(3), np.array([0.0, 0.0, along])) @ Rigid.about_z(round(angle / pitch) * pitch)


def _check_assembly(design: PlanetaryDesign, distance: float, tip: float) -> None:
    """Refuse planets that cannot be assembled with sun and ring, and planets that touch each other."""
    total = design.sun.teeth + design.ring.teeth
    for angle in design.angles:
        teeth = total * (angle - design.angles[0]) / 360.0
        if abs(teeth - round(teeth)) > ASSEMBLY_TOLERANCE_TEETH:
            if design.assembly.planet_angles is None:
                raise DesignError(
                    "planets",
                    design.planets,
                    reason=f"{design.sun.teeth} + {design.ring.teeth} teeth cannot be shared evenly",
                    allowed=f"{_divisors(total)} planets, or assembly.planet_angles in whole steps of {360.0 / total:.6g} deg",
                )
            raise DesignError(
                "assembly.planet_angles",
                angle,
                reason="the planet cannot be assembled",
                allowed=f"a whole step of {360.0 / total:.6g} deg from the first, the nearest is "
                f"{design.angles[0] + 360.0 * round(teeth) / total:.10g}",
            )
    # distance of neighbouring axes is the chord of their angle; tips must leave a gap
    order = sorted(angle % 360.0 for angle in design.angles)
    for k in range(len(order) if len(order) > 1 else 0):
        step = (order[(k + 1) % len(order)] - order[k]) % 360.0
        apart = 2.0 * distance * math.sin(math.radians(min(step, 360.0 - step)) / 2.0) - 2.0 * tip
        if apart <= 0.0:
            least = 2.0 * math.degrees(math.asin(min(1.0, tip / distance)))
            key = "planets" if design.assembly.planet_angles is None else "assembly.planet_angles"
            value = design.planets if key == "planets" else design.assembly.planet_angles
            raise DesignError(
                key,
                value,
                reason=f"tips of neighbouring planets are {-apart:.4g} mm too close",
                allowed=f"at least {at_least(least)} deg from planet to planet",
            )


def _snap_notes(design: PlanetaryDesign) -> Iterator[str]:
    """Yield a note on angles of planets that are moved to positions of assembly."""
    if design.assembly.planet_angles is None:
        return
    moved = [(given, taken) for given, taken in design.angles_taken if given != taken]
    if moved:
        given, taken = (", ".join(f"{angle:.10g}" for angle in angles) for angles in zip(*moved, strict=True))
        yield f"assembly.planet_angles: {given} deg: taken as {taken} deg, where planets can be assembled"


def _divisors(total: int) -> str:
    """Return the numbers of planets, as text, that share a number of teeth evenly."""
    divisors = [str(n) for n in range(2, 13) if total % n == 0]
    return ", ".join(divisors) if divisors else "no equal"
