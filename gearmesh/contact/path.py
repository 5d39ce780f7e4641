"""The result of a tooth contact analysis, as arrays over the positions; what exports, pictures and checks read."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.pair import PARTS
from gearmesh.kernel.numeric.algebra import Array


@dataclass(frozen=True)
class ContactPath:
    """Contact of one tooth pair at P positions; NaN where there is none (`kind` "none").

    phi1 (P,) as the source counts it (for [LT85] the generation angle) and `rotation` (P,) of the pinion, the same in
    most systems; phi2 (P,) rotation of the gear; rad; te (P,) transmission error in rad, relative to
    phi1 = 0; kind (P,) one of "point", "line", "edge", "none"; edge (P,) which edge took over ("pinion_tip",
    "gear_heel", two joined by "+" where edges cross, "" otherwise); status (P,) `errors.Status` codes;
    residual (P,) largest residual of r1 = r2 in mm; point, normal (P, 3) in the fixed frame (normal out of the
    pinion); point1, point2 (P, 3) in the members' own frames; params1, params2 (P, 2) surface parameters;
    semi_major, semi_minor (P,) semi-axes of the contact ellipse in mm and angle (P,) from the pinion's first
    parameter line to the major axis, rad (NaN for edges and lines); major, minor (P, 3) unit vectors along them, fixed frame;
    part (P,): what touches, a number in `pair.PARTS`, 0 on the flanks; parameters are those of the surfaces that touch;
    lines: for every position None or (K, 3) points of the contact line, fixed frame, mm, NaN between its pieces.
    """

    phi1: Array
    rotation: Array
    phi2: Array
    te: Array
    kind: NDArray[np.str_]
    edge: NDArray[np.str_]
    status: NDArray[np.int64]
    residual: Array
    point: Array
    normal: Array
    point1: Array
    point2: Array
    params1: Array
    params2: Array
    semi_major: Array
    semi_minor: Array
    angle: Array
    major: Array
    minor: Array
    lines: tuple[Array | None, ...]
    seconds: float
    part: NDArray[np.intp]

    def without(self, nothing: ContactPath, which: NDArray[np.bool_]) -> ContactPath:
        """The path with another one's values at some of its positions.

        Parameters
        ----------
        nothing : ContactPath
            Of as many positions; its rotations do not count.
        which : (P,) of bool
            Positions that are taken from it.

        Returns
        -------
        ContactPath

        Examples
        --------
        >>> path = gears.contact([-5.0, 0.0, 5.0]).path
        >>> other = gears.contact([-6.0, 1.0, 6.0]).path
        >>> mixed = path.without(other, np.array([True, False, False]))
        >>> (mixed.phi2 == other.phi2).tolist(), (mixed.phi2 == path.phi2).tolist()
        ([True, False, False], [False, True, True])
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
        """What of pinion and gear touches (P,): "flank", "fillet" or "tip_edge"; "" where nothing does."""
        first, second = np.array(PARTS)[self.part].T
        return np.where(self.touching, first, ""), np.where(self.touching, second, "")

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Positions with contact of any kind."""
        in_contact: NDArray[np.bool_] = self.kind != "none"
        return in_contact
