"""Scenes of motion: gears that turn through one pitch, and contact that rolls over a tooth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.answers.contact.rolling import RollingContact
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.view.on_tooth import ellipses_on_surface, lift_grid, union_level
from gearmesh.view.palette import LINE_COLOUR, OUTLINE_COLOUR
from gearmesh.view.scene import Curve, MemberContact, PatternArea, Scene, ToothView
from gearmesh.view.views import compound_scene, member_scene, pair_scene, pattern_scene

#: pictures of turning gears over one pitch
FRAMES_PER_PITCH = 24
#: positions of a tooth pair over one pitch, while contact rolls over a tooth
POSITIONS_PER_PITCH = 14
#: width of the contact line or outline at the present position, pixels
PRESENT_WIDTH = 4.0


def turning_scenes(
    rolling: RollingContact, meshes: dict[str, TriangleMesh], size: tuple[int, int], title: str
) -> list[Scene]:
    """Scenes of a pair at the positions of `rolling`, all seen by the camera of the first."""
    first, second = (meshes[name] for name in rolling.pair.members)
    scenes: list[Scene] = []
    for phi1, phi2 in zip(rolling.phi1.tolist(), rolling.phi2.tolist(), strict=True):
        scene = pair_scene(first, second, rolling.pair, (phi1, phi2), title, size)
        scenes.append(replace(scene, camera=scenes[0].camera) if scenes else scene)
    return scenes


def rolling_contact_scenes(view: ToothView, contact: MemberContact) -> list[Scene]:
    """Scenes of a tooth with one ellipse or contact line after the other, in the order of the positions.

    The path of contact is seen in all of them.
    """
    still = replace(member_scene(view, contact, 1), areas=())
    path = tuple(curve for curve in still.curves if curve.colour not in (LINE_COLOUR, OUTLINE_COLOUR))
    discs, outlines = ellipses_on_surface(contact, contact.ellipses, view.project, view.lift)
    outlines = outlines.reshape(len(contact.ellipses), -1, 3) if len(contact.ellipses) else outlines
    scenes = []
    for k in range(len(contact.point)):
        here = np.flatnonzero(contact.ellipses == k)
        areas = tuple(PatternArea(discs[i], label="contact ellipse") for i in here)
        curves = tuple(Curve(outlines[i], colour=OUTLINE_COLOUR, width=1.5) for i in here)
        line = contact.lines[k] if contact.lines else None
        if line is not None:
            raised = line + 1.5 * view.lift * contact.normal[k]
            curves += (Curve(raised, "contact line", LINE_COLOUR, PRESENT_WIDTH),)
        scenes.append(replace(still, areas=areas, curves=curves + path))
    return scenes


def growing_pattern_scenes(
    view: ToothView, contact: MemberContact, grid: Array, rubbed: str | None = None
) -> list[Scene]:
    """Scenes of a tooth whose contact pattern grows from the first position to the last.

    With `rubbed`, the legend of marking compound, it is the compound that goes. `grid` (I, J, 3) are points of the
    exact flank.
    """
    last = pattern_scene(view, contact, grid)
    lifted = lift_grid(grid, contact, view.lift)
    _, outlines = ellipses_on_surface(contact, contact.ellipses, view.project, view.lift)
    outlines = outlines.reshape(len(contact.ellipses), -1, 3)
    level, scenes = np.full(grid.shape[:-1], np.inf), []
    for i, k in enumerate(contact.ellipses):
        level = np.minimum(level, union_level(contact.at(np.arange(max(k - 1, 0), k + 1)), grid))
        outline = Curve(outlines[i], colour=OUTLINE_COLOUR, width=1.5)
        if rubbed is not None:
            share = np.clip(level**2, 0.0, 1.0)
            scene = compound_scene(view, contact, grid, share, rubbed, last.camera)
            scenes.append(replace(scene, curves=(outline,) if k < contact.ellipses[-1] else ()))
        else:
            area = PatternArea(lifted, level, "contact pattern: union of the ellipses")
            scenes.append(replace(last, areas=(area,), curves=(outline,)))
    return [*scenes[:-1], scenes[-1] if rubbed is not None else last]
