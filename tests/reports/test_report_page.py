"""The report page without a browser: what it shows is what the solver and the mesher say, and text from designs stays text."""

from __future__ import annotations

import base64
import html
import json
import re
import tomllib
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.places import PACKAGE, ROOT, SAMPLES

import gearmesh as gm
from gearmesh import Check, OutputError, RollTest
from gearmesh.answers.check import Verdict
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.reports.report import PagePlots, draw_plots, report_page, study_section
from gearmesh.view.report import card
from gearmesh.view.report.page import script_json
from gearmesh.view.report.staged_member import StagedMember

HOSTILE = "</script><script>alert(1)</script> <!-- {{STAGE}} & \"quoted\" 'name'"
FOLDER = PACKAGE / "view" / "report"


def floats(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype="<f4").astype(float)


class Reader(HTMLParser):
    """Tags with their attributes, and the text of elements by their tag."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: dict[str, list[str]] = {}
        self._inside: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self.texts.setdefault(tag, []).append("")
        if tag not in ("meta", "link", "img", "input"):
            self._inside.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self._inside.pop() == tag

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.texts[self._inside[-1]][-1] += data


@pytest.fixture(autouse=True)
def _few(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """Few positions, no trial of OpenGL, and no plots but in the page of the command: what is here is not about them."""
    monkeypatch.setattr("gearmesh.answers.contact.staging.SLIDER_POSITIONS", 7)
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: None)
    if "command_writes" not in request.node.name:
        monkeypatch.setattr("gearmesh.reports.report.draw_plots", lambda *_: PagePlots([("a plot", b"<svg/>")]))


def paged(sample: str, *overrides: str) -> tuple[gm.Gears, str]:
    """Gears of a sample and their page, without pictures."""
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml", overrides))
    contacts = {k: gears.contact(pair=k) for k in gears.train.different}
    return gears, report_page(gears, contacts, 0.05, images=[]).html


def stage_of(page: str) -> Any:
    found = re.search(r'<script type="application/json" id="stage">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    return json.loads(found[1])


def test_page_escapes_what_designs_say_and_asks_for_nothing() -> None:
    _, page = paged("spur", f"name={HOSTILE}")
    read = Reader(page)
    assert read.texts["title"] == read.texts["h1"] == [HOSTILE]
    assert [tag for tag, _ in read.tags].count("script") == 4
    assert HOSTILE in tomllib_name(read)
    for tag, attributes in read.tags:
        for name in ("src", "href"):
            value = attributes.get(name) or "#"
            assert value.startswith(("#", "data:")), (tag, value)
        assert not any(name.startswith("on") for name in attributes)
    assert json.loads(script_json({"name": HOSTILE})) == {"name": HOSTILE}
    assert not set("<>&") & set(script_json({"name": HOSTILE}))


def tomllib_name(read: Reader) -> str:
    """The name in the design file of a page, read as TOML."""
    (text,) = [text for text in read.texts["pre"] if "kind" in text]
    return str(tomllib.loads(text)["name"])


@pytest.mark.sweep
@pytest.mark.sweep_cases("planetary", "spiral_bevel_abdullah_straight")
@pytest.mark.parametrize("sample", ["spiral_bevel_abdullah_straight", "planetary", "rack"])
def test_page_rolls_the_gears_as_the_solver_does(sample: str) -> None:
    """Points of contact told in the own frames of both members meet, when these are moved as the page moves them."""
    gears, page = paged(sample)
    stage = stage_of(page)
    assert [member["name"] for member in stage["members"]] == list(gears.members)
    assert len(stage["pairs"]) == len(gears.train.different)
    for pair in stage["pairs"]:
        fixed = floats(pair["point"]).reshape(-1, 3)
        assert len(fixed) == 7
        for k, flank in zip(pair["members"], pair["flanks"], strict=True):
            member = stage["members"][k]
            own = floats(flank["contact"]).reshape(-1, 3) + np.array([*member["eccentricity"], 0.0])
            angle = member["sign"] * (floats(pair["turns"][k]) - member["zero"])
            if member["travel"] is None:
                c, s = np.cos(angle), np.sin(angle)
                x, y, z = own.T
                moved = np.stack((c * x - s * y, s * x + c * y, z), axis=-1)
            else:
                moved = own + angle[:, None] * np.array([0.0, member["travel"], 0.0])
            placed = moved @ np.array(member["rotation"]).T + member["translation"]
            assert np.abs(placed - fixed).max() < 2e-4  # mm: single precision at some 100 mm


@pytest.mark.sweep
def test_page_s_teeth_and_bodies_are_the_whole_solids() -> None:
    """Volume enclosed by the teeth, drawn as often as there are, and what is under them."""
    for sample in ("double_helical", "rack", "spur_relieved"):
        for member in gm.build(gm.load(SAMPLES / f"{sample}.toml")).members.values():
            staged = StagedMember.of(member, 0.05)
            places = member.tooth.joint.places(member.tooth.teeth)
            moves = member.tooth.joint.to((places - places[0]) * member.tooth.pitch_angle)
            parts = [staged.rest, *(_moved(staged.tooth, moves, k) for k in range(len(places)))]
            assert sum(part.volume() for part in parts) == pytest.approx(staged.whole.volume(), rel=1e-9), member.name
            assert len(staged.tooth.triangles) * len(places) + len(staged.rest.triangles) == len(staged.whole.triangles)


def _moved(mesh: TriangleMesh, moves: Any, k: int) -> TriangleMesh:
    translation = np.broadcast_to(moves.translation, (len(moves.rotation), 3))[k]
    return mesh.move(type(moves)(moves.rotation[k], translation))


@pytest.mark.parametrize(
    ("value", "text"),
    [(9.159997e-11, "0.0000000000916"), (0.09811, "0.0981"), (1.2632, "1.26"), (10.0, "10"), (99.96, "100"),
     (1265.7, "1266"), (-0.03251, "\u22120.0325"), (0.0, "0")],
)  # fmt: skip
def test_card_writes_three_digits_without_exponent(value: float, text: str) -> None:
    assert card.number(value) == text


@pytest.mark.sweep
def test_card_reads_as_the_solver_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """Words and units on the card of gears that fit and of gears that jam. The warning that comes first says what jams."""
    # by how much to move the members apart is not what is here
    monkeypatch.setattr("gearmesh.answers.contact.fit.freeing_shift", lambda *_: None)
    assert card.error(9.159997e-11, "arcsec") == "below 0.001\u00a0arcsec"
    assert card.span(-0.0325, 0.1) == "\u22120.0325 to 0.1\u00a0mm"
    assert card.span(-3e-15, 1e-15) == card.length(0.0) == "0\u00a0\u00b5m"
    assert card.span(0.0, 0.1) == "0 to 0.1\u00a0mm"
    for closer, backlash, note in (
        (0.0, "60\u00a0\u00b5m", "at least "),
        (-0.1, "\u22128.12\u00a0\u00b5m", "negative"),
    ):
        gears = gm.build(gm.load(SAMPLES / "spur.toml", [f"assembly.dx={closer}"]))
        contact = gears.contact()
        shown = {figure.label: figure for figure in card.mesh_card(contact).figures}
        assert len(shown) == 8
        assert list(shown)[:4] == [
            "Contact ratio",
            "Mesh transmission error",
            "Harmonics 1, 2, 3 of it",
            "Normal backlash",
        ]
        assert float(shown["Contact ratio"].value) == pytest.approx(contact.summary["contact_ratio"], abs=5e-3)
        assert shown["Contact ratio"].note == "1 or 2 tooth pairs in contact"
        assert shown["Normal backlash"].value.startswith(backlash)
        assert shown["Normal backlash"].note.startswith(note)
        page = report_page(gears, {0: contact}, 0.05, images=[]).html
        (section,) = re.findall(r'<section id="card".*?</section>', page, re.DOTALL)
        assert page.index(section) < page.index('<section id="view"')
        assert html.escape(shown["Tip clearance"].value) in section
        assert not re.search(r"\de[-+]\d|_mm|_deg|_arcsec", section)
        jammed = [line for line in contact.warnings if "jammed" in line]
        assert (html.escape(jammed[0]) if jammed else "No warnings.") in section
        assert bool(jammed) == (closer < 0.0)


def test_command_ends_as_the_check_on_its_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It ended with 0 where the check failed."""
    gears, target = gm.build(gm.load(SAMPLES / "spur.toml", ["contact.phi1.count=3"])), tmp_path / "a.html"
    contact, solids = gears.contact(cycle=False), {"pinion": gears.solid("pinion", 0.1)}
    for ok, status in ((True, 0), (False, 3)):
        rolled = RollTest([], (), (Verdict("roll: te_difference_arcsec", 2.0, 1.0, ok),))
        page = report_page(gears, {0: contact}, 0.1, Check(gears.design, solids, rolled), images=[])
        monkeypatch.setattr(gm.Gears, "report", lambda *_, page=page, **__: page)
        assert run("report", SAMPLES / "spur.toml", "-o", target)[0] == status
        assert ("te_difference_arcsec = 2: allowed is 1" in target.read_text(encoding="utf-8")) is not ok


def test_view_holds_whole_gears_in_perspective() -> None:
    """The near end of a long hub is larger than its middle, and was cut off below."""
    gears, page = paged("spline", "hub.face_width=60", "shaft.face_width=60", "contact.phi1.count=3")
    camera = stage_of(page)["camera"]
    focus, back, up = (np.array(camera[key], dtype=float) for key in ("focus", "back", "up"))
    back, slope = back / np.linalg.norm(back), np.tan(np.radians(10.0))
    right = np.cross(up, back) / np.linalg.norm(np.cross(up, back))
    distance = 0.9 * camera["height"] / 2.0 / slope
    for name, member in gears.members.items():
        away = member.mount.at(0.0).point(gears.solid(name, 0.05).mesh.vertices) - focus
        assert (np.abs(away @ np.cross(back, right)) < 0.99 * slope * (distance - away @ back)).all()
        assert (np.abs(away @ right) < 0.99 * 4.0 / 3.0 * slope * (distance - away @ back)).all()


def test_page_with_given_pictures_asks_for_no_opengl(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page without pictures says why it has none."""
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "no OpenGL today")
    gears, grey = gm.gear(17, module=2.0, face=5.0), np.full((60, 80, 3), 128, dtype=np.uint8)
    given, bare = (report_page(gears, {}, 0.1, images=images) for images in ([("gear", grey)], []))
    assert (given.skipped, bare.skipped) == (None, "no OpenGL today")
    assert "no OpenGL today" not in given.html


@pytest.mark.quick
def test_vendored_script_is_what_its_builder_makes() -> None:
    script = (FOLDER / "three.min.js").read_text(encoding="ascii")
    builder = (ROOT / "scripts" / "build_three.py").read_text(encoding="utf-8")
    (version,) = re.findall(r'"three": "([\d.]+)"', builder)
    assert re.match(rf"/\* three\.js {re.escape(version)}, .*MIT", script)
    assert "@license" in script
    assert "</script" not in script
    assert "<!--" not in script
    assert "Permission is hereby granted" in (FOLDER / "three.LICENSE.txt").read_text(encoding="utf-8")
    used = set(re.findall(r"\bTHREE\.(\w+)", (FOLDER / "scene.js").read_text(encoding="utf-8")))
    names = set(re.findall(r'^    "(\w+)",$', builder, re.MULTILINE))
    assert used == names | {"TrackballControls"}


@pytest.mark.sweep
def test_command_writes_a_page_with_the_design_as_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "no pictures here")
    sample = SAMPLES / "spur.toml"
    status, out, err = run("report", sample, "-o", "a.html", "--tol", "50um")
    assert (status, out) == (0, "")
    assert "no pictures here" in err
    page = (tmp_path / "a.html").read_text(encoding="utf-8")
    assert sample.read_text(encoding="utf-8") in Reader(page).texts["pre"]
    assert "no pictures here" in "".join(Reader(page).texts["li"])
    assert refused("report", sample, "-o", "a.htm") == "cannot write a.htm: its suffix must be .html"
    assert [path.name for path in tmp_path.iterdir()] == ["a.html"]


@pytest.mark.sweep
def test_page_holds_finished_studies(tmp_path: Path) -> None:
    """The figures that the study itself tells, as a table and pictures."""
    gears = gm.build(gm.load(SAMPLES / "spiral_bevel_abdullah_straight.toml"))
    study = gears.study(
        {"assembly.dV": [-0.02, 0.0, 0.01, 0.02]}, record="path", limits=["contact_ratio_estimate>1"], workers=1
    )
    study.save(tmp_path / "study.json")
    (tmp_path / "responses.png").write_bytes(b"\x89PNG of it")
    read = Reader(study_section(tmp_path).body)
    told = [row[0] for table in study.listings for row in table.rows]
    shown = read.texts["td"] + read.texts.get("th", [])
    assert {"contact_ratio_estimate", "assembly.dV"} <= set(told) <= set(shown)
    (image,) = [attributes for tag, attributes in read.tags if tag == "img"]
    assert base64.b64decode(str(image["src"]).partition(",")[2]) == b"\x89PNG of it"
    with pytest.raises(OutputError, match=r"^study = .*none: holds no finished study"):
        study_section(tmp_path / "none")


@pytest.mark.parametrize("eccentricity", [0.02, 0.0])
@pytest.mark.sweep_cases("0.02")
def test_plots_have_eccentric_members_over_whole_turns(eccentricity: float) -> None:
    few_teeth = ("pinion.teeth=16", "gear.teeth=16", "assembly.center_distance=48")
    gears = gm.build(gm.load(SAMPLES / "spur.toml", [*few_teeth, f"assembly.pinion_eccentricity={eccentricity}"]))
    drawn = dict(draw_plots(gears, {0: gears.contact(cycle=False)}).contact)
    caption = "Transmission error over whole turns"
    assert (caption in drawn) == (eccentricity > 0.0)
    assert drawn.get(caption, b"\x89PNG").startswith(b"\x89PNG")
