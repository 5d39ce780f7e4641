"""`python -m gearmesh`."""

import sys

from gearmesh.cli import main

if __name__ == "__main__":
    sys.exit(main())
