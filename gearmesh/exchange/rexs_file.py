"""REXS files: XML (.rexs, .rexs.xml), JSON (.rexsj, .rexs.json), or one of them zipped (.rexsz, .rexs.zip)."""

from __future__ import annotations

import io
import os
import zipfile
import zlib
from pathlib import Path

from gearmesh.errors import FileError
from gearmesh.exchange.json_form import json_of, model_of_json
from gearmesh.exchange.model import READ_VERSIONS, RexsModel
from gearmesh.exchange.versions import bring_up_to_date
from gearmesh.exchange.xml_form import model_of_xml, xml_of
from gearmesh.files.reading import BYTES_PER_MIB, file_bytes, size_text
from gearmesh.formats import REXS_JSON_SUFFIX, REXS_SUFFIXES, REXS_XML_SUFFIX, REXS_ZIP_SUFFIX

#: forms by the second suffix of a name with two, as gears.rexs.xml
SECOND_SUFFIXES = {".xml": REXS_XML_SUFFIX, ".json": REXS_JSON_SUFFIX, ".zip": REXS_ZIP_SUFFIX}
#: size of the largest file, zipped or not
MAX_FILE_BYTES = 32 * BYTES_PER_MIB
#: kind of file in messages
FILE_KIND = "REXS file"


def is_rexs(path: str | os.PathLike[str]) -> bool:
    """True if a file has the name of a REXS file."""
    return bool(form_of(path))


def form_of(path: str | os.PathLike[str]) -> str:
    """Form of a REXS file by its name: REXS_XML_SUFFIX, REXS_JSON_SUFFIX or REXS_ZIP_SUFFIX; "" for other names."""
    first, second = ["", "", *(suffix.lower() for suffix in Path(path).suffixes)][-2:]
    if first == REXS_XML_SUFFIX and second in SECOND_SUFFIXES:
        return SECOND_SUFFIXES[second]
    return second if second in REXS_SUFFIXES else ""


def read_rexs(path: str | os.PathLike[str]) -> RexsModel:
    """Return the model in a REXS file of the versions 1.0 to 1.7, in the form of 1.7.

    Raises FileError in one line; memory is bounded by `MAX_FILE_BYTES`.
    """
    name, content = os.fspath(path), file_bytes(path, MAX_FILE_BYTES, FILE_KIND)
    if form_of(path) == REXS_ZIP_SUFFIX:
        content = _unzip(content, name)
    if content.lstrip(b"\xef\xbb\xbf \t\r\n").startswith((b"{", b"[")):
        try:
            model = model_of_json(content.decode("utf-8-sig"), name)
        except UnicodeDecodeError as failure:
            raise FileError(name, reason=f"not UTF-8 text (byte {failure.start})") from None
    else:
        model = model_of_xml(content, name)
    if model.version not in READ_VERSIONS:
        raise FileError(
            name, reason=f"REXS version {model.version[:20]!r}; read are {READ_VERSIONS[0]} to {READ_VERSIONS[-1]}"
        )
    ids = [one.id for one in model.components]
    if len(set(ids)) < len(ids):
        twice = next(id for id in ids if ids.count(id) > 1)
        raise FileError(name, reason=f"two components have the id {twice}")
    bring_up_to_date(model)
    return model


def _unzip(content: bytes, name: str) -> bytes:
    """Return the only model in a zipped file; the size that the archive states is not relied on."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            inside = [one for one in archive.infolist() if form_of(one.filename) in (REXS_XML_SUFFIX, REXS_JSON_SUFFIX)]
            if len(inside) != 1:
                raise FileError(
                    name, reason=f"has {len(inside)} files {REXS_XML_SUFFIX} or {REXS_JSON_SUFFIX}; one is wanted"
                )
            with archive.open(inside[0]) as file:
                unzipped = file.read(MAX_FILE_BYTES + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as failure:
        raise FileError(name, reason=f"not a zip file that can be read: {failure}") from None
    if len(unzipped) > MAX_FILE_BYTES:
        raise FileError(
            name, reason=f"is larger than {size_text(MAX_FILE_BYTES)} unzipped, the limit for a {FILE_KIND}"
        )
    return unzipped


def rexs_bytes(model: RexsModel, path: str | os.PathLike[str]) -> bytes:
    """Return the file of a model in the form of the suffix of `path`; the same model gives the same bytes."""
    suffix, stem = Path(path).suffix.lower(), Path(path).stem
    if (
        suffix == REXS_JSON_SUFFIX
        and (spectra := len({case.spectrum for case in model.load_cases if case.spectrum})) > 1
    ):
        raise FileError(
            path,
            reason=f"JSON has one load spectrum, the model has {spectra}: write it as {REXS_XML_SUFFIX} or {REXS_ZIP_SUFFIX}",
        )
    text = json_of(model) if suffix == REXS_JSON_SUFFIX else xml_of(model)
    if suffix != REXS_ZIP_SUFFIX:
        return text.encode()
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(zipfile.ZipInfo(f"{stem}{REXS_XML_SUFFIX}", (1980, 1, 1, 0, 0, 0)), text, zipfile.ZIP_DEFLATED)
    return packed.getvalue()
