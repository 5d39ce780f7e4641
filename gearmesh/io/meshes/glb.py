"""Binary glTF 2.0 (GLB): float32 in metres, a node for each mesh, a coloured primitive for each region.

All primitives of a mesh share its vertices, so it stays one closed surface; without vertex normals glTF shades flat.
"""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh import __version__
from gearmesh.errors import OutputError
from gearmesh.files.reading import json_value
from gearmesh.formats import GLB_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.io.palette import region_colours
from gearmesh.io.rebuild import built_mesh, by_name
from gearmesh.io.registry import Scene, register
from gearmesh.io.single import in_single, steps
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import Facets, TriangleMesh

#: unit of glTF
_MM_PER_METRE = 1000.0
# numbers of the glTF 2.0 specification
_GLB_MAGIC = 0x46546C67
_JSON_CHUNK = 0x4E4F534A
_BINARY_CHUNK = 0x004E4942
_FLOAT_COMPONENT = 5126
_UNSIGNED_INT_COMPONENT = 5125
_VERTEX_BUFFER = 34962
_INDEX_BUFFER = 34963


class _Document:
    """A glTF document under construction: its JSON and the pieces of its binary buffer."""

    def __init__(self) -> None:
        self.pieces: list[bytes] = []
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": f"gearmesh {__version__}"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            **{key: [] for key in ("nodes", "meshes", "materials", "accessors", "bufferViews")},
        }

    def add(self, collection: str, entry: dict[str, Any]) -> int:
        """Append to a collection; return the index of the entry."""
        self.json[collection].append(entry)
        return len(self.json[collection]) - 1

    def array(self, data: NDArray[np.generic], target: int, accessor: dict[str, Any]) -> int:
        """Append an array of 4-byte numbers to the buffer; return the index of its accessor."""
        view = {"buffer": 0, "byteOffset": sum(map(len, self.pieces)), "byteLength": data.nbytes, "target": target}
        self.pieces.append(data.tobytes())
        return self.add("accessors", {"bufferView": self.add("bufferViews", view), **accessor})

    def mesh(self, name: str, mesh: TriangleMesh) -> None:
        """Append a mesh with its node."""
        points = (mesh.vertices / _MM_PER_METRE).astype("<f4")
        bounds = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
        shape = {"componentType": _FLOAT_COMPONENT, "type": "VEC3", "count": len(points), **bounds}
        position = self.array(points, _VERTEX_BUFFER, shape)
        primitives = []
        for i, colour in enumerate(region_colours(len(mesh.region_names))):
            indices = mesh.triangles[mesh.regions == i].astype("<u4")
            if not len(indices):
                continue
            shape = {"componentType": _UNSIGNED_INT_COMPONENT, "type": "SCALAR", "count": indices.size}
            index = self.array(indices, _INDEX_BUFFER, shape)
            material = self.add("materials", _material(mesh.region_names[i], colour))
            extras = {"region": i}
            primitives.append(
                {"attributes": {"POSITION": position}, "indices": index, "material": material, "extras": extras}
            )
        entry = {"name": name, "primitives": primitives, "extras": {"region_names": list(mesh.region_names)}}
        node = self.add("nodes", {"name": name, "mesh": self.add("meshes", entry)})
        self.json["scenes"][0]["nodes"].append(node)

    def pack(self) -> bytes:
        """Return the bytes of the file: header, JSON chunk and binary chunk, each padded to 4 bytes."""
        binary = b"".join(self.pieces)
        text = json.dumps({**self.json, "buffers": [{"byteLength": len(binary)}]}, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        head = struct.pack("<III", _GLB_MAGIC, 2, 28 + len(text) + len(binary))
        return (
            head
            + struct.pack("<II", len(text), _JSON_CHUNK)
            + text
            + struct.pack("<II", len(binary), _BINARY_CHUNK)
            + binary
        )


def _material(name: str, colour: tuple[float, float, float]) -> dict[str, Any]:
    # glTF takes linear colour factors; 2.2 is the usual approximation of the sRGB curve.
    linear = [round(part**2.2, 6) for part in colour]
    surface = {"baseColorFactor": [*linear, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.6}
    return {"name": name, "pbrMetallicRoughness": surface}


def mesh_in_file(mesh: Facets) -> Facets:
    """Return the mesh with the precision of the file; a closed mesh stays closed for readers that join equal vertices."""
    return in_single(mesh, _MM_PER_METRE)


def _steps(points: Array) -> Array:
    return steps(points, _MM_PER_METRE)


def write(scene: Scene, path: Path) -> None:
    """Write all meshes; coordinates keep their axes (glTF viewers show y upward)."""
    document = _Document()
    for name, mesh in scene.items():
        document.mesh(name, mesh.whole())
    with whole_file(path) as temporary:
        temporary.write_bytes(document.pack())


def read(path: Path) -> dict[str, TriangleMesh]:
    """Return the meshes of a GLB as this module writes it (plain accessors, nodes without transforms), in mm."""
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<III", data)
    if (magic, version, length) != (_GLB_MAGIC, 2, len(data)):
        raise ValueError("it is not a complete binary glTF 2.0")
    (size,) = struct.unpack_from("<I", data, 12)
    document = json_value(data[20 : 20 + size].decode("utf-8"), path, OutputError)
    binary = memoryview(data)[28 + size :]
    if any(key in node for node in document["nodes"] for key in ("matrix", "translation", "rotation", "scale")):
        raise ValueError("it places its meshes by transforms")
    return by_name(_mesh(entry, document, binary) for entry in document["meshes"])


def _mesh(entry: dict[str, Any], document: dict[str, Any], binary: memoryview) -> TriangleMesh:
    """Return the mesh of an entry of `meshes`; its primitives share their vertices."""

    def array(index: int, kind: str) -> NDArray[np.generic]:
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        if accessor["componentType"] != {"<f4": _FLOAT_COMPONENT, "<u4": _UNSIGNED_INT_COMPONENT}[kind]:
            raise ValueError("its numbers are not of the types written by gearmesh")
        return np.frombuffer(binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]], kind)

    primitives = entry["primitives"]
    (position,) = {primitive["attributes"]["POSITION"] for primitive in primitives}
    points = array(position, "<f4").astype(float) * _MM_PER_METRE
    parts = [array(primitive["indices"], "<u4").reshape(-1, 3) for primitive in primitives]
    labels = [primitive["extras"]["region"] for primitive in primitives]
    regions = np.repeat(labels, [len(part) for part in parts])
    names = tuple(entry["extras"]["region_names"])
    return built_mesh(entry["name"], points, np.concatenate(parts), regions, names)


register(GLB_SUFFIX, write, read, mesh_in_file, _steps)
