"""Contact of the pairs of a page, solved in steps, as data for its curves and its view.

The workshop loads this module, and with it the solver, when the first gears are on the screen.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from gearmesh.answers.bodies.questions import ModelledGears
from gearmesh.answers.contact.contact import Contact, MeshSolution, contact_of
from gearmesh.answers.contact.staging import first_contact, solved_contact, staged_contact
from gearmesh.errors import GearmeshError
from gearmesh.progress import in_turn
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.view.report.stage import StagedPair, pair_data


def solve_mesh(pair: GearPair) -> MeshSolution:
    """Solve the mesh of a pair."""
    return MeshSolution.of(pair)


def solve_contact(gears: ModelledGears, number: int, mesh: MeshSolution) -> Contact:
    """Return the contact of the pair with a `number`, whose mesh is solved."""
    return contact_of(gears.design, gears.pair(number), gears.warnings, mesh=mesh)


def few_positions(
    train: GearTrain, ends: Mapping[int, tuple[float, float]], names: list[str]
) -> list[dict[str, Any]] | None:
    """Return pairs with their contact at few positions between `ends` (rad) by number; None if the whole contact must say why not.

    `names` are those of all members, in the order of the view.
    """
    try:
        found = [first_contact(train, train.pairs[k], own) for k, own in ends.items()]
    except GearmeshError:
        return None
    return [_at_few(train, StagedPair(each, {}), names) for each in found if each is not None]


def few_solved(train: GearTrain, contacts: Iterable[Contact], names: list[str]) -> list[dict[str, Any]] | None:
    """Return pairs with solved contacts at their own positions; None if any of them touches at too few."""
    found = [solved_contact(train, contact) for contact in contacts]
    known = [_at_few(train, StagedPair(each, {}), names) for each in found if each is not None]
    return known if len(known) == len(found) else None


def _at_few(train: GearTrain, staged_pair: StagedPair, names: list[str]) -> dict[str, Any]:
    return pair_data(train, staged_pair, names) | {"later": True}


def staged(train: GearTrain, contacts: Iterable[Contact], names: list[str]) -> list[dict[str, Any]]:
    """Return pairs with solved contacts at the positions of the slider, and all fields."""
    return [
        pair_data(train, StagedPair(staged_contact(train, contact), {}), names) for contact in in_turn(list(contacts))
    ]
