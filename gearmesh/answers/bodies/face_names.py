"""Names of the faces of a CAD file by their numbers, for readers that drop names."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gearmesh.answers.result import Result, StatedDesign, columns, header
from gearmesh.answers.tables import Listing, csv_text
from gearmesh.cad.occ import mapped_shapes
from gearmesh.cad.step import Part, PartAssembly
from gearmesh.figures import Content, Figures, figure
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region


@dataclass(frozen=True)
class FaceNameFigures(Figures):
    """A face of a CAD file: its number and its name."""

    face: int = figure("number of the face in the whole file, from 1", whole=True)
    member: str = figure("member that has the face")
    member_face: int = figure("number of the face in its member, from 1", whole=True)
    name: str = figure("name of the face")
    region: str = figure("region of the tooth or the body")
    side: str | None = figure("side of the tooth: right or left; none of other faces")
    tooth: int | None = figure("number of the tooth, the tooth on +x being 1; none of other faces", whole=True)


@dataclass(frozen=True, repr=False)
class FaceNames(Result):
    """Names of the faces of a STEP file, in the order in which readers number them.

    `face` is the surface tag in gmsh.
    """

    design: StatedDesign
    faces: tuple[FaceNameFigures, ...]

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, CSV_SUFFIX)

    @property
    def headline(self) -> str:
        return f"{len(self.faces)} faces"

    @property
    def listings(self) -> list[Listing]:
        head = list(self.to_dict())
        return [Listing("Faces", head, [[row.row[key] for key in head] for row in self.faces])]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([face.row for face in self.faces])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "faces": list(self.faces)}

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        whole_text(target, csv_text([face.row for face in self.faces]))


def face_names(design: StatedDesign, made: Part | PartAssembly) -> FaceNames:
    """Return the faces of a part, or of all occurrences of an assembly, in the order of the file."""
    occurrences = (
        [(made.name, made)]
        if isinstance(made, Part)
        else [(occurrence.name, occurrence.part) for occurrence in made.occurrences]
    )
    rows = list[FaceNameFigures]()
    for member, part in occurrences:
        order = mapped_shapes(part.solid, "FACE")
        for number, face in enumerate(
            sorted(part.faces, key=lambda occurrence: int(order.FindIndex(occurrence.shape))), 1
        ):
            region = Region(face.region)
            rows.append(FaceNameFigures(len(rows) + 1, member, number, face.name, region, region.side, face.tooth))
    return FaceNames(design, tuple(rows))
