"""PNG files of pixels, read by Pillow."""

import numpy as np
import pytest
from PIL import Image

from gearmesh.io.png import write_png


@pytest.mark.parametrize("shaded", [False, True])
def test_pixels_and_resolution_are_read_as_they_were_written(tmp_path, shaded):
    # differences of rows wrap around at 256; the part of a larger picture has rows that do not follow each other
    whole = np.random.default_rng(3).integers(0, 256, (40, 31, 4), dtype=np.uint8)
    pixels = whole[3:, 2:, :3]
    file = tmp_path / "part.png"
    write_png(file, pixels, shaded=shaded, dpi=150)
    with Image.open(file) as read:
        assert read.mode == "RGB"
        assert np.array_equal(np.asarray(read), pixels)
        assert read.info["dpi"] == pytest.approx((150, 150), rel=1e-4)


def test_rows_of_shaded_pictures_are_differences(tmp_path):
    # a picture of equal rows of noise is one row and zeros
    rows = np.tile(np.random.default_rng(5).integers(0, 256, (1, 30_000, 3), dtype=np.uint8), (20, 1, 1))
    file = tmp_path / "rows.png"
    write_png(file, rows, shaded=True)
    assert rows[0].size < file.stat().st_size < 1.1 * rows[0].size
