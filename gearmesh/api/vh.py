"""The V-H check of a bevel pair, as a table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gearmesh.api.result import Result, columns, header
from gearmesh.api.tables import Listing, rounded
from gearmesh.design.core import Design
from gearmesh.systems.system import PatternShift


@dataclass(frozen=True, repr=False)
class VHCheck(Result):
    """Displacements V and H of the pinion (mm) that bring the centre of contact to places along the gear's face, for both sides."""

    design: Design
    shifts: tuple[PatternShift, ...]
    warnings: tuple[str, ...] = ()

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One dict a side and place, with the keys of the JSON."""
        return [
            {
                "side": f"pinion_{each.side}",
                "place": each.place,
                "v_mm": each.v,
                "h_mm": each.h,
                "j_mm": each.j,
                "alpha_deg": each.alpha,
            }
            for each in self.shifts
        ]

    @property
    def totals(self) -> list[dict[str, Any]]:
        """One dict a side: V and H from the toe's to the heel's, and their ratio."""
        found = []
        for side in dict.fromkeys(each.side for each in self.shifts):
            by_place = {each.place: each for each in self.shifts if each.side == side}
            v, h = (getattr(by_place["heel"], key) - getattr(by_place["toe"], key) for key in ("v", "h"))
            found.append({"side": f"pinion_{side}", "v_mm": v, "h_mm": h, "v_over_h": v / h if h else None})
        return found

    @property
    def headline(self) -> str:
        return ", ".join(f"{row['side']}: total V {row['v_mm']:.4g}, H {row['h_mm']:.4g} mm" for row in self.totals)

    @property
    def listings(self) -> list[Listing]:
        heads = ["side", "contact at", "V mm", "H mm", "J mm", "alpha deg"]
        rows = [[row["side"], row["place"], *(rounded(row[key], 5) for key in _COLUMNS)] for row in self.rows]
        totals = [
            [row["side"], *(None if row[key] is None else rounded(row[key], 5) for key in ("v_mm", "h_mm", "v_over_h"))]
            for row in self.totals
        ]
        return [
            Listing("V-H check: assembly.dV, dA (with dG, d_delta) that put the contact there", heads, rows),
            Listing("Total, from toe to heel", ["side", "V mm", "H mm", "V/H"], totals),
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns(self.rows)

    def document(self) -> dict[str, Any]:
        return {**header(self.design), "vh": self.rows, "totals": self.totals}


_COLUMNS = ("v_mm", "h_mm", "j_mm", "alpha_deg")
