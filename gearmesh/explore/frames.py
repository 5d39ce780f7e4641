"""Messages between the server and its process for heavy work: a length, then a JSON text or other bytes."""

from __future__ import annotations

import struct
from typing import Any, BinaryIO

#: length of a message in 4 bytes
FRAME_LENGTH = struct.Struct("<I")
#: smallest answer, a JSON text without an entry
EMPTY_TABLE = b"{}"
#: type of an answer that only says that the work goes on; no page gets it
SIGN_TYPE = "alive"


def frame(content: bytes) -> bytes:
    """Return a message with its length before it."""
    return FRAME_LENGTH.pack(len(content)) + content


def write_frame(stream: BinaryIO, content: bytes) -> None:
    """Write a message."""
    stream.write(frame(content))
    stream.flush()


def refused(line: str) -> dict[str, Any]:
    """Return the answer to a question that failed for no fault of a key: nothing is offered."""
    return {"type": "refused", "line": line, "key": "", "offers": []}


def read_frame(stream: BinaryIO) -> bytes | None:
    """Return the next message; None at the end of the stream."""
    head = stream.read(FRAME_LENGTH.size)
    if len(head) < FRAME_LENGTH.size:
        return None
    (size,) = FRAME_LENGTH.unpack(head)
    content = stream.read(size)
    return content if len(content) == size else None
