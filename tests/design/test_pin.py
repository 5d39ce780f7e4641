"""Pinned designs build the same gears, hold every default, and go on to when defaults and rules have changed."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.command_line import run
from oracles.places import SAMPLES
from oracles.same_gears import places

import gearmesh as gm
from gearmesh.answers.load.members import mounts_of
from gearmesh.kinds import Table

#: keys whose values face hobbing derives
HOBBED_RESULT = re.compile(r"(pinion\.con|gear\.cutter|(pinion|gear)\.root_angle|head\.eccentricity)")
#: mm, and of rotations: what later versions may differ by
SAME = 1e-12
#: of what takes longest there is another sample, and the snapshot has its derived values
LONG = (
    *("hypoid_formate", "hypoid_high_ratio", "spiral_bevel_formate", "spiral_bevel_abdullah_straight"),
    *(
        "modified_involute",
        "beveloid_crossed",
        "beveloid_intersected",
        "spiral_bevel_geometry1",
        "spiral_bevel_geometry2",
    ),
    "zerol",
)
PATHS = [path for path in sorted(SAMPLES.glob("*.toml")) if path.stem not in LONG]
#: keys that may be absent: another one is given in their place, they name a part that is not there, or no gear depends on them
ABSENT = {
    *("module", "diametral_pitch", "transverse_module", "transverse_diametral_pitch", "transverse_pressure_angle"),
    *(
        "tip_diameter",
        "root_diameter",
        "circumferential_backlash",
        "backlash",
        "rim",
        "bore",
        "gap_diameter",
        "gap_height",
        "rho",
    ),
    *("standard", "topography", "finishing_diameter", "chamfer_diameter", "chamfer_angle", "toprem_angle"),
    *(
        "start_roll_length",
        "start_diameter",
        "start_height",
        "crowning_disk_diameter",
        "start",
        "stop",
        "ratio_derivative",
        "semi_major_axis",
    ),
    *("stiffness", "z", "thickness", "quotient", "lead_angle", "friction", "wire_diameter"),
    *("pinion_right", "pinion_left", "gear_right", "gear_left", "pinion_pitch", "gear_pitch"),
    *(f"{member}_{what}_um" for member in ("pinion", "gear") for what in ("pitch_right", "pitch_left", "runout")),
    *(f"{member}_pitch_{what}" for member in ("pinion", "gear") for what in ("class", "seed")),
    # that of the drive side
    *("coast_pressure_angle", "coast_tool_tip_radius", "coast_tip_edge"),
    # refused without a shaft thicker than the roots
    "run_out_radius",
    *("end_rounding_toe", "end_rounding_heel"),
    *("end_chamfer_toe", "end_chamfer_heel", "end_chamfer_angle", "tip_cone_angle", "tip_throat_radius"),
}
#: keys that rules which are not of the kind's file say: "that of the cutter", where there is a disk, axes that are parallel
#: and the rim of finite-element models, which is 1.2 whole depths of either member, and the elements under it
ELSEWHERE = (
    "gear.cutter.outside.",
    "gear.cutter.inside.",
    "disk.vertex",
    "assembly.center_distance",
    "fe.rim",
    "fe.body_size",
)


def absent(table: type[Table], mapping: dict[str, Any], prefix: str = "") -> Iterator[str]:
    """Keys with a default that a file leaves out, but for those that may be."""
    for name in table.names():
        field, below, key = table.model_fields[name], table.table_of(name), table.key_of(name)
        if below is not None:
            if name in mapping:
                yield from absent(below, mapping[name], f"{prefix}{name}.")
            elif field.default is not None:
                yield prefix + name
        elif key is not None and name not in (*mapping, *ABSENT) and (field.default is not None or key.default):
            yield from () if f"{prefix}{name}".startswith(ELSEWHERE) else (prefix + name,)


def pinned(gears: gm.Gears, folder: Path) -> Path:
    file = folder / "pinned.toml"
    gears.pin().save(file)
    return file


@pytest.mark.sweep_cases(
    "hypoid",
    "face_gear_conjugate",
    "spiral_bevel_basic",
    "beveloid_parallel",
    "spiral_bevel_abdullah_curved",
    "face_gear_offset",
    "face_gear",
    "hypoid_measured",
    "internal",
    "novikov",
    "worm_drive",
    "worm_drive_dual_lead",
    "worm_drive_zk_oversize",
    "circular_arc",
    "cyclo_palloid",
    "double_helical",
    "helical_hub",
    "hob_protuberance",
    "hypoid_face_hobbed",
    "planetary",
    "rack",
    "spur",
    "spur_relieved",
)
@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_pinned_samples_build_the_same_gears_and_hold_every_default(path: Path, tmp_path: Path) -> None:
    gears = gm.build(gm.load(path))
    file = pinned(gears, tmp_path)
    given = tomllib.loads(file.read_text(encoding="utf-8"))
    assert given["gearmesh"] == gm.__version__
    design = gm.load(file)
    left = set(absent(type(design), given))
    if design.kind == "spiral_bevel" and "formate" in getattr(design, "process", ""):
        left.discard("gear.cutter.ratio_of_roll")
    if getattr(design, "hobbed", False):
        # head, blank and ease-off give machines, thicknesses and blades; their roundings are kept
        left -= {key for key in left if HOBBED_RESULT.match(key) and not key.endswith("edge_radius")}
    else:
        left.discard("head")
    if design.kind == "beveloid":
        # no number says that there are no tolerances
        left.discard("accuracy_class")
    if getattr(design, "discs", 0) == 1:
        # one disc has no gap to another
        left.discard("disc_gap")
    assert not left
    same = gm.build(design)
    np.testing.assert_allclose(places(same.train), places(gears.train), rtol=0, atol=SAME)
    # what is pinned has nothing left to pin
    again = same.pin()
    assert set(again.added) <= {"gear.cutter.ratio_of_roll"}, again.added


MORE: dict[str, dict[str, Any]] = {
    "inch": {
        "kind": "cylindrical",
        "units": "inch",
        "diametral_pitch": 8,
        "helix_angle": 12,
        "pinion": {"teeth": 19, "face_width": 1, "keyway": {}, "bore": 0.8},
        "gear": {"teeth": -67, "face_width": 1, "holes": {"count": 5}},
    },
    "shafts": {
        "kind": "cylindrical",
        "module": 2,
        "assembly": {"center_distance": 64, "gamma_v": 0.01},
        "pinion": {"teeth": 18, "face_width": 20, "hob": {"protuberance": 0.05, "chamfer_diameter": 40.5}},
        "gear": {"teeth": 45, "face_width": 20, "bore": 20, "web": {"thickness": 6}, "holes": {"count": 5}},
    },
    "halves": {
        "kind": "cylindrical",
        "module": 3,
        "helix_angle": 30,
        "arrangement": "double_helical",
        "gap": 8,
        "pinion": {"teeth": 21, "face_width": 60},
        "gear": {"teeth": 51, "face_width": 60, "thickness_allowance": {"upper": -0.03, "lower": -0.05}},
    },
    "bevel_inch": {
        "kind": "spiral_bevel",
        "units": "inch",
        "module": 0.2,
        "hand": "right",
        "backlash": 0.004,
        "assembly": {"dV": 0.002, "dA": -0.003},
        "pinion": {"teeth": 14, "concave": {"path_angle": 75}},
        "gear": {"teeth": 39},
    },
    "eased": {
        "kind": "spiral_bevel",
        "module": 5,
        "taper": "duplex",
        "contact": {"ease_off": {"length_crowning": 0.03, "profile_crowning": 0.02}},
        "pinion": {"teeth": 13},
        "gear": {"teeth": 44},
    },
    "conjugate": {
        "kind": "spiral_bevel_conjugate",
        "module": 4,
        "pinion": {"teeth": 20, "r_d": 74},
        "gear": {"teeth": 40, "r_d": 76},
    },
}


@pytest.mark.sweep
@pytest.mark.sweep_cases("bevel_inch", "shafts", "eased", "inch")
@pytest.mark.parametrize("name", MORE)
def test_pinned_designs_of_other_units_parts_and_errors_build_the_same_gears(name: str, tmp_path: Path) -> None:
    gears = gm.build(gm.parse(MORE[name]))
    same = gm.build(gm.load(pinned(gears, tmp_path)))
    # and phi1 = 0 is at the same place: of an ease-off that is where its conjugate would touch
    np.testing.assert_allclose(places(same.train), places(gears.train), rtol=0, atol=SAME)


@pytest.mark.sweep
def test_pinned_mounts_and_phi1_stay_where_they_are(tmp_path: Path) -> None:
    """Pinned keys state where each body is held, the point that its stiffness refers to, and the position phi1 = 0 of an
    ease-off."""
    design = gm.parse(
        {
            "kind": "spiral_bevel",
            "module": 5,
            "contact": {"ease_off": {"length_crowning": 0.03, "profile_crowning": 0.02}},
            "pinion": {"teeth": 13, "mount": {"stiffness": [2e5, 2e5, 1e5, 1e9, 1e9, "rigid"]}},
            "gear": {"teeth": 44},
        }
    )
    gears = gm.build(design)
    same = gm.build(gm.load(pinned(gears, tmp_path)))
    own = dict(same.design.own())
    assert {"pinion.mount.z", "gear.mount.held", "pinion.concave.mesh_angle"} <= own.keys()
    (first,), (second,) = (mounts_of(each.design, each.pairs[0]).values() for each in (gears, same))
    assert second.z == pytest.approx(first.z, abs=1e-9)
    paths = [each.contact([-5.0, 0.0, 5.0], cycle=False).path for each in (gears, same)]
    # 1e-12 mm of the flanks over the lever of contact, some 20 mm; TE counts from phi1 = 0, which is the same place
    np.testing.assert_allclose(paths[1].phi2, paths[0].phi2, rtol=0, atol=1e-12)
    np.testing.assert_allclose(paths[1].te, paths[0].te, rtol=0, atol=1e-12)


@pytest.mark.sweep
def test_positions_that_are_left_out_are_pinned_by_the_engagement(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They stay whatever the engagement is found to be; a set has one of each pair, and leaves them out."""
    gears = gm.build(gm.parse(MORE["shafts"]))
    assert not {"contact.phi1.start", "contact.phi1.stop"} & dict(gears.design.own()).keys()
    before = gears.contact(cycle=False).path.phi1
    file = pinned(gears, tmp_path)
    ends = np.radians([gears.pin().added[f"contact.phi1.{end}"] for end in ("start", "stop")])
    np.testing.assert_allclose(before[[0, -1]], ends, rtol=0, atol=SAME)
    monkeypatch.setattr("gearmesh.answers.contact.contact.engagement_range", lambda *_: (-9.0, 9.0))
    same = gm.build(gm.load(file))
    np.testing.assert_allclose(same.contact(cycle=False).path.phi1, before, rtol=0, atol=SAME)
    planetary = gm.build(gm.load(SAMPLES / "planetary.toml"))
    assert not any(key.startswith("contact.phi1.st") for key in planetary.pin().added)
    assert gm.build(gm.load(pinned(planetary, tmp_path))).design.sets("contact.phi1.start") is False


def test_mesh_angle_needs_the_index() -> None:
    refused = r"^pinion.convex.mesh_angle = 3 deg: needs index_angle"
    with pytest.raises(gm.DesignError, match=refused):
        gm.load(SAMPLES / "spiral_bevel_basic.toml", ["pinion.convex.mesh_angle=3"])


@pytest.mark.sweep
def test_pinned_pinions_of_one_cutter_are_the_same_and_keep_their_index(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both sides by the concave one's machine; the turn of the blank that the backlash asks for is given, too."""
    basic = {"kind": "spiral_bevel", "module": 5, "backlash": 0.1, "gear": {"teeth": 44}}
    values = gm.build(gm.parse({**basic, "pinion": {"teeth": 13}})).sheet().values
    machine = {key.rpartition(".")[2]: value for key, value in values.items() if key.startswith("pinion.concave.")}
    convex = {"tip_radius": machine["tip_radius"] - 2.2, "blade_angle": 23.0}
    pinion = {"teeth": 13, "concave": machine, "convex": convex}
    gears = gm.build(gm.parse({**basic, "process": "completing", "pinion": pinion}))
    file = pinned(gears, tmp_path)
    assert gm.load(file).pinion.concave.index_angle is not None  # type: ignore[attr-defined]
    monkeypatch.setattr("gearmesh.systems.spiral_bevel.machine.cutting.thinning", lambda *_: 0.0)
    forget_bevel_teeth()
    np.testing.assert_allclose(places(gm.build(gm.load(file)).train), places(gears.train), rtol=0, atol=SAME)


#: constants of the rules by which something is chosen, and what they are in another version; designs that they change
OTHER_RULES: dict[str, tuple[str, Any, dict[str, Any]]] = {
    "bore": ("gearmesh.systems.common.bodies.body.DEFAULT_BORE", 0.3, MORE["halves"]),
    "gap": ("gearmesh.systems.cylindrical.double_helical.GAP_DEPTH_MODULES", 0.9, MORE["halves"]),
    "web": ("gearmesh.systems.common.bodies.body.RIM_DEPTHS", 1.5, MORE["shafts"]),
    "holes": ("gearmesh.systems.common.bodies.features.HOLE_ROOM", 0.4, MORE["shafts"]),
    "chamfer": ("gearmesh.systems.cylindrical.cutting.hobbed.DEFAULT_CHAMFER_ANGLE_DEG", 50.0, MORE["shafts"]),
    "cutter": ("gearmesh.systems.cylindrical.cutting.cutter_choice.CUTTER_TEETH_SHARE", 0.5, MORE["inch"]),
    "rim": ("gearmesh.systems.cylindrical.cutting.shaped.DEFAULT_RIM_MODULES", 4.0, MORE["inch"]),
    "profile": (
        "gearmesh.systems.cylindrical.design.BASIC_RACKS",
        {"A": (1.0, 1.3, 0.3), "B": (1.0, 1.25, 0.3), "C": (1.0, 1.25, 0.25), "D": (1.0, 1.4, 0.39)},
        MORE["halves"],
    ),
    "face_gear": (
        "gearmesh.systems.face_gear.pinion_root.STANDARD_DEDENDUM_MODULES",
        1.3,
        {"kind": "face_gear", "module": 3, "pinion": {"teeth": 25}, "gear": {"teeth": 120}, "shaper": {"teeth": 28}},
    ),
    "clearance": ("gearmesh.systems.common.bevel.blank.CLEARANCE_FACTOR", 0.15, MORE["bevel_inch"]),
}


def forget_bevel_teeth() -> None:
    """Teeth of equal bevel designs are remembered, whatever the rules were when they were made."""
    from gearmesh.systems.spiral_bevel.synthesis import teeth_choice

    for each in vars(teeth_choice).values():
        if hasattr(each, "cache_clear"):
            each.cache_clear()


@pytest.mark.sweep
@pytest.mark.sweep_cases("face_gear", "web", "holes", "bore", "chamfer", "clearance", "cutter", "profile", "rim")
@pytest.mark.parametrize("rule", OTHER_RULES)
def test_a_rule_that_changes_changes_a_design_and_not_what_is_pinned(
    rule: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place, value, keys = OTHER_RULES[rule]
    forget_bevel_teeth()
    gears = gm.build(gm.parse(keys))
    file, before = pinned(gears, tmp_path), places(gears.train)
    monkeypatch.setattr(place, value)
    forget_bevel_teeth()
    after = places(gm.build(gm.parse(keys)).train)
    assert after.shape != before.shape or np.abs(after - before).max() > 1e-4
    np.testing.assert_allclose(places(gm.build(gm.load(file)).train), before, rtol=0, atol=SAME)


@pytest.mark.sweep
def test_pinned_bevel_gears_ask_nothing_of_their_contact(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither local synthesis nor the choice of the contact nor of proportions has a part in them any more."""
    gears = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml"))
    file, before = pinned(gears, tmp_path), places(gears.train)

    def never(*_: Any, **__: Any) -> Any:
        raise AssertionError("a pinned design leaves nothing to choose")

    for rule in (
        "spiral_bevel.synthesis.settings.synthesise",
        "spiral_bevel.synthesis.settings.tool_values",
        "common.bevel.blank.suggested_depth_factor",
        "common.bevel.blank.nominal_radius",
    ):
        monkeypatch.setattr(f"gearmesh.systems.{rule}", never)
    forget_bevel_teeth()
    design = gm.load(file)
    np.testing.assert_allclose(places(gm.build(design).train), before, rtol=0, atol=SAME)


@pytest.mark.quick
def test_the_command_names_files_from_where_it_writes(tmp_path: Path) -> None:
    (tmp_path / "own").mkdir()
    (tmp_path / "other").mkdir()
    corpus = SAMPLES.parent / "tests" / "corpus" / "topography.csv"
    (tmp_path / "own" / "map.csv").write_bytes(corpus.read_bytes())
    text = (SAMPLES / "helical.toml").read_text(encoding="utf-8")
    (tmp_path / "own" / "design.toml").write_text(
        text.replace("[gear]", 'modifications = { topography = "map.csv" }\n\n[gear]'), encoding="utf-8"
    )
    file = tmp_path / "other" / "pinned.toml"
    done = run("pin", str(tmp_path / "own" / "design.toml"), "-o", str(file))
    assert done[0] == 0
    assert "pinion.bore" in done[1]
    given = tomllib.loads(file.read_text(encoding="utf-8"))
    assert given["pinion"]["modifications"]["topography"] == "../own/map.csv"
    assert gm.build(gm.load(file)).members.keys() == {"pinion", "gear"}
