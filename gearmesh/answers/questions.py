"""Gears that are asked how they touch: contact with shares of load, contact under load, all meshes under load, the check of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.answers.gearset import GearSet, number_list, position_list
from gearmesh.arguments import checks_methods
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import Progress, silent
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearPair

if TYPE_CHECKING:
    from gearmesh.answers.bodies.solid import Solid
    from gearmesh.answers.check import Check
    from gearmesh.answers.contact.contact import Contact
    from gearmesh.answers.load.loaded import LoadedContact
    from gearmesh.contact.engagement.cycle import Cycle
    from gearmesh.contact.path import ContactPath
    from gearmesh.loaded.mounts import FlexibleMount


@checks_methods
class SolvedGears(GearSet):
    """The gears of a design, and what one answer about their contact needs another for."""

    def contact(
        self,
        phi1: ArrayLike | None = None,
        *,
        torque: float | None = None,
        load_sharing: bool = False,
        cycle: bool = True,
        turns: bool = False,
        pair: int | str = 0,
    ) -> Contact:
        """Tooth contact of a pair: the path of one tooth pair, and the whole mesh cycle.

        Parameters
        ----------
        phi1 : array_like, (P,), optional
            Rotations of the pinion, deg; by default the design's positions.
        torque : float, optional
            Nm on the pinion: then also the Hertz pressure along the path, all load on the one tooth pair.
        load_sharing : bool
            Give the tooth pair the share of the torque that `loaded_contact` finds.
        cycle : bool
            Whether the mesh cycle is solved, or the path alone.
        turns : bool
            Also the transmission error over whole turns of eccentric members, until the same teeth meet again.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".

        Returns
        -------
        Contact
            Positions (P,), contact ratio, transmission error, backlash, clearance, interference.

        Raises
        ------
        DesignError
            For positions, a torque or a pair that are none.

        Examples
        --------
        >>> f"{gears.contact().summary['contact_ratio']:.3f}"
        '1.566'
        """
        from gearmesh.answers.contact.contact import contact_of, refuse_torques

        # what is wrong with arguments is refused before anything is built
        positions = None if phi1 is None else np.radians(position_list(phi1))
        refuse_torques(torque, load_sharing=load_sharing)
        known, mesh = systems.system_of(self.design).first_order, self.pair(pair)

        def shares(path: ContactPath, whole: Cycle | None) -> tuple[Array, list[str]]:
            """Share (P,) of the torque on the tooth pair along its path, and the warnings about it."""
            from gearmesh.answers.load.loaded import loaded_contact_of

            # of double helical gears a torque is here that of one half, there that of both
            loaded = loaded_contact_of(self.design, mesh, [len(mesh.halves) * (torque or 0.0)], cycle=whole)
            return loaded.share_at(path.rotation), [*loaded.warnings, *loaded.complaints]

        return contact_of(
            self.design,
            mesh,
            self.warnings,
            phi1=positions,
            torque=torque,
            shares=shares if load_sharing else None,
            cycle=cycle,
            first_order=None if known is None else known(self.design.in_mm()),
            turns=turns,
        )

    def loaded_contact(
        self,
        torque: ArrayLike,
        phi1: ArrayLike | None = None,
        *,
        pair: int | str = 0,
        progress: Progress = silent,
        mounts: Mapping[str, FlexibleMount] | None = None,
        contact: Contact | None = None,
    ) -> LoadedContact:
        """Contact of a pair under load: load of every tooth pair, loaded transmission error, pressures, stiffness and root stress.

        Parameters
        ----------
        torque : array_like
            One torque or several, Nm, on the pinion. In a planetary set it is that of this mesh alone: of N equal planets
            the sun has
            N times as much.
        phi1 : array_like, (P,), optional
            Rotations of the pinion, deg; 21 in a pitch.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        progress : callable, optional
            Is told how far the work is (0 to 1) and what it is doing.
        mounts : mapping of str to FlexibleMount, optional
            Elastic shafts and bearings, by the members' names, as {"pinion": FlexibleMount.of([2e5, 2e5, 1e5, inf, inf, inf])},
            instead of the design's own; displacements are then reported, and are part of the transmission error.
        contact : Contact, optional
            That of the pair, where it is solved already: its mesh cycle gives the transmission error without load.

        Returns
        -------
        LoadedContact
            Figures of every torque, position and tooth pair.

        Raises
        ------
        DesignError
            For torques that are not above 0 and for eccentric members.
        NoSolutionError
            Where no teeth touch without load.

        Examples
        --------
        >>> loaded = gears.loaded_contact(20.0, [0.0])
        >>> loaded.save("load.json").name
        'load.json'
        """
        from gearmesh.answers.contact.fit import fitted_cycle
        from gearmesh.answers.load.loaded import loaded_contact_of, required_torques

        # what is wrong with arguments is refused before anything is built
        torques = required_torques(number_list("torque", torque, "Nm").tolist())
        positions = None if phi1 is None else position_list(phi1)
        mesh, meshes = self.pair(pair), self.train.like(pair)
        one = f"{mesh.name} is one of {meshes} equally loaded meshes: the torque is that of this mesh alone"
        return loaded_contact_of(
            self.design,
            mesh,
            torques,
            (*self.warnings, one) if meshes > 1 else self.warnings,
            None if positions is None else np.radians(positions),
            progress,
            cycle=fitted_cycle(mesh)[1] if contact is None else contact.cycle,
            mounts=mounts,
        )

    def check_solved(self, contacts: Mapping[int, Contact], solids: dict[str, Solid]) -> Check:
        """The check of contacts and solids that are there already.

        Parameters
        ----------
        contacts : mapping of int to Contact
            Solved contacts, by the numbers of their pairs; none of gears that do not mesh.
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


def loaded_meshes(
    gears: SolvedGears,
    torque: ArrayLike,
    contacts: Mapping[int, Contact],
    progress: Progress = silent,
) -> dict[int, LoadedContact]:
    """Every mesh of a gear set that is not like one before it, by the numbers of the pairs, under one torque or several, Nm, on the
    pinion of the first, and with its solved contact; other meshes have the torque that is transmitted to their pinions: idlers,
    such as planets, take up none of it.

    Raises DesignError and NoSolutionError as `SolvedGears.loaded_contact`.
    """
    first, asked = gears.pairs[0], number_list("torque", torque, "Nm")
    handed: dict[str, float] = {first.pinion.name: 1.0}
    by_pair: dict[int, LoadedContact] = {}
    for pair in gears.pairs:
        handed.setdefault(pair.gear.name, handed.setdefault(pair.pinion.name, 1.0) / abs(pair.ratio))
    different = gears.train.different
    for done, k in enumerate(different):
        pair, part = gears.pairs[k], handed[gears.pairs[k].pinion.name]

        def report(share: float, doing: str, done: int = done) -> None:
            progress((done + share) / len(different), doing)

        under_load = gears.loaded_contact(part * asked, pair=k, progress=report, contact=contacts[k])
        if len(different) > 1:
            under_load = replace(
                under_load, warnings=(*gears.warnings, *_of_mesh(pair, under_load.warnings, gears.warnings))
            )
        if pair.pinion.name != first.pinion.name:
            line = (
                f"{pair.name}: its torque is transmitted by {first.name}, {part * asked[-1]:.6g} Nm on the {pair.pinion.name} with "
                f"{asked[-1]:g} Nm on the {first.pinion.name}"
            )
            under_load = replace(under_load, warnings=(*under_load.warnings, line))
        by_pair[k] = under_load
    return by_pair


def _of_mesh(pair: GearPair, lines: Sequence[str], known: Sequence[str]) -> list[str]:
    """Lines that are not of all gears, each with the name of the mesh."""
    own = [line for line in lines if line not in known]
    return [line if line.startswith(pair.name) else f"{pair.name}: {line}" for line in own]
