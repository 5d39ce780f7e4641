"""Picture of a member with its tool, in the position in which the tool generates the middle of a flank."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearmesh.kernel.motion.motion import MachineAxis
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, cross, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.generation.tool_in_place import ToolInPlace
from gearmesh.tools.drawing import ToolSheet
from gearmesh.view.palette import INK_COLOUR, LINE_COLOUR, OUTLINE_COLOUR, PATH_COLOUR
from gearmesh.view.scene import STEEL_PAINT, TOOL_PAINT, Camera, Curve, Dots, Scene, SceneBody, Word
from gearmesh.view.views import frame

#: size of the picture relative to member, tool and axes
TOOL_MARGIN = 1.45
#: size of the picture relative to a rack or shaper, whose axes are too far away to be shown
CLOSE_MARGIN = 2.2
#: size of the picture relative to a member and such a tool
WHOLE_MARGIN = 1.3
#: factor up to which this picture may be larger than the picture of the tool, so that the whole member is shown
MAX_WHOLE_GROWTH = 1.4
#: factor up to which the picture of a tool with its axes may be larger than the picture of the tool
MAX_TOOL_GROWTH = 2.0
#: smallest distances of words across and up, as shares of the picture's height; one of them must hold
MIN_WORD_DISTANCES = (0.35, 0.08)
#: opacity of a tool's working surfaces
SHEET_OPACITY = 0.55
#: opacity of the mesh of a tool
PART_OPACITY = 0.75
#: length of an axis beyond its body, relative to the body's size
AXIS_OVERHANG = 0.12
#: components of the direction of view: up the tooth, along it beyond the heel, and along the flank's normal
VIEW_COMPONENTS = (0.55, 0.6, 0.45)
#: axes of tool and machine
MACHINE_COLOUR = LINE_COLOUR
#: axis of the member
MEMBER_COLOUR = INK_COLOUR


def tool_scene(
    member: TriangleMesh,
    tool: ToolInPlace,
    grid: Array,
    part: TriangleMesh | None = None,
    title: str = "",
    size: tuple[int, int] = (1600, 1200),
) -> Scene:
    """Scene of a member's mesh, own frame, with its tool in place, or with the mesh `part` of the tool, in the tool's
    frame.

    `grid` (I, J, 3): points of the generated flank, from root to tip and from toe to heel.
    """
    mesh = sheet_mesh(tool.sheets, tool.name) if part is None else part
    opacity = SHEET_OPACITY if part is None else PART_OPACITY
    bodies = (
        SceneBody(member, Rigid.identity(), STEEL_PAINT),
        SceneBody(mesh, tool.tool_to_own, TOOL_PAINT, opacity=opacity),
    )
    seen = np.concatenate((member.vertices, tool.tool_to_own.point(mesh.vertices)))
    lines = [(axis, _along(axis, tool.tool_to_own.point(mesh.vertices))) for axis in tool.axes]
    own = MachineAxis(f"axis of the {member.name}", np.zeros(3), Z_AXIS)
    lines.append((own, _along(own, member.vertices)))
    curves = [Curve(ends, colour=MEMBER_COLOUR if axis is own else MACHINE_COLOUR, width=2.5) for axis, ends in lines]
    outline = [tool.tool_to_own.point(outline) for outline in tool.outlines]
    curves += [Curve(line, "section of the tool at the middle of the flank", OUTLINE_COLOUR, 3.0) for line in outline]
    tool_points, look = tool.tool_to_own.point(mesh.vertices), _looking(tool, grid)
    if tool.axes:
        whole = frame(*look, np.concatenate((seen, *(ends for _, ends in lines))), size, TOOL_MARGIN)
        most = MAX_TOOL_GROWTH
    else:
        whole, most = frame(*look, seen, size, WHOLE_MARGIN), MAX_WHOLE_GROWTH
    close = frame(*look, tool_points, size, CLOSE_MARGIN)
    camera = whole if whole.height < most * close.height else close
    words = [_axis_name(*line, camera) for line in lines] if tool.axes else []
    words = [word for word in words if _in_sight(word, camera, size)]
    if any(_too_near(words[-1], word, camera) for word in words[:-1]):
        words[-1] = replace(words[-1], point=words[-1].inside, inside=words[-1].point)
    middle = Dots(tool.touching.r[None], "middle of the flank, being generated", PATH_COLOUR, 9.0)
    return Scene(bodies, camera, tuple(curves), (middle,), words=tuple(words), title=title, size=size)


def _axis_name(axis: MachineAxis, ends: Array, camera: Camera) -> Word:
    """Word with the name of an axis, at its upper end; the member's axis, which is z, has it at the end towards the
    viewer.
    """
    k = int(np.argmax(ends @ camera.axes[2 if axis.direction is Z_AXIS else 1]))
    return Word(axis.name, ends[k], ends[1 - k])


def _in_sight(word: Word, camera: Camera, size: tuple[int, int]) -> bool:
    """True if the point of a word is in a picture of a size."""
    place = camera.axes[:2] @ (word.point - camera.focus) / camera.height
    return bool((np.abs(place) < 0.5 * np.array([size[0] / size[1], 1.0])).all())


def _too_near(word: Word, other: Word, camera: Camera) -> bool:
    """True if two words are too near to each other to be read."""
    apart = np.abs(camera.axes[:2] @ (word.point - other.point)) / camera.height
    return bool((apart < MIN_WORD_DISTANCES).all())


def _along(axis: MachineAxis, points: Array) -> Array:
    """Ends (2, 3) of the part of an axis that reaches beyond points (K, 3)."""
    along = (points - axis.point) @ axis.direction
    out = AXIS_OVERHANG * float(np.linalg.norm(np.ptp(points, axis=0)))
    ends = np.array([along.min() - out, along.max() + out])
    return np.asarray(axis.point + ends[:, None] * axis.direction)


def _looking(tool: ToolInPlace, grid: Array) -> tuple[Array, Array]:
    """Direction of view and direction upwards, (3,) each; the camera is up the tooth, at its heel, before its flank."""
    i, j = grid.shape[0] // 2, grid.shape[1] // 2
    up, length = unit(grid[-1, j] - grid[0, j]), unit(grid[i, -1] - grid[i, 0])
    up = unit(up - (up @ tool.touching.n) * tool.touching.n)
    up_part, length_part, before = VIEW_COMPONENTS
    return up_part * up + length_part * length + before * tool.touching.n, up


def sheet_mesh(sheets: Sequence[ToolSheet], name: str) -> TriangleMesh:
    """Return grids of a tool as one open mesh; its triangles face out of the tool."""
    names = tuple(dict.fromkeys(sheet.region for sheet in sheets))
    vertices, triangles, regions, normals, count = [], [], [], [], 0
    for sheet in sheets:
        rows, columns = sheet.points.shape[:2]
        index = count + np.arange(rows * columns).reshape(rows, columns)
        if np.allclose(sheet.points[:, 0], sheet.points[:, -1]):
            index[:, -1] = index[:, 0]
        a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
        cells = np.concatenate([np.stack(corners_of, axis=-1).reshape(-1, 3) for corners_of in ((a, b, c), (a, c, d))])
        corners = sheet.points.reshape(-1, 3)[cells - count]
        outwards = -sheet.normals.reshape(-1, 3)[cells - count].mean(axis=1)
        facing = dot(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), outwards) < 0.0
        cells[facing] = cells[facing, ::-1]
        vertices.append(sheet.points.reshape(-1, 3))
        triangles.append(cells)
        regions.append(np.full(len(cells), names.index(sheet.region), dtype=np.int32))
        normals.append(unit(outwards))
        count += rows * columns
    points, cells, places, outwards = (np.concatenate(parts) for parts in (vertices, triangles, regions, normals))
    return TriangleMesh(points, cells, places, names, outwards, name)
