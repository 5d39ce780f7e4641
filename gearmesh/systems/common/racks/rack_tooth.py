"""The space of a rack cutter in the normal section: flanks, tip roundings, and their points of tangency."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import Arc, Parabola, ProfilePieces, RackLine

#: distance of a touching rounding from the tip plane, before the last Newton step
TANGENCY_TOLERANCE_MODULES = 1e-12


@dataclass(frozen=True)
class RackTipCorner:
    """Profile at a cutter's root that cuts the edge between flank and land.

    - form_point (p, q): parameters of the flank and of this profile at the point where their surfaces meet.
    - end: parameter of this profile at the blank's tip.
    """

    profile: Profile
    form_point: tuple[float, float]
    end: float


@dataclass(frozen=True)
class RackTooth:
    """The right side of a rack cutter's space: flank and tip rounding in the normal section."""

    #: profile of the flank
    flank: Profile
    #: tip rounding
    rounding: Arc
    #: parameters (p, q) of flank and rounding at their point of tangency
    form_point: tuple[float, float]
    #: flank parameter near the blank's tip
    tip: float
    #: x of the blank's tip, mm
    tip_height: float
    #: x of the cutter's tip plane, mm
    root_height: float
    #: profiles of the fillet if it is more than the rounding; it meets the flank in an edge and has edges at knots
    pieces: ProfilePieces | None = None
    #: profile that cuts the tooth's tip, if any
    tip_corner: RackTipCorner | None = None

    @property
    def root_profile(self) -> Profile:
        """Profile that generates the fillet."""
        return self.rounding if self.pieces is None else self.pieces


class CutterTip(Protocol):
    """Tip of the cutter, in normal modules, as a design gives it."""

    @property
    def dedendum(self) -> float: ...
    @property
    def tool_tip_radius(self) -> float: ...


class SidedTip(Protocol):
    """Roundings of a tool's tip on drive and coast side, in normal modules, as a design gives them."""

    @property
    def tool_tip_radius(self) -> float: ...
    @property
    def coast_tool_tip_radius(self) -> float | None: ...


@dataclass(frozen=True)
class TipRounding:
    """Rounding of a tool's tip on one side of the teeth, in normal modules, and the key of a member that gives it."""

    key: str
    modules: float


def tip_rounding(spec: SidedTip, *, coast: bool) -> TipRounding:
    """Return the rounding of the drive side or the coast side: that of the drive side if the design gives no other."""
    own = spec.coast_tool_tip_radius if coast else None
    if own is None:
        return TipRounding("tool_tip_radius", spec.tool_tip_radius)
    return TipRounding("coast_tool_tip_radius", own)


def tip_roundings(spec: SidedTip, coast: Side) -> tuple[TipRounding, TipRounding]:
    """Return the roundings of the right and the left flanks; `coast`: flanks of the coast side."""
    right, left = (tip_rounding(spec, coast=side is coast) for side in (Side.RIGHT, Side.LEFT))
    return right, left


@dataclass(frozen=True)
class Heights:
    """Heights x of the blank's tip and of the cutter's tip plane, mm, in the normal section."""

    tip: float
    root: float


def round_tips(
    name: str,
    spec: CutterTip,
    module: float,
    flanks: tuple[RackLine | Parabola, RackLine | Parabola],
    heights: Heights,
    roundings: tuple[TipRounding, TipRounding] | None = None,
) -> tuple[RackTooth, RackTooth]:
    """Return both sides, (right, left), of a space whose cutter has a rounded tip.

    `roundings`: of the right and the left side; without them the radius is `spec.tool_tip_radius` normal modules.
    Raises DesignError naming key, value and limit, with `name` before it. Reasons are a cutter's tooth that is pointed
    or too narrow for the roundings, no flank left, and a profile that bends back before tip or root.
    """
    _check_bend(name, flanks, heights)
    land = float(tip_land(flanks, (np.zeros(1), np.zeros(1)), heights.root, module)[0])
    if not land >= 0.0:
        raise VagueError(
            f"{name}.dedendum",
            spec.dedendum,
            reason="the cutter's tooth is pointed",
            allowed="a smaller dedendum",
            excess=-land,
        )
    both = roundings or (TipRounding("tool_tip_radius", spec.tool_tip_radius),) * 2
    radii = np.array([both[0].modules]) * module, np.array([both[1].modules]) * module
    if not tip_land(flanks, radii, heights.root, module)[0] >= -1e-12 * module:
        # the larger rounding is refused; a rounding with a key of its own stays
        wide = max((0, 1), key=lambda k: both[k].modules)
        fixed = None if both[0].key == both[1].key else float(radii[1 - wide][0])
        largest = largest_rounding((flanks[wide], flanks[1 - wide]), heights.root, module, float(radii[wide][0]), fixed)
        raise DesignError(
            f"{name}.{both[wide].key}",
            both[wide].modules,
            reason="the cutter's tooth is too narrow for the fillet",
            allowed=Allowed.at_most(np.floor(10000.0 * largest / module) / 10000.0),
        )
    right, left = (_side(name, rounding, flank, heights, module) for rounding, flank in zip(both, flanks, strict=True))
    return right, left


def _check_bend(name: str, flanks: tuple[RackLine | Parabola, RackLine | Parabola], heights: Heights) -> None:
    """Refuse a parabola that bends back before the tip or the root, which is where c^2 = 4 a sin(alpha) x, x from its vertex."""
    for flank in flanks:
        for x in (heights.tip, heights.root):
            if not np.isfinite(flank.at_height(x)):
                limit = flank.bend_limit(x)
                # heights that are derived change with the coefficient, and its limit with them
                raise VagueError(
                    f"{name}.parabola",
                    abs(flank.coefficient),
                    unit="1/mm",
                    reason="the profile bends back before the tip or the root",
                    allowed=Allowed.less_than(limit, "1/mm"),
                )


def tip_land(
    flanks: tuple[RackLine | Parabola, RackLine | Parabola], radii: tuple[Array, Array], root: float, module: float
) -> Array:
    """Return the land (M,), mm, of a cutter's tip at the height `root` between roundings of `radii` (M,), mm.

    It is negative where the roundings overlap, and NaN where a rounding does not touch its flank.
    """
    right, left = (_touch(flank, radius, root, module)[1][:, 1] for flank, radius in zip(flanks, radii, strict=True))
    return np.pi * module + right + left


def largest_rounding(
    flanks: tuple[RackLine | Parabola, RackLine | Parabola],
    root: float,
    module: float,
    most: float,
    fixed: float | None = None,
) -> float:
    """Return the largest rounding (mm) of a cutter's tip at the height `root`, up to `most`.

    `fixed`: rounding (mm) of the second flank, if only that of the first one is searched. The result is 0 if the tip is
    pointed without a rounding.
    """
    ends = np.zeros(1), np.array([most])

    def land(radius: Array) -> Array:
        return tip_land(flanks, (radius, radius if fixed is None else np.full_like(radius, fixed)), root, module)

    if land(ends[1])[0] >= 0.0:
        return most
    largest, _ = last_true(lambda r, _: land(r) >= 0.0, *ends)
    return float(largest[0])


def _side(name: str, rounded: TipRounding, flank: RackLine | Parabola, heights: Heights, module: float) -> RackTooth:
    """Return one side of the space."""
    radius = rounded.modules * module
    (touch,), (centre,), (angle,) = _touch(flank, np.array([radius]), heights.root, module)
    if flank.section(np.array(touch))[0][0] >= heights.tip:
        raise VagueError(
            f"{name}.{rounded.key}", rounded.modules, reason="leaves no flank below the tip", allowed="less"
        )
    if flank.coefficient != 0.0 and flank.section(np.array(flank.at_height(heights.tip)))[2][0] <= 0.0:
        # such normals never pass through the pitch point; below the pitch plane undercut may remove these points
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
    """Return flank parameters (M,), centres (M, 2) and angles (M,) of the normals of touching circles.

    The circles of `radius` (M,) touch the tip plane and the flank. NaN where there is no such circle.
    """

    def residual(p: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        point, tangent, normal, turned = flank.section(p[:, 0])
        r = radius[index]
        return (point[:, 0] + r * (normal[:, 0] - 1.0) - root)[:, None], (tangent[:, 0] + r * turned[:, 0])[
            :, None, None
        ]

    start = np.full((radius.size, 1), flank.at_height(root))
    solution = newton.solve(residual, start, tolerance=TANGENCY_TOLERANCE_MODULES * module)
    p = np.where(solution.converged, solution.values[:, 0], np.nan)
    point, _, normal, _ = flank.section(p)
    return p, point + radius[:, None] * normal, np.arctan2(normal[:, 0], -normal[:, 1])
