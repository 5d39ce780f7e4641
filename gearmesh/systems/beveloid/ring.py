"""Internal members of beveloid pairs: involute helicoids of cone angle 0, as a form tool leaves them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.beveloid.form_tool import form_tools
from gearmesh.systems.common.bodies.features import UnderTeeth, ring_features
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.micro_geometry import with_true_involutes
from gearmesh.systems.common.racks.ring_member import formed_side, prove_internal, ring_blank
from gearmesh.systems.common.racks.tool_roundings import with_roundings
from gearmesh.systems.common.tooth_edges import tip_edge
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.teeth.source_parameters import NamedParameters, SourceParameter
from gearmesh.teeth.tooth import Tooth
from gearmesh.tools.shaper import Shaper

if TYPE_CHECKING:
    from gearmesh.systems.beveloid.design import BeveloidMember

#: default rim of an internal gear, in normal modules
DEFAULT_RIM_MODULES = 3.0


def ring(
    name: str, spec: BeveloidMember, module: float, angles: tuple[float, float], reduction: float, coast: Side
) -> Member:
    """Return an internal member (in mm), proved to have closed, unpointed teeth from end to end.

    Arguments as for `form_tools`; `coast`: flanks of the coast side. Raises DesignError naming key, value and limit.
    """
    sharp = form_tools(name, spec, module, angles, reduction)
    drive = sharp[coast is Side.RIGHT]
    rounded = with_roundings(name, spec, module, drive, "the spaces are too narrow for such root fillets")
    shaper, other = (rounded, rounded.other_flank)[:: -1 if coast is Side.RIGHT else 1]
    tip = shaper.pitch_radius - (spec.addendum + spec.profile_shift) * module
    tip = tip if spec.tip_diameter is None else 0.5 * spec.tip_diameter
    for tool in (shaper, other):
        _check_tip(name, spec, tool, tip)
    twist = math.tan(math.radians(spec.helix_angle)) / shaper.pitch_radius
    rim = DEFAULT_RIM_MODULES * module if spec.rim is None else spec.rim
    tooth = Tooth(
        spec.teeth,
        formed_side(shaper, Side.RIGHT, twist, tip),
        formed_side(other, Side.LEFT, twist, tip),
        ring_blank(0.5 * spec.face_width, tip, shaper.top_radius, rim),
        tip_edge=tip_edge(spec, coast=coast),
    )
    prove_internal(name, tooth, f"another {name}.profile_shift")
    parameters = NamedParameters(
        (
            SourceParameter("theta_G", "deg", "roll angle of the involute, from the base circle"),
            SourceParameter("u_G", "mm", "distance along the axis, from mid face"),
        ),
        lambda p, v: (np.degrees(p), v),
    )
    under = UnderTeeth(name, tooth, tooth.blank.body, shaper.top_radius, shaper.top_radius, module)
    made = Member(name, tooth, parameters, ring_features(spec, under))
    return made if spec.modified else with_true_involutes(made, internal=True)


def _check_tip(name: str, spec: BeveloidMember, shaper: Shaper, tip: float) -> None:
    """Refuse a tip without involute, and root fillets that leave no flank below the tips."""
    key, value, unit = (
        ("addendum", spec.addendum, "") if spec.tip_diameter is None else ("tip_diameter", spec.tip_diameter, "mm")
    )
    if tip < shaper.base_radius:
        raise DesignError(
            f"{name}.{key}",
            value,
            unit=unit,
            reason="the involute ends on the base circle, before the tip",
            allowed=f"a tip diameter of at least {at_least(2.0 * shaper.base_radius)} mm, instead of {2.0 * tip:.7g} mm",
        )
    form = shaper.base_radius * math.hypot(1.0, shaper.form_point[0])
    if tip >= form:
        raise DesignError(
            f"{name}.{key}",
            value,
            unit=unit,
            reason="the root fillets leave no flank below the tips",
            allowed=f"a tip diameter of less than {at_most(2.0 * form)} mm, instead of {2.0 * tip:.7g} mm",
        )
