"""Files from users: only regular files, of a limited size, decoded and parsed; an error is one line.

A fifo, a device or a socket is refused before it is opened for reading, so that the program neither waits for it nor
grows with it. The limit counts the bytes that are read, because the size that the system states may change.
"""

from __future__ import annotations

import json
import os
import re
import stat
import sys
import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Any, TextIO

from gearmesh.errors import FileError, GearmeshError
from gearmesh.files.toml_hints import toml_refusal

PathLike = str | os.PathLike[str]

#: bytes in a mebibyte
BYTES_PER_MIB = 1 << 20
#: name of standard input in messages about files
STANDARD_INPUT = "standard input (-)"
#: characters of a key or a value that messages show
MAX_VALUE_CHARACTERS = 40
#: levels of nested tables; a key of n dots takes the TOML parser n^2 steps
MAX_TABLE_DEPTH = 64

# a bare or quoted part of a dotted key, and the dot after it; possessive, so that it takes one pass
_DEEP_KEY = re.compile(
    r"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+)""" + f"{{{MAX_TABLE_DEPTH}}}"
)


def file_bytes(path: PathLike, most: int, wanted: str = "file", error: type[GearmeshError] = FileError) -> bytes:
    """Return the content of a regular file of up to `most` bytes; `wanted`: name of the kind of file, as "design file".

    Raises `error` in one line that begins with the path.
    """
    try:
        _refuse_special(os.stat(path).st_mode, path, wanted, error)
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        with open(descriptor, "rb") as file:
            _refuse_special(os.fstat(descriptor).st_mode, path, wanted, error)
            content = file.read(most + 1)
    except (OSError, ValueError) as failure:  # ValueError: a path with a NUL in it
        raise _unreadable(path, failure, error) from None
    if len(content) > most:
        raise error(path, reason=f"is larger than {size_text(most)}, the limit for a {wanted}")
    return content


def refuse_missing(path: PathLike) -> None:
    """Raise the FileError of reading if a path leads to nothing."""
    try:
        os.stat(path)
    except (OSError, ValueError) as failure:
        raise _unreadable(path, failure, FileError) from None


def _unreadable(path: PathLike, failure: Exception, error: type[GearmeshError]) -> GearmeshError:
    """Return the error for a file that cannot be read."""
    return error(path, reason=f"cannot be read: {getattr(failure, 'strerror', None) or failure}")


def file_text(path: PathLike, most: int, wanted: str = "file", error: type[GearmeshError] = FileError) -> str:
    """Return the content of a file as UTF-8 text, with or without a byte order mark."""
    return _utf8_text(file_bytes(path, most, wanted, error), path, error)


def input_text(most: int, wanted: str = "file", error: type[GearmeshError] = FileError) -> str:
    """Return the UTF-8 text on standard input, at most `most` bytes; it is read once and kept.

    Raises `error` in one line that begins with STANDARD_INPUT.
    """
    content = _input_bytes(sys.stdin, most)
    if content is None:
        raise error(STANDARD_INPUT, reason="is closed")
    if len(content) > most:
        raise error(STANDARD_INPUT, reason=f"is larger than {size_text(most)}, the limit for a {wanted}")
    return _utf8_text(content, STANDARD_INPUT, error)


@lru_cache(maxsize=1)
def _input_bytes(stream: TextIO | None, most: int) -> bytes | None:
    """Read a stream, up to one byte more than allowed; None if it is closed."""
    return None if stream is None or stream.closed else stream.buffer.read(most + 1)


def _utf8_text(content: bytes, path: PathLike, error: type[GearmeshError]) -> str:
    """Decode UTF-8; an error names the byte."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as failure:
        raise error(path, reason=f"not UTF-8 text (byte {failure.start})") from None


def read_toml(path: PathLike, most: int, wanted: str = "file", error: type[GearmeshError] = FileError) -> Any:
    """Return the table in a TOML file."""
    return toml_value(file_text(path, most, wanted, error), path, error)


def toml_value(text: str, path: PathLike, error: type[GearmeshError] = FileError) -> Any:
    """Return the table in a TOML text from a file."""
    try:
        if _DEEP_KEY.search(text):
            raise RecursionError
        return tomllib.loads(text)
    except RecursionError:
        raise error(path, reason="nested too deeply") from None
    except ValueError as failure:  # TOMLDecodeError, and numbers of more digits than Python reads
        reason, remedy = toml_refusal(text, failure)
        raise error(path, reason=reason, remedy=remedy) from None


def read_json(path: PathLike, most: int, wanted: str = "file", error: type[GearmeshError] = FileError) -> Any:
    """Return the value in a JSON file."""
    return json_value(file_text(path, most, wanted, error), path, error)


def json_value(text: str, path: PathLike, error: type[GearmeshError] = FileError) -> Any:
    """Return the value in a JSON text from a file; a key that occurs twice in an object is refused."""

    def table(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        """Return an object as a dict; refuse a key that occurs twice."""
        made = dict(pairs)
        if len(made) < len(pairs):
            names = [name for name, _ in pairs]
            twice = next(name for name in names if names.count(name) > 1)
            values = " and ".join(json.dumps(value)[:MAX_VALUE_CHARACTERS] for name, value in pairs if name == twice)
            raise error(
                path, reason=f"key {json.dumps(twice)[:MAX_VALUE_CHARACTERS]} is given twice in one object: {values}"
            )
        return made

    try:
        # NaN and Infinity are no numbers of JSON: as texts they are refused where a number is wanted, with their key
        return json.loads(text, object_pairs_hook=table, parse_constant=str)
    except json.JSONDecodeError as failure:
        raise error(path, reason=f"line {failure.lineno}, column {failure.colno}: {failure.msg}") from None
    except RecursionError:
        raise error(path, reason="nested too deeply") from None
    except ValueError as failure:  # numbers of more digits than Python reads
        raise error(path, reason=" ".join(str(failure).split())) from None


def is_file(path: PathLike) -> bool:
    """True if the path is a regular file."""
    try:
        return Path(path).is_file()
    except ValueError:
        return False


def size_text(size: int) -> str:
    """Return a size in words."""
    return f"{size // BYTES_PER_MIB} MiB" if size >= BYTES_PER_MIB else f"{size} bytes"


def _refuse_special(mode: int, path: PathLike, wanted: str, error: type[GearmeshError]) -> None:
    """Refuse a folder and every file that is not regular."""
    if stat.S_ISDIR(mode):
        raise error(path, reason=f"is a folder, not a {wanted}")
    if not stat.S_ISREG(mode):
        raise error(path, reason=f"is not a regular file; it must be a {wanted}")
