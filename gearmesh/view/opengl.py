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
