"""The check: meshes against the exact surfaces, and the roll test of meshed flanks against the contact solver."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.api.result import Result, columns, header, times_apart
from gearmesh.api.solid import Solid
from gearmesh.api.tables import Listing, plain
from gearmesh.check.roll import RollContact, roll
from gearmesh.contact.path import ARCSEC, ContactPath
from gearmesh.design.core import Design
from gearmesh.kernel.algebra import Array
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.region import FLANKS
from gearmesh.teeth.train import GearPair

#: facet tolerance (mm) of the flanks that the roll test turns against each other
ROLL_TOLERANCE = 1e-4
#: positions at which the roll test is made, spread over those with contact inside both flanks
ROLL_POSITIONS = 3


@dataclass(frozen=True)
class RollTest:
    """Comparison rows of `check --json`, and the rolled contacts themselves."""

    rows: list[dict[str, Any]]
    contacts: tuple[RollContact, ...]

    def patches(self, pair: GearPair, name: str) -> list[tuple[Array, Array]]:
        """Gap maps of the positions that touch: points (..., 3) in the own frame of a member, and gaps (...,), mm."""
        found = []
        for each in self.contacts:
            if not each.touching:
                continue
            points = each.map_points
            if pair.index(name) == 1:
                first, second = pair.mounts
                points = (second.at(each.phi2).inverse @ first.at(each.phi1)).point(points)
            found.append((points, each.map_gap))
        return found


@dataclass(frozen=True, repr=False)
class Check(Result):
    """Solids of all members with their measured deviation, and the roll test of the pair against the solver."""

    design: Design
    solids: dict[str, Solid]
    roll: RollTest
    warnings: tuple[str, ...] = ()

    @property
    def headline(self) -> str:
        worst = max(solid.figures["max_deviation_um"] for solid in self.solids.values())
        off = [abs(row["te_difference_arcsec"]) for row in self.roll.rows if np.isfinite(row["te_difference_arcsec"])]
        rolled = f", rolled TE within {max(off):.2g} arcsec" if off else ""
        return f"meshes within {worst:.3g} um{rolled}"

    @property
    def complaints(self) -> list[str]:
        """What is wrong with the meshes, one line each."""
        return [line for solid in self.solids.values() for line in solid.complaints]

    @property
    def listings(self) -> list[Listing]:
        meshes = {name: plain(solid.figures) for name, solid in self.solids.items()}
        keys = list(next(iter(meshes.values())))
        rows = [[member, *(values[key] for key in keys)] for member, values in meshes.items()]
        found = [Listing("Meshes against exact surfaces", ["", *keys], rows)]
        if self.roll.rows:
            roll = plain(self.roll.rows)
            heads = list(roll[0])
            found.append(Listing("Roll test against solver", heads, [[row[key] for key in heads] for row in roll]))
        return found

    def to_dict(self) -> dict[str, list[Any]]:
        return columns(self.roll.rows)

    @property
    def figures(self) -> dict[str, Any]:
        """Figures of the meshes by member, and the rows of the roll test."""
        return {"mesh": {name: solid.figures for name, solid in self.solids.items()}, "roll": self.roll.rows}

    def document(self) -> dict[str, Any]:
        return times_apart({**header(self.design), **self.figures, "warnings": list(self.warnings)})


def roll_test(
    pair: GearPair, path: ContactPath, positions: int = ROLL_POSITIONS, tolerance: float = ROLL_TOLERANCE
) -> RollTest:
    """Roll the meshed flanks (facets within `tolerance`, mm) at some positions of a solved path and compare."""
    from gearmesh.view.on_tooth import spread

    inside = np.flatnonzero(np.isin(path.kind, ("point", "line")))
    chosen = spread(inside if inside.size else np.flatnonzero(path.touching), positions)
    pinion, gear = flank_meshes(pair, tolerance)
    contacts = roll(
        pinion, gear, pair.mounts, pair.ratio, path.rotation[chosen], pair.drive, pair.delta, path.phi2[chosen]
    )
    rows = []
    for k, found in zip(chosen, contacts, strict=True):
        is_point = bool(path.kind[k] == "point") and not found.cut_by_edge
        twist = np.degrees(np.arccos(min(1.0, abs(float(found.major @ path.major[k]))))) if is_point else None
        rows.append(
            {
                "phi1_deg": float(np.degrees(path.phi1[k])),
                "te_difference_arcsec": float(found.phi2 - path.phi2[k]) / ARCSEC,
                "a_ratio": float(found.semi_major / path.semi_major[k]) if is_point else None,
                "b_ratio": float(found.semi_minor / path.semi_minor[k]) if is_point else None,
                "angle_difference_deg": twist,
                "centre_distance_um": 1e3 * float(np.linalg.norm(found.centre_limit - path.point[k]))
                if is_point
                else None,
            }
        )
    return RollTest(rows, contacts)


def flank_meshes(pair: GearPair, tolerance: float) -> tuple[TriangleMesh, TriangleMesh]:
    """The touching flanks of one tooth each, meshed within `tolerance` (mm), in the members' own frames."""
    from gearmesh.mesh.solid import teeth_mesh
    from gearmesh.mesh.tessellate import tessellate

    first, second = (
        teeth_mesh(tessellate(member.tooth, tolerance, (FLANKS[side],)), member.name, np.array([0]))
        for member, side in zip(pair.both, pair.flanks, strict=True)
    )
    return first, second
