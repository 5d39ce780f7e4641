"""Parameters of flanks under the names of their source, with unit and meaning."""

from __future__ import annotations

from collections.abc import Callable

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: endings of names that state the unit
UNIT_ENDINGS = {"mm": "_mm", "deg": "_deg"}


@dataclass(frozen=True)
class SourceParameter:
    """Declaration of a parameter of a flank."""

    #: name in JSON and CSV
    name: str
    #: unit; empty for a number without unit
    unit: str
    #: meaning in words
    meaning: str

    @property
    def label(self) -> str:
        """Name in tables, without the unit; names of several words have blanks."""
        ending = UNIT_ENDINGS.get(self.unit, "")
        if ending and self.name.endswith(ending):
            return self.name.removesuffix(ending).replace("_", " ")
        return self.name

    @property
    def heading(self) -> str:
        """Label and unit, as a table has them above a column."""
        return f"{self.label}, {self.unit}" if self.unit else self.label


@dataclass(frozen=True)
class NamedParameters:
    """Function from surface parameters to the parameters of the source, which it declares."""

    #: parameters in the order of the values
    declared: tuple[SourceParameter, ...]
    #: returns one array (...,) per parameter from the surface parameters p and v (...,)
    values: Callable[[Array, Array], tuple[Array, ...]]

    def __call__(self, p: Array, v: Array) -> dict[str, Array]:
        """Return the values (...,) by name."""
        return {parameter.name: value for parameter, value in zip(self.declared, self.values(p, v), strict=True)}
