"""Local synthesis of a face-hobbed pinion: the head and machine whose flank has a given point, normal and shape operator.

All vectors are in the pinion's frame, as in `synthesis.local_synthesis`. The blank turns with unit rate about z, the
cradle with the ratio of roll m about c. Per unit of the cutter's rotation about its axis a, the blank turns by z_0/z_1
for the index. At the mean point P the cradle moves with y = m c x (P - M), and the cutter's rotation alone with
g = a x (P - C). The edge sweeps the crown gear's surface with the velocity w = g + y z_0/z_1.

1. The flank is an envelope: n . y = n . (z x P). It is swept: n . w = 0. Both give all of y and g but one component
   each; with m these are three unknowns.

2. |g| is the cutter's radius r. The blade's face is turned from the radius by nu, r sin(nu) = z_0 m_n / 2. The edge in
   the face is at right angles to n, which gives the blade angle.

3. Edge tangent t and velocity w give the second fundamental form of the swept surface (n . r_uu, n . (omega x t),
   n . dw/dtheta). Its envelope in the roll has the shape operator K1 of `generated_operator`. The three components of
   K1 are the equations for the unknowns, solved by Newton steps.

Where the cradle takes the place of a gear that is not generated, m is the ratio of the teeth, and the curvature of the
blade is the third unknown: hollow blades crown the profile, and the machine stays near the gear's. Blades change only
the curvature along the line that generates. On gears with many teeth this line is nearly along the tooth, and blades
would be too hollow to touch in more than a point. They are then as hollow as they may be, and m is the third unknown.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, cross, dot, unit
from gearmesh.systems.spiral_bevel.synthesis.local_synthesis import (
    BladeAtMean,
    MachinePlanes,
    ToolSettings,
    generated_operator,
    placed_tool,
)

#: largest residual of the operator (dimensionless: times the cone distance) that counts as solved
OPERATOR_TOLERANCE = 1e-12
#: curvature of the most hollow blade at the ratio of the teeth, over that of the most hollow blade
MAX_HOLLOW_SHARE = 0.75
#: curvature of a blade beside a sought ratio of roll, over that of the blade at the ratio of the teeth
BLADE_SHARE = 0.9
#: number of steps from the start's operator to the one asked for, where another root of the ratio of roll is near
OPERATOR_STEPS = 6
#: step of differences of the dimensionless unknowns
DIFFERENCE_STEP = 1e-7


@dataclass(frozen=True)
class IndexingHead:
    """Head that cuts one side of a pinion, and the machine from which the Newton steps start."""

    #: turns of the blank per turn of the cutter, for the index
    per_turn: float
    #: r sin(nu), mm: constant along a blade; > 0 for right-hand members
    lead: float
    #: cutter radius at the mean point from which the steps start, mm
    radius: float
    #: point (3,) of the cradle axis from which the steps start, mm
    centre: Array
    #: ratio of roll from which the steps start, or that of the machine
    ratio: float
    #: 1/R of the blade, 1/mm, 0 straight, > 0 convex; None if it is sought at the ratio of roll
    blade_curvature: float | None
    #: 1/R of the most hollow blade that is sought, 1/mm
    hollowest: float = -np.inf
    #: coefficient of modified roll of the second order, by right-handed rotations
    second_roll: float = 0.0


@dataclass(frozen=True)
class HeadStart:
    """Head and unknowns of a machine from which the Newton steps to one nearby start."""

    #: the head, with the curvature of the blade or without
    head: IndexingHead
    #: unknowns (3,)
    unknowns: Array


def head_settings(
    operator: Array,
    mean: tuple[Array, Array],
    planes: MachinePlanes,
    side: int,
    head: IndexingHead,
    start: HeadStart | None = None,
) -> tuple[ToolSettings, HeadStart]:
    """Return the settings of the head whose flank has a given point, normal and shape operator, and a start for others.

    - `operator`: shape operator (3, 3) of the pinion, 1/mm
    - `mean`: mean point (3,) and normal (3,)
    - `planes`: axes of cradle and cutter, and the plane in which the blade ends
    - `side`: +1 for outside, -1 for inside blades
    - `start`: that of a machine nearby

    Raises NoSolutionError if the steps do not converge.
    """
    fit = _IndexingFit(mean[0], mean[1], planes, side, head if start is None else start.head)
    solved = fit.solved(operator, fit.start if start is None else start.unknowns)
    if fit.head.blade_curvature is None and (
        solved is None or fit.curvature(solved) < MAX_HOLLOW_SHARE * head.hollowest
    ):
        flatter = -np.inf if solved is None else BLADE_SHARE * fit.curvature(solved)
        fit = replace(fit, head=replace(fit.head, blade_curvature=max(flatter, head.hollowest)))
        solved = fit.solved(operator, fit.start, OPERATOR_STEPS) if np.isfinite(head.hollowest) else None
    if solved is None:
        raise NoSolutionError(
            reason="no face-hobbing machine gives this contact", remedy="change spiral_angle, offset or head.radius"
        )
    made = fit.cut(solved[None])
    velocity, ratio = made.cradle_velocity[0], float(made.ratio[0])
    curvature = float(made.blade_curvature[0])
    blade = BladeAtMean(float(made.angle[0]), float(made.radius[0]), made.radial[0], made.down[0], curvature)
    arm = -np.cross(planes.cradle, velocity) / ratio
    return placed_tool(mean[0], planes, blade, ratio, arm), HeadStart(fit.head, solved)


@dataclass(frozen=True)
class _HeadCut:
    """Cut of N machines at the mean point."""

    #: ratios of roll (N,)
    ratio: Array
    #: 1/R (N,) of the blades, 1/mm
    blade_curvature: Array
    #: velocity (N, 3) with the cradle, per unit rotation of the blank, mm
    cradle_velocity: Array
    #: cutter radii (N,), mm
    radius: Array
    #: unit vectors (N, 3) from the cutter's axis to the mean point
    radial: Array
    #: blade angles (N,), rad
    angle: Array
    #: directions (N, 3) down the edge to its tip, per unit of height
    down: Array
    #: shape operators (N, 2, 2) of the flank in the basis of `_IndexingFit`, 1/mm
    operator: Array


@dataclass(frozen=True)
class _IndexingFit:
    """Newton steps to one side of a pinion.

    The unknowns (3,) are the free components of both velocities, over the cone distance, and the ratio of roll or the
    curvature of the blade, times the cone distance.
    """

    #: mean point (3,), mm
    point: Array
    #: normal (3,) out of the pinion
    normal: Array
    #: axes of cradle and cutter
    planes: MachinePlanes
    #: +1 for outside, -1 for inside blades
    side: int
    #: the head
    head: IndexingHead

    @cached_property
    def _size(self) -> float:
        """Cone distance (mm) that makes lengths dimensionless."""
        return float(np.linalg.norm(self.point))

    @cached_property
    def _basis(self) -> Array:
        """Orthonormal tangents (2, 3) at the mean point."""
        along = unit(np.cross(self.normal, Z_AXIS))
        return np.stack((along, np.cross(self.normal, along)))

    @cached_property
    def _known(self) -> tuple[Array, Array, Array, Array]:
        """Known parts (3,) of the velocities with cradle and cutter, mm, and unit vectors (3,) of their free parts."""
        n, across = self.normal, float(self.normal @ np.cross(Z_AXIS, self.point))
        parts = []
        for axis, size in ((self.planes.cradle, across), (self.planes.tool, -self.head.per_turn * across)):
            in_plane = n - (n @ axis) * axis
            parts.append((size / (n @ in_plane) * in_plane, unit(np.cross(axis, n))))
        (cradle, cradle_free), (cutter, cutter_free) = parts
        return cradle, cutter, cradle_free, cutter_free

    @property
    def start(self) -> Array:
        """Unknowns (3,) of the head's start."""
        _, cutter, cradle_free, _ = self._known
        moved = self.head.ratio * np.cross(self.planes.cradle, self.point - self.head.centre)
        # the mean point is on the side of the cutter's axis on which the blade cuts
        turned = -self.side * np.sqrt(self.head.radius**2 - cutter @ cutter)
        third = 0.0 if self.head.blade_curvature is None else self.head.ratio
        return np.array([moved @ cradle_free / self._size, turned / self._size, third])

    def curvature(self, unknowns: Array) -> float:
        """Return the curvature (1/mm) of the blade of unknowns (3,) where it is sought."""
        return float(unknowns[2] / self._size)

    def solved(self, operator: Array, start: Array, steps: int = 1) -> Array | None:
        """Return the unknowns (3,) with the operator (3, 3), or None; in steps from the operator of the start (3,)."""
        at = start
        with np.errstate(all="ignore"):
            own = self._basis.T @ self.cut(start[None]).operator[0] @ self._basis
            for step in range(1, steps + 1):
                target = operator if step == steps else own + step / steps * (operator - own)
                solution = newton.solve(self.residual_of(target), at[None], tolerance=OPERATOR_TOLERANCE)
                if not solution.converged[0]:
                    return None
                at = solution.values[0]
        return at

    def residual_of(self, operator: Array) -> newton.Residual:
        """Return residuals (M, 3) of the operator (3, 3), and their derivatives (M, 3, 3) by differences."""
        wanted = self._basis @ operator @ self._basis.T

        def residual(x: Array, _: NDArray[np.intp]) -> tuple[Array, Array]:
            shifted = x + DIFFERENCE_STEP * np.concatenate((np.zeros((1, 3)), np.eye(3)))[:, None]
            apart = self._size * (self.cut(shifted.reshape(-1, 3)).operator - wanted)
            f = np.stack((apart[:, 0, 0], apart[:, 0, 1], apart[:, 1, 1]), axis=-1).reshape(shifted.shape)
            return f[0], np.moveaxis(f[1:] - f[0], 0, -1) / DIFFERENCE_STEP

        return residual

    def cut(self, x: Array) -> _HeadCut:
        """Return what the machines of unknowns (N, 3) cut at the mean point."""
        n, cradle, tool, side = self.normal, self.planes.cradle, self.planes.tool, self.side
        known_cradle, known_cutter, cradle_free, cutter_free = self._known
        given, third = self.head.blade_curvature, x[:, 2]
        ratio = np.full_like(third, self.head.ratio) if given is None else third
        curvature = third / self._size if given is None else np.full_like(third, given)
        by_cradle = known_cradle + self._size * x[:, :1] * cradle_free
        by_cutter = known_cutter + self._size * x[:, 1:2] * cutter_free
        radius = np.sqrt(dot(by_cutter, by_cutter))
        around = by_cutter / radius[:, None]
        radial = cross(around, tool)
        # face and edge of the blade
        sine = self.head.lead / radius
        face = np.sqrt(1.0 - sine**2)[:, None] * radial + sine[:, None] * around
        angle = np.arctan2(-(n @ tool), -side * (face @ n))
        c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
        edge, bent = side * s * face - c * tool, -s * tool - side * c * face
        # swept surface: the crown gear carries the cutter
        rate = ratio[:, None] * self.head.per_turn
        swept = by_cutter + self.head.per_turn * by_cradle
        spin, arm = tool + rate * cradle, radius[:, None] * radial
        by_arm = cross(rate * cradle, arm) + by_cutter
        change = cross(rate * cradle, swept) + cross(cross(rate * cradle, tool), arm) + cross(tool, by_arm)
        form = np.empty((len(x), 2, 2))
        form[:, 0, 0] = curvature * (bent @ n)
        form[:, 0, 1] = form[:, 1, 0] = cross(spin, edge) @ n
        form[:, 1, 1] = change @ n
        tangents: Array = np.asarray(np.linalg.inv(np.stack((edge, swept), axis=1) @ self._basis.T), dtype=np.float64)
        cutter_operator = tangents @ form @ np.swapaxes(tangents, -1, -2)
        operator = generated_operator(
            cutter_operator,
            (self.point, n, self._basis),
            (Z_AXIS, ratio[:, None] * cradle),
            by_cradle,
            (2.0 * self.head.second_roll * ratio, self.head.per_turn * tangents[:, :, 1]),
        )
        down = tool - side * np.tan(angle)[:, None] * face
        return _HeadCut(ratio, curvature, by_cradle, radius, radial, angle, down, operator)
