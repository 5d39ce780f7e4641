"""Choice of tests: cases with the mark sweep, by their ids; parts of the sweep and of any selection. Collection without the
garbage collector; one thread a process.

    python -m pytest                          all tests without the mark sweep
    python -m pytest --sweep-part 3/5         and the third of five parts of the tests that have it
    python -m pytest -m sweep                 these alone
    python -m pytest -m quick --part 2/5      the second of five parts of a selection

A test is in the same part whatever else is collected, so the N parts together are all tests, each once.
"""

from __future__ import annotations

import gc
import os
import zlib
from collections.abc import Generator

import pytest

# before NumPy is imported, here and in what tests start: processes that run side by side and have threads each wait for one
# another, a tenth more of processor time and up to a third of the clock's
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(threads, "1")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options that choose parts of the tests."""
    parser.addoption(
        "--sweep-part", type=part, metavar="K/N", help="also run part K of N of the tests with the mark sweep"
    )
    parser.addoption("--part", type=part, metavar="K/N", help="run part K of N of the tests that are selected")


def part(text: str) -> tuple[int, int]:
    """Number of a part, from 1, and count of parts, of "K/N".

    Raises ValueError for any other text, which pytest reports.
    """
    number, count = map(int, text.split("/"))
    if not 1 <= number <= count:
        raise ValueError(f"part {text}: must be K/N with K from 1 to N")
    return number, count


def in_part(item: pytest.Item, chosen: tuple[int, int] | None) -> bool:
    """True for tests of the chosen part, by a checksum of their ids."""
    return chosen is not None and zlib.crc32(item.nodeid.encode()) % chosen[1] == chosen[0] - 1


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect the tests without garbage collection: 3,500 tests leave no garbage, and to find that out took a quarter of the
    time."""
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
    left_out = [item for item in items if not selected(item, config)]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if selected(item, config)]


def selected(item: pytest.Item, config: pytest.Config) -> bool:
    """True for tests that the options select; a mark that -m names decides alone about the sweep."""
    if not config.option.markexpr and item.get_closest_marker("sweep") and not in_part(item, config.option.sweep_part):
        return False
    return config.option.part is None or in_part(item, config.option.part)
