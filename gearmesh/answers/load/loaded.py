"""A pair of gears under torque over a mesh cycle: load sharing, loaded transmission error, pressures, stiffness, root stress."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.answers.load.materials import materials_of
from gearmesh.answers.load.mounting import held_by_rim, mounts_of
from gearmesh.answers.result import Result, columns, header, times_apart
from gearmesh.answers.tables import Listing, csv_text, flat, plain, rounded
from gearmesh.contact.cycle import Cycle
from gearmesh.contact.path import ARCSEC
from gearmesh.design.core import Design
from gearmesh.errors import DesignError, Status
from gearmesh.kernel.algebra import Array
from gearmesh.loaded.compliance import FlankCompliance
from gearmesh.loaded.edges import EdgeLoad, edge_loads
from gearmesh.loaded.mounts import FlexibleMount
from gearmesh.loaded.sharing import LoadedMesh, PairLoad, compliances, loaded_mesh, whole_cycle
from gearmesh.teeth.train import GearPair

#: positions in a pitch
POSITIONS = 21
#: acute angle between axes, rad, up to which a pair is one with parallel axes and an error of assembly
NEARLY_PARALLEL = 0.01


@dataclass(frozen=True, repr=False)
class LoadedContact(Result):
    """The gears of a pair under torques on the pinion, position by position; `cycle`: their whole mesh cycle without load, None
    where it was not handed on."""

    design: Design
    pair: GearPair
    mesh: LoadedMesh
    warnings: tuple[str, ...]
    seconds: float
    cycle: Cycle | None = None

    @property
    def unloaded_peak_to_peak(self) -> float:
        """Of the transmission error without load over the whole mesh cycle, rad: that of `Contact`; NaN where it is not known."""
        return np.nan if self.cycle is None else self.cycle.peak_to_peak

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (".json", ".csv")

    @property
    def headline(self) -> str:
        worst = _largest(np.concatenate([load.peak for load in self.mesh.loads]))
        told = "contact on edges alone" if np.isnan(worst) else f"pressure up to {worst:.4g} MPa"
        return f"{len(self.mesh.torque)} torques at {len(self.mesh.phi1)} positions, {told}"

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One dict a torque and position, with the keys of the JSON; pair k does at phi1 what pair 0 does k pitches before."""
        return [self._row(k, p) for k in range(len(self.mesh.torque)) for p in range(len(self.mesh.phi1))]

    def _row(self, torque: int, position: int) -> dict[str, Any]:
        mesh, load, at = self.mesh, self.mesh.loads[torque], (torque, position)
        own = np.flatnonzero((load.position == position) & (load.force > 0.0))
        share = load.moment / mesh.torque[torque]
        worst = own[np.nan_to_num(load.peak[own]).argmax()]
        return {
            "torque_nm": 1e-3 * float(mesh.torque[torque]),
            "phi1_deg": float(np.degrees(mesh.phi1[position]).round(12)),
            "te_arcsec": float(mesh.te[at] - mesh.unloaded[0]) / ARCSEC,
            "unloaded_te_arcsec": float(mesh.unloaded[position] - mesh.unloaded[0]) / ARCSEC,
            "rotation_arcsec": float(mesh.rotation[at]) / ARCSEC,
            "gear_torque_nm": 1e-3 * float(mesh.gear_torque[at]),
            **self._slid(at),
            "stiffness_nm_per_arcsec": 1e-3 * float(mesh.stiffness[at]) * ARCSEC,
            "tangent_stiffness_nm_per_arcsec": 1e-3 * float(mesh.tangent[at]) * ARCSEC,
            **({} if self._width is None else {"tangent_stiffness_n_per_mm_um": float(mesh.tangent[at]) / self._width}),
            "peak_pressure_mpa": float(load.peak[worst]),
            "peak_pressure_pair": int(load.number[worst]) if np.isfinite(load.peak[worst]) else None,
            "peak_pressure_point_mm": load.place[worst].tolist(),
            "edge_contact": bool(load.edge_contact[own].any()),
            **self._root(
                mesh.bending[at],
                mesh.root_error[at],
                mesh.root_stress[at],
                mesh.tangent_stress[at],
                mesh.contact_stress[at],
            ),
            **{
                f"{name}_root_stress_point_mm": mesh.root_place[at][n].tolist()
                for n, name in enumerate(self.pair.members)
            },
            **self._displaced(at),
            "tooth_pairs": [
                {
                    "pair": int(load.number[m]),
                    "load_share": float(share[m]),
                    **({} if self.pair.pinion.mirrored is None else {"half": int(load.half[m]) + 1}),
                    "force_n": float(load.force[m]),
                    "peak_pressure_mpa": float(load.peak[m]),
                    "on_edge": bool(load.on_edge[m]),
                    "edge_contact": bool(load.edge_contact[m]),
                    **self._bending(load, m),
                }
                for m in own
            ],
            "residual_mm": float(mesh.residual[at]),
            "status": Status(int(mesh.status[at])).name.lower(),
        }

    @cached_property
    def _width(self) -> float | None:
        """N mm/rad of the pinion in 1 N/(mm um) at its base circle per mm of face [ISO 6336-1]; None where axes cross."""
        return None if self.pair.slide is not None else _per_width(self.pair, self.mesh.loads[-1])

    def _root(
        self, bending: Array, error: Array, largest: Array, at_tangent: Array, contact: Array
    ) -> dict[str, float]:
        """Stresses (2,), MPa, in the fillets of both members: bending, with the estimate of its error, the largest away from the
        contact, that at the tangents of 30 deg, and the contact's own."""
        found: dict[str, float] = {}
        for n, name in enumerate(self.pair.members):
            found |= {
                f"{name}_bending_stress_mpa": float(bending[n]),
                f"{name}_bending_stress_error_percent": 100.0 * float(error[n]),
                f"{name}_root_stress_mpa": float(largest[n]),
                f"{name}_root_stress_30_mpa": float(at_tangent[n]),
                f"{name}_fillet_contact_stress_mpa": float(contact[n]),
            }
        return found

    def _bending(self, load: PairLoad, pair: int | np.intp) -> dict[str, float]:
        """Bending stress, MPa, in the fillets of the teeth of a pair; NaN where all of it is the contact's own field."""
        own = load.roots.nominal[pair]
        return {f"{name}_bending_stress_mpa": float(own[n]) for n, name in enumerate(self.pair.members)}

    @property
    def tooth_pair(self) -> list[dict[str, Any]]:
        """One tooth pair over the cycle of meshing: one dict a torque and rotation of the pinion, counted from where the pair is at
        phi1 as others are a whole number of pitches before or after; `peak_pressure_mpa` is NaN where `edge_contact` is."""
        found = []
        for torque, load in zip(self.mesh.torque, self.mesh.loads, strict=True):
            phase = self.mesh.phi1[load.position] - self.pair.pitch * load.number
            for m in np.lexsort((phase, load.half)):
                if load.force[m] > 0.0:
                    found.append(
                        {
                            "torque_nm": 1e-3 * float(torque),
                            "phi1_deg": float(np.degrees(phase[m]).round(12)),
                            **({} if self.pair.pinion.mirrored is None else {"half": int(load.half[m]) + 1}),
                            "load_share": float(load.moment[m] / torque),
                            "force_n": float(load.force[m]),
                            "peak_pressure_mpa": float(load.peak[m]),
                            "edge_contact": bool(load.edge_contact[m]),
                            **self._bending(load, m),
                        }
                    )
        return found

    def _displaced(self, at: tuple[int, int]) -> dict[str, list[float]]:
        """What of members is told whose mounts give way: displacements, in which the transmission error has its part."""
        found: dict[str, list[float]] = {}
        for n, name in enumerate(self.pair.members):
            if self.mesh.displacement[..., n, :].any():
                moved = self.mesh.displacement[at][n]
                found[f"{name}_displacement_um"] = (1e3 * moved[:3]).tolist()
                found[f"{name}_tilt_arcsec"] = (moved[3:] / ARCSEC).tolist()
        return found

    def _slid(self, at: tuple[int, int]) -> dict[str, float]:
        """What of a gear that slides is told beside its angles, which are those of the circle that rolls along it."""
        slide, mesh = self.pair.slide, self.mesh
        if slide is None:
            return {}
        te, unloaded = (float(each - mesh.unloaded[0]) for each in (mesh.te[at], mesh.unloaded[at[1]]))
        found = {"te_um": 1e3 * slide * te, "unloaded_te_um": 1e3 * slide * unloaded}
        return found | {"gear_force_n": float(mesh.gear_torque[at]) / slide}

    def share_at(self, rotation: Array, torque: int = 0) -> Array:
        """Share (P,) of one of the torques that tooth pair 0 carries at rotations (P,), rad, of the pinion; 0 where none.

        Between positions it is linear: of positions evenly spaced over a pitch shares of all pairs sum to 1 everywhere.
        """
        load = self.mesh.loads[torque]
        number = np.arange(load.number.min() - 1, load.number.max() + 2)
        share = np.zeros((len(self.mesh.phi1), len(number)))
        np.add.at(share, (load.position, load.number - number[0]), load.moment / self.mesh.torque[torque])
        own = (self.mesh.phi1[:, None] - self.pair.pitch * number).ravel()
        order = np.argsort(own)
        found: Array = np.interp(rotation, own[order], share.ravel()[order], 0.0, 0.0)
        return found

    @property
    def totals(self) -> list[dict[str, Any]]:
        """One dict a torque: peak to peak of the loaded transmission error over the positions and of the unloaded one over the
        whole mesh cycle, means of the tangent stiffness (on parallel axes also
        per mm of face, c_gamma of ISO 6336-1), the greatest of all else over the positions."""
        return [self._total(k, load) for k, load in enumerate(self.mesh.loads)]

    def _total(self, torque: int, load: PairLoad) -> dict[str, Any]:
        mesh = self.mesh
        carrying = self._carrying(load)
        return {
            "torque_nm": 1e-3 * float(mesh.torque[torque]),
            "te_peak_to_peak_arcsec": float(np.ptp(mesh.te[torque])) / ARCSEC,
            "unloaded_te_peak_to_peak_arcsec": self.unloaded_peak_to_peak / ARCSEC,
            "mean_tooth_pairs": float(carrying.mean()),
            "tooth_pairs": [int(carrying.min()), int(carrying.max())],
            "max_pressure_mpa": _largest(load.peak),
            "max_pair_force_n": float(load.force.max()),
            "mean_tangent_stiffness_nm_per_arcsec": 1e-3 * float(mesh.tangent[torque].mean()) * ARCSEC,
            **(
                {} if self._width is None else {"c_gamma_n_per_mm_um": float(mesh.tangent[torque].mean()) / self._width}
            ),
            **self._root(*(_most(each[torque]) for each in self._in_fillets())),
            "on_edge": bool((load.on_edge & (load.force > 0.0)).any()),
            "edge_contact": bool(load.edge_contact.any()),
            "edge_load_share": {
                each.edge: float(each.moment.max() / mesh.torque[torque])
                for each in edge_loads(self.pair, load, len(mesh.phi1))
                if each.edge
            },
        }

    def _in_fillets(self) -> tuple[Array, ...]:
        """Figures (T, P, 2) in the fillets of both members; the error where bending is the largest of its torque."""
        mesh = self.mesh
        worst = np.nan_to_num(mesh.bending, nan=-np.inf).argmax(axis=1)[:, None]
        error = np.take_along_axis(mesh.root_error, worst, axis=1)
        return mesh.bending, error, mesh.root_stress, mesh.tangent_stress, mesh.contact_stress

    def _carrying(self, load: PairLoad) -> NDArray[np.intp]:
        """How many tooth pairs carry (P,)."""
        own = np.unique(np.stack((load.position, load.number))[:, load.force > 0.0], axis=1)
        return np.bincount(own[0], minlength=len(self.mesh.phi1))

    @property
    def complaints(self) -> list[str]:
        """What did not converge."""
        wrong = self.mesh.status != Status.CONVERGED
        if not wrong.any():
            return []
        torque, position = (int(each[0]) for each in np.nonzero(wrong))
        return [
            f"{int(wrong.sum())} of {wrong.size} positions and torques did not converge, the first at "
            f"{1e-3 * self.mesh.torque[torque]:g} Nm, phi1 = {np.degrees(self.mesh.phi1[position]):.5g} deg: figures there are no "
            "more than a guess; try less torque or positions beside it"
        ]

    @property
    def listings(self) -> list[Listing]:
        names = ["Nm", "phi1 deg", "te arcsec", "pressure MPa", "of pair", "on edge", "load share"]
        bent = [f"{name} MPa" for name in self.pair.members]
        heads = ["Nm", "phi1 deg", "share %", "pressure MPa", *bent]
        return [
            *self.overview,
            Listing("Positions", names, [self._cells(r) for r in self.rows]),
            Listing("One tooth pair: pressure, bending stress", heads, [self._pair_cells(r) for r in self.tooth_pair]),
        ]

    @property
    def overview(self) -> list[Listing]:
        """What is told of whole torques, as tables."""
        over = "the mesh cycle" if whole_cycle(self.pair, self.mesh.phi1) else f"positions: {len(self.mesh.phi1)}"
        first, second = self.pair.members
        heads = ["Nm", "te p-p arcsec", "unloaded", "pairs", "MPa", "pair N", f"{first} root", f"{second} root"]
        shown = [
            *("torque_nm", "te_peak_to_peak_arcsec", "unloaded_te_peak_to_peak_arcsec", "mean_tooth_pairs"),
            *("max_pressure_mpa", "max_pair_force_n", *self._stresses),
        ]
        totals = self.totals
        edges = [
            [each["torque_nm"], edge, rounded(100.0 * share, 2)]
            for each in totals
            for edge, share in each["edge_load_share"].items()
        ]
        return [
            Listing(f"Over {over}", heads, [[rounded(each[key], 3) for key in shown] for each in totals]),
            Listing(
                "Stress in the fillets, MPa",
                _FILLETS,
                [self._fillet(each, n) for each in totals for n in self.pair.members],
            ),
            *([Listing("Most load next to edges", ["Nm", "edge", "% of the torque"], edges)] if edges else []),
        ]

    @property
    def _stresses(self) -> list[str]:
        return [f"{member}_bending_stress_mpa" for member in self.pair.members]

    def _fillet(self, total: dict[str, Any], member: str) -> list[Any]:
        keys = ("bending_stress_mpa", "bending_stress_error_percent", "root_stress_mpa", "fillet_contact_stress_mpa")
        return [total["torque_nm"], member, *(rounded(total[f"{member}_{key}"], 3) for key in keys)]

    def _cells(self, row: dict[str, Any]) -> list[Any]:
        shares = " ".join(f"{_name(each)}:{100.0 * each['load_share']:.0f}%" for each in row["tooth_pairs"])
        figures = (row[key] for key in ("torque_nm", "phi1_deg", "te_arcsec", "peak_pressure_mpa"))
        named = {each["pair"]: _name(each) for each in row["tooth_pairs"]}
        edges = " ".join(_name(each) for each in row["tooth_pairs"] if each["edge_contact"])
        of = row["peak_pressure_pair"]
        return [*(rounded(value, 3) for value in figures), None if of is None else named[of], edges or None, shares]

    def _pair_cells(self, row: dict[str, Any]) -> list[Any]:
        half = "'" if row.get("half") == 2 else ""
        bending = [rounded(row[f"{name}_bending_stress_mpa"], 3) for name in self.pair.members]
        pressure = "edge" if row["edge_contact"] else rounded(row["peak_pressure_mpa"], 3)
        share = f"{rounded(100.0 * row['load_share'], 2)}{half}"
        return [row["torque_nm"], rounded(row["phi1_deg"], 4), share, pressure, *bending]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns(self.rows)

    def csv(self) -> str:
        """One row a torque and position, the columns of the JSON laid flat; of tooth pairs those that carry anywhere."""
        rows = self.rows
        known = {_column(each): dict.fromkeys(each, np.nan) for row in rows for each in row["tooth_pairs"]}
        table = []
        for row in rows:
            pairs = known | {_column(each): each for each in row.pop("tooth_pairs")}
            row |= {k: {key: v for key, v in pairs[k].items() if key not in ("pair", "half")} for k in sorted(known)}
            table.append(dict(flat(row)))
        return csv_text(table)

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        whole_text(target, self.csv())

    @property
    def figures(self) -> dict[str, Any]:
        """What of the document is figures: "totals", one a torque, "positions", one a torque and position, and "tooth_pair", one a
        torque and position of one tooth pair from its first touch to its last."""
        found = {"totals": self.totals, "positions": self.rows, "tooth_pair": self.tooth_pair}
        return {name: [plain(each) for each in rows] for name, rows in found.items()}

    def document(self) -> dict[str, Any]:
        return times_apart(
            {
                **header(self.design),
                "warnings": list(self.warnings),
                **self.figures,
                "seconds": self.seconds,
            }
        )


def loaded_contact_of(
    design: Design,
    pair: GearPair,
    torque: Sequence[float],
    warnings: tuple[str, ...] = (),
    phi1: Array | None = None,
    progress: Callable[[float, str], None] = lambda fraction, doing: None,
    *,
    cycle: Cycle | None,
    bodies: tuple[FlankCompliance, FlankCompliance] | None = None,
    mounts: Mapping[str, FlexibleMount] | None = None,
) -> LoadedContact:
    """A pair under torques (Nm) on the pinion at rotations phi1 (P,), rad, of it; by default at `POSITIONS` in a pitch.

    `cycle`: the whole mesh cycle without load, None where nothing is to be said of it; `bodies`: how both members give way, where
    known: it does not depend on where they stand; `mounts`: shafts and bearings that give way, by the members' names, in the
    place of the design's own.

    Raises DesignError for torques that are not above 0, for eccentric members and for mounts of none of the members.
    """
    started = time.perf_counter()
    for member in pair.both:
        if member.mount.eccentricity != (0.0, 0.0):
            raise DesignError(
                f"pair = {pair.name}: the {member.name} is eccentric, no two of its teeth meet alike; loaded contact is of members "
                f"whose eccentricity is 0"
            )
    places = pair.pitch * np.arange(POSITIONS) / POSITIONS if phi1 is None else phi1
    torques = 1e3 * np.array(required_torques(torque))
    if bodies is None:
        progress(0.0, f"compliance of the {' and the '.join(pair.members)}")
        bodies = bodies_of(design, pair)
    progress(0.2, f"loaded contact, torques: {torques.size}, positions: {len(places)}")
    if unknown := [name for name in mounts or {} if name not in pair.members]:
        raise DesignError(f"mounts = {unknown[0]}: must be of {' or '.join(pair.members)}")
    given = {**mounts_of(design, pair), **(mounts or {})}
    flexible = given.get(pair.pinion.name), given.get(pair.gear.name)
    mesh = loaded_mesh(pair, places, torques, bodies, materials_of(design, pair), flexible=flexible)
    unloaded = np.nan if cycle is None else cycle.peak_to_peak
    return LoadedContact(
        design, pair, mesh, (*warnings, *_warnings(pair, mesh, unloaded)), time.perf_counter() - started, cycle
    )


def required_torques(torque: Sequence[float]) -> list[float]:
    """Torques, Nm. Raises DesignError unless there is one at least and all are above 0."""
    wrong = [each for each in torque if not 0.0 < each < np.inf]
    if wrong or not torque:
        raise DesignError(
            f"torque = {f'{wrong[0]:g}' if wrong else '[]'} Nm: must be one or more finite numbers above 0"
        )
    return list(torque)


def bodies_of(design: Design, pair: GearPair) -> tuple[FlankCompliance, FlankCompliance]:
    """How both members of a pair of a design give way."""
    return compliances(pair, materials_of(design, pair), held_by_rim(design, pair))


def _name(pair: dict[str, Any]) -> str:
    """A tooth pair in the table: its number, of the second half of double helical gears with a stroke."""
    return f"{pair['pair']}" + ("'" if pair.get("half") == 2 else "")


def _column(pair: dict[str, Any]) -> str:
    """A tooth pair in the CSV."""
    return f"pair_{pair['pair']}" + (f"_half_{pair['half']}" if "half" in pair else "")


#: columns of the table of stresses in fillets
_FILLETS = ["Nm", "member", "bending", "error %", "largest", "contact's own"]


def _most(values: Array) -> Array:
    """The largest (2,) of figures (P, 2), NaN where there are none."""
    return np.asarray(np.fmax.reduce(values, axis=0))


def _largest(peaks: Array) -> float:
    """The largest of pressures (M,); NaN where there are none but on edges."""
    return float(np.nanmax(peaks)) if np.isfinite(peaks).any() else np.nan


def _per_width(pair: GearPair, load: PairLoad) -> float | None:
    """N mm/rad of the pinion that are 1 N/(mm um) along the transverse line of action per mm of the common face; None unless the
    axes of both members are parallel, but for errors of assembly."""
    if pair.acute_angle > NEARLY_PARALLEL:
        return None
    axis = pair.pinion.mount.axis
    ends = [
        np.sort(member.mount.base.point(member.tooth.flank_grid(side, [0.5], [0.0, 1.0]).points[0]) @ axis)
        for member, side in zip(pair.both, pair.flanks, strict=True)
    ]
    face = min(high for _, high in ends) - max(low for low, _ in ends)
    grid, weight = load.separation, load.pressure.sum(axis=2)
    across = np.sqrt(1.0 - (grid.normal @ axis) ** 2)
    base = (weight * grid.levers[0] / across).sum() / weight.sum()
    halves = 1 if pair.pinion.mirrored is None else 2
    return 1e3 * float(base**2 * face * halves)


#: what takes load away from an edge
REMEDIES = {
    "tip": "tip relief",
    "toe": "crowning or end relief",
    "heel": "crowning or end relief",
}
#: edges whose loads are told in a warning, and part of what teeth give way by that is an uneven run to warn of
TOLD, UNEVEN = 2, 0.1


def _edge_warnings(pair: GearPair, mesh: LoadedMesh, least: float) -> list[str]:
    """From which torque on edges carry (`least`, N mm), which do most at the largest torque, and what is done about it; and where a
    grid is too short."""
    largest = int(mesh.torque.argmax())
    at, found = f"at {1e-3 * mesh.torque[largest]:g} Nm", edge_loads(pair, mesh.loads[largest], len(mesh.phi1))

    def share(each: EdgeLoad) -> str:
        return f"{100.0 * each.moment.max() / mesh.torque[largest]:.2g} %"

    def place(each: EdgeLoad) -> str:
        return f"(phi1 = {np.degrees(mesh.phi1[each.moment.argmax()]):.4g} deg, {each.width:.2g} mm wide)"

    beyond = [
        f"{at} contact goes on beyond its grid, whose last cells carry up to {share(each)} of the torque {place(each)}: figures "
        "there are those of a shorter contact"
        for each in found
        if not each.edge
    ]
    begun = f" from {1e-3 * least:g} Nm on" if least > mesh.torque.min() else ""
    limitless = f"edges carry{begun}: next to them pressure has no limit and is not told"
    edges = [each for each in found if each.edge]
    if not edges:
        return [limitless, *beyond]
    wanted = dict.fromkeys(REMEDIES[name] for each in edges if (name := each.edge.rpartition("_")[2]) in REMEDIES)
    remedy = f"; {' and '.join(wanted)} would lessen that" if wanted else ""
    most = ", ".join(f"{share(each)} at {each.edge} {place(each)}" for each in edges[:TOLD])
    more = f", less at {len(edges) - TOLD} more" if len(edges) > TOLD else ""
    return [f"{limitless}; {at} their outermost cells carry, of the torque, up to {most}{more}{remedy}", *beyond]


def _error_warning(pair: GearPair, mesh: LoadedMesh, peak_to_peak: float) -> list[str]:
    """Where the gears run less evenly under a torque than without, over a whole mesh cycle, by more than little of their give;
    `peak_to_peak` of the unloaded error, rad, NaN where it is not known."""
    swings, unloaded = np.ptp(mesh.te, axis=1) / ARCSEC, peak_to_peak / ARCSEC
    worst = int(swings.argmax())
    give = float(np.abs(mesh.unloaded - mesh.te[worst]).mean()) / ARCSEC
    if np.isnan(unloaded) or not whole_cycle(pair, mesh.phi1) or swings[worst] <= max(unloaded, UNEVEN * give):
        return []
    return [
        f"at {1e-3 * mesh.torque[worst]:g} Nm the transmission error swings by {swings[worst]:.3g} arcsec, without load by "
        f"{rounded(unloaded, 3):g}: reliefs or a crowning as deep as the teeth give way would even it"
    ]


def _warnings(pair: GearPair, mesh: LoadedMesh, unloaded: float) -> list[str]:
    found = []
    edges = [(load.sharp & (load.force > 0.0)).any() for load in mesh.loads]
    if any(edges):
        least = float(mesh.torque[np.flatnonzero(edges)].min())
        found += _edge_warnings(pair, mesh, least)
    found += _error_warning(pair, mesh, unloaded)
    bodies = [member.name for member in pair.both if member.holes or member.keyway or member.hub]
    if bodies:
        found.append(
            f"{' and '.join(bodies)}: holes, keyway and hub beyond the face are left out of how bodies give way"
        )
    halves = [member.name for member in pair.both if member.mirrored is not None]
    if halves:
        found.append(
            f"{' and '.join(halves)}: both halves give way as solid gears of their own, without web and gap, and turn alike"
        )
    found += [
        f"{member.name}: a bar held at its back that goes on beyond its ends; next to them teeth give way more"
        for member in pair.both
        if member.tooth.course.drift is not None
    ]
    return found
