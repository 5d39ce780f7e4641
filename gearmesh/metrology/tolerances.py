"""Tolerances of one gear by the class of a standard, and the class that measured deviations have.

    tolerance of class A = round(tolerance of the reference class R x sqrt(2)^(A - R))

A figure is within a class where its amount is not above the rounded tolerance; its own class is the finest that it is within.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from gearmesh.metrology.tolerance_rounding import round_tolerance

#: what a symbol of a deviation has at its end as that of its tolerance
TOLERANCE = "T"
#: um that are rounding, not deviation
ROUNDING = 1e-6


class ToleranceSizes(ABC):
    """The sizes of a gear that its tolerances follow from.

    `standard`: that has them; `names`: what tolerances are called, by symbol, in the standard's order; `informative`: those
    that do not decide the class of the gear; `classes`: finest and coarsest; `reference`: the class of `reference_values`.
    """

    standard: ClassVar[str]
    names: ClassVar[Mapping[str, str]]
    informative: ClassVar[Mapping[str, str]]
    classes: ClassVar[tuple[int, int]]
    reference: ClassVar[int]
    #: circle (mm) on which pitch deviations are measured
    diameter: float

    @property
    @abstractmethod
    def known(self) -> bool:
        """Whether the sizes are in the range of the standard."""

    @property
    @abstractmethod
    def reference_values(self) -> tuple[float, ...]:
        """Tolerances (um) of the reference class, those named first, then the informative ones."""

    def tolerances(self, tolerance_class: int) -> dict[str, float] | None:
        """Tolerances (um) by their symbols; None beyond the range of the standard."""
        if not self.known:
            return None
        # exact where it is a whole power of 2: halves are halves
        factor = 2.0 ** (0.5 * (tolerance_class - self.reference))
        symbols = (*self.names, *self.informative)
        return {
            symbol: round_tolerance(factor * value)
            for symbol, value in zip(symbols, self.reference_values, strict=True)
        }


@dataclass(frozen=True)
class FigureClass:
    """The class of a deviation `symbol`, um; None: coarser than any. `tolerance` (um) is that of the class, of the coarsest
    where there is none; `decides`: whether it counts for the class of the gear."""

    symbol: str
    name: str
    deviation: float
    tolerance: float
    tolerance_class: int | None
    decides: bool


@dataclass(frozen=True)
class GearClass:
    """The classes of all deviations of a gear, in the order of the standard."""

    standard: str
    figures: tuple[FigureClass, ...]

    @property
    def deciding(self) -> tuple[FigureClass, ...]:
        """The figures that decide the class of the gear."""
        return tuple(own for own in self.figures if own.decides)

    @property
    def overall(self) -> int | None:
        """The coarsest class of those that decide; None where one has no class, or none was measured."""
        classes = [own.tolerance_class for own in self.deciding]
        known = [number for number in classes if number is not None]
        return max(known) if known and len(known) == len(classes) else None

    @property
    def limiting(self) -> tuple[str, ...]:
        """Symbols of the figures that limit it: those of its class, or those that have none."""
        return tuple(own.symbol for own in self.deciding if own.tolerance_class == self.overall)


def class_of(sizes: ToleranceSizes, deviations: Mapping[str, float]) -> GearClass | None:
    """The class of a gear with measured `deviations`, um, by their symbols (tolerances' without the T); others are neglected.

    None beyond the range of the standard.
    """
    finest, coarsest = sizes.classes
    by_class = {number: sizes.tolerances(number) or {} for number in range(finest, coarsest + 1)}
    if not sizes.known:
        return None
    figures = []
    for symbol, name in {**sizes.names, **sizes.informative}.items():
        deviation = deviations.get(symbol.removesuffix(TOLERANCE))
        if deviation is None:
            continue
        own = next((number for number, all_of in by_class.items() if abs(deviation) <= all_of[symbol] + ROUNDING), None)
        limit = by_class[coarsest if own is None else own][symbol]
        figures.append(
            FigureClass(symbol.removesuffix(TOLERANCE), name, deviation, limit, own, symbol not in sizes.informative)
        )
    return GearClass(sizes.standard, tuple(figures))
