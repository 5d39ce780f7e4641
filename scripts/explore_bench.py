"""Time from a change on the local page to what is on its screen, in a headless Chromium: `python scripts/explore_bench.py`.

For each sample: the start, from the command to the first gear; an error of assembly to its pattern; a key to its figures and to the
gears. Medians of some changes, in seconds, with the load of the machine.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
import webbrowser
from functools import partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from oracles.browser import chromium  # noqa: E402

from gearmesh.explore.explorer import Explorer, origin_of_file  # noqa: E402

#: time after which a change counts as unanswered, s
PATIENCE_S = 120.0
#: tries a change in the page, and returns the milliseconds to its figures, to its first scene and to its end
CHANGE = """
const [key, value, done] = arguments, page = window.gearmeshExplore, begun = performance.now(), at = {};
const input = document.querySelector(`[data-key="${key}"] input[type=text]`);
if (!input) { done(null); return; }
const listen = (type) => { at[type] ??= performance.now() - begun; };
page.listen(listen);
input.value = value;
input.dispatchEvent(new Event("change"));
const look = () => {
  if (at.end === undefined) { requestAnimationFrame(look); return; }
  requestAnimationFrame(() => done(at));
};
look();
"""


class Measured(webbrowser.BaseBrowser):
    """The browser that is measured, as the one that the program opens."""

    def __init__(self, browser: Any) -> None:
        super().__init__()
        self._browser = browser

    def open(self, url: str, new: int = 0, autoraise: bool = True) -> bool:
        """Open an address; returns before the page is loaded."""
        self._browser.execute_cdp_cmd("Page.navigate", {"url": url})
        return True


def measured(browser: Any, key: str, values: list[str]) -> list[dict[str, float]]:
    """Times of changes of a key, without those that are refused."""
    found = [browser.execute_async_script(CHANGE, key, value) for value in values]
    return [times for times in found if times is not None and "figures" in times]


def median(times: list[dict[str, float]], what: str) -> str:
    """Median of one of the times as text, s."""
    known = [each[what] for each in times if what in each]
    return f"{statistics.median(known) / 1000:.2f}" if known else "-"


def main() -> None:
    """Print a line for each sample."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("samples", nargs="*", help="names of samples; all if left out")
    parser.add_argument("--changes", type=int, default=20, help="changes of each kind")
    given = parser.parse_args()
    names = given.samples or sorted(path.stem for path in (ROOT / "samples").glob("*.toml"))
    print(f"{'sample':32} start  error: pattern  key: figures  gears  fine   load")
    with tempfile.TemporaryDirectory() as profile, chromium(Path(profile)) as browser:
        browser.set_script_timeout(PATIENCE_S)
        # the program opens this browser, at the moment at which it would open that of the user
        webbrowser.register("measured", None, Measured(browser), preferred=True)
        for name in names:
            begun = time.perf_counter()
            path = ROOT / "samples" / f"{name}.toml"
            with Explorer(partial(origin_of_file, path)):
                while not browser.execute_script("return window.gearmeshExplore?.state.scene?.triangles"):
                    time.sleep(0.01)
                start = time.perf_counter() - begun
                while browser.execute_script("return window.gearmeshExplore.state.busy"):
                    time.sleep(0.05)
                errors = browser.execute_script("return window.gearmeshExplore.state.errors")
                values = browser.execute_script("return window.gearmeshExplore.state.values")
                moved = (
                    measured(browser, errors[0], [f"{0.001 * (k + 1):g}" for k in range(given.changes)])
                    if errors
                    else []
                )
                key = next(
                    key for key in ("pressure_angle", "module", "backlash") if isinstance(values.get(key), int | float)
                )
                own = float(values[key])
                changed = measured(
                    browser, key, [f"{own * (1 + 0.001 * (k + 1)) or 0.01 * (k + 1):.6g}" for k in range(given.changes)]
                )
                columns = (
                    f"{start:5.2f}",
                    f"{median(moved, 'scene'):>14}",
                    f"{median(changed, 'figures'):>12}",
                    f"{median(changed, 'scene'):>5}",
                    f"{median(changed, 'end'):>4}",
                    f"{os.getloadavg()[0]:5.1f}",
                    key,
                )
                print(f"{name:32} {'  '.join(columns)}", flush=True)


if __name__ == "__main__":
    main()
