"""Envelopes of two-parameter motions: the surface that a tool generates while it rolls and is fed independently.

A tool surface r(u, v) moves by M(psi, s): psi is the roll and s the feed. w_psi and w_s are the velocities of tool
points over the blank per unit of roll and feed, in the tool frame. Two equations of meshing hold at a point of contact:

    f_1 = n . w_psi = 0,   f_2 = n . w_s = 0                                        [LF04 17.7.11, 17.7.12]

and R = M r, N = L n [LF04 17.7.10]. At a feed s the tool touches the surface along a line, one point per u. The
generated surface therefore has the parameters (u, s), and v(u, s) and psi(u, s) solve the two equations. The tool's own
(u, v) are no parameters of the surface: if the feed is a screw motion of the blank, the same tool points touch at all
s. With the 2 x 2 Jacobian J of (f_1, f_2) in (v, psi):

    J (v_x, psi_x) = -(f_1x, f_2x)   for x = u and s
    R_u = L (r_u + r_v v_u + w_psi psi_u),   R_s = L (r_v v_s + w_psi psi_s + w_s)

The result is again a `Surface` with an exact jet, so envelopes nest: rack -> worm -> pinion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError, Solution, Status
from gearmesh.kernel.motion.motion import MachineAxis, SeveralStates
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, cross, dot, plane_cross
from gearmesh.kernel.numeric.effort import FED_MOTION, spend
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: number of the roll among the motion's parameters
ROLL_PARAMETER = 0
#: number of the feed among the motion's parameters
FEED_PARAMETER = 1
#: largest |n . w| per unit of roll or feed (mm) that counts as solved
MESHING_TOLERANCE = 1e-11
#: relative rounding of the terms whose sum is n . w
RELATIVE_ROUNDING = 2.2e-16
#: largest shift of a jet's point to n . w = 0; a larger shift means nearly dependent equations
MAX_JET_SHIFT_MM = 1e-7
#: plain Newton steps before damped Newton steps; 3 suffice for plunges of 0.1 mm
MAX_PLAIN_STEPS = 8
#: Chebyshev nodes over u and s for the interpolated start values, tried in this order
START_NODES = ((48, 10), (96, 16), (192, 16))
#: largest residual, mm per unit of roll or feed, of accepted start values
MAX_START_RESIDUAL = 1e-6


class TwoParameterMotion(Protocol):
    """Rigid motion of a tool relative to a blank, by roll and feed."""

    def at_several(self, psi: Array, s: Array) -> SeveralStates:
        """Return the state at roll and feed (...,)."""

    def axes(self, psi: Array, s: Array) -> tuple[MachineAxis, ...]:
        """Return the machine's axes at one roll and feed, without the axes of blank and tool."""


@dataclass(frozen=True)
class FeedGeneration:
    """Solution of the two equations of meshing at (u, s) (...,)."""

    #: second parameter of the tool's surface (...,)
    v: Array
    #: roll (...,), rad
    psi: Array
    #: jet of the tool, in the tool frame
    tool: Jet
    #: motion at psi and s
    state: SeveralStates
    #: velocities (..., 3) of the tool point per unit of roll and of feed, in the tool frame
    velocities: tuple[Array, Array]
    #: number of iterations for the batch
    iterations: int = 0

    @property
    def residual(self) -> Array:
        """Left sides (..., 2) of both equations, mm per unit of roll and feed."""
        return np.stack([dot(self.tool.n, w) for w in self.velocities], axis=-1)

    @property
    def residual_limits(self) -> Array:
        """Largest residuals (..., 2) that count as 0: the rounding of omega x r and tau, with r as accurate as v."""
        coordinate_sum = np.abs(self.tool.r).sum(axis=-1) + np.abs(self.v) * np.abs(self.tool.r_v).sum(axis=-1)
        parts = [
            np.abs(omega).sum(axis=-1) * coordinate_sum + np.abs(tau).sum(axis=-1) for omega, tau in self.state.twists
        ]
        return np.maximum(MESHING_TOLERANCE, RELATIVE_ROUNDING * np.stack(parts, axis=-1))

    @property
    def holds(self) -> NDArray[np.bool_]:
        """True (...,) where both equations of meshing hold."""
        return np.asarray((np.abs(self.residual) <= self.residual_limits).all(axis=-1))

    @property
    def solution(self) -> Solution:
        """(v, psi) (..., 2), their status and the larger residual; NOT_FINITE if the tool never touches the blank."""
        residual = np.abs(self.residual).max(axis=-1)
        status = np.where(np.isfinite(residual), int(Status.MAX_ITERATIONS), int(Status.NOT_FINITE))
        status = np.where(self.holds, int(Status.CONVERGED), status)
        return Solution(np.stack((self.v, self.psi), axis=-1), status, residual, self.iterations)

    @property
    def newton_step(self) -> tuple[Array, Array]:
        """Newton step (...,) of v and of the roll."""
        return _cramer(self.partials(self.tool.r_v, self.tool.n_v), self.by_motion(ROLL_PARAMETER), -self.residual)

    def partials(self, r_x: Array, n_x: Array) -> Array:
        """Return derivatives (..., 2) of both equations for changes r_x, n_x (..., 3) of tool point and normal."""
        return np.stack(
            [
                dot(n_x, w) + dot(self.tool.n, cross(omega, r_x))
                for w, (omega, _) in zip(self.velocities, self.state.twists, strict=True)
            ],
            axis=-1,
        )

    def by_motion(self, parameter: int) -> Array:
        """Return the derivatives (..., 2) of both equations with respect to roll or feed."""
        rows = [row[parameter] for row in self.state.derivatives]
        return np.stack([dot(self.tool.n, cross(omega, self.tool.r) + tau) for omega, tau in rows], axis=-1)


@dataclass(frozen=True)
class FeedEnvelope:
    """Surface generated by `tool` in a motion of roll (parameter 0, rad) and feed (parameter 1, mm).

    Its parameters are the tool's u and the feed s. `start` returns (v, psi) near the solution for (u, s). The jet is
    NaN where Newton's method finds no solution from there, as the jet of an `Envelope` is where its tool never touches
    the blank.
    """

    tool: Surface
    motion: TwoParameterMotion
    start: Callable[[Array, Array], tuple[Array, Array]]

    def generation(self, u: Array, s: Array) -> FeedGeneration:
        """Solve both equations of meshing at (u, s) (...,) and return everything computed there.

        Raises NoSolutionError if they have no solution near the start.
        """
        g = self._solve(u, s)
        missing = ~g.solution.converged
        if missing.any():
            first_u, first_s = (np.broadcast_to(x, missing.shape)[missing][0] for x in (u, s))
            raise NoSolutionError(
                reason=f"the two equations of meshing have no solution near the start at {int(missing.sum())} of "
                f"{missing.size} points, first at u = {first_u:g}, s = {first_s:g} mm"
            )
        return g

    def prepare(self, u_range: tuple[float, float], s_range: tuple[float, float]) -> FeedEnvelope:
        """Return the same envelope with a start that is almost the solution for u and s (mm) in these ranges.

        (v, psi) are interpolated by Chebyshev polynomials, which saves three of four evaluations of tool and motion.
        The envelope is returned unchanged if the equations have no solution in a part of the region, or a solution that
        jumps.
        """
        attempts = (self._interpolate((u_range, s_range), nodes) for nodes in START_NODES)
        return next((attempt for attempt in attempts if attempt is not None), self)

    def _interpolate(
        self, ranges: tuple[tuple[float, float], tuple[float, float]], nodes: tuple[int, int]
    ) -> FeedEnvelope | None:
        """Return the envelope of `prepare` for a number of nodes over u and s, or None if it is not accurate enough."""
        orders = range(nodes[0]), range(nodes[1])
        # solve the equations at Chebyshev nodes
        places = [np.cos(np.pi * (np.array(k) + 0.5) / len(k)) for k in orders]
        scaled = [0.5 * (low + high) + 0.5 * (high - low) * x for (low, high), x in zip(ranges, places, strict=True)]
        g = self._solve(*np.meshgrid(*scaled, indexing="ij"))
        if not np.isfinite(g.v).all():
            return None
        # one more Newton step makes the nodes exact to rounding, which keeps interpolated values within the tolerance
        polished = [value + step for value, step in zip((g.v, g.psi), g.newton_step, strict=True)]
        # discrete cosine transforms in both directions
        across, along = (
            2.0 / len(k) * np.cos(np.outer(k, np.arccos(x))) * np.where(np.array(k) > 0, 1.0, 0.5)[:, None]
            for k, x in zip(orders, places, strict=True)
        )
        coefficients = np.stack([across @ values @ along.T for values in polished], axis=-1)

        def start(u: Array, s: Array) -> tuple[Array, Array]:
            x, y = ((2.0 * c - low - high) / (high - low) for c, (low, high) in zip((u, s), ranges, strict=True))
            v, psi = np.polynomial.chebyshev.chebval2d(x, y, coefficients)
            with np.errstate(invalid="ignore"):
                outside = np.maximum(np.abs(x), np.abs(y)) > 1.0
            if outside.any():
                v, psi = np.array(v), np.array(psi)
                v[outside], psi[outside] = self.start(u[outside], s[outside])
            return v, psi

        # accept the interpolation if its residual is small half way between the nodes
        between = np.meshgrid(*(0.5 * (x[1:] + x[:-1]) for x in scaled), indexing="ij")
        generation = self._at(between[0], *start(*between), between[1])
        return replace(self, start=start) if np.abs(generation.residual).max() <= MAX_START_RESIDUAL else None

    def after_steps(self, count: int) -> Callable[[Array, Array], tuple[Array, Array]]:
        """Return a start that improves the current start by `count` Newton steps."""

        def start(u: Array, s: Array) -> tuple[Array, Array]:
            v, psi = self.start(u, s)
            with np.errstate(divide="ignore", invalid="ignore"):
                for _ in range(count):
                    dv, dpsi = self._at(u, v, psi, s).newton_step
                    v, psi = v + dv, psi + dpsi
            return v, psi

        return start

    def _solve(self, u: Array, s: Array) -> FeedGeneration:
        """Return the generation at (u, s), NaN where there is no solution.

        Plain Newton steps from the start come first; members that fail continue with damped steps. Only the residual
        has to converge: (v, psi) may slide along the surface if the two equations are nearly dependent.
        """
        u, s = broadcast_pair(u, s)
        v, psi = (np.array(np.broadcast_to(x, u.shape), dtype=float) for x in self.start(u, s))
        with np.errstate(divide="ignore", invalid="ignore"):
            # a prepared start is often the solution already
            g = self._at(u, v, psi, s)
            todo = np.flatnonzero(~g.holds & np.isfinite(u) & np.isfinite(s))
            if not todo.size:
                return g
            # plain Newton steps of the unsolved points; the last dv, dpsi belong to the points of `todo`
            flat_u, flat_v, flat_psi, flat_s = (x.reshape(-1) for x in (u, v, psi, s))
            dv, dpsi = (x.reshape(-1)[todo] for x in g.newton_step)
            iterations = 0
            for _ in range(MAX_PLAIN_STEPS):
                iterations += 1
                flat_v[todo] += dv
                flat_psi[todo] += dpsi
                g = self._at(flat_u[todo], flat_v[todo], flat_psi[todo], flat_s[todo])
                away = ~g.holds
                todo = todo[away]
                dv, dpsi = (x[away] for x in g.newton_step)
                if not todo.size:
                    break
            else:
                # damped steps from the start for the rest; points without a solution become NaN
                solution = self._damped_newton(flat_u[todo], flat_s[todo])
                iterations += solution.iterations
                flat_v[todo], flat_psi[todo] = np.where(solution.converged[:, None], solution.values, np.nan).T
            return replace(self._at(u, v, psi, s), iterations=iterations)

    def _damped_newton(self, u: Array, s: Array) -> Solution:
        """Solve for (v, psi) (M, 2) by damped Newton steps from the start, at u, s (M,)."""

        def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
            g = self._at(u[index], x[:, 0], x[:, 1], s[index])
            unit = MESHING_TOLERANCE / g.residual_limits
            jacobian = np.stack((g.partials(g.tool.r_v, g.tool.n_v), g.by_motion(ROLL_PARAMETER)), axis=-1)
            return unit * g.residual, unit[..., None] * jacobian

        return newton.solve(residual, np.stack(self.start(u, s), axis=-1), tolerance=MESHING_TOLERANCE)

    @property
    def freedoms(self) -> int:
        return 2

    def on_tool(self, u: Array, v: Array) -> tuple[Array, Array]:
        return u, self.generation(u, v).v

    def generating(self, u: Array, v: Array) -> tuple[Array, ...]:
        return self.generation(u, v).psi, v

    def tool_to_blank(self, *motion: Array) -> Rigid:
        return self.motion.at_several(*motion).tool_to_blank

    def axes(self, *motion: Array) -> tuple[MachineAxis, ...]:
        return self.motion.axes(*motion)

    def progress(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return the feed (...,), mm, which is constant along a line of contact, and its partials 0 and 1."""
        u, v = broadcast_pair(u, v)
        return v, np.zeros_like(v), np.ones_like(v)

    def jet(self, u: Array, s: Array) -> Jet:
        """Return the jet of the generated surface in the blank frame.

        The point is moved from the rounded numerical solution to the solution of the equations, to first order.
        """
        g = self._solve(u, s)
        # an evaluation for roll and one for feed per iteration
        spend(g.v.size, 2 * (g.iterations + 1), FED_MOTION)
        # derivatives of tool point, normal and equations: with u, with the feed, and for the remaining residual
        across = (g.tool.r_u, g.tool.n_u), g.partials(g.tool.r_u, g.tool.n_u)
        along = (np.zeros(3), np.zeros(3)), g.by_motion(FEED_PARAMETER)
        f_v, f_psi = g.partials(g.tool.r_v, g.tool.n_v), g.by_motion(ROLL_PARAMETER)
        remaining = (np.zeros(3), np.zeros(3)), g.residual
        partials = []
        for ((r_x, n_x), f_x), fed in ((across, False), (along, True), (remaining, False)):
            # the determinant is 0 on the limiting line, where the partials are not finite
            with np.errstate(divide="ignore", invalid="ignore"):
                v_x, psi_x = _cramer(f_v, f_psi, -f_x)
            v_x, psi_x = v_x[..., None], psi_x[..., None]
            (omega_psi, _), (omega_s, _) = g.state.twists
            r_x = r_x + g.tool.r_v * v_x + g.velocities[ROLL_PARAMETER] * psi_x
            n_x = n_x + g.tool.n_v * v_x + cross(omega_psi, g.tool.n) * psi_x
            if fed:
                r_x, n_x = r_x + g.velocities[FEED_PARAMETER], n_x + cross(omega_s, g.tool.n)
            partials += [r_x, n_x]
        r_u, n_u, r_s, n_s, r_on, n_on = partials
        slight = np.abs(r_on).max(axis=-1, keepdims=True) <= MAX_JET_SHIFT_MM
        r, n = g.tool.r + np.where(slight, r_on, 0.0), g.tool.n + np.where(slight, n_on, 0.0)
        return Jet(r, n, r_u, r_s, n_u, n_s).move(g.state.tool_to_blank)

    def _at(self, u: Array, v: Array, psi: Array, s: Array) -> FeedGeneration:
        tool = self.tool.jet(u, v)
        state = self.motion.at_several(psi, s)
        roll, feed = (cross(omega, tool.r) + tau for omega, tau in state.twists)
        return FeedGeneration(v, psi, tool, state, (roll, feed))


def _cramer(first: Array, second: Array, right: Array) -> tuple[Array, Array]:
    """Solve x first + y second = right, (..., 2) each, for x, y (...,)."""
    area = plane_cross(first, second)
    return plane_cross(right, second) / area, plane_cross(first, right) / area
