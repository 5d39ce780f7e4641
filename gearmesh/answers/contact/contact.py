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
    PairCurvature,
    PathSummary,
    PositionFigures,
    TorqueSummary,
    shown_contact,
    slid_summary,
)
from gearmesh.answers.contact.fit import (
    BACKLASHES,
    UNMET,
    BacklashCurve,
    FitDetails,
    FitSummary,
    fit_warnings,
    fitted_cycle,
    verdict,
)
from gearmesh.answers.contact.sides import SideContact, side_contacts, whole_path
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
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path, jammed_path
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, DesignError, NoSolutionError, Status
from gearmesh.figures import Content, Summary
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.progress import tell
from gearmesh.systems.system import FirstOrder
from gearmesh.teeth.gear_train import GearPair, Member

#: shares (P,) of a torque along a path, from its mesh cycle, and what is to be said of them
Shares = Callable[[ContactPath, Cycle | None], tuple[Array, list[str]]]
#: how the torque of the Hertz contact is shared
ALONE, SHARED = "all of the torque on one tooth pair", "load sharing by loaded contact"
#: advance (arcsec) at the change of teeth from which on it is worth a warning
ADVANCE = 0.5


@dataclass(frozen=True, repr=False)
class Contact(Result):
    """Contact of a pair of gears.

    `path`: of one tooth pair, P positions; `params`: its parameters named as in the source, per position, for each
    member; `cycle`: the whole mesh cycle, None where it was not asked for or nothing touches; `hertz`: only where a torque was
    asked for; `first_order` (P,): transmission error in closed form, rad, where the gear system knows one; `fit`: backlash,
    clearance and what interferes, None where there is no cycle; `neighbours` (P,), rad: how far a neighbouring tooth pair is
    ahead of this one; `turns`: the pair over whole turns, only where they were asked for.
    """

    design: Design
    pair: GearPair
    path: ContactPath
    params: dict[str, list[dict[str, float]]]
    summary: Summary
    warnings: tuple[str, ...]
    cycle: Cycle | None
    hertz: PathHertz | None = None
    first_order: Array | None = None
    fit: Fit | None = None
    neighbours: Array | None = None
    turns: FullTurns | None = None
    #: the whole engagement of the tooth pair, None where it has not been followed
    engagement: Engagement | None = None

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (".json", ".csv")

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
            *self._closed_listing(),
            *(() if self.turns is None else (turns_listing(self.turns),)),
            figures("Summary", self.summary),
        ]

    def ease_off(self) -> EaseOffMap:
        """How far the pinion's flank stays from the gear's, as `Gears.ease_off`.

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

    def backlash(self, count: int = BACKLASHES) -> BacklashCurve:
        """The backlash over one pitch of the pinion, from phi1 = 0 on.

        Parameters
        ----------
        count : int
            Positions, evenly from phi1 = 0 to a pitch; its least and greatest values beside them.

        Returns
        -------
        BacklashCurve
            phi1, deg, backlash as rotation of the gear, deg, and at its pitch circle, mm.

        Raises
        ------
        NoSolutionError
            Where it is not known: gears that do not touch on both sides, or jam.

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
        """The pair over whole turns, asked for or not; None of members that are neither eccentric nor have pitch deviations, and
        where turns are too many or teeth do not meet all the time."""
        if self.turns is not None or not (self.pair.eccentric or self.pair.uneven):
            return self.turns
        try:
            return whole_turns(self.pair)
        except (DesignError, NoSolutionError):
            return None

    @property
    def stuck(self) -> bool:
        """Whether gears are jammed at all positions, so that there is no contact to show."""
        return self.fit is not None and self.fit.jammed and not self.path.touching.any()

    @cached_property
    def whole(self) -> ContactPath | None:
        """The path of a tooth pair from its first touch to its last, whatever positions were asked for; None where teeth do not
        touch, or jam."""
        if self.fit is not None and self.fit.jammed:
            return None
        followed = self.engagement or whole_engagement(solver_pair(self.pair), self.pair.pitch)
        touching = followed is not None and followed.contacts.touching.any()
        return whole_path(self.pair, followed) if followed is not None and touching else None

    @cached_property
    def sides(self) -> tuple[SideContact, ...]:
        """The contact on both sides of the teeth; a side without contact is left out."""
        # the fit of eccentric members is of others, that stand
        known = self.fit is not None and not self.pair.eccentric
        coast = self.fit.coast if self.fit and known else None
        return side_contacts(self.pair, self.path, self.engagement, coast, self.whole)

    def positions(self) -> list[PositionFigures]:
        """The figures of `tca --json` at every position.

        Returns
        -------
        list of PositionFigures
            One per position (P,); NaN where there is nothing.

        Examples
        --------
        >>> len(gears.contact([0.0, 1.0]).positions())
        2
        """
        return list(self._positions)

    @cached_property
    def _positions(self) -> tuple[PositionFigures, ...]:
        """The same, found once for tables, JSON and CSV."""
        path = self.path
        phi1, phi2, angle = (_degrees(values) for values in (path.phi1, path.phi2, path.angle))
        points, normals, majors = path.point.tolist(), path.normal.tolist(), path.major.tolist()
        own = dict(zip(self.params, (path.point1.tolist(), path.point2.tolist()), strict=True))
        regions = list(zip(*(region.tolist() for region in path.regions), strict=True))
        curved, output = self._curvatures(), self.pair.output

        plays = None if self.fit is None or self.fit.jammed else self.fit.play(path.rotation)
        led = None if self.neighbours is None else output.way(self.neighbours)

        def optional(values: Array | None, factor: float, i: int) -> float | None:
            return None if values is None else float(values[i]) * factor

        return tuple(
            PositionFigures(
                phi1=phi1[i],
                phi2=phi2[i],
                te=float(path.te[i]) / ARCSEC,
                # to 1e-12 mm: what is less is rounding
                displacement=_less_rounding(output.way(float(path.phi2[i]))),
                te_um=output.way(1e3 * float(path.te[i])),
                contact=str(path.kind[i]),
                edge=str(path.edge[i]) or None,
                regions=dict(zip(own, (region or None for region in regions[i]), strict=True)),
                status=Status(int(path.status[i])).name.lower(),
                residual=float(path.residual[i]),
                point=points[i],
                normal=normals[i],
                members={member: MemberPoint(self.params[member][i], own[member][i]) for member in own},
                ellipse=EllipseFigures(float(path.semi_major[i]), float(path.semi_minor[i]), angle[i], majors[i]),
                curvature=curved[i],
                line=path.lines[i],
                hertz=None if self.hertz is None else _hertz(self.hertz, i),
                load_share=None if self.hertz is None else float(self.hertz.share[i]),
                neighbour_advance=optional(self.neighbours, 1.0 / ARCSEC, i),
                neighbour_advance_um=optional(led, 1e3, i),
                backlash=optional(plays, 180.0 / math.pi, i),
                te_first_order=optional(self.first_order, 1.0 / ARCSEC, i),
            )
            for i in range(len(phi1))
        )

    def _curvatures(self) -> list[PairCurvature]:
        """Principal curvatures and directions at every position: of both flanks, and relative ones."""
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
            *own, relative = (CurvatureFigures(*(part[i] for part in column)) for column in columns)
            return PairCurvature(dict(zip(self.params, own, strict=True)), relative)

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
            **({} if self.turns is None else {"turns": TurnsDetails.of(self.turns)}),
            "positions": self._positions,
        }

    @property
    def _fit(self) -> FitDetails | None:
        """What is known of how the gears fit; None where it was not asked for."""
        if self.fit is not None:
            return FitDetails.of(self.pair, self.fit)
        return FitDetails(None, verdict(None), UNMET) if UNMET in self.warnings else None

    def csv(self) -> str:
        """The positions as a table; of whole turns theirs instead.

        Returns
        -------
        str
            CSV, one row per position, the columns of the JSON laid flat, empty where there is nothing.

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
        """Rounded, so that what is zero but for rounding reads as zero."""
        names = [(member, name) for member in self.params for name in self.params[member][0]]
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
        heads += [f"{member} {name}" for member, name in names]
        return [Listing("Contact", heads, values)]

    def _hertz_listing(self) -> list[Listing]:
        """The table of the Hertz contact, if a torque was asked for."""
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
        how = "shared" if self.summary.get("load_sharing") == SHARED else "all on this tooth pair"
        title = f"Hertz contact, {self.hertz.torque:g} Nm on the {self.pair.pinion.name}, {how}"
        return [Listing(title, heads, values)]

    def _closed_listing(self) -> list[Listing]:
        """The closed form beside the solver, where the gear system knows one."""
        if self.first_order is None:
            return []
        rows = [
            [round_to(float(np.degrees(phi1)), 4), round_to(te / ARCSEC, 3), round_to(closed / ARCSEC, 3)]
            for phi1, te, closed in zip(self.path.phi1, self.path.te, self.first_order, strict=True)
        ]
        return [Listing("Transmission error by the solver and, of first order, in closed form", _CLOSED_HEADS, rows)]


#: decimals of the figures of the Hertz contact
_HERTZ_DIGITS = (1, 4, 4, 3, 2)
_CLOSED_HEADS = ("phi1 deg", "TE arcsec", "closed form arcsec")


#: the range of positions
RANGE = ("contact.phi1.start", "contact.phi1.stop")


def by_engagement(design: Design, pair: GearPair) -> bool:
    """Whether positions follow the engagement: angles by which a source counts its tables are not those of the engagement."""
    return pair.generation is None and not any(map(design.sets, RANGE))


def positions_of(design: Design, pair: GearPair) -> tuple[float, float] | None:
    """First and last position (deg) of a pair whose design sets none: its engagement. None where it does not follow that, or
    the teeth never meet."""
    if not by_engagement(design, pair):
        return None
    followed = whole_engagement(solver_pair(pair), pair.pitch)
    if followed is None or not followed.contacts.touching.any():
        return None
    first, last = np.degrees(engagement_range(followed, pair.pitch))
    return float(first), float(last)


def refuse_torques(torque: float | None, *, load_sharing: bool) -> None:
    """Raise ArgumentError for a torque (Nm) that is none, and for load sharing without one."""
    if load_sharing and torque is None:
        raise ArgumentError("load_sharing", True, must_be="left out without a torque that is shared")
    if torque is not None:
        refuse_torque(torque)


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
) -> Contact:
    """Contact of a pair at phi1 (P,), rad, and the whole mesh cycle.

    By default at the design's positions, which, where it sets none, go from the first touch of a tooth pair to its last.

    With a `torque` (Nm) on the pinion also its Hertz contact, all load on the one tooth pair or those `shares` of it. With
    `turns` also the pair over whole turns, until it repeats. Raises
    DesignError for a torque that is not above 0, and for sharing without one.
    """
    flanks = solver_pair(pair)
    following = phi1 is None and by_engagement(design, pair)
    followed = whole_engagement(flanks, pair.pitch) if cycle or following else None
    tell(0.3)
    fits, whole = fitted_cycle(pair, followed) if cycle and followed is not None else (None, None)
    tell(0.7)
    if following and followed is not None and followed.contacts.touching.any():
        known = whole is not None and not pair.eccentric
        ends = np.degrees(
            whole.engagement if whole is not None and known else engagement_range(followed, pair.pitch, whole)
        )
        design = design.with_values(dict(zip(RANGE, map(float, ends), strict=True)))
    if phi1 is None:
        wanted = design.contact.phi1
        phi1 = np.radians(np.linspace(wanted.start, wanted.stop, wanted.count))
    jams = np.zeros(len(phi1), dtype=bool) if fits is None else fits.jams(phi1)
    path = jammed_path(flanks, phi1)
    if fits is None or not (fits.jammed and jams.all()):
        path = contact_path(flanks, phi1, pair.generation, engagement=followed).without(path, jams)
    tell(0.9)
    summary = Summary(_summary(pair, path, whole), pair.figures, None if fits is None else FitSummary.of(pair, fits))
    hertz = None
    if torque is not None:
        from gearmesh.answers.load.materials import materials_of

        share, said = shares(path, whole) if shares is not None else (np.ones(1), [])
        warnings = (*warnings, *said)
        hertz = hertz_path(pair, path, torque, materials_of(design, pair), share)
        peak = hertz.peak_pressure[~np.isnan(hertz.peak_pressure)]
        how = ALONE if shares is None else SHARED
        summary = Summary(summary, TorqueSummary(torque, how, float(peak.max()) if peak.size else None))
    all_turns = whole_turns(pair) if turns else None
    if all_turns is not None:
        summary = Summary(summary, TurnsSummary.of(pair, all_turns))
        warnings = (*warnings, *turns_warnings(pair, all_turns))
    return Contact(
        design,
        pair,
        path,
        {
            member.name: _named_parameters(member, params)
            for member, params in zip(pair.both, (path.params1, path.params2), strict=True)
        },
        summary,
        (
            *warnings,
            *((UNMET,) if cycle and fits is None else fit_warnings(pair, fits) if fits is not None else ()),
            *_contact_warnings(pair, path, whole),
            *_break_warnings(pair, whole, design.keeps_from_crossing),
        ),
        whole,
        hertz,
        None if first_order is None else first_order(path.rotation),
        fits,
        _neighbours(pair, path, followed, whole),
        all_turns,
        None if whole is None or whole.curve is None else followed,
    )


def _neighbours(pair: GearPair, path: ContactPath, followed: Engagement | None, cycle: Cycle | None) -> Array | None:
    """How far (P,), rad, a neighbouring tooth pair is ahead, where the pair has been followed."""
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
    """To 1e-12: what is less is rounding."""
    return None if value is None else round(value, 12)


def _hertz(hertz: PathHertz, i: int) -> HertzFigures:
    values = hertz.peak_pressure, hertz.semi_major, hertz.semi_minor, 1e3 * hertz.approach, hertz.force
    return HertzFigures(*(float(value[i]) for value in values))


def _contact_warnings(pair: GearPair, path: ContactPath, cycle: Cycle | None) -> list[str]:
    """Warnings about the figures: a transmission advance at the change of tooth pairs, and teeth that are not all alike."""
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
        # how the error is curved over a pitch, without what the eccentricities do over a turn
        known = cycle is not None and cycle.curve is not None
        path = contact_path(cycle.curve.engagement.pair, path.rotation) if cycle and cycle.curve and known else path
    inside = path.kind == "point"
    if inside.sum() >= 5:
        bend = pair.drive * np.polyfit(path.phi1[inside], path.te[inside], 2)[0]
        advance = bend * (0.5 * pair.pitch) ** 2
        if advance / ARCSEC > ADVANCE:
            rad, unit = pair.output.reading.error
            warnings.append(
                f"the gear runs ahead by {advance / rad:.3g} {unit} at the change of tooth pairs (the transmission error is "
                "curved the wrong way): the pairs change over in edge contact"
            )
    return warnings


def _break_warnings(pair: GearPair, cycle: Cycle | None, keeps_from_crossing: str) -> list[str]:
    """Where the transmission error is discontinuous, one line each; what `keeps_from_crossing` flanks that do."""
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
    """Why there is edge contact alone, and what helps: against flanks that cross, of some tooth pair at every position of a pitch,
    neither crowning nor a mounting does."""
    where = "edge contact alone: at no position do the flanks touch inside both; "
    if cycle.curve is not None and keeps_from_crossing:
        engagement = cycle.curve.engagement
        if crossing_over_a_pitch(engagement.pair.parts[0], engagement.phi1, pair.pitch):
            return f"{where}where they are tangent they cross, and are inside each other towards the edges; {keeps_from_crossing}"
    return f"{where}crowning, or smaller errors of assembly, bring the contact there"


def total_ratio(pair: GearPair, cycle: Cycle) -> float:
    """The total contact ratio: pitches over which one tooth pair would touch somewhere on its flanks, were these conjugate. What
    a crowning takes away, so that contact without load is in a point, is not taken off."""
    if cycle.curve is None:
        return cycle.contact_ratio
    phi1 = ease_off(cycle.curve.engagement, pair.pitch).phi1
    met = phi1[np.isfinite(phi1)]
    return max(cycle.contact_ratio, float(np.ptp(met)) / pair.pitch if met.size else 0.0)


def _named_parameters(member: Member, params: Array) -> list[dict[str, float]]:
    named = member.source_parameters(params[:, 0], params[:, 1])
    return [dict(zip(named, map(float, row), strict=True)) for row in zip(*named.values(), strict=True)]


def _degrees(radians: Array) -> list[float]:
    """Degrees; the last digits, which going to radians and back leaves behind, are rounded away."""
    return [float(value) for value in (radians * (180.0 / math.pi)).round(12)]
