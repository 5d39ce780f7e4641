"""The nominal mesh of a cylindrical design, and the mesh with the allowances of the tooth thickness [ISO 21771]."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.geometry.allowances import made_allowance
from gearmesh.systems.cylindrical.geometry.geometry import (
    MAX_WORKING_ANGLE,
    InvolutePair,
    Toothing,
    distance_of,
    shifts_at_angle,
)
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember, ToothingKeys
    from gearmesh.systems.cylindrical.rack.design import RackTable
    from gearmesh.systems.cylindrical.rack.member import RackMesh

#: names of the members
MEMBER_NAMES = ("pinion", "gear")


@dataclass(frozen=True)
class ToothedGear:
    """A gear of a design, independent of its mating gear."""

    #: name of its table in the design
    table: str
    #: its name in texts
    name: str
    #: its table
    spec: CylindricalMember
    #: its teeth, with their allowance
    own: Toothing
    #: profile of its basic rack, a key of `PROFILES`
    profile: str


def toothed_gear(design: CylindricalDesign, name: str, mesh: InvolutePair) -> ToothedGear:
    """Return a member of a mesh whose teeth have the allowances of their thickness."""
    return ToothedGear(name, design.name_in_texts(name), getattr(design, name), getattr(mesh, name), design.profile)


def toothing(design: CylindricalDesign, name: str) -> Toothing:
    """Return the nominal teeth of a member; a profile shift that is still to be derived counts as 0."""
    ring = design.pinion.internal or design.gear.internal
    # two external gears have opposite hands; an internal gear has the hand of its mating gear
    hand = -1.0 if name == "gear" and not ring else 1.0
    return teeth_of(design, getattr(design, name), hand, drive=driving_side(name, inside=ring))


def driving_side(name: str, *, inside: bool) -> Side:
    """Return the flanks of a member on the drive side: the pinion's right flanks, or the flanks that touch them.

    `inside`: True if a member of the pair is internal.
    """
    return Side.LEFT if name == "gear" and inside else Side.RIGHT


def teeth_of(
    design: ToothingKeys,
    spec: CylindricalMember,
    hand: float = 1.0,
    allowance: float = 0.0,
    drive: Side = Side.RIGHT,
) -> Toothing:
    """Return the nominal teeth of the part `spec` of a design, with an `allowance` (mm).

    `hand`: -1 for the hand opposite to the pinion's. `drive`: flanks of the drive side.
    """
    return Toothing(
        teeth=spec.teeth,
        module=design.given_module,
        alpha=math.radians(design.normal_angle),
        beta=(1.0 if design.hand == "right" else -1.0) * hand * math.radians(design.helix_angle),
        shift=0.0 if math.isnan(spec.profile_shift) else spec.profile_shift,
        internal=spec.internal,
        allowance=allowance,
        coast_alpha=None if design.coast_angle is None else math.radians(design.coast_angle),
        drive=Side.RIGHT if design.coast_angle is None else drive,
    )


def nominal_mesh(design: CylindricalDesign) -> InvolutePair:
    """Return the nominal teeth at the given centre distance, or at the distance without backlash."""
    pinion, gear = (toothing(design, name) for name in MEMBER_NAMES)
    given = design.assembly.center_distance
    mesh = InvolutePair(pinion, gear, distance_of(pinion, gear) if given is None else given)
    least = mesh.least_distance
    if given is not None and given <= least:
        between = "difference" if pinion.internal or gear.internal else "sum"
        counts = ("pinion.teeth", pinion.teeth), ("gear.teeth", gear.teeth)
        numbers = ", ".join(f"{design.name_in_texts(key)} = {count}" for key, count in counts)
        raise DesignError(
            "assembly.center_distance",
            given,
            unit="mm",
            allowed=Allowed.more_than(least, "mm", f"the {between} of the base radii", note=f" with {numbers}"),
        )
    if math.isnan(mesh.distance):
        raise _no_working_angle(design, mesh)
    return mesh


def _no_working_angle(design: CylindricalDesign, mesh: InvolutePair) -> DesignError:
    """Return the refusal of profile shifts without a working pressure angle between 0 and MAX_WORKING_ANGLE."""
    shifts = [("pinion", mesh.pinion.shift), ("gear", mesh.gear.shift)]
    (first, own), (second, other) = shifts if design.sets("pinion.profile_shift") else shifts[::-1]
    ends = sorted(shifts_at_angle(mesh.pinion, mesh.gear, angle) for angle in (0.0, MAX_WORKING_ANGLE))
    return DesignError(
        design.name_in_texts(f"{first}.profile_shift"),
        own,
        reason=f"with {design.name_in_texts(second)}.profile_shift = {other:g} there is no working pressure angle",
        allowed=Allowed.between(ends[0] - other, ends[1] - other),
    )


def with_allowances(design: CylindricalDesign, nominal: InvolutePair) -> InvolutePair:
    """Return the mesh with the allowances of the tooth thickness, given or required by the wanted backlash."""
    wanted = wanted_backlash(design, nominal)
    if wanted is None:
        of_pinion, of_gear = (
            made_allowance(design.name_in_texts(name), getattr(design, name), getattr(nominal, name))
            for name in MEMBER_NAMES
        )
    else:
        # sum of both A_sn = (j_bn of the nominal teeth - j_bn) / cos(alpha_n), shared equally
        of_pinion = of_gear = 0.5 * (nominal.normal_backlash - wanted) / math.cos(nominal.pinion.alpha)
    return replace(
        nominal,
        pinion=replace(nominal.pinion, allowance=of_pinion),
        gear=replace(nominal.gear, allowance=of_gear),
    )


def wanted_backlash(design: ToothingKeys, nominal: InvolutePair | RackMesh) -> float | None:
    """Return the normal backlash that a design asks for, by either key; None if it asks for none."""
    if design.circumferential_backlash is not None:
        return design.circumferential_backlash * math.cos(nominal.working_angle) * math.cos(nominal.pinion.beta_b)
    return design.backlash if design.sets("backlash") else None


def refuse_thin(design: ToothingKeys, name: str, mesh: InvolutePair | RackMesh, thickness: float) -> None:
    """Refuse the allowance or backlash that leaves a member no tooth.

    `thickness`: the resulting tooth thickness (mm), zero or negative.
    """
    refuse_thin_allowance(design.name_in_texts(name), getattr(design, name), thickness)
    key = "backlash" if design.circumferential_backlash is None else "circumferential_backlash"
    # both allowances are equal, so that the backlash at which this tooth vanishes follows from its thickness
    most = mesh.normal_backlash + 2.0 * math.cos(mesh.pinion.alpha) * thickness
    if key != "backlash":
        most /= math.cos(mesh.working_angle) * math.cos(mesh.pinion.beta_b)
    raise DesignError(
        key,
        getattr(design, key),
        unit="mm",
        reason=f"leaves no tooth of the {design.name_in_texts(name)}",
        allowed=Allowed.less_than(most, "mm"),
    )


def refuse_thin_allowance(name: str, spec: CylindricalMember | RackTable, thickness: float) -> None:
    """Refuse the allowance of a part `spec`, if it has one, that leaves it no tooth.

    `thickness`: the resulting tooth thickness (mm), zero or negative.
    """
    key = spec.thickness_key
    if key is not None:
        given = getattr(spec, key).upper
        more = Allowed.more_than(given - thickness, "mm") if key == "thickness_allowance" else "more"
        raise DesignError(f"{name}.{key}.upper", given, unit="mm", reason="leaves no tooth", allowed=more)
