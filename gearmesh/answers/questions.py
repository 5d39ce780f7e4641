"""Questions about gears that one answer needs another for: contact with shares of load, all meshes under load, the check of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.answers.bodies.solid import Solid
from gearmesh.answers.check import Check, roll_test
from gearmesh.answers.contact.contact import Contact, contact_of
from gearmesh.answers.contact.fit import fitted_cycle
from gearmesh.answers.gearset import GearSet
from gearmesh.answers.load.loaded import LoadedContact, loaded_contact_of, required_torques
from gearmesh.contact.engagement.cycle import Cycle
from gearmesh.contact.path import ContactPath
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.mounts import FlexibleMount
from gearmesh.progress import Progress, silent
from gearmesh.systems import system as systems
from gearmesh.teeth.train import GearPair


def contact(
    gears: GearSet,
    phi1: ArrayLike | None = None,
    *,
    torque: float | None = None,
    load_sharing: bool = False,
    cycle: bool = True,
    turns: bool = False,
    pair: int | str = 0,
) -> Contact:
    """Tooth contact of a pair of gears at `phi1` (P,), deg, as `Gears.contact` says."""
    known, mesh = systems.system(gears.design.kind).first_order, gears.train.pair(pair)

    def shares(path: ContactPath, whole: Cycle | None) -> tuple[Array, list[str]]:
        """Share (P,) of the torque on the tooth pair along its path, and the warnings about it."""
        # of double helical gears a torque is here that of one half, there that of both
        loaded = loaded_contact_of(gears.design, mesh, [len(mesh.halves) * (torque or 0.0)], cycle=whole)
        return loaded.share_at(path.rotation), [*loaded.warnings, *loaded.complaints]

    return contact_of(
        gears.design,
        mesh,
        gears.warnings,
        phi1=None if phi1 is None else np.radians(np.atleast_1d(np.asarray(phi1, dtype=float))),
        torque=torque,
        shares=shares if load_sharing else None,
        cycle=cycle,
        first_order=None if known is None else known(gears.design.in_mm()),
        turns=turns,
    )


def loaded(
    gears: GearSet,
    torque: ArrayLike,
    phi1: ArrayLike | None = None,
    *,
    pair: int | str = 0,
    progress: Progress = silent,
    mounts: Mapping[str, FlexibleMount] | None = None,
    contact: Contact | None = None,
) -> LoadedContact:
    """Contact of a pair under one torque or several, Nm, as `Gears.loaded` says."""
    mesh, meshes = gears.train.pair(pair), gears.train.like(pair)
    one = f"{mesh.name} is one of {meshes} equally loaded meshes: the torque is that of this mesh alone"
    torques = required_torques(np.atleast_1d(np.asarray(torque, dtype=float)).tolist())
    return loaded_contact_of(
        gears.design,
        mesh,
        torques,
        (*gears.warnings, one) if meshes > 1 else gears.warnings,
        None if phi1 is None else np.radians(np.atleast_1d(np.asarray(phi1, dtype=float))),
        progress,
        cycle=fitted_cycle(mesh)[1] if contact is None else contact.cycle,
        mounts=mounts,
    )


def loaded_meshes(
    gears: GearSet,
    torque: ArrayLike,
    contacts: Mapping[int, Contact],
    progress: Progress = silent,
) -> dict[int, LoadedContact]:
    """Every mesh of a gear set that is not like one before it, by the numbers of the pairs, under one torque or several, Nm, on the
    pinion of the first, and with its solved contact; other meshes have the torque that is transmitted to their pinions: idlers,
    such as planets, take up none of it.

    Raises DesignError and NoSolutionError as `Gears.loaded`.
    """
    first, asked = gears.pairs[0], np.atleast_1d(np.asarray(torque, dtype=float))
    handed: dict[str, float] = {first.pinion.name: 1.0}
    found: dict[int, LoadedContact] = {}
    for pair in gears.pairs:
        handed.setdefault(pair.gear.name, handed.setdefault(pair.pinion.name, 1.0) / abs(pair.ratio))
    different = gears.train.different
    for done, k in enumerate(different):
        pair, part = gears.pairs[k], handed[gears.pairs[k].pinion.name]

        def told(share: float, doing: str, done: int = done) -> None:
            progress((done + share) / len(different), doing)

        each = loaded(gears, part * asked, pair=k, progress=told, contact=contacts[k])
        if len(different) > 1:
            each = replace(each, warnings=(*gears.warnings, *_of_mesh(pair, each.warnings, gears.warnings)))
        if pair.pinion.name != first.pinion.name:
            line = (
                f"{pair.name}: its torque is transmitted by {first.name}, {part * asked[-1]:.6g} Nm on the {pair.pinion.name} with "
                f"{asked[-1]:g} Nm on the {first.pinion.name}"
            )
            each = replace(each, warnings=(*each.warnings, line))
        found[k] = each
    return found


def _of_mesh(pair: GearPair, lines: Sequence[str], known: Sequence[str]) -> list[str]:
    """Lines that are not of all gears, each with the name of the mesh."""
    own = [line for line in lines if line not in known]
    return [line if line.startswith(pair.name) else f"{pair.name}: {line}" for line in own]


def checked(gears: GearSet, contacts: Mapping[int, Contact], solids: dict[str, Solid]) -> Check:
    """The check of solved contacts, by the numbers of their pairs, and of solids by the names of their members."""
    found = [
        Check(gears.design, {}, roll_test(each.pair, each.path), each.warnings, each.fit, mesh=tuple(each.pair.members))
        for each in contacts.values()
    ]
    warnings = tuple(dict.fromkeys(line for each in found for line in each.warnings))
    return replace(found[0], solids=solids, warnings=warnings, others=tuple(found[1:]))
