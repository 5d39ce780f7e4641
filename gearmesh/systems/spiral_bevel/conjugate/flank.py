"""The pinion's flank that is conjugate to the gear's flank, over the active flank: the reference of the ease-off.

A point of the gear's flank, as cut, meets the equation of meshing at one rotation of the gear. Transformed into the
pinion's frame, which is turned by the ratio of the teeth, it is a point of the conjugate flank. The normal is the
gear's normal reversed.

The active flank in the axial plane of the pinion, A along the pitch cone from the apex, d across it, out of the blank:

                                        y = +1      pinion's tip
            toe  x = -1  +-----------------------------+  x = +1  heel
                         |             + x = y = 0     |               x = 2 (A - (A_i + A_e) / 2) / b
                         +-----------------------------+               y = (2 d - h1 + h2) / (h1 + h2)
                                        y = -1      as deep as the gear's tip reaches

h1 and h2 are the addenda of pinion and gear at A. The face of width b is between A_i and A_e.
"""

from __future__ import annotations

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
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.pair import HAND_SIGNS, MATING_SIDES, nominal_base
from gearmesh.systems.spiral_bevel.synthesis.settings import gear_sides, meshing_turns

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: number of points of the grid along the face and up the tooth
ACTIVE_GRID_SHAPE = (9, 17)
#: step (mean normal modules; rad) of the central differences of the coordinates over the gear's flank
DIFFERENCE_STEP = 1e-5
#: residual of the coordinates, whose range is -1 to 1, at which a point is solved
COORDINATE_TOLERANCE = 1e-9
#: area ratio of conjugate and gear flank, over the ratio in the middle, below which the point is near an undercut limit
MIN_AREA_RATIO = 0.05
#: largest number of Newton steps
MAX_NEWTON_STEPS = 20


@dataclass(frozen=True)
class ActiveFlank:
    """Coordinates over the pinion's active flank: see the drawing of the module."""

    blank: BevelBlank

    def coordinates(self, r: Array) -> tuple[Array, Array]:
        """Return x and y (...,) of points r (..., 3) of the pinion's frame."""
        blank, pinion = self.blank, self.blank.pinion
        x = 2.0 * (pinion.stations.value(r) - pinion.inner_cone_distance) / pinion.face_width - 1.0
        pinion_addendum, gear_addendum = (
            member_blank.addendum_at(_station(member_blank, x)) for member_blank in (pinion, blank.gear)
        )
        return x, (2.0 * pinion.pitch_cone.value(r) - pinion_addendum + gear_addendum) / (
            pinion_addendum + gear_addendum
        )


def _station(member: MemberBlank, x: Array) -> Array:
    """Return the cone distances (...,) of a member, mm, at coordinates x."""
    return np.asarray(member.inner_cone_distance + 0.5 * (1.0 + x) * member.face_width)


@dataclass(frozen=True)
class ConjugateFlank:
    """Conjugate points on a grid over the active flank of one side of the pinion.

    The pinion is in its position as cut when the gear, turned by `gear_turn` (rad), touches it in the middle of the
    grid.
    """

    #: x coordinates of the grid (I, J), along the face
    along: Array
    #: y coordinates of the grid (I, J), up the tooth
    up: Array
    #: conjugate points (I, J, 3), mm; NaN where the gear's flank ends or has no conjugate
    points: Array
    #: normals (I, J, 3) out of the pinion
    normals: Array
    #: height of the gear's point in the middle of the grid over the tip plane of its cutter, mm
    height: float
    #: distance of the gear's point in the middle of the grid from the apex, mm
    station: float

    @staticmethod
    def of(design: FaceMilledDesign, blank: BevelBlank, name: str) -> ConjugateFlank:
        """Return the conjugate flank of the pinion's side `name` of a design in mm.

        Raises NoSolutionError if the middle of the flank has no conjugate.
        """
        return _OnGear(design, blank, name).solve()

    @cached_property
    def exists(self) -> NDArray[np.bool_]:
        """True (I, J) where a conjugate point exists."""
        return np.asarray(np.isfinite(self.points).all(axis=-1))


@dataclass(frozen=True)
class _OnGear:
    """Points of the gear's flank whose conjugates are on a grid over the pinion's active flank."""

    #: design in mm
    design: FaceMilledDesign
    #: blank of the pair
    blank: BevelBlank
    #: side of the pinion, "concave" or "convex"
    name: str

    def solve(self) -> ConjugateFlank:
        """Return the conjugate flank. Raises NoSolutionError if the middle of the flank has no conjugate."""
        y, x = np.meshgrid(np.linspace(-1.0, 1.0, ACTIVE_GRID_SHAPE[1]), np.linspace(-1.0, 1.0, ACTIVE_GRID_SHAPE[0]))
        parameters, middle = self._solve(x.ravel(), y.ravel()), x.size // 2
        p, v = parameters.T
        jet = self._surface.jet(p, v)
        turns = meshing_turns(jet, self._base, self._sense, self._ratio)
        points, normals = self._carry(jet, turns, float(turns[middle]))
        gear = self.blank.gear
        # points beyond the gear's tip, and undercut points, are no flank
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
        """Parameters (K, 2) on the gear's flank of points with conjugates at x and y (K,); NaN where there are none."""
        blank, level = self.blank, self.blank.gear.stations
        # start values: the gear's point at the same share of the face, as deep as the pinion's point is high
        heights = blank.clearance + 0.5 * (1.0 - y) * blank.mean_working_depth
        p = np.array([self._gear.blade.at_height(float(height)) for height in heights])
        start = np.stack((p, follow(self._surface, p, _station(blank.gear, x), level).values), axis=-1)

        def residual(q: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
            return self._coordinates(q) - np.stack((x, y), axis=-1)[index], self._slopes(q)

        with np.errstate(all="ignore"):
            solution = newton.solve(residual, start, tolerance=COORDINATE_TOLERANCE, max_iterations=MAX_NEWTON_STEPS)
        return np.where(solution.converged[:, None], solution.values, np.nan)

    def _undercut(self, parameters: Array, middle: int) -> NDArray[np.bool_]:
        """Return True (K,) where the conjugate of parameters (K, 2) is undercut, or nearly.

        `middle` is the index of a regular point.

        The area of the conjugate per area of the gear's flank vanishes at the limit of undercut and has the other sign
        beyond it.
        """
        slopes = self._slopes(parameters)
        area = slopes[:, 0, 0] * slopes[:, 1, 1] - slopes[:, 0, 1] * slopes[:, 1, 0]
        undercut: NDArray[np.bool_] = ~(area / area[middle] > MIN_AREA_RATIO)
        return undercut

    def _coordinates(self, q: Array) -> Array:
        """Return the coordinates (K, 2) of the conjugates of gear points at parameters q (K, 2)."""
        jet = self._surface.jet(q[:, 0], q[:, 1])
        turns = meshing_turns(jet, self._base, self._sense, self._ratio)
        return np.stack(ActiveFlank(self.blank).coordinates(self._carry(jet, turns, 0.0)[0]), axis=-1)

    def _slopes(self, q: Array) -> Array:
        """Return the derivatives (K, 2, 2) of the coordinates by q, by central differences."""
        # the first parameter is a length on a straight blade, an angle on an arc
        steps = DIFFERENCE_STEP * np.array(
            [self.blank.mean_normal_module / (abs(self._gear.blade.blade_radius) or 1.0), 1.0]
        )
        columns = [
            (self._coordinates(q + step) - self._coordinates(q - step)) / (2.0 * step.sum()) for step in np.diag(steps)
        ]
        return np.stack(columns, axis=-1)

    def _carry(self, jet: Jet, turns: Array, mean: float) -> tuple[Array, Array]:
        """Return the conjugate points and normals (K, 3) of gear points in the pinion's frame.

        The gear points (gear's frame, as cut) are in contact at gear rotations `turns` (K,), rad. The pinion is in its
        position as cut at the gear rotation `mean`.
        """
        phi1 = self._sense * (mean - turns) / self._ratio
        gear_to_pinion = Rigid.about_z(-self._sense * phi1) @ (self._base @ Rigid.about_z(turns))
        return gear_to_pinion.point(jet.r), -gear_to_pinion.vector(jet.n)

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
