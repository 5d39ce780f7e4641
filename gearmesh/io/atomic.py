"""Files that appear whole or not at all, and failures to write them as one clear line.

A file is written under a temporary name in the folder of its target and renamed when it is complete and on disk.
Until then an existing file is untouched, and whatever ends the writing early (a full disk, an exception, Ctrl-C)
leaves no temporary file. A process that was killed does leave one; its name shows whose it was, and the next process that
writes into the folder removes what is left of dead ones. Any other part of gearmesh that writes a file goes through here:

    with whole_file("teeth.png") as temporary:
        picture.save(temporary)
    whole_text("report.json", text)
"""

from __future__ import annotations

import os
import re
import secrets
import shutil
import socket
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from copy import copy
from functools import cache
from pathlib import Path

from gearmesh.errors import GearmeshError, OutputError

PathLike = str | os.PathLike[str]

# .gearmesh-<where process numbers mean the same>-<process>-<random>, then a suffix, or -was-<name of a retired folder>
_TEMPORARY = re.compile(r"\.gearmesh-([0-9a-f]{8})-([0-9]{1,10})-[0-9a-f]{12}(?:-was-(.+)|\..*)?", re.DOTALL)


#: what a file in a scratch folder is called in messages
SCRATCH = "a temporary file"
#: files and folders that this process has written whole, in their order
_written: list[Path] = []


def keep(path: PathLike) -> None:
    """Count a file that grows by whole lines among those that are written: what it has is kept when the process is stopped."""
    _written.append(Path(path))


def written_whole() -> tuple[Path, ...]:
    """The files and folders that this process has written and that are there, as their paths were given."""
    return tuple(path for path in dict.fromkeys(_written) if path.exists())


@contextmanager
def whole_file(path: PathLike) -> Iterator[Path]:
    """Context giving a temporary path, beside `path` and with its suffix, that becomes `path` on success.

    The temporary file exists and is empty on entry, so that an unwritable folder is found before any work is done.
    A symbolic link is written through. Raises OutputError, naming `path` and the reason, when `path` cannot be a
    file, on any OSError in the body (which should do nothing but write), and if the body writes nothing.
    """
    target = Path(os.path.realpath(path))
    temporary = _temporary_beside(target, target.suffix)
    try:
        with _report_errors(path, temporary):
            _refuse_unless_file(path, target)
            _remove_leftovers(target.parent)
            os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
            yield temporary
            if not temporary.stat().st_size:
                raise OutputError("cannot write", path, reason="the writer produced nothing")
            _flush_to_disk(temporary)
            os.replace(temporary, target)
            _written.append(Path(path))
    finally:
        with suppress(OSError):  # it may never have existed, and the reason is on its way already
            temporary.unlink()


@contextmanager
def whole_folder(path: PathLike, suffix: str) -> Iterator[Path]:
    """Context giving a new temporary folder that takes the place of the folder `path` on success.

    For formats that spread over files. An existing folder is replaced only if it holds nothing but files ending in
    `suffix`, and comes back if the exchange fails. Raises OutputError as `whole_file` does.
    """
    target = Path(os.path.realpath(path))
    temporary, retired = _temporary_beside(target, target.suffix), _temporary_beside(target, f"-was-{target.name}")
    try:
        with _report_errors(path, temporary):
            _remove_leftovers(target.parent)
            _refuse_unless_replaceable(path, target, suffix)
            temporary.mkdir()
            yield temporary
            for file in temporary.iterdir():
                _flush_to_disk(file)
            _exchange(temporary, target, retired)
            _written.append(Path(path))
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
        shutil.rmtree(retired, ignore_errors=True)


@contextmanager
def files_together(path: PathLike) -> Iterator[Path]:
    """Context giving a temporary folder whose files appear in the folder `path` together on success, and not at all otherwise.

    Files and folders there that have other names stay. A folder that is written anew replaces one that holds files of its
    suffixes alone. The temporary folder is inside `path`, which is made where it does not exist and goes again if nothing is
    written. Raises OutputError as `whole_file` does; refusals name the files as they would have been.
    """
    target = Path(os.path.realpath(path))
    temporary, known = target / _temporary_beside(target / "files", "").name, len(_written)
    made: list[Path] = []
    try:
        with _report_errors(path, temporary):
            made = _make_folder(target)
            _remove_leftovers(target)
            temporary.mkdir()
            try:
                yield temporary
            except OutputError as refusal:
                raise _under_final_name(target, refusal, temporary) from refusal.__cause__
            entries = sorted(temporary.iterdir(), key=lambda entry: entry.is_file())
            for entry in entries:
                _refuse_in_the_way(entry, Path(path) / entry.name)
            for entry in entries:
                _into_place(entry, target / entry.name)
            _written[known:] = [Path(path) / entry.name for entry in entries]
    finally:
        # what is gone was not written
        _written[known:] = [file for file in _written[known:] if temporary not in file.parents]
        shutil.rmtree(temporary, ignore_errors=True)
        for folder in made:
            with suppress(OSError):  # it holds what was written
                folder.rmdir()


def _make_folder(folder: Path) -> list[Path]:
    """Make a folder and those that it is in; all that were made, the innermost first."""
    missing = [parent for parent in (folder, *folder.parents) if not parent.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    return missing


def _under_final_name(target: Path, refusal: OutputError, temporary: Path) -> OutputError:
    """A refusal that names its file as it would have been in the folder `target`."""
    shown, own = str(target), str(temporary)
    refusal.value = str(refusal.value).replace(own, shown)
    refusal.reason = refusal.reason.replace(own, shown)
    return refusal


def _refuse_in_the_way(new: Path, path: Path) -> None:
    """Refuse a file or a folder whose place is taken by what it does not replace."""
    target = Path(os.path.realpath(path))
    if new.is_file():
        _refuse_unless_file(path, target)
    else:
        for suffix in {file.suffix for file in new.iterdir()}:
            _refuse_unless_replaceable(path, target, suffix)


def _into_place(new: Path, target: Path) -> None:
    """Rename a whole file or folder to its place."""
    if new.is_file():
        os.replace(new, os.path.realpath(target))
        return
    retired = _temporary_beside(target, f"-was-{target.name}")
    try:
        _exchange(new, target, retired)
    finally:
        shutil.rmtree(retired, ignore_errors=True)


def whole_text(path: PathLike, text: str) -> None:
    """Write `text` (UTF-8, line ends as given) to `path`, whole or not at all. Raises OutputError."""
    with whole_file(path) as temporary:
        temporary.write_bytes(text.encode())


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """Context giving a folder that is removed at the end; failures to write in it are OutputErrors that do not name it."""
    with tempfile.TemporaryDirectory(prefix="gearmesh-") as name:
        try:
            yield Path(name)
        except OSError as error:
            if name not in str(error):
                raise
            raise OutputError("cannot write", SCRATCH, reason=error.strerror or "it failed") from error
        except GearmeshError as failure:
            raise _with_other_name(failure, name, SCRATCH) from failure


@contextmanager
def _report_errors(path: PathLike, temporary: Path) -> Iterator[None]:
    """Turn an OSError into an OutputError naming `path` as the caller wrote it, never the temporary file."""
    try:
        yield
    except OSError as error:
        folder = os.path.dirname(os.path.abspath(path))
        missing = isinstance(error, FileNotFoundError) and not os.path.isdir(folder)
        told = error.strerror or str(error).replace(str(temporary), os.fspath(path))
        reason = f"the folder {folder} does not exist" if missing else told
        raise OutputError("cannot write", path, reason=reason) from error
    except GearmeshError as failure:
        raise _with_other_name(failure, str(temporary), os.fspath(path)) from failure


def _with_other_name(failure: GearmeshError, temporary: str, name: str) -> GearmeshError:
    """The refusal with another name for a temporary file or folder, and for what is in it."""
    if temporary not in str(failure):
        return failure
    made, inside = copy(failure), re.compile(rf"{re.escape(temporary)}[\w./-]*")
    for own, value in vars(made).items():
        if isinstance(value, str | Path):
            setattr(made, own, inside.sub(lambda _: name, str(value)))
    return made


def _temporary_beside(target: Path, end: str) -> Path:
    """An unused name in the folder of `target`, with its suffix as the `end`: some writers choose the format by it."""
    return target.with_name(f".gearmesh-{_place()}-{os.getpid()}-{secrets.token_hex(6)}{end}")


@cache
def _place() -> str:
    """Machine and process namespace in eight digits: folders may be shared with others, where other processes run."""
    known = [socket.gethostname()]
    with suppress(OSError):
        known.append(Path("/etc/machine-id").read_text(encoding="ascii"))
    with suppress(OSError):
        known.append(os.readlink("/proc/self/ns/pid"))
    return f"{zlib.crc32(' '.join(known).encode()):08x}"


@cache
def _remove_leftovers(folder: Path) -> None:
    """Remove, once a process, what killed processes left in a folder; a retired folder whose place is free goes back there.

    Temporaries of living processes stay, and those of other machines, where nothing is known of their processes.
    """
    if os.name != "posix":
        return  # there is no harmless signal
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in list(entries):
            match = _TEMPORARY.fullmatch(entry.name)
            if not match or match[1] != _place() or _alive(int(match[2])):
                continue
            with suppress(OSError):
                if match[3] and not os.path.lexists(folder / match[3]):
                    os.rename(entry.path, folder / match[3])
                elif entry.is_dir(follow_symlinks=False):
                    shutil.rmtree(entry.path, ignore_errors=True)
                else:
                    os.unlink(entry.path)


def _alive(process: int) -> bool:
    """Whether there is a process of this number, also one that may not be asked."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:
        return True
    return True


def _refuse_unless_file(path: PathLike, target: Path) -> None:
    if target.is_dir():
        raise OutputError("cannot write", path, reason="it is a folder")
    if target.exists() and not target.is_file():
        raise OutputError("cannot write", path, reason="it is not a regular file")


def _refuse_unless_replaceable(path: PathLike, target: Path, suffix: str) -> None:
    if not target.exists():
        return
    if not target.is_dir():
        raise OutputError("cannot write the folder", path, reason="a file has that name")
    if any(entry.is_dir() or entry.suffix != suffix for entry in target.iterdir()):
        raise OutputError("cannot replace the folder", path, reason=f"it holds other files than {suffix}")


def _exchange(new: Path, target: Path, retired: Path) -> None:
    """Rename `new` to `target`, moving an existing `target` to `retired`, or back if that fails."""
    if not target.exists():
        os.rename(new, target)
        return
    os.rename(target, retired)
    try:
        os.rename(new, target)
    except OSError:
        os.rename(retired, target)
        raise


def _flush_to_disk(file: Path) -> None:
    """Wait until the file's contents are on disk: a full disk may show only here."""
    descriptor = os.open(file, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
