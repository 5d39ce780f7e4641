"""Threads of linear algebra: one. Blocks of a tooth's layers are small, and threads of BLAS wait for one another by spinning.

The bodies of the helical sample take 3.0 CPU seconds on one thread; on two of an idle machine 8.4, and 4.6 s of wall time; beside
other work 15 and up to 28 s. Two bodies at once, a Python thread each, take 2.2 s of wall time.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


@contextmanager
def one_thread() -> Iterator[None]:
    """Linear algebra within takes one thread, also of what decorated functions call; what was set before holds again after."""
    with threadpool_limits(1, user_api="blas"):
        yield
