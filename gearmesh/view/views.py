"""The pictures of a gear pair as scenes: members with their contact, patterns, gap maps, the pair; and the cameras."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, spread, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.region import FLANK_REGIONS
from gearmesh.view.on_tooth import (
    area_edges,
    closest_gap,
    contact_lines,
    ellipses_on_surface,
    lift_grid,
    path_on_surface,
    position_dots,
    union_level,
)
from gearmesh.view.palette import OUTLINE, REGION_EDGE
from gearmesh.view.scene import (
    BLUE_STEEL,
    BRASS,
    BRONZE,
    Camera,
    Curve,
    MemberContact,
    PatternArea,
    Scene,
    SceneBody,
    ToothView,
    ValueMap,
    Word,
    beside_bar,
)


def member_scene(view: ToothView, contact: MemberContact, count: int = 9, camera: Camera | None = None) -> Scene:
    """A tooth with the path of contact and, at up to `count` positions, the contact ellipses or contact lines."""
    chosen = spread(contact.ellipses, count)
    discs, outlines = ellipses_on_surface(contact, chosen, view.project, view.lift)
    areas = tuple(PatternArea(disc, label="contact ellipses" if i == 0 else "") for i, disc in enumerate(discs))
    curves = (Curve(outlines, colour=OUTLINE, width=1.5),) if len(chosen) else ()
    camera = camera or flank_camera(view, contact)
    return Scene(
        bodies=view.bodies,
        camera=camera,
        areas=areas,
        curves=curves + contact_lines(view, contact, count) + path_on_surface(view, contact),
        dots=position_dots(view, contact),
        words=edge_words(view, camera, contact),
        title=view.title,
        size=view.size,
    )


def pattern_scene(view: ToothView, contact: MemberContact, grid: Array, camera: Camera | None = None) -> Scene:
    """A tooth with the union of its contact ellipses as one area; `grid` (I, J, 3) are points of its exact flank.

    150 x 300 points draw the ends of slender ellipses smoothly. A pair in line contact shows its lines instead.
    """
    lifted, level = lift_grid(grid, contact, view.lift), union_level(contact, grid)
    area = PatternArea(lifted, level, "contact pattern: union of the ellipses")
    border = (Curve(area_edges(lifted, level), colour=REGION_EDGE, width=1.0),) if len(contact.ellipses) else ()
    camera = camera or flank_camera(view, contact)
    return Scene(
        bodies=view.bodies,
        camera=camera,
        areas=(area,) if len(contact.ellipses) else (),
        curves=border + contact_lines(view, contact, count=25) + path_on_surface(view, contact),
        words=edge_words(view, camera, contact),
        title=view.title,
        size=view.size,
    )


def gap_scene(
    view: ToothView,
    contact: MemberContact,
    grid: Array,
    patches: Sequence[tuple[Array, Array]],
    limit: float,
    camera: Camera | None = None,
) -> Scene:
    """A tooth with the smallest gap of a roll test, up to `limit` mm, in colours.

    `grid` (I, J, 3) are points of its exact flank; every patch is one position's points (M, N, 3), own frame, and
    gaps (M, N) in mm, NaN where there is none. The path of contact is drawn from `contact`, the solver's result.
    """
    gap, lifted = closest_gap(grid, patches), lift_grid(grid, contact, view.lift)
    value_map = ValueMap(lifted, 1e3 * gap, 1e3 * limit, "smallest gap in the roll test (µm)")
    border = Curve(area_edges(lifted, gap / limit), colour=REGION_EDGE, width=1.0)
    seen = replace(view, size=beside_bar(view.size))
    camera = camera or flank_camera(seen, contact)
    return Scene(
        bodies=view.bodies,
        camera=camera,
        maps=(value_map,),
        curves=(border, *path_on_surface(view, contact)),
        words=edge_words(seen, camera, contact),
        title=view.title,
        size=view.size,
    )


def pair_scene(
    pinion: TriangleMesh,
    gear: TriangleMesh,
    pair: GearPair,
    phi: tuple[float, float],
    title: str = "",
    size: tuple[int, int] = (1600, 1200),
    close_up: tuple[Array, float] | None = None,
) -> Scene:
    """Both members (own frames) in their mounted positions at rotations `phi` = (phi1, phi2), fixed frame.

    `close_up` is a point (3,), fixed frame, and the radius (mm) around it that fills the picture instead of the pair.
    """
    bodies = (
        SceneBody(pinion, pair.pinion.mount.at(phi[0]), BLUE_STEEL),
        SceneBody(gear, pair.gear.mount.at(phi[1]), BRASS),
    )
    first, second = (body.own_to_scene.point(body.mesh.vertices) for body in bodies)
    return Scene(bodies, pair_camera(pair, first, second, size, close_up), title=title, size=size)


def set_scene(placed: Mapping[str, TriangleMesh], axis: Array, title: str, size: tuple[int, int]) -> Scene:
    """Meshes in the fixed frame, each in a colour of its own or that of its name but for a number, seen along their common axis."""
    kinds = list(dict.fromkeys(_kind(name) for name in placed))
    colours = (BLUE_STEEL, BRASS, BRONZE)
    bodies = tuple(
        SceneBody(mesh, Rigid.identity(), colours[kinds.index(_kind(name)) % len(colours)])
        for name, mesh in placed.items()
    )
    aside = unit(cross(np.array([0.0, 1.0, 0.0]), axis)) if abs(axis[1]) < ALONG else np.array([1.0, 0.0, 0.0])
    up = cross(axis, aside)
    back = unit(axis + SWUNG * aside + SWUNG * up)
    points = np.concatenate([mesh.vertices for mesh in placed.values()])
    return Scene(bodies, frame(back, up, points, size), title=title, size=size)


def _kind(name: str) -> str:
    """The name of a member without its number: planets are alike."""
    return name.rstrip("0123456789").rstrip("_")


# --- cameras ---

#: part of the length of a body along its axis by which it lies on one side of where axes cross
ASIDE = 0.05
#: how far aside and up, as parts of the way along the axis, a set of gears is looked at from
SWUNG = 0.35
#: cosine from which on an axis is upright
ALONG = 0.9

#: height of a picture of a flank in heights of the flank: of one that is cut off at least, and at most; by how much a picture is
#: larger than what it holds; how much larger it may become before a flank is cut off after all
CUT_OFF, LONGEST, FILLS, SPARED = 2.6, 9.5, 1.2, 1.25
#: where, as a part of the way to the picture's edge, it is said that a flank goes on, and how far below it in its heights
AT_EDGE, BELOW_ROOT = 0.94, 0.1
#: half the width of a word, as a part of the picture's height
WORD = 0.06
#: heights of a flank that are seen before its foremost point: the fillet, and not the next tooth
BEFORE = 0.12
#: mean of the directions from root to tip below which a flank winds; cosines up to which these look alike, and are in sight
WINDS, ALIKE, IN_SIGHT = 0.5, 0.85, -0.35
#: what the normal of a flank that winds counts for in the direction from which it is seen, as a part of its height
ASLANT = 0.7
#: what of a point is at right angles to z
FLAT = np.array([1.0, 1.0, 0.0])

#: shaft angle (rad) from which on a pair is looked at from the side
STEEP = np.radians(55.0)


def frame(back: Array, up: Array, points: Array, size: tuple[int, int], margin: float = 1.3) -> Camera:
    """Parallel camera looking along -`back` with `up` upwards (3,) that just holds `points` (K, 3), by `margin`."""
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = float(np.sqrt(dot(points - centre, points - centre).max()))
    first = Camera(centre + 4.0 * radius * unit(back), centre, up, 2.0 * radius)
    seen = (points - centre) @ first.axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    shift = (low[:2] + high[:2]) / 2 @ first.axes[:2]
    width, height = (high - low)[:2]
    tall = margin * max(height, width * size[1] / size[0])
    return Camera(first.position + shift, centre + shift, up, float(tall))


def flank_camera(view: ToothView, contact: MemberContact) -> Camera:
    """Look at a flank along its mean outward normal, its tip on top, the flank filling the picture.

    The neighbour that would hide it is cut away. A flank much longer than high is cut off beyond all that touches.
    """
    if not np.isfinite(contact.normal).any():
        raise NoSolutionError(
            view.title or "flank picture", reason="no position has contact, so there is nothing to show"
        )
    if view.grid is not None and _winds(view.grid):
        return _thread_camera(view.grid, contact, view.size)
    grid = _flank_points(view)
    normal = unit(np.nanmean(contact.normal, axis=0))
    if view.grid is not None:
        own = cross(np.gradient(view.grid, axis=0), np.gradient(view.grid, axis=1))
        mean = unit(own.reshape(-1, 3).sum(axis=0))
        normal = mean * np.sign(dot(mean, normal))
    land = view.fine.only("land").normals if "land" in view.fine.region_names else grid.mean(axis=0)[None] * FLAT
    up = unit(land.mean(axis=0))
    whole = frame(normal, up, grid, view.size, margin=FILLS)
    right, rise, _ = whole.axes
    height = np.ptp(grid @ rise)
    front = _front(view, whole) + BEFORE * height
    lengths, touched = (grid - whole.focus) @ right, (contact.places - whole.focus) @ right
    shape = view.size[0] / view.size[1]
    most = float(np.clip(FILLS * np.ptp(touched) / shape, CUT_OFF * height, LONGEST * height))
    if whole.height <= SPARED * most:
        return replace(whole, front=front)
    # along the tooth the contact is in the middle, but no picture shows what is beyond the end
    half, middle = 0.5 * most * shape / FILLS, 0.5 * float(touched.min() + touched.max())
    aside = float(np.clip(middle, lengths.min() + half, lengths.max() - half))
    near = np.abs(lengths - aside) < half
    lifted = (grid - whole.focus)[near] @ rise
    shift = aside * right + 0.5 * float(lifted.min() + lifted.max()) * rise
    return replace(whole, position=whole.position + shift, focus=whole.focus + shift, height=most, front=front)


def flank_pixel(grid: Array, size: tuple[int, int]) -> float:
    """Least length (mm) of a pixel in a picture of a `size` in which `flank_camera` looks at a flank with points (I, J, 3)."""
    middle = grid[grid.shape[0] // 2]
    length = float(np.linalg.norm(np.diff(middle, axis=0), axis=-1).sum())
    height = float(np.linalg.norm(grid[-1] - grid[0], axis=-1).mean())
    wide, high = size
    return max(FILLS * height / high, min(FILLS * length / wide, CUT_OFF * height / high))


def _thread_camera(grid: Array, contact: MemberContact, size: tuple[int, int]) -> Camera:
    """Look at a flank of points (I, J, 3) that winds round its axis: at what touches on the side of the axis where the middle of
    the contact is, and at as much of the flank as that takes."""
    turn = _turn_near(grid, contact.middle, IN_SIGHT)
    columns = _nearest_columns(grid, contact.places)
    touched = columns[(columns >= turn.start) & (columns < turn.stop)]
    seen = grid[:, touched.min() : touched.max() + 1]
    up = unit(_heights(seen).mean(axis=0))
    across = unit(cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1))[:, turn].reshape(-1, 3).mean(axis=0))
    out = across * np.sign(dot(across, unit(np.nanmean(contact.normal, axis=0))))
    # across the threads the next one would hide the root, from above the flank would be too steep
    camera = frame(ASLANT * out + up, up, seen.reshape(-1, 3), size, margin=FILLS)
    return replace(
        camera, height=max(camera.height, CUT_OFF * float(np.linalg.norm(seen[-1] - seen[0], axis=-1).mean()))
    )


def _nearest_columns(grid: Array, places: Array) -> NDArray[np.int64]:
    """Columns (K,) of a flank's points (I, J, 3) that places (K, 3) are nearest to."""
    few = grid[:: max(grid.shape[0] // 4, 1)]
    away = np.linalg.norm(places[:, None, None] - few, axis=-1)
    return np.asarray(away.min(axis=1).argmin(axis=1))


def _heights(grid: Array) -> Array:
    """Unit vectors (J, 3) from root to tip of a flank's points (I, J, 3)."""
    return np.asarray(unit(grid[-1] - grid[0]))


def _winds(grid: Array) -> bool:
    """Whether a flank winds so far round its axis that no direction looks at all of it."""
    return float(np.linalg.norm(_heights(grid).mean(axis=0))) < WINDS


def _turn_near(grid: Array, point: Array, least: float) -> slice:
    """The columns of a flank that winds, of points (I, J, 3), with heights at angles whose cosine with that at the column nearest
    to a point (3,) is at least `least`."""
    heights = _heights(grid)
    nearest = int(np.linalg.norm(grid - point, axis=-1).min(axis=0).argmin())
    other = np.flatnonzero(heights @ heights[nearest] < least)
    first = int(other[other < nearest].max(initial=-1)) + 1
    return slice(first, int(other[other > nearest].min(initial=len(heights))))


def _front(view: ToothView, camera: Camera) -> float:
    """How far (mm) before the focus the flank comes where it comes least: a gear is round, and before it there hide it."""
    if view.grid is None:
        return float(((_flank_points(view) - camera.focus) @ camera.axes[2]).max())
    depth = (view.grid - camera.focus) @ camera.axes[2]
    return float(depth.max(axis=0).min())


def edge_words(view: ToothView, camera: Camera, contact: MemberContact) -> tuple[Word, ...]:
    """Toe, heel, tip and root at the edges of the flank, above and below the middle of what is seen of it, or as near to that as
    they stand clear of what touches."""
    if view.grid is None:
        return ()
    if _winds(view.grid):
        part = view.grid[:, _turn_near(view.grid, camera.focus, ALIKE)]
        i, j = part.shape[0] // 2, part.shape[1] // 2
        return tuple(Word(word, part[k, j], part[i, j]) for word, k in (("tip", -1), ("root", 0)))
    i = view.grid.shape[0] // 2
    j = int(np.abs((view.grid[i] - camera.focus) @ camera.axes[0]).argmin())
    words = []
    for word, k in ("tip", -1), ("root", 0):
        column = _clear_column(view.grid[k], j, contact.places, camera)
        words.append(Word(word, view.grid[k, column], view.grid[i, column]))
    return (*(_end_word(view, view.grid, camera, word, k) for word, k in zip(view.ends, (0, -1), strict=True)), *words)


def _clear_column(edge: Array, middle: int, marks: Array, camera: Camera) -> int:
    """Of an edge of a flank, points (J, 3), the one nearest to its `middle` one by which no marks (K, 3) are seen."""
    width = camera.height * WORD
    across = camera.axes[:2].T
    places = (edge - camera.focus) @ across
    away = np.abs(places[:, None] - (marks - camera.focus) @ across)
    near = np.any((away[..., 0] < width) & (away[..., 1] < 0.5 * width), axis=1)
    clear = np.flatnonzero(~near & (np.abs(places[:, 0]) < 0.5 * camera.height - width))
    return int(clear[np.abs(clear - middle).argmin()]) if len(clear) else middle


def _end_word(view: ToothView, grid: Array, camera: Camera, word: str, end: int) -> Word:
    """Toe or heel beside the `end` of a flank; where that is outside of the picture, below the root at the picture's edge, clear of
    what lies on the flank."""
    (right, rise, _), i = camera.axes, grid.shape[0] // 2
    half = 0.5 * camera.height * view.size[0] / view.size[1]
    length = float((grid[i, end] - camera.focus) @ right)
    if abs(length) <= half:
        return Word(word, grid[i, end], grid[i, grid.shape[1] // 2])
    root = (grid[0] - camera.focus) @ right
    j = int(np.abs(root - np.sign(length) * AT_EDGE * half).argmin())
    below = grid[0, j] - BELOW_ROOT * np.ptp(grid[:, j] @ rise) * rise
    return Word(word, below, grid[i, j], beyond=True)


def _flank_points(view: ToothView) -> Array:
    """Points (K, 3) of the flank that is looked at, or of both flanks of its tooth."""
    if view.grid is not None:
        return view.grid.reshape(-1, 3)
    flanks = [name for name in view.fine.region_names if name in FLANK_REGIONS.values()]
    return view.fine.only(*flanks).vertices if flanks else view.fine.vertices


def _towards(axis: Array, points: Array) -> tuple[Array, bool]:
    """An axis (3,) in the sense in which points (K, 3) lie along it, and whether they tell: their middle is beyond `ASIDE`."""
    along = points @ axis
    middle = 0.5 * float(along.min() + along.max())
    tells = abs(middle) > ASIDE * float(np.ptp(along))
    return (-axis if tells and middle < 0.0 else axis), tells


def pair_camera(
    pair: GearPair,
    pinion: Array,
    gear: Array,
    size: tuple[int, int],
    close_up: tuple[Array, float] | None = None,
) -> Camera:
    """Look at a pair so that the mesh is seen: the picture holds the vertices `pinion` and `gear` (K, 3), fixed frame.

    Axes at a small angle are seen nearly end on, the pinion above or left of the gear; at a large angle the gear lies
    under the pinion and turns its teeth up. With `close_up` the picture holds the radius around its point instead.
    """
    first, second = pair.pinion.mount.axis, pair.gear.mount.axis
    apart = pinion.mean(axis=0) - gear.mean(axis=0)
    points = np.concatenate((pinion, gear))
    if pair.acute_angle > STEEP:
        # both axes from where they cross to the bodies; where a body lies on both sides of that, as a worm does, the pinion is in
        # front: vertices alone would tell rounding
        first, of_pinion = _towards(first, pinion - pair.gear.mount.origin)
        second, _ = _towards(second, gear - pair.pinion.mount.origin)
        if not of_pinion and cross(first, second) @ apart < 0.0:
            first = -first
        side = unit(cross(first, second))
        whole = frame(0.9 * side - 0.6 * second - 0.5 * first, -second, points, size)
    else:
        along = unit(first + np.where(dot(first, second) < 0, -second, second))
        above = unit(apart - dot(apart, along) * along)
        ups = (above, cross(above, along))
        views = (frame(along + 0.4 * up + 0.3 * cross(up, along), up, points, size) for up in ups)
        whole = min(views, key=lambda camera: camera.height)
    if close_up is None:
        return whole
    point, radius = close_up
    return replace(whole, position=whole.position - whole.focus + point, focus=point, height=2.0 * radius)
