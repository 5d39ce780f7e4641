"""The report page in a real Chromium, opened from a file: it draws, rolls, picks, asks for nothing, and does without WebGL."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.browser import chromium, needs_chromium, requests, resize
from oracles.loaded import loaded_contact
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.reports.report import report_page
from gearmesh.view.load.loaded_pictures import LoadedPictures

pytestmark = needs_chromium
NAME = "</script><script>document.title = 'bad'</script>"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Address of the page of a pair with contact in points, under three torques, and a stand-in for its picture."""
    gears = gm.build(gm.load(SAMPLES / "beveloid_crossed.toml", [f"name={NAME}"]))
    grey = np.full((60, 80, 3), 128, dtype=np.uint8)
    loaded = loaded_contact("beveloid_crossed", (2.0, 10.0, 30.0), 9)
    made = report_page(
        gears, {0: gears.contact()}, 0.05, images=[("pair in mesh", grey)], loaded={0: LoadedPictures(loaded)}
    )
    return made.save(tmp_path_factory.mktemp("page") / "report.html").as_uri()


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    with chromium(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def state(browser: Any) -> Any:
    return browser.execute_script("return window.gearmeshView.state")


def pixels(browser: Any, file: Path) -> np.ndarray:
    """RGB of what the canvas shows, after the frames that are on their way."""
    from matplotlib.image import imread

    browser.execute_async_script(
        "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))"
    )
    browser.find_element("id", "canvas").screenshot(str(file))
    return np.asarray(imread(file))[..., :3]


def moved(a: np.ndarray, b: np.ndarray) -> float:
    """Part of the pixels that differ."""
    return float((np.abs(a - b).max(axis=-1) > 0.05).mean())


def choose(browser: Any, name: str, value: str, event: str = "change") -> None:
    browser.execute_script(
        """const each = document.getElementById(arguments[0]);
        each.value = arguments[1];
        each.dispatchEvent(new Event(arguments[2]))""",
        name,
        value,
        event,
    )


@pytest.mark.sweep
def test_browser_draws_rolls_and_picks(page: str, browser: Any, tmp_path: Path) -> None:
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.keys import Keys

    browser.get(page)
    assert browser.title == NAME
    assert not browser.find_element("id", "stand-in").is_displayed()
    browser.execute_script("document.getElementById('canvas').scrollIntoView({ behavior: 'instant' })")
    first, before = pixels(browser, tmp_path / "first.png"), state(browser)
    assert len(np.unique((255 * first).round().astype(int).reshape(-1, 3), axis=0)) > 100
    assert before["triangles"] > 5000

    # it begins with the whole gears; the contact stands in the middle of the view that looks at it
    assert browser.find_element("id", "look").get_property("value") == ""
    assert {each.get_property("value") for each in browser.find_elements("css selector", "#members select")} == {
        "solid"
    }
    choose(browser, "look", "contact")
    first = pixels(browser, tmp_path / "contact.png")
    red = np.argwhere(first[..., 0] - first[..., 1] > 0.3)
    assert np.abs(red - np.array(first.shape[:2]) / 2).max(axis=1).min() < 6

    # the slider moves the gears: both turn, against their ratio, and other pixels are seen
    choose(browser, "roll", "0.9", "input")
    rolled, after = pixels(browser, tmp_path / "rolled.png"), state(browser)
    assert after["phi1"] > before["phi1"] + 0.05
    assert all(
        np.abs(np.subtract(a, b)).max() > 0.01 for a, b in zip(before["matrices"], after["matrices"], strict=True)
    )
    assert moved(first, rolled) > 0.01

    # at position 54 of 60 the points of contact of both members, in their own frames, meet where these have been moved
    (pair,) = json.loads(browser.execute_script("return document.getElementById('stage').textContent"))["pairs"]
    placed = []
    for k, flank in zip(pair["members"], pair["flanks"], strict=True):
        own = np.frombuffer(base64.b64decode(flank["contact"]), dtype="<f4").reshape(-1, 3)[54]
        placed.append(np.reshape(after["matrices"][k], (4, 4)).T @ [*own, 1.0])
    assert np.abs(placed[0] - placed[1]).max() < 2e-4  # mm: single precision

    # colours of a tooth
    choose(browser, "look", "0")
    plain = pixels(browser, tmp_path / "plain.png")
    choose(browser, "field", "ease_off")
    assert moved(plain, pixels(browser, tmp_path / "ease_off.png")) > 0.01
    assert "ease-off" in browser.find_element("id", "scale").text
    choose(browser, "look", "")

    # a click picks the member that is there, and shows it
    canvas = browser.find_element("id", "canvas")
    browser.execute_script("arguments[0].scrollIntoView({ behavior: 'instant' })", canvas)
    spots = browser.execute_script(
        """const box = arguments[0].getBoundingClientRect(), found = {};
        const at = (x, y) => window.gearmeshView.memberAt(box.left + box.width / 2 + x, box.top + box.height / 2 + y);
        for (let i = 1; i < 40; i++) for (let j = 1; j < 40; j++) {
          const x = (i / 40 - 0.5) * box.width, y = (j / 40 - 0.5) * box.height, name = at(x, y);
          if (name && [[-4, 0], [4, 0], [0, -4], [0, 4]].every(([dx, dy]) => at(x + dx, y + dy) === name)) found[name] = [x, y];
        }
        return found""",
        canvas,
    )
    assert set(spots) == {"pinion", "gear"}
    for name, (x, y) in spots.items():
        ActionChains(browser).move_to_element_with_offset(canvas, round(x), round(y)).click().perform()
        assert state(browser)["picked"] == name
        (pressed,) = browser.find_elements("css selector", "#members button[aria-pressed=true]")
        assert pressed.text.startswith(name)

    # a cut takes pixels away, and arrow keys turn the view
    whole = pixels(browser, tmp_path / "whole.png")
    choose(browser, "cut", "2")
    cut = pixels(browser, tmp_path / "cut.png")
    assert moved(whole, cut) > 0.01
    canvas.send_keys(Keys.ARROW_LEFT)
    assert moved(cut, pixels(browser, tmp_path / "turned.png")) > 0.01

    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []
    asked = requests(browser)
    assert page in asked
    assert [url for url in asked if not url.startswith(("data:", page, "blob:", "about:", "chrome:"))] == []


@pytest.mark.sweep
def test_browser_shows_pressures_of_the_torque(page: str, browser: Any, tmp_path: Path) -> None:
    """Colours show the pressure now and the highest pressure, and differ between torques. The text gives the figures of the
    chosen torque."""
    browser.get(page)
    choose(browser, "look", "0")
    told, shown = [], []
    for field in ("pressure_now", "pressure"):
        choose(browser, "field", field)
        for torque in ("0", "2"):
            choose(browser, "torque", torque)
            shown.append(pixels(browser, tmp_path / f"{field}{torque}.png"))
            told.append(browser.find_element("id", "position").text)
        assert "pressure" in browser.find_element("id", "scale").text
    assert all(moved(a, b) > 5e-4 for k, a in enumerate(shown) for b in shown[:k])
    assert ["at 2 Nm: " in told[0], "at 30 Nm: " in told[1]] == [True, True]
    loaded = loaded_contact("beveloid_crossed", (2.0, 10.0, 30.0), 9)
    # the card has the peak, the scale says where it ends below
    end, peak = browser.find_element("id", "scale-limit").text, max(load.peak.max() for load in loaded.mesh.loads)
    assert end.startswith("\u2265 ") == (peak > 1.01 * float(end.removeprefix("\u2265 ")))
    bounds = loaded.mesh.bending[2, :, 0]
    stress = float(told[1].split("root stress pinion ")[1].split(",")[0])
    assert bounds.min() - 0.5 <= stress <= bounds.max() + 0.5
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


@pytest.mark.sweep
def test_browser_shows_one_gear(browser: Any, tmp_path: Path) -> None:
    """Page of a gear without a mating gear shows the solid alone: no mark of contact and nothing to roll. The solid can be cut."""
    gears = gm.build(gm.parse({"kind": "rack", "module": 2, "rack": {"teeth": 9, "face_width": 12}}))
    browser.get(report_page(gears, {}, 0.05, images=[]).save(tmp_path / "one.html").as_uri())
    whole = pixels(browser, tmp_path / "one.png")
    assert state(browser)["triangles"] > 200
    assert not (np.abs(whole - [0.784, 0.063, 0.18]).max(axis=-1) < 0.1).any()
    for name in ("roll", "field", "torque", "look", "position"):
        assert not browser.find_element("id", name).is_displayed()
    choose(browser, "cut", "1")
    assert moved(whole, pixels(browser, tmp_path / "cut.png")) > 0.005
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


@pytest.mark.sweep
def test_browser_without_webgl_shows_the_picture(page: str, browser: Any) -> None:
    made = browser.execute_cdp_cmd(
        "Page.addScriptToEvaluateOnNewDocument", {"source": "HTMLCanvasElement.prototype.getContext = () => null"}
    )
    browser.get(page)
    assert browser.find_element("id", "still").is_displayed()
    assert not browser.find_element("id", "viewer").is_displayed()
    assert "WebGL" in browser.find_element("id", "no-view").text
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []
    browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", {"identifier": made["identifier"]})


@pytest.mark.sweep
def test_browser_fits_a_phone(page: str, browser: Any) -> None:
    metrics = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    browser.get(page)
    # however long what can be chosen is
    browser.execute_script(
        """for (const each of document.querySelectorAll("select"))
        each.append(Object.assign(document.createElement("option"), { textContent: "a choice with a long name ".repeat(6) }))"""
    )
    assert browser.execute_script("return document.documentElement.scrollWidth") <= 390
    beyond = browser.execute_script(
        """return [...document.querySelectorAll("input, select, button, a, dd")].filter((each) => each.getClientRects().length)
        .filter((each) => each.getBoundingClientRect().right > 390 || each.getBoundingClientRect().left < 0)
        .map((each) => each.outerHTML)"""
    )
    assert beyond == []
    # plots are drawn wide, and scroll: at the width of a phone their letters had 4 pixels
    widths = browser.execute_script(
        """return [...document.querySelectorAll(".plots figure")].filter((each) => each.getClientRects().length)
        .map((each) => [each.clientWidth, each.scrollWidth, each.querySelector("img").clientWidth])"""
    )
    assert widths
    assert all(seen <= 390 and whole >= drawn > 700 for seen, whole, drawn in widths)
    # what can be used has a name
    unnamed = browser.execute_script(
        """return [...document.querySelectorAll("input, select, button")]
        .filter((each) => !each.labels?.length && !each.ariaLabel && !(each.matches("button") && each.textContent.trim()))
        .map((each) => each.outerHTML)"""
    )
    assert unnamed == []


@pytest.mark.sweep
def test_first_screen_has_the_gears_and_eight_figures(page: str, browser: Any) -> None:
    """At 1280 x 800 the turning pair is beside its figures; a phone has them in one column, and raw tables are folded."""
    features = [{"name": "prefers-reduced-motion", "value": "no-preference"}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
    resize(browser, 1280, 800)
    browser.get(page)
    boxes = {
        name: browser.execute_script(
            "return document.querySelector(arguments[0]).getBoundingClientRect().toJSON()", name
        )
        for name in ("#canvas", "#card dl", "#card .good", "#roll")
    }
    assert max(box["bottom"] for box in boxes.values()) <= 800
    assert boxes["#canvas"]["right"] <= boxes["#card dl"]["left"]
    assert len(browser.find_elements("css selector", "#card dt")) == 8
    assert min(boxes["#canvas"]["width"], boxes["#canvas"]["height"]) > 350

    # the gears turn by themselves, and never leave their engagement; a hand on the slider stops them
    wait = "const done = arguments[1]; setTimeout(done, arguments[0])"
    before = state(browser)["phi1"]
    browser.execute_async_script(wait, 400)
    assert state(browser)["phi1"] != before
    choose(browser, "roll", "0.25", "input")
    still = state(browser)["phi1"]
    browser.execute_async_script(wait, 200)
    assert state(browser)["phi1"] == still

    bars = browser.find_elements("css selector", ".bar [role=img]")
    assert len(bars) == 8
    assert not any(each.is_displayed() for each in browser.find_elements("css selector", ".folded table, .folded pre"))
    resize(browser, 390, 844)
    lefts = browser.execute_script(
        "return ['#canvas', '#card'].map((each) => document.querySelector(each).getBoundingClientRect().left)"
    )
    assert max(lefts) < 40
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


@pytest.mark.sweep
def test_page_prints_on_few_sheets(page: str, browser: Any) -> None:
    """Folded tables, the slider and the licence stay off paper."""
    browser.get(page)
    made = browser.execute_cdp_cmd("Page.printToPDF", {"printBackground": True, "preferCSSPageSize": True})
    sheets = base64.b64decode(made["data"]).count(b"/Type /Page\n")
    assert 2 <= sheets <= 5
