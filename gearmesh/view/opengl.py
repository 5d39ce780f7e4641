"""Whether off-screen OpenGL works, found out in a child process.

VTK without a working OpenGL library ends the process with a segmentation fault that no `except` catches, so the
question is asked once, by a process that may die of it.
"""

from __future__ import annotations

import signal
import subprocess
import sys
from functools import lru_cache

PACKAGES = "libegl1 libgl1-mesa-dri (or libosmesa6 libx11-6)"

# A first rendering with a software driver takes one to three seconds; a busy machine may need many times that.
_PATIENCE_SECONDS = 120.0

# One black triangle on white: a driver that opens a window but draws nothing fails as well.
_PROBE = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=[64, 64])
plotter.set_background("white")
plotter.add_mesh(pyvista.Triangle(), color="black", lighting=False)
pixels = plotter.screenshot(return_img=True)
raise SystemExit(0 if pixels.min() < 64 and pixels.max() > 192 else "the picture came out empty")
"""


def missing_opengl_message() -> str | None:
    """None where a picture can be rendered, else one line saying what failed and which system packages help.

    The child process runs once, later calls take its answer.
    """
    failure = _failure()
    if failure is None:
        return None
    return f"no pictures: off-screen OpenGL does not work here ({failure}); on Debian: apt-get install {PACKAGES}"


@lru_cache(maxsize=1)
def _failure() -> str | None:
    """How the child process failed, in a few words, or None."""
    try:
        child = subprocess.run(
            [sys.executable, "-c", _PROBE],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_PATIENCE_SECONDS,
        )
    except subprocess.TimeoutExpired:
        return f"no picture after {_PATIENCE_SECONDS:.0f} s"
    except OSError as error:
        return f"the test process did not start: {error.strerror}"
    if child.returncode == 0:
        return None
    if child.returncode < 0:
        return f"test rendering ended by {_signal_name(-child.returncode)}"
    lines = child.stderr.strip().splitlines()
    return f"test rendering failed: {lines[-1].strip()}" if lines else f"test rendering: exit {child.returncode}"


def _signal_name(number: int) -> str:
    return next((s.name for s in signal.Signals if s == number), f"signal {number}")
