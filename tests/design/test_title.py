"""Titles of designs without a name, at the heads of pages, drawings and files."""

from __future__ import annotations

from typing import Any

import pytest

import gearmesh as gm

INCH = {"diametral_pitch": 8, "units": "inch"}


def gears(size: dict[str, Any], **teeth: int) -> dict[str, Any]:
    return {"kind": "cylindrical", **size, **{name: {"teeth": count, "face_width": 1} for name, count in teeth.items()}}


@pytest.mark.quick
@pytest.mark.parametrize(
    ("keys", "title"),
    [
        ({"name": "Stage 1", **gears({"module": 2}, pinion=20, gear=40)}, "Stage 1"),
        (gears({"module": 2}, pinion=20, gear=40), "Spur gears 20/40, m = 2 mm"),
        (gears({**INCH, "helix_angle": 15}, pinion=20, gear=40), "Helical gears 20/40, P_n = 8 per inch"),
        (gears({"transverse_module": 2.5, "helix_angle": 15}, pinion=20, gear=-60), "Internal helical gears 20/60, m_t = 2.5 mm"),
        (gears({"module": 1.25}, gear=30), "Spur gear, 30 teeth, m = 1.25 mm"),
        ({"kind": "rack", "module": 2, "rack": {"length": 100, "face_width": 20}}, "Rack, 15 teeth, m = 2 mm"),
        (
            {"kind": "worm_drive", "module": 4, "module_section": "normal", "worm": {"threads": 2}, "wheel": {"teeth": 40}},
            "Worm drive 2/40, m_n = 4 mm",
        ),
    ],
)  # fmt: skip
def test_a_design_without_a_name_is_called_as_an_engineer_would(keys: dict[str, Any], title: str) -> None:
    assert gm.parse(keys).title == title


@pytest.mark.quick
def test_titles_of_all_kinds_are_words_numbers_and_a_size() -> None:
    designs = [gm.parse({"kind": kind, **gm.system(kind).design.example}) for kind in gm.kinds()]
    assert len({design.kind_in_words for design in designs}) == len(designs)
    for design in designs:
        assert "_" not in design.title.partition(",")[0]
        assert f" {design.resolve().get('pinion', {'teeth': ''})['teeth']}" in design.title
        assert " mm" in design.title
