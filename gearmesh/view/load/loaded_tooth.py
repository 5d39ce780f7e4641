"""A tooth with the largest pressure that each place of its flank sees under a torque, as a scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.view.load.loaded_diagrams import FAINTEST, PRESSURE, LoadedPanel, LoadedPattern
from gearmesh.view.on_tooth import lift_grid
from gearmesh.view.palette import EDGE
from gearmesh.view.scene import Camera, Dots, MemberContact, Scene, ToothView, ValueMap, beside_bar
from gearmesh.view.views import edge_words, flank_camera

#: size of the marks of edge contact, in pixels
MARK = 5.0
#: points across and along the part of a flank that is pressed
GRID = (121, 241)
#: what is drawn ends below the scale's end
BELOW = 0.999
#: how much more is seen than of a tooth alone, at least and most; the part of the width that what is pressed takes
WIDER, SEEN = (1.05, 1.6), 0.8


def loaded_scene(view: ToothView, pattern: LoadedPattern, name: str, torque: int) -> Scene:
    """The tooth of a member, own frame, with the pressures under the torque of a number in colours of the pattern's scale."""
    assert view.grid is not None
    # both halves of double helical gears have a tooth that looks like this: the one that is drawn
    panel, prints, limit = pattern.panels[name][torque][0], pattern.prints[torque][0], pattern.limit
    member = pattern.gears.index(name)
    pressed = prints.share > 0.0
    middle = prints.middle.shape[1] // 2
    point = prints.own(member, prints.middle)[pressed, middle]
    out = prints.own_to_fixed[member].inverse.vector(prints.normal)[pressed] * (1.0, -1.0)[member]
    none, no = np.full(len(point), np.nan), np.zeros_like(point)
    contact = MemberContact(point, out, no, no, none, none, np.zeros(len(point), dtype=bool))
    grid = _pressed_part(panel, view.grid)
    values = panel.at(panel.plane.frame.places(grid))
    # what is beyond the scale has the colour of its end
    shown = np.where(values > FAINTEST * limit, np.minimum(values, BELOW * limit), np.nan)
    edges = prints.own(member, prints.on_edges)[pressed]
    lifted = (edges + 2.0 * view.lift * out[:, None]).reshape(-1, 3)
    marks = lifted[np.isfinite(lifted).all(axis=1)]
    seen = replace(view, size=beside_bar(view.size))
    camera = _holding(flank_camera(seen, contact), seen, grid)
    return Scene(
        bodies=view.bodies,
        camera=camera,
        maps=(ValueMap(lift_grid(grid, contact, view.lift), shown, limit, PRESSURE),),
        dots=(Dots(marks, "edge contact, or contact longer than its grid", EDGE, MARK),) if len(marks) else (),
        words=edge_words(seen, camera, contact),
        title=view.title,
        size=view.size,
    )


def _pressed_part(panel: LoadedPanel, grid: Array) -> Array:
    """Points (GRID, 3) of the flank about where it is pressed, as a coarse `grid` (I, J, 3) of all of it shows."""
    lengths = panel.plane.frame.places(grid)[..., 0]
    low, high = panel.extent
    within = np.flatnonzero(((lengths >= low) & (lengths <= high)).any(axis=0))
    last = grid.shape[1] - 1
    ends = (within[0] - 1, within[-1] + 1) if within.size else (0, last)
    t = np.linspace(max(ends[0], 0) / last, min(ends[1], last) / last, GRID[1])
    plane = panel.plane
    return plane.member.tooth.flank_grid(plane.side, np.linspace(0.0, 1.0, GRID[0]), t).points


def _holding(camera: Camera, view: ToothView, grid: Array) -> Camera:
    """A camera that goes back as far as it may to see all of a grid."""
    right, shape = camera.axes[0], view.size[0] / view.size[1]
    lengths = (grid - camera.focus) @ right
    low, high = float(np.nanmin(lengths)), float(np.nanmax(lengths))
    height = float(np.clip((high - low) / (SEEN * shape), WIDER[0] * camera.height, WIDER[1] * camera.height))
    shift = 0.5 * (low + high) * right
    return replace(camera, position=camera.position + shift, focus=camera.focus + shift, height=height)
