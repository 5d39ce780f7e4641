"""Drawn pixels become a picture: sections are hatched, hollows receive less light, drawn pixels are averaged.

The depth of a pixel is compared with the depths around it. Tooth spaces, fillets and bodies behind others become
darker; flat and raised parts stay as they are. Lines and areas on a body keep their colours, and so does a section.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.view.offscreen.drawing_process import Order
from gearmesh.view.offscreen.letters import Image
from gearmesh.view.offscreen.shapes import section_colours
from gearmesh.view.palette import rgb
from gearmesh.view.scene import Camera, Scene

#: distance of the lines of a hatching, as a share of the picture's height
HATCH_SPACING_SHARE = 0.034
#: width of these lines as a share of their distance
HATCH_WIDTH_SHARE = 0.09
#: brightness of these lines relative to the section
HATCH_BRIGHTNESS = 0.82
#: distances at which a pixel is compared with others, ascending, as shares of the picture's height
RADII_SHARES = (0.008, 0.022, 0.05)
#: pairs of opposite directions at each distance
DIRECTIONS_PER_RADIUS = 4
#: share of the light that a deep hollow loses
LOST_LIGHT_SHARE = 0.55
#: rows of a picture whose drawn pixels are averaged at once: these stay in a processor's cache
HALVED_ROWS_AT_ONCE = 32
#: two parts of a pixel of four
TWO_PARTS = np.uint32(0x00FF00FF)
#: difference between the brightest and the darkest part of a colour from which it is not steel
MIN_COLOURED_RANGE = 40


def finish(scene: Scene, order: Order, drawn: bytearray, size: tuple[int, int]) -> Image:
    """Return the picture (H, W, 3) of a `size`, in pixels, that an order drew; hatching changes the drawn pixels."""
    from PIL import Image as pillow

    wide, high = order["size"]
    pixels = np.frombuffer(drawn, dtype=np.uint32, count=wide * high).reshape(high, wide)
    sections = section_colours(scene)
    light = _light(scene.camera, order, drawn, pixels, sections)
    _hatch(pixels, sections)
    # RGBX tells Pillow to ignore the transparency
    image = pillow.frombuffer("RGBX", size, _halved(pixels), "raw", "RGBX", 0, -1).convert("RGB")
    if light is not None:
        share = pillow.fromarray(np.rint(255.0 * light[::-1]).astype(np.uint8))
        image = _lit(image, share.resize(size, pillow.Resampling.BILINEAR), scene)
    return np.asarray(image)


def _halved(pixels: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Return pixels (H, W) of a picture drawn with twice as many (2 H, 2 W): means, weighted by distance, of four by four.

    Weights are 1, 3, 3 and 1 of 8 either way. Two parts of a pixel at a time have 16 bits each, which hold their sums;
    this takes a third of the time of Pillow's `resize`.
    """
    high, wide = pixels.shape[0] // 2, pixels.shape[1] // 2
    means = np.empty((high, wide), dtype=np.uint32)
    for top in range(0, high, HALVED_ROWS_AT_ONCE):
        part = means[top : top + HALVED_ROWS_AT_ONCE]
        rows = np.clip(np.arange(2 * top - 1, 2 * (top + len(part)) + 1), 0, len(pixels) - 1)
        drawn = np.pad(pixels[rows[0] : rows[-1] + 1], ((0, 0), (1, 1)), mode="edge")
        if len(drawn) < len(rows):
            drawn = drawn[rows - rows[0]]
        for shift in np.array((0, 8), dtype=np.uint32):
            sums = drawn >> shift & TWO_PARTS
            for _ in range(2):
                beside = sums[1:-2:2] + sums[2:-1:2]
                beside *= np.uint32(3)
                beside += sums[:-3:2]
                beside += sums[3::2]
                sums = beside.T
            # rounded quotient of 64
            sums += np.uint32(0x00200020)
            sums >>= np.uint32(6)
            sums &= TWO_PARTS
            if shift:
                part |= sums << shift
            else:
                part[:] = sums
    return means


def _lit(image: Any, share: Any, scene: Scene) -> Any:
    """Return Pillow's picture in a share (of 255) of its light; white, and colours that tell quantities, keep all.

    Pillow takes a tenth of numpy's time for parts of one byte.
    """
    from PIL import Image as pillow
    from PIL.ImageChops import darker, lighter, multiply, subtract

    red, green, blue = image.split()
    darkest = darker(darker(red, green), blue)
    full = lighter(share, darkest.point([0] * 255 + [255]))
    if scene.maps or scene.areas or scene.curves or scene.dots:
        colourful = subtract(lighter(lighter(red, green), blue), darkest)
        full = lighter(full, colourful.point([255 * (part > MIN_COLOURED_RANGE) for part in range(256)]))
    return multiply(image, pillow.merge("RGB", (full, full, full)))


def _words(colours: Sequence[str], brightness: float = 1.0) -> NDArray[np.uint32]:
    """Return opaque pixels (C,) of colours."""
    parts = [[*(round(brightness * part) for part in rgb(colour)), 255] for colour in colours]
    return np.array(parts, dtype=np.uint8).view(np.uint32)[:, 0]


def _hatch(pixels: NDArray[np.uint32], sections: Sequence[str]) -> None:
    """Hatch the colours of sections in pixels (H, W).

    The lines of different colours lean to different sides, as on drawings.
    """
    if not sections:
        return
    high, wide = pixels.shape
    period = HATCH_SPACING_SHARE * high
    # places along the lean of the lines, from the last row of the picture on
    inked = np.arange(1 - high, wide + high - 1) % period < HATCH_WIDTH_SHARE * period
    colours = list(zip(_words(sections), _words(sections, HATCH_BRIGHTNESS), strict=True))
    for row, line in enumerate(pixels):
        before = line.copy() if len(colours) > 1 else line
        for k, (plain, dark) in enumerate(colours):
            first = high - 1 - (-1) ** k * row
            line[inked[first : first + wide] & (before == plain)] = dark


def _light(
    camera: Camera, order: Order, drawn: bytearray, pixels: NDArray[np.uint32], sections: Sequence[str]
) -> NDArray[np.float32] | None:
    """Return the share of light (h, w) at every `depth_step`-th pixel, rows from below; None without depths."""
    step = order["depth_step"]
    if not step:
        return None
    thinned = pixels[::step, ::step]
    values = np.frombuffer(drawn, dtype=np.float32, offset=4 * pixels.size)
    share, (near, far) = values[:-2].reshape(thinned.shape), values[-2:]
    pixel = step * camera.height / len(pixels)
    seen = share < 1.0
    depth = near + (far - near) * share
    cut = np.isin(thinned, _words(sections)) if sections else None
    if cut is not None and cut.any():
        depth[cut] = _plane_depth(camera, thinned.shape, pixel)[cut]
    return _hollow_light(depth, seen, pixel)


def _plane_depth(camera: Camera, shape: tuple[int, ...], pixel: float) -> NDArray[np.float32]:
    """Return the depth (h, w), mm, of the front plane at pixels of this length (mm)."""
    assert camera.front is not None
    right, up, back = camera.axes @ (camera.axes[2] if camera.front_normal is None else camera.front_normal)
    y, x = (pixel * (np.arange(count) + 0.5 - 0.5 * count) for count in shape)
    towards = (camera.front - right * x - up * y[:, None]) / back
    return np.asarray(camera.distance - towards, dtype=np.float32)


def _hollow_light(depth: NDArray[np.float32], seen: NDArray[np.bool_], pixel: float) -> NDArray[np.float32]:
    """Return the share of light (h, w) of pixels with this depth and length (mm), where a body is `seen` (h, w).

    A pixel is compared with two opposite pixels at a time, so that a slope is no hollow. Pairs that reach beyond the
    picture are left out.
    """
    if not seen.any():
        return np.ones(depth.shape, dtype=np.float32)
    around = np.where(seen, depth, np.float32(np.inf))
    high, long = depth.shape
    dark, pairs = np.zeros(depth.shape, dtype=np.float32), np.zeros(depth.shape, dtype=np.float32)
    own = np.where(seen, depth, np.float32(0.0))
    for k, share in enumerate(RADII_SHARES):
        radius = share * len(depth)
        unit = np.float32(1.0 / (max(radius, 1.0) * pixel))
        for turn in np.pi * (np.arange(DIRECTIONS_PER_RADIUS) + k / len(RADII_SHARES)) / DIRECTIONS_PER_RADIUS:
            right, up = round(radius * np.cos(turn)), round(radius * np.sin(turn))
            rows, columns = slice(abs(up), high - abs(up)), slice(abs(right), long - abs(right))
            here = own[rows, columns]
            nearer = np.zeros_like(here)
            for sense in (1, -1):
                first, left = abs(up) + sense * up, abs(right) + sense * right
                there = around[first : first + len(here), left : left + long - 2 * abs(right)]
                nearer += np.clip((here - there) * unit, -1.0, 1.0)
            dark[rows, columns] += np.maximum(nearer, 0.0)
            pairs[rows, columns] += 1.0
    light = 1.0 - LOST_LIGHT_SHARE * np.minimum(dark / np.maximum(pairs, 1.0), 1.0)
    # a pixel without a body takes the light beside it, which the average over its edge needs
    weight = _mean(seen.astype(np.float32))
    beside = _mean(np.where(seen, light, np.float32(0.0))) / np.maximum(weight, np.float32(1e-3))
    return np.where(weight > 0.0, beside, np.float32(1.0))


def _mean(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the mean of values (h, w) over squares of three by three pixels, taken twice; beyond the edges there is 0."""
    for _ in range(4):
        padded = np.pad(values, ((1, 1), (0, 0)))
        values = ((padded[:-2] + padded[1:-1] + padded[2:]) / np.float32(3.0)).T
    return values
