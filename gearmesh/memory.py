"""Memory of processes that belong to gearmesh alone: the command line, and workers of studies."""

from __future__ import annotations

import sys
from contextlib import suppress
from functools import cache

#: bytes of an array from which the C library gives memory back at once, the largest it allows: new memory is cleared page by page
MAPPED_BYTES = 32 << 20
#: free bytes at the end of the memory from which the C library gives them back
TRIMMED_BYTES = 128 << 20
#: number of the mapped size in `mallopt`
MALLOPT_MAPPED = -3
#: number of the trimmed size in `mallopt`
MALLOPT_TRIMMED = -1


def is_own_process() -> bool:
    """Return True if the process belongs to gearmesh alone: it called `keep_memory`."""
    return keep_memory.cache_info().currsize > 0


@cache
def keep_memory() -> None:
    """Let the GNU C library keep the memory of freed arrays for the next arrays; other libraries stay as they are."""
    if sys.platform != "linux":
        return
    import ctypes

    with suppress(OSError, AttributeError):
        library = ctypes.CDLL(None)
        library.mallopt(MALLOPT_MAPPED, MAPPED_BYTES)
        library.mallopt(MALLOPT_TRIMMED, TRIMMED_BYTES)
