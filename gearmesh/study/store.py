"""What of a study is done: one file to which finished chunks are added, each a line with its checksum.

    DIR/plan.json      what is studied; another plan in the same folder is refused
    DIR/rows.jsonl     {"done": [7, [[...], ...]], "crc": ...}, one line a chunk, in the order in which they were finished

A line is written with one call and flushed to disk, so that a process which is killed leaves whole lines and at most a torn one,
which the next run cuts off. Chunks are numbered by the plan: none is done twice, and none is lost.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gearmesh.errors import OutputError

PLAN, ROWS = "plan.json", "rows.jsonl"

Rows = list[list[Any]]


class StudyStore:
    """Finished chunks of one plan: in a folder, or in memory alone (folder None)."""

    def __init__(self, folder: Path | None, plan: Mapping[str, Any]) -> None:
        self.folder, self.plan = folder, json.dumps(plan, indent=1, sort_keys=True) + "\n"
        self.chunks: dict[int, Rows] = {}
        self._file: int | None = None

    @contextmanager
    def opened(self) -> Iterator[StudyStore]:
        """The store, with what is done already read; nobody else may open it meanwhile.

        Raises OutputError for a folder that holds another plan, is in use or cannot be written.
        """
        if self.folder is None:
            yield self
            return
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            self._file = os.open(self.folder / ROWS, os.O_RDWR | os.O_CREAT, 0o666)
            try:
                self._lock()
                self._keep_plan()
                self._read()
                yield self
            finally:
                os.close(self._file)
                self._file = None
        except OSError as error:
            raise OutputError(f"cannot write {self.folder}: {error.strerror or error}") from error

    def add(self, chunk: int, rows: Rows) -> None:
        """Keep a finished chunk; one that is there already stays as it is."""
        if chunk in self.chunks:
            return
        self.chunks[chunk] = rows
        if self._file is not None:
            line = _line(chunk, rows)
            while line:
                line = line[os.write(self._file, line) :]
            os.fsync(self._file)

    def _lock(self) -> None:
        try:
            import fcntl
        except ImportError:  # no such locks on Windows
            return
        assert self._file is not None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise OutputError(f"-o {self.folder}: another process is working on this study") from None

    def _keep_plan(self) -> None:
        from gearmesh.io.atomic import whole_text

        assert self.folder is not None
        file = self.folder / PLAN
        if file.exists():
            if file.read_text(encoding="utf-8") != self.plan:
                raise OutputError(
                    f"-o {self.folder}: holds another study (design, plan, --record or version differ); name another folder"
                )
            return
        whole_text(file, self.plan)

    def _read(self) -> None:
        """Chunks of whole lines; what is torn at the end is cut off."""
        assert self._file is not None
        assert self.folder is not None
        good = 0
        with open(self.folder / ROWS, "rb") as file:
            for line in file:
                found = _parsed(line)
                if found is None:
                    break
                self.chunks.setdefault(*found)
                good += len(line)
        os.ftruncate(self._file, good)
        os.lseek(self._file, good, os.SEEK_SET)


def _line(chunk: int, rows: Rows) -> bytes:
    text = json.dumps([chunk, rows], allow_nan=False, separators=(",", ":"))
    return f'{{"done":{text},"crc":{zlib.crc32(text.encode())}}}\n'.encode()


def _parsed(line: bytes) -> tuple[int, Rows] | None:
    """Chunk and rows of a line; None for a torn one."""
    if not line.endswith(b"\n"):
        return None
    try:
        found = json.loads(line)
        chunk, rows = found["done"]
    except (ValueError, KeyError, TypeError):
        return None
    return (int(chunk), rows) if _line(chunk, rows) == line else None
