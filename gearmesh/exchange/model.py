"""A REXS model: components with attributes, relations between components, and load cases [REXS 1.7]."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

#: text of a value as a file has it, rows of them, or rows of rows
Text = str | list[str] | list[list[str]]

#: versions that are read, and the one that is written
VERSIONS = tuple(f"1.{minor}" for minor in range(8))
WRITTEN = VERSIONS[-1]

#: what begins the names of attributes that the format does not know and this program writes
OWN = "custom_gearmesh_"


@dataclass
class Attribute:
    """A value in a unit; `type`: the name that JSON has for its type, "" if the file does not say.

    `code`: that of encoded numbers, whose `text` is one string; `shape`: rows and columns of a matrix of them. `old_id`: its name
    in a file of an earlier version; `moved_from`: the component that has it in that file, if it is another one.
    """

    id: str
    text: Text
    unit: str = "none"
    type: str = ""
    code: str = ""
    shape: tuple[str, str] | None = None
    old_id: str = ""
    moved_from: str = ""

    @property
    def name(self) -> str:
        """Its name in the file."""
        return self.old_id or self.id


@dataclass
class Component:
    """A part, or data of one; `old_type`: its type in a file of an earlier version."""

    id: str
    type: str
    name: str = ""
    attributes: dict[str, Attribute] = field(default_factory=dict)
    old_type: str = ""

    def __str__(self) -> str:
        """Type and id, as the file has them."""
        return f"{self.old_type or self.type} {self.id}"

    @property
    def in_full(self) -> str:
        """Type, id and name, for refusals."""
        return f'{self} "{self.name}"' if self.name else str(self)


@dataclass
class ComponentReference:
    """A component in a relation; `hint`: its type."""

    role: str
    id: str
    hint: str = ""


@dataclass
class Relation:
    """Components that belong together, each in its role."""

    id: str
    type: str
    references: list[ComponentReference]
    order: str = ""

    def in_role(self, role: str) -> str | None:
        """Id of the component in a role, None if none is."""
        return next((one.id for one in self.references if one.role == role), None)


@dataclass
class LoadCase:
    """Attributes of components under one load; of the id "" those accumulated over all cases. `spectrum`: id of the spectrum."""

    id: str
    components: list[Component]
    spectrum: str = ""


@dataclass
class RexsModel:
    """All that a file says."""

    version: str = WRITTEN
    application: str = ""
    application_version: str = ""
    date: str = ""
    relations: list[Relation] = field(default_factory=list)
    components: list[Component] = field(default_factory=list)
    spectrum: str = ""
    load_cases: list[LoadCase] = field(default_factory=list)
    language: str = ""

    def component(self, id: str | None) -> Component | None:
        """The component that has an id."""
        return next((one for one in self.components if one.id == id), None)

    def relations_of(self, type: str, role: str, id: str) -> Iterator[Relation]:
        """Relations of a type in which a component has a role."""
        return (one for one in self.relations if one.type == type and one.in_role(role) == id)
