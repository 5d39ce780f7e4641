"""What a cylindrical mesh asks of its members: tips, roots, tool roundings, and every default that follows from them [ISO 21771].

Everything is in the design's own unit of length, so that it can be said under the design's keys.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gearmesh.systems.common.defaults import straight_rounding
from gearmesh.systems.cylindrical.cutter import cutter_of, generating, sharp_shaper
from gearmesh.systems.cylindrical.design import PROFILES
from gearmesh.systems.cylindrical.geometry import InvolutePair
from gearmesh.systems.cylindrical.nominal import MEMBERS, nominal_mesh, with_allowances
from gearmesh.systems.cylindrical.shifts import shifts, tip_alterations

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember

#: part of an internal gear's addendum that its default leaves between its tip and where the mate's involute ends, in modules
INSIDE = 0.02
#: part of the room on a cutter's tip that a rounding takes that is not given
ROOM = 0.8


@dataclass(frozen=True)
class PairProportions:
    """A pair with everything that its mesh says: teeth with their allowances, centre distance, radii of tips and roots."""

    mesh: InvolutePair
    nominal: InvolutePair
    tips: tuple[float, float]
    roots: tuple[float, float]


def proportions(design: CylindricalDesign) -> PairProportions:
    """Teeth, centre distance, tips and roots of a complete design. Raises DesignError where there is no working pressure angle."""
    nominal = nominal_mesh(design)
    mesh = with_allowances(design, nominal)
    members = (design.pinion, mesh.pinion), (design.gear, mesh.gear)
    tips, roots = [], []
    for spec, teeth in members:
        m = teeth.module
        tip = teeth.radius_at((spec.addendum + teeth.shift + spec.tip_alteration) * m)
        tips.append(tip if spec.tip_diameter is None else 0.5 * spec.tip_diameter)
        if spec.root_diameter is not None:
            roots.append(0.5 * spec.root_diameter)
        elif spec.shaper is not None and spec.shaper.addendum is not None:
            cutter = cutter_of(design, spec)
            top = cutter.radius + (spec.shaper.addendum + cutter.shift) * m
            roots.append(generating(cutter, teeth).distance - teeth.sense * top)
        else:
            roots.append(teeth.radius_at((teeth.shift - spec.dedendum) * m))
    return PairProportions(mesh, nominal, (tips[0], tips[1]), (roots[0], roots[1]))


def derived(design: CylindricalDesign) -> dict[str, float]:
    """What the mesh says of keys that the file leaves out, by dotted key, in the design's units.

    Raises DesignError for a centre distance or profile shifts that no working pressure angle belongs to.
    """
    found = {f"{name}.profile_shift": shift for name, shift in zip(MEMBERS, shifts(design), strict=True)}
    own = {name: value for name, value in found.items() if math.isnan(_member(design, name).profile_shift)}
    made = design if not own else design.filled(own)
    nominal = nominal_mesh(made)
    found |= {
        f"{name}.tip_alteration": value for name, value in zip(MEMBERS, tip_alterations(made, nominal), strict=True)
    }
    found |= {f"{name}.addendum": _addendum(made, name, nominal) for name in MEMBERS}
    found |= {f"{name}.tool_tip_radius": _rounding(made, name, nominal) for name in MEMBERS}
    mesh = with_allowances(made, nominal)
    found["backlash"] = mesh.normal_backlash
    plain = design.plain()
    return {key: value for key, value in found.items() if _is_open(plain, key)}


def _member(design: CylindricalDesign, dotted: str) -> CylindricalMember:
    member: CylindricalMember = getattr(design, dotted.partition(".")[0])
    return member


def _is_open(plain: dict[str, object], dotted: str) -> bool:
    """Whether a key counts in a plain design and is still to be derived."""
    table, _, key = dotted.rpartition(".")
    values = plain[table] if table else plain
    assert isinstance(values, dict)
    return isinstance(values.get(key), float) and math.isnan(values[key])


def _addendum(design: CylindricalDesign, name: str, mesh: InvolutePair) -> float:
    """The profile's addendum; of an internal gear at most what the mate's involute, above its tool's joint, leaves room for."""
    standard = PROFILES[design.profile][0]
    own = getattr(mesh, name)
    if not own.internal:
        return standard
    other = "gear" if name == "pinion" else "pinion"
    mate, spec = getattr(mesh, other), getattr(design, other)
    alpha_t, m = mate.alpha_t, mate.module
    depth = PROFILES[design.profile][1] if math.isnan(spec.dedendum) else spec.dedendum
    depth -= PROFILES[design.profile][2] * (1.0 - math.sin(mate.alpha)) + mate.shift
    joint = max(0.0, mate.radius * math.sin(alpha_t) - depth * m / math.sin(alpha_t))
    tip = math.hypot(own.base_radius, joint + mesh.generator)
    return float(min(standard, (own.radius - tip) / m - own.shift - INSIDE))


def _rounding(design: CylindricalDesign, name: str, mesh: InvolutePair) -> float:
    """The tip rounding of the profile, or what the tool's tooth has room for."""
    spec, own = getattr(design, name), getattr(mesh, name)
    standard, m = PROFILES[design.profile][2], own.module
    alpha = math.degrees(own.alpha)
    if not spec.shaped:
        if spec.root_diameter is not None:
            depth = own.shift + (own.radius - 0.5 * spec.root_diameter) / m
        else:
            depth = PROFILES[design.profile][1] if math.isnan(spec.dedendum) else spec.dedendum
        given = getattr(with_allowances(design, mesh), name).allowance
        return straight_rounding(0.5 * math.pi - given / m, depth, (alpha, alpha), standard)
    room = sharp_shaper(design, name, mesh).largest_tip_radius / m
    return float(min(standard, ROOM * room))
