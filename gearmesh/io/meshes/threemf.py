"""3MF: unit millimetre, seven decimals, an object for each mesh, regions as coloured base materials.

Follows the 3MF Core Specification 1.3: an Open Packaging zip with content types, one relationship and the model.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from gearmesh import __version__
from gearmesh.files.xml_tree import xml_root
from gearmesh.formats import THREEMF_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.io.palette import region_colours
from gearmesh.io.rebuild import built_mesh, by_name
from gearmesh.io.registry import Scene, register
from gearmesh.io.single import decimal_steps, in_decimals
from gearmesh.io.texts import lines, quote
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.numerals import parse_numbers, parse_whole_numbers

#: path of the model part in the archive
_MODEL_PATH = "3D/3dmodel.model"
#: namespace of the model
_CORE_NAMESPACE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
#: prefix of element names for the parser
_CORE_PREFIX = f"{{{_CORE_NAMESPACE}}}"
#: namespace of the parts of the archive
_PACKAGE_NAMESPACE = "http://schemas.openxmlformats.org/package/2006"
#: first line of each part
_XML_DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'
#: part with the content types of the archive
_CONTENT_TYPES = f"""{_XML_DECLARATION}<Types xmlns="{_PACKAGE_NAMESPACE}/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""
#: part that names the model part
_RELATIONSHIPS = f"""{_XML_DECLARATION}<Relationships xmlns="{_PACKAGE_NAMESPACE}/relationships">
<Relationship Id="model" Target="/{_MODEL_PATH}" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""


def write(scene: Scene, path: Path) -> None:
    """Write all meshes, each as an object of the build."""
    with (
        whole_file(path) as temporary,
        zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED, compresslevel=5) as archive,
    ):
        for part, pieces in (
            ("[Content_Types].xml", [_CONTENT_TYPES]),
            ("_rels/.rels", [_RELATIONSHIPS]),
            (_MODEL_PATH, _model(scene)),
        ):
            # An entry that is opened has zip's first date, so that the same mesh gives the same bytes; writestr would take
            # today's. force_zip64: the length of a streamed entry is not known when its header is written.
            with archive.open(part, "w", force_zip64=True) as entry:
                entry.writelines(piece.encode() for piece in pieces)


def _model(scene: Scene) -> Iterator[str]:
    """Yield the XML of the model part; resource 2k + 1 holds the materials and resource 2k + 2 the mesh of member k."""
    yield f'{_XML_DECLARATION}<model unit="millimeter" xml:lang="en-US" xmlns="{_CORE_NAMESPACE}">\n'
    yield f'<metadata name="Application">gearmesh {__version__}</metadata>\n<resources>\n'
    for k, (name, mesh) in enumerate(scene.items()):
        yield f'<basematerials id="{2 * k + 1}">\n'
        for region, colour in zip(mesh.region_names, region_colours(len(mesh.region_names)), strict=True):
            display = "".join(f"{round(255 * part):02X}" for part in colour)
            yield f'<base name={quote(region)} displaycolor="#{display}"/>\n'
        yield f'</basematerials>\n<object id="{2 * k + 2}" type="model" name={quote(name)}'
        yield f' pid="{2 * k + 1}" pindex="0"><mesh>\n<vertices>\n'
        for piece in mesh.vertex_pieces():
            yield from lines('<vertex x="%r" y="%r" z="%r"/>\n', piece)
        yield "</vertices>\n<triangles>\n"
        triangle = f'<triangle v1="%r" v2="%r" v3="%r" pid="{2 * k + 1}" p1="%r"/>\n'
        for triangles, regions in zip(mesh.triangle_pieces(), mesh.region_pieces(), strict=True):
            yield from lines(triangle, np.column_stack((triangles, regions)))
        yield "</triangles>\n</mesh></object>\n"
    items = "".join(f'<item objectid="{2 * k + 2}"/>\n' for k in range(len(scene)))
    yield f"</resources>\n<build>\n{items}</build>\n</model>\n"


def read(path: Path) -> dict[str, TriangleMesh]:
    """Return the mesh objects of a 3MF in mm; base materials are regions."""
    with zipfile.ZipFile(path) as archive:
        model = xml_root(archive.read(_MODEL_PATH))
    if model.get("unit", "millimeter") != "millimeter":
        raise ValueError("its unit is not millimeter")
    placed = any("transform" in item.attrib for item in model.iter(_CORE_PREFIX + "item"))
    if placed or next(model.iter(_CORE_PREFIX + "components"), None) is not None:
        raise ValueError("it places its meshes by components or transforms")
    groups = model.iter(_CORE_PREFIX + "basematerials")
    materials = {group.attrib["id"]: tuple(base.attrib["name"] for base in group) for group in groups}
    return by_name(_mesh(element, materials) for element in model.iter(_CORE_PREFIX + "object"))


def _mesh(element: Element, materials: dict[str, tuple[str, ...]]) -> TriangleMesh:
    """Return the mesh of an <object>; the base materials of the object are its regions."""
    triangles = list(element.iter(_CORE_PREFIX + "triangle"))
    corners = [t.attrib[key] for t in triangles for key in ("v1", "v2", "v3")]
    vertices = [v.attrib[key] for v in element.iter(_CORE_PREFIX + "vertex") for key in "xyz"]
    names = materials.get(element.get("pid", ""), ())
    default = element.get("pindex", "0")
    regions = parse_whole_numbers(t.get("p1", default) for t in triangles) if names else None
    name = element.get("name") or f"object {element.attrib['id']}"
    points, cells = np.array(parse_numbers(vertices)), np.array(parse_whole_numbers(corners))
    return built_mesh(name, points, cells, regions, names or ("surface",))


register(THREEMF_SUFFIX, write, read, in_decimals, decimal_steps)
