"""A tooth with the largest pressure that each place of its flank sees under a torque, as a scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.view.loaded_diagrams import FAINTEST, PRESSURE, LoadedPattern
from gearmesh.view.on_tooth import lift_grid
from gearmesh.view.palette import EDGE
from gearmesh.view.scene import Camera, Dots, MemberContact, Scene, ToothView, ValueMap
from gearmesh.view.views import edge_words, flank_camera

#: size of the marks where edges carry, in pixels
MARK = 5.0
#: how much more is seen than of a tooth alone, and how far aside, in widths: a scale stands at the right
WIDER, ASIDE = 1.18, 0.06


def loaded_scene(view: ToothView, pattern: LoadedPattern, name: str, torque: int) -> Scene:
    """The tooth of a member, own frame, with the pressures under the torque of a number in colours of the pattern's scale."""
    assert view.grid is not None
    panel, prints, limit = pattern.panels[name][torque], pattern.prints[torque], pattern.limit
    member = pattern.gears.index(name)
    pressed = prints.share > 0.0
    middle = prints.middle.shape[1] // 2
    point = prints.own(member, prints.middle)[pressed, middle]
    out = prints.own_to_fixed[member].inverse.vector(prints.normal)[pressed] * (1.0, -1.0)[member]
    none, no = np.full(len(point), np.nan), np.zeros_like(point)
    contact = MemberContact(point, out, no, no, none, none, np.zeros(len(point), dtype=bool))
    values = panel.at(panel.plane.frame.places(view.grid))
    shown = np.where(values > FAINTEST * limit, np.minimum(values, limit), np.nan)
    edges = prints.own(member, prints.on_edges)[pressed]
    lifted = (edges + 2.0 * view.lift * out[:, None]).reshape(-1, 3)
    marks = lifted[np.isfinite(lifted).all(axis=1)]
    camera = _beside_bar(flank_camera(view, contact), view)
    return Scene(
        bodies=view.bodies,
        camera=camera,
        maps=(ValueMap(lift_grid(view.grid, contact, view.lift), shown, limit, PRESSURE),),
        dots=(Dots(marks, "edges carry", EDGE, MARK),) if len(marks) else (),
        words=edge_words(view, camera),
        title=view.title,
        size=view.size,
    )


def _beside_bar(camera: Camera, view: ToothView) -> Camera:
    """A camera that leaves room for the scale."""
    height = WIDER * camera.height
    shift = ASIDE * height * view.size[0] / view.size[1] * camera.axes[0]
    return replace(camera, position=camera.position + shift, focus=camera.focus + shift, height=height)
