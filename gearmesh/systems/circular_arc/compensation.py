"""Settings that bring the contact of misassembled circular-arc gears back [LT85 33-37].

A changed centre distance moves the contact along the profile, made good by the pinion rack's setting b_F (33)-(36);
misaligned axes give a transmission error that grows with phi1, made good by the pinion's lead angle. The paper's formulas
are first approximations; here both are solved for on the exact contact.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.flanks import analyse
from gearmesh.contact.path import ARCSEC, ContactPath
from gearmesh.errors import NoSolutionError
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array
from gearmesh.systems.circular_arc.build import build
from gearmesh.systems.system import Setting

if TYPE_CHECKING:
    from gearmesh.systems.circular_arc.design import CircularArcDesign

#: pinion rotations (rad) between which the slope of the transmission error is taken
SLOPE_RANGE = np.radians((-5.0, 5.0))
#: contact angle (rad) and slope of the transmission error that count as restored, and the step of difference quotients
RESTORED, STEP = 1e-10, 1e-5


def compensate(design: CircularArcDesign) -> list[Setting]:
    """The pinion's b_F and lead angle that make good the assembly errors of a design.

    Raises NoSolutionError where no setting restores the contact.
    """
    nominal = np.radians(design.pressure_angle)
    values = {"pinion.b": design.pinion.b, "pinion.lead_angle": design.pinion.lead_angle}

    def errors(trial: dict[str, float]) -> Array:
        path = _contact(design.with_values(trial))
        slope = (path.te[2] - path.te[0]) / np.ptp(SLOPE_RANGE)
        return np.array([path.params1[1, 0] - nominal, slope])

    before = errors(values)
    wanted = {"pinion.b": design.assembly.dC != 0.0, "pinion.lead_angle": design.assembly.dgamma != 0.0}
    solved = _solve(errors, values, [key for key, needed in wanted.items() if needed])
    after = errors(solved)
    effects = {
        "pinion.b": "theta_F at phi1 = 0 from {:.4f} to {:.4f} deg".format(
            *np.degrees(nominal + np.array([before[0], after[0]]))
        ),
        "pinion.lead_angle": "TE per degree of phi1 from {:.5f} to {:.5f} arcsec".format(
            *(np.radians(1.0) / ARCSEC * np.array([before[1], after[1]]))
        ),
    }
    units = {"pinion.b": design.units, "pinion.lead_angle": "deg"}
    return [Setting(key, values[key], solved[key], units[key], effects[key]) for key in values]


def _contact(design: CircularArcDesign) -> ContactPath:
    path = analyse(build(design.in_mm()).pairs[0], np.array([SLOPE_RANGE[0], 0.0, SLOPE_RANGE[1]]))
    if (path.kind != "point").any():
        raise NoSolutionError(
            "the contact leaves the flanks, so its place cannot be compensated: reduce the assembly errors"
        )
    return path


def _solve(errors: Callable[[dict[str, float]], Array], values: dict[str, float], free: list[str]) -> dict[str, float]:
    """Newton with difference quotients on the settings `free`: the contact itself is solved exactly at every trial."""
    if not free:
        return values
    rows = [list(values).index(key) for key in free]

    def with_free(x: Array) -> dict[str, float]:
        return {**values, **{key: float(value) for key, value in zip(free, x, strict=True)}}

    def residual(x: Array, _: NDArray[np.intp]) -> tuple[Array, Array]:
        at = x[0]
        f = errors(with_free(at))[rows]
        steps = np.diag(STEP * np.maximum(1.0, np.abs(at)))
        columns = [(errors(with_free(at + step))[rows] - f) / step.sum() for step in steps]
        return f[None], np.stack(columns, axis=-1)[None]

    found = newton.solve(residual, np.array([[values[key] for key in free]]), tolerance=RESTORED)
    if not found.converged[0]:
        raise NoSolutionError(f"no value of {' and '.join(free)} restores the contact: reduce the assembly errors")
    return with_free(found.values[0])
