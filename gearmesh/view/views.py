"""Scenes of a gear pair: members with their contact, patterns, gap maps and the pair in mesh; and their cameras."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, every_nth, unit
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
from gearmesh.view.palette import OUTLINE_COLOUR, REGION_EDGE
from gearmesh.view.scene import (
    BLUE_STEEL_PAINT,
    BRASS_PAINT,
    BRONZE_PAINT,
    MARKED_PAINT,
    PLUM_PAINT,
    SAGE_PAINT,
    Camera,
    CompoundFilm,
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


def tooth_scene(view: ToothView, contact: MemberContact, camera: Camera | None = None) -> Scene:
    """Scene of a tooth with its title and the names of its edges; without a `camera` the flank fills the picture."""
    camera = camera or flank_camera(view, contact)
    return Scene(view.bodies, camera, words=edge_words(view, camera, contact), title=view.title, size=view.size)


def member_scene(view: ToothView, contact: MemberContact, count: int = 9) -> Scene:
    """Scene of a tooth with the path of contact and about `count` evenly spaced contact ellipses or contact lines."""
    chosen = every_nth(contact.ellipses, count)
    discs, outlines = ellipses_on_surface(contact, chosen, view.project, view.lift)
    areas = tuple(PatternArea(disc, label="contact ellipses" if i == 0 else "") for i, disc in enumerate(discs))
    curves = (Curve(outlines.reshape(-1, 3), colour=OUTLINE_COLOUR, width=1.5),) if len(chosen) else ()
    return replace(
        tooth_scene(view, contact),
        areas=areas,
        curves=curves + contact_lines(view, contact, count) + path_on_surface(view, contact),
        dots=position_dots(view, contact),
    )


def pattern_scene(view: ToothView, contact: MemberContact, grid: Array) -> Scene:
    """Scene of a tooth with the union of its contact ellipses as one area.

    `grid` (I, J, 3) are points of its exact flank; 150 x 300 points draw the ends of slender ellipses smoothly. A pair
    in line contact shows its lines instead.
    """
    lifted, level = lift_grid(grid, contact, view.lift), union_level(contact, grid)
    area = PatternArea(lifted, level, "contact pattern: union of the ellipses")
    border = (Curve(area_edges(lifted, level), colour=REGION_EDGE, width=1.0),) if len(contact.ellipses) else ()
    return replace(
        tooth_scene(view, contact),
        areas=(area,) if len(contact.ellipses) else (),
        curves=border + contact_lines(view, contact, count=25) + path_on_surface(view, contact),
    )


def compound_share(gap: Array) -> Array:
    """Share (I, J) of marking compound that stays at a gap (I, J), in thicknesses of the compound; all without a gap."""
    return np.where(np.isfinite(gap), np.clip(gap, 0.0, 1.0), 1.0)


def compound_scene(view: ToothView, contact: MemberContact, grid: Array, share: Array, rubbed: str) -> Scene:
    """Scene of a tooth painted with marking compound, as it looks after rolling.

    - grid: points (I, J, 3) of the exact flank.
    - share: share (I, J) of the compound that stays at these points.
    - rubbed: text of the legend that says where the compound is gone.
    """
    lifted = lift_grid(grid, contact, view.lift)
    film = CompoundFilm(lifted, share, unit(lifted - grid), rubbed_label=rubbed)
    bodies = tuple(replace(body, paint=MARKED_PAINT) for body in view.bodies)
    return replace(tooth_scene(view, contact), bodies=bodies, films=(film,))


def gap_scene(
    view: ToothView, contact: MemberContact, grid: Array, patches: Sequence[tuple[Array, Array]], limit: float
) -> Scene:
    """Scene of a tooth with the smallest gap of a roll test, up to `limit` mm, in colours.

    `grid` (I, J, 3) are points of its exact flank. Every patch has the points (M, N, 3), own frame, and gaps (M, N),
    mm, of one position, NaN without a gap. The path of contact is drawn from `contact`, the solver's result.
    """
    gap, lifted = closest_gap(grid, patches), lift_grid(grid, contact, view.lift)
    value_map = ValueMap(lifted, 1e3 * gap, 1e3 * limit, "smallest gap in the roll test (µm)")
    border = Curve(area_edges(lifted, gap / limit), colour=REGION_EDGE, width=1.0)
    seen = replace(view, size=beside_bar(view.size))
    near = grid[np.isfinite(gap)]
    # the roll test has one position: on a thread it may lie beside the path of contact
    winds = view.grid is not None and len(near) and _winds(view.grid)
    camera = _thread_camera(view.grid, contact, seen.size, near) if winds and view.grid is not None else None
    return replace(
        tooth_scene(seen, contact, camera),
        maps=(value_map,),
        curves=(border, *path_on_surface(view, contact)),
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
    """Scene of both members (own frames), mounted and rotated by `phi` = (phi1, phi2), fixed frame.

    `close_up` is a point (3,), fixed frame, and the radius (mm) around it that fills the picture instead of the pair.
    """
    bodies = (
        SceneBody(pinion, pair.pinion.mount.at(phi[0]), BLUE_STEEL_PAINT),
        SceneBody(gear, pair.gear.mount.at(phi[1]), BRASS_PAINT),
    )
    first, second = (body.own_to_scene.point(body.mesh.vertices) for body in bodies)
    return Scene(bodies, pair_camera(pair, first, second, size, close_up), title=title, size=size)


def set_scene(
    placed: Mapping[str, TriangleMesh], axis: Array, title: str = "", size: tuple[int, int] = (1600, 1200)
) -> Scene:
    """Scene of meshes in the fixed frame, seen along their common axis.

    Members whose names differ only by a number have the same colour.
    """
    kinds = list(dict.fromkeys(_kind(name) for name in placed))
    colours = (BLUE_STEEL_PAINT, BRASS_PAINT, BRONZE_PAINT, SAGE_PAINT, PLUM_PAINT)
    bodies = tuple(
        SceneBody(mesh, Rigid.identity(), colours[kinds.index(_kind(name)) % len(colours)])
        for name, mesh in placed.items()
    )
    aside = (
        unit(cross(np.array([0.0, 1.0, 0.0]), axis)) if abs(axis[1]) < MIN_UPRIGHT_COSINE else np.array([1.0, 0.0, 0.0])
    )
    up = cross(axis, aside)
    back = unit(axis + VIEW_SWING * aside + VIEW_SWING * up)
    points = np.concatenate([mesh.vertices for mesh in placed.values()])
    return Scene(bodies, _below_heading(frame(back, up, points, size, PAIR_MARGIN)), title=title, size=size)


def _below_heading(camera: Camera) -> Camera:
    """Return the camera that sees whole gears a little below the middle of the picture, under the heading."""
    return camera.moved(HEADING_SHIFT * camera.height * camera.axes[1], camera.height)


def _kind(name: str) -> str:
    """Name of a member without its number: planets look alike."""
    return name.rstrip("0123456789").rstrip("_")


# --- cameras ---

#: offset of a body from the crossing of the axes at which it lies on one side, in lengths of the body along its axis
MIN_OFFSET_LENGTHS = 0.05
#: components of the direction of view aside and up, relative to its component along the axis of a gear set
VIEW_SWING = 0.35
#: cosine of the angle to y from which an axis is upright
MIN_UPRIGHT_COSINE = 0.9

#: smallest height of a picture in which a long flank is cut off, in heights of the flank
MIN_CUT_HEIGHT = 2.6
#: largest height of a picture that holds all contact, in heights of the flank
MAX_HELD_HEIGHT = 10.2
#: height of a picture that does not hold all contact, in heights of the flank: teeth are seen, and some ellipses
CROWDED_HEIGHT = 6.0
#: size of a picture relative to its content
FLANK_MARGIN = 1.14
#: factor by which a picture may grow so that a flank need not be cut off
MAX_GROWTH = 1.25
#: position of the name of an end outside of the picture, as a share of the way to the picture's edge
END_WORD_SHARE = 0.94
#: distance of this name below the root, in heights of the flank
END_WORD_DROP = 0.1
#: length of a flank, in its heights, beyond which it is turned away from the viewer
MAX_SEEN_LENGTH_HEIGHTS = 3.0
#: largest angle by which a long flank is turned away
MAX_TURN_RAD = np.radians(55.0)
#: length of the mean normal of a flank below which its profile is so curved that it is shown from an end
MIN_FLAT_NORMAL = 0.98
#: smallest angle by which a flank with such a profile is turned away
CURVED_TURN_RAD = np.radians(38.0)
#: angle by which the viewer looks from above
LOOK_DOWN_RAD = np.radians(20.0)
#: half the width of a word, as a share of the picture's height
WORD_HALF_WIDTH = 0.06
#: distance of the front plane from the foremost point of the flank, in its heights: the fillet is seen, the next tooth
#: is not
FRONT_CLEARANCE = 0.12
#: length of the mean direction from root to tip below which a flank winds round its axis
MIN_MEAN_DIRECTION = 0.5
#: cosine of the angle within which such directions look alike
MIN_ALIKE_COSINE = 0.85
#: cosine of the angle within which the flank is in sight
MIN_VISIBLE_COSINE = -0.35
#: weight of the flank's normal in the direction of view of a flank that winds, relative to its height
NORMAL_WEIGHT = 0.7
#: factors of a point's coordinates that leave its part perpendicular to z
PLANE_FACTORS = np.array([1.0, 1.0, 0.0])

#: size of the picture of a pair relative to the pair
PAIR_MARGIN = 1.18
#: distance by which a pair is below the middle of its picture, under the heading, as a share of the height
HEADING_SHIFT = 0.035
#: components of the direction of view along the gear's axis that are tried for a pair seen from the side
SIDE_VIEW_HEIGHTS = (0.6, 0.9, 1.2)
#: cosine of the angle within which a rack is turned level
MIN_LEVEL_COSINE = 0.7
#: least share of the width of a whole rack that is seen, so that its pinion fills the height
MIN_RACK_SHARE = 0.55

#: shaft angle from which a pair is looked at from the side
SIDE_VIEW_ANGLE_RAD = np.radians(55.0)


def frame(back: Array, up: Array, points: Array, size: tuple[int, int], margin: float = 1.3) -> Camera:
    """Return the parallel camera that looks along -`back` with `up` upwards (3,) and holds `points` (K, 3) with a
    `margin`.
    """
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
    """Return the camera that looks at a flank, level and with its tip on top; the flank fills the picture.

    It looks along the mean outward normal, a little from above. A long flank is turned away, so that it appears
    shorter. The neighbouring tooth that would hide the flank is cut away. A flank much longer than high is cut off
    beyond all contact, or within it where the flank would be a thin strip. Raises NoSolutionError if no position has
    contact.
    """
    if not np.isfinite(contact.normal).any():
        raise NoSolutionError(
            view.title or "flank picture", reason="no position has contact, so there is nothing to show"
        )
    if view.grid is not None and _winds(view.grid):
        return _thread_camera(view.grid, contact, view.size)
    normal, up = _facing(view, contact)
    whole, most = _whole_tooth(view, contact, normal, *_looking(view.grid, normal, up))
    if whole.height <= MAX_GROWTH * most:
        return whole
    # too long: the contact is in the middle along the tooth, but the picture never reaches beyond an end
    part = None if view.grid is None else float(np.ptp(contact.places @ _along(view.grid)))
    whole, most = _whole_tooth(view, contact, normal, *_looking(view.grid, normal, up, part))
    (right, rise, _), grid = whole.axes, _flank_points(view)
    lengths, touched = (grid - whole.focus) @ right, (contact.places - whole.focus) @ right
    half = 0.5 * most * view.size[0] / view.size[1] / FLANK_MARGIN
    middle = 0.5 * float(touched.min() + touched.max())
    aside = float(np.clip(middle, lengths.min() + half, lengths.max() - half)) if np.ptp(lengths) > 2.0 * half else 0.0
    near = np.abs(lengths - aside) < half
    lifted = (grid - whole.focus)[near] @ rise
    shift = aside * right + 0.5 * float(lifted.min() + lifted.max()) * rise
    return whole.moved(shift, min(most, whole.height))


def _whole_tooth(
    view: ToothView, contact: MemberContact, normal: Array, back: Array, up: Array, along: Array | None
) -> tuple[Camera, float]:
    """Return the camera that holds a whole flank, and the height (mm) of a picture that holds all contact."""
    grid = _flank_points(view)
    camera = frame(back, up, grid, view.size, margin=FLANK_MARGIN)
    right, rise, _ = camera.axes
    height = np.ptp(grid @ rise)
    # the front plane cuts the next tooth away
    front = _front(view, camera.focus, normal) + FRONT_CLEARANCE * height
    # height in the proportions of the picture; ellipses may be longer than the flank
    touched = min(FLANK_MARGIN * np.ptp(contact.places @ right) * view.size[1] / view.size[0], camera.height)
    most = float(
        max(touched if touched < MAX_HELD_HEIGHT * height else CROWDED_HEIGHT * height, MIN_CUT_HEIGHT * height)
    )
    return replace(camera, front=front, front_normal=normal, measured=along), most


def _facing(view: ToothView, contact: MemberContact) -> tuple[Array, Array]:
    """Return the mean outward normal (3,) of a flank, on the side of the contact, and the direction (3,) to its tip."""
    grid, normal = _flank_points(view), unit(np.nanmean(contact.normal, axis=0))
    if view.grid is not None:
        own = cross(np.gradient(view.grid, axis=0), np.gradient(view.grid, axis=1))
        mean = unit(own.reshape(-1, 3).sum(axis=0))
        normal = mean * np.sign(dot(mean, normal))
    land = (
        view.fine.only("land").normals if "land" in view.fine.region_names else grid.mean(axis=0)[None] * PLANE_FACTORS
    )
    return normal, unit(land.mean(axis=0))


def _along(grid: Array) -> Array:
    """Unit vector (3,) from toe to heel of a flank's points (I, J, 3)."""
    return np.asarray(unit(grid[:, -1].mean(axis=0) - grid[:, 0].mean(axis=0)))


def _looking(
    grid: Array | None, normal: Array, up: Array, part: float | None = None
) -> tuple[Array, Array, Array | None]:
    """Return three directions (3,) for a flank's points (I, J, 3): back to the viewer, upwards, and along the tooth.

    The last is None without points. `part` is the length (mm) that is looked at, if it is not the whole flank.
    """
    if grid is None:
        return normal, up, None
    ends = _along(grid)
    along = unit(ends - dot(ends, normal) * normal)
    rise = cross(normal, along)
    rise = rise * np.sign(rise @ up)
    length, height = (float(np.ptp(grid @ way)) for way in (along, rise))
    length = length if part is None else min(part, length)
    turn = float(np.arccos(np.clip(MAX_SEEN_LENGTH_HEIGHTS * height / max(length, height), np.cos(MAX_TURN_RAD), 1.0)))
    if _profile_flatness(grid) < MIN_FLAT_NORMAL:
        turn = max(turn, CURVED_TURN_RAD)
    # towards the end that is in sight anyway: its face shows how deep the teeth are
    sense = np.sign(normal[2] * along[2]) or 1.0
    aside = np.cos(turn) * normal + sense * np.sin(turn) * along
    back = unit(np.cos(LOOK_DOWN_RAD) * aside + np.sin(LOOK_DOWN_RAD) * rise)
    level_up = cross(back, unit(ends - dot(ends, back) * back))
    return back, level_up * np.sign(level_up @ rise), ends


def _profile_flatness(grid: Array) -> float:
    """Length of the mean unit normal along the profile in the middle of a flank's points (I, J, 3); 1 if it is straight."""
    middle = grid.shape[1] // 2
    normals = unit(cross(np.gradient(grid, axis=0)[:, middle], np.gradient(grid, axis=1)[:, middle]))
    return float(np.linalg.norm(normals.mean(axis=0)))


def flank_pixel(grid: Array, size: tuple[int, int]) -> float:
    """Smallest length (mm) of a pixel if `flank_camera` looks at a flank with points (I, J, 3) in a picture of a
    `size`.
    """
    middle = grid[grid.shape[0] // 2]
    length = float(np.linalg.norm(np.diff(middle, axis=0), axis=-1).sum())
    height = float(np.linalg.norm(grid[-1] - grid[0], axis=-1).mean())
    wide, high = size
    return max(FLANK_MARGIN * height / high, min(FLANK_MARGIN * length / wide, MIN_CUT_HEIGHT * height / high))


def _thread_camera(grid: Array, contact: MemberContact, size: tuple[int, int], places: Array | None = None) -> Camera:
    """Return the camera that looks at a flank of points (I, J, 3) that winds round its axis.

    It looks from the side on which the middle of the contact lies, or of `places` (K, 3), and sees the columns of the
    flank with contact there.
    """
    middle = contact.middle
    if places is None:
        places = contact.places
    else:
        middle = places[int(np.linalg.norm(places - places.mean(axis=0), axis=-1).argmin())]
    turn = _turn_near(grid, middle, MIN_VISIBLE_COSINE)
    columns = _nearest_columns(grid, places)
    touched = columns[(columns >= turn.start) & (columns < turn.stop)]
    seen = grid[:, touched.min() : touched.max() + 1]
    up = unit(_heights(seen).mean(axis=0))
    across = unit(cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1))[:, turn].reshape(-1, 3).mean(axis=0))
    out = across * np.sign(dot(across, unit(np.nanmean(contact.normal, axis=0))))
    # seen along the normal, the next thread would hide the root; seen from above, the flank would be too steep
    camera = frame(NORMAL_WEIGHT * out + up, up, seen.reshape(-1, 3), size, margin=FLANK_MARGIN)
    return replace(
        camera, height=max(camera.height, MIN_CUT_HEIGHT * float(np.linalg.norm(seen[-1] - seen[0], axis=-1).mean()))
    )


def _nearest_columns(grid: Array, places: Array) -> NDArray[np.int64]:
    """Columns (K,) of a flank's points (I, J, 3) that are nearest to places (K, 3)."""
    few = grid[:: max(grid.shape[0] // 4, 1)]
    away = np.linalg.norm(places[:, None, None] - few, axis=-1)
    return np.asarray(away.min(axis=1).argmin(axis=1))


def _heights(grid: Array) -> Array:
    """Unit vectors (J, 3) from root to tip of a flank's points (I, J, 3)."""
    return np.asarray(unit(grid[-1] - grid[0]))


def _winds(grid: Array) -> bool:
    """True if a flank winds so far round its axis that no direction of view shows all of it."""
    return float(np.linalg.norm(_heights(grid).mean(axis=0))) < MIN_MEAN_DIRECTION


def _turn_near(grid: Array, point: Array, least: float) -> slice:
    """Return the columns of a winding flank, of points (I, J, 3), around the column nearest to a point (3,).

    The cosine of the angle between their heights and the height of that column is at least `least`.
    """
    heights = _heights(grid)
    nearest = int(np.linalg.norm(grid - point, axis=-1).min(axis=0).argmin())
    other = np.flatnonzero(heights @ heights[nearest] < least)
    first = int(other[other < nearest].max(initial=-1)) + 1
    return slice(first, int(other[other > nearest].min(initial=len(heights))))


def _front(view: ToothView, focus: Array, normal: Array) -> float:
    """Distance (mm) of the front plane before the focus: the smallest over the columns of their foremost points.

    A gear is round: teeth before this plane would hide the flank.
    """
    if view.grid is None:
        return float(((_flank_points(view) - focus) @ normal).max())
    depth = (view.grid - focus) @ normal
    return float(depth.max(axis=0).min())


def edge_words(view: ToothView, camera: Camera, contact: MemberContact) -> tuple[Word, ...]:
    """Return the words toe, heel, tip and root at the edges of the flank.

    Tip and root are above and below the middle of the visible part, or at the nearest position clear of the contact.
    """
    if view.grid is None:
        return ()
    if _winds(view.grid):
        part = view.grid[:, _turn_near(view.grid, camera.focus, MIN_ALIKE_COSINE)]
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
    """Index of the point of a flank's edge (J, 3) nearest to its `middle` point that is clear of the marks (K, 3)."""
    width = camera.height * WORD_HALF_WIDTH
    across = camera.axes[:2].T
    places = (edge - camera.focus) @ across
    away = np.abs(places[:, None] - (marks - camera.focus) @ across)
    near = np.any((away[..., 0] < width) & (away[..., 1] < 0.5 * width), axis=1)
    clear = np.flatnonzero(~near & (np.abs(places[:, 0]) < 0.5 * camera.height - width))
    return int(clear[np.abs(clear - middle).argmin()]) if len(clear) else middle


def _end_word(view: ToothView, grid: Array, camera: Camera, word: str, end: int) -> Word:
    """Return the word toe or heel beside an `end` of a flank.

    If the end is outside of the picture, the word is below the root at the picture's edge, clear of the content of the
    flank.
    """
    (right, rise, _), i = camera.axes, grid.shape[0] // 2
    half = 0.5 * camera.height * view.size[0] / view.size[1]
    length = float((grid[i, end] - camera.focus) @ right)
    if abs(length) <= half:
        return Word(word, grid[i, end], grid[i, grid.shape[1] // 2])
    root = (grid[0] - camera.focus) @ right
    j = int(np.abs(root - np.sign(length) * END_WORD_SHARE * half).argmin())
    below = grid[0, j] - END_WORD_DROP * np.ptp(grid[:, j] @ rise) * rise
    return Word(word, below, grid[i, j], beyond=True)


def _flank_points(view: ToothView) -> Array:
    """Points (K, 3) of the flank in view, or of both flanks of its tooth if there is no grid."""
    if view.grid is not None:
        return view.grid.reshape(-1, 3)
    flanks = [name for name in view.fine.region_names if name in FLANK_REGIONS.values()]
    return view.fine.only(*flanks).vertices if flanks else view.fine.vertices


def _towards(axis: Array, points: Array) -> tuple[Array, bool]:
    """Return an axis (3,) in the sense in which points (K, 3) lie along it, and True if their offset decides it.

    It decides if their middle is farther from the origin than `MIN_OFFSET_LENGTHS`.
    """
    along = points @ axis
    middle = 0.5 * float(along.min() + along.max())
    tells = abs(middle) > MIN_OFFSET_LENGTHS * float(np.ptp(along))
    return (-axis if tells and middle < 0.0 else axis), tells


def _level(pair: GearPair, back: Array, up: Array) -> Array:
    """Return the direction upwards (3,) near `up` by which a rack is level; `up` itself for gears that turn."""
    for mount in pair.mounts:
        first, second = mount.at(0.0), mount.at(1.0)
        if np.allclose(first.rotation, second.rotation):
            way = unit(second.translation - first.translation)
            level = unit(cross(back, way - dot(way, unit(back)) * unit(back)))
            return np.asarray(level * np.sign(level @ up)) if abs(level @ up) > MIN_LEVEL_COSINE else up
    return up


def _nearer_rack(whole: Camera, rack: Array, pinion: Array) -> Camera:
    """Return the camera nearer to a level rack and its pinion, vertices (K, 3): long racks go on beyond the picture."""
    right, up, _ = whole.axes
    rises = np.concatenate((rack, pinion)) @ up
    height = max(PAIR_MARGIN * float(np.ptp(rises)), MIN_RACK_SHARE * whole.height)
    if height >= whole.height:
        return whole
    # the pinion is in the middle, but the picture never reaches farther beyond an end than that of the whole rack
    of_rack, of_pinion = ((points - whole.focus) @ right for points in (rack, pinion))
    middle = 0.5 * float(of_pinion.min() + of_pinion.max())
    spare = 0.5 * float(np.ptp(of_rack)) * (1.0 - height / whole.height)
    return whole.moved(float(np.clip(middle, -spare, spare)) * right, height)


def _filled(camera: Camera, points: Array, size: tuple[int, int]) -> float:
    """Share of a picture that the box around points (K, 3) takes."""
    wide, high = np.ptp((points - camera.focus) @ camera.axes[:2].T, axis=0) / camera.height
    return float(wide * high * size[1] / size[0])


def pair_camera(
    pair: GearPair,
    pinion: Array,
    gear: Array,
    size: tuple[int, int],
    close_up: tuple[Array, float] | None = None,
) -> Camera:
    """Return the camera that looks at the mesh of a pair and holds the vertices `pinion` and `gear` (K, 3), fixed
    frame.

    Axes at a small angle are seen nearly end on, the pinion above or left of the gear. At a large angle the gear lies
    under the pinion with its teeth up. With `close_up` the picture holds the radius around its point instead.
    """
    first, second = pair.pinion.mount.axis, pair.gear.mount.axis
    apart = pinion.mean(axis=0) - gear.mean(axis=0)
    points = np.concatenate((pinion, gear))
    if pair.acute_angle > SIDE_VIEW_ANGLE_RAD:
        # each axis points from the crossing of the axes to its body; a worm lies on both sides of the crossing, its
        # sense would depend on rounding: then the sense that puts the pinion in front is taken
        first, of_pinion = _towards(first, pinion - pair.gear.mount.origin)
        second, _ = _towards(second, gear - pair.pinion.mount.origin)
        if not of_pinion and cross(first, second) @ apart < 0.0:
            first = -first
        side = unit(cross(first, second))
        # a flat ring is seen from higher up than a wheel
        ways = [(0.9 * side - height * second - 0.5 * first, -second) for height in SIDE_VIEW_HEIGHTS]
    else:
        along = unit(first + np.where(dot(first, second) < 0, -second, second))
        above = unit(apart - dot(apart, along) * along)
        ups = (above, cross(above, along))
        ways = [
            (along + 0.4 * up + 0.3 * cross(up, along), _level(pair, along + 0.4 * up + 0.3 * cross(up, along), up))
            for up in ups
        ]
    whole = max(
        (frame(back, up, points, size, PAIR_MARGIN) for back, up in ways),
        key=lambda camera: _filled(camera, points, size),
    )
    if not pair.gear.mount.spin.any():
        whole = _nearer_rack(whole, gear, pinion)
    whole = _below_heading(whole)
    if close_up is None:
        return whole
    point, radius = close_up
    return replace(whole, position=whole.position - whole.focus + point, focus=point, height=2.0 * radius)
