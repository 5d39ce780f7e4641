"""The process for heavy work as the server sees it: started again when it ends or hangs, one job at a time."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys
from collections.abc import Callable
from dataclasses import field
from typing import Any

from gearmesh.explore.frames import EMPTY_TABLE, FRAME_LENGTH, SIGN_TYPE, frame, refused
from gearmesh.explore.state import Origin
from gearmesh.records import dataclass

#: time without any answer after which a job counts as hung, s; reports of progress are answers
HANG_S = 60.0
#: time in which a process that has closed its output must be gone, s
ENDING_S = 60.0
#: number of processes that a job may end before it is given up
MAX_LOST_PER_JOB = 2
#: questions of which only the newest of a page counts
NEWEST_COUNTS = ("show", "range", "open", "start")

#: questions that do not wait for the range of a key, which may take a minute: the page asks for it again
ENDS_RANGES = ("show", "file")

#: number of the page of questions that no page has asked yet
NO_PAGE = 0

Answer = Callable[[bytes], None]


@dataclass(frozen=True, eq=False)
class Listener:
    """A page that waits for the answers to a question."""

    #: page, by its number
    page: int
    #: number of its message
    identity: int | None
    #: called with every answer, a JSON text
    answer: Answer

    def hear(self, content: bytes) -> None:
        """Pass an answer on, with the number of the message."""
        entry = f'"id":{json.dumps(self.identity)}}}'.encode()
        self.answer(content[:-1] + (entry if content == EMPTY_TABLE else b"," + entry))


@dataclass
class Asked:
    """A question, and the pages that ask it; without any of them it is not wanted any more."""

    #: message to the process
    request: dict[str, Any]
    #: pages that wait for answers
    listeners: list[Listener]
    #: answers that have come
    heard: list[bytes] = field(default_factory=list)
    #: number of processes that ended while they worked on it
    lost: int = 0

    @property
    def what(self) -> str:
        return str(self.request.get("do"))

    def hear(self, content: bytes) -> None:
        """Pass an answer on to all who listen."""
        self.heard.append(content)
        for listener in self.listeners:
            listener.hear(content)

    def join(self, listener: Listener) -> None:
        """Add a listener, who hears first what has come before."""
        self.listeners.append(listener)
        for content in self.heard:
            listener.hear(content)


@dataclass
class Worker:
    """Questions in turn, and the process that answers them."""

    #: called with a line about the process itself, for all pages
    report: Callable[[bool, str], None] = lambda works, line: None
    #: time without a sign of life, s, after which the process is ended
    hang_s: float = HANG_S
    #: first message to the process; None until the design is known
    first: dict[str, Any] | None = None
    #: questions that wait for the process, in turn
    waiting: list[Asked] = field(default_factory=list)
    #: question that the process works on; None without one
    running: Asked | None = None
    #: the process; None while there is none
    process: asyncio.subprocess.Process | None = None
    #: True while the program itself waits for the first answer to its question
    held: bool = False
    #: True once a page has asked
    _has_page: bool = False
    #: number of the last question that was sent
    _job: int = 0
    #: set when a question waits
    _wake: asyncio.Event = field(default_factory=asyncio.Event)
    #: task that serves the questions
    _task: asyncio.Task[None] | None = None

    def open(self, opened: Origin | None) -> None:
        """Tell the process the design, and serve it."""
        self.first = {"opened": None if opened is None else vars(opened)}
        self._write(self.first)
        self._task = asyncio.get_running_loop().create_task(self._serve())

    async def close(self) -> None:
        """End the process."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
        await self._end()

    @property
    def _unanswered(self) -> list[Asked]:
        """Questions without an end: the one that the process works on, then those that wait for it."""
        return [*([] if self.running is None else [self.running]), *self.waiting]

    def ask(self, request: dict[str, Any], listener: Listener) -> None:
        """Take a question; an older one of the same page is dropped if only the newest counts.

        A page that asks what is being worked on, for another page or before any page was there, joins in.
        """
        what = str(request.get("do"))
        same = next((each for each in self._unanswered if each.listeners and each.request == request), None)
        if same is not None and what == "show":
            same.join(listener)
        else:
            self.waiting.append(Asked(request, [listener]))
        for older in (what,) * (what in NEWEST_COUNTS) + ("range",) * (what in ENDS_RANGES):
            self.drop(listener.page, older, listener)
        self._has_page |= listener.page != NO_PAGE
        if not self.held:
            self.drop(NO_PAGE, None, listener)
        self._wake.set()

    def release(self) -> None:
        """Drop the question of the program, which has heard its first answer, as soon as a page has asked."""
        self.held = False
        if self._has_page:
            self.drop(NO_PAGE)

    def drop(self, page: int, what: str | None = None, newest: Listener | None = None) -> None:
        """Drop the questions of a page, or those of one kind, but for the newest one."""
        for asked in self._unanswered:
            if what in (None, asked.what) and asked.listeners:
                asked.listeners = [each for each in asked.listeners if each.page != page or each is newest]
                if asked is self.running and not asked.listeners:
                    self._write({"cancel": self._job})
        self.waiting = [each for each in self.waiting if each.listeners]

    # ---------------------------------------------------------------- the process

    async def start(self) -> None:
        """Start the process, which prepares itself until the design is known."""
        path = os.pathsep.join(part for part in sys.path if part)
        threads = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        self.process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-m",
            "gearmesh.explore.worker",
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            # Ctrl-C in a terminal must not reach it, not even before it can ignore it
            start_new_session=True,
            env={**threads, **os.environ, "PYTHONPATH": path},
        )
        if self.first is not None:
            self._write(self.first)

    async def _end(self, *, ended: bool = False) -> None:
        """End the process, or wait for one that has `ended` by itself."""
        process, self.process = self.process, None
        if process is None or process.returncode is not None:
            return
        if ended:
            # `kill` asks after the process and so takes its status away from asyncio, which would then complain on standard error
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(ENDING_S):
                    await process.wait()
                    return
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()

    def _write(self, message: dict[str, Any]) -> None:
        process = self.process
        if process is not None and process.stdin is not None and process.returncode is None:
            with contextlib.suppress(ConnectionError):
                process.stdin.write(frame(json.dumps(message).encode()))

    async def _serve(self) -> None:
        while True:
            while not self.waiting:
                self._wake.clear()
                await self._wake.wait()
            # figures of one page before files and ranges of all
            self.waiting.sort(key=lambda each: each.what != "show")
            self.running = asked = self.waiting.pop(0)
            try:
                await self._work(asked)
            except (asyncio.IncompleteReadError, TimeoutError, ConnectionError) as failure:
                await self._lose(asked, hung=isinstance(failure, TimeoutError))
            finally:
                self.running = None

    async def _lose(self, asked: Asked, *, hung: bool) -> None:
        """Replace the process, and ask again what it was working on, unless that ended too many."""
        await self._end(ended=not hung)
        why = f"gave no answer for {self.hang_s:g} s" if hung else "ended"
        self.report(False, f"the process for the gears {why}; a new one takes over, and nothing that was set is lost")
        await self.start()
        asked.lost += 1
        if not asked.listeners:
            return
        asked.heard = []
        if asked.lost < MAX_LOST_PER_JOB:
            self.waiting.append(asked)
            return
        line = f"{asked.what}: the process for the gears {why} {asked.lost} times; change a key to try again"
        asked.hear(json.dumps(refused(line)).encode())
        asked.hear(json.dumps({"type": "end", "status": "lost"}).encode())

    async def _work(self, asked: Asked) -> None:
        """Send a question to the process and pass its answers on. Raises if the process ends or hangs."""
        process = self.process
        if process is None or process.returncode is not None:
            raise ConnectionResetError
        assert process.stdout is not None
        self._job += 1
        self._write({**asked.request, "job": self._job})
        while True:
            # asyncio.wait_for loses a cancellation that comes with the answer, before Python 3.12: `close` would wait for ever
            async with asyncio.timeout(self.hang_s):
                (size,) = FRAME_LENGTH.unpack(await process.stdout.readexactly(FRAME_LENGTH.size))
                content = await process.stdout.readexactly(size)
            line, _, message = content.partition(b"\n")
            head = json.loads(line)
            if head["job"] != self._job:
                continue
            self.report(True, "")
            if head["type"] == SIGN_TYPE:
                continue
            asked.hear(message)
            if head["type"] == "end":
                return
