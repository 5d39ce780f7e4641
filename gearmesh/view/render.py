"""The one renderer of scenes: VTK draws the bodies in a process of its own, matplotlib letters the picture.

The lettering (title, legend, colour bar, scale, axes) is two-dimensional and never covers the middle of the picture.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import OutputError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import tell
from gearmesh.view.lettering import fit_title
from gearmesh.view.offscreen.shapes import drawing_order
from gearmesh.view.opengl import draw
from gearmesh.view.palette import COLOUR_MAP, CURVES, INK
from gearmesh.view.scene import BESIDE_BAR, Camera, Scene, ValueMap, beside_bar

Image = NDArray[np.uint8]

_KINDS = (".png", ".jpg", ".jpeg", ".tif", ".tiff")


def render(scene: Scene, path: Path | str | None = None, size: tuple[int, int] | None = None) -> Image:
    """The picture of a scene as RGB pixels (H, W, 3), also written to `path` if one is given.

    PNG, JPEG or TIFF by the path's suffix; `size` in pixels, width by height, overrides the scene's. Equal scenes
    give equal pixels. Raises OutputError where OpenGL does not work, because going on would end the process, or where
    the file cannot be written.
    """
    if path is not None and Path(path).suffix.lower() not in _KINDS:
        raise OutputError("cannot write", path, reason=f"the suffix of a picture must be {', '.join(_KINDS)}")
    size = size or scene.size
    heading = round(_heading(scene, size) * size[1])
    # what is higher than the room that scenes leave for it takes its own
    above = max(0, heading - round(_ROOM * size[1]))
    inner = beside_bar(size)[0] if scene.maps else size[0], size[1] - above
    tell(0.2)
    photograph = _photograph(scene, inner)
    tell(0.8)
    # heading and colour bar are on white, not on the teeth
    image = np.pad(photograph, ((above, 0), (0, size[0] - inner[0]), (0, 0)), constant_values=255)
    image[:heading] = 255
    image = _letter(image, scene, size, inner)
    if path is not None:
        from matplotlib.image import imsave

        from gearmesh.io.atomic import whole_file

        with whole_file(path) as unfinished:
            imsave(unfinished, image)
    return image


def _photograph(scene: Scene, size: tuple[int, int]) -> Image:
    """The three-dimensional part of the picture, (H, W, 3)."""
    from PIL import Image as pillow

    order = drawing_order(scene, size)
    # a pixel is the mean, by their distances from its middle, of four by four
    large = pillow.frombuffer("RGBA", order["size"], draw(order), "raw", "RGBA", 0, -1)
    return np.asarray(large.convert("RGB").resize(size, pillow.Resampling.BILINEAR))


# --- lettering ---

_TOP = 0.925
#: part of a picture's height that scenes leave for a heading: a title of one line and a legend of one row
_ROOM = 0.09
# Entries of the legend in a row, and the height of a row as a part of the picture's.
_COLUMNS, _ROW = 4, 0.031
#: nearest that a word may come to the picture's edges, as parts of it
_MARGIN = (0.035, 0.03)
#: how far a word stays from what it names and from the edges, as a part of the picture's height
_CLEAR = 0.009


def _letter(image: Image, scene: Scene, size: tuple[int, int], inner: tuple[int, int]) -> Image:
    """The picture with title and legend on top, a colour bar at the side, axes, scale and words; nothing of it is boxed.

    The camera sees what is `inner`, in the lower left.
    """
    figure = _sheet(size)
    canvas: Any = figure.canvas
    if scene.maps:
        _draw_colour_bar(figure, scene.maps[0])
    _draw_heading(figure, scene)
    _draw_words(figure, scene, size, inner)
    _draw_axes(figure, scene.camera, size)
    if scene.camera.parallel:
        _draw_scale(figure, scene.camera, size, inner)
    canvas.draw()
    letters = np.asarray(canvas.buffer_rgba())
    lettered = np.array(image)
    where = letters[..., 3] > 0
    over, share = letters[where][:, :3].astype(float), letters[where][:, 3:] / 255.0
    lettered[where] = np.round(lettered[where] * (1.0 - share) + over * share).astype(np.uint8)
    return lettered


def _sheet(size: tuple[int, int]) -> Any:
    """What is lettered: a figure of the picture's `size`; letters keep their share of it: 11 points where it is 7.5 inches high."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    dots_per_inch = size[1] / 7.5
    figure = Figure(figsize=(size[0] / dots_per_inch, 7.5), dpi=dots_per_inch, facecolor="none")
    FigureCanvasAgg(figure)
    return figure


def _halo(width: float = 3.0) -> list[Any]:
    """A white rim, so that what is written over the picture is read on any ground."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=width, foreground="white")]


def _draw_words(figure: Any, scene: Scene, size: tuple[int, int], inner: tuple[int, int]) -> None:
    """Words beyond their points, all of a word; those whose points are not in the picture are at its edge."""
    for word in scene.words:
        at, inside = (
            scene.camera.pixels(point, inner)[:2] / size * [1.0, -1.0] + [0.0, inner[1] / size[1]]
            for point in (word.point, word.inside)
        )
        way = (at - inside) * size
        way = way / max(float(np.hypot(*way)), 1e-9)
        place = at + 0.028 * way * size[1] / np.array(size)
        right, top = inner[0] / size[0] - _MARGIN[0], inner[1] / size[1] - (1.0 - _TOP)
        kept = np.clip(place, _MARGIN, (right, top - 0.05))
        cut = word.beyond or np.abs(kept - place).max() > 0.03
        leftwards = at[0] < 0.5 if word.beyond else way[0] < 0.0
        arrow = ("\N{LEFTWARDS ARROW} ", "") if leftwards else ("", " \N{RIGHTWARDS ARROW}")
        text = f"{arrow[0]}{word.text}{arrow[1]}" if cut else word.text
        across = "left" if cut and leftwards else "right" if cut else "center"
        drawn = figure.text(*kept, text, ha=across, va="center", fontsize=12, color=INK, path_effects=_halo())
        if not cut:
            _move_clear(drawn, at, way, inner[0] / size[0], top)


def _move_clear(drawn: Any, at: Array, way: Array, right: float, top: float) -> None:
    """Move a word on its `way` (2,) from what it names `at` (2,) until its box covers neither that nor an edge of the picture; the
    `right` one may be that of a colour bar, the `top` one that of the heading."""
    size = np.array(drawn.figure.bbox.size)
    box = drawn.get_window_extent()
    half = 0.5 * np.array([box.width, box.height])
    far = max(float((half / np.maximum(np.abs(way), 1e-9)).min()) + _CLEAR * size[1], 0.028 * size[1])
    low, high = _CLEAR * size[1] + half, np.array([right, top - 0.03]) * size - half
    drawn.set_position(np.clip(at * size + far * way, low, np.maximum(high, low)) / size)


def _line(x: tuple[float, float], y: tuple[float, float], colour: str, width: float) -> Any:
    from matplotlib.lines import Line2D

    return Line2D(x, y, color=colour, lw=width, solid_capstyle="butt", path_effects=_halo(width + 2.0))


def _heading(scene: Scene, size: tuple[int, int]) -> float:
    """Part of a picture's height that its heading takes, 0 without one."""
    figure = _sheet(size)
    _draw_heading(figure, scene)
    boxes = [part.get_window_extent() for part in (*figure.texts, *figure.legends)]
    return 1.0 - min(box.y0 for box in boxes) / figure.bbox.height + _CLEAR if boxes else 0.0


def _draw_heading(figure: Any, scene: Scene) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(facecolor=a.colour, label=a.label) for a in scene.areas if a.label]
    handles += [Line2D([], [], color=c.colour, lw=c.width, label=c.label) for c in scene.curves if c.label]
    handles += [Line2D([], [], color=d.colour, marker="o", ls="", label=d.label) for d in scene.dots if d.label]
    if not handles and not scene.title:
        return
    title = figure.text(0.5, 0.985, fit_title(scene.title, figure, 13), ha="center", va="top", fontsize=13, color=INK)
    title.set_path_effects(_halo())
    if handles:
        # further rows stand below the first, and all of them below the title
        below = max(0.0, _TOP + 0.02 + 0.5 * _ROW - title.get_window_extent().y0 / figure.bbox.height)
        middle = _TOP + 0.02 - below - 0.5 * _ROW * ((len(handles) - 1) // _COLUMNS)
        legend = figure.legend(
            handles=handles, loc="center", bbox_to_anchor=(0.5, middle), ncols=_COLUMNS, frameon=False, fontsize=10.5
        )
        for text in legend.get_texts():
            text.set_path_effects(_halo())


def _draw_axes(figure: Any, camera: Camera, size: tuple[int, int]) -> None:
    """The frame's x, y and z directions in the lower left corner, nearest last."""
    squeeze = np.array([size[1] / size[0], 1.0])
    centre, length = 0.078 * squeeze, 0.046
    taken: list[Array] = []
    for k in np.argsort(camera.axes[2]):
        colour = ("#c0392b", CURVES[2], CURVES[0])[k]
        tip = camera.axes[:2, k]
        end = centre + length * tip * squeeze
        figure.add_artist(_line((centre[0], end[0]), (centre[1], end[1]), colour, 2.0))
        if np.hypot(*tip) > 0.25:
            place = (length + 0.018) * tip
            if any(np.hypot(*(place - other)) < 0.022 for other in taken):
                place = place + np.array([0.022, 0.0])
            taken.append(place)
            x, y = centre + place * squeeze
            figure.text(x, y, "xyz"[k], color=colour, ha="center", va="center", fontsize=10, path_effects=_halo())


def _draw_scale(figure: Any, camera: Camera, size: tuple[int, int], inner: tuple[int, int]) -> None:
    """A bar of a round length, at most a seventh of the picture's width, in the lower right corner of what the camera sees."""
    width, edge = camera.height * size[0] / inner[1], inner[0] / size[0]
    power = 10.0 ** np.floor(np.log10(width / 7))
    length = max(step * power for step in (1, 2, 5) if step * power <= width / 7)
    left, right, y, tick = edge - 0.02 - length / width, edge - 0.02, 0.03, 0.008
    figure.add_artist(_line((left, right), (y, y), INK, 1.5))
    for x in (left, right):
        figure.add_artist(_line((x, x), (y - tick, y + tick), INK, 1.5))
    label = f"{length:g} mm"
    figure.text(
        (left + right) / 2, y + 0.012, label, ha="center", va="bottom", fontsize=10, color=INK, path_effects=_halo()
    )


def _draw_colour_bar(figure: Any, value_map: ValueMap) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    scale = ScalarMappable(Normalize(0.0, value_map.limit), COLOUR_MAP)
    bar = figure.colorbar(scale, cax=figure.add_axes((BESIDE_BAR + 0.02, 0.15, 0.022, 0.65)))
    bar.set_label(value_map.label, fontsize=11, color=INK)
    bar.ax.tick_params(labelsize=10)
    for text in (bar.ax.yaxis.label, *bar.ax.get_yticklabels()):
        text.set_path_effects(_halo())
