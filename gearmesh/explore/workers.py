"""The process for heavy work as the server sees it: started again when it ends or hangs, one job at a time."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from gearmesh.explore.frames import FRAME_LENGTH
from gearmesh.explore.state import Origin

#: time without any answer after which a job counts as hung, s; reports of progress are answers
HANG_S = 60.0
#: number of processes that a job may end before it is given up
MAX_LOST_PER_JOB = 2
#: questions of which only the newest of a page counts
NEWEST_COUNTS = ("show", "range", "open", "start")

Answer = Callable[[bytes], None]


@dataclass
class Asked:
    """A question of a page."""

    #: page, by its number
    page: int
    request: dict[str, Any]
    #: called with every answer, a JSON text
    answer: Answer
    #: number of processes that ended while they worked on it
    lost: int = 0
    #: True if it is not wanted any more
    stale: bool = False

    @property
    def what(self) -> str:
        return str(self.request.get("do"))


@dataclass
class Worker:
    """Questions in turn, and the process that answers them."""

    opened: Origin | None
    #: called with a line about the process itself, for all pages
    report: Callable[[bool, str], None]
    hang_s: float = HANG_S
    waiting: list[Asked] = field(default_factory=list)
    running: Asked | None = None
    #: the process; None while there is none
    process: asyncio.subprocess.Process | None = None
    _job: int = 0
    _wake: asyncio.Event = field(default_factory=asyncio.Event)
    _task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Start the process and the loop that serves it."""
        self._task = asyncio.get_running_loop().create_task(self._serve())

    async def close(self) -> None:
        """End the process."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
        await self._end()

    def ask(self, asked: Asked) -> None:
        """Take a question; an older one of the same page is dropped if only the newest counts."""
        if asked.what in NEWEST_COUNTS:
            self.drop(asked.page, asked.what)
        if asked.what == "show":
            self.drop(asked.page, "range")
        self.waiting.append(asked)
        self._wake.set()

    def drop(self, page: int, what: str | None = None) -> None:
        """Drop the questions of a page, or those of one kind."""
        self.waiting = [each for each in self.waiting if each.page != page or what not in (None, each.what)]
        running = self.running
        if running is not None and running.page == page and what in (None, running.what) and not running.stale:
            running.stale = True
            self._write({"cancel": self._job})

    # ---------------------------------------------------------------- the process

    async def _begin(self) -> asyncio.subprocess.Process:
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
        self._write({"opened": None if self.opened is None else vars(self.opened)})
        return self.process

    async def _end(self) -> None:
        process, self.process = self.process, None
        if process is not None and process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            await process.wait()

    def _write(self, message: dict[str, Any]) -> None:
        process = self.process
        if process is not None and process.stdin is not None and process.returncode is None:
            content = json.dumps(message).encode()
            with contextlib.suppress(ConnectionError):
                process.stdin.write(FRAME_LENGTH.pack(len(content)) + content)

    async def _serve(self) -> None:
        await self._begin()
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
        await self._end()
        why = f"gave no answer for {self.hang_s:g} s" if hung else "ended"
        self.report(False, f"the process for the gears {why}; a new one takes over, and nothing that was set is lost")
        await self._begin()
        asked.lost += 1
        if asked.stale:
            return
        if asked.lost < MAX_LOST_PER_JOB:
            if not any(each.page == asked.page and each.what == asked.what for each in self.waiting):
                self.waiting.append(asked)
            return
        line = f"{asked.what}: the process for the gears {why} {asked.lost} times; change a key to try again"
        told: dict[str, Any] = {"type": "refused", "line": line, "key": "", "offers": [], "id": asked.request.get("id")}
        asked.answer(json.dumps(told).encode())
        asked.answer(json.dumps({"type": "end", "status": "lost", "id": asked.request.get("id")}).encode())

    async def _work(self, asked: Asked) -> None:
        """Send a question to the process and pass its answers on. Raises if the process ends or hangs."""
        process = self.process
        if process is None or process.returncode is not None:
            raise ConnectionResetError
        assert process.stdout is not None
        self._job += 1
        self._write({**asked.request, "job": self._job})
        while True:
            size = FRAME_LENGTH.unpack(
                await asyncio.wait_for(process.stdout.readexactly(FRAME_LENGTH.size), self.hang_s)
            )[0]
            content = await asyncio.wait_for(process.stdout.readexactly(size), self.hang_s)
            line, _, message = content.partition(b"\n")
            head = json.loads(line)
            if head["job"] != self._job:
                continue
            if not asked.stale:
                asked.answer(message)
            if head["type"] == "end":
                self.report(True, "")
                return
