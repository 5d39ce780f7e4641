"""The check: meshes against the exact surfaces, and the roll test of meshed flanks against the contact solver."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from gearmesh.answers.bodies.solid import Solid
from gearmesh.answers.contact.fit import UNMET
from gearmesh.answers.result import Result, columns, header, times_apart
from gearmesh.answers.tables import Listing, plain
from gearmesh.check.members import roll_teeth
from gearmesh.check.roll import RollContact, roll
from gearmesh.contact.fit.fit import NOTHING, Fit
from gearmesh.contact.flanks import smooth_under
from gearmesh.contact.path import ARCSEC, ContactPath, error_unit
from gearmesh.design.core import Design
from gearmesh.kernel.numeric.algebra import Array, dot, spread
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.region import FLANKS
from gearmesh.teeth.train import GearPair

#: facet tolerance (mm) of the flanks that the roll test turns against each other, and over the height of teeth so large that this
#: is more
ROLL_TOLERANCE, OF_HEIGHT = 1e-4, 3e-6
#: the rolled ellipse against the solver's: relative difference of the axes, angle (deg), distance of the centres over semi_major
AXES_LIMIT, ANGLE_LIMIT, CENTRE_LIMIT = 0.1, 2.0, 0.1
#: ellipses rounder than this have no direction
ROUND = 1.2
#: transmission error of facets within a tolerance, over tolerance / lever: both members' facets, seen obliquely
FACETS = 2.5
#: positions at which the roll test is made, spread over those with contact inside both flanks
ROLL_POSITIONS = 3


@dataclass(frozen=True)
class Verdict:
    """Something that was compared: its value, the limit that it must keep (at most that, or for what may not be less, at least) and
    whether it does."""

    what: str
    value: float
    limit: float
    ok: bool


@dataclass(frozen=True, repr=False)
class RollTest(Result):
    """Comparison rows of `check --json`, the rolled contacts themselves, and the largest difference of each kind with its limit."""

    rows: list[dict[str, Any]]
    contacts: tuple[RollContact, ...]
    verdicts: tuple[Verdict, ...] = ()

    @property
    def headline(self) -> str:
        unit = "um" if self.rows and "te_difference_um" in self.rows[0] else "arcsec"
        differences = [abs(row[f"te_difference_{unit}"]) for row in self.rows]
        off = [each for each in differences if np.isfinite(each)]
        rolled = f", TE within {max(off):.2g} {unit}" if off else ""
        return f"{len(self.rows)} positions{rolled}"

    @property
    def listings(self) -> list[Listing]:
        if not self.rows:
            return []
        rows = plain(self.rows)
        heads = list(rows[0])
        return [Listing("Roll test against solver", heads, [[row[key] for key in heads] for row in rows])]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns(self.rows)

    def document(self) -> dict[str, Any]:
        return {"roll": self.rows}

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
    """Solids of all members with their measured deviation, and the roll test of the pair against the solver.

    Of a train with several meshes `others` holds what was found of the meshes beside the first, without solids; `mesh` names the
    members of a mesh.
    """

    design: Design
    solids: dict[str, Solid]
    roll: RollTest
    warnings: tuple[str, ...] = ()
    fit: Fit | None = None
    others: tuple[Check, ...] = ()
    mesh: tuple[str, ...] = ()

    @property
    def headline(self) -> str:
        worst = max(solid.measured.max_deviation for solid in self.solids.values())
        return f"meshes within {worst:.3g} um; rolled: {self.roll.headline}"

    @property
    def complaints(self) -> list[str]:
        """What is wrong with the meshes, with the contact as it was rolled, and with how the gears fit, one line each."""
        meshes = [line for solid in self.solids.values() for line in solid.complaints]
        failed = (each for each in self.verdicts if not each.ok)
        return [*meshes, *(f"{each.what} = {each.value:.4g}: allowed is {each.limit:.4g}" for each in failed)]

    @property
    def verdicts(self) -> list[Verdict]:
        """Everything that was compared, with its limit."""
        found = []
        for name, solid in self.solids.items():
            value, limit = solid.measured.max_deviation, solid.measured.tolerance
            found.append(Verdict(f"{name}: max_deviation_um", value, limit, value <= limit))
            found.append(Verdict(f"{name}: defects", float(len(solid.complaints)), 0.0, not solid.complaints))
        found += self.roll.verdicts
        meet = "fit: sides on which the flanks meet"
        if self.fit is None and UNMET in self.warnings:
            found.append(Verdict(meet, float(bool(self.roll.rows)), 2.0, ok=False))
        if self.fit is not None:
            found.append(Verdict(meet, 2.0, 2.0, ok=True))
            play, depth = self.fit.normal_backlash[0], max((each.depth for each in self.fit.interference), default=0.0)
            found.append(
                Verdict("fit: parts of the cycle without contact", float(len(self.fit.gaps)), 0.0, not self.fit.gaps)
            )
            known = bool(np.isfinite(play))
            found.append(Verdict("fit: least backlash_normal_mm", play, 0.0, known and not play < -NOTHING))
            found.append(Verdict("fit: interference_um", 1e3 * depth, 0.0, depth == 0.0))
            for name, clearance in zip(self.mesh or self.solids, self.fit.clearances, strict=False):
                if clearance is not None:
                    apart = clearance.distance
                    found.append(Verdict(f"fit: tip_clearance_{name}_mm", apart, 0.0, apart >= -NOTHING))
        for other in self.others:
            found += [replace(each, what=f"{'-'.join(other.mesh)}: {each.what}") for each in other.verdicts]
        return found

    @property
    def listings(self) -> list[Listing]:
        meshes = {name: plain(solid.figures) for name, solid in self.solids.items()}
        keys = list(next(iter(meshes.values())))
        rows = [[member, *(values[key] for key in keys)] for member, values in meshes.items()]
        verdicts = [
            [each.what, plain(each.value), plain(each.limit), "ok" if each.ok else "FAILED"] for each in self.verdicts
        ]
        return [
            Listing("Meshes against exact surfaces", ["", *keys], rows),
            *self.roll.listings,
            *(
                replace(listing, title=f"{listing.title}: {' and '.join(other.mesh)}")
                for other in self.others
                for listing in other.roll.listings
            ),
            Listing("Verdicts", ["", "value", "limit", ""], verdicts),
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return self.roll.to_dict()

    @property
    def figures(self) -> dict[str, Any]:
        """Figures of the meshes by member, and the rows of the roll test."""
        found: dict[str, Any] = {
            "mesh": {name: solid.figures for name, solid in self.solids.items()},
            "roll": self.roll.rows,
        }
        if self.others:
            found["other_meshes"] = [{"members": list(other.mesh), "roll": other.roll.rows} for other in self.others]
        return found

    def document(self) -> dict[str, Any]:
        verdicts = [asdict(each) for each in self.verdicts]
        return times_apart(
            {**header(self.design), **self.figures, "verdicts": verdicts, "warnings": list(self.warnings)}
        )


def roll_test(
    pair: GearPair, path: ContactPath, positions: int = ROLL_POSITIONS, tolerance: float | None = None
) -> RollTest:
    """Roll the meshed flanks (facets within `tolerance`, mm) at some positions of a solved path and compare; and, as fillets are no
    part of them, exact whole teeth of the pair at some of those where the solver finds a tip on a fillet."""
    if tolerance is None:
        tolerance = max(ROLL_TOLERANCE, OF_HEIGHT * min(member.tooth.height for member in pair.both))
    if not path.touching.any():
        return RollTest([], ())
    inside = np.flatnonzero(np.isin(path.kind, ("point", "line")))
    chosen = spread(inside if inside.size else np.flatnonzero(path.touching & (path.part == 0)), positions)
    contacts: tuple[RollContact, ...] = ()
    if chosen.size:
        pinion, gear = flank_meshes(pair, tolerance)
        contacts = roll(
            pinion, gear, pair.mounts, pair.ratio, path.rotation[chosen], pair.drive, pair.delta, path.phi2[chosen]
        )
    rows, smooth, (rad, unit) = [], smooth_under(pair, path), error_unit(pair.slide)
    key = f"te_difference_{unit}"
    for k, found in zip(chosen, contacts, strict=True):
        is_point = bool(path.kind[k] == "point") and not found.cut_by_edge and bool(smooth[k])
        twist = np.degrees(np.arccos(min(1.0, abs(float(found.major @ path.major[k]))))) if is_point else None
        rows.append(
            {
                **_turned(path, k, found.phi2, rad, key, "flanks"),
                "a_ratio": float(found.semi_major / path.semi_major[k]) if is_point else None,
                "b_ratio": float(found.semi_minor / path.semi_minor[k]) if is_point else None,
                "angle_difference_deg": twist,
                "centre_distance_um": 1e3 * float(np.linalg.norm(found.centre_limit - path.point[k]))
                if is_point
                else None,
            }
        )
    filleted = spread(np.flatnonzero(path.touching & (path.part > 0)), positions)
    if filleted.size:
        whole = roll_teeth(pair, path.rotation[filleted], guess_phi2=path.phi2[filleted])
        for k, touch in zip(filleted, whole, strict=True):
            phi2 = np.nan if touch is None else touch.phi2
            rows.append({**_turned(path, k, phi2, rad, key, "whole teeth"), **dict.fromkeys(_OF_POINTS)})
    compared, mount = np.concatenate((chosen, filleted)), pair.gear.mount
    arms = np.abs(dot(path.normal[compared], mount.velocity(path.point[compared])))
    limits = (FACETS * tolerance / arms / rad).tolist()
    rolled = (*contacts, *[None] * len(filleted))
    return RollTest(rows, contacts, tuple(_rolled_verdicts(rows, rolled, limits, key)))


#: what of a row is that of contact ellipses alone
_OF_POINTS = ("a_ratio", "b_ratio", "angle_difference_deg", "centre_distance_um")


def _turned(path: ContactPath, k: int, phi2: float, rad: float, key: str, rolled: str) -> dict[str, Any]:
    """What every row of the roll test has: how far the gear is from where the path has it, in arcsec and, under `key`, in the
    unit of `rad`, too, of a gear that slides; and what was rolled."""
    off = float(phi2 - path.phi2[k])
    return {
        "phi1_deg": float(np.degrees(path.phi1[k])),
        "rolled": rolled,
        "te_difference_arcsec": off / ARCSEC,
        key: off / rad,
    }


def _rolled_verdicts(
    rows: list[dict[str, Any]], contacts: tuple[RollContact | None, ...], te_limits: list[float], te_key: str
) -> Iterator[Verdict]:
    """The largest difference of each kind that was compared, over all positions; `te_key`: that of the transmission error."""
    limits: dict[str, list[tuple[float, float]]] = {}
    for row, te_limit, contact in zip(rows, te_limits, contacts, strict=True):
        limits.setdefault(te_key, []).append((abs(row[te_key]), te_limit))
        if row["a_ratio"] is None or contact is None:
            continue
        for key in ("a_ratio", "b_ratio"):
            limits.setdefault(key, []).append((abs(row[key] - 1.0), AXES_LIMIT))
        if contact.semi_major > ROUND * contact.semi_minor:
            limits.setdefault("angle_difference_deg", []).append((row["angle_difference_deg"], ANGLE_LIMIT))
        centre = row["centre_distance_um"], 1e3 * CENTRE_LIMIT * contact.semi_major
        limits.setdefault("centre_distance_um", []).append(centre)
    for key, each in limits.items():
        value, limit = max(each, key=lambda pair: float(np.nan_to_num(pair[0] / pair[1], nan=np.inf)))
        what = f"{key} off 1" if key.endswith("ratio") else key
        yield Verdict(f"roll: {what}", value, limit, bool(value <= limit))


def flank_meshes(pair: GearPair, tolerance: float) -> tuple[TriangleMesh, TriangleMesh]:
    """The touching flanks of one tooth each, meshed within `tolerance` (mm), in the members' own frames."""
    from gearmesh.mesh.solid import teeth_mesh
    from gearmesh.mesh.tessellate import tessellate

    first, second = (
        teeth_mesh(tessellate(member.tooth, tolerance, (FLANKS[side],)), member.name, np.array([0]))
        for member, side in zip(pair.both, pair.flanks, strict=True)
    )
    return first, second
