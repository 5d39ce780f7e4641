"""Loaded contact of a pair over a mesh cycle: load sharing, transmission error, pressures, stiffness, root stress."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from gearmesh.allowed import Allowed
from gearmesh.answers.contact.figures import shown_edge
from gearmesh.answers.load.figures import (
    FilletFigures,
    LoadedFigures,
    LoadedPosition,
    LoadedTotals,
    MemberDisplacement,
    MeshShareFigures,
    MeshShareTotals,
    ToothPairFigures,
    ToothPairPosition,
    stroke,
)
from gearmesh.answers.load.members import held_by_rim, materials_of, mounts_around, mounts_of
from gearmesh.answers.result import Result, RunTime, columns, header
from gearmesh.answers.tables import Listing, csv_text, round_to
from gearmesh.contact.engagement.cycle import Cycle
from gearmesh.contact.hertz import contact_modulus
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, Status
from gearmesh.figures import Content, Entry, Figure, Summary, flat
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, largest_known
from gearmesh.loaded.compliance.compliance import FlankCompliance
from gearmesh.loaded.compliance.twist import twist_compliance
from gearmesh.loaded.edges import EdgeLoad, edge_loads, load_along_face
from gearmesh.loaded.mounts import FlexibleMount
from gearmesh.loaded.sharing import (
    LOAD_LEVELS,
    Level,
    LoadedMesh,
    MeshShare,
    PairLoad,
    Reference,
    SecondMesh,
    compliances,
    loaded_mesh,
    whole_cycle,
)
from gearmesh.mesh.hexahedra.hexahedra import whole_depth
from gearmesh.progress import listening
from gearmesh.records import dataclass
from gearmesh.systems.system import NominalStresses, system_of
from gearmesh.teeth.blank.features import BodyFeatures
from gearmesh.teeth.gear_train import GearPair

if TYPE_CHECKING:
    from gearmesh.answers.load.tribology import PitchPoint, Tribology

#: positions in a pitch
POSITIONS_PER_PITCH = 21
#: slices of the common face in which the load is summed for the face load factor
FACE_SLICES = 20
#: least face width over whole depth that counts for the face load factor of root stress [ISO 6336-1]
LEAST_WIDTH_DEPTHS = 3.0
#: warning of gears with pitch deviations
UNEQUAL_PAIRS_WARNING = (
    "pitch deviations: every tooth pair is loaded differently; figures are for those in contact at these positions, with their "
    "flanks where they are, and for others with --phi1"
)
#: warning of the quick level
QUICK_WARNING = (
    "level quick: coarse elements and cells, no estimates of errors; transmission error and load shares are within 3 % of level "
    "full, pressures within 6 %, stresses in fillets within 15 %"
)
#: reason to refuse elastic shafts and bearings of meshes that share a torque
SHARED_MOUNTS_REASON = "members of several meshes that share a torque are held rigidly"
#: largest acute angle between axes that counts as an assembly error of parallel axes
MAX_PARALLEL_ANGLE_RAD = 0.01


@dataclass(frozen=True, repr=False)
class LoadedContact(Result):
    """Gears of a pair under torques on the pinion, position by position."""

    #: the design
    design: Design
    #: the pair
    pair: GearPair
    #: the solved loaded mesh
    mesh: LoadedMesh
    #: warnings, one line each
    warnings: tuple[str, ...]
    #: run time, s
    seconds: float
    #: whole mesh cycle without load; None if not given
    cycle: Cycle | None = None
    #: the same mesh without pitch deviations; None if there are none, and if it was not solved
    even: LoadedMesh | None = None

    @property
    def unloaded_peak_to_peak(self) -> float:
        """Peak to peak of the transmission error without load over the whole mesh cycle, rad, as in `Contact`.

        NaN if it is unknown.
        """
        return np.nan if self.cycle is None else self.cycle.peak_to_peak

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, CSV_SUFFIX)

    @property
    def headline(self) -> str:
        worst = largest_known(np.concatenate([load.peak for load in self.mesh.loads]))
        if np.isnan(worst):
            pressure = "contact on edges alone"
        else:
            total = max(self.totals, key=lambda total: np.nan_to_num(total.max_pressure))
            pressure = f"pressure up to {worst:.4g} MPa at phi1 = {total.max_pressure_phi1:.4g} deg"
            if any(load.sharp.any() for load in self.mesh.loads):
                pressure += ", without that of edge contact"
        return f"{len(self.mesh.torque)} torques at {len(self.mesh.phi1)} positions, {pressure}"

    @cached_property
    def rows(self) -> list[LoadedPosition]:
        """Figures, one row per torque and position; pair k has at phi1 the state that pair 0 has k pitches earlier."""
        return [self._row(k, p) for k in range(len(self.mesh.torque)) for p in range(len(self.mesh.phi1))]

    def _row(self, torque: int, position: int) -> LoadedPosition:
        mesh, load, at = self.mesh, self.mesh.loads[torque], (torque, position)
        loaded_pairs = np.flatnonzero((load.position == position) & (load.force > 0.0))
        # where other meshes carry the torque, no tooth pair of this one is loaded
        idle = not loaded_pairs.size
        worst = 0 if idle else loaded_pairs[np.nan_to_num(load.peak[loaded_pairs]).argmax()]
        peak, peak_error = (np.nan, np.nan) if idle else (float(load.peak[worst]), 100.0 * float(load.error[worst]))
        te, unloaded = (float(error - mesh.unloaded[0]) for error in (mesh.te[at], mesh.unloaded[position]))
        output, gear_torque = self.pair.output, float(mesh.gear_torque[at])
        return LoadedPosition(
            torque=1e-3 * float(mesh.torque[torque]),
            phi1=float(np.degrees(mesh.phi1[position]).round(12)),
            te=te / ARCSEC,
            unloaded_te=unloaded / ARCSEC,
            rotation=float(mesh.rotation[at]) / ARCSEC,
            gear_torque=1e-3 * gear_torque,
            te_um=output.way(1e3 * te),
            unloaded_te_um=output.way(1e3 * unloaded),
            gear_force=output.force(gear_torque),
            stiffness=1e-3 * float(mesh.stiffness[at]) * ARCSEC,
            tangent_stiffness=1e-3 * float(mesh.tangent[at]) * ARCSEC,
            tangent_stiffness_per_width=None if self._width is None else float(mesh.tangent[at]) / self._width,
            peak_pressure=peak,
            peak_pressure_error=peak_error,
            peak_pressure_pair=int(load.number[worst]) if np.isfinite(peak) else None,
            peak_pressure_point=[np.nan] * 3 if idle else load.place[worst].tolist(),
            edge_contact=bool(load.edge_contact[loaded_pairs].any()),
            fillets=self._fillets(
                mesh.bending[at],
                mesh.root_error[at],
                mesh.root_stress[at],
                mesh.tangent_stress[at],
                mesh.contact_stress[at],
            ),
            root_stress_point={name: mesh.root_place[at][n].tolist() for n, name in enumerate(self.pair.members)},
            displacements=self._displacements(at),
            meshes={
                name: MeshShareFigures(float(share.moment[at] / mesh.torque[torque]), float(share.peak[at]))
                for name, share in self._shares
            },
            tooth_pairs=tuple(self._tooth_pair(torque, m) for m in loaded_pairs),
            residual=float(mesh.residual[at]),
            status=Status(int(mesh.status[at])).name.lower(),
        )

    @property
    def _shares(self) -> list[tuple[str, MeshShare]]:
        """Meshes that share the torque, by their names in the order of the gear set; none of a single mesh."""
        names = [self.pair.name, *(fellow.pair.name for fellow in self.pair.fellows)]
        return sorted(zip(names, self.mesh.shares, strict=False), key=lambda item: item[0])

    def _tooth_pair(self, torque: int, m: np.intp) -> ToothPairFigures:
        """Return the figures of the m-th tooth pair under a torque."""
        load = self.mesh.loads[torque]
        return ToothPairFigures(
            pair=int(load.number[m]),
            load_share=float(load.moment[m] / self.mesh.torque[torque]),
            half=self._half(load, m),
            force=float(load.force[m]),
            peak_pressure=float(load.peak[m]),
            peak_pressure_error=100.0 * float(load.error[m]),
            on_edge=bool(load.on_edge[m]),
            edge_contact=bool(load.edge_contact[m]),
            bending_stress=self._bending(load, m),
        )

    def _half(self, load: PairLoad, m: np.intp) -> int | None:
        """Return the half, from 1, of the m-th tooth pair; None if the members have only one half."""
        return self.pair.pinion.halves[int(load.half[m])].number

    @cached_property
    def _width(self) -> float | None:
        """Stiffness in N mm/rad of the pinion that equals 1 N/(mm um) at its base circle per mm of common face [ISO 6336-1].

        It is measured along the transverse line of action. None unless the axes are parallel, except for assembly errors.
        """
        if self._face is None:
            return None
        low, high = self._face
        return 1e3 * float(self.lever**2 * (high - low) * len(self.pair.halves))

    def _fillets(
        self, bending: Array, error: Array, largest: Array, at_tangent: Array, contact: Array
    ) -> dict[str, FilletFigures]:
        """Return stresses (2,), MPa, in the fillets of both members.

        They are the bending stress with an estimate of its error, and the stress of the contact's own field. The others
        are the largest stress in the fillet and the stress at the tangents of 30 deg.
        """
        return {
            name: FilletFigures(
                float(bending[n]), 100.0 * float(error[n]), float(largest[n]), float(at_tangent[n]), float(contact[n])
            )
            for n, name in enumerate(self.pair.members)
        }

    def _bending(self, load: PairLoad, pair: np.intp) -> dict[str, float]:
        """Return the bending stress, MPa, in the fillets of the teeth of a pair.

        NaN if all of the stress is the contact's own field.
        """
        nominal = load.roots.nominal[pair]
        return {name: float(nominal[n]) for n, name in enumerate(self.pair.members)}

    @cached_property
    def tooth_pair(self) -> list[ToothPairPosition]:
        """Figures of one tooth pair over its engagement, one row per torque and rotation of the pinion.

        Other pairs at phi1 stand for this pair a whole number of pitches away. `peak_pressure` is NaN in edge contact.
        """
        rows = []
        for torque, load in zip(self.mesh.torque, self.mesh.loads, strict=True):
            phase = self.mesh.phi1[load.position] - self.pair.pitch * load.number
            rows += [
                ToothPairPosition(
                    torque=1e-3 * float(torque),
                    phi1=float(np.degrees(phase[m]).round(12)),
                    half=self._half(load, m),
                    load_share=float(load.moment[m] / torque),
                    force=float(load.force[m]),
                    peak_pressure=float(load.peak[m]),
                    peak_pressure_error=100.0 * float(load.error[m]),
                    edge_contact=bool(load.edge_contact[m]),
                    bending_stress=self._bending(load, m),
                )
                for m in np.lexsort((phase, load.half))
                if load.force[m] > 0.0
            ]
        return rows

    def _displacements(self, at: tuple[int, int]) -> dict[str, MemberDisplacement]:
        """Return the displacements of members on elastic mounts; they are part of the transmission error."""
        return {
            name: MemberDisplacement(
                (1e3 * self.mesh.displacement[at][n][:3]).tolist(),
                (self.mesh.displacement[at][n][3:] / ARCSEC).tolist(),
            )
            for n, name in enumerate(self.pair.members)
            if self.mesh.displacement[..., n, :].any()
        }

    def share_at(self, rotation: Array, torque: int = 0) -> Array:
        """Share of one of the torques on tooth pair 0, linear between positions.

        If positions divide a pitch equally, the shares of all pairs sum to 1 everywhere.

        Parameters
        ----------
        rotation : ndarray, (P,)
            Rotation of the pinion, rad.
        torque : int
            Number of the torque.

        Returns
        -------
        ndarray, (P,)
            From 0 to 1; 0 without load.

        Examples
        --------
        >>> gears.loaded_contact(20.0, [0.0], level="quick").share_at(np.array([0.0])).shape
        (1,)
        """
        load = self.mesh.loads[torque]
        number = np.arange(load.number.min() - 1, load.number.max() + 2)
        share = np.zeros((len(self.mesh.phi1), len(number)))
        np.add.at(share, (load.position, load.number - number[0]), load.moment / self.mesh.torque[torque])
        pair_rotation = (self.mesh.phi1[:, None] - self.pair.pitch * number).ravel()
        order = np.argsort(pair_rotation)
        shares: Array = np.interp(rotation, pair_rotation[order], share.ravel()[order], 0.0, 0.0)
        return shares

    def tribology(
        self,
        speed: float | None = None,
        *,
        friction: float | None = None,
        viscosity: float | None = None,
        pressure_viscosity: float | None = None,
        roughness: float | None = None,
    ) -> Tribology:
        """Load, curvature, sliding and rolling along every loaded contact; efficiency, flash temperature and film.

        Parameters
        ----------
        speed : float, optional
            Rpm of the pinion: adds velocities in m/s, and pressure times velocity.
        friction : float, optional
            Coefficient of friction: adds the efficiency, with a speed friction power and flash temperature of steel.
        viscosity : float, optional
            Dynamic viscosity, mPa s, of the oil at the bulk temperature of the teeth: adds the film thickness.
        pressure_viscosity : float, optional
            Its pressure-viscosity coefficient, 1/GPa.
        roughness : float, optional
            Arithmetic mean roughness Ra of both flanks, um, on parallel axes: with speed and viscosity adds the mean coefficient
            of friction of ISO/TR 14179-2 for mineral oil, and the efficiency with it.

        Returns
        -------
        Tribology
            One row per place along each contact, by torque, position and tooth pair.

        Raises
        ------
        ArgumentError
            For values that cannot be, and for an oil without a speed.

        Examples
        --------
        >>> tribology = gears.loaded_contact(20.0, [0.0], level="quick").tribology(1500, friction=0.05)
        >>> 98.0 < tribology.totals[0].efficiency < 100.0
        True
        """
        from gearmesh.answers.load.tribology import RunningConditions, Tribology

        running = RunningConditions(speed, friction, viscosity, pressure_viscosity, roughness)
        return Tribology(self.design, self.pair, self.mesh, self.warnings, running, self._pitch_point)

    @property
    def _pitch_point(self) -> PitchPoint | None:
        """The pitch point; None unless the axes are parallel and both members turn."""
        from gearmesh.answers.load.tribology import PitchPoint

        first, second = self.pair.mounts
        # speed of the gear over that of the pinion, below 0 if they turn in opposite senses, 0 if the gear slides
        ratio = self.pair.ratio * float(first.spin @ second.spin)
        if self._face is None or ratio == 0.0:
            return None
        low, high = self._face
        distance = float(np.linalg.norm(np.cross(second.origin - first.origin, first.axis)))
        radius = distance * abs(ratio) / abs(1.0 - ratio)
        # radii of curvature in the transverse section are the distances from both base circles along the line of action
        cosine = _base_cosine(self.pair, self.mesh.loads[-1])
        reach = np.sqrt(radius**2 - self.lever**2)
        curvature = cosine / reach * abs(1.0 - ratio)
        return PitchPoint(self.lever, radius, (high - low) * self.pair.own_halves, float(curvature))

    @cached_property
    def totals(self) -> list[LoadedTotals]:
        """Figures over all positions, one row per torque.

        The peak to peak of the loaded transmission error is over the positions, of the unloaded error over the whole
        mesh cycle. The tangent stiffness is a mean. On parallel axes it is also given per mm of face, and for the teeth
        alone as c_gamma and c' of ISO 6336-1. All other figures are maxima over the positions.
        """
        return [self._total(k, load) for k, load in enumerate(self.mesh.loads)]

    def _total(self, torque: int, load: PairLoad) -> LoadedTotals:
        mesh = self.mesh
        pair_counts = self._carrying(load)
        worst = np.nan_to_num(load.peak).argmax()
        phi1_of_worst = self.mesh.phi1[load.position[worst]] if np.isfinite(load.peak[worst]) else np.nan
        face_load_factor = self._face_load_factor(load)
        return LoadedTotals(
            torque=1e-3 * float(mesh.torque[torque]),
            te_peak_to_peak=float(mesh.te_peak_to_peak[torque]) / ARCSEC,
            unloaded_te_peak_to_peak=self.unloaded_peak_to_peak / ARCSEC,
            mean_tooth_pairs=float(pair_counts.mean()),
            tooth_pairs=[int(pair_counts.min()), int(pair_counts.max())],
            max_pressure=largest_known(load.peak),
            max_pressure_error=100.0 * float(load.error[worst]),
            max_pressure_phi1=float(np.degrees(phi1_of_worst).round(12)),
            max_pair_force=float(load.force.max()),
            gear_torque_ripple=100.0 * float(np.ptp(mesh.gear_torque[torque]) / abs(mesh.gear_torque[torque].mean())),
            mean_tangent_stiffness=1e-3 * float(mesh.tangent[torque].mean()) * ARCSEC,
            **self._per_width(torque, load),
            k_h_beta=face_load_factor,
            k_f_beta=None if face_load_factor is None else face_load_factor**self._face_exponent,
            k_h_alpha=None if self.even is None else float(load.force.max() / self.even.loads[torque].force.max()),
            fillets=self.largest_in_fillets(torque),
            nominal_contact_stress=self._nominal_contact(torque),
            nominal_root_stress=self._nominal_root(torque),
            meshes={
                name: MeshShareTotals(
                    float(share.moment[torque].min() / mesh.torque[torque]),
                    float(share.moment[torque].max() / mesh.torque[torque]),
                    largest_known(share.peak[torque]),
                    float(np.nanmax(share.force[torque], initial=0.0)),
                )
                for name, share in self._shares
            },
            on_edge=bool((load.on_edge & (load.force > 0.0)).any()),
            edge_contact=bool(load.edge_contact.any()),
            edge_load_share={
                edge_load.edge: float(edge_load.moment.max() / mesh.torque[torque])
                for edge_load in edge_loads(self.pair, load, len(mesh.phi1))
                if edge_load.edge
            },
        )

    @cached_property
    def _nominal(self) -> NominalStresses | None:
        """Nominal stresses of a standard; None of kinds without them."""
        of_kind = system_of(self.design).nominal
        return None if of_kind is None else of_kind(self.design, self.pair)

    def _nominal_contact(self, torque: int) -> float | None:
        """Return the nominal contact stress, MPa, under a torque; None if there is none."""
        if self._nominal is None:
            return None
        modulus = contact_modulus(*materials_of(self.design, self.pair))
        return self._nominal.contact_stress(float(self.mesh.torque[torque]), modulus)

    def _nominal_root(self, torque: int) -> dict[str, float]:
        """Return the nominal root stresses, MPa, of the members that have them under a torque."""
        if self._nominal is None:
            return {}
        stresses = self._nominal.root_stress(float(self.mesh.torque[torque]))
        return {name: value for name, value in zip(self.pair.members, stresses, strict=True) if np.isfinite(value)}

    def _per_width(self, torque: int, load: PairLoad) -> dict[str, float | None]:
        """Return the stiffness per mm of face under a torque: of the mesh, of the teeth, and the largest of a tooth
        pair.
        """
        names = "mean_tangent_stiffness_per_width", "c_gamma", "c_prime"
        tangent, twist = self.mesh.tangent[torque], self.twist
        if self._width is None or twist is None:
            return dict.fromkeys(names)
        bent = self.mesh.rotation[torque] - twist * self.mesh.torque[torque]
        # a tooth pair of double helical gears is one in each half: two stiffnesses beside each other
        one_pair = len(self.pair.halves) * (load.moment / bent[load.position]).max()
        values = tangent.mean(), (1.0 / (1.0 / tangent - twist)).mean(), one_pair
        return {name: float(value) / self._width for name, value in zip(names, values, strict=True)}

    @cached_property
    def _face(self) -> tuple[float, float] | None:
        """Ends of the common face of the first halves, mm along the pinion's axis, fixed frame.

        None unless the axes are parallel.
        """
        if not _has_parallel_axes(self.pair):
            return None
        # rotations without load: the teeth 0 face each other
        phi1 = float(self.mesh.phi1[0])
        return _common_face(self.pair, (phi1, float(self.mesh.unloaded[0]) + self.pair.ratio * phi1))

    def _face_load_factor(self, load: PairLoad) -> float | None:
        """Return K_Hbeta [ISO 6336-1] of the load of all tooth pairs, as a mean over the positions.

        None unless the axes are parallel, and if the positions are not a whole cycle.
        """
        if self._face is None or not whole_cycle(self.pair, self.mesh.phi1):
            return None
        loads = load_along_face(load, self.pair.pinion.mount.axis, np.linspace(*self._face, FACE_SLICES + 1))
        return float(loads.max() / loads.mean())

    @cached_property
    def _face_exponent(self) -> float:
        """Exponent N_F of K_Fbeta over K_Hbeta, from face widths of one half and whole depths of both members."""
        widths, depths = [], []
        for member, side in zip(self.pair.both, self.pair.flanks, strict=True):
            ends = member.tooth.flank_grid(side, np.array([0.5]), np.array([0.0, 1.0])).points[0, :, 2]
            widths.append(abs(float(ends[1] - ends[0])))
            depths.append(whole_depth(member.one_tooth, np.array([0.0, 0.5, 1.0])))
        return face_exponent(widths, depths)

    @cached_property
    def lever(self) -> float:
        """Lever, mm, of the line of action about the pinion's axis: on parallel axes the base radius, otherwise the mean
        lever of the normal force."""
        return _lever(self.pair, self.mesh.loads[-1])

    @cached_property
    def twist(self) -> float | None:
        """Rotation of the pinion over its torque, rad/(N mm), by the twist of both bodies; an idler does not twist.

        None unless the axes are parallel, and for meshes that share the torque.
        """
        if not _has_parallel_axes(self.pair) or self.pair.fellows:
            return None
        materials, held = materials_of(self.design, self.pair), held_by_rim(self.design, self.pair)
        first, second = (
            0.0 if member.idler else twist_compliance(member.one_tooth, material, by_rim=by_rim)
            for member, material, by_rim in zip(self.pair.both, materials, held, strict=True)
        )
        # halves of double helical gears twist beside each other, each under its part of the torque
        return (first + second / self.pair.ratio**2) / len(self.pair.halves)

    def _in_fillets(self) -> tuple[Array, ...]:
        """Return figures (T, P, 2) in the fillets of both members.

        The error belongs to the largest bending stress of its torque.
        """
        mesh = self.mesh
        worst = np.nan_to_num(mesh.bending, nan=-np.inf).argmax(axis=1)[:, None]
        error = np.take_along_axis(mesh.root_error, worst, axis=1)
        return mesh.bending, error, mesh.root_stress, mesh.tangent_stress, mesh.contact_stress

    def largest_in_fillets(self, torque: int) -> dict[str, FilletFigures]:
        """Largest stresses in the fillets over all positions.

        Parameters
        ----------
        torque : int
            Number of the torque.

        Returns
        -------
        dict
            Stresses by members.

        Examples
        --------
        >>> list(gears.loaded_contact(20.0, [0.0], level="quick").largest_in_fillets(0))
        ['pinion', 'gear']
        """
        return self._fillets(*(_most(in_fillet[torque]) for in_fillet in self._in_fillets()))

    def tooth_pairs_at(self, torque: int) -> NDArray[np.intp]:
        """Numbers of loaded tooth pairs.

        Parameters
        ----------
        torque : int
            Number of the torque.

        Returns
        -------
        ndarray, (P,)
            One per position.

        Examples
        --------
        >>> gears.loaded_contact(20.0, [0.0], level="quick").tooth_pairs_at(0).tolist()
        [2]
        """
        return self._carrying(self.mesh.loads[torque])

    def _carrying(self, load: PairLoad) -> NDArray[np.intp]:
        """Return the number of loaded tooth pairs (P,)."""
        loaded_pairs = np.unique(np.stack((load.position, load.number))[:, load.force > 0.0], axis=1)
        return np.bincount(loaded_pairs[0], minlength=len(self.mesh.phi1))

    @property
    def complaints(self) -> list[str]:
        """Positions that did not converge, in one line."""
        wrong = self.mesh.status != Status.CONVERGED
        if not wrong.any():
            return []
        torque, position = (int(numbers[0]) for numbers in np.nonzero(wrong))
        return [
            f"{int(wrong.sum())} of {wrong.size} positions and torques did not converge, the first at "
            f"{1e-3 * self.mesh.torque[torque]:g} Nm, phi1 = {np.degrees(self.mesh.phi1[position]):.5g} deg: their figures are "
            "unreliable; try a smaller torque or neighbouring positions"
        ]

    @property
    def listings(self) -> list[Listing]:
        names = ["Nm", "phi1 deg", "te arcsec", "pressure MPa", "of pair", "on edge", "load share"]
        bent = [f"{name} MPa" for name in self.pair.members]
        heads = ["Nm", "phi1 deg", "share %", "pressure MPa", *bent]
        return [
            *self.overview,
            Listing("Positions", names, [_cells(row) for row in self.rows]),
            Listing(
                "One tooth pair: pressure, bending stress",
                heads,
                [_pair_cells(position) for position in self.tooth_pair],
            ),
        ]

    @property
    def overview(self) -> list[Listing]:
        """Tables of the figures per torque."""
        over = "the mesh cycle" if whole_cycle(self.pair, self.mesh.phi1) else f"positions: {len(self.mesh.phi1)}"
        first, second = self.pair.members
        heads = ["Nm", "te p-p arcsec", "unloaded", "pairs", "MPa", "pair N", f"{first} root", f"{second} root"]
        totals = self.totals
        edges = [
            [total.torque, shown_edge(edge), round_to(100.0 * share, 2)]
            for total in totals
            for edge, share in total.edge_load_share.items()
        ]
        return [
            Listing(f"Over {over}", heads, [_total_cells(total) for total in totals]),
            Listing(
                "Largest contact pressure, away from singular edges",
                ["Nm", "MPa", "error %", "at phi1 deg", "edge contact"],
                [_pressure_cells(total, load) for total, load in zip(totals, self.mesh.loads, strict=True)],
            ),
            Listing(
                "Stress in the fillets, MPa",
                _FILLET_COLUMNS,
                [_fillet_cells(total, name) for total in totals for name in self.pair.members],
            ),
            *self._shares_listing(),
            *self._nominal_listing(),
            *([Listing("Most load next to edges", ["Nm", "edge", "% of the torque"], edges)] if edges else []),
        ]

    def _shares_listing(self) -> list[Listing]:
        """Return the table of meshes that share the torque; empty of a single mesh."""
        rows = [
            [
                total.torque,
                name,
                round_to(100.0 * mesh.least_share, 2),
                round_to(100.0 * mesh.largest_share, 2),
                round_to(mesh.max_pressure, 3),
                round_to(mesh.max_pair_force, 3),
            ]
            for total in self.totals
            for name, mesh in total.meshes.items()
        ]
        heads = ["Nm", "mesh", "least share %", "largest share %", "MPa", "pair N"]
        return [Listing("Meshes that share the torque", heads, rows)] if rows else []

    def _nominal_listing(self) -> list[Listing]:
        """Return the table of the nominal stresses; empty of kinds without them."""
        if self._nominal is None:
            return []
        rows = [
            [
                total.torque,
                round_to(total.nominal_contact_stress or np.nan, 4),
                *(round_to(total.nominal_root_stress.get(name, np.nan), 4) for name in self.pair.members),
            ]
            for total in self.totals
        ]
        heads = ["Nm", "contact", *(f"{name} root" for name in self.pair.members)]
        return [Listing("Nominal stresses of ISO 6336-2 and -3 without load factors, MPa", heads, rows)]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.row for row in self.rows])

    def csv(self) -> str:
        """The positions as a table.

        Returns
        -------
        str
            CSV, one row per torque and position, with flattened JSON keys as columns, without tooth pairs that are never loaded.

        Examples
        --------
        >>> gears.loaded_contact(20.0, [0.0], level="quick").csv().splitlines()[0].split(",")[:2]
        ['torque_nm', 'phi1_deg']
        """
        rows = self.rows
        known = {
            tooth_pair.column: dict.fromkeys(tooth_pair.flat, np.nan) for row in rows for tooth_pair in row.tooth_pairs
        }
        table = []
        for row in rows:
            pairs = known | {tooth_pair.column: tooth_pair.flat for tooth_pair in row.tooth_pairs}
            pair_columns = Entry(_TOOTH_PAIR_COLUMNS, {name: pairs[name] for name in sorted(known)})
            table.append(flat((*row.entries, pair_columns)))
        return csv_text(table)

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        whole_text(target, self.csv())

    @property
    def figures(self) -> LoadedFigures:
        """All figures of the document."""
        return LoadedFigures(self.totals, self.rows, self.tooth_pair)

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "warnings": self.warnings, **Summary(self.figures)}

    @property
    def run_time(self) -> RunTime:
        """Run time of the whole answer."""
        return RunTime(self.seconds)


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
    level: Level = "full",
    reference: Reference | None = None,
) -> LoadedContact:
    """Return a pair under torques (Nm) on the pinion at its rotations phi1 (P,), rad; by default POSITIONS_PER_PITCH
    positions.

    - `cycle`: the whole mesh cycle without load; None leaves it out of the report.
    - `bodies`: compliances of both members, if known; they do not depend on the mounting.
    - `mounts`: elastic shafts and bearings, by names of members, replacing those of the design.
    - `level`: model of bodies and contacts, "full" or "quick".
    - `reference`: solved mesh of a nearly equal design, of the same level, on rigid mounts.

    Raises ArgumentError for torques that are not above 0, for eccentric members, and for mounts of unknown members.
    """
    started = time.perf_counter()
    refuse_eccentric(pair)
    places = pair.pitch * np.arange(POSITIONS_PER_PITCH) / POSITIONS_PER_PITCH if phi1 is None else phi1
    torques = 1e3 * np.array(required_torques(torque))
    if unknown := [name for name in mounts or {} if name not in pair.members]:
        raise ArgumentError("mounts", unknown[0], must_be=f"{' or '.join(pair.members)}")
    given = {**mounts_of(design, pair), **(mounts or {})}
    if given and pair.fellows:
        raise ArgumentError("mounts", next(iter(given)), reason=SHARED_MOUNTS_REASON, allowed="left out")
    if bodies is None:
        progress(0.0, f"compliance of the {' and the '.join(pair.members)}")
        bodies = bodies_of(design, pair, level)
    doing = f"loaded contact, torques: {torques.size}, positions: {len(places)}"
    progress(0.2, doing)
    flexible = mounts_around(pair, given)
    second = _second_mesh(design, pair, given, level)
    # pitch deviations count against the same mesh without them; of meshes that share a torque others are uneven, too
    pairs = [pair, pair.even] if pair.uneven and not pair.fellows and reference is None else [pair]
    with listening(lambda done: progress(0.2 + 0.8 * done, doing)):
        mesh, *others = (
            loaded_mesh(
                each,
                places,
                torques,
                bodies,
                materials_of(design, pair),
                flexible=flexible,
                level=level,
                reference=reference,
                second=second,
            )
            for each in pairs
        )
    unloaded = np.nan if cycle is None else cycle.peak_to_peak
    if level == "quick":
        warnings = (*warnings, QUICK_WARNING)
    if pair.uneven:
        warnings = (*warnings, UNEQUAL_PAIRS_WARNING)
    lines = (*warnings, *_warnings(pair, mesh, unloaded))
    return LoadedContact(design, pair, mesh, lines, time.perf_counter() - started, cycle, *others)


def _second_mesh(
    design: Design, pair: GearPair, mounts: Mapping[str, FlexibleMount], level: Level
) -> SecondMesh | None:
    """Return the other mesh of the pair's planet if its pin is elastic, with the `mounts` of the pair and those of the
    design."""
    other = pair.other_mesh
    if other is None or other.planet not in mounts:
        return None
    beside = replace(other.pair, around=pair.around)
    refuse_eccentric(beside)
    given = {**mounts_of(design, beside), other.planet: mounts[other.planet]}
    shared = pair.index(other.planet)
    bodies = bodies_of(design, beside, level)
    return SecondMesh(beside, shared, bodies, materials_of(design, beside), mounts_around(beside, given))


def refuse_eccentric(pair: GearPair) -> None:
    """Raise ArgumentError for a pair with an eccentric member."""
    for member in pair.both:
        if member.mount.eccentricity != (0.0, 0.0):
            raise ArgumentError(
                "pair",
                pair.name,
                reason=f"the {member.name} is eccentric, so every tooth pair is loaded differently; loaded contact needs "
                "an eccentricity of 0",
            )


#: smallest and largest torque: below, rounding exceeds the forces of mesh points; no gear has a larger torque
TORQUE_RANGE_NM = (1e-9, 1e12)


def required_torques(torque: Sequence[float]) -> list[float]:
    """Return torques, Nm. Raises ArgumentError unless there is at least one and all are above 0."""
    wrong = [value for value in torque if not 0.0 < value < np.inf]
    if wrong or not torque:
        raise ArgumentError(
            "torque", f"{wrong[0]:g}" if wrong else "[]", unit="Nm", must_be="one or more finite numbers above 0"
        )
    beyond = [value for value in torque if not TORQUE_RANGE_NM[0] <= value <= TORQUE_RANGE_NM[1]]
    if beyond:
        raise ArgumentError("torque", beyond[0], unit="Nm", allowed=Allowed.from_to(*TORQUE_RANGE_NM, "Nm"))
    return list(torque)


def required_level(level: str) -> Level:
    """Return a level of contact under load. Raises ArgumentError for another one."""
    if level not in LOAD_LEVELS:
        raise ArgumentError("level", level, allowed=" or ".join(LOAD_LEVELS))
    return cast("Level", level)


def bodies_of(design: Design, pair: GearPair, level: Level = "full") -> tuple[FlankCompliance, FlankCompliance]:
    """Return the compliances of both members of a pair of a design."""
    return compliances(pair, materials_of(design, pair), held_by_rim(design, pair), level)


#: columns of tooth pairs; their names begin with the number of the pair
_TOOTH_PAIR_COLUMNS = Figure("", "", "", "load on each tooth pair")


def _total_cells(total: LoadedTotals) -> list[float]:
    """Return a row of the table of torques."""
    run = total.torque, total.te_peak_to_peak, total.unloaded_te_peak_to_peak, total.mean_tooth_pairs
    bent = (fillet.bending_stress for fillet in total.fillets.values())
    return [round_to(value, 3) for value in (*run, total.max_pressure, total.max_pair_force, *bent)]


def _pressure_cells(total: LoadedTotals, load: PairLoad) -> list[Any]:
    """Return a row of the table of pressures."""
    figures = total.max_pressure, total.max_pressure_error, total.max_pressure_phi1
    return [total.torque, *(round_to(value, 4) for value in figures), "yes" if load.sharp.any() else "no"]


def _fillet_cells(total: LoadedTotals, member: str) -> list[Any]:
    """Return a row of the table of stresses in fillets."""
    fillet = total.fillets[member]
    figures = fillet.bending_stress, fillet.error, fillet.root_stress, fillet.contact_stress
    return [total.torque, member, *(round_to(value, 3) for value in figures)]


def _cells(row: LoadedPosition) -> list[Any]:
    """Return a row of the table of positions."""
    shares = " ".join(f"{tooth_pair.name}:{100.0 * tooth_pair.load_share:.0f}%" for tooth_pair in row.tooth_pairs)
    named = {tooth_pair.pair: tooth_pair.name for tooth_pair in row.tooth_pairs}
    edges = " ".join(tooth_pair.name for tooth_pair in row.tooth_pairs if tooth_pair.edge_contact)
    of = None if row.peak_pressure_pair is None else named[row.peak_pressure_pair]
    figures = row.torque, row.phi1, row.te, row.peak_pressure
    return [*(round_to(value, 3) for value in figures), of, edges or None, shares]


def _pair_cells(row: ToothPairPosition) -> list[Any]:
    """Return a row of the table of one tooth pair."""
    pressure = "edge" if row.edge_contact else round_to(row.peak_pressure, 3)
    share = f"{round_to(100.0 * row.load_share, 2)}{stroke(row.half)}"
    bending = (round_to(value, 3) for value in row.bending_stress.values())
    return [row.torque, round_to(row.phi1, 4), share, pressure, *bending]


#: columns of the table of stresses in fillets
_FILLET_COLUMNS = ["Nm", "member", "bending", "error %", "largest", "contact's own"]


def _most(values: Array) -> Array:
    """Return the largest (2,) of figures (P, 2); NaN if none is known."""
    return np.asarray(np.fmax.reduce(values, axis=0))


def _common_face(pair: GearPair, turns: tuple[float, float]) -> tuple[float, float]:
    """Return the ends of the common face of the first halves, mm along the pinion's axis, fixed frame.

    `turns`: rotations of both members, rad, at which their teeth 0 face each other.
    """
    axis = pair.pinion.mount.axis
    ends = [
        np.sort(member.mount.at(turn).point(member.tooth.flank_grid(side, [0.5], [0.0, 1.0]).points[0]) @ axis)
        for member, side, turn in zip(pair.both, pair.flanks, turns, strict=True)
    ]
    return float(max(low for low, _ in ends)), float(min(high for _, high in ends))


def face_exponent(widths: Sequence[float], depths: Sequence[float]) -> float:
    """Return N_F of K_Fbeta = K_Hbeta^N_F [ISO 6336-1], from face widths b and whole depths h of both members.

    A root bears its load over a length of about h along the face: narrow faces even it out. The smaller b/h counts, and
    3 at least.
    """
    ratio = max(LEAST_WIDTH_DEPTHS, min(b / h for b, h in zip(widths, depths, strict=True)))
    return ratio**2 / (1.0 + ratio + ratio**2)


def _has_parallel_axes(pair: GearPair) -> bool:
    """Return True if the axes of a pair are parallel, except for assembly errors."""
    return pair.acute_angle <= MAX_PARALLEL_ANGLE_RAD


def _lever(pair: GearPair, load: PairLoad) -> float:
    """Return the lever, mm, of the line of action about the pinion's axis.

    On parallel axes that is the transverse line of action, and the lever is the base radius. Otherwise it is the mean
    lever of the normal force. Contact on edges, whose normals are others, does not count.
    """
    grid = load.separation
    weight = load.pressure.sum(axis=2)
    weight = np.where(grid.edged, 0.0, weight) if weight[~grid.edged].any() else weight
    across = np.ones(())
    if _has_parallel_axes(pair):
        across = np.sqrt(1.0 - (grid.normal @ pair.pinion.mount.axis) ** 2)
    return float((weight * grid.levers[0] / across).sum() / weight.sum())


def _base_cosine(pair: GearPair, load: PairLoad) -> float:
    """Return the cosine of the base helix angle of a pair on parallel axes, from the normals of loaded flanks."""
    grid = load.separation
    pressed = (load.pressure.sum(axis=2) > 0.0) & ~grid.edged
    return float(np.median(np.sqrt(1.0 - (grid.normal[pressed] @ pair.pinion.mount.axis) ** 2)))


#: remedies that reduce the load next to an edge
EDGE_REMEDIES = {
    "tip": "tip relief",
    "toe": "crowning or end relief",
    "heel": "crowning or end relief",
}
#: limit of the edges that a warning lists
MAX_LISTED_EDGES = 2
#: peak to peak of the loaded transmission error, relative to the deflection, above which a warning is given
WARNED_ERROR_SHARE = 0.1


def _edge_warnings(pair: GearPair, mesh: LoadedMesh, least: float) -> list[str]:
    """Return warnings of edge contact: its smallest torque `least` (N mm), the edges with most load, and the remedy.

    The loads are those at the largest torque. A further warning reports a grid that is too short.
    """
    largest = int(mesh.torque.argmax())
    at, loads = f"at {1e-3 * mesh.torque[largest]:g} Nm", edge_loads(pair, mesh.loads[largest], len(mesh.phi1))

    def share(edge_load: EdgeLoad) -> str:
        return f"{100.0 * edge_load.moment.max() / mesh.torque[largest]:.2g} %"

    def place(edge: EdgeLoad) -> str:
        return f"(phi1 = {np.degrees(mesh.phi1[edge.moment.argmax()]):.4g} deg, {edge.width:.2g} mm wide)"

    beyond = [
        f"{at} the contact is longer than its grid, whose last cells have up to {share(edge)} of the torque {place(edge)}: "
        "the figures there are those of a shorter contact"
        for edge in loads
        if not edge.edge
    ]
    begun = f" from {1e-3 * least:g} Nm on" if least > mesh.torque.min() else ""
    limitless = f"edge contact{begun}: the peak pressure is singular at the edge and is not reported"
    edges = [edge for edge in loads if edge.edge]
    if not edges:
        return [limitless, *beyond]
    wanted = dict.fromkeys(
        EDGE_REMEDIES[name] for edge in edges if (name := edge.edge.rpartition("_")[2]) in EDGE_REMEDIES
    )
    remedy = f"; {' and '.join(wanted)} would reduce it" if wanted else ""
    most = ", ".join(f"{share(edge)} at {shown_edge(edge.edge)} {place(edge)}" for edge in edges[:MAX_LISTED_EDGES])
    more = f", less at {len(edges) - MAX_LISTED_EDGES} more" if len(edges) > MAX_LISTED_EDGES else ""
    return [f"{limitless}; {at} the cells next to the edge have, of the torque, up to {most}{more}{remedy}", *beyond]


def _error_warning(pair: GearPair, mesh: LoadedMesh, peak_to_peak: float) -> list[str]:
    """Return a warning if the transmission under a torque is less uniform than without load, by a good part of the
    deflection.

    `peak_to_peak` is the unloaded error over a whole mesh cycle, rad; NaN if unknown.
    """
    swings, unloaded = mesh.te_peak_to_peak / ARCSEC, peak_to_peak / ARCSEC
    worst = int(swings.argmax())
    deflection = float(np.abs(mesh.unloaded - mesh.te[worst]).mean()) / ARCSEC
    if (
        np.isnan(unloaded)
        or not whole_cycle(pair, mesh.phi1)
        or swings[worst] <= max(unloaded, WARNED_ERROR_SHARE * deflection)
    ):
        return []
    return [
        f"at {1e-3 * mesh.torque[worst]:g} Nm the transmission error is {swings[worst]:.3g} arcsec peak to peak, without load "
        f"{round_to(unloaded, 3):g}: reliefs or a crowning as deep as the deflection of the teeth would reduce it"
    ]


def _warnings(pair: GearPair, mesh: LoadedMesh, unloaded: float) -> list[str]:
    lines = []
    edges = [(load.sharp & (load.force > 0.0)).any() for load in mesh.loads]
    if any(edges):
        least = float(mesh.torque[np.flatnonzero(edges)].min())
        lines += _edge_warnings(pair, mesh, least)
    lines += _error_warning(pair, mesh, unloaded)
    bodies = [member.name for member in pair.both if member.features != BodyFeatures()]
    if bodies:
        lines.append(
            f"{' and '.join(bodies)}: the compliance of the body neglects holes, keyway or flats of the bore, and hub "
            "beyond the face"
        )
    halves = [member.name for member in pair.both if member.halves[1:]]
    if halves:
        lines.append(
            f"{' and '.join(halves)}: each half deflects as a separate solid gear, without web and gap; both rotate "
            f"by the same angle"
        )
    lines += [
        f"{member.name}: modelled as an endless bar held at its back; teeth near its ends deflect more than reported"
        for member in pair.both
        if member.tooth.joint.travel is not None
    ]
    return lines
