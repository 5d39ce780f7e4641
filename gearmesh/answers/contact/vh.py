"""V-H check of a pair, as a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, round_to
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.figures import Content, Figures, figure
from gearmesh.records import dataclass
from gearmesh.systems import system as systems
from gearmesh.systems.system import PatternShift


@dataclass(frozen=True)
class Displacement(Figures):
    """Displacements of pinion and gear of a pair."""

    v: float | None = figure("displacement of the axes: assembly.dV; of worm drives assembly.da", "mm", "V")
    h: float | None = figure("displacement along the pinion's axis: assembly.dA", "mm", "H")
    j: float | None = figure("displacement along the gear's axis: assembly.dG; of worm drives assembly.dz2", "mm", "J")
    alpha: float | None = figure(
        "change of the shaft angle: assembly.d_delta; of worm drives assembly.d_sigma", "deg", "alpha"
    )

    @staticmethod
    def of(shift: PatternShift) -> Displacement:
        """Return the displacements of a shift of the contact pattern."""
        return Displacement(shift.v, shift.h, shift.j, shift.alpha)


@dataclass(frozen=True)
class NearestPlace(Figures):
    """The nearest place to which the contact of a pair can be brought."""

    face_share: float = figure("place of the contact from toe to heel, as a part of the face")
    displacement: Displacement = figure("displacements that bring the contact there", parts=Displacement)


@dataclass(frozen=True)
class PlaceFigures(Figures):
    """A place of the contact in the V-H check."""

    side: str = figure("flank of the pinion")
    place: str = figure(
        "place of the contact: toe, middle or heel; of worm drives entering side, middle or leaving side"
    )
    displacement: Displacement = figure("displacements that bring the contact there", parts=Displacement)
    face_share: float = figure("requested place from toe to heel, as a part of the face")
    reached: bool = figure("whether the contact can be brought there")
    nearest: NearestPlace | None = figure("the nearest place that can be reached, where it cannot")


@dataclass(frozen=True)
class TotalFigures(Figures):
    """Total V and H of a flank, from toe to heel."""

    side: str = figure("flank of the pinion")
    v: float | None = figure("V at the heel less V at the toe", "mm", "V")
    h: float | None = figure("H at the heel less H at the toe", "mm", "H")
    v_over_h: float | None = figure("ratio of total V and total H", symbol="V/H")


@dataclass(frozen=True, repr=False)
class VHCheck(Result):
    """Displacements of pinion and gear (mm, deg) that bring the centre of contact to places along the gear's face."""

    #: the design
    design: Design
    #: shifts of the contact pattern, by side and place
    shifts: tuple[PatternShift, ...]
    #: warnings, one line each
    warnings: tuple[str, ...] = ()
    #: key of the table `assembly` by letter: V, H, J, alpha
    keys: Mapping[str, str] = field(default_factory=dict)

    @property
    def rows(self) -> list[PlaceFigures]:
        """Rows, one per side and place; a place out of reach has displacements only in `nearest`."""
        return [
            PlaceFigures(
                side=shift.side,
                place=shift.place,
                displacement=Displacement.of(shift) if shift.reached else UNKNOWN_DISPLACEMENT,
                face_share=shift.asked,
                reached=shift.reached,
                nearest=None if shift.reached else NearestPlace(shift.share, Displacement.of(shift)),
            )
            for shift in self.shifts
        ]

    @property
    def totals(self) -> list[TotalFigures]:
        """V and H from the first place to the last, and their ratio, one row per side; None if a place is out of reach.

        The list is empty for kinds without H.
        """
        rows = list[TotalFigures]()
        if "H" not in self.keys:
            return rows
        for side in dict.fromkeys(shift.side for shift in self.shifts):
            first, last = (self._at(side, place) for place in ("toe", "heel"))
            if not (first.reached and last.reached):
                rows.append(TotalFigures(side, None, None, None))
                continue
            v, h = last.v - first.v, last.h - first.h
            rows.append(TotalFigures(side, v, h, v / h if h else None))
        return rows

    def _at(self, side: str, place: str) -> PatternShift:
        (pattern_shift,) = (shift for shift in self.shifts if (shift.side, shift.place) == (side, place))
        return pattern_shift

    @property
    def complaints(self) -> list[str]:
        """Places to which the contact cannot be brought, one line each."""
        return [
            f"{shift.side}: the contact cannot be brought to the {shift.place}, {shift.asked:g} of the face from the toe: "
            f"other points or edges touch first; the nearest that can be reached is {shift.share:g} of the face, with "
            f"V = {shift.v:.5g}, "
            f"H = {shift.h:.5g}, J = {shift.j:.5g} mm, alpha = {shift.alpha:.5g} deg"
            for shift in self.shifts
            if not shift.reached
        ]

    @property
    def headline(self) -> str:
        if "H" not in self.keys:
            return ", ".join(
                f"{shift.side}, {shift.place}: V {shift.v:.4g}, J {shift.j:.4g} mm, alpha {shift.alpha:.4g} deg"
                for shift in self.shifts
                if shift.reached
            )
        return ", ".join(
            f"{total.side}: toe or heel out of reach"
            if total.v is None
            else f"{total.side}: total V {total.v:.4g}, H {total.h:.4g} mm"
            for total in self.totals
        )

    @property
    def listings(self) -> list[Listing]:
        heads = ["side", "contact at", "V mm", "H mm", "J mm", "alpha deg", "of face"]
        rows = [
            [
                shift.side,
                shift.place if shift.reached else f"nearest to {shift.place}",
                *(round_to(value, 5) for value in (shift.v, shift.h, shift.j, shift.alpha)),
                round_to(shift.share, 5),
            ]
            for shift in self.shifts
        ]
        totals = [
            [total.side, *(None if x is None else round_to(x, 5) for x in (total.v, total.h, total.v_over_h))]
            for total in self.totals
        ]
        shown = [Listing(f"V-H check: assembly.{', '.join(self.keys.values())} for contact at each place", heads, rows)]
        if totals:
            shown.append(Listing("Total, from toe to heel", ["side", "V mm", "H mm", "V/H"], totals))
        return shown

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.row for row in self.rows])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "vh": self.rows, "totals": self.totals}


#: words for small numbers
COUNT_WORDS = {1: "one", 2: "two"}
#: displacements to a place out of reach
UNKNOWN_DISPLACEMENT = Displacement(None, None, None, None)


def vh_of(gears: GearSet, moved: tuple[str, ...] | None) -> VHCheck:
    """Return the V-H check of gears, as `Gears.vh` describes it."""
    made = systems.system_of(gears.design).vh
    if made is None:
        able = [kind for kind in systems.loaded_kinds() if systems.system(kind).vh is not None]
        raise DesignError("kind", gears.design.kind, reason="has no V-H check", allowed=" or ".join(able))
    moved = made.usual if moved is None else moved
    count = len(made.usual)
    if len({*moved} & made.keys.keys()) != count or len(moved) != count:
        must_be = f"{COUNT_WORDS[count]} of {', '.join(made.keys)}, as {','.join(made.usual)}"
        raise ArgumentError("moved", ",".join(moved), must_be=must_be)
    complete = systems.complete_design(gears.design).in_mm()
    return VHCheck(gears.design, tuple(made.shifts(complete, gears.train, moved)), gears.warnings, made.keys)
