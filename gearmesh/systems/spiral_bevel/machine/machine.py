"""The universal bevel gear machine: a cutter on a cradle, tilted and swivelled, over a blank that rolls with it or is fixed.

Machine frame, seen from the member: x along the machine root line from the apex to the heel, z along the cradle axis
from the cutter into the blank, y the member's own. The cradle turns about z and the blank about its own axis in the
same sense; a left-hand member's machine is the mirror image (y reversed) of a right-hand one's [AB Figs. 3-5].

    y ^          ^ j = 0
      |           \\
      |            + cutter's centre         in the plane of the cradle: radial S, cradle angle q. The tilted axis of the
      |         . '                          cutter, which points into the blank, leans at swivel j = 0 towards growing q,
      |     . ' S, j = 90 deg                at j = 90 deg back to the machine centre
      | . '   q
      +-----------------------> x
    machine centre

The settings are those of a cradle machine [AB; LF04 21]; the polynomials in the cradle's rotation are what numerical axes add to
it: modified roll, helical, vertical and radial motion, and motions of tilt and swivel [Fong, J. Mech. Des. 122 (2000) 136].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.rolling import CradleRoll, Vector
from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.kernel.surface.levels import ConeLevel


@dataclass(frozen=True)
class MachineSettings:
    """Settings of one machine, mm and rad.

    `radial`, `cradle_angle`: polar coordinates of the cutter's centre about the cradle axis; `ratio_of_roll`: cradle over
    blank; `machining_offset`: of the blank from the cradle axis, > 0 towards the side of the cutter's centre;
    `machine_centre_to_back`: machine centre beyond the apex, along the root line (in [AB] the vector sum of machine
    centre to back and sliding base); `sliding_base`: blank withdrawn along the cradle axis; `modified_roll`: coefficients
    c2, c3, ... of the blank's rotation (q - c2 q^2 - c3 q^3 - ...) / ratio_of_roll at cradle rotation q.

    `tilt` of the cutter's axis against the cradle axis, and `swivel`, the direction in which it leans: see the module's text.
    The motions are coefficients a1, a2, ... of q, q^2, ..., mm or rad, that are added: `helical_motion` to the sliding base,
    `vertical_motion` to the machining offset, `radial_motion`, `tilt_motion`, `swivel_motion` to what they are named after.
    `formate`: cradle and blank are fixed, the cutter itself is the flank, and what rolls or moves does not count.
    """

    radial: float
    cradle_angle: float
    ratio_of_roll: float
    machine_root_angle: float
    machining_offset: float = 0.0
    machine_centre_to_back: float = 0.0
    sliding_base: float = 0.0
    modified_roll: tuple[float, ...] = ()
    tilt: float = 0.0
    swivel: float = 0.0
    tilt_motion: tuple[float, ...] = ()
    swivel_motion: tuple[float, ...] = ()
    radial_motion: tuple[float, ...] = ()
    helical_motion: tuple[float, ...] = ()
    vertical_motion: tuple[float, ...] = ()
    formate: bool = False

    def own_from_machine(self, hand: int) -> Rigid:
        """Machine frame to the member's own frame at cradle rotation 0; the origin is the machine centre."""
        c, s = np.cos(self.machine_root_angle), np.sin(self.machine_root_angle)
        axes = np.array([[s, 0.0, -c], [0.0, 1.0, 0.0], [c, 0.0, s]])
        apart = np.array([self.machine_centre_to_back, -hand * self.machining_offset, -self.sliding_base])
        return Rigid(axes, axes @ apart)

    def cutter_centre(self, hand: int) -> Array:
        """Cutter centre (3,) in the machine frame at cradle rotation 0."""
        return self.radial * self._outwards(hand)

    def _outwards(self, hand: int) -> Array:
        """From the machine centre to the cutter's, a unit vector (3,) of the machine frame."""
        return np.array([np.cos(self.cradle_angle), hand * np.sin(self.cradle_angle), 0.0])

    @property
    def tilted(self) -> bool:
        """True where the cutter's axis is not the cradle's all the time."""
        return self.tilt != 0.0 or any(self.tilt_motion)

    @property
    def cuts_cone(self) -> bool:
        """True where the cutter's tip plane envelopes a cone about the blank's axis."""
        return not (self.tilted or self.formate or any(self.helical_motion))

    def _lean(self, hand: int) -> float:
        """Angle (rad) about the cradle axis, from x, towards which the cutter's axis leans at cradle rotation 0."""
        return hand * (self.cradle_angle + 0.5 * np.pi + self.swivel)

    def cutter_axes(self, hand: int) -> Array:
        """Columns: the axes of the cutter frame in the machine frame at cradle rotation 0, (3, 3)."""
        if not self.tilted:
            return np.eye(3)
        return rotation_about("z", self._lean(hand)) @ rotation_about("y", self.tilt)

    def motion(self, hand: int, place: float) -> CradleRoll:
        """Cutter to blank; `place` (rad) turns the generated flank about the member's axis."""
        per_roll = hand / self.ratio_of_roll
        turn = (place, -per_roll, *(per_roll * c for c in self.modified_roll))
        x, y, z = (float(c) for c in self.cutter_centre(hand))
        # the blank that is moved away is the machine that is moved back
        away = [(0.0, -hand * offset, -base) for offset, base in _pair(self.vertical_motion, self.helical_motion)]
        return CradleRoll(
            (x, y, z),
            self.own_from_machine(hand),
            turn,
            float(hand),
            tilt=(self.tilt, *self.tilt_motion) if self.tilted else (),
            swivel=(self._lean(hand), *(hand * a for a in self.swivel_motion)) if self.tilted else (),
            slide=_vectors([a * self._outwards(hand) for a in _trim(self.radial_motion)]),
            feed=_vectors(away),
        )

    def standing(self, hand: int, place: float) -> Rigid:
        """Cutter to blank of a machine that does not roll; `place` (rad) turns the flank about the member's axis."""
        cutter = Rigid(self.cutter_axes(hand), self.cutter_centre(hand))
        return Rigid.about_z(place) @ self.own_from_machine(hand) @ cutter

    def tip_cone(self) -> ConeLevel:
        """The cone that the cutter's tip plane envelopes where it `cuts_cone`: the root cone of the member."""
        return ConeLevel.of(
            float(self.sliding_base / np.cos(self.machine_root_angle)), float(np.tan(self.machine_root_angle))
        )


def _trim(coefficients: tuple[float, ...]) -> tuple[float, ...]:
    """Coefficients without zeros at the end."""
    return tuple(float(c) for c in np.trim_zeros(np.array(coefficients), "b"))


def _pair(first: tuple[float, ...], second: tuple[float, ...]) -> list[tuple[float, float]]:
    """Pairs of coefficients of the same power, to the highest that is not 0."""
    one, other = _trim(first), _trim(second)
    count = max(len(one), len(other))
    return list(zip(one + (0.0,) * (count - len(one)), other + (0.0,) * (count - len(other)), strict=True))


def _vectors(rows: list[Array] | list[Vector]) -> tuple[Vector, ...]:
    return tuple((float(x), float(y), float(z)) for x, y, z in rows)
