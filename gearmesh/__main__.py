"""The program `gearmesh`, and `python -m gearmesh`."""

from __future__ import annotations

import gc
import sys
from contextlib import suppress

#: objects made between two searches for unreachable cycles, and how many of these searches look at older objects, too: modules and
#: plots make many objects that stay
OBJECTS_BETWEEN_SEARCHES = (50_000, 20, 50)
#: bytes of an array from which the C library gives memory back at once, the largest it allows: new memory is cleared page by page
MAPPED_BYTES = 32 << 20
#: free bytes at the end of the memory from which the C library gives them back
TRIMMED_BYTES = 128 << 20
#: number of the mapped size in `mallopt`
MALLOPT_MAPPED = -3
#: number of the trimmed size in `mallopt`
MALLOPT_TRIMMED = -1


def main() -> int:
    """Answer the command line. Stopped while that is being loaded, it says so as it does later."""
    gc.set_threshold(*OBJECTS_BETWEEN_SEARCHES)
    _keep_memory()
    try:
        from gearmesh.app.cli import main as answer

        status = answer()
    except KeyboardInterrupt:
        print("gearmesh: error: stopped: no file was written", file=sys.stderr)
        status = 130
    if status == 130:
        # a stop within code that is a text, as methods of dataclasses are while they are made, leaves a mark by which Python ends
        # itself by a signal; the next text takes it away
        exec("")
    return status


def _keep_memory() -> None:
    """Let the GNU C library keep the memory of freed arrays for the next arrays; other libraries stay as they are."""
    if sys.platform != "linux":
        return
    import ctypes

    with suppress(OSError, AttributeError):
        library = ctypes.CDLL(None)
        library.mallopt(MALLOPT_MAPPED, MAPPED_BYTES)
        library.mallopt(MALLOPT_TRIMMED, TRIMMED_BYTES)


if __name__ == "__main__":
    sys.exit(main())
