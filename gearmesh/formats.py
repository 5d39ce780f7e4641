"""Table of all file formats: what a file holds, which commands write and read it, what must be installed besides.

Suffixes are written only here; `gearmesh formats` prints the table.
To add a format, add its suffix and its row, and write its module.
"""

from __future__ import annotations

from pathlib import Path

from gearmesh.errors import OutputError
from gearmesh.records import dataclass

# ---------------------------------------------------------------- suffixes

TOML_SUFFIX = ".toml"
JSON_SUFFIX = ".json"
CSV_SUFFIX = ".csv"
TEXT_SUFFIX = ".txt"
PARQUET_SUFFIX = ".parquet"
STL_SUFFIX = ".stl"
PLY_SUFFIX = ".ply"
OBJ_SUFFIX = ".obj"
THREEMF_SUFFIX = ".3mf"
GLB_SUFFIX = ".glb"
VTP_SUFFIX = ".vtp"
VTU_SUFFIX = ".vtu"
VTM_SUFFIX = ".vtm"
STEP_SUFFIX = ".step"
STP_SUFFIX = ".stp"
DXF_SUFFIX = ".dxf"
SVG_SUFFIX = ".svg"
PDF_SUFFIX = ".pdf"
PNG_SUFFIX = ".png"
#: compression of pictures as PNG, of 9: 6 takes half as long again for an eighth less
PNG_COMPRESSION_LEVEL = 4
GIF_SUFFIX = ".gif"
MP4_SUFFIX = ".mp4"
HTML_SUFFIX = ".html"
INP_SUFFIX = ".inp"
MSH_SUFFIX = ".msh"
CDB_SUFFIX = ".cdb"
BDF_SUFFIX = ".bdf"
K_SUFFIX = ".k"
MED_SUFFIX = ".med"
COMM_SUFFIX = ".comm"
CLS_SUFFIX = ".cls"
MACRO_SUFFIX = ".FCMacro"
REXS_XML_SUFFIX = ".rexs"
REXS_JSON_SUFFIX = ".rexsj"
REXS_ZIP_SUFFIX = ".rexsz"
#: versions of DXF files, the oldest first; the default is the oldest with splines, which most programs read
DXF_VERSIONS = ("R12", "R2000", "R2004", "R2007", "R2010", "R2013", "R2018")
DEFAULT_DXF_VERSION = "R2000"
#: version that has no splines and no lightweight polylines
DXF_VERSION_WITHOUT_SPLINES = "R12"

# ---------------------------------------------------------------- groups that one command, or one answer, writes

#: CAD solids
STEP_SUFFIXES = (STEP_SUFFIX, STP_SUFFIX)
#: sections
SECTION_SUFFIXES = (DXF_SUFFIX, SVG_SUFFIX)
#: workshop drawings
DRAWING_SUFFIXES = (PDF_SUFFIX, SVG_SUFFIX, PNG_SUFFIX)
#: diagrams: plots, and charts of measured gears
DIAGRAM_SUFFIXES = (PNG_SUFFIX, SVG_SUFFIX, PDF_SUFFIX)
#: nominal points of flanks
POINT_SUFFIXES = (CSV_SUFFIX, TEXT_SUFFIX)
#: passes of a cutter
TOOL_PATH_SUFFIXES = (CLS_SUFFIX, CSV_SUFFIX, VTP_SUFFIX)
#: gear data for other programs
REXS_SUFFIXES = (REXS_XML_SUFFIX, REXS_JSON_SUFFIX, REXS_ZIP_SUFFIX)

# ---------------------------------------------------------------- table


@dataclass(frozen=True)
class FileFormat:
    """Format of the files of some suffixes; a suffix with several kinds of contents has several rows."""

    #: suffixes, the usual one first
    suffixes: tuple[str, ...]
    #: contents, with unit and precision of the numbers
    holds: str
    #: commands that write such a file
    writers: tuple[str, ...] = ()
    #: commands that read such a file, "all" for every command that takes a design
    readers: tuple[str, ...] = ()
    #: extra of the package that writing or reading takes, "" if none
    extra: str = ""


_MESH_WRITERS = ("solid", "gear")
#: contents of mesh files, by suffix
_MESH_CONTENTS = {
    GLB_SUFFIX: "binary glTF, metres, float32, a coloured primitive for each region",
    OBJ_SUFFIX: "Wavefront OBJ, mm, text with seven decimals, a group for each region",
    PLY_SUFFIX: "binary PLY, mm, float64, faces by region",
    STL_SUFFIX: "binary STL, mm, float32, no regions",
    THREEMF_SUFFIX: "3MF, millimetre, seven decimals, a base material for each region",
    VTP_SUFFIX: "VTK surface, mm, float64, regions and exact normals of the cells",
    VTU_SUFFIX: "VTK unstructured grid, mm, float64, regions and exact normals of the cells",
    VTM_SUFFIX: "VTK multi-block, mm, float64, a block for each region (pieces in a folder beside)",
}
FILE_FORMATS = (
    FileFormat(
        (TOML_SUFFIX,),
        "design: the keys of a gear system",
        ("new", "pin", "size", "gear", "settings", "correct", "convert", "optimize"),
        ("all",),
    ),
    FileFormat((JSON_SUFFIX,), "design, keys as in TOML", (), ("all",)),
    FileFormat(
        (JSON_SUFFIX,),
        "figures of an answer, with units in their keys",
        (
            *("tca", "load", "check", "fe", "limits", "topography", "grid", "evaluate", "composite", "correct"),
            *("toolpath", "settings", "vh", "study", "describe", "prove", "run", "solid", "optimize"),
        ),
    ),
    FileFormat((CSV_SUFFIX,), "one row for each position of the mesh", ("tca", "load", "composite")),
    FileFormat((CSV_SUFFIX,), "one row for each assembly or design", ("study", "optimize")),
    FileFormat((CSV_SUFFIX,), "amounts of modifications over a flank, mm", ("topography", "correct"), ("all",)),
    FileFormat(POINT_SUFFIXES, "nominal points and unit normals of flanks, mm", ("grid",), ("evaluate", "correct")),
    FileFormat((CSV_SUFFIX,), "positions and axes of a cutter, mm", ("toolpath",)),
    FileFormat((CSV_SUFFIX,), "names of the faces of a CAD solid", ("solid",)),
    FileFormat((PARQUET_SUFFIX,), "one row for each assembly or design", ("study",), (), "study"),
    *(FileFormat((suffix,), f"solid: {holds}", _MESH_WRITERS) for suffix, holds in _MESH_CONTENTS.items()),
    FileFormat(STEP_SUFFIXES, "CAD solids, mm, faces and solids with names", _MESH_WRITERS, (), "step"),
    FileFormat((DXF_SUFFIX,), "section as arcs and splines, mm", _MESH_WRITERS, (), "cad"),
    FileFormat((SVG_SUFFIX,), "section as curves, mm", _MESH_WRITERS),
    FileFormat(DRAWING_SUFFIXES, "workshop drawing", ("drawing",)),
    FileFormat((PNG_SUFFIX,), "picture", ("render", "fe", "toolpath", "run")),
    FileFormat((GIF_SUFFIX,), "animation of the mesh", ("render",)),
    FileFormat((MP4_SUFFIX,), "animation of the mesh, by the program ffmpeg", ("render",)),
    FileFormat(DIAGRAM_SUFFIXES, "diagram, or chart of a measured gear", ("render", "grid", "evaluate", "composite")),
    FileFormat((HTML_SUFFIX,), "page with all results, in one file", ("report", "run")),
    FileFormat((INP_SUFFIX,), "finite-element model for CalculiX or Abaqus, mm", ("fe",)),
    FileFormat((MSH_SUFFIX,), "finite-element mesh for Gmsh 4.1, mm", ("fe",)),
    FileFormat(
        (VTU_SUFFIX,), "finite-element mesh for VTK, mm; with --solve displacements, stresses, pressure", ("fe",)
    ),
    FileFormat((CDB_SUFFIX,), "finite-element model for Ansys Mechanical APDL, mm", ("fe",)),
    FileFormat((BDF_SUFFIX,), "finite-element model for Nastran (SOL 101, Simcenter), mm", ("fe",)),
    FileFormat((K_SUFFIX,), "finite-element model for LS-DYNA (implicit), mm", ("fe",)),
    FileFormat(
        (MED_SUFFIX,), "finite-element model for Code_Aster, mm; its commands (.comm) beside it", ("fe",), (), "med"
    ),
    FileFormat((VTU_SUFFIX,), "ease-off map over a flank, mm", ("tca",)),
    FileFormat((CLS_SUFFIX,), "cutter locations of a tool path, mm", ("toolpath",)),
    FileFormat((VTP_SUFFIX,), "tool path as lines, mm", ("toolpath",)),
    FileFormat(REXS_SUFFIXES, "gear data as REXS: XML, JSON, zipped", ("convert",), ("convert",)),
    FileFormat((MACRO_SUFFIX,), "FreeCAD macro: a feature with the keys of the design", ("freecad",)),
)


#: headings of `format_row`
FORMAT_COLUMNS = ("suffix", "contents", "written by", "read by", "needs")


def format_row(entry: FileFormat) -> tuple[str, str, str, str, str]:
    """Return a format as texts for a table."""
    readers = ("every command with a design" if one == "all" else one for one in entry.readers)
    extra = entry.extra and f"gearmesh[{entry.extra}]"
    return " ".join(entry.suffixes), entry.holds, ", ".join(entry.writers), ", ".join(readers), extra


def mesh_contents(suffix: str) -> str:
    """Return the contents of a mesh file of a suffix, as text."""
    return _MESH_CONTENTS[suffix]


#: largest number of suffixes that a message joins by "or"
MAX_JOINED_SUFFIXES = 3


def refuse_suffix(path: Path, *suffixes: str) -> None:
    """Raise OutputError for a file whose suffix, in any case, is not one of `suffixes`."""
    if path.suffix.lower() in map(str.lower, suffixes):
        return
    few = len(suffixes) <= MAX_JOINED_SUFFIXES
    must_be = " or ".join(suffixes) if few else f"one of {', '.join(suffixes)}"
    raise OutputError("cannot write", path, reason=f"its suffix must be {must_be}")
