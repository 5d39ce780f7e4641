"""The page of two designs: their figures with the change, the keys that differ, and what one design alone may ask for."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.reports.comparison import change


def rows(page: str, heading: str) -> dict[str, list[str]]:
    """Cells of the table under a heading, by the first cell of the row."""
    (body,) = re.findall(rf"<h2>{heading}</h2>(.*?)</section>", page, re.DOTALL)
    cells = [re.findall(r"<td>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", body)]
    return {row[0]: [unescape(text) for text in row[1:]] for row in cells if row}


def test_two_designs_stand_side_by_side(tmp_path: Path) -> None:
    """Only the key that differs is listed, though one design leaves it to its default; the change is that of the closed form."""
    first = gm.build(gm.load(SAMPLES / "spur.toml"))
    second = gm.build(gm.load(SAMPLES / "spur.toml", ["name=B&B", "pinion.addendum=0.9"]))
    page = first.compare(second).save(tmp_path / "both.html").read_text(encoding="utf-8")
    assert rows(page, "Keys that differ") == {
        "name": [first.design.title, "B&B"],
        "pinion.addendum": ["1 (default)", "0.9"],
    }
    # involutes of z 20 and 40, module 3 mm, 20 deg, x = +-0.3, on a centre distance of 90 mm: length of contact over base pitch
    base = 1.5 * np.cos(np.radians(20.0)) * np.array([20.0, 40.0])
    tips = [3.0 * np.array([10.0 + 0.3 + addendum, 20.0 - 0.3 + 1.0]) for addendum in (1.0, 0.9)]
    contact = [np.sqrt(tip**2 - base**2).sum() - 90.0 * np.sin(np.radians(20.0)) for tip in tips]
    ratios = [length / (3.0 * np.pi * np.cos(np.radians(20.0))) for length in contact]
    shown = rows(page, "Figures")
    assert len(shown) == 8
    assert [float(text) for text in shown["Contact ratio"][:2]] == pytest.approx(ratios, abs=5e-3)
    step = ratios[1] - ratios[0]
    assert step < -0.05
    assert float(shown["Contact ratio"][2].split()[0].replace("\u2212", "-")) == pytest.approx(step, abs=5e-4)
    assert shown["Gear ratio"][2] == "equal"
    # amplitudes of rounding have no change
    assert shown["Harmonics 1, 2, 3 of it"] == ["below 0.001\u00a0arcsec", "below 0.001\u00a0arcsec", "equal"]
    assert "<script" not in page
    assert page.count("<img ") == 3


@pytest.mark.parametrize(
    ("amounts", "unit", "text"),
    [
        ((2.0, 2.5), "mm", "+0.5 mm (+25 %)"),
        ((50.0, 40.0), "%", "\u221210 %"),
        ((0.0, 1.0), "", "+1"),
        ((3.0, None), "", ""),
    ],
)
def test_change_has_sign_unit_and_share(amounts: tuple[float, float | None], unit: str, text: str) -> None:
    assert change(*amounts, unit) == text


def test_what_belongs_to_one_design_is_refused_with_two() -> None:
    both = ("report", SAMPLES / "spur.toml", SAMPLES / "rack.toml")
    assert refused(*both, "--check") == "--check: must be left out where two designs are compared"
    said = refused("report", SAMPLES / "spur.toml", "--errors", "assembly.dx=0,0.1")
    assert said.startswith("--errors assembly.dx=0,0.1: needs OTHER, a second design")
    assert "another.toml" in refused("report", SAMPLES / "spur.toml", "another.toml")
    status, _, err = run("report", SAMPLES / "spur.toml", SAMPLES / "spur.toml", "-o", "both.txt")
    assert (status, "its suffix must be .html" in err) == (2, True)


@pytest.mark.sweep
def test_loads_and_errors_of_assembly_stand_beside_each_other() -> None:
    """A narrow pair and its pinion with crowning, whose figures a study finds likewise at 9 positions."""
    tables = {"pinion": {"teeth": 20, "face_width": 6}, "gear": {"teeth": 31, "face_width": 6}}
    first = gm.build(gm.parse({"kind": "cylindrical", "module": 2, **tables}))
    crowned = {**tables["pinion"], "modifications": {"helix_crowning": 0.01}}
    second = gm.build(gm.parse({"kind": "cylindrical", "module": 2, **tables, "pinion": crowned}))
    page = first.compare(second, torque=10, errors={"assembly.gamma_v": [0.0, 0.05]}).html
    shown = rows(page, "Under load")
    _, before, after, step = shown["largest pressure, MPa"]
    found = [gears.loaded_contact(10).totals[0] for gears in (first, second)]
    assert [float(before), float(after)] == pytest.approx([total.max_pressure for total in found], rel=1e-3)
    share = 100.0 * (found[1].max_pressure / found[0].max_pressure - 1.0)
    assert f"(+{share:.3g} %)" in step
    assert set(shown) == {
        "transmission error, peak to peak, arcsec",
        "largest pressure, MPa",
        "root stress of the pinion, MPa",
        "root stress of the gear, MPa",
    }
    assert page.count("patterns on the pinion over assembly.gamma_v") == 4
