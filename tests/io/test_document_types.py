"""Mesh files with a document type are refused before any entity of it is read."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

from gearmesh import OutputError, io
from gearmesh.mesh.triangles import TriangleMesh

pytestmark = pytest.mark.quick

#: nine entities, each ten of the one before: 10^9 characters
LAUGHS = b'<!DOCTYPE x [<!ENTITY a0 "ha">%s]>' % b"".join(
    b'<!ENTITY a%d "%s">' % (k, b"&a%d;" % (k - 1) * 10) for k in range(1, 10)
)
MESH = TriangleMesh(np.eye(3), np.array([[0, 1, 2]]), np.array([0]), ("surface",), np.full((1, 3), 3**-0.5), "t")


def spoil(content: bytes) -> bytes:
    """The same XML with a document type behind its declaration."""
    declaration, end, rest = content.partition(b"?>")
    return declaration + end + LAUGHS + rest


@pytest.mark.parametrize("suffix", [".vtp", ".vtu", ".vtm", ".3mf"])
def test_document_types_are_refused(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"m{suffix}"
    io.write(MESH, path)
    assert io.read(path).triangles.shape == (1, 3)
    if suffix == ".3mf":
        with zipfile.ZipFile(path) as archive:
            parts = {name: archive.read(name) for name in archive.namelist()}
        with zipfile.ZipFile(path, "w") as archive:
            for name, content in parts.items():
                archive.writestr(name, spoil(content) if name.endswith(".model") else content)
    else:
        path.write_bytes(spoil(path.read_bytes()))
    with pytest.raises(OutputError, match=r"has a document type; files with entities are not read"):
        io.read(path)
