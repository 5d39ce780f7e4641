"""A REXS model: components with attributes, relations between components, and load cases [REXS 1.7]."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field

from gearmesh.records import dataclass

#: text of a value as a file has it, rows of them, or rows of rows
Text = str | list[str] | list[list[str]]

#: versions that are read
READ_VERSIONS = tuple(f"1.{minor}" for minor in range(8))
#: version that is written
WRITTEN_VERSION = READ_VERSIONS[-1]

#: prefix of attributes that the format does not have and this program writes
OWN_PREFIX = "custom_gearmesh_"


@dataclass
class Attribute:
    """A value in a unit."""

    #: id in version 1.7
    id: str
    #: text of the value, rows of texts, or rows of rows
    text: Text
    #: unit of the value
    unit: str = "none"
    #: name of the type in JSON; "" if the file does not state it
    type: str = ""
    #: encoding of numbers, whose text is one string; "" if they are written out
    code: str = ""
    #: rows and columns of an encoded matrix
    shape: tuple[str, str] | None = None
    #: id in a file of an earlier version
    old_id: str = ""
    #: component that has the attribute in such a file, if it is another one
    moved_from: str = ""

    @property
    def name(self) -> str:
        """Id in the file."""
        return self.old_id or self.id


@dataclass
class Component:
    """A part, or data of a part."""

    #: id of the component
    id: str
    #: type in version 1.7
    type: str
    #: name of the component
    name: str = ""
    #: attributes by id
    attributes: dict[str, Attribute] = field(default_factory=dict)
    #: type in a file of an earlier version
    old_type: str = ""

    def __str__(self) -> str:
        """Return type and id, as in the file."""
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

    #: id of the relation
    id: str
    #: type of the relation
    type: str
    #: the components with their roles
    references: list[ComponentReference]
    #: position in a sequence; "" without one
    order: str = ""

    def in_role(self, role: str) -> str | None:
        """Return the id of the component in a role, None if there is none."""
        return next((one.id for one in self.references if one.role == role), None)


@dataclass
class LoadCase:
    """Attributes of components under one load; with the id "", accumulated over all load cases. `spectrum`: id of the
    spectrum.
    """

    id: str
    components: list[Component]
    spectrum: str = ""


@dataclass
class RexsModel:
    """Content of a file."""

    #: version of the format
    version: str = WRITTEN_VERSION
    #: id of the program that wrote it
    application: str = ""
    #: version of that program
    application_version: str = ""
    #: date of writing
    date: str = ""
    #: relations between components
    relations: list[Relation] = field(default_factory=list)
    #: components
    components: list[Component] = field(default_factory=list)
    #: id of the load spectrum
    spectrum: str = ""
    #: load cases, and the accumulation
    load_cases: list[LoadCase] = field(default_factory=list)
    #: language of the names
    language: str = ""

    def component(self, id: str | None) -> Component | None:
        """Return the component with an id, None if there is none."""
        return next((one for one in self.components if one.id == id), None)

    def relations_of(self, type: str, role: str, id: str) -> Iterator[Relation]:
        """Yield the relations of a type in which a component has a role."""
        return (one for one in self.relations if one.type == type and one.in_role(role) == id)
