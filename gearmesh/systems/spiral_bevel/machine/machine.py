r"""The universal bevel gear machine: a tilted cutter on a cradle, over a blank that rolls with the cradle or is fixed.

Machine frame, seen from the member: x is along the machine root line from the apex to the heel, y as in the member's
frame. z is along the cradle axis from the cutter into the blank. The cradle turns about z and the blank about its axis
in the same sense. The machine of a left-hand member is the mirror image (y reversed) of a right-hand machine
[AB Figs. 3-5].

    y ^          ^ j = 0
      |           \
      |            + cutter's centre         in the plane of the cradle: radial S, cradle angle q. The tilted axis of the
      |         . '                          cutter, which points into the blank, leans at swivel j = 0 towards growing q,
      |     . ' S, j = 90 deg                at j = 90 deg back to the machine centre
      | . '   q
      +-----------------------> x
    machine centre

The settings are those of a cradle machine [AB; LF04 21]. Numerical axes add polynomials in the cradle's rotation:
modified roll, helical, vertical and radial motion, and motions of tilt and swivel [Fong, J. Mech. Des. 122 (2000) 136].
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.rolling import CradleRoll, Vector
from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.machine_frame import own_axes


@dataclass(frozen=True)
class MachineSettings:
    """Settings of one machine.

    q is the cradle's rotation from the cradle angle, rad. Motions are coefficients a1, a2, ... of q, q^2, ... in mm or
    rad, which are added to a setting. In [AB] the vector sum of machine centre to back and sliding base is along the
    root line.
    """

    #: distance of the cutter's centre from the cradle axis, mm
    radial: float
    #: polar angle of the cutter's centre about the cradle axis, rad
    cradle_angle: float
    #: rotation of the cradle over rotation of the blank
    ratio_of_roll: float
    #: machine root angle, rad
    machine_root_angle: float
    #: offset of the blank from the cradle axis, mm, > 0 towards the side of the cutter's centre
    machining_offset: float = 0.0
    #: distance of the machine centre beyond the apex along the root line, mm
    machine_centre_to_back: float = 0.0
    #: withdrawal of the blank along the cradle axis, mm
    sliding_base: float = 0.0
    #: coefficients c2, c3, ... of the blank's rotation (q - c2 q^2 - c3 q^3 - ...) / ratio_of_roll
    modified_roll: tuple[float, ...] = ()
    #: angle between the cutter's axis and the cradle axis, rad
    tilt: float = 0.0
    #: direction in which the cutter's axis leans, rad: see the drawing of the module
    swivel: float = 0.0
    #: coefficients added to the tilt, rad
    tilt_motion: tuple[float, ...] = ()
    #: coefficients added to the swivel, rad
    swivel_motion: tuple[float, ...] = ()
    #: coefficients added to the radial, mm
    radial_motion: tuple[float, ...] = ()
    #: coefficients added to the sliding base, mm
    helical_motion: tuple[float, ...] = ()
    #: coefficients added to the machining offset, mm
    vertical_motion: tuple[float, ...] = ()
    #: True where cradle and blank are fixed and the cutter's surface is the flank; roll and motions are then ignored
    formate: bool = False

    def own_from_machine(self, hand: int) -> Rigid:
        """Return the motion from machine frame to member frame at cradle rotation 0.

        The origin of the machine frame is the machine centre.
        """
        axes = own_axes(self.machine_root_angle)
        displacement = np.array([self.machine_centre_to_back, -hand * self.machining_offset, -self.sliding_base])
        return Rigid(axes, axes @ displacement)

    def cutter_centre(self, hand: int) -> Array:
        """Return the cutter's centre (3,) in the machine frame at cradle rotation 0."""
        return self.radial * self._outwards(hand)

    def _outwards(self, hand: int) -> Array:
        """Return the unit vector (3,) from the machine centre to the cutter's centre in the machine frame."""
        return np.array([np.cos(self.cradle_angle), hand * np.sin(self.cradle_angle), 0.0])

    @property
    def tilted(self) -> bool:
        """True where the cutter's axis differs from the cradle axis at some cradle rotation."""
        return self.tilt != 0.0 or any(self.tilt_motion)

    @property
    def cuts_cone(self) -> bool:
        """True where the cutter's tip plane envelopes a cone about the blank's axis."""
        return not (self.tilted or self.formate or any(self.helical_motion))

    def _lean(self, hand: int) -> float:
        """Angle (rad) about the cradle axis, from x, towards which the cutter's axis leans at cradle rotation 0."""
        return hand * (self.cradle_angle + 0.5 * np.pi + self.swivel)

    def cutter_axes(self, hand: int) -> Array:
        """Return the axes of the cutter frame in the machine frame at cradle rotation 0 as columns (3, 3)."""
        if not self.tilted:
            return np.eye(3)
        return rotation_about("z", self._lean(hand)) @ rotation_about("y", self.tilt)

    def motion(self, hand: int, place: float) -> CradleRoll:
        """Return the motion from cutter to blank; `place` (rad) turns the generated flank about the member's axis."""
        per_roll = hand / self.ratio_of_roll
        turn = (place, -per_roll, *(per_roll * c for c in self.modified_roll))
        x, y, z = (float(c) for c in self.cutter_centre(hand))
        # moving the blank away equals moving the machine back
        feed = [(0.0, -hand * offset, -base) for offset, base in _pair(self.vertical_motion, self.helical_motion)]
        return CradleRoll(
            (x, y, z),
            self.own_from_machine(hand),
            turn,
            float(hand),
            tilt=(self.tilt, *self.tilt_motion) if self.tilted else (),
            swivel=(self._lean(hand), *(hand * a for a in self.swivel_motion)) if self.tilted else (),
            slide=_vectors([a * self._outwards(hand) for a in _trim(self.radial_motion)]),
            feed=_vectors(feed),
        )

    def standing(self, hand: int, place: float) -> Rigid:
        """Return the position of the cutter at the blank on a machine without roll.

        `place` (rad) turns the flank about the member's axis.
        """
        cutter = Rigid(self.cutter_axes(hand), self.cutter_centre(hand))
        return Rigid.about_z(place) @ self.own_from_machine(hand) @ cutter

    def tip_cone(self) -> ConeLevel:
        """Return the cone that the cutter's tip plane envelopes if it `cuts_cone`: the root cone of the member."""
        return ConeLevel.of(
            float(self.sliding_base / np.cos(self.machine_root_angle)), float(np.tan(self.machine_root_angle))
        )


def _trim(coefficients: tuple[float, ...]) -> tuple[float, ...]:
    """Return coefficients without zeros at the end."""
    return tuple(float(c) for c in np.trim_zeros(np.array(coefficients), "b"))


def _pair(first: tuple[float, ...], second: tuple[float, ...]) -> list[tuple[float, float]]:
    """Return pairs of coefficients of the same power, up to the highest power that is not 0."""
    first_row, second_row = _trim(first), _trim(second)
    count = max(len(first_row), len(second_row))
    return list(
        zip(first_row + (0.0,) * (count - len(first_row)), second_row + (0.0,) * (count - len(second_row)), strict=True)
    )


def _vectors(rows: list[Array] | list[Vector]) -> tuple[Vector, ...]:
    """Return rows (3,) as tuples."""
    return tuple((float(x), float(y), float(z)) for x, y, z in rows)
