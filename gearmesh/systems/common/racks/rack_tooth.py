"""The space of a rack cutter in the normal section: flanks, tip roundings, and what joins them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import Arc, Parabola, ProfilePieces, RackLine

#: distance (modules) from the tip plane of a rounding that touches it, before the last Newton step
TOUCHING = 1e-12


@dataclass(frozen=True)
class RackTipCorner:
    """What a cutter has at its root to cut the edge between flank and land.

    `form_point` (p, q): parameters of the flank and of this where what they generate meets; `end`: its own at the blank's tip.
    """

    profile: Profile
    form_point: tuple[float, float]
    end: float


@dataclass(frozen=True)
class RackTooth:
    """The right side of a rack cutter's space: flank and tip rounding in the normal section, and what joins them.

    `form_point` (p, q): parameters of flank and rounding where they pass into each other; `tip`: flank parameter near the
    blank's tip; `tip_height`, `root_height`: x of the blank's tip and of the cutter's tip plane, mm.

    `pieces`: what generates the fillet, where that is more than the rounding; what it and the flank generate then meets in an edge
    at the form point, and is not smooth over the knots. `tip_corner`: what cuts the tooth's tip, if anything does.
    """

    flank: Profile
    rounding: Arc
    form_point: tuple[float, float]
    tip: float
    tip_height: float
    root_height: float
    pieces: ProfilePieces | None = None
    tip_corner: RackTipCorner | None = None

    @property
    def root_profile(self) -> Profile:
        """What generates the fillet."""
        return self.rounding if self.pieces is None else self.pieces


class CutterTip(Protocol):
    """What a design says of the cutter's tip, in normal modules."""

    @property
    def dedendum(self) -> float: ...
    @property
    def tool_tip_radius(self) -> float: ...


@dataclass(frozen=True)
class Heights:
    """x of the blank's tip and of the cutter's tip plane, mm, in the normal section."""

    tip: float
    root: float


def round_tips(
    name: str, spec: CutterTip, module: float, flanks: tuple[RackLine | Parabola, RackLine | Parabola], heights: Heights
) -> tuple[RackTooth, RackTooth]:
    """Both sides, (right, left), of a space whose cutter has its tip rounded by `spec.tool_tip_radius` normal modules.

    Raises DesignError naming key, value and limit, with `name` before it: cutter's tooth pointed or too narrow for the
    rounding, no flank left, profile that bends back before tip or root.
    """
    _check_bend(name, flanks, heights)
    if not tip_land(flanks, np.zeros(1), heights.root, module)[0] >= 0.0:
        raise VagueError(
            f"{name}.dedendum", spec.dedendum, reason="the cutter's tooth is pointed", allowed="a smaller dedendum"
        )
    radius = spec.tool_tip_radius * module
    if not tip_land(flanks, np.array([radius]), heights.root, module)[0] >= -1e-12 * module:
        largest = largest_rounding(flanks, heights.root, module, radius)
        raise DesignError(
            f"{name}.tool_tip_radius",
            spec.tool_tip_radius,
            reason="the cutter's tooth is too narrow for the fillet",
            allowed=f"at most {math.floor(10000.0 * largest / module) / 10000.0:.4f}",
        )
    right, left = (_side(name, spec, flank, radius, heights, module) for flank in flanks)
    return right, left


def _check_bend(name: str, flanks: tuple[RackLine | Parabola, RackLine | Parabola], heights: Heights) -> None:
    """Refuse a parabola that bends back before the tip or the root, which is where c^2 = 4 a sin(alpha) x."""
    for flank in flanks:
        for x in (heights.tip, heights.root):
            if not np.isfinite(flank.at_height(x)):
                alpha = flank.line.alpha
                limit = np.cos(alpha) ** 2 / (4.0 * np.sin(alpha) * abs(x))
                raise DesignError(
                    f"{name}.parabola",
                    abs(flank.coefficient),
                    unit="1/mm",
                    reason="the profile bends back before the tip or the root",
                    allowed=f"less than {limit:.4g} 1/mm",
                )


def tip_land(
    flanks: tuple[RackLine | Parabola, RackLine | Parabola], radius: Array, root: float, module: float
) -> Array:
    """Land (M,), mm, of a cutter's tip at the height `root` between roundings of `radius` (M,), mm.

    < 0 where they overlap, NaN where one touches its flank nowhere.
    """
    right, left = (_touch(flank, radius, root, module)[1][:, 1] for flank in flanks)
    return np.pi * module + right + left


def largest_rounding(
    flanks: tuple[RackLine | Parabola, RackLine | Parabola], root: float, module: float, most: float
) -> float:
    """Largest rounding (mm) of a cutter's tip at the height `root`, up to `most`; 0 where the tip is pointed without one."""
    ends = np.zeros(1), np.array([most])
    if tip_land(flanks, ends[1], root, module)[0] >= 0.0:
        return most
    largest, _ = last_true(lambda r, _: tip_land(flanks, r, root, module) >= 0.0, *ends)
    return float(largest[0])


def _side(
    name: str, spec: CutterTip, flank: RackLine | Parabola, radius: float, heights: Heights, module: float
) -> RackTooth:
    (touch,), (centre,), (angle,) = _touch(flank, np.array([radius]), heights.root, module)
    if flank.section(np.array(touch))[0][0] >= heights.tip:
        raise VagueError(
            f"{name}.tool_tip_radius", spec.tool_tip_radius, reason="leaves no flank below the tip", allowed="less"
        )
    if flank.coefficient != 0.0 and flank.section(np.array(flank.at_height(heights.tip)))[2][0] <= 0.0:
        # its normals there pass the pitch point at no rotation; below the pitch plane undercut may cut that off
        raise VagueError(
            f"{name}.parabola",
            abs(flank.coefficient),
            unit="1/mm",
            reason="the pressure angle falls to 0 before the tip",
            allowed="less",
        )
    rounding = Arc((float(centre[0]), float(centre[1])), -radius)
    return RackTooth(
        flank, rounding, (float(touch), float(angle)), flank.at_height(heights.tip), heights.tip, heights.root
    )


def _touch(flank: RackLine | Parabola, radius: Array, root: float, module: float) -> tuple[Array, Array, Array]:
    """Flank parameters (M,) where circles of `radius` (M,) standing on the tip plane touch, centres (M, 2), normals' angles.

    NaN where there is no such circle.
    """

    def residual(p: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        point, tangent, normal, turned = flank.section(p[:, 0])
        r = radius[index]
        return (point[:, 0] + r * (normal[:, 0] - 1.0) - root)[:, None], (tangent[:, 0] + r * turned[:, 0])[
            :, None, None
        ]

    start = np.full((radius.size, 1), flank.at_height(root))
    solution = newton.solve(residual, start, tolerance=TOUCHING * module)
    p = np.where(solution.converged, solution.values[:, 0], np.nan)
    point, _, normal, _ = flank.section(p)
    return p, point + radius[:, None] * normal, np.arctan2(normal[:, 0], -normal[:, 1])
