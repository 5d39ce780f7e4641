"""A tooth with the largest pressure that each place of its flank sees under a torque, as a scene."""

from __future__ import annotations

import numpy as np

from gearmesh.view.footprints import Footprints
from gearmesh.view.loaded_diagrams import FAINTEST, PRESSURE, LoadedPanel
from gearmesh.view.on_tooth import lift_grid
from gearmesh.view.palette import EDGE
from gearmesh.view.scene import Dots, MemberContact, Scene, ToothView, ValueMap
from gearmesh.view.views import edge_words, flank_camera

#: size of the marks where edges carry, in pixels
MARK = 5.0


def loaded_scene(view: ToothView, panel: LoadedPanel, prints: Footprints, member: int, limit: float) -> Scene:
    """The tooth of pinion (0) or gear (1), own frame, with the pressures of its panel in colours up to `limit`, MPa."""
    assert view.grid is not None
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
    camera = flank_camera(view, contact)
    return Scene(
        bodies=view.bodies,
        camera=camera,
        maps=(ValueMap(lift_grid(view.grid, contact, view.lift), shown, limit, PRESSURE),),
        dots=(Dots(marks, "edges carry", EDGE, MARK),) if len(marks) else (),
        words=edge_words(view, camera),
        title=view.title,
        size=view.size,
    )
