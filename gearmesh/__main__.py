"""The program `gearmesh`, and `python -m gearmesh`."""

from __future__ import annotations

import atexit
import gc
import sys

from gearmesh.memory import keep_memory

#: objects made before unreachable cycles are looked for, which are left out then and later: nearly all belong to modules
OBJECTS_BEFORE_SEARCHES = 200_000
#: objects made between two searches for unreachable cycles, and how many of these searches look at older objects, too: modules and
#: plots make many objects that stay
OBJECTS_BETWEEN_SEARCHES = (50_000, 20, 50)


def main() -> int:
    """Run the command line; a stop while modules are loading gives the same message as a later stop."""
    gc.set_threshold(OBJECTS_BEFORE_SEARCHES)
    gc.callbacks.append(_first_search)
    # the last searches, at the end of the process, would look at all objects, whose memory is given back anyhow
    atexit.register(gc.freeze)
    keep_memory()
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


def _first_search(phase: str, info: dict[str, int]) -> None:
    """Leave all objects out of the first search and later ones, when the first begins; search more often from then on."""
    gc.callbacks.remove(_first_search)
    gc.freeze()
    gc.set_threshold(*OBJECTS_BETWEEN_SEARCHES)


if __name__ == "__main__":
    sys.exit(main())
