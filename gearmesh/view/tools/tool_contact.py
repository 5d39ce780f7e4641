"""Picture of a tool and of the tooth that it generates, with their lines of contact [CR3553 1.5; LF04 Fig. 18.4.3].

Both surfaces are opened like a book, about the tooth's root, which the tool's tip generates. Toe and heel stay on the
same side.

      ___________ tip
     |_tooth_____|       seen from the tool
         root
         tip
     |‾tool‾‾‾‾‾‾|       seen from the tooth
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.generation.contact_lines import ContactLine, ToolContact
from gearmesh.tools.drawing import ToolSheet
from gearmesh.view.palette import CURVE_COLOURS, INK_COLOUR
from gearmesh.view.scene import STEEL_PAINT, TOOL_PAINT, Camera, Curve, Scene, SceneBody, Word
from gearmesh.view.tools.tool_scene import sheet_mesh
from gearmesh.view.views import frame

#: largest share of the picture's width that tool and tooth take
FILLED_WIDTH_SHARE = 0.88
#: shares of the picture's height above tool and tooth, for a legend of two rows, and below them, for the scale
HEIGHTS_AROUND = (0.14, 0.07)
#: distance between tool and tooth, in heights of the generating surface
GAP_HEIGHTS = 0.22
#: smallest share of the picture's height that tool and tooth take; longer ones are turned away from the viewer
MIN_FILLED_HEIGHT = 0.62
#: largest angle by which they are turned: farther, the end of a helical tooth would hide its flank
MAX_TURN_RAD = np.radians(70.0)
#: distance from the middle of a line of contact up to which a thread is shown, relative to the size of the tooth
VISIBLE_THREAD_SHARE = 0.5
#: height of lines above the generating surface, relative to its size
LIFT_SIZE_SHARE = 1e-3


def tool_contact_scene(
    tool: ToolContact, tooth: TriangleMesh, title: str = "", size: tuple[int, int] = (1600, 1200)
) -> Scene:
    """Scene of the tool's generating side, and above it the mesh of that `tooth`, own frame; in the tool's frame."""
    tool = _part_in_sight(tool)
    mesh, active = sheet_mesh(tool.sheets, tool.name), tool.active
    lift = LIFT_SIZE_SHARE * float(np.linalg.norm(np.ptp(active.points.reshape(-1, 3), axis=0)))
    seen = _axes(active, -1.0, tool.sheets[0].points)
    placed = _open(tool, seen, tooth)
    # rim of the generating surface; along a thread only the contact lines are drawn
    rim = _rim(active.points - lift * active.normals)
    curves = [Curve(rim, colour=INK_COLOUR, width=2.0)] if tool.rolls else []
    for colour, line in zip(CURVE_COLOURS, tool.lines, strict=False):
        points, normals = line.on_tooth
        curves.append(Curve(line.points - lift * line.normals, _caption(tool, line), colour, 4.0))
        curves.append(Curve(placed.point(points + lift * normals), colour=colour, width=4.0))
    shown = placed.point(tooth.vertices)
    both = np.concatenate((_near(tool).reshape(-1, 3), shown))
    camera = replace(_filled(_turned(seen, both, size), seen[1], both, size), measured=seen[0])
    grid = placed.point(tool.flank.points)
    i, j = (n // 2 for n in grid.shape[:2])
    words = tuple(Word(word, grid[i, k], grid[i, j]) for word, k in zip(tool.ends, (0, -1), strict=True))
    bodies = (SceneBody(mesh, Rigid.identity(), TOOL_PAINT), SceneBody(tooth, placed, STEEL_PAINT))
    return Scene(bodies, camera, tuple(curves), words=words, title=title, size=size)


def _filled(back: Array, up: Array, points: Array, size: tuple[int, int]) -> Camera:
    """Return the camera with directions (3,) back and upwards in which points (K, 3) fill the room below the heading."""
    camera, (above, below) = frame(back, up, points, size, 1.0), HEIGHTS_AROUND
    wide, high = np.ptp(points @ camera.axes[:2].T, axis=0)
    height = float(max(high / (1.0 - above - below), wide * size[1] / size[0] / FILLED_WIDTH_SHARE))
    return camera.moved(0.5 * (above - below) * height * camera.axes[1], height)


def _turned(seen: Array, points: Array, size: tuple[int, int]) -> Array:
    """Direction (3,) to the viewer of points (K, 3) along the rows of `seen` (3, 3), right, up and back.

    It is turned about the direction upwards, by `MAX_TURN_RAD` at most, until the points take `MIN_FILLED_HEIGHT`.
    """
    length, height = np.ptp(points @ seen[:2].T, axis=0)
    filled = MIN_FILLED_HEIGHT * length * size[1] / size[0] / FILLED_WIDTH_SHARE
    turn = np.arccos(np.clip(height / max(filled, height), np.cos(MAX_TURN_RAD), 1.0))
    return np.asarray(np.cos(turn) * seen[2] + np.sin(turn) * seen[0])


def _part_in_sight(tool: ToolContact) -> ToolContact:
    """Return a tool that is fed with only a part of its thread and of its line of contact; other tools as they are.

    The line goes round the worm. The part is about as long as the tooth, which a whole worm would make small.
    """
    if tool.rolls:
        return tool
    (line,) = tool.lines
    known = line.points[np.isfinite(line.points[:, 0])]
    middle = known[len(known) // 2]
    reach = VISIBLE_THREAD_SHARE * float(np.linalg.norm(np.ptp(tool.flank.points.reshape(-1, 3), axis=0)))

    def part(sheet: ToolSheet) -> ToolSheet:
        away = np.linalg.norm(sheet.points - middle, axis=-1).min(axis=0)
        nearest, far = int(away.argmin()), np.flatnonzero(away > reach)
        kept = slice(int(far[far < nearest].max(initial=-1)) + 1, int(far[far > nearest].min(initial=len(away))))
        return replace(sheet, points=sheet.points[:, kept], normals=sheet.normals[:, kept])

    near = np.linalg.norm(line.points - middle, axis=-1) <= reach
    short = replace(line, points=np.where(near[:, None], line.points, np.nan))
    return replace(tool, sheets=tuple(map(part, tool.sheets)), active=part(tool.active), lines=(short,))


def _axes(sheet: ToolSheet, sense: float, level_as: Array | None = None) -> Array:
    """Rows (3, 3): directions to the right, up and towards the viewer of a grid from root to tip and from toe to heel.

    The viewer is on the side of `sense` times the normals. The tool, seen against its normals, has its tip at the
    tooth's root. A grid `level_as` (K, L, 3) is level instead if it is given: a tapered tooth touches its tool aslant.
    """
    i, j = (n // 2 for n in sheet.points.shape[:2])
    back, rise = sense * sheet.normals[i, j], sense * (sheet.points[-1, j] - sheet.points[0, j])
    rows = sheet.points if level_as is None else level_as
    level = unit(cross(back, rows[len(rows) // 2, -1] - rows[len(rows) // 2, 0]))
    up = level * np.sign(level @ rise)
    return np.stack((cross(up, back), up, back))


def _open(tool: ToolContact, seen: Array, tooth: TriangleMesh) -> Rigid:
    """Motion from the tooth's own frame to the tool's: the tooth is above the tool as `seen` (3, 3), its flank to the
    viewer.
    """
    turn = seen.T @ _axes(tool.flank, 1.0)
    near, flank = _near(tool).reshape(-1, 3) @ seen.T, tool.flank.points.reshape(-1, 3) @ turn.T @ seen.T
    shift = 0.5 * (near.max(axis=0) + near.min(axis=0) - flank.max(axis=0) - flank.min(axis=0))
    above = near[:, 1].max() + GAP_HEIGHTS * float(np.ptp(near[:, 1]))
    shift[1] = above - (tooth.vertices @ turn.T @ seen.T)[:, 1].min()
    return Rigid(turn, shift @ seen)


def _near(tool: ToolContact) -> Array:
    """Points (K, 3) of the tool that the picture must hold."""
    return np.concatenate([sheet.points.reshape(-1, 3) for sheet in tool.sheets])


def _caption(tool: ToolContact, line: ContactLine) -> str:
    if tool.rolls:
        return f"rotation {np.degrees(line.at):.2f}°"
    return f"contact at the feed of {line.at:.2f} mm"


def _rim(grid: Array) -> Array:
    """Points (K, 3) round the edge of a grid (I, J, 3)."""
    return np.concatenate((grid[0], grid[1:, -1], grid[-1, -2::-1], grid[-2::-1, 0]))
