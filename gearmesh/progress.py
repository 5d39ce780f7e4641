"""Progress of long work, and its early end.

Work with an argument `progress` calls it. Work without one, as part of other work or with few stages, calls `tell`; a caller
that wants to know uses `listening`. By default nobody listens.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event
from typing import Any, TypeVar

#: function that is called with the share of work done (0 to 1) and the present stage
Progress = Callable[[float, str], None]

Item = TypeVar("Item")


def silent(fraction: float, doing: str) -> None:
    """Ignore progress."""


def stage_of(progress: Progress, number: int, count: int) -> Progress:
    """Return the progress of one of `count` equal stages of some work, counted from 0."""
    return lambda fraction, doing: progress((number + fraction) / count, doing)


_listener: ContextVar[Callable[[float], None] | None] = ContextVar("listener", default=None)


@contextmanager
def listening(listener: Callable[[float], None] | None) -> Iterator[None]:
    """Call a listener with the share, 0 to 1, of the work in the context that is done; None for no listener."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


def tell(fraction: float) -> None:
    """Report the share, 0 to 1, of the present work that is done."""
    listener = _listener.get()
    if listener is not None:
        listener(fraction)


@contextmanager
def part(first: float, last: float) -> Iterator[None]:
    """Mark a part of the present work, between two shares of it; at the end of the context the part is done."""
    whole = _listener.get()
    if whole is None:
        yield
        return
    with listening(lambda fraction: whole(first + (last - first) * fraction)):
        yield
    whole(last)


def in_turn(items: Iterable[Item]) -> Iterator[Item]:
    """Yield items as equal parts of the present work."""
    every: Sequence[Item] = list(items)
    for k, item in enumerate(every):
        with part(k / len(every), (k + 1) / len(every)):
            yield item


_ended: ContextVar[Callable[[], bool] | None] = ContextVar("ended", default=None)


@contextmanager
def ending_when(is_ended: Callable[[], bool]) -> Iterator[None]:
    """End the work in the context, with CancelledError, at its next call of `go_on` after `is_ended` returns True."""
    token = _ended.set(is_ended)
    try:
        yield
    finally:
        _ended.reset(token)


def side_by_side(work: Callable[..., Item], *arguments: Iterable[Any]) -> list[Item]:
    """Return the results of `work` for each set of arguments, as `map` takes them, each in its own thread.

    Ctrl-C, or an error in one thread, ends the other threads at their next call of `go_on`.
    """
    from concurrent.futures import ThreadPoolExecutor

    ended = Event()

    def in_thread(*values: Any) -> Item:
        _ended.set(ended.is_set)
        return work(*values)

    columns = list(zip(*arguments, strict=True))
    with ThreadPoolExecutor(len(columns)) as threads:
        waiting = [threads.submit(in_thread, *values) for values in columns]
        try:
            return [result.result() for result in waiting]
        except BaseException:
            ended.set()
            raise


def go_on() -> None:
    """Raise CancelledError if nobody waits for the work any more."""
    ended = _ended.get()
    if ended is not None and ended():
        from concurrent.futures import CancelledError

        raise CancelledError
