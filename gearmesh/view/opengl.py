"""The process that draws pictures, and the test of off-screen OpenGL in it.

The test draws a black triangle on white. A driver that opens a window but draws nothing fails, and so does a driver
that ends the process.
"""

from __future__ import annotations

import atexit
import marshal
import os
import signal
import subprocess
import sys
import time
from array import array
from contextlib import suppress
from functools import lru_cache
from threading import Lock, Timer
from typing import IO, Any, cast

from gearmesh.errors import OutputError
from gearmesh.pipes import closed_pipes_raise
from gearmesh.records import dataclass
from gearmesh.view.offscreen import drawing_process
from gearmesh.view.offscreen.drawing_process import PLAIN_PRIMITIVE, Order, Primitive, receive, send

#: Debian packages of a software OpenGL
OPENGL_PACKAGES = "libegl1 libgl1-mesa-dri (or libosmesa6 libx11-6)"

# A first rendering with a software driver takes one to three seconds; a busy machine may need many times that.
_PATIENCE_SECONDS = 120.0
# how long a process that has nothing to do may take to end
_END_SECONDS = 2.0
#: script that the drawing process runs
_DRAWING_PROGRAM = (drawing_process.__file__,)

#: test picture: a black triangle on white
_TRIAL_ORDER = Order(
    size=(64, 64),
    position=[0.0, 0.0, 3.0],
    focus=[0.0, 0.0, 0.0],
    up=[0.0, 1.0, 0.0],
    parallel=True,
    height=2.0,
    angle=30.0,
    peels=0,
    depth_step=0,
    primitives=[
        Primitive(
            {
                **PLAIN_PRIMITIVE,
                "points": array("f", (-1, -1, 0, 1, -1, 0, 0, 1, 0)).tobytes(),
                "cells": array("q", (0, 1, 2)).tobytes(),
                "starts": array("q", (0, 3)).tobytes(),
            }
        )
    ],
)


@dataclass(frozen=True)
class _DrawingProcess:
    """A drawing process, its error output, and the id of the process that started it."""

    child: subprocess.Popen[bytes]
    complaints: IO[bytes]
    owner: int

    @classmethod
    def start(cls) -> _DrawingProcess:
        """Start a drawing process. Raises OSError if it cannot start."""
        from tempfile import TemporaryFile

        complaints, pipe = TemporaryFile(), subprocess.PIPE  # noqa: SIM115
        child = subprocess.Popen([sys.executable, *_DRAWING_PROGRAM], stdin=pipe, stdout=pipe, stderr=complaints)
        return cls(child, complaints, os.getpid())

    def ask(self, order: Order | None) -> None:
        """Send an order, or None to end the process. Raises OSError if the process has ended."""
        assert self.child.stdin is not None
        with closed_pipes_raise():
            send(self.child.stdin, marshal.dumps(cast("Any", order)))

    def answer(self) -> bytearray:
        """Return the pixels of the oldest unanswered order. Raises EOFError if the process ends before."""
        assert self.child.stdout is not None
        return receive(cast("Any", self.child.stdout))

    def end(self) -> str:
        """End the process and return in a few words how it ended."""
        with suppress(OSError):
            self.ask(None)
        try:
            code = self.child.wait(_END_SECONDS)
        except subprocess.TimeoutExpired:
            self.child.kill()
            code = self.child.wait()
        for stream in (self.child.stdin, self.child.stdout):
            # an order that was not sent in full is dropped
            with suppress(OSError), closed_pipes_raise():
                stream.close()  # type: ignore[union-attr]
        with self.complaints:
            self.complaints.seek(0)
            lines = self.complaints.read().decode(errors="replace").strip().splitlines()
        if code < 0:
            return f"ended by {_signal_name(-code)}"
        return f"failed: {lines[-1].strip()}" if lines else f"ended with exit code {code}"


#: the process that draws, where it has begun
_begun: list[_DrawingProcess] = []
#: one order at a time
_turn = Lock()


def missing_opengl_message() -> str | None:
    """None if pictures can be rendered, otherwise one line with the failure and the system packages that help.

    The test runs once; later calls return its result.
    """
    failure = _failure()
    if failure is None:
        return None
    return (
        f"no pictures: off-screen OpenGL does not work here ({failure}); on Debian: apt-get install {OPENGL_PACKAGES}"
    )


def begin_drawing() -> None:
    """Start the drawing process now, so that it is ready for the first picture."""
    if not _begun and not _failure.cache_info().currsize:
        # if it does not start, the picture reports it
        with suppress(OSError):
            _begin_trial()


def draw(order: Order) -> bytearray:
    """Pixels (H, W, 4) of an order, rows from below. Raises OutputError if OpenGL does not work or fails."""
    missing = missing_opengl_message()
    if missing is not None:
        raise OutputError(reason=missing)
    with _turn:
        if not _own():
            _begun[:] = [_DrawingProcess.start()]
        process = _begun[0]
        try:
            process.ask(order)
            return process.answer()
        except (OSError, EOFError):
            _begun.clear()
            raise OutputError(reason=f"a picture was not drawn: OpenGL {process.end()}") from None
        except BaseException:
            # otherwise its answer would be taken for the next order's
            _begun.clear()
            process.child.kill()
            process.end()
            raise


def _own() -> bool:
    """True if this process started the drawing process; a forked process does not use its parent's."""
    return bool(_begun) and _begun[0].owner == os.getpid()


def _begin_trial() -> None:
    """Start the drawing process and send it the test picture. Raises OSError if it cannot start."""
    _begun[:] = [_DrawingProcess.start()]
    # a process that has ended by now reports it when it is asked for its answer
    with suppress(OSError):
        _begun[0].ask(_TRIAL_ORDER)


@lru_cache(maxsize=1)
def _failure() -> str | None:
    """Reason in a few words why the test failed, or None."""
    try:
        if not _own():
            _begin_trial()
    except OSError as error:
        return f"the test process did not start: {error.strerror}"
    process, begin = _begun[0], time.monotonic()
    watch = Timer(_PATIENCE_SECONDS, process.child.kill)
    watch.daemon = True
    watch.start()
    try:
        pixels = process.answer()
    except EOFError:
        _begun.clear()
        ended = process.end()
        late = time.monotonic() - begin >= _PATIENCE_SECONDS
        return f"no picture after {_PATIENCE_SECONDS:.0f} s" if late else f"test rendering {ended}"
    except BaseException:
        _begun.clear()
        process.child.kill()
        process.end()
        raise
    finally:
        watch.cancel()
    red = pixels[::4]
    if not min(red) < 64 < 192 < max(red):
        _begun.clear()
        process.end()
        return "test rendering failed: the picture came out empty"
    return None


@atexit.register
def _end() -> None:
    if _own():
        # no order is being drawn
        _begun[0].child.kill()
        _begun.pop().end()


def _signal_name(number: int) -> str:
    return next((s.name for s in signal.Signals if s == number), f"signal {number}")
