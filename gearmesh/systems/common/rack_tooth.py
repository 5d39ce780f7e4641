"""The space of a rack cutter in the normal section: flanks, tip roundings, and what joins them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.tools.rack import Arc, Line, Parabola, Profile

#: Newton steps to the point where a rounding touches the flank, one for a straight flank
TOUCHING = 30


@dataclass(frozen=True)
class RackTooth:
    """The right side of a rack cutter's space: flank and tip rounding in the normal section, and what joins them.

    `joint` (p, q): parameters of flank and rounding where they pass into each other; `tip`: flank parameter near the
    blank's tip; `tip_height`, `root_height`: x of the blank's tip and of the cutter's tip plane, mm.
    """

    flank: Profile
    rounding: Arc
    joint: tuple[float, float]
    tip: float
    tip_height: float
    root_height: float


@dataclass(frozen=True)
class Heights:
    """x of the blank's tip and of the cutter's tip plane, mm, in the normal section."""

    tip: float
    root: float


def rounded(
    name: str, spec: Any, module: float, flanks: tuple[Line | Parabola, Line | Parabola], heights: Heights
) -> tuple[RackTooth, RackTooth]:
    """Both sides, (right, left), of a space whose cutter has its tip rounded by `spec.tool_tip_radius` normal modules.

    Raises DesignError naming key, value and limit, with `name` before it: cutter's tooth pointed or too narrow for the
    rounding, no flank left, profile that bends back before tip or root.
    """
    for flank in flanks:
        if not np.isfinite([flank.at_height(x) for x in (heights.tip, heights.root)]).all():
            raise DesignError(f"{name}.parabola: the profile bends back before the tip or the root; allowed is less")
    pitch = np.pi * module

    def between(radius: float) -> float:
        """Land of the cutter's tip between the roundings, mm; < 0 where they overlap."""
        return pitch + sum(float(_touch(flank, radius, heights.root)[1][1]) for flank in flanks)

    if between(0.0) < 0.0:
        raise DesignError(
            f"{name}.dedendum = {spec.dedendum:g}: the cutter's tooth is pointed; allowed is a smaller dedendum"
        )
    radius = spec.tool_tip_radius * module
    if between(radius) < -1e-12 * module:
        raise DesignError(
            f"{name}.tool_tip_radius = {spec.tool_tip_radius:g}: the fillet cannot exist, the cutter's tooth is too narrow; "
            f"allowed is at most {_largest(between, radius) / module:.4f}"
        )
    right, left = (_side(name, spec, flank, radius, heights) for flank in flanks)
    return right, left


def _side(name: str, spec: Any, flank: Line | Parabola, radius: float, heights: Heights) -> RackTooth:
    touch, centre, angle = _touch(flank, radius, heights.root)
    if flank.section(np.array(touch))[0][0] >= heights.tip:
        raise DesignError(
            f"{name}.tool_tip_radius = {spec.tool_tip_radius:g}: leaves no flank below the tip; allowed is less"
        )
    rounding = Arc((float(centre[0]), float(centre[1])), -radius)
    return RackTooth(flank, rounding, (touch, angle), flank.at_height(heights.tip), heights.tip, heights.root)


def _touch(flank: Line | Parabola, radius: float, root: float) -> tuple[float, Any, float]:
    """Flank parameter where a circle of `radius` standing on the tip plane touches, its centre (2,), the normal's angle."""
    p = flank.at_height(root)
    for _ in range(TOUCHING):
        point, tangent, normal, turned = flank.section(np.array(p))
        step = (point[0] + radius * (normal[0] - 1.0) - root) / (tangent[0] + radius * turned[0])
        if abs(step) <= 1e-15 * (1.0 + abs(p)):
            break
        p = float(p - step)
    point, _, normal, _ = flank.section(np.array(p))
    return p, point + radius * normal, float(np.arctan2(normal[0], -normal[1]))


def _largest(between: Any, radius: float) -> float:
    """Largest radius (mm) below `radius` that leaves a land, by bisection."""
    low, high = 0.0, radius
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if between(middle) >= 0.0 else (low, middle)
    return low
