"""Displacements that restore uniform transmission of a conjugate pair with a shaft angle error [CR3553 3.5.28-3.5.35].

The pinion moves across both axes and along the pitch line until the error of phi2 at the mean point and its slope are
0. The source gives the displacements to first order (`kinematic_errors.compensation`). Here they are solved on the
exact contact.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.records import dataclass
from gearmesh.systems.common.restoring import restoring
from gearmesh.systems.spiral_bevel.conjugate.build import build, conjugate_blank, conjugate_geometry
from gearmesh.systems.spiral_bevel.errors.kinematic_errors import compensation
from gearmesh.systems.spiral_bevel.machine.pair import HAND_SIGNS, displaced_frames, without_errors
from gearmesh.systems.system import Setting

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.conjugate.design import ConjugateDesign

#: pinion rotations (rad) between which the slope of the transmission error is computed
SLOPE_RANGE = np.radians((-0.5, 0.5))


def compensate(design: ConjugateDesign) -> list[Setting]:
    """Assembly displacements dV, dA and dG that restore phi2 and its slope at the mean point of the design's side.

    Raises NoSolutionError if no displacements do.
    """
    design_mm = design.in_mm()
    blank = conjugate_blank(design_mm)
    aligned = solver_pair(build(design_mm.with_values(without_errors(design_mm))).pairs[0])
    turn = np.array([SLOPE_RANGE[0], 0.0, SLOPE_RANGE[1]])
    aligned_phi2 = _touching(aligned, turn)
    assembly = design_mm.assembly

    def displacements_of(values: dict[str, float]) -> dict[str, float]:
        """Return dV, dA and dG (mm) for displacements of the pinion across both axes and along the pitch line."""
        axial = _along_the_axes(blank, values["along"])
        return {"dV": values["across"], "dA": assembly.dA + axial["dA"], "dG": assembly.dG + axial["dG"]}

    def errors(values: dict[str, float]) -> Array:
        """Return the error of phi2 (rad) at the mean point, and its slope."""
        displaced = design_mm.with_values({f"assembly.{key}": value for key, value in displacements_of(values).items()})
        pinion, gear = (
            flank.remount(replace(flank.mount, base=base))
            for flank, base in zip(aligned.flanks, displaced_frames(displaced, blank), strict=True)
        )
        error = _touching(replace(aligned, pinion=pinion, gear=gear), turn) - aligned_phi2
        return np.array([error[1], (error[2] - error[0]) / np.ptp(SLOPE_RANGE)])

    first_order = _first_order(design_mm, blank)
    start = {"across": first_order.across, "along": first_order.along}
    # Newton steps from the first-order displacements
    solved = restoring(errors, start, list(start))
    before, after = (
        errors(displacements) / ARCSEC for displacements in ({"across": assembly.dV, "along": 0.0}, solved)
    )
    effects = {
        "dV": f"error of phi2 at the mean point from {before[0]:.3f} to {after[0]:.3f} arcsec",
        "dA": "its slope from {:.4f} to {:.4f} arcsec per degree".format(*np.radians((before[1], after[1]))),
        "dG": "with dA, along the pitch line",
    }
    values, unit, forms = displacements_of(solved), design.mm_per_unit, first_order.displacements
    return [
        Setting(
            f"assembly.{key}",
            getattr(design.assembly, key),
            values[key] / unit,
            design.units,
            f"{effect}; against d_delta alone by ({first_order.source}) {forms[key] / unit:.6g}",
        )
        for key, effect in effects.items()
    ]


@dataclass(frozen=True)
class FirstOrder:
    """Displacements of the pinion to first order."""

    #: numbers of the equations in [CR3553]
    source: str
    #: displacement across both axes, mm
    across: float
    #: displacement along the pitch line, to the heel, mm
    along: float
    #: the same displacement as dV, dA and dG, mm
    displacements: dict[str, float]


def _first_order(design: ConjugateDesign, blank: BevelBlank) -> FirstOrder:
    """Return the displacements that compensate the d_delta of a design in mm, to first order."""
    geometry = conjugate_geometry(design, blank, design.contact.pinion_side)
    cradle = None if np.isinf(geometry.rho) else geometry.setting(geometry.r_k)[1]
    closed = -float(np.radians(design.assembly.d_delta))
    across, along = compensation(geometry.spiral_angle, geometry.psi_c, geometry.cone_distance, closed, cradle)
    # the closed form is for a left-hand pinion
    across *= -HAND_SIGNS[design.hand]
    source = "3.5.28, 29" if cradle is None else "3.5.34, 35"
    return FirstOrder(source, across, along, {"dV": across, **_along_the_axes(blank, along)})


def _along_the_axes(blank: BevelBlank, along: float) -> dict[str, float]:
    """Return dA and dG (mm) that together displace the pinion along the pitch line, to the heel."""
    share = along / np.sin(blank.shaft_angle)
    return {"dA": float(share * np.sin(blank.gear.pitch_angle)), "dG": float(-share * np.sin(blank.pinion.pitch_angle))}


def _touching(pair: Pair, turn: Array) -> Array:
    """Return phi2 (N,) of the contact inside both flanks at rotations (N,).

    Raises NoSolutionError where there is no contact.
    """
    path = contact_path(pair, turn, edges=False)
    if (path.kind != "point").any():
        raise NoSolutionError(
            reason="the contact leaves the flanks, so it cannot be compensated", remedy="reduce the assembly errors"
        )
    return path.phi2
