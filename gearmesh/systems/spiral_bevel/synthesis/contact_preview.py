"""Contact preview of a bevel pair: the path of contact that a choice for local synthesis has, and what else touches.

Of untrimmed flanks as they are cut; what bounds the teeth is asked of the blank. A path is followed from the mean point either way.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions, Flank
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, polar_angle
from gearmesh.kernel.surface.stations import along, follow
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank, MemberBlank
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES, HAND_SIGNS, MATING_SIDES, nominal_base
from gearmesh.systems.spiral_bevel.synthesis.settings import (
    ContactChoice,
    MeanPoint,
    gear_sides,
    mean_point,
    meshing_turns,
    pinion_side,
)
from gearmesh.teeth.mount import Mount

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: positions either way, and pitches that they reach
STEPS, REACH = 8, 1.0
#: residual of a position over the mean normal module, and how it is solved for: one length of a step an evaluation, since settings
#: that are searched for depend on the last digits
TOLERANCE = 1e-7
solve = partial(newton.solve, max_iterations=10, at_once=1)
#: points of the gear's flank, along and up, that may touch before the path does; their heights over that of the tooth in its middle
GRID, HIGHEST = (9, 26), 1.3
#: parts of the steps up in which lags are looked at
FINER = 6
#: pitches from the mean point, and degree, of the polynomial that says of what order the lag is
FITTED, DEGREE = 0.8, 5
#: degree of that which gives the lag where neighbouring pairs change over, and points in which the change is looked for
SMOOTH, CHANGES = 6, 401

_NO_GRID = np.zeros((1, 1, 2))


@dataclass(frozen=True)
class ContactPreview:
    """A path of contact at phi (K,), pitches of the pinion from the mean point, ascending: `lag` (K,) of the gear, rad; `place`
    (K, 2) on the gear's flank: mm along the face from its middle and up from the middle of the working depth; surface contact from
    `begin` to `end`, pitches. Of the `pinion`, which has the `mean` point."""

    phi: Array
    lag: Array
    place: Array
    begin: float
    end: float
    pinion: Generated
    mean: MeanPoint

    @property
    def shorter(self) -> float:
        """Pitches of surface contact on the shorter side of the mean point."""
        return min(-self.begin, self.end)

    def at(self, phi: float) -> Array:
        """The place (2,) on the gear's flank."""
        return np.array([np.interp(phi, self.phi, column) for column in self.place.T])

    @cached_property
    def orders(self) -> Array:
        """Coefficients (6,) of the lag (rad) by powers of phi, pitches, about the mean point."""
        near = np.abs(self.phi) <= FITTED
        degree = min(DEGREE, int(near.sum()) - 1)
        coefficients = np.polynomial.Polynomial.fit(self.phi[near], self.lag[near], degree).convert().coef
        return np.pad(coefficients, (0, DEGREE + 1 - len(coefficients)))

    @cached_property
    def smooth(self) -> np.polynomial.Polynomial:
        """The lag (rad) by phi, pitches, all along the path."""
        return np.polynomial.Polynomial.fit(self.phi, self.lag, min(SMOOTH, len(self.phi) - 1))

    @cached_property
    def at_change(self) -> float:
        """Lag (rad) of the gear where neighbouring pairs change over, less the least of either; NaN where they do not."""
        span = float(self.phi[-1] - self.phi[0])
        if span <= 1.0:
            return np.nan
        smooth, phi = self.smooth, np.linspace(self.phi[0], self.phi[-1] - 1.0, CHANGES)
        apart = smooth(phi) - smooth(phi + 1.0)
        change = np.flatnonzero(apart[:-1] * apart[1:] <= 0.0)
        if not change.size:
            return np.nan
        k = change[np.abs(phi[change] + 0.5).argmin()]
        at = phi[k] + (phi[k + 1] - phi[k]) * apart[k] / (apart[k] - apart[k + 1])
        return float(smooth(at) - smooth(np.linspace(at, at + 1.0, CHANGES)).min())


@dataclass(frozen=True)
class ContactPreviews:
    """ContactPreviews of the pinion's side `name` of a design in mm."""

    design: FaceMilledDesign
    blank: BevelBlank
    name: str

    def of(self, choice: ContactChoice) -> ContactPreview | None:
        """The path of contact of a choice, None where no pinion gives it."""
        if choice not in self._cache:
            self._cache[choice] = self._of(choice)
        return self._cache[choice]

    def _of(self, choice: ContactChoice) -> ContactPreview | None:
        try:
            mean = mean_point(self.design, self.blank, self._gear, self._base, choice)
            return self._follow(pinion_side(self.design, self.blank, self.name, mean), mean)
        except (NoSolutionError, DesignError):
            return None

    @cached_property
    def _cache(self) -> dict[ContactChoice, ContactPreview | None]:
        return {}

    @property
    def count(self) -> int:
        """How many choices have been looked at."""
        return len(self._cache)

    @property
    def wanted_lag(self) -> float:
        """Lag (rad) asked for at the change of teeth."""
        return self.design.pinion.side(self.name).te_at_change * ARCSEC

    def apart(self, path: ContactPreview) -> float:
        """By how much the flanks are apart where they are least of all beyond what the gears lag; parts of the lag asked for.

        Of points of the gear's flank that stand, at the ratio of the teeth, where they are points of contact: how far the gear
        would lag if the pinion touched there, on the circle about its own axis.
        """
        blank, sense, ratio = self.blank, HAND_SIGNS[self.design.hand], self._ratio
        jet, turns = self._conjugate
        phi1 = sense * (path.mean.gear_turn - turns) / ratio
        r = (Rigid.about_z(-sense * phi1) @ (self._base @ Rigid.about_z(turns))).point(jet.r)
        flank, own = path.pinion.side(0.0).flank, blank.pinion.stations
        p = _parameters(path.pinion, r)
        start = np.stack((p, follow(flank, p, own.value(r), own).values), axis=-1)
        rho = np.hypot(r[:, 0], r[:, 1])

        def same_circle(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
            at = flank.jet(x[:, 0], x[:, 1])
            here = np.hypot(at.r[:, 0], at.r[:, 1])
            f = np.stack((here - rho[index], at.r[:, 2] - r[index, 2]), axis=-1)
            columns = [
                np.stack(((at.r[:, 0] * d[:, 0] + at.r[:, 1] * d[:, 1]) / here, d[:, 2]), axis=-1)
                for d in (at.r_u, at.r_v)
            ]
            return f, np.stack(columns, axis=-1)

        tolerance = TOLERANCE * blank.mean_normal_module
        with np.errstate(all="ignore"):
            solution = solve(same_circle, start, tolerance=tolerance)
            surface = flank.jet(solution.values[:, 0], solution.values[:, 1]).r
        ahead = (polar_angle(r) - polar_angle(surface) + np.pi) % (2.0 * np.pi) - np.pi
        lag = BLADE_SIDES[self.name] * sense * ratio * ahead
        own_margin = np.minimum(-blank.pinion.tip.value(surface), _above_form_point(path.pinion, solution.values[:, 0]))
        margin = np.where(solution.converged, np.minimum(own_margin, self._margin[self._in_contact]), np.nan)
        # where pairs change over the least lag has a corner, and what is ahead may be as narrow as that
        table = np.full((3, *self._margin.shape), np.nan)
        table[:, self._in_contact] = lag, phi1 / self._pitch, margin
        lag, pitches, margin = _finer(table, table[2] >= 0.0)
        least = path.smooth(np.clip(pitches - np.round(pitches), path.phi[0], path.phi[-1]))
        return float(np.min((lag - least)[margin >= 0.0], initial=0.0) / (self.wanted_lag or np.ptp(path.lag)))

    @cached_property
    def _conjugate(self) -> tuple[Jet, Array]:
        """Points (M,) of the gear's flank as cut, and how far (rad) it is turned where they are points of contact at the ratio of
        the teeth."""
        jet, turns, _ = self._of_grid
        met = self._in_contact
        return Jet(*(getattr(jet, name)[met] for name in ("r", "n", "r_u", "r_v", "n_u", "n_v"))), turns[met]

    @cached_property
    def _in_contact(self) -> NDArray[np.bool_]:
        """Which points of the grid are points of contact somewhere."""
        return np.isfinite(self._of_grid[1]) & np.isfinite(self._margin)

    @property
    def _margin(self) -> Array:
        """How far (mm) points of the grid are inside tip and form point of the gear's flank, NaN where it has none."""
        return self._of_grid[2]

    @cached_property
    def _of_grid(self) -> tuple[Jet, Array, Array]:
        """Points of the gear's flank up and along, turns (rad) and margins (mm), see above."""
        blank, level = self.blank, self.blank.gear.stations
        heights = np.linspace(0.0, HIGHEST * self._gear.tip_height, GRID[1])
        p = np.array([self._gear.blade.at_height(float(height)) for height in heights])[:, None]
        stations = np.linspace(*blank.gear.extent, GRID[0])
        curves = follow(self._surface, p, stations, level)
        margin = np.minimum(-blank.gear.tip.value(curves.jet.r), _above_form_point(self._gear, p))
        turns = meshing_turns(curves.jet, self._base, HAND_SIGNS[self.design.hand], self._ratio)
        return curves.jet, turns, np.where(curves.converged, margin, np.nan)

    @cached_property
    def _gear(self) -> Generated:
        """The gear's side that it meets."""
        return gear_sides(self.design, self.blank)[MATING_SIDES[self.name]]

    @cached_property
    def _surface(self) -> Surface:
        return self._gear.side(0.0).flank

    @cached_property
    def _base(self) -> Rigid:
        return nominal_base(self.blank, HAND_SIGNS[self.design.hand])

    @property
    def _ratio(self) -> float:
        return self.blank.pinion.teeth / self.blank.gear.teeth

    @property
    def _pitch(self) -> float:
        return 2.0 * np.pi / self.blank.pinion.teeth

    def _follow(self, pinion: Generated, mean: MeanPoint) -> ContactPreview:
        """The path of a pinion's side as cut, from the mean point on."""
        blank, sense = self.blank, float(HAND_SIGNS[self.design.hand])
        own, mating = blank.pinion.stations, blank.gear.stations
        first = Flank(pinion.side(0.0).flank, Mount(Rigid.identity(), sense), {}, own, blank.pinion.extent, _NO_GRID)
        turned = Mount(self._base @ Rigid.about_z(mean.gear_turn), -sense)
        second = Flank(self._surface, turned, {}, mating, blank.gear.extent, _NO_GRID)
        at = mean.contact.point[None]
        p = _parameters(pinion, at)
        v, _ = along(first.surface, p, own.value(at), own)
        start = np.array([p[0], v[0], *mean.parameters, 0.0])
        phi, x = _path((first, second), start, self._pitch, blank.mean_normal_module)
        r = first.surface.jet(x[:, 0], x[:, 1]).r, second.surface.jet(x[:, 2], x[:, 3]).r
        margins = [
            margin
            for k, (part, side) in enumerate(((blank.pinion, pinion), (blank.gear, self._gear)))
            for margin in self._margins(part, side, r[k], x[:, 2 * k])
        ]
        begin, end = _ends(phi, np.min(margins, axis=0))
        lag = -BLADE_SIDES[self.name] * (x[:, 4] - self._ratio * phi * self._pitch)
        above = self._gear.settings.tip_cone().value(r[1]) - blank.clearance
        up = 0.5 * (above + blank.gear.tip.value(r[1]))
        place = np.stack((mating.value(r[1]) - blank.gear.mean_cone_distance, up), axis=-1)
        return ContactPreview(phi, lag, place, begin, end, pinion, mean)

    @staticmethod
    def _margins(own: MemberBlank, side: Generated, r: Array, p: Array) -> tuple[Array, ...]:
        """How far (mm) points r (K, 3) of a flank, at blade parameters p (K,), are inside each of what bounds it."""
        station = own.stations.value(r)
        ends = station - own.inner_cone_distance, own.outer_cone_distance - station
        return *ends, -own.tip.value(r), _above_form_point(side, p)


def _finer(table: Array, on: NDArray[np.bool_]) -> Array:
    """What stands in columns of a table (K, H, S) where they are `on` (H, S), in finer steps (K, F, S): straight in between, and as
    straight up to a step beyond, for what is off there may be of another branch; NaN elsewhere."""
    inside = np.where(on, table, np.nan)
    share, step = np.arange(FINER)[:, None] / FINER, np.diff(inside, axis=1)[:, :, None]
    off = np.where(np.pad(on, ((1, 1), (0, 0))), np.nan, 0.0)[:, None]
    between = inside[:, :-1, None] + share * step
    above = inside[:, 1:, None] + share * step + off[2:][1:]
    below = inside[:, :-1, None] - share * step + off[:-2][:-1]
    return np.concatenate([part.reshape(len(table), -1, table.shape[-1]) for part in (between, above, below)], axis=1)


def _above_form_point(side: Generated, p: Array) -> Array:
    """How far (mm) along the blade parameters p (...,) are from its form point with the rounding, towards the tip of the tooth."""
    form_point = side.blade.form_point[0]
    # the parameter is an angle where the blade is an arc
    height: Array = (
        np.sign(side.blade.at_height(side.tip_height) - form_point)
        * (p - form_point)
        * (abs(side.blade.blade_radius) or 1.0)
    )
    return height


def _parameters(side: Generated, r: Array) -> Array:
    """Blade parameters (K,) near which own points r (K, 3) of a flank were generated: by height over the machine root plane."""
    return np.array([side.blade.at_height(float(height)) for height in side.above_plane(r)])


def _path(flanks: tuple[Flank, Flank], x: Array, pitch: float, length: float) -> tuple[Array, Array]:
    """phi (K,), pitches, ascending, and unknowns (K, 5) of contacts on either side of that at phi1 = 0, as far as they go on."""
    step = REACH / STEPS
    at_mean = Conditions(flanks, np.zeros(1), length)
    first = solve(at_mean, x[None], tolerance=TOLERANCE * length)
    if not first.converged[0]:
        raise NoSolutionError(reason="the flanks do not meet at the mean point")
    known = {0: first.values[0]}
    rate = at_mean.rate(first.values, np.zeros(1, dtype=np.intp))[0]
    going = [1, -1]
    for k in range(1, STEPS + 1):
        starts = []
        for way in going:
            before = [known[way * (k - n)] for n in range(1, min(k, 3) + 1)]
            if k == 1:
                starts.append(before[0] + way * step * pitch * rate)
            elif k == 2:
                starts.append(2.0 * before[0] - before[1])
            else:
                starts.append(3.0 * (before[0] - before[1]) + before[2])
        conditions = Conditions(flanks, np.array(going) * (k * step * pitch), length)
        solution = solve(conditions, np.array(starts), tolerance=TOLERANCE * length)
        known |= {way * k: x for way, x, good in zip(going, solution.values, solution.converged, strict=True) if good}
        going = [way for way in going if way * k in known]
        if not going:
            break
    order = sorted(known)
    return np.array(order) * step, np.array([known[k] for k in order])


def _ends(phi: Array, inside: Array) -> tuple[float, float]:
    """Where `inside` (K,) turns negative next to phi = 0 either way, or phi (K,) ends."""
    middle = int(np.abs(phi).argmin())
    ends = []
    for way in (-1, 1):
        k = middle
        while 0 <= k + way < len(phi) and inside[k + way] >= 0.0:
            k += way
        beyond = k + way
        if 0 <= beyond < len(phi) and inside[k] > 0.0:
            ends.append(float(phi[k] + inside[k] / (inside[k] - inside[beyond]) * (phi[beyond] - phi[k])))
        else:
            ends.append(float(phi[k]))
    return ends[0], ends[1]
