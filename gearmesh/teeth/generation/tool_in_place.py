"""The tool that generates a flank, in its position while it generates the middle of the flank.

A side of a tooth carries the description of its tool, and flank and fillet as surfaces that the tool generates. The
same tool also cuts the other side of a tooth or of a space if that side's tool has the same position.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearmesh.errors import ArgumentError, DesignError
from gearmesh.kernel.motion.motion import MachineAxis
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array
from gearmesh.kernel.surface.surface import GeneratedSurface, Jet
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.description import ToolDescription
from gearmesh.tools.drawing import DrawnPlace, DrawnSide, ToolSheet

#: distance (mm) and angle (rad) within which tools have the same position
SAME_POSITION = 1e-9


@dataclass(frozen=True)
class ToolInPlace:
    """A tool in its position over a member."""

    #: description of the tool
    description: ToolDescription
    #: transform from the tool's frame to the member's own frame
    tool_to_own: Rigid
    #: jet of the tool at the point that it generates, own frame; its normal points out of the member
    touching: Jet
    #: flank parameters (p, v) of that point
    place: tuple[float, float]
    #: known surfaces of the tool, tool's frame; none for a tool with a mesh of its own
    sheets: tuple[ToolSheet, ...]
    #: sections (K, 3) of the tool through the point, tool's frame, mm
    outlines: tuple[Array, ...]
    #: axes of the tool and its machine, own frame
    axes: tuple[MachineAxis, ...]

    @property
    def name(self) -> str:
        return self.description.name

    @property
    def as_part(self) -> bool:
        """True if the tool has a mesh of its own, which is then shown."""
        return self.description.drawing is not None and self.description.drawing.as_part


def tool_in_place(tooth: Tooth, which: Side) -> ToolInPlace:
    """Return the tool that generates one flank of a tooth, over the tooth as the tool leaves it.

    Raises DesignError if the tool is not drawn.
    """
    tooth = tooth.unmodified_tooth
    side = tooth.side(which)
    drawing, (flank, _) = side.tool.drawing, generation(side, "tool")
    if drawing is None:
        raise not_drawn(side, "tool")
    middle = tooth.flank_grid(which, [0.5], [0.5]).parameters[0, 0]
    u, v = middle
    motion, at_tool = flank.generating(u, v), flank.on_tool(u, v)
    tool_to_own, at_point = flank.tool_to_blank(*motion), flank.tool.jet(*at_tool)
    sides = [_draw_side(generated_side) for generated_side in (side, *_others(tooth, which, (motion, tool_to_own)))]
    reach = [tooth.flank_grid(flank_side, [0.0, 1.0], [0.0, 1.0]).parameters[..., 1] for flank_side in Side]
    place = DrawnPlace(middle, at_point.r, (float(np.min(reach)), float(np.max(reach))), tooth.pitch_angle)
    own_axes: tuple[MachineAxis, ...] = ()
    axis = drawing.axis_at(place)
    if axis is not None:
        axis_frame = tool_to_own @ axis
        own_axes = (MachineAxis(f"axis of the {side.tool.name}", axis_frame.translation, axis_frame.vector(Z_AXIS)),)
    return ToolInPlace(
        side.tool,
        tool_to_own,
        at_point.move(tool_to_own),
        (float(u), float(v)),
        *drawing.draw(sides, place),
        own_axes + flank.axes(*motion),
    )


def generation(side: ToothSide, view: str) -> tuple[GeneratedSurface, GeneratedSurface]:
    """Return flank and fillet of a side as its tool generates them. Raises DesignError, naming the `view`, if that is
    not known.
    """
    if side.generation is None:
        raise not_drawn(side, view)
    return side.generation


def not_drawn(side: ToothSide, view: str) -> DesignError:
    """Return the refusal for a side whose tool a `view` cannot show."""
    return ArgumentError(
        "view",
        view,
        reason=f"the {side.tool.name} that cuts this flank cannot be shown",
        allowed="a flank of head cutters, rack cutters, shapers, hobs, grinding worms or disks",
    )


def _others(tooth: Tooth, which: Side, standing: tuple[tuple[Array, ...], Rigid]) -> Iterator[ToothSide]:
    """Yield the other side if the same tool cuts it at the same time, in this tooth or in the next one beyond the
    space.

    `standing`: the motion's parameters, and the position of the tool.
    """
    other, (motion, position) = tooth.side(which.other), standing
    flank = None if other.generation is None else other.generation[0]
    if flank is None or flank.freedoms != len(motion):
        return
    other_position = flank.tool_to_blank(*motion)
    for number in (0, -which.sign, which.sign):
        turned_position = Rigid.about_z(number * tooth.pitch_angle) @ other_position
        apart = (
            np.abs(turned_position.rotation - position.rotation).max(),
            np.abs(turned_position.translation - position.translation).max(),
        )
        if max(apart) < SAME_POSITION:
            yield other
            return


def _draw_side(side: ToothSide) -> DrawnSide:
    """Return the surfaces of a side, for the drawing of its tool."""
    flank, fillet = generation(side, "tool")
    return DrawnSide(flank, fillet, side.form_point, side.root, side.tip)
