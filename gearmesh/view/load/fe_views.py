"""Pictures of a solved finite-element model, as scenes: the pressure on the flanks, and the stress of both members.

Both show the edges of the elements. The scale of a pressure that the elements do not resolve ends with the pressure by
Hertz, or with the mean pressure where an edge touches.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.answers.bodies.finite_elements import FiniteElementSolution
from gearmesh.fe.model import Model
from gearmesh.fe.placing import PlacedPair
from gearmesh.fe.results import NodalSolution, principal_stresses
from gearmesh.io.atomic import whole_file
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.hexahedra.hexes import HEX_FACES, HexMesh
from gearmesh.mesh.triangles import TriangleMesh, facet_normals
from gearmesh.view.palette import INK_COLOUR, RESULT_COLOUR_MAP
from gearmesh.view.picture import Diagram
from gearmesh.view.render import render
from gearmesh.view.scene import BLUE_STEEL_PAINT, BRASS_PAINT, Camera, Curve, Scene, SceneBody, ValueMap
from gearmesh.view.views import frame

#: end of the stress scale, relative to the largest tension in a fillet; at the contact the stress is far larger
STRESS_SHARE = 1.25
#: angle by which a flank is seen from above its tooth's tip, so that the neighbouring teeth do not hide it
VIEW_TILT_RAD = 0.6
#: face sets whose faces other sets repeat
REPEATED_SETS = ("bore",)
#: size of a face, pixels, from which its edges are drawn: finer ones would blacken the picture
MIN_DRAWN_FACE_PIXELS = 5.0
#: largest share of a scale that is drawn: float32 must not round a value beyond the end, where maps have holes
SCALE_END_SHARE = 1.0 - 1e-6
#: width of the elements' edges, pixels
EDGE_WIDTH_PIXELS = 0.7


def pressure_scene(
    model: Model, solution: NodalSolution, at: PlacedPair, size: tuple[int, int] = (1600, 1200), note: str = ""
) -> Scene:
    """Scene of the pressed teeth of the first member with their contact pressure, the leading flank facing the viewer;
    model's frame.

    Only faces with pressure on a corner are coloured. `note` says why the pressure is not resolved: then the scale and
    the title have the pressure by Hertz, or the mean pressure of edge contact.
    """
    mesh, name = model.mesh, next(iter(model.materials))
    flanks = {contact.slave: mesh.face_corners(contact.slave) for contact in model.contacts}
    point, normal = at.frame.point(at.path.point[0]), at.frame.vector(at.path.normal[0])
    leading = min(
        flanks, key=lambda flank: float(np.linalg.norm(mesh.nodes[flanks[flank]].mean(axis=1) - point, axis=-1).min())
    )
    pressed = [flank for flank in flanks if flank == leading or solution.pressure[flanks[flank]].any()]
    faces = np.concatenate([flanks[flank] for flank in pressed])
    shown = np.unique(
        np.concatenate([mesh.element_sets[f"{name}_tooth_{flank.rsplit('_', 1)[1]}"] for flank in pressed])
    )
    skins = [set_name for set_name in _outer_sets(mesh, name) if np.isin(mesh.face_sets[set_name][:, 0], shown).any()]
    outwards = unit(point * [1.0, 1.0, 0.0])
    rise = unit(outwards - dot(outwards, normal) * normal)
    camera = frame(
        np.cos(VIEW_TILT_RAD) * normal + np.sin(VIEW_TILT_RAD) * rise,
        outwards,
        mesh.nodes[np.unique(mesh.elements[shown])],
        size,
    )
    limit, words = _pressure_scale(solution, at, note)
    return Scene(
        bodies=(SceneBody(skin(mesh, name, shown), Rigid.identity(), BLUE_STEEL_PAINT),),
        camera=camera,
        curves=element_edges(mesh, skins, shown, camera, size),
        maps=(
            _patches(
                mesh,
                faces[solution.pressure[faces].max(axis=1) > 0.0],
                solution.pressure,
                limit,
                "contact pressure (MPa)",
            ),
        ),
        title=f"{name}: contact pressure, {words}",
        size=size,
    )


def _pressure_scale(solution: NodalSolution, at: PlacedPair, note: str) -> tuple[float, str]:
    """Return the end of the scale, MPa, and its words; `note` says why the largest pressure is not resolved."""
    peak = float(solution.pressure.max())
    if not note:
        return peak, f"at most {peak:.0f} MPa"
    if np.isnan(at.pressure):
        mean = max(
            (float(np.linalg.norm(each.force)) / each.area for each in solution.contacts if each.area), default=0.0
        )
        return (mean, f"mean {mean:.0f} MPa ({note})") if mean else (max(peak, 1.0), f"({note})")
    return at.pressure, f"{at.pressure:.0f} MPa by Hertz ({note})"


def stress_scene(model: Model, solution: NodalSolution, at: PlacedPair, size: tuple[int, int] = (1600, 1200)) -> Scene:
    """Scene of all bodies from above toe or heel, coloured by the largest principal stress where it is tension."""
    mesh = model.mesh
    tension = np.maximum(principal_stresses(solution.stress)[:, 2], 0.0)
    worst = max(float(tension[mesh.face_nodes(name)].max()) for name in mesh.face_sets if "_fillet_" in name)
    sets = [set_name for name in model.materials for set_name in _outer_sets(mesh, name)]
    faces = np.concatenate([mesh.face_corners(name) for name in sets])
    every = np.arange(len(mesh.elements))
    bodies = [
        SceneBody(skin(mesh, name, every), Rigid.identity(), paint)
        for name, paint in zip(model.materials, (BLUE_STEEL_PAINT, BRASS_PAINT), strict=False)
    ]
    normal = at.frame.vector(at.path.normal[0])
    outwards = unit(at.frame.point(at.path.point[0]) * [1.0, 1.0, 0.0])
    # along the axis, a little from the side that is pressed
    back = unit(np.array([0.0, 0.0, 1.0]) + 0.5 * cross(outwards, np.array([0.0, 0.0, np.sign(normal[2]) or 1.0])))
    limit, camera = STRESS_SHARE * worst, frame(back, outwards, mesh.nodes, size)
    return Scene(
        bodies=tuple(bodies),
        camera=camera,
        curves=element_edges(mesh, sets, every, camera, size),
        maps=(_patches(mesh, faces, tension, limit, "largest principal stress (MPa)"),),
        title=f"fillets: tension at most {worst:.0f} MPa",
        size=size,
    )


def _outer_sets(mesh: HexMesh, member: str) -> list[str]:
    """Return the face sets that cover a member, each face once."""
    return [name for name in mesh.face_sets if name.startswith(f"{member}_") and not name.endswith(REPEATED_SETS)]


def skin(mesh: HexMesh, member: str, elements: NDArray[np.int64]) -> TriangleMesh:
    """Return the named faces of some of a member's elements as triangles, with its face sets as regions.

    Where other elements of the member adjoin these, the faces between them close the skin.
    """
    names, corners = [], []
    for name in _outer_sets(mesh, member):
        chosen = mesh.face_corners(name)[np.isin(mesh.face_sets[name][:, 0], elements)]
        if len(chosen):
            names.append(name.removeprefix(f"{member}_"))
            corners.append(chosen)
    between = _cut_faces(mesh, elements)
    if len(between):
        names.append("cut")
        corners.append(between)
    triangles = np.concatenate(corners)[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    regions = np.repeat(np.arange(len(names), dtype=np.int32), [2 * len(faces) for faces in corners])
    return TriangleMesh(mesh.nodes, triangles, regions, tuple(names), facet_normals(mesh.nodes, triangles), member)


def _cut_faces(mesh: HexMesh, elements: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the corners (K, 4) of faces between given elements and others of the mesh, counterclockwise from outside."""
    corners = mesh.elements[:, :8][:, np.array(HEX_FACES)[:, ::-1]].reshape(-1, 4)
    keys = np.sort(corners, axis=1)
    _, face, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    inside = np.repeat(np.isin(np.arange(len(mesh.elements)), elements), len(HEX_FACES))
    face = face.reshape(-1)
    mine = np.bincount(face[inside], minlength=len(count))
    between: NDArray[np.int64] = corners[inside & (count[face] == 2) & (mine[face] == 1)]
    return between


def element_edges(
    mesh: HexMesh, sets: list[str], elements: NDArray[np.int64], camera: Camera, size: tuple[int, int]
) -> tuple[Curve, ...]:
    """Return the edges of the faces of some elements in some face sets as one curve, without faces that are too small."""
    outlines = np.concatenate(
        [mesh.face_outlines(name)[np.isin(mesh.face_sets[name][:, 0], elements)] for name in sets]
    )
    a, b, c, d = np.moveaxis(mesh.nodes[outlines[:, :: outlines.shape[1] // 4]], 1, 0)
    area = 0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=-1)
    drawn = outlines[np.sqrt(area) * size[1] / camera.height > MIN_DRAWN_FACE_PIXELS]
    edges = np.unique(np.sort(np.stack((drawn, np.roll(drawn, -1, axis=1)), axis=-1).reshape(-1, 2), axis=1), axis=0)
    if not len(edges):
        return ()
    points = np.concatenate((mesh.nodes[edges], np.full((len(edges), 1, 3), np.nan)), axis=1).reshape(-1, 3)
    return (Curve(points, colour=INK_COLOUR, width=EDGE_WIDTH_PIXELS),)


def _patches(mesh: HexMesh, faces: NDArray[np.int64], values: Array, limit: float, label: str) -> ValueMap:
    """Return a map of values (N,) at the nodes, on faces (K, 4)."""
    around = faces[:, [[0, 1], [3, 2]]]
    return ValueMap(
        mesh.nodes[around], np.minimum(values[around], SCALE_END_SHARE * limit), limit, label, RESULT_COLOUR_MAP
    )


def solution_picture(solved: FiniteElementSolution) -> Diagram:
    """Diagram of the pressure on the pinion and the tension in both members, side by side; a single member has its
    tension alone.

    A pressure that the elements do not resolve stands last.
    """
    problem = solved.problem

    def draw(file: Path) -> None:
        from matplotlib.image import imsave

        scenes = [stress_scene(problem._model, solved.solution, problem._built.at)]
        if problem._model.contacts:
            pressure = pressure_scene(problem._model, solved.solution, problem._built.at, note=solved.reserve)
            scenes.insert(1 if solved.reserve else 0, pressure)
        panels = [render(scene) for scene in scenes]
        with whole_file(file) as unfinished:
            imsave(unfinished, np.concatenate(panels, axis=1))

    return Diagram(f"{problem.headline}: pressure and tension", draw, _pixels=True)
