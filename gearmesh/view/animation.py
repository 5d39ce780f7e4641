"""Files of animations: GIF by Pillow, MP4 by the program ffmpeg."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from gearmesh.errors import OutputError
from gearmesh.formats import GIF_SUFFIX, MP4_SUFFIX, refuse_suffix
from gearmesh.io.atomic import whole_file
from gearmesh.progress import in_turn
from gearmesh.view.offscreen.letters import Image
from gearmesh.view.palette import COMPOUND_COLOUR, INK_COLOUR, LINE_COLOUR, OUTLINE_COLOUR, PATH_COLOUR, rgb
from gearmesh.view.render import render
from gearmesh.view.scene import Scene

#: time for which each picture is shown
FRAME_TIME_MS = 70
#: time for which the last picture of an animation that does not go round is shown
LAST_TIME_MS = 1500
#: colours of a GIF
GIF_COLOURS = 160
#: colours among them, whatever their share of the pictures
NAMED_COLOURS = ("#ffffff", PATH_COLOUR, LINE_COLOUR, OUTLINE_COLOUR, COMPOUND_COLOUR, INK_COLOUR)
#: levels within which Pillow takes any of several colours: no others are there about the named ones
NAMED_COLOUR_REACH = 8
#: shortest MP4: players do not repeat it
MIN_FILM_MS = 6000
#: program that writes MP4 files
FILM_PROGRAM = "ffmpeg"


def refuse_file(file: Path) -> None:
    """Raise OutputError for a suffix that is not of animations, and for an MP4 without ffmpeg."""
    refuse_suffix(file, GIF_SUFFIX, MP4_SUFFIX)
    if file.suffix.lower() == MP4_SUFFIX and shutil.which(FILM_PROGRAM) is None:
        reason = f"the program {FILM_PROGRAM} is not installed; {GIF_SUFFIX} needs no program"
        raise OutputError("cannot write", file, reason=reason)


def write_animation(
    file: Path, scenes: Sequence[Scene], size: tuple[int, int] | None = None, hold: bool = False
) -> None:
    """Write scenes as an endless GIF, or as an MP4 that repeats them.

    `hold` shows the last picture for longer. Raises OutputError for another suffix, without ffmpeg for an MP4, and if
    OpenGL does not work.
    """
    refuse_file(file)
    images = [render(scene, size=size) for scene in in_turn(scenes)]
    times = [FRAME_TIME_MS] * len(images)
    if hold:
        times[-1] = LAST_TIME_MS
    with whole_file(file) as unfinished:
        if file.suffix.lower() == GIF_SUFFIX:
            _write_gif(Path(unfinished), images, times)
        else:
            _write_film(Path(unfinished), file, images, times)


def _write_gif(file: Path, images: Sequence[Image], times: list[int]) -> None:
    """Write a GIF whose pictures share one palette, so that nothing flickers."""
    from PIL import Image as pillow

    shown = pillow.fromarray(np.concatenate([images[k] for k in (0, len(images) // 2, -1)]))
    # thin lines have few pixels: their colours are named
    mixed = shown.quantize(GIF_COLOURS - len(NAMED_COLOURS), dither=pillow.Dither.NONE).getpalette() or []
    named = np.array([rgb(colour) for colour in NAMED_COLOURS])
    others_mixed = np.reshape(mixed[: 3 * (GIF_COLOURS - len(named))], (-1, 3))
    apart = np.abs(others_mixed[:, None] - named).max(axis=2).min(axis=1) >= NAMED_COLOUR_REACH
    palette = pillow.new("P", (1, 1))
    palette.putpalette(np.concatenate((named, others_mixed[apart])).ravel().tolist())
    first, *others = (pillow.fromarray(image).quantize(palette=palette, dither=pillow.Dither.NONE) for image in images)
    first.save(file, format="GIF", save_all=True, append_images=others, duration=times, loop=0)


def _write_film(unfinished: Path, file: Path, images: Sequence[Image], times: list[int]) -> None:
    """Write an MP4 by ffmpeg. Raises OutputError with its last line if it fails."""
    # frames of this encoding have even sides
    high, wide = (side - side % 2 for side in images[0].shape[:2])
    rate = f"1000/{FRAME_TIME_MS}"
    taken = ("-y", "-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{wide}x{high}", "-r", rate, "-i", "-")
    made = ("-c:v", "libx264", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4", str(unfinished))
    pixels = b"".join(_film(images, times, (high, wide)))
    ended = subprocess.run((FILM_PROGRAM, *taken, *made), input=pixels, capture_output=True, check=False)
    if ended.returncode:
        said = ended.stderr.decode(errors="replace").strip().splitlines() or [f"exit code {ended.returncode}"]
        raise OutputError("cannot write", file, reason=f"{FILM_PROGRAM}: {said[-1]}")


def _film(images: Sequence[Image], times: list[int], shape: tuple[int, int]) -> Iterator[bytes]:
    """Yield the pixels of a film of a `shape`, repeated until it is long enough."""
    for _ in range(-(-MIN_FILM_MS // sum(times))):
        for image, time in zip(images, times, strict=True):
            pixels = np.ascontiguousarray(image[: shape[0], : shape[1]]).tobytes()
            yield from [pixels] * round(time / FRAME_TIME_MS)
