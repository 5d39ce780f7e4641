"""Gears of states of the local page: what comes, in which order, what is computed again, and what is refused with which offer."""

from __future__ import annotations

import base64
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Rigid
from gearmesh.design.dotted import leaves
from gearmesh.design.rewriting import rewritten
from gearmesh.explore.explorer import origin_of, origin_of_file
from gearmesh.explore.kept import Job, Stale
from gearmesh.explore.keys import plain_values
from gearmesh.explore.ranges import key_range
from gearmesh.explore.state import Origin, refuse_keys
from gearmesh.explore.workshop import Workshop
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.systems.system import complete_design

#: figures that come first, by key
MAIN_KEYS = ("contact_ratio", "mesh_te_peak_to_peak_arcsec", "backlash_normal_min_mm", "tip_clearance_pinion_mm")


@pytest.fixture(scope="module")
def workshop() -> Workshop:
    return Workshop(origin_of_file(SAMPLES / "helical.toml"))


def ask(
    workshop: Workshop, what: str = "show", changes: dict[str, Any] | None = None, **fields: Any
) -> list[dict[str, Any]]:
    """Answers without progress; `changes` are put into the keys of the opened design."""
    found: list[dict[str, Any]] = []
    keys = {**workshop.origins["opened"].shown, **(changes or {})}
    workshop.answer({"do": what, "from": "opened", "keys": keys, **fields}, Job(found.append))
    return [message for message in found if message["type"] != "progress"]


def first_answer(workshop: Workshop, changes: dict[str, Any]) -> str:
    """Type of the first answer to changes of the opened design, after which the work ends."""
    found: list[dict[str, Any]] = []
    job = Job(found.append, lambda: any(message["type"] != "progress" for message in found))
    request = {"do": "show", "from": "opened", "keys": {**workshop.origins["opened"].shown, **changes}}
    with pytest.raises(Stale):
        workshop.answer(request, job)
    return str(found[-1]["type"])


def of(messages: list[dict[str, Any]], kind: str) -> list[dict[str, Any]]:
    return [message for message in messages if message["type"] == kind]


def figure(messages: list[dict[str, Any]], key: str, *, later: bool = False) -> float:
    (found,) = (message for message in of(messages, "figures") if message["later"] is later)
    return next(each["value"] for each in found["meshes"][0]["figures"] if each["key"] == key)


@pytest.mark.sweep
def test_figures_come_first_and_what_is_known_does_not_come_again(
    workshop: Workshop, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = ask(workshop)
    # a page without gears gets them before their contact
    assert [message["type"] for message in first] == [
        "design", "scene", "figures", "figures", "curves", "scene", "scene"
    ]  # fmt: skip
    assert (first[1]["pairs"], first[1]["waiting"], first[5]["waiting"]) == ([], True, False)
    assert first[4]["pairs"] == first[5]["pairs"]
    shown = [[shape["key"] for shape in scene["shapes"]] for scene in of(first, "scene")]
    assert shown[0] == shown[1] != shown[2]
    alone = gm.build(gm.load(SAMPLES / "helical.toml")).contact().summary
    for later in (True, False):
        for key in MAIN_KEYS:
            assert figure(first, key, later=later) == pytest.approx(alone[key], rel=1e-12, abs=1e-9)
    held = [shape["key"] for shape in first[-1]["shapes"]]

    # an error of assembly: no build, no mesh, other contact, as of gears built with it
    monkeypatch.setattr("gearmesh.explore.workshop.build", lambda design: pytest.fail("gears were built"))
    monkeypatch.setattr("gearmesh.explore.kept.StagedMember.of", lambda *_: pytest.fail("a tooth was meshed"))
    moved = ask(workshop, changes={"assembly.dx": 0.05, "assembly.dy": 0.01}, have=held, rows=first[0]["of"])
    assert [message["type"] for message in moved] == ["design", "scene", "figures", "figures", "scene"]
    # the first pattern comes before the mesh cycle, on the path of contact that comes after it
    first_path, path = (curve(scene) for scene in of(moved, "scene"))
    assert 5 < len(first_path) < len(path)
    assert np.interp(first_path[:, 0], *path.T) == pytest.approx(first_path[:, 1], abs=2e-3)
    assert np.ptp(first_path[:, 0]) == pytest.approx(np.ptp(path[:, 0]), rel=0.1)
    fields = [{each["key"] for each in scene["pairs"][0]["flanks"][0]["fields"]} for scene in of(moved, "scene")]
    assert "pattern" in fields[0]
    assert fields[1] >= {"pattern", "ease_off", "gap"}
    assert "rows" not in moved[0]
    assert all(set(shape) == {"key"} for shape in moved[-1]["shapes"])
    built = gm.build(gm.load(SAMPLES / "helical.toml", ["assembly.dx=0.05", "assembly.dy=0.01"])).contact()
    for key in MAIN_KEYS:
        assert figure(moved, key) == pytest.approx(built.summary[key], rel=1e-9, abs=1e-9)

    # back again: nothing is solved either
    monkeypatch.setattr("gearmesh.explore.pairs.solve_mesh", lambda *_: pytest.fail("contact was solved"))
    again = ask(workshop, have=held)
    assert figure(again, "contact_ratio") == figure(first, "contact_ratio")
    assert again[-1]["pairs"] == first[-1]["pairs"]
    again = ask(workshop, changes={"assembly.dx": 0.05, "assembly.dy": 0.01}, have=held)
    assert [message["type"] for message in again] == ["design", "figures", "scene"]
    assert again[-1]["pairs"] == moved[-1]["pairs"]


def curve(scene: dict[str, Any]) -> np.ndarray:
    """Rotations and transmission errors (P, 2) of the pair of a scene."""
    (pair,) = scene["pairs"]
    return np.stack([np.frombuffer(base64.b64decode(pair[key]), dtype=np.float32) for key in ("phi1", "te")], axis=-1)


def test_a_changed_tooth_has_figures_and_pattern_before_its_fine_mesh(
    workshop: Workshop, monkeypatch: pytest.MonkeyPatch
) -> None:
    # a mesh that takes long, of many triangles
    monkeypatch.setattr("gearmesh.explore.kept.FEW_TRIANGLES", 100)
    held = [shape["key"] for shape in ask(workshop)[-1]["shapes"]]
    changed = ask(workshop, changes={"pinion.teeth": 27}, have=held)
    assert [message["type"] for message in changed] == ["design", "figures", "figures", "curves", "scene", "scene"]
    coarse, fine = of(changed, "scene")
    # the tooth of the gear is the same one, and did not come again
    assert [set(shape) == {"key"} for shape in coarse["shapes"]] == [False, True]
    count = [len(base64.b64decode(scene["shapes"][0]["tooth"]["corners"])) for scene in (coarse, fine)]
    assert count[0] < count[1]
    first_path, path = curve(coarse), curve(fine)
    assert np.interp(first_path[:, 0], *path.T) == pytest.approx(first_path[:, 1], abs=2e-3)
    fields = [{each["key"] for each in scene["pairs"][0]["flanks"][0]["fields"]} for scene in (coarse, fine)]
    assert "pattern" in fields[0] < fields[1]


def test_fine_mesh_made_with_the_coarse_one_is_sent_once(workshop: Workshop) -> None:
    held = [shape["key"] for shape in ask(workshop)[-1]["shapes"]]
    changed = ask(workshop, changes={"pinion.teeth": 28}, have=held)
    first, last = of(changed, "scene")
    assert [set(shape) == {"key"} for shape in first["shapes"]] == [False, True]
    assert [set(shape) == {"key"} for shape in last["shapes"]] == [True, True]
    assert [shape["key"] for shape in first["shapes"]] == [shape["key"] for shape in last["shapes"]]


@pytest.mark.sweep
def test_a_bore_leaves_contact_as_it_is(workshop: Workshop, monkeypatch: pytest.MonkeyPatch) -> None:
    first = ask(workshop)
    held = [shape["key"] for shape in first[-1]["shapes"]]
    changes = {"pinion.bore": 10.0}
    fresh = ask(Workshop(workshop.origins["opened"]), changes=changes)
    with monkeypatch.context() as patch:
        patch.setattr("gearmesh.explore.pairs.MeshSolution.of", lambda pair: pytest.fail("a mesh was solved"))
        patch.setattr("gearmesh.explore.pairs.contact_of", lambda *_, **__: pytest.fail("a contact was solved"))
        found = ask(workshop, changes=changes, have=held, rows=first[0]["of"])
    assert [message["type"] for message in found] == ["design", "figures", "scene"]
    shown, expected = of(found, "figures")[-1], of(fresh, "figures")[-1]
    assert shown["warnings"] == expected["warnings"]
    assert shown["meshes"] == expected["meshes"]
    scenes = of(found, "scene")[-1], of(fresh, "scene")[-1]
    assert scenes[0]["pairs"] == scenes[1]["pairs"]
    # the member with the bore is meshed again, the other is not
    assert [set(shape) == {"key"} for shape in scenes[0]["shapes"]] == [False, True]
    assert scenes[0]["shapes"][0]["rest"] == scenes[1]["shapes"][0]["rest"]


@pytest.fixture(scope="module")
def train() -> Workshop:
    return Workshop(origin_of_file(SAMPLES / "trains" / "train_two_stage.toml"))


def by_name(messages: list[dict[str, Any]]) -> dict[str, dict[str, float]]:
    """Figures of the parts of a train."""
    return {
        mesh["name"]: {each["key"]: each["value"] for each in mesh["figures"]}
        for mesh in of(messages, "figures")[-1]["meshes"]
    }


def test_a_train_has_figures_of_its_parts_and_turns_as_its_stages_do(train: Workshop) -> None:
    found, alone = ask(train), gm.load_train(SAMPLES / "trains" / "train_two_stage.toml")
    assert [message["type"] for message in found] == ["design", *["figures"] * 3, "scene", "scene"]
    figures = by_name(found)
    assert figures["train"]["ratio"] == alone.figures.ratio
    turns = alone.transmission_error(2.0)
    assert figures["train"]["te_peak_to_peak_arcsec"] == pytest.approx(turns.figures.te_peak_to_peak, rel=1e-12)
    stage = alone.layout.stages["second"].gears
    assert figures["second: pinion-gear"]["contact_ratio"] == pytest.approx(
        gm.build(stage.design).contact().summary["contact_ratio"], rel=1e-12
    )
    # members stand where the train has them, at the first and at a later position of the input
    scene = of(found, "scene")[-1]
    (pair,) = scene["pairs"]
    phi1, te = (np.frombuffer(base64.b64decode(pair[key]), dtype=np.float32) for key in ("phi1", "te"))
    # the input turns forwards, and the error is that of its rotation
    assert np.sign(phi1[-1] - phi1[0]) == alone.layout.sense
    at = np.interp(phi1 * alone.layout.sense, turns.solved.psi, turns.solved.te / ARCSEC)
    np.testing.assert_allclose(te, at, atol=1e-3)
    for k in (0, len(phi1) // 3):
        places = alone.places(float(np.degrees(phi1[k])))
        for member, packed in zip(scene["members"], pair["turns"], strict=True):
            angle = float(np.frombuffer(base64.b64decode(packed), dtype=np.float32)[k])
            turned = np.array(member["rotation"]) @ Rigid.about_z(angle).rotation
            np.testing.assert_allclose(turned, places[member["name"]].rotation, atol=2e-6)
            np.testing.assert_allclose(member["translation"], places[member["name"]].translation, atol=1e-9)


@pytest.mark.sweep
def test_a_train_that_ends_in_a_rack_has_its_travel(tmp_path: Path) -> None:
    """A rack moves by millimetres: its figures, its error and the line of positions say so."""
    (tmp_path / "rack.toml").write_text(
        'kind = "train"\ninput = "input"\noutput = "table"\n'
        f'[stages.pair]\ndesign = "{SAMPLES / "helical.toml"}"\n'
        f'[stages.slide]\ndesign = "{SAMPLES / "rack.toml"}"\nhelix_angle = 12\n'
        '[shafts.input]\nmembers = ["pair.pinion"]\n'
        '[shafts.middle]\nmembers = ["pair.gear", { member = "slide.pinion", position = 40 }]\n'
        '[shafts.table]\nmembers = ["slide.rack"]\n',
        encoding="utf-8",
    )
    alone = gm.load_train(tmp_path / "rack.toml")
    found = ask(Workshop(origin_of_file(tmp_path / "rack.toml")))
    whole = of(found, "figures")[-1]["meshes"][0]
    main = {each["key"]: each["value"] for each in whole["figures"] if each["main"]}
    assert main["travel_mm"] == pytest.approx(alone.figures.travel, rel=1e-12)
    assert None not in main.values()
    (pair,) = of(found, "scene")[-1]["pairs"]
    assert pair["te_unit"] == "um"
    te = np.frombuffer(base64.b64decode(pair["te"]), dtype=np.float32)
    assert np.ptp(te) == pytest.approx(main["te_peak_to_peak_um"], rel=1e-5)
    phi1 = np.frombuffer(base64.b64decode(pair["phi1"]), dtype=np.float32)
    table = next(shaft for shaft in pair["shafts"] if shaft["name"] == "table")
    way = table["travel"] * np.ptp(np.frombuffer(base64.b64decode(table["turns"]), dtype=np.float32))
    assert way == pytest.approx(abs(alone.figures.travel) * np.ptp(phi1) / (2.0 * np.pi), rel=1e-3)


@pytest.mark.sweep
def test_planets_go_round_with_their_carrier() -> None:
    file = SAMPLES / "trains" / "train_planetary.toml"
    scene = of(ask(Workshop(origin_of_file(file))), "scene")[-1]
    (pair,), alone = scene["pairs"], gm.load_train(file)
    phi1, *tracks = (np.frombuffer(base64.b64decode(text), dtype=np.float32) for text in (pair["phi1"], *pair["turns"]))
    k = len(phi1) // 5
    places = alone.places(float(np.degrees(phi1[k])))
    moving = 0
    for member, turns, packed in zip(scene["members"], tracks, pair["carried"], strict=True):
        base = Rigid(np.array(member["rotation"]), np.array(member["translation"]))
        if packed is not None:
            carrier = Rigid(*(np.array(member["carrier"][part]) for part in ("rotation", "translation")))
            around = float(np.frombuffer(base64.b64decode(packed), dtype=np.float32)[k])
            base, moving = carrier @ Rigid.about_z(around) @ base, moving + 1
        place = base @ Rigid.about_z(float(turns[k]))
        np.testing.assert_allclose(place.rotation, places[member["name"]].rotation, atol=5e-6)
        np.testing.assert_allclose(place.translation, places[member["name"]].translation, atol=1e-3)
    assert moving == 3


@pytest.mark.sweep
def test_a_key_of_a_stage_changes_its_stage_alone(train: Workshop) -> None:
    first, key = ask(train), "stages.second.helix_angle"
    held = [shape["key"] for shape in first[-1]["shapes"]]
    changed = ask(train, changes={key: 14.0}, have=held, rows=first[0]["of"])
    assert "rows" not in changed[0]
    before, after = by_name(first), by_name(changed)
    assert before["first: pinion-gear"] == after["first: pinion-gear"]
    assert before["second: pinion-gear"] != after["second: pinion-gear"]
    assert [set(shape) == {"key"} for shape in of(changed, "scene")[-1]["shapes"]] == [True, True, True, True]
    assert [set(shape) == {"key"} for shape in of(changed, "scene")[0]["shapes"]] == [True, True, False, False]
    assert of(ask(train, "range", key="stages.second.pinion.teeth"), "range")[0]["low"] < 17


def test_a_refused_key_of_a_stage_has_its_name_and_an_offer(train: Workshop) -> None:
    key = "stages.first.pinion.bore"
    told = of(ask(train, changes={key: 60}, last=key, good=16), "refused")
    assert {each["key"] for each in told} == {key}
    (offer,) = told[-1]["offers"]
    assert offer["key"] == key
    assert of(ask(train, changes={key: offer["value"]}), "scene")
    # no file, and no shaft, comes from a page
    for key, value in (("stages.first.design", "/etc/passwd"), ("shafts.input.members", ["first.gear"])):
        assert of(ask(train, changes={key: value}), "refused")[0]["key"] == key


@pytest.mark.sweep
def test_a_train_is_saved_with_its_comments_and_as_its_own_files(train: Workshop, tmp_path: Path) -> None:
    text = (SAMPLES / "trains" / "train_two_stage.toml").read_text(encoding="utf-8")

    def saved(suffix: str, member: str = "all") -> bytes:
        (file,) = of(ask(train, "file", changes={"stages.first.gear.teeth": 50}, suffix=suffix, member=member), "file")
        return base64.b64decode(file["content"])

    design = saved(".toml").decode()
    assert design == text.replace("gear = { teeth = 48,", "gear = { teeth = 50,")
    (tmp_path / "train.toml").write_text(design, encoding="utf-8")
    alone = gm.load_train(tmp_path / "train.toml")
    alone.solids(file=tmp_path / "middle.stl").parts["middle"].save(tmp_path / "middle.stl")
    assert saved(".stl", "middle") == (tmp_path / "middle.stl").read_bytes()
    (told,) = of(ask(train, "file", suffix=".dxf", member="middle"), "refused")
    assert "stage" in told["line"]


def test_rounding_is_shown_as_zero() -> None:
    """The backlash of gears without backlash is about 1e-14 mm, and no slider must begin with a step of its size."""
    for units in ("mm", "inch"):
        design = gm.load(SAMPLES / "helical.toml").with_values({"units": units, "pinion.face_width": 2})
        assert dict(plain_values(complete_design(design)))["backlash"] == 0.0
    small = gm.load(SAMPLES / "helical.toml").with_values({"backlash": 2e-9})
    assert dict(plain_values(small))["backlash"] == 2e-9


def test_work_that_is_not_wanted_ends(workshop: Workshop) -> None:
    found: list[dict[str, Any]] = []
    job = Job(found.append, lambda: len(found) >= 2)
    keys = {**workshop.origins["opened"].shown, "pinion.teeth": 25}
    with pytest.raises(Stale):
        workshop.answer({"do": "show", "from": "opened", "keys": keys}, job)
    assert "scene" not in {message["type"] for message in found}


@pytest.mark.sweep
def test_work_ends_at_the_next_surface_and_leaves_gears_as_they_were() -> None:
    """Gears are kept between changes: work that was broken off anywhere must not change what comes next."""
    origin = origin_of_file(SAMPLES / "spur.toml")
    kept, fresh = Workshop(origin), Workshop(origin)
    ask(kept)
    late = []
    for last in (1, 10, 40, 100, 200, 400):
        looks = 0

        def is_stale(last: int = last) -> bool:
            nonlocal looks
            looks += 1
            return looks > last

        keys = {**origin.shown, "assembly.dx": 0.02}
        with pytest.raises(Stale):
            kept.answer({"do": "show", "from": "opened", "keys": keys, "have": ["x"]}, Job(lambda _: None, is_stale))
        late.append(looks - last)
    # it ended when it looked, and it looks often: not only between the stages of its progress
    assert late == [1] * len(late)
    after, expected = (ask(workshop, changes={"assembly.dx": 0.02}, have=["x"]) for workshop in (kept, fresh))
    assert of(after, "figures") == of(expected, "figures")
    assert of(after, "scene")[-1]["pairs"] == of(expected, "scene")[-1]["pairs"]


@pytest.mark.parametrize(
    ("changes", "key", "good", "units"),
    [
        ({"pressure_angle": 44}, "pressure_angle", 20, "mm"),
        # the limit of the key is 45, with which nothing builds either
        ({"pressure_angle": 60}, "pressure_angle", 20, "mm"),
        ({"module": -2.5}, "module", 5, "mm"),
        ({"gear.teeth": 2}, "gear.teeth", 48, "mm"),
        pytest.param({"gear.bore": 400}, "gear.bore", None, "mm", marks=pytest.mark.sweep),
        ({"gear.bore": 16}, "gear.bore", None, "inch"),
    ],
)
def test_offer_of_a_refusal_builds(changes: dict[str, Any], key: str, good: float | None, units: str) -> None:
    origin = origin_of(
        gm.load(SAMPLES / "helical.toml").with_values(
            {"units": units, "module": 5 if units == "mm" else 0.2, "pinion.face_width": 2, "gear.face_width": 2}
        )
    )
    workshop, (last,) = Workshop(origin), changes
    at_once, message = ask(workshop, changes=changes, last=last, good=good)
    assert at_once == {**message, "offers": []}
    assert message["type"] == "refused"
    assert message["key"] == key
    assert message["line"].startswith(key)
    (offer,) = message["offers"]
    assert offer["key"] == last
    assert first_answer(workshop, {last: offer["value"]}) == "design"
    # the offer lies at the border of what builds, not only beside the good value
    if good is not None and last != "gear.teeth":
        beyond = offer["value"] + (changes[last] - good) / 50.0
        assert first_answer(workshop, {last: beyond}) == "refused"


@pytest.mark.quick
def test_offers_that_do_not_build_are_not_made(workshop: Workshop) -> None:
    """Without a value that built there is none from which to search."""
    for changes in ({"pressure_angle": 60}, {"gear.face_width": -1}):
        (message,) = ask(workshop, changes=changes, last=next(iter(changes)))
        assert message["offers"] == []


@pytest.mark.sweep
def test_range_is_what_builds(workshop: Workshop) -> None:
    design = gm.load(SAMPLES / "helical.toml")
    found = key_range(design, "pressure_angle", 20.0)
    for value, builds in ((found.low, True), (found.high, True), (found.high + 2.0, False)):
        try:
            gm.build(design.with_values({"pressure_angle": value}))
        except gm.GearmeshError:
            assert not builds
        else:
            assert builds
    (message,) = ask(workshop, "range", key="pinion.teeth")
    assert message["low"] == 3
    assert message["low_known"]


def test_pages_do_not_see_files() -> None:
    origin = origin_of_file(SAMPLES / "hypoid_measured.toml")
    assert origin.files
    assert not set(origin.files) & set(origin.shown)
    (message,) = ask(Workshop(origin), changes={next(iter(origin.files)): "x.csv"})
    assert message["type"] == "refused"
    assert "a page cannot choose" in message["line"]
    # the file that is saved names them as the opened file does
    (key, name), *_ = origin.named.items()
    saved = rewritten(origin.text, {**origin.shown, **origin.named})
    assert dict(leaves(tomllib.loads(saved)))[key] == name
    assert "/" not in name


SAVED = """# a pair
kind = "cylindrical"  # spur
module = 2   # mm
pinion = { teeth = 20, face_width = 22 }  # the small one

# the wheel
[gear]
teeth = 41  # prime
face_width = "2cm"

[contact.phi1]
count = 21
"""


@pytest.mark.quick
def test_saved_design_keeps_comments_and_order() -> None:
    keys = dict(leaves(tomllib.loads(SAVED)))
    assert rewritten(SAVED, keys) == SAVED
    changed = {
        **keys,
        "module": 2.5,
        "gear.teeth": 43,
        "pinion.bore": 8.0,
        "gear.keyway.width": 3.0,
        "backlash": 0.1,
        "pinion.teeth": 21,
    }
    del changed["contact.phi1.count"]
    made = rewritten(SAVED, changed)
    assert dict(leaves(tomllib.loads(made))) == changed
    for line in (
        "# a pair",
        "# the wheel",
        "module = 2.5  # mm",
        "teeth = 43  # prime",
        'face_width = "2cm"',
        'kind = "cylindrical"  # spur',
    ):
        assert line in made.splitlines()
    assert "# the small one" in made
    assert made.index("backlash") < made.index("[gear]")


def test_saved_design_of_every_sample_reads_back() -> None:
    chance = np.random.default_rng(57)
    for path in sorted(SAMPLES.glob("*.toml")):
        text = path.read_text(encoding="utf-8")
        keys = dict(leaves(tomllib.loads(text)))
        assert rewritten(text, keys) == text
        changed = {
            key: value * 1.5 if isinstance(value, float) else value
            for key, value in keys.items()
            if chance.random() < 0.8
        }
        changed["extra.table.key"] = 1
        made = rewritten(text, changed)
        assert dict(leaves(tomllib.loads(made))) == changed, path
        comments = [line for line in text.splitlines() if line.startswith("#")]
        assert [line for line in made.splitlines() if line.startswith("#")] == comments, path


def test_keys_of_every_kind_may_be_set() -> None:
    for kind in gm.kinds():
        for line in gm.system(kind).design.key_lines():
            assert refuse_keys({line.key: 1.0}) == {line.key: 1.0}


@pytest.mark.parametrize("name", ["kind:hypoid", "sample:planetary"])
def test_kinds_and_samples_open(name: str) -> None:
    origin = Origin.find(name)
    assert origin.shown["kind"] == name.partition(":")[2]


@pytest.mark.quick
def test_every_kind_has_its_picture() -> None:
    """Made by `python scripts/kind_pictures.py KIND`."""
    own = [kind for kind in gm.kinds() if gm.system(kind).design.__module__.startswith("gearmesh.")]
    pictures = files("gearmesh.explore") / "page" / "kinds"
    assert [kind for kind in own if not (pictures / f"{kind}.jpg").is_file()] == []
