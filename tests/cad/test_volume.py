"""Volumes of CAD solids by the borders of their faces, against closed forms and OpenCASCADE's own integral."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.cad_readers import needs_step

from gearmesh.cad.step import NamedFace, Part
from gearmesh.cad.volume import volume

pytestmark = needs_step

#: radii and height of a frustum, height of its lower end, radius of a hole beside the axis and distance of its axis, mm
LOW, HIGH, RISE, LEVEL, HOLE, BESIDE = 5.0, 3.0, 4.0, 7.0, 1.0, 1.25


def part_of(solid: Any) -> Part:
    """A part with all faces of a solid."""
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    faces, explorer = [], TopExp_Explorer(solid, TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        faces.append(NamedFace(TopoDS.Face(explorer.Current()), f"face_{len(faces)}", "face"))
        explorer.Next()
    return Part("part", solid, tuple(faces), ("face",))


def axes(x: float, z: float, up: float = 1.0, tilt: float = 0.0) -> Any:
    """Axes at (x, 0, z) whose direction is up or down, tilted towards x by an angle, rad."""
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return gp_Ax2(gp_Pnt(x, 0.0, z), gp_Dir(float(np.sin(tilt)), 0.0, up * float(np.cos(tilt))))


@pytest.mark.parametrize("up", [1.0, -1.0])
def test_frustum_with_a_hole_beside_its_axis(up: float) -> None:
    """The closed form; upside down the axes of cone, planes and circles are turned, too."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder

    frustum = BRepPrimAPI_MakeCone(axes(0.0, LEVEL, up), LOW, HIGH, RISE).Shape()
    hole = BRepPrimAPI_MakeCylinder(axes(BESIDE, LEVEL - up, up), HOLE, RISE + 2.0).Shape()
    made = part_of(BRepAlgoAPI_Cut(frustum, hole).Shape())
    expected = np.pi * RISE * ((LOW**2 + LOW * HIGH + HIGH**2) / 3.0 - HOLE**2)
    assert len(made.faces) == 4
    assert volume(made) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_frustum_cut_across(tilt: float) -> None:
    """The border of a frustum that a slanted cylinder cuts has other curves than lines and circles: OpenCASCADE's integral."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder
    from OCP.GProp import GProp_GProps

    frustum = BRepPrimAPI_MakeCone(axes(0.0, LEVEL), LOW, HIGH, RISE).Shape()
    cutter = BRepPrimAPI_MakeCylinder(axes(LOW, LEVEL - 1.0, 1.0, tilt), 2.0 * HOLE, RISE + 3.0).Shape()
    cut = BRepAlgoAPI_Cut(frustum, cutter).Shape()
    mass = GProp_GProps()
    BRepGProp.VolumeProperties_s(cut, mass, 1e-10)
    assert volume(part_of(cut)) == pytest.approx(mass.Mass(), rel=1e-8)
