"""Searches side by side: each asks for designs, all questions of a round are answered together.

The searches of scipy call a function and wait for its value. Here each runs in its own thread and waits until every
other one has asked, too, or has ended. The designs of a round therefore do not depend on the time that any of them
takes, nor on the number of workers that compute them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from queue import SimpleQueue
from threading import Thread
from typing import Any, TypeVar

Question = TypeVar("Question")
Answer = TypeVar("Answer")

#: function by which a search asks for the answers to several questions
Ask = Callable[[Sequence[Any]], list[Any]]


class EndedError(Exception):
    """End of a search: there are no more answers."""


def in_lockstep(searches: Sequence[Callable[[Ask], None]], answer: Callable[[list[Any]], list[Any] | None]) -> bool:
    """Run searches until each has ended; return False if `answer` returned None for the questions of a round.

    The first error of a search ends the others and is raised.
    """
    events: SimpleQueue[tuple[int, Sequence[Any] | None, BaseException | None]] = SimpleQueue()
    replies: list[SimpleQueue[list[Any] | None]] = [SimpleQueue() for _ in searches]

    def run(number: int) -> None:
        def ask(questions: Sequence[Any]) -> list[Any]:
            events.put((number, questions, None))
            reply = replies[number].get()
            if reply is None:
                raise EndedError
            return reply

        try:
            searches[number](ask)
        except EndedError:
            events.put((number, None, None))
        except BaseException as failure:  # raised again in the caller's thread
            events.put((number, None, failure))
        else:
            events.put((number, None, None))

    threads = [Thread(target=run, args=(number,), daemon=True) for number in range(len(searches))]
    for thread in threads:
        thread.start()
    running, failure, answered = set(range(len(searches))), None, True
    waiting: dict[int, Sequence[Any]] = {}
    try:
        while running:
            while len(waiting) < len(running):
                number, questions, error = events.get()
                if questions is None:
                    running.discard(number)
                    failure = failure or error
                else:
                    waiting[number] = questions
            if failure is not None or not running:
                break
            order = sorted(waiting)
            answers = answer([question for number in order for question in waiting[number]])
            if answers is None:
                answered = False
                break
            for number in order:
                count = len(waiting.pop(number))
                replies[number].put(answers[:count])
                answers = answers[count:]
    finally:
        for number in running:
            replies[number].put(None)
        for thread in threads:
            thread.join()
    if failure is not None:
        raise failure
    return answered
