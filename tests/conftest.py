"""Which cases of a parametrised test have the mark sweep, by their ids; collection without the garbage collector."""

from __future__ import annotations

import gc
from collections.abc import Generator

import pytest


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
