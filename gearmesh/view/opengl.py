"""Whether off-screen OpenGL works, found out in a child process.

VTK without a working OpenGL library ends the process with a segmentation fault that no `except` catches, so the
question is asked once, by a process that may die of it.
"""

from __future__ import annotations

import signal
import subprocess
import sys
from contextlib import suppress
from functools import lru_cache

PACKAGES = "libegl1 libgl1-mesa-dri (or libosmesa6 libx11-6)"

# A first rendering with a software driver takes one to three seconds; a busy machine may need many times that.
_PATIENCE_SECONDS = 120.0

#: the child process, where it began before it was asked for
_begun: list[subprocess.Popen[str]] = []

# One black disk on white: a driver that opens a window but draws nothing fails as well. By VTK alone, of which little is loaded.
_PROBE = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkFiltersSources import vtkRegularPolygonSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter

disk, mapper, actor, renderer, window, picture = (
    kind()
    for kind in (
        vtkRegularPolygonSource, vtkPolyDataMapper, vtkActor, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter
    )
)
mapper.SetInputConnection(disk.GetOutputPort())
actor.SetMapper(mapper)
actor.GetProperty().SetColor(0.0, 0.0, 0.0)
actor.GetProperty().LightingOff()
renderer.SetBackground(1.0, 1.0, 1.0)
renderer.AddActor(actor)
window.SetOffScreenRendering(True)
window.SetSize(64, 64)
window.AddRenderer(renderer)
window.Render()
picture.SetInput(window)
picture.Update()
darkest, brightest = picture.GetOutput().GetScalarRange()
raise SystemExit(0 if darkest < 64 and brightest > 192 else "the picture came out empty")
"""


def missing_opengl_message() -> str | None:
    """None where a picture can be rendered, else one line saying what failed and which system packages help.

    The child process runs once, later calls take its answer.
    """
    failure = _failure()
    if failure is None:
        return None
    return f"no pictures: off-screen OpenGL does not work here ({failure}); on Debian: apt-get install {PACKAGES}"


def begin_probe() -> None:
    """Start the child process now, so that its answer is there when the first picture is rendered."""
    if not _begun and not _failure.cache_info().currsize:
        # where it does not start the picture says so
        with suppress(OSError):
            _begun.append(_start())


def _start() -> subprocess.Popen[str]:
    """The child process. Raises OSError where it cannot start."""
    return subprocess.Popen(
        [sys.executable, "-c", _PROBE],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
    )


@lru_cache(maxsize=1)
def _failure() -> str | None:
    """How the child process failed, in a few words, or None."""
    try:
        child = _begun.pop() if _begun else _start()
    except OSError as error:
        return f"the test process did not start: {error.strerror}"
    with child:
        try:
            _, stderr = child.communicate(timeout=_PATIENCE_SECONDS)
        except BaseException as error:
            child.kill()
            if isinstance(error, subprocess.TimeoutExpired):
                return f"no picture after {_PATIENCE_SECONDS:.0f} s"
            raise
    if child.returncode == 0:
        return None
    if child.returncode < 0:
        return f"test rendering ended by {_signal_name(-child.returncode)}"
    lines = stderr.strip().splitlines()
    return f"test rendering failed: {lines[-1].strip()}" if lines else f"test rendering: exit {child.returncode}"


def _signal_name(number: int) -> str:
    return next((s.name for s in signal.Signals if s == number), f"signal {number}")
