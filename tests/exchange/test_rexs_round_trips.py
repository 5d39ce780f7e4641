"""Designs that are written as REXS models and read again are the same gears."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exchange.rexs_validation import faults

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.exchange.model import OWN_PREFIX
from gearmesh.exchange.rexs_file import read_rexs, rexs_bytes

SAMPLES = Path(__file__).parents[2] / "samples"

PAIR = {"kind": "cylindrical", "module": 3.0}
#: what no sample is
OTHERS: dict[str, dict[str, Any]] = {
    "inches": {
        "kind": "cylindrical", "units": "inch", "diametral_pitch": 8, "helix_angle": 20, "hand": "left",
        "pinion": {"teeth": 17, "face_width": 1.5}, "gear": {"teeth": 61, "face_width": 1.4}, "assembly": {"center_distance": 5.2},
    },
    "shaped": {
        "kind": "cylindrical", "module": 0.3, "pressure_angle": 25, "backlash": 0.01,
        "pinion": {"teeth": 11, "face_width": 2, "profile_shift": 0.4,
                   "shaper": {"teeth": 31, "profile_shift": 0.1, "addendum": 1.4}},
        "gear": {"teeth": 97, "face_width": 3, "root_diameter": 28.2},
    },
    "formed": {
        "kind": "cylindrical", "module": 2, "backlash": 0.05,
        "pinion": {"teeth": 19, "face_width": 12}, "gear": {"teeth": -83, "face_width": 12, "manufacture": "formed"},
    },
    "span": {
        **PAIR, "helix_angle": 12, "profile": "C",
        "pinion": {"teeth": 21, "face_width": 30, "span": {"teeth": 3, "upper": 23.1, "lower": 23.05}},
        "gear": {"teeth": 40, "face_width": 28, "thickness_allowance": "cd25", "allowance_by": "feed"},
        "assembly": {"center_distance": 94, "dz": 1.5, "dx": 0.02, "gamma_v": 0.03},
    },
    "modified": {
        **PAIR, "helix_angle": 12,
        "pinion": {
            "teeth": 21, "face_width": 30,
            "modifications": {"helix_crowning": 0.01, "helix_slope": -0.004, "profile_twist": 0.003},
            "modifications_right": {"profile_slope": 0.005, "helix_crowning": 0.002},
            "modifications_left": {"tip_relief": {"amount": 0.02, "start_diameter": 68, "shape": "parabolic"}},
        },
        "gear": {
            "teeth": 40, "face_width": 28,
            "modifications": {
                "end_relief_heel": {"amount": 0.01, "length": 4},
                "triangular_end_relief_tip": {"amount": 0.01, "length": 4},
                "tip_relief": {"amount": 0.02, "start_roll_length": 25},
            },
        },
    },
    "ring as pinion": {
        "kind": "cylindrical", "module": 2, "pinion": {"teeth": -70, "face_width": 12}, "gear": {"teeth": 22, "face_width": 14},
    },
    "asymmetric internal": {
        "kind": "cylindrical", "module": 2, "pressure_angle": 24, "coast_pressure_angle": 18, "helix_angle": 8,
        "pinion": {"teeth": 22, "face_width": 14, "tool_tip_radius": 0.3, "coast_tool_tip_radius": 0.15,
                   "tip_chamfer": 0.1, "coast_tip_edge": 0.2},
        "gear": {"teeth": -70, "face_width": 12, "tool_tip_radius": 0.1, "coast_tool_tip_radius": 0.2},
    },
    "transverse": {
        "kind": "cylindrical", "transverse_module": 3.1, "transverse_pressure_angle": 21, "helix_angle": 30,
        "pinion": {"teeth": 14, "face_width": 50, "profile_shift": 0.3}, "gear": {"teeth": 15, "face_width": 40},
    },
    "helical set": {
        "kind": "planetary", "module": 1.5, "helix_angle": 18, "planets": 4, "backlash": 0.03,
        "sun": {"teeth": 20, "face_width": 20}, "planet": {"teeth": 22, "face_width": 19}, "ring": {"teeth": -64, "face_width": 20},
    },
    "obtuse bevel": {
        "kind": "spiral_bevel", "module": 3, "spiral_angle": 35, "face_width": 15, "shaft_angle": 110,
        "pinion": {"teeth": 15}, "gear": {"teeth": 37}, "assembly": {"dA": 0.1, "dV": -0.05},
    },
    "offset the other way": {
        "kind": "hypoid", "units": "inch", "module": 0.18, "offset": -0.4, "hand": "right", "spiral_angle": 40, "face_width": 1.1,
        "pinion": {"teeth": 11, "bore": 0}, "gear": {"teeth": 45},
    },
    "ZK left-hand": {
        "kind": "worm_drive", "module": 4, "center_distance": 100,
        "worm": {"threads": 3, "form": "ZK", "right_hand": False, "quotient": 9}, "wheel": {"teeth": 41},
    },
    "ZN of normal module": {
        "kind": "worm_drive", "module": 3.8, "module_section": "normal",
        "worm": {"threads": 4, "form": "ZN", "lead_angle": 18}, "wheel": {"teeth": 33},
    },
    "helical wheel": {
        "kind": "worm_drive", "module": 3.8, "module_section": "normal",
        "worm": {"threads": 4, "lead_angle": 18}, "wheel": {"teeth": 33, "form": "helical"},
    },
}  # fmt: skip

HAVING = (
    "spur", "spur_relieved", "helical", "helical_hub", "asymmetric", "internal", "double_helical", "hob_protuberance", "planetary",
    "spiral_bevel_basic", "hypoid", "worm_drive",
)  # fmt: skip
SLOW = (
    "spiral_bevel_abdullah_straight", "spiral_bevel_abdullah_curved", "spiral_bevel_formate", "hypoid_formate", "hypoid_high_ratio",
    "zerol", "worm_drive_dual_lead",
)  # fmt: skip


def same_contact(one: gm.Gears, other: gm.Gears) -> None:
    """First touch of every mesh that is not alike another, to 1e-9."""
    for k in {0, len(one.pairs) - 1}:
        phi1 = np.degrees(one.contact(pair=k, cycle=False).path.phi1)
        # where lines of contact begin and end they have no length and lie on an edge as well: not quite as far
        phi1 = phi1.mean() + 0.99 * (phi1 - phi1.mean())
        paths = [gears.contact(phi1, pair=k, cycle=False).path for gears in (one, other)]
        first = paths[0]
        assert paths[0].kind.tolist() == paths[1].kind.tolist()
        assert paths[0].touching.any()
        np.testing.assert_allclose(paths[0].te, paths[1].te, rtol=0, atol=1e-9)
        # of lines any point may stand for the whole
        points = [path.point[first.kind == "point"] for path in paths]
        np.testing.assert_allclose(points[0], points[1], rtol=0, atol=1e-3)
        np.testing.assert_allclose(paths[0].semi_minor, paths[1].semi_minor, rtol=1e-7)


def same_roots(one: gm.Gears, other: gm.Gears) -> None:
    """Rows of the sheets that both have, to 1e-9: diameters of tips and roots are among them.

    A file always states the tool's rounding. Where an order leaves it open, a tool that is fed has a rounding of its own.
    """
    sheets = [json.loads(gears.sheet().json())["tables"] for gears in (one, other)]
    rows = [
        {
            (table, row): values
            for table in sheet
            if not table.startswith("Derived") and "As cut by feeding the tool" not in table
            for row, values in sheet[table].items()
        }
        for sheet in sheets
    ]
    compared = 0
    for key in rows[0].keys() & rows[1].keys():
        for a, b in zip(rows[0][key], rows[1][key], strict=True):
            if isinstance(a, float) and isinstance(b, float):
                assert b == pytest.approx(a, rel=1e-9, abs=1e-9), key
                compared += 1
    assert compared > 20


def there_and_back(gears: gm.Gears, folder: Path, suffix: str = ".rexs") -> gm.Gears:
    file = folder / f"gears{suffix}"
    export = gears.rexs(folder)
    export.save(file)
    for form in (".rexs", ".rexsj"):
        assert faults(export.save(folder / f"valid{form}")) == []
    reading = gm.load_rexs(file)
    reading.save(folder / "again.toml")
    return gm.build(gm.load(folder / "again.toml"))


def test_flanks_of_two_pressure_angles_are_asymmetric_teeth(tmp_path: Path) -> None:
    """A file without attributes of this program says both angles by its flanks."""
    gears = gm.build(gm.load(SAMPLES / "asymmetric.toml"))
    file = tmp_path / "gears.rexs"
    gears.rexs(tmp_path).save(file)
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    file.write_text("".join(line for line in lines if "custom_gearmesh" not in line), encoding="utf-8")
    gm.load_rexs(file).save(tmp_path / "again.toml")
    again = gm.load(tmp_path / "again.toml")
    assert (again.pressure_angle, again.coast_pressure_angle) == (28.0, 20.0)  # type: ignore[attr-defined]
    own, other = (each.sheet().plain_tables["Sides of asymmetric teeth"] for each in (gears, gm.build(again)))
    assert other["d_Ff"][1:] == pytest.approx(own["d_Ff"][1:], abs=1e-8)


@pytest.mark.parametrize("name", [*HAVING, *(pytest.param(name, marks=pytest.mark.sweep) for name in SLOW)])
@pytest.mark.sweep_cases(
    "double_helical",
    "helical_hub",
    "hob_protuberance",
    "hypoid",
    "internal",
    "planetary",
    "spiral_bevel_basic",
    "spur_relieved",
    "worm_drive",
    "asymmetric",
)
def test_samples_come_back_as_the_same_gears(name: str, tmp_path: Path) -> None:
    gears = gm.build(gm.load(SAMPLES / f"{name}.toml"))
    same_contact(gears, there_and_back(gears, tmp_path, ".rexsj" if len(name) % 2 else ".rexsz"))


@pytest.mark.parametrize("name", OTHERS)
@pytest.mark.sweep_cases(
    "ZK left-hand",
    "ZN of normal module",
    "formed",
    "helical set",
    "inches",
    "modified",
    "obtuse bevel",
    "offset the other way",
    "ring as pinion",
    "shaped",
    "span",
    "transverse",
    "asymmetric internal",
)
def test_others_come_back_as_the_same_gears(name: str, tmp_path: Path) -> None:
    gears = gm.build(gm.parse(OTHERS[name]))
    again = there_and_back(gears, tmp_path)
    same_contact(gears, again)
    if gears.design.units == "mm":
        same_roots(gears, again)
    if gears.design.kind == "worm_drive":
        assert again.design.worm.right_hand == gears.design.worm.right_hand


@pytest.mark.parametrize("name", ["spur", "helical", "internal", "hob_protuberance", "planetary"])
@pytest.mark.sweep_cases("hob_protuberance", "internal", "planetary", "spur")
def test_attributes_of_the_format_alone_say_the_pair(name: str, tmp_path: Path) -> None:
    """A file that another program hands back without our attributes gives the same pair, apart from the positions of contact."""
    gears = gm.build(gm.load(SAMPLES / f"{name}.toml"))
    gears.rexs(tmp_path).save(tmp_path / "own.rexs")
    model = read_rexs(tmp_path / "own.rexs")
    for component in model.components:
        for id in [id for id in component.attributes if id.startswith(OWN_PREFIX)]:
            del component.attributes[id]
    (tmp_path / "foreign.rexs").write_bytes(rexs_bytes(model, "foreign.rexs"))
    same_contact(gears, gm.build(gm.load_rexs(tmp_path / "foreign.rexs").design))


@pytest.mark.sweep
def test_results_of_loaded_contact_are_a_load_case(tmp_path: Path) -> None:
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    gears.rexs(tmp_path, torque=80.0).save(tmp_path / "gears.rexs")
    reading = gm.load_rexs(tmp_path / "gears.rexs")
    torques = {one.gear: one.torque_Nm for one in reading.torques}
    ratio = gears.design.gear.teeth / gears.design.pinion.teeth
    assert next(iter(torques.values())) == 80.0
    assert list(torques.values())[1] == pytest.approx(80.0 * ratio, rel=1e-3)
    (case,) = read_rexs(tmp_path / "gears.rexs").load_cases
    rows = gears.loaded_contact(80.0).rows
    written = {id: float(str(one.text)) for id, one in case.components[0].attributes.items()}
    assert written[f"{OWN_PREFIX}largest_contact_pressure"] == pytest.approx(
        max(row.peak_pressure for row in rows), rel=1e-6
    )
    te = [row.te for row in rows]
    assert written[f"{OWN_PREFIX}loaded_transmission_error_peak_to_peak"] == pytest.approx(
        (max(te) - min(te)) / 3600.0, rel=1e-6
    )


def test_a_pinned_set_is_the_same_in_python_as_from_its_file() -> None:
    """Profile shifts of the set that the pin states were chosen anew, as if they had been left out."""
    gears = gm.build(gm.load(SAMPLES / "planetary.toml"))
    again = gm.build(gears.pin().design)
    bodies = [one.train.members["ring"].plain_body.profile for one in (gears, again)]
    assert bodies[0] == bodies[1]


@pytest.mark.quick
def test_kinds_that_the_format_has_not_are_refused() -> None:
    with pytest.raises(DesignError, match='kind = rack: REXS has no such stage; allowed is "cylindrical"'):
        gm.build(gm.load(SAMPLES / "rack.toml")).rexs()


def test_a_relief_that_another_program_gives_by_its_length(tmp_path: Path) -> None:
    """Its start in closed form: the roll length at the tip less the length."""
    gears = gm.build(gm.load(SAMPLES / "spur_relieved.toml"))
    gears.rexs(tmp_path).save(tmp_path / "gears.rexs")
    model = read_rexs(tmp_path / "gears.rexs")
    reliefs = [one for one in model.components if one.type == "tip_relief"]
    assert reliefs
    for one in reliefs:
        del one.attributes["tip_relief_datum_diameter"]
        one.attributes["tip_relief_datum_length"] = one.attributes["tip_relief_depth"].__class__(
            "tip_relief_datum_length", "2.5", "mm"
        )
    reliefs[-1].attributes["shape_of_relief"].text = "logarithmic"
    (tmp_path / "other.rexs").write_bytes(rexs_bytes(model, "other.rexs"))
    reading = gm.load_rexs(tmp_path / "other.rexs")
    design = reading.design
    tip, base = (
        design.pinion.tip_diameter,
        design.module * design.pinion.teeth * math.cos(math.radians(design.pressure_angle)),
    )
    roll = 0.5 * math.sqrt(tip**2 - base**2) - 2.5
    assert design.pinion.modifications.tip_relief.start_diameter == pytest.approx(
        math.hypot(base, 2.0 * roll), rel=1e-12
    )
    assert any("not used: a design has no such tip_relief" in warning for warning in reading.warnings)
