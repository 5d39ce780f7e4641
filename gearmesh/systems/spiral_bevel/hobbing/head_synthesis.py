"""Machine of a face-hobbed side of the pinion with a given point, normal and shape operator, by Newton steps.

The surface that an indexing blade sweeps has no closed form of its curvatures. Point, normal and operator of the flank
at the mean point are eight conditions. The unknowns are radial setting, cradle angle, ratio of roll, machining offset,
machine centre to back, blade angle, cutter radius at the mean point, and rotation of the cutter there. The machine plane
is that of the root, which gives the height of the mean point over the blade's tip. The steps start from the machine that
generates the pinion by its own crown gear.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.curvature import shape_operator
from gearmesh.kernel.surface.surface import Jet
from gearmesh.systems.common.bevel.blank import BevelBlank
from gearmesh.systems.spiral_bevel.hobbing.sides import crown_cut, indexing
from gearmesh.tools.head_cutter import Blade

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.machine.generated import Generated

#: largest residual (dimensionless: lengths over the mean cone distance) that counts as solved
SYNTHESIS_TOLERANCE = 1e-11
#: largest number of steps
MAX_SYNTHESIS_STEPS = 60
#: step of differences
DIFFERENCE_STEP = 1e-7
#: least share of a step
MIN_STEP_SHARE = 1e-3
#: largest ratio of residuals at which the derivatives of an earlier step are kept
MAX_KEPT_RATIO = 0.5


def hobbed_values(
    design: FaceMilledDesign, blank: BevelBlank, name: str, mean: tuple[Array, Array], operator: Array
) -> dict[str, float]:
    """Return the settings by key (mm, deg) of one side of the pinion.

    `mean`: point (3,) and normal (3,), `operator`: shape operator (3, 3), in the pinion's frame, as cut.

    Raises NoSolutionError, naming the side, if no machine has them.
    """
    return _HeadFit(design, blank, name, mean, operator).values()


@dataclass(frozen=True)
class _HeadFit:
    """Newton steps to one side of the pinion."""

    #: design in mm
    design: FaceMilledDesign
    #: blank of the pair
    blank: BevelBlank
    #: "concave" or "convex"
    name: str
    #: point (3,), mm, and normal (3,)
    mean: tuple[Array, Array]
    #: shape operator (3, 3), 1/mm
    operator: Array

    def values(self) -> dict[str, float]:
        """Return the settings by key. Raises NoSolutionError if the steps do not converge."""
        with np.errstate(all="ignore"):
            x = self._solved()
        side = self._side(x)
        machine, blade = side.settings, side.blade
        return {
            "radial": machine.radial,
            "cradle_angle": float(np.degrees(machine.cradle_angle)),
            "ratio_of_roll": machine.ratio_of_roll,
            "machining_offset": machine.machining_offset,
            "machine_centre_to_back": machine.machine_centre_to_back,
            "sliding_base": machine.sliding_base,
            "blade_angle": float(np.degrees(blade.blade_angle)),
            "tip_radius": blade.tip_radius,
            "blade_height": self._height,
        }

    def _solved(self) -> Array:
        x, slopes = self._start, None
        rest = self._residual(x)
        for _ in range(MAX_SYNTHESIS_STEPS):
            size = float(np.linalg.norm(rest))
            if size < SYNTHESIS_TOLERANCE:
                return x
            fresh = slopes is None
            if slopes is None:
                steps = DIFFERENCE_STEP * np.eye(x.size)
                columns = [(self._residual(x + step) - rest) / step.sum() for step in steps]
                slopes = np.stack(columns, axis=1)
            if not np.isfinite(slopes).all():
                break
            step = -np.linalg.solve(slopes, rest)
            share, ahead = 1.0, self._residual(x + step)
            while fresh and share > MIN_STEP_SHARE and not np.linalg.norm(ahead) < size:
                share *= 0.5
                ahead = self._residual(x + share * step)
            if not np.linalg.norm(ahead) < size:
                if fresh:
                    break
                slopes = None
                continue
            # Broyden's update of the derivatives, unless the step was poor
            moved = share * step
            poor = np.linalg.norm(ahead) > MAX_KEPT_RATIO * size
            slopes = None if poor else slopes + np.outer(ahead - rest - slopes @ moved, moved) / (moved @ moved)
            x, rest = x + moved, ahead
        raise NoSolutionError(
            f"pinion.{self.name}",
            reason="no face-hobbing machine gives this contact",
            remedy="change spiral_angle, offset or head.radius",
        )

    @cached_property
    def _nominal(self) -> Generated:
        """Side that the pinion's own crown gear generates."""
        return crown_cut(self.design, self.blank, self.name)

    @cached_property
    def _height(self) -> float:
        """Height (mm) of the mean point over the tip plane."""
        return float(self._nominal.above_plane(self.mean[0][None])[0])

    @cached_property
    def _size(self) -> float:
        return self.blank.pinion.mean_cone_distance

    @cached_property
    def _start(self) -> Array:
        machine, blade = self._nominal.settings, self._nominal.blade
        return np.array(
            [
                machine.radial / self._size,
                machine.cradle_angle,
                machine.ratio_of_roll,
                machine.machining_offset / self._size,
                machine.machine_centre_to_back / self._size,
                blade.blade_angle,
                self.blank.cutter_radius / self._size,
                0.0,
            ]
        )

    def _side(self, x: Array) -> Generated:
        """Return the side of the unknowns (8,)."""
        radial, cradle_angle, ratio, offset, centre, angle, radius, _ = (float(value) for value in x)
        nominal, size = self._nominal, self._size
        machine = replace(
            nominal.settings,
            radial=radial * size,
            cradle_angle=cradle_angle,
            ratio_of_roll=ratio,
            machining_offset=offset * size,
            machine_centre_to_back=centre * size,
        )
        curved = self.design.pinion.side(self.name).blade_radius
        blade = Blade.through(nominal.blade.side, radius * size, self._height, angle, 0.0, curved)
        index = indexing(self.design, self.blank, self.blank.pinion, nominal.hand, radius * size)
        return replace(nominal, settings=machine, blade=blade, indexing=index)

    def _residual(self, x: Array) -> Array:
        """Return the residuals (8,) of point, normal and operator."""
        side, point, size = self._side(x), self.mean[0], self._size
        at = np.array([side.blade.at_height(self._height)]), x[7:]
        batch = side.envelope(side.blade.flank).jet(*at)
        jet = Jet(*(values[0] for values in (batch.r, batch.n, batch.r_u, batch.r_v, batch.n_u, batch.n_v)))
        e1, e2 = self._tangents
        along = e1 - jet.n * (jet.n @ e1)
        along /= np.sqrt(along @ along)
        k = shape_operator(jet, along, np.cross(jet.n, along)) - np.array(
            [[e1 @ self.operator @ e1, e1 @ self.operator @ e2], [e2 @ self.operator @ e1, e2 @ self.operator @ e2]]
        )
        return np.array(
            [*(jet.r - point) / size, jet.n @ e1, jet.n @ e2, k[0, 0] * size, k[0, 1] * size, k[1, 1] * size]
        )

    @cached_property
    def _tangents(self) -> tuple[Array, Array]:
        """Orthonormal tangents (3,) at the mean point."""
        normal = self.mean[1]
        e1 = np.cross(normal, [0.0, 0.0, 1.0])
        e1 /= np.sqrt(e1 @ e1)
        return e1, np.cross(normal, e1)
