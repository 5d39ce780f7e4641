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
from gearmesh.kernel.algebra import Array
from gearmesh.kernel.nearest import nearest
from gearmesh.mesh.solid import gear_solid, teeth_mesh
from gearmesh.mesh.tessellate import tessellate
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.pair import GearPair
from gearmesh.view import plots as plotting
from gearmesh.view.scene import ToothView, contact_on
from gearmesh.view.views import gap_scene, member_scene, pair_scene, pattern_scene

#: tolerances (mm) of the tooth looked at, and of what surrounds it
FINE, COARSE = 0.002, 0.05
#: exact points across and along a flank on which patterns are drawn
PATTERN_GRID = (81, 161)
#: start points of projections onto a flank
PROJECTION_GRID = (31, 61)


def member(
    gears: GearPair, name: str, path: ContactPath, file: Path | str, size: tuple[int, int] = (1600, 1200)
) -> None:
    """A member's tooth with the path of contact and the contact ellipses on it."""
    from gearmesh.view.render import render

    view = replace(_view(gears, name), title=f"{name}: path of contact and contact ellipses", size=size)
    render(member_scene(view, contact_on(name, path, gears.assembly)), file)


def all_pictures(
    gears: GearPair,
    path: ContactPath,
    patches: list[tuple[Array, Array]],
    meshes: dict[str, TriangleMesh],
    folder: Path,
) -> list[Path]:
    """Both members with their contact, the pinion's pattern by ellipses and by the roll test, and the pair in mesh.

    Contact along lines or on edges has no ellipses, and no picture of their union; the roll test shows its pattern.
    """
    from gearmesh.view.render import render

    scenes = {}
    for name in gears.members:
        view = _view(gears, name)
        contact = contact_on(name, path, gears.assembly)
        title = f"{name}: path of contact and contact ellipses"
        scenes[f"{name}_contact.png"] = member_scene(replace(view, title=title), contact)
        if name == "pinion":
            grid = _pattern_grid(gears)
            if contact.ellipses.size:
                title = "pinion: contact pattern, union of the ellipses"
                scenes["pinion_pattern.png"] = pattern_scene(replace(view, title=title), contact, grid)
            if patches:
                title = "pinion: contact pattern, roll test of the meshes"
                scenes["pinion_gap.png"] = gap_scene(replace(view, title=title), contact, grid, patches, gears.delta)
    k = _middle(path)
    scenes["pair.png"] = pair_scene(
        meshes["pinion"], meshes["gear"], gears.assembly, (float(path.rotation[k]), float(path.phi2[k])), "pair in mesh"
    )
    for file, scene in scenes.items():
        render(scene, folder / file)
    return [folder / file for file in scenes]


def plots(gears: GearPair, path: ContactPath, cycle: Cycle | None, te_file: Path, path_file: Path) -> None:
    """TE over the positions with the whole mesh cycle, and the paths of contact on both flanks."""
    whole = None
    if cycle is not None:
        whole = plotting.MeshCycle(cycle.phi1, cycle.te, cycle.envelope)
    plotting.plot_transmission_error(te_file, path, whole)
    plotting.plot_flank_paths(path_file, [flank_view(gears, name, path) for name in gears.members])


def flank_view(gears: GearPair, name: str, path: ContactPath) -> plotting.FlankView:
    """A member's trimmed flank with a path of contact on it, to be drawn by `plots.plot_flank_paths`."""
    return plotting.FlankView(name, _outline(gears, name), contact_on(name, path, gears.assembly))


def in_mesh(gears: GearPair, meshes: dict[str, TriangleMesh], path: ContactPath) -> dict[str, TriangleMesh]:
    """The members' meshes in the fixed frame at the middle position with contact."""
    k = _middle(path)
    return {
        "pinion": meshes["pinion"].moved(gears.assembly.pinion.at(path.rotation[k])),
        "gear": meshes["gear"].moved(gears.assembly.gear.at(path.phi2[k])),
    }


def _middle(path: ContactPath) -> int:
    touching = np.flatnonzero(path.touching)
    return int(touching[len(touching) // 2])


def _side(gears: GearPair, name: str) -> str:
    return gears.flanks[0 if name == "pinion" else 1]


def _view(gears: GearPair, name: str) -> ToothView:
    body = gears.members[name]
    fine = teeth_mesh(tessellate(body.tooth, FINE), name, np.array([0]))
    rough = tessellate(body.tooth, COARSE)
    whole = gear_solid(replace(body, keyway=None, hub=None), COARSE, rough)
    one_tooth = 2 * sum((len(patch.s) - 1) * (rough.t.size - 1) for patch in rough.patches)
    context = replace(
        whole,
        triangles=whole.triangles[one_tooth:],
        regions=whole.regions[one_tooth:],
        normals=whole.normals[one_tooth:],
    )
    return ToothView(fine, _projection(gears, name), context)


def _projection(gears: GearPair, name: str) -> Callable[[Array], Array]:
    """Points (..., 3) near the flank -> closest points of the trimmed exact flank, NaN beyond its edges."""
    mount = getattr(gears.assembly, name)
    flank = contact_flank(gears.members[name], _side(gears, name), mount)
    s, t = (np.linspace(0.0, 1.0, n) for n in PROJECTION_GRID)
    grid = gears.members[name].tooth.flank_grid(_side(gears, name), s, t)
    assert grid.p is not None
    assert grid.v is not None
    tree, p, v = cKDTree(grid.points.reshape(-1, 3)), grid.p.ravel(), grid.v.ravel()

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


def _pattern_grid(gears: GearPair) -> Array:
    s, t = (np.linspace(0.0, 1.0, n) for n in PATTERN_GRID)
    return gears.pinion.tooth.flank_grid(gears.flanks[0], s, t).points


def _outline(gears: GearPair, name: str) -> Array:
    """Points (K, 3) round the trimmed flank, own frame."""
    nodes = np.linspace(0.0, 1.0, 41)
    points = gears.members[name].tooth.flank_grid(_side(gears, name), nodes, nodes).points
    return np.concatenate((points[0], points[1:, -1], points[-1, -2::-1], points[-2::-1, 0]))
