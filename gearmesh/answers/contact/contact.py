"""Tooth contact: the path of one tooth pair, the mesh cycle, and Hertz pressure along the path."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.contact.ease_off import EaseOffMap, ease_off_of
from gearmesh.answers.contact.figures import (
    CurvatureFigures,
    CycleSummary,
    EllipseFigures,
    HertzFigures,
    MemberPoint,
    MotionFigures,
    PairCurvature,
    ParameterMeaning,
    PathSummary,
    PositionFigures,
    SpeedFigures,
    TorqueSummary,
    shown_contact,
    slid_summary,
)
from gearmesh.answers.contact.fit import (
    BACKLASH_POSITIONS,
    NO_CONTACT_WARNING,
    BacklashCurve,
    FitDetails,
    FitSummary,
    fit_warnings,
    fitted_cycle,
    verdict,
)
from gearmesh.answers.contact.pattern import PatternFigures, images, pattern_figures, pattern_listing
from gearmesh.answers.contact.sides import SideContact, side_contacts, whole_path, whole_positions
from gearmesh.answers.contact.turns import TurnsDetails, TurnsSummary, turns_listing, turns_warnings
from gearmesh.answers.contact.zone import ZoneFigures, zone_of_lines
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, csv_text, figures, round_to
from gearmesh.contact.engagement.cycle import Cycle, engagement_range
from gearmesh.contact.engagement.ease_off import ease_off
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.contact.engagement.transmission_advance import TransmissionAdvance
from gearmesh.contact.engagement.turns import FullTurns
from gearmesh.contact.first_touch.crossing import crossing_over_a_pitch
from gearmesh.contact.fit.fit import Fit
from gearmesh.contact.flanks import PathHertz, hertz_path, path_curvatures, refuse_torque, solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.sliding import path_motion
from gearmesh.contact.tca import contact_path, jammed_path
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, DesignError, NoSolutionError, Status
from gearmesh.figures import Content, Summary
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.progress import tell
from gearmesh.systems.system import FirstOrder
from gearmesh.teeth.gear_train import GearPair, Member

#: returns the shares (P,) of a torque along a path, from its mesh cycle, and warnings about them
Shares = Callable[[ContactPath, Cycle | None], tuple[Array, list[str]]]
#: load on the path without load sharing, as the summary names it
UNSHARED_LOAD = "all of the torque on one tooth pair"
#: load on the path with load sharing, as the summary names it
SHARED_LOAD = "load sharing by loaded contact"
#: transmission advance at the change of tooth pairs above which a warning is given
WARNED_ADVANCE_ARCSEC = 0.5


@dataclass(frozen=True, repr=False)
class Contact(Result):
    """Contact of a pair of gears."""

    #: the design
    design: Design
    #: the pair
    pair: GearPair
    #: path of contact of one tooth pair, at P positions
    path: ContactPath
    #: parameters of the surfaces at each position, named as in the source, by member
    params: dict[str, list[dict[str, float]]]
    #: figures of the path, of the mesh cycle and of the fit
    summary: Summary
    #: warnings, one line each
    warnings: tuple[str, ...]
    #: whole mesh cycle; None if not asked for, or if nothing touches
    cycle: Cycle | None
    #: Hertz contact along the path; None without a torque
    hertz: PathHertz | None = None
    #: transmission error (P,) in closed form, rad; None if the gear system has none
    first_order: Array | None = None
    #: backlash, clearances and interference; None without a mesh cycle
    fit: Fit | None = None
    #: advance (P,), rad, of a neighbouring tooth pair over this pair
    neighbours: Array | None = None
    #: the pair over whole turns; None if not asked for
    turns: FullTurns | None = None
    #: whole engagement of the tooth pair; None if it has not been followed
    engagement: Engagement | None = None
    #: speed of the pinion, rpm; None if not given
    speed: float | None = None
    #: path from first to last contact if it was solved together with `path`, else None
    _solved_whole: ContactPath | None = None

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, CSV_SUFFIX)

    @property
    def headline(self) -> str:
        touching = f"{int(self.path.touching.sum())} of {len(self.path.phi1)} positions touch"
        ratio = np.nan if self.cycle is None else self.cycle.contact_ratio
        return f"{touching}, contact ratio {ratio:.4g}" if np.isfinite(ratio) else touching

    @property
    def listings(self) -> list[Listing]:
        return [
            *self._path_listing(),
            *self._hertz_listing(),
            *self._speed_listing(),
            *self._closed_listing(),
            *pattern_listing(self.patterns, self.pair.delta),
            *(() if self.turns is None else (turns_listing(self.turns),)),
            figures("Summary", self.summary),
        ]

    def ease_off(self) -> EaseOffMap:
        """Gap between the flanks at the nominal ratio, as returned by `Gears.ease_off`.

        Returns
        -------
        EaseOffMap
            Distances, um, on a grid over the flank.

        Examples
        --------
        >>> len(gears.contact([0.0]).ease_off().rows()) > 100
        True
        """
        return ease_off_of(self.design, self.pair, self.engagement)

    def backlash(self, count: int = BACKLASH_POSITIONS) -> BacklashCurve:
        """The backlash over one pitch of the pinion, beginning at phi1 = 0.

        Parameters
        ----------
        count : int
            Number of equally spaced positions from phi1 = 0 to a pitch; smallest and largest backlash are added.

        Returns
        -------
        BacklashCurve
            phi1, deg; backlash as rotation of the gear, deg, and at its pitch circle, mm.

        Raises
        ------
        NoSolutionError
            If the backlash is unknown: gears that do not touch on both sides, or jam.

        Examples
        --------
        >>> len(gears.contact().backlash(5).phi1)
        5
        """
        if self.fit is None or self.fit.jammed or not np.isfinite(self.fit.backlash).any():
            raise NoSolutionError(reason="the backlash is not known", remedy="tca reports why")
        return BacklashCurve.of(self.pair, self.fit, count)

    @cached_property
    def unlike_turns(self) -> FullTurns | None:
        """The pair over whole turns, also if not asked for.

        None for members with neither eccentricity nor pitch deviations, if there are too many turns, and if teeth lose
        contact.
        """
        if self.turns is not None or not (self.pair.eccentric or self.pair.uneven):
            return self.turns
        try:
            return whole_turns(self.pair)
        except (DesignError, NoSolutionError):
            return None

    @property
    def stuck(self) -> bool:
        """True if the gears are jammed at all positions, so that there is no contact to show."""
        return self.fit is not None and self.fit.jammed and not self.path.touching.any()

    @cached_property
    def whole(self) -> ContactPath | None:
        """Path of a tooth pair from its first to its last contact, independent of the positions.

        None if teeth jam or never touch.
        """
        if self.fit is not None and self.fit.jammed:
            return None
        if self._solved_whole is not None:
            return self._solved_whole
        followed = self.engagement or whole_engagement(solver_pair(self.pair), self.pair.pitch)
        touching = followed is not None and followed.contacts.touching.any()
        known = None if self.cycle is None or self.pair.eccentric else self.cycle.engagement
        return whole_path(self.pair, followed, known) if followed is not None and touching else None

    @cached_property
    def sides(self) -> tuple[SideContact, ...]:
        """Contact on both sides of the teeth; a side without contact is left out."""
        coast = None if self._own_fit is None else self._own_fit.coast_curve
        return side_contacts(self.pair, self.path, self.engagement, coast, self.whole, self._exchange)

    @property
    def _own_fit(self) -> Fit | None:
        """Fit of these members; None without a fit, and where it belongs to eccentric members that stay displaced."""
        return None if self.pair.eccentric else self.fit

    @property
    def _exchange(self) -> Array | None:
        """Diagonal (3,) of the map of the members' frames that makes the coast side of the driving side; None: no image."""
        return None if self._own_fit is None else self._own_fit.exchange

    @cached_property
    def patterns(self) -> tuple[PatternFigures, ...]:
        """Contact pattern on both members, drive and coast side, without load; empty without a mesh cycle.

        Sides whose flanks touch on edges alone have no pattern.
        """
        if self.cycle is None or self.whole is None:
            return ()
        driving = pattern_figures(self.pair, self.whole, driving=True)
        if self._exchange is not None:
            return (*driving, *images(self.pair, driving, self._exchange))
        coast = (side for side in self.sides if not side.driving)
        return (*driving, *(pattern for side in coast for pattern in pattern_figures(side.pair, side.whole)))

    def positions(self) -> list[PositionFigures]:
        """Figures of every position, as in `tca --json`.

        Returns
        -------
        list of PositionFigures
            One per position (P,); NaN where there is no value.

        Examples
        --------
        >>> len(gears.contact([0.0, 1.0]).positions())
        2
        """
        return list(self._positions)

    @cached_property
    def _positions(self) -> tuple[PositionFigures, ...]:
        """Figures of every position, computed once for tables, JSON and CSV."""
        path = self.path
        phi1, phi2, angle = (_degrees(values) for values in (path.phi1, path.phi2, path.angle))
        points, normals, majors = path.point.tolist(), path.normal.tolist(), path.major.tolist()
        member_points = dict(zip(self.params, (path.point1.tolist(), path.point2.tolist()), strict=True))
        regions = list(zip(*(region.tolist() for region in path.regions), strict=True))
        curved, output = self._curvatures(), self.pair.output
        motions = MotionFigures.of(path_motion(self.pair, path), list(self.params))
        hertz = self.hertz

        def at_speed(i: int) -> SpeedFigures | None:
            if self.speed is None:
                return None
            return SpeedFigures.of(motions[i], self.speed, None if hertz is None else float(hertz.peak_pressure[i]))

        backlash = None if self.fit is None or self.fit.jammed else self.fit.play(path.rotation)
        slid_advance = None if self.neighbours is None else output.way(self.neighbours)

        def optional(values: Array | None, factor: float, i: int) -> float | None:
            return None if values is None else float(values[i]) * factor

        return tuple(
            PositionFigures(
                phi1=phi1[i],
                phi2=phi2[i],
                te=float(path.te[i]) / ARCSEC,
                # anything below 1e-12 mm is rounding
                displacement=_less_rounding(output.way(float(path.phi2[i]))),
                te_um=output.way(1e3 * float(path.te[i])),
                contact=str(path.kind[i]),
                edge=str(path.edge[i]) or None,
                regions=dict(zip(member_points, (region or None for region in regions[i]), strict=True)),
                status=Status(int(path.status[i])).name.lower(),
                residual=float(path.residual[i]),
                point=points[i],
                normal=normals[i],
                members={
                    member: MemberPoint(self.params[member][i], member_points[member][i]) for member in member_points
                },
                ellipse=EllipseFigures(float(path.semi_major[i]), float(path.semi_minor[i]), angle[i], majors[i]),
                curvature=curved[i],
                line=path.lines[i],
                hertz=None if hertz is None else _hertz(hertz, i),
                load_share=None if hertz is None else float(hertz.share[i]),
                neighbour_advance=optional(self.neighbours, 1.0 / ARCSEC, i),
                neighbour_advance_um=optional(slid_advance, 1e3, i),
                backlash=optional(backlash, 180.0 / math.pi, i),
                te_first_order=optional(self.first_order, 1.0 / ARCSEC, i),
                line_load=None if hertz is None else float(hertz.line_load[i]),
                motion=motions[i],
                at_speed=at_speed(i),
            )
            for i in range(len(phi1))
        )

    def _curvatures(self) -> list[PairCurvature]:
        """Return principal curvatures and directions at every position, of both flanks and of the gap between them."""
        columns = [
            [
                values.tolist()
                for values in (
                    path_curvature.k1,
                    path_curvature.k2,
                    path_curvature.direction1,
                    path_curvature.direction2,
                )
            ]
            for path_curvature in path_curvatures(self.pair, self.path)
        ]

        def curvatures_at(i: int) -> PairCurvature:
            *flank_curvatures, relative = (CurvatureFigures(*(part[i] for part in column)) for column in columns)
            return PairCurvature(dict(zip(self.params, flank_curvatures, strict=True)), relative)

        return [curvatures_at(i) for i in range(len(self.path.phi1))]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([position.flat for position in self.positions()])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {
            **header(self.design),
            "summary": self.summary,
            "warnings": self.warnings,
            "fit": self._fit,
            **({} if self.cycle is None else {"pattern": self.patterns}),
            **({} if self.turns is None else {"turns": TurnsDetails.of(self.turns)}),
            "surface_parameters": {
                member.name: {
                    name: ParameterMeaning(parameter.unit, parameter.meaning)
                    for name, parameter in member.declared_parameters.items()
                }
                for member in self.pair.both
            },
            "positions": self._positions,
        }

    @property
    def _fit(self) -> FitDetails | None:
        """Details of the fit; None if not asked for."""
        if self.fit is not None:
            return FitDetails.of(self.pair, self.fit)
        return FitDetails(None, verdict(None), NO_CONTACT_WARNING) if NO_CONTACT_WARNING in self.warnings else None

    def csv(self) -> str:
        """The positions as a table; with whole turns, their positions instead.

        Returns
        -------
        str
            CSV, one row per position, with flattened JSON keys as columns; empty where there is no value.

        Examples
        --------
        >>> len(gears.contact([0.0, 1.0]).csv().splitlines())
        3
        """
        if self.turns is not None:
            return csv_text(TurnsDetails.of(self.turns).positions.rows)
        return csv_text([position.flat for position in self.positions()])

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        whole_text(target, self.csv())

    def _path_listing(self) -> list[Listing]:
        """Return the table of positions, rounded, so that rounding errors are shown as 0."""
        names = [(member, name) for member in self.params for name in self.params[member][0]]
        declared = {member.name: member.declared_parameters for member in self.pair.both}
        reading = self.pair.output.reading
        heads = ["phi1 deg", f"{reading.quantity} {reading.motion[1]}", f"TE {reading.error[1]}"]
        heads += ["contact", "a mm", "b mm"]
        values = [
            [
                round_to(position.phi1, 4),
                round_to(position.phi2 if position.displacement is None else position.displacement, 4),
                round_to(position.te if position.te_um is None else position.te_um, 3),
                shown_contact(position.contact, position.edge, tuple(self.pair.members)),
                round_to(position.ellipse.a, 4),
                round_to(position.ellipse.b, 4),
                *(round_to(position.members[member].params[name], 4) for member, name in names),
            ]
            for position in self._positions
        ]
        known = [(member, name, declared[member].get(name)) for member, name in names]
        heads += [f"{member} {name if parameter is None else parameter.heading}" for member, name, parameter in known]
        labels: dict[str, dict[str, None]] = {}
        for *_, parameter in known:
            if parameter is not None:
                labels.setdefault(parameter.meaning, {})[parameter.label] = None
        notes = [f"{', '.join(alike)}: {meaning}" for meaning, alike in labels.items()]
        return [Listing("Contact", heads, values, notes=notes)]

    def _hertz_listing(self) -> list[Listing]:
        """Return the table of the Hertz contact; none without a torque."""
        if self.hertz is None:
            return []
        values = [
            [
                round_to(position.phi1, 4),
                *(round_to(entry.value, n) for entry, n in zip(position.hertz.entries, _HERTZ_DIGITS, strict=True)),
                round_to(100.0 * share, 1),
            ]
            for position, share in zip(self._positions, self.hertz.share.tolist(), strict=True)
            if position.hertz is not None
        ]
        heads = ["phi1 deg", *(figure.key.replace("_", " ") for figure in HertzFigures.declared_figures()), "share %"]
        how = "shared" if self.summary.get("load_sharing") == SHARED_LOAD else "all on this tooth pair"
        title = f"Hertz contact, {self.hertz.torque:g} Nm on the {self.pair.pinion.name}, {how}"
        return [Listing(title, heads, values)]

    def _speed_listing(self) -> list[Listing]:
        """Return the table of velocities; none without a speed."""
        if self.speed is None:
            return []
        rows = [
            [round_to(position.phi1, 4), *(round_to(value, 4) for value in position.at_speed.flat.values())]
            for position in self._positions
            if position.at_speed is not None
        ]
        first, second = self.params
        heads = ["phi1 deg", "sliding m/s", f"{first} m/s", f"{second} m/s", "entrainment m/s"]
        heads += [] if self.hertz is None else ["p v MPa m/s"]
        return [Listing(f"Sliding and rolling, {self.speed:g} rpm of the {first}", heads, rows)]

    def _closed_listing(self) -> list[Listing]:
        """Return the table of solver and closed form; none if the gear system has no closed form."""
        if self.first_order is None:
            return []
        rows = [
            [round_to(float(np.degrees(phi1)), 4), round_to(te / ARCSEC, 3), round_to(closed / ARCSEC, 3)]
            for phi1, te, closed in zip(self.path.phi1, self.path.te, self.first_order, strict=True)
        ]
        return [Listing("Transmission error by the solver and, of first order, in closed form", _CLOSED_HEADS, rows)]


#: decimals of the figures of the Hertz contact
_HERTZ_DIGITS = (1, 4, 4, 3, 2)
#: headings of the table with the closed form
_CLOSED_HEADS = ("phi1 deg", "TE arcsec", "closed form arcsec")


#: keys of the range of positions
PHI1_RANGE_KEYS = ("contact.phi1.start", "contact.phi1.stop")


def by_engagement(design: Design, pair: GearPair) -> bool:
    """Return True if positions follow the engagement; angles of a source's tables are not related to it."""
    return pair.generation is None and not any(map(design.sets, PHI1_RANGE_KEYS))


def positions_of(design: Design, pair: GearPair) -> tuple[float, float] | None:
    """Return the first and last position (deg) of the engagement of a pair whose design sets no range.

    None if the positions do not follow the engagement, or the teeth never meet.
    """
    if not by_engagement(design, pair):
        return None
    followed = whole_engagement(solver_pair(pair), pair.pitch)
    if followed is None or not followed.contacts.touching.any():
        return None
    first, last = np.degrees(engagement_range(followed, pair.pitch))
    return float(first), float(last)


def refuse_torques(torque: float | None, *, load_sharing: bool) -> None:
    """Raise ArgumentError for an invalid torque (Nm), and for load sharing without a torque."""
    if load_sharing and torque is None:
        raise ArgumentError("load_sharing", True, must_be="left out without a torque that is shared")
    if torque is not None:
        refuse_torque(torque)


@dataclass(frozen=True)
class MeshSolution:
    """Solved mesh of a pair, on which its contact is built."""

    #: mounted flanks of the pair
    flanks: Pair
    #: whole engagement of a tooth pair; None where the teeth never meet
    followed: Engagement | None
    #: fit of the gears; None where nothing touches
    fit: Fit | None
    #: mesh cycle; None where nothing touches
    cycle: Cycle | None

    @staticmethod
    def of(pair: GearPair) -> MeshSolution:
        """Solve the mesh of a pair."""
        flanks = solver_pair(pair)
        followed = whole_engagement(flanks, pair.pitch)
        tell(0.3)
        return MeshSolution(flanks, followed, *((None, None) if followed is None else fitted_cycle(pair, followed)))

    def summary(self, pair: GearPair) -> Summary:
        """Return the figures of a pair that its mesh determines; the path of contact adds others."""
        cycle = None if self.cycle is None else CycleSummary.of(self.cycle)
        return Summary(cycle, None if self.fit is None else FitSummary.of(pair, self.fit))


def contact_of(
    design: Design,
    pair: GearPair,
    warnings: tuple[str, ...] = (),
    *,
    phi1: Array | None = None,
    torque: float | None = None,
    shares: Shares | None = None,
    cycle: bool = True,
    first_order: FirstOrder | None = None,
    turns: bool = False,
    speed: float | None = None,
    mesh: MeshSolution | None = None,
) -> Contact:
    """Return the contact of a pair at phi1 (P,), rad, and the whole mesh cycle.

    The default positions are those of the design; if it sets none, they extend from the first to the last contact of a
    tooth pair. A `torque` (Nm) on the pinion adds the Hertz contact, with the whole load on one tooth pair or with its
    `shares`. `turns` adds the pair over whole turns, until it repeats. A `speed` (rpm) of the pinion adds velocities.
    A `mesh` of the pair that is solved already saves its solution.
    Raises ArgumentError for a torque that is not above 0, and for sharing without a torque.
    """
    # positions: those asked for, those of the design, or the engagement of a tooth pair
    following = phi1 is None and by_engagement(design, pair)
    if cycle:
        mesh = mesh or MeshSolution.of(pair)
        flanks, followed, fits, whole = mesh.flanks, mesh.followed, mesh.fit, mesh.cycle
    else:
        flanks, fits, whole = solver_pair(pair), None, None
        followed = whole_engagement(flanks, pair.pitch) if following else None
    tell(0.7)
    # first and last contact of the pair as the cycle knows them; its phi1 is not the phi1 of a source's tables
    known = None if whole is None or pair.eccentric or pair.generation is not None else whole.engagement
    if following and followed is not None and followed.contacts.touching.any():
        ends = np.degrees(engagement_range(followed, pair.pitch, whole) if known is None else known)
        design = design.with_values(dict(zip(PHI1_RANGE_KEYS, map(float, ends), strict=True)))
    # positions over the whole engagement, for pictures and the pattern
    more = np.empty(0) if phi1 is not None or known is None else whole_positions(known)
    if phi1 is None:
        wanted = design.contact.phi1
        phi1 = np.radians(np.linspace(wanted.start, wanted.stop, wanted.count))
    path, solved_whole = _solved_paths(pair, flanks, phi1, more, followed, fits)
    tell(0.9)
    summary = Summary(_summary(pair, path, whole), pair.figures, None if fits is None else FitSummary.of(pair, fits))
    hertz = None
    if torque is not None:
        from gearmesh.answers.load.members import materials_of

        share, share_warnings = shares(path, whole) if shares is not None else (np.ones(1), [])
        warnings = (*warnings, *share_warnings)
        hertz = hertz_path(pair, path, torque, materials_of(design, pair), share)
        peak = hertz.peak_pressure[~np.isnan(hertz.peak_pressure)]
        how = UNSHARED_LOAD if shares is None else SHARED_LOAD
        summary = Summary(summary, TorqueSummary(torque, how, float(peak.max()) if peak.size else None))
    all_turns = whole_turns(pair) if turns else None
    if all_turns is not None:
        summary = Summary(summary, TurnsSummary.of(pair, all_turns))
        warnings = (*warnings, *turns_warnings(pair, all_turns))
    if fits is not None:
        warnings = (*warnings, *fit_warnings(pair, fits))
    elif cycle:
        warnings = (*warnings, NO_CONTACT_WARNING)
    warnings = (
        *warnings,
        *_contact_warnings(pair, path, whole),
        *_break_warnings(pair, whole, design.keeps_from_crossing),
    )
    return Contact(
        design,
        pair,
        path,
        {
            member.name: _named_parameters(member, params)
            for member, params in zip(pair.both, (path.params1, path.params2), strict=True)
        },
        summary,
        warnings,
        whole,
        hertz,
        None if first_order is None else first_order(path.rotation),
        fits,
        _neighbours(pair, path, followed, whole),
        all_turns,
        None if whole is None or whole.curve is None else followed,
        speed,
        solved_whole,
    )


def _solved_paths(
    pair: GearPair, flanks: Pair, phi1: Array, more: Array, followed: Engagement | None, fits: Fit | None
) -> tuple[ContactPath, ContactPath | None]:
    """Return the path at phi1 (P,), rad, empty where gears jam, and the path at the positions `more` (Q,); None for Q = 0.

    Both are solved in one batch: the time is that of calls, not of positions.
    """
    path = jammed_path(flanks, phi1)
    # gears that jam have no contact at these positions; without any contact nothing is solved
    jams = np.zeros(len(phi1), dtype=bool) if fits is None else fits.jams(phi1)
    if fits is not None and fits.jammed and jams.all():
        return path, None
    solved = contact_path(flanks, np.concatenate((phi1, more)), pair.generation, engagement=followed)
    path = solved.part_of(slice(0, len(phi1))).without(path, jams)
    return path, solved.part_of(slice(len(phi1), None)) if more.size else None


def _neighbours(pair: GearPair, path: ContactPath, followed: Engagement | None, cycle: Cycle | None) -> Array | None:
    """Return the advance (P,), rad, of a neighbouring tooth pair; None if the pair has not been followed."""
    if followed is None or (pair.eccentric and (cycle is None or cycle.curve is None)):
        return None
    advance = TransmissionAdvance(followed) if cycle is None or cycle.curve is None else cycle.curve.of_pair
    return advance.over_neighbours(pair.pitch, path.rotation)


def _summary(pair: GearPair, path: ContactPath, cycle: Cycle | None) -> Summary:
    zone = None if cycle is None else zone_of_lines(pair, path)
    figures = Summary(
        PathSummary.of(pair, path),
        None if cycle is None else CycleSummary.of(cycle),
        None if zone is None else ZoneFigures.of(zone),
    )
    return Summary(figures, slid_summary(pair, figures))


def _less_rounding(value: float | None) -> float | None:
    """Return a value rounded to 1e-12; anything below is rounding."""
    return None if value is None else round(value, 12)


def _hertz(hertz: PathHertz, i: int) -> HertzFigures:
    values = hertz.peak_pressure, hertz.semi_major, hertz.semi_minor, 1e3 * hertz.approach, hertz.force
    return HertzFigures(*(float(value[i]) for value in values))


def _contact_warnings(pair: GearPair, path: ContactPath, cycle: Cycle | None) -> list[str]:
    """Return warnings about the figures: a transmission advance at the change of tooth pairs, and unequal teeth."""
    warnings = []
    if pair.eccentric:
        warnings.append(
            "eccentric members: the transmission error differs from tooth pair to tooth pair; the path is that of the tooth pair "
            "at phi1 = 0, mesh cycle, backlash and clearances are those of members that stay displaced as at phi1 = 0, figures "
            "over whole turns (--turns) are for all tooth pairs as they are"
        )
    if pair.uneven:
        warnings.append(
            "pitch deviations: every tooth pair is ahead or behind by its own; path, mesh cycle and backlash are for teeth at "
            "their places, figures over whole turns (--turns) for all tooth pairs as they are"
        )
    if pair.eccentric:
        # curvature of the error over a pitch, without the effect of the eccentricities over a turn
        known = cycle is not None and cycle.curve is not None
        path = contact_path(cycle.curve.engagement.pair, path.rotation) if cycle and cycle.curve and known else path
    inside = path.kind == "point"
    if inside.sum() >= 5:
        bend = pair.drive * np.polyfit(path.phi1[inside], path.te[inside], 2)[0]
        advance = bend * (0.5 * pair.pitch) ** 2
        if advance / ARCSEC > WARNED_ADVANCE_ARCSEC:
            rad, unit = pair.output.reading.error
            warnings.append(
                f"the gear runs ahead by {advance / rad:.3g} {unit} at the change of tooth pairs (the transmission error is "
                "curved the wrong way): the pairs change over in edge contact"
            )
    return warnings


def _break_warnings(pair: GearPair, cycle: Cycle | None, keeps_from_crossing: str) -> list[str]:
    """Return a line for each jump of the transmission error.

    `keeps_from_crossing` is the remedy for flanks that cross.
    """
    if cycle is not None and cycle.curve is not None and cycle.curve.pair.coupled and cycle.contact_ratio < 1.0:
        return [
            f"members out of place: the tooth pair that touches first does so inside both flanks over {cycle.contact_ratio:.3g} "
            "pitches, beyond that on edges; `describe` has the gaps of all tooth pairs"
        ]
    warnings, (rad, unit) = [], pair.output.reading.error
    total = total_ratio(pair, cycle) if cycle is not None and cycle.contact_ratio < 1.0 else math.inf
    if cycle is not None and total < 1.0:
        warnings.append(
            f"contact ratio {cycle.contact_ratio:.4g} of the flank surfaces is below 1: between two tooth pairs there is edge "
            "contact; higher teeth, less undercut (which `limits` shows), a wider face or less crowning increase it"
        )
    if cycle is not None and math.isnan(cycle.contact_ratio) and not math.isnan(cycle.peak_to_peak):
        warnings.append(_edge_contact(pair, cycle, keeps_from_crossing))
    for place in cycle.breaks if cycle else ():
        what = "begins" if place.beginning else "ends"
        size, why = "before that of the next pair begins", ""
        if cycle is not None and 1.0 <= total < math.inf:
            why = f": without load the contact ratio is {cycle.contact_ratio:.4g}, with conjugate flanks it would be {total:.4g}"
        if not np.isnan(place.jump):
            size = f"{place.jump / rad:.3g} {unit} ahead of the {'previous' if place.beginning else 'next'} pair"
        warnings.append(
            f"the transmission error jumps: at phi1 = {np.degrees(place.phi1):.5g} deg the surface contact of a tooth pair "
            f"{what} {size}; there is edge contact there{why}"
        )
    return warnings


def _edge_contact(pair: GearPair, cycle: Cycle, keeps_from_crossing: str) -> str:
    """Return the reason for contact on edges only, and the remedy.

    Neither crowning nor mounting helps if flanks of some tooth pair cross at every position of a pitch.
    """
    where = "edge contact alone: at no position do the flanks touch inside both; "
    if cycle.curve is not None and keeps_from_crossing:
        engagement = cycle.curve.engagement
        if crossing_over_a_pitch(engagement.pair.parts[0], engagement.phi1, pair.pitch):
            return f"{where}where they are tangent they cross, and are inside each other towards the edges; {keeps_from_crossing}"
    return f"{where}crowning, or smaller errors of assembly, bring the contact there"


def total_ratio(pair: GearPair, cycle: Cycle) -> float:
    """Return the total contact ratio: the pitches over which one tooth pair would touch anywhere on its flanks.

    It is the ratio for conjugate flanks. Crowning, which reduces contact without load to points, does not reduce it.
    """
    if cycle.curve is None:
        return cycle.contact_ratio
    phi1 = ease_off(cycle.curve.engagement, pair.pitch).phi1
    met = phi1[np.isfinite(phi1)]
    return max(cycle.contact_ratio, float(np.ptp(met)) / pair.pitch if met.size else 0.0)


def _named_parameters(member: Member, params: Array) -> list[dict[str, float]]:
    named = member.source_parameters(params[:, 0], params[:, 1])
    return [dict(zip(named, map(float, row), strict=True)) for row in zip(*named.values(), strict=True)]


def _degrees(radians: Array) -> list[float]:
    """Return angles in degrees, without the rounding of the conversion to radians and back."""
    return [float(value) for value in (radians * (180.0 / math.pi)).round(12)]
