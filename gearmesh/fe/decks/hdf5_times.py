"""Times in the object headers of HDF5 files, replaced by a fixed one: the same model then has the same bytes.

The MED library stores in each object when it was written, and has no switch for that. A header of version 2 is

    "OHDR", version, flags, times (4 x 4 bytes, if bit 5 of flags), limits (2 x 2 bytes, if bit 4),
    size (1, 2, 4 or 8 bytes by bits 0 and 1), messages of this size, checksum (4 bytes)

[HDF5 File Format Specification, version 3.0, IV.A.1.b]. The checksum is that of Bob Jenkins (lookup3) over all bytes
before it. A place counts as a header only if its checksum is right, so that no data are taken for one.
"""

from __future__ import annotations

import struct
from pathlib import Path

#: first bytes of a header of version 2
HEADER_START = b"OHDR\x02"
#: bit of the flags of a header with times
TIMES_FLAG = 0x20
#: bit of the flags of a header with limits of its attributes
LIMITS_FLAG = 0x10
#: bytes of signature, version and flags
PREFIX_BYTES = 6
#: bytes of the four times
TIMES_BYTES = 16
#: all bits of a word
WORD_MASK = 0xFFFFFFFF
#: rotations of the rounds of the checksum, and of its end
ROUND_ROTATIONS = (4, 6, 8, 16, 19, 4)
END_ROTATIONS = (14, 11, 25, 16, 4, 14, 24)


def without_times(path: Path) -> None:
    """Set all times in the object headers of an HDF5 file to the beginning of 1970."""
    data = bytearray(path.read_bytes())
    place = data.find(HEADER_START)
    while place >= 0:
        end = _end_of_header(data, place)
        if end is not None:
            data[place + PREFIX_BYTES : place + PREFIX_BYTES + TIMES_BYTES] = bytes(TIMES_BYTES)
            struct.pack_into("<I", data, end, checksum(bytes(data[place:end])))
        place = data.find(HEADER_START, place + 1)
    path.write_bytes(data)


def _end_of_header(data: bytearray, place: int) -> int | None:
    """Return the place of the checksum of a header with times; None if there is no such header at a place."""
    flags = data[place + PREFIX_BYTES - 1]
    if not flags & TIMES_FLAG:
        return None
    size_at = place + PREFIX_BYTES + TIMES_BYTES + (4 if flags & LIMITS_FLAG else 0)
    width = 1 << (flags & 3)
    end = size_at + width + int.from_bytes(data[size_at : size_at + width], "little")
    if end + 4 > len(data):
        return None
    (stored,) = struct.unpack_from("<I", data, end)
    return end if stored == checksum(bytes(data[place:end])) else None


def checksum(data: bytes) -> int:
    """Return the checksum (lookup3, initial value 0) of HDF5's metadata."""
    a = b = c = (0xDEADBEEF + len(data)) & WORD_MASK
    words = struct.unpack(f"<{-(-len(data) // 12) * 3}I", data.ljust(-(-len(data) // 12) * 12, b"\0"))
    if not words:
        return c
    for k in range(0, len(words) - 3, 3):
        a, b, c = (a + words[k]) & WORD_MASK, (b + words[k + 1]) & WORD_MASK, (c + words[k + 2]) & WORD_MASK
        a, b, c = _round(a, b, c)
    a, b, c = (a + words[-3]) & WORD_MASK, (b + words[-2]) & WORD_MASK, (c + words[-1]) & WORD_MASK
    return _last_round(a, b, c)


def _rotated(word: int, bits: int) -> int:
    """Return a word, its bits moved round to the left."""
    return ((word << bits) | (word >> (32 - bits))) & WORD_MASK


def _round(a: int, b: int, c: int) -> tuple[int, int, int]:
    """Return the three words mixed."""
    for bits in ROUND_ROTATIONS:
        a = ((a - c) & WORD_MASK) ^ _rotated(c, bits)
        a, b, c = b, (c + b) & WORD_MASK, a
    return a, b, c


def _last_round(a: int, b: int, c: int) -> int:
    """Return the checksum of the three words."""
    for bits in END_ROTATIONS:
        c = ((c ^ b) - _rotated(b, bits)) & WORD_MASK
        a, b, c = b, c, a
    return b
