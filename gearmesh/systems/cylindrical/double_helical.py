"""Double helical gears: two halves of opposite hands on one body, mirror images, with or without a gap between them.

Meshing is computed for one half, the half with the pinion's `hand`. Its middle is at z = 0 of every member's own frame;
the plane of symmetry is at z > 0. Face widths include both halves and the gap: b = 2 b_B + gap [ISO 21771].
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from gearmesh.allowed import Allowed
from gearmesh.design.core import BODY_TABLES
from gearmesh.errors import DesignError
from gearmesh.systems.common.bodies.body import disc_body
from gearmesh.systems.common.bodies.features import UnderTeeth, body_features, ring_features
from gearmesh.systems.common.tooth_edges import check_beside_holes
from gearmesh.systems.cylindrical.geometry.proportions import GearProportions
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.blank.halves import DoubleHelical, DoubleHelicalBar
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember, HalvesKeys
    from gearmesh.systems.cylindrical.rack.design import RackDesign, RackKeys, RackTable

DesignT = TypeVar("DesignT", bound="HalvesKeys")
PairT = TypeVar("PairT", "CylindricalDesign", "RackDesign")

#: default depth of the gap below the root, normal modules
GAP_DEPTH_MODULES = 0.25
#: largest part of the rim that the default gap takes
MAX_GAP_SHARE = 0.5
#: note that all figures are for one half
HALF_NOTE = (
    "double helical: contact, contact ratios, finite elements and their torques are for one half, and the other half is its "
    "mirror image; torques of loaded contact are for both halves"
)


def half_of(design: PairT) -> PairT:
    """Return the first halves of a double helical design (in mm) as a helical pair; any other design is unchanged."""
    if not design.double_helical:
        return design
    halves = first_halves(design)
    # the planes of symmetry coincide, so that halves of different widths have different middles
    first, second = (spec.face_width for spec in halves.specs.values())
    aside = 0.5 * (first - second)
    return halves.model_copy(update={"assembly": design.assembly.model_copy(update={"dz": aside})})


def first_halves(design: DesignT) -> DesignT:
    """Return a design (in mm) with the first half of every double helical member, with a plain body.

    Any other design is unchanged.
    """
    if not design.double_helical:
        return design
    halves = {
        name: spec.model_copy(
            update={
                **{key: None for key in (*BODY_TABLES, spec.gap_key) if key in type(spec).model_fields},
                "face_width": half_width(design, spec),
            }
        )
        for name, spec in design.specs.items()
    }
    return design.model_copy(update={**halves, "arrangement": "single", "gap": 0.0})


def half_width(design: HalvesKeys, spec: CylindricalMember | RackTable) -> float:
    """Return the face width b_B of one half of a member."""
    return 0.5 * (spec.face_width - design.gap)


def double_helical_member(design: HalvesKeys, half: Member, gear: GearProportions) -> Member:
    """Return a double helical member (in mm) with both halves, the gap and the features of the body.

    - half: the member's first half.
    - gear: proportions of this half.

    Raises DesignError naming key, value and limit.
    """
    name = gear.name
    spec: CylindricalMember = design.specs[gear.table]
    internal, tip, root = gear.own.internal, gear.tip, gear.root
    near = 0.5 * half_width(design, spec)
    plane = near + 0.5 * design.gap
    own = half.tooth.blank.body
    if design.gap == 0.0:
        half = _sharp_inside(half, 0 if internal else 1)
    if internal:
        rim = own.profile[0][0]
        body = Body.tube(rim, 2.0 * plane + near, -near, Region.RIM)
        groove = _groove(design, gear, rim)
        rows = DoubleHelical(plane, near, False, groove, body)
        under = UnderTeeth(
            name, half.tooth, body, root if groove is None else groove, rim, gear.own.module, rows.halves
        )
        return _with_features(replace(half, features=ring_features(spec, under), rows=rows), spec)
    body = disc_body(name, spec, own.bore_radius, root, tip - root).shift(plane)
    floor = own.bore_radius if body.web is None else body.web.outer
    groove = _groove(design, gear, floor)
    rows = DoubleHelical(plane, near, True, groove, body)
    smallest = root if groove is None else groove
    under = UnderTeeth(name, half.tooth, body, smallest, root, gear.own.module, rows.halves)
    return _with_features(replace(half, features=body_features(spec, under), rows=rows), spec)


def _with_features(member: Member, spec: CylindricalMember) -> Member:
    """Return a member whose ends were broken before it got its holes. Raises DesignError for ends that reach them."""
    check_beside_holes(member, spec)
    return member


def double_helical_bar(design: RackKeys, half: Member) -> Member:
    """Return a double helical rack (in mm) with both halves and the gap.

    `half`: its first half. Raises DesignError naming key, value and limit.
    """
    near = 0.5 * half_width(design, design.rack)
    plane = near + 0.5 * design.gap
    back = half.tooth.blank.body.profile[0][0]
    body = Body.tube(back, -near, 2.0 * plane + near, Region.BACK)
    if design.gap == 0.0:
        half = _sharp_inside(half, 1)
    length = half.tooth.teeth * design.pitch + 2.0 * half.overhang
    return replace(half, rows=DoubleHelicalBar(plane, near, True, _bar_groove(design, half, back), body, length))


def gap_heights(rack: Member) -> list[float]:
    """Return the height (mm) of the floor of a rack's gap over the back of the bar; empty without a gap."""
    return [gap.floor - rack.plain_body.profile[0][0] for gap in rack.gaps]


def _bar_groove(design: RackKeys, half: Member, back: float) -> float | None:
    """Return the height x of the floor of a rack's gap, between its root and the `back`; None without a gap."""
    root = float(half.tooth.blank.root.at(0.0))
    given = design.rack.gap_height
    if design.gap == 0.0:
        return None
    if given is None:
        return root - min(GAP_DEPTH_MODULES * design.given_module, MAX_GAP_SHARE * (root - back))
    if not 0.0 < given < root - back:
        raise DesignError(
            f"{half.name}.gap_height",
            given,
            unit="mm",
            allowed=Allowed.between(0.0, root - back, "mm", ", back and root of the bar"),
        )
    return back + given


def _sharp_inside(half: Member, end: int) -> Member:
    """Return a half without a chamfer at the end 0 (toe) or 1 (heel) where it meets the other half."""
    blank = half.tooth.blank
    if blank.ends[end] is None:
        return half
    ends = (None, blank.ends[1]) if end == 0 else (blank.ends[0], None)
    return replace(half, tooth=replace(half.tooth, blank=blank.with_ends(ends)))


def _groove(design: HalvesKeys, gear: GearProportions, floor: float) -> float | None:
    """Return the radius of the gap, between the root and the `floor` of the rim; None without a gap."""
    name, root = gear.name, gear.root
    spec: CylindricalMember = design.specs[gear.table]
    if design.gap == 0.0:
        return None
    depth = abs(root - floor)
    sense = 1.0 if floor > root else -1.0
    if spec.gap_diameter is None:
        return root + sense * min(GAP_DEPTH_MODULES * gear.own.module, MAX_GAP_SHARE * depth)
    radius = 0.5 * spec.gap_diameter
    if not 0.0 < sense * (radius - root) < depth:
        low, high = sorted((root, floor))
        raise DesignError(
            f"{name}.gap_diameter",
            spec.gap_diameter,
            unit="mm",
            allowed=Allowed.between(
                2.0 * low,
                2.0 * high,
                "mm",
                note=f", root and {'outside of the rim' if sense > 0 else 'bore, or inside of the rim'}",
            ),
        )
    return radius
