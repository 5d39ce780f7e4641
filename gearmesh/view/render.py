"""The one renderer of scenes: VTK draws the bodies off screen, matplotlib letters the picture.

Bodies, areas and maps are drawn once, with depth offsets so that what lies on a surface is not torn by its facets.
The lettering (title, legend, colour bar, scale, axes) is two-dimensional and never covers the middle of the picture.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import OutputError
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.progress import tell
from gearmesh.view.lettering import fit_title
from gearmesh.view.opengl import missing_opengl_message
from gearmesh.view.palette import COLOUR_MAP, CURVES, INK
from gearmesh.view.scene import BESIDE_BAR, Camera, Curve, Dots, PatternArea, Scene, SceneBody, ValueMap, beside_bar

Image = NDArray[np.uint8]

_KINDS = (".png", ".jpg", ".jpeg", ".tif", ".tiff")
_EDGE_COLOUR, _INSIDE = "#5b6670", "#f4f6f8"
# Normals of one region that differ by more than this from their mean belong to a sharp edge inside the region.
_SHARP = np.cos(np.radians(35.0))
# Directions to the lights in camera axes (right, up, towards the viewer) and their strengths: no side stays black.
_LIGHTS = (
    ((-0.6, 0.9, 1.0), 0.36),
    ((1.0, 0.1, 0.3), 0.50),
    ((-1.0, 0.0, 0.3), 0.34),
    ((0.0, 0.0, 1.0), 0.26),
    ((-0.3, -1.0, 0.3), 0.26),
)
# The picture is rendered at twice its size each way and averaged: widths in pixels are drawn doubled.
_OVERSAMPLING = 2
# Layers of translucent bodies one behind the other: a ring has four.
_PEELS = 8


def render(scene: Scene, path: Path | str | None = None, size: tuple[int, int] | None = None) -> Image:
    """The picture of a scene as RGB pixels (H, W, 3), also written to `path` if one is given.

    PNG, JPEG or TIFF by the path's suffix; `size` in pixels, width by height, overrides the scene's. Equal scenes
    give equal pixels. Raises OutputError where OpenGL does not work, because going on would end the process, or where
    the file cannot be written.
    """
    message = missing_opengl_message()
    if message is not None:
        raise OutputError(reason=message)
    if path is not None and Path(path).suffix.lower() not in _KINDS:
        raise OutputError("cannot write", path, reason=f"the suffix of a picture must be {', '.join(_KINDS)}")
    size = size or scene.size
    inner = beside_bar(size) if scene.maps else size
    tell(0.2)
    photograph = _photograph(scene, inner)
    tell(0.8)
    # a colour bar stands on white, not on the teeth
    image = np.pad(photograph, ((0, 0), (0, size[0] - inner[0]), (0, 0)), constant_values=255)
    image = _letter(image, scene, size, inner)
    if path is not None:
        from matplotlib.image import imsave

        from gearmesh.io.atomic import whole_file

        with whole_file(path) as unfinished:
            imsave(unfinished, image)
    return image


# --- bodies ---


class _Layer(NamedTuple):
    """An actor moved away from the viewer by `slopes` times its rise over one pixel and by the length of `pixels`."""

    actor: Any
    slopes: float
    pixels: float


def corner_normals(mesh: TriangleMesh) -> Array:
    """Normals (T, 3, 3) for smooth shading, at the corners of every triangle.

    The mean, weighted with the corner angles, of the cell normals of the same region around the vertex; a cell that
    is at a sharp edge inside a region keeps its own. A cell normal that contradicts its facet's orientation
    would be shaded black, so there the facet's takes its place.
    """
    corners = mesh.corners()
    sides = np.roll(corners, -1, axis=1) - corners
    facet = cross(sides[:, 0], sides[:, 1])
    own = np.where((dot(facet, mesh.normals) > 0.0)[:, None], mesh.normals, facet)
    length = np.sqrt(dot(own, own))
    own = own / np.where(length > 0.0, length, 1.0)[:, None]
    back = np.roll(corners, 1, axis=1) - corners
    angle = np.arctan2(np.linalg.norm(cross(sides, back), axis=-1), dot(sides, back))
    group = mesh.triangles * len(mesh.region_names) + mesh.regions[:, None]
    member = np.unique(group, return_inverse=True)[1].reshape(-1)
    weighted = (angle[..., None] * own[:, None, :]).reshape(-1, 3)
    total = np.stack([np.bincount(member, weighted[:, k]) for k in range(3)], axis=-1).astype(float)
    size = np.sqrt(dot(total, total))
    mean = (total / np.where(size > 0.0, size, 1.0)[:, None])[member].reshape(-1, 3, 3)
    repeated = np.broadcast_to(own[:, None, :], mean.shape)
    return np.where((dot(mean, repeated) > _SHARP)[..., None], mean, repeated)


def region_edges(mesh: TriangleMesh) -> NDArray[np.int64]:
    """Edges (E, 2), vertex indices, between two regions, at sharp corners and along open boundaries."""
    edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    cell = np.repeat(np.arange(len(mesh.triangles)), 3)
    order = np.lexsort(edges.T)
    edges, cell = edges[order], cell[order]
    first = np.flatnonzero(np.r_[True, (edges[1:] != edges[:-1]).any(axis=1)])
    count = np.diff(np.r_[first, len(edges)])
    one, two = cell[first], cell[first + count - 1]
    bent = dot(mesh.normals[one], mesh.normals[two]) < np.cos(np.radians(50.0))
    shown: NDArray[np.int64] = edges[first[(count != 2) | (mesh.regions[one] != mesh.regions[two]) | bent]]
    return shown


def _rgb(colour: str) -> tuple[int, int, int]:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def _faces(points: Array, cells: NDArray[np.int64]) -> Any:
    """VTK's surface of points (V, 3) and cells (C, 3) or (C, 4)."""
    import pyvista

    return pyvista.PolyData(points, np.insert(cells, 0, cells.shape[1], axis=1).ravel())


def _add_body(plotter: Any, body: SceneBody, camera: Camera) -> Iterator[_Layer]:
    import pyvista

    mesh = body.mesh.move(body.own_to_scene)
    surface = _faces(mesh.corners().reshape(-1, 3), np.arange(3 * len(mesh.triangles)).reshape(-1, 3))
    surface.point_data.active_normals = corner_normals(mesh).reshape(-1, 3)
    colours = np.array([_rgb(body.paint.of(name)) for name in mesh.region_names], dtype=np.uint8)
    surface.cell_data["colour"] = colours[mesh.regions]
    actor = plotter.add_mesh(surface, scalars="colour", rgb=True, ambient=0.25, specular=0.12, specular_power=20)
    actor.prop.interpolation = "Phong"
    actor.prop.opacity = body.opacity
    behind = 4.0 if body.yields else 0.0
    actors = [actor]
    if body.yields and camera.front is not None:
        # Where a solid is cut open its inside is seen, as flat as a section: it is drawn before the lines on it.
        actor.prop.culling = "back"
        inside = plotter.add_mesh(
            surface.copy(), color=body.section or _INSIDE, scalars=None, lighting=False, culling="front"
        )
        inside.mapper.scalar_visibility = False
        yield _Layer(inside, 0.0, behind - 2.0)
        actors.append(inside)
    yield _Layer(actor, 1.0, behind)
    edges = region_edges(mesh)
    # lines on the far side would show through a section
    if len(edges) and body.section is None:
        outline = pyvista.PolyData(mesh.vertices, lines=np.insert(edges, 0, 2, axis=1).ravel())
        actor = plotter.add_mesh(outline, color=_EDGE_COLOUR, line_width=1.0 * _OVERSAMPLING, lighting=False)
        yield _Layer(actor, 0.0, behind - 0.5)
        actors.append(actor)
    if body.yields and camera.front is not None:
        for clipped in actors:
            clipped.mapper.AddClippingPlane(_half_space(camera.focus + camera.front * camera.axes[2], -camera.axes[2]))


def _half_space(origin: Array, inwards: Array) -> Any:
    """VTK's plane through a point that keeps what lies inwards."""
    from vtkmodules.vtkCommonDataModel import vtkPlane

    plane = vtkPlane()
    plane.SetOrigin(*origin)
    plane.SetNormal(*inwards)
    return plane


# --- what lies on them ---


def _is_finite(points: Array) -> NDArray[np.bool_]:
    """Which of the points (..., 3) are no NaN, (...,)."""
    return np.asarray(np.isfinite(points).all(axis=-1))


def _grid_surface(points: Array, values: Array) -> Any:
    """Quadrilaterals of a patch (..., M, N, 3) with `values` (..., M, N); cells with a NaN corner are left out."""
    shape = points.shape[:-1]
    index = np.arange(int(np.prod(shape))).reshape(shape)
    quads = np.stack(
        (index[..., :-1, :-1], index[..., 1:, :-1], index[..., 1:, 1:], index[..., :-1, 1:]), axis=-1
    ).reshape(-1, 4)
    known = _is_finite(points) & np.isfinite(values)
    quads = quads[known.reshape(-1)[quads].all(axis=1)]
    used, cells = np.unique(quads, return_inverse=True)
    surface = _faces(points.reshape(-1, 3)[used], cells.reshape(-1, 4))
    surface.point_data["value"] = values.reshape(-1)[used]
    return surface


def _add_area(plotter: Any, area: PatternArea) -> Iterator[_Layer]:
    level = np.zeros(area.points.shape[:-1]) if area.level is None else area.level
    surface = _grid_surface(area.points, level)
    inside = surface.clip_scalar(scalars="value", value=1.0) if area.level is not None and surface.n_cells else surface
    if inside.n_cells:
        actor = plotter.add_mesh(inside, color=area.colour, scalars=None, show_scalar_bar=False, lighting=False)
        actor.mapper.scalar_visibility = False
        yield _Layer(actor, 0.0, -0.5)


def _add_map(plotter: Any, value_map: ValueMap) -> Iterator[_Layer]:
    surface = _grid_surface(value_map.points, value_map.values)
    near = surface.clip_scalar(scalars="value", value=value_map.limit) if surface.n_cells else surface
    if near.n_cells:
        # Unlit, so that a colour on the tooth is exactly the colour in the bar.
        actor = plotter.add_mesh(
            near,
            scalars="value",
            cmap=COLOUR_MAP,
            clim=(0.0, value_map.limit),
            lighting=False,
            interpolate_before_map=True,
            show_scalar_bar=False,
        )
        yield _Layer(actor, 0.0, -0.5)


def _add_curve(plotter: Any, curve: Curve) -> Iterator[_Layer]:
    import pyvista

    known = _is_finite(curve.points)
    start = np.flatnonzero(known[:-1] & known[1:])
    if len(start):
        place = np.cumsum(known)[start] - 1
        segments = np.stack((np.full_like(place, 2), place, place + 1), axis=-1)
        line = pyvista.PolyData(curve.points[known], lines=segments.ravel())
        actor = plotter.add_mesh(line, color=curve.colour, line_width=curve.width * _OVERSAMPLING, lighting=False)
        yield _Layer(actor, 0.0, -1.0)


def _add_dots(plotter: Any, dots: Dots) -> Iterator[_Layer]:
    import pyvista

    known = _is_finite(dots.points)
    if known.any():
        actor = plotter.add_mesh(
            pyvista.PolyData(dots.points[known]),
            color=dots.colour,
            point_size=dots.size * _OVERSAMPLING,
            render_points_as_spheres=True,
            lighting=False,
        )
        # A dot is drawn as a ball: its front half stands out by itself.
        yield _Layer(actor, 0.0, 0.0)


def _photograph(scene: Scene, size: tuple[int, int]) -> Image:
    """The three-dimensional part of the picture, (H, W, 3)."""
    import pyvista

    with _quiet_vtk():
        plotter: Any = pyvista.Plotter(off_screen=True, window_size=list(size), lighting="none")
    try:
        plotter.set_background("white")
        _aim(plotter, scene.camera)
        layers = [layer for body in scene.bodies for layer in _add_body(plotter, body, scene.camera)]
        layers += [layer for area in scene.areas for layer in _add_area(plotter, area)]
        layers += [layer for value_map in scene.maps for layer in _add_map(plotter, value_map)]
        layers += [layer for curve in scene.curves for layer in _add_curve(plotter, curve)]
        layers += [layer for dots in scene.dots for layer in _add_dots(plotter, dots)]
        if any(body.opacity < 1.0 for body in scene.bodies):
            plotter.enable_depth_peeling(_PEELS)
        plotter.enable_anti_aliasing("ssaa", multi_samples=_OVERSAMPLING**2)
        plotter.renderer.ResetCameraClippingRange()
        with _quiet_vtk(), _depth_offsets(layers, scene.camera, plotter.camera.clipping_range, size):
            plotter.render()
            return np.array(plotter.screenshot(return_img=True)[..., :3])
    finally:
        plotter.close()


def _aim(plotter: Any, camera: Camera) -> None:
    """Set camera and lights; the lights are fixed relative to the camera."""
    import pyvista

    view = plotter.camera
    view.position, view.focal_point, view.up = camera.position, camera.focus, camera.axes[1]
    view.parallel_projection = camera.parallel
    view.parallel_scale = camera.height / 2
    view.view_angle = float(np.degrees(2 * np.arctan2(camera.height / 2, camera.distance)))
    plotter.renderer.camera_set = True
    for direction, strength in _LIGHTS:
        at = camera.focus + camera.distance * unit(np.array(direction)) @ camera.axes
        plotter.add_light(pyvista.Light(position=at, focal_point=camera.focus, intensity=strength, positional=False))


@contextmanager
def _depth_offsets(
    layers: list[_Layer], camera: Camera, clipping: tuple[float, float], size: tuple[int, int]
) -> Iterator[None]:
    """Give every actor its depth offset, and the process its own setting back afterwards.

    VTK counts the constant part in 1/65000 of the depth buffer, and adds what is set for all actors of the process.
    """
    from vtkmodules.vtkCommonCore import reference
    from vtkmodules.vtkRenderingCore import vtkMapper

    near, far = clipping
    depth_of_mm = 1.0 / (far - near) if camera.parallel else near * far / (far - near) / camera.distance**2
    units_of_pixel = 65000.0 * depth_of_mm * camera.height / size[1]
    slope: Any = reference(0.0)
    unit_count: Any = reference(0.0)
    before = vtkMapper.GetResolveCoincidentTopology()
    vtkMapper.SetResolveCoincidentTopologyToPolygonOffset()
    try:
        for layer in layers:
            mapper, units = layer.actor.mapper, layer.pixels * units_of_pixel
            mapper.GetResolveCoincidentTopologyPolygonOffsetParameters(slope, unit_count)
            mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(
                layer.slopes - float(slope), units - float(unit_count)
            )
            mapper.GetResolveCoincidentTopologyLineOffsetParameters(slope, unit_count)
            mapper.SetRelativeCoincidentTopologyLineOffsetParameters(
                layer.slopes - float(slope), units - float(unit_count)
            )
        yield
    finally:
        vtkMapper.SetResolveCoincidentTopology(before)


@contextmanager
def _quiet_vtk() -> Iterator[None]:
    """Keep VTK's word on every window system it tries off the terminal; the probe has shown that one works."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)


# --- lettering ---

_TOP = 0.925
# Entries of the legend in a row, and the height of a row as a part of the picture's.
_COLUMNS, _ROW = 4, 0.031
#: nearest that a word may come to the picture's edges, as parts of it
_MARGIN = (0.035, 0.03)
#: how far a word stays from what it names and from the edges, as a part of the picture's height
_CLEAR = 0.009


def _letter(image: Image, scene: Scene, size: tuple[int, int], inner: tuple[int, int]) -> Image:
    """The picture with title and legend on top, a colour bar at the side, axes, scale and words; nothing of it is boxed.

    The camera sees what is `inner`.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    # Letters keep their share of the picture: 11 points where it is 7.5 inches high.
    dots_per_inch = size[1] / 7.5
    figure = Figure(figsize=(size[0] / dots_per_inch, 7.5), dpi=dots_per_inch, facecolor="none")
    canvas: Any = FigureCanvasAgg(figure)
    if scene.maps:
        _draw_colour_bar(figure, scene.maps[0])
    _draw_heading(figure, scene)
    _draw_words(figure, scene, size, inner)
    _draw_axes(figure, scene.camera, size)
    if scene.camera.parallel:
        _draw_scale(figure, scene.camera, size, inner[0] / size[0])
    canvas.draw()
    letters = np.asarray(canvas.buffer_rgba())
    lettered = np.array(image)
    where = letters[..., 3] > 0
    over, share = letters[where][:, :3].astype(float), letters[where][:, 3:] / 255.0
    lettered[where] = np.round(lettered[where] * (1.0 - share) + over * share).astype(np.uint8)
    return lettered


def _halo(width: float = 3.0) -> list[Any]:
    """A white rim, so that what is written over the picture is read on any ground."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=width, foreground="white")]


def _draw_words(figure: Any, scene: Scene, size: tuple[int, int], inner: tuple[int, int]) -> None:
    """Words beyond their points, all of a word; those whose points are not in the picture are at its edge."""
    for word in scene.words:
        at, inside = (
            scene.camera.pixels(point, inner)[:2] / size * [1.0, -1.0] + [0.0, 1.0]
            for point in (word.point, word.inside)
        )
        way = (at - inside) * size
        way = way / max(float(np.hypot(*way)), 1e-9)
        place = at + 0.028 * way * size[1] / np.array(size)
        right = inner[0] / size[0] - _MARGIN[0]
        kept = np.clip(place, _MARGIN, (right, _TOP - 0.05))
        cut = word.beyond or np.abs(kept - place).max() > 0.03
        leftwards = at[0] < 0.5 if word.beyond else way[0] < 0.0
        arrow = ("\N{LEFTWARDS ARROW} ", "") if leftwards else ("", " \N{RIGHTWARDS ARROW}")
        text = f"{arrow[0]}{word.text}{arrow[1]}" if cut else word.text
        across = "left" if cut and leftwards else "right" if cut else "center"
        drawn = figure.text(*kept, text, ha=across, va="center", fontsize=12, color=INK, path_effects=_halo())
        if not cut:
            _move_clear(drawn, at, way, inner[0] / size[0])


def _move_clear(drawn: Any, at: Array, way: Array, right: float) -> None:
    """Move a word on its `way` (2,) from what it names `at` (2,) until its box covers neither that nor an edge of the picture; the
    `right` one may be that of a colour bar."""
    size = np.array(drawn.figure.bbox.size)
    box = drawn.get_window_extent()
    half = 0.5 * np.array([box.width, box.height])
    far = max(float((half / np.maximum(np.abs(way), 1e-9)).min()) + _CLEAR * size[1], 0.028 * size[1])
    low, high = _CLEAR * size[1] + half, np.array([right, _TOP - 0.03]) * size - half
    drawn.set_position(np.clip(at * size + far * way, low, np.maximum(high, low)) / size)


def _line(x: tuple[float, float], y: tuple[float, float], colour: str, width: float) -> Any:
    from matplotlib.lines import Line2D

    return Line2D(x, y, color=colour, lw=width, solid_capstyle="butt", path_effects=_halo(width + 2.0))


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


def _draw_scale(figure: Any, camera: Camera, size: tuple[int, int], edge: float) -> None:
    """A bar of a round length, at most a seventh of the picture's width, in the lower right corner."""
    width = camera.height * size[0] / size[1]
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
