"""The picture of a tool's surface with its lines of contact with the tooth that it generates [CR3553 1.5]."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.algebra import Array, unit
from gearmesh.kernel.rigid import Rigid
from gearmesh.teeth.contact_lines import ContactLine, ToolContact
from gearmesh.view.palette import CURVES, INK
from gearmesh.view.scene import TOOL, Curve, Scene, SceneBody
from gearmesh.view.tool_scene import sheet_mesh
from gearmesh.view.views import framed

#: by how much a picture is larger than what generates the flank, and how far above the tool lines are drawn, in its size
MARGIN, LIFT = 1.35, 1e-3


def tool_contact_scene(tool: ToolContact, title: str = "", size: tuple[int, int] = (1600, 1200)) -> Scene:
    """The side of the tool that generates the flank, seen from the tooth, its tip on top, in the tool's frame."""
    mesh, active = sheet_mesh(tool.sheets, tool.name), tool.active
    lift = LIFT * float(np.linalg.norm(np.ptp(active.points.reshape(-1, 3), axis=0)))
    # what generates the flank; along a thread no more than the line itself
    rim = _rim(active.points - lift * active.normals)
    curves = [Curve(rim, colour=INK, width=2.0)] if tool.rolls else []
    for colour, line in zip(CURVES, tool.lines, strict=False):
        curves.append(Curve(line.points - lift * line.normals, _told(tool, line), colour, 4.0))
    i, j = (n // 2 for n in active.points.shape[:2])
    along, rise = unit(active.points[i, -1] - active.points[i, 0]), active.points[0, j] - active.points[-1, j]
    back, up = -active.normals[i, j], unit(rise - (rise @ along) * along)
    camera = framed(back, up, active.points.reshape(-1, 3), size, MARGIN)
    return Scene((SceneBody(mesh, Rigid.identity(), TOOL),), camera, tuple(curves), title=title, size=size)


def _told(tool: ToolContact, line: ContactLine) -> str:
    if tool.rolls:
        return f"rotation {np.degrees(line.at):.2f}°"
    return f"contact at the feed of {line.at:.2f} mm"


def _rim(grid: Array) -> Array:
    """The outer points (K, 3) of a grid (I, J, 3), once round."""
    return np.concatenate((grid[0], grid[1:, -1], grid[-1, -2::-1], grid[-2::-1, 0]))
