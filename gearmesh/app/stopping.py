"""Ctrl-C, SIGTERM and SIGHUP: a stop that no finaliser, callback or library can swallow.

Python raises KeyboardInterrupt at any place of the program. In a finaliser, a callback of a weak reference or a callback from C
the exception is "unraisable": Python prints and drops it, and the work continues. Some libraries also clear exceptions, or turn
them into others: a C module that is stopped while it loads ends in ImportError, as if it were not installed. Therefore a dropped
stop is raised again, a cleared stop is remembered, and an error after a stop counts as the stop.
"""

from __future__ import annotations

import signal
import sys
import threading
from _thread import interrupt_main
from time import sleep
from types import FrameType, TracebackType
from typing import Any, Self

#: signals that stop a command, with Python's default handlers
STOP_SIGNALS = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
if hasattr(signal, "SIGHUP"):  # not on Windows
    STOP_SIGNALS[signal.SIGHUP] = signal.SIG_DFL
#: exit status of a command stopped by a signal, minus the number of the signal
SIGNAL_STATUS = 128
#: delay after which a dropped stop is raised again
RAISE_AGAIN_S = 0.01


class Stopping:
    """Context in which every stopping signal raises KeyboardInterrupt, again if it was dropped or replaced by another error.

    It does nothing outside the main thread. A signal with a handler other than Python's default keeps its handler.
    """

    def __init__(self) -> None:
        #: number of the first stopping signal, 0 before
        self.asked = 0
        self._before: dict[int, Any] = {}
        self._unraisable_before: Any = None
        #: True while `_unraisable` runs, in which another KeyboardInterrupt would be lost
        self._dropping = False

    @property
    def status(self) -> int:
        """Exit status of the command; without a signal it is the status of Ctrl-C."""
        return SIGNAL_STATUS + (self.asked or signal.SIGINT)

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            self._before = {number: own for number, own in STOP_SIGNALS.items() if signal.getsignal(number) is own}
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
        self._dropping = True
        if self.asked and dropped.exc_type is KeyboardInterrupt:
            # raise it later from a thread: exceptions raised within this hook are dropped, too
            threading.Thread(target=self._raise_again, daemon=True).start()
        else:
            self._unraisable_before(dropped)
        # the last statement: no signal is handled between it and the end of the hook
        self._dropping = False

    def _raise_again(self) -> None:
        """Raise KeyboardInterrupt in the main thread when it has left the hook; on a busy machine that may take long."""
        sleep(RAISE_AGAIN_S)
        while self._dropping:
            sleep(RAISE_AGAIN_S)
        interrupt_main()
