"""Make the pictures of the kinds on the first screen of the local page: `python scripts/kind_pictures.py [KIND ...]`."""

from __future__ import annotations

import sys
import tempfile
import tomllib
from pathlib import Path

from PIL import Image

import gearmesh as gm

#: folder of the pictures
TARGET = Path(__file__).parents[1] / "gearmesh" / "explore" / "page" / "kinds"
#: width and height of the pictures, pixels, and how many times larger they are drawn
SIZE, DRAWN = (320, 240), 3
#: quality of JPEG files, per cent
QUALITY_PERCENT = 82


def main() -> None:
    """Draw the gears of a new file of each kind, or of those that are named, in mesh, without title."""
    TARGET.mkdir(exist_ok=True)
    for kind in sys.argv[1:] or gm.kinds():
        gears = gm.build(gm.parse(tomllib.loads(gm.new(kind, short=True))))
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "pair.png"
            gears.picture("pair", size=(DRAWN * SIZE[0], DRAWN * (SIZE[1] + 24))).save(file)
            # the title is above the gears
            drawn = Image.open(file).convert("RGB").crop((0, DRAWN * 24, DRAWN * SIZE[0], DRAWN * (SIZE[1] + 24)))
            drawn.resize(SIZE, Image.Resampling.LANCZOS).save(
                TARGET / f"{kind}.jpg", quality=QUALITY_PERCENT, optimize=True
            )
        print(f"{kind}: {(TARGET / f'{kind}.jpg').stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
