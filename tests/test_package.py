"""Installed package: the samples wherever the package is, types, metadata, and no more names at the top than are meant."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from oracles.places import PACKAGE, ROOT, SAMPLES

from gearmesh import DesignError, OutputError, samples

PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
TOP = {"README.md", "findings", "gearmesh", "pyproject.toml", "samples", "scripts", "tests"}


def test_all_samples_have_a_name_and_a_headline() -> None:
    folders = (SAMPLES, SAMPLES / "trains")
    files = [path for folder in folders for path in folder.iterdir() if path.suffix in samples.SAMPLE_SUFFIXES]
    assert samples.names() == sorted(path.stem for path in files)
    assert "spur" in samples.names()
    for path in files:
        assert samples.text(path.stem) == samples.text(path.name) == path.read_text(encoding="utf-8")
        assert 15 <= len(samples.headline(path.stem)) <= 105
    assert samples.headline("spur").endswith("on a centre distance of 90 mm")
    assert samples.headline("fig9_beveloid_ellipse") == "How round is the contact of beveloid gears?"
    assert len(samples.guides()) >= 15
    assert samples.headline("01-spur-pair") == "Order a pair of spur gears"
    assert samples.headline("gears-in-3d.ipynb") == "Gears in 3-D"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("spurr", 'name = "spurr": no sample has this name; did you mean "spur"?'),
        ("spur.py", 'name = "spur.py": no sample has this name; did you mean "spur"?'),
        ("README", 'name = "README": '),
        ("../README.md", 'name = "../README.md": '),
        ("", 'name = "": no sample has this name; gearmesh sample lists them'),
    ],
)
def test_a_name_that_is_none_is_refused_with_the_nearest(name: str, words: str, tmp_path: Path) -> None:
    for refused in (lambda: samples.text(name), lambda: samples.copy(name, tmp_path)):
        with pytest.raises(DesignError) as found:
            refused()
        assert str(found.value).startswith(words)
    assert not list(tmp_path.iterdir())


def test_a_copy_is_the_sample_and_takes_nothing_s_place(tmp_path: Path) -> None:
    written = samples.copy("zerol", tmp_path)
    assert written == tmp_path / "zerol.toml"
    assert written.read_bytes() == (SAMPLES / "zerol.toml").read_bytes()
    written.write_text("mine", encoding="utf-8")
    with pytest.raises(OutputError, match="exists already"):
        samples.copy("zerol.toml", tmp_path)
    assert written.read_text(encoding="utf-8") == "mine"
    with pytest.raises(OutputError, match="cannot write"):
        samples.copy("zerol", tmp_path / "nowhere")


def test_files_that_a_sample_names_are_copied_with_it(tmp_path: Path) -> None:
    written = samples.copy("hypoid_measured", tmp_path)
    points = tmp_path / "hypoid_measured_pinion.csv"
    assert points.read_bytes() == (SAMPLES / points.name).read_bytes()
    written.unlink()
    with pytest.raises(OutputError, match=r"hypoid_measured_pinion\.csv: it exists already"):
        samples.copy("hypoid_measured", tmp_path)
    assert not written.exists()


def test_an_installed_package_has_them_inside(tmp_path: Path) -> None:
    """Laid out as the wheel is, by the rules of pyproject.toml."""
    wheel = PYPROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert set(wheel["only-include"]) == {"gearmesh", "samples"}
    assert set(wheel["exclude"]) == {"README.md", "notes.md", "*.svg", "samples/pictures", "samples/guides/pictures"}
    hidden = shutil.ignore_patterns("__pycache__", "README.md", "notes.md", "*.svg", "pictures")
    shutil.copytree(PACKAGE, tmp_path / "gearmesh", ignore=hidden)
    ((source, target),) = wheel["sources"].items()
    shutil.copytree(ROOT / source, tmp_path / target, ignore=hidden)
    program = (
        "import json; from gearmesh import samples as s; "
        "print(json.dumps([s.__file__, s.names(), s.guides(), s.text('spur')]))"
    )
    run = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    file, names, guides, text = json.loads(run.stdout)
    assert guides == samples.guides()
    assert Path(file).is_relative_to(tmp_path)
    assert names == samples.names()
    assert text == samples.text("spur")


def test_the_package_says_what_it_is() -> None:
    project = PYPROJECT["project"]
    assert (PACKAGE / "py.typed").is_file()
    assert "Typing :: Typed" in project["classifiers"]
    assert project["readme"] == "README.md"
    assert project["keywords"]
    # no licence has been chosen, and there are no addresses to give
    assert not {"license", "urls"} & set(project)
    assert not any(name.startswith("License") for name in project["classifiers"])


def test_nothing_but_what_is_meant_stands_at_the_top() -> None:
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("not a git checkout: what else lies here is not ours to judge")
    run = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    names = {line.partition("/")[0] for line in run.stdout.splitlines()}
    assert {name for name in names if not name.startswith(".")} == TOP
