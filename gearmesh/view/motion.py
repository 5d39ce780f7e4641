"""Scenes of motion: gears that turn through one pitch, and contact that rolls over a tooth."""

from __future__ import annotations

from dataclasses import replace
from itertools import accumulate

import numpy as np

from gearmesh.answers.contact.rolling import RollingContact
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.view.on_tooth import ellipse_outlines, ellipses_on_surface, path_on_surface, position_dots, union_level
from gearmesh.view.palette import LINE_COLOUR, OUTLINE_COLOUR
from gearmesh.view.scene import Curve, MemberContact, PatternArea, Scene, ToothView
from gearmesh.view.views import compound_scene, compound_share, pair_scene, pattern_scene, tooth_scene

#: pictures of turning gears over one pitch
FRAMES_PER_PITCH = 24
#: positions of a tooth pair over one pitch, while contact rolls over a tooth
POSITIONS_PER_PITCH = 14
#: width of the contact line at the present position, pixels
LINE_WIDTH = 4.0
#: width of the outline of the ellipse at the present position, pixels
OUTLINE_WIDTH = 1.5


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
    still = replace(tooth_scene(view, contact), dots=position_dots(view, contact))
    path = path_on_surface(view, contact)
    discs, outlines = ellipses_on_surface(contact, contact.ellipses, view.project, view.lift)
    scenes = []
    for k in range(len(contact.point)):
        here = np.flatnonzero(contact.ellipses == k)
        areas = tuple(PatternArea(discs[i], label="contact ellipse") for i in here)
        curves = tuple(Curve(outlines[i], colour=OUTLINE_COLOUR, width=OUTLINE_WIDTH) for i in here)
        line = contact.lines[k] if contact.lines else None
        if line is not None:
            raised = line + 1.5 * view.lift * contact.normal[k]
            curves += (Curve(raised, "contact line", LINE_COLOUR, LINE_WIDTH),)
        scenes.append(replace(still, areas=areas, curves=curves + path))
    return scenes


def growing_pattern_scenes(
    view: ToothView, contact: MemberContact, grid: Array, rubbed: str | None = None
) -> list[Scene]:
    """Scenes of a tooth whose contact pattern grows from the first position to the last.

    With `rubbed`, the legend of marking compound, it is the compound that goes. `grid` (I, J, 3) are points of the
    exact flank.
    """
    # levels of the union from the first position to each position
    levels = list(
        accumulate(
            (union_level(contact.at(np.arange(max(k - 1, 0), k + 1)), grid) for k in contact.ellipses), np.minimum
        )
    )
    if rubbed is None:
        whole = pattern_scene(view, contact, grid)
    else:
        whole = compound_scene(view, contact, grid, compound_share(levels[-1] ** 2), rubbed)
    outlines = ellipse_outlines(contact, contact.ellipses, view.project, view.lift)
    growing = [
        replace(
            whole,
            areas=tuple(replace(area, level=level) for area in whole.areas),
            films=tuple(replace(film, share=compound_share(level**2)) for film in whole.films),
            curves=(Curve(outline, colour=OUTLINE_COLOUR, width=OUTLINE_WIDTH),),
        )
        for level, outline in zip(levels[:-1], outlines[:-1], strict=True)
    ]
    return [*growing, whole]
