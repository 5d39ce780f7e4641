"""STEP AP242 files of solids whose faces have names and colours; several solids make an assembly of placed parts.

What is written are OpenCASCADE shapes, made elsewhere; this module knows how a STEP file is put together. It is no
format of the registry, which holds meshes.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from io import BytesIO
from pathlib import Path
from typing import Any

from gearmesh import __version__
from gearmesh.cad.occ import location
from gearmesh.cad.part21 import basic_alphabet, condense
from gearmesh.cad.programs.requirements import require
from gearmesh.errors import OutputError
from gearmesh.io.atomic import PathLike, whole_file
from gearmesh.io.palette import region_colours
from gearmesh.kernel.motion.rigid import Rigid

#: settings of the writer: AP242, names on faces too, and every edge's curve on its faces: a third more file,
#: but readers that project instead go astray where undercut begins, where the flank has a singular corner
_SCHEMA = {"write.step.schema": "AP242DIS"}
_SWITCHES = {"write.stepcaf.subshapes.name": 1, "write.surfacecurve.mode": 1}
#: the unit of length of all documents
MM_IN_METRES = 1e-3


@dataclass(frozen=True)
class NamedFace:
    """A TopoDS_Face, its name in the file, and its region, by which it is coloured.

    `copies` counts the faces of the part that are this one turned about the axis, itself among them; 0 is one of these.
    `tooth` is the number of the tooth that has the face, from 1; None for faces of the body.
    """

    shape: Any
    name: str
    region: str
    copies: int = 1
    tooth: int | None = None


@dataclass(frozen=True)
class Part:
    """A named TopoDS_Solid with all its faces; `regions` are the regions that share out the colours.

    One that is not `closed` has a TopoDS_Compound of open shells instead.
    """

    name: str
    solid: Any
    faces: tuple[NamedFace, ...]
    regions: tuple[str, ...]
    closed: bool = True

    def move(self, place: Rigid) -> Part:
        """The same part in another frame.

        Parameters
        ----------
        place : Rigid
            From its own frame to the other one.

        Returns
        -------
        Part
            Its shapes are shared, not copied.

        Examples
        --------
        >>> part = gears.cad("pinion").made
        >>> part.move(gm.Rigid.about_z(0.5)).name
        'pinion'
        """
        there = location(place)
        faces = tuple(replace(face, shape=face.shape.Moved(there)) for face in self.faces)
        return replace(self, solid=self.solid.Moved(there), faces=faces)


@dataclass(frozen=True)
class Occurrence:
    """A part in an assembly: what it is called there, and where it is (its own frame to the common one)."""

    name: str
    part: Part
    place: Rigid


@dataclass(frozen=True)
class PartAssembly:
    """Parts in a common frame; a part may occur several times."""

    name: str
    occurrences: tuple[Occurrence, ...]

    @property
    def parts(self) -> tuple[Part, ...]:
        """Every part once."""
        return tuple({id(occurrence.part): occurrence.part for occurrence in self.occurrences}.values())

    @property
    def colours(self) -> tuple[tuple[float, float, float], ...]:
        """An sRGB colour for every occurrence, one for all of a part."""
        parts = self.parts
        palette = dict(zip(map(id, parts), region_colours(len(parts)), strict=True))
        return tuple(palette[id(occurrence.part)] for occurrence in self.occurrences)


def require_occ() -> None:
    """Raise OutputError, naming what to install, where OpenCASCADE cannot be loaded."""
    require("OCP.STEPCAFControl", "STEP needs OpenCASCADE", "step")


def write_step(made: Part | PartAssembly, path: PathLike, description: str) -> None:
    """Write one part in its own frame, or an assembly, which has each of its parts once, however often they occur.

    Lengths are mm; `description` goes into the header. Raises OutputError for a file that cannot be written and where
    OpenCASCADE is missing.
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
    # into memory: OpenCASCADE does not say why a file cannot be written
    stream = BytesIO()
    if writer.WriteStream(stream) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise OutputError("cannot write", path, reason="OpenCASCADE does not write the file")
    # names come in whatever bytes they went in
    text = condense(stream.getvalue().decode("latin-1"))
    with whole_file(path) as temporary:
        temporary.write_bytes(text.encode("latin-1"))


def _silence() -> None:
    """Take away OpenCASCADE's statistics on standard output."""
    from OCP.Message import Message

    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)


def _configure() -> None:
    """The settings are global and exist only after a writer has been made; OpenCASCADE 7.8 has them for the next one."""
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Writer

    STEPCAFControl_Writer()
    accepted = [Interface_Static.SetCVal_s(name, value) for name, value in _SCHEMA.items()]
    accepted += [Interface_Static.SetIVal_s(name, value) for name, value in _SWITCHES.items()]
    if not all(accepted):
        raise OutputError(reason="this OpenCASCADE does not know AP242 with named faces: install version 7.8 or later")


def _document(made: Part | PartAssembly) -> Any:
    """Document with every part, its faces' names and colours, and the assembly if it is one."""
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
    """Label of a part in a document, with names and colours.

    The solid has a colour of its own, for readers that have one colour a part: they took that of a face.
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
    # instead of "Author" and the like
    for clear in (header.SetAuthorValue, header.SetOrganizationValue):
        clear(1, TCollection_HAsciiString(""))
    header.SetAuthorisation(TCollection_HAsciiString(""))


def _time_stamp() -> str:
    """The time of SOURCE_DATE_EPOCH, else the beginning of 1970: the same command writes the same bytes."""
    seconds = os.environ.get("SOURCE_DATE_EPOCH", "0")
    try:
        return datetime.fromtimestamp(int(seconds), UTC).strftime("%Y-%m-%dT%H:%M:%S")
    except (ValueError, OverflowError, OSError):
        raise OutputError("SOURCE_DATE_EPOCH", seconds, must_be="a number of seconds since 1970") from None
