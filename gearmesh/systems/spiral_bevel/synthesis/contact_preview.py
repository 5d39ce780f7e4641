"""Contact preview of a bevel pair: path of contact of a choice for local synthesis, and other contact before it.

The flanks are untrimmed, as cut; the blank gives the limits of the teeth. A path is followed from the mean point in
both directions.
"""

from __future__ import annotations

from dataclasses import replace
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
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank
from gearmesh.systems.spiral_bevel.hobbing.crowning import crowned_contact
from gearmesh.systems.spiral_bevel.hobbing.sides import formate_twist
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

#: number of positions on either side of the mean point
PATH_STEPS = 8
#: length of the path on either side of the mean point, in pitches
PATH_REACH_PITCHES = 1.0
#: residual at which a position is solved, over the mean normal module
POSITION_TOLERANCE = 1e-7
#: halvings of a step from start values of another path: a position that such a step takes farther is left to its neighbours
ALIKE_HALVINGS = 0
#: halvings of other steps
STEP_HALVINGS = 8
#: Newton with one step length per evaluation: the sought settings depend on the last digits
solve = partial(newton.solve, max_iterations=10, at_once=1)
#: numbers of points of the gear's flank, along and up, that may touch before the path
FLANK_GRID_SHAPE = (9, 26)
#: height of the highest points, over the height of the tooth in its middle
MAX_HEIGHT_SHARE = 1.3
#: number of parts of a step up in which lags are interpolated
HEIGHT_SUBDIVISIONS = 6
#: range (pitches from the mean point) of the polynomial that gives the orders of the lag
ORDER_FIT_PITCHES = 0.8
#: degree of the polynomial that gives the orders of the lag
ORDER_FIT_DEGREE = 5
#: degree of the polynomial of the lag along the whole path
LAG_FIT_DEGREE = 6
#: number of points in which the change of tooth pairs is sought
CHANGE_POINTS = 401

#: relative difference up to which a ratio of roll is that of the teeth
RATIO_TOLERANCE = 1e-2

_NO_GRID = np.zeros((1, 1, 2))


@dataclass(frozen=True)
class ContactPreview:
    """A path of contact at K positions."""

    #: pinion rotations (K,) from the mean point, ascending, in pitches
    phi: Array
    #: lag (K,) of the gear, rad
    lag: Array
    #: places (K, 2) on the gear's flank, mm: along the face from its middle, and up from the middle of the working
    #: depth
    place: Array
    #: begin of surface contact, in pitches
    begin: float
    #: end of surface contact, in pitches
    end: float
    #: side of the pinion
    pinion: Generated
    #: mean point of the side
    mean: MeanPoint
    #: unknowns (K, 5) of the contacts: blade parameters and positions on pinion and gear, rotation of the gear
    unknowns: Array

    @property
    def shorter(self) -> float:
        """Length of surface contact on the shorter side of the mean point, in pitches."""
        return min(-self.begin, self.end)

    def at(self, phi: float) -> Array:
        """Return the place (2,) on the gear's flank at a rotation phi."""
        return np.array([np.interp(phi, self.phi, column) for column in self.place.T])

    @cached_property
    def orders(self) -> Array:
        """Coefficients (6,) of the lag (rad) by powers of phi (pitches) about the mean point."""
        near = np.abs(self.phi) <= ORDER_FIT_PITCHES
        degree = min(ORDER_FIT_DEGREE, int(near.sum()) - 1)
        coefficients = np.polynomial.Polynomial.fit(self.phi[near], self.lag[near], degree).convert().coef
        return np.pad(coefficients, (0, ORDER_FIT_DEGREE + 1 - len(coefficients)))

    @cached_property
    def smooth(self) -> np.polynomial.Polynomial:
        """Polynomial of the lag (rad) by phi (pitches) along the whole path."""
        return np.polynomial.Polynomial.fit(self.phi, self.lag, min(LAG_FIT_DEGREE, len(self.phi) - 1))

    @cached_property
    def at_change(self) -> float:
        """Lag (rad) of the gear at the change of tooth pairs, less the least lag of a pair; NaN if there is no change."""
        span = float(self.phi[-1] - self.phi[0])
        if span <= 1.0:
            return np.nan
        # at the change the lags of a pair and of its successor, one pitch later, are equal
        smooth, phi = self.smooth, np.linspace(self.phi[0], self.phi[-1] - 1.0, CHANGE_POINTS)
        lag_difference = smooth(phi) - smooth(phi + 1.0)
        change = np.flatnonzero(lag_difference[:-1] * lag_difference[1:] <= 0.0)
        if not change.size:
            return np.nan
        # the change nearest to half a pitch before the mean point, interpolated linearly
        k = change[np.abs(phi[change] + 0.5).argmin()]
        change_phi = phi[k] + (phi[k + 1] - phi[k]) * lag_difference[k] / (lag_difference[k] - lag_difference[k + 1])
        return float(smooth(change_phi) - smooth(np.linspace(change_phi, change_phi + 1.0, CHANGE_POINTS)).min())


@dataclass(frozen=True)
class ContactPreviews:
    """Contact previews of one side of the pinion."""

    #: design in mm
    design: FaceMilledDesign
    #: blank of the pair
    blank: BevelBlank
    #: side of the pinion, "concave" or "convex"
    name: str

    def of(self, choice: ContactChoice) -> ContactPreview | None:
        """Return the path of contact of a choice, None if no pinion gives it. Paths are computed once."""
        if choice not in self._cache:
            self._cache[choice] = self._of(choice)
        return self._cache[choice]

    def _of(self, choice: ContactChoice) -> ContactPreview | None:
        """Compute the path of contact of a choice, None if no pinion gives it."""
        try:
            mean = self._mean_point(choice)
            return self._follow(pinion_side(self.design, self.blank, self.name, mean), mean)
        except (NoSolutionError, DesignError):
            return None

    def _mean_point(self, choice: ContactChoice) -> MeanPoint:
        """Return the mean point of a choice; choices that differ in direction, ellipse or parabola alone share it."""
        place = choice.height, choice.along
        if place not in self._mean_points:
            self._mean_points[place] = mean_point(self.design, self.blank, self._gear, self._base, choice)
        return replace(self._mean_points[place], choice=choice)

    @cached_property
    def _mean_points(self) -> dict[tuple[float, float], MeanPoint]:
        """Mean points computed so far, by height and place along the face."""
        return {}

    @cached_property
    def _cache(self) -> dict[ContactChoice, ContactPreview | None]:
        """Paths computed so far, by choice."""
        return {}

    @property
    def count(self) -> int:
        """Number of choices whose paths have been computed."""
        return len(self._cache)

    @property
    def by_gear_head(self) -> bool:
        """True if the gear's own head can cut the pinion: of face-hobbed gears that are not generated."""
        return self.design.hobbed and self.design.formate

    def crowned(self, choice: ContactChoice, *, lengthwise: bool = True, share: float | None = None) -> ContactChoice:
        """Return a choice with the path of the gear's own head, crowned, and an ellipse of about the choice's length at most.

        A choice whose mean point never meets the pinion is returned as it is.

        - `lengthwise`: with more crowning lengthwise than along the profile
        - `share`: direction of the path, as for `directed_curvatures`; modified roll adds what the lag of the head lacks
        """
        try:
            mean = self._mean_point(choice)
        except NoSolutionError:
            return choice
        flank, position = mean.mating
        jet = flank.jet(*(np.array(x) for x in mean.parameters)).move(position)
        asked = crowned_contact(mean.contact, jet, self._twist, choice.asked, lengthwise=lengthwise, share=share)
        if share is None:
            return replace(choice, asked=asked)
        wanted = choice.asked.ratio_derivative
        return replace(
            choice, asked=replace(asked, ratio_derivative=wanted), by_roll=True, head_derivative=asked.ratio_derivative
        )

    def in_gear_place(self, path: ContactPreview | None) -> bool:
        """Return True for a path of a head in the place of the gear: the ratio of roll is that of the teeth."""
        return path is not None and abs(path.pinion.settings.ratio_of_roll / self._ratio - 1.0) < RATIO_TOLERANCE

    @cached_property
    def _twist(self) -> float:
        """Curvature by both directions, over that along the tooth, of length crowning by the gear's head."""
        return formate_twist(self.design, self.blank, MATING_SIDES[self.name])

    @property
    def wanted_lag(self) -> float:
        """Requested lag (rad) at the change of teeth."""
        return self.design.pinion.side(self.name).te_at_change * ARCSEC

    def apart(self, path: ContactPreview) -> float:
        """Return the least clearance of the flanks beyond the lag of the gear, over the requested lag.

        It is 0, or < 0 if another point touches before the path.

        Each point of the gear's flank is placed where it would be in contact at the ratio of the teeth. Its distance
        from the pinion's flank, along the circle about the pinion's axis, is the lag at which it would touch. It is computed
        once for each path of these previews.
        """
        if id(path) not in self._clearances:
            self._clearances[id(path)] = self._apart(path)
        return self._clearances[id(path)]

    @cached_property
    def _clearances(self) -> dict[int, float]:
        """Least clearances computed so far, by the identity of their paths, all of which are kept."""
        return {}

    def _apart(self, path: ContactPreview) -> float:
        """Compute the clearance of `apart`."""
        blank, sense, ratio = self.blank, HAND_SIGNS[self.design.hand], self._ratio
        jet, turns = self._conjugate
        phi1 = sense * (path.mean.gear_turn - turns) / ratio
        r = (Rigid.about_z(-sense * phi1) @ (self._base @ Rigid.about_z(turns))).point(jet.r)
        flank, own = path.pinion.side(0.0).flank, blank.pinion.stations
        # point of the pinion's flank on the same circle about its axis, by Newton from a point at the same station
        p = _parameters(path.pinion, r)
        start = np.stack((p, follow(flank, p, own.value(r), own).values), axis=-1)
        rho = np.hypot(r[:, 0], r[:, 1])

        def same_circle(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
            jet_at = flank.jet(x[:, 0], x[:, 1])
            radius = np.hypot(jet_at.r[:, 0], jet_at.r[:, 1])
            f = np.stack((radius - rho[index], jet_at.r[:, 2] - r[index, 2]), axis=-1)
            columns = [
                np.stack(((jet_at.r[:, 0] * d[:, 0] + jet_at.r[:, 1] * d[:, 1]) / radius, d[:, 2]), axis=-1)
                for d in (jet_at.r_u, jet_at.r_v)
            ]
            return f, np.stack(columns, axis=-1)

        tolerance = POSITION_TOLERANCE * blank.mean_normal_module
        with np.errstate(all="ignore"):
            solution = solve(same_circle, start, tolerance=tolerance)
            surface = flank.jet(solution.values[:, 0], solution.values[:, 1]).r
        # lag at which the points would touch, and how far both are inside the limits of their flanks
        ahead = (polar_angle(r) - polar_angle(surface) + np.pi) % (2.0 * np.pi) - np.pi
        lag = BLADE_SIDES[self.name] * sense * ratio * ahead
        own_margin = np.minimum(-blank.pinion.tip.value(surface), _above_form_point(path.pinion, solution.values[:, 0]))
        margin = np.where(solution.converged, np.minimum(own_margin, self._margin[self._in_contact]), np.nan)
        # the least lag has a corner at the change of pairs; points ahead of it may be as narrow, hence the finer steps
        table = np.full((3, *self._margin.shape), np.nan)
        table[:, self._in_contact] = lag, phi1 / self._pitch, margin
        lag, pitches, margin = _finer(table, table[2] >= 0.0)
        least = path.smooth(np.clip(pitches - np.round(pitches), path.phi[0], path.phi[-1]))
        return float(np.min((lag - least)[margin >= 0.0], initial=0.0) / (self.wanted_lag or np.ptp(path.lag)))

    @cached_property
    def _conjugate(self) -> tuple[Jet, Array]:
        """Points (M,) of the gear's flank, and the gear rotations (rad) at which they are in contact.

        The points are as cut; the contact is at the ratio of the teeth.
        """
        jet, turns, _ = self._of_grid
        met = self._in_contact
        return Jet(*(getattr(jet, name)[met] for name in ("r", "n", "r_u", "r_v", "n_u", "n_v"))), turns[met]

    @cached_property
    def _in_contact(self) -> NDArray[np.bool_]:
        """True for points of the grid that are in contact at some rotation."""
        return np.isfinite(self._of_grid[1]) & np.isfinite(self._margin)

    @property
    def _margin(self) -> Array:
        """Distances (mm) of grid points inside tip and form point of the gear's flank; NaN off the flank."""
        return self._of_grid[2]

    @cached_property
    def _of_grid(self) -> tuple[Jet, Array, Array]:
        """Grid of points of the gear's flank, (up, along): jets, gear rotations (rad) at contact, and margins (mm)."""
        blank, level = self.blank, self.blank.gear.stations
        heights = np.linspace(0.0, MAX_HEIGHT_SHARE * self._gear.tip_height, FLANK_GRID_SHAPE[1])
        p = np.array([self._gear.blade.at_height(float(height)) for height in heights])[:, None]
        stations = np.linspace(*blank.gear.extent, FLANK_GRID_SHAPE[0])
        curves = follow(self._surface, p, stations, level)
        margin = np.minimum(-blank.gear.tip.value(curves.jet.r), _above_form_point(self._gear, p))
        turns = meshing_turns(curves.jet, self._base, HAND_SIGNS[self.design.hand], self._ratio)
        return curves.jet, turns, np.where(curves.converged, margin, np.nan)

    @cached_property
    def _gear(self) -> Generated:
        """Side of the gear that meets the pinion's side."""
        return gear_sides(self.design, self.blank)[MATING_SIDES[self.name]]

    @cached_property
    def _surface(self) -> Surface:
        """Flank of the gear as cut."""
        return self._gear.side(0.0).flank

    @cached_property
    def _base(self) -> Rigid:
        """Motion from the gear's frame to the pinion's."""
        return nominal_base(self.blank, HAND_SIGNS[self.design.hand])

    @property
    def _ratio(self) -> float:
        """Ratio of the teeth, pinion over gear."""
        return self.blank.pinion.teeth / self.blank.gear.teeth

    @property
    def _pitch(self) -> float:
        """Angular pitch of the pinion, rad."""
        return 2.0 * np.pi / self.blank.pinion.teeth

    def _follow(self, pinion: Generated, mean: MeanPoint) -> ContactPreview:
        """Return the path of a pinion's side as cut, from the mean point in both directions."""
        blank, sense = self.blank, float(HAND_SIGNS[self.design.hand])
        pinion_stations, gear_stations = blank.pinion.stations, blank.gear.stations
        pinion_flank = Flank(
            pinion.side(0.0).flank, Mount(Rigid.identity(), sense), {}, pinion_stations, blank.pinion.extent, _NO_GRID
        )
        turned = Mount(self._base @ Rigid.about_z(mean.gear_turn), -sense)
        gear_flank = Flank(self._surface, turned, {}, gear_stations, blank.gear.extent, _NO_GRID)
        contact_point = mean.contact.point[None]
        p = _parameters(pinion, contact_point)
        v, _ = along(pinion_flank.surface, p, pinion_stations.value(contact_point), pinion_stations)
        start = np.array([p[0], v[0], *mean.parameters, 0.0])
        alike = next((path for path in reversed(self._cache.values()) if path is not None), None)
        phi, x = _path((pinion_flank, gear_flank), start, self._pitch, blank.mean_normal_module, alike)
        # surface contact ends where a point leaves the limits of either flank
        r = pinion_flank.surface.jet(x[:, 0], x[:, 1]).r, gear_flank.surface.jet(x[:, 2], x[:, 3]).r
        margins = [
            margin
            for k, (part, side) in enumerate(((blank.pinion, pinion), (blank.gear, self._gear)))
            for margin in self._margins(part, side, r[k], x[:, 2 * k])
        ]
        begin, end = _ends(phi, np.min(margins, axis=0))
        lag = -BLADE_SIDES[self.name] * (x[:, 4] - self._ratio * phi * self._pitch)
        # height over the middle of the working depth: mean of the heights over its lower and upper limit
        above = self._gear.settings.tip_cone().value(r[1]) - blank.clearance
        up = 0.5 * (above + blank.gear.tip.value(r[1]))
        place = np.stack((gear_stations.value(r[1]) - blank.gear.mean_cone_distance, up), axis=-1)
        return ContactPreview(phi, lag, place, begin, end, pinion, mean, x)

    @staticmethod
    def _margins(member: MemberBlank, side: Generated, r: Array, p: Array) -> tuple[Array, ...]:
        """Return the distances (mm) of points r (K, 3) of a flank inside each of its limits.

        `p`: blade parameters (K,) of the points.
        """
        station = member.stations.value(r)
        ends = station - member.inner_cone_distance, member.outer_cone_distance - station
        return *ends, -member.tip.value(r), _above_form_point(side, p)


def _finer(table: Array, on: NDArray[np.bool_]) -> Array:
    """Return a table (K, H, S) where it is `on` (H, S), in finer steps (K, F, S) along its second axis.

    Values are interpolated linearly between neighbouring rows that are on. They are extrapolated linearly up to a step
    beyond, because values that are off may belong to another branch. All others are NaN.
    """
    inside = np.where(on, table, np.nan)
    share, step = np.arange(HEIGHT_SUBDIVISIONS)[:, None] / HEIGHT_SUBDIVISIONS, np.diff(inside, axis=1)[:, :, None]
    off = np.where(np.pad(on, ((1, 1), (0, 0))), np.nan, 0.0)[:, None]
    between = inside[:, :-1, None] + share * step
    above = inside[:, 1:, None] + share * step + off[2:][1:]
    below = inside[:, :-1, None] - share * step + off[:-2][:-1]
    return np.concatenate([part.reshape(len(table), -1, table.shape[-1]) for part in (between, above, below)], axis=1)


def _above_form_point(side: Generated, p: Array) -> Array:
    """Return the distances (mm) of blade parameters p (...,) from the form point, towards the tip of the tooth.

    The form point is where the blade meets its rounding.
    """
    form_point = side.blade.form_point[0]
    # the parameter is a length on a straight blade, an angle on an arc
    height: Array = (
        np.sign(side.blade.at_height(side.tip_height) - form_point)
        * (p - form_point)
        * (abs(side.blade.blade_radius) or 1.0)
    )
    return height


def _parameters(side: Generated, r: Array) -> Array:
    """Return blade parameters (K,) near points r (K, 3), by their height over the machine plane."""
    return np.array([side.blade.at_height(float(height)) for height in side.above_plane(r)])


def _path(
    flanks: tuple[Flank, Flank], x: Array, pitch: float, length: float, alike: ContactPreview | None = None
) -> tuple[Array, Array]:
    """Return rotations phi (K,), pitches, ascending, and unknowns (K, 5) of contacts on both sides of phi1 = 0.

    `x` (5,): start values at phi1 = 0; `pitch`: angular pitch, rad; `length`: mean normal module, mm. A side ends where
    no contact is found. Raises NoSolutionError if the flanks do not meet at the mean point. The positions of a path that is
    `alike` are solved at once, with start values from that path; other positions follow step by step.
    """
    step = PATH_REACH_PITCHES / PATH_STEPS

    def solved(numbers: NDArray[np.intp], starts: Array, halvings: int = STEP_HALVINGS) -> dict[int, Array]:
        """Solve for the unknowns at some numbers of steps, of which those without contact are left out."""
        phi1: Array = np.asarray(numbers, dtype=float) * (step * pitch)
        conditions = Conditions(flanks, phi1, length)
        solution = solve(conditions, starts, tolerance=POSITION_TOLERANCE * length, halvings=halvings)
        return {
            int(k): values for k, values, met in zip(numbers, solution.values, solution.converged, strict=True) if met
        }

    known = dict[int, Array]()
    if alike is not None:
        numbers = np.rint(alike.phi / step).astype(np.intp)
        moved = x - alike.unknowns[np.flatnonzero(numbers == 0)[0]]
        found = solved(numbers, alike.unknowns + moved, ALIKE_HALVINGS)
        for direction in (1, -1):
            k = 0
            while k in found:
                known[k] = found[k]
                k += direction
    if 0 not in known:
        known = solved(np.zeros(1, dtype=np.intp), x[None])
    if not known:
        raise NoSolutionError(reason="the flanks do not meet at the mean point")
    # both sides step by step: start values are extrapolated from up to three positions
    for k in range(1, PATH_STEPS + 1):
        following = [n for n in (k, -k) if n not in known and n - np.sign(n) in known]
        starts = []
        for n in following:
            direction = int(np.sign(n))
            before = [known[n - direction * m] for m in range(1, min(k, 3) + 1)]
            if k == 1:
                # the derivatives at the mean point predict the first step
                rate = Conditions(flanks, np.zeros(1), length).rate(known[0][None], np.zeros(1, dtype=np.intp))[0]
                starts.append(before[0] + direction * step * pitch * rate)
            elif k == 2:
                starts.append(2.0 * before[0] - before[1])
            else:
                starts.append(3.0 * (before[0] - before[1]) + before[2])
        if following:
            known |= solved(np.array(following), np.array(starts))
    order = sorted(known)
    return np.array(order) * step, np.array([known[k] for k in order])


def _ends(phi: Array, inside: Array) -> tuple[float, float]:
    """Return the rotations on both sides of phi = 0 at which `inside` (K,) becomes negative, or phi (K,) ends."""
    middle = int(np.abs(phi).argmin())
    ends = []
    for direction in (-1, 1):
        k = middle
        while 0 <= k + direction < len(phi) and inside[k + direction] >= 0.0:
            k += direction
        beyond = k + direction
        if 0 <= beyond < len(phi) and inside[k] > 0.0:
            ends.append(float(phi[k] + inside[k] / (inside[k] - inside[beyond]) * (phi[beyond] - phi[k])))
        else:
            ends.append(float(phi[k]))
    return ends[0], ends[1]
