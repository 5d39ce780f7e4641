"""Result of a tooth contact analysis as arrays over the positions, for exports, pictures and checks."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.pair import PART_PAIRS
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass


@dataclass(frozen=True)
class ContactPath:
    """Contact of one tooth pair at P positions; values are NaN at positions without contact."""

    #: rotations (P,) of the pinion as the source counts them (in [LT85] the generation angle), rad
    phi1: Array
    #: rotations (P,) of the pinion, rad; equal to `phi1` in most systems
    rotation: Array
    #: rotations (P,) of the gear, rad
    phi2: Array
    #: transmission error (P,) relative to phi1 = 0, rad
    te: Array
    #: kind (P,) of contact: "point", "line", "edge" or "none"
    kind: NDArray[np.str_]
    #: edge (P,) in contact ("pinion_tip", "gear_heel"), two joined by "+" where edges cross, "" without edge contact
    edge: NDArray[np.str_]
    #: codes (P,) of `errors.Status`
    status: NDArray[np.int64]
    #: distance (P,) between the points of both flanks, mm
    residual: Array
    #: points (P, 3) of contact, fixed frame, mm
    point: Array
    #: unit normals (P, 3) out of the pinion, fixed frame
    normal: Array
    #: points (P, 3) of contact in the pinion's frame, mm
    point1: Array
    #: points (P, 3) of contact in the gear's frame, mm
    point2: Array
    #: surface parameters (P, 2) of the pinion's surface in contact
    params1: Array
    #: surface parameters (P, 2) of the gear's surface in contact
    params2: Array
    #: semi-major axis (P,) of the contact ellipse, mm, NaN for edges and lines
    semi_major: Array
    #: semi-minor axis (P,) of the contact ellipse, mm, NaN for edges and lines
    semi_minor: Array
    #: angle (P,) from the pinion's first parameter line to the major axis, rad, NaN for edges and lines
    angle: Array
    #: unit vectors (P, 3) along the major axis, fixed frame
    major: Array
    #: unit vectors (P, 3) along the minor axis, fixed frame
    minor: Array
    #: for every position None or points (K, 3) of the contact line, fixed frame, mm, NaN between its pieces
    lines: tuple[Array | None, ...]
    #: time of the solution, s
    seconds: float
    #: parts (P,) in contact, numbers in `pair.PARTS`, 0 on the flanks
    part: NDArray[np.intp]

    def part_of(self, which: slice) -> ContactPath:
        """Return the path at some of its positions."""
        values: dict[str, Any] = {"lines": self.lines[which]}
        for field in fields(self):
            own = getattr(self, field.name)
            if isinstance(own, np.ndarray):
                values[field.name] = own[which]
        return replace(self, **values)

    def without(self, nothing: ContactPath, which: NDArray[np.bool_]) -> ContactPath:
        """Return the path with the values of another path at some positions.

        `nothing`: path with as many positions; its rotations are ignored. `which`: positions with the values of
        `nothing`.
        """
        values: dict[str, Any] = {
            "lines": tuple(None if off else line for line, off in zip(self.lines, which, strict=True))
        }
        for field in fields(self):
            own = getattr(self, field.name)
            if isinstance(own, np.ndarray) and field.name != "rotation":
                values[field.name] = np.where(
                    which if own.ndim == 1 else which[:, None], getattr(nothing, field.name), own
                )
        return replace(self, **values)

    @property
    def regions(self) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
        """Regions (P,) of pinion and gear in contact: "flank", "fillet" or "tip_edge"; "" without contact."""
        first, second = np.array(PART_PAIRS)[self.part].T
        return np.where(self.touching, first, ""), np.where(self.touching, second, "")

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Positions with contact of any kind."""
        in_contact: NDArray[np.bool_] = self.kind != "none"
        return in_contact
