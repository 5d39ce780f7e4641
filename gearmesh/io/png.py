"""PNG files of pixels. Every row has the same filter; a library that tries all of them for each row takes twice as long."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.formats import PNG_COMPRESSION_LEVEL

#: first bytes of a file
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
#: depth of a channel in bits, colour type RGB, and the only methods of compression, filtering and interlacing
RGB_FORMAT = (8, 2, 0, 0, 0)
#: filters of rows: none, and the difference from the row above
NO_FILTER, ABOVE_FILTER = 0, 2
#: millimetres of an inch over those of a metre
INCHES_PER_METRE = 1.0 / 0.0254
#: unit of resolutions: pixels per metre
PER_METRE_UNIT = 1


def write_png(file: Path, pixels: NDArray[np.uint8], *, shaded: bool, dpi: float | None = None) -> None:
    """Write RGB pixels (H, W, 3), with the resolution `dpi` if given.

    Rows of `shaded` pictures are differences from the rows above, those of line drawings are as they are.
    """
    high, wide, channels = pixels.shape
    flat = np.ascontiguousarray(pixels).reshape(high, channels * wide)
    rows = np.empty((high, 1 + channels * wide), dtype=np.uint8)
    rows[:, 0] = ABOVE_FILTER if shaded else NO_FILTER
    rows[:, 1:] = flat
    if shaded:
        rows[1:, 1:] -= flat[:-1]
    chunks = [(b"IHDR", struct.pack(">2I5B", wide, high, *RGB_FORMAT))]
    if dpi is not None:
        chunks.append((b"pHYs", struct.pack(">2IB", *[round(dpi * INCHES_PER_METRE)] * 2, PER_METRE_UNIT)))
    chunks += [(b"IDAT", zlib.compress(rows.data, PNG_COMPRESSION_LEVEL)), (b"IEND", b"")]
    with open(file, "wb") as stream:
        stream.write(PNG_SIGNATURE)
        for name, data in chunks:
            stream.write(
                struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(data, zlib.crc32(name)))
            )
