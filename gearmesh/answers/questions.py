"""Questions about the contact of gears: load sharing, contact under load, all meshes under load, and the check."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.answers.gearset import GearSet, number_list, position_list
from gearmesh.arguments import checks_methods, refuse_speed
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import Progress, silent, stage_of
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearPair

if TYPE_CHECKING:
    from gearmesh.answers.bodies.solid import Solid
    from gearmesh.answers.check import Check
    from gearmesh.answers.contact.contact import Contact
    from gearmesh.answers.load.dynamics import Dynamics
    from gearmesh.answers.load.loaded import LoadedContact
    from gearmesh.contact.engagement.cycle import Cycle
    from gearmesh.contact.path import ContactPath
    from gearmesh.loaded.mounts import FlexibleMount


@checks_methods
class SolvedGears(GearSet):
    """Gears of a design, with the answers about contact that other answers need."""

    def contact(
        self,
        phi1: ArrayLike | None = None,
        *,
        torque: float | None = None,
        load_sharing: bool = False,
        cycle: bool = True,
        turns: bool = False,
        pair: int | str = 0,
        speed: float | None = None,
    ) -> Contact:
        """Tooth contact of a pair: the path of one tooth pair, and the whole mesh cycle.

        Parameters
        ----------
        phi1 : array_like, (P,), optional
            Rotations of the pinion, deg; by default the design's positions.
        torque : float, optional
            Nm on the pinion: adds the Hertz pressure along the path, with the whole load on one tooth pair.
        load_sharing : bool
            Load the tooth pair with the share of the torque that `loaded_contact` computes.
        cycle : bool
            Solve the mesh cycle, not only the path.
        turns : bool
            Add the transmission error over whole turns of eccentric members, until the same teeth meet again.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        speed : float, optional
            Rpm of the pinion: adds sliding and rolling velocities in m/s, and pressure times velocity.

        Returns
        -------
        Contact
            Positions (P,), contact ratio, transmission error, backlash, clearance, interference.

        Raises
        ------
        DesignError
            For an invalid position, torque, speed or pair.

        Examples
        --------
        >>> f"{gears.contact().summary['contact_ratio']:.3f}"
        '1.566'
        """
        from gearmesh.answers.contact.contact import contact_of, refuse_torques

        # invalid arguments are refused before anything is built
        positions = None if phi1 is None else np.radians(position_list(phi1))
        refuse_torques(torque, load_sharing=load_sharing)
        refuse_speed(speed)
        known, mesh = systems.system_of(self.design).first_order, self.pair(pair)

        def shares(path: ContactPath, whole: Cycle | None) -> tuple[Array, list[str]]:
            """Return the share (P,) of the torque on the tooth pair along its path, and the warnings about it."""
            from gearmesh.answers.load.loaded import loaded_contact_of

            # for double helical gears `contact` takes the torque of one half, loaded contact the torque of both halves
            torques = [len(mesh.halves) * (torque or 0.0)]
            loaded = loaded_contact_of(self.design, self.train.sharing(pair), torques, cycle=whole)
            return loaded.share_at(path.rotation), [*loaded.warnings, *loaded.complaints]

        contact = contact_of(
            self.design,
            mesh,
            self.warnings,
            phi1=positions,
            torque=torque,
            shares=shares if load_sharing else None,
            cycle=cycle,
            first_order=None if known is None else known(self.design.in_mm()),
            turns=turns,
            speed=speed,
        )
        if not self.train.shared:
            return contact
        from gearmesh.answers.contact.shared import with_shared

        return with_shared(contact, self.train, pair)

    def loaded_contact(
        self,
        torque: ArrayLike,
        phi1: ArrayLike | None = None,
        *,
        pair: int | str = 0,
        progress: Progress = silent,
        mounts: Mapping[str, FlexibleMount] | None = None,
        contact: Contact | None = None,
        level: str = "full",
    ) -> LoadedContact:
        """Contact of a pair under load: load sharing, transmission error, pressures, stiffness and root stress.

        Parameters
        ----------
        torque : array_like
            One torque or several, Nm, on the pinion. In a planetary set this is the torque of one mesh: the torque of the
            sun is N times as large for N equal planets. Of a cycloidal drive with several discs it is that of all discs.
        phi1 : array_like, (P,), optional
            Rotations of the pinion, deg; by default 21 in a pitch.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        progress : callable, optional
            Called with the finished share of the work (0 to 1) and its current step.
        mounts : mapping of str to FlexibleMount, optional
            Elastic shafts and bearings, by the members' names, for example
            {"pinion": FlexibleMount.of([2e5, 2e5, 1e5, inf, inf, inf])}. They replace those of the design.
            Displacements are then reported, and are part of the transmission error.
        contact : Contact, optional
            Solved contact of the pair: its mesh cycle gives the transmission error without load.
        level : str
            "full", or "quick" for sweeps: coarse elements and cells, within 3 % in transmission error and load shares.

        Returns
        -------
        LoadedContact
            Figures of every torque, position and tooth pair.

        Raises
        ------
        DesignError
            For torques that are not above 0 and for eccentric members.
        NoSolutionError
            If no teeth touch without load.

        Examples
        --------
        >>> loaded = gears.loaded_contact(20.0, [0.0])
        >>> loaded.save("load.json").name
        'load.json'
        """
        from gearmesh.answers.contact.fit import fitted_cycle
        from gearmesh.answers.load.loaded import (
            loaded_contact_of,
            refuse_eccentric,
            required_level,
            required_torques,
        )

        # invalid arguments are refused before anything is built
        model = required_level(level)
        torques = required_torques(number_list("torque", torque, "Nm").tolist())
        positions = None if phi1 is None else position_list(phi1)
        mesh, meshes = self.train.sharing(pair), 1 if self.train.shared else self.train.like(pair)
        refuse_eccentric(mesh)
        note = f"{mesh.name} is one of {meshes} equally loaded meshes: the torque is that of this mesh alone"
        return loaded_contact_of(
            self.design,
            mesh,
            torques,
            (*self.warnings, note) if meshes > 1 else self.warnings,
            None if positions is None else np.radians(positions),
            progress,
            cycle=fitted_cycle(mesh)[1] if contact is None else contact.cycle,
            mounts=mounts,
            level=model,
        )

    def dynamics(
        self,
        torque: ArrayLike,
        phi1: ArrayLike | None = None,
        *,
        pair: int | str | None = None,
        progress: Progress = silent,
        loaded: LoadedContact | None = None,
    ) -> Dynamics:
        """Tables for rotor dynamics: static transmission error, mesh stiffness, harmonics and phases of the meshes.

        Parameters
        ----------
        torque : array_like
            One torque or several, Nm, on the pinion of the first mesh. Other meshes have the torque transmitted to them.
        phi1 : array_like, (P,), optional
            Rotations of the pinion, deg, on equal steps over one pitch or several; by default 21 in a pitch.
        pair : int or str, optional
            The only mesh, by number or by members as "sun-planet_1"; by default every different mesh. The torque is
            then that of its pinion.
        progress : callable, optional
            Called with the finished share of the work (0 to 1) and its current step.
        loaded : LoadedContact, optional
            Solved loaded contact of the first mesh, or of `pair`, at the same torques and positions.

        Returns
        -------
        Dynamics
            A regular grid over torque and phi1, harmonics 1 to 10, and the phases of all meshes.

        Raises
        ------
        DesignError
            For torques that are not above 0, for eccentric members, and for positions that do not cover whole pitches.
        NoSolutionError
            If no teeth touch without load.

        Examples
        --------
        >>> half_pitches = np.degrees(gears.pairs[0].pitch) * np.array([0.0, 0.5])
        >>> loaded = gears.loaded_contact(20.0, half_pitches, level="quick")
        >>> tables = gears.dynamics(20.0, half_pitches, loaded=loaded)
        >>> tables.grid[0].mesh_stiffness.tangent_line > 1e8
        True
        """
        from gearmesh.answers.load.dynamics import Dynamics, whole_pitches
        from gearmesh.answers.load.loaded import required_torques

        torques = np.array(required_torques(number_list("torque", torque, "Nm").tolist()))
        numbers = list(self.train.loaded) if pair is None else [self.train.names.pair_number(pair)]
        if phi1 is not None:
            for number in numbers:
                whole_pitches(self.pairs[number], np.radians(position_list(phi1)))
        ratios = transmitted_torques(self.pairs)
        solved: dict[int, LoadedContact] = {}
        for done, number in enumerate(numbers):
            if loaded is not None and loaded.pair.name == self.pairs[number].name:
                solved[number] = loaded
            else:
                ratio = 1.0 if pair is not None else ratios[number]
                of_mesh = stage_of(progress, done, len(numbers))
                solved[number] = self.loaded_contact(ratio * torques, phi1, pair=number, progress=of_mesh)
        warnings = dict.fromkeys(line for answer in solved.values() for line in answer.warnings)
        return Dynamics(self.design, self.train, solved, tuple(warnings))

    def check_solved(self, contacts: Mapping[int, Contact], solids: dict[str, Solid]) -> Check:
        """Check of solved contacts and solids.

        Parameters
        ----------
        contacts : mapping of int to Contact
            Solved contacts, by the numbers of their pairs; empty for gears that do not mesh.
        solids : dict of str to Solid
            Solids by the names of their members.

        Returns
        -------
        Check
            A verdict on each.

        Examples
        --------
        >>> parts = {name: gears.solid(name, 0.05) for name in gears.members}
        >>> all(verdict.ok for verdict in gears.check_solved({0: gears.contact([0.0, 1.0])}, parts).verdicts)
        True
        """
        from gearmesh.answers.check import Check, RollTest, roll_test

        if not contacts:
            alone = ", ".join(f"{name}: no mating gear, so nothing is rolled" for name in solids)
            return Check(self.design, solids, RollTest([], ()), (*self.warnings, alone))
        known = systems.system_of(self.design).reserves
        reserves = () if known is None else known(self.design, self.train)
        checks = [
            Check(
                self.design,
                {},
                roll_test(contact.pair, contact.path),
                contact.warnings,
                contact.fit,
                turns=contact.unlike_turns,
                mesh=tuple(contact.pair.members),
                reserves=tuple(reserve for reserve in reserves if reserve.pair == number),
            )
            for number, contact in contacts.items()
        ]
        warnings = tuple(dict.fromkeys(line for check in checks for line in check.warnings))
        return replace(checks[0], solids=solids, warnings=warnings, others=tuple(checks[1:]))


def transmitted_torques(pairs: Sequence[GearPair]) -> list[float]:
    """Return the torque on the pinion of every pair, over the torque on the pinion of the first.

    Idlers, such as planets, take up no torque.
    """
    ratios: dict[str, float] = {}
    for pair in pairs:
        ratios.setdefault(pair.gear.name, ratios.setdefault(pair.pinion.name, 1.0) / abs(pair.ratio))
    return [ratios[pair.pinion.name] for pair in pairs]


def loaded_meshes(
    gears: SolvedGears,
    torque: ArrayLike,
    contacts: Mapping[int, Contact],
    progress: Progress = silent,
) -> dict[int, LoadedContact]:
    """Return the loaded contact of every different mesh of a gear set, by the numbers of the pairs.

    The torques (Nm) are on the pinion of the first mesh. Other meshes have the torque that is transmitted to their
    pinions; idlers, such as planets, take up no torque. Raises the errors of `SolvedGears.loaded_contact`.
    """
    first, torques = gears.pairs[0], number_list("torque", torque, "Nm")
    torque_ratios = transmitted_torques(gears.pairs)
    by_pair: dict[int, LoadedContact] = {}
    different = gears.train.loaded
    for done, k in enumerate(different):
        pair, ratio, of_mesh = gears.pairs[k], torque_ratios[k], stage_of(progress, done, len(different))
        under_load = gears.loaded_contact(ratio * torques, pair=k, progress=of_mesh, contact=contacts[k])
        if len(different) > 1:
            under_load = replace(
                under_load, warnings=(*gears.warnings, *_of_mesh(pair, under_load.warnings, gears.warnings))
            )
        if pair.pinion.name != first.pinion.name:
            line = (
                f"{pair.name}: its torque is transmitted by {first.name}, {ratio * torques[-1]:.6g} Nm on the "
                f"{pair.pinion.name} with {torques[-1]:g} Nm on the {first.pinion.name}"
            )
            under_load = replace(under_load, warnings=(*under_load.warnings, line))
        by_pair[k] = under_load
    return by_pair


def _of_mesh(pair: GearPair, lines: Sequence[str], known: Sequence[str]) -> list[str]:
    """Return the lines that do not apply to all gears, each with the name of the mesh."""
    mesh_lines = [line for line in lines if line not in known]
    return [line if line.startswith(pair.name) else f"{pair.name}: {line}" for line in mesh_lines]
