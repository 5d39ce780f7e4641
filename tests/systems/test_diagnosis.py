"""Refusals: they name the key that the design sets, and a bound of it that is true."""

from __future__ import annotations

import re
from typing import Any

import pytest
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, GearmeshError, system
from gearmesh.design.dotted import with_keys
from gearmesh.kernel.numeric.effort import Effort, count_effort
from gearmesh.systems import diagnosis, trials

# what is set, and the key and the side of the bound that the refusal begins with; none of them names what was noticed
REFUSED = [
    ("spur", ["pressure_angle=40"], "pressure_angle", "at most"),
    ("novikov", ["rack_parameter=2.1"], "rack_parameter", "at most"),
    ("circular_arc", ["pinion.addendum=1.2"], "pinion.addendum", "at most"),
    ("spur", ["backlash=30"], "backlash", "at most"),
    ("spur", ["gear.teeth=400"], "assembly.center_distance", "at least"),
    ("circular_arc", ["center_distance=8.77"], "center_distance", "at least"),
    ("circular_arc", ["diametral_pitch=1.4"], "diametral_pitch", "at least"),
    ("face_gear", ["pressure_angle=15"], "pressure_angle", "at least"),
    ("face_gear", ["gear.top_land=1"], "gear.top_land", "at most"),
    ("spiral_bevel_basic", ["depth_factor=2", "contact.delta=0.2"], "depth_factor", "at most"),
    ("spiral_bevel_geometry1", ["addendum=1.8"], "addendum", "at most"),
    ("zerol", ["gear.root_angle=5"], "gear.root_angle", "at least"),
    ("worm_drive", ["worm.addendum=3"], "worm.addendum", "at most"),
    ("worm_drive", ["hob.center_distance=60"], "hob.center_distance", "at least"),
]


@pytest.mark.sweep_cases("spiral_bevel_geometry1-addendum=1.8", "worm_drive-worm.addendum=3")
@pytest.mark.parametrize(
    ("sample", "given", "key", "side"),
    [*some(REFUSED[:-1], 3), *some(REFUSED[-1:], 0)],
    ids=[f"{row[0]}-{row[1][0]}" for row in REFUSED],
)
def test_the_key_that_the_design_sets_is_named_with_a_true_bound(
    sample: str, given: list[str], key: str, side: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = SAMPLES / f"{sample}.toml"
    with pytest.raises(GearmeshError) as refused:
        gm.build(gm.load(file, given))
    rough = r"(?: \w+)?, ([\d.]+) \w+ is refused as well"
    found = re.match(
        rf"{re.escape(key)} = \S+(?: \w+)?: allowed is {side} (?:about )?([\d.]+)(?:{rough})?", str(refused.value)
    )
    assert found is not None, str(refused.value)
    bound = float(found[1])
    gm.build(gm.load(file, [*given, f"{key}={bound}"]))
    # a little beyond it, where the key is not looked for again; of a drive whose builds take long 3 %
    beyond = bound * (1.005 if side == "at most" else 0.995) if found[2] is None else float(found[2])
    assert abs(beyond / bound - 1.0) < 0.03
    monkeypatch.setattr(diagnosis, "MAX_EFFORT", 0.0)
    with pytest.raises(GearmeshError):
        gm.build(gm.load(file, [*given, f"{key}={beyond}"]))


@pytest.mark.sweep_cases("beveloid_intersected-pinion.profile_shift=1-10")
@pytest.mark.parametrize(
    ("sample", "given", "most"),
    # the cutter's tooth is pointed, the tooth is
    [("spur", "pressure_angle=40", 15), ("beveloid_intersected", "pinion.profile_shift=1", 10)],
)
def test_bounds_go_by_how_far_figures_are_beyond_their_limits(
    sample: str, given: str, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Halving took 26 and 17 builds to four digits."""
    builds: list[float | None] = []
    trial = trials.Trials._trial

    def count(own: trials.Trials[Any], key: str, value: float | None, effort: float) -> trials.Outcome:
        # what is built of other keys looks for more that mends
        if given.startswith(key):
            builds.append(value)
        return trial(own, key, value, effort)

    monkeypatch.setattr(trials.Trials, "_trial", count)
    with pytest.raises(DesignError, match=given.replace("=", " = ")):
        gm.build(gm.load(SAMPLES / f"{sample}.toml", [given]))
    assert 3 < len(builds) <= most


@pytest.mark.sweep
def test_keys_without_influence_are_moved_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The root below a bore does not depend on crowning, backlash, or the rack: these were moved six times each."""
    moved: dict[str, int] = {}
    trial = trials.Trials._trial

    def count(own: trials.Trials[Any], key: str, value: float | None, effort: float) -> trials.Outcome:
        moved[key] = moved.get(key, 0) + (value is not None)
        return trial(own, key, value, effort)

    monkeypatch.setattr(trials.Trials, "_trial", count)
    with pytest.raises(DesignError, match=r"pinion\.bore = 20 mm"):
        gm.build(gm.load(SAMPLES / "rack.toml", ["pinion.teeth=7"]))
    assert moved["pinion.modifications.profile_crowning"] == moved["rack.height"] == 2


def test_changed_keys_are_moved_as_far_as_it_helps() -> None:
    """The key of the command is named, not two keys of the file: its bound is more than 0.8 of its value away."""
    with pytest.raises(
        DesignError, match=r"^pinion.teeth = 7: allowed is at least 18, with the other keys unchanged: "
    ):
        gm.build(gm.load(SAMPLES / "spur_relieved.toml", ["pinion.teeth=7"]))
    gm.build(gm.load(SAMPLES / "spur_relieved.toml", ["pinion.teeth=18"]))


# bounds that are known where they are noticed: what is set, the bound's pattern, and the factor that goes beyond it
BOUNDED = [
    ("circular_arc", "pinion.fillet_radius=1.2", r"to ([\d.]+)$", 1.001),
    ("circular_arc", "pinion.fillet_radius=0.1", r"from ([\d.]+)", 0.999),
    ("spiral_bevel_geometry1", "face_width=1e-6", r"more than ([\d.]+)", 0.999),
]


@pytest.mark.parametrize(("sample", "given", "pattern", "beyond"), BOUNDED, ids=[row[1] for row in BOUNDED])
@pytest.mark.sweep_cases("face_width=1e-6", "pinion.fillet_radius=0.1")
def test_bounds_are_true(sample: str, given: str, pattern: str, beyond: float) -> None:
    def refusal(*overrides: str) -> str:
        try:
            gm.build(gm.load(SAMPLES / f"{sample}.toml", list(overrides)))
        except DesignError as failure:
            return str(failure)
        return ""

    line = refusal(given)
    found = re.search(pattern, line)
    assert found is not None, line
    key, limit = line.split(" = ")[0], float(found[1])
    same = line.split(": ")[1].split(";")[0]
    inside = limit * (2.0 - beyond)
    assert same not in refusal(given, f"{key}={inside}")
    assert same in refusal(given, f"{key}={limit * beyond}")


@pytest.mark.sweep
def test_one_depth_of_both_sides_is_enough() -> None:
    """Both sides of the pinion are cut to one depth: the one that is left out follows the other."""
    for key, value in (("sliding_base", 0.05), ("machine_root_angle", 14.4)):
        sides = [
            gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml", [f"pinion.{side}.{key}={value}"]))
            for side in ("concave", "convex")
        ]
        first, second = (gears.members["pinion"].tooth.blank.root for gears in sides)
        assert first == second
    depths = ["pinion.concave.sliding_base=0.1", "pinion.convex.sliding_base=0.4"]
    with pytest.raises(DesignError, match=r"pinion.convex.sliding_base = 0.4 mm: .*same sliding_base"):
        gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml", depths))


def test_what_several_keys_would_mend_names_them() -> None:
    """A build of it takes a twelfth of the effort: other keys are looked for with the half that is left."""
    with pytest.raises(
        DesignError, match=r"^pinion.profile_shift = 1: .*, or pinion.cone_angle = 30 deg: allowed is at most 12.82 deg"
    ):
        gm.build(gm.load(SAMPLES / "beveloid_intersected.toml", ["pinion.profile_shift=1"]))


@pytest.mark.sweep
def test_limits_are_told_beyond_them_too() -> None:
    """Limits of a face gear that is undercut at its inner radius: they give the radius that would work, and the design beyond
    it."""
    from gearmesh.answers.limits import limits_beyond
    from gearmesh.design import files
    from gearmesh.systems.designs import parse_as_stated

    mapping = files.override(files.read(SAMPLES / "face_gear.toml"), ["gear.inner_radius=460"])
    design = parse_as_stated(mapping)
    with pytest.raises(DesignError) as refused:
        gm.build(design)
    found = limits_beyond(design, refused.value)
    document = found.document()
    assert document["members"]["gear"]["inner_radius_mm"] == pytest.approx(465.023, abs=1e-3)
    assert document["design"]["gear"]["inner_radius"] == 460.0
    assert found.warnings[0].startswith("gear.inner_radius = 460 mm: undercut by the shaper; allowed is at least 465.0")


@pytest.mark.parametrize(("teeth", "mating", "shaper"), [(20, 100, 22), (21, 80, 23)])
@pytest.mark.sweep_cases("21-80-23")
def test_face_gears_of_20_deg_have_teeth(teeth: int, mating: int, shaper: int) -> None:
    """The inner radius that is left out is where the shaper's involute reaches the tips, not only where undercut ends."""
    given = ["module=3", "pressure_angle=20", "pinion.bore=20", "gear.bore=60"]
    given += [f"pinion.teeth={teeth}", f"gear.teeth={mating}", f"shaper.teeth={shaper}"]
    gears = gm.build(gm.load(SAMPLES / "face_gear.toml", given))
    limits = gears.limits().document()["members"]["gear"]
    assert limits["inner_radius_mm"] < gears.members["gear"].tooth.blank.extent[0] < limits["outer_radius_mm"]


@pytest.mark.sweep
def test_first_of_two_faults_is_named_with_the_key_that_mends_it() -> None:
    """Both members are pointed, and neither the cone angle of the one nor that of the other mends both."""
    keys: dict[str, Any] = {
        "kind": "beveloid",
        "module": 1.506,
        "pressure_angle": 9.6777,
        "pinion": {"teeth": 15, "face_width": 3.042, "cone_angle": 41.412, "profile_shift": -0.53936},
        "gear": {"teeth": 28, "face_width": 4.46, "cone_angle": 41.412},
    }
    noticed = "pinion.addendum: the tooth is pointed"

    def refusal(**pinion: float) -> str:
        with pytest.raises(DesignError) as refused:
            gm.build(gm.parse({**keys, "pinion": {**keys["pinion"], **pinion}}))
        return str(refused.value)

    first = refusal()
    found = re.match(r"pinion\.cone_angle = 41\.412 deg: allowed is at most ([\d.]+) deg", first)
    assert found is not None, first
    assert f"(another refusal then follows): {noticed}" in first
    assert noticed not in refusal(cone_angle=float(found[1]))
    assert noticed in refusal(cone_angle=1.002 * float(found[1]))


@pytest.mark.sweep
def test_what_was_put_in_anew_is_tried_first_and_the_search_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Design with 37 keys whose teeth take long to build. The refusal gives a bound of the changed key, found within the effort
    allowed."""
    file, given = SAMPLES.parent / "tests" / "designs" / "maker_summary_13_42.toml", "pinion.convex.blade_angle=50"
    spent: list[float] = []

    def effort(allowed: float) -> Effort:
        spent.append(allowed)
        return Effort(allowed)

    monkeypatch.setattr(diagnosis, "Effort", effort)
    monkeypatch.setattr(trials, "Effort", effort)
    with pytest.raises(GearmeshError) as refused:
        gm.load(file, [given])
    found = re.match(
        r"pinion\.convex\.blade_angle = 50 deg: allowed is at most (?:about )?([\d.]+) deg"
        r"(?:, ([\d.]+) deg is refused as well)?, with",
        str(refused.value),
    )
    assert found is not None, str(refused.value)
    # the bound itself is 48.51: the search ends with its effort, and says where it stopped if that is far away
    refused_as_well = found[2] or "48.6"
    assert 48.4 < float(found[1]) < 48.52 < float(refused_as_well) < 50.0
    gm.load(file, [f"pinion.convex.blade_angle={found[1]}"])
    # no clock decides: the same effort is the same message, and none is the refusal as it was noticed
    assert spent[0] == diagnosis.MAX_EFFORT
    # as many trials as the effort allows: 10 since tips of teeth start from those of their proof
    assert 1 < len(spent) < 20
    monkeypatch.setattr(diagnosis, "MAX_EFFORT", 0.0)
    with pytest.raises(GearmeshError, match=r"^pinion: the fillets of neighbouring teeth overlap"):
        gm.load(file, [f"pinion.convex.blade_angle={refused_as_well}"])
    with pytest.raises(GearmeshError, match=r"^pinion: the fillets of neighbouring teeth overlap"):
        gm.load(file, [given])


@pytest.mark.sweep
@pytest.mark.sweep_cases("novikov-pinion.tip_rounding-6.0")
@pytest.mark.parametrize(
    ("kind", "key", "value"),
    # these took up to ten times the effort, most of it for the bound in the reason
    [("modified_involute", "pressure_angle", 5.0), ("novikov", "pinion.tip_rounding", 6.0)],
)
def test_the_bound_in_a_reason_and_the_search_share_one_effort(
    kind: str, key: str, value: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    diagnose, spent, allowed = diagnosis.diagnose, list[float](), 100.0

    def counted(*arguments: Any) -> GearmeshError:
        with count_effort(allowed) as effort:
            refusal = diagnose(*arguments)
        spent.append(allowed - effort.left)
        return refusal

    monkeypatch.setattr(diagnosis, "diagnose", counted)
    cls = system(kind).design
    keys = {**dict(cls(**cls.example).own()), key: value}
    with pytest.raises(GearmeshError) as refused:
        gm.build(cls(**with_keys({}, keys.items())))
    assert str(refused.value).startswith(f"{key} = {value:g}")
    assert spent[0] < 1.15 * diagnosis.MAX_EFFORT


@pytest.mark.sweep
@pytest.mark.parametrize("module", some([2.0, 4.0], 1))
def test_of_an_unusual_offset_one_that_works_is_named(module: float) -> None:
    """11/22 teeth with an offset of 39 % of the gear's outer diameter: not the module or the teeth are what is unusual."""
    own = system("hypoid")
    assert own.tried is not None

    def tried(offset: float) -> Any:
        asked = own.design(module=module, offset=offset, pinion={"teeth": 11}, gear={"teeth": 22})
        own.tried(asked)
        return asked

    offset = 0.39 * 22 * module
    with pytest.raises(GearmeshError) as refused:
        tried(offset)
    design = own.design(module=module, offset=offset, pinion={"teeth": 11}, gear={"teeth": 22})
    line = str(diagnosis.diagnose(design, refused.value, own.tried))
    found = re.match(
        rf"offset = {offset:.7g} mm: allowed is at most (?:about )?([\d.]+) mm, .*with the other keys unchanged", line
    )
    assert found is not None, line
    assert 0.1 * offset < float(found[1]) < offset
    tried(float(found[1]))


@pytest.mark.quick
def test_tables_without_a_key_stay_in_the_trials_of_a_refusal() -> None:
    """The design of a trial differs from the design in one key alone, as in the file."""
    cls = system("spiral_bevel").design
    design = cls(**with_keys(cls.example, [("gear.cutter", {}), ("gear.bore", 30.0)]))
    tried = list[dict[str, Any]]()

    def build(given: Any) -> object:
        tried.append(given.stated())
        raise DesignError("gear.bore", 30.0, reason="too large")

    assert diagnosis.without_one(design, build) is None
    assert tried
    assert all(stated["gear"]["cutter"] == {} for stated in tried)


def test_designs_that_differ_in_what_was_put_in_anew_alone_are_equal() -> None:
    plain: Any = gm.load(SAMPLES / "spur.toml")
    again = plain.with_values({"pressure_angle": plain.pressure_angle})
    assert (plain.changed_keys, again.changed_keys) == ((), ("pressure_angle",))
    assert again == plain
    assert gm.load(SAMPLES / "spur.toml", ["pressure_angle = 21"]).in_mm().changed_keys == ("pressure_angle",)


def test_refusals_that_stay_as_they_are_know_their_excess(monkeypatch: pytest.MonkeyPatch) -> None:
    """They were raised from themselves: whoever followed their causes went round in a circle (RecursionError)."""
    monkeypatch.setattr(diagnosis, "MAX_EFFORT", 0.0)
    with pytest.raises(GearmeshError) as refused:
        gm.build(gm.load(SAMPLES / "worm_drive.toml", ["wheel.face_width=100"]))
    assert refused.value.__cause__ is not refused.value
    # the hob's tip diameter is 72 mm
    assert refused.value.excess == pytest.approx(28.0)
    with pytest.raises(GearmeshError) as refused:
        gm.build(gm.load(SAMPLES / "spur.toml", ["pressure_angle=40"]))
    causes = [refused.value]
    while isinstance(cause := causes[-1].__cause__, GearmeshError) and len(causes) < 10:
        causes.append(cause)
    assert len(causes) < 10
