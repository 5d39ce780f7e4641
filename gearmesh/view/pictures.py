"""The pictures and plots of a gear pair: which meshes a picture needs, and how finely; drawing is left to the renderer.

A flank picture meshes the tooth that carries the contact finely and lets the rest be coarse.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from gearmesh.contact.cycle import Cycle
from gearmesh.contact.flanks import contact_flank
from gearmesh.contact.path import ContactPath
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.algebra import Array
from gearmesh.kernel.nearest import nearest
from gearmesh.mesh.solid import gear_solid, teeth_mesh
from gearmesh.mesh.tessellate import tessellate
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.region import Side
from gearmesh.teeth.train import GearPair
from gearmesh.view import plots as plotting
from gearmesh.view.scene import Scene, ToothView, contact_on
from gearmesh.view.views import gap_scene, member_scene, pair_scene, pattern_scene, set_scene

#: width and height of a picture in pixels
Size = tuple[int, int]
SIZE = (1600, 1200)
#: tolerances (mm) of the tooth looked at, and of what surrounds it
FINE, COARSE = 0.002, 0.05
#: exact points across and along a flank on which patterns are drawn
PATTERN_GRID = (81, 161)
#: start points of projections onto a flank
PROJECTION_GRID = (31, 61)


def contact_picture(
    pair: GearPair, name: str, path: ContactPath, size: Size = SIZE, view: ToothView | None = None
) -> Scene:
    """A member's tooth with the path of contact and the contact ellipses (or lines) on it.

    `view`, of `tooth_view`, saves meshing the tooth again, here and in the other pictures of a tooth.
    """
    view = replace(view or tooth_view(pair, name), title=f"{name}: path of contact and contact ellipses", size=size)
    return member_scene(view, contact_on(pair.index(name), path, pair.mounts))


def pattern_picture(
    pair: GearPair, name: str, path: ContactPath, size: Size = SIZE, view: ToothView | None = None
) -> Scene:
    """A member's tooth with its contact pattern as the union of the ellipses.

    Raises NoSolutionError where contact is along lines or on edges, which have no ellipses.
    """
    contact = contact_on(pair.index(name), path, pair.mounts)
    if not contact.ellipses.size:
        raise NoSolutionError(
            "no position has an ellipse of contact: the pattern by the roll test (gap) shows the contact"
        )
    view = replace(view or tooth_view(pair, name), title=f"{name}: contact pattern, union of the ellipses", size=size)
    return pattern_scene(view, contact, _pattern_grid(pair, name))


def gap_picture(
    pair: GearPair,
    name: str,
    path: ContactPath,
    patches: list[tuple[Array, Array]],
    size: Size = SIZE,
    view: ToothView | None = None,
) -> Scene:
    """A member's tooth with the gaps that the roll test found: `patches` of points in its own frame and gaps, mm."""
    contact = contact_on(pair.index(name), path, pair.mounts)
    view = replace(view or tooth_view(pair, name), title=f"{name}: contact pattern, roll test of the meshes", size=size)
    return gap_scene(view, contact, _pattern_grid(pair, name), patches, pair.delta)


def pair_picture(pair: GearPair, meshes: dict[str, TriangleMesh], path: ContactPath, size: Size = SIZE) -> Scene:
    """Both members in mesh, at the middle position with contact."""
    k = _middle(path)
    first, second = (meshes[name] for name in pair.members)
    return pair_scene(first, second, pair, (float(path.rotation[k]), float(path.phi2[k])), "pair in mesh", size)


def set_picture(gears: GearPair, placed: dict[str, TriangleMesh], size: Size = SIZE) -> Scene:
    """All members of a train of several meshes, of which `gears` is the first, in the fixed frame."""
    return set_scene(placed, gears.pinion.mount.axis, "gears in mesh", size)


def all_pictures(
    pair: GearPair, path: ContactPath, patches: list[tuple[Array, Array]], meshes: dict[str, TriangleMesh]
) -> dict[str, Scene]:
    """Scenes by file name: both members with their contact, the pinion's pattern by ellipses and by the roll test, the pair.

    Contact along lines or on edges has no ellipses, and no picture of their union; the roll test shows its pattern.
    """
    first = pair.pinion.name
    views = {name: tooth_view(pair, name) for name in pair.members}
    scenes = {f"{name}_contact.png": contact_picture(pair, name, path, view=view) for name, view in views.items()}
    if contact_on(0, path, pair.mounts).ellipses.size:
        scenes[f"{first}_pattern.png"] = pattern_picture(pair, first, path, view=views[first])
    if patches:
        scenes[f"{first}_gap.png"] = gap_picture(pair, first, path, patches, view=views[first])
    scenes["pair.png"] = pair_picture(pair, meshes, path)
    return scenes


def plots(gears: GearPair, path: ContactPath, cycle: Cycle | None, te_file: Path, path_file: Path) -> None:
    """TE over the positions with the whole mesh cycle, and the paths of contact on both flanks."""
    plotting.plot_transmission_error(te_file, path, cycle, slide=gears.slide)
    plotting.plot_flank_paths(path_file, [flank_view(gears, name, path) for name in gears.members])


def flank_view(gears: GearPair, name: str, path: ContactPath) -> plotting.FlankView:
    """A member's trimmed flank with a path of contact on it, to be drawn by `plots.plot_flank_paths`."""
    contact = contact_on(gears.index(name), path, gears.mounts)
    return plotting.FlankView(name, _outline(gears, name), contact, course=gears.members[name].mount.course)


def in_mesh(gears: GearPair, meshes: dict[str, TriangleMesh], path: ContactPath) -> dict[str, TriangleMesh]:
    """The members' meshes in the fixed frame at the middle position with contact."""
    k = _middle(path)
    turns = path.rotation[k], path.phi2[k]
    return {
        name: meshes[name].moved(member.mount.at(turn))
        for (name, member), turn in zip(gears.members.items(), turns, strict=True)
    }


def _middle(path: ContactPath) -> int:
    touching = np.flatnonzero(path.touching)
    return int(touching[len(touching) // 2])


def _side(gears: GearPair, name: str) -> Side:
    return gears.flanks[gears.index(name)]


def tooth_view(gears: GearPair, name: str) -> ToothView:
    """A member's tooth to look at, finely meshed, in front of the rest of its gear."""
    body = gears.members[name]
    fine = teeth_mesh(tessellate(body.tooth, FINE), name, np.array([0]))
    rough = tessellate(body.tooth, COARSE)
    whole = gear_solid(replace(body, keyway=None, hub=None, holes=None), COARSE, rough)
    context = replace(
        whole,
        triangles=whole.triangles[rough.triangles :],
        regions=whole.regions[rough.triangles :],
        normals=whole.normals[rough.triangles :],
    )
    return ToothView(fine, _projection(gears, name), context)


def _projection(gears: GearPair, name: str) -> Callable[[Array], Array]:
    """Points (..., 3) near the flank -> closest points of the trimmed exact flank, NaN beyond its edges."""
    flank = contact_flank(gears.members[name], _side(gears, name))
    s, t = (np.linspace(0.0, 1.0, n) for n in PROJECTION_GRID)
    grid = gears.members[name].tooth.flank_grid(_side(gears, name), s, t)
    tree, (p, v) = cKDTree(grid.points.reshape(-1, 3)), grid.parameters.reshape(-1, 2).T

    def project(q: Array) -> Array:
        known = np.isfinite(q).all(axis=-1)
        places = np.full(q.shape, np.nan)
        distance, start = tree.query(q[known])
        found = nearest(flank.surface, q[known], p[start], v[start])
        jet = found.jet
        outside = flank.margin(found.values, jet.r) > 1e-6
        # beyond a singular line of the surface the search can end farther away than it started
        outside |= np.linalg.norm(jet.r - q[known], axis=-1) > distance + 1e-9
        places[known] = np.where(outside[:, None], np.nan, jet.r)
        return places

    return project


def _pattern_grid(gears: GearPair, name: str) -> Array:
    s, t = (np.linspace(0.0, 1.0, n) for n in PATTERN_GRID)
    return gears.members[name].tooth.flank_grid(_side(gears, name), s, t).points


def _outline(gears: GearPair, name: str) -> Array:
    """Points (K, 3) round the trimmed flank, own frame."""
    nodes = np.linspace(0.0, 1.0, 41)
    points = gears.members[name].tooth.flank_grid(_side(gears, name), nodes, nodes).points
    return np.concatenate((points[0], points[1:, -1], points[-1, -2::-1], points[-2::-1, 0]))
