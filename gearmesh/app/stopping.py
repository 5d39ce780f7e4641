"""Ctrl-C: a stop that no finaliser, callback or library may swallow.

Python raises KeyboardInterrupt wherever it happens to be. In a finaliser, a weak reference's callback or a callback from C the
exception is "unraisable": printed, dropped, and the work goes on. Some libraries clear exceptions, too, or make others of them: a
module in C that is stopped while it loads ends in ImportError, as if it were not installed. So a stop that was dropped is asked
for anew, one that was cleared is remembered, and what fails after it is a stop.
"""

from __future__ import annotations

import signal
import sys
import threading
from _thread import interrupt_main
from types import FrameType, TracebackType
from typing import Any, Self

#: seconds after which a stop that was dropped is raised again
AGAIN = 0.01


class Stopping:
    """While it is entered: whether Ctrl-C was pressed, and KeyboardInterrupt raised again where it was dropped, or another error.

    Does nothing in other threads than the main one, and where another handler than Python's own is installed.
    """

    def __init__(self) -> None:
        self.asked = False
        self._unraisable_before: Any = None

    def __enter__(self) -> Self:
        plain = signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if plain and threading.current_thread() is threading.main_thread():
            self._unraisable_before = sys.unraisablehook
            signal.signal(signal.SIGINT, self._stop)
            sys.unraisablehook = self._unraisable
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._unraisable_before is not None:
            sys.unraisablehook = self._unraisable_before
            signal.signal(signal.SIGINT, signal.default_int_handler)
        if self.asked and isinstance(error, Exception):
            raise KeyboardInterrupt from error

    def _stop(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        raise KeyboardInterrupt

    def _unraisable(self, dropped: Any) -> None:
        if self.asked and dropped.exc_type is KeyboardInterrupt:
            # not here: what is raised within this hook is dropped, too
            again = threading.Timer(AGAIN, interrupt_main)
            again.daemon = True
            again.start()
        else:
            self._unraisable_before(dropped)
