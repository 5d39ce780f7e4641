"""Design files: what is accepted, what it becomes, and how everything else is refused."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.drawn import zero_or_more
from oracles.examples import examples, some
from oracles.places import SAMPLES

from gearmesh import DesignError, load, parse, system, toml
from gearmesh.design import files
from gearmesh.kinds import Table
from gearmesh.systems.system import build, kinds

BEVELOID: dict[str, Any] = {
    "kind": "beveloid",
    "module": 5,
    "pinion": {"teeth": 24, "face_width": 14, "cone_angle": 30},
    "gear": {"teeth": 36, "face_width": 14, "cone_angle": 30},
}
CIRCULAR_ARC: dict[str, Any] = {
    "kind": "circular_arc",
    "units": "inch",
    "diametral_pitch": 2,
    "pinion": {"teeth": 12, "lead_angle": 75, "face_width": 9.5},
    "gear": {"teeth": 94, "lead_angle": 75, "face_width": 9.5},
}

# Every length of a beveloid design by its last name: written out, so that no unit is taken from the code under test.
LENGTHS = {
    *(
        "module",
        "backlash",
        "face_width",
        "bore",
        "width",
        "depth",
        "diameter",
        "length",
        "tip_chamfer",
        "circle",
        "hub_diameter",
        "rim_diameter",
        "thickness",
    ),
    *("tip_diameter", "root_diameter", "dx", "dy", "dz", "center_distance", "delta", "tolerance"),
}


def set_in(data: dict[str, Any], dotted: str, value: Any) -> dict[str, Any]:
    """A copy of nested data with one dotted key set."""
    first, _, rest = dotted.partition(".")
    below = data.get(first, {})
    return {**data, first: set_in(below if isinstance(below, dict) else {}, rest, value) if rest else value}


def _is_length(key: str, value: Any) -> bool:
    """True for lengths: the thickness of a web is one, that of a finite-element model is a number of elements."""
    return key in LENGTHS and not (key == "thickness" and isinstance(value, int))


def in_inches(data: dict[str, Any]) -> dict[str, Any]:
    """A beveloid design in mm rewritten in inches."""
    return {
        key: in_inches(value) if isinstance(value, dict) else value / 25.4 if _is_length(key, value) else value
        for key, value in data.items()
    } | ({"units": "inch"} if "kind" in data else {})


def assert_close(a: Any, b: Any) -> None:
    """Nested data equal, numbers within rounding."""
    if isinstance(a, dict):
        assert a.keys() == b.keys()
        for key in a:
            assert_close(a[key], b[key])
    elif isinstance(a, float):
        assert math.isclose(a, b, rel_tol=1e-14)
    else:
        assert a == b


@st.composite
def beveloids(draw: st.DrawFn) -> dict[str, Any]:
    """Valid beveloid designs in mm that use every kind of key."""
    length = st.floats(1e-3, 1e3)

    def either_sign(most: float) -> st.SearchStrategy[float]:
        return zero_or_more(-most, most)

    data = BEVELOID
    choices: dict[str, st.SearchStrategy[Any]] = {
        "module": length,
        "pressure_angle": st.floats(1, 45),
        "backlash": length,
        "name": st.text("abc äö", max_size=80),
        "assembly.dx": either_sign(1e3),
        "assembly.turned_over": st.just(True),
        "assembly.center_distance": length,
        "contact.phi1.start": either_sign(360),
        "contact.phi1.count": st.integers(1, 100),
        "contact.flank": st.sampled_from(["right", "left"]),
        "contact.delta": st.floats(1e-4, 1.0),
        "mesh.tolerance": st.floats(1e-4, 1.0),
        "pinion.teeth": st.integers(3, 100),
        "pinion.keyway": st.one_of(st.fixed_dictionaries({"width": length, "depth": length}), st.just({})),
        "gear.hub": st.fixed_dictionaries({"diameter": length, "length": length}),
        "gear.web": st.fixed_dictionaries({"thickness": length}, optional={"hub_diameter": length}),
        "gear.holes": st.fixed_dictionaries({"count": st.integers(1, 9)}, optional={"circle": length}),
        "gear.bore": st.just(0.0),
        "gear.tip_chamfer": length,
        "gear.tip_diameter": length,
        "gear.profile_shift": either_sign(5),
    }
    for key in draw(st.sets(st.sampled_from(sorted(choices)))):
        data = set_in(data, key, draw(choices[key]))
    if "center_distance" in data.get("assembly", {}):
        data = set_in(data, "assembly.turned_over", True)
    return data


@examples(100)
@given(beveloids())
def test_resolved_design_loads_back_to_the_same(data: dict[str, Any]) -> None:
    design = parse(data)
    resolved = design.resolve()
    assert parse(resolved) == design
    assert parse(json.loads(json.dumps(resolved))) == design
    assert parse(files.tomllib.loads(toml(resolved))) == design


@pytest.mark.quick
@examples(100)
@given(beveloids())
def test_inches_and_mm_give_the_same_design(data: dict[str, Any]) -> None:
    in_mm = parse(data)
    from_inches = parse(in_inches(in_mm.resolve())).in_mm()
    assert_close(in_mm.resolve(), from_inches.resolve())
    # defaults that are lengths are the same lengths, whatever the units
    assert_close(in_mm.resolve(), parse(in_inches({**data, "units": "mm"})).in_mm().resolve())


@pytest.mark.quick
def test_diametral_pitch_is_per_inch_in_any_units() -> None:
    for units, module in (("mm", 12.7), ("inch", 0.5)):
        data = {**BEVELOID, "units": units, "diametral_pitch": 2}
        del data["module"]
        design = parse(data)
        assert design.given_module == pytest.approx(module, rel=1e-15)
        assert design.in_mm().given_module == pytest.approx(12.7, rel=1e-15)


@pytest.mark.quick
def test_circular_arc_defaults_are_those_of_the_paper() -> None:
    """The rack of [LT85] example 1, as recomputed, from diametral pitch 2 alone."""
    design = parse(set_in(CIRCULAR_ARC, "center_distance", 29.239515)).resolve()
    pinion, gear = design["pinion"], design["gear"]
    expected = [(pinion["profile_radius"], 0.675), (gear["profile_radius"], 0.75), (pinion["a"], 0.1994)]
    expected += [(pinion["b"], 0.12195), (gear["b"], 0.15945), (gear["a"], 0.1994 + 0.075 * math.sqrt(0.75))]
    expected += [(pinion["pitch_radius"], 12 * 29.239515 / 106), (gear["pitch_radius"], 94 * 29.239515 / 106)]
    for found, value in expected:
        assert found == pytest.approx(value, rel=1e-14)
    # the centre distance belongs to a lead angle of 65 deg
    alone = parse(set_in(set_in(CIRCULAR_ARC, "pinion.lead_angle", 65), "gear.lead_angle", 65)).resolve()
    assert alone["center_distance"] == pytest.approx(29.239515, abs=1e-6)


@pytest.mark.quick
def test_values_given_keep_derived_defaults_consistent() -> None:
    design = parse(set_in(set_in(CIRCULAR_ARC, "pinion.b", -0.021), "gear.profile_radius", 0.8)).resolve()
    assert design["gear"]["b"] == pytest.approx(-0.021 + 0.125 * 0.5, rel=1e-14)
    assert parse(set_in(BEVELOID, "pinion.teeth", 30)).contact.phi1.start == -6.0


@pytest.mark.quick
def test_tip_diameter_replaces_the_addendum() -> None:
    data = set_in(BEVELOID, "pinion.tip_diameter", 130)
    assert "addendum" not in parse(data).resolve()["pinion"]
    assert parse(data).resolve()["gear"]["addendum"] == 1.0


@pytest.mark.quick
def test_other_values_take_the_place_of_what_was_derived() -> None:
    """Design of the same file with these keys set; keys that the design itself sets stay."""
    keys: dict[str, Any] = {
        "kind": "cylindrical",
        "module": 2,
        "pinion": {"teeth": 18, "face_width": 20},
        "gear": {"teeth": 45, "face_width": 20},
    }
    for values in (
        {"gear.tip_diameter": 93.0, "pinion.root_diameter": 31.5},
        {"transverse_pressure_angle": 21.0},
        {"circumferential_backlash": 0.1},
        {"gear.thickness_allowance": {"upper": -0.05, "lower": -0.09}},
        {"gear.shaper": {"teeth": 20, "addendum": 1.2}},
    ):
        design, stated = parse(keys).with_values(values), keys
        for dotted, value in values.items():
            stated = set_in(stated, dotted, value)
        assert {key for key, _ in design.own()} == {key for key, _ in parse(stated).own()}
        assert set(design.resolve()["gear"]) == set(parse(stated).resolve()["gear"])
        build(design)
    keys["gear"]["addendum"] = 1.0
    with pytest.raises(DesignError, match=r"^gear.tip_diameter = 93 mm: cannot be given together with addendum$"):
        parse(keys).with_values({"gear.tip_diameter": 93.0})
    assert parse(keys).with_values({"gear.addendum": 0.9}).resolve()["gear"]["addendum"] == 0.9


@pytest.mark.sweep_cases("hypoid_formate", "hypoid_measured", "spiral_bevel_formate", "hypoid_high_ratio")
@pytest.mark.parametrize("file", some(sorted(SAMPLES.glob("*.toml")), 12), ids=lambda file: file.stem)
def test_samples_load(file: Path) -> None:
    design = load(file)
    assert parse(design.resolve()) == design
    # the papers' data is stated, not left to defaults
    stated = files.read(file)
    words = {"basic", "hypoid", "internal", "planetary", "rack", "relieved", "worm", "cycloidal", "spline", "palloid"}
    if not words & set(file.stem.split("_")) and file.stem != "straight_bevel":
        assert {"start", "stop", "count"} <= stated["contact"]["phi1"].keys()
    if design.units == "inch":
        assert design.in_mm().resolve()["gear"]["face_width"] == pytest.approx(12.0 * 25.4)
        assert stated["center_distance"] == 29.239515
        assert {"a", "b", "profile_radius"} <= stated["gear"].keys()


@pytest.mark.quick
def test_sample_gear_is_that_of_the_defaults() -> None:
    """circular_arc.toml states the gear's rack; it must be [LT85] (13) for the stated pinion."""
    stated = files.read(SAMPLES / "circular_arc.toml")
    bare = {**stated, "gear": {k: v for k, v in stated["gear"].items() if k not in ("a", "b", "profile_radius")}}
    assert_close(load(SAMPLES / "circular_arc.toml").resolve(), parse(bare).resolve())


@pytest.mark.quick
def test_overrides() -> None:
    file = SAMPLES / "beveloid_intersected.toml"
    design = load(file, ["pinion.teeth=25", "assembly.dx=0.3", "contact.phi1={start=1, stop=2, count=3}", "name=a b"])
    found = design.resolve()
    assert (found["pinion"]["teeth"], found["assembly"]["dx"], found["name"]) == (25, 0.3, "a b")
    assert found["contact"]["phi1"] == {"start": 1.0, "stop": 2.0, "count": 3}
    assert load(file, ["contact.phi1.count=7", "contact.phi1.count=9"]).contact.phi1.count == 9
    # a value with a line break cannot smuggle in other keys
    assert files.override({}, ["a=1\nb=2"]) == {"a": "1\nb=2"}


REFUSED: list[tuple[str, dict[str, Any], str]] = [
    (
        "missing kind",
        {"module": 5},
        'kind: missing; must be one of "cylindrical", "planetary", "rack", "beveloid", "circular_arc"',
    ),
    (
        "unknown kind",
        {**BEVELOID, "kind": "bevelod"},
        'kind = "bevelod": must be one of "cylindrical", "planetary", "rack", "beveloid", "circular_arc", ',
    ),
    (
        "missing key",
        set_in(BEVELOID, "pinion", {"teeth": 24}),
        "pinion.face_width: missing; must be a length in mm",
    ),
    (
        "missing table",
        {"kind": "beveloid", "module": 1, "gear": BEVELOID["gear"]},
        "pinion: missing; must be a table",
    ),
    ("unknown key", set_in(BEVELOID, "pinion.cone", 3), "pinion.cone: unknown key; did you mean pinion.cone_angle?"),
    ("key of a table", set_in(BEVELOID, "helix", 3), "helix: unknown key; did you mean pinion.helix_angle?"),
    (
        "in a table too deep",
        set_in(BEVELOID, "pinion.pressure_angle", 20),
        "pinion.pressure_angle: unknown key; did you mean pressure_angle?",
    ),
    (
        "of other axes",
        set_in(BEVELOID, "shaft_angle", 30),
        "shaft_angle: the cone and helix angles of the members give it",
    ),
    ("strange key", set_in(BEVELOID, "gear.qqqq", 3), "gear.qqqq: unknown key; known here: teeth, bore, tip_chamfer"),
    (
        "key of another table of a member",
        set_in(BEVELOID, "gear.web.width", 3),
        "gear.web.width: unknown key; known here: thickness, rim_diameter, hub_diameter",
    ),
    (
        "beginning of a key",
        set_in(BEVELOID, "gear.material.young", 3),
        "gear.material.young: unknown key; did you mean gear.material.youngs_modulus?",
    ),
    (
        "unlike all in its table",
        set_in(BEVELOID, "fe.profile_elements", 3),
        "fe.profile_elements: unknown key; known here: ",
    ),
    (
        "misspelt, of another table",
        set_in(BEVELOID, "gear.diametral_pich", 20),
        "gear.diametral_pich: unknown key; did you mean diametral_pitch?",
    ),
    ("key of two lines", set_in(BEVELOID, "gear.a\nb", 3), 'gear."a\\nb": unknown key; known here: teeth'),
    ("text for number", set_in(BEVELOID, "module", "five"), 'module = "five": must be a length in mm from'),
    ("nan", set_in(BEVELOID, "gear.helix_angle", math.nan), "gear.helix_angle = NaN: must be an angle in deg from -88"),
    (
        "infinity",
        set_in(BEVELOID, "assembly.dx", math.inf),
        "assembly.dx = Infinity: must be a length in mm from -1",
    ),
    (
        "negative teeth",
        set_in(BEVELOID, "pinion.teeth", -24),
        "pinion.teeth = -24: must be a whole number from 1 to",
    ),
    ("no teeth", set_in(BEVELOID, "pinion.teeth", 0), "pinion.teeth = 0: must be a whole number from 1 to 10000"),
    ("half a tooth", set_in(BEVELOID, "pinion.teeth", 24.5), "pinion.teeth = 24.5: must be a whole number from 1"),
    ("no module", set_in(BEVELOID, "module", 0), "module = 0: must be a length in mm from 0.001 to 10000"),
    (
        "angle",
        set_in(BEVELOID, "pinion.cone_angle", 61),
        "pinion.cone_angle = 61: must be an angle in deg from",
    ),
    ("units", set_in(BEVELOID, "units", "cm"), 'units = "cm": must be one of "mm", "inch"'),
    ("truth for number", set_in(BEVELOID, "module", True), "module = true: must be a length in mm"),
    (
        "number for truth",
        set_in(BEVELOID, "assembly.turned_over", 1),
        "assembly.turned_over = 1: must be true or fa",
    ),
    (
        "number for table",
        set_in(BEVELOID, "contact.phi1", 3),
        "contact.phi1 = 3: must be a table with the keys start",
    ),
    (
        "inches",
        {**CIRCULAR_ARC, "center_distance": 1e6},
        "center_distance = 1000000.0: must be a length in inch above",
    ),
    (
        "no size",
        {k: v for k, v in BEVELOID.items() if k != "module"},
        "module: missing; give module (mm) or diametr",
    ),
    (
        "two sizes",
        {**BEVELOID, "diametral_pitch": 2},
        "diametral_pitch = 2 1/inch: cannot be given together with module",
    ),
    (
        "two tips",
        set_in(set_in(BEVELOID, "gear.addendum", 1), "gear.tip_diameter", 190),
        "gear.tip_diameter = 190 mm: cannot be given together with addendum",
    ),
    (
        "two edges",
        set_in(BEVELOID, "gear", {**BEVELOID["gear"], "tip_chamfer": 1, "tip_rounding": 2}),
        "gear.tip_rounding = 2 mm: cannot be given together with tip_chamfer",
    ),
    (
        "keyway without bore",
        set_in(BEVELOID, "gear", {**BEVELOID["gear"], "bore": 0, "keyway": {"width": 3, "depth": 1}}),
        "gear.keyway.width = 3 mm: must be smaller than the bore, 0",
    ),
    (
        "centre distance of axes that meet",
        set_in(BEVELOID, "assembly.center_distance", 150),
        "assembly.center_distance = 150 mm: only parallel axes have one",
    ),
    (
        "unknown key before other errors",
        set_in(set_in(set_in(BEVELOID, "module", -1), "gear.teeth", -1), "qq", 1),
        "qq: unknown key; known here: kind, gearmesh, units, name, module, diametral_pitch, backlash, pressure_angle,"
        " coast_pressure_angle, accuracy_class, pinion, gear, contact, mesh, material, fe, measured, assembly (and 2 more)",
    ),
]


@pytest.mark.quick
@pytest.mark.parametrize(("data", "message"), [row[1:] for row in REFUSED], ids=[row[0] for row in REFUSED])
def test_refused(data: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError) as error:
        parse(data)
    assert str(error.value).startswith(message)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("settings_", "message"),
    [
        (["module.x=3"], 'overrides "module.x=3": module = 5 is not a table; no key can be set in it'),
        (["module"], 'overrides "module": must look like dotted.key=value'),
        (["=3"], 'overrides "=3": must look like dotted.key=value'),
        (["pinion..teeth=3"], 'overrides "pinion..teeth=3": must look like dotted.key=value'),
        (["pinion.teeth=abc"], 'pinion.teeth = "abc": must be a whole number'),
        (["pinion.teeth=2024-01-01"], 'pinion.teeth = "2024-01-01": must be a whole number'),
    ],
)
def test_refused_overrides(settings_: list[str], message: str) -> None:
    with pytest.raises(DesignError) as error:
        load(SAMPLES / "beveloid_intersected.toml", settings_)
    assert str(error.value).startswith(message)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.toml", b"kind = 'beveloid'\nmodule = = 3\n", "a.toml: Invalid value (at line 2, column 10)"),
        ("a.toml", b"module = 1\nmodule = 2\n", "a.toml: Cannot overwrite a value (at line 2, column 11)"),
        ("a.json", b'{"kind": "beveloid",\n "module": }', "a.json: line 2, column 12: Expecting value"),
        ("a.json", b"[1]", "a.json: a design is a table (an object in JSON), not [1]"),
        ("a.toml", b"kind = '\xff'", "a.toml: not UTF-8 text (byte 8)"),
        ("a.toml", b"x = " + b"[" * 5000, "a.toml: nested too deeply"),
        ("a.toml", b"x = " + b"9" * 5000, "a.toml: Exceeds the limit"),
        ("a.toml", b"kind = 0x" + b"f" * 5000, 'kind = <int>: must be one of "cylindrical"'),
        ("a.json", b'{"kind":' * 900 + b"1" + b"}" * 900, 'kind = {"kind": {"kind"'),
        ("folder", None, "folder: is a folder, not a design file"),
        ("absent.toml", None, "absent.toml: cannot be read: No such file or directory"),
    ],
)
def test_refused_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, content: bytes | None, message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    if content is not None:
        Path(name).write_bytes(content)
    elif name == "folder":
        Path(name).mkdir()
    with pytest.raises(DesignError) as error:
        load(name)
    assert message in str(error.value)


TEXTS = st.text("aé 0-.=\"'#[]{}\\\n\r\t\x00\x1b\x85\u2028\U0001f600", max_size=20)
SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | TEXTS | st.dates()
VALUES = SCALARS | st.lists(SCALARS, max_size=3) | st.dictionaries(TEXTS, SCALARS | st.lists(SCALARS), max_size=3)
KEYS = sorted(
    {line.key for kind in kinds() for line in system(kind).design.key_lines()}
    | {"pinion", "gear.hub", "contact.phi1", "x"}
)


def refusal(action: Callable[[], Any]) -> str:
    """The message of the DesignError that `action` raises, "" if it succeeds."""
    try:
        action()
    except DesignError as error:
        return str(error)
    return ""


@pytest.mark.quick
@examples(200)
@given(st.sampled_from([BEVELOID, CIRCULAR_ARC]), st.dictionaries(st.sampled_from(KEYS), VALUES, max_size=4))
def test_any_values_give_a_design_or_one_line(base: dict[str, Any], values: dict[str, Any]) -> None:
    for key, value in values.items():
        base = set_in(base, key, value)
    message = refusal(lambda: parse(base))
    assert len(message.splitlines()) <= 1


@pytest.mark.quick
@examples(100)
@given(TEXTS)
def test_any_override_is_taken_or_refused(setting: str) -> None:
    message = refusal(lambda: files.override(BEVELOID, [setting]))
    assert message == "" or message.startswith("overrides ")


# ---------------------------------------------------------------- lengths with their units


@pytest.mark.quick
@pytest.mark.parametrize("text", ["12.7mm", "0.5in", "0.5 inch", " 12700um ", "12700 µm", "1.27e1 mm", "+.5in"])
@pytest.mark.parametrize(("units", "bore"), [("mm", 12.7), ("inch", 0.5)])
def test_a_length_may_have_a_unit_of_its_own(units: str, bore: float, text: str) -> None:
    """It is a number in the file's units from then on, whatever those are, and loads back as one."""
    design = parse(set_in(in_inches(BEVELOID) if units == "inch" else BEVELOID, "pinion.bore", text))
    assert design.pinion.bore == bore
    assert parse(design.resolve()) == design
    assert design.in_mm().pinion.bore == pytest.approx(12.7, rel=1e-15)


@pytest.mark.quick
def test_lengths_with_units_in_files_and_overrides(tmp_path: Path) -> None:
    file = tmp_path / "spur.toml"
    file.write_text((SAMPLES / "spur.toml").read_text().replace("module = 3", 'module = "3000um"', 1))
    design = load(file, ["mesh.tolerance=9um", "contact.delta = 0.0004in", 'pinion.bore="20 mm"', "assembly.dx=-15um"])
    found = design.resolve()
    assert found["module"] == 3.0
    # decimal: no 0.009000000000000001
    assert (found["mesh"]["tolerance"], found["contact"]["delta"], found["pinion"]["bore"]) == (0.009, 0.01016, 20.0)
    assert found["assembly"]["dx"] == -0.015


@pytest.mark.quick
@pytest.mark.parametrize(
    "text", ["15km", "15", "mm", "1e", "1.2.3mm", "1 2mm", "15um mm", "inf mm", "1e999999999999mm"]
)
def test_wrong_units_are_refused_with_how_it_looks(text: str) -> None:
    message = refusal(lambda: parse(set_in(BEVELOID, "pinion.bore", text)))
    assert message.startswith(f'pinion.bore = "{text}": must be a length in mm from 0 to 1000000, or a length with its')
    assert message.endswith("unit, as 15um, 0.01mm or 0.0004in")


@pytest.mark.quick
def test_ranges_hold_for_lengths_with_units_and_other_keys_have_none() -> None:
    for key, text in (("mesh.tolerance", "11mm"), ("mesh.tolerance", "0.001um"), ("pinion.bore", "-1mm")):
        assert refusal(lambda key=key, text=text: parse(set_in(BEVELOID, key, text))).startswith(
            f'{key} = "{text}": must'
        )
    assert refusal(lambda: parse(set_in(BEVELOID, "pressure_angle", "20mm"))).endswith("deg from 1 to 45")
    assert refusal(lambda: parse(set_in(BEVELOID, "pinion.teeth", "20mm"))).endswith("from 1 to 10000")


@pytest.mark.quick
@pytest.mark.parametrize("kind", kinds())
def test_a_key_of_a_table_changes_no_default_of_another(kind: str) -> None:
    """A table that is left out is the empty one."""
    tables = {
        name: field.default
        for name, field in system(kind).design.model_fields.items()
        if isinstance(field.default, Table)
    }
    assert tables
    assert tables == {name: type(table)() for name, table in tables.items()}


@pytest.mark.quick
def test_derived_values_out_of_range_have_the_digits_of_other_figures() -> None:
    """A shift that follows from the centre distance, not what somebody typed with 17 digits."""
    with pytest.raises(DesignError, match=r"gear.profile_shift = 5\.91 among them$"):
        load(SAMPLES / "helical.toml", ["assembly.center_distance=220"])
    with pytest.raises(DesignError, match=r"pinion.profile_shift = 12.3456789: must be"):
        load(SAMPLES / "helical.toml", ["pinion.profile_shift=12.3456789"])


def test_tables_without_a_key_stay_when_other_keys_change() -> None:
    design = load(SAMPLES / "zerol.toml")
    assert design.stated()["gear"] == {"teeth": 30, "cutter": {}}
    assert design.with_values({"name": "other"}).stated()["gear"] == design.stated()["gear"]
    assert "cutter" not in design.with_values({"gear.cutter": None}).stated()["gear"]
    own = design.with_values({"gear.cutter.tilt": 1.0})
    assert "cutter" not in own.with_values({"gear.cutter.tilt": None}).stated()["gear"]
