"""Second-order deviations of a flank: thickness, and the five figures by which a bevel gear is corrected.

They are the coefficients, by least squares, of

    d = a + a_x x + a_y y + a_xx x^2 + a_xy x y + a_yy y^2

x is the distance along the flank from the middle of the measured grid to the heel, y to the tip, mm. d is measured
along the normal, positive outside of the nominal material. Every figure is the excess over nominal.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.errors import ArgumentError
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: number of coefficients
TERM_COUNT = 6
#: sine of the spiral angle below which teeth count as straight
MIN_SPIRAL_SINE = 1e-3


@dataclass(frozen=True)
class SecondOrder:
    """Deviations of a flank to second order, over the extent of the measured grid."""

    #: deviation in the middle, mm, along the normal
    thickness: float
    #: error of the profile angle, rad; positive if the pressure angle is larger, so that material falls to the tip
    profile_angle: float
    #: lengthwise angle, rad; positive if material rises to the heel
    lengthwise_angle: float
    #: profile crowning, mm; positive if the middle is higher than the ends
    profile_crowning: float
    #: lengthwise crowning, mm; positive if the middle is higher than the ends
    length_crowning: float
    #: rise to the tip at the heel minus rise to the tip at the toe, mm
    twist: float
    #: root mean square of the deviations of higher order, mm
    rest: float
    #: largest amount of the deviations of higher order, mm
    largest: float


def second_order(length: ArrayLike, height: ArrayLike, deviations: ArrayLike) -> SecondOrder:
    """Fit deviations (...,), mm, at lengths to the heel and heights to the tip (...,), mm.

    Lengths and heights run along the flank from any origin. Values that are not finite are ignored. Raises DesignError
    if the points do not determine the six terms.
    """
    x, y, d = (np.ravel(np.asarray(values, dtype=float)) for values in (length, height, deviations))
    is_known = np.isfinite(d)
    x, y, d = x[is_known], y[is_known], d[is_known]
    if not d.size:
        raise _too_few_points(0)
    (x, half_x), (y, half_y) = _to_middle(x), _to_middle(y)
    terms = np.stack((np.ones_like(x), x, y, x * x, x * y, y * y), axis=-1)
    coefficients, _, rank, _ = np.linalg.lstsq(terms, d, rcond=None)
    if rank < TERM_COUNT:
        raise _too_few_points(d.size)
    a, a_x, a_y, a_xx, a_xy, a_yy = coefficients.tolist()
    residuals = d - terms @ coefficients
    return SecondOrder(
        thickness=a,
        profile_angle=-float(np.arctan(a_y / half_y)),
        lengthwise_angle=float(np.arctan(a_x / half_x)),
        profile_crowning=-a_yy,
        length_crowning=-a_xx,
        twist=4.0 * a_xy,
        rest=float(np.sqrt(np.mean(residuals**2))),
        largest=float(np.abs(residuals).max()),
    )


def flank_coordinates(points: Array) -> tuple[Array, Array]:
    """Return lengths to the heel and heights to the tip (I, J), mm, of a grid of points (I, J, 3) on a flank.

    The grid runs from root to tip and from toe to heel; distances are measured along its lines, from their middles.
    """
    length, height = (_way(np.moveaxis(points, axis, 0)) for axis in (1, 0))
    return np.moveaxis(length, 0, 1), height


def spiral_angle_error(points: Array, normals: Array, lengthwise_angle: float, joint: Joint) -> float:
    """Return the error (rad) of the amount of the spiral or helix angle, at the middle of the flank.

    - `points`, `normals` (I, J, 3), mm: points and outward normals of a flank, 3 x 3 or more.
    - `lengthwise_angle`: rise of material to the heel, rad.
    - `joint`: joint of the member.

    A deviation d moves the trace of the flank in the pitch surface by d / (n . e), where e is at right angles to the
    trace in that surface. For straight teeth the error is positive if the heel leans in the direction of increasing
    angle about the axis.
    """
    i, j = (size // 2 for size in points.shape[:2])
    circumferential = joint.angle_gradient(points[i, j])
    circumferential = circumferential / np.linalg.norm(circumferential)
    trace = points[i, j + 1] - points[i, j - 1]
    trace = trace / np.linalg.norm(trace)
    lean = float(trace @ circumferential)
    across = circumferential - lean * trace
    hand = 1.0 if abs(lean) < MIN_SPIRAL_SINE else float(np.sign(lean))
    return float(hand * lengthwise_angle * np.linalg.norm(across) / (normals[i, j] @ across))


def _way(points: Array) -> Array:
    """Return distances (K, M), mm, along lines of points (K, M, 3), from the middle of each line."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=-1)
    distance = np.concatenate((np.zeros_like(steps[:1]), np.cumsum(steps, axis=0)))
    return np.asarray(distance - 0.5 * distance[-1])


def _to_middle(values: Array) -> tuple[Array, float]:
    """Return values scaled to -1 .. 1 over their extent, and half of this extent."""
    half = 0.5 * float(np.ptp(values))
    return (values - values.min()) / (half or 1.0) - 1.0, half or 1.0


def _too_few_points(count: int) -> ArgumentError:
    return ArgumentError(
        "deviations",
        count,
        reason="so many points do not determine slopes, crownings and twist",
        allowed="3 x 3 or more",
    )
