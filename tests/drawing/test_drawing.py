"""Workshop drawings: what stands on them, where, and that it is the gear's."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import WorkshopDrawing
from gearmesh.cad.section import member_section
from gearmesh.drawing.canvas import HATCH_SPACING_MM, Box, Canvas, Pen
from gearmesh.drawing.facts import number
from gearmesh.drawing.gear_data import drawn_symbol, facts_of
from gearmesh.drawing.outline import bar_faces, outline_of
from gearmesh.drawing.page import TABLE_LETTER_HEIGHT_MM, formula
from gearmesh.drawing.paper import DRAWING_SCALES, INTERMEDIATE_SCALES, scale_name

#: sample, changes, member, texts that must be there: key dimensions, hole pattern, tolerances, limits of the span
KEYED = [
    *(
        "gear.bore=40",
        "gear.keyway={width=12, depth=3.3}",
        "gear.hub={diameter=64, length=15}",
        "gear.web={thickness=10}",
    ),
    *(
        "gear.holes={count=6}",
        'gear.thickness_allowance="cd25"',
        'gear.tip_diameter_tolerance="h8"',
        "accuracy_class=7",
    ),
]
CASES = {
    "keyed": ("helical", KEYED, "gear", {"12", "43.3", "15", "\u230040", "10", "7"}),
    "hexagon": ("spur", ["gear.hex_bore={across_flats=20}"], "gear", {"20 A/F"}),
    "D bore": ("spur", ["gear.bore=20", "gear.d_bore={height=17.5}"], "gear", {"\u230020", "17.5"}),
    "ring": ("internal", [], "gear", {"\u2300142.139", "(\u2300144.939)", "\u2300162.739", "20"}),
    "double helical": ("double_helical", [], "pinion", {"30", "72", "\u2300112.196"}),
    "spokes": (
        "helical_hub",
        [],
        "gear",
        {"6 spokes, 22 wide, \u2300124.958 to \u2300196.625, R 3.583", "6 \u00d7 \u23007 on \u2300105"},
    ),
    "rack": ("rack", [], "rack", {"200", "24", "22"}),
    "worm": ("worm_drive", [], "worm", {"worm, 2 threads"}),
    "single": ("worm_drive_dual_lead", [], "worm", {"worm, 1 thread"}),
    "bevel": ("zerol", [], "pinion", {"pinion, 15 teeth", "(\u230060)", "\u230070.527", "26.5651\N{DEGREE SIGN}"}),
}


def drawing(case: str) -> WorkshopDrawing:
    sample, changes, member, _ = CASES[case]
    return gm.build(gm.load(SAMPLES / f"{sample}.toml", changes)).drawing(member)


@pytest.mark.sweep_cases("keyed", "ring", "single", "bevel", "double helical", "rack", "worm", "hexagon", "spokes")
@pytest.mark.parametrize("case", CASES)
def test_texts_say_what_the_gear_is_and_none_lies_on_another(case: str) -> None:
    made = drawing(case)
    assert set(made.texts) >= CASES[case][-1]
    left, low, right, high = made._page.paper.frame
    boxes = [letters.box for letters in made._page.canvas.letters if letters.text]
    assert len(boxes) > 40
    for box in boxes:
        assert left <= box.left < box.right <= right
        assert low <= box.low < box.high <= high
    assert not [pair for pair in itertools.combinations(boxes, 2) if pair[0].overlaps(pair[1], 0.0)]
    for stroke in made._page.canvas.strokes:
        assert np.all(stroke.points >= np.array([left, low]) - 1e-9)
        assert np.all(stroke.points <= np.array([right, high]) + 1e-9)
    assert made._page.scale in (*DRAWING_SCALES, *INTERMEDIATE_SCALES)


def test_lines_are_to_scale_and_hatching_is_where_material_is() -> None:
    made = drawing("double helical")
    scale = made._page.scale
    # end view: all teeth, as far from its centre as the tip; 23 of them
    outline = [
        stroke.points for stroke in made._page.canvas.strokes if stroke.pen is Pen.OUTLINE and len(stroke.points) > 60
    ]
    teeth = [points for points in outline if len(points) < 150]
    assert len(teeth) == 23
    every = np.concatenate(teeth)
    centre = 0.5 * (every.min(axis=0) + every.max(axis=0))
    assert np.linalg.norm(every - centre, axis=-1).max() == pytest.approx(0.5 * 112.1964 * scale, abs=0.2)
    # lines so far apart cover the section: two strips of 72 mm from the bore to root or gap, less the keyway
    lengths = [np.linalg.norm(np.diff(s.points, axis=0)) for s in made._page.canvas.strokes if s.pen is Pen.HATCHING]
    root, gap = 0.5 * 94.1964, 0.5 * (94.1964 - 2.0)
    section = 2.0 * (60.0 * (root - 20.0) + 12.0 * (gap - 20.0)) - 72.0 * 3.3
    assert HATCH_SPACING_MM * sum(lengths) / scale**2 == pytest.approx(section, rel=0.01)


@pytest.mark.quick
def test_hatching_leaves_openings_out() -> None:
    canvas = Canvas()
    square = np.array([(0.0, 0.0), (60.0, 0.0), (60.0, 60.0), (0.0, 60.0)])
    canvas.hatch([square, 20.0 + square / 3.0])
    points = np.concatenate([stroke.points.mean(axis=0, keepdims=True) for stroke in canvas.strokes])
    inside = np.all((points > 20.0) & (points < 40.0), axis=1)
    assert not inside.any()
    area = HATCH_SPACING_MM * sum(np.linalg.norm(np.diff(stroke.points, axis=0)) for stroke in canvas.strokes)
    assert area == pytest.approx(3200.0, rel=0.02)
    scales = (2.0, 1.25, 1.0, 1.0 / 1.5, 0.05)
    assert [scale_name(scale) for scale in scales] == ["2:1", "1.25:1", "1:1", "1:1.5", "1:20"]
    assert Box(0.0, 0.0, 1.0, 1.0).overlaps(Box(0.9, 0.9, 2.0, 2.0))


@pytest.mark.sweep
def test_table_has_tolerances_only_for_a_given_accuracy_class() -> None:
    sample, changes, member, _ = CASES["keyed"]
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml", changes))
    tables = gears.sheet().plain_tables
    texts = gears.drawing(member).texts
    measures, limits = tables["Measures of the tooth thickness"], tables["Flank tolerances [ISO 1328-1:2013]"]
    ends = [f"{measures[f'W_k_{end}'][2]:.4f}".rstrip("0") for end in ("upper", "lower")]
    assert f"{ends[0]} / {ends[1]} mm" in texts
    for symbol in ("f_pT", "F_pT"):
        assert f"{limits[symbol][2]:g} µm" in texts
    plain = gm.build(gm.load(SAMPLES / "helical.toml")).drawing("gear").texts
    assert "f_pT" not in plain
    assert {"flank tolerance class", "6, default"} <= set(plain)
    assert "7" in texts
    assert "W_k" in plain


@pytest.mark.sweep
def test_files_have_the_same_bytes_every_time(tmp_path: Path) -> None:
    made = drawing("rack")
    for suffix in ("png", "svg", "pdf"):
        files = [made.save(tmp_path / f"{k}.{suffix}") for k in (1, 2)]
        assert files[0].read_bytes() == files[1].read_bytes()
    assert b"CreationDate" not in files[0].read_bytes()


def test_the_command_writes_a_sheet_or_says_in_one_line_why_not(tmp_path: Path) -> None:
    file = tmp_path / "rack.svg"
    status, out, _ = run("drawing", SAMPLES / "rack.toml", "--member", "rack", "-o", file)
    assert (status, out.strip().rpartition(": A")[2]) == (0, "3 at 1:1")
    assert file.read_text().startswith("<?xml")
    wrong = tmp_path / "rack.dxf"
    assert "its suffix must be .pdf or .svg or .png" in refused(
        "drawing", SAMPLES / "rack.toml", "--member", "rack", "-o", wrong
    )
    message = refused("drawing", SAMPLES / "rack.toml", "--member", "ring", "-o", file)
    assert message.startswith("--member = ring: must be one of pinion, rack")


@pytest.mark.sweep
def test_chamfers_of_end_faces_are_drawn_and_said() -> None:
    """In the axial section tip and root end a chamfer's width inside, where the end face is; seen along the axis there is one more
    line round all teeth."""
    plain = gm.build(gm.load(SAMPLES / "helical.toml"))
    gears = gm.build(gm.load(SAMPLES / "helical.toml", ["pinion.end_chamfer_toe=2", "pinion.end_chamfer_angle=30"]))
    (row,), (sharp,) = (outline_of(made.members["pinion"]).rows for made in (gears, plain))
    for own, before in zip(row.broken, sharp.broken, strict=True):
        assert own[0] == pytest.approx(before[0] - [0.0, 2.0], abs=1e-9)
        assert own[1] == pytest.approx(before[0] + [2.0 * np.tan(np.radians(30.0)), 0.0], abs=1e-9)
        assert own[-1] == pytest.approx(before[-1], abs=1e-9)
    assert row.tip == pytest.approx(sharp.tip, abs=1e-12)
    drawn = [made.drawing("pinion") for made in (gears, plain)]
    assert "2 mm x 30° / sharp" in drawn[0].texts
    lines = [sum(stroke.pen is Pen.OUTLINE for stroke in made._page.canvas.strokes) for made in drawn]
    # the side of the toe is what is seen
    assert lines[0] == lines[1] + 24


def test_chamfers_of_a_rack_are_drawn_in_both_views() -> None:
    """The outline of its end face is inside the section under it, from end to end; in the section the bar's corner is cut."""
    keys = {"teeth": 4, "face_width": 12, "length": 40, "end_chamfer_heel": 0.5, "end_chamfer_angle": 60}
    made = gm.build(gm.parse({"kind": "rack", "module": 2, "rack": keys}))
    member = made.members["rack"]
    (face,) = bar_faces(member)
    assert face[[0, -1], 1] == pytest.approx([np.pi - 20.0, np.pi + 20.0], abs=1e-9)
    contour = np.concatenate(
        [curve.at(np.linspace(0.0, 1.0, 801)) for curve in member_section(member, 0.0, 1e-5).contours[0].curves]
    )
    own = contour[np.abs(contour[:, 1] - np.pi) < 19.9]
    apart = np.linalg.norm(face[1:-1, None] - own, axis=-1).min(axis=1)
    assert apart == pytest.approx(0.5, abs=1e-3)
    body, depth = outline_of(member).body, 0.5 * np.tan(np.radians(60.0))
    heel = body[body[:, 0] > 6.0 - depth - 1e-9]
    assert {tuple(point) for point in heel.round(9).tolist()} == {
        (round(6.0 - depth, 9), -2.5),
        (6.0, -3.0),
        (6.0, -8.5),
    }
    assert "0.5 mm x 60\N{DEGREE SIGN}" in " ".join(made.drawing("rack").texts)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("symbol", "text"),
    [
        ("alpha_n", "α_{n}"),  # noqa: RUF001
        ("eps_v_gamma", "ε_{vγ}"),  # noqa: RUF001
        ("j_phi1", "j_{φ1}"),
        ("Delta b_F", r"Δ\ b_{F}"),
        ("theta0", "θ0"),
        ("deltoid", "deltoid"),
    ],
)
def test_symbols_have_greek_letters_and_subscripts(symbol: str, text: str) -> None:
    assert formula(symbol) == rf"$\mathregular{{{text}}}$"


@pytest.mark.quick
@pytest.mark.parametrize(
    ("symbol", "drawn"),
    [
        ("dae", "d_ae"),
        ("Re", "R_e"),
        ("tzF", "t_zF"),
        ("txo", "t_xo"),
        ("beta", "beta"),
        ("rho", "rho"),
        ("s_mn", "s_mn"),
        ("hand", ""),
        ("f_HbT", "f_H_beta_T"),
        ("F_aT", "F_alpha_T"),
        ("f_pT", "f_pT"),
    ],
)
def test_drawings_have_the_standard_s_symbols_and_none_for_words(symbol: str, drawn: str) -> None:
    assert drawn_symbol(symbol) == drawn


def test_what_a_design_and_its_sheet_both_say_is_drawn_once() -> None:
    gears = gm.build(gm.load(SAMPLES / "beveloid_crossed.toml"))
    rows = facts_of(gears, gears.train.members["pinion"]).rows
    assert len(rows) == len(set(rows))
    assert [(row.words, row.symbol, row.value) for row in rows if row.value == "rack cutter"] == [
        ("tool", "", "rack cutter")
    ]


def test_symbols_with_greek_letters_are_as_large_as_others() -> None:
    """Their size is that of the letters, not of these letters' names."""
    page = gm.build(gm.load(SAMPLES / "helical.toml", ["accuracy_class=7"])).drawing("pinion")._page
    assert {one.height for one in page.canvas.letters if one.symbol} == {TABLE_LETTER_HEIGHT_MM}


def rows_of(sample: str, member: str, *changes: str) -> dict[str, str]:
    """Values of the rows of gear data by their words."""
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml", list(changes)))
    return {row.words: row.value for row in facts_of(gears, gears.train.members[member]).rows}


@pytest.mark.sweep
def test_basic_rack_or_tool_is_a_row() -> None:
    """A hobbed gear has its basic rack [DIN 3966-1], by name where it is standard; a shaped gear its cutter."""
    standard = rows_of("helical", "gear")
    assert standard["basic rack profile"] == "ISO 53, A"
    changes = 'profile="D"', "gear.tool_tip_radius=0.3", "gear.profile_shift=0.2"
    own = rows_of("helical", "gear", *changes)
    assert own["basic rack profile"] == "as below"
    factors = [own[f"{words} of the basic rack"] for words in ("addendum", "dedendum", "fillet", "pressure angle")]
    assert factors == ["1 m_n", "1.4 m_n", "0.3 m_n", "20\N{DEGREE SIGN}"]
    assert rows_of("helical", "pinion", *changes)["basic rack profile"] == "ISO 53, D"
    ring = rows_of("internal", "gear")
    assert "basic rack profile" not in ring
    assert (ring["tool"], ring["tool: teeth"]) == ("shaper", "28")
    bevel = rows_of("hypoid", "gear")
    assert (bevel["tool"], bevel["tool: point radius, right / left"]) == ("head cutter", "74.945 / 77.455 mm")


def test_hand_is_of_the_member() -> None:
    """The gear of a right-hand pinion on parallel axes is left-hand; its design has the hand of the pinion alone."""
    assert [rows_of("circular_arc", name)["hand of the teeth"] for name in ("pinion", "gear")] == ["right", "left"]
    assert [rows_of("helical", name)["hand of the helix"] for name in ("pinion", "gear")] == ["right", "left"]
    assert "hand of the teeth" not in rows_of("face_gear", "pinion")
    assert rows_of("face_gear", "gear")["Mating gear: pinion"] == ""


def test_run_outs_are_rows() -> None:
    """Of hobbed teeth that run out into a shaft: their length and the radius of the tool."""
    shaft = "pinion.heel_shaft={diameters=[70], lengths=[20]}", "pinion.run_out_radius=45"
    own = rows_of("spur", "pinion", *shaft)
    assert own["radius of the tool that leaves run-outs"] == "45 mm"
    assert float(own["run-outs of the teeth beyond the face width, of both ends"].removesuffix(" mm")) > 15.0
    assert not [name for name in rows_of("spur", "gear", *shaft) if "run-out" in name]


def test_material_rows_have_the_values_of_the_member() -> None:
    own = rows_of("helical", "gear", "gear.material.youngs_modulus=110000", "material.density=7300")
    assert (own["Young's modulus"], own["density"]) == ("110 GPa", f"{number(7300.0)} kg/m\N{SUPERSCRIPT THREE}")
    assert rows_of("helical", "pinion")["Young's modulus"] == "206 GPa"


@pytest.mark.sweep
def test_names_of_rows_are_large_enough_to_read() -> None:
    """The swivel of the hob has three clauses in the sheet; with all of them its letters were 0.6 mm high."""
    page = gm.build(gm.load(SAMPLES / "worm_drive.toml")).drawing("wheel")._page
    heights = {letters.text: letters.height for letters in page.canvas.letters if letters.align == "left"}
    assert [text for text in heights if text.startswith("swivel of the hob") and not text.endswith("h_w0")]
    assert min(height for text, height in heights.items() if " " in text) >= 1.4


@pytest.mark.sweep
def test_intermediate_scales_fill_the_sheet() -> None:
    """No other scale of the two series, a fifth larger, would fit on A3; recommended scales stay where they do."""
    scales = {name: gm.build(gm.load(SAMPLES / f"{name}.toml")).drawing("gear").scale for name in ("helical", "hypoid")}
    assert scales == {"helical": "1:1.5", "hypoid": "1:1"}


@pytest.mark.sweep
def test_protuberance_and_stock_of_the_hob_are_rows() -> None:
    """They are beside the basic rack, with the design's values; teeth of internal gears are below 0."""
    own = rows_of("hob_protuberance", "pinion", "pinion.hob.stock=0.13")
    assert own["protuberance of the hob"] == "0.2 mm"
    assert own["stock that the hob leaves on each flank"] == "0.13 mm"
    assert "protuberance of the hob" not in rows_of("hob_protuberance", "gear")
    gears = gm.build(gm.load(SAMPLES / "internal.toml"))
    assert facts_of(gears, gears.train.members["gear"]).rows[0].value == "\N{MINUS SIGN}70"
