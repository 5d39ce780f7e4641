"""The pictures of a gear pair as scenes: members with their contact, patterns, gap maps, the pair; and the cameras."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.algebra import Array, cross, dot, unit
from gearmesh.kernel.rigid import Rigid
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.region import FLANKS
from gearmesh.teeth.train import GearPair
from gearmesh.view.on_tooth import (
    closest_gap,
    contact_lines,
    ellipses_on_surface,
    lift_grid,
    path_on_surface,
    position_dots,
    spread,
    union_level,
)
from gearmesh.view.scene import (
    BLUE_STEEL,
    BRASS,
    BRONZE,
    OUTLINE,
    Camera,
    Curve,
    MemberContact,
    PatternArea,
    Scene,
    SceneBody,
    ToothView,
    ValueMap,
)


def member_scene(view: ToothView, contact: MemberContact, count: int = 9, camera: Camera | None = None) -> Scene:
    """A tooth with the path of contact and, at up to `count` positions, the contact ellipses or contact lines."""
    chosen = spread(contact.ellipses, count)
    discs, outlines = ellipses_on_surface(contact, chosen, view.project, view.lift)
    areas = tuple(PatternArea(disc, label="contact ellipses" if i == 0 else "") for i, disc in enumerate(discs))
    curves = (Curve(outlines, colour=OUTLINE, width=1.5),) if len(chosen) else ()
    return Scene(
        bodies=view.bodies,
        camera=camera or flank_camera(view, contact),
        areas=areas,
        curves=curves + contact_lines(view, contact, count) + path_on_surface(view, contact),
        dots=position_dots(view, contact),
        title=view.title,
        size=view.size,
    )


def pattern_scene(view: ToothView, contact: MemberContact, grid: Array, camera: Camera | None = None) -> Scene:
    """A tooth with the union of its contact ellipses as one area; `grid` (I, J, 3) are points of its exact flank.

    150 x 300 points draw the ends of slender ellipses smoothly. A pair in line contact shows its lines instead.
    """
    lifted = lift_grid(grid, contact, view.lift)
    area = PatternArea(lifted, union_level(contact, grid), "contact pattern: union of the ellipses")
    return Scene(
        bodies=view.bodies,
        camera=camera or flank_camera(view, contact),
        areas=(area,) if len(contact.ellipses) else (),
        curves=contact_lines(view, contact, count=25) + path_on_surface(view, contact),
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
    gap = closest_gap(grid, patches)
    value_map = ValueMap(
        lift_grid(grid, contact, view.lift), 1e3 * gap, 1e3 * limit, "smallest gap in the roll test (µm)"
    )
    return Scene(
        bodies=view.bodies,
        camera=camera or flank_camera(view, contact),
        maps=(value_map,),
        curves=path_on_surface(view, contact),
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
    return Scene(bodies, framed(back, up, points, size), title=title, size=size)


def _kind(name: str) -> str:
    """The name of a member without its number: planets are alike."""
    return name.rstrip("0123456789").rstrip("_")


# --- cameras ---

#: how far aside and up, as parts of the way along the axis, a set of gears is looked at from
SWUNG = 0.35
#: cosine from which on an axis is upright
ALONG = 0.9

#: shaft angle (rad) from which on a pair is looked at from the side
STEEP = np.radians(55.0)


def framed(back: Array, up: Array, points: Array, size: tuple[int, int], margin: float = 1.3) -> Camera:
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


def flank_camera(view: ToothView, contact: MemberContact, tilt: float = 0.6, swing: float = 0.2) -> Camera:
    """Look at a flank along its outward normal at the middle of the contact, tilted so that neighbours do not hide it.

    The view is up the tooth (along the normals of its top land), turned by `tilt` (rad) from the normal towards the tip
    and by `swing` along the tooth; it holds the flanks of `view.fine`.
    """
    if not np.isfinite(contact.normal).any():
        raise NoSolutionError(
            f"{view.title or 'flank picture'}: no position has contact, so there is nothing to look at"
        )
    flanks = [name for name in view.fine.region_names if name in FLANKS.values()]
    shown = view.fine.only(*flanks).vertices if flanks else view.fine.vertices
    normal = unit(np.nanmean(contact.normal, axis=0))
    middle = np.nanmean(contact.point, axis=0)
    land = view.fine.only("land").normals if "land" in view.fine.region_names else middle[None] * [1.0, 1.0, 0.0]
    up = unit(land.mean(axis=0))
    rise = unit(up - dot(up, normal) * normal)
    along = cross(rise, normal)
    back = np.cos(tilt) * (np.cos(swing) * normal + np.sin(swing) * along) + np.sin(tilt) * rise
    return framed(back, up, shown, view.size)


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
        # both axes from where they cross to the bodies
        first = first * np.sign(first @ (pinion.mean(axis=0) - pair.gear.mount.origin))
        second = second * np.sign(second @ (gear.mean(axis=0) - pair.pinion.mount.origin))
        side = unit(cross(first, second))
        whole = framed(0.9 * side - 0.6 * second - 0.5 * first, -second, points, size)
    else:
        along = unit(first + np.where(dot(first, second) < 0, -second, second))
        above = unit(apart - dot(apart, along) * along)
        ups = (above, cross(above, along))
        views = (framed(along + 0.4 * up + 0.3 * cross(up, along), up, points, size) for up in ups)
        whole = min(views, key=lambda camera: camera.height)
    if close_up is None:
        return whole
    point, radius = close_up
    return replace(whole, position=whole.position - whole.focus + point, focus=point, height=2.0 * radius)
