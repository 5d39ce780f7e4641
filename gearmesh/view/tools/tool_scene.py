"""Picture of a member with its tool, in the position in which the tool generates the middle of a flank."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

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
#: room beside a member in a picture that does not hold all of it, and the heading, as shares of the picture's height
ROOM_SHARES = (0.04, 0.11)
#: factor up to which the picture of a tool with its axes may be larger than the picture of the tool
MAX_TOOL_GROWTH = 2.0
#: rows of the raster in which bodies, lines and words are looked for beneath a word
RASTER_ROWS = 200
#: points along each side of a small and of a large triangle that mark it in this raster
MARKS_PER_SIDE = (12, 72)
#: longest side, in rows of the raster, from which a triangle is large
LARGE_SIDE_ROWS = 11.0
#: height of a word and mean width of its letters, as shares of the picture's height
WORD_SHARES = (0.034, 0.0122)
#: distance of a word from the end of its axis, as a share of the picture's height
WORD_GAP_SHARE = 0.012
#: lengths, as shares of the picture's height, by which an axis may be drawn longer, so that its name is on the ground
AXIS_STRETCHES = tuple(0.025 * step for step in range(13))
#: length, as such a share, at which a name is rather at the other end of its axis
OTHER_END_STRETCH = 0.06
#: length, as such a share, that counts as much as a cell of the raster beneath a name or close to it
COVERED_CELL_STRETCH = 0.05
#: opacity of a tool's working surfaces
SHEET_OPACITY = 0.55
#: opacity of the mesh of a tool
PART_OPACITY = 0.75
#: smallest sine of the angle between an axis and the line of sight at which the axis is named
MIN_AXIS_SINE = 0.05
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
    tool_points, look = tool.tool_to_own.point(mesh.vertices), _looking(tool, grid)
    lines = [(axis, _along(axis, tool_points)) for axis in tool.axes]
    # the member's axis is drawn only together with axes of tool and machine
    if tool.axes:
        own = MachineAxis(f"axis of the {member.name}", np.zeros(3), Z_AXIS)
        lines.append((own, _along(own, member.vertices)))
    if tool.axes:
        whole = frame(*look, np.concatenate((seen, *(ends for _, ends in lines))), size, TOOL_MARGIN)
        most = MAX_TOOL_GROWTH
    else:
        whole, most = frame(*look, seen, size, WHOLE_MARGIN), MAX_WHOLE_GROWTH
    close = frame(*look, tool_points, size, CLOSE_MARGIN)
    camera = whole if whole.height < most * close.height else _slid(close, seen, size)
    ground, words, curves = _Ground(camera, size), list[Word](), list[Curve]()
    for body in bodies:
        ground.mark_triangles(body.mesh.move(body.own_to_scene).corners())
    for k, (axis, ends) in enumerate(lines):
        others = [other for _, other in (*lines[:k], *lines[k + 1 :])]
        ends, word = _named(axis, ends, ground.beside(others))
        lines[k] = axis, ends
        if word is not None:
            ground.write(word)
        colour = MEMBER_COLOUR if axis.direction is Z_AXIS else MACHINE_COLOUR
        curves.append(Curve(ends, colour=colour, width=2.5))
        words += [] if word is None else [word]
    outline = [tool.tool_to_own.point(outline) for outline in tool.outlines]
    curves += [Curve(line, "section of the tool at the middle of the flank", OUTLINE_COLOUR, 3.0) for line in outline]
    middle = Dots(tool.touching.r[None], "middle of the flank, being generated", PATH_COLOUR, 9.0)
    return Scene(bodies, camera, tuple(curves), (middle,), words=tuple(words), title=title, size=size)


def _slid(camera: Camera, points: Array, size: tuple[int, int]) -> Camera:
    """Return the camera moved so that no side is blank while points (K, 3) are cut off at the side across."""
    places, (room, heading) = (points - camera.focus) @ camera.axes[:2].T / camera.height, ROOM_SHARES
    edge = 0.5 * np.array([size[0] / size[1], 1.0]) - room
    # lengths of what is blank, below zero of what is cut off: at the left and below, at the right and above
    first, last = edge + places.min(axis=0), edge - np.array([0.0, heading]) - places.max(axis=0)
    shift = np.where(first > 0.0, np.clip(-last, 0.0, first), -np.clip(-first, 0.0, np.maximum(last, 0.0)))
    return camera.moved(camera.height * shift @ camera.axes[:2], camera.height)


@dataclass(frozen=True)
class _Ground:
    """Raster of a picture: True where something is drawn that a word would cover."""

    #: camera of the picture
    camera: Camera
    #: width and height of the picture, pixels
    size: tuple[int, int]
    #: cells (RASTER_ROWS, N), from below
    taken: NDArray[np.bool_] = field(init=False)

    def __post_init__(self) -> None:
        columns = round(RASTER_ROWS * self.size[0] / self.size[1])
        object.__setattr__(self, "taken", np.zeros((RASTER_ROWS, columns), dtype=bool))

    def place(self, points: Array) -> Array:
        """Places (..., 2) of points (..., 3), to the right and up from the middle, as shares of the picture's height."""
        places: Array = (points - self.camera.focus) @ self.camera.axes[:2].T / self.camera.height
        return places

    def mark(self, points: Array) -> None:
        """Mark what is at points (K, 3)."""
        self._mark(self.place(points))

    def mark_triangles(self, corners: Array) -> None:
        """Mark triangles (T, 3, 3)."""
        sides = np.roll(corners, -1, axis=1) - corners
        large = np.linalg.norm(sides, axis=-1).max(axis=1) > LARGE_SIDE_ROWS / RASTER_ROWS * self.camera.height
        for which, side in zip((~large, large), MARKS_PER_SIDE, strict=True):
            self.mark(_marks(corners[which], side))

    def _mark(self, places: Array) -> None:
        rows, columns = self.taken.shape
        across, up = np.floor(places * RASTER_ROWS + 0.5 * np.array([columns, rows])).astype(np.int64).T
        inside = (across >= 0) & (across < columns) & (up >= 0) & (up < rows)
        self.taken[up[inside], across[inside]] = True

    def beside(self, lines: Sequence[Array]) -> _Ground:
        """Return the ground with lines between ends (2, 3) marked."""
        ground = _Ground(self.camera, self.size)
        ground.taken[...] = self.taken
        for ends in lines:
            ground.mark(np.linspace(ends[0], ends[1], 2 * RASTER_ROWS))
        return ground

    def box(self, text: str, end: Array, way: Array) -> tuple[Array, Array]:
        """Corners (2,) of the box of a word beyond a place `end` (2,) in the direction `way` (2,)."""
        high, letter = WORD_SHARES
        half = 0.5 * np.array([letter * len(text), high])
        middle = end + (float((half / np.maximum(np.abs(way), 1e-9)).min()) + WORD_GAP_SHARE) * way
        return middle - half, middle + half

    def covered(self, low: Array, high: Array) -> int | None:
        """Number of marked cells in a box and close around it; None if the box is not wholly in the picture."""
        rows, columns = self.taken.shape
        middle = 0.5 * np.array([columns, rows])
        left, below = np.floor((low - WORD_GAP_SHARE) * RASTER_ROWS + middle).astype(int)
        right, above = np.ceil((high + WORD_GAP_SHARE) * RASTER_ROWS + middle).astype(int)
        if left < 0 or below < 0 or right > columns or above > rows:
            return None
        return int(np.count_nonzero(self.taken[below:above, left:right]))

    def write(self, word: Word) -> None:
        """Mark the box of a word."""
        end, inside = self.place(word.point), self.place(word.inside)
        way = (end - inside) / float(np.hypot(*(end - inside)))
        x, y = (np.linspace(*ends, RASTER_ROWS) for ends in zip(*self.box(word.text, end, way), strict=True))
        self._mark(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))


def _named(axis: MachineAxis, ends: Array, ground: _Ground) -> tuple[Array, Word | None]:
    """Return the ends (2, 3) of an axis and the word with its name, at the end where it covers least; None if the axis
    is out of sight.

    It is rather at the upper end; the member's axis, which is z, rather has it at the end towards the viewer. An axis is
    drawn longer where its name would cover something.
    """
    camera = ground.camera
    first = int(np.argmax(ends @ camera.axes[2 if axis.direction is Z_AXIS else 1]))
    choices = []
    for k in (first, 1 - first):
        outwards = unit(ends[k] - ends[1 - k])
        way = ground.place(outwards + camera.focus)
        length = float(np.hypot(*way))
        if length * camera.height < MIN_AXIS_SINE:
            continue
        for stretch in AXIS_STRETCHES:
            end = ends[k] + stretch / length * outwards
            low, high = ground.box(axis.name, ground.place(end), way / length)
            covered = ground.covered(low, high)
            if covered is not None:
                cost = stretch + OTHER_END_STRETCH * (k != first) + COVERED_CELL_STRETCH * covered
                choices.append((cost, k, end))
    if not choices:
        return ends, None
    _, k, end = min(choices, key=lambda choice: choice[:2])
    longer = ends.copy()
    longer[k] = end
    return longer, Word(axis.name, end, longer[1 - k])


def _marks(corners: Array, side: int) -> Array:
    """Points (K, 3) that are spread over triangles (T, 3, 3), `side` of them along each side."""
    a, b = (index.ravel() for index in np.indices((side, side)))
    kept = a + b < side
    weights = np.stack((a[kept], b[kept], side - 1 - a[kept] - b[kept]), axis=-1) / (side - 1)
    return np.asarray(weights @ corners).reshape(-1, 3)


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
