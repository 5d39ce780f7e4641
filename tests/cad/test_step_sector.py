"""Sectors as STEP: one valid solid with named faces, of the exact volume, its cut faces alike, as another program reads it."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from oracles.built import built
from oracles.cad_readers import gmsh_model, needs_step

from gearmesh import DesignError, Rigid
from gearmesh.cad.brep import exact_volume
from gearmesh.kinds import Region

pytestmark = needs_step
TEETH, PITCHES = 13, 3
KEYS = {"kind": "cylindrical", "module": 2, "helix_angle": 20, "gear": {"teeth": TEETH, "face_width": 12, "bore": 8}}


def face_properties(path: Path) -> tuple[list[float], list[tuple[float, np.ndarray]]]:
    """Volumes of a file's solids, and area and centre of every face, by gmsh."""
    with gmsh_model(path) as model:
        occ = model.occ
        volumes = [occ.getMass(*solid) for solid in model.getEntities(3)]
        return volumes, [(occ.getMass(*face), np.array(occ.getCenterOfMass(*face))) for face in model.getEntities(2)]


@pytest.mark.sweep
def test_gmsh_reads_a_sector_with_congruent_cut_faces(tmp_path: Path) -> None:
    gears = built(KEYS)
    cad = gears.cad("gear", sector=PITCHES)
    assert cad.figures["gear"]["pitches"] == PITCHES
    part = cad.made
    counts = Counter(face.region for face in part.faces)
    assert (counts[Region.LAND], counts[Region.FLANK_LEFT], counts[Region.ROOT]) == (PITCHES, PITCHES, PITCHES + 1)
    assert {"cut_right", "cut_left", "face_toe", "bore", "land_1"} <= {face.name for face in part.faces}
    volumes, faces = face_properties(cad.save(tmp_path / "sector.step"))
    assert volumes == [pytest.approx(PITCHES / TEETH * exact_volume(gears.members["gear"]), rel=1e-6)]
    assert len(faces) == len(part.faces)
    # a face that is another one turned by the pitches: the first cut face
    turn = Rigid.about_z(2.0 * np.pi * PITCHES / TEETH)
    alike = [
        (area, centre)
        for area, centre in faces
        for other, place in faces
        if abs(area - other) < 1e-6 * area and np.linalg.norm(turn.point(centre) - place) < 1e-5
    ]
    ((area, centre),) = alike
    # from bore to root over the face width, askew
    assert area > 12.0 * 5.0
    middle = np.arctan2(centre[1], centre[0])
    assert middle == pytest.approx(-np.pi / TEETH, abs=0.01 * np.pi)


def test_all_members_have_no_sector() -> None:
    with pytest.raises(DesignError, match="sector = 3: must be left out for several members"):
        built(KEYS).cad(sector=3)
