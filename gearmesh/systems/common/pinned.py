"""Values that a design leaves to its build, taken from the built members: they pin the design."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gearmesh.design.core import STEEL_DENSITY_KG_PER_M3, BrokenEdges, MemberBody
from gearmesh.systems.common.tooth_edges import DEFAULT_END_CHAMFER_ANGLE_DEG, end_widths
from gearmesh.teeth.region import Region

if TYPE_CHECKING:
    from gearmesh.design.core import Design, MemberMount
    from gearmesh.teeth.gear_train import GearPair, GearTrain, Member

#: values by dotted key, lengths in mm; None removes a key that other keys replace
Values = dict[str, Any]


def body_values(design: Design, train: GearTrain) -> Values:
    """Return density, bores, keyways, webs and holes of the members as built, for a complete design in mm."""
    values_given: Values = {"material.density": design.material.density or STEEL_DENSITY_KG_PER_M3}
    for name, member in train.members.items():
        table = name.rstrip("0123456789").removesuffix("_")
        spec, pair = getattr(design, table), next((pair for pair in train.pairs if name in pair.members), None)
        if isinstance(spec, BrokenEdges) and any(end_widths(spec)):
            values_given[f"{table}.end_chamfer_angle"] = spec.end_chamfer_angle or DEFAULT_END_CHAMFER_ANGLE_DEG
        if isinstance(spec, MemberBody):
            values_given |= {f"{table}.{key}": value for key, value in _of_body(spec, member).items()}
        # a bar has no body, but may have a mount
        if isinstance(spec, MemberBody) or getattr(spec, "mount", None) is not None:
            values_given |= _of_mount(design.mount(name), table, pair, name)
    return values_given


def _of_mount(mount: MemberMount, table: str, pair: GearPair | None, name: str) -> Values:
    """Return the values of a member's mount: the place of its body and, in a pair, of its elastic mount."""
    values: Values = {f"{table}.mount.held": mount.held}
    if pair is not None and mount.stiffness is not None and mount.z is None:
        values[f"{table}.mount.z"] = pair.middle(pair.members[name])
    return values


def _of_body(spec: MemberBody, member: Member) -> Values:
    """Return the values of a member's body."""
    body, values = member.plain_body, Values()
    if Region.BORE in body.bands:
        values["bore"] = 2.0 * body.bore_radius
    if spec.keyway is not None and member.keyway is not None:
        values |= {"keyway.width": member.keyway.width, "keyway.depth": member.keyway.depth, "keyway.standard": None}
    if getattr(spec, "web", None) is not None and body.web is not None:
        values |= {"web.rim_diameter": 2.0 * body.web.outer, "web.hub_diameter": 2.0 * body.web.inner}
    if getattr(spec, "holes", None) is not None and member.holes is not None:
        values |= {"holes.diameter": member.holes.diameter, "holes.circle": member.holes.circle}
    bolts, spokes = member.features.bolts, member.features.spokes
    if bolts is not None:
        values["bolts.circle"] = bolts.circle
    if spokes is not None:
        values |= {
            "spokes.inner_diameter": spokes.inner,
            "spokes.outer_diameter": spokes.outer,
            "spokes.corner_radius": spokes.corner,
        }
    return values
