"""Picture of a tool path: the passes of a space on the gear, and the ball-end cutter on one of them."""

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
from gearmesh.view.palette import LINE_COLOUR, PATH_COLOUR
from gearmesh.view.scene import STEEL_PAINT, TOOL_PAINT, Curve, Scene, SceneBody
from gearmesh.view.tools.tool_scene import sheet_mesh
from gearmesh.view.views import frame

#: tolerance of the gear
GEAR_TOLERANCE_MM = 0.02
#: size of the picture relative to the space with its passes
PASSES_MARGIN = 1.35
#: components of the direction of view: out of the space, along it, and across it towards the hidden wall
VIEW_COMPONENTS = (1.0, 0.45, -0.4)
#: points round the cutter
CUTTER_POINTS_AROUND = 48
#: points from the pole of its ball to the equator
CUTTER_POINTS_UP = 17
#: visible length of the shank, in depths of the space
SHANK_DEPTHS = 2.5
#: opacity of the cutter
CUTTER_OPACITY = 0.85
#: height of lines above the surface, relative to the depth of the space
LIFT_DEPTH_SHARE = 2e-3


def path_scene(answer: ToolPathAnswer, size: tuple[int, int] = (1600, 1200), title: str = "") -> Scene:
    """Scene of the gear with all passes of the space before the tooth on +x, and the cutter half way along a flank
    pass.
    """
    path, passes = answer._path, answer._path.passes
    member = replace(path.space.member, features=BodyFeatures())
    gear = SceneBody(gear_solid(member, GEAR_TOLERANCE_MM), Rigid.identity(), STEEL_PAINT)
    station = passes.contacts.shape[1] // 2
    shown = int(np.flatnonzero(passes.side == passes.side.max())[-1]) * 3 // 4
    axis, centre = path.axes.vectors[shown, station], passes.centres[shown, station]
    cutter = cutter_mesh(path.ball.radius, min(path.ball.length, SHANK_DEPTHS * path.space.depth))
    body = SceneBody(cutter, Rigid(_frame(axis), centre), TOOL_PAINT, opacity=CUTTER_OPACITY)
    lifted = passes.contacts + LIFT_DEPTH_SHARE * path.space.depth * passes.normals
    flank = np.array([path.space.walls[k].region.is_flank for k in passes.wall])
    curves = [
        Curve(_in_one(lifted[which]), label, colour, 1.6)
        for which, label, colour in (
            (flank, "passes of the flanks", LINE_COLOUR),
            (~flank, "passes of fillets and root", PATH_COLOUR),
        )
        if which.any()
    ]
    directions = passes.frames.at(station)
    back = unit(
        sum(
            share * of[0]
            for share, of in zip(VIEW_COMPONENTS, (directions.opening, directions.feed, directions.across), strict=True)
        )
    )
    return Scene(
        (gear, body),
        frame(back, directions.across[0], lifted.reshape(-1, 3), size, PASSES_MARGIN),
        tuple(curves),
        title=f"{title}: {answer.headline}" if title else answer.headline,
        size=size,
    )


def cutter_mesh(radius: float, length: float) -> TriangleMesh:
    """Mesh of a cutter's ball and shank, mm; the ball's centre is at 0, the shank along +z."""
    turn = np.linspace(0.0, 2.0 * np.pi, CUTTER_POINTS_AROUND + 1)
    below = np.linspace(-0.5 * np.pi, 0.0, CUTTER_POINTS_UP)

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
    """Join lines (P, N, 3) to one polyline (K, 3), interrupted between them."""
    return np.concatenate([np.concatenate((line, np.full((1, 3), np.nan))) for line in lines])
