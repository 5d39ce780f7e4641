"""One cylindrical gear without a mating gear: the same gear as in a pair, by its own keys alone."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from oracles.command_line import refused, run
from scipy.spatial import cKDTree

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.reports.report import report_page
from gearmesh.systems.cylindrical.geometry import measures
from gearmesh.systems.cylindrical.single.build import single_gear

#: one of each kind: spur, helical and left, internal helical, double helical with a gap, shaped external, hob with protuberance
GEARS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "spur": ({"module": 1}, {"teeth": 30, "face_width": 10}),
    "helical": (
        {"module": 2.5, "helix_angle": 17, "hand": "left", "profile": "D", "pressure_angle": 17.5},
        {"teeth": 23, "face_width": 21, "profile_shift": 0.3, "tip_chamfer": 0.2, "bore": 20, "keyway": {}},
    ),
    "internal": (
        {"module": 1.5, "helix_angle": 10},
        {
            "teeth": 62,
            "internal": True,
            "face_width": 12,
            "thickness_allowance": {"upper": -0.03, "lower": -0.07},
            "addendum": 0.8,
        },
    ),
    "double_helical": (
        {"module": 2, "helix_angle": 25, "arrangement": "double_helical", "gap": 6},
        {"teeth": 27, "face_width": 46, "web": {"thickness": 20}},
    ),
    "shaped": ({"module": 3}, {"teeth": 19, "face_width": 9, "shaper": {"teeth": 25}}),
}


def alone_and_in_pair(name: str, table: str) -> tuple[gm.Gears, gm.Gears]:
    """A gear by itself, and pinned in a pair with another one whose shift is its own with the other sign."""
    keys, own = GEARS[name]
    alone = gm.build(gm.parse({"kind": "cylindrical", **keys, table: own}))
    spec = getattr(alone.design, table)
    defaults = ("profile_shift", "addendum", "tip_alteration", "tool_tip_radius")
    pinned = {**own, **{key: getattr(spec, key) for key in defaults}}
    # the other member's hand is that of the pinion where one of both is internal
    turned = {"left": "right", "right": "left"}
    hand = keys.get("hand", "right")
    if table == "gear" and not spec.internal:
        keys = {**keys, "hand": turned[hand]}
    other = {
        "teeth": 24 if spec.internal else 40,
        "face_width": own["face_width"],
        "profile_shift": -spec.profile_shift,
        "thickness_allowance": {"upper": 0, "lower": 0},
    }
    if "thickness_allowance" not in own:
        pinned["thickness_allowance"] = {"upper": 0, "lower": 0}
    mating = "gear" if table == "pinion" else "pinion"
    return alone, gm.build(gm.parse({"kind": "cylindrical", **keys, table: pinned, mating: other}))


@pytest.mark.sweep_cases("helical-gear", "helical-pinion", "internal-gear", "shaped-pinion", "spur-gear")
@pytest.mark.parametrize(
    ("name", "table"),
    [
        ("spur", "gear"),
        ("helical", "pinion"),
        ("helical", "gear"),
        ("internal", "gear"),
        ("double_helical", "gear"),
        ("shaped", "pinion"),
    ],
)
def test_is_the_same_gear_as_in_a_pair(name: str, table: str) -> None:
    """Second route: the pair's own defaults, sheet and mesh, bit for bit."""
    alone, pair = alone_and_in_pair(name, table)
    one, other = (gears.solid(table, 0.05).mesh for gears in (alone, pair))
    assert np.array_equal(one.vertices, other.vertices)
    assert np.array_equal(one.triangles, other.triangles)
    column = ("pinion", "gear").index(table)
    theirs = pair.sheet().plain_tables
    compared = 0
    for title, rows in alone.sheet().plain_tables.items():
        # of the pair the tool's rounding is stated; where it is left open, a tool that is fed has one of its own
        if title in ("Derived keys (lengths in mm)", "Gear", "As cut by feeding the tool for the allowance"):
            continue
        for symbol, (unit, value) in rows.items():
            assert theirs[title][symbol][0] == unit
            assert theirs[title][symbol][1 + column] == value, (title, symbol)
            compared += 1
    assert compared > 40


@pytest.mark.sweep
@pytest.mark.sweep_cases("helical-gear-2")
@pytest.mark.parametrize(("name", "table", "order"), [("helical", "gear", 2), ("internal", "gear", 1)])
def test_finite_elements_are_those_of_the_member_of_a_pair(name: str, table: str, order: int) -> None:
    """Second route: the pair's model with even lines, moved back from where contact analysis places it."""
    compare_models(*alone_and_in_pair(name, table), table, {"fe.order": order})


def test_finite_elements_of_a_rack_are_those_beside_a_pinion() -> None:
    # the pair's hand is that of the pinion
    keys = {"kind": "rack", "module": 2, "helix_angle": 12, "rack": {"teeth": 5, "face_width": 12}}
    alone = gm.build(gm.parse({**keys, "hand": "left"}))
    compare_models(
        alone, gm.build(gm.parse({**keys, "pinion": {"teeth": 20, "face_width": 12}})), "rack", {"fe.teeth": 0}
    )


def compare_models(alone: gm.Gears, pair: gm.Gears, member: str, keys: dict[str, Any]) -> None:
    """The same elements, sets, material and support, and the same nodes to 1e-12 mm."""
    keys = {"fe.flank": 5, "fe.fillet": 4, "fe.thickness": 2, "fe.face": 6, **keys}
    own = gm.build(alone.design.with_values(keys)).finite_elements()
    other = gm.build(pair.design.with_values({**keys, "fe.spacing": "even"})).finite_elements(members=[member])
    at, mesh, theirs = other._built.at, own.mesh, other.mesh
    placed = at.frame @ pair.members[member].mount.at(at.turns[other.pair.index(member)])
    np.testing.assert_allclose(mesh.nodes, placed.inverse.point(theirs.nodes), rtol=0.0, atol=1e-12)
    assert np.array_equal(mesh.elements, theirs.elements)
    for kind in ("node_sets", "face_sets", "element_sets"):
        sets, wanted = getattr(mesh, kind), getattr(theirs, kind)
        assert list(sets) == list(wanted)
        assert all(np.array_equal(sets[key], wanted[key]) for key in sets)
    assert own._model.supports == other._model.supports
    assert own._model.materials == other._model.materials
    assert not own._model.forces


def test_finite_elements_fill_the_solid() -> None:
    """All teeth down to the bore: the volume in closed form, but for the chords of the curves, 5e-5 of it here."""
    gear = {"teeth": 30, "face_width": 10, "bore": 12}
    coarse = {"teeth": 0, "rim": 7.75, "flank": 4, "fillet": 4, "thickness": 2, "rim_layers": 2, "face": 2}
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 1, "gear": gear, "fe": coarse}))
    model = gears.finite_elements()
    assert "gear_bore" in model.mesh.node_sets
    assert model.figures["volume_mm3"] == pytest.approx(gears.members["gear"].plain_volume(), rel=1e-4)


def test_fe_command_of_one_gear(tmp_path: Path) -> None:
    """Every format; what needs a mating gear is refused by its option, before anything is written."""
    mapdl_archive = pytest.importorskip("mapdl_archive")
    design = tmp_path / "one.toml"
    design.write_text('kind = "cylindrical"\nmodule = 1\n[gear]\nteeth = 30\nface_width = 10\n')
    coarse = ["--set", "fe.flank=4", "--set", "fe.fillet=3", "--set", "fe.face=2", "--teeth", "1"]
    files = [tmp_path / f"one.{suffix}" for suffix in ("inp", "msh", "vtu", "cdb")]
    for file in files:
        status, out, _ = run("fe", design, "-o", file, *coarse, "--json", "-")
        assert status == 0
    document = json.loads(out)
    points = [len(meshio.read(file).points) for file in files[:3]]
    assert [*points, mapdl_archive.Archive(files[3]).n_node] == [document["model"]["nodes"]] * 4
    assert set(document["model"]) == {"elements", "element_order", "nodes", "min_scaled_jacobian", "volume_mm3"}
    assert document["design"]["fe"]["spacing"] == "even"
    deck = (tmp_path / "one.inp").read_text()
    assert "*BOUNDARY\ngear_held, 1, 1, 0\n" in deck
    assert not any(word in deck for word in ("*CLOAD", "*CONTACT PAIR", "*RIGID BODY"))
    why = "needs a mating gear: add the table [pinion]"
    for option, value, shown in (
        ("--phi1", "5", "5"),
        ("--rotation", "0.1", "0.1"),
        ("--friction", "0.1", "0.1"),
        ("--pair", "pinion-gear", "pinion-gear"),
        ("--solve", None, "true"),
    ):
        given = [option] if value is None else [option, value]
        assert refused("fe", design, "-o", tmp_path / "no.inp", *given) == f"{option} = {shown}: {why}"
    line = "fe.torque: needs a mating gear: give both tables"
    assert refused("fe", design, "-o", tmp_path / "no.inp", "--torque", "50") == line
    assert not (tmp_path / "no.inp").exists()


def test_measures_are_the_published_ones() -> None:
    """Spans: 30 teeth of module 1 as in tables of base tangent lengths; m 3, z 24, x 0.4 as in Elements of Metric Gear Technology
    (SDP/SI), table 10-12. Over pins of 1.728 modules: Machinery's Handbook, 20 deg, 30 teeth."""
    for keys, teeth, span in (
        ({"module": 1}, {"teeth": 30}, 10.7526),
        ({"module": 3}, {"teeth": 24, "profile_shift": 0.4}, 32.8266),
    ):
        alone = gm.build(gm.parse({"kind": "cylindrical", **keys, "gear": {"face_width": 30, **teeth}}))
        measured = alone.sheet().plain_tables["Measures of the tooth thickness"]
        assert measured["k_W"][1] == 4
        assert measured["W_k"][1] == pytest.approx(span, abs=5e-5)
    design: Any = gm.parse({"kind": "cylindrical", "module": 1, "gear": {"teeth": 30, "face_width": 10}})
    assert measures.over_pins(single_gear(design).own, 1.728) == pytest.approx(32.4102, abs=5e-5)


@pytest.mark.sweep
def test_answers_that_need_no_mating_gear() -> None:
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 1, "pinion": {"teeth": 12, "face_width": 4}}))
    assert [limits.fewest_teeth for limits in gears.limits().members.values()] == [18]
    check = gears.check(0.02)
    assert [verdict.ok for verdict in check.verdicts] == [True, True]
    assert gears.solids(0.02).parts["pinion"].measured.watertight
    again = gm.parse(gears.pin().design.resolve())
    assert np.array_equal(
        gm.build(again).solid("pinion", 0.05).mesh.vertices, gears.solid("pinion", 0.05).mesh.vertices
    )


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ({"assembly": {"dx": 1}}, "assembly: needs a mating gear: give both tables, [pinion] and [gear]"),
        ({"backlash": 0.1}, "backlash: needs a mating gear: give both tables, [pinion] and [gear]"),
        ({"contact": {"flank": "left"}}, "contact: needs a mating gear: give both tables, [pinion] and [gear]"),
        ({"gap": 1.0}, 'gap = 1 mm: needs arrangement = "double_helical"'),
        ({"gear.profile_shift": -3.0}, "gear.profile_shift = -3: allowed is at least -1.8"),
        (
            {"gear.thickness_allowance": {"upper": -2, "lower": -3}},
            "gear.thickness_allowance.upper = -2 mm: leaves no tooth; allowed is more than -1.07",
        ),
    ],
)
def test_refusals_name_the_key(keys: dict[str, Any], line: str) -> None:
    gear = {"teeth": 30, "face_width": 10, **{key[5:]: value for key, value in keys.items() if key.startswith("gear.")}}
    top = {key: value for key, value in keys.items() if not key.startswith("gear.")}
    with pytest.raises(DesignError) as refused:
        gm.build(gm.parse({"kind": "cylindrical", "module": 1, "gear": gear, **top}))
    assert str(refused.value).startswith(line)


def test_what_needs_a_mating_gear_says_so() -> None:
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 1, "gear": {"teeth": 30, "face_width": 10}}))
    line = "pinion: the gear has no mating gear, which contact, load and all figures of a mesh need: add the table \\[pinion\\]"
    for ask in (gears.contact, lambda: gears.loaded_contact(10), gears.ease_off):
        with pytest.raises(DesignError, match=f"^{line}$"):
            ask()
    with pytest.raises(
        DesignError, match=r"^view = contact: needs a mating gear: add the table \[pinion\]; allowed is pair, tool"
    ):
        gears.picture("contact")


@pytest.mark.sweep_cases("12")
@pytest.mark.parametrize("teeth", [12, 31])
def test_a_rack_is_the_same_as_with_a_pinion(teeth: int) -> None:
    """Second route: the rack of a pair, whatever the pinion; its hand is then the other one."""
    keys: dict[str, Any] = {"kind": "rack", "module": 2.5, "helix_angle": 13, "profile": "B"}
    bar = {"teeth": 12, "face_width": 18, "length": 110, "thickness_allowance": {"upper": -0.02, "lower": -0.06}}
    bar |= {"tip_chamfer": 0.3, "modifications": {"helix_crowning": 0.03}}
    pinion = {"teeth": teeth, "face_width": 18, "thickness_allowance": {"upper": 0, "lower": 0}}
    alone = gm.build(gm.parse({**keys, "hand": "left", "rack": {**bar, "tool_tip_radius": 0.3}}))
    pair = gm.build(gm.parse({**keys, "hand": "right", "rack": {**bar, "tool_tip_radius": 0.3}, "pinion": pinion}))
    one, other = (gears.solid("rack", 0.02).mesh for gears in (alone, pair))
    # of other pinions the coordinate along the bar is rounded elsewhere
    assert np.array_equal(one.vertices, other.vertices) or teeth != bar["teeth"]
    assert np.abs(one.vertices - other.vertices).max() < 1e-12
    own, theirs = (gears.sheet().plain_tables["Rack"] for gears in (alone, pair))
    assert set(theirs) - set(own) == {"c"}
    assert all(theirs[symbol] == row for symbol, row in own.items() if symbol != "V")
    with pytest.raises(DesignError, match=r"^pinion: the rack has no mating gear"):
        alone.contact()


def test_page_without_contact() -> None:
    """Drawing, limits and sheet; the view's teeth, each moved by its place, are those of the solid."""
    keys = {"kind": "rack", "module": 2, "rack": {"teeth": 9, "face_width": 12, "length": 70}}
    gears = gm.build(gm.parse(keys))
    page = report_page(gears, {}, 0.05, images=[]).html
    headings = re.findall("<h2>(.*?)</h2>", page)
    assert [each for each in headings if each != "Warnings"] == [
        "Drawing",
        "Limits",
        "Data sheet",
        "Design file",
        "Versions",
    ]
    assert page.count('<img src="data:image/svg+xml') == 1
    (stage,) = re.findall('<script type="application/json" id="stage">(.*?)</script>', page, re.DOTALL)
    data = json.loads(stage)
    assert data["pairs"] == []
    ((name, member),), (shown,) = gears.members.items(), data["members"]
    tooth = np.frombuffer(base64.b64decode(data["shapes"][0]["tooth"]["positions"]), dtype="<f4").reshape(-1, 3)
    solid = gears.solid(name, 0.05).mesh.vertices
    along = shown["travel"] * shown["pitch"] * np.array(shown["places"])
    teeth = tooth + along[:, None, None] * [0.0, 1.0, 0.0]
    assert len(along) == member.tooth.teeth
    # single precision of 35 mm
    assert cKDTree(solid).query(teeth.reshape(-1, 3))[0].max() < 1e-5
    with pytest.raises(DesignError, match=r"has no mating gear"):
        gears.report(torque=5)


@pytest.mark.sweep
def test_runs_without_contact(tmp_path: Path) -> None:
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 1, "pinion": {"teeth": 12, "face_width": 4}}))
    report = gears.run(tmp_path, 0.05)
    names = {file.name for file in report.files}
    assert (
        {"pinion.stl", "sheet.json", "limits.json", "report.html", "report.json"}
        <= names
        == {file.name for file in tmp_path.iterdir()} - {".gearmesh-run.json"}
    )
    document = json.loads((tmp_path / "report.json").read_text())
    assert "contact" not in document
    assert document["sheet"]["Members"]["z"][1] == 12
    assert report.complaints == []
    with pytest.raises(DesignError, match=r"^gear: the pinion has no mating gear"):
        gears.run(tmp_path / "loaded", torque=10)
