"""READMEs are right: links lead somewhere, commands parse, designs load, and the Python prints the text that stands after it."""

from __future__ import annotations

import ast
import os
import re
import shlex
import subprocess
import sys
import urllib.request
from pathlib import Path
from typing import Any

import pytest
import typer
from oracles.command_line import run
from oracles.places import PACKAGE, ROOT, SAMPLES

import gearmesh as gm
from gearmesh.app import cli
from gearmesh.app.options import is_train

FILES = sorted(
    path.relative_to(ROOT).as_posix()
    for path in (ROOT / "README.md", *(p for top in ("gearmesh", "samples", "scripts") for p in (ROOT / top).rglob("*.md")))
    if path.name in ("README.md", "notes.md", "measured.md") and "pages" not in path.relative_to(ROOT).parts
)  # fmt: skip
#: this checkout, wherever a program runs
OWN = {**os.environ, "PYTHONPATH": str(ROOT)}
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS: dict[str, Any] = typer.main.get_command(cli.command_line()).commands  # type: ignore[attr-defined]
SYSTEMS = sorted(path.parent for path in PACKAGE.glob("systems/*/build.py"))


def read(file: str) -> str:
    return (ROOT / file).read_text(encoding="utf-8")


def links(text: str) -> list[str]:
    """Targets of links and pictures."""
    return re.findall(r"\]\(([^)\s]+)\)", text) + re.findall(r'src="([^"]+)"', text)


def commands(text: str) -> list[str]:
    """Command lines of the program, without the words beside them: from code blocks, and from code in sentences."""
    blocks = re.findall(r"^    (?:.*/bin/)?gearmesh (.*(?:\n {8,}\[.*)*)", text, re.MULTILINE)
    return [
        *(" ".join(re.split(r" {2,}(?![\[ ])", line)[0].split()) for line in blocks),
        *re.findall(r"`gearmesh ([^`]+)`", text),
    ]


def is_usage(command: str) -> bool:
    """True for a line that describes a command, as `tca DESIGN [--json FILE|-]`, and cannot be typed."""
    return re.search(r"\[|\b[A-Z]{4,}\b", command) is not None


def refusal(command: str) -> str:
    """Return the fault of a command line that could be typed; "" if it parses and its design loads with its settings."""
    name, *words = shlex.split(command)
    if name not in COMMANDS:
        return f"no command {name}"
    try:
        values = COMMANDS[name].make_context(name, list(words)).params if words else {}
    except Exception as error:  # the parser's own errors, wherever typer keeps them
        # files of readers' own are not here, as those of other programs that `convert` reads
        return "" if str(error).endswith("cannot be read: No such file or directory") else str(error)
    design = values.get("design_file")
    if design is not None:
        # studies are of trains too
        read_design = gm.load_train if is_train(ROOT / design) else gm.load
        read_design(ROOT / design, values.get("settings") or [])
    if name == "describe":
        status, _, message = run(name, *words)
        return message if status and not message.endswith("No such file or directory\n") else ""
    return ""


#: those of the first design are run, below
CASES = [
    (file, command)
    for file in FILES
    for command in dict.fromkeys(commands(read(file)))
    if file != "README.md" or "spur.toml" not in command.split()
]


@pytest.mark.quick
@pytest.mark.parametrize("file", FILES)
def test_links_lead_somewhere(file: str) -> None:
    folder = (ROOT / file).parent
    missing = [to for to in links(read(file)) if not (folder / to.partition("#")[0]).exists()]
    # paths from the top, as the sentences name them
    named = re.findall(r"`((?:gearmesh|samples|scripts|tests)/[\w./]+)`", read(file))
    assert not missing + [path for path in named if not (ROOT / path).exists()]
    assert not [to for to in links(read(file)) if "://" in to]


@pytest.mark.quick
@pytest.mark.parametrize("file", FILES)
def test_scripts_that_are_named_exist(file: str) -> None:
    for script in re.findall(r"python ((?:samples|scripts)/\S+?\.py)", read(file)):
        assert (ROOT / script).is_file(), script


@pytest.mark.quick
@pytest.mark.parametrize(("file", "command"), [case for case in CASES if not is_usage(case[1])])
@pytest.mark.sweep_cases(
    "gearmesh/systems/cylindrical/spline/README.md-describe samples/spline.toml",
    "gearmesh/systems/spiral_bevel/hobbing/README.md-tca samples/hypoid_face_hobbed.toml --set contact.side=pinion_convex",
    "gearmesh/systems/spiral_bevel/hobbing/README.md-tca samples/hypoid_face_hobbed.toml --set process=face_hobbed",
    "gearmesh/systems/straight_bevel/README.md-describe samples/straight_bevel.toml --torque 20 --speed 1000",
    "gearmesh/systems/worm_drive/README.md-describe samples/worm_drive.toml --torque 20 --speed 1450",
)
def test_commands_parse_and_their_designs_load(file: str, command: str) -> None:
    assert refusal(command) == ""


@pytest.mark.quick
@pytest.mark.parametrize(("file", "usage"), [case for case in CASES if is_usage(case[1])])
def test_options_of_a_usage_line_exist(file: str, usage: str) -> None:
    name = usage.split()[0]
    offered = {option for parameter in COMMANDS[name].params for option in parameter.opts}
    assert set(re.findall(r"(?<![\w-])--?[a-z][a-z0-9-]*", usage)) <= offered


@pytest.mark.quick
def test_commands_that_are_wrong_are_found() -> None:
    block = "    gearmesh tca a.toml --set x.y=1     what it does\n    gearmesh fe DESIGN [-o FILE]\n             [--solve]  more\n"
    text = block + "As `gearmesh new` says."
    assert commands(text) == ["tca a.toml --set x.y=1", "fe DESIGN [-o FILE] [--solve]", "new"]
    assert refusal("weave samples/spur.toml") == "no command weave"
    assert "--knot" in refusal("tca samples/spur.toml --knot")
    assert "pattern" in refusal("render samples/spur.toml --view knot -o a.png")
    with pytest.raises(Exception, match=r"did you mean pinion\.teeth"):
        refusal("tca samples/spur.toml --set pinion.tooth=20")


@pytest.mark.quick
def test_the_page_of_commands_has_those_of_the_program() -> None:
    page = read("gearmesh/app/README.md")
    assert set(re.findall(r"^    gearmesh (\w+)", page, re.MULTILINE)) == set(COMMANDS)


@pytest.mark.quick
def test_pages_are_at_most_120_lines_long() -> None:
    """READMEs say what it is, how, what comes out, and limits; evidence goes to the notes beside them."""
    lines = {file: len(read(file).splitlines()) for file in FILES if file.endswith("README.md")}
    assert {file: count for file, count in lines.items() if count > 120} == {}


@pytest.mark.quick
def test_the_readme_is_short_and_shows_the_result_first() -> None:
    assert len(README.splitlines()) <= 110
    assert re.match(
        r"# gearmesh\n\n!\[.*\]\(samples/pictures/\w+\.png\)\n!\[.*\]\(samples/pictures/\w+\.png\)\n", README
    )
    # the first command runs gears that have backlash
    (sample,) = re.findall(r"gearmesh run (\S+) -o out$", README, re.MULTILINE)
    assert gm.load(ROOT / sample, complete=False).backlash > 0.0
    # what .ci/run takes for the tests' command
    assert len(re.findall(r"^    .* # test$", README, re.MULTILINE)) == 1


def section(title: str) -> str:
    """Return the text under a heading."""
    found = re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", README, re.DOTALL | re.MULTILINE)
    assert found is not None, f"no heading {title!r}"
    return found[1]


def page_is_served_until_it_is_ended(program: tuple[str, ...], folder: Path) -> None:
    """The command that ends only when it is told to."""
    whole = (*program, "--no-browser")
    with subprocess.Popen(whole, cwd=folder, stdout=subprocess.PIPE, text=True, env=OWN) as process:
        try:
            assert process.stdout is not None
            with urllib.request.urlopen(process.stdout.readline().strip(), timeout=30) as page:
                assert b"<title>gearmesh explore</title>" in page.read()
        finally:
            process.terminate()
        assert process.wait(30) == 0 or os.name == "nt"


def test_the_first_python_prints_what_the_readme_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same in this process, for the sweep runs the commands, too."""
    blocks = dict(re.findall(r"```(toml|python|text)\n(.*?)```", section("A pair of spur gears"), re.DOTALL))
    monkeypatch.chdir(tmp_path)
    Path("spur.toml").write_text(blocks["toml"])
    exec(blocks["python"], {})
    assert capsys.readouterr().out == blocks["text"]


@pytest.mark.sweep
def test_the_first_design_becomes_what_the_readme_says(tmp_path: Path) -> None:
    """Five lines of TOML; each command writes its file, and the Python prints what stands after it."""
    text = section("A pair of spur gears")
    blocks = dict(re.findall(r"```(toml|python|text)\n(.*?)```", text, re.DOTALL))
    assert len(blocks["toml"].splitlines()) == 5
    (tmp_path / "spur.toml").write_text(blocks["toml"])
    python = (sys.executable, "-c", blocks["python"])
    programs = [(sys.executable, "-m", "gearmesh", *shlex.split(line)) for line in commands(text)]
    for program in (python, *(p for p in programs if "spur.toml" in p)):
        if "explore" in program:
            page_is_served_until_it_is_ended(program, tmp_path)
            continue
        process = subprocess.run(program, cwd=tmp_path, capture_output=True, text=True, check=False, env=OWN)
        assert process.returncode == 0, process.stderr
        assert process.stdout == blocks["text"] or program is not python
    assert (tmp_path / "spur.step").read_text().startswith("ISO-10303-21")
    assert (tmp_path / "spur.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.quick
def test_every_gear_system_has_its_page() -> None:
    for folder in SYSTEMS:
        assert f"({folder.relative_to(ROOT).as_posix()}/README.md)" in README
    systems = README.partition("## Gear systems")[2].partition("\n## ")[0]
    assert all(f"`{kind}`" in systems for kind in gm.kinds())


#: folders of systems that are told of as wholes
OWN_PAGE = {"planetary", "rack", "single", "spline", "iso23509", "__pycache__"}


@pytest.mark.quick
@pytest.mark.parametrize("folder", SYSTEMS, ids=lambda folder: folder.name)
def test_the_notes_of_a_gear_system_name_its_modules(folder: Path) -> None:
    """All of the folder, none that is not there, and the root fillet's place."""
    where = (
        read(f"{folder.relative_to(ROOT).as_posix()}/notes.md")
        .partition("## Where things are")[2]
        .partition("\n## ")[0]
    )
    named = set(re.findall(r"`([\w/]+\.py)`", re.sub(r"\[[^]]*\]\([^)]*\)", "", where)))
    own = [folder, *(each for each in folder.iterdir() if each.is_dir() and each.name not in OWN_PAGE)]
    there = {path.relative_to(folder).as_posix() for each in own for path in each.glob("*.py")}
    assert named == {name for name in there if not name.endswith("__init__.py")}
    assert "fillet" in where


#: theory pages of gear systems
THEORY = sorted(path.relative_to(ROOT).as_posix() for path in PACKAGE.glob("systems/**/theory.md"))


def names_of_file(path: Path) -> set[str]:
    """Functions, classes and constants of a module, and methods and fields of its classes as Class.name."""
    found = set()

    def visit(body: list[ast.stmt], prefix: str) -> None:
        for node in body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                found.add(prefix + node.name)
                if isinstance(node, ast.ClassDef):
                    visit(node.body, f"{prefix}{node.name}.")
            for target in [node.target] if isinstance(node, ast.AnnAssign) else getattr(node, "targets", []):
                if isinstance(target, ast.Name):
                    found.add(prefix + target.id)

    visit(ast.parse(path.read_text(encoding="utf-8")).body, "")
    return found


def missing_places(text: str, folder: Path) -> list[str]:
    """Places `file.py:name` of a page whose file or name does not exist; files are relative to the page's folder."""
    places = set(re.findall(r"`([\w./]+\.py):([\w.]+)`", text))
    files = {file: folder / file for file, _ in places}
    known = {file: names_of_file(path) if path.is_file() else set[str]() for file, path in files.items()}
    return sorted(f"{file}:{name}" for file, name in places if name not in known[file])


@pytest.mark.quick
@pytest.mark.parametrize("file", THEORY)
def test_places_that_a_theory_page_names_exist(file: str) -> None:
    text = read(file)
    assert missing_places(text, (ROOT / file).parent) == []
    assert len(re.findall(r"`[\w./]+\.py:[\w.]+`", text)) >= 10
    assert len(re.findall(r"\$\$", text)) >= 6
    links_to = [(ROOT / file).parent / to.partition("#")[0] for to in links(text)]
    assert [to for to in links_to if not to.exists()] == []
    assert "(theory.md)" in read(file.replace("theory.md", "README.md"))


@pytest.mark.quick
def test_places_that_do_not_exist_are_found() -> None:
    text = "`build.py:build`, `build.py:biuld`, `design.py:CylindricalMember.teeeth`, `nowhere.py:a`, `build.py`"
    wanted = ["build.py:biuld", "design.py:CylindricalMember.teeeth", "nowhere.py:a"]
    assert missing_places(text, PACKAGE / "systems" / "cylindrical") == wanted


@pytest.mark.quick
def test_the_gallery_shows_every_sample() -> None:
    gallery = read("samples/README.md")
    for path in (p for p in SAMPLES.iterdir() if p.suffix in (".toml", ".py")):
        rows = [line for line in gallery.splitlines() if f"[{path.name}]({path.name})" in line]
        assert len(rows) == 1
        assert f'<img src="pictures/{path.stem}.png"' in rows[0]


@pytest.mark.quick
def test_pictures_are_small_and_all_are_shown() -> None:
    pictures = list((SAMPLES / "pictures").iterdir())
    assert all(path.suffix == ".png" and path.stat().st_size < 100_000 for path in pictures)
    # shaded teeth and hatched sections take a quarter more than flat colours did; a kind adds its pictures
    assert sum(path.stat().st_size for path in pictures) < 33_000 * len(pictures)
    shown = {((ROOT / file).parent / to).resolve() for file in FILES for to in links(read(file)) if to.endswith(".png")}
    # others belong to guides, which are compared with what they draw
    shown = {path for path in shown if path.parent.name != "pictures" or path.parent.parent.name != "guides"}
    assert shown == {path.resolve() for path in pictures}
