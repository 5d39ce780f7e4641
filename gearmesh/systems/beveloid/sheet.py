"""The data sheet of a beveloid pair: the common tables, and both sides of asymmetric teeth in closed form.

Each side of an asymmetric tooth is an involute of its own base circle. Sums over both sides replace twice the value of
symmetric teeth.

    sum inv(alpha_wt) = sum inv(alpha_t) + 2 (x1 + x2) / (z1 + z2) sum tan(alpha_n)                working pressure angles
    sum inv(alpha_K) = sum (inv(alpha_t) + psi + D / d_b / cos(beta_b)) - 2 pi / z                 centre of a ball

The first equation holds without backlash. psi is the angle from the tooth's middle to its flank on the reference circle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.metrology.iso1328 import TOLERANCE_NAMES, CylindricalSizes
from gearmesh.records import dataclass
from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.racks.rack_tooth import tip_roundings
from gearmesh.systems.common.symbol_table import Missing, Row, Values, table
from gearmesh.systems.system import Sheet, SheetTable, complete_design
from gearmesh.teeth.gear_train import GearTrain

if TYPE_CHECKING:
    from gearmesh.systems.beveloid.design import BeveloidDesign, BeveloidMember

#: diameter of the ball of the sheet, in normal modules
BALL_MODULES = 1.75
#: largest radius of a ball's centre that is searched, in reference radii
MAX_CENTRE_RADII = 3.0
#: value of a span
NO_SPAN = Missing("the flanks of both sides are involutes of different base circles: no parallel planes touch them")
#: tolerance class of conical members
NO_CONES = Missing("ISO 1328-1 is for cylindrical gears: cone angle 0")
#: value of measures of conical and internal members
NOT_MEASURED = Missing("is given for external members of cone angle 0")


def beveloid_sheet(design: BeveloidDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a design and the pair built from it."""
    own = complete_design(design).in_mm()
    made = plain_sheet(own, train)
    first, *others = made.tables
    sides = (_sides(own),) if own.asymmetric else ()
    tolerances = () if own.accuracy_class is None else (_tolerances(own, own.accuracy_class),)
    return Sheet((first, *sides, *others, *tolerances), {})


def _tolerances(design: BeveloidDesign, grade: int) -> SheetTable:
    """Return the table of the flank tolerances of both members in a tolerance class."""
    members = {"pinion": design.pinion, "gear": design.gear}
    limits = []
    for spec in members.values():
        helix = math.radians(spec.helix_angle)
        diameter = spec.teeth * design.given_module / math.cos(helix)
        sizes = CylindricalSizes(spec.teeth, design.given_module, diameter, spec.face_width, helix)
        limits.append(None if spec.cone_angle else sizes.tolerances(grade) or {})
    rows: list[Row] = [
        ("A", "flank tolerance class", "-", tuple(NO_CONES if of is None else grade for of in limits)),
        *(
            (symbol, words, "um", tuple(None if of is None else of.get(symbol) for of in limits))
            for symbol, words in TOLERANCE_NAMES.items()
        ),
    ]
    return table("Flank tolerances [ISO 1328-1:2013]", tuple(members), rows)


def _sides(design: BeveloidDesign) -> SheetTable:
    """Return the table of both sides of the teeth of both members."""
    members = ("pinion", design.pinion), ("gear", design.gear)
    sides = [AsymmetricTeeth.of(design, name, spec) if spec.cone_angle == 0.0 else None for name, spec in members]
    columns = tuple(f"{name}, {side}" for name, _ in members for side in ("right", "left"))

    def of_sides(value: Callable[[AsymmetricTeeth], Array]) -> Values:
        """Return a value for each side of each member."""
        return tuple(
            entry for teeth in sides for entry in ((None, None) if teeth is None else map(float, value(teeth)))
        )

    angles = [angle for name, _ in members for angle in design.pressure_angles(name)]
    drive = [name == "pinion" or not crosswise for name in ("pinion", "gear") for crosswise in [design.crosswise]]
    words = [("drive", "coast") if straight else ("coast", "drive") for straight in drive]
    over = tuple(
        value
        for teeth, (_, spec) in zip(sides, members, strict=True)
        for value in ((NOT_MEASURED, None) if teeth is None or spec.internal else (teeth.over_balls, None))
    )
    rows: list[Row] = [
        ("side", "side of the teeth", "", tuple(word for pair in words for word in pair)),
        ("alpha_n", "normal pressure angle", "deg", tuple(angles)),
        ("alpha_t", "transverse pressure angle", "deg", of_sides(lambda teeth: np.degrees(teeth.alpha_t))),
        ("d_b", "base diameter", "mm", of_sides(lambda teeth: 2.0 * teeth.base)),
        ("beta_b", "base helix angle", "deg", of_sides(lambda teeth: np.degrees(teeth.base_helix))),
        (
            "s_n/2",
            "normal thickness at the reference cylinder, from the middle of the rack's space",
            "mm",
            of_sides(lambda teeth: teeth.half_thickness),
        ),
        (
            "rho_fP",
            "tip rounding of the rack; of an internal gear its root fillet, transverse",
            "m_n",
            tuple(
                rounding.modules
                for name, spec in members
                for rounding in tip_roundings(spec, design.coast_flanks(name))
            ),
        ),
        ("W_k", "span", "mm", (NO_SPAN, None, NO_SPAN, None)),
        ("D_M", "ball", "mm", (BALL_MODULES * design.given_module, None) * 2),
        ("M_dK", "over balls", "mm", over),
    ]
    return table("Sides of asymmetric teeth", columns, rows)


@dataclass(frozen=True)
class AsymmetricTeeth:
    """Teeth of a member of cone angle 0; arrays (2,) are of its right and left side."""

    #: number of teeth
    teeth: int
    #: normal module, mm
    module: float
    #: radius of the reference cylinder, mm
    radius: float
    #: transverse pressure angles, rad
    alpha_t: Array
    #: helix angles at the base cylinders, rad
    base_helix: Array
    #: normal thickness at the reference cylinder from the middle of the rack's space, mm
    half_thickness: Array
    #: helix angle, rad
    helix: float

    @staticmethod
    def of(design: BeveloidDesign, name: str, spec: BeveloidMember) -> AsymmetricTeeth:
        """Return the teeth of a member as made."""
        alpha, beta = np.radians(design.pressure_angles(name)), math.radians(spec.helix_angle)
        m = design.given_module
        half = (0.25 * math.pi + spec.profile_shift * np.tan(alpha)) * m - design.reduction
        return AsymmetricTeeth(
            teeth=spec.teeth,
            module=m,
            radius=0.5 * spec.teeth * m / math.cos(beta),
            alpha_t=np.arctan(np.tan(alpha) / math.cos(beta)),
            base_helix=np.arcsin(math.sin(beta) * np.cos(alpha)),
            half_thickness=half,
            helix=beta,
        )

    @property
    def base(self) -> Array:
        """Base radii, mm."""
        return np.asarray(self.radius * np.cos(self.alpha_t))

    def centre_radius(self, diameter: float) -> float:
        """Return the radius of the centre of a ball that touches both flanks of a space; NaN if there is none, mm."""
        psi = self.half_thickness / math.cos(self.helix) / self.radius
        ball = 0.5 * diameter / self.base / np.cos(self.base_helix)
        wanted = float((involute(self.alpha_t) + psi + ball).sum()) - 2.0 * math.pi / self.teeth

        def excess(radius: Array, _: NDArray[np.intp]) -> Array:
            pressure = np.arccos(self.base / np.asarray(radius)[..., None])
            return np.asarray(involute(pressure).sum(axis=-1) - wanted)

        low = np.array([float(self.base.max())])
        root = bracketed_root(excess, low, np.array([MAX_CENTRE_RADII * self.radius]))
        return float(root.values[0]) if root.converged[0] else math.nan

    @property
    def over_balls(self) -> float | Missing:
        """Dimension M_dK over two balls, mm."""
        diameter = BALL_MODULES * self.module
        radius = self.centre_radius(diameter)
        if math.isnan(radius):
            return Missing("no such ball touches both flanks")
        odd = math.cos(0.5 * math.pi / self.teeth) if self.teeth % 2 else 1.0
        return 2.0 * radius * odd + diameter


def involute(angle: Array) -> Array:
    """Return inv(angle) = tan(angle) - angle [ISO 21771]."""
    return np.asarray(np.tan(angle) - angle)
