"""The worm over wires: three wires between parallel anvils, each in a space along the threads.

A free wire turns until it has no moment about the radius through the middle of the space. The normals of both points of
contact then intersect on the wire's axis at this radius. The wire touches at the same points as a ball of its
diameter. For both M = 2 x + D, with the ball's centre at the radius x in the middle of the space. The flank's parallel
surface at D / 2 is the helicoid that the curve c + n D / 2 sweeps.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.envelope.helicoid import half_plane
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.records import dataclass
from gearmesh.systems.common.symbol_table import Missing, Row
from gearmesh.systems.worm_drive.build import worm_thread
from gearmesh.systems.worm_drive.thread import WormThread

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign

#: reason of a missing measure
NO_WIRE = "no wire or ball touches both flanks of the space, stands out of it and clears its ground"


def flank_radius(design: WormDriveDesign, thread: WormThread) -> float:
    """Return the radius (mm) at which the flanks of a worm's thread begin, beyond the rounding of its root."""
    spec, m = design.worm, design.axial_module
    rounding = thread.root_rounding(thread.radius - spec.dedendum * m, spec.root_rounding * m)
    curve = thread.section.curve.at(np.array(rounding.form_point[0]))
    return float(np.hypot(curve.c[0], curve.c[1]))


@dataclass(frozen=True)
class Wires:
    """Wires in the spaces of a thread."""

    #: diameter of the wires, mm
    diameter: float
    #: radius of their centres, mm
    centre: float
    #: radius of their points of contact, mm
    contact: float

    @property
    def over(self) -> float:
        """Measure over the wires, mm."""
        return 2.0 * self.centre + self.diameter


def _parallel(thread: WormThread, p: Array, radius: Array) -> tuple[Array, Array]:
    """Radii (N,) of the flank at p, and the points (N, 2), x and z, at `radius` (N,) over it in the axial section."""
    jet = thread.section.jet(p, np.zeros_like(p))
    points, _ = half_plane(jet.r + radius[:, None] * jet.n, jet.n, thread.screw)
    return np.hypot(jet.r[:, 0], jet.r[:, 1]), points


def wires_at(thread: WormThread, radius: float) -> Wires:
    """Return the wires that touch the flanks at a radius (mm); NaN if there are none."""
    p = np.array([thread.at_radius(radius)])

    def miss(half: Array, index: NDArray[np.intp]) -> Array:
        return np.asarray(_parallel(thread, p[index], half)[1][:, 1] - 0.5 * thread.axial_pitch)

    half = bracketed_root(miss, np.zeros(1), np.full(1, thread.axial_pitch)).values
    centre = float(_parallel(thread, p, half)[1][0, 0])
    return Wires(2.0 * float(half[0]), centre, radius)


def wires_of(thread: WormThread, diameter: float, radii: tuple[float, float]) -> Wires | None:
    """Return the wires of a diameter (mm) that touch the flanks between two radii (mm), or None."""
    ends = np.array([thread.at_radius(radius) for radius in radii])
    half = np.array([0.5 * diameter])

    def miss(p: Array, _: NDArray[np.intp]) -> Array:
        return np.asarray(_parallel(thread, p, half)[1][:, 1] - 0.5 * thread.axial_pitch)

    root = bracketed_root(miss, ends[:1], ends[1:])
    if not root.converged.all():
        return None
    contact_radii, points = _parallel(thread, root.values, half)
    return Wires(diameter, float(points[0, 0]), float(contact_radii[0]))


def over_balls(
    flanks: tuple[WormThread, WormThread], diameter: float, pitch: float, radii: tuple[float, float]
) -> float:
    """Return the measure (mm) over two balls between flanks of two leads; NaN if they do not touch.

    - `flanks`: threads of both leads
    - `diameter`: diameter of the balls, mm
    - `pitch`: distance of the middles of both threads beside the balls, if each had the thickness in the middle of the
      worm, mm
    - `radii`: radii between which the balls touch, mm
    """
    half = np.array([0.5 * diameter])

    def at_centre(thread: WormThread, x: Array) -> tuple[Array, Array]:
        """Return parameters (N,) of contact for centres at radii x (N,), and distances (N,) from the thread's middle."""
        ends = [np.full(x.shape, thread.at_radius(radius)) for radius in radii]
        halves = np.full(x.shape, half[0])
        root = bracketed_root(lambda p, k: _parallel(thread, p, halves[k])[1][:, 0] - x[k], *ends)
        p = np.where(root.converged, root.values, np.nan)
        return p, _parallel(thread, p, halves)[1][:, 1]

    def miss(x: Array, _: NDArray[np.intp]) -> Array:
        return np.asarray(sum(at_centre(thread, x)[1] for thread in flanks) - pitch)

    # range of the centre in which the ball can touch both flanks between the radii
    reach = np.array(
        [
            [_parallel(thread, np.array([thread.at_radius(radius)]), half)[1][0, 0] for radius in radii]
            for thread in flanks
        ]
    )
    inside = 1e-9 * np.ptp(reach)
    centre = bracketed_root(miss, np.array([reach[:, 0].max() + inside]), np.array([reach[:, 1].min() - inside]))
    return 2.0 * float(centre.values[0]) + diameter if centre.converged.all() else math.nan


def wire_rows(design: WormDriveDesign) -> list[Row]:
    """Return the rows of the design's wires, or of wires that touch the nominal thread on the reference cylinder.

    Raises DesignError for a wire that does not touch the flanks, does not project from the space or touches its ground.
    """
    thread, spec, m = worm_thread(design), design.worm, design.axial_module
    tip, root = thread.radius + spec.addendum * m, thread.radius - spec.dedendum * m
    flank = (flank_radius(design, thread), tip)
    if spec.wire_diameter is None:
        wires: Wires | None = wires_at(thread, thread.radius)
    else:
        wires = wires_of(thread, spec.wire_diameter, flank)
        if wires is None or wires.over < 2.0 * tip or wires.centre - 0.5 * wires.diameter < root:
            fit = [
                at for at in (wires_at(thread, radius) for radius in np.linspace(*flank, 65)) if at.over >= 2.0 * tip
            ]
            fit = [at for at in fit if at.centre - 0.5 * at.diameter >= root]
            raise DesignError(
                "worm.wire_diameter",
                spec.wire_diameter,
                unit="mm",
                reason="does not touch both flanks of a space, or does not stand out of it",
                allowed=Allowed.from_to(fit[0].diameter, fit[-1].diameter, "mm") if fit else "none, no wire does",
            )
    fits = wires is not None and wires.over >= 2.0 * tip and wires.centre - 0.5 * wires.diameter >= root
    none = Missing(NO_WIRE)
    given = (wires.diameter, wires.over, 2.0 * wires.contact) if wires is not None and fits else (none,) * 3
    return [
        ("D_M", "diameter of the wires", "mm", (given[0],)),
        ("M_d", "diameter over three wires or two balls", "mm", (given[1],)),
        ("d_MK", "diameter where wires or balls touch", "mm", (given[2],)),
    ]
