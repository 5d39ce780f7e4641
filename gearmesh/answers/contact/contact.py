"""Tooth contact: the path of one pair of teeth, the mesh cycle, and Hertz pressure along the path."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.contact.ease_off import EaseOffMap, ease_off_of
from gearmesh.answers.contact.fit import UNMET, fit_details, fit_summary, fit_warnings, fitted_cycle, verdict
from gearmesh.answers.contact.sides import SideContact, side_contacts
from gearmesh.answers.contact.turns import turns_details, turns_listing, turns_rows, turns_summary, turns_warnings
from gearmesh.answers.load.materials import materials_of
from gearmesh.answers.result import Result, columns, header, times_apart
from gearmesh.answers.tables import Listing, csv_text, figures, flat, rounded
from gearmesh.contact.cycle import Cycle, engagement_range
from gearmesh.contact.ease_off import ease_off
from gearmesh.contact.engagement import Engagement, engaged
from gearmesh.contact.fit import Fit
from gearmesh.contact.flanks import PathHertz, hertz_path, path_curvatures, solver_pair
from gearmesh.contact.lead import PairLead
from gearmesh.contact.path import ARCSEC, ContactPath, error_unit
from gearmesh.contact.tca import contact_path, jammed_path
from gearmesh.contact.turns import FullTurns, full_turns
from gearmesh.design.core import Design
from gearmesh.errors import DesignError, Status
from gearmesh.kernel.algebra import Array
from gearmesh.systems.system import FirstOrder
from gearmesh.teeth.train import GearPair, Member

#: shares (P,) of a torque along a path, from its mesh cycle, and what is to be said of them
Shares = Callable[[ContactPath, Cycle | None], tuple[Array, list[str]]]
#: how the torque of the Hertz contact is shared
ALONE, SHARED = "one tooth pair carries all of the torque", "shares of the torque by loaded contact"
#: lead (arcsec) at the change of teeth from which on it is worth a warning
LEAD = 0.5


@dataclass(frozen=True, repr=False)
class Contact(Result):
    """Contact of a pair of gears.

    `path`: of one pair of teeth, P positions; `params`: its parameters named as in the source, one dict a position for each
    member; `cycle`: the whole mesh cycle, None where it was not asked for or nothing touches; `hertz`: only where a torque was
    asked for; `first_order` (P,): transmission error in closed form, rad, where the gear system knows one; `fit`: backlash,
    clearance and what interferes, None where there is no cycle; `neighbours` (P,), rad: how far a neighbouring pair of teeth is
    ahead of this one; `turns`: the pair over whole turns, only where they were asked for.
    """

    design: Design
    pair: GearPair
    path: ContactPath
    params: dict[str, list[dict[str, float]]]
    summary: dict[str, Any]
    warnings: tuple[str, ...]
    cycle: Cycle | None
    hertz: PathHertz | None = None
    first_order: Array | None = None
    fit: Fit | None = None
    neighbours: Array | None = None
    turns: FullTurns | None = None

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (".json", ".csv")

    @property
    def headline(self) -> str:
        touching = f"{int(self.path.touching.sum())} of {len(self.path.phi1)} positions touch"
        ratio = "" if self.cycle is None else f", contact ratio {self.cycle.contact_ratio:.4g}"
        return f"{touching}{ratio}"

    @property
    def listings(self) -> list[Listing]:
        return [
            *self._path_listing(),
            *self._hertz_listing(),
            *self._closed_listing(),
            *(() if self.turns is None else (turns_listing(self.turns),)),
            figures("Summary", self.summary),
        ]

    @property
    def engagement(self) -> Engagement | None:
        """The whole engagement that the mesh cycle is of; None where there is no cycle."""
        return None if self.cycle is None or self.cycle.curve is None else self.cycle.curve.engagement

    def ease_off(self) -> EaseOffMap:
        """How far the pinion's flank stays from the gear's, as `Gears.ease_off`."""
        return ease_off_of(self.design, self.pair, self.engagement)

    @cached_property
    def sides(self) -> tuple[SideContact, ...]:
        """The contact on both sides of the teeth; a side without contact is left out."""
        return side_contacts(self.pair, self.path, self.engagement)

    def positions(self) -> list[dict[str, Any]]:
        """One dict a position with the keys of `tca --json`; NaN where there is nothing."""
        path = self.path
        phi1, phi2, angle = (_degrees(values) for values in (path.phi1, path.phi2, path.angle))
        te = (path.te / ARCSEC).tolist()
        status = [Status(code).name.lower() for code in path.status.tolist()]
        points, normals, majors = path.point.tolist(), path.normal.tolist(), path.major.tolist()
        own = dict(zip(self.params, (path.point1.tolist(), path.point2.tolist()), strict=True))
        a, b = path.semi_major.tolist(), path.semi_minor.tolist()
        curved = self._curvatures()
        regions = list(zip(*(region.tolist() for region in path.regions), strict=True))
        return [
            {
                "phi1_deg": phi1[i],
                "phi2_deg": phi2[i],
                "te_arcsec": te[i],
                **self._slid(i),
                "contact": str(path.kind[i]),
                "edge": str(path.edge[i]) or None,
                "regions": dict(zip(own, (region or None for region in regions[i]), strict=True)),
                "status": status[i],
                "residual_mm": float(path.residual[i]),
                "point_mm": points[i],
                "normal": normals[i],
                **{member: {"params": dict(self.params[member][i]), "point_mm": own[member][i]} for member in own},
                "ellipse": {"a_mm": a[i], "b_mm": b[i], "angle_deg": angle[i], "major_axis": majors[i]},
                "curvature": curved[i],
                "line_mm": path.lines[i],
                **self._more(i),
            }
            for i in range(len(phi1))
        ]

    def _curvatures(self) -> list[dict[str, Any]]:
        """Principal curvatures and directions at every position: of both flanks, and relative ones."""
        names = (*self.params, "relative")
        columns = [
            [values.tolist() for values in (each.k1, each.k2, each.direction1, each.direction2)]
            for each in path_curvatures(self.pair, self.path)
        ]
        return [
            {
                name: {key: part[i] for key, part in zip(_CURVATURE, own, strict=True)}
                for name, own in zip(names, columns, strict=True)
            }
            for i in range(len(self.path.phi1))
        ]

    def _slid(self, i: int) -> dict[str, Any]:
        """How far a gear that slides has come at a position, and its error."""
        slide = self.pair.slide
        if slide is None:
            return {}
        # to 1e-12 mm: what is less is rounding
        return {
            "displacement_mm": float((slide * self.path.phi2[i]).round(12)),
            "te_um": 1e3 * slide * float(self.path.te[i]),
        }

    def _more(self, i: int) -> dict[str, Any]:
        """What only some contacts have at a position: the Hertz contact, the closed form of the transmission error."""
        more: dict[str, Any] = {}
        if self.hertz is not None:
            hertz = {
                "p0_mpa": self.hertz.peak_pressure,
                "a_mm": self.hertz.semi_major,
                "b_mm": self.hertz.semi_minor,
                "approach_um": 1e3 * self.hertz.approach,
                "force_n": self.hertz.force,
            }
            more["hertz"] = {key: float(values[i]) for key, values in hertz.items()}
            more["load_share"] = float(self.hertz.share[i])
        if self.neighbours is not None:
            more["neighbour_lead_arcsec"] = float(self.neighbours[i]) / ARCSEC
            if self.pair.slide is not None:
                more["neighbour_lead_um"] = 1e3 * self.pair.slide * float(self.neighbours[i])
        if self.first_order is not None:
            more["te_first_order_arcsec"] = float(self.first_order[i]) / ARCSEC
        return more

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([dict(self._flat(row)) for row in self.positions()])

    @staticmethod
    def _flat(row: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
        """A position laid flat; a line of contact has no place in a table."""
        return flat({key: value for key, value in row.items() if key != "line_mm"})

    def document(self) -> dict[str, Any]:
        return times_apart(
            {
                **header(self.design),
                "summary": self.summary,
                "warnings": list(self.warnings),
                "fit": self._fit(),
                **({} if self.turns is None else {"turns": turns_details(self.turns)}),
                "positions": [_without_nothing(row, tuple(self.params)) for row in self.positions()],
            }
        )

    def _fit(self) -> dict[str, Any] | None:
        """What is known of how the gears fit; None where it was not asked for."""
        if self.fit is not None:
            return fit_details(self.pair, self.fit)
        return {"fits": None, "verdict": verdict(None), "reason": UNMET} if UNMET in self.warnings else None

    def csv(self) -> str:
        """One row a position, the columns of the JSON laid flat, empty where there is nothing; of whole turns theirs instead."""
        if self.turns is not None:
            return csv_text(turns_rows(self.turns))
        return csv_text([dict(self._flat(row)) for row in self.positions()])

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        whole_text(target, self.csv())

    def _path_listing(self) -> list[Listing]:
        """Rounded, so that what is zero but for rounding reads as zero."""
        rows = self.positions()
        names = [(member, name) for member in self.params for name in self.params[member][0]]
        moved, error = ("phi2_deg", "te_arcsec") if self.pair.slide is None else ("displacement_mm", "te_um")
        heads = ["phi1 deg", moved.replace("_", " "), f"TE {error.removeprefix('te_')}", "contact", "a mm", "b mm"]
        values = [
            [
                rounded(row["phi1_deg"], 4),
                rounded(row[moved], 4),
                rounded(row[error], 3),
                f"edge: {row['edge']}" if row["edge"] else row["contact"],
                rounded(row["ellipse"]["a_mm"], 4),
                rounded(row["ellipse"]["b_mm"], 4),
                *(rounded(row[member]["params"][name], 4) for member, name in names),
            ]
            for row in rows
        ]
        heads += [f"{member} {name}" for member, name in names]
        return [Listing("Contact", heads, values)]

    def _hertz_listing(self) -> list[Listing]:
        """The table of the Hertz contact, if a torque was asked for."""
        if self.hertz is None:
            return []
        digits = {"p0_mpa": 1, "a_mm": 4, "b_mm": 4, "approach_um": 3, "force_n": 2}
        heads = ["phi1 deg", *(name.replace("_", " ") for name in digits), "share %"]
        values = [
            [
                rounded(row["phi1_deg"], 4),
                *(rounded(row["hertz"][k], n) for k, n in digits.items()),
                rounded(100.0 * row["load_share"], 1),
            ]
            for row in self.positions()
        ]
        how = "shared" if self.summary.get("load_sharing") == SHARED else "all on this pair of teeth"
        title = f"Hertz contact, {self.hertz.torque:g} Nm on the {self.pair.pinion.name}, {how}"
        return [Listing(title, heads, values)]

    def _closed_listing(self) -> list[Listing]:
        """The closed form beside the solver, where the gear system knows one."""
        if self.first_order is None:
            return []
        rows = [
            [rounded(float(np.degrees(phi1)), 4), rounded(te / ARCSEC, 3), rounded(closed / ARCSEC, 3)]
            for phi1, te, closed in zip(self.path.phi1, self.path.te, self.first_order, strict=True)
        ]
        return [Listing("Transmission error by the solver and, of first order, in closed form", _CLOSED_HEADS, rows)]


#: keys of principal curvatures (1/mm) and their directions (unit vectors, fixed frame)
_CURVATURE = ("k1_per_mm", "k2_per_mm", "direction1", "direction2")
_CLOSED_HEADS = ("phi1 deg", "TE arcsec", "closed form arcsec")


#: the range of positions
_RANGE = ("contact.phi1.start", "contact.phi1.stop")


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

    With a `torque` (Nm) on the pinion also its Hertz contact, all load on the one pair of teeth or those `shares` of it. With
    `turns` also the pair over whole turns, until it repeats. Raises
    DesignError for a torque that is not above 0, and for sharing without one.
    """
    if shares is not None and torque is None:
        raise DesignError("load_sharing = true: must be left out without a torque that is shared")
    flanks = solver_pair(pair)
    # angles by which a source counts its tables are not those of the engagement
    by_engagement = phi1 is None and pair.generation is None and not any(map(design.sets, _RANGE))
    followed = engaged(flanks, pair.pitch) if cycle or by_engagement else None
    fits, whole = fitted_cycle(pair, followed) if cycle and followed is not None else (None, None)
    if by_engagement and followed is not None and followed.contacts.touching.any():
        ends = np.degrees(engagement_range(followed, pair.pitch) if whole is None else whole.engagement)
        design = design.with_values(dict(zip(_RANGE, map(float, ends), strict=True)))
    if phi1 is None:
        wanted = design.contact.phi1
        phi1 = np.radians(np.linspace(wanted.start, wanted.stop, wanted.count))
    jams = np.zeros(len(phi1), dtype=bool) if fits is None else fits.jams(phi1)
    path = jammed_path(flanks, phi1)
    if fits is None or not (fits.jammed and jams.all()):
        path = contact_path(flanks, phi1, pair.generation, engagement=followed).jammed(path, jams)
    summary = _summary(pair, path, whole)
    if fits is not None:
        summary |= fit_summary(pair, fits)
    hertz = None
    if torque is not None:
        share, said = shares(path, whole) if shares is not None else (np.ones(1), [])
        warnings = (*warnings, *said)
        hertz = hertz_path(pair, path, torque, materials_of(design, pair), share)
        peak = hertz.peak_pressure[~np.isnan(hertz.peak_pressure)]
        summary |= {
            "torque_nm": torque,
            "load_sharing": ALONE if shares is None else SHARED,
            "max_pressure_mpa": float(peak.max()) if peak.size else None,
        }
    whole_turns = full_turns(pair) if turns else None
    if whole_turns is not None:
        summary |= turns_summary(pair, whole_turns)
        warnings = (*warnings, *turns_warnings(whole_turns))
    return Contact(
        design,
        pair,
        path,
        {
            member.name: _named(member, params)
            for member, params in zip(pair.both, (path.params1, path.params2), strict=True)
        },
        summary,
        (
            *warnings,
            *((UNMET,) if cycle and fits is None else fit_warnings(pair, fits) if fits is not None else ()),
            *_contact_warnings(pair, path),
            *_break_warnings(pair, whole),
        ),
        whole,
        hertz,
        None if first_order is None else first_order(path.rotation),
        fits,
        _neighbours(pair, path, followed, whole),
        whole_turns,
    )


def _neighbours(pair: GearPair, path: ContactPath, followed: Engagement | None, cycle: Cycle | None) -> Array | None:
    """How far (P,), rad, a neighbouring pair of teeth is ahead, where the pair has been followed."""
    if followed is None:
        return None
    lead = PairLead(followed) if cycle is None or cycle.curve is None else cycle.curve.of_pair
    return lead.over_neighbours(pair.pitch, path.rotation)


def _summary(pair: GearPair, path: ContactPath, cycle: Cycle | None) -> dict[str, Any]:
    te = path.te[path.touching]
    summary: dict[str, Any] = {
        "positions": len(path.phi1),
        "converged": int(path.touching.sum()),
        "te_peak_to_peak_arcsec": float(np.ptp(te)) / ARCSEC if te.size else None,
        "max_residual_mm": float(path.residual[path.touching].max()) if te.size else None,
        "seconds": path.seconds,
        "shaft_angle_deg": float(np.degrees(pair.shaft_angle)),
    }
    if cycle is not None:
        summary |= cycle_summary(cycle)
    if pair.slide is not None:
        summary |= slid_summary(pair, pair.slide, summary)
    return summary | pair.figures


def cycle_summary(cycle: Cycle) -> dict[str, Any]:
    """Figures of a mesh cycle under the keys of the JSON."""
    return {
        "contact_ratio": cycle.contact_ratio,
        **_parts(cycle),
        "engagement_phi1_deg": np.degrees(cycle.engagement).tolist(),
        "mesh_te_peak_to_peak_arcsec": cycle.peak_to_peak / ARCSEC,
        "mesh_te_harmonics_arcsec": [float(a) / ARCSEC for a in cycle.harmonics],
        "te_breaks_phi1_deg": [float(np.degrees(each.phi1)) for each in cycle.breaks],
    }


def slid_summary(pair: GearPair, slide: float, summary: Mapping[str, Any]) -> dict[str, Any]:
    """Of a gear that slides (mm/rad): its way in a turn of the pinion, and every error in um, too."""
    found: dict[str, Any] = {"displacement_per_turn_mm": 2.0 * math.pi * pair.ratio * slide}
    um = 1e3 * slide * ARCSEC
    for key, value in summary.items():
        if key.endswith("_arcsec"):
            name = f"{key.removesuffix('_arcsec')}_um"
            found[name] = None if value is None else [um * v for v in value] if isinstance(value, list) else um * value
    return found


def _parts(cycle: Cycle) -> dict[str, Any]:
    """Parts of a line's contact ratio, and how many pairs of teeth have surface contact, least and most."""
    parts: dict[str, Any] = {}
    if np.isfinite(cycle.overlap_ratio):
        parts = {"transverse_contact_ratio": cycle.transverse_ratio, "overlap_ratio": cycle.overlap_ratio}
    if np.isfinite(cycle.contact_ratio):
        least = math.floor(cycle.contact_ratio + 1e-9)
        most = math.ceil(cycle.contact_ratio - 1e-9)
        parts["pairs_in_contact"] = [least, most]
    return parts


def _contact_warnings(pair: GearPair, path: ContactPath) -> list[str]:
    """What to know of the figures: a lead at the change of teeth, and teeth that are not all alike."""
    warnings = []
    if any(mount.eccentricity != (0.0, 0.0) for mount in pair.mounts):
        warnings.append(
            "eccentric members: every tooth pair has another error; mesh cycle and backlash are those of the pair at phi1 = 0, "
            "tca --turns has those of all"
        )
    inside = path.kind == "point"
    if inside.sum() >= 5:
        bend = pair.drive * np.polyfit(path.phi1[inside], path.te[inside], 2)[0]
        lead = bend * (0.5 * pair.pitch) ** 2
        if lead / ARCSEC > LEAD:
            rad, unit = error_unit(pair.slide)
            warnings.append(
                f"the transmission error bends towards a lead of {lead / rad:.3g} {unit} at the change of teeth: "
                "they change over on edges"
            )
    return warnings


def _break_warnings(pair: GearPair, cycle: Cycle | None) -> list[str]:
    """Where the transmission error is discontinuous, one line each."""
    warnings, (rad, unit) = [], error_unit(pair.slide)
    total = total_ratio(pair, cycle) if cycle is not None and cycle.contact_ratio < 1.0 else math.inf
    if cycle is not None and total < 1.0:
        warnings.append(
            f"contact ratio {cycle.contact_ratio:.4g} of the flanks' surfaces is below 1: between two pairs of teeth edges carry; "
            "higher teeth, a wider face or less crowning give more"
        )
    for each in cycle.breaks if cycle else ():
        what = "begins" if each.beginning else "ends"
        size, why = "before the next pair's begins", ""
        if cycle is not None and 1.0 <= total < math.inf:
            why = f": without load the contact ratio is {cycle.contact_ratio:.4g}, of conjugate flanks it would be {total:.4g}"
        if not np.isnan(each.jump):
            size = f"{each.jump / rad:.3g} {unit} ahead of the {'last' if each.beginning else 'next'} pair"
        warnings.append(
            f"the transmission error is discontinuous: at phi1 = {np.degrees(each.phi1):.5g} deg the surface contact of a "
            f"pair {what} {size}; edges carry there{why}"
        )
    return warnings


def total_ratio(pair: GearPair, cycle: Cycle) -> float:
    """The total contact ratio: pitches over which one pair of teeth would touch somewhere on its flanks, were these conjugate. What
    a crowning takes away, so that contact without load is in a point, is not taken off."""
    if cycle.curve is None:
        return cycle.contact_ratio
    phi1 = ease_off(cycle.curve.engagement, pair.pitch).phi1
    met = phi1[np.isfinite(phi1)]
    return max(cycle.contact_ratio, float(np.ptp(met)) / pair.pitch if met.size else 0.0)


def _named(member: Member, params: Array) -> list[dict[str, float]]:
    named = member.source_parameters(params[:, 0], params[:, 1])
    return [dict(zip(named, map(float, row), strict=True)) for row in zip(*named.values(), strict=True)]


def _degrees(radians: Array) -> list[float]:
    """Degrees; the last digits, which going to radians and back leaves behind, are rounded away."""
    return [float(value) for value in (radians * (180.0 / math.pi)).round(12)]


def _without_nothing(row: dict[str, Any], members: tuple[str, ...]) -> dict[str, Any]:
    """A position with vectors of NaN and ellipses without axes as None."""
    own = {m: {**row[m], "point_mm": _vector(row[m]["point_mm"])} for m in members}
    vectors = {name: _vector(row[name]) for name in ("point_mm", "normal")}
    ellipse = None if math.isnan(row["ellipse"]["a_mm"]) else row["ellipse"]
    curvature = None if math.isnan(row["curvature"]["relative"]["k1_per_mm"]) else row["curvature"]
    loaded = {"hertz": None if math.isnan(row["hertz"]["p0_mpa"]) else row["hertz"]} if "hertz" in row else {}
    return {**row, **vectors, **own, "ellipse": ellipse, "curvature": curvature, **loaded}


def _vector(values: list[float]) -> list[float] | None:
    return None if any(map(math.isnan, values)) else values
