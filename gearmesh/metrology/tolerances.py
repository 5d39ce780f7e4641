"""Tolerances of a gear for a class of a standard, and the class of measured deviations.

    tolerance of class A = round(tolerance of the reference class R x sqrt(2)^(A - R))

A figure is within a class if its amount does not exceed the rounded tolerance [rounding: ISO 1328-1:2013 5.2.3;
ISO 17485:2006 5.3]. The class of a figure is the finest class that it is within.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar

from gearmesh.records import dataclass

#: um, below which tolerances are rounded to 0.1 um
MAX_TENTH_UM = 5.0
#: decimals of a tolerance in steps of its rounding; further ones are rounding of computed numbers
STEP_DIGITS = 9
#: um, up to which larger tolerances are rounded to 0.5 um; beyond, to 1 um
MAX_HALF_UM = 10.0


def round_tolerance(tolerance: float) -> float:
    """Round a tolerance (um): to 0.1 below 5 um, to 0.5 up to 10 um, to 1 beyond; halves are rounded up."""
    step = 0.1 if tolerance < MAX_TENTH_UM else 0.5 if tolerance <= MAX_HALF_UM else 1.0
    # a tenth has no exact binary value: a half is one within rounding, and the result is the number that prints as the tolerance
    return round(math.floor(round(tolerance / step, STEP_DIGITS) + 0.5) * step, 1)


#: end of a tolerance's symbol, after the symbol of the deviation
TOLERANCE_SUFFIX = "T"
#: um by which rounding errors may exceed a tolerance
ROUNDING_UM = 1e-6


class ToleranceSizes(ABC):
    """Sizes of a gear from which its tolerances follow."""

    #: designation of the standard
    standard: ClassVar[str]
    #: names of the deciding tolerances, by symbol, in the order of the standard
    names: ClassVar[Mapping[str, str]]
    #: names of tolerances that do not decide the class of the gear
    informative: ClassVar[Mapping[str, str]]
    #: finest and coarsest class
    classes: ClassVar[tuple[int, int]]
    #: class of `reference_values`
    reference: ClassVar[int]
    #: diameter (mm) of the circle on which pitch deviations are measured
    diameter: float

    @property
    @abstractmethod
    def known(self) -> bool:
        """True if the sizes are in the range of the standard."""

    @property
    @abstractmethod
    def reference_values(self) -> tuple[float, ...]:
        """Tolerances (um) of the reference class: those in `names`, then the informative ones."""

    def tolerances(self, tolerance_class: int) -> dict[str, float] | None:
        """Return tolerances (um) of a class by their symbols; None beyond the range of the standard."""
        if not self.known:
            return None
        # exact for even class differences, so that halves are rounded as halves
        factor = 2.0 ** (0.5 * (tolerance_class - self.reference))
        symbols = (*self.names, *self.informative)
        return {
            symbol: round_tolerance(factor * value)
            for symbol, value in zip(symbols, self.reference_values, strict=True)
        }


@dataclass(frozen=True)
class FigureClass:
    """Class of one measured deviation."""

    #: symbol of the deviation
    symbol: str
    #: name of the deviation
    name: str
    #: measured deviation, um
    deviation: float
    #: tolerance of the class, um; of the coarsest class if the figure has none
    tolerance: float
    #: class; None if the deviation exceeds the coarsest class
    tolerance_class: int | None
    #: True if it counts for the class of the gear
    decides: bool


@dataclass(frozen=True)
class GearClass:
    """Classes of all deviations of a gear, in the order of the standard."""

    standard: str
    figures: tuple[FigureClass, ...]

    @property
    def deciding(self) -> tuple[FigureClass, ...]:
        """Figures that decide the class of the gear."""
        return tuple(figure for figure in self.figures if figure.decides)

    @property
    def overall(self) -> int | None:
        """Coarsest class of the deciding figures; None if one of them has no class, or none was measured."""
        classes = [figure.tolerance_class for figure in self.deciding]
        known = [number for number in classes if number is not None]
        return max(known) if known and len(known) == len(classes) else None

    @property
    def limiting(self) -> tuple[str, ...]:
        """Symbols of the figures that limit the class of the gear: those of this class, or those without a class."""
        return tuple(figure.symbol for figure in self.deciding if figure.tolerance_class == self.overall)


def class_of(sizes: ToleranceSizes, deviations: Mapping[str, float]) -> GearClass | None:
    """Return the class of a gear with measured `deviations`, um, by their symbols (without the T of tolerances).

    Deviations that the standard does not have are ignored. The result is None beyond the range of the standard.
    """
    finest, coarsest = sizes.classes
    by_class = {number: sizes.tolerances(number) or {} for number in range(finest, coarsest + 1)}
    if not sizes.known:
        return None
    figures = []
    for symbol, name in {**sizes.names, **sizes.informative}.items():
        deviation = deviations.get(symbol.removesuffix(TOLERANCE_SUFFIX))
        if deviation is None:
            continue
        figure_class = next(
            (number for number, tolerances in by_class.items() if abs(deviation) <= tolerances[symbol] + ROUNDING_UM),
            None,
        )
        limit = by_class[coarsest if figure_class is None else figure_class][symbol]
        figures.append(
            FigureClass(
                symbol.removesuffix(TOLERANCE_SUFFIX),
                name,
                deviation,
                limit,
                figure_class,
                symbol not in sizes.informative,
            )
        )
    return GearClass(sizes.standard, tuple(figures))
