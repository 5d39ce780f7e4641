"""A headless Chromium that opens files."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
#: mark of tests that need it
needs_chromium = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="needs apt-get install chromium chromium-driver")
OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    # a page with a view that turns by itself would never be at rest
    "--force-prefers-reduced-motion",
    "--disable-background-networking",
    "--no-first-run",
    "--window-size=1000,900",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)


@contextmanager
def chromium(profile: Path) -> Iterator[Any]:
    """A browser whose console and requests are logged; skips where selenium is not there."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium, of the extra [test], is not installed")
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for option in (*OPTIONS, f"--user-data-dir={profile}"):
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    browser = webdriver.Chrome(options=options, service=Service(DRIVER))
    try:
        yield browser
    finally:
        browser.quit()


def requests(browser: Any) -> list[str]:
    """Addresses that were asked for since this was last called."""
    events = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    return [event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"]


def resize(browser: Any, width: int, height: int = 900) -> None:
    """Make the page this wide, in pixels of CSS: windows have a least width, pages have none."""
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
