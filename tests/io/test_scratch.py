"""Temporary files have no name in any message."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from gearmesh import DesignError, Diagram, GearmeshError, OutputError
from gearmesh.io.atomic import SCRATCH_FILE_WORDS, scratch_folder, whole_file, whole_folder

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    "failure",
    [
        lambda path: OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path)),
        lambda path: OSError(f"failed to open local file '{path}'"),
        lambda path: OutputError("cannot write", path, reason="no space left"),
        lambda path: DesignError("member", "x", reason=f"{path} has no such part"),
    ],
)
def test_messages_do_not_name_temporary_files(failure, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    for context in (
        lambda: whole_file(tmp_path / "a.stl"),
        lambda: whole_folder(tmp_path / "b", ".vtp"),
        scratch_folder,
    ):
        with pytest.raises(GearmeshError) as raised, context() as temporary:
            raise failure(temporary / "inside" if temporary.is_dir() else temporary)
        assert temporary.name not in str(raised.value)
        assert temporary.name not in repr(raised.value)
    assert SCRATCH_FILE_WORDS in str(raised.value)


def test_pictures_in_notebooks_do_not_name_them(tmp_path: Path) -> None:
    def draw(file: Path) -> None:
        raise OutputError("cannot write", file, reason="no space left")

    with pytest.raises(OutputError, match=f"^cannot write {SCRATCH_FILE_WORDS}: no space left$"):
        Diagram("x", draw)._repr_png_()


def test_other_failures_pass_as_they_are() -> None:
    with pytest.raises(BrokenPipeError), scratch_folder():
        raise BrokenPipeError(errno.EPIPE, "Broken pipe")
