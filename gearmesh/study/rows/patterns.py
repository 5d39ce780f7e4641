"""Contact of every row of a small study, to be drawn side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearmesh.contact.assemblies import AssemblyPaths
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.study.rows.path_figures import PHASES_PER_PITCH, gears_advance
from gearmesh.study.rows.work import NO_CONTACT, StudyWork
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import GearPair


@dataclass(frozen=True)
class AssemblyContact:
    """Contact of a pair in the assembly of one row."""

    #: pair with the members mounted as in the row
    pair: GearPair
    #: frame of the pinion's flank
    frame: FlankFrame
    #: paths of contact of this one assembly
    paths: AssemblyPaths
    #: line of contact at each of P positions, in the pinion's own frame; None for contact at a point
    lines: tuple[Array | None, ...]
    #: advance (PHASES_PER_PITCH,) of the gears over a pitch, rad
    advance: Array

    @property
    def phase(self) -> Array:
        """Rotations (PHASES_PER_PITCH + 1,), rad, of `advance`, with the first value repeated at the end."""
        return np.arange(PHASES_PER_PITCH + 1) * self.pair.pitch / PHASES_PER_PITCH


def assembly_contacts(work: StudyWork, rows: Sequence[Sequence[Any]]) -> list[AssemblyContact | str]:
    """Return the contact of each row, or the reason why it has none."""
    contacts: list[AssemblyContact | str] = []
    for row in work.paths(rows):
        if isinstance(row, str):
            contacts.append(row)
            continue
        variant, paths = row
        if not paths.touching.any():
            contacts.append(NO_CONTACT)
            continue
        line = (paths.surface & paths.line)[0]
        lines: list[Array | None] = [None] * len(line)
        if line.any():
            solved = contact_path(variant.flanks, paths.phi1[line], None)
            to_own = variant.pair.pinion.mount.at(solved.rotation).inverse
            for i, k in enumerate(np.flatnonzero(line)):
                each_line = solved.lines[i]
                lines[k] = None if each_line is None else each_line @ to_own.rotation[i].T + to_own.translation[i]
        advance = gears_advance(paths, variant.pair.pitch)[0]
        contacts.append(AssemblyContact(variant.pair, variant.frame, paths, tuple(lines), advance))
    return contacts
