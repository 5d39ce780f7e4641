"""Motion of a tool that turns about its own axis and is fed along a path, while the blank turns about z.

    M(psi, s) r = Rz(angle0 + turn psi + theta(s)) (p(s) + B Rz(tool_turn psi) r)

psi is the roll (rad) and s the feed (mm); theta and p are polynomials of s; B fixes the direction of the tool's axis.
Worms and disks that grind helical gears move in this way [LF04 17.7.5-9].

The velocities follow in the tool frame from the blank's axis a, the point c = p and the feed direction d = p', all
given in the tool frame. These vectors turn against the tool, x_psi = -tool_turn e_z x x:

    roll   omega = turn a + tool_turn e_z,   tau = turn a x c
    feed   omega = theta' a,                 tau = theta' a x c + d
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.polynomial import Polynomial

from gearmesh.kernel.motion.motion import MachineAxis, SeveralStates
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, about_z, broadcast_pair, cross, rotation_about
from gearmesh.records import dataclass


@dataclass(frozen=True)
class FeedMotion:
    """Two-parameter motion of roll and feed; the module's docstring has its equations."""

    #: rotation of the blank (rad) per rad of roll
    turn: float
    #: rotation of the tool (rad) per rad of roll
    tool_turn: float
    #: coefficients of s, s^2, ... in theta (rad)
    feed_turn: tuple[float, ...]
    #: coefficients (3,) of 1, s, s^2, ... in p (mm)
    path: tuple[tuple[float, float, float], ...]
    #: B, from the tool's frame at rest; only its rotation is used
    base: Rigid
    #: angle of the blank at roll 0 and feed 0, rad
    angle0: float = 0.0

    def at_several(self, psi: Array, s: Array) -> SeveralStates:
        """Return the state at psi, s (...,); parameter 0 is the roll, parameter 1 the feed."""
        psi, s = broadcast_pair(psi, s)
        # rotation of vectors that are fixed in the machine, seen from the turning tool
        spin = -self.tool_turn * Z_AXIS
        cosine, sine = np.cos(self.tool_turn * psi), np.sin(self.tool_turn * psi)
        place, along, bend = self._path(s)
        theta, rate, rate_s = (p(s)[..., None] for p in self._feed_turn)
        back = self.base.rotation
        # blank axis a, point c = p, feed d = p' and its change e = p'' in the tool frame
        a, c, d, e = (about_z(cosine, -sine, vector @ back) for vector in (Z_AXIS, place, along, bend))
        # the twists of roll and feed, and their derivatives by roll and feed
        arm, lever = cross(a, c), cross(a, d)
        a_psi, arm_psi, d_psi = cross(spin, a), cross(spin, arm), cross(spin, d)
        zero = np.zeros(3)
        roll = self.turn * a - spin, self.turn * arm
        feed = rate * a, rate * arm + d
        derivatives = (
            ((self.turn * a_psi, self.turn * arm_psi), (zero, self.turn * lever)),
            ((rate * a_psi, rate * arm_psi + d_psi), (rate_s * a, rate_s * arm + rate * lever + e)),
        )
        blank = self.angle0 + self.turn * psi + theta[..., 0]
        outer = rotation_about("z", blank)
        # columns of B Rz(tool_turn psi), then the rotation of the blank
        tool = np.empty((*psi.shape, 3, 3))
        tool[..., 0] = cosine[..., None] * back[:, 0] + sine[..., None] * back[:, 1]
        tool[..., 1] = cosine[..., None] * back[:, 1] - sine[..., None] * back[:, 0]
        tool[..., 2] = back[:, 2]
        transform = Rigid(outer @ tool, about_z(np.cos(blank), np.sin(blank), place))
        return SeveralStates(transform, (roll, feed), derivatives)

    def axes(self, psi: Array, s: Array) -> tuple[MachineAxis, ...]:
        return ()

    @cached_property
    def _feed_turn(self) -> tuple[Polynomial, Polynomial, Polynomial]:
        theta = Polynomial((0.0, *self.feed_turn))
        return theta, theta.deriv(1), theta.deriv(2)

    def _path(self, s: Array) -> tuple[Array, Array, Array]:
        """Return p and its first two derivatives at s (...,), (..., 3) each."""
        path = np.array((*self.path, *([(0.0, 0.0, 0.0)] * (3 - len(self.path)))))
        powers = s[..., None] ** np.arange(len(path))
        power = np.arange(1, len(path))
        return (
            powers @ path,
            powers[..., :-1] @ (power[:, None] * path[1:]),
            powers[..., :-2] @ ((power[1:] * power[:-1])[:, None] * path[2:]),
        )
