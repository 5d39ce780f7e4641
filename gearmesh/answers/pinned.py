"""A design with every default and derived value given: it builds the same gears in later versions."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing, plain
from gearmesh.design.core import Design

#: what follows from the gears themselves, not from a default: positions left out are those of their engagement, not a range of keys
_FOLLOWS = ("contact.phi1.start", "contact.phi1.stop")


@dataclass(frozen=True, repr=False)
class Pinned(Result):
    """The `design` with all that its gears were built of; `added`: keys that it has besides those that were set, and their values.

    As ".toml" its file is saved.
    """

    design: Design
    added: dict[str, Any]
    warnings: tuple[str, ...] = ()

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (".json", ".toml")

    @property
    def headline(self) -> str:
        return f"{len(self.added)} keys added"

    @property
    def listings(self) -> list[Listing]:
        return [Listing("Keys added", ("key", "value"), [[key, plain(value)] for key, value in self.added.items()])]

    def to_dict(self) -> dict[str, list[Any]]:
        return {"key": list(self.added), "value": list(self.added.values())}

    def document(self) -> dict[str, Any]:
        return {**header(self.design), "added": self.added}

    def _write(self, target: Path) -> None:
        from gearmesh.design.files import written
        from gearmesh.io.atomic import whole_text

        whole_text(target, written(self.design, target.parent, _FOLLOWS))


def pinned(stated: Design, design: Design) -> Pinned:
    """The pinned `design` of one as it was stated."""
    given = dict(stated.own())
    every = dict(_leaves(design.plain()))
    added = {key: value for key, value in every.items() if key not in given and key not in _FOLLOWS}
    return Pinned(design, added)


def _leaves(table: dict[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        found += _leaves(value, f"{prefix}{key}.") if isinstance(value, dict) else [(prefix + key, value)]
    return found
