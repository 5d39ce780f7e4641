"""STEP AP242 files of solids whose faces have names and colours; several solids make an assembly of placed parts.

Other modules make the OpenCASCADE shapes; this module composes the STEP file. STEP is not in the registry of formats, which
holds formats of meshes.
"""

from __future__ import annotations

import os
from dataclasses import replace
from datetime import UTC, datetime
from io import BytesIO
from pathlib import Path
from typing import Any

from gearmesh import __version__
from gearmesh.cad.occ import location, mapped_shapes, shapes_as_bytes, shapes_from_bytes
from gearmesh.cad.part21 import basic_alphabet, condense
from gearmesh.cad.programs.requirements import require
from gearmesh.errors import OutputError
from gearmesh.io.atomic import PathLike, whole_file
from gearmesh.io.palette import region_colours
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.records import dataclass

#: setting of the writer: AP242
_SCHEMA_SETTINGS = {"write.step.schema": "AP242DIS"}
#: settings of the writer: names of faces, and parameter curves of edges. Parameter curves make files a third larger, but readers
#: that project edges themselves fail at the singular corner of a flank where undercut begins
_SWITCH_SETTINGS = {"write.stepcaf.subshapes.name": 1, "write.surfacecurve.mode": 1}
#: unit of length of all documents
MM_IN_METRES = 1e-3


@dataclass(frozen=True)
class NamedFace:
    """A TopoDS_Face with its name in the file."""

    #: TopoDS_Face
    shape: Any
    #: name in the file
    name: str
    #: region, by which the face is coloured
    region: str
    #: number of faces of the part that are this face turned about the axis, itself included; 0 for the turned copies
    copies: int = 1
    #: number of the tooth that has the face, from 1; None for faces of the body
    tooth: int | None = None


@dataclass(frozen=True)
class Part:
    """A named solid, or open shells, with all faces."""

    #: name in the file
    name: str
    #: TopoDS_Solid, or TopoDS_Compound of open shells
    solid: Any
    #: all faces
    faces: tuple[NamedFace, ...]
    #: regions that have a colour each
    regions: tuple[str, ...]
    #: True for a solid, False for open shells
    closed: bool = True

    def move(self, place: Rigid) -> Part:
        """Return the part in another frame.

        `place`: from its own frame to the other one.
        """
        there = location(place)
        faces = tuple(replace(face, shape=face.shape.Moved(there)) for face in self.faces)
        return replace(self, solid=self.solid.Moved(there), faces=faces)

    def __reduce__(self) -> tuple[Any, ...]:
        labels = [(face.name, face.region, face.copies, face.tooth) for face in self.faces]
        content = shapes_as_bytes([self.solid, *(face.shape for face in self.faces)])
        return _part_from_bytes, (self.name, content, labels, self.regions, self.closed)


def _part_from_bytes(
    name: str, content: bytes, labels: list[tuple[str, str, int, int | None]], regions: tuple[str, ...], closed: bool
) -> Part:
    """Return the part that `Part.__reduce__` has taken apart."""
    from OCP.TopoDS import TopoDS

    solid, *shapes = shapes_from_bytes(content)
    faces = tuple(NamedFace(TopoDS.Face(shape), *label) for shape, label in zip(shapes, labels, strict=True))
    return Part(name, solid, faces, regions, closed)


@dataclass(frozen=True)
class Occurrence:
    """A part in an assembly, with its name there and its position (part's frame to common frame)."""

    name: str
    part: Part
    place: Rigid


@dataclass(frozen=True)
class PartAssembly:
    """Parts in a common frame, which may occur several times."""

    name: str
    occurrences: tuple[Occurrence, ...]

    @property
    def parts(self) -> tuple[Part, ...]:
        """All parts, each once."""
        return tuple({id(occurrence.part): occurrence.part for occurrence in self.occurrences}.values())

    @property
    def colours(self) -> tuple[tuple[float, float, float], ...]:
        """sRGB colours of the occurrences; occurrences of one part have the same colour."""
        parts = self.parts
        palette = dict(zip(map(id, parts), region_colours(len(parts)), strict=True))
        return tuple(palette[id(occurrence.part)] for occurrence in self.occurrences)


def own_copy(part: Part, name: str) -> Part:
    """Return a copy of a part under another name, which shares no shape with it."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
    from OCP.TopoDS import TopoDS

    copy = BRepBuilderAPI_Copy(part.solid)
    faces = tuple(replace(face, shape=TopoDS.Face(copy.ModifiedShape(face.shape))) for face in part.faces)
    return replace(part, name=name, solid=copy.Shape(), faces=faces)


def faces_after(operation: Any, solid: Any, sources: tuple[NamedFace, ...]) -> tuple[NamedFace, ...]:
    """Return the faces of a solid made by an operation on others, each with the name of the face that it is part of."""
    from OCP.TopoDS import TopoDS

    faces, named = mapped_shapes(solid, "FACE"), []
    for source in sources:
        pieces = list(operation.Modified(source.shape)) or [source.shape]
        places = [faces.FindIndex(piece) for piece in pieces if faces.Contains(piece)]
        for number, place in enumerate(places, 1):
            name = source.name if number == 1 else f"{source.name}_piece_{number}"
            named.append(NamedFace(TopoDS.Face(faces.FindKey(place)), name, source.region, tooth=source.tooth))
    return tuple(named)


def require_occ() -> None:
    """Raise OutputError with the package to install if OpenCASCADE cannot be loaded."""
    require("OCP.STEPCAFControl", "STEP needs OpenCASCADE", "step")


def write_step(made: Part | PartAssembly, path: PathLike, description: str) -> None:
    """Write one part in its own frame, or an assembly, whose file has each part once.

    Lengths are in mm; `description` is written in the header. Raises OutputError for a file that cannot be written, and without
    OpenCASCADE.
    """
    require_occ()
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Writer

    _silence()
    document = _document(made)
    _configure()
    writer = STEPCAFControl_Writer()
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    if not writer.Transfer(document):
        raise OutputError("cannot write", path, reason="OpenCASCADE does not translate the solid")
    _write_header(writer.ChangeWriter().Model(), Path(path).name, description)
    # write to memory first: OpenCASCADE does not report why a file cannot be written
    stream = BytesIO()
    if writer.WriteStream(stream) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise OutputError("cannot write", path, reason="OpenCASCADE does not write the file")
    # OpenCASCADE returns the bytes of names unchanged
    text = condense(stream.getvalue().decode("latin-1"))
    with whole_file(path) as temporary:
        temporary.write_bytes(text.encode("latin-1"))


def _silence() -> None:
    """Suppress OpenCASCADE's statistics on standard output."""
    from OCP.Message import Message

    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)


def _configure() -> None:
    """Set the global settings of the writer.

    They exist only after a first writer has been made; OpenCASCADE 7.8 uses them from the next writer on.
    """
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Writer

    STEPCAFControl_Writer()
    accepted = [Interface_Static.SetCVal_s(name, value) for name, value in _SCHEMA_SETTINGS.items()]
    accepted += [Interface_Static.SetIVal_s(name, value) for name, value in _SWITCH_SETTINGS.items()]
    if not all(accepted):
        raise OutputError(reason="this OpenCASCADE does not know AP242 with named faces: install version 7.8 or later")


def _document(made: Part | PartAssembly) -> Any:
    """Return a document with all parts, names and colours of their faces, and the assembly if there is one."""
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("gearmesh"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, MM_IN_METRES)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    if isinstance(made, Part):
        _add_part(made, region_colours(1)[0], shapes, colours)
        return document
    palette = region_colours(len(made.parts))
    labels = {id(part): _add_part(part, own, shapes, colours) for part, own in zip(made.parts, palette, strict=True)}
    assembly = shapes.NewShape()
    _name(assembly, made.name)
    for occurrence in made.occurrences:
        component = shapes.AddComponent(assembly, labels[id(occurrence.part)], location(occurrence.place))
        _name(component, occurrence.name)
    shapes.UpdateAssemblies()
    return document


def _add_part(part: Part, own_colour: tuple[float, float, float], shapes: Any, colours: Any) -> Any:
    """Add a part with names and colours to a document, and return its label.

    The solid has its own colour for readers with one colour per part, which would take the colour of a face otherwise.
    """
    from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
    from OCP.XCAFDoc import XCAFDoc_ColorType

    def paint(item: Any, colour: tuple[float, float, float]) -> None:
        painted = Quantity_Color(*colour, Quantity_TypeOfColor.Quantity_TOC_sRGB)
        colours.SetColor(item, painted, XCAFDoc_ColorType.XCAFDoc_ColorSurf)

    label = shapes.AddShape(part.solid, False)
    _name(label, part.name)
    paint(label, own_colour)
    palette = dict(zip(part.regions, region_colours(len(part.regions)), strict=True))
    for face in part.faces:
        own = shapes.AddSubShape(label, face.shape)
        _name(own, face.name)
        paint(own, palette[face.region])
    return label


def _name(label: Any, name: str) -> None:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    TDataStd_Name.Set_s(label, TCollection_ExtendedString(basic_alphabet(name)))


def _write_header(model: Any, name: str, description: str) -> None:
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.TCollection import TCollection_HAsciiString

    header = APIHeaderSection_MakeHeader(model)
    header.SetDescriptionValue(1, TCollection_HAsciiString(basic_alphabet(description)))
    header.SetName(TCollection_HAsciiString(basic_alphabet(name)))
    header.SetTimeStamp(TCollection_HAsciiString(_time_stamp()))
    header.SetOriginatingSystem(TCollection_HAsciiString(f"gearmesh {__version__}"))
    # clear the default texts, as "Author"
    for clear in (header.SetAuthorValue, header.SetOrganizationValue):
        clear(1, TCollection_HAsciiString(""))
    header.SetAuthorisation(TCollection_HAsciiString(""))


def _time_stamp() -> str:
    """Return the time of SOURCE_DATE_EPOCH, by default the beginning of 1970: the same command writes the same bytes."""
    seconds = os.environ.get("SOURCE_DATE_EPOCH", "0")
    try:
        return datetime.fromtimestamp(int(seconds), UTC).strftime("%Y-%m-%dT%H:%M:%S")
    except (ValueError, OverflowError, OSError):
        raise OutputError("SOURCE_DATE_EPOCH", seconds, must_be="a number of seconds since 1970") from None
