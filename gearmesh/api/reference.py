"""Reference of all figures of answers: key, unit, symbol and meaning, as declared."""

from __future__ import annotations

import importlib
import pkgutil
import re

import gearmesh.answers
import gearmesh.optimize
import gearmesh.study
import gearmesh.systems
import gearmesh.trains
from gearmesh.answers.tables import Listing
from gearmesh.figures import MEMBER_PLACE, Figure, Figures
from gearmesh.records import dataclass

#: packages whose modules declare figures
FIGURE_PACKAGES = (gearmesh.answers, gearmesh.systems, gearmesh.study, gearmesh.optimize, gearmesh.trains)
#: suffix of a column that names one of three coordinates
COORDINATE_SUFFIX = re.compile(r"_[xyz](?=_mm$|$)")
#: columns of the reference
REFERENCE_COLUMNS = ("key", "unit", "symbol", "meaning")


@dataclass(frozen=True)
class FigureGroup:
    """The figures of one kind of answer, in the order of the JSON; `of` describes the kind."""

    of: str
    figures: tuple[Figure, ...]

    @property
    def rows(self) -> list[tuple[str, str, str, str]]:
        """Key, unit, symbol and meaning of each figure."""
        return [(figure.key, figure.unit, figure.symbol, figure.meaning) for figure in self.figures]

    @property
    def listing(self) -> Listing:
        """Table of the figures."""
        return Listing(self.of, REFERENCE_COLUMNS, self.rows)


def figure_groups(word: str = "") -> list[FigureGroup]:
    """Return all declared figures whose key contains a `word`, by answers; nothing is solved."""
    kinds = sorted(declaring(), key=lambda kind: (_rank(kind.__module__), kind.__module__))
    groups = (FigureGroup(_first_line(kind), _figures_with(kind, word)) for kind in kinds)
    return [group for group in groups if group.figures]


def figures_document(groups: list[FigureGroup]) -> dict[str, dict[str, list[dict[str, str]]]]:
    """Return the document of `describe --figures --json`."""
    return {
        "figures": {
            group.of: [dict(zip(REFERENCE_COLUMNS, row, strict=True)) for row in group.rows] for group in groups
        }
    }


def declaring() -> list[type[Figures]]:
    """Return all kinds of figures that the packages declare, in the order of their declaration."""
    for package in FIGURE_PACKAGES:
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
    """Return the rank of a module: answers first, then gear systems and studies."""
    return next(
        (k for k, package in enumerate(FIGURE_PACKAGES) if module.startswith(package.__name__)), len(FIGURE_PACKAGES)
    )


def _first_line(kind: type[Figures]) -> str:
    return (kind.__doc__ or kind.__name__).splitlines()[0].removesuffix(".")


def _figures_with(kind: type[Figures], word: str) -> tuple[Figure, ...]:
    """Return the figures of a kind whose key contains a word; figures of nested kinds are listed with these kinds."""
    return tuple(known for known in kind.declared_figures() if known.key and _is_meant(known, word))


def _is_meant(known: Figure, word: str) -> bool:
    """Return True if a word is part of the key of a figure, or names a column of the figure.

    Columns may have a prefix, the name of a member, the name of a coordinate, or the unit of the travel of a rack.
    """
    keys = [known.key, *([known.in_um().key] if known.unit == "arcsec" else [])]
    column = COORDINATE_SUFFIX.sub("", word) if known.vector else word
    patterns = [re.escape(key).replace(re.escape(MEMBER_PLACE), r"\w+") for key in keys if key != MEMBER_PLACE]
    return word in known.key or any(re.search(rf"(^|_){pattern}$", column) for pattern in patterns)
