"""The reference: every figure that answers have, with key, unit, symbol and meaning, as it is declared."""

from __future__ import annotations

import importlib
import pkgutil
import re
from dataclasses import dataclass

import gearmesh.answers
import gearmesh.study
import gearmesh.systems
from gearmesh.answers.tables import Listing
from gearmesh.figures import MEMBER_PLACE, Figure, Figures

#: packages whose modules declare figures
PACKAGES = (gearmesh.answers, gearmesh.systems, gearmesh.study)
#: where a column says which of three coordinates it is
COORDINATE = re.compile(r"_[xyz](?=_mm$|$)")
#: columns of the reference
COLUMNS = ("key", "unit", "symbol", "meaning")


@dataclass(frozen=True)
class FigureGroup:
    """The figures of one kind of answer: what it is `of`, and each figure in the order of the JSON."""

    of: str
    figures: tuple[Figure, ...]

    @property
    def rows(self) -> list[tuple[str, str, str, str]]:
        """Key, unit, symbol and meaning of each."""
        return [(figure.key, figure.unit, figure.symbol, figure.meaning) for figure in self.figures]

    @property
    def listing(self) -> Listing:
        """As a table."""
        return Listing(self.of, COLUMNS, self.rows)


def figure_groups(word: str = "") -> list[FigureGroup]:
    """All declared figures whose key contains a `word`, by answers; nothing is solved."""
    kinds = sorted(declaring(), key=lambda kind: (_rank(kind.__module__), kind.__module__))
    groups = (FigureGroup(_first_line(kind), _figures_with(kind, word)) for kind in kinds)
    return [group for group in groups if group.figures]


def figures_document(groups: list[FigureGroup]) -> dict[str, dict[str, list[dict[str, str]]]]:
    """As `describe --figures --json` writes it."""
    return {"figures": {group.of: [dict(zip(COLUMNS, row, strict=True)) for row in group.rows] for group in groups}}


def declaring() -> list[type[Figures]]:
    """All kinds of figures that the packages declare, as they are declared in each module."""
    for package in PACKAGES:
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            importlib.import_module(module.name)
    kinds: list[type[Figures]] = []
    waiting = list(Figures.__subclasses__())
    while waiting:
        kind = waiting.pop(0)
        waiting += kind.__subclasses__()
        if kind.__module__.startswith(f"{gearmesh.__name__}."):
            kinds.append(kind)
    return kinds


def _rank(module: str) -> int:
    """Answers first, then what gear systems and studies add."""
    return next((k for k, package in enumerate(PACKAGES) if module.startswith(package.__name__)), len(PACKAGES))


def _first_line(kind: type[Figures]) -> str:
    return (kind.__doc__ or kind.__name__).splitlines()[0].removesuffix(".")


def _figures_with(kind: type[Figures], word: str) -> tuple[Figure, ...]:
    """Its own figures whose key contains a word; those that consist of figures of another kind are listed there."""
    return tuple(known for known in kind.declared_figures() if known.key and _is_meant(known, word))


def _is_meant(known: Figure, word: str) -> bool:
    """Whether a word is part of the key of a figure, or a column of it: after what it is of, with the name of a member, with one
    of three coordinates, or as travel of a rack."""
    keys = [known.key, *([known.in_um().key] if known.unit == "arcsec" else [])]
    column = COORDINATE.sub("", word) if known.vector else word
    patterns = [re.escape(key).replace(re.escape(MEMBER_PLACE), r"\w+") for key in keys if key != MEMBER_PLACE]
    return word in known.key or any(re.search(rf"(^|_){pattern}$", column) for pattern in patterns)
