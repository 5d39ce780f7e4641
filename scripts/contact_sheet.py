"""Every scene of every sample on one sheet, to be looked at: how pictures are judged after a change of cameras, light or colours.

Usage: python scripts/contact_sheet.py SHEET.png [NAME ...] [--views VIEW ...] [--size WxH]

A tile has its picture drawn at the size (900x700 by default) and beside it at 400x300, where lines crowd. Views that a design does
not have are left out. NAME is a sample's. All samples take ten minutes. Needs OpenGL.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

from gearmesh import DesignError, Gears, NoSolutionError, build, load
from gearmesh.view.render import render

SAMPLES = Path(__file__).parents[1] / "samples"
#: views of one member, and of all
MEMBER_VIEWS, COMMON_VIEWS = ("contact", "pattern", "tool", "contact_lines"), ("pair", "section", "gap")
#: size of the small picture of a tile
SMALL = (400, 300)
#: tiles in a row
COLUMNS = 3


def scenes(gears: Gears, views: list[str], size: tuple[int, int]) -> Iterator[tuple[str, object]]:
    """Yield the scenes that a design has, with the name of the view and the member."""
    for view in views:
        for member in gears.members if view in MEMBER_VIEWS else (None,):
            try:
                yield f"{view} {member or ''}", gears.picture(view, member, size=size)._scene
            except (DesignError, NoSolutionError):
                continue


def main() -> None:
    from PIL import Image, ImageDraw

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sheet", type=Path)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--views", nargs="+", default=[*MEMBER_VIEWS, *COMMON_VIEWS], metavar="VIEW")
    parser.add_argument("--size", default="900x700", metavar="WxH")
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    tiles = []
    for name in options.names or sorted(path.stem for path in SAMPLES.glob("*.toml")):
        for what, scene in scenes(build(load(SAMPLES / f"{name}.toml")), options.views, (width, height)):
            tile = Image.new("RGB", (width + SMALL[0], height + 14), "white")
            tile.paste(Image.fromarray(render(scene)), (0, 14))
            tile.paste(Image.fromarray(render(scene, size=SMALL)), (width, 14))
            ImageDraw.Draw(tile).text((2, 1), f"{name}: {what}", fill="black")
            tiles.append(tile)
            print(f"{name}: {what}", flush=True)
    rows = -(-len(tiles) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * tiles[0].width, rows * tiles[0].height), "white")
    for k, tile in enumerate(tiles):
        sheet.paste(tile, (k % COLUMNS * tile.width, k // COLUMNS * tile.height))
    sheet.save(options.sheet)


if __name__ == "__main__":
    main()
