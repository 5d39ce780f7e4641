"""Tools that roll: a rack on a pitch cylinder, a cutter on a cradle; written out, a third of the time of the general product."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearmesh.kernel.motion.motion import MachineAxis, MotionState
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.two_turns import TwoTurns
from gearmesh.kernel.numeric.algebra import AXIS, Array, about_z, cross, rotation_about, turn

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class RackRoll:
    """A rack's pitch plane x = 0 rolling without sliding on the pitch cylinder of radius `radius` (mm) [LT02 6].

    M(phi) r = Rz(phi) (r + (radius, -radius phi, -advance phi)); the twist in the tool frame is Omega = e_z and
    tau = (radius phi, 0, -advance), which makes the equation of meshing linear in phi [LT02 7; LT85 A.4]. A worm or hob that turns
    is the same surface as one that slides along its axis: it is a rack, too, with an `advance` (mm/rad) along the blank's axis
    where the axes are not at right angles.
    """

    radius: float
    advance: float = 0.0
    linear: bool = True
    unmodified_motion: None = None

    def at(self, phi: Array) -> MotionState:
        phi = np.asarray(phi, dtype=float)
        rotation, r = rotation_about("z", phi), self.radius
        c, s = rotation[..., 0, 0], rotation[..., 1, 0]
        shift, tau = np.zeros((*phi.shape, 3)), np.zeros((*phi.shape, 3))
        shift[..., 0], shift[..., 1], shift[..., 2] = r * (c + phi * s), r * (s - phi * c), -self.advance * phi
        tau[..., 0], tau[..., 2] = r * phi, -self.advance
        along_x = np.array([r, 0.0, 0.0])
        return MotionState(Rigid(rotation, shift), AXIS, tau, np.zeros(3), along_x)

    def axes(self, phi: Array) -> tuple[MachineAxis, ...]:
        return ()


@dataclass(frozen=True)
class CradleRoll:
    """A tool turning with a cradle about its z axis while the blank turns about its own [CR3553 1.2; AB 9-16], tilted and fed.

    M(phi) r = Rz(turn(phi)) base (feed(phi) + Rz(sense phi) (centre + slide(phi) + Rz(swivel(phi)) Ry(tilt(phi)) r)): `centre`
    (3,) the tool's origin in the machine frame at phi = 0, `base` the machine frame to the blank's at rest. turn, tilt and
    swivel are polynomials (their coefficients, rad, none: 0); `feed` of machine and blank apart and `slide` of the tool on the
    cradle as well, by their coefficients (3,) of phi, phi^2, ..., mm.
    """

    centre: Vector
    base: Rigid
    turn: tuple[float, ...]
    sense: float = 1.0
    tilt: tuple[float, ...] = ()
    swivel: tuple[float, ...] = ()
    slide: tuple[Vector, ...] = ()
    feed: tuple[Vector, ...] = ()
    linear: bool = False

    @cached_property
    def unmodified_motion(self) -> CradleRoll:
        """The motion with a constant ratio of roll, the tool fixed on the cradle and nothing fed."""
        if not (self.slide or self.feed or any(map(any, (self.turn[2:], self.tilt[1:], self.swivel[1:])))):
            return self
        return replace(self, turn=self.turn[:2], tilt=self.tilt[:1], swivel=self.swivel[:1], slide=(), feed=())

    def machine_to_blank(self, phi: Array) -> Rigid:
        """The machine frame, whose z axis is the cradle's, to the blank's at phi (...,), rad."""
        phi = np.asarray(phi, dtype=float)
        base = Rigid(self.base.rotation, self.base.point(_path(self.feed, phi)[0]))
        return Rigid.about_z(_polynomial(self._turn[0], phi)[..., 0]) @ base

    def axes(self, phi: Array) -> tuple[MachineAxis, ...]:
        machine = self.machine_to_blank(phi)
        return (MachineAxis("cradle axis", machine.translation, machine.vector(AXIS)),)

    @cached_property
    def _blank(self) -> tuple[Array, Array]:
        """Blank axis and a point of it, (3,) each, in the machine frame."""
        back = self.base.inverse
        return back.vector(AXIS), back.translation

    @cached_property
    def _turn(self) -> tuple[Array, Array, Array]:
        """Coefficients of the blank's angle and its first two derivatives, highest first."""
        return _derivatives(self.turn)

    @cached_property
    def _two_turns(self) -> TwoTurns | None:
        """The same where the ratio is constant and nothing else moves."""
        if self.unmodified_motion is not self:
            return None
        standing = np.eye(3) if self._standing is None else self._standing
        angle, rate = (*self.turn, 0.0, 0.0)[:2]
        return TwoTurns((angle, rate), self.base, (0.0, self.sense), Rigid(standing, np.array(self.centre)))

    def at(self, phi: Array) -> MotionState:
        phi = np.asarray(phi, dtype=float)
        if self._two_turns is not None:
            return self._two_turns.at(phi)
        angle, rate, rate_phi = (_polynomial(p, phi) for p in self._turn)
        c, s = np.cos(self.sense * phi), np.sin(self.sense * phi)
        # the blank's axis and origin, as they go round in the tool's frame, and their derivatives
        axis, origin = (about_z(c, -s, vector) for vector in self._blank)
        spin, centre = self.sense * AXIS, np.array(self.centre)
        axis_phi, origin_phi = -cross(spin, axis), -cross(spin, origin)
        moving, fed = bool(self.slide or self.feed), np.zeros(3)
        if moving:
            (slid, slid_phi, slid_2), (fed, *rates) = (_path(path, phi) for path in (self.slide, self.feed))
            moved, drift, drift_2 = (about_z(c, -s, shift) for shift in (fed, *rates))
            centre, origin = centre + slid, origin - moved
            origin_phi = -cross(spin, origin) - drift - slid_phi
        lever = cross(axis, centre - origin)
        lever_phi = cross(axis_phi, centre - origin) - cross(axis, origin_phi)
        state = MotionState(
            self._transform((c, s), (np.cos(angle[..., 0]), np.sin(angle[..., 0])), centre, fed),
            omega=spin + rate * axis,
            tau=cross(spin, centre) + rate * lever,
            omega_phi=rate_phi * axis + rate * axis_phi,
            tau_phi=rate_phi * lever + rate * lever_phi,
        )
        if moving:
            more, more_phi = slid_phi + drift, cross(spin, slid_phi - drift) + slid_2 + drift_2
            state = replace(state, tau=state.tau + more, tau_phi=state.tau_phi + more_phi)
        return self._tilt(state, phi) if self.tilt or self.swivel else state

    @cached_property
    def _leaning(self) -> tuple[tuple[Array, Array, Array], ...]:
        """Coefficients of tilt and swivel and their first two derivatives, highest first."""
        return _derivatives(self.tilt), _derivatives(self.swivel)

    @cached_property
    def _standing(self) -> Array | None:
        """Rotation (3, 3) of a tool that leans alike all the time, None of another."""
        if any(self.tilt[1:]) or any(self.swivel[1:]):
            return None
        tilt, swivel = (np.array(angle[0] if angle else 0.0) for angle in (self.tilt, self.swivel))
        return rotation_about("z", swivel) @ rotation_about("y", tilt)

    def _tilt(self, carried: MotionState, phi: Array) -> MotionState:
        """The motion of the tool that is tilted on its carrier."""
        rates = carried.omega, carried.tau, carried.omega_phi, carried.tau_phi
        standing, place = self._standing, carried.tool_to_blank
        if standing is None:
            standing, rates = self._leant(carried, phi)
        back = np.swapaxes(standing, -1, -2)
        return MotionState(
            Rigid(place.rotation @ standing, place.translation),
            *(turn(back, rate) for rate in rates),
        )

    def _leant(self, carried: MotionState, phi: Array) -> tuple[Array, tuple[Array, Array, Array, Array]]:
        """Rotations (..., 3, 3) of a tool whose tilt or swivel changes, and the carrier's rates with its own."""
        (tilt, tilt_phi, tilt_2), (swivel, swivel_phi, swivel_2) = (
            tuple(_polynomial(p, phi)[..., 0] for p in setting) for setting in self._leaning
        )
        c, s = np.cos(swivel), np.sin(swivel)
        # over the carrier the tool turns about its z axis and about the y axis swivelled
        y = about_z(c, s, np.array([0.0, 1.0, 0.0]))
        turning = swivel_phi[..., None] * AXIS + tilt_phi[..., None] * y
        turning_phi = swivel_2[..., None] * AXIS + tilt_2[..., None] * y
        turning_phi = turning_phi + (tilt_phi * swivel_phi)[..., None] * cross(AXIS, y)
        omega, tau = carried.omega + turning, carried.tau
        omega_phi = carried.omega_phi + turning_phi - cross(turning, omega)
        tau_phi = carried.tau_phi - cross(turning, tau)
        standing = rotation_about("z", swivel) @ rotation_about("y", tilt)
        return standing, (omega, tau, omega_phi, tau_phi)

    def _transform(self, cradle: tuple[Array, Array], blank: tuple[Array, Array], centre: Array, fed: Array) -> Rigid:
        """Rz(blank) base Rz(cradle) by cosines and sines, written out: a third of the time of general products."""
        (c, s), (c_blank, s_blank) = cradle, blank
        columns = np.empty((*c.shape, 3, 3))
        base = self.base.rotation
        columns[..., 0] = c[..., None] * base[:, 0] + s[..., None] * base[:, 1]
        columns[..., 1] = c[..., None] * base[:, 1] - s[..., None] * base[:, 0]
        columns[..., 2] = base[:, 2]
        rotation = np.empty_like(columns)
        c_blank, s_blank = c_blank[..., None], s_blank[..., None]
        rotation[..., 0, :] = c_blank * columns[..., 0, :] - s_blank * columns[..., 1, :]
        rotation[..., 1, :] = s_blank * columns[..., 0, :] + c_blank * columns[..., 1, :]
        rotation[..., 2, :] = columns[..., 2, :]
        shift = about_z(c_blank[..., 0], s_blank[..., 0], self.base.translation + turn(base, fed))
        return Rigid(rotation, (rotation @ centre if centre.ndim == 1 else turn(rotation, centre)) + shift)


def _derivatives(coefficients: tuple[float, ...]) -> tuple[Array, Array, Array]:
    """Coefficients of a polynomial, lowest first, and those of its first two derivatives, all highest first."""
    highest_first = np.trim_zeros(np.array(coefficients[::-1]), "f")
    return highest_first, np.polyder(highest_first), np.polyder(highest_first, 2)


def _path(coefficients: tuple[Vector, ...], x: Array) -> tuple[Array, Array, Array]:
    """Values and first two derivatives, (..., 3) each, of a path by its coefficients of x, x^2, ...; (3,) where there are none."""
    if not coefficients:
        return np.zeros(3), np.zeros(3), np.zeros(3)
    path = np.vstack((np.zeros(3), coefficients))
    powers, first = x[..., None] ** np.arange(len(path)), np.arange(1, len(path))
    rates = first[:, None] * path[1:]
    return powers @ path, powers[..., :-1] @ rates, powers[..., :-2] @ (first[:-1, None] * rates[1:])


def _polynomial(coefficients: Array, x: Array) -> Array:
    """Values (..., 1) of a polynomial, highest coefficient first; of a constant only one, (1,)."""
    value: Array = coefficients[:1] if coefficients.size else np.zeros(1)
    for coefficient in coefficients[1:]:
        value = value * x[..., None] + coefficient
    return value
