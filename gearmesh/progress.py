"""How far a long piece of work is, and its end before it is done.

A piece of work that takes a `progress` tells it. What takes none, as it is part of other work or has few stages, says `tell`:
whoever waits for it listens with `listening`, and by default nobody does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event
from typing import Any, TypeVar

#: Told how far a long piece of work is (0 to 1) and what it is doing.
Progress = Callable[[float, str], None]

Item = TypeVar("Item")


def silent(fraction: float, doing: str) -> None:
    """Progress of which nobody wants to know."""


_listener: ContextVar[Callable[[float], None] | None] = ContextVar("listener", default=None)


@contextmanager
def listening(listener: Callable[[float], None] | None) -> Iterator[None]:
    """Have a listener called with how far the work within is, 0 to 1; None: nobody."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


def tell(fraction: float) -> None:
    """Say how far (0 to 1) the present piece of work is."""
    listener = _listener.get()
    if listener is not None:
        listener(fraction)


@contextmanager
def part(first: float, last: float) -> Iterator[None]:
    """A part of the present piece of work, between two fractions of it; at its end all of the part is done."""
    whole = _listener.get()
    if whole is None:
        yield
        return
    with listening(lambda fraction: whole(first + (last - first) * fraction)):
        yield
    whole(last)


def in_turn(items: Iterable[Item]) -> Iterator[Item]:
    """The items one after the other, each as large a part of the present piece of work as the next."""
    every: Sequence[Item] = list(items)
    for k, item in enumerate(every):
        with part(k / len(every), (k + 1) / len(every)):
            yield item


_ended: ContextVar[Event | None] = ContextVar("ended", default=None)


def side_by_side(work: Callable[..., Item], *arguments: Iterable[Any]) -> list[Item]:
    """What `work` gives for each set of arguments, as `map` has them, each in a thread of its own.

    Whatever ends the wait for them, as Ctrl-C or an error in one, ends the others where they next say `go_on`.
    """
    ended = Event()

    def own(*values: Any) -> Item:
        _ended.set(ended)
        return work(*values)

    columns = list(zip(*arguments, strict=True))
    with ThreadPoolExecutor(len(columns)) as threads:
        waiting = [threads.submit(own, *values) for values in columns]
        try:
            return [result.result() for result in waiting]
        except BaseException:
            ended.set()
            raise


def go_on() -> None:
    """Go on with a piece of work, unless nobody waits for it any more: raises CancelledError then."""
    ended = _ended.get()
    if ended is not None and ended.is_set():
        raise CancelledError
