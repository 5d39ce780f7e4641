"""REXS files: XML (.rexs, .rexs.xml), JSON (.rexsj, .rexs.json), or either of them zipped (.rexsz, .rexs.zip)."""

from __future__ import annotations

import io
import os
import zipfile
import zlib
from pathlib import Path

from gearmesh.errors import FileError
from gearmesh.exchange.json_form import json_of, model_of_json
from gearmesh.exchange.model import VERSIONS, RexsModel
from gearmesh.exchange.versions import bring_up_to_date
from gearmesh.exchange.xml_form import model_of_xml, xml_of
from gearmesh.files.reading import BYTES_PER_MIB, file_bytes, size_text

XML, JSON, ZIP = ".rexs", ".rexsj", ".rexsz"
SUFFIXES = (XML, JSON, ZIP)
#: second suffix of a name that ends with two, as gears.rexs.xml
SECOND = {".xml": XML, ".json": JSON, ".zip": ZIP}
#: bytes of the largest file, zipped or not
LARGEST = 32 * BYTES_PER_MIB
WANTED = "REXS file"


def is_rexs(path: str | os.PathLike[str]) -> bool:
    """True where the name of a file is that of a REXS file."""
    return bool(form_of(path))


def form_of(path: str | os.PathLike[str]) -> str:
    """Form of a REXS file by its name: XML, JSON or ZIP; "" for other names."""
    first, second = ["", "", *(suffix.lower() for suffix in Path(path).suffixes)][-2:]
    if first == XML and second in SECOND:
        return SECOND[second]
    return second if second in SUFFIXES else ""


def read_rexs(path: str | os.PathLike[str]) -> RexsModel:
    """The model in a REXS file of the versions 1.0 to 1.7, in the form of 1.7.

    Raises FileError in one line; memory is bounded by `LARGEST`.
    """
    name, content = os.fspath(path), file_bytes(path, LARGEST, WANTED)
    if form_of(path) == ZIP:
        content = _unzip(content, name)
    if content.lstrip(b"\xef\xbb\xbf \t\r\n").startswith((b"{", b"[")):
        try:
            model = model_of_json(content.decode("utf-8-sig"), name)
        except UnicodeDecodeError as failure:
            raise FileError(name, reason=f"not UTF-8 text (byte {failure.start})") from None
    else:
        model = model_of_xml(content, name)
    if model.version not in VERSIONS:
        raise FileError(name, reason=f"REXS version {model.version[:20]!r}; read are {VERSIONS[0]} to {VERSIONS[-1]}")
    ids = [one.id for one in model.components]
    if len(set(ids)) < len(ids):
        twice = next(id for id in ids if ids.count(id) > 1)
        raise FileError(name, reason=f"two components have the id {twice}")
    bring_up_to_date(model)
    return model


def _unzip(content: bytes, name: str) -> bytes:
    """The one model in a zipped file; what it says of its own size is not relied on."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            inside = [one for one in archive.infolist() if form_of(one.filename) in (XML, JSON)]
            if len(inside) != 1:
                raise FileError(name, reason=f"has {len(inside)} files {XML} or {JSON}; one is wanted")
            with archive.open(inside[0]) as file:
                unzipped = file.read(LARGEST + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as failure:
        raise FileError(name, reason=f"not a zip file that can be read: {failure}") from None
    if len(unzipped) > LARGEST:
        raise FileError(name, reason=f"is larger than {size_text(LARGEST)} unzipped, the limit for a {WANTED}")
    return unzipped


def rexs_bytes(model: RexsModel, path: str | os.PathLike[str]) -> bytes:
    """The file of a model, of the form that the suffix of `path` says; the same model gives the same bytes."""
    suffix, stem = Path(path).suffix.lower(), Path(path).stem
    if suffix == JSON and (spectra := len({case.spectrum for case in model.load_cases if case.spectrum})) > 1:
        raise FileError(path, reason=f"JSON has one load spectrum, the model has {spectra}: write it as {XML} or {ZIP}")
    text = json_of(model) if suffix == JSON else xml_of(model)
    if suffix != ZIP:
        return text.encode()
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(zipfile.ZipInfo(f"{stem}{XML}", (1980, 1, 1, 0, 0, 0)), text, zipfile.ZIP_DEFLATED)
    return packed.getvalue()
