"""Ctrl-C, SIGTERM and SIGHUP: a stop that no finaliser, callback or library may swallow.

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

#: signals that stop a command, and what Python does about each where nobody has changed that
STOPS = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
if hasattr(signal, "SIGHUP"):  # not on Windows
    STOPS[signal.SIGHUP] = signal.SIG_DFL
#: exit status of a command that a signal has stopped, less the signal's number
STOPPED = 128
#: seconds after which a stop that was dropped is raised again
AGAIN = 0.01


class Stopping:
    """While it is entered: KeyboardInterrupt for every signal that stops a command, raised again where it was dropped, or another
    error took its place.

    Does nothing in other threads than the main one; a signal that has another handler than Python's own keeps it.
    """

    def __init__(self) -> None:
        #: number of the first signal that asked for a stop, 0 before
        self.asked = 0
        self._before: dict[int, Any] = {}
        self._unraisable_before: Any = None

    @property
    def status(self) -> int:
        """Exit status of the command, that of Ctrl-C where no signal was seen."""
        return STOPPED + (self.asked or signal.SIGINT)

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            self._before = {number: own for number, own in STOPS.items() if signal.getsignal(number) is own}
        for number in self._before:
            signal.signal(number, self._stop)
        if self._before:
            self._unraisable_before = sys.unraisablehook
            sys.unraisablehook = self._unraisable
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._unraisable_before is not None:
            sys.unraisablehook = self._unraisable_before
        for number, own in self._before.items():
            signal.signal(number, own)
        if self.asked and isinstance(error, Exception):
            raise KeyboardInterrupt from error

    def _stop(self, number: int, frame: FrameType | None) -> None:
        self.asked = self.asked or number
        raise KeyboardInterrupt

    def _unraisable(self, dropped: Any) -> None:
        if self.asked and dropped.exc_type is KeyboardInterrupt:
            # not here: what is raised within this hook is dropped, too
            again = threading.Timer(AGAIN, interrupt_main)
            again.daemon = True
            again.start()
        else:
            self._unraisable_before(dropped)
