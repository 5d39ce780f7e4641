"""The picture of a tool path: the passes of a space on the gear, and the ball-end cutter on one of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gearmesh.answers.bodies.toolpath import ToolPathAnswer
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, unit
from gearmesh.mesh.solid import gear_solid
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.blank.features import BodyFeatures
from gearmesh.tools.drawing import ToolSheet
from gearmesh.view.palette import LINES, PATH
from gearmesh.view.scene import STEEL, TOOL, Curve, Scene, SceneBody
from gearmesh.view.tools.tool_scene import sheet_mesh
from gearmesh.view.views import frame

#: tolerance (mm) of the gear, and by how much the picture is larger than the space with its passes
GEAR, MARGIN = 0.02, 1.35
#: direction that it is taken from: parts out of the space, along it, and across it towards the wall that is seen worse
FROM = (1.0, 0.45, -0.4)
#: points round the cutter and up its ball; how much of its shank is shown, in depths of the space; how much of what is
#: behind it hides
AROUND, UP, SHOWN, OPAQUE = 48, 17, 2.5, 0.85
#: height of lines over the surface, as a share of the depth
LIFT = 2e-3


def path_scene(answer: ToolPathAnswer, size: tuple[int, int] = (1600, 1200), title: str = "") -> Scene:
    """The gear with all passes of the space before the tooth on +x, and the cutter half way along one over a flank."""
    path, passes = answer._path, answer._path.passes
    member = replace(path.space.member, features=BodyFeatures())
    gear = SceneBody(gear_solid(member, GEAR), Rigid.identity(), STEEL)
    station = passes.contacts.shape[1] // 2
    shown = int(np.flatnonzero(passes.side == passes.side.max())[-1]) * 3 // 4
    axis, centre = path.axes.vectors[shown, station], passes.centres[shown, station]
    cutter = cutter_mesh(path.ball.radius, min(path.ball.length, SHOWN * path.space.depth))
    body = SceneBody(cutter, Rigid(_frame(axis), centre), TOOL, opacity=OPAQUE)
    lifted = passes.contacts + LIFT * path.space.depth * passes.normals
    flank = np.array([path.space.walls[k].region.is_flank for k in passes.wall])
    curves = [
        Curve(_in_one(lifted[which]), label, colour, 1.6)
        for which, label, colour in (
            (flank, "passes of the flanks", LINES),
            (~flank, "passes of fillets and root", PATH),
        )
        if which.any()
    ]
    directions = passes.frames.at(station)
    back = unit(
        sum(
            share * of[0]
            for share, of in zip(FROM, (directions.opening, directions.feed, directions.across), strict=True)
        )
    )
    return Scene(
        (gear, body),
        frame(back, directions.across[0], lifted.reshape(-1, 3), size, MARGIN),
        tuple(curves),
        title=f"{title}: {answer.headline}" if title else answer.headline,
        size=size,
    )


def cutter_mesh(radius: float, length: float) -> TriangleMesh:
    """Ball and shank of a cutter, mm; the ball's centre at 0, the shank along +z."""
    turn = np.linspace(0.0, 2.0 * np.pi, AROUND + 1)
    below = np.linspace(-0.5 * np.pi, 0.0, UP)

    def sheet(region: str, rho: Array, z: Array, out: Callable[[Array], Array]) -> ToolSheet:
        points = np.stack(
            (np.outer(rho, np.cos(turn)), np.outer(rho, np.sin(turn)), np.outer(z, np.ones_like(turn))), -1
        )
        return ToolSheet(region, points, -out(points))

    def from_axis(points: Array) -> Array:
        return unit(points * [1.0, 1.0, 0.0])

    ball = sheet("flank", radius * np.cos(below) + 1e-9 * radius, radius * np.sin(below), unit)
    shank = sheet("shank", np.array([radius, radius]), np.array([0.0, length]), from_axis)
    return sheet_mesh((ball, shank), "cutter")


def _frame(axis: Array) -> Array:
    """Rotation (3, 3) that takes z to a unit axis (3,)."""
    aside = unit(cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))]))
    return np.stack((aside, cross(axis, aside), axis), axis=-1)


def _in_one(lines: Array) -> Array:
    """Lines (P, N, 3) as one polyline (K, 3), broken between them."""
    return np.concatenate([np.concatenate((line, np.full((1, 3), np.nan))) for line in lines])
