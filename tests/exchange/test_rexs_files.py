"""Forms of REXS files, and what is refused of them."""

from __future__ import annotations

import io
import re
import tracemalloc
import zipfile
from pathlib import Path

import pytest

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.exchange.model import READ_VERSIONS
from gearmesh.exchange.rexs_file import MAX_FILE_BYTES, read_rexs, rexs_bytes

FLANKS = """
    <relation id="2{n}" type="flank"><ref id="{n}" role="gear"/><ref id="1{n}" role="left"/>
      <ref id="2{n}" role="right"/></relation>"""
GEAR = """
    <component id="{n}" type="cylindrical_gear" name="gear {n}">
      <attribute id="number_of_teeth" unit="none">{z}</attribute>
      <attribute id="normal_module" unit="mm">4.5</attribute>
      <attribute id="helix_angle_reference_diameter" unit="deg">{beta}</attribute>
      <attribute id="face_width" unit="mm">50</attribute>
      <attribute id="u_axis_vector" unit="mm"><array><c>1</c><c>0</c><c>0</c></array></attribute>
      <attribute id="support_vector" unit="mm"><array code="float64">{place}</array></attribute>
    </component>
    <component id="1{n}" type="cylindrical_gear_flank">{flank}</component>
    <component id="2{n}" type="cylindrical_gear_flank">{flank}</component>"""
FLANK = """
      <attribute id="normal_pressure_angle" unit="deg">20</attribute>
      <attribute id="addendum_modification_coefficient" unit="">0.25</attribute>
    """
#: a gearbox with a stage, a bearing that no design has, and two load cases
FILE = f"""<?xml version="1.0" encoding="UTF-8"?>
<model version="1.7" applicationId="by hand" applicationVersion="1" date="2026-11-24T12:00:00+01:00">
  <relations>
    <relation id="1" type="stage"><ref id="5" role="stage"/><ref id="1" role="gear_1"/><ref id="2" role="gear_2"/></relation>
    {FLANKS.format(n=1)}{FLANKS.format(n=2)}
    <relation id="7" type="assembly"><ref id="6" role="assembly"/><ref id="1" role="part"/></relation>
    <relation id="8" type="assembly"><ref id="6" role="assembly"/><ref id="7" role="part"/></relation>
  </relations>
  <components>
    <component id="5" type="cylindrical_stage" name="first stage">
      <attribute id="center_distance" unit="m">0.19</attribute>
      <attribute id="bearing_matrix" unit="N / mm"><matrix><r><c>1.5</c><c>2</c></r><r><c>3</c><c>4</c></r></matrix></attribute>
    </component>
    {GEAR.format(n=1, z=27, beta=21, flank=FLANK, place="AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA")}
    {GEAR.format(n=2, z=51, beta=-21, flank=FLANK, place="AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA")}
    <component id="6" type="shaft"/>
    <component id="7" type="external_load"/>
    <component id="8" type="concept_bearing">
      <attribute id="lists" unit="mm">
        <array_of_arrays><array><c>1</c></array><array><c>2</c><c>3</c></array></array_of_arrays>
      </attribute>
    </component>
  </components>
  <load_spectrum id="1">
    <load_case id="1"><component id="7"><attribute id="torque_around_u_axis" unit="N m">567</attribute></component></load_case>
    <load_case id="2"><component id="7"><attribute id="torque_around_u_axis" unit="kN m">-0.3</attribute></component></load_case>
    <accumulation><component id="8"><attribute id="life" unit="h">30000</attribute></component></accumulation>
  </load_spectrum>
</model>
"""


def written(folder: Path, text: str, name: str = "gearbox.rexs") -> Path:
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.quick
def test_all_forms_have_the_same_model(tmp_path: Path) -> None:
    model = read_rexs(written(tmp_path, FILE))
    for suffix in (".rexs", ".rexsj", ".rexsz", ".rexsj"):
        file = tmp_path / f"again{suffix}"
        file.write_bytes(rexs_bytes(model, file))
        again = read_rexs(file)
        assert rexs_bytes(again, file) == rexs_bytes(model, file)
        # the text of numbers may be another: 50 or 50.0
        plain = [re.sub(r"(?<=\d)\.0\b", "", rexs_bytes(one, "x.rexs").decode()) for one in (model, again)]
        assert plain[0] == plain[1]
        model = again


@pytest.mark.quick
@pytest.mark.parametrize("version", READ_VERSIONS)
def test_the_design_of_a_stage_and_what_it_leaves(version: str, tmp_path: Path) -> None:
    reading = gm.load_rexs(written(tmp_path, FILE.replace('version="1.7"', f'version="{version}"')))
    design = reading.design
    assert (design.kind, design.name, design.module, design.helix_angle, design.hand) == (
        "cylindrical",
        "first stage",
        4.5,
        21,
        "right",
    )
    assert (design.pinion.teeth, design.gear.teeth, design.assembly.center_distance) == (27, 51, 190.0)
    assert (design.pinion.profile_shift, design.pinion.face_width, design.pressure_angle) == (0.25, 50, 20)
    assert [(one.gear, one.load_case, one.torque_Nm) for one in reading.torques] == [
        ("cylindrical_gear 1", "1", 567.0),
        ("cylindrical_gear 1", "2", -300.0),
    ]
    assert ("concept_bearing 8", "lists") in [(one.component, one.attribute) for one in reading.unused]
    assert ("concept_bearing 8 (accumulation)", "life") in [(one.component, one.attribute) for one in reading.unused]
    assert len(reading.unused) == 4
    assert "no tool in the file" in reading.warnings[0]


BOMB = """<?xml version="1.0"?>
<!DOCTYPE m [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<model version="1.7">&b;</model>"""
TWO_VALUES = (
    '{"model": {"version": "1.7", "components": [{"id": 1, "attributes": [{"id": "a", "string": "1", "integer": 1}]}]}}'
)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "name", "why"),
    [
        (BOMB, "a.rexs", "has a document type"),
        ("<model version='1.7'>" + "<a>" * 40, "a.rexs", "nested too deeply"),
        ("<model version='1.7'", "a.rexs", "not XML: unclosed token"),
        ("", "a.rexs", "not XML: no element found"),
        ("<gearbox/>", "a.rexs", "its root is <gearbox>"),
        ("<model/>", "a.rexs", "<model> without version"),
        (FILE.replace('"1.7"', '"2.0"', 1), "a.rexs", "REXS version '2.0'; read are 1.0 to 1.7"),
        (FILE.replace('component id="6"', 'component id="7"'), "a.rexs", "two components have the id 7"),
        (FILE.replace("number_of_teeth", "teeth"), "a.rexs", 'cylindrical_gear 1 "gear 1": number_of_teeth: missing'),
        (FILE.replace(">27<", ">27.5<"), "a.rexs", 'cylindrical_gear 1 "gear 1": number_of_teeth = 27.5: not a whole number'),
        (FILE.replace(">50<", ">nan<", 1), "a.rexs", 'cylindrical_gear 1 "gear 1": face_width = nan: not a number'),
        (FILE.replace(">50<", ">wide<", 1), "a.rexs", 'cylindrical_gear 1 "gear 1": face_width = wide: not a number'),
        (FILE.replace('"mm">50<', '"kg">50<', 1), "a.rexs", '1 "gear 1": face_width: must be in mm, mum, is in kg'),
        (FILE.replace(">0.25<", ">0.2<", 1), "a.rexs", "= 0.25: the other flank, cylindrical_gear_flank 11, has 0.2; flanks"),
        (FILE.replace(">4.5<", ">4<", 1), "a.rexs", '2 "gear 2": normal_module = 4.5: must be 4 mm, as the mating gear'),
        (FILE.replace(">-21<", ">21<", 1), "a.rexs", "helix_angle_reference_diameter = 21.0: must be -21 deg"),
        (FILE.replace('<ref id="2" role="gear_2"/>', '<ref id="99" role="gear_2"/>'), "a.rexs", "refers to component 99"),
        (FILE.replace('type="stage"', 'type="pair"'), "a.rexs", '5 "first stage": no relation of type stage says'),
        (FILE.replace("cylindrical_stage", "chain"), "a.rexs", "has no stage of these types: cylindrical_stage,"),
        ("{", "a.rexsj", "line 1, column 2"),
        ("[1]", "a.rexsj", "the file is not an object"),
        (100_000 * "[", "a.rexsj", "nested too deeply"),
        ('{"model": 3}', "a.rexsj", "model is not an object"),
        ('{"model": {"version": "1.7", "components": {"id": 1}}}', "a.rexsj", "components is not an array"),
        (TWO_VALUES, "a.rexsj", "attribute a with 2 values: string, integer"),
        ("no zip", "a.rexsz", "not a zip file that can be read"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_refused_in_one_line(text: str, name: str, why: str, tmp_path: Path) -> None:
    file = written(tmp_path, text, name)
    with pytest.raises(DesignError) as refusal:
        gm.load_rexs(file)
    message = str(refusal.value)
    assert why in message
    assert name in message
    assert "\n" not in message


@pytest.mark.quick
def test_files_that_grow_are_not_unpacked(tmp_path: Path) -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("a.rexs", "w") as file:
        for _ in range(300):
            file.write(bytes(1 << 20))
    bomb = tmp_path / "bomb.rexsz"
    bomb.write_bytes(packed.getvalue())
    tracemalloc.start()
    try:
        with pytest.raises(DesignError, match="larger than 32 MiB unzipped"):
            read_rexs(bomb)
        assert tracemalloc.get_traced_memory()[1] < 4 * MAX_FILE_BYTES
    finally:
        tracemalloc.stop()


@pytest.mark.quick
def test_of_several_stages_one_is_named(tmp_path: Path) -> None:
    more = '<component id="9" type="cylindrical_stage"/><component id="6" type="shaft"/>'
    file = written(tmp_path, FILE.replace('<component id="6" type="shaft"/>', more))
    with pytest.raises(DesignError, match=r'2 stages; name one; allowed is 5 \(cylindrical_stage "first stage"\), 9'):
        gm.load_rexs(file)
    with pytest.raises(DesignError, match="the file has no such stage; allowed is 5"):
        gm.load_rexs(file, "8")
    assert gm.load_rexs(file, "5").design.pinion.teeth == 27


def test_a_design_that_was_read_keeps_what_its_file_has(tmp_path: Path) -> None:
    file = written(tmp_path, FILE)
    gm.load_rexs(file).save(tmp_path / "stage.toml")
    design = gm.load(tmp_path / "stage.toml", ["pinion.face_width=44"])
    gm.build(design).rexs(tmp_path).save(tmp_path / "new.rexsj")
    before, after = read_rexs(file), read_rexs(tmp_path / "new.rexsj")
    for component in before.components:
        one = after.component(component.id)
        assert one is not None
        for id, attribute in component.attributes.items():
            if (component.id, id) not in {("1", "face_width"), ("5", "center_distance")}:
                texts = [re.sub(r"(?<=\d)\.0\b", "", str(each.text)) for each in (attribute, one.attributes[id])]
                assert texts[0] == texts[1], id
    assert {one.id for one in before.relations} <= {one.id for one in after.relations}
    assert [case.id for case in after.load_cases] == ["1", "2", ""]
    again = gm.load_rexs(tmp_path / "new.rexsj")
    assert again.design.pinion.face_width == 44
    assert [one.torque_Nm for one in again.torques] == [567.0, -300.0]
