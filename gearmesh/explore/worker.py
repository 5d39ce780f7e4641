"""The process for heavy work: reads requests from standard input, writes answers to standard output, ends with its input.

A request is JSON with a `job`. Its answers begin with a line that names the job and their type; the last one is "end". A request
{"cancel": job} ends work that is not wanted any more.
"""

from __future__ import annotations

import json
import os
import queue
import signal
import sys
import threading
import time
from typing import Any, BinaryIO

from gearmesh.explore.frames import EMPTY_TABLE, SIGN_TYPE, read_frame, refused, write_frame

#: least time between two reports of progress, s
PROGRESS_INTERVAL_S = 0.05
#: time without an answer after which work that goes on says so, s: on a busy machine one stage may take long
SIGN_INTERVAL_S = 5.0


class Inbox:
    """Requests that are waiting, and those that are not wanted any more."""

    def __init__(self, stream: BinaryIO) -> None:
        self.requests: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self.cancelled: set[int] = set()
        self._stream = stream
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        while (content := read_frame(self._stream)) is not None:
            request = json.loads(content)
            if "cancel" in request:
                self.cancelled.add(request["cancel"])
            else:
                self.requests.put(request)
        # nobody listens any more: work that still runs is of no use
        os._exit(0)


class Answers:
    """Answers to a request with a number, written one after the other, whatever thread they come from."""

    def __init__(self, output: BinaryIO, number: int) -> None:
        self.number, self._output, self._writing = number, output, threading.Lock()
        self._told, self._signed = 0.0, time.monotonic()

    def send(self, message: dict[str, Any]) -> None:
        """Write an answer; reports of progress that follow each other too soon are left out."""
        if message["type"] == "progress":
            now = time.monotonic()
            if now - self._told < PROGRESS_INTERVAL_S:
                return
            self._told = now
        self._write(message["type"], json.dumps(message, separators=(",", ":"), allow_nan=False).encode())

    def sign(self) -> None:
        """Write that the work goes on if nothing was written for long."""
        if time.monotonic() - self._signed > SIGN_INTERVAL_S:
            self._write(SIGN_TYPE, EMPTY_TABLE)

    def _write(self, kind: str, content: bytes) -> None:
        head = json.dumps({"job": self.number, "type": kind}).encode()
        with self._writing:
            self._signed = time.monotonic()
            write_frame(self._output, head + b"\n" + content)


def main() -> None:
    """Answer requests until the input ends."""
    # Ctrl-C in a terminal is for the program, which then ends the input
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # what a library prints must not come between messages
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    inbox = Inbox(sys.stdin.buffer)

    # before the first message, which comes when the program has read its design
    from gearmesh.explore.kept import Job, Stale
    from gearmesh.explore.state import Origin
    from gearmesh.explore.workshop import Workshop

    opened = inbox.requests.get()
    assert opened is not None, "the first message"
    workshop = Workshop(None if opened["opened"] is None else Origin(**opened["opened"]))
    while (request := inbox.requests.get()) is not None:
        number = int(request.pop("job"))
        answers = Answers(output, number)

        def is_stale(answers: Answers = answers) -> bool:
            # asked at every surface: the place where work that takes long shows that it goes on
            answers.sign()
            return answers.number in inbox.cancelled

        job = Job(answers.send, is_stale)
        status = "done"
        try:
            job.check()
            workshop.answer(request, job)
        except Stale:
            status = "cancelled"
        except MemoryError:
            answers.send(refused("out of memory: choose coarser gears"))
        except Exception as fault:  # a fault of the program, which the page must show
            print(f"gearmesh explore: {type(fault).__name__}: {fault}", file=sys.stderr)
            line = " ".join(f"a fault of the program: {type(fault).__name__}: {fault}".split())
            answers.send(refused(line[:300]))
        inbox.cancelled.discard(number)
        answers.send({"type": "end", "status": status})


if __name__ == "__main__":
    main()
