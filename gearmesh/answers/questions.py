"""Gears that are asked how they touch: contact with shares of load, contact under load, all meshes under load, the check of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.answers.gearset import GearSet, number_list
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
        phi1 : (P,), optional
            Rotations of the pinion, deg; by default the design's positions.
        torque : float, optional
            On the pinion, Nm: adds the Hertz pressure along the path, with all load on the one tooth pair.
        load_sharing : bool
            With a torque: the share of it that `loaded_contact` gives the pair instead.
        cycle : bool
            Whether the mesh cycle is solved too: contact ratio, mesh transmission error, backlash, clearance, interference.
        turns : bool
            Whether the transmission error of eccentric members is followed over whole turns, until the same teeth meet again.
        pair : int or str
            Number of the pair, or its members as "sun-planet_1".

        Returns
        -------
        Contact
            `path` at P positions, `summary`, `cycle`; prints as a table.

        Raises
        ------
        DesignError
            For a pair that there is not, positions or a torque that are no numbers, and gears without a mating gear.
        NoSolutionError
            Where load sharing has no solution.

        Examples
        --------
        >>> contact = gears.contact()
        >>> contact.summary["contact_ratio"], contact.cycle.peak_to_peak  # the latter in rad
        >>> gears.contact([-5, 0, 5], torque=50, cycle=False).save("path.csv")
        """
        from gearmesh.answers.contact.contact import contact_of

        known, mesh = systems.system_of(self.design).first_order, self.train.pair(pair)

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
            phi1=None if phi1 is None else np.radians(number_list("phi1", phi1, "deg")),
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
        """Contact of a pair under one torque or several: load of every tooth pair, transmission error, pressures, root stress.

        In a planetary set the torque is that of this mesh alone: of N equal planets the sun has N times as much.

        Parameters
        ----------
        torque : float or (T,)
            On the pinion, Nm.
        phi1 : (P,), optional
            Rotations of the pinion, deg; by default 21 in a pitch.
        pair : int or str
            Number of the pair, or its members as "sun-planet_1".
        progress : Progress
            Called with the share that is done, and what is being done.
        mounts : mapping, optional
            Elastic shafts and bearings, by the members' names, instead of the design's own; displacements are then reported, and
            are part of the transmission error.
        contact : Contact, optional
            That of the pair, where it is solved already: its mesh cycle gives the transmission error without load.

        Returns
        -------
        LoadedContact
            Figures of T torques and P positions.

        Raises
        ------
        DesignError
            For torques that are not above 0, and for eccentric members.
        NoSolutionError
            Where no teeth touch without load.

        Examples
        --------
        >>> loaded = gears.loaded_contact([50, 100], [0.0])
        >>> soft = gm.FlexibleMount.of([2e5, 2e5, 1e5, np.inf, np.inf, np.inf])
        >>> gears.loaded_contact(50, [0.0], mounts={"pinion": soft}).save("soft.json")
        """
        from gearmesh.answers.contact.fit import fitted_cycle
        from gearmesh.answers.load.loaded import loaded_contact_of, required_torques

        mesh, meshes = self.train.pair(pair), self.train.like(pair)
        one = f"{mesh.name} is one of {meshes} equally loaded meshes: the torque is that of this mesh alone"
        torques = required_torques(number_list("torque", torque, "Nm").tolist())
        return loaded_contact_of(
            self.design,
            mesh,
            torques,
            (*self.warnings, one) if meshes > 1 else self.warnings,
            None if phi1 is None else np.radians(number_list("phi1", phi1, "deg")),
            progress,
            cycle=fitted_cycle(mesh)[1] if contact is None else contact.cycle,
            mounts=mounts,
        )

    def check_solved(self, contacts: Mapping[int, Contact], solids: dict[str, Solid]) -> Check:
        """The check of solved contacts, by the numbers of their pairs, and of solids by the names of their members; of gears that
        do not mesh that of the solids."""
        from gearmesh.answers.check import Check, RollTest, roll_test

        if not contacts:
            alone = ", ".join(f"{name}: no mating gear, so nothing is rolled" for name in solids)
            return Check(self.design, solids, RollTest([], ()), (*self.warnings, alone))
        checks = [
            Check(
                self.design,
                {},
                roll_test(contact.pair, contact.path),
                contact.warnings,
                contact.fit,
                mesh=tuple(contact.pair.members),
            )
            for contact in contacts.values()
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
