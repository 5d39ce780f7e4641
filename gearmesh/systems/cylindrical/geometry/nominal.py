"""The nominal mesh of a cylindrical design, and the one that allowances of the tooth thickness make of it [ISO 21771]."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.cylindrical.geometry.allowances import made_allowance
from gearmesh.systems.cylindrical.geometry.geometry import STEEPEST, InvolutePair, Toothing, distance_of, involute

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember, ToothingKeys
    from gearmesh.systems.cylindrical.rack.design import RackTable
    from gearmesh.systems.cylindrical.rack.member import RackMesh

#: Names of the members.
MEMBERS = ("pinion", "gear")


@dataclass(frozen=True)
class ToothedGear:
    """A gear as a design says it, whatever it meshes with: its table, its name in texts, its part `spec` of the design, its teeth
    with their allowance, and the profile of its basic rack."""

    table: str
    name: str
    spec: CylindricalMember
    own: Toothing
    profile: str


def toothed_gear(design: CylindricalDesign, name: str, mesh: InvolutePair) -> ToothedGear:
    """A member of a mesh, which has the allowances of the thicknesses."""
    return ToothedGear(name, design.name_in_texts(name), getattr(design, name), getattr(mesh, name), design.profile)


def toothing(design: CylindricalDesign, name: str) -> Toothing:
    """The nominal teeth of a member; its profile shift 0 where that is still to be derived."""
    ring = design.pinion.internal or design.gear.internal
    # two external gears have opposite hands, an internal one that of its mating gear
    return teeth_of(design, getattr(design, name), -1.0 if name == "gear" and not ring else 1.0)


def teeth_of(design: ToothingKeys, spec: CylindricalMember, hand: float = 1.0, allowance: float = 0.0) -> Toothing:
    """The teeth of a part `spec` of a design, nominal but for an `allowance` (mm); `hand` -1: of the other hand than the pinion."""
    return Toothing(
        teeth=spec.teeth,
        module=design.given_module,
        alpha=math.radians(design.normal_angle),
        beta=(1.0 if design.hand == "right" else -1.0) * hand * math.radians(design.helix_angle),
        shift=0.0 if math.isnan(spec.profile_shift) else spec.profile_shift,
        internal=spec.internal,
        allowance=allowance,
    )


def nominal_mesh(design: CylindricalDesign) -> InvolutePair:
    """Nominal teeth at the centre distance asked for, or at the one without backlash."""
    pinion, gear = (toothing(design, name) for name in MEMBERS)
    given = design.assembly.center_distance
    mesh = InvolutePair(pinion, gear, distance_of(pinion, gear) if given is None else given)
    least = mesh.reference_distance * math.cos(pinion.alpha_t)
    if given is not None and given <= least:
        between = "difference" if pinion.internal or gear.internal else "sum"
        raise DesignError(
            "assembly.center_distance",
            given,
            unit="mm",
            allowed=f"more than the {between} of the base radii, {at_least(least)} mm with "
            f"{design.name_in_texts('pinion.teeth')} = {pinion.teeth}, {design.name_in_texts('gear.teeth')} = {gear.teeth}",
        )
    if math.isnan(mesh.distance):
        raise _no_working_angle(design, mesh)
    return mesh


def _no_working_angle(design: CylindricalDesign, mesh: InvolutePair) -> DesignError:
    """The refusal where profile shifts leave no working pressure angle between 0 and STEEPEST."""
    shifts = [("pinion", mesh.pinion.shift), ("gear", mesh.gear.shift)]
    (first, own), (second, other) = shifts if design.sets("pinion.profile_shift") else shifts[::-1]
    signed = mesh.pinion.signed_teeth + mesh.gear.signed_teeth
    ends = sorted(
        signed * (end - involute(mesh.pinion.alpha_t)) / (2.0 * math.tan(mesh.pinion.alpha))
        for end in (0.0, involute(STEEPEST))
    )
    return DesignError(
        design.name_in_texts(f"{first}.profile_shift"),
        own,
        reason=f"with {design.name_in_texts(second)}.profile_shift = {other:g} there is no working pressure angle",
        allowed=f"between {at_least(ends[0] - other)} and {at_most(ends[1] - other)}",
    )


def with_allowances(design: CylindricalDesign, nominal: InvolutePair) -> InvolutePair:
    """Both members with the allowances of their thickness: as given, or what the backlash that is wanted asks for."""
    wanted = wanted_backlash(design, nominal)
    if wanted is None:
        first, second = (
            made_allowance(design.name_in_texts(name), getattr(design, name), getattr(nominal, name))
            for name in MEMBERS
        )
    else:
        # sum of the A_sn = (j_bn of the nominal teeth - j_bn) / cos(alpha_n)
        first = second = 0.5 * (nominal.normal_backlash - wanted) / math.cos(nominal.pinion.alpha)
    return replace(
        nominal,
        pinion=replace(nominal.pinion, allowance=first),
        gear=replace(nominal.gear, allowance=second),
    )


def wanted_backlash(design: ToothingKeys, nominal: InvolutePair | RackMesh) -> float | None:
    """The normal backlash that a design asks for in a mesh, by either key; None where it asks for none."""
    if design.circumferential_backlash is not None:
        return design.circumferential_backlash * math.cos(nominal.working_angle) * math.cos(nominal.pinion.beta_b)
    return design.backlash if design.sets("backlash") else None


def refuse_thin(design: ToothingKeys, name: str, mesh: InvolutePair | RackMesh, thickness: float) -> None:
    """Refuse the allowance or backlash that leaves a member no tooth: a `thickness` (mm), as it is, of less than nothing."""
    refuse_thin_allowance(design.name_in_texts(name), getattr(design, name), thickness)
    key = "backlash" if design.circumferential_backlash is None else "circumferential_backlash"
    # the allowances of both are the same: how much less of either leaves none of this member
    most = mesh.normal_backlash + 2.0 * math.cos(mesh.pinion.alpha) * thickness
    if key != "backlash":
        most /= math.cos(mesh.working_angle) * math.cos(mesh.pinion.beta_b)
    raise DesignError(
        key,
        getattr(design, key),
        unit="mm",
        reason=f"leaves no tooth of the {design.name_in_texts(name)}",
        allowed=f"less than {at_most(most)} mm",
    )


def refuse_thin_allowance(name: str, spec: CylindricalMember | RackTable, thickness: float) -> None:
    """Refuse the allowance of a part `spec`, if it has one, that leaves it no tooth: a `thickness` (mm) of less than nothing."""
    key = spec.thickness_key
    if key is not None:
        given = getattr(spec, key).upper
        more = f"more than {at_least(given - thickness)} mm" if key == "thickness_allowance" else "more"
        raise DesignError(f"{name}.{key}.upper", given, unit="mm", reason="leaves no tooth", allowed=more)
