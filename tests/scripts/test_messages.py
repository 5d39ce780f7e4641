"""scripts/messages.py: the list of all texts, docstrings and READMEs."""

from __future__ import annotations

import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from oracles.places import ROOT
from oracles.scripts import script

MESSAGES = script("messages")


@cache
def everything() -> list[Any]:
    """Return all texts, docstrings and READMEs."""
    found: list[Any] = MESSAGES.texts(kinds=MESSAGES.KINDS + MESSAGES.DOCUMENTS)
    return found


@pytest.mark.sweep
@pytest.mark.quick
def test_the_list_has_every_kind_of_text(tmp_path: Path) -> None:
    """A refusal by its field, a warning, a figure, a key, a command with its option, a docstring, and texts inside of others."""
    listed = {
        kind: [text for text in everything() if text.kind == kind] for kind in MESSAGES.KINDS + MESSAGES.DOCUMENTS
    }
    assert all(listed.values())
    fields = {text.field for text in listed["refusal"]}
    assert {"reason", "allowed", "must_be", "remedy"} <= fields
    for kind, file, words in (
        ("refusal", "gearmesh/answers/contact/ease_off.py", "the flanks never meet"),
        ("message", "gearmesh/answers/contact/fit.py", "the pair is jammed"),
        ("figure", "gearmesh/answers/contact/fit.py", "normal backlash, least"),
        ("key", "gearmesh/design/core.py", "bore diameter; 0 = no bore"),
        ("command", "gearmesh/app/commands/contact/check.py", "Meshes against exact surfaces"),
        ("option", "gearmesh/app/commands/designs/size.py", "Gear ratio."),
        ("label", "gearmesh/view/diagrams/plots.py", "transmission error"),
        ("file", "gearmesh/fe/decks/inp.py", "** mm, N, MPa"),
        ("docstring", "gearmesh/contact/fit/fit.py", "Fit of a pair of gears"),
        ("readme", "README.md", "## Gear systems"),
    ):
        assert any(text.file == file and words in text.text for text in listed[kind]), words
    source = tmp_path / "inside.py"
    source.write_text("warn(f\"backlash is {'not known here' if x else y} mm\")\n", encoding="utf-8")
    inside = [text.text for text in MESSAGES.found_in(source.name, source.read_text(encoding="utf-8"))]
    assert inside == ["backlash is {'not known here' if x else y} mm", "not known here"]


def test_the_script_prints_the_list() -> None:
    file = ROOT / "gearmesh" / "answers" / "contact" / "ease_off.py"
    arguments = [sys.executable, ROOT / "scripts" / "messages.py", "--kind", "refusal", file]
    printed = subprocess.run(arguments, capture_output=True, text=True, check=True).stdout.splitlines()
    assert len(printed) == 2
    assert re.fullmatch(
        r"gearmesh/answers/contact/ease_off\.py:\d+: refusal\.reason: the flanks never meet", printed[0]
    )
