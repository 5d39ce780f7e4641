"""The README's Python prints what the README says it prints, and its commands exist."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_python_of_the_readme_prints_what_it_says() -> None:
    code = re.search(r"```python\n(.*?)```", README, re.DOTALL)
    printed = re.search(r"```text\n(.*?)```", README, re.DOTALL)
    assert code is not None
    assert printed is not None
    run = subprocess.run([sys.executable, "-c", code[1]], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout == printed[1]


def test_the_commands_of_the_readme_are_the_program_s() -> None:
    documented = set(re.findall(r"^    gearmesh (\w+)", README, re.MULTILINE))
    run = subprocess.run([sys.executable, "-m", "gearmesh", "--help"], capture_output=True, text=True, check=True)
    offered = set(re.findall(r"^ +(\w+) {2,}\S", run.stdout.partition("Commands")[2], re.MULTILINE))
    assert documented == offered
