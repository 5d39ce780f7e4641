"""Proportions of a pinion and a rack, and every default that follows from their mesh [ISO 21771].

Everything is in the design's own unit of length, so that it can be reported under the design's keys. The pinion is the
pinion of a cylindrical pair whose other gear has no influence.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from gearmesh.allowed import Allowed
from gearmesh.design.keys import given_or
from gearmesh.errors import DesignError
from gearmesh.records import dataclass
from gearmesh.systems.common.defaults import straight_rounding
from gearmesh.systems.common.racks.rack_tooth import SidedTip
from gearmesh.systems.cylindrical.cutting.last_cut import LastCut
from gearmesh.systems.cylindrical.design import BASIC_RACKS, CylindricalDesign
from gearmesh.systems.cylindrical.geometry.allowances import made_allowance
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.systems.cylindrical.geometry.nominal import refuse_thin, teeth_of, wanted_backlash
from gearmesh.systems.cylindrical.geometry.proportions import (
    TIP_ROUNDING_SHARE,
    PairProportions,
    proportions,
    sharp_drive_side,
    still_open,
)
from gearmesh.systems.cylindrical.parts import completed_pair, nest, shared_keys
from gearmesh.systems.cylindrical.rack.design import PINION_NAME, RACK_NAME
from gearmesh.systems.cylindrical.rack.member import RackMesh, RackProportions

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.rack.design import RackDesign, RackKeys

#: teeth, or a mesh, of one side
Side = TypeVar("Side")
#: default height of the bar under the root, in normal modules
BAR_MODULES = 3.0
#: largest profile shift of either sign
MAX_PROFILE_SHIFT = 5.0
#: smaller lengths are rounding
ROUNDING_MODULES = 1e-12
#: length of flank that default roundings leave beyond the mating tip
FLANK_MARGIN_MODULES = 0.002


@dataclass(frozen=True)
class RackPairProportions:
    """Proportions of pinion and rack."""

    #: mesh with the allowances of the tooth thickness
    mesh: RackMesh
    #: mesh of nominal teeth
    nominal: RackMesh
    #: cylindrical pair whose pinion is the rack's pinion
    pair: CylindricalDesign
    #: proportions of this pair
    of_pair: PairProportions

    @property
    def root(self) -> float:
        """Root radius of the pinion."""
        return self.of_pair.roots[0]


def rack_proportions(design: RackDesign) -> RackPairProportions:
    """Return teeth, distance, tips and roots of a complete design.

    Raises DesignError for teeth that cannot exist.
    """
    nominal = _nominal(design)
    mesh = _with_allowances(design, nominal)
    _check(design, mesh)
    pair = _pair(design, mesh.pinion)
    of_pair = proportions(pair)
    tip = of_pair.tips[0]
    return RackPairProportions(replace(mesh, tip=tip), replace(nominal, tip=tip), pair, of_pair)


def derived_values(design: RackDesign) -> dict[str, float]:
    """Return the values of keys left out in the file that follow from the mesh, by dotted key.

    Values are in the design's units. Raises DesignError for a mounting distance to which no profile shift belongs.
    """
    rounding = BASIC_RACKS[design.profile][2]
    # addendum and height of the bar, then the profile shift, which the mounting distance requires
    defaults = bar_defaults(design)
    made = design.fill(defaults)
    defaults |= still_open(made, {f"{PINION_NAME}.profile_shift": _shift(made)})
    made = design.fill(defaults)
    nominal = _nominal(made)
    # shorten the pinion's tip by the difference between profile shift and distance
    own = nominal.pinion
    nearer = nominal.above / own.module - own.shift
    defaults |= still_open(made, {f"{PINION_NAME}.tip_alteration": nearer if nearer < -ROUNDING_MODULES else 0.0})
    made = design.fill(defaults)
    mesh = _with_allowances(made, nominal)
    _check(made, mesh)
    pair = _pair(made, mesh.pinion)
    of_pair = proportions(pair)
    mesh = replace(mesh, tip=of_pair.tips[0])
    # roundings leave the flanks straight as far as the mating tips reach
    values = {
        f"{RACK_NAME}.tool_tip_radius": min(
            _clear(
                bar_rounding(made, mesh),
                mesh.rack.dedendum,
                -side.rack_height(side.pinion.roll_length(mesh.tip)) / own.module,
                side.pinion.alpha,
            )
            for side in _shared(mesh.sides, design.rack)
        ),
        f"{PINION_NAME}.addendum": pair.pinion.addendum,
        "backlash": mesh.normal_backlash,
    }
    if design.pinion.shaped:
        values[f"{PINION_NAME}.tool_tip_radius"] = _shaper_rounding(pair, mesh, rounding)
    elif design.pinion.hob is None:
        values[f"{PINION_NAME}.tool_tip_radius"] = min(
            _clear(
                pair.pinion.tool_tip_radius,
                (own.radius - of_pair.roots[0]) / own.module,
                mesh.rack.addendum - mesh.above / own.module,
                side.alpha,
            )
            for side in _shared(own.sides, design.pinion)
        )
    else:
        values[f"{PINION_NAME}.tool_tip_radius"] = pair.pinion.tool_tip_radius
    return defaults | still_open(made, values)


def _shared(sides: tuple[Side, ...], spec: SidedTip) -> tuple[Side, ...]:
    """Return the sides of a member whose tool has one tip rounding: both, or the drive side if the coast side has its own."""
    return sides if spec.coast_tool_tip_radius is None else sides[:1]


def _clear(standard: float, depth: float, needed: float, alpha: float) -> float:
    """Return a rounding of a rack's tip that leaves its flank straight down to a depth.

    - standard: largest rounding, returned if no rounding leaves enough flank.
    - depth: depth of the rack's tip below its pitch plane.
    - needed: depth to which the flank must be straight.
    - alpha: pressure angle, rad.

    Lengths are in modules.
    """
    most = (depth - needed - FLANK_MARGIN_MODULES) / (1.0 - math.sin(alpha))
    return standard if most < 0.0 else min(standard, most)


def _nominal(design: RackDesign) -> RackMesh:
    """Return the mesh without allowances; the tip of its pinion is not known yet."""
    own = teeth_of(design, design.pinion)
    mesh = RackMesh(own, bar_of(design), math.nan, own.radius + own.shift * own.module)
    mounted = design.assembly.mounting_distance
    return mesh if mounted is None else replace(mesh, distance=mounted - mesh.pitch_height)


def bar_of(design: RackKeys) -> RackProportions:
    """Return the nominal rack of a design."""
    spec = design.rack
    return RackProportions(
        teeth=design.rack_teeth,
        face_width=spec.face_width,
        height=spec.height,
        addendum=spec.addendum,
        dedendum=spec.dedendum,
        tool_tip_radius=spec.tool_tip_radius,
        coast_tool_tip_radius=spec.coast_tool_tip_radius,
        overhang=design.overhang,
    )


def bar_defaults(design: RackKeys) -> dict[str, float]:
    """Return addendum and height of the rack that the file leaves out, by dotted key."""
    addendum, _, _ = BASIC_RACKS[design.profile]
    depth = given_or(design.rack.addendum, addendum) + design.rack.dedendum
    return still_open(
        design, {f"{RACK_NAME}.addendum": addendum, f"{RACK_NAME}.height": (depth + BAR_MODULES) * design.given_module}
    )


def bar_rounding(design: RackKeys, mesh: RackMesh) -> float:
    """Return the profile's radius of the rack's root fillets, in modules, limited by the room in its spaces."""
    own = mesh.pinion
    width = 0.5 * math.pi - mesh.rack.allowance / own.module
    drive, coast = (math.degrees(own.side(side).alpha) for side in (own.drive, own.drive.other))
    standard, other = BASIC_RACKS[design.profile][2], design.rack.coast_tool_tip_radius
    return straight_rounding(width, mesh.rack.dedendum, (drive, coast), standard, other)


def _shift(design: RackDesign) -> float:
    """Return the pinion's profile shift at which nominal teeth have no backlash at the mounting distance.

    The shift is 0 if no mounting distance is given.
    """
    mounted = design.assembly.mounting_distance
    if mounted is None:
        return 0.0
    own, height = teeth_of(design, design.pinion), design.rack.height - design.rack.addendum * design.given_module
    shift = (mounted - height - own.radius) / own.module
    if abs(shift) > MAX_PROFILE_SHIFT:
        least, most = (own.radius + height + sign * MAX_PROFILE_SHIFT * own.module for sign in (-1.0, 1.0))
        raise DesignError(
            "assembly.mounting_distance",
            mounted,
            unit="mm",
            reason=f"the pinion would need a profile shift of {shift:.4g}",
            allowed=Allowed.from_to(least, most, "mm"),
        )
    return shift


def _with_allowances(design: RackDesign, nominal: RackMesh) -> RackMesh:
    """Return the mesh with the allowances of the tooth thickness, given or required by the wanted backlash."""
    wanted = wanted_backlash(design, nominal)
    if wanted is None:
        of_pinion, of_rack = (
            made_allowance(name, getattr(design, name), nominal.pinion) for name in (PINION_NAME, RACK_NAME)
        )
    else:
        # sum of both A_sn = (j_bn of the nominal teeth - j_bn) / cos(alpha_n), shared equally
        of_pinion = of_rack = 0.5 * (nominal.normal_backlash - wanted) / math.cos(nominal.pinion.alpha)
    return with_allowances(nominal, of_pinion, of_rack)


def with_allowances(nominal: RackMesh, of_pinion: float, of_rack: float) -> RackMesh:
    """Return the mesh with allowances of the normal thickness of pinion and rack."""
    return replace(
        nominal,
        pinion=replace(nominal.pinion, allowance=of_pinion),
        rack=replace(nominal.rack, allowance=of_rack),
    )


def _check(design: RackDesign, mesh: RackMesh) -> None:
    """Refuse thicknesses that leave no tooth of either member, and a pointed rack."""
    for name, thickness in ((PINION_NAME, mesh.pinion.thickness), (RACK_NAME, mesh.rack_thickness)):
        if thickness <= 0.0:
            refuse_thin(design, name, mesh, thickness)
    check_land(mesh)


def check_land(mesh: RackMesh) -> None:
    """Refuse a pointed rack."""
    if mesh.rack_land <= 0.0:
        most = mesh.rack_thickness / mesh.pinion.both_tangents / mesh.pinion.module
        raise DesignError(
            f"{RACK_NAME}.addendum",
            mesh.rack.addendum,
            reason="the rack's teeth are pointed",
            allowed=Allowed.less_than(most),
        )


def _pair(design: RackDesign, own: Toothing) -> CylindricalDesign:
    """Return a pair with the pinion as it is made; its other gear is a substitute.

    The pinion's table has all values that would depend on a mating gear.
    """
    table: dict[str, Any] = nest(dict(design.own()), {PINION_NAME: "pinion"})["pinion"]
    table |= {
        "profile_shift": own.shift,
        "thickness_allowance": {"upper": own.allowance, "lower": own.allowance},
    }
    for key in {"span", "balls", "pins"} & table.keys():
        # the allowance already contains the limits
        table[key] = {name: value for name, value in table[key].items() if name not in ("upper", "lower")}
    if design.pinion.tip_diameter is None:
        table["tip_alteration"] = design.pinion.tip_alteration
    if not math.isnan(design.pinion.tool_tip_radius):
        table["tool_tip_radius"] = design.pinion.tool_tip_radius
    gear = {"teeth": own.teeth, "face_width": design.pinion.face_width, "profile_shift": -own.shift}
    keys = {**shared_keys(design), "hand": design.hand, "pinion": table, "gear": gear}
    return completed_pair(CylindricalDesign, keys)


def _shaper_rounding(pair: CylindricalDesign, mesh: RackMesh, standard: float) -> float:
    """Return the tip rounding of a shaped pinion's cutter.

    It is the profile's rounding, limited by the room on the cutter and by the involute that the rack's tips need.
    """
    own, of_pair = mesh.pinion, proportions(pair)
    sharp = sharp_drive_side(of_pair.gear("pinion"))
    most = min(standard * own.module, TIP_ROUNDING_SHARE * sharp.largest_tip_radius)
    largest = []
    for side, shaper in zip(_shared(mesh.sides, pair.pinion), (sharp, sharp.other_flank), strict=False):
        reached = side.roll_length_at((mesh.rack.addendum + FLANK_MARGIN_MODULES) * own.module)
        largest.append(LastCut(shaper, side.pinion, of_pair.roots[0]).largest_rounding(reached, most) / own.module)
    return min(largest)
