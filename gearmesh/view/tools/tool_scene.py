"""The picture of a member with its tool, in the position in which it generates the middle of a flank."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearmesh.kernel.motion.motion import MachineAxis
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import AXIS, Array, cross, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.generation.tool_in_place import ToolInPlace
from gearmesh.tools.drawing import ToolSheet
from gearmesh.view.palette import INK, LINES, OUTLINE, PATH
from gearmesh.view.scene import STEEL, TOOL, Camera, Curve, Dots, Scene, SceneBody, Word
from gearmesh.view.views import frame

#: by how much a picture is larger than what it holds: member, tool and axes, or a rack or shaper alone, whose axes are far away
MARGIN, CLOSE = 1.45, 2.2
#: parts of the picture's height, across and up, that words are apart at least in one of them
CROWDED = (0.35, 0.08)
#: how much of what is behind the tool it hides: working surfaces alone, and a whole part
VEIL, PART_VEIL = 0.55, 0.75
#: how far axes stand out beyond what they are the axes of, in its reach
OUT = 0.12
#: direction that a picture is taken from: parts up the tooth, along it beyond the heel, and along the flank's normal
FROM = (0.55, 0.6, 0.45)
#: colours of the axes of tool and machine, and of the member
MACHINE, OWN = LINES, INK


def tool_scene(
    member: TriangleMesh,
    tool: ToolInPlace,
    grid: Array,
    part: TriangleMesh | None = None,
    title: str = "",
    size: tuple[int, int] = (1600, 1200),
) -> Scene:
    """A member's mesh, own frame, with its tool, or with the mesh `part` of the tool, in the tool's frame, in its place.

    `grid` (I, J, 3): points of the flank that is generated, from root to tip and from toe to heel.
    """
    mesh = sheet_mesh(tool.sheets, tool.name) if part is None else part
    opacity = VEIL if part is None else PART_VEIL
    bodies = (SceneBody(member, Rigid.identity(), STEEL), SceneBody(mesh, tool.tool_to_own, TOOL, opacity=opacity))
    seen = np.concatenate((member.vertices, tool.tool_to_own.point(mesh.vertices)))
    lines = [(axis, _along(axis, tool.tool_to_own.point(mesh.vertices))) for axis in tool.axes]
    own = MachineAxis(f"axis of the {member.name}", np.zeros(3), AXIS)
    lines.append((own, _along(own, member.vertices)))
    curves = [Curve(ends, colour=OWN if axis is own else MACHINE, width=2.5) for axis, ends in lines]
    outline = [tool.tool_to_own.point(outline) for outline in tool.outlines]
    curves += [Curve(line, "section of the tool at the middle of the flank", OUTLINE, 3.0) for line in outline]
    if tool.axes:
        held, margin = np.concatenate((seen, *(ends for _, ends in lines))), MARGIN
    else:
        held, margin = tool.tool_to_own.point(mesh.vertices), CLOSE
    camera = frame(*_looking(tool, grid), held, size, margin)
    words = [_axis_name(*line, camera) for line in lines] if tool.axes else []
    if any(_too_near(words[-1], word, camera) for word in words[:-1]):
        words[-1] = replace(words[-1], point=words[-1].inside, inside=words[-1].point)
    middle = Dots(tool.touching.r[None], "middle of the flank, being generated", PATH, 9.0)
    return Scene(bodies, camera, tuple(curves), (middle,), words=tuple(words), title=title, size=size)


def _axis_name(axis: MachineAxis, ends: Array, camera: Camera) -> Word:
    """The name of an axis at its upper end, that of the member's, which is z, where it comes towards the viewer."""
    k = int(np.argmax(ends @ camera.axes[2 if axis.direction is AXIS else 1]))
    return Word(axis.name, ends[k], ends[1 - k])


def _too_near(word: Word, other: Word, camera: Camera) -> bool:
    """Whether two words stand too near to each other to be read."""
    apart = np.abs(camera.axes[:2] @ (word.point - other.point)) / camera.height
    return bool((apart < CROWDED).all())


def _along(axis: MachineAxis, points: Array) -> Array:
    """The ends (2, 3) of the part of an axis that stands out beyond points (K, 3)."""
    along = (points - axis.point) @ axis.direction
    out = OUT * float(np.linalg.norm(np.ptp(points, axis=0)))
    ends = np.array([along.min() - out, along.max() + out])
    return np.asarray(axis.point + ends[:, None] * axis.direction)


def _looking(tool: ToolInPlace, grid: Array) -> tuple[Array, Array]:
    """Where to look from, and what is upwards, (3,) each: up the tooth, from its heel and from before its flank."""
    i, j = grid.shape[0] // 2, grid.shape[1] // 2
    up, length = unit(grid[-1, j] - grid[0, j]), unit(grid[i, -1] - grid[i, 0])
    up = unit(up - (up @ tool.touching.n) * tool.touching.n)
    up_part, length_part, before = FROM
    return up_part * up + length_part * length + before * tool.touching.n, up


def sheet_mesh(sheets: Sequence[ToolSheet], name: str) -> TriangleMesh:
    """Grids of a tool as one open mesh, its triangles turned as their normals point out of the tool."""
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
