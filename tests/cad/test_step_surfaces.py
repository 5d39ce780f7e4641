"""Flanks and surfaces of some teeth as STEP: open shells on the exact surfaces, as other programs read them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.built import built_sample
from oracles.cad_readers import gmsh_model, needs_step

from gearmesh import DesignError
from gearmesh.answers.bodies.extract import Extract
from gearmesh.kinds import Region

pytestmark = needs_step


def read(path: Path, points: np.ndarray) -> tuple[int, int, float, np.ndarray, np.ndarray]:
    """Solids of a file, edges of one face alone, the area of its faces, and of points (N, 3) the distances from the nearest face
    and its normals, by gmsh."""
    with gmsh_model(path) as model:
        faces = model.getEntities(2)
        area = sum(model.occ.getMass(*face) for face in faces)
        nearest, normals = np.full(len(points), np.inf), np.zeros_like(points)
        for dimension, tag in faces:
            if not len(points):
                break
            feet, at = model.getClosestPoint(dimension, tag, points.ravel())
            away = np.linalg.norm(np.reshape(feet, (-1, 3)) - points, axis=1)
            own = np.reshape(model.getNormal(tag, at), (-1, 3))
            normals[away < nearest] = own[away < nearest]
            nearest = np.minimum(nearest, away)
        outline = len(model.getBoundary(faces, combined=True, oriented=False))
        return len(model.getEntities(3)), outline, area, nearest, normals


def middle_of(face: Any) -> tuple[np.ndarray, np.ndarray]:
    """A point in the middle of a face, and the normal there, in the sense of the face."""
    from OCP.BRepGProp import BRepGProp_Face
    from OCP.gp import gp_Pnt, gp_Vec

    surface, point, normal = BRepGProp_Face(face), gp_Pnt(), gp_Vec()
    u, w, v, z = surface.Bounds()
    surface.Normal(0.5 * (u + w), 0.5 * (v + z), point, normal)
    normal.Normalize()
    return np.array([point.X(), point.Y(), point.Z()]), np.array([normal.X(), normal.Y(), normal.Z()])


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "member", "rows"),
    [("double_helical", "pinion", 2), pytest.param("spiral_bevel_basic", "gear", 1, marks=pytest.mark.sweep)],
)
def test_flanks_are_open_shells_on_the_exact_surfaces(sample: str, member: str, rows: int, tmp_path: Path) -> None:
    gears = built_sample(sample)
    cad = gears.cad(member, "0.1um", flank_only="left", teeth=2, offset=0.02)
    assert [face.region for face in cad.made.faces] == [Region.FLANK_LEFT] * 2 * rows
    tooth, s = Extract.of(0.02).shift(gears.members[member]).tooth, np.linspace(0.0, 1.0, 201)
    grid = tooth.grid(Region.FLANK_LEFT, s, tooth.sections(s)).points
    across, back = grid[1:, 1:] - grid[:-1, :-1], grid[1:, :-1] - grid[:-1, 1:]
    exact = 2 * rows * 0.5 * np.linalg.norm(np.cross(across, back), axis=-1).sum()
    mesh = gears.solid(member, "1um", flank_only="left", teeth=2, offset=0.02).mesh
    some = np.linspace(0, len(mesh.vertices) - 1, 200).astype(int)
    solids, _, area, away, normals = read(cad.save(tmp_path / "flanks.step"), mesh.vertices[some])
    assert solids == 0
    assert away.max() < 1e-4
    assert area == pytest.approx(exact, rel=2e-6)
    assert cad.measured[member].area == pytest.approx(area, rel=1e-7)
    assert np.abs((normals * mesh.vertex_normals[some]).sum(axis=1)).min() > 1.0 - 1e-6
    for face in cad.made.faces:
        point, normal = middle_of(face.shape)
        vertex = np.argmin(np.linalg.norm(mesh.vertices - point, axis=1))
        assert normal @ mesh.vertex_normals[vertex] > 0.9


@pytest.mark.parametrize(("sample", "member"), [("rack", "rack"), ("helical", "pinion")])
@pytest.mark.sweep_cases("helical-pinion")
def test_faces_of_some_teeth_have_their_edges_in_common(sample: str, member: str, tmp_path: Path) -> None:
    cad = built_sample(sample).cad(member, "1um", teeth=3)
    count = len(cad.made.faces)
    assert [face.region for face in cad.made.faces].count(Region.LAND) == 3
    solids, outline, area, *_ = read(cad.save(tmp_path / "teeth.step"), np.zeros((0, 3)))
    # lands and roots of helical teeth are less than what cylinders have between their ends
    assert cad.measured[member].area == pytest.approx(area, rel=1e-6)
    # every face has an edge at toe and heel, the first and the last one another
    assert (solids, outline) == (0, 2 * count + 2)


def test_refusals() -> None:
    gears = built_sample("helical")
    with pytest.raises(DesignError, match="flank_only = left: must be left out for several members"):
        gears.cad(flank_only="left")
    with pytest.raises(DesignError, match="teeth = 99: must be a whole number from 1 to 24"):
        gears.cad("pinion", teeth=99)
    with pytest.raises(DesignError, match="teeth = 2: must be left out with space"):
        gears.cad("pinion", teeth=2, space=True)
