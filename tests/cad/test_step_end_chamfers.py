"""Chamfers of end faces as STEP: valid solids with faces of their own, as heavy as sections and meshes say, as another program
reads them."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from oracles.built import built, built_sample
from oracles.cad_readers import gmsh_model, needs_step

import gearmesh as gm
from gearmesh.cad.brep import exact_volume

pytestmark = needs_step

#: tip roundings that end in points before the end face, one end sharp, a gap between mirrored halves
HELICAL = {"kind": "cylindrical", "module": 2, "helix_angle": 20}
HELICAL |= {"gear": {"teeth": 13, "face_width": 12, "bore": 8, "tip_rounding": 0.2, "end_chamfer_heel": 0.3}}
HALVES = {"kind": "cylindrical", "module": 2, "helix_angle": 20, "arrangement": "double_helical", "gap": 3}
HALVES |= {"gear": {"teeth": 13, "face_width": 20, "end_chamfer": 0.2}}


def read(path: Path) -> tuple[list[float], int]:
    """Volumes of a file's solids, and the number of its faces, by gmsh."""
    with gmsh_model(path) as model:
        volumes = [model.occ.getMass(*solid) for solid in model.getEntities(3)]
        return volumes, len(model.getEntities(2))


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("gears", "name", "toe", "heel"),
    [
        # seven links, two of which end in points
        (lambda: built(HELICAL), "gear", 0, 8),
        (lambda: built(HALVES), "gear", 12, 12),
        pytest.param(
            lambda: built_sample("helical", "pinion.end_rounding_toe=1", "pinion.end_chamfer_heel=0.5"),
            *("pinion", 6, 6),
            marks=pytest.mark.sweep,
        ),
        pytest.param(
            lambda: built_sample("spiral_bevel_basic", "gear.end_rounding_heel=0.6"),
            *("gear", 0, 6),
            marks=pytest.mark.sweep,
        ),
        # the root is reached in an arc on one side and in a mitre on the other
        pytest.param(
            lambda: built_sample("spiral_bevel_formate", "pinion.end_chamfer=0.3"),
            "pinion",
            7,
            7,
            marks=pytest.mark.sweep,
        ),
    ],
)
def test_a_solid_with_chamfers(gears: Any, name: str, toe: int, heel: int, tmp_path: Path) -> None:
    made: gm.Gears = gears()
    cad, member = made.cad(name), made.members[name]
    faces, figures, teeth = cad.made.faces, cad.figures[name], member.tooth.teeth
    counts = Counter(face.region for face in faces)
    assert (counts["edge_toe"], counts["edge_heel"]) == (toe * teeth, heel * teeth)
    assert figures["max_deviation_um"] <= 0.1
    volume = exact_volume(member)
    assert figures["volume_mm3"] == pytest.approx(volume, rel=1e-7)
    # 3e-7 is the error of its quadrature on a fillet
    assert read(cad.save(tmp_path / "gear.step")) == ([pytest.approx(volume, rel=1e-6)], len(faces))
    solid = made.solid(name, "5um")
    assert solid.figures["volume_mm3"] == pytest.approx(volume, abs=0.005 * solid.to_trimesh().area)


@pytest.mark.parametrize(
    ("keys", "splines", "counts"),
    [
        # all but fillets and their chamfers are planes; half of the first root has one of its own
        ({"end_chamfer": 0.4, "length": 30}, 3 * 6, (19, 19)),
        # of roundings every face, at the toe alone
        ({"end_rounding_toe": 0.3, "tip_chamfer": 0.2}, 6 + 8 * 3 + 1, (25, 0)),
    ],
)
@pytest.mark.sweep_cases("keys1-31-counts1")
def test_a_rack_with_broken_end_edges(
    keys: dict[str, float], splines: int, counts: tuple[int, int], tmp_path: Path
) -> None:
    """Planes where they are, along the half roots to the ends of the bar."""
    made = built({"kind": "rack", "module": 2, "helix_angle": 15, "rack": {"teeth": 3, "face_width": 10, **keys}})
    cad, member = made.cad("rack"), made.members["rack"]
    faces, figures = cad.made.faces, cad.figures["rack"]
    regions = Counter(face.region for face in faces)
    assert (regions["edge_toe"], regions["edge_heel"]) == counts
    file = cad.save(tmp_path / "rack.step")
    assert file.read_text().count("B_SPLINE_SURFACE_WITH_KNOTS") == splines
    volume = exact_volume(member)
    assert figures["volume_mm3"] == pytest.approx(volume, rel=1e-7)
    assert read(file) == ([pytest.approx(volume, rel=1e-7)], len(faces))
    solid = made.solid("rack", "5um")
    assert solid.figures["volume_mm3"] == pytest.approx(volume, abs=0.005 * solid.to_trimesh().area)
