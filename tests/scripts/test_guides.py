"""scripts/guides.py, and the guides themselves: every block runs, and prints and draws what stands after it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from oracles.scripts import script

guides = script("guides")
NOTEBOOKS = sorted(guides.GUIDES.glob("*.ipynb"))

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
from PIL import Image

two = tomllib.load(open("numbers.toml", "rb"))["two"]
```
```python
print(two + two)
Image.new("RGB", (80, 60), "red").save("sum.png")
```
```text
4.00
```
<!-- needs: a-program-that-nobody-has -->

```bash
exit 1
```
```text
not compared
```
![the sum](pictures/sum_sum.png)
"""


def run(tmp_path: Path, *change: str, write: bool = False) -> Path:
    """The guide, run with a change of its text."""
    path = tmp_path / "sum.md"
    path.write_text(GUIDE.replace(*change) if change else GUIDE, encoding="utf-8")
    folder = tmp_path / "folder"
    folder.mkdir(exist_ok=True)
    guides.run(path, folder, write=write)
    return path


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The picture that is kept of the guide of this file: a red sheet."""
    from PIL import Image

    monkeypatch.setattr(guides, "PICTURES", tmp_path / "kept")
    (tmp_path / "kept").mkdir()
    path = tmp_path / "kept" / "sum_sum.png"
    Image.new("RGB", (40, 30), "red").save(path)
    return path


@pytest.mark.quick
@pytest.mark.usefixtures("kept")
def test_blocks_run_in_order_and_share_their_folder_and_names(tmp_path: Path) -> None:
    assert run(tmp_path).read_text(encoding="utf-8") == GUIDE


@pytest.mark.quick
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("two = 2.003", "two = 2.002"), r"sum.md:9: printed: 'two = 2.004', not 'two = 2.002'"),
        (("...\n", ""), "not printed: 'right'"),
        (("...\nright\n", ""), "printed, too: 'left over'"),
        (("right\n```\n```python", "left\n```\n```python"), "not printed: 'left'"),
        (("echo right", "exit 3"), "sum.md:6: status 3"),
        (("two + two", "two + too"), "sum.md:20: Traceback"),
        (("4.00\n", "3.99\n"), "printed: '4.008', not '3.99'"),
        (("<!-- needs: a-program-that-nobody-has -->\n", ""), "sum.md:28: status 1"),
        (('"red"', '"white"'), "sum_sum.png looks unlike sum.png"),
        (("(80, 60)", "(80, 80)"), "sum_sum.png looks unlike sum.png"),
        (("sum_sum.png)", "other.png)"), "names of its pictures begin with sum_"),
    ],
)
@pytest.mark.usefixtures("kept")
def test_a_guide_that_is_wrong_fails_at_its_line(change: tuple[str, str], words: str, tmp_path: Path) -> None:
    with pytest.raises(guides.GuideError, match=words):
        run(tmp_path, *change)


@pytest.mark.quick
def test_what_is_printed_and_drawn_now_is_written(tmp_path: Path, kept: Path) -> None:
    kept.unlink()
    written = run(tmp_path, "4.00\n", "3.99\n", write=True).read_text(encoding="utf-8")
    assert written == GUIDE.replace("4.00\n", "4.008\n")
    assert kept.stat().st_size < 10_000
    # words do not change by themselves
    with pytest.raises(guides.GuideError, match="not printed: 'left'"):
        run(tmp_path, "right\n```\n```python", "left\n```\n```python", write=True)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("wanted", "printed", "agree"),
    [
        ("1.23", "1.24", True),
        ("1.23", "1.25", False),
        ("12", "13", False),
        ("1.0e-9", "1.1e-9", True),
        ("1.0e-9", "1.2e-9", False),
        ("a 1", "b 1", False),
        ("x1 5", "x2 5", False),
    ],
)
def test_numbers_agree_to_their_last_digit(wanted: str, printed: str, agree: bool) -> None:
    assert guides.same(wanted, printed) is agree


@pytest.mark.quick
def test_guides_have_titles_and_small_pictures_and_nothing_else_lies_there() -> None:
    shown: set[Path] = set()
    for path in guides.guides():
        assert path.read_text(encoding="utf-8").startswith("# ")
        shown |= set(guides.pictures(path).values())
    assert shown == set(guides.PICTURES.iterdir())
    assert all(picture.stat().st_size < 150_000 for picture in shown)


@pytest.mark.sweep
@pytest.mark.parametrize("path", guides.guides(), ids=lambda path: path.stem)
def test_a_guide_prints_what_it_says(path: Path, tmp_path: Path) -> None:
    guides.run(path, tmp_path)


@pytest.mark.quick
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_small_and_has_been_run(path: Path) -> None:
    """All cells have run in their order, and none has failed."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in code] == list(range(1, len(code) + 1))
    assert not [output for cell in code for output in cell["outputs"] if output["output_type"] == "error"]
    assert path.stat().st_size < 150_000
    assert "".join(notebook["cells"][0]["source"]).startswith("# ")


@pytest.mark.sweep
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_shows_what_is_kept(path: Path, tmp_path: Path) -> None:
    script("notebooks").run(path, tmp_path)
