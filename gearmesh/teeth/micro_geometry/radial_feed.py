"""Helix crowning by a radial feed of the tool, and the twist that the feed gives the flanks of helical gears.

The tool moves along the face and is fed radially by a parabola of its face position s. The line along which it touches
the flank leans, so that the points of one transverse section are cut at different s:

    amount(L, z) = A w(L) ((z - s0(L) - z_m) / h)^2,   s = z - s0(L)

A is the amount at toe and heel on the reference circle, z_m the middle of the face, h half the face width.

- A hob or a threaded wheel (worm) touches the flank along the line of action of worm and gear. This line is a normal of
  the flank and goes through the pitch point. Its transverse and axial parts are as 1 : lean, with lean = h tan(beta_b)
  of `ScrewInvolute`. Therefore s0 = lean (L - L_C) and w = 1, where L_C is the roll length on the reference circle, on
  which the worm rolls. A rack moves in this way exactly, a worm of finite radius nearly.
- A disk touches the flank where normals of the flank meet the axis of the disk:

      (r - c) . (n x w) = 0,   c a point of the axis, w its direction

  Each roll length has one point (L, z) on this line; s0 is its z, less the z of the point on the reference circle. A
  radial feed of 1 mm moves the flank by n_x along its normal, so that w = n_x(L) / n_x(L_C).

The feed at toe and heel is A cos(beta_b) / n_x(L_C), with n_x = sin(alpha_n) of a worm.

The parabola of each flank has its vertex where the tool touches the reference circle at mid face. The root stays as it
is without the feed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, about_z, broadcast_pair, cross, dot
from gearmesh.teeth.micro_geometry.modification import Extent, FlankField, Kinks
from gearmesh.teeth.micro_geometry.screw_involute import AmountJet, ScrewInvolute

#: degree of the polynomials over the profile; the next degrees change the line of contact by less than 1e-9 mm
PROFILE_DEGREE = 10
#: largest distance (mm) of a normal from the axis of the disk that counts as solved
MAX_AXIS_DISTANCE_MM = 1e-10


@dataclass(frozen=True)
class DiskSetting:
    """Position of a disk in a tooth space."""

    #: number of teeth of the gear
    teeth: int
    #: reference radius of the gear, mm
    reference_radius: float
    #: radius of the disk where it meets the reference circle in the middle of the space, mm
    disk_radius: float


@dataclass(frozen=True)
class FedCrowning:
    """Crowning by the radial feed of a tool; the module's docstring has the equation."""

    #: amount at toe and heel on the reference circle, mm
    amount: float
    #: radial feed at toe and heel that removes this amount, mm
    feed: float
    #: middle of the face, mm
    middle: float
    #: half of the face width, mm; negative if the heel has the smaller z
    half: float
    #: s0 over the roll length, mm
    place: Chebyshev
    #: w over the roll length
    share: Chebyshev

    @property
    def kinks(self) -> Kinks:
        """No lines: the field is smooth."""
        return Kinks()

    @cached_property
    def _series(self) -> tuple[tuple[Chebyshev, ...], ...]:
        """Derivatives 0, 1 and 2 of s0 and w."""
        return tuple((each, each.deriv(1), each.deriv(2)) for each in (self.place, self.share))

    def jet(self, length: Array, z: Array) -> AmountJet:
        length, z = broadcast_pair(length, z)
        (s, s_l, s_ll), (w, w_l, w_ll) = (tuple(each(length) for each in series) for series in self._series)
        x, scale = (z - s - self.middle) / self.half, self.amount
        x_l, x_ll, x_z = -s_l / self.half, -s_ll / self.half, 1.0 / self.half
        return AmountJet(
            scale * w * x**2,
            scale * (w_l * x**2 + 2.0 * w * x * x_l),
            scale * 2.0 * w * x * x_z,
            scale * (w_ll * x**2 + 4.0 * w_l * x * x_l + 2.0 * w * (x_l**2 + x * x_ll)),
            scale * 2.0 * x_z * (w_l * x + w * x_l),
            scale * 2.0 * w * x_z**2,
        )


def worm_crowning(amount: float, extent: Extent, *, involute: ScrewInvolute, reference_radius: float) -> FedCrowning:
    """Return the crowning by the radial feed of a hob or a threaded wheel.

    - amount: mm, at toe and heel on the reference circle.
    - reference_radius: radius of the circle (mm) on which the worm rolls.
    """
    reference = involute.length_at(reference_radius)
    domain = sorted((extent.root, extent.tip))
    place = Chebyshev.fit(domain, [involute.lean * (length - reference) for length in domain], 1, domain=domain)
    # in the transverse plane the feed moves the flank by the sine of the pressure angle
    feed = amount * reference_radius / reference
    return FedCrowning(amount, feed, *_face(extent), place, Chebyshev([1.0], domain=domain))


def disk_crowning(
    amount: float, extent: Extent, *, involute: ScrewInvolute, setting: DiskSetting, key: str
) -> FedCrowning:
    """Return the crowning by the radial feed of a disk; amount in mm, at toe and heel on the reference circle.

    Raises DesignError of `key` if the disk does not touch the flank along its whole profile.
    """
    domain = sorted((extent.root, extent.tip))
    nodes = np.cos(np.pi * (np.arange(PROFILE_DEGREE + 1) + 0.5) / (PROFILE_DEGREE + 1))
    lengths = domain[0] + 0.5 * (domain[1] - domain[0]) * (1.0 + nodes)
    # the last point is that on the reference circle
    touched = _contact(involute, setting, np.append(lengths, involute.length_at(setting.reference_radius)))
    if touched is None:
        raise DesignError(
            key,
            2.0 * setting.disk_radius,
            unit="mm",
            reason="the disk does not touch the whole profile",
            allowed="another diameter",
        )
    z, normal = touched
    place, share = (
        Chebyshev.fit(lengths, each[:-1], PROFILE_DEGREE, domain=domain) for each in (z - z[-1], normal / normal[-1])
    )
    base_cosine = 1.0 / np.hypot(1.0, involute.lean)
    feed = amount * float(base_cosine / abs(normal[-1]))
    return FedCrowning(amount, feed, *_face(extent), place, share)


def _face(extent: Extent) -> tuple[float, float]:
    """Return middle and half of the face, mm."""
    return 0.5 * (extent.toe + extent.heel), 0.5 * (extent.heel - extent.toe)


def twist_of(field: FlankField, extent: Extent) -> float:
    """Return the twist of a field, mm: its rise from root to tip at the heel, less this rise at the toe."""
    root_toe, tip_toe, root_heel, tip_heel = field.jet(
        np.array([extent.root, extent.tip, extent.root, extent.tip]),
        np.array([extent.toe, extent.toe, extent.heel, extent.heel]),
    ).a
    return float((tip_heel - root_heel) - (tip_toe - root_toe))


def _contact(involute: ScrewInvolute, setting: DiskSetting, lengths: Array) -> tuple[Array, Array] | None:
    """Return the points of a flank that a disk at rest touches, by their roll lengths (N,).

    Returns their z (N,), mm, and the parts (N,) of their normals along the line from the gear's axis to the disk; None
    if the disk does not touch the flank at each of them.
    """
    away = -1.0 if involute.internal else 1.0
    # the middle of the space beside the flank, at z = 0, turns to the line of centres
    turn = np.full(lengths.shape, involute.side * np.pi / setting.teeth)
    cosine, sine = np.cos(turn), np.sin(turn)
    centre = np.array([setting.reference_radius + away * setting.disk_radius, 0.0, 0.0])
    # the axis is perpendicular to the line of centres and to the tooth on the reference circle
    axis = np.array([0.0, -1.0, involute.rate * setting.reference_radius])
    axis /= np.linalg.norm(axis)

    def distance(unknowns: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return distances of normals from the axis, (N, 1), and their derivatives by z, (N, 1, 1)."""
        jet = involute.jet(lengths[index], unknowns[:, 0])
        r, n, r_z, n_z = (about_z(cosine[index], sine[index], each) for each in (jet.r, jet.n, jet.r_v, jet.n_v))
        arm = r - centre
        value = dot(arm, cross(n, axis))
        slope = dot(r_z, cross(n, axis)) + dot(arm, cross(n_z, axis))
        return value[:, None], slope[:, None, None]

    # a spur flank is touched in the transverse plane of the disk's middle, a helical one not far from it
    solution = newton.solve(distance, np.zeros((len(lengths), 1)), tolerance=MAX_AXIS_DISTANCE_MM)
    if not solution.converged.all():
        return None
    z = solution.values[:, 0]
    normal = about_z(cosine, sine, involute.jet(lengths, z).n)
    return z, normal[:, 0]
