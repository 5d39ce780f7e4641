"""Designs from standard input: "-" stands for the file."""

from __future__ import annotations

import io
import sys

import pytest

from gearmesh.app.cli import main

GEAR = "kind = 'cylindrical'\nmodule = 1\n[gear]\nteeth = 12\nface_width = 4\n"
GEAR_JSON = '{"kind": "cylindrical", "module": 1, "gear": {"teeth": 12, "face_width": 4}}'


def piped(monkeypatch: pytest.MonkeyPatch, content: bytes, *arguments: str) -> int:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(content)))
    return main(arguments)


@pytest.mark.parametrize("text", [GEAR, GEAR_JSON])
@pytest.mark.sweep_cases("kind = 'cylindrical'\\nmodule = 1\\n[gear]\\nteeth = 12\\nface_width = 4\\n")
def test_reads_toml_and_json(text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert piped(monkeypatch, text.encode(), "describe", "-", "--set", "gear.teeth=17") == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["z", "teeth;", "internal:", "negative", "-", "17"] in rows


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (b"kind =", "standard input (-): Invalid value (at end of document)"),
        (b"a" * (1 << 20) + b"b", "standard input (-): is larger than 1 MiB, the limit for a design file"),
        (b"\xff", "standard input (-): not UTF-8 text (byte 0)"),
        (b"[1, 2]", "standard input (-): a design is a table (an object in JSON), not [1, 2]"),
        (b"", "kind: missing; must be one of"),
    ],
)
def test_refuses_in_one_line(
    content: bytes, line: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert piped(monkeypatch, content, "limits", "-") == 2
    said = capsys.readouterr().err
    assert said.startswith(f"gearmesh: error: {line}")
    assert said.count("\n") == 1
