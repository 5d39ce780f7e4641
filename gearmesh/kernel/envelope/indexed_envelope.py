"""Flanks that the edges of an indexing cutter leave in a roll that is not in a constant ratio: envelopes by two parameters.

While the cutter turns by theta, the blank turns by k theta for the index; the machine M(q) carries the cutter at the
cradle rotation q. An edge e(u) sweeps

    R(u, theta, q) = Rz(k theta) M(q) Rz(direction + theta) e(u)

In the constant ratio of roll both rotations of the blank add up, and the edge sweeps one surface of the crown gear,
whose `Envelope` is the flank. With modified roll, or motions of the machine, it does not. All vectors below are in the
cutter frame on the cradle, which does not turn with theta. Rates are those over the blank. a and o are the direction of
the blank's axis and a point on it; Omega and tau are the twist of M, t the unit tangent of the edge:

    R_theta = z x r + k a x (r - o)       R_q = Omega x r + tau
    n = +- unit(t x R_theta)              equation of meshing   f(u, theta, q) = n . R_q = 0
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from gearmesh.kernel.envelope.envelope import MAX_POLISHING_STEPS, POLISHED_STEP_RAD, Envelope
from gearmesh.kernel.envelope.swept_curve import Edge, SweptCurve
from gearmesh.kernel.motion.motion import MachineAxis, MotionState
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.rolling import CradleRoll
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, broadcast_pair, cross, dot
from gearmesh.kernel.numeric.effort import OTHER_MOTION, spend
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass

#: step of a start after which its Newton steps end: its square is rounding
SQUARED_STEP_RAD = 1e-8


@dataclass(frozen=True)
class _Swept:
    """Velocities and normals (..., 3) of a swept edge in the cradle's frame, and partials of the equation of meshing."""

    #: rotation of the blank per rotation of the cutter, for the index
    per_turn: float
    #: that of the swept surface
    sense: float
    #: the turned edge
    edge: Edge
    #: the machine
    state: MotionState
    #: direction of the blank's axis
    axis: Array
    #: velocity by theta without the index
    own: Array
    #: R_theta
    by_theta: Array
    #: R_q
    by_q: Array
    #: change of R_theta with q, without the rotation of the machine
    changing: Array
    #: +- t x R_theta
    normal: Array
    #: its partial by q
    normal_q: Array
    #: partial of R_q by q
    by_q_q: Array

    @property
    def step(self) -> Array:
        """Newton step (...,) of q, rad, by normals of any length."""
        return np.asarray(dot(self.normal, self.by_q) / (dot(self.normal_q, self.by_q) + dot(self.normal, self.by_q_q)))

    def slopes(self) -> tuple[Array, Array]:
        """Return the partials of q (...,) by u and theta."""
        omega, n, by_q = self.state.omega, self.normal, self.by_q
        by_u, by_theta = self.normal_changes
        f_u = dot(by_u, by_q) + dot(n, cross(omega, self.edge.r_u))
        f_theta = dot(by_theta, by_q) + dot(n, self.changing + cross(omega, self.by_theta))
        f_q = dot(self.normal_q, by_q) + dot(n, self.by_q_q)
        return -f_u / f_q, -f_theta / f_q

    @cached_property
    def normal_changes(self) -> tuple[Array, Array]:
        """Partials (..., 3) of the normal by u and theta."""
        edge, spin = self.edge, Z_AXIS + self.per_turn * self.axis
        by_u = cross(edge.t_u, self.by_theta) + cross(edge.t, cross(spin, edge.r_u))
        moved = cross(spin, self.own) + self.per_turn * cross(self.axis, self.by_theta)
        by_theta = cross(cross(spin, edge.t), self.by_theta) + cross(edge.t, moved)
        return self.sense * by_u, self.sense * by_theta

    def jet(self) -> Jet:
        """Return the jet of the envelope."""
        size = np.sqrt(dot(self.normal, self.normal))[..., None]
        n, (by_u, by_theta) = self.normal / size, self.normal_changes
        q_u, q_v = (slope[..., None] for slope in self.slopes())
        n_u, n_v = (
            (change - n * dot(n, change)[..., None]) / size
            for change in (by_u + self.normal_q * q_u, by_theta + self.normal_q * q_v)
        )
        return Jet(self.edge.r, n, self.edge.r_u + self.by_q * q_u, self.by_theta + self.by_q * q_v, n_u, n_v)


@dataclass(frozen=True)
class IndexedEnvelope:
    """Surface that an edge leaves; its parameters are u of the edge, and theta of the cutter, rad.

    The roots of the equation of meshing are those near the `nominal` envelope, by Newton steps.
    """

    #: envelope of the surface that the edge sweeps on the crown gear, in the constant ratio of roll
    nominal: Envelope
    #: the swept surface on the crown gear
    tool: SweptCurve
    #: motion of the machine, from the cutter frame to the blank
    motion: CradleRoll
    #: rotation of the blank per rotation of the cutter, for the index
    per_turn: float
    #: rotation of the crown gear per rotation of the cutter, for the index; > 0 in the sense of the cradle's q
    crown_per_turn: float
    #: direction of the edge on the cutter at theta = 0, rad
    direction: float

    @property
    def freedoms(self) -> int:
        return 2

    def on_tool(self, u: Array, v: Array) -> tuple[Array, Array]:
        return u, v

    def rolls(self, u: Array, v: Array) -> Array:
        """Return the rotations q (...,) of the cradle, rad, at which the points u, theta (...,) are cut."""
        return self._solved(*broadcast_pair(u, v))[0]

    def parameter(self, u: Array, v: Array) -> Array:
        """Return the rotations (...,), rad, of the crown gear besides its index."""
        return np.asarray(self.rolls(u, v) - self.crown_per_turn * v)

    def generating(self, u: Array, v: Array) -> tuple[Array, ...]:
        u, v = broadcast_pair(u, v)
        return self.rolls(u, v), v

    def tool_to_blank(self, *motion: Array) -> Rigid:
        q, theta = motion
        placed = Rigid.about_z(self.per_turn * theta) @ self.motion.at(q).tool_to_blank
        return placed @ Rigid.about_z(self.direction + theta) @ self.tool.motion.at(theta).tool_to_blank.inverse

    def axes(self, *motion: Array) -> tuple[MachineAxis, ...]:
        q, theta = motion
        turned = Rigid.about_z(self.per_turn * theta)
        return tuple(
            MachineAxis(axis.name, turned.point(axis.point), turned.vector(axis.direction))
            for axis in self.motion.axes(q)
        )

    def progress(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        q, at = self._solved(*broadcast_pair(u, v))
        return q, *at.slopes()

    def jet(self, u: Array, v: Array) -> Jet:
        """Return the jet of the surface in the blank's frame."""
        u, v = broadcast_pair(u, v)
        _, at = self._solved(u, v)
        return at.jet().move(Rigid.about_z(self.per_turn * v) @ at.state.tool_to_blank)

    def _solved(self, u: Array, v: Array) -> tuple[Array, _Swept]:
        """Return q (...,), rad, and what is swept there; NaN where the edge never touches the blank."""
        edge = self._turned(u, v)
        q = self.nominal.parameter(u, v) + self.crown_per_turn * v if self._blank is None else self._start(edge)
        at = self._swept(edge, q)
        for _ in range(MAX_POLISHING_STEPS):
            step = at.step
            spend(q.size, 1, OTHER_MOTION)
            if not (np.abs(step) > POLISHED_STEP_RAD).any():
                return q, at
            q = q - step
            at = self._swept(edge, q)
        q = np.where(np.abs(step) > POLISHED_STEP_RAD, np.nan, q)
        return q, self._swept(edge, q)

    @cached_property
    def _blank(self) -> tuple[Array, Array] | None:
        """Constant, cosine and sine parts (3, 3) of the blank's axis a and of a x o on the cradle, by rows.

        None where the cutter moves on the cradle, or the blank along its axis.
        """
        constant = self.motion.unmodified_motion
        if replace(self.motion, turn=constant.turn) != constant:
            return None
        # discrete Fourier transform of three samples, exact for a first harmonic
        q = np.array([0.0, 2.0, 4.0]) * np.pi / 3.0
        back = constant.at(q).tool_to_blank.inverse
        weights = np.stack((np.ones(3) / 3.0, 2.0 / 3.0 * np.cos(q), 2.0 / 3.0 * np.sin(q)))
        axis = back.rotation[..., :, 2]
        return weights @ axis, weights @ cross(axis, back.translation)

    def _start(self, edge: Edge) -> Array:
        """Return q (...,), rad, at which a turned edge cuts, where the cutter is fixed on the cradle.

        The velocity of the cradle is V, that of the blank w B with B = a x (r - o), which is a first harmonic of q:

            f = s (t x z x r) . V + s (k V x t + w t x z x r) . B        w = d turn/dq
        """
        assert self._blank is not None
        axes, levers = self._blank
        r, own, state = edge.r, cross(Z_AXIS, edge.r), self._rest
        rates = np.polynomial.Polynomial(self.motion.turn).deriv()
        # the velocity at q = 0 is that of the cradle and of the blank
        by_cradle = state.velocity(r) - rates(0.0) * (cross(axes[0] + axes[1], r) - levers[0] - levers[1])
        swept = cross(edge.t, own)

        def parts(vector: Array) -> Array:
            """Return constant, cosine and sine parts (..., 3) of vector . B."""
            return np.asarray(cross(r, vector) @ axes.T - vector @ levers.T)

        carried, rolled = self.per_turn * parts(cross(by_cradle, edge.t)), parts(swept)
        carried[..., 0] += dot(swept, by_cradle)

        def harmonics(rate: Array) -> tuple[Array, Array, Array]:
            """Return constant, cosine and sine parts (...,) of f at a rate (...,) of the blank."""
            mean, cosine, sine = np.moveaxis(self.tool.sense * (carried + rate[..., None] * rolled), -1, 0)
            return mean, cosine, sine

        mean, cosine, sine = harmonics(rates(np.zeros(r.shape[:-1])))
        with np.errstate(invalid="ignore"):
            q = np.arctan2(sine, cosine) - self.nominal.branch * np.arccos(-mean / np.hypot(cosine, sine))
        q = (q + np.pi) % (2.0 * np.pi) - np.pi
        bends = rates.deriv()
        for _ in range(MAX_POLISHING_STEPS):
            mean, cosine, sine = harmonics(rates(q))
            c, s = np.cos(q), np.sin(q)
            change = self.tool.sense * bends(q) * (rolled[..., 0] + rolled[..., 1] * c + rolled[..., 2] * s)
            step = (mean + cosine * c + sine * s) / (change + sine * c - cosine * s)
            q = q - step
            if not (np.abs(step) > SQUARED_STEP_RAD).any():
                break
        return np.asarray(q)

    @cached_property
    def _rest(self) -> MotionState:
        """The machine at q = 0."""
        return self.motion.at(np.zeros(()))

    def _turned(self, u: Array, v: Array) -> Edge:
        """Return the edge at u, turned with the cutter to theta (...,), in the cradle's frame."""
        edge = self.tool.curve.at(u)
        return Edge(*Rigid.about_z(self.direction + v).vectors(edge.r, edge.t, edge.r_u, edge.t_u))

    def _swept(self, edge: Edge, q: Array) -> _Swept:
        """Return what a turned edge sweeps at q (...,)."""
        r, state, k, sense = edge.r, self.motion.at(q), self.per_turn, self.tool.sense
        back = state.tool_to_blank.inverse
        axis, origin, omega = back.rotation[..., :, 2], back.translation, state.omega
        arm, own = r - origin, cross(Z_AXIS, r)
        by_theta, by_q = own + k * cross(axis, arm), state.velocity(r)
        # in the cradle's frame the blank's axis moves against the cradle
        changing = k * (cross(axis, state.velocity(origin)) - cross(cross(omega, axis), arm))
        normal = sense * cross(edge.t, by_theta)
        change = cross(omega, normal) + sense * cross(edge.t, changing)
        by_q_q = state.velocity_change(r) + cross(omega, by_q)
        return _Swept(k, sense, edge, state, axis, own, by_theta, by_q, changing, normal, change, by_q_q)
