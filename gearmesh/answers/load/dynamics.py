"""Tables for rotor dynamics: static transmission error and mesh stiffness over a regular grid of torque and rotation.

Conventions:

- phi1 is the rotation of the pinion, on equal steps over one pitch or several; all repeats with the pitch.
- The line of action has one lever l on the pinion: on parallel axes the base radius (transverse line of action), otherwise the mean
  lever of the normal force. Its static transmission error is x = drive (phi1 N1/N2 - phi2) l N2/N1, with phi2 the rotation of the
  gear and drive +1 or -1. The pinion is ahead of the gear by x along the line of action; x >= 0 under load.
- A stiffness k along the line of action is that of rotation over l^2. Secant: torque over the rotation by the deflection. Tangent:
  change of torque over change of rotation. In a model with masses the force is F = k_secant (x - x_0), with x_0 the error without
  load. About a steady state it is F = T/l + k_tangent (x - x_T), with x_T the error under T.
- Stiffness of the teeth is without the twist of both bodies [ISO 6336-1]. The other stiffness has teeth, bodies and elastic mounts.
- A harmonic k of a curve f: f = mean + sum of A_k cos(2 pi k (phi1 - phi_0)/pitch + psi_k). Phases psi_k count from phi_0 = contact
  of tooth pair 0 at the pitch point, as R. G. Parker and J. Lin (2004) do, and from phi_0 = its first contact without load.
- The phase gamma of a mesh in a gear set is a share of the mesh period T, from 0 to 1. By this share its contact at the pitch point
  comes after that of the first mesh while phi1 grows. Alike meshes have f_n(t) = f_1(t - gamma_n T).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, csv_text, round_to
from gearmesh.contact.pitch_point import pitch_point_phi1
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair, GearTrain

NumberT = TypeVar("NumberT", float, Array)

#: harmonics of the mesh frequency; fewer if there are less than twice as many positions in a pitch
HARMONIC_COUNT = 10
#: largest difference between steps of the rotation, as a share of the pitch
STEP_TOLERANCE = 1e-6


@dataclass(frozen=True)
class StiffnessFigures(Figures):
    """Stiffness of a mesh, of rotation of the pinion and along the line of action."""

    secant: float = figure("secant mesh stiffness: torque over rotation of the pinion", "Nm/rad")
    tangent: float = figure("tangent mesh stiffness: change of torque over change of rotation", "Nm/rad")
    secant_line: float = figure("secant mesh stiffness along the line of action", "N/m", key="secant_n_per_m")
    tangent_line: float = figure("tangent mesh stiffness along the line of action", "N/m", key="tangent_n_per_m")


@dataclass(frozen=True)
class GridFigures(Figures):
    """A mesh under a torque at one position of the regular grid."""

    mesh: str = figure("members of the mesh")
    torque: float = figure("torque on the pinion of the mesh", "Nm", "T_1")
    phi1: float = figure("rotation of the pinion", "deg", "phi_1")
    phase_pitch_point: float | None = figure("share of the pitch since contact at the pitch point")
    phase_first_contact: float | None = figure("share of the pitch since the first contact of a tooth pair")
    te: float = figure(
        "loaded transmission error: phi2 - phi1 N1/N2, against the first position without load", "arcsec"
    )
    line_te: float = figure(
        "static transmission error along the line of action: pinion ahead of the gear, against the first position "
        "without load",
        "um",
        "x",
    )
    unloaded_line_te: float = figure("the same without load", "um", "x_0")
    mesh_stiffness: StiffnessFigures = figure("stiffness of teeth, bodies and elastic mounts")
    tooth_stiffness: StiffnessFigures | None = figure(
        "stiffness of the teeth without the twist of the bodies", optional=True
    )
    tooth_pairs: int = figure("loaded tooth pairs", whole=True)


@dataclass(frozen=True)
class PairStiffnessFigures(Figures):
    """One tooth pair alone over its engagement under a torque."""

    torque: float = figure("torque on the pinion of the mesh", "Nm", "T_1")
    phi1: float = figure("rotation of the pinion in the mesh cycle of tooth pair 0", "deg", "phi_1")
    half: int | None = figure("half of double helical gears", whole=True, optional=True)
    load_share: float = figure("share of the torque on the tooth pair", symbol="X")
    secant: float = figure("part of the torque on the tooth pair over the rotation of the pinion", "Nm/rad")
    secant_line: float = figure("the same along the line of action", "N/m", key="secant_n_per_m")


@dataclass(frozen=True)
class HarmonicPhases(Figures):
    """Phases of the harmonics of a curve over a pitch, from the first."""

    phases_pitch_point: list[float] | None = figure("phase of every harmonic, from contact at the pitch point", "deg")
    phases_first_contact: list[float] | None = figure("phase of every harmonic, from the first contact", "deg")


@dataclass(frozen=True)
class TeHarmonics(HarmonicPhases):
    """Harmonics of the static transmission error along the line of action."""

    mean: float = figure("mean over the pitch", "um")
    amplitudes: list[float] = figure("amplitude of every harmonic of the mesh frequency", "um")


@dataclass(frozen=True)
class StiffnessHarmonics(HarmonicPhases):
    """Harmonics of the tangent mesh stiffness along the line of action."""

    mean: float = figure("mean over the pitch", "N/m")
    amplitudes: list[float] = figure("amplitude of every harmonic of the mesh frequency", "N/m")


@dataclass(frozen=True)
class TorqueHarmonics(Figures):
    """Harmonics of a mesh under a torque."""

    torque: float = figure("torque on the pinion of the mesh", "Nm", "T_1")
    te: TeHarmonics = figure("static transmission error along the line of action", key="te")
    stiffness: StiffnessHarmonics = figure("tangent mesh stiffness along the line of action", key="stiffness")


@dataclass(frozen=True)
class MeshDynamicsFigures(Figures):
    """A mesh: its line of action, its phases, and its harmonics."""

    mesh: str = figure("members of the mesh")
    pitch: float = figure("pitch of the pinion: rotation after which all repeats", "deg")
    lever: float = figure(
        "lever of the line of action about the pinion's axis; on parallel axes the base radius", "mm", "r_b1"
    )
    gear_lever: float = figure("lever of the line of action about the gear's axis", "mm", "r_b2")
    pitch_point_phi1: float | None = figure(
        "rotation of the pinion at which tooth pair 0 touches at the pitch point, at mid face", "deg"
    )
    first_contact_phi1: float | None = figure(
        "rotation of the pinion at which the flanks of tooth pair 0 begin contact without load", "deg"
    )
    harmonics: list[TorqueHarmonics] = figure("harmonics of the mesh frequency, one per torque")
    tooth_pair: list[PairStiffnessFigures] = figure("one tooth pair alone, one per torque and position")


@dataclass(frozen=True)
class PhaseFigures(Figures):
    """Phase of a mesh in its gear set, against the first mesh."""

    mesh: str = figure("members of the mesh")
    phase: float | None = figure(
        "share of the mesh period by which contact at the pitch point comes after that of the first mesh",
        symbol="gamma",
    )


@dataclass(frozen=True)
class DynamicsFigures(Figures):
    """All tables for rotor dynamics."""

    meshes: list[MeshDynamicsFigures] = figure("different meshes")
    phases: list[PhaseFigures] = figure("phases of all meshes of the gear set")
    grid: list[GridFigures] = figure("transmission error and stiffness, one per mesh, torque and position")


@dataclass(frozen=True, repr=False)
class Dynamics(Result):
    """Static transmission error and mesh stiffness of the meshes of a gear set, over torque and rotation."""

    #: the design
    design: Design
    #: the gear set
    train: GearTrain
    #: solved loaded contact of every mesh that is reported, over whole pitches, by the numbers of the pairs
    loaded: Mapping[int, LoadedContact]
    #: warnings, one line each
    warnings: tuple[str, ...]

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, CSV_SUFFIX)

    @property
    def headline(self) -> str:
        named = ", ".join(loaded.pair.name for loaded in self.loaded.values())
        return f"transmission error and stiffness of {named}, {len(self.grid)} places of torque and rotation"

    @cached_property
    def _tables(self) -> list[_MeshTable]:
        """Tables of the meshes."""
        return [_MeshTable(loaded) for loaded in self.loaded.values()]

    @cached_property
    def grid(self) -> list[GridFigures]:
        """Transmission error and stiffness, by mesh, torque and position."""
        return [row for table in self._tables for row in table.grid()]

    @cached_property
    def meshes(self) -> list[MeshDynamicsFigures]:
        """Lines of action, phases and harmonics of the meshes."""
        return [table.figures() for table in self._tables]

    @cached_property
    def phases(self) -> list[PhaseFigures]:
        """Phases of all meshes of the gear set."""
        return mesh_phases(self.train)

    @property
    def listings(self) -> list[Listing]:
        heads = ["mesh", "Nm", "N/um", "1", "2", "3", "te um", "1", "2", "3"]
        rows = []
        for mesh in self.meshes:
            for harmonics in mesh.harmonics:
                stiffness = [harmonics.stiffness.mean, *harmonics.stiffness.amplitudes[:3]]
                te = [harmonics.te.mean, *harmonics.te.amplitudes[:3]]
                cells = [*(round_to(1e-6 * value, 2) for value in stiffness), *(round_to(value, 3) for value in te)]
                rows.append([mesh.mesh, harmonics.torque, *cells])
        title = "Along the line of action: mean and harmonics of tangent stiffness and static transmission error"
        phases = [[phase.mesh, None if phase.phase is None else round_to(phase.phase, 4)] for phase in self.phases]
        return [
            Listing(title, heads, rows),
            *([Listing("Phases of the meshes, shares of the period", ["mesh", "phase"], phases)] if phases[1:] else []),
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.flat for row in self.grid])

    def csv(self) -> str:
        """The grid as a table.

        Returns
        -------
        str
            CSV, one line per mesh, torque and position, with flattened JSON keys as columns.

        Examples
        --------
        >>> half_pitches = np.degrees(gears.pairs[0].pitch) * np.array([0.0, 0.5])
        >>> loaded = gears.loaded_contact(20.0, half_pitches, level="quick")
        >>> gears.dynamics(20.0, half_pitches, loaded=loaded).csv().splitlines()[0].split(",")[:3]
        ['mesh', 'torque_nm', 'phi1_deg']
        """
        return csv_text([row.flat for row in self.grid])

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        whole_text(target, self.csv())

    @property
    def sections(self) -> Mapping[str, Content]:
        tables = DynamicsFigures(self.meshes, self.phases, self.grid)
        return {**header(self.design), "warnings": self.warnings, **Summary(tables)}


class _MeshTable:
    """Tables of one mesh, from its loaded contact over whole pitches."""

    def __init__(self, loaded: LoadedContact) -> None:
        self.loaded, self.pair, self.mesh = loaded, loaded.pair, loaded.mesh
        self.places, self.pitches = whole_pitches(self.pair, self.mesh.phi1)
        self.lever = loaded.lever
        cycle = loaded.cycle
        begin = np.nan if cycle is None else cycle.surface[0]
        self.first_contact = cycle.engagement[0] if cycle is not None and np.isnan(begin) else begin
        self.pitch_point = pitch_point_phi1(self.pair)[0]
        reference = self.mesh.unloaded[0]
        to_line = -1e3 * self.pair.drive * self.lever / abs(self.pair.ratio)
        #: static transmission errors along the line of action, um
        self.line_te = to_line * (self.mesh.te - reference)
        self.unloaded_line_te = to_line * (self.mesh.unloaded - reference)

    def grid(self) -> list[GridFigures]:
        """Return the rows of the mesh on its grid."""
        mesh, pitch = self.mesh, self.pair.pitch
        te = (mesh.te - mesh.unloaded[0]) / ARCSEC
        twist = self.loaded.twist
        rows = []
        for k, torque in enumerate(mesh.torque.tolist()):
            pairs = self.loaded.tooth_pairs_at(k)
            for p in self.places:
                secant, tangent = float(mesh.stiffness[k, p]), float(mesh.tangent[k, p])
                teeth = None if twist is None else [1.0 / (1.0 / value - twist) for value in (secant, tangent)]
                rows.append(
                    GridFigures(
                        self.pair.name,
                        1e-3 * torque,
                        float(np.degrees(mesh.phi1[p]).round(12)),
                        _known((mesh.phi1[p] - self.pitch_point) / pitch % 1.0),
                        _known((mesh.phi1[p] - self.first_contact) / pitch % 1.0),
                        float(te[k, p]),
                        float(self.line_te[k, p]),
                        float(self.unloaded_line_te[p]),
                        self._stiffness(secant, tangent),
                        None if teeth is None else self._stiffness(*teeth),
                        int(pairs[p]),
                    )
                )
        return rows

    def _line(self, stiffness: NumberT) -> NumberT:
        """Return a stiffness of rotation, N mm/rad, along the line of action, N/m; one, or one per position."""
        return 1e3 * stiffness / self.lever**2

    def _stiffness(self, secant: float, tangent: float) -> StiffnessFigures:
        """Return the figures of stiffnesses of rotation, N mm/rad."""
        return StiffnessFigures(1e-3 * secant, 1e-3 * tangent, self._line(secant), self._line(tangent))

    def figures(self) -> MeshDynamicsFigures:
        """Return line of action, phases, harmonics and the tooth pair alone."""
        return MeshDynamicsFigures(
            self.pair.name,
            float(np.degrees(self.pair.pitch)),
            self.lever,
            self.lever / abs(self.pair.ratio),
            _known(np.degrees(self.pitch_point)),
            _known(np.degrees(self.first_contact)),
            [
                TorqueHarmonics(
                    1e-3 * float(torque),
                    TeHarmonics(*self._harmonics(self.line_te[k])),
                    StiffnessHarmonics(*self._harmonics(self._line(self.mesh.tangent[k]))),
                )
                for k, torque in enumerate(self.mesh.torque)
            ],
            self._tooth_pair(),
        )

    def _harmonics(self, curve: Array) -> tuple[list[float] | None, list[float] | None, float, list[float]]:
        """Return phases from the pitch point and from first contact, deg, and mean and amplitudes, of a curve (P,)."""
        values, phi1 = curve[self.places], self.mesh.phi1[self.places]
        order = np.arange(1, min(HARMONIC_COUNT, (len(values) // self.pitches - 1) // 2) + 1)[:, None]
        waves = np.exp(-2j * np.pi * order * phi1 / self.pair.pitch)
        coefficients = 2.0 / len(values) * (values * waves).sum(axis=1)
        phases = []
        for begin in (self.pitch_point, self.first_contact):
            turned = coefficients * np.exp(2j * np.pi * order[:, 0] * begin / self.pair.pitch)
            phases.append(None if np.isnan(begin) else np.degrees(np.angle(turned)).tolist())
        return phases[0], phases[1], float(values.mean()), np.abs(coefficients).tolist()

    def _tooth_pair(self) -> list[PairStiffnessFigures]:
        """Return the stiffness of one tooth pair alone over its engagement."""
        rows = []
        for k, torque in enumerate(self.mesh.torque.tolist()):
            load = self.mesh.loads[k]
            phase = self.mesh.phi1[load.position] - self.pair.pitch * load.number
            chosen = np.flatnonzero((load.force > 0.0) & np.isin(load.position, self.places))
            for m in chosen[np.lexsort((phase[chosen], load.half[chosen]))]:
                secant = float(load.moment[m] / self.mesh.rotation[k, load.position[m]])
                rows.append(
                    PairStiffnessFigures(
                        1e-3 * torque,
                        float(np.degrees(phase[m]).round(12)),
                        self.pair.pinion.halves[int(load.half[m])].number,
                        float(load.moment[m] / torque),
                        1e-3 * secant,
                        self._line(secant),
                    )
                )
        return rows


def whole_pitches(pair: GearPair, phi1: Array) -> tuple[list[int], int]:
    """Return the numbers of the positions that cover whole pitches once, and the number of pitches.

    Rotations phi1 (P,), rad, are those of the pinion. A last one that repeats the first is left out. Raises
    ArgumentError for rotations that are not on equal steps over whole pitches.
    """
    count, pitch = len(phi1), pair.pitch
    steps = np.diff(phi1)
    even = count > 1 and steps[0] > 0.0 and np.abs(steps - steps[0]).max() < STEP_TOLERANCE * pitch
    for kept in (count, count - 1) if even else ():
        pitches = kept * float(steps.mean()) / pitch
        if round(pitches) > 0 and abs(pitches - round(pitches)) < STEP_TOLERANCE * count:
            return list(range(kept)), round(pitches)
    raise ArgumentError(
        "phi1",
        f"{np.degrees(phi1[0]):g} to {np.degrees(phi1[-1]):g} deg",
        shown=f"{np.degrees(phi1[0]):g} to {np.degrees(phi1[-1]):g} deg, {count} positions",
        must_be=f"left out, or on equal steps over one pitch of the {pair.pinion.name} ({np.degrees(pitch):.10g} deg) or several: "
        "tables for dynamics repeat with the pitch",
    )


def mesh_phases(train: GearTrain) -> list[PhaseFigures]:
    """Return the phases of all meshes of a gear set against the first.

    Every gear stands where its teeth are in contact with its pinion: rotation c t + o, for a rotation t of the first
    pinion. A phase is None if it is unknown, and if the mesh has another period than the first.
    """
    first = train.pairs[0]
    rotations: dict[str, tuple[float, float]] = {first.pinion.name: (1.0, 0.0)}
    contacts = []
    for pair in train.pairs:
        at_pinion, at_gear = pitch_point_phi1(pair)
        rate, zero = rotations.get(pair.pinion.name, (np.nan, np.nan))
        rotations.setdefault(pair.gear.name, (rate * pair.ratio, at_gear + pair.ratio * (zero - at_pinion)))
        contacts.append(((at_pinion - zero) / rate, pair.pitch / abs(rate)))
    (begin, period) = contacts[0]
    return [
        PhaseFigures(
            pair.name, _known(_from_zero((turn - begin) / period)) if abs(own / period - 1.0) < STEP_TOLERANCE else None
        )
        for pair, (turn, own) in zip(train.pairs, contacts, strict=True)
    ]


def _from_zero(share: float) -> float:
    """Return a share of a period from 0 to 1; 0 where rounding alone parts it from a whole one."""
    rest = float(share % 1.0)
    return 0.0 if 1.0 - rest < STEP_TOLERANCE else rest


def _known(value: float) -> float | None:
    """Return a figure, None if it is NaN."""
    return None if np.isnan(value) else float(value)
