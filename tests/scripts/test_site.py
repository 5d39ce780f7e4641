"""scripts/site: built once, its links lead somewhere, and a browser opens it from files, at any width, without network."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest
import typer
from oracles.browser import chromium, needs_chromium, requests, resize
from oracles.places import ROOT

import gearmesh as gm
from gearmesh.api.reference import figure_groups
from gearmesh.app import cli
from gearmesh.formats import FILE_FORMATS

pytestmark = pytest.mark.sweep


#: what of a page is seen beyond the right edge of the screen and can not be moved there within a frame of its own
BEYOND = """
const framed = (item) => {
    for (let box = item; box && !["ARTICLE", "BODY"].includes(box.tagName); box = box.parentElement)
        if (["auto", "scroll"].includes(getComputedStyle(box).overflowX)
            && box.getBoundingClientRect().right <= document.documentElement.clientWidth + 1) return true;
    return false;
};
return [...document.querySelectorAll("header *, article, article *, footer *")].filter((item) => item.getClientRects().length
    && item.getBoundingClientRect().right > document.documentElement.clientWidth + 1 && !framed(item))
    .slice(0, 5).map((item) => item.outerHTML.slice(0, 100));
"""


class Page(HTMLParser):
    """Targets of links, files that are loaded, and the names of places in a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        #: address of each picture, and of the link around it
        self.pictures: list[tuple[str, str]] = []
        self._around = ""
        self.places: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        known = {name: value or "" for name, value in attrs}
        self.places |= {known[name] for name in ("id", "name") if name in known}
        if tag == "a":
            self._around = known.get("href", "")
        if tag == "img":
            self.pictures.append((known["src"], self._around))
        if "src" in known:
            self.loaded.append(known["src"])
        if "href" in known:
            (self.links if tag == "a" else self.loaded).append(known["href"])

    def handle_endtag(self, tag: str) -> None:
        if tag == "a":
            self._around = ""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the site, built by its one command."""
    pytest.importorskip("sphinx", reason="Sphinx, of the extra [site], is not installed")
    folder = tmp_path_factory.mktemp("site") / "html"
    command = [sys.executable, ROOT / "scripts" / "site", "-o", folder]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Page]:
    return {path: Page(path) for path in site.rglob("*.html") if "_static" not in path.parts}


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    with chromium(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def test_links_anchors_and_files_are_there(site: Path, pages: dict[Path, Page]) -> None:
    broken, foreign = [], []
    for path, page in pages.items():
        for link in [*page.links, *page.loaded]:
            if link.startswith(("data:", "javascript:")):
                continue
            if "://" in link or link.startswith(("//", "mailto:")):
                foreign.append((path.name, link))
                continue
            file, _, place = unquote(link).partition("#")
            target = (path.parent / file.partition("?")[0]).resolve() if file else path
            known = pages.get(target)
            if not target.exists() or (place and known is not None and place not in known.places):
                broken.append((path.relative_to(site).as_posix(), link))
    assert len(pages) > 60
    assert not broken
    # what the theme says of itself, which is followed by a click alone
    assert [link for _, link in foreign if not link.endswith("/furo")] == []


def test_pictures_open_in_full_size(pages: dict[Path, Page]) -> None:
    pictures = {(path.name, *picture) for path, page in pages.items() for picture in page.pictures}
    assert len(pictures) > 80
    assert {(name, shown, opened) for name, shown, opened in pictures if opened != shown} == set()


def test_the_reference_has_all_that_the_program_has(pages: dict[Path, Page], site: Path) -> None:
    python = {place for path, page in pages.items() if path.parent.name == "python" for place in page.places}
    tables = [(site / f"reference/python/{name}.html").read_text(encoding="utf-8") for name in ("designs", "parts")]
    listed = {
        name for name in gm.__all__ if f"gearmesh.{name}" in python or any(f">{name}<" in text for text in tables)
    }
    assert set(gm.__all__) - listed == set()
    assert "gearmesh.Gears.loaded_contact" in python
    commands: Any = typer.main.get_command(cli.command_line())
    assert set(commands.commands) <= pages[site / "reference/commands.html"].places
    figures = (site / "reference/figures.html").read_text(encoding="utf-8")
    assert not [figure.key for group in figure_groups() for figure in group.figures if f">{figure.key}<" not in figures]
    for kind in gm.kinds():
        keys = (site / f"reference/keys/{kind}.html").read_text(encoding="utf-8")
        assert not [line.key for line in gm.system(kind).design.key_lines() if line.key.rpartition(".")[2] not in keys]
        assert f"../schema/{kind}.json" in keys or "_downloads" in keys


def test_pages_show_measured_tables_and_no_link_to_a_file(site: Path) -> None:
    for page in ("scripts/measured", "gearmesh/study/notes", "gearmesh/loaded/notes"):
        text = (site / f"{page}.html").read_text(encoding="utf-8")
        assert "<table" in text
        assert ".csv</a>" not in text
    measured = (site / "scripts/measured.html").read_text(encoding="utf-8")
    assert "one batch is faster, times" in measured


def test_the_page_of_formats_has_all_suffixes(site: Path) -> None:
    page = (site / "reference" / "formats.html").read_text(encoding="utf-8")
    suffixes = {suffix for entry in FILE_FORMATS for suffix in entry.suffixes}
    assert not [suffix for suffix in suffixes if not re.search(rf"{re.escape(suffix)}\b", page)]


def test_the_first_minutes_of_the_home_page_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its design, the commands on it, and the Python."""
    home = (ROOT / "scripts" / "site" / "pages" / "index.md").read_text(encoding="utf-8")
    blocks = dict(re.findall(r"```(toml|python)\n(.*?)```", home, re.DOTALL))
    monkeypatch.chdir(tmp_path)
    Path("pair.toml").write_text(blocks["toml"], encoding="utf-8")
    exec(compile(blocks["python"], "index.md", "exec"), {"print": lambda answer: None})
    assert Path("pair.step").stat().st_size > 100_000
    commands: Any = typer.main.get_command(cli.command_line())
    lines = re.findall(r"^    gearmesh (\w+) (.*?)  ", home, re.MULTILINE)
    assert len(lines) == 4
    for name, words in lines:
        commands.commands[name].make_context(name, words.split())


@needs_chromium
def test_pages_load_from_files_alone_and_fit_a_phone(pages: dict[Path, Page], browser: Any) -> None:
    resize(browser, 400)
    requests(browser)
    for path in pages:
        browser.get(path.as_uri())
        assert browser.execute_script(BEYOND) == [], path.name
        assert [entry for entry in browser.get_log("browser") if entry["level"] != "INFO"] == [], path.name
    asked = requests(browser)
    assert len(asked) > len(pages)
    assert [address for address in asked if not address.startswith(("file:", "data:"))] == []


@needs_chromium
def test_search_finds_a_word(site: Path, browser: Any) -> None:
    from selenium.webdriver.support.wait import WebDriverWait

    resize(browser, 1000)
    browser.get(f"{(site / 'search.html').as_uri()}?q=undercut")

    def targets(page: Any) -> list[str]:
        return [link.get_attribute("href") for link in page.find_elements("css selector", "#search-results li a")]

    WebDriverWait(browser, 20).until(lambda page: any("theory/limits" in target for target in targets(page)))
    assert [entry for entry in browser.get_log("browser") if entry["level"] != "INFO"] == []


@needs_chromium
def test_pages_follow_the_light_or_dark_of_the_screen(site: Path, browser: Any) -> None:
    shades = {}
    for scheme in ("light", "dark"):
        feature = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", feature)
        browser.get((site / "index.html").as_uri())
        shade = browser.execute_script("return getComputedStyle(document.body).backgroundColor")
        shades[scheme] = sum(map(int, shade.partition("(")[2].rstrip(")").split(",")[:3]))
    assert shades["light"] > 700
    assert shades["dark"] < 150
