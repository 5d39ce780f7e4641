"""Scene of a tooth with the largest pressure at each point of its flank under a torque."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.view.load.loaded_diagrams import MIN_DRAWN_SHARE, PRESSURE_LABEL, LoadedPanel, LoadedPattern
from gearmesh.view.on_tooth import lift_grid
from gearmesh.view.palette import EDGE_COLOUR
from gearmesh.view.scene import Camera, Dots, MemberContact, Scene, ToothView, ValueMap, beside_bar
from gearmesh.view.views import flank_camera, tooth_scene

#: size of the marks of edge contact
EDGE_MARK_PIXELS = 5.0
#: points across and along the pressed part of a flank
PRESSED_GRID = (121, 241)
#: largest drawn pressure as a share of the scale's end, so that the map does not leave it out
MAX_SHOWN_SHARE = 0.999
#: smallest and largest factor by which the picture is higher than the picture of a tooth alone
ZOOM_RANGE = (1.05, 1.6)
#: share of the picture's width that the pressed part takes
PRESSED_WIDTH_SHARE = 0.8


def loaded_scene(view: ToothView, pattern: LoadedPattern, name: str, torque: int) -> Scene:
    """Scene of a member's tooth, own frame, with the pressures under a torque (by index) in colours of the pattern's
    scale.
    """
    assert view.grid is not None
    # the drawn tooth stands for both halves of double helical gears
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
    # pressures beyond the scale have the colour of its end
    shown = np.where(values > MIN_DRAWN_SHARE * limit, np.minimum(values, MAX_SHOWN_SHARE * limit), np.nan)
    edges = prints.own(member, prints.on_edges)[pressed]
    lifted = (edges + 2.0 * view.lift * out[:, None]).reshape(-1, 3)
    marks = lifted[np.isfinite(lifted).all(axis=1)]
    seen = replace(view, size=beside_bar(view.size))
    camera = _holding(flank_camera(seen, contact), seen, grid)
    return replace(
        tooth_scene(seen, contact, camera),
        maps=(ValueMap(lift_grid(grid, contact, view.lift), shown, limit, PRESSURE_LABEL),),
        dots=(Dots(marks, "edge contact, or contact longer than its grid", EDGE_COLOUR, EDGE_MARK_PIXELS),)
        if len(marks)
        else (),
        size=view.size,
    )


def _pressed_part(panel: LoadedPanel, grid: Array) -> Array:
    """Exact points (PRESSED_GRID, 3) of the part of a flank with pressure, found on a coarse `grid` (I, J, 3) of the
    flank.
    """
    lengths = panel.plane.frame.places(grid)[..., 0]
    low, high = panel.extent
    within = np.flatnonzero(((lengths >= low) & (lengths <= high)).any(axis=0))
    last = grid.shape[1] - 1
    ends = (within[0] - 1, within[-1] + 1) if within.size else (0, last)
    t = np.linspace(max(ends[0], 0) / last, min(ends[1], last) / last, PRESSED_GRID[1])
    plane = panel.plane
    return plane.member.tooth.flank_grid(plane.side, np.linspace(0.0, 1.0, PRESSED_GRID[0]), t).points


def _holding(camera: Camera, view: ToothView, grid: Array) -> Camera:
    """Move a camera back, within `ZOOM_RANGE`, to see all of a grid."""
    right, shape = camera.axes[0], view.size[0] / view.size[1]
    lengths = (grid - camera.focus) @ right
    low, high = float(np.nanmin(lengths)), float(np.nanmax(lengths))
    height = float(
        np.clip(
            (high - low) / (PRESSED_WIDTH_SHARE * shape), ZOOM_RANGE[0] * camera.height, ZOOM_RANGE[1] * camera.height
        )
    )
    shift = 0.5 * (low + high) * right
    return camera.moved(shift, height)
