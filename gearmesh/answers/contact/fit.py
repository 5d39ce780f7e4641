"""Fit of gears: figures for the summary, and warnings of interference with their remedies."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from gearmesh.contact.engagement.cycle import Cycle, gears_curve, mesh_cycle
from gearmesh.contact.engagement.displaced import displaced_gears
from gearmesh.contact.engagement.engagement import Engagement
from gearmesh.contact.fit.fit import ROUNDING_MM, Fit, centre_distance, fit
from gearmesh.contact.fit.freeing import direction, freeing_shift
from gearmesh.contact.flanks import solver_pair
from gearmesh.figures import Figures, figure
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair

#: words for driving and coast flanks
FLANK_WORDS = {True: "driving", False: "coast"}
#: positions of a pitch at which backlash is plotted
BACKLASH_POSITIONS = 241
#: warning of flanks that never touch
NO_CONTACT_WARNING = (
    "the driving or the coast flanks touch nowhere: the teeth may be apart or overlap, and the backlash is unknown"
)


def fitted_cycle(pair: GearPair, followed: Engagement | None = None) -> tuple[Fit | None, Cycle | None]:
    """Return the fit of a pair and its whole mesh cycle, which is NaN if the gears jam; None if nothing touches.

    Both follow from the whole engagement of a tooth pair, which is computed if `followed` is not given.
    """
    flanks = solver_pair(pair) if followed is None else followed.pair
    curve = gears_curve(flanks, pair.pitch, followed)
    if curve is None:
        return None, None
    fits = fit(pair, curve)
    return fits, mesh_cycle(flanks, pair.pitch, curve=curve, jammed=fits is not None and fits.jammed)


@dataclass(frozen=True)
class FitSummary(Figures):
    """Fit of gears: backlash over the mesh cycle, clearance of tips over roots, interference."""

    backlash_min: float = figure("backlash as rotation of the gear, least over the mesh cycle", "deg")
    backlash_max: float = figure("backlash as rotation of the gear, greatest over the mesh cycle", "deg")
    backlash_pinion_min: Mapping[str, float] = figure(
        "backlash as rotation of the pinion, least", "deg", key="backlash_{member}_min_deg"
    )
    backlash_pinion_max: Mapping[str, float] = figure(
        "backlash as rotation of the pinion, greatest", "deg", key="backlash_{member}_max_deg"
    )
    backlash_normal_min: float = figure("normal backlash, least", "mm", "j_bn")
    backlash_normal_max: float = figure("normal backlash, greatest", "mm", "j_bn")
    backlash_transverse_min: float = figure("circumferential backlash at the gear's pitch circle, least", "mm", "j_t")
    backlash_transverse_max: float = figure(
        "circumferential backlash at the gear's pitch circle, greatest", "mm", "j_t"
    )
    tip_clearance: Mapping[str, float | None] = figure(
        "clearance of the tip over the mating gear's root", "mm", "c", key="tip_clearance_{member}_mm"
    )
    interference: float = figure("largest depth of a tip in the mating gear's fillet; 0 where there is none", "um")

    @staticmethod
    def of(pair: GearPair, fit: Fit) -> FitSummary:
        """Return the figures of a pair's fit."""
        (low, high), ratio = np.degrees(fit.backlash), abs(pair.ratio)
        return FitSummary(
            float(low),
            float(high),
            {pair.pinion.name: float(low / ratio)},
            {pair.pinion.name: float(high / ratio)},
            *fit.normal_backlash,
            *fit.transverse_backlash,
            {
                member.name: None if clearance is None else clearance.distance
                for member, clearance in zip(pair.both, fit.clearances, strict=True)
            },
            1e3 * max((overlap.depth for overlap in fit.interference), default=0.0),
        )


@dataclass(frozen=True)
class BacklashCurve:
    """Backlash over a pitch of the pinion."""

    #: rotations (N,) of the pinion, deg
    phi1: Array
    #: rotation (N,) of the gear between the first contacts of both sides, deg
    backlash: Array
    #: backlash (N,) at the gear's pitch circle, mm
    transverse: Array
    #: smallest backlash over the pitch, deg
    least: float
    #: largest backlash over the pitch, deg
    greatest: float

    @staticmethod
    def of(pair: GearPair, fit: Fit, count: int) -> BacklashCurve:
        """Return the backlash of a pair's fit at `count` equally spaced positions."""
        phi1 = np.linspace(0.0, pair.pitch, count)
        turns = fit.play(phi1)
        low, high = np.degrees(fit.backlash)
        return BacklashCurve(np.degrees(phi1), np.degrees(turns), turns * fit.pitch_radius, float(low), float(high))


@dataclass(frozen=True)
class TipPlace(Figures):
    """Place at which a tip is nearest to the mating gear."""

    phi1: float = figure("rotation of the pinion", "deg", "phi_1")
    point: list[float] = figure("place, fixed frame", "mm", vector=True)
    own: Mapping[str, list[float]] = figure(
        "place, own frame of the member", "mm", key="{member}_point_mm", vector=True
    )

    @staticmethod
    def of(pair: GearPair, fit: Fit, phi1: float, point: Array) -> TipPlace:
        """Return the figures of a point (3,) of the fixed frame, at phi1 (rad) of the driven gears."""
        turns = np.array([phi1]), fit.turns(np.array([phi1]))
        own_points = {
            member.name: member.mount.at(turn).inverse.point(point[None])[0].tolist()
            for member, turn in zip(pair.both, turns, strict=True)
        }
        return TipPlace(float(np.degrees(phi1)), point.tolist(), own_points)


@dataclass(frozen=True)
class ClearanceFigures(Figures):
    """The clearance of a tip over the root of the mating gear, where it is least."""

    distance: float = figure("distance of the tip and the root", "mm", "c")
    place: TipPlace = figure("where it is least", parts=TipPlace)


@dataclass(frozen=True)
class InterferenceFigures(Figures):
    """A tip inside a fillet."""

    depth: float = figure("depth of the tip in the fillet", "um")
    tip_of: str = figure("member whose tip it is")
    fillet_of: str = figure("member whose fillet it is")
    flanks: str = figure("flanks in contact: driving or coast")
    place: TipPlace = figure("where it is deepest", parts=TipPlace)


@dataclass(frozen=True)
class TipCollisionFigures(Figures):
    """Tips that collide beside the mesh."""

    depth: float = figure("overlap of the tips when the flanks touch, along the normal of the pinion's flank", "um")
    flanks: str = figure("flanks in contact: driving or coast")
    place: TipPlace = figure("where the tips meet", parts=TipPlace)


@dataclass(frozen=True)
class ContactGap(Figures):
    """Part of a pitch in which the flanks of one side have no contact."""

    flanks: str = figure("flanks without contact: driving or coast")
    phi1: list[float] = figure("rotations of the pinion at which the gap begins and ends", "deg", "phi_1")


@dataclass(frozen=True)
class FitDetails(Figures):
    """Verdict on the fit of gears, with the places where they do not fit."""

    fits: bool | None = figure("whether the gears fit; none where that is not known")
    verdict: str = figure("the same in a word: yes, no, unknown")
    reason: str | None = figure("why it is not known")
    jammed: bool | None = figure("whether no rotation of the gear is free", optional=True, default=None)
    no_contact: list[ContactGap] | None = figure(
        "parts of a pitch in which flanks have no contact", optional=True, default=None
    )
    tip_clearance: Mapping[str, ClearanceFigures | None] | None = figure(
        "clearance of the members' tips over the mating gear's root", optional=True, default=None
    )
    interference: list[InterferenceFigures] | None = figure("tips inside fillets", optional=True, default=None)
    tip_collisions: list[TipCollisionFigures] | None = figure(
        "tips that collide beside the mesh as they pass each other", optional=True, default=None
    )

    @staticmethod
    def of(pair: GearPair, fit: Fit) -> FitDetails:
        """Return the details of a pair's fit."""
        names = [member.name for member in pair.both]
        pair = displaced_gears(pair)
        return FitDetails(
            fits=fit.fits,
            verdict=verdict(fit),
            reason=" and ".join(_unknown(fit)) or None,
            jammed=fit.jammed,
            no_contact=[
                ContactGap(FLANK_WORDS[gap.driving], np.degrees([gap.begin, gap.end]).tolist()) for gap in fit.gaps
            ],
            tip_clearance={
                name: None
                if least is None
                else ClearanceFigures(least.distance, TipPlace.of(pair, fit, least.phi1, least.point))
                for name, least in zip(names, fit.clearances, strict=True)
            },
            interference=[
                InterferenceFigures(
                    depth=1e3 * tip.depth,
                    tip_of=names[1 - tip.fillet_of],
                    fillet_of=names[tip.fillet_of],
                    flanks=FLANK_WORDS[tip.driving],
                    place=TipPlace.of(pair, fit, tip.phi1, tip.point),
                )
                for tip in fit.interference
            ],
            tip_collisions=[
                TipCollisionFigures(
                    1e3 * tips.depth, FLANK_WORDS[tips.driving], TipPlace.of(pair, fit, tips.phi1, tips.point)
                )
                for tips in fit.collisions
            ],
        )


def verdict(fit: Fit | None) -> str:
    """Return "yes", "no" or "unknown" for the fit of gears."""
    return "unknown" if fit is None or fit.fits is None else "yes" if fit.fits else "no"


def _unknown(fit: Fit) -> list[str]:
    """Return the parts of a pitch without contact, in words, one line per side."""
    lines = []
    for driving in (True, False):
        parts = [f"{np.degrees(g.begin):.4g} to {np.degrees(g.end):.4g}" for g in fit.gaps if g.driving == driving]
        if parts:
            lines.append(
                f"the {FLANK_WORDS[driving]} flanks have no contact at phi1 = {', '.join(parts)} deg of a pitch"
            )
    return lines


def fit_warnings(pair: GearPair, fit: Fit) -> Iterator[str]:
    """Yield a line for each interference, with its size, place and remedy."""
    if fit.gaps:
        low, known = (
            fit.normal_backlash[0],
            "it is unknown whether the gears fit" if fit.fits is None else "the gears do not fit",
        )
        rest = f"at least {low:.4g} mm" if np.isfinite(low) else "unknown"
        yield f"{known}: {' and '.join(_unknown(fit))}; over the rest of the mesh cycle the normal backlash is {rest}"
    if fit.fits is not False:
        return
    names = [member.name for member in pair.both]
    # the centre distance has little effect on tips that collide beside the mesh: they must be shorter
    remedy = "; shorter tips free them" if fit.collisions else _remedy(pair, fit)
    if fit.jammed:
        overlap = "tips collide beside the mesh" if fit.collisions else "tips overlap fillets or roots"
        yield f"{overlap} and there is no backlash: no transmission error is reported{remedy}"
    if fit.normal_backlash[0] < -ROUNDING_MM:
        yield (
            f"the pair is jammed: the normal backlash is {1e3 * fit.normal_backlash[0]:.4g} um "
            f"({_way(pair, fit.backlash[0])} of the {names[1]}){remedy}"
        )
    for clash in fit.interference:
        yield (
            f"interference: the tip of the {names[1 - clash.fillet_of]} is {1e3 * clash.depth:.4g} um inside the fillet of the "
            f"{names[clash.fillet_of]} when the {FLANK_WORDS[clash.driving]} flanks touch, at phi1 = "
            f"{np.degrees(clash.phi1):.5g} deg, {_place(clash.point)}{remedy}"
        )
    for tips in fit.collisions:
        yield (
            f"interference: the tips of {names[0]} and {names[1]} collide beside the mesh by {1e3 * tips.depth:.4g} um when the "
            f"{FLANK_WORDS[tips.driving]} flanks touch, at phi1 = {np.degrees(tips.phi1):.5g} deg, {_place(tips.point)}{remedy}"
        )
    for k, clearance in enumerate(fit.clearances):
        if clearance is not None and clearance.distance < -ROUNDING_MM:
            yield (
                f"interference: the tip of the {names[k]} is {-1e3 * clearance.distance:.4g} um inside the root of the "
                f"{names[1 - k]}, at phi1 = {np.degrees(clearance.phi1):.5g} deg, {_place(clearance.point)}{remedy}"
            )


def _way(pair: GearPair, phi2: float) -> str:
    """Return a rotation (rad) of the gear in words, or the travel of a gear that slides."""
    rad, unit = pair.output.reading.motion
    return f"{phi2 / rad:.4g} {unit}"


def _place(point: Array) -> str:
    return "at ({:.4g}, {:.4g}, {:.4g}) mm".format(*point)


def _remedy(pair: GearPair, fit: Fit) -> str:
    """Return the remedy that frees the pair, in words; empty if moving the gear does not free it."""
    freeing = freeing_shift(pair, fit)
    if freeing is None:
        return ""
    shift = freeing.length
    apart, size = centre_distance(pair), abs(shift)
    # three digits, rounded up, so that the reported distance frees the pair
    places = 2 - math.floor(math.log10(size))
    by = f"{_up(size, places):.3g}"
    if pair.output.travel is not None:
        return f"; to free it move the {pair.gear.name} {by} mm {'away' if shift > 0.0 else 'closer'}"
    if apart is not None:
        bound = f"{abs(_up(math.copysign(apart + shift, shift), places)):.{max(places, 0)}f} mm"
        if not freeing.least:
            return f"; free with a centre distance of {bound}"
        return (
            f"; free with a centre distance of at least {bound}"
            if shift > 0.0
            else f"; free with a centre distance of at most {bound}"
        )
    name = pair.gear.name
    if abs(float(direction(pair) @ pair.gear.mount.axis)) > 1.0 - MAX_SINE_OF_PARALLEL:
        sense = "+z" if shift > 0.0 else "-z"
        return f"; to free it move the {name} {by} mm along its axis ({sense} of its own frame)"
    return f"; to free it move the axes {by} mm {'apart' if shift > 0.0 else 'together'}"


def _up(length: float, places: int) -> float:
    """Return a length rounded up to the given number of decimals."""
    return math.ceil(length * 10.0**places - 1e-6) / 10.0**places
