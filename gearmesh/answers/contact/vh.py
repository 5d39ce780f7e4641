"""The V-H check of a bevel pair, as a table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, rounded
from gearmesh.design.core import Design
from gearmesh.errors import DesignError
from gearmesh.systems import system as systems
from gearmesh.systems.system import PatternShift


@dataclass(frozen=True, repr=False)
class VHCheck(Result):
    """Displacements of pinion and gear (mm, deg) that bring the centre of contact to places along the gear's face."""

    design: Design
    shifts: tuple[PatternShift, ...]
    warnings: tuple[str, ...] = ()

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One dict a side and place, with the keys of the JSON; a place out of reach has none but in `nearest`."""
        return [
            {
                "side": f"pinion_{each.side}",
                "place": each.place,
                **(_values(each) if each.reached else dict.fromkeys(_COLUMNS)),
                "face_share": each.asked,
                "reached": each.reached,
                "nearest": None if each.reached else {"face_share": each.share, **_values(each)},
            }
            for each in self.shifts
        ]

    @property
    def totals(self) -> list[dict[str, Any]]:
        """One dict a side: V and H from the toe's to the heel's, and their ratio; None where either is out of reach."""
        found: list[dict[str, Any]] = []
        for side in dict.fromkeys(each.side for each in self.shifts):
            toe, heel = (self._at(side, place) for place in ("toe", "heel"))
            if not (toe.reached and heel.reached):
                found.append({"side": f"pinion_{side}", "v_mm": None, "h_mm": None, "v_over_h": None})
                continue
            v, h = heel.v - toe.v, heel.h - toe.h
            found.append({"side": f"pinion_{side}", "v_mm": v, "h_mm": h, "v_over_h": v / h if h else None})
        return found

    def _at(self, side: str, place: str) -> PatternShift:
        (found,) = (each for each in self.shifts if (each.side, each.place) == (side, place))
        return found

    @property
    def complaints(self) -> list[str]:
        """A line for every place to which the contact cannot be brought."""
        return [
            f"pinion_{each.side}: the contact cannot be brought to the {each.place}, {each.asked:g} of the face from the toe: "
            f"other places or edges touch first; nearest is {each.share:g} of the face, with V = {each.v:.5g}, "
            f"H = {each.h:.5g}, J = {each.j:.5g} mm, alpha = {each.alpha:.5g} deg"
            for each in self.shifts
            if not each.reached
        ]

    @property
    def headline(self) -> str:
        return ", ".join(
            f"{row['side']}: total V {row['v_mm']:.4g}, H {row['h_mm']:.4g} mm"
            if row["v_mm"] is not None
            else f"{row['side']}: toe or heel out of reach"
            for row in self.totals
        )

    @property
    def listings(self) -> list[Listing]:
        heads = ["side", "contact at", "V mm", "H mm", "J mm", "alpha deg", "of face"]
        rows = [
            [
                f"pinion_{each.side}",
                each.place if each.reached else f"nearest to {each.place}",
                *(rounded(value, 5) for value in _values(each).values()),
                rounded(each.share, 5),
            ]
            for each in self.shifts
        ]
        totals = [
            [row["side"], *(None if row[key] is None else rounded(row[key], 5) for key in ("v_mm", "h_mm", "v_over_h"))]
            for row in self.totals
        ]
        return [
            Listing("V-H check: assembly.dV, dA, dG, d_delta that put the contact there", heads, rows),
            Listing("Total, from toe to heel", ["side", "V mm", "H mm", "V/H"], totals),
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns(self.rows)

    def document(self) -> dict[str, Any]:
        return {**header(self.design), "vh": self.rows, "totals": self.totals}


_COLUMNS = ("v_mm", "h_mm", "j_mm", "alpha_deg")


def _values(shift: PatternShift) -> dict[str, float]:
    return dict(zip(_COLUMNS, (shift.v, shift.h, shift.j, shift.alpha), strict=True))


def vh_of(gears: GearSet, moved: tuple[str, str]) -> VHCheck:
    """The V-H check of gears, as `Gears.vh` says."""
    made = systems.system(gears.design.kind).vh
    if made is None:
        able = [kind for kind in systems.kinds() if systems.system(kind).vh is not None]
        raise DesignError(f"kind = {gears.design.kind}: has no V-H check; allowed is {' or '.join(able)}")
    own = systems.completed(gears.design).in_mm()
    if len({*moved} & {"V", "H", "J", "alpha"}) != 2 or len(moved) != 2:
        raise DesignError(f"--move {','.join(moved)}: allowed are two of V, H, J, alpha, as V,H")
    return VHCheck(gears.design, tuple(made(own, gears.train, moved)), gears.warnings)
