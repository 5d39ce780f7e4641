"""Forms of REXS files, versions 1.0 to 1.7: files made by hand, and the designs that they must be."""

from __future__ import annotations

import base64
import math
import struct
from pathlib import Path
from typing import Any

import pytest
from exchange.gearboxes import Gearbox, add_gear, add_tool, helical_pair
from exchange.rexs_validation import faults

import gearmesh as gm
from gearmesh import DesignError, system
from gearmesh.exchange.model import READ_VERSIONS
from gearmesh.exchange.rexs_file import read_rexs, rexs_bytes
from gearmesh.exchange.stage import StageReader
from gearmesh.systems.system import kinds

SERIES = "tooth_thickness_deviation_tolerance_series_din_3967_1978"
FIELD = "center_distance_tolerance_field_din_3964_1980"
ENDS = "upper_center_distance_allowance", "lower_center_distance_allowance"
FORMS = (".rexs", ".rexsj", ".rexsz", ".rexs.xml", ".rexs.json", ".rexs.zip")


def read_stage(file: Path, id: str | None = None) -> tuple[dict[str, Any], str]:
    """Keys of the design of a stage, the first one if no `id` says which, and the notes; the design is not made."""
    model = read_rexs(file)
    stages = [one for one in model.components if one.type.endswith("_stage")]
    reader = StageReader(str(file), model, next(one for one in stages if id in (None, one.id)))
    forms = [form for kind in kinds() if (form := system(kind).rexs) is not None and reader.stage.type in form.stages]
    form = next(form for form in forms if form.is_of(reader))
    return form.read(reader), "; ".join(reader.notes)


def keys_of(box: Gearbox, folder: Path, suffix: str = ".rexs", stage: str | None = None) -> dict[str, Any]:
    return read_stage(box.write(folder, suffix), stage)[0]


def notes_of(box: Gearbox, folder: Path, stage: str | None = None) -> str:
    return read_stage(box.write(folder), stage)[1]


PAIR = {
    "kind": "cylindrical", "units": "mm", "name": "first stage", "module": 2.0, "pressure_angle": 20.0, "helix_angle": 12.0,
    "hand": "right", "pinion.teeth": 19, "gear.teeth": 41, "assembly.center_distance": 63.0,
    "assembly.center_distance_allowance": "js7", "material.density": 7800.0,
    **{f"{name}.{key}": value for name in ("pinion", "gear") for key, value in {
        "internal": False, "face_width": 20.0, "dedendum": 1.4, "tool_tip_radius": 0.3, "hob.protuberance": 0.1,
        "hob.protuberance_angle": 10.0, "hob.stock": 0.1, "thickness_allowance.series": "cd25",
        "material.youngs_modulus": 210000.0, "material.poisson_ratio": 0.29,
    }.items()},
    "pinion.profile_shift": 0.35, "gear.profile_shift": 0.05,
}  # fmt: skip


@pytest.mark.quick
@pytest.mark.parametrize("version", READ_VERSIONS)
def test_a_pair_of_every_version_and_form_is_the_same_design(version: str, tmp_path: Path) -> None:
    for suffix in FORMS:
        assert read_stage(helical_pair(version).write(tmp_path, suffix)) == (PAIR, ""), suffix


@pytest.mark.quick
@pytest.mark.parametrize("by", ["reference", "ordered_reference", "assembly", "ordered_assembly"])
def test_tools_of_gears_by_every_relation(by: str, tmp_path: Path) -> None:
    assert keys_of(helical_pair("1.4", by), tmp_path) == PAIR
    assert keys_of(helical_pair("1.4", by, of_flank=True), tmp_path) == PAIR


@pytest.mark.parametrize("version", ["1.0", "1.4"])
@pytest.mark.sweep_cases("1.4")
def test_a_file_of_an_earlier_version_is_written_as_a_valid_one(version: str, tmp_path: Path) -> None:
    box = helical_pair(version)
    if version == "1.0":
        # of the wheel the file has a stock and no tool
        box.relations = [one for one in box.relations if one[0] != "ordered_reference" or ("origin", 4) in one[2]]
    gm.load_rexs(box.write(tmp_path)).save(tmp_path / "pair.toml")
    export = gm.build(gm.load(tmp_path / "pair.toml", ["gear.face_width=19"])).rexs(tmp_path)
    for suffix in (".rexs", ".rexsj"):
        export.save(tmp_path / f"new{suffix}")
        assert faults(tmp_path / f"new{suffix}") == []
        again, _ = read_stage(tmp_path / f"new{suffix}")
        same = [
            key
            for key in PAIR
            if version != "1.0" or ("gear.hob" not in key and key not in ("gear.dedendum", "gear.tool_tip_radius"))
        ]
        assert {key: again[key] for key in same} == {key: {**PAIR, "gear.face_width": 19.0}[key] for key in same}
        assert "gear.hob.stock" in again or version == "1.0"


@pytest.mark.quick
def test_helix_angles_of_versions_without_their_sign(tmp_path: Path) -> None:
    for version in READ_VERSIONS:
        box = helical_pair(version)
        box.change("wheel", helix_angle_reference_diameter=(12.0, "deg"))
        if version < "1.3":
            assert keys_of(box, tmp_path) == PAIR
            assert "have no sign: the hand of cylindrical_gear 4 is taken as right" in notes_of(box, tmp_path)
        else:
            with pytest.raises(DesignError, match=r'"wheel": helix_angle_reference_diameter = 12[.]0: must be -12'):
                keys_of(box, tmp_path)


@pytest.mark.quick
def test_values_in_all_units_of_the_format(tmp_path: Path) -> None:
    radians = math.radians(12.0)
    box = helical_pair()
    box.change("first stage", center_distance=(63000.0, "mum"))
    box.change(
        "pinion", helix_angle_reference_diameter=(radians, "rad"), normal_module=(2.0, "mm"), face_width=(20000, "mum")
    )
    box.change("steel", elastic_modulus=(210000.0, "MPa"))
    keys = keys_of(box, tmp_path)
    assert keys == {
        key: pytest.approx(value, rel=1e-12) if isinstance(value, float) else value for key, value in PAIR.items()
    }
    box.change("steel", elastic_modulus=(2.1e11, "Pa"))
    assert keys_of(box, tmp_path)["gear.material.youngs_modulus"] == pytest.approx(210000.0)
    box.change("pinion", face_width=(2, "kg"))
    with pytest.raises(DesignError, match='"pinion": face_width: must be in mm, mum, is in kg'):
        keys_of(box, tmp_path)


def internal_pair(
    *, type: str = "ring_gear", teeth: int = 70, a: float = 48.0, x: float = 0.0, d: float = 138.0
) -> Gearbox:
    box = Gearbox("1.5")
    stage = box.add("cylindrical_stage", "", center_distance=(a, "mm"))
    pinion, _ = add_gear(box, "cylindrical_gear", "pinion", 22, 0.0, {"addendum_modification_coefficient": 0.4})
    diameters = {"tip_diameter": (d, "mm"), "root_diameter": (d + 9.0, "mm")}
    ring, _ = add_gear(box, type, "ring", teeth, 0.0, {"addendum_modification_coefficient": x}, **diameters)
    box.relate("stage", stage=stage, gear_1=pinion, gear_2=ring)
    return box


def shift_of_ring(a: float) -> float:
    """x2 of 22/-70, m 2, x1 = 0.4 without backlash at a centre distance, positive towards the ring's tip [ISO 21771]."""
    alpha, teeth = math.radians(20.0), 22 - 70
    working = math.acos(-teeth * math.cos(alpha) / a)
    involutes = math.tan(working) - working - math.tan(alpha) + alpha
    return teeth * involutes / (2.0 * math.tan(alpha)) - 0.4


@pytest.mark.quick
def test_rings_in_every_convention(tmp_path: Path) -> None:
    x = shift_of_ring(47.5)
    plain = keys_of(internal_pair(a=47.5, x=x), tmp_path)
    assert (plain["gear.teeth"], plain["gear.internal"], plain["gear.tip_diameter"]) == (70, True, 138.0)
    assert plain["gear.profile_shift"] == pytest.approx(x)
    for type, teeth, sign in (("ring_gear", -70, 1), ("cylindrical_gear", -70, -1), ("ring_gear", 70, -1)):
        box = internal_pair(type=type, teeth=teeth, a=sign * 47.5, x=x, d=138.0)
        box.change("ring", tip_diameter=(sign * 138.0, "mm"), root_diameter=(sign * 147.0, "mm"))
        assert keys_of(box, tmp_path) == plain
    # profile shift counted away from the axis: the centre distance fits that one alone
    box = internal_pair(a=47.5, x=-x)
    assert keys_of(box, tmp_path)["gear.profile_shift"] == pytest.approx(x)
    assert "counts its profile shift away from the axis" in notes_of(box, tmp_path)


def planetary(
    version: str = "1.1",
    *,
    per_planet: bool = True,
    parts: bool = True,
    places: bool = True,
    angles: Any = (0, 120, 240),
) -> Gearbox:
    """A set 18/27/-72: two meshes for each planet, or for one of them; its meshes as `parts`, its planets in their `places`."""
    box = Gearbox(version)
    stage = box.add("planetary_stage", "set")
    plain: dict[str, Any] = {"addendum_modification_coefficient": 0.0}
    frame = {"reference_component_for_position": 1, "u_axis_vector": ([1.0, 0.0, 0.0], "mm")}
    here = {**frame, "support_vector": ([10.0, 0.0, 0.0], "mm")} if places else {}
    sun, _ = add_gear(box, "cylindrical_gear", "sun", 18, 0.0, plain, **here)
    ring, flanks = add_gear(box, "ring_gear", "ring", 72, 0.0, plain, **here)
    height = {"addendum_coefficient_reference_profile": 1.25}
    cutter = box.add("cutter_wheel_tool", "cutter", number_of_teeth=25, tip_radius_factor=0.0, **height)
    add_tool(box, ring, flanks, cutter, "ordered_reference" if version < "1.3" else "manufacturing_step")
    for number, angle in enumerate(angles, start=1):
        shaft = box.add("shaft", f"shaft {number}")
        box.relate("planet_shaft", planetary_stage=stage, shaft=shaft)
        if number > 1 and not per_planet:
            continue
        turned = math.radians(angle)
        place = (
            {**frame, "support_vector": ([10.0, 45.0 * math.cos(turned), 45.0 * math.sin(turned)], "mm")}
            if places
            else {}
        )
        planet, _ = add_gear(box, "cylindrical_gear", f"planet {number}", 27, 0.0, plain, **place)
        box.relate("assembly", assembly=shaft, part=planet)
        for roles in ({"gear_1": sun, "gear_2": planet}, {"gear_1": planet, "gear_2": ring}):
            mesh = box.add("cylindrical_stage", "", center_distance=(45.0, "mm"))
            box.relate("stage", stage=mesh, **roles)
            if parts:
                box.relate("assembly", assembly=stage, part=mesh)
    return box


SET = {
    "kind": "planetary", "units": "mm", "name": "set", "module": 2.0, "pressure_angle": 20.0, "helix_angle": 0.0, "hand": "right",
    "planets": 3, "assembly.center_distance": 45.0, "ring.shaper.teeth": 25, "ring.shaper.addendum": 1.25,
    "ring.shaper.profile_shift": 0.0, "ring.tool_tip_radius": 0.0,
    **{f"{name}.{key}": value for name in ("sun", "planet", "ring") for key, value in {
        "teeth": {"sun": 18, "planet": 27, "ring": 72}[name], "internal": name == "ring", "face_width": 20.0, "profile_shift": 0.0,
    }.items()},
}  # fmt: skip


@pytest.mark.quick
@pytest.mark.parametrize("version", ["1.1", "1.3", "1.7"])
def test_planetary_sets_in_every_form(version: str, tmp_path: Path) -> None:
    for per_planet in (True, False):
        for suffix in (".rexs", ".rexsj"):
            assert keys_of(planetary(version, per_planet=per_planet), tmp_path, suffix, "1") == SET
        # meshes that only their gears' shafts tell to be of the set
        assert keys_of(planetary(version, per_planet=per_planet, parts=False), tmp_path, stage="1") == SET
        assert keys_of(planetary(version, per_planet=per_planet, places=False), tmp_path, stage="1") == SET
    # a ring that only its number of teeth tells to be one
    box = planetary(version)
    box.components = [
        ("cylindrical_gear" if type == "ring_gear" else type, name, one) for type, name, one in box.components
    ]
    box.change("ring", number_of_teeth=-72)
    assert keys_of(box, tmp_path, stage="1") == SET


@pytest.mark.quick
def test_planets_that_are_not_evenly_spaced(tmp_path: Path) -> None:
    # (18 + 72) / 360 teeth a degree: whole numbers at multiples of 4 deg
    uneven = keys_of(planetary(angles=(40, 176, 272)), tmp_path, stage="1")
    assert uneven == {**SET, "assembly.planet_angles": "0, 136, 232"}
    assert gm.load_rexs(tmp_path / "gearbox.rexs", "1").design.angles == [0.0, 136.0, 232.0]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("name", "change", "why"),
    [
        (
            "planet 2",
            {"number_of_teeth": 26},
            r'cylindrical_gear \d+ "planet 2": teeth = 26: all planets must be alike: cylindrical_gear \d+ "planet 1"',
        ),
        ("planet 3", {"face_width": (19.0, "mm")}, r'"planet 3": face_width = 19.0: all planets must be alike'),
        (
            "planet 1",
            {"normal_module": (2.5, "mm")},
            r'"planet 1": normal_module = 2.5: must be 2 mm, as the mating gear, cylindrical_gear 2 "sun"',
        ),
        ("sun", {"number_of_teeth": None}, r'cylindrical_gear 2 "sun": number_of_teeth: missing'),
    ],
)
def test_sets_that_are_none_are_refused(name: str, change: dict[str, Any], why: str, tmp_path: Path) -> None:
    box = planetary()
    box.change(name, **change)
    with pytest.raises(DesignError, match=why):
        keys_of(box, tmp_path, stage="1")


@pytest.mark.quick
def test_sets_without_a_mesh_or_with_two_suns_are_refused(tmp_path: Path) -> None:
    box = planetary()
    outer = {dict(refs)["stage"] for type, _, refs in box.relations if type == "stage" and ("gear_2", 5) in refs}
    box.relations = [one for one in box.relations if one[0] != "assembly" or dict(one[2])["part"] not in outer]
    with pytest.raises(
        DesignError, match='planetary_stage 1 "set": has 3 cylindrical stages without a ring gear and 0 with one'
    ):
        keys_of(box, tmp_path, stage="1")
    box = planetary()
    other, _ = add_gear(box, "cylindrical_gear", "other sun", 18, 0.0, {})
    last = max(
        number for number, (type, _, refs) in enumerate(box.relations) if type == "stage" and ("gear_1", 2) in refs
    )
    box.relations[last][2][:] = [(role, other if id == 2 else id) for role, id in box.relations[last][2]]
    two = f'cylindrical_gear 2 "sun", cylindrical_gear {other} "other sun"'
    with pytest.raises(DesignError, match=f"with one sun; this one has {two}"):
        keys_of(box, tmp_path, stage="1")


def test_a_set_with_a_mesh_for_each_planet_is_written_whole(tmp_path: Path) -> None:
    gm.load_rexs(planetary().write(tmp_path), "1").save(tmp_path / "set.toml")
    gears = gm.build(
        gm.load(tmp_path / "set.toml", ["planet.face_width=18", "planet.modifications.helix_crowning=0.004"])
    )
    gears.rexs(tmp_path).save(tmp_path / "new.rexs")
    assert faults(tmp_path / "new.rexs") == []
    model = read_rexs(tmp_path / "new.rexs")
    planets = [one for one in model.components if one.type == "cylindrical_gear" and one.name != "sun"]
    assert [one.attributes["face_width"].text for one in planets] == 3 * ["18.0"]
    assert len({str(one.attributes["support_vector"].text) for one in planets}) == 3
    again, _ = read_stage(tmp_path / "new.rexs", "1")
    assert {key: again[key] for key in SET} == {
        **SET,
        "planet.face_width": 18.0,
        "ring.profile_shift": again["ring.profile_shift"],
    }
    assert again["planet.modifications.helix_crowning"] == 0.004
    with pytest.raises(DesignError, match="planets = 2: must be 3, as in the REXS file"):
        gm.build(gm.load(tmp_path / "set.toml", ["planets=2"])).rexs(tmp_path)


def worm(version: str = "1.4") -> Gearbox:
    """A drive 2/41 of module 4, in the names of a version."""
    box = Gearbox(version)
    end = "_din_3975_2017"
    names = {
        "axial_module": f"axial_module{end}", "flank_form": f"flank_form{end}",
        "reference_diameter_worm_gear": f"reference_diameter{end}",
        "pressure_angle_worm_gear": f"pressure_angle{end}", "lead_angle_worm_gear": f"reference_lead_angle{end}",
        "tip_diameter_worm_gear": f"tip_diameter{end}", "root_diameter_worm_gear": f"root_diameter{end}",
        "face_width_worm_wheel": f"face_width{end}", "outer_diameter_worm_wheel": f"outer_diameter{end}",
    } if version == "1.2" else {}  # fmt: skip

    def named(**attributes: Any) -> dict[str, Any]:
        return {names.get(id, id): value for id, value in attributes.items()}

    stage = box.add("worm_stage", "drive", center_distance=(101.0, "mm"))
    angle = (-math.degrees(math.atan(2 * 4 / 36)), "deg")
    screw = box.add(
        "worm_gear", "worm", number_of_teeth=2,
        **named(axial_module=(4.0, "mm"), flank_form="zi", pressure_angle_worm_gear=(20.0, "deg"), lead_angle_worm_gear=angle,
                reference_diameter_worm_gear=(36.0, "mm"), tip_diameter_worm_gear=(44.0, "mm"),
                root_diameter_worm_gear=(26.4, "mm")),
    )  # fmt: skip
    wheel = box.add(
        "worm_wheel", "wheel", number_of_teeth=41, throat_radius_worm_wheel=(0.0, "mm"),
        **named(reference_diameter_worm_gear=(164.0, "mm"), tip_diameter_worm_gear=(173.6, "mm"),
                root_diameter_worm_gear=(156.0, "mm"), face_width_worm_wheel=(30.0, "mm"), outer_diameter_worm_wheel=(0.0, "mm")),
    )  # fmt: skip
    box.relate("stage", stage=stage, gear_1=screw, gear_2=wheel)
    return box


WORM = {
    "kind": "worm_drive", "units": "mm", "name": "drive", "module": 4.0, "module_section": "axial", "pressure_angle": 20.0,
    "center_distance": 101.0, "worm.threads": 2, "worm.form": "ZI", "worm.reference_diameter": 36.0, "worm.right_hand": False,
    "worm.addendum": 1.0, "worm.dedendum": 1.2, "wheel.teeth": 41, "wheel.face_width": 30.0,
    # x2 = (101 - 18 - 82) / 4 = 0.25; (173.6 - 164) / 8 - 0.25; (164 - 156) / 8 + 0.25
    "wheel.addendum": 0.95, "hob.addendum": 1.25,
}  # fmt: skip


@pytest.mark.quick
@pytest.mark.parametrize("version", READ_VERSIONS[2:])
def test_worm_drives_of_every_version(version: str, tmp_path: Path) -> None:
    for suffix in (".rexs", ".rexsj"):
        assert keys_of(worm(version), tmp_path, suffix) == WORM
    if version > "1.2":
        box = worm(version)
        others = {"effective_face_width_worm_wheel": (30.0, "mm"), "rim_width_worm_wheel": (34.0, "mm")}
        box.change("wheel", face_width_worm_wheel=None, **others)
        assert keys_of(box, tmp_path) == WORM
        assert "effective_face_width_worm_wheel is taken" in notes_of(box, tmp_path)
        hob = box.add("worm_wheel_hob_tool", "hob", tooth_addendum_worm_wheel_hob=(4.8, "mm"), number_of_teeth=2)
        box.relate("reference", origin=3, referenced=hob)
        assert keys_of(box, tmp_path) == {**WORM, "hob.addendum": 1.2, "hob.threads": 2}


@pytest.mark.quick
@pytest.mark.parametrize("version", READ_VERSIONS)
def test_bevel_stages_of_every_version(version: str, tmp_path: Path) -> None:
    box = Gearbox(version)
    stage = box.add(
        "bevel_stage", "axle", shaft_angle=(90.0, "deg"), hypoid_offset=(0.0, "mm"), outer_transverse_module=(4.0, "mm"),
        cutter_radius=(76.2, "mm"), nominal_design_pressure_angle_drive=(20.0, "deg"),
    )  # fmt: skip
    gears = [
        box.add("bevel_gear", name, number_of_teeth=teeth, face_width=(25.0, "mm"), mean_spiral_angle=(angle, "deg"))
        for name, teeth, angle in (("gear", 43, 35.0), ("pinion", 14, -35.0))
    ]
    box.relate("stage", stage=stage, gear_1=gears[0], gear_2=gears[1])
    wanted = {
        "kind": "spiral_bevel", "units": "mm", "name": "axle", "module": 4.0, "shaft_angle": 90.0, "pressure_angle": 20.0,
        "spiral_angle": 35.0, "hand": "left", "face_width": 25.0, "pinion.teeth": 14, "gear.teeth": 43,
        "gear.cutter.tip_radius": 76.2,
    }  # fmt: skip
    for suffix in (".rexs", ".rexsj"):
        assert keys_of(box, tmp_path, suffix) == wanted
    box.change("axle", hypoid_offset=(15.0, "mm"))
    box.change("pinion", spiral_angle_pitch_direction="left")
    assert keys_of(box, tmp_path) == {**wanted, "kind": "hypoid", "offset": 15.0}


@pytest.mark.quick
def test_allowances_of_the_centre_distance(tmp_path: Path) -> None:
    # IT7 of 50 to 80 mm: 30 mum
    for upper, lower in (
        ((15.0, "mum"), (-15.0, "mum")),
        ((15.0, "mum"), (15.0, "mum")),
        ((0.015, "mm"), (-0.015, "mm")),
    ):
        box = helical_pair()
        box.change("first stage", **{FIELD: None, **dict(zip(ENDS, (upper, lower), strict=True))})
        assert keys_of(box, tmp_path) == PAIR
    box.change("first stage", upper_center_distance_allowance=(20.0, "mum"))
    assert "assembly.center_distance_allowance" not in keys_of(box, tmp_path)
    assert "20 and 15 mum are no class of DIN 3964" in notes_of(box, tmp_path)


@pytest.mark.quick
def test_js7_is_written_as_the_format_has_it(tmp_path: Path) -> None:
    """Both amounts are above 0 in the format: 63 mm, js7: 15 mum either way."""
    gm.build(gm.load(helical_design(tmp_path))).rexs(tmp_path).save(tmp_path / "new.rexs")
    assert faults(tmp_path / "new.rexs") == []
    stage = next(one for one in read_rexs(tmp_path / "new.rexs").components if one.type == "cylindrical_stage")
    ends = {
        id: (float(str(one.text)), one.unit)
        for id, one in stage.attributes.items()
        if id.endswith("_distance_allowance")
    }
    assert ends == {"upper_center_distance_allowance": (15.0, "mum"), "lower_center_distance_allowance": (15.0, "mum")}
    assert stage.attributes[FIELD].text == "7"
    assert not any("center_distance_allowance" in id for id in stage.attributes if id.startswith("custom_"))


def helical_design(folder: Path) -> Path:
    return gm.load_rexs(helical_pair().write(folder)).save(folder / "pair.toml")


@pytest.mark.quick
def test_thickness_and_tip_tolerances(tmp_path: Path) -> None:
    box = helical_pair()
    deviations = (("upper", -0.05), ("lower", -0.09))
    box.change("pinion", **{f"chordal_tooth_thickness_{end}_deviation": (value, "mm") for end, value in deviations})
    box.change(
        "pinion", tip_diameter=(43.5, "mm"), maximum_tip_diameter=(43.5, "mm"), minimum_tip_diameter=(43.461, "mm")
    )
    keys = keys_of(box, tmp_path)
    # the deviations are not those of cd25: they count, and the series does not
    assert "pinion.thickness_allowance.series" not in keys
    assert (keys["pinion.thickness_allowance.upper"], keys["pinion.thickness_allowance.lower"]) == (-0.05, -0.09)
    assert "= cd25 is not used: the deviations in the file are others" in notes_of(box, tmp_path)
    assert (keys["pinion.tip_diameter_tolerance.upper"], keys["pinion.tip_diameter_tolerance.lower"]) == (0.0, -0.039)
    gm.load_rexs(box.write(tmp_path)).save(tmp_path / "pair.toml")
    gm.build(gm.load(tmp_path / "pair.toml")).rexs(tmp_path).save(tmp_path / "new.rexs")
    assert faults(tmp_path / "new.rexs") == []
    again, _ = read_stage(tmp_path / "new.rexs")
    assert {key: again[key] for key in keys} == keys


@pytest.mark.quick
def test_zeros_that_stand_for_nothing_given(tmp_path: Path) -> None:
    box = helical_pair()
    box.change("pinion", tip_diameter=(0.0, "mm"), face_width=(0.0, "mm"), helix_angle_base_circle=(0.0, "deg"))
    box.change("first stage", common_face_width=(20.0, "mm"))
    box.change("steel", elastic_modulus=(0.0, "N / mm^2"), density=(0.0, "kg / dm^3"))
    material = {f"{name}.material.youngs_modulus" for name in ("pinion", "gear")} | {"material.density"}
    assert keys_of(box, tmp_path) == {key: value for key, value in PAIR.items() if key not in material}
    assert "no face_width in the file: common_face_width of the stage is taken" in notes_of(box, tmp_path)
    # a rounding of 0 is one: the tool has a sharp edge
    box.change("hob", tip_radius_factor=0.0)
    assert keys_of(box, tmp_path)["pinion.tool_tip_radius"] == 0.0
    box.change("first stage", center_distance=(0.0, "mm"))
    assert "assembly.center_distance" not in keys_of(box, tmp_path)
    box.change("pinion", normal_module=(0.0, "mm"))
    with pytest.raises(DesignError, match=r'cylindrical_gear 4 "pinion": normal_module: must be above 0'):
        keys_of(box, tmp_path)


@pytest.mark.quick
def test_tools_that_are_there_and_not_used(tmp_path: Path) -> None:
    assert "no tool in the file" not in notes_of(helical_pair(), tmp_path)
    box = helical_pair()
    box.components[1] = ("zero_degree_grinding_disk_tool", "disk", {})
    assert 'zero_degree_grinding_disk_tool 2 "disk" generates no root' in notes_of(box, tmp_path)
    box = helical_pair()
    box.change("hob", normal_module=(2.25, "mm"))
    assert 'rack_shaped_tool 2 "hob" is not used: normal_module = 2.25 is not the gear\'s, 2' in notes_of(box, tmp_path)
    box = helical_pair()
    box.relations = [one for one in box.relations if one[0] != "manufacturing_step"]
    assert "cylindrical_gear 4: no tool in the file" in notes_of(box, tmp_path)
    box = internal_pair()
    rack = box.add("rack_shaped_tool", "rack", addendum_reference_profile=(2.4, "mm"), tip_radius=(0.5, "mm"))
    box.relate("reference", origin=5, referenced=rack)
    keys = keys_of(box, tmp_path)
    assert (keys["gear.dedendum"], keys["gear.tool_tip_radius"]) == (1.2, 0.25)
    assert 'rack_shaped_tool 8 "rack" cannot cut an internal gear' in notes_of(box, tmp_path)


@pytest.mark.quick
def test_other_figures_of_the_toothing(tmp_path: Path) -> None:
    """Module, angles and heights by the other attributes that the format has for them."""
    beta, alpha = math.radians(12.0), math.radians(20.0)
    transverse = math.atan(math.tan(alpha) / math.cos(beta))
    base = math.degrees(math.asin(math.sin(beta) * math.cos(alpha)))
    sizes = {
        "transverse_module": 2.0 / math.cos(beta),
        "normal_circular_pitch": 2.0 * math.pi,
        "axial_module": 2.0 / math.sin(beta),
    }
    for id, size in sizes.items():
        box = helical_pair()
        box.change("pinion", normal_module=None, **{id: (size, "mm")})
        assert keys_of(box, tmp_path)["module"] == pytest.approx(2.0, rel=1e-12)
    box = helical_pair()
    for name, sign in (("pinion", 1), ("wheel", -1)):
        box.change(name, helix_angle_reference_diameter=None, helix_angle_base_circle=(sign * base, "deg"))
    assert keys_of(box, tmp_path)["helix_angle"] == pytest.approx(12.0, rel=1e-12)
    box = helical_pair()
    for type, _, one in box.components:
        if type == "cylindrical_gear_flank":
            one["pressure_angle_in_the_transverse_section"] = (math.degrees(transverse), "deg")
            one["addendum_modification"] = (2.0 * one.pop("addendum_modification_coefficient"), "mm")
            del one["normal_pressure_angle"]
    keys = keys_of(box, tmp_path)
    assert (keys["pressure_angle"], keys["pinion.profile_shift"]) == (pytest.approx(20.0, rel=1e-12), 0.35)


@pytest.mark.quick
def test_encoded_positions_and_places_of_the_gears(tmp_path: Path) -> None:
    box = helical_pair()
    for name, place in (("pinion", 4.0), ("wheel", 6.5)):
        box.change(name, support_vector=([place, 0.0, 0.0], "mm"), u_axis_vector=([2.0, 0.0, 0.0], "none"))
    plain = box.xml()
    assert keys_of(box, tmp_path) == {**PAIR, "assembly.dz": 2.5}
    for code, form in (("float64", "<3d"), ("float32", "<3f"), ("int32", "<3i")):
        packed = base64.b64encode(
            struct.pack(form, *(int(one) if code == "int32" else one for one in (4.0, 0.0, 0.0)))
        ).decode()
        text = plain.replace("<array><c>4.0</c><c>0.0</c><c>0.0</c></array>", f'<array code="{code}">{packed}</array>')
        assert text != plain
        (tmp_path / "coded.rexs").write_text(text, encoding="utf-8")
        assert read_stage(tmp_path / "coded.rexs")[0] == {**PAIR, "assembly.dz": 2.5}
    spoilt_ones = {
        'code="int32">AA': "not base64 text of int32 numbers",
        'code="int8">': "must be one of float64, float32, int32",
    }
    for spoilt, why in spoilt_ones.items():
        (tmp_path / "coded.rexs").write_text(text.replace('code="int32">', spoilt), encoding="utf-8")
        with pytest.raises(DesignError, match=f'cylindrical_gear 4 "pinion": support_vector.*{why}'):
            read_stage(tmp_path / "coded.rexs")


@pytest.mark.quick
def test_values_of_another_type_in_json(tmp_path: Path) -> None:
    """Attributes as a program writes them: numbers for whole numbers and choices, false for values that it does not hand over."""
    box = helical_pair()
    box.change("first stage", **{FIELD: 7.0})
    box.change("pinion", number_of_teeth=19.0, support_vector=(False, "mm"))
    box.change("wheel", **{SERIES: False}, tip_diameter=("", "mm"))
    keys, notes = read_stage(box.write(tmp_path, ".rexsj"))
    assert keys == {key: value for key, value in PAIR.items() if key != "gear.thickness_allowance.series"}
    assert f"{SERIES}: a boolean is no value of this attribute and is not used" in notes


@pytest.mark.quick
@pytest.mark.parametrize(
    ("name", "change", "why"),
    [
        (
            "pinion",
            {"helix_angle_reference_diameter": (95.0, "deg")},
            'cylindrical_gear 4 "pinion": helix_angle_reference_diameter = 95.0 deg: must be between -90 and 90 deg',
        ),
        (
            "pinion",
            {"inner_diameter": (-3.0, "mm")},
            'cylindrical_gear 4 "pinion": inner_diameter = -3.0 mm: must be at least 0 mm',
        ),
        ("wheel", {SERIES: "x1"}, f'cylindrical_gear 9 "wheel": {SERIES} = x1: must be one of a21 to h30'),
        (
            "first stage",
            {FIELD: "4"},
            f'cylindrical_stage 1 "first stage": {FIELD} = 4: must be one of 5, 6, 7, 8, 9, 10, 11',
        ),
        (
            "hob",
            {"tip_radius_factor": 3.0},
            'rack_shaped_tool 2 "hob": tip_radius_factor = 3.0: as a design, .*tool_tip_radius = 3.0: must be',
        ),
        (
            "steel",
            {"poisson_ratio": 0.7},
            'material 3 "steel": poisson_ratio = 0.7: as a design, .*material.poisson_ratio = 0.7: must be',
        ),
        (
            "first stage",
            {"center_distance": (2e6, "mm")},
            'cylindrical_stage 1 "first stage": center_distance = 2000000.0 mm: as a design, assembly.center_distance',
        ),
    ],
)
def test_refusals_name_component_attribute_and_what_is_allowed(
    name: str, change: dict[str, Any], why: str, tmp_path: Path
) -> None:
    box = helical_pair()
    box.change(name, **change)
    with pytest.raises(DesignError, match=f"gearbox.rexs: {why}"):
        gm.load_rexs(box.write(tmp_path))


@pytest.mark.quick
def test_names_of_the_file_in_what_is_said_of_it(tmp_path: Path) -> None:
    """A refusal and the list of what is not used have the names of the version of the file."""
    box = helical_pair("1.0")
    box.change("pinion", din_3967_deviation_tolerance_series="x1")
    with pytest.raises(DesignError, match='"pinion": din_3967_deviation_tolerance_series = x1'):
        keys_of(box, tmp_path)
    box = helical_pair("1.0")
    for _, _, one in box.components:
        if "machining_allowance" in one:
            one["machining_allowance_tolerance"] = (0.0, "mm")
    unused = {(one.component, one.attribute) for one in gm.load_rexs(box.write(tmp_path)).unused}
    assert unused == {(f"flank_geometry {id}", "machining_allowance_tolerance") for id in (5, 6, 8, 9)}


@pytest.mark.quick
def test_the_datum_face_at_either_end(tmp_path: Path) -> None:
    """The relief at the datum face is that of the toe, or of the heel where the datum face lies at the positive end."""
    for orientation, end in ((None, "toe"), ("negative", "toe"), ("positive", "heel")):
        box = helical_pair()
        box.change("pinion", datum_face_orientation=orientation)
        relief = box.add(
            "end_relief_datum_face",
            "relief",
            end_relief_depth_datum_face=(0.01, "mm"),
            end_relief_length_datum_face=(4.0, "mm"),
        )
        none = box.add("tip_relief", "none", tip_relief_depth=(0.0, "mm"), tip_relief_datum_diameter=(0.0, "mm"))
        for flank in (5, 6):
            box.relate("reference", origin=flank, referenced=relief)
            box.relate("reference", origin=flank, referenced=none)
        keys, notes = read_stage(box.write(tmp_path))
        stem = f"pinion.modifications.end_relief_{end}"
        assert keys == {**PAIR, f"{stem}.amount": 0.01, f"{stem}.length": 4.0}
        assert not notes


@pytest.mark.quick
def test_several_load_spectra_stay(tmp_path: Path) -> None:
    file = helical_pair().write(tmp_path)
    case = '<load_case id="1"><component id="1"><attribute id="custom_a" unit="none">{}</attribute></component></load_case>'
    spectra = "".join(f'<load_spectrum id="{id}">{case.format(id)}</load_spectrum>' for id in (1, 2))
    file.write_text(file.read_text(encoding="utf-8").replace("</model>", f"{spectra}</model>"), encoding="utf-8")
    model = read_rexs(file)
    assert [(one.spectrum, one.id) for one in model.load_cases] == [("1", "1"), ("2", "1")]
    (tmp_path / "again.rexs").write_bytes(rexs_bytes(model, "again.rexs"))
    assert read_rexs(tmp_path / "again.rexs") == model
    with pytest.raises(DesignError, match="JSON has one load spectrum, the model has 2"):
        rexs_bytes(model, "again.rexsj")
