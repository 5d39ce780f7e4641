"""Cylindrical gears [ISO 21771]: external members by a rack or a shaper cutter, internal ones by a shaper cutter
or a form tool.

Fixed frame: the pinion's own, its axis z, the middle of both faces at z = 0; the gear's axis is at x = a, or at x = -a where one of
the two is internal and the pinion the smaller one. phi1 turns the pinion clockwise about +z; at phi1 = 0 one of its teeth, or of
its spaces if it is internal, is on the line between the axes.
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
from gearmesh.systems.common.racks.rack_member import Roll, member
from gearmesh.systems.common.racks.rack_tooth import Heights
from gearmesh.systems.common.tooth_edges import with_end_chamfers
from gearmesh.systems.cylindrical.cutting.cutter import other_cutters, trimming_warnings
from gearmesh.systems.cylindrical.cutting.hobbed import hobbed_racks
from gearmesh.systems.cylindrical.cutting.shaped import cut_of, shaped_member
from gearmesh.systems.cylindrical.design import PROFILES
from gearmesh.systems.cylindrical.double_helical import HALF, double_helical_member, half_of
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
THICKER = 0.01


def build(design: CylindricalDesign) -> GearTrain:
    """The pair of a cylindrical design (in mm).

    Raises DesignError naming key, value and limit: no working pressure angle, teeth or cutters that cannot exist.
    """
    whole, design = design, half_of(design)
    geometry = proportions(design)
    members = [whole_member(whole, name, geometry) for name in MEMBER_NAMES]
    flank = Side(design.contact.flank)
    inside = design.pinion.internal or design.gear.internal
    first, second = _mounts(design, geometry)
    pair = GearPair(
        pinion=replace(members[0], mount=first),
        gear=replace(members[1], mount=second),
        flanks=(flank, flank.other if inside else flank),
        drive=flank.sign,
        ratio=design.pinion.teeth / design.gear.teeth,
        delta=design.contact.delta,
    )
    said = (HALF,) if whole.double_helical else ()
    return GearTrain(design.kind, (pair,), (*warnings_of(design, geometry), *said))


def whole_member(design: CylindricalDesign, name: str, geometry: PairProportions) -> Member:
    """A member of a pair (in mm), of a double helical one both halves, without its mounting; `geometry`: that of `half_of` it.

    Raises DesignError as `member_of`.
    """
    half = member_of(design, name, geometry)
    return double_helical_member(design, half, geometry.gear(name)) if design.double_helical else half


def member_of(design: CylindricalDesign, name: str, geometry: PairProportions) -> Member:
    """A member of a pair (in mm), without its mounting. Raises DesignError for teeth or cutters that cannot exist."""
    gear = geometry.gear(name)
    if gear.own.thickness <= 0.0:
        refuse_thin(design, name, geometry.mesh, gear.own.thickness)
    return gear_member(gear)


def gear_member(gear: GearProportions) -> Member:
    """A gear (in mm) as a member, without its mounting. Raises DesignError for teeth or cutters that cannot exist, and for spans
    and balls that do not touch them."""
    made = _toothed_member(gear)
    check_measures(gear, made)
    return with_end_chamfers(made, gear.spec)


def _toothed_member(gear: GearProportions) -> Member:
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
        )
    if not spec.hobbed:
        made = shaped_member(name, spec, cut_of(gear), tip_key, f"theta_{letter}", f"u_{letter}")
        made = with_modifications(with_tip_surface(made, spec, tip), spec, internal=own.internal)
        own_flanks = made.tooth.unmodified_tooth is made.tooth
        return with_true_involutes(made, internal=own.internal) if own_flanks else made
    racks = hobbed_racks(name, spec, own, Heights(tip - own.radius, root - own.radius))

    def source_parameters(p: Array, v: Array) -> dict[str, Array]:
        return {f"l_{letter}": p, f"u_{letter}": v}

    made = member(name, spec, racks, Roll(own.radius, own.beta, 0.0), source_parameters, tip_key)
    return with_modifications(with_tip_surface(made, spec, tip), spec)


def _mounts(design: CylindricalDesign, geometry: PairProportions) -> tuple[Mount, Mount]:
    """Positions of both: errors move the gear in its own frame, parallel to the fixed one, and then tilt its axis."""
    errors = design.assembly
    away = -1.0 if design.gear.internal else 1.0
    inside = design.pinion.internal or design.gear.internal
    origin = np.array([away * geometry.mesh.distance, 0.0, 0.0])
    offset = Rigid(np.eye(3), origin + np.array([errors.dx, errors.dy, errors.dz]))
    tilt = tilts(errors.gamma_h, errors.gamma_v)
    return Mount(Rigid.identity(), sign=-1.0), Mount(offset @ Rigid(tilt, np.zeros(3)), sign=-1.0 if inside else 1.0)


def _displaced_bases(design: CylindricalDesign, train: GearTrain, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
    pinion, gear = (mount.base for mount in train.pairs[0].mounts)
    moved = gear.translation + shifts(errors["dx"], errors["dy"], errors["dz"])
    return pinion, Rigid(tilts(errors["gamma_h"], errors["gamma_v"]) @ gear.rotation, moved)


DISPLACEMENTS = Displacements(("dx", "dy", "dz", "gamma_h", "gamma_v"), _displaced_bases)


def warnings_of(design: CylindricalDesign, geometry: PairProportions) -> tuple[str, ...]:
    """Warnings about a design: adapted defaults, interference of an internal gear."""
    standard = {key: value for gear in geometry.gears for key, value in standard_rounding(gear).items()}
    for name in ("pinion", "gear"):
        spec = getattr(design, name)
        if spec.internal and spec.tip_diameter is None:
            shortened = spec.addendum < addendum(design, name, geometry.nominal)
            why = own_end(spec) if shortened else "the mating gear's involute ends there"
            standard[f"{name}.addendum"] = (PROFILES[design.profile][0], why)
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
    """Why the default tip of an internal gear stays where it does, whatever gear it meshes with."""
    return "its involute ends on the base circle" if spec.formed else "its cutter generates involute up to there"


def standard_rounding(gear: ToothedGear) -> dict[str, tuple[float, str]]:
    """The rounding of the profile, and why a default may be another, by the key of a gear's."""
    return {f"{gear.table}.tool_tip_radius": (PROFILES[gear.profile][2], "the tool's tooth has no room for it")}


def _thickness_warnings(geometry: PairProportions) -> tuple[str, ...]:
    """A warning of teeth that the given backlash makes thicker than their profile shifts do."""
    nominal, more = geometry.nominal, geometry.mesh.pinion.allowance
    if more <= THICKER * nominal.pinion.module or more != geometry.mesh.gear.allowance:
        return ()
    own = distance_of(nominal.pinion, nominal.gear)
    wanted = sum_of_shifts(nominal.pinion, nominal.gear, nominal.distance)
    return (
        f"teeth are {more:.4g} mm thicker than by their profile shifts, for the given backlash: with these shifts the centre "
        f"distance without backlash is {own:.7g} mm; for {nominal.distance:g} mm the sum of the profile shifts must "
        f"be {wanted:.4g}",
    )
