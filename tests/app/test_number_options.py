"""Options that are numbers refuse what is none with its value; files that cannot be written are refused before any work."""

from __future__ import annotations

from pathlib import Path

import pytest
from oracles.command_line import refused
from oracles.places import SAMPLES

HELICAL = SAMPLES / "helical.toml"


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("solid", "--member", "gear", "--sector", "two"), "--sector = two: must be a whole number"),
        (("render", "--view", "te", "--dpi", "1.5"), "--dpi = 1.5: must be a whole number from 20 up to 1200"),
        (("render", "--view", "te", "--dpi", "5000"), "--dpi = 5000: must be a whole number from 20 up to 1200"),
        (("render", "--phi1", "x"), "--phi1 = x: must be a number"),
        (("fe", "--torque", "1Nm"), "--torque = 1Nm: must be a bare number in Nm, without letters behind it"),
    ],
)
def test_numbers_that_are_none_are_refused_in_one_line_with_the_value(
    tmp_path: Path, arguments: tuple[str, ...], text: str
) -> None:
    assert refused(arguments[0], HELICAL, *arguments[1:], "-o", tmp_path / "out.png") == text


@pytest.mark.quick
def test_models_of_unknown_suffixes_are_refused_before_the_design_is_read(tmp_path: Path) -> None:
    """There is a file, and no design in it."""
    broken = tmp_path / "broken.toml"
    broken.write_text("kind = ")
    assert "unknown suffix .xyz; allowed for finite-element models" in refused("fe", broken, "-o", tmp_path / "x.xyz")
    assert "the suffix of abaqus files is .inp" in refused("fe", broken, "-o", tmp_path / "x.msh", "--for", "abaqus")


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("--view", "toolpath"), "--tool: missing; the view toolpath needs a cutter, as ball:3mm"),
        (("--tool", "ball:3mm"), "--tool = ball:3mm: is for the view toolpath; --view is contact"),
        (("--scallop", "10um"), "--scallop = 10um: is for the view toolpath; --view is contact"),
    ],
)
def test_pictures_of_tool_paths_need_a_cutter_and_others_have_none(
    tmp_path: Path, arguments: tuple[str, ...], text: str
) -> None:
    assert refused("render", HELICAL, *arguments, "-o", tmp_path / "out.png") == text
