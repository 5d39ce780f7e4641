"""Settings of one side of the pinion whose flank has a requested ease-off over the whole active flank.

The ease-off is the material that is missing on the pinion, along the normal, against the flank that is conjugate to the
gear's flank. The requested ease-off is a polynomial in the coordinates of the active flank (`conjugate.flank`):

    e = pressure_angle y + spiral_angle x + profile_crowning y^2 + length_crowning x^2 + twist x y

1. Local synthesis gives the settings with the point, normal and curvatures of this ease-off in the middle of the flank.

2. From there the free settings are found by least squares over a grid, in steps within a trust region [Artoni,
Gabiccini & Guiggiani, J. Mech. Des. 130 (2008) 112602]. The five parameters have more weight than the residual
topography, which is of higher order. Distance of the settings from the start has a small weight, because some
combinations of settings change the flank very little.

3. If the residual is too large, modified roll is added to the unknowns, unless the design gives it.

A change of a setting moves a point of an envelope along the normal by the same amount as the tool's point that
generates it. The derivatives of the ease-off therefore need no solving.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.figures import Figures, figure
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, cross, dot, unit
from gearmesh.kernel.surface.stations import follow
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.blank import BevelBlank
from gearmesh.systems.spiral_bevel.conjugate.flank import ActiveFlank, ConjugateFlank
from gearmesh.systems.spiral_bevel.design import EASE_OFF_KEYS, SYNTHESISED_KEYS, PinionSide
from gearmesh.systems.spiral_bevel.machine.motions import given_roll
from gearmesh.systems.spiral_bevel.machine.pair import HAND_SIGNS, MATING_SIDES, nominal_base
from gearmesh.systems.spiral_bevel.synthesis.local_synthesis import MeanContact, conjugate_operator
from gearmesh.systems.spiral_bevel.synthesis.settings import (
    ContactChoice,
    FlankForm,
    contact_asked,
    gear_sides,
    mean_point,
    side_of,
    synthesise,
    tool_values,
)

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import EaseOffTable, FaceMilledDesign

#: weight of a parameter over the weight of a point of the grid
PARAMETER_WEIGHT = 30.0
#: residual (mm) of a setting that differs from its start by a mean cone distance, 1 rad or 1
SETTING_WEIGHT_MM = 0.03
#: residual topography over the largest requested ease-off above which there is a warning
WARNED_RESIDUAL_SHARE = 0.1
#: residual topography (mm) up to which there is no warning
WARNED_RESIDUAL_MM = 1e-3
#: residual topography over the largest requested ease-off above which modified roll is used
ROLL_RESIDUAL_SHARE = 0.03
#: residual topography (mm) up to which modified roll is not used
ROLL_RESIDUAL_MM = 3e-4
#: orders of modified roll that are unknowns; higher orders reduce the residual very little
ROLL_ORDERS = (2, 3)
#: relative change of the sum of squares at which least squares stop: nearly dependent settings leave a flat valley
COST_TOLERANCE = 1e-2
#: largest number of evaluations at first, and to turn the flank clear
FEW_EVALUATIONS = 12
#: largest number of evaluations with modified roll
MANY_EVALUATIONS = 30
#: Newton steps from the last point of the pinion on a conjugate's normal to the next
NEWTON_STEPS = 2
#: Newton steps to the first point of the pinion on a conjugate's normal
FIRST_NEWTON_STEPS = 6
#: largest distance (mean normal modules) of such a point from the normal
MAX_NORMAL_MISS_MODULES = 1e-3
#: step of the differences by settings, over the changes that have equal weight
SETTING_STEP = 1e-6
#: step of the differences along the flank, in mean normal modules
FLANK_STEP_MODULES = 0.02
#: largest height (mm) of a flank over its conjugate, at which it would not yet jam without backlash
MAX_PROJECTION_MM = 2e-5
#: least share of the grid that has a flank
MIN_GRID_SHARE = 0.6


def form_choice(design: FaceMilledDesign, blank: BevelBlank, name: str, target: EaseOffTable) -> ContactChoice:
    """Return the choice of the pinion's side `name` of a design in mm with the ease-off `target`.

    Its mean point is in the middle of the active flank; its `form` has the settings. Raises NoSolutionError if no
    settings give the ease-off at the mean point.
    """
    conjugate = ConjugateFlank.of(design, blank, name)
    wanted = np.array([getattr(target, key) for key in EASE_OFF_KEYS])
    at_middle = ContactChoice(
        contact_asked(design, blank, name),
        conjugate.height - 0.5 * blank.mean_depth,
        conjugate.station - blank.gear.mean_cone_distance,
    )
    gear, base = gear_sides(design, blank)[MATING_SIDES[name]], nominal_base(blank, HAND_SIGNS[design.hand])
    contact = mean_point(design, blank, gear, base, at_middle).contact
    start, spec = _start(design, blank, name, at_middle, contact, wanted), design.pinion.side(name)
    keys = tuple(key for key in SYNTHESISED_KEYS if getattr(spec, key) is None)
    exists = conjugate.exists
    least = float((terms(conjugate.along[exists], conjugate.up[exists]) @ wanted).min())
    # the flank is turned until its point with the least ease-off is on the conjugate flank
    fit = _Fit(design, blank, name, conjugate, wanted, start, given_roll(spec), exists, keys, -least).whole()
    # least squares, a second time with modified roll if the residual is too large
    form = fit.solve(MANY_EVALUATIONS if spec.gives_roll else FEW_EVALUATIONS)
    if form.rest_max > max(ROLL_RESIDUAL_SHARE * form.most, ROLL_RESIDUAL_MM) and not spec.gives_roll:
        fit = replace(fit, start=form.values, orders=ROLL_ORDERS)
        form = fit.solve(MANY_EVALUATIONS)
    # the residual topography projects somewhere: the flank is turned back by as much
    out = float(np.nanmin(form.reached)) + form.away
    if fit.turns and out < -MAX_PROJECTION_MM:
        form = replace(fit, start=form.values, roll=form.roll, away=fit.away - out).solve(FEW_EVALUATIONS)
    return ContactChoice(at_middle.asked, at_middle.height, at_middle.along, form=form)


def terms(x: Array, y: Array) -> Array:
    """Return the terms (..., 5) of the polynomial at coordinates x and y (...,), in the order of EASE_OFF_KEYS."""
    return np.stack((y, x, y * y, x * x, x * y), axis=-1)


@dataclass(frozen=True)
class FormFigures(Figures):
    """The ease-off that was reached, by its parameters, and the topography that is left."""

    ease_off_pressure_angle: float = figure("ease-off reached: pressure angle", "um")
    ease_off_spiral_angle: float = figure("ease-off reached: spiral angle", "um")
    ease_off_profile_crowning: float = figure("ease-off reached: profile crowning", "um")
    ease_off_length_crowning: float = figure("ease-off reached: lengthwise crowning", "um")
    ease_off_twist: float = figure("ease-off reached: twist", "um")
    ease_off_residual_max: float = figure("largest residual topography against the requested ease-off", "um")
    ease_off_residual_rms: float = figure("root mean square of the residual topography", "um")


def form_figures(form: FlankForm) -> FormFigures:
    """Return the reached parameters and the residual topography."""
    reached = {f"ease_off_{key}": 1e3 * value for key, value in form.parameters.items()}
    return FormFigures(
        **reached,
        ease_off_residual_max=1e3 * form.rest_max,
        ease_off_residual_rms=1e3 * float(np.sqrt(np.nanmean(form.residual**2))),
    )


def form_warnings(design: FaceMilledDesign, forms: dict[str, FlankForm | None]) -> Iterator[str]:
    """Yield the warnings on sides with too much residual topography."""
    for name, form in forms.items():
        if form is not None and form.rest_max > max(WARNED_RESIDUAL_SHARE * form.most, WARNED_RESIDUAL_MM):
            yield (
                f"{design.ease_off_key(name)}: the residual topography of pinion.{name} is up to {1e3 * form.rest_max:.3g} um, the "
                f"requested ease-off up to {1e3 * form.most:.3g} um; give fewer settings or a smaller ease-off"
            )


def _start(
    design: FaceMilledDesign, blank: BevelBlank, name: str, choice: ContactChoice, contact: MeanContact, wanted: Array
) -> dict[str, float]:
    """Return settings by key (mm, deg) whose flank has the ease-off to second order in the middle.

    Given settings remain.
    """
    active, r, n = ActiveFlank(blank), contact.point, contact.normal
    # slopes and second derivatives of the ease-off in the tangent plane, by central differences
    e1 = unit(cross(n, Z_AXIS))
    basis = np.stack((e1, cross(n, e1)))
    h = FLANK_STEP_MODULES * blank.mean_normal_module
    grid = h * np.array([[(s, t) for t in (-1, 0, 1)] for s in (-1, 0, 1)]) @ basis
    e = terms(*active.coordinates(r + grid)) @ wanted
    tilted = np.array([e[2, 1] - e[0, 1], e[1, 2] - e[1, 0]]) / (2.0 * h)
    mixed = 0.25 * (e[2, 2] - e[2, 0] - e[0, 2] + e[0, 0])
    bent = np.array([[e[2, 1] - 2.0 * e[1, 1] + e[0, 1], mixed], [mixed, e[1, 2] - 2.0 * e[1, 1] + e[1, 0]]]) / h**2
    # e is missing along n: the slopes of e tilt the normal, and its second derivatives change the shape operator
    operator = conjugate_operator(contact) - basis.T @ bent @ basis
    try:
        values = tool_values(design, blank, name, (r, unit(n + tilted @ basis)), operator)
    except NoSolutionError:
        values = synthesise(design, blank, name, contact, choice.asked)
    spec = design.pinion.side(name)
    given = {key: getattr(spec, key) for key in (*SYNTHESISED_KEYS, "blade_height") if getattr(spec, key) is not None}
    # the sliding base of a tilted cutter follows from the other settings
    base = values["sliding_base"] if spec.upright else spec.sliding_base
    return {**values, **given, "sliding_base": base}


@dataclass(frozen=True)
class _Fit:
    """Least squares for the settings of a side.

    Unknowns are changes of the settings `keys` and of modified roll of the `orders`, over the changes that have equal
    weight. The requested ease-off is 0 in the middle of the flank. The flank is turned about the pinion's axis until
    the ease-off there is `away`.
    """

    #: design in mm
    design: FaceMilledDesign
    #: blank of the pair
    blank: BevelBlank
    #: side of the pinion, "concave" or "convex"
    name: str
    #: conjugate flank of the side
    conjugate: ConjugateFlank
    #: requested parameters (5,) of the ease-off, mm
    parameters: Array
    #: settings at the start, by key (mm, deg)
    start: dict[str, float]
    #: coefficients of modified roll at the start, from the second order on
    roll: tuple[float, ...]
    #: True (I, J) for points of the grid that are used
    used: NDArray[np.bool_]
    #: keys of the settings that are free
    keys: tuple[str, ...]
    #: ease-off in the middle of the turned flank, mm
    away: float
    #: orders of modified roll that are free
    orders: tuple[int, ...] = ()

    def whole(self) -> _Fit:
        """Return the fit over the points that the flank has at the start. Raises NoSolutionError if they are few."""
        e = self.ease_off(self.cut(np.zeros(len(self.keys))), self.begin)[0]
        used = self.used.copy()
        used[used] = np.isfinite(e)
        if used.mean() < MIN_GRID_SHARE:
            raise self._nothing()
        return replace(self, used=used)

    def _nothing(self) -> NoSolutionError:
        """Return the error of an ease-off whose settings at the mean point generate no flank around it."""
        return NoSolutionError(
            self.design.ease_off_key(self.name),
            reason=f"settings that give it at the mean point generate no flank of pinion.{self.name} around that point; "
            "give a smaller ease-off, or fewer settings",
        )

    def solve(self, evaluations: int) -> FlankForm:
        """Return the form nearest to the requested ease-off. Raises NoSolutionError if there is no flank at the start."""
        from scipy.optimize import least_squares

        tried: dict[bytes, tuple[Envelope, Array, Array, Jet]] = {}
        at = self.begin

        def trial_at(q: Array) -> tuple[Envelope, Array, Array, Jet]:
            """Return the flank of unknowns q, its ease-off, parameters and jets."""
            if q.tobytes() not in tried:
                surface = self.cut(q)
                tried[q.tobytes()] = surface, *self.ease_off(surface, at)
            return tried[q.tobytes()]

        def residual(q: Array) -> Array:
            """Return the weighted residuals of unknowns q; NaN for settings that a design cannot have."""
            if not self._can_be(q):
                return np.full(len(self._rows) + len(q), np.nan)
            e = trial_at(q)[1]
            return np.concatenate(
                (self._rows @ (e - self._wanted_ease_off - self.away * self._turning), SETTING_WEIGHT_MM * q)
            )

        def derivatives(q: Array) -> Array:
            """Return the derivatives of the residuals; the points become the start of the next Newton steps."""
            nonlocal at
            surface, _, at, jet = trial_at(q)
            return np.concatenate((self._rows @ self._slopes(q, surface, at, jet), SETTING_WEIGHT_MM * np.eye(len(q))))

        zero = np.zeros(len(self.keys) + len(self.orders))
        with np.errstate(all="ignore"):
            if not np.isfinite(residual(zero)).all():
                raise self._nothing()
            fit = least_squares(
                residual, zero, derivatives, ftol=COST_TOLERANCE, xtol=None, gtol=None, max_nfev=evaluations
            )
            reached = trial_at(fit.x)[1]
        # turn and parameters that were reached, and the ease-off without the turn
        away, *five = self._polynomial @ reached
        grids = np.full((2, *self.used.shape), np.nan)
        grids[:, self.used] = self._wanted_ease_off, reached - away * self._turning
        values, roll = self._settings(fit.x)
        return FlankForm(
            values,
            roll,
            self.conjugate.along,
            self.conjugate.up,
            wanted=grids[0],
            reached=grids[1],
            away=float(away),
            parameters=dict(zip(EASE_OFF_KEYS, map(float, five), strict=True)),
        )

    def cut(self, q: Array) -> Envelope:
        """Return the flank with the settings of unknowns q (N,)."""
        values, roll = self._settings(q)
        side = side_of(self.design, self.blank, self.name, values, roll)
        # cutters of designs with an ease-off do not index
        return cast(Envelope, side.envelope(side.blade.flank))

    def ease_off(self, surface: Surface, at: Array, steps: int = NEWTON_STEPS) -> tuple[Array, Array, Jet]:
        """Ease-off (K,), mm, and parameters and jet of the surface's points on the normals of the conjugate flank.

        The points are found by Newton steps from the parameters `at` (K, 2). The ease-off is NaN where the surface is
        not near.
        """
        e1, e2 = self._across
        with np.errstate(all="ignore"):
            for _ in range(steps):
                jet = surface.jet(at[:, 0], at[:, 1])
                to_surface = self._r - jet.r
                # Newton step in the plane across the conjugate's normal
                f1, f2 = dot(to_surface, e1), dot(to_surface, e2)
                a, b, c, d = (dot(column, e) for e in (e1, e2) for column in (jet.r_u, jet.r_v))
                step = np.stack((d * f1 - b * f2, a * f2 - c * f1), axis=-1) / (a * d - b * c)[:, None]
                at = at + step
            jet = surface.jet(at[:, 0], at[:, 1])
            # orientation of the surface, whose sign tells folded parts from the flank
            area = dot(cross(jet.r_u, jet.r_v), jet.n)
            to_surface = self._r - jet.r
            # a remaining distance from the normal is corrected in the tangent plane
            e = dot(to_surface, jet.n) / dot(self._n, jet.n)
            near = (
                np.hypot(dot(to_surface, e1), dot(to_surface, e2))
                < MAX_NORMAL_MISS_MODULES * self.blank.mean_normal_module
            )
            # folded parts of the surface have the opposite orientation to most of it
            near &= area * np.nansum(np.sign(area)) > 0.0
        return np.where(near, e, np.nan), at, jet

    def _slopes(self, q: Array, surface: Envelope, at: Array, jet: Jet) -> Array:
        """Return the derivatives (K, N) of the ease-off by the unknowns."""
        phi = surface.parameter(at[:, 0], at[:, 1])
        columns = []
        # each tool point is moved by the changed settings at the same cradle rotation and parameters
        for k in range(len(q)):
            moved = q.copy()
            moved[k] += SETTING_STEP
            moved_flank = self.cut(moved)
            r = moved_flank.motion.at(phi).tool_to_blank.point(moved_flank.tool.jet(at[:, 0], at[:, 1]).r)
            columns.append(dot(jet.r - r, jet.n) / (SETTING_STEP * dot(self._n, jet.n)))
        return np.stack(columns, axis=-1)

    def _settings(self, q: Array) -> tuple[dict[str, float], tuple[float, ...]]:
        """Return the values of the settings, and the coefficients of modified roll."""
        changes = {key: float(x) * self._cost(key) for key, x in zip(self.keys, q, strict=False)}
        values = {key: value + changes.get(key, 0.0) for key, value in self.start.items()}
        roll = list(self.roll)
        for order, x in zip(self.orders, q[len(self.keys) :], strict=True):
            roll[order - 2] += float(x)
        return values, tuple(roll)

    def _can_be(self, q: Array) -> bool:
        """Return True if a design may have these settings; least squares take back a step beyond them."""
        values, _ = self._settings(q)
        keys = {key: PinionSide.key_of(key) for key in SYNTHESISED_KEYS}
        return all(
            key is not None and key.low < values[name] <= key.high
            for name, key in keys.items()
            if name != "cradle_angle"
        )

    def _cost(self, key: str) -> float:
        """Return the change of a setting (mm, deg) that has unit weight."""
        if key in ("cradle_angle", "blade_angle"):
            return float(np.degrees(1.0))
        return 1.0 if key == "ratio_of_roll" else self.blank.gear.mean_cone_distance

    @property
    def turns(self) -> bool:
        """True if the cradle angle is free: it turns the flank about the pinion's axis without a change of form.

        The thickness of the tooth depends on this turn.
        """
        return "cradle_angle" in self.keys

    @cached_property
    def begin(self) -> Array:
        """Parameters (K, 2) near the points of the flank at the start."""
        flank, stations = self.cut(np.zeros(len(self.keys) + len(self.orders))), self.blank.pinion.stations
        blade = side_of(self.design, self.blank, self.name, self.start, self.roll).blade
        heights = self.blank.clearance + 0.5 * (1.0 + self.conjugate.up[self.used]) * self.blank.mean_working_depth
        p = np.array([blade.at_height(float(height)) for height in heights])
        parameters = np.stack((p, follow(flank, p, stations.value(self._r), stations).values), axis=-1)
        return self.ease_off(flank, parameters, FIRST_NEWTON_STEPS)[1]

    @cached_property
    def _r(self) -> Array:
        """Points (K, 3) of the conjugate flank."""
        return self.conjugate.points[self.used]

    @cached_property
    def _n(self) -> Array:
        """Normals (K, 3) of the conjugate flank."""
        return self.conjugate.normals[self.used]

    @cached_property
    def _across(self) -> tuple[Array, Array]:
        """Unit vectors (K, 3) across the normals."""
        e1 = unit(cross(self._n, Z_AXIS))
        return e1, cross(self._n, e1)

    @cached_property
    def _terms(self) -> Array:
        """Terms (K, 5) of the polynomial."""
        return terms(self.conjugate.along[self.used], self.conjugate.up[self.used])

    @cached_property
    def _turning(self) -> Array:
        """Ease-off (K,) of a flank that turns about the pinion's axis, 1 in the middle."""
        lever = dot(self.conjugate.normals, cross(Z_AXIS, self.conjugate.points))
        i, j = lever.shape
        ease_off: Array = (lever / lever[i // 2, j // 2])[self.used]
        return ease_off

    @property
    def _wanted_ease_off(self) -> Array:
        """Requested ease-off (K,), mm."""
        wanted: Array = self._terms @ self.parameters
        return wanted

    @cached_property
    def _polynomial(self) -> Array:
        """Matrix (6, K) from values (K,) to their turn and five parameters, by least squares."""
        inverse: Array = np.linalg.pinv(np.column_stack((self._turning, self._terms)))
        return inverse

    @cached_property
    def _rows(self) -> Array:
        """Matrix (R, K) from values (K,) to weighted residuals: points and parameters.

        The turn is removed from the points if the flank cannot turn.
        """
        count = len(self._terms)
        points = np.eye(count)
        if not self.turns:
            points = points - np.outer(self._turning, self._polynomial[0])
        return np.concatenate((points, PARAMETER_WEIGHT * self._polynomial[1:]))
