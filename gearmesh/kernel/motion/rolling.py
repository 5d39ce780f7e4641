"""Rolling motions written out, faster than the general product: a rack on a pitch cylinder, a cutter on a cradle."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from gearmesh.kernel.motion.motion import MachineAxis, MotionState
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.two_turns import TwoTurns
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, about_z, cross, rotation_about, turn
from gearmesh.records import dataclass

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class RackRoll:
    """A rack's pitch plane x = 0 rolls without sliding on the pitch cylinder of radius `radius` (mm) [LT02 6].

    M(phi) r = Rz(phi) (r + (radius, -radius phi, -advance phi)). The twist in the tool frame is Omega = e_z and
    tau = (radius phi, 0, -advance), so the equation of meshing is linear in phi [LT02 7; LT85 A.4].

    A turning worm or hob is the same surface as a worm or hob that slides along its axis. It is therefore a rack, too;
    if the axes are not at right angles it has an `advance` along the blank's axis.
    """

    #: radius of the pitch cylinder, mm
    radius: float
    #: displacement along the blank's axis, mm/rad
    advance: float = 0.0
    #: the equation of meshing is linear in phi
    linear: bool = True
    #: none, as the twist is not harmonic
    unmodified_motion: None = None

    def at(self, phi: Array) -> MotionState:
        phi = np.asarray(phi, dtype=float)
        rotation, r = rotation_about("z", phi), self.radius
        c, s = rotation[..., 0, 0], rotation[..., 1, 0]
        shift, tau = np.zeros((*phi.shape, 3)), np.zeros((*phi.shape, 3))
        shift[..., 0], shift[..., 1], shift[..., 2] = r * (c + phi * s), r * (s - phi * c), -self.advance * phi
        tau[..., 0], tau[..., 2] = r * phi, -self.advance
        along_x = np.array([r, 0.0, 0.0])
        return MotionState(Rigid(rotation, shift), Z_AXIS, tau, np.zeros(3), along_x)

    def axes(self, phi: Array) -> tuple[MachineAxis, ...]:
        return ()


@dataclass(frozen=True)
class CradleRoll:
    """A tilted and fed tool turns with a cradle while the blank turns about its own axis [CR3553 1.2; AB 9-16].

        M r = Rz(turn(phi)) base (feed(phi) + Rz(sense phi) (centre + slide(phi) + Rz(swivel(phi)) Ry(tilt(phi)) r))

    The cradle axis is z of the machine frame. turn, tilt and swivel are polynomials of phi: their coefficients (rad)
    belong to 1, phi, phi^2, ...; no coefficients mean 0. feed and slide are paths: their coefficients (3,), mm, belong
    to phi, phi^2, ...
    """

    #: origin of the tool in the machine frame at phi = 0, mm
    centre: Vector
    #: transform from the machine frame to the blank's frame at rest
    base: Rigid
    #: coefficients of the blank's rotation
    turn: tuple[float, ...]
    #: rotation of the cradle (rad) per rad of phi, such as +1 or -1
    sense: float = 1.0
    #: coefficients of the tool's tilt about y
    tilt: tuple[float, ...] = ()
    #: coefficients of the tool's swivel about z
    swivel: tuple[float, ...] = ()
    #: coefficients of the tool's path on the cradle
    slide: tuple[Vector, ...] = ()
    #: coefficients of the displacement between machine and blank
    feed: tuple[Vector, ...] = ()
    #: False: the equation of meshing is not linear in phi
    linear: bool = False

    @cached_property
    def unmodified_motion(self) -> CradleRoll:
        """The motion with a constant ratio of roll, the tool fixed on the cradle, and no feed."""
        if not (self.slide or self.feed or any(map(any, (self.turn[2:], self.tilt[1:], self.swivel[1:])))):
            return self
        return replace(self, turn=self.turn[:2], tilt=self.tilt[:1], swivel=self.swivel[:1], slide=(), feed=())

    def machine_to_blank(self, phi: Array) -> Rigid:
        """Return the transform at phi (...,), rad, from the machine frame (z: the cradle axis) to the blank's frame."""
        phi = np.asarray(phi, dtype=float)
        base = Rigid(self.base.rotation, self.base.point(_path(self.feed, phi)[0]))
        return Rigid.about_z(_polynomial(self._turn[0], phi)[..., 0]) @ base

    def axes(self, phi: Array) -> tuple[MachineAxis, ...]:
        machine = self.machine_to_blank(phi)
        return (MachineAxis("cradle axis", machine.translation, machine.vector(Z_AXIS)),)

    @cached_property
    def _blank(self) -> tuple[Array, Array]:
        """Direction of the blank's axis and a point on it, (3,) each, in the machine frame."""
        back = self.base.inverse
        return back.vector(Z_AXIS), back.translation

    @cached_property
    def _turn(self) -> tuple[Array, Array, Array]:
        """Coefficients of the blank's angle and of its first two derivatives, highest power first."""
        return _derivatives(self.turn)

    @cached_property
    def _two_turns(self) -> TwoTurns | None:
        """The same motion as `TwoTurns`, if the ratio is constant and nothing else moves; otherwise None."""
        if self.unmodified_motion is not self:
            return None
        leaning = np.eye(3) if self._constant_tilt is None else self._constant_tilt
        angle, rate = (*self.turn, 0.0, 0.0)[:2]
        return TwoTurns((angle, rate), self.base, (0.0, self.sense), Rigid(leaning, np.array(self.centre)))

    def at(self, phi: Array) -> MotionState:
        phi = np.asarray(phi, dtype=float)
        if self._two_turns is not None:
            return self._two_turns.at(phi)
        angle, rate, rate_phi = (_polynomial(p, phi) for p in self._turn)
        c, s = np.cos(self.sense * phi), np.sin(self.sense * phi)
        # axis and origin of the blank in the frame that turns with the cradle, and their derivatives
        axis, origin = (about_z(c, -s, vector) for vector in self._blank)
        spin, centre = self.sense * Z_AXIS, np.array(self.centre)
        axis_phi, origin_phi = -cross(spin, axis), -cross(spin, origin)
        # slide moves the tool in the cradle's frame; feed moves the blank's origin, seen from the turning cradle
        moving, fed = bool(self.slide or self.feed), np.zeros(3)
        if moving:
            (slid, slid_phi, slid_2), (fed, *rates) = (_path(path, phi) for path in (self.slide, self.feed))
            moved, fed_phi, fed_2 = (about_z(c, -s, shift) for shift in (fed, *rates))
            centre, origin = centre + slid, origin - moved
            origin_phi = -cross(spin, origin) - fed_phi - slid_phi
        # the twist is the rotation of the cradle plus `rate` times the rotation of the blank
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
            added, added_phi = slid_phi + fed_phi, cross(spin, slid_phi - fed_phi) + slid_2 + fed_2
            state = replace(state, tau=state.tau + added, tau_phi=state.tau_phi + added_phi)
        return self._tilt(state, phi) if self.tilt or self.swivel else state

    @cached_property
    def _leaning(self) -> tuple[tuple[Array, Array, Array], ...]:
        """Coefficients of tilt and swivel and of their first two derivatives, highest power first."""
        return _derivatives(self.tilt), _derivatives(self.swivel)

    @cached_property
    def _constant_tilt(self) -> Array | None:
        """Rotation (3, 3) of the tool on the cradle if tilt and swivel are constant; otherwise None."""
        if any(self.tilt[1:]) or any(self.swivel[1:]):
            return None
        tilt, swivel = (np.array(angle[0] if angle else 0.0) for angle in (self.tilt, self.swivel))
        return rotation_about("z", swivel) @ rotation_about("y", tilt)

    def _tilt(self, carried: MotionState, phi: Array) -> MotionState:
        """Return the motion of the tilted tool from the motion of the carrier on which it is tilted."""
        rates = carried.omega, carried.tau, carried.omega_phi, carried.tau_phi
        leaning, place = self._constant_tilt, carried.tool_to_blank
        if leaning is None:
            leaning, rates = self._with_changing_tilt(carried, phi)
        back = np.swapaxes(leaning, -1, -2)
        return MotionState(
            Rigid(place.rotation @ leaning, place.translation),
            *(turn(back, rate) for rate in rates),
        )

    def _with_changing_tilt(self, carried: MotionState, phi: Array) -> tuple[Array, tuple[Array, Array, Array, Array]]:
        """Return rotations (..., 3, 3) of a tool with changing tilt or swivel, and the twist of carrier plus tool."""
        (tilt, tilt_phi, tilt_2), (swivel, swivel_phi, swivel_2) = (
            tuple(_polynomial(p, phi)[..., 0] for p in setting) for setting in self._leaning
        )
        c, s = np.cos(swivel), np.sin(swivel)
        # the tool turns on the carrier about the z axis and about the swivelled y axis
        y = about_z(c, s, np.array([0.0, 1.0, 0.0]))
        turning = swivel_phi[..., None] * Z_AXIS + tilt_phi[..., None] * y
        turning_phi = swivel_2[..., None] * Z_AXIS + tilt_2[..., None] * y
        turning_phi = turning_phi + (tilt_phi * swivel_phi)[..., None] * cross(Z_AXIS, y)
        omega, tau = carried.omega + turning, carried.tau
        omega_phi = carried.omega_phi + turning_phi - cross(turning, omega)
        tau_phi = carried.tau_phi - cross(turning, tau)
        leaning = rotation_about("z", swivel) @ rotation_about("y", tilt)
        return leaning, (omega, tau, omega_phi, tau_phi)

    def _transform(self, cradle: tuple[Array, Array], blank: tuple[Array, Array], centre: Array, fed: Array) -> Rigid:
        """Return Rz(blank) base Rz(cradle) from cosines and sines, written out, faster than general products."""
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
    """Return coefficients, highest power first, of a polynomial given lowest first, and of two derivatives."""
    highest_first = np.trim_zeros(np.array(coefficients[::-1]), "f")
    return highest_first, np.polyder(highest_first), np.polyder(highest_first, 2)


def _path(coefficients: tuple[Vector, ...], x: Array) -> tuple[Array, Array, Array]:
    """Return a path and two derivatives, (..., 3) each, from coefficients of x, x^2, ...; (3,) if there are none."""
    if not coefficients:
        return np.zeros(3), np.zeros(3), np.zeros(3)
    path = np.vstack((np.zeros(3), coefficients))
    powers, power = x[..., None] ** np.arange(len(path)), np.arange(1, len(path))
    rates = power[:, None] * path[1:]
    return powers @ path, powers[..., :-1] @ rates, powers[..., :-2] @ (power[:-1, None] * rates[1:])


def _polynomial(coefficients: Array, x: Array) -> Array:
    """Return values (..., 1) of a polynomial, highest coefficient first; (1,) for a constant."""
    value: Array = coefficients[:1] if coefficients.size else np.zeros(1)
    for coefficient in coefficients[1:]:
        value = value * x[..., None] + coefficient
    return value
