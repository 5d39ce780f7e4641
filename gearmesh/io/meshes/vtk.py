"""VTK XML files VTP (surface) and VTU (cells): float64, mm, with regions and the exact normals.

Cell data are `region` (number) and `Normals` (3). The field data have an entry for each region, with its name and number;
meshio refuses files with names as strings. Arrays are appended raw, little endian. This module writes and reads files
without VTK, which takes half a second to load. It reads only files of this form.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import BinaryIO
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from gearmesh.files.xml_tree import xml_root
from gearmesh.formats import VTP_SUFFIX, VTU_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.io.rebuild import built_mesh
from gearmesh.io.registry import Scene, register
from gearmesh.io.texts import quote
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.numerals import parse_whole_numbers

_TRIANGLE_CELL = 5  # VTK's number of the cell type
_XML_TYPES = {"<f8": "Float64", "<i8": "Int64", "<i4": "Int32", "|u1": "UInt8"}


class _Appended:
    """Arrays at the end of a file, and the XML elements that refer to them."""

    def __init__(self) -> None:
        self.blocks: list[bytes] = []
        self.offset = 0

    def array(self, name: str, data: NDArray[np.generic], dtype: str) -> str:
        """Append an array (N,) or (N, K) as `dtype`; return its <DataArray> element."""
        block = np.ascontiguousarray(data, dtype=dtype).tobytes()
        # meshio makes a column of numbers that say they have one component.
        width = f' NumberOfComponents="{data.shape[1]}"' if data.ndim == 2 else ""
        element = (
            f'<DataArray type="{_XML_TYPES[dtype]}" Name="{name}"{width} format="appended" offset="{self.offset}"/>\n'
        )
        self.blocks += [np.array(len(block), "<u8").tobytes(), block]
        self.offset += 8 + len(block)
        return element

    def write(self, file: BinaryIO, head: str) -> None:
        """Write the XML before the arrays (`head`), the arrays, and the end of the file."""
        file.write(head.encode())
        file.writelines(self.blocks)
        file.write(b"\n</AppendedData>\n</VTKFile>\n")


def _write_file(mesh: TriangleMesh, path: Path, dataset: str, cells: str) -> None:
    """Write a file of type `dataset` with the triangles in its element `cells` (Polys or Cells)."""
    count, data = len(mesh.triangles), _Appended()
    number = f"NumberOf{cells}"
    types = data.array("types", np.full(count, _TRIANGLE_CELL), "|u1") if cells == "Cells" else ""
    fields = "".join(
        f'<DataArray type="Int32" Name={quote(name)} NumberOfTuples="1" format="ascii">{i}</DataArray>\n'
        for i, name in enumerate(mesh.region_names)
    )
    of_points = "".join(data.array(key, array, "<f8") for key, array in mesh.vertex_data.items())
    point_data = f'<PointData Normals="Normals">\n{of_points}</PointData>\n' if of_points else ""
    text = (
        f'<?xml version="1.0"?>\n<VTKFile type="{dataset}" version="1.0" byte_order="LittleEndian"'
        f' header_type="UInt64">\n'
        f"<{dataset}>\n<FieldData>\n{fields}</FieldData>\n"
        f'<Piece NumberOfPoints="{len(mesh.vertices)}" {number}="{count}">\n'
        f"<Points>\n{data.array('Points', mesh.vertices, '<f8')}</Points>\n"
        f"<{cells}>\n{data.array('connectivity', mesh.triangles.ravel(), '<i8')}"
        f"{data.array('offsets', 3 * np.arange(1, count + 1), '<i8')}{types}</{cells}>\n"
        f"{point_data}"
        f'<CellData Scalars="region" Normals="Normals">\n{data.array("region", mesh.regions, "<i4")}'
        f"{data.array('Normals', mesh.normals, '<f8')}</CellData>\n"
        f'</Piece>\n</{dataset}>\n<AppendedData encoding="raw">\n_'
    )
    with open(path, "wb") as file:
        data.write(file, text)


def write_surface(mesh: TriangleMesh, path: Path) -> None:
    """Write a VTP straight to `path` (not by way of a temporary file)."""
    _write_file(mesh, path, "PolyData", "Polys")


def write_polylines(
    path: Path,
    points: NDArray[np.float64],
    lines: Sequence[NDArray[np.int64]],
    point_data: Mapping[str, NDArray[np.float64]],
    cell_data: Mapping[str, NDArray[np.int32]],
) -> None:
    """Write polylines as a VTP.

    - points: (K, 3), mm.
    - lines: indices of the points of each line.
    - point_data: vectors (K, 3) of the points by name.
    - cell_data: whole numbers (lines,) of the lines by name.
    """
    data = _Appended()
    offsets = np.cumsum([len(line) for line in lines])
    vectors = "".join(data.array(name, array, "<f8") for name, array in point_data.items())
    numbers = "".join(data.array(name, array, "<i4") for name, array in cell_data.items())
    text = (
        '<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        f'<PolyData>\n<Piece NumberOfPoints="{len(points)}" NumberOfLines="{len(lines)}">\n'
        f"<PointData>\n{vectors}</PointData>\n<CellData>\n{numbers}</CellData>\n"
        f"<Points>\n{data.array('Points', points, '<f8')}</Points>\n"
        f"<Lines>\n{data.array('connectivity', np.concatenate(lines), '<i8')}{data.array('offsets', offsets, '<i8')}</Lines>\n"
        '</Piece>\n</PolyData>\n<AppendedData encoding="raw">\n_'
    )
    with whole_file(path) as temporary, open(temporary, "wb") as file:
        data.write(file, text)


def write_vtp(scene: Scene, path: Path) -> None:
    """Write the only mesh of the scene as a surface."""
    (mesh,) = scene.values()
    with whole_file(path) as temporary:
        write_surface(mesh.whole(), temporary)


def write_vtu(scene: Scene, path: Path) -> None:
    """Write the only mesh of the scene as cells of an unstructured grid."""
    (mesh,) = scene.values()
    with whole_file(path) as temporary:
        _write_file(mesh.whole(), temporary, "UnstructuredGrid", "Cells")


def read_piece(path: Path) -> TriangleMesh:
    """Return the mesh of a VTP or VTU as this module writes it: one piece, arrays appended raw, no compression."""
    head, mark, rest = path.read_bytes().partition(b'<AppendedData encoding="raw">')
    if not mark or b" compressor=" in head:
        raise ValueError("its arrays are not appended raw and without compression")
    root = xml_root(head + b"</VTKFile>")
    if (root.get("header_type"), root.get("byte_order")) != ("UInt64", "LittleEndian"):
        raise ValueError("its arrays are not little endian with lengths of 64 bits")
    data = memoryview(rest)[rest.index(b"_") + 1 :]
    (piece,) = root.iter("Piece")
    arrays = {element.attrib["Name"]: _array(element, data) for element in piece.iter("DataArray")}
    count = _whole(piece.get("NumberOfPolys", piece.get("NumberOfCells", "0")))
    if not np.array_equal(arrays["offsets"], 3 * np.arange(1, count + 1)):
        raise ValueError("a cell is not a triangle")
    numbers = {
        element.attrib["Name"]: _whole(element.text or "") for element in root.iterfind(".//FieldData/DataArray")
    }
    names = tuple(sorted(numbers, key=numbers.__getitem__))
    cells = arrays["connectivity"], arrays["region"]
    return built_mesh(path.stem, arrays["Points"], *cells, names, arrays["Normals"])


def _whole(text: str) -> int:
    (value,) = parse_whole_numbers([text])
    return value


def _array(element: Element, data: memoryview) -> NDArray[np.generic]:
    """Return the array (N,) or (N, K) of a <DataArray>."""
    start = _whole(element.attrib["offset"])
    size = int.from_bytes(data[start : start + 8], "little")
    dtype = next(dtype for dtype, name in _XML_TYPES.items() if name == element.attrib["type"])
    width = _whole(element.get("NumberOfComponents", "1"))
    array = np.frombuffer(data, dtype, size // np.dtype(dtype).itemsize, start + 8)
    return array.reshape(-1, width) if width > 1 else array


def read(path: Path) -> dict[str, TriangleMesh]:
    """Return the mesh under the file's name."""
    return {path.stem: read_piece(path)}


register(VTP_SUFFIX, write_vtp, read)
register(VTU_SUFFIX, write_vtu, read)
