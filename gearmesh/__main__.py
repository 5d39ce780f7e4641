"""`python -m gearmesh`."""

import sys

from gearmesh.app.cli import main

if __name__ == "__main__":
    sys.exit(main())
