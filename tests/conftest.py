"""Which cases of a parametrised test have the mark sweep, by their ids; collection without the garbage collector; one thread a
process."""

from __future__ import annotations

import gc
import os
from collections.abc import Generator

import pytest

# before NumPy is imported, here and in what tests start: processes that run side by side and have threads each wait for one
# another, a tenth more of processor time and up to a third of the clock's
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(threads, "1")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Of 3,500 tests nothing is garbage, which took a quarter of the time to learn."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Cases that `sweep_cases` names have the mark sweep.

    Raises pytest.UsageError for an id that no case of the test has.
    """
    unknown: dict[str, set[str]] = {}
    for item in items:
        case = item.name.partition("[")[2].removesuffix("]")
        test = item.nodeid.partition("[")[0]
        for mark in item.iter_markers("sweep_cases"):
            unknown.setdefault(test, set(mark.args)).discard(case)
            if case in mark.args:
                item.add_marker("sweep")
    # a case that was asked for by its id comes alone
    lines = [f"{test} has no case {', '.join(sorted(ids))}" for test, ids in unknown.items() if ids]
    if lines and not any("::" in argument for argument in config.args):
        raise pytest.UsageError("\n".join(lines))
