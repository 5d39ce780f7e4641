"""scripts/messages.py: the list of all texts; they, docstrings and READMEs use the words of the field."""

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

#: words that only this program's authors would understand, and what the field says; in backticks and in what is filled in they
#: are names
PRIVATE = {
    r"\bg[ia]v(?:e|es|en|ing) way\b": "deflection, compliance; thinned, shortened",
    r"\b(?:is|are|was|were|be|been|being) (?:told|said)\b": "is reported",
    r"\btold (?:of|with|about|by|in|apart)\b": "warning; distinguished",
    r"\b(?:dents?|dented)\b": "local contact compliance",
    r"\bbricks?\b": "incompatible-mode hexahedra",
    r"\bpressure has no limit\b": "pressure is singular",
    r"\bcarr(?:y|ies) alike\b|\b(?:edges?|pairs?|who|that) carr(?:y|ies)\b(?! the)": "edge contact; load sharing",
    r"\bprospects?\b": "contact preview",
    r"\bto blame\b": "the key that makes the design infeasible",
    r"\b(?:un)?settle[sd]?\b|\blooked into\b": "converge; determine; refine",
    r"\b(?:ladders?|rungs?)\b": "strip triangulation, diagonals",
    r"\b(?:the|a|an|its|their|no|greatest|with a) leads?\b(?! angle)": "transmission advance; lead is that of a helix",
    r"(?<!of )\bcourses?\b|\bdrifts?\b": "joint, travel",
    r"(?<!gear )(?<!\.)\btrains?\b": "gear set",
    r"\bfront doors?\b": "public names",
    r"\bma(?:ke|kes|king|de) good\b|\bmakes good errors\b": "compensate",
    r"\b[Ww]hat \w+ stands? on\b|\bwhat (?:it|they|both) stands? on\b": "assumptions; body",
    r"\bone dict\b": "per torque, per kind",
    r"\bcomes? to (?!lie|rest)": "equals, reaches",
    r"\b(?:is|are|was|were) off by\b|\bvolume off by\b": "error",
    r"\b(?:a|the|no|any) folds?\b": "cusp",
    r"\btouch and none\b": "contact missed by one of both",
    r"\b(?:turn(?:s|ed|ing)?|driven) backwards\b": "coast side",
    r"\b(?:stands?|stood|standing) (?:at|still|beside|askew)\b": "position, fixed",
    r"\bwhere (?:it|they|both|all|(?:the )?members) stands?\b": "mounting, position",
    r"\bmates?\b": "mating gear",
    r"\brun(?:s|ning)? (?:most )?evenly\b|\beven running\b": "uniform transmission",
    r"\bpairs? of teeth\b": "tooth pair",
    r"\bhalf ax[ei]s\b": "semi-axis",
}


MESSAGES = script("messages")


@cache
def everything() -> list[Any]:
    """All texts, docstrings and READMEs."""
    found: list[Any] = MESSAGES.texts(kinds=MESSAGES.KINDS + MESSAGES.DOCUMENTS)
    return found


def private(text: str) -> list[str]:
    """The private words in a text, lines joined, and the field's instead."""
    plain = " ".join(re.sub(r"`[^`]*`|\{[^{}]*\}", " ", text).split())
    return [f"{found[0]!r} ({instead})" for word, instead in PRIVATE.items() if (found := re.search(word, plain))]


@pytest.mark.quick
def test_texts_use_the_words_of_the_field() -> None:
    found = [f"{text.file}:{text.line}: {', '.join(words)}" for text in everything() if (words := private(text.text))]
    # the glossary says what each word means here
    assert not [line for line in found if not line.startswith("gearmesh/README.md:")], "\n".join(found)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("teeth give way under load, and that is told", 2),
        ("the mate carries alike; edges carry", 2),
        ("the greatest lead of the gears", 1),
        ("a lead angle of 20 deg, a step that leads beyond; of course", 0),
        ("the mating gear carries the load; `mates` and {mate} are names", 0),
        ("a gear train; the settings; it comes to lie on the flank", 0),
        ("the value comes to 3 mm and is off by 2", 2),
    ],
)
def test_the_words_do_not_misfire(text: str, count: int) -> None:
    assert len(private(text)) == count


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
        ("docstring", "gearmesh/contact/fit/fit.py", "Whether a pair of gears fits"),
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
