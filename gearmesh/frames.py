"""Rigid transforms in batches, and one-parameter rigid motions with their exact twists.

A transform is named by both of its frames, `tool_to_blank` takes coordinates in the tool frame to coordinates in
the blank frame. Lengths are in mm, angles in radians. A transform holds a rotation (..., 3, 3) and a translation
(..., 3); leading axes broadcast.

A motion M(phi) takes the tool to the blank. Its twist is given in the *tool* frame: a tool point r moves over the
blank with M^-1 M' r = Omega x r + tau, which is the relative velocity in the equation of meshing [CR3553 1.5.2].
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

#: the z axis
AXIS = np.array([0.0, 0.0, 1.0])


def dot(a: Array, b: Array) -> Array:
    """Scalar product over the last axis, (..., 3) and (..., 3) -> (...,)."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def cross(a: Array, b: Array) -> Array:
    """Vector product over the last axis, (..., 3) and (..., 3) -> (..., 3)."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    x = ay * bz - az * by
    # half the time of np.stack, which counts: most calls are for a few hundred vectors
    product = np.empty((*x.shape, 3))
    product[..., 0], product[..., 1], product[..., 2] = x, az * bx - ax * bz, ax * by - ay * bx
    return product


def plane_cross(a: Array, b: Array) -> Array:
    """Area (...,) of the parallelogram of a and b (..., 2 or more) in the plane of their first two components."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def unit(a: Array) -> Array:
    """Vectors (..., 3) scaled to length 1."""
    return a / np.sqrt(dot(a, a))[..., None]


def turn(rotation: Array, vectors: Array) -> Array:
    """Apply rotations (..., 3, 3) to vectors (..., 3)."""
    if rotation.ndim == 2:
        return vectors @ rotation.T
    return np.matmul(rotation, vectors[..., None])[..., 0]


def rotation_about(axis: str, angle: ArrayLike) -> Array:
    """Right-handed rotation matrices (..., 3, 3) by `angle` (..., rad) about the axis "x", "y" or "z"."""
    angle = np.asarray(angle, dtype=float)
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    matrix = np.zeros((*angle.shape, 3, 3))
    c, s = np.cos(angle), np.sin(angle)
    matrix[..., i, i] = 1.0
    matrix[..., j, j] = matrix[..., k, k] = c
    matrix[..., j, k] = -s
    matrix[..., k, j] = s
    return matrix


def polar_angle(r: Array) -> Array:
    """Angle (...,), rad, of points (..., 2 or more) about z, -pi .. pi."""
    return np.arctan2(r[..., 1], r[..., 0])


def about_z(c: Array, s: Array, vector: Array) -> Array:
    """Vectors (3,) or (..., 3) turned about z by angles with cosines c and sines s (...,): (..., 3)."""
    x, y, z = np.moveaxis(vector, -1, 0)
    turned = np.empty((*c.shape, 3))
    turned[..., 0], turned[..., 1], turned[..., 2] = c * x - s * y, s * x + c * y, z
    return turned


@dataclass(frozen=True)
class Rigid:
    """Rigid transform r -> rotation r + translation; rotation (..., 3, 3), translation (..., 3) in mm."""

    rotation: Array
    translation: Array

    @staticmethod
    def identity() -> Rigid:
        return Rigid(np.eye(3), np.zeros(3))

    @staticmethod
    def about_z(angle: ArrayLike) -> Rigid:
        """Rotation by `angle` (..., rad) about the z axis."""
        return Rigid(rotation_about("z", angle), np.zeros(3))

    def point(self, r: Array) -> Array:
        """Points (..., 3) in the target frame."""
        return turn(self.rotation, r) + self.translation

    def vector(self, v: Array) -> Array:
        """Free vectors (..., 3) in the target frame."""
        return turn(self.rotation, v)

    def vectors(self, *vectors: Array) -> tuple[Array, ...]:
        """Several free vectors (..., 3) in the target frame, in one product."""
        together = np.empty((*vectors[0].shape[:-1], len(vectors), 3))
        for k, vector in enumerate(vectors):
            together[..., k, :] = vector
        turned = together @ np.swapaxes(self.rotation, -1, -2)
        return tuple(turned[..., k, :] for k in range(len(vectors)))

    def __matmul__(self, other: Rigid) -> Rigid:
        """`a_to_b @ c_to_a` is c_to_b."""
        return Rigid(self.rotation @ other.rotation, self.point(other.translation))

    @property
    def inverse(self) -> Rigid:
        back = np.swapaxes(self.rotation, -1, -2)
        return Rigid(back, -turn(back, self.translation))


@dataclass(frozen=True)
class MotionState:
    """A motion at parameters phi (...,): the transform, its twist in the tool frame, and the twist's derivative.

    `omega`, `tau` give the velocity omega x r + tau of a tool point r per unit of phi, in the tool frame; `omega_phi`,
    `tau_phi` are their derivatives with respect to phi. Each is (..., 3), or (3,) where it is the same for all phi.
    """

    tool_to_blank: Rigid
    omega: Array
    tau: Array
    omega_phi: Array
    tau_phi: Array


class Motion(Protocol):
    """One-parameter rigid motion of a tool relative to a blank."""

    @property
    def linear(self) -> bool:
        """True where omega is constant and tau linear in phi, so that the equation of meshing is linear in phi."""

    @property
    def unmodified(self) -> Motion | None:
        """This motion, or one close to it, whose twist is a + b cos(phi) + c sin(phi) in the tool frame; None if none is.

        So is the twist of a tool turning with a cradle over a blank that turns in a constant ratio: the equation of
        meshing is A cos(phi) + B sin(phi) + C = 0.
        """

    def at(self, phi: Array) -> MotionState:
        """State at phi (...,), in rad."""


@dataclass(frozen=True)
class Step:
    """One factor of a `Chain`: turn about z by angle0 + rate phi, then shift by offset + velocity phi.

    As a transform it takes r to Rz(angle0 + rate phi) r + offset + velocity phi, after the fixed frame `base`:
    base o shift o turn. All vectors (3,) in the frame that `base` maps from. `higher` are coefficients of phi^2,
    phi^3, ... which are added to the angle (modified roll), `plunge` those, (3,) each, which are added to the shift.
    `parameter` tells which of a motion's parameters phi is, where there are several.
    """

    rate: float = 0.0
    angle0: float = 0.0
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    base: Rigid | None = None
    higher: tuple[float, ...] = ()
    plunge: tuple[tuple[float, float, float], ...] = ()
    parameter: int = 0

    def shift(self, phi: Array) -> tuple[Array, Array, Array]:
        """Shift and its first two derivatives with respect to phi, (..., 3) each, (3,) where they are constant."""
        if not self.plunge:
            velocity = np.array(self.velocity)
            return np.array(self.offset) + phi[..., None] * velocity, velocity, np.zeros(3)
        path = np.array((self.offset, self.velocity, *self.plunge), dtype=float)
        powers = phi[..., None] ** np.arange(len(path))
        first = np.arange(1, len(path))
        return (
            powers @ path,
            powers[..., :-1] @ (first[:, None] * path[1:]),
            powers[..., :-2] @ ((first[1:] * first[:-1])[:, None] * path[2:]),
        )

    def turning(self, phi: Array) -> tuple[Array, Array, Array]:
        """Angle about z and its first two derivatives with respect to phi, each (...,)."""
        if not any(self.higher):
            return self.angle0 + self.rate * phi, np.array(self.rate), np.array(0.0)
        angle = np.polynomial.Polynomial((self.angle0, self.rate, *self.higher))
        return angle(phi), angle.deriv(1)(phi), angle.deriv(2)(phi)


@dataclass(frozen=True)
class Chain:
    """Motion composed of steps, leftmost first: M(phi) = S_1(phi) S_2(phi) ... S_n(phi).

    Twists are accumulated exactly: appending a factor J to a product with body twist xi gives
    Ad(J^-1) xi + xi_J, and its derivative Ad(J^-1) xi' - [xi_J, Ad(J^-1) xi] + xi_J'.
    """

    steps: tuple[Step, ...]
    linear: bool = False
    harmonic: bool = False

    @cached_property
    def unmodified(self) -> Chain | None:
        """The chain without the higher terms of its angles, where `harmonic` says that its twist is then harmonic."""
        if not self.harmonic:
            return None
        if not any(any(step.higher) for step in self.steps):
            return self
        return replace(self, steps=tuple(replace(step, higher=()) for step in self.steps))

    def at(self, phi: Array) -> MotionState:
        """State at phi (...,), which every step follows."""
        total, ((omega, tau),), (((omega_phi, tau_phi),),) = _accumulated(self.steps, (np.asarray(phi, dtype=float),))
        return MotionState(total, omega, tau, omega_phi, tau_phi)

    def at_several(self, *parameters: Array) -> SeveralStates:
        """State at values (...,) of several parameters, each step following the one it names."""
        values = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in parameters))
        return SeveralStates(*_accumulated(self.steps, tuple(values)))


Twist = tuple[Array, Array]


@dataclass(frozen=True)
class SeveralStates:
    """A motion of K parameters at values of them: as `MotionState`, with a twist (omega, tau), (..., 3) each, for every one.

    `twists[a]`: velocity of tool points per unit of parameter a, in the tool frame; `derivatives[a][b]`: its derivative
    with respect to parameter b.
    """

    tool_to_blank: Rigid
    twists: tuple[Twist, ...]
    derivatives: tuple[tuple[Twist, ...], ...]


def _accumulated(
    steps: tuple[Step, ...], parameters: tuple[Array, ...]
) -> tuple[Rigid, tuple[Twist, ...], tuple[tuple[Twist, ...], ...]]:
    """Transform, twists and their derivatives of a product of steps."""
    every = range(len(parameters))
    zero = np.zeros((*parameters[0].shape, 3))
    total = Rigid.identity()
    twists: list[Twist] = [(zero, zero) for _ in every]
    derivatives: list[list[Twist]] = [[(zero, zero) for _ in every] for _ in every]
    for step in steps:
        phi, own = parameters[step.parameter], step.parameter
        if step.base is not None:
            total = total @ step.base
            twists = [_body(step.base, *twist) for twist in twists]
            derivatives = [[_body(step.base, *twist) for twist in row] for row in derivatives]
        angle, rate, rate_phi = step.turning(phi)
        offset, velocity, velocity_phi = step.shift(phi)
        joint = Rigid(rotation_about("z", angle), offset)
        back = joint.inverse.rotation
        omega, tau = rate[..., None] * AXIS, turn(back, velocity)
        # d/dphi of Rz(-angle) v = -rate e_z x (Rz(-angle) v) + Rz(-angle) v'
        omega_phi, tau_phi = rate_phi[..., None] * AXIS, turn(back, velocity_phi) - cross(omega, tau)
        total = total @ joint
        twists = [_body(joint, *twist) for twist in twists]
        derivatives = [[_body(joint, *twist) for twist in row] for row in derivatives]
        for a in every:
            moved, before = twists[a], derivatives[a][own]
            derivatives[a][own] = (
                before[0] - cross(omega, moved[0]),
                before[1] - cross(omega, moved[1]) - cross(tau, moved[0]),
            )
        derivatives[own][own] = (derivatives[own][own][0] + omega_phi, derivatives[own][own][1] + tau_phi)
        twists[own] = (twists[own][0] + omega, twists[own][1] + tau)
    return total, tuple(twists), tuple(tuple(row) for row in derivatives)


def _body(joint: Rigid, omega: Array, tau: Array) -> tuple[Array, Array]:
    """Ad(joint^-1) of a twist: the velocity field omega x r + tau, seen from the frame that `joint` maps from."""
    back = np.swapaxes(joint.rotation, -1, -2)
    return turn(back, omega), turn(back, tau + cross(omega, joint.translation))


@dataclass(frozen=True)
class RackRoll:
    """A rack's pitch plane x = 0 rolling without sliding on the pitch cylinder of radius `radius` (mm) [LT02 6].

    M(phi) r = Rz(phi) (r + (radius, -radius phi, 0)); the twist in the tool frame is Omega = e_z and
    tau = (radius phi, 0, 0), which makes the equation of meshing linear in phi [LT02 7; LT85 A.4].
    The same motion as a `Chain` is `RackRoll.chain`; this one saves the general product.
    """

    radius: float
    linear: bool = True
    unmodified: None = None

    def at(self, phi: Array) -> MotionState:
        phi = np.asarray(phi, dtype=float)
        rotation, r = rotation_about("z", phi), self.radius
        c, s = rotation[..., 0, 0], rotation[..., 1, 0]
        shift, tau = np.zeros((*phi.shape, 3)), np.zeros((*phi.shape, 3))
        shift[..., 0], shift[..., 1] = r * (c + phi * s), r * (s - phi * c)
        tau[..., 0] = r * phi
        along_x = np.array([r, 0.0, 0.0])
        return MotionState(Rigid(rotation, shift), AXIS, tau, np.zeros(3), along_x)

    @property
    def chain(self) -> Chain:
        """The same motion through the general product (a second route for the tests)."""
        return Chain((Step(rate=1.0), Step(offset=(self.radius, 0.0, 0.0), velocity=(0.0, -self.radius, 0.0))))


@dataclass(frozen=True)
class CradleRoll:
    """A tool turning with a cradle about its z axis while the blank turns about its own [CR3553 1.2; AB 9-16].

    M(phi) r = Rz(turn(phi)) (base Rz(sense phi) (r + centre)): `centre` (3,) the tool's origin in the machine frame at phi = 0,
    `base` the machine frame to the blank's at rest, turn(phi) the polynomial `turn` (its coefficients, rad) of the blank.
    The same motion as a `Chain` is `CradleRoll.chain`; this one saves the general product.
    """

    centre: tuple[float, float, float]
    base: Rigid
    turn: tuple[float, ...]
    sense: float = 1.0
    linear: bool = False

    @cached_property
    def unmodified(self) -> CradleRoll:
        """The motion with a constant ratio of roll."""
        return replace(self, turn=self.turn[:2]) if any(self.turn[2:]) else self

    @cached_property
    def _blank(self) -> tuple[Array, Array]:
        """Blank axis and a point of it, (3,) each, in the machine frame."""
        back = self.base.inverse
        return back.vector(AXIS), back.translation

    @cached_property
    def _turn(self) -> tuple[Array, Array, Array]:
        """Coefficients of the blank's angle and its first two derivatives, highest first."""
        turn = np.trim_zeros(np.array(self.turn[::-1]), "f")
        return turn, np.polyder(turn), np.polyder(turn, 2)

    def at(self, phi: Array) -> MotionState:
        phi = np.asarray(phi, dtype=float)
        angle, rate, rate_phi = (_polynomial(p, phi) for p in self._turn)
        c, s = np.cos(self.sense * phi), np.sin(self.sense * phi)
        # the blank's axis and origin, as they go round in the tool's frame, and their derivatives
        axis, origin = (about_z(c, -s, vector) for vector in self._blank)
        spin, centre = self.sense * AXIS, np.array(self.centre)
        axis_phi, origin_phi = -cross(spin, axis), -cross(spin, origin)
        lever = cross(axis, centre - origin)
        lever_phi = cross(axis_phi, centre - origin) - cross(axis, origin_phi)
        return MotionState(
            self._transform(c, s, np.cos(angle[..., 0]), np.sin(angle[..., 0])),
            omega=spin + rate * axis,
            tau=cross(spin, centre) + rate * lever,
            omega_phi=rate_phi * axis + rate * axis_phi,
            tau_phi=rate_phi * lever + rate * lever_phi,
        )

    def _transform(self, c: Array, s: Array, c_blank: Array, s_blank: Array) -> Rigid:
        """Rz(blank) base Rz(cradle), written out: a third of the time of general products."""
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
        shift = about_z(c_blank[..., 0], s_blank[..., 0], self.base.translation)
        return Rigid(rotation, rotation @ np.array(self.centre) + shift)

    @property
    def chain(self) -> Chain:
        """The same motion through the general product (a second route for the tests)."""
        start, rate, *higher = self.turn
        blank = Step(rate=rate, angle0=start, higher=tuple(higher))
        return Chain((blank, Step(rate=self.sense, base=self.base), Step(offset=self.centre)), harmonic=True)


def _polynomial(coefficients: Array, x: Array) -> Array:
    """Values (..., 1) of a polynomial, highest coefficient first; of a constant only one, (1,)."""
    value: Array = coefficients[:1] if coefficients.size else np.zeros(1)
    for coefficient in coefficients[1:]:
        value = value * x[..., None] + coefficient
    return value
