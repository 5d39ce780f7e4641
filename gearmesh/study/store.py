"""Store of a study: one file to which finished chunks are added, each as one line with its checksum.

    DIR/plan.json      what is studied; another plan in the same folder is refused
    DIR/rows.jsonl     {"done": [7, [[...], ...]], "crc": ...}, one line per chunk, in the order in which they finished

A line is written with one call and flushed to disk. A process that is killed therefore leaves whole lines and at most
one torn line at the end, which the next run cuts off. Chunks are numbered by the plan: none is done twice, none is
lost. If the file holds anything else, it is refused and not changed.
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
from gearmesh.files.reading import BYTES_PER_MIB, file_text, is_file, size_text

#: name of the file of the plan
PLAN_FILE = "plan.json"
#: name of the file of finished chunks
ROWS_FILE = "rows.jsonl"
#: limit of a line, and of the additional size of another plan; the whole file of chunks has no limit
MAX_LINE_BYTES = 16 * BYTES_PER_MIB
#: limit of the size of whole numbers, as files of figures hold them
WHOLE_NUMBER_LIMIT = 2**63

Rows = list[list[Any]]


class StudyStore:
    """Finished chunks of one plan, in a folder or only in memory (folder None).

    The entries "rows", "chunk" (its size) and "record" of the plan determine which chunks are valid.
    """

    def __init__(self, folder: str | os.PathLike[str] | None, plan: Mapping[str, Any]) -> None:
        self.folder = None if folder is None else Path(folder)
        self.plan = json.dumps(plan, indent=1, sort_keys=True, default=str) + "\n"
        self._rows, self._chunk, self._figures = int(plan["rows"]), int(plan["chunk"]), len(plan["record"])
        self.chunks: dict[int, Rows] = {}
        self._file: int | None = None

    @contextmanager
    def open(self) -> Iterator[StudyStore]:
        """Yield the store with the finished chunks read; nobody else can open it meanwhile.

        Raises OutputError if the folder holds another plan, is in use, or cannot be written.
        """
        if self.folder is None:
            yield self
            return
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            if (self.folder / ROWS_FILE).exists() and not is_file(self.folder / ROWS_FILE):
                raise OutputError(
                    self.folder / ROWS_FILE, reason="is not a regular file; it must hold the rows of a study"
                )
            self._file = os.open(self.folder / ROWS_FILE, os.O_RDWR | os.O_CREAT, 0o666)
            try:
                self._lock()
                self._keep_plan()
                self._read()
                yield self
            finally:
                os.close(self._file)
                self._file = None
        except OSError as error:
            raise OutputError("cannot write", self.folder, reason=error.strerror or str(error)) from error

    def add(self, chunk: int, rows: Rows) -> None:
        """Add a finished chunk; a chunk that is already stored is not changed."""
        if chunk in self.chunks:
            return
        self.chunks[chunk] = rows
        if self._file is not None and self.folder is not None:
            from gearmesh.io.atomic import keep

            line = _line(chunk, rows)
            while line:
                line = line[os.write(self._file, line) :]
            os.fsync(self._file)
            keep(self.folder / ROWS_FILE)

    def _lock(self) -> None:
        try:
            import fcntl
        except ImportError:  # no such locks on Windows
            return
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise OutputError(str(self.folder), reason="another process is working on this study") from None

    def _keep_plan(self) -> None:
        from gearmesh.io.atomic import whole_text

        assert self.folder is not None
        file = self.folder / PLAN_FILE
        if os.path.lexists(file):
            if file_text(file, MAX_LINE_BYTES + len(self.plan), "plan of a study", OutputError) != self.plan:
                raise OutputError(
                    self.folder,
                    reason="holds another study (design, plan, record or version differ); name another folder",
                )
            return
        if os.fstat(self._descriptor).st_size:
            raise OutputError(self.folder, reason=f"holds {ROWS_FILE} without its {PLAN_FILE}; name another folder")
        whole_text(file, self.plan)

    def _read(self) -> None:
        """Read the chunks of whole lines, and cut off a torn line at the end.

        Raises OutputError for a whole line that is not a chunk of this plan.
        """
        assert self.folder is not None
        good, number = 0, 0
        with open(self._descriptor, "rb", closefd=False) as file:
            while line := file.readline(MAX_LINE_BYTES + 1):
                number += 1
                parsed = _parse(line)
                if parsed is None and not file.read(1) and len(line) <= MAX_LINE_BYTES:
                    break
                if parsed is None or not self._holds(*parsed):
                    why = (
                        f"longer than {size_text(MAX_LINE_BYTES)}"
                        if len(line) > MAX_LINE_BYTES
                        else "not a finished chunk of this study"
                    )
                    mended = "delete the line to compute its rows again, or name another folder"
                    raise OutputError(self.folder / ROWS_FILE, reason=f"line {number}: {why}; {mended}")
                self.chunks.setdefault(*parsed)
                good += len(line)
        os.ftruncate(self._descriptor, good)
        os.lseek(self._descriptor, good, os.SEEK_SET)

    def _holds(self, chunk: int, rows: Any) -> bool:
        """Return True if the plan has such a chunk: the right number of rows, each with its figures and a reason."""
        size = min(self._chunk, self._rows - chunk * self._chunk)
        return (
            chunk >= 0
            and isinstance(rows, list)
            and len(rows) == size
            and all(
                isinstance(row, list) and len(row) == self._figures + 1 and isinstance(row[-1], str) for row in rows
            )
            and all(_is_figure(figure) for row in rows for figure in row[:-1])
        )

    @property
    def _descriptor(self) -> int:
        assert self._file is not None
        return self._file


def _line(chunk: int, rows: Rows) -> bytes:
    text = json.dumps([chunk, rows], allow_nan=False, separators=(",", ":"))
    return f'{{"done":{text},"crc":{zlib.crc32(text.encode())}}}\n'.encode()


def _parse(line: bytes) -> tuple[int, Rows] | None:
    """Return chunk and rows of a line; None for a torn line."""
    if not line.endswith(b"\n"):
        return None
    try:
        entry = json.loads(line)
        chunk, rows = entry["done"]
        whole = type(chunk) is int and _line(chunk, rows) == line
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    return (chunk, rows) if whole else None


def _is_figure(value: Any) -> bool:
    """Return True if a row may have this value: a number that files hold, a text, or None."""
    return (
        value is None or isinstance(value, str | float) or (isinstance(value, int) and abs(value) < WHOLE_NUMBER_LIMIT)
    )
