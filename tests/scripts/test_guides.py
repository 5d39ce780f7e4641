"""scripts/guides.py, and the guides themselves: every block runs, and prints what stands after it."""

from __future__ import annotations

from pathlib import Path

import pytest
from oracles.scripts import script

guides = script("guides")

GUIDE = """# Two and two

```toml numbers.toml
two = 2.004
```
```bash
cat numbers.toml; echo; echo left   over; echo right
```
```text
two = 2.003
...
right
```
```python
import tomllib
two = tomllib.load(open("numbers.toml", "rb"))["two"]
```
```python
print(two + two)
open("sum.png", "w").close()
```
```text
4.00
```
![the sum](pictures/sum.png)
"""


def run(tmp_path: Path, *change: str) -> dict[str, str]:
    path = tmp_path / "sum.md"
    path.write_text(GUIDE.replace(*change) if change else GUIDE, encoding="utf-8")
    folder = tmp_path / "folder"
    folder.mkdir()
    printed: dict[str, str] = guides.run(path, folder)
    return printed


@pytest.mark.quick
def test_blocks_run_in_order_and_share_their_folder_and_names(tmp_path: Path) -> None:
    assert list(run(tmp_path).values()) == ["two = 2.004\n\nleft over\nright\n", "", "4.008\n"]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("two = 2.003", "two = 2.002"), r"sum.md:9: not printed: 'two = 2.002'"),
        (("...\n", ""), "not printed: 'right'"),
        (("right\n```\n```python", "left\n```\n```python"), "not printed: 'left'"),
        (("echo right", "exit 3"), "sum.md:6: status 3"),
        (("two + two", "two + too"), "sum.md:18: NameError"),
        (("4.00\n", "3.99\n"), "not printed: '3.99'"),
        (("sum.png)", "other.png)"), "no block writes other.png"),
    ],
)
def test_a_guide_that_is_wrong_fails_at_its_line(change: tuple[str, str], words: str, tmp_path: Path) -> None:
    with pytest.raises(guides.GuideError, match=words):
        run(tmp_path, *change)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("wanted", "printed", "agree"),
    [("1.23", "1.24", True), ("1.23", "1.25", False), ("12", "13", False), ("1.0e-9", "1.1e-9", True), ("a 1", "b 1", False)],
)  # fmt: skip
def test_numbers_agree_to_their_last_digit(wanted: str, printed: str, agree: bool) -> None:
    assert guides.same(wanted, printed) is agree


@pytest.mark.quick
@pytest.mark.parametrize("path", guides.guides(), ids=lambda path: path.stem)
def test_a_guide_has_a_title_and_its_pictures(path: Path) -> None:
    guide = path.read_text(encoding="utf-8")
    assert guide.startswith("# ")
    for name in guides.pictures(guide):
        assert (path.parent / "pictures" / name).stat().st_size < 200_000


@pytest.mark.sweep
@pytest.mark.parametrize("path", guides.guides(), ids=lambda path: path.stem)
def test_a_guide_prints_what_it_says(path: Path, tmp_path: Path) -> None:
    guides.run(path, tmp_path)
