"""Pinned design: every default and derived value is given, so that later versions build the same gears."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gearmesh.answers.contact.contact import PHI1_RANGE_KEYS, positions_of
from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing, plain
from gearmesh.design.core import Design
from gearmesh.design.dotted import values_of
from gearmesh.design.files import every_key
from gearmesh.figures import Content
from gearmesh.formats import JSON_SUFFIX, TOML_SUFFIX
from gearmesh.records import dataclass
from gearmesh.systems.designs import parse
from gearmesh.teeth.gear_train import GearPair


@dataclass(frozen=True, repr=False)
class Pinned(Result):
    """Design with all values from which its gears were built.

    A file with the suffix ".toml" is the design file.
    """

    #: the design with all its values
    design: Design
    #: keys that were not set before, and their values
    added: Mapping[str, Any]
    #: True if the range of phi1 was set or is among the added keys
    positions: bool = True
    #: warnings, one line each
    warnings: tuple[str, ...] = ()

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, TOML_SUFFIX)

    @property
    def headline(self) -> str:
        return f"{len(self.added)} keys added"

    @property
    def listings(self) -> list[Listing]:
        return [Listing("Keys added", ("key", "value"), [[key, plain(value)] for key, value in self.added.items()])]

    def to_dict(self) -> dict[str, list[Any]]:
        return {"key": list(self.added), "value": list(self.added.values())}

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "added": self.added}

    def _write(self, target: Path) -> None:
        from gearmesh.design.files import design_text
        from gearmesh.io.atomic import whole_text

        left_out = () if self.positions else PHI1_RANGE_KEYS
        whole_text(target, design_text(self.design, target.parent, left_out))


def pin(stated: Design, design: Design, pairs: tuple[GearPair, ...]) -> Pinned:
    """Return the pinned design of the `stated` design; `design` is complete, and `pairs` are built from it.

    If the stated design has no positions, those of the engagement of its only pair are added. They are left out with
    several pairs, or if the pair never meets.
    """
    given = dict(stated.own())
    positions = any(map(stated.sets, PHI1_RANGE_KEYS)) or len(pairs) == 1
    if len(pairs) == 1 and (ends := positions_of(stated, pairs[0])) is not None:
        # the whole table is added: a table that is partly given has other defaults than a missing table
        table = {key: value for key, value in values_of(design.plain()) if key.startswith("contact.")}
        design = design.with_values({**table, **dict(zip(PHI1_RANGE_KEYS, ends, strict=True))})
    # parse it as a stated design: a later build could choose a default anew that is only filled in
    design = parse(every_key(design, () if positions else PHI1_RANGE_KEYS))
    all_keys = dict(values_of(design.plain()))
    added = {
        key: value for key, value in all_keys.items() if key not in given and (positions or key not in PHI1_RANGE_KEYS)
    }
    return Pinned(design, added, positions)
