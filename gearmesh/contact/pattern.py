"""Contact pattern as people measure it on a tooth: ends and path, in shares of the flank's face and working height.

Shares are those of `FlankFrame.shares`: of the face from the toe, of the working height from the root limit. The pattern
is the area that the contact ellipses of all positions cover, or the contact lines. Its centre is the middle between its
ends, its length and width the distances of the ends.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.flank_frame import FlankFrame

#: corners of the polygon in the place of an ellipse; its ends are short by 0.2 % of the semi-axes
ELLIPSE_CORNERS = 48


def ellipse_ends(frame: FlankFrame, points: Array, axes: Array, inside: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return smallest and largest shares (..., 2) of contact ellipses, cut off at the edges of the flank.

    - `points` (..., P, 3): centres, own frame, mm
    - `axes` (..., P, 2, 3): semi-axes, own frame, mm
    - `inside` (..., P): True for the positions that count

    NaN where no position counts.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, ELLIPSE_CORNERS, endpoint=False)
    counts = inside & np.isfinite(axes).all(axis=(-2, -1))
    first, second = (frame.directions(points, axes[..., k, :])[..., None, :] for k in (0, 1))
    rim = frame.places(points)[..., None, :] + np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second
    corners = frame.shares(np.where(counts[..., None, None], rim, np.nan))
    low, high = _clipped(corners, np.roll(corners, -1, axis=-2))
    # an ellipse that covers the whole flank has no corner on it
    covers = counts & ~np.isfinite(low).any(axis=(-2, -1))
    low[covers], high[covers] = 0.0, 1.0
    return _ends(low, axis=(-3, -2), least=True), _ends(high, axis=(-3, -2), least=False)


def line_ends(frame: FlankFrame, lines: Sequence[Array]) -> tuple[Array, Array]:
    """Return smallest and largest shares (2,) of contact lines, each (K, 3) in the own frame."""
    shares = np.clip(frame.shares(frame.places(np.concatenate((np.full((1, 3), np.nan), *lines)))), 0.0, 1.0)
    return _ends(shares, axis=(0,), least=True), _ends(shares, axis=(0,), least=False)


def _clipped(start: Array, stop: Array) -> tuple[Array, Array]:
    """Return smallest and largest coordinates (..., 2) of segments inside the unit square; NaN for those outside."""
    way = stop - start
    with np.errstate(divide="ignore", invalid="ignore"):
        bounds = np.stack(((0.0 - start) / way, (1.0 - start) / way))
    still = way == 0.0
    within = (start >= 0.0) & (start <= 1.0)
    enter = np.where(still, np.where(within, 0.0, np.inf), bounds.min(axis=0)).max(axis=-1, initial=0.0)
    leave = np.where(still, np.where(within, 1.0, -np.inf), bounds.max(axis=0)).min(axis=-1, initial=1.0)
    seen = (enter <= leave)[..., None]
    ends = [np.clip(start + np.where(seen, part[..., None], np.nan) * way, 0.0, 1.0) for part in (enter, leave)]
    return np.minimum(*ends), np.maximum(*ends)


def _ends(values: Array, axis: tuple[int, ...], *, least: bool) -> Array:
    """Return the least or greatest known values over axes, NaN where none is known."""
    known = np.isfinite(values)
    end = np.where(known, values, np.inf).min(axis=axis) if least else np.where(known, values, -np.inf).max(axis=axis)
    return np.asarray(np.where(known.any(axis=axis), end, np.nan))
