"""The flank of the pinion that is conjugate to the gear's, over the active flank, and how far a pinion as cut stays from it.

A point of the gear's flank, as cut, meets the equation of meshing at one rotation of the gear; transformed into the pinion's own
frame, turned by as much at the ratio of the teeth, it is a point of the conjugate flank, with the gear's normal reversed.

The active flank in the axial plane of the pinion, A along the pitch cone from the apex, d across it, out of the blank:

                                        y = +1      pinion's tip
            toe  x = -1  +-----------------------------+  x = +1  heel
                         |             + x = y = 0     |               x = 2 (A - (A_i + A_e) / 2) / b
                         +-----------------------------+               y = (2 d - h1 + h2) / (h1 + h2)
                                        y = -1      as deep as the gear's tip reaches

h1 and h2 are the addenda of pinion and gear at A; between A_i and A_e is the face, b wide.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.stations import follow
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank, MemberBlank
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.pair import HAND_SIGNS, MATING_SIDES, nominal_base
from gearmesh.systems.spiral_bevel.synthesis.settings import gear_sides, meshing_turns

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: points along and up
GRID = (9, 17)
#: step (mean normal modules; rad) of the differences that follow coordinates over the gear's flank
STEP = 1e-5
#: distance from the coordinates, of 1, that counts as none
FOUND = 1e-9
#: area of the conjugate flank, over that in the middle by as much of the gear's, below which it is next to a limit of undercut
REGULAR = 0.05
#: Newton steps at most
ITERATIONS = 20


@dataclass(frozen=True)
class ActiveFlank:
    """Coordinates over the pinion's active flank, see the module's text."""

    blank: BevelBlank

    def coordinates(self, r: Array) -> tuple[Array, Array]:
        """x and y (...,) of points r (..., 3) of the pinion's own frame."""
        blank, own = self.blank, self.blank.pinion
        x = 2.0 * (own.stations.value(r) - own.inner_cone_distance) / own.face_width - 1.0
        first, second = (member_blank.addendum_at(_station(member_blank, x)) for member_blank in (own, blank.gear))
        return x, (2.0 * own.pitch_cone.value(r) - first + second) / (first + second)


def _station(own: MemberBlank, x: Array) -> Array:
    """Cone distance (...,) of a member, mm, as far from its toe as x is."""
    return np.asarray(own.inner_cone_distance + 0.5 * (1.0 + x) * own.face_width)


@dataclass(frozen=True)
class ConjugateFlank:
    """Conjugate points on a grid over the active flank of the pinion's side `name` of a design in mm; the pinion stands as it is
    cut where the gear, turned by `gear_turn` (rad), touches it in the middle of the grid.

    `along` (I, J) and `up` (I, J) are the grid's coordinates, `points` and `normals` (I, J, 3), out of the pinion, NaN where the
    gear's flank has no conjugate, or ends. The gear's point in the middle of the grid is at `height` (mm) over its cutter's tip
    plane and at `station` (mm) from the apex.
    """

    along: Array
    up: Array
    points: Array
    normals: Array
    height: float
    station: float

    @staticmethod
    def of(design: FaceMilledDesign, blank: BevelBlank, name: str) -> ConjugateFlank:
        """Raises NoSolutionError where the middle of the flank has no conjugate."""
        return _OnGear(design, blank, name).solve()

    @cached_property
    def exists(self) -> NDArray[np.bool_]:
        """Where there is a conjugate, (I, J)."""
        return np.asarray(np.isfinite(self.points).all(axis=-1))


@dataclass(frozen=True)
class _OnGear:
    """Of points of the gear's flank, those whose conjugates are on a grid over the pinion's."""

    design: FaceMilledDesign
    blank: BevelBlank
    name: str

    def solve(self) -> ConjugateFlank:
        y, x = np.meshgrid(np.linspace(-1.0, 1.0, GRID[1]), np.linspace(-1.0, 1.0, GRID[0]))
        parameters, middle = self._solve(x.ravel(), y.ravel()), x.size // 2
        p, v = parameters.T
        jet = self._surface.jet(p, v)
        turns = meshing_turns(jet, self._base, self._sense, self._ratio)
        points, normals = self._carry(jet, turns, float(turns[middle]))
        gear = self.blank.gear
        beyond = gear.tip.value(jet.r) > 0.0
        points[beyond | self._undercut(parameters, middle)] = np.nan
        if not np.isfinite(points[middle]).all():
            raise NoSolutionError(
                f"pinion.{self.name}",
                reason="no pinion flank is conjugate to the middle of the gear's flank, so there is no ease-off",
            )
        return ConjugateFlank(
            x,
            y,
            points.reshape(*x.shape, 3),
            normals.reshape(*x.shape, 3),
            height=float(self._gear.blade.flank.section(p[middle])[0][0]),
            station=float(gear.stations.value(jet.r[middle])),
        )

    def _solve(self, x: Array, y: Array) -> Array:
        """Parameters (K, 2) on the gear's flank of points with conjugates at x and y (K,), NaN where there are none."""
        blank, level = self.blank, self.blank.gear.stations
        # what touches the pinion's tip is as deep in the gear
        heights = blank.clearance + 0.5 * (1.0 - y) * blank.mean_working_depth
        p = np.array([self._gear.blade.at_height(float(height)) for height in heights])
        start = np.stack((p, follow(self._surface, p, _station(blank.gear, x), level).values), axis=-1)

        def apart(q: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
            return self._coordinates(q) - np.stack((x, y), axis=-1)[index], self._slopes(q)

        with np.errstate(all="ignore"):
            solution = newton.solve(apart, start, tolerance=FOUND, max_iterations=ITERATIONS)
        return np.where(solution.converged[:, None], solution.values, np.nan)

    def _undercut(self, parameters: Array, middle: int) -> NDArray[np.bool_]:
        """Where the conjugate is undercut, or nearly: parameters (K, 2) on the gear's flank, `middle` is not."""
        slopes = self._slopes(parameters)
        area = slopes[:, 0, 0] * slopes[:, 1, 1] - slopes[:, 0, 1] * slopes[:, 1, 0]
        undercut: NDArray[np.bool_] = ~(area / area[middle] > REGULAR)
        return undercut

    def _coordinates(self, q: Array) -> Array:
        """Coordinates (K, 2) of the conjugates of points of the gear's flank at parameters q (K, 2)."""
        jet = self._surface.jet(q[:, 0], q[:, 1])
        turns = meshing_turns(jet, self._base, self._sense, self._ratio)
        return np.stack(ActiveFlank(self.blank).coordinates(self._carry(jet, turns, 0.0)[0]), axis=-1)

    def _slopes(self, q: Array) -> Array:
        """Their derivatives (K, 2, 2), by differences."""
        # the first parameter is an angle where the blade is an arc
        steps = STEP * np.array([self.blank.mean_normal_module / (abs(self._gear.blade.blade_radius) or 1.0), 1.0])
        columns = [
            (self._coordinates(q + step) - self._coordinates(q - step)) / (2.0 * step.sum()) for step in np.diag(steps)
        ]
        return np.stack(columns, axis=-1)

    def _carry(self, jet: Jet, turns: Array, mean: float) -> tuple[Array, Array]:
        """Conjugate points and normals (K, 3) of the gear's (own frame, as cut), which meet the pinion at `turns` (K,), rad, where
        the pinion stands as cut at that turn which is `mean`."""
        phi1 = self._sense * (mean - turns) / self._ratio
        place = Rigid.about_z(-self._sense * phi1) @ (self._base @ Rigid.about_z(turns))
        return place.point(jet.r), -place.vector(jet.n)

    @cached_property
    def _gear(self) -> Generated:
        return gear_sides(self.design, self.blank)[MATING_SIDES[self.name]]

    @cached_property
    def _surface(self) -> Surface:
        return self._gear.cut(self._gear.blade.flank, 0.0)

    @cached_property
    def _base(self) -> Rigid:
        return nominal_base(self.blank, self._sense)

    @property
    def _sense(self) -> int:
        return HAND_SIGNS[self.design.hand]

    @property
    def _ratio(self) -> float:
        return self.blank.pinion.teeth / self.blank.gear.teeth
