"""Threads of linear algebra: one, because the blocks of a tooth's layers are small.

Several threads of BLAS would wait for one another by spinning. Two bodies are computed at the same time instead, each
on a Python thread (times in notes.md).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit linear algebra to one thread within the block or the decorated function, and restore the limit
    afterwards."""
    with threadpool_limits(1, user_api="blas"):
        yield
