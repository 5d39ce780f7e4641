"""Involute splines: shaft and hub as cylindrical gears of as many teeth on one axis.

The fixed frame is the shaft's own: its axis is z, and the middle of both faces is at z = 0. At phi1 = 0 a tooth of the shaft and
a space of the hub are on +x. phi1 turns the shaft clockwise about +z, and the hub turns with it: at nominal position all tooth
pairs touch at once, on whole flanks. Assembly errors tilt and move the hub, and every tooth pair then has its own gap.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.common.axes import shifts, tilts
from gearmesh.systems.common.defaults import straight_rounding
from gearmesh.systems.cylindrical.build import gear_member
from gearmesh.systems.cylindrical.cutting.cutter import sharp_shaper, trimming_warnings
from gearmesh.systems.cylindrical.geometry.nominal import refuse_thin_allowance
from gearmesh.systems.cylindrical.geometry.proportions import (
    TIP_ROUNDING_SHARE,
    GearProportions,
    GearsProportions,
    still_open,
)
from gearmesh.systems.cylindrical.pinned import member_values
from gearmesh.systems.cylindrical.single.build import proportions, single_gear
from gearmesh.systems.cylindrical.single.design import SingleGearDesign
from gearmesh.systems.cylindrical.spline.design import HUB_NAME, MEMBER_NAMES, SHAFT_NAME
from gearmesh.systems.cylindrical.spline.profiles import DIN_SHIFTS
from gearmesh.systems.system import Displacements
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.cylindrical.spline.design import SplineDesign

#: keys of a member that only splines have
_OWN_KEYS = ("tolerance", "effective_variation")


class ShaftGear(SingleGearDesign):
    """The shaft as a gear."""

    other_names: ClassVar[Mapping[str, str]] = {"pinion": SHAFT_NAME}


class HubGear(SingleGearDesign):
    """The hub as an internal gear."""

    other_names: ClassVar[Mapping[str, str]] = {"gear": HUB_NAME}


def member_design(design: SplineDesign, name: str) -> SingleGearDesign:
    """Return a member of a design as a design of one gear, in the same units."""
    spec, inside = getattr(design, name), name == HUB_NAME
    keys: dict[str, Any] = {key: value for key, value in spec.plain().items() if key not in _OWN_KEYS}
    keys |= {"teeth": design.counted_teeth, "internal": inside, "tip_alteration": 0.0}
    keys["profile_shift"] = -design.profile_shift if inside else design.profile_shift
    if not spec.thickness_given:
        upper, lower = _allowance_by_tolerance(design, name)
        keys["thickness_allowance"] = {"upper": upper, "lower": lower}
    whole: dict[str, Any] = {
        "units": design.units,
        "module": design.given_module,
        "pressure_angle": design.pressure_angle,
        "material": design.material.plain(),
        "gear" if inside else "pinion": keys,
    }
    return (HubGear if inside else ShaftGear)(**whole)


def _allowance_by_tolerance(design: SplineDesign, name: str) -> tuple[float, float]:
    """Return upper and lower allowance of the actual thickness of a member's teeth, in the design's units.

    They are those of the tolerance, if it is known, else 0. A profile with a wider space thins the teeth of the hub.
    """
    known, units = design.member_tolerance(name), design.mm_per_unit
    wider = -design.basic_rack.wider_space * design.given_module if name == HUB_NAME else 0.0
    if known is None:
        return wider, wider
    upper, lower = (wider + (known.effective - part) / units for part in (known.variation, known.total))
    return upper, lower


def effective_variation(design: SplineDesign, name: str) -> float:
    """Return the effective variation of a member, given or by its tolerance, else 0, in the design's units."""
    given, known = getattr(design, name).effective_variation, design.member_tolerance(name)
    if given is not None:
        return float(given)
    return 0.0 if known is None else known.variation / design.mm_per_unit


def derived_values(design: SplineDesign) -> dict[str, float]:
    """Return the roundings of the tools that the design leaves out, by dotted key: those of the profile, or what has room."""
    open_keys = still_open(design, {f"{name}.tool_tip_radius": 0.0 for name in MEMBER_NAMES})
    return {key: _rounding(design, key.partition(".")[0]) for key in open_keys}


def _rounding(design: SplineDesign, name: str) -> float:
    """Return the tip rounding of a member's tool, modules."""
    rack = design.basic_rack
    standard = (rack.hub if name == HUB_NAME else rack.shaft)[2]
    sharp = design.fill({f"{other}.tool_tip_radius": standard for other in MEMBER_NAMES})
    gear = single_gear(member_design(sharp, name))
    own, spec = gear.own, gear.spec
    if not spec.hobbed:
        return min(standard, TIP_ROUNDING_SHARE * sharp_shaper(gear).largest_tip_radius / own.module)
    root = own.radius_at((own.shift - spec.dedendum) * own.module)
    if spec.root_diameter is not None:
        root = 0.5 * spec.root_diameter
    depth = own.shift + (own.radius - root) / own.module
    alpha = math.degrees(own.alpha)
    return straight_rounding(0.5 * math.pi - own.allowance / own.module, depth, (alpha, alpha), standard)


def gears_of(design: SplineDesign) -> GearsProportions:
    """Return teeth, tips and roots of shaft and hub of a complete design.

    Raises DesignError for an allowance or profile shift that leaves no tooth.
    """
    gears = tuple(proportions(member_design(design, name)) for name in MEMBER_NAMES)
    for gear in gears:
        if gear.own.thickness <= 0.0:
            refuse_thin_allowance(gear.name, gear.spec, gear.own.thickness)
            shift = 0.25 * math.pi / math.tan(gear.own.alpha)
            allowed = Allowed.less_than(shift) if gear.own.internal else Allowed.more_than(-shift)
            raise DesignError(
                "profile_shift", design.profile_shift, reason=f"leaves the {gear.name} no tooth", allowed=allowed
            )
    return GearsProportions(gears)


def build(design: SplineDesign) -> GearTrain:
    """Return shaft and hub of a design (in mm).

    Raises DesignError naming key, value and limit: teeth or tools that cannot exist.
    """
    shaft, hub = gears_of(design).gears
    flank = Side(design.contact.flank)
    errors = design.assembly
    # a space of the hub on +x, before the errors
    turned = tilts(errors.gamma_h, errors.gamma_v) @ Rigid.about_z(-math.pi / design.counted_teeth).rotation
    mount = Mount(Rigid(turned, np.array([errors.dx, errors.dy, errors.dz])), sign=-1.0)
    pair = GearPair(
        pinion=replace(gear_member(shaft), mount=Mount(Rigid.identity(), sign=-1.0)),
        gear=replace(gear_member(hub), mount=mount),
        flanks=(flank, flank.other),
        drive=flank.sign,
        ratio=1.0,
        delta=design.contact.delta,
    )
    return GearTrain(design.kind, (pair,), tuple(_warnings(design, shaft, hub)))


def _displaced_bases(design: SplineDesign, train: GearTrain, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
    """Return the positions of both members with assembly errors."""
    shaft, hub = (mount.base for mount in train.pairs[0].mounts)
    moved = hub.translation + shifts(errors["dx"], errors["dy"], errors["dz"])
    return shaft, Rigid(tilts(errors["gamma_h"], errors["gamma_v"]) @ hub.rotation, moved)


#: keys of the assembly errors, and the positions of the members with them
ASSEMBLY_DISPLACEMENTS = Displacements(("dx", "dy", "dz", "gamma_h", "gamma_v"), _displaced_bases)


def _warnings(design: SplineDesign, shaft: GearProportions, hub: GearProportions) -> Iterator[str]:
    """Yield the warnings of a design: sizes outside of a standard, tolerances that are not known, tips on roots."""
    if design.reference_diameter is not None and design.profile == "DIN 5480":
        low, high = DIN_SHIFTS
        if not low - 1e-9 <= design.profile_shift <= high + 1e-9:
            yield (
                f"profile shift {design.profile_shift:.4g}: outside of {low:g} to {high:g} of DIN 5480-1; "
                "another number of teeth may be meant"
            )
    for name in MEMBER_NAMES:
        text, spec = design.tolerance(name), getattr(design, name)
        if text and design.member_tolerance(name) is None and not spec.thickness_given:
            yield (
                f"tolerance {text} of the {name}: its limits are not known, the teeth are nominal; give "
                f"{name}.thickness_allowance and effective_variation, or limits of {name}.pins"
            )
    for name, tip, root in ((SHAFT_NAME, shaft.tip, hub.root), (HUB_NAME, shaft.root, hub.tip)):
        if tip >= root:
            yield f"the tips of the {name} reach the roots of the other: {2.0 * tip:.6g} and {2.0 * root:.6g} mm"
    yield from trimming_warnings((hub,))


def pinned_values(design: SplineDesign, train: GearTrain) -> Values:
    """Return the values that the build chose, for a complete design in mm and the gear set built from it."""
    values: Values = {}
    for gear, name in zip(gears_of(design).gears, MEMBER_NAMES, strict=True):
        values |= member_values(gear, name, train.members[name])
        if not getattr(design, name).thickness_given:
            upper, lower = _allowance_by_tolerance(design, name)
            values |= {f"{name}.thickness_allowance.upper": upper, f"{name}.thickness_allowance.lower": lower}
        values[f"{name}.tolerance"] = design.tolerance(name) or None
        values[f"{name}.effective_variation"] = effective_variation(design, name)
    return values
