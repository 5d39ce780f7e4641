"""Envelopes of two-parameter motions: the surface that a tool generates while it rolls and is fed independently.

A tool surface r(u, v) moves as M(psi, s): psi is the roll, s the feed. With the velocities w_psi, w_s of tool points over the blank
per unit of either (in the tool frame), two equations of meshing hold where the tool touches what it generates

    f_1 = n . w_psi = 0,   f_2 = n . w_s = 0                                        [LF04 17.7.11, 17.7.12]

and R = M r, N = L n [LF04 17.7.10]. At a place s of the feed the tool touches the surface along a line, one point for every
u: the generated surface has the parameters (u, s), and v(u, s), psi(u, s) solve the two equations. (The tool's own (u, v)
would not do: where the feed is a screw motion of the blank, the same tool points touch at all s.) With the 2 x 2 Jacobian
of (f_1, f_2) in (v, psi),

    J (v_x, psi_x) = -(f_1x, f_2x)   for x = u and s
    R_u = L (r_u + r_v v_u + w_psi psi_u),   R_s = L (r_v v_s + w_psi psi_s + w_s)

so that it is again a `Surface` with an exact jet, and envelopes nest: rack -> worm -> pinion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError, Solution, Status
from gearmesh.kernel.motion.motion import MachineAxis, SeveralStates
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, cross, dot, plane_cross
from gearmesh.kernel.numeric.effort import spend
from gearmesh.kernel.surface.surface import Jet, Surface

#: indices of the parameters in the motion's chain
ROLL, FEED = 0, 1
#: largest |n . w| per unit of roll or feed (mm) that counts as solved, and the part to which what it is the sum of is rounded
TOLERANCE, ROUNDING = 1e-11, 2.2e-16
#: mm up to which the jet goes on to where nothing is left of n . w: where that is farther the two equations are all but one
SLIGHT = 1e-7
#: plain Newton steps tried before the damped ones; 3 suffice for plunges of 0.1 mm
QUICK = 8
#: Chebyshev nodes over u and s between which start values are interpolated: more where a line of action runs far off
NODES = ((48, 10), (96, 16), (192, 16))
#: largest residual, mm per unit of roll or feed, of start values that are
CLOSE = 1e-6


class TwoParameterMotion(Protocol):
    """Rigid motion of a tool relative to a blank by roll and feed."""

    def at_several(self, psi: Array, s: Array) -> SeveralStates:
        """State at roll and feed (...,)."""

    def axes(self, psi: Array, s: Array) -> tuple[MachineAxis, ...]:
        """Axes of the machine at one roll and feed, beside those of blank and tool."""


@dataclass(frozen=True)
class FeedGeneration:
    """What the equations of meshing say at (u, s) (...,): tool parameter v, roll psi, tool jet, state, velocities (roll, feed)."""

    v: Array
    psi: Array
    tool: Jet
    state: SeveralStates
    velocities: tuple[Array, Array]
    iterations: int = 0

    @property
    def residual(self) -> Array:
        """Both equations' left sides (..., 2), mm per unit of roll and feed."""
        return np.stack([dot(self.tool.n, w) for w in self.velocities], axis=-1)

    @property
    def residual_limits(self) -> Array:
        """Residuals (..., 2) that count as none: n . w is known no better than omega x r and tau are, and r no better than v."""
        reach = np.abs(self.tool.r).sum(axis=-1) + np.abs(self.v) * np.abs(self.tool.r_v).sum(axis=-1)
        parts = [np.abs(omega).sum(axis=-1) * reach + np.abs(tau).sum(axis=-1) for omega, tau in self.state.twists]
        return np.maximum(TOLERANCE, ROUNDING * np.stack(parts, axis=-1))

    @property
    def holds(self) -> NDArray[np.bool_]:
        """Whether (...,) the equations of meshing hold."""
        return np.asarray((np.abs(self.residual) <= self.residual_limits).all(axis=-1))

    @property
    def solution(self) -> Solution:
        """(v, psi) (..., 2), their status and the larger residual: NOT_FINITE where the tool never touches."""
        residual = np.abs(self.residual).max(axis=-1)
        status = np.where(np.isfinite(residual), int(Status.MAX_ITERATIONS), int(Status.NOT_FINITE))
        status = np.where(self.holds, int(Status.CONVERGED), status)
        return Solution(np.stack((self.v, self.psi), axis=-1), status, residual, self.iterations)

    @property
    def newton_step(self) -> tuple[Array, Array]:
        """Changes (...,) of v and roll that reduce the residual to 0 in first order."""
        return _cramer(self.partials(self.tool.r_v, self.tool.n_v), self.by_motion(ROLL), -self.residual)

    def partials(self, r_x: Array, n_x: Array) -> Array:
        """Derivatives (..., 2) of both equations where the tool point moves by r_x and its normal by n_x, (..., 3)."""
        return np.stack(
            [
                dot(n_x, w) + dot(self.tool.n, cross(omega, r_x))
                for w, (omega, _) in zip(self.velocities, self.state.twists, strict=True)
            ],
            axis=-1,
        )

    def by_motion(self, parameter: int) -> Array:
        """Derivatives (..., 2) of both equations with respect to roll or feed."""
        rows = [row[parameter] for row in self.state.derivatives]
        return np.stack([dot(self.tool.n, cross(omega, self.tool.r) + tau) for omega, tau in rows], axis=-1)


@dataclass(frozen=True)
class FeedEnvelope:
    """Surface generated by `tool` in the motion `motion` of roll (parameter 0, rad) and feed (parameter 1, mm).

    Its parameters are the tool's u and the feed s. `start` gives (v, psi) near the solution for (u, s). Where Newton's
    method does not get from there to a solution the jet is NaN, as that of an `Envelope` is where its tool never touches.
    """

    tool: Surface
    motion: TwoParameterMotion
    start: Callable[[Array, Array], tuple[Array, Array]]

    def generation(self, u: Array, s: Array) -> FeedGeneration:
        """Solve both equations of meshing at (u, s) (...,) and return everything known there.

        Raises NoSolutionError where they have no solution near the start.
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
        """The same envelope with a start that is all but the solution for u and s (mm) in these ranges.

        (v, psi) are interpolated there by Chebyshev polynomials: one evaluation of tool and motion instead of four. Where
        they have no solution in a part of the region, or one that jumps, the envelope stays as it is.
        """
        attempts = (self._interpolate((u_range, s_range), nodes) for nodes in NODES)
        return next((attempt for attempt in attempts if attempt is not None), self)

    def _interpolate(
        self, ranges: tuple[tuple[float, float], tuple[float, float]], nodes: tuple[int, int]
    ) -> FeedEnvelope | None:
        """As `prepare` with so many nodes; None where they do not do."""
        orders = range(nodes[0]), range(nodes[1])
        places = [np.cos(np.pi * (np.array(k) + 0.5) / len(k)) for k in orders]
        scaled = [0.5 * (low + high) + 0.5 * (high - low) * x for (low, high), x in zip(ranges, places, strict=True)]
        g = self._solve(*np.meshgrid(*scaled, indexing="ij"))
        if not np.isfinite(g.v).all():
            return None
        # to rounding, so that the interpolated values are within the tolerance
        polished = [value + step for value, step in zip((g.v, g.psi), g.newton_step, strict=True)]
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

        between = np.meshgrid(*(0.5 * (x[1:] + x[:-1]) for x in scaled), indexing="ij")
        generation = self._at(between[0], *start(*between), between[1])
        return replace(self, start=start) if np.abs(generation.residual).max() <= CLOSE else None

    def after_steps(self, count: int) -> Callable[[Array, Array], tuple[Array, Array]]:
        """A start that is `count` steps of Newton's method better than this one's."""

        def start(u: Array, s: Array) -> tuple[Array, Array]:
            v, psi = self.start(u, s)
            with np.errstate(divide="ignore", invalid="ignore"):
                for _ in range(count):
                    dv, dpsi = self._at(u, v, psi, s).newton_step
                    v, psi = v + dv, psi + dpsi
            return v, psi

        return start

    def _solve(self, u: Array, s: Array) -> FeedGeneration:
        """As `generation`, NaN where there is no solution.

        Plain Newton steps from the start, then damped ones where these do not arrive. (v, psi) themselves need not converge:
        where the equations are all but dependent they slide along the surface.
        """
        u, s = broadcast_pair(u, s)
        v, psi = (np.array(np.broadcast_to(x, u.shape), dtype=float) for x in self.start(u, s))
        with np.errstate(divide="ignore", invalid="ignore"):
            g = self._at(u, v, psi, s)
            todo = np.flatnonzero(~g.holds & np.isfinite(u) & np.isfinite(s))
            if not todo.size:
                return g
            flat_u, flat_v, flat_psi, flat_s = (x.reshape(-1) for x in (u, v, psi, s))
            dv, dpsi = (x.reshape(-1)[todo] for x in g.newton_step)
            iterations = 0
            for _ in range(QUICK):
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
                solution = self._damped_newton(flat_u[todo], flat_s[todo])
                iterations += solution.iterations
                flat_v[todo], flat_psi[todo] = np.where(solution.converged[:, None], solution.values, np.nan).T
            return replace(self._at(u, v, psi, s), iterations=iterations)

    def _damped_newton(self, u: Array, s: Array) -> Solution:
        """(v, psi) (M, 2) by damped Newton from the start; u, s (M,)."""

        def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
            g = self._at(u[index], x[:, 0], x[:, 1], s[index])
            unit = TOLERANCE / g.residual_limits
            jacobian = np.stack((g.partials(g.tool.r_v, g.tool.n_v), g.by_motion(ROLL)), axis=-1)
            return unit * g.residual, unit[..., None] * jacobian

        return newton.solve(residual, np.stack(self.start(u, s), axis=-1), tolerance=TOLERANCE)

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
        """The feed (...,), mm, at which the tool touches along one line, and its partials, 0 and 1."""
        u, v = broadcast_pair(u, v)
        return v, np.zeros_like(v), np.ones_like(v)

    def jet(self, u: Array, s: Array) -> Jet:
        """Jet of the generated surface in the blank frame, at its point next to the solution, which is one of rounded numbers."""
        g = self._solve(u, s)
        # two motions, and both parameters
        spend(g.v.size, 2 * (g.iterations + 1), linear=False)
        across = (g.tool.r_u, g.tool.n_u), g.partials(g.tool.r_u, g.tool.n_u)
        along = (np.zeros(3), np.zeros(3)), g.by_motion(FEED)
        f_v, f_psi = g.partials(g.tool.r_v, g.tool.n_v), g.by_motion(ROLL)
        left = (np.zeros(3), np.zeros(3)), g.residual
        partials = []
        for ((r_x, n_x), f_x), fed in ((across, False), (along, True), (left, False)):
            # on the limiting line the determinant is 0 and the partials are no numbers
            with np.errstate(divide="ignore", invalid="ignore"):
                v_x, psi_x = _cramer(f_v, f_psi, -f_x)
            v_x, psi_x = v_x[..., None], psi_x[..., None]
            (omega_psi, _), (omega_s, _) = g.state.twists
            r_x = r_x + g.tool.r_v * v_x + g.velocities[ROLL] * psi_x
            n_x = n_x + g.tool.n_v * v_x + cross(omega_psi, g.tool.n) * psi_x
            if fed:
                r_x, n_x = r_x + g.velocities[FEED], n_x + cross(omega_s, g.tool.n)
            partials += [r_x, n_x]
        r_u, n_u, r_s, n_s, r_on, n_on = partials
        slight = np.abs(r_on).max(axis=-1, keepdims=True) <= SLIGHT
        r, n = g.tool.r + np.where(slight, r_on, 0.0), g.tool.n + np.where(slight, n_on, 0.0)
        return Jet(r, n, r_u, r_s, n_u, n_s).move(g.state.tool_to_blank)

    def _at(self, u: Array, v: Array, psi: Array, s: Array) -> FeedGeneration:
        tool = self.tool.jet(u, v)
        state = self.motion.at_several(psi, s)
        roll, feed = (cross(omega, tool.r) + tau for omega, tau in state.twists)
        return FeedGeneration(v, psi, tool, state, (roll, feed))


def _cramer(first: Array, second: Array, right: Array) -> tuple[Array, Array]:
    """Solutions x, y (...,) of x first + y second = right, (..., 2) each."""
    area = plane_cross(first, second)
    return plane_cross(right, second) / area, plane_cross(first, right) / area
