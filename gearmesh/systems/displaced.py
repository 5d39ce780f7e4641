"""Members of a pair moved by errors of assembly: their teeth stay, only their mounts change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gearmesh.design.core import Design
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.system import system_of
from gearmesh.teeth.gear_train import GearPair, GearTrain


def displaced_bases(
    design: Design, train: GearTrain, pair: GearPair, errors: Mapping[str, Array]
) -> tuple[Rigid, Rigid]:
    """Return the bases of the mounts of pinion and gear in M assemblies: rotations (M, 3, 3), translations (M, 3).

    - design, train, pair: gears without errors of assembly.
    - errors: values (M,) by dotted key, in the units of the design: all of the kind that only move members. A kind
      without any needs another entry, which gives M.
    """
    known, count = system_of(design).displacements, len(next(iter(errors.values())))
    bases = tuple(mount.base for mount in pair.mounts)
    if known is not None:
        values = {}
        for key in known.keys:
            dotted = f"assembly.{key}"
            meant = type(design).key_at(dotted)
            factor = design.mm_per_unit if meant is not None and meant.unit == "length" else 1.0
            values[key] = factor * errors[dotted]
        bases = known.displaced(design.in_mm(), train, values)
        if pair.name != train.pairs[0].name:
            bases = _as_first(pair, train.pairs[0], bases)
    first, second = (
        Rigid(np.broadcast_to(base.rotation, (count, 3, 3)), np.broadcast_to(base.translation, (count, 3)))
        for base in bases
    )
    return first, second


def _as_first(pair: GearPair, first: GearPair, bases: tuple[Rigid, ...]) -> tuple[Rigid, ...]:
    """Return the bases of a pair whose members are displaced as those of the first pair, each seen from its own pinion."""
    image = pair.pinion.mount.base @ first.pinion.mount.base.inverse
    from_first = image.inverse
    return tuple(
        image @ base @ old.base.inverse @ from_first @ own.base
        for base, old, own in zip(bases, first.mounts, pair.mounts, strict=True)
    )


def displaced_pair(pair: GearPair, bases: tuple[Rigid, Rigid], m: int = 0) -> GearPair:
    """Return a pair with its members mounted as in the m-th of M assemblies."""
    first, second = (
        replace(member, mount=replace(member.mount, base=Rigid(base.rotation[m], base.translation[m])))
        for member, base in zip(pair.both, bases, strict=True)
    )
    return replace(pair, pinion=first, gear=second)
