"""A flank's deviations by the five figures that a bevel gear is corrected by, and its thickness: least squares of

    d = a + a_x x + a_y y + a_xx x^2 + a_xy x y + a_yy y^2

x from the middle of the measured grid to the heel, y to the tip, mm along the flank; d along the normal, positive outside of the
nominal material. Every figure is what the teeth have more than nominal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.errors import ArgumentError
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array

#: coefficients
TERMS = 6
#: sine of the spiral angle (rad) of teeth that count as straight
STRAIGHT = 1e-3


@dataclass(frozen=True)
class SecondOrder:
    """Deviations of a flank to second order: angles in rad, all else in mm, over the extent of the grid that was measured.

    `thickness`: along the normal, in the middle; `profile_angle`: positive where the pressure angle is larger, so that material
    falls to the tip; `lengthwise_angle`: positive where material rises to the heel; `profile_crowning`, `length_crowning`:
    positive where the middle is higher than the ends; `twist`: rise to the tip at the heel less that at the toe; `rest`: root
    mean square, and `largest` amount, of what is of higher order.
    """

    thickness: float
    profile_angle: float
    lengthwise_angle: float
    profile_crowning: float
    length_crowning: float
    twist: float
    rest: float
    largest: float


def second_order(length: ArrayLike, height: ArrayLike, deviations: ArrayLike) -> SecondOrder:
    """Of deviations (...,), mm, at lengths to the heel and heights to the tip (...,), mm, along the flank from anywhere; those
    that are not finite are neglected. Raises DesignError where the points do not determine the six terms."""
    x, y, d = (np.ravel(np.asarray(values, dtype=float)) for values in (length, height, deviations))
    known = np.isfinite(d)
    x, y, d = x[known], y[known], d[known]
    if not d.size:
        raise _too_few_points(0)
    (x, half_x), (y, half_y) = _to_middle(x), _to_middle(y)
    terms = np.stack((np.ones_like(x), x, y, x * x, x * y, y * y), axis=-1)
    coefficients, _, rank, _ = np.linalg.lstsq(terms, d, rcond=None)
    if rank < TERMS:
        raise _too_few_points(d.size)
    a, a_x, a_y, a_xx, a_xy, a_yy = coefficients.tolist()
    rest = d - terms @ coefficients
    return SecondOrder(
        thickness=a,
        profile_angle=-float(np.arctan(a_y / half_y)),
        lengthwise_angle=float(np.arctan(a_x / half_x)),
        profile_crowning=-a_yy,
        length_crowning=-a_xx,
        twist=4.0 * a_xy,
        rest=float(np.sqrt(np.mean(rest**2))),
        largest=float(np.abs(rest).max()),
    )


def flank_coordinates(points: Array) -> tuple[Array, Array]:
    """Lengths to the heel and heights to the tip (I, J), mm, of points (I, J, 3) of a flank, from root to tip and toe to heel:
    ways along the grid's lines, from its middle."""
    length, height = (_way(np.moveaxis(points, axis, 0)) for axis in (1, 0))
    return np.moveaxis(length, 0, 1), height


def spiral_angle_error(points: Array, normals: Array, lengthwise_angle: float, joint: Joint) -> float:
    """By how much (rad) the amount of the spiral or helix angle is larger where material rises to the heel by the
    `lengthwise_angle`; of points and outward normals (I, J, 3), mm, of a flank of 3 x 3 or more, at its middle;
    `joint` of its member.

    The trace of the flank in the pitch surface moves by d / (n . e), e across the trace in that surface. Of straight teeth it is
    positive where the heel leans to rising angles about the axis.
    """
    i, j = (size // 2 for size in points.shape[:2])
    around = joint.angle_gradient(points[i, j])
    around = around / np.linalg.norm(around)
    trace = points[i, j + 1] - points[i, j - 1]
    trace = trace / np.linalg.norm(trace)
    lean = float(trace @ around)
    across = around - lean * trace
    sense = 1.0 if abs(lean) < STRAIGHT else float(np.sign(lean))
    return float(sense * lengthwise_angle * np.linalg.norm(across) / (normals[i, j] @ across))


def _way(points: Array) -> Array:
    """Ways (K, M), mm, along lines of points (K, M, 3), from the middle of each."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=-1)
    way = np.concatenate((np.zeros_like(steps[:1]), np.cumsum(steps, axis=0)))
    return np.asarray(way - 0.5 * way[-1])


def _to_middle(values: Array) -> tuple[Array, float]:
    """Values as -1 to 1 over their extent, and half of that."""
    half = 0.5 * float(np.ptp(values))
    return (values - values.min()) / (half or 1.0) - 1.0, half or 1.0


def _too_few_points(count: int) -> ArgumentError:
    return ArgumentError(
        "deviations",
        count,
        reason="so many points do not determine slopes, crownings and twist",
        allowed="3 x 3 or more",
    )
