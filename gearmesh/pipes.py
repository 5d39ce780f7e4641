"""Pipes to other processes: a process at the other end that has ended gives an error, never the end of the program.

Python ignores the signal SIGPIPE, so that writing to a closed pipe raises BrokenPipeError. Libraries in the same process may
restore the signal's default action (gmsh 4.15.2 does in `gmsh.initialize`), which ends the program without a word.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def closed_pipes_raise() -> Iterator[None]:
    """Let this thread get BrokenPipeError where it writes to a closed pipe, whatever the action of SIGPIPE is."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows has no such signal
        yield
        return
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    try:
        yield
    finally:
        if signal.SIGPIPE not in blocked:
            # a signal that came would end the program as soon as it is let through
            if signal.SIGPIPE in signal.sigpending():
                signal.sigwait({signal.SIGPIPE})
            signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
