"""The README's Python prints what the README says it prints, and its commands exist."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def section(title: str) -> str:
    """What stands under a heading."""
    found = re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", README, re.DOTALL | re.MULTILINE)
    assert found is not None, f"no heading {title!r}"
    return found[1]


def test_the_python_of_the_readme_prints_what_it_says() -> None:
    """Every snippet runs in the checkout; a ```text block after it, before the next snippet, is what it prints."""
    blocks = re.findall(r"```(python|text)\n(.*?)```", section("In Python"), re.DOTALL)
    assert "python" in [kind for kind, _ in blocks]
    for k, (kind, code) in enumerate(blocks):
        if kind == "text":
            continue
        run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stderr
        if k + 1 < len(blocks) and blocks[k + 1][0] == "text":
            assert run.stdout == blocks[k + 1][1]


def test_the_commands_of_the_readme_are_the_program_s() -> None:
    documented = set(re.findall(r"^    gearmesh (\w+)", README, re.MULTILINE))
    run = subprocess.run([sys.executable, "-m", "gearmesh", "--help"], capture_output=True, text=True, check=True)
    offered = set(re.findall(r"^ +(\w+) {2,}\S", run.stdout.partition("Commands")[2], re.MULTILINE))
    assert documented == offered
