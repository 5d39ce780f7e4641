"""Widths of the slots between the blades that cut both sides of a space, at the root."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.algebra import unit as unit_vector
from gearmesh.kernel.surface.stations import along
from gearmesh.systems.common.bevel.blank import MemberBlank
from gearmesh.systems.common.bevel.tooth_measures import width_across
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.tools.rack import at_height


def slot_widths_of(tooth: Tooth, member: MemberBlank) -> Array:
    """Return the normal widths (3,), mm, of the slots between the blades' edges at the root, at toe, mean and heel.

    The blades' edges are prolonged to the root.
    """
    return slot_widths(tooth, np.array([tooth.blank.extent[0], member.mean_cone_distance, tooth.blank.extent[1]]))


def slot_widths(tooth: Tooth, stations: Array) -> Array:
    """Return the slot widths (T,), mm: root land between the fillets, and at each end the distance to the blade's edge."""
    ends, tangents, to_edges = [], [], np.zeros_like(stations)
    for side_of_tooth in Side:
        side = tooth.side(side_of_tooth)
        jet = along(side.fillet, np.full_like(stations, side.root), stations, tooth.blank.axial)[1]
        gradient = tooth.blank.axial.gradient(jet.r)
        # tangent along the end of the fillet, towards the heel; the left side is turned back by a pitch to one space
        back = Rigid.about_z(-tooth.pitch_angle if side_of_tooth is Side.LEFT else 0.0)
        ends.append(back.point(jet.r))
        tangents.append(back.vector(unit_vector(jet.r_v)) * np.sign(dot(gradient, jet.r_v))[:, None])
        tip, blade = side.tool.tip, side.tool.profile
        # the fillet ends at the tip land of the blade
        assert tip is not None
        assert blade is not None
        # distance from there to the cutting edge, prolonged to the tip plane
        edge = blade.section(np.array(at_height(blade, 0.0, side.form_point[0])))[0][1]
        to_edges += abs(float(tip.section(np.array(side.root))[0][1] - edge))
    return width_across((ends[0], ends[1]), tangents[0] + tangents[1]) + to_edges
