"""What the mesh of a pinion and a rack says of both, and every default that follows from it [ISO 21771].

Everything is in the design's own unit of length, so that it can be reported under the design's keys. The pinion is that of a
cylindrical pair whose other gear has no part in it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from gearmesh.design.keys import given_or
from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.defaults import straight_rounding
from gearmesh.systems.cylindrical.cutting.cutter import sharp_shaper
from gearmesh.systems.cylindrical.cutting.last_cut import LastCut
from gearmesh.systems.cylindrical.design import PROFILES, CylindricalDesign
from gearmesh.systems.cylindrical.geometry.allowances import made_allowance
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.systems.cylindrical.geometry.nominal import refuse_thin, teeth_of, wanted_backlash
from gearmesh.systems.cylindrical.geometry.proportions import (
    TIP_ROUNDING_SHARE,
    PairProportions,
    proportions,
    still_open,
)
from gearmesh.systems.cylindrical.parts import completed_pair, nest, shared_keys
from gearmesh.systems.cylindrical.rack.design import PINION, RACK
from gearmesh.systems.cylindrical.rack.member import RackMesh, RackProportions

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.rack.design import RackDesign, RackKeys

#: bar under the root that is not given, in normal modules
BAR = 3.0
#: largest profile shift either way
LARGEST = 5.0
#: what is less, in modules, is rounding
NOTHING = 1e-12
#: flank (modules) that default roundings leave beyond what the mating gear's tips need
BEYOND = 0.002


@dataclass(frozen=True)
class RackPairProportions:
    """The mesh of pinion and rack with their allowances, and nominal; the pair whose `pinion` it is, and what its mesh says."""

    mesh: RackMesh
    nominal: RackMesh
    pair: CylindricalDesign
    of_pair: PairProportions

    @property
    def root(self) -> float:
        """Root radius of the pinion."""
        return self.of_pair.roots[0]


def rack_proportions(design: RackDesign) -> RackPairProportions:
    """Teeth, distance, tips and roots of a complete design. Raises DesignError for teeth that cannot exist."""
    nominal = _nominal(design)
    mesh = _with_allowances(design, nominal)
    _check(design, mesh)
    pair = _pair(design, mesh.pinion)
    of_pair = proportions(pair)
    tip = of_pair.tips[0]
    return RackPairProportions(replace(mesh, tip=tip), replace(nominal, tip=tip), pair, of_pair)


def derived_values(design: RackDesign) -> dict[str, float]:
    """What the mesh says of keys that the file leaves out, by dotted key, in the design's units.

    Raises DesignError for a mounting distance that no profile shift belongs to.
    """
    rounding = PROFILES[design.profile][2]
    defaults = bar_defaults(design)
    made = design.fill(defaults)
    defaults |= still_open(made, {f"{PINION}.profile_shift": _shift(made)})
    made = design.fill(defaults)
    nominal = _nominal(made)
    own = nominal.pinion
    nearer = nominal.above / own.module - own.shift
    defaults |= still_open(made, {f"{PINION}.tip_alteration": nearer if nearer < -NOTHING else 0.0})
    made = design.fill(defaults)
    mesh = _with_allowances(made, nominal)
    _check(made, mesh)
    pair = _pair(made, mesh.pinion)
    of_pair = proportions(pair)
    mesh = replace(mesh, tip=of_pair.tips[0])
    values = {
        f"{RACK}.tool_tip_radius": _clear(
            bar_rounding(made, mesh),
            mesh.rack.dedendum,
            -mesh.rack_height(own.roll_length(mesh.tip)) / own.module,
            own.alpha,
        ),
        f"{PINION}.addendum": pair.pinion.addendum,
        "backlash": mesh.normal_backlash,
    }
    if design.pinion.shaped:
        values[f"{PINION}.tool_tip_radius"] = _shaper_rounding(pair, mesh, rounding)
    elif design.pinion.hob is None:
        values[f"{PINION}.tool_tip_radius"] = _clear(
            pair.pinion.tool_tip_radius,
            (own.radius - of_pair.roots[0]) / own.module,
            mesh.rack.addendum - mesh.above / own.module,
            own.alpha,
        )
    else:
        values[f"{PINION}.tool_tip_radius"] = pair.pinion.tool_tip_radius
    return defaults | still_open(made, values)


def _clear(standard: float, depth: float, needed: float, alpha: float) -> float:
    """A rounding of a rack's tip so `depth` below its pitch plane, at most the `standard`, that leaves its flank straight down to
    what is `needed`; the standard where none does. All in modules."""
    most = (depth - needed - BEYOND) / (1.0 - math.sin(alpha))
    return standard if most < 0.0 else min(standard, most)


def _nominal(design: RackDesign) -> RackMesh:
    """The mesh without allowances; its pinion's tip is not known yet."""
    own = teeth_of(design, design.pinion)
    mesh = RackMesh(own, bar_of(design), math.nan, own.radius + own.shift * own.module)
    mounted = design.assembly.mounting_distance
    return mesh if mounted is None else replace(mesh, distance=mounted - mesh.pitch_height)


def bar_of(design: RackKeys) -> RackProportions:
    """The rack of a design, nominal."""
    spec = design.rack
    return RackProportions(
        teeth=design.rack_teeth,
        face_width=spec.face_width,
        height=spec.height,
        addendum=spec.addendum,
        dedendum=spec.dedendum,
        tool_tip_radius=spec.tool_tip_radius,
        overhang=design.overhang,
    )


def bar_defaults(design: RackKeys) -> dict[str, float]:
    """Addendum and height of the rack that the file leaves out, by dotted key."""
    addendum, _, _ = PROFILES[design.profile]
    depth = given_or(design.rack.addendum, addendum) + design.rack.dedendum
    return still_open(design, {f"{RACK}.addendum": addendum, f"{RACK}.height": (depth + BAR) * design.given_module})


def bar_rounding(design: RackKeys, mesh: RackMesh) -> float:
    """The profile's radius of the rack's root fillets, in modules, or what its spaces have room for."""
    own = mesh.pinion
    alpha, width = math.degrees(own.alpha), 0.5 * math.pi - mesh.rack.allowance / own.module
    return straight_rounding(width, mesh.rack.dedendum, (alpha, alpha), PROFILES[design.profile][2])


def _shift(design: RackDesign) -> float:
    """The pinion's profile shift with which nominal teeth have no backlash at the mounting distance; 0 where none is given."""
    mounted = design.assembly.mounting_distance
    if mounted is None:
        return 0.0
    own, height = teeth_of(design, design.pinion), design.rack.height - design.rack.addendum * design.given_module
    shift = (mounted - height - own.radius) / own.module
    if abs(shift) > LARGEST:
        least, most = (own.radius + height + sign * LARGEST * own.module for sign in (-1.0, 1.0))
        raise DesignError(
            "assembly.mounting_distance",
            mounted,
            unit="mm",
            reason=f"the pinion would need a profile shift of {shift:.4g}",
            allowed=f"from {at_least(least)} to {at_most(most)} mm",
        )
    return shift


def _with_allowances(design: RackDesign, nominal: RackMesh) -> RackMesh:
    """Both members with the allowances of their thickness: as given, or what the backlash that is wanted asks for."""
    wanted = wanted_backlash(design, nominal)
    if wanted is None:
        first, second = (made_allowance(name, getattr(design, name), nominal.pinion) for name in (PINION, RACK))
    else:
        # sum of the A_sn = (j_bn of the nominal teeth - j_bn) / cos(alpha_n)
        first = second = 0.5 * (nominal.normal_backlash - wanted) / math.cos(nominal.pinion.alpha)
    return with_allowances(nominal, first, second)


def with_allowances(nominal: RackMesh, of_pinion: float, of_rack: float) -> RackMesh:
    """The mesh with allowances of the normal thickness of both."""
    return replace(
        nominal,
        pinion=replace(nominal.pinion, allowance=of_pinion),
        rack=replace(nominal.rack, allowance=of_rack),
    )


def _check(design: RackDesign, mesh: RackMesh) -> None:
    """Refuse thicknesses that leave no tooth of either member, and a pointed rack."""
    for name, thickness in ((PINION, mesh.pinion.thickness), (RACK, mesh.rack_thickness)):
        if thickness <= 0.0:
            refuse_thin(design, name, mesh, thickness)
    check_land(mesh)


def check_land(mesh: RackMesh) -> None:
    """Refuse a pointed rack."""
    if mesh.rack_land <= 0.0:
        most = 0.5 * mesh.rack_thickness / math.tan(mesh.pinion.alpha) / mesh.pinion.module
        raise DesignError(
            f"{RACK}.addendum",
            mesh.rack.addendum,
            reason="the rack's teeth are pointed",
            allowed=f"less than {at_most(most)}",
        )


def _pair(design: RackDesign, own: Toothing) -> CylindricalDesign:
    """A pair with the pinion as it is made, with all figures that a mating gear would need; the other gear is a substitute."""
    table: dict[str, Any] = nest(dict(design.own()), {PINION: "pinion"})["pinion"]
    table |= {
        "profile_shift": own.shift,
        "thickness_allowance": {"upper": own.allowance, "lower": own.allowance},
    }
    for key in {"span", "balls", "pins"} & table.keys():
        # what its limits say is in the allowance
        table[key] = {name: value for name, value in table[key].items() if name not in ("upper", "lower")}
    if design.pinion.tip_diameter is None:
        table["tip_alteration"] = design.pinion.tip_alteration
    if not math.isnan(design.pinion.tool_tip_radius):
        table["tool_tip_radius"] = design.pinion.tool_tip_radius
    gear = {"teeth": own.teeth, "face_width": design.pinion.face_width, "profile_shift": -own.shift}
    keys = {**shared_keys(design), "hand": design.hand, "pinion": table, "gear": gear}
    return completed_pair(CylindricalDesign, keys)


def _shaper_rounding(pair: CylindricalDesign, mesh: RackMesh, standard: float) -> float:
    """The tip rounding of a shaped pinion's cutter: the profile's, or what it has room for and leaves the involute that the rack's
    tips need."""
    own, of_pair = mesh.pinion, proportions(pair)
    sharp = sharp_shaper(of_pair.gear("pinion"))
    most = min(standard * own.module, TIP_ROUNDING_SHARE * sharp.largest_tip_radius)
    reached = mesh.roll_length_at((mesh.rack.addendum + BEYOND) * own.module)
    return LastCut(sharp, own, of_pair.roots[0]).largest_rounding(reached, most) / own.module
