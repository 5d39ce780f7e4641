"""Pictures of a solved finite-element model, as scenes: the pressure on the flanks, and the stress of both members."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.answers.bodies.finite_elements import FiniteElementSolution
from gearmesh.errors import OutputError
from gearmesh.fe.model import Model
from gearmesh.fe.placing import PlacedPair
from gearmesh.fe.results import NodalSolution, principal_stresses
from gearmesh.formats import PNG_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.mesh.triangles import TriangleMesh, facet_normals
from gearmesh.view.picture import Diagram
from gearmesh.view.render import render
from gearmesh.view.scene import BLUE_STEEL_PAINT, BRASS_PAINT, Scene, SceneBody, ValueMap
from gearmesh.view.views import frame

#: end of the stress scale, relative to the largest tension in a fillet; at the contact the stress is far larger
STRESS_SHARE = 1.25
#: angle by which a flank is seen from above its tooth's tip, so that the neighbouring teeth do not hide it
VIEW_TILT_RAD = 0.6
#: face sets whose faces other sets repeat
REPEATED_SETS = ("bore",)


def pressure_scene(
    model: Model, solution: NodalSolution, at: PlacedPair, size: tuple[int, int] = (1600, 1200), note: str = ""
) -> Scene:
    """Scene of the first member with the contact pressure on its flanks, the leading flank facing the viewer; model's
    frame.

    Only faces with pressure on a corner are coloured. `note` is added to the title's statement of the pressure.
    """
    mesh, name = model.mesh, next(iter(model.materials))
    flanks = [mesh.face_corners(contact.slave) for contact in model.contacts]
    point, normal = at.frame.point(at.path.point[0]), at.frame.vector(at.path.normal[0])
    leading = min(
        flanks, key=lambda faces_of: float(np.linalg.norm(mesh.nodes[faces_of].mean(axis=1) - point, axis=-1).min())
    )
    faces = np.concatenate(flanks)
    pressed = solution.pressure[faces]
    peak = float(solution.pressure.max())
    outwards = unit(point * [1.0, 1.0, 0.0])
    rise = unit(outwards - dot(outwards, normal) * normal)
    return Scene(
        bodies=(SceneBody(skin(mesh, name), Rigid.identity(), BLUE_STEEL_PAINT),),
        camera=frame(
            np.cos(VIEW_TILT_RAD) * normal + np.sin(VIEW_TILT_RAD) * rise,
            outwards,
            mesh.nodes[np.unique(leading)],
            size,
        ),
        maps=(_patches(mesh, faces[pressed.max(axis=1) > 0.0], solution.pressure, peak, "contact pressure (MPa)"),),
        title=f"{name}: contact pressure, at most {peak:.0f} MPa{note and f' ({note})'}",
        size=size,
    )


def stress_scene(model: Model, solution: NodalSolution, at: PlacedPair, size: tuple[int, int] = (1600, 1200)) -> Scene:
    """Scene of all bodies from above toe or heel, coloured by the largest principal stress where it is tension."""
    mesh = model.mesh
    tension = np.maximum(principal_stresses(solution.stress)[:, 2], 0.0)
    worst = max(float(tension[mesh.face_nodes(name)].max()) for name in mesh.face_sets if "_fillet_" in name)
    faces = np.concatenate([mesh.face_corners(name) for name in mesh.face_sets if not name.endswith(REPEATED_SETS)])
    bodies = [
        SceneBody(skin(mesh, name), Rigid.identity(), paint)
        for name, paint in zip(model.materials, (BLUE_STEEL_PAINT, BRASS_PAINT), strict=False)
    ]
    normal = at.frame.vector(at.path.normal[0])
    outwards = unit(at.frame.point(at.path.point[0]) * [1.0, 1.0, 0.0])
    # along the axis, a little from the side that is pressed
    back = unit(np.array([0.0, 0.0, 1.0]) + 0.5 * cross(outwards, np.array([0.0, 0.0, np.sign(normal[2]) or 1.0])))
    limit = STRESS_SHARE * worst
    return Scene(
        bodies=tuple(bodies),
        camera=frame(back, outwards, mesh.nodes, size),
        maps=(_patches(mesh, faces, np.minimum(tension, limit), limit, "largest principal stress (MPa)"),),
        title=f"fillets: tension at most {worst:.0f} MPa",
        size=size,
    )


def skin(mesh: HexMesh, member: str) -> TriangleMesh:
    """Return the outer faces of one member as triangles, with its face sets as regions."""
    names = [name for name in mesh.face_sets if name.startswith(f"{member}_") and not name.endswith(REPEATED_SETS)]
    corners = [mesh.face_corners(name) for name in names]
    triangles = np.concatenate(corners)[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    regions = np.repeat(np.arange(len(names), dtype=np.int32), [2 * len(faces) for faces in corners])
    return TriangleMesh(
        mesh.nodes,
        triangles,
        regions,
        tuple(name.removeprefix(f"{member}_") for name in names),
        facet_normals(mesh.nodes, triangles),
        member,
    )


def _patches(mesh: HexMesh, faces: NDArray[np.int64], values: Array, limit: float, label: str) -> ValueMap:
    """Return a map of values (N,) at the nodes, on faces (K, 4)."""
    around = faces[:, [[0, 1], [3, 2]]]
    return ValueMap(mesh.nodes[around], values[around], limit, label)


def solution_picture(solved: FiniteElementSolution) -> Diagram:
    """Diagram of the pressure on the pinion and the tension in both members, side by side; a single member has its
    tension alone.
    """
    problem = solved.problem

    def draw(file: Path) -> None:
        from matplotlib.image import imsave

        if file.suffix.lower() != PNG_SUFFIX:
            raise OutputError("cannot write", file, reason="its suffix must be .png")
        scenes = [stress_scene(problem._model, solved.solution, problem._built.at)]
        if problem._model.contacts:
            scenes.insert(0, pressure_scene(problem._model, solved.solution, problem._built.at, note=solved.reserve))
        panels = [render(scene) for scene in scenes]
        with whole_file(file) as unfinished:
            imsave(unfinished, np.concatenate(panels, axis=1))

    return Diagram(f"{problem.headline}: pressure and tension", draw)
