"""Check: meshes compared with the exact surfaces, and a roll test of meshed flanks compared with the contact solver."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from gearmesh.answers.bodies.solid import Solid
from gearmesh.answers.contact.fit import NO_CONTACT_WARNING
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, plain, run_time_keys
from gearmesh.check.members import roll_teeth
from gearmesh.check.roll import RollContact, roll
from gearmesh.check.windings import turns
from gearmesh.contact.engagement.turns import FullTurns
from gearmesh.contact.fit.fit import ROUNDING_MM, Fit
from gearmesh.contact.flanks import smooth_under
from gearmesh.contact.path import ContactPath
from gearmesh.design.core import Design
from gearmesh.figures import Content, Figures, Summary, at_resolution, figure
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, dot, spread
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.records import dataclass
from gearmesh.systems.system import Reserve
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.region import FLANK_REGIONS

#: facet tolerance of the flanks in the roll test
ROLL_TOLERANCE_MM = 1e-4
#: smallest facet tolerance in the roll test, relative to the tooth height; it counts for large teeth
ROLL_TOLERANCE_PER_HEIGHT = 3e-6
#: limit of the relative difference between the axes of the rolled ellipse and of the solver's
AXES_LIMIT = 0.1
#: limit of the angle between the major axes of both ellipses, deg
ANGLE_LIMIT_DEG = 2.0
#: limit of the distance of both centres, in semi-major axes
CENTRE_LIMIT = 0.1
#: ratio of the axes below which an ellipse has no definite direction
ROUND_AXES_RATIO = 1.2
#: limit of the transmission error from facets, over tolerance / lever: facets of both members, seen obliquely
FACET_ERROR_FACTOR = 2.5
#: positions of the roll test, spread over the positions with contact inside both flanks
ROLL_POSITIONS = 3


@dataclass(frozen=True)
class Verdict(Figures):
    """Something that was compared."""

    what: str = figure("what was compared")
    value: float = figure("its value")
    limit: float = figure("limit of the value: a maximum, or a minimum for backlash, clearance and reserves")
    ok: bool = figure("whether the value is within the limit")


@dataclass(frozen=True)
class RollRow(Figures):
    """One position of the roll test against the contact solver."""

    phi1: float = figure("rotation of the pinion", "deg", "phi_1")
    rolled: str = figure("what was rolled: meshed flanks or whole teeth")
    te_difference: float = figure("transmission error of the roll test minus that of the solver", "arcsec")
    along: float | None = figure(
        "the same along the travel of a gear that slides", "um", key="te_difference_um", optional=True
    )
    a_ratio: float | None = figure("semi-major axis of the contact ellipse of the roll test, over that of the solver")
    b_ratio: float | None = figure("semi-minor axis of the contact ellipse of the roll test, over that of the solver")
    angle_difference: float | None = figure("angle between the major axes of both ellipses", "deg")
    centre_distance: float | None = figure("distance between the centres of both ellipses", "um")

    @property
    def difference(self) -> float:
        """Difference of the transmission error, in the unit of the gear's errors."""
        return self.te_difference if self.along is None else self.along


@dataclass(frozen=True)
class MeshRoll(Figures):
    """The roll test of a further mesh of a gear set."""

    members: tuple[str, ...] = figure("members of the mesh")
    roll: list[RollRow] = figure("positions of the roll test")


@dataclass(frozen=True, repr=False)
class RollTest(Result):
    """Roll test of a pair, compared with the contact solver."""

    #: comparison at each position, as `check --json` writes it
    rows: list[RollRow]
    #: rolled contacts of the meshed flanks
    contacts: tuple[RollContact, ...]
    #: largest difference of each kind, with its limit
    verdicts: tuple[Verdict, ...] = ()

    @property
    def headline(self) -> str:
        unit = "um" if any(row.along is not None for row in self.rows) else "arcsec"
        differences = [abs(row.difference) for row in self.rows if np.isfinite(row.difference)]
        rolled = f", TE within {max(differences):.2g} {unit}" if differences else ""
        return f"{len(self.rows)} positions{rolled}"

    @property
    def listings(self) -> list[Listing]:
        if not self.rows:
            return []
        rows = [plain(row.row) for row in self.rows]
        return [Listing("Roll test against solver", list(rows[0]), [list(row.values()) for row in rows])]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.row for row in self.rows])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {"roll": self.rows}

    def patches(self, pair: GearPair, name: str) -> list[tuple[Array, Array]]:
        """Gap maps of the positions that touch.

        Parameters
        ----------
        pair : GearPair
            The pair that rolled.
        name : str
            Name of the member in whose own frame the points are.

        Returns
        -------
        list of (ndarray (..., 3), ndarray (...,))
            Points and gaps, mm.

        Examples
        --------
        >>> len(gears.roll(gears.contact([0.0, 1.0])).patches(gears.pairs[0], "pinion"))
        2
        """
        gap_maps = []
        for contact in self.contacts:
            if not contact.touching:
                continue
            points = contact.map_points
            if pair.index(name) == 1:
                first, second = pair.mounts
                points = (second.at(contact.phi2).inverse @ first.at(contact.phi1)).point(points)
            gap_maps.append((points, contact.map_gap))
        return gap_maps


@dataclass(frozen=True, repr=False)
class Check(Result):
    """Solids of all members with their measured deviation, and the roll test of the pair compared with the solver."""

    #: the design of the gears
    design: Design
    #: solids, by names of their members
    solids: dict[str, Solid]
    #: roll test of the first mesh
    roll: RollTest
    #: warnings about gears and figures, one line each
    warnings: tuple[str, ...] = ()
    #: clearances and interference of the first mesh; None if unknown
    fit: Fit | None = None
    #: checks of the further meshes of a gear set, without solids
    others: tuple[Check, ...] = ()
    #: the pair over whole turns, if its tooth pairs differ and the turns are known
    turns: FullTurns | None = None
    #: names of the members of the mesh
    mesh: tuple[str, ...] = ()
    #: reserves of the mesh against interference of its teeth, in closed form
    reserves: tuple[Reserve, ...] = ()

    @property
    def headline(self) -> str:
        worst = max(solid.measured.max_deviation for solid in self.solids.values())
        rolled = f"; rolled: {self.roll.headline}" if self.roll.rows or self.roll.verdicts else ""
        return f"meshes within {worst:.3g} um{rolled}"

    @property
    def complaints(self) -> list[str]:
        """Failures of the meshes, of the roll test and of the fit of the gears, one line each."""
        meshes = [line for solid in self.solids.values() for line in solid.complaints]
        failed = (verdict for verdict in self.verdicts if not verdict.ok)
        return [
            *meshes,
            *(f"{verdict.what} = {verdict.value:.4g}: allowed is {verdict.limit:.4g}" for verdict in failed),
        ]

    @property
    def verdicts(self) -> list[Verdict]:
        """All comparisons, with their limits."""
        compared = []
        for name, solid in self.solids.items():
            value, limit = solid.measured.max_deviation, solid.measured.tolerance
            compared.append(Verdict(f"{name}: max_deviation_um", value, limit, value <= limit))
            compared.append(Verdict(f"{name}: defects", float(len(solid.complaints)), 0.0, not solid.complaints))
        compared += self.roll.verdicts
        meeting_sides = "fit: sides on which the flanks meet"
        if self.fit is None and NO_CONTACT_WARNING in self.warnings:
            compared.append(Verdict(meeting_sides, float(bool(self.roll.rows)), 2.0, ok=False))
        if self.fit is not None:
            compared.append(Verdict(meeting_sides, 2.0, 2.0, ok=True))
            play, depth = (
                self.fit.normal_backlash[0],
                max((overlap.depth for overlap in self.fit.interference), default=0.0),
            )
            compared.append(
                Verdict("fit: parts of the cycle without contact", float(len(self.fit.gaps)), 0.0, not self.fit.gaps)
            )
            is_known = bool(np.isfinite(play))
            compared.append(Verdict("fit: least backlash_normal_mm", play, 0.0, is_known and not play < -ROUNDING_MM))
            compared.append(Verdict("fit: interference_um", 1e3 * depth, 0.0, depth == 0.0))
            collided = max((tips.depth for tips in self.fit.collisions), default=0.0)
            compared.append(Verdict("fit: tip_collision_um", 1e3 * collided, 0.0, collided == 0.0))
            for name, clearance in zip(self.mesh or self.solids, self.fit.clearances, strict=False):
                if clearance is not None:
                    distance = clearance.distance
                    compared.append(Verdict(f"fit: tip_clearance_{name}_mm", distance, 0.0, distance >= -ROUNDING_MM))
        if self.turns is not None:
            play = float(np.degrees(self.turns.backlash.min()))
            compared.append(Verdict("fit: least turns_backlash_deg", play, 0.0, self.turns.runs_free))
        for reserve in self.reserves:
            compared.append(Verdict(f"sheet: {reserve.name}_{reserve.unit}", reserve.value, 0.0, reserve.value >= 0.0))
        for other in self.others:
            compared += [replace(verdict, what=f"{'-'.join(other.mesh)}: {verdict.what}") for verdict in other.verdicts]
        return compared

    @property
    def listings(self) -> list[Listing]:
        meshes = {name: plain(figures) for name, figures in self.meshes.items()}
        keys = list(next(iter(meshes.values())))
        rows = [[member, *(values[key] for key in keys)] for member, values in meshes.items()]
        verdicts = [
            [
                verdict.what,
                *(at_resolution(plain(value), ROUNDING_MM) for value in (verdict.value, verdict.limit)),
                "ok" if verdict.ok else "FAILED",
            ]
            for verdict in self.verdicts
        ]
        return [
            Listing(
                "Meshes against exact surfaces", ["", *keys], rows, run_time_keys(next(iter(self.meshes.values())))
            ),
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
    def meshes(self) -> dict[str, Summary]:
        """Figures of the meshes, by members."""
        return {name: solid.figures for name, solid in self.solids.items()}

    @property
    def sections(self) -> Mapping[str, Content]:
        others = [MeshRoll(other.mesh, other.roll.rows) for other in self.others]
        return {
            **header(self.design),
            "mesh": self.meshes,
            "roll": self.roll.rows,
            **({"other_meshes": others} if others else {}),
            "verdicts": self.verdicts,
            "warnings": self.warnings,
        }


def roll_test(
    pair: GearPair, path: ContactPath, positions: int = ROLL_POSITIONS, tolerance: float | None = None
) -> RollTest:
    """Roll the meshed flanks at some positions of a solved path, and compare the result with the path.

    The facets are within `tolerance` (mm). Flank meshes have no fillets. Where the solver finds a tip on a fillet,
    exact whole teeth are rolled at some of these positions.
    """
    if tolerance is None:
        tolerance = max(ROLL_TOLERANCE_MM, ROLL_TOLERANCE_PER_HEIGHT * min(member.tooth.height for member in pair.both))
    if not path.touching.any():
        return RollTest([], ())
    # positions with contact inside both flanks; if there are none, with contact on an edge of a flank
    inside = np.flatnonzero(np.isin(path.kind, ("point", "line")))
    chosen = spread(inside if inside.size else np.flatnonzero(path.touching & (path.part == 0)), positions)
    contacts: tuple[RollContact, ...] = ()
    if chosen.size:
        contacts = roll(
            *flank_meshes(pair, tolerance),
            pair.mounts,
            pair.ratio,
            path.rotation[chosen],
            pair.drive,
            pair.delta,
            path.phi2[chosen],
            turns(pair.pinion.tooth),
        )
    rows, smooth = list[RollRow](), smooth_under(pair, path)
    for k, contact in zip(chosen, contacts, strict=True):
        flank_row = _rotation_row(path, k, contact.phi2, pair.output, "flanks")
        comparable = bool(path.kind[k] == "point") and not contact.cut_by_edge and bool(smooth[k])
        rows.append(_with_ellipse(flank_row, contact, path, k) if comparable else flank_row)
    # positions at which a tip touches a fillet: whole teeth are rolled, because the meshes are of flanks only
    filleted = spread(np.flatnonzero(path.touching & (path.part > 0)), positions)
    if filleted.size:
        whole = roll_teeth(pair, path.rotation[filleted], guess_phi2=path.phi2[filleted])
        for k, touch in zip(filleted, whole, strict=True):
            rows.append(_rotation_row(path, k, np.nan if touch is None else touch.phi2, pair.output, "whole teeth"))
    # facets within the tolerance turn the gear by up to tolerance / lever about its axis
    compared, mount = np.concatenate((chosen, filleted)), pair.gear.mount
    arms = np.abs(dot(path.normal[compared], mount.velocity(path.point[compared])))
    limits = (FACET_ERROR_FACTOR * tolerance / arms / pair.output.reading.error[0]).tolist()
    rolled = (*contacts, *[None] * len(filleted))
    return RollTest(rows, contacts, tuple(_rolled_verdicts(rows, rolled, limits)))


def _rotation_row(path: ContactPath, k: int, phi2: float, output: Joint, rolled: str) -> RollRow:
    """Return the difference of the gear's rotation from the path at its k-th position, and what was rolled."""
    difference = float(phi2 - path.phi2[k])
    return RollRow(
        float(np.degrees(path.phi1[k])),
        rolled,
        difference / ARCSEC,
        output.way(1e3 * difference),
        None,
        None,
        None,
        None,
    )


def _with_ellipse(row: RollRow, rolled: RollContact, path: ContactPath, k: int) -> RollRow:
    """Return the row with the rolled contact ellipse compared with the ellipse of the path."""
    return replace(
        row,
        a_ratio=float(rolled.semi_major / path.semi_major[k]),
        b_ratio=float(rolled.semi_minor / path.semi_minor[k]),
        angle_difference=float(np.degrees(np.arccos(min(1.0, abs(float(rolled.major @ path.major[k])))))),
        centre_distance=1e3 * float(np.linalg.norm(rolled.centre_limit - path.point[k])),
    )


def _rolled_verdicts(
    rows: list[RollRow], contacts: tuple[RollContact | None, ...], te_limits: list[float]
) -> Iterator[Verdict]:
    """Yield the largest difference of each kind over all positions, relative to its limit."""
    kinds: dict[str, list[tuple[float, float]]] = {}
    for row, te_limit, contact in zip(rows, te_limits, contacts, strict=True):
        for what, value, limit in _comparisons(row, te_limit, contact):
            kinds.setdefault(what, []).append((value, limit))
    for what, values in kinds.items():
        value, limit = max(values, key=lambda pair: float(np.nan_to_num(pair[0] / pair[1], nan=np.inf)))
        yield Verdict(f"roll: {what}", value, limit, bool(value <= limit))


def _comparisons(row: RollRow, te_limit: float, contact: RollContact | None) -> Iterator[tuple[str, float, float]]:
    """Yield each quantity that is compared at a position, its difference, and the limit of the difference."""
    yield RollRow.key_of("te_difference" if row.along is None else "along"), abs(row.difference), te_limit
    if row.a_ratio is None or row.b_ratio is None or contact is None:
        return
    yield f"{RollRow.key_of('a_ratio')} off 1", abs(row.a_ratio - 1.0), AXES_LIMIT
    yield f"{RollRow.key_of('b_ratio')} off 1", abs(row.b_ratio - 1.0), AXES_LIMIT
    if row.angle_difference is not None and contact.semi_major > ROUND_AXES_RATIO * contact.semi_minor:
        yield RollRow.key_of("angle_difference"), row.angle_difference, ANGLE_LIMIT_DEG
    if row.centre_distance is not None:
        yield RollRow.key_of("centre_distance"), row.centre_distance, 1e3 * CENTRE_LIMIT * contact.semi_major


def flank_meshes(pair: GearPair, tolerance: float) -> tuple[TriangleMesh, TriangleMesh]:
    """Return the touching flanks of one tooth of each member, own frames, meshed within `tolerance` (mm)."""
    from gearmesh.mesh.solid import teeth_mesh
    from gearmesh.mesh.tessellate import tessellate

    first, second = (
        teeth_mesh(tessellate(member.tooth, tolerance, (FLANK_REGIONS[side],), lean=False), member.name, np.array([0]))
        for member, side in zip(pair.both, pair.flanks, strict=True)
    )
    return first, second
