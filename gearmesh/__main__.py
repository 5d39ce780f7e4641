"""The program `gearmesh`, and `python -m gearmesh`."""

from __future__ import annotations

import sys


def main() -> int:
    """Answer the command line. Stopped while that is being loaded, it says so as it does later."""
    try:
        from gearmesh.app.cli import main as answer
    except KeyboardInterrupt:
        print("gearmesh: error: stopped: no file was written", file=sys.stderr)
        return 130
    return answer()


if __name__ == "__main__":
    sys.exit(main())
