"""Machine settings that give the contact asked for, and that restore it in a misassembled pair.

Spiral bevel gears: local synthesis anew, with the gear where the assembly errors put it [AB; CR3553 3.5]. Path, ellipse and
parabola that the pair has when it stands right come back at the same point of the gear.
Circular-arc gears [LT85]: a changed centre distance moves the contact along the profile, made good by the pinion
rack's setting b_F (33)-(36); misaligned axes give a transmission error that grows with phi1, made good by the pinion's
lead angle. The paper's formulas are first approximations; here both are solved for on the exact contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.flanks import analyse, solver_pair
from gearmesh.contact.path import ARCSEC, ContactPath
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import AXIS, Array
from gearmesh.kernel.curvature import shape_operator, tangent_basis
from gearmesh.kernel.rigid import Rigid
from gearmesh.kernel.surface import Jet
from gearmesh.systems import build
from gearmesh.systems.spiral_bevel.local_synthesis import MeanContact, contact_of
from gearmesh.systems.spiral_bevel.pair import HANDS, SIDES, displaced
from gearmesh.systems.spiral_bevel.settings import (
    SYNTHESISED,
    basic_blank,
    contact_at,
    mean_contact,
    pinion_values,
    synthesised,
)

#: pinion rotations (rad) between which the slope of the transmission error is taken
SLOPE_RANGE = np.radians((-5.0, 5.0))
#: contact angle (rad) and slope of the transmission error that count as restored, and the step of difference quotients
RESTORED, STEP = 1e-10, 1e-5


@dataclass(frozen=True)
class Setting:
    """A key of the design, its value before and after in the design's units, and what the change does."""

    key: str
    before: float
    after: float
    unit: str
    effect: str


Changed = Callable[[Any, dict[str, Any]], Any]


def compensate(design: Any, changed: Changed) -> list[Setting]:
    """Settings that bring the contact of a misassembled pair back to where it was designed.

    `changed(design, {key: value})` returns the design with other values, in its own units.
    Raises DesignError for kinds without such settings, NoSolutionError where no setting restores the contact.
    """
    if design.kind not in COMPENSATIONS:
        allowed = " or ".join(COMPENSATIONS)
        raise DesignError(f"kind = {design.kind}: has no compensating settings; allowed is {allowed}")
    return COMPENSATIONS[design.kind](design, changed)


def _spiral_bevel(design: Any, changed: Changed) -> list[Setting]:
    """Both sides of the pinion, settings of each for the gear where it stands."""
    own = design.in_mm()
    blank = basic_blank(own)
    first, second = displaced(own, blank.shaft_angle)
    ratio, unit = blank.pinion.teeth / blank.gear.teeth, design.mm_per_unit
    aligned = {f"assembly.{key}": 0.0 for key in type(design.assembly).model_fields}
    rows = []
    for name in SIDES:
        gears = build(changed(design, {**aligned, "contact.side": f"pinion_{name}"}))
        path = analyse(gears, np.zeros(1))
        if path.kind[0] != "point":
            raise NoSolutionError(
                f"the aligned pair does not touch at the mean point of pinion.{name}: check its settings"
            )
        sides = solver_pair(gears).flanks
        at = [side.surface.jet(p[:, 0], p[:, 1]) for side, p in zip(sides, (path.params1, path.params2), strict=True)]
        at = [
            jet.moved(side.mount.at(turn))
            for jet, side, turn in zip(at, sides, (path.rotation, path.phi2), strict=True)
        ]
        pinion, gear = (_single(jet) for jet in at)
        base = gears.assembly.gear.base
        nominal = _as_it_touches(gear, base, HANDS[own.hand])
        e1, e2 = tangent_basis(pinion)
        basis = np.stack((e1, e2))
        asked = contact_of(basis.T @ shape_operator(pinion, e1, e2) @ basis, nominal, own.contact.delta)
        # the gear as it meets the aligned pinion has not far to turn to meet the misaligned one
        standing = mean_contact(gear.moved(base.inverse), first.inverse @ second, HANDS[own.hand], ratio)[1]
        before = pinion_values(own, blank, name, nominal)
        after = synthesised(own, blank, name, standing, asked)
        for key in (*SYNTHESISED, *(["blade_height"] if getattr(own.pinion, name).blade_radius else [])):
            length = key not in ("cradle_angle", "ratio_of_roll", "blade_angle")
            scale = unit if length else 1.0
            noun = "" if key == "ratio_of_roll" else design.units if length else "deg"
            effect = f"path {np.degrees(asked.path_angle):.4g} deg, ellipse {2.0 * asked.semi_major_axis:.4g} mm long"
            rows.append(Setting(f"pinion.{name}.{key}", before[key] / scale, after[key] / scale, noun, effect))
    return rows


def _as_it_touches(gear: Jet, base: Rigid, sense: int) -> MeanContact:
    """The gear at its actual contact, with the ratio that it has there: n . v12 = 0."""
    axis, origin = base.rotation[:, 2], base.translation
    first = gear.n @ np.cross(AXIS, gear.r)
    second = gear.n @ np.cross(-axis, gear.r - origin)
    return contact_at(gear, axis, origin, sense, float(first / second))


def _single(jet: Jet) -> Jet:
    """The jet of one point out of a batch of one."""
    return Jet(*(getattr(jet, name)[0] for name in ("r", "n", "r_u", "r_v", "n_u", "n_v")))


def _circular_arc(design: Any, changed: Changed) -> list[Setting]:
    """[LT85 33-37]: the pinion's b_F and lead angle."""
    nominal = np.radians(design.pressure_angle)
    values = {"pinion.b": design.pinion.b, "pinion.lead_angle": design.pinion.lead_angle}

    def errors(trial: dict[str, float]) -> np.ndarray:
        path = _contact(changed(design, trial))
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


def _contact(design: Any) -> ContactPath:
    path = analyse(build(design), np.array([SLOPE_RANGE[0], 0.0, SLOPE_RANGE[1]]))
    if (path.kind != "point").any():
        raise NoSolutionError(
            "the contact leaves the flanks, so its place cannot be compensated: reduce the assembly errors"
        )
    return path


def _solve(
    errors: Callable[[dict[str, float]], np.ndarray], values: dict[str, float], free: list[str]
) -> dict[str, float]:
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


#: kind of a design -> its compensation
COMPENSATIONS = {"circular_arc": _circular_arc, "spiral_bevel": _spiral_bevel}
