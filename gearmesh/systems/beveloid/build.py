"""Beveloid (conical involute) gears on intersected, crossed and parallel axes [LT02]; cone angle 0: involute gears.

The frame S_1 = S_f is the pinion's, with the pitch point Q = (r1, 0, 0). The common imaginary rack has its normal X_T =
(cos d1, 0, -sin d1), Y_T = y_f and Z_T = (sin d1, 0, cos d1). phi1 turns the pinion clockwise about +z.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL, Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, rotation_about
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.systems.beveloid.design import STANDARD_TIP_RADIUS
from gearmesh.systems.beveloid.ring import ring
from gearmesh.systems.beveloid.sheet import involute
from gearmesh.systems.common.axes import shifts, tilts
from gearmesh.systems.common.backlash import thin
from gearmesh.systems.common.bodies.tip_surface import with_tip_surface
from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.common.micro_geometry import with_modifications
from gearmesh.systems.common.racks.rack_member import Roll, member, rack_parameters
from gearmesh.systems.common.racks.rack_tooth import Heights, RackTooth, round_tips, tip_roundings
from gearmesh.systems.common.tooth_edges import with_end_chamfers
from gearmesh.systems.system import Displacements
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side
from gearmesh.tools.rack import RackLine

if TYPE_CHECKING:
    from gearmesh.systems.beveloid.design import BeveloidDesign, BeveloidMember

#: largest working pressure angle (rad) that is searched
MAX_WORKING_ANGLE = 1.5


def build(design: BeveloidDesign) -> GearTrain:
    """Return the pair of a beveloid design (in mm).

    Raises DesignError for teeth that cannot exist (see `rack_member.member`). It is also raised for a centre distance
    on axes that are not parallel, or too small to have a working pressure angle.
    """
    module = design.given_module
    members, rolls = [], []
    for name, letter, spec in (("pinion", "F", design.pinion), ("gear", "G", design.gear)):
        helix, cone = np.radians(spec.helix_angle), np.radians(spec.cone_angle)
        roll = Roll(0.5 * spec.teeth * module / np.cos(helix), helix, cone)
        tip_key, angles = "tip_diameter" if spec.tip_diameter is not None else "addendum", design.pressure_angles(name)
        # u of a gear that is turned over is counted along its reversed axis [LT02 Table 4]
        along = -1.0 if name == "gear" and design.assembly.turned_over else 1.0
        if spec.internal:
            made = ring(name, spec, module, angles, design.reduction, design.coast_flanks(name))
        else:
            racks = _rack(name, spec, design, roll)
            made = member(
                name,
                spec,
                racks,
                roll,
                rack_parameters(f"l_{letter}", f"u_{letter}", along),
                tip_key,
                coast=design.coast_flanks(name),
            )
        reference_radius = None if cone else roll.radius
        made = with_modifications(
            with_tip_surface(made, spec), spec, internal=spec.internal, reference_radius=reference_radius
        )
        members.append(with_end_chamfers(made, spec))
        rolls.append(roll)
    flank = Side(design.contact.flank)
    pair = GearPair(
        pinion=replace(members[0], mount=Mount(Rigid.identity(), sign=-1.0)),
        gear=replace(members[1], mount=_gear_mount(design, rolls[0], rolls[1])),
        flanks=(flank, flank.other if design.crosswise else flank),
        drive=flank.sign,
        ratio=design.pinion.teeth / design.gear.teeth,
        delta=design.contact.delta,
    )
    return GearTrain(design.kind, (pair,), _warnings(design))


def _warnings(design: BeveloidDesign) -> tuple[str, ...]:
    """Return the warnings about adapted defaults."""
    why = "the rack's tooth has no room for it"
    return unusual_defaults(
        design, {f"{name}.tool_tip_radius": (STANDARD_TIP_RADIUS, why) for name in ("pinion", "gear")}
    )


def _rack(name: str, spec: BeveloidMember, design: BeveloidDesign, roll: Roll) -> tuple[RackTooth, RackTooth]:
    """Return both sides of the standard rack's space, shifted by x m_n.

    Each of the pair's four flanks is set back by a quarter of the backlash, which is normal to the drive flanks.
    """
    module = design.given_module
    shift = spec.profile_shift * module
    half_thickness = thin(0.25 * np.pi * module, design.backlash, 0.25, np.radians(design.pressure_angle))
    tip_height = shift + spec.addendum * module
    root_height = shift - spec.dedendum * module
    if spec.tip_diameter is not None:
        tip_height = (0.5 * spec.tip_diameter - roll.radius) * np.cos(roll.cone)
    if spec.root_diameter is not None:
        root_height = (0.5 * spec.root_diameter - roll.radius) * np.cos(roll.cone)
    if root_height >= tip_height:
        key = (
            "tip_diameter"
            if spec.tip_diameter is not None
            else "root_diameter"
            if spec.root_diameter is not None
            else "dedendum"
        )
        raise DesignError(
            f"{name}.{key}",
            reason=f"the root ({2 * (roll.radius + root_height / np.cos(roll.cone)):.6g} mm) must be smaller than the "
            f"tip ({2 * (roll.radius + tip_height / np.cos(roll.cone)):.6g} mm)",
        )
    heights = Heights(tip_height, root_height)
    right, left = (RackLine(np.radians(angle), module, half_thickness, shift) for angle in design.pressure_angles(name))
    return round_tips(name, spec, module, (right, left), heights, tip_roundings(spec, design.coast_flanks(name)))


def _gear_mount(design: BeveloidDesign, pinion: Roll, gear: Roll) -> Mount:
    """Return the position of the gear.

    Helix angles that add up to more than 90 deg do not turn the gear over: its axis only passes 90 deg.
    """
    errors, inside = design.assembly, design.gear.internal
    angle = pinion.helix + design.gear.sense * gear.helix + (np.pi if errors.turned_over else 0.0)
    d1, d2 = pinion.cone, gear.cone
    x_t, y_t, z_t = np.array([np.cos(d1), 0, -np.sin(d1)]), np.array([0.0, 1, 0]), np.array([np.sin(d1), 0, np.cos(d1)])
    # the gear's rack is the common rack seen from the other side, turned about its normal by the helix angles; an
    # internal gear sees it from the same side
    x_rack = x_t if inside else -x_t
    z_rack = np.cos(angle) * z_t + np.sin(angle) * y_t
    y_rack = cross(z_rack, x_rack)
    axes = np.stack(
        (np.cos(d2) * x_rack + np.sin(d2) * z_rack, y_rack, np.cos(d2) * z_rack - np.sin(d2) * x_rack), axis=-1
    )
    shift = (design.pinion.profile_shift + design.gear.profile_shift) * design.given_module
    # the pitch planes of shifted racks are apart by the profile shifts
    origin = np.array([pinion.radius, 0.0, 0.0]) - gear.radius * axes[:, 0] + shift * x_t
    parallel = math.hypot(axes[0, 2], axes[1, 2]) < MAX_SINE_OF_PARALLEL
    if errors.center_distance is not None and not parallel:
        raise DesignError(
            "assembly.center_distance", errors.center_distance, reason="allowed only where the axes are parallel"
        )
    if parallel:
        origin = _parallel_origin(design, pinion, gear, origin)
    # [LT02 Fig. 5] errors are given in S_g: the gear's frame turned by 180 deg about its axis, and over with the gear
    to_fixed = Rigid(axes, origin) @ Rigid.about_z(0.0 if inside else np.pi)
    over = Rigid(rotation_about("x", np.pi if errors.turned_over else 0.0), np.zeros(3))
    offset = Rigid(np.eye(3), np.array([errors.dx, errors.dy, errors.dz]))
    tilt = tilts(errors.gamma_h, errors.gamma_v)
    base = to_fixed @ over @ offset @ Rigid(tilt, np.zeros(3)) @ over
    return Mount(base, sign=-1.0 if errors.turned_over or inside else 1.0)


def _displaced_bases(design: BeveloidDesign, train: GearTrain, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
    """Return the positions of both members with assembly errors."""
    pinion, gear = (mount.base for mount in train.pairs[0].mounts)
    over = Rigid(rotation_about("x", np.pi if design.assembly.turned_over else 0.0), np.zeros(3))
    offset = Rigid(tilts(errors["gamma_h"], errors["gamma_v"]), shifts(errors["dx"], errors["dy"], errors["dz"]))
    return pinion, gear @ over @ offset @ over


#: keys of the assembly errors, and the positions of the members with them
ASSEMBLY_DISPLACEMENTS: Displacements[BeveloidDesign] = Displacements(
    ("dx", "dy", "dz", "gamma_h", "gamma_v"), _displaced_bases
)


def _no_working_angle(
    design: BeveloidDesign, reason: str, *, least: float | None = None, most: float | None = None
) -> DesignError:
    """Return the refusal of the profile shift that is set first.

    The sum of both shifts must be more than `least` or less than `most`.
    """
    shifts = [("pinion", design.pinion.profile_shift), ("gear", design.gear.profile_shift)]
    (named, shift), (other_member, other_shift) = (
        shifts if "profile_shift" in design.pinion.model_fields_set else shifts[::-1]
    )
    reason_begin = f"with {other_member}.profile_shift = {other_shift:g}"
    allowed = "" if least is None else Allowed.more_than(least - other_shift)
    allowed = allowed if most is None else Allowed.less_than(most - other_shift)
    return DesignError(f"{named}.profile_shift", shift, reason=f"{reason_begin} {reason}", allowed=allowed)


def _parallel_origin(design: BeveloidDesign, pinion: Roll, gear: Roll, origin: Array) -> Array:
    """Return the origin of the gear on parallel axes.

    The axes are at the given centre distance. Cylindrical gears without one are at the distance without backlash [ISO
    21771].
    """
    given = design.assembly.center_distance
    if given is None and (pinion.cone or gear.cone):
        return origin
    sense = design.gear.sense
    reference = abs(pinion.radius + sense * gear.radius)
    teeth = design.pinion.teeth + sense * design.gear.teeth
    tangents = np.tan(np.radians(design.pressure_angles("pinion")))
    transverse = np.arctan(tangents / np.cos(pinion.helix))
    cosines, nominal, steepness = np.cos(transverse), float(involute(transverse).sum()), float(tangents.sum())
    # the flanks of the smaller angle have the larger base circles, which touch first
    flattest = float(cosines.max())
    if given is None:
        shifts = design.pinion.profile_shift + design.gear.profile_shift

        def involutes(working: Array) -> Array:
            """Return the sums of inv(alpha_wt) of both sides, by the working angles (K,) of the side that touches first."""
            return np.asarray(involute(np.arccos(cosines * np.cos(working)[..., None] / flattest)).sum(axis=-1))

        # both sides without backlash: sum of inv(alpha_wt) = sum of inv(alpha_t) + 2 (x1 + x2) / (z1 + z2) sum of tan(alpha_n)
        wanted = nominal + 2.0 * shifts * steepness / teeth
        least, most = (float(involutes(np.array([angle]))[0]) for angle in (0.0, MAX_WORKING_ANGLE))
        bounds = [0.5 * (end - nominal) * teeth / steepness for end in (least, most)]
        if wanted <= least:
            ends = (bounds[0], None) if sense > 0 else (None, bounds[0])
            raise _no_working_angle(design, "there is no working pressure angle", least=ends[0], most=ends[1])
        working = bracketed_root(lambda a, _: involutes(a) - wanted, np.zeros(1), np.array([MAX_WORKING_ANGLE]))
        if not working.converged[0]:
            above = f"the working pressure angle would be above {np.degrees(MAX_WORKING_ANGLE):.4g} deg"
            ends = (None, bounds[1]) if sense > 0 else (bounds[1], None)
            raise _no_working_angle(design, above, least=ends[0], most=ends[1])
        given = reference * flattest / np.cos(float(working.values[0]))
    elif given <= reference * flattest and not (pinion.cone or gear.cone):
        raise DesignError(
            "assembly.center_distance",
            given,
            unit="mm",
            allowed=Allowed.more_than(
                reference * flattest,
                "mm",
                f"the {'sum' if sense > 0 else 'difference'} of the base radii",
                note=f" with pinion.teeth = {design.pinion.teeth}, gear.teeth = {design.gear.teeth}",
            ),
        )
    return np.array([sense * given, 0.0, origin[2]])


def pinned_values(design: BeveloidDesign, train: GearTrain) -> dict[str, float]:
    """Return the distance of parallel axes of a complete design in mm, which its build derives by default."""
    no_errors = design.assembly.model_copy(update=dict.fromkeys(ASSEMBLY_DISPLACEMENTS.keys, 0.0))
    pinion_base, gear_base = (
        mount.base for mount in build(design.model_copy(update={"assembly": no_errors})).pairs[0].mounts
    )
    if math.hypot(gear_base.rotation[0, 2], gear_base.rotation[1, 2]) >= MAX_SINE_OF_PARALLEL:
        return {}
    return {"assembly.center_distance": abs(float(gear_base.translation[0] - pinion_base.translation[0]))}
