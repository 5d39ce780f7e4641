"""Messages between the server and its process for heavy work: a length, then a JSON text or other bytes."""

from __future__ import annotations

import struct
from typing import BinaryIO

#: length of a message in 4 bytes
FRAME_LENGTH = struct.Struct("<I")


def write_frame(stream: BinaryIO, content: bytes) -> None:
    """Write a message."""
    stream.write(FRAME_LENGTH.pack(len(content)) + content)
    stream.flush()


def read_frame(stream: BinaryIO) -> bytes | None:
    """Return the next message; None at the end of the stream."""
    head = stream.read(FRAME_LENGTH.size)
    if len(head) < FRAME_LENGTH.size:
        return None
    (size,) = FRAME_LENGTH.unpack(head)
    content = stream.read(size)
    return content if len(content) == size else None
