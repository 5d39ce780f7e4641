"""The local page in a real Chromium: a key changes figures and pixels, refusals mend, and nothing that was set is lost."""

from __future__ import annotations

import base64
import json
import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from oracles.browser import chromium, needs_chromium, requests, resize

import gearmesh as gm
from gearmesh import Explorer, samples
from gearmesh.explore.explorer import origin_of_file

pytestmark = [needs_chromium, pytest.mark.sweep]
DESIGN = """# a pair
kind = "cylindrical"
module = 2  # mm
pinion = { teeth = 20, face_width = 10, bore = 12 }
gear = { teeth = 31, face_width = 10, bore = 16 }
backlash = 0.1
"""
#: time in which the page must have answered, s; the machine may be busy
PATIENCE_S = 120


@pytest.fixture(scope="module")
def design(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("design") / "pair.toml"
    file.write_text(DESIGN)
    return file


@pytest.fixture(scope="module")
def running(design: Path) -> Iterator[Explorer]:
    with Explorer(origin_of_file(design), browser=False) as page:
        yield page


@pytest.fixture(scope="module")
def downloads(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("downloads")


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory, running: Explorer, downloads: Path) -> Iterator[Any]:
    """A browser with the page; the token of the address is used up."""
    with chromium(tmp_path_factory.mktemp("profile")) as opened:
        # the driver itself gives a script 30 s, which is little on a busy machine
        opened.set_script_timeout(PATIENCE_S)
        resize(opened, 1300)
        behaviour = {"behavior": "allow", "downloadPath": str(downloads)}
        opened.execute_cdp_cmd("Browser.setDownloadBehavior", behaviour)
        opened.get(running.url)
        settled(opened)
        yield opened


@pytest.fixture(autouse=True)
def _fresh(browser: Any, running: Explorer) -> None:
    """Every test begins with the opened design, a new history, and what the page was asked for forgotten."""
    requests(browser)
    browser.get("about:blank")
    browser.get(address(running))
    settled(browser)


def address(running: Explorer) -> str:
    return f"http://127.0.0.1:{running.port}/"


def wait_for(holds: Any, told: Any = "the page did not answer") -> None:
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end, told() if callable(told) else told
        time.sleep(0.02)


def page_state(browser: Any) -> Any:
    return browser.execute_script("return window.gearmeshExplore && window.gearmeshExplore.state")


def settled(browser: Any) -> Any:
    """State of the page once everything that was asked has come."""
    wait_for(
        lambda: (now := page_state(browser)) and now["entered"] and now["latest"] is not None and not now["busy"],
        lambda: browser.execute_script("return document.body.innerText"),
    )
    return page_state(browser)


def put(browser: Any, key: str, value: str) -> Any:
    """Write into the field of a key, and wait for the answer."""
    browser.execute_script(
        """const field = document.querySelector(`[data-key="${arguments[0]}"] input[type=text]`);
        field.focus();
        field.value = arguments[1];
        field.dispatchEvent(new Event("change"))""",
        key,
        value,
    )
    return settled(browser)


def figure(state: Any, key: str) -> float:
    return next(each["value"] for each in state["figures"][0]["figures"] if each["key"] == key)


def press(browser: Any, css: str) -> Any:
    browser.execute_script("document.querySelector(arguments[0]).click()", css)
    return settled(browser)


def pixels(browser: Any, file: Path) -> np.ndarray:
    browser.execute_async_script(
        "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))"
    )
    browser.find_element("id", "canvas").screenshot(str(file))
    return np.asarray(imread(file))[..., :3]


def moved(a: np.ndarray, b: np.ndarray) -> float:
    return float((np.abs(a - b).max(axis=-1) > 0.05).mean())


def test_a_key_changes_figures_and_pixels_and_undo_brings_them_back(
    browser: Any, running: Explorer, design: Path, tmp_path: Path
) -> None:
    first, seen = settled(browser), pixels(browser, tmp_path / "first.png")
    after, changed = put(browser, "pinion.teeth", "25"), pixels(browser, tmp_path / "changed.png")
    gears = gm.build(gm.load(design, ["pinion.teeth=25"]))
    ratio = gears.contact().summary["contact_ratio"]
    assert figure(after, "contact_ratio") == pytest.approx(ratio, rel=1e-9)
    assert moved(seen, changed) > 0.02
    assert after["scene"]["camera"] == pytest.approx(first["scene"]["camera"])
    assert f"{ratio:.4g}" in browser.find_element("css selector", '[data-figure="contact_ratio"]').text
    # the mesh of the gear is the same, and did not come again
    assert len(set(first["held"]) & set(after["held"])) == 1

    back = press(browser, "#undo")
    assert back["figures"] == first["figures"]
    assert moved(seen, pixels(browser, tmp_path / "back.png")) < 0.001
    assert figure(press(browser, "#redo"), "contact_ratio") == figure(after, "contact_ratio")
    # nothing was asked of any other host, and nothing but what the page is made of
    urls = requests(browser)
    assert all(url.startswith((address(running), f"ws://127.0.0.1:{running.port}/", "data:", "about:")) for url in urls)
    assert [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


def test_a_refusal_stands_beside_its_key_and_its_remedy_mends(browser: Any) -> None:
    before = settled(browser)
    put(browser, "pinion.bore", "200")
    (box,) = browser.find_elements("css selector", ".key .refusal")
    assert box.text.startswith("pinion.bore = 200")
    assert browser.execute_script("return arguments[0].closest('.key').dataset.key", box) == "pinion.bore"
    # the last good gears stay, greyed
    assert "old" in browser.find_element("id", "view").get_attribute("class")
    assert page_state(browser)["figures"] == before["figures"]
    after = press(browser, ".key .refusal button")
    assert after["state"]["keys"]["pinion.bore"] < 200
    assert browser.find_elements("css selector", ".key .refusal") == []
    # a value beyond all limits can be taken back where it is refused
    put(browser, "pinion.face_width", "-1")
    back = press(browser, ".refusal .take-back")
    assert back["state"] == after["state"]
    assert browser.find_elements("css selector", ".refusal:not([hidden])") == []
    assert "old" not in browser.find_element("id", "view").get_attribute("class")


def test_values_that_follow_are_short_and_whole_in_their_title(browser: Any) -> None:
    values = put(browser, "pinion.profile_shift", "0.3")["values"]
    browser.execute_script("document.getElementById('every').click()")
    shown = browser.execute_script(
        """return Object.fromEntries([...document.querySelectorAll(".key.free input[type=text]")]
        .map((field) => [field.closest(".key").dataset.key, [field.value, field.title]]))"""
    )
    browser.execute_script("document.getElementById('every').click()")
    numbers = {key: shown[key] for key, value in values.items() if isinstance(value, float) and key in shown}
    long = {key for key in numbers if values[key] != float(f"{values[key]:.6g}")}
    assert long
    for key, (text, title) in numbers.items():
        assert float(text) == pytest.approx(values[key], rel=6e-6)
        assert len(text.split("e")[0].lstrip("-0.").replace(".", "")) <= 6 or float(text) >= 1e6
        assert float(title) == values[key]


def test_gears_that_jam_are_all_seen(browser: Any) -> None:
    browser.execute_script(
        "const look = document.getElementById('look'); look.value = '0'; look.dispatchEvent(new Event('change'))"
    )
    after = put(browser, "assembly.dx", "-0.8")
    assert figure(after, "backlash_normal_min_mm") < 0
    hidden = "return [...document.querySelectorAll('#members select')].map((each) => each.value)"
    assert browser.execute_script(hidden) == ["solid", "solid"]
    assert not browser.find_element("id", "scale").is_displayed()


def test_slider_of_an_error_and_pinned_state(browser: Any) -> None:
    press(browser, "#pin")
    browser.execute_script(
        """const slider = document.querySelector('[data-key="assembly.dx"] input[type=range]');
        for (const value of [0.01, 0.02, 0.03]) { slider.value = value; slider.dispatchEvent(new Event("input")); }
        slider.dispatchEvent(new Event("change"))"""
    )
    after = settled(browser)
    assert after["state"]["keys"]["assembly.dx"] == 0.03
    # the steps of a slider are one step of the history
    assert after["history"] == 2
    change = browser.find_element("css selector", '[data-figure="tip_clearance_gear_mm"] .change').text
    assert change == "+0.03 mm"
    assert "assembly.dx" in browser.find_element("id", "compared").text

    # both states side by side, and no change that is rounding
    def pictures() -> Any:
        return browser.execute_script("return [...document.querySelectorAll('#compared img')].map((each) => each.src)")

    pinned, moved_apart = pictures()
    put(browser, "pinion.teeth", "26")
    (again, other), back = pictures(), press(browser, "#undo")
    assert pinned == again
    assert pictures() == [pinned, moved_apart] != [pinned, other]
    assert back["state"] == after["state"]
    changes = [each.text for each in browser.find_elements("css selector", "#figures .change")]
    assert "e-" not in " ".join(changes)


def test_range_of_a_key_is_found_and_its_slider_turns_the_gear(browser: Any) -> None:
    browser.execute_script("document.getElementById('key-pinion.teeth').focus()")
    wait_for(lambda: browser.find_elements("css selector", '[data-key="pinion.teeth"] input[type=range]'))
    slider = browser.find_element("css selector", '[data-key="pinion.teeth"] input[type=range]')
    assert slider.get_attribute("min") == "9"
    browser.execute_script("arguments[0].value = 26; arguments[0].dispatchEvent(new Event('input'))", slider)
    assert settled(browser)["values"]["pinion.teeth"] == 26
    assert "number of teeth" in browser.find_element("css selector", '[data-key="pinion.teeth"] .more').text


def test_reload_and_a_second_tab_show_the_same(browser: Any, running: Explorer) -> None:
    after = put(browser, "backlash", "0.15")
    link = browser.current_url
    assert "token" not in link
    browser.refresh()
    again = settled(browser)
    assert (again["state"], again["figures"]) == (after["state"], after["figures"])
    browser.switch_to.new_window("tab")
    browser.get(link)
    second = settled(browser)
    assert second["figures"] == after["figures"]
    put(browser, "backlash", "0.3")
    browser.close()
    browser.switch_to.window(browser.window_handles[0])
    assert page_state(browser)["state"]["keys"]["backlash"] == 0.15
    assert figure(put(browser, "backlash", "0.2"), "backlash_normal_min_mm") == pytest.approx(0.2, abs=1e-6)


@pytest.mark.parametrize("keys", [None, [1], "module"])
def test_a_link_without_a_state_says_so(browser: Any, running: Explorer, keys: Any) -> None:
    link = base64.urlsafe_b64encode(json.dumps({"from": "opened", "keys": keys}).encode()).decode().rstrip("=")
    browser.get("about:blank")
    browser.get(f"{address(running)}#{link}")
    wait_for(lambda: browser.find_element("id", "trouble").text == "The link has no state that can be read.")
    # the opened design is there instead
    assert figure(settled(browser), "contact_ratio") > 1


def test_a_process_that_is_killed_is_replaced_and_nothing_is_lost(browser: Any, running: Explorer) -> None:
    process = running.pages.worker.process
    assert process is not None
    os.kill(process.pid, signal.SIGKILL)
    after = put(browser, "pinion.teeth", "27")
    assert after["values"]["pinion.teeth"] == 27
    assert running.pages.worker.process is not process
    assert not browser.find_element("id", "trouble").is_displayed()


def choose_file(browser: Any, what: str) -> None:
    browser.execute_script(
        "const e = document.getElementById('save'); e.value = arguments[0]; e.dispatchEvent(new Event('change'))", what
    )


def test_saved_design_gives_the_same_gears(browser: Any, downloads: Path) -> None:
    put(browser, "pinion.teeth", "23")

    def saved(suffix: str) -> Path:
        choose_file(browser, suffix)
        wait_for(lambda: [file for file in downloads.glob(f"*{suffix}") if file.stat().st_size])
        return next(downloads.glob(f"*{suffix}"))

    design = saved(".toml")
    assert design.read_text() == DESIGN.replace("teeth = 20", "teeth = 23")
    gears = gm.build(gm.load(design))
    assert gears.design.pinion.teeth == 23
    own = downloads / "own"
    own.mkdir()
    # every file is the one that the program makes of the saved design, to the last byte
    for suffix, made in {
        ".stl": lambda file: gears.solid("pinion", file=file).save(file),
        ".3mf": lambda file: gears.solid("pinion", file=file).save(file),
        ".step": lambda file: gears.cad("pinion").save(file),
        ".dxf": lambda file: gears.section("pinion").save(file),
    }.items():
        file = saved(suffix)
        made(own / file.name)
        assert (own / file.name).read_bytes() == file.read_bytes(), suffix
    report = saved(".html").read_text(encoding="utf-8")
    assert all(
        f"{name}, {teeth} teeth" in report or str(teeth) in report for name, teeth in (("pinion", 23), ("gear", 31))
    )
    assert f"{gears.contact().summary['contact_ratio']:.4g}" in report
    choose_file(browser, "picture")
    wait_for(lambda: list(downloads.glob("*.png")))
    picture = np.asarray(imread(next(downloads.glob("*.png"))))
    shades = np.unique(picture.reshape(-1, picture.shape[-1]), axis=0)
    assert len(shades) > 100


def test_distance_of_two_points_and_other_gears(browser: Any) -> None:
    browser.execute_script(
        """const canvas = document.getElementById("canvas"), box = canvas.getBoundingClientRect();
        for (const share of [0.3, 0.6]) for (const type of ["pointerdown", "pointerup"]) canvas.dispatchEvent(new PointerEvent(type,
          { clientX: box.left + share * box.width, clientY: box.top + 0.6 * box.height, shiftKey: true, pointerId: 1 }))"""
    )
    text = browser.find_element("id", "distance").text
    assert text.startswith("Distance of the two points: ")
    assert 1.0 < float(text.split()[-2]) < 200.0
    before = page_state(browser)["scene"]["camera"]
    press(browser, "#other")
    wait_for(lambda: browser.find_elements("css selector", "#kinds button"))
    title = browser.title
    press(browser, "#other")
    assert browser.find_element("id", "view").is_displayed()
    assert (title, browser.title) == ("gearmesh explore", browser.find_element("id", "title").text)
    press(browser, "#other")
    wait_for(lambda: browser.find_element("id", "start").is_displayed())
    assert len(browser.find_elements("css selector", "#kinds img")) == len(gm.kinds())
    browser.execute_script(
        "[...document.querySelectorAll('#kinds button')].find((each) => each.textContent.startsWith('rack')).click()"
    )
    wait_for(lambda: page_state(browser)["values"].get("kind") == "rack")
    other = settled(browser)
    # other gears are looked at anew, and have a history of their own
    assert np.abs(np.subtract(other["scene"]["camera"], before)).max() > 1.0
    assert other["history"] == 1


def test_a_train_turns_and_follows_a_key_of_a_stage(browser: Any, downloads: Path) -> None:
    train = samples.path("train_two_stage")

    def figures(css: str) -> str:
        return str(browser.find_element("css selector", css).text)

    def matrices() -> np.ndarray:
        return np.array(page_state(browser)["scene"]["matrices"])

    with Explorer(origin_of_file(train), browser=False) as page:
        browser.get(page.url)
        first, still = settled(browser), matrices()
        assert browser.title == "Two-stage helical gearbox"
        # both shafts turn with the input, each by its ratio
        browser.execute_script(
            "const r = document.getElementById('roll'); r.value = 0.1; r.dispatchEvent(new Event('input'))"
        )
        turned = matrices()
        assert (np.abs(turned - still).max(axis=1) > 0.05).all()
        angle = [
            np.arctan2(one[1], one[0]) - np.arctan2(two[1], two[0]) for one, two in zip(turned, still, strict=True)
        ]
        assert np.cos(angle[1]) == pytest.approx(np.cos(angle[0] / 2.0), abs=2e-3)
        press(browser, "#pin")
        after = put(browser, "stages.second.gear.teeth", "61")
        assert figure(after, "ratio") == pytest.approx(48.0 / 24.0 * 61.0 / 17.0)
        assert "+0.94" in figures('[data-figure="ratio"] .change')
        assert "stages.second.gear.teeth" in figures("#compared")
        back = press(browser, "#undo")
        assert back["figures"] == first["figures"]
        put(browser, "stages.first.pinion.bore", "70")
        (box,) = browser.find_elements("css selector", ".key .refusal")
        assert box.text.startswith("stages.first.pinion.bore = 70")
        press(browser, ".key .refusal button")
        put(browser, "stages.first.pinion.bore", "17")
        before = set(downloads.iterdir())
        choose_file(browser, ".toml")
        wait_for(lambda: [file for file in set(downloads.iterdir()) - before if file.suffix == ".toml"])
        (file,) = (file for file in set(downloads.iterdir()) - before if file.suffix == ".toml")
        assert file.read_text() == train.read_text().replace("face_width = 22, bore = 16", "face_width = 22, bore = 17")
        assert [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


def test_narrow_dark_and_by_keyboard(browser: Any, tmp_path: Path) -> None:
    from selenium.webdriver.common.keys import Keys

    light = browser.execute_script("return getComputedStyle(document.body).backgroundColor")
    browser.execute_cdp_cmd(
        "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]}
    )
    assert browser.execute_script("return getComputedStyle(document.body).backgroundColor") != light
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    resize(browser, 400)
    width = browser.execute_script("return document.documentElement.scrollWidth")
    resize(browser, 1300)
    assert width <= 400
    # from the search to a key, by keys alone
    browser.find_element("id", "search").send_keys("pinion.teeth")
    field = browser.find_element("id", "key-pinion.teeth")
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys("24", Keys.TAB)
    assert settled(browser)["values"]["pinion.teeth"] == 24
    browser.switch_to.active_element.send_keys(Keys.CONTROL, "z")
    assert settled(browser)["values"]["pinion.teeth"] != 24


def test_wrong_token_and_no_webgl(browser: Any, running: Explorer) -> None:
    browser.get(f"{address(running)}?token=guess")
    assert "the token in the address is wrong" in browser.find_element("css selector", "body").text
    script = "HTMLCanvasElement.prototype.getContext = () => null"
    added = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": script})
    browser.get(address(running))
    state = settled(browser)
    browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)
    assert browser.find_element("id", "no-view").is_displayed()
    assert figure(state, "contact_ratio") > 1
    assert browser.find_element("css selector", "#curves .line").get_attribute("d")
    assert json.dumps(put(browser, "pinion.teeth", "22")["figures"]) != json.dumps(state["figures"])
