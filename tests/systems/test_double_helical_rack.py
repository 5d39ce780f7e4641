"""Double helical racks: solids, moments and CAD against straight helical racks; the mesh with a pinion of two halves."""

from __future__ import annotations

import math
from typing import Any

import manifold3d
import numpy as np
import pytest
from oracles.built import built

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.cad.brep import exact_volume
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.blank.moments import member_moments
from gearmesh.teeth.turned_blank import blank_of

TEETH: dict[str, Any] = {"kind": "rack", "module": 1, "helix_angle": 30}
PINION = {"teeth": 30, "face_width": 20, "bore": 4}
#: chamfers, a bar longer than its teeth, and bolts
BAR: dict[str, Any] = {"teeth": 5, "length": 25, "height": 9, "end_chamfer": 0.2, "bolts": {"count": 2, "diameter": 2}}


def bar(gap: float, **keys: Any) -> gm.Gears:
    """Return a double helical rack with halves 9 mm wide."""
    keys = {"teeth": 5, **keys, "face_width": 18 + gap}
    return built({**TEETH, "arrangement": "double_helical", "gap": gap, "rack": keys})


def body(mesh: TriangleMesh) -> manifold3d.Manifold:
    return manifold3d.Manifold(
        manifold3d.Mesh64(np.ascontiguousarray(mesh.vertices), np.ascontiguousarray(mesh.triangles, dtype=np.uint64))
    )


@pytest.mark.parametrize("gap", [0.0, 2.0])
@pytest.mark.parametrize("keys", [{}, BAR], ids=["plain", "bolts"])
@pytest.mark.sweep_cases("bolts-0.0", "bolts-2.0")
def test_the_whole_is_two_helical_racks_and_the_gap(gap: float, keys: dict[str, Any]) -> None:
    gears = bar(gap, **keys)
    rack, solid = gears.members["rack"], gears.solid("rack", 0.01)
    assert solid.figures["watertight"]
    assert solid.figures["max_deviation_um"] <= 10.0
    # a mirror image of itself
    vertices = solid.mesh.vertices
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    image = vertices * [1.0, 1.0, -1.0] + [0.0, 0.0, low + high]
    assert {*map(tuple, image.round(7) + 0.0)} == {*map(tuple, vertices.round(7) + 0.0)}
    # the second half is a rack of the other hand: its right flanks lean the other way
    right = solid.mesh.regions == solid.mesh.region_names.index("flank_right")
    below = vertices[solid.mesh.triangles].mean(axis=1)[:, 2] < 0.5 * (low + high)
    leaning = solid.mesh.normals[right, 2] * np.where(below[right], 1.0, -1.0)
    assert leaning[0] != 0.0
    assert np.allclose(leaning, leaning[0])
    # volume of two helical racks 9 mm wide, chamfered at their free ends, and of the bar in the gap
    half = {**keys, "face_width": 9, "bolts": None, "end_chamfer": None}
    if keys:
        half |= {"end_chamfer_toe": 0.2, **({"end_chamfer_heel": 0.2} if gap else {})}
    half = {key: value for key, value in {"teeth": 5, **half}.items() if value is not None}
    of_half = exact_volume(built({**TEETH, "rack": half}).members["rack"])
    floor, length = keys.get("height", 5.25) - 2.5, keys.get("length", 5 * math.pi / math.cos(math.radians(30)))
    holes = 2 * math.pi * (18 + gap) if keys else 0.0
    whole = 2.0 * of_half + gap * floor * length - holes
    moments = member_moments(rack)
    assert exact_volume(rack) == pytest.approx(whole, rel=1e-9)
    assert moments.volume == pytest.approx(whole, rel=1e-9)
    mesh = solid.to_trimesh()
    assert mesh.volume == pytest.approx(whole, abs=0.01 * mesh.area)
    assert moments.first / moments.volume == pytest.approx(mesh.center_mass, abs=5e-3)


@pytest.mark.parametrize(
    ("gap", "keys"),
    [
        (0.0, {"teeth": 2}),
        (2.0, {**BAR, "teeth": 2}),
        (0.0, {"teeth": 2, "end_chamfer": 0.2, "length": 10}),
        (2.0, {"teeth": 2, "tip_rounding": 0.1}),
    ],
    ids=["planes", "bolts", "chamfers", "roundings"],
)
@pytest.mark.sweep_cases("roundings", "bolts")
def test_cad_has_the_exact_volume_and_every_face_once(gap: float, keys: dict[str, Any]) -> None:
    gears = bar(gap, **keys)
    cad, rack = gears.cad("rack"), gears.members["rack"]
    # a chamfer consists of several faces of one name
    names = [face.name for face in cad.made.faces if not face.region.startswith("edge")]
    assert len(names) == len(set(names))
    assert {"flank_right_1", "flank_right_1_mirrored", "end_1", "end_2_mirrored", "back"} <= set(names)
    assert ("gap" in names) == (gap > 0.0)
    assert cad.figures["rack"]["volume_mm3"] == pytest.approx(exact_volume(rack), rel=1e-7)
    # its section: teeth of the tooth trace on both sides of the middle, and the floor in the gap
    low, high = rack.plain_body.ends
    first, second = (gears.section("rack", z).area for z in (low + 2.0, high - 2.0))
    assert first == pytest.approx(second, rel=1e-9)
    if gap:
        floor = gears.section("rack", 0.5 * (low + high)).area
        assert floor < first


@pytest.mark.parametrize("gap", [0.0, 2.0])
def test_blank_holds_the_bar(gap: float) -> None:
    blank = blank_of(bar(gap).members["rack"])
    length = 5 * math.pi / math.cos(math.radians(30))
    assert blank.volume() == pytest.approx(length * (18 * 5.25 + gap * 2.75), rel=1e-12)
    mesh = bar(gap).solid("rack", 0.01, blank=True)
    assert mesh.figures["watertight"]
    assert mesh.figures["volume_mm3"] == pytest.approx(blank.volume(), rel=1e-9)


@pytest.mark.sweep
def test_pinion_and_rack_of_unequal_widths_mesh_in_both_halves() -> None:
    keys = {**TEETH, "arrangement": "double_helical", "backlash": 0.1, "pinion": PINION}
    design = {**keys, "gap": 2, "rack": {"teeth": 6, "face_width": 24}}
    gears = built(design)
    assert gears.sheet().plain_tables["Pair"]["s_1"][-1] == pytest.approx(108.828, abs=5e-4)
    pair = gears.train.pair(0)
    planes = [m.mount.base.translation[2] + 0.5 * sum(m.plain_body.ends) for m in gears.members.values()]
    assert planes[0] == pytest.approx(planes[1], abs=1e-12)
    # contact of one half is contact of a helical pair
    half = built(
        {**TEETH, "backlash": 0.1, "pinion": {**PINION, "face_width": 9}, "rack": {"teeth": 6, "face_width": 11}}
    )
    ours, theirs = (g.contact([0.0, 5.0]) for g in (gears, half))
    for key in ("contact_ratio", "backlash_normal_min_mm", "te_peak_to_peak_arcsec"):
        assert ours.summary[key] == pytest.approx(theirs.summary[key], abs=1e-7)
    # no overlap at any rotation with the backlash on both sides, and overlap beyond it
    meshes = [part.mesh for part in gears.solids(0.01).parts.values()]
    pinion, rack = map(body, meshes)
    free = 0.5 * gears.sheet().plain_tables["Backlash"]["j_wt"][-1]
    for turn in np.linspace(0.0, pair.pitch, 3, endpoint=False).tolist():
        turned = pinion.rotate((0.0, 0.0, -math.degrees(turn)))
        moved = rack.translate((0.0, -turn * 15.0 / math.cos(math.radians(30)) - free, 0.0))
        assert (turned ^ moved).volume() == 0.0
        beyond = moved.translate((0.0, 1.5 * free, 0.0)), moved.translate((0.0, -1.5 * free, 0.0))
        assert min((turned ^ there).volume() for there in beyond) > 1e-4
    forces = gears.sheet(torque=20).plain_tables["Forces for 20 Nm on the pinion, its right flanks driving"]
    assert forces["F_wa"][-2:] == [0.0, 0.0]


@pytest.mark.parametrize(
    ("keys", "key"),
    [
        ({"gap": 20}, "gap"),
        ({"helix_angle": 0}, "helix_angle"),
        ({"rack": {"teeth": 5, "face_width": 20, "gap_height": 1}}, "rack.gap_height"),
        ({"gap": 2, "rack": {"teeth": 5, "face_width": 20, "gap_height": 4}}, "rack.gap_height"),
        ({"assembly": {"dz": 0.1}}, "assembly.dz"),
        ({"gap": 1, "pinion": {**PINION, "gap_diameter": 34}}, "pinion.gap_diameter"),
    ],
)
def test_refusals(keys: dict[str, Any], key: str) -> None:
    design = {**TEETH, "arrangement": "double_helical", "pinion": PINION, "rack": {"teeth": 5, "face_width": 20}}
    with pytest.raises(DesignError) as refusal:
        gm.build(gm.parse({**design, **keys}))
    assert refusal.value.key == key
