"""How many examples property tests are asked: the same ones every time, or, to look for more, other ones.

    EXAMPLES=20000 python -m pytest -n 0 tests/kernel -k "twist or curvature"

asks so many, drawn anew. Without it the examples follow from the test alone, so that no machine turns red by luck.
"""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

#: set by who looks for more
WANTED = os.environ.get("EXAMPLES")


def examples(count: int) -> settings:
    """Settings of a property test with `count` examples."""
    return settings(
        max_examples=int(WANTED or count),
        derandomize=WANTED is None,
        database=None,
        deadline=None,
        suppress_health_check=[HealthCheck.too_slow],
    )
