"""Settings of one side of the pinion whose flank has the ease-off asked for, over the whole active flank.

The ease-off is the material that is missing on the pinion, along the normal, against the flank that is conjugate to the gear's;
what is asked for is a polynomial in the coordinates of the active flank (`conjugate_flank`):

    e = pressure_angle y + spiral_angle x + profile_crowning y^2 + length_crowning x^2 + twist x y

1. Local synthesis gives the settings with the point, normal and curvatures that this asks for in the middle of the flank.
2. From there the settings that are free are found by least squares over a grid, in steps within a region of trust [Artoni,
   Gabiccini & Guiggiani, J. Mech. Des. 130 (2008) 112602]. The five parameters count more than what is left of higher order, the
   residual topography, and a little is paid for settings far from the start: some of them change next to nothing together.
3. Where too much is left, modified roll takes its part, unless the design gives that itself.

A setting moves a point of an envelope along the normal by as much as it moves the tool's point that generates it, so that the
derivatives of the ease-off take no solving.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.figures import Figures, figure
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.numeric.algebra import AXIS, Array, cross, dot, unit
from gearmesh.kernel.surface.stations import follow
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank
from gearmesh.systems.spiral_bevel.conjugate.flank import ActiveFlank, ConjugateFlank
from gearmesh.systems.spiral_bevel.design import EASE_OFF, SYNTHESISED, PinionSide
from gearmesh.systems.spiral_bevel.machine.pair import HAND_SIGNS, MATING_SIDES, nominal_base
from gearmesh.systems.spiral_bevel.synthesis.local_synthesis import MeanContact, conjugate_operator
from gearmesh.systems.spiral_bevel.synthesis.settings import (
    ContactChoice,
    FlankForm,
    contact_asked,
    gear_sides,
    given_roll,
    mean_point,
    side_of,
    synthesise,
    tool_values,
)

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import EaseOffTable, FaceMilledDesign

#: how much more a parameter counts than a point of the grid, and what (mm) a setting costs that is as far from its start as a mean
#: cone distance, 1 rad or 1
PARAMETER_WEIGHT, FAR = 30.0, 0.03
#: part of what is asked for, and mm, that may be left as residual topography without more being tried, or said
LEFT, LEFT_LEAST = 0.1, 1e-3
#: the same below which modified roll is not asked for
ROLL_FROM, ROLL_LEAST = 0.03, 3e-4
#: orders of modified roll that take their part: higher ones take next to nothing more
ROLL = (2, 3)
#: change of the sum of squares, of itself, at which least squares stop, and evaluations at most: to begin with, with modified roll,
#: and to turn the flank clear. What settings do together leaves a long curved valley, on the floor of which little is to be had
TOLERANCE, FEW, MANY = 1e-2, 12, 30
#: Newton steps to the point of the pinion on a conjugate's normal, from the last one and at first, and how far from it (mean normal
#: modules) they may end
STEPS, FIRST_STEPS, REACHED = 2, 6, 1e-3
#: steps of differences: of the settings, over those costs; mean normal modules along the flank
STEP, ALONG = 1e-6, 0.02
#: how far (mm) a flank may stand out of the conjugate: it would jam without backlash
CLEAR = 2e-5
#: part of the grid that must be left
ENOUGH = 0.6


def form_choice(design: FaceMilledDesign, blank: BevelBlank, name: str, target: EaseOffTable) -> ContactChoice:
    """The choice of the pinion's side `name` of a design in mm with the ease-off `target`: its mean point is in the middle of the
    active flank, and its `form` the settings.

    Raises NoSolutionError where there are no settings to begin with.
    """
    conjugate = ConjugateFlank.of(design, blank, name)
    wanted = np.array([getattr(target, key) for key in EASE_OFF])
    at_middle = ContactChoice(
        contact_asked(design, blank, name),
        conjugate.height - 0.5 * blank.mean_depth,
        conjugate.station - blank.gear.mean_cone_distance,
    )
    gear, base = gear_sides(design, blank)[MATING_SIDES[name]], nominal_base(blank, HAND_SIGNS[design.hand])
    contact = mean_point(design, blank, gear, base, at_middle).contact
    start, spec = _start(design, blank, name, at_middle, contact, wanted), design.pinion.side(name)
    keys = tuple(key for key in SYNTHESISED if getattr(spec, key) is None)
    met = conjugate.exists
    least = float((terms(conjugate.along[met], conjugate.up[met]) @ wanted).min())
    # turned until what has least is as the conjugate
    fit = _Fit(design, blank, name, conjugate, wanted, start, given_roll(spec), met, keys, -least).whole()
    form = fit.solve(MANY if spec.gives_roll else FEW)
    if form.rest_max > max(ROLL_FROM * form.most, ROLL_LEAST) and not spec.gives_roll:
        fit = replace(fit, start=form.values, orders=ROLL)
        form = fit.solve(MANY)
    # what is left of higher order stands out somewhere
    out = float(np.nanmin(form.reached)) + form.away
    if fit.turns and out < -CLEAR:
        form = replace(fit, start=form.values, roll=form.roll, away=fit.away - out).solve(FEW)
    return ContactChoice(at_middle.asked, at_middle.height, at_middle.along, form=form)


def terms(x: Array, y: Array) -> Array:
    """Terms (..., 5) of the polynomial at coordinates x and y (...,), in the order of EASE_OFF."""
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
    """The parameters that were reached, and how much is left."""
    reached = {f"ease_off_{key}": 1e3 * value for key, value in form.parameters.items()}
    return FormFigures(
        **reached,
        ease_off_residual_max=1e3 * form.rest_max,
        ease_off_residual_rms=1e3 * float(np.sqrt(np.nanmean(form.residual**2))),
    )


def form_warnings(design: FaceMilledDesign, forms: dict[str, FlankForm | None]) -> Iterator[str]:
    """What to say of sides with too much residual topography."""
    for name, form in forms.items():
        if form is not None and form.rest_max > max(LEFT * form.most, LEFT_LEAST):
            yield (
                f"{design.ease_off_key(name)}: the residual topography of pinion.{name} is up to {1e3 * form.rest_max:.3g} um, the "
                f"requested ease-off up to {1e3 * form.most:.3g} um; give fewer settings or a smaller ease-off"
            )


def _start(
    design: FaceMilledDesign, blank: BevelBlank, name: str, choice: ContactChoice, contact: MeanContact, wanted: Array
) -> dict[str, float]:
    """Settings under their keys (mm, deg) whose flank has the ease-off to the second order in the middle, but for what is given."""
    active, r, n = ActiveFlank(blank), contact.point, contact.normal
    e1 = unit(cross(n, AXIS))
    basis = np.stack((e1, cross(n, e1)))
    h = ALONG * blank.mean_normal_module
    grid = h * np.array([[(s, t) for t in (-1, 0, 1)] for s in (-1, 0, 1)]) @ basis
    e = terms(*active.coordinates(r + grid)) @ wanted
    tilted = np.array([e[2, 1] - e[0, 1], e[1, 2] - e[1, 0]]) / (2.0 * h)
    mixed = 0.25 * (e[2, 2] - e[2, 0] - e[0, 2] + e[0, 0])
    bent = np.array([[e[2, 1] - 2.0 * e[1, 1] + e[0, 1], mixed], [mixed, e[1, 2] - 2.0 * e[1, 1] + e[1, 0]]]) / h**2
    # less material by e along n: the normal leans with its slope, and the shape operator changes by its curvature
    operator = conjugate_operator(contact) - basis.T @ bent @ basis
    try:
        values = tool_values(design, blank, name, (r, unit(n + tilted @ basis)), operator)
    except NoSolutionError:
        values = synthesise(design, blank, name, contact, choice.asked)
    spec = design.pinion.side(name)
    given = {key: getattr(spec, key) for key in (*SYNTHESISED, "blade_height") if getattr(spec, key) is not None}
    # that of a cutter that leans follows from the rest
    base = values["sliding_base"] if spec.upright else spec.sliding_base
    return {**values, **given, "sliding_base": base}


@dataclass(frozen=True)
class _Fit:
    """Least squares for the settings of a side from its `start`, under their keys (mm, deg), and the coefficients of modified roll
    with which it starts, over the points of a grid that are `used` (I, J).

    Unknowns are changes of the settings `keys` and of modified roll of the `orders`, over what each costs. What is wanted, by its
    `parameters`, has nothing missing in the middle: there the flank is turned about the pinion's axis to be `away` (mm).
    """

    design: FaceMilledDesign
    blank: BevelBlank
    name: str
    conjugate: ConjugateFlank
    parameters: Array
    start: dict[str, float]
    roll: tuple[float, ...]
    used: NDArray[np.bool_]
    keys: tuple[str, ...]
    away: float
    orders: tuple[int, ...] = ()

    def whole(self) -> _Fit:
        """The same over the points that the flank has at the start. Raises NoSolutionError where these are few."""
        e = self.ease_off(self.cut(np.zeros(len(self.keys))), self.begin)[0]
        used = self.used.copy()
        used[used] = np.isfinite(e)
        if used.mean() < ENOUGH:
            raise self._nothing()
        return replace(self, used=used)

    def _nothing(self) -> NoSolutionError:
        return NoSolutionError(
            self.design.ease_off_key(self.name),
            reason=f"settings that give it at the mean point generate no flank of pinion.{self.name} around that point; "
            "give a smaller ease-off, or fewer settings",
        )

    def solve(self, evaluations: int) -> FlankForm:
        """The form that is nearest to what is wanted. Raises NoSolutionError where there is none to begin with."""
        from scipy.optimize import least_squares

        tried: dict[bytes, tuple[Envelope, Array, Array, Jet]] = {}
        at = self.begin

        def trial_at(q: Array) -> tuple[Envelope, Array, Array, Jet]:
            """The flank of unknowns q, its ease-off, parameters and jets."""
            if q.tobytes() not in tried:
                surface = self.cut(q)
                tried[q.tobytes()] = surface, *self.ease_off(surface, at)
            return tried[q.tobytes()]

        def residual(q: Array) -> Array:
            if not self._can_be(q):
                return np.full(len(self._rows) + len(q), np.nan)
            e = trial_at(q)[1]
            return np.concatenate((self._rows @ (e - self._wanted_ease_off - self.away * self._turning), FAR * q))

        def derivatives(q: Array) -> Array:
            nonlocal at
            surface, _, at, jet = trial_at(q)
            return np.concatenate((self._rows @ self._slopes(q, surface, at, jet), FAR * np.eye(len(q))))

        zero = np.zeros(len(self.keys) + len(self.orders))
        with np.errstate(all="ignore"):
            if not np.isfinite(residual(zero)).all():
                raise self._nothing()
            fit = least_squares(residual, zero, derivatives, ftol=TOLERANCE, xtol=None, gtol=None, max_nfev=evaluations)
            reached = trial_at(fit.x)[1]
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
            parameters=dict(zip(EASE_OFF, map(float, five), strict=True)),
        )

    def cut(self, q: Array) -> Envelope:
        """The flank with the settings of unknowns q (N,)."""
        values, roll = self._settings(q)
        side = side_of(self.design, self.blank, self.name, values, roll)
        return side.envelope(side.blade.flank)

    def ease_off(self, surface: Surface, at: Array, steps: int = STEPS) -> tuple[Array, Array, Jet]:
        """Ease-off (K,), mm, NaN where the surface is not near, by Newton steps from the parameters at (K, 2); parameters and jet
        of the points of the surface that are on the normals of the conjugate flank."""
        e1, e2 = self._across
        with np.errstate(all="ignore"):
            for _ in range(steps):
                jet = surface.jet(at[:, 0], at[:, 1])
                away = self._r - jet.r
                f1, f2 = dot(away, e1), dot(away, e2)
                a, b, c, d = (dot(column, e) for e in (e1, e2) for column in (jet.r_u, jet.r_v))
                step = np.stack((d * f1 - b * f2, a * f2 - c * f1), axis=-1) / (a * d - b * c)[:, None]
                at = at + step
            jet = surface.jet(at[:, 0], at[:, 1])
            area = dot(cross(jet.r_u, jet.r_v), jet.n)
            away = self._r - jet.r
            # what is left beside the normal counts in the tangent plane
            e = dot(away, jet.n) / dot(self._n, jet.n)
            near = np.hypot(dot(away, e1), dot(away, e2)) < REACHED * self.blank.mean_normal_module
            # as most of it lies; what is folded lies the other way
            near &= area * np.nansum(np.sign(area)) > 0.0
        return np.where(near, e, np.nan), at, jet

    def _slopes(self, q: Array, surface: Envelope, at: Array, jet: Jet) -> Array:
        """Derivatives (K, N) of the ease-off."""
        phi = surface.parameter(at[:, 0], at[:, 1])
        columns = []
        for k in range(len(q)):
            moved = q.copy()
            moved[k] += STEP
            other = self.cut(moved)
            r = other.motion.at(phi).tool_to_blank.point(other.tool.jet(at[:, 0], at[:, 1]).r)
            columns.append(dot(jet.r - r, jet.n) / (STEP * dot(self._n, jet.n)))
        return np.stack(columns, axis=-1)

    def _settings(self, q: Array) -> tuple[dict[str, float], tuple[float, ...]]:
        """Values of the settings, and coefficients of modified roll."""
        changes = {key: float(x) * self._cost(key) for key, x in zip(self.keys, q, strict=False)}
        values = {key: value + changes.get(key, 0.0) for key, value in self.start.items()}
        roll = list(self.roll)
        for order, x in zip(self.orders, q[len(self.keys) :], strict=True):
            roll[order - 2] += float(x)
        return values, tuple(roll)

    def _can_be(self, q: Array) -> bool:
        """Whether a design may have these settings: a step that leads beyond is taken back."""
        values, _ = self._settings(q)
        keys = {key: PinionSide.key_of(key) for key in SYNTHESISED}
        return all(
            key is not None and key.low < values[name] <= key.high
            for name, key in keys.items()
            if name != "cradle_angle"
        )

    def _cost(self, key: str) -> float:
        """Change of a setting (mm, deg) that costs as much as any other's."""
        if key in ("cradle_angle", "blade_angle"):
            return float(np.degrees(1.0))
        return 1.0 if key == "ratio_of_roll" else self.blank.gear.mean_cone_distance

    @property
    def turns(self) -> bool:
        """Whether a setting is free that turns the flank about the pinion's axis and leaves its form: thickness depends on it."""
        return "cradle_angle" in self.keys

    @cached_property
    def begin(self) -> Array:
        """Parameters (K, 2) near which the points are on the flank at the start."""
        flank, own = self.cut(np.zeros(len(self.keys) + len(self.orders))), self.blank.pinion.stations
        blade = side_of(self.design, self.blank, self.name, self.start, self.roll).blade
        heights = self.blank.clearance + 0.5 * (1.0 + self.conjugate.up[self.used]) * self.blank.mean_working_depth
        p = np.array([blade.at_height(float(height)) for height in heights])
        at = np.stack((p, follow(flank, p, own.value(self._r), own).values), axis=-1)
        return self.ease_off(flank, at, FIRST_STEPS)[1]

    @cached_property
    def _r(self) -> Array:
        return self.conjugate.points[self.used]

    @cached_property
    def _n(self) -> Array:
        return self.conjugate.normals[self.used]

    @cached_property
    def _across(self) -> tuple[Array, Array]:
        """Unit vectors (K, 3) across the normals."""
        e1 = unit(cross(self._n, AXIS))
        return e1, cross(self._n, e1)

    @cached_property
    def _terms(self) -> Array:
        return terms(self.conjugate.along[self.used], self.conjugate.up[self.used])

    @cached_property
    def _turning(self) -> Array:
        """Ease-off (K,) of a flank that turns about the pinion's axis, 1 in the middle."""
        lever = dot(self.conjugate.normals, cross(AXIS, self.conjugate.points))
        i, j = lever.shape
        ease_off: Array = (lever / lever[i // 2, j // 2])[self.used]
        return ease_off

    @property
    def _wanted_ease_off(self) -> Array:
        wanted: Array = self._terms @ self.parameters
        return wanted

    @cached_property
    def _polynomial(self) -> Array:
        """Of values (K,), by least squares, the part of a turning flank and the parameters, (6, K)."""
        inverse: Array = np.linalg.pinv(np.column_stack((self._turning, self._terms)))
        return inverse

    @cached_property
    def _rows(self) -> Array:
        """What counts of values (K,)."""
        count = len(self._terms)
        points = np.eye(count)
        if not self.turns:
            points = points - np.outer(self._turning, self._polynomial[0])
        return np.concatenate((points, PARAMETER_WEIGHT * self._polynomial[1:]))
