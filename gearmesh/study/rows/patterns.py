"""Contact of every row of a small study, to be drawn beside each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.contact.assemblies import AssemblyPaths
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.study.rows.path_figures import PHASES, gears_advance
from gearmesh.study.rows.work import NO_CONTACT, StudyWork
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import GearPair


@dataclass(frozen=True)
class AssemblyContact:
    """A pair as one row has it, its `frame` and paths (one assembly), the `lines` of contact (P) in the pinion's own frame where it
    has such, and the gears' `advance` (PHASES,), rad, over a pitch."""

    pair: GearPair
    frame: FlankFrame
    paths: AssemblyPaths
    lines: tuple[Array | None, ...]
    advance: Array

    @property
    def phase(self) -> Array:
        """Rotations (PHASES + 1,), rad, at which `advance` and its first again are."""
        return np.arange(PHASES + 1) * self.pair.pitch / PHASES


def assembly_contacts(work: StudyWork, rows: Sequence[Sequence[Any]]) -> list[AssemblyContact | str]:
    """Of each row its contact, or why there is none."""
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
