"""Cylindrical gears [ISO 21771]: members cut by a rack, a shaper cutter or, if internal, a form tool.

The fixed frame is the pinion's own: its axis is z, and the middle of both faces is at z = 0. The gear's axis is at x =
a, or at x = -a if the gear is internal. phi1 turns the pinion clockwise about +z. At phi1 = 0 a tooth of the pinion, or
a space if it is internal, is on the line between the axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import VagueError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.common.axes import shifts, tilts
from gearmesh.systems.common.bodies.tip_surface import with_tip_surface
from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.common.micro_geometry import with_modifications, with_true_involutes
from gearmesh.systems.common.racks.rack_member import Roll, member, rack_parameters
from gearmesh.systems.common.racks.rack_tooth import Heights
from gearmesh.systems.common.tooth_edges import with_end_chamfers
from gearmesh.systems.cylindrical.cutting.cutter import other_cutters, trimming_warnings
from gearmesh.systems.cylindrical.cutting.hobbed import hobbed_racks
from gearmesh.systems.cylindrical.cutting.run_out import run_outs
from gearmesh.systems.cylindrical.cutting.shaped import cuts_of, shaped_member
from gearmesh.systems.cylindrical.design import BASIC_RACKS
from gearmesh.systems.cylindrical.double_helical import HALF_NOTE, double_helical_member, half_of
from gearmesh.systems.cylindrical.geometry.geometry import distance_of, sum_of_shifts
from gearmesh.systems.cylindrical.geometry.interference import interference_warnings
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES, ToothedGear, refuse_thin
from gearmesh.systems.cylindrical.geometry.proportions import GearProportions, PairProportions, proportions
from gearmesh.systems.cylindrical.geometry.shifts import addendum
from gearmesh.systems.cylindrical.measured import check_measures
from gearmesh.systems.system import Displacements
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember

#: allowance of the tooth thickness (modules) from which on a warning says that teeth are thicker
MIN_WARNED_ALLOWANCE = 0.01


def build(design: CylindricalDesign) -> GearTrain:
    """Return the pair of a cylindrical design (in mm).

    Raises DesignError naming key, value and limit: no working pressure angle, teeth or cutters that cannot exist.
    """
    whole, design = design, half_of(design)
    geometry = proportions(design)
    members = [whole_member(whole, name, geometry) for name in MEMBER_NAMES]
    flank = Side(design.contact.flank)
    inside = design.pinion.internal or design.gear.internal
    pinion_mount, gear_mount = _mounts(design, geometry)
    pair = GearPair(
        pinion=replace(members[0], mount=pinion_mount),
        gear=replace(members[1], mount=gear_mount),
        flanks=(flank, flank.other if inside else flank),
        drive=flank.sign,
        ratio=design.pinion.teeth / design.gear.teeth,
        delta=design.contact.delta,
    )
    notes = (HALF_NOTE,) if whole.double_helical else ()
    return GearTrain(design.kind, (pair,), (*warnings_of(design, geometry), *notes))


def whole_member(design: CylindricalDesign, name: str, geometry: PairProportions) -> Member:
    """Return a member of a pair (in mm) without its mounting; a double helical member has both halves.

    `geometry`: proportions of `half_of` the design. Raises DesignError as `member_of` does.
    """
    half = member_of(design, name, geometry)
    return double_helical_member(design, half, geometry.gear(name)) if design.double_helical else half


def member_of(design: CylindricalDesign, name: str, geometry: PairProportions) -> Member:
    """Return a member of a pair (in mm) without its mounting.

    Raises DesignError for teeth or cutters that cannot exist.
    """
    gear = geometry.gear(name)
    if gear.own.thickness <= 0.0:
        refuse_thin(design, name, geometry.mesh, gear.own.thickness)
    return gear_member(gear)


def gear_member(gear: GearProportions) -> Member:
    """Return a gear (in mm) as a member without its mounting.

    Raises DesignError for teeth or cutters that cannot exist, and for spans and balls that do not touch them.
    """
    made = _toothed_member(gear)
    check_measures(gear, made)
    return with_end_chamfers(made, gear.spec)


def _toothed_member(gear: GearProportions) -> Member:
    """Return a gear as a member, before its measures are checked and its ends chamfered."""
    name, spec, own, tip, root = gear.name, gear.spec, gear.own, gear.tip, gear.root
    letter = "F" if gear.table == "pinion" else "G"
    tip_key = "tip_diameter" if spec.tip_diameter is not None else "addendum"
    if (tip - root) * own.sense <= 0.0:
        order = "larger" if own.internal else "smaller"
        raise VagueError(
            f"{name}.{tip_key}",
            reason=f"the root ({2 * root:.6g} mm) must be {order} than the tip ({2 * tip:.6g} mm)",
            allowed=f"{'less' if own.internal else 'more'} than {2 * root:.6g} mm" if tip_key == "tip_diameter" else "",
            remedies={f"{name}.{tip_key}": 0},
            excess=(root - tip) * own.sense,
        )
    if not spec.hobbed:
        made = shaped_member(name, spec, cuts_of(gear), own.drive, tip_key, f"theta_{letter}", f"u_{letter}")
        made = with_modifications(
            with_tip_surface(made, spec, tip), spec, internal=own.internal, reference_radius=own.radius
        )
        own_flanks = made.tooth.unmodified_tooth is made.tooth
        return with_true_involutes(made, internal=own.internal) if own_flanks else made
    racks = hobbed_racks(name, spec, own, Heights(tip - own.radius, root - own.radius))
    parameters = rack_parameters(f"l_{letter}", f"u_{letter}")
    way_out = run_outs(gear, racks)
    made = member(
        name, spec, racks, Roll(own.radius, own.beta, 0.0), parameters, tip_key, way_out=way_out, coast=own.drive.other
    )
    return with_modifications(with_tip_surface(made, spec, tip), spec, reference_radius=own.radius)


def _mounts(design: CylindricalDesign, geometry: PairProportions) -> tuple[Mount, Mount]:
    """Return the positions of both members.

    Errors move the gear in its own frame, parallel to the fixed frame, and then tilt its axis.
    """
    errors = design.assembly
    away = -1.0 if design.gear.internal else 1.0
    inside = design.pinion.internal or design.gear.internal
    origin = np.array([away * geometry.mesh.distance, 0.0, 0.0])
    offset = Rigid(np.eye(3), origin + np.array([errors.dx, errors.dy, errors.dz]))
    tilt = tilts(errors.gamma_h, errors.gamma_v)
    return Mount(Rigid.identity(), sign=-1.0), Mount(offset @ Rigid(tilt, np.zeros(3)), sign=-1.0 if inside else 1.0)


def _displaced_bases(design: CylindricalDesign, train: GearTrain, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
    """Return the positions of both members with assembly errors."""
    pinion, gear = (mount.base for mount in train.pairs[0].mounts)
    moved = gear.translation + shifts(errors["dx"], errors["dy"], errors["dz"])
    return pinion, Rigid(tilts(errors["gamma_h"], errors["gamma_v"]) @ gear.rotation, moved)


#: keys of the assembly errors, and the positions of the members with them
ASSEMBLY_DISPLACEMENTS = Displacements(("dx", "dy", "dz", "gamma_h", "gamma_v"), _displaced_bases)


def warnings_of(design: CylindricalDesign, geometry: PairProportions) -> tuple[str, ...]:
    """Return the warnings of a design: adapted defaults, interference of an internal gear, cutters."""
    standard = {key: value for gear in geometry.gears for key, value in standard_rounding(gear).items()}
    for name in ("pinion", "gear"):
        spec = getattr(design, name)
        if spec.internal and spec.tip_diameter is None:
            shortened = spec.addendum < addendum(design, name, geometry.nominal)
            why = own_end(spec) if shortened else "the mating gear's involute ends there"
            standard[f"{name}.addendum"] = (BASIC_RACKS[design.profile][0], why)
    return (
        *unusual_defaults(design, standard),
        *_thickness_warnings(geometry),
        *interference_warnings(
            geometry.mesh, geometry.tips, geometry.roots, [*map(design.name_in_texts, MEMBER_NAMES)]
        ),
        *other_cutters(geometry.gears),
        *trimming_warnings(geometry.gears),
    )


def own_end(spec: CylindricalMember) -> str:
    """Return the reason why the default tip of an internal gear does not depend on its mating gear."""
    return "its involute ends on the base circle" if spec.formed else "its cutter generates involute up to there"


def standard_rounding(gear: ToothedGear) -> dict[str, tuple[float, str]]:
    """Return the rounding of the profile, and the reason for another default, by its key."""
    return {f"{gear.table}.tool_tip_radius": (BASIC_RACKS[gear.profile][2], "the tool's tooth has no room for it")}


def _thickness_warnings(geometry: PairProportions) -> tuple[str, ...]:
    """Return the warning of teeth that the given backlash makes thicker than their profile shifts do."""
    nominal, allowance = geometry.nominal, geometry.mesh.pinion.allowance
    if allowance <= MIN_WARNED_ALLOWANCE * nominal.pinion.module or allowance != geometry.mesh.gear.allowance:
        return ()
    tight_distance = distance_of(nominal.pinion, nominal.gear)
    needed_shifts = sum_of_shifts(nominal.pinion, nominal.gear, nominal.distance)
    return (
        f"teeth are {allowance:.4g} mm thicker than by their profile shifts, for the given backlash: with these shifts "
        f"the centre distance without backlash is {tight_distance:.7g} mm; "
        f"for {nominal.distance:g} mm the sum of the profile shifts must be {needed_shifts:.4g}",
    )
